/* partition/discrete/discrete_parts.h: what the steps of the discrete
 * decomposition share. */
#ifndef VG_PARTITION_DISCRETE_DISCRETE_PARTS_H
#define VG_PARTITION_DISCRETE_DISCRETE_PARTS_H

#include "core/delaunay/tets.h"
#include "core/sizing/sizing.h"
#include "partition/discrete/discrete.h"

/* The coarse mesh. Faces of the front have no link, even if there are cells on
 * both sides. */
struct vg_coarse {
  struct vg_tets t;  /* no dead cells */
  size_t n_front;    /* first points: those of the front */
  uint32_t (*on)[4]; /* [n_cell] face of the front that each face of a
                        cell is, or VG_NONE */
  double *weight;    /* [n_cell] cells that it is expected to hold */
  uint32_t *part;    /* [n_cell] */
  uint32_t n_part;
  double elsewhere; /* s of processor time in other processes */
};

void vg_coarse_release(struct vg_coarse *c);

/** Fill the void at sizes times a factor, or with the cells given; c is empty.
 * VG_ERR_STOPPED: as asked. (discrete_coarse.c) */
vg_status vg_coarse_fill(const struct vg_front *front,
                         const struct vg_sizing *sizing, double factor,
                         const struct vg_coarse_cells *given,
                         const struct vg_engine *e, struct vg_coarse *c,
                         struct vg_error *err);

/** Deal its cells out, by those that the void's load expects in them:
 * c->weight, c->part, c->n_part. n_apart out: parts beyond those asked for.
 * (discrete_deal.c) */
vg_status vg_coarse_deal(struct vg_coarse *c, const struct vg_load *load,
                         const struct vg_sizing *sizing,
                         const struct vg_decomposition_options *o,
                         const struct vg_engine *e, uint64_t *n_apart,
                         struct vg_error *err);

/* Faces between parts, each once: of the cell with the lower number. */
struct vg_interface {
  size_t n_face;
  uint32_t *side;      /* [n_face] 4 * cell + face */
  uint32_t (*edge)[3]; /* [n_face] k: from corner k to k + 1 */
  size_t n_edge;
  uint32_t (*end)[2]; /* [n_edge] rising */
  uint32_t *n_around; /* [n_edge] faces between parts around it */
};

void vg_interface_release(struct vg_interface *f);

/** List them. f is empty. (discrete_faces.c) */
vg_status vg_interface_list(const struct vg_coarse *c, struct vg_interface *f,
                            struct vg_error *err);

/** Corners of face i, as its cell sees it from within. */
void vg_interface_corners(const struct vg_coarse *c,
                          const struct vg_interface *f, size_t i,
                          uint32_t v[3]);

/** Smooth the interfaces: points of the coarse mesh move, those of the front
 * and where curves end stay. (discrete_smooth.c) */
vg_status vg_interface_smooth(struct vg_coarse *c, const struct vg_interface *f,
                              struct vg_error *err);

/* Interfaces as they are meshed. Points below t.n_point are the coarse mesh's,
 * others x[k - t.n_point]. */
struct vg_sheets {
  size_t n_point, cap_point;
  double (*x)[3];     /* [n_point] new */
  size_t *begin;      /* [n_face + 1] into tri */
  uint32_t (*tri)[3]; /* turned as the corners of their face */
};

void vg_sheets_release(struct vg_sheets *s);

/** Bring the interfaces to the local size: edges, then faces within their
 * planes. s is empty. Faces are shared out in loops of e. (discrete_divide.c)
 * */
vg_status vg_sheets_remesh(const struct vg_coarse *c,
                           const struct vg_interface *f,
                           const struct vg_sizing *sizing,
                           const struct vg_engine *e, struct vg_sheets *s,
                           struct vg_error *err);

/** The same by halving edges until none is longer than the size at its middle
 * by half. (discrete_halve.c) */
vg_status vg_sheets_halve(const struct vg_coarse *c,
                          const struct vg_interface *f,
                          const struct vg_sizing *sizing, struct vg_sheets *s,
                          struct vg_error *err);

#endif
