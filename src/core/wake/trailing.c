/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/wake/trailing.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"

/* W1: cosines and limits of a trailing edge. */
#define SIDE_EDGE 0.9659    /* 15 degrees between edge and stream */
#define SHARP 0.5           /* 60 degrees inside the body */
#define UPSTREAM (-0.5)     /* 60 degrees between a face and the stream */
#define BASE 0.7071         /* 45 degrees between a base and the stream */
#define PARALLEL 0.7071     /* 45 degrees between the edges of a base */
#define CREASE (-0.866)     /* 150 degrees between faces */
#define THICKNESS_MOST 0.05 /* of the chord */

#define NONE UINT32_MAX

struct finder {
  const struct vg_mesh *m;
  const uint32_t (*tri)[3];
  const uint8_t *is_body;
  const double *flow;
  struct vg_edges edges;
  uint32_t *shell; /* [n_tri] owned */
  int8_t *side;    /* [n_tri] owned; 1: the triangle faces the fluid, -1: it
                      faces the body */
  uint32_t n_shell;
};

static const double *corner(const struct finder *f, uint32_t half)
{
  return f->m->point[vg_half_from(f->tri, half)];
}

static int is_body(const struct finder *f, uint32_t half)
{
  return f->is_body[f->m->tri_patch[half / 3]];
}

/* The other half-edge of a manifold edge, NONE at others. */
static uint32_t mate(const struct finder *f, uint32_t half)
{
  const uint32_t e = f->edges.of_half[half];
  const uint32_t *h = vg_edges_at(&f->edges, e);

  if (vg_edges_count(&f->edges, e) != 2) return NONE;
  return h[h[0] == half];
}

/* --- sides of the shells ------------------------------------------------- */

/* Give the triangles connected with t the orientation of t. stack: [n_tri]
 * scratch. */
static void flood(struct finder *f, uint32_t t, uint32_t *stack)
{
  size_t top = 0;

  f->shell[t] = f->n_shell;
  f->side[t] = 1;
  stack[top++] = t;
  while (top) {
    const uint32_t at = stack[--top];

    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t h = 3 * at + k, o = mate(f, h);

      if (o == NONE || f->side[o / 3]) continue;
      f->shell[o / 3] = f->n_shell;
      f->side[o / 3] = vg_half_from(f->tri, h) == vg_half_from(f->tri, o)
                       ? (int8_t)-f->side[at]
                       : f->side[at];
      stack[top++] = o / 3;
    }
  }
  f->n_shell++;
}

struct shell {
  double origin[3], n_open; /* mean of the points of its open edges */
  double volume;            /* six times that between origin and triangles */
  int has_other;            /* 1: patches that are no body */
};

/* The volume of a shell that is cut open at a plane has its sign if the origin
 * is in that plane. */
static void measure(const struct finder *f, struct shell *s)
{
  for (uint32_t h = 0; h < 3 * f->m->n_tri; h++) {
    struct shell *at = s + f->shell[h / 3];

    at->has_other |= !is_body(f, h);
    if (vg_edges_count(&f->edges, f->edges.of_half[h]) != 1) continue;
    at->n_open++;
    for (int k = 0; k < 3; k++) at->origin[k] += corner(f, h)[k];
  }
  for (uint32_t i = 0; i < f->n_shell; i++)
    for (int k = 0; k < 3 && s[i].n_open > 0; k++)
      s[i].origin[k] /= s[i].n_open;
  for (uint32_t t = 0; t < f->m->n_tri; t++) {
    struct shell *at = s + f->shell[t];

    at->volume += f->side[t] * vg_det(at->origin, corner(f, 3 * t),
                                      corner(f, 3 * t + 1),
                                      corner(f, 3 * t + 2));
  }
}

static vg_status find_sides(struct finder *f, int is_internal,
                            struct vg_error *err)
{
  const size_t n = f->m->n_tri;
  uint32_t *stack = vg_alloc(n, sizeof *stack);
  struct shell *s = NULL;
  vg_status st = VG_OK;

  f->shell = vg_alloc(n, sizeof *f->shell);
  f->side = vg_calloc(n, sizeof *f->side);
  if (!stack || !f->shell || !f->side) {
    st = vg_fail_memory(err, "the trailing edges");
    goto done;
  }
  for (uint32_t t = 0; t < n; t++)
    if (!f->side[t]) flood(f, t, stack);
  s = vg_calloc(f->n_shell, sizeof *s);
  if (!s) {
    st = vg_fail_memory(err, "the trailing edges");
    goto done;
  }
  measure(f, s);
  for (uint32_t i = 0; i < f->n_shell; i++) is_internal &= !s[i].has_other;
  for (size_t t = 0; t < n; t++) {
    const struct shell *at = s + f->shell[t];

    /* The volume is positive if the triangles point out of the shell. */
    if ((at->volume < 0) != (at->has_other || is_internal))
      f->side[t] = (int8_t)-f->side[t];
  }
done:
  free(stack);
  free(s);
  return st;
}

