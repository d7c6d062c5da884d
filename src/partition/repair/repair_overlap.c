/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Makes the overlap of an owner: the cells around its interface points, where
 * the cells of other pieces are joined to its own by the global ids of their
 * points. */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "partition/repair/repair_parts.h"

void vg_overlap_release(struct vg_overlap *f)
{
  vg_metrics_free(f->metrics);
  vg_tets_release(&f->t);
  free(f->shared);
  free(f->stays);
  free(f->other);
  vg_table_release(&f->table);
  free(f->place);
  free(f->kind);
  free(f->shape);
  free(f->point);
}

static int is_shared(const struct vg_overlap *f, uint32_t v)
{
  return v >= f->q->n_in && v - f->q->n_in < f->q->n_point &&
         f->shared[v - f->q->n_in];
}

static int has_shared(const struct vg_overlap *f, const uint32_t *v)
{
  return is_shared(f, v[0]) || is_shared(f, v[1]) || is_shared(f, v[2]) ||
         is_shared(f, v[3]);
}

static uint64_t name_of(const struct vg_overlap *f, uint32_t v)
{
  return v < f->q->n_in ? f->q->in[v] : f->other[v - f->n_base];
}

static uint32_t *find_name(const struct vg_overlap *f, uint64_t name)
{
  uint32_t *at;

  VG_TABLE_FIND(&f->table, at, vg_hash_1(name), name_of(f, *at) == name);
  return at;
}

/* Finds or adds the vertex with that global id. */
static uint32_t vertex_of(struct vg_overlap *f, uint64_t name,
                          const double x[3])
{
  uint32_t *at;

  if (name >> 32 == f->q->serial)
    return (uint32_t)(f->q->n_in + (uint32_t)name);
  at = find_name(f, name);
  if (*at != VG_TABLE_FREE) return *at;
  *at = (uint32_t)f->t.n_point;
  f->other[f->n_other++] = name;
  memcpy(f->t.x[f->t.n_point], x, sizeof *f->t.x);
  return (uint32_t)f->t.n_point++;
}

static vg_status new_names(struct vg_overlap *f, size_t n_other)
{
  const struct vg_piece *q = f->q;

  f->other = vg_alloc(n_other, sizeof *f->other);
  if (!f->other || vg_table_init(&f->table, q->n_in + n_other))
    return VG_ERR_MEMORY;
  for (uint32_t v = 0; v < q->n_in; v++) {
    uint32_t *at = find_name(f, q->in[v]);

    if (*at == VG_TABLE_FREE) *at = v;
  }
  return VG_OK;
}

static vg_status make_room(struct vg_overlap *f)
{
  const struct vg_piece *q = f->q;
  size_t n_other = 0, n_cell = 0;

  f->n_base = q->n_in + q->n_point;
  f->shared = vg_calloc(q->n_point, 1);
  f->stays = vg_calloc(q->n_point, 1);
  if (!f->shared || !f->stays) return VG_ERR_MEMORY;
  for (size_t k = 0; k < f->n_halo; k++) {
    const struct vg_halo *s = f->halo[k];

    for (size_t i = 0; i < s->n_known; i++) f->shared[s->known[i]] = 1;
    n_cell += s->n_cell;
    n_other += s->n_other;
  }
  for (size_t c = 0; c < q->n_cell; c++) {
    uint32_t v[4];

    vg_piece_cell(q, c, v);
    f->n_own += (size_t)has_shared(f, v);
  }
  n_cell += f->n_own;
  f->t.x = vg_alloc(f->n_base + n_other, sizeof *f->t.x);
  f->t.cell = vg_alloc(n_cell, sizeof *f->t.cell);
  f->t.cap_cell = f->cap_kind = f->cap_shape = n_cell;
  f->place = vg_alloc(f->n_own, sizeof *f->place);
  f->kind = vg_calloc(n_cell, 1);
  f->shape = vg_alloc(n_cell, sizeof *f->shape);
  if (!f->t.x || !f->t.cell || !f->place || !f->kind || !f->shape)
    return VG_ERR_MEMORY;
  f->t.n_point = f->n_base;
  memcpy(f->t.x, q->x, f->n_base * sizeof *q->x);
  return new_names(f, n_other);
}

static void hold(struct vg_overlap *f, const uint32_t *v)
{
  for (int i = 0; i < 4; i++)
    if (is_shared(f, v[i])) f->stays[v[i] - f->q->n_in] = 1;
}

