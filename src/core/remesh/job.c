/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: remove small faults of the input surface, find feature curves, close
 * narrow strips, and compute the sizing field. Long feature edges are split if
 * the sizes at their ends do not represent the size at their midpoint. Feature
 * curves and sizes are then computed again. */
#include "core/remesh/job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/borders.h"
#include "core/remesh/sizes.h"
#include "core/remesh/work.h"
#include "core/sizing/sizing_source.h"
#include "core/surface/envelope.h"

#define TOLERANCE 1e-4 /* S20: of the body's length */
#define CHORD 0.6    /* of the tolerance: sagitta of an arc that sizes allow */
#define NOISE 3.0    /* S43: of the accuracy: least size from the shape alone */
#define H_MAX 0.02   /* of the length of the body */
#define H_MIN 2e-4   /* of the length: twice the tolerance */
#define H_OUTER 0.04 /* of the length of the domain */
#define OUTER 0.9    /* S27: share of a patch's triangles that makes it outer */
#define TRIANGLES 3e8 /* limit of the estimated number of new triangles */

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
      j->cap[t] = outer[t] ? INFINITY : j->far;
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

/* Refuse sizes that would give more triangles than any computer can hold. The
 * usual reason is another unit of length. */
static vg_status check_number(const struct vg_remesh_job *j,
                              struct vg_error *err)
{
  const struct vg_ref *r = &j->ref;
  double n = 0, size;

  for (size_t t = 0; t < r->n_tri; t++) {
    double x[3];

    vg_cross(r->shape[t].u, r->shape[t].v, x);
    size = (r->size[r->tri[t][0]] + r->size[r->tri[t][1]] +
            r->size[r->tri[t][2]]) /
           3;
    n += vg_norm(x) / (0.8660254037844386 * size * size);
  }
  if (n < TRIANGLES) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the remeshed surface would have some %.2g triangles; check "
                 "that sizes and tolerance are in the unit of the surface",
                 n);
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
  VG_TRY(vg_sizes_make(&j->ref, &j->curves,
                       &(struct vg_sizes_options){
                         o->per_turn / o->scale,
                         CHORD * j->jag * o->scale * o->scale, o->scale,
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

  VG_TRY(vg_strips_find(&j->ref, &j->curves, j->given,
                        &(struct vg_strips_options){ j->r.tolerance,
                                                     j->o->across, c },
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

void vg_job_release_reference(struct vg_remesh_job *j)
{
  free(j->strip_cap);
  free(j->point_cap);
  free(j->stretch);
  j->strip_cap = j->point_cap = j->stretch = NULL;
  vg_curves_release(&j->curves);
  vg_ref_release(&j->ref);
  vg_strips_release(&j->strips);
  j->given = j->whole;
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
                                 .stretch = o->stretch };
  vg_status st;

  VG_TRY(find_lines(j, &c, err));
  if (closes) VG_TRY(close_strips(j, &c, err));
  VG_TRY(find_sizes(j, err));
  if (j->looks) goto done;
  VG_TRY(check_number(j, err));
  VG_TRY(vg_ref_thin(&j->ref, (1 + VG_WORK_NEARER) * j->r.tolerance,
                     (1 + VG_WORK_NEARER) * VG_JOB_RELATIVE * j->r.h_max,
                     cap_of(j), o->threads, &o->stop, err));
done:
  return st;
}

/* --- small faults -------------------------------------------------------- */

vg_status vg_job_adopt(struct vg_remesh_job *j, struct vg_mesh *m,
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
  j->own = *j->o;
  j->own.cap = *cap;
  j->own.stretch = stretch;
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
  VG_TRY(vg_job_adopt(j, &c.mesh, c.tri_from, NULL, &cap, err));
done:
  free(cap);
  vg_clean_release(&c);
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

/* --- borders between patches --------------------------------------------- */

static vg_status keep_borders(struct vg_remesh_job *j, struct vg_error *err)
{
  if (!j->o->keeps_borders || j->frees_borders) return VG_OK;
  j->kept = vg_calloc(j->whole->n_patch, 1);
  if (!j->kept) return vg_fail_memory(err, "the borders of the patches");
  return vg_borders_keep(j->whole, j->r.h_max, j->kept, err);
}

/* --- preparation ---------------------------------------------------------- */

vg_status vg_job_prepare(struct vg_remesh_job *j, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  vg_status st;

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
  VG_TRY(vg_job_set_reference(j, !j->looks && !o->fixed, err));
  if (!j->looks && !o->fixed) VG_TRY(vg_job_cut_edges(j, err));
done:
  return st;
}

vg_status vg_job_restart(struct vg_remesh_job *j, const struct vg_mesh *m,
                         const struct vg_remesh_options *o, int no_cuts,
                         struct vg_error *err)
{
  vg_job_release(j);
  j->cap = j->own_cap = j->own_stretch = NULL;
  j->kept = NULL;
  j->source = NULL;
  j->keep = NULL;
  j->n_source = j->cap_source = j->n_keep = 0;
  j->given = j->whole = m;
  j->o = o;
  j->is_cut = 0;
  j->no_cuts = no_cuts;
  return vg_job_prepare(j, err);
}

void vg_job_release(struct vg_remesh_job *j)
{
  free(j->cap);
  free(j->source);
  free(j->own_cap);
  free(j->own_stretch);
  free(j->kept);
  free(j->keep);
  vg_job_release_reference(j);
  vg_mesh_release(&j->base);
}
