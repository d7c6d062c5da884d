/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: sweeps collapse short edges, the shortest first, unless a triangle
 * around the edge has already changed in the same sweep. After each sweep the
 * longest edges of flat triangles are swapped. At triangles that intersect each
 * other, longer edges also count as short. */
#include "core/remesh/job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"

#define SHORT 0.02  /* S46: of the tolerance: shorter edges collapse */
#define FLAT 0.02   /* S46: of the tolerance: lower triangles are flat */
#define CROSSED 1.0 /* SHORT at triangles that intersect */
#define SWEEPS 24
#define CLEARINGS 14 /* most searches for intersections */
#define DEEPEST                                                                \
  0.25             /* S46: of the tolerance: deeper ones are not moved apart */
#define CLEAR 1e-4 /* of the tolerance: least clearance after moving */
#define RING 256   /* most triangles at a point of a collapsed edge */

/* --- neighbourhood of a point --------------------------------------------- */

struct sweep {
  struct vg_mesh *m;
  struct vg_ref ref;      /* Faces of m. */
  uint32_t *start, *half; /* Outgoing half-edges of each point. */
  uint8_t *hard;          /* [n_point] On a rim or a fixed patch border. */
  uint8_t *busy;          /* [n_tri] Changed in this sweep. */
  uint8_t *gone;          /* [n_tri] Removed. */
  size_t *left;           /* [n_patch] Remaining triangles. */
  double limit2;          /* Squared least height of a sound triangle. */
};

struct candidate {
  double length2;
  uint32_t half;
};

static void release_sweep(struct sweep *s)
{
  vg_ref_release(&s->ref);
  free(s->start);
  free(s->half);
  free(s->hard);
  free(s->busy);
  free(s->gone);
  free(s->left);
}

static vg_status begin_sweep(struct sweep *s, const struct vg_clean_options *o,
                             struct vg_error *err)
{
  const struct vg_mesh *m = s->m;
  vg_status st;

  VG_TRY(vg_ref_set_faces(&s->ref, m, &o->stop, err));
  s->start = vg_calloc(m->n_point + 2, sizeof *s->start);
  s->half = vg_alloc(3 * m->n_tri, sizeof *s->half);
  s->hard = vg_calloc(m->n_point, 1);
  s->busy = vg_calloc(m->n_tri, 1);
  s->gone = vg_calloc(m->n_tri, 1);
  s->left = vg_calloc(m->n_patch, sizeof *s->left);
  if (!s->start || !s->half || !s->hard || !s->busy || !s->gone || !s->left)
    VG_TRY(vg_fail_memory(err, "short edges of the surface"));
  for (uint32_t h = 0; h < 3 * m->n_tri; h++) {
    s->start[vg_ref_from(&s->ref, h) + 2]++;
    if (vg_curves_is_hard(o->lines, &s->ref, h))
      s->hard[vg_ref_from(&s->ref, h)] = s->hard[vg_ref_to(&s->ref, h)] = 1;
  }
  for (size_t p = 1; p < m->n_point + 2; p++) s->start[p] += s->start[p - 1];
  for (uint32_t h = 0; h < 3 * m->n_tri; h++)
    s->half[s->start[vg_ref_from(&s->ref, h) + 1]++] = h;
  for (size_t t = 0; t < m->n_tri; t++) s->left[m->tri_patch[t]]++;
done:
  return st;
}

/* --- one collapse -------------------------------------------------------- */

static int is_neighbour(const struct sweep *s, uint32_t p, uint32_t q)
{
  for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++)
    if (vg_ref_to(&s->ref, s->half[i]) == q ||
        vg_ref_from(&s->ref, vg_half_prev(s->half[i])) == q)
      return 1;
  return 0;
}

/* Link condition: the ends of h share no neighbours except the corners opposite
 * h, and no triangle around them has changed in this sweep. */
static int link_fits(const struct sweep *s, uint32_t h)
{
  const struct vg_ref *r = &s->ref;
  const uint32_t v = vg_ref_from(r, h), u = vg_ref_to(r, h), g = r->mate[h];
  const uint32_t o = vg_ref_from(r, vg_half_prev(h));
  const uint32_t q = g == VG_REF_NONE ? o : vg_ref_from(r, vg_half_prev(g));

  if (s->start[v + 1] - s->start[v] > RING ||
      s->start[u + 1] - s->start[u] > RING)
    return 0;
  for (int k = 0; k < 2; k++) {
    const uint32_t p = k ? u : v;

    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++)
      if (s->busy[s->half[i] / 3]) return 0;
  }
  for (uint32_t i = s->start[v]; i < s->start[v + 1]; i++)
    for (int k = 0; k < 2; k++) {
      const uint32_t n = k ? vg_ref_from(r, vg_half_prev(s->half[i]))
                           : vg_ref_to(r, s->half[i]);

      if (n != u && n != o && n != q && is_neighbour(s, u, n)) return 0;
    }
  return 1;
}

