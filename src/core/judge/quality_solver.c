/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality in the terms of solvers: sweep over the faces and cells. */
#include "core/judge/quality_solver.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/judge/quality_solver_parts.h"

vg_status vg_solver_begin(struct vg_solver_sweep *s, const struct vg_mesh *m,
                          const uint64_t first[VG_CELL_KINDS],
                          const float *volume, struct vg_stats *f,
                          struct vg_error *err)
{
  size_t n = vg_mesh_n_cell(m);

  assert(s && m && f);
  if (vg_reserve(&s->quality, &s->room[0], n, sizeof *s->quality) ||
      vg_reserve(&s->determinant, &s->room[1], n, sizeof *s->determinant) ||
      vg_reserve(&s->border, &s->room[2], n, 1) ||
      vg_reserve(&s->middle, &s->room[3], n - m->n_tet, sizeof *s->middle))
    return vg_fail_memory(err, "the quality of the cells");
  if (n) memset(s->border, 0, n);
  s->m = m;
  s->n_cell = n;
  memcpy(s->first, first, sizeof s->first);
  s->f = f;
  s->volume = volume;
  s->batch.n = 0;
  return VG_OK;
}

void vg_solver_release(struct vg_solver_sweep *s)
{
  free(s->quality);
  free(s->determinant);
  free(s->border);
  free(s->middle);
  memset(s, 0, sizeof *s);
}

size_t vg_solver_bytes(const struct vg_mesh *m)
{
  size_t mixed = m->n_pyr + m->n_pri + m->n_hex;

  return (m->n_tet + mixed) * (2 * sizeof(float) + 1) +
         mixed * sizeof(struct vg_cell_middle);
}

/* --- cells ---------------------------------------------------------------- */

/* Nodes of a cell, and its kind. */
static inline const uint32_t *cell_of(const struct vg_mesh *m, size_t cell,
                                      int *kind)
{
  size_t at = cell - m->n_tet;

  *kind = VG_CELL_TET;
  if (cell < m->n_tet) return m->tet[cell];
  *kind = VG_CELL_PYR;
  if (at < m->n_pyr) return m->pyr[at];
  at -= m->n_pyr;
  *kind = VG_CELL_PRI;
  if (at < m->n_pri) return m->pri[at];
  *kind = VG_CELL_HEX;
  return m->hex[at - m->n_pri];
}

/* Corners of face j; returns their number. */
static int face_corners(const double (*point)[3], int kind,
                        const uint32_t *node, int j, double x[4][3])
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  int n = j < f->n_tri ? 3 : 4;

  for (int i = 0; i < n; i++)
    memcpy(x[i], point[node[f->node[j][i]]], sizeof x[i]);
  return n;
}

static inline void tet_centre(const struct vg_mesh *m, const uint32_t n[4],
                              double out[3])
{
  const double *a = m->point[n[0]], *b = m->point[n[1]];
  const double *c = m->point[n[2]], *d = m->point[n[3]];

  for (int k = 0; k < 3; k++) out[k] = (a[k] + b[k] + c[k] + d[k]) * 0.25;
}

static inline void centre_of(const struct vg_solver_sweep *s, size_t cell,
                             double out[3])
{
  const struct vg_mesh *m = s->m;

  if (cell < m->n_tet) tet_centre(m, m->tet[cell], out);
  else memcpy(out, s->middle[cell - m->n_tet].at, sizeof *out * 3);
}

static float volume_of(const struct vg_solver_sweep *s, size_t cell)
{
  return cell < s->m->n_tet ? s->volume[cell]
                            : s->middle[cell - s->m->n_tet].volume;
}

static uint64_t number_of(const struct vg_solver_sweep *s, size_t cell)
{
  const struct vg_mesh *m = s->m;
  size_t at = cell - m->n_tet;

  if (cell < m->n_tet) return s->first[VG_CELL_TET] + cell;
  if (at < m->n_pyr) return s->first[VG_CELL_PYR] + at;
  at -= m->n_pyr;
  if (at < m->n_pri) return s->first[VG_CELL_PRI] + at;
  return s->first[VG_CELL_HEX] + at - m->n_pri;
}

