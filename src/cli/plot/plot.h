/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plot/plot.h: plots of runs, as SVG. Uses cli/plot/svg.h,
 * cli/plot/timeline.h. */
#ifndef VG_CLI_PLOT_PLOT_H
#define VG_CLI_PLOT_PLOT_H

#include <stddef.h>
#include <stdint.h>

#include "cli/plot/timeline.h"

/** Timeline: a lane for each thread of each rank, coloured by kind of task,
 * with idle time white and the stages before and after the tasks as grey
 * blocks. */
vg_status vg_plot_timeline(const char *path, const struct vg_timeline *t,
                           struct vg_error *err);

/** Histogram of the number of cells per leaf.
 * @param target  requested cells per leaf; 0: none */
vg_status vg_plot_sizes(const char *path, const struct vg_timeline *t,
                        double target, struct vg_error *err);

/* A curve: dots and a line if measured, a dashed line if from the model. */
struct vg_plot_series {
  const char *label;
  int colour, is_model;
  size_t n;
  const double *workers, *speedup; /* [n], sorted by workers */
};

/** Speed-up over workers, with the ideal line; logarithmic axes beyond 16
 * workers. */
vg_status vg_plot_speedup(const char *path, const char *title,
                          const char *subtitle, size_t n,
                          const struct vg_plot_series *series,
                          struct vg_error *err);

struct vg_plot_bar {
  const char *label;
  const double *seconds;
};

/** A bar for each run, divided into its phases (seconds[VG_PHASE_N]). */
vg_status vg_plot_phases(const char *path, const char *title, size_t n,
                         const struct vg_plot_bar *bar, struct vg_error *err);

#endif
