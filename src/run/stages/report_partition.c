/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on the domain decomposition, as text and as JSON. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/stages/run.h"

/* Cells of the leaves. Fragments (small components of the front) are filled
 * together in one task, since they are too small for a task each; its path ends
 * with ".r". */
struct leaves {
  size_t n, n_fragment;
  uint64_t *cells; /* [n] in ascending order, without fragments */
  uint64_t fragment_cells;
};

static int by_size(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

  return (x > y) - (x < y);
}

static int is_fragment(const struct vg_span *s)
{
  size_t n = strlen(s->path);

  return n > 3 && !strcmp(s->path + n - 3, ".rL");
}

/* No leaves if out of memory. */
static struct leaves leaves_of(const struct vg_spans *s)
{
  struct leaves l = { .cells = vg_alloc(s->n, sizeof *l.cells) };

  for (size_t i = 0; i < s->n && l.cells; i++) {
    const struct vg_span *span = &s->span[i];

    if (span->kind != VG_SPAN_LEAF || !span->n_cell) continue;
    if (is_fragment(span)) {
      l.n_fragment++;
      l.fragment_cells += span->n_cell;
    } else {
      l.cells[l.n++] = span->n_cell;
    }
  }
  if (l.n) qsort(l.cells, l.n, sizeof *l.cells, by_size);
  return l;
}

static void print_leaves(FILE *to, const struct leaves *l)
{
  char a[32], b[32], c[32];

  fprintf(to, "  leaves (subdomains that are filled) %s",
          vg_text_count(l->n, a));
  if (l->n > 1)
    fprintf(to, ": %s to %s cells, median %s", vg_text_count(l->cells[0], a),
            vg_text_count(l->cells[l->n - 1], b),
            vg_text_count(l->cells[(l->n - 1) / 2], c));
  fprintf(to, "\n");
  if (l->n_fragment)
    fprintf(to, "  and %s of small components filled together, %s cells\n",
            vg_text_count(l->n_fragment, a),
            vg_text_count(l->fragment_cells, b));
}

/* Cells that repairs and swaps across interfaces have added to those of the
 * tasks, or, if negative, removed. */
static int64_t repair_cells(const struct vg_run *r, const struct leaves *l)
{
  uint64_t tasks = r->partition.n_zone_cell + l->fragment_cells;

  for (size_t i = 0; i < l->n; i++) tasks += l->cells[i];
  return (int64_t)(r->n_field_cell - tasks);
}

static double share_of(const struct vg_run *r, uint64_t n)
{
  return r->n_field_cell ? 100 * (double)n / (double)r->n_field_cell : 0;
}

/* Largest number of cells of a leaf over the mean. */
static double balance(const struct leaves *l)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) sum += (double)l->cells[i];
  return l->n ? (double)l->cells[l->n - 1] * (double)l->n / sum : 1;
}

/* The decomposition by discrete or octree, made before anything is filled. */
static void print_decomposition(FILE *to, const struct vg_run *r,
                                const struct leaves *l)
{
  const struct vg_partition_report *p = &r->partition;
  const struct vg_decomposition_report *q = &p->decomposition;
  char a[32], b[32];

  if (!p->n_part) return;
  fprintf(to,
          "  decomposition %s; subdomains: %s (requested: %s; added for "
          "disconnected pieces: %llu),\n"
          "  balance %.3f (max/mean of the cells generated in leaves)\n",
          r->decomposition, vg_text_count(p->n_part, a),
          vg_text_count(q->n_asked, b), (unsigned long long)q->n_apart,
          balance(l));
  fprintf(to, "  %s %s, coarsening %.2f, %s interface triangles\n",
          vg_text_count(q->n_coarse, a), q->n_gap ? "octants" : "coarse cells",
          q->coarsening, vg_text_count(q->n_face, b));
  if (q->n_gap)
    fprintf(to,
            "  subdomains in the gap region at the front, which planes may "
            "cut: %s; octants\n"
            "  contain %.1f %% of the expected cells%s\n",
            vg_text_count(q->n_gap, a), 100 * q->coarse_cells / p->estimate,
            q->n_coarse ? ""
                        : ": there is no room for octants away from the "
                          "front");
  fprintf(to,
          "  time (s): %s %.2f, assignment %.2f, smoothing of interfaces "
          "%.2f, subdivision %.2f\n",
          q->n_gap ? "octants" : "coarse cells",
          q->time[VG_DECOMPOSITION_COARSE], q->time[VG_DECOMPOSITION_GRAPH],
          q->time[VG_DECOMPOSITION_SMOOTH], q->time[VG_DECOMPOSITION_FACES]);
}

static json_t *count(uint64_t n)
{
  return json_integer((json_int_t)n);
}

static void put_decomposition(const struct vg_run *r, const struct leaves *l,
                              json_t *o)
{
  const struct vg_partition_report *p = &r->partition;
  json_t *decomposition;

  json_object_set_new(o, "decomposition", json_string(r->decomposition));
  json_object_set_new(o, "schedule",
                      json_string(r->cyclic ? "cyclic" : "dynamic"));
  json_object_set_new(o, "balance", json_real(balance(l)));
  if (r->near.n_cell)
    json_object_set_new(o, "near_interfaces",
                        json_pack("{s:I s:f s:f}", "cells",
                                  (json_int_t)r->near.n_cell, "angle_min",
                                  r->near.angle_min, "angle_min_p1",
                                  r->near.angle_min_p1));
  if (!p->n_part) return;
  decomposition = json_object();
  json_object_set_new(decomposition, "count", count(p->n_part));
  vg_report_entries(decomposition, decomposition, &vg_decomposition_entries,
                    &p->decomposition);
  json_object_set_new(o, "subdomains", decomposition);
}

