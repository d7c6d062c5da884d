/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/judge/zone_quality.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/exact_sum.h"
#include "core/geometry/vector.h"
#include "core/judge/quality.h"

/* Sums of a zone. */
struct sums {
  uint64_t n_cell;
  uint64_t n_tet;
  struct vg_exact volume, edge; /* edge: of the mean edges of tetrahedra */
  double angle_min, edge2_max;  /* edge2_max: squared length */
};

struct vg_zone_quality {
  const struct vg_mesh *m; /* borrowed */
  atomic_flag
    busy; /* spin lock of the sums, while those of a slice are added */
  struct sums *sums; /* [n_zone] */
};

vg_status vg_zone_quality_new(const struct vg_mesh *m,
                              struct vg_zone_quality **out,
                              struct vg_error *err)
{
  struct vg_zone_quality *q;

  assert(m && out);
  *out = NULL;
  if (!m->n_zone) return VG_OK;
  q = vg_calloc(1, sizeof *q);
  if (!q) return vg_fail_memory(err, "the zones");
  q->m = m;
  q->sums = vg_calloc(m->n_zone, sizeof *q->sums);
  if (!q->sums) {
    free(q);
    return vg_fail_memory(err, "the zones");
  }
  for (size_t z = 0; z < m->n_zone; z++) q->sums[z].angle_min = 180;
  atomic_flag_clear(&q->busy);
  *out = q;
  return VG_OK;
}

void vg_zone_quality_free(struct vg_zone_quality *q)
{
  if (!q) return;
  free(q->sums);
  free(q);
}

static void add_edges(const double (*x)[3], const uint32_t *cell,
                      struct sums *to)
{
  double sum = 0;

  for (int i = 0; i < 3; i++)
    for (int k = i + 1; k < 4; k++) {
      const double d2 = vg_distance2(x[cell[i]], x[cell[k]]);

      sum += sqrt(d2);
      if (d2 > to->edge2_max) to->edge2_max = d2;
    }
  vg_exact_add(&to->edge, sum / 6);
}

/* Adds n cells of a kind. angle: of tetrahedra, or NULL */
static void add_run(const struct vg_slice *slice, int kind, size_t first,
                    size_t n, const float *angle, struct sums *to)
{
  const size_t width = vg_slice_width[kind];

  to->n_cell += n;
  for (size_t c = first; c < first + n; c++) {
    vg_exact_add(&to->volume,
                 vg_cell_volume(slice->x, kind, slice->cell[kind] + c * width));
    if (!angle) continue;
    to->angle_min = fmin(to->angle_min, (double)angle[c]);
    add_edges(slice->x, slice->cell[kind] + c * width, to);
  }
  if (angle) to->n_tet += n;
}

static void join(struct vg_exact *to, const struct vg_exact *more)
{
  for (int i = 0; i < VG_EXACT_LIMBS; i++) to->limb[i] += more->limb[i];
  to->n_odd += more->n_odd;
}

static void merge(struct vg_zone_quality *q, size_t z, const struct sums *more)
{
  struct sums *to = &q->sums[z];

  while (atomic_flag_test_and_set(&q->busy)) {
  }
  to->n_cell += more->n_cell;
  to->n_tet += more->n_tet;
  join(&to->volume, &more->volume);
  join(&to->edge, &more->edge);
  to->angle_min = fmin(to->angle_min, more->angle_min);
  to->edge2_max = fmax(to->edge2_max, more->edge2_max);
  atomic_flag_clear(&q->busy);
}

/* Runs of cells of one zone. */
static void add_kind(struct vg_zone_quality *q, const struct vg_slice *slice,
                     int kind, const float *angle)
{
  uint64_t end = 0;
  size_t c = 0;

  for (size_t z = 0; z < q->m->n_zone && c < slice->n_cell[kind]; z++) {
    struct sums sums = { .angle_min = 180 };
    size_t n;

    end += q->m->zone[z].n_cell[kind];
    if (end <= slice->cell_at[kind] + c) continue;
    n = (size_t)(end - slice->cell_at[kind]) - c;
    if (n > slice->n_cell[kind] - c) n = slice->n_cell[kind] - c;
    add_run(slice, kind, c, n, kind == VG_SLICE_TET ? angle : NULL, &sums);
    merge(q, z, &sums);
    c += n;
  }
}

