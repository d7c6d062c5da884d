/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/analytic.h: smooth functions with exact derivatives. Private to
 * core/accuracy. */
#ifndef VG_CORE_ACCURACY_ANALYTIC_H
#define VG_CORE_ACCURACY_ANALYTIC_H

#include "core/accuracy/accuracy.h"

/** Scales of all functions. */
struct vg_field_scale {
  double length, centre[3];
  double viscous; /* length of y+ 1; 0: no walls */
};

/** A position. */
struct vg_place {
  double x[3];
  double distance;  /* from the nearest wall */
  double normal[3]; /* direction in which it grows; zero: not defined */
};

struct vg_field_value {
  double value, gradient[3], laplacian;
};

/** A row of the table of functions. */
struct vg_field {
  const char *name;
  int needs_walls;   /* 1: defined by the wall distance, only within layers */
  int has_laplacian; /* 1: the Laplacian is not 0 everywhere */
  void (*at)(const struct vg_field_scale *s, const struct vg_place *p,
             struct vg_field_value *out);
};

extern const struct vg_field vg_fields[VG_FIELDS];

#endif
