/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The front: tops, remeshed slide patches, and all other triangles
 * unchanged. */
#include "layers/slide/slide.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"
#include "layers/slide/slide_parts.h"

enum { TEXT = sizeof((struct vg_slide_failure *)0)->text };

vg_status vg_slide_add_point(struct vg_slide_work *w, const double x[3],
                             uint32_t *number)
{
  assert(number);
  if (w->n_x >= UINT32_MAX - 1)
    return vg_fail(w->err, VG_ERR_UNSUPPORTED,
                   "front of the layers: more than 4 billion points; coarsen "
                   "the surface");
  if (vg_reserve(&w->x, &w->cap_x, w->n_x + 1, sizeof *w->x))
    return vg_fail_memory(w->err, "slide patches");
  memcpy(w->x[w->n_x], x, 3 * sizeof *x);
  *number = (uint32_t)w->n_x++;
  return VG_OK;
}

void vg_slide_mark_bad(struct vg_slide_work *w, uint32_t i, uint32_t patch,
                       const double x[3], const char *what)
{
  assert(i < w->c->n_column && what);

  const struct vg_patch *p = &w->m->patch[patch];

  if (!w->c->column[i].n) return;
  if (!w->text[0])
    snprintf(w->text, TEXT,
             "patch %" PRId32 " (%.60s) near (%.6g, %.6g, "
             "%.6g): %s",
             p->id, p->name, x[0], x[1], x[2], what);
  w->n_bad += !w->bad[i];
  if (!w->bad[i]) w->bad[i] = 1;
}

void vg_slide_mark_bad_all(struct vg_slide_work *w, size_t s, const char *what)
{
  assert(s < w->n_part && what);
  for (uint32_t r = w->border_first[s]; r < w->border_first[s + 1]; r++)
    for (int k = 0; k < 2; k++) {
      const uint32_t i = w->c->border[w->border[r]][k];

      vg_slide_mark_bad(w, i, w->part[s].patch,
                        w->m->point[w->c->column[i].root], what);
    }
}

uint32_t vg_slide_twin(const struct vg_slide_work *w, uint32_t a, uint32_t b)
{
  assert(a != b);
  for (uint32_t i = w->first[b]; i < w->first[b + 1]; i++) {
    const uint32_t h = w->half[i];

    if (w->m->tri[h / 3][h % 3 < 2 ? h % 3 + 1 : 0] == a) return h;
  }
  return VG_NO_INDEX;
}

/* --- preparation --------------------------------------------------------- */

static void release(struct vg_slide_work *w)
{
  free(w->slide_of);
  free(w->x);
  free(w->local);
  free(w->copy_of);
  free(w->held);
  free(w->held_edge);
  free(w->first);
  free(w->half);
  free(w->part);
  free(w->part_of);
  free(w->tri_first);
  free(w->tri);
  free(w->border_first);
  free(w->border);
  free(w->gone);
  free(w->edge);
  free(w->new_tri);
  free(w->new_patch);
  free(w->bad);
  free(w->step);
  free(w->steps_of);
  vg_slide_images_release(w);
}

static vg_status prepare(struct vg_slide_work *w)
{
  const struct vg_mesh *m = w->m;
  struct vg_columns *c = w->c;

  if (m->n_point + c->n_column >= UINT32_MAX - 1 || m->n_tri > UINT32_MAX / 3)
    return vg_fail(w->err, VG_ERR_UNSUPPORTED,
                   "layers: %zu wall columns on %zu points and %zu triangles "
                   "exceed the limits of 32-bit indices; coarsen the surface",
                   c->n_column, m->n_point, m->n_tri);
  w->slide_of = vg_alloc(m->n_patch, sizeof *w->slide_of);
  w->bad = vg_calloc(c->n_column, 1);
  w->n_x = w->cap_x = m->n_point + c->n_column;
  w->x = vg_alloc(w->cap_x, sizeof *w->x);
  if (!w->slide_of || !w->bad || !w->x)
    return vg_fail_memory(w->err, "slide patches");
  free(c->path);
  c->path = NULL;
  c->n_path = 0;
  memcpy(w->x, m->point, m->n_point * sizeof *w->x);
  for (size_t i = 0; i < c->n_column; i++) {
    c->column[i].bent = SIZE_MAX;
    vg_column_top(c, m, i, w->x[m->n_point + i]);
  }
  for (size_t i = 0; i < m->n_patch; i++) w->slide_of[i] = VG_NO_INDEX;
  for (size_t i = 0; i < w->n_slide; i++)
    w->slide_of[w->slide[i].patch] = (uint32_t)i;
  if (vg_mesh_inner_points(m, &w->copy_of, w->err) || vg_slide_hold(w))
    return VG_ERR_MEMORY;
  vg_slide_copy_tops(w);
  if (vg_slide_images_open(w)) return VG_ERR_MEMORY;
  return vg_slide_parts(w);
}

