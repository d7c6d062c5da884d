/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The faces of a front that a region is given: all that may intersect it, in
 * any order of additions, with indices that lead back to the front. */
#define _GNU_SOURCE
#include "advance_support.h"

#include "base/memory.h"
#include "core/geometry/triangles.h"
#include "partition/cut/lattice.h"
#include "partition/cut/select.h"

/* --- fronts and regions -------------------------------------------------- */

static void front_of(const struct vg_mesh *m, struct vg_front *f)
{
  memset(f, 0, sizeof *f);
  f->n_point = m->n_point;
  f->n_face = m->n_tri;
  f->x = vg_alloc(m->n_point, sizeof *f->x);
  f->id = vg_alloc(m->n_point, sizeof *f->id);
  f->face = vg_alloc(m->n_tri, sizeof *f->face);
  assert_non_null(f->x);
  assert_non_null(f->id);
  assert_non_null(f->face);
  memcpy(f->x, m->point, m->n_point * sizeof *f->x);
  memcpy(f->face, m->tri, m->n_tri * sizeof *f->face);
  for (size_t k = 0; k < m->n_point; k++) f->id[k] = VG_POINT_ID(3, 7 * k);
  assert_int_equal(vg_select_sort(f, NULL), VG_OK);
}

/* For the box [0, 1]^3 or the sphere's, [-20, 20]^3. */
static struct vg_lattice lattice_of(double lo, double hi)
{
  struct vg_lattice l = { .n = { 3, 1, 2 } };

  for (int axis = 0; axis < 3; axis++)
    for (int i = 0; i < l.n[axis]; i++)
      l.at[axis][i] = lo + (hi - lo) * (i + 1.03) / (l.n[axis] + 1);
  return l;
}

struct part {
  struct vg_front f;
  uint32_t *point, *face;
};

static void part_end(struct part *p)
{
  vg_front_release(&p->f);
  free(p->point);
  free(p->face);
}

static void select_part(const struct vg_select *s, const struct vg_region *r,
                        struct part *p)
{
  assert_int_equal(vg_select_part(s, r, &p->f, &p->point, &p->face, NULL),
                   VG_OK);
}

/* --- invariants ---------------------------------------------------------- */

/* Points are the front's, numbered in the order of their first use by faces. */
static void numbers_lead_back(const struct vg_front *f, const struct part *p)
{
  uint32_t seen = 0;

  for (size_t i = 0; i < p->f.n_face; i++) {
    if (i) assert_true(p->face[i - 1] < p->face[i]);
    for (int k = 0; k < 3; k++) {
      uint32_t v = p->f.face[i][k];

      assert_true(v <= seen);
      seen += v == seen;
      assert_int_equal(p->point[v], f->face[p->face[i]][k]);
    }
  }
  assert_int_equal(seen, p->f.n_point);
  for (size_t v = 0; v < p->f.n_point; v++) {
    assert_memory_equal(p->f.x[v], f->x[p->point[v]], sizeof *f->x);
    assert_int_equal(p->f.id[v], f->id[p->point[v]]);
  }
}

static int may_meet(const struct vg_front *f, size_t i,
                    const struct vg_region *r, const struct vg_sizing *sizing)
{
  const uint32_t *v = f->face[i];

  return v[0] != VG_FACE_GONE &&
         vg_region_may_meet(r, sizing, f->x[v[0]], f->x[v[1]], f->x[v[2]],
                            VG_BAND_FRONT);
}

/* All faces that may intersect the region are included. Returns their
 * number. */
static size_t is_complete(const struct vg_front *f, const struct part *p,
                          const struct vg_region *r,
                          const struct vg_sizing *sizing)
{
  size_t n = 0, k = 0;

  for (size_t i = 0; i < f->n_face; i++) {
    int has;

    while (k < p->f.n_face && p->face[k] < i) k++;
    has = k < p->f.n_face && p->face[k] == i;
    if (has) assert_true(f->face[i][0] != VG_FACE_GONE);
    if (!may_meet(f, i, r, sizing)) continue;
    assert_true(has);
    n++;
  }
  return n;
}

