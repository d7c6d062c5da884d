/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* verification/cad/shapes.cpp: writes random CAD files whose domain, volume and
 * face areas are known.
 *
 * usage: vg_random_cad DIR SEED FIRST COUNT
 *
 * Shape i, from FIRST on, is a function of SEED and i alone. DIR gets one file
 * for each shape, and shapes.jsonl one line:
 *
 *     {"file": "00012_plate.step", "kind": "plate", "domain": "external",
 *      "options": "", "length": 2.5, "volume": 0.01, "area": 4.2,
 *      "faces": [1, 1, 0.02]}
 *
 * Lengths are in the unit that the program uses by default, the file's own.
 * Volume and areas come from the exact integrals of Open CASCADE over the body
 * that the fluid meets. "faces" is empty if the program may merge or split
 * faces. Shapes on which Open CASCADE itself fails are not written. */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepAlgoAPI_Splitter.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepGProp.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>
#include <gp_Pln.hxx>
#include <gp_Trsf.hxx>

namespace
{

/* The same numbers with every standard library. */
class Random
{
public:
  explicit Random(uint64_t seed) : engine_(seed)
  {
  }
  double unit()
  {
    return double(engine_() >> 11) * 0x1p-53;
  }
  double in(double lo, double hi)
  {
    return lo + (hi - lo) * unit();
  }
  /* Uniform in its logarithm. */
  double scale(double lo, double hi)
  {
    return lo * std::pow(hi / lo, unit());
  }
  int pick(int n)
  {
    return int(engine_() % uint64_t(n));
  }
  bool chance(double p)
  {
    return unit() < p;
  }

private:
  std::mt19937_64 engine_;
};

struct Shape {
  std::string kind, domain = "external", options;
  TopoDS_Shape shape; /* as written */
  TopoDS_Shape body;  /* null: shape; its volume and areas are expected */
  double area = 0;    /* 0: of body */
  bool has_faces = true;
  bool may_turn = true; /* may be rotated and moved */
};

double volume_of(const TopoDS_Shape &s)
{
  GProp_GProps p;

  BRepGProp::VolumeProperties(s, p, 1e-6);
  return std::fabs(p.Mass());
}

double area_of(const TopoDS_Shape &s)
{
  GProp_GProps p;

  BRepGProp::SurfaceProperties(s, p, 1e-6);
  return p.Mass();
}

TopoDS_Shape moved(const TopoDS_Shape &s, const gp_Trsf &t)
{
  return BRepBuilderAPI_Transform(s, t, Standard_True).Shape();
}

TopoDS_Shape shifted(const TopoDS_Shape &s, double x, double y, double z)
{
  gp_Trsf t;

  t.SetTranslation(gp_Vec(x, y, z));
  return moved(s, t);
}

TopoDS_Shape checked(BRepAlgoAPI_BooleanOperation &&op)
{
  if (!op.IsDone() || op.HasErrors()) throw std::runtime_error("boolean");
  op.SimplifyResult();
  return op.Shape();
}

TopoDS_Shape fuse(const TopoDS_Shape &a, const TopoDS_Shape &b)
{
  return checked(BRepAlgoAPI_Fuse(a, b));
}

TopoDS_Shape cut(const TopoDS_Shape &a, const TopoDS_Shape &b)
{
  return checked(BRepAlgoAPI_Cut(a, b));
}

TopoDS_Shape box(double x, double y, double z, double a, double b, double c)
{
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), a, b, c).Shape();
}

gp_Ax2 axis_of(int k, const gp_Pnt &at)
{
  return gp_Ax2(at, k == 0 ? gp::DX() : k == 1 ? gp::DY() : gp::DZ());
}

/* --- extrusions ---------------------------------------------------------- */

TopoDS_Shape polygon_prism(Random &r, double radius, double height)
{
  BRepBuilderAPI_MakePolygon polygon;
  const int n = 3 + r.pick(6);

  for (int i = 0; i < n; i++) {
    const double a = 2 * M_PI * (i + r.in(-0.3, 0.3)) / n;
    const double d = radius * r.in(0.55, 1);

    polygon.Add(gp_Pnt(d * std::cos(a), d * std::sin(a), 0));
  }
  polygon.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(),
                               gp_Vec(0, 0, height))
    .Shape();
}

