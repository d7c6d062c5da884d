/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Assigns the faces of a front to patches. The file does not contain the
 * patches (formats.md 1.9), but it lists the edges on the curves of the
 * project.
 *
 *   1. Every mesh edge is entered into a list, and curve edges are marked.
 *   2. Faces are flooded across the other edges into regions.
 *   3. Curve edges are chained between curve ends, and each chain is matched
 *      with the curve of the project that has the same ends (the nearest
 *      one, if several have).
 *   4. The curves around a region, signed by the direction in which the
 *      region runs along them, are those of exactly one patch. Loops of the
 *      project are inward by the right-hand rule, as faces are, so that even
 *      two patches inside the same loop differ. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "core/geometry/vector.h"
#include "io/vgrid/vgrid.h"

#define NONE UINT32_MAX

struct edge { /* mesh edge, a < b */
  uint32_t a, b;
  uint32_t face[2];
  int n_face;
  int on_curve;
  int32_t curve; /* number of the curve from 1; negative: the curve runs from
                    b to a */
};

/* A curve edge as seen from one of its ends. */
struct link {
  uint32_t from, to;
  uint32_t edge;
};

struct front {
  struct vg_mesh *m;
  const struct vg_project *project;
  const char *path;
  struct vg_table table; /* edges by their points */
  size_t n_edge;
  struct edge *edge; /* [n_edge] */
  uint32_t *region;  /* [n_tri] */
  uint32_t *seed;    /* [n_region] first face of each region */
  size_t n_region, n_link;
  struct link *link;     /* [n_link] sorted by from, to */
  uint32_t (*end)[2];    /* [n_curve] mesh points at both ends of each curve */
  unsigned char *is_end; /* [n_point] */
};

/* Edge between two points, created if it does not exist yet. */
static struct edge *edge_of(struct front *w, uint32_t p, uint32_t q)
{
  uint32_t a = p < q ? p : q, b = p < q ? q : p, *at;

  VG_TABLE_FIND(&w->table, at, vg_hash_1(vg_edge_key(a, b)),
                w->edge[*at].a == a && w->edge[*at].b == b);
  if (*at == VG_TABLE_FREE) {
    *at = (uint32_t)w->n_edge;
    w->edge[w->n_edge++] = (struct edge){ .a = a, .b = b };
  }
  return &w->edge[*at];
}

static vg_status build_edges(struct front *w, size_t n_edge,
                             const uint32_t (*edge)[2], struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  size_t most = 3 * m->n_tri + n_edge;

  w->edge = vg_alloc(most, sizeof *w->edge);
  if (!w->edge || vg_table_init(&w->table, most))
    return vg_fail_memory(err, "the edges of a front");
  for (size_t f = 0; f < m->n_tri; f++)
    for (int k = 0; k < 3; k++) {
      struct edge *c = edge_of(w, m->tri[f][k], m->tri[f][(k + 1) % 3]);

      if (c->n_face < 2) c->face[c->n_face] = (uint32_t)f;
      c->n_face += c->n_face < 3;
    }
  for (size_t i = 0; i < n_edge; i++) {
    struct edge *c = edge_of(w, edge[i][0], edge[i][1]);

    c->on_curve = 1;
    if (!c->n_face)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: curve edge %zu connects points %u and %u, but no "
                     "face has this edge; the file is damaged",
                     w->path, i + 1, edge[i][0] + 1, edge[i][1] + 1);
  }
  return VG_OK;
}

