/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/section/section_mesh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "run/section/section_surface.h"

enum { SYMMETRY_X = 6661 }; /* FUN3D's condition; y and z follow. */

struct build {
  const struct vg_mesh *slab;
  const struct vg_columns *c; /* NULL without layers. */
  const struct vg_front *front;
  struct vg_plane_mesh *m;
  uint32_t n_strip; /* Points of walls and farfield. */
  uint32_t back;
  uint32_t *base;   /* [n_column] number of level 1; VG_NO_INDEX: the column is
                       not in the plane. */
  uint32_t *number; /* [front points] or [slab points] number in m. */
  size_t cap_x, cap_tri, cap_quad, cap_edge, cap_edge_patch;
  struct vg_error *err;
};

static vg_status no_memory(struct build *b)
{
  return vg_fail_memory(b->err, "the mesh in the plane");
}

static vg_status add_point(struct build *b, const double x[3])
{
  struct vg_plane_mesh *m = b->m;

  if (vg_reserve(&m->x, &b->cap_x, m->n_point + 1, sizeof *m->x))
    return no_memory(b);
  if (m->n_point >= UINT32_MAX / 2 - 1)
    return vg_fail(b->err, VG_ERR_UNSUPPORTED,
                   "the mesh has more than 2 billion points; coarsen it");
  memcpy(m->x[m->n_point++], x, sizeof *m->x);
  return VG_OK;
}

static vg_status add_tri(struct build *b, uint32_t i, uint32_t j, uint32_t k)
{
  struct vg_plane_mesh *m = b->m;
  const uint32_t v[3] = { i, j, k };

  if (vg_reserve(&m->tri, &b->cap_tri, m->n_tri + 1, sizeof *m->tri))
    return no_memory(b);
  memcpy(m->tri[m->n_tri++], v, sizeof v);
  return VG_OK;
}

static vg_status add_quad(struct build *b, const uint32_t v[4])
{
  struct vg_plane_mesh *m = b->m;

  if (vg_reserve(&m->quad, &b->cap_quad, m->n_quad + 1, sizeof *m->quad))
    return no_memory(b);
  memcpy(m->quad[m->n_quad++], v, sizeof *m->quad);
  return VG_OK;
}

/* --- layers -------------------------------------------------------------- */

static uint32_t level(const struct build *b, uint32_t column, uint32_t l)
{
  return l ? b->base[column] + l - 1 : b->c->column[column].root;
}

static vg_status put_columns(struct build *b)
{
  const struct vg_columns *c = b->c;
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
  vg_status st = VG_OK;

  b->base = vg_alloc(c->n_column, sizeof *b->base);
  if (!b->base) return no_memory(b);
  memset(b->base, 0xff, c->n_column * sizeof *b->base);
  for (size_t i = 0; i < c->n_border; i++)
    for (int k = 0; k < 2 && c->border_patch[i] == b->back; k++)
      b->base[c->border[i][k]] = 0;
  for (size_t i = 0; i < c->n_column && st >= 0; i++) {
    if (b->base[i] == VG_NO_INDEX) continue;
    b->base[i] = (uint32_t)b->m->n_point;
    vg_column_points(c, b->slab, i, d, x);
    for (int l = 1; l <= c->column[i].n && st >= 0; l++)
      st = add_point(b, x[l]);
  }
  return st;
}

/* The cells on the edge between two columns, which has the fluid on its right.
 */
static vg_status put_stack(struct build *b, uint32_t i, uint32_t j)
{
  const struct vg_column *p = &b->c->column[i], *q = &b->c->column[j];
  const uint32_t n = p->n < q->n ? p->n : q->n;
  vg_status st = VG_OK;

  for (uint32_t l = 0; l < n && st >= 0; l++) {
    const uint32_t v[4] = { level(b, j, l), level(b, i, l), level(b, i, l + 1),
                            level(b, j, l + 1) };

    st = v[0] == v[1] ? add_tri(b, v[0], v[2], v[3]) : add_quad(b, v);
  }
  for (uint32_t l = n; l < p->n && st >= 0; l++)
    st = add_tri(b, level(b, j, n), level(b, i, l), level(b, i, l + 1));
  for (uint32_t l = n; l < q->n && st >= 0; l++)
    st = add_tri(b, level(b, j, l), level(b, i, n), level(b, j, l + 1));
  return st;
}

static vg_status put_layers(struct build *b)
{
  vg_status st = put_columns(b);

  for (size_t i = 0; i < b->c->n_border && st >= 0; i++)
    if (b->c->border_patch[i] == b->back)
      st = put_stack(b, b->c->border[i][0], b->c->border[i][1]);
  b->m->n_layer_tri = b->m->n_tri;
  return st;
}

