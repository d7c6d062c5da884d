/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard plan --replay: simulates the tasks of a recorded run on other
 * machines. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "cli/plan/plan.h"
#include "cli/plot/plot.h"
#include "cli/plot/timeline.h"
#include "run/common/json_build.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/report/report.h"

struct row {
  int ranks, threads;
  struct vg_model_result f;
};

struct plan {
  const struct vg_plan_options *o;
  struct vg_timeline t;
  struct vg_machine machine;
  struct row recorded; /* replay on the machine of the record */
  double measured;     /* seconds, total time of the recorded run */
  size_t n;
  struct row *row; /* [n] */
};

static vg_status replay(struct plan *p, int ranks, int threads, struct row *row,
                        struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  vg_status st;

  p->machine.ranks = ranks;
  p->machine.threads = threads;
  row->ranks = ranks;
  row->threads = threads;
  st = vg_model_replay(&p->t.spans, &p->machine, &row->f, NULL, &why);
  return st < 0 ? vg_fail(err, st, "%s: %s", p->o->replay, why.text) : VG_OK;
}

/* The requested schedule, by default that of the record. */
static vg_status choose_schedule(const struct plan *p, int *cyclic,
                                 struct vg_error *err)
{
  struct vg_settings s;
  vg_status st;

  vg_settings_default(&s);
  s.cyclic = p->t.cyclic;
  st = vg_cli_apply(&p->o->kept, &s, err);
  *cyclic = s.cyclic;
  vg_settings_release(&s);
  return st;
}

/* The ranks of the recorded machine are taken as one node. */
static vg_status replay_all(struct plan *p, struct vg_error *err)
{
  const struct vg_plan_options *o = p->o;
  int per_node = o->machine.ranks_per_node, cyclic;
  vg_status st;

  VG_TRY(choose_schedule(p, &cyclic, err));
  p->machine = o->machine;
  p->machine.cyclic = p->t.cyclic;
  p->machine.serial = o->serial;
  if (o->serial < 0) vg_timeline_outside(&p->t, &p->machine);
  p->machine.ranks_per_node = p->t.spans.n_rank;
  VG_TRY(replay(p, p->t.spans.n_rank, p->t.spans.n_thread, &p->recorded, err));
  p->measured = o->serial >= 0
                ? p->t.spans.wall + o->serial
                : fmax(p->t.spans.wall, p->t.seconds[VG_PHASE_TOTAL]);
  p->machine.ranks_per_node = per_node;
  p->machine.cyclic = cyclic;
  p->row = vg_alloc(o->ranks.n * o->threads.n, sizeof *p->row);
  if (!p->row) return vg_fail_memory(err, "the forecast");
  for (size_t t = 0; t < o->threads.n; t++)
    for (size_t r = 0; r < o->ranks.n; r++) {
      VG_TRY(replay(p, (int)o->ranks.v[r], (int)o->threads.v[t], &p->row[p->n],
                    err));
      p->n++;
    }
done:
  return st;
}

static double error_percent(const struct plan *p)
{
  return p->measured > 0 ? 100 * (p->recorded.f.wall / p->measured - 1) : 0;
}

static void print_text(const struct plan *p)
{
  const struct vg_spans *s = &p->t.spans;
  char cells[32];

  printf("%s\n"
         "\n"
         "Timeline %s\n"
         "  %d rank%s x %d thread%s, %zu tasks, %s cells; cut and fill %.3f "
         "s\n"
         "  outside the tasks, on one core: %.3f s serial, %.3f s parallel "
         "within a node, %.3f s parallel over all workers\n",
         p->t.title, p->o->replay, (int)s->n_rank, s->n_rank > 1 ? "s" : "",
         (int)s->n_thread, s->n_thread > 1 ? "s" : "", s->n,
         vg_text_count((unsigned long long)p->t.n_cell, cells), s->wall,
         p->machine.serial, p->machine.by_node, p->machine.by_all);
  printf("  loops of front updates (joins), which idle threads of a rank "
         "share: %.3f s\n",
         vg_spans_loops(s));
  printf("  same machine: replayed %.3f s, measured %.3f s (%+.1f %%)\n",
         p->recorded.f.wall, p->measured, error_percent(p));
  printf("\nForecast%s\n  ranks threads workers       time  speed-up  "
         "efficiency   critical   cuts end  cuts extra  idle  imbalance   sent"
         "\n",
         p->machine.cyclic ? ", leaves assigned in turn (cyclic)" : "");
  printf("                               s                     %%          s"
         "          s     %%     %%     %%                MB\n");
  for (size_t i = 0; i < p->n; i++) {
    const struct row *r = &p->row[i];

    printf("  %5d %7d %7d %10.3f %9.2f %11.1f %10.3f %10.3f %5.1f %5.1f "
           "%5.1f %10.3f %6.0f\n",
           r->ranks, r->threads, r->ranks * r->threads, r->f.wall, r->f.speedup,
           100 * r->f.efficiency, r->f.critical, r->f.cuts_wall,
           100 * r->f.cuts, 100 * r->f.cuts_extra, 100 * r->f.idle,
           r->f.imbalance, r->f.bytes / 1e6);
  }
}

