/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Forecasts: regular trees of uniform boxes, sums, tasks that the model can
 * run, and agreement with the tasks of a real run. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "cli/examples/demo.h"
#include "partition/advance/advance.h"
#include "partition/model/forecast.h"
#include "partition/model/model.h"

struct scene {
  struct vg_demo demo;
  struct vg_sizing *sizing;
  struct vg_front front; /* of the demo's surface */
  struct vg_load load;
};

static void make(struct scene *s, const char *name, size_t n_cell)
{
  const struct vg_mesh *m;

  memset(s, 0, sizeof *s);
  assert_int_equal(vg_demo_make(name, n_cell, &s->demo, NULL), VG_OK);
  m = &s->demo.surface;
  assert_int_equal(vg_sizing_new(&s->demo.sizing, s->demo.n_source,
                                 s->demo.source, m, &s->sizing, NULL),
                   VG_OK);
  s->front = vg_front_of(m);
  assert_int_equal(vg_load_new(&s->front, s->sizing, VG_LOAD_CELLS_PER_CUBE, 1,
                               &s->load, NULL),
                   VG_OK);
}

static void release(struct scene *s)
{
  vg_load_release(&s->load);
  vg_sizing_free(s->sizing);
  vg_demo_release(&s->demo);
}

static struct vg_cut_rule leaves_of(double cells)
{
  struct vg_cut_rule r = { cells, -1, 0 };

  return r;
}

static struct vg_forecast look(const struct scene *s, struct vg_cut_rule rule,
                               int levels)
{
  struct vg_forecast o = VG_FORECAST_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_forecast_new(&s->front, &s->load, &rule, levels, &vg_rates_measured,
                      &o, &err) < 0)
    fail_msg("%s", err.text);
  return o;
}

static double sum_of(const struct vg_spans *s, char kind)
{
  double sum = 0;

  for (size_t i = 0; i < s->n; i++)
    if (s->span[i].kind == kind) sum += s->span[i].estimate;
  return sum;
}

/* Few leaves: planes one after another, always through the middle of the
 * remaining void. */
static void few_leaves_have_whole_planes(void **state)
{
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "box", 60000);
  o = look(&s, leaves_of(s.load.cells / 16), 0);
  assert_int_equal(o.n_leaf, 16);
  assert_int_equal(o.n_node, 31);
  assert_int_equal(o.n_tile, 15);
  assert_int_equal(o.n_pencil, 0);
  assert_int_equal(o.node[0].n_child, 2);
  vg_forecast_release(&o);
  release(&s);
}

/* Decomposed by a maker: one task whose cost follows from its rates, and the
 * leaves after it. A subdomain that may be cut has the tasks that it would have
 * by itself. */
static void parts_follow_their_maker(void **state)
{
  static const struct vg_decomposition_rate rate = { 2e-6, 3e-6, 5e-6,
                                                     0.25, 1e-6, 4e-6 };
  struct vg_forecast_part part[3];
  struct vg_forecast_decomposition all = { &rate, 7000, 1100, 3, part };
  struct vg_forecast o = VG_FORECAST_INIT, alone;
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_model_result f;
  struct vg_cut_rule rule;
  const struct vg_span *maker = NULL;
  double coarse = 0;
  struct scene s;

  (void)state;
  make(&s, "box", 20000);
  rule = leaves_of(s.load.cells / 4);
  for (int k = 0; k < 3; k++)
    part[k] = (struct vg_forecast_part){ s.front, &s.load, k == 2 };
  alone = look(&s, rule, 0);
  assert_int_equal(vg_forecast_parted(&s.front, &s.load, &all, &rule, 0,
                                      &vg_rates_measured, &o, NULL),
                   VG_OK);
  assert_int_equal(o.n_leaf, 2 + alone.n_leaf);
  assert_int_equal(o.n_tile, alone.n_tile);
  assert_int_equal(o.node[0].n_child, 3);
  assert_false(vg_forecast_is_leaf(&o.node[0]));
  assert_true(vg_forecast_is_leaf(&o.node[1]));
  for (size_t i = 0; i < o.spans.n; i++) {
    const struct vg_span *one = &o.spans.span[i];

    if (!strcmp(one->path, "0J0")) maker = one;
    if (one->path[0] == '1') coarse += one->cpu;
    if (strcmp(one->path, "0.1L")) continue;
    assert_string_equal(one->after, "0J0");
    assert_true(one->n_cell == (uint64_t)(s.load.cells + 0.5));
    assert_true(one->work > 0);
  }
  assert_non_null(maker);
  assert_true(fabs(maker->cpu - (2e-6 * (double)s.front.n_face + 3e-6 * 7000 +
                                 5e-6 * 1100)) < 1e-12);
  assert_true(fabs(maker->loops - maker->cpu / 4) < 1e-12);
  m.ranks = 4;
  assert_int_equal(vg_model_replay(&o.spans, &m, &f, NULL, NULL), VG_OK);
  assert_string_equal(maker->after, "1R0");
  assert_true(fabs(coarse - 4e-6 * 7000) < 1e-12);
  assert_true(f.wall > coarse + maker->cpu && f.wall < o.spans.wall);
  m.cyclic = 1;
  assert_int_equal(vg_model_replay(&o.spans, &m, &f, NULL, NULL), VG_OK);
  vg_forecast_release(&o);
  vg_forecast_release(&alone);
  release(&s);
}

