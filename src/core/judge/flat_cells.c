/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/judge/flat_cells.h"

#include <assert.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/vector.h"

struct vg_flat {
  struct vg_flat_boundary b;
  struct vg_table table;  /* Points of the boundary by their ids; unused if they
                             have no ids. */
  uint32_t *first, *list; /* Faces of point p: list[first[p] .. first[p + 1] -
                             1], in increasing order. */
};

const char *vg_point_kind_name(enum vg_point_kind kind)
{
  static const char *const name[VG_POINT_KINDS] = {
    "unknown", "field", "interface", "top", "wall", "slide", "surface"
  };

  return name[kind];
}

static const struct {
  const char *key, *name;
} causes[VG_FLAT_CAUSES] = {
  { "tops_of_one_patch", "four tops of one patch" },
  { "tops_of_several_patches", "four tops of several patches" },
  { "tops_and_field", "tops and field points" },
  { "tops_and_surface", "tops and other surface points" },
  { "surface", "surface points without tops" },
  { "surface_and_field", "surface and field points, no tops" },
  { "field", "field points only" },
};

const char *vg_flat_cause_key(enum vg_flat_cause cause)
{
  return causes[cause].key;
}

const char *vg_flat_cause_name(enum vg_flat_cause cause)
{
  return causes[cause].name;
}

/* --- preparation ---------------------------------------------------------- */

static uint32_t *slot_of(const struct vg_flat *f, uint32_t id)
{
  uint32_t *at;

  VG_TABLE_FIND(&f->table, at, vg_hash_1(id), f->b.id[*at] == id);
  return at;
}

static void list_faces(struct vg_flat *f)
{
  const struct vg_flat_boundary *b = &f->b;

  for (size_t i = 0; i < 3 * b->n_face; i++)
    f->first[b->face[i / 3][i % 3] + 1]++;
  for (size_t p = 0; p < b->n_point; p++) f->first[p + 1] += f->first[p];
  for (size_t i = 3 * b->n_face; i-- > 0;)
    f->list[--f->first[b->face[i / 3][i % 3] + 1]] = (uint32_t)(i / 3);
  /* Entry p + 1 now has the beginning of point p. */
  for (size_t p = 0; p < b->n_point; p++) f->first[p] = f->first[p + 1];
  f->first[b->n_point] = (uint32_t)(3 * b->n_face);
}

vg_status vg_flat_new(const struct vg_flat_boundary *b, struct vg_flat **out,
                      struct vg_error *err)
{
  assert(b && out && (b->face || !b->n_face));

  struct vg_flat *f = vg_calloc(1, sizeof *f);

  if (!f) return vg_fail_memory(err, "the causes of flat cells");
  f->b = *b;
  f->first = vg_calloc(b->n_point + 1, sizeof *f->first);
  f->list = vg_alloc(3 * b->n_face, sizeof *f->list);
  if (!f->first || !f->list ||
      (b->id && vg_table_init(&f->table, b->n_point))) {
    vg_flat_free(f);
    return vg_fail_memory(err, "the causes of flat cells");
  }
  list_faces(f);
  for (size_t p = 0; b->id && p < b->n_point; p++) {
    uint32_t *at = slot_of(f, b->id[p]);

    if (*at == VG_TABLE_FREE) *at = (uint32_t)p;
  }
  *out = f;
  return VG_OK;
}

size_t vg_flat_bytes(const struct vg_flat *f)
{
  if (!f) return 0;
  return (size_t)(f->table.end - f->table.slot) * sizeof *f->table.slot +
         (f->b.n_point + 1) * sizeof *f->first +
         3 * f->b.n_face * sizeof *f->list;
}

void vg_flat_free(struct vg_flat *f)
{
  if (!f) return;
  vg_table_release(&f->table);
  free(f->first);
  free(f->list);
  free(f);
}

/* --- classification ------------------------------------------------------- */

/* Point of the boundary, or VG_TABLE_FREE. */
static uint32_t point_of(const struct vg_flat *f, uint32_t id)
{
  if (!f->b.n_point) return VG_TABLE_FREE;
  if (f->b.id) return *slot_of(f, id);
  return id < f->b.n_point ? id : VG_TABLE_FREE;
}

static enum vg_point_kind kind_of(const struct vg_flat *f, uint32_t p)
{
  return f->b.kind ? (enum vg_point_kind)f->b.kind[p] : VG_POINT_SURFACE;
}

/* Whether a face counts for the patches of a point. */
static int counts(const struct vg_flat *f, uint32_t p, uint32_t face)
{
  enum vg_point_kind kind = kind_of(f, p);

  if (!f->b.top || (kind != VG_POINT_TOP && kind != VG_POINT_WALL)) return 1;
  return f->b.top[face] != UINT32_MAX;
}

static int has_patch(const struct vg_flat *f, uint32_t p, uint32_t patch)
{
  for (uint32_t i = f->first[p]; i < f->first[p + 1]; i++)
    if (f->b.patch[f->list[i]] == patch && counts(f, p, f->list[i])) return 1;
  return 0;
}

