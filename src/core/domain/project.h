/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/project.h: the data of a mesh project besides surface triangles:
 * planar patches bounded by curves, sources, layer settings. Filled by the .d3m
 * reader and by the run deck. Uses core/mesh/mesh.h, core/sizing/sizing.h. */
#ifndef VG_CORE_DOMAIN_PROJECT_H
#define VG_CORE_DOMAIN_PROJECT_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** An ordered chain of configuration points. */
struct vg_curve {
  int32_t id;
  size_t n;
  uint32_t *point; /* [n] indices into vg_project.point; owned */
};

/** A patch bounded by one closed loop of curves; its normal follows the
 * right-hand rule and points into the fluid. */
struct vg_patch_shape {
  struct vg_patch patch; /* Number and name; bc from the .mapbc if known. */
  int32_t type, rotation, n_side;
  int32_t meshing_class; /* The "bc" column of the .d3m: 2 grows layers. */
  size_t n;
  int32_t *curve; /* [n] 1-based index into curve[]; < 0: reversed. */
};

/** Growth law of VGRID: formats.md 1.8. */
struct vg_layer_law {
  double delta1, rate1, rate2;
  int32_t n_max;
};

struct vg_project {
  char name[VG_NAME_MAX];
  int32_t grid; /* 0 Euler, 1 uniform growth law, 2 growth law by source. */
  struct vg_layer_law layer;
  int32_t restart, stretch, n_background;
  double ifact, vfact; /* Spacing factors of the sizing field and of layers. */
  size_t n_point, n_curve, n_shape, n_source;
  double (*point)[3];
  struct vg_curve *curve;
  struct vg_patch_shape *shape;
  struct vg_source *source;
};
#define VG_PROJECT_INIT                                                        \
  {                                                                            \
    .ifact = 1, .vfact = 1                                                     \
  }

/** Free everything and leave *p empty. */
void vg_project_release(struct vg_project *p);

#endif
