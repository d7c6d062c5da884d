/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repair of triangles that do not follow their face.
 *
 * A triangle of a curved face whose vertices are all on the rim lies in the
 * plane of the rim. If the neighbouring face is a plane cap, or also has such a
 * triangle, the two overlap. Near a cusp, points of the face lie beyond the
 * chord of its rim, so that triangles fold. Swapping an edge, inserting a point
 * of the face, or removing one repairs both. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>

#include <BRepAdaptor_Surface.hxx>
#include <gp_Vec.hxx>

namespace vg_occt
{

namespace
{

/* Squared cosines of the largest angle between a triangle and its face: if all
 * vertices are on the rim, 1 degree if one neighbouring face has all three,
 * else 30 degrees; for other triangles 60 degrees. */
const double near_cap = 0.9996954, near_rim = 0.75, near_face = 0.25; /* S53 */
/* distance from an edge into the face */
const double pull[] = { 0, 0.25, 0.5, 0.75 };
/* A triangle with a smaller ratio of height to longest edge is useless. */
const double flat = 1e-7;
const int most_passes = 20;
/* A face that needs more changes than this is damaged and left unchanged. */
const int most_changes = 2000;

struct Corner {
  uint32_t p;
  gp_Pnt2d uv;
};

struct Tri {
  Corner v[3];
  bool is_touched, is_suspect, was_suspect, is_dead;

  Tri()
      : is_touched(false), is_suspect(false), was_suspect(false), is_dead(false)
  {
  }
  Tri(const Corner &a, const Corner &b, const Corner &c)
      : v{ a, b, c }, is_touched(true), is_suspect(true), was_suspect(true),
        is_dead(false)
  {
  }
  int corner(uint32_t p) const
  {
    for (int k = 0; k < 3; k++)
      if (v[k].p == p) return k;
    return -1;
  }
};

struct Side {
  uint32_t a, b; /* a < b */
  size_t tri;
  int corner; /* opposite the edge */
};

bool before(const Side &x, const Side &y)
{
  if (x.a != y.a) return x.a < y.a;
  return x.b != y.b ? x.b < y.b : x.tri < y.tri;
}

/* The triangles of one face. */
class Patch
{
public:
  Patch(Surface &s, const std::vector<std::vector<uint32_t>> &pieces,
        const Face &face, uint32_t piece)
      : s_(s), pieces_(pieces), piece_(piece), surface_(face.shape),
        is_reversed_(face.shape.Orientation() == TopAbs_REVERSED)
  {
  }

  void add(size_t t)
  {
    Tri tri;

    for (int k = 0; k < 3; k++)
      tri.v[k] = { s_.tri[3 * t + k], s_.uv[3 * t + k] };
    tri_.push_back(tri);
  }

  /* Returns true if any triangle was changed. */
  bool run()
  {
    list_sides();
    find_suspects();
    for (int i = 0; i < most_passes && pass(); i++) list_sides();
    return n_changes_ > 0;
  }

  const std::vector<Tri> &triangles() const
  {
    return tri_;
  }

private:
  gp_Pnt at(uint32_t p) const
  {
    return gp_Pnt(s_.point[3 * p], s_.point[3 * p + 1], s_.point[3 * p + 2]);
  }

  gp_Vec normal(const Tri &t) const
  {
    gp_Pnt a = at(t.v[0].p);

    return gp_Vec(a, at(t.v[1].p)).Crossed(gp_Vec(a, at(t.v[2].p)));
  }

  gp_Vec normal_of_face(const Tri &t) const
  {
    gp_XY uv = (t.v[0].uv.XY() + t.v[1].uv.XY() + t.v[2].uv.XY()) / 3;
    gp_Pnt p;
    gp_Vec du, dv;

    surface_.D1(uv.X(), uv.Y(), p, du, dv);
    return is_reversed_ ? dv.Crossed(du) : du.Crossed(dv);
  }

  bool is_on_rim(uint32_t p) const
  {
    return p < pieces_.size() && !pieces_[p].empty();
  }

  /* Does another face have all three vertices? */
  bool has_neighbour(const Tri &t) const
  {
    for (uint32_t other : pieces_[t.v[0].p])
      if (other != piece_ && has(t.v[1].p, other) && has(t.v[2].p, other))
        return true;
    return false;
  }

