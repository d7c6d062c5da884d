/* partition/repair/repair_parts.h: what the steps of the repair share. */
#ifndef VG_PARTITION_REPAIR_REPAIR_PARTS_H
#define VG_PARTITION_REPAIR_REPAIR_PARTS_H

#include "base/bytes.h"
#include "base/table.h"
#include "core/optimise/optimise.h"
#include "partition/repair/repair.h"

#define VG_NO_CLUSTER UINT32_MAX

/* --- who has which piece (repair_find.c) --------------------------------- */

struct vg_owner {
  uint32_t serial, rank, piece;
  uint32_t order; /* in the order of the paths */
  int is_zone;    /* its points may have cells elsewhere */
};

struct vg_owners {
  size_t n;
  struct vg_owner *at;
}; /* by serial */

/** Pieces of all ranks. Collective. */
vg_status vg_owners_gather(const struct vg_partition *p, struct vg_comm *comm,
                           struct vg_owners *out, struct vg_error *err);

/** Whose point is this? NULL: the boundary's. */
const struct vg_owner *vg_owners_find(const struct vg_owners *o, uint64_t name);

/** A list for each of the ranks. */
struct vg_outbox {
  int size;
  struct vg_writer *to;
};

vg_status vg_outbox_new(struct vg_outbox *post, int size, struct vg_error *err);
void vg_outbox_release(struct vg_outbox *post);

/** Give each rank its list. from out: [size], see vg_bytes_release.
 * Collective; st: this rank's status so far. */
vg_status vg_outbox_send(struct vg_outbox *post, struct vg_comm *comm,
                         vg_status st, struct vg_bytes **from,
                         struct vg_error *err);

/* --- where (repair_smooth.c, repair_spots.c) ----------------------------- */

/* A ball around a bad cell. */
struct vg_spot {
  double at[3], radius;
};

/* For cells that are not good, bad ones, and what stayed bad. */
enum vg_spot_size {
  VG_SPOT_SMALL,
  VG_SPOT_MIDDLE,
  VG_SPOT_LARGE,
  VG_SPOT_SIZES
};

/** A ball around a cell: a few spacings, and all of the cell. */
struct vg_spot vg_spot_around(const struct vg_sizing *sizing,
                              const double *const x[4], enum vg_spot_size k);

/** Add one around a cell of a shape below VG_SHAPE_TARGET. */
struct vg_spots {
  size_t n, cap;
  struct vg_spot *at;
};
vg_status vg_spots_add(struct vg_spots *s, const struct vg_sizing *sizing,
                       const double *const x[4], double shape);

/** The balls that ranks wrote, on all of them: in an order that does not
 * depend on ranks, thinned. out: owned by the caller, also on failure.
 * Collective. */
vg_status vg_spots_gather(struct vg_writer *w, int n_rank, struct vg_comm *comm,
                          size_t *n, struct vg_spot **out,
                          struct vg_error *err);

/** As vg_shape: dihedral angles below 18 or above 162 degrees. */
#define VG_SHAPE_BAD 0.0955 /* R4 */

/** Swap and smooth across interfaces, and list balls around the cells with a
 * corner there that stay bad, of all ranks, by their coordinates. Collective.
 * spans: this rank's tasks are added. (repair_smooth.c) */
vg_status vg_repair_smooth(struct vg_partition *p, struct vg_comm *comm,
                           const struct vg_owners *owners,
                           struct vg_spans *spans, size_t *n,
                           struct vg_spot **out, struct vg_error *err);

/* Cells of one piece that have a corner among the points of another, as its
 * owner needs them. (repair_halo.c) */
struct vg_halo {
  uint32_t owner, to;  /* whose points: piece and rank */
  uint32_t from, rank; /* who has the cells: likewise */
  uint32_t order;      /* of its path */
  uint32_t n_known, n_other, n_cell;
  uint32_t *known;     /* [n_known] places of the owner's points */
  uint32_t *vertex;    /* [n_known] in the piece that has the cells;
                          not sent: [n_known + n_other] */
  double (*x)[3];      /* [n_other] corners that are not the owner's */
  uint64_t *name;      /* [n_other] */
  uint32_t *zone;      /* [n_other] order of the zone whose they are */
  uint32_t (*cell)[4]; /* [n_cell] 0 ... n_known - 1 known, then other */
  uint32_t *place;     /* [n_cell] in the piece that has them */
  uint32_t n_gone;     /* not sent. place [n_gone] once all is done:
                          those that the owner has others for */
};
#define VG_NO_ZONE UINT32_MAX

