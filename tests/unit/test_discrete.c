/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The discrete decomposition: subdomains that fit together, meshes of them,
 * voids that cannot be decomposed. */
#define _GNU_SOURCE
#include "advance_support.h"

#include "base/bytes.h"
#include "base/child.h"
#include "core/geometry/shape.h"
#include "core/geometry/vector.h"
#include "partition/cut/decomposition.h"
#include "partition/discrete/discrete.h"
#include "partition/discrete/discrete_parts.h"
#include "partition/graph/bisect.h"
#include "parts_support.h"

enum { SERIAL = 9 };

struct case_of {
  struct scene s;
  struct vg_front front;
  struct vg_load load;
};

static void case_begin(struct case_of *c, const char *name, size_t n)
{
  scene_demo(&c->s, name, n);
  c->front = vg_front_of(&c->s.m);
  c->front.id = vg_alloc(c->front.n_point, sizeof *c->front.id);
  assert_non_null(c->front.id);
  for (size_t k = 0; k < c->front.n_point; k++)
    c->front.id[k] = VG_POINT_ID(0, k);
  memset(&c->load, 0, sizeof c->load);
  assert_int_equal(vg_load_new(&c->front, c->s.sizing, VG_LOAD_CELLS_PER_CUBE,
                               1, &c->load, NULL),
                   VG_OK);
}

static void case_end(struct case_of *c)
{
  free(c->front.id);
  vg_load_release(&c->load);
  scene_end(&c->s);
}

static struct vg_decomposition_options how(int n_part, int partitioner,
                                           int h_refine)
{
  struct vg_decomposition_options o = VG_DECOMPOSITION_OPTIONS_INIT;

  o.n_part = n_part;
  o.partitioner = partitioner;
  o.h_refine = h_refine;
  return o;
}

static void part(const struct case_of *c, struct vg_decomposition_options o,
                 struct vg_decomposition *p)
{
  struct vg_error err = VG_ERROR_INIT;