/* Is the turn of a zone before that of the owner? */
static int is_before(const struct vg_overlap *f, uint32_t order)
{
  if (order == VG_NO_ZONE) return 0;
  return f->first ? order < f->self->order : order > f->self->order;
}

/* The zone that owns vertex v < q.n_in. */
static uint32_t zone_of(const struct vg_overlap *f,
                        const struct vg_owners *owners, uint32_t v,
                        const struct vg_owner **last)
{
  uint64_t name = f->q->in[v];

  if (!(name >> 32)) return VG_NO_ZONE;
  if (!*last || (*last)->serial != name >> 32)
    *last = vg_owners_find(owners, name);
  return *last && (*last)->is_zone ? (*last)->order : VG_NO_ZONE;
}

static void add_own(struct vg_overlap *f, const struct vg_owners *owners)
{
  const struct vg_owner *last = NULL;

  for (size_t c = 0; c < f->q->n_cell; c++) {
    uint32_t v[4];
    int later = 0;

    vg_piece_cell(f->q, c, v);
    if (!has_shared(f, v)) continue;
    for (int i = 0; i < 4; i++)
      if (v[i] < f->q->n_in)
        later |= is_before(f, zone_of(f, owners, v[i], &last));
    if (later) hold(f, v);
    f->kind[f->t.n_cell] = later ? VG_OVERLAP_CLAIMED | VG_OVERLAP_LATER : 0;
    f->place[f->t.n_cell] = (uint32_t)c;
    memcpy(f->t.cell[f->t.n_cell++].v, v, sizeof f->t.cell->v);
  }
}

static void add_halo(struct vg_overlap *f, const struct vg_halo *s,
                     uint32_t *vertex)
{
  for (size_t k = 0; k < s->n_known; k++)
    vertex[k] = (uint32_t)f->q->n_in + s->known[k];
  for (size_t k = 0; k < s->n_other; k++)
    vertex[s->n_known + k] = vertex_of(f, s->name[k], s->x[k]);
  for (size_t c = 0; c < s->n_cell; c++) {
    uint32_t *v = f->t.cell[f->t.n_cell].v;
    uint8_t kind = 0;

    for (int i = 0; i < 4; i++) {
      uint32_t k = s->cell[c][i];

      v[i] = vertex[k];
      if (k < s->n_known || !is_before(f, s->zone[k - s->n_known])) continue;
      kind |= VG_OVERLAP_LATER;
      /* the piece that has the cell handles it only if others use that point */
      if (s->zone[k - s->n_known] != s->order) kind |= VG_OVERLAP_CLAIMED;
    }
    if (kind) hold(f, v);
    f->kind[f->t.n_cell++] = kind;
  }
}

static vg_status find_shapes(struct vg_overlap *f)
{
  const struct vg_tets *t = &f->t;

  if (vg_metrics_of_corners(f->sizing, t, &f->metrics) < 0)
    return VG_ERR_MEMORY;
  for (size_t c = 0; c < t->n_cell; c++)
    f->shape[c] = (float)vg_cell_shape(f->metrics, t, t->cell[c].v);
  return VG_OK;
}

static vg_status list_points(struct vg_overlap *f)
{
  size_t n = f->self->is_zone ? f->q->n_point : 0;

  f->point = vg_alloc(n, sizeof *f->point);
  if (!f->point) return VG_ERR_MEMORY;
  for (size_t i = 0; i < n; i++)
    if (f->shared[i] && !f->stays[i])
      f->point[f->n_point++] = (uint32_t)(f->q->n_in + i);
  return VG_OK;
}

vg_status vg_overlap_new(struct vg_overlap *f, const struct vg_owners *owners,
                         int first)
{
  uint32_t *vertex;
  size_t most = 0;
  vg_status st = make_room(f);

  f->first = first;
  if (st < 0) return st;
  for (size_t k = 0; k < f->n_halo; k++) {
    size_t n = (size_t)f->halo[k]->n_known + f->halo[k]->n_other;

    if (n > most) most = n;
  }
  vertex = vg_alloc(most, sizeof *vertex);
  if (!vertex) return VG_ERR_MEMORY;
  add_own(f, owners);
  for (size_t k = 0; k < f->n_halo; k++) add_halo(f, f->halo[k], vertex);
  free(vertex);
  st = find_shapes(f);
  return st == VG_OK ? list_points(f) : st;
}