vg_status vg_zone_quality_add(struct vg_zone_quality *q,
                              const struct vg_slice *slice,
                              struct vg_error *err)
{
  const struct vg_mesh tets = { .n_point = slice->n_point,
                                .point = (double(*)[3])(uintptr_t)slice->x,
                                .n_tet = slice->n_cell[VG_SLICE_TET],
                                .tet = (uint32_t(*)[4])(
                                         uintptr_t)slice->cell[VG_SLICE_TET] };
  float *angle;

  if (!q) return VG_OK;
  angle = vg_alloc(tets.n_tet, sizeof *angle);
  if (!angle) return vg_fail_memory(err, "the zones");
  vg_mesh_cell_quality(&tets, angle, NULL);
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++)
    add_kind(q, slice, kind, angle);
  free(angle);
  return VG_OK;
}

static vg_status sum_exact(struct vg_comm *comm, struct vg_exact *sum,
                           struct vg_error *err)
{
  vg_status st = vg_comm_sum(comm, VG_EXACT_LIMBS, sum->limb, err);

  return st < 0 ? st : vg_comm_sum(comm, 1, &sum->n_odd, err);
}

vg_status vg_zone_quality_sum(struct vg_comm *comm,
                              const struct vg_zone_quality *q,
                              struct vg_zone_report *report,
                              struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t z = 0; q && z < q->m->n_zone; z++) {
    struct sums sums = q->sums[z];
    uint64_t n[2] = { sums.n_cell, sums.n_tet };
    double most[2] = { -sums.angle_min, sums.edge2_max };

    VG_TRY(vg_comm_sum(comm, 2, n, err));
    VG_TRY(sum_exact(comm, &sums.volume, err));
    VG_TRY(sum_exact(comm, &sums.edge, err));
    VG_TRY(vg_comm_max(comm, 2, most, err));
    report[z] = (struct vg_zone_report){
      .n_cell = n[0],
      .volume = vg_exact_value(&sums.volume),
      .angle_min = -most[0],
      .edge_mean = n[1] ? vg_exact_value(&sums.edge) / (double)n[1] : 0,
      .edge_max = sqrt(most[1])
    };
  }
done:
  return st;
}

vg_status vg_zone_quality_judge(const struct vg_mesh *m,
                                struct vg_zone_report **report,
                                struct vg_error *err)
{
  const struct vg_slice all = {
    .n_point = m->n_point,
    .x = (const double(*)[3])m->point,
    .n_cell = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex },
    .cell = { (const uint32_t *)m->tet, (const uint32_t *)m->pyr,
              (const uint32_t *)m->pri, (const uint32_t *)m->hex }
  };
  struct vg_zone_report *r = NULL;
  struct vg_zone_quality *q = NULL;
  vg_status st;

  *report = NULL;
  VG_TRY(vg_zone_quality_new(m, &q, err));
  if (!q) goto done;
  r = vg_calloc(m->n_zone, sizeof *r);
  if (!r) VG_TRY(vg_fail_memory(err, "the zones"));
  VG_TRY(vg_zone_quality_add(q, &all, err));
  VG_TRY(vg_zone_quality_sum(NULL, q, r, err));
  *report = r;
  r = NULL;
done:
  vg_zone_quality_free(q);
  free(r);
  return st;
}

vg_status vg_interfaces_judge(const struct vg_mesh *m, size_t *n, double x[3],
                              struct vg_error *err)
{
  uint32_t(*zone)[2] = vg_alloc(m->n_sheet_tri, sizeof *zone);
  vg_status st = zone ? VG_OK : vg_fail_memory(err, "the zones");

  *n = 0;
  VG_TRY(st);
  VG_TRY(vg_mesh_zone_sides(m, zone, err));
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const uint32_t *v = m->sheet_tri[t];

    if (!m->sheet[m->sheet_of[t]].is_interface || zone[t][0] != zone[t][1])
      continue;
    for (int d = 0; d < 3 && !*n; d++)
      x[d] = (m->point[v[0]][d] + m->point[v[1]][d] + m->point[v[2]][d]) / 3;
    ++*n;
  }
done:
  free(zone);
  return st;
}
