/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reads report and timeline of the runs of a sweep, and compares runs. */
#define _GNU_SOURCE
#include <dirent.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/sweep/sweep.h"
#include "partition/store/store.h"
#include "run/common/json_build.h"

static int ends_with(const char *text, const char *end)
{
  size_t n = strlen(text), m = strlen(end);

  return n >= m && !strcmp(text + n - m, end);
}

/* The first file (by name) in a folder whose name ends with `end`; to be freed
 * by the caller. */
static char *find_file(const char *dir, const char *end)
{
  struct dirent **list = NULL;
  int n = scandir(dir, &list, NULL, alphasort);
  char *path = NULL;

  for (int i = 0; i < n; i++) {
    if (!path && ends_with(list[i]->d_name, end) &&
        asprintf(&path, "%s/%s", dir, list[i]->d_name) < 0)
      path = NULL;
    free(list[i]);
  }
  free(list);
  return path;
}

/* Entries of "files" are paths, or objects with path and digest. */
static const char *file_name(const json_t *file)
{
  const char *path = json_is_string(file)
                     ? json_string_value(file)
                     : json_string_value(json_object_get(file, "path"));

  if (!path) return NULL;
  return strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
}

static void take_digests(const json_t *files, struct vg_sweep_case *c)
{
  struct vg_digest zero = { { 0, 0 } }, d;
  size_t size = 0, i;
  const json_t *file;
  FILE *to = vg_text_open(&c->files, &size);

  if (!to) return;
  json_array_foreach(files, i, file)
  {
    const char *name = file_name(file);
    const char *xxh3 = json_string_value(json_object_get(file, "xxh3"));

    /* Reports contain times, which differ. */
    if (name && xxh3 && !ends_with(name, ".json"))
      fprintf(to, "%s %s\n", name, xxh3);
  }
  if (fclose(to) || !size) {
    free(c->files);
    c->files = NULL;
    return;
  }
  d = vg_digest_of(zero, size, c->files);
  snprintf(c->digest, sizeof c->digest, "%016llx%016llx",
           (unsigned long long)d.word[0], (unsigned long long)d.word[1]);
}

static void remove_meshes(const json_t *files, const char *dir)
{
  const json_t *file;
  size_t i;

  json_array_foreach(files, i, file)
  {
    const char *name = file_name(file);
    char *path;

    if (!name || !*name || ends_with(name, ".json") ||
        ends_with(name, ".deck") || asprintf(&path, "%s/%s", dir, name) < 0)
      continue;
    unlink(path);
    free(path);
  }
}

/* Read the figures of the decomposition and the quality near interfaces. */
static void take_parts(const json_t *root, struct vg_sweep_parts *to)
{
  static const char *const steps[] = { "coarse_seconds", "deal_seconds",
                                       "smooth_seconds", "divide_seconds" };
  const json_t *all = json_object_get(root, "partition");
  const json_t *near = json_object_get(all, "near_interfaces");
  const json_t *made = json_object_get(all, "subdomains");
  const json_t *mesh = json_object_get(root, "field");

  if (!mesh) mesh = json_object_get(root, "mesh");
  to->n_part = vg_json_number(made ? made : all, made ? "count" : "leaves");
  to->balance = vg_json_number(all, "balance");
  to->near_cells = vg_json_number(near, "cells");
  to->near_p1 = vg_json_number(near, "angle_min_p1");
  to->all_p1 = vg_json_number(mesh, "angle_min_p1");
  to->seconds = all ? 0 : NAN;
  for (size_t k = 0; made && k < sizeof steps / sizeof *steps; k++)
    to->seconds += vg_json_number(made, steps[k]);
}

static void read_report(const struct vg_sweep_options *o,
                        struct vg_sweep_case *c)
{
  char *path = find_file(c->dir, ".report.json");
  json_t *root = path ? json_load_file(path, 0, NULL) : NULL;
  const json_t *mesh = json_object_get(root, "field");
  const json_t *files = json_object_get(root, "files");

  if (!mesh) mesh = json_object_get(root, "mesh");
  c->angle_min = vg_json_number(mesh, "angle_min");
  c->peak_memory = vg_json_number(root, "peak_memory_bytes");
  take_parts(root, &c->parts_made);
  if (c->family) vg_sweep_member(root, c);
  if (o->rule != VG_FAMILY_PLAIN) vg_sweep_figures(root, o, c);
  if (c->is_done) {
    take_digests(files, c);
    if (!o->keep) remove_meshes(files, c->dir);
  }
  json_decref(root);
  free(path);
}

/* The critical path of the tasks of a run on its own machine, in seconds. */
static double critical_of(const struct vg_timeline *t)
{
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_model_result f;

  m.ranks = m.ranks_per_node = t->spans.n_rank;
  m.threads = t->spans.n_thread;
  m.cyclic = t->cyclic;
  vg_timeline_outside(t, &m);
  return vg_model_replay(&t->spans, &m, &f, NULL, NULL) < 0 ? NAN : f.critical;
}

