/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/sweep/sweep.h: vanguard sweep: one run of vanguard mesh for each point of
 * a grid of parameters, and the comparison of the runs. Uses
 * run/common/ranges.h, cli/plot/timeline.h, partition/advance/ways.h. */
#ifndef VG_CLI_SWEEP_SWEEP_H
#define VG_CLI_SWEEP_SWEEP_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "cli/common/process.h"
#include "cli/plot/timeline.h"
#include "partition/advance/ways.h"
#include "run/common/ranges.h"

/* The law of a grid family: levels with factors 2 / (L + 1), or the figures of
 * a workshop. */
enum vg_family_rule {
  VG_FAMILY_PLAIN,
  VG_FAMILY_DPW,
  VG_FAMILY_HLPW,
  VG_FAMILY_N
};

/* Farfield of the workshops' families, in reference lengths. */
#define VG_FAMILY_FARFIELD 1000

struct vg_sweep_options {
  const char *project, *dir;
  const char *deck;     /* NULL: PROJECT.deck if it exists */
  const char *launcher; /* command with {ranks}, {threads}; NULL:
                           mpirun if there are 2 ranks or more */
  const char *program;  /* NULL: this program */
  struct vg_range_list bisections, leaf_cells, ranks, threads, subdomains;
  int n_way, way[VG_DECOMPOSITIONS]; /* [n_way] enum vg_decomposition_method */
  struct vg_range_list family; /* levels of a grid family; empty: no family */
  double scale;                /* scale of the first level */
  enum vg_family_rule rule;
  const char *levels_planned;   /* as given; NULL: none */
  struct vg_range_list planned; /* levels that are planned, not meshed */
  double reynolds, length;      /* of the deck, for a workshop's family */
  int64_t layer_count; /* of the deck; 0: up to the local edge length */
  int sets_farfield;   /* 1: the deck does not exclude a farfield made
                          by the program */
  int repeat, keep, json, quiet;
  int is_plane; /* 1: the project is a plane section */
  int n_extra;
  char **extra; /* [n_extra] for vanguard mesh */
};

/* Quantities that are compared along a family; NAN: unknown. */
enum vg_member_figure {
  VG_MEMBER_CELLS,   /* number of cells */
  VG_MEMBER_SURFACE, /* mean edge length on the surface */
  VG_MEMBER_FIELD,   /* mean edge length outside the layers */
  VG_MEMBER_FIRST,   /* mean first height */
  VG_MEMBER_LEVELS,  /* mean number of layers */
  VG_MEMBER_N
};

/* Figures of a mesh in the form of the workshops; NAN: unknown. */
enum vg_sweep_figure {
  VG_FIGURE_NODES,
  VG_FIGURE_CELLS,
  VG_FIGURE_TETRAHEDRA,
  VG_FIGURE_PYRAMIDS,
  VG_FIGURE_PRISMS,
  VG_FIGURE_HEXAHEDRA,
  VG_FIGURE_BOUNDARY_NODES,
  VG_FIGURE_BOUNDARY_TRIANGLES,
  VG_FIGURE_BOUNDARY_QUADS,
  VG_FIGURE_LAYER_CELLS,
  VG_FIGURE_FIRST,
  VG_FIGURE_Y_PLUS,
  VG_FIGURE_GROWTH,
  VG_FIGURE_FULL,
  VG_FIGURE_FARFIELD,   /* half of the domain's extent, in reference lengths */
  VG_FIGURE_LEAD_ASKED, /* edge lengths at leading and trailing edges, % of the
                           local chord, requested by the deck and reached */
  VG_FIGURE_LEAD,
  VG_FIGURE_TRAIL_ASKED,
  VG_FIGURE_TRAIL,
  VG_FIGURE_ROOT_ASKED, /* along the span, % of the semispan */
  VG_FIGURE_ROOT,
  VG_FIGURE_TIP_ASKED,
  VG_FIGURE_TIP,
  VG_FIGURE_N
};

struct vg_sweep_case {
  int64_t bisections, leaf_cells, subdomains; /* -1: not given */
  int way;        /* enum vg_decomposition_method; -1: not given */
  int64_t family; /* level, from 1; 0: no family */
  double member[VG_MEMBER_N];
  int is_plane; /* 1: a mesh in two dimensions */
  double figure[VG_FIGURE_N];
  int is_planned; /* 1: only vanguard plan is run */
  int ranks, threads, repeat;
  char name[96], *dir;
  int is_run, is_done;
  int exit_status;            /* 128 + n: ended by signal n */
  char note[VG_FAILURE_NOTE]; /* why it failed */
  double wall;                /* seconds from start to exit */
  int has_timeline;
  struct vg_timeline t;
  double angle_min, peak_memory; /* NAN if not in the report */
  struct vg_sweep_parts {        /* NAN as well; angles in degrees */
    double n_part, balance;      /* subdomains; max/mean of cells in leaves */
    double seconds;              /* decomposition, before filling */
    double near_cells;           /* cells within two layers of an interface */
    double near_p1, all_p1;      /* 1st percentiles of the smallest angles near
                                    interfaces, and of all cells outside the
                                    layers */
  } parts_made;
  double critical; /* seconds; NAN without a timeline */
  char *files;     /* "name digest" lines, or NULL */
  char digest[40]; /* of all files, or "" */
};

struct vg_sweep {
  const struct vg_sweep_options *o;
  size_t n;
  struct vg_sweep_case *item; /* [n] */
};

