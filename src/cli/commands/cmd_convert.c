/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard convert: writes a mesh or a surface in another format, and reports
 * what that format cannot hold. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "core/mesh/double_faces.h"
#include "core/mesh/zones.h"
#include "io/mesh/fluent.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/mesh/su2.h"
#include "io/mesh/ugrid.h"
#include "io/slices/slices.h"
#include "io/slices/ugrid_slices.h"
#include "io/stream/patch_words.h"
#include "io/stream/sheet_file.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/report/report.h"
#include "run/settings/patch_names.h"
#include "run/stages/output.h"

/* First line of a .mapbc of this command, which may be overwritten. */
#define TITLE "converted by Vanguard"

enum { KEY_FORM = 500, KEY_MAPBC, KEY_DOUBLED };

/* Cells of a slice, of which each thread has one in memory. */
#define SLICE_CELLS 100000

/* What a format stores. CODES: the conditions as they are; TYPES: a type that
 * follows from the condition. IDS: patch numbers, to which a .mapbc refers. */
enum {
  CELLS = 1,
  BOUNDARY = 2,
  QUADS = 4,
  NAMES = 8,
  WORDS = 16,
  IDS = 32,
  CODES = 64,
  TYPES = 128
};

static const struct held {
  const char *suffix;
  int what;
} held[] = {
  { "stl", BOUNDARY | NAMES },
  { "tri", BOUNDARY | IDS },
  { "obj", BOUNDARY | QUADS | NAMES },
  { "mesh", CELLS | BOUNDARY | QUADS | IDS },
  { "meshb", CELLS | BOUNDARY | QUADS | IDS },
  { "fluent.msh", CELLS | BOUNDARY | QUADS | WORDS | TYPES },
  { "msh", CELLS | BOUNDARY | QUADS | WORDS | IDS },
  { "cgns", CELLS | BOUNDARY | QUADS | WORDS | TYPES },
  { "cogsg", CELLS | BOUNDARY | IDS | WORDS | CODES },
  { VG_FOAM_SUFFIX, CELLS | BOUNDARY | QUADS | WORDS | TYPES },
  { "su2", CELLS | BOUNDARY | QUADS | WORDS },
  { VG_SU2_ZONES, CELLS | BOUNDARY | QUADS | WORDS },
  { "vtu", CELLS },
};
/* All kinds of UGRID. */
static const int held_by_ugrid = CELLS | BOUNDARY | QUADS | IDS;

struct arguments {
  const char *in, *out, *form, *mapbc, *doubled; /* NULL: not given */
  int json, quiet;
};

struct conversion {
  const struct arguments *a;
  struct vg_ugrid_slices *slices; /* NULL: `mesh` is the whole mesh */
  struct vg_mesh mesh; /* with `slices`: boundary and counts, borrowed */
  struct vg_read_info info;
  size_t n_cell, n_layer; /* n_layer: layer tetrahedra; 0: none, or unknown */
  char *file, *mapbc;     /* files written; mapbc: NULL without one */
  char *sheets;           /* file with the sheets, or NULL */
  const char *suffix;     /* of the format written */
  struct vg_outputs outputs;
  struct vg_foam_options foam;
  int what; /* stored in it */
  struct vg_notes notes;
};

/* --- the name of the output ---------------------------------------------- */

/* Suffix of the format that a word of --form, or a file name, stands for; NULL:
 * none that can be written. */
static const char *output_suffix(const char *word)
{
  const char *suffix, *best = NULL;
  size_t n = strlen(word);

  for (size_t i = 0; (suffix = vg_format_output_suffix(i)); i++) {
    size_t len = strlen(suffix);

    if (n < len || strcasecmp(word + n - len, suffix)) continue;
    if (n > len && word[n - len - 1] != '.') continue;
    if (!best || len > strlen(best)) best = suffix;
  }
  return best;
}

static vg_status unknown_form(const char *word, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_USAGE,
                 "%s: not a format that can be written; known formats are %s; "
                 "the suffix of OUT or --form selects one (foam and foam-ascii "
                 "are OpenFOAM cases)",
                 word, vg_format_list());
}