/* Eight blocks at once; they differ by the octants next to planes: some per
 * cent. */
static void a_box_has_a_regular_tree(void **state)
{
  struct vg_cut_rule rule = { .leaf_cells = 0, .first_axis = -1 };
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "box", 200000);
  o = look(&s, rule, 3);
  assert_int_equal(o.n_leaf, 8);
  assert_int_equal(o.n_node, 9);
  assert_int_equal(o.n_tile, 12 + 1); /* a point where three meet */
  assert_int_equal(o.n_pencil, 5);
  assert_int_equal(o.node[0].n_child, 8);
  assert_true(o.node[0].parent == SIZE_MAX);
  for (int k = 0; k < 3; k++) assert_int_equal(o.node[0].lattice.n[k], 1);
  for (size_t i = 1; i < o.n_node; i++) {
    const struct vg_forecast_node *n = &o.node[i];
    double even = (s.load.cells - o.separator_cells) / 8;

    assert_true(vg_forecast_is_leaf(n) && n->depth == 1 && n->parent == 0);
    assert_in_range((int)(100 * n->cells / even), 95, 125);
    for (int k = 0; k < 3; k++) {
      double at = o.node[0].lattice.at[k][0];

      assert_true(n->lo[k] == at || n->hi[k] == at);
    }
  }
  vg_forecast_release(&o);
  release(&s);
}

/* Nothing is lost except the rounding of the shares, which are single
 * precision. */
static void sums_are_the_loads(void **state)
{
  static const char *const name[] = { "box", "sphere", "wing" };

  (void)state;
  for (int i = 0; i < 3; i++) {
    struct scene s;
    struct vg_forecast o;

    make(&s, name[i], 150000);
    o = look(&s, leaves_of(10000), 0);
    assert_true(o.cells == s.load.cells && o.n_leaf > 8);
    assert_true(fabs(sum_of(&o.spans, 'L') + sum_of(&o.spans, 'P') +
                     sum_of(&o.spans, 'T') - o.cells) < 1e-4 * o.cells);
    assert_true(fabs(sum_of(&o.spans, 'P') + sum_of(&o.spans, 'T') -
                     o.separator_cells) < 1e-9 * o.cells);
    vg_forecast_release(&o);
    release(&s);
  }
}

static void the_model_runs_its_tasks(void **state)
{
  double one = 0, before = 0;
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "sphere", 150000);
  o = look(&s, leaves_of(8000), 0);
  assert_int_equal(o.spans.n_rank, 1);
  for (int ranks = 1; ranks <= 16; ranks *= 2) {
    struct vg_machine m = VG_MACHINE_INIT;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_model_result f;

    m.ranks = ranks;
    if (vg_model_replay(&o.spans, &m, &f, NULL, &err) < 0)
      fail_msg("%s", err.text);
    if (ranks == 1) one = before = f.wall;
    assert_true(fabs(f.work - o.spans.wall) < 1e-9 * f.work);
    assert_true(f.wall <= before * 1.02 && f.wall >= one / ranks * 0.999);
    before = f.wall;
  }
  assert_true(fabs(one - o.spans.wall) < 1e-9 * one && before < one / 3);
  vg_forecast_release(&o);
  release(&s);
}

