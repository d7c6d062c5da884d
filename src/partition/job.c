#include "partition/job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/hilbert.h"
#include "core/predicates.h"
#include "base/bytes.h"

void vg_front_release(struct vg_front *f)
{
  free(f->x);
  free(f->name);
  free(f->face);
  memset(f, 0, sizeof *f);
}

void vg_front_put(struct vg_writer *w, const struct vg_front *f, int names)
{
  uint64_t count[2] = {f->n_point, f->n_face};

  vg_put(w, 2, sizeof *count, count);
  vg_put(w, f->n_point, sizeof *f->x, f->x);
  vg_put(w, f->n_face, sizeof *f->face, f->face);
  if (names) vg_put(w, f->n_point, sizeof *f->name, f->name);
}

static int all_below(size_t n, const uint32_t *v, size_t limit)
{
  for (size_t i = 0; i < n; i++)
    if (v[i] >= limit) return 0;
  return 1;
}

void vg_front_get(struct vg_reader *r, struct vg_front *f, int names)
{
  uint64_t count[2] = {0, 0};

  memset(f, 0, sizeof *f);
  vg_get(r, 2, sizeof *count, count);
  f->n_point = count[0];
  f->n_face = count[1];
  f->x = vg_get_array(r, f->n_point, sizeof *f->x);
  f->face = vg_get_array(r, f->n_face, sizeof *f->face);
  if (names) f->name = vg_get_array(r, f->n_point, sizeof *f->name);
  if (!r->bad && !all_below(3 * f->n_face, f->face[0], f->n_point))
    r->bad = 1;
  if (r->bad) vg_front_release(f);
}

/* --- parts --------------------------------------------------------------- */

