/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Faulty plug-ins, one for each BAD, for test_mesher.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <vanguard/mesher.h>

enum {
  NO_SYMBOL = 1,
  OTHER_VERSION,
  DIES_LOADING,
  NO_MESHER,
  CRASHES,
  EXITS,
  TURNS,
  SLEEPS,
  TOO_FEW,
  TWICE,
  OUTSIDE,
  NO_NUMBER,
  NO_POINT,
  NOTHING,
  WILD
};

/* A point in the middle joined to all triangles, with the fault added. */
static int fill(const struct vg_mesher_front *f,
                const struct vg_mesher_sizes *sizes,
                struct vg_mesher_cells *out)
{
  (void)sizes;
  out->n_point = 1;
  out->x = calloc(2, sizeof *out->x);
  out->cell = calloc(2 * f->n_face, sizeof *out->cell);
  for (size_t i = 0; i < f->n_point; i++)
    for (int k = 0; k < 3; k++) out->x[0][k] += f->x[i][k] / (double)f->n_point;
  for (size_t i = 0; i < f->n_face; i++) {
    memcpy(out->cell[i], f->face[i], sizeof f->face[i]);
    out->cell[i][3] = (uint32_t)f->n_point;
  }
  out->n_cell = f->n_face;
  switch (BAD) {
  case CRASHES: abort();
  case EXITS: exit(0);
  case TURNS:
    for (volatile int k = 0;; k++) {
    }
  case SLEEPS:
    for (;;) pause();
  case TOO_FEW: out->n_cell--; break;
  case TWICE:
    memcpy(out->cell + f->n_face, out->cell, f->n_face * sizeof *out->cell);
    out->n_cell *= 2;
    break;
  case OUTSIDE: out->x[0][0] += 100; break;
  case NO_NUMBER: out->x[0][1] = NAN; break;
  case NO_POINT: out->cell[3][2] = (uint32_t)f->n_point + 7; break;
  case NOTHING: out->n_cell = 0; break;
  case WILD: out->n_cell = SIZE_MAX / 64; break;
  default: break;
  }
  return 0;
}

#if BAD != 1
const struct vg_mesher *vg_mesher_plugin(void)
{
  static struct vg_mesher bad = { VG_MESHER_VERSION, "bad", fill, NULL };

  if (BAD == OTHER_VERSION) bad.version++;
  if (BAD == DIES_LOADING) abort();
  return BAD == NO_MESHER ? NULL : &bad;
}
#endif