/* Threads of a rank share the loops of joins, ranks of one thread do not. */
static void threads_share_joins(void **state)
{
  struct vg_machine ranks = VG_MACHINE_INIT, threads = VG_MACHINE_INIT;
  struct vg_model_result f, g;
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "box", 200000);
  o = look(&s, leaves_of(2000), 0);
  for (size_t i = 0; i < o.spans.n; i++) {
    const struct vg_span *one = &o.spans.span[i];

    assert_true(one->kind == VG_SPAN_JOIN
                  ? one->loops >= 0 && one->loops < one->cpu
                  : one->loops == 0);
    if (!strcmp(one->path, "0J1")) assert_true(one->loops > 0);
  }
  ranks.ranks = threads.threads = 16;
  ranks.latency = threads.latency = 0;
  assert_int_equal(vg_model_replay(&o.spans, &ranks, &f, NULL, NULL), VG_OK);
  assert_int_equal(vg_model_replay(&o.spans, &threads, &g, NULL, NULL), VG_OK);
  assert_true(fabs(g.work - f.work) < 1e-9 * f.work);
  assert_true(g.critical < f.critical && g.wall < f.wall);
  vg_forecast_release(&o);
  release(&s);
}

static void it_is_the_same_twice(void **state)
{
  struct vg_forecast a, b;
  struct scene s;

  (void)state;
  make(&s, "sphere", 100000);
  a = look(&s, leaves_of(10000), 0);
  b = look(&s, leaves_of(10000), 0);
  assert_int_equal(a.n_node, b.n_node);
  assert_int_equal(a.spans.n, b.spans.n);
  assert_memory_equal(a.node, b.node, a.n_node * sizeof *a.node);
  for (size_t i = 0; i < a.spans.n; i++) {
    const struct vg_span *p = &a.spans.span[i], *q = &b.spans.span[i];

    assert_string_equal(p->path, q->path);
    assert_string_equal(p->after, q->after);
    assert_true(p->cpu == q->cpu && p->n_cell == q->n_cell);
  }
  vg_forecast_release(&a);
  vg_forecast_release(&b);
  release(&s);
}

static void levels_and_axes_are_obeyed(void **state)
{
  struct vg_cut_rule rule = { 0, 2, 1 };
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "box", 100000);
  o = look(&s, rule, 1);
  assert_int_equal(o.n_leaf, 2);
  assert_int_equal(o.node[0].lattice.n[0] + o.node[0].lattice.n[1], 0);
  assert_int_equal(o.node[0].lattice.n[2], 1);
  vg_forecast_release(&o);
  o = look(&s, leaves_of(1e9), 0);
  assert_int_equal(o.n_node, 1);
  assert_int_equal(o.spans.n, 1);
  assert_string_equal(o.spans.span[0].path, "0L");
  assert_string_equal(o.spans.span[0].after, "");
  vg_forecast_release(&o);
  release(&s);
}

/* Far more bisections than there are cells. Where separator zones leave no
 * cells, there is no void to cut, and further bisections add no task. The run
 * of this box with 12 bisections made 81 cuts, 8 of them repeated, 185 tiles
 * and no leaf. */
static void bisections_end_where_no_cells_are_left(void **state)
{
  struct vg_cut_rule rule = { .leaf_cells = 0, .first_axis = -1 };
  struct vg_forecast o, more;
  struct scene s;

  (void)state;
  make(&s, "box", 20000);
  o = look(&s, rule, 12);
  more = look(&s, rule, 24);
  assert_int_equal(o.n_leaf, 0);
  assert_in_range(o.n_node, 1 + 8 + 32, 1 + 8 + 64);
  assert_in_range(o.n_tile, 150, 220);
  assert_true(o.separator_cells > 0.99 * s.load.cells);
  assert_int_equal(more.n_node, o.n_node);
  assert_int_equal(more.spans.n, o.spans.n);
  vg_forecast_release(&o);
  vg_forecast_release(&more);
  release(&s);
}

