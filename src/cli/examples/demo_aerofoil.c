/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/examples/demo_aerofoil.h"

#include <math.h>

#include "core/geometry/graded.h"
#include "io/stream/stream.h"

enum { SIDE = 80 }; /* Intervals on each side. */

static const struct vg_demo_case cases[] = {
  { "aerofoil", "NACA 0012 in two dimensions, sharp trailing edge", 9000 },
  { "aerofoil-blunt", "NACA 0012 in two dimensions, blunt trailing edge",
    10000 },
};

const struct vg_demo_case *vg_demo_sections(size_t *n)
{
  *n = sizeof cases / sizeof *cases;
  return cases;
}

/* Half the thickness at x. The coefficients of the sharp section add up to 0
 * except for rounding. */
static double thickness(double x, int is_blunt)
{
  const double last = is_blunt ? 0.1015 : 0.1036;

  if (x >= 1 && !is_blunt) return 0;
  return 0.6 * (0.2969 * sqrt(x) -
                x * (0.1260 + x * (0.3516 - x * (0.2843 - last * x))));
}

/* Points are closer to each other at both edges. */
static void put_point(struct vg_output *out, int i, int side, int is_blunt)
{
  double sine, cosine, x;

  vg_quarter_turn(i * 1.0 / SIDE, &sine, &cosine);
  /* (1 - cos(pi u)) / 2 */
  x = i == SIDE ? 1 : sine * sine;
  vg_output_real(out, x);
  vg_output_text(out, " ");
  vg_output_real(out, side * thickness(x, is_blunt));
  vg_output_text(out, "\n");
}

vg_status vg_demo_aerofoil_write(const char *path, int is_blunt,
                                 struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_open(path, &out, err);

  if (st < 0) return st;
  vg_output_text(&out, "NACA 0012\n");
  for (int i = SIDE; i > 0; i--) put_point(&out, i, 1, is_blunt);
  for (int i = 0; i <= SIDE; i++) put_point(&out, i, -1, is_blunt);
  st = vg_output_commit(&out, err);
  vg_output_release(&out);
  return st;
}
