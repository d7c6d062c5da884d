/* The parent's side of meshers in child processes: core/mesher/mesher_parts.h.
 */
#include "core/mesher/fill_with.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/child.h"
#include "base/clock.h"
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

static vg_status borrow(struct vg_mesher_pool *p, struct vg_child *c,
                        struct vg_error *err)
{
  int is_idle;

  pthread_mutex_lock(&p->lock);
  is_idle = p->n > 0;
  if (is_idle) *c = p->idle[--p->n];
  pthread_mutex_unlock(&p->lock);
  return is_idle ? VG_OK : start(p, c, err);
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

vg_status vg_mesher_open(const char *name, struct vg_mesher_pool **out,
                         struct vg_error *err)
{
  struct vg_mesher_pool *p = vg_calloc(1, sizeof *p);
  struct vg_child c;
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
    st = start(p, &c, err);
  }
  if (st < 0) {
    vg_mesher_close(p);
    return st;
  }
  give_back(p, &c);
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

enum outcome { FILLED, STOPPED, TOO_MANY, FAILED, ENDED };

struct filling {
  int fd;
  const struct vg_front *front;
  const struct vg_sizing *sizing;
  const struct vg_fill_options *options;
  double seconds;
  size_t n, n_cell;
  double (*x)[3]; /* [n] points of the front first */
  uint32_t (*cell)[4];
};

/* Wait until data can be read. */
static enum outcome await(const struct filling *f)
{
  double end = vg_clock() + silence * f->seconds;
  struct pollfd p = { f->fd, POLLIN, 0 };

  for (;;) {
    int n = poll(&p, 1, 100);

    if (n > 0) return FILLED;
    if (n < 0 && errno != EINTR) return ENDED;
    if (vg_stops(&f->options->stop)) return STOPPED;
    if (vg_clock() > end) return ENDED;
  }
}

static int put_job(const struct filling *f)
{
  const struct vg_front *v = f->front;
  const struct vg_mesher_job job = { v->n_point, v->n_face, f->seconds };

  return vg_child_put(f->fd, &job, sizeof job) &&
         vg_child_put(f->fd, v->x, v->n_point * sizeof *v->x) &&
         vg_child_put(f->fd, v->face, v->n_face * sizeof *v->face);
}

static int answer_sizes(const struct filling *f, uint64_t n)
{
  double x[64][3], h[64];

  for (size_t here; n; n -= here) {
    here = n < 64 ? n : 64;
    if (!vg_child_get(f->fd, x, here * sizeof *x)) return 0;
    vg_sizing_eval(f->sizing, here, (const double(*)[3])x, h);
    if (!vg_child_put(f->fd, h, here * sizeof *h)) return 0;
  }
  return 1;
}

static enum outcome take_cells(struct filling *f,
                               const struct vg_mesher_word *w)
{
  size_t n_front = f->front->n_point;

  if (f->options->point_limit && w->n > f->options->point_limit)
    return TOO_MANY;
  if (w->n_cell > n_max || w->n > n_max) return ENDED;
  f->n = n_front + w->n;
  f->n_cell = w->n_cell;
  f->x = vg_alloc(f->n, sizeof *f->x);
  f->cell = vg_alloc(f->n_cell, sizeof *f->cell);
  if (!f->x || !f->cell) return ENDED;
  memcpy(f->x, f->front->x, n_front * sizeof *f->x);
  if (!vg_child_get(f->fd, f->x + n_front, w->n * sizeof *f->x) ||
      !vg_child_get(f->fd, f->cell, w->n_cell * sizeof *f->cell))
    return ENDED;
  return FILLED;
}

static enum outcome run_job(struct filling *f)
{
  struct vg_mesher_word w;

  if (!put_job(f)) return ENDED;
  for (;;) {
    enum outcome waited = await(f);

    if (waited != FILLED) return waited;
    if (!vg_child_get(f->fd, &w, sizeof w)) return ENDED;
    if (w.what == VG_WORD_CELLS) return take_cells(f, &w);
    if (w.what == VG_WORD_NONE) return FAILED;
    if (w.what != VG_WORD_SIZES || !answer_sizes(f, w.n)) return ENDED;
  }
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
  struct filling f = { .front = front,
                       .sizing = sizing,
                       .options = options,
                       .seconds = p->time_limit + p->time_limit_per_face *
                                                    (double)front->n_face };
  double t = vg_clock();
  struct vg_child c;
  enum outcome o;
  vg_status st;

  assert(p && sizing && options && report);
  assert(!out->n_point && !out->n_cell && !out->x && !out->cell);
  if (!front->n_face) return VG_OK;
  st = borrow(p, &c, err);
  if (st < 0) return st;
  f.fd = c.fd;
  o = run_job(&f);
  if (o == FILLED || o == FAILED) give_back(p, &c);
  else vg_child_close(&c);
  st = VG_NOT_BETTER;
  switch (o) {
  case FILLED: st = judge(&f, out, report, err); break;
  case STOPPED: st = vg_stopped(&options->stop, err); break;
  case TOO_MANY:
    st = vg_fail(err, VG_ERR_UNSUPPORTED, "a void needs more than %llu points",
                 (unsigned long long)options->point_limit);
    break;
  case FAILED: report->n_other_failed++; break;
  case ENDED: report->n_other_ended++; break;
  }
  free(f.x);
  free(f.cell);
  report->time_total += vg_clock() - t;
  report->time_other += vg_clock() - t;
  return st;
}
