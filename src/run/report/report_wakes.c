/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on cells across wakes. Declared in run/report/report.h. */
#include <math.h>

#include "run/common/text.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"
#include "run/settings/wake_table.h"

static const double chords[VG_WAKE_STATIONS] = VG_WAKE_STATION_CHORDS;

struct vg_wake_count vg_report_wake_count(size_t n,
                                          const struct vg_wake_probe *probe,
                                          size_t wake, size_t station)
{
  struct vg_wake_count c = { chords[station], 0, 0, NAN, NAN, NAN, NAN };
  double asked = 0, got = 0, least = INFINITY, stretch = 0;

  for (size_t i = 0; i < n; i++) {
    if (probe[i].wake != wake || probe[i].station != station) continue;
    c.n_line++;
    asked += probe[i].asked;
    if (isnan(probe[i].got)) continue;
    c.n_measured++;
    got += probe[i].got;
    stretch += probe[i].stretch;
    least = fmin(least, probe[i].got);
  }
  if (c.n_line) c.asked = asked / (double)c.n_line;
  if (!c.n_measured) return c;
  c.mean = got / (double)c.n_measured;
  c.least = least;
  c.stretch = stretch / (double)c.n_measured;
  return c;
}

static void wake_name(const struct vg_wake_row *row, char *name, size_t size)
{
  vg_param_format(&vg_wake_table.column[0], row, name, size);
}

void vg_report_wakes_text(FILE *to, const struct vg_read_wakes *w, size_t n,
                          const struct vg_wake_probe *probe)
{
  char name[2 * VG_NAME_MAX + 4], clean[2 * VG_NAME_MAX + 4];

  if (!n) return;
  fprintf(to, "\nWakes\n  %4s %7s %10s %13s %9s %9s %9s  %s\n", "wake",
          "chords", "requested", "reached mean", "least", "stretch", "measured",
          "patch");
  for (size_t i = 0; i < w->n; i++) {
    wake_name(&w->row[i], name, sizeof name);
    for (size_t k = 0; k < VG_WAKE_STATIONS; k++) {
      const struct vg_wake_count c = vg_report_wake_count(n, probe, i, k);

      if (!c.n_line) continue;
      fprintf(to, "  %4zu %7.3g %10.1f ", i + 1, c.chords, c.asked);
      if (c.n_measured)
        fprintf(to, "%13.1f %9.1f %9.1f", c.mean, c.least, c.stretch);
      else fprintf(to, "%13s %9s %9s", "-", "-", "-");
      fprintf(to, " %4zu/%-4zu  %s\n", c.n_measured, c.n_line,
              vg_text_clean(name, clean, sizeof clean));
    }
  }
}

json_t *vg_report_wakes_json(const struct vg_read_wakes *w, size_t n,
                             const struct vg_wake_probe *probe)
{
  json_t *list = json_array();
  char name[2 * VG_NAME_MAX + 4];

  for (size_t i = 0; i < w->n; i++) {
    json_t *o = json_object(), *counts = json_array();

    wake_name(&w->row[i], name, sizeof name);
    json_object_set_new(o, "wake", vg_json_count(i + 1));
    json_object_set_new(o, "patch", vg_text_json(name));
    json_object_set_new(o, "kind", json_string(vg_wake_kind_word(&w->row[i])));
    for (size_t k = 0; k < VG_WAKE_STATIONS; k++) {
      const struct vg_wake_count c = vg_report_wake_count(n, probe, i, k);
      json_t *at = json_object();

      json_object_set_new(at, "chords", json_real(c.chords));
      json_object_set_new(at, "lines", vg_json_count(c.n_line));
      json_object_set_new(at, "lines_measured", vg_json_count(c.n_measured));
      json_object_set_new(at, "requested", vg_json_real(c.asked));
      json_object_set_new(at, "reached_mean", vg_json_real(c.mean));
      json_object_set_new(at, "reached_least", vg_json_real(c.least));
      json_object_set_new(at, "stretch_requested",
                          json_real(w->row[i].stretch));
      json_object_set_new(at, "stretch_reached", vg_json_real(c.stretch));
      json_array_append_new(counts, at);
    }
    json_object_set_new(o, "cells_across", counts);
    json_array_append_new(list, o);
  }
  return list;
}
