/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Balls around bad cells, owners of pieces, and messages to other ranks. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/repair/repair_parts.h"

/* R10: the worse a cell, the larger its ball: `reach` local spacings, and
 * `most` times the distance of its own corners. A cell that stayed bad needs
 * much room, for example next to long triangles at a sharp edge. */
static const struct {
  double reach, most;
} ball[VG_SPOT_SIZES] = { { 1.2, 1.01 }, { 2.5, 1.01 }, { 4, 2 } };

/* --- owners -------------------------------------------------------------- */

static int by_serial(const void *a, const void *b)
{
  const struct vg_owner *s = a, *t = b;

  return s->serial < t->serial ? -1 : s->serial > t->serial;
}

/* An owner as sent to other ranks. */
struct listed {
  struct vg_owner o;
  char path[VG_PATH_MAX];
};

static int by_listed_path(const void *a, const void *b)
{
  return strcmp(((const struct listed *)a)->path,
                ((const struct listed *)b)->path);
}

static vg_status list_owners(struct vg_bytes *all, int size,
                             struct vg_owners *out, struct vg_error *err)
{
  struct listed *l;
  size_t bytes = 0, at = 0;

  for (int r = 0; r < size; r++) bytes += all[r].n;
  l = vg_alloc(bytes, 1);
  out->n = bytes / sizeof *l;
  out->at = vg_alloc(out->n, sizeof *out->at);
  if (!l || !out->at) {
    free(l);
    return vg_fail_memory(err, "repairs");
  }
  for (int r = 0; r < size; r++) {
    if (all[r].n) memcpy((char *)l + at, all[r].data, all[r].n);
    at += all[r].n;
  }
  if (out->n) qsort(l, out->n, sizeof *l, by_listed_path);
  for (size_t k = 0; k < out->n; k++) {
    out->at[k] = l[k].o;
    out->at[k].order = (uint32_t)k;
  }
  if (out->n) qsort(out->at, out->n, sizeof *out->at, by_serial);
  free(l);
  return VG_OK;
}

vg_status vg_owners_gather(const struct vg_partition *p, struct vg_comm *comm,
                           struct vg_owners *out, struct vg_error *err)
{
  struct listed *own = vg_calloc(p->n_piece, sizeof *own);
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  struct vg_bytes mine = { p->n_piece * sizeof *own, (unsigned char *)own };
  vg_status st = own && all ? VG_OK : vg_fail_memory(err, "repairs");

  memset(out, 0, sizeof *out);
  for (size_t k = 0; st == VG_OK && k < p->n_piece; k++) {
    const struct vg_piece *q = &p->piece[k];

    own[k].o = (struct vg_owner){ .serial = q->serial,
                                  .rank = (uint32_t)p->rank,
                                  .piece = (uint32_t)k,
                                  .is_zone = q->kind == VG_SPAN_PENCIL ||
                                             q->kind == VG_SPAN_TILE ||
                                             q->n_adopted > 0 };
    memcpy(own[k].path, q->path, sizeof own[k].path);
  }
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &mine, all, err);
  if (st == VG_OK) st = list_owners(all, p->size, out, err);
  vg_bytes_release(all, (size_t)p->size);
  free(own);
  return vg_comm_agree(comm, st, err);
}

const struct vg_owner *vg_owners_find(const struct vg_owners *o, uint64_t name)
{
  struct vg_owner key = { .serial = (uint32_t)(name >> 32) };

  assert(o->at || !o->n);
  if (!key.serial) return NULL;
  return bsearch(&key, o->at, o->n, sizeof key, by_serial);
}

/* --- messages ------------------------------------------------------------ */

vg_status vg_outbox_new(struct vg_outbox *post, int size, struct vg_error *err)
{
  assert(size > 0);
  post->size = size;
  post->to = vg_calloc((size_t)size, sizeof *post->to);
  return post->to ? VG_OK : vg_fail_memory(err, "repairs");
}

void vg_outbox_release(struct vg_outbox *post)
{
  for (int r = 0; post->to && r < post->size; r++) free(post->to[r].bytes.data);
  free(post->to);
  post->to = NULL;
}

vg_status vg_outbox_send(struct vg_outbox *post, struct vg_comm *comm,
                         vg_status st, struct vg_bytes **from,
                         struct vg_error *err)
{
  assert(from);

  struct vg_bytes *to = vg_calloc((size_t)post->size, sizeof *to);
  struct vg_bytes *got = vg_calloc((size_t)post->size, sizeof *got);

