/* The edge length that a slide patch is re-meshed with. The field was made
 * over walls that are covered now: where tops fan out, their edges are longer
 * than it asks for, and what is filled later starts from them. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

void vg_slide_law_release(struct vg_slide_law *l)
{
  free(l->top);
  free(l->box);
  vg_aabb_tree2_release(&l->tree);
}

/* Edge between tops that is longer than the field asks for? */
static int is_coarse(const struct vg_slide_work *w, const uint32_t e[2],
                     double mid[3], double *h)
{
  const double *a = w->x[e[0]], *b = w->x[e[1]];

  if (vg_slide_column(w, e[0]) == VG_NO_INDEX
      && vg_slide_column(w, e[1]) == VG_NO_INDEX)
    return 0;
  for (int k = 0; k < 3; k++) mid[k] = 0.5 * (a[k] + b[k]);
  *h = vg_distance(a, b);
  return vg_sizing_at(w->sizing, mid) < *h;
}

vg_status vg_slide_law_floor(struct vg_slide_work *w,
                             const struct vg_slide_loops *loops,
                             struct vg_slide_law *l)
{
  size_t n = 0;

  l->slope = vg_sizing_growth(w->sizing);
  l->top = vg_alloc(loops->n, sizeof *l->top);
  l->box = vg_alloc(loops->n, sizeof *l->box);
  if (!l->top || !l->box) return vg_fail_memory(w->err, "a slide patch");
  for (size_t i = 0; i < loops->n; i++) {
    double mid[3], h;

    if (!is_coarse(w, loops->edge[i], mid, &h)) continue;
    vg_slide_to_plane(l->frame, mid, l->top[n].p);
    l->top[n].h = h;
    for (int k = 0; k < 2; k++) {
      l->box[n].lo[k] = l->top[n].p[k] - h / l->slope;
      l->box[n].hi[k] = l->top[n].p[k] + h / l->slope;
    }
    n++;
  }
  if (n && vg_aabb_tree2_build(&l->tree, n, l->box))
    return vg_fail_memory(w->err, "a slide patch");
  return VG_OK;
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

static void lift_to(void *user, uint32_t i)
{
  struct at *at = user;
  const double x = at->p[0] - at->l->top[i].p[0];
  const double y = at->p[1] - at->l->top[i].p[1];
  const double h = at->l->top[i].h - at->l->slope * sqrt(x * x + y * y);

  if (h > at->h) at->h = h;
}

double vg_slide_size(void *law, const double p[2])
{
  const struct vg_slide_law *l = law;
  struct at at = { l, p, 0 };
  struct vg_box2 box;
  double x[3];

  assert(law);
  vg_slide_place(l, p, x);
  at.h = vg_sizing_at(l->sizing, x);
  for (int k = 0; k < 2; k++) box.lo[k] = box.hi[k] = p[k];
  vg_aabb_tree2_query(&l->tree, &box, lift_to, &at);
  return at.h;
}
