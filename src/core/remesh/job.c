/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: remove small faults of the input surface, find feature curves, close
 * narrow strips, and compute the sizing field. Long feature edges are split if
 * the sizes at their ends do not represent the size at their midpoint. Feature
 * curves and sizes are then computed again. */
#include "core/remesh/job.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/sizes.h"
#include "core/remesh/strips_cut.h"
#include "core/remesh/work.h"
#include "core/sizing/sizing_source.h"
#include "core/surface/borders.h"
#include "core/surface/envelope.h"

#define TOLERANCE 1e-4 /* S20: of the body's length */
#define FINE 0.0075    /* S86: of the width of a patch: largest tolerance */
#define NOISE 3.0    /* S43: of the accuracy: least size from the shape alone */
#define H_MAX 0.02   /* of the length of the body */
#define H_MIN 2e-4   /* of the length: twice the tolerance */
#define H_OUTER 0.04 /* of the length of the domain */
#define OUTER 0.9    /* S27: share of a patch's triangles that makes it outer */
/* S47: largest ratio of grown to interpolated size at the midpoint of a feature
 * edge and of other edges. */
#define LEAP 10.0
#define LEAP_INSIDE 4.0
/* S47: largest ratio of the expected numbers of triangles after and before
 * feature edges are split, and other edges are bisected once. */
#define GAIN 0.7
#define GAIN_INSIDE 0.99
#define CUTS 256        /* most pieces of a feature edge */
#define PLANE 1e-12     /* 1 - cosine between the triangles of a plane face */
#define ROUNDS 20       /* most bisections of another edge */
#define MOST_CUT 200000 /* triangles above which other edges are not split */
#define ALONG 4.0       /* S47: triangles along an edge of a feature curve */
#define SAME 1e-3       /* relative difference of sizes that are equal */
#define TRIANGLES 3e8   /* limit of the estimated number of new triangles */

static double length_of(const struct vg_mesh *m, const uint8_t *outer)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY }, most = 0;
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !(outer && outer[t]); k++)
      for (int d = 0; d < 3; d++) {
        lo[d] = fmin(lo[d], m->point[m->tri[t][k]][d]);
        hi[d] = fmax(hi[d], m->point[m->tri[t][k]][d]);
      }
  for (int d = 0; d < 3; d++) most = fmax(most, hi[d] - lo[d]);
  return most;
}

/* A patch of which all but a few triangles are outer is outer as a whole: a
 * single remaining triangle would make the body as long as the domain. */
static vg_status complete_outer(const struct vg_mesh *m, uint8_t *outer,
                                struct vg_error *err)
{
  size_t(*n)[2] = vg_calloc(m->n_patch, sizeof *n);

  if (!n) return vg_fail_memory(err, "the patches");
  for (size_t t = 0; t < m->n_tri; t++) n[m->tri_patch[t]][!!outer[t]]++;
  for (size_t t = 0; t < m->n_tri; t++) {
    const size_t *of = n[m->tri_patch[t]];

    if ((double)of[1] >= OUTER * (double)(of[0] + of[1])) outer[t] = 1;
  }
  free(n);
  return VG_OK;
}

/* Surfaces that end on the outer boundary have sizes of bodies there. */
static int has_line(const struct vg_remesh_job *j, size_t t)
{
  const double *by = j->o->stretch ? j->o->stretch + 3 * t : NULL;

  return by && (by[0] < 0 || by[1] < 0 || by[2] < 0);
}

/* Set tolerance and size bounds from the length of the body. The outer boundary
 * of a whole domain has its own upper bound. */