/* From the area vectors of n faces. */
static double determinant_of(const double (*a)[3], int n)
{
  double mean = 0, t[6] = { 0 }, scale;

  for (int i = 0; i < n; i++) mean += vg_norm(a[i]);
  if (!(mean > 0)) return 0;
  scale = n / mean;
  for (int i = 0; i < n; i++) {
    const double x = a[i][0] * scale, y = a[i][1] * scale, z = a[i][2] * scale;

    t[0] += x * x;
    t[1] += x * y;
    t[2] += x * z;
    t[3] += y * y;
    t[4] += y * z;
    t[5] += z * z;
  }
  return fabs(t[0] * (t[3] * t[5] - t[4] * t[4]) -
              t[1] * (t[1] * t[5] - t[4] * t[2]) +
              t[2] * (t[1] * t[4] - t[3] * t[2])) /
         8;
}

/* From the faces of a cell that are not on the boundary. */
static double inner_determinant(const struct vg_solver_sweep *s, size_t cell)
{
  double a[6][3];
  int kind, n = 0;
  const uint32_t *node = cell_of(s->m, cell, &kind);

  for (int j = 0; j < vg_cell_faces[kind].n_face; j++) {
    double x[4][3];
    struct vg_face_shape shape;
    int corners;

    if (s->border[cell] >> j & 1) continue;
    corners = face_corners((const double(*)[3])s->m->point, kind, node, j, x);
    vg_face_shape((const double(*)[3])x, corners, &shape);
    memcpy(a[n++], shape.area, sizeof shape.area);
  }
  return determinant_of((const double(*)[3])a, n);
}

double vg_faces_middle(const struct vg_face_shape *shape, int n_face,
                       double at[3])
{
  double mean[3] = { 0, 0, 0 }, sum[3] = { 0, 0, 0 }, total = 0;

  for (int j = 0; j < n_face; j++)
    for (int k = 0; k < 3; k++) mean[k] += shape[j].centre[k] / n_face;
  for (int j = 0; j < n_face; j++) {
    const double *c = shape[j].centre;
    double d[3], part;

    vg_sub(c, mean, d);
    part = vg_dot(shape[j].area, d);
    total += part;
    for (int k = 0; k < 3; k++) sum[k] += part * (0.75 * c[k] + 0.25 * mean[k]);
  }
  for (int k = 0; k < 3; k++) at[k] = total != 0 ? sum[k] / total : mean[k];
  return total;
}

/* Least signed square of the cosines between A and f, for a cell with its
 * centre at `at`. */
static double least_cosine2(const struct vg_face_shape *shape, int n_face,
                            const double at[3])
{
  double least = 1;

  for (int j = 0; j < n_face; j++) {
    double f[3], product, size2;

    vg_sub(shape[j].centre, at, f);
    product = vg_dot(shape[j].area, f);
    size2 = vg_dot(shape[j].area, shape[j].area) * vg_dot(f, f);
    product = size2 > 0 ? product * fabs(product) / size2 : -1;
    if (product < least) least = product;
  }
  return least;
}

double vg_cell_cosine2(const double (*x)[3], int kind, const uint32_t *node)
{
  assert(kind > VG_CELL_TET && kind < VG_CELL_KINDS);

  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  struct vg_face_shape shape[6];
  double at[3];

  for (int j = 0; j < f->n_face; j++) {
    double corner[4][3];
    const int n = face_corners(x, kind, node, j, corner);

    vg_face_shape((const double(*)[3])corner, n, &shape[j]);
  }
  vg_faces_middle(shape, f->n_face, at);
  return least_cosine2(shape, f->n_face, at);
}

/* Centre, volume, determinant and the cosines between A and f. */
static void measure_mixed(struct vg_solver_sweep *s, size_t cell)
{
  struct vg_cell_middle *middle = &s->middle[cell - s->m->n_tet];
  struct vg_face_shape shape[6];
  double area[6][3];
  int kind;
  const uint32_t *node = cell_of(s->m, cell, &kind);
  int n_face = vg_cell_faces[kind].n_face;

  for (int j = 0; j < n_face; j++) {
    double x[4][3];
    int n = face_corners((const double(*)[3])s->m->point, kind, node, j, x);

    vg_face_shape((const double(*)[3])x, n, &shape[j]);
    memcpy(area[j], shape[j].area, sizeof area[j]);
  }
  s->determinant[cell] = (float)determinant_of((const double(*)[3])area,
                                               n_face);
  middle->volume = (float)(vg_faces_middle(shape, n_face, middle->at) / 3);
  s->quality[cell] = (float)least_cosine2(shape, n_face, middle->at);
}

