#include "core/wrap/wrap_parts.h"

#include "core/wrap/wrap.h"

#ifndef VG_CGAL

extern "C" int vg_wrap_is_built(void)
{
  return 0;
}

static vg_status not_built(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "this build of vanguard cannot wrap: "
                 "install CGAL (Debian's libcgal-dev) and configure again, or "
                 "repair the surface elsewhere");
}

extern "C" vg_status vg_wrap_cgal(const struct vg_mesh *,
                                  const struct vg_wrap_options *, size_t,
                                  struct vg_mesh *, struct vg_error *err)
{
  return not_built(err);
}

extern "C" vg_status vg_wrap_outside(const struct vg_mesh *, size_t,
                                     const double (*)[3],
                                     const struct vg_stop *, uint8_t *,
                                     struct vg_error *err)
{
  return not_built(err);
}

extern "C" vg_status vg_wrap_crossings(const struct vg_mesh *, size_t,
                                       const double (*)[3], const double (*)[3],
                                       const struct vg_stop *, uint32_t *,
                                       struct vg_error *err)
{
  return not_built(err);
}

extern "C" vg_status vg_wrap_nearest(const struct vg_mesh *, size_t,
                                     const double (*)[3],
                                     const struct vg_stop *, double (*)[3],
                                     uint32_t *, struct vg_error *err)
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

