/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/input/cones.h"
#include "run/input/wakes.h"
#include "run/input/input.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "io/mesh/aflr.h"
#include "io/mesh/format.h"
#include "io/section/section.h"
#include "io/vgrid/mapbc.h"
#include "io/vgrid/vgrid.h"
#include "layers/columns/growth_law.h"
#include "run/common/text.h"
#include "run/input/shape_parts.h"
#include "run/input/share.h"
#include "run/input/sizes.h"
#include "run/input/wall_shear.h"
#include "run/input/zone_table.h"
#include "run/input/mesh_unit.h"
#include "run/settings/deck.h"
#include "run/settings/plan_options.h"
#include "run/settings/patch_names.h"

void vg_note(struct vg_notes *notes, const char *format, ...)
{
  va_list args;
  char *text;
  int n;

  va_start(args, format);
  n = vasprintf(&text, format, args);
  va_end(args);
  if (n >= 0 && !vg_reserve(&notes->text, &notes->cap, notes->n + 1,
                            sizeof *notes->text)) {
    notes->text[notes->n++] = text;
    return;
  }
  if (n >= 0) free(text);
  vg_print_lose();
}

void vg_notes_release(struct vg_notes *notes)
{
  for (size_t i = 0; i < notes->n; i++) free(notes->text[i]);
  free(notes->text);
  memset(notes, 0, sizeof *notes);
}

static void release_files(struct vg_input_files *f)
{
  free(f->stem);
  free(f->d3m);
  free(f->front);
  free(f->surface);
  free(f->mapbc);
  free(f->deck);
  free(f->tags);
  free(f->aflr);
  memset(f, 0, sizeof *f);
}

void vg_boundary_release(struct vg_boundary *b)
{
  vg_boundary_forget_zones(b);
  vg_boundary_forget_gaps(b);
  if (b->common.data) vg_shmem_release(&b->common);
  else vg_mesh_release(&b->surface);
  vg_mesh_release(&b->inner);
  vg_surface_report_release(&b->check);
  vg_flow_release(&b->flow);
  vg_remeshing_release(&b->remeshing);
  vg_cad_model_release(&b->model);
  free(b->row);
  vg_pairs_release(&b->pairs);
  free(b->given_area.id);
  free(b->given_area.area);
}

static void release_read(struct vg_read *r)
{
  release_files(&r->files);
  vg_settings_release(&r->settings);
  vg_project_release(&r->project);
  vg_size_samples_free(r->samples);
  vg_size_mesh_free(r->metrics);
  vg_wall_shear_free(r->shear);
  vg_mesh_release(&r->surface);
  vg_cad_model_release(&r->model);
  free(r->heights.item);
  vg_read_wakes_release(&r->wakes);
}

void vg_problem_forget_sizes(struct vg_problem *p)
{
  vg_boundary_forget_gaps(&p->boundary);
  vg_wall_shear_free(p->read.shear);
  p->read.shear = NULL;
  if (!p->read.samples && !p->read.metrics) return;
  vg_size_samples_free(p->read.samples);
  vg_size_mesh_free(p->read.metrics);
  p->read.samples = NULL;
  p->read.metrics = NULL;
  p->read.map = p->boundary.map = NULL;
}

void vg_problem_release(struct vg_problem *p)
{
  vg_boundary_release(&p->boundary);
  release_read(&p->read);
  vg_resolved_release(&p->resolved);
  vg_settings_release(&p->asked);
  vg_notes_release(&p->notes);
}

static int exists(const char *path)
{
  return access(path, F_OK) == 0;
}

static int has_mode(const char *path, mode_t kind)
{
  struct stat s;

  return stat(path, &s) == 0 && (s.st_mode & S_IFMT) == kind;
}

/* Path of stem.suffix if that file exists, otherwise "". NULL: no memory. */
static char *adjacent(const char *stem, const char *suffix)
{
  char *path;

  if (asprintf(&path, "%s.%s", stem, suffix) < 0) return NULL;
  if (!exists(path)) *path = 0;
  return path;
}

/* Surface file of a stem: the only one without cells, since files with cells
 * next to it are meshes of earlier runs. */
static vg_status find_surface(const char *stem, char **out,
                              struct vg_error *err)
{
  const char *suffix;
  char *found = NULL;
  vg_status st = VG_OK;

