/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard demo: complete example projects that need no external data. */
#define _GNU_SOURCE
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/examples/demo.h"
#include "cli/examples/demo_aerofoil.h"
#include "io/mesh/format.h"
#include "io/vgrid/mapbc.h"
#include "run/common/folder.h"
#include "run/common/ranges.h"
#include "run/common/text.h"
#include "run/settings/deck.h"
#include "run/stages/output.h"

struct arguments {
  const char *name, *dir;
  size_t n_cell;
  int list;
};

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;
  int64_t n;

  switch (key) {
  case 'o': a->dir = arg; return 0;
  case 'l': a->list = 1; return 0;
  case 'c':
    if (!vg_parse_count(arg, strlen(arg), &n) || n < 1)
      argp_error(state, "--cells takes a positive integer, not '%s'", arg);
    a->n_cell = (size_t)n;
    return 0;
  case ARGP_KEY_ARG:
    if (a->name) argp_error(state, "only one demo is accepted: %s", arg);
    a->name = arg;
    return 0;
  case ARGP_KEY_END:
    if (!a->name && !a->list)
      argp_error(state, "no demo given; --list shows the available ones");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

static void list(const struct vg_demo_case *c, size_t n)
{
  char count[32];

  for (size_t i = 0; i < n; i++)
    printf("%-16s %s (%s cells)\n", c[i].name, c[i].summary,
           vg_text_count(c[i].n_cell, count));
}

static int list_cases(void)
{
  const struct vg_demo_case *c;
  size_t n;

  c = vg_demo_cases(&n);
  list(c, n);
  c = vg_demo_sections(&n);
  list(c, n);
  return VG_EXIT_DONE;
}

/* Cases with viscous layers: Reynolds number based on the mean chord, on the
 * length of the body, or on the axial chord. */
static const struct rans {
  const char *name;
  double y_plus, reynolds, length;
} rans_cases[] = {
  { "wing", 1, 5e6, 0.7 },       { "wing-half", 1, 5e6, 0.7 },
  { "wing-sharp", 1, 5e6, 0.7 }, { "wing-sharp-half", 1, 5e6, 0.7 },
  { "boom", 1, 5e6, 1 },         { "boom-half", 1, 5e6, 1 },
  { "passage", 1, 2e4, 1 },
};

static const char layer_comment[] =
  "# Viscous layers grow on the patches with condition 4 in the .mapbc. Their\n"
  "# first height follows from y_plus, reynolds and reference_length (a chord\n"
  "# or the length of the body) below. 'vanguard mesh --layers no' generates\n"
  "# isotropic cells only; '--cells mixed' does not divide prisms into\n"
  "# tetrahedra.\n";

static const char walls_comment[] =
  "# Layers grow on the patches in walls: the casing, and the sides of the\n"
  "# pipe that face the fluids. 'vanguard mesh --layers no' generates\n"
  "# isotropic cells only; '--cells mixed' does not divide prisms into\n"
  "# tetrahedra.\n";

/* Returns 1 if the case has layers. */
static int set_layers(const char *name, struct vg_settings *s)
{
  for (size_t i = 0; i < sizeof rans_cases / sizeof *rans_cases; i++) {
    if (strcmp(rans_cases[i].name, name) != 0) continue;
    s->layer.y_plus = rans_cases[i].y_plus;
    s->layer.reynolds = rans_cases[i].reynolds;
    s->layer.length = rans_cases[i].length;
    return 1;
  }
  return 0;
}

/* A farfield along the Mach cone, and sources along the cones of the body,
 * whose place follows from the body and the farfield. Other sizes grow from the
 * surface of the body. */
static vg_status ask_for_boom(const struct vg_mach_extent *e,
                              const struct vg_source *cones,
                              struct vg_settings *s, struct vg_error *err)
{
  struct vg_source source;

  s->farfield.kind = VG_DOMAIN_MACH;
  s->farfield.mach = e->mach;
  s->farfield.upstream = e->upstream;
  s->farfield.downstream = e->downstream;
  s->farfield.radial = e->radial;
  vg_settings_row_default(VG_TABLE_SOURCES, &source);
  source.kind = VG_SOURCE_MACHCONE;
  source.h0 = cones->h0;
  source.h1 = cones->h1;
  source.stretch = cones->stretch;
  return vg_settings_add(s, VG_TABLE_SOURCES, &source, err);
}

/* The roles of the sheets, and their names, which a .ugrid does not hold; the
 * zones that they enclose. */
static vg_status ask_for_sheets(const struct vg_demo *d, struct vg_settings *s,
                                struct vg_error *err)
{
  struct vg_patch_row row;
  struct vg_zone_row zone;
  vg_status st = VG_OK;

  for (size_t i = 0; i < d->sheet.n_patch && st >= 0; i++) {
    const struct vg_patch *p = &d->sheet.patch[i];

    vg_settings_row_default(VG_TABLE_PATCHES, &row);
    row.id = p->id;
    row.role = p->is_interface ? VG_PATCH_INTERFACE
             : p->is_sheet     ? VG_PATCH_SHEET
                               : VG_PATCH_BAFFLE;
    snprintf(row.name, sizeof row.name, "%s", p->name);
    st = vg_settings_add(s, VG_TABLE_PATCHES, &row, err);
  }
  for (size_t i = 0; i < d->n_zone && st >= 0; i++) {
    vg_settings_row_default(VG_TABLE_ZONES, &zone);
    snprintf(zone.name, sizeof zone.name, "%s", d->zone[i].name);
    zone.kind = d->zone[i].kind;
    if (zone.kind == VG_ZONE_SOLID) zone.mesh = VG_ANSWER_YES;
    memcpy(zone.seed, d->seed[i], sizeof zone.seed);
    st = vg_settings_add(s, VG_TABLE_ZONES, &zone, err);
  }
  return st;
}

/* A pair of periodic patches, whose transform the run finds. */
static vg_status ask_for_pair(const char *const name[2], struct vg_settings *s,
                              struct vg_error *err)
{
  struct vg_periodic_row row;

  vg_settings_row_default(VG_TABLE_PERIODIC, &row);
  snprintf(row.patch_name, sizeof row.patch_name, "%s", name[0]);
  snprintf(row.image_name, sizeof row.image_name, "%s", name[1]);
  return vg_settings_add(s, VG_TABLE_PERIODIC, &row, err);
}

/* Adds the sheets to the surface. */
static vg_status add_sheets(const struct vg_mesh *sheet, struct vg_mesh *m,
                            struct vg_error *err)
{
  const size_t n_point = m->n_point + sheet->n_point;
  const size_t n_tri = m->n_tri + sheet->n_tri, n_patch = m->n_patch;
  size_t cap[3] = { m->n_point, m->n_tri, m->n_tri };

  for (size_t i = 0; i < sheet->n_patch; i++)
    if (vg_mesh_add_patch(m, sheet->patch[i].id, sheet->patch[i].name) ==
        SIZE_MAX)
      return vg_fail_memory(err, "the sheet");
  if (vg_reserve(&m->point, &cap[0], n_point, sizeof *m->point) ||
      vg_reserve(&m->tri, &cap[1], n_tri, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &cap[2], n_tri, sizeof *m->tri_patch))
    return vg_fail_memory(err, "the sheet");
  memcpy(m->point + m->n_point, sheet->point,
         sheet->n_point * sizeof *m->point);
  for (size_t t = 0; t < sheet->n_tri; t++, m->n_tri++) {
    for (int k = 0; k < 3; k++)
      m->tri[m->n_tri][k] = (uint32_t)m->n_point + sheet->tri[t][k];
    m->tri_patch[m->n_tri] = (uint32_t)n_patch + sheet->tri_patch[t];
  }
  m->n_point = n_point;
  return VG_OK;
}

/* The patches of the mesh, with conditions: those of the surface, and both
 * sides of baffles. */
static vg_status list_patches(const struct vg_demo *d, struct vg_mesh *all,
                              struct vg_error *err)
{
  int32_t id = (int32_t)(d->surface.n_patch + d->sheet.n_patch);
  vg_status st;

  VG_TRY(vg_mesh_copy(all, &d->surface, err));
  for (size_t i = 0; i < d->sheet.n_patch; i++) {
    const struct vg_patch *p = &d->sheet.patch[i];
    char name[VG_NAME_MAX];

    if (p->is_sheet) continue;
    snprintf(name, sizeof name, "%.40s_back", p->name);
    for (int side = 0; side < 2; side++) {
      const size_t at = vg_mesh_add_patch(all, side ? ++id : p->id,
                                          side ? name : p->name);

      if (at == SIZE_MAX) return vg_fail_memory(err, "the patches");
      all->patch[at].bc = all->patch[at].family = p->bc;
      all->patch[at].bc_fun3d = p->bc_fun3d;
    }
  }
done:
  return st;
}

/* The recommended settings of the case. */
static vg_status settings_of(const char *name, const struct vg_demo *demo,
                             struct vg_settings *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  vg_settings_default(s);
  snprintf(s->title, sizeof s->title, "Vanguard demo: %s", name);
  s->scale = demo->sizing.scale;
  s->growth = demo->sizing.growth;
  s->hmin = demo->sizing.h_min;
  s->hmax = demo->sizing.h_max;
  s->surface_sizes = demo->sizing.from_surface;
  s->farfield.kind = VG_DOMAIN_NONE;
  if (demo->walls) {
    snprintf(s->layer.walls, sizeof s->layer.walls, "%s", demo->walls);
    s->layer.first = s->hmax / 4;
    s->layer.count = 4;
  }
  if (demo->farfield.kind == VG_FARFIELD_MACH)
    return ask_for_boom(&demo->farfield.extent, &demo->source[0], s, err);
  for (size_t i = 0; i < demo->n_source && st >= 0; i++)
    st = vg_settings_add(s, VG_TABLE_SOURCES, &demo->source[i], err);
  if (st >= 0 && demo->periodic[0]) st = ask_for_pair(demo->periodic, s, err);
  return st < 0 ? st : ask_for_sheets(demo, s, err);
}

/* The path STEM.suffix, which must not exist yet. */
static vg_status new_path(const char *stem, const char *suffix, char **out,
                          struct vg_error *err)
{
  if (asprintf(out, "%s.%s", stem, suffix) < 0) {
    *out = NULL;
    return vg_fail_memory(err, "a path");
  }
  if (access(*out, F_OK)) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s exists and is not overwritten; remove "
                 "it or choose another folder with --out",
                 *out);
}

