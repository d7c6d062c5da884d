#include "core/wrap/wrap_parts.h"

#include "core/wrap/wrap.h"

#ifndef VG_CGAL

extern "C" int vg_wrap_is_built(void)
{
  return 0;
}

static vg_status not_built(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED, "this build of vanguard cannot wrap: "
                 "install CGAL (Debian's libcgal-dev) and configure again, or "
                 "repair the surface elsewhere");
}

extern "C" vg_status vg_wrap_cgal(const struct vg_mesh *, double, double,
                                  const struct vg_stop *, struct vg_mesh *,
                                  double (**)[3], struct vg_error *err)
{
  return not_built(err);
}

extern "C" vg_status vg_wrap_label(const struct vg_mesh *, struct vg_mesh *,
                                   const struct vg_stop *,
                                   struct vg_wrap_report *,
                                   struct vg_error *err)
{
  return not_built(err);
}

#else

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

namespace {

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef Kernel::Point_3 Point;
typedef std::vector<Kernel::Triangle_3> Triangles;
typedef CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>
    Primitive;
typedef CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> Tree;
typedef CGAL::Surface_mesh<Point> Mesh;

Point point_of(const vg_mesh *m, uint32_t v)
{
  return Point(m->point[v][0], m->point[v][1], m->point[v][2]);
}

/* The input's triangles, those without area left out, and which they are. */
struct Input {
  explicit Input(const vg_mesh *mesh) : m(mesh)
  {
    for (size_t i = 0; i < m->n_tri; i++) {
      const uint32_t *v = m->tri[i];
      Kernel::Triangle_3 t(point_of(m, v[0]), point_of(m, v[1]),
                           point_of(m, v[2]));

      if (t.is_degenerate()) continue;
      triangle.push_back(t);
      number.push_back(i);
    }
    tree.rebuild(triangle.cbegin(), triangle.cend());
  }

  /* Number of the nearest triangle; its distance into *d. */
  size_t nearest(const Point &p, double *d) const
  {
    auto hit = tree.closest_point_and_primitive(p);

    *d = std::sqrt(CGAL::squared_distance(p, hit.first));
    return number[static_cast<size_t>(hit.second - triangle.cbegin())];
  }

  const vg_mesh *m;
  Triangles triangle;
  std::vector<size_t> number;
  Tree tree;
};

struct Stopped {};

void ask(const vg_stop *stop)
{
  if (vg_stops(stop)) throw Stopped();
}

/* Asks before each facet that the wrap is carved through. */
struct Visitor : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  explicit Visitor(const vg_stop *s) : stop(s) {}

  template <typename Wrapper, typename Gate>
  void before_facet_treatment(const Wrapper &, const Gate &) const
  {
    ask(stop);
  }

  const vg_stop *stop;
};

void wrap(const vg_mesh *m, double size, double offset, const vg_stop *stop,
          Mesh &out)
{
  std::vector<Point> points;
  std::vector<std::array<size_t, 3>> faces;

  for (size_t i = 0; i < m->n_point; i++)
    points.push_back(point_of(m, static_cast<uint32_t>(i)));
  for (size_t i = 0; i < m->n_tri; i++)
    faces.push_back({m->tri[i][0], m->tri[i][1], m->tri[i][2]});
  CGAL::alpha_wrap_3(points, faces, size, offset, out,
                     CGAL::parameters::default_values(),
                     CGAL::parameters::visitor(Visitor(stop)));
}

bool allocate(size_t n_point, size_t n_tri, vg_mesh *out)
{
  out->point = static_cast<double(*)[3]>(
      std::malloc((n_point + 1) * sizeof *out->point));
  out->tri = static_cast<uint32_t(*)[3]>(
      std::malloc((n_tri + 1) * sizeof *out->tri));
  out->tri_patch = static_cast<uint32_t *>(
      std::malloc((n_tri + 1) * sizeof *out->tri_patch));
  return out->point && out->tri && out->tri_patch;
}

void farther(const Point &p, double d, vg_wrap_report *r)
{
  if (d <= r->distance) return;
  r->distance = d;
  r->at[0] = p.x();
  r->at[1] = p.y();
  r->at[2] = p.z();
}

/* near: of each point the nearest place of the input. */
void give(const Mesh &from, const Input &in, const vg_stop *stop, vg_mesh *out,
          double (**near)[3])
{
  std::vector<uint32_t> place(from.num_vertices());

  if (!allocate(from.number_of_vertices(), from.number_of_faces(), out))
    throw std::bad_alloc();
  *near = static_cast<double(*)[3]>(
      std::malloc((from.number_of_vertices() + 1) * sizeof **near));
  if (!*near) throw std::bad_alloc();
  for (Mesh::Vertex_index v : from.vertices()) {
    const Point &p = from.point(v);
    const Point q = in.tree.closest_point(p);

    ask(stop);
    place[v] = static_cast<uint32_t>(out->n_point);
    for (int k = 0; k < 3; k++) {
      out->point[out->n_point][k] = p[k];
      (*near)[out->n_point][k] = q[k];
    }
    out->n_point++;
  }
  for (Mesh::Face_index f : from.faces()) {
    int k = 0;

    for (Mesh::Vertex_index v : from.vertices_around_face(from.halfedge(f)))
      out->tri[out->n_tri][k++] = place[v];
    out->tri_patch[out->n_tri++] = 0;
  }
}

void label(const Input &in, const vg_stop *stop, vg_mesh *out,
           vg_wrap_report *r)
{
  double d;

  for (size_t i = 0; i < out->n_point; i++) {
    const Point p = point_of(out, static_cast<uint32_t>(i));

    ask(stop);
    in.nearest(p, &d);
    farther(p, d, r);
  }
  for (size_t i = 0; i < out->n_tri; i++) {
    const uint32_t *t = out->tri[i];
    Point c = CGAL::centroid(point_of(out, t[0]), point_of(out, t[1]),
                             point_of(out, t[2]));
    size_t old = in.nearest(c, &d);

    ask(stop);
    farther(c, d, r);
    out->tri_patch[i] = in.m->tri_patch[old];
  }
}

}  // namespace

extern "C" int vg_wrap_is_built(void)
{
  return 1;
}

extern "C" vg_status vg_wrap_cgal(const struct vg_mesh *m, double size,
                                  double offset, const struct vg_stop *stop,
                                  struct vg_mesh *out, double (**near)[3],
                                  struct vg_error *err)
{
  try {
    Input in(m);
    Mesh made;

    if (in.triangle.empty())
      return vg_fail(err, VG_ERR_INPUT, "a wrap: all triangles are degenerate");
    ask(stop);
    wrap(m, size, offset, stop, made);
    give(made, in, stop, out, near);
    return VG_OK;
  } catch (const Stopped &) {
    return vg_stopped(stop, err);
  } catch (const std::bad_alloc &) {
    return vg_fail_memory(err, "a wrap; take a larger size");
  } catch (const std::exception &e) {
    return vg_fail(err, VG_ERR_GEOMETRY, "CGAL could not wrap the surface: "
                   "%.300s", e.what());
  }
}

extern "C" vg_status vg_wrap_label(const struct vg_mesh *m,
                                   struct vg_mesh *out,
                                   const struct vg_stop *stop,
                                   struct vg_wrap_report *r,
                                   struct vg_error *err)
{
  try {
    label(Input(m), stop, out, r);
    return VG_OK;
  } catch (const Stopped &) {
    return vg_stopped(stop, err);
  } catch (const std::bad_alloc &) {
    return vg_fail_memory(err, "a wrap; take a larger size");
  }
}

#endif
