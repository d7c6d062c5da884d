/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Jobs, their settings and their surface: the first half of api/vanguard.h. */
#define _GNU_SOURCE
#include "api/job.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/child.h"
#include "base/memory.h"
#include "run/settings/deck.h"

const char *vanguard_version(void)
{
  return VG_VERSION;
}

int vanguard_abi(void)
{
  return VANGUARD_ABI;
}

vanguard_status vanguard_prepare(void)
{
  return vg_job_status(vg_child_server_start(NULL));
}

/* --- one call at a time -------------------------------------------------- */

/* The job whose use this thread was refused last; NULL: a later call was
 * accepted. */
static _Thread_local const vanguard_job *refused;

vanguard_status vg_job_enter(const vanguard_job *job)
{
  int is_free;

  if (!job) return VANGUARD_ERR_USAGE;
  is_free = !atomic_exchange(&((vanguard_job *)job)->busy, 1);
  refused = is_free ? NULL : job;
  return is_free ? VANGUARD_OK : VANGUARD_ERR_BUSY;
}

void vg_job_leave(const vanguard_job *const *job)
{
  refused = NULL;
  atomic_store(&((vanguard_job *)*job)->busy, 0);
}

/* --- jobs ---------------------------------------------------------------- */

static vg_status refuse_abi(int abi, struct vg_error *err)
{
  if (abi == VANGUARD_ABI) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the program was compiled for ABI %d of libvanguard, but "
                 "this is version %s with ABI %d; recompile it with the "
                 "header of this version",
                 abi, VG_VERSION, VANGUARD_ABI);
}

static vanguard_job *new_job(int abi)
{
  vanguard_job *job = vg_calloc(1, sizeof *job);

  if (!job) return NULL;
  job->problem = (struct vg_problem)VG_PROBLEM_INIT;
  vg_settings_default(&job->settings);
  job->is_refused = refuse_abi(abi, &job->err) < 0;
  return job;
}

static vanguard_status settle(vanguard_job *job, vg_status st,
                              vanguard_job **out)
{
  job->is_refused |= st < 0;
  *out = job;
  return vg_job_status(st);
}

vanguard_status vanguard_new(int abi, vanguard_job **out)
{
  if (!out) return VANGUARD_ERR_USAGE;
  *out = new_job(abi);
  if (!*out) return VANGUARD_ERR_MEMORY;
  return settle(*out, (*out)->err.code, out);
}

vanguard_status vanguard_new_mpi(int abi, const void *comm, vanguard_job **out)
{
  vg_status st;

  if (!out) return VANGUARD_ERR_USAGE;
  *out = new_job(abi);
  if (!*out) return VANGUARD_ERR_MEMORY;
  st = (*out)->err.code;
  if (st >= 0) st = vg_job_needs(*out, comm, "comm");
  if (st >= 0) st = vg_comm_of(comm, &(*out)->comm, &(*out)->err);
  return settle(*out, st, out);
}

vanguard_status vanguard_new_fortran(int abi, int32_t comm, vanguard_job **out)
{
  vg_status st;

  if (!out) return VANGUARD_ERR_USAGE;
  *out = new_job(abi);
  if (!*out) return VANGUARD_ERR_MEMORY;
  st = (*out)->err.code;
  if (st >= 0) st = vg_comm_of_fortran(comm, &(*out)->comm, &(*out)->err);
  return settle(*out, st, out);
}

vanguard_status vanguard_close(vanguard_job *job)
{
  if (!job) return VANGUARD_OK;
  if (vg_job_enter(job)) return VANGUARD_ERR_BUSY;
  vg_job_release_run(job, 1);
  vg_settings_release(&job->settings);
  vg_mesh_release(&job->surface);
  vg_job_forget_sizes(job);
  free(job->project);
  free(job->deck);
  free(job->name);
  vg_comm_close(job->comm);
  free(job);
  return VANGUARD_OK;
}

void vanguard_free(vanguard_job *job)
{
  vanguard_close(job);
}

const char *vanguard_message(const vanguard_job *job)
{
  if (!job)
    return "no job: it has not been created, or there was not enough memory";
  if (job == refused || atomic_load(&job->busy))
    return "the job is in use by another call: a callback cannot use the job "
           "that called it, and only one thread at a time can use a job; wait "
           "until the call has returned, or use another job";
  return job->err.text;
}

