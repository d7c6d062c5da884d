/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The octree-guided decomposition: subdomains of octants and the gap region at
 * the front are closed, make up the void, share each interface with exactly one
 * other, and can be filled; octants are balanced; impossible requests are
 * refused. */
#define _GNU_SOURCE
#include "advance_support.h"

#include "core/fill/fill.h"
#include "partition/octree/octree.h"
#include "partition/octree/octree_parts.h"
#include "parts_support.h"

enum { SERIAL = 7 };

struct parted {
  struct scene s;
  struct vg_front front; /* points and faces of the scene */
  struct vg_load load;
  struct vg_decomposition p;
};

/* The front and the load of an existing scene. */
static void enter(struct parted *q)
{
  struct vg_error err = VG_ERROR_INIT;

  q->front = vg_front_of(&q->s.m);
  q->front.id = vg_alloc(q->front.n_point, sizeof *q->front.id);
  assert_non_null(q->front.id);
  for (size_t k = 0; k < q->front.n_point; k++)
    q->front.id[k] = VG_POINT_ID(0, k);
  q->load = (struct vg_load)VG_LOAD_INIT;
  if (vg_load_new(&q->front, q->s.sizing, VG_LOAD_CELLS_PER_CUBE, 1, &q->load,
                  &err) < 0)
    fail_msg("%s", err.text);
  q->p = (struct vg_decomposition)VG_DECOMPOSITION_INIT;
}

static void leave(struct parted *q)
{
  free(q->front.id);
  vg_load_release(&q->load);
  vg_decomposition_release(&q->p);
  scene_end(&q->s);
}

static vg_status try(struct parted *q, struct vg_decomposition_options o,
                     struct vg_decomposition *p, struct vg_error *err)
{
  o.cells_per_cube = VG_LOAD_CELLS_PER_CUBE;
  return vg_octree_part(&q->front, &q->load, q->s.sizing, &o, SERIAL, NULL, p,
                        err);
}

static void part(struct parted *q, struct vg_decomposition_options o)
{
  struct vg_error err = VG_ERROR_INIT;

  if (try(q, o, &q->p, &err) != VG_OK) fail_msg("%s", err.text);
}

/* A leaf of side 1 whose front is as fine as `n_cell` cells require. With a
 * source in its middle, octants of several sizes are adjacent. */
static void graded_scene(struct scene *s, size_t n_cell)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_source source = {
    .kind = VG_SOURCE_POINT, .p0 = { 0.5, 0.47, 0.52 }, .h0 = 0.004, .r0 = 0.01
  };
  struct vg_error err = VG_ERROR_INIT;

  memset(s, 0, sizeof *s);
  if (vg_demo_make("box", n_cell, &d, &err) < 0) fail_msg("%s", err.text);
  d.sizing.h_max = 0;
  d.sizing.from_surface = 1;
  if (vg_sizing_new(&d.sizing, 1, &source, &d.surface, &s->sizing, &err) < 0)
    fail_msg("%s", err.text);
  vg_mesh_move(&s->m, &d.surface);
  vg_demo_release(&d);
  s->volume = scene_volume(&s->m);
}

/* --- invariants ---------------------------------------------------------- */

struct side {
  uint64_t name[3];
  int turn;
};

static int by_names(const void *p, const void *q)
{
  const struct side *a = p, *b = q;
  int d = memcmp(a->name, b->name, sizeof a->name);

  return d ? d : a->turn - b->turn;
}

/* A face by its global ids, in ascending order, and its orientation. */
static struct side side_of(const struct vg_front *f, const uint32_t v[3])
{
  struct side s = { { f->id[v[0]], f->id[v[1]], f->id[v[2]] }, 0 };

  for (int pass = 0; pass < 3; pass++)
    for (int j = 0; j < 2; j++)
      if (s.name[j] > s.name[j + 1]) {
        uint64_t swap = s.name[j];

        s.name[j] = s.name[j + 1];
        s.name[j + 1] = swap;
        s.turn ^= 1;
      }
  return s;
}

