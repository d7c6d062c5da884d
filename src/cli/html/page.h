/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/html: elements and sections of a page. */
#ifndef VG_CLI_HTML_PAGE_H
#define VG_CLI_HTML_PAGE_H

#include "cli/html/html.h"
#include "cli/scene/scene.h"
#include "io/stream/stream.h"
#include "run/picture/body.h"
#include "run/picture/shot.h"

/* Pictures of a page by number: the surface coloured by a quantity (enum by)
 * from two directions, cuts, and two of the cuts in other colours. */
enum { VIEWS = 2 };
enum by { BY_PATCH, BY_LEVEL, BY_CAUSE, BY_N };
enum {
  PICTURE_SURFACE = 0,
  PICTURE_CUT = BY_N * VIEWS,
  PICTURE_ANGLE = PICTURE_CUT + VG_CUTS_MAX,
  PICTURE_PART,
  PICTURES
};

/* Colours of the triangles of the surface, GREY if not on a wall, and which
 * triangles are visible in its pictures. walls.c */
struct walls {
  uint8_t *by[BY_N], *by_share, *is_seen; /* [surface.n_tri] */
  int level_most;
  size_t cause[2][VG_CAUSE_N]; /* triangles: fewer, thinner */
};

struct page {
  struct vg_output out;
  const struct vg_html *h;
  int has_layers;
  uint8_t *body; /* [surface.n_patch] run/picture/body.h */
  struct walls walls;
  struct vg_camera camera[VIEWS];
  struct vg_bytes png[PICTURES]; /* empty if there is no such picture */
  size_t part_cut;               /* cut of PICTURE_PART */
};

/* page.c: text with markup escaped; markup, written unchanged; printf, to be
 * used without reals. */
void vg_page_text(struct page *p, const char *text);
void vg_page_markup(struct page *p, const char *markup);
void vg_page_format(struct page *p, const char *format, ...)
  __attribute__((format(printf, 2, 3)));

/* A count with thousands separators; a real with `digits` significant digits;
 * a real with `decimals` decimals; a dash if it is not finite. */
void vg_page_count(struct page *p, uint64_t n);
void vg_page_real(struct page *p, double v, int digits);
void vg_page_fixed(struct page *p, double v, int decimals);

/* Bytes, encoded as base64. */
void vg_page_base64(struct page *p, const unsigned char *data, size_t n);

/* A colour as "#rrggbb". */
void vg_page_colour(struct page *p, const uint8_t rgb[3]);

/* A legend entry: a coloured square and a word. */
void vg_page_key(struct page *p, const uint8_t rgb[3], const char *word);

/* Begin of a section with id and heading; end of a section. */
void vg_page_section(struct page *p, const char *id, const char *title);
void vg_page_end_section(struct page *p);

/* A figure: a picture with an alternative text; the caller adds the caption and
 * vg_page_end_figure. id: for scripts, or NULL. */
void vg_page_figure(struct page *p, int picture, const char *id,
                    const char *alt);
void vg_page_end_figure(struct page *p);

/* A row of a table of facts: vg_page_fact writes the name only, and the caller
 * adds the value and </td></tr>; vg_page_fact_count writes a complete row. */
void vg_page_fact(struct page *p, const char *name);
void vg_page_fact_count(struct page *p, const char *name, uint64_t n);

/* Values of the report by path, as in "field.angle_min"; NULL and 0 if
 * absent. */
const json_t *vg_page_json(const struct page *p, const char *path);
double vg_page_number(const struct page *p, const char *path);

/* The object of the report with the quality of the cells: "field" or "mesh". */
const char *vg_page_judged(const struct page *p);

/* html_pictures.c: draws all pictures; the colours of a kind of picture. */
vg_status vg_html_draw(struct page *p, struct vg_error *err);
struct palette {
  uint8_t rgb[256][3];
};
void vg_html_palette(enum by by, struct palette *to);

/* Sections, in the order of the page. */
void vg_html_head(struct page *p); /* html_head.c */
void vg_html_first(struct page *p);
void vg_html_tiles(struct page *p);
vg_status vg_html_scene(struct page *p, struct vg_error *err);
void vg_html_surface(struct page *p);
void vg_html_cuts(struct page *p);
void vg_html_layers(struct page *p);
void vg_html_quality(struct page *p);
void vg_html_volumes(struct page *p);
void vg_html_wakes(struct page *p);
void vg_html_zones(struct page *p);
void vg_html_worst(struct page *p);
void vg_html_settings(struct page *p);
void vg_html_patches(struct page *p);
void vg_html_partition(struct page *p); /* html_cuts.c */
vg_status vg_html_run(struct page *p, struct vg_error *err);

/* html_cuts.c: a cut with its cells coloured by smallest angle. */
void vg_html_angles(struct page *p);

/* A histogram with bins of width `step` from 0, or of equal ratio; bins below
 * bad_below and from bad_from on are highlighted. Counts have a logarithmic
 * scale. */
struct bars {
  const char *title, *unit, *alt;
  int decimals;
  double step, bad_below, bad_from;
  double lowest;  /* begin of the first bin if bins have equal ratios, else 0 */
  int per_octave; /* number of such bins per factor of 2: 1, 2 or 4 */
};
void vg_html_bars(struct page *p, const struct bars *b, const json_t *counts);

/* colours.c; those of patches are in cli/scene/scene.h */
enum { LEVEL_COLOURS = 16, GREY = VG_SHOT_BEHIND };
extern const uint8_t vg_level_colour[LEVEL_COLOURS][3];
extern const uint8_t vg_cause_colour[VG_CAUSE_N][3];

/* Explanation of a cause, such as "proximity". */
const char *vg_cause_words(enum vg_layer_cause cause);

vg_status vg_walls_colour(const struct page *p, struct walls *w,
                          struct vg_error *err);
void vg_walls_release(struct walls *w);

#endif
