/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Replaces solids that touch or overlap by their union.
 *
 * Open CASCADE's general fuse divides all solids of a group by each other into
 * cells that share faces. A face of one cell is an outer face; a face of two
 * cells is between materials and is dropped. A solid whose cells are among
 * those of another one is inside it. The larger one may then be the fluid
 * around it, so it is not changed. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <BOPAlgo_Builder.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>

namespace vg_occt
{

namespace
{

/* Largest number of faces of all solids of a group for which the union is
 * tried; beyond this the time grows too fast. */
const size_t most_faces = 5000;

/* The volume of a solid's cells equals that of the solid to this relative
 * tolerance. */
const double volume_near = 1e-2; /* S54 */

typedef std::vector<size_t> Group;        /* numbers of solids, ascending */
typedef std::vector<TopoDS_Shape> Solids; /* null: the solid is not closed */

/* Does every edge have an even number of these faces? */
bool is_closed(const std::vector<TopoDS_Shape> &faces)
{
  TopTools_IndexedMapOfShape edges;
  std::vector<size_t> n;

  for (const TopoDS_Shape &f : faces)
    for (TopExp_Explorer e(f, TopAbs_EDGE); e.More(); e.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
      size_t at = static_cast<size_t>(edges.Add(e.Current()));

      if (at > n.size()) n.push_back(0);
      n[at - 1]++;
    }
  return !n.empty() &&
         std::all_of(n.begin(), n.end(), [](size_t k) { return k % 2 == 0; });
}

/* Collects the shells and faces of each solid. */
class Shells
{
public:
  explicit Shells(const Model &model)
      : faces_(static_cast<size_t>(model.n_solid))
  {
    const std::vector<size_t> of = find_shells(model);

    for (size_t i = 0; i < of.size(); i++) {
      const Face &f = model.faces[i];

      if (f.shape.IsNull()) continue;
      if (f.solid >= 0) add(f.solid, of[i], f.shape);
      if (f.behind >= 0) add(f.behind, of[i], f.shape.Reversed());
    }
  }

  Solids solids() const
  {
    Solids out(faces_.size());

    for (const auto &one : shell_) {
      const size_t k = static_cast<size_t>(one.first.first);
      TopoDS_Shell shell = one.second;
      TopoDS_Solid solid;

      if (!is_closed(faces_[k])) continue;
      if (out[k].IsNull()) {
        BRep_Builder().MakeSolid(solid);
        out[k] = solid;
      }
      shell.Closed(Standard_True);
      BRep_Builder().Add(out[k], shell);
    }
    return out;
  }

private:
  void add(int solid, size_t connected, const TopoDS_Shape &face)
  {
    TopoDS_Shell &shell = shell_[{ solid, connected }];

    faces_[static_cast<size_t>(solid)].push_back(face);
    if (shell.IsNull()) BRep_Builder().MakeShell(shell);
    BRep_Builder().Add(shell, face);
  }

