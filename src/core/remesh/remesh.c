/* Outline: the surface as given becomes a reference; its lines and sizes are
 * found; a copy is changed pass by pass; the outcome is checked as any surface
 * that is to be meshed. Where triangles meet, which changes cannot see that
 * look around themselves only, those there are made smaller; should that not
 * help, all is done again with these sizes. */
#include "core/remesh/remesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/blocks.h"
#include "core/remesh/passes.h"
#include "core/remesh/result.h"
#include "core/remesh/sizes.h"
#include "core/remesh/stretch.h"
#include "core/remesh/strips.h"
#include "core/sizing/sizing_source.h"
#include "core/surface/envelope.h"
#include "core/surface/surface_check.h"

#define TOLERANCE 1e-4    /* S20: of the body's length */
#define RELATIVE 0.05     /* of the size */
#define CHORD 0.6         /* of the tolerance: what sizes allow for arcs */
#define NOISE 3.0         /* S43: of the accuracy of what is given: sizes that
                             follow from it alone */
#define H_MAX 0.02        /* of the length */
#define H_MIN 2e-4        /* twice the tolerance */
#define H_OUTER 0.04      /* of the domain's length */
#define OUTER 0.9         /* S27: of the triangles of a patch: all of it is */
#define TRIANGLES 3e8     /* more are refused */
#define ROUNDS 3          /* S31: from the beginning, until triangles no longer
                             meet */
#define MENDS 4           /* in each: more and more triangles where they do */
#define SPOTS 256         /* of them at a time */
#define SPOT_LEAST 0.0625 /* S34: of h_min: sizes there */
#define PHASES 2          /* of blocks, then the whole */
#define HALVINGS 16       /* of needles, at most */
#define POLISH2 0.46      /* S21: (sin 42.7 degrees)^2: below, triangles are
                             polished one by one */
#define POLISHES 2        /* and once more after the last smoothing */

struct job {
  const struct vg_mesh *whole;  /* as given */
  const struct vg_mesh *given;  /* the same, or with strips that are closed */
  const struct vg_remesh_options *o;
  struct vg_remesh_report r;
  struct vg_ref ref;
  struct vg_curves curves;
  struct vg_strips strips;  /* closed ones; then given is their mesh */
  double *strip_cap;        /* cap with strips; or NULL */
  double *cap;              /* [n_tri] largest size, or NULL */
  double *point_cap;        /* [n_point] the same, with strips; or NULL */
  double *stretch;          /* [3 n_tri] that of the options, with strips */
  double jag;               /* tolerance of lines, the same at any scale */
  double far;               /* larger sizes are on an outer boundary only;
                               0: there is none */
  struct vg_source *source; /* those of the options, then spots */
  size_t n_source, cap_source;
  int looks;                /* nothing is changed */
};

static const char *const cause_names[] = { "corner", "strip", "line",
                                           "surface" };

const char *vg_remesh_cause_name(enum vg_remesh_cause c)
{
  return cause_names[c];
}

void vg_remesh_report_release(struct vg_remesh_report *r)
{
  free(r->bad);
  memset(r, 0, sizeof *r);
}

/* --- what is asked for --------------------------------------------------- */

static vg_status check_surface(const struct vg_mesh *m, struct vg_error *err)
{
  if (!m->n_tri || m->n_quad)
    return vg_fail(err, VG_ERR_INPUT, "a surface of triangles is needed: this "
                   "has %zu, and %zu quadrilaterals", m->n_tri, m->n_quad);
  if (m->n_tri > UINT32_MAX / 24)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%zu triangles are too many to be "
                   "made anew", m->n_tri);
  for (size_t i = 0; i < m->n_point; i++)
    if (!isfinite(m->point[i][0] + m->point[i][1] + m->point[i][2]))
      return vg_fail(err, VG_ERR_INPUT, "point %zu of the surface is not "
                     "finite; repair the surface", i + 1);
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (m->tri[i / 3][i % 3] >= m->n_point)
      return vg_fail(err, VG_ERR_INPUT, "triangle %zu of the surface uses "
                     "point %zu of %zu; repair the surface", i / 3 + 1,
                     (size_t)m->tri[i / 3][i % 3] + 1, m->n_point);
  return VG_OK;
}

