/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers and isotropic region in one mesh: conforming, positive, in order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/judge/quality.h"
#include "fill_support.h"
#include "join_support.h"

static double volume6(const struct vg_mesh *m, uint32_t a, uint32_t b,
                      uint32_t c, uint32_t d)
{
  const double *o = m->point[a];
  double u[3], v[3], w[3];

  for (int k = 0; k < 3; k++) {
    u[k] = m->point[b][k] - o[k];
    v[k] = m->point[c][k] - o[k];
    w[k] = m->point[d][k] - o[k];
  }
  return u[0] * (v[1] * w[2] - v[2] * w[1]) +
         u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Layer cells, or corners of them, without positive volume. */
static size_t count_flat(const struct vg_mesh *m,
                         const struct vg_join_info *info)
{
  static const uint8_t prism[6][4] = { { 0, 1, 2, 3 }, { 1, 2, 0, 4 },
                                       { 2, 0, 1, 5 }, { 3, 5, 4, 0 },
                                       { 4, 3, 5, 1 }, { 5, 4, 3, 2 } };
  static const uint8_t pyramid[4][4] = {
    { 0, 3, 4, 2 }, { 0, 4, 1, 2 }, { 0, 3, 1, 2 }, { 3, 4, 1, 2 }
  };
  static const uint8_t hex[8][4] = { { 0, 1, 3, 4 }, { 1, 2, 0, 5 },
                                     { 2, 3, 1, 6 }, { 3, 0, 2, 7 },
                                     { 4, 7, 5, 0 }, { 5, 4, 6, 1 },
                                     { 6, 5, 7, 2 }, { 7, 6, 4, 3 } };
  size_t n = 0;

  for (size_t i = 0; i < 8 * m->n_hex; i++) {
    const uint32_t *t = m->hex[i / 8];
    const uint8_t *c = hex[i % 8];

    n += !(volume6(m, t[c[0]], t[c[1]], t[c[2]], t[c[3]]) > 0);
  }
  for (size_t i = 0; i < info->n_layer_tet; i++) {
    const uint32_t *t = m->tet[i];

    n += !(volume6(m, t[0], t[1], t[2], t[3]) > 0);
  }
  for (size_t i = 0; i < 6 * m->n_pri; i++) {
    const uint32_t *t = m->pri[i / 6];
    const uint8_t *c = prism[i % 6];

    n += !(volume6(m, t[c[0]], t[c[1]], t[c[2]], t[c[3]]) > 0);
  }
  for (size_t i = 0; i < 4 * m->n_pyr; i++) {
    const uint32_t *t = m->pyr[i / 4];
    const uint8_t *c = pyramid[i % 4];

    n += !(volume6(m, t[c[0]], t[c[1]], t[c[2]], t[c[3]]) > 0);
  }
  return n;
}

/* Everything about the connectivity of cells; volumes of the cone are not
 * checked. */
static void assert_conforming(const struct vg_mesh *m, struct vg_mesh_report *r)
{
  assert_int_equal(vg_mesh_judge(m, NULL, r, NULL), VG_OK);
  assert_int_equal(r->bad_index, 0);
  assert_int_equal(r->not_finite, 0);
  assert_int_equal(r->unused_point, 0);
  assert_int_equal(r->duplicate_point, 0);
  assert_int_equal(r->open_face, 0);
  assert_int_equal(r->crowded_face, 0);
  assert_int_equal(r->same_side_face, 0);
  assert_int_equal(r->orphan_boundary, 0);
  assert_int_equal(r->outward_boundary, 0);
  /* sums of some thousand terms of order one */
  assert_true(r->volume_error < 1e-12);
}

/* Boundary points come first, and all of them are on the boundary. */
static void assert_boundary_first(const struct vg_mesh *m,
                                  const struct vg_join_info *info)
{
  uint8_t *on = vg_calloc(m->n_point, 1);

  for (size_t i = 0; i < 3 * m->n_tri; i++) on[m->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < 4 * m->n_quad; i++) on[m->quad[i / 4][i % 4]] = 1;
  for (size_t i = 0; i < m->n_point; i++)
    assert_int_equal(on[i], i < info->n_boundary_point);
  free(on);
}

/* Corners of a face in ascending order of their columns. */
static void rising_order(const uint32_t f[3], int order[3])
{
  for (int k = 0; k < 3; k++)
    order[(f[k] > f[(k + 1) % 3]) + (f[k] > f[(k + 2) % 3])] = k;
}

/* Tetrahedra made by the lift rule, without those that have a repeated
 * point. */
static size_t count_lifts(const struct vg_columns *c)
{
  size_t n = 0;

  for (size_t i = 0; i < c->n_face; i++) {
    uint32_t low[3], new = VG_NO_INDEX;
    int order[3];

    rising_order(c->face[i], order);
    for (int k = 0; k < 3; k++) low[k] = c->column[c->face[i][k]].root;
    for (int l = 0; l < VG_LEVELS_MAX; l++)
      for (int r = 0; r < 3; r++) {
        if (c->column[c->face[i][order[r]]].n <= l) continue;
        n += low[0] != low[1] && low[1] != low[2] && low[2] != low[0];
        low[order[r]] = new --;
      }
  }
  return n;
}

static void join_model(const struct model *m, enum vg_layer_cells cells,
                       int threads, struct vg_mesh *out,
                       struct vg_join_info *info)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_layers_join(&m->surface, &m->layers, &m->field, cells, threads, out,
                     info, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* Hexahedra of all models: in fans, and on walls. */
static size_t n_hexahedra, n_on_walls;

/* Pairs of wall triangles change the layers only, not their side faces or the
 * number of points on the boundary. Returns the number of layer cells without
 * volume. */
static size_t check_hex(const struct model *m, const struct vg_mesh *mixed,
                        const struct vg_join_info *before)
{
  struct vg_mesh hex = VG_MESH_INIT;
  struct vg_join_info info;
  struct vg_mesh_report r;
  uint64_t n;
  size_t n_flat, n_pair;

  join_model(m, VG_LAYER_HEX, 1, &hex, &info);
  assert_conforming(&hex, &r);
  assert_boundary_first(&hex, &info);
  assert_int_equal(vg_layers_count(&m->surface, &m->layers, VG_LAYER_HEX, 1, &n,
                                   NULL),
                   VG_OK);
  assert_int_equal(n, info.n_layer_tet + info.n_layer_pyr + info.n_layer_pri +
                        info.n_layer_hex);
  assert_int_equal(info.n_boundary_point, before->n_boundary_point);
  n_pair = info.n_layer_point - before->n_layer_point;
  assert_int_equal(hex.n_quad, mixed->n_quad + n_pair);
  assert_int_equal(hex.n_tri + 2 * n_pair, mixed->n_tri);
  assert_int_equal(hex.n_tet - info.n_layer_tet,
                   mixed->n_tet - before->n_layer_tet);
  assert_true(n_pair ? info.wall_quads > 0 : info.wall_quads == 0);
  n_flat = count_flat(&hex, &info);
  n_on_walls += hex.n_hex - mixed->n_hex;
  vg_mesh_release(&hex);
  return n_flat;
}

/* All expansions of one model; returns the number of their layer cells without
 * volume. */

static size_t check_model(const struct model *m)
{
  struct vg_mesh tets = VG_MESH_INIT, mixed = VG_MESH_INIT;
  struct vg_join_info a, b;
  struct vg_mesh_report r;
  size_t n_flat;

  join_model(m, VG_LAYER_TETS, 1, &tets, &a);
  join_model(m, VG_LAYER_MIXED, 1, &mixed, &b);
  assert_conforming(&tets, &r);
  assert_conforming(&mixed, &r);
  assert_boundary_first(&tets, &a);
  assert_boundary_first(&mixed, &b);
  assert_int_equal(a.n_layer_tet, count_lifts(&m->layers.columns));
  for (int k = 0; k < 2; k++) {
    const struct vg_join_info *info = k ? &b : &a;
    uint64_t n;

    assert_int_equal(vg_layers_count(&m->surface, &m->layers,
                                     k ? VG_LAYER_MIXED : VG_LAYER_TETS, 1, &n,
                                     NULL),
                     VG_OK);
    assert_int_equal(n, info->n_layer_tet + info->n_layer_pyr +
                          info->n_layer_pri + info->n_layer_hex);
  }
  assert_int_equal(tets.n_tet, a.n_layer_tet + m->field.n_tet);
  assert_int_equal(mixed.n_tet, b.n_layer_tet + m->field.n_tet);
  assert_int_equal(mixed.n_pyr, b.n_layer_pyr);
  assert_int_equal(mixed.n_pri, b.n_layer_pri);
  assert_int_equal(mixed.n_hex, b.n_layer_hex);
  assert_int_equal(tets.n_quad + tets.n_pyr + tets.n_pri, 0);
  assert_int_equal(tets.n_tri, mixed.n_tri + 2 * mixed.n_quad);
  assert_true(tets.n_point <= mixed.n_point); /* Middles of pairs. */
  if (tets.n_point == mixed.n_point)
    assert_memory_equal(tets.point, mixed.point,
                        tets.n_point * sizeof *tets.point);
  n_flat = count_flat(&tets, &a) + count_flat(&mixed, &b) +
           check_hex(m, &mixed, &b);
  n_hexahedra += mixed.n_hex;
  vg_mesh_release(&tets);
  vg_mesh_release(&mixed);
  return n_flat;
}

/* The cells of one level are those that vg_join_wall_cells lists. */
static void check_wall_cells(const struct model *m)
{
  const struct vg_columns *c = &m->layers.columns;
  struct vg_mesh mesh = VG_MESH_INIT;
  struct vg_join_info info;
  size_t n[7] = { 0 }, at[7] = { 0 };

  join_model(m, VG_LAYER_MIXED, 1, &mesh, &info);
  for (size_t i = 0; i < c->n_face; i++) {
    struct vg_wall_cell cell[3];
    int n_cell = vg_join_wall_cells(c, i, cell);

    for (int k = 0; k < n_cell; k++) {
      int size = cell[k].n_node;
      const uint32_t *node = size == 4 ? mesh.tet[at[4]++]
                           : size == 5 ? mesh.pyr[at[5]++]
                                       : mesh.pri[at[6]++];

      n[size]++;
      for (int j = 0; j < size; j++) {
        uint32_t local = cell[k].node[j];
        size_t column = c->face[i][local % 3];
        double x[2][3], d[VG_LEVELS_MAX + 1];

        vg_column_points(c, &m->surface, column, d, x);
        for (int a = 0; a < 3; a++)
          assert_true(mesh.point[node[j]][a] == x[local / 3][a]);
      }
    }
  }
  assert_int_equal(n[4], info.n_layer_tet);
  assert_int_equal(n[5], info.n_layer_pyr);
  assert_int_equal(n[6], info.n_layer_pri);
  vg_mesh_release(&mesh);
}

/* Without levels the boundary is the surface, in its order. */
static void check_nothing_grown(const struct model *m)
{
  struct vg_mesh mesh = VG_MESH_INIT;
  struct vg_join_info info;

  join_model(m, VG_LAYER_MIXED, 1, &mesh, &info);
  assert_int_equal(info.n_layer_tet + info.n_layer_pyr + info.n_layer_pri +
                     info.n_layer_hex,
                   0);
  assert_int_equal(info.n_layer_point, m->surface.n_point);
  assert_int_equal(mesh.n_tri, m->surface.n_tri);
  assert_memory_equal(mesh.tri, m->surface.tri, mesh.n_tri * sizeof *mesh.tri);
  assert_memory_equal(mesh.tri_patch, m->surface.tri_patch,
                      mesh.n_tri * sizeof *mesh.tri_patch);
  vg_mesh_release(&mesh);
}

static uint32_t one_side(const double x[3], const double y[3])
{
  (void)x;
  (void)y;
  return 0;
}

/* One ridge with fans of np and nq columns, and a wall triangle on each side.
 * order: indices of the ridge ends p, q and of the outer corners. */
static void make_ridge(struct model *m, int np, int nq, const int order[4],
                       uint32_t turn)
{
  static const double x[4][3] = {
    { -0.5, 0, 0 }, { 0.5, 0, 0 }, { 0.1, 1, -0.5 }, { -0.1, -1, -0.5 }
  };
  uint32_t fan[4][3];
  const int count[4] = { np, nq, 1, 1 };

  memset(m, 0, sizeof *m);
  vg_mesh_add_patch(&m->surface, 3, "side");
  vg_mesh_add_patch(&m->surface, 1, "wall");
  for (int i = 0; i < 4; i++) {
    int at = order[i];
    uint32_t root = shape_point(&m->surface, x[at][0], x[at][1], x[at][2]);

    for (int k = 0; k < count[at]; k++) {
      double s = count[at] > 1 ? k - (count[at] - 1) / 2.0 : 0;
      const double dir[3] = { 0.3 * x[at][0], at < 2 ? 0.4 * s : x[at][1] / 3,
                              1 };

      fan[at][k] = model_column(m, root, dir);
    }
  }
  model_wall(m, fan[0][np - 1], fan[1][nq - 1], fan[2][0]);
  model_wall(m, fan[1][0], fan[0][0], fan[3][0]);
  model_strip(m, fan[0], np, fan[1], nq, turn);
  model_rims(m, one_side);
  model_law(m, 0.01);
}

static void clear_front(struct model *m)
{
  vg_mesh_release(&m->field);
  vg_front_release(&m->layers.front);
}

/* Whether in each fan all columns rise, or none. Otherwise only two opposite
 * corners of a square of the strip may rise, which gives a cell without
 * volume. */
static int is_even(const struct vg_columns *c)
{
  for (size_t i = 1; i < c->n_column; i++)
    if (c->column[i].root == c->column[i - 1].root &&
        !c->column[i].n != !c->column[i - 1].n)
      return 0;
  return 1;
}

/* Levels 0, 1 and `high` in all combinations: neighbours may differ by any
 * number. */
static size_t all_levels(struct model *m, size_t high, size_t *n_flat)
{
  struct vg_columns *c = &m->layers.columns;
  size_t n = 1, n_done = 0, flat;

  for (size_t i = 0; i < c->n_column; i++) n *= 3;
  for (size_t code = 0; code < n; code++) {
    size_t rest = code;

    for (size_t i = 0; i < c->n_column; i++, rest /= 3)
      c->column[i].n = (uint16_t)(rest % 3 == 2 ? high : rest % 3);
    clear_front(m);
    model_front(m);
    if (!model_front_is_manifold(m)) continue;
    model_field(m);
    flat = check_model(m);
    if (is_even(c)) *n_flat += flat;
    n_done++;
  }
  return n_done;
}

static void a_ridge_in_all_configurations(void **state)
{
  static const int order[4][4] = {
    { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 1, 3, 0 }, { 3, 2, 0, 1 }
  };
  size_t n_done = 0, n_flat = 0;

  (void)state;
  for (int i = 0; i < 4; i++)
    for (int fans = 0; fans < 4; fans++)
      for (uint32_t turn = 0; turn < 3; turn++) {
        struct model m;
        int np = 1 + fans % 2, nq = 1 + fans / 2;

        /* nothing to choose if the strip has at most one triangle */
        if (turn != (fans < 3 ? 0 : (uint32_t)i % 3)) continue;
        make_ridge(&m, np, nq, order[i], turn);
        n_done += all_levels(&m, 2 + (size_t)i % 2, &n_flat);
        model_release(&m);
      }
  assert_true(n_done > 2000 && n_hexahedra > 10);
  assert_int_equal(n_flat, 0);
}

/* Thicker and more layers, on which pairs of wall triangles have a last level
 * of good shape. */
static void thicken(struct model *m, double delta1, unsigned more)
{
  for (size_t i = 0; i < m->layers.columns.n_column; i++)
    m->layers.columns.column[i].n += (uint16_t)more;
  m->layers.columns.law[0].delta1 = delta1;
  clear_front(m);
  model_front(m);
}

static void check_roofs(int n_each, double delta1, unsigned more, int n_model)
{
  uint64_t seed = 1;
  int n_done = 0;

  for (int i = 0; i < n_model; i++) {
    struct model m;
    size_t n_flat;

    model_roof(&m, 2 + 2 * (i % 4), n_each, i % 7, &seed);
    thicken(&m, delta1, more);
    if (model_front_is_manifold(&m)) {
      model_field(&m);
      n_flat = check_model(&m);
      if (i % 7 == 0 && !more) check_nothing_grown(&m);
      if (i % 7 == 1 && !more) check_wall_cells(&m); /* one level at most */
      /* different heights within a fan may twist its cells until they are
       * flat */
      if (n_each) assert_int_equal(n_flat, 0);
      n_done++;
    }
    model_release(&m);
  }
  assert_true(n_done > n_model * 3 / 4);
}

static void roofs_with_any_fans(void **state)
{
  (void)state;
  check_roofs(0, 0.001, 0, 150);
  n_on_walls = 0;
  check_roofs(0, 0.02, 3, 100);
  assert_true(n_on_walls > 1000);
}

static void roofs_with_equal_fans(void **state)
{
  (void)state;
  for (int n = 1; n <= ROOF_FAN; n++) check_roofs(n, 0.001, 0, 40);
}

static void fill_model(struct model *m)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_sizing *sizing = shape_sizing(FRONT_MESH(&m->layers.front,
                                                     &m->surface),
                                          1.5, 0);
  struct vg_fill_report report;
  struct vg_error err = VG_ERROR_INIT;

  if (fill_mesh(FRONT_MESH(&m->layers.front, &m->surface), sizing, &options,
                &m->field, &report, &err) != VG_OK)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
}

static void a_sphere_in_a_box(void **state)
{
  struct model m;
  struct vg_mesh mesh[3] = { VG_MESH_INIT, VG_MESH_INIT, VG_MESH_INIT };
  struct vg_join_info info[3];
  struct vg_mesh_report r[3];
  uint64_t seed = 5;

  (void)state;
  model_sphere(&m, 6, 6, &seed);
  thicken(&m, 0.03, 0);
  fill_model(&m);
  for (int i = 0; i < 3; i++) {
    join_model(&m, (enum vg_layer_cells)i, 1, &mesh[i], &info[i]);
    assert_conforming(&mesh[i], &r[i]);
    assert_true(r[i].is_valid);
    assert_int_equal(r[i].n_component, 1);
    assert_int_equal(count_flat(&mesh[i], &info[i]), 0);
    assert_int_equal(info[i].n_boundary_point, m.surface.n_point);
    assert_int_equal(mesh[i].n_patch, m.surface.n_patch);
    if (i == VG_LAYER_HEX) continue;
    /* the boundary is the surface, in its order */
    assert_int_equal(mesh[i].n_tri, m.surface.n_tri);
    assert_int_equal(mesh[i].n_quad, 0);
    assert_memory_equal(mesh[i].tri, m.surface.tri,
                        m.surface.n_tri * sizeof *mesh[i].tri);
    assert_memory_equal(mesh[i].tri_patch, m.surface.tri_patch,
                        m.surface.n_tri * sizeof *mesh[i].tri_patch);
  }
  assert_true(mesh[2].n_hex && mesh[2].n_quad);
  assert_int_equal(mesh[2].n_tri + 2 * mesh[2].n_quad, m.surface.n_tri);
  /* quadrilaterals are not plane, but the mean of their triangulations */
  assert_true(fabs(r[0].volume - r[2].volume) < 1e-2 * r[0].volume);
  assert_true(fabs(r[0].volume - r[1].volume) < 1e-12 * r[0].volume);
  assert_true(info[1].n_layer_pri > info[1].n_layer_pyr);
  for (int i = 0; i < 3; i++) vg_mesh_release(&mesh[i]);
  model_release(&m);
}

/* Points of a column are consecutive, and columns are ordered by their first
 * face. */
static void check_points(const struct model *m, const struct vg_mesh *mesh,
                         const struct vg_join_info *info)
{
  const struct vg_columns *c = &m->layers.columns;
  uint8_t *seen = vg_calloc(c->n_column, 1);
  size_t at = info->n_boundary_point;

  for (size_t i = 0; i < 3 * c->n_face; i++) {
    double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
    uint32_t column = c->face[i / 3][i % 3];
    size_t n = c->column[column].n;

    if (seen[column]++) continue;
    vg_column_points(c, &m->surface, column, d, x);
    if (n) assert_memory_equal(mesh->point[at], x[1], n * sizeof *x);
    at += n;
  }
  assert_int_equal(at, info->n_layer_point);
  free(seen);
}

/* The lift rule, coded independently. */
static void check_lifts(const struct model *m, const struct vg_mesh *mesh,
                        const struct vg_join_info *info)
{
  const struct vg_columns *c = &m->layers.columns;
  size_t n = 0;

  for (size_t i = 0; i < c->n_face; i++)
    for (size_t l = 0; l < 6; l++) {
      size_t rises = 0;

      for (int k = 0; k < 3; k++) rises += c->column[c->face[i][k]].n > l;
      for (size_t k = 0; k < rises; k++, n++) {
        uint32_t top = mesh->tet[n][3];
        double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
        int found = 0;

        for (int v = 0; v < 3; v++) {
          if (c->column[c->face[i][v]].n <= l) continue;
          vg_column_points(c, &m->surface, c->face[i][v], d, x);
          found |= !memcmp(mesh->point[top], x[l + 1], sizeof x[0]) &&
                   !memcmp(mesh->point[mesh->tet[n][v]], x[l], sizeof x[0]);
        }
        assert_true(found);
      }
    }
  assert_int_equal(n, info->n_layer_tet);
}

static void points_and_cells_in_order(void **state)
{
  struct model m;
  struct vg_mesh mesh = VG_MESH_INIT;
  struct vg_join_info info;
  uint64_t seed = 8;
  size_t n_point = 0;

  (void)state;
  model_sphere(&m, 5, 6, &seed);
  fill_model(&m);
  join_model(&m, VG_LAYER_TETS, 2, &mesh, &info);
  for (size_t k = 0; k < m.layers.columns.n_column; k++)
    n_point += m.layers.columns.column[k].n;
  assert_int_equal(info.n_layer_point, m.surface.n_point + n_point);
  check_points(&m, &mesh, &info);
  check_lifts(&m, &mesh, &info);
  vg_mesh_release(&mesh);
  model_release(&m);
}

static void same_array(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

/* Enough columns and faces for several chunks of both. */
static void any_number_of_threads(void **state)
{
  uint64_t seed = 3;
  struct model m;

  (void)state;
  model_sphere(&m, 40, 6, &seed);
  thicken(&m, 0.02, 2);
  assert_true(m.layers.columns.n_face > 6000);
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  for (int cells = VG_LAYER_TETS; cells <= VG_LAYER_HEX; cells++) {
    struct vg_mesh mesh[3] = { VG_MESH_INIT, VG_MESH_INIT, VG_MESH_INIT };
    struct vg_join_info info;

    for (int i = 0; i < 3; i++) {
      join_model(&m, (enum vg_layer_cells)cells, i + 1, &mesh[i], &info);
      assert_int_equal(mesh[i].n_tet, mesh[0].n_tet);
      assert_int_equal(mesh[i].n_pyr, mesh[0].n_pyr);
      assert_int_equal(mesh[i].n_pri, mesh[0].n_pri);
      assert_int_equal(mesh[i].n_point, mesh[0].n_point);
      assert_int_equal(mesh[i].n_hex, mesh[0].n_hex);
      assert_int_equal(mesh[i].n_quad, mesh[0].n_quad);
      same_array(mesh[0].hex, mesh[i].hex, mesh[0].n_hex, sizeof *mesh->hex);
      same_array(mesh[0].quad, mesh[i].quad, mesh[0].n_quad,
                 sizeof *mesh->quad);
      same_array(mesh[0].tet, mesh[i].tet, mesh[0].n_tet, sizeof *mesh->tet);
      same_array(mesh[0].pyr, mesh[i].pyr, mesh[0].n_pyr, sizeof *mesh->pyr);
      same_array(mesh[0].pri, mesh[i].pri, mesh[0].n_pri, sizeof *mesh->pri);
      same_array(mesh[0].point, mesh[i].point, mesh[0].n_point,
                 sizeof *mesh->point);
    }
    assert_true(cells != VG_LAYER_HEX || mesh[0].n_hex > 1000);
    for (int i = 0; i < 3; i++) vg_mesh_release(&mesh[i]);
  }
  model_release(&m);
}

static void refuses_layers_that_do_not_fit(void **state)
{
  uint64_t seed = 4;
  struct model m;
  struct vg_mesh mesh = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  model_sphere(&m, 3, 2, &seed);
  assert_int_equal(vg_layers_join(&m.surface, &m.layers, &m.field,
                                  VG_LAYER_TETS, 1, &mesh, NULL, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "does not fill"));
  assert_int_equal(vg_mesh_copy(&m.field,
                                FRONT_MESH(&m.layers.front, &m.surface), NULL),
                   VG_OK);
  model_column(&m, 0, (const double[3]){ 0, 0, 1 });
  m.layers.columns.column[7].n = 1;
  m.layers.columns.column[m.layers.columns.n_column - 1].n = 1;
  assert_int_equal(vg_layers_join(&m.surface, &m.layers, &m.field,
                                  VG_LAYER_TETS, 1, &mesh, NULL, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "no face"));
  m.layers.columns.column[7].n = VG_LEVELS_MAX + 1;
  assert_int_equal(vg_layers_join(&m.surface, &m.layers, &m.field,
                                  VG_LAYER_TETS, 1, &mesh, NULL, &err),
                   VG_ERR_INPUT);
  assert_null(mesh.point);
  model_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_ridge_in_all_configurations),
    cmocka_unit_test(roofs_with_any_fans),
    cmocka_unit_test(roofs_with_equal_fans),
    cmocka_unit_test(a_sphere_in_a_box),
    cmocka_unit_test(points_and_cells_in_order),
    cmocka_unit_test(any_number_of_threads),
    cmocka_unit_test(refuses_layers_that_do_not_fit),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
