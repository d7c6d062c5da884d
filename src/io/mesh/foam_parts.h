/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/foam_parts.h: declarations shared by foam.c (the five files of a
 * mesh), foam_case.c (folders) and, for faces, fluent.c. Private. */
#ifndef VG_IO_MESH_FOAM_PARTS_H
#define VG_IO_MESH_FOAM_PARTS_H

#include "base/status.h"
#include "core/mesh/cell_links.h"

/* --- faces (foam.c) --- */

/** vg_cell_links_build for the whole mesh. VG_ERR_UNSUPPORTED if 32-bit labels
 * cannot count the vertices of all faces. */
vg_status vg_foam_links(struct vg_cell_links *f, const struct vg_mesh *m,
                        const char *name, struct vg_error *err);

/** Half-faces of `cell` whose other cell has a higher number, sorted by that
 * number (upper-triangular order). Returns their number, at most 6. */
int vg_foam_upper(const struct vg_cell_links *f, uint32_t cell,
                  uint32_t code[6], uint32_t neighbour[6]);

/* --- folders (foam_case.c) --- */

/** "a/b"; NULL if there is not enough memory. */
char *vg_foam_path(const char *a, const char *b);

/** Create a folder unless it exists. */
vg_status vg_foam_folder(const char *path, struct vg_error *err);

/** Files of a polyMesh. */
enum { VG_FOAM_FILES = 5 };
extern const char *const vg_foam_file[VG_FOAM_FILES];

#define VG_FOAM_ZONES "faceZones"
#define VG_FOAM_CELL_ZONES "cellZones"

/** Write the header of an OpenFOAM file; note may be NULL. */
struct vg_output;
void vg_foam_header(struct vg_output *out, const char *class_name,
                    const char *location, const char *object, int is_ascii,
                    const char *note);

/** Write the files of system/ and NAME.foam that are absent. */
vg_status vg_foam_surroundings(const char *case_dir, struct vg_error *err);

#endif
