/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One slice of the layers: a run of faces with all its cells and new points.
 *
 * Local points: first the new inner points, in the order of the mesh, so that
 * the slice owns the points 0, 1, ...; then columns that belong to the boundary
 * or to an earlier slice; then the points at level 0. The points of a column
 * are consecutive here too, so cells are made as for the whole mesh. */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "layers/expand/pairs.h"
#include "layers/expand/slices_parts.h"

struct run {
  const struct vg_join_plan *p;
  size_t first, end; /* Range of blocks. */
  size_t n_face;     /* Number of faces with levels. */
  size_t n_column;
  uint32_t *face;        /* [n_face] faces of the plan. */
  uint32_t (*corner)[4]; /* [n_face] local columns. */
  uint8_t *n_corner;     /* [n_face] 3, or 4 for a pair. */
  uint32_t *column;      /* [n_column] columns of the plan. */
  uint32_t *foot, *base; /* [n_column] local points at levels 0 and 1. */
  struct vg_table table; /* Table of columns, then of points at level 0. */
};

static int has_levels(const struct vg_expand *e, size_t face)
{
  uint32_t f[4];
  const int n = vg_expand_corners(e, face, f);

  return n == 4 ||
         (n == 3 && vg_mark_n(e->mark[f[0]] | e->mark[f[1]] | e->mark[f[2]]));
}

static size_t end_face(const struct run *r)
{
  size_t end = r->end * VG_FACE_BLOCK, n = r->p->columns->n_face;

  return end < n ? end : n;
}

static vg_status reserve_run(struct run *r, struct vg_error *err)
{
  const struct vg_expand *e = &r->p->expand;
  size_t most;

  for (size_t i = r->first * VG_FACE_BLOCK; i < end_face(r); i++)
    r->n_face += (size_t)has_levels(e, i);
  most = 4 * r->n_face < e->columns->n_column ? 4 * r->n_face
                                              : e->columns->n_column;
  r->face = vg_alloc(r->n_face, sizeof *r->face);
  r->corner = vg_alloc(r->n_face, sizeof *r->corner);
  r->n_corner = vg_alloc(r->n_face, sizeof *r->n_corner);
  r->column = vg_alloc(most, sizeof *r->column);
  r->foot = vg_alloc(most, sizeof *r->foot);
  r->base = vg_alloc(most, sizeof *r->base);
  if (r->face && r->corner && r->n_corner && r->column && r->foot && r->base &&
      !vg_table_init(&r->table, most))
    return VG_OK;
  return vg_fail_memory(err, "a slice of the layers");
}

static void release_run(struct run *r)
{
  free(r->face);
  free(r->corner);
  free(r->n_corner);
  free(r->column);
  free(r->foot);
  free(r->base);
  vg_table_release(&r->table);
}

static void list_columns(struct run *r)
{
  const struct vg_expand *e = &r->p->expand;
  size_t n = 0;

  for (size_t i = r->first * VG_FACE_BLOCK; i < end_face(r); i++) {
    uint32_t column[4];

    if (!has_levels(e, i)) continue;
    r->n_corner[n] = (uint8_t)vg_expand_corners(e, i, column);
    for (int k = 0; k < r->n_corner[n]; k++) {
      uint32_t c = column[k];
      uint32_t *at;

      VG_TABLE_FIND(&r->table, at, vg_hash_1(c), r->column[*at] == c);
      if (*at == VG_TABLE_FREE) {
        *at = (uint32_t)r->n_column;
        r->column[r->n_column++] = c;
      }
      r->corner[n][k] = *at;
    }
    r->face[n++] = (uint32_t)i;
  }
}

/* Numbers the local points; returns their number. */
static size_t number_points(struct run *r)
{
  const struct vg_expand *e = &r->p->expand;
  size_t mine = e->inner[r->first], n = e->inner[r->end] - mine, n_own = n;

  for (size_t i = 0; i < r->n_column; i++) {
    uint32_t base = e->base[r->column[i]];

    r->base[i] = VG_NO_INDEX;
    if (base == VG_NO_INDEX) continue;
    if (base >= mine && base - mine < n_own) r->base[i] = base - (uint32_t)mine;
    else {
      r->base[i] = (uint32_t)n;
      n += vg_mark_n(e->mark[r->column[i]]);
    }
  }
  vg_table_clear(&r->table);
  for (size_t i = 0; i < r->n_column; i++) {
    uint32_t foot = e->foot[r->column[i]], *at;

    VG_TABLE_FIND(&r->table, at, vg_hash_1(foot),
                  e->foot[r->column[*at]] == foot);
    if (*at == VG_TABLE_FREE) {
      *at = (uint32_t)i;
      r->foot[i] = (uint32_t)n++;
    } else {
      r->foot[i] = r->foot[*at];
    }
  }
  return n;
}

