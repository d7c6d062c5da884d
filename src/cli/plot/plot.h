/* cli/plot/plot.h: figures of runs, as SVG. Uses cli/plot/svg.h,
 * cli/plot/timeline.h. */
#ifndef VG_CLI_PLOT_PLOT_H
#define VG_CLI_PLOT_PLOT_H

#include <stddef.h>
#include <stdint.h>

#include "cli/plot/timeline.h"

/** Who did what when: a lane for each thread of each rank, colours by kind of
 * task, idle white; the stages before and after as grey blocks. */
vg_status vg_plot_timeline(const char *path, const struct vg_timeline *t,
                           struct vg_error *err);

/** How large subdomains are: leaves by their cells.
 * @param target  cells per leaf that were asked for; 0: none */
vg_status vg_plot_sizes(const char *path, const struct vg_timeline *t,
                        double target, struct vg_error *err);

/* Points of one colour: measured ones with dots, a model's a dashed line. */
struct vg_plot_series {
  const char *label;
  int colour, is_model;
  size_t n;
  const double *workers, *speedup; /* [n], workers rising */
};

/** Speed-up over workers, with the ideal line. Logarithmic beyond 16. */
vg_status vg_plot_speedup(const char *path, const char *title,
                          const char *subtitle, size_t n,
                          const struct vg_plot_series *series,
                          struct vg_error *err);

struct vg_plot_bar {
  const char *label;
  const double *seconds;
};

/** A bar for each run, its parts the phases ([VG_PHASE_N] each). */
vg_status vg_plot_phases(const char *path, const char *title, size_t n,
                         const struct vg_plot_bar *bar, struct vg_error *err);

#endif
