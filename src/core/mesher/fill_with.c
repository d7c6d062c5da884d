/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The parent's side of meshers in child processes: core/mesher/mesher_parts.h.
 */
#include "core/mesher/fill_with.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/helper/helper.h"
#include "base/memory.h"
#include "core/mesher/mesher_parts.h"

/* Slow meshers make a thousand cells per second, and about ten cells per
 * triangle. */
static const double time_limit = 600, time_limit_per_face = 0.05; /* K31 */
static const double silence = 10; /* limit without any message, relative to
                                     the processor time */

static const uint64_t n_max = UINT32_MAX / 8 - 1; /* limit of cell_links.h */

struct vg_mesher_pool {
  struct vg_mesher_spec spec;
  int is_helper; /* 1: each void has a new process of vanguard-tetgen */
  double time_limit, time_limit_per_face;
  pthread_mutex_t lock;
  size_t n, room;
  struct vg_child *idle; /* [n] idle processes that have loaded the mesher */
};

/* --- processes ------------------------------------------------------------ */

static vg_status start(struct vg_mesher_pool *p, struct vg_child *c,
                       struct vg_error *err)
{
  struct vg_mesher_hello hello;
  vg_status st = VG_OK;

  if (vg_child_open(vg_mesher_serve, c) < 0)
    return vg_fail_memory(err, "a process for a mesher");
  if (!vg_child_put(c->fd, &p->spec, sizeof p->spec) ||
      !vg_child_get(c->fd, &hello, sizeof hello))
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "mesher %s: the process that loads "
                 "it ended; the library crashes when it is loaded or when "
                 "its plug-in function is called",
                 p->spec.name);
  else if (!hello.is_ready)
    st = vg_fail(err, VG_ERR_UNSUPPORTED, "mesher %s: %.500s", p->spec.name,
                 hello.text);
  if (st < 0) vg_child_close(c);
  return st;
}

/* Get a process that can fill a void. */
static vg_status borrow(struct vg_mesher_pool *p, struct vg_child *c,
                        struct vg_link *l, struct vg_error *err)
{
  int is_idle;
  vg_status st = VG_OK;

  if (p->is_helper)
    return vg_helper_open(VG_HELPER_TETGEN, l->stop, l->silence, c, l, err);
  pthread_mutex_lock(&p->lock);
  is_idle = p->n > 0;
  if (is_idle) *c = p->idle[--p->n];
  pthread_mutex_unlock(&p->lock);
  if (!is_idle) st = start(p, c, err);
  if (st == VG_ERR_UNSUPPORTED) /* it was supported when it was opened */
    st = vg_fail(err, VG_ERR_IO, "mesher %.200s no longer starts",
                 p->spec.name);
  l->fd = c->fd;
  return st;
}

static void give_back(struct vg_mesher_pool *p, struct vg_child *c)
{
  int refused;

  pthread_mutex_lock(&p->lock);
  refused = vg_reserve(&p->idle, &p->room, p->n + 1, sizeof *p->idle);
  if (!refused) p->idle[p->n++] = *c;
  pthread_mutex_unlock(&p->lock);
  if (refused) vg_child_close(c);
}

/* Try a mesher when it is opened, so that a run fails at its start. */
static vg_status test(struct vg_mesher_pool *p, struct vg_error *err)
{
  struct vg_helper h;
  struct vg_child c;
  vg_status st;

  if (p->is_helper) {
    vg_helper_find(VG_HELPER_TETGEN, &h);
    return h.is_found ? VG_OK
                      : vg_fail(err, VG_ERR_UNSUPPORTED, "mesher %s: %s",
                                p->spec.name, h.why);
  }
  st = start(p, &c, err);
  if (st == VG_OK) give_back(p, &c);
  return st;
}

vg_status vg_mesher_open(const char *name, struct vg_mesher_pool **out,
                         struct vg_error *err)
{
  struct vg_mesher_pool *p = vg_calloc(1, sizeof *p);
  vg_status st;

  assert(name && out);
  if (!p) return vg_fail_memory(err, "a mesher");
  pthread_mutex_init(&p->lock, NULL);
  p->time_limit = time_limit;
  p->time_limit_per_face = time_limit_per_face;
  if ((size_t)snprintf(p->spec.name, sizeof p->spec.name, "%s", name) >=
      sizeof p->spec.name) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "mesher %.60s...: the path is too "
                 "long",
                 name);
  } else {
    p->is_helper = !strcmp(name, "tetgen");
    st = test(p, err);
  }
  if (st < 0) {
    vg_mesher_close(p);
    return st;
  }
  *out = p;
  return VG_OK;
}

void vg_mesher_close(struct vg_mesher_pool *p)
{
  if (!p) return;
  for (size_t k = 0; k < p->n; k++) vg_child_close(&p->idle[k]);
  free(p->idle);
  pthread_mutex_destroy(&p->lock);
  free(p);
}

