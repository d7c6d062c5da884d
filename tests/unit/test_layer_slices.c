/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers and isotropic region in slices: together they equal the mesh of
 * vg_layers_join. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/parallel.h"
#include "core/judge/flat_cells.h"
#include "core/judge/quality_parts.h"
#include "fill_support.h"
#include "join_support.h"
#include "layer_cases.h"
#include "layers/expand/slices.h"
#include "layers/expand/slices_parts.h"
#include "layers/grow/grow.h"

/* --- a mesh of tetrahedra served in pieces ------------------------------- */

struct server {
  const struct vg_mesh *m;
  size_t n_front;
  size_t n_piece; /* number of pieces, each with cells and the points that are
                     not on the front */
  size_t rank, size;
  int apart; /* the front's points are in a separate slice */
  int fails;
};

struct piece {
  double (*x)[3];
  uint32_t *id, *own, (*tet)[4];
};

static size_t share(size_t n, size_t i, size_t of)
{
  return n * i / of;
}

static void serve_put(const struct vg_slices *s, struct vg_slice *slice)
{
  struct piece *p = slice->keep;

  (void)s;
  free(p->x);
  free(p->id);
  free(p->own);
  free(p->tet);
  free(p);
}

/* Points used by cells come first, so the owned points are not contiguous. */
static void serve_points(const struct vg_mesh *m, size_t first, size_t end,
                         size_t first_tet, size_t n_tet, struct vg_slice *out)
{
  struct piece *p = vg_calloc(1, sizeof *p);
  uint32_t *local = vg_alloc(m->n_point, sizeof *local);
  size_t n = 0;

  memset(local, 0xff, m->n_point * sizeof *local);
  p->id = vg_alloc(4 * n_tet + end - first, sizeof *p->id);
  p->x = vg_alloc(4 * n_tet + end - first, sizeof *p->x);
  p->own = vg_alloc(end - first, sizeof *p->own);
  p->tet = vg_alloc(n_tet, sizeof *p->tet);
  for (size_t i = 0; i < 4 * n_tet + end - first; i++) {
    uint32_t v = i < 4 * n_tet ? m->tet[first_tet + i / 4][i % 4]
                               : (uint32_t)(first + i - 4 * n_tet);

    if (local[v] == VG_NO_INDEX) {
      local[v] = (uint32_t)n;
      p->id[n] = v;
      memcpy(p->x[n++], m->point[v], sizeof *p->x);
    }
    if (i < 4 * n_tet) p->tet[i / 4][i % 4] = local[v];
    else p->own[i - 4 * n_tet] = local[v];
  }
  free(local);
  *out = (struct vg_slice){ .n_point = n,
                            .x = (const double(*)[3])p->x,
                            .id = p->id,
                            .point_at = first,
                            .n_own = end - first,
                            .own = p->own,
                            .domain = 7,
                            .kind = 1,
                            .keep = p };
  out->cell_at[VG_SLICE_TET] = first_tet;
  out->n_cell[VG_SLICE_TET] = n_tet;
  out->cell[VG_SLICE_TET] = (const uint32_t *)p->tet;
}

static vg_status serve_get(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  const struct server *v = s->user;
  size_t at = v->rank + i * v->size, first, end, cell;

  if (v->fails) return vg_fail_memory(err, "a test");
  if (v->apart && !at) {
    serve_points(v->m, 0, v->n_front, 0, 0, out);
    return VG_OK;
  }
  at -= (size_t)v->apart;
  first = v->n_front + share(v->m->n_point - v->n_front, at, v->n_piece);
  end = v->n_front + share(v->m->n_point - v->n_front, at + 1, v->n_piece);
  cell = share(v->m->n_tet, at, v->n_piece);
  serve_points(v->m, !v->apart && !at ? 0 : first, end, cell,
               share(v->m->n_tet, at + 1, v->n_piece) - cell, out);
  return VG_OK;
}

static struct vg_slices serve(struct server *v)
{
  size_t n = v->n_piece + (size_t)v->apart;
  struct vg_slices s = { .n_point = v->m->n_point,
                         .boundary = v->m,
                         .get = serve_get,
                         .put = serve_put,
                         .user = v };

