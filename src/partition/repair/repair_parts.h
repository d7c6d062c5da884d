/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/repair/repair_parts.h: declarations shared by the steps of the
 * repair. */
#ifndef VG_PARTITION_REPAIR_REPAIR_PARTS_H
#define VG_PARTITION_REPAIR_REPAIR_PARTS_H

#include "base/bytes.h"
#include "base/table.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/optimise/optimise.h"
#include "partition/repair/repair.h"

#define VG_NO_CLUSTER UINT32_MAX

/* --- owners of pieces (repair_find.c) ------------------------------------ */

struct vg_owner {
  uint32_t serial, rank, piece;
  uint32_t order; /* Position of the piece in the order of the paths. */
  int is_zone;    /* 1: its points may be corners of cells elsewhere. */
};

struct vg_owners {
  size_t n;
  struct vg_owner *at;
}; /* sorted by serial */

/** Gathers the pieces of all ranks. Collective. */
vg_status vg_owners_gather(const struct vg_partition *p, struct vg_comm *comm,
                           struct vg_owners *out, struct vg_error *err);

/** The owner of a point. NULL: a boundary point. */
const struct vg_owner *vg_owners_find(const struct vg_owners *o, uint64_t name);

/** A message for each rank. */
struct vg_outbox {
  int size;
  struct vg_writer *to;
};

vg_status vg_outbox_new(struct vg_outbox *post, int size, struct vg_error *err);
void vg_outbox_release(struct vg_outbox *post);

/** Sends each rank its message. from out: [size], see vg_bytes_release.
 * Collective; st: this rank's status so far. */
vg_status vg_outbox_send(struct vg_outbox *post, struct vg_comm *comm,
                         vg_status st, struct vg_bytes **from,
                         struct vg_error *err);

/* --- limits of shapes (repair_levels.c) ---------------------------------- */

enum { VG_REPAIR_CLASSES = 3 };

/* Limits of shapes (vg_cell_shape), which depend on the measure of shapes. */
struct vg_repair_levels {
  float smooth;    /* Points with a cell below this are smoothed in the first
                      round. */
  float adjacent;  /* The same in the second round, and for adjacent points. */
  float swap;      /* Cells below this are swapped. */
  double target;   /* Cells below this get a repair region. */
  double bad;      /* Cells below this get a larger one. */
  double hopeless; /* Cells that stay below this are tried again. */
  double tally[VG_REPAIR_CLASSES]; /* A repair may not increase the number of
                                      cells below the first two; the last one
                                      is the target. */
};

/** The limits for shapes in the metrics of the field, or for Euclidean shapes
 * if it is not stretched. */
const struct vg_repair_levels *vg_repair_levels(const struct vg_sizing *sizing);

/* --- repair regions (repair_smooth.c, repair_spots.c) -------------------- */

/* A ball around a bad cell: the points x with (x - at)' m (x - at) <= radius^2.
 * m is the metric of the field at the centre, scaled to the determinant 1, so
 * that the ball has the volume of a round one. Where sizes do not depend on the
 * direction, m is exactly the unit tensor. */
struct vg_spot {
  double at[3], radius;
  double m[6];
  double half[3]; /* Half the lengths of the ball's bounding box. */
};

/** A ball; m: NULL: the unit tensor. */
struct vg_spot vg_spot_of(const double at[3], double radius, const double *m);

/** Squared distance of x from the centre, in the metric of the ball. */
static inline double vg_spot_distance2(const struct vg_spot *s,
                                       const double x[3])
{
  double d[3];

  vg_sub(x, s->at, d);
  return vg_tensor_form(s->m, d);
}

/* Ball sizes for cells that are not good, bad cells, and cells that stayed
 * bad. */
enum vg_spot_size {
  VG_SPOT_SMALL,
  VG_SPOT_MIDDLE,
  VG_SPOT_LARGE,
  VG_SPOT_SIZES
};

/** Makes a ball around a cell: a few spacings, and at least the whole cell. */
struct vg_spot vg_spot_around(const struct vg_sizing *sizing,
                              const double *const x[4], enum vg_spot_size k);

