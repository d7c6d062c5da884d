/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges from half-edges: bucket by the lower node, then sort each bucket by
 * the higher node. Linear, except for nodes with very many edges. */
#include "core/mesh/edges.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define FEW 24 /* up to this many keys are sorted by insertion */

/* The half-edges to pair: those of triangles, or given sides. */
struct halves {
  size_t n_point, n;
  const uint32_t (*tri)[3], (*side)[2];
  const uint8_t *state;
  uint8_t out;
};

static int compare_key(const void *a, const void *b)
{
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;

  return (p > q) - (p < q);
}

static void sort_keys(uint64_t *key, size_t n)
{
  if (n > FEW) {
    qsort(key, n, sizeof *key, compare_key);
    return;
  }
  for (size_t i = 1; i < n; i++) {
    uint64_t k = key[i];
    size_t j = i;

    for (; j && key[j - 1] > k; j--) key[j] = key[j - 1];
    key[j] = k;
  }
}

/* Both nodes of half-edge h. Returns 0 if the half-edge is excluded. */
static inline int ends(const struct halves *s, size_t h, uint32_t *lo,
                       uint32_t *hi)
{
  uint32_t a, b;

  if (s->side) {
    a = s->side[h][0];
    b = s->side[h][1];
  } else {
    if (s->state && s->state[h / 3] & s->out) return 0;
    a = s->tri[h / 3][h % 3];
    b = s->tri[h / 3][h % 3 == 2 ? 0 : h % 3 + 1];
  }
  *lo = a < b ? a : b;
  *hi = a < b ? b : a;
  return 1;
}

/* Fill key[] with pairs (higher node, half-edge), in buckets of the lower
 * node. at[] (n_point + 1, zeroed) becomes the end of each bucket. */
static void fill_buckets(const struct halves *s, uint64_t *key, uint32_t *at)
{
  uint32_t lo, hi, sum = 0;

  for (size_t h = 0; h < s->n; h++)
    if (ends(s, h, &lo, &hi)) at[lo]++;
  for (size_t p = 0; p <= s->n_point; p++) {
    uint32_t n = at[p];

    at[p] = sum;
    sum += n;
  }
  for (size_t h = 0; h < s->n; h++)
    if (ends(s, h, &lo, &hi)) key[at[lo]++] = (uint64_t)hi << 32 | h;
}

static void number_edges(struct vg_edges *e, const struct halves *s,
                         uint64_t *key, const uint32_t *end)
{
  uint32_t i = 0;

  for (size_t p = 0; p < s->n_point; p++) {
    sort_keys(key + i, end[p] - i);
    for (uint32_t first = i; i < end[p]; i++) {
      if (i == first || key[i] >> 32 != key[i - 1] >> 32) e->start[e->n++] = i;
      e->half[i] = (uint32_t)key[i];
    }
  }
  e->start[e->n] = i;
}

static vg_status name_edges(struct vg_edges *e, size_t n)
{
  e->of_half = vg_alloc(n, sizeof *e->of_half);
  if (!e->of_half) return VG_ERR_MEMORY;
  memset(e->of_half, 0xff, n * sizeof *e->of_half);
  for (size_t i = 0; i < e->n; i++)
    for (uint32_t k = e->start[i]; k < e->start[i + 1]; k++)
      e->of_half[e->half[k]] = (uint32_t)i;
  return VG_OK;
}

static vg_status build(struct vg_edges *e, const struct halves *s,
                       struct vg_error *err)
{
  uint64_t *key = vg_alloc(s->n, sizeof *key);
  uint32_t *at = vg_calloc(s->n_point + 1, sizeof *at);
  vg_status st = VG_ERR_MEMORY;

  *e = (struct vg_edges)VG_EDGES_INIT;
  e->start = vg_alloc(s->n + 1, sizeof *e->start);
  e->half = vg_alloc(s->n, sizeof *e->half);
  if (key && at && e->start && e->half) {
    fill_buckets(s, key, at);
    number_edges(e, s, key, at);
    st = VG_OK;
  }
  free(key);
  free(at);
  if (st >= 0) st = name_edges(e, s->n);
  if (st >= 0) return VG_OK;
  vg_edges_release(e);
  return vg_fail_memory(err, "the edges of the surface");
}

vg_status vg_edges_build(struct vg_edges *e, size_t n_point, size_t n_tri,
                         const uint32_t (*tri)[3], const uint8_t *state,
                         uint8_t out, struct vg_error *err)
{
  const struct halves s = {
    .n_point = n_point, .n = 3 * n_tri, .tri = tri, .state = state, .out = out
  };

  return build(e, &s, err);
}

vg_status vg_edges_build_sides(struct vg_edges *e, size_t n_point,
                               size_t n_side, const uint32_t (*side)[2],
                               struct vg_error *err)
{
  const struct halves s = { .n_point = n_point, .n = n_side, .side = side };

  return build(e, &s, err);
}

void vg_edges_release(struct vg_edges *e)
{
  free(e->start);
  free(e->half);
  free(e->of_half);
  *e = (struct vg_edges)VG_EDGES_INIT;
}
