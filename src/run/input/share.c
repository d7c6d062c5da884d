#include "run/input/share.h"

#include "base/bytes.h"

struct head { uint64_t n_point, n_tri, n_patch, number; };

vg_status vg_surface_pack(const struct vg_mesh *m, uint64_t number,
                          struct vg_bytes *out, struct vg_error *err)
{
  struct head h = { m->n_point, m->n_tri, m->n_patch, number };
  struct vg_writer w = { { 0, NULL }, 0, 0 };

  w.refused = vg_reserve(&w.bytes.data, &w.cap, sizeof h +
                         m->n_point * sizeof *m->point +
                         m->n_tri * (sizeof *m->tri + sizeof *m->tri_patch) +
                         m->n_patch * sizeof *m->patch, 1) != 0;
  vg_put(&w, 1, sizeof h, &h);
  vg_put(&w, m->n_point, sizeof *m->point, m->point);
  vg_put(&w, m->n_tri, sizeof *m->tri, m->tri);
  vg_put(&w, m->n_tri, sizeof *m->tri_patch, m->tri_patch);
  vg_put(&w, m->n_patch, sizeof *m->patch, m->patch);
  if (w.refused) {
    free(w.bytes.data);
    return vg_fail_memory(err, "the surface as bytes");
  }
  *out = w.bytes;
  return VG_OK;
}

static int is_sound(const struct vg_mesh *m)
{
  int good = 1;

  for (size_t i = 0; i < m->n_tri; i++) {
    for (int k = 0; k < 3; k++) good &= m->tri[i][k] < m->n_point;
    good &= m->tri_patch[i] < m->n_patch;
  }
  for (size_t i = 0; i < m->n_patch; i++)
    good &= memchr(m->patch[i].name, 0, VG_NAME_MAX) != NULL;
  return good;
}

vg_status vg_surface_unpack(const struct vg_bytes *bytes, struct vg_mesh *m,
                            uint64_t *number, struct vg_error *err)
{
  struct vg_reader r = { bytes->data, bytes->n, 0, 0 };
  struct vg_mesh got = VG_MESH_INIT;
  struct head h = { 0 };

  vg_get(&r, 1, sizeof h, &h);
  got.n_point = h.n_point;
  got.n_tri = h.n_tri;
  got.n_patch = h.n_patch;
  got.point = vg_get_array(&r, h.n_point, sizeof *got.point);
  got.tri = vg_get_array(&r, h.n_tri, sizeof *got.tri);
  got.tri_patch = vg_get_array(&r, h.n_tri, sizeof *got.tri_patch);
  got.patch = vg_get_array(&r, h.n_patch, sizeof *got.patch);
  if (r.bad || r.at != r.n || !is_sound(&got)) {
    vg_mesh_release(&got);
    return vg_fail(err, VG_ERR_FORMAT, "%zu bytes are no surface, or memory "
                   "is short; run again", bytes->n);
  }
  *number = h.number;
  vg_mesh_move(m, &got);
  return VG_OK;
}
