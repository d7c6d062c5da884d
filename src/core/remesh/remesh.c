/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the input surface becomes the reference; its feature curves and
 * sizes are computed. A copy is changed pass by pass, and the result is checked
 * like any surface before meshing. Each change examines its neighbourhood
 * only, so that distant triangles may intersect afterwards. There the triangles
 * are made smaller; if that does not help, everything is repeated with these
 * sizes. */
#include "core/remesh/remesh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/mesh_defects.h"
#include "core/remesh/blocks.h"
#include "core/remesh/job.h"
#include "core/remesh/passes.h"
#include "core/remesh/result.h"
#include "core/remesh/sizes.h"
#include "core/remesh/stretch.h"
#include "core/sizing/sizing_source.h"
#include "core/surface/surface_check.h"

#define ROUNDS                                                                 \
  2 /* S31: attempts while triangles intersect; 1 for a faulty input */
#define KEEPS                                                                  \
  7 /* S48: further attempts, in which input triangles are kept; each doubles  \
       the neighbourhood */
#define DEEP 3.0  /* S31: of the tolerance: depth of hopeless intersections */
#define MENDS 4   /* in each attempt: smaller triangles at intersections */
#define FEW 64    /* intersections that are mended in the first attempts */
#define SPOTS 256 /* most spots added at a time */
#define SPOT_LEAST 0.0625 /* S34: of h_min: least size at a spot */
#define FLAT 0.1 /* of the tolerance: flat triangles swapped at the end */
#define BAD                                                                    \
  0.005 /* S47: largest share of triangles below VG_REMESH_BAD: more are worse \
           than small sizes all along an edge */
#define PHASES 2    /* of blocks, before the whole surface */
#define EVEN 2      /* sweeps along curves in each round in a metric */
#define ROUGH 1     /* rounds of smoothing on levels with enlarged sizes */
#define HALVINGS 64 /* most rounds of splitting needles */
#define NEAR 2      /* rounds in which much too long edges wait */
#define POLISH2                                                                \
  0.46 /* S21: (sin 42.7 degrees)^2: below, triangles are polished */
#define CHURN                                                                  \
  6.0 /* S104: points inserted into a block per expected point; an attempt     \
         that inserts more has failed */
#define POLISHES 2 /* rounds, and one more after the last smoothing */

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

/* --- checks of the input -------------------------------------------------- */

static vg_status check_surface(const struct vg_mesh *m, struct vg_error *err)
{
  if (!m->n_tri || m->n_quad)
    return vg_fail(err, VG_ERR_INPUT,
                   "only a surface of triangles can be remeshed: this one "
                   "has %zu triangles and %zu quadrilaterals",
                   m->n_tri, m->n_quad);
  if (m->n_tri > UINT32_MAX / 24)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%zu triangles are too many to be remeshed", m->n_tri);
  for (size_t i = 0; i < m->n_point; i++)
    if (!isfinite(m->point[i][0] + m->point[i][1] + m->point[i][2]))
      return vg_fail(err, VG_ERR_INPUT,
                     "point %zu of the surface is not "
                     "finite; repair the surface",
                     i + 1);
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (m->tri[i / 3][i % 3] >= m->n_point)
      return vg_fail(err, VG_ERR_INPUT,
                     "triangle %zu of the surface uses "
                     "point %zu of %zu; repair the surface",
                     i / 3 + 1, (size_t)m->tri[i / 3][i % 3] + 1, m->n_point);
  return VG_OK;
}

