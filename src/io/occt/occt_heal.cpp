/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Removes superfluous faces, and starts the repair, sewing and uniting of
 * faces. */
#include "io/occt/occt_parts.h"

#include "io/cad/cad.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>

namespace vg_occt
{

namespace
{

/* A face narrower than this fraction of the model has no area. */
const double width_least = 1e-9; /* S13 */
/* Copies of a face may be different splines. Candidates agree in area and
 * centre to these relative tolerances; a grid of points on the face and points
 * of its edges decide. */
const double area_near = 1e-2, centre_near = 1e-2, copy_near = 1e-4,
             rim_near = 1e-3;
const int copy_grid = 7, copy_rim = 5;
/* A curve in the parameter plane that is farther than this from its edge,
 * relative to the diagonal of the face, and than the tolerance of the edge, is
 * wrong. */
const double curve_far = 1e-2; /* S13 */

struct Measure {
  size_t at; /* index of the face */
  double area;
  gp_Pnt centre;
};

Measure measure(const Model &model, size_t at)
{
  GProp_GProps g;

  BRepGProp::SurfaceProperties(model.faces[at].shape, g, area_near / 10);
  return { at, std::fabs(g.Mass()), g.CentreOfMass() };
}

/* --- faces to repair ----------------------------------------------------- */

/* Does an edge of the face lack its curve in the parameter plane? */
bool lacks_curves(const TopoDS_Face &face)
{
  double first, last;

  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
    if (BRep_Tool::CurveOnSurface(TopoDS::Edge(e.Current()), face, first, last)
          .IsNull())
      return true;
  return false;
}

/* Largest distance, at some points of an edge, between its curve in the
 * parameter plane and the edge itself. */
double curve_error(const TopoDS_Edge &edge, const TopoDS_Face &face)
{
  const bool is_point = BRep_Tool::Degenerated(edge);
  const BRepAdaptor_Surface on(face, Standard_False);
  double first, last, worst = 0;
  Handle(Geom2d_Curve) uv = BRep_Tool::CurveOnSurface(edge, face, first, last);

  if (uv.IsNull()) return 0;
  if (is_point
        ? TopExp::FirstVertex(edge).IsNull()
        : !(BRep_Tool::SameParameter(edge) && BRep_Tool::SameRange(edge)))
    return 0;
  for (int i = 0; i < copy_rim; i++) {
    const double t = first + (last - first) * i / (copy_rim - 1);
    const gp_Pnt2d at = uv->Value(t);
    const gp_Pnt p = is_point ? BRep_Tool::Pnt(TopExp::FirstVertex(edge))
                              : BRepAdaptor_Curve(edge).Value(t);

    worst = std::max(worst, p.Distance(on.Value(at.X(), at.Y())));
  }
  return worst;
}

/* Does the curve of an edge in the parameter plane belong to another place? */
bool has_wrong_curves(const TopoDS_Face &face)
{
  Bnd_Box box;

  BRepBndLib::Add(face, box, Standard_False);
  if (box.IsVoid() || box.IsOpen()) return false;
  const double most = curve_far * std::sqrt(box.SquareExtent());
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge &edge = TopoDS::Edge(e.Current());

    if (curve_error(edge, face) > std::max(most, BRep_Tool::Tolerance(edge)))
      return true;
  }
  return false;
}

/* The face without any curve in its parameter plane. Its edges are the same,
 * except for those at poles, which are only such curves. */
TopoDS_Face without_curves(const TopoDS_Face &face)
{
  BRep_Builder builder;
  TopLoc_Location at;
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face, at);
  TopoDS_Face out;

  surface = Handle(Geom_Surface)::DownCast(surface->Copy());
  builder.MakeFace(out, surface, at, BRep_Tool::Tolerance(face));
  for (TopoDS_Iterator w(face.Oriented(TopAbs_FORWARD)); w.More(); w.Next()) {
    TopoDS_Wire wire;

    if (w.Value().ShapeType() != TopAbs_WIRE) continue;
    builder.MakeWire(wire);
    for (TopoDS_Iterator e(w.Value().Oriented(TopAbs_FORWARD)); e.More();
         e.Next())
      if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Value())))
        builder.Add(wire, e.Value());
    builder.Add(out, wire.Oriented(w.Value().Orientation()));
  }
  out.Orientation(face.Orientation());
  return out;
}

