/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cut planes of a void: planes at quantiles of the load, the regions of each
 * stage, and the walls that keep regions apart. */
#include "io_support.h"

#include "core/geometry/tensor.h"
#include "fill_shapes.h"
#include "partition/cut/lattice.h"
#include "tets_support.h"

struct scene {
  struct vg_sizing *sizing;
  struct vg_load load;
};

static void scene_of(struct scene *s, struct vg_mesh *m, double growth,
                     double h_max)
{
  const struct vg_front front = vg_front_of(m);

  s->load = (struct vg_load)VG_LOAD_INIT;
  s->sizing = shape_sizing(m, growth, h_max);
  assert_int_equal(vg_load_new(&front, s->sizing, VG_LOAD_CELLS_PER_CUBE, 1,
                               &s->load, NULL),
                   VG_OK);
  vg_mesh_release(m);
}

/* n spacings long, from -0.5 to 0.5. */
static void box_scene(struct scene *s, int n)
{
  struct vg_mesh m = VG_MESH_INIT;

  shape_box(&m, n, 0.5);
  scene_of(s, &m, 1.2, 1.0 / n);
}

static void block_scene(struct scene *s, int nx, int ny, int nz)
{
  const int n[3] = { nx, ny, nz };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { nx, ny, nz };
  struct vg_mesh m = VG_MESH_INIT;

  shape_block(&m, n, lo, hi, shape_all);
  scene_of(s, &m, 1.2, 1);
}

/* Cells are dense around the body, which is not in the middle. */
static void sphere_scene(struct scene *s)
{
  const double centre[3] = { 4, -3, 2 };
  struct vg_mesh m = VG_MESH_INIT;

  shape_box(&m, 6, 10);
  shape_sphere(&m, 10, centre, 1, 7);
  scene_of(s, &m, 1.2, 0);
}

static void scene_end(struct scene *s)
{
  vg_load_release(&s->load);
  vg_sizing_free(s->sizing);
}

/* The share of the cells below a plane. */
static double share_below(const struct vg_load *l, int axis, double at)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    const struct vg_load_octant *c = &l->octant[i];
    double part = 0.5 + (at - (double)c->at[axis]) / (2 * (double)c->half);

    sum += (double)c->cells * fmax(0, fmin(1, part));
  }
  return sum / l->cells;
}

static void planes_are(const struct vg_lattice *l, int x, int y, int z)
{
  if (l->n[0] != x || l->n[1] != y || l->n[2] != z)
    fail_msg("%d %d %d planes instead of %d %d %d", l->n[0], l->n[1], l->n[2],
             x, y, z);
}

/* --- planes -------------------------------------------------------------- */

/* The largest number of bisections that one cut makes: 8 blocks at least. */
static int most_of(const struct vg_load *load)
{
  const struct vg_cut_rule rule = { 0, -1, 0 };
  struct vg_lattice l;
  int most = vg_lattice_plan(load, &rule, 100, 0, &l);

  assert_in_range(most, 3, 6);
  return most;
}

static void levels_make_planes(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 };
  struct vg_lattice l;
  struct scene s;
  int most;

  (void)state;
  box_scene(&s, 48);
  most = most_of(&s.load);
  for (int levels = 0; levels <= 8; levels++) {
    int used = vg_lattice_plan(&s.load, &rule, levels, 0, &l), blocks = 1;

    assert_int_equal(used, levels < most ? levels : most);
    for (int axis = 0; axis < 3; axis++) blocks *= l.n[axis] + 1;
    assert_int_equal(blocks, 1 << used);
    if (levels == 3) planes_are(&l, 1, 1, 1);
    if (used == 6) planes_are(&l, 3, 3, 3);
  }
  scene_end(&s);
}

/* In ascending order, with an equal share of the cells between them. */
static void planes_are_at_quantiles(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 };

  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    struct vg_lattice l;
    struct scene s;
    int n = 0;

    if (kind) sphere_scene(&s);
    else box_scene(&s, 48);
    assert_true(vg_lattice_plan(&s.load, &rule, 6, 0, &l) >= 3);
    for (int axis = 0; axis < 3; axis++)
      for (int k = 0; k < l.n[axis]; k++, n++) {
        double want = (k + 1.0) / (l.n[axis] + 1);

        /* quantiles are read from octants in single precision */
        assert_true(fabs(share_below(&s.load, axis, l.at[axis][k]) - want) <
                    1e-3);
        assert_true(!k || l.at[axis][k] > l.at[axis][k - 1]);
      }
    assert_true(n >= 3);
    if (!kind) assert_true(fabs(l.at[0][l.n[0] / 2]) < 0.02);
    scene_end(&s);
  }
}