/* vg_select_near reduces a part of f to exactly the n faces that may intersect
 * the region, with indices that still lead back to f. */
static void near_is_exact(const struct vg_front *f, struct part *p,
                          const struct vg_region *r,
                          const struct vg_sizing *sizing, size_t n)
{
  assert_int_equal(vg_select_near(&p->f, r, sizing, &p->point, &p->face, NULL),
                   VG_OK);
  assert_int_equal(p->f.n_face, n);
  numbers_lead_back(f, p);
  for (size_t i = 0; i < n; i++)
    assert_true(may_meet(f, p->face[i], r, sizing));
}

/* Regions of all stages, and wider ones as for patches. most: largest allowed
 * ratio of selected faces to faces that may intersect. */
static void regions_get_what_they_need(const char *name, size_t cells,
                                       double lo, double hi, double most)
{
  struct vg_lattice l = lattice_of(lo, hi);
  size_t given = 0, needed = 0;
  struct vg_select s;
  struct vg_front f;
  struct scene scene;

  scene_demo(&scene, name, cells);
  front_of(&scene.m, &f);
  vg_select_init(&s, &f, scene.sizing);
  assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
  for (size_t i = 0; i < f.n_face; i += 5) f.face[i][0] = VG_FACE_GONE;
  for (int stage = 0; stage < VG_LATTICE_STAGES; stage++)
    for (size_t k = 0; k < vg_lattice_count(&l, stage); k++) {
      struct vg_region r;
      struct part p;
      size_t n;

      vg_lattice_region(&l, stage, k, &r);
      r.wide = k % 3 == 2 ? 2.5 : 0;
      select_part(&s, &r, &p);
      numbers_lead_back(&f, &p);
      n = is_complete(&f, &p, &r, scene.sizing);
      given += p.f.n_face;
      near_is_exact(&f, &p, &r, scene.sizing, n);
      needed += n;
      part_end(&p);
    }
  assert_true(needed > 100);
  assert_true((double)given < most * (double)needed);
  vg_select_release(&s);
  vg_front_release(&f);
  scene_end(&scene);
}

/* --- tests --------------------------------------------------------------- */

/* Uniform spacing: boxes of 16 faces are about as wide as the region, so at
 * most half of the needed number of faces is selected in addition. */
static void even_spacing(void **state)
{
  (void)state;
  regions_get_what_they_need("box", 100000, 0, 1, 1.5);
}

/* Faces from 0.06 to 4 in size; spacing is bounded by its growth there. */
static void spacing_varies(void **state)
{
  (void)state;
  regions_get_what_they_need("sphere", 100000, -20, 20, 2);
}

static void same_boxes(const struct vg_select *a, const struct vg_select *b)
{
  for (int k = 0; k < VG_SELECT_LEVELS; k++) {
    assert_int_equal(a->level[k].n, b->level[k].n);
    if (a->level[k].n)
      assert_memory_equal(a->level[k].box, b->level[k].box,
                          a->level[k].n * sizeof *a->level[k].box);
  }
}

/* The boxes are the same for any runs in which the front was added, full or
 * not: from one face on, over several levels. */
static void added_in_pieces(void **state)
{
  const size_t upto[] = { 1, 15, 16, 17, 128, 130, 2000, 2048, 4001 };
  struct vg_select s, once;
  struct vg_front f;
  struct scene scene;
  size_t all;

  (void)state;
  scene_demo(&scene, "box", 100000);
  front_of(&scene.m, &f);
  all = f.n_face;
  vg_select_init(&s, &f, scene.sizing);
  for (size_t i = 0; i < sizeof upto / sizeof *upto; i++) {
    assert_true(upto[i] < all);
    f.n_face = upto[i];
    assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
    vg_select_init(&once, &f, scene.sizing);
    assert_int_equal(vg_select_update(&once, NULL, NULL), VG_OK);
    same_boxes(&s, &once);
    vg_select_release(&once);
  }
  vg_select_release(&s);
  vg_front_release(&f);
  scene_end(&scene);
}

