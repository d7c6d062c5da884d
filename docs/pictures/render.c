/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Draws a mesh as a PNG: the cells below the plane z = CUT, with the exposed
 * faces of the cells, and the walls (conditions 4 and 5) inside. For the
 * picture of the README: `cmake --build --preset release --target picture`,
 * then render wing.b8.ugrid wing.png 0 1400 An orthographic z-buffer with 2 x 2
 * samples per pixel; edges are drawn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/format.h"
#include "png.h"

#define SAMPLES 2

struct image {
  int width, height; /* in samples */
  float *depth;
  unsigned char (*rgb)[3];
  double right[3], up[3], toward[3]; /* orthonormal; toward: to the viewer */
  double centre[3], scale;           /* samples per length */
};

struct face {
  uint32_t node[3];
}; /* ascending */

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void unit(double v[3])
{
  double n = sqrt(dot(v, v));

  for (int k = 0; k < 3; k++) v[k] = n > 0 ? v[k] / n : 0;
}

static void look(struct image *im, const double toward[3])
{
  const double z[3] = { 0, 0, 1 };

  memcpy(im->toward, toward, sizeof im->toward);
  unit(im->toward);
  cross(z, im->toward, im->right);
  unit(im->right);
  cross(im->toward, im->right, im->up);
}

static double light(const struct image *im, const double *const p[3])
{
  double a[3], b[3], n[3], l;

  for (int k = 0; k < 3; k++) a[k] = p[1][k] - p[0][k];
  for (int k = 0; k < 3; k++) b[k] = p[2][k] - p[0][k];
  cross(a, b, n);
  unit(n);
  l = 0.4 + 0.45 * fabs(dot(n, im->toward)) + 0.25 * fabs(n[0]);
  return l < 1 ? l : 1;
}

/* Screen coordinates and depth of a point. */
static void project(const struct image *im, const double p[3], double s[3])
{
  double d[3];

  for (int k = 0; k < 3; k++) d[k] = p[k] - im->centre[k];
  s[0] = dot(d, im->right) * im->scale + im->width / 2.0;
  s[1] = im->height / 2.0 - dot(d, im->up) * im->scale;
  s[2] = dot(d, im->toward);
}

/* Shade one sample. A barycentric weight times the height over its edge is
 * the distance from that edge. */
static void sample(struct image *im, int x, int y, double s[3][3], double area,
                   const double height[3], double bright,
                   const unsigned char colour[3])
{
  size_t at = (size_t)y * (size_t)im->width + (size_t)x;
  double depth = 0, edge = 1e9;

  for (int i = 0; i < 3; i++) {
    const double *a = s[(i + 1) % 3], *b = s[(i + 2) % 3];
    double w = ((b[0] - a[0]) * (y + 0.5 - a[1]) -
                (b[1] - a[1]) * (x + 0.5 - a[0])) /
               area;

    if (w < 0) return;
    depth += w * s[i][2];
    edge = fmin(edge, w * height[i]);
  }
  if (depth <= im->depth[at]) return;
  im->depth[at] = (float)depth;
  if (edge < 0.8) bright *= 0.45;
  for (int k = 0; k < 3; k++)
    im->rgb[at][k] = (unsigned char)(colour[k] * bright);
}

static int clamp(double v, int most)
{
  return v < 0 ? 0 : v > most ? most : (int)v;
}

static void draw(struct image *im, const double *const p[3],
                 const unsigned char colour[3])
{
  double s[3][3], area, height[3], bright = light(im, p);

  for (int i = 0; i < 3; i++) project(im, p[i], s[i]);
  area = (s[1][0] - s[0][0]) * (s[2][1] - s[0][1]) -
         (s[2][0] - s[0][0]) * (s[1][1] - s[0][1]);
  if (fabs(area) < 1e-6) return;
  for (int i = 0; i < 3; i++) {
    const double *a = s[(i + 1) % 3], *b = s[(i + 2) % 3];

    height[i] = fabs(area) / hypot(b[0] - a[0], b[1] - a[1]);
    /* Edges of faces smaller than the pen would only blacken them. */
    if (height[i] < 5) height[i] *= 1e3;
  }
  for (int y = clamp(fmin(s[0][1], fmin(s[1][1], s[2][1])), im->height);
       y < clamp(fmax(s[0][1], fmax(s[1][1], s[2][1])) + 1, im->height); y++)
    for (int x = clamp(fmin(s[0][0], fmin(s[1][0], s[2][0])), im->width);
         x < clamp(fmax(s[0][0], fmax(s[1][0], s[2][0])) + 1, im->width); x++)
      sample(im, x, y, s, area, height, bright, colour);
}

