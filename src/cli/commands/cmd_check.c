/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard check: whether a surface can be meshed; validity and quality of a
 * volume mesh. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/commands/check_accuracy.h"
#include "cli/commands/check_surface.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "io/mesh/format.h"
#include "io/mesh/ugrid.h"
#include "io/mesh/vtu.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/input/sizes.h"
#include "run/report/report.h"
#include "run/settings/plan_options.h"

#define NO_INNER " has no effect on a volume mesh, which has them already"

struct arguments {
  struct vg_cli_one one;
  const char *deck, *defects, *against, *vtu;
  const char *sizes; /* NULL: not on the command line */
  struct vg_cli_overrides kept;
  int with_accuracy; /* 1: report discretisation errors */
  int *written;      /* set to 1 once the report has been printed as JSON */
  int *missed;       /* set to 1 if a limit on the mesh is not met */
};

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'd': a->deck = arg; return 0;
  case 'f': a->defects = arg; return 0;
  case 'a': a->against = arg; return 0;
  case 'v': a->vtu = arg; return 0;
  case 'A': a->with_accuracy = 1; return 0;
  default: break;
  }
  if (key == vg_cli_option_key("sizes")) a->sizes = arg;
  if (!vg_cli_one(&a->one, "file", key, arg, state)) return 0;
  return vg_cli_add_override(&a->kept, key, arg, state);
}

/* The sizing field of the deck and of the file of sizes, with which the mesh is
 * compared. Without a deck, the sizes of the file alone. */
static vg_status field(const struct arguments *a, struct vg_problem *p,
                       const struct vg_mesh *m, struct vg_sizing **out,
                       struct vg_error *err)
{
  struct vg_read read = { .settings = p->asked, .notes = &p->notes };
  const struct vg_settings *s = &p->asked;
  struct vg_sizing_options options;
  vg_status st;

  if (!a->deck && !a->sizes) return VG_OK;
  VG_TRY(vg_read_sizes(&read, err));
  options = vg_options_sizing(s, read.map);
  if (!a->deck) options.from_surface = 0;
  VG_TRY(
    vg_sizing_new(&options, a->deck ? s->n_source : 0, s->source, m, out, err));
done:
  vg_size_samples_free(read.samples);
  vg_size_mesh_free(read.metrics);
  return st;
}

/* Number of tetrahedra of layers, if the file records it. They are the first
 * ones of the mesh. */
static vg_status count_layers(const struct arguments *a,
                              const struct vg_mesh *m, size_t *n,
                              struct vg_error *err)
{
  int is_known;
  vg_status st = vg_format_layer_tets(a->one.file, &is_known, n, err);

  if (st < 0 || !is_known || *n > m->n_tet) *n = 0;
  return st;
}

/* Sizes of a file request figures in the metric, even if they do not depend on
 * the direction. */
static vg_status judge(const struct arguments *a, struct vg_problem *p,
                       const struct vg_mesh *m, struct vg_mesh_report *r,
                       struct vg_error *err)
{
  struct vg_sizing *sizing = NULL;
  size_t n_layer = 0;
  vg_status st = field(a, p, m, &sizing, err);

  if (st < 0) return st;
  if (a->sizes || (sizing && vg_sizing_is_stretched(sizing))) {
    st = count_layers(a, m, &n_layer, err);
    if (st >= 0) st = vg_mesh_judge_in_metric(m, n_layer, sizing, r, err);
  } else {
    st = vg_mesh_judge(m, sizing, r, err);
  }
  vg_sizing_free(sizing);
  if (st >= 0 && vg_wants_median_dual(&p->asked))
    st = vg_mesh_judge_dual(m, r, err);
  return st;
}

