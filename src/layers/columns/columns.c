/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/columns/columns.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

const char *vg_layer_cause_name(enum vg_layer_cause cause)
{
#define ROW(name, key, text, red, green, blue) key,
  static const char *const name[] = { VG_LAYER_CAUSES(ROW) };
#undef ROW

  return (unsigned)cause < VG_CAUSE_N ? name[cause] : "?";
}

void vg_columns_release(struct vg_columns *c)
{
  free(c->column);
  free(c->face);
  free(c->face_tri);
  free(c->border);
  free(c->border_patch);
  free(c->law);
  free(c->path);
  free(c->is_twin);
  memset(c, 0, sizeof *c);
}

void vg_column_at(const struct vg_column *c, const double root[3], double h,
                  double x[3])
{
  for (int k = 0; k < 3; k++)
    x[k] = h == 0 || (c->dir[k] == 0 && c->shift[k] == 0)
           ? root[k]
           : root[k] + (c->shift[k] + c->dir[k] * h);
}

void vg_column_points(const struct vg_columns *c, const struct vg_mesh *m,
                      size_t i, double *d, double (*x)[3])
{
  assert(i < c->n_column && c->column[i].n <= VG_LEVELS_MAX);
  assert(c->column[i].root < m->n_point && c->column[i].law < c->n_law);
  assert(d && x);

  const struct vg_column *col = &c->column[i];

  if (col->bent != SIZE_MAX) {
    memcpy(x, c->path + col->bent, ((size_t)col->n + 1) * sizeof *x);
    return;
  }
  vg_growth_law_heights(&c->law[col->law], col->cap, col->n, d);
  for (int l = 0; l <= col->n; l++)
    vg_column_at(col, m->point[col->root], d[l], x[l]);
}

void vg_column_top(const struct vg_columns *c, const struct vg_mesh *m,
                   size_t i, double x[3])
{
  assert(i < c->n_column && c->column[i].n <= VG_LEVELS_MAX);
  assert(c->column[i].root < m->n_point && c->column[i].law < c->n_law);

  const struct vg_column *col = &c->column[i];
  double d[VG_LEVELS_MAX + 1];

  if (col->bent != SIZE_MAX) {
    memcpy(x, c->path[col->bent + col->n], 3 * sizeof *x);
    return;
  }
  vg_growth_law_heights(&c->law[col->law], col->cap, col->n, d);
  vg_column_at(col, m->point[col->root], d[col->n], x);
}