  if (st == VG_OK && (!to || !got)) st = vg_fail_memory(err, "repairs");
  for (int r = 0; st == VG_OK && r < post->size; r++) {
    if (post->to[r].refused) st = vg_fail_memory(err, "repairs");
    to[r] = post->to[r].bytes;
  }
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_exchange(comm, to, got, err);
  free(to);
  vg_outbox_release(post);
  if (st == VG_OK) *from = got;
  else vg_bytes_release(got, (size_t)post->size);
  return st;
}

/* --- bad cells ----------------------------------------------------------- */

/* The ball of a long cell in a coarse region may cover everything fine, and
 * contain most of the mesh. It is halved until no spacing inside is below this
 * share of its radius (R8), even if the cell's own corners are then outside. */
static const double least_spacing = 1.0 / 48;

static int is_too_large(const struct vg_sizing *sizing, const struct vg_spot *s)
{
  double half = fmax(s->half[0], fmax(s->half[1], s->half[2])), lo[3], x[3];

  for (int k = 0; k < 3; k++) lo[k] = s->at[k] - half;
  return vg_sizing_least(sizing, lo, 2 * half, x) < least_spacing * s->radius;
}

/* The metric at x, scaled to the determinant 1. Returns the spacing there. */
static double metric_at(const struct vg_sizing *sizing, const double x[3],
                        double m[6])
{
  double t[6], h = vg_sizing_stretch_at(sizing, x, t);

  vg_tensor_uniform(1, m);
  if (!vg_sizing_is_stretched(sizing)) return h;
  vg_tensor_square(t, m);
  for (int k = 0; k < 6; k++) m[k] *= h * h;
  return h;
}

struct vg_spot vg_spot_around(const struct vg_sizing *sizing,
                              const double *const x[4], enum vg_spot_size k)
{
  struct vg_spot s;
  double at[3], m[6], far = 0, reach;

  for (int a = 0; a < 3; a++)
    at[a] = 0.25 * (x[0][a] + x[1][a] + x[2][a] + x[3][a]);
  reach = ball[k].reach * metric_at(sizing, at, m);
  for (int i = 0; i < 4; i++) {
    double d[3];

    vg_sub(at, x[i], d);
    far = fmax(far, vg_tensor_form(m, d));
  }
  s = vg_spot_of(at, fmax(ball[k].most * sqrt(far), reach), m);
  while (is_too_large(sizing, &s)) s = vg_spot_of(at, 0.5 * s.radius, m);
  return s;
}

vg_status vg_spots_add(struct vg_spots *s, const struct vg_sizing *sizing,
                       const double *const x[4], double shape)
{
  if (vg_reserve(&s->at, &s->cap, s->n + 1, sizeof *s->at))
    return VG_ERR_MEMORY;
  s->at[s->n++] = vg_spot_around(sizing, x,
                                 shape < vg_repair_levels(sizing)->bad
                                   ? VG_SPOT_MIDDLE
                                   : VG_SPOT_SMALL);
  return VG_OK;
}

/* --- gathering ----------------------------------------------------------- */

static int by_place(const void *a, const void *b)
{
  const struct vg_spot *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->at[k] != t->at[k]) return s->at[k] < t->at[k] ? -1 : 1;
  return s->radius < t->radius ? -1 : s->radius > t->radius;
}

vg_status vg_spots_gather(struct vg_writer *w, int n_rank, struct vg_comm *comm,
                          size_t *n, struct vg_spot **out, struct vg_error *err)
{
  struct vg_bytes *all = vg_calloc((size_t)n_rank, sizeof *all);
  size_t bytes = 0, at = 0;
  vg_status st;

  *out = NULL;
  st = vg_comm_agree(comm,
                     w->refused || !all ? vg_fail_memory(err, "repairs")
                                        : VG_OK,
                     err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &w->bytes, all, err);
  for (int r = 0; st == VG_OK && r < n_rank; r++) bytes += all[r].n;
  if (st == VG_OK && !(*out = vg_alloc(bytes, 1)))
    st = vg_fail_memory(err, "repairs");
  for (int r = 0; st == VG_OK && r < n_rank; r++) {
    if (all[r].n) memcpy((char *)*out + at, all[r].data, all[r].n);
    at += all[r].n;
  }
  vg_bytes_release(all, n_rank);
  *n = at / sizeof **out;
  if (*n) qsort(*out, *n, sizeof **out, by_place);
  if (st == VG_OK) st = vg_spots_thin(n, *out, err);
  return vg_comm_agree(comm, st, err);
}
