/* core/mesher/mesher_parts.h: declarations shared by the two processes of a
 * mesher, parent and child. Private to core/mesher.
 *
 * The process that loads a mesher fills no void itself. It forks a process for
 * each void, which ends afterwards. Every void thus gets the mesher in its
 * initial state, and a library of many megabytes is loaded only once. Messages
 * on the socket, in the byte order of the machine:
 *   parent: struct vg_mesher_spec; child: struct vg_mesher_hello;
 *   then for each void, parent: struct vg_mesher_job, x, face;
 *   child: struct vg_mesher_word, followed by its data:
 *     VG_WORD_SIZES: n points; the parent answers with n lengths
 *     VG_WORD_CELLS: n new points and n_cell cells; the void is done
 *     VG_WORD_NONE:  no data, the mesher failed; the void is done */
#ifndef VG_CORE_MESHER_MESHER_PARTS_H
#define VG_CORE_MESHER_MESHER_PARTS_H

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
struct vg_mesher_job {
  uint64_t n_point, n_face;
  double seconds;
};
enum { VG_WORD_SIZES = 1, VG_WORD_CELLS, VG_WORD_NONE };
struct vg_mesher_word {
  uint64_t what, n, n_cell;
};

/** Main function of the child: a vg_child_body. */
void vg_mesher_serve(int fd);

/* --- in the child --------------------------------------------------------- */

/** core/mesher/tetgen.cpp, core/mesher/hxt.c. vg_mesher_hxt returns NULL and
 * the reason in why if the library cannot be used. */
const struct vg_mesher *vg_mesher_tetgen(void);
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
 * requested from the parent. NULL if memory is refused. Ends the process if
 * the parent is gone. */
struct vg_child_sizes;
void vg_child_sizes_free(struct vg_child_sizes *s);
struct vg_child_sizes *vg_child_sizes_new(int fd,
                                          const struct vg_mesher_front *f);
void vg_child_sizes_at(void *sizes, size_t n, const double (*x)[3], double *h);

#ifdef __cplusplus
}
#endif

#endif