static int compare_face(const void *a, const void *b)
{
  const struct face *x = a, *y = b;

  for (int k = 0; k < 3; k++)
    if (x->node[k] != y->node[k]) return x->node[k] < y->node[k] ? -1 : 1;
  return 0;
}

static struct face make_face(uint32_t a, uint32_t b, uint32_t c)
{
  uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
  struct face f = { { c < lo ? c : lo,
                      c < lo   ? lo
                      : c < hi ? c
                               : hi,
                      c < hi ? hi : c } };

  return f;
}

/* Faces that belong to exactly one of the cells below the plane. */
static size_t skin(const struct vg_mesh *m, double cut, struct face *face)
{
  size_t n = 0, kept = 0;

  for (size_t i = 0; i < m->n_tet; i++) {
    const uint32_t *t = m->tet[i];
    double z = 0;

    for (int k = 0; k < 4; k++) z += m->point[t[k]][2] / 4;
    for (int k = 0; z <= cut && k < 4; k++)
      face[n++] = make_face(t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]);
  }
  qsort(face, n, sizeof *face, compare_face);
  for (size_t i = 0; i < n; i++) {
    if (i + 1 < n && !compare_face(&face[i], &face[i + 1])) i++;
    else face[kept++] = face[i];
  }
  return kept;
}

static void draw_nodes(struct image *im, const struct vg_mesh *m,
                       const uint32_t node[3], const unsigned char colour[3])
{
  const double *p[3];

  for (int k = 0; k < 3; k++) p[k] = m->point[node[k]];
  draw(im, p, colour);
}

static int draw_mesh(struct image *im, const struct vg_mesh *m, double cut)
{
  static const unsigned char cells[3] = { 250, 232, 184 };
  static const unsigned char wall[3] = { 110, 165, 222 };
  struct face *face = vg_alloc(4 * m->n_tet, sizeof *face);
  size_t n;

  if (!face) return -1;
  n = skin(m, cut, face);
  for (size_t i = 0; i < n; i++) draw_nodes(im, m, face[i].node, cells);
  for (size_t i = 0; i < m->n_tri; i++) {
    int32_t bc = m->patch[m->tri_patch[i]].bc;

    if (bc == 4 || bc == 5) draw_nodes(im, m, m->tri[i], wall);
  }
  free(face);
  return 0;
}

/* Set centre and scale so that the bounding box of the walls just fits. */
static void aim(struct image *im, const struct vg_mesh *m)
{
  double lo[3] = { 1e300, 1e300, 1e300 }, hi[3] = { -1e300, -1e300, -1e300 };
  double width = 0, height = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    int32_t bc = m->patch[m->tri_patch[i]].bc;

    for (int k = 0; (bc == 4 || bc == 5) && k < 9; k++) {
      double v = m->point[m->tri[i][k / 3]][k % 3];

      lo[k % 3] = fmin(lo[k % 3], v);
      hi[k % 3] = fmax(hi[k % 3], v);
    }
  }
  for (int k = 0; k < 3; k++) {
    im->centre[k] = (lo[k] + hi[k]) / 2;
    width += fabs(im->right[k]) * (hi[k] - lo[k]);
    height += fabs(im->up[k]) * (hi[k] - lo[k]);
  }
  im->scale = 0.95 * fmin(im->width / width, im->height / height);
}

int main(int argc, char **argv)
{
  const double toward[3] = { 0.55, -0.75, 0.9 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct image im = { 0 };
  size_t n;
  int bad;

  if (argc < 5) {
    fprintf(stderr, "render MESH PNG CUT_Z WIDTH\n");
    return 2;
  }
  im.width = SAMPLES * atoi(argv[4]);
  im.height = im.width * 5 / 9 / SAMPLES * SAMPLES;
  n = (size_t)im.width * (size_t)im.height;
  if (vg_mesh_read(argv[1], &m, NULL, &err) < 0) {
    fprintf(stderr, "%s\n", err.text);
    return 1;
  }
  im.depth = vg_alloc(n, sizeof *im.depth);
  im.rgb = vg_alloc(n, sizeof *im.rgb);
  bad = !im.depth || !im.rgb;
  for (size_t i = 0; !bad && i < n; i++) im.depth[i] = -1e30f;
  if (!bad) memset(im.rgb, 255, n * sizeof *im.rgb);
  look(&im, toward);
  aim(&im, &m);
  bad = bad || draw_mesh(&im, &m, strtod(argv[3], NULL)) ||
        png_write(argv[2], im.width / SAMPLES, im.height / SAMPLES, SAMPLES,
                  (const unsigned char(*)[3])im.rgb);
  free(im.depth);
  free(im.rgb);
  vg_mesh_release(&m);
  return bad;
}
