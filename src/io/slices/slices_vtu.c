/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes a mesh in slices as one .vtu with the bytes of vg_vtu_write. */
#include "core/judge/quality.h"
#include "core/mesh/zones.h"
#include "io/slices/slices_parts.h"

/* Values per write call; two blocks of 128 kB are on the stack. */
#define BLOCK 32768

struct whole {
  struct vg_mesh mesh; /* frame of the file */
  struct vg_vtu_field field[VG_VTU_FIELDS_MAX];
  size_t n_field, n_quality; /* 0 or 2 quality fields of tetrahedra; then the
                                solver partition and the zone, if there are
                                any */
  struct vg_vtu_places at;
};

static void put_whole_frame(const void *of, struct vg_output *out)
{
  const struct whole *w = of;

  vg_vtu_put(out, &w->mesh, w->field, w->n_field);
}

static void put_quality(const struct whole *w, const struct vg_slice *slice,
                        struct vg_output *out)
{
  size_t n = slice->n_cell[VG_SLICE_TET];
  float figure[2][BLOCK];

  for (size_t i = 0; i < n; i += BLOCK) {
    const struct vg_mesh part = {
      .n_point = slice->n_point,
      .point = (double(*)[3])slice->x,
      .n_tet = n - i < BLOCK ? n - i : BLOCK,
      .tet = (uint32_t(*)[4])slice->cell[VG_SLICE_TET] + i
    };

    vg_mesh_cell_quality(&part, figure[0], figure[1]);
    for (int f = 0; f < 2; f++) {
      vg_output_seek(out,
                     w->at.field[f] +
                       sizeof **figure * (slice->cell_at[VG_SLICE_TET] + i));
      vg_output_bytes(out, figure[f], part.n_tet * sizeof **figure);
    }
  }
}

static void put_parts(const struct whole *w, const struct vg_slice *slice,
                      int kind, uint64_t first, struct vg_output *out)
{
  vg_output_seek(out, w->at.field[w->n_quality] +
                        sizeof(uint32_t) * (first + slice->cell_at[kind]));
  vg_output_bytes(out, slice->part[kind],
                  slice->n_cell[kind] * sizeof(uint32_t));
}

/* Numbers of the zones of the cells, in the last field. */
static void put_zones(const struct whole *w, const struct vg_slice *slice,
                      int kind, uint64_t first, struct vg_output *out)
{
  const struct vg_mesh *m = &w->mesh;
  uint64_t end = 0;
  size_t z = 0;

  vg_output_seek(out, w->at.field[w->n_field - 1] +
                        sizeof(int32_t) * (first + slice->cell_at[kind]));
  for (size_t c = 0; c < slice->n_cell[kind]; c++) {
    vg_mesh_zone_walk(m, kind, slice->cell_at[kind] + c, &z, &end);
    vg_output_bytes(out, &m->zone[z].id, sizeof m->zone[z].id);
  }
}

static void put_whole_slice(void *of, const struct vg_slice *slice,
                            struct vg_output *out)
{
  const struct whole *w = of;
  const uint64_t n[VG_SLICE_KINDS] = { w->mesh.n_tet, w->mesh.n_pyr,
                                       w->mesh.n_pri, w->mesh.n_hex };
  uint64_t first = 0, first_node = 0;

  vg_output_seek(out, w->at.points + 24 * slice->point_at);
  for (size_t k = 0; k < slice->n_own; k++)
    vg_output_f64(out, 3, slice->x[slice->own[k]]);
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    const struct vg_vtu_cells c = { k,
                                    slice->n_cell[k],
                                    slice->cell[k],
                                    slice->id,
                                    0,
                                    first + slice->cell_at[k],
                                    first_node +
                                      slice->cell_at[k] * vg_slice_width[k] };

    if (c.n) vg_vtu_put_cells(out, &w->at, &c);
    if (c.n && slice->part[k]) put_parts(w, slice, k, first, out);
    if (c.n && w->mesh.n_zone) put_zones(w, slice, k, first, out);
    first += n[k];
    first_node += n[k] * vg_slice_width[k];
  }
  if (w->n_quality) put_quality(w, slice, out);
}

vg_status vg_slices_write_vtu(struct vg_comm *comm, const struct vg_slices *s,
                              const char *path,
                              const struct vg_slices_options *o,
                              struct vg_error *err)
{
  struct whole w = {
    .mesh = vg_slices_frame(s),
    .field = { { "angle_min", VG_VTU_CELL, VG_VTU_FLOAT32, 1, NULL },
               { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT32, 1, NULL } }
  };
  const struct vg_vtu_field parts = { VG_VTU_SOLVER_PART, VG_VTU_CELL,
                                      VG_VTU_INT32, 1, NULL };
  const struct vg_vtu_field zones = { VG_VTU_ZONE, VG_VTU_CELL, VG_VTU_INT32, 1,
                                      NULL };
  struct vg_slice_file f = { path, 0, &w, put_whole_frame, put_whole_slice };
  uint64_t size = 0;
  vg_status st;

  if (!o->plain && !(s->n_cell[VG_SLICE_PYR] + s->n_cell[VG_SLICE_PRI] +
                     s->n_cell[VG_SLICE_HEX]))
    w.n_quality = 2;
  w.n_field = w.n_quality;
  if (s->n_part) w.field[w.n_field++] = parts;
  if (w.mesh.n_zone) w.field[w.n_field++] = zones;
  st = vg_slice_file_size(&f, &size, err);
  st = vg_comm_agree(comm, st, err);
  if (st < 0) return st;
  vg_vtu_find(&w.mesh, size, w.field, w.n_field, &w.at);
  return vg_slice_file_write(&f, comm, s, o->threads, err);
}
