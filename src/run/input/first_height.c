/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Notes about first heights that are implausible for the size of the walls.
 * Declared in run/input/layers.h. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "layers/columns/growth_law.h"
#include "run/input/layers.h"

/* L26: relative to the largest extent of the walls. On a flat plate of that
 * length, y+ 0.6 at a Reynolds number of 1e9 is 2e-8. */
#define HEIGHT_LEAST 2e-8
#define HEIGHT_MOST 0.02
#define LENGTH_LEAST 0.005
#define LENGTH_MOST 50.0
#define Y_PLUS_LEAST 0.01
#define Y_PLUS_MOST 500.0

/* Largest extent of the walls with layers along x, y or z. */
static double extent_of(const struct vg_layer_stage *s, const struct vg_mesh *m)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++) {
    if (!s->request[m->tri_patch[t]].is_wall) continue;
    for (int i = 0; i < 9; i++) {
      const double x = m->point[m->tri[t][i / 3]][i % 3];

      lo[i % 3] = fmin(lo[i % 3], x);
      hi[i % 3] = fmax(hi[i % 3], x);
    }
  }
  return fmax(hi[0] - lo[0], fmax(hi[1] - lo[1], hi[2] - lo[2]));
}

/* A wall whose first height is implausible; SIZE_MAX: none. */
static size_t implausible(const struct vg_layer_stage *s, double extent)
{
  for (size_t i = 0; i < s->n_patch; i++) {
    const double first = s->request[i].law.delta1;
    const double y_plus = s->reynolds > 0
                          ? vg_y_plus(first, s->reynolds, s->length)
                          : 1;

    if (!s->request[i].is_wall) continue;
    if (first < HEIGHT_LEAST * extent || first > HEIGHT_MOST * extent ||
        y_plus < Y_PLUS_LEAST || y_plus > Y_PLUS_MOST)
      return i;
  }
  return SIZE_MAX;
}

static void note_first(const struct vg_layer_stage *s, struct vg_boundary *b,
                       size_t i, double extent)
{
  const struct vg_patch *p = &b->surface.patch[i];
  const double first = s->request[i].law.delta1;

  if (s->reynolds > 0)
    vg_note(b->notes,
            "the first height %.3g of patch %d %s is %.2g times the extent of "
            "the walls, %.6g, and y+ %.3g at Reynolds number %g and reference "
            "length %g: are first height, reference length and surface in the "
            "same unit?",
            first, (int)p->id, p->name, first / extent, extent,
            vg_y_plus(first, s->reynolds, s->length), s->reynolds, s->length);
  else
    vg_note(b->notes,
            "the first height %.3g of patch %d %s is %.2g times the extent of "
            "the walls, %.6g: are both in the same unit?",
            first, (int)p->id, p->name, first / extent, extent);
}

static void note_length(const struct vg_layer_stage *s, struct vg_boundary *b,
                        double extent)
{
  vg_note(b->notes,
          "the reference length %g is %.2g times the extent of the walls, "
          "%.6g: is it in the unit of the surface? First heights and y+ "
          "follow from it",
          s->length, s->length / extent, extent);
}

/* The last note becomes the first. */
static void to_front(struct vg_notes *notes)
{
  char *last = notes->text[notes->n - 1];

  memmove(notes->text + 1, notes->text, (notes->n - 1) * sizeof *notes->text);
  notes->text[0] = last;
}

void vg_note_first_heights(const struct vg_layer_stage *s,
                           struct vg_boundary *b)
{
  assert(s->n_patch == b->surface.n_patch);

  const size_t n = b->notes->n;
  const double extent = extent_of(s, &b->surface);
  const size_t i = implausible(s, extent);

  if (s->length > 0 &&
      (s->length < LENGTH_LEAST * extent || s->length > LENGTH_MOST * extent))
    note_length(s, b, extent);
  else if (i != SIZE_MAX) note_first(s, b, i, extent);
  if (b->notes->n > n) to_front(b->notes);
}
