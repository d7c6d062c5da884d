#include "core/near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define VG_NONE UINT32_MAX

/* Level k has cells of side 2^k, between 1.1 and 2.2 of the spacing. */
static int level_of(double h)
{
  int e;

  frexp(2.2 * h, &e);
  return e - 1;
}

/* Cells are kept in blocks of 4 x 4 x 4, which share a hash entry and lie
 * together in memory: the surroundings of a point touch few of them. */
static uint64_t block_key(int level, const int64_t i[3])
{
  return ((uint64_t)(level + 512) << 54) ^
         ((uint64_t)(i[0] >> 2) & 0x3ffff) << 36 ^
         ((uint64_t)(i[1] >> 2) & 0x3ffff) << 18 ^
         ((uint64_t)(i[2] >> 2) & 0x3ffff);
}

static uint32_t cell_in_block(const int64_t i[3])
{
  return (uint32_t)((i[0] & 3) << 4 | (i[1] & 3) << 2 | (i[2] & 3));
}

static size_t find_slot(const struct vg_near *s, uint64_t key)
{
  uint64_t mix = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
  size_t at = (mix ^ mix >> 29) * 0xbf58476d1ce4e5b9u >> 32 & (s->n_slot - 1);

  while (s->slot[at].block != VG_NONE && s->slot[at].key != key)
    at = (at + 1) & (s->n_slot - 1);
  return at;
}

static int resize(struct vg_near *s, size_t size)
{
  struct vg_near_slot *old = s->slot, *slot = vg_alloc(size, sizeof *slot);
  size_t n = s->n_slot;

  if (!slot) return -1;
  memset(slot, 0xff, size * sizeof *slot);
  s->slot = slot;
  s->n_slot = size;
  for (size_t i = 0; i < n; i++)
    if (old[i].block != VG_NONE) s->slot[find_slot(s, old[i].key)] = old[i];
  free(old);
  return 0;
}

/* Head of the pages of cell i, made if need be; NULL: memory refused. */
static uint32_t *cell_head(struct vg_near *s, int level, const int64_t i[3])
{
  uint64_t key = block_key(level, i);
  size_t at;

  if (2 * s->n_block >= s->n_slot && resize(s, 2 * s->n_slot))
    return NULL;
  at = find_slot(s, key);
  if (s->slot[at].block == VG_NONE) {
    if (vg_reserve(&s->block, &s->cap_block, s->n_block + 1,
                   sizeof *s->block))
      return NULL;
    memset(s->block[s->n_block], 0xff, sizeof *s->block);
    s->slot[at].key = key;
    s->slot[at].block = (uint32_t)s->n_block++;
  }
  return &s->block[s->slot[at].block][cell_in_block(i)];
}

static uint32_t new_page(struct vg_near *s, uint32_t next)
{
  if (vg_reserve(&s->page, &s->cap_page, s->n_page + 1, sizeof *s->page))
    return VG_NONE;
  s->page[s->n_page].next = next;
  s->page[s->n_page].n = 0;
  return (uint32_t)s->n_page++;
}

int vg_near_add(struct vg_near *s, const double x[3], double h)
{
  int level = level_of(h);
  double inverse = ldexp(1, -level), side = ldexp(1, level);
  int64_t i[3];
  struct vg_near_page *page;
  uint32_t *head;

  for (int k = 0; k < 3; k++)
    i[k] = (int64_t)floor((x[k] - s->lo[k]) * inverse);
  head = cell_head(s, level, i);
  if (!head) return -1;
  if (*head == VG_NONE || s->page[*head].n == VG_NEAR_PAGE) {
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

/* A grid cell met by a search: its pages are on their way to the cache while
 * the other cells are looked up. d: its corner relative to the centre. */
static void find_cell(struct vg_near *s, uint32_t page, const double d[3])
{
  struct vg_near_cell *f = &s->cell[s->n_cell];

  if (page == VG_NONE || s->n_cell == VG_NEAR_CELLS) return;
  __builtin_prefetch(&s->page[page]);
  __builtin_prefetch((const char *)(&s->page[page] + 1) - 1);
  f->page = page;
  for (int k = 0; k < 3; k++) f->d[k] = (float)d[k];
  s->n_cell++;
}

static void gather_cell(struct vg_near *s, const struct vg_near_cell *f,
                        float r2)
{
  float x = f->d[0], y = f->d[1], z = f->d[2];

  for (uint32_t at = f->page; at != VG_NONE; at = s->page[at].next) {
    const struct vg_near_page *page = &s->page[at];

    for (uint32_t k = 0; k < page->n; k++) {
      float u = page->x[0][k] + x, v = page->x[1][k] + y;
      float w = page->x[2][k] + z;

      if (u * u + v * v + w * w > r2 || s->n == VG_NEAR_MAX) continue;
      s->x[0][s->n] = u;
      s->x[1][s->n] = v;
      s->x[2][s->n] = w;
      s->n++;
    }
  }
}

/* Distance along one axis from the centre to a cell that starts at d. */
static double gap(double d, double side)
{
  return d > 0 ? d : d + side < 0 ? -(d + side) : 0;
}

static void find_level(struct vg_near *s, const double c[3], double r,
                         int level)
{
  double inverse = ldexp(1, -level), side = ldexp(1, level), d[3], g[3];
  int64_t lo[3], hi[3], i[3];
  uint64_t key = UINT64_MAX;
  uint32_t block = VG_NONE;

  for (int k = 0; k < 3; k++) {
    lo[k] = (int64_t)floor((c[k] - r - s->lo[k]) * inverse);
    hi[k] = (int64_t)floor((c[k] + r - s->lo[k]) * inverse);
  }
  for (i[0] = lo[0]; i[0] <= hi[0]; i[0]++) {
    d[0] = s->lo[0] + side * (double)i[0] - c[0];
    g[0] = gap(d[0], side);
    for (i[1] = lo[1]; i[1] <= hi[1]; i[1]++) {
      d[1] = s->lo[1] + side * (double)i[1] - c[1];
      g[1] = gap(d[1], side);
      for (i[2] = lo[2]; i[2] <= hi[2]; i[2]++) {
        d[2] = s->lo[2] + side * (double)i[2] - c[2];
        g[2] = gap(d[2], side);
        if (g[0] * g[0] + g[1] * g[1] + g[2] * g[2] > r * r) continue;
        if (block_key(level, i) != key) {
          key = block_key(level, i);
          block = s->slot[find_slot(s, key)].block;
        }
        if (block != VG_NONE)
          find_cell(s, s->block[block][cell_in_block(i)], d);
      }
    }
  }
}

/* All points within r of c, r about twice the spacing h there. They are on
 * the levels that the gradient of the field allows. */
void vg_near_gather(struct vg_near *s, const double c[3], double h, double r)
{
  double change = fmin(s->slope * r, 0.6 * h);

  s->n = s->n_cell = 0;
  for (int level = level_of(h - change); level <= level_of(h + change);
       level++)
    if (level >= s->level_lo && level <= s->level_hi)
      find_level(s, c, r, level);
  for (size_t k = 0; k < s->n_cell; k++)
    gather_cell(s, &s->cell[k], (float)(r * r));
}

int vg_near_init(struct vg_near *s, const double lo[3], double h_min,
                 double h_max, double slope)
{
  memcpy(s->lo, lo, sizeof s->lo);
  s->slope = slope;
  s->level_lo = level_of(h_min) - 1;
  s->level_hi = level_of(h_max) + 1;
  return resize(s, 1 << 16);
}

void vg_near_release(struct vg_near *s)
{
  free(s->slot);
  free(s->block);
  free(s->page);
}
