/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/cuts_parts.h: samples of a cut. Private to run/picture. */
#ifndef VG_RUN_PICTURE_CUTS_PARTS_H
#define VG_RUN_PICTURE_CUTS_PARTS_H

#include <pthread.h>

#include "run/picture/cuts.h"

/* Samples are stored in square tiles, which are created when first drawn
 * into. */
enum {
  SAMPLES = 2,
  TILE = 64,
  TILES_X = SAMPLES * VG_CUT_WIDTH / TILE,
  TILES_Y = SAMPLES * VG_CUT_HEIGHT / TILE,
  TILES = TILES_X * TILES_Y,
  CORNERS_MAX = 12 /* edges of a hexahedron */
};

/* A sample: 0 if nothing is drawn, or a code that describes the cell. */
#define CODE(kind, shade, angle, part)                                         \
  (uint16_t)(0x8000 | (kind) << 12 | (shade) << 9 | (angle) << 6 | (part))
enum {
  SHADE_MAX = 7,
  PARTS = 64,
  PART_LAYER = 0,
  PART_ZONE = 1,
  PART_FIRST = 2
};

struct tile {
  uint16_t code[TILE * TILE];
  pthread_mutex_t lock; /* Held by the thread that draws. */
};

struct vg_cuts {
  size_t n;
  struct vg_cut cut[VG_CUTS_MAX];
  struct tile **at; /* [n * TILES]; NULL: nothing is drawn there. */
};

/* In samples, from the upper left corner. */
struct polygon {
  int n;
  double p[CORNERS_MAX][2];
};

/** The tile, created if it does not exist; NULL: no memory. Threads: safe. */
struct tile *vg_cuts_tile(struct tile **at);

/* cuts_draw.c: draws a convex polygon. Its corners may be in any order and are
 * sorted around it. code: that of an inner sample, with shade 0. Threads: safe.
 */
vg_status vg_cuts_draw(struct tile **tiles, struct polygon *g, uint16_t code,
                       struct vg_error *err);

#endif
