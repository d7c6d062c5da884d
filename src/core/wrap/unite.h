/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wrap/unite.h: unites closed shells that cross, overlap or touch each
 * other, by exact arithmetic.
 *
 *      .--------.                    .--------.
 *      |  A .---|------.             |        '------.
 *      |    |   |   B  |     ->      |   A and B     |
 *      '----|---'      |             '----.          |
 *           '----------'                  '----------'
 *
 * The helper program vanguard-wrap contains the library (CGAL, corefinement:
 * Loriot, Rouxel-Labbe, Tournois, Yaz, "Polygon Mesh Processing"). Triangles
 * that shells cross are divided along the intersection; all others remain. New
 * points are rounded to double. Along an intersection, triangles may be
 * slivers, so that the surface should be remeshed. */
#ifndef VG_CORE_WRAP_UNITE_H
#define VG_CORE_WRAP_UNITE_H

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "core/surface/surface_check.h"

struct vg_unite_options {
  int subtracts; /* 1: from the largest shell of each set of shells that meet,
                    all others are subtracted: it bounds a fluid from outside.
                    0: all are united. */
  struct vg_stop stop;
};

struct vg_unite_report {
  size_t n_shell, n_set;    /* Shells that were united, and the number of sets
                               of shells that meet. */
  size_t n_before, n_after; /* Their triangles. */
  int is_ambiguous;         /* A shell is mostly inside another one that fills
                               most of its bounding box: the one around it may
                               be the wall of a tunnel or a room. */
  double at[3];             /* A point of the shell inside. */
  uint32_t inside, around;  /* Patches of both. */
};

/** Unite the shells of m that meet.
 *
 * @param m      triangles; patches keep their order, including those left
 *               without triangles. Points of different shells are no longer
 *               common. Untouched on failure
 * @param check  report on m (surface_check.h), with or without repair
 * @param r      set on success
 *
 * Returns VG_BLOCKED, with m unchanged, if no shells meet, if one of those that
 * do is open, not manifold or intersects itself, or if the surface of the union
 * is not a manifold. VG_ERR_UNSUPPORTED without vanguard-wrap; VG_ERR_GEOMETRY
 * if it crashes; VG_ERR_STOPPED, VG_ERR_MEMORY. One thread, about 10 us
 * per triangle. Re-entrant. */
vg_status vg_unite(struct vg_mesh *m, const struct vg_surface_report *check,
                   const struct vg_unite_options *o, struct vg_unite_report *r,
                   struct vg_error *err);

/** Divide the triangles of surfaces that may be open along the curves on which
 * these surfaces meet, by exact arithmetic; new points are rounded to double.
 *
 * @param m       triangles of walls, n_wall, and then of sheets. Sheets have no
 *                common points with each other and with the walls, but may have
 *                common places. No surface intersects itself
 * @param n_made  out: triangles of walls in the result, which come first
 *
 * Triangles keep their patches; patches keep their order. VG_BLOCKED, with m
 * unchanged: a surface is not a manifold. Otherwise errors and cost of
 * vg_unite. */
vg_status vg_imprint(struct vg_mesh *m, size_t n_wall,
                     const struct vg_stop *stop, size_t *n_made,
                     struct vg_error *err);

#endif