static vg_status flood(struct front *w, struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  uint32_t *stack = vg_alloc(m->n_tri, sizeof *stack);
  size_t cap = 0;

  w->region = vg_alloc(m->n_tri, sizeof *w->region);
  if (!stack || !w->region) goto refused;
  memset(w->region, 0xff, m->n_tri * sizeof *w->region);
  for (size_t first = 0; first < m->n_tri; first++) {
    size_t n = 0;

    if (w->region[first] != NONE) continue;
    if (vg_reserve(&w->seed, &cap, w->n_region + 1, sizeof *w->seed) < 0)
      goto refused;
    w->seed[w->n_region] = (uint32_t)first;
    w->region[first] = (uint32_t)w->n_region;
    stack[n++] = (uint32_t)first;
    while (n) {
      uint32_t f = stack[--n];

      for (int k = 0; k < 3; k++) {
        const struct edge *c = edge_of(w, m->tri[f][k], m->tri[f][(k + 1) % 3]);
        uint32_t g = c->face[0] == f ? c->face[1] : c->face[0];

        if (c->on_curve || c->n_face != 2 || w->region[g] != NONE) continue;
        w->region[g] = (uint32_t)w->n_region;
        stack[n++] = g;
      }
    }
    w->n_region++;
  }
  free(stack);
  return VG_OK;
refused:
  free(stack);
  return vg_fail_memory(err, "the regions of a front");
}

/* --- curves of the project, found in the front --- */

static int compare_link(const void *x, const void *y)
{
  const struct link *p = x, *q = y;

  if (p->from != q->from) return p->from < q->from ? -1 : 1;
  return (p->to > q->to) - (p->to < q->to);
}

static vg_status build_links(struct front *w, struct vg_error *err)
{
  size_t n = 0;

  for (size_t i = 0; i < w->n_edge; i++) n += w->edge[i].on_curve;
  w->link = vg_alloc(2 * n, sizeof *w->link);
  if (!w->link) return vg_fail_memory(err, "the curves of a front");
  for (size_t i = 0; i < w->n_edge; i++) {
    const struct edge *c = w->edge + i;

    if (!c->on_curve) continue;
    w->link[w->n_link++] = (struct link){ c->a, c->b, (uint32_t)i };
    w->link[w->n_link++] = (struct link){ c->b, c->a, (uint32_t)i };
  }
  qsort(w->link, w->n_link, sizeof *w->link, compare_link);
  return VG_OK;
}

static size_t first_link(const struct front *w, uint32_t from)
{
  size_t lo = 0, hi = w->n_link;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (w->link[mid].from < from) lo = mid + 1;
    else hi = mid;
  }
  return lo;
}

static int degree(const struct front *w, uint32_t p)
{
  size_t at = first_link(w, p);
  int n = 0;

  while (n < 3 && at + (size_t)n < w->n_link &&
         w->link[at + (size_t)n].from == p)
    n++;
  return n;
}

struct by_x {
  double x;
  uint32_t p;
};

static int compare_x(const void *a, const void *b)
{
  const struct by_x *p = a, *q = b;

  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  return (p->p > q->p) - (p->p < q->p);
}

/* Curve point of the front that is nearest to c and within `tolerance` of it,
 * or NONE. `list` holds the curve points, sorted by x. */
static uint32_t nearest(const struct front *w, const struct by_x *list,
                        size_t n, const double c[3], double tolerance)
{
  double best = tolerance * tolerance;
  uint32_t found = NONE;
  size_t lo = 0, hi = n;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (list[mid].x < c[0] - tolerance) lo = mid + 1;
    else hi = mid;
  }
  for (; lo < n && list[lo].x <= c[0] + tolerance; lo++) {
    double d = vg_distance2(w->m->point[list[lo].p], c);

    if (d < best || (d == best && found == NONE)) {
      best = d;
      found = list[lo].p;
    }
  }
  return found;
}

/* Coordinates of a .d3m have eight digits, those of a .front thirteen. */
static double match_tolerance(const struct vg_mesh *m)
{
  double lo[3], hi[3], size = 0;

  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) {
    if (fabs(lo[k]) > size) size = fabs(lo[k]);
    if (fabs(hi[k]) > size) size = fabs(hi[k]);
  }
  return 1e-6 * size;
}

