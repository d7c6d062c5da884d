/* Edges from half-edges: bucket by the lower node, sort each bucket by the
 * higher. Linear but for nodes with very many edges. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static int compare_key(const void *a, const void *b)
{
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;

  return (p > q) - (p < q);
}

static void sort_keys(uint64_t *key, size_t n)
{
  if (n > 24) {
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

static void ends(const struct vg_faces *s, size_t h, uint32_t *lo,
                 uint32_t *hi)
{
  uint32_t a = s->node[h / 3][h % 3], b = s->node[h / 3][(h + 1) % 3];

  if (h % 3 == 2) b = s->node[h / 3][0];
  *lo = a < b ? a : b;
  *hi = a < b ? b : a;
}

/* key[] = higher node and half-edge, in buckets of the lower node;
 * at[] (n_point + 1, zeroed) becomes the end of each bucket. */
static size_t fill_buckets(const struct vg_faces *s, uint64_t *key,
                           uint32_t *at)
{
  uint32_t lo, hi, sum = 0;

  for (size_t h = 0; h < 3 * s->n; h++) {
    if (s->state[h / 3] & VG_FACE_OUT) continue;
    ends(s, h, &lo, &hi);
    at[lo]++;
  }
  for (size_t p = 0; p <= s->n_point; p++) {
    uint32_t n = at[p];

    at[p] = sum;
    sum += n;
  }
  for (size_t h = 0; h < 3 * s->n; h++) {
    if (s->state[h / 3] & VG_FACE_OUT) continue;
    ends(s, h, &lo, &hi);
    key[at[lo]++] = (uint64_t)hi << 32 | h;
  }
  return sum;
}

static void number_edges(struct vg_edges *e, const struct vg_faces *s,
                         uint64_t *key, const uint32_t *end)
{
  uint32_t i = 0;

  for (size_t p = 0; p < s->n_point; p++) {
    sort_keys(key + i, end[p] - i);
    for (uint32_t first = i; i < end[p]; i++) {
      if (i == first || key[i] >> 32 != key[i - 1] >> 32)
        e->start[e->n++] = i;
      e->half[i] = (uint32_t)key[i];
      e->of_half[(uint32_t)key[i]] = (uint32_t)(e->n - 1);
    }
  }
  e->start[e->n] = i;
}

vg_status vg_edges_build(struct vg_edges *e, const struct vg_faces *s,
                         struct vg_error *err)
{
  assert(!e->start && !e->half);

  size_t n = 3 * s->n;
  uint64_t *key = vg_alloc(n, sizeof *key);
  uint32_t *at = vg_calloc(s->n_point + 1, sizeof *at);

  e->start = vg_alloc(n + 1, sizeof *e->start);
  e->half = vg_alloc(n, sizeof *e->half);
  e->of_half = vg_alloc(n, sizeof *e->of_half);
  if (!key || !at || !e->start || !e->half || !e->of_half) {
    free(key);
    free(at);
    vg_edges_release(e);
    return vg_fail_memory(err, "the edges of the surface");
  }
  e->n = 0;
  memset(e->of_half, 0xff, n * sizeof *e->of_half);
  fill_buckets(s, key, at);
  number_edges(e, s, key, at);
  free(key);
  free(at);
  return VG_OK;
}

void vg_edges_release(struct vg_edges *e)
{
  free(e->start);
  free(e->half);
  free(e->of_half);
  memset(e, 0, sizeof *e);
}

int vg_edges_disagree(const struct vg_edges *e, const struct vg_faces *s,
                      size_t edge)
{
  assert(edge < e->n && e->start[edge + 1] - e->start[edge] == 2);

  uint32_t g = e->half[e->start[edge]], h = e->half[e->start[edge] + 1];

  return s->node[g / 3][g % 3] == s->node[h / 3][h % 3];
}
