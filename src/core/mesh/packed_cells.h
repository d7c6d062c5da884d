/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/packed_cells.h: finished tetrahedra in memory, with only the bits
 * per corner that the largest point index needs. A subdomain of 200,000 cells
 * has 45,000 points, so that a cell takes 8 bytes instead of 16. Any cell can
 * be read on its own; cells keep their order and that of their corners. */
#ifndef VG_CORE_MESH_PACKED_CELLS_H
#define VG_CORE_MESH_PACKED_CELLS_H

#include <stddef.h>
#include <stdint.h>

/** n cells; empty if zeroed. */
struct vg_packed_cells {
  unsigned width; /* Bits per corner, 1 to 32. */
  uint64_t *word; /* Corner k has bits k * width and following, from the lowest
                     bit of a word upwards; one more word at the end. */
};

/** Pack n cells with point indices below n_point.
 *
 * out: replaced without being released; to be released by the caller. Returns
 * -1 if there is not enough memory (*out is unchanged), 0 otherwise. */
int vg_packed_cells_new(size_t n, const uint32_t (*cell)[4], size_t n_point,
                        struct vg_packed_cells *out);

void vg_packed_cells_release(struct vg_packed_cells *p);

/** Unpack all n cells. cell out: [n][4]. */
void vg_packed_cells_all(const struct vg_packed_cells *p, size_t n,
                         uint32_t (*cell)[4]);

/** Bytes in memory of n cells. */
size_t vg_packed_cells_bytes(const struct vg_packed_cells *p, size_t n);

/** Corner k % 4 of cell k / 4. */
static inline uint32_t vg_packed_corner(const struct vg_packed_cells *p,
                                        size_t k)
{
  size_t bit = k * p->width;
  const uint64_t *w = p->word + bit / 64;
  unsigned low = bit % 64;

  /* two shifts, since a shift by 64 is undefined */
  return (uint32_t)((w[0] >> low | w[1] << 1 << (63 - low)) &
                    (UINT64_MAX >> (64 - p->width)));
}

/** Unpack cell c. Threads: safe, as everything that does not change p. */
static inline void vg_packed_cell(const struct vg_packed_cells *p, size_t c,
                                  uint32_t v[4])
{
  for (size_t i = 0; i < 4; i++) v[i] = vg_packed_corner(p, 4 * c + i);
}

#endif