  for (size_t i = 0; (suffix = vg_format_input_suffix(i)) && st >= 0; i++) {
    char *path = adjacent(stem, suffix);

    if (!path) {
      st = vg_fail_memory(err, "a path");
    } else if (!*path || vg_format_holds_cells(path)) {
      free(path);
    } else if (found) {
      st = vg_fail(err, VG_ERR_INPUT,
                   "both %s and %s could be the surface; give the complete "
                   "name of one of them",
                   found, path);
      free(path);
    } else {
      found = path;
    }
  }
  /* Other programs write .dat files next to a surface. */
  if (st >= 0 && !found) found = adjacent(stem, &VG_SECTION_SUFFIX[1]);
  if (st < 0) {
    free(found);
    return st;
  }
  *out = found;
  return found ? VG_OK : vg_fail_memory(err, "a path");
}

/* Stem of a complete surface name; NULL if it is not one. */
static char *stem_of(const char *name)
{
  size_t suffix = vg_section_is(name) ? vg_section_suffix_length(name)
                                      : vg_format_suffix_length(name);
  size_t n = strlen(name);

  if (!suffix || suffix >= n || !exists(name)) return NULL;
  return strndup(name, n - suffix);
}

static vg_status find_companions(struct vg_input_files *f, const char *deck,
                                 struct vg_error *err)
{
  f->mapbc = adjacent(f->stem, "mapbc");
  if (f->mapbc && !*f->mapbc) {
    free(f->mapbc);
    f->mapbc = adjacent(f->stem, "mapbc.gz");
  }
  f->deck = deck ? strdup(deck) : adjacent(f->stem, "deck");
  f->tags = adjacent(f->stem, "tags");
  f->aflr = adjacent(f->stem, "bc");
  if (!f->d3m) f->d3m = strdup("");
  if (!f->front) f->front = strdup("");
  /* A .bc next to a mesh of an earlier run is in the format of VGRID. */
  if (f->aflr && *f->aflr && !vg_aflr_is_bc(f->aflr)) *f->aflr = 0;
  if (!f->mapbc || !f->deck || !f->d3m || !f->front || !f->tags || !f->aflr)
    return vg_fail_memory(err, "the paths of the project");
  return VG_OK;
}

/* Neither a file nor a project of this name exists. A name with the suffix of a
 * format is that of a file. */
static vg_status refuse_absent(const char *name, struct vg_error *err)
{
  const char *slash = strrchr(name, '/');
  char *folder = slash && slash > name ? strndup(name, (size_t)(slash - name))
                                       : NULL;
  vg_status st;

  if (folder && !has_mode(folder, S_IFDIR))
    st = vg_fail(err, VG_ERR_INPUT, "%s: the folder %s does not exist", name,
                 folder);
  else if (vg_format_suffix_length(name) || vg_text_ends(name, ".d3m"))
    st = vg_fail(err, VG_ERR_INPUT, "%s: this file does not exist", name);
  else
    st = vg_fail(
      err, VG_ERR_INPUT,
      "%s: there is no such file, and no project found: there is "
      "neither %s.d3m nor %s.front nor a surface such as "
      "%s.lb8.ugrid or %s.stl, nor a plane section %s.dat; give the stem of "
      "a project or the complete name of a surface file",
      name, name, name, name, name, name);
  free(folder);
  return st;
}

static vg_status find_stem(const char *given, struct vg_input_files *f,
                           struct vg_error *err)
{
  const size_t suffix = vg_text_ends(given, ".d3m") && exists(given) ? 4 : 0;
  const char *name;
  vg_status st;

  name = f->stem = strndup(given, strlen(given) - suffix);
  if (!name) return vg_fail_memory(err, "the paths of the project");
  f->d3m = adjacent(name, "d3m");
  f->front = adjacent(name, "front");
  if (!f->d3m || !f->front)
    return vg_fail_memory(err, "the paths of the project");
  if (*f->front) {
    f->surface = strdup("");
    return f->surface ? VG_OK : vg_fail_memory(err, "a path");
  }
  st = find_surface(name, &f->surface, err);
  if (st < 0 || *f->surface || *f->d3m) return st;
  if (has_mode(name, S_IFREG)) return vg_format_unknown(name, err);
  if (has_mode(name, S_IFDIR))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: this is a folder; give the stem of a project in it, "
                   "or the complete name of a surface file",
                   name);
  return refuse_absent(name, err);
}

