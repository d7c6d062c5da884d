/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/node.h: a node of the decomposition tree: one void from the
 * plan of its cut to its children. For the modules of partition alone.
 *
 * A cut goes through stages (lattice.h draws them). All tasks of a stage get
 * parts of the same front, and their changes are inserted together:
 *
 *    pJ0  vg_node_start   plan planes; regions of stage 0, a vg_work for each
 *           |
 *         pP..  pT..      tasks on any rank: cells along a line (pencil) or a
 *           |             plane (tile); cells stay there, a vg_change returns
 *           v
 *    pJi  vg_node_join    insert the changes into the front (vg_node_put),
 *           |      ^      select the parts of the front for the next stage
 *           |      |
 *           |      +----  pencils, segments, ribs, tiles, then boxes and
 *           v             patches where the void is still connected
 *         vg_node_split   no stage left: divide the front by blocks
 *           |
 *           +--> p.0, p.1, ...   children: cut again, or leaves (p.0L) */
#ifndef VG_PARTITION_CUT_NODE_H
#define VG_PARTITION_CUT_NODE_H

#include <pthread.h>
#include <stdatomic.h>

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "partition/cut/doubled.h"
#include "partition/cut/partition.h"
#include "partition/cut/select.h"
#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"
#include "partition/engine/spans.h"

/* A leaf that needs this many times the expected points, or the points of this
 * many times the leaf size if that is more, is cut again. */
#define VG_OUTGROWN 2.0 /* C8 */

struct vg_work;

/* Bit in the number of a block: the point is on a plane, in the block below. */
#define VG_ON_PLANE 0x8000u

typedef char vg_path[VG_PATH_MAX];

struct vg_node {
  struct vg_node *next, **link; /* Links of the list of nodes being cut on
                                   this rank. */
  uint64_t number;              /* Number in this list, for messages. */
  char path[VG_PATH_MAX];
  struct vg_front front;
  struct vg_load load;
  double per_cube;  /* Cells per cube of the spacing, as observed in the
                       zones of its ancestors. */
  int levels;       /* Remaining bisections, in a partition by levels. */
  int retry;        /* Failed attempts. */
  int is_final;     /* 1: filled whatever its size. */
  double fill_work; /* Of a leaf, see vg_front_work; 0: not known. */
  int to_part; /* 1: decomposed by a maker (decomposition.h), not by planes. */
  double
    other_seconds; /* Processor time in s spent on it in other processes. */
  uint32_t serial; /* Serial of its leaf; 0: none yet. */
  /* Used while it is being cut: faces keep their index and are marked with
   * VG_FACE_GONE. */
  size_t cap_x, cap_id, cap_face; /* Capacities of the front's arrays; 0:
                                     equal to their sizes. */
  struct vg_select select;
  size_t n_block, cap_block;
  uint16_t *block; /* [n_block] Block of each point of the front, with or
                      without VG_ON_PLANE. */
  size_t n_seen;   /* Faces examined so far for `open`. */
  size_t n_open, cap_open;
  uint32_t *open; /* [n_open] Faces that are in no block, ascending; some of
                     them may be gone. */
  int is_planned; /* 1: the next two members match the present load and
                     retry. */
  int n_bisection;
  struct vg_lattice lattice;
  int n_join;
  int stage;                /* Next stage. */
  size_t n_work, n_left;    /* Tasks of this stage; those not yet done. */
  struct vg_work **work;    /* [n_work] Until submitted. */
  struct vg_region *region; /* [n_work] Region of each task. */
  uint32_t **point, **face; /* [n_work] Points and faces of the front that
                               each task was given. */
  struct vg_change *change; /* [n_work] Change that each task returned. */
  double separator_cells, zone_volume;
  size_t n_pencil;  /* Pencils so far; numbers continue across stages. */
  size_t n_patch;   /* Boxes and patches so far; their numbers continue too. */
  size_t n_blocked; /* Tasks that made nothing, or cells that cross the
                       front. */
  size_t n_child;
  struct vg_node **child; /* [n_child] Child nodes created by the cut. */
};

/* Input of a task. */
enum { VG_WORK_START, VG_WORK_JOIN, VG_WORK_ZONE, VG_WORK_LEAF };

struct vg_work {
  int what;
  struct vg_node *node; /* START, LEAF: owned; JOIN, ZONE: borrowed, at home
                           only. */
  uint64_t home_node; /* On other ranks, the number of the node at its home. */
  uint32_t serial;    /* For ZONE and LEAF. */
  /* for ZONE only: */
  char path[VG_PATH_MAX];
  char kind;
  size_t index;
  double estimate;
  struct vg_front part;
  struct vg_region region;
};

