/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks every cell of the columns.
 *
 * Faces are processed in chunks of nearby faces. The points of the columns of a
 * chunk are computed once for all its faces, so memory stays small for any
 * number of levels. */
#include "layers/measure/measure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/team.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "layers/expand/join.h"

#define DEGREE 57.295779513082320877
/* L33: distance of a periodic column from a plane, relative to the
 * coordinates. */
#define ROUNDING 1e-12

enum { GRAIN = 1024 }; /* Faces per chunk. */

/* Points of the columns of a chunk; one per worker. */
struct chunk_points {
  struct vg_table table; /* Columns by number. */
  uint32_t *column;      /* [3 * GRAIN] columns in order of first use. */
  double (*x)[3];        /* [3 * GRAIN][job->stride] points of each column. */
};

struct judge_job {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  size_t stride;                   /* Levels of the tallest column, + 1. */
  struct chunk_points *scratch;    /* [workers] scratch. */
  struct vg_layer_judgement *part; /* [chunks] results. */
  double *cosine;                  /* [chunks] largest cosine of the angles of
                                      tops. */
  uint8_t *has_axis; /* [surface->n_patch][3] 1: all points have the same
                        coordinate. */
  double *axis_at;   /* [surface->n_patch][3] that coordinate. */
};

/* Points of column c, which are computed on first use. */
static const double (*levels_of(const struct judge_job *j,
                                struct chunk_points *s, uint32_t *n_used,
                                uint32_t c))[3]
{
  double d[VG_LEVELS_MAX + 1];
  uint32_t *at;

  VG_TABLE_FIND(&s->table, at, vg_hash_1(c), s->column[*at] == c);
  if (*at == VG_TABLE_FREE) {
    *at = (*n_used)++;
    s->column[*at] = c;
    vg_column_points(j->columns, j->surface, c, d, s->x + *at * j->stride);
  }
  return (const double(*)[3])(s->x + *at * j->stride);
}

/* State of a face under the lift rule. */
struct stack {
  const double (*x[3])[3]; /* Points of its columns. */
  int n[3], level[3];      /* Number of levels, and current levels. */
  int order[3];            /* Corners by increasing column number. */
  uint32_t root[3];
};

/* Whether two corners are the same point at level 0. */
static int is_pinched(const struct stack *s, int a, int b)
{
  return s->root[a] == s->root[b] && !s->level[a] && !s->level[b];
}

static int has_pinch(const struct stack *s)
{
  return is_pinched(s, 0, 1) || is_pinched(s, 1, 2) || is_pinched(s, 2, 0);
}

static double lift(const struct stack *s, int k)
{
  return vg_orient3d(s->x[0][s->level[0]], s->x[1][s->level[1]],
                     s->x[2][s->level[2]], s->x[k][s->level[k] + 1]);
}

/* Raises the corners that have a further level, by the lift rule. */
static void raise(struct stack *s, int l, struct vg_layer_judgement *r)
{
  for (int i = 0; i < 3; i++) {
    int k = s->order[i];

    if (s->n[k] <= l) continue;
    if (!has_pinch(s)) {
      r->n_cell++;
      r->n_negative += !(lift(s, k) > 0);
    }
    s->level[k]++;
  }
}

/* As raise(), for a complete prism from level l to l + 1. Two of its six corner
 * tetrahedra, the first lower and the last upper one, are also cells of the
 * lift rule. */
static void raise_prism(struct stack *s, int l, struct vg_layer_judgement *r)
{
  const double *p[3], *q[3];
  int a = s->order[0], b = s->order[1], c = s->order[2], bad_first, bad_last;
  int bad_middle, bad_rest;

  for (int k = 0; k < 3; k++) {
    p[k] = s->x[k][l];
    q[k] = s->x[k][l + 1];
  }
  bad_first = !(lift(s, a) > 0);
  s->level[a]++;
  bad_middle = !(lift(s, b) > 0);
  s->level[b]++;
  bad_last = !(lift(s, c) > 0);
  s->level[c]++;
  bad_rest = !(vg_orient3d(p[0], p[1], p[2], q[b]) > 0) ||
             !(vg_orient3d(p[0], p[1], p[2], q[c]) > 0) ||
             !(vg_orient3d(q[0], q[1], q[2], p[a]) < 0) ||
             !(vg_orient3d(q[0], q[1], q[2], p[b]) < 0);
  r->n_cell += 3;
  r->n_negative += (size_t)(bad_first + bad_middle + bad_last);
  r->n_prism++;
  r->n_bad_corner += bad_first || bad_last || bad_rest;
}