TopoDS_Shape primitive(Random &r)
{
  switch (r.pick(6)) {
  case 0:
    return box(-0.5, -0.5, -0.5, r.in(0.2, 1.4), r.in(0.2, 1.4),
               r.in(0.2, 1.4));
  case 1:
    return BRepPrimAPI_MakeCylinder(axis_of(r.pick(3), gp_Pnt(0, 0, 0)),
                                    r.in(0.1, 0.6), r.in(0.3, 1.5))
      .Shape();
  case 2: return BRepPrimAPI_MakeSphere(r.in(0.2, 0.7)).Shape();
  case 3:
    return BRepPrimAPI_MakeCone(axis_of(r.pick(3), gp_Pnt(0, 0, 0)),
                                r.in(0.3, 0.6),
                                r.chance(0.3) ? 0 : r.in(0.05, 0.25),
                                r.in(0.4, 1.2))
      .Shape();
  case 4:
    return BRepPrimAPI_MakeTorus(axis_of(r.pick(3), gp_Pnt(0, 0, 0)),
                                 r.in(0.4, 0.7), r.in(0.08, 0.25))
      .Shape();
  default: return polygon_prism(r, r.in(0.3, 0.8), r.in(0.2, 1.2));
  }
}

Shape union_of(Random &r)
{
  Shape s;
  const int n = 2 + r.pick(3);

  s.kind = "union";
  s.shape = primitive(r);
  for (int i = 1; i < n; i++) {
    const TopoDS_Shape next = shifted(primitive(r), r.in(-0.6, 0.6),
                                      r.in(-0.6, 0.6), r.in(-0.6, 0.6));

    s.shape = r.chance(0.75) ? fuse(s.shape, next) : cut(s.shape, next);
  }
  return s;
}

Shape rounded(Random &r)
{
  Shape s;
  const double a = r.in(0.5, 2), b = r.in(0.5, 1), c = r.in(0.2, 0.6);
  const TopoDS_Shape block = r.chance(0.5) ? box(0, 0, 0, a, b, c)
                                           : polygon_prism(r, a, c);
  BRepFilletAPI_MakeFillet fillet(block);
  TopTools_IndexedMapOfShape edge;

  s.kind = "rounded";
  TopExp::MapShapes(block, TopAbs_EDGE, edge);
  for (int i = 1; i <= edge.Extent(); i++)
    if (r.chance(0.6)) fillet.Add(r.scale(0.01, 0.08), TopoDS::Edge(edge(i)));
  if (!fillet.NbContours()) fillet.Add(0.05, TopoDS::Edge(edge(1)));
  fillet.Build();
  if (!fillet.IsDone()) throw std::runtime_error("fillet");
  s.shape = fillet.Shape();
  return s;
}

Shape plate(Random &r)
{
  Shape s;
  const double t = r.scale(0.0005, 0.05);

  s.kind = "plate";
  switch (r.pick(4)) {
  case 0: s.shape = box(0, 0, 0, r.in(0.4, 2), r.in(0.4, 2), t); break;
  case 1: s.shape = polygon_prism(r, r.in(0.5, 1.5), t); break;
  case 2: /* a square tube */ {
    const double a = r.in(0.3, 1), b = r.in(0.3, 1), c = r.in(0.5, 2);

    s.shape = cut(box(0, 0, 0, a, b, c),
                  box(t, t, -1, a - 2 * t, b - 2 * t, c + 2));
    break;
  }
  default: /* two plates in an angle, or a plate with a hole */
    s.shape = box(0, 0, 0, 1, 1, t);
    if (r.chance(0.5)) s.shape = fuse(s.shape, box(0, 0, 0, 1, t, 1));
    else
      s.shape = cut(s.shape,
                    BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.5, 0.5, -1),
                                                    gp::DZ()),
                                             r.in(0.1, 0.3), 3)
                      .Shape());
  }
  return s;
}

