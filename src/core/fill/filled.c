/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The result of the kernel: the cells that are kept, and the resulting change
 * of the front. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "core/fill/fill_parts.h"
#include "core/geometry/predicates.h"

void vg_filled_release(struct vg_filled *f)
{
  free(f->x);
  free(f->cell);
  free(f->face);
  free(f->consumed);
  memset(f, 0, sizeof *f);
}

void vg_filled_put(struct vg_writer *w, const struct vg_filled *f, int cells)
{
  uint64_t count[5] = { f->n_point, f->n_cell, f->n_face, f->n_consumed,
                        f->n_hole };

  assert(w && f);
  assert(!cells || f->cell || !f->n_cell);
  vg_put(w, 5, sizeof *count, count);
  vg_put(w, 1, sizeof f->volume, &f->volume);
  vg_put(w, f->n_point, sizeof *f->x, f->x);
  vg_put(w, f->n_face, sizeof *f->face, f->face);
  vg_put(w, f->n_consumed, sizeof *f->consumed, f->consumed);
  if (cells) vg_put(w, f->n_cell, sizeof *f->cell, f->cell);
}

void vg_filled_get(struct vg_reader *r, struct vg_filled *f, int cells)
{
  uint64_t count[5] = { 0 };

  assert(r && f);
  memset(f, 0, sizeof *f);
  vg_get(r, 5, sizeof *count, count);
  vg_get(r, 1, sizeof f->volume, &f->volume);
  f->n_point = count[0];
  f->n_cell = count[1];
  f->n_face = count[2];
  f->n_consumed = count[3];
  f->n_hole = count[4];
  f->x = vg_get_array(r, f->n_point, sizeof *f->x);
  f->face = vg_get_array(r, f->n_face, sizeof *f->face);
  f->consumed = vg_get_array(r, f->n_consumed, sizeof *f->consumed);
  if (cells) f->cell = vg_get_array(r, f->n_cell, sizeof *f->cell);
  if (r->bad) vg_filled_release(f);
}

/* --- points and cells ----------------------------------------------------- */

/* Index in the result of each point of t: points of the front keep theirs, new
 * points of kept cells follow, all others have VG_NONE. */
static vg_status number_points(struct vg_filling *g, uint32_t *number,
                               struct vg_error *err)
{
  const struct vg_tets *t = &g->t;
  struct vg_filled *f = &g->out;
  size_t n_front = g->front->n_point;

  memset(number, 0xff, t->n_point * sizeof *number);
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++)
      number[t->cell[c].v[i]] = 0;
  for (size_t p = n_front; p < t->n_point; p++)
    if (number[p] != VG_NONE) number[p] = (uint32_t)(n_front + f->n_point++);
  for (size_t p = 0; p < n_front; p++) number[p] = (uint32_t)p;
  f->x = vg_alloc(f->n_point, sizeof *f->x);
  if (!f->x) return vg_fail_memory(err, "the points of the mesh");
  for (size_t p = n_front; p < t->n_point; p++)
    if (number[p] != VG_NONE)
      memcpy(f->x[number[p] - n_front], t->x[p], sizeof *f->x);
  return VG_OK;
}

static vg_status take_cells(struct vg_filling *g, const uint32_t *number,
                            struct vg_error *err)
{
  const struct vg_tets *t = &g->t;
  struct vg_filled *f = &g->out;
  size_t n = 0;

  f->cell = vg_alloc(f->n_cell, sizeof *f->cell);
  if (!f->cell) return vg_fail_memory(err, "the cells of the mesh");
  for (size_t c = 0; c < t->n_cell; c++) {
    if (!(t->flag[c] & VG_MARK)) continue;
    for (int i = 0; i < 4; i++) f->cell[n][i] = number[t->cell[c].v[i]];
    n++;
  }
  return VG_OK;
}

/* --- the change of the front ---------------------------------------------- */

/* Faces of the front, sorted by their lowest point. */
struct lookup {
  const struct vg_front *front;
  uint32_t *first; /* [front->n_point + 2] first face of each point */
  uint32_t *face;  /* [front->n_face] */
};

static uint32_t lowest(const uint32_t v[3])
{
  uint32_t low = v[0] < v[1] ? v[0] : v[1];

  return low < v[2] ? low : v[2];
}

static vg_status lookup_init(struct lookup *l, const struct vg_front *f,
                             struct vg_error *err)
{
  l->front = f;
  l->first = vg_calloc(f->n_point + 2, sizeof *l->first);
  l->face = vg_alloc(f->n_face, sizeof *l->face);
  if (!l->first || !l->face) return vg_fail_memory(err, "the front");
  for (size_t i = 0; i < f->n_face; i++) l->first[lowest(f->face[i]) + 2]++;
  for (size_t p = 0; p < f->n_point; p++) l->first[p + 2] += l->first[p + 1];
  for (size_t i = 0; i < f->n_face; i++)
    l->face[l->first[lowest(f->face[i]) + 1]++] = (uint32_t)i;
  return VG_OK;
}

