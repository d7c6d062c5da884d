/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/result.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/mesh/mesh_defects.h"

#define SWEEPS 8 /* over zigzags of smooth patch borders */
#define NEAR_SQRT2 1.4142135623730951

/* --- patches ------------------------------------------------------------- */

static void middle(const struct vg_tris *w, size_t t, double x[3])
{
  for (int d = 0; d < 3; d++) {
    x[d] = 0;
    for (int k = 0; k < 3; k++) x[d] += w->point[w->tri[t][k]].x[d] / 3;
  }
}

/* Patch of the input triangle below the centroid of triangle t. */
static uint32_t patch_of(const struct vg_tris *w, size_t t,
                         const uint32_t *patch)
{
  uint32_t hint = w->point[w->tri[t][0]].home;
  double x[3], y[3], u[3], v[3], n[3];

  middle(w, t, x);
  vg_sub(vg_tris_at(w, w->tri[t][1]), vg_tris_at(w, w->tri[t][0]), u);
  vg_sub(vg_tris_at(w, w->tri[t][2]), vg_tris_at(w, w->tri[t][0]), v);
  vg_cross(u, v, n);
  vg_ref_nearest(w->ref, x, vg_unit(n) > 0 ? n : NULL, &hint, y);
  return patch[hint];
}

/* A triangle with two neighbours in the same other patch joins that patch, so
 * that smooth patch borders do not zigzag. No patch loses its last triangle. */
static void straighten(const struct vg_tris *w, uint32_t *label, size_t *count)
{
  size_t n = 1;

  for (int sweep = 0; n && sweep < SWEEPS; sweep++) {
    n = 0;
    for (uint32_t t = 0; t < w->n_tri; t++) {
      uint32_t other[3], own = label[t], n_other = 0;

      if (vg_tris_removed(w, t) || count[own] < 2) continue;
      for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        uint32_t q;

        if (w->edge[h] || w->mate[h] == VG_REF_NONE) continue;
        q = label[w->mate[h] / 3];
        if (q != own) other[n_other++] = q;
      }
      if (n_other < 2) continue;
      if (other[0] != other[1]) {
        if (n_other < 3 || (other[0] != other[2] && other[1] != other[2]))
          continue;
        other[0] = other[2];
      }
      label[t] = other[0];
      count[own]--;
      count[other[0]]++;
      n++;
    }
  }
}

/* A patch that is smaller than the local triangles gets the nearest
 * triangle. */
static void keep_patches(const struct vg_tris *w, const struct vg_mesh *given,
                         uint32_t *label, size_t *count)
{
  for (size_t i = 0; i < given->n_tri; i++) {
    const uint32_t p = given->tri_patch[i];
    double x[3], y[3], best = INFINITY;
    size_t at = SIZE_MAX;

    if (count[p]) continue;
    for (int d = 0; d < 3; d++)
      x[d] = w->ref->shape[i].a[d] +
             (w->ref->shape[i].u[d] + w->ref->shape[i].v[d]) / 3;
    for (size_t t = 0; t < w->n_tri; t++) {
      if (vg_tris_removed(w, t) || count[label[t]] < 2) continue;
      middle(w, t, y);
      if (vg_distance2(x, y) < best) best = vg_distance2(x, y), at = t;
    }
    if (at == SIZE_MAX) return;
    count[label[at]]--;
    label[at] = p;
    count[p]++;
  }
}

struct labelling {
  const struct vg_tris *w;
  const uint32_t *patch; /* Of the input triangles. */
  uint32_t *label;
};

static void find_labels(void *context, size_t first, size_t end, int worker)
{
  const struct labelling *l = context;

  (void)worker;
  if (vg_stops(&l->w->stop)) return;
  for (size_t t = first; t < end; t++)
    if (!vg_tris_removed(l->w, t)) l->label[t] = patch_of(l->w, t, l->patch);
}

