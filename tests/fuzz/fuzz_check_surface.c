/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "core/surface/surface_check.h"
#include "io/mesh/tri.h"

/* If the check offers a tolerance for coincident rims, welding with it closes
 * edges. */
static void weld(struct vg_mesh *m, const struct vg_surface_report *r,
                 struct vg_error *err)
{
  size_t n_edge = 0, n_welded = 0;
  double gap = -1;

  fuzz_expect(vg_surface_rim_gap(m, r, &gap, &n_edge, err) == VG_OK &&
                gap >= 0 && n_edge <= r->count[VG_DEFECT_OPEN_EDGE] &&
                (gap > 0) == (n_edge > 0),
              "there is a gap exactly if there are edges");
  if (gap > 0) {
    fuzz_expect(vg_surface_weld_rims(m, gap, NULL, &n_welded, err) == VG_OK,
                "a surface can be welded");
    fuzz_expect(n_welded > 0, "the offered tolerance welds edges");
  }
}

/* The steps after reading a surface: the check with repair, the text of every
 * defect, and rims that can be welded. */
static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  char text[512];
  vg_status st = vg_tri_parse(in, m, err);

  if (st < 0) return st;
  o.external = m->n_tri & 1;
  st = vg_surface_check(m, &o, &r, err);
  fuzz_expect(st == VG_OK, "a surface can be checked");
  for (size_t i = 0; i < r.n_defect; i++)
    vg_defect_text(m, &r.defect[i], text, sizeof text);
  weld(m, &r, err);
  vg_surface_report_release(&r);
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
