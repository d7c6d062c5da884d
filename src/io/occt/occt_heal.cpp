/* Faces that should not be there, and edges that should be one. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace vg_occt {

namespace {

/* A face narrower than this share of the model has no area. */
const double width_least = 1e-9;   /* S13 */
/* Copies of a face may be other splines: candidates are those whose areas and
 * centres agree by so much; points on a grid decide. */
const double area_near = 1e-2, centre_near = 1e-2, copy_near = 1e-4;
const int copy_grid = 7;

struct Measure {
  size_t at;                 /* index of the face */
  double area;
  gp_Pnt centre;
};

Measure measure(const Model &model, size_t at)
{
  GProp_GProps g;

  BRepGProp::SurfaceProperties(model.faces[at].shape, g);
  return {at, std::fabs(g.Mass()), g.CentreOfMass()};
}

std::string named(const Face &f)
{
  return f.name.empty() ? format("face %u", f.number)
                        : format("face %u (%.60s)", f.number, f.name.c_str());
}

/* --- faces to mend ------------------------------------------------------- */

/* An edge without its curve in the plane of parameters of its face. */
bool lacks_curves(const TopoDS_Face &face)
{
  double first, last;

  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
    if (BRep_Tool::CurveOnSurface(TopoDS::Edge(e.Current()), face, first, last)
            .IsNull()) return true;
  return false;
}

/* --- faces to drop ------------------------------------------------------- */

/* Is all of a on b, as far as a grid of points tells? */
bool lies_on(const TopoDS_Face &a, const TopoDS_Face &b, double tolerance)
{
  std::vector<gp_Pnt> some = samples(a, copy_grid);
  Projector on(b);

  if (some.empty()) some.push_back(point_of(a));
  return std::all_of(some.begin(), some.end(), [&](const gp_Pnt &p) {
    return p.Distance(on.nearest(p)) <= tolerance;
  });
}

bool are_copies(const Model &model, const Measure &a, const Measure &b)
{
  double size = std::sqrt(a.area);
  const TopoDS_Face &f = model.faces[a.at].shape, &g = model.faces[b.at].shape;

  return std::fabs(a.area - b.area) <= area_near * a.area &&
         a.centre.Distance(b.centre) <= centre_near * size &&
         lies_on(f, g, copy_near * size) && lies_on(g, f, copy_near * size);
}

/* The later one of two in the file goes. */
void drop_copy(Model &model, size_t i, size_t j, const Talk &talk)
{
  Face &later = model.faces[std::max(i, j)];

  talk.note(format("%s at %s repeats face %u and was dropped",
                   named(later).c_str(), place(point_of(later.shape)).c_str(),
                   model.faces[std::min(i, j)].number));
  later.shape.Nullify();
}

void drop_copies(Model &model, std::vector<Measure> &list, const Talk &talk)
{
  std::sort(list.begin(), list.end(), [](const Measure &a, const Measure &b) {
    return a.centre.X() != b.centre.X() ? a.centre.X() < b.centre.X()
                                        : a.at < b.at;
  });
  for (size_t i = 0; i < list.size(); i++)
    for (size_t j = i + 1; j < list.size(); j++) {
      const Measure &a = list[i], &b = list[j];

      if (b.centre.X() - a.centre.X() > centre_near * std::sqrt(a.area)) break;
      if (model.faces[a.at].shape.IsNull()) break;
      if (model.faces[b.at].shape.IsNull() || !are_copies(model, a, b))
        continue;
      drop_copy(model, a.at, b.at, talk);
    }
}

/* What has no area goes at once; the others are returned. */
std::vector<Measure> drop_slits(Model &model, const Talk &talk)
{
  std::vector<Measure> kept;

  for (size_t i = 0; i < model.faces.size(); i++) {
    Face &f = model.faces[i];

    try {
      Measure m = measure(model, i);

      if (!(m.area <= width_least * model.diagonal * model.diagonal *
                        width_least)) {
        kept.push_back(m);
        continue;
      }
      talk.note(format("%s at %s has no area and was dropped",
                       named(f).c_str(), place(point_of(f.shape)).c_str()));
    } catch (const Standard_Failure &e) {
      talk.note(format("%s cannot be evaluated (%s) and was dropped",
                       named(f).c_str(), e.DynamicType()->Name()));
    }
    f.shape.Nullify();
  }
  return kept;
}

/* --- open edges ---------------------------------------------------------- */

struct Edges {
  size_t n_open = 0, n_many = 0;
  TopoDS_Shape open, many;   /* the first of each */
  size_t open_face = 0, many_face = 0;
};

/* Edges with one face, and with more than two. A seam counts twice in its
 * face. */
