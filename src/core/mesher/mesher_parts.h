/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesher/mesher_parts.h: declarations shared by the two processes of a
 * mesher, parent and child. Private to core/mesher.
 *
 * The process that loads a mesher fills no void itself. It forks a process for
 * each void, which ends afterwards. Every void thus gets the mesher in its
 * initial state, and a library of many megabytes is loaded only once. The
 * parent first sends a struct vg_mesher_spec and receives a struct
 * vg_mesher_hello. After that the messages are those of a helper program
 * (base/helper/helper_format.h): VG_HELPER_FILL and VG_HELPER_LENGTHS from the
 * parent, VG_HELPER_SIZES, VG_HELPER_CELLS and VG_HELPER_NONE from the child.
 * TetGen is a helper program itself (base/helper/helper.h), and each of its
 * processes fills one void. */
#ifndef VG_CORE_MESHER_MESHER_PARTS_H
#define VG_CORE_MESHER_MESHER_PARTS_H

#include "base/helper/helper_format.h"
#include "core/mesher/mesher.h"

#ifdef __cplusplus
extern "C" {
#endif

struct vg_mesher_spec {
  char name[4096];
};
struct vg_mesher_hello {
  int32_t is_ready;
  char text[508];
};
/** Main function of the child: a vg_child_body. */
void vg_mesher_serve(int fd);

/* --- in the child --------------------------------------------------------- */

/** core/mesher/hxt.c. Returns NULL and the reason in why if the library cannot
 * be used. */
const struct vg_mesher *vg_mesher_hxt(char *why, size_t size);

/** core/mesher/child.c: as dlopen; the library's own symbols take precedence
 * over those of this program. */
void *vg_mesher_library(const char *path);

/** core/mesher/shells.c: shells of a front, which are not connected to each
 * other except at points and edges. A shell is hollow if the void lies around
 * it. A piece is a part of a shell that ends at edges with more than two
 * triangles. */
struct vg_mesher_shells {
  size_t n, n_hollow, n_piece;
  uint32_t *of, *piece;     /* [n_face] shell and piece of each face */
  uint32_t *shell_of;       /* [n_piece] shell of each piece */
  unsigned char *is_hollow; /* [n] */
  size_t *largest;          /* [n] largest triangle of each shell */
};
/** Returns 0, or -1 if memory is refused. */
int vg_mesher_find_shells(const struct vg_mesher_front *f,
                          struct vg_mesher_shells *out);
void vg_mesher_shells_release(struct vg_mesher_shells *s);

/** Normal of a face; its length is twice the area. */
void vg_mesher_normal(const struct vg_mesher_front *f, size_t face,
                      double n[3]);

/** core/mesher/child_sizes.c: target edge lengths over the box of a front,
 * requested from the parent: questions go to `out`, answers come from `in`, two
 * descriptors of which both may be the same socket. NULL if memory is refused.
 * Ends the process if the parent is gone. Also part of vanguard-tetgen. */
struct vg_child_sizes;
void vg_child_sizes_free(struct vg_child_sizes *s);
struct vg_child_sizes *vg_child_sizes_new(int in, int out,
                                          const struct vg_mesher_front *f);
void vg_child_sizes_at(void *sizes, size_t n, const double (*x)[3], double *h);

#ifdef __cplusplus
}
#endif

#endif