static vg_status check_options(const struct vg_remesh_options *o,
                               struct vg_error *err)
{
  if (!(o->tolerance >= 0 && o->accuracy >= 0 && o->h_min >= 0 &&
        o->h_max >= 0 &&
        isfinite(o->tolerance + o->accuracy + o->h_min + o->h_max)))
    return vg_fail(err, VG_ERR_INPUT,
                   "tolerance %g, accuracy %g and sizes %g and %g of the "
                   "remeshed surface must be finite and not negative; 0 "
                   "selects a value from the length of the body",
                   o->tolerance, o->accuracy, o->h_min, o->h_max);
  if (!(o->scale > 0 && o->scale <= 1e4))
    return vg_fail(err, VG_ERR_INPUT,
                   "size scale %g is out of range (above 0, at most 1e4)",
                   o->scale);
  if (o->h_max > 0 && o->h_min > o->h_max)
    return vg_fail(err, VG_ERR_INPUT,
                   "smallest size %g is above the largest, "
                   "%g; exchange them",
                   o->h_min, o->h_max);
  if (!(o->feature_angle >= 5 && o->feature_angle <= 170 && o->per_turn >= 3 &&
        o->per_turn <= 1e4 && o->growth > 1 && o->growth <= 10))
    return vg_fail(err, VG_ERR_INPUT,
                   "feature angle %g (5 to 170 degrees), %g edges per turn "
                   "(3 to 10000) or growth %g (above 1, at most 10) is out "
                   "of range",
                   o->feature_angle, o->per_turn, o->growth);
  return VG_OK;
}

static vg_status check_stretch(const struct vg_mesh *m, const double *stretch,
                               struct vg_error *err)
{
  for (size_t h = 0; stretch && h < 3 * m->n_tri; h++)
    if (!(stretch[h] >= 0 && stretch[h] <= VG_REMESH_STRETCH) &&
        stretch[h] != VG_REMESH_FEATURE)
      return vg_fail(err, VG_ERR_INPUT,
                     "edge %zu of triangle %zu: stretching ratio %g is out "
                     "of range (0 to %d)",
                     h % 3 + 1, h / 3 + 1, stretch[h], VG_REMESH_STRETCH);
  return VG_OK;
}

static int has_stretch(const double *by, size_t n)
{
  for (size_t h = 0; by && h < n; h++)
    if (by[h] > 0) return 1;
  return 0;
}

/* --- one attempt ---------------------------------------------------------- */

/* Split edges until none is much too long. */
static vg_status halve(void *user, struct vg_tris *w, struct vg_error *err)
{
  size_t n = 1, n_gone;
  vg_status st = VG_OK;

  (void)user;
  vg_pass_curves(w);
  vg_pass_swap(w);
  VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n_gone, err));
  /* Halves of needles are collapsed before they are split again. */
  for (int i = 0; n && i < HALVINGS; i++) {
    VG_TRY(vg_pass_split(w, 2 * VG_WORK_SHORT * VG_WORK_LONG, VG_SPLIT_LONGEST,
                         &n, err));
    VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n_gone, err));
  }
done:
  return st;
}

static vg_status change_block(void *user, struct vg_tris *w,
                              struct vg_error *err)
{
  size_t n;
  vg_status st;

  VG_TRY(halve(user, w, err));
  for (int i = 0; i < 4; i++) {
    const int near = i < NEAR || w->is_block;

    if (w->field) vg_pass_even(w, EVEN);
    vg_pass_smooth(w, 1);
    VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n, err));
    VG_TRY(vg_pass_split(w, VG_WORK_LONG, near ? VG_SPLIT_NEAR : VG_SPLIT_ALL,
                         &n, err));
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

/* Triangles near a block border in one phase are inside a block in the next.
 * Those near borders in both phases are left to a single thread. */
static vg_status run(struct vg_remesh_job *j, struct vg_tris *w,
                     vg_block_body body, struct vg_error *err)
{
  const size_t n = vg_blocks_number(w);
  vg_status st;

  for (int phase = 0; n > 1 && phase < PHASES && !w->ends; phase++)
    VG_TRY(
      vg_blocks_run(w, n + (size_t)phase, phase, j->o->threads, body, j, err));
  VG_TRY(body(j, w, err));
done:
  return st;
}

/* A level in which sizes are still enlarged: triangles need not have their
 * final quality. */
static vg_status change_roughly(void *user, struct vg_tris *w,
                                struct vg_error *err)
{
  size_t n;
  vg_status st;

  VG_TRY(halve(user, w, err));
  for (int i = 0; i < ROUGH; i++) {
    vg_pass_even(w, EVEN);
    vg_pass_smooth(w, 1);
    VG_TRY(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n, err));
    VG_TRY(vg_pass_split(w, VG_WORK_LONG, VG_SPLIT_NEAR, &n, err));
  }
  vg_pass_smooth(w, 1);