/* Each face of the front is in one subdomain; all others are in two, with
 * opposite orientations. */
static void check_faces(const struct parted *q)
{
  size_t n = 0, at = 0, n_front = 0, n_pair = 0;
  struct side *side;

  for (size_t k = 0; k < q->p.n_part; k++) n += q->p.part[k].front.n_face;
  side = calloc(n, sizeof *side);
  assert_non_null(side);
  for (size_t k = 0; k < q->p.n_part; k++) {
    const struct vg_front *f = &q->p.part[k].front;

    for (size_t i = 0; i < f->n_face; i++) side[at++] = side_of(f, f->face[i]);
  }
  qsort(side, n, sizeof *side, by_names);
  for (size_t i = 0; i < n; i++) {
    if (i + 1 < n &&
        !memcmp(side[i].name, side[i + 1].name, sizeof side->name)) {
      assert_int_not_equal(side[i].turn, side[i + 1].turn);
      n_pair++;
      i++;
    } else {
      n_front++;
      for (int j = 0; j < 3; j++) assert_true(side[i].name[j] >> 32 == 0);
    }
  }
  assert_int_equal(n_front, q->front.n_face);
  assert_int_equal(n, n_front + 2 * n_pair);
  free(side);
}

/* Coordinates agree with global ids; no new point is on the front. */
static void check_points(const struct parted *q)
{
  for (size_t k = 0; k < q->p.n_part; k++) {
    const struct vg_front *f = &q->p.part[k].front;

    for (size_t i = 0; i < f->n_point; i++) {
      const uint32_t v = (uint32_t)f->id[i];
      const int is_new = f->id[i] >> 32 == SERIAL;

      assert_true(is_new || f->id[i] >> 32 == 0);
      assert_true(v < (is_new ? q->p.n_point : q->front.n_point));
      assert_memory_equal(f->x[i], is_new ? q->p.x[v] : q->front.x[v],
                          sizeof *f->x);
    }
  }
}

/* Closed, and together as large as the void. */
static void check_volumes(const struct parted *q)
{
  double sum = 0;

  for (size_t k = 0; k < q->p.n_part; k++) {
    const struct vg_front *f = &q->p.part[k].front;

    assert_int_equal(vg_front_open_edges(f), 0);
    assert_true(vg_front_volume(f) > 0);
    sum += vg_front_volume(f);
  }
  assert_true(fabs(sum - q->s.volume) < 1e-9 * q->s.volume);
}

/* Subdomains of octants come first. Returns their number. */
static size_t check_parts(const struct parted *q)
{
  size_t n = 0;

  check_faces(q);
  check_points(q);
  check_volumes(q);
  while (n < q->p.n_part && !q->p.part[n].may_cut) n++;
  for (size_t k = n; k < q->p.n_part; k++) {
    assert_int_equal(q->p.part[k].may_cut, 1);
    assert_true(q->p.part[k].front.n_face > 0);
  }
  assert_true(n < q->p.n_part);
  return n;
}

/* The most cells expected in a subdomain of octants. mean: out. */
static double most_cells(const struct parted *q, size_t n, double *mean)
{
  double most = 0, sum = 0;

  for (size_t k = 0; k < n; k++) {
    struct vg_load l = VG_LOAD_INIT;

    assert_int_equal(vg_load_new(&q->p.part[k].front, q->s.sizing,
                                 VG_LOAD_CELLS_PER_CUBE, 1, &l, NULL),
                     VG_OK);
    if (l.cells > most) most = l.cells;
    sum += l.cells;
    vg_load_release(&l);
  }
  *mean = sum / (double)n;
  return most;
}

/* --- tests --------------------------------------------------------------- */