static vg_status find_end(struct front *w, const struct by_x *list, size_t n,
                          double tolerance, size_t curve, int side,
                          struct vg_error *err)
{
  const struct vg_curve *c = w->project->curve + curve;
  uint32_t number = c->point[side ? c->n - 1 : 0];
  const double *at = w->project->point[number];
  uint32_t p = nearest(w, list, n, at, tolerance);

  if (p == NONE)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the %s of curve %d of the project, at (%g %g %g), "
                   "is not a curve point of the front; the .d3m and the "
                   ".front do not belong together",
                   w->path, side ? "end" : "start", c->id, at[0], at[1], at[2]);
  w->end[curve][side] = p;
  w->is_end[p] = 1;
  return VG_OK;
}

static vg_status find_ends(struct front *w, struct vg_error *err)
{
  const struct vg_project *project = w->project;
  struct by_x *list = vg_alloc(w->n_link, sizeof *list);
  double tolerance = match_tolerance(w->m);
  vg_status st = VG_OK;
  size_t n = 0;

  w->end = vg_alloc(project->n_curve, sizeof *w->end);
  w->is_end = vg_calloc(w->m->n_point, 1);
  if (!list || !w->end || !w->is_end) {
    free(list);
    return vg_fail_memory(err, "the curves of a front");
  }
  for (size_t i = 0; i < w->n_link; i++)
    if (!i || w->link[i].from != w->link[i - 1].from)
      list[n++] = (struct by_x){ w->m->point[w->link[i].from][0],
                                 w->link[i].from };
  qsort(list, n, sizeof *list, compare_x);
  for (size_t c = 0; c < project->n_curve && st == VG_OK; c++)
    for (int side = 0; side < 2 && st == VG_OK; side++)
      st = find_end(w, list, n, tolerance, c, side, err);
  free(list);
  return st;
}

/* Squared distance of x from the polyline of a curve. *where is the parameter
 * of the nearest location (segment number plus fraction). */
static double along(const struct vg_project *p, const struct vg_curve *c,
                    const double x[3], double *where)
{
  double best = INFINITY;

  *where = 0;
  for (size_t i = 0; i + 1 < c->n; i++) {
    const double *a = p->point[c->point[i]], *b = p->point[c->point[i + 1]];
    double length = vg_distance2(a, b), t = 0, at[3], d;

    for (int k = 0; k < 3; k++) t += (x[k] - a[k]) * (b[k] - a[k]);
    t = length > 0 ? t / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; k++) at[k] = a[k] + t * (b[k] - a[k]);
    d = vg_distance2(at, x);
    if (d < best) {
      best = d;
      *where = (double)i + t;
    }
  }
  return best;
}

struct chain {
  size_t n; /* points */
  size_t cap, cap_edge;
  uint32_t *point; /* [n] */
  uint32_t *edge;  /* [n - 1] */
};

static int chain_add(struct chain *c, uint32_t p)
{
  if (vg_reserve(&c->point, &c->cap, c->n + 1, sizeof *c->point) < 0 ||
      vg_reserve(&c->edge, &c->cap_edge, c->n + 1, sizeof *c->edge) < 0)
    return -1;
  c->point[c->n++] = p;
  return 0;
}

/* Collect points and edges from link l to the next curve end or fork. */
static int follow(const struct front *w, size_t l, struct chain *c)
{
  uint32_t start = w->link[l].from, p = start;

  c->n = 0;
  if (chain_add(c, p) < 0) return -1;
  for (;;) {
    uint32_t edge = w->link[l].edge;

    c->edge[c->n - 1] = edge;
    p = w->link[l].to;
    if (chain_add(c, p) < 0) return -1;
    if (w->is_end[p] || p == start || degree(w, p) != 2) return 0;
    l = first_link(w, p);
    if (w->link[l].edge == edge) l++;
  }
}

/* Does the chain run along the direction of the curve? Decided by the ends, or,
 * if these are the same point, by the locations of its second and its last but
 * one point. */
