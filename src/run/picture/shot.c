/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/shot.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"

enum { SAMPLES = 2, BAND = 60 };
#define PEN                                                                    \
  0.9 /* Distance from an edge, in samples, that the edge darkens.             \
       */

/* The light of a sample: brightness of the face up to 63, darkness of an
 * edge. */
enum { LIGHT_FULL = 63, EDGE_DARK = 3 };
#define SMALL 3.0  /* Triangles lower than this have no edges, ... */
#define LARGE 12.0 /* ... and those higher than this have black edges. */

/* --- camera -------------------------------------------------------------- */

void vg_camera_aim(const struct vg_mesh *m, const uint8_t *is_seen,
                   const double toward[3], int width, int height,
                   struct vg_camera *c)
{
  const double z[3] = { 0, 0, 1 };
  double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
  double middle[2], extent[2];

  assert(width > 0 && height > 0 && (toward[0] != 0 || toward[1] != 0));
  memset(c, 0, sizeof *c);
  c->width = width;
  c->height = height;
  memcpy(c->toward, toward, sizeof c->toward);
  vg_unit(c->toward);
  vg_cross(z, c->toward, c->right);
  vg_unit(c->right);
  vg_cross(c->toward, c->right, c->up);
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3 && is_seen[i]; k++) {
      const double *x = m->point[m->tri[i][k]];
      double at[2] = { vg_dot(x, c->right), vg_dot(x, c->up) };

      for (int j = 0; j < 2; j++) {
        lo[j] = fmin(lo[j], at[j]);
        hi[j] = fmax(hi[j], at[j]);
      }
    }
  for (int j = 0; j < 2; j++) {
    middle[j] = lo[j] <= hi[j] ? (lo[j] + hi[j]) / 2 : 0;
    extent[j] = hi[j] > lo[j] ? hi[j] - lo[j] : 1e-300;
  }
  for (int k = 0; k < 3; k++)
    c->centre[k] = middle[0] * c->right[k] + middle[1] * c->up[k];
  c->scale = 0.94 * fmin(width / extent[0], height / extent[1]);
}

void vg_camera_see(const struct vg_camera *c, const double x[3], double out[3])
{
  double d[3];

  vg_sub(x, c->centre, d);
  out[0] = vg_dot(d, c->right) * c->scale + c->width / 2.0;
  out[1] = c->height / 2.0 - vg_dot(d, c->up) * c->scale;
  out[2] = vg_dot(d, c->toward) * c->scale;
}

/* --- drawing ------------------------------------------------------------- */

struct drawing {
  const struct vg_mesh *m;
  const uint8_t *is_seen;
  const struct vg_camera *camera;
  struct vg_shot *s;
  float *depth;
  double (*at)[3];    /* [n_point] positions in samples. */
  uint16_t (*row)[2]; /* [n_tri] rows from .. to - 1; empty if not visible. */
};

static void place(void *context, size_t first, size_t end, int worker)
{
  const struct drawing *d = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    vg_camera_see(d->camera, d->m->point[i], d->at[i]);
    for (int k = 0; k < 3; k++) d->at[i][k] *= SAMPLES;
  }
}

/* A lamp at the eye and one above it. */
static double brightness(const struct drawing *d, const uint32_t *t)
{
  const double *o = d->m->point[t[0]];
  double a[3], b[3], n[3], l;

  vg_sub(d->m->point[t[1]], o, a);
  vg_sub(d->m->point[t[2]], o, b);
  vg_cross(a, b, n);
  vg_unit(n);
  l = 0.5 + 0.44 * fabs(vg_dot(n, d->camera->toward)) +
      0.14 * fabs(vg_dot(n, d->camera->up));
  return l > 1 ? 1 : l;
}

/* Linear functions of the position that are 0 on an edge and 1 at the opposite
 * corner. */
struct plane {
  double a[3], b[3], c[3], height[3];
  int bright, pen;
};

static double area_of(const struct drawing *d, size_t t)
{
  const uint32_t *node = d->m->tri[t];
  const double *s[3] = { d->at[node[0]], d->at[node[1]], d->at[node[2]] };

  return (s[1][0] - s[0][0]) * (s[2][1] - s[0][1]) -
         (s[2][0] - s[0][0]) * (s[1][1] - s[0][1]);
}