/* No shared points: the largest possible number, far more than in a surface. */
static void triangles_without_shared_points(void **state)
{
  const struct vg_region all = VG_REGION_ALL;
  struct vg_select s;
  struct vg_front f, own = VG_FRONT_INIT;
  struct scene scene;
  struct part p;

  (void)state;
  scene_demo(&scene, "box", 20000);
  front_of(&scene.m, &f);
  own.n_face = f.n_face;
  own.n_point = 3 * f.n_face;
  own.x = vg_alloc(own.n_point, sizeof *own.x);
  own.id = vg_alloc(own.n_point, sizeof *own.id);
  own.face = vg_alloc(own.n_face, sizeof *own.face);
  for (size_t i = 0; i < f.n_face; i++)
    for (size_t k = 0; k < 3; k++) {
      size_t v = own.n_point - 1 - (3 * i + k);

      own.face[i][k] = (uint32_t)v;
      own.id[v] = VG_POINT_ID(1, v);
      memcpy(own.x[v], f.x[f.face[i][k]], sizeof *own.x);
    }
  vg_select_init(&s, &own, scene.sizing);
  assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
  select_part(&s, &all, &p);
  assert_int_equal(p.f.n_face, own.n_face);
  assert_int_equal(p.f.n_point, own.n_point);
  numbers_lead_back(&own, &p);
  part_end(&p);
  vg_select_release(&s);
  vg_front_release(&f);
  vg_front_release(&own);
  scene_end(&scene);
}

static void no_faces_near_the_region(void **state)
{
  struct vg_region r = { .n_plane = 1 };
  struct vg_select s;
  struct vg_front f;
  struct scene scene;
  struct part p;

  (void)state;
  scene_demo(&scene, "box", 20000);
  front_of(&scene.m, &f);
  vg_select_init(&s, &f, scene.sizing);
  assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
  r.plane[0] = (struct vg_plane){ { 0, 0, 1 }, 0.5 };
  r.wall[r.n_wall++] = (struct vg_plane){ { 1, 0, 0 }, 3 };
  select_part(&s, &r, &p);
  assert_int_equal(p.f.n_face, 0);
  assert_int_equal(p.f.n_point, 0);
  part_end(&p);
  vg_select_release(&s);
  vg_front_release(&f);
  scene_end(&scene);
}

/* One triangle in a sizing field, given by the distances of its corners from
 * the plane z = 0.5, in spacings, and shifted along x. */
struct lone {
  struct vg_select select;
  struct vg_front f;
  double x[3][3];
  uint64_t name[3];
  uint32_t face[1][3];
};

static void lone_face(struct lone *t, const struct scene *scene,
                      const struct vg_region *r, double a, double b, double c,
                      double beside)
{
  const double middle[3] = { 0.5, 0.5, 0.5 }, z[3] = { a, b, c };
  double h = vg_region_spacing(r, scene->sizing, middle);

  memset(t, 0, sizeof *t);
  for (int k = 0; k < 3; k++) {
    t->x[k][0] = 0.5 + (beside + (k == 1)) * h;
    t->x[k][1] = 0.5 + (k == 2) * h;
    t->x[k][2] = 0.5 + z[k] * h;
    t->face[0][k] = (uint32_t)k;
  }
  t->f = (struct vg_front){
    .n_point = 3, .x = t->x, .id = t->name, .n_face = 1, .face = t->face
  };
  vg_select_init(&t->select, &t->f, scene->sizing);
  assert_int_equal(vg_select_update(&t->select, NULL, NULL), VG_OK);
}