static vg_status settle(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_mesh *m = j->given;
  struct vg_remesh_report *r = &j->r;
  struct vg_envelope e;
  uint8_t *outer = vg_alloc(m->n_tri, 1);
  double whole = length_of(m, NULL);
  vg_status st = VG_OK;

  if (!outer) VG_TRY(vg_fail_memory(err, "the outer boundary"));
  VG_TRY(vg_envelope_measure(m, outer, &e, err));
  if (j->o->is_body) e.is_domain = 0;
  if (e.is_domain) VG_TRY(complete_outer(m, outer, err));
  r->length = e.is_domain ? length_of(m, outer) : whole;
  if (!(r->length > 0)) r->length = whole;
  j->jag = j->o->tolerance > 0 ? j->o->tolerance
                               : fmax(TOLERANCE * r->length, j->o->accuracy);
  r->tolerance = j->jag * j->o->scale * fmax(j->o->scale, 1);
  r->h_max = j->o->h_max > 0 ? j->o->h_max : H_MAX * r->length;
  if (e.is_domain) {
    j->far = j->o->is_requested && j->o->h_max > 0
             ? r->h_max
             : fmin(r->h_max, H_MAX * r->length);
    j->cap = vg_alloc(m->n_tri, sizeof *j->cap);
    if (!j->cap) VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
    for (size_t t = 0; t < m->n_tri; t++)
      j->cap[t] = outer[t] && !has_line(j, t) ? INFINITY : j->far;
    if (!(j->o->h_max > 0)) r->h_max = fmax(r->h_max, H_OUTER * whole);
  }
  r->h_min = j->o->h_min > 0 ? j->o->h_min : fmin(H_MIN * r->length, r->h_max);
  for (size_t t = 0; j->cap && t < m->n_tri; t++) j->cap[t] *= j->o->scale;
  r->h_max *= j->o->scale;
  j->far *= j->o->scale;
  r->far = j->far;
  r->h_min *= j->o->scale;
done:
  free(outer);
  return st;
}

static double edge_length(const struct vg_ref *r, uint32_t h)
{
  return vg_distance(r->point[vg_ref_from(r, h)], r->point[vg_ref_to(r, h)]);
}

/* Mean of 1/h over an edge with sizes h that are a and b at its ends. */
static double mean_inverse(double a, double b)
{
  return fabs(b - a) > SAME * a ? log(b / a) / (b - a) : 2 / (a + b);
}

/* Mean of 1/h^2 over a triangle with sizes h at its corners: twice the second
 * divided difference of -log h (Hermite-Genocchi formula). */
static double mean_inverse2(const double h[3])
{
  const double lo = fmin(h[0], fmin(h[1], h[2]));
  const double hi = fmax(h[0], fmax(h[1], h[2]));
  const double sum = h[0] + h[1] + h[2], mid = sum - lo - hi;

  if (!(hi - lo > SAME * hi)) return 9 / (sum * sum);
  return 2 * (mean_inverse(lo, mid) - mean_inverse(mid, hi)) / (hi - lo);
}

/* Number of new triangles that the sizes request: those that fill the area, and
 * rows on both sides of the feature curves. */
static double expected_number(const struct vg_remesh_job *j)
{
  const struct vg_ref *r = &j->ref;
  double n = 0;

  for (uint32_t t = 0; t < r->n_tri; t++) {
    const uint32_t *v = r->tri[t];
    const double size[3] = { r->size[v[0]], r->size[v[1]], r->size[v[2]] };
    double x[3];

    vg_cross(r->shape[t].u, r->shape[t].v, x);
    n += vg_norm(x) / 0.8660254037844386 * mean_inverse2(size);
    for (uint32_t k = 0; k < 3; k++)
      if (j->curves.line[3 * t + k])
        n += ALONG * edge_length(r, 3 * t + k) *
             mean_inverse(size[k], size[(k + 1) % 3]);
  }
  return n;
}

/* Refuse sizes that would give more triangles than any computer can hold. The
 * usual reason is another unit of length. */
