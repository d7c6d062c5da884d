/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The timeline of a run: round trip, columns in any order, error messages. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/plot/timeline.h"

#define COLUMNS                                                                \
  "\"columns\": [\"path\",\"after\",\"kind\",\"rank\","                        \
  "\"thread\",\"home\",\"start\",\"end\",\"cpu\",\"estimate\",\"cells\","      \
  "\"bytes_in\",\"bytes_out\"]"
#define HEAD                                                                   \
  "{\"vanguard_timeline\": 1, \"facts\": {\"ranks\": 2, "                      \
  "\"threads\": 3}, "

#define HELP                                                                   \
  "\"help_columns\": [\"path\",\"rank\",\"thread\",\"start\","                 \
  "\"end\"], \"help\": "

static void refuse(const char *text, const char *expected)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_timeline_parse("t.json", text, strlen(text), &t, &err),
                   VG_ERR_FORMAT);
  if (strncmp(err.text, "t.json:", 7) || !strstr(err.text, expected))
    fail_msg("message '%s' lacks '%s'", err.text, expected);
  assert_null(t.spans.span);
}

static void accept(const char *text, struct vg_timeline *t)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_timeline_parse("t.json", text, strlen(text), t, &err) < 0)
    fail_msg("%s", err.text);
}

static void fill(struct vg_timeline *t)
{
  static const struct vg_span span[] = {
    { "0.1L",
      "0J",
      'L',
      { 0 },
      1,
      0,
      0,
      1.25,
      3.5,
      2.125,
      0,
      400,
      1.5e-7,
      500,
      88,
      60,
      7 },
    { "0J",
      "",
      'J',
      { 0 },
      0,
      2,
      0,
      0,
      1.000001,
      1.75,
      1.25,
      300,
      0,
      0,
      9,
      0,
      0 },
  };
  static const struct vg_help help[] = {
    { "0J", 0, 1, 0.125, 0.875 },
    { "0J", 0, 0, 0.25, 0.5 },
  };

  snprintf(t->title, sizeof t->title, "a \"wing\"\n\\ \xc3\xbc");
  snprintf(t->digest, sizeof t->digest, "0123abcd");
  t->n_cell = (uint64_t)1 << 40;
  t->n_point = 12345;
  for (int i = 0; i < VG_PHASE_N; i++) t->seconds[i] = 0.5 + i;
  t->spans.n_rank = 2;
  t->spans.n_thread = 3;
  t->spans.wall = t->seconds[VG_PHASE_ENGINE];
  for (int i = 0; i < 2; i++)
    assert_int_equal(vg_spans_add(&t->spans, &span[i], NULL), VG_OK);
  for (int i = 0; i < 2; i++)
    assert_int_equal(vg_spans_add_help(&t->spans, &help[i], NULL), VG_OK);
}

static void written_files_can_be_read(void **state)
{
  const char *path = VG_TMP_DIR "/round.timeline.json";
  struct vg_timeline t = VG_TIMELINE_INIT, u = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  fill(&t);
  if (vg_timeline_write(path, &t, &err) < 0 ||
      vg_timeline_read(path, &u, &err) < 0)
    fail_msg("%s", err.text);
  assert_string_equal(t.title, u.title);
  assert_string_equal(t.digest, u.digest);
  assert_memory_equal(t.seconds, u.seconds, sizeof t.seconds);
  assert_true(t.n_cell == u.n_cell && t.n_point == u.n_point);
  assert_int_equal(u.spans.n, 2);
  assert_int_equal(u.spans.n_rank, 2);
  assert_int_equal(u.spans.n_thread, 3);
  assert_true(u.spans.wall == t.spans.wall);
  assert_memory_equal(t.spans.span, u.spans.span, 2 * sizeof *t.spans.span);
  assert_int_equal(u.spans.n_help, 2);
  vg_spans_sort(&t.spans);
  assert_int_equal(t.spans.help[0].thread, 0);
  assert_memory_equal(t.spans.help, u.spans.help, 2 * sizeof *u.spans.help);
  /* 2.25 s and 1.000001 s of tasks and 1 s of help, on 6 workers */
  assert_true(fabs(vg_spans_busy(&u.spans) * 6 * u.spans.wall - 4.250001) <
              1e-12);
  vg_timeline_release(&t);
  vg_timeline_release(&u);
  remove(path);
}

/* On the machine of the timeline, the model gives the measured times outside
 * the engine; one core takes longer, except for the serial parts. */