void vg_solver_measure_mixed(struct vg_solver_sweep *s)
{
  for (size_t i = s->m->n_tet; i < s->n_cell; i++) measure_mixed(s, i);
}

/* quality: signed square of the smallest cosine. */
static void count_quality(struct vg_stats *f, uint64_t cell,
                          const double centre[3], float quality)
{
  double q = sqrt(fabs((double)quality)), bin;

  q = q < 1 ? q : 1; /* NaN: 1, in a mesh that is not valid */
  if (quality < 0) q = -q;
  bin = q * VG_HIST_UNIT;
  bin = bin > 0 ? bin : 0;
  f->n.quality[bin < VG_HIST_UNIT ? (size_t)bin : VG_HIST_UNIT - 1]++;
  f->n.sum_quality += (uint64_t)(int64_t)vg_fixed(q);
  if (-q > f->most[VG_MOST_SLANTED]) f->most[VG_MOST_SLANTED] = -q;
  if (centre && vg_places_admit(&f->places[VG_WORST_QUALITY], q))
    vg_places_add(&f->places[VG_WORST_QUALITY],
                  &(struct vg_worst_place){
                    (size_t)cell, q, { centre[0], centre[1], centre[2] } });
}

static void count_determinant(struct vg_stats *f, double determinant)
{
  f->n.n_determinant += determinant < VG_LIMIT_DETERMINANT;
  if (-determinant > f->most[VG_MOST_SINGULAR])
    f->most[VG_MOST_SINGULAR] = -determinant;
}

/* --- faces ---------------------------------------------------------------- */

static void note_face(struct vg_places *list, uint64_t cell, double value,
                      const double at[3])
{
  struct vg_worst_place p = { (size_t)cell, value, { at[0], at[1], at[2] } };

  vg_places_add(list, &p);
}

static void count_skewness(struct vg_stats *f, double skewness)
{
  double bin = 4 * skewness;

  f->n.skewness[bin < VG_HIST_SKEW ? (size_t)bin : VG_HIST_SKEW - 1]++;
  if (skewness > f->most[VG_MOST_SKEWED]) f->most[VG_MOST_SKEWED] = skewness;
}

static void count_face(struct vg_stats *f, const struct vg_face_figures *g)
{
  f->n.solver_angle[vg_angle_bin(g->cosine)]++;
  f->n.sum_cosine += (uint64_t)(int64_t)vg_fixed(g->cosine);
  if (-g->cosine > f->most[VG_MOST_OBLIQUE])
    f->most[VG_MOST_OBLIQUE] = -g->cosine;
  count_skewness(f, g->skewness);
  f->n.n_weight += g->weight < VG_LIMIT_WEIGHT;
  if (-g->weight > f->most[VG_MOST_LOPSIDED])
    f->most[VG_MOST_LOPSIDED] = -g->weight;
}

static void count_volumes(struct vg_stats *f, float v, float w)
{
  double ratio = vg_volume_ratio(v, w);

  f->n.n_volume_ratio += ratio < VG_LIMIT_VOLUME_RATIO;
  if (-ratio > f->most[VG_MOST_UNEQUAL]) f->most[VG_MOST_UNEQUAL] = -ratio;
}

static int is_notable(const struct vg_stats *f, double cosine, double skewness)
{
  return vg_places_admit(&f->places[VG_WORST_ANGLE], cosine) ||
         vg_places_admit(&f->places[VG_WORST_SKEWNESS], -skewness);
}