static vg_status check_number(struct vg_remesh_job *j, struct vg_error *err)
{
  j->n_expected = expected_number(j);
  if (j->o->most_tri > 0 && j->n_expected > j->o->most_tri)
    return vg_fail(err, VG_ERR_INPUT,
                   "the remeshed surface would have some %.2g triangles, more "
                   "than the %.9g cells that are allowed (max_cells); use "
                   "larger sizes, or raise the limit",
                   j->n_expected, j->o->most_tri);
  if (j->n_expected < TRIANGLES) return VG_OK;
  if (!isfinite(j->n_expected))
    return vg_fail(err, VG_ERR_INPUT,
                   "the areas of the triangles, or their target edge lengths, "
                   "are beyond the range of numbers; check the coordinates and "
                   "the unit");
  return vg_fail(err, VG_ERR_INPUT,
                 "the remeshed surface would have some %.2g triangles; check "
                 "that sizes and tolerance are in the unit of the surface",
                 j->n_expected);
}

static const double *cap_of(const struct vg_remesh_job *j)
{
  return j->strip_cap ? j->strip_cap : j->cap;
}

static vg_status find_lines(struct vg_remesh_job *j,
                            const struct vg_curves_options *c,
                            struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_ref_set_faces(&j->ref, j->given, &j->o->stop, err));
  VG_TRY(vg_stopped(&j->o->stop, err));
  VG_TRY(vg_curves_find(&j->curves, &j->ref, c, err));
  VG_TRY(vg_stopped(&j->o->stop, err));
done:
  return st;
}

static vg_status find_sizes(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  vg_status st;

  VG_TRY(vg_ref_add_tree(&j->ref, &o->stop, err));
  VG_TRY(vg_stopped(&o->stop, err));
  VG_TRY(
    vg_sizes_make(&j->ref, &j->curves,
                  &(struct vg_sizes_options){
                    o->per_turn / o->scale,
                    VG_SIZES_CHORD * j->jag * o->scale * o->scale, o->scale,
                    j->r.h_min, j->r.h_max, NOISE * o->accuracy * o->scale,
                    vg_scaled_growth(o->growth, o->scale), cap_of(j),
                    j->point_cap ? j->point_cap : o->cap, o->across,
                    j->given->tri_patch, o->stop },
                  err));
done:
  return st;
}

/* Extend the largest sizes to the mesh in which strips are closed. */
static vg_status extend_caps(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_strips *s = &j->strips;
  const size_t n = s->mesh.n_point - s->n_new;
  double *cap;

  if (j->cap) {
    cap = j->strip_cap = vg_alloc(s->mesh.n_tri, sizeof *cap);
    if (!cap) return vg_fail_memory(err, "the sizes on the surface");
    for (size_t t = 0; t < s->mesh.n_tri; t++) cap[t] = j->cap[s->tri_from[t]];
  }
  if (!j->o->cap) return VG_OK;
  cap = j->point_cap = vg_alloc(s->mesh.n_point, sizeof *cap);
  if (!cap) return vg_fail_memory(err, "the sizes on the surface");
  memcpy(cap, j->o->cap, n * sizeof *cap);
  for (size_t i = 0; i < s->n_new; i++)
    cap[n + i] = fmin(cap[s->ends[i][0]], cap[s->ends[i][1]]);
  return VG_OK;
}

static vg_status extend_stretch(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_strips *s = &j->strips;
  const size_t n = 3 * s->mesh.n_tri;

  if (!j->o->stretch) return VG_OK;
  j->stretch = vg_calloc(n, sizeof *j->stretch);
  if (!j->stretch) return vg_fail_memory(err, "the stretched feature curves");
  for (size_t h = 0; h < n; h++)
    if (s->half_from[h] != VG_REF_NONE)
      j->stretch[h] = j->o->stretch[s->half_from[h]];
  return VG_OK;
}

/* Close narrow strips. If there are any, find the feature curves again without
 * the closed pieces. */
static vg_status close_strips(struct vg_remesh_job *j,
                              struct vg_curves_options *c, struct vg_error *err)
{
  vg_status st;