static int is_forward(const struct front *w, size_t curve,
                      const struct chain *c)
{
  const struct vg_mesh *m = w->m;
  double first, last;

  if (w->end[curve][0] != w->end[curve][1])
    return w->end[curve][0] == c->point[0];
  along(w->project, w->project->curve + curve, m->point[c->point[1]], &first);
  along(w->project, w->project->curve + curve, m->point[c->point[c->n - 2]],
        &last);
  return first < last;
}

/* Midpoint of a chain: one of its points, or the centre of its only edge. */
static void middle(const struct front *w, const struct chain *c, double x[3])
{
  const double *a = w->m->point[c->point[(c->n - 1) / 2]];
  const double *b = w->m->point[c->point[c->n / 2]];

  for (int k = 0; k < 3; k++) x[k] = (a[k] + b[k]) / 2;
}

struct ends {
  uint32_t lo, hi, curve;
};

static int compare_ends(const void *x, const void *y)
{
  const struct ends *p = x, *q = y;

  if (p->lo != q->lo) return p->lo < q->lo ? -1 : 1;
  if (p->hi != q->hi) return p->hi < q->hi ? -1 : 1;
  return (p->curve > q->curve) - (p->curve < q->curve);
}

static vg_status name_chain(struct front *w, const struct ends *list,
                            const struct chain *c, struct vg_error *err)
{
  uint32_t p = c->point[0], q = c->point[c->n - 1];
  uint32_t a = p < q ? p : q, b = p < q ? q : p;
  size_t lo = 0, hi = w->project->n_curve;
  double best = INFINITY, x[3], where;
  uint32_t curve = NONE;
  int forward;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (list[mid].lo < a || (list[mid].lo == a && list[mid].hi < b))
      lo = mid + 1;
    else hi = mid;
  }
  middle(w, c, x);
  for (; lo < w->project->n_curve && list[lo].lo == a && list[lo].hi == b;
       lo++) {
    double d = along(w->project, w->project->curve + list[lo].curve, x, &where);

    if (d >= best) continue;
    best = d;
    curve = list[lo].curve;
  }
  if (curve == NONE)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the curve edges from point %u to point %u, at (%g "
                   "%g %g), do not lie on any curve of the project; the "
                   ".d3m and the .front do not belong together",
                   w->path, p + 1, q + 1, x[0], x[1], x[2]);
  forward = is_forward(w, curve, c);
  for (size_t i = 0; i + 1 < c->n; i++) {
    struct edge *e = w->edge + c->edge[i];

    e->curve = (e->a == c->point[i]) == forward ? (int32_t)curve + 1
                                                : -(int32_t)curve - 1;
  }
  return VG_OK;
}

static vg_status name_curves(struct front *w, struct vg_error *err)
{
  struct ends *list = vg_alloc(w->project->n_curve, sizeof *list);
  struct chain c = { 0, 0, 0, NULL, NULL };
  vg_status st = VG_OK;

  if (!list) return vg_fail_memory(err, "the curves of a front");
  for (size_t i = 0; i < w->project->n_curve; i++) {
    uint32_t p = w->end[i][0], q = w->end[i][1];

    list[i] = (struct ends){ p < q ? p : q, p < q ? q : p, (uint32_t)i };
  }
  qsort(list, w->project->n_curve, sizeof *list, compare_ends);
  for (size_t l = 0; l < w->n_link && st == VG_OK; l++) {
    uint32_t from = w->link[l].from;

    if (w->edge[w->link[l].edge].curve ||
        (!w->is_end[from] && degree(w, from) == 2))
      continue;
    st = follow(w, l, &c) < 0 ? vg_fail_memory(err, "a curve of a front")
                              : name_chain(w, list, &c, err);
  }
  free(list);
  free(c.point);
  free(c.edge);
  return st;
}

/* --- regions and patches by their signed curves --- */

struct signature {
  const int32_t *curve; /* [n] sorted, each once */
  size_t n;
  uint32_t owner; /* region or shape */
};