namespace
{

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

Kernel::Triangle_3 triangle_of(const vg_mesh *m, size_t i)
{
  const uint32_t *v = m->tri[i];

  return Kernel::Triangle_3(point_of(m, v[0]), point_of(m, v[1]),
                            point_of(m, v[2]));
}

bool is_flat(const vg_mesh *m)
{
  for (size_t i = 0; i < m->n_tri; i++)
    if (!triangle_of(m, i).is_degenerate()) return false;
  return true;
}

/* The input triangles with a positive area, and their numbers in the input. */
struct Input {
  explicit Input(const vg_mesh *m)
  {
    for (size_t i = 0; i < m->n_tri; i++) {
      Kernel::Triangle_3 t = triangle_of(m, i);

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

struct Stopped {
};
struct TooMany {
};

void ask(const vg_stop *stop)
{
  if (vg_stops(stop)) throw Stopped();
}

/* Polls `stop` before each facet through which the wrap is carved, and reports
 * every 256th point. */
struct Visitor : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  Visitor(const vg_wrap_options *options, size_t forecast)
      : o(options), expected(forecast)
  {
  }

  template <typename Wrapper, typename Gate>
  void before_facet_treatment(const Wrapper &, const Gate &) const
  {
    ask(&o->stop);
  }

  /* Each point adds two triangles. */
  template <typename Wrapper, typename Vertex>
  void after_Steiner_point_insertion(const Wrapper &, Vertex)
  {
    if (++points > VG_WRAP_MOST / 2) throw TooMany();
    if (o->progress && points % 256 == 0)
      o->progress(o->user, points, expected);
  }

  const vg_wrap_options *o;
  size_t expected, points = 0;
};

void wrap(const vg_mesh *m, const vg_wrap_options *o, size_t expected,
          Mesh &out)
{
  std::vector<Point> points;
  std::vector<std::array<size_t, 3>> faces;

  for (size_t i = 0; i < m->n_point; i++)
    points.push_back(point_of(m, static_cast<uint32_t>(i)));
  for (size_t i = 0; i < m->n_tri; i++)
    faces.push_back({ m->tri[i][0], m->tri[i][1], m->tri[i][2] });
  CGAL::alpha_wrap_3(points, faces, o->size, o->size * VG_WRAP_OFFSET, out,
                     CGAL::parameters::default_values(),
                     CGAL::parameters::visitor(Visitor(o, expected)));
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

void give(const Mesh &from, vg_mesh *out)
{
  std::vector<uint32_t> place(from.num_vertices());

  if (!allocate(from.number_of_vertices(), from.number_of_faces(), out))
    throw std::bad_alloc();
  for (Mesh::Vertex_index v : from.vertices()) {
    place[v] = static_cast<uint32_t>(out->n_point);
    for (int k = 0; k < 3; k++) out->point[out->n_point][k] = from.point(v)[k];
    out->n_point++;
  }
  for (Mesh::Face_index f : from.faces()) {
    int k = 0;

    for (Mesh::Vertex_index v : from.vertices_around_face(from.halfedge(f)))
      out->tri[out->n_tri][k++] = place[v];
    out->tri_patch[out->n_tri++] = 0;
  }
}

void find_nearest(const Input &in, size_t n, const double (*x)[3],
                  const vg_stop *stop, double (*foot)[3], uint32_t *tri)
{
  for (size_t i = 0; i < n; i++) {
    auto hit = in.tree.closest_point_and_primitive(
      Point(x[i][0], x[i][1], x[i][2]));

    ask(stop);
    for (int k = 0; k < 3; k++) foot[i][k] = hit.first[k];
    tri[i] = static_cast<uint32_t>(
      in.number[static_cast<size_t>(hit.second - in.triangle.cbegin())]);
  }
}

/* The ray is parallel to no plane that a designer would use, so that it hits no
 * edge in practice. If it does for some point, the result is still the same
 * each time. */
void find_outside(const Input &in, size_t n, const double (*x)[3],
                  const vg_stop *stop, uint8_t *outside)
{
  const Kernel::Vector_3 along(0.7548776662466927, 0.5698402909980532,
                               0.3247179572447460);

  for (size_t i = 0; i < n; i++) {
    const Kernel::Ray_3 ray(Point(x[i][0], x[i][1], x[i][2]), along);

    ask(stop);
    outside[i] = in.tree.number_of_intersected_primitives(ray) % 2 == 0;
  }
}

void find_crossings(const Input &in, size_t n, const double (*a)[3],
                    const double (*b)[3], const vg_stop *stop, uint32_t *count)
{
  for (size_t i = 0; i < n; i++) {
    ask(stop);
    count[i] = static_cast<uint32_t>(in.tree.number_of_intersected_primitives(
      Kernel::Segment_3(Point(a[i][0], a[i][1], a[i][2]),
                        Point(b[i][0], b[i][1], b[i][2]))));
  }
}

/* No exception leaves this file. */
template <typename Body>
vg_status guarded(const vg_stop *stop, vg_error *err, Body body)
{
  try {
    return body();
  } catch (const Stopped &) {
    return vg_stopped(stop, err);
  } catch (const TooMany &) {
    return vg_fail(err, VG_ERR_INPUT,
                   "a wrap was stopped at %.2g triangles before it was "
                   "complete: take a larger size",
                   VG_WRAP_MOST);
  } catch (const std::bad_alloc &) {
    return vg_fail_memory(err, "a wrap; take a larger size");
  } catch (const std::exception &e) {
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "CGAL could not wrap the surface: "
                   "%.300s",
                   e.what());
  }
}

} // namespace

extern "C" int vg_wrap_is_built(void)
{
  return 1;
}

extern "C" vg_status vg_wrap_cgal(const struct vg_mesh *m,
                                  const struct vg_wrap_options *o,
                                  size_t expected, struct vg_mesh *out,
                                  struct vg_error *err)
{
  return guarded(&o->stop, err, [&] {
    Mesh made;

    if (is_flat(m))
      return vg_fail(err, VG_ERR_INPUT,
                     "the surface cannot be wrapped: all "
                     "triangles are degenerate");
    wrap(m, o, expected, made);
    give(made, out);
    return VG_OK;
  });
}

extern "C" vg_status vg_wrap_outside(const struct vg_mesh *m, size_t n,
                                     const double (*x)[3],
                                     const struct vg_stop *stop,
                                     uint8_t *outside, struct vg_error *err)
{
  return guarded(stop, err, [&] {
    find_outside(Input(m), n, x, stop, outside);
    return VG_OK;
  });
}

extern "C" vg_status vg_wrap_crossings(const struct vg_mesh *m, size_t n,
                                       const double (*a)[3],
                                       const double (*b)[3],
                                       const struct vg_stop *stop,
                                       uint32_t *count, struct vg_error *err)
{
  return guarded(stop, err, [&] {
    find_crossings(Input(m), n, a, b, stop, count);
    return VG_OK;
  });
}

extern "C" vg_status vg_wrap_nearest(const struct vg_mesh *m, size_t n,
                                     const double (*x)[3],
                                     const struct vg_stop *stop,
                                     double (*foot)[3], uint32_t *tri,
                                     struct vg_error *err)
{
  return guarded(stop, err, [&] {
    find_nearest(Input(m), n, x, stop, foot, tri);
    return VG_OK;
  });
}

#endif