  VG_TRY(
    vg_strips_find(&j->ref, &j->curves, j->given,
                   &(struct vg_strips_options){ .tolerance = j->r.tolerance,
                                                .closes_edges = j->closes_edges,
                                                .across = j->o->across,
                                                .lines = c },
                   &j->strips, err));
  if (!j->strips.n) goto done;
  VG_TRY(extend_caps(j, err));
  VG_TRY(extend_stretch(j, err));
  vg_curves_release(&j->curves);
  vg_ref_release(&j->ref);
  j->given = &j->strips.mesh;
  c->tri_patch = j->given->tri_patch;
  c->stretch = j->stretch;
  c->closed = j->strips.closed;
  VG_TRY(find_lines(j, c, err));
done:
  return st;
}

/* Stretch the edges along thin strips. */
static vg_status stretch_strips(struct vg_remesh_job *j, struct vg_error *err)
{
  const size_t n = 3 * j->given->n_tri;
  const double *by = j->stretch ? j->stretch : j->o->stretch;

  j->along = vg_calloc(n, sizeof *j->along);
  if (!j->along) return vg_fail_memory(err, "the stretched feature curves");
  if (by) memcpy(j->along, by, n * sizeof *by);
  if (vg_strips_stretch(&j->ref, &j->curves, j->o->across, j->given->tri_patch,
                        j->along))
    return VG_OK;
  free(j->along);
  j->along = NULL;
  return VG_OK;
}

void vg_job_release_reference(struct vg_remesh_job *j)
{
  free(j->strip_cap);
  free(j->point_cap);
  free(j->stretch);
  free(j->along);
  j->strip_cap = j->point_cap = j->stretch = j->along = NULL;
  vg_curves_release(&j->curves);
  vg_ref_release(&j->ref);
  vg_strips_release(&j->strips);
  j->given = j->whole;
}

/* An arc of sagitta s and its chord enclose two thirds of s times the chord, so
 * that the area of a patch of width w, twice its area over the length of its
 * border, changes by up to 4 s / 3 w. */
static vg_status limit_tolerance(struct vg_remesh_job *j, struct vg_error *err)
{
  const double scale = j->o->scale * fmax(j->o->scale, 1);
  struct vg_ref *r = &j->ref;

  if (!j->kept) return VG_OK;
  r->fine = vg_alloc(r->n_tri, sizeof *r->fine);
  r->fine_at = vg_alloc(r->n_point, sizeof *r->fine_at);
  if (!r->fine || !r->fine_at)
    return vg_fail_memory(err, "the borders of the patches");
  for (size_t p = 0; p < r->n_point; p++) r->fine_at[p] = INFINITY;
  for (size_t t = 0; t < r->n_tri; t++) {
    const uint32_t patch = j->given->tri_patch[t];

    r->fine[t] = j->kept[patch] ? FINE * scale * j->width[patch] : INFINITY;
    for (int k = 0; k < 3; k++)
      r->fine_at[r->tri[t][k]] = fmin(r->fine_at[r->tri[t][k]], r->fine[t]);
  }
  return VG_OK;
}

/* Build the reference with its feature curves and sizes. */
vg_status vg_job_set_reference(struct vg_remesh_job *j, int closes,
                               struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  struct vg_curves_options c = { .angle = o->feature_angle,
                                 .tolerance = j->jag,
                                 .tri_patch = j->whole->tri_patch,
                                 .patch = j->whole->patch,
                                 .hard = o->hard,
                                 .kept = j->kept,
                                 .stretch = o->stretch,
                                 .still = o->still,
                                 .n_still = o->still ? j->whole->n_point : 0 };
  vg_status st;

  VG_TRY(find_lines(j, &c, err));
  if (closes) VG_TRY(close_strips(j, &c, err));
  VG_TRY(limit_tolerance(j, err));
  VG_TRY(find_sizes(j, err));
  if (!o->field && !j->closes_edges) VG_TRY(stretch_strips(j, err));
  if (j->looks) goto done;
  VG_TRY(check_number(j, err));
  VG_TRY(vg_ref_thin(&j->ref, (1 + VG_WORK_NEARER) * j->r.tolerance,
                     (1 + VG_WORK_NEARER) * VG_JOB_RELATIVE * j->r.h_max,
                     cap_of(j), o->threads, &o->stop, err));
done:
  return st;
}

