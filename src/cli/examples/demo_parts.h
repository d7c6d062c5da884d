/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/examples/demo_parts.h: declarations shared by demo*.c; private. */
#ifndef VG_CLI_EXAMPLES_DEMO_PARTS_H
#define VG_CLI_EXAMPLES_DEMO_PARTS_H

#include "cli/examples/demo.h"
#include "core/domain/planar_patch.h"

/** Sources of a case, with a factor on all spacings. */
enum { VG_DEMO_SOURCE_MAX = 10 };

struct vg_demo_spacing {
  size_t n;
  struct vg_source source[VG_DEMO_SOURCE_MAX];
  double h_max, growth;
};

/** Spacing of a law; for vg_size_function. user: const struct vg_demo_spacing.
 */
double vg_demo_size(void *user, const double x[3]);

/** A wing: all lengths in root chords. */
struct vg_demo_wing {
  int is_sharp, is_half;
};

/** Sources of the wing for a factor on all spacings. */
void vg_demo_wing_law(const struct vg_demo_wing *w, double factor,
                      struct vg_demo_spacing *law);

/** Returns 1 for a point inside the wing; of a half model, at y >= 0. */
int vg_demo_wing_holds(const struct vg_demo_wing *w, const double x[3]);

/** Surface of the wing without farfield: closed, or open along y = 0. */
vg_status vg_demo_wing_surface(const struct vg_demo_wing *w,
                               const struct vg_demo_spacing *law,
                               struct vg_mesh *out, struct vg_error *err);

/** Add the mirror image of a surface at y >= 0; points at y = 0 are shared. */
vg_status vg_demo_mirror(struct vg_mesh *m, struct vg_error *err);

/** A body of revolution of length 1 from the origin along x, in a domain for
 * its sonic boom: sources for a factor on all spacings; the first one stretches
 * cells along the Mach cones. */
void vg_demo_boom_law(double factor, struct vg_demo_spacing *law);

/** Its domain, and the box around that. */
struct vg_farfield vg_demo_boom_farfield(void);
void vg_demo_boom_box(int is_half, double lo[3], double hi[3]);

/** Returns 1 for a point of the fluid in the domain. */
int vg_demo_boom_holds(const double x[3]);

/** Surface without farfield: closed, or open along y = 0. */
vg_status vg_demo_boom_surface(int is_half, const struct vg_demo_spacing *law,
                               struct vg_mesh *out, struct vg_error *err);

/** A passage of a turbine with one blade, between periodic sides. */
void vg_demo_passage_law(double factor, struct vg_demo_spacing *law);

/** The box around it. */
void vg_demo_passage_box(double lo[3], double hi[3]);

/** Returns 1 for a point of the fluid in it. */
int vg_demo_passage_holds(const double x[3]);

/** Its surface, closed. The second periodic side has the images of the points
 * and triangles of the first one. */
vg_status vg_demo_passage_surface(const struct vg_demo_spacing *law,
                                  struct vg_mesh *out, struct vg_error *err);

/** demo_sheets.c: a disk across the flow ahead of the sphere, with edges of the
 * size at its centre. */
vg_status vg_demo_add_disk(const struct vg_demo_spacing *law, struct vg_demo *d,
                           struct vg_error *err);

/** demo_sheets.c: a cylinder in the box, an interface, and in it four pitched
 * blades, which are baffles. */
vg_status vg_demo_add_rotor(const struct vg_demo_spacing *law,
                            struct vg_demo *d, struct vg_error *err);

/** demo_sheets.c: a plate with three fins in the box, a solid whose surface is
 * an interface. */
vg_status vg_demo_add_fins(const struct vg_demo_spacing *law, struct vg_demo *d,
                           struct vg_error *err);

/** demo_sheets.c: a pipe in a round casing, a solid between two fluids:
 * surface, sheets, zones and walls of *d, with edges of law->h_max. */
vg_status vg_demo_exchanger_surface(const struct vg_demo_spacing *law,
                                    struct vg_demo *d, struct vg_error *err);

/** Volume inside its casing. */
double vg_demo_exchanger_volume(void);

#endif