static void find_plane(const struct drawing *d, size_t t, struct plane *p)
{
  const uint32_t *node = d->m->tri[t];
  const double *s[3] = { d->at[node[0]], d->at[node[1]], d->at[node[2]] };
  double low = INFINITY, area = area_of(d, t);

  for (int i = 0; i < 3; i++) {
    const double *u = s[(i + 1) % 3], *v = s[(i + 2) % 3];
    double dx = v[0] - u[0], dy = v[1] - u[1];
    double length = sqrt(dx * dx + dy * dy);

    p->a[i] = -dy / area;
    p->b[i] = dx / area;
    p->c[i] = (dy * u[0] - dx * u[1]) / area;
    p->height[i] = -area / length;
    low = fmin(low, p->height[i]);
  }
  low = (low - SMALL) / (LARGE - SMALL);
  p->pen = low < 0 ? 0 : low < 1 ? (int)(low * EDGE_DARK + 0.5) : EDGE_DARK;
  p->bright = (int)(LIGHT_FULL * brightness(d, node) + 0.5);
}

static double least(double a, double b)
{
  return a < b ? a : b;
}
static double most(double a, double b)
{
  return a > b ? a : b;
}

static void sample(const struct drawing *d, size_t t, const struct plane *p,
                   int x, int y)
{
  size_t to = (size_t)y * (size_t)d->s->width + (size_t)x;
  double depth = 0, edge = INFINITY;

  for (int i = 0; i < 3; i++) {
    double w = p->a[i] * (x + 0.5) + p->b[i] * (y + 0.5) + p->c[i];

    if (w < 0) return;
    depth += w * d->at[d->m->tri[t][i]][2];
    edge = least(edge, w * p->height[i]);
  }
  if (!((float)depth > d->depth[to])) return;
  d->depth[to] = (float)depth;
  d->s->tri[to] = (uint32_t)t;
  d->s->light[to] = (uint8_t)(p->bright << 2 | (edge < PEN ? p->pen : 0));
}

static int whole(double v, int from, int to)
{
  return v < from ? from : v > to ? to : (int)v;
}

/* From the first sample whose centre is beyond lo to the last one before hi. */
static void between(double lo, double hi, int all, int *from, int *to)
{
  *from = whole(ceil(lo - 0.5), 0, all);
  *to = whole(floor(hi + 0.5), 0, all);
}

static void find_rows(void *context, size_t first, size_t end, int worker)
{
  const struct drawing *d = context;

  (void)worker;
  for (size_t t = first; t < end; t++) {
    const uint32_t *n = d->m->tri[t];
    const double *a = d->at[n[0]], *b = d->at[n[1]], *c = d->at[n[2]];
    int from = 0, to = 0;

    /* y points down, so front faces are clockwise. */
    if (d->is_seen[t] && area_of(d, t) < -1e-9)
      between(least(a[1], least(b[1], c[1])), most(a[1], most(b[1], c[1])),
              d->s->height, &from, &to);
    d->row[t][0] = (uint16_t)from;
    d->row[t][1] = (uint16_t)to;
  }
}

/* Draws the rows of a band, with all triangles in order: of two that are
 * equally near, the first stays. */
static void draw(void *context, size_t first, size_t end, int worker)
{
  const struct drawing *d = context;
  struct plane p;

  (void)worker;
  for (size_t t = 0; t < d->m->n_tri; t++) {
    const uint32_t *n = d->m->tri[t];
    const double *a = d->at[n[0]], *b = d->at[n[1]], *c = d->at[n[2]];
    int y = d->row[t][0], to = d->row[t][1], left, right;

    if (y < (int)first) y = (int)first;
    if (to > (int)end) to = (int)end;
    if (y >= to) continue;
    between(least(a[0], least(b[0], c[0])), most(a[0], most(b[0], c[0])),
            d->s->width, &left, &right);
    if (left >= right) continue;
    find_plane(d, t, &p);
    for (; y < to; y++)
      for (int x = left; x < right; x++) sample(d, t, &p, x, y);
  }
}