/* --- small faults -------------------------------------------------------- */

/* New points are not still; the others have the first numbers, as before. */
static vg_status adopt_still(struct vg_remesh_job *j, const struct vg_mesh *m,
                             struct vg_error *err)
{
  const size_t n = j->whole->n_point;
  uint8_t *still = vg_calloc(m->n_point, 1);

  assert(m->n_point >= n);
  if (!still) return vg_fail_memory(err, "the sizes on the surface");
  memcpy(still, j->o->still, n);
  free(j->own_still);
  j->own_still = still;
  return VG_OK;
}

/* Replace the working surface by m, and the per-point and per-triangle options
 * by arrays for m. tri_from [n_tri] and half_from [3 n_tri] are the numbers in
 * the previous surface; VG_REF_NONE: new. */
static vg_status adopt(struct vg_remesh_job *j, struct vg_mesh *m,
                       const uint32_t *tri_from, const uint32_t *half_from,
                       double **cap, struct vg_error *err)
{
  const size_t n = 3 * m->n_tri;
  double *of_tri = NULL, *stretch = NULL;
  vg_status st = VG_OK;

  if (j->cap) of_tri = vg_alloc(m->n_tri, sizeof *of_tri);
  if (j->o->stretch) stretch = vg_calloc(n, sizeof *stretch);
  if ((j->cap && !of_tri) || (j->o->stretch && !stretch)) {
    free(of_tri);
    free(stretch);
    VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
  }
  for (size_t t = 0; of_tri && t < m->n_tri; t++)
    of_tri[t] = j->cap[tri_from[t]];
  for (size_t h = 0; stretch && h < n; h++) {
    const uint32_t from = half_from ? half_from[h]
                                    : 3 * tri_from[h / 3] + (uint32_t)(h % 3);

    if (from != VG_REF_NONE) stretch[h] = j->o->stretch[from];
  }
  if (j->o->still && adopt_still(j, m, err) < 0) {
    free(of_tri);
    free(stretch);
    return VG_ERR_MEMORY;
  }
  j->own = *j->o;
  j->own.cap = *cap;
  j->own.stretch = stretch;
  if (j->o->still) j->own.still = j->own_still;
  j->o = &j->own;
  free(j->cap);
  free(j->own_cap);
  free(j->own_stretch);
  j->cap = of_tri;
  j->own_cap = *cap;
  j->own_stretch = stretch;
  *cap = NULL;
  vg_mesh_release(&j->base);
  vg_mesh_move(&j->base, m);
  j->given = j->whole = &j->base;
done:
  return st;
}

static vg_status clean(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  const struct vg_curves_options lines = { .angle = o->feature_angle,
                                           .tolerance = j->jag,
                                           .tri_patch = j->whole->tri_patch,
                                           .patch = j->whole->patch,
                                           .hard = o->hard };
  struct vg_clean c = VG_CLEAN_INIT;
  double *cap = NULL;
  vg_status st;

  VG_TRY(vg_clean_find(j->whole,
                       &(struct vg_clean_options){ j->r.tolerance, &lines,
                                                   o->threads, o->stop },
                       &c, err));
  j->r.n_clean = c.n_collapse;
  memcpy(j->r.n_crossing, c.n_crossing, sizeof c.n_crossing);
  j->r.crossing_depth = c.depth;
  memcpy(j->r.crossing_at, c.at, sizeof c.at);
  if (!c.n_collapse && !c.n_flap && !c.n_swap && !c.n_crossing[0]) goto done;
  if (o->cap) {
    cap = vg_alloc(c.mesh.n_point, sizeof *cap);
    if (!cap) VG_TRY(vg_fail_memory(err, "the sizes on the surface"));
    for (size_t p = 0; p < c.mesh.n_point; p++)
      cap[p] = o->cap[c.point_from[p]];
  }
  VG_TRY(adopt(j, &c.mesh, c.tri_from, NULL, &cap, err));
done:
  free(cap);
  vg_clean_release(&c);
  return st;
}

