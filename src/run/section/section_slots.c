/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The slots between the elements of a section. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "core/search/box_tree.h"
#include "run/section/section_surface.h"

struct search {
  const struct vg_mesh *strip;
  const struct vg_box_tree *tree;
  const double *x;
  uint32_t patch; /* Edges of this element do not count. */
  double d2;
  uint32_t edge;
};

/* The ends of edge i in the plane z = 0: two triangles lie on it. */
static void ends(const struct vg_mesh *m, uint32_t i, const double **a,
                 const double **b)
{
  const uint32_t *v = m->tri[2 * (size_t)i];

  *a = m->point[v[0]];
  *b = m->point[v[1]];
}

static int enter(void *context, size_t node, double d2)
{
  const struct search *s = context;

  (void)node;
  return d2 < s->d2;
}

static void leaf(void *context, size_t node)
{
  struct search *s = context;
  const size_t end = vg_box_tree_end(s->tree, node);

  for (size_t k = vg_box_tree_first(s->tree, node); k < end; k++) {
    const uint32_t i = s->tree->item[k];
    const double *a, *b;
    double d2;

    if (s->strip->tri_patch[2 * (size_t)i] == s->patch) continue;
    ends(s->strip, i, &a, &b);
    /* The foot on a segment needs no area. */
    d2 = vg_to_triangle2(s->x, a, b, b);
    if (d2 < s->d2 || (d2 == s->d2 && i < s->edge)) s->d2 = d2, s->edge = i;
  }
}

static vg_status make_tree(const struct vg_mesh *m, struct vg_box_tree *tree,
                           struct vg_error *err)
{
  const size_t n = m->n_tri / 2;
  struct vg_box *box = vg_alloc(n, sizeof *box);
  vg_status st;

  if (!box) return vg_fail_memory(err, "the slots of a section");
  for (uint32_t i = 0; i < n; i++) {
    const double *a, *b;

    ends(m, i, &a, &b);
    box[i] = (struct vg_box)VG_BOX_EMPTY;
    vg_box_add(&box[i], a);
    vg_box_add(&box[i], b);
  }
  st = vg_box_tree_build_items(tree, n, box, NULL, err);
  free(box);
  return st;
}

vg_status vg_section_slot_find(const struct vg_mesh *strip,
                               struct vg_section_slot *out,
                               struct vg_error *err)
{
  struct vg_box_tree tree = { 0 };
  vg_status st;

  *out = (struct vg_section_slot){ .width = INFINITY, .edge = 1 };
  if (strip->n_patch < 2) return VG_OK;
  VG_TRY(make_tree(strip, &tree, err));
  for (uint32_t i = 0; i < strip->n_tri / 2; i++) {
    const double *a, *b;
    struct search s = { .strip = strip,
                        .tree = &tree,
                        .patch = strip->tri_patch[2 * (size_t)i],
                        .d2 = INFINITY,
                        .edge = UINT32_MAX };
    double edge;

    ends(strip, i, &a, &b);
    edge = vg_distance(a, b);
    s.x = a;
    vg_box_tree_approach(&tree, a, enter, leaf, &s);
    if (!(sqrt(s.d2) * out->edge < out->width * edge)) continue;
    *out = (struct vg_section_slot){
      .width = sqrt(s.d2),
      .edge = edge,
      .at = { a[0], a[1] },
      .patch = { s.patch, strip->tri_patch[2 * s.edge] }
    };
  }
done:
  vg_box_tree_release(&tree);
  return st;
}
