/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writer of Gmsh's .msh, version 4.1 binary; see io/mesh/gmsh.h. Sizes and tags
 * of nodes and elements have 8 bytes, tags of entities 4. */
#include "io/mesh/gmsh.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "io/mesh/gmsh_put.h"
#include "io/stream/boundary.h"

#define BLOCK 1024

enum { TRIANGLE = 2, QUADRILATERAL = 3, SURFACE = 2, VOLUME = 3 };

/* Our node order to Gmsh's, whose pyramid has its apex last. */
static const struct kind {
  int32_t type;
  int n_node;
  int order[8];
} kinds[VG_GMSH_KINDS] = {
  { 4, 4, { 0, 1, 2, 3 } },
  { 7, 5, { 0, 3, 4, 1, 2 } },
  { 6, 6, { 0, 1, 2, 3, 4, 5 } },
  { 5, 8, { 0, 1, 2, 3, 4, 5, 6, 7 } },
};

static void put_size(struct vg_output *out, uint64_t v)
{
  vg_output_i64(out, 1, (const int64_t *)&v);
}

static uint64_t count_cells(const struct vg_gmsh *g)
{
  return g->n_cell[0] + g->n_cell[1] + g->n_cell[2] + g->n_cell[3];
}

static size_t count_faces(const struct vg_gmsh *g)
{
  return g->frame->n_tri + g->frame->n_quad;
}

/* Number of a patch, both as a surface and as a physical group. */
int32_t vg_gmsh_tag(const struct vg_gmsh *g, size_t patch)
{
  return g->has_ids ? g->frame->patch[patch].id : (int32_t)patch + 1;
}

static int is_empty(const struct vg_gmsh *g, size_t patch)
{
  return g->face_first[patch] == g->face_first[patch + 1];
}

/* --- format, names --- */

static void put_head(struct vg_output *out, const struct vg_gmsh *g)
{
  static const int32_t one = 1;

  vg_output_text(out, "$MeshFormat\n4.1 1 8\n");
  vg_output_i32(out, 1, &one);
  vg_output_format(out, "\n$EndMeshFormat\n$PhysicalNames\n%zu\n",
                   g->n_surface + g->n_volume);
  for (size_t p = 0; p < g->frame->n_patch; p++)
    if (!is_empty(g, p))
      vg_output_format(out, "2 %d \"%s\"\n", (int)vg_gmsh_tag(g, p),
                       g->word[p]);
  for (size_t v = 0; v < g->n_volume; v++)
    vg_output_format(out, "3 %d \"%s\"\n", (int)(g->volume + (int32_t)v),
                     g->volume_word[v]);
  vg_output_text(out, "$EndPhysicalNames\n");
}

/* --- entities --- */

/* Does a patch bound the volume? Sheets are in it. */
static int is_border(const struct vg_gmsh *g, size_t patch)
{
  return !is_empty(g, patch) && !g->frame->patch[patch].is_sheet;
}

/* Those of several volumes are not listed. */
static size_t count_borders(const struct vg_gmsh *g)
{
  size_t n = 0;

  if (g->n_volume > 1) return 0;
  for (size_t p = 0; p < g->frame->n_patch; p++) n += is_border(g, p);
  return n;
}

#define ENTITIES "$Entities\n"
#define ENTITIES_END "\n$EndEntities\n"

static uint64_t entities_size(const struct vg_gmsh *g)
{
  /* tag, box, number of groups, group, number of bounding entities */
  uint64_t one = 4 + 6 * 8 + 8 + 4 + 8;
  uint64_t size = 4 * 8 + (g->n_surface + g->n_volume) * one;

  if (g->n_volume) size += 4 * count_borders(g);
  return strlen(ENTITIES) + size + strlen(ENTITIES_END);
}

static void widen(double box[6], const double x[3])
{
  for (int k = 0; k < 3; k++) {
    if (x[k] < box[k]) box[k] = x[k];
    if (x[k] > box[3 + k]) box[3 + k] = x[k];
  }
}

