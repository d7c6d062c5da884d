#include "core/hilbert.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { BITS = 20 };

/* The 20 bits of q, two clear ones between any two. */
static uint64_t spread(uint64_t q)
{
  q = (q | q << 32) & 0x001f00000000ffffu;
  q = (q | q << 16) & 0x001f0000ff0000ffu;
  q = (q | q << 8) & 0x100f00f00f00f00fu;
  q = (q | q << 4) & 0x10c30c30c30c30c3u;
  return (q | q << 2) & 0x1249249249249249u;
}

/* Skilling's transposed key ("Programming the Hilbert curve", 2004), without
 * branches: bits of coordinates are not to be predicted. */
uint64_t vg_hilbert_key(const double x[3], const double lo[3], double scale)
{
  uint32_t q[3], t;

  for (int k = 0; k < 3; k++) {
    double cell = (x[k] - lo[k]) * scale;

    q[k] = !(cell > 0) ? 0
           : cell >= (1u << BITS) - 1 ? (1u << BITS) - 1 : (uint32_t)cell;
  }
  for (int b = BITS - 1; b > 0; b--)
    for (int k = 0; k < 3; k++) {
      uint32_t low = (1u << b) - 1, is_set = 0u - (q[k] >> b & 1);
      uint32_t exchange = (q[0] ^ q[k]) & low & ~is_set;

      q[k] ^= exchange;
      q[0] ^= exchange ^ (low & is_set);
    }
  q[1] ^= q[0];
  q[2] ^= q[1];
  t = q[2];                  /* of each bit the parity of those above it */
  for (int shift = 1; shift < BITS; shift *= 2) t ^= t >> shift;
  t >>= 1;
  return spread(q[0] ^ t) << 2 | spread(q[1] ^ t) << 1 | spread(q[2] ^ t);
}

vg_status vg_sort_keys(size_t n, struct vg_key *key, struct vg_error *err)
{
  struct vg_key *to, *from = key, *buffer = vg_alloc(n, sizeof *buffer);
  uint64_t any = 0;

  if (!buffer) return vg_fail_memory(err, "sorting");
  to = buffer;
  for (size_t i = 0; i < n; i++) any |= key[i].key ^ key[0].key;
  for (int shift = 0; shift < 64; shift += 11) {
    size_t start[2049] = {0};

    if (!(any >> shift & 2047)) continue;
    for (size_t i = 0; i < n; i++) start[(from[i].key >> shift & 2047) + 1]++;
    for (int b = 0; b < 2048; b++) start[b + 1] += start[b];
    for (size_t i = 0; i < n; i++)
      to[start[from[i].key >> shift & 2047]++] = from[i];
    from = to;
    to = to == buffer ? key : buffer;
  }
  if (from != key) memcpy(key, from, n * sizeof *key);
  free(buffer);
  return VG_OK;
}

static vg_status order_by(size_t n, const double (*x)[3],
                          uint64_t (*rank)(size_t), uint32_t *order,
                          struct vg_error *err)
{
  struct vg_key *key = vg_alloc(n, sizeof *key);
  double lo[3] = {0}, hi[3] = {0}, side = 0;
  vg_status st;

  if (!key) return vg_fail_memory(err, "ordering points");
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      if (!i || x[i][k] < lo[k]) lo[k] = x[i][k];
      if (!i || x[i][k] > hi[k]) hi[k] = x[i][k];
    }
  for (int k = 0; k < 3; k++)
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
  for (size_t i = 0; i < n; i++) {
    key[i].key = vg_hilbert_key(x[i], lo, side > 0 ? (1 << BITS) / side : 0);
    if (rank) key[i].key |= rank(i) << (3 * BITS);
    key[i].index = (uint32_t)i;
  }
  st = vg_sort_keys(n, key, err);
  for (size_t i = 0; i < n && st == VG_OK; i++) order[i] = key[i].index;
  free(key);
  return st;
}

vg_status vg_hilbert_order(size_t n, const double (*x)[3], uint32_t *order,
                           struct vg_error *err)
{
  return order_by(n, x, NULL, order, err);
}

/* Round of point i: 15 with probability 7/8, 14 with 7/64, ... The mix is a
 * fixed hash of the index, so the rounds are the same on every machine. */
static uint64_t round_of(size_t i)
{
  uint64_t mix = (i + 1) * 0x9e3779b97f4a7c15u, round = 15;

  mix ^= mix >> 32;
  mix *= 0xd6e8feb86659fd93u;
  mix ^= mix >> 32;
  for (; round && !(mix & 7); round--) mix >>= 3;
  return round;
}

vg_status vg_insertion_order(size_t n, const double (*x)[3], uint32_t *order,
                             struct vg_error *err)
{
  return order_by(n, x, round_of, order, err);
}