/** Adds a ball around a cell with a shape below the target. */
struct vg_spots {
  size_t n, cap;
  struct vg_spot *at;
};
vg_status vg_spots_add(struct vg_spots *s, const struct vg_sizing *sizing,
                       const double *const x[4], double shape);

/** Gathers the balls of all ranks on all ranks, in an order that does not
 * depend on ranks, and thins them. out: owned by the caller, also on failure.
 * Collective. */
vg_status vg_spots_gather(struct vg_writer *w, int n_rank, struct vg_comm *comm,
                          size_t *n, struct vg_spot **out,
                          struct vg_error *err);

/** Swaps and smooths across interfaces. Lists balls around the cells with a
 * corner there that stay bad, of all ranks, by their coordinates. Collective.
 * spans: this rank's tasks are added. (repair_smooth.c) */
vg_status vg_repair_smooth(struct vg_partition *p, struct vg_comm *comm,
                           const struct vg_owners *owners,
                           struct vg_spans *spans, size_t *n,
                           struct vg_spot **out, struct vg_error *err);

/* A halo: cells of one piece that have a corner among the points of another
 * piece, as the owner of these points needs them. (repair_halo.c)
 *
 *     piece A owns the points o   |  piece B has the cells h
 *                                 |
 *     .-------.-------s-----------o-----------x-------.-------.
 *     |       |       |           |     h     |       |       |
 *     .-------.-------s-----------o-----------x-------.-------.
 *     |       |       |           |     h     |       |       |
 *     .-------.-------s-----------o-----------x-------.-------.
 *                     |<--- overlap of A ---->|
 *                                 |<- halo -->|
 *
 *     o  interface points: A smooths them and swaps around them
 *     x  other corners of the halo, sent with their global ids
 *     s, x  adjacent points: smoothed afterwards, in their own piece
 *
 * The overlap is the owner's cells at o and the halos of all pieces around
 * o. */
struct vg_halo {
  uint32_t owner, to;  /* Piece and rank that own the points. */
  uint32_t from, rank; /* Piece and rank that have the cells. */
  uint32_t order;      /* Order of the path of that piece. */
  uint32_t n_known, n_other, n_cell;
  uint32_t *known;     /* [n_known] Indices of the owner's points. */
  uint32_t *vertex;    /* [n_known] Their vertices in the piece that has the
                          cells; not sent: [n_known + n_other]. */
  double (*x)[3];      /* [n_other] Corners that are not the owner's. */
  uint64_t *name;      /* [n_other] Their global ids. */
  uint32_t *zone;      /* [n_other] Order of the zone that owns each corner. */
  uint32_t (*cell)[4]; /* [n_cell] 0 ... n_known - 1 known, then other
                          corners. */
  uint32_t *place;     /* [n_cell] Index in the piece that has them. */
  uint32_t n_gone;     /* Not sent. place [n_gone], at the end: cells that
                          the owner has replaced. */
};
#define VG_NO_ZONE UINT32_MAX

void vg_halo_release(struct vg_halo *s);
void vg_halo_put(struct vg_writer *w, const struct vg_halo *s);
/** On invalid data, sets r->bad and leaves *s empty. */
void vg_halo_get(struct vg_reader *r, struct vg_halo *s);

/** Makes the halos of piece k of this rank. hit out: [n_hit] its cells with a
 * corner among the points of zones, ascending. out, hit: owned by the caller,
 * also on failure. */
vg_status vg_halos_of(const struct vg_partition *p, size_t k,
                      const struct vg_owners *owners, size_t *n,
                      struct vg_halo **out, size_t *n_hit, uint32_t **hit);

/** Updates the coordinates of a halo's corners. */
void vg_halo_refresh(const struct vg_piece *q, struct vg_halo *s);

/** Smooths the points of a piece that are corners of the cells hit [n], which
 * are the cells with a corner on an interface, ascending. Points marked in
 * shared [q.n_point] stay; NULL: none. out: cells that got bad, other than
 * those in hit. (repair_adjacent.c) */
vg_status vg_repair_adjacent(const struct vg_piece *q,
                             const struct vg_sizing *sizing, size_t n,
                             const uint32_t *hit, const uint8_t *shared,
                             struct vg_spots *out);

