/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writer of CGNS files of meshes in two dimensions, which are small: HDF5
 * stores the arrays in memory. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/cgns/cgns.h"
#include "io/cgns/cgns_conditions.h"
#include "io/cgns/cgns_store.h"
#include "io/cgns/cgns_tree.h"
#include "io/stream/patch_words.h"

enum { BAR_2 = 3, TRI_3 = 5, QUAD_4 = 7, BLOCK = 1 << 16 };

struct plane {
  const struct vg_plane_mesh *m;
  struct vg_cgns_tree *tree;
  char (*word)[VG_PATCH_WORD];
  int64_t base, zone, boundary;
  int32_t n_element;
};

static vg_status add(struct plane *p, int64_t parent, const char *name,
                     const char *label, const char *type, int n_dim,
                     uint64_t rows, uint64_t columns, const void *value,
                     int64_t *id, struct vg_error *err)
{
  const struct vg_cgns_data d = { type, n_dim, { rows, columns }, value };

  return vg_cgns_tree_add(p->tree, parent, name, label, &d, id, NULL, err);
}

static vg_status add_text(struct plane *p, int64_t parent, const char *name,
                          const char *label, const char *text, int64_t *id,
                          struct vg_error *err)
{
  return add(p, parent, name, label, "C1", 1, strlen(text), 0, text, id, err);
}

static vg_status put_zone(struct plane *p, int64_t root, struct vg_error *err)
{
  static const float version = 3.4f;
  static const int32_t two[2] = { 2, 2 };
  const int32_t size[3] = { (int32_t)p->m->n_point,
                            (int32_t)(p->m->n_quad + p->m->n_tri), 0 };
  vg_status st;

  VG_TRY(add(p, root, "CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4", 1, 1,
             0, &version, NULL, err));
  VG_TRY(add(p, root, "Base", "CGNSBase_t", "I4", 1, 2, 0, two, &p->base, err));
  VG_TRY(add(p, p->base, "Zone", "Zone_t", "I4", 2, 1, 3, size, &p->zone, err));
  st = add_text(p, p->zone, "ZoneType", "ZoneType_t", "Unstructured", NULL,
                err);
done:
  return st;
}

static vg_status put_points(struct plane *p, struct vg_error *err)
{
  static const char *const name[2] = { "CoordinateX", "CoordinateY" };
  const size_t n = p->m->n_point;
  double *x = vg_alloc(n, sizeof *x);
  int64_t grid;
  vg_status st;

  if (!x) return vg_fail_memory(err, "the nodes of a CGNS file");
  VG_TRY(add(p, p->zone, "GridCoordinates", "GridCoordinates_t", "MT", 0, 0, 0,
             NULL, &grid, err));
  for (int k = 0; k < 2; k++) {
    for (size_t i = 0; i < n; i++) x[i] = p->m->x[i][k];
    VG_TRY(add(p, grid, name[k], "DataArray_t", "R8", 1, n, 0, x, NULL, err));
  }
done:
  free(x);
  return st;
}

/* A section of n elements with n_node points each. */
static vg_status put_section(struct plane *p, const char *name, int32_t type,
                             size_t n, size_t n_node, const uint32_t *node,
                             struct vg_error *err)
{
  const int32_t range[2] = { p->n_element + 1, p->n_element + (int32_t)n };
  const int32_t kind[2] = { type, 0 };
  int32_t *v;
  int64_t section;
  vg_status st;

  if (!n) return VG_OK;
  v = vg_alloc(n * n_node, sizeof *v);
  if (!v) return vg_fail_memory(err, "the nodes of a CGNS file");
  for (size_t i = 0; i < n * n_node; i++) v[i] = (int32_t)node[i] + 1;
  VG_TRY(
    add(p, p->zone, name, "Elements_t", "I4", 1, 2, 0, kind, &section, err));
  VG_TRY(add(p, section, "ElementRange", "IndexRange_t", "I4", 1, 2, 0, range,
             NULL, err));
  VG_TRY(add(p, section, "ElementConnectivity", "DataArray_t", "I4", 1,
             n * n_node, 0, v, NULL, err));
  p->n_element += (int32_t)n;
done:
  free(v);
  return st;
}

/* The edges of a patch with its condition, and its family with its number. */
static vg_status put_patch(struct plane *p, size_t first, size_t end,
                           struct vg_error *err)
{
  const struct vg_patch *patch = &p->m->patch[p->m->edge_patch[first]];
  const char *word = p->word[p->m->edge_patch[first]];
  const char *type = vg_cgns_condition(patch);
  const int32_t range[2] = { p->n_element + 1,
                             p->n_element + (int32_t)(end - first) };
  char number[16];
  int64_t id;
  vg_status st;