  *p = (struct vg_decomposition)VG_DECOMPOSITION_INIT;
  if (vg_discrete_part(&c->front, &c->load, c->s.sizing, &o, SERIAL, NULL, p,
                       &err) != VG_OK ||
      vg_decomposition_check(p, &c->front, SERIAL, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* --- decompositions ------------------------------------------------------ */

/* Volumes of subdomains are sums of some thousand roundings. */
static void parts_make_up_the_void(void **state)
{
  struct case_of c;

  (void)state;
  needs_metis();
  case_begin(&c, "sphere", 20000);
  for (int way = 0; way < 4; way++) {
    struct vg_decomposition p, q;
    double volume = 0;

    part(&c, how(5, way & 1, way >> 1), &p);
    part(&c, how(5, way & 1, way >> 1), &q);
    assert_true(p.n_part >= 5 && p.n_part <= 7);
    assert_int_equal(p.n_part, 5 + p.report.n_apart);
    assert_true(p.n_point > 50 && p.report.n_face > 100);
    for (size_t k = 0; k < p.n_part; k++) {
      double own = vg_front_volume(&p.part[k].front);

      assert_true(own > 0);
      assert_int_equal(p.part[k].may_cut, 0);
      volume += own;
    }
    assert_true(fabs(volume - c.s.volume) < 1e-10 * c.s.volume);
    assert_int_equal(p.n_point, q.n_point);
    assert_memory_equal(p.x, q.x, p.n_point * sizeof *p.x);
    vg_decomposition_release(&p);
    vg_decomposition_release(&q);
  }
  case_end(&c);
}

/* Edges of interfaces have the local size: half of them within a third of it,
 * except near the front, whose edges are fixed. */
static void interfaces_have_the_local_size(void **state)
{
  struct case_of c;

  (void)state;
  needs_metis();
  case_begin(&c, "box", 30000);
  for (int h = 0; h < 2; h++) {
    struct vg_decomposition p;
    size_t n = 0, n_good = 0;

    part(&c, how(4, VG_PARTITIONER_METIS, h), &p);
    for (size_t k = 0; k < p.n_part; k++) {
      const struct vg_front *f = &p.part[k].front;

      for (size_t i = 0; i < 3 * f->n_face; i++) {
        uint32_t a = f->face[i / 3][i % 3], b = f->face[i / 3][(i + 1) % 3];
        double r;

        if (f->id[a] >> 32 != SERIAL || f->id[b] >> 32 != SERIAL) continue;
        r = vg_distance(f->x[a], f->x[b]) / vg_sizing_at(c.s.sizing, f->x[a]);
        assert_true(r < 2.5);
        n_good += r > 0.67 && r < 1.5;
        n++;
      }
    }
    assert_true(n > 100 && 10 * n_good > (h ? 6 : 8) * n);
    vg_decomposition_release(&p);
  }
  case_end(&c);
}

static void coarse(const struct case_of *c, double factor, struct vg_coarse *m)
{
  struct vg_error err = VG_ERROR_INIT;

  memset(m, 0, sizeof *m);
  if (vg_coarse_fill(&c->front, c->s.sizing, factor, NULL, NULL, m, &err) !=
      VG_OK)
    fail_msg("%s", err.text);
}

static void corners(const struct vg_coarse *m, size_t q, const double *x[4])
{
  for (int k = 0; k < 4; k++) x[k] = m->t.x[m->t.cell[q].v[k]];
}

/* Subdomains by distance from the middle of the box: inside, outside. */
static void part_ball(struct vg_coarse *m, double radius)
{
  m->part = vg_calloc(m->t.n_cell, sizeof *m->part);
  assert_non_null(m->part);
  m->n_part = 2;
  for (size_t q = 0; q < m->t.n_cell; q++) {
    double mid[3] = { 0 };
    const double *x[4];

    corners(m, q, x);
    for (int k = 0; k < 12; k++) mid[k % 3] += x[k / 3][k % 3] / 4;
    for (int k = 0; k < 3; k++) mid[k] -= 0.5;
    m->part[q] = vg_norm(mid) > radius;
  }
}

static double ball(const struct vg_coarse *m)
{
  const double *x[4];
  double sum = 0;

  for (size_t q = 0; q < m->t.n_cell; q++)
    if (!m->part[q]) {
      corners(m, q, x);
      sum += fabs(vg_det(x[0], x[1], x[2], x[3])) / 6;
    }
  return sum;
}

/* Smoothing removes the teeth of a ball of coarse cells, 6 % of its volume; if
 * points only moved towards the mean of their neighbours, it would remove 12
 * %. */
static void smoothing_keeps_the_volume_of_a_ball(void **state)
{
  struct vg_coarse m;
  struct vg_interface f = { 0 };
  struct case_of c;
  double was;

  (void)state;
  case_begin(&c, "box", 30000);
  coarse(&c, 1, &m);
  part_ball(&m, 0.3);
  was = ball(&m);
  assert_int_equal(vg_interface_list(&m, &f, NULL), VG_OK);
  assert_true(f.n_face > 500);
  assert_int_equal(vg_interface_smooth(&m, &f, NULL), VG_OK);
  assert_true(fabs(ball(&m) / was - 1) < 0.09);
  vg_interface_release(&f);
  vg_coarse_release(&m);
  case_end(&c);
}

/* Squared sine of the smallest angle of the cells at a face. */
static double shape_at(const struct vg_coarse *m, uint32_t side)
{
  const double *x[4], *y[4];

  corners(m, side >> 2, x);
  corners(m, m->t.cell[side >> 2].link[side & 3] >> 2, y);
  return fmin(vg_shape(x[0], x[1], x[2], x[3]),
              vg_shape(y[0], y[1], y[2], y[3]));
}

/* Flatten the cells around the middle planes. The halves of a box would meet
 * there, with 84 % of their faces at flat cells, if flat cells were not
 * avoided; actually 8 % are. */
static void squeeze(struct vg_coarse *m)
{
  const double from = 0.45, to = 0.4975;

  for (size_t k = 0; k < 3 * m->t.n_point; k++) {
    double *x = &m->t.x[k / 3][k % 3], low = fmin(*x, 1 - *x);
    double y = low < from ? low / from * to
                          : to + (low - from) / (0.5 - from) * (0.5 - to);

    *x = *x < 0.5 ? y : 1 - y;
  }
}

static void interfaces_avoid_flat_cells(void **state)
{
  struct vg_decomposition_options o = how(2, VG_PARTITIONER_METIS, 0);
  struct vg_coarse m;
  struct vg_interface f = { 0 };
  struct case_of c;
  uint64_t n_apart;
  size_t n = 0;
  const double flat = 0.02; /* 8 degrees */

  (void)state;
  needs_metis();
  case_begin(&c, "box", 30000);
  coarse(&c, 1, &m);
  squeeze(&m);
  assert_int_equal(vg_coarse_assign(&m, &c.load, c.s.sizing, &o, NULL, &n_apart,
                                    NULL),
                   VG_OK);
  assert_int_equal(vg_interface_list(&m, &f, NULL), VG_OK);
  for (size_t i = 0; i < f.n_face; i++) n += shape_at(&m, f.side[i]) < flat;
  assert_true(4 * n < f.n_face);
  vg_interface_release(&f);
  vg_coarse_release(&m);
  case_end(&c);
}

static void one_part_is_the_void(void **state)
{
  struct vg_decomposition p;
  struct case_of c;

  (void)state;
  needs_metis();
  case_begin(&c, "box", 5000);
  part(&c, how(1, VG_PARTITIONER_METIS, 0), &p);
  assert_int_equal(p.n_part, 1);
  assert_int_equal(p.n_point, 0);
  assert_int_equal(p.part[0].front.n_face, c.front.n_face);
  vg_decomposition_release(&p);
  case_end(&c);
}

static void too_many_subdomains_are_refused(void **state)
{
  struct vg_decomposition_options o = how(1000000, VG_PARTITIONER_RCB, 0);
  struct vg_decomposition p = VG_DECOMPOSITION_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct case_of c;

  (void)state;
  case_begin(&c, "box", 5000);
  assert_int_equal(vg_discrete_part(&c.front, &c.load, c.s.sizing, &o, SERIAL,
                                    NULL, &p, &err),
                   VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "fewer subdomains"));
  assert_int_equal(p.n_part, 0);
  o.n_part = 0;
  assert_int_equal(vg_discrete_part(&c.front, &c.load, c.s.sizing, &o, SERIAL,
                                    NULL, &p, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "request at least 1"));
  o.n_part = 4500; /* fewer than the mesh will have cells */
  assert_int_equal(vg_discrete_part(&c.front, &c.load, c.s.sizing, &o, SERIAL,
                                    NULL, &p, &err),
                   VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "smaller coarsening"));
  c.front.n_face--; /* a hole */
  o = how(4, VG_PARTITIONER_METIS, 0);
  assert_int_equal(vg_discrete_part(&c.front, &c.load, c.s.sizing, &o, SERIAL,
                                    NULL, &p, &err),
                   VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "coarse mesh"));
  c.front.n_face++;
  case_end(&c);
}

