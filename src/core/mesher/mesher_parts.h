/* core/mesher/mesher_parts.h: what the two ends of a mesher's process share.
 * Private to core/mesher.
 *
 * The process that loads a mesher fills no void itself: for each it forks one
 * that does and ends, so that every void finds the mesher as it was loaded, and
 * a library of many megabytes is loaded once. On the socket, in the byte order
 * of the machine:
 *   parent: struct vg_mesher_spec; child: struct vg_mesher_hello;
 *   then for each void, parent: struct vg_mesher_job, x, face;
 *   child: struct vg_mesher_word, and what it says:
 *     VG_WORD_SIZES: n points follow; parent answers with n sizes
 *     VG_WORD_CELLS: n new points and n_cell cells follow; the void is done
 *     VG_WORD_NONE:  the mesher could not; the void is done */
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

/** The child: a vg_child_body. */
void vg_mesher_serve(int fd);

/* --- in the child -------------------------------------------------------- */

/** core/mesher/tetgen.cpp, core/mesher/hxt.c: NULL and why not. */
const struct vg_mesher *vg_mesher_tetgen(void);
const struct vg_mesher *vg_mesher_hxt(char *why, size_t size);

/** core/mesher/child.c: as dlopen, with its own names before those of this
 * program. */
void *vg_mesher_library(const char *path);

/** core/mesher/shells.c: what bounds a front's parts, which hang together at
 * points and edges at most. A shell is hollow where what is to be filled goes
 * around it. A piece is a part of a shell that ends where more than two
 * triangles meet at an edge. */
struct vg_mesher_shells {
  size_t n, n_hollow, n_piece;
  uint32_t *of, *piece;     /* [n_face] */
  uint32_t *shell_of;       /* [n_piece] */
  unsigned char *is_hollow; /* [n] */
  size_t *largest;          /* [n] the largest triangle */
};
/** 0, or -1 where memory is refused. */
int vg_mesher_find_shells(const struct vg_mesher_front *f,
                          struct vg_mesher_shells *out);
void vg_mesher_shells_release(struct vg_mesher_shells *s);

/** Normal of a face, twice its area long. */
void vg_mesher_normal(const struct vg_mesher_front *f, size_t face,
                      double n[3]);

/** core/mesher/child_sizes.c: sizes that the parent is asked for, over the box
 * of a front. NULL: no memory. Ends the process when the parent is gone. */
struct vg_child_sizes;
void vg_child_sizes_free(struct vg_child_sizes *s);
struct vg_child_sizes *vg_child_sizes_new(int fd,
                                          const struct vg_mesher_front *f);
void vg_child_sizes_at(void *sizes, size_t n, const double (*x)[3], double *h);

#ifdef __cplusplus
}
#endif

#endif
