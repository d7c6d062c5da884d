/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures are well-formed, contain the expected elements, and are the same for
 * the same data. Their appearance is not tested. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/plot/plot.h"
#include "cli/plot/svg.h"
#include "partition/model/model.h"

static char *contents(const char *path)
{
  FILE *f = fopen(path, "rb");
  char *text = calloc(1, 1 << 22);

  assert_non_null(f);
  assert_non_null(text);
  assert_true(fread(text, 1, (1 << 22) - 1, f) < (1 << 22) - 1);
  fclose(f);
  return text;
}

/* Check that every element is closed, in the right order, and that no number is
 * NaN or infinite. */
static void assert_well_formed(const char *text)
{
  char open[16][16];
  int depth = 0;

  assert_non_null(strstr(text, "<svg xmlns=\"http://www.w3.org/2000/svg\""));
  assert_null(strstr(text, "nan"));
  assert_null(strstr(text, "inf"));
  text = strstr(text, "?>") + 2;
  while ((text = strchr(text, '<'))) {
    const char *end = strchr(text, '>');
    size_t len = strcspn(text + 1, " />");

    assert_non_null(end);
    if (text[1] == '/') {
      assert_true(depth > 0);
      depth--;
      len = (size_t)(end - text) - 2;
      assert_true(!strncmp(open[depth], text + 2, len) && !open[depth][len]);
    } else if (end[-1] != '/') {
      assert_true(depth < 16 && len < 16);
      memcpy(open[depth], text + 1, len);
      open[depth++][len] = 0;
    }
    text = end;
  }
  assert_int_equal(depth, 0);
}

static void add(struct vg_spans *s, const char *path, const char *after,
                double cpu)
{
  struct vg_span one = { .cpu = cpu, .estimate = 200000 * cpu };

  snprintf(one.path, sizeof one.path, "%s", path);
  snprintf(one.after, sizeof one.after, "%s", after);
  one.kind = path[strcspn(path, "JPTLRX")];
  one.n_cell = (uint64_t)(200000 * cpu);
  assert_int_equal(vg_spans_add(s, &one, NULL), VG_OK);
}

static double drawn(uint32_t *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 16) / 65536;
}

/* Add the spans of a decomposition tree with 2^depth leaves. Each cut has a
 * join, three edge separators, a join, two face separators and a join. */
static void grow(struct vg_spans *s, const char *node, const char *after,
                 int depth, uint32_t *seed)
{
  char path[VG_PATH_MAX], first[VG_PATH_MAX], last[VG_PATH_MAX];
  double size = 0.02 * (1 << depth);

  if (depth == 0) {
    snprintf(path, sizeof path, "%.50sL", node);
    add(s, path, after, 0.3 + 0.4 * drawn(seed));
    return;
  }
  snprintf(first, sizeof first, "%.50sJ1", node);
  add(s, first, after, 0.002);
  for (int i = 0; i < 3; i++) {
    snprintf(last, sizeof last, "%.50sP%d", node, i);
    add(s, last, first, 0.1 * size * (1 + drawn(seed)));
  }
  snprintf(path, sizeof path, "%.50sJ2", node);
  add(s, path, last, 0.002);
  for (int i = 0; i < 2; i++) {
    snprintf(last, sizeof last, "%.50sT%d", node, i);
    add(s, last, path, 0.4 * size * (1 + drawn(seed)));
  }
  snprintf(first, sizeof first, "%.50sJ3", node);
  add(s, first, last, 0.003);
  for (int i = 1; i <= 2; i++) {
    snprintf(path, sizeof path, "%.40s.%d", node, i);
    grow(s, path, first, depth - 1, seed);
  }
}

