/* io/cgns/cgns_tree.h: the tree of nodes of a CGNS file in HDF5. Private to
 * its module; the only file that knows the HDF5 library is cgns_tree.c,
 * without which cgns_none.c stands for it.
 *
 * A node is an HDF5 group of its name, with attributes name, label, type and
 * flags, and its data in a set " data", whose dimensions stand in HDF5 in the
 * reverse order. */
#ifndef VG_IO_CGNS_TREE_H
#define VG_IO_CGNS_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "io/cgns/cgns_store.h"
#include "io/stream/stream.h"

enum { VG_CGNS_NAME = 33 }; /* bytes of a name or label with its end */

/* What a node holds. type: as in CGNS, "MT" nothing, "C1" characters, "I4",
 * "I8", "R4", "R8". */
struct vg_cgns_data {
  const char *type;
  int n_dim;         /* 0 (MT) to 2 */
  uint64_t dim[2];   /* in the order of the standard */
  const void *value; /* NULL: room is reserved, and nothing written */
};

struct vg_cgns_node {
  int64_t id;
  char name[VG_CGNS_NAME], label[VG_CGNS_NAME];
};

struct vg_cgns_tree;

int vg_cgns_tree_is_built(void);

/* --- writing --- */

/** A new file in an empty store, which must stay; *root: its first node. When
 * it is closed its bytes are [store->size].
 * @param name  what messages call it */
vg_status vg_cgns_tree_new(struct vg_cgns_store *store, const char *name,
                           struct vg_cgns_tree **out, int64_t *root,
                           struct vg_error *err);

/** Append a child. id: NULL, or for children of its own; at: where in the file
 * its data are, of reserved room only; else NULL. */
vg_status vg_cgns_tree_add(struct vg_cgns_tree *t, int64_t parent,
                           const char *name, const char *label,
                           const struct vg_cgns_data *d, int64_t *id,
                           uint64_t *at, struct vg_error *err);

/* --- reading, in a process of its own: the library's settings are changed ---
 */

/** The file in `in`, which must stay. */
vg_status vg_cgns_tree_open(struct vg_input *in, struct vg_cgns_tree **out,
                            int64_t *root, struct vg_error *err);

/** Children of a node with this label, in the order in which they were made
 * (by name, where the file does not keep that); *list to be freed.
 * VG_ERR_UNSUPPORTED: one of them is a link. */
vg_status vg_cgns_tree_children(struct vg_cgns_tree *t, int64_t parent,
                                const char *label, struct vg_cgns_node **list,
                                size_t *n, struct vg_error *err);

/** Data of a node as integers, reals, text (with an end; n counts without it).
 * `what` is for messages; *v to be freed. VG_ERR_FORMAT: none, or of another
 * type, or more than can be in such a file. */
vg_status vg_cgns_tree_ints(struct vg_cgns_tree *t, int64_t id,
                            const char *what, int64_t **v, size_t *n,
                            struct vg_error *err);
vg_status vg_cgns_tree_reals(struct vg_cgns_tree *t, int64_t id,
                             const char *what, double **v, size_t *n,
                             struct vg_error *err);
vg_status vg_cgns_tree_text(struct vg_cgns_tree *t, int64_t id,
                            const char *what, char **v, size_t *n,
                            struct vg_error *err);

/** Close. Of a file that is written: a failure so far. NULL is accepted. */
vg_status vg_cgns_tree_close(struct vg_cgns_tree *t, struct vg_error *err);

#endif
