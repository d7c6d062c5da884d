/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Families, and zones of cells in a CGNS file: a ZoneSubRegion_t with a range
 * of cells, or a Zone_t among several. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/zones.h"
#include "io/cgns/cgns_conditions.h"
#include "io/cgns/cgns_read_parts.h"
#include "io/stream/convention.h"
#include "io/stream/stream.h"

static int by_name(const void *a, const void *b)
{
  return strcmp(((const struct vg_cgns_family *)a)->name,
                ((const struct vg_cgns_family *)b)->name);
}

const struct vg_cgns_family *vg_cgns_find_family(const struct vg_cgns_reader *r,
                                                 const char *name)
{
  struct vg_cgns_family key = { .name = "" };

  if (!r->n_family) return NULL;
  snprintf(key.name, sizeof key.name, "%.*s", VG_CGNS_NAME - 1, name);
  return bsearch(&key, r->family, r->n_family, sizeof key, by_name);
}

static vg_status add_region(struct vg_cgns_reader *r,
                            const char name[VG_CGNS_NAME], int64_t first,
                            int64_t last, struct vg_error *err)
{
  struct vg_cgns_region *to;

  if (vg_reserve(&r->region, &r->cap_region, r->n_region + 1,
                 sizeof *r->region))
    return vg_fail_memory(err, "the zones");
  to = &r->region[r->n_region++];
  *to = (struct vg_cgns_region){ .first = first, .last = last };
  memcpy(to->name, name, sizeof to->name);
  return VG_OK;
}

/* Regions of faces, of points, and lists are not zones. */
static vg_status read_region(struct vg_cgns_reader *r,
                             const struct vg_cgns_node *b, struct vg_error *err)
{
  char list[VG_CGNS_NAME] = "", at[VG_CGNS_NAME], family[VG_CGNS_NAME];
  int64_t *v = NULL;
  size_t n;
  vg_status st;

  VG_TRY(vg_cgns_child_text(r, b->id, "GridLocation_t", NULL, at, err));
  if (strcmp(at, "CellCenter")) goto done;
  VG_TRY(vg_cgns_elements_of(r, b, list, &v, &n, err));
  if (!strstr(list, "Range") || n != 2 || v[0] > v[1]) goto done;
  VG_TRY(vg_cgns_family_name(r, b->id, family, err));
  st = add_region(r, *family ? family : b->name, v[0], v[1], err);
done:
  free(v);
  return st;
}

static int by_first(const void *a, const void *b)
{
  const struct vg_cgns_region *p = a, *q = b;

  return p->first < q->first ? -1 : p->first > q->first;
}

vg_status vg_cgns_read_regions(struct vg_cgns_reader *r, struct vg_error *err)
{
  struct vg_cgns_region *own;
  struct vg_cgns_node *list = NULL;
  size_t n;
  vg_status st;

  r->first_region = r->n_region;
  VG_TRY(vg_cgns_tree_children(r->tree, r->zone.id, "ZoneSubRegion_t", &list,
                               &n, err));
  for (size_t i = 0; i < n && st >= 0; i++) st = read_region(r, &list[i], err);
  if (st >= 0 && r->n_region == r->first_region && r->n_zone > 1)
    st = add_region(r, r->zone.name, 1, INT64_MAX, err);
  if (st < 0) goto done;
  own = r->region + r->first_region;
  n = r->n_region - r->first_region;
  if (n) qsort(own, n, sizeof *own, by_first);
  for (size_t i = 1; i < n && st >= 0; i++)
    if (own[i].first <= own[i - 1].last)
      st = vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: zone '%s': the regions of cells %s and %s overlap; a "
                   "cell is in one zone",
                   r->in->path, r->zone.name, own[i - 1].name, own[i].name);
done:
  free(list);
  return st;
}

int32_t vg_cgns_region_of(const struct vg_cgns_reader *r, int64_t element,
                          size_t *hint)
{
  while (*hint < r->n_region && r->region[*hint].last < element) ++*hint;
  return *hint < r->n_region && r->region[*hint].first <= element
         ? (int32_t)*hint + 1
         : 0;
}

int vg_cgns_take_tag(struct vg_cgns_reader *r, int element, int32_t region)
{
  const struct vg_mesh *m = &r->soup.m;
  const size_t n[VG_CGNS_N_ELEMENT] = { 0,        0,        0,       m->n_tet,
                                        m->n_pyr, m->n_pri, m->n_hex };

  if (vg_reserve(&r->tag[element], &r->cap_tag[element], n[element] + 1,
                 sizeof **r->tag))
    return -1;
  r->tag[element][n[element]] = region;
  return 0;
}

/* Numbers that the families record, if they are ascending. */
static void restore(const struct vg_cgns_reader *r, struct vg_mesh *m)
{
  int32_t last = 0;
  int is_valid = 1;

  for (size_t z = 0; z < m->n_zone; z++) {
    struct vg_zone *zone = &m->zone[z];
    const size_t i = (size_t)zone->id - 1; /* of a region */
    const struct vg_cgns_family *f = NULL;
    int64_t v = 0;

    if (i < r->n_region) {
      f = vg_cgns_find_family(r, r->region[i].name);
      vg_name_from_file(r->region[i].name, strlen(r->region[i].name),
                        zone->name, sizeof zone->name);
    }
    is_valid &= f && vg_parse_int(f->number, strlen(f->number), &v) &&
                v > last && v <= INT32_MAX;
    last = zone->id = is_valid ? (int32_t)v : 0;
    for (int k = 0; f && k < VG_ZONE_KINDS; k++)
      if (!strcmp(f->kind, vg_zone_kind_word[k])) zone->kind = k;
  }
  for (size_t z = 0; z < m->n_zone && !is_valid; z++)
    m->zone[z].id = (int32_t)z + 1;
}

/* Element kinds are in the order of the mesh. */
vg_status vg_cgns_make_zones(struct vg_cgns_reader *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->soup.m;
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  const int first = VG_CGNS_N_ELEMENT - VG_ZONE_KINDS;
  int32_t *tag, *to;
  vg_status st;

  if (!r->n_region) return VG_OK;
  tag = to = vg_alloc(n[0] + n[1] + n[2] + n[3], sizeof *tag);
  if (!tag) return vg_fail_memory(err, "the zones");
  for (int k = 0; k < VG_ZONE_KINDS; to += n[k++])
    if (n[k]) memcpy(to, r->tag[first + k], n[k] * sizeof *to);
  st = vg_mesh_zones_from_tags(m, tag, 0, err);
  if (st >= 0) restore(r, m);
  free(tag);
  return st;
}
