/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/slices/slices.h: writes meshes that are available as slices, by all ranks
 * at once, into files that are byte for byte those of a single process. */
#ifndef VG_IO_SLICES_SLICES_H
#define VG_IO_SLICES_SLICES_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "core/periodic/periodic.h"

struct vg_slices_options {
  int threads; /* number of threads that encode; 0: one per available core */
  int tail;    /* .ugrid: write the number of layer tetrahedra, as
                  vg_ugrid_write_tail */
  uint32_t record_limit; /* maximum bytes of a Fortran subrecord; 0: 2 GB */
  uint64_t piece_cells;  /* .pvtu: a slice starts a new piece when the number
                            of cells before it passes a multiple of this; 0: 2
                            M */
  int plain;             /* .vtu: 1: without fields of quality */
  const struct vg_periodic_links *links; /* periodic patches for .cgns,
                                            .fluent.msh and .msh: points and
                                            faces of vg_slices_boundary; NULL:
                                            none. The same on all ranks */
};
#define VG_SLICES_OPTIONS_INIT                                                 \
  {                                                                            \
    .threads = 0                                                               \
  }

/** Can a mesh in slices be written in this form? The words of the run deck's
 * write list: "cogsg", every binary .ugrid ("lb8.ugrid", ...), "vtu", "pvtu",
 * "su2", "msh", "cgns", "fluent.msh", as well as "mapbc", "fun3d.mapbc",
 * "surface.vtu" and "part.N". */
int vg_slices_can_write(const char *form);

/** Write STEM.form and its companion files: .bc and .mapbc of .cogsg (as
 * vg_cogsg_write), the pieces of .pvtu. Collective; all ranks return the same
 * status. Files appear complete or not at all.
 *
 * For any number of ranks and threads, the files have the same bytes as those
 * of the writers of whole meshes. "vtu" has the fields angle_min and
 * radius_ratio if all cells are tetrahedra, unless `plain` is set. If the mesh
 * has solver partitions, vtu and pvtu contain them as cell data solver_part,
 * and part.N, where N is their number, is a METIS file
 * (io/stream/metis_part.h). A .pvtu has no counterpart among whole meshes: it
 * has a piece for every sequence of slices with about 2 M cells, in which each
 * slice has its own points; the cell data `subdomain` and `kind` are those of
 * the slices. Memory: a slice and 1 MB per thread; the boundary points for
 * cogsg and mapbc. VG_ERR_UNSUPPORTED: another form, fluent.msh for a mesh with
 * sheets, counts that exceed its
 * limits, or cells that it cannot hold. */
vg_status vg_slices_write(struct vg_comm *comm, const struct vg_slices *s,
                          const char *stem, const char *form, int threads,
                          struct vg_error *err);

vg_status vg_slices_write_with(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem, const char *form,
                               const struct vg_slices_options *o,
                               struct vg_error *err);

/** Write a binary .ugrid at `path` slice by slice, by a caller that uses each
 * slice for other purposes as well. Open and close are collective and return
 * the same status on all ranks. put is a vg_slice_body for any number of
 * threads; every slice must be put exactly once. close: st is the status of
 * this rank; the file appears, complete, if that of all ranks is VG_OK. s must
 * be valid until then.
 * For 4-byte reals, close returns VG_ERR_GEOMETRY if rounding makes cells flat
 * or inverted, or points coincident. */
struct vg_slices_ugrid;
int vg_slices_is_ugrid(const char *form);
vg_status vg_slices_ugrid_open(struct vg_comm *comm, const struct vg_slices *s,
                               const char *path,
                               const struct vg_slices_options *o,
                               struct vg_slices_ugrid **out,
                               struct vg_error *err);
vg_status vg_slices_ugrid_put(void *ugrid, const struct vg_slice *slice,
                              struct vg_error *err);
vg_status vg_slices_ugrid_close(struct vg_slices_ugrid *u, vg_status st,
                                struct vg_error *err);

/** Path of piece k of STEM.pvtu, which is STEM_k.vtu as in ParaView. Pieces are
 * numbered from 0 without gaps. To be freed; NULL if there is not enough
 * memory. */
char *vg_slices_piece(const char *stem, size_t k);

/** Collect the boundary and its points (no others) on every rank. Collective.
 * *out is replaced on success; indices are those of the mesh. */
vg_status vg_slices_boundary(struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_mesh *out,
                             struct vg_error *err);

/** Collect the whole mesh on rank 0, for formats that have no writer of slices.
 * Collective. *out is replaced on success, by an empty mesh on the other ranks;
 * *part is the solver partition of each cell on rank 0, to be freed, or NULL
 * without n_part. Memory: the whole mesh on rank 0, and 256 MB.
 * VG_ERR_UNSUPPORTED: too many points for 32 bits. VG_ERR_MEMORY. */
vg_status vg_slices_gather(struct vg_comm *comm, const struct vg_slices *s,
                           int threads, struct vg_mesh *out, uint32_t **part,
                           struct vg_error *err);

#endif
