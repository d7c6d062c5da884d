/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Triangulates faces so that they share points by topology: a vertex is one
 * point, and so is each division of an edge, for all faces that meet there. */
#include "io/occt/occt_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Vec.hxx>

namespace vg_occt
{

namespace
{

const uint32_t none = UINT32_MAX;
/* Smallest useful edge length, relative to the diagonal and to the size of the
 * median face, which a distant boundary does not affect. */
const double least_of_all = 1e-7, least_of_face = 1e-6; /* S51 */

/* Set bits in s.rim for the edges of triangles on the rims of their faces,
 * which are edges with one triangle only. Triangles of one face are adjacent in
 * the list. */
void find_rims(Surface &s)
{
  struct Side {
    uint32_t a, b;
    size_t tri;
    int corner;
  };
  std::vector<Side> sides;
  auto same = [](const Side &x, const Side &y) {
    return x.a == y.a && x.b == y.b;
  };

  s.rim.assign(s.face.size(), 0);
  for (size_t from = 0, end; from < s.face.size(); from = end) {
    sides.clear();
    for (end = from; end < s.face.size() && s.piece[end] == s.piece[from];
         end++)
      for (int k = 0; k < 3; k++) {
        uint32_t a = s.tri[3 * end + (k + 1) % 3];
        uint32_t b = s.tri[3 * end + (k + 2) % 3];

        sides.push_back({ std::min(a, b), std::max(a, b), end, k });
      }
    std::sort(sides.begin(), sides.end(), [](const Side &x, const Side &y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    });
    for (size_t i = 0; i < sides.size(); i++)
      if (!(i && same(sides[i], sides[i - 1])) &&
          !(i + 1 < sides.size() && same(sides[i], sides[i + 1])))
        s.rim[sides[i].tri] |= static_cast<uint8_t>(1 << sides[i].corner);
  }
}

class Builder
{
public:
  Builder(Model &model, Surface &out) : model_(model), out_(out)
  {
  }

  /* Returns false if the face has no triangles. */
  bool add(size_t piece, uint32_t patch)
  {
    const Face &f = model_.faces[piece];
    TopLoc_Location at;
    Handle(Poly_Triangulation) t = BRep_Tool::Triangulation(f.shape, at);

    if (t.IsNull() || !t->NbTriangles()) return false;
    global_.assign(static_cast<size_t>(t->NbNodes()) + 1, none);
    for (TopExp_Explorer e(f.shape, TopAbs_EDGE); e.More(); e.Next())
      add_edge(TopoDS::Edge(e.Current()), t, at);
    for (int k = 1; k <= t->NbNodes(); k++)
      if (global_[static_cast<size_t>(k)] == none)
        global_[static_cast<size_t>(k)] = point(node(t, at, k));
    add_triangles(piece, t, patch);
    return true;
  }

private:
  static gp_Pnt node(const Handle(Poly_Triangulation) & t,
                     const TopLoc_Location &at, int k)
  {
    return t->Node(k).Transformed(at.Transformation());
  }

  uint32_t point(const gp_Pnt &p)
  {
    uint32_t at = static_cast<uint32_t>(out_.point.size() / 3);

    out_.point.insert(out_.point.end(),
                      { p.X() + 0.0, p.Y() + 0.0, p.Z() + 0.0 });
    out_.corner.push_back(false);
    return at;
  }

  uint32_t vertex(const TopoDS_Vertex &v)
  {
    size_t at = static_cast<size_t>(vertices_.Add(v));

    if (at > vertex_.size()) {
      vertex_.push_back(point(BRep_Tool::Pnt(v)));
      out_.corner.back() = true;
    }
    return vertex_[at - 1];
  }

