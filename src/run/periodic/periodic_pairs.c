/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/periodic/periodic_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/mesh.h"
#include "core/periodic/copy.h"
#include "core/remesh/remesh.h"
#include "run/settings/patch_names.h"
#include "run/settings/periodic_table.h"

/* S102: largest distance from the image of a point to its partner, as a share
 * of the extent of both patches: coordinates may have six digits. */
#define TOLERANCE 1e-5

int vg_pairs_have(const struct vg_pairs *list, int32_t id)
{
  for (size_t i = 0; i < list->n; i++)
    if (list->pair[i].patch == id || list->pair[i].image == id) return 1;
  return 0;
}

/* --- the pairs ------------------------------------------------------------ */

/* The one patch that a column names. */
static vg_status find_patch(const struct vg_mesh *m, size_t line, int32_t id,
                            const char *name, int32_t *out,
                            struct vg_error *err)
{
  uint8_t *on = vg_calloc(m->n_patch, 1);
  const struct vg_patch *found = NULL;
  vg_status st;

  if (!on) return vg_fail_memory(err, "the patches");
  VG_TRY(vg_patch_ref_mark("periodic", id, name, m, m->n_patch, on, err));
  for (size_t i = 0; i < m->n_patch && st >= 0; i++) {
    if (!on[i]) continue;
    if (found)
      st = vg_fail(err, VG_ERR_INPUT,
                   "periodic: line %zu: '%s' matches patches %d %s and %d %s; "
                   "name one patch",
                   line, name, (int)found->id, found->name, (int)m->patch[i].id,
                   m->patch[i].name);
    found = &m->patch[i];
    *out = found->id;
  }
done:
  free(on);
  return st;
}

/* Takes the transform of a row; 0: the row has none. */
static int take_transform(const struct vg_periodic_row *row,
                          struct vg_periodic *p)
{
  if (!isnan(row->t[0])) {
    memcpy(p->shift, row->t, sizeof p->shift);
    return 1;
  }
  if (isnan(row->angle)) return 0;
  p->is_rotation = 1;
  memcpy(p->axis, row->axis, sizeof p->axis);
  vg_unit(p->axis);
  for (int k = 0; k < 3; k++)
    p->centre[k] = isnan(row->centre[k]) ? 0 : row->centre[k];
  vg_periodic_turn(p, row->angle);
  return 1;
}

/* "patches 3 (lo) and 4 (hi)" */
static const char *name_of(const struct vg_mesh *m, const struct vg_periodic *p,
                           char *text, size_t size)
{
  const char *a = m->patch[vg_mesh_find_patch(m, p->patch)].name;
  const char *b = m->patch[vg_mesh_find_patch(m, p->image)].name;

  snprintf(text, size, "patches %d%s%s%s and %d%s%s%s", (int)p->patch,
           *a ? " (" : "", a, *a ? ")" : "", (int)p->image, *b ? " (" : "", b,
           *b ? ")" : "");
  return text;
}

static const char *transform_of(const struct vg_periodic *p, char *text,
                                size_t size)
{
  if (p->is_rotation)
    snprintf(text, size,
             "the rotation by %.9g degrees about (%.6g, %.6g, %.6g) through "
             "(%.6g, %.6g, %.6g)",
             vg_periodic_degrees(p), p->axis[0], p->axis[1], p->axis[2],
             p->centre[0], p->centre[1], p->centre[2]);
  else
    snprintf(text, size, "the translation by (%.9g, %.9g, %.9g)", p->shift[0],
             p->shift[1], p->shift[2]);
  return text;
}

static vg_status mismatch(const struct vg_mesh *m, const struct vg_periodic *p,
                          double tolerance, const struct vg_periodic_match *r,
                          const char *remedy, struct vg_error *err)
{
  char pair[2 * VG_NAME_MAX + 60], by[300], place[100] = "";

  name_of(m, p, pair, sizeof pair);
  transform_of(p, by, sizeof by);
  if (r->worst != VG_PERIODIC_NONE)
    snprintf(place, sizeof place, ", at (%g, %g, %g)", m->point[r->worst][0],
             m->point[r->worst][1], m->point[r->worst][2]);
  if (!r->n_face[0] || !r->n_face[1])
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: of %s, patch %d has no triangles; name patches "
                   "of the surface, or remove the line",
                   pair, (int)(r->n_face[0] ? p->image : p->patch));
  if (r->n_face[0] != r->n_face[1] || r->n_point[0] != r->n_point[1])
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: %s differ: %zu and %zu faces, %zu and %zu "
                   "points, areas %.6g and %.6g; by %s, the largest distance "
                   "of a point of the first from the second is %.3g%s; %s",
                   pair, r->n_face[0], r->n_face[1], r->n_point[0],
                   r->n_point[1], r->area[0], r->area[1], by, r->distance,
                   place, remedy);
  if (r->n_off)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: %s do not match by %s: %zu of %zu points have "
                   "no partner within %.3g, or within a tenth of the shortest "
                   "edge there; the largest distance is %.3g%s; %s",
                   pair, by, r->n_off, r->n_point[0], tolerance, r->distance,
                   place, remedy);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "periodic: the points of %s match by %s, with distances of at "
                 "most %.3g%s, but %zu of %zu faces have no partner between "
                 "the same points; %s",
                 pair, by, r->distance, place, r->n_bad, r->n_face[0], remedy);
}

