/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/discrete/discrete_parts.h: declarations shared by the steps of the
 * discrete decomposition. */
#ifndef VG_PARTITION_DISCRETE_DISCRETE_PARTS_H
#define VG_PARTITION_DISCRETE_DISCRETE_PARTS_H

#include "core/delaunay/tets.h"
#include "core/sizing/sizing.h"
#include "partition/discrete/discrete.h"

/* The coarse mesh. Faces of the front have no link, even with cells on both
 * sides. */
struct vg_coarse {
  struct vg_tets t;  /* Without dead cells. */
  size_t n_front;    /* Number of points of the front, which come first. */
  uint32_t (*on)[4]; /* [n_cell] Index of the front face at each face of a
                        cell, or VG_NONE. */
  double *weight;    /* [n_cell] Cells that each is expected to hold. */
  uint32_t *part;    /* [n_cell] Subdomain. */
  uint32_t n_part;
  double other_seconds; /* Processor time in s of other processes. */
};

void vg_coarse_release(struct vg_coarse *c);

/** Fills the void at sizes times a factor, or takes the given cells; c is
 * empty. VG_ERR_STOPPED: on request. (discrete_coarse.c) */
vg_status vg_coarse_fill(const struct vg_front *front,
                         const struct vg_sizing *sizing, double factor,
                         const struct vg_coarse_cells *given,
                         const struct vg_engine *e, struct vg_coarse *c,
                         struct vg_error *err);

/** Assigns its cells to subdomains, by the cells that the void's load expects
 * in them: sets c->weight, c->part, c->n_part. n_apart out: subdomains beyond
 * the requested number. (discrete_deal.c) */
vg_status vg_coarse_assign(struct vg_coarse *c, const struct vg_load *load,
                           const struct vg_sizing *sizing,
                           const struct vg_decomposition_options *o,
                           const struct vg_engine *e, uint64_t *n_apart,
                           struct vg_error *err);

/* Faces between subdomains, each once, from the cell with the lower index. */
struct vg_interface {
  size_t n_face;
  uint32_t *side;      /* [n_face] 4 * cell + face */
  uint32_t (*edge)[3]; /* [n_face] Edge k is from corner k to k + 1. */
  size_t n_edge;
  uint32_t (*end)[2]; /* [n_edge] Ascending. */
  uint32_t *n_around; /* [n_edge] Faces between subdomains around the edge. */
};

void vg_interface_release(struct vg_interface *f);

/** Lists the faces. f is empty. (discrete_faces.c) */
vg_status vg_interface_list(const struct vg_coarse *c, struct vg_interface *f,
                            struct vg_error *err);

/** Corners of face i, oriented as seen from inside its cell. */
void vg_interface_corners(const struct vg_coarse *c,
                          const struct vg_interface *f, size_t i,
                          uint32_t v[3]);

/** Smooths the interfaces by moving points of the coarse mesh; points of the
 * front and ends of curves stay. (discrete_smooth.c) */
vg_status vg_interface_smooth(struct vg_coarse *c, const struct vg_interface *f,
                              struct vg_error *err);

/* Meshed interfaces. Points below t.n_point are points of the coarse mesh, the
 * others are x[k - t.n_point]. */
struct vg_sheets {
  size_t n_point, cap_point;
  double (*x)[3];     /* [n_point] New points. */
  size_t *begin;      /* [n_face + 1] First triangle of each face. */
  uint32_t (*tri)[3]; /* Oriented like the corners of their face. */
};

void vg_sheets_release(struct vg_sheets *s);

/** Remeshes the interfaces to the local size: edges, then faces within their
 * planes. s is empty. Faces are distributed in loops of e.
 * (discrete_divide.c) */
vg_status vg_sheets_remesh(const struct vg_coarse *c,
                           const struct vg_interface *f,
                           const struct vg_sizing *sizing,
                           const struct vg_engine *e, struct vg_sheets *s,
                           struct vg_error *err);

/** Refines the interfaces instead by halving edges until none is longer than
 * 1.5 times the size at its midpoint. (discrete_halve.c) */
vg_status vg_sheets_halve(const struct vg_coarse *c,
                          const struct vg_interface *f,
                          const struct vg_sizing *sizing, struct vg_sheets *s,
                          struct vg_error *err);

#endif
