#include "core/place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Side of the cubic pattern over the spacing: mean edge of a body-centred
 * lattice of side 1 is (8 sqrt(3)/2 + 6) / 14 = 0.923. */
static const double lattice = 1.083;
/* Least distance between points over the spacing of the later one. */
static const double exclusion = 0.75;
/* Height of the apex over a surface face: regular tetrahedron. */
static const double apex = 0.8165;
/* Spacing may change by this much per unit of length; points of the spatial
 * hash are looked for on the levels that this allows. */
static const double slope = 0.1;

enum { N_BUCKET = 8192, BUCKET_ZERO = 4096, NEAR_MAX = 2048 };

struct grid_slot { uint64_t key; uint32_t head, used; };

struct placer {
  const struct vg_tets *t;
  const struct vg_sizing *sizing;
  const struct vg_region *region;
  size_t n, cap, cap_h, cap_cell, cap_next, cap_queue, limit;
  double (*x)[3];            /* surface points first */
  float *h;
  uint32_t *cell;            /* cell of t that holds the point */
  uint32_t *next;            /* next point in the same grid cell */
  uint32_t *queue;           /* next item in the same bucket */
  size_t n_slot, n_used;     /* grid: open addressing, n_slot a power of 2 */
  struct grid_slot *slot;
  size_t n_face;
  uint32_t *face;            /* links 4 * cell + face of the surface */
  uint32_t first[N_BUCKET], last[N_BUCKET];
  int lowest;                /* no bucket below it has items */
  size_t n_near;
  float near[3][NEAR_MAX];   /* surroundings, relative to the parent */
  double lo[3];
};

/* --- spatial hash ------------------------------------------------------- */

/* Level k has cells of side 2^k, between 0.9 and 1.8 of the spacing. */
static int level_of(double h)
{
  int e;

  frexp(1.8 * h, &e);
  return e - 1;
}

static uint64_t grid_key(int level, const int64_t i[3])
{
  return ((uint64_t)(level + 512) << 54) ^
         ((uint64_t)i[0] & 0x3ffff) << 36 ^
         ((uint64_t)i[1] & 0x3ffff) << 18 ^ ((uint64_t)i[2] & 0x3ffff);
}

static size_t grid_find(const struct placer *p, uint64_t key)
{
  uint64_t mix = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
  size_t at = (mix ^ mix >> 29) * 0xbf58476d1ce4e5b9u >> 32 & (p->n_slot - 1);

  while (p->slot[at].used && p->slot[at].key != key)
    at = (at + 1) & (p->n_slot - 1);
  return at;
}

static int grid_resize(struct placer *p, size_t size)
{
  struct grid_slot *old = p->slot, *slot = vg_calloc(size, sizeof *slot);
  size_t n = p->n_slot;

  if (!slot) return -1;
  p->slot = slot;
  p->n_slot = size;
  for (size_t i = 0; i < n; i++)
    if (old[i].used) p->slot[grid_find(p, old[i].key)] = old[i];
  free(old);
  return 0;
}

static int grid_add(struct placer *p, uint32_t point)
{
  int level = level_of(p->h[point]);
  double inverse = ldexp(1, -level);
  int64_t i[3];
  size_t at;

  if (2 * p->n_used >= p->n_slot && grid_resize(p, 2 * p->n_slot)) return -1;
  for (int k = 0; k < 3; k++)
    i[k] = (int64_t)floor((p->x[point][k] - p->lo[k]) * inverse);
  at = grid_find(p, grid_key(level, i));
  if (!p->slot[at].used) {
    p->slot[at].used = 1;
    p->slot[at].key = grid_key(level, i);
    p->slot[at].head = VG_NONE;
    p->n_used++;
  }
  p->next[point] = p->slot[at].head;
  p->slot[at].head = point;
  return 0;
}

static void gather_cell(struct placer *p, uint32_t point, const double c[3],
                        double r2)
{
  for (; point != VG_NONE; point = p->next[point]) {
    double d[3], d2 = 0;

    for (int k = 0; k < 3; k++) {
      d[k] = p->x[point][k] - c[k];
      d2 += d[k] * d[k];
    }
    if (d2 > r2 || p->n_near == NEAR_MAX) continue;
    for (int k = 0; k < 3; k++) p->near[k][p->n_near] = (float)d[k];
    p->n_near++;
  }
}

/* All points within r of c, r about twice the spacing h there. */
static void gather(struct placer *p, const double c[3], double h, double r)
{
  double change = slope * r < 0.5 * h ? slope * r : 0.5 * h;

  p->n_near = 0;
  for (int level = level_of(h - change); level <= level_of(h + change);
       level++) {
    double inverse = ldexp(1, -level);
    int64_t lo[3], hi[3], i[3];

    for (int k = 0; k < 3; k++) {
      lo[k] = (int64_t)floor((c[k] - r - p->lo[k]) * inverse);
      hi[k] = (int64_t)floor((c[k] + r - p->lo[k]) * inverse);
    }
    for (i[0] = lo[0]; i[0] <= hi[0]; i[0]++)
      for (i[1] = lo[1]; i[1] <= hi[1]; i[1]++)
        for (i[2] = lo[2]; i[2] <= hi[2]; i[2]++) {
          size_t at = grid_find(p, grid_key(level, i));

          if (p->slot[at].used) gather_cell(p, p->slot[at].head, c, r * r);
        }
  }
}

