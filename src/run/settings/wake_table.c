/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/settings/wake_table.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "io/stream/stream.h"

/* Position in vg_wake_table. */
enum { PATCH };

size_t vg_wake_angles(const char *text, double angle[VG_WAKE_ANGLES])
{
  size_t n = 0;

  for (;;) {
    size_t len = strcspn(text, ", ");

    if (n == VG_WAKE_ANGLES || strspn(text, "+-.0123456789") < len ||
        !vg_parse_real(text, len, &angle[n]) ||
        fabs(angle[n]) > VG_WAKE_ANGLE_MAX)
      return 0;
    n++;
    text += len;
    if (!*text) return n;
    if (*text++ != ',') return 0;
    text += strspn(text, " ");
  }
}

static vg_status check_angles(const char *name, const char *text,
                              struct vg_error *err)
{
  double angle[VG_WAKE_ANGLES];

  if (vg_wake_angles(text, angle)) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: '%s' is not a list of 1 to %d angles from -%d to %d "
                 "degrees; separate them by commas, as in 0,2.5,-4",
                 name, text, VG_WAKE_ANGLES, VG_WAKE_ANGLE_MAX,
                 VG_WAKE_ANGLE_MAX);
}

/* `$` alone also matches before a line feed at the end. */
static char *angles_pattern(void)
{
#define DECIMALS "(?:\\.[0-9]*)?"
#define ANGLE "[-+]?0*(?:60(?:\\.0*)?|[0-5]?[0-9]" DECIMALS "|\\.[0-9]+)"
  return strdup("^" ANGLE "(?:, *" ANGLE "){0,15}$(?!\\n)");
}

/* In the order of enum vg_wake_up, enum vg_wake_stream. */
static const char *const up_words[] = { "auto", "x", "y", "z", NULL };
static const char *const stream_words[] = { "x", "-x", "y", "-y",
                                            "z", "-z", NULL };

#define AT(field)                                                              \
  .offset = offsetof(struct vg_wake_row, field),                               \
  .size = sizeof((struct vg_wake_row *)0)->field
#define CHORDS(name, field, most, about)                                       \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_REAL, .hi = most, .above_lo = 1,         \
                     .unit = "chords", .help = about                           \
  }
#define ANGLES(name, field, about)                                             \
  {                                                                            \
    name, AT(field), .type = VG_PARAM_TEXT, .check = check_angles,             \
                     .pattern = angles_pattern, .unit = "degrees",             \
                     .help = about                                             \
  }

/* In the order of enum vg_wake_kind. */
static const char *const kind_words[] = { "sources", "sheet", NULL };

static const struct vg_param columns[] = {
  { "patch", AT(patch), VG_PATCH_COLUMN(struct vg_wake_row, patch_name),
    .required = 1,
    .help = "Number or name of the patch whose trailing edges have the wake "
            "(* and ? are wildcards; * alone: all)" },
  { "kind", AT(kind), .type = VG_PARAM_WORD, .words = kind_words, .unit = "",
    .help = "sources: sizes around the wake; sheet: a surface of triangles "
            "from the trailing edges along one stream, with fluid on both "
            "sides, on which layers can grow" },
  CHORDS("length", length, 1000, "Length of the wake downstream"),
  CHORDS("size", size, 10, "Edge length across the wake at the trailing edge"),
  CHORDS("height", height, 10,
         "Half of the wake's height at the trailing "
         "edge"),
  { "growth", AT(growth), .type = VG_PARAM_REAL, .lo = 1, .hi = 2, .unit = "",
    .help = "Growth downstream: size and height increase along the stream as "
            "edges of this growth ratio do" },
  { "chord", AT(chord), .type = VG_PARAM_REAL, .hi = 1e60, .unit = "length",
    .help = "Reference chord; 0: the local chord" },
  { "stretch", AT(stretch), .type = VG_PARAM_REAL, .lo = 1, .hi = 100,
    .unit = "", .help = "Edge lengths along the stream over those across it" },
  ANGLES("alpha", alpha,
         "Angles of attack, as in 0,4: one wake for each angle"),
  ANGLES("beta", beta,
         "Angles of sideslip: one wake for each pair of alpha and beta"),
  { "stream", AT(stream), .type = VG_PARAM_WORD, .words = stream_words,
    .unit = "",
    .help = "Axis along which the stream runs if alpha and beta are 0" },
  { "up", AT(up), .type = VG_PARAM_WORD, .words = up_words, .unit = "",
    .help = "Axis that points up; alpha turns the stream towards it. auto: of "
            "the two axes normal to the stream, the one along which the body "
            "is less extended" },
};

const struct vg_setting_table vg_wake_table = {
  "wakes",
  "Refined wakes of trailing edges, which are found by "
  "geometry. Lengths are in chords.",
  columns, sizeof columns / sizeof *columns, sizeof(struct vg_wake_row)
};

const char *vg_wake_kind_word(const struct vg_wake_row *row)
{
  return kind_words[row->kind];
}

const char *vg_wake_stream_word(const struct vg_wake_row *row)
{
  return stream_words[row->stream];
}

/* W3: defaults. */
void vg_wake_row_default(struct vg_wake_row *row)
{
  *row = (struct vg_wake_row){ .patch = VG_BC_NONE,
                               .length = 2,
                               .size = 0.02,
                               .height = 0.05,
                               .growth = 1.01,
                               .stretch = 1,
                               .patch_name = "*",
                               .alpha = "0",
                               .beta = "0" };
}

vg_status vg_wake_rows_check(const struct vg_settings *s, struct vg_error *err)
{
  char patch[2 * VG_NAME_MAX + 4];

  for (size_t i = 0; i < s->n_wake; i++) {
    const struct vg_wake_row *r = &s->wake_row[i];

    vg_param_format(&columns[PATCH], r, patch, sizeof patch);
    if (r->kind == VG_WAKE_SOURCES && r->size > 2 * r->height)
      return vg_fail(err, VG_ERR_INPUT,
                     "wakes: line %zu, patch %s: the size, %g chords, exceeds "
                     "the height of the wake, 2 x %g; reduce size or increase "
                     "height",
                     i + 1, patch, r->size, r->height);
    if (r->up != VG_UP_AUTO && r->up - VG_UP_X == r->stream / 2)
      return vg_fail(err, VG_ERR_INPUT,
                     "wakes: line %zu, patch %s: up and stream name the same "
                     "axis, %s; change one of them",
                     i + 1, patch, up_words[r->up]);
    if (r->kind == VG_WAKE_SHEET &&
        (strchr(r->alpha, ',') || strchr(r->beta, ',')))
      return vg_fail(err, VG_ERR_INPUT,
                     "wakes: line %zu, patch %s: a sheet follows one stream; "
                     "give one angle in alpha and in beta, and a line for each "
                     "further sheet",
                     i + 1, patch);
    if (r->kind == VG_WAKE_SOURCES && r->size > r->length)
      return vg_fail(err, VG_ERR_INPUT,
                     "wakes: line %zu, patch %s: the size, %g chords, exceeds "
                     "the length of the wake, %g; reduce size or increase "
                     "length",
                     i + 1, patch, r->size, r->length);
  }
  return VG_OK;
}