  snprintf(number, sizeof number, "%" PRId32, patch->id);
  VG_TRY(put_section(p, word, BAR_2, end - first, 2, p->m->edge[first], err));
  VG_TRY(add_text(p, p->boundary, word, "BC_t", "FamilySpecified", &id, err));
  VG_TRY(
    add(p, id, "PointRange", "IndexRange_t", "I4", 2, 1, 2, range, NULL, err));
  VG_TRY(
    add_text(p, id, "GridLocation", "GridLocation_t", "EdgeCenter", NULL, err));
  VG_TRY(add_text(p, id, "FamilyName", "FamilyName_t", word, NULL, err));
  VG_TRY(add(p, p->base, word, "Family_t", "MT", 0, 0, 0, NULL, &id, err));
  VG_TRY(add_text(p, id, VG_CGNS_NUMBER, "Descriptor_t", number, NULL, err));
  st = add_text(p, id, "FamilyBC", "FamilyBC_t", type ? type : "UserDefined",
                NULL, err);
done:
  return st;
}

static vg_status put_tree(struct plane *p, int64_t root, struct vg_error *err)
{
  const struct vg_plane_mesh *m = p->m;
  vg_status st;

  VG_TRY(put_zone(p, root, err));
  VG_TRY(put_points(p, err));
  VG_TRY(put_section(p, "Quadrilaterals", QUAD_4, m->n_quad, 4,
                     (const uint32_t *)m->quad, err));
  VG_TRY(put_section(p, "Triangles", TRI_3, m->n_tri, 3,
                     (const uint32_t *)m->tri, err));
  VG_TRY(add(p, p->zone, "ZoneBC", "ZoneBC_t", "MT", 0, 0, 0, NULL,
             &p->boundary, err));
  for (size_t i = 0, end; i < m->n_edge; i = end) {
    for (end = i; end < m->n_edge && m->edge_patch[end] == m->edge_patch[i];)
      end++;
    VG_TRY(put_patch(p, i, end, err));
  }
done:
  return st;
}

static vg_status write_store(const char *path,
                             const struct vg_cgns_store *store,
                             struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  unsigned char *block = vg_alloc(BLOCK, 1);
  vg_status st;

  if (!block) return vg_fail_memory(err, "the nodes of a CGNS file");
  VG_TRY(vg_output_open(path, &out, err));
  for (uint64_t at = 0, n; at < store->size; at += n) {
    n = store->size - at < BLOCK ? store->size - at : BLOCK;
    vg_cgns_store_get(store, at, n, block);
    vg_output_bytes(&out, block, (size_t)n);
  }
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(block);
  return st;
}

/* No patch may have the name of another node. */
static vg_status make_words(struct plane *p, struct vg_error *err)
{
  static const char *const taken[] = { "Zone",           "ZoneType",
                                       "ZoneBC",         "GridCoordinates",
                                       "Quadrilaterals", "Triangles" };
  struct vg_mesh m = { .n_patch = p->m->n_patch };

  m.patch = vg_alloc(m.n_patch, sizeof *m.patch);
  for (size_t i = 0; m.patch && i < m.n_patch; i++) {
    m.patch[i] = p->m->patch[i];
    for (size_t k = 0; k < sizeof taken / sizeof *taken; k++)
      if (!strcmp(m.patch[i].name, taken[k]))
        snprintf(m.patch[i].name, VG_NAME_MAX, "patch_%s", taken[k]);
  }
  if (m.patch) p->word = vg_patch_words(&m, VG_CGNS_WORD_MOST);
  free(m.patch);
  return p->word ? VG_OK : vg_fail_memory(err, "the names of the patches");
}

vg_status vg_cgns_plane_write(const char *path, const struct vg_plane_mesh *m,
                              struct vg_error *err)
{
  struct vg_cgns_store store = VG_CGNS_STORE_INIT;
  struct plane p = { .m = m };
  int64_t root;
  vg_status st, closed;

  if (4 * (m->n_quad + m->n_tri + m->n_edge) > INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: the mesh in two dimensions has more than 500 million "
                   "cells; coarsen it",
                   path);
  VG_TRY(make_words(&p, err));
  VG_TRY(vg_cgns_tree_new(&store, path, &p.tree, &root, err));
  st = put_tree(&p, root, err);
  closed = vg_cgns_tree_close(p.tree, st < 0 ? NULL : err);
  if (st >= 0) st = closed;
  if (st >= 0) st = write_store(path, &store, err);
done:
  vg_cgns_store_release(&store);
  free(p.word);
  return st;
}
