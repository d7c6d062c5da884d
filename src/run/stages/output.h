/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/output.h: the files of a run. They are written into a hidden
 * folder next to their final location and moved there together at the end, so
 * that a run that fails or is stopped leaves no incomplete files. */
#ifndef VG_RUN_STAGES_OUTPUT_H
#define VG_RUN_STAGES_OUTPUT_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "run/commit/commit.h"
#include "run/input/input.h"
#include "run/layers/layers.h"
#include "run/settings/lists.h"

struct vg_slices_ugrid;
struct vg_plane_mesh;

struct vg_outputs {
  char *dir, *name; /* Target folder ("." if none is given), base name. */
  int made_dir;     /* 1: dir did not exist; removed again if it stays empty. */
  struct vg_commit commit; /* On rank 0, from vg_outputs_claim. */
  char *temp_dir;          /* Hidden folder while writing, or NULL. */
  int is_guest; /* 1: another rank makes and removes the hidden folder. */
  size_t n_item;
  char item[VG_WRITE_ITEMS][VG_WRITE_NAME];
  size_t n_open;     /* Number of entries of `open`. */
  uint64_t put_time; /* Nanoseconds in vg_outputs_put, all threads. */
  struct vg_slices_ugrid *open[VG_WRITE_ITEMS];
  const struct vg_plane_mesh *plane; /* Mesh of a plane section; borrowed. */
  int drops_sheets; /* 1: STEM.sheets of an earlier mesh is removed. */
  size_t n_file, cap_file;
  /* is_case: a folder with an OpenFOAM mesh. A suffix that begins with '_'
   * follows the name without a dot. */
  struct vg_outputs_file {
    char *suffix;
    int keep_old, is_case;
    uint64_t bytes, digest[2]; /* Set by vg_outputs_digest. */
  } * file;
};
#define VG_OUTPUTS_INIT                                                        \
  {                                                                            \
    .n_item = 0                                                                \
  }

void vg_outputs_release(struct vg_outputs *o);

/** Do both paths name the same existing file? Then writing one destroys the
 * other. NULL and "" name none. */
int vg_is_same_file(const char *a, const char *b);

/** Determines where files are written, and checks that this is possible.
 *
 * @param stem  determines the names of the files
 * @param dir   NULL: the folder of the stem; created if absent */
vg_status vg_outputs_place(const char *stem, const char *dir,
                           struct vg_outputs *o, struct vg_error *err);

/** Distributes the name of the hidden folder, and makes it if that has not been
 * done. Collective. Each file then comes from vg_outputs_new. */
vg_status vg_outputs_begin(struct vg_outputs *o, struct vg_comm *comm,
                           struct vg_error *err);

/** Is a mesh in two dimensions written in this format of the list? */
int vg_outputs_has_plane(const struct vg_outputs *o, const char *item);

/** Writes o->plane on rank 0. Collective. run/stages/output_plane.c. */
vg_status vg_outputs_plane(struct vg_outputs *o, struct vg_comm *comm,
                           const char *item, struct vg_error *err);

/** Is the mesh written in a format to which STEM.sheets belongs? */
int vg_outputs_need_sheets(const struct vg_outputs *o);

/** VG_ERR_INPUT if sheets are requested, and none of the formats holds them. */
vg_status vg_outputs_check_sheets(const struct vg_outputs *o,
                                  const struct vg_settings *s,
                                  struct vg_error *err);

/** VG_ERR_INPUT if a format of the list needs zones, and the final surface has
 * no interfaces. */
vg_status vg_outputs_check_zones(const struct vg_outputs *o,
                                 const struct vg_mesh *surface,
                                 struct vg_error *err);

/** Notes for the formats of the write list that lose the sheets of m. */
void vg_outputs_note_sheets(const struct vg_outputs *o, const struct vg_mesh *m,
                            struct vg_notes *notes);

/** Writes the sheets of m to STEM.sheets, which is added to the files. If m has
 * no sheets, such a file of an earlier mesh is removed by vg_outputs_commit. A
 * STEM.sheets that Vanguard did not write stays, with a note. On rank 0, after
 * the files of the mesh have been written, one of which is in a format to which
 * STEM.sheets belongs.
 *
 * @param n_point, n_cell  of the whole mesh */
vg_status vg_outputs_sheets(struct vg_outputs *o, const struct vg_mesh *m,
                            uint64_t n_point, uint64_t n_cell,
                            struct vg_notes *notes, struct vg_error *err);

/** Registers the pieces of a .pvtu, which are found by their names. */
vg_status vg_outputs_pieces(struct vg_outputs *o, const char *stem,
                            struct vg_error *err);

