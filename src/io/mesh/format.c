/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The table of formats; see io/mesh/format.h. */
#define _GNU_SOURCE
#include "io/mesh/format.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/memory.h"
#include "core/mesh/zone_surface.h"
#include "core/mesh/zones.h"
#include "io/cad/cad.h"
#include "io/cgns/cgns.h"
#include "io/mesh/aflr.h"
#include "io/mesh/fluent.h"
#include "io/mesh/foam.h"
#include "io/mesh/gmsh.h"
#include "io/mesh/medit.h"
#include "io/mesh/obj.h"
#include "io/mesh/stl.h"
#include "io/mesh/su2.h"
#include "io/mesh/tri.h"
#include "io/mesh/ugrid.h"
#include "io/mesh/vtu.h"
#include "io/stream/sheet_file.h"
#include "io/vgrid/vgrid.h"

typedef vg_status (*reader)(const char *path, struct vg_mesh *out,
                            struct vg_read_info *info, struct vg_error *err);
typedef vg_status (*writer)(const char *path, const struct vg_mesh *m,
                            struct vg_error *err);

#define PLAIN_READER(name)                                                     \
  static vg_status read_##name(const char *path, struct vg_mesh *out,          \
                               struct vg_read_info *info,                      \
                               struct vg_error *err)                           \
  {                                                                            \
    (void)info;                                                                \
    return vg_##name##_read(path, out, err);                                   \
  }
PLAIN_READER(stl)
PLAIN_READER(tri)
PLAIN_READER(obj)
PLAIN_READER(medit)
PLAIN_READER(cgns)

static vg_status read_gmsh(const char *path, struct vg_mesh *out,
                           struct vg_read_info *info, struct vg_error *err)
{
  vg_status st = vg_gmsh_read_volumes(path, out, info->zones, err);

  info->has_volumes = info->zones && info->zones->n;
  return st;
}

static vg_status read_surf(const char *path, struct vg_mesh *out,
                           struct vg_read_info *info, struct vg_error *err)
{
  (void)info;
  return vg_aflr_surf_read(path, out, NULL, err);
}

static vg_status read_cogsg(const char *path, struct vg_mesh *out,
                            struct vg_read_info *info, struct vg_error *err)
{
  return vg_cogsg_read(path, out, NULL, &info->turned, err);
}

static vg_status read_ugrid(const char *path, struct vg_mesh *out,
                            struct vg_read_info *info, struct vg_error *err)
{
  return vg_ugrid_read(path, out, &info->turned, err);
}

static char *adjacent(const char *path, const char *suffix)
{
  size_t n = strlen(path) - vg_format_suffix_length(path);
  char *to;

  return asprintf(&to, "%.*s%s", (int)n, path, suffix) < 0 ? NULL : to;
}

/* STEM.suffix or STEM.suffix.gz, whichever exists; "" if neither does; NULL if
 * there is not enough memory. The caller frees it. */
static char *companion(const char *path, const char *suffix, const char *packed)
{
  char *name = adjacent(path, suffix);

  if (!name || !access(name, F_OK)) return name;
  free(name);
  name = adjacent(path, packed);
  if (name && access(name, F_OK)) *name = 0;
  return name;
}

static vg_status read_front(const char *path, struct vg_mesh *out,
                            struct vg_read_info *info, struct vg_error *err)
{
  struct vg_project project = VG_PROJECT_INIT;
  char *d3m = companion(path, ".d3m", ".d3m.gz");
  vg_status st = VG_OK;

  (void)info;
  if (!d3m) return vg_fail_memory(err, "a file name");
  if (*d3m) VG_TRY(vg_d3m_read(d3m, &project, err));
  VG_TRY(vg_front_read(path, &project, out, err));
done:
  vg_project_release(&project);
  free(d3m);
  return st;
}

static vg_status write_cogsg(const char *path, const struct vg_mesh *m,
                             struct vg_error *err)
{
  return vg_cogsg_write(path, m, NULL, 0, NULL, err);
}

static vg_status write_vtu(const char *path, const struct vg_mesh *m,
                           struct vg_error *err)
{
  struct vg_vtu_field zone = { VG_VTU_ZONE, VG_VTU_CELL, VG_VTU_INT32, 1,
                               NULL };
  int32_t *id = NULL;
  vg_status st;

