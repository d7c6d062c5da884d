/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Collapse of edges that are too short to be useful. Curves that end in a cusp
 * are divided indefinitely there, since their direction changes at every
 * scale. */
#include "io/occt/occt_parts.h"

#include <algorithm>

#include <gp_Vec.hxx>

namespace vg_occt
{

namespace
{

const int most_passes = 10;
/* Squared cosine of the largest rotation of a triangle: 60 degrees. */
const double most_turn = 0.25; /* S51 */

struct Short {
  double length2;
  uint32_t a, b; /* a < b */
};

bool before(const Short &x, const Short &y)
{
  if (x.length2 != y.length2) return x.length2 < y.length2;
  return x.a != y.a ? x.a < y.a : x.b < y.b;
}

/* Remove the items, of `width` values each, that are marked as gone. */
template <class T>
void keep(std::vector<T> &list, size_t width, const std::vector<bool> &gone)
{
  size_t n = 0;

  for (size_t i = 0; i < gone.size(); i++) {
    if (gone[i]) continue;
    std::copy_n(list.begin() + static_cast<ptrdiff_t>(width * i), width,
                list.begin() + static_cast<ptrdiff_t>(width * n++));
  }
  list.resize(width * n);
}

class Collapse
{
public:
  Collapse(Surface &s, double least) : s_(s), least2_(least * least)
  {
  }

  bool has_short()
  {
    return !list().empty();
  }

  void run()
  {
    dead_.assign(s_.face.size(), false);
    of_.assign(s_.point.size() / 3, {});
    near_.assign(of_.size(), {});
    for (size_t t = 0; t < s_.face.size(); t++)
      for (int k = 0; k < 3; k++) of_[s_.tri[3 * t + k]].push_back(t);
    for (size_t i = 0; i < s_.curve.size(); i++)
      for (int k = 0; k < 2; k++) near_[s_.segment[2 * i + k]].push_back(i);
    for (int i = 0; i < most_passes && pass(); i++) {
    }
    sweep();
  }

private:
  gp_Pnt at(uint32_t p) const
  {
    return gp_Pnt(s_.point[3 * p], s_.point[3 * p + 1], s_.point[3 * p + 2]);
  }

  /* Short edges, sorted by length; some may belong to dead triangles. */
  std::vector<Short> list() const
  {
    std::vector<Short> out;

    for (size_t t = 0; t < s_.face.size(); t++)
      for (int k = 0; k < 3; k++) {
        uint32_t a = s_.tri[3 * t + k], b = s_.tri[3 * t + (k + 1) % 3];
        double d = at(a).SquareDistance(at(b));

        if (d < least2_ && a != b)
          out.push_back({ d, std::min(a, b), std::max(a, b) });
      }
    std::sort(out.begin(), out.end(), before);
    out.erase(std::unique(out.begin(), out.end(),
                          [](const Short &x, const Short &y) {
                            return x.a == y.a && x.b == y.b;
                          }),
              out.end());
    return out;
  }

  bool pass()
  {
    bool any = false;

    for (const Short &e : list()) {
      if (of_[e.a].empty() || of_[e.b].empty()) continue;
      if (can_go(e.b, e.a)) any = merge(e.b, e.a) || any;
      else if (can_go(e.a, e.b)) any = merge(e.a, e.b) || any;
    }
    return any;
  }

  /* May a point move to another? A point of a curve moves along its curve only,
   * a point of a face anywhere. */
  bool can_go(uint32_t gone, uint32_t to) const
  {
    if (s_.corner[gone]) return false;
    if (near_[gone].empty()) return true;
    return std::any_of(near_[gone].begin(), near_[gone].end(), [&](size_t i) {
      return s_.segment[2 * i] == to || s_.segment[2 * i + 1] == to;
    });
  }

  bool has(size_t t, uint32_t p) const
  {
    const uint32_t *v = &s_.tri[3 * t];

    return v[0] == p || v[1] == p || v[2] == p;
  }

  /* Points that share a triangle with p. */
  std::vector<uint32_t> around(uint32_t p) const
  {
    std::vector<uint32_t> out;

    for (size_t t : of_[p])
      for (int k = 0; k < 3; k++)
        if (s_.tri[3 * t + k] != p) out.push_back(s_.tri[3 * t + k]);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  /* Is every common neighbour of both points the third vertex of a triangle of
   * the edge? */
  bool keeps_topology(uint32_t gone, uint32_t to) const
  {
    std::vector<uint32_t> a = around(gone), b = around(to), both, third;

    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(),
                          std::back_inserter(both));
    for (size_t t : of_[gone])
      for (int k = 0; k < 3 && has(t, to); k++)
        if (s_.tri[3 * t + k] != gone && s_.tri[3 * t + k] != to)
          third.push_back(s_.tri[3 * t + k]);
    std::sort(third.begin(), third.end());
    third.erase(std::unique(third.begin(), third.end()), third.end());
    return both == third && !third.empty();
  }

