/* io/mesh/foam_parts.h: what foam.c (the five files of a mesh), foam_faces.c,
 * foam_case.c (folders) and, of the faces, fluent.c share. Private.
 *
 * A half-face is one face of one cell, coded as 8 * cell + face; cells are
 * numbered tetrahedra, pyramids, prisms, hexahedra in their order. */
#ifndef VG_IO_MESH_FOAM_PARTS_H
#define VG_IO_MESH_FOAM_PARTS_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_foam_faces {
  const struct vg_mesh *m;      /* borrowed */
  uint32_t n_cell, end_tet, end_pyr, end_pri; /* numbers behind each kind */
  uint32_t *link;               /* [half-faces] code of the mate, or
                                   VG_FOAM_BOUNDARY */
  uint32_t *boundary;           /* [n_tri + n_quad] half-face on each */
  uint64_t n_internal;          /* faces between two cells */
  uint64_t n_corner;            /* nodes of all faces */
};
#define VG_FOAM_FACES_INIT { .m = NULL }
#define VG_FOAM_BOUNDARY UINT32_MAX

void vg_foam_faces_release(struct vg_foam_faces *f);

/** Find the mate of every half-face. `name` is for messages. VG_ERR_INPUT
 * names a face of a cell, or of the boundary, that has no mate;
 * VG_ERR_UNSUPPORTED when labels of 32 bits do not suffice. O(n), one pass
 * in the order of the cells. */
vg_status vg_foam_faces_build(struct vg_foam_faces *f, const struct vg_mesh *m,
                              const char *name, struct vg_error *err);

/** Nodes of a half-face, normal out of its cell; returns 3 or 4. */
int vg_foam_face_nodes(const struct vg_foam_faces *f, uint32_t code,
                       uint32_t node[4]);

/** Half-faces of `cell` whose mates are in higher cells, by rising mate:
 * upper-triangular order. Returns how many, at most 6. */
int vg_foam_upper(const struct vg_foam_faces *f, uint32_t cell,
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