/* The face of the front with these corners and orientation, or VG_NONE. */
static uint32_t lookup_find(const struct lookup *l, const uint32_t v[3])
{
  uint32_t low = lowest(v);

  if (v[0] >= l->front->n_point || v[1] >= l->front->n_point ||
      v[2] >= l->front->n_point)
    return VG_NONE;
  for (uint32_t i = l->first[low]; i < l->first[low + 1]; i++) {
    const uint32_t *f = l->front->face[l->face[i]];

    for (int k = 0; k < 3; k++)
      if (f[0] == v[k] && f[1] == v[(k + 1) % 3] && f[2] == v[(k + 2) % 3])
        return l->face[i];
  }
  return VG_NONE;
}

/* Every face around the kept cells is either a face of the front, which is
 * consumed, or a new face, which looks away from the cell. */
static vg_status take_faces(struct vg_filling *g, const struct lookup *l,
                            const uint32_t *number, uint8_t *is_consumed,
                            struct vg_error *err)
{
  const struct vg_tets *t = &g->t;
  struct vg_filled *out = &g->out;
  size_t cap = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++) {
      int is_fixed = t->flag[c] >> i & 1;
      uint32_t link = t->cell[c].link[i], v[3], f;

      if (link != VG_NONE && t->flag[link >> 2] & VG_MARK && !is_fixed)
        continue;
      for (int k = 0; k < 3; k++) v[k] = number[t->cell[c].v[vg_face[i][k]]];
      f = is_fixed ? lookup_find(l, v) : VG_NONE;
      if (f != VG_NONE) {
        is_consumed[f] = 1;
        continue;
      }
      if (vg_reserve(&out->face, &cap, out->n_face + 1, sizeof *out->face))
        return vg_fail_memory(err, "the front");
      out->face[out->n_face][0] = v[0];
      out->face[out->n_face][1] = v[2];
      out->face[out->n_face++][2] = v[1];
    }
  return VG_OK;
}

static vg_status close_front(struct vg_filling *g, const uint32_t *number,
                             struct vg_error *err)
{
  struct vg_filled *f = &g->out;
  size_t n_face = g->front->n_face;
  uint8_t *is_consumed = vg_calloc(n_face, 1);
  struct lookup l = { 0 };
  vg_status st;

  f->consumed = vg_alloc(n_face, sizeof *f->consumed);
  if (!is_consumed || !f->consumed) {
    st = vg_fail_memory(err, "the front");
    goto done;
  }
  VG_TRY(lookup_init(&l, g->front, err));
  VG_TRY(take_faces(g, &l, number, is_consumed, err));
  for (size_t i = 0; i < n_face; i++)
    if (is_consumed[i]) f->consumed[f->n_consumed++] = (uint32_t)i;
done:
  free(l.first);
  free(l.face);
  free(is_consumed);
  return st;
}

vg_status vg_filled_take(struct vg_filling *g, struct vg_error *err)
{
  uint32_t *number = vg_alloc(g->t.n_point, sizeof *number);
  vg_status st = number ? number_points(g, number, err)
                        : vg_fail_memory(err, "the points of the mesh");

  assert(!g->out.cell && !g->out.n_face && !g->out.face && !g->out.consumed);
  if (st == VG_OK) st = take_cells(g, number, err);
  if (st == VG_OK && g->region) st = close_front(g, number, err);
  free(number);
  return st;
}

/* --- checks --------------------------------------------------------------- */

static const double *point_of(const struct vg_front *front,
                              const struct vg_filled *f, uint32_t v)
{
  return v < front->n_point ? front->x[v] : f->x[v - front->n_point];
}

static int is_positive(const struct vg_front *front, const struct vg_filled *f,
                       const uint32_t v[4])
{
  const double *x[4];

  for (int i = 0; i < 4; i++) {
    if (v[i] >= front->n_point + f->n_point) return 0;
    x[i] = point_of(front, f, v[i]);
  }
  return vg_orient3d(x[0], x[1], x[2], x[3]) > 0;
}

/* Number of open edges of the boundary of a region's cells, which consists of
 * the consumed faces of the front and the new faces seen from the cells.
 * SIZE_MAX if the consumed faces are invalid. */
static size_t open_edges_around(const struct vg_front *front,
                                const struct vg_filled *f)
{
  struct vg_front around = { .n_point = front->n_point + f->n_point };
  size_t n_open;

  for (size_t i = 0; i < f->n_consumed; i++)
    if (f->consumed[i] >= front->n_face ||
        (i && f->consumed[i] <= f->consumed[i - 1]))
      return SIZE_MAX;
  around.face = vg_alloc(f->n_consumed + f->n_face, sizeof *around.face);
  if (!around.face) return SIZE_MAX;
  for (size_t i = 0; i < f->n_consumed; i++)
    memcpy(around.face[around.n_face++], front->face[f->consumed[i]],
           sizeof *around.face);
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++)
      around.face[f->n_consumed + i][k] = f->face[i][2 - k];
  around.n_face += f->n_face;
  n_open = vg_front_open_edges(&around);
  free(around.face);
  return n_open;
}

size_t vg_filled_defects(const struct vg_front *front,
                         const struct vg_filled *f, int has_region)
{
  size_t bad = 0, n_open;

  assert(front && f && (f->cell || !f->n_cell));
  for (size_t c = 0; c < f->n_cell; c++)
    bad += !is_positive(front, f, f->cell[c]);
  if (!has_region) return bad + f->n_face + f->n_consumed;
  n_open = open_edges_around(front, f);
  return n_open == SIZE_MAX ? n_open : bad + n_open;
}