static int held_by(const char *suffix)
{
  struct vg_ugrid_kind kind;

  for (size_t i = 0; i < sizeof held / sizeof *held; i++)
    if (!strcmp(held[i].suffix, suffix)) return held[i].what;
  return vg_ugrid_kind(suffix, &kind) ? held_by_ugrid : 0;
}

/* Not the name of a file that can appear when it is complete: a device, a
 * pipe. */
static int is_special(const char *path)
{
  struct stat s;

  if (!strncmp(path, "/dev/", 5)) return 1;
  return !stat(path, &s) && !S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode);
}

/* Set file, suffix and what. */
static vg_status choose(struct conversion *c, struct vg_error *err)
{
  const char *form = c->a->form, *own = output_suffix(c->a->out);

  c->suffix = !form                        ? own
            : vg_foam_word(form, &c->foam) ? VG_FOAM_SUFFIX
                                           : output_suffix(form);
  if (!c->suffix || (form && *c->suffix != *VG_FOAM_SUFFIX &&
                     strcasecmp(form, c->suffix) != 0))
    return unknown_form(form ? form : c->a->out, err);
  if (asprintf(&c->file, own == c->suffix ? "%s" : "%s.%s", c->a->out,
               c->suffix) < 0) {
    c->file = NULL;
    return vg_fail_memory(err, "a file name");
  }
  if (is_special(c->a->out))
    return vg_fail(err, VG_ERR_USAGE,
                   "%s: not a regular file; give the name of a file",
                   c->a->out);
  if (vg_is_same_file(c->a->in, c->file))
    return vg_fail(err, VG_ERR_USAGE,
                   "%s: this is the input; give another name", c->file);
  c->what = held_by(c->suffix);
  return VG_OK;
}

/* The points of a .cogsg are in another order than those of the mesh, to which
 * STEM.sheets refers. */
static int is_reordered(const struct conversion *c)
{
  return !strcmp(c->suffix, "cogsg");
}

/* --- what is lost -------------------------------------------------------- */

static size_t count_codes(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t p = 0; p < m->n_patch; p++)
    n += m->patch[p].bc != VG_BC_NONE || m->patch[p].bc_fun3d != VG_BC_NONE;
  return n;
}

static size_t count_names(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t p = 0; p < m->n_patch; p++) n += *m->patch[p].name != 0;
  return n;
}

static void note_words(struct conversion *c)
{
  const struct vg_mesh *m = &c->mesh;
  char(*word)[VG_PATCH_WORD] = vg_patch_words(m, VG_PATCH_WORD_MOST);

  for (size_t p = 0; word && p < m->n_patch; p++) {
    const struct vg_patch *from = m->patch + p;
    char name[VG_NAME_MAX];

    if (*from->name && strcmp(from->name, word[p]))
      vg_note(&c->notes, "patch %d is called %s instead of '%s'", from->id,
              word[p], vg_text_clean(from->name, name, sizeof name));
  }
  free(word);
}

/* Names and conditions that neither the format nor a .mapbc holds. */
static void note_patches(struct conversion *c)
{
  size_t n_name = count_names(&c->mesh), n_code = count_codes(&c->mesh);

  if (!(c->what & (NAMES | WORDS)) && n_name && !c->mapbc)
    vg_note(&c->notes, ".%s has no names of patches: %zu names are lost",
            c->suffix, n_name);
  if (c->what & WORDS) note_words(c);
  if (c->what & CODES && n_code < c->mesh.n_patch)
    vg_note(&c->notes,
            "%zu patches without a condition are inviscid walls (5) in the "
            ".mapbc",
            c->mesh.n_patch - n_code);
  if (c->what & TYPES && n_code)
    vg_note(&c->notes,
            "conditions are written as the types of .%s, which cover fewer "
            "cases",
            c->suffix);
  else if (!(c->what & CODES) && n_code && !c->mapbc)
    vg_note(&c->notes,
            ".%s has no boundary conditions: those of %zu patches are lost",
            c->suffix, n_code);
}

