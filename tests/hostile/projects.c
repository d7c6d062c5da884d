/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Project files and run decks that break their rules, given to `vanguard mesh`,
 * which must stop before it meshes anything. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hostile.h"

/* A good .d3m: the unit tetrahedron. Each case replaces lines of it. */
static const char *const good[] = {
  "#VGRID VERSION",
  "3.6",
  "#Project Name",
  "T1",
  "#",
  "1 (grid)",
  "0.15 (rate1)",
  "0.02 (rate2)",
  "0.001 (delt1)",
  "100 (nlayr)",
  "0 (rstrt)",
  "1 (ifact)",
  "1 (vfact)",
  "0 (strch)",
  "4 (npoli)",
  "6 (nline)",
  "4 (nptch)",
  "1 (ms)",
  "20 (ni)",
  "250000 (mboun)",
  "2500000 (mpoin)",
  "#",
  "1 0 0 0",
  "2 1 0 0",
  "3 0 1 0",
  "4 0 0 1",
  "#",
  "1 2 1 2",
  "2 2 2 3",
  "3 2 1 3",
  "4 2 1 4",
  "5 2 2 4",
  "6 2 3 4",
  "#",
  "1 1 3 0 2 viscous_surface",
  "1 2 -3",
  "2 1 3 0 1 char_in/outflow",
  "4 -5 -1",
  "3 1 3 0 1 char_in/outflow",
  "3 6 -4",
  "4 1 3 0 1 char_in/outflow",
  "5 -6 -2",
  "#",
  "source_number 1 all",
  "0 0",
  "1 0 0",
  "0.2 0.2",
  "0.001 0.15 0.02",
  "0.2 0.2",
  "0.001 0.15 0.02",
  "1 0 0",
  "0 0 0",
  "0 0 0",
  "0 0 0",
};
#define N_LINE (sizeof good / sizeof *good)

/* Write stem.d3m with the line that equals `from` replaced by `to`. If `to` is
 * NULL, the file ends before that line. */
static void save_d3m(const char *stem, const char *from, const char *to)
{
  char text[4096], name[80];
  size_t n = 0;
  int found = 0;

  for (size_t i = 0; i < N_LINE; i++) {
    const char *line = good[i];

    if (!strcmp(line, from)) {
      found = 1;
      if (!to) break;
      line = to;
    }
    n += (size_t)snprintf(text + n, sizeof text - n, "%s\n", line);
  }
  if (!found) abort();
  snprintf(name, sizeof name, "%s.d3m", stem);
  save(name, text, n);
}

static void make_count(const char *stem)
{
  save_d3m(stem, "4 (npoli)", "2000000000 (npoli)");
}

static void make_negative(const char *stem)
{
  save_d3m(stem, "6 (nline)", "-6 (nline)");
}

static void make_point_nan(const char *stem)
{
  save_d3m(stem, "3 0 1 0", "3 0 nan 0");
}

static void make_curve_range(const char *stem)
{
  save_d3m(stem, "5 2 2 4", "5 2 2 44");
}

static void make_patch_range(const char *stem)
{
  save_d3m(stem, "3 6 -4", "3 66 -4");
}

static void make_loop_open(const char *stem)
{
  save_d3m(stem, "5 -6 -2", "5 6 -2");
}

static void make_spacing_zero(const char *stem)
{
  save_d3m(stem, "0.2 0.2", "0 0.2");
}

static void make_truncated(const char *stem)
{
  save_d3m(stem, "0.001 0.15 0.02", NULL);
}

static void make_ends_early(const char *stem)
{
  save_d3m(stem, "100 (nlayr)", NULL);
}

static void make_d3m_binary(const char *stem)
{
  char name[80];

  snprintf(name, sizeof name, "%s.d3m", stem);
  save(name, "\000\001\002\003\377\376", 6);
}

static void make_d3m_empty(const char *stem)
{
  char name[80];

  snprintf(name, sizeof name, "%s.d3m", stem);
  save(name, "", 0);
}

/* For a file that another case writes, or that must not exist. */
static void make_nothing(const char *stem)
{
  (void)stem;
}

