/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/decomposition.h: decomposition of a void by interfaces before
 * any of it is filled, as the discrete and the octree-guided decomposition make
 * it. The subdomains are filled, or cut further, like the children of a cut.
 * Uses task_data.h, load.h, engine.h. */
#ifndef VG_PARTITION_CUT_DECOMPOSITION_H
#define VG_PARTITION_CUT_DECOMPOSITION_H

#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"

/* In the order of the words of the setting. */
enum vg_partitioner { VG_PARTITIONER_METIS, VG_PARTITIONER_RCB };

/* Coarse mesh of a void: the points of its front first, in their order. */
struct vg_coarse_cells {
  size_t n_point, n_cell;
  double (*x)[3];      /* [n_point] */
  uint32_t (*cell)[4]; /* [n_cell] In either orientation. */
  double seconds;      /* Time in s to make it. */
};

void vg_coarse_cells_release(struct vg_coarse_cells *c);

struct vg_decomposition_options {
  /* Number of subdomains, at least 1 when a maker is called; before that,
   * 0: derived from the rule's leaf_cells. */
  int n_part;
  int partitioner;       /* enum vg_partitioner */
  double coarsening;     /* Edge length of the coarse mesh or octree relative
                            to the mesh; 0: automatic. */
  int h_refine;          /* 1: interfaces are refined to the local size by
                            halving edges. */
  double cells_per_cube; /* See vg_load_new. */
  /* Coarse mesh that all workers made before, for the discrete maker;
   * borrowed. NULL: the maker makes one. */
  const struct vg_coarse_cells *coarse;
};
#define VG_DECOMPOSITION_OPTIONS_INIT                                          \
  {                                                                            \
    0, VG_PARTITIONER_METIS, 0, 0, VG_LOAD_CELLS_PER_CUBE, NULL                \
  }

/* In the order of the words of the setting. */
enum vg_decomposition_method {
  VG_DECOMPOSE_ADVANCING,
  VG_DECOMPOSE_DISCRETE,
  VG_DECOMPOSE_OCTREE,
  VG_DECOMPOSITIONS
};

/* Steps of a maker whose times are reported. */
enum {
  VG_DECOMPOSITION_COARSE, /* coarse mesh or octree */
  VG_DECOMPOSITION_GRAPH,  /* assignment of its cells to subdomains */
  VG_DECOMPOSITION_SMOOTH, /* smoothing of interfaces */
  VG_DECOMPOSITION_FACES,  /* remeshing of interfaces to the local size */
  VG_DECOMPOSITION_STEPS
};

struct vg_decomposition_report {
  double coarsening;   /* Coarsening that was used. */
  uint64_t n_coarse;   /* Coarse cells or octants. */
  double coarse_cells; /* Cells expected in the octants. */
  uint64_t n_gap;      /* Gap regions at the front, without octants; 0: none. */
  uint64_t n_apart;    /* Subdomains beyond n_part, made from disconnected
                          components. */
  uint64_t n_asked; /* Requested subdomains; with octants there may be fewer. */
  uint64_t n_face;  /* Triangles of interfaces. */
  double time[VG_DECOMPOSITION_STEPS];
  double other_seconds; /* Processor time in s of other processes. */
};

struct vg_writer;
struct vg_reader;

struct vg_decomposition {
  size_t n_point;
  double (*x)[3]; /* [n_point] Interface points, none of them on the front. */
  size_t n_part;
  struct vg_part {
    /* Closed front, facing into the subdomain. Global ids: unchanged for
     * the void's own points, VG_POINT_ID(serial of the decomposition, k)
     * for x[k]. */
    struct vg_front front;
    /* 1: the advancing partition may cut it further, if each of its
     * interface points is also on a subdomain that may not be cut;
     * otherwise it is filled. */
    int may_cut;
  } * part; /* [n_part], in an order that depends on the input alone. */
  struct vg_decomposition_report report;
};
#define VG_DECOMPOSITION_INIT                                                  \
  {                                                                            \
    0                                                                          \
  }

void vg_decomposition_release(struct vg_decomposition *p);

/** Number of subdomains for leaves of the given size; 0: one. */
int vg_decomposition_parts(double cells, double leaf_cells);

/** Leaf size for a void of `cells` expected cells that planes cut when n_part
 * subdomains are requested; n_part 0: leaf_cells, which is 0 if the rule does
 * not use it.
 * is_parted 1: subdomains that a maker leaves to be cut get leaves as large as
 * its subdomains, but no smaller than worth a cut, and no larger than
 * leaf_cells. */
double vg_decomposition_leaf_cells(double cells, int n_part, int is_parted,
                                   double leaf_cells);

/** Can a void with the given number of expected cells be divided into the
 * number of subdomains that the options request? If not, VG_ERR_INPUT or
 * VG_ERR_UNSUPPORTED with a remedy. */
vg_status vg_decomposition_check_options(
  const struct vg_decomposition_options *o, double cells, struct vg_error *err);

/** Decomposes the void within a front (a maker).
 *
 * @param front   closed, facing into the void; borrowed
 * @param load    of the void
 * @param serial  no point of the front has it in its global id
 * @param e       for loops (vg_engine_loop); polled for a stop
 * @param out     empty; untouched on failure
 * The result depends on the arguments alone, bit by bit, except e and the
 * serial.
 * Threads: several may run at once.
 * VG_ERR_STOPPED: on request; VG_ERR_GEOMETRY, VG_ERR_UNSUPPORTED: the void
 * cannot be decomposed in this way, with the reason and a remedy;
 * VG_ERR_MEMORY. */
typedef vg_status vg_decomposition_maker(
  const struct vg_front *front, const struct vg_load *load,
  const struct vg_sizing *sizing,
  const struct vg_decomposition_options *options, uint32_t serial,
  const struct vg_engine *e, struct vg_decomposition *out,
  struct vg_error *err);

/** Checks that this is a decomposition of the void within the front: every face
 * of the front is in one subdomain, unchanged, and every other face in two,
 * with opposite orientations. Cost: a sort of all faces. VG_ERR_GEOMETRY names
 * the defect and its position. */
vg_status vg_decomposition_check(const struct vg_decomposition *p,
                                 const struct vg_front *front, uint32_t serial,
                                 struct vg_error *err);

/** Packs and unpacks a decomposition for the store, independently of its
 * serial; *p is unchanged by packing. On invalid data, r->bad is set and *p
 * stays empty. */
void vg_decomposition_put(struct vg_writer *w, struct vg_decomposition *p,
                          uint32_t serial);
void vg_decomposition_get(struct vg_reader *r, uint32_t serial,
                          struct vg_decomposition *p);

#endif