  s.n_cell[VG_SLICE_TET] = v->m->n_tet;
  s.n_boundary_point = v->n_front;
  s.n_slice = n > v->rank ? (n - v->rank + v->size - 1) / v->size : 0;
  return s;
}

/* --- slices against the whole mesh --------------------------------------- */

static const size_t n_node[VG_SLICE_KINDS] = { 4, 5, 6, 8 };

struct check {
  const struct vg_mesh *m;
  const struct vg_slices *s;
  uint8_t *point, *cell[VG_SLICE_KINDS]; /* number of times each one was seen */
  size_t *wrong;                         /* by slice */
};

static size_t count_of(const struct vg_mesh *m, int kind)
{
  return kind == VG_SLICE_TET ? m->n_tet
       : kind == VG_SLICE_PYR ? m->n_pyr
       : kind == VG_SLICE_PRI ? m->n_pri
                              : m->n_hex;
}

static const uint32_t *cells_of(const struct vg_mesh *m, int kind)
{
  return kind == VG_SLICE_TET ? (const uint32_t *)m->tet
       : kind == VG_SLICE_PYR ? (const uint32_t *)m->pyr
       : kind == VG_SLICE_PRI ? (const uint32_t *)m->pri
                              : (const uint32_t *)m->hex;
}

static void check_start(struct check *c, const struct vg_mesh *m)
{
  memset(c, 0, sizeof *c);
  c->m = m;
  c->point = vg_calloc(m->n_point, 1);
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    c->cell[k] = vg_calloc(count_of(m, k), 1);
}

/* Differences between a slice and the mesh. */
static size_t compare(const struct check *c, const struct vg_slice *s)
{
  size_t wrong = 0;

  for (size_t i = 0; i < s->n_point; i++)
    if (s->id[i] >= c->m->n_point) return 1;
    else wrong += memcmp(s->x[i], c->m->point[s->id[i]], sizeof *s->x) != 0;
  for (size_t i = 0; i < s->n_own; i++)
    if (s->own[i] >= s->n_point || s->id[s->own[i]] != s->point_at + i)
      return wrong + 1;
    else c->point[s->point_at + i]++;
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    const uint32_t *whole = cells_of(c->m, k);

    if (s->cell_at[k] + s->n_cell[k] > count_of(c->m, k)) return wrong + 1;
    for (size_t i = 0; i < s->n_cell[k] * n_node[k]; i++)
      if (s->cell[k][i] >= s->n_point) return wrong + 1;
      else
        wrong += s->id[s->cell[k][i]] != whole[s->cell_at[k] * n_node[k] + i];
    for (size_t i = 0; i < s->n_cell[k]; i++) c->cell[k][s->cell_at[k] + i]++;
  }
  return wrong;
}

static void compare_some(void *context, size_t first, size_t end, int worker)
{
  const struct check *c = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_slice slice;

    c->wrong[i] = 1;
    if (c->s->get(c->s, i, &slice, NULL) < 0) continue;
    c->wrong[i] = compare(c, &slice);
    c->s->put(c->s, &slice);
  }
}

/* Everything was seen once. */
static void check_end(struct check *c)
{
  for (size_t i = 0; i < c->m->n_point; i++) assert_int_equal(c->point[i], 1);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    for (size_t i = 0; i < count_of(c->m, k); i++)
      assert_int_equal(c->cell[k][i], 1);
    free(c->cell[k]);
  }
  free(c->point);
}