vg_status vg_job_usable(vanguard_job *job)
{
  return job->is_refused ? VG_ERR_USAGE : VG_OK;
}

vg_status vg_job_needs(vanguard_job *job, const void *argument,
                       const char *name)
{
  if (job->is_refused) return VG_ERR_USAGE;
  if (argument) return VG_OK;
  return vg_fail(&job->err, VG_ERR_USAGE,
                 "the argument '%s' is NULL, but this call needs it", name);
}

/* --- settings ------------------------------------------------------------ */

vanguard_status vanguard_set(vanguard_job *job, const char *name,
                             const char *value)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, name, "name");

  if (st >= 0) st = vg_job_needs(job, value, "value");
  if (st >= 0) st = vg_settings_set(&job->settings, name, value, &job->err);
  return vg_job_status(st);
}

vanguard_status vanguard_get(vanguard_job *job, const char *name, char *value,
                             size_t size)
{
  VG_JOB_CALL(job);
  char text[2 * VG_LIST_MAX + 4];
  vg_status st = vg_job_needs(job, name, "name");

  if (st >= 0 && size) st = vg_job_needs(job, value, "value");
  if (st >= 0)
    st = vg_settings_get(&job->settings, name, text, sizeof text, &job->err);
  if (st >= 0 && strlen(text) >= size)
    st = vg_fail(&job->err, VG_ERR_USAGE,
                 "the value of %s has %zu characters and does not fit into "
                 "an array of %zu",
                 name, strlen(text), size);
  if (st >= 0) memcpy(value, text, strlen(text) + 1);
  return vg_job_status(st);
}

vanguard_status vanguard_add(vanguard_job *job, const char *table, size_t n,
                             const char *const *column,
                             const char *const *value)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, table, "table");

  if (st >= 0 && n) st = vg_job_needs(job, column, "column");
  if (st >= 0 && n) st = vg_job_needs(job, value, "value");
  for (size_t i = 0; i < n && st >= 0; i++) {
    st = vg_job_needs(job, column[i], "column[i]");
    if (st >= 0) st = vg_job_needs(job, value[i], "value[i]");
  }
  if (st >= 0)
    st = vg_settings_add_named(&job->settings, table, n, column, value,
                               &job->err);
  return vg_job_status(st);
}

vanguard_status vanguard_deck(vanguard_job *job, const char *text)
{
  VG_JOB_CALL(job);
  vg_status st = vg_job_needs(job, text, "text");

  if (st >= 0)
    st = vg_deck_parse("deck", text, strlen(text), &job->settings, &job->err);
  return vg_job_status(st);
}

/* Copies what fits; returns 0 if `out` has no size. */
static int give(void *out, const void *full, size_t size)
{
  size_t known = 0;

  assert(size >= sizeof known);
  if (out) memcpy(&known, out, sizeof known);
  if (known < sizeof known) return 0;
  if (known < size) size = known;
  if (size > sizeof known)
    memcpy((char *)out + sizeof known, (const char *)full + sizeof known,
           size - sizeof known);
  return 1;
}

vg_status vg_job_give(vanguard_job *job, void *out, const void *full,
                      size_t size)
{
  if (give(out, full, size)) return VG_OK;
  return vg_fail(&job->err, VG_ERR_USAGE,
                 out ? "the struct_size of the structure is not set: "
                       "initialise it with VANGUARD_INIT"
                     : "the structure for the result is NULL");
}

int vanguard_setting(size_t i, struct vanguard_setting *out)
{
  static const char *const kind[] = {
    [VG_PARAM_REAL] = "real", [VG_PARAM_COUNT] = "count",
    [VG_PARAM_ID] = "count",  [VG_PARAM_PATCH] = "text",
    [VG_PARAM_FLAG] = "flag", [VG_PARAM_WORD] = "word",
    [VG_PARAM_TEXT] = "text"
  };
  struct vanguard_setting s = { .struct_size = sizeof s };
  int in_farfield;
  const struct vg_param *p = vg_settings_name(i, &s.name, &in_farfield);

  if (!p) return 0;
  s.unit = p->unit;
  s.help = p->help;
  s.kind = kind[p->type];
  s.words = p->words;
  s.least = p->lo;
  s.most = p->hi;
  return give(out, &s, sizeof s);
}

/* --- input --------------------------------------------------------------- */

