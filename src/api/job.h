/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* api/job.h: the members of a vanguard_job. Private to api. */
#ifndef VG_API_JOB_H
#define VG_API_JOB_H

#include <stdatomic.h>

#include "api/vanguard.h"
#include "base/comm.h"
#include "core/sizing/sizing_map.h"
#include "core/sizing/sizing_mesh.h"
#include "run/input/input.h"
#include "run/layers/layers.h"
#include "run/plan/run_plan.h"
#include "run/stages/file_mesh.h"
#include "run/stages/report_run.h"

/* Pieces of the mesh that have been given to the caller, in the order of their
 * numbers (pieces.c). */
struct vg_job_lent {
  size_t n, cap, n_held;
  struct vg_job_piece {
    uintptr_t number;       /* Value of vanguard_piece.keep. */
    struct vg_slice *slice; /* NULL: taken back. */
  } * piece;
};

struct vanguard_job {
  atomic_int busy; /* 1 while a call uses the job */
  struct vg_comm *comm;
  int is_refused; /* the caller's ABI is not supported, or the job could not
                     be created: every call fails */
  struct vg_error err;
  struct vg_settings settings;
  char *project, *deck;   /* names given to vanguard_open; else NULL */
  char *name;             /* name of `surface` */
  struct vg_mesh surface; /* surface given to vanguard_surface */
  /* Sizes: at most one of the following is given. */
  vanguard_size_function *size;
  vanguard_metric_function *metric;
  void *size_user;        /* of `size` or `metric` */
  struct vg_size_map map; /* map of `size` or `metric` */
  size_t n_size;
  double (*size_at)[3], *size_of; /* [n_size] points and sizes given to
                                     vanguard_size_points */
  struct vg_mesh background;      /* points and cells given to
                                     vanguard_metric_points */
  double (*metric_of)[6];         /* [background.n_point] their metrics */
  /* State of the last run. */
  vanguard_progress *progress;
  void *progress_user;
  struct vg_display show;
  struct vg_size_samples *samples; /* of `size_of` */
  struct vg_size_mesh *metrics;    /* of `metric_of` */
  struct vg_problem problem;
  struct vg_layer_stage layers;
  struct vg_run run;
  int is_meshed;
  struct vg_run_times times;
  struct vg_error failure;  /* Of the last run; code VG_OK: none. */
  struct vg_file_mesh file; /* Mesh of vanguard_read. */
  char *report;             /* Text of vanguard_report. */
  struct vg_job_lent lent;  /* Pieces that the caller holds. */
  uint32_t *wall_point;     /* [n_point] made by vanguard_wall_points at its
                               first call; NULL before */
  char *details;
};

/** Convert an internal status to that of the public functions. */
static inline vanguard_status vg_job_status(vg_status st)
{
  return st < 0 ? (vanguard_status)st : VANGUARD_OK;
}

/** Claim the job for a call: VANGUARD_OK; VANGUARD_ERR_BUSY if another call
 * uses it, in another thread or further up in this one, which runs its
 * callback; VANGUARD_ERR_USAGE if it is NULL. After VANGUARD_ERR_BUSY the
 * calling thread gets the message of that status. */
vanguard_status vg_job_enter(const vanguard_job *job);
void vg_job_leave(const vanguard_job *const *job);

#define VG_JOB_CLAIM(job)                                                      \
  const vanguard_job *const claimed                                            \
    __attribute__((cleanup(vg_job_leave), unused)) = (job)

/** First line of a public function that returns a status: claims the job until
 * the function returns, or returns the status of vg_job_enter. */
#define VG_JOB_CALL(job)                                                       \
  const vanguard_status entered = vg_job_enter(job);                           \
  if (entered) return entered;                                                 \
  VG_JOB_CLAIM(job)

/** As VG_JOB_CALL, in a function that returns something else: `nothing` if the
 * job cannot be claimed. */
#define VG_JOB_ASK(job, nothing)                                               \
  if (vg_job_enter(job)) return nothing;                                       \
  VG_JOB_CLAIM(job)

/** Prepare a job for a run: the last one is released, and the callback and the
 * ranks are those of the new one. */
void vg_job_begin(vanguard_job *job, vanguard_progress *progress, void *user);

/** What a run makes; FORECAST is BOUNDARY with a forecast. */
enum vg_job_goal {
  VG_JOB_SURFACE,
  VG_JOB_BOUNDARY,
  VG_JOB_FORECAST,
  VG_JOB_MESH
};

/** Release the last run and make another one. plan: that of VG_JOB_FORECAST,
 * with the problem, the layers and the progress of the job; else NULL.
 * (mesh.c) */
vg_status vg_job_run(vanguard_job *job, enum vg_job_goal goal,
                     struct vg_plan *plan, vanguard_progress *progress,
                     void *user);

/** VG_ERR_USAGE if the job could not be created, or if it has no mesh. */
vg_status vg_job_usable(vanguard_job *job);
vg_status vg_job_meshed(vanguard_job *job);

/** VG_ERR_USAGE if the job could not be created, or if an argument of the
 * call is NULL. name: that of the argument, for the message. */
vg_status vg_job_needs(vanguard_job *job, const void *argument,
                       const char *name);

/** Give patch i of a mesh, or VG_ERR_USAGE. (access.c) */
vg_status vg_job_give_patch(vanguard_job *job, const struct vg_mesh *m,
                            size_t i, struct vanguard_patch *out);

/** Take back all pieces that the caller holds. (pieces.c) */
void vg_job_take_back(vanguard_job *job);

/** Forget the sizes that the caller has given. (sizes.c) */
void vg_job_forget_sizes(vanguard_job *job);

/** Release everything that belongs to the last run. Collective. */
void vg_job_release_run(vanguard_job *job, int success);

/** Copy those members of a structure to the caller that the caller's
 * struct_size covers. Both structures begin with their size. VG_ERR_USAGE if
 * `out` is NULL or its struct_size is not set. */
vg_status vg_job_give(vanguard_job *job, void *out, const void *full,
                      size_t size);

#endif
