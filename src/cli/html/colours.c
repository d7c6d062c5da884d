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
  { 176, 208, 190 }, { 176, 208, 190 }, { 230, 159, 0 }, { 160, 110, 190 },
  { 200, 40, 50 },   { 130, 70, 40 },   { 0, 114, 178 }, { 240, 100, 150 }
};

const char *vg_cause_words(enum vg_layer_cause cause)
{
  static const char *const words[VG_CAUSE_N] = {
    "full layers",
    "ended at the local edge length, as intended",
    "proximity to an opposite surface",
    "columns converge in a concave corner",
    "no direction sees all faces of the point",
    "a cell would be inverted or flat",
    "tops or side faces of the layers would intersect",
    "the wall meets a slide patch at too flat an angle"
  };

  return words[cause];
}