void vg_report_partition_text(FILE *to, const struct vg_run *r)
{
  const struct vg_partition_report *p = &r->partition;
  struct leaves l = leaves_of(&r->spans);
  char a[32], b[32], c[32];

  fprintf(to, "  %d rank%s x %d thread%s; %s cells expected, %s generated\n",
          r->size, r->size > 1 ? "s" : "", r->threads,
          r->threads > 1 ? "s" : "",
          vg_text_count((unsigned long long)p->estimate, a),
          vg_text_count(r->n_field_cell, b));
  print_decomposition(to, r, &l);
  fprintf(to,
          "  cuts %s; edge separators (pencils) %s, face separators (tiles) "
          "%s: %.1f %% of the cells\n",
          vg_text_count(p->n_node, a), vg_text_count(p->n_pencil, b),
          vg_text_count(p->n_tile, c), share_of(r, p->n_zone_cell));
  print_leaves(to, &l);
  if (p->n_widened)
    fprintf(to,
            "  subdomains that could not be filled and were extended by "
            "their neighbours: %s,\n"
            "  %s cells regenerated in %.2f s\n",
            vg_text_count(p->n_widened, a), vg_text_count(p->n_widened_cell, b),
            p->widened);
  if (p->n_blocked || p->n_retry || p->n_uncut || p->n_outgrown)
    fprintf(to,
            "  separators abandoned %s, cuts repeated elsewhere %s, overloaded "
            "leaves cut %s, leaves left too large %llu\n",
            vg_text_count(p->n_blocked, a), vg_text_count(p->n_retry, b),
            vg_text_count(p->n_outgrown, c), (unsigned long long)p->n_uncut);
  if (p->n_open_left)
    fprintf(to,
            "  separators not made, since the void would stay connected in "
            "too many places (filled as leaves): %llu\n",
            (unsigned long long)p->n_open_left);
  fprintf(to, "  repair across interfaces: %s point moves, %s swaps; ",
          vg_text_count(p->n_repair_moved, a),
          vg_text_count(p->n_repair_swapped, b));
  fprintf(to, "%s of %s poor regions repaired, %+lld cells, %.2f s\n",
          vg_text_count(p->n_repaired, a), vg_text_count(p->n_repair, b),
          (long long)repair_cells(r, &l), p->repair);
  if (r->near.n_cell)
    fprintf(to,
            "  cells within two layers of cells of an interface: %s; 1st "
            "percentile of the smallest angle\n  %.2f degrees, smallest %.2f\n",
            vg_text_count(r->near.n_cell, a), r->near.angle_min_p1,
            r->near.angle_min);
  free(l.cells);
  fprintf(to, "  workers busy %.1f %%, imbalance %.3f (max/mean)%s\n",
          100 * vg_spans_busy(&r->spans), vg_spans_imbalance(&r->spans),
          r->cyclic ? "; leaves assigned in turn (cyclic)" : "");
  if (!r->store) return;
  fprintf(to, "  tasks reused from %s: %s\n", r->options.dir,
          vg_text_count(p->n_found, a));
  if (*r->stored.stopped)
    fprintf(to, "  not all tasks were stored there: %s\n", r->stored.stopped);
}

json_t *vg_report_partition_json(const struct vg_run *r)
{
  const struct vg_partition_report *p = &r->partition;
  struct leaves l = leaves_of(&r->spans);
  const struct {
    const char *name;
    uint64_t n;
  } row[] = {
    { "ranks", (uint64_t)r->size },
    { "threads", (uint64_t)r->threads },
    { "leaves", l.n },
    { "fragment_leaves", l.n_fragment },
    { "fragment_cells", l.fragment_cells },
    { "repair_regions", p->n_repair },
    { "repair_regions_improved", p->n_repaired },
    { "repair_region_cells", p->n_repair_cell },
    { "points_moved_across", p->n_repair_moved },
    { "swaps_across", p->n_repair_swapped },
  };
  json_t *o = json_object(), *leaves = json_array();
  json_int_t by_repair = repair_cells(r, &l);

  for (size_t i = 0; i < sizeof row / sizeof *row; i++)
    json_object_set_new(o, row[i].name, count(row[i].n));
  vg_report_entries(o, o, &vg_partition_entries, p);
  for (size_t i = 0; i < l.n; i++)
    json_array_append_new(leaves, count(l.cells[i]));
  put_decomposition(r, &l, o);
  free(l.cells);
  json_object_set_new(o, "leaf_cells", leaves);
  json_object_set_new(o, "repair_cells", json_integer(by_repair));
  json_object_set_new(o, "subdomains_extended_seconds", json_real(p->widened));
  json_object_set_new(o, "repair_seconds", json_real(p->repair));
  json_object_set_new(o, "busy", json_real(vg_spans_busy(&r->spans)));
  json_object_set_new(o, "imbalance", json_real(vg_spans_imbalance(&r->spans)));
  json_object_set_new(o, "memory_of_all_ranks_bytes", json_real(r->memory_sum));
  return o;
}
