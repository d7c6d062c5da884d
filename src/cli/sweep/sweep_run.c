/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Creates the cases of a sweep and runs them one after the other. */
#define _GNU_SOURCE
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "cli/common/process.h"
#include "cli/sweep/sweep.h"
#include "run/common/folder.h"
#include "run/common/progress.h"

void vg_sweep_release(struct vg_sweep *s)
{
  for (size_t i = 0; i < s->n; i++) {
    free(s->item[i].dir);
    free(s->item[i].files);
    vg_timeline_release(&s->item[i].t);
  }
  free(s->item);
  memset(s, 0, sizeof *s);
}

static int way_of(const char *word, size_t len)
{
  for (int k = 0; k < VG_DECOMPOSITIONS; k++)
    if (strlen(vg_ways[k].name) == len && !strncmp(word, vg_ways[k].name, len))
      return k;
  return -1;
}

vg_status vg_sweep_ways(const char *what, const char *text,
                        struct vg_sweep_options *o, struct vg_error *err)
{
  o->n_way = 0;
  for (const char *at = text; at;
       at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    size_t len = strcspn(at, ",");
    int way = way_of(at, len), is_there = 0;

    if (way < 0)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s takes advancing, discrete or "
                     "octree, separated by commas, not '%.*s'",
                     what, (int)len, at);
    for (int k = 0; k < o->n_way; k++) is_there |= o->way[k] == way;
    if (!is_there) o->way[o->n_way++] = way;
  }
  return VG_OK;
}

static vg_status add_case(struct vg_sweep *s, const struct vg_sweep_case *c,
                          struct vg_error *err)
{
  struct vg_sweep_case *to = &s->item[s->n];
  char part[64] = "";
  size_t at = 0;

  *to = *c;
  if (c->family) {
    vg_sweep_level_name(s->o, c->family, part);
    strcat(part, "-");
    at = strlen(part);
  }
  if (c->bisections >= 0)
    snprintf(part + at, sizeof part - at, "L%lld-", (long long)c->bisections);
  if (c->leaf_cells >= 0)
    snprintf(part + at, sizeof part - at, "c%lld-", (long long)c->leaf_cells);
  if (c->way >= 0)
    snprintf(part + at, sizeof part - at, "%s-", vg_ways[c->way].name);
  if (c->subdomains >= 0)
    snprintf(part + strlen(part), 24, "p%lld-", (long long)c->subdomains);
  snprintf(to->name, sizeof to->name, "%sn%d-t%d", part, c->ranks, c->threads);
  if (s->o->repeat > 1)
    snprintf(to->name + strlen(to->name), 16, "-r%d", c->repeat);
  to->angle_min = to->peak_memory = to->critical = NAN;
  to->parts_made = (struct vg_sweep_parts){ NAN, NAN, NAN, NAN, NAN, NAN };
  for (int k = 0; k < VG_MEMBER_N; k++) to->member[k] = NAN;
  for (int k = 0; k < VG_FIGURE_N; k++) to->figure[k] = NAN;
  to->is_planned = vg_sweep_is_in(&s->o->planned, c->family);
  if (asprintf(&to->dir, "%s/%s", s->o->dir, to->name) < 0) {
    to->dir = NULL;
    return vg_fail_memory(err, "a path");
  }
  s->n++;
  return VG_OK;
}

static vg_status add_machines(struct vg_sweep *s, struct vg_sweep_case *c,
                              struct vg_error *err)
{
  const struct vg_sweep_options *o = s->o;
  vg_status st = VG_OK;

  for (size_t t = 0; t < o->threads.n; t++)
    for (size_t n = 0; n < o->ranks.n && st >= 0; n++) {
      c->ranks = (int)o->ranks.v[n];
      c->threads = (int)o->threads.v[t];
      st = add_case(s, c, err);
    }
  return st;
}