/* Matches a pair, and moves the points of its image. */
static vg_status settle(struct vg_mesh *m, struct vg_periodic *p, int is_found,
                        size_t *n_moved, struct vg_error *err)
{
  const double tolerance = TOLERANCE * vg_periodic_extent(m, p);
  struct vg_periodic_match r = VG_PERIODIC_MATCH_INIT;
  vg_status st;

  VG_TRY(vg_periodic_match(m, p, tolerance, &r, err));
  if (is_found && !p->is_rotation && !r.n_off) {
    VG_TRY(vg_periodic_refine(m, p, &r, err));
    vg_periodic_match_release(&r);
    VG_TRY(vg_periodic_match(m, p, tolerance, &r, err));
  }
  if (vg_periodic_matches(&r)) *n_moved += vg_periodic_apply(m, p, &r);
  else
    st = mismatch(m, p, tolerance, &r,
                  is_found
                    ? "make the triangles of the patches equal, or give the "
                      "transform in the table"
                    : "correct the transform, or leave its columns out to "
                      "have it found",
                  err);
done:
  vg_periodic_match_release(&r);
  return st;
}

/* Finds the transform of a row.
 * by_corners: the faces have no partners yet. */
static vg_status find_pair(const struct vg_pairs *list, const struct vg_mesh *m,
                           const struct vg_periodic_row *row, size_t line,
                           int by_corners, struct vg_periodic *out,
                           int *is_given, struct vg_error *err)
{
  struct vg_periodic p = { .patch = 0 };
  char pair[2 * VG_NAME_MAX + 60];
  int is_found = 1;
  vg_status st;

  VG_TRY(find_patch(m, line, row->patch, row->patch_name, &p.patch, err));
  VG_TRY(find_patch(m, line, row->image, row->image_name, &p.image, err));
  if (p.patch == p.image)
    return vg_fail(err, VG_ERR_INPUT,
                   "periodic: line %zu: patch %d is paired with itself; name "
                   "another patch as its image",
                   line, (int)p.patch);
  if (vg_pairs_have(list, p.patch) || vg_pairs_have(list, p.image))
    return vg_fail(err, VG_ERR_INPUT,
                   "periodic: line %zu: patch %d is in an earlier line, too; "
                   "a patch has one partner",
                   line,
                   (int)(vg_pairs_have(list, p.patch) ? p.patch : p.image));
  *is_given = take_transform(row, &p);
  if (!*is_given && by_corners)
    VG_TRY(vg_periodic_find_corners(m, &p, &is_found, err));
  else if (!*is_given) is_found = vg_periodic_find(m, &p);
  if (!*is_given && is_found && row->kind)
    is_found = p.is_rotation == (row->kind == VG_PERIODIC_ROTATION);
  if (!is_found)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: line %zu: no %s takes %s to each other, by their "
                   "areas, mean normals and centroids; check the patches, or "
                   "give the transform in the table",
                   line,
                   row->kind == VG_PERIODIC_ROTATION      ? "rotation"
                   : row->kind == VG_PERIODIC_TRANSLATION ? "translation"
                                                          : "transform",
                   name_of(m, &p, pair, sizeof pair));
  *out = p;
done:
  return st;
}

static vg_status add_pair(struct vg_pairs *list, struct vg_mesh *m,
                          const struct vg_periodic_row *row, size_t line,
                          size_t *n_moved, struct vg_error *err)
{
  struct vg_periodic p;
  int is_given;
  vg_status st;

  VG_TRY(find_pair(list, m, row, line, 0, &p, &is_given, err));
  VG_TRY(settle(m, &p, !is_given, n_moved, err));
  list->pair[list->n++] = p;
done:
  return st;
}

