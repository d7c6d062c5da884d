/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "cli/http/archive.h"
#include "cli/http/fields.h"
#include "cli/serve/form.h"
#include "cli/http/http.h"
#include "cli/http/inside.h"
#include "cli/http/visitors.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/projects.h"
#include "cli/serve/runs.h"
#include "portal_support.h"
#include "run/settings/deck.h"

static struct portal_scene scene;

/* --- parts --------------------------------------------------------------- */

static void put(struct vg_fields *f, const char *name, const char *value)
{
  struct vg_error err;

  assert_int_equal(vg_fields_put(f, name, value, 0, strlen(value), &err),
                   VG_OK);
}

static void fields_arrive_in_pieces(void **state)
{
  struct vg_fields f = VG_FIELDS_INIT;
  struct vg_error err;
  int n;

  (void)state;
  put(&f, "a", "one");
  assert_int_equal(vg_fields_put(&f, "a", " two", 3, 4, &err), VG_OK);
  assert_string_equal(vg_fields_get(&f, "a"), "one two");
  assert_null(vg_fields_get(&f, "b"));
  /* Refused: a piece that does not follow the previous one, a zero byte, too
   * many bytes. */
  assert_int_equal(vg_fields_put(&f, "a", "x", 9, 1, &err), VG_ERR_INPUT);
  assert_int_equal(vg_fields_put(&f, "b", "x", 1, 1, &err), VG_ERR_INPUT);
  assert_int_equal(vg_fields_put(&f, "b", "x\0y", 0, 3, &err), VG_ERR_INPUT);
  assert_int_equal(vg_fields_put(&f, "b", NULL, 0, VG_FIELDS_BYTES, &err),
                   VG_ERR_INPUT);
  put(&f, "n", "12");
  assert_int_equal(vg_fields_count(&f, "n", "n", 1, 20, 3, &n, &err), VG_OK);
  assert_int_equal(n, 12);
  assert_int_equal(vg_fields_count(&f, "n", "n", 1, 11, 3, &n, &err),
                   VG_ERR_INPUT);
  assert_int_equal(vg_fields_count(&f, "m", "m", 1, 11, 3, &n, &err), VG_OK);
  assert_int_equal(n, 3);
  while (f.n < VG_FIELDS_MAX) put(&f, "x", "");
  assert_int_equal(vg_fields_put(&f, "x", "", 0, 0, &err), VG_ERR_INPUT);
  vg_fields_release(&f);
}

static void check_inside(const char *name, vg_status expected)
{
  char *real = NULL;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_inside(scene.root, name, &real, &err), expected);
  if (expected < 0) assert_null(real);
  free(real);
}

static void paths_stay_inside(void **state)
{
  static const char *const bad[] = { "..",
                                     "../other/secret.obj",
                                     "/etc/passwd",
                                     "./octa.obj",
                                     "octa.obj/",
                                     "a//b",
                                     "vanguard-runs/../../other",
                                     "out.obj",
                                     "away",
                                     "away/secret.obj",
                                     "a\nb",
                                     "\xff",
                                     "a/..",
                                     "." };

  (void)state;
  check_inside("", VG_OK);
  check_inside("octa.obj", VG_OK);
  check_inside("vanguard-runs", VG_OK);
  check_inside("nothing", VG_ERR_IO);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    check_inside(bad[i], VG_ERR_INPUT);
  assert_true(vg_inside_holds("/", "/a"));
  assert_true(vg_inside_holds("/a", "/a/b"));
  assert_false(vg_inside_holds("/a", "/ab"));
}

static void names_of_files_are_plain(void **state)
{
  static const char *const bad[] = { "",    ".",    "..",    ".x",      "-x",
                                     "a/b", "a\\b", "a\x01", "\xc0\x80" };
  struct vg_error err;
  char longest[202];

  (void)state;
  memset(longest, 'a', 201);
  longest[201] = 0;
  assert_int_equal(vg_inside_name(longest, &err), VG_ERR_INPUT);
  longest[200] = 0;
  assert_int_equal(vg_inside_name(longest, &err), VG_OK);
  assert_int_equal(vg_inside_name("fl\xc3\xbcgel 2.stl", &err), VG_OK);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_int_equal(vg_inside_name(bad[i], &err), VG_ERR_INPUT);
}

static void markup_is_escaped(void **state)
{
  char *text;
  size_t size;
  FILE *to = open_memstream(&text, &size);

  (void)state;
  vg_markup(to, "<b a=\"x\" b='y'>&\x01\xff\xc3\xa4\n");
  fputs("|", to);
  vg_markup_path(to, "a b/<c>.stl");
  fputs("|", to);
  vg_markup_size(to, 999);
  fputs("|", to);
  vg_markup_size(to, 1234567);
  fclose(to);
  assert_string_equal(text, "&lt;b a=&quot;x&quot; b=&#39;y&#39;&gt;&amp; "
                            "?\xc3\xa4\n|a%20b/%3Cc%3E.stl|999 B|1.2 MB");
  free(text);
}

