/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The boundary of the mesh of layers and field: remaining triangles of the
 * surface, side faces of the layers, and remeshed patches. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "layers/expand/join_plan.h"
#include "layers/expand/pairs.h"

struct work {
  const struct vg_join_plan *p;
  struct vg_mesh *m;
  uint8_t *stays;     /* [surface->n_tri] 1: the triangle remains. */
  uint8_t *paired;    /* [surface->n_tri] 1: part of a quadrilateral. */
  uint8_t *changed;   /* [n_patch] 1: the patch was remeshed. */
  size_t *tri, *quad; /* [n_patch] index of the next new face of each patch. */
};

/* The patches in which columns with levels slide were remeshed (slide.h). The
 * triangles of all others remain. */
static void find_changes(struct work *w)
{
  const struct vg_columns *c = w->p->columns;
  const struct vg_mesh *s = w->p->surface;

  for (size_t i = 0; i < 2 * c->n_border; i++) {
    const struct vg_column *column = &c->column[c->border[i / 2][i % 2]];

    for (int k = 0; k < 2 && column->n; k++)
      if (column->slide[k] != VG_NO_INDEX) w->changed[column->slide[k]] = 1;
  }
  for (size_t i = 0; i < s->n_tri; i++)
    w->stays[i] = !w->changed[s->tri_patch[i]];
}

/* Marks the triangles of the walls that are in quadrilaterals. They remain, but
 * not as triangles. */
static void find_quads(struct work *w)
{
  const struct vg_expand *e = &w->p->expand;

  for (size_t i = 0; e->partner && i < e->columns->n_face; i++)
    if (e->columns->face_tri[i] != VG_NO_INDEX)
      w->paired[e->columns->face_tri[i]] = e->partner[i] != VG_NO_INDEX;
}

static vg_status reserve_boundary(struct vg_mesh *m, struct vg_error *err)
{
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->tri_patch = vg_alloc(m->n_tri, sizeof *m->tri_patch);
  if (m->n_quad) {
    m->quad = vg_alloc(m->n_quad, sizeof *m->quad);
    m->quad_patch = vg_alloc(m->n_quad, sizeof *m->quad_patch);
  }
  if (m->tri && m->tri_patch && (!m->n_quad || (m->quad && m->quad_patch)))
    return VG_OK;
  return vg_fail_memory(err, "the boundary of the mesh");
}

/* Whether triangle i of the front is on the boundary of the mesh but not in the
 * surface. */
static int is_new(const struct work *w, size_t i)
{
  return w->p->front->face_id[i] == VG_NO_INDEX &&
         w->changed[w->p->front->patch[i]];
}

/* Whether face i is the first of a pair on a wall. */
static int is_quad(const struct work *w, size_t i)
{
  return w->p->columns->face_tri[i] != VG_NO_INDEX &&
         vg_pair_is_first(&w->p->expand, i);
}

/* Counts faces by patch, then turns the counts into first indices. */
static void count_boundary(struct work *w)
{
  const struct vg_columns *c = w->p->columns;
  const struct vg_front *f = w->p->front;
  const struct vg_mesh *s = w->p->surface;
  size_t n_tri = 0, n_quad = 0;

  for (size_t r = 0; r < c->n_border; r++) {
    size_t tri, quad;

    vg_expand_count_flank(&w->p->expand, r, &tri, &quad);
    w->tri[c->border_patch[r]] += tri;
    w->quad[c->border_patch[r]] += quad;
  }
  for (size_t i = 0; i < c->n_face; i++)
    if (is_quad(w, i)) w->quad[s->tri_patch[c->face_tri[i]]]++;
  for (size_t i = 0; i < f->n_face; i++)
    if (is_new(w, i)) w->tri[f->patch[i]]++;
  for (size_t i = 0; i < s->n_tri; i++) n_tri += w->stays[i] && !w->paired[i];
  for (size_t q = 0; q < s->n_patch; q++) {
    size_t tri = w->tri[q], quad = w->quad[q];

    w->tri[q] = n_tri;
    w->quad[q] = n_quad;
    n_tri += tri;
    n_quad += quad;
  }
  w->m->n_tri = n_tri;
  w->m->n_quad = n_quad;
}

