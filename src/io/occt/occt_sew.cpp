/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sewing of open edges, orientation of faces, and volume of the model. */
#include "io/occt/occt_parts.h"

#include "io/cad/cad.h"

#include <algorithm>
#include <cmath>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace vg_occt
{

namespace
{

/* Sewing tolerances relative to the diagonal, tried in this order. Those after
 * the first must be smaller than share_of_edge times the shortest edge that is
 * longer than the first. */
const double sequence[] = { 1e-6, 1e-5, 1e-4 }, share_of_edge = 0.1; /* S52 */
/* With more open edges than this they are not compared with each other. */
const size_t most_compared = 2000;
const int most_places = 3;
/* Relative error requested from Open CASCADE for the volume of a shell. */
const double integral_near = 1e-6; /* S55 */

/* Use of an edge by a face. */
struct Use {
  size_t face;
  bool is_reversed;
};

/* Edges that are not degenerate, with the faces that use them. A seam lists its
 * face twice. */
struct Edges {
  explicit Edges(const Model &model)
  {
    for (size_t i = 0; i < model.faces.size(); i++) {
      if (model.faces[i].shape.IsNull()) continue;
      for (TopExp_Explorer e(model.faces[i].shape, TopAbs_EDGE); e.More();
           e.Next()) {
        if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
        size_t at = static_cast<size_t>(map.Add(e.Current()));
        if (at > uses.size()) uses.emplace_back();
        uses[at - 1].push_back(
          { i, e.Current().Orientation() == TopAbs_REVERSED });
      }
    }
    for (const std::vector<Use> &u : uses) {
      n_open += u.size() == 1;
      n_many += u.size() > 2;
    }
  }

  const TopoDS_Edge &edge(size_t i) const
  {
    return TopoDS::Edge(map.FindKey(static_cast<int>(i + 1)));
  }

  TopTools_IndexedMapOfShape map;
  std::vector<std::vector<Use>> uses;
  size_t n_open = 0, n_many = 0;
};

std::string middle(const TopoDS_Edge &edge)
{
  double first, last;
  Handle(Geom_Curve) c = BRep_Tool::Curve(edge, first, last);

  return c.IsNull() ? "an unknown place" : place(c->Value((first + last) / 2));
}

/* --- sewing -------------------------------------------------------------- */

struct Sewn {
  Model model;
  double tolerance;
  size_t n_open;
  std::string places; /* locations of the first edges that were joined */
  std::vector<std::string> notes;

  /* Take over the result of sewing for a face: the face itself, several faces,
   * or none. */
  void take(const Face &from, const TopoDS_Shape &to)
  {
    size_t n = model.faces.size();

    for (TopExp_Explorer e(to, TopAbs_FACE); !to.IsNull() && e.More();
         e.Next()) {
      model.faces.push_back(from);
      model.faces.back().shape = TopoDS::Face(e.Current());
    }
    if (model.faces.size() > n) return;
    notes.push_back(format("%s at %s is narrower than the sewing tolerance "
                           "and was dropped",
                           named(from).c_str(),
                           place(point_of(from.shape)).c_str()));
    model.faces.push_back(from);
    model.faces.back().shape.Nullify();
  }
};

/* Locations of edges that were open before and no longer are. */
std::string joined_places(const Edges &before, const Edges &after,
                          const BRepBuilderAPI_Sewing &sewing)
{
  std::string out;
  int n = 0;

  for (size_t i = 0; i < before.uses.size() && n < most_places; i++) {
    if (before.uses[i].size() != 1) continue;
    TopoDS_Shape to = before.edge(i);

    if (sewing.IsModified(to)) to = sewing.Modified(to);
    int at = to.IsNull() ? 0 : after.map.FindIndex(to);
    if (at && after.uses[static_cast<size_t>(at) - 1].size() == 1) continue;
    out += (n++ ? ", " : std::string()) + middle(before.edge(i));
  }
  return out;
}

Sewn sew_within(const Model &model, double tolerance, const Edges &before)
{
  BRepBuilderAPI_Sewing sewing(tolerance);
  Sewn out;

  for (const Face &f : model.faces)
    if (!f.shape.IsNull()) sewing.Add(f.shape);
  sewing.Perform();
  out.model = model;
  out.model.faces.clear();
  for (const Face &f : model.faces) {
    if (f.shape.IsNull() || !sewing.IsModifiedSubShape(f.shape))
      out.model.faces.push_back(f);
    else out.take(f, sewing.ModifiedSubShape(f.shape));
  }
  Edges after(out.model);
  out.tolerance = tolerance;
  out.n_open = after.n_open;
  out.places = joined_places(before, after, sewing);
  return out;
}

double shortest_edge(const Edges &edges, double least)
{
  double shortest = HUGE_VAL;

  for (size_t i = 0; i < edges.uses.size(); i++) {
    double length = GCPnts_AbscissaPoint::Length(
      BRepAdaptor_Curve(edges.edge(i)));

    if (length > least) shortest = std::min(shortest, length);
  }
  return shortest;
}

/* Can an open edge have a partner within the tolerance, that is, is the
 * midpoint of one inside the bounding box of another? */
bool may_have_partner(const Edges &edges, double tolerance)
{
  std::vector<Bnd_Box> box;
  std::vector<gp_Pnt> mid;

  if (edges.n_open > most_compared) return true;
  for (size_t i = 0; i < edges.uses.size(); i++) {
    if (edges.uses[i].size() != 1) continue;
    BRepAdaptor_Curve c(edges.edge(i));

    box.emplace_back();
    BRepBndLib::Add(edges.edge(i), box.back(), Standard_False);
    box.back().Enlarge(tolerance);
    mid.push_back(c.Value((c.FirstParameter() + c.LastParameter()) / 2));
  }
  for (size_t i = 0; i < mid.size(); i++)
    for (size_t j = 0; j < box.size(); j++)
      if (i != j && !box[j].IsOut(mid[i])) return true;
  return false;
}

/* Sew with the first tolerance that leaves the fewest open edges. */
Sewn sew_best(const Model &model, const std::vector<double> &list,
              const Edges &before)
{
  Sewn best = sew_within(model, list[0], before);
  double most = share_of_edge * shortest_edge(before, list[0]);

  for (size_t i = 1; i < list.size(); i++) {
    if (!best.n_open || list[i] > most ||
        !may_have_partner(Edges(best.model), list[i]))
      break;
    Sewn next = sew_within(model, list[i], before);
    if (next.n_open < best.n_open) best = next;
  }
  return best;
}

/* --- orientation --------------------------------------------------------- */

/* Orients faces like their neighbours, starting from the first face of each
 * shell. Faces of solids come first and are never turned. */
class Turning
{
public:
  explicit Turning(Model &model)
      : model_(model), edges_(model), of_(model.faces.size()),
        state_(model.faces.size(), unknown)
  {
    for (size_t i = 0; i < edges_.uses.size(); i++)
      if (edges_.uses[i].size() == 2)
        for (const Use &u : edges_.uses[i]) of_[u.face].push_back(i);
  }

  /* Returns the number of faces that were turned. */
  size_t run()
  {
    size_t n = 0;

    for (int solid = 1; solid >= 0; solid--)
      for (size_t i = 0; i < state_.size(); i++)
        if (state_[i] == unknown && !model_.faces[i].shape.IsNull() &&
            (model_.faces[i].solid >= 0) == (solid == 1))
          walk(i);
    for (size_t i = 0; i < state_.size(); i++)
      if (state_[i] == turned) {
        model_.faces[i].shape.Reverse();
        n++;
      }
    return n;
  }

private:
  enum State : char { unknown, kept, turned };

  void walk(size_t from)
  {
    std::vector<size_t> todo(1, from);

    state_[from] = kept;
    for (size_t next = 0; next < todo.size(); next++)
      for (size_t e : of_[todo[next]]) {
        const std::vector<Use> &u = edges_.uses[e];
        const size_t me = todo[next];
        const size_t other = u[0].face == me ? u[1].face : u[0].face;

        if (state_[other] != unknown) continue;
        bool agree = u[0].is_reversed != u[1].is_reversed;
        state_[other] = (state_[me] == kept) == agree ||
                            model_.faces[other].solid >= 0
                        ? kept
                        : turned;
        todo.push_back(other);
      }
  }

  Model &model_;
  Edges edges_;
  std::vector<std::vector<size_t>> of_; /* edges of each face */
  std::vector<char> state_;
};

void note_edges(const Model &model, double tolerance, const Talk &talk)
{
  Edges edges(model);
  bool open = false, many = false;

  for (size_t i = 0; i < edges.uses.size(); i++) {
    const std::vector<Use> &u = edges.uses[i];
    const unsigned number = model.faces[u[0].face].number;

    if (u.size() == 1 && !open)
      talk.note(format("%zu edges belong to one face only, the first to face "
                       "%u at %s: a face is missing there, the gap is wider "
                       "than %.3g (cad_tolerance), or the model is half of a "
                       "body",
                       edges.n_open, number, middle(edges.edge(i)).c_str(),
                       tolerance));
    if (u.size() > 2 && !many)
      talk.note(format("%zu edges belong to three or more faces, the first "
                       "to face %u at %s: some faces duplicate or divide "
                       "others",
                       edges.n_many, number, middle(edges.edge(i)).c_str()));
    open = open || u.size() == 1;
    many = many || u.size() > 2;
  }
}

} // namespace

std::vector<double> tolerances(const vg_cad_ask &ask, const Model &model)
{
  std::vector<double> out;

  if (ask.tolerance > 0) return std::vector<double>(1, ask.tolerance);
  for (double share : sequence) out.push_back(share * model.diagonal);
  return out;
}

double sew(const vg_cad_ask &ask, Model &model, const Talk &talk)
{
  const std::vector<double> list = tolerances(ask, model);
  double used = list[0];
  Edges before(model);

  if (before.n_open) {
    talk.stage("sewing its faces");
    Sewn sewn = sew_best(model, list, before);
    used = sewn.tolerance;
    if (sewn.n_open < before.n_open) {
      talk.note(format("%zu edges belonged to one face only; sewing with a "
                       "tolerance of %.3g joined %zu of them, for "
                       "example at %s",
                       before.n_open, used, before.n_open - sewn.n_open,
                       sewn.places.c_str()));
      for (const std::string &text : sewn.notes) talk.note(text);
      model = sewn.model;
    }
  }
  return used;
}

void orient(Model &model, double tolerance, const Talk &talk)
{
  if (size_t n = Turning(model).run())
    talk.note(format("%zu faces that do not belong to a solid were reversed "
                     "to match their neighbours",
                     n));
  note_edges(model, tolerance, talk);
}

std::vector<size_t> find_shells(const Model &model)
{
  Edges edges(model);
  std::vector<size_t> of(model.faces.size());
  auto root = [&of](size_t i) {
    while (of[i] != i) i = of[i] = of[of[i]];
    return i;
  };

  for (size_t i = 0; i < of.size(); i++) of[i] = i;
  for (const std::vector<Use> &u : edges.uses)
    for (const Use &x : u) {
      size_t a = root(u[0].face), b = root(x.face);

      of[std::max(a, b)] = std::min(a, b);
    }
  for (size_t i = 0; i < of.size(); i++) of[i] = root(i);
  return of;
}

/* The shells, as numbers of their first faces, that consist of one plane face
 * which belongs to no solid. */
static std::vector<bool> loose_planes(const Model &model)
{
  const std::vector<size_t> of = find_shells(model);
  std::vector<size_t> n(of.size());
  std::vector<bool> loose(of.size());

  for (size_t i = 0; i < of.size(); i++) n[of[i]]++;
  for (size_t i = 0; i < of.size(); i++) {
    const Face &f = model.faces[i];

    loose[i] = n[of[i]] == 1 && f.solid < 0 && !f.shape.IsNull() &&
               BRepAdaptor_Surface(f.shape, Standard_False).GetType() ==
                 GeomAbs_Plane;
  }
  return loose;
}

void drop_loose(const vg_cad_ask &ask, Model &model, const Talk &talk)
{
  std::vector<bool> drop(model.faces.size());
  std::string first;
  size_t n = 0;

  if (ask.solids == VG_CAD_SOLIDS_ALL) return;
  if (ask.solids == VG_CAD_SOLIDS_AUTO) drop = loose_planes(model);
  else
    for (size_t i = 0; i < drop.size(); i++)
      drop[i] = model.faces[i].solid < 0 && !model.faces[i].shape.IsNull();
  for (size_t i = 0; i < drop.size(); i++) {
    if (!drop[i]) continue;
    if (!n++) first = place(point_of(model.faces[i].shape));
    model.faces[i].shape.Nullify();
  }
  if (n)
    talk.note(format("%zu faces that belong to no solid were left out, the "
                     "first at %s (cad_solids all keeps them)",
                     n, first.c_str()));
}

void measure_volume(Model &model)
{
  Edges edges(model);
  std::vector<size_t> of = find_shells(model);
  std::vector<TopoDS_Compound> shell(of.size());
  BRep_Builder builder;
  double sum = 0, absolute = 0;
  bool solid = true;

  model.is_solid = false;
  model.volume = NAN;
  for (const std::vector<Use> &u : edges.uses)
    if (u.size() != 2) return;
  for (size_t i = 0; i < of.size(); i++) {
    if (model.faces[i].shape.IsNull()) continue;
    if (shell[of[i]].IsNull()) builder.MakeCompound(shell[of[i]]);
    builder.Add(shell[of[i]], model.faces[i].shape);
    solid = solid && model.faces[i].solid >= 0;
  }
  for (const TopoDS_Compound &s : shell) {
    GProp_GProps g;

    if (s.IsNull()) continue;
    BRepGProp::VolumeProperties(s, g, integral_near);
    sum += g.Mass();
    absolute += std::fabs(g.Mass());
  }
  model.is_solid = solid && sum > 0;
  model.volume = model.is_solid ? sum : absolute;
}

} // namespace vg_occt
