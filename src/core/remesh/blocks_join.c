/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the remaining points and triangles and the new ones are numbered
 * block by block; each block writes its range. Open edges of blocks are matched
 * by their end points, which have not moved. Points near these edges count as
 * changed. */
#include "core/remesh/blocks_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "base/parallel.h"

#define BAD2 0.25 /* S29: (sin 30 degrees)^2 */

struct joining {
  struct vg_tris made;
  struct vg_block *block;
  uint32_t *number; /* [n_point before] New number of each point that
                       remains. */
};

/* Old points that remain keep their order and come first, followed by new
 * points. */
static vg_status number(const struct vg_tris *w, size_t n, struct joining *j,
                        struct vg_error *err)
{
  size_t n_point = 0, n_tri = 0, n_line = 0;

  memset(j->number, 0xff, w->n_point * sizeof *j->number);
  for (size_t i = 0; i < n; i++)
    for (size_t p = 0; p < j->block[i].n_origin; p++)
      if (j->block[i].w.point[p].half != VG_REF_NONE)
        j->number[j->block[i].origin[p]] = 0;
  for (size_t p = 0; p < w->n_point; p++)
    if (j->number[p] != VG_REF_NONE) j->number[p] = (uint32_t)n_point++;
  for (size_t i = 0; i < n; i++) {
    struct vg_block *b = &j->block[i];

    b->first_point = n_point;
    b->first_tri = n_tri;
    b->first_line = n_line;
    for (size_t p = b->n_origin; p < b->w.n_point; p++)
      n_point += b->w.point[p].half != VG_REF_NONE;
    for (size_t t = 0; t < b->w.n_tri; t++) n_tri += !vg_tris_removed(&b->w, t);
    n_line += b->w.n_line;
  }
  j->made.n_point = j->made.cap_point = n_point;
  j->made.n_tri = n_tri;
  j->made.n_line = j->made.cap_line = n_line;
  return n_point < UINT32_MAX - 2 && n_tri < UINT32_MAX / 3
         ? VG_OK
         : vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the remeshed surface would have %zu triangles, which are "
                   "too many; request larger sizes",
                   n_tri);
}

static vg_status room(struct joining *j, struct vg_error *err)
{
  struct vg_tris *m = &j->made;
  vg_status st;

  VG_TRY(vg_tris_room(m, m->n_tri, err));
  m->point = vg_alloc(m->n_point, sizeof *m->point);
  m->line = vg_alloc(m->n_line, sizeof *m->line);
  if (!m->point || !m->line) st = vg_fail_memory(err, "the remeshed surface");
done:
  return st;
}

/* --- from a block to the whole surface ------------------------------------ */

static void put_points(struct joining *j, struct vg_block *b)
{
  uint32_t next = (uint32_t)b->first_point;

  for (size_t p = 0; p < b->w.n_point; p++) {
    struct vg_tris_point *q = &b->w.point[p];

    b->point[p] = VG_REF_NONE;
    if (q->half == VG_REF_NONE) continue;
    b->point[p] = p < b->n_origin ? j->number[b->origin[p]] : next++;
    if (q->frozen) continue; /* shared with other blocks: see finish_points */
    q->changed = q->tried = 0;
    j->made.point[b->point[p]] = *q;
  }
}

static void put_tris(struct joining *j, const struct vg_block *b)
{
  struct vg_tris *m = &j->made;
  const struct vg_tris *l = &b->w;

  for (size_t t = 0; t < l->n_tri; t++) {
    uint32_t to = b->place[t];

    if (to == VG_REF_NONE) continue;
    m->first[to] = l->first[t];
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t h = 3 * (uint32_t)t + k, g = l->mate[h];

      m->tri[to][k] = b->point[l->tri[t][k]];
      m->mate[3 * to + k] = g == VG_REF_NONE ? VG_REF_NONE
                                             : 3 * b->place[g / 3] + g % 3;
      m->edge[3 * to + k] = l->edge[h] ? l->edge[h] + (uint32_t)b->first_line
                                       : 0;
    }
  }
}

static void put(void *context, size_t first, size_t end, int worker)
{
  struct joining *j = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_block *b = &j->block[i];
    uint32_t next = (uint32_t)b->first_tri;

    b->point = vg_alloc(b->w.n_point, sizeof *b->point);
    b->place = vg_alloc(b->w.n_tri, sizeof *b->place);
    if (!b->point || !b->place) {
      b->st = VG_ERR_MEMORY;
      continue;
    }
    for (size_t t = 0; t < b->w.n_tri; t++)
      b->place[t] = vg_tris_removed(&b->w, t) ? VG_REF_NONE : next++;
    put_points(j, b);
    put_tris(j, b);
    for (size_t k = 0; k < b->w.n_line; k++) {
      struct vg_tris_line line = b->w.line[k];

      for (int e = 0; e < 2; e++)
        if (b->point[line.end[e]] != VG_REF_NONE)
          line.end[e] = b->point[line.end[e]];
        else line.end[e] = 0; /* the feature edge no longer exists */
      j->made.line[b->first_line + k] = line;
    }
  }
}

/* --- block borders -------------------------------------------------------- */

/* Half-edges of the whole surface on block borders, ascending, and their end
 * points. */