  bool has(uint32_t p, uint32_t piece) const
  {
    return std::binary_search(pieces_[p].begin(), pieces_[p].end(), piece);
  }

  bool is_all_on_rim(const Tri &t) const
  {
    return is_on_rim(t.v[0].p) && is_on_rim(t.v[1].p) && is_on_rim(t.v[2].p);
  }

  bool is_bad(const Tri &t) const
  {
    gp_Vec n = normal(t), up = normal_of_face(t);
    double dot = n * up, most = near_face;

    if (is_all_on_rim(t)) most = has_neighbour(t) ? near_cap : near_rim;
    return dot < 0 ||
           dot * dot < most * n.SquareMagnitude() * up.SquareMagnitude();
  }

  /* An edge between two rim points that belong to two faces may also be an edge
   * of the other face. */
  bool may_be_double(uint32_t a, uint32_t b) const
  {
    if (!is_on_rim(a) || !is_on_rim(b)) return false;
    for (uint32_t other : pieces_[a])
      if (other != piece_ && has(b, other)) return true;
    return false;
  }

  /* Find triangles with all vertices on the rim, and those that fold; their
   * normals are compared with the face. */
  void find_suspects()
  {
    std::vector<gp_Vec> n;

    for (Tri &t : tri_) {
      n.push_back(normal(t));
      t.is_suspect = is_all_on_rim(t);
    }
    for (size_t i = 1; i < sides_.size(); i++) {
      const Side &x = sides_[i - 1], &y = sides_[i];

      if (x.a != y.a || x.b != y.b) continue;
      double dot = n[x.tri] * n[y.tri];
      if (dot >= 0 && dot * dot >= near_face * n[x.tri].SquareMagnitude() *
                                     n[y.tri].SquareMagnitude())
        continue;
      tri_[x.tri].is_suspect = tri_[y.tri].is_suspect = true;
    }
  }

  /* Is the triangle neither bad nor inverted nor degenerate? */
  bool is_good(const Tri &t) const
  {
    gp_Vec n = normal(t);
    double longest = 0;

    for (int k = 0; k < 3; k++)
      longest = std::max(longest,
                         at(t.v[k].p).SquareDistance(at(t.v[(k + 1) % 3].p)));
    return n.Magnitude() > flat * longest && n * normal_of_face(t) > 0 &&
           !is_bad(t);
  }

  bool all_good(const Tri *t, size_t n) const
  {
    return std::all_of(t, t + n, [this](const Tri &f) { return is_good(f); });
  }

  void list_sides()
  {
    sides_.clear();
    for (size_t t = 0; t < tri_.size(); t++)
      for (int k = 0; k < 3 && !tri_[t].is_dead; k++) {
        uint32_t a = tri_[t].v[(k + 1) % 3].p, b = tri_[t].v[(k + 2) % 3].p;

        sides_.push_back({ std::min(a, b), std::max(a, b), t, k });
      }
    std::sort(sides_.begin(), sides_.end(), before);
  }

  std::vector<Side>::const_iterator find(uint32_t a, uint32_t b) const
  {
    return std::lower_bound(sides_.begin(), sides_.end(),
                            Side{ std::min(a, b), std::max(a, b), 0, 0 },
                            before);
  }

  bool is_side(uint32_t a, uint32_t b) const
  {
    auto e = find(a, b);

    return e != sides_.end() && e->a == std::min(a, b) &&
           e->b == std::max(a, b);
  }

  /* The other triangle of an edge with two triangles; null if the edge is on
   * the rim. */
  const Side *across(size_t t, int corner) const
  {
    uint32_t a = tri_[t].v[(corner + 1) % 3].p;
    uint32_t b = tri_[t].v[(corner + 2) % 3].p;
    const Side *other = nullptr;
    size_t n = 0;

    for (auto e = find(a, b);
         e != sides_.end() && e->a == std::min(a, b) && e->b == std::max(a, b);
         ++e, ++n)
      if (e->tri != t) other = &*e;
    return n == 2 ? other : nullptr;
  }

