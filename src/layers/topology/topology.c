/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/topology/topology.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "layers/topology/fan.h"
#include "layers/topology/topology_wall.h"

void vg_topology_release(struct vg_topology *t)
{
  free(t->first);
  free(t->corner);
  free(t->near_first);
  free(t->near);
  free(t->preset);
  memset(t, 0, sizeof *t);
}

static vg_status make_columns(const struct vg_wall *w, const struct vg_fans *f,
                              struct vg_columns *c, struct vg_topology *t,
                              struct vg_error *err)
{
  c->n_column = f->first[w->n_point];
  c->column = vg_calloc(c->n_column, sizeof *c->column);
  t->preset = vg_calloc(c->n_column, sizeof *t->preset);
  if (!c->column || !t->preset) return vg_fail_memory(err, "the columns");
  for (size_t p = 0; p < w->n_point; p++)
    for (size_t i = f->first[p]; i < f->first[p + 1]; i++) {
      struct vg_column *col = &c->column[i];

      col->root = w->point[p];
      memcpy(col->slide, w->slide[p], sizeof col->slide);
      col->bent = SIZE_MAX;
      col->cause = w->cause[p];
    }
  for (size_t i = 0; i < f->n_preset; i++) {
    const struct vg_fan_preset *preset = &f->preset[i];
    uint32_t at = f->first[preset->point] + preset->at;

    memcpy(c->column[at].dir, preset->dir, sizeof preset->dir);
    t->preset[at] = 1;
  }
  return VG_OK;
}

/* Faces of wall triangles, followed by virtual faces. */
static vg_status make_faces(const struct vg_wall *w, const struct vg_fans *f,
                            struct vg_columns *c, struct vg_error *err)
{
  c->n_face = w->n_face + f->n_face;
  if (c->n_face > UINT32_MAX / 12)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the layers need %zu faces with fans, but at most %u are "
                   "supported; raise the fan angle or coarsen the surface",
                   c->n_face, UINT32_MAX / 12);
  c->face = vg_alloc(c->n_face, sizeof *c->face);
  c->face_tri = vg_alloc(c->n_face, sizeof *c->face_tri);
  if (!c->face || !c->face_tri)
    return vg_fail_memory(err, "the faces of the columns");
  for (uint32_t h = 0; h < 3 * w->n_face; h++)
    c->face[h / 3][h % 3] = vg_fan_column(w, f, h);
  memcpy(c->face_tri, w->tri, w->n_face * sizeof *w->tri);
  for (size_t i = 0; i < f->n_face; i++) {
    memcpy(c->face[w->n_face + i], f->face[i], sizeof *c->face);
    c->face_tri[w->n_face + i] = VG_NO_INDEX;
  }
  return VG_OK;
}

/* Boundary edges of wall triangles, sorted by half-edge, followed by those of
 * fans. */
static vg_status make_rims(const struct vg_wall *w, const struct vg_fans *f,
                           struct vg_columns *c, struct vg_error *err)
{
  c->n_border = w->n_border + f->n_border;
  c->border = vg_alloc(c->n_border, sizeof *c->border);
  c->border_patch = vg_alloc(c->n_border, sizeof *c->border_patch);
  if (!c->border || !c->border_patch)
    return vg_fail_memory(err, "the boundary edges of the columns");
  for (size_t i = 0; i < w->n_border; i++) {
    c->border[i][0] = vg_fan_column(w, f, w->border[i]);
    c->border[i][1] = vg_fan_column(w, f, vg_half_next(w->border[i]));
    c->border_patch[i] = w->border_patch[i];
  }
  for (size_t i = 0; i < f->n_border; i++) {
    memcpy(c->border[w->n_border + i], f->border[i], sizeof *c->border);
    c->border_patch[w->n_border + i] = f->border_patch[i];
  }
  return VG_OK;
}

/* The column in the place of column i after the reversal. */
static uint32_t reversed(const struct vg_wall *w, const struct vg_fans *f,
                         const uint8_t *is_reversed, const struct vg_columns *c,
                         uint32_t i)
{
  size_t lo = 0, n = w->n_point;

  if (!is_reversed[c->column[i].root]) return i;
  while (n > 1) { /* The last point whose columns begin at i or before. */
    const size_t half = n / 2;

    if (f->first[lo + half] <= i) lo += half;
    n -= half;
  }
  return f->first[lo] + f->first[lo + 1] - 1 - i;
}

