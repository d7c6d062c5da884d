/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cad/cad.h: surfaces from CAD files (STEP, IGES, BREP), read by Open
 * CASCADE.
 *
 * On damaged files Open CASCADE throws exceptions, raises signals, enters
 * endless loops and leaks memory, and it depends on seventy shared libraries.
 * Therefore only a child process (base/child.h) loads it (io/occt,
 * libvanguard-cad.so). The child keeps the model: as long as it lives, points
 * can be projected to the model's faces and curves.
 *
 * The result depends on the file and the options, and on the processor, since
 * Open CASCADE uses libm, which selects code for the processor. The ranks of a
 * job must therefore receive the surface from a single rank, as in
 * run/input/share.h. */
#ifndef VG_IO_CAD_CAD_H
#define VG_IO_CAD_CAD_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

enum vg_cad_kind { VG_CAD_NONE, VG_CAD_STEP, VG_CAD_IGES, VG_CAD_BREP };

/** Length unit of the result; FILE: the unit of the file. */
enum vg_cad_unit {
  VG_CAD_UNIT_FILE,
  VG_CAD_UNIT_MM,
  VG_CAD_UNIT_CM,
  VG_CAD_UNIT_M,
  VG_CAD_UNIT_KM,
  VG_CAD_UNIT_INCH,
  VG_CAD_UNIT_FOOT,
  VG_CAD_UNIT_N
};

/** What makes a patch: each face, or all faces with the same name, colour,
 * layer or part. */
enum vg_cad_patches {
  VG_CAD_BY_FACE,
  VG_CAD_BY_NAME,
  VG_CAD_BY_COLOUR,
  VG_CAD_BY_LAYER,
  VG_CAD_BY_PART,
  VG_CAD_BY_N
};

/** Which faces of a file with solids are read. */
enum vg_cad_solids {
  VG_CAD_SOLIDS_AUTO,  /* All but plane faces that belong to no solid, bound
                          nothing and touch nothing: datum planes, sketches. */
  VG_CAD_SOLIDS_ONLY,  /* Those of solids. */
  VG_CAD_SOLIDS_ALL,   /* All. */
  VG_CAD_SOLIDS_ZONES, /* Those of solids, each of which is a zone: a face that
                          two solids share is an interface. */
  VG_CAD_SOLIDS_N
};

struct vg_cad_options {
  int32_t unit;     /* see enum vg_cad_unit */
  int32_t solids;   /* see enum vg_cad_solids */
  int32_t patches;  /* see enum vg_cad_patches */
  double tolerance; /* gaps between faces up to this size are sewn, in the
                       unit of the result; 0: 1e-6 of the diagonal of the
                       bounding box */
  double chord;     /* chord height: distance of an edge of the triangulation
                       from its curve, relative to the size of that curve; for a
                       face, of the largest of its edges */
  double angle; /* degrees between neighbouring edges on a curve, and between
                   neighbouring triangles on a face */
  /* Smallest useful edge length, in the unit of the result. Curves and faces
   * are not divided below it, and shorter edges are collapsed, except between
   * two corners of the model and where triangles would be inverted. 0: no edge
   * is collapsed, and the limit of division is 1e-7 of the diagonal of the
   * bounding box, or 1e-6 of that of the median face, whichever is larger. */
  double least;
  double seconds;   /* time limit; 0: 360 and 60 per megabyte of the file */
  int keeps_solids; /* 1: solids that touch or overlap are triangulated one by
                       one, each with all its faces; 0: they are united */
  /* 1: the curves of the file are a plane section: those of its faces, or those
   * of no face. The result has no triangles, but points (x, y, 0), or (x, z, 0)
   * of curves in a plane y = constant, and a segment for each wire from its
   * first to its last point; these coincide if the wire is closed. Closed wires
   * begin at their rearmost point. */
  int is_section;
  /* Receives lines for a report: the unit, and the faces and edges that were
   * healed or dropped, with their locations. May be NULL. */
  void (*note)(void *user, const char *text);
  void *user;          /* passed to note */
  struct vg_stop stop; /* polled ten times a second */
};
#define VG_CAD_OPTIONS_INIT                                                    \
  {                                                                            \
    .chord = 2e-3, .angle = 15                                                 \
  } /* S15 */

/** A solid, or a zone of a volume mesh, as a zone. */
struct vg_cad_zone {
  double seed[3]; /* a point in it */
  int32_t kind;   /* VG_ZONE_... */
  char name[VG_NAME_MAX];
};

struct vg_cad_zones {
  size_t n;
  struct vg_cad_zone *of; /* [n] owned */
};

/** A triangulated model. Faces and curves have the numbers of the file's faces
 * and edges, counted from 1 in the order of its shells. Numbers of dropped
 * faces and curves are not used. */