struct pair {
  uint32_t owner;
  int32_t curve;
};

static int compare_pair(const void *x, const void *y)
{
  const struct pair *p = x, *q = y;

  if (p->owner != q->owner) return p->owner < q->owner ? -1 : 1;
  return (p->curve > q->curve) - (p->curve < q->curve);
}

static int compare_signature(const void *x, const void *y)
{
  const struct signature *p = x, *q = y;

  if (p->n != q->n) return p->n < q->n ? -1 : 1;
  for (size_t i = 0; i < p->n; i++)
    if (p->curve[i] != q->curve[i]) return p->curve[i] < q->curve[i] ? -1 : 1;
  return 0;
}

static int compare_signature_owner(const void *x, const void *y)
{
  const struct signature *p = x, *q = y;
  int c = compare_signature(x, y);

  return c ? c : (p->owner > q->owner) - (p->owner < q->owner);
}

/* Convert pairs into one signature per owner, in the order of the owners. */
static void pack(struct pair *pair, size_t n_pair, int32_t *curve,
                 struct signature *s, size_t n_owner)
{
  size_t i = 0, n = 0;

  qsort(pair, n_pair, sizeof *pair, compare_pair);
  for (size_t owner = 0; owner < n_owner; owner++) {
    s[owner] = (struct signature){ curve + n, 0, (uint32_t)owner };
    for (; i < n_pair && pair[i].owner == owner; i++) {
      if (s[owner].n && curve[n - 1] == pair[i].curve) continue;
      curve[n++] = pair[i].curve;
      s[owner].n++;
    }
  }
}

struct matching {
  struct pair *pair;
  int32_t *curve[2];
  struct signature *region, *shape;
};

static void matching_release(struct matching *g)
{
  free(g->pair);
  free(g->curve[0]);
  free(g->curve[1]);
  free(g->region);
  free(g->shape);
}

static vg_status signatures(struct front *w, struct matching *g,
                            struct vg_error *err)
{
  const struct vg_project *p = w->project;
  size_t n_loop = 0, n = 0, n_max;

  for (size_t i = 0; i < p->n_shape; i++) n_loop += p->shape[i].n;
  n_max = n_loop > w->n_link ? n_loop : w->n_link;
  g->pair = vg_alloc(n_max, sizeof *g->pair);
  g->curve[0] = vg_alloc(w->n_link, sizeof **g->curve);
  g->curve[1] = vg_alloc(n_loop, sizeof **g->curve);
  g->region = vg_alloc(w->n_region, sizeof *g->region);
  g->shape = vg_alloc(p->n_shape, sizeof *g->shape);
  if (!g->pair || !g->curve[0] || !g->curve[1] || !g->region || !g->shape)
    return vg_fail_memory(err, "the patches of a front");
  for (size_t f = 0; f < w->m->n_tri; f++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = w->m->tri[f][k], b = w->m->tri[f][(k + 1) % 3];
      const struct edge *c = edge_of(w, a, b);

      /* A curve edge with three faces could exceed the space allocated. */
      if (c->curve && n < n_max)
        g->pair[n++] = (struct pair){ w->region[f],
                                      a < b ? c->curve : -c->curve };
    }
  pack(g->pair, n, g->curve[0], g->region, w->n_region);
  n = 0;
  for (size_t i = 0; i < p->n_shape; i++)
    for (size_t k = 0; k < p->shape[i].n; k++)
      g->pair[n++] = (struct pair){ (uint32_t)i, p->shape[i].curve[k] };
  pack(g->pair, n, g->curve[1], g->shape, p->n_shape);
  qsort(g->shape, p->n_shape, sizeof *g->shape, compare_signature_owner);
  return VG_OK;
}

static vg_status lost_region(const struct front *w, uint32_t region,
                             const char *why, struct vg_error *err)
{
  uint32_t f = w->seed[region];
  const double *x = w->m->point[w->m->tri[f][0]];

  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the region of face %u, at (%g %g %g), %s; the .d3m and "
                 "the .front do not belong together",
                 w->path, f + 1, x[0], x[1], x[2], why);
}