vg_status vg_input_find(const char *name, const char *deck,
                        struct vg_input_files *out, struct vg_error *err)
{
  struct vg_input_files f = { 0 };
  vg_status st = VG_OK;

  if (!*name)
    return vg_fail(err, VG_ERR_INPUT, "the name of the project is empty");
  f.stem = stem_of(name);
  if (f.stem) {
    f.surface = strdup(name);
    if (!f.surface) st = vg_fail_memory(err, "a path");
  } else {
    st = find_stem(name, &f, err);
  }
  if (st >= 0) st = find_companions(&f, deck, err);
  if (st < 0) {
    release_files(&f);
    return st;
  }
  f.is_section = vg_section_is(f.surface);
  *out = f;
  return VG_OK;
}

vg_status vg_problem_open_deck(struct vg_problem *p, struct vg_error *err)
{
  const struct vg_input_files *f = &p->read.files;
  struct vg_settings *s = &p->asked;
  const char *base = strrchr(f->stem, '/');

  vg_settings_default(s);
  p->read.is_section = vg_section_is(f->surface);
  snprintf(s->title, sizeof s->title, "%s", base ? base + 1 : f->stem);
  vg_text_trim_end(s->title);
  if (!*f->deck) return VG_OK;
  return vg_deck_read(f->deck, s, err);
}

vg_status vg_problem_open(struct vg_problem *p, const char *name,
                          const char *deck, struct vg_error *err)
{
  vg_status st = vg_input_find(name, deck, &p->read.files, err);

  return st < 0 ? st : vg_problem_open_deck(p, err);
}

static void note_match(struct vg_read *r, const struct vg_mapbc_match *match)
{
  if (match->n_unused)
    vg_note(r->notes,
            "%s lists %zu patches that the surface does not "
            "have (the first is %d)",
            r->files.mapbc, match->n_unused, (int)match->first_unused);
  if (match->n_renamed) vg_note_renamed(r->notes, match);
}

static enum vg_flow_side side_of(const char *format)
{
  if (!strncmp(format, "cogsg", 5)) return VG_SIDE_DEFINED;
  return strstr(format, "ugrid") || !strncmp(format, "surf", 4) ? VG_SIDE_USUAL
                                                                : VG_SIDE_FREE;
}

void vg_note_own_mapbc(struct vg_notes *notes, const char *stem, size_t n)
{
  vg_note(notes,
          "%.*s.mapbc was written by an earlier run of Vanguard and was not "
          "read; --mapbc %.*s.mapbc uses it",
          (int)n, stem, (int)n, stem);
}

void vg_note_renamed(struct vg_notes *notes, const struct vg_mapbc_match *match)
{
  vg_note(notes,
          "%zu patches have other names in the .mapbc, which was matched by "
          "number, as it has none of the mesh's names; the first patch is %d",
          match->n_renamed, (int)match->first_renamed);
}

/* The .mapbc of an earlier run is not an input and may be overwritten. */
static void leave_own_mapbc(struct vg_read *r)
{
  vg_note_own_mapbc(r->notes, r->files.stem, strlen(r->files.stem));
  *r->files.mapbc = 0;
}

/* A file named by the settings replaces that of the project. */
static vg_status name_mapbc(struct vg_read *r, struct vg_error *err)
{
  char *name;

  if (!*r->settings.mapbc) return VG_OK;
  name = strdup(r->settings.mapbc);
  if (!name) return vg_fail_memory(err, "a path");
  free(r->files.mapbc);
  r->files.mapbc = name;
  return VG_OK;
}

/* Boundary conditions come from the .mapbc that the settings name, or that has
 * the stem of the file. */
static vg_status read_surface_file(struct vg_read *r, struct vg_display *show,
                                   struct vg_error *err)
{
  const int is_remeshed = vg_read_is_remeshed(r, &r->surface);
  struct vg_cad_options cad = vg_options_cad(&r->settings, is_remeshed);
  struct vg_cad_zones zones = { 0, NULL };
  struct vg_read_info info = {
    .cad = &cad,
    .zones = &zones,
    .model = is_remeshed && !vg_read_keeps_triangles(r) ? &r->model : NULL,
    .mapbc = r->settings.mapbc
  };
  const char *path = r->files.surface;
  size_t n_zone;
  vg_status st = name_mapbc(r, err);