static void make(int ranks, int threads, struct vg_timeline *t)
{
  static const double seconds[VG_PHASE_N] = { 0.2, 0.5, 0.4, 1.1, 0,
                                              0.1, 0.3, 0.6, 0 };
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_model_result f;
  struct vg_spans s = VG_SPANS_INIT;
  uint32_t seed = 5;

  grow(&s, "0", "", 5, &seed);
  for (int i = 0; i < 4; i++) {
    char path[16];

    snprintf(path, sizeof path, "0R%d", i);
    add(&s, path, "0.1.1.1.1.1L", 0.05 + 0.1 * drawn(&seed));
  }
  for (size_t i = 0; i < s.n; i++)
    if (s.span[i].kind == VG_SPAN_JOIN) s.span[i].loops = s.span[i].cpu / 2;
  m.ranks = ranks;
  m.threads = threads;
  assert_int_equal(vg_model_replay(&s, &m, &f, &t->spans, NULL), VG_OK);
  vg_spans_release(&s);
  snprintf(t->title, sizeof t->title, "Wing <M6> & \"co\"");
  t->n_cell = 5234567;
  memcpy(t->seconds, seconds, sizeof seconds);
  t->seconds[VG_PHASE_ENGINE] = t->spans.wall;
  t->seconds[VG_PHASE_TOTAL] = t->spans.wall + 3.2;
}

static void a_timeline_is_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/timeline.svg";
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char *text, *again;

  (void)state;
  make(4, 2, &t);
  if (vg_plot_timeline(path, &t, &err) < 0) fail_msg("%s", err.text);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, "Wing &lt;M6&gt; &amp; &quot;co&quot;"));
  assert_non_null(strstr(text, "rank 3, thread 1"));
  assert_non_null(strstr(text, "4 ranks x 2 threads, 5,234,567 cells"));
  assert_non_null(strstr(text, ">leaf "));
  assert_non_null(strstr(text, ">pencil "));
  assert_non_null(strstr(text, ">help "));
  assert_non_null(strstr(text, "time, s"));
  if (vg_plot_timeline(path, &t, &err) < 0) fail_msg("%s", err.text);
  again = contents(path);
  assert_string_equal(text, again);
  free(text);
  free(again);
  vg_timeline_release(&t);
}

static void many_lanes_are_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/lanes.svg";
  struct vg_timeline t = VG_TIMELINE_INIT;
  char *text;

  (void)state;
  make(128, 4, &t);
  assert_int_equal(vg_plot_timeline(path, &t, NULL), VG_OK);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, "rank 0"));
  assert_null(strstr(text, "rank 1<"));
  free(text);
  vg_timeline_release(&t);
}

/* Values that only a damaged record can contain must not break a figure. */
static void odd_records_are_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/odd.svg";
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_span far = { "0L", "",  'Q', { 0 }, 7,    7, 0,
                         1e9,  1e9, 1,   0,     1e15, 0, (uint64_t)1 << 53,
                         0,    0,   0 };
  char *text;

  (void)state;
  snprintf(t.title, sizeof t.title, "m\xfc\x01");
  t.spans.n_rank = t.spans.n_thread = 1;
  assert_int_equal(vg_plot_timeline(path, &t, NULL), VG_OK);
  assert_int_equal(vg_plot_sizes(path, &t, 0, NULL), VG_OK);
  assert_int_equal(vg_spans_add(&t.spans, &far, NULL), VG_OK);
  far.kind = 'L';
  far.rank = far.thread = 0;
  assert_int_equal(vg_spans_add(&t.spans, &far, NULL), VG_OK);
  t.spans.span[0].rank = t.spans.span[0].thread = 0;
  t.spans.wall = 1e-300;
  assert_int_equal(vg_plot_sizes(path, &t, 1e15, NULL), VG_OK);
  assert_int_equal(vg_plot_timeline(path, &t, NULL), VG_OK);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, ">m? <"));
  free(text);
  vg_timeline_release(&t);
}

static void sizes_are_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/sizes.svg";
  struct vg_timeline t = VG_TIMELINE_INIT;
  char *text;

  (void)state;
  make(2, 1, &t);
  assert_int_equal(vg_plot_sizes(path, &t, 100000, NULL), VG_OK);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, "32 leaves: smallest "));
  assert_non_null(strstr(text, "requested 100k"));
  free(text);
  vg_timeline_release(&t);
}

