/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The table `surface`: target edge lengths of single patches, curves, leading
 * edges and strips of a surface to be remeshed, as largest sizes at its current
 * points, and curves along which edges are stretched. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/search/box.h"
#include "core/wake/trailing.h"
#include "run/input/cones.h"
#include "run/input/shape_parts.h"
#include "run/settings/patch_names.h"
#include "run/settings/surface_table.h"

#define SECTIONS 256 /* Number of sections along the span of a patch. */

static void lower(double *cap, uint32_t p, double size)
{
  cap[p] = fmin(cap[p], size);
}

/* --- curves -------------------------------------------------------------- */

struct side {
  uint32_t lo, hi, patch, half;
};

static int by_ends(const void *pa, const void *pb)
{
  const struct side *a = pa, *b = pb;

  if (a->lo != b->lo) return a->lo < b->lo ? -1 : 1;
  if (a->hi != b->hi) return a->hi < b->hi ? -1 : 1;
  return (a->patch > b->patch) - (a->patch < b->patch);
}

/* Whether an edge lies between a patch with on[][0] and one with on[][1]. */
static int is_between(const uint8_t (*on)[2], uint32_t p, uint32_t q)
{
  return p != q && ((on[p][0] && on[q][1]) || (on[p][1] && on[q][0]));
}

static vg_status size_curve(const struct vg_mesh *m, const uint8_t (*on)[2],
                            double size, double stretch,
                            struct vg_surface_sizes *to, size_t *n_edge,
                            struct vg_error *err)
{
  struct side *s = vg_alloc(3 * m->n_tri, sizeof *s);
  size_t n = 0;

  *n_edge = 0;

  if (!s) return vg_fail_memory(err, "the edges of two patches");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = m->tri[t][k], q = m->tri[t][(k + 1) % 3];

      if (!on[m->tri_patch[t]][0] && !on[m->tri_patch[t]][1]) continue;
      s[n++] = (struct side){ p < q ? p : q, p < q ? q : p, m->tri_patch[t],
                              (uint32_t)(3 * t) + (uint32_t)k };
    }
  qsort(s, n, sizeof *s, by_ends);
  for (size_t i = 1; i < n; i++)
    if (s[i].lo == s[i - 1].lo && s[i].hi == s[i - 1].hi &&
        is_between(on, s[i].patch, s[i - 1].patch)) {
      lower(to->cap, s[i].lo, size);
      lower(to->cap, s[i].hi, size);
      for (size_t j = i - 1; stretch > 0 && j <= i; j++)
        to->stretch[s[j].half] = stretch;
      ++*n_edge;
    }
  free(s);
  return VG_OK;
}

/* --- leading edges ------------------------------------------------------- */

/* Range of x, from `lo` to `hi`, of a patch in sections normal to y or z,
 * whichever of its extents is larger; the flow is along x. */
struct sections {
  int axis;
  double from, step;
  double lo[SECTIONS], hi[SECTIONS];
};

static double section_at(const struct sections *s, size_t i)
{
  return s->from + s->step * ((double)i + 0.5);
}

/* Extends the sections that the line ab crosses. */
static void cross(struct sections *s, const double *a, const double *b)
{
  const double *l = a[s->axis] < b[s->axis] ? a : b, *h = l == a ? b : a;
  double first = (l[s->axis] - s->from) / s->step - 0.5;

  for (size_t i = first > 0 ? (size_t)ceil(first) : 0; i < SECTIONS; i++) {
    double at = section_at(s, i), t, x;

    if (at > h[s->axis]) break;
    t = (at - l[s->axis]) / (h[s->axis] - l[s->axis]);
    x = isfinite(t) ? l[0] + t * (h[0] - l[0]) : l[0];
    s->lo[i] = fmin(s->lo[i], x);
    s->hi[i] = fmax(s->hi[i], x);
  }
}

