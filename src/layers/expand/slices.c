/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers and field in slices: division into slices, and their assignment to
 * ranks. */
#include "layers/expand/slices.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/judge/flat_cells.h"
#include "core/mesh/copies.h"
#include "core/mesh/sheets.h"
#include "layers/expand/slices_parts.h"

/* Least number of cells in a slice, and number of points in a slice of boundary
 * points. */
#define SLICE_CELLS 262144 /* L18 */
#define SLICE_POINTS 16384

_Static_assert((int)VG_SLICE_TET == VG_KIND_TET &&
                 (int)VG_SLICE_PYR == VG_KIND_PYR &&
                 (int)VG_SLICE_PRI == VG_KIND_PRI &&
                 (int)VG_SLICE_HEX == VG_KIND_HEX &&
                 (int)VG_SLICE_KINDS == VG_N_KIND,
               "kinds by the same number");

struct vg_layer_slices {
  struct vg_join_plan plan;
  const struct vg_slices *field;
  double (*point)[3]; /* Boundary points. */
  size_t n_front;     /* vg_layer_slices_front */
  uint64_t n_copy;    /* Boundary points that are copies of earlier ones. */
  uint8_t *kind;      /* [front n_point] enum vg_point_kind, for flat cells. */
  size_t rank, size;
  size_t n_part; /* Number of slices of boundary points. */
  size_t n_run, room_run;
  size_t *run;          /* [n_run + 1] first block of faces of each run. */
  size_t first, n_mine; /* Slices of boundary points and runs of faces served by
                           this rank. */
};

/* Ends a run once it has enough cells. Trailing blocks of faces without levels
 * get no slice. */
static vg_status find_runs(struct vg_layer_slices *k, struct vg_error *err)
{
  const struct vg_expand *e = &k->plan.expand;
  size_t begin = 0;

  for (size_t b = 1; b <= e->n_block; b++) {
    size_t n = 0, n_point = e->inner[b] - e->inner[begin];

    for (int i = 0; i < VG_N_KIND; i++) n += e->cell[i][b] - e->cell[i][begin];
    if (n < SLICE_CELLS && (b < e->n_block || !(n || n_point))) continue;
    if (vg_reserve(&k->run, &k->room_run, k->n_run + 2, sizeof *k->run))
      return vg_fail_memory(err, "the slices of the layers");
    k->run[k->n_run++] = begin;
    k->run[k->n_run] = begin = b;
  }
  return VG_OK;
}

static vg_status count_copies(struct vg_layer_slices *k, struct vg_error *err)
{
  struct vg_mesh m = k->plan.boundary;

  m.point = k->point;
  m.n_point = k->plan.first_inner;
  return vg_mesh_has_inner(&m) ? vg_mesh_copies(&m, &k->n_copy, err) : VG_OK;
}

/* Faces of the front on each sheet: two if the field is on both sides. */
static vg_status count_front(struct vg_layer_slices *k, struct vg_error *err)
{
  const struct vg_mesh *m = &k->plan.boundary;
  const struct vg_front *f = k->plan.front;
  struct vg_sheet_table table = VG_SHEET_TABLE_INIT;
  uint8_t *n;
  vg_status st;

  k->n_front = f->n_face;
  if (!m->n_sheet_tri) return VG_OK;
  n = vg_calloc(m->n_sheet_tri, 1);
  if (!n) return vg_fail_memory(err, "the sheets");
  VG_TRY(vg_sheet_table_new(&table, m, err));
  for (size_t i = 0; i < f->n_face; i++) {
    uint32_t v[3], t;
    int is_same;

    for (int c = 0; c < 3; c++) v[c] = k->plan.id[f->face[i][c]];
    t = vg_sheet_table_find(&table, v, &is_same);
    if (t != UINT32_MAX && ++n[t] == 2) k->n_front -= 2;
  }
done:
  vg_sheet_table_release(&table);
  free(n);
  return st;
}

