/* core/judge/judge_slices_parts.h: what the files of judge_slices.c share.
 * Private.
 *
 * First every thread judges slices one by one (judge_slice.c) and keeps what
 * others must know of; then faces, edges and places meet (judge_match.c); then
 * the figures are summed and reported (judge_slices.c). */
#ifndef VG_CORE_JUDGE_JUDGE_SLICES_PARTS_H
#define VG_CORE_JUDGE_JUDGE_SLICES_PARTS_H

#include "base/rendezvous.h"
#include "core/judge/judge_slices.h"
#include "core/judge/quality_parts.h"

enum { VG_JUDGED_WHOLE, VG_JUDGED_FIELD, VG_JUDGED };

/* What face_item.flags is made of; the slice is in the bits above. */
enum {
  VG_FACE_WINDING = 1, /* as in quality_faces.c, by index in the mesh */
  VG_FACE_BOUNDARY = 2,
  VG_FACE_FIELD = 4,
  VG_FACE_BITS = 3
};

struct vg_face_item {
  uint32_t node[4];   /* lowest, lower and upper of its neighbours, and
                         that across a quad or VG_NO_NODE */
  uint32_t component; /* of its cell: in its slice, then in the mesh */
  float volume;       /* of its cell */
  uint32_t flags;
};

/* Its nodes name a face. */
struct vg_face_key {
  uint32_t node[4];
};

struct vg_edge_item {
  uint32_t node[2]; /* lower, upper */
  double ratio;     /* length / target; < 0: not to be counted */
};

struct vg_place_item {
  double x[3];
};

/* -0 and +0 are the same place. */
static inline struct vg_place_item vg_place_item(const double x[3])
{
  return (struct vg_place_item){ { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 } };
}

/** Belongs to one thread. */
struct vg_judge_worker {
  struct vg_items face, edge;
  struct vg_items place;   /* keys of places */
  struct vg_items crowd;   /* of these, where several points may be */
  struct vg_items suspect; /* keys of faces that do not join two */
  /* Of slices: what is no field and what is; afterwards whole and field. */
  struct vg_stats *figures[VG_JUDGED];
  uint32_t *parent[VG_JUDGED]; /* [n_component of all] */
  double lo[3], hi[3];         /* of points */
  uint64_t n_cell[VG_SLICE_KINDS], n_field_component;
  vg_status st;
  struct vg_error err;
};

struct vg_slices_judgement {
  struct vg_comm *comm;
  const struct vg_slices *s;
  const struct vg_sizing *sizing;
  int threads, n_judged; /* n_judged 1: no report of the field */
  int edges_of;          /* VG_JUDGED_...: whose edges are measured */
  vg_slice_body body;    /* or NULL: for slices that are sound */
  void *context;         /* of body */
  int n_worker;
  struct vg_judge_worker *worker;
  size_t n_word;             /* one bit for each point of the mesh */
  uint64_t *used[VG_JUDGED]; /* [n_word] by cells */
  size_t n_place;
  double (*place)[3];          /* [n_place] where points of the boundary are */
  uint32_t *n_component;       /* [n_slice], then that of the first */
  uint64_t n_all, n_all_field; /* components of slices */
  /* Faces that did not join two when all but these were matched in slices:
   * sorted, of all ranks, on all ranks. */
  size_t n_suspect;
  struct vg_face_key *suspect;
};

/** Canonical form of a face with these nodes in the mesh, in cyclic order;
 * node[3] VG_NO_NODE for a triangle. */
void vg_face_item_set(struct vg_face_item *f, const uint32_t node[4]);

/** Judge slices first .. end - 1; a body of vg_parallel_for on j. */
void vg_judge_some_slices(void *j, size_t first, size_t end, int worker);

/** Order of keys, for qsort and bsearch. */
int vg_face_key_order(const void *a, const void *b);

/** Let faces meet, then edges, then places. Collective. */
vg_status vg_judge_match(struct vg_slices_judgement *j, struct vg_error *err);

/** *n_component out: [n_judged]. Collective. */
vg_status vg_judge_components(struct vg_slices_judgement *j,
                              size_t *n_component, struct vg_error *err);

#endif