/* A family sets --scale itself; one after '--' would override it. */
static vg_status check_extra(const struct vg_sweep_options *o,
                             struct vg_error *err)
{
  for (int i = 0; o->family.n && i < o->n_extra; i++)
    if (!strcmp(o->extra[i], "--scale") ||
        !strncmp(o->extra[i], "--scale=", strlen("--scale=")))
      return vg_fail(err, VG_ERR_INPUT,
                     "--scale after '--' would override "
                     "the scales of --family; give the scale of the first "
                     "level in the deck");
  return VG_OK;
}

vg_status vg_sweep_plan(const struct vg_sweep_options *o, struct vg_sweep *s,
                        struct vg_error *err)
{
  size_t n_way = o->n_way ? (size_t)o->n_way : o->subdomains.n > 0;
  size_t n_parts = o->subdomains.n ? o->subdomains.n : 1;
  size_t n_cut = o->bisections.n + o->leaf_cells.n;
  size_t n_mesh = n_cut + n_way * n_parts, n;
  size_t n_member = o->family.n ? o->family.n : 1;
  vg_status st;

  VG_TRY(check_extra(o, err));
  VG_TRY(vg_sweep_check_named(o, err));
  s->o = o;
  if (!n_mesh) n_mesh = 1;
  n = n_mesh * n_member;
  if (n <= VG_RANGE_MAX) n *= (size_t)o->repeat;
  if (n <= VG_RANGE_MAX) n *= o->ranks.n;
  if (n <= VG_RANGE_MAX) n *= o->threads.n;
  if (n > VG_RANGE_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "the lists give more than %d cases; shorten them",
                   VG_RANGE_MAX);
  s->item = vg_calloc(n, sizeof *s->item);
  if (!s->item) return vg_fail_memory(err, "the cases");
  for (int k = 1; k <= o->repeat; k++)
    for (size_t at = 0; at < n_mesh * n_member; at++) {
      struct vg_sweep_case c = { .bisections = -1,
                                 .leaf_cells = -1,
                                 .subdomains = -1,
                                 .way = -1,
                                 .repeat = k };
      size_t i = at / n_member;

      if (o->family.n) c.family = o->family.v[at % n_member];
      if (i < o->bisections.n) c.bisections = o->bisections.v[i];
      else if (i < n_cut) c.leaf_cells = o->leaf_cells.v[i - o->bisections.n];
      else if (o->n_way) c.way = o->way[(i - n_cut) / n_parts];
      if (i >= n_cut && o->subdomains.n)
        c.subdomains = o->subdomains.v[(i - n_cut) % n_parts];
      VG_TRY(add_machines(s, &c, err));
    }
done:
  return st;
}

/* --- command lines ------------------------------------------------------- */

/* Options of a family member; they precede those after '--', which may
 * therefore select another rule for the layers. */
static vg_status add_member(struct vg_words *w,
                            const struct vg_sweep_options *o,
                            const struct vg_sweep_case *c, struct vg_error *err)
{
  char text[40];
  vg_status st;

  if (o->rule != VG_FAMILY_PLAIN)
    return vg_sweep_add_named(w, o, c->family, err);
  snprintf(text, sizeof text, "%.17g", o->scale * vg_sweep_scale(o, c->family));
  VG_TRY(vg_words_add(w, "--scale", err));
  VG_TRY(vg_words_add(w, text, err));
  VG_TRY(vg_words_add(w, "--scale-layers", err));
  st = vg_words_add(w, "workshop", err);
done:
  return st;
}

/* The program and the project. A forecast runs on one rank. */
static vg_status begin_line(const struct vg_sweep_options *o,
                            const struct vg_sweep_case *c, struct vg_words *w,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!c->is_planned)
    VG_TRY(vg_words_launcher(w, o->launcher, c->ranks, c->threads, err));
  VG_TRY(
    vg_words_take(w, o->program ? strdup(o->program) : vg_own_path(), err));
  VG_TRY(vg_words_add(w, c->is_planned ? "plan" : "mesh", err));
  VG_TRY(vg_words_add(w, "-p", err));
  VG_TRY(vg_words_add(w, o->project, err));
  if (o->deck) {
    VG_TRY(vg_words_add(w, "--deck", err));
    VG_TRY(vg_words_add(w, o->deck, err));
  }
