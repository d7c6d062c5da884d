/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writer of CGNS files of whole meshes, and of the frame of files of slices;
 * see io/cgns/cgns.h and io/cgns/cgns_put.h. HDF5 makes the nodes in a store in
 * which the arrays are left out; the bytes between the arrays are taken from
 * that store. */
#include "io/cgns/cgns.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"
#include "io/cgns/cgns_conditions.h"
#include "io/cgns/cgns_put.h"
#include "io/cgns/cgns_store.h"
#include "io/cgns/cgns_tree.h"
#include "io/stream/boundary.h"
#include "io/stream/patch_words.h"

#define BASE "Base"
#define BLOCK 1024
#define SECOND "+quads" /* a suffix; words have no plus */
#define REGION "+faces" /* another one */
#define CELLS_OF "+cells"

/* Our node order to CGNS's, whose pyramid has its apex last; CGNS's codes of
 * kinds. */
static const struct kind {
  const char *name;
  int32_t code;
  int n_node, order[8];
} kinds[VG_CGNS_KINDS] = {
  { "Tetrahedra", 10, 4, { 0, 1, 2, 3 } },
  { "Pyramids", 12, 5, { 0, 3, 4, 1, 2 } },
  { "Prisms", 14, 6, { 0, 1, 2, 3, 4, 5 } },
  { "Hexahedra", 17, 8, { 0, 1, 2, 3, 4, 5, 6, 7 } },
};
enum { TRI_3 = 5, QUAD_4 = 7 };

/* Content of an array in the file: coordinates, cells of a kind, or the faces
 * from `first` to `end` - 1 with n_node vertices. */
enum what { POINTS, CELLS, FACES };

struct vg_cgns_array {
  uint64_t at, size;
  enum what what;
  int which;         /* axis, kind of cells, or vertices per face */
  size_t first, end; /* first: also of cells */
};

/* A file during layout. */
struct layout {
  struct vg_cgns *c;
  struct vg_cgns_tree *tree;
  char (*word)[VG_PATCH_WORD]; /* of patches, then of zones */
  uint64_t n_cell[VG_CGNS_KINDS];
  uint64_t n_element; /* number of elements in the sections so far */
  int64_t base, zone, boundary;
};

static int index_size(const struct vg_cgns_places *p)
{
  return p->is_wide ? 8 : 4;
}

static const char *index_type(const struct layout *l)
{
  return l->c->places.is_wide ? "I8" : "I4";
}

/* --- nodes --- */

static vg_status add_text(struct layout *l, int64_t parent, const char *name,
                          const char *label, const char *text, int64_t *id,
                          struct vg_error *err)
{
  const struct vg_cgns_data d = { "C1", 1, { strlen(text), 0 }, text };

  return vg_cgns_tree_add(l->tree, parent, name, label, &d, id, NULL, err);
}

static vg_status add_empty(struct layout *l, int64_t parent, const char *name,
                           const char *label, int64_t *id, struct vg_error *err)
{
  const struct vg_cgns_data d = { "MT", 0, { 0, 0 }, NULL };

  return vg_cgns_tree_add(l->tree, parent, name, label, &d, id, NULL, err);
}

/* Indices as [rows][n / rows] of the standard; n is at most 4. */
static vg_status add_indices(struct layout *l, int64_t parent, const char *name,
                             const char *label, int n_dim, size_t rows,
                             size_t n, const int64_t *v, int64_t *id,
                             struct vg_error *err)
{
  struct vg_cgns_data d = { index_type(l), n_dim, { n, 0 }, v };
  int32_t narrow[4];

  if (n_dim == 2) d.dim[0] = rows, d.dim[1] = n / rows;
  for (size_t i = 0; i < n; i++) narrow[i] = (int32_t)v[i];
  if (!l->c->places.is_wide) d.value = narrow;
  return vg_cgns_tree_add(l->tree, parent, name, label, &d, id, NULL, err);
}

/* Add a node whose data are an array of n values. */
static vg_status add_array(struct layout *l, int64_t parent, const char *name,
                           const char *type, uint64_t n, struct vg_cgns_array a,
                           struct vg_error *err)
{
  const struct vg_cgns_data d = { type, 1, { n, 0 }, NULL };
  vg_status st = vg_cgns_tree_add(l->tree, parent, name, "DataArray_t", &d,
                                  NULL, &a.at, err);

