/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/judge_slices_parts.h: declarations shared by the files of
 * judge_slices.c. Private.
 *
 * First, every thread checks slices one by one (judge_slice.c) and keeps the
 * data that other slices need. Then positions, faces and edges are matched
 * (judge_match.c), and faces and cells for the figures in the terms of solvers
 * (judge_solver.c). Finally the figures are summed and reported
 * (judge_slices.c). */
#ifndef VG_CORE_JUDGE_JUDGE_SLICES_PARTS_H
#define VG_CORE_JUDGE_JUDGE_SLICES_PARTS_H

#include <stdatomic.h>

#include "base/rendezvous.h"
#include "base/table.h"
#include "core/judge/judge_slices.h"
#include "core/judge/quality_solver.h"

enum { VG_JUDGED_WHOLE, VG_JUDGED_FIELD, VG_JUDGED };

/* Bits of face_item.flags. */
enum {
  VG_FACE_WINDING = 1, /* as in quality_faces.c, by index in the mesh */
  VG_FACE_BOUNDARY = 2,
  VG_FACE_FIELD = 4
};

struct vg_face_item {
  uint32_t node[4];   /* lowest node, lower and upper one of its neighbours,
                         and the opposite node of a quad or VG_NO_NODE */
  uint32_t component; /* component of its cell: number on the rank, later in
                         the mesh */
  float volume;       /* volume of its cell */
  uint32_t flags;
};

/* A face, identified by its nodes. */
struct vg_face_key {
  uint32_t node[4];
};

struct vg_edge_item {
  uint32_t node[2]; /* lower, upper node */
  double ratio;     /* length / target, or length in the metric; < 0: the edge
                       is on the boundary of the checked cells */
};

struct vg_place_item {
  double x[3];
};

/* Adding 0 makes -0 and +0 the same position. */
static inline struct vg_place_item vg_place_item(const double x[3])
{
  return (struct vg_place_item){ { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 } };
}

/** Data of one thread. */
struct vg_judge_worker {
  struct vg_item_blocks face, edge;
  struct vg_item_blocks place; /* keys of positions */
  /* For the figures in the terms of solvers: sweep over the present slice,
   * sides of faces between slices, and cells that have several of them. */
  struct vg_solver_sweep solver;
  struct vg_item_blocks side, rest;
  struct vg_item_blocks dual_face, dual_point; /* parts of the median dual */
  struct vg_items crowd;   /* keys that several points have */
  struct vg_items suspect; /* keys of faces that do not join two sides */
  /* Figures of slices: first of layers and of the field; later of the whole
   * mesh and of the field. */
  struct vg_stats *figures[VG_JUDGED];
  /* [n_parent] union-find forests: components of this rank that exist so far,
   * later [n_all]. */
  uint32_t *parent[VG_JUDGED];
  size_t n_parent, room_parent[VG_JUDGED];
  double lo[3], hi[3]; /* bounding box of the points */
  uint64_t n_cell[VG_SLICE_KINDS], n_field_component;
  size_t slice_bytes; /* arrays of the largest slice */
  vg_status st;
  struct vg_error err;
};

struct vg_slices_judgement {
  struct vg_comm *comm;
  const struct vg_slices *s;
  const struct vg_sizing *sizing;
  int threads, n_judged;      /* n_judged 1: no report of the field */
  int has_dual;               /* 1: measure the median dual */
  int in_metric;              /* 1: measure lengths and cells in the metric */
  int edges_of;               /* VG_JUDGED_...: whole mesh or field for the edge
                                 statistics and flat cells */
  const struct vg_flat *flat; /* NULL: do not classify flat cells */
  vg_slice_body body;         /* called for valid slices; may be NULL */
  void *context;              /* argument of body */
  int n_worker;
  struct vg_judge_worker *worker;
  size_t n_word;             /* number of words with one bit per point of the
                                mesh */
  uint64_t *used[VG_JUDGED]; /* [n_word] points used by cells */
  size_t n_place;
  double (*place)[3];          /* [n_place] positions of the boundary's
                                  points */
  atomic_uint_fast64_t n_here; /* components of the slices of this rank */
  uint64_t first_here;         /* number of the first one in the mesh */
  uint64_t n_all, n_all_field; /* sums of the components of all slices */
  struct vg_table bound;       /* faces of the boundary by their nodes */
  struct vg_waiting_items waiting_side; /* sides of faces of all threads */
  struct vg_waiting_items waiting; /* faces of all threads whose other sides
                                      are in slices not yet checked */
  /* Faces that did not join two sides when all other faces were matched in
   * slices: sorted, of all ranks, known on all ranks. */
  size_t n_suspect;
  struct vg_face_key *suspect;
  size_t bytes; /* largest memory of the data that slices share so far */
};

