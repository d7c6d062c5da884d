/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shells are united one after the other by corefinement (CGAL, Polygon Mesh
 * Processing) with exact coordinates, which are rounded at the end. Faces carry
 * the number of the input triangle that they are part of. */
#include "wrap/unite.h"

#include <map>
#include <numeric>
#include <stdexcept>
#include <string>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

namespace
{

namespace PMP = CGAL::Polygon_mesh_processing;

typedef CGAL::Exact_predicates_exact_constructions_kernel Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Body;
typedef Body::Face_index Face;
typedef Body::Property_map<Face, uint32_t> From;

From from_of(Body &b)
{
  return b.add_property_map<Face, uint32_t>("f:from", 0).first;
}

/* Keeps the numbers of input triangles while faces are split and copied. */
struct Tracker : PMP::Corefinement::Default_visitor<Body> {
  std::map<const Body *, From> *from;
  uint32_t split = 0;

  void before_subface_creations(Face f, Body &b)
  {
    split = (*from)[&b][f];
  }

  void after_subface_created(Face f, Body &b)
  {
    (*from)[&b][f] = split;
  }

  void after_face_copy(Face f, const Body &b, Face copy, Body &to)
  {
    (*from)[&to][copy] = (*from)[&b][f];
  }
};

/* Number of the shell of each triangle, in the order of their first ones. The
 * first n_wall triangles count as one shell. */
std::vector<size_t> shells_of(const vg_serve_surface &s, size_t n_wall,
                              size_t &n)
{
  std::vector<uint32_t> root(s.n_point);
  std::vector<size_t> number(s.n_point, SIZE_MAX), shell(s.n_tri);
  const auto find = [&root](uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };

  std::iota(root.begin(), root.end(), 0u);
  for (size_t i = 1; i < n_wall; i++)
    root[find(s.tri[i][0])] = find(s.tri[0][0]);
  for (size_t i = 0; i < s.n_tri; i++)
    for (int k = 1; k < 3; k++) root[find(s.tri[i][k])] = find(s.tri[i][0]);
  n = 0;
  for (size_t i = 0; i < s.n_tri; i++) {
    size_t &own = number[find(s.tri[i][0])];

    if (own == SIZE_MAX) own = n++;
    shell[i] = own;
  }
  return shell;
}

std::vector<Body> split(const vg_serve_surface &s, size_t n_wall)
{
  size_t n;
  const std::vector<size_t> shell = shells_of(s, n_wall, n);
  std::vector<Body> body(n);
  std::vector<From> from;
  std::vector<Body::Vertex_index> place(s.n_point, Body::null_vertex());

  for (Body &b : body) from.push_back(from_of(b));
  for (size_t i = 0; i < s.n_tri; i++) {
    Body &b = body[shell[i]];
    Face f;

    for (int k = 0; k < 3; k++) {
      const double *x = s.x[s.tri[i][k]];
      Body::Vertex_index &v = place[s.tri[i][k]];

      if (v == Body::null_vertex())
        v = b.add_vertex(Kernel::Point_3(x[0], x[1], x[2]));
    }
    f = b.add_face(place[s.tri[i][0]], place[s.tri[i][1]], place[s.tri[i][2]]);
    if (f == Body::null_face())
      throw std::runtime_error("a shell is not a manifold");
    from[shell[i]][f] = static_cast<uint32_t>(i);
  }
  return body;
}

/* a: the union of a and b, or without b. */
void combine(Body &a, Body &b, bool subtract)
{
  std::map<const Body *, From> from;
  Tracker tracker;
  bool good;

  from[&a] = from_of(a);
  from[&b] = from_of(b);
  tracker.from = &from;
  const auto np = CGAL::parameters::visitor(tracker);
  good = subtract ? PMP::corefine_and_compute_difference(a, b, a, np)
                  : PMP::corefine_and_compute_union(a, b, a, np);
  if (!good) throw std::runtime_error("the common surface is not a manifold");
}

void add_rounded(Body &b, vg_united &to)
{
  From from = from_of(b);
  std::vector<uint32_t> place(b.number_of_vertices() +
                              b.number_of_removed_vertices());

  for (Body::Vertex_index v : b.vertices()) {
    place[v] = static_cast<uint32_t>(to.x.size() / 3);
    for (int k = 0; k < 3; k++)
      to.x.push_back(CGAL::to_double(b.point(v)[k].exact()));
  }
  for (Face f : b.faces()) {
    for (Body::Vertex_index v : b.vertices_around_face(b.halfedge(f)))
      to.tri.push_back(place[v]);
    to.from.push_back(from[f]);
  }
}

/* Divides the triangles of a and b along the curves on which they meet. */
void corefine(Body &a, Body &b)
{
  std::map<const Body *, From> from;
  Tracker tracker;

  if (!CGAL::do_overlap(PMP::bbox(a), PMP::bbox(b))) return;
  from[&a] = from_of(a);
  from[&b] = from_of(b);
  tracker.from = &from;
  PMP::corefine(a, b, CGAL::parameters::visitor(tracker));
}

} // namespace

vg_united vg_unite(const vg_serve_surface &s, bool subtract)
{
  std::vector<Body> body = split(s, 0);
  vg_united to;
  const size_t first = subtract ? 1 : 0;

  for (const Body &b : body)
    if (!CGAL::is_closed(b)) throw std::runtime_error("a shell is open");
  for (size_t i = first + 1; i < body.size(); i++)
    combine(body[first], body[i], false);
  if (subtract && body.size() > 1) combine(body[0], body[1], true);
  add_rounded(body[0], to);
  return to;
}

vg_united vg_imprint(const vg_serve_surface &s, size_t n_wall)
{
  std::vector<Body> body = split(s, n_wall);
  vg_united to;

  for (size_t i = 0; i < body.size(); i++)
    for (size_t k = i + 1; k < body.size(); k++) corefine(body[i], body[k]);
  for (Body &b : body) add_rounded(b, to);
  return to;
}
