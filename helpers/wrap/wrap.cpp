/* SPDX-License-Identifier: GPL-3.0-or-later */
/* vanguard-wrap: CGAL's alpha wrap, its tree of triangles and the union of
 * closed shells (unite.h) as a helper program of Vanguard. */
#include <array>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <unistd.h>

#include "common/serve.h"
#include "wrap/unite.h"

extern "C" const char vg_source_digest[];

namespace
{

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef Kernel::Point_3 Point;
typedef std::vector<Kernel::Triangle_3> Triangles;
typedef CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>
  Primitive;
typedef CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> Tree;
typedef CGAL::Surface_mesh<Point> Mesh;

Point point_at(const double x[3])
{
  return Point(x[0], x[1], x[2]);
}

Point point_of(const vg_serve_surface &s, uint32_t v)
{
  return point_at(s.x[v]);
}

Kernel::Triangle_3 triangle_of(const vg_serve_surface &s, size_t i)
{
  const uint32_t *v = s.tri[i];

  return Kernel::Triangle_3(point_of(s, v[0]), point_of(s, v[1]),
                            point_of(s, v[2]));
}

bool is_flat(const vg_serve_surface &s)
{
  for (size_t i = 0; i < s.n_tri; i++)
    if (!triangle_of(s, i).is_degenerate()) return false;
  return true;
}

/* The input triangles with a positive area, and their numbers in the input. */
struct Input {
  explicit Input(const vg_serve_surface &s)
  {
    for (size_t i = 0; i < s.n_tri; i++) {
      Kernel::Triangle_3 t = triangle_of(s, i);

      if (t.is_degenerate()) continue;
      triangle.push_back(t);
      number.push_back(i);
    }
    tree.rebuild(triangle.cbegin(), triangle.cend());
  }

  Triangles triangle;
  std::vector<size_t> number;
  Tree tree;
};

struct TooMany {
};

/* Reports every 256th point. */
struct Visitor : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  explicit Visitor(uint64_t limit) : most(limit)
  {
  }

  template <typename Wrapper, typename Vertex>
  void after_Steiner_point_insertion(const Wrapper &, Vertex)
  {
    if (++points > most) throw TooMany();
    if (points % 256 == 0) vg_serve_put(VG_HELPER_PROGRESS, 0, points, 0);
  }

  uint64_t most, points = 0;
};

void wrap(const vg_helper_message &m, const vg_serve_surface &s, Mesh &out)
{
  std::vector<Point> points;
  std::vector<std::array<size_t, 3>> faces;

  for (size_t i = 0; i < s.n_point; i++) points.push_back(point_at(s.x[i]));
  for (size_t i = 0; i < s.n_tri; i++)
    faces.push_back({ s.tri[i][0], s.tri[i][1], s.tri[i][2] });
  CGAL::alpha_wrap_3(points, faces, m.value[0], m.value[1], out,
                     CGAL::parameters::default_values(),
                     CGAL::parameters::visitor(Visitor(m.n[2])));
}

void give(const Mesh &from)
{
  std::vector<uint32_t> place(from.num_vertices()), tri;
  std::vector<double> x;

  for (Mesh::Vertex_index v : from.vertices()) {
    place[v] = static_cast<uint32_t>(x.size() / 3);
    for (int k = 0; k < 3; k++) x.push_back(from.point(v)[k]);
  }
  for (Mesh::Face_index f : from.faces())
    for (Mesh::Vertex_index v : from.vertices_around_face(from.halfedge(f)))
      tri.push_back(place[v]);
  vg_serve_put(VG_HELPER_SURFACE, 0, x.size() / 3, tri.size() / 3);
  vg_serve_put_array(x.data(), x.size() * sizeof x[0]);
  vg_serve_put_array(tri.data(), tri.size() * sizeof tri[0]);
}

void give_united(const vg_united &u)
{
  vg_serve_put(VG_HELPER_SURFACE, 0, u.x.size() / 3, u.tri.size() / 3);
  vg_serve_put_array(u.x.data(), u.x.size() * sizeof u.x[0]);
  vg_serve_put_array(u.tri.data(), u.tri.size() * sizeof u.tri[0]);
  vg_serve_put(VG_HELPER_COUNTS, 0, u.from.size(), 0);
  vg_serve_put_array(u.from.data(), u.from.size() * sizeof u.from[0]);
}

