/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader of CGNS; see io/cgns/cgns.h. For each zone it reads the points, then
 * the patches that the zone's BC_t give to the elements of each section, then
 * the elements. */
#include "io/cgns/cgns_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/cgns/cgns_conditions.h"
#include "io/cgns/cgns_read_parts.h"
#include "io/stream/convention.h"
#include "io/vgrid/mapbc.h"

#define NONE VG_CGNS_NONE

enum element { PASSED, TRI, QUAD, TET, PYR, PRI, HEX };
enum { MIXED = 20, NODES_MOST = 8 };

/* CGNS's element types of first order, and points and lines. Slot k of the file
 * is our node slot[k]. */
static const struct type {
  int64_t code;
  enum element element;
  int n_node, slot[NODES_MOST];
} types[] = {
  { 5, TRI, 3, { 0, 1, 2 } },
  { 7, QUAD, 4, { 0, 1, 2, 3 } },
  { 10, TET, 4, { 0, 1, 2, 3 } },
  { 12, PYR, 5, { 0, 3, 4, 1, 2 } },
  { 14, PRI, 6, { 0, 1, 2, 3, 4, 5 } },
  { 17, HEX, 8, { 0, 1, 2, 3, 4, 5, 6, 7 } },
  { 2, PASSED, 1, { 0 } },
  { 3, PASSED, 2, { 0 } },
  { 4, PASSED, 3, { 0 } },
};

struct vg_cgns_section {
  struct vg_cgns_node node;
  int64_t code, first, last; /* element numbers */
  int64_t *v;                /* [n_v] connectivity */
  size_t n_v;
  uint32_t *patch; /* [last - first + 1], NONE: no BC_t */
};

/* --- nodes --- */

vg_status vg_cgns_fail_zone(const struct vg_cgns_reader *r,
                            struct vg_error *err, vg_status code,
                            const char *what)
{
  return vg_fail(err, code, "%s: zone '%s': %s", r->in->path, r->zone.name,
                 what);
}

/* First child with this label and, unless NULL, this name; id is -1 if there is
 * none. */
static vg_status find_child(struct vg_cgns_reader *r, int64_t parent,
                            const char *label, const char *name,
                            struct vg_cgns_node *out, struct vg_error *err)
{
  struct vg_cgns_node *list;
  size_t n;
  vg_status st = vg_cgns_tree_children(r->tree, parent, label, &list, &n, err);

  if (st < 0) return st;
  *out = (struct vg_cgns_node){ .id = -1 };
  for (size_t i = n; i-- > 0;)
    if (!name || !strcmp(list[i].name, name)) *out = list[i];
  free(list);
  return VG_OK;
}

/* Text of a child, shortened if necessary; "" if there is no such child. */
vg_status vg_cgns_child_text(struct vg_cgns_reader *r, int64_t parent,
                             const char *label, const char *name,
                             char to[VG_CGNS_NAME], struct vg_error *err)
{
  struct vg_cgns_node node;
  char *text = NULL;
  size_t n;
  vg_status st = find_child(r, parent, label, name, &node, err);

  *to = 0;
  if (st < 0 || node.id < 0) return st;
  st = vg_cgns_tree_text(r->tree, node.id, label, &text, &n, err);
  if (st >= 0) strncat(to, text, VG_CGNS_NAME - 1);
  free(text);
  return st;
}

/* Name of a family, without the base that may precede it: "/Base/wing". */
vg_status vg_cgns_family_name(struct vg_cgns_reader *r, int64_t parent,
                              char to[VG_CGNS_NAME], struct vg_error *err)
{
  vg_status st = vg_cgns_child_text(r, parent, "FamilyName_t", NULL, to, err);
  char *slash = strrchr(to, '/');

  if (slash) memmove(to, slash + 1, strlen(slash));
  return st;
}

static int by_name(const void *a, const void *b)
{
  return strcmp(((const struct vg_cgns_family *)a)->name,
                ((const struct vg_cgns_family *)b)->name);
}

static vg_status read_families(struct vg_cgns_reader *r, int64_t base,
                               struct vg_error *err)
{
  struct vg_cgns_node *list;
  size_t n;
  vg_status st = vg_cgns_tree_children(r->tree, base, "Family_t", &list, &n,
                                       err);

