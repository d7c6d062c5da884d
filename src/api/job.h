/* api/job.h: what a vanguard_job is. Private to api. */
#ifndef VG_API_JOB_H
#define VG_API_JOB_H

#include "api/vanguard.h"
#include "base/comm.h"
#include "core/sizing/sizing_map.h"
#include "run/input/input.h"
#include "run/input/layers.h"
#include "run/stages/run.h"

struct vanguard_job {
  struct vg_comm *comm;
  int is_refused; /* the caller's ABI is: no call makes sense */
  struct vg_error err;
  struct vg_settings settings;
  char *project, *deck;   /* of vanguard_open; NULL */
  char *name;             /* of `surface` */
  struct vg_mesh surface; /* of vanguard_surface */
  vanguard_size_function *size;
  void *size_user;
  struct vg_size_map map; /* of `size` or `samples`; at NULL: none */
  size_t n_size;
  double (*size_at)[3], *size_of; /* [n_size] of vanguard_size_points */
  /* a run */
  vanguard_progress *progress;
  void *progress_user;
  struct vg_display show;
  struct vg_size_samples *samples;
  struct vg_problem problem;
  struct vg_layer_stage layers;
  struct vg_run run;
  int is_meshed;
  uint32_t *wall_point; /* of vanguard_wall_points; NULL: not asked yet */
  char *details;
};

/** Keep a failure: what the public function returns. */
static inline vanguard_status vg_job_status(vg_status st)
{
  return st < 0 ? (vanguard_status)st : VANGUARD_OK;
}

/** VG_ERR_USAGE where the job cannot do anything, or has no mesh. */
vg_status vg_job_usable(vanguard_job *job);
vg_status vg_job_meshed(vanguard_job *job);

/** Release everything of the last run. Collective. */
void vg_job_release_run(vanguard_job *job, int success);

/** Give out a structure, no more of it than the caller knows: the first
 * member of both is the size. */
void vg_job_give(void *out, const void *full, size_t size);

#endif