  if (st < 0) return st;
  a.size = n * (uint64_t)(type[1] - '0');
  l->c->array[l->c->n_array++] = a;
  return VG_OK;
}

static vg_status add_section(struct layout *l, const char *name, int32_t code,
                             uint64_t n, int n_node, struct vg_cgns_array a,
                             struct vg_error *err)
{
  const int64_t range[2] = { (int64_t)l->n_element + 1,
                             (int64_t)(l->n_element + n) };
  const int32_t kind[2] = { code, 0 };
  const struct vg_cgns_data d = { "I4", 1, { 2, 0 }, kind };
  int64_t section;
  vg_status st;

  VG_TRY(vg_cgns_tree_add(l->tree, l->zone, name, "Elements_t", &d, &section,
                          NULL, err));
  VG_TRY(add_indices(l, section, "ElementRange", "IndexRange_t", 1, 1, 2, range,
                     NULL, err));
  l->n_element += n;
  st = add_array(l, section, "ElementConnectivity", index_type(l),
                 n * (uint64_t)n_node, a, err);
done:
  return st;
}

/* --- the parts of the tree --- */

static vg_status layout_zone(struct layout *l, int64_t root,
                             struct vg_error *err)
{
  static const float version = 3.4f;
  static const int32_t three[2] = { 3, 3 };
  const struct vg_cgns_data release = { "R4", 1, { 1, 0 }, &version };
  const struct vg_cgns_data dimensions = { "I4", 1, { 2, 0 }, three };
  int64_t size[3] = { (int64_t)l->c->frame->n_point, 0, 0 };
  vg_status st;

  for (int k = 0; k < VG_CGNS_KINDS; k++) size[1] += (int64_t)l->n_cell[k];
  VG_TRY(vg_cgns_tree_add(l->tree, root, "CGNSLibraryVersion",
                          "CGNSLibraryVersion_t", &release, NULL, NULL, err));
  VG_TRY(vg_cgns_tree_add(l->tree, root, BASE, "CGNSBase_t", &dimensions,
                          &l->base, NULL, err));
  VG_TRY(
    add_indices(l, l->base, "Zone", "Zone_t", 2, 1, 3, size, &l->zone, err));
  st = add_text(l, l->zone, "ZoneType", "ZoneType_t", "Unstructured", NULL,
                err);
done:
  return st;
}

static vg_status layout_points(struct layout *l, struct vg_error *err)
{
  static const char *const name[3] = { "CoordinateX", "CoordinateY",
                                       "CoordinateZ" };
  int64_t grid;
  vg_status st = add_empty(l, l->zone, "GridCoordinates", "GridCoordinates_t",
                           &grid, err);

  for (int k = 0; k < 3 && st >= 0; k++)
    st = add_array(l, grid, name[k], "R8", l->c->frame->n_point,
                   (struct vg_cgns_array){ .what = POINTS, .which = k }, err);
  return st;
}

static vg_status layout_kind(struct layout *l, int k, const char *name,
                             uint64_t first, uint64_t n, struct vg_error *err)
{
  return n ? add_section(l, name, kinds[k].code, n, kinds[k].n_node,
                         (struct vg_cgns_array){
                           .what = CELLS, .which = k, .first = (size_t)first },
                         err)
           : VG_OK;
}

/* Sections of a zone follow each other, so that its elements are a range. */
static vg_status layout_cells(struct layout *l, struct vg_error *err)
{
  const struct vg_mesh *m = l->c->frame;
  char name[VG_CGNS_NAME];
  vg_status st = VG_OK;

  for (int k = 0; k < VG_CGNS_KINDS && !m->n_zone && st >= 0; k++)
    st = layout_kind(l, k, kinds[k].name, 0, l->n_cell[k], err);
  for (size_t z = 0; z < m->n_zone; z++)
    for (int k = 0; k < VG_CGNS_KINDS && st >= 0; k++) {
      snprintf(name, sizeof name, "%s+%zu", kinds[k].name, z + 1);
      st = layout_kind(l, k, name, vg_mesh_zone_start(m, z, k),
                       m->zone[z].n_cell[k], err);
    }
  return st;
}

