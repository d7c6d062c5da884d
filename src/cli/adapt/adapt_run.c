/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Runs the steps of a loop as child processes. */
#define _GNU_SOURCE
#include "cli/adapt/adapt.h"

#include <ctype.h>
#include <ftw.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "cli/common/process.h"
#include "io/stream/stream.h"
#include "partition/store/store.h"
#include "run/common/folder.h"
#include "run/common/progress.h"

/* Files in which a solver may leave its solution. */
static const char *const solution_names[] = { "solution.vtu", "solution.csv",
                                              "solution.solb", "solution.sol" };
enum { N_SOLUTION = sizeof solution_names / sizeof *solution_names };
static const char *const wall_names[] = { "wall", "wall.vtu", "wall.vtp" };
enum { N_WALL = sizeof wall_names / sizeof *wall_names };

/* --- child processes ------------------------------------------------------ */

/* Run a command with its output in the log NAME.log of the cycle; `out` is the
 * file of its standard output, or NULL. */
static vg_status run(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                     enum vg_adapt_step step, const struct vg_words *w,
                     const char *name, const char *out, int *status,
                     char note[VG_FAILURE_NOTE], struct vg_error *err)
{
  char file[32], *log = NULL;
  double wall = 0;
  vg_status st;

  snprintf(file, sizeof file, "%s.log", name);
  VG_TRY(vg_folder_path(c->dir, file, &log, err));
  if (!a->o->quiet)
    fprintf(stderr, "cycle %d of %zu: %s\n", c->number, a->n, name);
  VG_TRY(vg_words_run(w, step == VG_ADAPT_SOLVE ? a->home : NULL, log, out,
                      status, &wall, err));
  c->seconds[step] += wall;
  if (*status) vg_failure_note(log, note, VG_FAILURE_NOTE);
  if (vg_display_interrupted())
    st = vg_fail(err, VG_ERR_STOPPED,
                 "interrupted in cycle %d; the same command continues",
                 c->number);
done:
  free(log);
  return st;
}

static vg_status own(const struct vg_adapt_options *o, const char *command,
                     struct vg_words *w, struct vg_error *err)
{
  vg_status st = vg_words_take(w,
                               o->program ? strdup(o->program) : vg_own_path(),
                               err);

  return st < 0 ? st : vg_words_add(w, command, err);
}

static vg_status add_two(struct vg_words *w, const char *name,
                         const char *value, struct vg_error *err)
{
  vg_status st = vg_words_add(w, name, err);

  return st < 0 ? st : vg_words_add(w, value, err);
}

static vg_status add_real(struct vg_words *w, const char *name, double v,
                          struct vg_error *err)
{
  char text[40];

  if (!isfinite(v)) return VG_OK;
  snprintf(text, sizeof text, "%.17g", v);
  return add_two(w, name, text, err);
}

static vg_status add_path(struct vg_words *w, const char *option,
                          const char *folder, const char *file,
                          struct vg_error *err)
{
  char *path = NULL;
  vg_status st = vg_folder_path(folder, file, &path, err);

  if (st >= 0 && option) st = vg_words_add(w, option, err);
  if (st >= 0) return vg_words_take(w, path, err);
  free(path);
  return st;
}

static int has_file(const char *folder, const char *file)
{
  char *path = NULL;
  int there;

  if (vg_folder_path(folder, file, &path, NULL) < 0) return 0;
  there = !access(path, R_OK);
  free(path);
  return there;
}

/* The skin friction on the walls of a solution; NULL: none. */
static const char *wall_of(const struct vg_adapt_cycle *c)
{
  for (int i = 0; i < N_WALL; i++)
    if (has_file(c->dir, wall_names[i])) return wall_names[i];
  return NULL;
}

/* --- metric --------------------------------------------------------------- */

static const char *solution_of(const struct vg_adapt_cycle *c)
{
  for (int i = 0; i < N_SOLUTION; i++)
    if (has_file(c->dir, solution_names[i])) return solution_names[i];
  return NULL;
}

/* File of the metric of an attempt. */
static void metric_name(int attempt, char name[32])
{
  if (attempt == 1) strcpy(name, "metric.vtu");
  else snprintf(name, 32, "metric-%d.vtu", attempt);
}

/* Cells of the metric of a cycle, from the second one on. */
static double cells_of(const struct vg_adapt *a, int number)
{
  const struct vg_adapt_row *r = &a->o->row;
  const double first = isfinite(r->cells) ? r->cells : a->cycle[0].field_cells;
  const double ratio = isfinite(r->cells_ratio) ? r->cells_ratio : 2;

  return first * pow(ratio, number - 2);
}