/* --- faces to drop ------------------------------------------------------- */

/* Points of the edges of a face. The grid alone does not tell discs apart whose
 * radii differ a little. */
void add_rim(const TopoDS_Face &face, std::vector<gp_Pnt> &out)
{
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
    if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
    BRepAdaptor_Curve c(TopoDS::Edge(e.Current()));
    const double from = c.FirstParameter(), to = c.LastParameter();

    for (int i = 0; i < copy_rim; i++)
      out.push_back(c.Value(from + (to - from) * (i + 0.5) / copy_rim));
  }
}

/* Does a lie entirely on b, judged by points inside and, less sharply, on the
 * rim? */
bool lies_on(const TopoDS_Face &a, const TopoDS_Face &b, double size)
{
  std::vector<gp_Pnt> some = samples(a, copy_grid), rim;
  Projector on(b);
  auto all = [&](const std::vector<gp_Pnt> &list, double tolerance) {
    return std::all_of(list.begin(), list.end(), [&](const gp_Pnt &p) {
      return p.Distance(on.nearest(p)) <= tolerance;
    });
  };

  if (some.empty()) some.push_back(point_of(a));
  add_rim(a, rim);
  return all(some, copy_near * size) && all(rim, rim_near * size);
}

bool are_copies(const Model &model, const Measure &a, const Measure &b)
{
  double size = std::sqrt(a.area);
  const TopoDS_Face &f = model.faces[a.at].shape, &g = model.faces[b.at].shape;

  return std::fabs(a.area - b.area) <= area_near * a.area &&
         a.centre.Distance(b.centre) <= centre_near * size &&
         lies_on(f, g, size) && lies_on(g, f, size);
}

/* Normal of a face at its nearest point to p, oriented as the face. */
gp_Vec normal_at(const TopoDS_Face &face, const gp_Pnt &p)
{
  Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  gp_Pnt2d uv = ShapeAnalysis_Surface(surface).ValueOfUV(
    p, Precision::Confusion());
  gp_Pnt at;
  gp_Vec du, dv;

  surface->D1(uv.X(), uv.Y(), at, du, dv);
  return face.Orientation() == TopAbs_REVERSED ? dv.Crossed(du)
                                               : du.Crossed(dv);
}

/* Do two copies of a face form a wall between the materials of two solids? */
bool is_between(const Face &a, const Face &b)
{
  gp_Pnt p = point_of(a.shape);

  return a.solid >= 0 && b.solid >= 0 && a.solid != b.solid &&
         normal_at(a.shape, p) * normal_at(b.shape, p) < 0;
}

/* How often the faces of each solid use an edge. */
class Uses
{
public:
  explicit Uses(const Model &model)
  {
    for (const Face &f : model.faces)
      if (!f.shape.IsNull() && f.solid >= 0) count(f, 1);
  }

  void remove(const Face &f)
  {
    if (f.solid >= 0) count(f, -1);
  }

  /* Would the shell of a face be open without it? An edge between an even
   * number of faces would then be one of an odd number. */
  bool close(const Face &f) const
  {
    std::map<int, int> own;

    if (f.solid < 0) return false;
    for (TopExp_Explorer e(f.shape, TopAbs_EDGE); e.More(); e.Next())
      own[edges_.FindIndex(e.Current())]++;
    return std::any_of(own.begin(), own.end(), [&](std::pair<int, int> n) {
      return n.second % 2 && uses_.at({ f.solid, n.first }) % 2 == 0;
    });
  }

private:
  void count(const Face &f, int n)
  {
    for (TopExp_Explorer e(f.shape, TopAbs_EDGE); e.More(); e.Next())
      uses_[{ f.solid, edges_.Add(e.Current()) }] += n;
  }

