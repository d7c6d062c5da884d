#include <string.h>

#include "io/slices_parts.h"

#define BLOCK 3840 /* a multiple of 3, 4, 5 and 6 */

struct ugrid {
  struct vg_ugrid_kind kind;
  struct vg_mesh mesh;       /* the frame */
  uint64_t count[7];
  const size_t *n_layer_tet; /* NULL: no tail */
};

static void put_frame(const void *of, struct vg_output *out)
{
  const struct ugrid *u = of;

  vg_ugrid_put(out, &u->kind, &u->mesh, u->n_layer_tet);
}

static void put_points(const struct ugrid *u, const struct vg_slice *slice,
                       struct vg_output *out)
{
  double x[BLOCK / 3][3];

  vg_ugrid_seek(out, &u->kind, u->count, 0, slice->point_at);
  for (size_t k = 0, n; k < slice->n_own; k += n) {
    n = slice->n_own - k < BLOCK / 3 ? slice->n_own - k : BLOCK / 3;
    vg_slice_points(slice, k, n, x);
    vg_ugrid_put_points(out, &u->kind, n, (const double (*)[3])x);
  }
}

static void put_cells(const struct ugrid *u, const struct vg_slice *slice,
                      int kind, size_t width, struct vg_output *out)
{
  const uint32_t *node = slice->cell[kind];
  size_t n = width * slice->n_cell[kind];
  uint32_t block[BLOCK];

  vg_ugrid_seek(out, &u->kind, u->count, 3 + kind, slice->cell_at[kind]);
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < m; k++) block[k] = slice->id[node[i + k]];
    vg_ugrid_put_nodes(out, &u->kind, m, block);
  }
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  const struct ugrid *u = of;

  put_points(u, slice, out);
  put_cells(u, slice, VG_SLICE_TET, 4, out);
  put_cells(u, slice, VG_SLICE_PYR, 5, out);
  put_cells(u, slice, VG_SLICE_PRI, 6, out);
}

vg_status vg_slices_write_ugrid(struct vg_comm *comm,
                                const struct vg_slices *s, const char *path,
                                const struct vg_slices_options *o,
                                struct vg_error *err)
{
  struct ugrid u = { .mesh = vg_slices_frame(s) };
  struct vg_slice_file f = { path, o->record_limit, &u, put_frame, put_slice };
  const uint64_t count[7] = {
    s->n_point, u.mesh.n_tri, u.mesh.n_quad, s->n_cell[VG_SLICE_TET],
    s->n_cell[VG_SLICE_PYR], s->n_cell[VG_SLICE_PRI], 0
  };
  size_t n_layer_tet = (size_t)s->n_layer_cell[VG_SLICE_TET];
  vg_status st;

  vg_ugrid_kind(path, &u.kind);
  memcpy(u.count, count, sizeof count);
  if (o->tail) u.n_layer_tet = &n_layer_tet;
  st = vg_ugrid_check(path, &u.kind, &u.mesh, u.n_layer_tet, err);
  if (st < 0) return st;   /* the same on all ranks */
  return vg_slice_file_write(&f, comm, s, o->threads, err);
}