/* Is any gathered point nearer than r to c + d? */
static int crowded(const struct placer *p, const double d[3], double r)
{
  float x = (float)d[0], y = (float)d[1], z = (float)d[2];
  float least = INFINITY;

  for (size_t k = 0; k < p->n_near; k++) {
    float u = p->near[0][k] - x, v = p->near[1][k] - y, w = p->near[2][k] - z;
    float d2 = u * u + v * v + w * w;

    least = d2 < least ? d2 : least;
  }
  return least < (float)(r * r);
}

/* --- queue -------------------------------------------------------------- */

/* Eight buckets per doubling of the spacing, first in first out. */
static int bucket_of(double h)
{
  static const double step[8] = {0.5, 0.5452538663326288, 0.5946035575013605,
    0.6484197773255048, 0.7071067811865476, 0.7711054127039704,
    0.8408964152537145, 0.9170040432046712};
  int e, k = 7;
  double m = frexp(h, &e);

  while (k && m < step[k]) k--;
  e = 8 * e + k + BUCKET_ZERO;
  return e < 0 ? 0 : e >= N_BUCKET ? N_BUCKET - 1 : e;
}

static void push(struct placer *p, uint32_t item, double h)
{
  int b = bucket_of(h);

  p->queue[item] = VG_NONE;
  if (p->first[b] == VG_NONE) p->first[b] = item;
  else p->queue[p->last[b]] = item;
  p->last[b] = item;
  if (b < p->lowest) p->lowest = b;
}

static uint32_t pop(struct placer *p)
{
  for (; p->lowest < N_BUCKET; p->lowest++) {
    uint32_t item = p->first[p->lowest];

    if (item == VG_NONE) continue;
    p->first[p->lowest] = p->queue[item];
    return item;
  }
  return VG_NONE;
}

/* --- proposals ---------------------------------------------------------- */

static int reserve(struct placer *p, size_t n)
{
  return vg_reserve(&p->x, &p->cap, n, sizeof *p->x) ||
         vg_reserve(&p->h, &p->cap_h, n, sizeof *p->h) ||
         vg_reserve(&p->cell, &p->cap_cell, n, sizeof *p->cell) ||
         vg_reserve(&p->next, &p->cap_next, n, sizeof *p->next) ||
         vg_reserve(&p->queue, &p->cap_queue, p->n_face + n,
                    sizeof *p->queue);
}

/* Let a point stand at c + d with spacing h, unless it is outside. */
static int stand(struct placer *p, const double c[3], const double d[3],
                 double h, uint32_t start)
{
  double x[3] = {c[0] + d[0], c[1] + d[1], c[2] + d[2]};
  uint32_t cell, point = (uint32_t)p->n;

  if (p->region && !vg_region_near(p->region, x, h)) return 0;
  cell = vg_tets_locate(p->t, start, x);
  if (cell == VG_NONE || p->t->flag[cell] & VG_OUTSIDE) return 0;
  if (reserve(p, p->n + 1)) return -1;
  memcpy(p->x[point], x, sizeof x);
  p->h[point] = (float)h;
  p->cell[point] = cell;
  p->n++;
  if (grid_add(p, point)) return -1;
  push(p, (uint32_t)p->n_face + point, h);
  if (p->n_near < NEAR_MAX) {
    for (int k = 0; k < 3; k++) p->near[k][p->n_near] = (float)d[k];
    p->n_near++;
  }
  return 0;
}

/* Propose c + unit * length(h), the spacing taken half way. */
static int propose(struct placer *p, const double c[3], const double unit[3],
                   double h, uint32_t start)
{
  double d[3], x[3], there;

  for (int k = 0; k < 3; k++) d[k] = unit[k] * h;
  if (crowded(p, d, 0.9 * exclusion * h)) return 0;
  for (int k = 0; k < 3; k++) x[k] = c[k] + d[k];
  there = vg_sizing_at(p->sizing, x);
  for (int k = 0; k < 3; k++) {
    d[k] = unit[k] * 0.5 * (h + there);
    x[k] = c[k] + d[k];
  }
  if (crowded(p, d, exclusion * there)) return 0;
  return stand(p, c, d, there, start);
}