  if (st >= 0 && r->is_section) return vg_read_section(r, show, err);
  cad.note = vg_read_note_cad;
  cad.stop = (struct vg_stop){ vg_display_stop, show };
  cad.user = r->notes;
  if (st < 0) return st;
  st = vg_surface_read(path, &r->surface, &info, err);
  n_zone = zones.n;
  st = vg_zone_rows_take(&r->settings, &zones, st, err);
  /* The message of the library has less detail. */
  if (st == VG_ERR_STOPPED) return vg_display_stopped(show, err);
  if (st < 0) return st;
  r->has_cells = info.n_cell > 0 || info.has_volumes;
  if (info.unit) r->unit = info.unit;
  r->side = side_of(info.format);
  if (info.n_cell)
    vg_note(r->notes,
            "%s is a volume mesh: its boundary%s is used as the surface, and "
            "its %zu cells are ignored",
            path, n_zone ? " with the faces between its zones" : "",
            info.n_cell);
  if (info.turned.face)
    vg_note(r->notes,
            "%s: %zu boundary faces pointed out of their cells; their "
            "orientation was reversed",
            path, info.turned.face);
  if (info.inner.n_sheet_face)
    vg_note(r->notes, VG_SHEET_FACES_NOTE, path, info.inner.n_sheet_face);
  if (info.inner.n_face)
    vg_note(r->notes, VG_INNER_FACES_NOTE, path, info.inner.n_face,
            info.inner.patches);
  if (info.turned.loose_face)
    vg_note(r->notes, "%s: %zu boundary faces belong to no cell", path,
            info.turned.loose_face);
  if (info.has_own_mapbc) leave_own_mapbc(r);
  note_match(r, &info.match);
  return VG_OK;
}

/* Sizes must cover the patches, wherever the sources are. */
static vg_status mesh_patches(struct vg_read *r, struct vg_display *show,
                              struct vg_error *err)
{
  struct vg_sizing_options options = vg_options_sizing(&r->settings, r->map);
  const struct vg_mesh corners = { .n_point = r->project.n_point,
                                   .point = r->project.point };
  const struct vg_stop stop = { vg_display_stop, show };
  struct vg_sizing *sizing = NULL;
  vg_status st;

  if (!r->project.n_shape)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: it has no patches, and there is no surface next to "
                   "it; add a .front or a surface file",
                   r->files.d3m);
  VG_TRY(vg_sizing_new(&options, r->settings.n_source, r->settings.source,
                       &corners, &sizing, err));
  VG_TRY(vg_project_surface(&r->project, sizing, &stop, &r->surface, err));
done:
  vg_sizing_free(sizing);
  /* The message of the library has less detail. */
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

/* Applies VGRID's factor to all sources. */
static void use_ifact(struct vg_settings *s, double ifact)
{
  for (size_t i = 0; i < s->n_source; i++) {
    s->source[i].h0 *= ifact;
    s->source[i].h1 *= ifact;
    s->source[i].sp0 *= ifact;
    s->source[i].sp1 *= ifact;
  }
}

/* Sources of the project come first, followed by those of the deck. The last
 * bits of the sum in VGRID's source law depend on the order. */
static vg_status merge_sources(struct vg_read *r, struct vg_error *err)
{
  struct vg_settings *s = &r->settings;
  size_t n = r->project.n_source, total = n + s->n_source;
  struct vg_source *all;

  if (!s->d3m_sources || !*r->files.d3m) return VG_OK;
  s->d3m_sources = 0;
  if (!n) use_ifact(s, r->project.ifact);
  if (!n) return VG_OK;
  all = vg_alloc(total, sizeof *all);
  if (!all) return vg_fail_memory(err, "the sources");
  memcpy(all, r->project.source, n * sizeof *all);
  for (size_t i = 0; i < n && !r->project.stretch; i++) all[i].stretch = 0;
  if (s->n_source) memcpy(all + n, s->source, s->n_source * sizeof *all);
  free(s->source);
  s->source = all;
  s->n_source = s->cap_source = total;
  use_ifact(s, r->project.ifact);
  return VG_OK;
}

