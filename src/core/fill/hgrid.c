/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/fill/hgrid.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined __x86_64__ && !defined VG_PORTABLE
#include <immintrin.h>
#endif

#include "base/hash.h"
#include "base/memory.h"
#include "base/wide.h"

#define VG_NONE UINT32_MAX

/* Level k has cells of side 2^k, which is between half of this and this, in
 * units of the spacing. */
static const double widest_cell = 2.8; /* K39 */
/* A search assumes that the spacing changes by at most this share. */
static const double largest_change = 0.6; /* K39 */

/* The exponent of widest_cell * h, a normal number. */
static inline int level_of(double h)
{
  double wide = widest_cell * h;
  uint64_t bits;

  assert(isnormal(wide) && wide > 0);
  memcpy(&bits, &wide, sizeof bits);
  return (int)(bits >> 52) - 1023;
}

/* Largest integer up to x, without a call to the mathematical library. */
static inline int64_t floor_of(double x)
{
  int64_t i = (int64_t)x;

  return i - (x < (double)i);
}

/* Side of a cell of a level, without a call to the mathematical library. */
static inline double side_of(int level)
{
  uint64_t bits = (uint64_t)(1023 + level) << 52;
  double side;

  assert(level > -1023 && level < 1024);
  memcpy(&side, &bits, sizeof side);
  return side;
}

/* Blocks of 4 x 4 x 4 cells share an entry of the table and are contiguous in
 * memory, so that a query accesses few of them. */
static uint64_t hash(int level, const int64_t block[3])
{
  return vg_hash_1(
    vg_hash_3((uint64_t)block[0], (uint64_t)block[1], (uint64_t)block[2]) +
    (uint64_t)level);
}

static uint64_t block_hash(const void *grid, uint32_t block)
{
  const struct vg_hgrid *s = grid;

  return hash(s->block[block].level, s->block[block].at);
}

static uint32_t cell_in_block(const int64_t i[3])
{
  return (uint32_t)((i[0] & 3) << 4 | (i[1] & 3) << 2 | (i[2] & 3));
}

/* Bit mask of the cells of a block from `from` to `to` on each axis, 0 to 3. */
static uint64_t cells_between(const int from[3], const int to[3])
{
  uint64_t x = UINT64_MAX << 16 * from[0] & UINT64_MAX >> 16 * (3 - to[0]);
  uint64_t y = 0xffffu << 4 * from[1] & 0xffffu >> 4 * (3 - to[1]);
  uint64_t z = 0xfu << from[2] & 0xfu >> (3 - to[2]);

  return x & y * 0x0001000100010001u & z * 0x1111111111111111u;
}

static int is_block(const struct vg_hgrid_block *b, int level,
                    const int64_t at[3])
{
  return b->at[0] == at[0] && b->at[1] == at[1] && b->at[2] == at[2] &&
         b->level == level;
}

/* Slot of a block, or the free slot for it. */
static inline uint32_t *find_slot(const struct vg_hgrid *s, int level,
                                  const int64_t block[3])
{
  uint32_t *at;

  VG_TABLE_FIND(&s->table, at, hash(level, block),
                is_block(&s->block[*at], level, block));
  return at;
}

/* Head of the list of pages of cell i, created if needed. NULL if memory is
 * refused. */
static uint32_t *cell_head(struct vg_hgrid *s, int level, const int64_t i[3])
{
  const int64_t at[3] = { i[0] >> 2, i[1] >> 2, i[2] >> 2 };
  struct vg_hgrid_block *block;
  uint32_t *slot;

  if (vg_table_reserve(&s->table, s->n_block + 1, block_hash, s)) return NULL;
  slot = find_slot(s, level, at);
  if (*slot == VG_TABLE_FREE) {
    if (vg_reserve(&s->block, &s->cap_block, s->n_block + 1, sizeof *s->block))
      return NULL;
    block = &s->block[s->n_block];
    memset(block, 0xff, sizeof *block);
    block->used = 0;
    block->level = level;
    memcpy(block->at, at, sizeof at);
    *slot = (uint32_t)s->n_block++;
  }
  block = &s->block[*slot];
  block->used |= (uint64_t)1 << cell_in_block(i);
  return &block->page[cell_in_block(i)];
}

