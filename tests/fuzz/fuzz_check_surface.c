#include "fuzz.h"

#include "core/surface/surface_check.h"
#include "io/mesh/tri.h"

/* What follows reading a surface: the check with repair, and the text of
 * every defect. */
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
  vg_surface_report_release(&r);
  return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