/* --- checks -------------------------------------------------------------- */

static void damaged_decompositions_are_refused(void **state)
{
  struct vg_decomposition p;
  struct vg_front *f;
  struct case_of c;
  uint32_t v;
  uint64_t name;

  (void)state;
  case_begin(&c, "box", 5000);
  part(&c, how(3, VG_PARTITIONER_RCB, 0), &p);
  f = &p.part[0].front;
  f->n_face--; /* a face missing */
  assert_int_equal(vg_decomposition_check(&p, &c.front, SERIAL, NULL),
                   VG_ERR_GEOMETRY);
  f->n_face++;
  v = f->face[7][0]; /* a face reversed */
  f->face[7][0] = f->face[7][1];
  f->face[7][1] = v;
  assert_int_equal(vg_decomposition_check(&p, &c.front, SERIAL, NULL),
                   VG_ERR_GEOMETRY);
  f->face[7][1] = f->face[7][0];
  f->face[7][0] = v;
  name = f->id[f->face[f->n_face - 1][0]];
  assert_int_equal(vg_decomposition_check(&p, &c.front, SERIAL, NULL), VG_OK);
  f->id[f->face[f->n_face - 1][0]] = VG_POINT_ID(SERIAL, p.n_point);
  assert_int_equal(vg_decomposition_check(&p, &c.front, SERIAL, NULL),
                   VG_ERR_GEOMETRY);
  f->id[f->face[f->n_face - 1][0]] = name;
  vg_decomposition_release(&p);
  case_end(&c);
}

