/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Stub of io/cgns/cgns_tree.h in a build without the HDF5 library. */
#include "io/cgns/cgns.h"
#include "io/cgns/cgns_tree.h"

#include <string.h>

int vg_cgns_tree_is_built(void)
{
  return 0;
}

void vg_library_hdf5(struct vg_library *out)
{
  out->name = "HDF5";
  strcpy(out->version, VG_NOT_IN_BUILD " (VG_HDF5=OFF)");
}

static vg_status absent(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "this build does not support CGNS, because it was configured "
                 "without HDF5 (CMake option VG_HDF5): install libhdf5-dev and "
                 "configure again");
}

vg_status vg_cgns_tree_new(struct vg_cgns_store *store, const char *name,
                           struct vg_cgns_tree **out, int64_t *root,
                           struct vg_error *err)
{
  (void)store;
  (void)out;
  (void)root;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: this build cannot write CGNS (CMake "
                 "option VG_HDF5): install libhdf5-dev and configure again",
                 name);
}

vg_status vg_cgns_tree_add(struct vg_cgns_tree *t, int64_t parent,
                           const char *name, const char *label,
                           const struct vg_cgns_data *d, int64_t *id,
                           uint64_t *at, struct vg_error *err)
{
  (void)t, (void)parent, (void)name, (void)label, (void)d, (void)id, (void)at;
  return absent(err);
}

vg_status vg_cgns_tree_open(struct vg_input *in, struct vg_cgns_tree **out,
                            int64_t *root, struct vg_error *err)
{
  (void)out;
  (void)root;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: this build cannot read CGNS (CMake "
                 "option VG_HDF5): install libhdf5-dev and configure again",
                 in->path);
}

vg_status vg_cgns_tree_children(struct vg_cgns_tree *t, int64_t parent,
                                const char *label, struct vg_cgns_node **list,
                                size_t *n, struct vg_error *err)
{
  (void)t, (void)parent, (void)label, (void)list, (void)n;
  return absent(err);
}

vg_status vg_cgns_tree_ints(struct vg_cgns_tree *t, int64_t id,
                            const char *what, int64_t **v, size_t *n,
                            struct vg_error *err)
{
  (void)t, (void)id, (void)what, (void)v, (void)n;
  return absent(err);
}

vg_status vg_cgns_tree_reals(struct vg_cgns_tree *t, int64_t id,
                             const char *what, double **v, size_t *n,
                             struct vg_error *err)
{
  (void)t, (void)id, (void)what, (void)v, (void)n;
  return absent(err);
}

vg_status vg_cgns_tree_text(struct vg_cgns_tree *t, int64_t id,
                            const char *what, char **v, size_t *n,
                            struct vg_error *err)
{
  (void)t, (void)id, (void)what, (void)v, (void)n;
  return absent(err);
}

vg_status vg_cgns_tree_close(struct vg_cgns_tree *t, struct vg_error *err)
{
  (void)t, (void)err;
  return VG_OK;
}
