/* io/cgns/cgns_store.h: a file in memory in which only what was written takes
 * room, or bytes that are there to be read. Private to its module.
 *
 * HDF5 keeps what it cannot write for ever, and trips over it at the end of
 * the program, so the nodes of a CGNS file are made where no disk is full. */
#ifndef VG_IO_CGNS_STORE_H
#define VG_IO_CGNS_STORE_H

#include <stddef.h>
#include <stdint.h>

enum { VG_CGNS_PAGE = 4096 };

struct vg_cgns_page {
  uint64_t number;
  unsigned char byte[VG_CGNS_PAGE];
};

struct vg_cgns_store {
  const unsigned char *view; /* [size] borrowed; NULL: pages */
  uint64_t size;             /* up to where room is taken */
  struct vg_cgns_page *page; /* [n_page] by rising number */
  size_t n_page, cap_page;
  int failed; /* 1: memory was refused */
};
#define VG_CGNS_STORE_INIT                                                     \
  {                                                                            \
    .view = NULL                                                               \
  } /* releasing this is a no-op */

void vg_cgns_store_release(struct vg_cgns_store *s);

/** n bytes from `at` on; zero where nothing was written. */
void vg_cgns_store_get(const struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       void *to);

/** Where memory is refused the bytes are lost, and `failed` set. */
void vg_cgns_store_put(struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       const void *from);

#endif