static const double pattern[14][3] = {
  {.5, .5, .5}, {-.5, -.5, -.5}, {.5, .5, -.5}, {-.5, -.5, .5},
  {.5, -.5, .5}, {-.5, .5, -.5}, {-.5, .5, .5}, {.5, -.5, -.5},
  {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

static int grow_point(struct placer *p, uint32_t point)
{
  double c[3], h = p->h[point];
  uint32_t start = p->cell[point];

  memcpy(c, p->x[point], sizeof c);
  gather(p, c, h, (lattice + exclusion) * 1.1 * h);
  for (int i = 0; i < 14; i++) {
    double unit[3];

    for (int k = 0; k < 3; k++) unit[k] = lattice * pattern[i][k];
    if (propose(p, c, unit, h, start)) return -1;
  }
  return 0;
}

static int grow_face(struct placer *p, uint32_t link)
{
  const struct vg_cell *cell = &p->t->cell[link >> 2];
  const double *v[3];
  double a[3], b[3], n[3], c[3], unit[3], length, h;

  for (int k = 0; k < 3; k++) v[k] = p->t->x[cell->v[vg_face[link & 3][k]]];
  for (int k = 0; k < 3; k++) {
    a[k] = v[1][k] - v[0][k];
    b[k] = v[2][k] - v[0][k];
    c[k] = (v[0][k] + v[1][k] + v[2][k]) / 3;
  }
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
  length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(length > 0)) return 0;
  for (int k = 0; k < 3; k++) unit[k] = apex * n[k] / length;
  h = vg_sizing_at(p->sizing, c);
  gather(p, c, h, (apex + exclusion) * 1.1 * h);
  return propose(p, c, unit, h, link >> 2);
}

/* --- the front ---------------------------------------------------------- */

static int start_points(struct placer *p)
{
  const struct vg_tets *t = p->t;

  memcpy(p->x, t->x, t->n_point * sizeof *t->x);
  p->n = t->n_point;
  for (size_t i = 0; i < p->n; i++) p->cell[i] = VG_NONE;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int k = 0; k < 4 && !(t->flag[c] & (VG_OUTSIDE | VG_DEAD)); k++)
      p->cell[t->cell[c].v[k]] = c;
  for (uint32_t i = 0; i < p->n; i++) {
    p->h[i] = (float)vg_sizing_at(p->sizing, p->x[i]);
    if (grid_add(p, i)) return -1;
    if (p->cell[i] != VG_NONE) push(p, (uint32_t)p->n_face + i, p->h[i]);
  }
  return 0;
}

static int start_faces(struct placer *p)
{
  const struct vg_tets *t = p->t;
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & (VG_OUTSIDE | VG_DEAD)))
      n += (size_t)__builtin_popcount(t->flag[c] & VG_FIXED_FACES);
  p->face = vg_alloc(n, sizeof *p->face);
  if (!p->face) return -1;
  p->n_face = n;
  n = 0;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++)
      if (!(t->flag[c] & (VG_OUTSIDE | VG_DEAD)) && t->flag[c] >> i & 1)
        p->face[n++] = 4 * c + i;
  return reserve(p, t->n_point);
}

/* Faces come before points of equal size: they are pushed first. */
static int push_faces(struct placer *p)
{
  for (uint32_t i = 0; i < p->n_face; i++) {
    const struct vg_cell *cell = &p->t->cell[p->face[i] >> 2];
    double c[3] = {0};

    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        c[k] += p->t->x[cell->v[vg_face[p->face[i] & 3][j]]][k] / 3;
    push(p, i, vg_sizing_at(p->sizing, c));
  }
  return 0;
}

static void release(struct placer *p)
{
  free(p->x);
  free(p->h);
  free(p->cell);
  free(p->next);
  free(p->queue);
  free(p->slot);
  free(p->face);
  free(p);
}

static struct placer *start(const struct vg_tets *t,
                            const struct vg_sizing *sizing,
                            const struct vg_region *region)
{
  struct placer *p = vg_calloc(1, sizeof *p);

  if (!p) return NULL;
  p->t = t;
  p->sizing = sizing;
  p->region = region;
  p->lowest = N_BUCKET;
  memset(p->first, 0xff, sizeof p->first);
  for (int k = 0; k < 3; k++) p->lo[k] = t->n_point ? t->x[0][k] : 0;
  if (grid_resize(p, 1 << 16) || start_faces(p) || push_faces(p) ||
      start_points(p)) {
    release(p);
    return NULL;
  }
  return p;
}

vg_status vg_place(const struct vg_tets *t, const struct vg_sizing *sizing,
                   const struct vg_region *region, size_t limit,
                   struct vg_placed *out, struct vg_error *err)
{
  struct placer *p = start(t, sizing, region);
  uint32_t item;
  int bad = 0;

  if (!p) return vg_fail_memory(err, "placing points");
  while (!bad && (item = pop(p)) != VG_NONE) {
    bad = item < p->n_face ? grow_face(p, p->face[item])
                           : grow_point(p, item - (uint32_t)p->n_face);
    if (limit && p->n - t->n_point > limit) break;
  }
  if (bad || (limit && p->n - t->n_point > limit)) {
    release(p);
    return bad ? vg_fail_memory(err, "placing points")
               : vg_fail(err, VG_ERR_UNSUPPORTED,
                         "more than %zu field points are needed; use a "
                         "coarser spacing or raise the limit", limit);
  }
  out->n = p->n - t->n_point;
  memmove(p->x, p->x + t->n_point, out->n * sizeof *p->x);
  out->x = p->x;
  p->x = NULL;
  release(p);
  return VG_OK;
}