  bool pass()
  {
    bool any = false;
    size_t n = tri_.size();

    for (Tri &t : tri_) t.is_touched = false;
    for (size_t t = 0; t < n; t++) {
      if (tri_[t].is_dead || tri_[t].is_touched || !tri_[t].is_suspect ||
          n_changes_ > most_changes)
        continue;
      tri_[t].is_suspect = is_bad(tri_[t]);
      if (!tri_[t].is_suspect) continue;
      for (int k = 0; k < 3; k++)
        if (const Side *other = across(t, k)) any = spread(other->tri) || any;
      if (!mend(t)) continue;
      any = true;
      n_changes_++;
    }
    return any;
  }

  /* The neighbours of a bad triangle may be bad without a fold between them. */
  bool spread(size_t t)
  {
    bool was = tri_[t].is_suspect || tri_[t].was_suspect;

    tri_[t].is_suspect = true;
    tri_[t].was_suspect = true;
    return !was;
  }

  bool mend(size_t t)
  {
    bool has_chord = false;

    for (int k = 0; k < 3; k++) {
      const Side *other = across(t, k);

      has_chord = has_chord || other;
      if (!other || tri_[other->tri].is_touched) continue;
      if (swap(t, k, *other)) return true;
      if (is_all_on_rim(tri_[t]) && divide(t, k, *other)) return true;
    }
    for (int k = 0; k < 3; k++)
      if (!is_on_rim(tri_[t].v[k].p) && remove(t, k)) return true;
    return !has_chord && insert(t);
  }

  /* Triangles of a point; empty if one of them was already changed. */
  std::vector<size_t> star(uint32_t p) const
  {
    std::vector<size_t> out;

    for (size_t t = 0; t < tri_.size(); t++) {
      if (tri_[t].is_dead || tri_[t].corner(p) < 0) continue;
      if (tri_[t].is_touched) return std::vector<size_t>();
      out.push_back(t);
    }
    return out;
  }

  /* Is x in a triangle with `to`, but not in one with p? */
  bool is_beside(uint32_t x, uint32_t to, uint32_t p) const
  {
    return is_side(x, to) && !(is_side(x, p) && is_third(x, to, p));
  }

  /* Is there a triangle with these three vertices? */
  bool is_third(uint32_t x, uint32_t a, uint32_t b) const
  {
    for (auto e = find(a, b);
         e != sides_.end() && e->a == std::min(a, b) && e->b == std::max(a, b);
         ++e)
      if (tri_[e->tri].corner(x) >= 0) return true;
    return false;
  }

  /* Remove a point of the face by moving it to one of its neighbours. */
  bool remove(size_t t, int k)
  {
    const uint32_t p = tri_[t].v[k].p;
    const std::vector<size_t> around = star(p);

    for (size_t i : around) {
      const Corner *v = tri_[i].v;
      int at = tri_[i].corner(p);

      if (move(p, v[(at + 1) % 3], around)) return true;
    }
    return false;
  }

  bool move(uint32_t p, const Corner &to, const std::vector<size_t> &around)
  {
    for (size_t i : around) {
      Tri next = tri_[i];
      int at = next.corner(p);

      if (next.corner(to.p) >= 0) continue;
      for (int j = 1; j < 3; j++) {
        uint32_t x = next.v[(at + j) % 3].p;

        if (is_beside(x, to.p, p) ||
            (!is_side(x, to.p) && may_be_double(x, to.p)))
          return false;
      }
      next.v[at] = to;
      if (!(normal(next) * normal_of_face(next) > 0) || is_bad(next))
        return false;
    }
    for (size_t i : around) {
      if (tri_[i].corner(to.p) >= 0) tri_[i].is_dead = true;
      else tri_[i].v[tri_[i].corner(p)] = to;
      tri_[i].is_touched = tri_[i].is_suspect = true;
    }
    return true;
  }

  /* Triangle (p a b) and its neighbour (q b a) become (p a q) and (p q b). */
  bool swap(size_t t, int k, const Side &other)
  {
    const Corner *v = tri_[t].v;
    Corner p = v[k], a = v[(k + 1) % 3], b = v[(k + 2) % 3];
    Corner q = tri_[other.tri].v[other.corner];
    Tri first(p, a, q), second(p, q, b);

    if (p.p == q.p || is_side(p.p, q.p) || may_be_double(p.p, q.p) ||
        !is_good(first) || !is_good(second))
      return false;
    tri_[t] = first;
    tri_[other.tri] = second;
    return true;
  }

