/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/forecast_parts.h: a void of the forecast's tree, with its
 * load and a coarse front (forecast_front.c), divided into blocks
 * (forecast_blocks.c). Private to forecast*.c. The result of every function
 * depends on its arguments alone; VG_ERR_MEMORY is their only error. */
#ifndef VG_PARTITION_MODEL_FORECAST_PARTS_H
#define VG_PARTITION_MODEL_FORECAST_PARTS_H

#include "core/front/region.h"
#include "partition/load/load.h"
#include "partition/model/forecast.h"

/* Triangles of edge h per square of side h, 4 / sqrt(3). */
#define VG_FACES_PER_SQUARE 2.309

/* A piece of front: n faces around x with the area of an equilateral triangle
 * of edge h. across: the target edge length across planes normal to the axes
 * (vg_load_octant); h if the sizes do not depend on the direction. */
struct vg_bin {
  float x[3], h, across[3], n;
};

struct vg_bins {
  size_t n, cap;
  struct vg_bin *bit;
};

/* Number of cells, and of those at varying spacing. */
struct vg_amount {
  double cells, graded;
};

/* A void of the forecast, which cuts divide further. */
struct vg_subdomain {
  struct vg_load load;
  struct vg_bins front;
  double lo[3], hi[3];
  char path[VG_PATH_MAX];
  size_t parent;
  int depth, levels, retry;
};

/* --- front and load (forecast_front.c) ----------------------------------- */

void vg_subdomain_release(struct vg_subdomain *p);

vg_status vg_bins_add(struct vg_bins *f, const struct vg_bin *b,
                      struct vg_error *err);
double vg_bins_faces(const struct vg_bins *f);

/** Adds a share of an octant's content to a. */
void vg_amount_add(struct vg_amount *a, const struct vg_load_octant *c,
                   double share);

/** Removes the cells of the region from the load and counts them in a. If there
 * are any, the faces that the zone leaves are added to made. */
vg_status vg_bins_take(struct vg_subdomain *p, const struct vg_region *r,
                       struct vg_bins *made, struct vg_amount *a,
                       struct vg_error *err);

/** Removes the front that a zone has covered, among the first n bins. */
void vg_bins_cover(struct vg_bins *f, size_t n, const struct vg_region *r);

/** Faces of the first n bins that the task of the region must know. */
double vg_bins_near(const struct vg_bins *f, size_t n,
                    const struct vg_region *r);

/* --- blocks (forecast_blocks.c) ------------------------------------------ */

struct vg_blocks {
  const struct vg_lattice *l; /* borrowed */
  size_t n;
  struct vg_subdomain *part; /* [n] Subdomains, x first. */
};

/** Divides load, front and box of p among the blocks of a lattice. Call
 * vg_blocks_release in any case. */
vg_status vg_blocks_open(struct vg_blocks *b, const struct vg_lattice *l,
                         const struct vg_subdomain *p, struct vg_error *err);
void vg_blocks_release(struct vg_blocks *b);

#endif