  TopTools_IndexedMapOfShape edges_; /* regardless of their orientation */
  std::map<std::pair<int, int>, int> uses_; /* of a solid and an edge */
};

/* Drop the later of two equal faces in the file. Equal faces of solids that
 * overlap are kept for their union in the first round. */
void drop_copy(Model &model, size_t i, size_t j, bool again, const Talk &talk)
{
  Face &later = model.faces[std::max(i, j)];
  Face &first = model.faces[std::min(i, j)];

  if (!again && first.solid >= 0 && later.solid >= 0 &&
      first.solid != later.solid)
    return;
  talk.note(format("%s at %s duplicates face %u and was dropped",
                   named(later).c_str(), place(point_of(later.shape)).c_str(),
                   first.number));
  later.shape.Nullify();
}

/* Pairs of copies that do not belong to solids: a face that the file has twice,
 * or the wall between two closed shells of loose faces, of which each has its
 * own copy.
 *
 *        shell A              shell B           other faces at the edge e:
 *     ____________  e   e  ____________         2 if A and B share a wall,
 *                 | |   | |                     1 if A has its cap twice
 *                 | |   | |  copies
 *     ____________|_|   |_|____________
 */
class Pairs
{
public:
  explicit Pairs(Model &model) : model_(model), partner_(model.faces.size(), 0)
  {
  }

  void add(size_t i, size_t j)
  {
    pairs_.push_back({ std::min(i, j), std::max(i, j) });
    partner_[i]++;
    partner_[j]++;
  }

  /* Drop both faces of walls and the second face of other pairs. */
  void drop(const Talk &talk)
  {
    if (pairs_.empty()) return;
    list_edges();
    std::vector<Votes> votes;
    for (const Pair &p : pairs_) votes.push_back(count(p));
    spread(votes);
    for (size_t k = 0; k < pairs_.size(); k++) {
      const Pair &p = pairs_[k];

      if (votes[k].is_wall() && partner_[p.i] == 1 && partner_[p.j] == 1)
        drop_wall(p, talk);
      else drop_copy(model_, p.i, p.j, true, talk);
    }
  }

private:
  struct Pair {
    size_t i, j;
  };
  struct Votes {
    size_t two = 0, other = 0; /* edges with two other faces; with another
                                  number of them */
    std::vector<size_t> near;  /* faces of other pairs at these edges */

    bool is_wall() const
    {
      return two && !other;
    }
  };
  struct Edge {
    size_t face;
    TopoDS_Edge edge;
    Bnd_Box box;
  };