void vg_mesher_set_time_limit(struct vg_mesher_pool *p, double seconds,
                              double seconds_each)
{
  assert(p && seconds >= 0 && seconds_each >= 0);
  p->time_limit = seconds;
  p->time_limit_per_face = seconds_each;
}

/* --- a void --------------------------------------------------------------- */

enum outcome { FILLED, TOO_MANY, FAILED, CRASHED, WRONG };

struct filling {
  struct vg_mesher_pool *pool;
  struct vg_link *link;
  enum outcome outcome;
  int n_crash;
  size_t n_hole;
  double (*hole)[3]; /* [n_hole] a point in each hollow of the front */
  const struct vg_front *front;
  const struct vg_sizing *sizing;
  const struct vg_fill_options *options;
  double seconds;
  size_t n, n_cell;
  double (*x)[3]; /* [n] points of the front first */
  uint32_t (*cell)[4];
};

/* Put a point into each hollow, closely behind its largest triangle. */
static vg_status find_holes(const struct vg_front *v, size_t *n,
                            double (**hole)[3], struct vg_error *err)
{
  const struct vg_mesher_front f = { v->n_point, v->n_face,
                                     (const double(*)[3])v->x,
                                     (const uint32_t(*)[3])v->face };
  struct vg_mesher_shells shells;

  *n = 0;
  *hole = NULL;
  if (vg_mesher_find_shells(&f, &shells))
    return vg_fail_memory(err, "the shells of a front");
  *hole = vg_alloc(shells.n_hollow, sizeof **hole);
  for (size_t s = 0; *hole && s < shells.n; s++) {
    const uint32_t *face = f.face[shells.largest[s]];
    double normal[3], length = 0;

    if (!shells.is_hollow[s]) continue;
    vg_mesher_normal(&f, shells.largest[s], normal);
    for (int k = 0; k < 3; k++) length += normal[k] * normal[k];
    length = sqrt(sqrt(length)); /* about an edge length */
    for (int k = 0; k < 3; k++)
      (*hole)[*n][k] = (f.x[face[0]][k] + f.x[face[1]][k] + f.x[face[2]][k]) /
                         3 -
                       1e-4 * normal[k] / length;
    ++*n;
  }
  vg_mesher_shells_release(&shells);
  return *hole ? VG_OK : vg_fail_memory(err, "the holes of a front");
}

static int put_job(struct filling *f)
{
  const struct vg_front *v = f->front;
  const struct vg_helper_message job = { .what = VG_HELPER_FILL,
                                         .n = { v->n_point, v->n_face,
                                                f->n_hole },
                                         .value = { f->seconds, 0 } };

  return vg_link_put(f->link, &job, sizeof job) &&
         vg_link_put(f->link, v->x, v->n_point * sizeof *v->x) &&
         vg_link_put(f->link, v->face, v->n_face * sizeof *v->face) &&
         vg_link_put(f->link, f->hole, f->n_hole * sizeof *f->hole);
}

static int answer_sizes(struct filling *f, uint64_t n)
{
  const struct vg_helper_message a = { .what = VG_HELPER_LENGTHS, .n = { n } };
  double x[64][3], h[64];

  if (n > 64) return 0; /* more would fill the sockets of both sides */
  if (!vg_link_get(f->link, x, n * sizeof *x)) return 0;
  vg_sizing_eval(f->sizing, n, (const double(*)[3])x, h);
  return vg_link_put(f->link, &a, sizeof a) &&
         vg_link_put(f->link, h, n * sizeof *h);
}

static void release_cells(struct filling *f)
{
  free(f->x);
  free(f->cell);
  f->x = NULL;
  f->cell = NULL;
}

static vg_status take_cells(struct filling *f,
                            const struct vg_helper_message *w,
                            struct vg_error *err)
{
  size_t n_front = f->front->n_point;
  double(*added)[3];

  f->outcome = f->options->point_limit && w->n[0] > f->options->point_limit
               ? TOO_MANY
             : w->n[1] > n_max || w->n[0] > n_max ? WRONG
                                                  : FILLED;
  if (f->outcome != FILLED) return VG_OK;
  added = vg_link_get_array(f->link, w->n[0], sizeof *added);
  f->n = n_front + w->n[0];
  f->n_cell = w->n[1];
  f->x = vg_alloc(f->n, sizeof *f->x);
  if (added && f->x) {
    memcpy(f->x, f->front->x, n_front * sizeof *f->x);
    if (w->n[0]) memcpy(f->x + n_front, added, w->n[0] * sizeof *f->x);
    f->cell = vg_link_get_array(f->link, w->n[1], sizeof *f->cell);
  }
  free(added);
  if (f->cell) return VG_OK;
  return f->link->state == VG_LINK_OPEN
         ? vg_fail_memory(err, "the cells of a void")
         : vg_helper_lost(f->link, 0, f->pool->spec.name, err);
}