  if (st < 0) return st;
  if (vg_reserve(&r->family, &r->cap_family, r->n_family + n,
                 sizeof *r->family))
    st = vg_fail_memory(err, "the families");
  for (size_t i = 0; i < n && st >= 0; i++) {
    struct vg_cgns_family *f = &r->family[r->n_family++];

    memcpy(f->name, list[i].name, sizeof f->name);
    st = vg_cgns_child_text(r, list[i].id, "FamilyBC_t", NULL, f->condition,
                            err);
    if (st >= 0)
      st = vg_cgns_child_text(r, list[i].id, "Descriptor_t", VG_CGNS_NUMBER,
                              f->number, err);
    if (st >= 0)
      st = vg_cgns_child_text(r, list[i].id, "Descriptor_t", VG_CGNS_KIND,
                              f->kind, err);
  }
  free(list);
  return st;
}

/* Find or create the patch with this name. condition "" means that of the
 * family with the same name. */
vg_status vg_cgns_find_patch(struct vg_cgns_reader *r, const char *name,
                             const char *condition, uint32_t *at,
                             struct vg_error *err)
{
  const struct vg_cgns_family *f = vg_cgns_find_family(r, name);
  struct vg_patch *p;
  vg_status st = vg_soup_named_patch(&r->soup, name, strlen(name), at, err);

  if (st < 0) return st;
  p = &r->soup.m.patch[*at];
  if (p->bc == VG_BC_NONE && *condition) vg_cgns_take_condition(condition, p);
  if (p->bc == VG_BC_NONE && f) vg_cgns_take_condition(f->condition, p);
  return VG_OK;
}

/* --- points --- */

/* Read the three coordinates of the points, [n_point] each, which the caller
 * frees also on failure. */
vg_status vg_cgns_read_coordinates(struct vg_cgns_reader *r, double *x[3],
                                   struct vg_error *err)
{
  static const char *const name[3] = { "CoordinateX", "CoordinateY",
                                       "CoordinateZ" };
  struct vg_cgns_node grid, node;
  vg_status st = find_child(r, r->zone.id, "GridCoordinates_t", NULL, &grid,
                            err);

  for (int k = 0; k < 3 && st >= 0; k++) {
    size_t n = 0;

    node.id = -1;
    if (grid.id >= 0)
      st = find_child(r, grid.id, "DataArray_t", name[k], &node, err);
    if (st >= 0 && node.id >= 0)
      st = vg_cgns_tree_reals(r->tree, node.id, name[k], &x[k], &n, err);
    if (st >= 0 && (node.id < 0 || n != r->n_point))
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: zone '%s': %s has %zu values for "
                   "%zu points",
                   r->in->path, r->zone.name, name[k], n, r->n_point);
  }
  return st;
}

static vg_status read_points(struct vg_cgns_reader *r, struct vg_error *err)
{
  double *x[3] = { NULL, NULL, NULL };
  vg_status st;

  VG_TRY(vg_cgns_read_coordinates(r, x, err));
  r->point = vg_alloc(r->n_point, sizeof *r->point);
  if (!r->point) VG_TRY(vg_fail_memory(err, "the points"));
  for (size_t i = 0; i < r->n_point; i++) {
    const double p[3] = { x[0][i], x[1][i], x[2][i] };

    VG_TRY((r->n_zone > 1 ? vg_soup_weld : vg_soup_point)(&r->soup, p,
                                                          &r->point[i], err));
  }
done:
  for (int k = 0; k < 3; k++) free(x[k]);
  return st;
}

/* --- sections --- */

static const struct type *find_type(int64_t code)
{
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (types[i].code == code) return types + i;
  return NULL;
}

static vg_status unknown_type(const struct vg_cgns_reader *r,
                              const struct vg_cgns_section *s, int64_t code,
                              struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: section '%s': elements of type %lld are polygons, or "
                 "not of first order; write TRI_3, QUAD_4 or MIXED",
                 r->in->path, s->node.name, (long long)code);
}

static vg_status fail_section(const struct vg_cgns_reader *r,
                              const struct vg_cgns_section *s, const char *what,
                              struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT, "%s: section '%s': %s", r->in->path,
                 s->node.name, what);
}

