/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/foam/foam_read.h: reader of OpenFOAM's cases: the mesh of
 * constant/polyMesh and the fields of a time. Uses core/mesh, io/stream.
 *
 * Text and binary files are read, also compressed ones (.gz), with labels and
 * scalars of 32 and 64 bits. Cells must be tetrahedra, pyramids, prisms or
 * hexahedra; OpenFOAM stores them as lists of faces:
 *
 *     owner ----> neighbour     a face points from the cell with the lower
 *       |   face    |           number to the other one, or out of the domain
 */
#ifndef VG_IO_FOAM_FOAM_READ_H
#define VG_IO_FOAM_FOAM_READ_H

#include "core/mesh/mesh.h"

struct vg_input;

/** A case, its mesh, and where its cells are in that mesh. */
struct vg_foam_case {
  char *folder; /* of the case */
  char *time;   /* path of the folder of the fields; "" for a case without
                     times */
  struct vg_mesh m;
  size_t n_cell;
  uint32_t *cell; /* [n_cell] number of the cell of m (tetrahedra,
                     pyramids, prisms, hexahedra) that is OpenFOAM's cell i */
};
#define VG_FOAM_CASE_INIT                                                      \
  {                                                                            \
    .folder = NULL                                                             \
  }

/** Is the path the folder of a case, or of one of its times? */
int vg_foam_is_case(const char *path);

/** Read the mesh of a case.
 *
 * @param path  folder of the case, whose last time is chosen, or of a time
 * @param c     empty; release it in any case
 *
 * Points are those of the time, if the mesh moves. Patches are numbered in
 * their order, without conditions. Zones are not read.
 * VG_ERR_IO, VG_ERR_FORMAT: a file is missing or damaged. VG_ERR_UNSUPPORTED: a
 * cell of another kind, named with its number and a point. VG_ERR_MEMORY. */
vg_status vg_foam_case_read(const char *path, struct vg_foam_case *c,
                            struct vg_error *err);
void vg_foam_case_release(struct vg_foam_case *c);

/** Read the values of a field in the cells.
 *
 * @param name        file in the folder of the time
 * @param components  out: 1, 3, 6 or 9
 * @param value       out: [n_cell * components] in the order of the
 *                    cells of c->m; to be freed
 *
 * VG_ERR_INPUT: no such field, with the names of those that there are; values
 * at faces or points; a number of values other than that of the cells. */
vg_status vg_foam_field_read(const struct vg_foam_case *c, const char *name,
                             int *components, double **value,
                             struct vg_error *err);

/** The same for the file in `in`, in the order of the file. */
vg_status vg_foam_field_parse(struct vg_input *in, size_t n_cell,
                              int *components, double **value,
                              struct vg_error *err);

#endif
