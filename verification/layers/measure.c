/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Measures the layers in a mesh file, independently of the program's report.
 *
 * vg_measure_layers box MESH.cogsg PATCH DELTA1 R1 R2
 *   a mesh with layers on one plane patch, from VGRID or Vanguard: columns are
 *   identified by their foot on the wall; levels, largest difference from the
 *   law, layer cells, and the quality of the other cells: dihedral angles,
 *   volume ratio across the top.
 * vg_measure_layers first MESH.b8.ugrid HEIGHT
 *   walls (condition 4 in the .mapbc of the mesh): the first points over each
 *   wall point, found from the cells on the wall; their distance from the wall
 *   triangles there; wall faces with a prism.
 * Prints "key value" lines. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/quality.h"
#include "io/mesh/format.h"
#include "io/vgrid/vgrid.h"

#define LEVELS 256
#define SAME_FOOT 1e-4 /* same foot; VGRID's columns are 0.1 apart */

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus(const double a[3], const double b[3], double c[3])
{
  for (int k = 0; k < 3; k++) c[k] = a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double c[3])
{
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double tet_volume(const struct vg_mesh *m, const uint32_t t[4])
{
  double u[3], v[3], w[3], n[3];

  minus(m->point[t[1]], m->point[t[0]], u);
  minus(m->point[t[2]], m->point[t[0]], v);
  minus(m->point[t[3]], m->point[t[0]], w);
  cross(u, v, n);
  return dot(n, w) / 6;
}

static int by_value(const void *a, const void *b)
{
  double x = *(const double *)a, y = *(const double *)b;

  return (x > y) - (x < y);
}

/* box: columns --------------------------------------------------------- */

struct wall {
  double normal[3], at;
  size_t n;
  uint32_t *point; /* [n] */
};

static int find_wall(const struct vg_mesh *m, int32_t id, struct wall *w)
{
  size_t p = vg_mesh_find_patch(m, id);
  char *on = vg_calloc(m->n_point, 1);

  w->n = 0;
  w->point = vg_alloc(m->n_point, sizeof *w->point);
  if (!on || !w->point) return -1;
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];
    double u[3], v[3], length;

    if (m->tri_patch[i] != p) continue;
    for (int k = 0; k < 3; k++) on[t[k]] = 1;
    if (w->at != 0) continue;
    minus(m->point[t[1]], m->point[t[0]], u);
    minus(m->point[t[2]], m->point[t[0]], v);
    cross(u, v, w->normal);
    length = sqrt(dot(w->normal, w->normal));
    for (int k = 0; k < 3; k++) w->normal[k] /= length;
    w->at = dot(w->normal, m->point[t[0]]);
  }
  for (size_t i = 0; i < m->n_point; i++)
    if (on[i]) w->point[w->n++] = (uint32_t)i;
  free(on);
  return w->n ? 0 : -1;
}

/* Wall index of the foot of x. A linear search: the wall has hundreds of
 * points. */
static size_t foot(const struct vg_mesh *m, const struct wall *w,
                   const double x[3], double *height)
{
  *height = dot(w->normal, x) - w->at;
  for (size_t i = 0; i < w->n; i++) {
    double d[3], h;

    minus(x, m->point[w->point[i]], d);
    h = dot(d, w->normal);
    if (dot(d, d) - h * h < SAME_FOOT * SAME_FOOT) return i;
  }
  return SIZE_MAX;
}

static void law(double delta1, double r1, double r2, double d[LEVELS])
{
  d[0] = 0;
  for (int j = 1; j < LEVELS; j++)
    d[j] = d[j - 1] + delta1 * pow(1 + r1 * pow(1 + r2, j - 1), j - 1);
}

static void judge_columns(const struct wall *w, double (*height)[LEVELS],
                          const int *n, double delta1, double r1, double r2)
{
  size_t count[LEVELS] = { 0 };
  double d[LEVELS], worst = 0, first = 0;

  law(delta1, r1, r2, d);
  for (size_t i = 0; i < w->n; i++) {
    count[n[i]]++;
    qsort(height[i], (size_t)n[i], sizeof **height, by_value);
    for (int j = 0; j < n[i]; j++)
      worst = fmax(worst, fabs(height[i][j] - d[j + 1]));
    if (n[i]) first = fmax(first, fabs(height[i][0] - d[1]));
  }
  printf("columns %zu\n", w->n);
  for (int j = 0; j < LEVELS; j++)
    if (count[j]) printf("levels_%d %zu\n", j, count[j]);
  printf("law_error %.3g\nfirst_error %.3g\n", worst, first);
}