static void progress_lines_are_parsed(void **state)
{
  static const char *const other[] = { "",
                                       "vanguard: no room",
                                       "Surface",
                                       "  points  12",
                                       "fill 12 of ~x",
                                       "fill 12 of ~20 nonsense",
                                       "fill 3 4",
                                       "3 of 2: n1",
                                       "0 of 2: n1" };
  static const char tail[] = "ill  1\nread\nfill         1 of ~2   50%\nx 9";
  struct vg_tell t = VG_TELL_INIT;

  (void)state;
  assert_true(vg_tell_line("read", 4, &t));
  assert_string_equal(t.stage, "read");
  assert_true(t.share < 0);
#define LINE                                                                   \
  "cut and join              12,345 of ~27,000   46%  350,000/s"               \
  "  ETA 2 min 10 s"
  assert_true(vg_tell_line(LINE, sizeof LINE - 1, &t));
  assert_string_equal(t.stage, "cut and join");
  assert_string_equal(t.count, "12,345 of 27,000");
  assert_string_equal(t.rate, "350,000/s");
  assert_string_equal(t.left, "2 min 10 s");
  assert_true(t.share > 0.459 && t.share < 0.461);
  assert_true(vg_tell_line("2 of 4: n1-t2", 13, &t));
  assert_string_equal(t.stage, "n1-t2");
  assert_true(t.share == 0.25);
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    assert_false(vg_tell_line(other[i], strlen(other[i]), &t));
  assert_false(vg_tell_line("re\0d", 4, &t));
  assert_true(vg_tell_tail(tail, sizeof tail - 1, 0, &t));
  assert_string_equal(t.count, "1 of 2");
  /* The end of "/folder/big" is no stage. */
  assert_false(vg_tell_tail("ig\n", 3, 1, &t));
  assert_true(vg_tell_tail("ig\nread\n", 8, 1, &t));
  assert_string_equal(t.stage, "read");
  assert_int_equal(vg_tell_status("x\nexit status 4 after 1.2 s\n", 27), 4);
  assert_int_equal(vg_tell_status("exit status 4", 13), -1);
  assert_int_equal(vg_tell_status("\nexit status 4", 14), -1);
  assert_int_equal(vg_tell_status("\nexit status ", 13), -1);
}

/* --- settings ------------------------------------------------------------ */

/* Where the last form was wrong. */
static struct vg_form_fault fault;

static vg_status settings_of(const struct vg_fields *f, struct vg_settings *s,
                             struct vg_error *err)
{
  const struct vg_form_fault nowhere = VG_FORM_FAULT_INIT;

  vg_settings_default(s);
  fault = nowhere;
  return vg_form_settings(f, scene.root, s, &fault, err);
}

static void a_form_becomes_settings(void **state)
{
  struct vg_fields f = VG_FIELDS_INIT;
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  put(&f, "title", "  Wing, Mach 0.8");
  put(&f, "s.growth", "1.3");
  put(&f, "s.hmax", "");
  put(&f, "s.layers", "yes");
  put(&f, "s.walls", "1-3, 5");
  put(&f, "farfield.kind", "box");
  put(&f, "farfield.lengths", "7");
  put(&f, "sweep.threads", "1,2");
  put(&f, "patches", "\r\nid bc name # it\r\n\r\n3 4 \"a wing\"\r\n4 - -");
  put(&f, "layers", "id y_plus\n3 1"); /* requires the fields below */
  put(&f, "s.reynolds", "1e6");
  put(&f, "s.reference_length", "1");
  put(&f, "sources", "kind x0 h0\npoint 1 0.5\nsphere 2 0.25\n");
  assert_int_equal(settings_of(&f, &s, &err), VG_OK);
  assert_string_equal(s.title, "Wing, Mach 0.8");
  assert_true(s.growth == 1.3 && s.hmax == 0);
  assert_int_equal(s.layer.grow, VG_ANSWER_YES);
  assert_int_equal(s.farfield.kind, VG_DOMAIN_BOX);
  assert_true(s.farfield.lengths == 7);
  assert_string_equal(s.sweep.threads, "1,2");
  assert_int_equal(s.n_patch, 2);
  assert_string_equal(s.patch[0].name, "a wing");
  assert_int_equal(s.n_source, 2);
  /* A setting without a field keeps its value; a setting with an empty field
   * gets its default. */
  f.item[1].value[0] = 0;
  assert_string_equal(f.item[1].name, "s.growth");
  s.hmin = 0.125;
  s.layer.grow = VG_ANSWER_NO;
  assert_int_equal(vg_form_settings(&f, scene.root, &s, &fault, &err), VG_OK);
  assert_true(s.growth == 1.2 && s.hmin == 0.125);
  assert_int_equal(s.layer.grow, VG_ANSWER_YES);
  assert_int_equal(s.n_source, 2);
  vg_settings_release(&s);
  vg_fields_release(&f);
}

/* The message contains `why`, and the fault is in this field. */
static void refuses(const char *name, const char *value, const char *why)
{
  struct vg_fields f = VG_FIELDS_INIT;
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;

  put(&f, name, value);
  if (!strcmp(name, "s.first_from")) { /* It requires these fields. */
    put(&f, "s.y_plus", "1");
    put(&f, "s.reynolds", "1e6");
    put(&f, "s.reference_length", "1");
  }
  assert_true(settings_of(&f, &s, &err) < 0);
  if (!strstr(err.text, why)) fail_msg("'%s' lacks '%s'", err.text, why);
  assert_string_equal(fault.field, name);
  vg_settings_release(&s);
  vg_fields_release(&f);
}

