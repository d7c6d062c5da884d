/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Halos: the cells of other pieces that the owner of interface points needs. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/repair/repair_parts.h"

/* --- messages ------------------------------------------------------------ */

void vg_halo_release(struct vg_halo *s)
{
  free(s->known);
  free(s->vertex);
  free(s->x);
  free(s->name);
  free(s->zone);
  free(s->cell);
  free(s->place);
  memset(s, 0, sizeof *s);
}

enum { N_HEAD = 8 };

void vg_halo_put(struct vg_writer *w, const struct vg_halo *s)
{
  uint32_t head[N_HEAD] = { s->owner, s->to,      s->from,    s->rank,
                            s->order, s->n_known, s->n_other, s->n_cell };

  vg_put(w, N_HEAD, sizeof *head, head);
  vg_put(w, s->n_known, sizeof *s->known, s->known);
  vg_put(w, s->n_known, sizeof *s->vertex, s->vertex);
  vg_put(w, s->n_other, sizeof *s->x, s->x);
  vg_put(w, s->n_other, sizeof *s->name, s->name);
  vg_put(w, s->n_other, sizeof *s->zone, s->zone);
  vg_put(w, s->n_cell, sizeof *s->cell, s->cell);
  vg_put(w, s->n_cell, sizeof *s->place, s->place);
}

void vg_halo_get(struct vg_reader *r, struct vg_halo *s)
{
  uint32_t head[N_HEAD] = { 0 };

  vg_get(r, N_HEAD, sizeof *head, head);
  *s = (struct vg_halo){ .owner = head[0],
                         .to = head[1],
                         .from = head[2],
                         .rank = head[3],
                         .order = head[4],
                         .n_known = head[5],
                         .n_other = head[6],
                         .n_cell = head[7] };
  s->known = vg_get_array(r, s->n_known, sizeof *s->known);
  s->vertex = vg_get_array(r, s->n_known, sizeof *s->vertex);
  s->x = vg_get_array(r, s->n_other, sizeof *s->x);
  s->name = vg_get_array(r, s->n_other, sizeof *s->name);
  s->zone = vg_get_array(r, s->n_other, sizeof *s->zone);
  s->cell = vg_get_array(r, s->n_cell, sizeof *s->cell);
  s->place = vg_get_array(r, s->n_cell, sizeof *s->place);
  if (r->bad) vg_halo_release(s);
}

/* --- the halos of a piece ------------------------------------------------ */

/* A cell with a corner among the points of an owner. */
struct hit {
  uint32_t cell, owner;
};

/* A piece and the owners whose points it uses. */
struct user {
  const struct vg_piece *q;
  const struct vg_owner *self;
  size_t n_owner, cap_owner;
  const struct vg_owner **owner; /* [n_owner] In the order of first use. */
  uint32_t *of; /* [n_in] Index in owner; VG_NO_CLUSTER: a boundary point. */
  size_t n_hit, cap_hit;
  struct hit *hit; /* [n_hit] Sorted by cell. */
  size_t *first;   /* [n_owner + 2] Cells of each owner's halo. */
  uint32_t *cell;
  uint32_t *number; /* [n_in + n_point] Scratch. */
  uint32_t *list;   /* Vertices of a halo. */
};

static void user_release(struct user *u)
{
  free(u->owner);
  free(u->of);
  free(u->hit);
  free(u->first);
  free(u->cell);
  free(u->number);
  free(u->list);
}

static vg_status find_owners(struct user *u, const struct vg_owners *owners)
{
  const struct vg_piece *q = u->q;
  uint32_t last = VG_NO_CLUSTER;

  for (size_t i = 0; i < q->n_in; i++) {
    const struct vg_owner *o;

    u->of[i] = VG_NO_CLUSTER;
    if (!(q->in[i] >> 32)) continue;
    if (last == VG_NO_CLUSTER || u->owner[last]->serial != q->in[i] >> 32) {
      o = vg_owners_find(owners, q->in[i]);
      if (!o) continue;
      for (last = 0; last < u->n_owner && u->owner[last] != o; last++) {
      }
      if (last == u->n_owner) {
        if (vg_reserve(&u->owner, &u->cap_owner, u->n_owner + 1,
                       sizeof *u->owner))
          return VG_ERR_MEMORY;
        u->owner[u->n_owner++] = o;
      }
    }
    u->of[i] = last;
  }
  return VG_OK;
}