done:
  return st;
}

/* Edges are first split everywhere: next to large triangles, as at block
 * borders, points would otherwise be inserted and removed repeatedly. */
static vg_status change(struct vg_remesh_job *j, struct vg_tris *w,
                        struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_pass_divide(w, j->o->threads, err));
  for (double factor = w->coarse; factor > 1; factor /= 2) {
    VG_TRY(run(j, w, change_roughly, err));
    VG_TRY(vg_tris_set_level(w, factor / 2, err));
  }
  VG_TRY(run(j, w, halve, err));
  VG_TRY(run(j, w, change_block, err));
done:
  return st;
}

static double source_size(const void *user, const double x[3])
{
  return vg_source_at(user, x);
}

/* --- intersections of the remeshed surface -------------------------------- */

static int is_fault(const struct vg_defect *d)
{
  return d->kind != VG_DEFECT_OPEN_EDGE && d->kind != VG_DEFECT_SHELL &&
         d->kind != VG_DEFECT_NO_BC;
}

/* Request smaller triangles at face f. */
static vg_status add_spot(struct vg_remesh_job *j, const struct vg_mesh *m,
                          size_t f, struct vg_error *err)
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

/* Keep the input triangles within the distance of face f. Adds the number of
 * points that are newly kept to *n_new. */
static vg_status keep_near(struct vg_remesh_job *j, const struct vg_mesh *m,
                           size_t f, double distance, size_t *n_new,
                           struct vg_error *err)
{
  struct vg_box box = VG_BOX_EMPTY;
  uint32_t *tri;
  size_t n;

  for (int k = 0; k < 3; k++) vg_box_add(&box, m->point[m->tri[f][k]]);
  n = vg_ref_around(&j->ref, &box, distance, 0, NULL);
  tri = vg_alloc(n, sizeof *tri);
  if (!tri) return vg_fail_memory(err, "the remeshed surface");
  vg_ref_around(&j->ref, &box, distance, n, tri);
  for (size_t i = 0; i < 3 * n; i++) {
    uint8_t *keep = &j->keep[j->ref.tri[tri[i / 3]][i % 3]];

    *n_new += !*keep;
    if (!*keep) *keep = VG_WORK_KEPT;
  }
  free(tri);
  return VG_OK;
}

static double edge_of(const struct vg_mesh *m, size_t f)
{
  double most = 0;

  for (int k = 0; k < 3; k++)
    most = fmax(most, vg_distance(m->point[m->tri[f][k]],
                                  m->point[m->tri[f][(k + 1) % 3]]));
  return most;
}

static vg_status keep_around(struct vg_remesh_job *j, const struct vg_mesh *m,
                             const struct vg_surface_report *r, double rings,
                             struct vg_error *err)
{
  vg_status st = VG_OK;
  size_t n = 0;

  if (!j->keep) j->keep = vg_calloc(j->whole->n_point, 1);
  if (!j->keep) return vg_fail_memory(err, "the remeshed surface");
  for (size_t i = 0; i < r->n_defect; i++)
    for (int k = 0; k < 2; k++) {
      const struct vg_defect *d = &r->defect[i];

      if (!is_fault(d) || d->face[k] == SIZE_MAX) continue;
      if (!j->n_keep && !n) memcpy(j->r.kept_at, d->at, sizeof d->at);
      VG_TRY(
        keep_near(j, m, d->face[k], rings * edge_of(m, d->face[k]), &n, err));
    }
  j->n_keep += n;
  j->is_all_kept = !n;
done:
  return st;
}

static vg_status refuse_crossing(const struct vg_remesh_job *j,
                                 const double at[3], struct vg_error *err)
{
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "near (%g, %g, %g) the surface intersects itself by more than "
                 "the remeshing tolerance %g: repair the model there",
                 at[0], at[1], at[2], j->r.tolerance);
}

static vg_status refuse(const struct vg_remesh_job *j,
                        const struct vg_defect *d, struct vg_error *err)
{
  if (j->r.n_crossing[1]) return refuse_crossing(j, d->at, err);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "near (%g, %g, %g) remeshed triangles intersect at all "
                 "sizes that were tried (%s): give a smaller "
                 "surface_tolerance, or mesh the surface without remeshing it",
                 d->at[0], d->at[1], d->at[2], vg_defect_name(d->kind));
}