struct vg_partition {
  int rank, size;
  struct vg_mesh boundary;   /* Boundary of the whole void; its arrays are
                                borrowed. */
  struct vg_doubled doubled; /* Points of its inner surfaces. */
  const struct vg_sizing *sizing;
  struct vg_partition_options options;
  const char *stage; /* Name for progress: "fill", "recut". */
  atomic_uint_fast32_t n_serial;
  pthread_mutex_t lock; /* Guards the members below. */
  size_t n_piece, cap_piece;
  struct vg_piece *piece; /* Submeshes that this rank made. */
  size_t n_drop, cap_drop;
  uint32_t *drop; /* Serials of zones, in nodes of this rank, whose changes
                     were rejected. */
  size_t n_unfilled, cap_unfilled;
  struct {
    struct vg_node *node;
    struct vg_error why;
  } * unfilled;
  struct vg_partition_report report;
  struct vg_node *cutting; /* List of nodes being cut; those left after a
                              stop are freed. */
  uint64_t n_cutting;      /* Last number given to a node in the list. */
  /* numbering: */
  struct vg_slices slices;
  size_t n_place;
  struct vg_place_of {
    uint32_t serial;
    uint64_t point;
  } * place;                     /* Sorted by serial. */
  uint64_t *point_at, *cell_at;  /* [n_piece] First point and cell number of
                                    each piece. */
  uint32_t *domain;              /* [n_piece] Subdomain number of each piece. */
  uint32_t *front_id;            /* [boundary->n_point] 0, 1, ... */
  struct vg_mesh boundary_faces; /* The boundary without points. */
};

/** Reports progress to the callback of the options, on rank 0. */
static inline void vg_partition_tell(const struct vg_partition *p,
                                     const char *stage, size_t done,
                                     size_t expected)
{
  if (!p->rank) vg_tell(&p->options.progress, stage, done, expected);
}

/** Returns a serial that no other task on any rank has. Threads: safe. */
uint32_t vg_partition_serial(struct vg_partition *p);

void vg_node_free(struct vg_node *n);
void vg_work_free(struct vg_work *w);

/** Creates a node with a front, which it takes over. NULL: no memory. */
struct vg_node *vg_node_new(const char *path, struct vg_front *front);

/** Should the void be cut? Plans the planes, which vg_node_start uses. Set
 * n->is_planned to 0 after changing the load. */
int vg_node_wants_cut(const struct vg_partition *p, struct vg_node *n);

/** Makes the tasks of the first stage that has any. If no stage has any,
 * n->n_work is 0 and n->n_child is 1 (the node itself, to be filled). */
vg_status vg_node_start(struct vg_partition *p, struct vg_node *n,
                        const struct vg_engine *e, struct vg_error *err);

/** Inserts the changes of a stage into the front, and makes the tasks of the
 * next stage or, when no stage is left, the children. */
vg_status vg_node_join(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err);

/** Inserts the changes of the tasks into the front, except for changes that
 * cross it: these count as blocked, and their cells are dropped. Releases all
 * changes, and the lists of points and faces given to the tasks.
 * (node_put.c) */
vg_status vg_node_put(struct vg_partition *p, struct vg_node *n,
                      const struct vg_engine *e, struct vg_error *err);

/** The point of the front that has index v in the change of task i, whose new
 * points are in the front from `first` on. */
static inline uint32_t vg_node_point(const struct vg_node *n, size_t i,
                                     size_t first, uint32_t v)
{
  size_t n_part = n->change[i].n_part;

  return v < n_part ? n->point[i][v] : (uint32_t)(first + v - n_part);
}

/** Does a new face in the change of task i, whose points are in the front
 * already, intersect a face that the task was not given, other than at shared
 * corners and edges, or do its cells contain such a face? Exact. -1: no memory
 * for the test.
 * Cost: proportional to the faces that leave the band that the task was given,
 * which are few. Threads: safe. (node_cross.c) */
int vg_node_crosses(const struct vg_node *n, size_t i, size_t first);

/** Marks the cells of a zone to be dropped when all tasks are done. Threads:
 * safe. */
vg_status vg_partition_note_drop(struct vg_partition *p,
                                 const struct vg_change *c,
                                 struct vg_error *err);

/** Drops the marked cells when all tasks are done, also in *spans, which may be
 * NULL. Collective. (drop.c) */
vg_status vg_partition_drop(struct vg_partition *p, struct vg_comm *comm,
                            struct vg_spans *spans, struct vg_error *err);

/** Sets the cell count of the tasks with these paths [n_path] to 0 in *spans,
 * which may be NULL, because their cells were dropped. Only the rank that had
 * a piece knows its path, and the spans of all ranks are on rank 0.
 * Collective. (drop.c) */
vg_status vg_partition_forget_spans(struct vg_partition *p,
                                    struct vg_comm *comm, size_t n_path,
                                    vg_path *path, struct vg_spans *spans,
                                    struct vg_error *err);

/** Sets aside the node of a leaf that cannot be filled. The node is taken over,
 * except on failure. Threads: safe. (recut.c) */
