/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Splits edges of the input surface that are long compared with the sizes at
 * their ends. Sizes are interpolated linearly within the input triangles, so
 * that a large triangle with small sizes at its corners would be filled with
 * small triangles.
 *
 *      narrow strip, small sizes          small sizes at the rim only
 *     o============================o     o===o===o===o===o===o===o===o
 *     |                         .  |     |  / \ / \ / \ / \ / \ / \  |
 *     |                 .          |     |.   .   .   .   .   .    . |
 *     |         .                  |     |    larger sizes inside    |
 *     | .                          |     |'   '   '   '   '   '    ' |
 *     o============================o     o===o===o===o===o===o===o===o
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/job.h"
#include "core/remesh/strips_cut.h"

/* S47: largest ratio of grown to interpolated size at the midpoint of a feature
 * edge and of other edges. */
#define LEAP 10.0
#define LEAP_INSIDE 4.0
#define CUTS 256    /* most pieces of a feature edge */
#define PLANE 1e-12 /* 1 - cosine between the triangles of a plane face */
#define ROUNDS 20   /* most bisections of another edge */
#define MOST 200000 /* triangles above which other edges are not split */

/* Ratio of the size that growth from the ends of edge h permits at its
 * midpoint to the interpolated size. */
static double leap(const struct vg_remesh_job *j, uint32_t h, double *grown)
{
  const struct vg_ref *r = &j->ref;
  const double a = r->size[vg_ref_from(r, h)], b = r->size[vg_ref_to(r, h)];
  const double length = vg_distance(r->point[vg_ref_from(r, h)],
                                    r->point[vg_ref_to(r, h)]);

  *grown = fmin(j->r.h_max, fmin(a, b) + r->slope * length / 2);
  return 2 * *grown / (a + b);
}

static double length_of(const struct vg_ref *r, uint32_t h)
{
  return vg_distance(r->point[vg_ref_from(r, h)], r->point[vg_ref_to(r, h)]);
}

/* Number of pieces into which feature edge h must be split. */
static int pieces(const struct vg_remesh_job *j, uint32_t h)
{
  double grown;

  if (!(leap(j, h, &grown) > LEAP)) return 1;
  grown = length_of(&j->ref, h) / grown;
  return grown < CUTS ? (int)grown + 2 : CUTS;
}

/* Is h the longest edge of its triangle that is not a feature edge? Of equal
 * edges it is the first. */
static int is_longest(const struct vg_remesh_job *j, uint32_t h)
{
  const double own = length_of(&j->ref, h);

  for (uint32_t g = 3 * (h / 3); g < 3 * (h / 3) + 3; g++)
    if (g != h && !j->curves.line[g] &&
        (length_of(&j->ref, g) > own ||
         (!(length_of(&j->ref, g) < own) && g < h)))
      return 0;
  return 1;
}

/* Is triangle t coplanar with its neighbours up to the next feature curves? The
 * facets of a curved face are not. */
static int is_plane(const struct vg_remesh_job *j, uint32_t t)
{
  const struct vg_ref *r = &j->ref;

  for (uint32_t h = 3 * t; h < 3 * t + 3; h++)
    if (!j->curves.line[h] &&
        (r->mate[h] == VG_REF_NONE ||
         !(vg_dot(r->shape[t].n, r->shape[r->mate[h] / 3].n) > 1 - PLANE)))
      return 0;
  return 1;
}

/* Must edge h inside a plane face be bisected? Only the longest edges of
 * triangles are, so that triangles keep their shape. On curved faces, new
 * points would have no curvature. */
static int is_bisected(const struct vg_remesh_job *j, uint32_t h)
{
  const uint32_t g = j->ref.mate[h];
  double grown;

  return g != VG_REF_NONE && leap(j, h, &grown) > LEAP_INSIDE &&
         is_plane(j, h / 3) && is_plane(j, g / 3) &&
         (is_longest(j, h) || is_longest(j, g));
}

/* [3 whole->n_tri] Number of pieces of each edge, stored at one of its
 * half-edges. */
static size_t count_pieces(const struct vg_remesh_job *j, int lines,
                           uint16_t *n)
{
  size_t sum = 0;

  for (uint32_t h = 0; h < 3 * j->ref.n_tri; h++) {
    const uint32_t g = j->ref.mate[h];
    uint32_t from = j->strips.n ? j->strips.half_from[h] : h;
    int k = 1;

    if ((g != VG_REF_NONE && g < h) || from == VG_REF_NONE) continue;
    if (j->curves.line[h]) k = lines ? pieces(j, h) : 1;
    else if (!lines && is_bisected(j, h)) k = 2;
    if (k <= n[from] || k < 2) continue;
    sum++;
    n[from] = (uint16_t)k;
  }
  return sum;
}

static vg_status cut_all(struct vg_remesh_job *j, const uint16_t *n,
                         struct vg_strips *s, struct vg_error *err)
{
  struct vg_ref faces = VG_REF_INIT;
  struct vg_strip_cutter cut = { .s = s };
  vg_status st;

  VG_TRY(vg_ref_set_faces(&faces, j->whole, &j->o->stop, err));
  VG_TRY(vg_strip_cutter_begin(&cut, &faces, j->whole, err));
  for (uint32_t h = 0; h < 3 * j->whole->n_tri; h++) {
    const uint32_t g = faces.mate[h];
    int k = n[h];

    if (g != VG_REF_NONE && g < h) continue;
    if (g != VG_REF_NONE && n[g] > k) k = n[g];
    for (int i = 1; i < k; i++)
      VG_TRY(vg_strip_cut(&cut, h, (double)i / k, (i + 1.0) / k, err));
  }
done:
  vg_strip_cutter_release(&cut);
  vg_ref_release(&faces);
  return st;
}

/* Split feature edges or other edges, and build the reference for the split
 * surface. */
static vg_status cut_edges(struct vg_remesh_job *j, int lines, int *any,
                           struct vg_error *err)
{
  const size_t n_old = j->whole->n_point;
  uint16_t *n = vg_calloc(3 * j->whole->n_tri, sizeof *n);
  struct vg_strips s = VG_STRIPS_INIT;
  double *cap = NULL;
  vg_status st = VG_OK;

  if (!n) VG_TRY(vg_fail_memory(err, "the edges of the surface"));
  *any = count_pieces(j, lines, n) > 0;
  if (!*any) goto done;
  VG_TRY(cut_all(j, n, &s, err));
  if (j->o->cap) {
    cap = vg_alloc(s.mesh.n_point, sizeof *cap);
    if (!cap) VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
    memcpy(cap, j->o->cap, n_old * sizeof *cap);
    for (size_t i = 0; i < s.n_new; i++)
      cap[n_old + i] = fmin(cap[s.ends[i][0]], cap[s.ends[i][1]]);
  }
  vg_job_release_reference(j);
  VG_TRY(vg_job_adopt(j, &s.mesh, s.tri_from, s.half_from, &cap, err));
  VG_TRY(vg_job_set_reference(j, 1, err));
done:
  free(n);
  free(cap);
  vg_strips_release(&s);
  return st;
}

vg_status vg_job_cut_edges(struct vg_remesh_job *j, struct vg_error *err)
{
  int any = 0;
  vg_status st = VG_OK;

  if (!j->no_cuts) VG_TRY(cut_edges(j, 1, &j->is_cut, err));
  for (int i = 0; i < ROUNDS && j->whole->n_tri < MOST; i++) {
    VG_TRY(cut_edges(j, 0, &any, err));
    if (!any) break;
  }
done:
  return st;
}