  /* Points of an edge from its first parameter to its last. The first face sets
   * their coordinates; all faces have the same. */
  const std::vector<uint32_t> &divisions(const TopoDS_Edge &edge,
                                         const Handle(Poly_Triangulation) & t,
                                         const TopLoc_Location &at,
                                         const TColStd_Array1OfInteger &nodes)
  {
    size_t n = static_cast<size_t>(nodes.Length());
    size_t number = static_cast<size_t>(curves_.Add(edge));
    TopoDS_Vertex first, last;

    if (number > curve_.size()) {
      model_.curves.push_back(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)));
      curve_.emplace_back();
    }
    std::vector<uint32_t> &list = curve_[number - 1];
    if (list.size() == n) return list;
    if (!list.empty())
      throw Failure{ VG_ERR_GEOMETRY,
                     format("curve %zu is divided differently by two faces",
                            number) };
    TopExp::Vertices(model_.curves[number - 1], first, last);
    list.resize(n);
    for (size_t k = 0; k < n; k++) {
      int i = nodes.Lower() + static_cast<int>(k);

      if (!k && !first.IsNull()) list[k] = vertex(first);
      else if (k + 1 == n && !last.IsNull()) list[k] = vertex(last);
      else list[k] = point(node(t, at, nodes(i)));
    }
    if (n > 1 && first.IsNull() && last.IsNull()) list[n - 1] = list[0];
    add_segments(list, static_cast<uint32_t>(number));
    return list;
  }

  void add_segments(const std::vector<uint32_t> &list, uint32_t number)
  {
    for (size_t k = 0; k + 1 < list.size(); k++) {
      if (list[k] == list[k + 1]) continue;
      out_.segment.insert(out_.segment.end(), { list[k], list[k + 1] });
      out_.curve.push_back(number);
    }
  }

  void add_edge(const TopoDS_Edge &edge, const Handle(Poly_Triangulation) & t,
                const TopLoc_Location &at)
  {
    Handle(Poly_PolygonOnTriangulation)
      p = BRep_Tool::PolygonOnTriangulation(edge, t, at);
    TopoDS_Vertex first, last;

    if (p.IsNull()) return;
    const TColStd_Array1OfInteger &nodes = p->Nodes();
    if (BRep_Tool::Degenerated(edge)) {
      TopExp::Vertices(edge, first, last);
      for (int i = nodes.Lower(); i <= nodes.Upper() && !first.IsNull(); i++)
        global_[static_cast<size_t>(nodes(i))] = vertex(first);
      return;
    }
    const std::vector<uint32_t> &list = divisions(edge, t, at, nodes);
    for (size_t k = 0; k < list.size(); k++)
      global_[static_cast<size_t>(nodes(nodes.Lower() + static_cast<int>(k)))] =
        list[k];
  }

  /* Triangles that collapsed because a vertex replaced several points are
   * dropped. */
  void add_triangles(size_t piece, const Handle(Poly_Triangulation) & t,
                     uint32_t patch)
  {
    const Face &f = model_.faces[piece];
    bool turned = f.shape.Orientation() == TopAbs_REVERSED;
    size_t from = out_.face.size();

    for (int k = 1; k <= t->NbTriangles(); k++) {
      int n[3];

      t->Triangle(k).Get(n[0], n[1], n[2]);
      if (turned) std::swap(n[1], n[2]);
      uint32_t v[3];
      for (int i = 0; i < 3; i++) v[i] = global_[static_cast<size_t>(n[i])];
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      out_.tri.insert(out_.tri.end(), v, v + 3);
      for (int i : n)
        out_.uv.push_back(t->HasUVNodes() ? t->UVNode(i) : gp_Pnt2d());
      out_.face.push_back(f.number);
      out_.patch.push_back(patch);
      out_.piece.push_back(static_cast<uint32_t>(piece));
    }
    swap_caps(out_, from);
  }

  Model &model_;
  Surface &out_;
  TopTools_IndexedMapOfShape vertices_, curves_;
  std::vector<uint32_t> vertex_;
  std::vector<std::vector<uint32_t>> curve_;
  std::vector<uint32_t> global_; /* numbers of the nodes of one face in the
                                    surface */
};

/* Relative error requested from Open CASCADE for the area of a face. */
const double area_near = 1e-4;
/* The triangles of a face have its area to this relative tolerance, or at least
 * to this fraction of the area of all faces. The mesher of Open CASCADE, which
 * reports no error then, may cover a part of a face only. */
const double face_near = 0.25, all_near = 1e-5; /* S89 */
/* A part of the area of all faces that may be missing. */
const double all_most = 1e-3; /* S89 */