static const char *const suffixes[] = { "lb8.ugrid", "mapbc", "deck" };

/* The file STEM.suffixes[i] in the hidden folder. */
static vg_status write_file(struct vg_outputs *o, int i, const char *name,
                            const struct vg_mesh *surface,
                            const struct vg_mesh *all,
                            const struct vg_settings *s, const char *comment,
                            struct vg_error *err)
{
  char *path = vg_outputs_temp_path(o, suffixes[i]);
  vg_status st = path ? vg_outputs_add(o, suffixes[i], err)
                      : vg_fail_memory(err, "a path");

  if (st >= 0 && i == 0) st = vg_format_write(path, surface, err);
  if (st >= 0 && i == 1)
    st = vg_mapbc_write(path, all, VG_MAPBC_VGRID, name, NULL, err);
  if (st >= 0 && i == 2)
    st = vg_deck_write(path, s, comment, VG_DECK_CHANGED, err);
  free(path);
  return vg_outputs_failed(o, st, err);
}

/* All files, or none. */
static vg_status write_files(const char *stem, const char *name,
                             const struct vg_mesh *surface,
                             const struct vg_mesh *all,
                             const struct vg_settings *s, const char *comment,
                             struct vg_error *err)
{
  struct vg_outputs o = VG_OUTPUTS_INIT;
  struct vg_notes notes = { 0 };
  vg_status st;