/* The collapse does not close a tetrahedron or a lens of two triangles. */
static int leaves_surface(const struct sweep *s, uint32_t h)
{
  const struct vg_ref *r = &s->ref;
  uint32_t k = h;

  for (int side = 0; side < 2 && k != VG_REF_NONE; side++, k = r->mate[h]) {
    const uint32_t a = r->mate[vg_half_next(k)], b = r->mate[vg_half_prev(k)];

    if (a == VG_REF_NONE && b == VG_REF_NONE) return 0;
    if (a != VG_REF_NONE && b != VG_REF_NONE && a / 3 == b / 3) return 0;
  }
  return 1;
}

static void cross_of(const double *a, const double *b, const double *c,
                     double n[3])
{
  double u[3], v[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
}

static double longest2(const double *a, const double *b, const double *c)
{
  return fmax(vg_distance2(a, b), fmax(vg_distance2(b, c), vg_distance2(c, a)));
}

/* No triangle of significant height is inverted. */
static int keeps_sides(const struct sweep *s, uint32_t h)
{
  const struct vg_ref *r = &s->ref;
  const uint32_t v = vg_ref_from(r, h), u = vg_ref_to(r, h);

  for (uint32_t i = s->start[v]; i < s->start[v + 1]; i++) {
    const uint32_t k = s->half[i], a = vg_ref_to(r, k);
    const uint32_t b = vg_ref_from(r, vg_half_prev(k));
    const double *x = r->point[v], *y = r->point[a], *z = r->point[b];
    double before[3], after[3], l2;

    if (a == u || b == u) continue;
    cross_of(x, y, z, before);
    cross_of(r->point[u], y, z, after);
    l2 = longest2(x, y, z);
    if (vg_dot(before, before) <= s->limit2 * l2) continue;
    if (!(vg_dot(before, after) > 0)) return 0;
  }
  return 1;
}

static int patches_stay(const struct sweep *s, uint32_t h)
{
  const uint32_t g = s->ref.mate[h], p = s->m->tri_patch[h / 3];
  const uint32_t q = g == VG_REF_NONE ? p : s->m->tri_patch[g / 3];

  return s->left[p] > 2 && s->left[q] > 2;
}

/* Move the start of h to its end. */
static int collapse(struct sweep *s, uint32_t h)
{
  const struct vg_ref *r = &s->ref;
  const uint32_t v = vg_ref_from(r, h), u = vg_ref_to(r, h), g = r->mate[h];

  if (!link_fits(s, h) || !leaves_surface(s, h) || !patches_stay(s, h) ||
      !keeps_sides(s, h))
    return 0;
  for (int k = 0; k < 2; k++) {
    const uint32_t p = k ? u : v;

    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++)
      s->busy[s->half[i] / 3] = 1;
  }
  for (uint32_t i = s->start[v]; i < s->start[v + 1]; i++)
    s->m->tri[s->half[i] / 3][s->half[i] % 3] = u;
  for (int k = 0; k < 2; k++) {
    const uint32_t side = k ? g : h;

    if (side == VG_REF_NONE) continue;
    s->gone[side / 3] = 1;
    s->left[s->m->tri_patch[side / 3]]--;
  }
  return 1;
}

/* Collapse the edge by moving one of its ends to the other. A point on a rim or
 * a fixed border moves only along an edge of it. */
static int collapse_edge(struct sweep *s, const struct vg_clean_options *o,
                         uint32_t h)
{
  const uint32_t v = vg_ref_from(&s->ref, h), u = vg_ref_to(&s->ref, h);
  const int along = vg_curves_is_hard(o->lines, &s->ref, h);

  if (s->hard[u] && s->hard[v] && !along) return 0;
  if ((!s->hard[v] || along) && collapse(s, h)) return 1;
  if (s->ref.mate[h] == VG_REF_NONE || (s->hard[u] && !along)) return 0;
  return collapse(s, s->ref.mate[h]);
}

/* --- sweeps -------------------------------------------------------------- */

static int by_length(const void *pa, const void *pb)
{
  const struct candidate *a = pa, *b = pb;

  if (a->length2 != b->length2) return a->length2 < b->length2 ? -1 : 1;
  return a->half < b->half ? -1 : a->half > b->half;
}

