/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: every triangle is assigned to a block. Each block copies its
 * triangles into a surface of its own with local numbers, in which edges shared
 * with other blocks are open and their end points frozen. When all blocks have
 * been changed, they are joined along those edges. */
#include "core/remesh/blocks_parts.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

struct blocks {
  const struct vg_tris *w;
  size_t n;
  struct vg_block *block; /* [n] */
  uint32_t *of;           /* [n_tri] Block of each triangle. */
  uint32_t *tri;          /* [n_tri] Triangles sorted by block. */
  uint32_t *local;        /* [n_tri] Local number of each triangle in its
                             block. */
  uint32_t *map;          /* [workers][n_point] Local numbers of points; all
                             VG_REF_NONE between blocks. */
  vg_block_body body;
  void *user;
  atomic_int is_over; /* 1: a block has used up its budget, so that the others
                         are not needed. */
};

/* --- from the whole surface to a block ------------------------------------ */

static vg_status room(struct vg_block *b, const struct vg_tris *w,
                      struct vg_error *err)
{
  struct vg_tris *l = &b->w;

  *l = (struct vg_tris){ .ref = w->ref,
                         .curves = w->curves,
                         .tolerance = w->tolerance,
                         .relative = w->relative,
                         .far = w->far,
                         .other_size = w->other_size,
                         .user = w->user,
                         .form = w->form,
                         .of_form = w->of_form,
                         .field = w->field,
                         .coarse = w->coarse,
                         .h_min = w->h_min,
                         .h_max = w->h_max,
                         .follow = w->follow,
                         .is_sample = w->is_sample,
                         .is_block = 1,
                         .clock = 1,
                         .budget = w->churn > 0
                                   ? 1 + (size_t)(w->churn * b->weight)
                                   : 0,
                         .stop = w->stop };
  b->origin = vg_alloc(3 * b->n_tri, sizeof *b->origin);
  if (!b->origin) return vg_fail_memory(err, "a block of the surface");
  return vg_tris_room(l, b->n_tri, err);
}

static vg_status take_points(struct vg_block *b, const struct vg_tris *w,
                             uint32_t *map, struct vg_error *err)
{
  struct vg_tris *l = &b->w;

  for (size_t i = 0; i < b->n_tri; i++) {
    l->first[i] = w->first[b->tri[i]];
    l->stamp[i] = w->stamp[b->tri[i]] != 0;
    for (int k = 0; k < 3; k++) {
      uint32_t p = w->tri[b->tri[i]][k];

      if (map[p] == VG_REF_NONE) {
        map[p] = (uint32_t)b->n_origin;
        b->origin[b->n_origin++] = p;
      }
      l->tri[i][k] = map[p];
    }
  }
  l->n_point = l->cap_point = b->n_origin;
  l->point = vg_alloc(l->n_point, sizeof *l->point);
  if (!l->point) return vg_fail_memory(err, "a block of the surface");
  for (size_t i = 0; i < l->n_point; i++) {
    struct vg_tris_point *p = &l->point[i];

    *p = w->point[b->origin[i]];
    p->half = VG_REF_NONE;
    p->changed = p->changed != 0; /* The clock of the block starts at 0. */
    p->tried = !p->changed;
  }
  for (uint32_t h = 0; h < 3 * l->n_tri; h++)
    if (l->point[vg_tris_from(l, h)].half == VG_REF_NONE)
      l->point[vg_tris_from(l, h)].half = h;
  return VG_OK;
}

static vg_status take_line(struct vg_tris *l, const struct vg_tris *w,
                           uint32_t line, const uint32_t *map, uint32_t *edge,
                           struct vg_error *err)
{
  struct vg_tris_line *to;

  if (vg_reserve(&l->line, &l->cap_line, l->n_line + 1, sizeof *l->line))
    return vg_fail_memory(err, "a block of the surface");
  to = &l->line[l->n_line++];
  *to = w->line[line];
  for (int k = 0; k < 2; k++) to->end[k] = map[to->end[k]];
  *edge = (uint32_t)l->n_line;
  return VG_OK;
}

/* Copy mates and feature edges. The ends of edges that are shared with another
 * block are frozen. */
static vg_status take_edges(const struct blocks *s, struct vg_block *b,
                            const uint32_t *map, struct vg_error *err)
{
  const struct vg_tris *w = s->w;
  struct vg_tris *l = &b->w;
  const uint32_t own = (uint32_t)(b - s->block);
  vg_status st = VG_OK;

  for (uint32_t h = 0; h < 3 * l->n_tri; h++) {
    uint32_t from = 3 * b->tri[h / 3] + h % 3, g = w->mate[from];
    int inside = g != VG_REF_NONE && s->of[g / 3] == own;

    l->mate[h] = inside ? 3 * s->local[g / 3] + g % 3 : VG_REF_NONE;
    if (g != VG_REF_NONE && !inside)
      l->point[vg_tris_from(l, h)].frozen = l->point[vg_tris_to(l, h)]
                                              .frozen = VG_WORK_FROZEN;
    if (!w->edge[from]) continue;
    if (inside && l->mate[h] < h) l->edge[h] = l->edge[l->mate[h]];
    else VG_TRY(take_line(l, w, w->edge[from] - 1, map, &l->edge[h], err));
  }
done:
  return st;
}