/* Parallel planes need space for their separator zones: ten spacings. */
static void planes_keep_their_distance(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 }, along = { 0, 2, 1 };
  struct vg_lattice l;
  struct scene s;

  (void)state;
  box_scene(&s, 24); /* a quarter of it is 6 */
  assert_int_equal(vg_lattice_plan(&s.load, &rule, 6, 0, &l), 3);
  planes_are(&l, 1, 1, 1);
  scene_end(&s);
  block_scene(&s, 6, 6, 32);
  assert_int_equal(vg_lattice_plan(&s.load, &along, 6, 0, &l), 1);
  planes_are(&l, 0, 0, 1);
  scene_end(&s);
  block_scene(&s, 6, 6, 60);
  assert_int_equal(vg_lattice_plan(&s.load, &along, 6, 0, &l), 2);
  planes_are(&l, 0, 0, 3);
  for (int k = 0; k < 2; k++) assert_true(l.at[2][k + 1] - l.at[2][k] >= 10);
  scene_end(&s);
}

/* A long block is cut across its length. */
static void the_cheapest_axis_is_cut(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 };
  static const int size[3][3] = { { 40, 8, 12 }, { 12, 40, 8 }, { 8, 12, 40 } };

  (void)state;
  for (int axis = 0; axis < 3; axis++) {
    struct vg_lattice l;
    struct scene s;

    block_scene(&s, size[axis][0], size[axis][1], size[axis][2]);
    assert_int_equal(vg_lattice_plan(&s.load, &rule, 1, 0, &l), 1);
    planes_are(&l, axis == 0, axis == 1, axis == 2);
    assert_true(fabs(l.at[axis][0] - 20) < 0.5);
    scene_end(&s);
  }
}

static void an_axis_can_be_requested(void **state)
{
  struct scene s;

  (void)state;
  block_scene(&s, 50, 14, 46);
  for (int axis = 0; axis < 3; axis++) {
    struct vg_cut_rule rule = { 0, axis, 0 };
    struct vg_lattice l;

    assert_int_equal(vg_lattice_plan(&s.load, &rule, 1, 0, &l), 1);
    planes_are(&l, axis == 0, axis == 1, axis == 2);
    assert_int_equal(vg_lattice_plan(&s.load, &rule, 3, 0, &l), 3);
    assert_true(l.n[axis] > 0);
    rule.constant = 1;
    assert_int_equal(vg_lattice_plan(&s.load, &rule, 6, 0, &l),
                     axis == 1 ? 1 : 2);
    planes_are(&l, axis == 0 ? 3 : 0, axis == 1, axis == 2 ? 3 : 0);
  }
  scene_end(&s);
}

/* A void is cut if it is expected to have more cells than a leaf should have,
 * with some tolerance: by one plane at a time if few leaves result, else by all
 * the planes that make them. */
static void leaves_have_their_size(void **state)
{
  static const struct {
    double leaves;
    int planes;
  } is[] = { { 1, 0 }, { 1.2, 0 }, { 1.3, 1 }, { 2, 1 },
             { 4, 1 }, { 12, 1 },  { 64, 1 },  { 90, 6 } };
  struct vg_lattice l;
  struct scene s;

  (void)state;
  box_scene(&s, 48);
  for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
    struct vg_cut_rule rule = { s.load.cells / is[k].leaves, -1, 0 };

    assert_int_equal(vg_lattice_plan(&s.load, &rule, 0, 0, &l), is[k].planes);
  }
  scene_end(&s);
}

/* Each further attempt is a single plane at a different position. */
static void attempts_differ(void **state)
{
  const struct vg_cut_rule rule = { 0, 2, 0 };
  double at[5];
  struct scene s;

  (void)state;
  box_scene(&s, 48);
  for (int k = 0; k < 5; k++) {
    struct vg_lattice l;

    assert_int_equal(vg_lattice_plan(&s.load, &rule, k ? 6 : 1, k, &l), 1);
    planes_are(&l, 0, 0, 1);
    at[k] = l.at[2][0];
    assert_true(fabs(at[k]) < 0.2);
    for (int j = 0; j < k; j++) assert_true(fabs(at[k] - at[j]) > 1.0 / 48);
  }
  scene_end(&s);
}