void vg_halo_release(struct vg_halo *s);
void vg_halo_put(struct vg_writer *w, const struct vg_halo *s);
/** Sets r->bad, and leaves *s empty, where the data cannot be. */
void vg_halo_get(struct vg_reader *r, struct vg_halo *s);

/** The halos of piece k of this rank. hit out: [n_hit] its cells with a corner
 * among the points of zones, in rising order. out, hit: owned by the caller,
 * also on failure. */
vg_status vg_halos_of(const struct vg_partition *p, size_t k,
                      const struct vg_owners *owners, size_t *n,
                      struct vg_halo **out, size_t *n_hit, uint32_t **hit);

/** The corners of a halo as they are now. */
void vg_halo_refresh(const struct vg_piece *q, struct vg_halo *s);

/** As vg_shape. Points with a cell below the first (42 degrees) around them
 * are smoothed in the first round, below the second (48) in the second and
 * as adjacent points; cells below the third (39) are swapped. */
#define VG_SHAPE_LEVEL 0.45f    /* R1 */
#define VG_SHAPE_ADJACENT 0.55f /* R2 */
#define VG_SHAPE_SWAP 0.4f      /* R3 */

/** Smooth the points of a piece that are corners of the cells hit [n], which
 * are those with a corner on an interface in rising order; but not those that
 * are shared [q.n_point], NULL: none is. out: cells that it spoiled, but for
 * those hit. (repair_adjacent.c) */
vg_status vg_repair_adjacent(const struct vg_piece *q,
                             const struct vg_sizing *sizing, size_t n,
                             const uint32_t *hit, const uint8_t *shared,
                             struct vg_spots *out);

enum {                         /* what is known of a cell in it */
       VG_OVERLAP_CLAIMED = 1, /* an earlier owner looks at it */
       VG_OVERLAP_LATER = 2,   /* an earlier owner may move a point of it */
       VG_OVERLAP_NEW = 4
};

/* All cells with a corner among an owner's points on interfaces.
 * (repair_overlap.c) */
struct vg_overlap {
  const struct vg_piece *q;
  const struct vg_owner *self;
  int first; /* as below */
  size_t n_halo;
  struct vg_halo *const *halo;
  uint8_t *shared;        /* [q.n_point] on an interface */
  uint8_t *stays;         /* [q.n_point] an earlier owner's point is near */
  size_t n_base, n_other; /* vertices of q, then those of the halos */
  uint64_t *other;        /* [n_other] their names */
  struct vg_table table;  /* vertices by their names */
  size_t n_own;           /* cells of q come first */
  uint32_t *place;        /* [n_own] in q */
  struct vg_tets t;       /* without links */
  size_t cap_kind, cap_shape;
  uint8_t *kind; /* [t.n_cell] */
  float *shape;  /* [t.n_cell] */
  size_t n_point;
  uint32_t *point; /* [n_point] that may move */
};

/** first: those who come first in the order may move points; or who come
 * last. */
vg_status vg_overlap_new(struct vg_overlap *f, const struct vg_owners *owners,
                         int first);
void vg_overlap_release(struct vg_overlap *f);

/* Cells of a piece that others take the place of. */
struct vg_edit {
  uint8_t *gone; /* [q.n_cell] or NULL: none */
  size_t n_cell, n_point;
  uint32_t (*cell)[4]; /* [n_cell] vertices of q, then further ones: */
  uint64_t *name;      /* [n_point] */
  double (*x)[3];      /* [n_point] */
};

void vg_edit_release(struct vg_edit *c);

/** Put a change into a piece; points of others that are not used any more are
 * dropped. (repair_edit.c) */
vg_status vg_piece_edit(struct vg_piece *q, const struct vg_edit *c);

/** Swap in a field, where no other owner does and no earlier one moves a
 * point. What goes is noted in out->gone and in the halos, what comes is part
 * of the field. (repair_swap.c) */
vg_status vg_overlap_swap(struct vg_overlap *f, struct vg_edit *out,
                          size_t *n_swap);

/** The new cells, as they end. */
vg_status vg_overlap_take(const struct vg_overlap *f, struct vg_edit *out);

enum { VG_LEVEL_MAX = 64 };

/* Balls, to be found by points in them. A grid cell can meet many balls, which
 * base/table.h does not store, and its key takes 32 bytes. Here a ball takes 4
 * bytes for each of the at most 8 cells that it meets, and 32 to 64 bytes of
 * slots. A slot can list balls of other cells; their distance excludes them. */