  VG_TRY(vg_outputs_place(stem, NULL, &o, err));
  VG_TRY(vg_outputs_claim(&o, &notes, err));
  VG_TRY(vg_outputs_begin(&o, NULL, err));
  for (int i = 0; i < 3 && st >= 0; i++)
    st = write_file(&o, i, name, surface, all, s, comment, err);
  if (st >= 0) st = vg_outputs_commit(&o, err);
done:
  vg_notes_release(&notes);
  vg_outputs_release(&o);
  return st;
}

static vg_status write_project(char *const path[3], const char *stem,
                               const char *name, size_t wanted,
                               const struct vg_demo *demo, struct vg_error *err)
{
  char points[32], triangles[32], cells[32];
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_mesh surface = demo->surface; /* Borrowed. */
  struct vg_mesh with_sheet = VG_MESH_INIT, all = VG_MESH_INIT;
  int has_layers;
  vg_status st;

  /* The run adds farfield and symmetry plane to the body. The .mapbc contains
   * their patches, too: an input of the run, which is not overwritten. */
  if (demo->farfield.kind == VG_FARFIELD_MACH) {
    surface.n_tri = demo->n_body_tri;
    surface.n_point = demo->n_body_point;
    surface.n_patch = 1;
  }
  if (demo->sheet.n_tri) {
    VG_TRY(vg_mesh_copy(&with_sheet, &demo->surface, err));
    VG_TRY(add_sheets(&demo->sheet, &with_sheet, err));
    surface = with_sheet;
  }
  VG_TRY(settings_of(name, demo, &s, err));
  has_layers = set_layers(name, &s);
  VG_TRY(list_patches(demo, &all, err));
  VG_TRY(write_files(stem, name, &surface, &all, &s,
                     has_layers    ? layer_comment
                     : demo->walls ? walls_comment
                                   : NULL,
                     err));
  printf("%s: surface of %s points, %s triangles\n", path[0],
         vg_text_count(surface.n_point, points),
         vg_text_count(surface.n_tri, triangles));
  printf("%s: boundary conditions of %zu patches\n", path[1], all.n_patch);
  printf("%s: settings, for about %s cells%s\n", path[2],
         vg_text_count((unsigned long long)demo->n_cell, cells),
         has_layers || demo->walls ? " without the viscous layers" : "");
  if (wanted && demo->n_cell > 1.05 * (double)wanted)
    printf("  %s cells were requested, but the geometry needs more\n",
           vg_text_count(wanted, cells));
  printf("Next: vanguard mesh -p %s\n", stem);
done:
  vg_mesh_release(&with_sheet);
  vg_mesh_release(&all);
  vg_settings_release(&s);
  return st;
}

