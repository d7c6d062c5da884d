/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Meshes for the tests of the mesh check in slices: valid ones, damaged ones,
 * and the isotropic region of a cut by itself. Header only. */
#ifndef TESTS_UNIT_JUDGE_SUPPORT_H
#define TESTS_UNIT_JUDGE_SUPPORT_H

#include <math.h>

#include "core/judge/judge_slices.h"
#include "core/judge/quality_parts.h"
#include "slices_support.h"

/* --- closing ------------------------------------------------------------- */

struct judge_side {
  uint32_t key[4], node[4];
};

static inline int judge_by_key(const void *a, const void *b)
{
  const struct judge_side *p = a, *q = b;

  for (int k = 0; k < 4; k++)
    if (p->key[k] != q->key[k]) return p->key[k] < q->key[k] ? -1 : 1;
  return 0;
}

static inline struct judge_side judge_side(const uint32_t *cell,
                                           const uint8_t *at, int n)
{
  struct judge_side s;

  s.key[3] = s.node[3] = VG_NO_NODE;
  for (int k = 0; k < n; k++) s.key[k] = s.node[k] = cell[at[k]];
  for (int i = 1; i < n; i++)
    for (int k = i; k > 0 && s.key[k - 1] > s.key[k]; k--) {
      uint32_t t = s.key[k];

      s.key[k] = s.key[k - 1];
      s.key[k - 1] = t;
    }
  return s;
}

/* The boundary: the faces that belong to one cell only, turned inwards. */
static inline void judge_close(struct vg_mesh *m)
{
  size_t n_cell = m->n_tet + m->n_pyr + m->n_pri + m->n_hex;
  struct judge_side *s = vg_alloc(6 * n_cell, sizeof *s);
  size_t n = 0;

  shape_need(s);
  for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
    struct vg_cells c = vg_mesh_cells(m, kind);
    const struct vg_cell_faces *f = &vg_cell_faces[kind];

    for (size_t i = 0; i < c.n; i++)
      for (int k = 0; k < f->n_face; k++)
        s[n++] = judge_side(c.node + i * (size_t)f->n_node, f->node[k],
                            k < f->n_tri ? 3 : 4);
  }
  qsort(s, n, sizeof *s, judge_by_key);
  m->tri = vg_alloc(n, sizeof *m->tri);
  m->quad = vg_alloc(n, sizeof *m->quad);
  shape_need(m->tri);
  shape_need(m->quad);
  for (size_t i = 0, j; i < n; i = j) {
    const uint32_t *v = s[i].node;

    for (j = i + 1; j < n && !judge_by_key(s + i, s + j); j++) {
    }
    if (j - i > 1) continue;
    if (v[3] == VG_NO_NODE) {
      for (int k = 0; k < 3; k++) m->tri[m->n_tri][k] = v[2 - k];
      m->n_tri++;
    } else {
      for (int k = 0; k < 4; k++) m->quad[m->n_quad][k] = v[3 - k];
      m->n_quad++;
    }
  }
  free(s);
}

/* --- meshes -------------------------------------------------------------- */

static inline struct vg_mesh judge_mesh(enum vg_layer_cells cells)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_join_info info;

  cut_mesh(&m, &info, cells);
  m.n_quad = 0; /* quadrilaterals are for writers only */
  return m;
}

/* A block of nx by ny by nz cubes, two prisms each, level by level. */
static inline struct vg_mesh judge_prisms(uint32_t nx, uint32_t ny, uint32_t nz)
{
  uint32_t row = nx + 1, level = row * (ny + 1);
  struct vg_mesh m = VG_MESH_INIT;

  m.pri = vg_alloc(2 * nx * ny * nz, sizeof *m.pri);
  shape_need(m.pri);
  for (uint32_t i = 0; i < level * (nz + 1); i++)
    shape_point(&m, i % row, 1.5 * (i / row % (ny + 1)),
                0.5 * (i / level) + 0.1 * (i % row));
  for (uint32_t c = 0; c < nx * ny * nz; c++) {
    uint32_t a = c % nx + row * (c / nx % ny) + level * (c / nx / ny);
    uint32_t tri[2][3] = { { a, a + 1, a + 1 + row },
                           { a, a + 1 + row, a + row } };

    for (int h = 0; h < 2; h++, m.n_pri++)
      for (int k = 0; k < 3; k++) {
        m.pri[m.n_pri][k] = tri[h][k];
        m.pri[m.n_pri][3 + k] = tri[h][k] + level;
      }
  }
  judge_close(&m);
  return m;
}