static void speedup_is_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/speedup.svg";
  const double workers[] = { 1, 2, 4 }, low[] = { 1, 1.8, 3.4 };
  const double high[] = { 1.02, 1.95, 3.6 };
  const double many[] = { 1, 2, 4, 8, 16, 32, 64, 128, 256, 512 };
  const double model[] = { 1, 1.9, 3.7, 7.2, 14, 27, 50, 90, 140, 160 };
  const struct vg_plot_series series[] = {
    { "leaves of 50k", 0, 0, 3, workers, low },
    { "leaves of 300k", 1, 0, 3, workers, high },
    { "leaves of 50k, model", 0, 1, 10, many, model },
  };
  char *text;

  (void)state;
  assert_int_equal(vg_plot_speedup(path, "Sphere", "against 1 worker: 63.2 s",
                                   3, series, NULL),
                   VG_OK);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, ">ideal<"));
  assert_non_null(strstr(text, ">512<"));
  assert_non_null(strstr(text, "stroke-dasharray"));
  free(text);
  assert_int_equal(vg_plot_speedup(VG_TMP_DIR "/speedup2.svg", "Sphere", "", 2,
                                   series, NULL),
                   VG_OK);
  text = contents(VG_TMP_DIR "/speedup2.svg");
  assert_well_formed(text);
  assert_null(strstr(text, ">512<"));
  free(text);
}

static void phases_are_drawn(void **state)
{
  const char *path = VG_TMP_DIR "/phases.svg";
  const double one[VG_PHASE_N] = { 1, 2, 3, 4, 60, 1, 3, 5, 80 };
  const double two[VG_PHASE_N] = { 1, 2, 3, 4, 31, 1, 1.5, 3, 47 };
  const double none[VG_PHASE_N] = { 0 };
  const struct vg_plot_bar bars[] = {
    { "1 rank x 1 thread, leaves of 50k", one },
    { "2 ranks x 1 thread, leaves of 50k", two },
    { "none", none },
  };
  char *text;

  (void)state;
  assert_int_equal(vg_plot_phases(path, "Phases", 3, bars, NULL), VG_OK);
  text = contents(path);
  assert_well_formed(text);
  assert_non_null(strstr(text, ">cut+fill<"));
  assert_non_null(strstr(text, ">80 s<"));
  free(text);
}

static void axes_have_round_ticks(void **state)
{
  static const struct {
    double most;
    int n;
    double step, hi;
  } row[] = {
    { 10, 5, 2, 10 },       { 9.5, 5, 2, 10 },
    { 0.37, 8, 0.05, 0.4 }, { 1234567, 6, 500000, 1500000 },
    { 1, 1, 1, 1 },
  };
  static const struct {
    double v;
    const char *text;
  } number[] = {
    { 0, "0" },       { 0.25, "0.25" },     { 9999, "9999" },
    { 10000, "10k" }, { 123456, "123.5k" }, { 2.5e6, "2.5M" },
    { -0.0001, "0" }, { -12, "-12" },       { 3e12, "3000G" },
  };
  char text[32];

  (void)state;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
    struct vg_axis a = vg_axis_linear(row[i].most, row[i].n, 100, 0);

    assert_true(fabs(a.step - row[i].step) < 1e-12 * row[i].step);
    assert_true(fabs(a.hi - row[i].hi) < 1e-12 * row[i].hi);
    assert_true(fabs(vg_axis_at(&a, a.hi)) < 1e-9);
  }
  for (size_t i = 0; i < sizeof number / sizeof *number; i++)
    assert_string_equal(vg_svg_number(number[i].v, text), number[i].text);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_timeline_is_drawn),
    cmocka_unit_test(many_lanes_are_drawn),
    cmocka_unit_test(odd_records_are_drawn),
    cmocka_unit_test(sizes_are_drawn),
    cmocka_unit_test(speedup_is_drawn),
    cmocka_unit_test(phases_are_drawn),
    cmocka_unit_test(axes_have_round_ticks),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