static void note_joint(struct vg_stats *f, uint64_t cell,
                       const struct vg_face_figures *g, const double at[3])
{
  if (vg_places_admit(&f->places[VG_WORST_ANGLE], g->cosine))
    note_face(&f->places[VG_WORST_ANGLE], cell, g->cosine, at);
  if (vg_places_admit(&f->places[VG_WORST_SKEWNESS], -g->skewness))
    note_face(&f->places[VG_WORST_SKEWNESS], cell, -g->skewness, at);
}

static void lower(struct vg_solver_sweep *s, uint32_t cell, float quality)
{
  if (quality < s->quality[cell]) s->quality[cell] = quality;
}

/* Is the node one of n? */
static int has_node(const uint32_t *node, int n, uint32_t wanted)
{
  for (int i = 0; i < n; i++)
    if (node[i] == wanted) return 1;
  return 0;
}

/* The face of a cell of which all nodes are among these n; -1: none. */
static int find_face(int kind, const uint32_t *cell, const uint32_t *node,
                     int n)
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];

  for (int j = 0; j < f->n_face; j++) {
    int width = j < f->n_tri ? 3 : 4, same = 0;

    while (same < width && has_node(node, n, cell[f->node[j][same]])) same++;
    if (same == width) return j;
  }
  return -1;
}

/* The node of a that b does not have: 0 to 3. */
static inline unsigned apart(const uint32_t a[4], const uint32_t b[4])
{
  unsigned at = 0;

  for (unsigned k = 1; k < 4; k++)
    at += k & -(unsigned)((a[k] != b[0]) & (a[k] != b[1]) & (a[k] != b[2]) &
                          (a[k] != b[3]));
  return at & 3;
}

/* Nodes of a tetrahedron: the one opposite a face, and those of the face. */
static const uint8_t from_node[4][4] = {
  { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 0, 1, 3 }, { 3, 0, 2, 1 }
};

static inline void put_point(struct vg_solver_batch *b, size_t i, size_t t,
                             const double x[3])
{
  for (int k = 0; k < 3; k++) b->x[i][k][t] = x[k];
}

static inline void collect_tets(struct vg_solver_sweep *s, size_t t)
{
  struct vg_solver_batch *b = &s->batch;
  const struct vg_mesh *m = s->m;
  uint32_t lo = b->cell[0][t], hi = b->cell[1][t];
  const uint32_t *n = m->tet[lo], *o = m->tet[hi];
  const uint8_t *at = from_node[apart(n, o)];
  /* The other nodes cancel. Modulo 2^32, so that it is in range. */
  uint32_t far = o[0] + o[1] + o[2] + o[3] - n[at[1]] - n[at[2]] - n[at[3]];

  if (far >= m->n_point) far = o[0]; /* not a valid mesh */
  put_point(b, 0, t, m->point[n[at[0]]]);
  put_point(b, 1, t, m->point[far]);
  put_point(b, 2, t, m->point[n[at[1]]]);
  put_point(b, 3, t, m->point[n[at[2]]]);
  put_point(b, 4, t, m->point[n[at[3]]]);
  b->share[0][t] = b->share[1][t] = 0.25;
  b->volume[0][t] = s->volume[lo];
  b->volume[1][t] = s->volume[hi];
}

/* The end of face j at a cell. */
static void end_of(const struct vg_solver_sweep *s, uint32_t cell, int j,
                   struct vg_face_end *out)
{
  /* The node of a tetrahedron opposite each face. */
  static const uint8_t opposite[4] = { 3, 2, 0, 1 };

  out->share = cell < s->m->n_tet ? 0.25 : 1;
  if (cell < s->m->n_tet)
    memcpy(out->at, s->m->point[s->m->tet[cell][opposite[j]]], sizeof out->at);
  else centre_of(s, cell, out->at);
}

/* The face of a cell whose nodes are these, bit by bit, plus 1; 0: none. */
static const uint8_t face_of[VG_CELL_KINDS][256] = {
  { [0x07] = 1, [0x0b] = 2, [0x0e] = 3, [0x0d] = 4 },
  { [0x07] = 1, [0x16] = 2, [0x1c] = 3, [0x0d] = 4, [0x1b] = 5 },
  { [0x07] = 1, [0x38] = 2, [0x1b] = 3, [0x36] = 4, [0x2d] = 5 },
  { [0x0f] = 1, [0xf0] = 2, [0x33] = 3, [0x66] = 4, [0xcc] = 5, [0x99] = 6 }
};

