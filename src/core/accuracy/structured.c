/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Structured meshes of hexahedra for comparison. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/accuracy/accuracy_parts.h"

/* Largest numbers of spacings along and across the plate and across the
 * cylinder: more of them would not change the errors, which do not vary there.
 * The number around the cylinder has no limit, since its facets are as long as
 * those of the judged mesh. */
enum { MOST_ALONG = 64, CYLINDER_ACROSS = 8, MOST_LEVELS = 4096 };

/* Levels beyond the layers, so that their last cells are not at the boundary */
enum { LEVELS_BEYOND = 2 };

struct block {
  size_t n[3];          /* cells along, across, and above the wall */
  double step;          /* spacing along the wall */
  double radius;        /* of the cylinder; 0: plate */
  const double *height; /* [n[2] + 1] of the levels */
};

/* Sum of n heights that begin with `first` and grow. */
static double sum_of(double first, double growth, size_t n)
{
  double sum = 0;

  for (size_t i = 0; i < n; i++, first *= growth) sum += first;
  return sum;
}

/* The growth with which n heights add up to `total`; at least 1. */
static double growth_for(double first, double total, size_t n)
{
  double lo = 1, hi = 2;

  if (sum_of(first, 1, n) >= total || n < 2) return 1;
  while (sum_of(first, hi, n) < total) hi *= 2;
  for (int i = 0; i < 100; i++) {
    double mid = 0.5 * (lo + hi);

    if (sum_of(first, mid, n) < total) lo = mid;
    else hi = mid;
  }
  return lo;
}

static uint32_t node_at(const struct block *b, size_t i, size_t j, size_t k)
{
  size_t around = b->radius > 0 ? b->n[0] : b->n[0] + 1;

  return (uint32_t)((k * (b->n[1] + 1) + j) * around + i % around);
}

static void put_points(const struct block *b, struct vg_mesh *m)
{
  const size_t around = b->radius > 0 ? b->n[0] : b->n[0] + 1;
  const double turn = 6.283185307179586477 / (double)b->n[0];

  for (size_t k = 0; k <= b->n[2]; k++)
    for (size_t j = 0; j <= b->n[1]; j++)
      for (size_t i = 0; i < around; i++) {
        double *x = m->point[node_at(b, i, j, k)], r = b->radius + b->height[k];

        x[0] = b->radius > 0 ? r * cos(turn * (double)i) : b->step * (double)i;
        x[1] = b->step * (double)j;
        x[2] = b->radius > 0 ? -r * sin(turn * (double)i) : b->height[k];
      }
}

static void put_quad(struct vg_mesh *m, const uint32_t *hex, const int at[4],
                     uint32_t patch)
{
  for (int c = 0; c < 4; c++) m->quad[m->n_quad][c] = hex[at[c]];
  m->quad_patch[m->n_quad++] = patch;
}

/* Boundary faces point into the cells. Patch 0 is the wall. */
static void put_faces(const struct block *b, struct vg_mesh *m, size_t i,
                      size_t j, size_t k, const uint32_t *hex)
{
  static const int face[6][4] = { { 0, 3, 7, 4 }, { 1, 5, 6, 2 },
                                  { 0, 4, 5, 1 }, { 2, 6, 7, 3 },
                                  { 0, 1, 2, 3 }, { 4, 7, 6, 5 } };
  const size_t at[3] = { i, j, k };

  for (int f = 0; f < 6; f++) {
    int axis = f / 2;

    if (axis == 0 && b->radius > 0) continue;
    if (at[axis] == (f % 2 ? b->n[axis] - 1 : 0))
      put_quad(m, hex, face[f], f != 4);
  }
}