static void note_mesh(struct conversion *c)
{
  const struct vg_mesh *m = &c->mesh;
  const size_t n_held = vg_format_holds_zones(c->suffix)
                        ? vg_mesh_interface_triangles(m)
                        : 0,
               n_lost = m->n_sheet_tri - n_held;
  struct vg_ugrid_kind kind;

  if (c->info.inner.n_face)
    vg_note(&c->notes, VG_INNER_FACES_NOTE, c->a->in, c->info.inner.n_face,
            c->info.inner.patches);
  if (m->n_sheet && !(c->what & CELLS))
    vg_note(&c->notes,
            ".%s holds surfaces: %zu triangles of sheets are omitted",
            c->suffix, m->n_sheet_tri);
  else if (n_lost && !c->sheets && !vg_format_holds_sheets(c->suffix))
    vg_note(&c->notes,
            ".%s has no faces between cells: %zu triangles of sheets are lost",
            c->suffix, n_lost);
  if (m->n_zone && !c->sheets &&
      (!(c->what & CELLS) || !vg_format_holds_zones(c->suffix)))
    vg_note(&c->notes, ".%s has no zones: %zu are lost", c->suffix, m->n_zone);
  if (m->is_resorted)
    vg_note(&c->notes, "cells were sorted by zones, of which each is together");
  if (m->n_sheet && (!strcmp(c->suffix, "mesh") || !strcmp(c->suffix, "meshb")))
    vg_note(&c->notes, ".%s has no names: those of %zu sheets are lost",
            c->suffix, m->n_sheet);
  if (m->n_zone && (!strcmp(c->suffix, "mesh") || !strcmp(c->suffix, "meshb")))
    vg_note(&c->notes,
            ".%s has neither names nor kinds of zones: those of %zu are lost",
            c->suffix, m->n_zone);
  if (c->sheets)
    vg_note(&c->notes,
            ".%s has no faces between cells: %zu triangles of sheets are in %s",
            c->suffix, m->n_sheet_tri, c->sheets);
  if (c->info.turned.cell)
    vg_note(&c->notes, "%zu cells of negative volume were mirrored",
            c->info.turned.cell);
  if (c->n_cell && !(c->what & CELLS))
    vg_note(&c->notes,
            ".%s holds surfaces: the %zu cells are omitted, and the boundary "
            "is written",
            c->suffix, c->n_cell);
  if (m->n_quad && c->what & BOUNDARY && !(c->what & QUADS))
    vg_note(&c->notes,
            ".%s has no quadrilaterals: %zu are written as two triangles each",
            c->suffix, m->n_quad);
  if (c->n_cell && !(c->what & BOUNDARY))
    vg_note(&c->notes, ".%s holds the cells only: the %zu patches are omitted",
            c->suffix, m->n_patch);
  else note_patches(c);
  if (vg_ugrid_kind(c->suffix, &kind)) {
    if (kind.real_size == 4)
      vg_note(&c->notes, "coordinates are rounded to 4-byte reals");
  } else if (c->n_layer)
    vg_note(&c->notes,
            "the number of layer tetrahedra (%zu) is not written; "
            "'vanguard partition' needs it to keep their stacks together",
            c->n_layer);
}

/* --- the .mapbc ---------------------------------------------------------- */

/* May the file be written: is it absent, or made by this command? */
static int is_free(const char *path)
{
  char line[256] = "";
  FILE *f = fopen(path, "r");
  int is_own;

  if (!f) return access(path, F_OK) != 0;
  is_own = fgets(line, sizeof line, f) && strstr(line, TITLE);
  if (!is_own) is_own = fgets(line, sizeof line, f) && strstr(line, TITLE);
  fclose(f);
  return is_own;
}

/* Conditions and names in STEM.mapbc, for formats that have patch numbers but
 * no conditions. */