/* Nodes of a that b has too, and the other way round. */
static inline void common(const uint32_t *a, int n_a, const uint32_t *b,
                          int n_b, unsigned mask[2])
{
  mask[0] = mask[1] = 0;
  for (int i = 0; i < n_a; i++)
    for (int k = 0; k < n_b; k++) {
      unsigned same = a[i] == b[k];

      mask[0] |= same << i;
      mask[1] |= same << k;
    }
}

/* Finds the common face of two cells: its number in each of them. Returns 0 for
 * cells without a common face. */
static int find_common(const struct vg_mesh *m, uint32_t lo, uint32_t hi,
                       int face[2])
{
  int kind, other;
  const uint32_t *a = cell_of(m, lo, &kind), *b = cell_of(m, hi, &other);
  unsigned mask[2];

  if (kind == VG_CELL_PRI && other == VG_CELL_PRI) common(a, 6, b, 6, mask);
  else
    common(a, vg_cell_faces[kind].n_node, b, vg_cell_faces[other].n_node, mask);
  face[0] = face_of[kind][mask[0]] - 1;
  face[1] = face_of[other][mask[1]] - 1;
  return face[0] >= 0 && face[1] >= 0; /* else the mesh is not valid */
}

static void collect_mixed(struct vg_solver_sweep *s, size_t t)
{
  struct vg_solver_batch *b = &s->batch;
  uint32_t lo = b->cell[0][t], hi = b->cell[1][t];
  int kind;
  const uint32_t *n = cell_of(s->m, lo, &kind);
  double x[4][3];

  face_corners((const double(*)[3])s->m->point, kind, n, b->face[0][t], x);
  for (size_t i = 0; i < 2; i++) {
    struct vg_face_end end;

    end_of(s, b->cell[i][t], b->face[i][t], &end);
    put_point(b, i, t, end.at);
    b->share[i][t] = end.share;
  }
  for (size_t i = 0; i < 3; i++) put_point(b, 2 + i, t, x[i]);
  b->volume[0][t] = volume_of(s, lo);
  b->volume[1][t] = volume_of(s, hi);
}

static void note_lane(struct vg_solver_sweep *s, size_t t)
{
  const struct vg_solver_batch *b = &s->batch;
  const struct vg_face_figures g = { b->cosine[t], b->skewness[t],
                                     b->weight[t] };
  double at[3];

  if (!is_notable(s->f, g.cosine, g.skewness)) return;
  for (int k = 0; k < 3; k++)
    at[k] = (b->x[2][k][t] + b->x[3][k][t] + b->x[4][k][t]) * (1 / 3.);
  note_joint(s->f, number_of(s, b->cell[0][t]), &g, at);
}

static void raise_to(double *most, double value)
{
  if (value > *most) *most = value;
}

static void count_sums(struct vg_stats *f, size_t n,
                       const struct vg_solver_sums *sums)
{
  f->n.n_joined += n;
  f->n.sum_cosine += (uint64_t)(int64_t)sums->cosine;
  f->n.n_weight += sums->n_weight;
  f->n.n_volume_ratio += sums->n_volume_ratio;
  if (!n) return;
  raise_to(&f->most[VG_MOST_OBLIQUE], -sums->cosine_least);
  raise_to(&f->most[VG_MOST_SKEWED], sums->skewness_most);
  raise_to(&f->most[VG_MOST_LOPSIDED], -sums->weight_least);
  raise_to(&f->most[VG_MOST_UNEQUAL], -sums->ratio_least);
}

/* For fields of the cells. */
static void note_cell(const struct vg_solver_sweep *s, uint32_t cell,
                      double cosine, double skewness)
{
  if (!s->oblique) return;
  if (cosine < (double)s->oblique[cell]) s->oblique[cell] = (float)cosine;
  if (skewness > (double)s->skewed[cell]) s->skewed[cell] = (float)skewness;
}

/* The faces are collected together, so that the processor loads the points of
 * many at the same time. */
