/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/bytes.h: flat bytes for messages and records, written and read in
 * sequence, in this machine's byte order. Uses base/comm.h. */
#ifndef VG_BASE_BYTES_H
#define VG_BASE_BYTES_H

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/comm.h"
#include "base/memory.h"

struct vg_writer {
  struct vg_bytes bytes;
  size_t cap;
  int refused;
};

static inline void vg_put(struct vg_writer *w, size_t n, size_t size,
                          const void *data)
{
  size_t more = n * size;

  assert(data || !n || !size);
  if (w->refused || !more) return;
  if (vg_reserve(&w->bytes.data, &w->cap, w->bytes.n + more, 1)) {
    w->refused = 1;
    return;
  }
  memcpy(w->bytes.data + w->bytes.n, data, more);
  w->bytes.n += more;
}

struct vg_reader {
  const unsigned char *data;
  size_t n, at;
  int bad;
};

static inline void vg_get(struct vg_reader *r, size_t n, size_t size,
                          void *data)
{
  assert(r->at <= r->n || r->bad);
  assert(data || !n || !size);
  if (r->bad || (size && n > (r->n - r->at) / size)) {
    r->bad = 1;
    return;
  }
  if (n && size) memcpy(data, r->data + r->at, n * size);
  r->at += n * size;
}

/** Read an array of n items into new memory. Returns NULL and sets r->bad if
 * the message does not contain that many. */
static inline void *vg_get_array(struct vg_reader *r, size_t n, size_t size)
{
  void *a;

  assert(r->at <= r->n || r->bad);
  if (r->bad || (size && n > (r->n - r->at) / size) ||
      !(a = vg_alloc(n, size))) {
    r->bad = 1;
    return NULL;
  }
  vg_get(r, n, size, a);
  return a;
}

/** VG_ERR_FORMAT: the data read are inconsistent, or do not fit into memory. */
static inline vg_status vg_fail_damaged(struct vg_error *err, const char *what)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "a damaged message (%s), or one too large for the "
                 "available memory",
                 what);
}

#endif
