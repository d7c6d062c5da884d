/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A closed mesh of all kinds of cells for tests, made of columns of three
 * cubes. The lowest cube is a hexahedron; the middle one consists of five
 * pyramids around its centre and, on top, two tetrahedra; the highest of two
 * prisms. */
#ifndef VG_TESTS_MIXED_SUPPORT_H
#define VG_TESTS_MIXED_SUPPORT_H

#include "io_support.h"

/* Outward faces by kind, written independently of the library's tables; a
 * triangle repeats its last node. */
static const int mixed_width[4] = { 4, 5, 6, 8 };
static const int mixed_n_face[4] = { 4, 5, 5, 6 };
static const int mixed_face[4][6][4] = {
  { { 0, 2, 1, 1 }, { 0, 1, 3, 3 }, { 1, 2, 3, 3 }, { 0, 3, 2, 2 } },
  { { 0, 1, 4, 3 },
    { 0, 2, 1, 1 },
    { 1, 2, 4, 4 },
    { 4, 2, 3, 3 },
    { 3, 2, 0, 0 } },
  { { 0, 2, 1, 1 },
    { 3, 4, 5, 5 },
    { 0, 1, 4, 3 },
    { 1, 2, 5, 4 },
    { 2, 0, 3, 5 } },
  { { 0, 3, 2, 1 },
    { 4, 5, 6, 7 },
    { 0, 1, 5, 4 },
    { 1, 2, 6, 5 },
    { 2, 3, 7, 6 },
    { 3, 0, 4, 7 } }
};

static inline const uint32_t *mixed_cell(const struct vg_mesh *m, size_t cell,
                                         int *kind)
{
  const size_t n[4] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  const uint32_t *const list[4] = { (uint32_t *)m->tet, (uint32_t *)m->pyr,
                                    (uint32_t *)m->pri, (uint32_t *)m->hex };

  for (*kind = 0; cell >= n[*kind]; ++*kind) cell -= n[*kind];
  return list[*kind] + cell * (size_t)mixed_width[*kind];
}

static inline size_t mixed_n_cell(const struct vg_mesh *m)
{
  return m->n_tet + m->n_pyr + m->n_pri + m->n_hex;
}

struct mixed_side {
  uint32_t key[4], node[4];
};

static inline int mixed_by_key(const void *a, const void *b)
{
  return memcmp(((const struct mixed_side *)a)->key,
                ((const struct mixed_side *)b)->key,
                sizeof((const struct mixed_side *)a)->key);
}

static inline void mixed_sort(uint32_t *v, int n)
{
  for (int i = 1; i < n; i++)
    for (int k = i; k > 0 && v[k - 1] > v[k]; k--) {
      uint32_t t = v[k];

      v[k] = v[k - 1];
      v[k - 1] = t;
    }
}

static inline size_t mixed_sides(const struct vg_mesh *m,
                                 struct mixed_side **out)
{
  size_t n = 0;
  struct mixed_side *s = malloc(6 * mixed_n_cell(m) * sizeof *s);

  for (size_t c = 0; c < mixed_n_cell(m); c++) {
    int kind;
    const uint32_t *cell = mixed_cell(m, c, &kind);

    for (int f = 0; f < mixed_n_face[kind]; f++, n++) {
      const int *q = mixed_face[kind][f];

      for (int k = 0; k < 4; k++) s[n].node[k] = cell[q[k]];
      memcpy(s[n].key, s[n].node, sizeof s[n].key);
      if (q[2] == q[3]) s[n].node[3] = s[n].key[3] = UINT32_MAX;
      mixed_sort(s[n].key, 4);
    }
  }
  qsort(s, n, sizeof *s, mixed_by_key);
  *out = s;
  return n;
}

/* Boundary faces, inward: the sides that belong to one cell only. Patches 1:
 * below (lowest points), 2: above, 3: all other faces. */
static inline void mixed_close(struct vg_mesh *m, uint32_t below,
                               uint32_t above)
{
  struct mixed_side *s;
  size_t n = mixed_sides(m, &s);

  m->tri = malloc(n * sizeof *m->tri);
  m->quad = malloc(n * sizeof *m->quad);
  m->tri_patch = malloc(n * sizeof *m->tri_patch);
  m->quad_patch = malloc(n * sizeof *m->quad_patch);
  for (size_t i = 0, j; i < n; i = j) {
    const uint32_t *v = s[i].node;
    int width = v[3] == UINT32_MAX ? 3 : 4;
    uint32_t patch = s[i].key[width - 1] < below ? 0
                   : s[i].key[0] >= above        ? 1
                                                 : 2;

    for (j = i + 1; j < n && !mixed_by_key(s + i, s + j); j++) {
    }
    if (j - i == 2) continue;
    assert_int_equal(j - i, 1);
    if (width == 3) {
      for (int k = 0; k < 3; k++) m->tri[m->n_tri][k] = v[2 - k];
      m->tri_patch[m->n_tri++] = patch;
    } else {
      for (int k = 0; k < 4; k++) m->quad[m->n_quad][k] = v[3 - k];
      m->quad_patch[m->n_quad++] = patch;
    }
  }
  free(s);
}

