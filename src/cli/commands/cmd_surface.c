/* vanguard surface: a triangulation in, a surface of triangles to size out. */
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
#include "run/common/folder.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/report/report.h"
#include "run/settings/lists.h"

#define FILES (VG_WRITE_ITEMS + 3)

struct arguments {
  struct vg_cli_one one;
  const char *deck, *dir;
  struct vg_cli_overrides kept;
};

/* Files are written beside their places and moved there together. */
struct files {
  char *stem;
  size_t n;
  struct { char *path, *temp; } file[FILES];
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
  for (size_t i = 0; i < f->n; i++) {
    if (f->file[i].temp) unlink(f->file[i].temp);
    free(f->file[i].path);
    free(f->file[i].temp);
  }
  free(f->stem);
}

/* A file to write, for which there must be room: what is there is an input or
 * somebody's work. */
static vg_status add_file(struct files *f, const char *suffix,
                          struct vg_error *err)
{
  char *path, *temp;
  const char *name = strrchr(f->stem, '/');
  int folder = name ? (int)(name - f->stem) + 1 : 0;

  if (asprintf(&path, "%s.%s", f->stem, suffix) < 0)
    return vg_fail_memory(err, "a path");
  if (asprintf(&temp, "%.*s.vanguard-%ld-%s.%s", folder, f->stem,
               (long)getpid(), f->stem + folder, suffix) < 0) {
    free(path);
    return vg_fail_memory(err, "a path");
  }
  f->file[f->n].path = path;
  f->file[f->n++].temp = temp;
  if (access(path, F_OK)) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "%s exists and is not overwritten; remove "
                 "it or choose another folder with --out", path);
}

/* Beside the input, under a name of its own, or in a folder, under its name. */
static vg_status plan_files(const struct vg_problem *p,
                            const struct arguments *a, struct files *f,
                            struct vg_error *err)
{
  char item[VG_WRITE_ITEMS][VG_WRITE_NAME];
  const char *name = strrchr(p->files.stem, '/');
  size_t n = 0;
  vg_status st;

  name = name ? name + 1 : p->files.stem;
  if (a->dir) VG_TRY(vg_make_folder(a->dir, err));
  if ((a->dir ? asprintf(&f->stem, "%s/%s", a->dir, name)
              : asprintf(&f->stem, "%s.new", p->files.stem)) < 0) {
    f->stem = NULL;
    return vg_fail_memory(err, "a path");
  }
  VG_TRY(vg_write_list(p->settings.write, &n, item, err));
  for (size_t i = 0; i < n; i++) {
    if (!strcmp(item[i], "cogsg") || !strcmp(item[i], "openfoam"))
      VG_TRY(vg_fail(err, VG_ERR_INPUT, "%s is for volume meshes; write the "
                     "surface as lb8.ugrid, stl, ...", item[i]));
    VG_TRY(add_file(f, item[i], err));
  }
  VG_TRY(add_file(f, "mapbc", err));
  VG_TRY(add_file(f, "surface.vtu", err));
  VG_TRY(add_file(f, "surface.json", err));
done:
  return st;
}

static vg_status move_files(struct files *f, struct vg_error *err)
{
  for (size_t i = 0; i < f->n; i++) {
    if (rename(f->file[i].temp, f->file[i].path))
      return vg_fail(err, VG_ERR_IO, "%s: cannot be put into its place",
                     f->file[i].path);
    free(f->file[i].temp);
    f->file[i].temp = NULL;
  }
  return VG_OK;
}

/* --- what is written ----------------------------------------------------- */

/* The first of both arrays begins what is allocated. */
static vg_status write_vtu(const char *path, const struct vg_problem *p,
                           struct vg_error *err)
{
  size_t n = p->surface.n_tri;
  double *angle = vg_alloc(2 * n, sizeof *angle);
  const struct vg_vtu_field field[3] = {
    { "smallest_angle", VG_VTU_CELL, VG_VTU_FLOAT64, 1, angle },
    { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT64, 1, angle + n },
    { "distance", VG_VTU_CELL, VG_VTU_FLOAT64, 1, p->renewal.face } };
  vg_status st;

  if (!angle) return vg_fail_memory(err, "the angles");
  vg_surface_shapes(&p->surface, angle, angle + n);
  st = vg_vtu_write_boundary(path, &p->surface, field, 3, err);
  free(angle);
  return st;
}

