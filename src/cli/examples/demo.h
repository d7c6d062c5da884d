/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/examples/demo.h: the geometry of `vanguard demo`: complete flow domains
 * of any size that need no external data. Uses core/mesh/mesh.h,
 * core/sizing/sizing.h. */
#ifndef VG_CLI_EXAMPLES_DEMO_H
#define VG_CLI_EXAMPLES_DEMO_H

#include <stddef.h>

#include "core/domain/planar.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** Cells per cube of the target edge length in a finished mesh, which relates
 * the number of cells to the spacings. Measured: 8.9 to 9.2 on the box (20
 * thousand to a million cells), whose spacing is uniform. */
#define VG_DEMO_CELLS_PER_CUBE 9.0

/** Factor on VG_DEMO_CELLS_PER_CUBE for graded meshes: 10.3 to 10.8 cells per
 * cube on the sphere, 10.8 to 11.1 on the wings. */
#define VG_DEMO_GRADED 1.2

/** A case of the list. */
struct vg_demo_case {
  const char *name;    /* as on the command line */
  const char *summary; /* one line */
  size_t n_cell;       /* default size */
};

/** All cases. *n out: their number. Static storage. */
const struct vg_demo_case *vg_demo_cases(size_t *n);

enum { VG_DEMO_ZONES = 3 };

/** A case ready to be meshed. */
struct vg_demo {
  struct vg_mesh surface; /* closed, normals point into the fluid; patches
                             have names and conditions of both solvers */
  struct vg_mesh sheet;   /* triangles of inner surfaces, without points of the
                             surface: interfaces (is_interface), other sheets
                             (is_sheet), baffles; empty in most cases */
  size_t n_zone;
  struct vg_zone zone[VG_DEMO_ZONES]; /* [n_zone] names and kinds; solids have
                                         cells */
  double seed[VG_DEMO_ZONES][3];      /* a point in each */
  const char *walls;       /* list of the patches with layers, or NULL: those
                              with viscous conditions; static */
  const char *periodic[2]; /* names of a pair of periodic patches, or NULL;
                              static */
  size_t n_body_tri;       /* the first triangles of the surface, which are the
                              body; 0: no body */
  size_t n_body_point;     /* the first points, which are those of the body */
  struct vg_farfield farfield; /* of kind VG_FARFIELD_MACH: that of the surface,
                                  which the settings of the project ask for;
                                  else VG_FARFIELD_NONE */
  struct vg_sizing_options sizing; /* recommended, with from_surface */
  size_t n_source;
  struct vg_source *source;
  double n_cell; /* estimated number of cells, within 5 % */
};
#define VG_DEMO_INIT                                                           \
  {                                                                            \
    .farfield = {.kind = VG_FARFIELD_NONE }                                    \
  }

/** Make a case.
 *
 * @param name    "box" unit cube, even spacing; "sphere" of radius 1 in a box
 *                of half width 20; "wing", "wing-half" swept tapered wing
 *                with a blunt trailing edge, whole and on a symmetry plane;
 *                "wing-sharp", "wing-sharp-half" with a sharp one; "boom",
 *                "boom-half" a body of revolution at Mach 1.6 in a domain
 *                along the Mach cone, with cells stretched along it;
 *                "disk" the sphere behind an actuator disk; "rotor" the box
 *                with an impeller in a rotating zone; "fins" the box with a
 *                solid with fins; "exchanger" two fluids on both sides of
 *                a pipe; "passage" one blade of a turbine between periodic
 *                sides
 * @param n_cell  requested number of cells, 0: the default. The geometry sets a
 *                lower bound: see the estimate in *out
 * @param out     owned by the caller, vg_demo_release; unchanged on failure
 * VG_ERR_INPUT: no such case (the message lists the known ones), or n_cell is
 * above 2e9. Same bytes for the same arguments. */
vg_status vg_demo_make(const char *name, size_t n_cell, struct vg_demo *out,
                       struct vg_error *err);

void vg_demo_release(struct vg_demo *d);

#endif
