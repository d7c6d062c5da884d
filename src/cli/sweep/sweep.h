/* cli/sweep/sweep.h: the parts of vanguard sweep: one run of vanguard mesh for
 * each point of a grid of parameters, and what comes out. Uses
 * run/common/ranges.h, cli/plot/timeline.h, partition/advance/ways.h. */
#ifndef VG_CLI_SWEEP_SWEEP_H
#define VG_CLI_SWEEP_SWEEP_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "cli/plot/timeline.h"
#include "partition/advance/ways.h"
#include "run/common/ranges.h"

struct vg_sweep_options {
  const char *project, *dir;
  const char *deck;     /* NULL: PROJECT.deck where there is one */
  const char *launcher; /* words with {ranks}, {threads}; NULL:
                           mpirun from 2 ranks on */
  const char *program;  /* NULL: this one */
  struct vg_range_list levels, leaf_cells, ranks, threads, parts;
  int n_way, way[VG_DECOMPOSITIONS]; /* [n_way] enum vg_decomposition_method */
  struct vg_range_list family; /* levels of a grid family; none: no family */
  double scale;                /* of its first level */
  int repeat, keep, json, quiet;
  int n_extra;
  char **extra; /* [n_extra] for vanguard mesh */
};

/* What is compared along a family; NAN: not known. */
enum vg_member_figure {
  VG_MEMBER_CELLS,
  VG_MEMBER_SURFACE,
  VG_MEMBER_FIELD,
  VG_MEMBER_FIRST,
  VG_MEMBER_LEVELS,
  VG_MEMBER_N /* cells; mean edges on the surface and in the
                 field; mean first height; mean layers */
};

struct vg_sweep_case {
  int64_t levels, leaf_cells, parts; /* -1: not given */
  int way;        /* enum vg_decomposition_method; -1: not given */
  int64_t family; /* level from 1; 0: none */
  double member[VG_MEMBER_N];
  int ranks, threads, repeat;
  char name[96], *dir;
  int is_run, is_done;
  int exit_status; /* 128 + n: ended by signal n */
  char note[256];  /* why it failed */
  double wall;     /* s, from start to exit */
  int has_timeline;
  struct vg_timeline t;
  double angle_min, peak_memory; /* NAN where the report does not say */
  struct vg_sweep_parts {        /* the same; angles in degrees */
    double n_part, balance;      /* most over mean of the leaves' cells */
    double seconds;         /* decomposition the void, before it is filled */
    double near_cells;      /* within two rings of interfaces */
    double near_p1, all_p1; /* 1st percentiles of the smallest angles, near
                               interfaces and of all outside the layers */
  } parts_made;
  double critical; /* s; NAN without a record */
  char *files;     /* "name digest" lines, or NULL */
  char digest[40]; /* of all files, or "" */
};

struct vg_sweep {
  const struct vg_sweep_options *o;
  size_t n;
  struct vg_sweep_case *item; /* [n] */
};

void vg_sweep_release(struct vg_sweep *s);

/** Words of a list of ways, as in "advancing,octree", each once. */
vg_status vg_sweep_ways(const char *what, const char *text,
                        struct vg_sweep_options *o, struct vg_error *err);

/** Lay the cases out: repeats around decompositions around threads around
 * ranks. */
vg_status vg_sweep_plan(const struct vg_sweep_options *o, struct vg_sweep *s,
                        struct vg_error *err);

/** Run one case; its output goes to dir/run.log. A run that fails is no
 * failure of this: see is_done and note. VG_ERR_IO when nothing can be
 * started at all, or the user stopped the sweep. */
vg_status vg_sweep_run(const struct vg_sweep_options *o,
                       struct vg_sweep_case *c, struct vg_error *err);

/** Take over what the run wrote, and remove its meshes unless o->keep. */
void vg_sweep_collect(const struct vg_sweep_options *o,
                      struct vg_sweep_case *c);

/** Seconds of a case that is done: of its record, else measured outside. */
double vg_sweep_seconds(const struct vg_sweep_case *c);

/** Cells that the tasks of a case made, without those of layers; NAN without a
 * record. */
double vg_sweep_field_cells(const struct vg_sweep_case *c);

/** These, over those of the advancing partition in as many parts, or else in
 * the first case of it; NAN: there is none. */
double vg_sweep_cells_ratio(const struct vg_sweep *s,
                            const struct vg_sweep_case *c);

/** The case that speed-ups are against: the first of those with the fewest
 * workers that is done; NULL: there is none. */
const struct vg_sweep_case *vg_sweep_base(const struct vg_sweep *s);

/** Against one worker, for which the fewest workers stand if there are more: w
 * of them are taken to be w times as fast. NAN: there is no base. */
double vg_sweep_speedup(const struct vg_sweep *s, double seconds);

/** 1 when two cases ask for the same mesh. */
int vg_sweep_same_mesh(const struct vg_sweep_case *a,
                       const struct vg_sweep_case *b);

/** Of all cases that ask for the same mesh, one whose files differ from the
 * first's, and that one; 0 when there is none. *n_compared: files' digests
 * that were held against each other.
 * @param file  out: the first file that differs: [64] */
int vg_sweep_differ(const struct vg_sweep *s, size_t *n_compared,
                    const struct vg_sweep_case **a,
                    const struct vg_sweep_case **b, char *file);

/** Size of a level of a family over that of the first: 2 / (level + 1), as the
 * Drag Prediction Workshops have it. */
double vg_sweep_scale(int64_t level);

/** Take the figures of a member from its report. */
struct json_t;
void vg_sweep_member(const struct json_t *report, struct vg_sweep_case *c);

/** Members of the family, each with its figures over those of the one before
 * and what the rule has for it: for people, and as family.csv in o->dir.
 * Nothing happens without a family. */
void vg_sweep_family_text(FILE *to, const struct vg_sweep *s);
vg_status vg_sweep_family_write(const struct vg_sweep *s, struct vg_error *err);

/** sweep.csv, sweep.json and the figures. */
vg_status vg_sweep_write(const struct vg_sweep *s, struct vg_error *err);
vg_status vg_sweep_draw(const struct vg_sweep *s, struct vg_error *err);

#endif
