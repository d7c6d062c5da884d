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
#include "io/vgrid/vgrid.h"

typedef vg_status (*reader)(const char *path, struct vg_mesh *out,
                            struct vg_turned *turned, struct vg_error *err);
typedef vg_status (*writer)(const char *path, const struct vg_mesh *m,
                            struct vg_error *err);

#define PLAIN_READER(name)                                                     \
  static vg_status read_##name(const char *path, struct vg_mesh *out,          \
                               struct vg_turned *turned, struct vg_error *err) \
  {                                                                            \
    (void)turned;                                                              \
    return vg_##name##_read(path, out, err);                                   \
  }
PLAIN_READER(stl)
PLAIN_READER(tri)
PLAIN_READER(obj)
PLAIN_READER(medit)
PLAIN_READER(gmsh)
PLAIN_READER(cgns)

static vg_status read_surf(const char *path, struct vg_mesh *out,
                           struct vg_turned *turned, struct vg_error *err)
{
  (void)turned;
  return vg_aflr_surf_read(path, out, NULL, err);
}

static vg_status read_cogsg(const char *path, struct vg_mesh *out,
                            struct vg_turned *turned, struct vg_error *err)
{
  return vg_cogsg_read(path, out, NULL, turned, err);
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
                            struct vg_turned *turned, struct vg_error *err)
{
  struct vg_project project = VG_PROJECT_INIT;
  char *d3m = companion(path, ".d3m", ".d3m.gz");
  vg_status st = VG_OK;

  (void)turned;
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
  return vg_vtu_write(path, m, NULL, 0, err);
}

static vg_status write_foam(const char *path, const struct vg_mesh *m,
                            struct vg_error *err)
{
  return vg_foam_write(path, m, NULL, err);
}

#define UGRID(name)                                                            \
  {                                                                            \
    name, vg_ugrid_read, vg_ugrid_write                                        \
  }

static const struct format {
  const char *suffix;
  reader read;
  writer write;
} formats[] = {
  { "stl", read_stl, vg_stl_write },
  { "tri", read_tri, vg_tri_write },
  { "triq", read_tri, NULL },
  { "obj", read_obj, vg_obj_write },
  { "mesh", read_medit, vg_medit_write },
  { "meshb", read_medit, vg_medit_write },
  { VG_FLUENT_SUFFIX, NULL, vg_fluent_write },
  { "msh", read_gmsh, vg_gmsh_write },
  { "cgns", read_cgns, vg_cgns_write },
  UGRID("b8.ugrid"),
  UGRID("lb8.ugrid"),
  UGRID("b4.ugrid"),
  UGRID("lb4.ugrid"),
  UGRID("r8.ugrid"),
  UGRID("lr8.ugrid"),
  UGRID("r4.ugrid"),
  UGRID("lr4.ugrid"),
  UGRID("b8l.ugrid"),
  UGRID("lb8l.ugrid"),
  UGRID("b8.ugrid64"),
  UGRID("lb8.ugrid64"),
  UGRID("ugrid"),
  { "cogsg", read_cogsg, write_cogsg },
  { "front", read_front, NULL },
  { "surf", read_surf, NULL },
  { VG_FOAM_SUFFIX, NULL, write_foam },
  { "su2", NULL, vg_su2_write },
  { "vtu", NULL, write_vtu },
  { "step", NULL, NULL },
  { "stp", NULL, NULL },
  { "iges", NULL, NULL },
  { "igs", NULL, NULL },
  { "brep", NULL, NULL },
  { "egads", NULL, NULL },
};
#define N_FORMAT (sizeof formats / sizeof formats[0])

/* The formats of the table that io/cad reads, which has its own options. */
static const struct {
  const char *suffix;
  enum vg_cad_kind kind;
} cad[] = {
  { "step", VG_CAD_STEP }, { "stp", VG_CAD_STEP },  { "iges", VG_CAD_IGES },
  { "igs", VG_CAD_IGES },  { "brep", VG_CAD_BREP }, { "egads", VG_CAD_BREP },
};

static enum vg_cad_kind cad_kind(const struct format *f)
{
  for (size_t i = 0; f && i < sizeof cad / sizeof *cad; i++)
    if (!strcmp(f->suffix, cad[i].suffix)) return cad[i].kind;
  return VG_CAD_NONE;
}

/* Every suffix of a surface, uncompressed and compressed. */
static const char *const input_suffix[] = { "stl",           "tri",
                                            "triq",          "obj",
                                            "mesh",          "meshb",
                                            "b8.ugrid",      "lb8.ugrid",
                                            "b4.ugrid",      "lb4.ugrid",
                                            "r8.ugrid",      "lr8.ugrid",
                                            "r4.ugrid",      "lr4.ugrid",
                                            "b8l.ugrid",     "lb8l.ugrid",
                                            "b8.ugrid64",    "lb8.ugrid64",
                                            "ugrid",         "surf",
                                            "msh",           "cgns",
                                            "step",          "stp",
                                            "iges",          "igs",
                                            "brep",          "egads",
                                            "stl.gz",        "tri.gz",
                                            "triq.gz",       "obj.gz",
                                            "mesh.gz",       "meshb.gz",
                                            "b8.ugrid.gz",   "lb8.ugrid.gz",
                                            "b4.ugrid.gz",   "lb4.ugrid.gz",
                                            "r8.ugrid.gz",   "lr8.ugrid.gz",
                                            "r4.ugrid.gz",   "lr4.ugrid.gz",
                                            "b8l.ugrid.gz",  "lb8l.ugrid.gz",
                                            "b8.ugrid64.gz", "lb8.ugrid64.gz",
                                            "ugrid.gz",      "surf.gz",
                                            "msh.gz",        "cgns.gz",
                                            "step.gz",       "stp.gz",
                                            "iges.gz",       "igs.gz",
                                            "brep.gz",       "egads.gz" };

