/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repair of triangles whose three points are collinear. Open CASCADE
 * triangulates in the parameter plane. On cones, cylinders and ruled faces, the
 * points of one generator are collinear there as well; triangles between them
 * have no area, or overlap by rounding. Swapping the edge between such a cap
 * and its neighbour in the same face moves no point. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>

#include <gp_Vec.hxx>

namespace vg_occt
{

namespace
{

/* Triangles with a smaller ratio of height to longest edge are treated; a swap
 * must improve it by the factor `gain`. */
const double flat = 1e-3, gain = 2; /* S14 */
/* A ratio below this is only rounding. */
const double straight = 1e-9;
const int most_passes = 20;

struct Edge {
  uint32_t a, b; /* a < b */
  size_t tri;
  int side; /* opposite this vertex */
};

bool before(const Edge &e, const Edge &f)
{
  return e.a != f.a ? e.a < f.a : e.b != f.b ? e.b < f.b : e.tri < f.tri;
}

class Caps
{
public:
  Caps(const std::vector<double> &x, uint32_t *tri, gp_Pnt2d *uv, size_t n)
      : x_(x), tri_(tri), uv_(uv), n_(n)
  {
  }

  bool pass()
  {
    bool any = false;

    list_edges();
    touched_.assign(n_, false);
    for (size_t t = 0; t < n_; t++) {
      int side = 0;

      if (!touched_[t] && height(tri_ + 3 * t, &side) < flat)
        any = swap(t, side) || any;
    }
    return any;
  }

private:
  gp_Pnt at(uint32_t p) const
  {
    return gp_Pnt(x_[3 * p], x_[3 * p + 1], x_[3 * p + 2]);
  }

  gp_Vec normal(const uint32_t *v) const
  {
    return gp_Vec(at(v[0]), at(v[1])).Crossed(gp_Vec(at(v[0]), at(v[2])));
  }

  /* Ratio of height to longest edge, which is opposite vertex *side. */
  double height(const uint32_t *v, int *side) const
  {
    double longest = 0;

    for (int k = 0; k < 3; k++) {
      double d = at(v[(k + 1) % 3]).SquareDistance(at(v[(k + 2) % 3]));

      if (d > longest) {
        longest = d;
        *side = k;
      }
    }
    return longest > 0 ? normal(v).Magnitude() / longest : 0;
  }

  void list_edges()
  {
    edges_.clear();
    for (size_t t = 0; t < n_; t++)
      for (int k = 0; k < 3; k++) {
        uint32_t a = tri_[3 * t + (k + 1) % 3], b = tri_[3 * t + (k + 2) % 3];

        edges_.push_back({ std::min(a, b), std::max(a, b), t, k });
      }
    std::sort(edges_.begin(), edges_.end(), before);
  }

  /* First entry of an edge; further entries of the edge follow. */
  std::vector<Edge>::const_iterator find(uint32_t a, uint32_t b) const
  {
    return std::lower_bound(edges_.begin(), edges_.end(),
                            Edge{ std::min(a, b), std::max(a, b), 0, 0 },
                            before);
  }

  bool has(uint32_t a, uint32_t b) const
  {
    auto e = find(a, b);

    return e != edges_.end() && e->a == std::min(a, b) &&
           e->b == std::max(a, b);
  }

  const Edge *across(size_t t, uint32_t a, uint32_t b) const
  {
    const Edge *other = nullptr;
    size_t n = 0;

    for (auto e = find(a, b);
         e != edges_.end() && e->a == std::min(a, b) && e->b == std::max(a, b);
         ++e, ++n)
      if (e->tri != t) other = &*e;
    return n == 2 ? other : nullptr;
  }

  /* A swap is useful if the smaller height of the new triangles exceeds that of
   * t by the factor `gain` and neither is inverted. If all four points are
   * collinear, it is useful if the new edge is shorter: in this way a cap moves
   * on until its neighbour has an area. */
  bool is_better(const uint32_t *v, const uint32_t *w, const uint32_t *first,
                 const uint32_t *second, double longest) const
  {
    int k = 0;
    double then = std::min(height(first, &k), height(second, &k));
    gp_Vec up = normal(w);

    if (height(w, &k) < straight)
      return at(first[0]).SquareDistance(at(first[2])) < longest;
    return then > gain * height(v, &k) && normal(first) * up > 0 &&
           normal(second) * up > 0;
  }

  /* Triangle t = (p a b) and its neighbour (q b a) become (p a q) and (p q
   * b). */
  bool swap(size_t t, int side)
  {
    uint32_t *v = tri_ + 3 * t;
    uint32_t p = v[side], a = v[(side + 1) % 3], b = v[(side + 2) % 3];
    const Edge *other = across(t, a, b);

    if (!other || touched_[other->tri]) return false;
    uint32_t *w = tri_ + 3 * other->tri, q = w[other->side];
    if (w[(other->side + 1) % 3] != b || p == q || has(p, q)) return false;
    const uint32_t first[3] = { p, a, q }, second[3] = { p, q, b };
    if (!is_better(v, w, first, second, at(a).SquareDistance(at(b))))
      return false;
    touched_[t] = touched_[other->tri] = true;
    std::copy(first, first + 3, v);
    std::copy(second, second + 3, w);
    swap_places(t, side, other->tri, other->side);
    return true;
  }

  void swap_places(size_t t, int side, size_t other, int across)
  {
    gp_Pnt2d *v = uv_ + 3 * t, *w = uv_ + 3 * other;
    const gp_Pnt2d p = v[side], a = v[(side + 1) % 3], b = v[(side + 2) % 3];
    const gp_Pnt2d q = w[across];

    v[0] = p;
    v[1] = a;
    v[2] = q;
    w[0] = p;
    w[1] = q;
    w[2] = b;
  }

  const std::vector<double> &x_;
  uint32_t *tri_;
  gp_Pnt2d *uv_; /* parameters of their vertices */
  size_t n_;
  std::vector<Edge> edges_;
  std::vector<bool> touched_;
};

} // namespace

void swap_caps(Surface &s, size_t from)
{
  Caps caps(s.point, s.tri.data() + 3 * from, s.uv.data() + 3 * from,
            s.tri.size() / 3 - from);

  for (int k = 0; k < most_passes && caps.pass(); k++) {
  }
}

} // namespace vg_occt