static void fill_flanks(struct work *w)
{
  const struct vg_columns *c = w->p->columns;
  struct vg_mesh *m = w->m;

  for (size_t r = 0; r < c->n_border; r++) {
    uint32_t q = c->border_patch[r];
    size_t n_tri, n_quad;

    vg_expand_count_flank(&w->p->expand, r, &n_tri, &n_quad);
    vg_expand_flank(&w->p->expand, r, m->tri + w->tri[q],
                    n_quad ? m->quad + w->quad[q] : NULL);
    while (n_tri--) m->tri_patch[w->tri[q]++] = q;
    while (n_quad--) m->quad_patch[w->quad[q]++] = q;
  }
}

static void fill_quads(struct work *w)
{
  const struct vg_columns *c = w->p->columns;
  const struct vg_expand *e = &w->p->expand;

  for (size_t i = 0; i < c->n_face; i++) {
    uint32_t q[4], patch;
    size_t to;

    if (!is_quad(w, i)) continue;
    vg_pair_corners(e, i, q);
    patch = w->p->surface->tri_patch[c->face_tri[i]];
    to = w->quad[patch]++;
    for (int k = 0; k < 4; k++) w->m->quad[to][k] = e->foot[q[k]];
    w->m->quad_patch[to] = patch;
  }
}

static void fill_boundary(struct work *w)
{
  const struct vg_mesh *s = w->p->surface;
  const struct vg_front *f = w->p->front;
  struct vg_mesh *m = w->m;
  size_t at = 0;

  for (size_t i = 0; i < s->n_tri; i++)
    if (w->stays[i] && !w->paired[i]) {
      for (int k = 0; k < 3; k++) m->tri[at][k] = w->p->root[s->tri[i][k]];
      m->tri_patch[at++] = s->tri_patch[i];
    }
  fill_quads(w);
  fill_flanks(w);
  for (size_t i = 0; i < f->n_face; i++)
    if (is_new(w, i)) {
      size_t to = w->tri[f->patch[i]]++;

      for (int k = 0; k < 3; k++) m->tri[to][k] = w->p->id[f->face[i][k]];
      m->tri_patch[to] = f->patch[i];
    }
}

static vg_status copy_patches(struct work *w, struct vg_error *err)
{
  size_t n = w->p->surface->n_patch;

  if (!n) return VG_OK;
  w->m->patch = vg_alloc(n, sizeof *w->m->patch);
  if (!w->m->patch) return vg_fail_memory(err, "the patches of the mesh");
  memcpy(w->m->patch, w->p->surface->patch, n * sizeof *w->m->patch);
  w->m->n_patch = n;
  return VG_OK;
}

vg_status vg_join_boundary(struct vg_join_plan *p, struct vg_error *err)
{
  size_t n = p->surface->n_patch;
  struct work w = { p,
                    &p->boundary,
                    vg_calloc(p->surface->n_tri, 1),
                    vg_calloc(p->surface->n_tri, 1),
                    vg_calloc(n, 1),
                    vg_calloc(n, sizeof *w.tri),
                    vg_calloc(n, sizeof *w.quad) };
  vg_status st;

  if (!w.stays || !w.paired || !w.changed || !w.tri || !w.quad) {
    st = vg_fail_memory(err, "the boundary of the mesh");
    goto done;
  }
  find_changes(&w);
  find_quads(&w);
  count_boundary(&w);
  VG_TRY(reserve_boundary(w.m, err));
  fill_boundary(&w);
  VG_TRY(copy_patches(&w, err));
  st = vg_mesh_part_sheets(w.m, err);
done:
  free(w.stays);
  free(w.paired);
  free(w.changed);
  free(w.tri);
  free(w.quad);
  return st;
}
