/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/occt/occt_parts.h: a CAD file in Open CASCADE, in the child process of
 * io/cad. All functions may throw a Failure, or exceptions of Open CASCADE. */
#ifndef VG_IO_OCCT_OCCT_PARTS_H
#define VG_IO_OCCT_OCCT_PARTS_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>

#include "base/status.h"
#include "io/cad/wire.h"

namespace vg_occt
{

/** Error that ends a question, with a message for a person; the parent adds the
 * file name. */
struct Failure {
  vg_status code;
  std::string text;
};

/** Triangles do not cover a face. */
struct Uncovered : Failure {
  std::string face;
};

std::string format(const char *text, ...) __attribute__((format(printf, 1, 2)));

/** "(x, y, z)". */
std::string place(const gp_Pnt &p);

/** Connection to the parent. */
class Talk
{
public:
  Talk(int fd, const vg_cad_wire *wire) : fd_(fd), wire_(wire)
  {
  }
  void note(const std::string &text) const
  {
    say(VG_CAD_TELL_NOTE, 0, text);
  }
  void stage(const std::string &text) const
  {
    say(VG_CAD_TELL_STAGE, 0, text);
  }
  void fail(const Failure &f) const
  {
    say(VG_CAD_TELL_FAIL, f.code, f.text);
  }
  void put(const void *data, size_t size) const;
  bool get(void *data, size_t size) const;

private:
  void say(int what, int code, std::string text) const;
  int fd_;
  const vg_cad_wire *wire_;
};

/** A face of the file, or a piece of one. Texts are "" if the file has none. */
struct Face {
  uint32_t number;   /* number in the file, from 1 */
  TopoDS_Face shape; /* oriented as in its solid; null: dropped */
  int solid = -1;    /* number of the solid that it bounds; -1: none */
  int behind = -1;   /* number of a second solid with this face; -1: none */
  std::string name, colour, layer, part;
};

/** A solid that is a zone, and a point in it. */
struct Zone {
  std::string name;
  gp_Pnt seed;
};

struct Model {
  std::vector<Face> faces; /* sorted by number; pieces of one face are
                              adjacent */
  std::vector<std::string> solid_names; /* [n_solid] "": the file has none */
  std::vector<Zone> zones; /* solids, if they are zones: faces with a solid on
                              both sides (behind) are then interfaces */
  int n_solid = 0; /* solids of the file; joined solids keep the number of
                      the first of them, and the others have no faces */
  std::vector<TopoDS_Edge> loose;  /* curves of no face, as read */
  std::vector<TopoDS_Edge> curves; /* [number - 1], set by triangulation */
  double diagonal = 0;             /* diagonal of the bounding box */
  double face_size = 0;   /* median diagonal of the faces' bounding boxes */
  bool is_united = false; /* are faces those of a union of solids? */
  bool is_solid = false;  /* see struct vg_cad_surface */
  double volume = 0;
  int unit = 0; /* enum vg_cad_unit; 0: not known */
};

/** Read the faces with their names, with lengths in the requested unit.
 * @param path  the file, also if it has no name of its own */
void read(const vg_cad_ask &ask, const std::string &path, Model &model,
          const Talk &talk);

/** The curves of the file as a plane section: points (x, y, 0) or (x, z, 0),
 * and a segment for each wire, with its first and last point, which coincide if
 * it is closed. */
void section(const vg_cad_ask &ask, const Model &model, struct Surface &out);

/** Number of faces of a shape; `most` if there are at least that many. */
size_t count_faces(const TopoDS_Shape &shape, size_t most);

/** Make readers of STEP and IGES that are created later repair shells with many
 * faces in linear time. */
void mend_large_shells();

/** In a file with solids, drop faces that belong to none, as ask.solids
 * requests, with a note. */
void drop_loose(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** All faces that were not dropped, as one shape. */
TopoDS_Compound together(const Model &model);

/** Let Open CASCADE repair all faces: missing curves in the parameter plane,
 * and the order and gaps of rims. Faces keep their numbers. */
void mend(Model &model, const Talk &talk);

/** Mend faces whose curves in the parameter plane are missing, and measure the
 * model. */
void complete(Model &model, const Talk &talk);

/** Unite solids, drop faces that repeat others or have no area, sew open edges,
 * and orient faces consistently. */
void heal(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** A solid fills a hollow of another one if its bounding box is inside that of
 * the other and both share at least this fraction of its area. */
const double hollow_share = 0.5, box_near = 1e-3; /* S54 */

/** Replace the faces of solids that touch or overlap by the outer faces of
 * their union. Solids that contain others are not changed.
 * @param is_last  note the solids that could not be united
 * @param said     notes of unions, which are not repeated; appended to
 * @returns false if a solid is not closed, or some could not be united */
bool unite(const vg_cad_ask &ask, bool is_last, Model &model,
           std::vector<std::string> &said, const Talk &talk);

/** Make a zone of each solid: divide the faces of solids that touch by each
 * other, so that those between two solids occur once. VG_ERR_INPUT: solids are
 * open or overlap, or none of them touch. VG_ERR_GEOMETRY: the general fuse
 * fails. */
void separate(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** Tolerances to be tried in this order: ask.tolerance, or fractions of the
 * diagonal. */
std::vector<double> tolerances(const vg_cad_ask &ask, const Model &model);

/** Join open edges with the tolerance that leaves the fewest of them. Returns
 * the tolerance. */
double sew(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** Orient faces that do not belong to solids like their neighbours, and note
 * edges that do not have two faces. tolerance: that of sewing. */
void orient(Model &model, double tolerance, const Talk &talk);

/** Shells, which are faces connected by edges: for each face of the model, the
 * index of the first face of its shell. */
std::vector<size_t> find_shells(const Model &model);

/** Determine whether the model is solid, and its volume. */
void measure_volume(Model &model);

/** Copy a name of the file, shortened without splitting characters; control
 * characters become '_'. */
void set_name(char (&to)[80], const std::string &name);

/** "face 3 (wing)", for messages. */
std::string named(const Face &f);

/** The surface that io/cad/wire.h sends. */
struct Surface {
  std::vector<double> point;
  std::vector<uint32_t> tri, face, patch, segment, curve; /* face: numbers */
  std::vector<vg_cad_patch> patches;
  /* The members below are not sent. */
  std::vector<uint32_t> piece; /* [triangles] index into Model.faces */
  std::vector<bool> corner; /* [points] is the point a vertex of the model? */
  std::vector<gp_Pnt2d> uv; /* parameters on the face of each vertex of the
                               triangles */
  std::vector<uint8_t> rim; /* [triangles] bit k: the edge opposite vertex k
                               is on the rim of its face */
  double bulge = 0; /* bound for the distance of the face's rim from such an
                       edge, relative to the length of the edge */
};

/** Triangulate the model; faces that fail are noted. Throws Uncovered. */
void triangulate(const vg_cad_ask &ask, Model &model, Surface &out,
                 const Talk &talk);

/** Remove triangles without area, from number `from` on, by swaps, where that
 * moves no point. O(n log n). */
void swap_caps(Surface &s, size_t from);

/** Collapse edges shorter than `least`. Corners do not move; points of curves
 * move along their curve. */
void collapse_short(Surface &s, double least);

/** Replace triangles that do not follow their face: those whose vertices are
 * all on the rim of a curved face, and folds. New points are on the face. */
void follow_faces(Surface &s, const Model &model);

/** Remove points that neither triangles nor segments use. */
void drop_unused(Surface &s);

/** A triangle of a face in the parameter plane. */
struct Piece {
  gp_Pnt2d uv[3];
  double least[3]; /* points whose barycentric coordinates are not smaller
                      are certainly on the face */
  bool holds(const gp_Pnt2d &at) const;
};

/** Finds nearest points on one face, repeatedly. */
class Projector
{
public:
  explicit Projector(const TopoDS_Face &face);
  ~Projector();
  gp_Pnt nearest(const gp_Pnt &p);
  /* As above, with a starting point and the triangle that contains it, which is
   * some ten times as fast. */
  gp_Pnt nearest(const gp_Pnt &p, gp_Pnt2d guess, const Piece &piece);

private:
  struct State;
  std::unique_ptr<State> state_;
};

/** Nearest point of a curve, including its ends. */
gp_Pnt nearest_on_curve(const TopoDS_Edge &edge, const gp_Pnt &p);

/** A point of a face, for messages. */
gp_Pnt point_of(const TopoDS_Face &face);

/** Points inside a face, at most n * n, over its range of parameters. */
std::vector<gp_Pnt> samples(const TopoDS_Face &face, int n);

} // namespace vg_occt

#endif