/* Check that the remeshed surface is as sound as the input. If it is not, add
 * spots at its faults, or with rings > 0 keep the input triangles there. */
static vg_status is_sound(struct vg_remesh_job *j, struct vg_mesh *m, int last,
                          double rings, int *sound, struct vg_error *err)
{
  struct vg_surface_check_options o = { .threads = j->o->threads,
                                        .stop = j->o->stop };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_surface_check(m, &o, &r, err));
  j->n_fault[0] = j->n_fault[1];
  j->n_fault[1] = r.count[VG_DEFECT_INTERSECTION];
  for (size_t i = 0; i < r.n_defect; i++) {
    const struct vg_defect *d = &r.defect[i];

    if (!is_fault(d)) continue;
    if (last) VG_TRY(refuse(j, d, err));
    if (n++ >= SPOTS || rings > 0) break;
    for (int k = 0; k < 2; k++)
      if (d->face[k] != SIZE_MAX) VG_TRY(add_spot(j, m, d->face[k], err));
  }
  if (n && rings > 0) VG_TRY(keep_around(j, m, &r, rings, err));
  *sound = !n;
done:
  vg_surface_report_release(&r);
  return st;
}

/* Clear the members that the next attempt sets. */
static void clear_report(struct vg_remesh_report *r)
{
  const struct vg_remesh_report kept = *r;

  free(r->bad);
  *r = (struct vg_remesh_report){ .length = kept.length,
                                  .tolerance = kept.tolerance,
                                  .far = kept.far,
                                  .h_min = kept.h_min,
                                  .h_max = kept.h_max,
                                  .n_round = kept.n_round + 1,
                                  .n_clean = kept.n_clean,
                                  .n_crossing = { kept.n_crossing[0],
                                                  kept.n_crossing[1] },
                                  .crossing_depth = kept.crossing_depth };
  memcpy(r->kept_at, kept.kept_at, sizeof r->kept_at);
  memcpy(r->crossing_at, kept.crossing_at, sizeof r->crossing_at);
}

/* --- whole surface -------------------------------------------------------- */

static vg_status ask_sources(const struct vg_remesh_job *j, struct vg_tris *w,
                             struct vg_source_set *set, struct vg_error *err)
{
  const struct vg_sizing_options s = {
    .growth = vg_scaled_growth(j->o->growth, j->o->scale), .scale = j->o->scale
  };
  /* A field contains the sources of the options. */
  const size_t first = j->o->field ? j->o->n_source : 0;
  const struct vg_size_map *map = j->o->field ? NULL : j->o->map;
  vg_status st = VG_OK;

  vg_source_release(set);
  if (j->n_source == first && !map) return VG_OK;
  VG_TRY(vg_source_check(j->n_source - first, j->source + first, err));
  VG_TRY(
    vg_source_prepare(&s, j->n_source - first, j->source + first, 1, set, err));
  set->map = map;
  w->other_size = source_size;
  w->user = set;
done:
  return st;
}

/* Mark triangles as changed where sources now request smaller sizes. */
static void narrow(struct vg_tris *w)
{
  if (!w->other_size) return;
  for (size_t p = 0; p < w->n_point; p++) {
    struct vg_tris_point *q = &w->point[p];
    double h;

    if (q->half == VG_REF_NONE) continue;
    h = w->other_size(w->user, q->x);
    if (h < w->h_min) h = w->h_min;
    if (!(h < q->asked.size)) continue;
    if (w->field) vg_tris_ask(w, q, h);
    q->asked.size = h;
    vg_tris_find_room(w, q);
    q->changed = ++w->clock;
  }
  for (uint32_t t = 0; t < w->n_tri; t++)
    if (!vg_tris_is_old(w, 3 * t, w->looked[VG_WORK_POLISH]) ||
        !vg_tris_is_old(w, 3 * t + 1, w->looked[VG_WORK_POLISH]))
      w->stamp[t] = w->clock;
}

