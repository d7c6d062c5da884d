/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: looks, processes that examine a project before a run
 * without meshing: they show the surface, check it, or forecast a run.
 * There is at most one look of each kind; a new one ends the old one, and all
 * end with the portal. The files of a look are in a folder of its own,
 * looks/KIND below the folder of the runs. */
#ifndef VG_CLI_SERVE_LOOKS_H
#define VG_CLI_SERVE_LOOKS_H

#include <sys/types.h>

#include "base/status.h"
#include "cli/common/process.h"
#include "cli/serve/tell.h"
#include "run/settings/settings.h"

enum vg_look_type { VG_SEE_VIEW, VG_SEE_CHECK, VG_SEE_PLAN, VG_SEE_TYPES };

enum vg_look_state {
  VG_SEE_NOTHING, /* No look yet. */
  VG_SEE_RUNNING,
  VG_SEE_DONE,
  VG_SEE_FAILED /* Without a result; `note` has the reason. */
};

struct vg_look_process {
  int id; /* Unique among the looks of a portal, from 1. */
  enum vg_look_state state;
  char *dir;
  pid_t pid;
  char note[VG_FAILURE_NOTE];
};

struct vg_looks {
  int n; /* Number of looks so far. */
  char *dir;
  struct vg_look_process item[VG_SEE_TYPES];
};

/** Name of a type: "view", "check", "plan". */
const char *vg_look_word(enum vg_look_type type);

/** The type with this name; VG_SEE_TYPES if no type
 * has it. */
enum vg_look_type vg_look_type_of(const char *word);

/** @param dir  folder of the runs */
vg_status vg_looks_open(struct vg_looks *l, const char *dir,
                        struct vg_error *err);

/** End all looks. Accepts a zeroed structure. */
void vg_looks_release(struct vg_looks *l);

struct vg_look_order {
  enum vg_look_type type;
  const char *own, *program;   /* This program, and the meshing program. */
  const char *root, *project;  /* The project, relative to root. */
  const struct vg_settings *s; /* Written to the deck of the look. */
  int ranks;                   /* For the forecast; threads are in `s`. */
  int may_start;               /* 0: this portal starts no processes. */
};

/** Start a look. VG_ERR_IO: the deck cannot be written, or no process
 * started; VG_ERR_UNSUPPORTED: this portal starts none. */
vg_status vg_looks_start(struct vg_looks *l, const struct vg_look_order *o,
                         int *id, struct vg_error *err);

/** Detect looks that have ended. To be called often. */
void vg_looks_watch(struct vg_looks *l);

/** End a look; nothing happens if there is no such look or it has ended. */
void vg_looks_stop(struct vg_looks *l, int id);

/** The type of look `id`, or VG_SEE_TYPES if there is no such look any
 * more. */
enum vg_look_type vg_looks_find(const struct vg_looks *l, int id);

/** JSON text with kind, state, progress, and the result or the reason of a
 * failure; free it. NULL: out of memory. */
char *vg_looks_json(const struct vg_looks *l, enum vg_look_type type);

#endif