/* --- field --------------------------------------------------------------- */

/* Number of point v of the front, or of the slab without layers. */
static vg_status number_point(struct build *b, uint32_t v, uint32_t *out)
{
  const uint64_t id = b->front ? b->front->id[v] : vg_layer_point_id(v);
  const uint32_t column = vg_layer_column_of(id), p = vg_layer_point_of(id);
  vg_status st = VG_OK;

  if (column != VG_NO_INDEX) {
    assert(b->base[column] != VG_NO_INDEX);
    *out = level(b, column, b->c->column[column].n);
  } else if (p < b->n_strip) {
    *out = p;
  } else {
    if (b->number[v] == VG_NO_INDEX) {
      b->number[v] = (uint32_t)b->m->n_point;
      st = add_point(b, b->front ? b->front->x[v] : b->slab->point[v]);
    }
    *out = b->number[v];
  }
  return st;
}

static vg_status put_field(struct build *b)
{
  const struct vg_mesh *s = b->slab;
  const struct vg_front *f = b->front;
  const size_t n = f ? f->n_face : s->n_tri;
  const size_t n_point = f ? f->n_point : s->n_point;
  vg_status st = VG_OK;

  b->number = vg_alloc(n_point, sizeof *b->number);
  if (!b->number) return no_memory(b);
  memset(b->number, 0xff, n_point * sizeof *b->number);
  for (size_t i = 0; i < n && st >= 0; i++) {
    const uint32_t *t = f ? f->face[i] : s->tri[i];
    uint32_t v[3];

    if ((f ? f->patch[i] : s->tri_patch[i]) != b->back) continue;
    for (int k = 0; k < 3; k++) VG_TRY(number_point(b, t[k], &v[k]));
    st = add_tri(b, v[0], v[1], v[2]);
  }
done:
  return st;
}

/* --- boundary ------------------------------------------------------------ */

/* An edge of the boundary with the fluid on the right of i -> j. */
static vg_status add_edge(struct build *b, uint32_t i, uint32_t j,
                          uint32_t patch)
{
  struct vg_plane_mesh *m = b->m;

  if (vg_reserve(&m->edge, &b->cap_edge, m->n_edge + 1, sizeof *m->edge) ||
      vg_reserve(&m->edge_patch, &b->cap_edge_patch, m->n_edge + 1,
                 sizeof *m->edge_patch))
    return no_memory(b);
  m->edge[m->n_edge][0] = j;
  m->edge[m->n_edge][1] = i;
  m->edge_patch[m->n_edge++] = patch;
  return VG_OK;
}

/* 1 for the patches other than the planes in which columns slide: those of a
 * tunnel at both ends of walls with layers. */
static vg_status find_slides(const struct build *b, uint8_t **slides)
{
  *slides = vg_calloc(b->slab->n_patch, 1);
  if (!*slides) return vg_fail_memory(b->err, "the patches");
  for (size_t i = 0; b->c && i < b->c->n_border; i++)
    (*slides)[b->c->border_patch[i]] = b->c->border_patch[i] < b->back;
  return VG_OK;
}

/* The sides of the columns in the plane, on the patches in which they slide. */
static vg_status put_sides(struct build *b, const uint8_t *slides)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < b->c->n_border; i++)
    for (int k = 0; k < 2 && slides[b->c->border_patch[i]]; k++) {
      const uint32_t c = b->c->border[i][k];
      const uint32_t n = b->base[c] == VG_NO_INDEX ? 0 : b->c->column[c].n;

      for (uint32_t l = 0; l < n && st >= 0; l++)
        st = add_edge(b, level(b, c, l + (uint32_t)k),
                      level(b, c, l + 1 - (uint32_t)k), b->c->border_patch[i]);
    }
  return st;
}

/* The edges of these patches above the columns. */
static vg_status put_above(struct build *b, const uint8_t *slides)
{
  const struct vg_front *f = b->front;
  vg_status st;

  for (size_t t = 0; t < f->n_face; t++)
    for (int k = 0; k < 3 && slides[f->patch[t]]; k++) {
      const uint32_t i = f->face[t][k], j = f->face[t][(k + 1) % 3];
      uint32_t v[2];

      if (f->x[i][2] != 0 || f->x[j][2] != 0) continue;
      VG_TRY(number_point(b, i, &v[0]));
      VG_TRY(number_point(b, j, &v[1]));
      VG_TRY(add_edge(b, v[0], v[1], f->patch[t]));
    }
  st = VG_OK;
done:
  return st;
}

