/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Draws the cells that a plane cuts, for docs/reference/layers.md:
 *
 *   cut MESH PNG PLANE U V WIDTH PIXELS [LAYER_TETS]
 *
 * PLANE is x=C, y=C, z=C, or patch=ID for the faces of a boundary patch.
 * U V is the centre of the window in the two other coordinates (for a patch,
 * in all coordinates except the one with the smallest extent). WIDTH is the
 * width of the window in length units; its height is two thirds of that.
 * Prisms are blue, pyramids orange, tetrahedra pale, the first LAYER_TETS of
 * them green; walls (condition 4) are thick lines. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/format.h"
#include "png.h"

#define SAMPLES 3
#define CORNERS_MAX 12

struct window {
  int axis, u, v;          /* axis normal to the plane; axes of the picture */
  double at;               /* coordinate of the plane */
  double centre[2], scale; /* samples per length */
  int width, height;       /* in samples */
  unsigned char (*rgb)[3];
};

struct polygon {
  int n;
  double p[CORNERS_MAX][2];
};

static const unsigned char prism[3] = { 120, 178, 232 };
static const unsigned char pyramid[3] = { 246, 166, 86 };
static const unsigned char layer_tet[3] = { 150, 208, 140 };
static const unsigned char field_tet[3] = { 250, 236, 200 };
static const unsigned char ink[3] = { 40, 40, 48 };

static void to_picture(const struct window *w, double u, double v, double p[2])
{
  p[0] = (u - w->centre[0]) * w->scale + w->width / 2.0;
  p[1] = w->height / 2.0 - (v - w->centre[1]) * w->scale;
}

/* Sort the corners counter-clockwise about their mean; cells are convex. */
static void order(struct polygon *g)
{
  double c[2] = { 0, 0 }, angle[CORNERS_MAX];

  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) c[k] += g->p[i][k] / g->n;
  for (int i = 0; i < g->n; i++)
    angle[i] = atan2(g->p[i][1] - c[1], g->p[i][0] - c[0]);
  for (int i = 1; i < g->n; i++)
    for (int j = i; j > 0 && angle[j] < angle[j - 1]; j--) {
      double t = angle[j], q[2] = { g->p[j][0], g->p[j][1] };

      angle[j] = angle[j - 1];
      angle[j - 1] = t;
      memcpy(g->p[j], g->p[j - 1], sizeof q);
      memcpy(g->p[j - 1], q, sizeof q);
    }
}

static double to_segment(const double a[2], const double b[2], double x,
                         double y)
{
  double d[2] = { b[0] - a[0], b[1] - a[1] }, l = d[0] * d[0] + d[1] * d[1];
  double t = l > 0 ? ((x - a[0]) * d[0] + (y - a[1]) * d[1]) / l : 0;

  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return hypot(a[0] + t * d[0] - x, a[1] + t * d[1] - y);
}

static int clamp(double v, int most)
{
  return v < 0 ? 0 : v > most ? most : (int)v;
}

static void box_of(const struct window *w, const struct polygon *g, int lo[2],
                   int hi[2])
{
  double a[2] = { INFINITY, INFINITY }, b[2] = { -INFINITY, -INFINITY };

  for (int i = 0; i < g->n; i++)
    for (int k = 0; k < 2; k++) {
      a[k] = fmin(a[k], g->p[i][k]);
      b[k] = fmax(b[k], g->p[i][k]);
    }
  for (int k = 0; k < 2; k++) {
    lo[k] = clamp(a[k] - 2, k ? w->height : w->width);
    hi[k] = clamp(b[k] + 3, k ? w->height : w->width);
  }
}

/* Twice the area over the circumference: about the height of a flat
 * polygon. */
static double thickness(const struct polygon *g)
{
  double area = 0, around = 0;

  for (int i = 0; i < g->n; i++) {
    const double *a = g->p[i], *b = g->p[(i + 1) % g->n];

    area += a[0] * b[1] - a[1] * b[0];
    around += hypot(b[0] - a[0], b[1] - a[1]);
  }
  return around > 0 ? 2 * fabs(area) / around : 0;
}

