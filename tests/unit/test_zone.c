/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Separator zones: final cells along planes, made from the part of a front near
 * them. Tests their division of the void, their cost, and their refusals. */
#include "core/recover/boundary.h"
#include "io/mesh/ugrid.h"
#include "zone_scene.h"

#include "parts_support.h"

/* --- planes, one after the other ----------------------------------------- */

static void three_zones_make_eight_boxes(void **state)
{
  struct scene s;
  size_t made = 0;

  (void)state;
  box_scene(&s, 12);
  parts_are(&s, 1);
  for (int axis = 0; axis < 3; axis++) {
    struct vg_region r = plane_at(axis, 0.03 * axis - 0.02);
    size_t now = cut(&s, &r);
    /* The box is 12 spacings wide. Earlier zones leave 11 of a side that they
     * cut; a cube of the spacing has 9 cells. */
    int open = 144 - axis * 12 + axis / 2;
    double thickness = (double)now / (9 * open);

    /* The regular cells that cross a plane are 0.91 spacings thick, zones 1.14
     * in the mean (docs/lab/trials.md, "Zones and interfaces"). */
    assert_true(thickness > 0.91 && thickness < 1.14);
    made += now;
    parts_are(&s, (size_t)2 << axis);
  }
  assert_int_equal(s.report.whole_void, 0);
  assert_true(smallest_angle(&s, 0) > 5);
  print_message("%zu cells, smallest angle %.1f\n", made,
                smallest_angle(&s, 0));
  is_filled(&s);
  scene_end(&s);
}

/* For any position of the planes. */
static void any_planes_divide_a_box(void **state)
{
  (void)state;
  for (int k = 0; k < 6; k++) {
    struct scene s;

    box_scene(&s, 8 + k % 3);
    for (int axis = 0; axis < 3; axis++) {
      double at = 0.4 * ((k * 37 + axis * 53 + 11) % 97 / 97.0 - 0.5);
      struct vg_region r = plane_at(axis, at);

      cut(&s, &r);
      parts_are(&s, (size_t)2 << axis);
    }
    is_filled(&s);
    scene_end(&s);
  }
}

/* Planes through the points of the front, and along a side. */
static void planes_through_points(void **state)
{
  struct scene s;

  (void)state;
  for (int axis = 0; axis < 3; axis++) {
    struct vg_region r = plane_at(axis, 0);

    box_scene(&s, 8);
    assert_true(cut(&s, &r) > 200);
    parts_are(&s, 2);
    is_filled(&s);
    scene_end(&s);
  }
  for (int side = -1; side <= 1; side += 2) {
    struct vg_region r = plane_at(1, 0.5 * side);

    box_scene(&s, 8);
    assert_true(cut(&s, &r) > 100);
    parts_are(&s, 1);
    is_filled(&s);
    scene_end(&s);
  }
}

/* x cuts the body, y misses it, z cuts the rest of it. */
static void zones_around_a_sphere(void **state)
{
  static const double at[3] = { 0.15, 1.6, -0.3 };
  static const size_t want[3] = { 2, 4, 8 };
  struct scene s;

  (void)state;
  sphere_scene(&s);
  parts_are(&s, 2); /* outside and body */
  for (int axis = 0; axis < 3; axis++) {
    struct vg_region r = plane_at(axis, at[axis]);

    assert_true(cut(&s, &r) > 100);
    parts_are(&s, want[axis]);
  }
  print_message("%zu cells, smallest angle %.1f\n", s.n_cell,
                smallest_angle(&s, 0));
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* A zone that misses the body leaves it complete, in one of the subdomains. */
static void a_zone_next_to_the_sphere(void **state)
{
  struct vg_region r = plane_at(2, 2.0);
  struct scene s;

  (void)state;
  sphere_scene(&s);
  assert_true(cut(&s, &r) > 50);
  parts_are(&s, 3);
  is_filled(&s);
  scene_end(&s);
}

/* --- cost ---------------------------------------------------------------- */

/* A box of 6 x 6 x n cells of edge 1, cut at z = 5.3: the zone's input and its
 * result. */
static void zone_of_tower(int n, struct vg_filled *z, size_t *n_point,
                          size_t *n_face)
{
  const int count[3] = { 6, 6, n };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 6, 6, n };
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_region r = plane_at(2, 5.3);
  struct zone_part p;
  struct scene s;

  memset(&s, 0, sizeof s);
  shape_block(&s.m, count, lo, hi, shape_all);
  scene_begin(&s, 1.2, 1);
  zone_select(&s, &r, &p);
  assert_true(p.front.n_face < s.front.n_face);
  assert_int_equal(zone_make(&s, &p, &r, &options, z, NULL), VG_OK);
  *n_point = p.front.n_point;
  *n_face = p.front.n_face;
  zone_part_release(&p);
  scene_end(&s);
}