static vg_status find_slices(struct vg_layer_slices *k, struct vg_error *err)
{
  size_t n = k->plan.first_inner;
  vg_status st = find_runs(k, err);

  if (st < 0) return st;
  k->point = vg_alloc(n, sizeof *k->point);
  if (!k->point) return vg_fail_memory(err, "the points of the boundary");
  vg_join_plan_points(&k->plan, 1, k->point);
  VG_TRY(count_copies(k, err));
  VG_TRY(count_front(k, err));
  k->n_part = (n + SLICE_POINTS - 1) / SLICE_POINTS;
done:
  return st;
}

static uint64_t cells_of(const struct vg_layer_slices *k, size_t slice)
{
  const struct vg_expand *e = &k->plan.expand;
  size_t run = slice - k->n_part;
  uint64_t n = 0;

  for (int i = 0; i < VG_N_KIND && slice >= k->n_part; i++)
    n += e->cell[i][k->run[run + 1]] - e->cell[i][k->run[run]];
  return n;
}

/* Cost of a slice, in cells of the field. Checking a layer cell takes half the
 * time, since its edges are not measured; making a boundary point takes a
 * fraction of it. */
static uint64_t weight_of(const struct vg_layer_slices *k, size_t slice)
{
  return slice < k->n_part ? SLICE_POINTS / 8 : cells_of(k, slice) / 2;
}

/* Level up to which all ranks are filled so that `n` more cells fit. Water
 * filling: some ranks may already have more. */
static double level_of(size_t size, const uint64_t *n_field, uint64_t n)
{
  double level = INFINITY;

  for (size_t r = 0; r < size; r++) { /* ranks with no more cells than r */
    double sum = (double)n, wet = 0;

    for (size_t i = 0; i < size; i++) {
      if (n_field[i] > n_field[r]) continue;
      sum += (double)n_field[i];
      wet++;
    }
    if (sum / wet < level) level = sum / wet;
  }
  return level;
}

/* A slice is served by the rank whose share contains the middle of the
 * slice. */
static void share_out(struct vg_layer_slices *k, const uint64_t *n_field)
{
  size_t n = k->n_part + k->n_run, rank = 0;
  uint64_t total = 0, at = 0;
  double level, end;

  for (size_t i = 0; i < n; i++) total += weight_of(k, i);
  level = level_of(k->size, n_field, total);
  end = fmax(level - (double)n_field[0], 0);
  k->first = k->n_mine = 0;
  for (size_t i = 0; i < n; i++) {
    uint64_t w = weight_of(k, i);

    while (rank + 1 < k->size && (double)at + (double)w / 2 >= end)
      end += fmax(level - (double)n_field[++rank], 0);
    if (rank == k->rank && !k->n_mine++) k->first = i;
    at += w;
  }
}

static vg_status get_part(const struct vg_layer_slices *k, size_t part,
                          struct vg_layer_slice *at, struct vg_slice *s,
                          struct vg_error *err)
{
  size_t first = part * SLICE_POINTS, n = k->plan.first_inner - first;

  if (n > SLICE_POINTS) n = SLICE_POINTS;
  at->id = vg_alloc(n, sizeof *at->id);
  at->own = vg_alloc(n, sizeof *at->own);
  if (!at->id || !at->own)
    return vg_fail_memory(err, "a slice of the boundary's points");
  for (size_t i = 0; i < n; i++) {
    at->id[i] = (uint32_t)(first + i);
    at->own[i] = (uint32_t)i;
  }
  s->n_point = s->n_own = n;
  s->point_at = first;
  s->x = (const double(*)[3])(k->point + first);
  s->id = at->id;
  s->own = at->own;
  return VG_OK;
}

/* Removes the points of the front from those owned by a slice of the field. A
 * slice that then owns no points and has no cells becomes empty. */
static void leave_front(const struct vg_layer_slices *k, struct vg_slice *s)
{
  uint64_t n_front = k->plan.front->n_point;
  size_t n_cell = 0;

  if (s->point_at < n_front) {
    uint64_t n = n_front - s->point_at;

    if (n > s->n_own) n = s->n_own;
    s->own += n;
    s->n_own -= n;
    s->point_at = n_front;
  }
  s->point_at += k->plan.first_field - n_front;
  for (int i = 0; i < VG_SLICE_KINDS; i++) {
    s->cell_at[i] += k->plan.expand.n_cell[i];
    n_cell += s->n_cell[i];
  }
  if (!s->n_own && !n_cell) s->n_point = 0;
}

