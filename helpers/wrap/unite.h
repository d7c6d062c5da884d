/* SPDX-License-Identifier: GPL-3.0-or-later */
/* helpers/wrap/unite.h: union of closed shells, and common curves of surfaces,
 * by exact arithmetic. */
#ifndef VG_HELPERS_WRAP_UNITE_H
#define VG_HELPERS_WRAP_UNITE_H

#include <cstdint>
#include <vector>

#include "common/serve.h"

struct vg_united {
  std::vector<double> x;      /* [n_point][3] rounded to double */
  std::vector<uint32_t> tri;  /* [n_tri][3] */
  std::vector<uint32_t> from; /* [n_tri] triangle of the input that contains the
                                 triangle */
};

/* Unite the shells of s. A shell is a set of triangles connected by points;
 * each is closed, points outwards and does not intersect itself. With
 * `subtract`, all shells but that of the first triangle are united and
 * subtracted from it. Throws std::runtime_error if a shell is open or the
 * surface of the union is not a manifold. Intersections of a shell with itself
 * are not detected. */
vg_united vg_unite(const vg_serve_surface &s, bool subtract);

/* Divide the triangles of s along the curves on which surfaces meet: the walls,
 * which are the first n_wall triangles, and the sheets, sets of other triangles
 * connected by points. Surfaces have no common points, may be open, and do not
 * intersect themselves. Triangles of the walls come first in the result. Throws
 * std::runtime_error if a surface is not a manifold. */
vg_united vg_imprint(const vg_serve_surface &s, size_t n_wall);

#endif
