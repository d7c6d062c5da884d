/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/format.h: the table of formats. A format is recognised by its suffix,
 * in upper or lower case, optionally followed by ".gz". Read and written: .stl
 * .tri .obj .mesh .meshb .msh .cgns .ugrid (and .b8.ugrid, ...,
 * io/mesh/ugrid.h) .cogsg. Read only: .triq .front .surf and CAD (.step .stp
 * .iges .igs .brep, io/cad/cad.h). Written only: .fluent.msh, .su2, .zones.su2,
 * .vtu and .openfoam (a folder, io/mesh/foam.h). */
#ifndef VG_IO_MESH_FORMAT_H
#define VG_IO_MESH_FORMAT_H

#include <stddef.h>

#include "core/mesh/mesh.h"
#include "io/cad/cad.h"
#include "io/stream/convention.h"
#include "io/vgrid/mapbc.h"

/** Options and findings of reading a file. */
struct vg_read_info {
  const struct vg_cad_options *cad; /* in: options for CAD; NULL: defaults */
  struct vg_cad_model *model; /* in: empty; receives the model of a CAD file.
                                 NULL: the model is not kept */
  struct vg_cad_zones *zones; /* in: empty; receives the zones of a CAD file,
                                 see vg_cad_read, of a surface that Gmsh made
                                 (vg_gmsh_read_volumes), or of a volume mesh in
                                 vg_surface_read; may be NULL */
  /* in: file with boundary conditions; NULL or "": STEM.mapbc, unless the mesh
   * is a surface and Vanguard wrote that file */
  const char *mapbc;
  const char *format;          /* suffix in the table; static */
  struct vg_turned turned;     /* zero for formats without cells */
  struct vg_inner_faces inner; /* faces between cells */
  size_t n_cell;               /* number of cells in the file */
  int has_volumes;   /* the file names volumes that its surfaces bound */
  int has_mapbc;     /* a .mapbc was used */
  int has_own_mapbc; /* STEM.mapbc was ignored because Vanguard wrote it */
  int unit;          /* enum vg_cad_unit, of the result; FILE: not known */
  enum vg_mapbc_layout layout; /* layout of the .mapbc */
  struct vg_mapbc_match match; /* patches without an entry, entries without a
                                  patch */
};

/** i-th suffix, without the leading dot, that the surface of a project may have
 * ("stl", "lb8.ugrid", "stl.gz", ...); NULL past the last one. */
const char *vg_format_input_suffix(size_t i);

/** Length of the known suffix of a name, including its dot and ".gz": 13 for
 * "wing.lb8.ugrid.gz", 0 for "wing". The stem is the name without it. */
size_t vg_format_suffix_length(const char *name);

/** Suffix i, without its dot, of the formats that can be written; NULL past the
 * last one. */
const char *vg_format_output_suffix(size_t i);

/** Returns 1 if path has the suffix of a CAD file. */
int vg_format_is_cad(const char *path);

/** Returns 1 for formats whose triangles approximate a shape and are not meant
 * for meshing: STL, OBJ, Cart3D. */
int vg_format_is_tessellation(const char *path);

/** Returns 1 if the file contains volume cells, according to its header where
 * the format has one; 0 also if it cannot be read. */
int vg_format_holds_cells(const char *path);

/** Returns 1 if the format, given by its suffix, holds sheets
 * (core/mesh/sheets.h). */
int vg_format_holds_sheets(const char *suffix);

/** Does a format, by its suffix, hold zones? */
int vg_format_holds_zones(const char *suffix);

/** *out: the file with the sheets of a .ugrid, in the same folder
 * (io/stream/sheet_file.h); "" without such a file, and for other formats. To
 * be freed. VG_ERR_MEMORY. */
vg_status vg_format_sheet_file(const char *path, char **out,
                               struct vg_error *err);

/** All suffixes for a message, "stl, tri, ...". Static string. */
const char *vg_format_list(void);

/** Fail with VG_ERR_FORMAT because the suffix of path cannot be read. The
 * message lists the suffixes that can, or tells what to do with native CAD
 * files. */
vg_status vg_format_unknown(const char *path, struct vg_error *err);

/** Read boundary and cells of a file; its suffix selects the format. A .cogsg
 * needs its .bc in the same folder; a .front takes its patches from the .d3m in
 * the same folder, if there is one. *out is unchanged on failure. An unknown
 * suffix is VG_ERR_FORMAT, and the message lists the known ones. */
vg_status vg_format_read(const char *path, struct vg_mesh *out,
                         struct vg_error *err);

/** As vg_format_read, with conditions and names from info->mapbc, or from
 * STEM.mapbc if it exists, and with faces between two cells as sheets: those
 * that the boundary contains (vg_mesh_take_inner) and those of STEM.sheets.
 * info: the caller sets the members marked "in", the function sets the others;
 * may be NULL. */
vg_status vg_mesh_read(const char *path, struct vg_mesh *out,
                       struct vg_read_info *info, struct vg_error *err);

/** The part of vg_mesh_read for conditions and names: adds them to the boundary
 * m of the file and sets has_mapbc, has_own_mapbc, layout and match of *info.
 * Uses its members mapbc and n_cell. */
vg_status vg_format_use_mapbc(const char *path, struct vg_mesh *m,
                              struct vg_read_info *info, struct vg_error *err);

/** As vg_mesh_read, but without the cells and the points that only cells use:
 * the boundary of a volume mesh is a surface. */
vg_status vg_surface_read(const char *path, struct vg_mesh *out,
                          struct vg_read_info *info, struct vg_error *err);

/** Number of layer tetrahedra, which are the first ones of the file, for
 * formats that record it: a .cogsg, and a binary .ugrid with a tail. *is_known
 * is 0 if the file does not. */
vg_status vg_format_layer_tets(const char *path, int *is_known, size_t *n,
                               struct vg_error *err);

/** Write a mesh in the format given by the suffix of `path`. With a .cogsg its
 * .bc and .mapbc are written. */
vg_status vg_format_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err);

/** Write STEM.suffix, e.g. suffix "b8.ugrid". */
vg_status vg_mesh_write(const char *stem, const char *suffix,
                        const struct vg_mesh *m, struct vg_error *err);

#endif