const char *vg_format_input_suffix(size_t i)
{
  return i < sizeof input_suffix / sizeof input_suffix[0] ? input_suffix[i]
                                                          : NULL;
}

const char *vg_format_list(void)
{
  return ".stl .tri .triq .obj .mesh .meshb .msh .cgns .ugrid, .X.ugrid "
         "with X of b8 lb8 b4 lb4 r8 lr8 r4 lr4 b8l lb8l, .b8.ugrid64 "
         ".lb8.ugrid64, .cogsg, .front .surf .step .stp .iges .igs .brep "
         "(read only), .fluent.msh .su2 .vtu .openfoam (write only); files "
         "that are read may be compressed (.gz)";
}

/* Does name[0..n) end in ".suffix"? */
static int ends_in(const char *name, size_t n, const char *suffix)
{
  size_t len = strlen(suffix);

  return n > len && name[n - len - 1] == '.' &&
         !strncasecmp(name + n - len, suffix, len);
}

/* In the table, longer suffixes precede those that they end in. */
static const struct format *find(const char *name, size_t n)
{
  for (size_t i = 0; i < N_FORMAT; i++)
    if (ends_in(name, n, formats[i].suffix)) return formats + i;
  return NULL;
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

  return cad_kind(f) != VG_CAD_NONE;
}

int vg_format_is_tessellation(const char *path)
{
  static const char *const name[] = { "stl", "tri", "triq", "obj" };
  const struct format *f = find(path, without_gz(path));

  for (size_t i = 0; f && i < sizeof name / sizeof *name; i++)
    if (!strcmp(f->suffix, name[i])) return 1;
  return 0;
}

int vg_format_holds_cells(const char *path)
{
  const struct format *f = find(path, without_gz(path));
  struct vg_mesh m = VG_MESH_INIT;
  uint64_t count[7];
  int has = 0;

  if (!f || !f->read) return 0;
  if (f->read == vg_ugrid_read) {
    if (vg_ugrid_peek(path, count, NULL) == VG_OK)
      has = count[3] || count[4] || count[5] || count[6];
  } else if (f->read == read_medit || f->read == read_gmsh ||
             f->read == read_cgns) {
    if (f->read(path, &m, NULL, NULL) == VG_OK)
      has = m.n_tet || m.n_pyr || m.n_pri || m.n_hex;
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
  enum vg_cad_kind kind = cad_kind(f);
  vg_status st;

  if (!f || (!f->read && !kind)) return vg_format_unknown(path, err);
  st = kind ? vg_cad_read(path, kind, info->cad, info->model, out, err)
            : f->read(path, out, &info->turned, err);
  if (st < 0) return st;
  info->format = f->suffix;
  info->n_cell = out->n_tet + out->n_pyr + out->n_pri + out->n_hex;
  return VG_OK;
}

vg_status vg_format_read(const char *path, struct vg_mesh *out,
                         struct vg_error *err)
{
  struct vg_read_info info = { 0 };

  return read_by_name(path, out, &info, err);
}

static vg_status use_mapbc(const char *path, struct vg_mesh *m,
                           struct vg_read_info *info, struct vg_error *err)
{
  const int is_named = info->mapbc && *info->mapbc;
  char *name = is_named ? strdup(info->mapbc)
                        : companion(path, ".mapbc", ".mapbc.gz");
  struct vg_mapbc b = VG_MAPBC_INIT;
  vg_status st = VG_OK;

  if (!name) return vg_fail_memory(err, "a file name");
  if (!*name) goto done;
  if (!is_named && !info->n_cell && vg_mapbc_is_output(name)) {
    info->has_own_mapbc = 1;
    goto done;
  }
  VG_TRY(vg_mapbc_read(name, &b, err));
  VG_TRY(vg_mapbc_apply(&b, m, &info->match, err));
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
  asked.mapbc = info->mapbc;
  return asked;
}

vg_status vg_mesh_read(const char *path, struct vg_mesh *out,
                       struct vg_read_info *info, struct vg_error *err)
{
  struct vg_read_info found = asked_of(info);
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  VG_TRY(read_by_name(path, &m, &found, err));
  VG_TRY(use_mapbc(path, &m, &found, err));
  VG_TRY(vg_mesh_drop_inner(&m, &found.inner, err));
  if (found.turned.loose_face >= found.inner.n_copy)
    found.turned.loose_face -= found.inner.n_copy;
  vg_mesh_move(out, &m);
  if (info) *info = found;
done:
  vg_mesh_release(&m);
  return st;
}

vg_status vg_surface_read(const char *path, struct vg_mesh *out,
                          struct vg_read_info *info, struct vg_error *err)
{
  struct vg_read_info found = asked_of(info);
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  VG_TRY(vg_mesh_read(path, &m, &found, err));
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
  if (f && f->read == vg_ugrid_read)
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