/* --- plane sections ------------------------------------------------------ */

static const char section_comment[] =
  "# A mesh in two dimensions: the section is in the .dat. Layers grow on it;\n"
  "# their first height follows from y_plus, reynolds and reference_length.\n"
  "# te_spacing, le_spacing and te_cells request edges of the section.\n";

/* All edges and layers follow the requested number of cells. */
static void set_section(const struct vg_demo_case *c, size_t n_cell,
                        struct vg_settings *s)
{
  vg_settings_default(s);
  snprintf(s->title, sizeof s->title, "Vanguard demo: %s", c->name);
  s->layer.y_plus = 1;
  s->layer.reynolds = 6e6;
  s->layer.length = 1;
  if (strstr(c->name, "blunt")) s->tail_cells = 8;
  if (n_cell) s->scale = sqrt((double)c->n_cell / (double)n_cell);
  if (n_cell) s->layer.scale_rule = VG_GROWTH_LAW_EVEN;
  snprintf(s->write, sizeof s->write, "su2,foam,b8.ugrid");
}

/* STEM.dat and STEM.deck, or neither. */
static vg_status write_section(const char *stem, const struct vg_demo_case *c,
                               const struct vg_settings *s,
                               struct vg_error *err)
{
  const int is_blunt = strstr(c->name, "blunt") != NULL;
  struct vg_outputs o = VG_OUTPUTS_INIT;
  struct vg_notes notes = { 0 };
  char *dat = NULL, *deck = NULL;
  vg_status st;

