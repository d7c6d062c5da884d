/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/solution.h: values of a flow solution at the points of a mesh. Uses
 * core/mesh/mesh.h. */
#ifndef VG_RUN_INPUT_SOLUTION_H
#define VG_RUN_INPUT_SOLUTION_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

#define VG_SOLUTION_FIELDS 16

struct vg_solution {
  struct vg_mesh m;
  size_t n_layer_tet; /* the first tetrahedra are layers, if the file of the
                         mesh records it */
  char *mesh;         /* file of the mesh, if it is not that of the values */
  size_t n_field;
  struct vg_solution_field {
    char *name;
    double *value; /* [n_point], finite */
  } field[VG_SOLUTION_FIELDS];
};
#define VG_SOLUTION_INIT                                                       \
  {                                                                            \
    .n_field = 0                                                               \
  }

/** Read fields of a solution and the mesh of their points.
 *
 * @param path    a .vtu with point or cell arrays; a .cgns with one zone and a
 *                solution at its points; the folder of an OpenFOAM case or of
 *                one of its times (values in the cells become values at the
 *                points, core/hessian/point_values.h); Medit's .sol or .solb
 *                with one scalar, next to the mesh of the same name; or a .csv
 *                with a line for each point, as SU2's restart files
 * @param names   fields, separated by commas; of a vector, NAME:1, NAME:2, ...
 *                is a component and NAME:mag the length. NULL or "": the only
 *                one
 * @param mesh    file of the mesh of a .csv; NULL otherwise
 * @param s       empty; release it in any case
 *
 * VG_ERR_INPUT, VG_ERR_FORMAT: no such field, with the names of those that
 * there are; another number of points than the mesh has, or points elsewhere; a
 * value that is not finite. */
vg_status vg_solution_read(const char *path, const char *names,
                           const char *mesh, struct vg_solution *s,
                           struct vg_error *err);
void vg_solution_release(struct vg_solution *s);

/** VG_ERR_INPUT: the .vtu `in` has no point array `name`. The message says
 * whether there is one at the cells, and lists those at the points. name "": no
 * array is named, which `option` does. */
vg_status vg_solution_no_array(const char *path, const char *name,
                               const char *option, struct vg_input *in,
                               struct vg_error *err);

#endif