  VG_TRY(vg_mesh_zone_numbers(m, &id, err));
  zone.data = id;
  st = vg_vtu_write(path, m, &zone, id != NULL, err);
done:
  free(id);
  return st;
}

static vg_status write_foam(const char *path, const struct vg_mesh *m,
                            struct vg_error *err)
{
  return vg_foam_write(path, m, NULL, err);
}

/* The formats: a row each, in the table of those that are read and written,
 * only written, or only read.
 *
 * ROW(SUFFIX, READ, WRITE, KIND, USES)
 *   KIND  of CAD files, which io/cad reads with its own options
 *   USES  INPUT: a project's surface may have the suffix; TESSELLATION: its
 *         triangles approximate a shape and are not meant for meshing; SHEETS:
 *         it holds faces between cells, and zones; ZONES: it holds
 *         zones and their interfaces alone; ORDER: its patches have names, and
 *         numbers only by their order */
#define READ_AND_WRITTEN(ROW)                                                  \
  ROW("stl", read_stl, vg_stl_write, NONE, INPUT | TESSELLATION | ORDER)       \
  ROW("tri", read_tri, vg_tri_write, NONE, INPUT | TESSELLATION)               \
  ROW("obj", read_obj, vg_obj_write, NONE, INPUT | TESSELLATION | ORDER)       \
  ROW("mesh", read_medit, vg_medit_write, NONE, INPUT | SHEETS)                \
  ROW("meshb", read_medit, vg_medit_write, NONE, INPUT | SHEETS)               \
  ROW("msh", read_gmsh, vg_gmsh_write, NONE, INPUT | SHEETS)                   \
  ROW("cgns", read_cgns, vg_cgns_write, NONE, INPUT | SHEETS | ORDER)          \
  UGRID(ROW, "b8.ugrid")                                                       \
  UGRID(ROW, "lb8.ugrid")                                                      \
  UGRID(ROW, "b4.ugrid")                                                       \
  UGRID(ROW, "lb4.ugrid")                                                      \
  UGRID(ROW, "r8.ugrid")                                                       \
  UGRID(ROW, "lr8.ugrid")                                                      \
  UGRID(ROW, "r4.ugrid")                                                       \
  UGRID(ROW, "lr4.ugrid")                                                      \
  UGRID(ROW, "b8l.ugrid")                                                      \
  UGRID(ROW, "lb8l.ugrid")                                                     \
  UGRID(ROW, "b8.ugrid64")                                                     \
  UGRID(ROW, "lb8.ugrid64")                                                    \
  UGRID(ROW, "ugrid")                                                          \
  ROW("cogsg", read_cogsg, write_cogsg, NONE, 0)
#define WRITTEN(ROW)                                                           \
  ROW(VG_FLUENT_SUFFIX, NULL, vg_fluent_write, NONE, SHEETS)                   \
  ROW(VG_FOAM_SUFFIX, NULL, write_foam, NONE, SHEETS)                          \
  ROW("su2", NULL, vg_su2_write, NONE, 0)                                      \
  ROW(VG_SU2_ZONES, NULL, vg_su2_write_zones, NONE, ZONES)                     \
  ROW("vtu", NULL, write_vtu, NONE, 0)
#define READ_ONLY(ROW)                                                         \
  ROW("triq", read_tri, NULL, NONE, INPUT | TESSELLATION)                      \
  ROW("front", read_front, NULL, NONE, 0)                                      \
  ROW("surf", read_surf, NULL, NONE, INPUT)                                    \
  ROW("step", NULL, NULL, STEP, INPUT)                                         \
  ROW("stp", NULL, NULL, STEP, INPUT)                                          \
  ROW("iges", NULL, NULL, IGES, INPUT)                                         \
  ROW("igs", NULL, NULL, IGES, INPUT)                                          \
  ROW("brep", NULL, NULL, BREP, INPUT)                                         \
  ROW("egads", NULL, NULL, BREP, INPUT)
#define UGRID(ROW, suffix) ROW(suffix, read_ugrid, vg_ugrid_write, NONE, INPUT)
#define ALL(ROW) READ_AND_WRITTEN(ROW) WRITTEN(ROW) READ_ONLY(ROW)

enum { INPUT = 1, TESSELLATION = 2, SHEETS = 4, ORDER = 8, ZONES = 16 };