vg_status vg_shot_take(const struct vg_mesh *m, const uint8_t *is_seen,
                       const struct vg_camera *c, int threads,
                       struct vg_shot *s, struct vg_error *err)
{
  int width = SAMPLES * c->width, height = SAMPLES * c->height;
  size_t n = (size_t)width * (size_t)height;
  struct vg_shot made = { width, height, vg_alloc(n, sizeof *made.tri),
                          vg_calloc(n, 1) };
  struct drawing d = { m,
                       is_seen,
                       c,
                       &made,
                       vg_alloc(n, sizeof *d.depth),
                       vg_alloc(m->n_point, sizeof *d.at),
                       vg_alloc(m->n_tri, sizeof *d.row) };
  vg_status st = VG_OK;

  assert(!s->tri && !s->light && (is_seen || !m->n_tri));
  if (made.tri && made.light && d.depth && d.at && d.row) {
    memset(made.tri, 255, n * sizeof *made.tri);
    for (size_t i = 0; i < n; i++) d.depth[i] = -INFINITY;
    vg_parallel_for(threads, m->n_point, 4096, place, &d);
    vg_parallel_for(threads, m->n_tri, 4096, find_rows, &d);
    vg_parallel_for(threads, (size_t)height, BAND, draw, &d);
    *s = made;
  } else {
    vg_shot_release(&made);
    st = vg_fail_memory(err, "a picture of the surface");
  }
  free(d.depth);
  free(d.at);
  free(d.row);
  return st;
}

void vg_shot_release(struct vg_shot *s)
{
  free(s->tri);
  free(s->light);
  *s = (struct vg_shot)VG_SHOT_INIT;
}

/* Sums over samples: colour times brightness. */
struct sum {
  int rgb[3], n;
};

static struct sum shaded(const uint8_t *rgb, int light, int is_behind)
{
  int bright = is_behind ? LIGHT_FULL : light >> 2;
  int edge = is_behind ? 12 - (light & 3) : 12 - 2 * (light & 3);
  struct sum s = { .n = 1 };

  for (int k = 0; k < 3; k++)
    s.rgb[k] = rgb[k] * bright * edge / (12 * LIGHT_FULL);
  return s;
}

/* A row of pixels. Neighbouring samples mostly have the same triangle and
 * light. */
static void pixels(const struct vg_shot *s, int y, const uint8_t *colour,
                   const uint8_t (*palette)[3], uint8_t (*to)[4])
{
  struct sum last = { .n = 0 };
  uint32_t tri = VG_SHOT_NOTHING;
  int light = -1;

  for (int x = 0; x < s->width / SAMPLES; x++) {
    struct sum sum = { .n = 0 };

    for (int j = 0; j < SAMPLES * SAMPLES; j++) {
      size_t at = (size_t)(SAMPLES * y + j / SAMPLES) * (size_t)s->width +
                  (size_t)(SAMPLES * x + j % SAMPLES);

      if (s->tri[at] == VG_SHOT_NOTHING) continue;
      if (s->tri[at] != tri || s->light[at] != light) {
        tri = s->tri[at];
        light = s->light[at];
        last = shaded(palette[colour[tri]], light,
                      colour[tri] == VG_SHOT_BEHIND);
      }
      for (int k = 0; k < 3; k++) sum.rgb[k] += last.rgb[k];
      sum.n++;
    }
    for (int k = 0; k < 3 && sum.n; k++)
      to[x][k] = (uint8_t)(sum.rgb[k] / sum.n);
    to[x][3] = (uint8_t)(255 * sum.n / (SAMPLES * SAMPLES));
  }
}

vg_status vg_shot_image(const struct vg_shot *s, const uint8_t *colour,
                        const uint8_t (*palette)[3], struct vg_image *out,
                        struct vg_error *err)
{
  vg_status st = vg_image_new(s->width / SAMPLES, s->height / SAMPLES, out,
                              err);

  for (int y = 0; y < out->height && st >= 0; y++)
    pixels(s, y, colour, palette, out->rgba + (size_t)y * (size_t)out->width);
  return st;
}