static double angle_of(const struct vg_mesh *m, size_t t)
{
  const double sine2 = vg_form_shape(NULL, m->point[m->tri[t][0]],
                                     m->point[m->tri[t][1]],
                                     m->point[m->tri[t][2]]);

  return asin(fmin(sqrt(sine2), 1)) * (180 / M_PI); /* for the report only */
}

/* Swap flat triangles of the remeshed surface, and update the report. */
static vg_status swap_flat(struct vg_remesh_job *j, struct vg_mesh *m,
                           struct vg_error *err)
{
  struct vg_remesh_report *r = &j->r;
  size_t n = 0;
  vg_status st;

  if (j->along || j->stretch || j->o->stretch || j->o->field) return VG_OK;
  VG_TRY(vg_flat_swap(m, &(struct vg_flat_limit){ FLAT * r->tolerance, j->far },
                      &j->n_flat, err));
  if (!j->n_flat) goto done;
  r->angle_min = 60;
  for (size_t t = 0; t < m->n_tri; t++)
    r->angle_min = fmin(r->angle_min, angle_of(m, t));
  memset(r->cause, 0, sizeof r->cause);
  for (size_t i = 0; i < r->n_bad; i++) {
    r->bad[i].angle = angle_of(m, r->bad[i].face);
    if (r->bad[i].angle >= VG_REMESH_BAD) continue;
    r->cause[r->bad[i].cause]++;
    r->bad[n++] = r->bad[i];
  }
  r->n_bad = n;
done:
  return st;
}

/* One attempt: how often intersecting triangles are made smaller, whether
 * failure is final, the width of the neighbourhood in which input triangles are
 * kept next, in edges of the intersecting triangles, the largest number of
 * intersections at which triangles are made smaller, 0: any number, and whether
 * an attempt that inserts points again and again ends. */
struct attempt {
  int mends, last;
  double rings;
  size_t few;
  int is_bounded;
};

/* Remesh once. Intersecting triangles are made smaller; if that does not help,
 * *sound is 0. */
static vg_status make(struct vg_remesh_job *j, struct vg_mesh *out,
                      const struct attempt *a, int *sound, struct vg_error *err)
{
  struct vg_source_set set = VG_SOURCE_SET_INIT;
  struct vg_stretch stretch = { .by = j->along   ? j->along
                                    : j->stretch ? j->stretch
                                                 : j->o->stretch };
  struct vg_remesh_report *r = &j->r;
  struct vg_tris w = { .ref = &j->ref,
                       .curves = &j->curves,
                       .tolerance = r->tolerance,
                       .relative = VG_JOB_RELATIVE,
                       .far = j->far,
                       .field = j->o->field,
                       .coarse = 1,
                       .h_min = r->h_min,
                       .h_max = r->h_max,
                       .churn = a->is_bounded ? CHURN : 0,
                       .threads = j->o->threads,
                       .keep = j->keep,
                       .stop = j->o->stop };
  vg_status st;

  if (has_stretch(stretch.by, 3 * j->ref.n_tri)) w.stretch = &stretch;
  VG_TRY(ask_sources(j, &w, &set, err));
  if (j->n_source > j->o->n_source) w.h_min *= SPOT_LEAST;
  if (!j->looks) w.coarse = 1 << vg_sizes_levels(&j->ref, w.field, r->h_max);
  VG_TRY(vg_tris_begin(&w, err));
  if (!j->looks) VG_TRY(change(j, &w, err));
  if (w.is_over) j->n_fault[1] = SIZE_MAX;
  if (w.is_over && a->last) VG_TRY(refuse_crossing(j, r->crossing_at, err));
  for (int mend = 0; !w.is_over && !*sound && mend < a->mends; mend++) {
    const int is_end = mend + 1 == a->mends;

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
    VG_TRY(swap_flat(j, out, err));
    VG_TRY(
      is_sound(j, out, a->last && is_end, is_end ? a->rings : 0, sound, err));
    if (a->few && j->n_fault[1] > a->few) break;
    if (!mend || *sound || j->n_fault[1] <= j->n_fault[0]) continue;
    /* Smaller triangles have caused more intersections. */
    if (a->rings > 0 && !is_end)
      VG_TRY(is_sound(j, out, a->last, a->rings, sound, err));
    break;
  }
  r->n_split = w.n_split;
  r->n_collapse = w.n_collapse;
  r->n_swap = w.n_swap + j->n_flat;
  r->n_move = w.n_move;
done:
  vg_tris_release(&w);
  vg_stretch_release(&stretch);
  vg_source_release(&set);
  return st;
}