/* List edges shorter than the limit, and at marked triangles edges shorter than
 * `longer`. */
static vg_status list_short(const struct sweep *s, const uint8_t *crossed,
                            double limit, double longer,
                            struct candidate **list, size_t *n,
                            struct vg_error *err)
{
  const struct vg_ref *r = &s->ref;
  size_t cap = 0;

  for (uint32_t h = 0; h < 3 * r->n_tri; h++) {
    const uint32_t g = r->mate[h];
    double most = limit, l2;

    if (g != VG_REF_NONE && g < h) continue;
    if (crossed && (crossed[h / 3] || (g != VG_REF_NONE && crossed[g / 3])))
      most = longer;
    l2 = vg_distance2(r->point[vg_ref_from(r, h)], r->point[vg_ref_to(r, h)]);
    if (!(l2 < most * most)) continue;
    if (vg_reserve(list, &cap, *n + 1, sizeof **list))
      return vg_fail_memory(err, "short edges of the surface");
    (*list)[(*n)++] = (struct candidate){ l2, h };
  }
  if (*n > 1) qsort(*list, *n, sizeof **list, by_length);
  return VG_OK;
}

/* Remove deleted triangles, and points without triangles. */
static vg_status pack(struct vg_clean *c, const struct sweep *s,
                      uint8_t *crossed, struct vg_error *err)
{
  struct vg_mesh *m = &c->mesh;
  uint32_t *number = vg_alloc(m->n_point, sizeof *number);
  size_t n = 0;

  if (!number) return vg_fail_memory(err, "the points of the surface");
  memset(number, 0xff, m->n_point * sizeof *number);
  for (size_t t = 0; t < m->n_tri; t++) {
    if (s->gone[t]) continue;
    for (int k = 0; k < 3; k++) number[m->tri[t][k]] = 0;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n] = m->tri_patch[t];
    if (crossed) crossed[n] = crossed[t];
    c->tri_from[n++] = c->tri_from[t];
  }
  m->n_tri = n;
  n = 0;
  for (size_t p = 0; p < m->n_point; p++) {
    if (number[p] == UINT32_MAX) continue;
    memmove(m->point[n], m->point[p], sizeof *m->point);
    c->point_from[n] = c->point_from[p];
    number[p] = (uint32_t)n++;
  }
  m->n_point = n;
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    m->tri[i / 3][i % 3] = number[m->tri[i / 3][i % 3]];
  free(number);
  return VG_OK;
}

/* Collapse short edges and swap edges of flat triangles until nothing changes.
 * CAD systems often divide one edge of two patches differently: flat triangles
 * along that edge then hide the feature edge and touch the other patch. */
static vg_status collapse_short(struct vg_clean *c,
                                const struct vg_clean_options *o,
                                uint8_t *crossed, double longer,
                                struct vg_error *err)
{
  const double limit = SHORT * o->tolerance;
  vg_status st = VG_OK;

  for (int i = 0; i < SWEEPS && st >= 0; i++) {
    struct vg_curves_options lines = *o->lines;
    struct vg_clean_options own = *o;
    struct sweep s = { .m = &c->mesh, .limit2 = limit * limit };
    struct candidate *list = NULL;
    size_t n = 0, done = 0;

    lines.tri_patch = c->mesh.tri_patch;
    lines.stretch = NULL;
    own.lines = &lines;
    st = begin_sweep(&s, &own, err);
    if (st >= 0) st = list_short(&s, crossed, limit, longer, &list, &n, err);
    for (size_t k = 0; st >= 0 && k < n; k++)
      if (!s.gone[list[k].half / 3])
        done += (size_t)collapse_edge(&s, &own, list[k].half);
    c->n_collapse += done;
    if (st >= 0 && done) st = pack(c, &s, crossed, err);
    free(list);
    release_sweep(&s);
    n = 0;
    if (st >= 0)
      st = vg_flat_swap(&c->mesh,
                        &(struct vg_flat_limit){ FLAT * o->tolerance, 0 }, &n,
                        err);
    c->n_swap += n;
    if (!done && !n) break;
  }
  return st;
}

/* --- intersections ------------------------------------------------------- */

/* Signed distances of the corners of triangle a from the plane of b. Returns 0
 * if b is too flat to define a plane. */
