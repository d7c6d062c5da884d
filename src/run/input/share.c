/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/share.h"

#include <assert.h>
#include <string.h>

#include "base/bytes.h"

struct head {
  uint64_t n_point, n_tri, n_patch, number;
};

/* --- shared memory -------------------------------------------------------- */

enum { N_PART = 5 };

static void list_parts(const struct head *h, const struct vg_mesh *m,
                       struct vg_bytes part[N_PART])
{
  const struct vg_bytes list[N_PART] = {
    { sizeof *h, (unsigned char *)(uintptr_t)h },
    { h->n_point * sizeof *m->point, (unsigned char *)m->point },
    { h->n_tri * sizeof *m->tri, (unsigned char *)m->tri },
    { h->n_tri * sizeof *m->tri_patch, (unsigned char *)m->tri_patch },
    { h->n_patch * sizeof *m->patch, (unsigned char *)m->patch }
  };

  memcpy(part, list, sizeof list);
}

vg_status vg_surface_share(struct vg_comm *c, struct vg_mesh *m,
                           uint64_t *number, struct vg_shmem *common,
                           struct vg_error *err)
{
  struct head h = { m->n_point, m->n_tri, m->n_patch, *number };
  struct vg_bytes part[N_PART];
  unsigned char *at[N_PART];
  vg_status st;

  assert(number && common);
  if (vg_comm_node_size(c) == 1) return VG_OK;
  list_parts(&h, m, part);
  st = vg_comm_node_shmem(c, N_PART, part, common, err);
  if (st < 0) return st;
  at[0] = (unsigned char *)(uintptr_t)common->data;
  memcpy(&h, at[0], sizeof h);
  list_parts(&h, m, part);
  for (int i = 1; i < N_PART; i++)
    at[i] = at[i - 1] + vg_shmem_padded(part[i - 1].n);
  vg_mesh_release(m);
  *number = h.number;
  m->n_point = h.n_point;
  m->n_tri = h.n_tri;
  m->n_patch = h.n_patch;
  m->point = (void *)at[1];
  m->tri = (void *)at[2];
  m->tri_patch = (void *)at[3];
  m->patch = (void *)at[4];
  return st;
}

/* --- conversion to bytes ------------------------------------------------- */

vg_status vg_surface_pack(const struct vg_mesh *m, uint64_t number,
                          struct vg_bytes *out, struct vg_error *err)
{
  struct head h = { m->n_point, m->n_tri, m->n_patch, number };
  struct vg_writer w = { { 0, NULL }, 0, 0 };

  w.refused = vg_reserve(&w.bytes.data, &w.cap,
                         sizeof h + m->n_point * sizeof *m->point +
                           m->n_tri * (sizeof *m->tri + sizeof *m->tri_patch) +
                           m->n_patch * sizeof *m->patch,
                         1) != 0;
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
    return vg_fail(err, VG_ERR_FORMAT,
                   "the %zu bytes received are not a valid surface, or memory "
                   "is short; run again",
                   bytes->n);
  }
  *number = h.number;
  vg_mesh_move(m, &got);
  return VG_OK;
}

vg_status vg_surface_bcast(struct vg_comm *c, int takes, vg_status st,
                           struct vg_mesh *m, struct vg_error *err)
{
  struct vg_bytes b = { 0, NULL };
  uint64_t number;

  if (st >= 0 && !vg_comm_rank(c)) st = vg_surface_pack(m, 0, &b, err);
  VG_TRY(vg_comm_agree(c, st, err));
  VG_TRY(vg_comm_bcast(c, 0, &b, err));
  if (vg_comm_rank(c) && takes) st = vg_surface_unpack(&b, m, &number, err);
  st = vg_comm_agree(c, st, err);
done:
  free(b.data);
  return st;
}