/* --- sections ------------------------------------------------------------ */

struct section {
  double at[3], normal[3]; /* plane */
  double far;              /* largest distance from `at` so far */
};

static double height(const struct section *s, const double x[3])
{
  double d[3];

  vg_sub(x, s->at, d);
  return vg_dot(d, s->normal);
}

/* The half-edge by which the section leaves the triangle of h, which it enters
 * through h; a point on the plane counts as above. */
static uint32_t leave(const struct finder *f, const struct section *s,
                      uint32_t h)
{
  const uint32_t next = vg_half_next(h), prev = vg_half_prev(h);
  const int from = height(s, corner(f, h)) >= 0;
  const int third = height(s, corner(f, prev)) >= 0;

  return third == from ? next : prev;
}

/* Distance of the point where the plane crosses h from the section's middle. */
static double reach(const struct finder *f, const struct section *s, uint32_t h)
{
  const double *a = corner(f, h), *b = corner(f, vg_half_next(h));
  const double ha = height(s, a), hb = height(s, b);
  const double t = ha != hb ? ha / (ha - hb) : 0.5;
  double x[3];

  for (int k = 0; k < 3; k++) x[k] = a[k] + t * (b[k] - a[k]);
  return vg_distance(x, s->at);
}

/* Is the edge of h convex, with less than 150 degrees inside the body? */
static int is_crease(const struct finder *f, uint32_t h, uint32_t o);

/* Follow the section from the triangle of h on, to the edge of h, or to where
 * the body ends or, if to_crease is set, to a convex edge. Returns the
 * half-edge by which the section leaves its last triangle, NONE if it does not
 * come to such an end. */
static uint32_t follow(const struct finder *f, struct section *s, uint32_t h,
                       int to_crease)
{
  const uint32_t first = f->edges.of_half[h];

  for (size_t n = 0; n < f->m->n_tri; n++) {
    const uint32_t out = leave(f, s, h);

    s->far = fmax(s->far, reach(f, s, out));
    h = mate(f, out);
    if (h == NONE || !is_body(f, h) || f->edges.of_half[h] == first) return out;
    if (to_crease && is_crease(f, out, h)) return out;
  }
  return NONE;
}

/* --- edges --------------------------------------------------------------- */

/* Unit normal of the triangle of h into the fluid, and the unit direction from
 * its edge into the triangle. Returns 0 for a triangle without area. */
static int directions(const struct finder *f, uint32_t h, double n[3],
                      double in[3])
{
  const double *a = corner(f, h), *b = corner(f, vg_half_next(h));
  double t[3], w[3];

  vg_sub(b, a, t);
  vg_sub(corner(f, vg_half_prev(h)), a, w);
  vg_cross(t, w, n);
  if (!(vg_unit(n) > 0)) return 0;
  vg_cross(n, t, in);
  vg_unit(in);
  for (int k = 0; k < 3; k++) n[k] *= f->side[h / 3];
  return 1;
}

static int is_crease(const struct finder *f, uint32_t h, uint32_t o)
{
  double n[2][3], in[2][3];

  return directions(f, h, n[0], in[0]) && directions(f, o, n[1], in[1]) &&
         vg_dot(n[0], in[1]) < 0 && vg_dot(in[0], in[1]) > CREASE;
}

/* Plane of the section through the middle of the edge. */
static void lay_section(const struct finder *f, uint32_t h, const double t[3],
                        struct section *s)
{
  const double *a = corner(f, h), *b = corner(f, vg_half_next(h));
  const double along = vg_dot(t, f->flow);

  for (int k = 0; k < 3; k++) {
    s->at[k] = 0.5 * (a[k] + b[k]);
    s->normal[k] = t[k] - along * f->flow[k];
  }
  vg_unit(s->normal);
  s->far = 0;
}

/* The wall whose section has the chord, and the base of a blunt edge. */
struct kind {
  uint32_t wall, base;
};