static vg_status metric_line(const struct vg_adapt *a,
                             const struct vg_adapt_cycle *c, struct vg_words *w,
                             struct vg_error *err)
{
  const struct vg_adapt_cycle *from = c - 1;
  const struct vg_adapt_row *r = &a->o->row;
  const char *solution = solution_of(from);
  char name[32], mesh[300];
  double growth, aspect_max;
  vg_status st;

  if (!solution)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the solution of this cycle is gone; remove the folder "
                   "to compute it again",
                   from->dir);
  vg_adapt_attempt(r, c->attempt, &growth, &aspect_max);
  metric_name(c->attempt, name);
  VG_TRY(own(a->o, "metric", w, err));
  VG_TRY(add_path(w, NULL, from->dir, solution, err));
  if (!strcmp(solution, "solution.csv")) {
    snprintf(mesh, sizeof mesh, "%.250s.b8.ugrid", a->stem);
    VG_TRY(add_path(w, "--mesh", from->dir, mesh, err));
  }
  VG_TRY(add_two(w, "--field", r->field, err));
  VG_TRY(add_real(w, "--cells", c->requested, err));
  if (*r->norm) VG_TRY(add_two(w, "--norm", r->norm, err));
  VG_TRY(add_real(w, "--growth", growth, err));
  VG_TRY(add_real(w, "--h-min", r->h_min, err));
  VG_TRY(add_real(w, "--h-max", r->h_max, err));
  VG_TRY(add_real(w, "--aspect-max", aspect_max, err));
  VG_TRY(add_path(w, "--out", c->dir, name, err));
done:
  return st;
}

static vg_status make_metric(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                             struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  char note[VG_FAILURE_NOTE] = "";
  int status;
  vg_status st;

  c->requested = cells_of(a, c->number);
  VG_TRY(metric_line(a, c, &w, err));
  VG_TRY(run(a, c, VG_ADAPT_METRIC, &w, "metric", NULL, &status, note, err));
  if (status)
    st = vg_fail(err, VG_ERR_INPUT,
                 "cycle %d: no metric: %s; the log is %s/metric.log", c->number,
                 note, c->dir);
done:
  vg_words_release(&w);
  return st;
}

/* --- mesh ----------------------------------------------------------------- */

static vg_status mesh_line(const struct vg_adapt *a,
                           const struct vg_adapt_cycle *c, struct vg_words *w,
                           struct vg_error *err)
{
  const struct vg_adapt_options *o = a->o;
  char name[32], kept[32]; /* finished tasks of a mesh that was stopped */
  vg_status st;

  snprintf(kept, sizeof kept, "mesh-%d.run", c->attempt);
  VG_TRY(vg_words_launcher(w, o->launcher, o->ranks, o->threads, err));
  VG_TRY(own(o, "mesh", w, err));
  VG_TRY(add_two(w, "-p", o->project, err));
  if (o->deck) VG_TRY(add_two(w, "--deck", o->deck, err));
  VG_TRY(vg_words_add(w, "--json", err));
  if (o->threads) VG_TRY(vg_words_pair(w, "--threads", o->threads, err));
  if (vg_adapt_has_metric(a, c)) {
    metric_name(c->attempt, name);
    VG_TRY(add_path(w, "--sizes", c->dir, name, err));
    VG_TRY(add_two(w, "--surface-sizes", "no", err));
    VG_TRY(add_two(w, "--growth", "2", err));
  }
  if (c->number > 1 && wall_of(c - 1))
    VG_TRY(add_path(w, "--first-from", (c - 1)->dir, wall_of(c - 1), err));
  VG_TRY(add_path(w, "--run-dir", c->dir, kept, err));
  if (vg_store_has_run(w->word[w->n - 1], NULL) >= 0)
    VG_TRY(vg_words_add(w, "--resume", err));
  VG_TRY(add_two(w, "-o", c->dir, err));
  for (int i = 0; i < o->n_extra; i++)
    VG_TRY(vg_words_add(w, o->extra[i], err));
done:
  return st;
}

static void read_report(const struct vg_adapt *a, struct vg_adapt_cycle *c)
{
  char name[300], *path = NULL;
  const char *field;
  json_t *o;

  snprintf(name, sizeof name, "%.250s.report.json", a->stem);
  if (vg_folder_path(c->dir, name, &path, NULL) < 0) return;
  o = json_load_file(path, 0, NULL);
  field = json_object_get(o, "plane") ? "plane"
        : json_object_get(o, "field") ? "field"
                                      : "mesh";
  c->cells = vg_json_number(o, "mesh", "cells");
  c->points = vg_json_number(o, "mesh", "points");
  c->field_cells = vg_json_number(o, field, "cells");
  c->angle_min = vg_json_number(o, field, "angle_min");
  json_decref(o);
  free(path);
}

