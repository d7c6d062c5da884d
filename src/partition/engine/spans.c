/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/engine/spans.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_spans_release(struct vg_spans *s)
{
  struct vg_spans empty = VG_SPANS_INIT;

  free(s->span);
  free(s->help);
  *s = empty;
}

vg_status vg_spans_add(struct vg_spans *s, const struct vg_span *span,
                       struct vg_error *err)
{
  assert(span && memchr(span->path, 0, sizeof span->path));
  if (vg_reserve(&s->span, &s->cap, s->n + 1, sizeof *s->span))
    return vg_fail_memory(err, "the trace of tasks");
  s->span[s->n++] = *span;
  return VG_OK;
}

vg_status vg_spans_add_help(struct vg_spans *s, const struct vg_help *help,
                            struct vg_error *err)
{
  assert(help && memchr(help->path, 0, sizeof help->path));
  if (vg_reserve(&s->help, &s->cap_help, s->n_help + 1, sizeof *s->help))
    return vg_fail_memory(err, "the trace of tasks");
  s->help[s->n_help++] = *help;
  return VG_OK;
}

static int by_path(const void *a, const void *b)
{
  const struct vg_span *s = a, *t = b;
  int order = strcmp(s->path, t->path);

  return order ? order : s->kind - t->kind;
}

static int by_worker(const void *a, const void *b)
{
  const struct vg_help *s = a, *t = b;
  int order = strcmp(s->path, t->path);

  if (order) return order;
  if (s->rank != t->rank) return s->rank - t->rank;
  if (s->thread != t->thread) return s->thread - t->thread;
  return (s->start > t->start) - (s->start < t->start);
}

void vg_spans_sort(struct vg_spans *s)
{
  if (s->n_help) qsort(s->help, s->n_help, sizeof *s->help, by_worker);
  if (s->n) qsort(s->span, s->n, sizeof *s->span, by_path);
}

vg_status vg_spans_append(struct vg_spans *s, const struct vg_spans *more,
                          struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(more && s != more);
  for (size_t k = 0; k < more->n && st == VG_OK; k++) {
    struct vg_span span = more->span[k];

    span.start += s->wall;
    span.end += s->wall;
    st = vg_spans_add(s, &span, err);
  }
  for (size_t k = 0; k < more->n_help && st == VG_OK; k++) {
    struct vg_help help = more->help[k];

    help.start += s->wall;
    help.end += s->wall;
    st = vg_spans_add_help(s, &help, err);
  }
  s->wall += more->wall;
  vg_spans_sort(s);
  return st;
}

/* Sum and maximum of the workers' busy time. */
static void busy(const struct vg_spans *s, double *sum, double *most)
{
  size_t n = (size_t)(s->n_rank * s->n_thread);
  double *time = vg_calloc(n, sizeof *time);

  *sum = *most = 0;
  for (size_t i = 0; time && i < s->n; i++)
    time[s->span[i].rank * s->n_thread + s->span[i].thread] += s->span[i].end -
                                                               s->span[i].start;
  for (size_t i = 0; time && i < s->n_help; i++)
    time[s->help[i].rank * s->n_thread + s->help[i].thread] += s->help[i].end -
                                                               s->help[i].start;
  for (size_t i = 0; time && i < n; i++) {
    *sum += time[i];
    if (time[i] > *most) *most = time[i];
  }
  free(time);
}

double vg_spans_busy(const struct vg_spans *s)
{
  double sum, most, all = s->wall * s->n_rank * s->n_thread;

  busy(s, &sum, &most);
  return all > 0 ? sum / all : 0;
}

double vg_spans_imbalance(const struct vg_spans *s)
{
  double sum, most;

  busy(s, &sum, &most);
  return sum > 0 ? most * s->n_rank * s->n_thread / sum : 1;
}

double vg_spans_loops(const struct vg_spans *s)
{
  double sum = 0;

  for (size_t i = 0; i < s->n; i++) sum += s->span[i].loops;
  return sum;
}