void vg_sweep_release(struct vg_sweep *s);

/** Parse a list of decomposition methods, as in "advancing,octree", without
 * duplicates. */
vg_status vg_sweep_ways(const char *what, const char *text,
                        struct vg_sweep_options *o, struct vg_error *err);

/** Create the cases in this order: ranks vary fastest, then threads,
 * decompositions and repeats. */
vg_status vg_sweep_plan(const struct vg_sweep_options *o, struct vg_sweep *s,
                        struct vg_error *err);

/** Run one case; its output goes to dir/run.log. If the run fails, this
 * function still succeeds: see is_done and note. VG_ERR_IO if the process
 * cannot be started, or if the user stopped the sweep. */
vg_status vg_sweep_run(const struct vg_sweep_options *o,
                       struct vg_sweep_case *c, struct vg_error *err);

/** Read report and timeline of the run, and remove its meshes unless
 * o->keep. */
void vg_sweep_collect(const struct vg_sweep_options *o,
                      struct vg_sweep_case *c);

/** Time of a finished case in seconds: from its timeline, else from start to
 * exit of its process. */
double vg_sweep_seconds(const struct vg_sweep_case *c);

/** Number of cells made by the tasks of a case, without layer cells; NAN
 * without a timeline. */
double vg_sweep_field_cells(const struct vg_sweep_case *c);

/** Ratio of these cells to those of the advancing method with the same number
 * of subdomains or, failing that, of its first case; NAN if there is no
 * such case. */
double vg_sweep_cells_ratio(const struct vg_sweep *s,
                            const struct vg_sweep_case *c);

/** The reference case of speed-ups: the first finished one of those with the
 * fewest workers; NULL if no case is finished. */
const struct vg_sweep_case *vg_sweep_base(const struct vg_sweep *s);

/** Speed-up over one worker. If the reference case has w > 1 workers, it is
 * taken to be w times as fast as one. NAN: there is no reference case. */
double vg_sweep_speedup(const struct vg_sweep *s, double seconds);

/** Returns 1 if two cases request the same mesh. */
int vg_sweep_same_mesh(const struct vg_sweep_case *a,
                       const struct vg_sweep_case *b);

/** Find two cases that request the same mesh but whose files differ; returns 0
 * if no two cases differ. *n_compared receives the number of cases that were
 * compared with an earlier one.
 * @param file  out: name of the first file that differs [64] */
int vg_sweep_differ(const struct vg_sweep *s, size_t *n_compared,
                    const struct vg_sweep_case **a,
                    const struct vg_sweep_case **b, char *file);

/** Take the levels of a family: numbers such as 1:3, or dpw:1-6 and hlpw:A-F
 * with the laws of a workshop. VG_ERR_INPUT. what: for messages. */
vg_status vg_sweep_take_family(const char *what, const char *text,
                               struct vg_sweep_options *o,
                               struct vg_error *err);

/** Take the levels that are planned rather than meshed, after the family.
 * VG_ERR_INPUT without a workshop's family, and for levels outside of it. */
vg_status vg_sweep_take_planned(const char *text, struct vg_sweep_options *o,
                                struct vg_error *err);

int vg_sweep_is_in(const struct vg_range_list *list, int64_t v);

/** VG_ERR_INPUT if the deck lacks what a workshop's family needs. */
vg_status vg_sweep_check_named(const struct vg_sweep_options *o,
                               struct vg_error *err);

/** Scale of a level of a grid family relative to the first level. */
double vg_sweep_scale(const struct vg_sweep_options *o, int64_t level);

/** Name of a level, such as f2, dpw2 or hlpwB. */
void vg_sweep_level_name(const struct vg_sweep_options *o, int64_t level,
                         char name[24]);

/** Add the options of a level of a workshop's family. */
struct vg_words;
vg_status vg_sweep_add_named(struct vg_words *w,
                             const struct vg_sweep_options *o, int64_t level,
                             struct vg_error *err);

/** Read the figures of a case from its report, or from its forecast. */
struct json_t;
void vg_sweep_figures(const struct json_t *report,
                      const struct vg_sweep_options *o,
                      struct vg_sweep_case *c);
void vg_sweep_estimates(const struct json_t *plan, struct vg_sweep_case *c);

/** Print the table of requested and reached figures of a workshop's family;
 * write it as metrics.html, and all figures as metrics.csv in o->dir. No effect
 * on other families. */
void vg_sweep_named_text(FILE *to, const struct vg_sweep *s);
vg_status vg_sweep_named_write(const struct vg_sweep *s, struct vg_error *err);

/** The previous member of the family: the last finished case before i of
 * another level with the same parameters otherwise, or NULL. */
const struct vg_sweep_case *vg_sweep_before(const struct vg_sweep *s, size_t i);

/** Read the quantities of a family member from its report. */
void vg_sweep_member(const struct json_t *report, struct vg_sweep_case *c);

/** Print the members of the family, each with the ratios of its quantities to
 * those of the previous member and the ratios of the family rule; write them
 * as family.csv in o->dir. No effect without a family. */
void vg_sweep_family_text(FILE *to, const struct vg_sweep *s);
vg_status vg_sweep_family_write(const struct vg_sweep *s, struct vg_error *err);

/** sweep.csv, sweep.json and the figures. */
vg_status vg_sweep_write(const struct vg_sweep *s, struct vg_error *err);
vg_status vg_sweep_draw(const struct vg_sweep *s, struct vg_error *err);

#endif