enum {                         /* flags of a cell in an overlap */
       VG_OVERLAP_CLAIMED = 1, /* another owner handles it */
       VG_OVERLAP_LATER = 2,   /* a point of it may be moved by a zone whose
                                  turn is earlier */
       VG_OVERLAP_NEW = 4
};

/* Overlap: all cells with a corner among an owner's points on interfaces.
 * (repair_overlap.c) */
struct vg_overlap {
  const struct vg_piece *q;
  const struct vg_sizing *sizing;
  const struct vg_owner *self;
  int first; /* See vg_overlap_new. */
  size_t n_halo;
  struct vg_halo *const *halo;
  uint8_t *shared;        /* [q.n_point] 1: on an interface. */
  uint8_t *stays;         /* [q.n_point] 1: near a point of a zone whose turn
                             is earlier. */
  size_t n_base, n_other; /* Vertices of q, then those of the halos. */
  uint64_t *other;        /* [n_other] Their global ids. */
  struct vg_table table;  /* Vertices by global id. */
  size_t n_own;           /* Cells of q, which come first. */
  uint32_t *place;        /* [n_own] Index in q. */
  struct vg_tets t;       /* Without links. */
  struct vg_metrics *metrics; /* Of the corners of its cells, or NULL. */
  size_t cap_kind, cap_shape;
  uint8_t *kind; /* [t.n_cell] Flags. */
  float *shape;  /* [t.n_cell] */
  size_t n_point;
  uint32_t *point; /* [n_point] Points that may move. */
};

/** Makes the overlap. first: 1: zones with earlier paths have the first turn to
 * move points; 0: zones with later paths. */
vg_status vg_overlap_new(struct vg_overlap *f, const struct vg_owners *owners,
                         int first);
void vg_overlap_release(struct vg_overlap *f);

/* Replacement of cells of a piece. */
struct vg_edit {
  uint8_t *gone; /* [q.n_cell] 1: removed; NULL: none. */
  size_t n_cell, n_point;
  uint32_t (*cell)[4]; /* [n_cell] New cells; vertices of q, then the points
                          below. */
  uint64_t *name;      /* [n_point] */
  double (*x)[3];      /* [n_point] */
};

void vg_edit_release(struct vg_edit *c);

/** Applies a change to a piece; points of others that are no longer used are
 * dropped. (repair_edit.c) */
vg_status vg_piece_edit(struct vg_piece *q, const struct vg_edit *c);

/** Swaps in an overlap, where no other owner does and no zone with an earlier
 * turn moves a point. Removed cells are noted in out->gone and in the halos;
 * new cells become part of the overlap. (repair_swap.c) */
vg_status vg_overlap_swap(struct vg_overlap *f, struct vg_edit *out,
                          size_t *n_swap);

/** Takes the final new cells. */
vg_status vg_overlap_take(const struct vg_overlap *f, struct vg_edit *out);

enum { VG_LEVEL_MAX = 64 };

/* Balls that are searched by points inside them. A grid cell can meet many
 * balls, which base/table.h does not store, and its key takes 32 bytes. Here a
 * ball takes 4 bytes for each of the at most 8 cells that it meets, and 32 to
 * 64 bytes of slots. A slot can list balls of other cells; they are excluded
 * by their distance. */
struct vg_spot_grid {
  size_t n;
  const struct vg_spot *spot; /* [n] borrowed */
  uint32_t *cluster;          /* [n] Or VG_NO_CLUSTER: left for later. */
  size_t n_cluster;
  int n_level, level[VG_LEVEL_MAX]; /* Binary exponents of the radii. */
  double share[VG_LEVEL_MAX]; /* Grid cells of each level per unit length. */
  unsigned shift;         /* 64 minus the logarithm of the number of slots. */
  uint32_t *first, *ball; /* [slots + 2] Start in `ball`, by hash of grid
                             cells. */
};

/** Removes balls whose centre is deep inside another ball. */
vg_status vg_spots_thin(size_t *n, struct vg_spot *spot, struct vg_error *err);

/** Joins overlapping balls into clusters, numbered by their first ball. Balls
 * that would make a cluster of more than `most` balls are left for later. */