static void nothing_to_cut(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 }, small = { 1e9, -1, 0 };
  const struct vg_load empty = VG_LOAD_INIT;
  struct vg_lattice l;
  struct scene s;

  (void)state;
  box_scene(&s, 8);
  assert_int_equal(vg_lattice_plan(&s.load, &small, 6, 0, &l), 0);
  planes_are(&l, 0, 0, 0);
  for (int stage = 0; stage < VG_LATTICE_STAGES; stage++)
    assert_int_equal(vg_lattice_count(&l, stage), 0);
  assert_int_equal(vg_lattice_plan(&empty, &rule, 6, 0, &l), 0);
  planes_are(&l, 0, 0, 0);
  scene_end(&s);
}

/* --- ribs ---------------------------------------------------------------- */

static void ribs_for(const struct scene *s, double leaf_cells,
                     struct vg_lattice *l)
{
  const struct vg_cut_rule rule = { leaf_cells, -1, 0 };
  struct vg_error err = VG_ERROR_INIT;

  vg_lattice_release(l);
  if (vg_lattice_add_ribs(&s->load, &rule, l, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* One plane across z, with ribs as for leaves of half its size. */
static void one_plane(const struct scene *s, struct vg_lattice *l)
{
  const struct vg_cut_rule rule = { s->load.cells / 2, 2, 0 };

  assert_int_equal(vg_lattice_plan(&s->load, &rule, 0, 0, l), 1);
  planes_are(l, 0, 0, 1);
  ribs_for(s, s->load.cells / 2, l);
}

/* 12 cells per square of a plane, 12,000 per piece. A rib counts as 25 cells
 * per edge of its length, and the ribs of a tile may have 12 % of its cells. */
static void large_tiles_are_divided(void **state)
{
  static const struct {
    int nx, ny, pieces;
  } is[] = {
    { 32, 32, 1 }, { 64, 64, 4 }, { 60, 20, 1 }, { 200, 16, 3 }, { 16, 120, 2 }
  };

  (void)state;
  for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
    struct vg_lattice l;
    struct scene s;

    block_scene(&s, is[k].nx, is[k].ny, 12);
    one_plane(&s, &l);
    if (l.n_rib + 1 != is[k].pieces)
      fail_msg("%d x %d: %d pieces instead of %d", is[k].nx, is[k].ny,
               l.n_rib + 1, is[k].pieces);
    for (int i = 0; i < l.n_rib; i++) {
      int across = is[k].ny > is[k].nx;
      double length = across ? is[k].ny : is[k].nx;

      assert_int_equal(l.rib[i].tile, 0);
      if (is[k].nx != is[k].ny) assert_true(l.rib[i].plane.normal[across] == 1);
      /* shares of octants of up to 3 spacings, counted by their middles */
      if (fabs(l.rib[i].plane.offset - length * (i + 1) / is[k].pieces) > 3)
        fail_msg("rib %d of %d x %d is at %g", i, is[k].nx, is[k].ny,
                 l.rib[i].plane.offset);
    }
    vg_lattice_release(&l);
    scene_end(&s);
  }
}

/* A piece has a fifth of a leaf's cells, from 4,000 to 12,000. */
static void small_leaves_have_small_pieces(void **state)
{
  static const struct {
    double leaf;
    int pieces;
  } is[] = { { 0, 3 },     { 1e6, 3 },   { 60000, 3 }, { 40000, 5 },
             { 32000, 6 }, { 20000, 8 }, { 5000, 8 } };
  struct vg_lattice l;
  struct scene s;

  (void)state;
  block_scene(&s, 200, 16, 12);
  one_plane(&s, &l);
  for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
    ribs_for(&s, is[k].leaf, &l);
    if (l.n_rib + 1 != is[k].pieces)
      fail_msg("leaves of %g: %d pieces instead of %d", is[k].leaf, l.n_rib + 1,
               is[k].pieces);
  }
  vg_lattice_release(&l);
  scene_end(&s);
}

static void small_tiles_stay_whole(void **state)
{
  struct vg_lattice l;
  struct scene s;

  (void)state;
  sphere_scene(&s);
  one_plane(&s, &l);
  assert_int_equal(l.n_rib, 0);
  scene_end(&s);
}

/* --- regions ------------------------------------------------------------- */

static const struct vg_lattice two = { .n = { 1, 1, 1 },
                                       .at = { { 0.1 }, { -0.2 }, { 0.15 } } };
static const struct vg_lattice once = { .n = { 1, 1, 1 },
                                        .lines_at_once = 1,
                                        .at = { { 0.1 }, { -0.2 }, { 0.15 } } };
static const struct vg_lattice four = {
  .n = { 3, 3, 3 },
  .at = { { -0.5, 0.1, 0.45 }, { -0.6, -0.2, 0.5 }, { -0.4, 0, 0.55 } }
};
static const struct vg_lattice flat = {
  .n = { 2, 1, 0 }, .at = { { -0.3, 0.4 }, { 0.1 }, { 0 } }
};
/* Tiles in pieces: one of `flat`'s divided by two parallel ribs, and one by a
 * fan of ribs. */
static const struct vg_lattice ribbed = {
  .n = { 2, 1, 0 },
  .at = { { -0.3, 0.4 }, { 0.1 }, { 0 } },
  .n_rib = 4,
  .rib = (struct vg_rib[]){ { 1, { { 0, 0, 1 }, -0.5 } },
                            { 1, { { 0, 0, 1 }, 0.4 } },
                            { 3, { { 0, -0.6, 0.8 }, -0.86 } },
                            { 3, { { 0, -0.8, 0.6 }, -0.68 } } }
};
static const struct vg_lattice row = {
  .n = { 0, 7, 0 }, .at = { { 0 }, { -.6, -.4, -.2, 0, .2, .4, .6 }, { 0 } }
};

static void counts_are(const struct vg_lattice *l, size_t lines,
                       size_t segments, size_t tiles)
{
  assert_int_equal(vg_lattice_count(l, 0), lines);
  assert_int_equal(vg_lattice_count(l, 1), segments);
  assert_int_equal(vg_lattice_count(l, 2), l->n_rib);
  assert_int_equal(vg_lattice_count(l, VG_LATTICE_TILES),
                   tiles + (size_t)l->n_rib);
}

static void numbers_of_regions(void **state)
{
  (void)state;
  counts_are(&two, 1, 4, 12);
  counts_are(&once, 6, 0, 12);
  counts_are(&four, 9, 72, 144);
  counts_are(&flat, 2, 0, 7);
  counts_are(&row, 0, 0, 7);
  counts_are(&ribbed, 2, 0, 7);
}

static double length_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Planes of the lattice, along the expected axes; unit normals. */
static void is_well_made(const struct vg_lattice *l, int stage, int axis,
                         const struct vg_region *r)
{
  int is_tile = stage == VG_LATTICE_TILES, is_rib = stage == 2;

  assert_int_equal(r->n_plane, is_tile ? 1 : 2);
  assert_in_range(r->n_wall, 0, VG_REGION_WALLS);
  assert_true(is_tile || is_rib ? r->reach >= 0 : r->reach > 0);
  assert_in_range(axis, 0, 2);
  for (int i = 0; i < (is_rib ? 1 : r->n_plane); i++) {
    int across = -1, found = 0;

    assert_true(fabs(length_of(r->plane[i].normal) - 1) < 1e-15);
    for (int k = 0; k < 3; k++)
      if (r->plane[i].normal[k] != 0) across = k;
    assert_true(across >= 0 && (across == axis) == (is_tile || is_rib));
    for (int k = 0; k < l->n[across]; k++)
      found |= l->at[across][k] == r->plane[i].offset;
    assert_true(found);
  }
  if (!is_tile)
    for (int k = 0; k < 3; k++)
      assert_true(r->plane[0].normal[k] * r->plane[1].normal[k] == 0);
  for (int i = 0; i < r->n_wall; i++)
    assert_true(fabs(length_of(r->wall[i].normal) - 1) < 1e-12);
}

/* Number of regions of the stage that have x within their walls. hit:
 * counts. */
static int owners(size_t n, const struct vg_region *r, const double x[3],
                  size_t *hit)
{
  int sum = 0;

  for (size_t k = 0; k < n; k++) {
    if (!vg_region_within(&r[k], x)) continue;
    hit[k]++;
    sum++;
  }
  return sum;
}

/* A random point; half of them on or near planes, where walls meet. */
static void sample(const struct vg_lattice *l, uint64_t *seed, double x[3])
{
  for (int k = 0; k < 3; k++) {
    x[k] = 2 * tets_random(seed) - 1;
    if (l->n[k] && tets_random(seed) < 0.5) {
      int i = (int)(tets_random(seed) * l->n[k]);

      x[k] = l->at[k][i] + 0.1 * (tets_random(seed) - 0.5);
      if (tets_random(seed) < 0.3) x[k] = l->at[k][i];
    }
  }
}

static void walls_keep_apart(const struct vg_lattice *l)
{
  uint64_t seed = 5;

  for (int stage = 0; stage < VG_LATTICE_STAGES; stage++) {
    size_t n = vg_lattice_count(l, stage);
    struct vg_region *r = vg_calloc(n, sizeof *r);
    size_t *hit = vg_calloc(n, sizeof *hit);

    assert_true(r && hit);
    for (size_t k = 0; k < n; k++)
      is_well_made(l, stage, vg_lattice_region(l, stage, k, &r[k]), &r[k]);
    for (int i = 0; i < 40000; i++) {
      double x[3];

      sample(l, &seed, x);
      assert_true(owners(n, r, x, hit) <= 1);
    }
    for (size_t k = 0; k < n; k++) assert_true(hit[k] > 0);
    free(r);
    free(hit);
  }
}

static int is_on(const struct vg_region *r, const double x[3])
{
  double foot[3], off = 0;

  vg_region_foot(r, x, foot);
  for (int k = 0; k < 3; k++) off = fmax(off, fabs(foot[k] - x[k]));
  return off < 1e-12;
}

static int is_on_tile(const struct vg_lattice *l, int tile, const double x[3])
{
  struct vg_lattice whole = *l;
  struct vg_region r;

  whole.n_rib = 0;
  vg_lattice_region(&whole, VG_LATTICE_TILES, (size_t)tile, &r);
  return is_on(&r, x) && vg_region_within(&r, x);
}

/* Where the planes of a region meet, some region contains the point: the whole
 * plane is cut, and cells are grown along the whole line. Only for points
 * between crossings. */
static void nothing_is_left_out(const struct vg_lattice *l)
{
  uint64_t seed = 9;

  for (int stage = 0; stage < VG_LATTICE_STAGES; stage++) {
    size_t n = vg_lattice_count(l, stage);
    struct vg_region *r = vg_calloc(n, sizeof *r);

    assert_non_null(r);
    for (size_t k = 0; k < n; k++) vg_lattice_region(l, stage, k, &r[k]);
    for (int i = 0; i < 4000 && n; i++) {
      size_t found = 0, of = (size_t)(tets_random(&seed) * (double)n);
      double x[3], foot[3];

      for (int k = 0; k < 3; k++) x[k] = 2 * tets_random(&seed) - 1;
      vg_region_foot(&r[of], x, foot);
      if (stage == 2 && !is_on_tile(l, l->rib[of].tile, foot)) continue;
      for (size_t k = 0; k < n; k++) {
        found += is_on(&r[k], foot) && vg_region_within(&r[k], foot);
      }
      assert_int_equal(found, 1);
    }
    free(r);
  }
}

static void regions_are_disjoint_and_complete(void **state)
{
  const struct vg_lattice *all[6] = {
    &two, &once, &four, &flat, &row, &ribbed
  };

  (void)state;
  for (int k = 0; k < 6; k++) {
    walls_keep_apart(all[k]);
    nothing_is_left_out(all[k]);
  }
}

/* --- blocks and patches -------------------------------------------------- */

/* A block's number is the sum of the steps of all planes below its point, x
 * first. A point on a plane is in the block below or, if the upper one is
 * requested, above. */
static void points_have_blocks(void **state)
{
  uint64_t seed = 3;

  (void)state;
  assert_int_equal(vg_lattice_blocks(&four), 64);
  assert_int_equal(vg_lattice_blocks(&flat), 6);
  for (int i = 0; i < 1000; i++) {
    uint32_t want[2] = { 0, 0 }, step = 1;
    double x[3];

    sample(&four, &seed, x);
    for (int axis = 0; axis < 3; axis++, step *= 4)
      for (int k = 0; k < 3; k++) {
        want[0] += step * (x[axis] > four.at[axis][k]);
        want[1] += step * (x[axis] >= four.at[axis][k]);
      }
    assert_int_equal(vg_lattice_block(&four, x, 0), want[0]);
    assert_int_equal(vg_lattice_block(&four, x, 1), want[1]);
  }
}

/* A patch of a region is on its plane and ends with the box, and midway to the
 * next plane: patches of neighbouring boxes do not overlap. */
static void patches_end_with_their_box(void **state)
{
  const double lo[3] = { -0.2, -0.3, 0.1 }, hi[3] = { 0.4, 0.3, 0.6 };
  struct vg_region r;
  uint64_t seed = 4;

  (void)state;
  for (int i = 0; i < 3; i++) {
    vg_lattice_patch(&four, 1, i, lo, hi, &r);
    assert_int_equal(r.n_plane, 1);
    assert_true(r.plane[0].normal[1] == 1 &&
                r.plane[0].offset == four.at[1][i]);
    for (int n = 0; n < 1000; n++) {
      double x[3];
      int in;

      for (int k = 0; k < 3; k++) x[k] = 2 * tets_random(&seed) - 1;
      in = x[0] > lo[0] && x[0] < hi[0] && x[2] > lo[2] && x[2] < hi[2] &&
           (i == 0 || x[1] > 0.5 * (four.at[1][i - 1] + four.at[1][i])) &&
           (i == 2 || x[1] < 0.5 * (four.at[1][i] + four.at[1][i + 1]));
      assert_int_equal(vg_region_within(&r, x), in);
    }
  }
}

/* --- metrics -------------------------------------------------------------- */

/* Cells have the size 0.08 / factor along the axis, and 0.08 across it. */
struct constant {
  int axis;
  double factor;
};

static void constant_metric(void *user, const double x[3], double m[6])
{
  static const int diagonal[3] = { 0, 3, 5 };
  const struct constant *c = user;

  (void)x;
  vg_tensor_uniform(156.25, m);
  m[diagonal[c->axis]] *= c->factor * c->factor;
}

static void metric_scene(struct scene *s, struct constant *c)
{
  const struct vg_size_map map = { .metric = constant_metric, .user = c };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_front front;

  shape_box(&m, 4, 1);
  front = vg_front_of(&m);
  o.from_surface = 0;
  o.map = &map;
  s->load = (struct vg_load)VG_LOAD_INIT;
  assert_int_equal(vg_sizing_new(&o, 0, NULL, &m, &s->sizing, NULL), VG_OK);
  assert_int_equal(vg_load_new(&front, s->sizing, VG_LOAD_CELLS_PER_CUBE, 1,
                               &s->load, NULL),
                   VG_OK);
  vg_mesh_release(&m);
}

/* A plane of the cube, of area 4, crosses 4 / (h h') layers of cells with the
 * sizes h and h' along it. Without the metric, all planes have the same cost,
 * and the plane across x is chosen. */
static void planes_cross_the_fewest_cells(void **state)
{
  const struct vg_cut_rule rule = { 0, -1, 0 };

  (void)state;
  for (int i = 0; i < 6; i++) {
    struct constant c = { i % 3, i < 3 ? 4 : 0.25 };
    struct vg_lattice l;
    struct scene s;

    metric_scene(&s, &c);
    for (int axis = 0; axis < 3; axis++) {
      double crossed = 4 / (0.08 * 0.08) * (axis == c.axis ? 1 : c.factor);
      double cells = 2 * VG_LOAD_CELLS_PER_CUBE * crossed;

      assert_true(fabs(vg_load_zone(&s.load, axis, 0, 1) / cells - 1) < 0.05);
    }
    assert_int_equal(vg_lattice_plan(&s.load, &rule, 1, 0, &l), 1);
    assert_int_equal(l.n[c.axis], c.factor > 1);
    scene_end(&s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(levels_make_planes),
    cmocka_unit_test(planes_are_at_quantiles),
    cmocka_unit_test(planes_keep_their_distance),
    cmocka_unit_test(the_cheapest_axis_is_cut),
    cmocka_unit_test(planes_cross_the_fewest_cells),
    cmocka_unit_test(an_axis_can_be_requested),
    cmocka_unit_test(leaves_have_their_size),
    cmocka_unit_test(attempts_differ),
    cmocka_unit_test(nothing_to_cut),
    cmocka_unit_test(large_tiles_are_divided),
    cmocka_unit_test(small_leaves_have_small_pieces),
    cmocka_unit_test(small_tiles_stay_whole),
    cmocka_unit_test(numbers_of_regions),
    cmocka_unit_test(regions_are_disjoint_and_complete),
    cmocka_unit_test(points_have_blocks),
    cmocka_unit_test(patches_end_with_their_box),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
