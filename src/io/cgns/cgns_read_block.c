/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Structured zones; see io/cgns/cgns.h. All faces of a surface are read; of a
 * block with cells, only the faces of its conditions. */
#include "io/cgns/cgns_read_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static vg_status set_block(struct vg_cgns_reader *r, const int64_t *size,
                           size_t n, struct vg_error *err)
{
  uint64_t total = 1;

  r->n_index = n == 3 || n == 6 || n == 9 ? (int)(n / 3) : 0;
  if (r->n_index != r->dimension)
    return vg_cgns_fail_zone(r, err, VG_ERR_FORMAT,
                             "its sizes are not those of a structured zone "
                             "in this base");
  r->flat = -1;
  for (int k = 2; k >= 0; k--) {
    r->block.n[k] = k < r->n_index ? size[k] : 1;
    if (r->block.n[k] < 1 || r->block.n[k] >= UINT32_MAX ||
        __builtin_mul_overflow(total, (uint64_t)r->block.n[k], &total) ||
        total >= UINT32_MAX)
      return vg_cgns_fail_zone(r, err, VG_ERR_FORMAT,
                               "its numbers of points "
                               "are not positive, or beyond 32 bits");
  }
  for (int k = 0; k < 3; k++)
    if (r->block.n[k] == 1) r->flat = k;
  r->n_point = (size_t)total;
  return VG_OK;
}

static vg_status fail_range(const struct vg_cgns_reader *r,
                            const struct vg_cgns_node *b, const char *what,
                            struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED, "%s: zone '%s': condition '%s' %s",
                 r->in->path, r->zone.name, b->name, what);
}

/* Axis that a range of faces is normal to: the one along which both ends have
 * the number of the first point, or of the last, which no cell has. -1: no
 * axis, -2: several. */
static int normal_of_faces(const struct vg_cgns_reader *r,
                           const struct vg_cgns_range *range)
{
  int axis = -1;

  for (int k = 0; k < 3; k++) {
    if (range->lo[k] != range->hi[k]) continue;
    if (range->lo[k] == r->block.n[k]) return k;
    if (range->lo[k] == 1) axis = axis == -1 ? k : -2;
  }
  return axis;
}

/* Axis along which all points of a range have the same number; -1 if there is
 * none or more than one, in which case there are no faces between the
 * points. */
static int normal_of_points(const struct vg_cgns_range *range)
{
  int axis = -1, n = 0;

  for (int k = 0; k < 3; k++)
    if (range->lo[k] == range->hi[k]) {
      axis = k;
      n++;
    }
  return n == 1 ? axis : -1;
}

/* Read the points of a BC_t. Its range refers to points or to the faces between
 * them. *axis becomes the index direction normal to the faces; -1: the range
 * has no faces. */
static vg_status take_range(const struct vg_cgns_reader *r,
                            const struct vg_cgns_node *b, const int64_t *v,
                            const char *at, struct vg_cgns_range *range,
                            int *axis, struct vg_error *err)
{
  const int is_face = *at && strcmp(at, "Vertex");
  int is_outside = 0;

  for (int k = 0; k < 3; k++) {
    int64_t p = k < r->n_index ? v[k] : 1;
    int64_t q = k < r->n_index ? v[r->n_index + k] : 1;

    range->lo[k] = p < q ? p : q;
    range->hi[k] = p < q ? q : p;
    is_outside |= range->lo[k] < 1 || range->hi[k] > r->block.n[k];
  }
  if (r->flat >= 0) *axis = r->flat;
  else if (!is_face) *axis = normal_of_points(range);
  else if (*at >= 'I' && *at <= 'K') *axis = *at - 'I';
  else *axis = normal_of_faces(r, range);
  if (*axis == -2)
    return fail_range(r, b,
                      "does not tell the direction of its faces; write "
                      "IFaceCenter, JFaceCenter or KFaceCenter",
                      err);
  for (int k = 0; k < 3 && is_face && !is_outside; k++)
    if (k != *axis) is_outside |= ++range->hi[k] > r->block.n[k];
  if (!is_outside) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: zone '%s': the PointRange of condition '%s' exceeds "
                 "the zone",
                 r->in->path, r->zone.name, b->name);
}