static vg_status write_mapbc(struct conversion *c, struct vg_error *err)
{
  size_t n = strlen(c->file), n_stem = n - strlen(c->suffix) - 1, n_unset = 0;
  const struct vg_mesh m = c->slices ? vg_ugrid_slices_boundary(c->slices)
                                     : c->mesh;
  char *path;
  vg_status st;

  if (!(c->what & IDS) || c->what & CODES || !count_codes(&c->mesh))
    return VG_OK;
  if (asprintf(&c->mapbc, "%.*s.mapbc", (int)n_stem, c->file) < 0) {
    c->mapbc = NULL;
    return vg_fail_memory(err, "a file name");
  }
  if (!is_free(c->mapbc)) {
    vg_note(&c->notes,
            "%s exists and is not overwritten; remove it or write under "
            "another name if it does not belong to this mesh",
            c->mapbc);
    free(c->mapbc);
    c->mapbc = NULL;
    return VG_OK;
  }
  path = vg_outputs_temp_path(&c->outputs, "mapbc");
  st = path ? vg_outputs_add(&c->outputs, "mapbc", err)
            : vg_fail_memory(err, "a file name");
  if (st >= 0)
    st = vg_mapbc_write(path, &m, VG_MAPBC_VGRID, TITLE, &n_unset, err);
  free(path);
  if (st >= 0 && n_unset)
    vg_note(&c->notes,
            "%zu patches without a condition are inviscid walls (5) in %s",
            n_unset, c->mapbc);
  return st;
}

/* Gmsh requires positive numbers of groups; without them the writer numbers the
 * patches from 1. */
static void check_ids(struct conversion *c)
{
  if (strcmp(c->suffix, "msh") != 0) return;
  for (size_t p = 0; p < c->mesh.n_patch; p++)
    if (c->mesh.patch[p].id <= 0 || c->mesh.patch[p].id == INT32_MAX)
      c->what &= ~IDS;
}

/* --- sheets -------------------------------------------------------------- */

/* The sheets in STEM.sheets, for formats that do not hold them. */
static vg_status write_sheets(struct conversion *c, struct vg_error *err)
{
  const struct vg_mesh *m = &c->mesh;
  const size_t before = c->outputs.n_file;
  vg_status st;

  if (!(c->what & CELLS) || !c->n_cell || vg_format_holds_zones(c->suffix) ||
      is_reordered(c))
    return VG_OK;
  st = vg_outputs_sheets(&c->outputs, m, m->n_point, c->n_cell, &c->notes, err);
  if (st < 0 || c->outputs.n_file == before) return st;
  c->sheets = vg_outputs_final(&c->outputs, VG_SHEET_SUFFIX);
  return c->sheets ? VG_OK : vg_fail_memory(err, "a file name");
}

/* --- steps --------------------------------------------------------------- */

/* The name has the suffix of no format. */
static vg_status refuse_stem(const char *name, struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;

  vg_format_unknown(name, &why);
  return vg_fail(err, VG_ERR_USAGE,
                 "%s; give the complete name of a file, not the stem of a "
                 "project",
                 why.text);
}

/* Can the output be written from slices, in the same bytes? Doubled interfaces
 * have other points than the file. The writer of
 * .cogsg needs boundary points that come first, and that of .fluent.msh keeps
 * the faces between slices. */
static int takes_slices(const struct conversion *c)
{
  const size_t n = strlen(c->file), len = strlen(c->suffix);

  return !c->a->doubled && vg_slices_can_write(c->suffix) &&
         strcmp(c->suffix, "cogsg") && strcmp(c->suffix, VG_FLUENT_SUFFIX) &&
         n > len && !strcmp(c->file + n - len, c->suffix);
}

/* Read a mesh of which only slices are in memory, if file and output allow it:
 * c->slices is set then. */