static vg_status reserve_slice(const struct run *r, size_t n_point,
                               struct vg_layer_slice *at, struct vg_slice *s,
                               struct vg_error *err)
{
  const struct vg_expand *e = &r->p->expand;
  int refused;

  s->n_point = n_point;
  s->point_at = e->inner[r->first];
  s->n_own = e->inner[r->end] - e->inner[r->first];
  at->x = vg_alloc(n_point, sizeof *at->x);
  at->id = vg_alloc(n_point, sizeof *at->id);
  at->own = vg_alloc(s->n_own, sizeof *at->own);
  refused = !at->x || !at->id || !at->own;
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    s->cell_at[k] = e->cell[k][r->first];
    s->n_cell[k] = e->cell[k][r->end] - e->cell[k][r->first];
    at->cell[k] = vg_alloc(s->n_cell[k],
                           vg_slice_width[k] * sizeof *at->cell[k]);
    refused |= !at->cell[k];
    s->cell[k] = at->cell[k];
  }
  s->x = (const double(*)[3])at->x;
  s->id = at->id;
  s->own = at->own;
  return refused ? vg_fail_memory(err, "a slice of the layers") : VG_OK;
}

/* Local point in the middle of the pair of face i, which this slice owns. */
static uint32_t middle_of(const struct run *r, size_t i)
{
  const struct vg_expand *e = &r->p->expand;

  return (uint32_t)(e->middle[r->face[i]] - e->inner[r->first]);
}

static void place_points(const struct run *r, struct vg_layer_slice *at,
                         size_t n_own)
{
  const struct vg_expand *e = &r->p->expand;
  const struct vg_mesh *surface = r->p->surface;

  for (size_t i = 0; i < n_own; i++) at->own[i] = (uint32_t)i;
  for (size_t i = 0; i < r->n_column; i++) {
    uint32_t c = r->column[i], foot = r->foot[i];
    unsigned n = vg_mark_n(e->mark[c]);

    memcpy(at->x[foot], surface->point[e->columns->column[c].root],
           sizeof *at->x);
    at->id[foot] = e->foot[c];
    if (!n) continue;
    vg_expand_column(e, surface, c, at->x + r->base[i]);
    for (unsigned l = 0; l < n; l++) at->id[r->base[i] + l] = e->base[c] + l;
  }
  for (size_t i = 0; i < r->n_face; i++) {
    uint32_t p, q[4], base[4];

    if (r->n_corner[i] < 4) continue;
    p = middle_of(r, i);
    for (int k = 0; k < 4; k++) {
      q[k] = r->column[r->corner[i][k]];
      base[k] = r->base[r->corner[i][k]];
    }
    vg_pair_middle_of((const double(*)[3])at->x, base, vg_pair_levels(e, q),
                      at->x[p]);
    at->id[p] = e->middle[r->face[i]];
  }
}

static void make_cells(const struct run *r, struct vg_layer_slice *at)
{
  struct vg_cell_sink s = { (uint32_t(*)[4])at->cell[VG_SLICE_TET],
                            (uint32_t(*)[5])at->cell[VG_SLICE_PYR],
                            (uint32_t(*)[6])at->cell[VG_SLICE_PRI],
                            (uint32_t(*)[8])at->cell[VG_SLICE_HEX] };

  for (size_t i = 0; i < r->n_face; i++) {
    uint32_t foot[4], base[4];

    for (int k = 0; k < r->n_corner[i]; k++) {
      foot[k] = r->foot[r->corner[i][k]];
      base[k] = r->base[r->corner[i][k]];
    }
    vg_expand_face(&r->p->expand, r->face[i], foot, base,
                   r->n_corner[i] == 4 ? middle_of(r, i) : VG_NO_INDEX, &s);
  }
}

vg_status vg_layer_slice_expand(const struct vg_join_plan *p, size_t first,
                                size_t end, struct vg_layer_slice *at,
                                struct vg_slice *s, struct vg_error *err)
{
  struct run r = { .p = p, .first = first, .end = end };
  vg_status st;

  VG_TRY(reserve_run(&r, err));
  list_columns(&r);
  VG_TRY(reserve_slice(&r, number_points(&r), at, s, err));
  place_points(&r, at, s->n_own);
  make_cells(&r, at);
done:
  release_run(&r);
  return st;
}