/* Key and name of the patch of a face. */
std::string group_of(const vg_cad_ask &ask, const Face &f)
{
  switch (ask.patches) {
  case 1: return f.name.empty() ? f.part : f.name;
  case 2: return f.colour;
  case 3: return f.layer;
  case 4: return f.part;
  default: return f.name;
  }
}

/* Patches of faces; groups are numbered from 1 in the order of their first
 * faces. */
class Patches
{
public:
  Patches(const vg_cad_ask &ask, const Model &model,
          std::vector<vg_cad_patch> &list)
      : ask_(ask), model_(model), list_(list)
  {
    for (const Face &f : model.faces) last_ = std::max(last_, f.number);
  }

  uint32_t of(const Face &f)
  {
    const bool is_interface = !model_.zones.empty() && f.behind >= 0;
    std::string name = is_interface ? between(f) : group_of(ask_, f);
    uint32_t next = static_cast<uint32_t>(list_.size());
    vg_cad_patch p;

    auto found = known_.emplace(is_interface
                                  ? format("i %d %d", f.solid, f.behind)
                                : ask_.patches ? "g " + name
                                               : std::to_string(f.number),
                                next);

    if (!found.second) {
      list_[found.first->second].area += area(f);
      return found.first->second;
    }
    p.area = area(f);
    p.id = ask_.patches ? static_cast<int32_t>(next + 1)
         : is_interface ? static_cast<int32_t>(++last_)
                        : static_cast<int32_t>(f.number);
    p.is_interface = is_interface;
    set_name(p.name, name);
    list_.push_back(p);
    return next;
  }

private:
  /* The adaptive integration of Open CASCADE misses curved parts of some rims,
   * and the one with a fixed number of points those of others, by up to 1 % of
   * a face. The integral nearer to the area of the triangles is taken. */
  double area(const Face &f) const
  {
    GProp_GProps adaptive, fixed, triangles;

    if (!ask_.with_volume) return NAN;
    BRepGProp::SurfaceProperties(f.shape, adaptive, area_near);
    BRepGProp::SurfaceProperties(f.shape, fixed);
    BRepGProp::SurfaceProperties(f.shape, triangles, Standard_False,
                                 Standard_True);
    const double a = std::fabs(adaptive.Mass()), b = std::fabs(fixed.Mass()),
                 near = std::fabs(triangles.Mass());
    return std::fabs(a - near) <= std::fabs(b - near) ? a : b;
  }

  std::string between(const Face &f) const
  {
    return format("%.37s_to_%.37s",
                  model_.zones[static_cast<size_t>(f.solid)].name.c_str(),
                  model_.zones[static_cast<size_t>(f.behind)].name.c_str());
  }

  const vg_cad_ask &ask_;
  const Model &model_;
  std::vector<vg_cad_patch> &list_;
  std::map<std::string, uint32_t> known_;
  uint32_t last_ = 0; /* largest number of a face, or of an interface */
};

/* Deflections are relative to the size of each edge, so that a distant boundary
 * does not coarsen the body. With a single thread the result is
 * reproducible. */
void run_mesher(const vg_cad_ask &ask, const TopoDS_Shape &shape, double least)
{
  IMeshTools_Parameters p;

  p.Relative = Standard_True;
  p.Deflection = ask.chord;
  p.Angle = ask.angle * (M_PI / 180);
  p.MinSize = std::max(least, Precision::Confusion());
  p.InParallel = Standard_False;
  BRepTools::Clean(shape);
  BRepMesh_IncrementalMesh(shape, p);
}

size_t count_bare(const Model &model)
{
  TopLoc_Location at;

  return static_cast<size_t>(
    std::count_if(model.faces.begin(), model.faces.end(), [&](const Face &f) {
      return !f.shape.IsNull() &&
             BRep_Tool::Triangulation(f.shape, at).IsNull();
    }));
}

/* Faces that cannot be triangulated are repaired and tried again. */
void make_triangles(const vg_cad_ask &ask, Model &model, double least,
                    const Talk &talk)
{
  Model mended = model;
  size_t bare;

  run_mesher(ask, together(model), least);
  bare = count_bare(model);
  if (!bare) return;
  talk.stage("repairing its faces");
  mend(mended, talk);
  run_mesher(ask, together(mended), least);
  if (count_bare(mended) < bare) model = mended;
  else run_mesher(ask, together(model), least);
}