static void time_outside_tasks_matches_the_timeline(void **state)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_machine m = VG_MACHINE_INIT;

  (void)state;
  fill(&t);
  t.seconds[VG_PHASE_TOTAL] = 40;
  vg_timeline_outside(&t, &m);
  assert_true(vg_model_outside(&m) > 90);
  m.ranks = m.ranks_per_node = 2;
  m.threads = 3;
  assert_true(fabs(vg_model_outside(&m) - 35.5) < 1e-12);
  /* The layers took 3.5 s on 6 workers, which are 13.125 s on one core: 12 % of
   * that is serial, 27 % is repeated on every node. Check and sizes are split
   * in the same way. */
  assert_true(fabs(m.by_node - 0.27 * 13.125 - 0.8 * 4.5 - 0.2 * 12) < 1e-12);
  t.seconds[VG_PHASE_TOTAL] = t.seconds[VG_PHASE_WRITE] = 0;
  vg_timeline_outside(&t, &m); /* a timeline without these times */
  assert_true(m.serial > 0);
  assert_true(fabs(m.by_all - 0.75 * 12 - 0.61 * 13.125 -
                   0.99 * 6.5 / (0.01 + 0.99 / 6)) < 1e-12);
  vg_timeline_release(&t);
}

/* A title that is not valid UTF-8 must not make the file invalid. */
static void any_title_can_be_written(void **state)
{
  const char *path = VG_TMP_DIR "/title.timeline.json";
  struct vg_timeline t = VG_TIMELINE_INIT, u = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  fill(&t);
  snprintf(t.title, sizeof t.title,
           "m\xfc"
           "ll");
  if (vg_timeline_write(path, &t, &err) < 0 ||
      vg_timeline_read(path, &u, &err) < 0)
    fail_msg("%s", err.text);
  assert_string_equal(u.title, "m?ll");
  vg_timeline_release(&t);
  vg_timeline_release(&u);
  remove(path);
}

static void columns_come_in_any_order(void **state)
{
  struct vg_timeline t = VG_TIMELINE_INIT;

  (void)state;
  accept(HEAD "\"columns\": [\"new\",\"bytes_out\",\"after\",\"kind\","
              "\"rank\",\"thread\",\"home\",\"start\",\"end\",\"cpu\","
              "\"estimate\",\"cells\",\"bytes_in\",\"path\"], \"spans\": "
              "[[[1,2],9,\"\",\"L\",1,2,0,1,2.5,1,10,11,12,\"0L\"]], "
              "\"more\": null}",
         &t);
  assert_int_equal(t.spans.n, 1);
  assert_string_equal(t.spans.span[0].path, "0L");
  assert_int_equal(t.spans.span[0].bytes_out, 9);
  assert_int_equal(t.spans.span[0].thread, 2);
  assert_true(t.spans.span[0].end == 2.5);
  assert_int_equal(t.n_cell, 0);
  vg_timeline_release(&t);
}

/* Timelines without the columns of loops (older versions) or of later
 * versions. */
static void absent_columns_are_zero(void **state)
{
  struct vg_timeline t = VG_TIMELINE_INIT;

  (void)state;
  accept(HEAD COLUMNS ", \"spans\": [[\"0L\",\"\",\"L\",1,2,0,1,2,1,0,0,0,"
                      "0]], \"help\": []}",
         &t);
  assert_true(t.spans.span[0].loops == 0 && t.spans.span[0].cpu == 1);
  assert_int_equal(t.spans.n_help, 0);
  vg_timeline_release(&t);
}