static int heights(const struct vg_mesh *m, size_t a, size_t b, double n[3],
                   double h[3])
{
  const double *o = m->point[m->tri[b][0]];
  double u[3], v[3];

  vg_sub(m->point[m->tri[b][1]], o, u);
  vg_sub(m->point[m->tri[b][2]], o, v);
  vg_cross(u, v, n);
  if (!(vg_unit(n) > 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const uint32_t p = m->tri[a][k];

    vg_sub(m->point[p], o, u);
    h[k] = vg_dot(u, n);
    for (int j = 0; j < 3; j++)
      if (m->tri[b][j] == p) h[k] = 0;
  }
  return 1;
}

/* Depth by which triangle a reaches through the plane of b. */
static double reach(const double h[3])
{
  const double lo = fmin(h[0], fmin(h[1], h[2]));
  const double hi = fmax(h[0], fmax(h[1], h[2]));

  return fmax(0, fmin(-lo, hi));
}

static int is_pair(const struct vg_defect *d)
{
  return d->kind == VG_DEFECT_INTERSECTION && d->face[0] != SIZE_MAX &&
         d->face[1] != SIZE_MAX;
}

/* Set depth and location of the deepest intersection. */
static void find_depth(const struct vg_mesh *m,
                       const struct vg_surface_report *r, struct vg_clean *c)
{
  c->depth = 0;
  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];
    double n[3], h[3], deep = INFINITY;

    if (!is_pair(d)) continue;
    for (int k = 0; k < 2; k++)
      if (heights(m, d->face[k], d->face[!k], n, h))
        deep = fmin(deep, reach(h));
    if (!(deep < INFINITY)) deep = 0;
    if (i && deep < c->depth) continue;
    c->depth = deep;
    memcpy(c->at, d->at, sizeof c->at);
  }
}

/* Move corners of a that are barely on the wrong side of b to the side on which
 * most of a is. */
static void push(const struct vg_mesh *m, size_t a, size_t b, double tolerance,
                 double (*move)[3])
{
  double n[3], h[3], side;

  if (!heights(m, a, b, n, h)) return;
  if (!(reach(h) > 0 && reach(h) < DEEPEST * tolerance)) return;
  side = h[0] + h[1] + h[2] > 0 ? 1 : -1;
  for (int k = 0; k < 3; k++) {
    const uint32_t p = m->tri[a][k];
    double by = fmax(CLEAR * tolerance, -0.5 * side * h[k]) - side * h[k];

    if (!(side * h[k] < 0) || by * by <= vg_dot(move[p], move[p])) continue;
    for (int d = 0; d < 3; d++) move[p][d] = side * by * n[d];
  }
}

/* Move points of intersecting triangles along their normals, so that the two
 * sheets of a thin region separate. */
static vg_status part(struct vg_mesh *m, const struct vg_surface_report *r,
                      double tolerance, size_t *n_moved, struct vg_error *err)
{
  double(*move)[3] = vg_calloc(m->n_point, sizeof *move);

  *n_moved = 0;
  if (!move) return vg_fail_memory(err, "intersections of the surface");
  for (size_t i = 0; i < r->n_defect; i++)
    for (int k = 0; k < 2; k++)
      if (is_pair(&r->defect[i]))
        push(m, r->defect[i].face[k], r->defect[i].face[!k], tolerance, move);
  for (size_t p = 0; p < m->n_point; p++) {
    if (!(vg_dot(move[p], move[p]) > 0)) continue;
    for (int d = 0; d < 3; d++) m->point[p][d] += move[p][d];
    ++*n_moved;
  }
  free(move);
  return VG_OK;
}

static vg_status clear_crossings(struct vg_clean *c,
                                 const struct vg_clean_options *o,
                                 struct vg_error *err)
{
  const struct vg_surface_check_options co = { .threads = o->threads,
                                               .stop = o->stop };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  uint8_t *crossed = vg_alloc(c->mesh.n_tri, 1);
  double longer = SHORT * o->tolerance;
  vg_status st = VG_OK;

  if (!crossed) VG_TRY(vg_fail_memory(err, "intersections of the surface"));
  for (int i = 0; i < CLEARINGS; i++) {
    const size_t n = c->n_collapse;
    size_t n_moved = 0;

    VG_TRY(vg_surface_check(&c->mesh, &co, &r, err));
    c->n_crossing[i > 0] = r.count[VG_DEFECT_INTERSECTION];
    if (!i) find_depth(&c->mesh, &r, c);
    if (!r.count[VG_DEFECT_INTERSECTION]) break;
    memset(crossed, 0, c->mesh.n_tri);
    for (size_t k = 0; k < r.n_defect; k++)
      for (int j = 0; j < 2; j++)
        if (r.defect[k].kind == VG_DEFECT_INTERSECTION &&
            r.defect[k].face[j] != SIZE_MAX)
          crossed[r.defect[k].face[j]] = 1;
    VG_TRY(collapse_short(c, o, crossed, longer, err));
    if (c->n_collapse == n && longer >= CROSSED * o->tolerance)
      VG_TRY(part(&c->mesh, &r, o->tolerance, &n_moved, err));
    if (c->n_collapse == n && !n_moved && longer >= CROSSED * o->tolerance)
      break;
    longer = fmin(2 * longer, CROSSED * o->tolerance);
  }
done:
  free(crossed);
  vg_surface_report_release(&r);
  return st;
}