  std::vector<std::vector<TopoDS_Shape>> faces_; /* of each solid */
  std::map<std::pair<int, size_t>, TopoDS_Shell> shell_;
};

/* Groups of solids whose bounding boxes touch directly or through others. */
std::vector<Group> touching(const Solids &solids, double tolerance)
{
  std::vector<Bnd_Box> box(solids.size());
  std::vector<size_t> of(box.size());
  std::vector<Group> out(box.size());

  for (size_t i = 0; i < box.size(); i++) {
    of[i] = i;
    if (solids[i].IsNull())
      continue; /* its box stays void and touches
                   nothing */
    BRepBndLib::Add(solids[i], box[i], Standard_False);
    box[i].Enlarge(tolerance);
    for (size_t j = 0; j < i; j++)
      if (of[j] != of[i] && !box[i].IsOut(box[j])) {
        size_t from = std::max(of[i], of[j]), to = std::min(of[i], of[j]);

        std::replace(of.begin(), of.begin() + static_cast<ptrdiff_t>(i) + 1,
                     from, to);
      }
  }
  for (size_t i = 0; i < of.size(); i++) out[of[i]].push_back(i);
  out.erase(std::remove_if(out.begin(), out.end(),
                           [](const Group &g) { return g.size() < 2; }),
            out.end());
  return out;
}

/* Cells of a group of solids. */
class Cells
{
public:
  Cells(const Solids &solids, const Group &group, double tolerance)
      : group_(group)
  {
    for (size_t k : group) fuse_.AddArgument(solids[k]);
    fuse_.SetNonDestructive(Standard_True);
    fuse_.SetRunParallel(Standard_False);
    fuse_.SetFuzzyValue(tolerance);
    fuse_.Perform();
    failed_ = fuse_.HasErrors();
    if (failed_) return;
    for (size_t k : group) {
      cells_.push_back(cells_of(solids[k]));
      failed_ = failed_ || !fills(cells_.back(), solids[k]);
    }
    take_faces();
  }

  bool failed() const
  {
    return failed_;
  }

  /* Do any two of the solids touch? */
  bool touch() const
  {
    TopTools_IndexedMapOfShape all;

    for (const TopTools_IndexedMapOfShape &cells : cells_) {
      TopTools_IndexedMapOfShape mine;

      for (int i = 1; i <= cells.Extent(); i++)
        TopExp::MapShapes(cells(i), TopAbs_VERTEX, mine);
      for (int i = 1; i <= mine.Extent(); i++)
        if (all.Contains(mine(i))) return true;
      for (int i = 1; i <= mine.Extent(); i++) all.Add(mine(i));
    }
    return false;
  }

  /* Solids that completely contain another one, or have a hollow that another
   * one fills. */
  Group containers() const
  {
    Group out;

    for (size_t i = 0; i < group_.size(); i++)
      for (size_t j = 0; j < group_.size(); j++)
        if (i != j && (contains(cells_[i], cells_[j]) || is_hollow(i, j))) {
          out.push_back(group_[i]);
          break;
        }
    return out;
  }

  /* Two solids of the group that have a common cell. */
  bool overlap(size_t &a, size_t &b) const
  {
    for (size_t i = 0; i < group_.size(); i++)
      for (size_t j = 0; j < i; j++)
        for (int k = 1; k <= cells_[i].Extent(); k++)
          if (cells_[j].Contains(cells_[i](k))) {
            a = group_[j];
            b = group_[i];
            return true;
          }
    return false;
  }

  /* The solids of the group on the sides of each face, in ascending order. */
  std::vector<Group> owners() const
  {
    std::vector<Group> out(static_cast<size_t>(faces_.Extent()));

    for (size_t i = 0; i < group_.size(); i++) {
      TopTools_IndexedMapOfShape mine;

      for (int k = 1; k <= cells_[i].Extent(); k++)
        TopExp::MapShapes(cells_[i](k), TopAbs_FACE, mine);
      for (int k = 1; k <= mine.Extent(); k++)
        out[index(mine(k))].push_back(group_[i]);
    }
    return out;
  }

  size_t index(const TopoDS_Shape &face) const
  {
    return static_cast<size_t>(faces_.FindIndex(face)) - 1;
  }

  /* The faces that a face of the file became, with at most this many cells;
   * each is returned for one face of the file only. */
  std::vector<TopoDS_Face> take(const TopoDS_Face &face, size_t most = 1)
  {
    const TopTools_ListOfShape &list = fuse_.Modified(face);
    std::vector<TopoDS_Face> out;

    if (list.IsEmpty()) add(face, most, out);
    for (const TopoDS_Shape &s : list) add(s, most, out);
    return out;
  }