static int keep_text(char **to, const char *text)
{
  char *copy = text ? strdup(text) : NULL;

  if (text && !copy) return -1;
  free(*to);
  *to = copy;
  return 0;
}

vanguard_status vanguard_open(vanguard_job *job, const char *project,
                              const char *deck)
{
  VG_JOB_CALL(job);
  struct vg_problem p = VG_PROBLEM_INIT;
  vg_status st;

  VG_TRY(vg_job_needs(job, project, "project"));
  VG_TRY(vg_problem_open(&p, project, deck, &job->err));
  VG_TRY(vg_problem_refuse_section(&p, &job->err));
  if (keep_text(&job->project, project) || keep_text(&job->deck, deck)) {
    st = vg_fail_memory(&job->err, "the names of the project");
    goto done;
  }
  vg_settings_release(&job->settings);
  job->settings = p.asked;
  memset(&p.asked, 0, sizeof p.asked);
  vg_mesh_release(&job->surface);
done:
  vg_problem_release(&p);
  return vg_job_status(st);
}

static vg_status check_triangles(const char *name, size_t n_point, size_t n,
                                 const uint32_t *tri, struct vg_error *err)
{
  if (n_point >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: %zu points are too many for "
                   "a surface",
                   name, n_point);
  if (!n)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the surface has no triangles; give at least one", name);
  for (size_t i = 0; i < 3 * n; i++)
    if (tri[i] >= n_point)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: triangle %zu refers to point %lu, but points are "
                     "numbered from 0 to %lld",
                     name, i / 3, (unsigned long)tri[i],
                     (long long)n_point - 1);
  return VG_OK;
}

static int compare_id(const void *a, const void *b)
{
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;

  return (x > y) - (x < y);
}

/* Create the patches in ascending order of their ids. */
static vg_status make_patches(struct vg_mesh *m, const int32_t *patch,
                              struct vg_error *err)
{
  int32_t *id = vg_alloc(m->n_tri, sizeof *id);
  size_t n = 0;

  if (!id) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_tri; i++) id[i] = patch ? patch[i] : 1;
  qsort(id, m->n_tri, sizeof *id, compare_id);
  for (size_t i = 0; i < m->n_tri; i++)
    if (!i || id[i] != id[i - 1]) id[n++] = id[i];
  for (size_t i = 0; i < n; i++)
    if (vg_mesh_add_patch(m, id[i], NULL) == SIZE_MAX) break;
  for (size_t i = 0; i < m->n_tri && m->n_patch == n; i++) {
    int32_t key = patch ? patch[i] : 1, *at;

    at = bsearch(&key, id, n, sizeof *id, compare_id);
    m->tri_patch[i] = (uint32_t)(at - id);
  }
  free(id);
  return m->n_patch == n ? VG_OK : vg_fail_memory(err, "the patches");
}

vanguard_status vanguard_surface(vanguard_job *job, const char *name,
                                 size_t n_point, const double *xyz,
                                 size_t n_tri, const uint32_t *tri,
                                 const int32_t *patch)
{
  VG_JOB_CALL(job);
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  VG_TRY(vg_job_needs(job, name, "name"));
  if (n_point) VG_TRY(vg_job_needs(job, xyz, "xyz"));
  if (n_tri) VG_TRY(vg_job_needs(job, tri, "tri"));
  VG_TRY(check_triangles(name, n_point, n_tri, tri, &job->err));
  m.point = vg_alloc(n_point, sizeof *m.point);
  m.tri = vg_alloc(n_tri, sizeof *m.tri);
  m.tri_patch = vg_alloc(n_tri, sizeof *m.tri_patch);
  if (!m.point || !m.tri || !m.tri_patch || keep_text(&job->name, name)) {
    st = vg_fail_memory(&job->err, "the surface");
    goto done;
  }
  m.n_point = n_point;
  m.n_tri = n_tri;
  if (n_point) memcpy(m.point, xyz, n_point * sizeof *m.point);
  if (n_tri) memcpy(m.tri, tri, n_tri * sizeof *m.tri);
  VG_TRY(make_patches(&m, patch, &job->err));
  vg_mesh_move(&job->surface, &m);
  keep_text(&job->project, NULL);
  keep_text(&job->deck, NULL);
done:
  vg_mesh_release(&m);
  return vg_job_status(st);
}
