/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Pictures of the surface: patches, number of layers, causes. */
#include <stdio.h>

#include "cli/html/page.h"

static void pair(struct page *p, enum by by, const char *what)
{
  static const char *const from[VIEWS] = { "from the front and above",
                                           "from behind and below" };
  char alt[200];

  vg_page_markup(p, "<div class=\"pair\">\n");
  for (int view = 0; view < VIEWS; view++) {
    snprintf(alt, sizeof alt, "Surface: %s, seen %s.", what, from[view]);
    vg_page_figure(p, PICTURE_SURFACE + (int)by * VIEWS + view, NULL, alt);
    vg_page_format(p, "%s, %s", what, from[view]);
    vg_page_end_figure(p);
  }
  vg_page_markup(p, "</div>\n<p class=\"keys\">");
}

static void patch_keys(struct page *p)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  size_t n = 0, rest = 0;
  char word[VG_NAME_MAX + 24];

  for (size_t i = 0; i < m->n_patch; i++) {
    if (!p->body[i]) continue;
    if (n == 24) {
      rest++;
      continue;
    }
    n++;
    snprintf(word, sizeof word, "%d %s", (int)m->patch[i].id, m->patch[i].name);
    vg_page_key(p, vg_patch_colour[i % VG_PATCH_COLOURS], word);
  }
  if (rest) vg_page_format(p, "and %zu more; ", rest);
  vg_page_key(p, vg_adjacent_colour, "adjacent to the body");
  if (n > VG_PATCH_COLOURS)
    vg_page_markup(p, "<span>Colours repeat after twelve patches.</span>");
}

static void level_keys(struct page *p)
{
  int most = p->walls.level_most;
  char word[40];

  for (int k = 0; k < LEVEL_COLOURS; k += 3) {
    snprintf(word, sizeof word, "%d layers",
             (k * (most + 1) + LEVEL_COLOURS - 1) / LEVEL_COLOURS);
    vg_page_key(p, vg_level_colour[k], word);
  }
}

static void cause_keys(struct page *p)
{
  struct palette palette;
  char word[120];

  vg_html_palette(BY_CAUSE, &palette);
  vg_page_key(p, palette.rgb[0], "full layers");
  for (int thin = 0; thin < 2; thin++)
    for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++) {
      if (!p->walls.cause[thin][c]) continue;
      snprintf(word, sizeof word, "%s: %s (%zu triangles)",
               thin ? "thinner" : "fewer",
               vg_cause_words((enum vg_layer_cause)c), p->walls.cause[thin][c]);
      vg_page_key(p, palette.rgb[c + thin * VG_CAUSE_N], word);
    }
}

void vg_html_surface(struct page *p)
{
  vg_page_section(p, "surface", "Surface");
  pair(p, BY_PATCH, "Patches");
  patch_keys(p);
  if (p->has_layers) {
    vg_page_markup(p, "</p>\n");
    pair(p, BY_LEVEL, "Number of layers");
    level_keys(p);
    vg_page_markup(p, "</p>\n");
    pair(p, BY_CAUSE, "Causes of fewer or thinner layers");
    cause_keys(p);
  }
  vg_page_markup(p, "</p>\n");
  vg_page_end_section(p);
}