  void list_edges()
  {
    for (size_t i = 0; i < model_.faces.size(); i++) {
      const TopoDS_Face &face = model_.faces[i].shape;

      if (face.IsNull() || model_.faces[i].solid >= 0) continue;
      for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
        const TopoDS_Edge &edge = TopoDS::Edge(e.Current());
        Bnd_Box box;

        if (BRep_Tool::Degenerated(edge)) continue;
        BRepBndLib::Add(edge, box, Standard_False);
        edges_.push_back({ i, edge, box });
      }
    }
  }

  /* Count the other faces in the middle of each edge of a pair. */
  Votes count(const Pair &p) const
  {
    Votes out;

    for (TopExp_Explorer e(model_.faces[p.i].shape, TopAbs_EDGE); e.More();
         e.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
      BRepAdaptor_Curve c(TopoDS::Edge(e.Current()));
      count_at(p, c.Value((c.FirstParameter() + c.LastParameter()) / 2), out);
    }
    return out;
  }

  void count_at(const Pair &p, const gp_Pnt &at, Votes &out) const
  {
    const double near = copy_near * model_.face_size;
    const TopoDS_Vertex vertex = BRepBuilderAPI_MakeVertex(at);
    Bnd_Box around;
    std::set<size_t> faces;
    const size_t n_near = out.near.size();

    around.Add(at);
    around.Enlarge(near);
    for (const Edge &e : edges_) {
      if (e.face == p.i || e.face == p.j || e.box.IsOut(around)) continue;
      BRepExtrema_DistShapeShape to(vertex, e.edge);
      if (!to.IsDone() || to.Value() > near) continue;
      if (partner_[e.face]) out.near.push_back(e.face);
      else faces.insert(e.face);
    }
    if (faces.empty() && out.near.size() > n_near) return; /* between pairs */
    ++(faces.size() == 2 ? out.two : out.other);
  }

  /* Pairs that share edges are one wall, or copies of one surface. */
  void spread(std::vector<Votes> &votes) const
  {
    std::vector<size_t> of(model_.faces.size(), SIZE_MAX), todo;
    std::vector<bool> seen(pairs_.size(), false);

    for (size_t k = 0; k < pairs_.size(); k++)
      of[pairs_[k].i] = of[pairs_[k].j] = k;
    for (size_t k = 0; k < pairs_.size(); k++) {
      Votes sum;

      if (seen[k]) continue;
      seen[k] = true;
      todo.assign(1, k);
      for (size_t next = 0; next < todo.size(); next++) {
        sum.two += votes[todo[next]].two;
        sum.other += votes[todo[next]].other;
        for (size_t face : votes[todo[next]].near)
          if (!seen[of[face]]) {
            seen[of[face]] = true;
            todo.push_back(of[face]);
          }
      }
      for (size_t one : todo) {
        votes[one].two = sum.two;
        votes[one].other = sum.other;
      }
    }
  }

  void drop_wall(const Pair &p, const Talk &talk)
  {
    Face &f = model_.faces[p.i], &g = model_.faces[p.j];

    talk.note(format("%s and face %u at %s are a wall between two closed "
                     "shells and were dropped",
                     named(f).c_str(), g.number,
                     place(point_of(f.shape)).c_str()));
    f.shape.Nullify();
    g.shape.Nullify();
  }

  Model &model_;
  std::vector<Pair> pairs_;
  std::vector<size_t> partner_; /* number of pairs of each face */
  std::vector<Edge> edges_;     /* of all loose faces */
};

/* Walls between solids, which are single faces or two copies of one face. */
class Walls
{
public:
  Walls(Model &model, const std::vector<Measure> &list)
      : model_(model), area_(model.faces.size(), 0),
        box_(static_cast<size_t>(model.n_solid)), total_(box_.size(), 0)
  {
    for (const Measure &m : list) area_[m.at] = m.area;
    for (size_t i = 0; i < model.faces.size(); i++) {
      const Face &f = model.faces[i];

      if (f.shape.IsNull()) continue;
      if (f.solid >= 0) add(static_cast<size_t>(f.solid), i);
      if (f.behind >= 0) add(static_cast<size_t>(f.behind), i);
    }
  }

  void add_pair(size_t i, size_t j)
  {
    const Face &f = model_.faces[i], &g = model_.faces[j];
    int a = f.solid, b = i == j ? f.behind : g.solid;

    pairs_.push_back({ i, j, std::min(a, b), std::max(a, b) });
    shared_[{ std::min(a, b), std::max(a, b) }] += area_[i];
  }

  /* Drop the walls and join their solids, unless one solid fills a hollow of
   * the other, which may be the fluid around it. */
  void drop(bool again, const Talk &talk)
  {
    for (const Pair &p : pairs_) {
      Face &f = model_.faces[p.i], &g = model_.faces[p.j];

      if (f.shape.IsNull() || g.shape.IsNull()) continue;
      if (fills_hollow(p)) {
        if (p.i != p.j) drop_copy(model_, p.i, p.j, again, talk);
        continue;
      }
      talk.note(
        format("%s%s at %s %s between two solids that touch and %s "
               "dropped",
               named(f).c_str(),
               p.i == p.j ? "" : format(" and face %u", g.number).c_str(),
               place(point_of(f.shape)).c_str(),
               p.i == p.j ? "is a wall" : "are a wall",
               p.i == p.j ? "was" : "were"));
      f.shape.Nullify();
      g.shape.Nullify();
      joined_.push_back({ p.a, p.b });
    }
    for (const std::pair<int, int> &p : joined_) join(p.first, p.second);
  }

private:
  struct Pair {
    size_t i, j;
    int a, b; /* solids, a < b */
  };

