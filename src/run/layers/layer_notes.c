/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Notes about the layers that are planned. Declared in run/layers/layers.h. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "layers/columns/growth_law.h"
#include "run/layers/layers.h"

#define SHOWN_PATCHES 20

/* L26: relative to the largest extent of the walls. On a flat plate of that
 * length, y+ 0.6 at a Reynolds number of 1e9 is 2e-8. */
#define HEIGHT_LEAST 2e-8
#define HEIGHT_MOST 0.02
#define LENGTH_LEAST 0.005
#define LENGTH_MOST 50.0
#define Y_PLUS_LEAST 0.01
#define Y_PLUS_MOST 500.0

/* Largest extent of the walls with layers along x, y or z. */
static double extent_of(const struct vg_layer_stage *s, const struct vg_mesh *m)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++) {
    if (!s->request[m->tri_patch[t]].is_wall) continue;
    for (int i = 0; i < 9; i++) {
      const double x = m->point[m->tri[t][i / 3]][i % 3];

      lo[i % 3] = fmin(lo[i % 3], x);
      hi[i % 3] = fmax(hi[i % 3], x);
    }
  }
  return fmax(hi[0] - lo[0], fmax(hi[1] - lo[1], hi[2] - lo[2]));
}

/* A wall whose first height is implausible; SIZE_MAX: none. */
static size_t implausible(const struct vg_layer_stage *s, double extent)
{
  for (size_t i = 0; i < s->n_patch; i++) {
    const double first = s->request[i].law.delta1;
    const double y_plus = s->reynolds > 0
                          ? vg_y_plus(first, s->reynolds, s->length)
                          : 1;

    if (!s->request[i].is_wall) continue;
    if (first < HEIGHT_LEAST * extent || first > HEIGHT_MOST * extent ||
        y_plus < Y_PLUS_LEAST || y_plus > Y_PLUS_MOST)
      return i;
  }
  return SIZE_MAX;
}

static void note_first(const struct vg_layer_stage *s, struct vg_boundary *b,
                       size_t i, double extent)
{
  const struct vg_patch *p = &b->surface.patch[i];
  const double first = s->request[i].law.delta1;

  if (s->reynolds > 0)
    vg_note(b->notes,
            "the first height %.3g of patch %d %s is %.2g times the extent of "
            "the walls, %.6g, and y+ %.3g at Reynolds number %g and reference "
            "length %g: are first height, reference length and surface in the "
            "same unit?",
            first, (int)p->id, p->name, first / extent, extent,
            vg_y_plus(first, s->reynolds, s->length), s->reynolds, s->length);
  else
    vg_note(b->notes,
            "the first height %.3g of patch %d %s is %.2g times the extent of "
            "the walls, %.6g: are both in the same unit?",
            first, (int)p->id, p->name, first / extent, extent);
}

static void note_length(const struct vg_layer_stage *s, struct vg_boundary *b,
                        double extent)
{
  vg_note(b->notes,
          "the reference length %g is %.2g times the extent of the walls, "
          "%.6g: is it in the unit of the surface? First heights and y+ "
          "follow from it",
          s->length, s->length / extent, extent);
}

/* The last note becomes the first. */
static void to_front(struct vg_notes *notes)
{
  char *last = notes->text[notes->n - 1];

  memmove(notes->text + 1, notes->text, (notes->n - 1) * sizeof *notes->text);
  notes->text[0] = last;
}

void vg_note_first_heights(const struct vg_layer_stage *s,
                           struct vg_boundary *b)
{
  assert(s->n_patch == b->surface.n_patch);

  const size_t n = b->notes->n;
  const double extent = extent_of(s, &b->surface);
  const size_t i = implausible(s, extent);

  if (s->length > 0 &&
      (s->length < LENGTH_LEAST * extent || s->length > LENGTH_MOST * extent))
    note_length(s, b, extent);
  else if (i != SIZE_MAX) note_first(s, b, i, extent);
  if (b->notes->n > n) to_front(b->notes);
}

/* Number of walls, and their numbers as " 3 4 7". `odd`: only those with a
 * condition that is not viscous. */
static size_t wall_numbers(const struct vg_layer_stage *s,
                           const struct vg_mesh *m, int odd, char *list,
                           size_t size)
{
  size_t n = 0, at = 0;

  *list = 0;
  for (size_t i = 0; i < s->n_patch; i++) {
    const struct vg_patch *p = &m->patch[i];

    if (s->reason[i] == VG_WALL_NOT || s->reason[i] == VG_WALL_EXTENDED ||
        (odd && (vg_is_viscous(p) || p->bc == VG_BC_NONE)))
      continue;
    if (n++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, size - at, " %d", (int)p->id);
  }
  if (n > SHOWN_PATCHES) snprintf(list + at, size - at, " ...");
  return n;
}

void vg_note_missing_first(const struct vg_layer_stage *s,
                           struct vg_boundary *b)
{
  char list[12 * SHOWN_PATCHES + 24];
  size_t n_wall = wall_numbers(s, &b->surface, 0, list, sizeof list);