/* A good surface with a bad deck in the same folder. */
static void save_deck(const char *stem, const char *deck)
{
  char name[80];

  snprintf(name, sizeof name, "%s.tri", stem);
  save_text(name, "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 3 2\n1 2 4\n1 4 3\n"
                  "2 3 4\n");
  snprintf(name, sizeof name, "%s.deck", stem);
  save_text(name, deck);
}

static void make_unknown_name(const char *stem)
{
  save_deck(stem, "title\ngrowt hmin\n1.2 0.1\n");
}

static void make_not_a_number(const char *stem)
{
  save_deck(stem, "title\ngrowth hmin\n1.2 small\n");
}

static void make_missing_value(const char *stem)
{
  save_deck(stem, "title\ngrowth hmin hmax\n1.2 0.1\n");
}

static void make_out_of_range(const char *stem)
{
  save_deck(stem, "title\ngrowth\n0.5\n");
}

static void make_source_without_spacing(const char *stem)
{
  save_deck(stem, "title\nsources\nkind x0 y0 z0\npoint 0 0 0\n");
}

static void make_deck_binary(const char *stem)
{
  save_deck(stem, "title\n\001\002\003 \377\n");
}

/* Without it, the surface is wrapped. */
static void make_unrepaired(const char *file)
{
  char name[80];

  snprintf(name, sizeof name, "%s.deck", file);
  save_text(name, "unrepaired\nrepair\nno\n");
}

static void make_quote(const char *stem)
{
  save_deck(stem, "title\nwrite\n\"cogsg,vtu\n");
}

#define MESH "mesh -p"

const struct hostile hostile_projects[] = {
  { .file = "d3m_count",
    .phrase = "too short",
    .make = make_count,
    .command = MESH },
  { .file = "d3m_negative",
    .phrase = "-6",
    .make = make_negative,
    .command = MESH },
  { .file = "d3m_nan",
    .phrase = "nan",
    .make = make_point_nan,
    .command = MESH },
  { .file = "d3m_curve",
    .phrase = "44",
    .make = make_curve_range,
    .command = MESH },
  { .file = "d3m_patch",
    .phrase = "66",
    .make = make_patch_range,
    .command = MESH },
  { .file = "d3m_loop",
    .phrase = "patch 4",
    .make = make_loop_open,
    .command = MESH },
  { .file = "d3m_spacing",
    .phrase = "spacing",
    .make = make_spacing_zero,
    .command = MESH },
  { .file = "d3m_truncated",
    .phrase = "ends",
    .make = make_truncated,
    .command = MESH },
  { .file = "d3m_early",
    .phrase = "ends",
    .make = make_ends_early,
    .command = MESH },
  { .file = "d3m_binary",
    .phrase = "d3m_binary.d3m",
    .make = make_d3m_binary,
    .command = MESH },
  { .file = "d3m_empty",
    .phrase = "empty",
    .make = make_d3m_empty,
    .command = MESH },
  { .file = "deck_name",
    .phrase = "'growth'",
    .make = make_unknown_name,
    .command = MESH },
  { .file = "deck_number",
    .phrase = "'small'",
    .make = make_not_a_number,
    .command = MESH },
  { .file = "deck_missing",
    .phrase = "2 values for 3 names",
    .make = make_missing_value,
    .command = MESH },
  { .file = "deck_range",
    .phrase = "growth",
    .make = make_out_of_range,
    .command = MESH },
  { .file = "deck_source",
    .phrase = "h0",
    .make = make_source_without_spacing,
    .command = MESH },
  { .file = "deck_binary",
    .phrase = "deck_binary.deck",
    .make = make_deck_binary,
    .command = MESH },
  { .file = "through_itself",
    .phrase = "cannot bound a mesh",
    .make = make_unrepaired,
    .command = MESH },
  { .file = "common_edge",
    .phrase = "cannot bound a mesh",
    .make = make_unrepaired,
    .command = MESH },
  { .file = "one_sided",
    .phrase = "cannot bound a mesh",
    .make = make_unrepaired,
    .command = MESH },
  { .file = "line",
    .phrase = "no surface is left",
    .make = make_nothing,
    .command = MESH },
  { .file = "nothing_here",
    .phrase = "no project found",
    .make = make_nothing,
    .command = MESH },
  { .file = "deck_quote",
    .phrase = "quote",
    .make = make_quote,
    .command = MESH },
  { 0 }
};