static void fill(struct window *w, const struct polygon *g,
                 const unsigned char colour[3])
{
  /* Lines around cells thinner than the pen would only blacken them. */
  double pen = fmin(1, thickness(g) / (3 * SAMPLES));
  int lo[2], hi[2];

  box_of(w, g, lo, hi);
  for (int y = lo[1]; y < hi[1]; y++)
    for (int x = lo[0]; x < hi[0]; x++) {
      unsigned char *to = w->rgb[(size_t)y * (size_t)w->width + (size_t)x];
      double edge = INFINITY, dark;
      int left = 0, right = 0;

      for (int i = 0; i < g->n; i++) {
        const double *a = g->p[i], *b = g->p[(i + 1) % g->n];
        double s = (b[0] - a[0]) * (y + 0.5 - a[1]) -
                   (b[1] - a[1]) * (x + 0.5 - a[0]);

        left |= s > 0;
        right |= s < 0;
        edge = fmin(edge, to_segment(a, b, x + 0.5, y + 0.5));
      }
      if (left && right) continue;
      dark = edge < 0.3 * SAMPLES ? pen : 0;
      for (int k = 0; k < 3; k++)
        to[k] = (unsigned char)(colour[k] + dark * (ink[k] - colour[k]));
    }
}

static void line(struct window *w, const double a[2], const double b[2],
                 double half)
{
  struct polygon g = { .n = 2 };
  int lo[2], hi[2];

  memcpy(g.p[0], a, sizeof g.p[0]);
  memcpy(g.p[1], b, sizeof g.p[1]);
  box_of(w, &g, lo, hi);
  for (int y = lo[1]; y < hi[1]; y++)
    for (int x = lo[0]; x < hi[0]; x++)
      if (to_segment(a, b, x + 0.5, y + 0.5) < half)
        memcpy(w->rgb[(size_t)y * (size_t)w->width + (size_t)x], ink, 3);
}

/* Intersections of the edges of a cell with the plane; a node in the plane
 * counts as above it. */
static void cut(const struct window *w, const struct vg_mesh *m,
                const uint32_t *node, const int (*edge)[2], int n_edge,
                struct polygon *g)
{
  g->n = 0;
  for (int e = 0; e < n_edge; e++) {
    const double *a = m->point[node[edge[e][0]]];
    const double *b = m->point[node[edge[e][1]]];
    double s = a[w->axis] - w->at, t = b[w->axis] - w->at, f;

    if ((s >= 0) == (t >= 0)) continue;
    f = s / (s - t);
    to_picture(w, a[w->u] + f * (b[w->u] - a[w->u]),
               a[w->v] + f * (b[w->v] - a[w->v]), g->p[g->n++]);
  }
}

static void draw_cells(struct window *w, const struct vg_mesh *m,
                       const uint32_t *node, size_t n, int width,
                       const int (*edge)[2], int n_edge,
                       const unsigned char colour[3])
{
  for (size_t i = 0; i < n; i++) {
    struct polygon g;

    cut(w, m, node + i * (size_t)width, edge, n_edge, &g);
    if (g.n < 3) continue;
    order(&g);
    fill(w, &g, colour);
  }
}

static void draw_cut(struct window *w, const struct vg_mesh *m, size_t layers)
{
  static const int tet[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                 { 1, 2 }, { 1, 3 }, { 2, 3 } };
  static const int pyr[8][2] = { { 0, 3 }, { 3, 4 }, { 4, 1 }, { 1, 0 },
                                 { 0, 2 }, { 1, 2 }, { 3, 2 }, { 4, 2 } };
  static const int pri[9][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 },
                                 { 3, 4 }, { 4, 5 }, { 5, 3 },
                                 { 0, 3 }, { 1, 4 }, { 2, 5 } };
  static const int tri[3][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 } };

  draw_cells(w, m, m->tet[layers], m->n_tet - layers, 4, tet, 6, field_tet);
  draw_cells(w, m, m->tet[0], layers, 4, tet, 6, layer_tet);
  if (m->n_pyr) draw_cells(w, m, m->pyr[0], m->n_pyr, 5, pyr, 8, pyramid);
  if (m->n_pri) draw_cells(w, m, m->pri[0], m->n_pri, 6, pri, 9, prism);
  for (size_t i = 0; i < m->n_tri; i++) {
    struct polygon g;

    if (m->patch[m->tri_patch[i]].bc != 4) continue;
    cut(w, m, m->tri[i], tri, 3, &g);
    if (g.n == 2) line(w, g.p[0], g.p[1], 0.8 * SAMPLES);
  }
}

