/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/sites.h: settled points of a body-centred cubic lattice. One bit
 * per point, in blocks of 8 x 8 x 8 half sides, whose bits fill a cache line.
 * Uses base only. */
#ifndef VG_CORE_FILL_SITES_H
#define VG_CORE_FILL_SITES_H

#include <stddef.h>
#include <stdint.h>

#include "base/table.h"

struct vg_sites {
  struct vg_table table;
  size_t n, cap;
  struct vg_site_block {
    int32_t at[3]; /* position of the block, in units of 8 half sides */
    float h;       /* spacing of the lattice */
    uint64_t bit[8];
  } * block; /* [n] */
};

void vg_sites_release(struct vg_sites *s);

/** The block that contains site i of the lattice with spacing h > 0, created if
 * needed; NULL if memory is refused. The pointer is valid until the next call.
 * i: below 2^33 in magnitude. */
struct vg_site_block *vg_sites_block(struct vg_sites *s, const int64_t i[3],
                                     float h);

/** Is site i in block b? */
static inline int vg_site_is_in(const struct vg_site_block *b,
                                const int64_t i[3])
{
  return !((i[0] >> 3 ^ b->at[0]) | (i[1] >> 3 ^ b->at[1]) |
           (i[2] >> 3 ^ b->at[2]));
}

/* Bit of site i in bit[i[0] & 7] of its block. */
static inline uint64_t vg_site_bit(const int64_t i[3])
{
  return (uint64_t)1 << ((i[1] & 7) << 3 | (i[2] & 7));
}

#endif