/* New triangles still intersect: keep more and more of the input triangles
 * there, at the requested sizes. */
static vg_status keep(struct vg_remesh_job *j, struct vg_mesh *out,
                      struct vg_error *err)
{
  int sound = 0;
  vg_status st = VG_OK;

  j->n_source = j->o->n_source;
  for (int i = 1; !sound; i++) {
    const struct attempt a = { 1, i == KEEPS || j->is_all_kept, 1 << i, 0, 0 };

    VG_TRY(make(j, out, &a, &sound, err));
  }
  for (size_t t = 0; t < j->whole->n_tri; t++) {
    const uint32_t *v = j->whole->tri[t];

    j->r.n_kept += j->keep[v[0]] && j->keep[v[1]] && j->keep[v[2]];
  }
done:
  return st;
}

/* Attempt to remesh; only few intersections are mended. *poor: the result
 * has many poor triangles. */
static vg_status try_once(struct vg_remesh_job *j, struct vg_mesh *out,
                          int *sound, int *poor, struct vg_error *err)
{
  const struct attempt once = { MENDS, 0, 0, FEW, 1 };
  size_t n_bad;
  vg_status st;

  VG_TRY(make(j, out, &once, sound, err));
  /* Triangles of thin strips are needles. */
  n_bad = j->r.n_bad - (j->along ? j->r.cause[VG_REMESH_STRIP] : 0);
  *poor = (double)n_bad > BAD * (double)out->n_tri;
done:
  return st;
}

/* Attempt to remesh the given surface m with options o as prepared. Larger
 * sizes at midpoints of long feature edges may cause intersections or poor
 * triangles, or prevent needles next to a sharp edge of zero thickness from
 * being split: the attempt is then repeated without them. */
static vg_status try_cuts(struct vg_remesh_job *j, const struct vg_mesh *m,
                          const struct vg_remesh_options *o,
                          struct vg_mesh *out, int *sound, struct vg_error *err)
{
  int poor;
  vg_status st;

  VG_TRY(try_once(j, out, sound, &poor, err));
  if (!j->is_cut || (*sound && !poor)) goto done;
  *sound = 0;
  VG_TRY(vg_job_restart(j, m, o, 1, err));
  VG_TRY(try_once(j, out, sound, &poor, err));
done:
  return st;
}

/* Attempts in which triangles are made smaller and input triangles are kept. */
static vg_status repeat(struct vg_remesh_job *j, struct vg_mesh *out,
                        struct vg_error *err)
{
  const int rounds = j->r.n_crossing[0] ? 1 : ROUNDS;
  const int hopeless = j->r.n_crossing[1] > 0;
  size_t left = 0;
  int sound = 0;
  vg_status st = VG_OK;

  for (int round = 1; !sound && round <= rounds; round++) {
    const struct attempt a = { hopeless ? 1 : MENDS, hopeless,
                               !j->strips.n && round == rounds ? 1 : 0, 0, 1 };

    VG_TRY(make(j, out, &a, &sound, err));
    if (sound || !j->strips.n) continue;
    /* Closed strips may have caused the intersections: start again without
     * them. */
    left = j->strips.n;
    vg_job_release_reference(j);
    VG_TRY(vg_job_set_reference(j, 0, err));
    j->n_source = j->o->n_source;
    round = 0;
  }
  if (!sound) VG_TRY(keep(j, out, err));
  j->r.n_left = left;
done:
  return st;
}

/* All attempts. Those that keep the borders between patches and the strips of
 * thin edges come first. The others start again without both. */
static vg_status attempt_all(struct vg_remesh_job *j, const struct vg_mesh *m,
                             const struct vg_remesh_options *o,
                             struct vg_mesh *out, struct vg_error *err)
{
  const int hopeless = j->r.n_crossing[1] > 0;
  const int has_more = j->kept || j->along || j->strips.has_edges;
  int sound = 0;
  vg_status st = VG_OK;

