/* io/slices_parts.h: what writers of whole meshes share with those of meshes
 * in slices.
 *
 * A file is its frame and what slices put into it. The frame is what the
 * writer of whole meshes makes of a mesh that has boundary and counts, but
 * NULL for its points and cells: their bytes are skipped, headers and markers
 * fall where they belong. Slices seek in it and use the same encoders. */
#ifndef VG_IO_SLICES_PARTS_H
#define VG_IO_SLICES_PARTS_H

#include "core/slices.h"
#include "io/narrow.h"
#include "io/slices.h"
#include "io/stream.h"
#include "io/ugrid.h"
#include "io/vgrid.h"
#include "io/vtu.h"

/* --- .ugrid --- */

/** VG_ERR_UNSUPPORTED: counts beyond the kind's integers; VG_ERR_INPUT: more
 * layer tetrahedra than there are. n_layer_tet NULL: no tail. */
vg_status vg_ugrid_check(const char *path, const struct vg_ugrid_kind *kind,
                         const struct vg_mesh *m, const size_t *n_layer_tet,
                         struct vg_error *err);

/** Is what rounding to the kind's reals left of a mesh fit for a file? */
vg_status vg_ugrid_accept(const struct vg_ugrid_kind *kind,
                          const struct vg_narrow *n, struct vg_error *err);

/** A mesh, or a frame of a binary kind. */
void vg_ugrid_put(struct vg_output *out, const struct vg_ugrid_kind *kind,
                  const struct vg_mesh *m, const size_t *n_layer_tet);

/** Go to an item of a binary file. item: as in the header, 0 points, 3
 * tetrahedra, 4 pyramids, 5 prisms. */
void vg_ugrid_seek(struct vg_output *out, const struct vg_ugrid_kind *kind,
                   const uint64_t count[7], int item, uint64_t first);

/** n numbers of points, 0-based; NULL: skipped. */
void vg_ugrid_put_nodes(struct vg_output *out,
                        const struct vg_ugrid_kind *kind, size_t n,
                        const uint32_t *node);
void vg_ugrid_put_points(struct vg_output *out,
                         const struct vg_ugrid_kind *kind, size_t n,
                         const double (*x)[3]);

/* --- .cogsg --- */

vg_status vg_cogsg_check(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info,
                         struct vg_error *err);

/** A mesh, or a frame; the orders of vg_vgrid_order, or NULL. */
void vg_cogsg_put(struct vg_output *out, const struct vg_mesh *m,
                  const struct vg_cogsg_info *info,
                  const uint32_t *new_to_old, const uint32_t *old_to_new);

/** Content of the .bc. */
void vg_cogsg_put_faces(struct vg_output *out, const struct vg_mesh *m,
                        const struct vg_cogsg_info *info,
                        const uint32_t *old_to_new);

/** STEM.mapbc beside a .cogsg; m has the points of its triangles. */
vg_status vg_cogsg_write_mapbc(const char *stem, const struct vg_mesh *m,
                               size_t *n_unset, struct vg_error *err);

/** Go to a cell or a point in one of its four or three columns. */
enum vg_cogsg_part { VG_COGSG_CELLS, VG_COGSG_POINTS };
void vg_cogsg_seek(struct vg_output *out, uint64_t n_tet, uint64_t n_point,
                   enum vg_cogsg_part part, int column, uint64_t first);

/* --- .vtu --- */

#define VG_VTU_FIELDS_MAX 2

/* Where in the file the data of an array start. */
struct vg_vtu_places {
  uint64_t points, connectivity, offsets, types, field[VG_VTU_FIELDS_MAX];
};

/** A frame. field: [n] of cells; data NULL: skipped. */
void vg_vtu_put(struct vg_output *out, const struct vg_mesh *frame,
                const struct vg_vtu_field *field, size_t n);

/** Places in a file of file_size bytes. */
void vg_vtu_find(const struct vg_mesh *frame, uint64_t file_size,
                 const struct vg_vtu_field *field, size_t n,
                 struct vg_vtu_places *to);

/* A run of cells of one kind. */
struct vg_vtu_cells {
  int kind;                  /* VG_SLICE_TET, ... */
  size_t n;
  const uint32_t *node;
  const uint32_t *number;    /* of a node in the file; NULL: itself */
  uint64_t add;              /* to that number */
  uint64_t first, first_node;  /* place among cells, in the connectivity */
};

/** Connectivity, offsets and types of a run of cells. */
void vg_vtu_put_cells(struct vg_output *out, const struct vg_vtu_places *at,
                      const struct vg_vtu_cells *c);

/* --- a file in slices --- */

/* How a kind of file is written; `of` is its own. */
struct vg_slice_file {
  const char *path;
  uint32_t record_limit;     /* 0: VG_RECORD_LIMIT */
  void *of;
  void (*frame)(const void *of, struct vg_output *out);
  void (*slice)(void *of, const struct vg_slice *slice,
                struct vg_output *out);
};

/** Bytes of the file. */
vg_status vg_slice_file_size(const struct vg_slice_file *f, uint64_t *size,
                             struct vg_error *err);

/** A slice, or the frame for NULL, into an open file. Local. Threads: any
 * number at once. */
vg_status vg_slice_file_put(const struct vg_slice_file *f,
                            struct vg_shared_file *to,
                            const struct vg_slice *slice,
                            struct vg_error *err);

/** Frame (by rank 0) and slices into an open file. Not collective. */
vg_status vg_slice_file_fill(const struct vg_slice_file *f,
                             struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_shared_file *to,
                             struct vg_error *err);

/** Collective; the file has its size. */
vg_status vg_slice_file_open(const struct vg_slice_file *f,
                             struct vg_comm *comm, struct vg_shared_file **to,
                             struct vg_error *err);

/** Open, fill, close. Collective. */
vg_status vg_slice_file_write(const struct vg_slice_file *f,
                              struct vg_comm *comm, const struct vg_slices *s,
                              int threads, struct vg_error *err);

/** Counts and boundary of a mesh in slices; nothing to be released. */
struct vg_mesh vg_slices_frame(const struct vg_slices *s);

/** Coordinates [n][3] of the points `own` of a slice from its k-th on. */
void vg_slice_points(const struct vg_slice *slice, size_t k, size_t n,
                     double (*x)[3]);

/* Coordinates of boundary points as slices deliver them; [n_boundary_point].
 * add: from several threads at once; share: collective, between all ranks. */
struct vg_boundary_points {
  size_t n;
  double (*x)[3];
  unsigned char *known;      /* delivered on this rank */
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

vg_status vg_slices_write_cogsg(struct vg_comm *comm,
                                const struct vg_slices *s, const char *stem,
                                const struct vg_slices_options *o,
                                struct vg_error *err);
vg_status vg_slices_write_vtu(struct vg_comm *comm, const struct vg_slices *s,
                              const char *path, int threads,
                              struct vg_error *err);
vg_status vg_slices_write_pvtu(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem,
                               const struct vg_slices_options *o,
                               struct vg_error *err);

#endif