/* --- lofts --------------------------------------------------------------- */

/* A section of a wing: a spline around it from its trailing edge, and a base
 * if that is blunt. */
TopoDS_Wire airfoil(double chord, double thickness, double base, double camber,
                    double x, double y, double z)
{
  const int n = 12;
  Handle(TColgp_HArray1OfPnt) p = new TColgp_HArray1OfPnt(1, 2 * n + 1);
  BRepBuilderAPI_MakeWire wire;

  for (int i = 0; i <= 2 * n; i++) {
    const double c = 0.5 * (1 + std::cos(M_PI * i / n));
    const double side = i < n ? 1 : i > n ? -1 : 0;
    const double t = 5 * thickness *
                     (0.2969 * std::sqrt(c) - 0.126 * c - 0.3516 * c * c +
                      0.2843 * c * c * c - 0.1036 * c * c * c * c);
    const double h = side * (t + 0.5 * base * c) + 4 * camber * c * (1 - c);

    p->SetValue(i + 1, gp_Pnt(x + chord * c, y, z + chord * h));
  }
  if (base <= 0) p->SetValue(2 * n + 1, p->Value(1));
  GeomAPI_Interpolate curve(p, Standard_False, 1e-9);
  curve.Perform();
  if (!curve.IsDone()) throw std::runtime_error("spline");
  wire.Add(BRepBuilderAPI_MakeEdge(curve.Curve()).Edge());
  if (base > 0)
    wire.Add(BRepBuilderAPI_MakeEdge(p->Value(2 * n + 1), p->Value(1)).Edge());
  return wire.Wire();
}

TopoDS_Shape loft(const std::vector<TopoDS_Wire> &wire, bool ruled)
{
  BRepOffsetAPI_ThruSections through(Standard_True, ruled);

  for (const TopoDS_Wire &w : wire) through.AddWire(w);
  through.CheckCompatibility(Standard_False);
  through.Build();
  if (!through.IsDone()) throw std::runtime_error("loft");
  return through.Shape();
}

TopoDS_Shape wing_solid(Random &r)
{
  std::vector<TopoDS_Wire> wire;
  const int n = 2 + r.pick(3);
  const double span = r.in(0.8, 4), sweep = r.in(0, 0.6);
  const double taper = r.in(0.3, 1), thickness = r.in(0.06, 0.18);
  const double base = r.chance(0.3) ? 0 : r.scale(0.0005, 0.02);
  const double camber = r.chance(0.5) ? 0 : r.in(0, 0.03);

  for (int i = 0; i < n; i++) {
    const double f = double(i) / (n - 1);

    wire.push_back(airfoil(1 - (1 - taper) * f, thickness, base, camber,
                           sweep * span * f, span * f, 0.08 * span * f));
  }
  return loft(wire, r.chance(0.5));
}

Shape wing(Random &r)
{
  Shape s;

  s.kind = "wing";
  s.shape = wing_solid(r);
  return s;
}

Shape fuselage(Random &r)
{
  Shape s;

  s.kind = "fuselage";
  if (r.chance(0.5)) {
    std::vector<TopoDS_Wire> wire;
    const int n = 3 + r.pick(3);

    for (int i = 0; i < n; i++) {
      const double a = r.in(0.2, 0.5), b = a * r.in(0.5, 1);

      wire.push_back(
        BRepBuilderAPI_MakeWire(
          BRepBuilderAPI_MakeEdge(
            gp_Elips(gp_Ax2(gp_Pnt(i, 0, 0), gp::DX(), gp::DY()), a, b))
            .Edge())
          .Wire());
    }
    s.shape = loft(wire, false);
    return s;
  }
  /* A body of revolution: pointed or blunt nose, base. */
  Handle(TColgp_HArray1OfPnt) p = new TColgp_HArray1OfPnt(1, 5);
  const double l = r.in(2, 6), nose = r.chance(0.5) ? 0 : r.in(0.02, 0.1);

  for (int i = 0; i < 5; i++)
    p->SetValue(i + 1, gp_Pnt(l * i / 4, 0,
                              i ? r.in(0.25, 0.4) * std::sqrt(i / 4.) : nose));
  GeomAPI_Interpolate curve(p, Standard_False, 1e-9);
  curve.Perform();
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(curve.Curve()).Edge());
  const gp_Pnt end(l, 0, 0), start(0, 0, 0);

  wire.Add(BRepBuilderAPI_MakeEdge(p->Value(5), end).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(end, start).Edge());
  if (nose > 0) wire.Add(BRepBuilderAPI_MakeEdge(start, p->Value(1)).Edge());
  s.shape = BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(),
                                  gp_Ax1(start, gp::DX()))
              .Shape();
  return s;
}