done:
  return st;
}

/* Where the results go. */
static vg_status add_outputs(const struct vg_sweep_case *c, struct vg_words *w,
                             struct vg_error *err)
{
  vg_status st;

  if (c->is_planned) {
    VG_TRY(vg_words_add(w, "-q", err));
    return vg_words_add(w, "--json", err);
  }
  VG_TRY(vg_words_add(w, "--timeline", err));
  VG_TRY(vg_words_add(w, "-o", err));
  st = vg_words_add(w, c->dir, err);
done:
  return st;
}

static vg_status command_line(const struct vg_sweep_options *o,
                              const struct vg_sweep_case *c, struct vg_words *w,
                              struct vg_error *err)
{
  vg_status st;

  VG_TRY(begin_line(o, c, w, err));
  VG_TRY(vg_words_pair(w, "--threads", c->threads, err));
  if (c->bisections >= 0)
    VG_TRY(vg_words_pair(w, "--bisections", c->bisections, err));
  if (c->leaf_cells >= 0)
    VG_TRY(vg_words_pair(w, "--leaf-cells", c->leaf_cells, err));
  if (c->way >= 0) {
    VG_TRY(vg_words_add(w, "--decompose", err));
    VG_TRY(vg_words_add(w, vg_ways[c->way].name, err));
  }
  if (c->subdomains >= 0)
    VG_TRY(vg_words_pair(w, "--subdomains", c->subdomains, err));
  if (c->family) VG_TRY(add_member(w, o, c, err));
  VG_TRY(add_outputs(c, w, err));
  for (int i = 0; i < o->n_extra; i++)
    VG_TRY(vg_words_add(w, o->extra[i], err));
done:
  return st;
}

/* --- child processes ----------------------------------------------------- */

static int ends_with(const char *text, const char *end)
{
  size_t n = strlen(text), m = strlen(end);

  return n >= m && !strcmp(text + n - m, end);
}

/* Remove the reports of an earlier sweep, so that they are not read as those of
 * this one. */
static void remove_stale(const char *dir)
{
  DIR *d = opendir(dir);
  struct dirent *e;

  while (d && (e = readdir(d)))
    if (ends_with(e->d_name, ".report.json") ||
        !strcmp(e->d_name, "plan.json") ||
        ends_with(e->d_name, ".timeline.json"))
      unlinkat(dirfd(d), e->d_name, 0);
  if (d) closedir(d);
}

vg_status vg_sweep_run(const struct vg_sweep_options *o,
                       struct vg_sweep_case *c, struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  char *path = NULL, *plan = NULL;
  vg_status st;

  VG_TRY(vg_make_folder(c->dir, err));
  remove_stale(c->dir);
  VG_TRY(command_line(o, c, &w, err));
  VG_TRY(vg_folder_path(c->dir, "run.log", &path, err));
  if (c->is_planned) VG_TRY(vg_folder_path(c->dir, "plan.json", &plan, err));
  VG_TRY(vg_words_run(&w, NULL, path, plan, &c->exit_status, &c->wall, err));
  c->is_run = 1;
  /* If a limit on the layers is not met, the mesh is complete nevertheless. */
  c->is_done = c->exit_status == VG_EXIT_DONE ||
               c->exit_status == VG_EXIT_LIMIT;
  if (!c->is_done) vg_failure_note(path, c->note, sizeof c->note);
  if (vg_display_interrupted())
    st = vg_fail(err, VG_ERR_IO, "interrupted during %s", c->name);
done:
  vg_words_release(&w);
  free(path);
  free(plan);
  return st;
}