static vg_status run_job(struct filling *f, struct vg_error *err)
{
  struct vg_helper_message w = { .what = 0 };
  int is_open = put_job(f);

  while (is_open && vg_link_get(f->link, &w, sizeof w) &&
         w.what == VG_HELPER_SIZES)
    is_open = answer_sizes(f, w.n[0]);
  if (f->link->state == VG_LINK_OPEN && w.what == VG_HELPER_CELLS)
    return take_cells(f, &w, err);
  f->outcome = w.what == VG_HELPER_NONE ? FAILED : CRASHED;
  if (f->outcome == FAILED) return VG_OK;
  if (w.what != VG_HELPER_FAILED) w.option = 0;
  if (w.option == VG_HELPER_CRASHED)
    return f->n_crash++ ? VG_OK : VG_BLOCKED; /* it must happen twice */
  return vg_helper_lost(f->link, w.option, f->pool->spec.name, err);
}

/* Fill the void in a process. */
static vg_status attempt(void *user, struct vg_error *err)
{
  struct filling *f = user;
  struct vg_mesher_pool *p = f->pool;
  struct vg_link l = { .stop = &f->options->stop,
                       .silence = silence * f->seconds };
  struct vg_child c;
  vg_status st;

  release_cells(f);
  f->link = &l;
  if ((st = borrow(p, &c, &l, err)) < 0) return st;
  st = run_job(f, err);
  if (p->is_helper) vg_helper_close(&c);
  else if (st == VG_OK && (f->outcome == FILLED || f->outcome == FAILED))
    give_back(p, &c);
  else vg_child_close(&c);
  return st;
}

/* Store the checked cells, without the points of the front. */
static vg_status take(struct filling *f, struct vg_filled *out,
                      struct vg_error *err)
{
  size_t n_front = f->front->n_point, n_new = f->n - n_front;

  out->x = vg_alloc(n_new, sizeof *out->x);
  if (!out->x) return vg_fail_memory(err, "the cells of the mesh");
  if (n_new) memcpy(out->x, f->x + n_front, n_new * sizeof *out->x);
  out->n_point = n_new;
  out->cell = f->cell;
  out->n_cell = f->n_cell;
  f->cell = NULL;
  return VG_OK;
}

static vg_status judge(struct filling *f, struct vg_filled *out,
                       struct vg_fill_report *r, struct vg_error *err)
{
  const struct vg_front *front = f->front;
  const char *wrong;
  vg_status st = vg_mesher_check(front->n_point, front->n_face,
                                 (const uint32_t(*)[3])front->face, &f->n, f->x,
                                 f->n_cell, f->cell, &wrong, err);

  if (st == VG_NOT_BETTER) r->n_other_wrong++;
  if (st != VG_OK) return st;
  st = take(f, out, err);
  if (st < 0) return st;
  r->n_other++;
  r->n_other_cell += out->n_cell;
  r->n_placed += out->n_point;
  r->n_inserted += out->n_point;
  return VG_OK;
}

vg_status vg_mesher_fill(struct vg_mesher_pool *p, const struct vg_front *front,
                         const struct vg_sizing *sizing,
                         const struct vg_fill_options *options,
                         struct vg_filled *out, struct vg_fill_report *report,
                         struct vg_error *err)
{
  struct filling f = { .pool = p,
                       .front = front,
                       .sizing = sizing,
                       .options = options,
                       .seconds = p->time_limit + p->time_limit_per_face *
                                                    (double)front->n_face };
  double t = vg_clock();
  vg_status st;

  assert(p && sizing && options && report);
  assert(!out->n_point && !out->n_cell && !out->x && !out->cell);
  if (!front->n_face) return VG_OK;
  if (p->is_helper) VG_TRY(find_holes(front, &f.n_hole, &f.hole, err));
  do st = vg_helper_repeat(attempt, &f, &options->stop, err);
  while (st == VG_BLOCKED);
  if (st < 0) goto done;
  st = VG_NOT_BETTER;
  switch (f.outcome) {
  case FILLED: st = judge(&f, out, report, err); break;
  case TOO_MANY:
    st = vg_fail(err, VG_ERR_UNSUPPORTED, "a void needs more than %llu points",
                 (unsigned long long)options->point_limit);
    break;
  case FAILED: report->n_other_failed++; break;
  case CRASHED: report->n_other_ended++; break;
  case WRONG: report->n_other_wrong++; break;
  }
done:
  free(f.hole);
  release_cells(&f);
  report->time_total += vg_clock() - t;
  report->time_other += vg_clock() - t;
  return st;
}