Edges count_edges(const Model &model)
{
  TopTools_IndexedMapOfShape map;
  std::vector<uint32_t> n, face;
  Edges out;

  for (const Face &f : model.faces) {
    if (f.shape.IsNull()) continue;
    for (TopExp_Explorer e(f.shape, TopAbs_EDGE); e.More(); e.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
      size_t at = static_cast<size_t>(map.Add(e.Current()));
      if (at > n.size()) {
        n.push_back(0);
        face.push_back(f.number);
      }
      n[at - 1]++;
    }
  }
  for (size_t k = n.size(); k-- > 0;) {
    const TopoDS_Shape &e = map.FindKey(static_cast<int>(k + 1));

    if (n[k] == 1) {
      out.n_open++;
      out.open = e;
      out.open_face = face[k];
    } else if (n[k] > 2) {
      out.n_many++;
      out.many = e;
      out.many_face = face[k];
    }
  }
  return out;
}

std::string middle(const TopoDS_Shape &edge)
{
  double first, last;
  Handle(Geom_Curve) c = BRep_Tool::Curve(TopoDS::Edge(edge), first, last);

  return c.IsNull() ? "an unknown place"
                    : place(c->Value((first + last) / 2));
}

void sew(Model &model, double tolerance, const Edges &before, const Talk &talk)
{
  BRepBuilderAPI_Sewing sewing(tolerance);
  Model sewn = model;
  size_t after;

  for (const Face &f : model.faces)
    if (!f.shape.IsNull()) sewing.Add(f.shape);
  sewing.Perform();
  for (Face &f : sewn.faces) {
    if (f.shape.IsNull() || !sewing.IsModifiedSubShape(f.shape)) continue;
    TopoDS_Shape to = sewing.ModifiedSubShape(f.shape);

    if (to.IsNull() || to.ShapeType() != TopAbs_FACE) return;
    f.shape = TopoDS::Face(to);
  }
  after = count_edges(sewn).n_open;
  if (after >= before.n_open) return;
  talk.note(format("%zu edges had one face only; by sewing within %.3g %zu of "
                   "them found a partner", before.n_open, tolerance,
                   before.n_open - after));
  model = sewn;
}

void note_edges(const Edges &e, double tolerance, const Talk &talk)
{
  if (e.n_open)
    talk.note(format("%zu edges have one face only, the first is of face %zu "
                     "at %s: a face is missing there, the gap is wider than "
                     "%.3g (cad_tolerance), or half of a body ends there",
                     e.n_open, e.open_face, middle(e.open).c_str(),
                     tolerance));
  if (e.n_many)
    talk.note(format("%zu edges have three faces or more, the first is of face "
                     "%zu at %s: faces that repeat or divide others",
                     e.n_many, e.many_face, middle(e.many).c_str()));
}

}  // namespace

TopoDS_Compound together(const Model &model)
{
  TopoDS_Compound all;
  BRep_Builder builder;

  builder.MakeCompound(all);
  for (const Face &f : model.faces)
    if (!f.shape.IsNull()) builder.Add(all, f.shape);
  return all;
}

void mend(Model &model, const Talk &talk)
{
  ShapeFix_Shape fix(together(model));
  size_t n = 0;
  const Face *first = nullptr;

  fix.Perform();
  for (Face &f : model.faces) {
    if (f.shape.IsNull()) continue;
    TopoDS_Shape to = fix.Context()->Apply(f.shape);

    if (to.IsNull() || to.ShapeType() != TopAbs_FACE) continue;
    if (!to.IsEqual(f.shape) && !n++) first = &f;
    f.shape = TopoDS::Face(to);
  }
  if (n)
    talk.note(format("%zu faces were mended, the first is %s at %s", n,
                     named(*first).c_str(),
                     place(point_of(first->shape)).c_str()));
}

void complete(Model &model, const Talk &talk)
{
  Bnd_Box box;
  size_t n = 0;

  for (const Face &f : model.faces) {
    if (!lacks_curves(f.shape)) continue;
    if (!n++)
      talk.note(format("%s lacks the curves of its rim in its plane of "
                       "parameters; they are made anew, also for others of the "
                       "kind", named(f).c_str()));
  }
  if (n) mend(model, talk);
  for (const Face &f : model.faces)
    BRepBndLib::Add(f.shape, box, Standard_False);
  if (box.IsVoid() || box.IsOpen())
    throw Failure{VG_ERR_INPUT, "a face of it reaches to infinity"};
  model.diagonal = std::sqrt(box.SquareExtent());
}

void heal(const vg_cad_ask &ask, Model &model, const Talk &talk)
{
  double tolerance = ask.tolerance > 0 ? ask.tolerance
                                       : 1e-6 * model.diagonal;
  std::vector<Measure> list = drop_slits(model, talk);
  Edges edges;

  talk.stage("looking for faces that repeat others");
  drop_copies(model, list, talk);
  edges = count_edges(model);
  if (edges.n_open) {
    talk.stage("sewing its faces");
    sew(model, tolerance, edges, talk);
    edges = count_edges(model);
  }
  note_edges(edges, tolerance, talk);
}

}  // namespace vg_occt
