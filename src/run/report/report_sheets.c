/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on sheets and zones. Declared in run/report/report.h. */
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"
#include "run/common/text.h"
#include "run/report/report.h"

void vg_report_sheets_text(FILE *to, const struct vg_mesh *m,
                           const struct vg_sheet_report *r)
{
  char name[VG_NAME_MAX];

  if (!m->n_sheet || !r) return;
  fprintf(to, "  %8s %13s %13s %13s %10s  %s\n", "sheet", "triangles",
          "cells before", "cells behind", "area", "name");
  for (size_t i = 0; i < m->n_sheet && i < VG_SHOWN_PATCHES; i++) {
    char n[3][32];

    fprintf(to, "  %8d %13s %13s %13s %10.4g  %s\n", (int)m->sheet[i].id,
            vg_text_count((size_t)r[i].n_tri, n[0]),
            vg_text_count((size_t)r[i].n_cell[0], n[1]),
            vg_text_count((size_t)r[i].n_cell[1], n[2]), r[i].area,
            vg_text_clean(m->sheet[i].name, name, sizeof name));
    if (r[i].n_bad)
      fprintf(to, "    triangles that are not between two cells: %llu\n",
              (unsigned long long)r[i].n_bad);
  }
  if (m->n_sheet > VG_SHOWN_PATCHES)
    fprintf(to, "  ... and %zu more sheets\n", m->n_sheet - VG_SHOWN_PATCHES);
}

json_t *vg_report_sheets_json(const struct vg_mesh *m,
                              const struct vg_sheet_report *r)
{
  json_t *list = json_array();

  for (size_t i = 0; r && i < m->n_sheet; i++)
    json_array_append_new(list,
                          json_pack("{s:i s:o s:I s:I s:I s:I s:f}", "id",
                                    (int)m->sheet[i].id, "name",
                                    vg_text_json(m->sheet[i].name), "triangles",
                                    (json_int_t)r[i].n_tri, "cells_before",
                                    (json_int_t)r[i].n_cell[0], "cells_behind",
                                    (json_int_t)r[i].n_cell[1], "bad_triangles",
                                    (json_int_t)r[i].n_bad, "area", r[i].area));
  return list;
}

void vg_report_zones_text(FILE *to, const struct vg_mesh *m,
                          const struct vg_zone_report *r)
{
  char name[VG_NAME_MAX], n[32];

  if (!m->n_zone || !r) return;
  fprintf(to, "  %8s %-8s %13s %13s %10s  %s\n", "zone", "kind", "cells",
          "volume", "angle", "name");
  for (size_t i = 0; i < m->n_zone && i < VG_SHOWN_PATCHES; i++)
    fprintf(to, "  %8d %-8s %13s %13.6g %10.2f  %s\n", (int)m->zone[i].id,
            vg_zone_kind_word[m->zone[i].kind],
            vg_text_count((size_t)r[i].n_cell, n), r[i].volume, r[i].angle_min,
            vg_text_clean(m->zone[i].name, name, sizeof name));
  if (m->n_zone > VG_SHOWN_PATCHES)
    fprintf(to, "  ... and %zu more zones\n", m->n_zone - VG_SHOWN_PATCHES);
}

json_t *vg_report_zones_json(const struct vg_mesh *m,
                             const struct vg_zone_report *r)
{
  json_t *list = json_array();

  for (size_t i = 0; r && i < m->n_zone; i++)
    json_array_append_new(
      list, json_pack("{s:i s:o s:s s:I s:f s:f s:f s:f}", "id",
                      (int)m->zone[i].id, "name", vg_text_json(m->zone[i].name),
                      "kind", vg_zone_kind_word[m->zone[i].kind], "cells",
                      (json_int_t)r[i].n_cell, "volume", r[i].volume,
                      "angle_min", r[i].angle_min, "edge_mean", r[i].edge_mean,
                      "edge_max", r[i].edge_max));
  return list;
}