/* Read element numbers, nodes and kind of a section. */
static vg_status read_section(struct vg_cgns_reader *r,
                              struct vg_cgns_section *s, struct vg_error *err)
{
  int64_t *kind = NULL, *range = NULL;
  struct vg_cgns_node node, nodes;
  const struct type *t;
  uint64_t n_element;
  size_t n;
  vg_status st;

  VG_TRY(vg_cgns_tree_ints(r->tree, s->node.id, s->node.name, &kind, &n, err));
  s->code = n ? kind[0] : -1;
  t = find_type(s->code);
  if (!t && s->code != MIXED) VG_TRY(unknown_type(r, s, s->code, err));
  VG_TRY(find_child(r, s->node.id, "IndexRange_t", "ElementRange", &node, err));
  VG_TRY(find_child(r, s->node.id, "DataArray_t", "ElementConnectivity", &nodes,
                    err));
  if (node.id < 0 || nodes.id < 0)
    VG_TRY(fail_section(r, s, "no ElementRange or ElementConnectivity", err));
  VG_TRY(vg_cgns_tree_ints(r->tree, node.id, "ElementRange", &range, &n, err));
  if (n != 2 || range[0] < 1 || range[1] < range[0])
    VG_TRY(fail_section(r, s, "ElementRange is not a valid range", err));
  s->first = range[0];
  s->last = range[1];
  VG_TRY(vg_cgns_tree_ints(r->tree, nodes.id, "ElementConnectivity", &s->v,
                           &s->n_v, err));
  /* A mixed element has at least a type and one node. */
  n_element = (uint64_t)(s->last - s->first) + 1;
  if (t ? s->n_v % (size_t)t->n_node || s->n_v / (size_t)t->n_node != n_element
        : s->n_v / 2 < n_element)
    VG_TRY(fail_section(r, s,
                        "ElementConnectivity does not match the number of "
                        "elements in ElementRange",
                        err));
  s->patch = vg_alloc((size_t)n_element, sizeof *s->patch);
  if (!s->patch) VG_TRY(vg_fail_memory(err, "the elements"));
  memset(s->patch, 0xff, (size_t)n_element * sizeof *s->patch);
done:
  free(kind);
  free(range);
  return st;
}

static int by_number(const void *a, const void *b)
{
  const struct vg_cgns_section *p = a, *q = b;

  return (p->first > q->first) - (p->first < q->first);
}

static vg_status read_sections(struct vg_cgns_reader *r, struct vg_error *err)
{
  struct vg_cgns_node *list;
  size_t n;
  vg_status st = vg_cgns_tree_children(r->tree, r->zone.id, "Elements_t", &list,
                                       &n, err);

  if (st < 0) return st;
  r->section = vg_calloc(n, sizeof *r->section);
  if (!r->section) st = vg_fail_memory(err, "the sections");
  for (size_t i = 0; i < n && st >= 0; i++) {
    r->section[i].node = list[i];
    r->n_section = i + 1;
    st = read_section(r, &r->section[i], err);
  }
  free(list);
  if (st < 0 || !n) return st;
  qsort(r->section, n, sizeof *r->section, by_number);
  for (size_t i = 1; i < n && st >= 0; i++)
    if (r->section[i].first <= r->section[i - 1].last)
      st = fail_section(r, &r->section[i],
                        "its element numbers overlap with those of another "
                        "section",
                        err);
  return st;
}

/* --- conditions --- */

/* Section that contains this element, or the first one after it; n_section if
 * no section does. */
static size_t find_section(const struct vg_cgns_reader *r, int64_t element)
{
  size_t lo = 0, hi = r->n_section;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (r->section[mid].last < element) lo = mid + 1;
    else hi = mid;
  }
  return lo;
}

static void mark_range(struct vg_cgns_reader *r, int64_t first, int64_t last,
                       uint32_t patch)
{
  for (size_t i = find_section(r, first); i < r->n_section; i++) {
    struct vg_cgns_section *s = &r->section[i];
    int64_t from = first > s->first ? first : s->first;
    int64_t to = last < s->last ? last : s->last;

    if (s->first > last) break;
    for (int64_t e = from; e <= to; e++) s->patch[e - s->first] = patch;
  }
}