/* --- faces that are imprinted -------------------------------------------- */

/* A block with rectangles, discs and slots in its sides. */
Shape imprinted(Random &r)
{
  Shape s;
  const double a = r.in(1, 3), b = r.in(1, 3), c = r.in(1, 3);
  const int n = 1 + r.pick(4);
  TopTools_ListOfShape whole, tools;

  s.kind = "imprinted";
  whole.Append(box(0, 0, 0, a, b, c));
  for (int i = 0; i < n; i++) {
    const double x = a * r.in(0.1, 0.6), y = b * r.in(0.1, 0.6);
    const double z = r.chance(0.5) ? 0 : c;

    if (r.chance(0.5)) {
      BRepBuilderAPI_MakePolygon slot;
      const double w = a * r.in(0.05, 0.3), h = b * r.scale(0.005, 0.3);

      slot.Add(gp_Pnt(x, y, z));
      slot.Add(gp_Pnt(x + w, y, z));
      slot.Add(gp_Pnt(x + w, y + h, z));
      slot.Add(gp_Pnt(x, y + h, z));
      slot.Close();
      tools.Append(BRepBuilderAPI_MakeFace(slot.Wire()).Face());
    } else {
      const gp_Ax2 at(gp_Pnt(x + 0.1, y + 0.1, z), gp::DZ());
      const double radius = r.scale(0.01, 0.09);

      tools.Append(BRepBuilderAPI_MakeFace(
                     BRepBuilderAPI_MakeWire(
                       BRepBuilderAPI_MakeEdge(gp_Circ(at, radius)).Edge())
                       .Wire())
                     .Face());
    }
  }
  BRepAlgoAPI_Splitter split;
  split.SetArguments(whole);
  split.SetTools(tools);
  split.Build();
  if (!split.IsDone() || split.HasErrors()) throw std::runtime_error("split");
  s.shape = split.Shape();
  return s;
}

/* --- half models --------------------------------------------------------- */