/* Add a section for the faces of one kind. */
static vg_status layout_faces(struct layout *l, const char *word, size_t first,
                              size_t end, int n_node, int is_second,
                              struct vg_error *err)
{
  char name[VG_CGNS_NAME];

  if (first == end) return VG_OK;
  snprintf(name, sizeof name, "%.*s%s", VG_CGNS_WORD_MOST, word,
           is_second ? SECOND : "");
  return add_section(l, name, n_node == 3 ? TRI_3 : QUAD_4, end - first, n_node,
                     (struct vg_cgns_array){ .what = FACES,
                                             .which = n_node,
                                             .first = first,
                                             .end = end },
                     err);
}

/* The family of a patch has its number, which CGNS has no place for. */
static vg_status add_family(struct layout *l, const char *word, int32_t number,
                            int64_t *id, struct vg_error *err)
{
  char text[16];
  vg_status st = add_empty(l, l->base, word, "Family_t", id, err);

  snprintf(text, sizeof text, "%" PRId32, number);
  return st < 0
         ? st
         : add_text(l, *id, VG_CGNS_NUMBER, "Descriptor_t", text, NULL, err);
}

/* A region of faces or cells, with a family that has no condition. */
static vg_status layout_region(struct layout *l, const char *word, int32_t of,
                               int32_t number, const int64_t range[2],
                               int64_t *id, struct vg_error *err)
{
  const struct vg_cgns_data dimension = { "I4", 1, { 1, 0 }, &of };
  char name[VG_CGNS_NAME];
  vg_status st;

  snprintf(name, sizeof name, "%.*s%s", VG_CGNS_WORD_MOST, word,
           of == 3 ? CELLS_OF : REGION);
  VG_TRY(vg_cgns_tree_add(l->tree, l->zone, name, "ZoneSubRegion_t", &dimension,
                          id, NULL, err));
  VG_TRY(add_indices(l, *id, "PointRange", "IndexRange_t", 2, 1, 2, range, NULL,
                     err));
  VG_TRY(add_text(l, *id, "GridLocation", "GridLocation_t",
                  of == 3 ? "CellCenter" : "FaceCenter", NULL, err));
  VG_TRY(add_text(l, *id, "FamilyName", "FamilyName_t", word, NULL, err));
  st = add_family(l, word, number, id, err);
done:
  return st;
}

static vg_status layout_sheet(struct layout *l, const char *word,
                              const struct vg_patch *p, uint64_t before,
                              struct vg_error *err)
{
  const int64_t range[2] = { (int64_t)before + 1, (int64_t)l->n_element };
  int64_t id;

  return layout_region(l, word, 2, p->id, range, &id, err);
}

/* The family of a zone records its kind, too. */
static vg_status layout_zones(struct layout *l, struct vg_error *err)
{
  const struct vg_mesh *m = l->c->frame;
  int64_t range[2] = { 1, 0 }, id;
  vg_status st = VG_OK;

  for (size_t z = 0; z < m->n_zone && st >= 0; z++) {
    const uint64_t n = vg_mesh_zone_cells(m, z);

    range[1] += (int64_t)n;
    if (!n) continue;
    VG_TRY(layout_region(l, l->word[m->n_patch + z], 3, m->zone[z].id, range,
                         &id, err));
    st = add_text(l, id, VG_CGNS_KIND, "Descriptor_t",
                  vg_zone_kind_word[m->zone[z].kind], NULL, err);
    range[0] = range[1] + 1;
  }
done:
  return st;
}

static vg_status layout_condition(struct layout *l, const char *word,
                                  const struct vg_patch *p, uint64_t before,
                                  struct vg_error *err)
{
  const int64_t range[2] = { (int64_t)before + 1, (int64_t)l->n_element };
  const char *type = vg_cgns_condition(p);
  int64_t id;
  vg_status st;