static const struct format {
  const char *suffix;
  reader read;
  writer write;
  enum vg_cad_kind cad;
  int uses;
} formats[] = {
#define ROW(suffix, read, write, kind, uses)                                   \
  { suffix, read, write, VG_CAD_##kind, uses },
  ALL(ROW)
#undef ROW
};
#define N_FORMAT (sizeof formats / sizeof formats[0])

const char *vg_format_input_suffix(size_t i)
{
  static const char *const packed[N_FORMAT] = {
#define ROW(suffix, ...) suffix ".gz",
    ALL(ROW)
#undef ROW
  };

  for (size_t k = 0; k < 2 * N_FORMAT; k++)
    if (formats[k % N_FORMAT].uses & INPUT && !i--)
      return k < N_FORMAT ? formats[k].suffix : packed[k - N_FORMAT];
  return NULL;
}

const char *vg_format_list(void)
{
#define ROW(suffix, ...) "." suffix " "
  return READ_AND_WRITTEN(ROW) "(read and written), " READ_ONLY(
    ROW) "(read only), " WRITTEN(ROW) "(written only); files that are read may "
                                      "be compressed (.gz)";
#undef ROW
}

/* Does name[0..n) end in ".suffix"? */
static int ends_in(const char *name, size_t n, const char *suffix)
{
  size_t len = strlen(suffix);

  return n > len && name[n - len - 1] == '.' &&
         !strncasecmp(name + n - len, suffix, len);
}

/* The format with the longest suffix in which the name ends: x.fluent.msh is
 * not a .msh. */
static const struct format *find(const char *name, size_t n)
{
  const struct format *found = NULL;

  for (size_t i = 0; i < N_FORMAT; i++)
    if (ends_in(name, n, formats[i].suffix) &&
        (!found || strlen(formats[i].suffix) > strlen(found->suffix)))
      found = formats + i;
  return found;
}

static size_t without_gz(const char *name)
{
  size_t n = strlen(name);

  return ends_in(name, n, "gz") ? n - 3 : n;
}

size_t vg_format_suffix_length(const char *name)
{
  size_t n = without_gz(name);
  const struct format *f = find(name, n);

  return f ? strlen(name) - n + strlen(f->suffix) + 1 : 0;
}

const char *vg_format_output_suffix(size_t i)
{
  for (size_t k = 0; k < N_FORMAT; k++)
    if (formats[k].write && !i--) return formats[k].suffix;
  return NULL;
}

int vg_format_is_cad(const char *path)
{
  const struct format *f = find(path, without_gz(path));

  return f && f->cad != VG_CAD_NONE;
}

int vg_format_is_tessellation(const char *path)
{
  const struct format *f = find(path, without_gz(path));

  return f && f->uses & TESSELLATION;
}

int vg_format_holds_sheets(const char *suffix)
{
  for (size_t i = 0; i < N_FORMAT; i++)
    if (!strcmp(formats[i].suffix, suffix)) return formats[i].uses & SHEETS;
  return 0;
}

int vg_format_holds_zones(const char *suffix)
{
  for (size_t i = 0; i < N_FORMAT; i++)
    if (!strcmp(formats[i].suffix, suffix))
      return formats[i].uses & (SHEETS | ZONES);
  return 0;
}

vg_status vg_format_sheet_file(const char *path, char **out,
                               struct vg_error *err)
{
  const struct format *f = find(path, without_gz(path));

  if (!f || f->read != read_ugrid) *out = strdup("");
  else *out = companion(path, "." VG_SHEET_SUFFIX, "." VG_SHEET_SUFFIX ".gz");
  return *out ? VG_OK : vg_fail_memory(err, "a file name");
}

int vg_format_holds_cells(const char *path)
{
  const struct format *f = find(path, without_gz(path));
  struct vg_read_info info = { 0 };
  struct vg_mesh m = VG_MESH_INIT;
  uint64_t count[7];
  int has = 0;

  if (!f || !f->read) return 0;
  if (f->read == read_ugrid) {
    if (vg_ugrid_peek(path, count, NULL) == VG_OK)
      has = count[3] || count[4] || count[5] || count[6];
  } else if (f->read == read_medit || f->read == read_gmsh ||
             f->read == read_cgns) {
    if (f->read(path, &m, &info, NULL) == VG_OK) has = vg_mesh_n_cell(&m) > 0;
    vg_mesh_release(&m);
  } else {
    has = f->read == read_cogsg;
  }
  return has;
}

vg_status vg_format_unknown(const char *path, struct vg_error *err)
{
  static const char *const native[] = { "x_t",    "x_b", "catpart",
                                        "sldprt", "prt", "jt" };
  const struct format *f = find(path, without_gz(path));

  for (size_t i = 0; i < sizeof native / sizeof *native; i++)
    if (ends_in(path, without_gz(path), native[i]))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: this is the native format of a CAD system; export "
                     "the geometry as STEP or IGES; readable formats are %s",
                     path, vg_format_list());
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s; known formats are %s", path,
                 f ? "this format can only be written" : "unknown suffix",
                 vg_format_list());
}

