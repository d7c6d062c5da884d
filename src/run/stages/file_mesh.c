/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/stages/file_mesh.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/format.h"

/* The whole mesh is one slice, whose points have their numbers in the mesh. */
static vg_status get_all(const struct vg_slices *s, size_t i,
                         struct vg_slice *out, struct vg_error *err)
{
  const struct vg_file_mesh *f = s->user;
  const struct vg_mesh *m = &f->mesh;

  (void)i, (void)err;
  memset(out, 0, sizeof *out);
  out->n_point = out->n_own = m->n_point;
  out->x = (const double(*)[3])m->point;
  out->id = out->own = f->identity;
  out->n_cell[VG_SLICE_TET] = m->n_tet;
  out->n_cell[VG_SLICE_PYR] = m->n_pyr;
  out->n_cell[VG_SLICE_PRI] = m->n_pri;
  out->n_cell[VG_SLICE_HEX] = m->n_hex;
  out->cell[VG_SLICE_TET] = (const uint32_t *)m->tet;
  out->cell[VG_SLICE_PYR] = (const uint32_t *)m->pyr;
  out->cell[VG_SLICE_PRI] = (const uint32_t *)m->pri;
  out->cell[VG_SLICE_HEX] = (const uint32_t *)m->hex;
  return VG_OK;
}

static void put_all(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s, (void)slice;
}

/* Number of boundary points if they come first, otherwise 0. */
static size_t leading_boundary(const struct vg_mesh *m, uint8_t *on)
{
  size_t n = 0, end = 0;

  for (size_t i = 0; i < 3 * m->n_tri; i++) on[m->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < 4 * m->n_quad; i++) on[m->quad[i / 4][i % 4]] = 1;
  for (size_t p = 0; p < m->n_point; p++) {
    n += on[p];
    if (on[p]) end = p + 1;
  }
  return n == end ? n : 0;
}

static vg_status serve(struct vg_file_mesh *f, struct vg_error *err)
{
  const struct vg_mesh *m = &f->mesh;
  uint8_t *on = vg_calloc(m->n_point, 1);

  f->identity = vg_alloc(m->n_point, sizeof *f->identity);
  if (!on || !f->identity) {
    free(on);
    return vg_fail_memory(err, "the mesh");
  }
  for (size_t p = 0; p < m->n_point; p++) f->identity[p] = (uint32_t)p;
  f->slices = (struct vg_slices){ .n_point = m->n_point,
                                  .n_cell = { m->n_tet, m->n_pyr, m->n_pri,
                                              m->n_hex },
                                  .n_boundary_point = leading_boundary(m, on),
                                  .boundary = m,
                                  .n_slice = 1,
                                  .n_served = vg_mesh_n_cell(m),
                                  .get = get_all,
                                  .put = put_all,
                                  .user = f };
  free(on);
  return VG_OK;
}

vg_status vg_file_mesh_read(const char *file, const char *mapbc,
                            struct vg_file_mesh *out, struct vg_notes *notes,
                            struct vg_error *err)
{
  struct vg_read_info info = { .mapbc = mapbc };
  vg_status st;

  assert(file && out && !out->identity && notes);
  VG_TRY(vg_mesh_read(file, &out->mesh, &info, err));
  if (!info.n_cell)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: this is a surface, which has no cells", file);
  out->n_turned = info.turned.cell;
  if (info.turned.cell)
    vg_note(notes, "%s: %zu cells of negative volume were mirrored", file,
            info.turned.cell);
  if (info.turned.face)
    vg_note(notes,
            "%s: %zu boundary faces pointed out of their cells; their "
            "orientation was reversed",
            file, info.turned.face);
  VG_TRY(serve(out, err));
  st = vg_mesh_judge(&out->mesh, NULL, &out->judge, err);
done:
  return st;
}

void vg_file_mesh_release(struct vg_file_mesh *f)
{
  vg_mesh_release(&f->mesh);
  free(f->identity);
  memset(f, 0, sizeof *f);
}
