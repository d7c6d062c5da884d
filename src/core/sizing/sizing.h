/* core/sizing/sizing.h: target edge length in space. Uses base and
 * core/mesh/mesh.h.
 *
 * Two families of sources (formats.md 1.7; deck.md, "Table sources"):
 *   inverse square: VGRID's nodal and line sources,
 *     S(x) = sum(a_i S_i / r_i^2) / sum(a_i / r_i^2);
 *   bounded growth: h(d) = h0 inside the shape, h0 + (g - 1) d outside at
 *     distance d; the minimum over all sources.
 * The edges of the boundary triangulation are sources of the second family.
 * The field is S = min(VGRID's mean, bounded sources), lowered until its
 * gradient is at most (growth - 1); then, with size h_v at each point v of
 * the boundary and g the growth rate,
 *   min( min_v(h_v + (g-1) r_v), max( S, max_v(h_v - (g-1) r_v) ) ):
 * the size on the boundary is the boundary's own, since the cells must fit
 * it, and departs from there at the growth rate, upwards, or downwards to a
 * source that is finer than the boundary near it. Beyond 1.5 h_v it falls by
 * 0.5 r_v, if g is less than 1.5, so that sources have what they ask for three
 * lengths h_v away from any face. Sizes of the boundary that jump faster than
 * the growth rate are lowered likewise.
 * What is evaluated is an octree built from input alone: trilinear, within a
 * few per cent, continuous, its gradient bounded by vg_sizing_slope. */
#ifndef VG_CORE_SIZING_SIZING_H
#define VG_CORE_SIZING_SIZING_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "core/mesh/mesh.h"

enum vg_source_kind {
  VG_SOURCE_VGRID_NODE, /* at p0, spacing h0, weight a */
  VG_SOURCE_VGRID_LINE, /* p0 to p1, spacing h0 to h1, weight a */
  VG_SOURCE_POINT,      /* p0; h0 within radius r0 */
  VG_SOURCE_LINE,       /* segment p0 p1; h0 to h1, within radius r0 */
  VG_SOURCE_TRIANGLE,   /* p0 p1 p2; h0 within distance r0 */
  VG_SOURCE_BOX,        /* corners p0, p1 (axis-aligned); h0 inside */
  VG_SOURCE_SPHERE,     /* centre p0, radius r0; h0 inside */
  VG_SOURCE_CYLINDER    /* axis p0 p1, radii r0 at p0, r1 at p1 (a cone
                           where they differ); h0 to h1 along the axis */
};

struct vg_source {
  enum vg_source_kind kind;
  double p0[3], p1[3], p2[3];
  double h0, h1;        /* spacing, length unit of the input, > 0 */
  double r0, r1;        /* radii, >= 0 */
  double growth;        /* per-source growth rate > 1; 0: the global one */
  double an, bn, alpha; /* VGRID intensities; an > 0; bn, alpha as read */
  double stretch, sp0, sp1, u[3], p[3]; /* VGRID stretching data, as read */
  double layer0[3], layer1[3]; /* delta1 rate1 rate2 at p0 and p1 (grid=2) */
  char group[32];
};

/** Sizes from elsewhere, besides the sources and limited by the growth as they
 * are, but not scaled: a function of the place (a call-back), or samples
 * (sizing_map.h). */
struct vg_size_map {
  /* > 0, INFINITY: asks for nothing. Called by several threads at once; must
   * follow from x alone. */
  double (*at)(void *user, const double x[3]);
  /* A bound from below within the box lo..hi. NULL: none is known, and what is
   * smaller than a 32nd of the domain's box is found only where another size
   * is small. */
  double (*least)(void *user, const double lo[3], const double hi[3]);
  double most; /* the largest it asks for; 0: not known */
  void *user;
};

struct vg_sizing_options {
  double h_min;         /* no size below this; 0: none */
  double h_max;         /* no size above this; INFINITY: no limit; 0: within
                           a surface the largest one that the surface or a
                           source asks for, elsewhere no limit */
  double growth;        /* growth rate g > 1 of neighbouring edges away from
                           the surface; default 1.2 */
  double scale;         /* multiplies h_min, h_max, growth - 1 and, of every
                           source, spacing and growth - 1 (VGRID's ifact): a
                           similar field, but for what the surface says */
  int from_surface;     /* 1: boundary edges are sources (default) */
  int threads;          /* 0: one per core; default 1 */
  double coarseness;    /* >= 1: how much larger the finest cells of what is
                           evaluated are; default 1 */
  struct vg_team *team; /* that makes it together (base/team.h), or NULL */
  const struct vg_size_map *map; /* NULL: none; borrowed for the call */
};
#define VG_SIZING_OPTIONS_INIT                                                 \
  {                                                                            \
    0, 0, 1.2, 1, 1, 1, 1, NULL, NULL                                          \
  }