static vg_status check_options(const struct vg_remesh_options *o,
                               struct vg_error *err)
{
  if (!(o->tolerance >= 0 && o->accuracy >= 0 && o->h_min >= 0
        && o->h_max >= 0
        && isfinite(o->tolerance + o->accuracy + o->h_min + o->h_max)))
    return vg_fail(err, VG_ERR_INPUT, "tolerance %g, accuracy %g and sizes %g, "
                   "%g of the new surface must be lengths; 0: by the body",
                   o->tolerance, o->accuracy, o->h_min, o->h_max);
  if (!(o->scale > 0 && o->scale <= 1e4))
    return vg_fail(err, VG_ERR_INPUT, "scale %g of sizes is out of range (0 "
                   "to 1e4)", o->scale);
  if (o->h_max > 0 && o->h_min > o->h_max)
    return vg_fail(err, VG_ERR_INPUT, "smallest size %g is above the largest, "
                   "%g; exchange them", o->h_min, o->h_max);
  if (!(o->ridge_angle >= 5 && o->ridge_angle <= 170 && o->per_turn >= 3
        && o->per_turn <= 1e4 && o->growth > 1 && o->growth <= 10))
    return vg_fail(err, VG_ERR_INPUT, "ridge angle %g (5 to 170 degrees), %g "
                   "edges per turn (3 to 10000) or growth %g (1 to 10) is out "
                   "of range", o->ridge_angle, o->per_turn, o->growth);
  return VG_OK;
}

static vg_status check_stretch(const struct vg_mesh *m, const double *stretch,
                               struct vg_error *err)
{
  for (size_t h = 0; stretch && h < 3 * m->n_tri; h++)
    if (!(stretch[h] >= 0 && stretch[h] <= VG_REMESH_STRETCH))
      return vg_fail(err, VG_ERR_INPUT, "edges along edge %zu of triangle %zu "
                     "are to be %g times as long as across it: 1 to %d is "
                     "possible", h % 3 + 1, h / 3 + 1, stretch[h],
                     VG_REMESH_STRETCH);
  return VG_OK;
}

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

/* A patch that is outer but for a sliver or two is outer: one of them would
 * make the body as long as the domain. */
static vg_status complete_outer(const struct vg_mesh *m, uint8_t *outer,
                                struct vg_error *err)
{
  size_t (*n)[2] = vg_calloc(m->n_patch, sizeof *n);

  if (!n) return vg_fail_memory(err, "the patches");
  for (size_t t = 0; t < m->n_tri; t++) n[m->tri_patch[t]][!!outer[t]]++;
  for (size_t t = 0; t < m->n_tri; t++) {
    const size_t *of = n[m->tri_patch[t]];

    if ((double)of[1] >= OUTER * (double)(of[0] + of[1])) outer[t] = 1;
  }
  free(n);
  return VG_OK;
}