/* Classify the edge of the half-edges h and o. */
static int is_trailing(const struct finder *f, uint32_t h, uint32_t o,
                       const double t[3], struct kind *kind)
{
  const uint32_t half[2] = { h, o };
  double n[2][3], in[2][3], up[3], along = vg_dot(t, f->flow);

  if (fabs(along) > SIDE_EDGE) return 0;
  if (!directions(f, h, n[0], in[0]) || !directions(f, o, n[1], in[1]))
    return 0;
  if (!(vg_dot(n[0], in[1]) < 0 && vg_dot(in[0], in[1]) > CREASE)) return 0;
  for (int k = 0; k < 3; k++) up[k] = f->flow[k] - along * t[k];
  vg_unit(up);
  *kind = (struct kind){ h, NONE };
  if (vg_dot(in[0], in[1]) >= SHARP && vg_dot(in[0], up) < UPSTREAM &&
      vg_dot(in[1], up) < UPSTREAM)
    return 1;
  for (int k = 0; k < 2; k++)
    if (vg_dot(n[k], up) > BASE && vg_dot(in[1 - k], up) < UPSTREAM) {
      *kind = (struct kind){ half[1 - k], half[k] };
      return 1;
    }
  return 0;
}

static vg_status add(const struct finder *f, uint32_t h, uint32_t o,
                     double chord, double thickness, struct vg_trailing *to,
                     struct vg_error *err)
{
  const uint32_t a = vg_half_from(f->tri, h), b = vg_half_to(f->tri, h);

  if (vg_reserve(&to->edge, &to->cap, to->n + 1, sizeof *to->edge))
    return vg_fail_memory(err, "the trailing edges");
  to->edge[to->n++] = (struct vg_trailing_edge){
    { a < b ? a : b, a < b ? b : a },
    { f->m->tri_patch[h / 3], f->m->tri_patch[o / 3] },
    chord,
    thickness
  };
  return VG_OK;
}

/* Follow the section across a base. The edge at the other side must be about
 * parallel, unlike that at the end of a wing. */
static int crosses_base(const struct finder *f, struct section *s,
                        uint32_t base, const double t[3])
{
  const uint32_t out = follow(f, s, base, 1);
  double far[3];

  if (out == NONE) return 0;
  vg_sub(corner(f, vg_half_next(out)), corner(f, out), far);
  vg_unit(far);
  return fabs(vg_dot(far, t)) > PARALLEL;
}

static vg_status take_edge(const struct finder *f, size_t e,
                           struct vg_trailing *to, struct vg_error *err)
{
  const uint32_t h = vg_edges_at(&f->edges, e)[0];
  const uint32_t o = vg_edges_count(&f->edges, e) == 2 ? mate(f, h) : NONE;
  struct section s;
  struct kind kind;
  double t[3], thickness = 0;

  if (o == NONE || !is_body(f, h) || !is_body(f, o)) return VG_OK;
  vg_sub(corner(f, vg_half_next(h)), corner(f, h), t);
  if (!(vg_unit(t) > 0)) return VG_OK;
  if (!is_trailing(f, h, o, t, &kind)) return VG_OK;
  lay_section(f, h, t, &s);
  if (kind.base != NONE) {
    if (!crosses_base(f, &s, kind.base, t)) return VG_OK;
    thickness = s.far;
    s.far = 0;
  }
  if (follow(f, &s, kind.wall, 0) == NONE || !(s.far > 0)) return VG_OK;
  if (thickness > THICKNESS_MOST * s.far) return VG_OK;
  return add(f, h, o, s.far, thickness, to, err);
}

vg_status vg_trailing_find(const struct vg_mesh *m, const uint8_t *is_body,
                           int is_internal, const double flow[3],
                           struct vg_trailing *out, struct vg_error *err)
{
  struct finder f = { .m = m,
                      .tri = (const uint32_t(*)[3])m->tri,
                      .is_body = is_body,
                      .flow = flow,
                      .edges = VG_EDGES_INIT };
  struct vg_trailing found = VG_TRAILING_INIT;
  vg_status st;

  assert(!out->n && fabs(vg_norm(flow) - 1) < 1e-6);
  st = vg_edges_build(&f.edges, m->n_point, m->n_tri, f.tri, NULL, 0, err);
  if (st >= 0) st = find_sides(&f, is_internal, err);
  for (size_t e = 0; e < f.edges.n && st >= 0; e++)
    st = take_edge(&f, e, &found, err);
  vg_edges_release(&f.edges);
  free(f.shell);
  free(f.side);
  if (st < 0) vg_trailing_release(&found);
  else *out = found;
  return st;
}

void vg_trailing_release(struct vg_trailing *t)
{
  free(t->edge);
  memset(t, 0, sizeof *t);
}