static json_t *report(const struct vg_problem *p, const struct files *f)
{
  json_t *notes = json_array(), *files = json_array();

  for (size_t i = 0; i < p->notes.n; i++)
    json_array_append_new(notes, vg_text_json(p->notes.text[i]));
  for (size_t i = 0; i < f->n; i++)
    json_array_append_new(files, vg_text_json(f->file[i].path));
  return json_pack("{s:b s:o s:o s:o s:o s:o}", "ok", 1, "remesh",
                   vg_report_remesh_json(&p->renewal, &p->surface), "patches",
                   vg_report_patches_json(&p->surface), "surface",
                   vg_report_surface_json(&p->surface, &p->check,
                                          VG_LISTED_DEFECTS),
                   "notes", notes, "files", files);
}

static vg_status write_all(const struct vg_problem *p, struct files *f,
                           const json_t *o, struct vg_display *show,
                           struct vg_error *err)
{
  size_t n = f->n - 3;
  vg_status st = VG_OK;

  for (size_t i = 0; i < n; i++)
    VG_TRY(vg_format_write(f->file[i].temp, &p->surface, err));
  VG_TRY(vg_mapbc_write(f->file[n].temp, &p->surface, VG_MAPBC_VGRID,
                        p->settings.title, NULL, err));
  VG_TRY(write_vtu(f->file[n + 1].temp, p, err));
  VG_TRY(vg_json_write(f->file[n + 2].temp, o, "the report", err));
  VG_TRY(vg_display_stopped(show, err));
  VG_TRY(move_files(f, err));
done:
  return st;
}

static void print(const struct vg_problem *p, const struct files *f)
{
  vg_report_remesh_text(stdout, &p->renewal);
  vg_report_surface_text(stdout, &p->surface, &p->check, 0);
  for (size_t i = 0; i < p->notes.n; i++)
    printf("  note: %s\n", p->notes.text[i]);
  for (size_t i = 0; i < f->n; i++) printf("  %s\n", f->file[i].path);
}

static vg_status run(const struct arguments *a, struct vg_display *show,
                     struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  struct files f = { .n = 0 };
  json_t *o = NULL;
  vg_status st;

  vg_display_end_at_once(1);     /* nothing is written yet */
  vg_display_update(show, "read", 0, 0);
  VG_TRY(vg_input_find(a->one.file, a->deck, &p.files, err));
  VG_TRY(vg_problem_deck(&p, err));
  VG_TRY(vg_cli_apply(&a->kept, &p.settings, err));
  if (!strcmp(p.settings.write, "auto"))
    snprintf(p.settings.write, sizeof p.settings.write, "lb8.ugrid");
  p.settings.remesh = VG_ANSWER_YES;
  p.surface_only = 1;
  p.threads = (int)p.settings.threads;
  VG_TRY(plan_files(&p, a, &f, err));
  VG_TRY(vg_problem_surface(&p, show, err));
  VG_TRY(vg_problem_close(&p, show, err));
  vg_problem_note_unset(&p);
  vg_problem_note_unused(&p, 0, VG_USE_JUDGED_SURFACE);
  o = report(&p, &f);
  if (!o) VG_TRY(vg_fail_memory(err, "the report"));
  vg_display_end_at_once(0);
  vg_display_update(show, "write", p.surface.n_tri, 0);
  VG_TRY(write_all(&p, &f, o, show, err));
  vg_display_clear(show);
  if (a->one.json) {
    json_dumpf(o, stdout, JSON_INDENT(2));
    printf("\n");
  } else {
    printf("%s: a new surface\n", a->one.file);
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
    { "deck", 'd', "FILE", 0, "settings, patches and sources [default "
      "STEM.deck where that exists]", 0 },
    { "out", 'o', "DIR", 0, "folder for the files, made where absent; they "
      "have the name of the input [default beside it, as STEM.new]", 0 },
    { "json", 'j', NULL, 0, "report as JSON", 0 },
    { "quiet", 'q', NULL, 0, "no progress", 0 },
    { NULL, 't', "N", 0, "as --threads", 0 },
    { 0 }
  };
  struct vg_cli_options options;
  struct argp argp = { .parser = option, .args_doc = "INPUT",
    .doc = "Make the triangles of a surface anew, as long as its shape and "
      "sources ask for. Ridges, corners and patches stay. Written are the "
      "surface (--write, default lb8.ugrid), its conditions (.mapbc), quality "
      "and distance (.surface.vtu) and the report (.surface.json)." };
  struct arguments a = { 0 };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (vg_cli_options(own, &options) < 0) {
    vg_fail_memory(&err, "the options");
    return vg_cli_fail(&err);
  }
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &a);
  vg_display_init(&show, a.one.quiet);
  st = run(&a, &show, &err);
  vg_display_clear(&show);
  vg_cli_options_free(&options);
  free(a.kept.set);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
