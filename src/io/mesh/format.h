/* io/mesh/format.h: the table of formats. Names decide, upper or lower case, a
 * ".gz" at the end aside: .stl .tri .triq .obj .mesh .meshb .msh .cgns .ugrid
 * (and .b8.ugrid, ... , io/mesh/ugrid.h) .cogsg .front .surf and CAD (.step
 * .stp .iges .igs .brep, io/cad/cad.h) are read; .fluent.msh, .su2, .vtu and
 * .openfoam (a folder, io/mesh/foam.h) are written only, .front, .triq, .surf
 * and CAD are read only. */
#ifndef VG_IO_MESH_FORMAT_H
#define VG_IO_MESH_FORMAT_H

#include <stddef.h>

#include "core/mesh/mesh.h"
#include "io/cad/cad.h"
#include "io/stream/convention.h"
#include "io/vgrid/mapbc.h"

/** What reading found out, for a report. */
struct vg_read_info {
  const struct vg_cad_options *cad; /* in: for CAD; NULL: its defaults */
  struct vg_cad_model *model;  /* in: where the model of a CAD file is kept,
                                  empty; NULL: it is not */
  const char *mapbc;           /* in: file with conditions; NULL or "":
                                  STEM.mapbc, but next to a surface not one
                                  that Vanguard wrote */
  const char *format;          /* suffix of the table; static */
  struct vg_turned turned;     /* zero for formats without cells */
  size_t n_cell;               /* cells in the file */
  int has_mapbc;               /* a .mapbc was used */
  int has_own_mapbc;           /* STEM.mapbc was not used, since Vanguard
                                  wrote it */
  enum vg_mapbc_layout layout; /* its layout */
  struct vg_mapbc_match match; /* patches it lacks, entries not used */
};

/** i-th suffix, without leading dot, that a surface of a project may have
 * ("stl", "lb8.ugrid", "stl.gz", ...); NULL behind the last. */
const char *vg_format_input_suffix(size_t i);

/** Length of the known suffix at the end of a name, with its dot and with
 * ".gz": "wing.lb8.ugrid.gz" 13, "wing" 0. The rest is the stem. */
size_t vg_format_suffix_length(const char *name);

/** 1 when a mesh can be written under this suffix (no leading dot). */
int vg_format_can_write(const char *suffix);

/** 1 when the suffix of path is that of a CAD file. */
int vg_format_is_cad(const char *path);

/** 1 for a format whose triangles stand for a shape and were not made to be
 * meshed: STL, OBJ, Cart3D. */
int vg_format_is_tessellation(const char *path);

/** 1 when the file at `path` holds volume cells, by its header where the
 * format has one; 0 also when it cannot be read. */
int vg_format_holds_cells(const char *path);

/** "stl, tri, ...": all suffixes for a message. Static string. */
const char *vg_format_list(void);

/** VG_ERR_FORMAT: the suffix of path is none that is read, with what is; of CAD
 * geometry with what to do. */
vg_status vg_format_unknown(const char *path, struct vg_error *err);

/** Read a file by its suffix: boundary and cells. A .cogsg needs its .bc
 * beside it; a .front uses the .d3m beside it, if any, for its patches.
 * *out is untouched on failure; an unknown suffix is VG_ERR_FORMAT and the
 * message lists the known ones. */
vg_status vg_format_read(const char *path, struct vg_mesh *out,
                         struct vg_error *err);

/** As vg_format_read; conditions and names from info->mapbc, or STEM.mapbc
 * where that exists. info: what is asked of CAD and of conditions goes in, the
 * rest comes out; may be NULL. */
vg_status vg_mesh_read(const char *path, struct vg_mesh *out,
                       struct vg_read_info *info, struct vg_error *err);

/** As vg_mesh_read, but cells and the points that only they use are dropped:
 * the boundary of a volume mesh is a surface. */
vg_status vg_surface_read(const char *path, struct vg_mesh *out,
                          struct vg_read_info *info, struct vg_error *err);

/** The number of tetrahedra in layers, the first ones of a file, where it tells
 * that: a .cogsg does, a binary .ugrid with a tail too. *is_known says whether.
 */
vg_status vg_format_layer_tets(const char *path, int *is_known, size_t *n,
                               struct vg_error *err);

/** Write by the suffix of `path`. A .cogsg brings its .bc and .mapbc. */
vg_status vg_format_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err);

/** Write STEM.suffix, e.g. suffix "b8.ugrid". */
vg_status vg_mesh_write(const char *stem, const char *suffix,
                        const struct vg_mesh *m, struct vg_error *err);

#endif