static void a_faster_core_takes_less_time(void **state)
{
  struct vg_rates half = vg_rates_measured;
  struct vg_forecast a, b = VG_FORECAST_INIT;
  struct vg_cut_rule rule = leaves_of(20000);
  struct scene s;

  (void)state;
  make(&s, "box", 100000);
  half.leaf.task /= 2;
  half.leaf.even /= 2;
  half.leaf.graded /= 2;
  half.leaf.face /= 2;
  a = look(&s, rule, 0);
  assert_int_equal(vg_forecast_new(&s.front, &s.load, &rule, 0, &half, &b,
                                   NULL),
                   VG_OK);
  assert_int_equal(a.spans.n, b.spans.n);
  for (size_t i = 0; i < a.spans.n; i++) {
    double twice = b.spans.span[i].cpu;

    if (a.spans.span[i].kind == VG_SPAN_LEAF) twice *= 2;
    assert_true(fabs(a.spans.span[i].cpu - twice) < 1e-12);
  }
  vg_forecast_release(&a);
  vg_forecast_release(&b);
  release(&s);
}

static double made(const struct vg_spans *s, char kind)
{
  double sum = 0;

  for (size_t i = 0; i < s->n; i++)
    if (s->span[i].kind == kind) sum += (double)s->span[i].n_cell;
  return sum;
}

static int has(const struct vg_spans *s, const struct vg_span *one)
{
  for (size_t i = 0; i < s->n; i++)
    if (!strcmp(s->span[i].path, one->path)) return 1;
  return 0;
}

/* One repair for each separator zone, after all leaves; none without cuts. */
static void repairs_come_last(void **state)
{
  struct vg_forecast o, whole;
  struct scene s;
  size_t n = 0;

  (void)state;
  make(&s, "sphere", 100000);
  o = look(&s, leaves_of(s.load.cells / 8), 0);
  whole = look(&s, leaves_of(2 * s.load.cells), 0);
  for (size_t i = 0; i < o.spans.n; i++) {
    const struct vg_span *one = &o.spans.span[i];

    if (one->kind != VG_SPAN_REPAIR) continue;
    n++;
    assert_true(one->cpu > 0);
    assert_true(one->after[strlen(one->after) - 1] == VG_SPAN_LEAF);
  }
  assert_int_equal(n, o.n_pencil + o.n_tile);
  assert_true(n > 0);
  assert_int_equal(whole.spans.n, 1);
  vg_forecast_release(&o);
  vg_forecast_release(&whole);
  release(&s);
}

/* A uniform box is cut by the same planes: every pencil and tile of the whole
 * has the same name, the number of each kind is equal, the cells of zones agree
 * within a fifth (they were fitted over boxes ten times as large) and those of
 * leaves within a tenth. */
static void a_run_has_these_tasks(void **state)
{
  struct vg_partition_options p = VG_PARTITION_OPTIONS_INIT;
  struct vg_partition_report r;
  struct vg_partition *grown = NULL;
  struct vg_spans spans = VG_SPANS_INIT;
  struct vg_comm *comm = NULL;
  struct vg_forecast o;
  struct scene s;

  (void)state;
  make(&s, "box", 100000);
  p.rule = leaves_of(s.load.cells / 8);
  o = look(&s, p.rule, 0);
  assert_int_equal(vg_comm_open(&comm, NULL), VG_OK);
  assert_int_equal(vg_partition_grow(comm, &s.demo.surface, s.sizing, &p,
                                     &grown, &r, &spans, NULL),
                   VG_OK);
  assert_int_equal(r.n_pencil, o.n_pencil);
  assert_int_equal(r.n_tile, o.n_tile);
  for (size_t i = 0; i < o.spans.n; i++)
    if (o.spans.span[i].kind != VG_SPAN_LEAF &&
        o.spans.span[i].kind != VG_SPAN_REPAIR)
      assert_true(has(&spans, &o.spans.span[i]));
  assert_true(fabs(made(&o.spans, 'L') / made(&spans, 'L') - 1) < 0.1);
  assert_true(fabs(o.separator_cells / (double)r.n_zone_cell - 1) < 0.2);
  vg_partition_free(grown);
  vg_comm_close(comm);
  vg_spans_release(&spans);
  vg_forecast_release(&o);
  release(&s);
}

