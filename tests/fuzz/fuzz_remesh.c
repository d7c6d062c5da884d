/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include <math.h>

#include "core/remesh/remesh.h"
#include "core/surface/surface_check.h"
#include "io/mesh/tri.h"

#define LARGE 400 /* triangles; more take too long for a fuzzer */

static int is_sound(struct vg_mesh *m, int repair)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  int sound;

  o.repair = repair;
  o.external = 1;
  sound = vg_surface_check(m, &o, &r, &err) == VG_OK &&
          r.n_defect == r.count[VG_DEFECT_OPEN_EDGE] + r.count[VG_DEFECT_SHELL];
  vg_surface_report_release(&r);
  return sound;
}

/* Stretch some edges, by the same factor on both sides. */
static void stretch_some(const struct vg_mesh *m, double *stretch)
{
  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    const uint32_t a = m->tri[i / 3][i % 3], b = m->tri[i / 3][(i % 3 + 1) % 3];

    stretch[i] = (a + b) % 3 ? 0 : 1 + (a + b) % 19;
  }
}

/* A surface that passes the check is remeshed, or refused with a message; the
 * remeshed surface passes the check again. */
static vg_status parse(struct vg_input *in, struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  double lo[3], hi[3], length = 0, stretch[3 * LARGE];
  vg_status st = vg_tri_parse(in, m, err);

  if (st < 0 || !m->n_tri || m->n_tri > LARGE || !is_sound(m, 1)) return st;
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) length = fmax(length, hi[k] - lo[k]);
  o.h_max = length / 4;
  o.h_min = length / 40;
  o.tolerance = length / 100;
  if (m->n_tri % 2) {
    stretch_some(m, stretch);
    o.stretch = stretch;
  }
  if (vg_remesh(m, &o, NULL, err) < 0)
    fuzz_expect(err->text[0], "a failure has a message");
  fuzz_expect(is_sound(m, 0), "a remeshed surface is valid");
  return VG_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  fuzz_mesh(parse, data, size);
  return 0;
}