/* Does a BC_t refer to elements (1), or is it ignored (0)? */
static vg_status is_on_elements(struct vg_cgns_reader *r,
                                const struct vg_cgns_node *b, const char *list,
                                int *on, struct vg_error *err)
{
  char at[VG_CGNS_NAME];
  vg_status st = vg_cgns_child_text(r, b->id, "GridLocation_t", NULL, at, err);

  if (st < 0) return st;
  /* Old files use these names for lists of elements. */
  *on = !strncmp(list, "Element", 7) || !strcmp(at, "FaceCenter") ||
        !strcmp(at, "CellCenter");
  /* Points and edges of a surface are its boundary. */
  if (*on || r->dimension == 2 || !strcmp(at, "EdgeCenter")) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: condition '%s' is given on points (GridLocation %s), "
                 "which does not determine its faces; write it with "
                 "FaceCenter",
                 r->in->path, b->name, *at ? at : "Vertex");
}

/* Elements of a BC_t, given as a range or a list. */
vg_status vg_cgns_elements_of(struct vg_cgns_reader *r,
                              const struct vg_cgns_node *b,
                              char name[VG_CGNS_NAME], int64_t **v, size_t *n,
                              struct vg_error *err)
{
  static const char *const label[] = { "IndexRange_t", "IndexArray_t" };
  static const char *const known[] = { "PointRange", "PointList",
                                       "ElementRange", "ElementList" };
  struct vg_cgns_node node = { .id = -1 };
  vg_status st = VG_OK;

  *v = NULL;
  *n = 0;
  for (int k = 0; k < 4 && node.id < 0 && st >= 0; k++)
    st = find_child(r, b->id, label[k % 2], known[k], &node, err);
  if (st < 0 || node.id < 0) return st;
  memcpy(name, node.name, sizeof node.name);
  return vg_cgns_tree_ints(r->tree, node.id, node.name, v, n, err);
}

/* Patch of a BC_t: that of its family if it has one, otherwise of its own
 * name. */
vg_status vg_cgns_condition_patch(struct vg_cgns_reader *r,
                                  const struct vg_cgns_node *b, uint32_t *patch,
                                  struct vg_error *err)
{
  char family[VG_CGNS_NAME], *type = NULL;
  size_t n;
  vg_status st;

  VG_TRY(vg_cgns_family_name(r, b->id, family, err));
  VG_TRY(vg_cgns_tree_text(r->tree, b->id, b->name, &type, &n, err));
  st = vg_cgns_find_patch(r, *family ? family : b->name,
                          strcmp(type, "FamilySpecified") ? type : "", patch,
                          err);
done:
  free(type);
  return st;
}

static vg_status read_condition(struct vg_cgns_reader *r,
                                const struct vg_cgns_node *b,
                                struct vg_error *err)
{
  char list[VG_CGNS_NAME] = "";
  int64_t *v = NULL;
  size_t n;
  uint32_t patch;
  int on;
  vg_status st;

  VG_TRY(vg_cgns_elements_of(r, b, list, &v, &n, err));
  if (!n) goto done;
  VG_TRY(is_on_elements(r, b, list, &on, err));
  if (!on) goto done;
  VG_TRY(vg_cgns_condition_patch(r, b, &patch, err));
  if (strstr(list, "Range")) {
    if (n != 2)
      VG_TRY(vg_fail(err, VG_ERR_FORMAT,
                     "%s: condition '%s': its %s is not a valid range",
                     r->in->path, b->name, list));
    mark_range(r, v[0], v[1], patch);
  } else {
    for (size_t i = 0; i < n; i++) mark_range(r, v[i], v[i], patch);
  }
done:
  free(v);
  return st;
}

/* Call `read` for every condition of the zone. */
vg_status vg_cgns_read_conditions(struct vg_cgns_reader *r,
                                  vg_cgns_read_one *read, struct vg_error *err)
{
  struct vg_cgns_node zone_bc, *list;
  size_t n;
  vg_status st = find_child(r, r->zone.id, "ZoneBC_t", NULL, &zone_bc, err);

  if (st < 0 || zone_bc.id < 0) return st;
  st = vg_cgns_tree_children(r->tree, zone_bc.id, "BC_t", &list, &n, err);
  if (st < 0) return st;
  for (size_t i = 0; i < n && st >= 0; i++) st = read(r, &list[i], err);
  free(list);
  return st;
}