  /* No change within the tolerance separates such parts. */
  if (hopeless && j->r.crossing_depth > DEEP * j->r.tolerance)
    return refuse_crossing(j, j->r.crossing_at, err);
  if (o->course == VG_REMESH_FIRST ||
      (o->course == VG_REMESH_ALL && has_more && !hopeless)) {
    VG_TRY(try_cuts(j, m, o, out, &sound, err));
    if (!sound && o->course == VG_REMESH_FIRST) return VG_BLOCKED;
  }
  if (!sound && has_more && !hopeless) {
    j->frees_borders = j->closes_edges = 1;
    VG_TRY(vg_job_restart(j, m, o, j->no_cuts, err));
  }
  if (!sound && j->is_cut && !hopeless)
    VG_TRY(try_cuts(j, m, o, out, &sound, err));
  if (!sound) VG_TRY(repeat(j, out, err));
done:
  return st;
}

/* Complete the report on input m and result out. */
static void tell(struct vg_remesh_job *j, const struct vg_mesh *m,
                 const struct vg_mesh *out, struct vg_remesh_report *report)
{
  j->r.n_intersection = j->n_fault[1];
  j->r.n_tri[0] = m->n_tri;
  j->r.n_tri[1] = out->n_tri;
  j->r.n_point[0] = m->n_point;
  j->r.n_point[1] = out->n_point;
  j->r.keeps_borders = j->kept != NULL;
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

vg_status vg_remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                    struct vg_remesh_report *report, struct vg_error *err)
{
  struct vg_remesh_job j = { .whole = m, .given = m, .o = o };
  struct vg_mesh out = VG_MESH_INIT;
  vg_status st;

  assert(m && o);
  VG_TRY(check_surface(m, err));
  VG_TRY(check_options(o, err));
  VG_TRY(check_stretch(m, o->stretch, err));
  VG_TRY(vg_job_prepare(&j, err));
  st = attempt_all(&j, m, o, &out, err);
  if (st < 0) goto done;
  tell(&j, m, &out, report);
  if (st == VG_BLOCKED) goto done;
  if (VG_CHECKS_ON && !vg_mesh_open_edges(m))
    VG_CHECK("the remeshing of a surface", vg_mesh_open_edges(&out));
  vg_mesh_move(m, &out);
done:
  free(j.r.bad);
  vg_job_release(&j);
  vg_mesh_release(&out);
  return st;
}

vg_status vg_remesh_judge(const struct vg_mesh *m,
                          const struct vg_remesh_options *o,
                          struct vg_remesh_report *report, struct vg_error *err)
{
  struct vg_remesh_job j = { .whole = m, .given = m, .o = o, .looks = 1 };
  struct vg_mesh out = VG_MESH_INIT;
  int sound = 0;
  vg_status st;

  assert(m && o);
  VG_TRY(check_surface(m, err));
  VG_TRY(check_options(o, err));
  VG_TRY(check_stretch(m, o->stretch, err));
  VG_TRY(vg_job_prepare(&j, err));
  VG_TRY(make(&j, &out, &(struct attempt){ 1, 0, 0, 0, 0 }, &sound, err));
  tell(&j, m, &out, report);
done:
  free(j.r.bad);
  vg_job_release(&j);
  vg_mesh_release(&out);
  return st;
}

vg_status vg_remesh_sizes(const struct vg_mesh *m,
                          const struct vg_remesh_options *o, double *size,
                          struct vg_error *err)
{
  struct vg_remesh_job j = { .whole = m, .given = m, .o = o, .looks = 1 };
  vg_status st;

  VG_TRY(check_surface(m, err));
  VG_TRY(check_options(o, err));
  VG_TRY(check_stretch(m, o->stretch, err));
  VG_TRY(vg_job_prepare(&j, err));
  for (size_t p = 0; p < m->n_point; p++)
    size[p] = fmin(fmax(j.ref.size[p], j.r.h_min), j.r.h_max);
done:
  vg_job_release(&j);
  return st;
}