static uint32_t root_of(uint32_t *parent, uint32_t k)
{
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

/* Half edges by their lower point. */
struct edges {
  uint32_t *first;           /* [n_point + 2] */
  uint32_t *half;            /* [3 n_face] 3 * face + corner that begins it */
};

static void ends_of(const struct vg_front *f, uint32_t half, uint32_t *from,
                    uint32_t *to)
{
  *from = f->face[half / 3][half % 3];
  *to = f->face[half / 3][(half % 3 + 1) % 3];
}

static int edges_init(struct edges *e, const struct vg_front *f)
{
  e->first = vg_calloc(f->n_point + 2, sizeof *e->first);
  e->half = vg_alloc(3 * f->n_face, sizeof *e->half);
  if (!e->first || !e->half) return -1;
  for (uint32_t h = 0; h < 3 * f->n_face; h++) {
    uint32_t a, b;

    ends_of(f, h, &a, &b);
    e->first[(a < b ? a : b) + 2]++;
  }
  for (size_t p = 0; p < f->n_point; p++) e->first[p + 2] += e->first[p + 1];
  for (uint32_t h = 0; h < 3 * f->n_face; h++) {
    uint32_t a, b;

    ends_of(f, h, &a, &b);
    e->half[e->first[(a < b ? a : b) + 1]++] = h;
  }
  return 0;
}

static void unite(uint32_t *parent, uint32_t a, uint32_t b)
{
  a = root_of(parent, a);
  b = root_of(parent, b);
  if (a < b) parent[b] = a;
  else parent[a] = b;
}

/* The corner of a half edge's face that is not on the edge. */
static const double *apex(const struct vg_front *f, uint32_t half)
{
  return f->x[f->face[half / 3][(half % 3 + 2) % 3]];
}

static void minus(const double a[3], const double b[3], double d[3])
{
  for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

static double triple(const double a[3], const double b[3], const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) +
         a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* How far a face is turned about its edge until it falls on another, through
 * the void that it faces: grows with the angle, from 0 to 4. */
static double turn(const struct vg_front *f, uint32_t half, uint32_t other)
{
  uint32_t from, to;
  double e[3], u[3], v[3], n, c, s;

  ends_of(f, half, &from, &to);
  minus(f->x[to], f->x[from], e);
  minus(apex(f, half), f->x[from], u);
  minus(apex(f, other), f->x[from], v);
  n = dot(e, e);
  c = dot(u, v) - dot(u, e) * dot(v, e) / n;
  s = triple(e, u, v) / sqrt(n);
  n = fabs(c) + fabs(s);
  if (!(n > 0)) return 0;
  return s >= 0 ? (c >= 0 ? s / n : 2 - s / n)
                : (c < 0 ? 2 - s / n : 4 + s / n);
}

/* Where more than two faces meet in an edge, voids touch each other there; a
 * face belongs to the one it meets first, turned into its own void. */
static void unite_crowd(const struct vg_front *f, uint32_t *parent, size_t n,
                        const uint32_t *half)
{
  for (size_t i = 0; i < n; i++) {
    uint32_t from, to, a, b, best = UINT32_MAX;
    double least = 5;

    ends_of(f, half[i], &from, &to);
    for (size_t j = 0; j < n; j++) {
      double angle;

      ends_of(f, half[j], &a, &b);
      if (a != to) continue;
      angle = turn(f, half[i], half[j]);
      if (angle < least) {
        least = angle;
        best = half[j];
      }
    }
    if (best != UINT32_MAX) unite(parent, half[i] / 3, best / 3);
  }
}

/* All edges whose lower point is p. */
static void unite_around(const struct vg_front *f, const struct edges *e,
                         uint32_t *parent, size_t p)
{
  uint32_t *list = e->half + e->first[p];
  size_t n = e->first[p + 1] - e->first[p], same;

  for (; n; n -= same, list += same) {
    uint32_t a, b, far;

    ends_of(f, list[0], &a, &b);
    far = a < b ? b : a;
    same = 1;
    for (size_t j = 1; j < n; j++) {
      uint32_t keep = list[j];

      ends_of(f, keep, &a, &b);
      if ((a < b ? b : a) != far) continue;
      list[j] = list[same];
      list[same++] = keep;
    }
    if (same == 2) unite(parent, list[0] / 3, list[1] / 3);
    else unite_crowd(f, parent, same, list);
  }
}

vg_status vg_front_parts(const struct vg_front *f, uint32_t *part, size_t *n,
                         struct vg_error *err)
{
  struct edges e = {0};
  uint32_t *parent = vg_alloc(f->n_face, sizeof *parent);
  vg_status st = VG_OK;

  *n = 0;
  if (!parent || edges_init(&e, f)) {
    st = vg_fail_memory(err, "the parts of a front");
    goto done;
  }
  for (uint32_t i = 0; i < f->n_face; i++) parent[i] = i;
  for (size_t p = 0; p < f->n_point; p++) unite_around(f, &e, parent, p);
  for (uint32_t i = 0; i < f->n_face; i++) {
    uint32_t r = root_of(parent, i);

    part[i] = r == i ? (uint32_t)(*n)++ : part[r];
  }
done:
  free(parent);
  free(e.first);
  free(e.half);
  return st;
}

double vg_front_volume(const struct vg_front *f)
{
  double sum = 0;

  for (size_t i = 0; i < f->n_face; i++) {
    double a[3], b[3], c[3];

    minus(f->x[f->face[i][0]], f->x[0], a);
    minus(f->x[f->face[i][1]], f->x[0], b);
    minus(f->x[f->face[i][2]], f->x[0], c);
    sum -= triple(a, b, c) / 6;
  }
  return sum;
}

/* 1: the segment x y passes through the triangle; 0: it misses; -1: it touches
 * an edge or ends in the plane, so another segment must be tried. */
static int passes(const double x[3], const double y[3], const double a[3],
                  const double b[3], const double c[3])
{
  double s = vg_orient3d(a, b, c, x), t = vg_orient3d(a, b, c, y), u, v, w;

  if ((s > 0 && t > 0) || (s < 0 && t < 0)) return 0;
  u = vg_orient3d(x, y, a, b);
  v = vg_orient3d(x, y, b, c);
  w = vg_orient3d(x, y, c, a);
  if ((u > 0 || v > 0 || w > 0) && (u < 0 || v < 0 || w < 0)) return 0;
  if (s == 0 || t == 0 || u == 0 || v == 0 || w == 0) return -1;
  return 1;
}

int vg_front_encloses(const struct vg_front *f, const double x[3])
{
  static const double way[5][3] = {{1, 0.0137, 0.0071}, {0.011, 1, 0.0173},
    {0.0091, 0.0153, 1}, {-1, 0.0319, 0.0277}, {0.57, -0.71, 0.31}};
  double size = 0;

  for (size_t i = 0; i < f->n_point; i++)
    for (int k = 0; k < 3; k++) {
      double d = fabs(f->x[i][k] - x[k]);

      if (d > size) size = d;
    }
  for (int w = 0; w < 5; w++) {
    double y[3];
    int n = 0, p = 0;

    for (int k = 0; k < 3; k++) y[k] = x[k] + 4 * size * way[w][k];
    for (size_t i = 0; i < f->n_face && p >= 0; i++) {
      p = passes(x, y, f->x[f->face[i][0]], f->x[f->face[i][1]],
                 f->x[f->face[i][2]]);
      n += p;
    }
    if (p >= 0) return n & 1;
  }
  return 0;
}

static vg_status allocate(struct vg_front *f, size_t n_point, size_t n_face,
                          struct vg_error *err)
{
  memset(f, 0, sizeof *f);
  f->x = vg_alloc(n_point, sizeof *f->x);
  f->name = vg_alloc(n_point, sizeof *f->name);
  f->face = vg_alloc(n_face, sizeof *f->face);
  if (f->x && f->name && f->face) return VG_OK;
  vg_front_release(f);
  return vg_fail_memory(err, "a front");
}

/* The faces listed, with their points. to: [n_point] all UINT32_MAX, before
 * and after. */
static vg_status take(const struct vg_front *f, size_t n,
                      const uint32_t *face, uint32_t *to,
                      struct vg_front *out, struct vg_error *err)
{
  size_t np = 0;
  vg_status st;

  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (to[f->face[face[i]][k]] == UINT32_MAX)
        to[f->face[face[i]][k]] = (uint32_t)np++;
  st = allocate(out, np, n, err);
  for (size_t i = 0; st == VG_OK && i < n; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = f->face[face[i]][k];

      out->face[i][k] = to[p];
      memcpy(out->x[to[p]], f->x[p], sizeof *out->x);
      out->name[to[p]] = f->name[p];
    }
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) to[f->face[face[i]][k]] = UINT32_MAX;
  if (st < 0) return st;
  out->n_point = np;
  out->n_face = n;
  return VG_OK;
}

vg_status vg_front_split(const struct vg_front *f, const uint32_t *part,
                         size_t n, struct vg_front *out, struct vg_error *err)
{
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  uint32_t *list = vg_alloc(f->n_face, sizeof *list);
  size_t *first = vg_calloc(n + 2, sizeof *first);
  vg_status st = VG_OK;

  memset(out, 0, n * sizeof *out);
  if (!to || !list || !first) {
    st = vg_fail_memory(err, "the parts of a front");
    goto done;
  }
  memset(to, 0xff, f->n_point * sizeof *to);
  for (size_t i = 0; i < f->n_face; i++) first[part[i] + 2]++;
  for (size_t k = 0; k < n; k++) first[k + 2] += first[k + 1];
  for (size_t i = 0; i < f->n_face; i++)
    list[first[part[i] + 1]++] = (uint32_t)i;
  for (size_t k = 0; k < n; k++)
    VG_TRY(take(f, first[k + 1] - first[k], list + first[k], to, &out[k],
                err));
done:
  for (size_t k = 0; st < 0 && k < n; k++) vg_front_release(&out[k]);
  free(to);
  free(list);
  free(first);
  return st;
}

/* Two points of one name are one point: parts that were one front may touch.
 * to out: [n_point] the first point of the same name. */
static vg_status find_twins(const struct vg_front *f, uint32_t *to,
                            struct vg_error *err)
{
  struct vg_key *key = vg_alloc(f->n_point, sizeof *key);
  vg_status st;

  if (!key) return vg_fail_memory(err, "a front");
  for (size_t k = 0; k < f->n_point; k++)
    key[k] = (struct vg_key){ f->name[k], (uint32_t)k };
  st = vg_sort_keys(f->n_point, key, err);
  for (size_t k = 0; st == VG_OK && k < f->n_point; k++)
    to[key[k].index] = k && key[k].key == key[k - 1].key
                         ? to[key[k - 1].index] : key[k].index;
  free(key);
  return st;
}

static vg_status weld(struct vg_front *f, struct vg_error *err)
{
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  size_t n = 0;
  vg_status st = to ? find_twins(f, to, err) : vg_fail_memory(err, "a front");

  for (size_t k = 0; st == VG_OK && k < f->n_point; k++) {
    if (to[k] != k) {
      to[k] = to[to[k]];
      continue;
    }
    memmove(f->x[n], f->x[k], sizeof *f->x);
    f->name[n] = f->name[k];
    to[k] = (uint32_t)n++;
  }
  for (size_t i = 0; st == VG_OK && i < f->n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[f->face[i][k]];
  if (st == VG_OK) f->n_point = n;
  free(to);
  return st;
}

vg_status vg_front_append(struct vg_front *to, const struct vg_front *from,
                          struct vg_error *err)
{
  size_t cap_x = to->n_point, cap_name = to->n_point, cap_face = to->n_face;
  size_t np = to->n_point + from->n_point, nf = to->n_face + from->n_face;

  if (vg_reserve(&to->x, &cap_x, np, sizeof *to->x) ||
      vg_reserve(&to->name, &cap_name, np, sizeof *to->name) ||
      vg_reserve(&to->face, &cap_face, nf, sizeof *to->face))
    return vg_fail_memory(err, "a front");
  if (from->n_point) {
    memcpy(to->x + to->n_point, from->x, from->n_point * sizeof *to->x);
    memcpy(to->name + to->n_point, from->name,
           from->n_point * sizeof *to->name);
  }
  for (size_t i = 0; i < from->n_face; i++)
    for (int k = 0; k < 3; k++)
      to->face[to->n_face + i][k] =
        (uint32_t)to->n_point + from->face[i][k];
  to->n_point = np;
  to->n_face = nf;
  return weld(to, err);
}

/* --- outcomes ------------------------------------------------------------ */

void vg_piece_release(struct vg_piece *p)
{
  free(p->in);
  free(p->x);
  free(p->cell);
  memset(p, 0, sizeof *p);
}

void vg_change_release(struct vg_change *c)
{
  free(c->x);
  free(c->face);
  free(c->gone);
  memset(c, 0, sizeof *c);
}

void vg_change_put(struct vg_writer *w, const struct vg_change *c)
{
  uint64_t count[8] = {(uint64_t)c->blocked, c->serial, c->n_point, c->n_face,
                       c->n_gone, c->n_cell, c->n_hole, c->n_part};

  vg_put(w, 8, sizeof *count, count);
  vg_put(w, 1, sizeof c->volume, &c->volume);
  vg_put(w, c->n_point, sizeof *c->x, c->x);
  vg_put(w, c->n_face, sizeof *c->face, c->face);
  vg_put(w, c->n_gone, sizeof *c->gone, c->gone);
}

void vg_change_get(struct vg_reader *r, struct vg_change *c)
{
  uint64_t count[8] = {0};

  memset(c, 0, sizeof *c);
  vg_get(r, 8, sizeof *count, count);
  vg_get(r, 1, sizeof c->volume, &c->volume);
  c->blocked = count[0] != 0;
  c->serial = (uint32_t)count[1];
  c->n_point = count[2];
  c->n_face = count[3];
  c->n_gone = count[4];
  c->n_cell = count[5];
  c->n_hole = count[6];
  c->n_part = count[7];
  c->x = vg_get_array(r, c->n_point, sizeof *c->x);
  c->face = vg_get_array(r, c->n_face, sizeof *c->face);
  c->gone = vg_get_array(r, c->n_gone, sizeof *c->gone);
  if (r->bad) vg_change_release(c);
}