/* --- long edges ----------------------------------------------------------- */

/* Edges of the input surface are split if they are long compared with the sizes
 * at their ends. Sizes are interpolated linearly within the input triangles, so
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

/* Number of pieces into which feature edge h must be split. */
static int pieces(const struct vg_remesh_job *j, uint32_t h)
{
  const uint8_t *still = j->o->still;
  double grown;

  if (still && still[vg_ref_from(&j->ref, h)] == VG_REMESH_KEPT &&
      still[vg_ref_to(&j->ref, h)] == VG_REMESH_KEPT)
    return 1;
  if (!(leap(j, h, &grown) > LEAP)) return 1;
  grown = edge_length(&j->ref, h) / grown;
  return grown < CUTS ? (int)grown + 2 : CUTS;
}

/* Is h the longest edge of its triangle that is not a feature edge? Of equal
 * edges it is the first. */
static int is_longest(const struct vg_remesh_job *j, uint32_t h)
{
  const double own = edge_length(&j->ref, h);

  for (uint32_t g = 3 * (h / 3); g < 3 * (h / 3) + 3; g++)
    if (g != h && !j->curves.line[g] &&
        (edge_length(&j->ref, g) > own ||
         (!(edge_length(&j->ref, g) < own) && g < h)))
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
  VG_TRY(adopt(j, &s.mesh, s.tri_from, s.half_from, &cap, err));
  VG_TRY(vg_job_set_reference(j, !j->has_kept, err));
done:
  free(n);
  free(cap);
  vg_strips_release(&s);
  return st;
}

static int has_long_lines(const struct vg_remesh_job *j)
{
  for (uint32_t h = 0; h < 3 * j->ref.n_tri; h++)
    if (j->curves.line[h] && pieces(j, h) > 1) return 1;
  return 0;
}

/* Bisect edges inside plane faces as long as this saves triangles. */
static vg_status bisect_edges(struct vg_remesh_job *j, struct vg_error *err)
{
  int any = 1;
  vg_status st = VG_OK;

  for (int i = 0; i < ROUNDS && any && j->whole->n_tri < MOST_CUT; i++) {
    const double n = j->n_expected;

    VG_TRY(cut_edges(j, 0, &any, err));
    if (any && j->n_expected > GAIN_INSIDE * n) break;
  }
done:
  return st;
}

/* --- fixed patches -------------------------------------------------------- */

static vg_status keep_fixed(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_mesh *m = j->whole;

  if (!j->o->fixed || j->looks) return VG_OK;
  j->keep = vg_calloc(m->n_point, 1);
  if (!j->keep) return vg_fail_memory(err, "the remeshed surface");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && j->o->fixed[m->tri_patch[t]]; k++)
      j->keep[m->tri[t][k]] = VG_WORK_FIXED;
  for (size_t p = 0; p < m->n_point; p++) j->n_keep += j->keep[p] != 0;
  j->no_cuts = 1;
  return VG_OK;
}

/* Marks the ends of feature edges that stay. */
static vg_status keep_lines(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_mesh *m = j->whole;

  if (!j->has_kept || j->looks) return VG_OK;
  j->keep = vg_calloc(m->n_point, 1);
  if (!j->keep) return vg_fail_memory(err, "the remeshed surface");
  for (size_t p = 0; p < m->n_point; p++) {
    if (j->o->still[p] == VG_REMESH_KEPT) j->keep[p] = VG_WORK_LINE;
    j->n_keep += j->keep[p] != 0;
  }
  return VG_OK;
}