static void count_pyramid(const double *const base[4], const double apex[3],
                          struct vg_layer_judgement *r)
{
  int bad = 0;

  for (int k = 0; k < 4; k++)
    bad |= !(vg_orient3d(base[k], base[(k + 1) % 4], base[(k + 2) % 4], apex) >
             0);
  r->n_pyramid++;
  r->n_bad_pyramid += bad != 0;
}

/* The pyramid on the quadrilateral of the two corners that are raised, with the
 * third corner as apex. */
static void judge_pyramid(const struct stack *s, int l,
                          struct vg_layer_judgement *r)
{
  int c = s->n[0] <= l ? 0 : s->n[1] <= l ? 1 : 2;
  int a = (c + 1) % 3, b = (c + 2) % 3;
  const double *base[4] = { s->x[a][l], s->x[a][l + 1], s->x[b][l + 1],
                            s->x[b][l] };

  count_pyramid(base, s->x[c][s->level[c]], r);
}

static int shares_root(const struct vg_columns *c, size_t i)
{
  uint32_t root = c->column[i].root;

  return (i && c->column[i - 1].root == root) ||
         (i + 1 < c->n_column && c->column[i + 1].root == root);
}

/* Cells of mixed output at level 0 on a face with a column that shares its
 * root: tetrahedra and pyramids, but never a complete prism. */
static void judge_wall(const struct judge_job *j, size_t face,
                       const struct stack *s, struct vg_layer_judgement *r)
{
  struct vg_wall_cell cell[3];
  int n = vg_join_wall_cells(j->columns, face, cell);

  for (int i = 0; i < n; i++) {
    const double *p[6];

    for (int k = 0; k < cell[i].n_node; k++)
      p[k] = s->x[cell[i].node[k] % 3][cell[i].node[k] / 3];
    if (cell[i].n_node == 5) {
      const double *base[4] = { p[0], p[3], p[4], p[1] };

      count_pyramid(base, p[2], r);
    } else {
      r->n_wall_tet++;
      r->n_bad_wall_tet += !(vg_orient3d(p[0], p[1], p[2], p[3]) > 0);
    }
  }
}

/* Checks all cells of a face. Above level 0 its points are distinct, except
 * where two columns of one root have no level, and there only the third column
 * can be raised. */
static void judge_face(const struct judge_job *j, size_t face, struct stack *s,
                       struct vg_layer_judgement *r)
{
  const uint32_t *v = j->columns->face[face];
  int shared = shares_root(j->columns, v[0]) || shares_root(j->columns, v[1]) ||
               shares_root(j->columns, v[2]);

  for (int l = 0; l < s->n[0] || l < s->n[1] || l < s->n[2]; l++) {
    int up = (s->n[0] > l) + (s->n[1] > l) + (s->n[2] > l);

    if (shared && !l) judge_wall(j, face, s, r);
    else if (up == 2) judge_pyramid(s, l, r);
    if (up == 3 && !(shared && !l)) raise_prism(s, l, r);
    else raise(s, l, r);
  }
}

static double cosine_at(const double a[3], const double b[3], const double c[3])
{
  double uu = 0, vv = 0, uv = 0;

  for (int k = 0; k < 3; k++) {
    double u = b[k] - a[k], v = c[k] - a[k];

    uu += u * u;
    vv += v * v;
    uv += u * v;
  }
  return uu > 0 && vv > 0 ? uv / sqrt(uu * vv) : 1;
}

/* Largest cosine at the corners of the top of a face. */
static void judge_top(const struct stack *s, double *cosine)
{
  const double *t[3];

  if (has_pinch(s) || !(s->level[0] || s->level[1] || s->level[2])) return;
  for (int k = 0; k < 3; k++) t[k] = s->x[k][s->level[k]];
  for (int k = 0; k < 3; k++) {
    double c = cosine_at(t[k], t[(k + 1) % 3], t[(k + 2) % 3]);

    if (c > *cosine) *cosine = c;
  }
}

