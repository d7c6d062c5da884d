/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/octree/octree_parts.h: octants, the faces between them, and the
 * plane patches that faces between subdomains form. Private to the module.
 *
 * Coordinates are integers of the load's lattice (load_tree.h). A corner of an
 * octant is therefore an exact double, and neighbours are found by their
 * coordinates. */
#ifndef VG_PARTITION_OCTREE_OCTREE_PARTS_H
#define VG_PARTITION_OCTREE_OCTREE_PARTS_H

#include "partition/cut/decomposition.h"
#include "partition/load/load_tree.h"

struct vg_engine;

#define VG_OCTANT_NONE UINT32_MAX

enum {
  VG_OCTANT_OUT, /* completely outside the void */
  VG_OCTANT_GAP, /* the front passes through it or is too close */
  VG_OCTANT_FREE /* in the void, away from the front */
};

struct vg_octant {
  uint32_t at[3]; /* Lower corner. */
  uint32_t child; /* Index of the first of eight children; 0: a leaf. */
  uint32_t id;    /* Subdomain of a leaf that is not out: 0 .. n_part - 1,
                     then those of the gap region. */
  uint8_t level, state;
  double reach; /* Required distance of the front; of inner nodes the maximum
                   of the leaves below. */
};

/* Face that two leaves share: a side of the smaller one. */
struct vg_octant_face {
  uint32_t at[3], side; /* Lower corner; edge length. */
  uint8_t axis;         /* Normal axis. */
  uint32_t leaf[2];     /* Leaf below, leaf above. */
};

struct vg_octants {
  double lo[3], unit;
  size_t n, cap;
  struct vg_octant *octant; /* [n] The first one is the root. */
  size_t n_leaf;
  uint32_t *leaf; /* [n_leaf] Leaves that are not out, in octree order. */
  size_t n_face, cap_face;
  struct vg_octant_face *face; /* [n_face] Faces between these leaves. */
  size_t n_part, n_gap;        /* Numbers of subdomains. */
  size_t n_apart;       /* Those of n_part made from disconnected components. */
  double cells;         /* Cells expected in the free octants. */
  double other_seconds; /* Processor time in s of other processes. */
};

static inline uint32_t vg_octant_side(const struct vg_octant *o)
{
  return (uint32_t)1 << (VG_LOAD_BITS - o->level);
}

/** Position of an integer coordinate along an axis, exact. */
static inline double vg_octants_place(const struct vg_octants *t, int axis,
                                      uint32_t p)
{
  return t->lo[axis] + p * t->unit;
}

/** Makes octants no wider than `coarsening` times the smallest size in them,
 * balanced 2 : 1 across faces, and marks as free those that are away from the
 * front (octants.c). Then lists the faces between them. The caller releases *t
 * also on failure. VG_ERR_UNSUPPORTED beyond 16 M octants. VG_ERR_STOPPED: on
 * request. */
vg_status vg_octants_make(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_sizing *sizing, double coarsening,
                          const struct vg_engine *e, struct vg_octants *t,
                          struct vg_error *err);
void vg_octants_release(struct vg_octants *t);

/** Assigns ids to leaves. The free leaves get about n_part times their share
 * of `cells`, all expected cells; subdomains are connected across faces.
 * Free components with too few cells for a subdomain join the gap region,
 * which is numbered by connected component (octants_part.c).
 * gap out: [v->n_face] the id of the gap component that each triangle
 * bounds. */
vg_status vg_octants_part(struct vg_octants *t, const struct vg_front *v,
                          const struct vg_sizing *sizing, double cells,
                          const struct vg_decomposition_options *o,
                          uint32_t *gap, struct vg_error *err);

/* Plane patches between two subdomains, bounded by straight curves. */
struct vg_patches {
  size_t n_corner;
  uint32_t (*corner)[3]; /* [n_corner] Ends of curves. */
  size_t n_curve;
  struct vg_patch_curve {
    uint8_t axis;    /* Direction, upwards. */
    uint32_t end[2]; /* Corners at both ends. */
  } * curve;         /* [n_curve] */
  size_t n;
  struct vg_plane_patch {
    uint8_t axis;   /* Normal axis. */
    uint32_t at;    /* Position along the axis. */
    uint32_t id[2]; /* Subdomain below, subdomain above. */
  } * patch;        /* [n] */
  size_t *begin;    /* [n + 1] First border entry of each patch. */
  uint32_t *border; /* [begin[n]] 2 curve + 1 if the patch is to the right of
                       the curve, seen from above. */
};

/** Makes patches from the faces between leaves of different ids: faces that are
 * connected in a plane, between the same two subdomains, form one patch.
 * (squares.c) The caller releases *p also on failure. */
vg_status vg_patches_make(const struct vg_octants *t, struct vg_patches *p,
                          struct vg_error *err);
void vg_patches_release(struct vg_patches *p);

/* Triangulated patches. */
struct vg_interfaces {
  size_t n_point;
  double (*x)[3];     /* [n_point] Corners, points on curves, inner points. */
  size_t *begin;      /* [patches + 1] First triangle of each patch. */
  uint32_t (*tri)[3]; /* [begin[patches]] Counter-clockwise seen from above. */
};

/** Triangulates to the sizes, curves first. (patches.c) The caller releases
 * *out also on failure. VG_ERR_STOPPED: on request. */
vg_status vg_interfaces_make(const struct vg_octants *t,
                             const struct vg_patches *p,
                             const struct vg_sizing *sizing,
                             const struct vg_engine *e,
                             struct vg_interfaces *out, struct vg_error *err);
void vg_interfaces_release(struct vg_interfaces *i);

#endif
