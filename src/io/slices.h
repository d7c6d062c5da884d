/* io/slices.h: writing meshes that are in slices, by all ranks at once, into
 * the files that one process would write, byte for byte. */
#ifndef VG_IO_SLICES_H
#define VG_IO_SLICES_H

#include "base/comm.h"
#include "core/slices.h"

/** Can a mesh in slices be written in this form ("cogsg", "lb8.ugrid", ...;
 * the words of the run deck's write list)? */
int vg_slices_can_write(const char *form);

/** Write STEM.form (and what belongs to it: .bc and .mapbc of .cogsg, as
 * io/output does for a whole mesh). Collective. threads: to encode with.
 * The same bytes as the writer of whole meshes makes, for any number of ranks
 * and threads; .pvtu and its pieces (one for every run of slices of about
 * 2 M cells; cell data: patch-less, `subdomain`, `kind`) have no such twin. */
vg_status vg_slices_write(struct vg_comm *comm, const struct vg_slices *s,
                          const char *path, const char *form, int threads,
                          struct vg_error *err);

#endif