static struct stack stack_of(const struct judge_job *j,
                             struct chunk_points *points, uint32_t *n_used,
                             const uint32_t v[3])
{
  struct stack s = { .order = { 0, 1, 2 } };

  for (int k = 0; k < 3; k++) {
    s.x[k] = levels_of(j, points, n_used, v[k]);
    s.n[k] = j->columns->column[v[k]].n;
    s.root[k] = j->columns->column[v[k]].root;
  }
  for (int i = 1; i < 3; i++)
    for (int k = i; k && v[s.order[k]] < v[s.order[k - 1]]; k--) {
      int t = s.order[k];

      s.order[k] = s.order[k - 1];
      s.order[k - 1] = t;
    }
  return s;
}

static int is_step(const struct judge_job *j, uint32_t a, uint32_t b)
{
  return abs(j->columns->column[a].n - j->columns->column[b].n) > 1;
}

static void judge_faces(void *context, size_t first, size_t end, int worker)
{
  const struct judge_job *j = context;
  struct chunk_points *points = &j->scratch[worker];
  struct vg_layer_judgement r = { .n_cell = 0 };
  double cosine = -1;
  uint32_t n_used = 0;

  vg_table_clear(&points->table);
  for (size_t f = first; f < end; f++) {
    const uint32_t *v = j->columns->face[f];
    struct stack s = stack_of(j, points, &n_used, v);

    judge_face(j, f, &s, &r);
    judge_top(&s, &cosine);
    for (int k = 0; k < 3; k++) r.n_step += is_step(j, v[k], v[(k + 1) % 3]);
  }
  j->part[first / GRAIN] = r;
  j->cosine[first / GRAIN] = cosine;
}

/* Steps were counted once per face; *n out: once per edge. */
static vg_status count_steps(const struct judge_job *j, size_t *n,
                             struct vg_error *err)
{
  uint32_t(*edge)[2];
  struct vg_edges e = VG_EDGES_INIT;
  size_t n_edge = 0, n_found = *n;
  vg_status st;

  if (!n_found) return VG_OK;
  edge = vg_alloc(n_found, sizeof *edge);
  if (!edge) return vg_fail_memory(err, "edges of unequal levels");
  for (size_t f = 0; f < j->columns->n_face; f++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = j->columns->face[f][k], b = j->columns->face[f][(k + 1) % 3];

      if (!is_step(j, a, b) || n_edge == n_found) continue;
      edge[n_edge][0] = a;
      edge[n_edge++][1] = b;
    }
  st = vg_edges_build_sides(&e, j->columns->n_column, n_edge,
                            (const uint32_t(*)[2])edge, err);
  if (st >= 0) *n = e.n;
  vg_edges_release(&e);
  free(edge);
  return st;
}

/* Finds the coordinates that are equal for all points of a patch. */
static vg_status find_axes(struct judge_job *j, struct vg_error *err)
{
  const struct vg_mesh *m = j->surface;

  j->has_axis = vg_alloc(m->n_patch, 3);
  j->axis_at = vg_alloc(m->n_patch, 3 * sizeof *j->axis_at);
  if (!j->has_axis || !j->axis_at) return vg_fail_memory(err, "slide planes");
  memset(j->has_axis, 2, 3 * m->n_patch); /* 2: no point visited yet. */
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 9; k++) {
      size_t at = 3 * (size_t)m->tri_patch[t] + (size_t)k % 3;
      double x = m->point[m->tri[t][k / 3]][k % 3];

      if (j->has_axis[at] == 2) {
        j->has_axis[at] = 1;
        j->axis_at[at] = x;
      } else if (j->axis_at[at] != x) {
        j->has_axis[at] = 0;
      }
    }
  return VG_OK;
}

/* Bent columns in planes are images of periodic columns, exact to rounding. */
static int leaves_plane(const struct judge_job *j, size_t c)
{
  const struct vg_column *col = &j->columns->column[c];
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3], most = 0;
  int off = 0;

  vg_column_points(j->columns, j->surface, c, d, x);
  if (col->bent != SIZE_MAX)
    most = ROUNDING * (vg_norm(x[0]) + vg_distance(x[0], x[col->n]));
  for (int i = 0; i < 2; i++)
    for (size_t k = 0; k < 3 && col->slide[i] != VG_NO_INDEX; k++) {
      size_t at = 3 * (size_t)col->slide[i] + k;

      if (j->has_axis[at] != 1) continue;
      for (int l = 0; l <= col->n; l++)
        off |= !(fabs(x[l][k] - j->axis_at[at]) <= most);
    }
  return off;
}