static void check_scene(struct parted *q, size_t least, size_t most)
{
  enter(q);
  for (int partitioner = 0; partitioner < 2; partitioner++)
    for (int n_part = 4; n_part <= 64; n_part *= 4) {
      double most_in, mean;
      size_t n;

      part(q, (struct vg_decomposition_options){ .n_part = n_part,
                                                 .partitioner = partitioner });
      n = check_parts(q);
      if (n_part == 16) {
        assert_in_range(n, least, most);
        most_in = most_cells(q, n, &mean);
        /* the number of subdomains is rounded; each has about ten octants, and
         * the estimates for octants and for a subdomain differ */
        assert_true(most_in < 1.4 * q->load.cells / n_part);
        /* disconnected components become subdomains too; METIS makes none of
         * them */
        if (partitioner == VG_PARTITIONER_METIS)
          assert_true(most_in < 1.15 * mean);
      }
      vg_decomposition_release(&q->p);
    }
  leave(q);
}

static void uniform_voids_are_decomposed(void **state)
{
  struct parted q;

  (void)state;
  needs_metis();
  scene_demo(&q.s, "box", 200000);
  check_scene(&q, 5, 12);
}

/* Octants of many sizes, around a body and inside a farfield. */
static void graded_voids_are_decomposed(void **state)
{
  struct parted q;

  (void)state;
  needs_metis();
  scene_demo(&q.s, "sphere", 60000);
  check_scene(&q, 3, 12);
  graded_scene(&q.s, 20000);
  check_scene(&q, 8, 20);
}

static void half_bodies_are_decomposed(void **state)
{
  struct parted q;

  (void)state;
  needs_metis();
  scene_demo(&q.s, "wing-half", 100000);
  check_scene(&q, 3, 12);
}

static void octants_are_balanced_and_off_the_front(void **state)
{
  struct vg_octants t = { .n = 0 };
  struct vg_error err = VG_ERROR_INIT;
  struct parted q;
  size_t n_step = 0, n_free = 0;

  (void)state;
  graded_scene(&q.s, 20000);
  enter(&q);
  if (vg_octants_make(&q.front, &q.load, q.s.sizing, 4, NULL, &t, &err) !=
      VG_OK)
    fail_msg("%s", err.text);
  for (size_t f = 0; f < t.n_face; f++) {
    const struct vg_octant *a = &t.octant[t.face[f].leaf[0]];
    const struct vg_octant *b = &t.octant[t.face[f].leaf[1]];

    assert_in_range(a->level - b->level + 1, 0, 2);
    assert_int_equal(t.face[f].side,
                     vg_octant_side(a->level > b->level ? a : b));
    n_step += a->level != b->level;
  }
  assert_true(n_step > 100);
  for (size_t l = 0; l < t.n_leaf; l++) {
    const struct vg_octant *o = &t.octant[t.leaf[l]];
    const double side = vg_octant_side(o) * t.unit;

    if (o->state != VG_OCTANT_FREE) continue;
    n_free++;
    for (size_t p = 0; p < q.front.n_point; p++) {
      double off = 0;

      for (int k = 0; k < 3; k++) {
        const double lo = vg_octants_place(&t, k, o->at[k]);
        const double x = q.front.x[p][k];
        const double d = fmax(fmax(lo - x, x - lo - side), 0);

        off += d * d;
      }
      assert_true(off >= o->reach * o->reach);
    }
  }
  assert_true(n_free > 100);
  vg_octants_release(&t);
  leave(&q);
}

static void parts_can_be_filled(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct parted q;

  (void)state;
  needs_metis();
  scene_demo(&q.s, "sphere", 30000);
  enter(&q);
  part(&q, (struct vg_decomposition_options){ .n_part = 8 });
  assert_true(check_parts(&q) > 1);
  for (size_t k = 0; k < q.p.n_part; k++) {
    const struct vg_front *f = &q.p.part[k].front;
    struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
    struct vg_fill_report r = { 0 };
    struct vg_filled made = VG_FILLED_INIT;

    if (vg_fill_front(f, NULL, q.s.sizing, &o, &made, &r, &err) != VG_OK)
      fail_msg("%s", err.text);
    assert_true(made.n_cell > 0);
    assert_int_equal(vg_filled_defects(f, &made, 0), 0);
    vg_filled_release(&made);
  }
  leave(&q);
}

