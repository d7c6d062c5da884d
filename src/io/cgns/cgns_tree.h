/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_tree.h: the tree of nodes of a CGNS file in HDF5. Private to its
 * module. Only cgns_tree.c uses the HDF5 library; cgns_none.c replaces it in
 * builds without HDF5.
 *
 * A node is an HDF5 group with the node's name and the attributes name, label,
 * type and flags. Its data are in a data set " data", whose dimensions are in
 * reverse order in HDF5. */
#ifndef VG_IO_CGNS_TREE_H
#define VG_IO_CGNS_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "io/cgns/cgns_store.h"
#include "io/stream/stream.h"

/* Bytes of a name or label, including the terminating zero. */
enum { VG_CGNS_NAME = 33 };

/* Data of a node. type: as in CGNS, "MT" none, "C1" characters, "I4", "I8",
 * "R4", "R8". */
struct vg_cgns_data {
  const char *type;
  int n_dim;         /* 0 (MT) to 2 */
  uint64_t dim[2];   /* in the order of the standard */
  const void *value; /* NULL: space is reserved, but nothing is written */
};

struct vg_cgns_node {
  int64_t id;
  char name[VG_CGNS_NAME], label[VG_CGNS_NAME];
};

struct vg_cgns_tree;

int vg_cgns_tree_is_built(void);

/* --- writing --- */

/** Create a file in an empty store, which must outlive it; *root: its first
 * node. After it is closed, its bytes are [store->size].
 * @param name  name of the file in messages */
vg_status vg_cgns_tree_new(struct vg_cgns_store *store, const char *name,
                           struct vg_cgns_tree **out, int64_t *root,
                           struct vg_error *err);

/** Append a child. id: receives the id of the child, which may get children;
 * may be NULL. at: receives the offset of its data in the file, for reserved
 * space only; otherwise NULL. */
vg_status vg_cgns_tree_add(struct vg_cgns_tree *t, int64_t parent,
                           const char *name, const char *label,
                           const struct vg_cgns_data *d, int64_t *id,
                           uint64_t *at, struct vg_error *err);

/* --- reading, only in a separate process, since it changes the settings of
 * HDF5 --- */

/** Open the file in `in`, which must outlive the tree. */
vg_status vg_cgns_tree_open(struct vg_input *in, struct vg_cgns_tree **out,
                            int64_t *root, struct vg_error *err);

/** Children of a node that have this label, in the order of their creation (by
 * name if the file does not record it); *list must be freed.
 * VG_ERR_UNSUPPORTED: one of the node's children is a link. */
vg_status vg_cgns_tree_children(struct vg_cgns_tree *t, int64_t parent,
                                const char *label, struct vg_cgns_node **list,
                                size_t *n, struct vg_error *err);

/** Data of a node as integers, reals or text (zero-terminated; n excludes the
 * zero). `what` is used in messages; *v must be freed. VG_ERR_FORMAT: there are
 * no data, they have another type, or more values than fit into the file. */
vg_status vg_cgns_tree_ints(struct vg_cgns_tree *t, int64_t id,
                            const char *what, int64_t **v, size_t *n,
                            struct vg_error *err);
vg_status vg_cgns_tree_reals(struct vg_cgns_tree *t, int64_t id,
                             const char *what, double **v, size_t *n,
                             struct vg_error *err);
vg_status vg_cgns_tree_text(struct vg_cgns_tree *t, int64_t id,
                            const char *what, char **v, size_t *n,
                            struct vg_error *err);

/** Close. For a file that was written, returns the first failure. Accepts
 * NULL. */
vg_status vg_cgns_tree_close(struct vg_cgns_tree *t, struct vg_error *err);

#endif