void vg_solver_empty_batch(struct vg_solver_sweep *s)
{
  struct vg_solver_batch *b = &s->batch;
  struct vg_solver_sums sums;

  for (size_t t = 0; t < b->n; t++)
    if (b->cell[1][t] < s->m->n_tet) collect_tets(s, t);
    else collect_mixed(s, t);
  vg_solver_measure_batch(b, &sums);
  count_sums(s->f, b->n, &sums);
  for (size_t t = 0; t < b->n; t++) {
    s->f->n.solver_angle[b->angle_bin[t]]++;
    s->f->n.skewness[b->skewness_bin[t]]++;
    lower(s, b->cell[0][t], b->quality[t]);
    lower(s, b->cell[1][t], b->quality[t]);
  }
  if (is_notable(s->f, sums.cosine_least, sums.skewness_most))
    for (size_t t = 0; t < b->n; t++) note_lane(s, t);
  for (size_t t = 0; s->oblique && t < b->n; t++)
    for (int i = 0; i < 2; i++)
      note_cell(s, b->cell[i][t], b->cosine[t], b->skewness[t]);
  b->n = 0;
}

/* A face with these corners, which is measured at once. */
static void measure_one(struct vg_stats *f, uint64_t cell,
                        const struct vg_face_end end[2], const double x[4][3],
                        int n, struct vg_face_figures *g)
{
  struct vg_face_shape shape;

  vg_face_shape(x, n, &shape);
  vg_face_measure(end, x, n, &shape, g);
  f->n.n_joined++;
  count_face(f, g);
  if (is_notable(f, g->cosine, g->skewness))
    note_joint(f, cell, g, shape.centre);
}

void vg_solver_join_mixed(struct vg_solver_sweep *s, uint32_t lo, uint32_t hi)
{
  struct vg_solver_batch *b = &s->batch;
  struct vg_face_end end[2];
  int kind, n, face[2];
  const uint32_t *a = cell_of(s->m, lo, &kind);
  struct vg_face_figures g;
  double x[4][3];

  if (!find_common(s->m, lo, hi, face)) return;
  if (face[0] < vg_cell_faces[kind].n_tri) {
    for (int i = 0; i < 2; i++) b->face[i][b->n] = (uint8_t)face[i];
    b->cell[0][b->n] = lo;
    b->cell[1][b->n] = hi;
    if (++b->n == VG_SOLVER_BATCH) vg_solver_empty_batch(s);
    return;
  }
  end_of(s, lo, face[0], &end[0]);
  end_of(s, hi, face[1], &end[1]);
  n = face_corners((const double(*)[3])s->m->point, kind, a, face[0], x);
  count_volumes(s->f, volume_of(s, lo), volume_of(s, hi));
  measure_one(s->f, number_of(s, lo), end, (const double(*)[3])x, n, &g);
  lower(s, lo, vg_signed_square(g.cosine));
  lower(s, hi, vg_signed_square(g.cosine));
  note_cell(s, lo, g.cosine, g.skewness);
  note_cell(s, hi, g.cosine, g.skewness);
}

void vg_solver_bound(struct vg_solver_sweep *s, uint32_t cell,
                     const uint32_t node[4])
{
  int kind, n = node[3] == VG_NO_NODE ? 3 : 4, j;
  const uint32_t *of = cell_of(s->m, cell, &kind);
  double x[4][3], centre[3], skewness;
  struct vg_face_shape shape;

  j = find_face(kind, of, node, n);
  if (j < 0) return; /* not a valid mesh */
  s->border[cell] |= (uint8_t)(1 << j);
  n = face_corners((const double(*)[3])s->m->point, kind, of, j, x);
  centre_of(s, cell, centre);
  vg_face_shape((const double(*)[3])x, n, &shape);
  skewness = vg_face_border_skewness(centre, (const double(*)[3])x, n, &shape);
  s->f->n.n_border++;
  count_skewness(s->f, skewness);
  note_cell(s, cell, 1, skewness);
  if (vg_places_admit(&s->f->places[VG_WORST_SKEWNESS], -skewness))
    note_face(&s->f->places[VG_WORST_SKEWNESS], number_of(s, cell), -skewness,
              shape.centre);
}