static void bytes_and_back(void **state)
{
  struct vg_decomposition p, q;
  struct vg_writer w = { .cap = 0 };
  struct vg_reader r;
  struct case_of c;

  (void)state;
  needs_metis();
  case_begin(&c, "box", 5000);
  part(&c, how(3, VG_PARTITIONER_METIS, 0), &p);
  vg_decomposition_put(&w, &p, SERIAL);
  assert_false(w.refused);
  assert_int_equal(vg_decomposition_check(&p, &c.front, SERIAL, NULL), VG_OK);
  r = (struct vg_reader){ .data = w.bytes.data, .n = w.bytes.n };
  vg_decomposition_get(&r, SERIAL + 4, &q);
  assert_true(!r.bad && r.at == r.n);
  assert_int_equal(q.n_part, p.n_part);
  assert_int_equal(vg_decomposition_check(&q, &c.front, SERIAL + 4, NULL),
                   VG_OK);
  vg_decomposition_release(&q);
  for (size_t n = 0; n < w.bytes.n; n += 1 + n / 7) {
    r = (struct vg_reader){ .data = w.bytes.data, .n = n };
    vg_decomposition_get(&r, SERIAL, &q);
    assert_true(r.bad);
    assert_null(q.part);
  }
  free(w.bytes.data);
  vg_decomposition_release(&p);
  case_end(&c);
}

/* Weights as even as whole items permit, for any number of subdomains. */
static void bisection_is_even(void **state)
{
  enum { N = 3000 };
  static double x[N][3], weight[N];
  static uint32_t of[N];
  static const int parts[] = { 1, 2, 7, 64, N };

  (void)state;
  for (size_t k = 0; k < N; k++) {
    for (int i = 0; i < 3; i++)
      x[k][i] = (double)(k * (size_t)(37 + 2 * i) % 1009);
    weight[k] = 1 + (double)(k % 5);
  }
  for (size_t t = 0; t < sizeof parts / sizeof *parts; t++) {
    static double sum[N];
    double most = 0;

    memset(sum, 0, sizeof sum);
    assert_int_equal(vg_bisect(N, (const double(*)[3])x, weight, parts[t], of,
                               NULL),
                     VG_OK);
    for (size_t k = 0; k < N; k++) {
      assert_true(of[k] < (uint32_t)parts[t]);
      sum[of[k]] += weight[k];
    }
    for (int k = 0; k < parts[t]; k++) {
      assert_true(sum[k] > 0);
      if (sum[k] > most) most = sum[k];
    }
    assert_true(most <= 3.0 * N / parts[t] + 20);
  }
}

/* --- meshes -------------------------------------------------------------- */

static struct vg_partition_options mesh_options(int n_part)
{
  struct vg_partition_options o = options_of(3000, 1, 0);

  o.maker = vg_discrete_part;
  o.decomposition.n_part = n_part;
  return o;
}

static void meshes_are_valid_in_any_order(void **state)
{
  struct vg_partition_options o = mesh_options(0);
  struct vg_partition_report r;
  struct mesh_digest first, next;
  struct scene s;

  (void)state;
  needs_metis();
  scene_demo(&s, "sphere", 20000);
  first = run_of(NULL, &s, &o, 1, &r);
  assert_true(r.n_part > 4 && r.n_leaf == r.n_part && !r.n_zone_cell);
  o.threads = 3;
  o.shuffle = 11;
  next = run_of(NULL, &s, &o, 0, &r);
  same_digest(&first, &next);
  scene_end(&s);
}

/* A subdomain that cannot be filled is extended by a neighbouring leaf at
 * once. */
static void parts_that_cannot_be_filled(void **state)
{
  struct vg_partition_options o = mesh_options(12);
  struct vg_partition_report r;
  struct mesh_digest first, next;
  struct scene s;

  (void)state;
  needs_metis();
  scene_demo(&s, "sphere", 20000);
  o.fail_leaves = 0.3;
  o.fail_rounds = 2;
  first = run_of(NULL, &s, &o, 1, &r);
  assert_true(r.n_widened > 0 && r.n_widened_cell > 0);
  o.threads = 2;
  o.shuffle = 5;
  next = run_of(NULL, &s, &o, 0, &r);
  same_digest(&first, &next);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(parts_make_up_the_void),
    cmocka_unit_test(interfaces_have_the_local_size),
    cmocka_unit_test(smoothing_keeps_the_volume_of_a_ball),
    cmocka_unit_test(interfaces_avoid_flat_cells),
    cmocka_unit_test(one_part_is_the_void),
    cmocka_unit_test(too_many_subdomains_are_refused),
    cmocka_unit_test(damaged_decompositions_are_refused),
    cmocka_unit_test(bytes_and_back),
    cmocka_unit_test(bisection_is_even),
    cmocka_unit_test(meshes_are_valid_in_any_order),
    cmocka_unit_test(parts_that_cannot_be_filled),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