static void without_octants_all_is_gap_region(void **state)
{
  struct parted q;

  (void)state;
  scene_demo(&q.s, "box", 500);
  enter(&q);
  part(&q, (struct vg_decomposition_options){ .n_part = 100 });
  assert_int_equal(q.p.n_part, 1);
  assert_int_equal(q.p.part[0].may_cut, 1);
  assert_int_equal(q.p.n_point, 0);
  assert_int_equal(q.p.part[0].front.n_face, q.front.n_face);
  check_parts(&q);
  leave(&q);
}

static void one_part_is_octants_and_a_gap(void **state)
{
  struct parted q;

  (void)state;
  scene_demo(&q.s, "box", 100000);
  enter(&q);
  part(&q, (struct vg_decomposition_options){ .n_part = 1, .coarsening = 3 });
  assert_int_equal(check_parts(&q), 1);
  assert_int_equal(q.p.n_part, 2);
  leave(&q);
}

static void it_is_the_same_every_time(void **state)
{
  struct vg_decomposition_options o = { .n_part = 16 };
  struct vg_decomposition again = VG_DECOMPOSITION_INIT;
  struct parted q;

  (void)state;
  needs_metis();
  scene_demo(&q.s, "sphere", 60000);
  enter(&q);
  part(&q, o);
  assert_int_equal(try(&q, o, &again, NULL), VG_OK);
  assert_int_equal(q.p.n_point, again.n_point);
  assert_memory_equal(q.p.x, again.x, again.n_point * sizeof *again.x);
  assert_int_equal(q.p.n_part, again.n_part);
  for (size_t k = 0; k < again.n_part; k++) {
    const struct vg_front *a = &q.p.part[k].front, *b = &again.part[k].front;

    assert_int_equal(a->n_point, b->n_point);
    assert_int_equal(a->n_face, b->n_face);
    assert_memory_equal(a->id, b->id, a->n_point * sizeof *a->id);
    assert_memory_equal(a->face, b->face, a->n_face * sizeof *a->face);
  }
  vg_decomposition_release(&again);
  leave(&q);
}

static void absurd_options_are_refused(void **state)
{
  static const struct {
    struct vg_decomposition_options o;
    const char *word;
  } bad[] = {
    { { .n_part = 0 }, "0 subdomains" },
    { { .n_part = -3 }, "-3 subdomains" },
    { { .n_part = 4, .coarsening = 1 }, "coarsening of 1" },
    { { .n_part = 4, .coarsening = -5 }, "coarsening of -5" },
    { { .n_part = 4, .coarsening = NAN }, "coarsening" },
    { { .n_part = 4, .coarsening = INFINITY }, "coarsening" },
    { { .n_part = 4, .h_refine = 1 }, "remesh" },
  };
  struct parted q;

  (void)state;
  scene_demo(&q.s, "box", 5000);
  enter(&q);
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(try(&q, bad[k].o, &q.p, &err), VG_ERR_INPUT);
    assert_non_null(strstr(err.text, bad[k].word));
    assert_null(q.p.part);
  }
  leave(&q);
}

static void open_fronts_are_refused(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct parted q;

  (void)state;
  scene_demo(&q.s, "box", 50000);
  enter(&q);
  q.front.n_face -= 3;
  assert_int_equal(try(&q, (struct vg_decomposition_options){ .n_part = 4 },
                       &q.p, &err),
                   VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "closed"));
  assert_null(q.p.part);
  leave(&q);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(uniform_voids_are_decomposed),
    cmocka_unit_test(graded_voids_are_decomposed),
    cmocka_unit_test(half_bodies_are_decomposed),
    cmocka_unit_test(octants_are_balanced_and_off_the_front),
    cmocka_unit_test(parts_can_be_filled),
    cmocka_unit_test(without_octants_all_is_gap_region),
    cmocka_unit_test(one_part_is_octants_and_a_gap),
    cmocka_unit_test(it_is_the_same_every_time),
    cmocka_unit_test(absurd_options_are_refused),
    cmocka_unit_test(open_fronts_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