/* Lengths by the body; the outer boundary of a whole domain has its own. */
static vg_status settle(struct job *j, struct vg_error *err)
{
  const struct vg_mesh *m = j->given;
  struct vg_remesh_report *r = &j->r;
  struct vg_envelope e;
  uint8_t *outer = vg_alloc(m->n_tri, 1);
  double whole = length_of(m, NULL);
  vg_status st = VG_OK;

  if (!outer) VG_TRY(vg_fail_memory(err, "the outer boundary"));
  VG_TRY(vg_envelope_measure(m, outer, &e, err));
  if (e.is_domain) VG_TRY(complete_outer(m, outer, err));
  r->length = e.is_domain ? length_of(m, outer) : whole;
  if (!(r->length > 0)) r->length = whole;
  j->jag = j->o->tolerance > 0 ? j->o->tolerance
           : fmax(TOLERANCE * r->length, j->o->accuracy);
  r->tolerance = j->jag * j->o->scale * fmax(j->o->scale, 1);
  r->h_max = j->o->h_max > 0 ? j->o->h_max : H_MAX * r->length;
  if (e.is_domain) {
    j->far = fmin(r->h_max, H_MAX * r->length);
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
  r->h_min *= j->o->scale;
done:
  free(outer);
  return st;
}

/* Sizes in another unit would ask for more triangles than fit anywhere. */
static vg_status check_number(const struct job *j, struct vg_error *err)
{
  const struct vg_ref *r = &j->ref;
  double n = 0, size;

  for (size_t t = 0; t < r->n_tri; t++) {
    double x[3];

    vg_cross(r->shape[t].u, r->shape[t].v, x);
    size = (r->size[r->tri[t][0]] + r->size[r->tri[t][1]]
            + r->size[r->tri[t][2]]) / 3;
    n += vg_norm(x) / (0.8660254037844386 * size * size);
  }
  if (n < TRIANGLES) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "the new surface would have some %.2g "
                 "triangles; are sizes and tolerance in its unit?", n);
}

static const double *cap_of(const struct job *j)
{
  return j->strip_cap ? j->strip_cap : j->cap;
}

static vg_status find_lines(struct job *j, const struct vg_curves_options *c,
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

static vg_status find_sizes(struct job *j, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  vg_status st;

  VG_TRY(vg_ref_add_tree(&j->ref, &o->stop, err));
  VG_TRY(vg_stopped(&o->stop, err));
  VG_TRY(vg_sizes_make(&j->ref, &j->curves, &(struct vg_sizes_options){
    o->per_turn / o->scale, CHORD * j->jag * o->scale * o->scale, o->scale,
    j->r.h_min, j->r.h_max, NOISE * o->accuracy * o->scale,
    vg_scaled_growth(o->growth, o->scale), cap_of(j),
    j->point_cap ? j->point_cap : o->cap, o->across, j->given->tri_patch,
    o->stop }, err));
done:
  return st;
}

/* Largest sizes of the mesh with the points where strips are cut. */
static vg_status extend_caps(struct job *j, struct vg_error *err)
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

static vg_status extend_stretch(struct job *j, struct vg_error *err)
{
  const struct vg_strips *s = &j->strips;
  const size_t n = 3 * s->mesh.n_tri;

  if (!j->o->stretch) return VG_OK;
  j->stretch = vg_calloc(n, sizeof *j->stretch);
  if (!j->stretch) return vg_fail_memory(err, "the lines that are stretched");
  for (size_t h = 0; h < n; h++)
    if (s->half_from[h] != VG_REF_NONE)
      j->stretch[h] = j->o->stretch[s->half_from[h]];
  return VG_OK;
}

/* Where strips are closed, lines are found again without them. */
static vg_status close_strips(struct job *j, struct vg_curves_options *c,
                              struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_strips_find(&j->ref, &j->curves, j->given,
    &(struct vg_strips_options){ j->r.tolerance, j->o->across, c },
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

static void release_reference(struct job *j)
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

/* The reference with its lines and sizes. */
static vg_status set_reference(struct job *j, int closes, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  struct vg_curves_options c = { o->ridge_angle, j->jag, j->whole->tri_patch,
    j->whole->patch, o->hard, o->stretch, NULL };
  vg_status st;

  VG_TRY(find_lines(j, &c, err));
  if (closes) VG_TRY(close_strips(j, &c, err));
  VG_TRY(find_sizes(j, err));
  if (j->looks) goto done;
  VG_TRY(check_number(j, err));
  VG_TRY(vg_ref_thin(&j->ref, (1 + VG_WORK_NEARER) * j->r.tolerance,
                     (1 + VG_WORK_NEARER) * RELATIVE * j->r.h_max, cap_of(j),
                     o->threads, &o->stop, err));
done:
  return st;
}

static vg_status prepare(struct job *j, struct vg_error *err)
{
  const struct vg_remesh_options *o = j->o;
  vg_status st;

  VG_TRY(check_stretch(j->given, o->stretch, err));
  VG_TRY(settle(j, err));
  VG_TRY(vg_stopped(&o->stop, err));
  j->source = vg_alloc(o->n_source, sizeof *j->source);
  if (!j->source) VG_TRY(vg_fail_memory(err, "the sources"));
  if (o->n_source)
    memcpy(j->source, o->source, o->n_source * sizeof *j->source);
  j->n_source = j->cap_source = o->n_source;
  VG_TRY(set_reference(j, !j->looks, err));
done:
  return st;
}

/* --- one round ----------------------------------------------------------- */

/* Until no edge is much too long. */
static vg_status halve(void *user, struct vg_work *w, struct vg_error *err)
{
  size_t n = 1, n_gone;
  vg_status st = VG_OK;

  (void)user;
  vg_pass_curves(w);
  vg_pass_swap(w);
  VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n_gone, err));
  /* Halves of needles collapse before they are halved again. */
  for (int i = 0; n && i < HALVINGS; i++) {
    VG_TRY(vg_pass_split(w, 2 * VG_WORK_SHORT * VG_WORK_LONG, 1, &n, err));
    VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n_gone, err));
  }