static vg_status open_slices(struct conversion *c, struct vg_error *err)
{
  const struct vg_slices *s;
  vg_status st;

  if (!takes_slices(c)) return VG_OK;
  st = vg_ugrid_slices_open(c->a->in, SLICE_CELLS, &c->slices, &c->info, err);
  if (st < 0 || !c->slices) return st;
  s = vg_ugrid_slices(c->slices);
  c->mesh = *s->boundary;
  c->mesh.n_point = (size_t)s->n_point;
  c->mesh.n_tet = (size_t)s->n_cell[VG_SLICE_TET];
  c->mesh.n_pyr = (size_t)s->n_cell[VG_SLICE_PYR];
  c->mesh.n_pri = (size_t)s->n_cell[VG_SLICE_PRI];
  c->mesh.n_hex = (size_t)s->n_cell[VG_SLICE_HEX];
  c->n_layer = (size_t)s->n_layer_cell[VG_SLICE_TET];
  return VG_OK;
}

static vg_status read_whole(struct conversion *c, struct vg_error *err)
{
  int is_known;
  vg_status st;

  VG_TRY(vg_mesh_read(c->a->in, &c->mesh, &c->info, err));
  VG_TRY(vg_format_layer_tets(c->a->in, &is_known, &c->n_layer, err));
  if (!is_known || c->n_layer > c->mesh.n_tet) c->n_layer = 0;
done:
  return st;
}

/* The interfaces of the list become two patches each. */
static vg_status double_interfaces(struct conversion *c, struct vg_error *err)
{
  struct vg_mesh *m = &c->mesh, list = VG_MESH_INIT;
  uint8_t *on = vg_calloc(m->n_sheet, 1),
          *is_doubled = vg_calloc(m->n_sheet, 1);
  const size_t n_patch = m->n_patch, n_point = m->n_point;
  vg_status st = VG_OK;

  list.patch = vg_alloc(m->n_sheet, sizeof *list.patch);
  if (!on || !is_doubled || !list.patch)
    VG_TRY(vg_fail_memory(err, "the interfaces"));
  for (size_t i = 0; i < m->n_sheet; i++)
    if (m->sheet[i].is_interface) list.patch[list.n_patch++] = m->sheet[i];
  if (!list.n_patch)
    VG_TRY(vg_fail(err, VG_ERR_INPUT,
                   "--double-interfaces: %s has no interfaces between zones",
                   c->a->in));
  VG_TRY(vg_patch_list_mark("double-interfaces", c->a->doubled, &list,
                            list.n_patch, on, err));
  for (size_t i = 0, k = 0; i < m->n_sheet; i++)
    if (m->sheet[i].is_interface) is_doubled[i] = on[k++];
  VG_TRY(vg_mesh_double_faces(m, is_doubled, err));
  for (size_t i = n_patch; i < m->n_patch; i += 2)
    vg_note(&c->notes,
            "interface %d%s%s has two sides, the back is patch %d%s%s",
            (int)m->patch[i].id, *m->patch[i].name ? " " : "", m->patch[i].name,
            (int)m->patch[i + 1].id, *m->patch[i].name ? " " : "",
            m->patch[i + 1].name);
  vg_note(&c->notes, "%zu copies of points follow the others",
          m->n_point - n_point);
done:
  free(on);
  free(is_doubled);
  free(list.patch);
  return st;
}

static vg_status read_input(struct conversion *c, struct vg_error *err)
{
  const struct vg_mesh *m = &c->mesh;
  vg_status st;

  if (!vg_format_suffix_length(c->a->in)) return refuse_stem(c->a->in, err);
  c->info.mapbc = c->a->mapbc;
  VG_TRY(open_slices(c, err));
  if (!c->slices) VG_TRY(read_whole(c, err));
  c->n_cell = vg_mesh_n_cell(m);
  if (c->info.has_own_mapbc)
    vg_note_own_mapbc(&c->notes, c->a->in,
                      strlen(c->a->in) - vg_format_suffix_length(c->a->in));
  if (c->info.match.n_missing)
    vg_note(&c->notes,
            "%zu patches have no entry in the .mapbc, first patch %d",
            c->info.match.n_missing, c->info.match.first_missing);
  if (c->info.match.n_renamed) vg_note_renamed(&c->notes, &c->info.match);
  if (c->a->doubled) st = double_interfaces(c, err);
done:
  return st;
}

