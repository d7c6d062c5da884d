/* io/occt/occt_parts.h: a CAD file in Open CASCADE's hands, in the child
 * process of io/cad. Everything here may throw: Failure, or Open CASCADE's
 * own. */
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

/** What ends a job, with a message for a person; the file's name is added by
 * the other end. */
struct Failure {
  vg_status code;
  std::string text;
};

std::string format(const char *text, ...) __attribute__((format(printf, 1, 2)));

/** "(x, y, z)". */
std::string place(const gp_Pnt &p);

/** The way back to the parent. */
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

/** A face of the file, or a piece of one. Words are "" where the file has
 * none. */
struct Face {
  uint32_t number;   /* in the file, from 1 */
  TopoDS_Face shape; /* oriented as in its solid; null: dropped */
  int solid = -1;    /* number of the solid that it bounds; -1: none */
  int behind = -1;   /* number of a second solid that has this face */
  std::string name, colour, layer, part;
};

struct Model {
  std::vector<Face> faces; /* by number; pieces of one face are neighbours */
  int n_solid = 0;         /* of the file; those that were joined count as
                              the first of them, the others have no faces */
  std::vector<TopoDS_Edge> curves; /* [number - 1], when triangulated */
  double diagonal = 0;             /* of the box around all */
  double face_size = 0;  /* median of the diagonals of the faces' boxes */
  bool is_solid = false; /* as in struct vg_cad_surface */
  double volume = 0;
};

/** Faces with names, lengths in the unit asked for.
 * @param path  the file, also when it has no name of its own */
void read(const vg_cad_ask &ask, const std::string &path, Model &model,
          const Talk &talk);

/** Faces of a shape; `most` where there are as many or more. */
size_t count_faces(const TopoDS_Shape &shape, size_t most);

/** Have shells of many faces mended in a time that grows as their number, from
 * now on, by readers of STEP and IGES that are made later. */
void mend_large_shells();

/** All faces as one shape, without those that were dropped. */
TopoDS_Compound together(const Model &model);

/** Let Open CASCADE mend all faces (curves in the plane of parameters that are
 * missing, order and gaps of rims). Faces keep their numbers. */
void mend(Model &model, const Talk &talk);

/** Mend faces where curves in the plane of parameters are missing, and measure
 * the model. */
void complete(Model &model, const Talk &talk);

/** Unite solids, drop faces that repeat others or have no area, sew open edges,
 * orient faces alike. */
void heal(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** A solid fills a hollow of another one where its box is within that one's,
 * and both share this part of its area. */
const double hollow_share = 0.5, box_near = 1e-3; /* S54 */

/** Replace the faces of solids that touch or overlap by the outer faces of
 * their union. Solids that contain others stay as they are. */
void unite(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** Tolerances to try in turn: ask.tolerance, or shares of the diagonal. */
std::vector<double> tolerances(const vg_cad_ask &ask, const Model &model);

/** Join open edges to their partners, by the tolerance that leaves the fewest.
 * Returns it. */
double sew(const vg_cad_ask &ask, Model &model, const Talk &talk);

/** Turn faces that are not of solids like their neighbours; note edges that do
 * not have two faces. tolerance: that of sewing. */
void orient(Model &model, double tolerance, const Talk &talk);

/** Shells, faces that are connected by edges: for each face of the model the
 * index of the first face of its shell. */
std::vector<size_t> find_shells(const Model &model);

/** Find out whether the model is solid, and its volume. */
void measure_volume(Model &model);

/** "face 3 (wing)", for messages. */
std::string named(const Face &f);

/** As io/cad/wire.h sends it. */
struct Surface {
  std::vector<double> point;
  std::vector<uint32_t> tri, face, patch, segment, curve; /* face: number */
  std::vector<vg_cad_patch> patches;
  /* These stay here. */
  std::vector<uint32_t> piece; /* of triangles: index into Model.faces */
  std::vector<bool> corner;    /* [points] is a vertex of the model */
  std::vector<gp_Pnt2d> uv; /* of each corner of the triangles, on its face */
  std::vector<uint8_t> rim; /* [triangles] bit k: the edge opposite corner k
                               is on the rim of its face */
  double bulge = 0;         /* the face's rim is no farther from such an edge,
                               in parts of its length */
};

/** Triangles; faces that could not be are noted. */
void triangulate(const vg_cad_ask &ask, Model &model, Surface &out,
                 const Talk &talk);

/** Triangles without area, from number `from` on, swapped away where that
 * moves nothing. O(n log n). */
void swap_caps(Surface &s, size_t from);

/** Collapse edges shorter than `least`. Corners stay where they are, points of
 * curves move along their curve. */
void collapse_short(Surface &s, double least);

/** Replace triangles that do not follow their face: those whose corners all lie
 * on the rim of a curved face, and folds. New points lie on the face. */
void follow_faces(Surface &s, const Model &model);

/** Drop points that neither triangles nor segments have. */
void drop_unused(Surface &s);

/** A triangle of a face in the plane of parameters. */
struct Piece {
  gp_Pnt2d uv[3];
  double least[3]; /* barycentric coordinates of places that are
                      surely on the face are no less */
  bool holds(const gp_Pnt2d &at) const;
};

/** The nearest points of a face, again and again. */
class Projector
{
public:
  explicit Projector(const TopoDS_Face &face);
  ~Projector();
  gp_Pnt nearest(const gp_Pnt &p);
  /* The same with a place to begin with and the triangle that it is in, which
   * is some ten times as fast. */
  gp_Pnt nearest(const gp_Pnt &p, gp_Pnt2d guess, const Piece &piece);

private:
  struct State;
  std::unique_ptr<State> state_;
};

/** The nearest point of a curve, its ends included. */
gp_Pnt nearest_on_curve(const TopoDS_Edge &edge, const gp_Pnt &p);

/** A point of a face, for messages. */
gp_Pnt point_of(const TopoDS_Face &face);

/** Points inside a face, at most n * n, over its range of parameters. */
std::vector<gp_Pnt> samples(const TopoDS_Face &face, int n);

} // namespace vg_occt

#endif