/* A code from 3000 to 7999, or a negative code, is one of FUN3D. */
static void set_condition(struct vg_patch *p, int32_t code, int axis)
{
  int32_t before = p->bc;

  if (code == VG_BC_NONE) return;
  if (code < 0 || (code >= 3000 && code < 8000)) {
    p->bc_fun3d = code;
    p->bc = vg_bc_to_usm3d(code);
  } else {
    p->bc = code;
    p->bc_fun3d = vg_bc_to_fun3d(code, axis);
  }
  if (p->bc != before) p->family = p->bc;
}

/* The table takes precedence over the .mapbc. */
vg_status vg_patch_table_apply(size_t n, const struct vg_patch_row *row,
                               int may_lack, struct vg_mesh *surface,
                               struct vg_error *err)
{
  int *axis = vg_alloc(surface->n_patch, sizeof *axis);
  vg_status st = axis ? vg_patch_axes(surface, axis, err)
                      : vg_fail_memory(err, "the patches");

  for (size_t i = 0; i < n && st >= 0; i++) {
    size_t at = vg_mesh_find_patch(surface, row[i].id);
    struct vg_patch *to = at == SIZE_MAX ? NULL : &surface->patch[at];

    if (!to && may_lack) continue;
    if (!to) {
      st = vg_patch_ref_mark("patches", row[i].id, "", surface,
                             surface->n_patch, NULL, err);
      break;
    }
    if (*row[i].name) snprintf(to->name, sizeof to->name, "%s", row[i].name);
    set_condition(to, row[i].bc, axis[at]);
  }
  free(axis);
  return st;
}

/* Replaces names by numbers first. */
static vg_status apply_patch_table(struct vg_read *r, struct vg_error *err)
{
  vg_status st = vg_patch_rows_resolve(&r->settings, &r->surface, err);

  return st < 0
         ? st
         : vg_patch_table_apply(r->settings.n_patch, r->settings.patch,
                                r->settings.close_holes, &r->surface, err);
}

/* A .mapbc that is an output is not an input, unless it is named. */
static vg_status leave_output(struct vg_read *r, struct vg_error *err)
{
  int is = 0;
  vg_status st = *r->settings.mapbc
                 ? VG_OK
                 : vg_mapbc_is_output(r->files.mapbc, &is, err);

  if (is) leave_own_mapbc(r);
  return st;
}

static vg_status apply_conditions(struct vg_read *r, struct vg_error *err)
{
  struct vg_mapbc bc = VG_MAPBC_INIT;
  struct vg_mapbc_match match;
  vg_status st;

  VG_TRY(name_mapbc(r, err));
  VG_TRY(leave_output(r, err));
  if (!*r->files.mapbc) return VG_OK;
  st = vg_mapbc_read(r->files.mapbc, &bc, err);
  if (st >= 0) st = vg_mapbc_apply(&bc, &r->surface, &match, err);
  if (st >= 0) note_match(r, &match);
done:
  vg_mapbc_release(&bc);
  return st;
}

int vg_read_is_by_first(const struct vg_read *r, struct vg_comm *comm)
{
  return vg_comm_size(comm) > 1 && vg_read_is_cad(r);
}

/* st: status of this rank so far. Collective. */
static vg_status read_for_all(struct vg_read *r, struct vg_comm *comm,
                              struct vg_display *show, vg_status st,
                              struct vg_error *err)
{
  VG_TRY(vg_comm_agree(comm, st, err));
  if (!vg_comm_rank(comm)) {
    st = read_surface_file(r, show, err);
  } else {
    st = name_mapbc(r, err);
    if (st >= 0) st = leave_output(r, err);
  }
  VG_TRY(vg_surface_bcast(comm, 1, st, &r->surface, err));
  st = vg_zone_rows_bcast(comm, &r->settings, err);
done:
  return st;
}

static vg_status read_surface(struct vg_read *r, struct vg_display *show,
                              struct vg_error *err)
{
  const struct vg_input_files *f = &r->files;
  const struct vg_project *project = *f->d3m ? &r->project : NULL;
  vg_status st;

  if (!*f->front && *f->surface) return read_surface_file(r, show, err);
  r->side = VG_SIDE_DEFINED;
  st = *f->front ? vg_front_read(f->front, project, &r->surface, err)
                 : mesh_patches(r, show, err);
  return st < 0 ? st : apply_conditions(r, err);
}