  gp_Vec normal(const uint32_t *v) const
  {
    return gp_Vec(at(v[0]), at(v[1])).Crossed(gp_Vec(at(v[0]), at(v[2])));
  }

  bool turns_none(uint32_t gone, uint32_t to) const
  {
    for (size_t t : of_[gone]) {
      uint32_t v[3];

      if (has(t, to)) continue;
      std::copy(&s_.tri[3 * t], &s_.tri[3 * t] + 3, v);
      gp_Vec was = normal(v);
      std::replace(v, v + 3, gone, to);
      gp_Vec is = normal(v);
      double dot = is * was;
      if (!(dot > 0 && dot * dot >= most_turn * is.SquareMagnitude() *
                                      was.SquareMagnitude()))
        return false;
    }
    return true;
  }

  bool merge(uint32_t gone, uint32_t to)
  {
    if (!keeps_topology(gone, to) || !turns_none(gone, to)) return false;
    for (size_t t : of_[gone])
      if (!has(t, to)) move_corner(t, gone, to);
    for (size_t t : of_[gone]) {
      if (!has(t, to)) {
        std::replace(&s_.tri[3 * t], &s_.tri[3 * t] + 3, gone, to);
        of_[to].push_back(t);
      } else if (!dead_[t]) {
        kill(t, gone);
      }
    }
    of_[gone].clear();
    move_segments(gone, to);
    return true;
  }

  void kill(size_t t, uint32_t gone)
  {
    dead_[t] = true;
    for (int k = 0; k < 3; k++) {
      std::vector<size_t> &of = of_[s_.tri[3 * t + k]];

      if (s_.tri[3 * t + k] != gone)
        of.erase(std::find(of.begin(), of.end(), t));
    }
  }

  /* Set the parameters of a vertex to those of `to` that are nearest to the old
   * ones, since a point on a seam has two. */
  void move_corner(size_t t, uint32_t gone, uint32_t to)
  {
    size_t k = 3 * t;
    double best = -1;
    gp_Pnt2d was;

    while (s_.tri[k] != gone) k++;
    was = s_.uv[k];
    for (size_t other : of_[to])
      for (size_t j = 3 * other; j < 3 * other + 3; j++) {
        if (s_.piece[other] != s_.piece[t] || s_.tri[j] != to) continue;
        double d = was.SquareDistance(s_.uv[j]);

        if (best >= 0 && d >= best) continue;
        best = d;
        s_.uv[k] = s_.uv[j];
      }
  }

  void move_segments(uint32_t gone, uint32_t to)
  {
    for (size_t i : near_[gone]) {
      std::replace(&s_.segment[2 * i], &s_.segment[2 * i] + 2, gone, to);
      near_[to].push_back(i);
    }
    near_[gone].clear();
  }

  /* Remove dead triangles, segments without length, and unused points. */
  void sweep()
  {
    std::vector<bool> no_length(s_.curve.size());

    for (size_t i = 0; i < no_length.size(); i++)
      no_length[i] = s_.segment[2 * i] == s_.segment[2 * i + 1];
    keep(s_.segment, 2, no_length);
    keep(s_.curve, 1, no_length);
    keep(s_.tri, 3, dead_);
    keep(s_.uv, 3, dead_);
    keep(s_.face, 1, dead_);
    keep(s_.patch, 1, dead_);
    keep(s_.piece, 1, dead_);
    drop_unused(s_);
  }

  Surface &s_;
  double least2_;
  std::vector<bool> dead_;
  std::vector<std::vector<size_t>> of_;   /* triangles of each point */
  std::vector<std::vector<size_t>> near_; /* segments of each point */
};

} // namespace

void drop_unused(Surface &s)
{
  std::vector<bool> unused(s.point.size() / 3, true);
  std::vector<uint32_t> number(unused.size());
  uint32_t n = 0;

  for (uint32_t p : s.tri) unused[p] = false;
  for (uint32_t p : s.segment) unused[p] = false;
  for (size_t p = 0; p < unused.size(); p++)
    if (!unused[p]) number[p] = n++;
  keep(s.point, 3, unused);
  keep(s.corner, 1, unused);
  for (uint32_t &p : s.tri) p = number[p];
  for (uint32_t &p : s.segment) p = number[p];
}

void collapse_short(Surface &s, double least)
{
  Collapse all(s, least);

  if (!all.has_short()) return;
  all.run();
}

} // namespace vg_occt
