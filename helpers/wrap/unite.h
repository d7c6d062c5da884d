/* SPDX-License-Identifier: GPL-3.0-or-later */
/* helpers/wrap/unite.h: union of closed shells by exact arithmetic. */
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

#endif
