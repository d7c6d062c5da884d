/* io/mesh/foam_parts.h: what foam.c (the five files of a mesh), foam_case.c
 * (folders) and, of the faces, fluent.c share. Private. */
#ifndef VG_IO_MESH_FOAM_PARTS_H
#define VG_IO_MESH_FOAM_PARTS_H

#include "base/status.h"
#include "core/mesh/cell_links.h"

/* --- faces (foam.c) --- */

/** vg_cell_links_build of a whole mesh, whose corners of faces 32-bit labels
 * count. */
vg_status vg_foam_links(struct vg_cell_links *f, const struct vg_mesh *m,
                        const char *name, struct vg_error *err);

/** Half-faces of `cell` whose mates are in higher cells, by rising mate:
 * upper-triangular order. Returns how many, at most 6. */
int vg_foam_upper(const struct vg_cell_links *f, uint32_t cell,
                  uint32_t code[6], uint32_t neighbour[6]);

/* --- folders (foam_case.c) --- */

/** "a/b"; NULL when memory is refused. */
char *vg_foam_path(const char *a, const char *b);

/** Make a folder unless there is one. */
vg_status vg_foam_folder(const char *path, struct vg_error *err);

/** The files of a polyMesh, in the order in which they are put in place. */
enum { VG_FOAM_FILES = 5 };
extern const char *const vg_foam_file[VG_FOAM_FILES];

/** Put the mesh files of one folder into another, which may hold an earlier
 * mesh, and remove the first. */
vg_status vg_foam_place_mesh(const char *from, const char *to,
                             struct vg_error *err);

/** Remove the mesh files of a folder, and it when this leaves it empty. */
void vg_foam_remove_mesh(const char *folder);

/** The head of an OpenFOAM file; note may be NULL. */
struct vg_output;
void vg_foam_header(struct vg_output *out, const char *class_name,
                    const char *location, const char *object, int is_ascii,
                    const char *note);

/** system/ and NAME.foam where absent. */
vg_status vg_foam_surroundings(const char *case_dir, struct vg_error *err);

#endif