static void patch_box(const struct vg_gmsh *g, size_t patch,
                      const double (*x)[3], double box[6])
{
  const struct vg_mesh *m = g->frame;

  for (size_t i = g->face_first[patch]; i < g->face_first[patch + 1]; i++) {
    size_t f = g->face[i];
    const uint32_t *v = f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri];

    if (i == g->face_first[patch])
      for (int k = 0; k < 6; k++) box[k] = x[v[0]][k % 3];
    for (int k = 0; k < (f < m->n_tri ? 3 : 4); k++) widen(box, x[v[k]]);
  }
}

static void put_entity(struct vg_output *out, int32_t tag, const double box[6],
                       int32_t group, uint64_t n_border)
{
  vg_output_i32(out, 1, &tag);
  vg_output_f64(out, 6, box);
  put_size(out, 1);
  vg_output_i32(out, 1, &group);
  put_size(out, n_border);
}

void vg_gmsh_put_entities(struct vg_output *out, const struct vg_gmsh *g,
                          const double (*x)[3])
{
  double all[6] = { 0, 0, 0, 0, 0, 0 }, box[6];
  int is_first = 1;

  vg_output_text(out, ENTITIES);
  put_size(out, 0);
  put_size(out, 0);
  put_size(out, g->n_surface);
  put_size(out, g->n_volume);
  for (size_t p = 0; p < g->frame->n_patch; p++) {
    if (is_empty(g, p)) continue;
    patch_box(g, p, x, box);
    put_entity(out, vg_gmsh_tag(g, p), box, vg_gmsh_tag(g, p), 0);
    if (is_first) memcpy(all, box, sizeof all);
    is_first = 0;
    widen(all, box);
    widen(all, box + 3);
  }
  for (int32_t v = 0; v < (int32_t)g->n_volume; v++) {
    put_entity(out, g->volume + v, all, g->volume + v, count_borders(g));
    for (size_t p = 0; p < g->frame->n_patch && count_borders(g); p++) {
      int32_t inward = -vg_gmsh_tag(g, p); /* surfaces are oriented as our
                                         faces, inward */

      if (is_border(g, p)) vg_output_i32(out, 1, &inward);
    }
  }
  vg_output_text(out, ENTITIES_END);
}

/* --- nodes --- */

/* All nodes are in one block, which belongs to the volume, or to the first
 * surface if there are no cells. */
static void put_nodes_head(struct vg_output *out, const struct vg_gmsh *g)
{
  int32_t entity[3] = { VOLUME, g->volume, 0 };
  uint64_t n = g->frame->n_point;
  size_t p = 0;

  vg_output_text(out, "$Nodes\n");
  put_size(out, 1);
  put_size(out, n);
  put_size(out, 1);
  put_size(out, n);
  if (!count_cells(g)) {
    while (is_empty(g, p)) p++;
    entity[0] = SURFACE;
    entity[1] = vg_gmsh_tag(g, p);
  }
  vg_output_i32(out, 3, entity);
  put_size(out, n);
}

void vg_gmsh_put_tags(struct vg_output *out, uint64_t point, size_t n)
{
  int64_t v[BLOCK];

  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < BLOCK ? n - i : BLOCK;
    for (size_t k = 0; k < m; k++) v[k] = (int64_t)(point + i + k) + 1;
    vg_output_i64(out, m, v);
  }
}

/* --- elements --- */

#define HEAD_SIZE (3 * 4 + 8) /* bytes of the head of a block */

static void put_block(struct vg_output *out, int32_t dimension, int32_t tag,
                      int32_t type, uint64_t n)
{
  const int32_t head[3] = { dimension, tag, type };

  vg_output_i32(out, 3, head);
  put_size(out, n);
}

/* Write the faces `first` to `end` - 1 of a patch, which have n_node vertices.
 * Returns the next tag. */
static uint64_t put_faces(struct vg_output *out, const struct vg_gmsh *g,
                          size_t patch, size_t first, size_t end, int n_node,
                          uint64_t tag)
{
  const struct vg_mesh *m = g->frame;

  if (first == end) return tag;
  put_block(out, SURFACE, vg_gmsh_tag(g, patch),
            n_node == 3 ? TRIANGLE : QUADRILATERAL, end - first);
  for (size_t i = first; i < end; i++) {
    size_t f = g->face[i];
    const uint32_t *v = f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri];

    put_size(out, tag++);
    for (int k = 0; k < n_node; k++) put_size(out, (uint64_t)v[k] + 1);
  }
  return tag;
}

