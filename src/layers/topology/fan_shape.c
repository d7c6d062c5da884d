/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Directions of the columns at one point of a convex edge. */
#include <assert.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "layers/topology/fan.h"
#include "layers/topology/most_normal.h"

/* L13: cosine of 40 degrees, the largest step. */
#define COS_STEP 0.7660444431189780
#define SLACK 1e-9 /* Lets a turn of exactly 40 degrees be one step. */
/* Least rotation of a step about its ridge, relative to its rotation. */
#define LEAST_TURN 0.1
/* Least sine between the centre and the plane of a polygon edge. */
#define LEAST_CENTRE 0.05

static void into_plane(const struct vg_fan_shape *s, double v[3])
{
  double d;

  if (!s->has_plane) return;
  d = vg_dot(v, s->plane);
  for (int k = 0; k < 3; k++)
    v[k] = fabs(s->plane[k]) == 1 ? 0 : v[k] - d * s->plane[k];
}

/* Point at the fraction t of the arc between two unit vectors less than 180
 * degrees apart. Halves the arc six times and then interpolates along the
 * chord, with an error below 1e-5 of the arc. */
static void on_arc(const double *from, const double *to, double t,
                   double out[3])
{
  double a[3], b[3], mid[3];

  memcpy(a, from, sizeof a);
  memcpy(b, to, sizeof b);
  for (int i = 0; i < 6; i++) {
    for (int k = 0; k < 3; k++) mid[k] = a[k] + b[k];
    vg_unit(mid);
    t *= 2;
    if (t < 1) {
      memcpy(b, mid, sizeof b);
    } else {
      memcpy(a, mid, sizeof a);
      t -= 1;
    }
  }
  for (int k = 0; k < 3; k++) out[k] = (1 - t) * a[k] + t * b[k];
  vg_unit(out);
}

static int steps_are_small(int n, const double (*dir)[3])
{
  for (int i = 0; i < n; i++)
    if (vg_dot(dir[i], dir[i + 1]) < COS_STEP - SLACK) return 0;
  return 1;
}

/* Middle of the arc from a to b, which turns about the ridge along `edge` with
 * a on its right. The sum of the two normals fails for thin wedges, and the sum
 * of the two outward directions fails for blunt ones; the sum of all four never
 * fails. */
static int middle(const struct vg_fan_shape *s, const double *a,
                  const double *b, const double *edge, double mid[3])
{
  double right[3], left[3];

  vg_cross(a, edge, right);
  vg_cross(edge, b, left);
  for (int k = 0; k < 3; k++) mid[k] = a[k] + b[k] + right[k] + left[k];
  into_plane(s, mid);
  return vg_unit(mid) > 0.1;
}

/* Chain dir[0 .. return] from a to b with the fewest steps. Returns 0 if no
 * chain is possible. */
static int make_chain(const struct vg_fan_shape *s, const double *a,
                      const double *b, const double *edge, double (*dir)[3])
{
  double mid[3];

  if (!middle(s, a, b, edge, mid)) return 0;
  for (int n = 1; n <= VG_FAN_STEPS; n++) {
    for (int i = 0; i <= n; i++) {
      double t = 2.0 * i / n;

      if (i == 0) memcpy(dir[i], a, sizeof *dir);
      else if (i == n) memcpy(dir[i], b, sizeof *dir);
      else if (t <= 1) on_arc(a, mid, t, dir[i]);
      else on_arc(mid, b, t - 1, dir[i]);
      into_plane(s, dir[i]);
      vg_unit(dir[i]);
    }
    if (steps_are_small(n, dir)) return n;
  }
  return 0;
}

/* Whether each step of a chain, from left to right, turns about the ridge. If
 * so, the cells of the virtual faces along it have positive volume. */
static int turns_about(int n, const double (*dir)[3], const double *edge)
{
  for (int i = 0; i < n; i++) {
    double c[3], l;

    vg_cross(dir[i + 1], dir[i], c);
    l = vg_norm(c);
    if (!(l > 0) || vg_dot(c, edge) < LEAST_TURN * l) return 0;
  }
  return 1;
}

static int sees_polygon(const struct vg_fan_shape *s, const double *centre)
{
  for (int i = 0; i < s->n_polygon; i++) {
    double c[3];

    vg_cross(s->dir[i], s->dir[(i + 1) % s->n_polygon], c);
    if (!(vg_unit(c) > 0) || vg_dot(c, centre) < LEAST_CENTRE) return 0;
  }
  return 1;
}

