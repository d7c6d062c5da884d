/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_store.h: a sparse file in memory, in which only the pages
 * written take memory, or a read-only view of existing bytes. Private to its
 * module.
 *
 * HDF5 never discards data that it cannot write, and fails on them at the end
 * of the program. So the nodes of a CGNS file are created in memory, where no
 * disk can be full. */
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
  uint64_t size;             /* end of the bytes allocated by HDF5 */
  struct vg_cgns_page *page; /* [n_page] sorted by number */
  size_t n_page, cap_page;
  int failed; /* 1: there was not enough memory */
};
#define VG_CGNS_STORE_INIT                                                     \
  {                                                                            \
    .view = NULL                                                               \
  } /* releasing this is a no-op */

void vg_cgns_store_release(struct vg_cgns_store *s);

/** Copy n bytes starting at `at`; bytes never written are zero. */
void vg_cgns_store_get(const struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       void *to);

/** Write n bytes. If there is not enough memory they are lost, and `failed` is
 * set. */
void vg_cgns_store_put(struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       const void *from);

#endif