done:
  return st;
}

static vg_status change_block(void *user, struct vg_work *w,
                              struct vg_error *err)
{
  size_t n;
  vg_status st;

  VG_TRY(halve(user, w, err));
  for (int i = 0; i < 4; i++) {
    vg_pass_smooth(w, 1);
    VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n, err));
    VG_TRY(vg_pass_split(w, VG_WORK_LONG, 0, &n, err));
  }
  vg_pass_smooth(w, 2);
  vg_pass_swap(w);
  for (int i = 0; i < POLISHES; i++) {
    VG_TRY(vg_pass_polish(w, POLISH2, &n, err));
    vg_pass_swap(w);
    vg_pass_smooth(w, 1);
  }
  VG_TRY(vg_pass_polish(w, POLISH2, &n, err));
done:
  return st;
}

/* What is near the border of a block in one phase is inside one in the next;
 * what is near both is left to one thread. */
static vg_status run(struct job *j, struct vg_work *w, vg_block_body body,
                     struct vg_error *err)
{
  const size_t n = vg_blocks_number(w);
  vg_status st;

  for (int phase = 0; n > 1 && phase < PHASES; phase++)
    VG_TRY(vg_blocks_run(w, n + (size_t)phase, phase, j->o->threads, body, j,
                         err));
  VG_TRY(body(j, w, err));
done:
  return st;
}

/* Edges are halved everywhere before anything else is done: beside large
 * triangles, where borders are, points would come and go. */
static vg_status change(struct job *j, struct vg_work *w, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_pass_divide(w, j->o->threads, err));
  VG_TRY(run(j, w, halve, err));
  VG_TRY(run(j, w, change_block, err));
done:
  return st;
}

static double source_size(const void *user, const double x[3])
{
  return vg_source_at(user, x);
}

/* --- whether triangles meet ---------------------------------------------- */

/* Ask for smaller triangles where face f is. */
static vg_status add_spot(struct job *j, const struct vg_mesh *m, size_t f,
                          struct vg_error *err)
{
  struct vg_source s = { .kind = VG_SOURCE_POINT };
  const double *p[3];
  double edge = 0;