static uint32_t new_page(struct vg_hgrid *s, uint32_t next)
{
  if (vg_reserve(&s->page, &s->cap_page, s->n_page + 1, sizeof *s->page))
    return VG_NONE;
  s->page[s->n_page] = (struct vg_hgrid_page){ .next = next };
  return (uint32_t)s->n_page++;
}

int vg_hgrid_add(struct vg_hgrid *s, const double x[3], double h)
{
  assert(h > 0);

  int level = level_of(h);
  double inverse = side_of(-level), side = side_of(level);
  int64_t i[3];
  struct vg_hgrid_page *page;
  uint32_t *head;

  for (int k = 0; k < 3; k++) i[k] = floor_of((x[k] - s->lo[k]) * inverse);
  head = cell_head(s, level, i);
  if (!head) return -1;
  if (*head == VG_NONE || s->page[*head].n == VG_HGRID_PAGE) {
    uint32_t fresh = new_page(s, *head);

    if (fresh == VG_NONE) return -1;
    *head = fresh;
  }
  page = &s->page[*head];
  for (int k = 0; k < 3; k++)
    page->x[k][page->n] = (float)(x[k] - s->lo[k] - side * (double)i[k]);
  page->n++;
  return 0;
}

/* Four lanes, in the vector syntax of GCC and Clang for any processor. */
typedef float f4 __attribute__((vector_size(16)));
typedef int32_t i4 __attribute__((vector_size(16)));

static inline unsigned lanes(i4 m)
{
#if defined __x86_64__ && !defined VG_PORTABLE
  return (unsigned)_mm_movemask_ps((__m128)m);
#else
  m &= (i4){ 1, 2, 4, 8 };
  return (unsigned)(m[0] | m[1] | m[2] | m[3]);
#endif
}

static inline f4 four(const float *from)
{
  f4 v;

  memcpy(&v, from, sizeof v);
  return v;
}

/* Bit k: point k of the page, translated by d, is within a distance of
 * sqrt(r2). */
static inline unsigned within(const struct vg_hgrid_page *page,
                              const float d[3], float r2)
{
  unsigned bits = 0;

  for (int k = 0; k < VG_HGRID_PAGE; k += 4) {
    f4 u = four(page->x[0] + k) + d[0], v = four(page->x[1] + k) + d[1];
    f4 w = four(page->x[2] + k) + d[2];

    bits |= lanes(u * u + v * v + w * w <= r2) << k;
  }
  return bits & ((1u << page->n) - 1);
}

/* List the points of a page, translated by d, that are within a distance of
 * sqrt(r2), after the first n of the list. Returns their number. */
static inline size_t take_page(struct vg_hgrid *s, size_t n,
                               const struct vg_hgrid_page *page,
                               const float d[3], float r2)
{
  size_t first = n;

  for (unsigned left = within(page, d, r2); left; left &= left - 1) {
    int k = __builtin_ctz(left);

    for (int a = 0; a < 3; a++) s->x[a][n] = page->x[a][k] + d[a];
    n++;
  }
  return n - first;
}

/* Number of listed points from `first` on that are nearer than sqrt(r2) to
 * d. */
static inline int count_from(const struct vg_hgrid *s, size_t first,
                             const float d[3], float r2)
{
  int n = 0;

  for (size_t k = first; k < s->n; k++) {
    float u = s->x[0][k] - d[0], v = s->x[1][k] - d[1], w = s->x[2][k] - d[2];

    n += u * u + v * v + w * w < r2;
  }
  return n;
}

#ifdef VG_WIDE
typedef float f8 __attribute__((vector_size(32)));
typedef int32_t i8 __attribute__((vector_size(32)));
_Static_assert(VG_HGRID_PAGE == 8, "a page has a lane for each point");

static inline VG_WIDE f8 eight(const float *from)
{
  return (f8)_mm256_loadu_ps(from);
}

/* As take_page, for the whole page at once and without branches. Writes eight
 * entries. */
