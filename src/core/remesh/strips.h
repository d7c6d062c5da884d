/* core/remesh/strips.h: strips of a surface between two lines that are close,
 * and the closing of those that are narrower than the tolerance, in which no
 * triangle but needles could be. Private to core/remesh. */
#ifndef VG_CORE_REMESH_STRIPS_H
#define VG_CORE_REMESH_STRIPS_H

#include "core/remesh/curves.h"

/* Where a walk across a strip ends. */
struct vg_strip_end {
  uint32_t half; /* half-edge of the other line, in the strip */
  double x[3];
};

/** Width of the surface from the point x of line h, straight across its
 * triangle, to another line nearly along it; INFINITY beyond `most` or where
 * there is none. *end: of lines of all directions; may be NULL. */
double vg_strip_width(const struct vg_ref *r, const struct vg_curves *c,
                      uint32_t h, const double x[3], double most,
                      struct vg_strip_end *end);

struct vg_strips_options {
  double tolerance;     /* narrower strips are closed */
  const double *across; /* [n_patch] where not NULL and above 1, strips
                           stay */
  const struct vg_curves_options *lines;
};

/* The surface as it was, with points more where strips begin to be narrow.
 * New points and triangles come last. */
struct vg_strips {
  size_t n;             /* pieces of lines that are closed; 0: the rest is
                           empty */
  double length;        /* of them all */
  double widest, at[3]; /* width of a strip, and where it is */
  struct vg_mesh mesh;
  uint8_t *closed;     /* [3 mesh.n_tri] half-edges of them, both sides */
  uint32_t *tri_from;  /* [mesh.n_tri] triangle that it is a part of */
  uint32_t *half_from; /* [3 mesh.n_tri] half-edge, the same;
                          VG_REF_NONE: new, within a triangle */
  size_t n_new;
  uint32_t (*ends)[2]; /* [n_new] of the edge in which a new point is;
                          they may be new themselves, but before it */
};
#define VG_STRIPS_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

/** Of two lines that are so close that the tolerance hides what is between
 * them only one needs to stay: the longer one, and rims and hard borders
 * always. m is what the faces of r are; neither tree nor sizes are asked for.
 * O(length of lines). VG_ERR_MEMORY. */
vg_status vg_strips_find(const struct vg_ref *r, const struct vg_curves *c,
                         const struct vg_mesh *m,
                         const struct vg_strips_options *o, struct vg_strips *s,
                         struct vg_error *err);

void vg_strips_release(struct vg_strips *s);

#endif