static void cut(struct sections *s, const struct vg_mesh *m, size_t patch)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++)
      for (int d = 0; d < 3; d++) {
        lo[d] = fmin(lo[d], m->point[m->tri[t][k]][d]);
        hi[d] = fmax(hi[d], m->point[m->tri[t][k]][d]);
      }
  s->axis = hi[1] - lo[1] >= hi[2] - lo[2] ? 1 : 2;
  s->from = lo[s->axis];
  s->step = (hi[s->axis] - s->from) / SECTIONS;
  for (int i = 0; i < SECTIONS; i++) s->lo[i] = INFINITY, s->hi[i] = -INFINITY;
  for (size_t t = 0; t < m->n_tri && s->step > 0; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++)
      cross(s, m->point[m->tri[t][k]], m->point[m->tri[t][(k + 1) % 3]]);
}

/* Chord of the patch at x, and distance of x behind its leading edge. */
static int chord_at(const struct sections *s, const double x[3], double *chord,
                    double *behind)
{
  double at = (x[s->axis] - s->from) / s->step - 0.5, t;
  size_t i = at > 0 ? (size_t)at : 0;

  if (!(s->step > 0)) return 0;
  if (i > SECTIONS - 2) i = SECTIONS - 2;
  t = at - (double)i;
  if (!(s->hi[i] >= s->lo[i] && s->hi[i + 1] >= s->lo[i + 1])) return 0;
  *behind = x[0] - (s->lo[i] + t * (s->lo[i + 1] - s->lo[i]));
  *chord = s->hi[i] - s->lo[i] +
           t * (s->hi[i + 1] - s->lo[i + 1] - s->hi[i] + s->lo[i]);
  return *chord > 0;
}

static void size_lead(const struct vg_mesh *m, size_t patch, double share,
                      double growth, double *cap)
{
  struct sections s;

  cut(&s, m, patch);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++) {
      uint32_t p = m->tri[t][k];
      double chord, behind;

      if (chord_at(&s, m->point[p], &chord, &behind))
        lower(cap, p, share * chord + (growth - 1) * fmax(behind, 0));
    }
}

/* --- trailing edges ------------------------------------------------------ */

/* Trailing edges of the surface for the stream along x. */
static vg_status find_trailing(const struct vg_boundary *b,
                               struct vg_trailing *t, struct vg_error *err)
{
  const double along_x[3] = { 1, 0, 0 };
  const struct vg_mesh *m = &b->surface;
  uint8_t *is_body = vg_alloc(m->n_patch, 1);
  vg_status st;

  if (!is_body) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_patch; i++)
    is_body[i] = !vg_patch_is_outer(&m->patch[i]);
  st = vg_trailing_find(m, is_body, b->flow.kind == VG_FLOW_INTERNAL, along_x,
                        t, err);
  free(is_body);
  return st;
}

/* Lower the sizes at the trailing edges of the patches with on[][0]. */
static vg_status size_trail(const struct vg_boundary *b,
                            const struct vg_surface_row *row,
                            const uint8_t (*on)[2], double *cap,
                            struct vg_error *err)
{
  struct vg_trailing t = VG_TRAILING_INIT;
  char name[2 * VG_NAME_MAX + 4];
  size_t n = 0;
  vg_status st = find_trailing(b, &t, err);

  for (size_t i = 0; i < t.n; i++) {
    const struct vg_trailing_edge *e = &t.edge[i];

    if (!on[e->patch[0]][0] && !on[e->patch[1]][0]) continue;
    for (int k = 0; k < 2; k++) lower(cap, e->point[k], row->trail * e->chord);
    n++;
  }
  vg_trailing_release(&t);
  if (st < 0 || n) return st;
  vg_param_format(&vg_surface_table.column[0], row, name, sizeof name);
  return vg_fail(err, VG_ERR_INPUT,
                 "surface: patch %s has no trailing edge for the stream along "
                 "x, which `trail` refers to; give the size of the curve "
                 "between its patches instead (adjacent, size)",
                 name);
}

/* --- the ends of a span --------------------------------------------------- */

/*   middle       root                             tip
 *     |           o--------------------------------o
 *     |           |                                |     axis y or z
 *     +-----------o--------------------------------o--->
 *     |<--------------- semispan ----------------->|
 */

/* Squared cosine between the normal of a triangle and the axis of the span:
 * triangles above are in a cut or a cap, not along the span. */
#define FACES_SPAN2 0.5
/* Of the semispan: distance of the sections from the ends, which need not be in
 * a plane. */
#define INSET 1e-3

