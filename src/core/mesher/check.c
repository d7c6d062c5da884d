/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Check that the result of a mesher fills the front. The cells must be
 * positive, each inner face must have two cells on opposite sides, and each
 * face of the front must have exactly one cell, on its inner side. The number
 * of cells that contain a position inside then equals the winding number of
 * the front around it, which is one. The volumes are compared in addition. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/mesh/cell_links.h"
#include "core/mesher/fill_with.h"

/* Sums of volumes differ by rounding only: about 1e-16 of the terms. */
static const double tolerance = 1e-10;

static const char *check_numbers(size_t n_front, size_t n, const double (*x)[3],
                                 size_t n_cell, const uint32_t (*cell)[4])
{
  for (size_t i = n_front; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (!isfinite(x[i][k])) return "a point is not finite";
  for (size_t c = 0; c < n_cell; c++)
    for (int k = 0; k < 4; k++)
      if (cell[c][k] >= n)
        return "a cell refers to a point that does not exist";
  return n_cell ? NULL : "there are no cells";
}

static const char *turn_cells(const double (*x)[3], size_t n_cell,
                              uint32_t (*cell)[4])
{
  for (size_t c = 0; c < n_cell; c++) {
    uint32_t *v = cell[c], t = v[0];
    double volume = vg_orient3d(x[v[0]], x[v[1]], x[v[2]], x[v[3]]);

    if (!(volume > 0 || volume < 0)) return "a cell is flat";
    if (volume > 0) continue;
    v[0] = v[1];
    v[1] = t;
  }
  return NULL;
}

static int turns_alike(const uint32_t a[3], const uint32_t b[3])
{
  int k = 0;

  while (k < 2 && b[k] != a[0]) k++;
  return a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3];
}

/* The normals of half-faces point out of their cell, those of front faces into
 * it. */
static const char *check_sides(const struct vg_cell_links *l,
                               const uint32_t (*face)[3], size_t n_face)
{
  uint32_t a[4], b[4], turned[3];

  for (uint32_t code = 0; code >> 3 < l->n_cell;
       code += (code & 7) == 3 ? 5 : 1) {
    uint32_t mate = vg_mate(l, code);

    if (mate == VG_NO_CELL || mate < code) continue;
    vg_half_face_nodes(l, code, a);
    vg_half_face_nodes(l, mate, b);
    if (turns_alike(a, b))
      return "two cells lie on the same side of their common face";
  }
  for (size_t i = 0; i < n_face; i++) {
    vg_half_face_nodes(l, l->boundary[i], a);
    for (int k = 0; k < 3; k++) turned[k] = a[2 - k];
    if (!turns_alike(turned, face[i])) return "a cell lies outside the front";
  }
  return NULL;
}

/* Compares six times the volumes. Cones start at a point of the front to avoid
 * cancellation. */
static const char *check_volume(const double (*x)[3], const uint32_t (*face)[3],
                                size_t n_face, size_t n_cell,
                                const uint32_t (*cell)[4])
{
  double front = 0, cells = 0, sum = 0;

  for (size_t i = 0; i < n_face; i++) {
    double v = vg_orient3d(x[face[i][0]], x[face[i][2]], x[face[i][1]],
                           x[face[0][0]]);

    front -= v;
    sum += fabs(v);
  }
  for (size_t c = 0; c < n_cell; c++) {
    const uint32_t *v = cell[c];

    cells += vg_orient3d(x[v[0]], x[v[1]], x[v[2]], x[v[3]]);
  }
  return fabs(fabs(front) - cells) <= tolerance * sum ? NULL
                                                      : "volumes do not add up";
}

static vg_status drop_unused(size_t n_front, size_t *n, double (*x)[3],
                             size_t n_cell, uint32_t (*cell)[4],
                             struct vg_error *err)
{
  uint32_t *to = vg_calloc(*n, sizeof *to), next = (uint32_t)n_front;

  if (!to) return vg_fail_memory(err, "the points of a void");
  for (size_t c = 0; c < n_cell; c++)
    for (int k = 0; k < 4; k++) to[cell[c][k]] = 1;
  for (size_t i = n_front; i < *n; i++)
    if (to[i]) {
      if (next != i) memcpy(x[next], x[i], sizeof *x);
      to[i] = next++;
    }
  for (size_t c = 0; c < n_cell; c++)
    for (int k = 0; k < 4; k++)
      if (cell[c][k] >= n_front) cell[c][k] = to[cell[c][k]];
  *n = next;
  free(to);
  return VG_OK;
}

vg_status vg_mesher_check(size_t n_front, size_t n_face,
                          const uint32_t (*face)[3], size_t *n, double (*x)[3],
                          size_t n_cell, uint32_t (*cell)[4],
                          const char **wrong, struct vg_error *err)
{
  struct vg_mesh m = {
    .n_point = *n, .point = x, .n_tri = n_face, .n_tet = n_cell, .tet = cell
  };
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  vg_status st;

  assert(wrong && *n >= n_front);
  assert(face || !n_face);
  assert(cell || !n_cell);
  memcpy(&m.tri, &face, sizeof m.tri); /* not modified */
  *wrong = check_numbers(n_front, *n, (const double(*)[3])x, n_cell,
                         (const uint32_t(*)[4])cell);
  if (!*wrong) *wrong = turn_cells((const double(*)[3])x, n_cell, cell);
  if (*wrong) return VG_NOT_BETTER;
  st = vg_cell_links_build(&l, &m, 0, "a void", err);
  if (st == VG_ERR_INPUT || st == VG_ERR_UNSUPPORTED) {
    *wrong = "the front is not preserved, or cells do not match face to face";
    return VG_NOT_BETTER;
  }
  if (st < 0) return st;
  *wrong = check_sides(&l, face, n_face);
  vg_cell_links_release(&l);
  if (!*wrong)
    *wrong = check_volume((const double(*)[3])x, face, n_face, n_cell,
                          (const uint32_t(*)[4])cell);
  if (*wrong) return VG_NOT_BETTER;
  return drop_unused(n_front, n, x, n_cell, cell, err);
}