static vg_status read_by_name(const char *path, struct vg_mesh *out,
                              struct vg_read_info *info, struct vg_error *err)
{
  const struct format *f = find(path, without_gz(path));
  enum vg_cad_kind kind = f ? f->cad : VG_CAD_NONE;
  vg_status st;

  if (!f || (!f->read && !kind)) return vg_format_unknown(path, err);
  st = kind ? vg_cad_read(path, kind, info->cad, info->model, out, &info->unit,
                          info->zones, err)
            : f->read(path, out, info, err);
  if (st < 0) return st;
  info->format = f->suffix;
  info->n_cell = vg_mesh_n_cell(out);
  return VG_OK;
}

vg_status vg_format_read(const char *path, struct vg_mesh *out,
                         struct vg_error *err)
{
  struct vg_read_info info = { 0 };

  return read_by_name(path, out, &info, err);
}

vg_status vg_format_use_mapbc(const char *path, struct vg_mesh *m,
                              struct vg_read_info *info, struct vg_error *err)
{
  const int is_named = info->mapbc && *info->mapbc;
  char *name = is_named ? strdup(info->mapbc)
                        : companion(path, ".mapbc", ".mapbc.gz");
  const struct format *f = find(path, without_gz(path));
  struct vg_mapbc b = VG_MAPBC_INIT;
  vg_status st = VG_OK;
  int is_own = 0;

  if (!name) return vg_fail_memory(err, "a file name");
  if (!*name) goto done;
  if (!is_named && !info->n_cell)
    VG_TRY(vg_mapbc_is_output(name, &is_own, err));
  if (is_own) {
    info->has_own_mapbc = 1;
    goto done;
  }
  VG_TRY(vg_mapbc_read(name, &b, err));
  if (f && f->uses & ORDER)
    VG_TRY(
      vg_mapbc_apply_names(name, &b, VG_CGNS_WORD_MOST, m, &info->match, err));
  else VG_TRY(vg_mapbc_apply(&b, m, &info->match, err));
  info->has_mapbc = 1;
  info->layout = b.layout;
done:
  vg_mapbc_release(&b);
  free(name);
  return st;
}

/* The members that the caller sets. */
static struct vg_read_info asked_of(const struct vg_read_info *info)
{
  struct vg_read_info asked = { 0 };

  if (!info) return asked;
  asked.cad = info->cad;
  asked.model = info->model;
  asked.zones = info->zones;
  asked.mapbc = info->mapbc;
  return asked;
}

/* Adds the sheets of STEM.sheets to the faces of a mesh with cells. */
static vg_status read_sheets(const char *path, struct vg_mesh *m,
                             struct vg_error *err)
{
  char *name;
  vg_status st = vg_format_sheet_file(path, &name, err);

  if (st < 0) return st;
  if (*name) st = vg_sheet_file_read(name, m, err);
  free(name);
  return st;
}

/* All triangles of STEM.sheets must have become sheets. */
static vg_status check_sheets(const char *path, const struct vg_mesh *m,
                              struct vg_error *err)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    const struct vg_patch *p = &m->patch[m->tri_patch[t]];
    const uint32_t *v = m->tri[t];

    if (p->is_sheet)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: the triangle with points %u, %u, %u of sheet %d%s%s "
                     "in its ." VG_SHEET_SUFFIX " file is not a face between "
                     "two cells; remove the file if it belongs to another mesh",
                     path, v[0] + 1, v[1] + 1, v[2] + 1, (int)p->id,
                     *p->name ? " " : "", p->name);
  }
  return VG_OK;
}