  VG_TRY(add_text(l, l->boundary, word, "BC_t", "FamilySpecified", &id, err));
  VG_TRY(add_indices(l, id, "PointRange", "IndexRange_t", 2, 1, 2, range, NULL,
                     err));
  VG_TRY(
    add_text(l, id, "GridLocation", "GridLocation_t", "FaceCenter", NULL, err));
  VG_TRY(add_text(l, id, "FamilyName", "FamilyName_t", word, NULL, err));
  VG_TRY(add_family(l, word, p->id, &id, err));
  st = add_text(l, id, "FamilyBC", "FamilyBC_t", type ? type : "UserDefined",
                NULL, err);
done:
  return st;
}

/* Patches without faces are omitted. */
static vg_status layout_patches(struct layout *l, struct vg_error *err)
{
  const struct vg_mesh *m = l->c->frame;
  vg_status st = add_empty(l, l->zone, "ZoneBC", "ZoneBC_t", &l->boundary, err);

  for (size_t p = 0; p < m->n_patch && st >= 0; p++) {
    size_t first = l->c->face_first[p], end = l->c->face_first[p + 1];
    size_t quad = first;
    uint64_t before = l->n_element;

    if (first == end) continue;
    while (quad < end && l->c->face[quad] < m->n_tri) quad++;
    VG_TRY(layout_faces(l, l->word[p], first, quad, 3, 0, err));
    VG_TRY(layout_faces(l, l->word[p], quad, end, 4, quad > first, err));
    st = m->patch[p].is_sheet
         ? layout_sheet(l, l->word[p], &m->patch[p], before, err)
         : layout_condition(l, l->word[p], &m->patch[p], before, err);
  }
done:
  return st;
}

/* --- periodic patches --- */

/* Numbers of the elements of faces: those of a patch, in the order of its
 * sections, and their partners. */
static vg_status add_faces(struct layout *l, int64_t parent, const char *name,
                           size_t n, const uint64_t *element,
                           struct vg_error *err)
{
  struct vg_cgns_data d = { index_type(l), 2, { 1, n }, element };
  int32_t *narrow = NULL;
  vg_status st;

  if (!l->c->places.is_wide) {
    narrow = vg_alloc(n, sizeof *narrow);
    if (!narrow) return vg_fail_memory(err, "the periodic patches");
    for (size_t i = 0; i < n; i++) narrow[i] = (int32_t)element[i];
    d.value = narrow;
  }
  st = vg_cgns_tree_add(l->tree, parent, name, "IndexArray_t", &d, NULL, NULL,
                        err);
  free(narrow);
  return st;
}

/* The transform of p. Its angles are about x, y and z, in this order. */
static vg_status add_transform(struct layout *l, int64_t parent,
                               const struct vg_periodic *p,
                               struct vg_error *err)
{
  static const char *const name[3] = { "RotationCenter", "RotationAngle",
                                       "Translation" };
  double angle[3];
  float v[3][3];
  int64_t id;
  vg_status st;

  vg_periodic_angles(p, angle);
  for (int k = 0; k < 3; k++) {
    v[0][k] = p->is_rotation ? (float)p->centre[k] : 0;
    v[1][k] = p->is_rotation ? (float)angle[k] : 0;
    v[2][k] = p->is_rotation ? 0 : (float)p->shift[k];
  }
  VG_TRY(add_empty(l, parent, "GridConnectivityProperty",
                   "GridConnectivityProperty_t", &id, err));
  VG_TRY(add_empty(l, id, "Periodic", "Periodic_t", &id, err));
  for (int i = 0; i < 3 && st >= 0; i++) {
    const struct vg_cgns_data d = { "R4", 1, { 3, 0 }, v[i] };

    st = vg_cgns_tree_add(l->tree, id, name[i], "DataArray_t", &d, NULL, NULL,
                          err);
  }
done:
  return st;
}

static vg_status layout_link(struct layout *l, int64_t parent, size_t number,
                             const struct vg_periodic *p, size_t n,
                             const uint64_t *element, const uint64_t *donor,
                             struct vg_error *err)
{
  char name[VG_CGNS_NAME];
  int64_t id;
  vg_status st;

