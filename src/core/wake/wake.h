/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wake/wake.h: refined wakes. Sheets leave trailing edges along the
 * stream; sources with the shape of triangles lie on them. Uses
 * core/wake/trailing.h, core/sizing/sizing.h.
 *
 * At the distance s behind a trailing edge of the chord c, the wake requests
 *   size         h(s) = size c + (growth - 1) s
 *   half height  height c h(s) / (size c),
 * so that the number of cells across it is the same everywhere. */
#ifndef VG_CORE_WAKE_WAKE_H
#define VG_CORE_WAKE_WAKE_H

#include "core/sizing/sizing.h"
#include "core/wake/trailing.h"

/* A wake, in chords. */
struct vg_wake {
  double length;  /* > 0 */
  double size;    /* size across the wake at its trailing edge, > 0 */
  double height;  /* half of its height there, > 0 */
  double growth;  /* >= 1 */
  double chord;   /* reference chord, a length; 0: the local chord */
  double stretch; /* sizes along the stream over those across it, >= 1 */
};

/* A part of a trailing edge, straight within a part of the wake's height. */
struct vg_wake_panel {
  double x[2][3];   /* its ends */
  double chord[2];  /* chords at its ends */
  double thickness; /* largest of its edges */
};

struct vg_wake_panels {
  size_t n, cap;
  struct vg_wake_panel *item; /* [n] owned */
};
#define VG_WAKE_PANELS_INIT                                                    \
  {                                                                            \
    0                                                                          \
  }

/** Join trailing edges into panels.
 *
 * @param m   mesh of the trailing edges
 * @param on  [n_patch] 1: edges of this patch count
 * @param out empty; the caller releases it with vg_wake_panels_release. Empty
 *            if no edge counts
 *
 * Chords change by at most four units per unit of span: those of edges whose
 * section continues over another part of the body are reduced. A panel deviates
 * from its edges by at most a tenth of the half height, is at most one chord
 * long, and its chord changes by at most 15 %. O(n log n). VG_ERR_MEMORY. */
vg_status vg_wake_panels_make(const struct vg_mesh *m,
                              const struct vg_trailing *t, const uint8_t *on,
                              const struct vg_wake *w,
                              struct vg_wake_panels *out, struct vg_error *err);

void vg_wake_panels_release(struct vg_wake_panels *p);

/** Cells that the wake of one panel requests for one direction of the stream,
 * without those in which sizes grow around it: tetrahedra of 9 per cube of the
 * edge length. scale: factor on sizes. */
double vg_wake_cells(const struct vg_wake *w, const struct vg_wake_panel *p,
                     double scale);

/** Number of sources of one panel. */
size_t vg_wake_sources_count(const struct vg_wake *w);

/** Sources of one panel for one direction of the stream.
 *
 * @param flow  unit vector
 * @param out   [vg_wake_sources_count]; kind VG_SOURCE_TRIANGLE, all other
 *              members 0 or "" */
void vg_wake_sources(const struct vg_wake *w, const struct vg_wake_panel *p,
                     const double flow[3], struct vg_source *out);

/* A line across a wake on which cells are counted. */
struct vg_wake_probe {
  uint64_t wake;    /* number of the wake, of the caller */
  uint64_t station; /* of the caller */
  double x[2][3];   /* its ends, on the limits of the wake */
  double flow[3];   /* unit vector along the stream */
  double asked;     /* requested number of cells along it */
  double got;       /* number of cells along it; NAN: not measured */
  double stretch;   /* edge lengths along the stream over those along the line;
                       NAN: not measured */
};

/** Line across the wake of a panel at s chords behind the middle of its
 * trailing edge. Returns 0 if the wake is shorter. scale: factor on sizes. */
int vg_wake_probe(const struct vg_wake *w, const struct vg_wake_panel *p,
                  const double flow[3], double s, double scale,
                  struct vg_wake_probe *out);

struct vg_comm;
struct vg_slices;

/** Count the cells along probes: a tetrahedron, or a prism outside of layers,
 * counts with the length of the probe within it, in edge lengths of the cell
 * along the probe (of the metric in which it is regular). Prisms outside of
 * layers are those of plane sections: parallelepipeds cut in half. Numbers are
 * extrapolated to whole probes. `stretch` is the quotient of the numbers for
 * vectors of the same length along the probe and along its flow. Those that
 * have less than half of their length in such cells, because they cross walls,
 * layers of other cells or the boundary, are not measured. Collective; the
 * probes are the same on all ranks, also afterwards. VG_ERR_MEMORY. */
vg_status vg_wake_measure(struct vg_comm *c, const struct vg_slices *s,
                          int threads, size_t n, struct vg_wake_probe *probe,
                          struct vg_error *err);

/** Direction of a stream with the angle of attack alpha and the sideslip beta
 * in degrees, between -90 and 90: cos a cos b along the axis `stream`, sin a
 * cos b along the axis `up`, -sin b along up x stream, which points to
 * starboard. stream, up: unit vectors normal to each other. The same bits on
 * every machine. */
void vg_wake_direction(double alpha, double beta, const double stream[3],
                       const double up[3], double flow[3]);

#endif
