/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Projection of points to faces and curves. */
#include "io/occt/occt_parts.h"

#include <cmath>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Curve.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace vg_occt
{

namespace
{

const int most_steps = 15;
/* Below this the lengths of the derivatives are meaningless, as at a pole. */
const double singular = 1e-10;
/* Iterations end when a step is smaller than these fractions of the point's
 * distance from the origin and of the first step. */
const double precise = 1e-13, relative = 1e-7;

} // namespace

struct Projector::State {
  explicit State(const TopoDS_Face &f)
      : face(f), surface(new ShapeAnalysis_Surface(BRep_Tool::Surface(f))),
        fast(f, Standard_False), inside(f, Precision::Confusion())
  {
    for (TopExp_Explorer e(f, TopAbs_EDGE); e.More(); e.Next())
      if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Current())))
        edges.push_back(TopoDS::Edge(e.Current()));
  }
  TopoDS_Face face;
  Handle(ShapeAnalysis_Surface) surface;
  BRepAdaptor_Surface fast;
  BRepTopAdaptor_FClass2d inside;
  std::vector<TopoDS_Edge> edges;
};

Projector::Projector(const TopoDS_Face &face) : state_(new State(face))
{
}

Projector::~Projector() = default;

/* The foot may be beyond the ends of the edge, or a period away. */
gp_Pnt nearest_on_curve(const TopoDS_Edge &edge, const gp_Pnt &p)
{
  BRepAdaptor_Curve curve(edge);
  double first = curve.FirstParameter(), last = curve.LastParameter(), at;
  gp_Pnt best = curve.Value(first), end = curve.Value(last), foot;

  if (p.SquareDistance(end) < p.SquareDistance(best)) best = end;
  ShapeAnalysis_Curve().Project(curve, p, Precision::Confusion(), foot, at,
                                Standard_False);
  if (curve.IsPeriodic())
    at -= curve.Period() * std::floor((at - first) / curve.Period());
  if (!(at > first && at < last)) return best;
  foot = curve.Value(at);
  return p.SquareDistance(foot) < p.SquareDistance(best) ? foot : best;
}

/* The nearest point of the whole surface if the face contains it; otherwise a
 * point of the face's rim. */
gp_Pnt Projector::nearest(const gp_Pnt &p)
{
  State &s = *state_;
  gp_Pnt2d uv = s.surface->ValueOfUV(p, Precision::Confusion());
  gp_Pnt best = s.surface->Value(uv);
  bool has = s.inside.Perform(uv) != TopAbs_OUT;

  if (has) return best;
  for (const TopoDS_Edge &edge : s.edges) {
    gp_Pnt to = nearest_on_curve(edge, p);

    if (!has || p.SquareDistance(to) < p.SquareDistance(best)) best = to;
    has = true;
  }
  return best;
}

/* Gauss-Newton iteration: points are near their feet, so the curvature of the
 * surface has little effect. */
static bool walk(const BRepAdaptor_Surface &surface, const gp_Pnt &p,
                 gp_Pnt2d &uv, gp_Pnt &foot)
{
  double far = precise * p.XYZ().Modulus(), first = -1;

  for (int i = 0; i < most_steps; i++) {
    gp_Vec du, dv;

    surface.D1(uv.X(), uv.Y(), foot, du, dv);
    gp_Vec r(foot, p);
    double a = du * du, b = du * dv, c = dv * dv, f = r * du, g = r * dv;
    double det = a * c - b * b;
    if (!(det > singular * a * c)) return false;
    double s = (c * f - b * g) / det, t = (a * g - b * f) / det;
    double step = (s * du + t * dv).Magnitude();
    if (first < 0) first = step;
    if (!(step <= 10 * first)) return false;
    uv.SetCoord(uv.X() + s, uv.Y() + t);
    if (step > far + relative * first) continue;
    foot = surface.Value(uv.X(), uv.Y());
    return true;
  }
  return false;
}

bool Piece::holds(const gp_Pnt2d &at) const
{
  gp_XY u = uv[1].XY() - uv[0].XY(), v = uv[2].XY() - uv[0].XY();
  gp_XY d = at.XY() - uv[0].XY();
  double det = u ^ v, a, b;

  if (det == 0) return false;
  a = (d ^ v) / det;
  b = (u ^ d) / det;
  return 1 - a - b >= least[0] && a >= least[1] && b >= least[2];
}

/* Deciding whether a location is on the face is slow if its rim is long; most
 * locations are in the triangle where the search began. */
gp_Pnt Projector::nearest(const gp_Pnt &p, gp_Pnt2d guess, const Piece &piece)
{
  State &s = *state_;
  gp_Pnt from = s.fast.Value(guess.X(), guess.Y()), foot;

  if (walk(s.fast, p, guess, foot) &&
      p.SquareDistance(foot) <= p.SquareDistance(from) &&
      (piece.holds(guess) || s.inside.Perform(guess) != TopAbs_OUT))
    return foot;
  return nearest(p);
}

std::vector<gp_Pnt> samples(const TopoDS_Face &face, int n)
{
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  BRepTopAdaptor_FClass2d inside(face, Precision::Confusion());
  std::vector<gp_Pnt> out;
  double u0, u1, v0, v1;

  BRepTools::UVBounds(face, u0, u1, v0, v1);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      gp_Pnt2d uv(u0 + (u1 - u0) * (i + 0.5) / n,
                  v0 + (v1 - v0) * (j + 0.5) / n);

      if (inside.Perform(uv) == TopAbs_IN)
        out.push_back(surface->Value(uv.X(), uv.Y()));
    }
  return out;
}

gp_Pnt point_of(const TopoDS_Face &face)
{
  std::vector<gp_Pnt> some = samples(face, 5);
  TopExp_Explorer vertex(face, TopAbs_VERTEX);

  if (!some.empty()) return some[some.size() / 2];
  return vertex.More() ? BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()))
                       : gp_Pnt();
}

} // namespace vg_occt
