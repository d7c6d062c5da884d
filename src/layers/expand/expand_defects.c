/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks of columns: their indices, and every one of their cells. */
#include "layers/expand/expand_defects.h"

#include <string.h>

#include "core/judge/quality.h"

static size_t bad_columns(const struct vg_columns *c, const struct vg_mesh *m)
{
  size_t bad = 0;

  for (size_t i = 0; i < c->n_column; i++) {
    const struct vg_column *k = &c->column[i];

    bad += k->root >= m->n_point || k->law >= c->n_law;
    bad += i && k->root < k[-1].root;
    bad += k->n > VG_LEVELS_MAX || k->cause >= VG_CAUSE_N ||
           k->compressed >= VG_CAUSE_N;
    bad += k->bent != SIZE_MAX && k->bent + k->n >= c->n_path;
    for (int s = 0; s < 2; s++)
      bad += k->slide[s] != VG_NO_INDEX && k->slide[s] >= m->n_patch;
    bad += k->slide[0] == VG_NO_INDEX && k->slide[1] != VG_NO_INDEX;
  }
  return bad;
}

static size_t bad_faces(const struct vg_columns *c, const struct vg_mesh *m)
{
  size_t bad = 0;
  int is_virtual = 0;

  for (size_t i = 0; i < c->n_face; i++) {
    const uint32_t *f = c->face[i], tri = c->face_tri[i];

    for (int k = 0; k < 3; k++)
      bad += f[k] >= c->n_column || f[k] == f[(k + 1) % 3];
    bad += is_virtual && tri != VG_NO_INDEX;
    is_virtual = tri == VG_NO_INDEX;
    bad += !is_virtual && tri >= m->n_tri;
  }
  return bad;
}

static int slides_in(const struct vg_column *k, uint32_t patch)
{
  return k->slide[0] == patch || k->slide[1] == patch;
}

static size_t bad_borders(const struct vg_columns *c)
{
  size_t bad = 0;

  for (size_t i = 0; i < c->n_border; i++)
    for (int k = 0; k < 2; k++)
      bad += c->border[i][k] >= c->n_column ||
             !slides_in(&c->column[c->border[i][k]], c->border_patch[i]);
  return bad;
}

/* The columns of a face and the current level of each. */
struct lift {
  const struct vg_column *column[3];
  double x[3][VG_LEVELS_MAX + 1][3];
  int at[3];
};

/* Whether corners i and k of the face are the same point. */
static int is_one_point(const struct lift *l, int i, int k)
{
  return !l->at[i] && !l->at[k] && l->column[i]->root == l->column[k]->root;
}

/* Raises corner i by a level. Returns 1 if the resulting cell does not have
 * positive volume. */
static int raise(struct lift *l, int i)
{
  const uint32_t node[4] = { 0, 1, 2, 3 };
  const int vanishes = is_one_point(l, 0, 1) || is_one_point(l, 1, 2) ||
                       is_one_point(l, 2, 0);
  double p[4][3];

  for (int k = 0; k < 3; k++) memcpy(p[k], l->x[k][l->at[k]], sizeof *p);
  l->at[i]++;
  memcpy(p[3], l->x[i][l->at[i]], sizeof *p);
  return !vanishes && !vg_cell_positive((const double(*)[3])p, 0, node);
}

static size_t bad_cells(const struct vg_columns *c, const struct vg_mesh *m,
                        const uint32_t *face)
{
  double d[VG_LEVELS_MAX + 1];
  struct lift l;
  size_t bad = 0;
  int order[3], n = 0;

  memset(l.at, 0, sizeof l.at);
  for (int i = 0; i < 3; i++) {
    l.column[i] = &c->column[face[i]];
    vg_column_points(c, m, face[i], d, l.x[i]);
    if (l.column[i]->n > n) n = l.column[i]->n;
    order[(face[i] > face[(i + 1) % 3]) + (face[i] > face[(i + 2) % 3])] = i;
  }
  for (int level = 0; level < n; level++)
    for (int i = 0; i < 3; i++)
      if (level < l.column[order[i]]->n) bad += (size_t)raise(&l, order[i]);
  return bad;
}

size_t vg_columns_defects(const struct vg_columns *c,
                          const struct vg_mesh *surface)
{
  size_t bad = bad_columns(c, surface) + bad_faces(c, surface) + bad_borders(c);

  for (size_t i = 0; !bad && i < c->n_face; i++)
    bad += bad_cells(c, surface, c->face[i]);
  return bad;
}