/* --- the front ----------------------------------------------------------- */

/* Triangles in the numbering of vg_slide_work: first the unchanged triangles of
 * the surface, with tops in the places of wall faces, then tops of virtual
 * faces, then remeshed patches. */
struct list {
  size_t n;
  uint32_t (*tri)[3], *patch, *face;
};

static void put(struct list *l, const uint32_t v[3], uint32_t patch,
                uint32_t face)
{
  memcpy(l->tri[l->n], v, 3 * sizeof *v);
  l->patch[l->n] = patch;
  l->face[l->n++] = face;
}

/* Adds the top of face f unless it is degenerate. If all columns of the face
 * have n = 0, the top is its own triangle. */
static void put_top(const struct vg_slide_work *w, uint32_t f, uint32_t patch,
                    struct list *l)
{
  const uint32_t *c = w->c->face[f];
  uint32_t v[3];
  int rises = 0;

  for (int k = 0; k < 3; k++) {
    v[k] = vg_slide_top(w, c[k]);
    rises |= w->c->column[c[k]].n > 0;
  }
  if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return;
  put(l, v, patch, rises ? f : VG_NO_INDEX);
}

static vg_status list_triangles(struct vg_slide_work *w, struct list *l)
{
  const struct vg_mesh *m = w->m;
  const struct vg_columns *c = w->c;
  const size_t most = m->n_tri + c->n_face + w->n_new;
  uint32_t *face_of = vg_alloc(m->n_tri, sizeof *face_of);
  uint32_t *patch_of = vg_alloc(m->n_point, sizeof *patch_of);

  l->tri = vg_alloc(most, sizeof *l->tri);
  l->patch = vg_alloc(most, sizeof *l->patch);
  l->face = vg_alloc(most, sizeof *l->face);
  if (!face_of || !patch_of || !l->tri || !l->patch || !l->face) {
    free(face_of);
    free(patch_of);
    return vg_fail_memory(w->err, "the front of the layers");
  }
  memset(face_of, 0xff, m->n_tri * sizeof *face_of);
  for (size_t f = c->n_face; f-- > 0;) {
    const uint32_t t = c->face_tri[f];

    if (t == VG_NO_INDEX) continue;
    face_of[t] = (uint32_t)f;
    for (int k = 0; k < 3; k++) patch_of[m->tri[t][k]] = m->tri_patch[t];
  }
  for (uint32_t t = 0; t < m->n_tri; t++) {
    const uint32_t patch = m->tri_patch[t];

    if (face_of[t] != VG_NO_INDEX) put_top(w, face_of[t], patch, l);
    else if (w->part_of[t] == VG_NO_INDEX)
      put(l, m->tri[t], patch, VG_NO_INDEX);
  }
  for (uint32_t f = 0; f < c->n_face; f++)
    if (c->face_tri[f] == VG_NO_INDEX)
      put_top(w, f, patch_of[c->column[c->face[f][0]].root], l);
  for (size_t i = 0; i < w->n_new; i++)
    put(l, w->new_tri[i], w->new_patch[i], VG_NO_INDEX);
  free(face_of);
  free(patch_of);
  return VG_OK;
}

/* An unchanged triangle must not use a root at which all columns have levels:
 * such a patch touches a wall at a point where no column slides in it. */
static vg_status check_roots(struct vg_slide_work *w, const struct list *l)
{
  const struct vg_columns *c = w->c;
  uint8_t *left = vg_calloc(w->m->n_point, 1); /* Bits: 1: a column with levels,
                                                  2: a column without. */

  if (!left) return vg_fail_memory(w->err, "the front of the layers");
  for (size_t i = 0; i < c->n_column; i++)
    left[c->column[i].root] |= c->column[i].n ? 1 : 2;
  for (size_t i = 0; i < l->n; i++)
    for (int k = 0; k < 3; k++) {
      const uint32_t v = l->tri[i][k];
      size_t lo = 0, n = c->n_column;

      if (v >= w->m->n_point || left[v] != 1) continue;
      while (n) {
        const size_t half = n / 2;
        const int below = c->column[lo + half].root < v;

        lo += below ? half + 1 : 0;
        n = below ? n - half - 1 : half;
      }
      for (; lo < c->n_column && c->column[lo].root == v; lo++)
        vg_slide_mark_bad(w, (uint32_t)lo, l->patch[i], w->m->point[v],
                          "columns have levels where the patch only touches "
                          "the wall");
    }
  free(left);
  return VG_OK;
}