/* The suffix of the file, in the letters of its name. */
static const char *own_suffix(const struct conversion *c)
{
  return c->file + strlen(c->file) - strlen(c->suffix);
}

static vg_status write_slices(struct conversion *c, const char *path,
                              struct vg_error *err)
{
  const struct vg_slices_options o = { .plain = 1, .tail = c->n_layer > 0 };
  const size_t n_stem = strlen(path) - strlen(c->suffix) - 1;
  char *stem = strndup(path, n_stem);
  vg_status st;

  if (!stem) return vg_fail_memory(err, "a file name");
  st = vg_slices_write_with(NULL, vg_ugrid_slices(c->slices), stem, c->suffix,
                            &o, err);
  free(stem);
  return st;
}

static vg_status write_mesh(struct conversion *c, const char *path,
                            struct vg_error *err)
{
  struct vg_ugrid_kind kind;

  if (c->slices) return write_slices(c, path, err);
  if (!strcmp(c->suffix, VG_FOAM_SUFFIX))
    return vg_foam_write(path, &c->mesh, &c->foam, err);
  if (c->n_layer && vg_ugrid_kind(c->suffix, &kind) && !kind.is_text)
    return vg_ugrid_write_tail(path, &c->mesh, c->n_layer, err);
  return vg_format_write(path, &c->mesh, err);
}

/* The files that the writer of .cogsg or .vtu adds to the first one. */
static vg_status add_companions(struct conversion *c, struct vg_error *err)
{
  static const char *const known[] = { "bc", "mapbc", "surface.vtu" };
  vg_status st = VG_OK;

  for (size_t i = 0; i < sizeof known / sizeof *known && st >= 0; i++) {
    char *path = vg_outputs_temp_path(&c->outputs, known[i]);

    if (!path) st = vg_fail_memory(err, "a file name");
    else if (!access(path, F_OK))
      st = vg_outputs_add(&c->outputs, known[i], err);
    free(path);
  }
  return st;
}

static vg_status write_output(struct conversion *c, struct vg_error *err)
{
  char *path = vg_outputs_temp_path(&c->outputs, own_suffix(c));
  vg_status st = path ? vg_outputs_add(&c->outputs, own_suffix(c), err)
                      : vg_fail_memory(err, "a file name");

  if (st >= 0) {
    c->outputs.file[0].is_case = !strcmp(c->suffix, VG_FOAM_SUFFIX);
    st = write_mesh(c, path, err);
  }
  free(path);
  return st < 0 ? st : add_companions(c, err);
}

/* The folder and the stem of the file, whose names are locked. */
static vg_status claim(struct conversion *c, struct vg_error *err)
{
  char *stem = strndup(c->file, strlen(c->file) - strlen(c->suffix) - 1);
  vg_status st = stem ? vg_outputs_place(stem, NULL, &c->outputs, err)
                      : vg_fail_memory(err, "a file name");

  free(stem);
  return st < 0 ? st : vg_outputs_claim(&c->outputs, &c->notes, err);
}

static vg_status convert(struct conversion *c, struct vg_display *show,
                         struct vg_error *err)
{
  vg_status st;

  VG_TRY(choose(c, err));
  VG_TRY(claim(c, err));
  vg_display_update(show, "read", 0, 0);
  VG_TRY(read_input(c, err));
  vg_display_update(show, "write", c->n_cell, 0);
  VG_TRY(vg_outputs_begin(&c->outputs, NULL, err));
  VG_TRY(vg_outputs_failed(&c->outputs, write_output(c, err), err));
  check_ids(c);
  VG_TRY(vg_outputs_failed(&c->outputs, write_mapbc(c, err), err));
  VG_TRY(vg_outputs_failed(&c->outputs, write_sheets(c, err), err));
  VG_TRY(vg_display_stopped(show, err));
  vg_display_commit();
  VG_TRY(vg_outputs_commit(&c->outputs, err));
  note_mesh(c);
done:
  return st;
}

static void bounds(const struct conversion *c, double lo[3], double hi[3])
{
  if (c->slices) vg_ugrid_slices_bounds(c->slices, lo, hi);
  else vg_mesh_bounds(&c->mesh, lo, hi);
}