  snprintf(name, sizeof name, "Periodic_%zu", number);
  VG_TRY(add_text(l, parent, name, "GridConnectivity_t", "Zone", &id, err));
  VG_TRY(add_text(l, id, "GridConnectivityType", "GridConnectivityType_t",
                  "Abutting1to1", NULL, err));
  VG_TRY(
    add_text(l, id, "GridLocation", "GridLocation_t", "FaceCenter", NULL, err));
  VG_TRY(add_faces(l, id, "PointList", n, element, err));
  VG_TRY(add_faces(l, id, "PointListDonor", n, donor, err));
  st = add_transform(l, id, p, err);
done:
  return st;
}

/* Two connections for each pair, from the first patch and from the second. */
static vg_status layout_periodic(struct layout *l,
                                 const struct vg_periodic_links *links,
                                 struct vg_error *err)
{
  const struct vg_mesh *m = l->c->frame;
  const size_t n_face = m->n_tri + m->n_quad;
  const uint64_t before = l->n_element - n_face;
  uint64_t *number, *pair = NULL;
  int64_t id;
  vg_status st = VG_OK;

  if (!links || !links->n) return VG_OK;
  number = vg_alloc(n_face, sizeof *number);
  pair = vg_alloc(2 * n_face, sizeof *pair);
  if (!number || !pair) VG_TRY(vg_fail_memory(err, "the periodic patches"));
  for (size_t i = 0; i < n_face; i++) number[l->c->face[i]] = before + i + 1;
  VG_TRY(add_empty(l, l->zone, "ZoneGridConnectivity", "ZoneGridConnectivity_t",
                   &id, err));
  for (size_t i = 0; i < links->n && st >= 0; i++) {
    const struct vg_periodic reverse = vg_periodic_reverse(&links->pair[i]);
    size_t n = 0;

    for (size_t f = 0; f < n_face; f++)
      if (links->match[i].face[f] != VG_PERIODIC_NONE) {
        pair[n] = number[f];
        pair[n_face + n++] = number[links->match[i].face[f]];
      }
    VG_TRY(layout_link(l, id, 2 * i + 1, &links->pair[i], n, pair,
                       pair + n_face, err));
    st = layout_link(l, id, 2 * i + 2, &reverse, n, pair + n_face, pair, err);
  }
done:
  free(number);
  free(pair);
  return st;
}

/* --- the bytes between the arrays --- */

static int by_place(const void *a, const void *b)
{
  const struct vg_cgns_array *p = a, *q = b;

  return (p->at > q->at) - (p->at < q->at);
}

static vg_status take_between(struct vg_cgns *c,
                              const struct vg_cgns_store *store,
                              struct vg_error *err)
{
  uint64_t n = store->size, at = 0, done = 0;

  c->places.size = store->size;
  for (size_t i = 0; i < c->n_array; i++) n -= c->array[i].size;
  c->between = vg_alloc(n, 1);
  if (!c->between) return vg_fail_memory(err, "the nodes of a CGNS file");
  for (size_t i = 0; i <= c->n_array; i++) {
    uint64_t end = i < c->n_array ? c->array[i].at : store->size;

    vg_cgns_store_get(store, at, end - at, c->between + done);
    done += end - at;
    if (i < c->n_array) at = end + c->array[i].size;
  }
  return VG_OK;
}

static void note_places(struct vg_cgns *c)
{
  for (size_t i = 0; i < c->n_array; i++) {
    const struct vg_cgns_array *a = &c->array[i];

    if (a->what == POINTS) c->places.at_x[a->which] = a->at;
    else if (a->what == CELLS) c->places.at[a->which] = a->at;
  }
  if (c->n_array) qsort(c->array, c->n_array, sizeof *c->array, by_place);
}

static vg_status make_layout(const char *path, struct layout *l,
                             const struct vg_cgns_options *o,
                             struct vg_error *err)
{
  struct vg_cgns_store store = VG_CGNS_STORE_INIT;
  int64_t root;
  vg_status st;

  VG_TRY(vg_cgns_tree_new(&store, path, &l->tree, &root, err));
  VG_TRY(layout_zone(l, root, err));
  VG_TRY(layout_points(l, err));
  VG_TRY(layout_cells(l, err));
  VG_TRY(layout_zones(l, err));
  VG_TRY(layout_patches(l, err));
  if (o) VG_TRY(layout_periodic(l, o->links, err));
  st = vg_cgns_tree_close(l->tree, err);
  l->tree = NULL;
  if (st < 0) goto done;
  note_places(l->c);
  st = take_between(l->c, &store, err);
done:
  vg_cgns_tree_close(l->tree, NULL);
  vg_cgns_store_release(&store);
  return st;
}

