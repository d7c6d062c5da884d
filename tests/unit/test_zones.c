/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones of random nestings: blocks in a cube of tetrahedra, inside each other,
 * touching in faces and edges, and cut by the sides of the cube. The sets of
 * cells that their faces connect are the zones. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "base/union_find.h"
#include "core/judge/quality.h"
#include "core/judge/zone_quality.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/copies.h"
#include "core/mesh/sheets.h"
#include "core/sides/inner.h"
#include "core/sides/zone_cells.h"
#include "io/stream/convention.h"

/* Planes of the cube, whose coordinates are rounded. */
#define FIRST 0.34
#define STEP 0.08

enum { N = 4, POINTS = (N + 1) * (N + 1) * (N + 1), TETS = 6 * N * N * N };

static uint64_t seed;

static unsigned draw(unsigned n)
{
  seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (unsigned)(seed >> 33) % n;
}

/* --- a cube of tetrahedra ---------------------------------------------------
 */

struct scene {
  struct vg_mesh cells;   /* points and tetrahedra */
  int label[N][N][N];     /* of blocks */
  uint32_t part[TETS];    /* connected sets of cells, by their lowest cells */
  struct vg_mesh surface; /* the sides of the cube, and interfaces */
};

static uint32_t point_of(int i, int j, int k)
{
  return (uint32_t)((k * (N + 1) + j) * (N + 1) + i);
}