static void same(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

static void same_boundary(const struct vg_mesh *a, const struct vg_mesh *b)
{
  assert_int_equal(b->n_point + b->n_tet + b->n_pyr + b->n_pri, 0);
  assert_int_equal(a->n_tri, b->n_tri);
  assert_int_equal(a->n_quad, b->n_quad);
  assert_int_equal(a->n_patch, b->n_patch);
  same(a->tri, b->tri, a->n_tri, sizeof *a->tri);
  same(a->tri_patch, b->tri_patch, a->n_tri, sizeof *a->tri_patch);
  same(a->quad, b->quad, a->n_quad, sizeof *a->quad);
  same(a->quad_patch, b->quad_patch, a->n_quad, sizeof *a->quad_patch);
  same(a->patch, b->patch, a->n_patch, sizeof *a->patch);
}

static void same_counts(const struct vg_mesh *m, const struct vg_join_info *a,
                        const struct vg_slices *s, const struct vg_join_info *b)
{
  const size_t n_layer[VG_SLICE_KINDS] = { a->n_layer_tet, a->n_layer_pyr,
                                           a->n_layer_pri, a->n_layer_hex };

  assert_int_equal(a->n_boundary_point, b->n_boundary_point);
  assert_int_equal(a->n_layer_point, b->n_layer_point);
  assert_int_equal(a->n_layer_tet, b->n_layer_tet);
  assert_int_equal(a->n_layer_pyr, b->n_layer_pyr);
  assert_int_equal(a->n_layer_pri, b->n_layer_pri);
  assert_int_equal(a->n_layer_hex, b->n_layer_hex);
  assert_int_equal(s->n_point, m->n_point);
  assert_int_equal(s->n_boundary_point, a->n_boundary_point);
  assert_int_equal(s->n_layer_point, a->n_layer_point);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    assert_int_equal(s->n_cell[k], count_of(m, k));
    assert_int_equal(s->n_layer_cell[k], n_layer[k]);
  }
}

/* Divide the layers again, as if later ranks had more of the isotropic region,
 * the last one more than all cells of the mesh. */
static void share_unevenly(struct vg_layer_slices *keep, int size,
                           struct vg_slices *s)
{
  uint64_t n_field[64] = { 0 };

  assert_in_range(size, 1, 64);
  for (int r = 1; r < size; r++)
    n_field[r] = r + 1 < size ? 2000 * (uint64_t)r : 100000000;
  vg_layer_slices_share(keep, n_field, s);
}

/* --- volumes across the tops --------------------------------------------- */

/* A triangle of a cell. */
struct side {
  uint32_t v[3];
  int is_field;
  double volume;
};

static int by_index(const void *a, const void *b)
{
  const uint32_t *s = a, *t = b;

  return (*s > *t) - (*s < *t);
}

static int by_points(const void *a, const void *b)
{
  const struct side *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->v[k] != t->v[k]) return s->v[k] < t->v[k] ? -1 : 1;
  return s->is_field - t->is_field;
}

static int by_value(const void *a, const void *b)
{
  const double *s = a, *t = b;

  return (*s > *t) - (*s < *t);
}

static size_t list_sides(const struct vg_mesh *m,
                         const size_t n_layer[VG_SLICE_KINDS],
                         struct side *side)
{
  size_t n = 0;

  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    const struct vg_cell_faces *f = &vg_cell_faces[kind];
    struct vg_cells c = vg_mesh_cells(m, kind);

    for (size_t i = 0; i < c.n; i++) {
      const uint32_t *node = c.node + i * (size_t)f->n_node;

      for (int k = 0; k < f->n_tri; k++, n++) {
        for (int j = 0; j < 3; j++) side[n].v[j] = node[f->node[k][j]];
        qsort(side[n].v, 3, sizeof *side[n].v, by_index);
        side[n].is_field = i >= n_layer[kind];
        side[n].volume = vg_cell_volume((const double(*)[3])m->point, kind,
                                        node);
      }
    }
  }
  return n;
}

/* The volume ratios at the tops equal those of a search for all pairs of a
 * layer cell and an isotropic cell. */
static void check_tops(const struct vg_mesh *m, const struct vg_join_info *info,
                       size_t n_face, double *ratio)
{
  const size_t n_layer[VG_SLICE_KINDS] = { info->n_layer_tet, info->n_layer_pyr,
                                           info->n_layer_pri,
                                           info->n_layer_hex };
  struct side *side = vg_alloc(4 * (m->n_tet + m->n_pyr + m->n_pri + m->n_hex),
                               sizeof *side);
  size_t n = list_sides(m, n_layer, side), n_top = 0;
  double *want = vg_calloc(n_face, sizeof *want);

  qsort(side, n, sizeof *side, by_points);
  for (size_t i = 1; i < n; i++) {
    const struct side *a = &side[i - 1], *b = &side[i];

    if (memcmp(a->v, b->v, sizeof a->v) || a->is_field == b->is_field ||
        !(a->volume > 0))
      continue;
    assert_true(n_top < n_face);
    want[n_top++] = a->volume > b->volume ? a->volume / b->volume
                                          : b->volume / a->volume;
  }
  qsort(want, n_face, sizeof *want, by_value);
  qsort(ratio, n_face, sizeof *ratio, by_value);
  for (size_t i = 0; i < n_face; i++)
    if (fabs(want[i] - ratio[i]) > 1e-9 * want[i])
      fail_msg("%zu of %zu: %.17g, not %.17g", i, n_face, ratio[i], want[i]);
  free(want);
  free(side);
}