/* Words of the patches and, after them, of the zones; none equals the name of
 * another node. */
static vg_status make_words(struct layout *l, struct vg_error *err)
{
  static const char *const taken[] = {
    "Zone",     "ZoneType", "ZoneBC",    "GridCoordinates",     "Tetrahedra",
    "Pyramids", "Prisms",   "Hexahedra", "ZoneGridConnectivity"
  };
  const struct vg_mesh *frame = l->c->frame;
  struct vg_mesh m = { .n_patch = frame->n_patch + frame->n_zone };

  m.patch = vg_calloc(m.n_patch, sizeof *m.patch);
  for (size_t p = 0; m.patch && p < m.n_patch; p++) {
    if (p < frame->n_patch) m.patch[p] = frame->patch[p];
    else {
      const struct vg_zone *z = &frame->zone[p - frame->n_patch];

      m.patch[p].id = z->id;
      snprintf(m.patch[p].name, VG_NAME_MAX, *z->name ? "%s" : "zone", z->name);
    }
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
      if (!strcmp(m.patch[p].name, taken[i]))
        snprintf(m.patch[p].name, VG_NAME_MAX, "patch_%s", taken[i]);
  }
  if (m.patch) l->word = vg_patch_words(&m, VG_CGNS_WORD_MOST);
  free(m.patch);
  return l->word ? VG_OK : vg_fail_memory(err, "the names of the patches");
}

/* Indices have 4 bytes if all counts allow it, including the nodes of a
 * section. */
static int needs_wide(const struct vg_mesh *m, const uint64_t *n_cell)
{
  uint64_t n = m->n_tri + m->n_quad;

  for (int k = 0; k < VG_CGNS_KINDS; k++) {
    n += n_cell[k];
    if (n_cell[k] * (uint64_t)kinds[k].n_node > INT32_MAX) return 1;
  }
  return n > INT32_MAX || m->n_point > INT32_MAX;
}

vg_status vg_cgns_plan(const char *path, const struct vg_mesh *frame,
                       const struct vg_cgns_options *o, struct vg_cgns *c,
                       struct vg_error *err)
{
  struct layout l = {
    .c = c, .n_cell = { frame->n_tet, frame->n_pyr, frame->n_pri, frame->n_hex }
  };
  vg_status st = VG_OK;

  *c = (struct vg_cgns){ .frame = frame };
  c->places.is_wide = (o && o->is_wide) || needs_wide(frame, l.n_cell);
  if (!(l.n_cell[0] + l.n_cell[1] + l.n_cell[2] + l.n_cell[3])) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: the mesh has no cells; write the surface as .stl or "
                 ".lb8.ugrid",
                 path);
    goto done;
  }
  c->array = vg_alloc(3 + VG_CGNS_KINDS * (1 + frame->n_zone) +
                        2 * frame->n_patch,
                      sizeof *c->array);
  if (!c->array) VG_TRY(vg_fail_memory(err, "the nodes of a CGNS file"));
  VG_TRY(make_words(&l, err));
  VG_TRY(vg_boundary_by_patch(frame, &c->face_first, &c->face, err));
  st = make_layout(path, &l, o, err);
done:
  free(l.word);
  if (st < 0) vg_cgns_release(c);
  return st;
}

void vg_cgns_release(struct vg_cgns *c)
{
  free(c->face_first);
  free(c->face);
  free(c->array);
  free(c->between);
  c->face_first = c->face = NULL;
  c->array = NULL;
  c->between = NULL;
}

/* --- writing --- */

/* Write n indices, counted from 1, in the width of the file; n is at most
 * BLOCK. */
static void put_indices(struct vg_output *out, const struct vg_cgns_places *p,
                        size_t n, const uint32_t *v)
{
  int32_t narrow[BLOCK];
  int64_t wide[BLOCK];

  if (p->is_wide) {
    for (size_t i = 0; i < n; i++) wide[i] = (int64_t)v[i] + 1;
    vg_output_i64(out, n, wide);
    return;
  }
  for (size_t i = 0; i < n; i++) narrow[i] = (int32_t)(v[i] + 1);
  vg_output_i32(out, n, narrow);
}