/* Lowest patch of point p that the n points q have, too. */
static uint32_t lowest_patch(const struct vg_flat *f, uint32_t p, int n,
                             const uint32_t *q)
{
  uint32_t low = VG_NO_PATCH;

  for (uint32_t i = f->first[p]; i < f->first[p + 1]; i++) {
    uint32_t patch = f->b.patch[f->list[i]];
    int k = 0;

    if (patch >= low || !counts(f, p, f->list[i])) continue;
    while (k < n && has_patch(f, q[k], patch)) k++;
    if (k == n) low = patch;
  }
  return low;
}

static int have_edge(const struct vg_flat *f, uint32_t p, uint32_t q)
{
  for (uint32_t i = f->first[p]; i < f->first[p + 1]; i++) {
    const uint32_t *v = f->b.face[f->list[i]];

    if (v[0] == q || v[1] == q || v[2] == q) return 1;
  }
  return 0;
}

/* Whether edges connect the n points p, n <= 4. */
static int are_connected(const struct vg_flat *f, int n, const uint32_t *p)
{
  unsigned reached = 1, before = 0;

  while (reached != before) {
    before = reached;
    for (int i = 0; i < n; i++)
      for (int k = 0; k < n; k++)
        if (before >> i & 1 && !(reached >> k & 1) && have_edge(f, p[i], p[k]))
          reached |= 1u << k;
  }
  return n == 0 || reached == (1u << n) - 1;
}

static int have_face(const struct vg_flat *f, const uint32_t p[3])
{
  for (uint32_t i = f->first[p[0]]; i < f->first[p[0] + 1]; i++) {
    const uint32_t *v = f->b.face[f->list[i]];
    int n = 0;

    for (int k = 0; k < 3; k++) n += v[k] == p[1] || v[k] == p[2];
    if (n == 2) return 1;
  }
  return 0;
}

/* Whether the triangle has an angle below the limit. */
static int is_needle(const double *const x[3])
{
  for (int k = 0; k < 3; k++) {
    double a[3], b[3];

    vg_sub(x[(k + 1) % 3], x[k], a);
    vg_sub(x[(k + 2) % 3], x[k], b);
    if (!(vg_dot(a, b) <= VG_FLAT_COSINE * vg_norm(a) * vg_norm(b))) return 1;
  }
  return 0;
}

/* p: n points of the boundary, with coordinates x. */
static int has_needle(const struct vg_flat *f, int n, const uint32_t *p,
                      const double *const *x)
{
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++)
      for (int k = 0; k < j; k++) {
        const uint32_t v[3] = { p[i], p[j], p[k] };
        const double *const corner[3] = { x[i], x[j], x[k] };

        if (is_needle(corner) && have_face(f, v)) return 1;
      }
  return 0;
}

static enum vg_flat_cause cause_of(int n_top, int n_surface, int n_inner,
                                   int one_patch)
{
  if (n_top == 4) return one_patch ? VG_FLAT_TOPS_ONE : VG_FLAT_TOPS_SEVERAL;
  if (n_top) return n_surface ? VG_FLAT_TOPS_SURFACE : VG_FLAT_TOPS_FIELD;
  if (n_surface) return n_inner ? VG_FLAT_SURFACE_FIELD : VG_FLAT_SURFACE;
  return VG_FLAT_FIELD;
}

struct vg_flat_class vg_flat_classify(const struct vg_flat *f,
                                      const uint32_t id[4],
                                      const double *const x[4],
                                      const enum vg_point_kind inner[4])
{
  struct vg_flat_class c = { .at_interface = 0 };
  uint32_t all[4], top[4], common = VG_NO_PATCH;
  const double *at[4];
  int n = 0, n_top = 0;

  for (int k = 0; k < 4; k++) {
    uint32_t p = point_of(f, id[k]);

    c.points.kind[k] = p == VG_TABLE_FREE ? inner[k] : kind_of(f, p);
    if (c.points.kind[k] == VG_POINT_TOP) top[n_top++] = p;
    c.at_interface |= c.points.kind[k] == VG_POINT_INTERFACE;
    if (p == VG_TABLE_FREE) continue;
    at[n] = x[k];
    all[n++] = p;
  }
  if (n_top) common = lowest_patch(f, top[0], n_top - 1, top + 1);
  for (int k = 0, i = 0; k < 4; k++) {
    int is_inner = c.points.kind[k] == VG_POINT_FIELD ||
                   c.points.kind[k] == VG_POINT_INTERFACE;

    c.points.patch[k] = is_inner ? VG_NO_PATCH
                      : c.points.kind[k] == VG_POINT_TOP &&
                            common != VG_NO_PATCH
                        ? common
                        : lowest_patch(f, all[i], 0, NULL);
    i += !is_inner;
  }
  c.cause = cause_of(n_top, n - n_top, 4 - n, common != VG_NO_PATCH);
  c.is_spanning = !are_connected(f, n, all);
  c.has_needle = has_needle(f, n, all, at);
  return c;
}
