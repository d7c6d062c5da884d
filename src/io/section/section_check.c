/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks that the curves of a section bound a region of the plane. */
#include "io/section/section_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/search/box_pairs.h"

struct check {
  const struct vg_section *s;
  const char *path;
  uint32_t *next, *element; /* [n_point] of each point and its segment */
  struct vg_error *err;
};

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

/* Whether p, on the line through a and b, is between them. */
static int is_between(const double *a, const double *b, const double *p)
{
  const int k = a[0] != b[0] ? 0 : 1;

  return a[k] < b[k] ? a[k] <= p[k] && p[k] <= b[k]
                     : b[k] <= p[k] && p[k] <= a[k];
}

/* Whether two segments share a point. */
static int touch(const double *a, const double *b, const double *c,
                 const double *d)
{
  const int side[4] = { sign(vg_orient2d(a, b, c)), sign(vg_orient2d(a, b, d)),
                        sign(vg_orient2d(c, d, a)),
                        sign(vg_orient2d(c, d, b)) };

  if (side[0] * side[1] < 0 && side[2] * side[3] < 0) return 1;
  return (!side[0] && is_between(a, b, c)) ||
         (!side[1] && is_between(a, b, d)) ||
         (!side[2] && is_between(c, d, a)) || (!side[3] && is_between(c, d, b));
}

/* Segments a b and b c overlap if c is on the side of a. */
static int folds_back(const double *a, const double *b, const double *c)
{
  return !sign(vg_orient2d(a, b, c)) &&
         (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0;
}

static vg_status visit(void *context, int worker, uint32_t i, uint32_t j)
{
  const struct check *k = context;
  const struct vg_section *s = k->s;
  const double(*x)[2] = (const double(*)[2])s->x;
  const uint32_t i_next = k->next[i], j_next = k->next[j];
  int bad;

  (void)worker;
  if (i_next == j) bad = folds_back(x[i], x[j], x[j_next]);
  else if (j_next == i) bad = folds_back(x[j], x[i], x[i_next]);
  else bad = touch(x[i], x[i_next], x[j], x[j_next]);
  if (!bad) return VG_OK;
  return vg_fail(k->err, VG_ERR_GEOMETRY,
                 "%s: %s: the segment from (%.6g, %.6g) to (%.6g, %.6g), lines "
                 "%zu and %zu, and that from (%.6g, %.6g) to (%.6g, %.6g), "
                 "lines %zu and %zu; correct these points, or check the order "
                 "of the points",
                 k->path,
                 k->element[i] == k->element[j]
                   ? "the section crosses or touches itself"
                   : "two elements cross or touch each other",
                 x[i][0], x[i][1], x[i_next][0], x[i_next][1], s->line[i],
                 s->line[i_next], x[j][0], x[j][1], x[j_next][0], x[j_next][1],
                 s->line[j], s->line[j_next]);
}

static vg_status check_crossings(struct check *k)
{
  const struct vg_section *s = k->s;
  struct vg_box *box = vg_alloc(s->n_point, sizeof *box);
  struct vg_box_tree tree = { 0 };
  vg_status st;

  if (!box) return vg_fail_memory(k->err, "the check of a section");
  for (size_t i = 0; i < s->n_point; i++) {
    const double *a = s->x[i], *b = s->x[k->next[i]];

    box[i] = (struct vg_box)VG_BOX_EMPTY;
    vg_box_add(&box[i], (const double[3]){ a[0], a[1], 0 });
    vg_box_add(&box[i], (const double[3]){ b[0], b[1], 0 });
  }
  VG_TRY(vg_box_tree_build_items(&tree, s->n_point, box, NULL, k->err));
  st = vg_box_tree_pairs(&tree, 1, visit, k);
  if (st == VG_ERR_MEMORY)
    st = vg_fail_memory(k->err, "the check of a section");
done:
  vg_box_tree_release(&tree);
  free(box);
  return st;
}

/* Whether p is inside element e: the parity of the segments to its right. */
static int is_inside(const struct check *k, size_t e, const double p[2])
{
  const struct vg_section *s = k->s;
  const struct vg_section_element *of = &s->element[e];
  int inside = 0;

  for (size_t i = of->first; i < of->first + of->n; i++) {
    const double *a = s->x[i], *b = s->x[k->next[i]];
    const double *low = a[1] < b[1] ? a : b, *high = a[1] < b[1] ? b : a;

    if (low[1] <= p[1] && p[1] < high[1])
      inside ^= vg_orient2d(low, high, p) > 0;
  }
  return inside;
}

static vg_status check_nesting(const struct check *k)
{
  const struct vg_section *s = k->s;

  for (size_t e = 0; e < s->n; e++)
    for (size_t o = 0; o < s->n; o++) {
      const size_t at = s->element[o].first;

      if (o != e && is_inside(k, e, s->x[at]))
        return vg_fail(k->err, VG_ERR_GEOMETRY,
                       "%s: element %zu %s, from (%.6g, %.6g) in line %zu, is "
                       "inside element %zu %s; the fluid is outside of all "
                       "elements. Remove one of them",
                       k->path, o + 1, s->element[o].name, s->x[at][0],
                       s->x[at][1], s->line[at], e + 1, s->element[e].name);
    }
  return VG_OK;
}

vg_status vg_section_check(const struct vg_section *s, const char *path,
                           struct vg_error *err)
{
  struct check k = { .s = s, .path = path, .err = err };
  vg_status st = VG_OK;

  if (s->n_point >= UINT32_MAX / 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%s: too many points", path);
  k.next = vg_alloc(s->n_point, sizeof *k.next);
  k.element = vg_alloc(s->n_point, sizeof *k.element);
  if (!k.next || !k.element) {
    st = vg_fail_memory(err, "the check of a section");
    goto done;
  }
  for (size_t e = 0; e < s->n; e++)
    for (size_t i = 0; i < s->element[e].n; i++) {
      const size_t at = s->element[e].first + i;

      k.element[at] = (uint32_t)e;
      k.next[at] = (uint32_t)(i + 1 < s->element[e].n ? at + 1
                                                      : s->element[e].first);
    }
  VG_TRY(check_crossings(&k));
  st = check_nesting(&k);
done:
  free(k.next);
  free(k.element);
  return st;
}