static void a_refused_form_names_the_field(void **state)
{
  char path[300];

  (void)state;
  refuses("s.growth", "0.5", "growth is 0.5; it must be above 1");
  refuses("s.hmin", "x", "hmin must be a number");
  refuses("title", "a\nb", "title");
  refuses("sources", "kind x0\npoint 1", "sources, line 2: ");
  refuses("sources", "\nkind x0 h0\n\npoint 1", "sources, line 4: 2 values");
  refuses("sources", "kind h0 h0\npoint 1 1", "h0 appears twice");
  refuses("patches", "id name\n3 \"wing",
          "line 2: a quotation mark is not closed");
  assert_int_equal(fault.line, 2);
  refuses("patches", "id bc\n3 4\n3 5", "patch 3 is listed twice");
  refuses("farfield.lengths", "0", "lengths is 0");
  refuses("s.first", "-1", "first");
  refuses("s.mesher", "./it.so", "plug-in");
  /* The field of a table cannot contain settings. */
  refuses("patches", "id bc\n1 4\n\nmesher\n./it.so", "line 4: 1 values");
  refuses("s.sizes", "../other/secret.obj", "not a path below");
  refuses("s.sizes", "/etc/passwd", "not a path below");
  refuses("s.sizes", "out.obj", "is outside");
  snprintf(path, sizeof path, "%s/../other/secret.obj", scene.root);
  refuses("s.sizes", path, "not a path below");
  refuses("s.mapbc", path, "not a path below");
  refuses("s.first_from", "/etc/passwd", "not a path below");
  refuses("s.first_from", scene.root, "is a folder");
  /* Values that contradict each other: the first setting of the message. */
  refuses("s.y_plus", "1", "y_plus requires reynolds");
  refuses("s.constant_direction", "yes", "requires a split_direction");
  refuses("s.mapbc", "out.obj", "is outside");
}

/* The value of an attribute in the printed form, that is, of a field that the
 * browser would send back. Ends the text there. */
static char *attribute(char *at, const char *name)
{
  char *found = strstr(at, name), *end;

  if (!found) return NULL;
  found += strlen(name);
  end = strchr(found, '"');
  *end = 0;
  return found;
}

static void a_printed_form_comes_back(void **state)
{
  struct vg_settings s, back;
  struct vg_fields f = VG_FIELDS_INIT, none = VG_FIELDS_INIT;
  struct vg_source source = { .kind = VG_SOURCE_SPHERE,
                              .h0 = 0.25,
                              .p0 = { 1, 2, 3 },
                              .an = 1,
                              .group = "a \"b\"" };
  struct vg_form_view view = { "octa.obj", &s, &none, &fault, NULL, 1 };
  struct vg_error err = VG_ERROR_INIT;
  char *text, *at, *table, path[300];
  size_t size;
  FILE *to = open_memstream(&text, &size);

  (void)state;
  vg_settings_default(&s);
  s.growth = 1.1;
  s.layer.first = 1e-5;
  assert_int_equal(vg_settings_add(&s, VG_TABLE_SOURCES, &source, &err), VG_OK);
  vg_form_print(to, &view);
  fclose(to);
  table = strstr(text, "name=\"sources\"");
  assert_non_null(table);
  table = strstr(table, ">\n") + 2;
  assert_non_null(strstr(table, "&quot;a &quot;&quot;b&quot;&quot;&quot;"));
  assert_true(!strncmp(table, "kind", 4));
  for (at = text; (at = strstr(at, "<input autocomplete"));) {
    char *name = attribute(at, " name=\""), *value;

    value = attribute(name + strlen(name) + 1, " value=\"");
    put(&f, name, value);
    at = value + strlen(value) + 1;
  }
  put(&f, "farfield.kind", "auto");
  assert_int_equal(settings_of(&f, &back, &err), VG_OK);
  assert_true(back.growth == 1.1 && back.layer.first == 1e-5);
  snprintf(path, sizeof path, "%s/back.deck", scene.dir);
  assert_int_equal(vg_deck_write(path, &back, NULL, VG_DECK_ALL, &err), VG_OK);
  assert_int_equal(vg_deck_read(path, &s, &err), VG_OK);
  assert_true(s.growth == 1.1 && s.layer.first == 1e-5);
  free(text);
  vg_settings_release(&back);
  vg_settings_release(&s);
  vg_fields_release(&f);
}

static void places_are_checked(void **state)
{
  static const struct {
    const char *name, *value;
    vg_status st;
  } t[] = { { "ranks", "2", VG_OK },
            { "ranks", "0", VG_ERR_INPUT },
            { "time", "1-02:00:00", VG_OK },
            { "time", "1; rm", VG_ERR_INPUT },
            { "partition", "--x", VG_ERR_INPUT },
            { "partition", "big", VG_OK },
            { "where", "moon", VG_ERR_INPUT },
            { "where", "slurm", VG_OK } };
  struct vg_error err;

  (void)state;
  for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
    struct vg_fields f = VG_FIELDS_INIT;
    struct vg_serve_run run = { 0 };

    put(&f, t[i].name, t[i].value);
    assert_int_equal(vg_form_run(&f, &run, &fault, &err), t[i].st);
    if (t[i].st < 0) assert_string_equal(fault.field, t[i].name);
    vg_fields_release(&f);
  }
}

static void projects_are_found(void **state)
{
  struct vg_projects list;
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_projects_list(scene.root, &list, &err), VG_OK);
  assert_int_equal(list.n, 1);
  assert_string_equal(list.item[0].name, "octa.obj");
  vg_projects_release(&list);
  assert_int_equal(vg_project_settings(scene.root, "octa.obj", NULL, &s, &err),
                   VG_OK);
  assert_string_equal(s.title, "octa");
  vg_settings_release(&s);
  assert_int_equal(vg_project_settings(scene.root, "out.obj", NULL, &s, &err),
                   VG_ERR_INPUT);
  /* A deck next to the surface that is a link to a file outside the folder. */
  portal_file(scene.root, "b.obj", "v 0 0 0\n");
  {
    char path[400];

    snprintf(path, sizeof path, "%s/b.deck", scene.root);
    assert_int_equal(symlink("../other/secret.obj", path), 0);
    assert_int_equal(vg_project_settings(scene.root, "b.obj", NULL, &s, &err),
                     VG_ERR_INPUT);
    assert_non_null(strstr(err.text, "b.deck is outside"));
    assert_null(strstr(err.text, PORTAL_SECRET));
    unlink(path);
  }
}