/* Distances from `middle` along the axis. */
struct span {
  int axis, crosses; /* 1: the patch is on both sides of the middle. */
  double middle, root, tip;
};

static double distance_along(const struct span *s, const double x[3])
{
  return fabs(x[s->axis] - s->middle);
}

/* The middle of a half model is its symmetry plane; that of others is the
 * middle of the body. */
static double find_middle(const struct vg_boundary *b, int axis)
{
  const struct vg_mesh *m = &b->surface;
  double lo = INFINITY, hi = -INFINITY;

  if (b->flow.axis == axis) return b->flow.at;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      if (vg_patch_is_outer(&m->patch[m->tri_patch[t]])) break;
      lo = fmin(lo, m->point[m->tri[t][k]][axis]);
      hi = fmax(hi, m->point[m->tri[t][k]][axis]);
    }
  return 0.5 * (lo + hi);
}

/* The span of the patches with mark[patch] 1. */
static struct span find_span(const struct vg_boundary *b, const uint8_t *mark)
{
  const struct vg_mesh *m = &b->surface;
  struct vg_box box = VG_BOX_EMPTY;
  struct span s = { .root = INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && mark[m->tri_patch[t]]; k++)
      vg_box_add(&box, m->point[m->tri[t][k]]);
  if (b->flow.axis > 0) s.axis = b->flow.axis;
  else s.axis = box.hi[1] - box.lo[1] >= box.hi[2] - box.lo[2] ? 1 : 2;
  s.middle = find_middle(b, s.axis);
  s.tip = fmax(distance_along(&s, box.lo), distance_along(&s, box.hi));
  s.crosses = b->flow.axis != s.axis && box.lo[s.axis] < s.middle &&
              box.hi[s.axis] > s.middle;
  s.root = s.crosses
           ? 0
           : fmin(distance_along(&s, box.lo), distance_along(&s, box.hi));
  return s;
}

/* The point of edge pq in a plane normal to the span. */
static int cut_edge(const struct span *s, double plane, const double *p,
                    const double *q, double x[3])
{
  const double d = p[s->axis] - plane, e = q[s->axis] - plane;

  if ((d < 0) == (e < 0)) return 0;
  for (int k = 0; k < 3; k++) x[k] = p[k] + d / (d - e) * (q[k] - p[k]);
  return 1;
}

/* Lines along the section of the patches in a plane. */
static vg_status add_section(const struct vg_mesh *m, const uint8_t *mark,
                             const struct span *s, double plane, double size,
                             struct vg_surface_sizes *to, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t t = 0; t < m->n_tri && st >= 0; t++) {
    struct vg_source line = { .kind = VG_SOURCE_LINE, .h0 = size, .h1 = size };
    double *const end[] = { line.p0, line.p1 };
    int n = 0;

    if (!mark[m->tri_patch[t]]) continue;
    for (int k = 0; k < 3 && n < 2; k++)
      n += cut_edge(s, plane, m->point[m->tri[t][k]],
                    m->point[m->tri[t][(k + 1) % 3]], end[n]);
    if (n == 2) st = vg_surface_sizes_add(to, &line, err);
  }
  return st;
}

/* Sections at a distance from the middle, on both sides of it. */
static vg_status add_sections(const struct vg_mesh *m, const uint8_t *mark,
                              const struct span *s, double at, double size,
                              struct vg_surface_sizes *to, struct vg_error *err)
{
  vg_status st = add_section(m, mark, s, s->middle + at, size, to, err);

  if (st < 0 || !(at > 0)) return st;
  return add_section(m, mark, s, s->middle - at, size, to, err);
}

static vg_status span_sizes(const struct vg_boundary *b, const uint8_t *mark,
                            double root, double tip,
                            struct vg_surface_sizes *to, struct vg_error *err)
{
  const struct span s = find_span(b, mark);
  const double inset = INSET * s.tip;
  vg_status st = VG_OK;

  if (root > 0)
    st = add_sections(&b->surface, mark, &s, s.crosses ? 0 : s.root + inset,
                      root * s.tip, to, err);
  if (tip > 0 && st >= 0)
    st = add_sections(&b->surface, mark, &s, s.tip - inset, tip * s.tip, to,
                      err);
  return st;
}

