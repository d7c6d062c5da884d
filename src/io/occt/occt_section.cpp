/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The curves of a file as a plane section. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>

#include <BRepAdaptor_Curve.hxx>
#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <BRepBndLib.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <ShapeAnalysis_FreeBounds.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_HSequenceOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>

namespace vg_occt
{

namespace
{

const double flat = 1e-6; /* S105: extent normal to the plane over the whole */
const double turn = 0.02; /* S105: radians between two points of a curve */
const double sag = 1e-5;  /* S105: their distance from it over the whole */
const int least = 12;     /* S105: points of a curve that is not straight */

using Points = std::vector<gp_Pnt>;

double extent(const std::vector<TopoDS_Wire> &wires)
{
  Bnd_Box box;

  for (const TopoDS_Wire &w : wires) BRepBndLib::Add(w, box);
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

/* The curves of faces, or those of no face. */
std::vector<TopoDS_Wire> find_wires(const Model &model, double tolerance)
{
  std::vector<TopoDS_Wire> out;
  Handle(TopTools_HSequenceOfShape) loose = new TopTools_HSequenceOfShape;
  Handle(TopTools_HSequenceOfShape) joined;

  if (!model.faces.empty() && !model.loose.empty())
    throw Failure{ VG_ERR_INPUT,
                   format("it has %zu faces and %zu curves of no face: either "
                          "could be the section; export one of the two",
                          model.faces.size(), model.loose.size()) };
  for (const Face &f : model.faces) {
    size_t n = 0;

    for (TopExp_Explorer i(f.shape, TopAbs_WIRE); i.More(); i.Next()) n++;
    if (n > 1)
      throw Failure{ VG_ERR_INPUT,
                     format("%s has %zu wires: it could be a body with holes, "
                            "or the fluid around bodies; export the wires of "
                            "the bodies",
                            named(f).c_str(), n) };
    out.push_back(BRepTools::OuterWire(f.shape));
  }
  for (const TopoDS_Edge &e : model.loose) loose->Append(e);
  if (loose->IsEmpty()) return out;
  ShapeAnalysis_FreeBounds::ConnectEdgesToWires(loose, tolerance,
                                                Standard_False, joined);
  for (int i = 1; i <= joined->Length(); i++)
    out.push_back(TopoDS::Wire(joined->Value(i)));
  return out;
}

/* Appends the points of an edge, in its direction in the wire. */
void add_edge(const TopoDS_Edge &e, double all, Points &to)
{
  const BRepAdaptor_Curve curve(e);
  GCPnts_TangentialDeflection at(curve, turn, sag * all,
                                 curve.GetType() == GeomAbs_Line ? 2 : least);
  const int n = at.NbPoints();

  for (int i = 1; i <= n; i++) {
    const gp_Pnt p = at.Value(e.Orientation() == TopAbs_REVERSED ? n + 1 - i
                                                                 : i);

    if (to.empty() || to.back().Distance(p) > flat * all) to.push_back(p);
  }
}

Points points_of(const TopoDS_Wire &w, double all)
{
  Points out;
  int left = 0;

  for (TopExp_Explorer i(w, TopAbs_EDGE); i.More(); i.Next()) left++;
  for (BRepTools_WireExplorer i(w); i.More(); i.Next(), left--)
    add_edge(i.Current(), all, out);
  if (left > 0)
    throw Failure{
      VG_ERR_INPUT,
      format("%d of the curves of a section do not follow the "
             "others, which end at %s; join them end to end",
             left, out.empty() ? "no point" : place(out.back()).c_str())
    };
  return out;
}

/* The axes along the section, by the one along which it has no extent. */
void find_axes(const std::vector<Points> &wires, double all, int axis[2])
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (const Points &wire : wires)
    for (const gp_Pnt &p : wire)
      for (int k = 0; k < 3; k++) {
        lo[k] = std::min(lo[k], p.Coord(k + 1));
        hi[k] = std::max(hi[k], p.Coord(k + 1));
      }
  axis[0] = 1;
  axis[1] = hi[2] - lo[2] <= flat * all ? 2 : 3;
  if (axis[1] == 2 || hi[1] - lo[1] <= flat * all) return;
  throw Failure{ VG_ERR_INPUT,
                 format("its curves are in no plane z = constant or y = "
                        "constant, as those of a section: they extend from "
                        "(%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g); rotate the "
                        "section, or export only its curves",
                        lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]) };
}

/* A closed wire begins at its rearmost point, the upper one of several. */
void turn_to_rear(Points &wire, const int axis[2], double all)
{
  auto is_behind = [&](const gp_Pnt &p, const gp_Pnt &q) {
    const double d = p.Coord(axis[0]) - q.Coord(axis[0]);

    return d > flat * all ||
           (d >= -flat * all && p.Coord(axis[1]) > q.Coord(axis[1]));
  };
  size_t at = 0;

  if (wire.size() < 2 || wire.front().Distance(wire.back()) > flat * all)
    return;
  wire.pop_back();
  for (size_t i = 1; i < wire.size(); i++)
    if (is_behind(wire[i], wire[at])) at = i;
  std::rotate(wire.begin(), wire.begin() + static_cast<std::ptrdiff_t>(at),
              wire.end());
  wire.push_back(wire.front());
}

} // namespace

void section(const vg_cad_ask &ask, const Model &model, Surface &out)
{
  const double near = ask.tolerance > 0 ? ask.tolerance : flat;
  const std::vector<TopoDS_Wire> shapes = find_wires(model, near);
  const double all = extent(shapes);
  std::vector<Points> wires;
  int axis[2];

  for (const TopoDS_Wire &w : shapes) wires.push_back(points_of(w, all));
  find_axes(wires, all, axis);
  for (Points &wire : wires) {
    const size_t first = out.point.size() / 3;

    turn_to_rear(wire, axis, all);
    if (wire.empty()) continue;
    for (const gp_Pnt &p : wire) {
      out.point.push_back(p.Coord(axis[0]));
      out.point.push_back(p.Coord(axis[1]));
      out.point.push_back(0);
    }
    out.segment.push_back(static_cast<uint32_t>(first));
    out.segment.push_back(static_cast<uint32_t>(out.point.size() / 3 - 1));
    out.curve.push_back(0);
  }
}

} // namespace vg_occt
