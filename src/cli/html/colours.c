/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Colours of layer counts and causes, for pictures and legends. */
#include "cli/html/page.h"

/* From few to many layers: dark blue over green to yellow, with increasing
 * brightness. */
const uint8_t vg_level_colour[LEVEL_COLOURS][3] = {
  { 68, 1, 84 },    { 72, 26, 108 },  { 71, 47, 125 },  { 65, 68, 135 },
  { 57, 86, 140 },  { 49, 104, 142 }, { 42, 120, 142 }, { 35, 136, 142 },
  { 31, 152, 139 }, { 34, 168, 132 }, { 53, 183, 121 }, { 84, 197, 104 },
  { 122, 209, 81 }, { 165, 219, 54 }, { 210, 226, 27 }, { 253, 231, 37 }
};

const uint8_t vg_cause_colour[VG_CAUSE_N][3] = {
#define ROW(name, key, text, red, green, blue) { red, green, blue },
  VG_LAYER_CAUSES(ROW)
#undef ROW
};

const char *vg_cause_words(enum vg_layer_cause cause)
{
#define ROW(name, key, text, red, green, blue) text,
  static const char *const words[] = { VG_LAYER_CAUSES(ROW) };
#undef ROW

  return words[cause];
}