/* The faces of a solid without those in the plane x[axis] = 0. */
TopoDS_Shape without_root(const TopoDS_Shape &solid, int axis)
{
  TopoDS_Compound open;
  BRep_Builder builder;
  int n_root = 0;

  builder.MakeCompound(open);
  for (TopExp_Explorer e(solid, TopAbs_FACE); e.More(); e.Next()) {
    Bnd_Box b;
    double lo[3], hi[3];

    BRepBndLib::AddOptimal(e.Current(), b, Standard_False, Standard_False);
    b.Get(lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
    if (std::fabs(lo[axis]) < 1e-6 && std::fabs(hi[axis]) < 1e-6) n_root++;
    else builder.Add(open, e.Current());
  }
  if (!n_root) throw std::runtime_error("no root");
  return open;
}

/* Half of a body, cut in y = 0 (or z = 0): open at the root, or capped and
 * requested by an option. */
Shape half(Random &r)
{
  Shape s;
  gp_Trsf turn;
  const int axis = 1 + r.pick(2);

  s.kind = "half";
  s.domain = "half";
  s.may_turn = false;
  if (r.chance(0.6)) s.body = wing_solid(r);
  else s.body = cut(fuselage(r).shape, box(-50, -100, -50, 100, 100, 100));
  if (axis == 2) {
    turn.SetRotation(gp::OX(), M_PI / 2);
    s.body = moved(s.body, turn);
  }
  s.has_faces = false;
  s.shape = without_root(s.body, axis);
  s.area = area_of(s.shape);
  if (r.chance(0.5)) {
    s.shape = s.body;
    s.options = axis == 1 ? "--half y" : "--half z";
  }
  return s;
}

/* --- several solids, loose faces ----------------------------------------- */

TopoDS_Shape loose(const TopoDS_Shape &solid)
{
  TopoDS_Compound faces;
  BRep_Builder builder;

  builder.MakeCompound(faces);
  for (TopExp_Explorer e(solid, TopAbs_FACE); e.More(); e.Next())
    builder.Add(faces, BRepBuilderAPI_Copy(e.Current()).Shape());
  return faces;
}

Shape loose_faces(Random &r)
{
  Shape s;

  switch (r.pick(4)) {
  case 0: s = wing(r); break;
  case 1: s = union_of(r); break;
  case 2: s = imprinted(r); break;
  default: s = fuselage(r);
  }
  s.kind = "loose";
  s.body = s.shape;
  s.shape = loose(s.body);
  return s;
}

TopoDS_Shape together(const std::vector<TopoDS_Shape> &part)
{
  TopoDS_Compound all;
  BRep_Builder builder;

  builder.MakeCompound(all);
  for (const TopoDS_Shape &p : part) builder.Add(all, p);
  return all;
}

/* Solids that touch: stacked blocks, a peg in a block, stages of a rocket. */
Shape touching(Random &r)
{
  Shape s;
  std::vector<TopoDS_Shape> part;

  s.kind = "touching";
  s.has_faces = false;
  switch (r.pick(3)) {
  case 0: {
    double z = 0;

    for (int i = 0, n = 2 + r.pick(3); i < n; i++) {
      const double h = r.in(0.2, 1);

      part.push_back(box(r.in(-0.3, 0.3), r.in(-0.3, 0.3), z, r.in(0.4, 1.5),
                         r.in(0.4, 1.5), h));
      z += h;
    }
    break;
  }
  case 1: {
    const double radius = r.in(0.1, 0.4), deep = r.in(0.2, 0.9);
    const gp_Ax2 at(gp_Pnt(0, 0, 1 - deep), gp::DZ());
    const TopoDS_Shape peg = BRepPrimAPI_MakeCylinder(at, radius, 1.5).Shape();

    part.push_back(cut(box(-0.5, -0.5, 0, 1, 1, 1), peg));
    part.push_back(peg);
    break;
  }
  default: {
    double x = 0, radius = r.in(0.2, 0.5);

    for (int i = 0, n = 2 + r.pick(3); i < n; i++) {
      const double l = r.in(0.5, 1.5);
      const gp_Ax2 at(gp_Pnt(x, 0, 0), gp::DX());
      const double end = i + 1 == n ? 0 : radius * r.in(0.5, 1);

      part.push_back(
        r.chance(0.5) && end > 0
          ? BRepPrimAPI_MakeCylinder(at, radius, l).Shape()
          : BRepPrimAPI_MakeCone(at, radius, end * 0.99, l).Shape());
      if (r.chance(0.6)) radius = end > 0 ? end : radius;
      x += l;
    }
  }
  }
  s.body = part[0];
  for (size_t i = 1; i < part.size(); i++) s.body = fuse(s.body, part[i]);
  s.shape = together(part);
  return s;
}

/* Solids that overlap, as wing and body of an assembly. */
Shape overlapping(Random &r)
{
  Shape s;
  const TopoDS_Shape body = fuselage(r).shape;
  TopoDS_Shape fin = wing_solid(r);
  gp_Trsf size;

  s.kind = "overlapping";
  s.has_faces = false;
  size.SetScaleFactor(r.in(0.3, 0.6));
  fin = shifted(moved(fin, size), r.in(0.8, 1.1), 0, 0.01);
  s.body = fuse(body, fin);
  s.shape = together({ body, fin });
  return s;
}

/* Two bodies apart. */
Shape apart(Random &r)
{
  Shape s;

  s.kind = "apart";
  s.shape = together({ primitive(r), shifted(primitive(r), 2.6, 0, 0) });
  return s;
}

/* A solid with a large sealed cavity: only its outside is meshed. A box around
 * something small would be a tunnel. */
Shape hollow(Random &r)
{
  Shape s;

  s.kind = "hollow";
  s.body = box(-1, -1, -1, r.in(2, 3), 2, r.in(2, 3));
  s.shape = cut(s.body, BRepPrimAPI_MakeSphere(r.in(0.75, 0.95)).Shape());
  return s;
}

/* A body in a closed tunnel or box, given as two solids. */
Shape enclosed(Random &r)
{
  Shape s;
  const double l = r.in(8, 20);
  const TopoDS_Shape body = primitive(r),
                     room = box(-l / 3, -l / 4, -l / 4, l, l / 2, l / 2);

  s.kind = "enclosed";
  s.domain = "internal";
  s.shape = together({ room, body });
  s.body = cut(room, body);
  return s;
}

/* --- files --------------------------------------------------------------- */

std::string quoted_lines(const std::string &text, const char *end)
{
  std::string out;

  for (char c : text) {
    if (c == '\n') out += end;
    else if (c != '\r') out += c;
  }
  return out;
}

/* STEP text as other systems write it: line ends, comments, names, text after
 * the end. */
void vary_text(Random &r, const std::string &path)
{
  std::ifstream in(path, std::ios::binary);
  std::stringstream buffer;

  buffer << in.rdbuf();
  std::string text = buffer.str();
  in.close();
  if (r.chance(0.3)) {
    const size_t at = text.find("DATA;");

    text.insert(at + 5, "\n/* exported; units as in the model */");
  }
  if (r.chance(0.3)) {
    const size_t at = text.find("FILE_NAME('");

    text.insert(at + 11, "Tr\\X2\\00E4\\X0\\ger d''essai ");
  }
  if (r.chance(0.3)) text = quoted_lines(text, "\r\n");
  if (r.chance(0.2)) text += "\n\n# exported by a script\n";
  std::ofstream(path, std::ios::binary) << text;
}

/* The shape with lengths in millimetres, from which writers convert. */
TopoDS_Shape in_mm(const TopoDS_Shape &s, double mm)
{
  gp_Trsf t;

  t.SetScaleFactor(mm);
  return moved(s, t);
}

struct Unit {
  const char *name, *iges;
  double mm;
};
const Unit units[] = { { "M", "M", 1000 },
                       { "MM", "MM", 1 },
                       { "INCH", "IN", 25.4 },
                       { "FT", "FT", 304.8 } };

void write_step(Random &r, const TopoDS_Shape &s, const std::string &path)
{
  const Unit &unit = units[r.pick(4)];

  Interface_Static::SetCVal("write.step.unit", unit.name);
  Interface_Static::SetCVal("write.step.schema",
                            r.chance(0.5) ? "AP214IS" : "AP203");
  STEPControl_Writer writer;
  if (writer.Transfer(in_mm(s, unit.mm), STEPControl_AsIs) !=
        IFSelect_RetDone ||
      writer.Write(path.c_str()) != IFSelect_RetDone)
    throw std::runtime_error("STEP");
  vary_text(r, path);
}

void write_iges(Random &r, const TopoDS_Shape &s, const std::string &path,
                bool as_solids)
{
  const Unit &unit = units[r.pick(4)];
  IGESControl_Writer writer(unit.iges, as_solids ? 1 : 0);

  if (!writer.AddShape(in_mm(s, unit.mm))) throw std::runtime_error("IGES");
  writer.ComputeModel();
  if (!writer.Write(path.c_str())) throw std::runtime_error("IGES");
}

/* Any place, direction and size. */
void place(Random &r, Shape *s)
{
  gp_Trsf t, size;
  gp_Trsf turn;

  if (s->may_turn && r.chance(0.6)) {
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0),
                            gp_Dir(r.in(-1, 1), r.in(-1, 1), r.in(0.1, 1))),
                     r.in(0, 2 * M_PI));
    t.SetTranslation(gp_Vec(r.in(-5, 5), r.in(-5, 5), r.in(-5, 5)));
    t.Multiply(turn);
  }
  size.SetScaleFactor(r.chance(0.4) ? 1 : r.scale(0.05, 2000));
  size.Multiply(t);
  s->area *= size.ScaleFactor() * size.ScaleFactor();
  if (s->body.IsNull()) s->body = s->shape;
  s->shape = moved(s->shape, size);
  s->body = moved(s->body, size);
}