static vg_status make_mesh(const struct block *b, struct vg_mesh *m,
                           struct vg_error *err)
{
  const size_t *n = b->n, around = b->radius > 0 ? n[0] : n[0] + 1;
  const size_t n_hex = n[0] * n[1] * n[2];
  const size_t n_quad = 2 * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0]);

  m->point = vg_alloc(around * (n[1] + 1) * (n[2] + 1), sizeof *m->point);
  m->hex = vg_alloc(n_hex, sizeof *m->hex);
  m->quad = vg_alloc(n_quad, sizeof *m->quad);
  m->quad_patch = vg_alloc(n_quad, sizeof *m->quad_patch);
  m->patch = vg_calloc(2, sizeof *m->patch);
  if (!m->point || !m->hex || !m->quad || !m->quad_patch || !m->patch)
    return vg_fail_memory(err, "the structured mesh for comparison");
  m->n_point = around * (n[1] + 1) * (n[2] + 1);
  m->n_patch = 2;
  put_points(b, m);
  for (size_t k = 0; k < n[2]; k++)
    for (size_t j = 0; j < n[1]; j++)
      for (size_t i = 0; i < n[0]; i++) {
        uint32_t *hex = m->hex[m->n_hex++];

        for (size_t c = 0; c < 8; c++)
          hex[c] = node_at(b, i + (c % 4 == 1 || c % 4 == 2), j + (c % 4 >= 2),
                           k + c / 4);
        put_faces(b, m, i, j, k, hex);
      }
  return VG_OK;
}

/* The walls of the judged mesh correspond to a square with the same area and
 * number of points. The plate is this square or a part of it. The circumference
 * of the cylinder is a side of the square. */
static struct block block_of(const struct vg_accuracy_report *r,
                             enum vg_reference_shape shape)
{
  const double side = sqrt((double)r->n_wall);
  const size_t n = side < 4 ? 4 : (size_t)(side + 0.5);
  struct block b = { .step = sqrt(r->wall_area) / (double)n };

  if (shape == VG_REFERENCE_PLATE) {
    b.n[0] = b.n[1] = n < MOST_ALONG ? n : MOST_ALONG;
    return b;
  }
  b.n[0] = n;
  b.n[1] = n < CYLINDER_ACROSS ? n : CYLINDER_ACROSS;
  b.radius = b.step * (double)n / 6.283185307179586477;
  return b;
}

static vg_status compare(const struct vg_accuracy_report *r,
                         enum vg_reference_shape shape, int threads,
                         struct vg_accuracy_reference *out,
                         struct vg_error *err)
{
  static const uint8_t is_wall[2] = { 1, 0 };
  const double top = VG_LAYERS_Y_PLUS * r->viscous_length;
  const double above = (double)r->n_layer / (double)r->n_wall - 1;
  const size_t levels = above < 1 ? 1
                                  : (size_t)(fmin(above, MOST_LEVELS) + 0.5);
  const struct vg_accuracy_options o = { .is_wall = is_wall,
                                         .viscous_length = r->viscous_length,
                                         .threads = threads };
  struct block b = block_of(r, shape);
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_accuracy_report own = { 0 };
  double height[MOST_LEVELS + LEVELS_BEYOND + 1] = { 0 }, next, growth;
  vg_status st;

  growth = growth_for(r->first_height, top, levels);
  b.n[2] = levels + LEVELS_BEYOND;
  next = r->first_height;
  for (size_t k = 0; k < b.n[2]; k++, next *= growth)
    height[k + 1] = height[k] + next;
  b.height = height;
  VG_TRY(make_mesh(&b, &m, err));
  VG_TRY(vg_accuracy_measure_with(&m, &o, 1, &own, err));
  out->growth = growth;
  out->levels = levels;
  for (int in = 0; in < VG_UNKNOWNS; in++)
    for (int s = 0; s < VG_SCHEMES; s++)
      out->layers[in][s] = own.error[in][VG_FIELD_WALL][s][VG_ZONE_LAYERS];
done:
  vg_mesh_release(&m);
  vg_accuracy_release(&own);
  return st;
}

vg_status vg_accuracy_compare(const struct vg_accuracy_options *o,
                              struct vg_accuracy_report *r,
                              struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(r->first_height > 0 && r->n_wall > 0);
  for (int shape = 0; shape < VG_REFERENCES; shape++)
    VG_TRY(compare(r, (enum vg_reference_shape)shape, o->threads,
                   &r->reference[shape], err));
  r->has_reference = 1;
done:
  return st;
}