/* Did the mesher fail because of the geometry? Everything else must not select
 * another metric: no memory, a full disk, a file that is gone. */
static int is_geometry(const char *answer)
{
  json_t *o = json_load_file(answer, 0, NULL);
  const char *kind = json_string_value(json_object_get(o, "error_kind"));
  const int is = kind && !strcmp(kind, vg_status_name(VG_ERR_GEOMETRY));

  json_decref(o);
  return is;
}

/* *again: another metric may help. */
static vg_status try_mesh(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                          int *again, char note[VG_FAILURE_NOTE],
                          struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  char *answer = NULL;
  vg_status st;

  VG_TRY(vg_folder_path(c->dir, "mesh.json", &answer, err));
  VG_TRY(mesh_line(a, c, &w, err));
  VG_TRY(
    run(a, c, VG_ADAPT_MESH, &w, "mesh", answer, &c->exit_status, note, err));
  *again = c->exit_status == VG_EXIT_FAILED && c->number > 1 &&
           c->attempt < VG_ADAPT_ATTEMPTS && is_geometry(answer);
  unlink(answer);
done:
  vg_words_release(&w);
  free(answer);
  return st;
}

/* A mesh that cannot be made by its metric is tried with metrics that change
 * less from point to point. */
static vg_status make_mesh(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                           struct vg_error *err)
{
  char note[VG_FAILURE_NOTE] = "";
  int again = 0;
  vg_status st;

  for (;;) {
    VG_TRY(try_mesh(a, c, &again, note, err));
    if (!again) break;
    c->attempt++;
    fprintf(stderr,
            "cycle %d: no mesh: %s; attempt %d with a metric of less growth "
            "and aspect\n",
            c->number, note, c->attempt);
    VG_TRY(make_metric(a, c, err));
  }
  if (c->exit_status && c->exit_status != VG_EXIT_LIMIT)
    st = vg_fail(err, VG_ERR_INPUT,
                 "cycle %d: no mesh: %s; the log is %s/mesh.log", c->number,
                 note, c->dir);
  else read_report(a, c);
done:
  return st;
}

/* --- solver --------------------------------------------------------------- */

static void set_environment(const struct vg_adapt *a,
                            const struct vg_adapt_cycle *c)
{
  char number[16], cycles[24];

  snprintf(number, sizeof number, "%d", c->number);
  snprintf(cycles, sizeof cycles, "%zu", a->n);
  setenv("VANGUARD_CYCLE", number, 1);
  setenv("VANGUARD_CYCLES", cycles, 1);
  setenv("VANGUARD_FOLDER", c->dir, 1);
  setenv("VANGUARD_STEM", a->stem, 1);
  setenv("VANGUARD_PREVIOUS", c->number > 1 ? (c - 1)->dir : "", 1);
}

/* A line name,value; the name may be in quotes, and blanks around both are
 * ignored. */
static vg_status take_output(const struct vg_input *in, const char *text,
                             size_t n, struct vg_adapt_cycle *c,
                             struct vg_error *err)
{
  const char *comma = memchr(text, ',', n);
  struct vg_adapt_output *to = &c->output[c->n_output];
  const char *from = comma ? comma + 1 : text, *end = text + n;
  size_t len = comma ? (size_t)(comma - text) : 0;

  while (n && isspace((unsigned char)*text)) text++, n--, len -= len > 0;
  if (!n) return VG_OK;
  while (len && isspace((unsigned char)text[len - 1])) len--;
  if (len > 1 && text[0] == '"' && text[len - 1] == '"') text++, len -= 2;
  while (from < end && isspace((unsigned char)*from)) from++;
  while (end > from && isspace((unsigned char)end[-1])) end--;
  if (!len || len >= sizeof to->name ||
      !vg_parse_real(from, (size_t)(end - from), &to->value))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s, line %zu: an output quantity is a name of at most %zu "
                   "characters, a comma and a number",
                   in->path, in->line - 1, sizeof to->name - 1);
  if (c->n_output == VG_ADAPT_OUTPUTS)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s, line %zu: more than %d output quantities", in->path,
                   in->line - 1, VG_ADAPT_OUTPUTS);
  memcpy(to->name, text, len);
  to->name[len] = 0;
  for (size_t i = 0; i < c->n_output; i++)
    if (!strcmp(c->output[i].name, to->name))
      return vg_fail(err, VG_ERR_FORMAT, "%s, line %zu: '%s' occurs twice",
                     in->path, in->line - 1, to->name);
  c->n_output++;
  return VG_OK;
}