static vg_status give_condition(struct vg_patch *p, struct vg_error *err)
{
  const int32_t bc = p->bc != VG_BC_NONE ? p->bc : p->bc_fun3d;

  if (bc != VG_BC_NONE && bc != VG_BC_PERIODIC)
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d%s%s is in the table periodic, but its boundary "
                   "condition is %d; leave the condition out, set %d, or "
                   "remove the patch from the table",
                   (int)p->id, *p->name ? " " : "", p->name, (int)bc,
                   VG_BC_PERIODIC);
  p->bc = p->family = p->bc_fun3d = VG_BC_PERIODIC;
  return VG_OK;
}

vg_status vg_pairs_give_conditions(const struct vg_settings *s,
                                   struct vg_mesh *m, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < 2 * s->n_periodic && st >= 0; i++) {
    const struct vg_periodic_row *row = &s->periodic_row[i / 2];
    int32_t id;

    st = i % 2
         ? find_patch(m, i / 2 + 1, row->image, row->image_name, &id, err)
         : find_patch(m, i / 2 + 1, row->patch, row->patch_name, &id, err);
    if (st >= 0) st = give_condition(&m->patch[vg_mesh_find_patch(m, id)], err);
  }
  return st;
}

/* Puts the points of both patches of all pairs in the same order. */
static vg_status order(const struct vg_pairs *list, struct vg_mesh *m,
                       int *is_changed, struct vg_error *err)
{
  struct vg_periodic_match *match = vg_calloc(list->n, sizeof *match);
  vg_status st = VG_OK;

  if (!match) return vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < list->n; i++) {
    const struct vg_periodic *p = &list->pair[i];

    VG_TRY(vg_periodic_match(m, p, VG_PERIODIC_EXACT * vg_periodic_extent(m, p),
                             &match[i], err));
  }
  st = vg_periodic_order(m, list->n, match, is_changed, err);
done:
  for (size_t i = 0; i < list->n; i++) vg_periodic_match_release(&match[i]);
  free(match);
  return st;
}

vg_status vg_pairs_settle(const struct vg_settings *s, struct vg_mesh *m,
                          struct vg_pairs *list, size_t *n_moved,
                          int *is_changed, struct vg_error *err)
{
  const size_t n = s->n_periodic;
  double distance;
  vg_status st = VG_OK;

  *n_moved = 0;
  *is_changed = 0;
  vg_pairs_release(list);
  if (!n) return VG_OK;
  list->pair = vg_alloc(n, sizeof *list->pair);
  if (!list->pair) return vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < n && st >= 0; i++)
    st = add_pair(list, m, &s->periodic_row[i], i + 1, n_moved, err);
  /* Pairs that share edges may have moved points of each other. */
  if (st >= 0)
    st = vg_pairs_verify(list, m,
                         "periodic patches that share edges must have "
                         "transforms that agree there",
                         &distance, err);
  if (st >= 0) st = order(list, m, is_changed, err);
  *is_changed |= *n_moved > 0;
  return st;
}

void vg_pairs_release(struct vg_pairs *list)
{
  free(list->pair);
  *list = (struct vg_pairs)VG_PAIRS_INIT;
}

vg_status vg_pairs_verify(const struct vg_pairs *list, const struct vg_mesh *m,
                          const char *remedy, double *distance,
                          struct vg_error *err)
{
  vg_status st = VG_OK;

  *distance = 0;
  for (size_t i = 0; i < list->n && st >= 0; i++) {
    const struct vg_periodic *p = &list->pair[i];
    const double exact = VG_PERIODIC_EXACT * vg_periodic_extent(m, p);
    struct vg_periodic_match r = VG_PERIODIC_MATCH_INIT;

    st = vg_periodic_match(m, p, exact, &r, err);
    if (st < 0) break;
    *distance = fmax(*distance, r.distance);
    if (!vg_periodic_matches(&r)) st = mismatch(m, p, exact, &r, remedy, err);
    vg_periodic_match_release(&r);
  }
  return st;
}

/* --- patches that are remeshed -------------------------------------------- */

/* The triangles of one patch with their points; with `by`, their images, of
 * opposite orientation. */
static vg_status take_patch(const struct vg_mesh *m, int32_t id,
                            const struct vg_periodic *by, struct vg_mesh *out,
                            struct vg_error *err)
{
  uint32_t *number = vg_alloc(m->n_point, sizeof *number);

