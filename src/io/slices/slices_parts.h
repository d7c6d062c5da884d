/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/slices/slices_parts.h: declarations shared by the writers of whole meshes
 * and of meshes in slices.
 *
 * A file consists of its frame and the data of the slices. The frame is the
 * output of the writer of whole meshes for a mesh that has a boundary and
 * counts, but NULL for its points and cells: their bytes are skipped, and
 * headers and markers are written at their final offsets. Slices seek in the
 * file and use the same encoders. */
#ifndef VG_IO_SLICES_SLICES_PARTS_H
#define VG_IO_SLICES_SLICES_PARTS_H

#include "core/mesh/slices.h"
#include "io/cgns/cgns_put.h"
#include "io/mesh/gmsh_put.h"
#include "io/mesh/su2_put.h"
#include "io/mesh/ugrid_put.h"
#include "io/mesh/vtu_put.h"
#include "io/slices/slices.h"
#include "io/stream/narrow.h"
#include "io/stream/stream.h"
#include "io/vgrid/cogsg_put.h"

/* Functions that write a kind of file; `of` is passed to them. */
struct vg_slice_file {
  const char *path;
  uint32_t record_limit; /* 0: VG_RECORD_LIMIT */
  void *of;
  void (*frame)(const void *of, struct vg_output *out);
  void (*slice)(void *of, const struct vg_slice *slice, struct vg_output *out);
};

/** Size of the file in bytes. */
vg_status vg_slice_file_size(const struct vg_slice_file *f, uint64_t *size,
                             struct vg_error *err);

/** Write a slice, or the frame if it is NULL, into an open file. Local.
 * Threads: any number at once. */
vg_status vg_slice_file_put(const struct vg_slice_file *f,
                            struct vg_shared_file *to,
                            const struct vg_slice *slice, struct vg_error *err);

/** Write frame (on rank 0) and slices into an open file. Not collective. */
vg_status vg_slice_file_fill(const struct vg_slice_file *f,
                             struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_shared_file *to,
                             struct vg_error *err);

/** Open the file with its final size. Collective. */
vg_status vg_slice_file_open(const struct vg_slice_file *f,
                             struct vg_comm *comm, struct vg_shared_file **to,
                             struct vg_error *err);

/** Open, fill, close. Collective. */
vg_status vg_slice_file_write(const struct vg_slice_file *f,
                              struct vg_comm *comm, const struct vg_slices *s,
                              int threads, struct vg_error *err);

/** Frame of a mesh in slices: counts and boundary. It must not be released. */
struct vg_mesh vg_slices_frame(const struct vg_slices *s);

/** VG_ERR_INPUT if a boundary face refers to a point that is not among the
 * first n_boundary_point. */
vg_status vg_slices_check_boundary(const struct vg_slices *s,
                                   struct vg_error *err);

/** Coordinates [n][3] of the points `own` of a slice, starting with the
 * k-th. */
void vg_slice_points(const struct vg_slice *slice, size_t k, size_t n,
                     double (*x)[3]);

/* Coordinates [n_boundary_point] of the boundary points, collected from slices.
 * add: may be called by several threads at once; share: between all ranks,
 * collective. */
struct vg_boundary_points {
  size_t n;
  double (*x)[3];
  unsigned char *known; /* points found on this rank */
};
vg_status vg_boundary_points_new(const struct vg_slices *s,
                                 struct vg_boundary_points *b,
                                 struct vg_error *err);
void vg_boundary_points_release(struct vg_boundary_points *b);
void vg_boundary_points_add(struct vg_boundary_points *b,
                            const struct vg_slice *slice);
vg_status vg_boundary_points_share(struct vg_comm *comm,
                                   struct vg_boundary_points *b,
                                   struct vg_error *err);

/* --- the forms --- */

vg_status vg_slices_write_cogsg(struct vg_comm *comm, const struct vg_slices *s,
                                const char *stem,
                                const struct vg_slices_options *o,
                                struct vg_error *err);
vg_status vg_slices_write_vtu(struct vg_comm *comm, const struct vg_slices *s,
                              const char *path,
                              const struct vg_slices_options *o,
                              struct vg_error *err);
vg_status vg_slices_write_su2(struct vg_comm *comm, const struct vg_slices *s,
                              const char *path, int threads,
                              struct vg_error *err);
vg_status vg_slices_write_part(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path, int threads,
                               struct vg_error *err);
vg_status vg_slices_write_gmsh(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_error *err);
vg_status vg_slices_write_cgns(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_error *err);
vg_status vg_slices_write_fluent(struct vg_comm *comm,
                                 const struct vg_slices *s, const char *path,
                                 const struct vg_slices_options *o,
                                 struct vg_error *err);
vg_status vg_slices_write_pvtu(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem,
                               const struct vg_slices_options *o,
                               struct vg_error *err);

#endif