/* Numbers the points in use, in the order of vg_slide_work. */
static vg_status number_points(const struct vg_slide_work *w,
                               const struct list *l, struct vg_front *f)
{
  const size_t n_m = w->m->n_point, n_c = w->c->n_column;
  uint32_t *number = vg_calloc(w->n_x, sizeof *number);
  size_t n = 0;

  for (size_t i = 0; number && i < 3 * l->n; i++)
    number[l->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; number && i < w->n_x; i++) n += number[i];
  f->x = vg_alloc(n, sizeof *f->x);
  f->id = vg_alloc(n, sizeof *f->id);
  if (!number || !f->x || !f->id) {
    free(number);
    return vg_fail_memory(w->err, "the front of the layers");
  }
  f->n_point = n;
  n = 0;
  for (size_t i = 0; i < w->n_x; i++) {
    if (!number[i]) continue;
    memcpy(f->x[n], w->x[i], sizeof w->x[i]);
    f->id[n] = i < n_m       ? vg_layer_point_id((uint32_t)i)
             : i < n_m + n_c ? vg_layer_top_id((uint32_t)(i - n_m))
                             : VG_LAYER_NEW;
    number[i] = (uint32_t)n++;
  }
  for (size_t i = 0; i < 3 * l->n; i++)
    l->tri[i / 3][i % 3] = number[l->tri[i / 3][i % 3]];
  free(number);
  return VG_OK;
}

static vg_status assemble(struct vg_slide_work *w, struct vg_front *out)
{
  struct vg_front f = VG_FRONT_INIT;
  struct list l = { 0, NULL, NULL, NULL };
  vg_status st;

  VG_TRY(list_triangles(w, &l));
  VG_TRY(check_roots(w, &l));
  if (w->n_bad) goto done;
  VG_TRY(number_points(w, &l, &f));
  f.n_face = l.n;
  f.face = l.tri;
  f.patch = l.patch;
  f.face_id = l.face;
  *out = f;
  return VG_OK;
done:
  free(l.tri);
  free(l.patch);
  free(l.face);
  vg_front_release(&f);
  return st;
}

static vg_status hand_failure(const struct vg_slide_work *w,
                              struct vg_slide_failure *failure)
{
  uint32_t *list = vg_alloc(w->n_bad, sizeof *list + 1);
  uint8_t *never = (uint8_t *)(list + w->n_bad);
  size_t n = 0;

  if (!list) return vg_fail_memory(w->err, "slide patches");
  for (uint32_t i = 0; i < w->c->n_column; i++)
    if (w->bad[i]) {
      never[n] = w->bad[i] > 1;
      list[n++] = i;
    }
  failure->n = n;
  failure->never = never;
  failure->column = list;
  return VG_BLOCKED;
}

vg_status vg_slide_front(const struct vg_mesh *surface, size_t n_slide,
                         const struct vg_slide *slide,
                         const struct vg_twins *twins,
                         struct vg_columns *columns,
                         const struct vg_sizing *sizing, struct vg_front *front,
                         struct vg_slide_failure *failure, struct vg_error *err)
{
  assert((slide || !n_slide) && sizing && front && failure);
  struct vg_slide_work w = { .m = surface,
                             .sizing = sizing,
                             .n_slide = n_slide,
                             .slide = slide,
                             .twins = twins,
                             .c = columns,
                             .text = failure->text,
                             .err = err };
  vg_status st;

  memset(failure, 0, sizeof *failure);
  *front = (struct vg_front)VG_FRONT_INIT;
  VG_TRY(prepare(&w));
  VG_TRY(vg_slide_curves(&w));
  vg_slide_copy_tops(&w);
  w.local = vg_alloc(w.n_x, sizeof *w.local);
  if (!w.local) {
    st = vg_fail_memory(err, "slide patches");
    goto done;
  }
  memset(w.local, 0xff, w.n_x * sizeof *w.local);
  for (size_t s = 0; s < w.n_part; s++)
    if (!vg_slide_is_image(&w, w.part[s].patch)) VG_TRY(vg_slide_remesh(&w, s));
  VG_TRY(vg_slide_copy_paths(&w));
  if (!w.n_bad) VG_TRY(vg_slide_copy_faces(&w));
  VG_TRY(assemble(&w, front));
  if (w.n_bad) st = hand_failure(&w, failure);
done:
  release(&w);
  return st;
}