/** Set the canonical form of a face with these nodes in the mesh, in cyclic
 * order. node[3] is VG_NO_NODE for a triangle. */
void vg_face_item_set(struct vg_face_item *f, const uint32_t node[4]);

/** Update j->bytes with the present lists and `more` bytes. */
void vg_judge_note_bytes(struct vg_slices_judgement *j, size_t more);

/** Check slices first .. end - 1; a body of vg_parallel_for on j. */
void vg_judge_some_slices(void *j, size_t first, size_t end, int worker);

/** Comparison of keys, for qsort and bsearch. */
int vg_face_key_order(const void *a, const void *b);

/** Hand the faces of a thread over to those that wait, and match the ones that
 * are complete if many wait. Threads: safe. */
vg_status vg_judge_thin(struct vg_slices_judgement *j, int worker,
                        struct vg_error *err);

/** Match positions, then faces, then edges. Collective. */
vg_status vg_judge_match(struct vg_slices_judgement *j, struct vg_error *err);

/** Prepare the figures in the terms of solvers, and release what they use. */
vg_status vg_judge_solver_init(struct vg_slices_judgement *j,
                               struct vg_error *err);
void vg_judge_solver_release(struct vg_slices_judgement *j);

/** Present memory, for vg_judge_note_bytes. */
size_t vg_judge_solver_bytes(const struct vg_slices_judgement *j);

/** Finish the sweep over a slice, whose own faces have been matched, and keep
 * the faces between slices. */
vg_status vg_judge_solver_slice(struct vg_slices_judgement *j, int worker,
                                const struct vg_slice *s,
                                struct vg_solver_sweep *sweep,
                                const struct vg_unpaired *unpaired,
                                struct vg_error *err);

/** Match the faces between slices. Collective. */
vg_status vg_judge_solver_match(struct vg_slices_judgement *j,
                                struct vg_error *err);

/** Is a face of a slice on the boundary of the mesh? */
int vg_judge_on_boundary(const struct vg_slices_judgement *j,
                         const struct vg_slice *s, const uint32_t local[4]);

/** judge_dual.c: measure the median dual of a slice, view, and keep its parts
 * of dual faces and control volumes between slices. */
vg_status vg_judge_dual_slice(struct vg_slices_judgement *j, int worker,
                              const struct vg_slice *s,
                              const struct vg_mesh *view, struct vg_stats *f,
                              const struct vg_unpaired *unpaired,
                              struct vg_error *err);

/** Match the parts of dual faces, then those of control volumes. Collective. */
vg_status vg_judge_dual_match(struct vg_slices_judgement *j,
                              struct vg_error *err);
void vg_judge_dual_release(struct vg_slices_judgement *j);
size_t vg_judge_dual_bytes(const struct vg_slices_judgement *j);

/** Unite the worst places of all ranks. Collective. */
vg_status vg_judge_solver_gather(struct vg_comm *comm, struct vg_stats *f,
                                 struct vg_error *err);

/** Count the components of cells. *n_component out: [n_judged]. Collective. */
vg_status vg_judge_components(struct vg_slices_judgement *j,
                              size_t *n_component, struct vg_error *err);

#endif