static void add_tops(const struct vg_layer_slices *keep, size_t n_face,
                     double *sum)
{
  double *ratio = vg_alloc(n_face, sizeof *ratio);

  assert_int_equal(vg_layer_slices_tops(NULL, keep, ratio, NULL), VG_OK);
  for (size_t i = 0; i < n_face; i++) {
    assert_true(!ratio[i] || !sum[i]);
    sum[i] += ratio[i];
  }
  free(ratio);
}

/* --- flat cells ---------------------------------------------------------- */

/* The points of all cells outside the layers have the kinds that follow from
 * the ids of the front. */
static void check_kinds(const struct model *m, const struct vg_mesh *whole,
                        const struct vg_join_info *info,
                        struct vg_layer_slices *keep)
{
  static const enum vg_point_kind inner[4] = { VG_POINT_FIELD, VG_POINT_FIELD,
                                               VG_POINT_FIELD, VG_POINT_FIELD };
  const struct vg_front *f = &m->layers.front;
  uint8_t *is_wall = vg_calloc(f->n_point, 1);
  struct vg_flat *flat = NULL;

  for (size_t i = 0; i < 3 * f->n_face; i++)
    if (f->face_id[i / 3] != VG_NO_INDEX) is_wall[f->face[i / 3][i % 3]] = 1;
  assert_int_equal(vg_layer_slices_flat(keep, &flat, NULL), VG_OK);
  for (size_t i = 0; i < m->field.n_tet; i++) {
    const uint32_t *v = m->field.tet[i];
    const uint32_t *node = whole->tet[info->n_layer_tet + i];
    const double *const x[4] = { whole->point[node[0]], whole->point[node[1]],
                                 whole->point[node[2]], whole->point[node[3]] };
    struct vg_flat_class c = vg_flat_classify(flat, node, x, inner);

    for (int k = 0; k < 4; k++) {
      enum vg_point_kind want = VG_POINT_FIELD;

      if (v[k] < f->n_point)
        want = f->id[v[k]] == VG_LAYER_NEW ? VG_POINT_SLIDE
             : f->id[v[k]] >> 32           ? VG_POINT_TOP
             : is_wall[v[k]]               ? VG_POINT_WALL
                                           : VG_POINT_SURFACE;
      assert_int_equal(c.points.kind[k], want);
      assert_true((c.points.patch[k] == VG_NO_PATCH) ==
                  (want == VG_POINT_FIELD));
    }
  }
  vg_flat_free(flat);
  free(is_wall);
}

/* An isotropic region in n_piece pieces on `size` ranks with several threads,
 * compared with the whole mesh. Returns the number of slices of the layers. */