/* Owners of a cell's points: out [4], each once; returns their number. */
static int owners_at(const struct user *u, const uint32_t *v, uint32_t *out)
{
  int n = 0;

  for (int i = 0; i < 4; i++) {
    int k = 0;

    if (v[i] >= u->q->n_in || u->of[v[i]] == VG_NO_CLUSTER) continue;
    while (k < n && out[k] != u->of[v[i]]) k++;
    if (k == n) out[n++] = u->of[v[i]];
  }
  return n;
}

/* Finds hits in one pass over the cells, most of which have no points of
 * others. */
static vg_status find_hits(struct user *u)
{
  const struct vg_piece *q = u->q;

  for (size_t c = 0; c < q->n_cell; c++) {
    uint32_t v[4], at[4];

    vg_piece_cell(q, c, v);
    if (v[0] >= q->n_in && v[1] >= q->n_in && v[2] >= q->n_in &&
        v[3] >= q->n_in)
      continue;
    if (vg_reserve(&u->hit, &u->cap_hit, u->n_hit + 4, sizeof *u->hit))
      return VG_ERR_MEMORY;
    for (int n = owners_at(u, v, at); n--;)
      u->hit[u->n_hit++] = (struct hit){ (uint32_t)c, at[n] };
  }
  return VG_OK;
}

static vg_status list_cells(struct user *u)
{
  u->first = vg_calloc(u->n_owner + 2, sizeof *u->first);
  if (!u->first || find_hits(u) < 0) return VG_ERR_MEMORY;
  for (size_t k = 0; k < u->n_hit; k++) u->first[u->hit[k].owner + 2]++;
  for (size_t k = 0; k < u->n_owner; k++) u->first[k + 2] += u->first[k + 1];
  u->cell = vg_alloc(u->n_hit, sizeof *u->cell);
  if (!u->cell) return VG_ERR_MEMORY;
  for (size_t k = 0; k < u->n_hit; k++)
    u->cell[u->first[u->hit[k].owner + 1]++] = u->hit[k].cell;
  return VG_OK;
}

/* Numbers the vertices of a halo's cells: the owner's, then the others, each
 * in the order of first use. Returns their number. */
static size_t number_vertices(struct user *u, uint32_t owner, size_t n,
                              const uint32_t *cell, struct vg_halo *s)
{
  const struct vg_piece *q = u->q;
  size_t n_list = 0;

  for (int pass = 0; pass < 2; pass++)
    for (size_t c = 0; c < n; c++)
      for (size_t i = 0; i < 4; i++) {
        uint32_t v = vg_packed_corner(&q->cell, 4 * (size_t)cell[c] + i);
        int known = v < q->n_in && u->of[v] == owner;

        if (known == pass || u->number[v] != VG_NO_CLUSTER) continue;
        u->number[v] = (uint32_t)n_list;
        u->list[n_list++] = v;
        s->n_known += (uint32_t)known;
      }
  s->n_other = (uint32_t)n_list - s->n_known;
  return n_list;
}

static uint32_t zone_of(const struct user *u, uint32_t v)
{
  const struct vg_owner *o = u->self;

  if (v < u->q->n_in) {
    if (u->of[v] == VG_NO_CLUSTER) return VG_NO_ZONE;
    o = u->owner[u->of[v]];
  }
  return o->is_zone ? o->order : VG_NO_ZONE;
}