/** The growth rate of a field whose sizes are `scale` times as large. */
static inline double vg_scaled_growth(double growth, double scale)
{
  return 1 + scale * (growth - 1);
}

struct vg_sizing; /* opaque, read-only after vg_sizing_new */

/** Build the field over the bounding box of `surface` (and of the sources).
 *
 * @param surface  may be NULL or without triangles; borrowed for the call
 * @param n        sources, 0 allowed if there is a surface
 * @param out      owned by the caller, vg_sizing_free; untouched on failure
 * Returns VG_ERR_INPUT naming the source for non-finite data, spacing <= 0,
 * growth <= 1, a map that gives no size at some place, or when nothing defines
 * a size.
 * Result depends on the arguments only, bit by bit, and not on threads. */
vg_status vg_sizing_new(const struct vg_sizing_options *options, size_t n,
                        const struct vg_source *source,
                        const struct vg_mesh *surface, struct vg_sizing **out,
                        struct vg_error *err);

/** A field of its own: the sizes of another times a factor >= 1, but no more
 * than `most` has there. Cost: a copy, and an evaluation of `most` for each
 * corner of a leaf. VG_ERR_MEMORY. */
vg_status vg_sizing_coarsened(const struct vg_sizing *s, double factor,
                              const struct vg_sizing *most,
                              struct vg_sizing **out, struct vg_error *err);

/** Free a field; NULL is accepted. */
void vg_sizing_free(struct vg_sizing *s);

/** The field of the first rank of a node on all of its ranks, in one copy if
 * they can have memory in common (base/comm.h). Collective over the node.
 *
 * @param s  the field, or NULL on other ranks; replaced by the common one,
 *           which has the same values bit by bit. Untouched on failure */
vg_status vg_sizing_share(struct vg_comm *c, struct vg_sizing **s,
                          struct vg_error *err);

/** Show `look` all that a field's values follow from, part after part: bytes
 * that are the same where fields are. */
void vg_sizing_show(const struct vg_sizing *s,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user);

/** Bytes of it that the ranks of a node have in common. */
size_t vg_sizing_shmem(const struct vg_sizing *s);

/** Target edge length at x, > 0. Outside the root cube: that of the nearest
 * point of it, grown with the distance, up to h_max if one is given, or the
 * largest source if VGRID's are among them.
 * Threads: safe on a shared field. Cost: below 0.2 us. */
double vg_sizing_at(const struct vg_sizing *s, const double x[3]);

/** vg_sizing_at for n points. h out: [n]. */
void vg_sizing_eval(const struct vg_sizing *s, size_t n, const double (*x)[3],
                    double *h);

/** Least size within the cube lo, side, and a place x where it is had. Of a
 * cube that lies outside the root cube a lower bound, and the place there that
 * it grows from.
 * Threads: safe on a shared field. Cost: a few evaluations. */
double vg_sizing_least(const struct vg_sizing *s, const double lo[3],
                       double side, double x[3]);

/** Bounds of vg_sizing_at within the root cube, both attained. Cost O(1). */
void vg_sizing_range(const struct vg_sizing *s, double *h_min, double *h_max);

/** Bound on the gradient of vg_sizing_at, octree errors aside: growth - 1, or
 * 0.5 if that is more and faces hold sources back somewhere. */
double vg_sizing_slope(const struct vg_sizing *s);

/** growth - 1, scaled. */
double vg_sizing_growth(const struct vg_sizing *s);

/** What a boundary edge of length h asks for at least at a distance of d
 * (above): the bound from below, 0 where there is none. */
double vg_sizing_below(double growth, double h, double d);

/** The longest edge for which that is h at most. */
double vg_sizing_below_edge(double growth, double h, double d);

/** Leaves of the octree, 32 bytes and 5.1 of tree each. */
size_t vg_sizing_leaves(const struct vg_sizing *s);

/** The exact source law at x, clamped, without octree, surface or bound on
 * the gradient. Cost O(n) and an allocation. INFINITY when n is 0. */
double vg_sizing_sources_at(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, const double x[3]);

#endif