/* --- records and jobs ---------------------------------------------------- */

static struct vg_serve_runs empty_runs(void)
{
  static const struct vg_portal_options o = VG_PORTAL_OPTIONS_INIT;
  struct vg_serve_runs r = { .o = &o, .root = scene.root };

  assert_true(asprintf(&r.dir, "%s/runs", scene.dir) > 0);
  mkdir(r.dir, 0777);
  return r;
}

static void records_come_back(void **state)
{
  struct vg_serve_runs r = empty_runs(), again = empty_runs();
  struct vg_serve_run *run;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_runs_new(&r, &run, &err), VG_OK);
  assert_int_equal(run->id, 1);
  free(run->project);
  run->project = strdup("a \"b\".stl");
  strcpy(run->title, "fl\xc3\xbcgel");
  run->is_slurm = 1;
  run->ranks = 7;
  strcpy(run->job, "4711");
  run->state = VG_SERVE_PENDING;
  assert_int_equal(vg_record_write(run, &err), VG_OK);
  assert_int_equal(vg_runs_new(&r, &run, &err), VG_OK);
  /* A run that was active when the portal ended, and has ended since. */
  run->state = VG_SERVE_RUNNING;
  run->pid = getpid();
  run->pid_start = vg_process_start(getpid()) + 1;
  assert_true(run->pid_start > 1);
  assert_int_equal(vg_record_write(run, &err), VG_OK);
  assert_int_equal(vg_runs_new(&r, &run, &err), VG_OK);
  portal_file(run->dir, "run.json", "{\"state\": \"done\"}");
  assert_int_equal(vg_runs_open(&again, &err), VG_OK);
  assert_int_equal(again.n, 2); /* the third has no record */
  run = again.item[0];
  assert_string_equal(run->project, "a \"b\".stl");
  assert_string_equal(run->title, "fl\xc3\xbcgel");
  assert_int_equal(run->ranks, 7);
  assert_int_equal(run->state, VG_SERVE_PENDING);
  assert_int_equal(again.item[1]->state, VG_SERVE_FAILED);
  assert_non_null(strstr(again.item[1]->note, "without an exit status"));
  /* The number of an existing run is not used again. */
  assert_int_equal(vg_runs_new(&again, &run, &err), VG_OK);
  assert_int_equal(run->id, 4);
  vg_runs_release(&r);
  vg_runs_release(&again);
}

static void damaged_records_are_refused(void **state)
{
  static const char *const bad[] = {
    "", "{}", "[1]", "{\"state\": 1}",
    "{\"state\": \"done\", \"state\": \"done\"}"
  };
  struct vg_serve_run run = { .id = 3 };
  struct vg_error err;

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_int_equal(vg_record_parse("it", bad[i], strlen(bad[i]), &run, &err),
                     VG_ERR_FORMAT);
  assert_null(run.project);
}

static void job_states_follow_squeue(void **state)
{
  struct vg_serve_runs r = empty_runs();
  struct vg_serve_run *run[3];
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int k = 0; k < 3; k++) {
    assert_int_equal(vg_runs_new(&r, &run[k], &err), VG_OK);
    run[k]->is_slurm = 1;
    run[k]->state = VG_SERVE_PENDING;
    snprintf(run[k]->job, sizeof run[k]->job, "%d", 12 + k);
  }
  r.squeue_start = 5;
  run[2]->submitted = 6; /* after squeue was started */
  vg_runs_take_squeue(&r, "112 RUNNING\n12 RUNNING\n", 23);
  assert_int_equal(run[0]->state, VG_SERVE_RUNNING);
  assert_int_equal(run[1]->state, VG_SERVE_FAILED);
  assert_int_equal(run[2]->state, VG_SERVE_PENDING);
  portal_file(run[0]->dir, "run.log", "x\nexit status 4 after 3.00 s\n");
  vg_runs_take_squeue(&r, "", 0);
  assert_int_equal(run[0]->state, VG_SERVE_LIMIT);
  vg_runs_release(&r);
}

/* --- requests ------------------------------------------------------------ */

/* Send the request `format`, whose %s is the token, and check the status of the
 * response. */
static void asks(int status, const char *format)
{
  char request[8192], expected[32];
  int n = snprintf(request, sizeof request, format, scene.token);

  assert_true(n > 0 && n < (int)sizeof request);
  portal_ask(&scene, request, (size_t)n);
  snprintf(expected, sizeof expected, "HTTP/1.1 %d ", status);
  if (strncmp(scene.answer, expected, strlen(expected)) != 0)
    fail_msg("not %d but '%.30s' %.200s for\n%s", status, scene.answer,
             strstr(scene.answer, "role=\"alert\"")
               ? strstr(scene.answer, "role=\"alert\"")
               : "",
             request);
  assert_null(strstr(scene.answer, PORTAL_SECRET));
}

#define HOST "Host: 127.0.0.1:8765\r\n"
#define OWN HOST "Origin: http://127.0.0.1:8765\r\n"
#define FORM "Content-Type: application/x-www-form-urlencoded\r\n"