/* --- elements --- */

/* Nodes of a new element, which is counted; NULL if there is not enough
 * memory. */
static uint32_t *next_element(struct vg_cgns_reader *r, enum element e,
                              uint32_t patch)
{
  struct vg_mesh *m = &r->soup.m;

#define NEXT(array, count)                                                     \
  (vg_reserve(&m->array, &r->cap[e], m->count + 1, sizeof *m->array)           \
     ? NULL                                                                    \
     : m->array[m->count++])
  switch (e) {
  case QUAD:
    if (vg_reserve(&m->quad_patch, &r->cap_quad_patch, m->n_quad + 1,
                   sizeof *m->quad_patch))
      return NULL;
    m->quad_patch[m->n_quad] = patch;
    return NEXT(quad, n_quad);
  case TET: return NEXT(tet, n_tet);
  case PYR: return NEXT(pyr, n_pyr);
  case PRI: return NEXT(pri, n_pri);
  default: return NEXT(hex, n_hex);
  }
#undef NEXT
}

/* patch: of a face; tag: of a cell */
static vg_status take_element(struct vg_cgns_reader *r,
                              const struct vg_cgns_section *s,
                              const struct type *t, int64_t number,
                              const int64_t *v, uint32_t patch, int32_t tag,
                              struct vg_error *err)
{
  uint32_t node[NODES_MOST], *to;

  for (int k = 0; k < t->n_node; k++) {
    if (v[k] < 1 || (uint64_t)v[k] > r->n_point)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: element %lld of section '%s' refers to point %lld "
                     "of %zu",
                     r->in->path, (long long)number, s->node.name,
                     (long long)v[k], r->n_point);
    node[t->slot[k]] = r->point[v[k] - 1];
  }
  if (t->element == PASSED) return VG_OK;
  if (t->element == TRI) return vg_soup_triangle(&r->soup, node, patch, err);
  if (t->element > QUAD && vg_cgns_take_tag(r, t->element, tag))
    return vg_fail_memory(err, "the zones");
  to = next_element(r, t->element, patch);
  if (!to) return vg_fail_memory(err, "the elements");
  memcpy(to, node, (size_t)t->n_node * sizeof *to);
  return VG_OK;
}

/* Patch of faces without a condition, created for the first of them. */
static vg_status default_patch(struct vg_cgns_reader *r,
                               const struct vg_cgns_section *s, uint32_t *patch,
                               struct vg_error *err)
{
  char family[VG_CGNS_NAME] = "";
  const char *name = s->node.name;
  vg_status st = VG_OK;

  if (r->dimension == 2) st = vg_cgns_family_name(r, r->zone.id, family, err);
  if (st < 0) return st;
  if (*family) name = family;
  else if (r->dimension == 2 && r->n_zone > 1) name = r->zone.name;
  return vg_cgns_find_patch(r, name, "", patch, err);
}

static vg_status take_section(struct vg_cgns_reader *r,
                              const struct vg_cgns_section *s,
                              struct vg_error *err)
{
  const struct type *t = find_type(s->code);
  uint32_t other = NONE;
  size_t at = 0, region = r->first_region;
  vg_status st = VG_OK;

  for (int64_t e = s->first; e <= s->last && st >= 0; e++) {
    uint32_t patch = s->patch[e - s->first];

    if (s->code == MIXED) {
      if (at == s->n_v) return fail_section(r, s, "too few nodes", err);
      t = find_type(s->v[at++]);
      if (!t) return unknown_type(r, s, s->v[at - 1], err);
      if (s->n_v - at < (size_t)t->n_node)
        return fail_section(r, s, "too few nodes", err);
    }
    if (patch == NONE && (t->element == TRI || t->element == QUAD)) {
      if (other == NONE) st = default_patch(r, s, &other, err);
      patch = other;
    }
    if (st >= 0)
      st = take_element(r, s, t, e, s->v + at, patch,
                        vg_cgns_region_of(r, e, &region), err);
    at += (size_t)t->n_node;
  }
  if (st >= 0 && at != s->n_v)
    st = fail_section(r, s,
                      "more nodes than those of the elements in "
                      "ElementRange",
                      err);
  return st;
}