static void same_zone(const struct vg_filled *a, const struct vg_filled *b)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_cell, b->n_cell);
  assert_int_equal(a->n_consumed, b->n_consumed);
  assert_int_equal(a->n_hole, b->n_hole);
  assert_memory_equal(&a->volume, &b->volume, sizeof a->volume);
  assert_memory_equal(a->x, b->x, a->n_point * sizeof *a->x);
  assert_memory_equal(a->face, b->face, a->n_face * sizeof *a->face);
  assert_memory_equal(a->cell, b->cell, a->n_cell * sizeof *a->cell);
  assert_memory_equal(a->consumed, b->consumed,
                      a->n_consumed * sizeof *a->consumed);
}

/* A zone is given the same number of faces for any size of the front. */
static void a_zone_costs_only_its_neighbourhood(void **state)
{
  struct vg_filled z[3] = { VG_FILLED_INIT, VG_FILLED_INIT, VG_FILLED_INIT };
  size_t n_point[3], n_face[3];

  (void)state;
  for (int k = 0; k < 3; k++) {
    zone_of_tower(15 << k, &z[k], &n_point[k], &n_face[k]);
    assert_int_equal(n_point[k], n_point[0]);
    assert_int_equal(n_face[k], n_face[0]);
    /* 48 faces to a row around the tower, rows one spacing high */
    assert_true((double)n_face[k] >= 48 * 2 * VG_BAND_FRONT);
    assert_true((double)n_face[k] <= 48 * (2 * VG_BAND_FRONT + 2));
    assert_true(z[k].n_cell > 200);
    assert_int_equal(z[k].n_hole, 0);
    /* the same number of spacings is read from another tree: cells differ
     * slightly */
    assert_true(fabs((double)z[k].n_cell / (double)z[0].n_cell - 1) < 0.05);
    assert_true(fabs(z[k].volume / z[0].volume - 1) < 0.05);
  }
  for (int k = 0; k < 3; k++) vg_filled_release(&z[k]);
}

static void the_same_bytes_again(void **state)
{
  struct vg_filled z[2] = { VG_FILLED_INIT, VG_FILLED_INIT };
  size_t n_point[2], n_face[2];

  (void)state;
  for (int k = 0; k < 2; k++) zone_of_tower(20, &z[k], &n_point[k], &n_face[k]);
  assert_int_equal(n_face[0], n_face[1]);
  same_zone(&z[0], &z[1]);
  for (int k = 0; k < 2; k++) vg_filled_release(&z[k]);
  assert_null(z[0].cell);
  assert_int_equal(z[0].n_cell + z[0].n_face + z[0].n_point, 0);
}

/* Where the spacing is 1, the sum of V / h^3 is the volume of the cells; all
 * indices in the lists are in range and used. */
