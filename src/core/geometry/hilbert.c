/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/hilbert.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"

enum { BITS = 20 };

/* The Hilbert curve through the eight octants of a cube, for each of its 24
 * orientations. An entry is 8 times the orientation within the octant, plus
 * the rank of the octant along the curve. Orientations of Skilling's key
 * ("Programming the Hilbert curve", 2004). */
static const uint8_t passed[24][8] = {
  { 8, 17, 27, 2, 39, 46, 52, 5 },
  { 56, 71, 73, 86, 91, 20, 10, 13 },
  { 48, 1, 103, 110, 115, 18, 12, 21 },
  { 126, 129, 29, 26, 79, 80, 140, 3 },
  { 148, 43, 37, 34, 127, 128, 78, 81 },
  { 156, 45, 35, 42, 31, 6, 160, 105 },
  { 72, 87, 139, 4, 57, 70, 50, 53 },
  { 0, 171, 111, 76, 49, 58, 102, 61 },
  { 180, 143, 83, 184, 69, 54, 66, 97 },
  { 16, 123, 9, 74, 47, 60, 38, 77 },
  { 132, 95, 85, 14, 67, 144, 82, 33 },
  { 142, 55, 185, 96, 93, 116, 90, 11 },
  { 188, 107, 175, 176, 101, 98, 62, 65 },
  { 164, 109, 119, 22, 99, 106, 152, 41 },
  { 174, 177, 63, 64, 117, 114, 92, 19 },
  { 30, 125, 161, 122, 7, 172, 104, 75 },
  { 130, 25, 133, 166, 179, 136, 84, 191 },
  { 94, 15, 141, 28, 145, 32, 138, 51 },
  { 146, 155, 149, 36, 137, 24, 190, 167 },
  { 154, 157, 147, 44, 169, 182, 120, 135 },
  { 162, 165, 121, 134, 187, 108, 168, 183 },
  { 118, 173, 23, 124, 153, 170, 40, 59 },
  { 178, 113, 131, 88, 181, 158, 68, 151 },
  { 186, 163, 89, 112, 189, 100, 150, 159 }
};

uint64_t vg_hilbert_key(const double x[3], const double lo[3], double scale)
{
  uint64_t part = 0, key = 0;
  unsigned position = 0;

  for (int k = 0; k < 3; k++) {
    double cell = (x[k] - lo[k]) * scale;
    uint32_t q = !(cell > 0)              ? 0
               : cell >= (1u << BITS) - 1 ? (1u << BITS) - 1
                                          : (uint32_t)cell;

    part = part << 1 | vg_interleave3(q);
  }
  for (int shift = 3 * (BITS - 1); shift >= 0; shift -= 3) {
    unsigned to = passed[position][part >> shift & 7];

    key = key << 3 | (to & 7);
    position = to >> 3;
  }
  return key;
}

vg_status vg_sort_keys(size_t n, struct vg_key *key, struct vg_error *err)
{
  assert(key || !n);

  struct vg_key *to, *from = key, *buffer = vg_alloc(n, sizeof *buffer);
  uint64_t any = 0;

  if (!buffer) return vg_fail_memory(err, "sorting");
  to = buffer;
  for (size_t i = 0; i < n; i++) any |= key[i].key ^ key[0].key;
  for (int shift = 0; shift < 64; shift += 11) {
    size_t start[2049] = { 0 };

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
  for (size_t i = 1; i < n; i++) assert(key[i - 1].key <= key[i].key);
  return VG_OK;
}

static vg_status order_by(size_t n, const double (*x)[3],
                          uint64_t (*rank)(size_t), uint32_t *order,
                          struct vg_error *err)
{
  struct vg_key *key = vg_alloc(n, sizeof *key);
  double lo[3] = { 0 }, hi[3] = { 0 }, side = 0;
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
  assert(n == 0 || (x && order));
  return order_by(n, x, NULL, order, err);
}

/* Round of point i: 15 with probability 7/8, 14 with 7/64, ... The mix is a
 * fixed hash of the index, so that the rounds are the same on every machine. */
static uint64_t round_of(size_t i)
{
  uint64_t mix = vg_hash_mix((i + 1) * VG_GOLDEN), round = 15;

  for (; round && !(mix & 7); round--) mix >>= 3;
  return round;
}

vg_status vg_insertion_order(size_t n, const double (*x)[3], uint32_t *order,
                             struct vg_error *err)
{
  assert(n == 0 || (x && order));
  return order_by(n, x, round_of, order, err);
}