/* The width set for a region that had another width before. */
static double width_for(const struct scene *scene, struct vg_region r, double a,
                        double b, double c, double beside)
{
  struct lone t;

  lone_face(&t, scene, &r, a, b, c, beside);
  r.wide = 7;
  assert_int_equal(vg_select_widen(&t.select, &r, NULL), VG_OK);
  vg_select_release(&t.select);
  return r.wide;
}

static void is_about(double is, double want)
{
  if (fabs(is - want) > 0.01) fail_msg("%g instead of %g", is, want);
}

/* Faces that cross all planes of a region, or nearly so, widen it: it must
 * reach the distance of their farthest corner plus 1.5 spacings. Faces of usual
 * length are within the known band and do not widen it. */
static void long_faces_widen_the_selection(void **state)
{
  struct vg_region zone = { .n_plane = 1 }, pencil, walled;
  struct scene scene;

  (void)state;
  scene_demo(&scene, "box", 20000);
  zone.plane[0] = (struct vg_plane){ { 0, 0, 1 }, 0.5 };
  is_about(width_for(&scene, zone, -0.5, 0.6, -0.4, 0), 0);
  is_about(width_for(&scene, zone, 0.1 - VG_BAND_FLUID, 0.6, 0, 0), 0);
  is_about(width_for(&scene, zone, -3, 0.6, -0.4, 0), 3 + 1.5 - VG_BAND_FLUID);
  is_about(width_for(&scene, zone, 0.2, 0.1, 4, 0), 4 + 1.5 - VG_BAND_FLUID);
  is_about(width_for(&scene, zone, 0.08, 0.3, 4, 0), 4 + 1.5 - VG_BAND_FLUID);
  is_about(width_for(&scene, zone, 0.15, 0.3, 4, 0), 0);

  walled = zone; /* beyond the end at a wall */
  walled.wall[walled.n_wall++] = (struct vg_plane){ { 1, 0, 0 }, 0.9 };
  is_about(width_for(&scene, walled, -3, 0.6, -0.4, 0), 0);

  pencil = zone; /* for any thickness */
  pencil.reach = 1.3;
  pencil.plane[pencil.n_plane++] = (struct vg_plane){ { 1, 0, 0 }, 0.5 };
  is_about(width_for(&scene, pencil, -3, 0.6, -0.4, -0.5),
           3 + 1.5 - VG_BAND_FLUID);
  is_about(width_for(&scene, pencil, -3, 0.6, -0.4, 1), 0);
  scene_end(&scene);
}

/* Of many faces the longest counts; removed faces do not. */
static void the_longest_face_counts(void **state)
{
  const struct vg_region r = { .n_plane = 1,
                               .plane = { { { 0, 0, 1 }, 0.5 } } };
  struct vg_region none = r, some = r;
  struct vg_select s;
  struct scene scene;
  struct lone t;
  uint32_t face[3][3] = { { 0, 1, 2 }, { 3, 4, 5 }, { VG_FACE_GONE, 7, 8 } };
  double x[9][3];
  static const double z[9] = { -1, 1, 0, -4, 1, 0, -6, 1, 0 };

  (void)state;
  scene_demo(&scene, "box", 20000);
  lone_face(&t, &scene, &r, 1, 1, 1, 0);
  for (int k = 0; k < 9; k++) {
    memcpy(x[k], t.x[k % 3], sizeof x[k]);
    x[k][2] = 0.5 + z[k] * (t.x[0][2] - 0.5);
  }
  vg_select_release(&t.select);
  t.f.n_point = 9;
  t.f.x = x;
  t.f.face = face;
  t.f.n_face = 3;
  vg_select_init(&s, &t.f, scene.sizing);
  none.wide = 7;
  assert_int_equal(vg_select_widen(&s, &none, NULL), VG_OK);
  assert_true(none.wide == 0); /* nothing was examined yet */
  assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
  assert_int_equal(vg_select_widen(&s, &some, NULL), VG_OK);
  is_about(some.wide, 4 + 1.5 - VG_BAND_FLUID);
  vg_select_release(&s);
  scene_end(&scene);
}

