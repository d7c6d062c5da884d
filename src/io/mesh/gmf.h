/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/gmf.h: parts shared by Medit's mesh and solution files (the GMF of
 * libMeshb): version, dimension, keywords. Private to io/mesh. */
#ifndef VG_IO_MESH_GMF_H
#define VG_IO_MESH_GMF_H

#include "io/stream/stream.h"

struct vg_gmf {
  struct vg_input *in;
  int binary, version; /* version: 1 to 4 */
  int dimension;       /* 0: not read yet */
};

/** Codes of keywords that are not in the tables of sections. */
enum { VG_GMF_DIMENSION = 3, VG_GMF_END = 54 };

/** Begin reading: determine whether the file is text or binary, its byte order
 * and its version. The caller sets g->in; all other members are set here.
 * VG_ERR_FORMAT. */
vg_status vg_gmf_open(struct vg_gmf *g, struct vg_error *err);

/** Fail with VG_ERR_FORMAT and a message with the text and the position, a line
 * or a byte. */
vg_status vg_gmf_fail(const struct vg_gmf *g, struct vg_error *err,
                      const char *text);

/** Read the dimension, which follows its keyword; VG_ERR_UNSUPPORTED: 2. */
vg_status vg_gmf_read_dimension(struct vg_gmf *g, struct vg_error *err);

/** Read n integers of the file's size, 8 bytes from version 4 on; at most
 * VG_GMF_INTS per call. */
#define VG_GMF_INTS 9
vg_status vg_gmf_ints(struct vg_gmf *g, size_t n, int64_t *v, const char *what,
                      struct vg_error *err);

/** In a binary file, read the code of the next keyword and the position of the
 * keyword after that, or 0. Positions must increase, otherwise reading a
 * damaged file might never end. */
vg_status vg_gmf_keyword(struct vg_gmf *g, int32_t *code, size_t *next,
                         struct vg_error *err);

#endif
