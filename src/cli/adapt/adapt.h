/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/adapt/adapt.h: vanguard adapt: cycles of mesh, flow solution and metric.
 * Uses run/settings/settings.h.
 *
 *     cycle-1             cycle-2                       cycle-3
 *     mesh -> solution -> metric -> mesh -> solution -> metric -> ...
 *
 * adapt.json in the folder of the loop records each finished step; the same
 * command continues after it. */
#ifndef VG_CLI_ADAPT_ADAPT_H
#define VG_CLI_ADAPT_ADAPT_H

#include <stddef.h>
#include <stdio.h>

#include "base/status.h"
#include "run/common/json_build.h"
#include "run/settings/settings.h"

#define VG_ADAPT_OUTPUTS 16 /* most output quantities of a solver */
#define VG_ADAPT_ATTEMPTS 3 /* metrics that are tried for a mesh */

struct vg_adapt_options {
  const char *project, *dir;
  const char *deck;     /* NULL: none */
  const char *launcher; /* of the mesher; as in struct vg_sweep_options */
  const char *program;  /* NULL: this program */
  struct vg_adapt_row row;
  int ranks, threads, json, quiet;
  int n_extra;
  char **extra; /* [n_extra] for vanguard mesh */
};

/* Steps of a cycle, in their order. The first cycle has no metric, and without
 * a field no cycle has one. */
enum vg_adapt_step {
  VG_ADAPT_METRIC,
  VG_ADAPT_MESH,
  VG_ADAPT_SOLVE,
  VG_ADAPT_N
};

struct vg_adapt_cycle {
  int number; /* from 1 */
  char *dir;
  int is_done[VG_ADAPT_N];
  double seconds[VG_ADAPT_N];
  double requested; /* cells outside of layers; NAN: no metric */
  int attempt;      /* the metric that is used, from 1 */
  int exit_status;  /* of the mesher: of a mesh, not 0 if a limit is not met */
  double cells, points, field_cells, angle_min; /* NAN: not known */
  size_t n_output;
  struct vg_adapt_output {
    char name[64];
    double value;
  } output[VG_ADAPT_OUTPUTS];
};

struct vg_adapt {
  const struct vg_adapt_options *o;
  char *dir, *home; /* absolute: folder of the loop; working directory
                       of the solver */
  char *stem;       /* of the files of a mesh */
  json_t *settings; /* what decides the results, as in adapt.json */
  size_t n;
  struct vg_adapt_cycle *cycle; /* [n] */
};

static inline int vg_adapt_has_metric(const struct vg_adapt *a,
                                      const struct vg_adapt_cycle *c)
{
  return c->number > 1 && *a->o->row.field;
}

/** Paths, cycles and settings; the finished steps of an earlier call from
 * adapt.json. VG_ERR_INPUT: a setting is missing, or adapt.json belongs to a
 * loop with other settings. */
vg_status vg_adapt_open(const struct vg_adapt_options *o, struct vg_adapt *a,
                        struct vg_error *err);
void vg_adapt_release(struct vg_adapt *a);

/** Write adapt.json. */
vg_status vg_adapt_record(const struct vg_adapt *a, struct vg_error *err);

/** Run the steps that are not done, and record each of them. A failed step is
 * an error that names its log. */
vg_status vg_adapt_run(struct vg_adapt *a, struct vg_error *err);

#define VG_ADAPT_NOTE 300
/** What a reader must know about a cycle: note k, or "". Returns 0 after the
 * last one. */
int vg_adapt_note(const struct vg_adapt *a, const struct vg_adapt_cycle *c,
                  int k, char note[VG_ADAPT_NOTE]);

/** The table of the cycles: for people; adapt.csv; as JSON, owned by the
 * caller. */
void vg_adapt_print(FILE *to, const struct vg_adapt *a);
vg_status vg_adapt_write_csv(const struct vg_adapt *a, struct vg_error *err);
json_t *vg_adapt_json(const struct vg_adapt *a);

/** adapt.html with the table and a plot of each output quantity over
 * cells^(-2/3). */
vg_status vg_adapt_write_page(const struct vg_adapt *a, struct vg_error *err);

/** Growth and aspect_max of the metric of attempt 1, 2, ...; NAN: as
 * requested. */
void vg_adapt_attempt(const struct vg_adapt_row *row, int attempt,
                      double *growth, double *aspect_max);

#endif