/* --- faces that a triangle touches ---------------------------------------- */

struct seen {
  size_t n;
  uint8_t *face;
};

static int see(void *context, uint32_t face)
{
  struct seen *s = context;

  s->face[face]++;
  s->n++;
  return 0;
}

static int stop_at_once(void *context, uint32_t face)
{
  size_t *n = context;

  (void)face;
  ++*n;
  return 7;
}

static double any(uint64_t *state, double lo, double hi)
{
  *state = *state * UINT64_C(6364136223846793005) + 1442695040888963407u;
  return lo + (hi - lo) * (double)(*state >> 11) / 9007199254740992.0;
}

/* Three points after those of the front: close together, far apart or
 * coplanar. */
static void any_triangle(struct vg_front *f, uint64_t *state, int how)
{
  double size = how % 3 == 0 ? 1 : 20;

  for (int k = 0; k < 3; k++) f->x[f->n_point][k] = any(state, -15, 15);
  for (size_t i = 1; i < 3; i++)
    for (int k = 0; k < 3; k++)
      f->x[f->n_point + i][k] = f->x[f->n_point][k] + size * any(state, -1, 1);
  for (int i = 0; i < 3 && how % 4 == 1; i++)
    f->x[f->n_point + (size_t)i][how % 5 % 3] = f->x[0][how % 5 % 3];
}

/* Every face that intersects the triangle is found once, with few others and no
 * removed face. */
static void finds_all_faces_that_a_triangle_meets(void **state)
{
  struct vg_select s;
  struct vg_front f;
  struct scene scene;
  struct seen seen = { .n = 0 };
  uint64_t random = 1;
  size_t met = 0;

  (void)state;
  scene_demo(&scene, "sphere", 100000);
  front_of(&scene.m, &f);
  f.x = vg_realloc(f.x, f.n_point + 3, sizeof *f.x);
  seen.face = vg_alloc(f.n_face, 1);
  assert_true(f.x && seen.face);
  for (size_t i = 0; i < f.n_face; i += 9) f.face[i][0] = VG_FACE_GONE;
  vg_select_init(&s, &f, scene.sizing);
  assert_int_equal(vg_select_update(&s, NULL, NULL), VG_OK);
  for (int n = 0; n < 300; n++) {
    const uint32_t p = (uint32_t)f.n_point, v[3] = { p, p + 1, p + 2 };
    const double *x[3];
    size_t stopped = 0, here = 0;

    any_triangle(&f, &random, n);
    for (int k = 0; k < 3; k++) x[k] = f.x[v[k]];
    memset(seen.face, 0, f.n_face);
    assert_int_equal(vg_select_touched(&s, x, see, &seen), 0);
    for (size_t i = 0; i < f.n_face; i++) {
      int is_gone = f.face[i][0] == VG_FACE_GONE;

      assert_true(seen.face[i] <= !is_gone);
      if (is_gone || !vg_triangles_meet((const double(*)[3])f.x, v, f.face[i],
                                        v, f.face[i]))
        continue;
      assert_int_equal(seen.face[i], 1);
      here++;
    }
    met += here;
    if (here) {
      assert_int_equal(vg_select_touched(&s, x, stop_at_once, &stopped), 7);
      assert_int_equal(stopped, 1);
    }
  }
  assert_true(met > 1000 && seen.n < 10 * met);
  free(seen.face);
  vg_select_release(&s);
  vg_front_release(&f);
  scene_end(&scene);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(even_spacing),
    cmocka_unit_test(spacing_varies),
    cmocka_unit_test(added_in_pieces),
    cmocka_unit_test(triangles_without_shared_points),
    cmocka_unit_test(no_faces_near_the_region),
    cmocka_unit_test(long_faces_widen_the_selection),
    cmocka_unit_test(the_longest_face_counts),
    cmocka_unit_test(finds_all_faces_that_a_triangle_meets),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
