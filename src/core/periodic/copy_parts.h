/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/periodic/copy_parts.h: parts of copy.h. Private to core/periodic. */
#ifndef VG_CORE_PERIODIC_COPY_PARTS_H
#define VG_CORE_PERIODIC_COPY_PARTS_H

#include "core/periodic/copy.h"

/* The borders of the patch (side 0) and of its image (side 1). They are
 * followed in the direction of the half-edges of the patch, and of those of the
 * other triangles at the image, so that both directions correspond. */
struct vg_borders {
  const struct vg_mesh *m;
  const struct vg_periodic *p;
  uint32_t *next[2];   /* [n_point] next point of the border; VG_PERIODIC_NONE:
                          the point is not on it */
  uint8_t *corner[2];  /* [n_point] */
  uint32_t *to, *from; /* [n_point] point of the other border that corresponds,
                          of side 0 and of side 1; VG_PERIODIC_NONE: none */
};

/* A point of the second border as it will be: of the image of `a`, of the
 * present point b, or of both. VG_PERIODIC_NONE: not of it. */
struct vg_border_point {
  uint32_t a, b;
};

/* The borders as they will be: each piece begins and ends with a point of
 * both. */
struct vg_border_pieces {
  size_t n, n_piece, cap, cap_piece;
  struct vg_border_point *point; /* [n] owned */
  size_t *end;                   /* [n_piece] owned: index after its points */
};

/** Finds borders and corners. VG_ERR_GEOMETRY: a border touches itself or is
 * on an edge of more than two triangles. */
vg_status vg_borders_find(const struct vg_mesh *m, const struct vg_periodic *p,
                          struct vg_borders *b, struct vg_error *err);

/** Pairs the corners of both borders; points on both are their own partners.
 *
 * @param is_strict  VG_ERR_GEOMETRY if a corner has no partner within
 *                   `tolerance`; else such corners have none */
vg_status vg_borders_pair(struct vg_borders *b, double tolerance, int is_strict,
                          struct vg_error *err);

/** Divides the borders between paired points. VG_ERR_GEOMETRY: points do not
 * follow each other in the same order. */
vg_status vg_borders_divide(struct vg_borders *b, struct vg_border_pieces *out,
                            struct vg_error *err);

void vg_borders_release(struct vg_borders *b);

struct vg_strip_triangle {
  uint32_t point[3], patch, origin;
  uint32_t next[3]; /* next corner, 3 t + k, at the same point */
  int is_gone;
};

/* A triangulation whose triangles are changed one by one. */
struct vg_border_strip {
  size_t n_point, n_tri, cap_point, cap_tri, cap_head;
  double (*point)[3];
  uint32_t *head; /* [n_point] first corner at each point */
  struct vg_strip_triangle *tri;
};

/** Takes all triangles but those of the patch with index `without`. */
vg_status vg_strip_start(struct vg_border_strip *s, const struct vg_mesh *m,
                         uint32_t without, struct vg_error *err);

/** Puts a new point x into the edge from u to v; without a triangle there,
 * only the point is added. Its number is s->n_point - 1. */
vg_status vg_strip_insert(struct vg_border_strip *s, uint32_t u, uint32_t v,
                          const double x[3], struct vg_error *err);

/** Removes the point b of the border between l and r. Returns 1, or 0 if no
 * triangles without it are found. */
int vg_strip_remove(struct vg_border_strip *s, uint32_t l, uint32_t b,
                    uint32_t r);

void vg_strip_release(struct vg_border_strip *s);

#endif