static int columns(const struct vg_mesh *m, size_t n_layer, int32_t patch,
                   double delta1, double r1, double r2)
{
  struct wall w = { .at = 0 };
  char *used = vg_calloc(m->n_point, 1);
  double(*height)[LEVELS] = NULL;
  int *n = NULL, bad = !used || find_wall(m, patch, &w);
  size_t lost = 0;

  if (!bad) {
    height = vg_alloc(w.n, sizeof *height);
    n = vg_calloc(w.n, sizeof *n);
    bad = !height || !n;
  }
  for (size_t i = 0; i < n_layer && !bad; i++)
    for (int k = 0; k < 4; k++) used[m->tet[i][k]] = 1;
  for (size_t i = 0; i < w.n && !bad; i++) used[w.point[i]] = 0;
  for (size_t i = 0; i < m->n_point && !bad; i++) {
    double h;
    size_t at = used[i] ? foot(m, &w, m->point[i], &h) : SIZE_MAX;

    if (at == SIZE_MAX) lost += used[i] != 0;
    else if (n[at] < LEVELS - 1) height[at][n[at]++] = h;
  }
  if (!bad) {
    printf("points_off_columns %zu\n", lost);
    judge_columns(&w, height, n, delta1, r1, r2);
  }
  free(used);
  free(height);
  free(n);
  free(w.point);
  return bad;
}

/* box: the other cells ------------------------------------------------- */

struct face {
  uint32_t v[3], cell;
};

static int by_face(const void *a, const void *b)
{
  const struct face *x = a, *y = b;

  for (int k = 0; k < 3; k++)
    if (x->v[k] != y->v[k]) return x->v[k] < y->v[k] ? -1 : 1;
  return (x->cell > y->cell) - (x->cell < y->cell);
}

static void sort3(uint32_t v[3])
{
  for (int i = 0; i < 3; i++)
    if (v[i % 2] > v[i % 2 + 1]) {
      uint32_t t = v[i % 2];

      v[i % 2] = v[i % 2 + 1];
      v[i % 2 + 1] = t;
    }
}

static int top_ratio(const struct vg_mesh *m, size_t n_layer)
{
  struct face *f = vg_alloc(4 * m->n_tet, sizeof *f);
  double *ratio = vg_alloc(4 * m->n_tet, sizeof *ratio);
  size_t n = 0, n_top = 0;

  if (!f || !ratio) return -1;
  for (size_t i = 0; i < m->n_tet; i++)
    for (int k = 0; k < 4; k++, n++) {
      for (int j = 0; j < 3; j++) f[n].v[j] = m->tet[i][(k + 1 + j) % 4];
      sort3(f[n].v);
      f[n].cell = (uint32_t)i;
    }
  qsort(f, n, sizeof *f, by_face);
  for (size_t i = 0; i + 1 < n; i++) {
    double a, b;

    if (memcmp(f[i].v, f[i + 1].v, sizeof f->v) || f[i].cell >= n_layer ||
        f[i + 1].cell < n_layer)
      continue;
    a = tet_volume(m, m->tet[f[i].cell]);
    b = tet_volume(m, m->tet[f[i + 1].cell]);
    ratio[n_top++] = a > b ? a / b : b / a;
  }
  qsort(ratio, n_top, sizeof *ratio, by_value);
  if (n_top)
    printf("top_faces %zu\ntop_ratio_median %.3f\ntop_ratio_95 %.3f\n"
           "top_ratio_max %.3f\n",
           n_top, ratio[n_top / 2], ratio[n_top * 95 / 100], ratio[n_top - 1]);
  free(f);
  free(ratio);
  return 0;
}

static int others(const struct vg_mesh *m, size_t n_layer)
{
  struct vg_mesh rest = *m;
  float *angle;
  size_t below = 0;
  double least = 180;

  rest.tet += n_layer;
  rest.n_tet -= n_layer;
  angle = vg_alloc(rest.n_tet, sizeof *angle);
  if (!angle) return -1;
  vg_mesh_cell_quality(&rest, angle, NULL);
  for (size_t i = 0; i < rest.n_tet; i++) {
    least = fmin(least, angle[i]);
    below += angle[i] < 10;
  }
  printf("other_cells %zu\nangle_min %.2f\nbelow_10 %.4f\n", rest.n_tet, least,
         rest.n_tet ? 100. * (double)below / (double)rest.n_tet : 0.);
  free(angle);
  return top_ratio(m, n_layer);
}

