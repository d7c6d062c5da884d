/* partition/cut/node.h: one void on its way through the advancing partition.
 * For the modules of partition alone. */
#ifndef VG_PARTITION_CUT_NODE_H
#define VG_PARTITION_CUT_NODE_H

#include <pthread.h>
#include <stdatomic.h>

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "partition/cut/partition.h"
#include "partition/cut/select.h"
#include "partition/cut/task_data.h"
#include "partition/engine/engine.h"
#include "partition/engine/spans.h"

/* A leaf that needs this many times the points that were expected is cut
 * again, as is one beyond this many times the leaf size. */
#define VG_OUTGROWN 2.0 /* C8 */

struct vg_work;

/* Beside the number of a block: the point is on a plane, in the block below. */
#define VG_ON_PLANE 0x8000u

typedef char vg_path[VG_PATH_MAX];

struct vg_node {
  struct vg_node *next, **link; /* nodes being cut on this rank */
  uint64_t number;              /* among these, for messages */
  char path[VG_PATH_MAX];
  struct vg_front front;
  struct vg_load load;
  double per_cube;  /* cells per cube of the spacing, as the zones of
                       its ancestors turned out */
  int levels;       /* bisections left, in a partition by levels */
  int retry;        /* attempts that failed */
  int is_final;     /* a leaf whatever it needs */
  double fill_work; /* of a leaf, see vg_front_work; 0: not known */
  int to_part;      /* by a maker of decompositions, not by planes */
  double elsewhere; /* s of processor time that this took in other
                       processes */
  uint32_t serial;  /* of its leaf; 0: none yet */
  /* while it is being cut: faces stay where they are, with VG_FACE_GONE */
  size_t cap_x, cap_id, cap_face; /* of the front; 0: just its size */
  struct vg_select select;
  size_t n_block, cap_block;
  uint16_t *block; /* [n_block] of the front's points: the block that
                      each is in, with VG_ON_PLANE or not */
  size_t n_seen;   /* faces that were looked at for the next list */
  size_t n_open, cap_open;
  uint32_t *open; /* [n_open] faces that lie in no block, rising;
                     of those seen, some may be gone */
  int is_planned; /* the next two are of this load, this retry */
  int n_bisection;
  struct vg_lattice lattice;
  int n_join;
  int stage;                /* the next one to be looked at */
  size_t n_work, n_left;    /* of this stage; not yet done */
  struct vg_work **work;    /* [n_work] until submitted */
  struct vg_region *region; /* [n_work] theirs */
  uint32_t **point, **face; /* [n_work] what of the front each was given */
  struct vg_change *change; /* [n_work] what came of it */
  double separator_cells, zone_volume;
  size_t n_pencil;  /* pencils so far: numbers go on */
  size_t n_patch;   /* boxes that closed what was left, likewise */
  size_t n_blocked; /* works that made nothing, or what crosses the
                       front */
  size_t n_child;
  struct vg_node **child; /* [n_child] what it fell into */
};

/* What a task is given. */
enum { VG_WORK_START, VG_WORK_JOIN, VG_WORK_ZONE, VG_WORK_LEAF };

struct vg_work {
  int what;
  struct vg_node *node; /* START, LEAF: owned; JOIN, ZONE: borrowed, at
                           its home only, */
  uint64_t home_node;   /* elsewhere its number there */
  uint32_t serial;      /* ZONE, LEAF */
  /* ZONE */
  char path[VG_PATH_MAX];
  char kind;
  size_t index;
  double estimate;
  struct vg_front part;
  struct vg_region region;
};

