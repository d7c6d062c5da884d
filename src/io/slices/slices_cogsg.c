/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/slices/slices_parts.h"
#include "io/stream/shared_file.h"

#define BLOCK 4096

/* VGRID's point order concerns only the boundary: in a mesh in slices
 * (core/mesh/slices.h), as in the file, the boundary points come first, so that
 * all other points keep their numbers. Coordinates of the boundary points are
 * collected from the slices that own them and written by rank 0. */
struct cogsg {
  struct vg_cogsg_info info;
  struct vg_mesh mesh;               /* frame of the file */
  uint32_t *new_to_old, *old_to_new; /* orders of boundary points, or NULL */
  struct vg_boundary_points boundary;
};

static void put_frame(const void *of, struct vg_output *out)
{
  const struct cogsg *c = of;

  vg_cogsg_put(out, &c->mesh, &c->info, NULL, NULL);
}

static void put_column(const struct cogsg *c, const struct vg_slice *slice,
                       int column, struct vg_output *out)
{
  const uint32_t *node = slice->cell[VG_SLICE_TET];
  size_t n = slice->n_cell[VG_SLICE_TET];
  int32_t block[BLOCK];

  vg_cogsg_seek(out, c->mesh.n_tet, c->mesh.n_point, VG_COGSG_CELLS, column,
                slice->cell_at[VG_SLICE_TET]);
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < m; k++) {
      uint32_t p = slice->id[node[4 * (i + k) + (size_t)column]];

      if (c->old_to_new && p < c->boundary.n) p = c->old_to_new[p];
      block[k] = (int32_t)(p + 1);
    }
    vg_output_i32(out, m, block);
  }
}

/* Write one coordinate of the points that are not on the boundary. */
static void put_axis(const struct cogsg *c, const struct vg_slice *slice,
                     int axis, struct vg_output *out)
{
  double block[BLOCK];
  size_t at = slice->point_at < c->boundary.n
              ? (size_t)(c->boundary.n - slice->point_at)
              : 0;

  if (at >= slice->n_own) return;
  vg_cogsg_seek(out, c->mesh.n_tet, c->mesh.n_point, VG_COGSG_POINTS, axis,
                slice->point_at + at);
  for (size_t m; at < slice->n_own; at += m) {
    m = slice->n_own - at < BLOCK ? slice->n_own - at : BLOCK;
    for (size_t k = 0; k < m; k++)
      block[k] = slice->x[slice->own[at + k]][axis];
    vg_output_f64(out, m, block);
  }
}

static void put_slice(void *of, const struct vg_slice *slice,
                      struct vg_output *out)
{
  struct cogsg *c = of;

  for (int k = 0; k < 4; k++) put_column(c, slice, k, out);
  for (int k = 0; k < 3; k++) put_axis(c, slice, k, out);
  vg_boundary_points_add(&c->boundary, slice);
}

static vg_status put_boundary(const struct cogsg *c, uint32_t record_limit,
                              struct vg_shared_file *to, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(to, &out, err);

  if (st < 0) return st;
  if (record_limit) out.record_limit = record_limit;
  for (int axis = 0; axis < 3; axis++) {
    vg_cogsg_seek(&out, c->mesh.n_tet, c->mesh.n_point, VG_COGSG_POINTS, axis,
                  0);
    for (size_t i = 0; i < c->boundary.n; i++)
      vg_output_f64(&out, 1,
                    &c->boundary.x[c->new_to_old ? c->new_to_old[i] : i][axis]);
  }
  st = vg_output_flush(&out, err);
  vg_output_release(&out);
  return st;
}

/* Write the .bc, still under its temporary name, and the .mapbc. */
static vg_status write_companions(const struct cogsg *c, const char *stem,
                                  const char *bc_name, struct vg_output *bc,
                                  struct vg_error *err)
{
  struct vg_mesh m = c->mesh;
  vg_status st;

  VG_TRY(vg_output_open(bc_name, bc, err));
  vg_cogsg_put_faces(bc, &m, &c->info, c->old_to_new);
  VG_TRY(vg_output_flush(bc, err));
  /* .mapbc uses the bounding box of the points, which is that of the
   * boundary. */
  m.n_point = c->boundary.n;
  m.point = c->boundary.x;
  VG_TRY(vg_cogsg_write_mapbc(stem, &m, NULL, err));
done:
  return st;
}

/* On rank 0, after all slices have been written. */
static vg_status finish(const struct cogsg *c, const char *stem,
                        uint32_t record_limit, struct vg_shared_file *to,
                        struct vg_error *err)
{
  struct vg_output bc = VG_OUTPUT_INIT;
  char *bc_name;
  vg_status st;

  if (asprintf(&bc_name, "%s.bc", stem) < 0)
    return vg_fail_memory(err, "a file name");
  VG_TRY(put_boundary(c, record_limit, to, err));
  VG_TRY(write_companions(c, stem, bc_name, &bc, err));
  VG_TRY(vg_output_commit(&bc, err));
done:
  vg_output_release(&bc);
  free(bc_name);
  return st;
}

static vg_status prepare(const struct vg_slices *s, const char *stem,
                         struct cogsg *c, struct vg_error *err)
{
  struct vg_mesh boundary = *s->boundary;
  vg_status st;

  c->info.n_layer_point = (size_t)s->n_layer_point;
  c->info.n_layer_cell = (size_t)s->n_layer_cell[VG_SLICE_TET];
  c->mesh = vg_slices_frame(s);
  VG_TRY(vg_cogsg_check(stem, &c->mesh, &c->info, err));
  VG_TRY(vg_slices_check_boundary(s, err));
  boundary.n_point = (size_t)s->n_boundary_point;
  VG_TRY(vg_vgrid_order(&boundary, &c->new_to_old, &c->old_to_new,
                        &c->info.n_curve_point, &c->info.n_boundary, err));
  VG_TRY(vg_boundary_points_new(s, &c->boundary, err));
done:
  return st;
}

vg_status vg_slices_write_cogsg(struct vg_comm *comm, const struct vg_slices *s,
                                const char *stem,
                                const struct vg_slices_options *o,
                                struct vg_error *err)
{
  struct cogsg c = { .info = VG_COGSG_INFO_INIT };
  struct vg_slice_file f = { NULL, o->record_limit, &c, put_frame, put_slice };
  struct vg_shared_file *to = NULL;
  char *path = NULL;
  uint64_t size = 0;
  vg_status st = VG_OK;

  if (asprintf(&path, "%s.cogsg", stem) < 0) {
    path = NULL;
    st = vg_fail_memory(err, "a file name");
  }
  f.path = path;
  if (st >= 0) st = prepare(s, stem, &c, err);
  if (st >= 0) st = vg_slice_file_size(&f, &size, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_shared_open(comm, path, size, &to, err));
  st = vg_slice_file_fill(&f, comm, s, o->threads, to, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_boundary_points_share(comm, &c.boundary, err);
  if (st >= 0 && !vg_comm_rank(comm))
    st = finish(&c, stem, o->record_limit, to, err);
  st = vg_shared_close(to, st, err);
done:
  vg_boundary_points_release(&c.boundary);
  free(c.new_to_old);
  free(c.old_to_new);
  free(path);
  return st;
}