/* Find shape_of[region]; each shape may be used once. */
static vg_status match_regions(struct front *w, const struct matching *g,
                               uint32_t *shape_of, struct vg_error *err)
{
  const struct vg_project *p = w->project;
  unsigned char *taken = vg_calloc(p->n_shape, 1);
  vg_status st = VG_OK;

  if (!taken) return vg_fail_memory(err, "the patches of a front");
  for (size_t r = 0; r < w->n_region && st == VG_OK; r++) {
    const struct signature *s = bsearch(g->region + r, g->shape, p->n_shape,
                                        sizeof *g->shape, compare_signature);

    if (!s) {
      st = lost_region(w, (uint32_t)r,
                       "is bounded by curves that bound no patch of the "
                       "project",
                       err);
    } else if (taken[s->owner]) {
      st = lost_region(w, (uint32_t)r,
                       "is bounded by the curves of a patch that already "
                       "has another region",
                       err);
    } else {
      taken[s->owner] = 1;
      shape_of[r] = s->owner;
    }
  }
  for (size_t i = 0; i < p->n_shape && st == VG_OK; i++)
    if (!taken[i])
      st = vg_fail(err, VG_ERR_INPUT,
                   "%s: no face of the front lies on patch %d of the project; "
                   "the .d3m and the .front do not belong together",
                   w->path, p->shape[i].patch.id);
  free(taken);
  return st;
}

/* Create the patches from the tags, with the names and codes of the project. */
static vg_status set_patches(struct front *w, const uint32_t *shape_of,
                             struct vg_error *err)
{
  struct vg_mesh *m = w->m;
  int32_t *tag = vg_alloc(m->n_tri, sizeof *tag);
  vg_status st;

  if (!tag) return vg_fail_memory(err, "the patches of a front");
  for (size_t f = 0; f < m->n_tri; f++)
    tag[f] = shape_of ? w->project->shape[shape_of[w->region[f]]].patch.id
                      : (int32_t)w->region[f] + 1;
  st = vg_patches_from_tags(m, tag, err);
  free(tag);
  if (st < 0 || !shape_of) return st;
  for (size_t r = 0; r < w->n_region; r++)
    m->patch[m->tri_patch[w->seed[r]]] = w->project->shape[shape_of[r]].patch;
  return VG_OK;
}

static vg_status match_project(struct front *w, struct vg_error *err)
{
  struct matching g = { NULL, { NULL, NULL }, NULL, NULL };
  uint32_t *shape_of = vg_alloc(w->n_region, sizeof *shape_of);
  vg_status st = VG_OK;

  if (!shape_of) return vg_fail_memory(err, "the patches of a front");
  VG_TRY(build_links(w, err));
  VG_TRY(find_ends(w, err));
  VG_TRY(name_curves(w, err));
  VG_TRY(signatures(w, &g, err));
  VG_TRY(match_regions(w, &g, shape_of, err));
  VG_TRY(set_patches(w, shape_of, err));
done:
  matching_release(&g);
  free(shape_of);
  return st;
}

vg_status vg_front_patches(struct vg_mesh *m, size_t n_edge,
                           const uint32_t (*edge)[2],
                           const struct vg_project *project, const char *path,
                           struct vg_error *err)
{
  struct front w = { .m = m, .project = project, .path = path };
  vg_status st;

  assert(edge || !n_edge);
  VG_TRY(build_edges(&w, n_edge, edge, err));
  VG_TRY(flood(&w, err));
  if (project && project->n_shape) VG_TRY(match_project(&w, err));
  else VG_TRY(set_patches(&w, NULL, err));
done:
  vg_table_release(&w.table);
  free(w.edge);
  free(w.region);
  free(w.seed);
  free(w.link);
  free(w.end);
  free(w.is_end);
  return st;
}