static void need_server(void)
{
  if (!scene.p) skip();
}

static void gate_refuses_unauthorised_requests(void **state)
{
  (void)state;
  need_server();
  asks(200, "GET /%s HTTP/1.1\r\n" HOST "\r\n");
  asks(200, "GET /%s HTTP/1.1\r\nHost: localhost:9\r\n\r\n");
  asks(200, "GET /%s HTTP/1.1\r\nHost: [::1]\r\n\r\n");
  asks(403, "GET / HTTP/1.1\r\n" HOST "\r\n");
  asks(403, "GET /0123456789abcdef0123456789abcdef/ HTTP/1.1\r\n" HOST "\r\n");
  asks(403, "GET /x%s HTTP/1.1\r\n" HOST "\r\n");
  asks(403, "GET /%s HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  asks(403, "GET /%s HTTP/1.1\r\nHost: 127.0.0.1.evil.example\r\n\r\n");
  asks(403, "GET /%s HTTP/1.1\r\nHost: localhost:80x\r\n\r\n");
  asks(405, "PUT /%s HTTP/1.1\r\n" HOST "\r\n");
  /* POST is accepted only from the portal's own pages. */
  asks(403, "POST /%sruns HTTP/1.1\r\n" HOST FORM "Content-Length: 0\r\n\r\n");
  asks(403, "POST /%sruns HTTP/1.1\r\n" HOST FORM "Origin: null\r\n"
            "Content-Length: 0\r\n\r\n");
  asks(403, "POST /%sruns HTTP/1.1\r\n" HOST FORM
            "Origin: http://evil.example\r\nContent-Length: 0\r\n\r\n");
  asks(413,
       "POST /%sruns HTTP/1.1\r\n" OWN FORM "Content-Length: 2000000\r\n\r\n");
  asks(413, "POST /%supload HTTP/1.1\r\n" OWN
            "Content-Type: multipart/form-data; boundary=XYZ\r\n"
            "Content-Length: 70000\r\n\r\n");
}

/* Connections that never complete a request keep nobody out, and end. */
static void slow_connections_make_room(void **state)
{
  enum { N = 70 };
  int mine[N], n_open = 0;
  char byte;

  (void)state;
  need_server();
  for (int i = 0; i < N; i++) {
    struct vg_error err = VG_ERROR_INIT;
    int fd[2];

    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fd),
                     0);
    mine[i] = fd[0];
    assert_int_equal(send(fd[0], "GET /", 5, MSG_NOSIGNAL), 5);
    if (vg_portal_connect(scene.p, fd[1], &err)) fail_msg("%s", err.text);
    vg_portal_step(scene.p, 0, &err);
  }
  asks(200, "GET /%s HTTP/1.1\r\n" HOST "\r\n");
  for (int i = 0; i < N; i++) {
    n_open += read(mine[i], &byte, 1) < 0;
    close(mine[i]);
  }
  assert_true(n_open <= VG_HTTP_VISITORS);
}

static void visits_end(void **state)
{
  struct vg_visitors all;
  struct vg_visitor one[3];
  int fd[3][2];
  char byte;

  (void)state;
  vg_visitors_init(&all);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fd[i]),
                     0);
    vg_visitors_add(&all, &one[i], fd[i][1]);
  }
  vg_visitors_remove(&all, &one[1]); /* it is trusted */
  vg_visitors_remove(&all, &one[1]);
  vg_visitors_expire(&all, one[0].since);
  assert_int_equal(all.n, 2);
  vg_visitors_expire(&all, one[2].since + 1);
  assert_int_equal(all.n, 0);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(read(fd[i][0], &byte, 1), i == 1 ? -1 : 0);
    for (int k = 0; k < 2; k++) close(fd[i][k]);
  }
}

static void pages_are_safe(void **state)
{
  (void)state;
  need_server();
  asks(200, "GET /%s?project=octa.obj HTTP/1.1\r\n" HOST "\r\n");
  assert_non_null(strstr(scene.answer, "frame-ancestors 'none'"));
  assert_non_null(strstr(scene.answer, "X-Content-Type-Options: nosniff"));
  assert_non_null(strstr(scene.answer, "name=\"s.growth\""));
  asks(200, "GET /%s?project=%%3Cscript%%3Ealert(1) HTTP/1.1\r\n" HOST "\r\n");
  assert_null(strstr(scene.answer, "<script>alert"));
  asks(200, "GET /%s?project=../other/secret.obj HTTP/1.1\r\n" HOST "\r\n");
  asks(200, "GET /%s?project=out.obj HTTP/1.1\r\n" HOST "\r\n");
  assert_non_null(strstr(scene.answer, "is outside"));
  asks(404, "GET /%snothing HTTP/1.1\r\n" HOST "\r\n");
  asks(404, "GET /%sruns/1/log HTTP/1.1\r\n" HOST "\r\n");
  asks(200, "GET /%sruns.json HTTP/1.1\r\n" HOST "\r\n");
}