static size_t count_off_plane(const struct judge_job *j)
{
  size_t n = 0;

  for (size_t c = 0; c < j->columns->n_column; c++)
    if (j->columns->column[c].slide[0] != VG_NO_INDEX)
      n += (size_t)leaves_plane(j, c);
  return n;
}

static vg_status prepare(struct judge_job *j, int workers, size_t n_chunk,
                         struct vg_error *err)
{
  const struct vg_columns *c = j->columns;

  for (size_t i = 0; i < c->n_column; i++) {
    if (c->column[i].n > VG_LEVELS_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "column %zu has %d levels, but at most %d are supported",
                     i + 1, c->column[i].n, VG_LEVELS_MAX);
    if (c->column[i].n >= j->stride) j->stride = c->column[i].n + (size_t)1;
  }
  j->part = vg_calloc(n_chunk, sizeof *j->part);
  j->cosine = vg_alloc(n_chunk, sizeof *j->cosine);
  j->scratch = vg_calloc((size_t)workers, sizeof *j->scratch);
  if (!j->part || !j->cosine || !j->scratch)
    return vg_fail_memory(err, "checking the layers");
  for (int i = 0; i < workers; i++) {
    struct chunk_points *s = &j->scratch[i];

    s->column = vg_alloc(3 * GRAIN, sizeof *s->column);
    s->x = vg_alloc(3 * GRAIN * j->stride, sizeof *s->x);
    if (!s->column || !s->x || vg_table_init(&s->table, 3 * GRAIN))
      return vg_fail_memory(err, "checking the layers");
  }
  return find_axes(j, err);
}

static void release(struct judge_job *j, int workers)
{
  for (int i = 0; i < workers && j->scratch; i++) {
    vg_table_release(&j->scratch[i].table);
    free(j->scratch[i].column);
    free(j->scratch[i].x);
  }
  free(j->scratch);
  free(j->part);
  free(j->cosine);
  free(j->has_axis);
  free(j->axis_at);
}

static void add(const struct vg_layer_judgement *part,
                struct vg_layer_judgement *sum)
{
  sum->n_cell += part->n_cell;
  sum->n_negative += part->n_negative;
  sum->n_prism += part->n_prism;
  sum->n_bad_corner += part->n_bad_corner;
  sum->n_pyramid += part->n_pyramid;
  sum->n_bad_pyramid += part->n_bad_pyramid;
  sum->n_wall_tet += part->n_wall_tet;
  sum->n_bad_wall_tet += part->n_bad_wall_tet;
  sum->n_step += part->n_step;
}

static vg_status judge_all(struct judge_job *j, int workers,
                           struct vg_team *team, struct vg_error *err)
{
  const struct vg_team_out out[] = { { j->part, sizeof *j->part, GRAIN, NULL },
                                     { j->cosine, sizeof *j->cosine, GRAIN,
                                       NULL } };

  return vg_team_for(team, workers, j->columns->n_face, GRAIN, judge_faces, j,
                     sizeof out / sizeof *out, out, err);
}

vg_status vg_layers_judge(const struct vg_mesh *surface,
                          const struct vg_columns *columns, int threads,
                          struct vg_team *team, struct vg_layer_judgement *out,
                          struct vg_error *err)
{
  assert(threads >= 0 && out);

  vg_status st = VG_OK;
  struct judge_job j = { .surface = surface, .columns = columns, .stride = 1 };
  struct vg_layer_judgement sum = { .n_cell = 0 };
  size_t n_chunk = (columns->n_face + GRAIN - 1) / GRAIN;
  int workers = threads > 0 ? threads : vg_cores();
  double cosine = -1;

  if ((size_t)workers > n_chunk) workers = n_chunk ? (int)n_chunk : 1;
  VG_TRY(prepare(&j, workers, n_chunk, err));
  VG_TRY(judge_all(&j, workers, team, err));
  for (size_t i = 0; i < n_chunk; i++) {
    add(&j.part[i], &sum);
    if (j.cosine[i] > cosine) cosine = j.cosine[i];
  }
  VG_TRY(count_steps(&j, &sum.n_step, err));
  sum.n_off_plane = count_off_plane(&j);
  sum.top_angle_min = cosine < 1 ? acos(cosine) * DEGREE : 0;
  *out = sum;
done:
  release(&j, workers);
  return st;
}