  Corner new_point(const gp_XY &uv)
  {
    gp_Pnt p = surface_.Value(uv.X(), uv.Y());
    uint32_t number = static_cast<uint32_t>(s_.point.size() / 3);

    s_.point.insert(s_.point.end(), { p.X() + 0.0, p.Y() + 0.0, p.Z() + 0.0 });
    s_.corner.push_back(false);
    return { number, gp_Pnt2d(uv) };
  }

  void forget_point()
  {
    s_.point.resize(s_.point.size() - 3);
    s_.corner.pop_back();
  }

  /* Split an edge: its two triangles become four around a new point of the
   * face. */
  bool divide(size_t t, int k, const Side &other)
  {
    const Corner *v = tri_[t].v;
    Corner p = v[k], a = v[(k + 1) % 3], b = v[(k + 2) % 3];
    Corner q = tri_[other.tri].v[other.corner];
    gp_XY middle = (a.uv.XY() + b.uv.XY()) / 2;

    for (double part : pull) {
      Corner x = new_point((1 - part) * middle + part * q.uv.XY());
      const Tri to[4] = { { p, a, x }, { p, x, b }, { q, b, x }, { q, x, a } };

      if (all_good(to, 4)) {
        tri_[t] = to[0];
        tri_[other.tri] = to[2];
        tri_.push_back(to[1]);
        tri_.push_back(to[3]);
        return true;
      }
      forget_point();
    }
    return false;
  }

  /* Split a triangle that is a whole face into three. */
  bool insert(size_t t)
  {
    const Corner a = tri_[t].v[0], b = tri_[t].v[1], c = tri_[t].v[2];
    Corner x = new_point((a.uv.XY() + b.uv.XY() + c.uv.XY()) / 3);
    const Tri to[3] = { { a, b, x }, { b, c, x }, { c, a, x } };

    if (!all_good(to, 3)) {
      forget_point();
      return false;
    }
    tri_[t] = to[0];
    tri_.push_back(to[1]);
    tri_.push_back(to[2]);
    return true;
  }

  Surface &s_;
  const std::vector<std::vector<uint32_t>> &pieces_;
  uint32_t piece_;
  BRepAdaptor_Surface surface_;
  bool is_reversed_;
  std::vector<Tri> tri_;
  std::vector<Side> sides_;
  int n_changes_ = 0;
};

/* For each point of a curve, the faces that contain it, in order. */
std::vector<std::vector<uint32_t>> list_pieces(const Surface &s)
{
  std::vector<std::vector<uint32_t>> out(s.point.size() / 3);
  std::vector<bool> is_on_curve(out.size(), false);

  for (uint32_t p : s.segment) is_on_curve[p] = true;
  for (size_t i = 0; i < s.tri.size(); i++) {
    std::vector<uint32_t> &list = out[s.tri[i]];
    uint32_t piece = s.piece[i / 3];

    if (is_on_curve[s.tri[i]] && (list.empty() || list.back() != piece))
      list.push_back(piece);
  }
  for (std::vector<uint32_t> &list : out) std::sort(list.begin(), list.end());
  return out;
}

/* Append triangles t to end of `from` to `to`, replaced by those of `patch`. */
void append(const Surface &from, size_t t, const std::vector<Tri> &patch,
            Surface &to)
{
  for (const Tri &tri : patch) {
    if (tri.is_dead) continue;
    for (const Corner &c : tri.v) {
      to.tri.push_back(c.p);
      to.uv.push_back(c.uv);
    }
    to.face.push_back(from.face[t]);
    to.patch.push_back(from.patch[t]);
    to.piece.push_back(from.piece[t]);
  }
}

} // namespace

void follow_faces(Surface &s, const Model &model)
{
  const std::vector<std::vector<uint32_t>> pieces = list_pieces(s);
  Surface out;
  bool any = false;

  for (size_t from = 0, end; from < s.piece.size(); from = end) {
    const Face &face = model.faces[s.piece[from]];
    Patch patch(s, pieces, face, s.piece[from]);

    for (end = from; end < s.piece.size() && s.piece[end] == s.piece[from];
         end++)
      patch.add(end);
    any = patch.run() || any;
    append(s, from, patch.triangles(), out);
  }
  if (!any) return;
  s.tri.swap(out.tri);
  s.uv.swap(out.uv);
  s.face.swap(out.face);
  s.patch.swap(out.patch);
  s.piece.swap(out.piece);
  drop_unused(s);
}

} // namespace vg_occt
