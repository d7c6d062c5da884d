/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/slide/twins.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_twins_release(struct vg_twins *t)
{
  for (size_t p = 0; p < t->n; p++) {
    if (t->match) vg_periodic_match_release(&t->match[p]);
    if (t->column) free(t->column[p]);
  }
  free(t->match);
  free(t->patch);
  free(t->column);
  *t = (struct vg_twins)VG_TWINS_INIT;
}

size_t vg_twins_image(const struct vg_twins *t, uint32_t patch)
{
  size_t p = 0;

  while (p < t->n && t->patch[p][1] != patch) p++;
  return p;
}

vg_status vg_twins_open(const struct vg_mesh *surface, size_t n,
                        const struct vg_periodic *pair, struct vg_twins *t,
                        struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(!t->n && (pair || !n));
  if (!n) return VG_OK;
  t->n = n;
  t->pair = pair;
  t->match = vg_calloc(n, sizeof *t->match);
  t->patch = vg_alloc(n, sizeof *t->patch);
  t->column = vg_calloc(n, sizeof *t->column);
  if (!t->match || !t->patch || !t->column)
    VG_TRY(vg_fail_memory(err, "the periodic patches"));
  for (size_t p = 0; p < n; p++) {
    const double exact = VG_PERIODIC_EXACT *
                         vg_periodic_extent(surface, &pair[p]);

    VG_TRY(vg_periodic_match(surface, &pair[p], exact, &t->match[p], err));
    if (!vg_periodic_matches(&t->match[p]))
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic patches %" PRId32 " and %" PRId32
                   " differ on the surface from which layers grow",
                   pair[p].patch, pair[p].image);
    if (st < 0) goto done;
    t->patch[p][0] = (uint32_t)vg_mesh_find_patch(surface, pair[p].patch);
    t->patch[p][1] = (uint32_t)vg_mesh_find_patch(surface, pair[p].image);
  }
done:
  if (st < 0) vg_twins_release(t);
  return st;
}

/* Columns first .. end - 1 at point p that slide in the patch. All columns of
 * one root slide in the same patches. */
static void columns_at(const struct vg_columns *c, const uint32_t *first,
                       uint32_t point, uint32_t patch, uint32_t range[2])
{
  range[0] = first[point];
  range[1] = first[point + 1];
  if (range[0] == range[1]) return;
  if (c->column[range[0]].slide[0] != patch &&
      c->column[range[0]].slide[1] != patch)
    range[1] = range[0];
}

static void find_pair(struct vg_twins *t, size_t p, size_t n_point,
                      struct vg_columns *c, const uint32_t *first,
                      uint8_t *alone)
{
  uint32_t *twin = t->column[p];

  memset(twin, 0xff, c->n_column * sizeof *twin);
  for (uint32_t i = 0; i < n_point; i++) {
    const uint32_t j = t->match[p].point[i];
    uint32_t a[2], b[2];

    if (j == VG_PERIODIC_NONE) continue;
    columns_at(c, first, i, t->patch[p][0], a);
    columns_at(c, first, j, t->patch[p][1], b);
    if (a[1] - a[0] == b[1] - b[0]) {
      for (uint32_t k = 0; k < a[1] - a[0]; k++) {
        twin[a[0] + k] = b[0] + k;
        c->is_twin[a[0] + k] = c->is_twin[b[0] + k] = 1;
      }
      continue;
    }
    for (uint32_t k = first[i]; k < first[i + 1]; k++) alone[k] = 1;
    for (uint32_t k = first[j]; k < first[j + 1]; k++) alone[k] = 1;
  }
}

void vg_twins_mark_images(const struct vg_twins *t, size_t n_point,
                          uint8_t *is_image)
{
  for (size_t p = 0; p < t->n; p++)
    for (uint32_t i = 0; i < n_point; i++) {
      const uint32_t j = t->match[p].point[i];

      if (j != VG_PERIODIC_NONE && j != i) is_image[j] = 1;
    }
}

vg_status vg_twins_find(struct vg_twins *t, const struct vg_mesh *surface,
                        struct vg_columns *c, uint8_t *alone,
                        struct vg_error *err)
{
  uint32_t *first;

  if (!t->n) return VG_OK;
  first = vg_calloc(surface->n_point + 1, sizeof *first);
  if (!first) return vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < c->n_column; i++) first[c->column[i].root + 1]++;
  for (size_t i = 0; i < surface->n_point; i++) first[i + 1] += first[i];
  for (size_t p = 0; p < t->n; p++) {
    free(t->column[p]);
    t->column[p] = vg_alloc(c->n_column, sizeof **t->column);
    if (!t->column[p]) {
      free(first);
      return vg_fail_memory(err, "the periodic patches");
    }
    find_pair(t, p, surface->n_point, c, first, alone);
  }
  free(first);
  return VG_OK;
}