void vg_solver_finish(struct vg_solver_sweep *s, const uint8_t *n_open)
{
  vg_solver_empty_batch(s);
  for (size_t i = 0; i < s->n_cell; i++) {
    double centre[3], q2 = (double)s->quality[i];
    const struct vg_places *list = &s->f->places[VG_WORST_QUALITY];

    count_determinant(s->f, s->border[i] ? inner_determinant(s, i)
                                         : (double)s->determinant[i]);
    if (n_open && n_open[i]) continue;
    /* The centre is needed if the cell may be one of the worst. */
    if (list->n == VG_WORST && q2 > 0 &&
        q2 * (1 - 1e-9) > list->place[VG_WORST - 1].value *
                            fabs(list->place[VG_WORST - 1].value)) {
      count_quality(s->f, 0, NULL, s->quality[i]);
      continue;
    }
    centre_of(s, i, centre);
    count_quality(s->f, number_of(s, i), centre, s->quality[i]);
  }
}

/* --- between slices ------------------------------------------------------- */

void vg_solver_side(const struct vg_solver_sweep *s, uint32_t cell,
                    const uint32_t node[4], uint32_t n_open,
                    struct vg_solver_side *out)
{
  int kind, n = node[3] == VG_NO_NODE ? 3 : 4;
  const uint32_t *of = cell_of(s->m, cell, &kind);
  int j = find_face(kind, of, node, n);
  uint64_t number = number_of(s, cell);

  memset(out, 0, sizeof *out);
  if (j >= 0) {
    struct vg_face_end end;

    face_corners((const double(*)[3])s->m->point, kind, of, j, out->corner);
    end_of(s, cell, j, &end);
    if (kind == VG_CELL_TET) memcpy(out->corner[3], end.at, sizeof end.at);
  }
  centre_of(s, cell, out->centre);
  out->cell[0] = (uint32_t)number;
  out->cell[1] = (uint32_t)(number >> 32);
  out->quality = s->quality[cell];
  out->volume = volume_of(s, cell);
  out->n_open = n_open;
  out->is_triangle = n == 3;
  out->is_tet = kind == VG_CELL_TET;
}

static uint64_t number_at(const uint32_t cell[2])
{
  return (uint64_t)cell[1] << 32 | cell[0];
}

void vg_solver_meet(struct vg_stats *f, const struct vg_solver_side *a,
                    const struct vg_solver_side *b,
                    struct vg_solver_cell rest[2], int *n)
{
  const struct vg_solver_side *side[2] = { a, b };
  struct vg_face_end end[2];
  struct vg_face_figures g;

  if (number_at(b->cell) < number_at(a->cell)) {
    side[0] = b;
    side[1] = a;
  }
  *n = 0;
  count_volumes(f, side[0]->volume, side[1]->volume);
  for (int i = 0; i < 2; i++) {
    const double *at = side[i]->is_tet ? side[i]->corner[3] : side[i]->centre;

    end[i].share = side[i]->is_tet ? 0.25 : 1;
    memcpy(end[i].at, at, sizeof end[i].at);
  }
  measure_one(f, number_at(side[0]->cell), end, side[0]->corner,
              side[0]->is_triangle ? 3 : 4, &g);
  for (int i = 0; i < 2; i++) {
    float quality = vg_signed_square(g.cosine);

    if (side[i]->quality < quality) quality = side[i]->quality;
    if (side[i]->n_open == 1) {
      count_quality(f, number_at(side[i]->cell), side[i]->centre, quality);
      continue;
    }
    memset(&rest[*n], 0, sizeof rest[*n]);
    memcpy(rest[*n].cell, side[i]->cell, sizeof rest->cell);
    memcpy(rest[*n].centre, side[i]->centre, sizeof rest->centre);
    rest[(*n)++].quality = quality;
  }
}

void vg_solver_meet_cell(struct vg_stats *f, const struct vg_solver_cell *c,
                         size_t n)
{
  float least = c->quality;

  for (size_t i = 1; i < n; i++)
    if (c[i].quality < least) least = c[i].quality;
  count_quality(f, number_at(c->cell), c->centre, least);
}
