/* A program outside the project: builds the surface of a tetrahedron, checks
 * it, and asks for the spacing in it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "core/surface/surface_check.h"

static int make_surface(struct vg_mesh *m)
{
  const double point[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
                               { 0, 0, 1 } };
  const uint32_t tri[4][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 },
                               { 1, 3, 2 } };

  m->point = malloc(sizeof point);
  m->tri = malloc(sizeof tri);
  m->tri_patch = calloc(4, sizeof *m->tri_patch);
  if (!m->point || !m->tri || !m->tri_patch) return -1;
  memcpy(m->point, point, sizeof point);
  memcpy(m->tri, tri, sizeof tri);
  m->n_point = m->n_tri = 4;
  return vg_mesh_add_patch(m, 1, "wall") == SIZE_MAX ? -1 : 0;
}

int main(void)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_surface_check_options check = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report report = VG_SURFACE_REPORT_INIT;
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_error err = VG_ERROR_INIT;
  const double at[3] = { 0.2, 0.2, 0.2 };
  int bad = make_surface(&m);

  bad = bad || vg_surface_check(&m, &check, &report, &err) < 0 ||
        report.n_defect ||
        vg_sizing_new(&options, 0, NULL, &m, &sizing, &err) < 0 ||
        !(vg_sizing_at(sizing, at) > 0);
  printf("%s\n", bad ? err.text : "the library answers");
  vg_sizing_free(sizing);
  vg_surface_report_release(&report);
  vg_mesh_release(&m);
  return bad;
}