static void print_json(const struct conversion *c)
{
  json_t *files = json_array(), *o;
  double lo[3], hi[3];

  bounds(c, lo, hi);
  json_array_append_new(files, vg_text_json(c->file));
  if (c->mapbc) json_array_append_new(files, vg_text_json(c->mapbc));
  if (c->sheets) json_array_append_new(files, vg_text_json(c->sheets));
  o = json_pack("{s:o s:s s:o s:o s:o s:f}", "file", vg_text_json(c->a->in),
                "format", c->suffix, "files", files, "size",
                vg_report_counts_json(&c->mesh, lo, hi), "notes",
                vg_report_notes_json(&c->notes), "peak_memory_bytes",
                vg_report_peak_memory());
  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

static void print_text(const struct conversion *c)
{
  double lo[3], hi[3];

  bounds(c, lo, hi);
  printf("%s: %s\n", c->a->in, c->n_cell ? "volume mesh" : "surface");
  vg_report_counts_text(stdout, &c->mesh, lo, hi);
  for (size_t i = 0; i < c->notes.n; i++)
    printf("  note: %s\n", c->notes.text[i]);
  printf("  %s\n", c->file);
  if (c->mapbc) printf("  %s\n", c->mapbc);
  if (c->sheets) printf("  %s\n", c->sheets);
}

/* --- options ------------------------------------------------------------- */

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case KEY_FORM: a->form = arg; return 0;
  case KEY_MAPBC: a->mapbc = arg; return 0;
  case KEY_DOUBLED: a->doubled = arg; return 0;
  case 'j': a->json = 1; return 0;
  case 'q': a->quiet = 1; return 0;
  case ARGP_KEY_ARG:
    if (a->out) argp_error(state, "a third argument, %s", arg);
    if (a->in) a->out = arg;
    else a->in = arg;
    return 0;
  case ARGP_KEY_END:
    if (!a->out) argp_error(state, "give the input and the output file");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

int vg_cmd_convert(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "form", KEY_FORM, "WORD", 0,
      "Format of the output, as in the write list of 'vanguard mesh': "
      "lb8.ugrid, msh, cgns, su2, zones.su2, vtu, meshb, fluent.msh, foam, "
      "foam-ascii, stl, ... [default: by the suffix of OUT]",
      0 },
    { "mapbc", KEY_MAPBC, "FILE", 0,
      "Boundary conditions and names of the patches of IN [default: the "
      ".mapbc with the stem of IN, if there is one]",
      0 },
    { "double-interfaces", KEY_DOUBLED, "LIST", 0,
      "Interfaces whose two sides become patches with points of their own, for "
      "zones that move along each other: numbers, names or patterns such as "
      "'rotor*'",
      0 },
    { "json", 'j', NULL, 0, "Write the report as JSON to standard output", 0 },
    { "quiet", 'q', NULL, 0, "Do not show progress", 0 },
    { 0 }
  };
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "IN OUT",
    .doc = "Write the volume mesh or the surface IN in the format of OUT. "
           "Points, cells and their order are kept. Names and conditions of "
           "patches that the format cannot hold are written to a .mapbc with "
           "the stem of OUT, if the format has patch numbers; notes list "
           "everything that is lost. IN and OUT are names of files, not stems "
           "of projects."
  };
  struct arguments a = { 0 };
  struct conversion c = { .a = &a };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_cli_parse(&argp, argc, argv, &a);
  vg_display_init(&show, a.quiet);
  vg_display_deadline(VG_DISPLAY_SOON_S);
  st = convert(&c, &show, &err);
  vg_display_clear(&show);
  if (st >= 0) {
    if (a.json) print_json(&c);
    else print_text(&c);
  }
  if (!c.slices) vg_mesh_release(&c.mesh);
  vg_ugrid_slices_close(c.slices);
  vg_outputs_release(&c.outputs);
  vg_notes_release(&c.notes);
  free(c.file);
  free(c.mapbc);
  free(c.sheets);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