/* Reverses the order of the columns of a root. */
static void reverse(const struct vg_wall *w, const struct vg_fans *f,
                    const uint8_t *is_reversed, struct vg_columns *c,
                    struct vg_topology *t)
{
  for (size_t k = 0; k < 3 * c->n_face; k++)
    c->face[k / 3][k % 3] = reversed(w, f, is_reversed, c,
                                     c->face[k / 3][k % 3]);
  for (size_t k = 0; k < 2 * c->n_border; k++)
    c->border[k / 2][k % 2] = reversed(w, f, is_reversed, c,
                                       c->border[k / 2][k % 2]);
  for (uint32_t i = 0; i < c->n_column; i++) {
    const uint32_t j = reversed(w, f, is_reversed, c, i);
    const struct vg_column column = c->column[i];
    const uint8_t preset = t->preset[i];

    if (j <= i) continue;
    c->column[i] = c->column[j];
    c->column[j] = column;
    t->preset[i] = t->preset[j];
    t->preset[j] = preset;
  }
}

/* Corners of each column. A counting sort keeps the faces in order. */
static vg_status make_corners(const struct vg_columns *c, struct vg_topology *t,
                              struct vg_error *err)
{
  size_t n = 3 * c->n_face;

  t->first = vg_calloc(c->n_column + 2, sizeof *t->first);
  t->corner = vg_alloc(n, sizeof *t->corner);
  if (!t->first || !t->corner)
    return vg_fail_memory(err, "the faces around columns");
  for (size_t h = 0; h < n; h++) t->first[c->face[h / 3][h % 3] + 2]++;
  for (size_t i = 2; i <= c->n_column + 1; i++) t->first[i] += t->first[i - 1];
  for (size_t h = 0; h < n; h++)
    t->corner[t->first[c->face[h / 3][h % 3] + 1]++] = (uint32_t)h;
  return VG_OK;
}

/* Visits the columns in order and appends each to the lists of its neighbours:
 * the lists are sorted, and repeated entries are adjacent. A list is at most
 * twice as long as that of the corners. */
static vg_status make_near(const struct vg_columns *c, struct vg_topology *t,
                           struct vg_error *err)
{
  uint32_t *end = vg_alloc(c->n_column, sizeof *end), *fit;
  size_t n = 0;

  t->near_first = vg_alloc(c->n_column + 1, sizeof *t->near_first);
  t->near = vg_alloc(6 * c->n_face, sizeof *t->near);
  if (!end || !t->near_first || !t->near) {
    free(end);
    return vg_fail_memory(err, "the neighbours of columns");
  }
  for (size_t i = 0; i < c->n_column; i++) end[i] = 2 * t->first[i];
  for (uint32_t i = 0; i < c->n_column; i++)
    for (uint32_t j = t->first[i]; j < t->first[i + 1]; j++)
      for (uint32_t k = 1; k < 3; k++) {
        uint32_t h = t->corner[j], b = c->face[h / 3][(h + k) % 3];

        if (end[b] == 2 * t->first[b] || t->near[end[b] - 1] != i)
          t->near[end[b]++] = i;
      }
  for (size_t i = 0; i < c->n_column; i++) {
    size_t from = 2 * (size_t)t->first[i], count = end[i] - from;

    t->near_first[i] = (uint32_t)n;
    memmove(t->near + n, t->near + from, count * sizeof *t->near);
    n += count;
  }
  t->near_first[c->n_column] = (uint32_t)n;
  fit = vg_realloc(t->near, n, sizeof *t->near);
  if (fit) t->near = fit;
  free(end);
  return VG_OK;
}

vg_status vg_topology_build(const struct vg_mesh *surface,
                            const uint8_t *is_wall, size_t n_slide,
                            const struct vg_slide *slide, double fan_angle,
                            const uint8_t *is_reversed,
                            struct vg_columns *columns, struct vg_topology *t,
                            struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_wall w = VG_WALL_INIT;
  struct vg_fans f = VG_FANS_INIT;
  struct vg_columns c = VG_COLUMNS_INIT;
  struct vg_topology made = VG_TOPOLOGY_INIT;

  assert(!columns->n_column && !columns->column);
  assert(is_wall || !surface->n_patch);
  assert(slide || !n_slide);
  VG_TRY(vg_wall_build(surface, is_wall, n_slide, slide, &w, err));
  VG_TRY(vg_fans_build(&w, n_slide, slide, fan_angle, &f, err));
  VG_TRY(make_columns(&w, &f, &c, &made, err));
  VG_TRY(make_faces(&w, &f, &c, err));
  VG_TRY(make_rims(&w, &f, &c, err));
  if (is_reversed) reverse(&w, &f, is_reversed, &c, &made);
  VG_TRY(make_corners(&c, &made, err));
  VG_TRY(make_near(&c, &made, err));
  *columns = c;
  *t = made;
  c = (struct vg_columns)VG_COLUMNS_INIT;
  made = (struct vg_topology)VG_TOPOLOGY_INIT;
done:
  vg_wall_release(&w);
  vg_fans_release(&f);
  vg_columns_release(&c);
  vg_topology_release(&made);
  return st;
}