/* The box, with coordinates along z and the sizes along it divided by
 * `squeeze`. */
static void make_squeezed(struct scene *s, size_t n_cell, double squeeze)
{
  struct vg_source all = { .kind = VG_SOURCE_BOX,
                           .p0 = { -1, -1, -1 },
                           .p1 = { 2, 2, 2 },
                           .stretch = 1 / squeeze,
                           .u = { 0, 0, 1 } };
  struct vg_sizing_options o;

  make(s, "box", n_cell);
  vg_load_release(&s->load);
  vg_sizing_free(s->sizing);
  all.h0 = all.h1 = s->demo.source[0].h0;
  for (size_t i = 0; i < s->demo.surface.n_point; i++)
    s->demo.surface.point[i][2] /= squeeze;
  o = s->demo.sizing;
  o.from_surface = 0;
  assert_int_equal(vg_sizing_new(&o, 1, &all, &s->demo.surface, &s->sizing,
                                 NULL),
                   VG_OK);
  assert_true(vg_sizing_is_stretched(s->sizing));
  assert_int_equal(vg_load_new(&s->front, s->sizing, VG_LOAD_CELLS_PER_CUBE, 1,
                               &s->load, NULL),
                   VG_OK);
}

static double received(const struct vg_spans *s, const char *kinds)
{
  double sum = 0;

  for (size_t i = 0; i < s->n; i++)
    if (strchr(kinds, s->span[i].kind)) sum += (double)s->span[i].bytes_in;
  return sum;
}

static int is_near(double a, double b)
{
  return fabs(a / b - 1) < 0.12;
}

/* A metric maps the squeezed box to the box, and hence each task to one with as
 * many cells and faces. Octants are cubes in both, so that the shares of them
 * in zones differ by some per cent. With distances along the normals of planes
 * instead of those in the metric, separators receive 49 % more faces and leaves
 * 27 %. */
static void a_metric_squeezes_the_forecast(void **state)
{
  struct vg_cut_rule rule = { .leaf_cells = 0, .first_axis = -1 };
  struct vg_forecast o, p;
  struct scene s, t;

  (void)state;
  make(&s, "box", 200000);
  make_squeezed(&t, 200000, 8);
  o = look(&s, rule, 3);
  p = look(&t, rule, 3);
  assert_true(is_near(t.load.cells, s.load.cells));
  assert_int_equal(p.n_leaf, o.n_leaf);
  assert_int_equal(p.n_pencil, o.n_pencil);
  assert_int_equal(p.n_tile, o.n_tile);
  assert_true(is_near(p.separator_cells, o.separator_cells));
  assert_true(is_near(received(&p.spans, "PT"), received(&o.spans, "PT")));
  assert_true(is_near(received(&p.spans, "L"), received(&o.spans, "L")));
  assert_true(is_near(received(&p.spans, "J"), received(&o.spans, "J")));
  vg_forecast_release(&o);
  vg_forecast_release(&p);
  release(&s);
  release(&t);
}

/* Measured meshes of boxes and spheres: 2,068,887 and 1,921,331 cells. */
static void points_follow_from_cells(void **state)
{
  (void)state;
  assert_true(fabs(vg_forecast_points(2068887, 50886) / 354957 - 1) < 0.03);
  assert_true(fabs(vg_forecast_points(1921331, 117364) / 342098 - 1) < 0.03);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(few_leaves_have_whole_planes),
    cmocka_unit_test(parts_follow_their_maker),
    cmocka_unit_test(a_box_has_a_regular_tree),
    cmocka_unit_test(sums_are_the_loads),
    cmocka_unit_test(the_model_runs_its_tasks),
    cmocka_unit_test(threads_share_joins),
    cmocka_unit_test(it_is_the_same_twice),
    cmocka_unit_test(levels_and_axes_are_obeyed),
    cmocka_unit_test(bisections_end_where_no_cells_are_left),
    cmocka_unit_test(a_faster_core_takes_less_time),
    cmocka_unit_test(repairs_come_last),
    cmocka_unit_test(a_run_has_these_tasks),
    cmocka_unit_test(a_metric_squeezes_the_forecast),
    cmocka_unit_test(points_follow_from_cells),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