void vg_cgns_put_cells(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, size_t n, const uint32_t *node,
                       const uint32_t *number)
{
  const struct kind *k = &kinds[kind];
  size_t width = (size_t)k->n_node, most = BLOCK / width;
  uint32_t v[BLOCK];

  assert(kind >= 0 && kind < VG_CGNS_KINDS && (node || !n));
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < most ? n - i : most;
    for (size_t c = 0; c < m; c++, node += width)
      for (size_t j = 0; j < width; j++) {
        uint32_t at = node[k->order[j]];

        v[c * width + j] = number ? number[at] : at;
      }
    put_indices(out, p, m * width, v);
  }
}

static void put_points(struct vg_output *out, const struct vg_mesh *m, int axis)
{
  double x[BLOCK];

  for (size_t i = 0, n; i < m->n_point; i += n) {
    n = m->n_point - i < BLOCK ? m->n_point - i : BLOCK;
    for (size_t k = 0; k < n; k++) x[k] = m->point[i + k][axis];
    vg_output_f64(out, n, x);
  }
}

static void put_cells(struct vg_output *out, const struct vg_cgns *c,
                      const struct vg_cgns_array *a)
{
  const struct vg_mesh *m = c->frame;
  size_t n_node = (size_t)kinds[a->which].n_node;
  size_t n = (size_t)(a->size / (uint64_t)index_size(&c->places)) / n_node;

  vg_cgns_put_cells(out, &c->places, a->which, n,
                    vg_mesh_nodes(m, a->which) + a->first * n_node, NULL);
}

static void put_faces(struct vg_output *out, const struct vg_cgns *c,
                      const struct vg_cgns_array *a)
{
  const struct vg_mesh *m = c->frame;

  for (size_t i = a->first; i < a->end; i++) {
    size_t f = c->face[i];

    put_indices(out, &c->places, (size_t)a->which,
                f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri]);
  }
}

void vg_cgns_put(struct vg_output *out, const struct vg_cgns *c)
{
  const unsigned char *between = c->between;
  uint64_t at = 0;

  vg_output_order(out, 0);
  for (size_t i = 0; i < c->n_array; i++) {
    const struct vg_cgns_array *a = &c->array[i];

    vg_output_bytes(out, between, a->at - at);
    between += a->at - at;
    at = a->at + a->size;
    if (a->what == FACES) put_faces(out, c, a);
    else if (!c->frame->point) vg_output_skip(out, a->size);
    else if (a->what == POINTS) put_points(out, c->frame, a->which);
    else put_cells(out, c, a);
  }
  vg_output_bytes(out, between, c->places.size - at);
}

void vg_cgns_seek_x(struct vg_output *out, const struct vg_cgns_places *p,
                    int axis, uint64_t point)
{
  assert(axis >= 0 && axis < 3);
  vg_output_seek(out, p->at_x[axis] + 8 * point);
}

void vg_cgns_seek_cell(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, uint64_t cell)
{
  assert(kind >= 0 && kind < VG_CGNS_KINDS);
  vg_output_seek(out, p->at[kind] + cell * (uint64_t)kinds[kind].n_node *
                                      (uint64_t)index_size(p));
}

vg_status vg_cgns_write_with(const char *path, const struct vg_mesh *m,
                             const struct vg_cgns_options *o,
                             struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_mesh view;
  struct vg_cgns c = { .frame = NULL };
  vg_status st = vg_mesh_sheet_view(m, &view, err);

  if (st < 0) return st;
  VG_TRY(vg_cgns_plan(path, &view, o, &c, err));
  VG_TRY(vg_output_open(path, &out, err));
  vg_cgns_put(&out, &c);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  vg_cgns_release(&c);
  vg_mesh_sheet_view_release(&view, m);
  return st;
}

vg_status vg_cgns_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err)
{
  return vg_cgns_write_with(path, m, NULL, err);
}

int vg_cgns_is_built(void)
{
  return vg_cgns_tree_is_built();
}
