/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/flat_cells.h: causes of flat cells. A flat cell is a tetrahedron
 * outside the layers whose smallest dihedral angle is below VG_FLAT_LIMIT. It
 * is classified by the kinds of its four points. Uses base and
 * core/geometry. */
#ifndef VG_CORE_JUDGE_FLAT_CELLS_H
#define VG_CORE_JUDGE_FLAT_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#define VG_FLAT_LIMIT 5.0                  /* Q1: degrees */
#define VG_FLAT_COSINE 0.99619469809174555 /* of VG_FLAT_LIMIT */
#define VG_NO_PATCH UINT32_MAX

enum vg_point_kind {
  VG_POINT_UNKNOWN,
  VG_POINT_FIELD,     /* Inside a subdomain. */
  VG_POINT_INTERFACE, /* On an interface, or in a separator or a repair. */
  VG_POINT_TOP,       /* Top of a column. */
  VG_POINT_WALL,      /* Wall point without levels. */
  VG_POINT_SLIDE,     /* New point of a remeshed slide patch. */
  VG_POINT_SURFACE,   /* Any other point of the surface. */
  VG_POINT_KINDS
};

/** Name of a kind in reports: "field", "interface", ... Static string. */
const char *vg_point_kind_name(enum vg_point_kind kind);

enum vg_flat_cause {
  VG_FLAT_TOPS_ONE,      /* Four tops of one patch. */
  VG_FLAT_TOPS_SEVERAL,  /* Four tops that do not share a patch. */
  VG_FLAT_TOPS_FIELD,    /* Tops and field points. */
  VG_FLAT_TOPS_SURFACE,  /* Tops and other surface points, perhaps with field
                            points. */
  VG_FLAT_SURFACE,       /* Surface points that are not tops. */
  VG_FLAT_SURFACE_FIELD, /* The same, with field points. */
  VG_FLAT_FIELD,         /* Field points only. */
  VG_FLAT_CAUSES
};

/** Name of a cause as a key of the JSON report and in texts. Static strings. */
const char *vg_flat_cause_key(enum vg_flat_cause cause);
const char *vg_flat_cause_name(enum vg_flat_cause cause);

/** The four points of a cell, in its node order. */
struct vg_flat_points {
  uint32_t kind[4];  /* enum vg_point_kind; VG_POINT_UNKNOWN: the cell is not
                        classified */
  uint32_t patch[4]; /* Index of a patch of the point: the lowest one that all
                        tops of the cell share, otherwise the lowest one of the
                        point; VG_NO_PATCH: none. */
};

struct vg_flat_class {
  struct vg_flat_points points;
  enum vg_flat_cause cause;
  int at_interface; /* A point is an interface point. */
  int is_spanning;  /* The edges of the boundary do not connect all boundary
                       points of the cell with each other, so the cell spans the
                       distance between two parts of the boundary. */
  int has_needle;   /* A face of the cell is a face of the boundary with an
                       angle below VG_FLAT_LIMIT. */
};

/** Boundary of the field: tops of layers, and surface without layers. All
 * arrays are borrowed. */
struct vg_flat_boundary {
  size_t n_point, n_face;
  const uint32_t *id;        /* [n_point] point of the mesh; NULL: 0 .. */
  const uint8_t *kind;       /* [n_point] enum vg_point_kind; NULL:
                                VG_POINT_SURFACE */
  const uint32_t (*face)[3]; /* [n_face] */
  const uint32_t *patch;     /* [n_face] index of the patch */
  const uint32_t *top;       /* [n_face] UINT32_MAX: not the top of a face. Such
                                faces do not count for the patches of tops and
                                wall points. NULL: there are no tops. */
};

/** Prepares the classification: O(points + faces), about 40 bytes per point.
 * *out is freed by vg_flat_free and must not outlive the arrays of b.
 * VG_ERR_MEMORY. */
struct vg_flat;
vg_status vg_flat_new(const struct vg_flat_boundary *b, struct vg_flat **out,
                      struct vg_error *err);

/** Bytes of memory; 0 for NULL. */
size_t vg_flat_bytes(const struct vg_flat *f);

/** Accepts NULL. */
void vg_flat_free(struct vg_flat *f);

/** Classifies a cell. Threads: safe on a shared f.
 *
 * @param id     its points in the mesh
 * @param x      [4] their coordinates
 * @param inner  [4] VG_POINT_FIELD or VG_POINT_INTERFACE: kind of each point if
 *               it is not on the boundary */
struct vg_flat_class vg_flat_classify(const struct vg_flat *f,
                                      const uint32_t id[4],
                                      const double *const x[4],
                                      const enum vg_point_kind inner[4]);

#endif