static inline VG_WIDE size_t take_wide(struct vg_hgrid *s, size_t n,
                                       const struct vg_hgrid_page *page,
                                       const float d[3], float r2)
{
  f8 u = eight(page->x[0]) + d[0], v = eight(page->x[1]) + d[1];
  f8 w = eight(page->x[2]) + d[2];
  i8 is_near = u * u + v * v + w * w <= r2;
  unsigned bits = (unsigned)_mm256_movemask_ps((__m256)is_near) &
                  ((1u << page->n) - 1);
  __m256i pick = _mm256_cvtepu8_epi32(
    _mm_loadl_epi64((const __m128i *)&s->pick[bits]));

  _mm256_storeu_ps(s->x[0] + n, _mm256_permutevar8x32_ps((__m256)u, pick));
  _mm256_storeu_ps(s->x[1] + n, _mm256_permutevar8x32_ps((__m256)v, pick));
  _mm256_storeu_ps(s->x[2] + n, _mm256_permutevar8x32_ps((__m256)w, pick));
  return (size_t)__builtin_popcount(bits);
}

/* As count_from(s, 0, d, r2), eight points at a time. */
static VG_WIDE int count_wide(const struct vg_hgrid *s, const float d[3],
                              float r2)
{
  size_t n = s->n / 8 * 8;
  i8 sum = { 0 };

  for (size_t k = 0; k < n; k += 8) {
    f8 u = eight(s->x[0] + k) - d[0], v = eight(s->x[1] + k) - d[1];
    f8 w = eight(s->x[2] + k) - d[2];

    sum -= u * u + v * v + w * w < r2;
  }
  return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5] + sum[6] + sum[7] +
         count_from(s, n, d, r2);
}
#endif

/* List the points of the cells that the query has found. */
VG_WITHIN void gather_with(struct vg_hgrid *s, float r2, int is_wide)
{
  size_t n = 0;

  for (size_t i = 0; i < s->n_cell; i++) {
    const struct vg_hgrid_cell *f = &s->cell[i];

    for (uint32_t at = f->page; at != VG_NONE && n < VG_HGRID_MAX;
         at = s->page[at].next) {
#ifdef VG_WIDE
      if (is_wide) {
        n += take_wide(s, n, &s->page[at], f->d, r2);
        continue;
      }
#endif
      n += take_page(s, n, &s->page[at], f->d, r2);
    }
  }
  (void)is_wide;
  s->n = n;
}

#ifdef VG_WIDE
static VG_WIDE void gather_wide(struct vg_hgrid *s, float r2)
{
  gather_with(s, r2, 1);
}
#endif

static void gather(struct vg_hgrid *s, float r2)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    gather_wide(s, r2);
    return;
  }
#endif
  gather_with(s, r2, 0);
}

int vg_hgrid_count(const struct vg_hgrid *s, const double d[3], double r)
{
  const float at[3] = { (float)d[0], (float)d[1], (float)d[2] };

#ifdef VG_WIDE
  if (VG_IS_WIDE) return count_wide(s, at, (float)(r * r));
#endif
  return count_from(s, 0, at, (float)(r * r));
}

/* Distance along one axis from the centre to a cell that begins at d. */
static double gap(double d, double side)
{
  return d > 0 ? d : d + side < 0 ? -(d + side) : 0;
}

/* A query of one level. For each axis, `d` and `gap2` describe the cells lo to
 * hi: the lower corner relative to the centre, and the squared distance. */
enum { AXIS_MAX = 16 }; /* cells are wider than 0.56 h, by K39 */

struct query {
  double r2;
  int64_t lo[3], hi[3]; /* range of cells to examine */
  float d[3][AXIS_MAX];
  double gap2[3][AXIS_MAX];
};

/* Record the cells of a block that are within the radius, and prefetch their
 * pages while the other cells are looked up. Whether a cell is within it cannot
 * be predicted; therefore every cell is written, and only counted if it is. */
