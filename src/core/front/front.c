/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/front/front.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"

void vg_front_release(struct vg_front *f)
{
  free(f->x);
  free(f->id);
  free(f->face);
  free(f->patch);
  free(f->face_id);
  memset(f, 0, sizeof *f);
}

void vg_front_put(struct vg_writer *w, const struct vg_front *f, int ids)
{
  uint64_t count[2] = { f->n_point, f->n_face };

  assert(w && f);
  assert(!ids || f->id || !f->n_point);
  vg_put(w, 2, sizeof *count, count);
  vg_put(w, f->n_point, sizeof *f->x, f->x);
  vg_put(w, f->n_face, sizeof *f->face, f->face);
  if (ids) vg_put(w, f->n_point, sizeof *f->id, f->id);
}

static int all_below(size_t n, const uint32_t *v, size_t limit)
{
  for (size_t i = 0; i < n; i++)
    if (v[i] >= limit) return 0;
  return 1;
}

void vg_front_get(struct vg_reader *r, struct vg_front *f, int ids)
{
  uint64_t count[2] = { 0, 0 };

  assert(r && f);
  memset(f, 0, sizeof *f);
  vg_get(r, 2, sizeof *count, count);
  f->n_point = count[0];
  f->n_face = count[1];
  f->x = vg_get_array(r, f->n_point, sizeof *f->x);
  f->face = vg_get_array(r, f->n_face, sizeof *f->face);
  if (ids) f->id = vg_get_array(r, f->n_point, sizeof *f->id);
  if (!r->bad && !all_below(3 * f->n_face, f->face[0], f->n_point)) r->bad = 1;
  if (r->bad) vg_front_release(f);
}

/* Mark the points that faces use. */
static vg_status mark_points(const struct vg_front *f, uint8_t *used,
                             struct vg_error *err)
{
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++) {
      if (f->face[i][k] >= f->n_point)
        return vg_fail(
          err, VG_ERR_INPUT,
          "triangle %zu refers to point %u, but there are %zu points", i + 1,
          f->face[i][k] + 1, f->n_point);
      used[f->face[i][k]] = 1;
    }
  return VG_OK;
}

vg_status vg_front_check(const struct vg_front *f, struct vg_error *err)
{
  assert(f && (f->x || !f->n_point) && (f->face || !f->n_face));

  uint8_t *used = vg_calloc(f->n_point, 1);
  size_t p = 0;
  vg_status st = used ? mark_points(f, used, err)
                      : vg_fail_memory(err, "the front");

  while (st == VG_OK && p < f->n_point && used[p]) p++;
  free(used);
  if (st < 0 || p == f->n_point) return st;
  return vg_fail(err, VG_ERR_INPUT,
                 "point %zu (%g %g %g) is in no triangle; remove it", p + 1,
                 f->x[p][0], f->x[p][1], f->x[p][2]);
}

double vg_front_volume(const struct vg_front *f)
{
  double sum = 0;

  assert((f->x && f->face) || !f->n_face);
  for (size_t i = 0; i < f->n_face; i++) {
    double a[3], b[3], c[3];

    vg_sub(f->x[f->face[i][0]], f->x[0], a);
    vg_sub(f->x[f->face[i][1]], f->x[0], b);
    vg_sub(f->x[f->face[i][2]], f->x[0], c);
    sum -= vg_triple(a, b, c) / 6;
  }
  return sum;
}

/* Points with the same id are one point: parts of a former single front may
 * touch. to out: [n_point] the first point with the same id. */
static vg_status find_twins(const struct vg_front *f, uint32_t *to,
                            struct vg_error *err)
{
  struct vg_key *key = vg_alloc(f->n_point, sizeof *key);
  vg_status st;

  if (!key) return vg_fail_memory(err, "a front");
  for (size_t k = 0; k < f->n_point; k++)
    key[k] = (struct vg_key){ f->id[k], (uint32_t)k };
  st = vg_sort_keys(f->n_point, key, err);
  for (size_t k = 0; st == VG_OK && k < f->n_point; k++)
    to[key[k].index] = k && key[k].key == key[k - 1].key ? to[key[k - 1].index]
                                                         : key[k].index;
  free(key);
  return st;
}

vg_status vg_front_weld(struct vg_front *f, struct vg_error *err)
{
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  size_t n = 0;
  vg_status st = to ? find_twins(f, to, err) : vg_fail_memory(err, "a front");

  assert(f->id || !f->n_point);
  for (size_t k = 0; st == VG_OK && k < f->n_point; k++) {
    if (to[k] != k) {
      to[k] = to[to[k]];
      continue;
    }
    memmove(f->x[n], f->x[k], sizeof *f->x);
    f->id[n] = f->id[k];
    to[k] = (uint32_t)n++;
  }
  for (size_t i = 0; st == VG_OK && i < f->n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[f->face[i][k]];
  if (st == VG_OK) f->n_point = n;
  free(to);
  return st;
}

vg_status vg_front_join(struct vg_front *to, const struct vg_front *from,
                        struct vg_error *err)
{
  size_t cap_x = to->n_point, cap_id = to->n_point, cap_face = to->n_face;
  size_t np = to->n_point + from->n_point, nf = to->n_face + from->n_face;

  assert(to->id || !to->n_point);
  assert(from->id || !from->n_point);
  if (vg_reserve(&to->x, &cap_x, np, sizeof *to->x) ||
      vg_reserve(&to->id, &cap_id, np, sizeof *to->id) ||
      vg_reserve(&to->face, &cap_face, nf, sizeof *to->face))
    return vg_fail_memory(err, "a front");
  if (from->n_point) {
    memcpy(to->x + to->n_point, from->x, from->n_point * sizeof *to->x);
    memcpy(to->id + to->n_point, from->id, from->n_point * sizeof *to->id);
  }
  for (size_t i = 0; i < from->n_face; i++)
    for (int k = 0; k < 3; k++)
      to->face[to->n_face + i][k] = (uint32_t)to->n_point + from->face[i][k];
  to->n_point = np;
  to->n_face = nf;
  return VG_OK;
}

vg_status vg_front_append(struct vg_front *to, const struct vg_front *from,
                          struct vg_error *err)
{
  vg_status st = vg_front_join(to, from, err);

  return st == VG_OK ? vg_front_weld(to, err) : st;
}