  for (int k = 0; k < 3; k++) p[k] = m->point[m->tri[f][k]];
  for (int k = 0; k < 3; k++) {
    edge = fmax(edge, vg_distance(p[k], p[(k + 1) % 3]));
    s.p0[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
  }
  s.r0 = edge;
  s.h0 = s.h1 = fmax(edge / 2, SPOT_LEAST * j->r.h_min) / j->o->scale;
  if (vg_reserve(&j->source, &j->cap_source, j->n_source + 1,
                 sizeof *j->source))
    return vg_fail_memory(err, "the sources");
  j->source[j->n_source++] = s;
  return VG_OK;
}

/* Whether the new surface is as sound as the one given; else spots are added
 * where it is not. */
static vg_status is_sound(struct job *j, struct vg_mesh *m, int last,
                          int *sound, struct vg_error *err)
{
  struct vg_surface_check_options o = { .threads = j->o->threads,
                                        .stop = j->o->stop };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_surface_check(m, &o, &r, err));
  for (size_t i = 0; i < r.n_defect; i++) {
    const struct vg_defect *d = &r.defect[i];

    if (d->kind == VG_DEFECT_OPEN_EDGE || d->kind == VG_DEFECT_SHELL
        || d->kind == VG_DEFECT_NO_BC) continue;
    if (last) {
      st = vg_fail(err, VG_ERR_GEOMETRY, "near (%g, %g, %g) new triangles "
                   "meet however small they are (%s): give a smaller "
                   "surface_tolerance, or mesh the surface as it is",
                   d->at[0], d->at[1], d->at[2], vg_defect_name(d->kind));
      goto done;
    }
    if (n++ >= SPOTS) break;
    for (int k = 0; k < 2; k++)
      if (d->face[k] != SIZE_MAX)
        VG_TRY(add_spot(j, m, d->face[k], err));
  }
  *sound = !n;
done:
  vg_surface_report_release(&r);
  return st;
}

/* What the next outcome says anew. */
static void clear_report(struct vg_remesh_report *r)
{
  const struct vg_remesh_report kept = *r;

  free(r->bad);
  *r = (struct vg_remesh_report){ .length = kept.length,
    .tolerance = kept.tolerance, .h_min = kept.h_min, .h_max = kept.h_max,
    .n_round = kept.n_round + 1 };
}

/* --- all ----------------------------------------------------------------- */

static vg_status ask_sources(const struct job *j, struct vg_work *w,
                             struct vg_source_set *set, struct vg_error *err)
{
  const struct vg_sizing_options s = {
    .growth = vg_scaled_growth(j->o->growth, j->o->scale),
    .scale = j->o->scale };
  vg_status st = VG_OK;

  vg_source_release(set);
  if (!j->n_source && !j->o->map) return VG_OK;
  VG_TRY(vg_source_check(j->n_source, j->source, err));
  VG_TRY(vg_source_prepare(&s, j->n_source, j->source, 1, set, err));
  set->map = j->o->map;
  w->other_size = source_size;
  w->user = set;
done:
  return st;
}

/* Where the sources have become finer, triangles count as changed. */
static void narrow(struct vg_work *w)
{
  if (!w->other_size) return;
  for (size_t p = 0; p < w->n_point; p++) {
    struct vg_work_point *q = &w->point[p];
    double h;

    if (q->half == VG_REF_NONE) continue;
    h = w->other_size(w->user, q->x);
    if (h < w->h_min) h = w->h_min;
    if (!(h < q->asked.size)) continue;
    q->asked.size = h;
    vg_work_find_room(w, q);
    q->changed = ++w->clock;
  }
  for (uint32_t t = 0; t < w->n_tri; t++)
    if (!vg_work_is_old(w, 3 * t, w->looked[VG_WORK_POLISH])
        || !vg_work_is_old(w, 3 * t + 1, w->looked[VG_WORK_POLISH]))
      w->stamp[t] = w->clock;
}

/* Triangles that meet are made smaller where they are; should that not help,
 * *sound is 0. */
static vg_status make(struct job *j, struct vg_mesh *out, int last, int *sound,
                      struct vg_error *err)
{
  struct vg_source_set set = VG_SOURCE_SET_INIT;
  struct vg_stretch stretch = {
    .by = j->stretch ? j->stretch : j->o->stretch };
  struct vg_remesh_report *r = &j->r;
  struct vg_work w = { .ref = &j->ref, .curves = &j->curves,
    .tolerance = r->tolerance, .relative = RELATIVE, .far = j->far,
    .h_min = r->h_min, .h_max = r->h_max, .threads = j->o->threads,
    .stop = j->o->stop };
  vg_status st;