  VG_TRY(vg_outputs_place(stem, NULL, &o, err));
  VG_TRY(vg_outputs_claim(&o, &notes, err));
  VG_TRY(vg_outputs_begin(&o, NULL, err));
  dat = vg_outputs_temp_path(&o, "dat");
  deck = vg_outputs_temp_path(&o, "deck");
  if (!dat || !deck) {
    st = vg_fail_memory(err, "a path");
    goto done;
  }
  VG_TRY(vg_outputs_add(&o, "dat", err));
  VG_TRY(vg_outputs_add(&o, "deck", err));
  VG_TRY(vg_demo_aerofoil_write(dat, is_blunt, err));
  VG_TRY(vg_deck_write(deck, s, section_comment, VG_DECK_CHANGED, err));
  st = vg_outputs_commit(&o, err);
done:
  st = vg_outputs_failed(&o, st, err);
  free(dat);
  free(deck);
  vg_notes_release(&notes);
  vg_outputs_release(&o);
  return st;
}

static vg_status make_section(const struct arguments *a,
                              const struct vg_demo_case *c, const char *stem,
                              struct vg_error *err)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  char *path[2] = { NULL, NULL }, count[32];
  vg_status st;

  VG_TRY(new_path(stem, "dat", &path[0], err));
  VG_TRY(new_path(stem, "deck", &path[1], err));
  if (a->dir) VG_TRY(vg_make_folder(a->dir, err));
  set_section(c, a->n_cell, &s);
  VG_TRY(write_section(stem, c, &s, err));
  printf("%s: coordinates of the section\n", path[0]);
  printf("%s: settings, for about %s cells with the viscous layers\n", path[1],
         vg_text_count(a->n_cell ? a->n_cell : c->n_cell, count));
  printf("Next: vanguard mesh -p %s\n", stem);
done:
  free(path[0]);
  free(path[1]);
  vg_settings_release(&s);
  return st;
}

/* The case of this name; NULL: it is no plane section. */
static const struct vg_demo_case *section_of(const char *name)
{
  size_t n;
  const struct vg_demo_case *c = vg_demo_sections(&n);

  for (size_t i = 0; i < n; i++)
    if (!strcmp(c[i].name, name)) return &c[i];
  return NULL;
}

static vg_status make(const struct arguments *a, struct vg_error *err)
{
  const struct vg_demo_case *section = section_of(a->name);
  struct vg_demo demo = VG_DEMO_INIT;
  char *stem = NULL, *path[3] = { NULL };
  vg_status st = VG_OK;

  if (asprintf(&stem, "%s%s%s", a->dir ? a->dir : "", a->dir ? "/" : "",
               a->name) < 0) {
    stem = NULL;
    st = vg_fail_memory(err, "a path");
    goto done;
  }
  if (section) {
    st = make_section(a, section, stem, err);
    goto done;
  }
  VG_TRY(new_path(stem, suffixes[0], &path[0], err));
  VG_TRY(new_path(stem, suffixes[1], &path[1], err));
  VG_TRY(new_path(stem, suffixes[2], &path[2], err));
  VG_TRY(vg_demo_make(a->name, a->n_cell, &demo, err));
  if (a->dir) VG_TRY(vg_make_folder(a->dir, err));
  VG_TRY(write_project(path, stem, a->name, a->n_cell, &demo, err));
done:
  for (int i = 0; i < 3; i++) free(path[i]);
  free(stem);
  vg_demo_release(&demo);
  return st;
}

int vg_cmd_demo(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "cells", 'c', "N", 0,
      "Approximate number of cells, without layers [default "
      "depends on the case]",
      0 },
    { "out", 'o', "DIR", 0,
      "Folder for the project, created if it does not exist "
      "[default: current folder]",
      0 },
    { "list", 'l', NULL, 0, "List the cases", 0 },
    { 0 }
  };
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "NAME",
    .doc = "Write the example project NAME: NAME.lb8.ugrid (surface), "
           "NAME.mapbc (boundary conditions) and NAME.deck (settings), ready "
           "for vanguard mesh; of a case in two dimensions NAME.dat "
           "(coordinates of the section) and NAME.deck."
  };
  struct arguments a = { 0 };
  struct vg_error err = VG_ERROR_INIT;

  vg_cli_parse(&argp, argc, argv, &a);
  if (a.list) return list_cases();
  return make(&a, &err) < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