static int box(char **argv)
{
  struct vg_cogsg_info info = VG_COGSG_INFO_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  int bad = vg_cogsg_read(argv[2], &m, &info, NULL, &err) < 0;

  if (bad) fprintf(stderr, "%s\n", err.text);
  if (!bad) {
    printf("layer_cells %zu\n", info.n_layer_cell);
    bad = columns(&m, info.n_layer_cell, atoi(argv[3]), strtod(argv[4], NULL),
                  strtod(argv[5], NULL), strtod(argv[6], NULL)) ||
          others(&m, info.n_layer_cell);
  }
  vg_mesh_release(&m);
  return bad;
}

/* first: distances at the wall ------------------------------------------ */

struct step {
  uint32_t root, node;
};

struct walls {
  const struct vg_mesh *m;
  size_t n;
  struct face *face;    /* [n] sorted; cell: the triangle */
  char *on;             /* [n_point] */
  uint32_t *first, *of; /* triangles at points */
  struct step *step;
  size_t n_step, cap_step, n_prism;
};

static int open_walls(struct walls *w)
{
  const struct vg_mesh *m = w->m;

  w->face = vg_alloc(m->n_tri, sizeof *w->face);
  w->on = vg_calloc(m->n_point, 1);
  w->first = vg_calloc(m->n_point + 2, sizeof *w->first);
  w->of = vg_alloc(3 * m->n_tri, sizeof *w->of);
  if (!w->face || !w->on || !w->first || !w->of) return -1;
  for (size_t i = 0; i < m->n_tri; i++) {
    struct face *f = &w->face[w->n];

    if (m->patch[m->tri_patch[i]].bc != 4) continue;
    memcpy(f->v, m->tri[i], sizeof f->v);
    for (int k = 0; k < 3; k++) w->on[f->v[k]] = 1, w->first[f->v[k] + 2]++;
    sort3(f->v);
    f->cell = (uint32_t)i;
    w->n++;
  }
  for (size_t i = 0; i <= m->n_point; i++) w->first[i + 1] += w->first[i];
  for (size_t i = 0; i < w->n; i++)
    for (int k = 0; k < 3; k++)
      w->of[w->first[w->face[i].v[k] + 1]++] = w->face[i].cell;
  qsort(w->face, w->n, sizeof *w->face, by_face);
  return w->n ? 0 : -1;
}

static void close_walls(struct walls *w)
{
  free(w->face);
  free(w->on);
  free(w->first);
  free(w->of);
  free(w->step);
}

static int is_wall_face(const struct walls *w, uint32_t a, uint32_t b,
                        uint32_t c)
{
  struct face f = { { a, b, c }, 0 };
  size_t lo = 0, hi = w->n;

  sort3(f.v);
  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;
    int cmp = 0;

    for (int k = 0; k < 3 && !cmp; k++)
      cmp = (w->face[mid].v[k] > f.v[k]) - (w->face[mid].v[k] < f.v[k]);
    if (!cmp) return 1;
    if (cmp < 0) lo = mid + 1;
    else hi = mid;
  }
  return 0;
}

static int add_step(struct walls *w, uint32_t root, uint32_t node)
{
  if (w->on[node]) return 0;
  if (vg_reserve(&w->step, &w->cap_step, w->n_step + 1, sizeof *w->step))
    return -1;
  w->step[w->n_step++] = (struct step){ root, node };
  return 0;
}

/* An off-wall node of a cell is above the nearest corner of its face, because
 * edges along the wall are far longer than the first height. */
static int add_nearest(struct walls *w, const uint32_t f[3], uint32_t node)
{
  double best = INFINITY;
  uint32_t root = f[0];

  for (int k = 0; k < 3; k++) {
    double d[3];

    minus(w->m->point[node], w->m->point[f[k]], d);
    if (dot(d, d) < best) {
      best = dot(d, d);
      root = f[k];
    }
  }
  return add_step(w, root, node);
}

/* Any three nodes of a cell other than a prism may be a wall face. */
static int walk_small(struct walls *w, const uint32_t *c, int n)
{
  int on = 0, bad = 0;

  for (int k = 0; k < n; k++) on += w->on[c[k]];
  for (int i = 0; on > 2 && i < n; i++)
    for (int j = i + 1; j < n; j++)
      for (int k = j + 1; k < n; k++) {
        const uint32_t f[3] = { c[i], c[j], c[k] };

        if (!w->on[c[i]] || !w->on[c[j]] || !w->on[c[k]] ||
            !is_wall_face(w, c[i], c[j], c[k]))
          continue;
        for (int q = 0; q < n && !bad; q++)
          if (q != i && q != j && q != k) bad = add_nearest(w, f, c[q]);
      }
  return bad;
}