static void find_in_block(struct vg_hgrid *s, const struct query *q,
                          const int64_t b[3],
                          const struct vg_hgrid_block *block)
{
  int first[3], from[3], to[3]; /* first: cell 0 of the block in the query */
  size_t n = s->n_cell;
  uint64_t left;

  for (int k = 0; k < 3; k++) {
    first[k] = (int)(4 * b[k] - q->lo[k]);
    from[k] = first[k] < 0 ? -first[k] : 0;
    to[k] = q->hi[k] < 4 * b[k] + 3 ? (int)(q->hi[k] - 4 * b[k]) : 3;
  }
  for (left = block->used & cells_between(from, to); left; left &= left - 1) {
    int at = __builtin_ctzll(left), x = first[0] + (at >> 4);
    int y = first[1] + (at >> 2 & 3), z = first[2] + (at & 3);
    const struct vg_hgrid_page *page = &s->page[block->page[at]];
    struct vg_hgrid_cell *f = &s->cell[n];

    __builtin_prefetch(page);
    __builtin_prefetch((const char *)(page + 1) - 1);
    f->page = block->page[at];
    f->d[0] = q->d[0][x];
    f->d[1] = q->d[1][y];
    f->d[2] = q->d[2][z];
    n += q->gap2[0][x] + q->gap2[1][y] + q->gap2[2][z] <= q->r2;
  }
  s->n_cell = n < VG_HGRID_CELLS ? n : VG_HGRID_CELLS;
}

static void find_level(struct vg_hgrid *s, const double c[3], double r,
                       int level)
{
  double inverse = side_of(-level), side = side_of(level);
  struct query q;
  int64_t b[3];

  q.r2 = r * r;
  for (int k = 0; k < 3; k++) {
    q.lo[k] = floor_of((c[k] - r - s->lo[k]) * inverse);
    q.hi[k] = floor_of((c[k] + r - s->lo[k]) * inverse);
    assert(q.hi[k] - q.lo[k] < AXIS_MAX);
    for (int64_t i = q.lo[k]; i <= q.hi[k]; i++) {
      double d = s->lo[k] + side * (double)i - c[k], g = gap(d, side);

      q.d[k][i - q.lo[k]] = (float)d;
      q.gap2[k][i - q.lo[k]] = g * g;
    }
  }
  for (b[0] = q.lo[0] >> 2; b[0] <= q.hi[0] >> 2; b[0]++)
    for (b[1] = q.lo[1] >> 2; b[1] <= q.hi[1] >> 2; b[1]++)
      for (b[2] = q.lo[2] >> 2; b[2] <= q.hi[2] >> 2; b[2]++) {
        uint32_t block = *find_slot(s, level, b);

        if (block != VG_NONE) find_in_block(s, &q, b, &s->block[block]);
      }
}

/* All points within r of c, where r is about twice the spacing h at c. They
 * are on the levels that the gradient of the sizing field allows. */
void vg_hgrid_gather(struct vg_hgrid *s, const double c[3], double h, double r)
{
  assert(h > 0 && r >= 0 && r <= VG_HGRID_REACH * h);

  double change = fmin(s->slope * r, largest_change * h);

  s->n = s->n_cell = 0;
  for (int level = level_of(h - change); level <= level_of(h + change); level++)
    if (level >= s->level_lo && level <= s->level_hi)
      find_level(s, c, r, level);
  gather(s, (float)(r * r));
  s->n_cut += s->n >= VG_HGRID_MAX || s->n_cell == VG_HGRID_CELLS;
  if (s->n > VG_HGRID_MAX) s->n = VG_HGRID_MAX;
}

int vg_hgrid_init(struct vg_hgrid *s, const double lo[3], double h_min,
                  double h_max, double slope)
{
  assert(!s->table.slot && !s->block && !s->page);
  assert(h_min > 0 && h_max >= h_min && slope >= 0);
  memcpy(s->lo, lo, sizeof s->lo);
  s->slope = slope;
  s->level_lo = level_of(h_min) - 1;
  s->level_hi = level_of(h_max) + 1;
  for (unsigned bits = 0; bits < 256; bits++) {
    int n = 0;

    for (unsigned k = 0; k < 8; k++)
      if (bits >> k & 1) s->pick[bits] |= (uint64_t)k << 8 * n++;
  }
  return vg_table_init(&s->table, 1 << 9);
}

void vg_hgrid_release(struct vg_hgrid *s)
{
  vg_table_release(&s->table);
  free(s->block);
  free(s->page);
}