/* Position of the first quadrilateral of a patch. */
static size_t first_quad(const struct vg_gmsh *g, size_t patch)
{
  size_t i = g->face_first[patch];

  while (i < g->face_first[patch + 1] && g->face[i] < g->frame->n_tri) i++;
  return i;
}

/* Cells of a kind in volume v, which follow those of the volumes before. */
static uint64_t cells_in(const struct vg_gmsh *g, int kind, size_t v)
{
  return g->frame->n_zone ? g->frame->zone[v].n_cell[kind] : g->n_cell[kind];
}

static void put_elements_head(struct vg_output *out, const struct vg_gmsh *g)
{
  uint64_t n_block = 0, n = count_faces(g) + count_cells(g), tag = 1;
  size_t n_patch = g->frame->n_patch;

  for (size_t p = 0; p < n_patch; p++) {
    size_t quad = first_quad(g, p);

    n_block += (quad > g->face_first[p]) + (quad < g->face_first[p + 1]);
  }
  for (int k = 0; k < VG_GMSH_KINDS; k++)
    for (size_t v = 0; v < g->n_volume; v++) n_block += cells_in(g, k, v) > 0;
  vg_output_text(out, "$Elements\n");
  put_size(out, n_block);
  put_size(out, n);
  put_size(out, 1);
  put_size(out, n);
  for (size_t p = 0; p < n_patch; p++) {
    size_t quad = first_quad(g, p);

    tag = put_faces(out, g, p, g->face_first[p], quad, 3, tag);
    tag = put_faces(out, g, p, quad, g->face_first[p + 1], 4, tag);
  }
}

static uint64_t cell_size(int kind)
{
  return 8 * (1 + (uint64_t)kinds[kind].n_node);
}

void vg_gmsh_put_cells(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell, size_t n, const uint32_t *node,
                       const uint32_t *number)
{
  const struct kind *k = &kinds[kind];
  size_t width = (size_t)k->n_node, most = BLOCK / (1 + width);
  int64_t tag = (int64_t)(g->first[kind] + cell), v[BLOCK];

  assert(kind >= 0 && kind < VG_GMSH_KINDS && (node || !n));
  for (size_t i = 0, m; i < n; i += m) {
    int64_t *to = v;

    m = n - i < most ? n - i : most;
    for (size_t c = 0; c < m; c++, node += width) {
      *to++ = tag++;
      for (size_t j = 0; j < width; j++) {
        uint32_t p = node[k->order[j]];

        *to++ = (int64_t)(number ? number[p] : p) + 1;
      }
    }
    vg_output_i64(out, (size_t)(to - v), v);
  }
}

/* --- the file --- */

static void put_points(struct vg_output *out, const struct vg_gmsh *g,
                       uint64_t *at_tag, uint64_t *at_point)
{
  const struct vg_mesh *m = g->frame;

  put_nodes_head(out, g);
  *at_tag = out->written;
  if (m->point) vg_gmsh_put_tags(out, 0, m->n_point);
  else vg_output_skip(out, 8 * (uint64_t)m->n_point);
  *at_point = out->written;
  if (m->point) vg_output_f64(out, 3 * m->n_point, m->point[0]);
  else vg_output_skip(out, 24 * (uint64_t)m->n_point);
  vg_output_text(out, "\n$EndNodes\n");
}

static void put_cells(struct vg_output *out, const struct vg_gmsh *g,
                      uint64_t at[VG_GMSH_KINDS])
{
  const struct vg_mesh *m = g->frame;

  for (int k = 0; k < VG_GMSH_KINDS; k++) {
    uint64_t first = 0;

    at[k] = out->written;
    for (size_t v = 0; v < g->n_volume; v++) {
      const uint64_t n = cells_in(g, k, v);

      if (!n) continue;
      put_block(out, VOLUME, g->volume + (int32_t)v, kinds[k].type, n);
      if (!m->point) vg_output_skip(out, n * cell_size(k));
      else
        vg_gmsh_put_cells(out, g, k, first, (size_t)n,
                          vg_mesh_nodes(m, k) + first * (size_t)kinds[k].n_node,
                          NULL);
      first += n;
    }
  }
}

