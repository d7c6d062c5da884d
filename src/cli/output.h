/* cli/output.h: the files of a run. They are written into a hidden folder
 * beside their place and moved there together at the end, so that a run that
 * fails or is stopped leaves nothing half-written. */
#ifndef VG_CLI_OUTPUT_H
#define VG_CLI_OUTPUT_H

#include "cli/input.h"
#include "cli/layers.h"

/** Kinds of file in a write list. */
enum { VG_OUTPUT_ITEMS = 16 };

struct vg_outputs {
  char *dir, *name;           /* target folder ("." if none), base name */
  char *aside;                /* hidden folder while writing, or NULL */
  size_t n_item;
  char item[VG_OUTPUT_ITEMS][24];
  size_t n_file, cap_file;
  /* is_case: a folder with an OpenFOAM mesh. */
  struct vg_outputs_file { char *suffix; int keep_old, is_case; } *file;
};
#define VG_OUTPUTS_INIT { .n_item = 0 }

void vg_outputs_release(struct vg_outputs *o);

/** Understand the write list and where files go, and refuse at once what
 * would overwrite an input.
 *
 * @param dir  NULL: beside the input; created when absent */
vg_status vg_outputs_plan(const struct vg_problem *p, const char *dir,
                          struct vg_outputs *o, struct vg_error *err);

/** Once the surface is final: an existing .mapbc that is an input stays, and
 * must know every patch. Call before the fill. */
vg_status vg_outputs_check(const struct vg_problem *p, struct vg_outputs *o,
                           struct vg_error *err);

/** Path of STEM.suffix where it is written now; free() it. */
char *vg_outputs_aside(struct vg_outputs *o, const char *suffix);

/** Path of STEM.suffix when all is done; free() it. */
char *vg_outputs_final(const struct vg_outputs *o, const char *suffix);

/** Write the mesh in every form asked for, the resolved deck, and the walls
 * with their layers where there are some. */
vg_status vg_outputs_mesh(struct vg_outputs *o, const struct vg_problem *p,
                          const struct vg_layer_stage *layers,
                          const struct vg_mesh *mesh, struct vg_error *err);

/** Start the hidden folder; register a file written there by the caller. */
vg_status vg_outputs_begin(struct vg_outputs *o, struct vg_error *err);
vg_status vg_outputs_add(struct vg_outputs *o, const char *suffix,
                         struct vg_error *err);

/** Move all files to their place and remove the hidden folder. */
vg_status vg_outputs_commit(struct vg_outputs *o, struct vg_error *err);

#endif
