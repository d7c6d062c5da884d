/* partition/cut/decomposition.h: a void that was parted by interfaces before
 * any of it is filled: what the discrete and the octree-guided decomposition
 * make. The parts are filled, or cut further, like the children of a cut. Uses
 * task_data.h, load.h, engine.h. */
#ifndef VG_PARTITION_CUT_DECOMPOSITION_H
#define VG_PARTITION_CUT_DECOMPOSITION_H

#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"

/* In the order of the setting's words. */
enum vg_partitioner { VG_PARTITIONER_METIS, VG_PARTITIONER_RCB };

/* A coarse mesh of a void: the points of its front first, in their order. */
struct vg_coarse_cells {
  size_t n_point, n_cell;
  double (*x)[3];      /* [n_point] */
  uint32_t (*cell)[4]; /* [n_cell] in either orientation */
  double seconds;      /* that it took */
};

void vg_coarse_cells_release(struct vg_coarse_cells *c);

struct vg_decomposition_options {
  int n_part;            /* at least 1 when a maker is asked; before, 0:
                            by the rule's leaf_cells */
  int partitioner;       /* enum vg_partitioner */
  double coarsening;     /* sizes of the coarse mesh or octree over those of
                            the mesh; 0: chosen */
  int h_refine;          /* 1: interfaces get their size by halving edges */
  double cells_per_cube; /* as of vg_load_new */
  const struct vg_coarse_cells *coarse; /* made before by all workers, for the
                               discrete maker; borrowed. NULL: it makes one */
};
#define VG_DECOMPOSITION_OPTIONS_INIT                                          \
  {                                                                            \
    0, VG_PARTITIONER_METIS, 0, 0, VG_LOAD_CELLS_PER_CUBE, NULL                \
  }

/* In the order of the setting's words. */
enum vg_decomposition_method {
  VG_DECOMPOSE_ADVANCING,
  VG_DECOMPOSE_DISCRETE,
  VG_DECOMPOSE_OCTREE,
  VG_DECOMPOSITIONS
};

/* Steps of a maker whose seconds are told. */
enum {
  VG_DECOMPOSITION_COARSE, /* coarse mesh or octree */
  VG_DECOMPOSITION_GRAPH,  /* its cells dealt out to parts */
  VG_DECOMPOSITION_SMOOTH, /* interfaces smoothed */
  VG_DECOMPOSITION_FACES,  /* interfaces brought to the local size */
  VG_DECOMPOSITION_STEPS
};

struct vg_decomposition_report {
  double coarsening;   /* that was used */
  uint64_t n_coarse;   /* coarse cells or octants */
  double coarse_cells; /* expected in the octants */
  uint64_t n_gap;      /* parts at the front, without octants; 0: there
                          are none */
  uint64_t n_apart;    /* parts beyond n_part: pieces that hung apart */
  uint64_t n_asked;    /* parts asked for; of octants fewer may be made */
  uint64_t n_face;     /* triangles of interfaces */
  double time[VG_DECOMPOSITION_STEPS];
  double elsewhere; /* s of processor time in other processes */
};

struct vg_writer;
struct vg_reader;

struct vg_decomposition {
  size_t n_point;
  double (*x)[3]; /* [n_point] points of interfaces, none of them on
                     the front */
  size_t n_part;
  struct vg_part {
    struct vg_front front; /* closed, into the part; names: of the void's own
                              points as they were, of x[k] VG_POINT_ID(
                              serial of the decomposition, k) */
    int may_cut;           /* 1: the advancing partition may cut it further,
                              if each of its interface points is on a part,
                              too, that it may not cut; else it is filled */
  } * part;                /* [n_part], in an order that follows from input */
  struct vg_decomposition_report report;
};
#define VG_DECOMPOSITION_INIT                                                  \
  {                                                                            \
    0                                                                          \
  }

void vg_decomposition_release(struct vg_decomposition *p);

/** Parts for leaves of so many cells; 0: one. */
int vg_decomposition_parts(double cells, double leaf_cells);

/** Cells of leaves where planes cut a void of so many, and so many parts are
 * asked for; n_part 0: leaf_cells, which is 0 where they are not to be cut by
 * that.
 * is_parted 1: what a maker leaves to be cut gets leaves as large as its parts,
 * but no smaller than is worth a cut, and no larger than leaf_cells. */
double vg_decomposition_leaf_cells(double cells, int n_part, int is_parted,
                                   double leaf_cells);

/** Can a void of so many cells, as expected, be as many parts as the options
 * ask for? VG_ERR_INPUT, VG_ERR_UNSUPPORTED, with a remedy, where it cannot. */
vg_status vg_decomposition_check_options(
  const struct vg_decomposition_options *o, double cells, struct vg_error *err);

/** Part the void within a front.
 *
 * @param front   closed, into the void; borrowed
 * @param load    of the void
 * @param serial  that no point of the front has in its name
 * @param e       for loops (vg_engine_loop); asked now and then whether to stop
 * @param out     empty; untouched on failure
 * Follows from the arguments alone, e and the serial aside, bit by bit.
 * Threads: several may run at once.
 * VG_ERR_STOPPED: as asked; VG_ERR_GEOMETRY, VG_ERR_UNSUPPORTED: it cannot be
 * parted so, with the reason and a remedy; VG_ERR_MEMORY. */
typedef vg_status vg_decomposition_maker(
  const struct vg_front *front, const struct vg_load *load,
  const struct vg_sizing *sizing,
  const struct vg_decomposition_options *options, uint32_t serial,
  const struct vg_engine *e, struct vg_decomposition *out,
  struct vg_error *err);

/** Is this a decomposition of the void within the front? Every face of the
 * front in one part, as it was, every other face in two that look at it from
 * both sides. Cost: a sort of all faces. VG_ERR_GEOMETRY names what is wrong
 * and where. */
vg_status vg_decomposition_check(const struct vg_decomposition *p,
                                 const struct vg_front *front, uint32_t serial,
                                 struct vg_error *err);

/** Bytes of a decomposition and back, for the store, whatever its serial is
 * then; *p is as it was. Sets r->bad, and leaves *p empty, where the data
 * cannot be. */
void vg_decomposition_put(struct vg_writer *w, struct vg_decomposition *p,
                          uint32_t serial);
void vg_decomposition_get(struct vg_reader *r, uint32_t serial,
                          struct vg_decomposition *p);

#endif
