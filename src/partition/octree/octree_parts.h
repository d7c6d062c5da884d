/* partition/octree/octree_parts.h: octants, the faces between them, and the
 * plane patches that faces between parts make up. Private to the module.
 *
 * Coordinates are whole numbers of the load's lattice (load_tree.h): a corner
 * of an octant is a double without error, and neighbours are found by them. */
#ifndef VG_PARTITION_OCTREE_OCTREE_PARTS_H
#define VG_PARTITION_OCTREE_OCTREE_PARTS_H

#include "partition/cut/decomposition.h"
#include "partition/load/load_tree.h"

struct vg_engine;

#define VG_OCTANT_NONE UINT32_MAX

enum {
  VG_OCTANT_OUT, /* no part of it is in the void */
  VG_OCTANT_GAP, /* the front passes, or is too close */
  VG_OCTANT_FREE /* in the void, off the front */
};

struct vg_octant {
  uint32_t at[3]; /* lower corner */
  uint32_t child; /* the first of eight; 0: a leaf */
  uint32_t id;    /* of a leaf that is not out: its part, in the end:
                     0 .. n_part - 1, then of the gap */
  uint8_t level, state;
  double reach; /* how far the front must be off; of others the
                   most of the leaves below */
};

/* The face that two leaves have in common: a side of the smaller one. */
struct vg_octant_face {
  uint32_t at[3], side; /* lower corner; length of its edges */
  uint8_t axis;         /* that it lies across */
  uint32_t leaf[2];     /* below, above */
};

struct vg_octants {
  double lo[3], unit;
  size_t n, cap;
  struct vg_octant *octant; /* [n] the first is the root */
  size_t n_leaf;
  uint32_t *leaf; /* [n_leaf] that are not out, in the order of the
                     tree */
  size_t n_face, cap_face;
  struct vg_octant_face *face; /* [n_face] between these */
  size_t n_part, n_gap;        /* numbers of ids */
  size_t n_apart;              /* of these parts: pieces that hang apart */
  double cells;                /* expected in the free ones */
  double elsewhere;            /* s of processor time in other processes */
};

static inline uint32_t vg_octant_side(const struct vg_octant *o)
{
  return (uint32_t)1 << (VG_LOAD_BITS - o->level);
}

/** Place of a whole number along an axis, exact. */
static inline double vg_octants_place(const struct vg_octants *t, int axis,
                                      uint32_t p)
{
  return t->lo[axis] + p * t->unit;
}

/** Octants no wider than `coarsening` times the least size in them, balanced
 * 2 : 1 over faces; those free that are off the front (octants.c). Then the
 * faces between them. *t is released by the caller also on failure.
 * VG_ERR_UNSUPPORTED beyond 16 M octants. VG_ERR_STOPPED: as asked. */
vg_status vg_octants_make(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_sizing *sizing, double coarsening,
                          const struct vg_engine *e, struct vg_octants *t,
                          struct vg_error *err);
void vg_octants_release(struct vg_octants *t);

/** Give leaves their ids: free ones about n_part times their share of `cells`,
 * all that are expected; parts hang together over faces. Free ones in places
 * with too few for a part join the gap, which is numbered by where it hangs
 * together (octants_part.c).
 * gap out: [v->n_face] the id of the gap that each triangle bounds. */
vg_status vg_octants_part(struct vg_octants *t, const struct vg_front *v,
                          const struct vg_sizing *sizing, double cells,
                          const struct vg_decomposition_options *o,
                          uint32_t *gap, struct vg_error *err);

/* Plane patches between two parts, bounded by straight curves. */
struct vg_patches {
  size_t n_corner;
  uint32_t (*corner)[3]; /* [n_corner] where curves end */
  size_t n_curve;
  struct vg_patch_curve {
    uint8_t axis;    /* that it runs along, upwards */
    uint32_t end[2]; /* corners */
  } * curve;         /* [n_curve] */
  size_t n;
  struct vg_plane_patch {
    uint8_t axis;   /* that it lies across */
    uint32_t at;    /* where */
    uint32_t id[2]; /* below, above */
  } * patch;        /* [n] */
  size_t *begin;    /* [n + 1] of the borders of each patch */
  uint32_t *border; /* [begin[n]] 2 curve + 1 where the patch is on
                       its right, seen from above */
};

/** Patches of the faces between leaves of different ids: those that hang
 * together in a plane, between the same two, are one. (squares.c) *p is
 * released by the caller also on failure. */
vg_status vg_patches_make(const struct vg_octants *t, struct vg_patches *p,
                          struct vg_error *err);
void vg_patches_release(struct vg_patches *p);

/* Patches, triangulated. */
struct vg_interfaces {
  size_t n_point;
  double (*x)[3];     /* [n_point] corners, of curves, inside */
  size_t *begin;      /* [patches + 1] of the triangles of each */
  uint32_t (*tri)[3]; /* [begin[patches]] seen from above
                         counter-clockwise */
};

/** Triangulate to the sizes, curves first. (patches.c) *out is released by the
 * caller also on failure. VG_ERR_STOPPED: as asked. */
vg_status vg_interfaces_make(const struct vg_octants *t,
                             const struct vg_patches *p,
                             const struct vg_sizing *sizing,
                             const struct vg_engine *e,
                             struct vg_interfaces *out, struct vg_error *err);
void vg_interfaces_release(struct vg_interfaces *i);

#endif