static vg_status read_outputs(struct vg_adapt_cycle *c, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  char *path = NULL;
  const char *text;
  size_t n;
  vg_status st;

  c->n_output = 0;
  if (!has_file(c->dir, "outputs.csv")) return VG_OK;
  VG_TRY(vg_folder_path(c->dir, "outputs.csv", &path, err));
  VG_TRY(vg_input_open(path, &in, err));
  while (st >= 0 && vg_input_line(&in, &text, &n))
    st = take_output(&in, text, n, c, err);
done:
  vg_input_release(&in);
  free(path);
  return st;
}

static int remove_entry(const char *path, const struct stat *at, int type,
                        struct FTW *walk)
{
  (void)at;
  (void)type;
  (void)walk;
  return remove(path);
}

/* Results of an earlier solver that failed must not count as new ones. */
static void remove_results(const struct vg_adapt_cycle *c)
{
  const char *name[N_SOLUTION + N_WALL + 1] = { "outputs.csv" };
  char *path;

  memcpy(name + 1, solution_names, sizeof solution_names);
  memcpy(name + 1 + N_SOLUTION, wall_names, sizeof wall_names);
  for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
    if (vg_folder_path(c->dir, name[i], &path, NULL) < 0) continue;
    nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    free(path);
  }
}

/* A solver without a folder may be one of the installed scripts. */
static vg_status find_script(struct vg_words *w, struct vg_error *err)
{
  char *own_path, *slash, *path = NULL;
  vg_status st;

  if (!w->n || strchr(w->word[0], '/')) return VG_OK;
  own_path = vg_own_path();
  if (!own_path) return vg_fail_memory(err, "a path");
  slash = strrchr(own_path, '/');
  if (slash) *slash = 0;
  st = slash && asprintf(&path, "%s/" VG_ADAPT_FROM_BIN "/%s", own_path,
                         w->word[0]) < 0
       ? vg_fail_memory(err, "a path")
       : VG_OK;
  free(own_path);
  if (st < 0) return st;
  if (!path || access(path, X_OK)) {
    free(path);
    return VG_OK;
  }
  free(w->word[0]);
  w->word[0] = path;
  return VG_OK;
}

static vg_status solve(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                       struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  char note[VG_FAILURE_NOTE] = "";
  int status;
  vg_status st;

  remove_results(c);
  set_environment(a, c);
  VG_TRY(
    vg_words_launcher(&w, a->o->row.solver, a->o->ranks, a->o->threads, err));
  VG_TRY(find_script(&w, err));
  VG_TRY(run(a, c, VG_ADAPT_SOLVE, &w, "solver", NULL, &status, note, err));
  if (status)
    st = vg_fail(err, VG_ERR_INPUT,
                 "cycle %d: the solver ended with status %d: %s; its log is "
                 "%s/solver.log",
                 c->number, status, note, c->dir);
  else if (*a->o->row.field && !solution_of(c))
    st = vg_fail(err, VG_ERR_INPUT,
                 "cycle %d: the solver left no solution.vtu, .csv, .solb or "
                 ".sol in %s",
                 c->number, c->dir);
  else if (!*a->o->row.field && !wall_of(c))
    st = vg_fail(
      err, VG_ERR_INPUT,
      "cycle %d: nothing to adapt to: give the fields that the "
      "metric resolves by --field or in the table adapt of the "
      "deck, or a solver that leaves the skin friction in the folder wall, "
      "wall.vtu or wall.vtp of %s",
      c->number, c->dir);
  else st = read_outputs(c, err);
done:
  vg_words_release(&w);
  return st;
}

/* --- the loop ------------------------------------------------------------- */

static vg_status run_cycle(const struct vg_adapt *a, struct vg_adapt_cycle *c,
                           struct vg_error *err)
{
  static vg_status (*const steps[VG_ADAPT_N])(
    const struct vg_adapt *, struct vg_adapt_cycle *,
    struct vg_error *) = { make_metric, make_mesh, solve };
  vg_status st;

  VG_TRY(vg_make_folder(c->dir, err));
  for (int k = 0; k < VG_ADAPT_N; k++) {
    if (c->is_done[k]) continue;
    c->seconds[k] = 0;
    VG_TRY(steps[k](a, c, err));
    c->is_done[k] = 1;
    VG_TRY(vg_adapt_record(a, err));
  }
done:
  return st;
}

vg_status vg_adapt_run(struct vg_adapt *a, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < a->n && st >= 0; i++)
    st = run_cycle(a, &a->cycle[i], err);
  return st;
}