struct vg_spot_grid {
  size_t n;
  const struct vg_spot *spot; /* [n] borrowed */
  uint32_t *cluster;          /* [n] or VG_NO_CLUSTER: to be done later */
  size_t n_cluster;
  int n_level, level[VG_LEVEL_MAX]; /* binary exponents of the radii */
  double share[VG_LEVEL_MAX];       /* grid cells of each level to a length */
  unsigned shift;                   /* 64 minus the logarithm of the slots */
  uint32_t *first, *ball; /* [slots + 2] into ball, by hash of grid cells */
};

/** Leave out balls around what is deep in others. */
vg_status vg_spots_thin(size_t *n, struct vg_spot *spot, struct vg_error *err);

/** Join balls that overlap to clusters, numbered by their first ball. Balls
 * that would make a cluster of more than `most` are left for later. */
vg_status vg_spot_grid_new(size_t n, const struct vg_spot *spot, size_t most,
                           struct vg_spot_grid *out, struct vg_error *err);
void vg_spot_grid_release(struct vg_spot_grid *b);

/** The cluster in whose balls x is, or VG_NO_CLUSTER. Threads: safe. */
uint32_t vg_spot_grid_at(const struct vg_spot_grid *b, const double x[3]);

/* --- what (repair_cluster.c) --------------------------------------------- */

/* Cells of one piece for a cluster, as they travel. */
struct vg_cluster_cells {
  uint32_t cluster;
  char path[VG_PATH_MAX]; /* of the piece */
  uint64_t n_point, n_cell;
  uint64_t *name;      /* [n_point] */
  double (*x)[3];      /* [n_point] */
  uint8_t *hold;       /* [n_point] 1: in a ball, but not all its cells
                          are the cluster's */
  uint32_t (*cell)[4]; /* [n_cell] */
};

void vg_cluster_cells_release(struct vg_cluster_cells *b);
void vg_cluster_cells_put(struct vg_writer *w,
                          const struct vg_cluster_cells *b);
/** Sets r->bad, and leaves *b empty, where the data cannot be. */
void vg_cluster_cells_get(struct vg_reader *r, struct vg_cluster_cells *b);

/* --- the boundary (repair_boundary.c) ------------------------------------ */

/* Its triangles between points that clusters have: a sheet with cells on both
 * sides cannot be told from other faces of three boundary points by the cells
 * alone. */
struct vg_repair_boundary {
  size_t n;
  uint32_t (*tri)[3]; /* [n] smallest point first, in rising order */
};

/** Triangles between the points of block [n]; boundary may be NULL. */
vg_status vg_repair_boundary_new(const struct vg_mesh *boundary, size_t n,
                                 const struct vg_cluster_cells *block,
                                 struct vg_repair_boundary *out,
                                 struct vg_error *err);
void vg_repair_boundary_release(struct vg_repair_boundary *r);

/** Is there a triangle of these points, of the front? */
int vg_repair_boundary_has(const struct vg_repair_boundary *r,
                           const uint32_t v[3]);

/* --- what came of it (repair_cluster.c) ---------------------------------- */

/* What became of a cluster. */
struct vg_repaired {
  int better;                 /* 0: the cells stay as they were */
  uint64_t n_cell;            /* of the cluster */
  uint64_t n_bad, n_bad_left; /* cells below VG_SHAPE_TARGET before, after */
  double worst, worst_left;   /* as vg_shape */
  struct vg_piece piece;      /* without path and serial */
  size_t n_moved;
  uint64_t *moved; /* [n_moved] points of others that moved */
  double (*x)[3];  /* [n_moved] to here */
  size_t n_spot, cap_spot;
  struct vg_spot *spot; /* [n_spot] around cells that stayed bad */
};

void vg_repaired_release(struct vg_repaired *m);

/** Improve the cells of a cluster. block: [n] by path. */
vg_status vg_repair_cluster(size_t n, const struct vg_cluster_cells *block,
                            const struct vg_spot_grid *balls,
                            const struct vg_repair_boundary *boundary,
                            const struct vg_sizing *sizing,
                            struct vg_repaired *out, struct vg_error *err);

/* --- how long (repair_record.c) ------------------------------------------- */

/** A task's time, from its begin to its end in the same thread. what: part of
 * the path, with which and number it is one of its kind. */
void vg_repair_begin(struct vg_span *s, int worker);
void vg_repair_end(struct vg_span *s, const char *what, size_t number,
                   size_t n_cell);

/** Put the tasks of all ranks, own and others', into the record of the run.
 * begin: when repairs began on this rank. own: its times are since then, and
 * its rank is told, afterwards. Collective. */
vg_status vg_repair_record(const struct vg_partition *p, struct vg_comm *comm,
                           double begin, struct vg_spans *own,
                           struct vg_spans *spans, struct vg_error *err);

#endif