  if (stretch.by) w.stretch = &stretch;
  VG_TRY(ask_sources(j, &w, &set, err));
  if (j->n_source > j->o->n_source) w.h_min *= SPOT_LEAST;
  VG_TRY(vg_work_begin(&w, err));
  if (!j->looks) VG_TRY(change(j, &w, err));
  for (int mend = 0; !*sound && mend < MENDS; mend++) {
    if (mend) {
      w.h_min = SPOT_LEAST * r->h_min;
      VG_TRY(ask_sources(j, &w, &set, err));
      narrow(&w);
      VG_TRY(change_block(j, &w, err));
    }
    clear_report(r);
    vg_mesh_release(out);
    VG_TRY(vg_result_store(&w, j->given, out, r, err));
    if (j->looks) break;
    VG_TRY(is_sound(j, out, last && mend + 1 == MENDS, sound, err));
  }
  r->n_split = w.n_split;
  r->n_collapse = w.n_collapse;
  r->n_swap = w.n_swap;
  r->n_move = w.n_move;
done:
  vg_work_release(&w);
  vg_stretch_release(&stretch);
  vg_source_release(&set);
  return st;
}

static vg_status repeat(struct job *j, struct vg_mesh *out,
                        struct vg_error *err)
{
  size_t left = 0;
  int sound = 0;
  vg_status st = VG_OK;

  for (int round = 1; !sound; round++) {
    VG_TRY(make(j, out, round == ROUNDS && !j->strips.n, &sound, err));
    if (sound || !j->strips.n) continue;
    /* They may be what made triangles meet: all again without. */
    left = j->strips.n;
    release_reference(j);
    VG_TRY(set_reference(j, 0, err));
    j->n_source = j->o->n_source;
    round = 0;
  }
  j->r.n_left = left;
done:
  return st;
}

/* Of m, which was given, and what came out. */
static void tell(struct job *j, const struct vg_mesh *m,
                 const struct vg_mesh *out, struct vg_remesh_report *report)
{
  j->r.n_tri[0] = m->n_tri;
  j->r.n_tri[1] = out->n_tri;
  j->r.n_point[0] = m->n_point;
  j->r.n_point[1] = out->n_point;
  j->r.n_corner = j->curves.n_corner;
  j->r.n_line = j->curves.n_curve;
  j->r.line_length[0] = j->curves.length;
  j->r.n_closed = j->strips.n;
  j->r.closed_length = j->strips.length;
  j->r.closed_width = j->strips.widest;
  memcpy(j->r.closed_at, j->strips.at, sizeof j->r.closed_at);
  if (!report) return;
  vg_remesh_report_release(report);
  *report = j->r;
  j->r.bad = NULL;
}

static void release(struct job *j)
{
  free(j->r.bad);
  free(j->cap);
  free(j->source);
  release_reference(j);
}

vg_status vg_remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                    struct vg_remesh_report *report, struct vg_error *err)
{
  struct job j = { .whole = m, .given = m, .o = o };
  struct vg_mesh out = VG_MESH_INIT;
  vg_status st;

  VG_TRY(check_surface(m, err));
  VG_TRY(check_options(o, err));
  VG_TRY(prepare(&j, err));
  VG_TRY(repeat(&j, &out, err));
  tell(&j, m, &out, report);
  vg_mesh_move(m, &out);
done:
  release(&j);
  vg_mesh_release(&out);
  return st;
}

vg_status vg_remesh_judge(const struct vg_mesh *m,
                          const struct vg_remesh_options *o,
                          struct vg_remesh_report *report,
                          struct vg_error *err)
{
  struct job j = { .whole = m, .given = m, .o = o, .looks = 1 };
  struct vg_mesh out = VG_MESH_INIT;
  int sound = 0;
  vg_status st;

  VG_TRY(check_surface(m, err));
  VG_TRY(check_options(o, err));
  VG_TRY(prepare(&j, err));
  VG_TRY(make(&j, &out, 0, &sound, err));
  tell(&j, m, &out, report);
done:
  release(&j);
  vg_mesh_release(&out);
  return st;
}