vg_status vg_recut_note_leaf(struct vg_partition *p, struct vg_node *n,
                             const struct vg_error *why, struct vg_error *err);
void vg_recut_release(struct vg_partition *p);

/** Makes larger voids, to be filled without cuts, around the leaves that
 * were set aside, when all tasks are done. The pieces in them are dropped,
 * also in *spans, which may be NULL. Cost: proportional to the adjacent
 * pieces. Collective.
 * n_void out: number on all ranks; node out: [*n] nodes of this rank; the
 * caller frees *node and the nodes, also on failure.
 * VG_ERR_GEOMETRY, with the original reason, if a leaf has no adjacent
 * piece. */
vg_status vg_recut_voids(struct vg_partition *p, struct vg_comm *comm,
                         struct vg_spans *spans, size_t *n_void,
                         struct vg_node ***node, size_t *n,
                         struct vg_error *err);

/** New leaves adopt those points of removed pieces that other pieces also use.
 * Adopted points are moved behind the other points of the leaf's front and get
 * ids with the leaf's serial; all pieces that use them are updated to the new
 * ids. Collective.
 * own: [n_own] serials of the pieces that this rank removed; node: [n], with
 * serials; k: their numbers, equal on all ranks. (recut_ids.c) */
vg_status vg_recut_adopt(struct vg_partition *p, struct vg_comm *comm,
                         size_t n_own, const uint32_t *own, size_t n,
                         struct vg_node *const *node, const uint32_t *k,
                         struct vg_error *err);

/** vg_recut_front makes the front that the cells of a piece fill; *f is empty
 * before. vg_recut_settle removes faces that occur in both orientations, unless
 * they are the sides of an inner surface, and sorts faces and points by
 * coordinates alone; VG_ERR_GEOMETRY if a face occurs twice. The caller
 * releases *f also on failure. (recut_front.c) */
vg_status vg_recut_front(const struct vg_doubled *d, const struct vg_piece *q,
                         struct vg_front *f, struct vg_error *err);
vg_status vg_recut_settle(const struct vg_doubled *d, struct vg_front *f,
                          struct vg_error *err);

/** Is a face with these points inside one block, not touching a plane? */
static inline int vg_node_is_in_block(const uint16_t *block,
                                      const uint32_t v[3])
{
  return block[v[0]] == block[v[1]] && block[v[0]] == block[v[2]] &&
         !(block[v[0]] & VG_ON_PLANE);
}

/** Updates n->open: O(faces added since the last call + listed faces).
 * (node_put.c) */
vg_status vg_node_list_open(struct vg_node *n, const struct vg_engine *e,
                            struct vg_error *err);

/** Finds regions where the void is still connected across planes of the lattice
 * after its stages: for axis -1 boxes to be filled, for an axis 0 to 2 patches
 * of the planes normal to it. If there are too many, none are returned
 * (report.n_open_left).
 * region out: [*n_region], freed by the caller. (node_close.c) */
vg_status vg_node_open_places(struct vg_partition *p, struct vg_node *n,
                              int axis, const struct vg_engine *e,
                              struct vg_region **region, size_t *n_region,
                              struct vg_error *err);

/** Makes the children of a node that a maker decomposes, and plans them.
 * Interface points are owned by leaves: each leaf has its own behind the other
 * points of its front, with ids of its serial. (node_part.c) */
vg_status vg_node_part(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err);

/** Options of the decomposition of a node. (node_part.c) */
struct vg_decomposition_options vg_node_decomposition(
  const struct vg_partition *p, const struct vg_node *n);

/** Computes the children's loads from the node's load and their fronts; cells
 * are multiplied by `correction` (vg_load_split). (node_split.c) */
vg_status vg_node_share_load(struct vg_node *n, double correction,
                             const struct vg_engine *e, struct vg_error *err);

/** Plans the children. (node_split.c) */
void vg_node_plan_children(const struct vg_partition *p, struct vg_node *n,
                           const struct vg_engine *e);

/** Divides the front by blocks: makes n->child, planned. (node_split.c) */
vg_status vg_node_split(struct vg_partition *p, struct vg_node *n,
                        const struct vg_engine *e, struct vg_error *err);

/** Makes the cells of a zone or leaf task, and keeps the piece.
 * change out: the change for the home rank. outgrown out: 1: overloaded,
 * nothing was made. (work.c) */
vg_status vg_work_zone(struct vg_partition *p, const struct vg_work *w,
                       struct vg_change *change, const struct vg_engine *e,
                       struct vg_error *err);
vg_status vg_work_leaf(struct vg_partition *p, const struct vg_work *w,
                       int *outgrown, size_t *n_cell, const struct vg_engine *e,
                       struct vg_error *err);

/** Numbers the points and cells of all ranks, and serves them as slices.
 * Collective. (number.c) */
vg_status vg_partition_number(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_error *err);

#endif