static void a_run_waits_and_is_stopped(void **state)
{
  (void)state;
  need_server();
  asks(400, "POST /%sruns HTTP/1.1\r\n" OWN FORM "Content-Length: 30\r\n\r\n"
            "project=octa.obj&s.growth=0.50");
  assert_non_null(strstr(scene.answer, "must be above 1"));
  assert_non_null(strstr(scene.answer, "value=\"0.50\""));
  asks(400, "POST /%sruns HTTP/1.1\r\n" OWN FORM "Content-Length: 27\r\n\r\n"
            "project=../other/secret.obj");
  asks(303, "POST /%sruns HTTP/1.1\r\n" OWN FORM "Content-Length: 30\r\n\r\n"
            "project=octa.obj&title=%%3Cb%%3E");
  asks(200, "GET /%sruns HTTP/1.1\r\n" HOST "\r\n");
  assert_non_null(strstr(scene.answer, "data-state=\"queued\""));
  assert_non_null(strstr(scene.answer, "&lt;b&gt;"));
  asks(200, "GET /%sruns/1/deck HTTP/1.1\r\n" HOST "\r\n");
  asks(200, "GET /%sruns/1/file/run.json HTTP/1.1\r\n" HOST "\r\n");
  asks(404, "GET /%sruns/1/file/../../octa.obj HTTP/1.1\r\n" HOST "\r\n");
  asks(404, "GET /%sruns/1/file/%%2e%%2e/lock HTTP/1.1\r\n" HOST "\r\n");
  asks(404, "GET /%sruns/1/file/ HTTP/1.1\r\n" HOST "\r\n");
  assert_int_equal(vg_portal_active(scene.p), 1);
  asks(303,
       "POST /%sruns/1/stop HTTP/1.1\r\n" OWN FORM "Content-Length: 0\r\n\r\n");
  assert_int_equal(vg_portal_active(scene.p), 0);
  asks(404,
       "POST /%sruns/1/burn HTTP/1.1\r\n" OWN FORM "Content-Length: 0\r\n\r\n");
  asks(404, "POST /%sruns/77/stop HTTP/1.1\r\n" OWN FORM
            "Content-Length: 0\r\n\r\n");
}

#define GET(path) "GET /%s" path " HTTP/1.1\r\n" HOST "\r\n"

/* Send a form to a path. */
static void sends(int status, const char *path, const char *body)
{
  char request[4096];
  size_t n = 0;

  snprintf(request, sizeof request,
           "POST /%%s%s HTTP/1.1\r\n" OWN FORM "Content-Length: %zu\r\n\r\n",
           path, strlen(body));
  for (n = strlen(request); *body && n < sizeof request - 3; body++) {
    if (*body == '%') request[n++] = '%';
    request[n++] = *body;
  }
  request[n] = 0;
  asks(status, request);
}

/* The value of a field that is wrong comes back, marked, in an open group. */
static void a_refused_run_marks_its_field(void **state)
{
  char *field;

  (void)state;
  need_server();
  sends(400, "runs", "project=octa.obj&s.hmin=<b>&title=abcdefgh");
  field = strstr(scene.answer, "name=\"s.hmin\"");
  assert_non_null(field);
  assert_non_null(strstr(field, "aria-invalid=\"true\""));
  assert_true(strstr(field, "aria-invalid") < strstr(field, ">"));
  assert_non_null(strstr(scene.answer, "href=\"#s.hmin\""));
  assert_non_null(strstr(scene.answer, "must be a number, or one with a unit"));
  assert_non_null(strstr(scene.answer, "not &#39;&lt;b&gt;&#39;"));
  assert_null(strstr(scene.answer, "=\"<b>"));
  assert_non_null(strstr(scene.answer, "value=\"&lt;b&gt;\""));
  sends(400, "runs", "project=octa.obj&patches=id bc%0a1 x%0a++");
  assert_non_null(strstr(scene.answer, "data-wrong=\"2\""));
}

/* This portal has no room for processes, so looks are refused; paths of looks
 * lead nowhere else. */
static void looks_are_confined(void **state)
{
  (void)state;
  need_server();
  asks(403,
       "POST /%slooks/view HTTP/1.1\r\n" HOST FORM "Content-Length: 0\r\n\r\n");
  sends(400, "looks/view", "project=octa.obj");
  assert_non_null(strstr(scene.answer, "starts no processes"));
  sends(400, "looks/check", "project=octa.obj&s.growth=0.500");
  assert_non_null(strstr(scene.answer, "\"field\":\"s.growth\""));
  sends(400, "looks/plan", "project=../other/secret.obj");
  sends(400, "looks/view", "project=out.obj");
  sends(404, "looks/mesh", "");
  sends(404, "looks/1/stop", "");
  sends(404, "looks/../runs", "");
  asks(404, GET("looks/1"));
  asks(404, GET("looks/1/scene"));
  asks(404, GET("looks/0/scene"));
  asks(404, GET("looks/view/scene"));
  asks(404, GET("looks/1/look.deck"));
  asks(404, GET("looks/99999999999/scene"));
}

static void pages_of_results_are_safe(void **state)
{
  (void)state;
  need_server();
  asks(200, GET("?uploaded=%%3Cscript%%3Ealert(1)"));
  assert_null(strstr(scene.answer, "<script>alert"));
  assert_non_null(strstr(scene.answer, "it is not a project"));
  asks(404, GET("?report=77"));
  asks(404, GET("?sweep=1"));
  asks(404, GET("?report=%%2e%%2e/1"));
  asks(200, GET("?compare=1&compare=77&compare=1"));
  assert_non_null(strstr(scene.answer, "Choose two to four"));
  asks(404, GET("runs/77/archive.tar"));
  asks(404, GET("runs/1/picture/0"));
  asks(404, GET("runs/1/picture/2"));
  asks(404, GET("runs/1/picture/../run.json"));
  asks(200, GET("view.js"));
  asks(200, GET("form.js"));
  asks(200, GET("case.js"));
  asks(404, GET("report.js"));
}

