/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writer of the run deck. Declared in run/settings/deck.h; grammar in
 * docs/reference/deck.md. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/stream.h"
#include "io/vgrid/mapbc.h"
#include "run/settings/deck.h"

#define CELL_SIZE (2 * VG_LIST_MAX + 4)
#define LINE_WIDTH 78
#define NAME_WIDTH 18 /* the longest name and two blanks */

static void pad(struct vg_output *out, const char *text, size_t width)
{
  vg_output_text(out, text);
  for (size_t n = strlen(text); n < width; n++) vg_output_text(out, " ");
}

/* Write "[length, default 0]" or "[length, required]". */
static void value_note(const struct vg_param *p, const void *defaults,
                       char *text, size_t size)
{
  char value[CELL_SIZE] = "";

  if (!p->required) vg_param_format(p, defaults, value, sizeof value);
  snprintf(text, size, "[%s%s%s%s]", p->unit, *p->unit ? ", " : "",
           p->required ? "required" : "default ", value);
}

/* Write "# name     help [unit, default]", with continuation lines aligned
 * under the help. */
static void explain_param(struct vg_output *out, const struct vg_param *p,
                          const void *defaults)
{
  char text[1024], note[CELL_SIZE + 64];
  size_t used = 2 + NAME_WIDTH;
  char *save = NULL;

  value_note(p, defaults, note, sizeof note);
  snprintf(text, sizeof text, "%s %s", p->help, note);
  vg_output_text(out, "# ");
  pad(out, p->name, NAME_WIDTH);
  for (char *w = strtok_r(text, " ", &save); w;
       w = strtok_r(NULL, " ", &save)) {
    if (used + strlen(w) > LINE_WIDTH) {
      vg_output_text(out, "\n# ");
      pad(out, "", NAME_WIDTH);
      used = 2 + NAME_WIDTH;
    }
    if (used > 2 + NAME_WIDTH) vg_output_text(out, " "), used++;
    vg_output_text(out, w);
    used += strlen(w);
  }
  vg_output_text(out, "\n");
}

static int is_default(const struct vg_param *p, const void *row,
                      const void *defaults)
{
  char a[CELL_SIZE], b[CELL_SIZE];

  vg_param_format(p, row, a, sizeof a);
  vg_param_format(p, defaults, b, sizeof b);
  return strcmp(a, b) == 0;
}

static int is_default_row(const struct vg_setting_table *t, const void *row,
                          const void *defaults)
{
  for (size_t c = 0; c < t->n_column; c++)
    if (!is_default(&t->column[c], row, defaults)) return 0;
  return 1;
}

/* Write the names of the n settings in p above their values, in columns. */
static void write_block(struct vg_output *out, const struct vg_param *const *p,
                        size_t n, const struct vg_settings *s)
{
  for (int line = 0; line < 2; line++) {
    for (size_t i = 0; i < n; i++) {
      char value[CELL_SIZE];
      size_t width = strlen(p[i]->name);

      vg_param_format(p[i], s, value, sizeof value);
      if (strlen(value) > width) width = strlen(value);
      pad(out, line ? value : p[i]->name, i + 1 < n ? width + 2 : 0);
    }
    vg_output_text(out, "\n");
  }
  vg_output_text(out, "\n");
}

static void write_params(struct vg_output *out, const struct vg_settings *s,
                         const struct vg_settings *defaults,
                         enum vg_deck_form form)
{
  enum { PER_BLOCK = 6 };
  const struct vg_param *block[PER_BLOCK];
  size_t n, n_block = 0;
  const struct vg_param *p = vg_settings_params(&n);

  for (size_t i = 0; i < n; i++) {
    if (form != VG_DECK_CHANGED || !is_default(&p[i], s, defaults))
      block[n_block++] = &p[i];
    if (n_block < PER_BLOCK && (i + 1 < n || !n_block)) continue;
    for (size_t k = 0; form == VG_DECK_EXPLAINED && k < n_block; k++)
      explain_param(out, block[k], defaults);
    write_block(out, block, n_block, s);
    n_block = 0;
  }
}

/* Widths of the columns that are written; 0: the column is omitted, since all
 * its values are defaults. */
static void column_widths(const struct vg_setting_table *t,
                          enum vg_table_kind kind, const struct vg_settings *s,
                          const void *defaults, enum vg_deck_form form,
                          size_t *width)
{
  char value[CELL_SIZE];
  size_t n = vg_settings_rows(s, kind);

  for (size_t c = 0; c < t->n_column; c++) {
    const struct vg_param *p = &t->column[c];
    int used = p->required || kind == VG_TABLE_PATCHES ||
               (kind == VG_TABLE_FARFIELD && form != VG_DECK_CHANGED);

    width[c] = strlen(p->name);
    for (size_t i = 0; i < n; i++) {
      const void *row = vg_settings_row(s, kind, i);

      used |= !is_default(p, row, defaults);
      vg_param_format(p, row, value, sizeof value);
      if (strlen(value) > width[c]) width[c] = strlen(value);
    }
    if (!used) width[c] = 0;
  }
}