static void figures_reported_by_a_zone(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_region r = plane_at(0, 0.04);
  struct vg_filled z = VG_FILLED_INIT;
  struct zone_part p;
  struct scene s;
  uint8_t *used, *is_gone;
  size_t n_front, n_gone;
  double sum = 0, h;

  (void)state;
  box_scene(&s, 8);
  zone_select(&s, &r, &p);
  assert_int_equal(zone_make(&s, &p, &r, &options, &z, NULL), VG_OK);
  used = vg_calloc(p.front.n_point + z.n_point, 1);
  is_gone = vg_calloc(s.front.n_face, 1);
  assert_true(used && is_gone);
  for (size_t c = 0; c < z.n_cell; c++)
    for (int k = 0; k < 4; k++) {
      assert_true(z.cell[c][k] < p.front.n_point + z.n_point);
      used[z.cell[c][k]] = 1;
    }
  for (size_t i = 0; i < z.n_face; i++)
    for (int k = 0; k < 3; k++) {
      assert_true(z.face[i][k] < p.front.n_point + z.n_point);
      assert_true(used[z.face[i][k]]);
    }
  for (size_t q = 0; q < z.n_point; q++) assert_true(used[p.front.n_point + q]);
  for (size_t i = 0; i < z.n_consumed; i++) { /* a set of faces, ascending */
    assert_true(z.consumed[i] < p.front.n_face);
    if (i) assert_true(z.consumed[i - 1] < z.consumed[i]);
  }
  n_gone = z.n_consumed;
  assert_true(n_gone > 30 && n_gone < p.front.n_face);
  assert_int_equal((n_gone + z.n_face) % 2, 0);
  n_front = s.front.n_face;
  zone_add(&s, &p, &z, is_gone);
  zone_compact(&s.front, is_gone, n_front);
  assert_int_equal(s.front.n_face, n_front - n_gone + z.n_face);
  is_valid(&s);
  for (size_t c = 0; c < s.n_cell; c++) sum += volume_of_cell(&s, c);
  h = vg_sizing_at(s.sizing, p.front.x[0]);
  assert_true(fabs(sum / (h * h * h) / z.volume - 1) < 1e-6);
  free(used);
  free(is_gone);
  vg_filled_release(&z);
  zone_part_release(&p);
  scene_end(&s);
}

static int passes(const struct scene *s, size_t c, const struct vg_region *r)
{
  const double(*x)[3] = (const double(*)[3])s->front.x;
  const uint32_t *v = s->cell[c];
  struct vg_region line = *r;

  line.reach = 0;
  return vg_region_has_cell(&line, s->sizing, x[v[0]], x[v[1]], x[v[2]],
                            x[v[3]]);
}

/* Longest edge, over the spacing in its middle, of cells that a line does not
 * pass through. */
static double longest_edge(const struct scene *s, const struct vg_region *r)
{
  double most = 0;

  for (size_t c = 0; c < s->n_cell; c++)
    for (int i = 0; i < 4 && !passes(s, c, r); i++)
      for (int j = 0; j < i; j++) {
        const double *a = s->front.x[s->cell[c][i]];
        const double *b = s->front.x[s->cell[c][j]];
        double middle[3], d2 = 0, ratio;

        for (int k = 0; k < 3; k++) {
          middle[k] = 0.5 * (a[k] + b[k]);
          d2 += (a[k] - b[k]) * (a[k] - b[k]);
        }
        ratio = sqrt(d2) / vg_sizing_at(s->sizing, middle);
        if (ratio > most) most = ratio;
      }
  return most;
}

/* Where a pencil leaves a plume in a corner of a box, its points are in the
 * shape of a trumpet: no cell spans the space next to it, as far as the front
 * is known. */
static void an_edge_separator_exits_a_plume(void **state)
{
  const struct vg_source plume = { .kind = VG_SOURCE_CYLINDER,
                                   .p0 = { 1, 0, 0 },
                                   .p1 = { 11, 0, 0 },
                                   .r0 = 0.25,
                                   .r1 = 1,
                                   .h0 = 0.041,
                                   .h1 = 0.041 };
  const int count[3] = { 40, 40, 40 };
  const double lo[3] = { -9, -11, -11 }, hi[3] = { 71, 69, 69 };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_region line = line_at(0, 8.276, 1, 0.0562);
  struct scene s;

  (void)state;
  memset(&s, 0, sizeof s);
  shape_block(&s.m, count, lo, hi, shape_all);
  scene_begin(&s, 1.2, 0);
  vg_sizing_free(s.sizing);
  assert_int_equal(vg_sizing_new(&o, 1, &plume, &s.m, &s.sizing, NULL), VG_OK);
  line.reach = 1.3;
  line.wide = 1;
  assert_true(cut(&s, &line) > 5000);
  assert_true(longest_edge(&s, &line) < 5);
  scene_end(&s);
}

