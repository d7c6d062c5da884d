/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/periodic/near_points.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

vg_status vg_near_points_add(struct vg_near_points *s, uint32_t point,
                             struct vg_error *err)
{
  assert(!s->n || s->point[s->n - 1] < point);
  if (vg_reserve(&s->point, &s->cap, s->n + 1, sizeof *s->point) < 0)
    return vg_fail_memory(err, "the periodic patches");
  s->point[s->n++] = point;
  return VG_OK;
}

vg_status vg_near_points_build(struct vg_near_points *s,
                               const struct vg_mesh *m, struct vg_error *err)
{
  struct vg_box *box = vg_alloc(s->n, sizeof *box);
  vg_status st;

  if (!box) return vg_fail_memory(err, "the periodic patches");
  s->m = m;
  for (size_t i = 0; i < s->n; i++) {
    box[i] = (struct vg_box)VG_BOX_EMPTY;
    vg_box_add(&box[i], m->point[s->point[i]]);
  }
  st = vg_box_tree_build_items(&s->tree, s->n, box, NULL, err);
  free(box);
  return st;
}

struct search {
  const struct vg_near_points *in;
  const double *x;
  double d2;
  uint32_t found;
};

static int is_near(void *context, size_t node, double d2)
{
  (void)node;
  return d2 <= ((struct search *)context)->d2;
}

static void take_near(void *context, size_t node)
{
  struct search *a = context;
  const struct vg_box_tree *t = &a->in->tree;

  for (size_t i = vg_box_tree_first(t, node); i < vg_box_tree_end(t, node);
       i++) {
    const uint32_t point = a->in->point[t->item[i]];
    const double d2 = vg_distance2(a->x, a->in->m->point[point]);

    if (d2 > a->d2 || (d2 == a->d2 && point > a->found)) continue;
    a->d2 = d2;
    a->found = point;
  }
}

uint32_t vg_near_points_find(const struct vg_near_points *s, const double x[3],
                             double *d2)
{
  struct search a = { s, x, INFINITY, VG_PERIODIC_NONE };

  vg_box_tree_approach(&s->tree, x, is_near, take_near, &a);
  *d2 = a.d2;
  return a.found;
}

void vg_near_points_release(struct vg_near_points *s)
{
  vg_box_tree_release(&s->tree);
  free(s->point);
  *s = (struct vg_near_points)VG_NEAR_POINTS_INIT;
}