  out->tri = vg_alloc(m->n_tri, sizeof *out->tri);
  out->tri_patch = vg_calloc(m->n_tri, sizeof *out->tri_patch);
  out->point = vg_alloc(m->n_point, sizeof *out->point);
  if (!number || !out->tri || !out->tri_patch || !out->point ||
      vg_mesh_add_patch(out, id, "") == SIZE_MAX) {
    free(number);
    return vg_fail_memory(err, "the periodic patches");
  }
  memset(number, 0xff, m->n_point * sizeof *number);
  for (size_t t = 0; t < m->n_tri; t++) {
    if (m->patch[m->tri_patch[t]].id != id) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t i = m->tri[t][k];

      if (number[i] == UINT32_MAX) {
        double *x = out->point[out->n_point];

        if (by) vg_periodic_image(by, m->point[i], x);
        else memcpy(x, m->point[i], 3 * sizeof *x);
        number[i] = (uint32_t)out->n_point++;
      }
      out->tri[out->n_tri][by ? 2 - k : k] = number[i];
    }
    out->n_tri++;
  }
  free(number);
  return VG_OK;
}

/* Fails if the shapes of a pair differ by more than `limit`. */
static vg_status compare(const struct vg_mesh *m, const struct vg_periodic *p,
                         double limit, int threads, const struct vg_stop *stop,
                         struct vg_error *err)
{
  struct vg_mesh side[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct vg_remesh_distance d[2];
  char pair[2 * VG_NAME_MAX + 60], by[300];
  const double *at;
  vg_status st;

  VG_TRY(take_patch(m, p->patch, p, &side[0], err));
  VG_TRY(take_patch(m, p->image, NULL, &side[1], err));
  if (!side[0].n_tri || !side[1].n_tri)
    VG_TRY(vg_fail(err, VG_ERR_GEOMETRY,
                   "periodic: of %s, patch %d has no triangles; name patches "
                   "of the surface, or remove the line",
                   name_of(m, p, pair, sizeof pair),
                   (int)(side[0].n_tri ? p->image : p->patch)));
  VG_TRY(vg_remesh_measure(&side[0], &side[1], threads, stop, NULL, d, err));
  at = d[d[1].most > d[0].most].at;
  if (fmax(d[0].most, d[1].most) > limit)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "periodic: %s do not match by %s: the largest distance is "
                 "%.3g, at (%g, %g, %g) of patch %d, and at most %.3g is "
                 "allowed; make the patches images of each other, or correct "
                 "the transform",
                 name_of(m, p, pair, sizeof pair),
                 transform_of(p, by, sizeof by), fmax(d[0].most, d[1].most),
                 at[0], at[1], at[2], (int)p->image, limit);
done:
  for (int i = 0; i < 2; i++) vg_mesh_release(&side[i]);
  return st;
}

vg_status vg_pairs_locate(const struct vg_settings *s, const struct vg_mesh *m,
                          double chord, int threads, const struct vg_stop *stop,
                          struct vg_pairs *list, struct vg_error *err)
{
  const size_t n = s->n_periodic;
  vg_status st = VG_OK;

  vg_pairs_release(list);
  if (!n) return VG_OK;
  list->pair = vg_alloc(n, sizeof *list->pair);
  if (!list->pair) return vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < n; i++) {
    struct vg_periodic *p = &list->pair[list->n];
    int is_given;

    VG_TRY(
      find_pair(list, m, &s->periodic_row[i], i + 1, 1, p, &is_given, err));
    VG_TRY(compare(m, p, (2 * chord + TOLERANCE) * vg_periodic_extent(m, p),
                   threads, stop, err));
    list->n++;
  }
done:
  return st;
}

/* Replaces *origin of the former triangles by that of the new ones. */
static void follow_origin(uint32_t **origin, size_t n,
                          struct vg_periodic_copied *c)
{
  for (size_t t = 0; t < n && *origin; t++)
    c->origin[t] = (*origin)[c->origin[t]];
  free(*origin);
  *origin = c->origin;
  c->origin = NULL;
}

vg_status vg_pairs_copy(const struct vg_pairs *list, struct vg_mesh *m,
                        uint32_t **origin, size_t *n_changed,
                        struct vg_error *err)
{
  struct vg_periodic_copied c = VG_PERIODIC_COPIED_INIT;
  vg_status st = VG_OK;

  *n_changed = 0;
  /* Patches of several pairs may share edges: then each pair changes the border
   * of the others, until all edges follow from one of them. */
  for (size_t round = 0; round < list->n; round++)
    for (size_t i = 0; i < list->n; i++) {
      const struct vg_periodic *p = &list->pair[i];

      VG_TRY(
        vg_periodic_copy(m, p, TOLERANCE * vg_periodic_extent(m, p), &c, err));
      *n_changed += c.n_inserted + c.n_removed;
      follow_origin(origin, m->n_tri, &c);
    }
done:
  vg_periodic_copied_release(&c);
  return st;
}