  /* Are all cells valid, are the outer faces closed, and were all faces with at
   * most this many cells taken? */
  bool is_whole(size_t most = 1) const
  {
    std::vector<TopoDS_Shape> outer;

    for (const TopTools_IndexedMapOfShape &cells : cells_)
      for (int i = 1; i <= cells.Extent(); i++)
        if (!BRepCheck_Analyzer(cells(i)).IsValid()) return false;
    for (int i = 1; i <= faces_.Extent(); i++) {
      const size_t at = static_cast<size_t>(i) - 1;

      if (count_[at] <= most && !taken_[at]) return false;
      if (count_[at] == 1) outer.push_back(faces_(i));
    }
    return is_closed(outer);
  }

private:
  TopTools_IndexedMapOfShape cells_of(const TopoDS_Shape &solid)
  {
    const TopTools_ListOfShape &list = fuse_.Modified(solid);
    TopTools_IndexedMapOfShape out;

    if (list.IsEmpty()) out.Add(solid);
    for (const TopoDS_Shape &s : list) out.Add(s);
    return out;
  }

  /* Do the cells fill the solid? The fuse may lose cells without reporting an
   * error. */
  static bool fills(const TopTools_IndexedMapOfShape &cells,
                    const TopoDS_Shape &solid)
  {
    double sum = 0, whole = volume(solid);

    for (int i = 1; i <= cells.Extent(); i++) sum += volume(cells(i));
    return whole > 0 && std::fabs(sum - whole) <= volume_near * whole;
  }

  static double volume(const TopoDS_Shape &s)
  {
    GProp_GProps g;

    BRepGProp::VolumeProperties(s, g, volume_near / 10);
    return g.Mass();
  }

  /* Is solid j inside the bounding box of solid i, and do the two share much of
   * its area but none of its material? */
  bool is_hollow(size_t i, size_t j) const
  {
    TopTools_IndexedMapOfShape mine, other;
    Bnd_Box box = box_of(i), both = box;
    double total = 0, common = 0;

    for (int k = 1; k <= cells_[j].Extent(); k++)
      if (cells_[i].Contains(cells_[j](k))) return false;
    both.Add(box_of(j));
    if (both.SquareExtent() > box.SquareExtent() * (1 + box_near)) return false;
    for (int k = 1; k <= cells_[i].Extent(); k++)
      TopExp::MapShapes(cells_[i](k), TopAbs_FACE, mine);
    for (int k = 1; k <= cells_[j].Extent(); k++)
      TopExp::MapShapes(cells_[j](k), TopAbs_FACE, other);
    for (int k = 1; k <= other.Extent(); k++) {
      GProp_GProps g;

      BRepGProp::SurfaceProperties(other(k), g);
      total += g.Mass();
      if (mine.Contains(other(k))) common += g.Mass();
    }
    return common >= hollow_share * total;
  }

  Bnd_Box box_of(size_t i) const
  {
    Bnd_Box box;

    for (int k = 1; k <= cells_[i].Extent(); k++)
      BRepBndLib::Add(cells_[i](k), box, Standard_False);
    return box;
  }

  static bool contains(const TopTools_IndexedMapOfShape &a,
                       const TopTools_IndexedMapOfShape &b)
  {
    for (int i = 1; i <= b.Extent(); i++)
      if (!a.Contains(b(i))) return false;
    return a.Extent() > b.Extent();
  }

  /* Collect the faces of all cells, oriented as in their first cell. */
  void take_faces()
  {
    TopTools_IndexedMapOfShape all;

    for (const TopTools_IndexedMapOfShape &cells : cells_)
      for (int i = 1; i <= cells.Extent(); i++) all.Add(cells(i));
    for (int i = 1; i <= all.Extent(); i++)
      for (TopExp_Explorer e(all(i), TopAbs_FACE); e.More(); e.Next()) {
        size_t at = static_cast<size_t>(faces_.Add(e.Current()));

        if (at > count_.size()) count_.push_back(0);
        count_[at - 1]++;
      }
    taken_.assign(count_.size(), false);
  }

