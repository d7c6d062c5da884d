/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard metric: the metric of the next mesh, from a flow solution. */
#define _GNU_SOURCE
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "core/hessian/multiscale.h"
#include "core/sizing/sizing.h"
#include "io/foam/foam_read.h"
#include "io/mesh/foam.h"
#include "io/mesh/medit.h"
#include "io/mesh/sol.h"
#include "io/mesh/vtu.h"
#include "io/stream/stream.h"
#include "run/common/text.h"
#include "run/input/sizes.h"
#include "run/input/solution.h"
#include "run/report/report.h"
#include "run/stages/output.h"

/* Cells of a mesh for each unit of complexity (docs/guide/adaptation.md). */
#define CELLS_PER_UNIT 10

/* A complexity that differs by more is noted. */
#define NEAR 0.02

/* Largest number of cells: more than any machine holds. */
#define MOST_CELLS 1e12

enum {
  KEY_FIELD = 500,
  KEY_CELLS,
  KEY_NORM,
  KEY_GROWTH,
  KEY_H_MIN,
  KEY_H_MAX,
  KEY_ASPECT,
  KEY_MESH,
  KEY_OUT
};

struct arguments {
  const char *in, *fields, *mesh, *out;
  double cells;
  struct vg_multiscale_options o;
  int json, quiet;
};

struct job {
  const struct arguments *a;
  struct vg_solution s;
  struct vg_estimate e;
  double (*metric)[6];
  struct vg_multiscale_report r;
  char *file, *mesh; /* files written; mesh: NULL without one */
  struct vg_outputs outputs;
  struct vg_notes notes;
};

/* --- files ---------------------------------------------------------------- */

/* Suffix of the file of a metric; NULL: another one. */
static const char *metric_suffix(const char *path)
{
  static const char *const known[] = { "vtu", "solb", "sol" };
  const size_t n = strlen(path);

  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    const size_t len = strlen(known[i]);

    if (n > len + 1 && path[n - len - 1] == '.' &&
        !strcmp(path + n - len, known[i]))
      return known[i];
  }
  return NULL;
}

/* A .sol belongs to the only mesh of its name. */
static vg_status check_mesh(const struct job *j, struct vg_error *err)
{
  char *found[2];
  vg_status st = vg_sizes_meshes(j->file, found, err);
  int is_own;

  if (st < 0 || !found[0]) return st;
  is_own = !found[1] && !strcmp(found[0], j->mesh) && !access(j->file, F_OK);
  if (!is_own)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: the folder has another mesh of this name, %s; give "
                 "another name by --out, or write a .vtu",
                 j->file, found[0]);
  free(found[0]);
  free(found[1]);
  return st;
}

/* Length of the name of the solution without its suffix, or of the folder of a
 * case without ".openfoam" and a slash at its end. */
static size_t stem_of(const char *in)
{
  static const char suffix[] = "." VG_FOAM_SUFFIX;
  const size_t n = sizeof suffix - 1;
  const char *dot = strrchr(in, '.');
  size_t len = strlen(in);

  if (!vg_foam_is_case(in)) return dot ? (size_t)(dot - in) : len;
  while (len > 1 && in[len - 1] == '/') len--;
  return len > n && !strncmp(in + len - n, suffix, n) ? len - n : len;
}

/* The file, and the lock on its names. */
static vg_status claim(struct job *j, struct vg_error *err)
{
  const char *in = j->a->in, *suffix;
  size_t n_stem;
  char *stem;
  vg_status st;

  n_stem = stem_of(in);
  if (!j->a->out && in[n_stem - 1] == '.')
    return vg_fail(err, VG_ERR_USAGE,
                   "%s: the folder has no name here; name the file of the "
                   "metric by --out",
                   in);
  if (j->a->out) j->file = strdup(j->a->out);
  else if (asprintf(&j->file, "%.*s.metric.vtu", (int)n_stem, in) < 0)
    j->file = NULL;
  if (!j->file) return vg_fail_memory(err, "a file name");
  suffix = metric_suffix(j->file);
  if (!suffix)
    return vg_fail(err, VG_ERR_USAGE,
                   "%s: a metric is written as .vtu, .solb or .sol", j->file);
  n_stem = strlen(j->file) - strlen(suffix) - 1;
  if (*suffix == 's' &&
      asprintf(&j->mesh, "%.*s.%s", (int)n_stem, j->file,
               strcmp(suffix, "sol") ? "meshb" : "mesh") < 0) {
    j->mesh = NULL;
    return vg_fail_memory(err, "a file name");
  }
  if (vg_is_same_file(j->file, in) || vg_is_same_file(j->mesh, j->s.mesh))
    return vg_fail(err, VG_ERR_USAGE,
                   "%s: this would overwrite the solution or its mesh; give "
                   "another name by --out",
                   j->file);
  if (j->mesh && (st = check_mesh(j, err)) < 0) return st;
  stem = strndup(j->file, n_stem);
  if (!stem) return vg_fail_memory(err, "a file name");
  st = vg_outputs_place(stem, NULL, &j->outputs, err);
  free(stem);
  return st < 0 ? st : vg_outputs_claim(&j->outputs, &j->notes, err);
}

