/* Points put back on faces and curves. */
#include "io/occt/occt_parts.h"

#include <cmath>

#include <BRepAdaptor_Curve.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Curve.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace vg_occt {

struct Projector::State {
  explicit State(const TopoDS_Face &f)
      : face(f), surface(new ShapeAnalysis_Surface(BRep_Tool::Surface(f))),
        inside(f, Precision::Confusion())
  {
    for (TopExp_Explorer e(f, TopAbs_EDGE); e.More(); e.Next())
      if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Current())))
        edges.push_back(TopoDS::Edge(e.Current()));
  }
  TopoDS_Face face;
  Handle(ShapeAnalysis_Surface) surface;
  BRepTopAdaptor_FClass2d inside;
  std::vector<TopoDS_Edge> edges;
};

Projector::Projector(const TopoDS_Face &face) : state_(new State(face)) {}

Projector::~Projector() = default;

/* The foot may lie beyond the ends of the edge, or a period away. */
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

/* The foot on the whole surface, where the face has it; else a point of the
 * face's rim. */
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

}  // namespace vg_occt