void find_nearest(const Input &in, const vg_serve_surface &s)
{
  std::vector<std::array<double, 3>> foot(s.n_more);
  std::vector<uint32_t> tri(s.n_more);

  for (size_t i = 0; i < s.n_more; i++) {
    auto hit = in.tree.closest_point_and_primitive(point_at(s.more[i]));

    for (int k = 0; k < 3; k++) foot[i][static_cast<size_t>(k)] = hit.first[k];
    tri[i] = static_cast<uint32_t>(
      in.number[static_cast<size_t>(hit.second - in.triangle.cbegin())]);
  }
  vg_serve_put(VG_HELPER_FEET, 0, s.n_more, 0);
  vg_serve_put_array(foot.data(), s.n_more * sizeof foot[0]);
  vg_serve_put_array(tri.data(), s.n_more * sizeof tri[0]);
}

void give_counts(const std::vector<uint32_t> &count)
{
  vg_serve_put(VG_HELPER_COUNTS, 0, count.size(), 0);
  vg_serve_put_array(count.data(), count.size() * sizeof count[0]);
}

/* The ray is parallel to no plane that a designer would use, so that it hits no
 * edge in practice. If it does for some point, the result is still the same
 * each time. */
void find_outside(const Input &in, const vg_serve_surface &s)
{
  const Kernel::Vector_3 along(0.7548776662466927, 0.5698402909980532,
                               0.3247179572447460);
  std::vector<uint32_t> outside(s.n_more);

  for (size_t i = 0; i < s.n_more; i++)
    outside[i] = in.tree.number_of_intersected_primitives(
                   Kernel::Ray_3(point_at(s.more[i]), along)) %
                   2 ==
                 0;
  give_counts(outside);
}

void find_crossings(const Input &in, const vg_serve_surface &s)
{
  std::vector<uint32_t> count(s.n_more);

  for (size_t i = 0; i < s.n_more; i++)
    count[i] = static_cast<uint32_t>(in.tree.number_of_intersected_primitives(
      Kernel::Segment_3(point_at(s.more[i]), point_at(s.more[s.n_more + i]))));
  give_counts(count);
}

bool answer(const vg_helper_message &m, const vg_serve_surface &s)
{
  Mesh made;

  if (m.what != VG_HELPER_OUTSIDE && m.what != VG_HELPER_CROSSINGS &&
      is_flat(s)) {
    vg_serve_fail(VG_HELPER_DEGENERATE, "all triangles are degenerate");
    return true;
  }
  switch (m.what) {
  case VG_HELPER_WRAP:
    if (!(m.value[0] > 0) || !(m.value[1] > 0)) return false;
    wrap(m, s, made);
    give(made);
    return true;
  case VG_HELPER_UNITE: give_united(vg_unite(s, m.option == 1)); return true;
  case VG_HELPER_IMPRINT:
    if (m.option > s.n_tri) return false;
    give_united(vg_imprint(s, m.option));
    return true;
  case VG_HELPER_NEAREST: find_nearest(Input(s), s); return true;
  case VG_HELPER_OUTSIDE: find_outside(Input(s), s); return true;
  case VG_HELPER_CROSSINGS: find_crossings(Input(s), s); return true;
  default: return false;
  }
}

/* Returns false if the process cannot go on. */
bool guarded(const vg_helper_message &m)
{
  vg_serve_surface s;
  bool good = true;

  if (!vg_serve_surface_read(STDIN_FILENO, &m, &s)) return false;
  try {
    good = answer(m, s);
  } catch (const TooMany &) {
    vg_serve_fail(VG_HELPER_TOO_MANY, "too many points");
  } catch (const std::bad_alloc &) {
    vg_serve_fail(VG_HELPER_NO_MEMORY, "out of memory");
  } catch (const std::exception &e) {
    vg_serve_fail(VG_HELPER_ERROR, e.what());
  }
  vg_serve_surface_release(&s);
  return good;
}

} // namespace

int main(int argc, char **argv)
{
  vg_helper_message m;

  vg_serve_start(argc, argv, "vanguard-wrap", "CGAL " CGAL_VERSION_STR,
                 vg_source_digest);
  while (vg_serve_next(STDIN_FILENO, &m))
    if (!guarded(m)) _exit(1);
  _exit(0);
}