static void print_json(json_t *o, const struct arguments *a)
{
  *a->written = 1;
  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

/* Inverted cells are mirrored on reading. If the mesh is not valid and the file
 * has 4-byte reals, rounding may have inverted them. */
static vg_status not_valid(const struct arguments *a,
                           const struct vg_turned *turned, struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  char cells[80] = "";

  if (!vg_ugrid_kind(a->one.file, &kind) || kind.real_size != 4)
    return vg_fail(err, VG_ERR_GEOMETRY, "%s: the mesh is not valid",
                   a->one.file);
  if (turned->cell)
    snprintf(cells, sizeof cells, " (inverted cells: %zu)", turned->cell);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: the mesh is not valid%s; its "
                 "coordinates are 4-byte reals: if the mesh was valid before "
                 "it was written, rounding has invalidated it; write 8-byte "
                 "reals, as in .lb8.ugrid",
                 a->one.file, cells);
}

/* The cells with their quality in the terms of solvers. */
static vg_status write_vtu(const struct arguments *a, const struct vg_mesh *m,
                           struct vg_error *err)
{
  static const char *const name[3] = { "non_orthogonality", "skewness",
                                       "orthogonal_quality" };
  size_t n = vg_mesh_n_cell(m);
  float *value = vg_alloc(3 * n, sizeof *value);
  struct vg_vtu_field field[3];
  vg_status st;

  if (!value) return vg_fail_memory(err, "the quality of the cells");
  for (size_t k = 0; k < 3; k++)
    field[k] = (struct vg_vtu_field){ name[k], VG_VTU_CELL, VG_VTU_FLOAT32, 1,
                                      value + k * n };
  VG_TRY(vg_mesh_solver_fields(m, value, value + n, value + 2 * n, err));
  st = vg_vtu_write(a->vtu, m, field, 3, err);
  if (st >= 0 && !a->one.json) printf("  quality of the cells: %s\n", a->vtu);
done:
  free(value);
  return st;
}

/* The parts of the report of a volume mesh. */
struct findings {
  const struct vg_mesh *m;
  const struct vg_read_info *info;
  struct vg_mesh_report quality;
  struct vg_sheet_report *sheets; /* [m->n_sheet] */
  struct vg_zone_report *zones;   /* [m->n_zone] */
  int has_accuracy;
  struct vg_accuracy_report accuracy;
};

/* The setting for inner surfaces that was given in vain, or NULL. */
static const char *inner_setting(const struct vg_problem *p)
{
  return *p->asked.baffles         ? "baffles"
       : *p->asked.sheets          ? "sheets"
       : *p->asked.zone_interfaces ? "zone_interfaces"
                                   : NULL;
}

static void put_json(const struct arguments *a, const struct vg_problem *p,
                     const struct findings *f, const struct vg_error *err)
{
  const struct vg_mesh_report *r = &f->quality;
  json_t *o = json_pack(
    "{s:s s:o s:b s:I s:I s:o s:o s:o s:o}", "vanguard", VG_VERSION, "file",
    vg_text_json(a->one.file), "ok", r->is_valid, "cells_turned",
    (json_int_t)f->info->turned.cell, "inner_faces",
    (json_int_t)(f->info->inner.n_face + f->info->inner.n_sheet_face), "size",
    vg_report_size_json(f->m), "patches", vg_report_patches_json(f->m), "mesh",
    vg_report_mesh_json(r, f->m), "limits_missed",
    vg_report_mesh_limits_json(&p->asked, r));

  if (f->sheets)
    json_object_set_new(o, "sheets", vg_report_sheets_json(f->m, f->sheets));
  if (f->zones)
    json_object_set_new(o, "zones", vg_report_zones_json(f->m, f->zones));
  if (f->has_accuracy)
    json_object_set_new(o, "accuracy",
                        vg_report_accuracy_json(&f->accuracy, f->m));
  if (inner_setting(p))
    json_object_set_new(o, "notes",
                        json_pack("[s+]", inner_setting(p), NO_INNER));
  if (!r->is_valid) vg_report_error_json(o, err);
  print_json(o, a);
}