/* Reports may be shown in a frame of the portal, and nothing else. */
static void only_reports_are_framed(void **state)
{
  char path[512];

  (void)state;
  need_server();
  snprintf(path, sizeof path, "%s/vanguard-runs/0001/mesh", scene.root);
  assert_int_equal(mkdir(path, 0777), 0);
  portal_file(path, "octa.report.html",
              "<figure><img src=\"data:image/png;base64,iVBORw0K\">");
  portal_file(path, "page.html", "<script>alert(1)</script>");
  asks(200, GET("runs/1/file/mesh/octa.report.html"));
  assert_non_null(strstr(scene.answer, "X-Frame-Options: SAMEORIGIN"));
  assert_non_null(strstr(scene.answer, "frame-ancestors 'self'"));
  assert_non_null(strstr(scene.answer, "sandbox allow-scripts"));
  assert_null(strstr(scene.answer, "unsafe-eval"));
  asks(200, GET("runs/1/file/mesh/page.html"));
  assert_non_null(strstr(scene.answer, "X-Frame-Options: DENY"));
  assert_non_null(strstr(scene.answer, "attachment"));
  asks(200, GET("runs/1/picture/0"));
  assert_non_null(strstr(scene.answer, "Content-Type: image/png"));
  assert_non_null(strstr(scene.answer, "\r\n\r\n\x89PNG\r\n"));
  /* A report that is a link out of the folder of the run is not read. */
  snprintf(path, sizeof path, "%s/vanguard-runs/0001/mesh/octa.report.html",
           scene.root);
  assert_int_equal(remove(path), 0);
  assert_int_equal(symlink("../../../../other/secret.obj", path), 0);
  asks(404, GET("runs/1/picture/0"));
  asks(404, GET("runs/1/file/mesh/octa.report.html"));
  /* Nor is a deck, in a comparison. */
  sends(303, "runs", "project=octa.obj");
  sends(303, "runs/2/stop", "");
  snprintf(path, sizeof path, "%s/vanguard-runs/0002/run.deck", scene.root);
  assert_int_equal(remove(path), 0);
  assert_int_equal(symlink("../../../other/secret.obj", path), 0);
  asks(200, GET("?compare=1&compare=2"));
  assert_non_null(strstr(scene.answer, "is outside the folder"));
}

/* The whole archive, by small pieces; free it. */
static char *read_archive(const char *dir, const char *skip, size_t *n)
{
  struct vg_archive *a = NULL;
  struct vg_error err = VG_ERROR_INIT;
  char *data;
  size_t size;
  ssize_t got;

  assert_int_equal(vg_archive_open(dir, "run", skip, &a, &err), VG_OK);
  size = (size_t)vg_archive_size(a);
  data = malloc(size + 100);
  for (*n = 0; (got = vg_archive_read(a, data + *n, 77)) > 0; *n += (size_t)got)
    assert_true(*n + (size_t)got <= size);
  assert_int_equal(got, 0);
  assert_int_equal(*n, size);
  vg_archive_free(a);
  return data;
}

static void archives_hold_all_files(void **state)
{
  char path[400], name[300], *data;
  struct vg_archive *a = NULL;
  struct vg_error err = VG_ERROR_INIT;
  size_t n;

  (void)state;
  snprintf(path, sizeof path, "%s/pack", scene.dir);
  assert_int_equal(mkdir(path, 0777), 0);
  portal_file(path, "a.txt", "0123456789");
  memset(name, 'n', 150);
  strcpy(name + 150, ".txt");
  portal_file(path, name, "long");
  portal_file(path, ".hidden", PORTAL_SECRET);
  snprintf(path, sizeof path, "%s/pack/kept", scene.dir);
  assert_int_equal(mkdir(path, 0777), 0);
  portal_file(path, "task", PORTAL_SECRET);
  snprintf(path, sizeof path, "%s/pack/away", scene.dir);
  assert_int_equal(symlink("../other/secret.obj", path), 0);
  snprintf(path, sizeof path, "%s/pack", scene.dir);
  data = read_archive(path, "kept", &n);
  /* a header and a block; a name of two blocks, a header and a block; the
   * end */
  assert_int_equal(n, 512 * (2 + 2 + 2 + 2));
  assert_string_equal(data, "run/a.txt");
  assert_memory_equal(data + 512, "0123456789", 11);
  assert_int_equal(data[2 * 512 + 156], 'L');
  assert_memory_equal(data + 3 * 512 + 4, name, 155);
  assert_memory_equal(data + 5 * 512, "long", 5);
  assert_null(memmem(data, n, PORTAL_SECRET, strlen(PORTAL_SECRET)));
  free(data);
  /* A file that shrinks while it is sent ends the archive with an error. */
  assert_int_equal(vg_archive_open(path, "run", "kept", &a, &err), VG_OK);
  snprintf(name, sizeof name, "%s/pack/a.txt", scene.dir);
  assert_int_equal(truncate(name, 3), 0);
  assert_int_equal(vg_archive_read(a, path, 77), -1);
  vg_archive_free(a);
}