/* Commented examples, written if a table is empty. */
static const char *const example[VG_TABLE_N] = {
  [VG_TABLE_FARFIELD] = "",
  [VG_TABLE_PATCHES] = "#\n# patches\n# id  bc  name\n# 1   4   wing\n\n",
  [VG_TABLE_LAYERS] = "#\n# layers\n# id  grow  first  min_full\n"
                      "# 1   yes   1e-5   98\n\n",
  [VG_TABLE_SURFACE] = "#\n# surface\n# patch  adjacent  size\n"
                       "# 1      2       0.01\n\n",
  [VG_TABLE_WAKES] = "#\n# wakes\n# patch  length  alpha\n"
                     "# *      2       0,4\n\n",
  [VG_TABLE_ZONES] = "#\n# zones\n# name   x  y  z  kind      hmax\n"
                     "# rotor  0  0  0  rotating  0.01\n\n",
  [VG_TABLE_PERIODIC] = "#\n# periodic\n# patch  image\n# lo     hi\n\n",
  [VG_TABLE_SOURCES] = "#\n# sources\n# kind   x0  y0  z0  r0  h0\n"
                       "# point  0   0   0   0   0.01\n\n",
  [VG_TABLE_SWEEP] = "#\n# sweep\n# ranks  threads  leaf_cells\n"
                     "# 1,2    1:4:x2   100000,300000\n\n",
  [VG_TABLE_ADAPT] = "#\n# adapt\n# solver       field  cycles  cells\n"
                     "# \"./run.sh\"  p,Ma   4       500000\n\n",
};

static void write_table(struct vg_output *out, const struct vg_settings *s,
                        enum vg_table_kind kind, enum vg_deck_form form)
{
  const int explain = form == VG_DECK_EXPLAINED;
  const struct vg_setting_table *t = vg_settings_table(kind);
  union {
    struct vg_farfield_row f;
    struct vg_patch_row p;
    struct vg_layer_row l;
    struct vg_surface_row u;
    struct vg_wake_row k;
    struct vg_zone_row z;
    struct vg_periodic_row o;
    struct vg_source s;
    struct vg_sweep_row w;
    struct vg_adapt_row a;
  } defaults;
  char value[CELL_SIZE];
  size_t width[64] = { 0 }, n = vg_settings_rows(s, kind);

  vg_settings_row_default(kind, &defaults);
  if (explain) {
    vg_output_format(out, "# Table %s. %s\n", t->name, t->help);
    for (size_t c = 0; c < t->n_column; c++)
      explain_param(out, &t->column[c], &defaults);
  }
  if (!n) {
    if (explain) vg_output_text(out, example[kind]);
    return;
  }
  column_widths(t, kind, s, &defaults, form, width);
  if (kind == VG_TABLE_FARFIELD && form == VG_DECK_CHANGED &&
      is_default_row(t, &s->farfield, &defaults))
    return;
  vg_output_format(out, "%s\n", t->name);
  for (size_t i = 0; i <= n; i++) {
    size_t gap = 0;

    for (size_t c = 0; c < t->n_column; c++) {
      if (!width[c]) continue;
      if (i)
        vg_param_format(&t->column[c], vg_settings_row(s, kind, i - 1), value,
                        sizeof value);
      pad(out, "", gap);
      vg_output_text(out, i ? value : t->column[c].name);
      gap = width[c] + 2 - strlen(i ? value : t->column[c].name);
    }
    vg_output_text(out, "\n");
  }
  vg_output_text(out, "\n");
}

vg_status vg_deck_write(const char *path, const struct vg_settings *s,
                        const char *comment, enum vg_deck_form form,
                        struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_settings defaults;
  vg_status st = vg_output_open(path, &out, err);

  if (st < 0) return st;
  vg_settings_default(&defaults);
  vg_output_format(&out, "%s\n", s->title);
  if (comment) vg_output_text(&out, comment);
  if (form == VG_DECK_CHANGED)
    vg_output_text(&out, "# All other settings have their defaults, which "
                         "'vanguard deck' lists.\n");
  if (form == VG_DECK_EXPLAINED)
    vg_output_text(
      &out,
      "# Each line of names is followed by a line of values, in any order.\n"
      "# A table consists of its name, a line of column names and lines of\n"
      "# values up to a blank line. Lengths are in the unit of the surface.\n");
  vg_output_text(&out, "\n");
  write_params(&out, s, &defaults, form);
  for (int t = 0; t < VG_TABLE_N; t++)
    write_table(&out, s, (enum vg_table_kind)t, form);
  st = vg_output_commit(&out, err);
  vg_output_release(&out);
  return st;
}

/* The code from which the codes of both solvers follow: USM3D's if FUN3D's is
 * its translation, else FUN3D's if it is more specific (4100 than 4). */
static int32_t defining_code(const struct vg_patch *p, int axis)
{
  if (p->bc == VG_BC_NONE) return p->bc_fun3d;
  if (p->bc_fun3d == vg_bc_to_fun3d(p->bc, axis)) return p->bc;
  if (p->bc_fun3d != VG_BC_NONE && vg_bc_to_usm3d(p->bc_fun3d) == p->bc)
    return p->bc_fun3d;
  return p->bc;
}

vg_status vg_deck_patches_of(const struct vg_mesh *m, struct vg_settings *s,
                             struct vg_error *err)
{
  int *axis = vg_alloc(m->n_patch, sizeof *axis);
  vg_status st = axis ? vg_patch_axes(m, axis, err)
                      : vg_fail_memory(err, "the patches");

  for (size_t i = 0; i < m->n_patch && st >= 0; i++) {
    struct vg_patch_row row = { .id = m->patch[i].id,
                                .bc = defining_code(&m->patch[i], axis[i]) };

    if (m->patch[i].inner == VG_INNER_BACK) continue; /* not in the input */
    snprintf(row.name, sizeof row.name, "%s", m->patch[i].name);
    st = vg_settings_add(s, VG_TABLE_PATCHES, &row, err);
  }
  free(axis);
  return st;
}