static void read_plan(struct vg_sweep_case *c)
{
  char *path = find_file(c->dir, "plan.json");
  json_t *root = path ? json_load_file(path, 0, NULL) : NULL;

  vg_sweep_estimates(root, c);
  c->member[VG_MEMBER_CELLS] = c->figure[VG_FIGURE_CELLS];
  json_decref(root);
  free(path);
}

void vg_sweep_collect(const struct vg_sweep_options *o, struct vg_sweep_case *c)
{
  char *path;
  struct vg_error err = VG_ERROR_INIT;

  if (c->is_planned) {
    read_plan(c);
    return;
  }
  path = find_file(c->dir, ".timeline.json");

  read_report(o, c);
  if (path && c->is_done) {
    c->has_timeline = vg_timeline_read(path, &c->t, &err) >= 0;
    if (!c->has_timeline) snprintf(c->note, sizeof c->note, "%.250s", err.text);
  }
  if (c->has_timeline) c->critical = critical_of(&c->t);
  if (c->has_timeline && !c->digest[0])
    snprintf(c->digest, sizeof c->digest, "%.39s", c->t.digest);
  free(path);
}

/* --- comparing ----------------------------------------------------------- */

double vg_sweep_seconds(const struct vg_sweep_case *c)
{
  double total = c->t.seconds[VG_PHASE_TOTAL];

  return c->has_timeline && total > 0 ? total : c->wall;
}

const struct vg_sweep_case *vg_sweep_base(const struct vg_sweep *s)
{
  int fewest = INT_MAX;

  for (size_t i = 0; i < s->n; i++)
    if (s->item[i].ranks * s->item[i].threads < fewest)
      fewest = s->item[i].ranks * s->item[i].threads;
  for (size_t i = 0; i < s->n; i++)
    if (s->item[i].is_done && s->item[i].ranks * s->item[i].threads == fewest)
      return &s->item[i];
  return NULL;
}

double vg_sweep_speedup(const struct vg_sweep *s, double seconds)
{
  const struct vg_sweep_case *base = vg_sweep_base(s);

  if (!base || !(seconds > 0)) return NAN;
  return base->ranks * base->threads * vg_sweep_seconds(base) / seconds;
}

int vg_sweep_same_mesh(const struct vg_sweep_case *a,
                       const struct vg_sweep_case *b)
{
  return a->bisections == b->bisections && a->leaf_cells == b->leaf_cells &&
         a->way == b->way && a->subdomains == b->subdomains &&
         a->family == b->family;
}

double vg_sweep_field_cells(const struct vg_sweep_case *c)
{
  double sum = 0;

  if (!c->has_timeline) return NAN;
  for (size_t i = 0; i < c->t.spans.n; i++) /* repairs only modify cells */
    if (c->t.spans.span[i].kind != VG_SPAN_REPAIR)
      sum += (double)c->t.spans.span[i].n_cell;
  return sum;
}

double vg_sweep_cells_ratio(const struct vg_sweep *s,
                            const struct vg_sweep_case *c)
{
  const struct vg_sweep_case *one = NULL;

  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *k = &s->item[i];

    if (k->way != VG_DECOMPOSE_ADVANCING || !k->has_timeline) continue;
    if (!one ||
        (one->subdomains != c->subdomains && k->subdomains == c->subdomains))
      one = k;
  }
  return one ? vg_sweep_field_cells(c) / vg_sweep_field_cells(one) : NAN;
}

/* Name of the first file whose line differs between the two lists. */
static void first_difference(const char *a, const char *b, char *file)
{
  snprintf(file, 64, "some file");
  while (a && b && *a && *b) {
    size_t n = strcspn(a, "\n"), m = strcspn(b, "\n");

    if (n != m || strncmp(a, b, n)) {
      snprintf(file, 64, "%.*s", (int)strcspn(a, " \n"), a);
      return;
    }
    a += n + 1;
    b += n + 1;
  }
}

int vg_sweep_differ(const struct vg_sweep *s, size_t *n_compared,
                    const struct vg_sweep_case **a,
                    const struct vg_sweep_case **b, char *file)
{
  *n_compared = 0;
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *c = &s->item[i], *first = NULL;

    if (!c->is_done || !c->digest[0]) continue;
    for (size_t k = 0; k < i && !first; k++)
      if (s->item[k].is_done && s->item[k].digest[0] &&
          vg_sweep_same_mesh(c, &s->item[k]))
        first = &s->item[k];
    if (!first) continue;
    ++*n_compared;
    if (!strcmp(first->digest, c->digest)) continue;
    *a = first;
    *b = c;
    first_difference(first->files, c->files, file);
    return 1;
  }
  return 0;
}