/* --- flaps --------------------------------------------------------------- */

struct face {
  uint32_t node[3], tri; /* Corners, ascending. */
  int turned;            /* The corners were sorted by an odd number of
                            exchanges. */
};

static int by_nodes(const void *pa, const void *pb)
{
  const struct face *a = pa, *b = pb;

  for (int k = 0; k < 3; k++)
    if (a->node[k] != b->node[k]) return a->node[k] < b->node[k] ? -1 : 1;
  return a->tri < b->tri ? -1 : a->tri > b->tri;
}

static struct face face_of(const struct vg_mesh *m, uint32_t t)
{
  struct face f = { { m->tri[t][0], m->tri[t][1], m->tri[t][2] }, t, 0 };

  f.turned = (int)vg_order3(f.node);
  return f;
}

/* The triangle is lower than the tolerance. */
static int is_thin(const struct vg_mesh *m, uint32_t t, double tolerance)
{
  const double *a = m->point[m->tri[t][0]], *b = m->point[m->tri[t][1]];
  const double *c = m->point[m->tri[t][2]];
  double n[3];

  cross_of(a, b, c, n);
  return vg_dot(n, n) <= tolerance * tolerance * longest2(a, b, c);
}

/* Drop pairs of triangles on the same three points that face opposite ways:
 * they enclose nothing. Only thin ones are dropped, as at the end of a cusp. */
static vg_status drop_flaps(struct vg_clean *c, double tolerance,
                            struct vg_error *err)
{
  struct vg_mesh *m = &c->mesh;
  struct sweep s = { .m = m, .gone = vg_calloc(m->n_tri, 1) };
  struct face *f = vg_alloc(m->n_tri, sizeof *f);
  size_t n = 0;
  vg_status st = VG_OK;

  if (!f || !s.gone) VG_TRY(vg_fail_memory(err, "the triangles"));
  for (uint32_t t = 0; t < m->n_tri; t++) f[t] = face_of(m, t);
  qsort(f, m->n_tri, sizeof *f, by_nodes);
  for (size_t i = 0; i + 1 < m->n_tri; i++) {
    if (memcmp(f[i].node, f[i + 1].node, sizeof f[i].node) ||
        f[i].turned == f[i + 1].turned || !is_thin(m, f[i].tri, tolerance))
      continue;
    s.gone[f[i].tri] = s.gone[f[i + 1].tri] = 1;
    i++;
    n++;
  }
  c->n_flap = n;
  if (n) VG_TRY(pack(c, &s, NULL, err));
done:
  free(f);
  free(s.gone);
  return st;
}

/* --- whole repair --------------------------------------------------------- */

static vg_status begin(struct vg_clean *c, const struct vg_mesh *m,
                       struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_mesh_copy(&c->mesh, m, err));
  c->point_from = vg_alloc(m->n_point, sizeof *c->point_from);
  c->tri_from = vg_alloc(m->n_tri, sizeof *c->tri_from);
  if (!c->point_from || !c->tri_from)
    VG_TRY(vg_fail_memory(err, "the reference"));
  for (uint32_t p = 0; p < m->n_point; p++) c->point_from[p] = p;
  for (uint32_t t = 0; t < m->n_tri; t++) c->tri_from[t] = t;
done:
  return st;
}

vg_status vg_clean_find(const struct vg_mesh *m,
                        const struct vg_clean_options *o, struct vg_clean *c,
                        struct vg_error *err)
{
  vg_status st = VG_OK;

  VG_TRY(begin(c, m, err));
  VG_TRY(drop_flaps(c, o->tolerance, err));
  st = collapse_short(c, o, NULL, 0, err);
  if (st == VG_ERR_INPUT) {
    vg_clean_release(c); /* Not a manifold surface: vg_ref_set_faces reports
                            where. */
    return VG_OK;
  }
  VG_TRY(st);
  VG_TRY(clear_crossings(c, o, err));
done:
  if (st < 0) vg_clean_release(c);
  return st;
}

void vg_clean_release(struct vg_clean *c)
{
  vg_mesh_release(&c->mesh);
  free(c->point_from);
  free(c->tri_from);
  memset(c, 0, sizeof *c);
}
