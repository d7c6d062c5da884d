/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Memory of a run by stage and part. */
#include <assert.h>

#include "layers/columns/share.h"
#include "run/report/report.h"
#include "run/stages/run.h"

static void add_bytes(void *user, size_t n, const void *data)
{
  size_t *sum = user;

  (void)data;
  *sum += n;
}

void vg_run_measure(struct vg_run *r, const struct vg_mesh *surface,
                    const struct vg_layers *layers,
                    const struct vg_sizing *sizing)
{
  struct vg_memory_parts *m = &r->memory_of;

  assert(surface && sizing);
  m->columns = m->sizes = 0;
  m->surface = surface->n_point * sizeof *surface->point +
               surface->n_tri *
                 (sizeof *surface->tri + sizeof *surface->tri_patch);
  if (layers) vg_layers_show(layers, add_bytes, &m->columns);
  vg_sizing_show(sizing, add_bytes, &m->sizes);
}

void vg_run_stage_ends(struct vg_run *r, enum vg_run_stage stage)
{
  assert(stage < VG_STAGES);
  for (int s = stage; s < VG_STAGES; s++)
    r->memory_of.peak[s] = vg_report_peak_memory();
}

/* The peak of a process can only grow: it occurred in the first stage that
 * ended with its present value. */
static enum vg_run_stage stage_of_peak(const struct vg_memory_parts *m)
{
  int s = 0;

  while (m->peak[s] < m->peak[VG_STAGES - 1]) s++;
  return (enum vg_run_stage)s;
}

/* Replaces sizes of this rank by the largest ones of all ranks. */
static vg_status find_largest(struct vg_run *r, struct vg_error *err)
{
  struct vg_memory_parts *m = &r->memory_of;
  struct vg_mesh_report *j = &r->judge;
  double part[] = { (double)m->numbers, (double)j->bytes_shared,
                    (double)j->bytes_slices };
  vg_status st = vg_comm_max(r->comm, 3, part, err);

  if (st >= 0) st = vg_comm_max(r->comm, VG_STAGES, m->peak, err);
  m->numbers = (size_t)part[0];
  j->bytes_shared = (size_t)part[1];
  j->bytes_slices = (size_t)part[2];
  return st;
}

vg_status vg_run_memory(struct vg_run *r, struct vg_error *err)
{
  double own, stage;
  uint64_t sum;
  vg_status st;

  vg_run_stage_ends(r, VG_STAGE_WRITE);
  r->memory = own = r->memory_of.peak[VG_STAGE_WRITE];
  sum = (uint64_t)own;
  if (vg_comm_node_rank(r->comm)) sum -= sum < r->common ? sum : r->common;
  VG_TRY(vg_comm_max(r->comm, 1, &r->memory, err));
  stage = own < r->memory ? -1 : (double)stage_of_peak(&r->memory_of);
  VG_TRY(vg_comm_max(r->comm, 1, &stage, err));
  r->memory_stage = (enum vg_run_stage)stage;
  VG_TRY(find_largest(r, err));
  VG_TRY(vg_comm_sum(r->comm, 1, &sum, err));
  r->memory_sum = (double)sum;
done:
  return st;
}

/* --- reports -------------------------------------------------------------- */

static const struct {
  const char *key, *text;
} stage_name[VG_STAGES] = { { "surface", "the surface" },
                            { "sizes", "sizing field and layers" },
                            { "fill", "the fill" },
                            { "check", "the mesh check" },
                            { "write", "writing" } };

struct part {
  const char *key, *text;
  double bytes;
  enum vg_run_stage from, to; /* First and last stage that has it in memory. */
};

enum { N_PART = 8 };

static void list_parts(const struct vg_run *r, struct part part[N_PART])
{
  const struct vg_memory_parts *m = &r->memory_of;
  const struct vg_partition_report *p = &r->partition;
  const struct part list[N_PART] = {
    { "surface", "surface", (double)m->surface, VG_STAGE_SURFACE,
      VG_STAGE_WRITE },
    { "columns", "columns", (double)m->columns, VG_STAGE_SIZES,
      VG_STAGE_WRITE },
    { "sizes", "sizing field", (double)m->sizes, VG_STAGE_SIZES,
      VG_STAGE_CHECK },
    { "cells", "cells until written", p->cell_bytes, VG_STAGE_FILL,
      VG_STAGE_WRITE },
    { "subdomain", "largest subdomain", p->fill.bytes, VG_STAGE_FILL,
      VG_STAGE_FILL },
    { "numbers", "numbers and boundary", (double)m->numbers, VG_STAGE_CHECK,
      VG_STAGE_WRITE },
    { "between", "faces, edges and points between slices",
      (double)r->judge.bytes_shared, VG_STAGE_CHECK, VG_STAGE_CHECK },
    { "slices", "slices in work", (double)r->judge.bytes_slices, VG_STAGE_CHECK,
      VG_STAGE_CHECK }
  };

  for (int i = 0; i < N_PART; i++) part[i] = list[i];
}

static int is_in(const struct part *p, enum vg_run_stage stage)
{
  return p->bytes > 0 && p->from <= stage && stage <= p->to;
}

void vg_report_memory_text(FILE *to, const struct vg_run *r)
{
  struct part part[N_PART];
  double known = 0;

  list_parts(r, part);
  fprintf(to, "\nPeak memory%s: %.0f MB, in %s\n",
          r->size > 1 ? " of a rank" : "", r->memory / 1e6,
          stage_name[r->memory_stage].text);
  for (int i = 0; i < N_PART; i++) {
    if (!is_in(&part[i], r->memory_stage)) continue;
    fprintf(to, "  %-40s %9.1f MB\n", part[i].text, part[i].bytes / 1e6);
    known += part[i].bytes;
  }
  fprintf(to, "  %-40s %9.1f MB\n", "everything else",
          (r->memory > known ? r->memory - known : 0) / 1e6);
}

json_t *vg_report_memory_json(const struct vg_run *r)
{
  struct part part[N_PART];
  json_t *o = json_object(), *peak = json_object();

  list_parts(r, part);
  for (int i = 0; i < N_PART; i++)
    json_object_set_new(o, part[i].key, json_real(part[i].bytes));
  json_object_set_new(o, "stage", json_string(stage_name[r->memory_stage].key));
  for (int s = 0; s < VG_STAGES; s++)
    json_object_set_new(peak, stage_name[s].key,
                        json_real(r->memory_of.peak[s]));
  json_object_set_new(o, "until", peak);
  return o;
}