/* --- periodic surfaces --- */

/* The image of a point as a matrix of 4 x 4, by rows. */
static void put_transform(struct vg_output *out, const struct vg_periodic *p)
{
  const int64_t n = 16;
  double a[16] = { [15] = 1 }, zero[3] = { 0 }, e[3], x[3];

  for (int j = 0; j < 3; j++) {
    for (int k = 0; k < 3; k++) e[k] = k == j;
    vg_periodic_vector(p, 0, e, x);
    for (int k = 0; k < 3; k++) a[4 * k + j] = x[k];
  }
  vg_periodic_image(p, zero, x);
  for (int k = 0; k < 3; k++) a[4 * k + 3] = x[k];
  vg_output_i64(out, 1, &n);
  vg_output_f64(out, 16, a);
}

void vg_gmsh_put_periodic(struct vg_output *out, const struct vg_gmsh *g,
                          const struct vg_periodic_links *links)
{
  if (!links || !links->n) return;
  vg_output_text(out, "$Periodic\n");
  vg_output_i64(out, 1, &(int64_t){ (int64_t)links->n });
  for (size_t i = 0; i < links->n; i++) {
    const struct vg_periodic *p = &links->pair[i];
    const struct vg_periodic_match *match = &links->match[i];
    const int32_t tag[3] = {
      SURFACE, vg_gmsh_tag(g, vg_mesh_find_patch(g->frame, p->image)),
      vg_gmsh_tag(g, vg_mesh_find_patch(g->frame, p->patch))
    };

    vg_output_i32(out, 3, tag);
    put_transform(out, p);
    vg_output_i64(out, 1, &(int64_t){ (int64_t)match->n_point[0] });
    for (size_t k = 0; k < links->n_point; k++) {
      const int64_t node[2] = { (int64_t)match->point[k] + 1, (int64_t)k + 1 };

      if (match->point[k] != VG_PERIODIC_NONE) vg_output_i64(out, 2, node);
    }
  }
  vg_output_text(out, "\n$EndPeriodic\n");
}

/* --- the whole file --- */

/* Write the file and record the offsets of its parts. */
static void put_all(struct vg_output *out, const struct vg_gmsh *g,
                    struct vg_gmsh *found)
{
  const struct vg_mesh *m = g->frame;

  vg_output_order(out, 0);
  put_head(out, g);
  found->at_entities = out->written;
  if (m->point) vg_gmsh_put_entities(out, g, (const double(*)[3])m->point);
  else vg_output_skip(out, entities_size(g));
  put_points(out, g, &found->at_tag, &found->at_point);
  put_elements_head(out, g);
  put_cells(out, g, found->at);
  vg_output_text(out, "\n$EndElements\n");
}

void vg_gmsh_put(struct vg_output *out, const struct vg_gmsh *g)
{
  struct vg_gmsh found;

  put_all(out, g, &found);
}

/* Determine the offsets by writing the frame without a file. */
static vg_status find_places(struct vg_gmsh *g, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_mesh frame = *g->frame;
  struct vg_gmsh nowhere = *g;
  vg_status st = vg_output_shared(NULL, &out, err);

  if (st < 0) return st;
  frame.point = NULL;
  nowhere.frame = &frame;
  put_all(&out, &nowhere, g);
  vg_output_release(&out);
  return VG_OK;
}

/* Names of the volumes that no surface and no other volume has. */
static vg_status name_volumes(struct vg_gmsh *g, struct vg_error *err)
{
  const struct vg_mesh *m = g->frame;
  const size_t n = m->n_patch + g->n_volume;
  char(*word)[VG_PATCH_WORD] = vg_zone_words(m, VG_PATCH_WORD_MOST);
  char(*used)[VG_PATCH_WORD] = vg_alloc(n, sizeof *used);

  g->volume_word = vg_alloc(g->n_volume, sizeof *g->volume_word);
  if (word && used && g->volume_word) {
    if (m->n_patch) memcpy(used, g->word, m->n_patch * sizeof *used);
    for (size_t v = 0; v < g->n_volume; v++) {
      vg_patch_free_word((const char(*)[VG_PATCH_WORD])used, m->n_patch + v,
                         m->n_zone ? word[v] : "fluid", g->volume_word[v]);
      memcpy(used[m->n_patch + v], g->volume_word[v], sizeof *used);
    }
  }
  if (!word || !used || !g->volume_word) {
    free(word);
    free(used);
    return vg_fail_memory(err, "the names of the zones");
  }
  free(word);
  free(used);
  return VG_OK;
}