/* Remove level k from a block of n by n by n. */
static inline void judge_take_layer(struct vg_mesh *m, size_t n, size_t k)
{
  size_t each = 2 * n * n;

  memmove(m->pri + k * each, m->pri + (k + 1) * each,
          (m->n_pri - (k + 1) * each) * sizeof *m->pri);
  m->n_pri -= each;
}

/* --- damage -------------------------------------------------------------- */

#define JUDGE_DAMAGES 14

static inline void judge_swap(uint32_t *a, uint32_t *b)
{
  uint32_t t = *a;

  *a = *b;
  *b = t;
}

/* at: 0, 1, 2: different locations. */
static inline void judge_damage(struct vg_mesh *m, int damage, uint32_t at)
{
  size_t tet = (1 + at) * m->n_tet / 4, tri = (1 + at) * m->n_tri / 4;
  uint32_t point = m->tet[tet][0], *t;

  switch (damage) {
  case 0: /* a cell is missing */
    m->n_tet--;
    memmove(m->tet + tet, m->tet + tet + 1, (m->n_tet - tet) * sizeof *m->tet);
    break;
  case 1: judge_swap(&m->tet[tet][1], &m->tet[tet][2]); break;
  case 2: m->point[point][at] += 100; break;
  case 3: /* two points with equal coordinates, except for signs of 0 */
    memset(m->point[point], 0, sizeof *m->point);
    m->point[m->tet[tet][1]][0] = m->point[m->tet[tet][1]][1] = 0;
    m->point[m->tet[tet][1]][2] = -0.0;
    break;
  case 4: /* points without cells, three with equal coordinates */
    for (int k = 0; k < 3; k++) shape_point(m, 2, 2, 2 + (int)at);
    break;
  case 5: judge_swap(&m->tri[tri][0], &m->tri[tri][1]); break;
  case 6: m->n_tri -= 1 + at; break;
  case 7:
    m->tri[tri][2] = m->tri[tri][2] == point ? m->tet[tet][1] : point;
    break;
  case 8: memcpy(m->tri[tri], m->tri[tri + 1], sizeof *m->tri); break;
  case 9: /* a cell uses a wrong point */
    m->tet[tet][3] = m->tet[tet / 2][0];
    break;
  case 10: /* a duplicate cell, the copy among the last */
    memcpy(m->tet[m->n_tet - 1], m->tet[tet / 2], sizeof *m->tet);
    break;
  case 11: /* a boundary face between two cells, or twice */
    memcpy(m->tri[tri], m->tet[tet], sizeof *m->tri);
    if (at) memcpy(m->tri[tri + 1], m->tet[tet], sizeof *m->tri);
    break;
  case 12: /* a third cell on a face, in one slice or not */
    memcpy(m->tet[m->n_tet - 1], m->tet[at ? m->n_tet - 5 : tet / 2],
           3 * sizeof **m->tet);
    break;
  default: /* inverted prisms or tetrahedra */
    t = m->n_pri ? m->pri[m->n_pri / (2 + at)] : m->tet[tet / 2];
    judge_swap(&t[0], &t[1]);
    if (m->n_pri) judge_swap(&t[3], &t[4]);
  }
}

static inline size_t judge_faults(const struct vg_mesh_report *r)
{
  return r->bad_index + r->unused_point + r->not_finite + r->duplicate_point +
         r->not_positive + r->open_face + r->crowded_face + r->same_side_face +
         r->orphan_boundary + r->outward_boundary;
}

/* --- reports ------------------------------------------------------------- */

static inline void judge_same_solver(const struct vg_solver_quality *a,
                                     const struct vg_solver_quality *b)
{
  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_boundary_face, b->n_boundary_face);
  assert_true(a->angle_max == b->angle_max && a->angle_mean == b->angle_mean);
  assert_true(a->skewness_max == b->skewness_max);
  assert_true(a->weight_min == b->weight_min);
  assert_true(a->volume_ratio_min == b->volume_ratio_min);
  assert_true(a->determinant_min == b->determinant_min);
  assert_true(a->quality_min == b->quality_min);
  assert_true(a->quality_mean == b->quality_mean);
  assert_memory_equal(a, b, sizeof *a);
}

