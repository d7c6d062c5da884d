/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/accuracy.h: discretisation errors of a mesh without a flow
 * solver.
 *
 * Smooth functions take the place of a flow. The judge gives their values to
 * the unknowns of a solver, reconstructs gradients with the schemes of solvers,
 * and compares them with the exact gradients. Unknowns are in the points, with
 * the median dual as control volumes (FUN3D, SU2), or in the cells (USM3D,
 * OpenFOAM). docs/design/methods.md has formulas and sources. */
#ifndef VG_CORE_ACCURACY_ACCURACY_H
#define VG_CORE_ACCURACY_ACCURACY_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

/* Where the unknowns are. */
enum vg_unknowns { VG_IN_NODES, VG_IN_CELLS, VG_UNKNOWNS };

enum vg_accuracy_field {
  VG_FIELD_LINEAR,    /* polynomial of degree 1 */
  VG_FIELD_QUADRATIC, /* polynomial of degree 2 */
  VG_FIELD_SPHERE,    /* potential of the flow around a sphere */
  VG_FIELD_VORTEX,    /* velocity component of a Lamb-Oseen vortex */
  VG_FIELD_SHEAR,     /* velocity of a free shear layer, tanh */
  VG_FIELD_WALL,      /* turbulent velocity profile of Reichardt */
  VG_FIELDS
};

enum vg_accuracy_scheme {
  VG_SCHEME_LSQ,     /* gradient, least squares without weights */
  VG_SCHEME_WLSQ,    /* gradient, least squares with weights 1 / distance */
  VG_SCHEME_GAUSS,   /* gradient by the theorem of Green and Gauss */
  VG_SCHEME_VISCOUS, /* truncation error of the Laplacian */
  VG_SCHEMES
};

/* Parts of the mesh, by wall distance: y+ at most 5, 30 and 1000; beyond these,
 * within one length of the walls' centre and outside. */
enum vg_accuracy_zone {
  VG_ZONE_SUBLAYER,
  VG_ZONE_BUFFER,
  VG_ZONE_LOG,
  VG_ZONE_FIELD,
  VG_ZONE_FAR,
  VG_ZONE_LAYERS, /* the first three together */
  VG_ZONE_ALL,
  VG_ZONES
};

/** Error relative to the exact values of a zone: in the 1-norm, 2-norm and
 * maximum norm. NAN: no control volume, or the exact values are 0. */
struct vg_accuracy_error {
  size_t n;      /* control volumes */
  double volume; /* sum of their volumes */
  double l1, l2, max;
};

/** Errors of the wall profile on a wall, without the neighbourhood of sharp
 * edges; NAN if nothing else is left. */
struct vg_accuracy_patch {
  uint32_t patch; /* index in the mesh */
  size_t n[VG_UNKNOWNS];
  /* Gradients in the first control volumes: relative, 2-norm. */
  double gradient[VG_UNKNOWNS][VG_SCHEME_VISCOUS];
  /* Wall shear over its exact value: mean, and 2-norm and maximum of its
   * deviation from 1, weighted by area. Unknowns in nodes: from the gradient in
   * the cell of the face; in cells: from the value in the cell. */
  double shear_mean[VG_UNKNOWNS], shear_l2[VG_UNKNOWNS];
  double shear_max[VG_UNKNOWNS];
};

/** Shapes of structured meshes of hexahedra for comparison. */
enum vg_reference_shape { VG_REFERENCE_PLATE, VG_REFERENCE_CYLINDER };
enum { VG_REFERENCES = 2 };

/** A structured mesh with the spacing of the walls, the first height and the
 * number of points per wall point, up to y+ 1000, of the judged mesh. */
struct vg_accuracy_reference {
  double growth; /* ratio of successive heights */
  size_t levels; /* number of cells across the layers */
  struct vg_accuracy_error layers[VG_UNKNOWNS][VG_SCHEMES]; /* wall profile */
};

struct vg_accuracy_report {
  double first_height;      /* median height of the first points above walls; 0:
                               no walls */
  double viscous_length;    /* length of y+ 1 */
  double length, centre[3]; /* diagonal and centre of the walls' bounding box;
                               without walls, of the mesh */
  size_t n[VG_UNKNOWNS];
  size_t n_wall;  /* points of walls */
  size_t n_layer; /* points in the zone of the layers */
  double wall_area;
  size_t n_deficient[VG_UNKNOWNS]; /* stencils that do not determine a gradient:
                                      the missing components count as 0 */
  struct vg_accuracy_error error[VG_UNKNOWNS][VG_FIELDS][VG_SCHEMES][VG_ZONES];
  size_t n_patch;
  struct vg_accuracy_patch *patch; /* [n_patch] walls; owned */
  int has_reference;
  struct vg_accuracy_reference reference[VG_REFERENCES];
};

struct vg_accuracy_options {
  const uint8_t *is_wall; /* [n_patch] of the mesh */
  double viscous_length;  /* length of y+ 1; 0: the median first height */
  int threads;            /* 0: one per core */
  int with_reference;     /* 1: compare with structured meshes */
};

/** Names for reports. Static strings. */
const char *vg_accuracy_field_name(enum vg_accuracy_field f);
const char *vg_accuracy_zone_name(enum vg_accuracy_zone z);

/** Measure the errors on a valid mesh with all its boundary faces. The figures
 * are the same bits for any number of threads.
 *
 * @param r  out: released with vg_accuracy_release; unchanged on failure
 *
 * O(n log n) time. Memory: 36 bytes per face of control volumes and 130 per
 * control volume, for points and cells one after the other. VG_ERR_MEMORY.
 * VG_ERR_UNSUPPORTED for more than 2^29 cells or 2^30 faces of control volumes;
 * VG_ERR_INPUT if faces of cells have no mate. */
vg_status vg_accuracy_measure(const struct vg_mesh *m,
                              const struct vg_accuracy_options *o,
                              struct vg_accuracy_report *r,
                              struct vg_error *err);

void vg_accuracy_release(struct vg_accuracy_report *r);

#endif