struct vg_cad_surface {
  /* Triangles, oriented as the faces: normals point out of solids. Points on a
   * curve shared by faces are shared too, by topology. The id of a patch is the
   * number of its face, or of its group. */
  struct vg_mesh mesh;
  uint32_t *tri_face; /* [mesh.n_tri] number of each triangle's face */
  size_t n_segment;
  uint32_t (*segment)[2];  /* [n_segment] edges on curves, in order */
  uint32_t *segment_curve; /* [n_segment] number of each segment's curve */
  int is_solid; /* 1: every face bounds a closed solid of the file, and its
                   normals point out of the material */
  /* Volume enclosed by the faces, integrated over their exact geometry. For
   * solids it is the volume of their material, for other faces the sum of the
   * absolute volumes of connected shells. NAN if an edge does not have exactly
   * two faces. */
  double volume;
  double *area;   /* [mesh.n_patch] area of each patch, integrated in the same
                     way; NAN: not known. */
  int unit;       /* enum vg_cad_unit, of the result; FILE: not known */
  size_t n_solid; /* number of solids of the file */
  /* With VG_CAD_SOLIDS_ZONES: the solids, in the order of the file. Patches
   * with is_interface have the faces between two of them, once each. */
  struct vg_cad_zones zones;
};
#define VG_CAD_SURFACE_INIT                                                    \
  {                                                                            \
    .mesh = VG_MESH_INIT                                                       \
  }
void vg_cad_surface_release(struct vg_cad_surface *s);

struct vg_cad; /* a child process with a model */

/** Returns 1 if this build can read CAD. */
int vg_cad_is_built(void);

/** Version with which the library for CAD was built. */
void vg_library_occt(struct vg_library *out);

/** Start a child. VG_ERR_UNSUPPORTED in a build without Open CASCADE;
 * VG_ERR_MEMORY if the system refuses a process. */
vg_status vg_cad_open(struct vg_cad **out, struct vg_error *err);

/** End the child; accepts NULL. The child also ends with this process. */
void vg_cad_close(struct vg_cad *c);

/** Read, heal and triangulate a file; its model replaces the previous one. May
 * be called again after any failure, which then starts a new child.
 *
 * Faces that repeat another face, and faces without area, are dropped, each
 * with a note that gives its location. Shells with open edges are sewn with
 * o->tolerance. Faces that could not be triangulated, and edges with only one
 * face, are noted and remain open.
 * VG_ERR_FORMAT: the file is truncated, or not of this kind; VG_ERR_INPUT: it
 * has no faces; VG_ERR_GEOMETRY: Open CASCADE crashed; VG_ERR_IO: it took
 * longer than o->seconds, or was killed; VG_ERR_STOPPED. *out is unchanged on
 * failure. Threads: one at a time for each child. */
vg_status vg_cad_parse(struct vg_cad *c, struct vg_input *in,
                       enum vg_cad_kind kind, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err);

/** Triangulate the model of the last vg_cad_parse again, with the patches,
 * chord, angle and least of `o`. The file is not read again, and unit and
 * tolerance do not change. The result is that of vg_cad_parse with these
 * options. VG_CAD_ON_TRIANGLES then refers to the new triangles; after a
 * failure it refers to the previous ones, as long as the child lives.
 * Status as for vg_cad_parse; VG_ERR_INPUT without a model. *out is unchanged
 * on failure. */
vg_status vg_cad_again(struct vg_cad *c, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err);

/** Project points to faces or curves of the model.
 *
 * @param on        faces, curves, or triangles of the parsed surface, which
 *                  select their faces
 * @param number    [n] of the face or curve (from 1), or the triangle (from 0),
 *                  for each point
 * @param point     in: [n][3]; out: nearest point of that face (within its
 *                  bounds) or curve
 * @param distance  out: [n] distance that each point was moved; may be NULL
 * stop and seconds of the options used to parse the model apply here too.
 * VG_ERR_INPUT for a number that the model lacks; VG_ERR_GEOMETRY if the child
 * has ended. Points are unchanged on failure. Takes some 10 to 100 us per
 * point; with triangles, which provide a starting point, some 2 us. */
enum vg_cad_on { VG_CAD_ON_FACES, VG_CAD_ON_CURVES, VG_CAD_ON_TRIANGLES };
vg_status vg_cad_project(struct vg_cad *c, enum vg_cad_on on, size_t n,
                         const uint32_t *number, double (*point)[3],
                         double *distance, struct vg_error *err);

/** A child and the surface read from its file. */
struct vg_cad_model {
  struct vg_cad *cad; /* NULL: no model */
  struct vg_cad_surface surface;
};
#define VG_CAD_MODEL_INIT                                                      \
  {                                                                            \
    NULL, VG_CAD_SURFACE_INIT                                                  \
  }
void vg_cad_model_release(struct vg_cad_model *m);

/** vg_cad_open and vg_cad_parse for a file (gzip'd or not).
 * @param o     NULL for defaults
 * @param keep  empty; out: the child, with a copy of the surface; NULL: the
 *              child is ended
 * @param unit  out: unit of the surface, as in struct vg_cad_surface
 * @param zones empty; out: owned by the caller; may be NULL */
vg_status vg_cad_read(const char *path, enum vg_cad_kind kind,
                      const struct vg_cad_options *o, struct vg_cad_model *keep,
                      struct vg_mesh *out, int *unit,
                      struct vg_cad_zones *zones, struct vg_error *err);

#endif
