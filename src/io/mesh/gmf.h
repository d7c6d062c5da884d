/* io/mesh/gmf.h: what Medit's meshes and solutions (the GMF of libMeshb) have
 * in common: version, dimension, keywords. Private to io/mesh. */
#ifndef VG_IO_MESH_GMF_H
#define VG_IO_MESH_GMF_H

#include "io/stream/stream.h"

struct vg_gmf {
  struct vg_input *in;
  int binary, version; /* version: 1 to 4 */
  int dimension;       /* 0: not seen yet */
};

/** Codes of keywords outside the tables of sections. */
enum { VG_GMF_DIMENSION = 3, VG_GMF_END = 54 };

/** Begin: byte order, or text, and the version. g->in is given, all else is
 * set. VG_ERR_FORMAT. */
vg_status vg_gmf_open(struct vg_gmf *g, struct vg_error *err);

/** VG_ERR_FORMAT with the text and the place, a line or a byte. */
vg_status vg_gmf_fail(const struct vg_gmf *g, struct vg_error *err,
                      const char *text);

/** The dimension, behind its keyword; VG_ERR_UNSUPPORTED: 2. */
vg_status vg_gmf_read_dimension(struct vg_gmf *g, struct vg_error *err);

/** n whole numbers of the file's width, 8 bytes from version 4 on; at most
 * VG_GMF_INTS at once. */
#define VG_GMF_INTS 9
vg_status vg_gmf_ints(struct vg_gmf *g, size_t n, int64_t *v, const char *what,
                      struct vg_error *err);

/** Binary: code of the next keyword and where the one behind it starts, 0:
 * nowhere. Positions advance, or a damaged file could be read for ever. */
vg_status vg_gmf_keyword(struct vg_gmf *g, int32_t *code, size_t *next,
                         struct vg_error *err);

#endif