static vg_status put_text(const struct arguments *a, const struct vg_problem *p,
                          const struct findings *f, struct vg_error *err)
{
  const struct vg_turned *turned = &f->info->turned;
  const struct vg_inner_faces *inner = &f->info->inner;

  printf("%s: volume mesh\n", a->one.file);
  vg_report_size_text(stdout, f->m);
  if (vg_report_patches_text(stdout, f->m, NULL) < 0)
    return vg_fail_memory(err, "the patches");
  vg_report_sheets_text(stdout, f->m, f->sheets);
  vg_report_zones_text(stdout, f->m, f->zones);
  if (turned->cell)
    printf("  cells of negative volume, mirrored on reading: %zu\n",
           turned->cell);
  if (inner->n_face)
    printf("  note: " VG_INNER_FACES_NOTE "\n", a->one.file, inner->n_face,
           inner->patches);
  if (inner_setting(p)) printf("  note: %s" NO_INNER "\n", inner_setting(p));
  for (size_t i = 0; a->sizes && i < p->notes.n; i++)
    printf("  note: %s\n", p->notes.text[i]);
  vg_report_mesh_text(stdout, &f->quality, 1);
  if (f->has_accuracy) vg_report_accuracy_text(stdout, &f->accuracy, f->m);
  return VG_OK;
}

/* Interfaces are all faces between two zones. */
static vg_status check_interfaces(const struct arguments *a,
                                  const struct vg_mesh *m,
                                  struct vg_mesh_report *r,
                                  struct vg_error *err)
{
  const char *what = "triangles of interfaces have one zone on both sides";
  double x[3];
  size_t n;
  vg_status st = vg_interfaces_judge(m, &n, x, err);

  if (st >= 0 && !n) {
    what = "faces between two zones are not in the interface between them";
    st = vg_zone_faces_judge(m, &n, x, err);
  }
  if (st < 0 || !n) return st;
  r->is_valid = 0;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s: the mesh is not valid: %zu %s, the first one at (%g, %g, "
                 "%g); write the zones and interfaces again from the mesh they "
                 "belong to",
                 a->one.file, n, what, x[0], x[1], x[2]);
}

static vg_status check_mesh(const struct arguments *a, struct vg_problem *p,
                            const struct vg_mesh *m,
                            const struct vg_read_info *info,
                            struct vg_error *err)
{
  struct findings f = { .m = m, .info = info };
  const struct vg_mesh_report *r = &f.quality;
  struct vg_mesh_limit limit[VG_MESH_LIMITS];
  vg_status st;

  VG_TRY(judge(a, p, m, &f.quality, err));
  VG_TRY(vg_sheet_sides_judge(m, &f.sheets, err));
  VG_TRY(vg_zone_quality_judge(m, &f.zones, err));
  if (a->with_accuracy && r->is_valid) {
    VG_TRY(vg_check_accuracy(&p->asked, m, &f.accuracy, err));
    f.has_accuracy = 1;
  }
  if (!r->is_valid) st = not_valid(a, &info->turned, err);
  else st = check_interfaces(a, m, &f.quality, err);
  *a->missed = vg_mesh_limits_missed(&p->asked, r, limit) > 0;
  if (a->one.json) put_json(a, p, &f, err);
  else if (put_text(a, p, &f, err) < 0) st = VG_ERR_MEMORY;
  if (a->vtu && r->is_valid && st >= 0) VG_TRY(write_vtu(a, m, err));
  fflush(stdout);
  vg_report_mesh_limits_text(stderr, &p->asked, r);
done:
  free(f.sheets);
  free(f.zones);
  vg_accuracy_release(&f.accuracy);
  return st;
}

/* Read and check a volume mesh. */
static vg_status check_volume(const struct arguments *a, struct vg_problem *p,
                              struct vg_display *show, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_read_info info = { .mapbc = p->asked.mapbc };
  vg_status st;

  VG_TRY(vg_mesh_read(a->one.file, &m, &info, err));
  vg_display_clear(show);
  st = check_mesh(a, p, &m, &info, err);
done:
  vg_mesh_release(&m);
  return st;
}