/* All figures, bit by bit. */
static inline void assert_same_report(const struct vg_mesh_report *a,
                                      const struct vg_mesh_report *b)
{
#define SAME(x)                                                                \
  do {                                                                         \
    if (memcmp(&a->x, &b->x, sizeof a->x))                                     \
      fail_msg("reports differ in " #x ": %.17g, %.17g", (double)a->x,         \
               (double)b->x);                                                  \
  } while (0)
#define SAME_LIST(x) assert_memory_equal(a->x, b->x, sizeof a->x)
  SAME(bad_index);
  SAME(unused_point);
  SAME(not_finite);
  SAME(duplicate_point);
  SAME(not_positive);
  SAME(open_face);
  SAME(crowded_face);
  SAME(same_side_face);
  SAME(orphan_boundary);
  SAME(outward_boundary);
  SAME(n_component);
  SAME(volume);
  SAME(enclosed);
  SAME(volume_error);
  SAME(is_valid);
  SAME(n_point);
  SAME(n_cell);
  SAME(n_inner_face);
  SAME(angle_min);
  SAME(angle_max);
  SAME(angle_min_p1);
  SAME_LIST(below);
  SAME_LIST(above);
  SAME(radius_ratio_mean);
  SAME(radius_ratio_min);
  SAME(mean_ratio_mean);
  SAME_LIST(volume_ratio);
  SAME_LIST(hist_angle_min);
  SAME_LIST(hist_angle_max);
  SAME_LIST(hist_radius_ratio);
  SAME(n_worst);
  assert_memory_equal(a->worst, b->worst, a->n_worst * sizeof *a->worst);
  SAME(has_sizing);
  SAME(edge_mean);
  SAME(edge_within);
  SAME_LIST(hist_edge);
  SAME(has_metric);
  SAME(metric.length_min);
  SAME(metric.length_max);
  SAME(metric.mean_ratio_mean);
  SAME(metric.mean_ratio_min);
  SAME(metric.complexity);
  assert_memory_equal(&a->metric, &b->metric, sizeof a->metric);
  /* A report on the field alone has none of these. */
  if (a->has_solver && b->has_solver) judge_same_solver(&a->solver, &b->solver);
  SAME(has_dual);
  if (a->has_dual) assert_memory_equal(&a->dual, &b->dual, sizeof a->dual);
#undef SAME
#undef SAME_LIST
}

/* --- the isotropic region of a cut --------------------------------------- */

static inline int judge_is_field(size_t g)
{
  return g % 4 != 0; /* the rule by which cut_get assigns kinds */
}

static inline uint32_t judge_point(const struct cut *c, struct vg_mesh *m,
                                   uint32_t *number, uint32_t p)
{
  const double *x = c->mesh->point[p];

  if (!number[p]) number[p] = shape_point(m, x[0], x[1], x[2]) + 1;
  return number[p] - 1;
}

/* The cells of slices without layers, as a mesh with its boundary. */
static inline struct vg_mesh judge_field(const struct cut *c)
{
  struct vg_mesh m = VG_MESH_INIT;
  uint32_t *number = vg_calloc(c->mesh->n_point, sizeof *number);
  uint32_t *to[VG_SLICE_KINDS];
  size_t *n[VG_SLICE_KINDS] = { &m.n_tet, &m.n_pyr, &m.n_pri, &m.n_hex };

  shape_need(number);
  m.tet = vg_alloc(c->mesh->n_tet, sizeof *m.tet);
  m.pyr = vg_alloc(c->mesh->n_pyr, sizeof *m.pyr);
  m.pri = vg_alloc(c->mesh->n_pri, sizeof *m.pri);
  m.hex = vg_alloc(c->mesh->n_hex, sizeof *m.hex);
  to[0] = (uint32_t *)m.tet;
  to[1] = (uint32_t *)m.pyr;
  to[2] = (uint32_t *)m.pri;
  to[3] = (uint32_t *)m.hex;
  for (size_t g = 0; g < c->n; g++)
    for (int kind = 0; kind < VG_SLICE_KINDS && judge_is_field(g); kind++) {
      size_t first = g ? c->end[g - 1][kind + 1] : 0;
      size_t width = vg_slice_width[kind];
      const uint32_t *from = cut_cells(c->mesh, kind);

      *n[kind] += c->end[g][kind + 1] - first;
      for (size_t i = width * first; i < width * c->end[g][kind + 1]; i++)
        *to[kind]++ = judge_point(c, &m, number, from[i]);
    }
  free(number);
  judge_close(&m);
  return m;
}

/* Numbers of the worst cells, from those in judge_field to those in all. */
static inline void judge_map_worst(const struct cut *c,
                                   struct vg_mesh_report *r)
{
  for (size_t k = 0; k < r->n_worst; k++) {
    size_t left = r->worst[k].cell, g = 0, first = 0;

    for (;; g++) {
      size_t n;

      first = g ? c->end[g - 1][1] : 0;
      n = c->end[g][1] - first;
      if (!judge_is_field(g)) continue;
      if (left < n) break;
      left -= n;
    }
    r->worst[k].cell = first + left;
  }
}

#endif