struct sides {
  size_t n, cap_half, cap_end;
  uint32_t *half, (*end)[2];
};

static vg_status list_sides(const struct joining *j, size_t n, struct sides *s,
                            struct vg_error *err)
{
  for (size_t i = 0; i < n; i++) {
    const struct vg_block *b = &j->block[i];

    for (uint32_t h = 0; h < 3 * b->w.n_tri; h++) {
      if (b->place[h / 3] == VG_REF_NONE || !vg_tris_is_border(&b->w, h))
        continue;
      if (vg_reserve(&s->half, &s->cap_half, s->n + 1, sizeof *s->half) ||
          vg_reserve(&s->end, &s->cap_end, s->n + 1, sizeof *s->end))
        return vg_fail_memory(err, "the borders of blocks");
      s->end[s->n][0] = b->point[vg_tris_from(&b->w, h)];
      s->end[s->n][1] = b->point[vg_tris_to(&b->w, h)];
      s->half[s->n++] = 3 * b->place[h / 3] + h % 3;
    }
  }
  return VG_OK;
}

/* Match the border edges of blocks. Open edges without a partner are open rims
 * of the surface. */
static vg_status join_sides(struct joining *j, size_t n, struct vg_error *err)
{
  struct sides s = { 0 };
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st;

  VG_TRY(list_sides(j, n, &s, err));
  VG_TRY(vg_edges_build_sides(&e, j->made.n_point, s.n,
                              (const uint32_t(*)[2])s.end, err));
  for (size_t i = 0; i < e.n; i++)
    for (uint32_t k = 1; k < vg_edges_count(&e, i); k++) {
      const uint32_t *at = vg_edges_at(&e, i) + k - 1;
      const uint32_t g = s.half[at[0]], h = s.half[at[1]];

      j->made.mate[g] = h;
      j->made.mate[h] = g;
      j->made.edge[h] = j->made.edge[g];
    }
done:
  vg_edges_release(&e);
  free(s.half);
  free(s.end);
  return st;
}

/* Triangles that the blocks left unfinished: with small angles, or with edges
 * that are too long or too short. */
static int is_bad(const struct vg_tris *w, uint32_t t)
{
  if (vg_tris_tri_shape(w, t) < BAD2) return 1;
  for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
    double r = vg_tris_ratio(w, h);

    if (r < VG_WORK_SHORT || r > VG_WORK_LONG) return 1;
  }
  return 0;
}

static void finish_points(struct joining *j, size_t n)
{
  struct vg_tris *m = &j->made;

  for (size_t i = 0; i < n; i++) {
    const struct vg_block *b = &j->block[i];

    for (size_t p = 0; p < b->n_origin; p++)
      if (b->w.point[p].frozen) m->point[b->point[p]] = b->w.point[p];
  }
  for (size_t p = 0; p < m->n_point; p++) m->point[p].half = VG_REF_NONE;
  for (uint32_t h = 0; h < 3 * m->n_tri; h++) {
    struct vg_tris_point *p = &m->point[vg_tris_from(m, h)];

    if (p->half == VG_REF_NONE) p->half = h;
  }
  for (uint32_t t = 0; t < m->n_tri; t++) {
    int near = is_bad(m, t);

    for (int k = 0; k < 3; k++) near |= m->point[m->tri[t][k]].frozen;
    for (int k = 0; near && k < 3; k++) m->point[m->tri[t][k]].changed = 1;
    m->stamp[t] = (uint64_t)near;
  }
  for (size_t p = 0; p < m->n_point; p++) {
    m->point[p].frozen = 0;
    m->point[p].tried = !m->point[p].changed;
  }
}

vg_status vg_blocks_join(struct vg_tris *w, size_t n, struct vg_block *b,
                         int threads, struct vg_error *err)
{
  assert(n > 0 && b && threads >= 0);

  struct joining j = { .made = *w, .block = b };
  vg_status st;

  j.made.point = NULL;
  j.made.tri = NULL;
  j.made.mate = j.made.edge = j.made.first = NULL;
  j.made.stamp = NULL;
  j.made.line = NULL;
  j.made.n_spare = 0;
  j.made.clock = 1;
  memset(j.made.looked, 0, sizeof j.made.looked);
  j.number = vg_alloc(w->n_point, sizeof *j.number);
  if (!j.number) VG_TRY(vg_fail_memory(err, "the remeshed surface"));
  VG_TRY(number(w, n, &j, err));
  VG_TRY(room(&j, err));
  vg_parallel_for(threads, n, 1, put, &j);
  for (size_t i = 0; i < n; i++)
    if (b[i].st < 0) VG_TRY(vg_fail_memory(err, "the remeshed surface"));
  VG_TRY(join_sides(&j, n, err));
  finish_points(&j, n);
  for (size_t i = 0; i < n; i++) {
    j.made.n_split += b[i].w.n_split;
    j.made.n_collapse += b[i].w.n_collapse;
    j.made.n_swap += b[i].w.n_swap;
    j.made.n_move += b[i].w.n_move;
  }
  VG_CHECK("the joining of blocks of a surface", vg_tris_defects(&j.made));
  vg_tris_free_arrays(w);
  *w = j.made;
done:
  if (st < 0) vg_tris_free_arrays(&j.made);
  free(j.number);
  return st;
}