static vg_status check(const struct arguments *a, struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  struct vg_display show;
  const struct vg_check_surface surface = { a->one.file, a->defects,
                                            a->against,  a->vtu,
                                            a->one.json, a->deck != NULL,
                                            a->written };
  vg_status st;

  vg_display_init(&show, a->one.quiet);
  vg_display_end_at_once(1);
  vg_display_update(&show, "read", 0, 0);
  VG_TRY(vg_problem_open(&p, a->one.file, a->deck, err));
  VG_TRY(vg_cli_apply(&a->kept, &p.asked, err));
  if (vg_format_holds_cells(a->one.file)) {
    st = check_volume(a, &p, &show, err);
    goto done;
  }
  VG_TRY(vg_problem_read(&p, NULL, &show, err));
  if (p.read.has_cells) st = check_volume(a, &p, &show, err);
  else if (a->with_accuracy)
    st = vg_fail(
      err, VG_ERR_INPUT,
      "%s: --accuracy needs a mesh with cells, and this is a surface",
      a->one.file);
  else st = vg_check_surface(&surface, &p, &show, err);
done:
  vg_display_clear(&show);
  vg_problem_release(&p);
  return st;
}

/* The report on a file that could not be examined. */
static void print_failure(const struct arguments *a, const struct vg_error *err)
{
  json_t *o = json_pack("{s:s s:o s:b}", "vanguard", VG_VERSION, "file",
                        vg_text_json(a->one.file), "ok", 0);

  vg_report_error_json(o, err);
  print_json(o, a);
}

int vg_cmd_check(int argc, char **argv)
{
  const struct argp_option own[] = {
    { "project", 'p', "PROJECT", 0,
      "Same as FILE: a file, or the stem of a project", VG_GROUP_COMMON },
    { "deck", 'd', "FILE", 0,
      "Settings, patches and sources; if given, edges are compared with the "
      "target edge lengths of the deck [default STEM.deck if it exists, "
      "without this comparison]",
      VG_GROUP_COMMON },
    { "defects", 'f', "FILE", 0,
      "Write all faces with a defect to this .vtu "
      "file",
      VG_GROUP_COMMON },
    { "against", 'a', "FILE", 0,
      "Measure the distances between the surface and the one in FILE, in both "
      "directions",
      VG_GROUP_COMMON },
    { "vtu", 'v', "FILE", 0,
      "Write the triangles of a surface with smallest angle, radius ratio "
      "(2 r/R) and distance to this .vtu file, or the cells of a mesh with "
      "non-orthogonality, skewness and orthogonal quality",
      VG_GROUP_COMMON },
    { "accuracy", 'A', NULL, 0,
      "Report the errors of the schemes of solvers on a mesh: gradients, wall "
      "shear and Laplacian of smooth functions, compared with structured "
      "meshes; y+ follows from reynolds and reference_length, or is 1 at the "
      "height first [default of the mesh]",
      VG_GROUP_COMMON },
    { "json", 'j', NULL, 0, "Write the report as JSON to standard output",
      VG_GROUP_COMMON },
    { "quiet", 'q', NULL, 0, "Do not show progress", VG_GROUP_COMMON },
    { 0 }
  };
  struct vg_cli_options options;
  struct argp argp = {
    .parser = option,
    .args_doc = "FILE",
    .doc =
      "Check a volume mesh or a surface. For a volume mesh, report validity, "
      "dihedral angles, radius ratio, histograms and worst cells, with "
      "--sizes also lengths and shapes in the metric of the sizes. For a "
      "surface, report how 'vanguard mesh' with the same options would "
      "process it: flow domain, patches, repairs, remeshing, and every defect "
      "for which it would be rejected.\v"
      "Exit status: 0 if the mesh is valid or the surface is accepted, 4 if a "
      "limit on the mesh is not met, 1 otherwise."
  };
  int written = 0, missed = 0;
  struct arguments a = { .written = &written, .missed = &missed };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (vg_cli_options(own, &options, &err) < 0) return vg_cli_fail(&err);
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &a);
  st = check(&a, &err);
  if (st < 0 && a.one.json && !written) print_failure(&a, &err);
  vg_cli_options_free(&options);
  free(a.kept.set);
  if (st < 0) return vg_cli_fail(&err);
  return missed ? VG_EXIT_LIMIT : VG_EXIT_DONE;
}
