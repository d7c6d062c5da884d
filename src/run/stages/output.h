/* run/stages/output.h: the files of a run. They are written into a hidden
 * folder beside their place and moved there together at the end, so that a run
 * that fails or is stopped leaves nothing half-written. */
#ifndef VG_RUN_STAGES_OUTPUT_H
#define VG_RUN_STAGES_OUTPUT_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "run/input/input.h"
#include "run/input/layers.h"
#include "run/settings/lists.h"

struct vg_slices_ugrid;

struct vg_outputs {
  char *dir, *name; /* target folder ("." if none), base name */
  char *temp_dir;   /* hidden folder while writing, or NULL */
  int is_guest;     /* 1: another rank makes and removes it */
  size_t n_item;
  char item[VG_WRITE_ITEMS][VG_WRITE_NAME];
  size_t n_open;     /* of `item` */
  uint64_t put_time; /* nanoseconds in vg_outputs_put, all threads */
  struct vg_slices_ugrid *open[VG_WRITE_ITEMS];
  size_t n_file, cap_file;
  /* is_case: a folder with an OpenFOAM mesh. A suffix that begins with '_'
   * follows the name without a dot. */
  struct vg_outputs_file {
    char *suffix;
    int keep_old, is_case;
    uint64_t bytes, digest[2]; /* vg_outputs_digest */
  } * file;
};
#define VG_OUTPUTS_INIT                                                        \
  {                                                                            \
    .n_item = 0                                                                \
  }

void vg_outputs_release(struct vg_outputs *o);

/** Where files go, and that files can be written there.
 *
 * @param stem  gives the files their name
 * @param dir   NULL: that of the stem; created when absent */
vg_status vg_outputs_place(const char *stem, const char *dir,
                           struct vg_outputs *o, struct vg_error *err);

/** Make the hidden folder. Collective. Files are then written to
 * vg_outputs_temp_path, and each is registered by vg_outputs_add. */
vg_status vg_outputs_begin(struct vg_outputs *o, struct vg_comm *comm,
                           struct vg_error *err);

/** Understand the write list and where files go, and refuse at once what
 * would overwrite an input of p, or cannot be written by several ranks.
 *
 * @param stem, dir  as of vg_outputs_place
 * @param list       as vg_resolve_write has it */
vg_status vg_outputs_plan(const struct vg_problem *p, const char *stem,
                          const char *dir, const char *list, int ranks,
                          struct vg_outputs *o, struct vg_error *err);

/** Once the surface is final: an existing .mapbc that is an input stays, and
 * must know every patch. Call before the fill. */
vg_status vg_outputs_check(const struct vg_problem *p, struct vg_outputs *o,
                           struct vg_error *err);

/** Path of STEM.suffix where it is written now; free() it. */
char *vg_outputs_temp_path(struct vg_outputs *o, const char *suffix);

/** Path of STEM.suffix when all is done; free() it. */
char *vg_outputs_final(const struct vg_outputs *o, const char *suffix);

/** vg_outputs_begin, and in the hidden folder the files that can be written
 * slice by slice while slices are at hand for something else. Between this and
 * closing every slice must be put once: vg_outputs_put is a vg_slice_body. What
 * stays open is closed with st, how this rank fared. Open and close:
 * collective; the same answer on all ranks. o NULL: nothing is written. */
vg_status vg_outputs_open(struct vg_outputs *o, const struct vg_problem *p,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          struct vg_error *err);
vg_status vg_outputs_put(void *outputs, const struct vg_slice *slice,
                         struct vg_error *err);
vg_status vg_outputs_close(struct vg_outputs *o, vg_status st,
                           struct vg_error *err);

/** Write the mesh in every other form asked for, the resolved deck, and the
 * walls with their layers where there are some. Collective; what is no form of
 * io/slices/slices.h is written from a copy of the whole mesh, by one rank
 * alone. After vg_outputs_close. */
vg_status vg_outputs_mesh(struct vg_outputs *o, const struct vg_problem *p,
                          const struct vg_layer_stage *layers,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          int threads, struct vg_error *err);

/** Size and XXH3 digest of every file there is. On rank 0. */
vg_status vg_outputs_digest(struct vg_outputs *o, struct vg_error *err);

/** Register a file that the caller writes into the hidden folder. */
vg_status vg_outputs_add(struct vg_outputs *o, const char *suffix,
                         struct vg_error *err);

/** Move all files to their place and remove the hidden folder. On rank 0. */
vg_status vg_outputs_commit(struct vg_outputs *o, struct vg_error *err);

#endif