/* Number surfaces and volumes. Some programs look up a
 * group by its number or name alone, without the dimension, so both are unique
 * over dimensions. */
static void number_groups(struct vg_gmsh *g)
{
  const struct vg_mesh *m = g->frame;
  int32_t last = 0;

  for (size_t p = 0; p < m->n_patch; p++) {
    int32_t id = m->patch[p].id;

    g->n_surface += !is_empty(g, p);
    g->has_ids &= id > 0 && id < INT32_MAX;
    if (id > last) last = id;
  }
  g->has_ids &= last <= INT32_MAX - (int32_t)(g->n_volume + 1);
  g->volume = 1 + (g->has_ids ? last : (int32_t)m->n_patch);
}

vg_status vg_gmsh_plan(const char *path, const struct vg_mesh *frame,
                       struct vg_gmsh *g, struct vg_error *err)
{
  vg_status st;

  *g = (struct vg_gmsh){ .frame = frame,
                         .has_ids = 1,
                         .n_cell = { frame->n_tet, frame->n_pyr, frame->n_pri,
                                     frame->n_hex } };
  if (!count_faces(g) && !count_cells(g))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the mesh has neither faces nor "
                   "cells, and a .msh needs some",
                   path);
  g->word = vg_patch_words(frame, VG_PATCH_WORD_MOST);
  if (!g->word) return vg_fail_memory(err, "the names of the patches");
  VG_TRY(vg_boundary_by_patch(frame, &g->face_first, &g->face, err));
  g->n_volume = !count_cells(g) ? 0 : frame->n_zone ? frame->n_zone : 1;
  number_groups(g);
  VG_TRY(name_volumes(g, err));
  g->first[0] = count_faces(g) + 1;
  for (int k = 1; k < VG_GMSH_KINDS; k++)
    g->first[k] = g->first[k - 1] + g->n_cell[k - 1];
  st = find_places(g, err);
done:
  if (st < 0) vg_gmsh_release(g);
  return st;
}

void vg_gmsh_release(struct vg_gmsh *g)
{
  free(g->word);
  free(g->volume_word);
  free(g->face_first);
  free(g->face);
  g->word = g->volume_word = NULL;
  g->face_first = g->face = NULL;
}

void vg_gmsh_seek_tags(struct vg_output *out, const struct vg_gmsh *g,
                       uint64_t point)
{
  vg_output_seek(out, g->at_tag + 8 * point);
}

void vg_gmsh_seek_points(struct vg_output *out, const struct vg_gmsh *g,
                         uint64_t point)
{
  vg_output_seek(out, g->at_point + 24 * point);
}

void vg_gmsh_seek_cell(struct vg_output *out, const struct vg_gmsh *g, int kind,
                       uint64_t cell)
{
  uint64_t before = 0, n_head = 0;

  assert(kind >= 0 && kind < VG_GMSH_KINDS);
  for (size_t v = 0; v < g->n_volume && before <= cell; v++) {
    n_head += cells_in(g, kind, v) > 0;
    before += cells_in(g, kind, v);
  }
  vg_output_seek(out,
                 g->at[kind] + n_head * HEAD_SIZE + cell * cell_size(kind));
}

vg_status vg_gmsh_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_mesh view;
  struct vg_gmsh g = { .frame = NULL };
  vg_status st = vg_mesh_sheet_view(m, &view, err);

  if (st < 0) return st;
  VG_TRY(vg_gmsh_plan(path, &view, &g, err));
  VG_TRY(vg_output_open(path, &out, err));
  vg_gmsh_put(&out, &g);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  vg_gmsh_release(&g);
  vg_mesh_sheet_view_release(&view, m);
  return st;
}