/* A plate with n x n edges, and m edges thick, in a wide box. */
static void plate_scene(struct scene *s, int n, int m, double growth)
{
  const int count[3] = { n, n, m };
  const double lo[3] = { -1, -1, -(double)m / n }, hi[3] = { 1, 1, -lo[2] };
  size_t first;

  memset(s, 0, sizeof *s);
  shape_box(&s->m, 6, 9);
  first = s->m.n_tri;
  shape_block(&s->m, count, lo, hi, shape_all);
  for (size_t t = first; t < s->m.n_tri; t++) {
    uint32_t *v = s->m.tri[t], w = v[1];

    v[1] = v[2];
    v[2] = w;
  }
  scene_begin(s, growth, 0);
}

/* Number of cells whose side is wrong next to their corner nearest to the plane
 * z = at, of those with a corner within the known band. */
static size_t wrong_sides(const struct scene *s, const struct zone_part *p,
                          const struct vg_region *plane, double half)
{
  struct vg_boundary_report report;
  struct vg_tets t = VG_TETS_INIT;
  size_t n_wrong = 0;

  assert_int_equal(vg_boundary_open(p->front.n_point,
                                    (const double(*)[3])p->front.x,
                                    p->front.n_face,
                                    (const uint32_t(*)[3])p->front.face, plane,
                                    s->sizing, &t, &report, NULL),
                   VG_OK);
  for (uint32_t c = 0; c < t.n_cell; c++) {
    double least = VG_BAND_FLUID, x[3];
    int best = -1, is_solid = 1, is_outside = 0;

    for (int i = 0; i < 4 && !(t.flag[c] & VG_DEAD); i++) {
      const double *y = t.x[t.cell[c].v[i]];
      double far = fabs(vg_plane_side(&plane->plane[0], y)) /
                   vg_region_spacing(plane, s->sizing, y);

      if (far > least) continue;
      least = far;
      best = i;
    }
    if (best < 0) continue;
    for (int k = 0; k < 3; k++) {
      double sum = 0;

      for (int i = 0; i < 4; i++) sum += t.x[t.cell[c].v[i]][k];
      x[k] = t.x[t.cell[c].v[best]][k];
      x[k] += (sum / 4 - x[k]) / 64;
      is_solid &= fabs(x[k]) < (k < 2 ? 1 : half);
      is_outside |= fabs(x[k]) > 9;
    }
    n_wrong += (is_solid | is_outside) != !!(t.flag[c] & VG_OUTSIDE);
  }
  vg_tets_release(&t);
  return n_wrong;
}

/* A plane along a plate ends on its sides, where the spacing and with it the
 * known part of the front grow quickly away from the body: the part is open,
 * and cells reach from its rim far into the fluid. Their sides are right,
 * whatever the plate and the plane. */
static void a_plane_along_a_thin_body(void **state)
{
  uint64_t r = 88172645463325252;
  size_t all = 0;

  (void)state;
  needs_tetgen();
  for (int k = 0; k < 24; k++) {
    struct vg_region plane = plane_at(2, 0);
    struct zone_part p;
    struct scene s;
    double u[4];
    int n, m;

    for (int i = 0; i < 4; i++) {
      r ^= r << 13;
      r ^= r >> 7;
      r ^= r << 17;
      u[i] = (double)(r >> 11) * 0x1p-53;
    }
    n = 24 + (int)(24 * u[0]);
    m = 7 + (int)(6 * u[1]);
    plate_scene(&s, n, m, 1.1 + 0.2 * u[2]);
    plane.plane[0].offset = 0.01 * (u[3] - 0.5);
    zone_select(&s, &plane, &p);
    assert_true(p.front.n_face < s.front.n_face);
    all += wrong_sides(&s, &p, &plane, (double)m / n);
    zone_part_release(&p);
    scene_end(&s);
  }
  assert_int_equal(all, 0);
}