/* --- zones --- */

static void release_zone(struct vg_cgns_reader *r)
{
  for (size_t i = 0; i < r->n_section; i++) {
    free(r->section[i].v);
    free(r->section[i].patch);
  }
  free(r->section);
  free(r->point);
  free(r->cell);
  vg_cgns_block_release(&r->block);
  r->section = NULL;
  r->point = r->cell = NULL;
  r->n_section = 0;
}

static vg_status read_elements(struct vg_cgns_reader *r, const int64_t *size,
                               size_t n, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (n < 3 || size[0] < 0 || (uint64_t)size[0] >= UINT32_MAX)
    VG_TRY(vg_cgns_fail_zone(r, err, VG_ERR_FORMAT,
                             "its number of points is missing, negative or "
                             "beyond 32 bits"));
  r->n_point = (size_t)size[0];
  VG_TRY(read_points(r, err));
  VG_TRY(read_sections(r, err));
  VG_TRY(vg_cgns_read_conditions(r, read_condition, err));
  VG_TRY(vg_cgns_read_regions(r, err));
  for (size_t i = 0; i < r->n_section; i++)
    VG_TRY(take_section(r, &r->section[i], err));
done:
  return st;
}

static vg_status read_zone(struct vg_cgns_reader *r, struct vg_error *err)
{
  char type[VG_CGNS_NAME];
  int64_t *size = NULL;
  size_t n;
  vg_status st;

  VG_TRY(vg_cgns_child_text(r, r->zone.id, "ZoneType_t", NULL, type, err));
  VG_TRY(vg_cgns_tree_ints(r->tree, r->zone.id, r->zone.name, &size, &n, err));
  if (!strcmp(type, "Unstructured")) VG_TRY(read_elements(r, size, n, err));
  else if (!strcmp(type, "Structured"))
    VG_TRY(vg_cgns_read_block(r, size, n, err));
  else
    VG_TRY(vg_cgns_fail_zone(r, err, VG_ERR_UNSUPPORTED,
                             "it is neither "
                             "Structured nor Unstructured"));
done:
  free(size);
  release_zone(r);
  return st;
}

/* --- bases --- */

struct base {
  int64_t id, dimension;
  struct vg_cgns_node *zone; /* [n_zone] */
  size_t n_zone;
};

static vg_status read_base(struct vg_cgns_reader *r,
                           const struct vg_cgns_node *node, struct base *b,
                           struct vg_error *err)
{
  int64_t *dimension = NULL;
  size_t n;
  vg_status st = vg_cgns_tree_ints(r->tree, node->id, node->name, &dimension,
                                   &n, err);

  if (st < 0) return st;
  b->id = node->id;
  b->dimension = n == 2 && dimension[1] == 3 ? dimension[0] : 0;
  free(dimension);
  return vg_cgns_tree_children(r->tree, b->id, "Zone_t", &b->zone, &b->n_zone,
                               err);
}

static vg_status read_bases(struct vg_cgns_reader *r, struct base *b, size_t n,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < n; i++)
    if (b[i].dimension == r->dimension) {
      r->n_zone += b[i].n_zone;
      VG_TRY(read_families(r, b[i].id, err));
    }
  if (r->n_family) qsort(r->family, r->n_family, sizeof *r->family, by_name);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < b[i].n_zone; k++) {
      if (b[i].dimension != r->dimension) continue;
      r->zone = b[i].zone[k];
      VG_TRY(read_zone(r, err));
    }
done:
  return st;
}

/* A base of surfaces in addition to one of cells is the boundary of these
 * cells, often with a solution, and is not read again. */
static vg_status read_tree(struct vg_cgns_reader *r, int64_t root,
                           struct vg_error *err)
{
  struct vg_cgns_node *list = NULL;
  struct base *base = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_cgns_tree_children(r->tree, root, "CGNSBase_t", &list, &n, err));
  base = vg_calloc(n, sizeof *base);
  if (!base) VG_TRY(vg_fail_memory(err, "the bases"));
  for (size_t i = 0; i < n; i++) {
    VG_TRY(read_base(r, &list[i], &base[i], err));
    if (base[i].dimension <= 3 && base[i].dimension > r->dimension)
      r->dimension = base[i].dimension;
  }
  if (!n)
    st = vg_fail(err, VG_ERR_FORMAT, "%s: the file has no base (CGNSBase_t)",
                 r->in->path);
  else if (r->dimension < 2)
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: base '%s' must have cells of dimension 2 or 3 in "
                 "three-dimensional space",
                 r->in->path, list[0].name);
  else st = read_bases(r, base, n, err);
