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
#include "run/input/layers.h"
#include "run/stages/run.h"

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
  uint32_t *wall_point; /* [n_point] made by vanguard_wall_points at its
                           first call; NULL before */
  char *details;
};

/** Convert an internal status to that of the public functions. */
static inline vanguard_status vg_job_status(vg_status st)
{
  return st < 0 ? (vanguard_status)st : VANGUARD_OK;
}

/** Claim the job for a call, or return 0 if another call uses it, in another
 * thread or further up in this one, which runs its callback. The calling thread
 * then gets the message of VANGUARD_ERR_BUSY. */
int vg_job_enter(const vanguard_job *job);
void vg_job_leave(const vanguard_job *const *job);

/** First line of a public function: claims the job until the function returns,
 * or returns `refusal`. */
#define VG_JOB_CALL(job, refusal)                                              \
  if (!vg_job_enter(job)) return refusal;                                      \
  const vanguard_job *const claimed                                            \
    __attribute__((cleanup(vg_job_leave), unused)) = (job)

/** VG_ERR_USAGE if the job could not be created, or if it has no mesh. */
vg_status vg_job_usable(vanguard_job *job);
vg_status vg_job_meshed(vanguard_job *job);

/** Forget the sizes that the caller has given. (sizes.c) */
void vg_job_forget_sizes(vanguard_job *job);

/** Release everything that belongs to the last run. Collective. */
void vg_job_release_run(vanguard_job *job, int success);

/** Copy those members of a structure to the caller that the caller's
 * struct_size covers. Both structures begin with their size. */
void vg_job_give(void *out, const void *full, size_t size);

#endif