struct vg_partition {
  int rank, size;
  struct vg_mesh boundary; /* of the whole void; its arrays are borrowed */
  const struct vg_sizing *sizing;
  struct vg_partition_options options;
  const char *stage; /* for progress: "fill", "recut" */
  atomic_uint_fast32_t n_serial;
  pthread_mutex_t lock; /* of what follows */
  size_t n_piece, cap_piece;
  struct vg_piece *piece; /* what this rank made */
  size_t n_drop, cap_drop;
  uint32_t *drop; /* serials of the zones of nodes of this rank whose
                     changes were not put in */
  size_t n_unfilled, cap_unfilled;
  struct {
    struct vg_node *node;
    struct vg_error why;
  } * unfilled;
  struct vg_partition_report report;
  struct vg_node *cutting; /* what a stopped job leaves */
  uint64_t n_cutting;      /* numbers given to these so far */
  /* numbering */
  struct vg_slices slices;
  size_t n_place;
  struct vg_place_of {
    uint32_t serial;
    uint64_t point;
  } * place;                     /* by serial
                                  */
  uint64_t *point_at, *cell_at;  /* [n_piece] */
  uint32_t *domain;              /* [n_piece] */
  uint32_t *front_id;            /* [boundary->n_point] 0, 1, ... */
  struct vg_mesh boundary_faces; /* the boundary without points */
};

/** Tell the options' progress, on rank 0. */
static inline void vg_partition_tell(const struct vg_partition *p,
                                     const char *stage, size_t done,
                                     size_t expected)
{
  if (!p->rank) vg_tell(&p->options.progress, stage, done, expected);
}

/** A serial that no other task of any rank has. Threads: safe. */
uint32_t vg_partition_serial(struct vg_partition *p);

void vg_node_free(struct vg_node *n);
void vg_work_free(struct vg_work *w);

/** A new node around a front, which it takes over. NULL: no memory. */
struct vg_node *vg_node_new(const char *path, struct vg_front *front);

/** Does the void ask to be cut? Plans the planes, which vg_node_start uses;
 * after its load was changed n->is_planned must be 0. */
int vg_node_wants_cut(const struct vg_partition *p, struct vg_node *n);

/** The works of the first stage that has some. Without any, n->n_work is 0
 * and n->n_child 1 (itself, to be filled). */
vg_status vg_node_start(struct vg_partition *p, struct vg_node *n,
                        const struct vg_engine *e, struct vg_error *err);

/** Put the changes of a stage into the front; then the works of the next
 * stage, or, when there is none, the children. */
vg_status vg_node_join(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err);

/** Put the changes of the works into the front, but those that cross it: these
 * count as blocked, and their cells are dropped. All changes, and what the
 * works were given, are released. (node_put.c) */
vg_status vg_node_put(struct vg_partition *p, struct vg_node *n,
                      const struct vg_engine *e, struct vg_error *err);

/** The point of the front that is v in the change of work i, whose new points
 * are in the front from `first` on. */
static inline uint32_t vg_node_point(const struct vg_node *n, size_t i,
                                     size_t first, uint32_t v)
{
  size_t n_part = n->change[i].n_part;

  return v < n_part ? n->point[i][v] : (uint32_t)(first + v - n_part);
}

/** Does a new face in the change of work i, whose points are in the front
 * already, meet a face of it beyond what the work was given, corners and edges
 * that they have in common aside, or do its cells hold such a face? Exact. -1:
 * no memory to tell.
 * Cost: of faces that leave the band that the work was given, which are few.
 * Threads: safe. (node_cross.c) */
int vg_node_crosses(const struct vg_node *n, size_t i, size_t first);

/** Forget the cells of this zone when all tasks are done. Threads: safe. */
vg_status vg_partition_note_drop(struct vg_partition *p,
                                 const struct vg_change *c,
                                 struct vg_error *err);

/** Now they are: forget them, also in *spans, which may be NULL. Collective.
 * (drop.c) */
vg_status vg_partition_drop(struct vg_partition *p, struct vg_comm *comm,
                            struct vg_spans *spans, struct vg_error *err);

/** Tasks with these paths [n_path] made no cells of the mesh: say so in *spans,
 * which may be NULL. Only the rank that had a piece knows its path, spans of
 * all are on rank 0. Collective. (drop.c) */
vg_status vg_partition_forget_spans(struct vg_partition *p,
                                    struct vg_comm *comm, size_t n_path,
                                    vg_path *path, struct vg_spans *spans,
                                    struct vg_error *err);

/** Lay the node of a leaf that cannot be filled aside; it is taken over, but
 * on failure. Threads: safe. (recut.c) */
vg_status vg_recut_note_leaf(struct vg_partition *p, struct vg_node *n,
                             const struct vg_error *why, struct vg_error *err);
void vg_recut_release(struct vg_partition *p);