  vg_note(b->notes,
          "no layers grow on %zu viscous wall%s (patch%s%s), because no first "
          "height is given: give --first, or --y-plus with --reynolds and "
          "--reference-length",
          n_wall, n_wall > 1 ? "s" : "", n_wall > 1 ? "es" : "", list);
}

/* Columns of a row of the table `layers` that have values, as "first, count".
 * out[size]. */
static void given_columns(const struct vg_layer_row *row, char *out,
                          size_t size)
{
  const struct vg_setting_table *t = vg_settings_table(VG_TABLE_LAYERS);
  struct vg_layer_row none;
  size_t at = 0;

  *out = 0;
  vg_settings_row_default(VG_TABLE_LAYERS, &none);
  for (size_t i = 0; i < t->n_column; i++) {
    const struct vg_param *p = &t->column[i];
    char value[2][2 * VG_LIST_MAX + 3];

    if (p->type == VG_PARAM_PATCH || p->type == VG_PARAM_WORD) continue;
    vg_param_format(p, row, value[0], sizeof value[0]);
    vg_param_format(p, &none, value[1], sizeof value[1]);
    if (strcmp(value[0], value[1]) == 0 || at >= size) continue;
    at += (size_t)snprintf(out + at, size - at, "%s%s", at ? ", " : "",
                           p->name);
  }
}

/* Rows of the table `layers` with values for patches without layers. */
static void note_idle_rows(const struct vg_layer_stage *s,
                           struct vg_boundary *b)
{
  const struct vg_settings *set = &b->read->settings;
  char list[SHOWN_PATCHES * (VG_NAME_MAX + 120)] = "", given[100];
  size_t n = 0, at = 0;

  for (size_t i = 0; i < set->n_layer; i++) {
    const struct vg_layer_row *row = &set->layer_row[i];
    const size_t p = vg_mesh_find_patch(&b->surface, row->id);

    if (p == SIZE_MAX || s->reason[p] != VG_WALL_NOT ||
        row->grow == VG_ANSWER_NO)
      continue;
    given_columns(row, given, sizeof given);
    if (*given && n++ < SHOWN_PATCHES)
      at += (size_t)snprintf(list + at, sizeof list - at, "%s%d %s (%s)",
                             n > 1 ? ", " : "", (int)row->id,
                             b->surface.patch[p].name, given);
  }
  if (n)
    vg_note(b->notes,
            "table layers: no layers grow on patch%s %s%s, so that these "
            "columns have no effect: set the column grow to yes, or name the "
            "patch%s in walls",
            n > 1 ? "es" : "", list, n > SHOWN_PATCHES ? ", ..." : "",
            n > 1 ? "es" : "");
}

void vg_note_layers(const struct vg_layer_stage *s, struct vg_boundary *b)
{
  const struct vg_layer_settings *l = &b->read->settings.layer;
  double ratio = isnan(l->ratio) ? 0 : l->ratio, cap = vg_layer_cap(l->cap);
  char list[12 * SHOWN_PATCHES + 24];
  size_t n = 0, n_odd = wall_numbers(s, &b->surface, 1, list, sizeof list);

  for (size_t i = 0; i < s->n_patch; i++) n += s->reason[i] == VG_WALL_BODY;
  note_idle_rows(s, b);
  if (n_odd)
    vg_note(b->notes,
            "%zu patch%s layers but a boundary condition that is not viscous: "
            "number%s",
            n_odd, n_odd > 1 ? "es have" : " has", list);
  if (n && b->flow.kind == VG_FLOW_INTERNAL)
    vg_note(b->notes,
            "no patch has a boundary condition: layers grow on %zu of %zu "
            "patches, but not on inlets, outlets, caps and outer boundaries "
            "around bodies; name the walls with --walls, --slip or the table "
            "layers if that is wrong",
            n, s->n_patch);
  else if (n)
    vg_note(b->notes, "no patch has a boundary condition: layers grow on the "
                      "whole body; name the walls with --walls, --slip or the "
                      "table layers if that is wrong");
  if (!l->by_source && l->y_plus > 0)
    vg_note(b->notes,
            "y+ %g at Reynolds number %g, based on the length %g: first "
            "height %.6g",
            l->y_plus, l->reynolds, l->length,
            vg_first_height(l->y_plus, l->reynolds, l->length));
  if (!*l->first_from && (*l->first_field || l->first_scale > 0))
    vg_note(b->notes, "first_field and first_scale have no effect without "
                      "first_from");
  if (l->scale_rule != VG_GROWTH_LAW_KEPT)
    vg_note(b->notes,
            "scale_layers: first heights are multiplied by %.4g, growth "
            "ratios of the layers are raised to the power %.4g, numbers of "
            "layers are divided by that power, and numbers of constant layers "
            "are divided by %.4g",
            b->read->settings.scale,
            vg_growth_law_power((enum vg_growth_law_rule)l->scale_rule,
                                b->read->settings.scale),
            b->read->settings.scale);
  if (ratio > cap)
    vg_note(b->notes,
            "ratio %g is larger than layer_cap %g, so the growth is "
            "limited to layer_cap",
            ratio, cap);
}