done:
  for (size_t i = 0; base && i < n; i++) free(base[i].zone);
  free(base);
  free(list);
  return st;
}

/* FUN3D's codes of symmetry planes depend on the axis that the plane is normal
 * to. */
static vg_status set_axes(struct vg_mesh *m, struct vg_error *err)
{
  int *axis = vg_alloc(m->n_patch, sizeof *axis);
  vg_status st = axis ? vg_patch_axes(m, axis, err)
                      : vg_fail_memory(err, "the patches");

  for (size_t p = 0; p < m->n_patch && st >= 0; p++)
    m->patch[p].bc_fun3d = vg_bc_to_fun3d(m->patch[p].bc, axis[p]);
  free(axis);
  return st;
}

static int by_value(const void *a, const void *b)
{
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;

  return (p > q) - (p < q);
}

/* Gives the patches the numbers that their families record, if all do and the
 * numbers differ. */
static vg_status restore_numbers(struct vg_cgns_reader *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->soup.m;
  int32_t *id = vg_alloc(2 * m->n_patch, sizeof *id), *sorted;
  int is_valid = 1;

  if (!id) return vg_fail_memory(err, "the patches");
  sorted = id + m->n_patch;
  for (size_t p = 0; p < m->n_patch && is_valid; p++) {
    const struct vg_cgns_family *f = vg_cgns_find_family(r, m->patch[p].name);
    int64_t v;

    is_valid = f && vg_parse_int(f->number, strlen(f->number), &v) &&
               v >= INT32_MIN && v <= INT32_MAX;
    if (is_valid) id[p] = sorted[p] = (int32_t)v;
  }
  if (is_valid && m->n_patch)
    qsort(sorted, m->n_patch, sizeof *sorted, by_value);
  for (size_t p = 1; p < m->n_patch && is_valid; p++)
    is_valid = sorted[p] != sorted[p - 1];
  for (size_t p = 0; p < m->n_patch && is_valid; p++) m->patch[p].id = id[p];
  free(id);
  return VG_OK;
}

static vg_status finish(struct vg_cgns_reader *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->soup.m;
  int has_cells = m->n_tet || m->n_pyr || m->n_pri || m->n_hex;
  vg_status st;

  if (!m->n_tri && !m->n_quad && !has_cells && r->n_volume_block)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: no BC_t says which faces of its structured blocks "
                   "(%zu) bound the flow; write a BC_t with a PointRange "
                   "for each wall, or the surface as zones in a base of "
                   "cell dimension 2",
                   r->in->path, r->n_volume_block);
  if (!m->n_tri && !m->n_quad && !has_cells)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: no triangles, quadrilaterals or "
                   "cells: there is nothing to mesh",
                   r->in->path);
  VG_TRY(vg_check_points(r->in->path, m->n_point, (const double(*)[3])m->point,
                         err));
  if (has_cells) VG_TRY(vg_cgns_make_zones(r, err));
  else vg_mesh_keep_boundary(m);
  VG_TRY(vg_mesh_turn(m, NULL, err));
  VG_TRY(set_axes(m, err));
  VG_TRY(restore_numbers(r, err));
done:
  return st;
}

vg_status vg_cgns_take(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_cgns_reader r = { .in = in, .soup = VG_SOUP_INIT };
  int64_t root;
  vg_status st = vg_cgns_tree_open(in, &r.tree, &root, err);

  if (st < 0) return st;
  VG_TRY(read_tree(&r, root, err));
  VG_TRY(finish(&r, err));
  vg_soup_finish(&r.soup, out);
done:
  release_zone(&r);
  vg_soup_release(&r.soup);
  free(r.family);
  free(r.region);
  for (int e = 0; e < VG_CGNS_N_ELEMENT; e++) free(r.tag[e]);
  vg_cgns_tree_close(r.tree, NULL);
  return st;
}