  void add(size_t solid, size_t face)
  {
    BRepBndLib::Add(model_.faces[face].shape, box_[solid], Standard_False);
    total_[solid] += area_[face];
  }

  bool is_within(size_t inner, size_t outer) const
  {
    Bnd_Box both = box_[outer];

    both.Add(box_[inner]);
    return both.SquareExtent() <= box_[outer].SquareExtent() * (1 + box_near);
  }

  bool fills_hollow(const Pair &p) const
  {
    const size_t a = static_cast<size_t>(p.a), b = static_cast<size_t>(p.b);
    const double area = shared_.at({ p.a, p.b });

    return (is_within(a, b) && area >= hollow_share * total_[a]) ||
           (is_within(b, a) && area >= hollow_share * total_[b]);
  }

  void join(int a, int b)
  {
    auto now = [this](int k) {
      for (const std::pair<int, int> &r : renamed_)
        if (r.first == k) k = r.second;
      return k;
    };
    const int x = now(a), y = now(b);

    if (x == y) return;
    renamed_.push_back({ std::max(x, y), std::min(x, y) });
    for (Face &f : model_.faces)
      if (f.solid == std::max(x, y)) f.solid = std::min(x, y);
  }

  Model &model_;
  std::vector<double> area_;  /* area of each face */
  std::vector<Bnd_Box> box_;  /* bounding box of each solid */
  std::vector<double> total_; /* area of each solid */
  std::vector<Pair> pairs_;
  std::map<std::pair<int, int>, double> shared_;
  std::vector<std::pair<int, int>> joined_, renamed_;
};

void drop_copies(Model &model, std::vector<Measure> &list, bool again,
                 const Talk &talk)
{
  Walls walls(model, list);
  Pairs loose(model);
  Uses uses(model);
  std::vector<bool> is_wall(model.faces.size(), false);

  for (size_t i = 0; i < model.faces.size(); i++) {
    const Face &f = model.faces[i];

    if (f.shape.IsNull() || f.behind < 0 || f.solid < 0) continue;
    walls.add_pair(i, i);
    is_wall[i] = true;
  }
  std::sort(list.begin(), list.end(), [](const Measure &a, const Measure &b) {
    return a.centre.X() != b.centre.X() ? a.centre.X() < b.centre.X()
                                        : a.at < b.at;
  });
  for (size_t i = 0; i < list.size(); i++)
    for (size_t j = i + 1; j < list.size(); j++) {
      const Measure &a = list[i], &b = list[j];

      if (b.centre.X() - a.centre.X() > centre_near * std::sqrt(a.area)) break;
      if (model.faces[a.at].shape.IsNull() || is_wall[a.at]) break;
      if (model.faces[b.at].shape.IsNull() || is_wall[b.at] ||
          !are_copies(model, a, b))
        continue;
      if (model.faces[a.at].solid < 0 && model.faces[b.at].solid < 0) {
        loose.add(a.at, b.at);
        is_wall[std::max(a.at, b.at)] = true;
        continue;
      }
      if (is_between(model.faces[a.at], model.faces[b.at])) {
        walls.add_pair(std::min(a.at, b.at), std::max(a.at, b.at));
        is_wall[a.at] = is_wall[b.at] = true;
        continue;
      }
      Face &later = model.faces[std::max(a.at, b.at)];
      const Face &first = model.faces[std::min(a.at, b.at)];
      const Face copy = later;

      if (first.solid == later.solid && uses.close(later)) continue;
      drop_copy(model, a.at, b.at, again, talk);
      if (later.shape.IsNull()) uses.remove(copy);
    }
  loose.drop(talk);
  walls.drop(again, talk);
}

