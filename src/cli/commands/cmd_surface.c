/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard surface: remeshes a surface to target edge lengths. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "core/surface/surface_quality.h"
#include "io/mesh/format.h"
#include "io/mesh/vtu.h"
#include "io/stream/stream.h"
#include "io/vgrid/mapbc.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/report/report.h"
#include "run/settings/lists.h"
#include "run/stages/output.h"

struct arguments {
  struct vg_cli_one one;
  const char *deck, *dir;
  struct vg_cli_overrides kept;
};

/* The output files; `stem` is the common beginning of their paths. */
struct files {
  char *stem;
  size_t n_item;
  char item[VG_WRITE_ITEMS][VG_WRITE_NAME];
  struct vg_outputs outputs;
};

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'd': a->deck = arg; return 0;
  case 'o': a->dir = arg; return 0;
  case 't': key = vg_cli_option_key("threads"); break;
  default: break;
  }
  if (!vg_cli_one(&a->one, "surface", key, arg, state)) return 0;
  return vg_cli_add_override(&a->kept, key, arg, state);
}

/* --- files --------------------------------------------------------------- */

static void release_files(struct files *f)
{
  vg_outputs_release(&f->outputs);
  free(f->stem);
}

/* Register a file to write. An existing file of that name, which may be the
 * input, is never overwritten. */
static vg_status add_file(struct files *f, const char *suffix,
                          struct vg_error *err)
{
  char *path;
  vg_status st = vg_outputs_add(&f->outputs, suffix, err);

  if (st < 0) return st;
  if (asprintf(&path, "%s.%s", f->stem, suffix) < 0)
    return vg_fail_memory(err, "a path");
  if (!access(path, F_OK))
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s exists and is not overwritten; remove "
                 "it or choose another folder with --out",
                 path);
  free(path);
  return st;
}

/* Files go to the folder of the input as STEM.new.*, or to the given folder
 * under the name of the input. */
static vg_status plan_files(struct vg_problem *p, const struct arguments *a,
                            struct files *f, struct vg_error *err)
{
  const char *stem = p->read.files.stem, *name = strrchr(stem, '/');
  vg_status st;

  name = name ? name + 1 : stem;
  if ((a->dir ? asprintf(&f->stem, "%s/%s", a->dir, name)
              : asprintf(&f->stem, "%s.new", stem)) < 0) {
    f->stem = NULL;
    return vg_fail_memory(err, "a path");
  }
  VG_TRY(vg_outputs_place(f->stem, a->dir, &f->outputs, err));
  VG_TRY(vg_outputs_claim(&f->outputs, &p->notes, err));
  VG_TRY(vg_write_list(p->asked.write, &f->n_item, f->item, err));
  for (size_t i = 0; i < f->n_item; i++) {
    if (!strcmp(f->item[i], "cogsg") || !strcmp(f->item[i], "openfoam"))
      VG_TRY(vg_fail(err, VG_ERR_INPUT,
                     "%s is a format for volume meshes; write the "
                     "surface as lb8.ugrid, stl, ...",
                     f->item[i]));
    VG_TRY(add_file(f, f->item[i], err));
  }
  VG_TRY(add_file(f, "mapbc", err));
  VG_TRY(add_file(f, "surface.vtu", err));
  VG_TRY(add_file(f, "surface.json", err));
done:
  return st;
}

/* --- output -------------------------------------------------------------- */

/* `angle` is an allocation of 2 n values: angles, then radius ratios. */
static vg_status write_vtu(const char *path, const struct vg_boundary *b,
                           struct vg_error *err)
{
  size_t n = b->surface.n_tri;
  double *angle = vg_alloc(2 * n, sizeof *angle);
  const struct vg_vtu_field field[3] = {
    { "smallest_angle", VG_VTU_CELL, VG_VTU_FLOAT64, 1, angle },
    { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT64, 1, angle + n },
    { "distance", VG_VTU_CELL, VG_VTU_FLOAT64, 1, b->remeshing.face }
  };
  vg_status st;

  if (!angle) return vg_fail_memory(err, "the angles");
  vg_surface_shapes(&b->surface, angle, angle + n);
  st = vg_vtu_write_boundary(path, &b->surface, field, 3, err);
  free(angle);
  return st;
}

static json_t *report(const struct vg_problem *p, const struct files *f)
{
  const struct vg_boundary *b = &p->boundary;
  json_t *notes = json_array(), *files = json_array();

  for (size_t i = 0; i < p->notes.n; i++)
    json_array_append_new(notes, vg_text_json(p->notes.text[i]));
  for (size_t i = 0; i < f->outputs.n_file; i++) {
    char *path = vg_outputs_final(&f->outputs, f->outputs.file[i].suffix);

    json_array_append_new(files, path ? vg_text_json(path) : NULL);
    free(path);
  }
  return json_pack("{s:b s:o s:o s:o s:o s:o}", "ok", 1, "remesh",
                   vg_report_remesh_json(&b->remeshing, &b->surface), "patches",
                   vg_report_patches_json(&b->surface), "surface",
                   vg_report_surface_json(&b->surface, &b->check, b->read->unit,
                                          VG_LISTED_DEFECTS),
                   "notes", notes, "files", files);
}

/* Write the file with the given suffix: the surface, its conditions, its
 * quality or the report. */
static vg_status write_file(const struct vg_problem *p, struct files *f,
                            const char *suffix, const json_t *o,
                            struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  char *path = vg_outputs_temp_path(&f->outputs, suffix);
  vg_status st;

  if (!path) return vg_fail_memory(err, "a path");
  VG_TRY(vg_boundary_single_sides(&p->boundary, &m, err));
  if (!strcmp(suffix, "mapbc"))
    st = vg_mapbc_write(path, &m, VG_MAPBC_VGRID, p->asked.title, NULL, err);
  else if (!strcmp(suffix, "surface.vtu"))
    st = write_vtu(path, &p->boundary, err);
  else if (!strcmp(suffix, "surface.json"))
    st = vg_json_write(path, o, "the report", err);
  else st = vg_format_write(path, &m, err);
done:
  vg_mesh_release(&m);
  free(path);
  return st;
}