static int walk(struct walls *w)
{
  const struct vg_mesh *m = w->m;
  int bad = 0;

  for (size_t i = 0; i < m->n_pri && !bad; i++) {
    const uint32_t *c = m->pri[i];

    for (int s = 0; s < 6; s += 3) {
      if (!is_wall_face(w, c[s], c[s + 1], c[s + 2])) continue;
      w->n_prism++;
      for (int k = 0; k < 3 && !bad; k++)
        bad = add_step(w, c[s + k], c[3 - s + k]);
    }
  }
  for (size_t i = 0; i < m->n_pyr && !bad; i++)
    bad = walk_small(w, m->pyr[i], 5);
  for (size_t i = 0; i < m->n_tet && !bad; i++)
    bad = walk_small(w, m->tet[i], 4);
  return bad;
}

/* Distance from p to the segment a b. */
static double to_segment(const double p[3], const double a[3],
                         const double b[3])
{
  double d[3], q[3], t;

  minus(b, a, d);
  minus(p, a, q);
  t = dot(d, q) / dot(d, d);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  for (int k = 0; k < 3; k++) q[k] -= t * d[k];
  return sqrt(dot(q, q));
}

static double to_triangle(const struct vg_mesh *m, const uint32_t t[3],
                          const double p[3])
{
  double u[3], v[3], n[3], q[3], best = INFINITY;
  int inside = 1;

  minus(m->point[t[1]], m->point[t[0]], u);
  minus(m->point[t[2]], m->point[t[0]], v);
  cross(u, v, n);
  for (int k = 0; k < 3; k++) {
    double e[3], s[3];

    minus(m->point[t[(k + 1) % 3]], m->point[t[k]], e);
    minus(p, m->point[t[k]], q);
    cross(n, e, s);
    inside &= dot(s, q) >= 0;
    best = fmin(best, to_segment(p, m->point[t[k]], m->point[t[(k + 1) % 3]]));
  }
  return inside ? fabs(dot(q, n)) / sqrt(dot(n, n)) : best;
}

static int by_step(const void *a, const void *b)
{
  const struct step *x = a, *y = b;

  if (x->root != y->root) return x->root < y->root ? -1 : 1;
  return (x->node > y->node) - (x->node < y->node);
}

static void judge_steps(struct walls *w, double height)
{
  size_t n = 0, n_root = 0, off = 0, n_wall = 0;
  double worst = 0, at[3] = { 0, 0, 0 };

  qsort(w->step, w->n_step, sizeof *w->step, by_step);
  for (size_t i = 0; i < w->n_step; i++) {
    const struct step *s = &w->step[i];
    double d = INFINITY;

    if (i && !by_step(s, s - 1)) continue;
    for (uint32_t j = w->first[s->root]; j < w->first[s->root + 1]; j++)
      d = fmin(d, to_triangle(w->m, w->m->tri[w->of[j]], w->m->point[s->node]));
    if (fabs(d / height - 1) > worst) {
      worst = fabs(d / height - 1);
      memcpy(at, w->m->point[s->root], sizeof at);
    }
    off += fabs(d / height - 1) > 0.01;
    n_root += !i || s->root != s[-1].root;
    n++;
  }
  for (size_t i = 0; i < w->m->n_point; i++) n_wall += w->on[i] != 0;
  printf("wall_points %zu\nwith_level %zu\nfirst_points %zu\n"
         "first_off_1_percent %zu\nfirst_error_percent %.4f\n"
         "worst_at %g %g %g\n"
         "wall_faces %zu\nfaces_with_prism_percent %.4f\n",
         n_wall, n_root, n, off, 100 * worst, at[0], at[1], at[2], w->n,
         100. * (double)w->n_prism / (double)w->n);
}

static int first(char **argv)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct walls w = { .m = &m };
  int bad = vg_mesh_read(argv[2], &m, NULL, &err) < 0;

  if (bad) fprintf(stderr, "%s\n", err.text);
  bad = bad || open_walls(&w) || walk(&w);
  if (!bad) judge_steps(&w, strtod(argv[3], NULL));
  else fprintf(stderr, "%s: not measured\n", argv[2]);
  close_walls(&w);
  vg_mesh_release(&m);
  return bad;
}

int main(int argc, char **argv)
{
  if (argc == 7 && !strcmp(argv[1], "box")) return box(argv);
  if (argc == 4 && !strcmp(argv[1], "first")) return first(argv);
  fprintf(stderr, "vg_measure_layers box MESH.cogsg PATCH DELTA1 R1 R2\n"
                  "vg_measure_layers first MESH.b8.ugrid HEIGHT\n");
  return 2;
}