/* Is triangle t in a cut or a cap? */
static int faces_span(const struct vg_mesh *m, size_t t, const struct span *s)
{
  double u[3], v[3], area[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, area);
  return area[s->axis] * area[s->axis] > FACES_SPAN2 * vg_dot(area, area);
}

/* Extent along the span of the triangles of the patches with a point closer to
 * the end than half the requested edge length, over the semispan. */
static void measure_triangles(const struct vg_mesh *m, const uint8_t *mark,
                              const struct span *s, double end, double share,
                              int caps, struct vg_edge_spacing *to)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    double lo = INFINITY, hi = 0, least = INFINITY;

    if (!mark[m->tri_patch[t]] || (!caps && faces_span(m, t, s))) continue;
    for (int k = 0; k < 3; k++) {
      const double at = distance_along(s, m->point[m->tri[t][k]]);

      lo = fmin(lo, at);
      hi = fmax(hi, at);
      least = fmin(least, fabs(at - end));
    }
    if (!(least <= 0.5 * share * s->tip)) continue;
    to->asked += share;
    to->reached += (hi - lo) / s->tip;
    to->n++;
  }
}

/* At a round tip all triangles face along the span. */
static void measure_end(const struct vg_mesh *m, const uint8_t *mark,
                        const struct span *s, double end, double share,
                        struct vg_edge_spacing *to)
{
  const size_t n = to->n;

  if (!(share > 0)) return;
  measure_triangles(m, mark, s, end, share, 0, to);
  if (to->n == n) measure_triangles(m, mark, s, end, share, 1, to);
}

static void measure_span(const struct vg_boundary *b, const uint8_t *mark,
                         double root, double tip, struct vg_edge_spacing to[2])
{
  const struct span s = find_span(b, mark);

  measure_end(&b->surface, mark, &s, s.root, root, &to[0]);
  measure_end(&b->surface, mark, &s, s.tip, tip, &to[1]);
}

/* --- rows of the table --------------------------------------------------- */

static vg_status take_curve(const struct vg_mesh *m,
                            const struct vg_surface_row *row, uint8_t (*on)[2],
                            struct vg_surface_sizes *s, struct vg_error *err)
{
  const double size = row->size > 0 ? row->size : INFINITY;
  char one[2 * VG_NAME_MAX + 4], two[2 * VG_NAME_MAX + 4];
  size_t n_edge;
  vg_status st;

  if (row->stretch > 0 && !s->stretch) {
    s->stretch = vg_calloc(3 * m->n_tri, sizeof *s->stretch);
    if (!s->stretch) return vg_fail_memory(err, "the stretched edges");
  }
  st = size_curve(m, (const uint8_t(*)[2])on, size, row->stretch, s, &n_edge,
                  err);
  if (st < 0 || n_edge) return st;
  vg_param_format(&vg_surface_table.column[0], row, one, sizeof one);
  vg_param_format(&vg_surface_table.column[1], row, two, sizeof two);
  return vg_fail(err, VG_ERR_INPUT,
                 "surface: patches %s and %s share no edge, so "
                 "there is no curve between them",
                 one, two);
}

static void take_patch(const struct vg_boundary *b, size_t patch,
                       const struct vg_surface_row *row,
                       struct vg_surface_sizes *s)
{
  const struct vg_mesh *m = &b->surface;

  for (size_t t = 0; t < m->n_tri && row->size > 0; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++)
      lower(s->cap, m->tri[t][k], row->size);
  if (row->lead > 0)
    size_lead(m, patch, row->lead, b->read->settings.growth, s->cap);
  if (row->across > 0) s->across[patch] = row->across;
}

/* mark[2 * n_patch] and on[n_patch] are scratch space. */
static vg_status take_row(const struct vg_boundary *b,
                          const struct vg_surface_row *row, uint8_t *mark,
                          uint8_t (*on)[2], struct vg_surface_sizes *s,
                          struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  const int adjacent = vg_surface_row_has_adjacent(row);
  vg_status st;

  memset(mark, 0, 2 * m->n_patch);
  VG_TRY(vg_patch_ref_mark("surface", row->patch, row->patch_name, m,
                           m->n_patch, mark, err));
  if (adjacent)
    VG_TRY(vg_patch_ref_mark("surface", row->adjacent, row->adjacent_name, m,
                             m->n_patch, mark + m->n_patch, err));
  for (size_t i = 0; i < m->n_patch; i++) {
    on[i][0] = mark[i];
    on[i][1] = mark[m->n_patch + i];
    if (!adjacent && mark[i]) take_patch(b, i, row, s);
  }
  if (!adjacent) VG_TRY(span_sizes(b, mark, row->root, row->tip, s, err));
  if (adjacent) st = take_curve(m, row, on, s, err);
  else if (row->trail > 0)
    st = size_trail(b, row, (const uint8_t(*)[2])on, s->cap, err);
done:
  return st;
}