static vg_status put_boundary(struct build *b)
{
  const struct vg_mesh *s = b->slab;
  uint8_t *slides;
  vg_status st = find_slides(b, &slides);

  for (size_t t = 0; t < s->n_tri && st >= 0; t++)
    for (int k = 0; k < 3 && !slides[s->tri_patch[t]] && st >= 0; k++) {
      const uint32_t i = s->tri[t][k], j = s->tri[t][(k + 1) % 3];

      if (i >= b->n_strip || j >= b->n_strip || s->tri_patch[t] == b->back)
        continue;
      st = add_edge(b, i, j, s->tri_patch[t]);
    }
  if (st >= 0 && b->c) st = put_sides(b, slides);
  if (st >= 0 && b->c) st = put_above(b, slides);
  free(slides);
  return st;
}

/* The points at the tops of the columns; to: numbers of points. */
static vg_status put_tops(struct build *b, const uint32_t *to, uint32_t **top)
{
  *top = vg_alloc(b->c->n_column, sizeof **top);
  if (!*top) return no_memory(b);
  for (uint32_t i = 0; i < b->c->n_column; i++)
    (*top)[i] = b->base[i] == VG_NO_INDEX ? VG_NO_INDEX
                                          : to[level(b, i, b->c->column[i].n)];
  return VG_OK;
}

/* Removes the points of patches in which columns slide that have no edge left.
 */
static vg_status drop_unused(struct build *b, uint32_t **top)
{
  struct vg_plane_mesh *m = b->m;
  uint32_t *to = vg_alloc(m->n_point, sizeof *to), n = 0;
  vg_status st;

  if (!to) return no_memory(b);
  memset(to, 0xff, m->n_point * sizeof *to);
  for (size_t i = 0; i < 3 * m->n_tri; i++) to[m->tri[i / 3][i % 3]] = 0;
  for (size_t i = 0; i < 4 * m->n_quad; i++) to[m->quad[i / 4][i % 4]] = 0;
  for (size_t i = 0; i < m->n_point; i++) {
    if (to[i] == VG_NO_INDEX) continue;
    memmove(m->x[n], m->x[i], sizeof *m->x);
    to[i] = n++;
  }
  m->n_point = n;
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    m->tri[i / 3][i % 3] = to[m->tri[i / 3][i % 3]];
  for (size_t i = 0; i < 4 * m->n_quad; i++)
    m->quad[i / 4][i % 4] = to[m->quad[i / 4][i % 4]];
  for (size_t i = 0; i < 2 * m->n_edge; i++)
    m->edge[i / 2][i % 2] = to[m->edge[i / 2][i % 2]];
  st = b->c ? put_tops(b, to, top) : VG_OK;
  free(to);
  return st;
}

/* The planes are the last two patches. */
static vg_status put_patches(struct build *b)
{
  struct vg_plane_mesh *m = b->m;

  assert(b->slab->n_patch > 2);
  m->n_patch = b->slab->n_patch - 2;
  m->patch = vg_alloc(m->n_patch, sizeof *m->patch);
  if (!m->patch) return no_memory(b);
  memcpy(m->patch, b->slab->patch, m->n_patch * sizeof *m->patch);
  return VG_OK;
}

vg_status vg_section_mesh(const struct vg_mesh *slab,
                          const struct vg_layers *layers,
                          struct vg_plane_mesh *out, uint32_t **top,
                          struct vg_error *err)
{
  struct vg_plane_mesh m = VG_PLANE_MESH_INIT;
  struct build b = { .slab = slab,
                     .c = layers ? &layers->columns : NULL,
                     .front = layers ? &layers->front : NULL,
                     .m = &m,
                     .n_strip = (uint32_t)vg_section_points(slab),
                     .back = (uint32_t)slab->n_patch - 2,
                     .err = err };
  vg_status st = VG_OK;

  for (uint32_t i = 0; i < b.n_strip; i++)
    VG_TRY(add_point(&b, slab->point[i]));
  if (layers) VG_TRY(put_layers(&b));
  VG_TRY(put_field(&b));
  VG_TRY(put_boundary(&b));
  VG_TRY(put_patches(&b));
  VG_TRY(drop_unused(&b, top));
  *out = m;
  m = (struct vg_plane_mesh)VG_PLANE_MESH_INIT;
done:
  free(b.base);
  free(b.number);
  vg_plane_mesh_release(&m);
  return st;
}

/* --- slices -------------------------------------------------------------- */

void vg_section_mesh_release(struct vg_section_mesh *m)
{
  vg_plane_mesh_release(&m->plane);
  vg_mesh_release(&m->solid);
  free(m->id);
  free(m->top);
  m->id = m->top = NULL;
}

/* Faces of the field without another cell of it: all in both planes, and the
 * edges of its triangles that occur once. */