/* Periodic patches of a mesh, by the numbers of its points and faces. */
struct vg_output_links {
  struct vg_mesh boundary;
  struct vg_periodic *pair;        /* [links.n] */
  struct vg_periodic_match *match; /* [links.n] */
  struct vg_periodic_links links;
};

/** Finds them on all ranks. *l: in: zero. Collective. Release also on
 * failure. */
vg_status vg_output_links_find(const struct vg_pairs *pairs,
                               struct vg_comm *comm,
                               const struct vg_slices *mesh, int threads,
                               struct vg_output_links *l, struct vg_error *err);
void vg_output_links_release(struct vg_output_links *l);

/** Writes STEM.periodic.cfg (io/periodic/periodic_cfg.h) for .su2 and .ugrid,
 * on rank 0. */
vg_status vg_outputs_periodic(struct vg_outputs *o,
                              const struct vg_output_links *l,
                              struct vg_error *err);

/** Parses the write list and determines where files are written. Refuses files
 * that would overwrite an input of p.
 *
 * @param stem, dir  as for vg_outputs_place
 * @param list       as from vg_resolve_write */
vg_status vg_outputs_plan(const struct vg_problem *p, const char *stem,
                          const char *dir, const char *list,
                          struct vg_outputs *o, struct vg_error *err);

/** Makes the hidden folder and locks the names o->name.* in the target folder
 * against other processes, until vg_outputs_commit or vg_outputs_release. The
 * files of runs that were killed are completed, restored or removed, and noted
 * (run/commit/commit.h). On rank 0, before vg_outputs_begin.
 *
 * VG_ERR_INPUT: another process has the lock; the message names it. */
vg_status vg_outputs_claim(struct vg_outputs *o, struct vg_notes *notes,
                           struct vg_error *err);

/** Called once the surface is final, before the fill: an existing .mapbc that
 * is an input is kept, and must contain every patch. */
vg_status vg_outputs_check(const struct vg_problem *p, struct vg_outputs *o,
                           struct vg_error *err);

/** Path of STEM.suffix while it is being written; free() it. */
char *vg_outputs_temp_path(struct vg_outputs *o, const char *suffix);

/** Final path of STEM.suffix, for reports; free() it. NULL: no memory, and
 * vg_print_is_lost. */
char *vg_outputs_final(const struct vg_outputs *o, const char *suffix);

/** vg_outputs_begin, and opens in the hidden folder the files that can be
 * written slice by slice while slices are in memory for another purpose.
 * Before they are closed, every slice must be passed to vg_outputs_put, a
 * vg_slice_body, once. Open files are closed with st, the status of this rank.
 * Open and close: collective, with the same status on all ranks. o NULL:
 * nothing is written. */
vg_status vg_outputs_open(struct vg_outputs *o, const struct vg_problem *p,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          struct vg_error *err);
vg_status vg_outputs_put(void *outputs, const struct vg_slice *slice,
                         struct vg_error *err);
vg_status vg_outputs_close(struct vg_outputs *o, vg_status st,
                           struct vg_error *err);

/** Writes the mesh in all other requested formats, the resolved deck, and the
 * walls with their layers, if any; notes are added to those of p. Collective.
 * Formats that io/slices/slices.h
 * does not write are written from a copy of the whole mesh, by a single rank.
 * Called after vg_outputs_close. */
vg_status vg_outputs_mesh(struct vg_outputs *o, struct vg_problem *p,
                          const struct vg_layer_stage *layers,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          int threads, struct vg_error *err);

/** Computes size and XXH3 digest of every file. On rank 0. */
vg_status vg_outputs_digest(struct vg_outputs *o, struct vg_error *err);

/** Brings all files written so far to the disk. vg_outputs_commit does it as
 * well; the time of meshes is measured here. On rank 0. */
vg_status vg_outputs_sync(const struct vg_outputs *o, struct vg_error *err);

/** Returns st. After a failure, file names of the hidden folder in the message
 * become those of the target folder. */
vg_status vg_outputs_failed(const struct vg_outputs *o, vg_status st,
                            struct vg_error *err);

/** Registers STEM.suffix, and returns the path at which the caller writes it;
 * free() it. NULL if it fails. */
vg_status vg_outputs_new(struct vg_outputs *o, const char *suffix, char **path,
                         struct vg_error *err);

/** Registers a file that the caller writes into the hidden folder. */
vg_status vg_outputs_add(struct vg_outputs *o, const char *suffix,
                         struct vg_error *err);

/** Moves all files into place, or none, and removes the hidden folder. When it
 * returns VG_OK all files are on the disk. VG_ERR_MEMORY: a note of the report
 * was lost (vg_print_is_lost). On rank 0. */
vg_status vg_outputs_commit(struct vg_outputs *o, struct vg_error *err);

#endif
