/* io/cad/cad.h: surfaces from CAD files (STEP, IGES, BREP) by Open CASCADE.
 *
 * Open CASCADE throws, raises signals, turns in circles and leaks on damaged
 * files, and brings seventy shared libraries along. So it is loaded (io/occt,
 * libvanguard-cad.so) by a child process only (base/child.h), which keeps the
 * model: as long as it lives, points can be put back on its faces and curves.
 *
 * The bytes that come out follow from the file and the options. Open CASCADE
 * calls libm, which chooses code by the processor: ranks of a job must take the
 * surface from one of them, and do (run/input/share.h). */
#ifndef VG_IO_CAD_CAD_H
#define VG_IO_CAD_CAD_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

enum vg_cad_kind { VG_CAD_NONE, VG_CAD_STEP, VG_CAD_IGES, VG_CAD_BREP };

/** Length unit of what is read; FILE: the file's own. */
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

/** What makes a patch: each face, or all faces that have this in common. */
enum vg_cad_patches {
  VG_CAD_BY_FACE,
  VG_CAD_BY_NAME,
  VG_CAD_BY_COLOUR,
  VG_CAD_BY_LAYER,
  VG_CAD_BY_PART,
  VG_CAD_BY_N
};

struct vg_cad_options {
  int32_t unit;     /* enum vg_cad_unit */
  int32_t patches;  /* enum vg_cad_patches */
  double tolerance; /* gaps between faces up to this are sewn, in the
                       unit of what is read; 0: 1e-6 of the diagonal
                       of the box around all */
  double chord;     /* distance of an edge of the triangulation from
                       its curve, over the size of that curve; of a
                       face the largest of its edges */
  double angle;     /* degrees between neighbouring edges on a curve,
                       and triangles on a face */
  double least;     /* shortest edge worth having, in the unit of what
                       is read. Curves and faces are not divided below
                       it, and shorter edges collapse, except between
                       two corners of the model and where triangles
                       would turn. 0: no edge collapses, and the bound
                       of division is 1e-7 of the diagonal of the box
                       around all or 1e-6 of that of the median face,
                       whichever is larger */
  double seconds;   /* give up then; 0: never */
  void (*note)(void *user, const char *text); /* what a report should say, line
                                by line: unit, what was healed or dropped, with
                                places; NULL: lost */
  void *user;                                 /* of note */
  struct vg_stop stop;                        /* asked ten times a second */
};
#define VG_CAD_OPTIONS_INIT                                                    \
  {                                                                            \
    .chord = 2e-3, .angle = 15, .seconds = 3600                                \
  } /* S15 */

/** A model as triangles. Faces and curves have the numbers, from 1 up, of the
 * file's faces and edges in the order of its shells; those that were dropped
 * leave gaps. */
struct vg_cad_surface {
  struct vg_mesh mesh; /* triangles, oriented as the faces are: normals
                          out of solids. Points on a curve that faces
                          share are shared, by topology. A patch has the
                          number of its face, or of its group */
  uint32_t *tri_face;  /* [mesh.n_tri] number of the face */
  size_t n_segment;
  uint32_t (*segment)[2];  /* [n_segment] points on curves, in order */
  uint32_t *segment_curve; /* [n_segment] number of the curve */
  int is_solid;            /* 1: every face bounds a closed solid of the file,
                              whose normals point out of its material */
  double volume;           /* that the faces enclose, integrated over their
                              exact geometry. Solids: volume of their
                              material. Other faces: sum of the absolute
                              volumes of connected shells. NAN where an edge
                              does not have two faces */
};
#define VG_CAD_SURFACE_INIT                                                    \
  {                                                                            \
    .mesh = VG_MESH_INIT                                                       \
  }
void vg_cad_surface_release(struct vg_cad_surface *s);

struct vg_cad; /* a child with a model */

/** 1 when this build can read CAD. */
int vg_cad_is_built(void);

/** Start a child. VG_ERR_UNSUPPORTED in a build without Open CASCADE;
 * VG_ERR_MEMORY when the system refuses a process. */
vg_status vg_cad_open(struct vg_cad **out, struct vg_error *err);

/** End the child; NULL accepted. It also ends with this process. */
void vg_cad_close(struct vg_cad *c);

/** Read, heal and triangulate a file; its model replaces the one before. May be
 * called again after any failure: the child is then another one.
 *
 * Dropped, each with a note that has its place: a face that repeats another
 * one, a face without area. Sewn: shells with open edges, by o->tolerance.
 * Faces that could not be triangulated and edges with one face are noted and
 * stay open.
 * VG_ERR_FORMAT: truncated, or not of its kind; VG_ERR_INPUT: nothing in it
 * that has faces; VG_ERR_GEOMETRY: Open CASCADE ended on it, or took longer
 * than o->seconds; VG_ERR_IO: stopped. *out is untouched on failure.
 * Threads: one at a time for each child. */
vg_status vg_cad_parse(struct vg_cad *c, struct vg_input *in,
                       enum vg_cad_kind kind, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err);

/** Triangulate the model that the last vg_cad_parse read once more, with the
 * patches, chord, angle and least of `o`. The file is not read again and unit
 * and tolerance stay as they were; the result is that of vg_cad_parse with
 * these options. VG_CAD_ON_TRIANGLES then refers to the new triangles. On
 * failure it refers to the former ones, as long as the child lives.
 * Status: as vg_cad_parse; VG_ERR_INPUT without a model. *out is untouched on
 * failure. */
vg_status vg_cad_again(struct vg_cad *c, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err);

/** Points put on faces, or on curves, of the model.
 *
 * @param on        faces, curves, or triangles of the surface as parsed, which
 *                  stand for their faces
 * @param number    [n] of the face, curve or triangle (from 0) for each point
 * @param point     in: [n][3]; out: the nearest point of that face (within its
 *                  bounds) or curve
 * @param distance  out: [n] how far each was moved; NULL accepted
 * stop and seconds of the options that the model was parsed with hold here too.
 * VG_ERR_INPUT for a number that the model lacks; VG_ERR_GEOMETRY when the
 * child is gone. Points are untouched on failure. Some 10 to 100 us each, by
 * triangles, which say where to begin, some 2. */
enum vg_cad_on { VG_CAD_ON_FACES, VG_CAD_ON_CURVES, VG_CAD_ON_TRIANGLES };
vg_status vg_cad_project(struct vg_cad *c, enum vg_cad_on on, size_t n,
                         const uint32_t *number, double (*point)[3],
                         double *distance, struct vg_error *err);

/** A child and what it made of its file. */
struct vg_cad_model {
  struct vg_cad *cad; /* NULL: none */
  struct vg_cad_surface surface;
};
#define VG_CAD_MODEL_INIT                                                      \
  {                                                                            \
    NULL, VG_CAD_SURFACE_INIT                                                  \
  }
void vg_cad_model_release(struct vg_cad_model *m);

/** vg_cad_open and vg_cad_parse on a file (gzip'd or not).
 * @param o     NULL for defaults
 * @param keep  empty; out: the child, with a copy of the surface; NULL: the
 *              child is ended */
vg_status vg_cad_read(const char *path, enum vg_cad_kind kind,
                      const struct vg_cad_options *o, struct vg_cad_model *keep,
                      struct vg_mesh *out, struct vg_error *err);

#endif