/* Takes layer settings from the .d3m where none are given. VGRID's vfact scales
 * the spacing of its viscous part, that is the local edge length at which
 * layers end. */
static void merge_layers(struct vg_read *r)
{
  struct vg_layer_settings *l = &r->settings.layer;
  const struct vg_project *d = &r->project;

  if (!l->from_files || !d->grid || l->grow == VG_ANSWER_NO) return;
  vg_note(r->notes,
          "layer settings taken from the .d3m (grid = %d): first height %g, "
          "rates %g and %g, at most %d layers, vfact %g",
          (int)d->grid, d->layer.delta1, d->layer.rate1, d->layer.rate2,
          (int)d->layer.n_max, d->vfact);
  if (l->first == 0 && l->y_plus == 0) {
    l->first = d->layer.delta1 > 0 ? d->layer.delta1 : 0;
    if (d->grid == 2) l->by_source = 1;
  }
  if (isnan(l->ratio)) {
    if (isnan(l->rate1)) l->rate1 = d->layer.rate1;
    if (isnan(l->rate2)) l->rate2 = d->layer.rate2;
  }
  if (l->most == 0 && d->layer.n_max > 0)
    l->most = d->layer.n_max < VG_LEVELS_MAX ? d->layer.n_max : VG_LEVELS_MAX;
  if (isnan(l->cap)) l->cap = 0;
  if (d->vfact > 0) l->end = d->vfact * vg_options_layers(&r->settings).end;
}

/* Row of patch id in the layers table; added if it is missing. */
static struct vg_layer_row *layer_row(struct vg_settings *s, int32_t id)
{
  struct vg_layer_row row;

  for (size_t i = 0; i < s->n_layer; i++)
    if (s->layer_row[i].id == id && !*s->layer_row[i].id_name)
      return &s->layer_row[i];
  vg_settings_row_default(VG_TABLE_LAYERS, &row);
  row.id = id;
  if (vg_settings_add(s, VG_TABLE_LAYERS, &row, NULL) < 0) return NULL;
  return &s->layer_row[s->n_layer - 1];
}

/* Layer settings of an AFLR file for one patch, where none are given. */
static vg_status merge_aflr_patch(struct vg_read *r,
                                  const struct vg_aflr_patch *a, int32_t id,
                                  struct vg_error *err)
{
  const double spacing = vg_units_of_file(r, a->spacing);
  const double thickness = vg_units_of_file(r, a->thickness);
  struct vg_settings *s = &r->settings;
  const struct vg_layer_settings *l = &s->layer;
  struct vg_layer_row *row;

  if (!a->is_viscous || !(a->spacing > 0 || a->thickness > 0 || a->n_layer > 0))
    return VG_OK;
  row = layer_row(s, id);
  if (!row) return vg_fail_memory(err, "the layers table");
  if (a->spacing > 0 && l->first == 0 && l->y_plus == 0 && isnan(row->first) &&
      isnan(row->y_plus))
    row->first = spacing;
  if (a->thickness > 0 && l->total == 0 && isnan(row->total))
    row->total = thickness;
  if (a->n_layer > 0 && a->n_layer <= VG_LEVELS_MAX && l->count == 0 &&
      row->count == VG_COUNT_NONE)
    row->count = a->n_layer;
  return VG_OK;
}

/* AFLR's .tags identifies patches by number, its .bc by name. */
static vg_status apply_aflr(struct vg_read *r, const char *path, int by_name,
                            struct vg_error *err)
{
  struct vg_aflr a = VG_AFLR_INIT;
  const struct vg_mesh *m = &r->surface;
  size_t n_unused = 0;
  vg_status st;

  if (!*path) return VG_OK;
  VG_TRY(by_name ? vg_aflr_bc_read(path, &a, err)
                 : vg_aflr_tags_read(path, &a, err));
  VG_TRY(vg_aflr_apply(&a, &r->surface, &n_unused, err));
  if (n_unused)
    vg_note(r->notes, "%s lists %zu patches that the surface does not have",
            path, n_unused);
  /* A row given by name takes precedence over one of the file. */
  VG_TRY(vg_patch_rows_resolve(&r->settings, &r->surface, err));
  for (size_t i = 0; i < a.n && r->settings.layer.from_files; i++)
    for (size_t j = 0; j < m->n_patch; j++)
      if (by_name ? strcmp(m->patch[j].name, a.patch[i].name) == 0
                  : m->patch[j].id == a.patch[i].id)
        VG_TRY(merge_aflr_patch(r, &a.patch[i], m->patch[j].id, err));
done:
  vg_aflr_release(&a);
  return st;
}