/* Removal: not while active, and never through a link. */
static void runs_are_removed(void **state)
{
  char path[512], link[600];
  struct stat s;

  (void)state;
  need_server();
  sends(303, "runs", "project=octa.obj");
  asks(409, GET("runs/3/archive.tar"));
  sends(409, "runs/3/delete", "");
  sends(303, "runs/3/stop", "");
  asks(200, GET("runs/3/archive.tar"));
  assert_non_null(strstr(scene.answer, "filename=\"vanguard-0003.tar\""));
  snprintf(path, sizeof path, "%s/vanguard-runs/0003", scene.root);
  snprintf(link, sizeof link, "%s/away", path);
  assert_int_equal(symlink("../../../other", link), 0);
  asks(403, "POST /%sruns/3/delete HTTP/1.1\r\n" HOST FORM
            "Origin: http://evil.example\r\nContent-Length: 0\r\n\r\n");
  assert_int_equal(stat(path, &s), 0);
  asks(404, GET("runs/3/delete"));
  sends(303, "runs/3/delete", "");
  assert_int_equal(lstat(path, &s), -1);
  snprintf(path, sizeof path, "%s/other/secret.obj", scene.dir);
  assert_int_equal(stat(path, &s), 0);
  sends(404, "runs/3/delete", "");
  asks(200, GET("runs"));
  assert_null(strstr(scene.answer, "id=\"run-3\""));
}

/* Upload one file with the content `text` by a form. */
static void brings(int status, const char *folder, const char *name,
                   const char *text)
{
  char body[8192], request[12000];
  int n = snprintf(
    body, sizeof body,
    "--XYZ\r\nContent-Disposition: form-data; name=\"folder\"\r\n\r\n%s\r\n"
    "--XYZ\r\nContent-Disposition: form-data; name=\"file\"; "
    "filename=\"%s\"\r\n"
    "Content-Type: application/octet-stream\r\n\r\n%s\r\n--XYZ--\r\n",
    folder, name, text);

  snprintf(request, sizeof request,
           "POST /%%supload HTTP/1.1\r\n" OWN
           "Content-Type: multipart/form-data; boundary=XYZ\r\n"
           "Content-Length: %d\r\n\r\n%s",
           n, body);
  asks(status, request);
}

static void files_are_uploaded(void **state)
{
  char text[1200], path[512];
  struct stat s;

  (void)state;
  need_server();
  memset(text, 'v', sizeof text);
  text[1001] = 0;
  brings(303, "", "new.obj", "v 0 0 0\n");
  assert_non_null(strstr(scene.answer, "?project=new.obj"));
  brings(400, "", "new.obj", "v 1 1 1\n");
  assert_non_null(strstr(scene.answer, "already exists"));
  brings(400, "", "long.obj", text);
  assert_non_null(strstr(scene.answer, "--max-upload"));
  text[1000] = 0;
  brings(303, "", "just.obj", text);
  brings(400, "", "../up.obj", "v 0 0 0\n");
  brings(400, "..", "up.obj", "v 0 0 0\n");
  brings(400, "away", "up.obj", "v 0 0 0\n");
  brings(400, "", ".hidden", "v 0 0 0\n");
  brings(400, "", "out.obj", "v 0 0 0\n");
  snprintf(path, sizeof path, "%s/new.obj", scene.root);
  assert_int_equal(stat(path, &s), 0);
  assert_int_equal(s.st_size, 8);
  snprintf(path, sizeof path, "%s/long.obj", scene.root);
  assert_int_equal(stat(path, &s), -1);
  snprintf(path, sizeof path, "%s/other/up.obj", scene.dir);
  assert_int_equal(stat(path, &s), -1);
}

static void a_second_portal_is_refused(void **state)
{
  struct vg_portal_options o = VG_PORTAL_OPTIONS_INIT;
  struct vg_portal *p = NULL;
  struct vg_error err = VG_ERROR_INIT;
  char path[512];
  struct stat s;

  (void)state;
  need_server();
  o.root = scene.root;
  o.port = -1;
  assert_int_equal(vg_portal_open(&o, &p, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "another portal"));
  snprintf(path, sizeof path, "%s/vanguard-runs/portal.url", scene.root);
  assert_int_equal(stat(path, &s), 0);
  assert_int_equal(s.st_mode & 0777, 0600);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(fields_arrive_in_pieces),
    cmocka_unit_test(paths_stay_inside),
    cmocka_unit_test(names_of_files_are_plain),
    cmocka_unit_test(markup_is_escaped),
    cmocka_unit_test(progress_lines_are_parsed),
    cmocka_unit_test(a_form_becomes_settings),
    cmocka_unit_test(a_refused_form_names_the_field),
    cmocka_unit_test(a_printed_form_comes_back),
    cmocka_unit_test(places_are_checked),
    cmocka_unit_test(projects_are_found),
    cmocka_unit_test(records_come_back),
    cmocka_unit_test(damaged_records_are_refused),
    cmocka_unit_test(job_states_follow_squeue),
    cmocka_unit_test(gate_refuses_unauthorised_requests),
    cmocka_unit_test(slow_connections_make_room),
    cmocka_unit_test(visits_end),
    cmocka_unit_test(pages_are_safe),
    cmocka_unit_test(a_run_waits_and_is_stopped),
    cmocka_unit_test(a_refused_run_marks_its_field),
    cmocka_unit_test(looks_are_confined),
    cmocka_unit_test(pages_of_results_are_safe),
    cmocka_unit_test(only_reports_are_framed),
    cmocka_unit_test(archives_hold_all_files),
    cmocka_unit_test(runs_are_removed),
    cmocka_unit_test(files_are_uploaded),
    cmocka_unit_test(a_second_portal_is_refused),
  };
  struct vg_error err = VG_ERROR_INIT;
  int failed;

  if (portal_scene_open(&scene, &err) < 0 && err.code != VG_ERR_UNSUPPORTED) {
    fprintf(stderr, "%s\n", err.text);
    return 1;
  }
  failed = cmocka_run_group_tests(tests, NULL, NULL);
  portal_scene_close(&scene);
  return failed;
}
