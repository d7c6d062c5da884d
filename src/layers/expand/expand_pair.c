/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells of a pair of faces below the level where its lowest column ends.
 * Declared in layers/expand/pairs.h, which has the drawing. Rings of pyramids
 * are counter-clockwise seen from outside, so that the apex is behind them. */
#include <assert.h>
#include <string.h>

#include "layers/expand/pairs.h"

static void put_pyramid(struct vg_cell_sink *s, uint32_t r0, uint32_t r1,
                        uint32_t r2, uint32_t r3, uint32_t apex)
{
  const uint32_t node[5] = { r0, r1, apex, r3, r2 };

  memcpy(*s->pyr++, node, sizeof node);
}

static void put_tet(struct vg_cell_sink *s, uint32_t a, uint32_t b, uint32_t c,
                    uint32_t d)
{
  const uint32_t node[4] = { a, b, c, d };

  memcpy(*s->tet++, node, sizeof node);
}

static void put_hex(struct vg_cell_sink *s, const uint32_t p[4],
                    const uint32_t h[4])
{
  uint32_t *n = *s->hex++;

  memcpy(n, p, 4 * sizeof *n);
  memcpy(n + 4, h, 4 * sizeof *n);
}

/* Level 0: columns h[0], h[1] stand on root a, h[2], h[3] on root b; or each
 * column on its own root. */
static void from_wall(enum vg_pair_start start, const uint32_t foot[4],
                      const uint32_t h[4], struct vg_cell_sink *s)
{
  const uint32_t a = foot[0], b = foot[2];
  const uint32_t prism[6] = { a, h[0], h[1], b, h[3], h[2] };

  switch (start) {
  case VG_PAIR_TOGETHER: memcpy(*s->pri++, prism, sizeof prism); break;
  case VG_PAIR_FIRST_ROOT:
    put_tet(s, a, b, h[0], h[1]);
    put_pyramid(s, h[0], h[1], h[2], h[3], b);
    break;
  case VG_PAIR_SECOND_ROOT:
    put_tet(s, b, a, h[2], h[3]);
    put_pyramid(s, h[0], h[1], h[2], h[3], a);
    break;
  case VG_PAIR_ON_WALL: put_hex(s, foot, h); break;
  }
}

/* The last level, whose top is that of the single faces. p: points below it. */
static void transition(const struct vg_expand *e, const size_t pair[2],
                       const uint32_t q[4], const uint32_t p[4],
                       uint32_t middle, struct vg_cell_sink *s)
{
  put_pyramid(s, p[0], p[3], p[2], p[1], middle);
  for (int k = 0; k < 4; k++) {
    const uint32_t a = p[k], b = p[(k + 1) % 4];

    put_pyramid(s, a, b, b + 1, a + 1, middle);
  }
  for (int i = 0; i < 2; i++) {
    uint32_t top[3];

    for (int k = 0; k < 3; k++) {
      int j = 0;

      while (q[j] != e->columns->face[pair[i]][k]) j++;
      assert(j < 4);
      top[k] = p[j] + 1;
    }
    put_tet(s, top[0], top[2], top[1], middle);
  }
}

void vg_expand_pair(const struct vg_expand *e, const size_t pair[2],
                    const uint32_t q[4], enum vg_pair_start start,
                    const uint32_t foot[4], const uint32_t base[4],
                    uint32_t middle, struct vg_cell_sink *s)
{
  const unsigned low = vg_pair_levels(e, q);
  uint32_t p[4];

  assert(low > 1);
  memcpy(p, base, sizeof p);
  from_wall(start, foot, base, s);
  for (unsigned l = 1; l + 1 < low; l++) {
    const uint32_t h[4] = { p[0] + 1, p[1] + 1, p[2] + 1, p[3] + 1 };

    put_hex(s, p, h);
    memcpy(p, h, sizeof p);
  }
  transition(e, pair, q, p, middle, s);
}