static vg_status label_all(const struct vg_tris *w, const struct vg_mesh *given,
                           uint32_t *label, struct vg_error *err)
{
  struct labelling l = { w, given->tri_patch, label };
  size_t *count = vg_calloc(given->n_patch, sizeof *count);
  vg_status st;

  if (!count) return vg_fail_memory(err, "the patches of the surface");
  vg_parallel_for(w->threads, w->n_tri, 1024, find_labels, &l);
  VG_TRY(vg_stopped(&w->stop, err));
  for (size_t t = 0; t < w->n_tri; t++)
    if (!vg_tris_removed(w, t)) count[label[t]]++;
  straighten(w, label, count);
  keep_patches(w, given, label, count);
done:
  free(count);
  return st;
}

/* --- report --------------------------------------------------------------- */

static enum vg_remesh_cause cause_of(const struct vg_tris *w, size_t t)
{
  double least = INFINITY;
  uint32_t at = 0;
  int n_line = 0, n_edge = 0;

  for (uint32_t h = 3 * (uint32_t)t; h < 3 * t + 3; h++) {
    double l = vg_distance2(vg_tris_at(w, vg_tris_from(w, h)),
                            vg_tris_at(w, vg_tris_to(w, h)));

    n_line += w->point[vg_tris_from(w, h)].kind != VG_WORK_FACE;
    n_edge += w->edge[h] != 0;
    if (l < least) least = l, at = h;
  }
  /* The smallest angle is opposite the shortest edge. */
  if (w->edge[vg_half_next(at)] && w->edge[vg_half_prev(at)])
    return VG_REMESH_CORNER;
  if (n_line == 3) return VG_REMESH_STRIP;
  return n_edge || n_line ? VG_REMESH_LINE : VG_REMESH_SURFACE;
}

static void count_aspect(const struct vg_tris *w, size_t t,
                         struct vg_remesh_report *r)
{
  const struct vg_tris_point *p[3];
  double u[3], v[3], n[3], form[6], aspect, upto = 1.5;
  int i = 0;

  for (int k = 0; k < 3; k++) p[k] = &w->point[w->tri[t][k]];
  vg_sub(p[1]->x, p[0]->x, u);
  vg_sub(p[2]->x, p[0]->x, v);
  vg_cross(u, v, n);
  for (int k = 0; k < 6; k++)
    form[k] = (p[0]->asked.form[k] + p[1]->asked.form[k] +
               p[2]->asked.form[k]) /
              3;
  aspect = vg_form_aspect(form, n);
  for (; i + 1 < VG_REMESH_ASPECTS && aspect > upto; upto *= 2) i++;
  r->n_aspect[i]++;
  r->aspect_most = fmax(r->aspect_most, aspect);
}

static vg_status list_bad(const struct vg_tris *w, size_t t, size_t face,
                          size_t *cap, struct vg_remesh_report *r,
                          struct vg_error *err)
{
  const double sine = sqrt(vg_tris_tri_shape(w, t));
  struct vg_remesh_bad b = { .face = face };

  b.angle = asin(fmin(sine, 1)) * (180 / M_PI); /* for the report only: libm */
  if (!face || b.angle < r->angle_min) r->angle_min = b.angle;
  if (vg_tris_is_stretched(w)) count_aspect(w, t, r);
  if (sine >= 0.34202014332566873) return VG_OK; /* sine of VG_REMESH_BAD */
  if (vg_reserve(&r->bad, cap, r->n_bad + 1, sizeof *r->bad))
    return vg_fail_memory(err, "the list of bad triangles");
  b.cause = cause_of(w, t);
  middle(w, t, b.at);
  r->cause[b.cause]++;
  r->bad[r->n_bad++] = b;
  return VG_OK;
}

static void count_edges(const struct vg_tris *w, struct vg_remesh_report *r)
{
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    double ratio;

    if (vg_tris_removed(w, h / 3) ||
        (w->mate[h] != VG_REF_NONE && w->mate[h] < h))
      continue;
    ratio = vg_tris_ratio(w, h);
    r->n_edge++;
    r->n_edge_fit += ratio <= NEAR_SQRT2 && ratio >= 1 / NEAR_SQRT2;
    if (w->edge[h])
      r->line_length[1] += vg_distance(vg_tris_at(w, vg_tris_from(w, h)),
                                       vg_tris_at(w, vg_tris_to(w, h)));
  }
}