/* Closes the polygon where three or more sectors meet. A triangle needs no
 * further column; other polygons get a centre column that sees all their
 * edges. */
static int fill_polygon(struct vg_fan_shape *s)
{
  double side[VG_FAN_COLUMNS][3], *centre = s->dir[s->n_column];

  memset(centre, 0, sizeof *s->dir);
  for (int i = 0; i < s->n_polygon; i++) {
    vg_cross(s->dir[i], s->dir[(i + 1) % s->n_polygon], side[i]);
    vg_unit(side[i]);
    for (int k = 0; k < 3; k++) centre[k] += s->dir[i][k];
  }
  vg_unit(centre);
  if (!sees_polygon(s, centre)) {
    if (!vg_most_normal(s->n_polygon, (const double(*)[3])side, centre))
      return 0;
    vg_unit(centre);
    if (!sees_polygon(s, centre)) return 0;
  }
  s->has_centre = s->n_polygon > 3;
  s->n_column += s->has_centre;
  return 1;
}

/* Closed ring of two sectors: both ridges share one chain. */
static int spread_pair(struct vg_fan_shape *s)
{
  double along[3], back[VG_FAN_STEPS + 1][3];
  int n;

  vg_sub(s->ridge[0], s->ridge[1], along);
  if (!(vg_unit(along) > 0)) return 0;
  n = make_chain(s, s->sector[0], s->sector[1], along, s->dir);
  if (!n || !turns_about(n, (const double(*)[3])s->dir, s->ridge[0])) return 0;
  for (int i = 0; i <= n; i++) memcpy(back[i], s->dir[n - i], sizeof *back);
  if (!turns_about(n, (const double(*)[3])back, s->ridge[1])) return 0;
  s->at[0] = 0;
  s->at[1] = n;
  s->n_step[0] = s->n_step[1] = n;
  s->shared = 1;
  s->n_column = n + 1;
  return 1;
}

/* Chains across n_ridge consecutive ridges from sector `first` on, followed by
 * the sector behind the last ridge. */
static int spread_from(struct vg_fan_shape *s, int first, int n_ridge)
{
  double chain[VG_FAN_STEPS + 1][3];
  int at = first;

  s->n_column = 0;
  for (int i = 0; i < n_ridge; i++, at = (at + 1) % s->n_sector) {
    int n = make_chain(s, s->sector[at], s->sector[(at + 1) % s->n_sector],
                       s->ridge[at], chain);

    if (!n || !turns_about(n, (const double(*)[3])chain, s->ridge[at]))
      return 0;
    memcpy(s->dir + s->n_column, chain, (size_t)n * sizeof *chain);
    s->at[at] = s->n_column;
    s->n_step[at] = n;
    s->n_column += n;
  }
  if (at == first) return 1;
  s->at[at] = s->n_column;
  memcpy(s->dir[s->n_column++], s->sector[at], sizeof *s->dir);
  return 1;
}

/* Sectors whose directions lie in one plane, such as where a blunt edge becomes
 * sharp: the chain of one ridge consists of the other chains in reverse. */
static int spread_shared(struct vg_fan_shape *s)
{
  double back[VG_FAN_COLUMNS][3];

  s->n_polygon = s->has_centre = 0;
  for (int i = 0; i < s->n_sector; i++) {
    int n;

    if (!spread_from(s, (i + 1) % s->n_sector, s->n_sector - 1)) continue;
    n = s->n_column - 1;
    for (int j = 0; j <= n; j++) memcpy(back[j], s->dir[n - j], sizeof *back);
    if (!turns_about(n, (const double(*)[3])back, s->ridge[i])) continue;
    s->shared = i;
    s->n_step[i] = n;
    return 1;
  }
  return 0;
}

int vg_fan_spread(struct vg_fan_shape *s)
{
  assert(s->n_sector > 0 && s->n_sector <= VG_FAN_SECTORS);
  s->n_column = s->n_polygon = s->has_centre = 0;
  s->shared = -1;
  if (s->is_open) return spread_from(s, 0, s->n_sector - 1);
  if (s->n_sector == 2) return spread_pair(s);
  if (!spread_from(s, 0, s->n_sector)) return spread_shared(s);
  s->n_polygon = s->n_column;
  return fill_polygon(s) || spread_shared(s);
}