/* Read a condition. Faces of a block with cells become triangles at once; in a
 * surface, the faces are marked. */
static vg_status read_block_condition(struct vg_cgns_reader *r,
                                      const struct vg_cgns_node *b,
                                      struct vg_error *err)
{
  char list[VG_CGNS_NAME] = "", at[VG_CGNS_NAME];
  struct vg_cgns_range range;
  int64_t *v = NULL;
  size_t n;
  uint32_t patch;
  int axis;
  vg_status st;

  VG_TRY(vg_cgns_elements_of(r, b, list, &v, &n, err));
  VG_TRY(vg_cgns_child_text(r, b->id, "GridLocation_t", NULL, at, err));
  if (!n || !strcmp(at, "EdgeCenter")) goto done;
  if (strcmp(list, "PointRange") != 0 || n != 2 * (size_t)r->n_index ||
      (r->flat < 0 && !strcmp(at, "CellCenter")))
    VG_TRY(
      fail_range(r, b, "is not given as a PointRange of points or faces", err));
  VG_TRY(take_range(r, b, v, at, &range, &axis, err));
  if (axis < 0 || (r->flat >= 0 && axis != r->flat) ||
      vg_cgns_range_is_thin(&range, axis))
    goto done;
  if (range.lo[axis] != 1 && range.lo[axis] != r->block.n[axis])
    VG_TRY(fail_range(r, b, "contains faces inside the block", err));
  VG_TRY(vg_cgns_condition_patch(r, b, &patch, err));
  if (r->flat < 0)
    VG_TRY(
      vg_cgns_block_boundary(&r->block, &range, axis, patch, &r->soup, err));
  else vg_cgns_block_mark(&r->block, &range, axis, patch, r->cell);
done:
  free(v);
  return st;
}

/* Patch of the faces of a surface that have no condition. */
static vg_status zone_patch(struct vg_cgns_reader *r, uint32_t *patch,
                            struct vg_error *err)
{
  char family[VG_CGNS_NAME];
  vg_status st = vg_cgns_family_name(r, r->zone.id, family, err);

  if (st < 0) return st;
  return vg_cgns_find_patch(r, *family ? family : r->zone.name, "", patch, err);
}

vg_status vg_cgns_read_block(struct vg_cgns_reader *r, const int64_t *size,
                             size_t n, struct vg_error *err)
{
  uint32_t other = VG_CGNS_NONE;
  vg_status st;

  VG_TRY(set_block(r, size, n, err));
  VG_TRY(vg_cgns_read_coordinates(r, r->block.x, err));
  r->block.point = vg_alloc(r->n_point, sizeof *r->block.point);
  if (!r->block.point) VG_TRY(vg_fail_memory(err, "the points"));
  memset(r->block.point, 0xff, r->n_point * sizeof *r->block.point);
  if (r->flat < 0) {
    r->n_volume_block++;
    VG_TRY(vg_cgns_read_conditions(r, read_block_condition, err));
    goto done;
  }
  n = vg_cgns_block_cells(&r->block, r->flat);
  r->cell = vg_alloc(n, sizeof *r->cell);
  if (!r->cell) VG_TRY(vg_fail_memory(err, "the faces"));
  memset(r->cell, 0xff, n * sizeof *r->cell);
  VG_TRY(vg_cgns_read_conditions(r, read_block_condition, err));
  for (size_t i = 0; i < n; i++) {
    if (r->cell[i] != VG_CGNS_NONE) continue;
    if (other == VG_CGNS_NONE) VG_TRY(zone_patch(r, &other, err));
    r->cell[i] = other;
  }
  VG_TRY(vg_cgns_block_surface(&r->block, r->flat, r->cell, &r->soup, err));
done:
  return st;
}