  void add(const TopoDS_Shape &s, size_t most, std::vector<TopoDS_Face> &out)
  {
    size_t at = static_cast<size_t>(faces_.FindIndex(s));

    if (!at || count_[at - 1] > most || taken_[at - 1]) return;
    taken_[at - 1] = true;
    out.push_back(TopoDS::Face(faces_(static_cast<int>(at))));
  }

  const Group &group_;
  BOPAlgo_Builder fuse_;
  bool failed_ = false;
  std::vector<TopTools_IndexedMapOfShape> cells_; /* cells of each solid */
  TopTools_IndexedMapOfShape faces_;
  std::vector<size_t> count_; /* number of cells of each face */
  std::vector<bool> taken_;
};

bool has(const Group &group, int solid)
{
  return solid >= 0 && std::binary_search(group.begin(), group.end(),
                                          static_cast<size_t>(solid));
}

std::string where(const Model &model, size_t solid)
{
  for (const Face &f : model.faces)
    if (f.solid == static_cast<int>(solid) && !f.shape.IsNull())
      return format("%s%sat %s", f.part.substr(0, 60).c_str(),
                    f.part.empty() ? "" : " ",
                    place(point_of(f.shape)).c_str());
  return "somewhere";
}

/* Replace the faces of the group by those of its union, which is then one
 * solid; returns false if the union is not closed. A face between the group and
 * another solid stays with the latter. */
bool replace_faces(Cells &cells, const Group &group, Model &model)
{
  std::vector<Face> out;

  for (const Face &f : model.faces) {
    const bool mine = has(group, f.solid), behind = has(group, f.behind);

    if (f.shape.IsNull() || !(mine || behind)) {
      out.push_back(f);
      continue;
    }
    std::vector<TopoDS_Face> pieces = cells.take(f.shape);
    Face next = f;

    if (behind) next.behind = -1;
    if (mine) next.solid = static_cast<int>(group[0]);
    if (mine) next.shape.Nullify();
    if (pieces.empty() || !mine) out.push_back(next);
    for (const TopoDS_Face &piece : pieces) {
      if (!mine) break;
      next.shape = piece;
      out.push_back(next);
    }
  }
  if (!cells.is_whole()) return false;
  model.faces = out;
  model.is_united = true;
  return true;
}

/* Unite one group, without the solids that contain others; notes are added to
 * `say`. */
void unite_group(const Solids &solids, Group group, double tolerance,
                 Model &model, std::vector<std::string> &say)
{
  for (;;) {
    Cells cells(solids, group, tolerance);

    if (cells.failed())
      throw Failure{ VG_ERR_GEOMETRY, "the general fuse failed" };
    if (!cells.touch()) return;
    Group outer = cells.containers(), rest;
    if (outer.empty()) {
      std::string first = where(model, group[0]);

      if (!replace_faces(cells, group, model))
        throw Failure{ VG_ERR_GEOMETRY, "its result is not valid" };
      say.push_back(format("%zu solids touch or overlap and were united within "
                           "%.3g: their common walls were dropped, the first "
                           "solid is %s",
                           group.size(), tolerance, first.c_str()));
      return;
    }
    for (size_t k : outer)
      say.push_back(format("the solid %s contains another one and was not "
                           "united with it. Where they touch, subtract the "
                           "inner one if the outer one is the fluid, "
                           "otherwise delete it",
                           where(model, k).c_str()));
    std::set_difference(group.begin(), group.end(), outer.begin(), outer.end(),
                        std::back_inserter(rest));
    if (rest.size() < 2) return;
    group = rest;
  }
}

/* Reason of a failure; empty on success. Texts that were said are not
 * repeated. */
std::string try_to_unite(const Solids &solids, const Group &group,
                         double tolerance, Model &model,
                         std::vector<std::string> &said, const Talk &talk)
{
  std::vector<std::string> say;

  try {
    unite_group(solids, group, tolerance, model, say);
  } catch (const Failure &f) {
    return f.text;
  } catch (const Standard_Failure &f) {
    return f.DynamicType()->Name();
  }
  for (const std::string &text : say) {
    if (std::find(said.begin(), said.end(), text) != said.end()) continue;
    talk.note(text);
    said.push_back(text);
  }
  return "";
}

size_t count_faces_of(const Model &model, const Group &group)
{
  return static_cast<size_t>(
    std::count_if(model.faces.begin(), model.faces.end(), [&](const Face &f) {
      return has(group, f.solid) || has(group, f.behind);
    }));
}

/* Do all solids that have faces have a shape? */
bool are_complete(const Model &model, const Solids &solids)
{
  auto lacks = [&](int k) {
    return k >= 0 && solids[static_cast<size_t>(k)].IsNull();
  };

  return std::none_of(model.faces.begin(), model.faces.end(),
                      [&](const Face &f) {
                        return !f.shape.IsNull() &&
                               (lacks(f.solid) || lacks(f.behind));
                      });
}

/* --- zones --------------------------------------------------------------- */

/* Replace the faces of the group by the pieces into which they divide each
 * other. Returns the reason of a failure; empty on success. */
std::string separate_group(const Solids &solids, const Group &group,
                           double tolerance, Model &model)
{
  Cells cells(solids, group, tolerance);
  std::vector<Face> out;
  size_t a, b;

  if (cells.failed()) return "the general fuse failed";
  if (cells.overlap(a, b))
    throw Failure{ VG_ERR_INPUT,
                   format("the solids %s and %s overlap, so that a place would "
                          "be in two zones; subtract one from the other",
                          where(model, a).c_str(), where(model, b).c_str()) };
  const std::vector<Group> owners = cells.owners();
  for (const Face &f : model.faces) {
    if (f.shape.IsNull() || !has(group, f.solid)) {
      out.push_back(f);
      continue;
    }
    for (const TopoDS_Face &piece : cells.take(f.shape, 2)) {
      const Group &of = owners[cells.index(piece)];
      Face next = f;

      next.shape = piece;
      next.solid = static_cast<int>(of[0]);
      next.behind = of.size() > 1 ? static_cast<int>(of[1]) : -1;
      out.push_back(next);
    }
  }
  if (!cells.is_whole(2)) return "its result is not valid";
  model.faces = out;
  return "";
}

/* The names of the solids; none occurs twice. A note tells of solids that have
 * got another name than in the file. */
std::vector<std::string> zone_names(const Model &model, const Talk &talk)
{
  std::vector<std::string> out;

  for (size_t i = 0; i < static_cast<size_t>(model.n_solid); i++) {
    const std::string own = model.solid_names[i].substr(0, 70);
    std::string name = own.empty() ? format("solid_%zu", i + 1) : own;

    for (size_t k = 2; std::find(out.begin(), out.end(), name) != out.end();
         k++)
      name = format("%s_%zu", own.empty() ? "solid" : own.c_str(), k);
    if (!own.empty() && name != own)
      talk.note(format("several solids have the name %s: solid %zu is the zone "
                       "%s",
                       own.c_str(), i + 1, name.c_str()));
    out.push_back(name);
  }
  return out;
}

/* Number of points of the surface of a solid that are tried in pairs. */
const size_t most_points = 40;

/* The point inside a solid that is farthest from points of its faces, among the
 * midpoints between these points. */
gp_Pnt point_in(const TopoDS_Shape &solid, const std::string &name)
{
  BRepClass3d_SolidClassifier side(solid);
  std::vector<gp_Pnt> on;
  gp_Pnt best;
  double most = 0;

  for (int n = 1; n < 6 && on.size() < most_points; n++)
    for (TopExp_Explorer e(solid, TopAbs_FACE);
         e.More() && on.size() < most_points; e.Next())
      for (const gp_Pnt &p : samples(TopoDS::Face(e.Current()), n))
        on.push_back(p);
  for (size_t i = 0; i < on.size(); i++)
    for (size_t j = 0; j < i; j++) {
      const gp_Pnt p((on[i].XYZ() + on[j].XYZ()) / 2);
      double near = p.SquareDistance(on[0]);

      for (const gp_Pnt &q : on) near = std::min(near, p.SquareDistance(q));
      if (near <= most) continue;
      side.Perform(p, Precision::Confusion());
      if (side.State() != TopAbs_IN) continue;
      most = near;
      best = p;
    }
  if (!(most > 0))
    throw Failure{ VG_ERR_GEOMETRY,
                   format("no point inside the solid %s was found",
                          name.c_str()) };
  return best;
}

} // namespace

void separate(const vg_cad_ask &ask, Model &model, const Talk &talk)
{
  const Solids solids = Shells(model).solids();
  const std::vector<double> list = tolerances(ask, model);
  const std::vector<std::string> names = zone_names(model, talk);
  size_t n = 0;

  talk.stage("dividing the faces of its solids");
  if (model.n_solid < 2)
    throw Failure{ VG_ERR_INPUT,
                   format("solids in it: %d; zones need two that touch; "
                          "export its parts as solids, or remove cad_solids "
                          "zones",
                          model.n_solid) };
  for (size_t i = 0; i < solids.size(); i++)
    if (solids[i].IsNull())
      throw Failure{ VG_ERR_INPUT,
                     format("the solid %s is not closed and cannot be a zone; "
                            "export closed solids",
                            where(model, i).c_str()) };
  for (const Group &group : touching(solids, list[0])) {
    std::string why = "they have too many faces";

    if (count_faces_of(model, group) <= most_faces)
      for (size_t i = 0; i < list.size() && !why.empty(); i++)
        why = separate_group(solids, group, list[i], model);
    if (!why.empty())
      throw Failure{ VG_ERR_GEOMETRY,
                     format("%zu solids touch, but cannot be zones (%s); the "
                            "first solid is %s; try another cad_tolerance",
                            group.size(), why.c_str(),
                            where(model, group[0]).c_str()) };
  }
  for (const Face &f : model.faces) n += !f.shape.IsNull() && f.behind >= 0;
  if (!n)
    throw Failure{ VG_ERR_INPUT,
                   format("none of its %d solids touch within %.3g, so that no "
                          "zones have a common wall; raise cad_tolerance, or "
                          "remove cad_solids zones",
                          model.n_solid, list[0]) };
  for (size_t i = 0; i < solids.size(); i++)
    model.zones.push_back({ names[i], point_in(solids[i], names[i]) });
  talk.note(format("%zu solids are zones; faces between two of them: %zu",
                   model.zones.size(), n));
}

bool unite(const vg_cad_ask &ask, bool is_last, Model &model,
           std::vector<std::string> &said, const Talk &talk)
{
  const Solids solids = Shells(model).solids();
  const std::vector<double> list = tolerances(ask, model);
  bool done = are_complete(model, solids);

  talk.stage(is_last ? VG_CAD_STAGE_UNITE : VG_CAD_STAGE_UNITE_WHOLE);
  for (const Group &group : touching(solids, list[0])) {
    std::string why = "it has too many faces";

    if (count_faces_of(model, group) <= most_faces)
      for (size_t i = 0; i < list.size() && !why.empty(); i++)
        why = try_to_unite(solids, group, list[i], model, said, talk);
    done = done && why.empty();
    if (!why.empty() && is_last)
      talk.note(format("%zu solids touch or overlap, but could not be united "
                       "(%s); only walls that they share as a whole are "
                       "dropped; the first solid is %s",
                       group.size(), why.c_str(),
                       where(model, group[0]).c_str()));
  }
  return done;
}

} // namespace vg_occt