vg_status vg_spot_grid_new(size_t n, const struct vg_spot *spot, size_t most,
                           struct vg_spot_grid *out, struct vg_error *err);
void vg_spot_grid_release(struct vg_spot_grid *b);

/** The cluster whose balls contain x, or VG_NO_CLUSTER. Threads: safe. */
uint32_t vg_spot_grid_at(const struct vg_spot_grid *b, const double x[3]);

/* --- cells of clusters (repair_cluster.c) -------------------------------- */

/* Cells of one piece for a cluster, as sent to its rank. */
struct vg_cluster_cells {
  uint32_t cluster;
  char path[VG_PATH_MAX]; /* Path of the piece. */
  uint64_t n_point, n_cell;
  uint64_t *name;      /* [n_point] */
  double (*x)[3];      /* [n_point] */
  uint8_t *hold;       /* [n_point] 1: in a ball, but the cluster does not
                          have all of its cells. */
  uint32_t (*cell)[4]; /* [n_cell] */
};

void vg_cluster_cells_release(struct vg_cluster_cells *b);
void vg_cluster_cells_put(struct vg_writer *w,
                          const struct vg_cluster_cells *b);
/** On invalid data, sets r->bad and leaves *b empty. */
void vg_cluster_cells_get(struct vg_reader *r, struct vg_cluster_cells *b);

/* --- the boundary (repair_boundary.c) ------------------------------------ */

/* Boundary triangles between points of clusters. A sheet with cells on both
 * sides cannot be distinguished, by the cells alone, from other faces of three
 * boundary points. */
struct vg_repair_boundary {
  size_t n;
  uint32_t (*tri)[3]; /* [n] Smallest point first, ascending. */
};

/** Selects the triangles between the points of block [n], which are first
 * copies (partition/cut/doubled.h); boundary may be NULL. */
vg_status vg_repair_boundary_new(const struct vg_doubled *doubled,
                                 const struct vg_mesh *boundary, size_t n,
                                 const struct vg_cluster_cells *block,
                                 struct vg_repair_boundary *out,
                                 struct vg_error *err);
void vg_repair_boundary_release(struct vg_repair_boundary *r);

/** Is there a boundary triangle of these points? */
int vg_repair_boundary_has(const struct vg_repair_boundary *r,
                           const uint32_t v[3]);

/* --- results (repair_cluster.c) ------------------------------------------ */

/* Result for a cluster. */
struct vg_repaired {
  int better;                 /* 0: the cells stay unchanged. */
  uint64_t n_cell;            /* Cells of the cluster. */
  uint64_t n_bad, n_bad_left; /* Cells below the target before, after. */
  double worst, worst_left;   /* Their worst shape before, after. */
  struct vg_piece piece;      /* Without path and serial. */
  size_t n_moved;
  uint64_t *moved; /* [n_moved] Points of other pieces that moved. */
  double (*x)[3];  /* [n_moved] Their new coordinates. */
  size_t n_spot, cap_spot;
  struct vg_spot *spot; /* [n_spot] Around cells that stayed bad. */
};

void vg_repaired_release(struct vg_repaired *m);

/** Improves the cells of a cluster. block: [n] by path. */
vg_status vg_repair_cluster(size_t n, const struct vg_cluster_cells *block,
                            const struct vg_spot_grid *balls,
                            const struct vg_repair_boundary *boundary,
                            const struct vg_sizing *sizing,
                            struct vg_repaired *out, struct vg_error *err);

/* --- timing (repair_record.c) -------------------------------------------- */

/** Times a task, begun and ended in the same thread. what: part of the path,
 * which with number is unique among tasks of its kind. */
void vg_repair_begin(struct vg_span *s, int worker);
void vg_repair_end(struct vg_span *s, const char *what, size_t number,
                   size_t n_cell);

/** Adds the tasks of all ranks to the trace of the run. begin: start of the
 * repairs on this rank. On return the times in own are relative to that start,
 * and its rank is set. Collective. */
vg_status vg_repair_record(const struct vg_partition *p, struct vg_comm *comm,
                           double begin, struct vg_spans *own,
                           struct vg_spans *spans, struct vg_error *err);

#endif