double area_of(const TopoDS_Face &face)
{
  GProp_GProps g;

  BRepGProp::SurfaceProperties(face, g, face_near / 10);
  return std::fabs(g.Mass());
}

/* Area of the triangles of each face. */
std::vector<double> areas_of(const Model &model, const Surface &s)
{
  std::vector<double> has(model.faces.size(), 0);

  for (size_t t = 0; t < s.face.size(); t++) {
    gp_Pnt p[3];

    for (size_t i = 0; i < 3; i++) {
      const double *x = s.point.data() + 3 * s.tri[3 * t + i];
      p[i].SetCoord(x[0], x[1], x[2]);
    }
    has[s.piece[t]] +=
      gp_Vec(p[0], p[1]).Crossed(gp_Vec(p[0], p[2])).Magnitude() / 2;
  }
  return has;
}

/* Find the first face that its triangles do not cover: an error if the surface
 * is then another one, else a note. */
void check_areas(const Model &model, const Surface &s, const Talk &talk)
{
  const std::vector<double> has = areas_of(model, s);
  const double all = std::accumulate(has.begin(), has.end(), 0.);
  bool said = false;

  for (size_t i = 0; i < has.size(); i++) {
    const Face &f = model.faces[i];

    if (f.shape.IsNull() || !(has[i] > 0)) continue;
    const double area = area_of(f.shape), off = std::fabs(has[i] - area);
    if (off <= face_near * area || off <= all_near * all) continue;
    const std::string face = named(f) + " at " + place(point_of(f.shape));
    const std::string text = format(
      "the triangles of %s have an area of %.4g, but the face itself %.4g: "
      "Open CASCADE covered it in part, or its rim crosses itself",
      face.c_str(), has[i], area);
    if (off > all_most * all)
      throw Uncovered{
        { VG_ERR_GEOMETRY,
          text + "; divide this face in the CAD program, or export the file in "
                 "another format (STEP, BREP) or unit (millimetres)" },
        face
      };
    if (!said)
      talk.note(text + ". If the surface lacks a part there, export the file "
                       "in another format (STEP, BREP)");
    said = true;
  }
}

} // namespace

void set_name(char (&to)[80], const std::string &name)
{
  size_t n = std::min(name.size(), sizeof to - 1);

  if (n < name.size())
    while (n && (static_cast<unsigned char>(name[n]) & 0xc0) == 0x80) n--;
  std::memset(to, 0, sizeof to);
  std::memcpy(to, name.data(), n);
  for (size_t k = 0; k < n; k++)
    if (static_cast<unsigned char>(to[k]) < ' ' || to[k] == 127) to[k] = '_';
}

void triangulate(const vg_cad_ask &ask, Model &model, Surface &out,
                 const Talk &talk)
{
  Builder builder(model, out);
  Patches patches(ask, model, out.patches);
  double least = ask.least > 0 ? ask.least
                               : std::max(least_of_all * model.diagonal,
                                          least_of_face * model.face_size);
  size_t n_bad = 0;
  std::string bad;

  model.curves.clear();
  make_triangles(ask, model, least, talk);
  /* An arc that turns by the angle rises by half of this relative to its chord;
   * the factor 2 allows for uneven parameters. */
  out.bulge = std::tan(ask.angle * (M_PI / 180) / 4);
  for (size_t i = 0; i < model.faces.size(); i++) {
    const Face &f = model.faces[i];

    if (f.shape.IsNull()) continue;
    if (builder.add(i, patches.of(f))) continue;
    if (!n_bad++)
      bad = format("face %u%s%.60s at %s", f.number, f.name.empty() ? "" : " ",
                   f.name.c_str(), place(point_of(f.shape)).c_str());
  }
  if (n_bad)
    talk.note(format("%zu faces could not be triangulated and leave holes, "
                     "the first is %s: its boundary may cross itself",
                     n_bad, bad.c_str()));
  if (out.tri.empty())
    throw Failure{ VG_ERR_GEOMETRY, "none of its faces could be triangulated" };
  if (ask.least > 0) collapse_short(out, least);
  follow_faces(out, model);
  check_areas(model, out, talk);
  find_rims(out);
}

} // namespace vg_occt