static vg_status count_front(struct vg_section_mesh *m, struct vg_error *err)
{
  const struct vg_plane_mesh *p = &m->plane;
  const size_t n_tri = p->n_tri - p->n_layer_tri;
  uint64_t *key = vg_alloc(3 * n_tri, sizeof *key);

  if (!key) return vg_fail_memory(err, "the mesh in the plane");
  for (size_t i = 0; i < 3 * n_tri; i++) {
    const uint32_t *t = p->tri[p->n_layer_tri + i / 3];

    key[i] = vg_edge_key(t[i % 3], t[(i + 1) % 3]);
  }
  if (n_tri) qsort(key, 3 * n_tri, sizeof *key, vg_compare_edge_keys);
  m->n_front = 2 * n_tri;
  for (size_t i = 0; i < 3 * n_tri;) {
    const size_t n = i + 1 < 3 * n_tri && key[i + 1] == key[i] ? 2 : 1;

    m->n_front += n == 1;
    i += n;
  }
  free(key);
  return VG_OK;
}

vg_status vg_section_mesh_new(const struct vg_mesh *slab,
                              const struct vg_layers *layers, int axis,
                              double width, struct vg_section_mesh *out,
                              struct vg_error *err)
{
  struct vg_section_mesh m = VG_SECTION_MESH_INIT;
  struct vg_patch plane[2];
  vg_status st;

  VG_TRY(vg_section_mesh(slab, layers, &m.plane, &m.top, err));
  memcpy(plane, slab->patch + slab->n_patch - 2, sizeof plane);
  plane[0].bc_fun3d = plane[1].bc_fun3d = SYMMETRY_X + axis;
  VG_TRY(vg_plane_mesh_extrude(&m.plane, axis, width, plane, &m.solid, err));
  m.id = vg_alloc(m.solid.n_point, sizeof *m.id);
  if (!m.id) {
    st = vg_fail_memory(err, "the mesh one cell thick");
    goto done;
  }
  for (size_t i = 0; i < m.solid.n_point; i++) m.id[i] = (uint32_t)i;
  m.frame = m.solid;
  m.frame.n_point = m.frame.n_pri = m.frame.n_hex = 0;
  m.frame.point = NULL;
  m.frame.pri = NULL;
  m.frame.hex = NULL;
  VG_TRY(count_front(&m, err));
  *out = m;
  return VG_OK;
done:
  vg_section_mesh_release(&m);
  return st;
}

/* Slice 0: layers, with all points; slice 1: the field. */
static vg_status get_slice(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  const struct vg_section_mesh *m = s->user;
  const size_t n_layer = m->plane.n_layer_tri;
  const size_t first = i ? n_layer : 0;

  (void)err;
  *out = (struct vg_slice){ .n_point = m->solid.n_point,
                            .x = (const double(*)[3])m->solid.point,
                            .id = m->id,
                            .point_at = i ? m->solid.n_point : 0,
                            .n_own = i ? 0 : m->solid.n_point,
                            .own = m->id,
                            .domain = (uint32_t)i,
                            .kind = (uint8_t)i };
  out->cell_at[VG_SLICE_PRI] = first;
  out->n_cell[VG_SLICE_PRI] = i ? m->solid.n_pri - n_layer : n_layer;
  out->cell[VG_SLICE_PRI] = (const uint32_t *)(m->solid.pri + first);
  out->cell_at[VG_SLICE_HEX] = i ? m->solid.n_hex : 0;
  out->n_cell[VG_SLICE_HEX] = i ? 0 : m->solid.n_hex;
  out->cell[VG_SLICE_HEX] = (const uint32_t *)m->solid.hex;
  return VG_OK;
}

static void put_slice(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  (void)slice;
}

void vg_section_mesh_slices(const struct vg_section_mesh *m, int is_served,
                            struct vg_slices *out)
{
  *out = (struct vg_slices){
    .n_point = m->solid.n_point,
    .n_boundary_point = m->solid.n_point,
    .n_layer_point = m->plane.n_layer_tri + m->plane.n_quad ? m->solid.n_point
                                                            : 0,
    .boundary = &m->frame,
    .n_slice = is_served ? 2 : 0,
    .n_served = is_served ? m->solid.n_pri + m->solid.n_hex : 0,
    .get = get_slice,
    .put = put_slice,
    .user = (void *)(uintptr_t)m
  };
  out->n_cell[VG_SLICE_PRI] = m->solid.n_pri;
  out->n_cell[VG_SLICE_HEX] = m->solid.n_hex;
  out->n_layer_cell[VG_SLICE_PRI] = m->plane.n_layer_tri;
  out->n_layer_cell[VG_SLICE_HEX] = m->solid.n_hex;
}