static vg_status get_field(const struct vg_layer_slices *k, size_t i,
                           struct vg_layer_slice *at, struct vg_slice *s,
                           struct vg_error *err)
{
  size_t n_front = k->plan.front->n_point;
  vg_status st = k->field->get(k->field, i, &at->field, err);

  if (st < 0) return st;
  at->is_field = 1;
  *s = at->field;
  leave_front(k, s);
  at->id = vg_alloc(s->n_point, sizeof *at->id);
  if (!at->id) return vg_fail_memory(err, "the numbers of a slice");
  for (size_t p = 0; p < s->n_point; p++) {
    uint32_t v = s->id[p];

    at->id[p] = v < n_front ? k->plan.id[v]
                            : (uint32_t)(k->plan.first_field + (v - n_front));
  }
  s->id = at->id;
  return VG_OK;
}

static void release(const struct vg_layer_slices *k, struct vg_layer_slice *at)
{
  if (at->is_field) k->field->put(k->field, &at->field);
  free(at->x);
  free(at->id);
  free(at->own);
  for (int i = 0; i < VG_SLICE_KINDS; i++) free(at->cell[i]);
  free(at);
}

static vg_status get_slice(const struct vg_slices *slices, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  const struct vg_layer_slices *k = slices->user;
  size_t n = k->first + i; /* Index among all slices of boundary points and
                              runs. */
  struct vg_layer_slice *at = vg_calloc(1, sizeof *at);
  struct vg_slice s = { 0 };
  vg_status st;

  if (!at) return vg_fail_memory(err, "a slice of the mesh");
  if (i >= k->n_mine) st = get_field(k, i - k->n_mine, at, &s, err);
  else if (n < k->n_part) st = get_part(k, n, at, &s, err);
  else {
    n -= k->n_part;
    st = vg_layer_slice_expand(&k->plan, k->run[n], k->run[n + 1], at, &s, err);
  }
  s.keep = at;
  if (st < 0) release(k, at);
  else *out = s;
  return st;
}

static void put_slice(const struct vg_slices *slices, struct vg_slice *slice)
{
  if (slice->keep) release(slices->user, slice->keep);
  memset(slice, 0, sizeof *slice);
}

static void describe(struct vg_layer_slices *k, struct vg_slices *out)
{
  const struct vg_join_plan *p = &k->plan;

  memset(out, 0, sizeof *out);
  out->n_point = p->n_point;
  out->n_boundary_point = p->first_inner;
  out->n_copy = k->n_copy;
  out->n_layer_point = p->first_field;
  for (int i = 0; i < VG_SLICE_KINDS; i++) {
    out->n_layer_cell[i] = p->expand.n_cell[i];
    out->n_cell[i] = p->expand.n_cell[i] + k->field->n_cell[i];
  }
  out->boundary = &p->boundary;
  out->n_slice = k->n_mine + k->field->n_slice;
  out->n_served = k->field->n_served;
  for (size_t i = 0; i < k->n_mine; i++)
    out->n_served += cells_of(k, k->first + i);
  out->get = get_slice;
  out->put = put_slice;
  out->user = k;
}

static vg_status share_equally(struct vg_layer_slices *k, struct vg_error *err)
{
  uint64_t *none = vg_calloc(k->size, sizeof *none);

  if (!none) return vg_fail_memory(err, "the slices of the mesh");
  share_out(k, none);
  free(none);
  return VG_OK;
}

vg_status vg_layer_slices_open(const struct vg_mesh *surface,
                               const struct vg_layers *layers,
                               const struct vg_slices *field,
                               enum vg_layer_cells cells, int rank, int size,
                               int threads, struct vg_slices *out,
                               struct vg_layer_slices **keep,
                               struct vg_join_info *info, struct vg_error *err)
{
  assert(size > 0 && rank >= 0 && rank < size);
  assert(threads >= 0 && out && keep);