static vg_status take_rows(const struct vg_boundary *b,
                           struct vg_surface_sizes *s, struct vg_error *err)
{
  size_t n = b->surface.n_patch;
  uint8_t *mark = vg_alloc(n, 2), (*on)[2] = vg_alloc(n, sizeof *on);
  vg_status st = mark && on ? VG_OK : vg_fail_memory(err, "the patches");

  for (size_t i = 0; i < b->read->settings.n_surface && st >= 0; i++)
    st = take_row(b, &b->read->settings.surface_row[i], mark, on, s, err);
  free(mark);
  free(on);
  return st;
}

vg_status vg_surface_sizes_add(struct vg_surface_sizes *s,
                               const struct vg_source *source,
                               struct vg_error *err)
{
  if (vg_reserve(&s->source, &s->cap_source, s->n_source + 1,
                 sizeof *s->source))
    return vg_fail_memory(err, "the sources of the surface");
  s->source[s->n_source++] = *source;
  return VG_OK;
}

vg_status vg_surface_sizes_make(const struct vg_boundary *b,
                                struct vg_surface_sizes *s,
                                struct vg_error *err)
{
  const struct vg_settings *set = &b->read->settings;
  vg_status st = VG_OK;

  for (size_t i = 0; i < set->n_source; i++)
    VG_TRY(vg_surface_sizes_add(s, &set->source[i], err));
  if (!set->n_surface) return VG_OK;
  s->cap = vg_alloc(b->surface.n_point, sizeof *s->cap);
  s->across = vg_alloc(b->surface.n_patch, sizeof *s->across);
  if (!s->cap || !s->across)
    return vg_fail_memory(err, "the sizes on the surface");
  for (size_t i = 0; i < b->surface.n_point; i++) s->cap[i] = INFINITY;
  for (size_t i = 0; i < b->surface.n_patch; i++) s->across[i] = 1;
  VG_TRY(take_rows(b, s, err));
  for (size_t i = 0; i < b->surface.n_point; i++) s->cap[i] *= set->scale;
done:
  return st;
}

/* --- spacing reached ------------------------------------------------------ */

/* Edge over height of an equilateral triangle. */
#define EDGE_OVER_HEIGHT 1.1547005383792515

static void add_spacing(struct vg_edge_spacing *s, double asked, double reached)
{
  s->asked += asked;
  s->reached += reached;
  s->n++;
}

/* Twice the area of a triangle, with its direction. */
static void area_of(const struct vg_mesh *m, size_t t, double area[3])
{
  double u[3], v[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, area);
}

/* Triangles with a point within half the requested edge length behind the
 * leading edge. */
static void measure_lead(const struct vg_mesh *m, size_t patch, double share,
                         struct vg_edge_spacing *to)
{
  struct sections s;

  cut(&s, m, patch);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++) {
      double chord, behind, area[3];

      if (!chord_at(&s, m->point[m->tri[t][k]], &chord, &behind) ||
          behind > 0.5 * share * chord)
        continue;
      area_of(m, t, area);
      add_spacing(to, share, sqrt(EDGE_OVER_HEIGHT * vg_norm(area)) / chord);
      break;
    }
}

/* Triangles on edges whose ends are on trailing edges, except those that face
 * along the stream. chord: [n_point] 0: not on a trailing edge. */