static vg_status fill_halo(struct user *u, uint32_t owner, size_t n,
                           const uint32_t *cell, struct vg_halo *s)
{
  const struct vg_piece *q = u->q;
  const struct vg_owner *o = u->owner[owner];
  size_t n_list;

  *s = (struct vg_halo){ .owner = o->piece,
                         .to = o->rank,
                         .from = u->self->piece,
                         .rank = u->self->rank,
                         .order = u->self->order,
                         .n_cell = (uint32_t)n };
  n_list = number_vertices(u, owner, n, cell, s);
  s->known = vg_alloc(s->n_known, sizeof *s->known);
  s->vertex = vg_alloc(n_list, sizeof *s->vertex);
  s->x = vg_alloc(s->n_other, sizeof *s->x);
  s->name = vg_alloc(s->n_other, sizeof *s->name);
  s->zone = vg_alloc(s->n_other, sizeof *s->zone);
  s->cell = vg_alloc(n, sizeof *s->cell);
  s->place = vg_alloc(n, sizeof *s->place);
  if (!s->known || !s->vertex || !s->x || !s->name || !s->zone || !s->cell ||
      !s->place)
    return VG_ERR_MEMORY;
  memcpy(s->vertex, u->list, n_list * sizeof *s->vertex);
  for (size_t k = 0; k < s->n_known; k++)
    s->known[k] = (uint32_t)q->in[u->list[k]];
  for (size_t k = 0; k < s->n_other; k++) {
    uint32_t v = u->list[s->n_known + k];

    memcpy(s->x[k], q->x[v], sizeof *s->x);
    s->name[k] = v < q->n_in ? q->in[v] : VG_POINT_ID(q->serial, v - q->n_in);
    s->zone[k] = zone_of(u, v);
  }
  for (size_t c = 0; c < n; c++) {
    uint32_t v[4];

    s->place[c] = cell[c];
    vg_piece_cell(q, cell[c], v);
    for (int i = 0; i < 4; i++) s->cell[c][i] = u->number[v[i]];
  }
  for (size_t k = 0; k < n_list; k++) u->number[u->list[k]] = VG_NO_CLUSTER;
  return VG_OK;
}

static vg_status fill_halos(struct user *u, size_t *n, struct vg_halo *out)
{
  size_t n_vertex = u->q->n_in + u->q->n_point;

  u->number = vg_alloc(n_vertex, sizeof *u->number);
  u->list = vg_alloc(n_vertex, sizeof *u->list);
  if (!u->number || !u->list) return VG_ERR_MEMORY;
  memset(u->number, 0xff, n_vertex * sizeof *u->number);
  for (uint32_t k = 0; k < u->n_owner; k++) {
    size_t many = u->first[k + 1] - u->first[k];

    if (many && fill_halo(u, k, many, u->cell + u->first[k], &out[(*n)++]) < 0)
      return VG_ERR_MEMORY;
  }
  return VG_OK;
}

static vg_status list_hits(const struct user *u, size_t *n, uint32_t **hit)
{
  *hit = vg_alloc(u->n_hit, sizeof **hit);
  if (!*hit) return VG_ERR_MEMORY;
  for (size_t k = 0; k < u->n_hit; k++)
    if (u->owner[u->hit[k].owner]->is_zone &&
        (!*n || (*hit)[*n - 1] != u->hit[k].cell))
      (*hit)[(*n)++] = u->hit[k].cell;
  return VG_OK;
}

vg_status vg_halos_of(const struct vg_partition *p, size_t k,
                      const struct vg_owners *owners, size_t *n,
                      struct vg_halo **out, size_t *n_hit, uint32_t **hit)
{
  assert(k < p->n_piece && n && out && n_hit && hit);

  const struct vg_piece *q = &p->piece[k];
  struct user u = { .q = q,
                    .self = vg_owners_find(owners, VG_POINT_ID(q->serial, 0)) };
  vg_status st;

  *n = *n_hit = 0;
  *out = NULL;
  *hit = NULL;
  u.of = vg_alloc(q->n_in, sizeof *u.of);
  st = u.of ? find_owners(&u, owners) : VG_ERR_MEMORY;
  if (st == VG_OK && u.n_owner) {
    *out = vg_calloc(u.n_owner, sizeof **out);
    st = *out ? list_cells(&u) : VG_ERR_MEMORY;
    if (st == VG_OK) st = fill_halos(&u, n, *out);
    if (st == VG_OK) st = list_hits(&u, n_hit, hit);
  }
  user_release(&u);
  return st;
}

void vg_halo_refresh(const struct vg_piece *q, struct vg_halo *s)
{
  for (size_t k = 0; k < s->n_other; k++)
    memcpy(s->x[k], q->x[s->vertex[s->n_known + k]], sizeof *s->x);
}