static size_t check_split(const struct model *m, const struct vg_mesh *whole,
                          const struct vg_join_info *info,
                          enum vg_layer_cells cells, size_t n_piece, int apart,
                          int size, int threads, int unevenly)
{
  struct check c;
  size_t n_slice = 0, n_face = m->layers.columns.n_face;
  double *top = vg_calloc(n_face, sizeof *top);

  check_start(&c, whole);
  for (int rank = 0; rank < size; rank++) {
    struct server server = { &m->field,
                             m->layers.front.n_point,
                             n_piece,
                             (size_t)rank,
                             (size_t)size,
                             apart,
                             0 };
    struct vg_slices field = serve(&server), s;
    struct vg_layer_slices *keep;
    struct vg_join_info again;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_layer_slices_open(&m->surface, &m->layers, &field, cells, rank, size,
                             threads, &s, &keep, &again, &err) < 0)
      fail_msg("%s", err.text);
    if (unevenly) share_unevenly(keep, size, &s);
    same_counts(whole, info, &s, &again);
    same_boundary(whole, s.boundary);
    c.s = &s;
    c.wrong = vg_calloc(s.n_slice, sizeof *c.wrong);
    vg_parallel_for(threads, s.n_slice, 1, compare_some, &c);
    for (size_t i = 0; i < s.n_slice; i++) assert_int_equal(c.wrong[i], 0);
    n_slice += s.n_slice - field.n_slice;
    add_tops(keep, n_face, top);
    check_kinds(m, whole, info, keep);
    free(c.wrong);
    vg_layer_slices_close(keep);
  }
  check_end(&c);
  check_tops(whole, info, n_face, top);
  free(top);
  return n_slice;
}

/* Every block of faces as a separate slice. */
static void check_blocks(const struct model *m, const struct vg_mesh *whole,
                         const struct vg_join_info *info,
                         enum vg_layer_cells cells)
{
  struct vg_join_plan plan;
  struct check c;
  const size_t n_layer[VG_SLICE_KINDS] = { info->n_layer_tet, info->n_layer_pyr,
                                           info->n_layer_pri,
                                           info->n_layer_hex };

  check_start(&c, whole);
  assert_int_equal(vg_join_plan_open(&plan, &m->surface, &m->layers,
                                     m->field.n_point - m->layers.front.n_point,
                                     cells, 1, NULL),
                   VG_OK);
  for (size_t b = 0; b < plan.expand.n_block; b++) {
    struct vg_layer_slice at = { .is_field = 0 };
    struct vg_slice s = { .n_point = 0 };

    assert_int_equal(vg_layer_slice_expand(&plan, b, b + 1, &at, &s, NULL),
                     VG_OK);
    assert_int_equal(compare(&c, &s), 0);
    free(at.x);
    free(at.id);
    free(at.own);
    for (int k = 0; k < VG_SLICE_KINDS; k++) free(at.cell[k]);
  }
  vg_join_plan_close(&plan);
  for (size_t i = info->n_boundary_point; i < info->n_layer_point; i++)
    assert_int_equal(c.point[i], 1);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    for (size_t i = 0; i < n_layer[k]; i++) assert_int_equal(c.cell[k][i], 1);
    free(c.cell[k]);
  }
  free(c.point);
}

/* On 1 to `most` ranks; returns the number of slices with all tetrahedra. */
static size_t check_model(const struct model *m, int most)
{
  size_t n_slice[3] = { 0, 0, 0 };

  for (int i = 0; i < 3; i++) {
    const enum vg_layer_cells cells = (enum vg_layer_cells)i;
    struct vg_mesh whole = VG_MESH_INIT;
    struct vg_join_info info;

    assert_int_equal(vg_layers_join(&m->surface, &m->layers, &m->field, cells,
                                    1, &whole, &info, NULL),
                     VG_OK);
    for (int size = 1; size <= most; size++)
      n_slice[i] = check_split(m, &whole, &info, cells, (size_t)(2 * size - 1),
                               size % 2, size, 1 + size % 3, i > 0);
    check_blocks(m, &whole, &info, cells);
    vg_mesh_release(&whole);
  }
  return n_slice[0];
}

/* --- cases --------------------------------------------------------------- */

static void roofs_with_fans(void **state)
{
  uint64_t seed = 11;
  int n_done = 0;

  (void)state;
  for (int i = 0; i < 60; i++) {
    struct model m;

    model_roof(&m, 2 + 2 * (i % 4), i % 3 ? 0 : 1 + i % ROOF_FAN, i % 7, &seed);
    model_front(&m);
    if (model_front_is_manifold(&m)) {
      model_field(&m);
      check_model(&m, 3);
      n_done++;
    }
    model_release(&m);
  }
  assert_true(n_done > 40);
}

/* Several slices of points without cells, and several runs of faces. */
static void many_slices(void **state)
{
  uint64_t seed = 3;
  struct model m;

  (void)state;
  model_sphere(&m, 66, 70, &seed);
  assert_true(m.surface.n_point > 16384);
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  assert_true(check_model(&m, 4) >= 4);
  model_release(&m);
}