static inline void mixed_fill_column(struct vg_mesh *m, const uint32_t v[16],
                                     uint32_t centre)
{
  static const int side[5][4] = { /* counter-clockwise seen from the centre */
                                  { 0, 1, 2, 3 },
                                  { 0, 4, 5, 1 },
                                  { 1, 5, 6, 2 },
                                  { 2, 6, 7, 3 },
                                  { 3, 7, 4, 0 }
  };
  const uint32_t *low = v + 4, *high = v + 8;

  memcpy(m->hex[m->n_hex++], v, 8 * sizeof *v);
  for (int f = 0; f < 5; f++) {
    uint32_t *p = m->pyr[m->n_pyr++];

    /* Slots 0 3 4 1 are the base, slot 2 is the apex. */
    p[0] = low[side[f][0]];
    p[3] = low[side[f][1]];
    p[4] = low[side[f][2]];
    p[1] = low[side[f][3]];
    p[2] = centre;
  }
  for (int half = 0; half < 2; half++) {
    uint32_t tri[3] = { 0, half ? 2u : 1u, half ? 3u : 2u };
    uint32_t *t = m->tet[m->n_tet++], *p = m->pri[m->n_pri++];

    for (int k = 0; k < 3; k++) {
      t[k] = high[tri[2 - k]];
      p[k] = high[tri[k]];
      p[3 + k] = high[4 + tri[k]];
    }
    t[3] = centre;
  }
}

/* Volume of mixed_make: the floor is a quadrilateral, half the product of its
 * diagonals; the height is 3. */
static inline double mixed_volume(double nx, double ny)
{
  return 3 * nx * ny * (1 + 0.025 * nx - 0.0025 * ny);
}

/* nx by ny columns, sheared so that no plane is normal to an axis except y = 0
 * and the lower and upper ends. Patches 11 "low end" (wall), 12 "top", 13
 * "". */
static inline void mixed_make(struct vg_mesh *m, uint32_t nx, uint32_t ny)
{
  uint32_t layer = (nx + 1) * (ny + 1), n = nx * ny, at = 4 * layer;

  memset(m, 0, sizeof *m);
  m->n_point = 4 * layer + n;
  m->point = malloc(m->n_point * sizeof *m->point);
  m->tet = malloc(2 * n * sizeof *m->tet);
  m->pyr = malloc(5 * n * sizeof *m->pyr);
  m->pri = malloc(2 * n * sizeof *m->pri);
  m->hex = malloc(n * sizeof *m->hex);
  for (uint32_t i = 0; i < 4 * layer; i++) {
    uint32_t x = i % layer % (nx + 1), y = i % layer / (nx + 1), z = i / layer;
    double *p = m->point[i];

    p[0] = x + 0.1 * y + 0.2 * z;
    p[1] = y * (1 + 0.05 * x);
    p[2] = z;
  }
  for (uint32_t y = 0; y < ny; y++)
    for (uint32_t x = 0; x < nx; x++, at++) {
      uint32_t v[16];

      for (uint32_t k = 0; k < 16; k++)
        v[k] = k / 4 * layer + (y + (k % 4 > 1)) * (nx + 1) + x +
               (k % 4 == 1 || k % 4 == 2);
      for (int d = 0; d < 3; d++) {
        m->point[at][d] = 0;
        for (int k = 4; k < 12; k++) m->point[at][d] += m->point[v[k]][d] / 8;
      }
      mixed_fill_column(m, v, at);
    }
  mixed_close(m, layer, 3 * layer);
  vg_mesh_add_patch(m, 11, "low end");
  vg_mesh_add_patch(m, 12, "top");
  vg_mesh_add_patch(m, 13, "");
  m->patch[0].bc = 4;
}

/* Points and cells are equal in every bit. The number of faces is equal; their
 * order may have been changed to that of the patches. */
static inline void mixed_same(const struct vg_mesh *a, const struct vg_mesh *b)
{
#define SAME(array, n)                                                         \
  (assert_int_equal(a->n, b->n),                                               \
   io_same_array(a->array, b->array, a->n, sizeof *a->array))
  SAME(point, n_point);
  SAME(tet, n_tet);
  SAME(pyr, n_pyr);
  SAME(pri, n_pri);
  SAME(hex, n_hex);
#undef SAME
  assert_int_equal(a->n_tri, b->n_tri);
  assert_int_equal(a->n_quad, b->n_quad);
  assert_int_equal(a->n_patch, b->n_patch);
}

#endif