/* Without reach, a pencil consists of the cells that the line passes
 * through. */
static void a_pencil_is_thin(void **state)
{
  struct vg_region thin = line_at(0, 0.03, 1, 0.02), thick = thin;
  size_t made[2];
  struct scene s;

  (void)state;
  thin.reach = 0;
  for (int k = 0; k < 2; k++) {
    box_scene(&s, 10);
    made[k] = cut(&s, k ? &thick : &thin);
    parts_are(&s, 1);
    is_filled(&s);
    scene_end(&s);
  }
  assert_in_range(made[0], 20, 250);
  assert_true(made[1] > 2 * made[0]);
}

/* --- real geometry ------------------------------------------------------- */

static void a_real_surface(void **state)
{
  const char *path = io_real(
    "simple/hemisphere_cylinder_farfield.lb8.ugrid.xz");
  struct vg_error err = VG_ERROR_INIT;
  double lo[3], hi[3];
  struct scene s;

  (void)state;
  memset(&s, 0, sizeof s);
  if (vg_ugrid_read(path, &s.m, NULL, &err) < 0) fail_msg("%s", err.text);
  remove(path);
  for (size_t i = 0; i < s.m.n_tri; i++) { /* normals point outwards */
    uint32_t keep = s.m.tri[i][0];

    s.m.tri[i][0] = s.m.tri[i][1];
    s.m.tri[i][1] = keep;
  }
  scene_begin(&s, 1.25, 0);
  vg_mesh_bounds(&s.m, lo, hi);
  for (int axis = 0; axis < 3; axis++) {
    struct vg_region r = plane_at(axis, lo[axis] + 0.4 * (hi[axis] - lo[axis]));
    size_t n_fragment, made = cut(&s, &r);

    print_message("axis %d: %zu cells, %zu parts", axis, made,
                  parts_of(&s.front, &n_fragment));
    print_message(", %zu fragments\n", n_fragment);
  }
  is_filled(&s);
  scene_end(&s);
}

/* --- refusal ------------------------------------------------------------- */

static void is_empty(const struct vg_filled *z)
{
  const struct vg_filled empty = VG_FILLED_INIT;

  assert_memory_equal(z, &empty, sizeof empty);
}

static void a_zone_without_front_nearby(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_region r = plane_at(1, 2);
  struct vg_filled z = VG_FILLED_INIT;
  struct zone_part p;
  struct scene s;

  (void)state;
  box_scene(&s, 6);
  zone_select(&s, &r, &p);
  assert_int_equal(p.front.n_face, 0);
  assert_int_equal(zone_make(&s, &p, &r, &options, &z, NULL), VG_BLOCKED);
  is_empty(&z);
  zone_part_release(&p);
  scene_end(&s);
}

/* The front is near, but the plane is on its outer side: nothing is made. */
static void a_plane_outside(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct scene s;

  (void)state;
  box_scene(&s, 6);
  for (double off = 0.25; off < VG_BAND_FRONT; off += 0.25)
    for (int side = -1; side <= 1; side += 2) {
      struct vg_region r = plane_at(1, side * (0.5 + off / 6));
      struct vg_filled z = VG_FILLED_INIT;
      struct zone_part p;
      vg_status st;

      zone_select(&s, &r, &p);
      assert_true(p.front.n_face > 0);
      st = zone_make(&s, &p, &r, &options, &z, NULL);
      assert_true(st == VG_OK || st == VG_BLOCKED);
      if (z.n_cell + z.n_face)
        fail_msg("%zu cells %g spacings outside", z.n_cell, off);
      vg_filled_release(&z);
      zone_part_release(&p);
    }
  scene_end(&s);
}

