/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on sheets. Declared in run/report/report.h. */
#include "core/mesh/sheets.h"
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