static vg_status write_all(const struct vg_problem *p, struct files *f,
                           const json_t *o, struct vg_display *show,
                           struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_outputs_begin(&f->outputs, NULL, err));
  for (size_t i = 0; i < f->outputs.n_file; i++)
    VG_TRY(write_file(p, f, f->outputs.file[i].suffix, o, err));
  VG_TRY(vg_display_stopped(show, err));
  vg_display_commit();
  st = vg_outputs_commit(&f->outputs, err);
done:
  return vg_outputs_failed(&f->outputs, st, err);
}

static void print(const struct vg_problem *p, const struct files *f)
{
  const struct vg_boundary *b = &p->boundary;

  vg_report_remesh_text(stdout, &b->remeshing);
  vg_report_surface_text(stdout, &b->surface, &b->check, b->read->unit,
                         vg_boundary_is_stretched(b), 0);
  for (size_t i = 0; i < p->notes.n; i++)
    printf("  note: %s\n", p->notes.text[i]);
  for (size_t i = 0; i < f->outputs.n_file; i++) {
    char *path = vg_outputs_final(&f->outputs, f->outputs.file[i].suffix);

    printf("  %s\n", path ? path : "");
    free(path);
  }
}

/* Read deck and options; the command has its own default format and always
 * remeshes. */
static vg_status read_settings(const struct arguments *a, struct vg_problem *p,
                               struct vg_error *err)
{
  struct vg_settings *s = &p->asked;
  vg_status st;

  VG_TRY(vg_problem_open(p, a->one.file, a->deck, err));
  VG_TRY(vg_cli_apply(&a->kept, s, err));
  VG_TRY(vg_problem_refuse_section(p, err));
  if (!strcmp(s->write, "auto"))
    snprintf(s->write, sizeof s->write, "lb8.ugrid");
  s->remesh = VG_ANSWER_YES;
done:
  return st;
}

static vg_status make_surface(struct vg_problem *p, struct vg_display *show,
                              struct vg_error *err)
{
  const struct vg_shape_options o = { .threads = (int)p->asked.threads,
                                      .remesh_open = 1 };
  struct vg_boundary *b = &p->boundary;
  vg_status st;

  VG_TRY(vg_problem_read(p, NULL, show, err));
  VG_TRY(vg_boundary_shape(&p->read, &o, show, b, err));
  VG_TRY(vg_boundary_check(b, show, err));
  VG_TRY(vg_boundary_finish_conditions(b, err));
  vg_problem_note_unused(p, 0, VG_USE_JUDGED_SURFACE);
done:
  return st;
}

static vg_status run(const struct arguments *a, struct vg_display *show,
                     struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  struct files f = { .n_item = 0 };
  json_t *o = NULL;
  vg_status st;

  vg_display_deadline(VG_DISPLAY_SOON_S);
  vg_display_update(show, "read", 0, 0);
  VG_TRY(read_settings(a, &p, err));
  VG_TRY(plan_files(&p, a, &f, err));
  VG_TRY(make_surface(&p, show, err));
  o = report(&p, &f);
  if (!o) VG_TRY(vg_fail_memory(err, "the report"));
  vg_display_update(show, "write", p.boundary.surface.n_tri, 0);
  VG_TRY(write_all(&p, &f, o, show, err));
  vg_display_clear(show);
  if (a->one.json) {
    json_dumpf(o, stdout, JSON_INDENT(2));
    printf("\n");
  } else {
    printf("%s: remeshed surface\n", a->one.file);
    print(&p, &f);
  }
done:
  json_decref(o);
  release_files(&f);
  vg_problem_release(&p);
  return st;
}

int vg_cmd_surface(int argc, char **argv)
{
  const struct argp_option own[] = {
    { "project", 'p', "PROJECT", 0,
      "Same as INPUT: a file, or the stem of a project", VG_GROUP_COMMON },
    { "deck", 'd', "FILE", 0,
      "Settings, patches and sources [default "
      "STEM.deck if it exists]",
      VG_GROUP_COMMON },
    { "out", 'o', "DIR", 0,
      "Folder for the files, created if it does not exist; they "
      "have the stem of the input [default: the folder of the input, with the "
      "stem STEM.new]",
      VG_GROUP_COMMON },
    { "json", 'j', NULL, 0, "Write the report as JSON to standard output",
      VG_GROUP_COMMON },
    { "quiet", 'q', NULL, 0, "Do not show progress", VG_GROUP_COMMON },
    { NULL, 't', "N", 0, "Same as --threads", VG_GROUP_COMMON },
    { 0 }
  };
  struct vg_cli_options options;
  struct argp argp = {
    .parser = option,
    .args_doc = "INPUT",
    .doc =
      "Remesh a surface to target edge lengths given by its curvature, by "
      "settings and by sources, preserving feature edges, corners and patches. "
      "The command writes the surface (--write, default lb8.ugrid), its "
      "boundary conditions (.mapbc), quality and distance of the triangles "
      "(.surface.vtu) and the report (.surface.json)."
  };
  struct arguments a = { 0 };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (vg_cli_options(own, &options, &err) < 0) return vg_cli_fail(&err);
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &a);
  vg_display_init(&show, a.one.quiet);
  st = run(&a, &show, &err);
  vg_display_clear(&show);
  vg_cli_options_free(&options);
  free(a.kept.set);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
