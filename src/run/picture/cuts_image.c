/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Converts samples of a cut to pixels. */
#include "run/picture/cuts.h"

#include <assert.h>

#include "run/picture/cuts_parts.h"

const uint8_t vg_cut_kind_colour[VG_CUT_KINDS][3] = { { 250, 236, 200 },
                                                      { 143, 202, 132 },
                                                      { 246, 166, 86 },
                                                      { 120, 178, 232 },
                                                      { 178, 150, 214 } };
const uint8_t vg_cut_zone_colour[3] = { 74, 80, 92 };
const uint8_t vg_cut_angle_colour[VG_CUT_ANGLES + 1][3] = {
  { 170, 0, 30 },    { 226, 88, 40 },   { 246, 170, 80 },
  { 250, 222, 140 }, { 200, 224, 170 }, { 120, 186, 160 }
};

static const uint8_t layer_grey[3] = { 214, 216, 220 };
static const uint8_t ink[3] = { 34, 36, 46 };

/* Subdomains with neighbouring numbers get clearly different colours. */
static const uint8_t part_colour[12][3] = {
  { 141, 184, 226 }, { 244, 190, 120 }, { 150, 204, 150 }, { 232, 150, 150 },
  { 190, 170, 220 }, { 206, 174, 150 }, { 240, 180, 214 }, { 200, 200, 110 },
  { 120, 204, 206 }, { 250, 220, 150 }, { 170, 200, 190 }, { 222, 196, 232 }
};

static const uint8_t *colour_of(unsigned code, enum vg_cut_colours colours)
{
  unsigned kind = code >> 12 & 7, part = code & 63;

  if (colours == VG_CUT_BY_KIND) return vg_cut_kind_colour[kind];
  if (part == PART_LAYER) return layer_grey;
  if (colours == VG_CUT_BY_ANGLE) return vg_cut_angle_colour[code >> 6 & 7];
  if (part == PART_ZONE) return vg_cut_zone_colour;
  return part_colour[(part - PART_FIRST) % 12];
}

size_t vg_cuts_in_parts(const struct vg_cuts *c, size_t i)
{
  size_t n = 0;

  assert(i < c->n);
  for (size_t k = i * TILES; k < (i + 1) * TILES; k++)
    for (size_t j = 0; c->at[k] && j < TILE * TILE; j++)
      n += (c->at[k]->code[j] & (PARTS - 1)) >= PART_FIRST;
  return n;
}

/* Sums over the samples of a pixel. */
struct sum {
  int rgb[3], n;
};

/* Colour of a sample, darkened near an edge. */
static struct sum shaded(unsigned code, enum vg_cut_colours colours)
{
  const uint8_t *c = colour_of(code, colours);
  int shade = (int)(code >> 9 & 7), dark = 2 * SHADE_MAX;
  struct sum s = { .n = 1 };

  for (int k = 0; k < 3; k++)
    s.rgb[k] = (c[k] * (dark - shade) + ink[k] * shade) / dark;
  return s;
}

/* Pixels of a tile. Neighbouring samples mostly have the same code. */
static void tile_pixels(const struct tile *t, enum vg_cut_colours colours,
                        uint8_t (*to)[4])
{
  unsigned last = 0;
  struct sum of_last = { .n = 0 };

  for (int y = 0; y < TILE / SAMPLES; y++)
    for (int x = 0; x < TILE / SAMPLES; x++) {
      uint8_t *pixel = to[y * VG_CUT_WIDTH + x];
      struct sum sum = { .n = 0 };

      for (int j = 0; j < SAMPLES * SAMPLES; j++) {
        unsigned code = t->code[(SAMPLES * y + j / SAMPLES) * TILE +
                                SAMPLES * x + j % SAMPLES];

        if (!code) continue;
        if (code != last) of_last = shaded(code, colours);
        last = code;
        for (int k = 0; k < 3; k++) sum.rgb[k] += of_last.rgb[k];
        sum.n++;
      }
      for (int k = 0; k < 3 && sum.n; k++)
        pixel[k] = (uint8_t)(sum.rgb[k] / sum.n);
      pixel[3] = (uint8_t)(255 * sum.n / (SAMPLES * SAMPLES));
    }
}

vg_status vg_cuts_image(const struct vg_cuts *c, size_t i,
                        enum vg_cut_colours colours, struct vg_image *out,
                        struct vg_error *err)
{
  vg_status st = vg_image_new(VG_CUT_WIDTH, VG_CUT_HEIGHT, out, err);

  assert(i < c->n && out);
  for (int k = 0; k < TILES && st >= 0; k++) {
    int y = k / TILES_X * TILE / SAMPLES, x = k % TILES_X * TILE / SAMPLES;

    if (c->at[i * TILES + (size_t)k])
      tile_pixels(c->at[i * TILES + (size_t)k], colours,
                  out->rgba + y * VG_CUT_WIDTH + x);
  }
  return st;
}