/* --- borders between patches --------------------------------------------- */

static vg_status keep_borders(struct vg_remesh_job *j, struct vg_error *err)
{
  if (!j->o->keeps_borders || j->frees_borders) return VG_OK;
  j->kept = vg_calloc(j->whole->n_patch, 1);
  j->width = vg_alloc(j->whole->n_patch, sizeof *j->width);
  if (!j->kept || !j->width)
    return vg_fail_memory(err, "the borders of the patches");
  /* Sizes above j->far occur on an outer boundary only. */
  return vg_borders_keep(j->whole, j->far > 0 ? j->far : j->r.h_max,
                         vg_cosine(j->o->feature_angle), j->kept, j->width,
                         err);
}

/* --- preparation ---------------------------------------------------------- */

/* Prepare j, in which only the surface and options are set. */
static vg_status prepare(struct vg_remesh_job *j, int cuts,
                         struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  vg_status st;

  assert(!o->still || (!o->is_reference && !o->fixed));
  j->has_kept = o->still && memchr(o->still, VG_REMESH_KEPT, j->whole->n_point);
  VG_TRY(settle(j, err));
  VG_TRY(vg_stopped(&o->stop, err));
  VG_TRY(keep_borders(j, err));
  j->source = vg_alloc(o->n_source, sizeof *j->source);
  if (!j->source) VG_TRY(vg_fail_memory(err, "the sources"));
  if (o->n_source)
    memcpy(j->source, o->source, o->n_source * sizeof *j->source);
  j->n_source = j->cap_source = o->n_source;
  if (o->is_reference && !j->looks) VG_TRY(clean(j, err));
  VG_TRY(keep_fixed(j, err));
  VG_TRY(vg_job_set_reference(j, !j->looks && !o->fixed && !j->has_kept, err));
  if (j->looks || o->fixed) goto done;
  if (cuts) VG_TRY(cut_edges(j, 1, &j->is_cut, err));
  VG_TRY(bisect_edges(j, err));
  VG_TRY(keep_lines(j, err));
done:
  return st;
}

static vg_status restart(struct vg_remesh_job *j, const struct vg_mesh *m,
                         const struct vg_remesh_options *o, int cuts,
                         struct vg_error *err)
{
  vg_job_release(j);
  j->cap = j->own_cap = j->own_stretch = NULL;
  j->own_still = NULL;
  j->kept = NULL;
  j->width = NULL;
  j->source = NULL;
  j->keep = NULL;
  j->n_source = j->cap_source = j->n_keep = 0;
  j->given = j->whole = m;
  j->o = o;
  j->is_cut = 0;
  return prepare(j, cuts, err);
}

/* Feature edges are split if this saves enough triangles. */
vg_status vg_job_restart(struct vg_remesh_job *j, const struct vg_mesh *m,
                         const struct vg_remesh_options *o, int no_cuts,
                         struct vg_error *err)
{
  double n;
  vg_status st;

  j->no_cuts = no_cuts;
  VG_TRY(restart(j, m, o, 0, err));
  if (j->looks || j->no_cuts || !has_long_lines(j)) goto done;
  n = j->n_expected;
  VG_TRY(restart(j, m, o, 1, err));
  if (j->is_cut && j->n_expected > GAIN * n) VG_TRY(restart(j, m, o, 0, err));
done:
  return st;
}

vg_status vg_job_prepare(struct vg_remesh_job *j, struct vg_error *err)
{
  return vg_job_restart(j, j->whole, j->o, j->no_cuts, err);
}

void vg_job_release(struct vg_remesh_job *j)
{
  free(j->cap);
  free(j->source);
  free(j->own_cap);
  free(j->own_stretch);
  free(j->own_still);
  free(j->kept);
  free(j->width);
  free(j->keep);
  vg_job_release_reference(j);
  vg_mesh_release(&j->base);
}