/* Drop faces without area; return the others. */
std::vector<Measure> drop_slits(Model &model, const Talk &talk)
{
  std::vector<Measure> kept;

  for (size_t i = 0; i < model.faces.size(); i++) {
    Face &f = model.faces[i];

    if (f.shape.IsNull()) continue;
    try {
      Measure m = measure(model, i);

      if (!(m.area <=
            width_least * model.diagonal * model.diagonal * width_least)) {
        kept.push_back(m);
        continue;
      }
      talk.note(format("%s at %s has no area and was dropped", named(f).c_str(),
                       place(point_of(f.shape)).c_str()));
    } catch (const Standard_Failure &e) {
      talk.note(format("%s cannot be evaluated (%s) and was dropped",
                       named(f).c_str(), e.DynamicType()->Name()));
    }
    f.shape.Nullify();
  }
  return kept;
}

} // namespace

std::string named(const Face &f)
{
  return f.name.empty() ? format("face %u", f.number)
                        : format("face %u (%.60s)", f.number, f.name.c_str());
}

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
    talk.note(format("%zu faces were repaired, the first is %s at %s", n,
                     named(*first).c_str(),
                     place(point_of(first->shape)).c_str()));
}

void complete(Model &model, const Talk &talk)
{
  std::vector<double> sizes;
  Bnd_Box box;
  const Face *first = nullptr;
  bool first_lacks = false;

  for (Face &f : model.faces) {
    const bool lacks = lacks_curves(f.shape);

    if (!lacks && !has_wrong_curves(f.shape)) continue;
    if (!first) first_lacks = lacks;
    if (!first) first = &f;
    if (!lacks) f.shape = without_curves(f.shape);
  }
  if (first) {
    mend(model, talk);
    talk.note(format("%s has %s parameter-space curves along its boundary, "
                     "at %s; they were computed, also for other faces like it",
                     named(*first).c_str(), first_lacks ? "no" : "wrong",
                     place(point_of(first->shape)).c_str()));
  }
  for (const Face &f : model.faces) {
    Bnd_Box one;

    BRepBndLib::Add(f.shape, one, Standard_False);
    if (!one.IsVoid() && !one.IsOpen())
      sizes.push_back(std::sqrt(one.SquareExtent()));
    box.Add(one);
  }
  if (box.IsVoid() || box.IsOpen())
    throw Failure{ VG_ERR_INPUT, "a face extends to infinity" };
  model.diagonal = std::sqrt(box.SquareExtent());
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2,
                   sizes.end());
  model.face_size = sizes[sizes.size() / 2];
}

void heal(const vg_cad_ask &ask, Model &model, const Talk &talk)
{
  const bool many = model.n_solid > 1;
  std::vector<Measure> list = drop_slits(model, talk);
  std::vector<std::string> said;
  double tolerance = 0;
  bool done = false;

  if (ask.solids == VG_CAD_SOLIDS_ZONES) {
    drop_loose(ask, model, talk);
    separate(ask, model, talk);
    if (ask.with_volume) measure_volume(model);
    return;
  }
  /* A solid that shares more than one wall in part is not closed without one of
   * its walls, so that the union needs all of them. */
  if (many && ask.leave_apart == VG_CAD_UNITE_WHOLE)
    done = unite(ask, false, model, said, talk);
  talk.stage("looking for duplicate faces");
  if (!done) {
    if (!said.empty()) list = drop_slits(model, talk);
    if (!many || ask.leave_apart < VG_CAD_KEEP_WALLS)
      drop_copies(model, list, !many, talk);
    tolerance = sew(ask, model, talk);
    if (many && ask.leave_apart < VG_CAD_LEAVE_APART)
      unite(ask, true, model, said, talk);
  }
  if (many && ask.leave_apart < VG_CAD_KEEP_WALLS) {
    list = drop_slits(model, talk);
    drop_copies(model, list, true, talk);
    tolerance = sew(ask, model, talk);
  }
  if (model.n_solid > 0) drop_loose(ask, model, talk);
  orient(model, tolerance, talk);
  if (ask.with_volume) measure_volume(model);
}

} // namespace vg_occt