/* VTK's order xx, yy, zz, xy, yz, xz. */
static vg_status write_vtu(const struct job *j, const char *path,
                           struct vg_error *err)
{
  static const int order[6] = { 0, 3, 5, 1, 4, 2 };
  const size_t n = j->s.m.n_point;
  double(*tensor)[6] = vg_alloc(n, sizeof *tensor);
  struct vg_vtu_field field = { "metric", VG_VTU_POINT, VG_VTU_FLOAT64, 6,
                                tensor };
  vg_status st;

  if (!tensor) return vg_fail_memory(err, "the metric of a solution");
  for (size_t p = 0; p < n; p++)
    for (int k = 0; k < 6; k++) tensor[p][k] = j->metric[p][order[k]];
  st = vg_vtu_write(path, &j->s.m, &field, 1, err);
  free(tensor);
  return st;
}

static vg_status write_one(struct job *j, const char *file,
                           struct vg_error *err)
{
  const char *suffix = strrchr(file, '.') + 1;
  char *path = vg_outputs_temp_path(&j->outputs, suffix);
  vg_status st = path ? vg_outputs_add(&j->outputs, suffix, err)
                      : vg_fail_memory(err, "a file name");

  if (st < 0) {
    free(path);
    return st;
  }
  if (file == j->mesh) st = vg_medit_write(path, &j->s.m, err);
  else if (!j->mesh) st = write_vtu(j, path, err);
  else
    st = vg_sol_write(path, j->s.m.n_point, (const double(*)[6])j->metric, err);
  free(path);
  return st;
}

static vg_status write_files(struct job *j, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_outputs_begin(&j->outputs, NULL, err));
  VG_TRY(vg_outputs_failed(&j->outputs, write_one(j, j->file, err), err));
  if (j->mesh)
    VG_TRY(vg_outputs_failed(&j->outputs, write_one(j, j->mesh, err), err));
  vg_display_commit();
  st = vg_outputs_commit(&j->outputs, err);
done:
  return st;
}

/* --- the metric ----------------------------------------------------------- */

static vg_status add_fields(struct job *j, struct vg_display *show,
                            struct vg_error *err)
{
  const size_t n = j->s.m.n_point;
  double(*hessian)[6] = vg_alloc(n, sizeof *hessian);
  struct vg_error inner = VG_ERROR_INIT;
  vg_status st = VG_OK;

  j->metric = vg_alloc(n, sizeof *j->metric);
  if (!hessian || !j->metric) st = vg_fail_memory(err, "the metric");
  for (size_t i = 0; i < j->s.n_field && st >= 0; i++) {
    vg_display_update(show, "derivatives", i, j->s.n_field);
    VG_TRY(vg_hessian(&j->e, j->s.field[i].value, hessian, err));
    st = vg_multiscale_add(&j->e, j->s.field[i].value,
                           (const double(*)[6])hessian, j->a->o.norm, i == 0,
                           j->metric, &inner);
    if (st < 0)
      vg_fail(err, st, "%s: the field '%s' gives no metric: %s", j->a->in,
              j->s.field[i].name, inner.text);
  }
done:
  free(hessian);
  return st;
}

static void note_result(struct job *j)
{
  const struct vg_multiscale_options *o = &j->a->o;
  const double ratio = j->r.complexity / o->complexity;

  if (j->e.n_left_out)
    vg_note(&j->notes,
            "%zu cells are layers and do not count: the next run grows its own",
            j->e.n_left_out);
  if (fabs(ratio - 1) > NEAR)
    vg_note(&j->notes,
            "the metric has %.3g times the requested number of cells, because "
            "h_min, h_max, aspect_max or growth leave no other choice",
            ratio);
  if (j->r.n_min)
    vg_note(&j->notes, "at %zu points an edge length is h_min", j->r.n_min);
  if (j->r.n_aspect)
    vg_note(&j->notes, "at %zu points the aspect is aspect_max", j->r.n_aspect);
}