  double start = vg_clock();
  struct vg_layer_slices *k = vg_calloc(1, sizeof *k);
  vg_status st;

  if (!k) return vg_fail_memory(err, "the slices of the mesh");
  k->field = field;
  k->rank = (size_t)rank;
  k->size = (size_t)size;
  VG_TRY(vg_join_check_field(&layers->front, field->n_point,
                             field->boundary ? field->boundary->n_tri : 0,
                             field->n_cell[VG_SLICE_PYR] +
                               field->n_cell[VG_SLICE_PRI] +
                               field->n_cell[VG_SLICE_HEX],
                             err));
  VG_TRY(vg_join_plan_open(&k->plan, surface, layers,
                           field->n_point - layers->front.n_point, cells,
                           threads, err));
  VG_TRY(find_slices(k, err));
  VG_TRY(share_equally(k, err));
  vg_join_plan_describe(&k->plan, vg_clock() - start, info);
  describe(k, out);
  *keep = k;
  k = NULL;
done:
  vg_layer_slices_close(k);
  return st;
}

void vg_layer_slices_share(struct vg_layer_slices *k, const uint64_t *n_field,
                           struct vg_slices *out)
{
  assert(k && n_field && out);
  share_out(k, n_field);
  describe(k, out);
}

vg_status vg_layer_slices_tops(struct vg_comm *comm,
                               const struct vg_layer_slices *k, double *ratio,
                               struct vg_error *err)
{
  assert(k && ratio);
  return vg_layer_tops(comm, &k->plan, k->field, ratio, err);
}

vg_status vg_layer_slices_flat(struct vg_layer_slices *k, struct vg_flat **out,
                               struct vg_error *err)
{
  assert(k && out);

  const struct vg_front *f = k->plan.front;
  struct vg_flat_boundary b = { .n_point = f->n_point,
                                .n_face = f->n_face,
                                .id = k->plan.id,
                                .face = (const uint32_t(*)[3])f->face,
                                .patch = f->patch,
                                .top = f->face_id };

  free(k->kind);
  b.kind = k->kind = vg_alloc(f->n_point, sizeof *k->kind);
  if (!k->kind) return vg_fail_memory(err, "the causes of flat cells");
  for (size_t i = 0; i < f->n_point; i++)
    k->kind[i] = f->id[i] == VG_LAYER_NEW                    ? VG_POINT_SLIDE
               : vg_layer_column_of(f->id[i]) != VG_NO_INDEX ? VG_POINT_TOP
                                                             : VG_POINT_SURFACE;
  for (size_t i = 0; i < 3 * f->n_face; i++) {
    uint32_t p = f->face[i / 3][i % 3];

    if (f->face_id[i / 3] != VG_NO_INDEX && k->kind[p] == VG_POINT_SURFACE)
      k->kind[p] = VG_POINT_WALL;
  }
  return vg_flat_new(&b, out, err);
}

size_t vg_layer_slices_front(const struct vg_layer_slices *keep)
{
  return keep->n_front;
}

const uint32_t *vg_layer_slices_roots(const struct vg_layer_slices *keep)
{
  return keep->plan.root;
}

size_t vg_layer_slices_bytes(const struct vg_layer_slices *k)
{
  assert(k);

  const struct vg_join_plan *p = &k->plan;
  const struct vg_expand *e = &p->expand;
  const struct vg_mesh *b = &p->boundary;

  return p->columns->n_column *
           (sizeof *e->mark + sizeof *e->foot + sizeof *e->base) +
         (e->n_block + 1) * (1 + VG_N_KIND) * sizeof *e->inner +
         p->surface->n_point * sizeof *p->root +
         p->front->n_point * (sizeof *p->id + sizeof *k->kind) +
         b->n_tri * (sizeof *b->tri + sizeof *b->tri_patch) +
         b->n_quad * (sizeof *b->quad + sizeof *b->quad_patch) +
         p->first_inner * sizeof *k->point;
}

void vg_layer_slices_close(struct vg_layer_slices *k)
{
  if (!k) return;
  vg_join_plan_close(&k->plan);
  free(k->point);
  free(k->kind);
  free(k->run);
  free(k);
}