/** When all tasks are done: larger voids, to be filled uncut, around those that
 * were laid aside. What was made in them is forgotten, also in *spans, which
 * may be NULL. Cost: of what is beside them. Collective.
 * n_void out: of all ranks; node out: [*n] this rank's, *node to be freed by
 * the caller also on failure, with the nodes.
 * VG_ERR_GEOMETRY, with the reason, where there is nothing beside one. */
vg_status vg_recut_voids(struct vg_partition *p, struct vg_comm *comm,
                         struct vg_spans *spans, size_t *n_void,
                         struct vg_node ***node, size_t *n,
                         struct vg_error *err);

/** Leaves to come adopt the points of what was taken back that others have too:
 * behind the others on their fronts, with names of their serials; whoever has
 * the points knows them by these names from then on. Collective.
 * own: [n_own] serials of what this rank took back; node: [n], with serials, k:
 * their numbers, the same whoever has them. (recut_ids.c) */
vg_status vg_recut_adopt(struct vg_partition *p, struct vg_comm *comm,
                         size_t n_own, const uint32_t *own, size_t n,
                         struct vg_node *const *node, const uint32_t *k,
                         struct vg_error *err);

/** The front that the cells of a piece fill, *f empty before; of faces that
 * look both ways keep none, and bring faces and points into an order that
 * follows from their places alone: VG_ERR_GEOMETRY where a face is there twice.
 * *f is released by the caller also on failure. (recut_front.c) */
vg_status vg_recut_front(const struct vg_piece *q, struct vg_front *f,
                         struct vg_error *err);
vg_status vg_recut_settle(struct vg_front *f, struct vg_error *err);

/** Does a face with these points lie within one block, off all planes? */
static inline int vg_node_is_in_block(const uint16_t *block,
                                      const uint32_t v[3])
{
  return block[v[0]] == block[v[1]] && block[v[0]] == block[v[2]] &&
         !(block[v[0]] & VG_ON_PLANE);
}

/** Bring n->open up to date: O(faces added since, and listed). (node_put.c) */
vg_status vg_node_list_open(struct vg_node *n, const struct vg_engine *e,
                            struct vg_error *err);

/** Where the void hangs together across planes of the lattice after its
 * stages: boxes to be filled, for axis -1, then patches of the planes across
 * an axis. They are few, or none are given (report.n_open_left).
 * region out: [*n_region], to be freed by the caller. (node_close.c) */
vg_status vg_node_open_places(struct vg_partition *p, struct vg_node *n,
                              int axis, const struct vg_engine *e,
                              struct vg_region **region, size_t *n_region,
                              struct vg_error *err);

/** The children of a node that a maker parts, planned. Points of interfaces are
 * those of leaves: each has some behind the others on its front, by names of
 * its serial. (node_part.c) */
vg_status vg_node_part(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err);

/** What it asks a maker for. (node_part.c) */
struct vg_decomposition_options vg_node_decomposition(
  const struct vg_partition *p, const struct vg_node *n);

/** The children's loads, from the node's and their fronts; cells are multiplied
 * by `correction` (vg_load_split). (node_split.c) */
vg_status vg_node_share_load(struct vg_node *n, double correction,
                             const struct vg_engine *e, struct vg_error *err);

/** Plan the children, which are known now. (node_split.c) */
void vg_node_plan_children(const struct vg_partition *p, struct vg_node *n,
                           const struct vg_engine *e);

/** Part the front by blocks: n->child, planned. (node_split.c) */
vg_status vg_node_split(struct vg_partition *p, struct vg_node *n,
                        const struct vg_engine *e, struct vg_error *err);

/** Grow what a zone's or a leaf's work asks for; keeps the piece.
 * change out: what its home hears. outgrown out: 1: too large, nothing was
 * made. (work.c) */
vg_status vg_work_zone(struct vg_partition *p, const struct vg_work *w,
                       struct vg_change *change, const struct vg_engine *e,
                       struct vg_error *err);
vg_status vg_work_leaf(struct vg_partition *p, const struct vg_work *w,
                       int *outgrown, size_t *n_cell, const struct vg_engine *e,
                       struct vg_error *err);

/** Number what all ranks made, and serve it as slices. Collective.
 * (number.c) */
vg_status vg_partition_number(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_error *err);

#endif