static void slices_of_a_mesh_without_layers(void **state)
{
  uint64_t seed = 3;
  struct model m;

  (void)state;
  model_sphere(&m, 5, 0, &seed);
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  assert_int_equal(check_model(&m, 3), 1);
  vg_columns_release(&m.layers.columns);
  assert_int_equal(check_model(&m, 3), 1);
  model_release(&m);
}

/* Grown layers with fans and with patches remeshed around the side faces, and
 * an isotropic region. */
static void check_grown(struct model *m, double h)
{
  struct vg_layer_request request[16];
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;
  struct vg_fill_options fill = VG_FILL_OPTIONS_INIT;
  struct vg_layer_report report;
  struct vg_fill_report filled;
  struct vg_sizing *sizing = shape_sizing(&m->surface, 1.2, 0);
  struct vg_error err = VG_ERROR_INIT;

  assert_true(m->surface.n_patch <= 16);
  memset(request, 0, sizeof request);
  for (size_t p = 0; p < m->surface.n_patch; p++) {
    request[p].law = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
    request[p].law.delta1 = 1e-3 * h;
    request[p].is_wall = m->surface.patch[p].bc == CASE_WALL;
  }
  o.patch = request;
  o.fan_angle = 60;
  if (vg_layers_grow(&m->surface, sizing, &o, &m->layers, &report, &err) < 0)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
  sizing = shape_sizing(FRONT_MESH(&m->layers.front, &m->surface), 1.3, 0);
  if (fill_mesh(FRONT_MESH(&m->layers.front, &m->surface), sizing, &fill,
                &m->field, &filled, &err) < 0)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
  assert_true(m->field.n_point > m->layers.front.n_point);
  assert_true(m->layers.columns.n_border > 0);
  assert_true(report.n_virtual_face > 0);
  check_model(m, 3);
  model_release(m);
}

static void a_wedge_between_planes(void **state)
{
  struct model m = { .apex = 0 };

  (void)state;
  case_wedge(&m.surface, 0.1, 0.12);
  check_grown(&m, 0.1);
}

static void refusals(void **state)
{
  uint64_t seed = 4;
  struct model m;
  struct vg_slices s = { .n_slice = 77 }, field;
  struct vg_layer_slices *keep = NULL;
  struct vg_slice slice;
  struct vg_error err = VG_ERROR_INIT;
  struct server server = { .n_piece = 1, .size = 1 };

  (void)state;
  model_sphere(&m, 3, 2, &seed);
  server.m = &m.field;
  field = serve(&server);
  assert_int_equal(vg_layer_slices_open(&m.surface, &m.layers, &field,
                                        VG_LAYER_TETS, 0, 1, 1, &s, &keep, NULL,
                                        &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "does not fill"));
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  server.n_front = m.field.n_point;
  field = serve(&server);
  field.n_point += UINT32_MAX;
  assert_int_equal(vg_layer_slices_open(&m.surface, &m.layers, &field,
                                        VG_LAYER_TETS, 0, 1, 1, &s, &keep, NULL,
                                        &err),
                   VG_ERR_UNSUPPORTED);
  field.n_point -= UINT32_MAX;
  assert_int_equal(s.n_slice, 77);
  assert_null(keep);
  assert_int_equal(vg_layer_slices_open(&m.surface, &m.layers, &field,
                                        VG_LAYER_TETS, 0, 1, 1, &s, &keep, NULL,
                                        &err),
                   VG_OK);
  server.fails = 1;
  slice.n_point = 5;
  assert_int_equal(s.get(&s, s.n_slice - 1, &slice, &err), VG_ERR_MEMORY);
  assert_int_equal(slice.n_point, 5);
  vg_layer_slices_close(keep);
  vg_layer_slices_close(NULL);
  model_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(roofs_with_fans),
    cmocka_unit_test(many_slices),
    cmocka_unit_test(slices_of_a_mesh_without_layers),
    cmocka_unit_test(a_wedge_between_planes),
    cmocka_unit_test(refusals),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