static vg_status make_metric(struct job *j, struct vg_display *show,
                             struct vg_error *err)
{
  struct vg_error inner = VG_ERROR_INIT;
  vg_status st;

  vg_display_update(show, "read", 0, 0);
  VG_TRY(vg_solution_read(j->a->in, j->a->fields, j->a->mesh, &j->s, err));
  VG_TRY(claim(j, err));
  st = vg_estimate_open(&j->e, &j->s.m, j->s.n_layer_tet, &inner);
  if (st < 0) {
    vg_fail(err, st, "%s: %s", j->s.mesh ? j->s.mesh : j->a->in, inner.text);
    goto done;
  }
  VG_TRY(add_fields(j, show, err));
  vg_display_update(show, "growth", 0, 0);
  VG_TRY(vg_multiscale_scale(&j->e, &j->a->o, j->metric, &j->r, err));
  note_result(j);
  vg_display_update(show, "write", 0, 0);
  VG_TRY(vg_display_stopped(show, err));
  st = write_files(j, err);
done:
  return st;
}

/* --- report --------------------------------------------------------------- */

static void print_json(const struct job *j)
{
  json_t *files = json_array(), *fields = json_array(), *o;

  json_array_append_new(files, vg_text_json(j->file));
  if (j->mesh) json_array_append_new(files, vg_text_json(j->mesh));
  for (size_t i = 0; i < j->s.n_field; i++)
    json_array_append_new(fields, vg_text_json(j->s.field[i].name));
  o = json_pack("{s:o s:o s:I s:I s:f s:f s:f s:f s:f s:I s:o s:o s:f}", "file",
                vg_text_json(j->a->in), "fields", fields, "points",
                (json_int_t)j->s.m.n_point, "layer_cells",
                (json_int_t)j->e.n_left_out, "complexity", j->r.complexity,
                "expected_cells", CELLS_PER_UNIT * j->r.complexity, "edge_min",
                j->r.h_least, "edge_max", j->r.h_most, "aspect_max",
                j->r.aspect_most, "refined_by_growth", (json_int_t)j->r.n_grown,
                "files", files, "notes", vg_report_notes_json(&j->notes),
                "peak_memory_bytes", vg_report_peak_memory());
  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

static void print_text(const struct job *j)
{
  char points[32], units[32], cells[32], grown[32];

  printf("%s: metric of", j->a->in);
  for (size_t i = 0; i < j->s.n_field; i++)
    printf("%s %s", i ? "," : "", j->s.field[i].name);
  printf("\n");
  printf("  points           %s\n", vg_text_count(j->s.m.n_point, points));
  printf("  complexity       %s\n",
         vg_text_count((unsigned long long)(j->r.complexity + 0.5), units));
  printf("  expected cells   %s\n",
         vg_text_count((unsigned long long)(CELLS_PER_UNIT * j->r.complexity +
                                            0.5),
                       cells));
  printf("  edge lengths     %.4g to %.4g\n", j->r.h_least, j->r.h_most);
  printf("  largest aspect   %.4g\n", j->r.aspect_most);
  printf("  refined by the growth at %s points\n",
         vg_text_count(j->r.n_grown, grown));
  for (size_t i = 0; i < j->notes.n; i++)
    printf("  note: %s\n", j->notes.text[i]);
  printf("  %s\n", j->file);
  if (j->mesh) printf("  %s\n", j->mesh);
}

/* --- options -------------------------------------------------------------- */

static double positive(const char *arg, const char *name,
                       const struct argp_state *state, double least)
{
  double v = 0;

  if (!vg_parse_real(arg, strlen(arg), &v) || !(v > least))
    argp_error(state, "--%s: '%s' is not a number above %g", name, arg, least);
  return v;
}

static int norm_of(const char *arg, const struct argp_state *state)
{
  int64_t v = 0;

  if (!strcmp(arg, "max")) return VG_NORM_MAX;
  if (!vg_parse_int(arg, strlen(arg), &v) || v < 1 || v > 16)
    argp_error(state, "--norm: '%s' is neither a number from 1 to 16 nor 'max'",
               arg);
  return (int)v;
}

static void check(const struct arguments *a, const struct argp_state *state)
{
  if (!a->in) argp_error(state, "give the file of a solution");
  if (!(a->cells > 0)) argp_error(state, "give the number of cells by --cells");
  if (a->cells > MOST_CELLS)
    argp_error(state, "--cells %g is more than %g", a->cells, MOST_CELLS);
  if (a->o.h_min >= a->o.h_max)
    argp_error(state, "--h-min %g is not below --h-max %g", a->o.h_min,
               a->o.h_max);
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case KEY_FIELD: a->fields = arg; return 0;
  case KEY_CELLS: a->cells = positive(arg, "cells", state, 0); return 0;
  case KEY_NORM: a->o.norm = norm_of(arg, state); return 0;
  case KEY_GROWTH: a->o.growth = positive(arg, "growth", state, 1); return 0;
  case KEY_H_MIN: a->o.h_min = positive(arg, "h-min", state, 0); return 0;
  case KEY_H_MAX: a->o.h_max = positive(arg, "h-max", state, 0); return 0;
  case KEY_ASPECT:
    a->o.aspect_max = positive(arg, "aspect-max", state, 1);
    return 0;
  case KEY_MESH: a->mesh = arg; return 0;
  case KEY_OUT: a->out = arg; return 0;
  case 'j': a->json = 1; return 0;
  case 'q': a->quiet = 1; return 0;
  case ARGP_KEY_ARG:
    if (a->in) argp_error(state, "a second file, %s", arg);
    a->in = arg;
    return 0;
  case ARGP_KEY_END: check(a, state); return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_option options[] = {
  { "field", KEY_FIELD, "LIST", 0,
    "Fields of the solution, separated by commas: p,Ma. U:1 is a component of "
    "a vector, U:mag its length. The metric resolves all of them",
    0 },
  { "cells", KEY_CELLS, "N", 0,
    "Number of cells outside of layers of the next mesh: ten times the "
    "complexity of the metric",
    0 },
  { "norm", KEY_NORM, "P", 0,
    "Norm L^P of the error that is reduced, 1 to 16 or max: a large one "
    "refines shocks more and weak features less [default: 2]",
    0 },
  { "growth", KEY_GROWTH, "RATE", 0,
    "Growth of edge lengths from one edge to the next [default: 1.5]", 0 },
  { "h-min", KEY_H_MIN, "LENGTH", 0, "Least edge length [default: none]", 0 },
  { "h-max", KEY_H_MAX, "LENGTH", 0,
    "Largest edge length [default: the diagonal of the mesh]", 0 },
  { "aspect-max", KEY_ASPECT, "RATIO", 0,
    "Largest ratio of two edge lengths at a point [default: 100]", 0 },
  { "mesh", KEY_MESH, "FILE", 0, "Mesh of a solution in a .csv", 0 },
  { "out", KEY_OUT, "FILE", 0,
    "File of the metric, .vtu, .solb or .sol; next to the last two, its mesh "
    "[default: the name of the solution with .metric.vtu]",
    0 },
  { "json", 'j', NULL, 0, "Write the report as JSON to standard output", 0 },
  { "quiet", 'q', NULL, 0, "Do not show progress", 0 },
  { 0 }
};

int vg_cmd_metric(int argc, char **argv)
{
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "SOLUTION",
    .doc =
      "Compute from the flow solution SOLUTION the metric of a mesh of N "
      "cells on which it would have the least interpolation error. "
      "SOLUTION is a .vtu or .cgns with values at the points, the folder of an "
      "OpenFOAM case (its last time) or of one of its times, a .sol or "
      ".solb next to its mesh, or a .csv, such as SU2's restart file, "
      "with --mesh. "
      "'vanguard mesh --sizes' makes the mesh. Layers are left out: "
      "pyramids, prisms and hexahedra, unless there are no tetrahedra, "
      "and the layer tetrahedra that a binary .ugrid records."
  };
  struct arguments a = { .o = { .norm = 2,
                                .growth = 1.5,
                                .h_max = INFINITY,
                                .aspect_max = VG_ASPECT_MAX } };
  struct job j = { .a = &a };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_cli_parse(&argp, argc, argv, &a);
  a.o.complexity = a.cells / CELLS_PER_UNIT;
  vg_display_init(&show, a.quiet);
  vg_display_deadline(VG_DISPLAY_SOON_S);
  st = make_metric(&j, &show, &err);
  vg_display_clear(&show);
  if (st >= 0) {
    if (a.json) print_json(&j);
    else print_text(&j);
  }
  vg_estimate_release(&j.e);
  vg_solution_release(&j.s);
  vg_outputs_release(&j.outputs);
  vg_notes_release(&j.notes);
  free(j.metric);
  free(j.file);
  free(j.mesh);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