static void measure_trail(const struct vg_mesh *m, const uint8_t (*on)[2],
                          double share, const double *chord,
                          struct vg_edge_spacing *to)
{
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && on[m->tri_patch[t]][0]; k++) {
      const uint32_t p = m->tri[t][k], q = m->tri[t][(k + 1) % 3];
      double area[3], norm;

      if (!(chord[p] > 0 && chord[q] > 0) || chord[m->tri[t][(k + 2) % 3]] > 0)
        continue;
      area_of(m, t, area);
      norm = vg_norm(area);
      if (2 * area[0] * area[0] > norm * norm) continue;
      add_spacing(to, share,
                  EDGE_OVER_HEIGHT * norm /
                    vg_distance(m->point[p], m->point[q]) /
                    (0.5 * (chord[p] + chord[q])));
    }
}

/* Does the row request edge lengths relative to a wing? */
static int is_spaced(const struct vg_surface_row *row)
{
  return row->lead > 0 || row->trail > 0 || row->root > 0 || row->tip > 0;
}

static vg_status measure_rows(const struct vg_boundary *b, uint8_t *mark,
                              uint8_t (*on)[2], const double *chord,
                              struct vg_edge_spacing (*of_row)[VG_SPACING_N],
                              struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_mesh *m = &b->surface;
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n_surface; i++) {
    const struct vg_surface_row *row = &s->surface_row[i];
    struct vg_edge_spacing *to = of_row[i];

    if (!is_spaced(row)) continue;
    memset(mark, 0, m->n_patch);
    VG_TRY(vg_patch_ref_mark("surface", row->patch, row->patch_name, m,
                             m->n_patch, mark, err));
    for (size_t k = 0; k < m->n_patch; k++) {
      on[k][0] = mark[k];
      if (mark[k] && row->lead > 0)
        measure_lead(m, k, row->lead * s->scale, &to[VG_AT_LEAD]);
    }
    measure_span(b, mark, row->root * s->scale, row->tip * s->scale,
                 &to[VG_AT_ROOT]);
    if (row->trail > 0)
      measure_trail(m, (const uint8_t(*)[2])on, row->trail * s->scale, chord,
                    &to[VG_AT_TRAIL]);
  }
done:
  return st;
}

/* Turns the sums of all rows into means, of each row and of all. */
static void take_means(struct vg_remeshing *r)
{
  for (int k = 0; k < VG_SPACING_N; k++) {
    struct vg_edge_spacing *all = &r->spacing[k];

    for (size_t i = 0; i <= r->n_row; i++) {
      struct vg_edge_spacing *to = i < r->n_row ? &r->row[i][k] : all;

      if (!to->n) continue;
      if (to != all) {
        all->asked += to->asked;
        all->reached += to->reached;
        all->n += to->n;
      }
      to->asked /= (double)to->n;
      to->reached /= (double)to->n;
    }
  }
}

vg_status vg_surface_spacing_measure(const struct vg_boundary *b,
                                     struct vg_remeshing *r,
                                     struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_mesh *m = &b->surface;
  struct vg_trailing t = VG_TRAILING_INIT;
  int any = 0, trail = 0;
  double *chord;
  uint8_t *mark;
  vg_status st;

  assert(!r->row);
  for (size_t i = 0; i < s->n_surface; i++) {
    any |= is_spaced(&s->surface_row[i]);
    trail |= s->surface_row[i].trail > 0;
  }
  if (!any) return VG_OK;
  chord = vg_calloc(m->n_point, sizeof *chord);
  mark = vg_calloc(3 * m->n_patch, 1);
  r->row = vg_calloc(s->n_surface, sizeof *r->row);
  if (!chord || !mark || !r->row)
    VG_TRY(vg_fail_memory(err, "the edges of the surface"));
  r->n_row = s->n_surface;
  if (trail) VG_TRY(find_trailing(b, &t, err));
  for (size_t i = 0; i < t.n; i++)
    for (int k = 0; k < 2; k++) chord[t.edge[i].point[k]] = t.edge[i].chord;
  VG_TRY(measure_rows(b, mark, (uint8_t(*)[2])(mark + m->n_patch), chord,
                      r->row, err));
  take_means(r);
done:
  vg_trailing_release(&t);
  free(chord);
  free(mark);
  return st;
}

void vg_surface_sizes_release(struct vg_surface_sizes *s)
{
  free(s->cap);
  free(s->across);
  free(s->stretch);
  free(s->source);
  vg_sizing_free(s->field);
  memset(s, 0, sizeof *s);
}