/* --- consistency check ---------------------------------------------------- */

static size_t bad_half(const struct vg_tris *w, uint32_t h)
{
  const uint32_t mate = w->mate[h];
  size_t bad = vg_tris_from(w, h) >= w->n_point;

  bad += w->edge[h] > w->n_line;
  if (mate == VG_REF_NONE) return bad;
  if (mate >= 3 * w->n_tri || vg_tris_removed(w, mate / 3)) return bad + 1;
  return bad + (w->mate[mate] != h) +
         (vg_tris_from(w, mate) != vg_tris_to(w, h)) +
         (vg_tris_to(w, mate) != vg_tris_from(w, h)) +
         (!w->edge[h] != !w->edge[mate]);
}

size_t vg_tris_defects(const struct vg_tris *w)
{
  size_t bad = 0;

  for (uint32_t t = 0; t < w->n_tri; t++) {
    if (vg_tris_removed(w, t)) continue;
    bad += w->tri[t][1] == w->tri[t][2] || w->tri[t][2] == w->tri[t][0];
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) bad += bad_half(w, h);
  }
  for (uint32_t p = 0; !bad && p < w->n_point; p++) {
    const uint32_t h = w->point[p].half;

    bad += h != VG_REF_NONE &&
           (h >= 3 * w->n_tri || vg_tris_removed(w, h / 3) ||
            vg_tris_from(w, h) != p);
  }
  return bad;
}

/* --- result --------------------------------------------------------------- */

static vg_status store(const struct vg_tris *w, const uint32_t *label,
                       uint32_t *map, struct vg_mesh *out,
                       struct vg_remesh_report *r, struct vg_error *err)
{
  size_t n = 0, cap = 0;
  vg_status st = VG_OK;

  for (size_t p = 0; p < w->n_point; p++) {
    if (w->point[p].half == VG_REF_NONE) continue;
    memcpy(out->point[n], w->point[p].x, sizeof *out->point);
    map[p] = (uint32_t)n++;
  }
  out->n_point = n;
  n = 0;
  for (size_t t = 0; t < w->n_tri; t++) {
    if (vg_tris_removed(w, t)) continue;
    for (int k = 0; k < 3; k++) out->tri[n][k] = map[w->tri[t][k]];
    VG_TRY(list_bad(w, t, n, &cap, r, err));
    out->tri_patch[n++] = label[t];
  }
  out->n_tri = n;
  count_edges(w, r);
done:
  return st;
}

vg_status vg_result_store(const struct vg_tris *w, const struct vg_mesh *given,
                          struct vg_mesh *out, struct vg_remesh_report *r,
                          struct vg_error *err)
{
  assert(!out->point && !out->tri && r);

  uint32_t *map = vg_alloc(w->n_point, sizeof *map);
  uint32_t *label = vg_alloc(w->n_tri, sizeof *label);
  vg_status st = VG_OK;

  out->point = vg_alloc(w->n_point, sizeof *out->point);
  out->tri = vg_alloc(w->n_tri, sizeof *out->tri);
  out->tri_patch = vg_alloc(w->n_tri, sizeof *out->tri_patch);
  out->patch = vg_alloc(given->n_patch, sizeof *out->patch);
  if (!map || !label || !out->point || !out->tri || !out->tri_patch ||
      !out->patch)
    VG_TRY(vg_fail_memory(err, "the remeshed surface"));
  memcpy(out->patch, given->patch, given->n_patch * sizeof *out->patch);
  out->n_patch = given->n_patch;
  VG_TRY(label_all(w, given, label, err));
  VG_TRY(store(w, label, map, out, r, err));
  VG_CHECK("the remeshing of a surface", vg_tris_defects(w));
  VG_CHECK("the remeshing of a surface", vg_mesh_bad_faces(out));
done:
  free(map);
  free(label);
  if (st < 0) vg_mesh_release(out);
  return st;
}
