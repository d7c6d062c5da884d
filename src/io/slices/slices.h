/* io/slices/slices.h: writing meshes that are in slices, by all ranks at once,
 * into the files that one process would write, byte for byte. */
#ifndef VG_IO_SLICES_SLICES_H
#define VG_IO_SLICES_SLICES_H

#include "base/comm.h"
#include "core/mesh/slices.h"

struct vg_slices_options {
  int threads;           /* to encode with; 0: one per core at hand */
  int tail;              /* .ugrid: with the number of layer tetrahedra, as
                            vg_ugrid_write_tail */
  uint32_t record_limit; /* bytes of a Fortran subrecord; 0: 2 GB */
  uint64_t piece_cells;  /* .pvtu: a new piece when slices begin behind
                            another multiple of this; 0: 2 M */
};
#define VG_SLICES_OPTIONS_INIT                                                 \
  {                                                                            \
    .threads = 0                                                               \
  }

/** Can a mesh in slices be written in this form? The words of the run deck's
 * write list: "cogsg", every binary .ugrid ("lb8.ugrid", ...), "vtu", "pvtu",
 * "su2", "msh", "cgns", "fluent.msh", and "mapbc", "fun3d.mapbc",
 * "surface.vtu"; and "part.N". */
int vg_slices_can_write(const char *form);

/** Write STEM.form, and what belongs to it: .bc and .mapbc of .cogsg (as
 * vg_cogsg_write), the pieces of .pvtu. Collective; the same answer on all
 * ranks. Files appear complete or not at all.
 *
 * The same bytes as the writer of whole meshes makes, for any number of ranks
 * and threads; "vtu" has fields angle_min and radius_ratio when all cells are
 * tetrahedra. Where the mesh has parts for the solver, vtu and pvtu have them
 * as cell data solver_part, and part.N, with N their number, is a METIS file
 * (io/stream/metis_part.h). A .pvtu has no such twin: a piece for every run of
 * slices of about 2 M cells, in which each slice has its own points; cell data
 * `subdomain` and `kind` of the slices.
 * Memory: a slice and 1 MB per thread; boundary points for cogsg and mapbc.
 * VG_ERR_UNSUPPORTED: another form, counts beyond it, or cells that it does
 * not hold. */
vg_status vg_slices_write(struct vg_comm *comm, const struct vg_slices *s,
                          const char *stem, const char *form, int threads,
                          struct vg_error *err);

vg_status vg_slices_write_with(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem, const char *form,
                               const struct vg_slices_options *o,
                               struct vg_error *err);

/** A binary .ugrid at `path`, written slice by slice by whoever has these at
 * hand for something else as well. Open and close are collective and have the
 * same answer on all ranks; put is a vg_slice_body for any number of threads,
 * and every slice must be put once. close: st says how this rank fared; the
 * file appears, complete, if all ranks are well. s: needed until closed.
 * Of 4-byte reals, close gives VG_ERR_GEOMETRY where rounding makes cells flat
 * or inverted, or points one. */
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

/** Path of piece k of STEM.pvtu, STEM_k.vtu as ParaView has it; they are
 * numbered from 0 without gaps. To be freed; NULL: no memory. */
char *vg_slices_piece(const char *stem, size_t k);

/** The boundary with its points (and no others) on every rank. Collective.
 * *out: replaced on success; indices are those of the mesh. */
vg_status vg_slices_boundary(struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_mesh *out,
                             struct vg_error *err);

#endif