static void draw_face(struct window *w, const struct vg_mesh *m,
                      const uint32_t *node, int n,
                      const unsigned char colour[3])
{
  struct polygon g = { .n = n };

  for (int i = 0; i < n; i++)
    to_picture(w, m->point[node[i]][w->u], m->point[node[i]][w->v], g.p[i]);
  fill(w, &g, colour);
}

static int draw_patch(struct window *w, const struct vg_mesh *m, int32_t id)
{
  size_t p = vg_mesh_find_patch(m, id);

  if (p == SIZE_MAX) return -1;
  for (size_t i = 0; i < m->n_tri; i++)
    if (m->tri_patch[i] == p) draw_face(w, m, m->tri[i], 3, field_tet);
  for (size_t i = 0; i < m->n_quad; i++)
    if (m->quad_patch[i] == p) draw_face(w, m, m->quad[i], 4, prism);
  return 0;
}

/* The axis along which a patch has the smallest extent. */
static int flat_axis(const struct vg_mesh *m, int32_t id)
{
  size_t p = vg_mesh_find_patch(m, id);
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };
  int best = 0;

  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 9 && m->tri_patch[i] == p; k++) {
      double v = m->point[m->tri[i][k / 3]][k % 3];

      lo[k % 3] = fmin(lo[k % 3], v);
      hi[k % 3] = fmax(hi[k % 3], v);
    }
  for (int k = 1; k < 3; k++)
    if (hi[k] - lo[k] < hi[best] - lo[best]) best = k;
  return best;
}

static int render(struct window *w, const struct vg_mesh *m, char **argv,
                  size_t layers)
{
  const char *plane = argv[3];
  int is_patch = !strncmp(plane, "patch=", 6);
  size_t n;

  w->axis = is_patch ? flat_axis(m, atoi(plane + 6)) : *plane - 'x';
  w->at = is_patch ? 0 : strtod(plane + 2, NULL);
  w->u = w->axis == 0 ? 1 : 0;
  w->v = w->axis == 2 ? 1 : 2;
  for (int k = 0; k < 2; k++) w->centre[k] = strtod(argv[4 + k], NULL);
  w->width = SAMPLES * atoi(argv[7]);
  w->height = w->width * 2 / 3 / SAMPLES * SAMPLES;
  w->scale = w->width / strtod(argv[6], NULL);
  n = (size_t)w->width * (size_t)w->height;
  w->rgb = vg_alloc(n, sizeof *w->rgb);
  if (!w->rgb) return 1;
  memset(w->rgb, 255, n * sizeof *w->rgb);
  if (!is_patch) draw_cut(w, m, layers);
  else if (draw_patch(w, m, atoi(plane + 6))) return 1;
  return png_write(argv[2], w->width / SAMPLES, w->height / SAMPLES, SAMPLES,
                   (const unsigned char(*)[3])w->rgb);
}

int main(int argc, char **argv)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct window w = { .rgb = NULL };
  size_t layers = argc > 8 ? strtoull(argv[8], NULL, 10) : 0;
  int bad;

  if (argc < 8 || atoi(argv[7]) < 1 || !strchr("xyzp", argv[3][0])) {
    fprintf(stderr, "cut MESH PNG x=C|y=C|z=C|patch=ID U V WIDTH PIXELS "
                    "[LAYER_TETS]\n");
    return 2;
  }
  if (vg_mesh_read(argv[1], &m, NULL, &err) < 0) {
    fprintf(stderr, "%s\n", err.text);
    return 1;
  }
  bad = layers > m.n_tet || render(&w, &m, argv, layers);
  if (bad) fprintf(stderr, "%s: no picture\n", argv[2]);
  free(w.rgb);
  vg_mesh_release(&m);
  return bad;
}