/* Six tetrahedra along the diagonal of a cube, for the orders of the axes. */
static void fill_block(struct vg_mesh *m, int i, int j, int k)
{
  static const int order[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
                                   { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };

  for (int t = 0; t < 6; t++) {
    int at[3] = { i, j, k };

    for (int c = 0; c < 4; c++) {
      m->tet[m->n_tet][c] = point_of(at[0], at[1], at[2]);
      if (c < 3) at[order[t][c]]++;
    }
    m->n_tet++;
  }
}

static void fill_cube(struct vg_mesh *m)
{
  m->point = vg_alloc(POINTS, sizeof *m->point);
  m->tet = vg_alloc(TETS, sizeof *m->tet);
  for (int k = 0; k <= N; k++)
    for (int j = 0; j <= N; j++)
      for (int i = 0; i <= N; i++) {
        double *x = m->point[m->n_point++];

        x[0] = FIRST + STEP * i;
        x[1] = FIRST + STEP * j;
        x[2] = FIRST + STEP * k;
      }
  for (int k = 0; k < N; k++)
    for (int j = 0; j < N; j++)
      for (int i = 0; i < N; i++) fill_block(m, i, j, k);
  vg_mesh_turn_cells(m);
}

/* Blocks of labels, of which later ones cover earlier ones. */
static void choose_labels(struct scene *s)
{
  const unsigned n = 1 + draw(4);

  for (unsigned b = 1; b <= n; b++) {
    int lo[3], hi[3];

    for (int d = 0; d < 3; d++) {
      lo[d] = (int)draw(N);
      hi[d] = lo[d] + 1 + (int)draw((unsigned)(N - lo[d]));
    }
    for (int k = lo[2]; k < hi[2]; k++)
      for (int j = lo[1]; j < hi[1]; j++)
        for (int i = lo[0]; i < hi[0]; i++) s->label[k][j][i] = (int)b;
  }
}

/* --- its faces --------------------------------------------------------------
 */

struct face {
  uint32_t key[3];        /* nodes, ascending */
  uint32_t node[3], cell; /* the normal is into the cell */
};

static int by_key(const void *a, const void *b)
{
  const struct face *p = a, *q = b;
  const int order = memcmp(p->key, q->key, sizeof p->key);

  return order ? order : p->cell < q->cell ? -1 : p->cell > q->cell;
}

static size_t list_faces(const struct vg_mesh *m, struct face *list)
{
  size_t n = 0;

  for (uint32_t c = 0; c < m->n_tet; c++)
    for (int f = 0; f < 4; f++, n++) {
      list[n].cell = c;
      for (int k = 0; k < 3; k++)
        list[n].node[k] = m->tet[c][vg_tet_face[f][k]];
      memcpy(list[n].key, list[n].node, sizeof list->key);
      vg_order3(list[n].key);
    }
  qsort(list, n, sizeof *list, by_key);
  return n;
}

static int label_of(const struct scene *s, uint32_t cell)
{
  return (&s->label[0][0][0])[cell / 6];
}

static void add_face(struct vg_mesh *m, const uint32_t *node, uint32_t patch)
{
  memcpy(m->tri[m->n_tri], node, sizeof *m->tri);
  m->tri_patch[m->n_tri++] = patch;
}

/* Sides of the cube; interfaces between labels, with any orientation. */
static void make_surface(struct scene *s)
{
  struct face *list = vg_alloc(4 * TETS, sizeof *list);
  const size_t n = list_faces(&s->cells, list);
  struct vg_mesh *m = &s->surface;

  m->n_point = POINTS;
  m->point = vg_alloc(POINTS, sizeof *m->point);
  memcpy(m->point, s->cells.point, POINTS * sizeof *m->point);
  m->tri = vg_alloc(n, sizeof *m->tri);
  m->tri_patch = vg_alloc(n, sizeof *m->tri_patch);
  vg_mesh_add_patch(m, 1, "wall");
  vg_mesh_add_patch(m, 2, "face");
  for (uint32_t c = 0; c < TETS; c++) s->part[c] = c;
  for (size_t i = 0; i < n; i++) {
    const int is_pair = i + 1 < n &&
                        !memcmp(list[i].key, list[i + 1].key, sizeof list->key);
    const uint32_t a = list[i].cell, b = is_pair ? list[i + 1].cell : a;

    if (!is_pair) add_face(m, list[i].node, 0);
    else if (label_of(s, a) != label_of(s, b))
      add_face(m, list[i + draw(2)].node, 1);
    else vg_union(s->part, a, b);
    i += (size_t)is_pair;
  }
  for (uint32_t c = 0; c < TETS; c++) s->part[c] = vg_root_of(s->part, c);
  free(list);
}

/* is_split: with points of its own on each side of an interface. */
static vg_status double_faces(struct vg_mesh *m, int is_split,
                              struct vg_error *err)
{
  const uint8_t is_inner[3] = { 0, 1, 0 };
  const uint32_t back[3] = { 0, 2, 0 };
  struct vg_inner_report r;
  vg_status st;

  vg_mesh_add_patch(m, 3, "face_back");
  for (int i = 1; i < 3; i++) {
    m->patch[i].inner = i;
    m->patch[i].is_sheet = m->patch[i].is_interface = 1;
    m->patch[i].is_split = is_split;
  }
  st = vg_inner_double(m, is_inner, back, &r, err);
  if (st < 0) return st;
  assert_int_equal(r.n_cut, 0);
  if (!is_split) assert_int_equal(m->n_point, POINTS);
  return VG_OK;
}

/* Sides with points of their own have the points of the others when these are
 * joined. split: the surface before its faces were doubled */
static void join_sides(const struct scene *s, struct vg_mesh *split)
{
  const struct vg_mesh *m = &s->surface;
  uint32_t *same;

  assert_int_equal(double_faces(split, 1, NULL), VG_OK);
  assert_int_equal(vg_mesh_joined_points(split, &same, NULL), VG_OK);
  assert_int_equal(split->n_tri, m->n_tri);
  assert_true(split->n_point > POINTS || m->n_tri == 12 * N * N);
  for (size_t k = 0; k < 3 * m->n_tri; k++)
    assert_int_equal(same[split->tri[k / 3][k % 3]], m->tri[k / 3][k % 3]);
  free(same);
}

/* --- the mesh in slices ------------------------------------------------------
 */

enum { SLICES = 7 };

struct served {
  const struct scene *s;
  struct vg_mesh boundary;
  uint32_t id[POINTS];
};

static size_t first_of(size_t i)
{
  return TETS * i / SLICES;
}

static vg_status get(const struct vg_slices *s, size_t i, struct vg_slice *out,
                     struct vg_error *err)
{
  const struct served *v = s->user;

  (void)err;
  *out = (struct vg_slice){ .n_point = POINTS,
                            .x = (const double(*)[3])v->s->cells.point,
                            .id = v->id,
                            .n_own = i ? 0 : POINTS,
                            .own = v->id,
                            .cell_at = { first_of(i) },
                            .n_cell = { first_of(i + 1) - first_of(i) },
                            .cell = { (const uint32_t *)(v->s->cells.tet +
                                                         first_of(i)) } };
  return VG_OK;
}

static void put(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  (void)slice;
}

static void serve(const struct scene *s, struct served *v,
                  struct vg_slices *out)
{
  v->s = s;
  assert_int_equal(vg_mesh_copy(&v->boundary, &s->surface, NULL), VG_OK);
  free(v->boundary.point);
  v->boundary.point = NULL;
  v->boundary.n_point = 0;
  assert_int_equal(vg_mesh_part_sheets(&v->boundary, NULL), VG_OK);
  for (uint32_t p = 0; p < POINTS; p++) v->id[p] = p;
  *out = (struct vg_slices){ .n_point = POINTS,
                             .n_cell = { TETS },
                             .boundary = &v->boundary,
                             .n_slice = SLICES,
                             .n_served = TETS,
                             .get = get,
                             .put = put,
                             .user = v };
}

/* --- comparison -------------------------------------------------------------
 */

/* Cells of each zone are those of one set, in their order. Returns the number
 * of zones. */
static size_t compare(const struct scene *s, const struct vg_zone_map *map,
                      const struct vg_mesh *m)
{
  struct vg_zone_report *r;
  size_t at = 0, n_set = 0, n_bad;
  double x[3];

  for (uint32_t c = 0; c < TETS; c++) n_set += s->part[c] == c;
  assert_int_equal(m->n_zone, n_set);
  assert_int_equal(map->n, n_set);
  assert_int_equal(vg_zone_quality_judge(m, &r, NULL), VG_OK);
  for (size_t z = 0; z < m->n_zone; z++) {
    const size_t n = m->zone[z].n_cell[0];
    uint32_t part = 0;

    assert_true(n > 0 && r[z].n_cell == n);
    assert_float_equal(r[z].volume, map->volume[z], 1e-12);
    assert_float_equal(r[z].volume, (double)n / 6 * STEP * STEP * STEP, 1e-12);
    /* The edges of such a tetrahedron: three sides, two diagonals of squares,
     * and that of the cube. */
    assert_float_equal(r[z].edge_mean, STEP * (3 + 2 * sqrt(2) + sqrt(3)) / 6,
                       1e-7);
    assert_float_equal(r[z].edge_max, STEP * sqrt(3), 1e-12);
    while (memcmp(s->cells.tet[part], m->tet[at], sizeof *m->tet)) part++;
    part = s->part[part];
    for (uint32_t c = 0; c < TETS; c++)
      if (s->part[c] == part)
        assert_memory_equal(s->cells.tet[c], m->tet[at++], sizeof *m->tet);
  }
  assert_int_equal(at, TETS);
  assert_int_equal(vg_interfaces_judge(m, &n_bad, x, NULL), VG_OK);
  assert_int_equal(n_bad, 0);
  free(r);
  return n_set;
}

/* A triangle that is missing in an interface is a face between two zones. */
static void open_mesh(struct vg_mesh *m)
{
  size_t n;
  double x[3];

  assert_int_equal(vg_zone_faces_judge(m, &n, x, NULL), VG_OK);
  assert_int_equal(n, 0);
  if (!m->n_sheet_tri) return;
  m->n_sheet_tri--;
  assert_int_equal(vg_zone_faces_judge(m, &n, x, NULL), VG_OK);
  m->n_sheet_tri++;
  assert_int_equal(n, 1);
  for (int d = 0; d < 3; d++) {
    const uint32_t *v = m->sheet_tri[m->n_sheet_tri - 1];

    assert_float_equal(
      x[d], (m->point[v[0]][d] + m->point[v[1]][d] + m->point[v[2]][d]) / 3,
      1e-12);
  }
}

/* Places in cells, and the places at which zones are not known. */
static void ask_places(const struct scene *s, const struct vg_zone_map *map,
                       const struct vg_mesh *m)
{
  const double out[3] = { .3, .42, .42 }, far[3] = { .46, .52, 6.5 };
  uint64_t end = 0;
  size_t z = 0;

  for (size_t c = 0; c < TETS; c++) {
    double x[3] = { 0, 0, 0 };

    vg_mesh_zone_walk(m, 0, c, &z, &end);
    for (int k = 0; k < 4; k++)
      for (int d = 0; d < 3; d++) x[d] += m->point[m->tet[c][k]][d] / 4;
    assert_int_equal(vg_zone_map_at(map, x), z);
  }
  assert_int_equal(vg_zone_map_at(map, out), VG_ZONE_OUTSIDE);
  assert_int_equal(vg_zone_map_at(map, far), VG_ZONE_OUTSIDE);
  for (size_t t = 0; t < s->surface.n_tri; t++) {
    const uint32_t *v = s->surface.tri[t];

    assert_int_equal(vg_zone_map_at(map, s->surface.point[v[0]]), VG_ZONE_ON);
  }
}

/* Returns the number of zones, 0 if blocks touch in single points. */
static size_t run(uint64_t number)
{
  struct scene *s = vg_calloc(1, sizeof *s);
  struct served *v = vg_calloc(1, sizeof *v);
  struct vg_zone_map map = VG_ZONE_MAP_INIT;
  struct vg_zone_slices *keep = NULL;
  struct vg_mesh whole = VG_MESH_INIT, split = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_slices slices, sorted;
  size_t n = 0;

  seed = number;
  fill_cube(&s->cells);
  choose_labels(s);
  make_surface(s);
  assert_int_equal(vg_mesh_copy(&split, &s->surface, NULL), VG_OK);
  if (double_faces(&s->surface, 0, &err) == VG_OK) {
    join_sides(s, &split);
    assert_int_equal(vg_zone_map_new(&s->surface, &map, &err), VG_OK);
    serve(s, v, &slices);
    assert_int_equal(vg_zone_slices_open(NULL, &map, &slices, 1 + (int)draw(3),
                                         &sorted, &keep, &err),
                     VG_OK);
    assert_int_equal(vg_slices_collect(&sorted, 1, &whole, &err), VG_OK);
    n = compare(s, &map, &whole);
    open_mesh(&whole);
    ask_places(s, &map, &whole);
  } else assert_non_null(strstr(err.text, "single point"));
  vg_zone_slices_close(keep);
  vg_zone_map_release(&map);
  vg_mesh_release(&whole);
  vg_mesh_release(&split);
  vg_mesh_release(&v->boundary);
  vg_mesh_release(&s->surface);
  vg_mesh_release(&s->cells);
  free(s);
  free(v);
  return n;
}

static void random_nestings(void **state)
{
  size_t n_run = 0, most = 0;

  (void)state;
  for (uint64_t i = 1; i <= 120; i++) {
    const size_t n = run(i);

    n_run += n > 0;
    most = n > most ? n : most;
  }
  assert_true(n_run > 60 && most > 4);
}

/* --- tags --------------------------------------------------------------------
 */

static void zones_of_tags(void **state)
{
  static const int32_t tag[4] = { 9, -4, 9, 2 };
  static const uint32_t tet[4][4] = { { 0 }, { 1 }, { 2 }, { 3 } };
  struct vg_mesh m = { .n_tet = 4 };

  (void)state;
  m.tet = vg_alloc(4, sizeof *m.tet);
  memcpy(m.tet, tet, sizeof tet);
  assert_int_equal(vg_mesh_zones_from_tags(&m, tag, 0, NULL), VG_OK);
  assert_int_equal(m.n_zone, 3);
  assert_int_equal(m.zone[0].id, 1); /* of -4 */
  assert_int_equal(m.zone[1].id, 2);
  assert_int_equal(m.zone[2].id, 9);
  for (int i = 0; i < 4; i++)
    assert_int_equal(m.tet[i][0], ((int[4]){ 1, 3, 0, 2 })[i]);
  assert_int_equal(vg_mesh_zone_of(&m, 0, 1), 1);
  assert_int_equal(vg_mesh_zone_start(&m, 3, 0), 4);
  vg_mesh_drop_zones(&m);
  assert_int_equal(vg_mesh_zones_from_tags(&m, (int32_t[4]){ 5, 5, 5, 5 }, 0,
                                           NULL),
                   VG_OK);
  assert_int_equal(m.n_zone, 0);
  assert_int_equal(vg_mesh_zones_from_tags(&m, (int32_t[4]){ 5, 5, 5, 5 }, 1,
                                           NULL),
                   VG_OK);
  assert_int_equal(m.n_zone, 1);
  vg_mesh_release(&m);
}

/* --- interfaces that enclose nothing
 * ------------------------------------------ */

/* A block without one of its triangles. */
static void open_interface(void **state)
{
  struct scene *s = vg_calloc(1, sizeof *s);
  struct vg_zone_map map = VG_ZONE_MAP_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh *m = &s->surface;

  (void)state;
  seed = 7;
  fill_cube(&s->cells);
  s->label[1][1][1] = s->label[1][1][2] = 1;
  make_surface(s);
  for (size_t t = 0; t < m->n_tri; t++)
    if (m->tri_patch[t] == 1) {
      m->n_tri--;
      memmove(m->tri + t, m->tri + t + 1, (m->n_tri - t) * sizeof *m->tri);
      memmove(m->tri_patch + t, m->tri_patch + t + 1,
              (m->n_tri - t) * sizeof *m->tri_patch);
      break;
    }
  assert_int_equal(double_faces(m, 0, &err), VG_OK);
  assert_int_equal(vg_zone_map_new(m, &map, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "interface 2 face encloses no zone"));
  assert_non_null(strstr(err.text, "3 edges of interfaces are free"));
  assert_null(map.of);
  vg_mesh_release(&s->surface);
  vg_mesh_release(&s->cells);
  free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(random_nestings),
                                      cmocka_unit_test(zones_of_tags),
                                      cmocka_unit_test(open_interface) };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