/* Sheets need no entry in the .mapbc. */
static void forgive_sheets(const struct vg_mesh *m,
                           struct vg_mapbc_match *match)
{
  for (size_t i = 0; i < m->n_sheet && match->n_missing; i++)
    match->n_missing -= m->sheet[i].bc == VG_BC_NONE &&
                        m->sheet[i].bc_fun3d == VG_BC_NONE &&
                        vg_mesh_find_patch(m, m->sheet[i].id) == SIZE_MAX;
  for (size_t i = m->n_sheet ? m->n_patch : 0; i--;)
    if (m->patch[i].bc == VG_BC_NONE && m->patch[i].bc_fun3d == VG_BC_NONE)
      match->first_missing = m->patch[i].id;
}

vg_status vg_mesh_read(const char *path, struct vg_mesh *out,
                       struct vg_read_info *info, struct vg_error *err)
{
  struct vg_read_info found = asked_of(info);
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  VG_TRY(read_by_name(path, &m, &found, err));
  VG_TRY(vg_format_use_mapbc(path, &m, &found, err));
  if (found.n_cell) VG_TRY(read_sheets(path, &m, err));
  VG_TRY(vg_mesh_take_inner(&m, &found.inner, err));
  VG_TRY(check_sheets(path, &m, err));
  VG_TRY(vg_mesh_mark_interfaces(&m, err));
  forgive_sheets(&m, &found.match);
  if (found.turned.loose_face >= found.inner.n_copy)
    found.turned.loose_face -= found.inner.n_copy;
  vg_mesh_move(out, &m);
  if (info) *info = found;
done:
  vg_mesh_release(&m);
  return st;
}

/* The zones of a volume mesh: its boundary gets their interfaces. */
static vg_status take_zones(const char *path, struct vg_mesh *m,
                            struct vg_cad_zones *out, struct vg_error *err)
{
  struct vg_cad_zone *of = vg_calloc(m->n_zone, sizeof *of);
  vg_status st = of ? VG_OK : vg_fail_memory(err, "the zones");

  VG_TRY(st);
  VG_TRY(vg_mesh_add_interfaces(m, path, err));
  for (size_t z = 0; z < m->n_zone; z++) {
    if (!vg_mesh_zone_cells(m, z)) continue;
    vg_mesh_zone_seed(m, z, of[out->n].seed);
    of[out->n].kind = m->zone[z].kind;
    vg_zone_name(&m->zone[z], of[out->n].name);
    out->n++;
  }
  out->of = of;
  of = NULL;
done:
  free(of);
  return st;
}

vg_status vg_surface_read(const char *path, struct vg_mesh *out,
                          struct vg_read_info *info, struct vg_error *err)
{
  struct vg_read_info found = asked_of(info);
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  VG_TRY(vg_mesh_read(path, &m, &found, err));
  if (m.n_zone > 1 && found.zones && !found.zones->of)
    VG_TRY(take_zones(path, &m, found.zones, err));
  if (found.n_cell) vg_mesh_keep_boundary(&m);
  vg_mesh_move(out, &m);
  if (info) *info = found;
done:
  vg_mesh_release(&m);
  return st;
}

vg_status vg_format_layer_tets(const char *path, int *is_known, size_t *n,
                               struct vg_error *err)
{
  const struct format *f = find(path, without_gz(path));

  assert(is_known && n);
  *is_known = 0;
  if (f && f->read == read_ugrid)
    return vg_ugrid_layer_tets(path, is_known, n, err);
  if (f && f->read == read_cogsg)
    return vg_cogsg_layer_tets(path, is_known, n, err);
  return VG_OK;
}

vg_status vg_format_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err)
{
  const struct format *f = find(path, strlen(path));

  if (f && f->write) return f->write(path, m, err);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s; known formats are %s", path,
                 f ? "this format can only be read" : "unknown suffix",
                 vg_format_list());
}

vg_status vg_mesh_write(const char *stem, const char *suffix,
                        const struct vg_mesh *m, struct vg_error *err)
{
  size_t n = strlen(stem), len = strlen(suffix);
  char *path = vg_alloc(n + len + 2, 1);
  vg_status st;

  if (!path) return vg_fail_memory(err, "a file name");
  memcpy(path, stem, n);
  path[n] = '.';
  memcpy(path + n + 1, suffix, len + 1);
  st = vg_format_write(path, m, err);
  free(path);
  return st;
}