static json_t *row_json(const struct row *r)
{
  return json_pack("{s:i s:i s:i s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f}",
                   "ranks", r->ranks, "threads", r->threads, "workers",
                   r->ranks * r->threads, "seconds", r->f.wall, "work",
                   r->f.work, "speedup", r->f.speedup, "efficiency",
                   r->f.efficiency, "critical", r->f.critical, "cuts",
                   r->f.cuts, "cuts_extra", r->f.cuts_extra, "cuts_end",
                   r->f.cuts_wall, "idle", r->f.idle, "imbalance",
                   r->f.imbalance, "bytes_sent", r->f.bytes);
}

static vg_status print_json(const struct plan *p, struct vg_error *err)
{
  json_t *o = json_object(), *list = json_array();
  vg_status st;

  json_object_set_new(o, "title", vg_text_json(p->t.title));
  json_object_set_new(o, "record", vg_text_json(p->o->replay));
  json_object_set_new(o, "tasks", json_integer((json_int_t)p->t.spans.n));
  json_object_set_new(o, "serial", json_real(p->machine.serial));
  json_object_set_new(o, "by_node", json_real(p->machine.by_node));
  json_object_set_new(o, "by_all", json_real(p->machine.by_all));
  json_object_set_new(o, "loops", json_real(vg_spans_loops(&p->t.spans)));
  json_object_set_new(o, "machine",
                      json_pack("{s:i s:f s:f s:f s:b s:b s:i}",
                                "ranks_per_node", p->machine.ranks_per_node,
                                "latency", p->machine.latency, "bandwidth",
                                p->machine.bandwidth, "rate", p->machine.rate,
                                "joins_roam", p->machine.joins_roam, "cyclic",
                                p->machine.cyclic, "loop_threads",
                                p->machine.loop_threads));
  json_object_set_new(o, "recorded",
                      json_pack("{s:i s:i s:f s:f s:f}", "ranks",
                                p->recorded.ranks, "threads",
                                p->recorded.threads, "measured", p->measured,
                                "replayed", p->recorded.f.wall, "error_percent",
                                error_percent(p)));
  for (size_t i = 0; i < p->n; i++)
    json_array_append_new(list, row_json(&p->row[i]));
  json_object_set_new(o, "forecast", list);
  st = vg_json_print(stdout, o, 0, "the forecast", err);
  json_decref(o);
  return st;
}

static int by_workers(const void *a, const void *b)
{
  const struct row *s = a, *t = b;
  int n = s->ranks * s->threads, m = t->ranks * t->threads;

  return n != m ? n - m : s->ranks - t->ranks;
}

/* Plot all rows as one curve over the number of workers. */
static vg_status draw(struct plan *p, struct vg_error *err)
{
  double *v = vg_alloc(2 * p->n, sizeof *v);
  struct vg_plot_series one = { "model", 0, 1, p->n, v, v + p->n };
  char subtitle[128];
  vg_status st;

  if (!v) return vg_fail_memory(err, "a figure");
  qsort(p->row, p->n, sizeof *p->row, by_workers);
  for (size_t i = 0; i < p->n; i++) {
    v[i] = p->row[i].ranks * p->row[i].threads;
    v[p->n + i] = p->row[i].f.speedup;
  }
  snprintf(subtitle, sizeof subtitle, "replay of %zu tasks", p->t.spans.n);
  st = vg_plot_speedup(p->o->plot, p->t.title, subtitle, 1, &one, err);
  free(v);
  return st;
}

int vg_plan_replay(const struct vg_plan_options *o)
{
  struct plan p = { .o = o };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  VG_TRY(vg_timeline_read(o->replay, &p.t, &err));
  VG_TRY(replay_all(&p, &err));
  if (o->json) VG_TRY(print_json(&p, &err));
  else print_text(&p);
  if (o->plot) VG_TRY(draw(&p, &err));
done:
  free(p.row);
  vg_timeline_release(&p.t);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