/* Starts with the requested settings, to which files may add. */
static vg_status begin(const struct vg_settings *asked, struct vg_read *r,
                       struct vg_error *err)
{
  vg_status st = vg_settings_copy(&r->settings, asked, err);

  if (st >= 0) vg_resolve_write(asked, r->settings.write);
  return st;
}

vg_status vg_problem_given(struct vg_problem *p, const char *name,
                           struct vg_mesh *surface, struct vg_error *err)
{
  struct vg_read *r = &p->read;
  struct vg_input_files *f = &r->files;
  char **path[] = { &f->d3m,  &f->front, &f->surface, &f->mapbc,
                    &f->deck, &f->tags,  &f->aflr };
  vg_status st;
  int bad = 0;

  r->notes = &p->notes;
  vg_helper_set_folder(p->asked.helpers);
  vg_mesh_move(&r->surface, surface);
  r->side = VG_SIDE_DEFINED; /* As the interface defines it. */
  VG_TRY(begin(&p->asked, r, err));
  f->stem = strdup(name);
  for (size_t i = 0; i < sizeof path / sizeof *path; i++)
    bad |= !(*path[i] = strdup(""));
  if (bad || !f->stem) return vg_fail_memory(err, "the names of a surface");
  VG_TRY(vg_units_begin(r, err));
  VG_TRY(vg_units_end(r, NULL, err));
  VG_TRY(vg_read_sizes(r, err));
  VG_TRY(vg_read_shear(r, err));
  VG_TRY(vg_read_add_wake_patches(r, err));
  VG_TRY(apply_conditions(r, err));
  VG_TRY(apply_patch_table(r, err));
  vg_note_symmetry(r->notes, &r->surface);
  VG_TRY(vg_read_place_cones(r, err));
  st = vg_read_place_wakes(r, err);
done:
  return st;
}

/* Reads the project, its sources, the file of sizes and that of the wall
 * shear. */
static vg_status read_asides(const struct vg_settings *asked, struct vg_read *r,
                             struct vg_error *err)
{
  vg_status st;

  VG_TRY(begin(asked, r, err));
  VG_TRY(vg_units_begin(r, err));
  if (*r->files.d3m) {
    VG_TRY(vg_d3m_read(r->files.d3m, &r->project, err));
    merge_layers(r);
  }
  VG_TRY(merge_sources(r, err));
  VG_TRY(vg_read_sizes(r, err));
  st = vg_read_shear(r, err);
done:
  return st;
}

/* Takes conditions, names and layers of the patches from files and settings. */
static vg_status read_patches(struct vg_read *r, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_read_add_wake_patches(r, err));
  VG_TRY(apply_aflr(r, r->files.tags, 0, err));
  VG_TRY(apply_aflr(r, r->files.aflr, 1, err));
  VG_TRY(vg_read_surf_settings(r, err));
  /* All layer settings are in the settings now, except heights by point. */
  if (!r->heights.n) r->settings.layer.from_files = 0;
  VG_TRY(apply_patch_table(r, err));
  vg_note_symmetry(r->notes, &r->surface);
  VG_TRY(vg_read_place_cones(r, err));
  st = vg_read_place_wakes(r, err);
done:
  return st;
}

vg_status vg_problem_read(struct vg_problem *p, struct vg_comm *comm,
                          struct vg_display *show, struct vg_error *err)
{
  struct vg_read *r = &p->read;
  vg_status st;

  r->notes = &p->notes;
  vg_section_complete(r, &p->asked);
  vg_helper_set_folder(p->asked.helpers);
  st = read_asides(&p->asked, r, err);
  if (vg_read_is_by_first(r, comm)) st = read_for_all(r, comm, show, st, err);
  else if (st >= 0) st = read_surface(r, show, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_units_end(r, comm, err);
  if (st >= 0) st = read_patches(r, err);
  if (st >= 0 && show) st = vg_display_stopped(show, err);
  return vg_comm_agree(comm, st, err);
}