void describe(const Shape &s, const std::string &file, FILE *out)
{
  Bnd_Box b;
  double lo[3], hi[3], length = 0;
  const char *comma = "";

  BRepBndLib::Add(s.shape, b);
  b.Get(lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
  for (int k = 0; k < 3; k++) length = std::max(length, hi[k] - lo[k]);
  std::fprintf(out,
               "{\"file\": \"%s\", \"kind\": \"%s\", \"domain\": \"%s\", "
               "\"options\": \"%s\", \"length\": %.9g, \"volume\": %.12g, "
               "\"area\": %.12g, \"faces\": [",
               file.c_str(), s.kind.c_str(), s.domain.c_str(),
               s.options.c_str(), length, volume_of(s.body),
               s.area > 0 ? s.area : area_of(s.body));
  for (TopExp_Explorer e(s.body, TopAbs_FACE); s.has_faces && e.More();
       e.Next(), comma = ", ")
    std::fprintf(out, "%s%.12g", comma, area_of(e.Current()));
  std::fprintf(out, "]}\n");
}

Shape make(Random &r)
{
  static const std::function<Shape(Random &)> maker[] = {
    union_of,    union_of, rounded,     plate, plate,  wing,
    wing,        fuselage, imprinted,   half,  half,   loose_faces,
    loose_faces, touching, overlapping, apart, hollow, enclosed
  };

  return maker[r.pick(sizeof maker / sizeof *maker)](r);
}

/* Is it a body with a volume that is not tiny, and sound? */
bool is_sound(const Shape &s)
{
  TopTools_IndexedMapOfShape solid;

  TopExp::MapShapes(s.body, TopAbs_SOLID, solid);
  return solid.Extent() >= 1 && BRepCheck_Analyzer(s.body).IsValid() &&
         volume_of(s.body) > 0 && (s.kind != "union" || solid.Extent() == 1);
}

void write(Random &r, Shape *s, const std::string &dir, int number, FILE *list)
{
  char name[64];
  const int format = r.pick(5);
  const char *ending = format < 3 ? "step" : format == 3 ? "igs" : "brep";
  std::snprintf(name, sizeof name, "%05d_%s.%s", number, s->kind.c_str(),
                ending);
  const std::string path = dir + "/" + name;

  if (format < 3) write_step(r, s->shape, path);
  else if (format == 3)
    write_iges(r, s->shape, path, s->kind != "loose" && s->kind != "half");
  else if (!BRepTools::Write(s->shape, path.c_str()))
    throw std::runtime_error("BREP");
  describe(*s, name, list);
}

} // namespace

int main(int argc, char **argv)
{
  if (argc != 5) {
    std::fprintf(stderr, "usage: vg_random_cad DIR SEED FIRST COUNT\n");
    return 2;
  }
  const std::string dir = argv[1];
  const uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  const int first = std::atoi(argv[3]), count = std::atoi(argv[4]);
  FILE *list = std::fopen((dir + "/shapes.jsonl").c_str(), "w");

  if (!list) {
    std::perror(dir.c_str());
    return 1;
  }
  Message::DefaultMessenger()->RemovePrinters(
    STANDARD_TYPE(Message_PrinterOStream));
  STEPControl_Controller::Init();
  IGESControl_Controller::Init();
  for (int i = first; i < first + count; i++) {
    Random r(seed * 1000003 + uint64_t(i));

    try {
      Shape s = make(r);

      place(r, &s);
      if (is_sound(s)) write(r, &s, dir, i, list);
    } catch (const Standard_Failure &) {
    } catch (const std::runtime_error &) {
    }
  }
  return std::fclose(list) ? 1 : 0;
}