/* An invalid front: no crash, and an empty result or an error status. A
 * reversed face on the plane contradicts its neighbours. */
static int is_below_and_above(const struct zone_part *p, size_t face, double at)
{
  int below = 0, above = 0;

  for (int k = 0; k < 3; k++) {
    double y = p->front.x[p->front.face[face][k]][1];

    below |= y < at;
    above |= y > at;
  }
  return below && above;
}

static void a_damaged_front(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_region r = plane_at(1, 0.03);
  struct vg_filled z = VG_FILLED_INIT;
  struct zone_part p;
  struct scene s;
  uint32_t keep;
  size_t at = 0;
  vg_status st;

  (void)state;
  box_scene(&s, 8);
  zone_select(&s, &r, &p);
  while (!is_below_and_above(&p, at, 0.03)) at++;
  keep = p.front.face[at][0];
  p.front.face[at][0] = p.front.face[at][1];
  p.front.face[at][1] = keep;
  st = zone_make(&s, &p, &r, &options, &z, NULL);
  assert_int_equal(st, VG_BLOCKED);
  assert_true(s.report.n_retry > 0);
  is_empty(&z);
  zone_part_release(&p);
  scene_end(&s);
}

struct stop {
  int at, calls;
};

static int stop_later(void *user)
{
  struct stop *s = user;

  return ++s->calls >= s->at;
}

static void it_can_be_stopped_at_every_call(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_region r = plane_at(2, 0.03);
  struct vg_filled z = VG_FILLED_INIT;
  struct stop stop = { 1, 0 };
  struct zone_part p;
  struct scene s;
  vg_status st = VG_BLOCKED;

  (void)state;
  box_scene(&s, 8);
  zone_select(&s, &r, &p);
  options.stop = (struct vg_stop){ stop_later, &stop };
  for (; stop.at < 100; stop.at++, stop.calls = 0) {
    st = zone_make(&s, &p, &r, &options, &z, NULL);
    if (st == VG_OK) break;
    assert_int_equal(st, VG_ERR_STOPPED);
    assert_int_equal(stop.calls, stop.at);
    is_empty(&z);
  }
  assert_int_equal(st, VG_OK);
  assert_true(stop.at > 3);
  assert_true(z.n_cell > 200);
  vg_filled_release(&z);
  zone_part_release(&p);
  scene_end(&s);
}

static void the_point_limit_refuses(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_region r = plane_at(2, 0.03);
  struct vg_filled z = VG_FILLED_INIT;
  struct zone_part p;
  struct scene s;

  (void)state;
  box_scene(&s, 8);
  zone_select(&s, &r, &p);
  options.point_limit = 3;
  assert_int_equal(zone_make(&s, &p, &r, &options, &z, &err),
                   VG_ERR_UNSUPPORTED);
  assert_true(strlen(err.text) > 10);
  is_empty(&z);
  zone_part_release(&p);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(three_zones_make_eight_boxes),
    cmocka_unit_test(any_planes_divide_a_box),
    cmocka_unit_test(planes_through_points),
    cmocka_unit_test(zones_around_a_sphere),
    cmocka_unit_test(a_zone_next_to_the_sphere),
    cmocka_unit_test(a_zone_costs_only_its_neighbourhood),
    cmocka_unit_test(the_same_bytes_again),
    cmocka_unit_test(figures_reported_by_a_zone),
    cmocka_unit_test(an_edge_separator_exits_a_plume),
    cmocka_unit_test(a_plane_along_a_thin_body),
    cmocka_unit_test(a_pencil_is_thin),
    cmocka_unit_test(a_real_surface),
    cmocka_unit_test(a_zone_without_front_nearby),
    cmocka_unit_test(a_plane_outside),
    cmocka_unit_test(a_damaged_front),
    cmocka_unit_test(it_can_be_stopped_at_every_call),
    cmocka_unit_test(the_point_limit_refuses),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