/* A point with more than one outgoing open edge belongs to several umbrellas:
 * its triangles in this block are not connected over edges. */
static vg_status find_fans(struct vg_tris *l, struct vg_error *err)
{
  uint8_t *open = vg_calloc(l->n_point, 1);

  if (!open) return vg_fail_memory(err, "a block of the surface");
  for (uint32_t h = 0; h < 3 * l->n_tri; h++) {
    uint32_t p = vg_tris_from(l, h);

    if (l->mate[h] != VG_REF_NONE || !l->point[p].frozen) continue;
    if (open[p]) l->point[p].frozen = VG_WORK_FANS;
    open[p] = 1;
  }
  free(open);
  return VG_OK;
}

static vg_status extract(const struct blocks *s, struct vg_block *b,
                         uint32_t *map, struct vg_error *err)
{
  vg_status st;

  VG_TRY(room(b, s->w, err));
  st = take_points(b, s->w, map, err);
  if (st >= 0) st = take_edges(s, b, map, err);
  for (size_t i = 0; i < b->n_origin; i++) map[b->origin[i]] = VG_REF_NONE;
  VG_TRY(st);
  VG_TRY(find_fans(&b->w, err));
done:
  return st;
}

static void change(void *context, size_t first, size_t end, int worker)
{
  struct blocks *s = context;

  for (size_t i = first; i < end && !s->is_over; i++) {
    struct vg_block *b = &s->block[i];

    b->st = vg_stopped(&s->w->stop, &b->err);
    if (b->st >= 0)
      b->st = extract(s, b, s->map + (size_t)worker * s->w->n_point, &b->err);
    if (b->st >= 0) b->st = s->body(s->user, &b->w, &b->err);
    if (b->w.is_over) s->is_over = 1;
  }
}

/* --- all blocks ----------------------------------------------------------- */

/* Sort the triangles by block and number them within it. */
static vg_status sort_by_block(struct blocks *s, struct vg_error *err)
{
  size_t *start = vg_calloc(s->n + 1, sizeof *start);

  if (!start) return vg_fail_memory(err, "the blocks of the surface");
  for (size_t t = 0; t < s->w->n_tri; t++)
    if (s->of[t] != VG_REF_NONE) start[s->of[t] + 1]++;
  for (size_t i = 0; i < s->n; i++) {
    s->block[i].tri = s->tri + start[i];
    start[i + 1] += start[i];
  }
  for (uint32_t t = 0; t < s->w->n_tri; t++) {
    struct vg_block *b;

    if (s->of[t] == VG_REF_NONE) continue;
    b = &s->block[s->of[t]];
    s->local[t] = (uint32_t)b->n_tri++;
    s->tri[start[s->of[t]]++] = t;
  }
  free(start);
  return VG_OK;
}

static vg_status run_blocks(struct blocks *s, struct vg_tris *w, int phase,
                            int threads, struct vg_error *err)
{
  const size_t workers = (size_t)threads;
  vg_status st;

  s->block = vg_calloc(s->n, sizeof *s->block);
  s->of = vg_alloc(w->n_tri, sizeof *s->of);
  s->tri = vg_alloc(w->n_tri, sizeof *s->tri);
  s->local = vg_alloc(w->n_tri, sizeof *s->local);
  s->map = vg_alloc(workers * w->n_point, sizeof *s->map);
  if (!s->block || !s->of || !s->tri || !s->local || !s->map)
    VG_TRY(vg_fail_memory(err, "the blocks of the surface"));
  memset(s->map, 0xff, workers * w->n_point * sizeof *s->map);
  VG_TRY(vg_blocks_cut(w, s->n, phase, s->of, s->block, err));
  VG_TRY(sort_by_block(s, err));
  vg_parallel_for(threads, s->n, 1, change, s);
  for (size_t i = 0; i < s->n; i++) {
    if (s->block[i].st >= 0) continue;
    if (err) *err = s->block[i].err;
    st = s->block[i].st;
    goto done;
  }
  if (s->is_over) w->is_over = w->ends = 1;
  else VG_TRY(vg_blocks_join(w, s->n, s->block, threads, err));
done:
  return st;
}

vg_status vg_blocks_run(struct vg_tris *w, size_t n, int phase, int threads,
                        vg_block_body body, void *user, struct vg_error *err)
{
  struct blocks s = { .w = w, .n = n, .body = body, .user = user };
  vg_status st;

  assert(n > 0 && phase >= 0 && threads >= 0 && body);
  if (n < 2) return body(user, w, err);
  st = run_blocks(&s, w, phase, threads > 0 ? threads : vg_cores(), err);
  for (size_t i = 0; s.block && i < n; i++) {
    vg_tris_release(&s.block[i].w);
    free(s.block[i].origin);
    free(s.block[i].point);
    free(s.block[i].place);
  }
  free(s.block);
  free(s.of);
  free(s.tri);
  free(s.local);
  free(s.map);
  return st;
}