static void faults_are_reported(void **state)
{
  (void)state;
  refuse("", "not JSON");
  refuse("{\"a\": 1,\n\"a\": 2}", "t.json:2: not JSON");
  refuse("[]", "not a timeline of vanguard mesh");
  refuse("{\"ok\": true}", "give a .timeline.json");
  refuse("{\"vanguard_timeline\": 1}", "\"facts\" is missing");
  refuse("{\"vanguard_timeline\": 1, \"facts\": {\"ranks\": 2}}",
         "fact \"threads\" is not an integer");
  refuse("{\"vanguard_timeline\": 1, \"facts\": {\"ranks\": 0, "
         "\"threads\": 1}}",
         "0 ranks with 1 threads");
  refuse("{\"vanguard_timeline\": 1, \"facts\": {\"ranks\": 1048576, "
         "\"threads\": 1048576}}",
         "number of workers must be");
  refuse("{\"vanguard_timeline\": 1, \"facts\": {\"ranks\": 1, "
         "\"threads\": 1, \"seconds_judge\": -1}}",
         "fact \"seconds_judge\" is not a number from 0");
  refuse(HEAD "\"columns\": [\"path\"]}", "no column \"after\"");
  refuse(HEAD COLUMNS "}", "\"spans\" is missing");
  refuse(HEAD COLUMNS ", \"spans\": [[\"0L\"]]}", "span 1 has no \"after\"");
  refuse(HEAD COLUMNS ", \"spans\": [7]}", "span 1 has no \"path\"");
  refuse(HEAD "\"columns\": [\"path\",\"after\",\"kind\",\"rank\","
              "\"thread\",\"home\",\"start\",\"end\",\"cpu\",\"loops\","
              "\"estimate\",\"cells\",\"bytes_in\",\"bytes_out\"], \"spans\": "
              "[[\"0J\",\"\",\"J\",0,0,0,0,2,1,1.5,0,0,0,0]]}",
         "span 1, task 0J: \"loops\" is not within \"cpu\"");
  refuse(HEAD COLUMNS ", \"spans\": [], \"help\": [[\"0J\",0,0,1,2]]}",
         "no column \"path\" in \"help_columns\"");
  refuse(HEAD COLUMNS ", \"spans\": [], " HELP "[[\"0J\",0,0,1]]}",
         "help 1 has no \"end\"");
  refuse(HEAD COLUMNS ", \"spans\": [], " HELP "[[\"0J\",0,3,1,2]]}",
         "help 1, task 0J: \"thread\" is not an integer from 0 to 2");
  refuse(HEAD COLUMNS ", \"spans\": [], " HELP "[[\"0J\",0,2,3,2]]}",
         "help 1, task 0J: \"end\" is not after");
}

/* The timeline has a valid span, followed by the span with these values. */
static void refuse_span(const char *values, const char *expected)
{
  char text[1024];

  snprintf(text, sizeof text,
           HEAD COLUMNS ", \"spans\": [[\"0J\",\"\","
                        "\"J\",0,0,0,0,1,1,0,0,0,0],[%s]]}",
           values);
  refuse(text, expected);
}

static void faults_of_spans_are_reported(void **state)
{
  (void)state;
  refuse_span("\"\",\"\",\"L\",0,0,0,0,1,1,0,0,0,0",
              "span 2: \"path\" is not of any length");
  refuse_span("1,\"\",\"L\",0,0,0,0,1,1,0,0,0,0", "span 2: \"path\"");
  refuse_span("\"0.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1."
              "1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1L"
              "\",\"\",\"L\",0,0,0,0,1,1,0,0,0,0",
              "span 2: \"path\"");
  refuse_span("\"0L\",\"\",\"l\",0,0,0,0,1,1,0,0,0,0",
              "span 2, task 0L: \"kind\" is not a letter");
  refuse_span("\"0L\",\"\",\"L\",2,0,0,0,1,1,0,0,0,0",
              "\"rank\" is not an integer from 0 to 1");
  refuse_span("\"0L\",\"\",\"L\",0,3,0,0,1,1,0,0,0,0",
              "\"thread\" is not an integer from 0 to 2");
  refuse_span("\"0L\",\"\",\"L\",0,0,-1,0,1,1,0,0,0,0", "\"home\" is not");
  refuse_span("\"0L\",\"\",\"L\",0,0,0,2,1,1,0,0,0,0",
              "\"end\" is not after \"start\"");
  refuse_span("\"0L\",\"\",\"L\",0,0,0,0,1e10,1,0,0,0,0", "\"end\" is not");
  refuse_span("\"0L\",\"\",\"L\",0,0,0,0,1,\"1\",0,0,0,0", "\"cpu\" is not");
  refuse_span("\"0L\",\"\",\"L\",0,0,0,0,1,1,0,0.5,0,0",
              "\"cells\" is not an integer");
}

static void a_missing_file_is_named(void **state)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_timeline_read(VG_TMP_DIR "/none.json", &t, &err),
                   VG_ERR_IO);
  assert_non_null(strstr(err.text, "none.json"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(written_files_can_be_read),
    cmocka_unit_test(time_outside_tasks_matches_the_timeline),
    cmocka_unit_test(any_title_can_be_written),
    cmocka_unit_test(columns_come_in_any_order),
    cmocka_unit_test(absent_columns_are_zero),
    cmocka_unit_test(faults_are_reported),
    cmocka_unit_test(faults_of_spans_are_reported),
    cmocka_unit_test(a_missing_file_is_named),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
