/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Target edge length for remeshing a slide patch. The sizing field was built
 * for the walls, which are now covered by layers: where tops spread apart,
 * their edges are longer than the field requests, and the meshing that follows
 * starts from these edges. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

void vg_slide_law_release(struct vg_slide_law *l)
{
  free(l->top);
  vg_box_tree_release(&l->tree);
}

/* Whether an edge between tops is longer than the field requests. */
static int is_coarse(const struct vg_slide_work *w, const uint32_t e[2],
                     double mid[3], double *h)
{
  const double *a = w->x[e[0]], *b = w->x[e[1]];

  if (vg_slide_column(w, e[0]) == VG_NO_INDEX &&
      vg_slide_column(w, e[1]) == VG_NO_INDEX)
    return 0;
  for (int k = 0; k < 3; k++) mid[k] = 0.5 * (a[k] + b[k]);
  *h = vg_distance(a, b);
  return vg_sizing_at(w->sizing, mid) < *h;
}

vg_status vg_slide_law_floor(struct vg_slide_work *w,
                             const struct vg_slide_loops *loops,
                             struct vg_slide_law *l)
{
  struct vg_box *box = vg_alloc(loops->n, sizeof *box);
  size_t n = 0;
  vg_status st = VG_OK;

  l->slope = vg_sizing_growth(w->sizing);
  l->top = vg_alloc(loops->n, sizeof *l->top);
  if (!l->top || !box) VG_TRY(vg_fail_memory(w->err, "a slide patch"));
  for (size_t i = 0; i < loops->n; i++) {
    double mid[3], lo[2], hi[2], h;

    if (!is_coarse(w, loops->edge[i], mid, &h)) continue;
    vg_slide_to_plane(l->frame, mid, l->top[n].p);
    l->top[n].h = h;
    for (int k = 0; k < 2; k++) {
      lo[k] = l->top[n].p[k] - h / l->slope;
      hi[k] = l->top[n].p[k] + h / l->slope;
    }
    box[n++] = vg_slide_box(lo, hi);
  }
  VG_TRY(vg_slide_tree(&l->tree, n, box, w->err));
done:
  free(box);
  return st;
}

void vg_slide_place(const struct vg_slide_law *l, const double p[2],
                    double x[3])
{
  if (l->graph) vg_slide_lift(l->graph, p, x);
  else vg_slide_to_space(l->frame, p, x);
}

struct at {
  const struct vg_slide_law *l;
  const double *p;
  double h;
};

static int lift_to(void *user, uint32_t i)
{
  struct at *at = user;
  const double x = at->p[0] - at->l->top[i].p[0];
  const double y = at->p[1] - at->l->top[i].p[1];
  const double h = at->l->top[i].h - at->l->slope * sqrt(x * x + y * y);

  if (h > at->h) at->h = h;
  return 0;
}

double vg_slide_size(void *law, const double p[2])
{
  const struct vg_slide_law *l = law;
  struct at at = { l, p, 0 };
  const struct vg_box box = vg_slide_box(p, p);
  double x[3];

  assert(law);
  vg_slide_place(l, p, x);
  at.h = vg_sizing_at(l->sizing, x);
  vg_box_tree_touched(&l->tree, &box, lift_to, &at);
  return at.h;
}
