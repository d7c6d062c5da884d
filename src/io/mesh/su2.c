/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/su2.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/zone_meshes.h"
#include "io/mesh/su2_put.h"

#define REAL_WIDTH 25 /* vg_format_real writes at most 24 characters */
#define LINE 256

/* Our node order to VTK's, as in a .vtu (io/mesh/vtu.c). */
static const struct kind {
  int n_node;
  const char *name;
  int order[8];
} kinds[VG_SU2_KINDS] = {
  { 4, "10", { 0, 1, 2, 3 } },
  { 5, "14", { 1, 0, 3, 4, 2 } },
  { 6, "13", { 1, 0, 2, 4, 3, 5 } },
  { 8, "12", { 0, 1, 2, 3, 4, 5, 6, 7 } },
};

static int digits(uint64_t n)
{
  int width = 1;

  while (n >= 10) {
    n /= 10;
    width++;
  }
  return width;
}

/* Write a blank and v, right-justified in `width` columns, at *to. */
static void column(char **to, int width, uint64_t v)
{
  char *at = *to + width;

  *to = at + 1;
  do {
    *at-- = (char)('0' + v % 10);
    v /= 10;
  } while (v);
  while (at >= *to - width - 1) *at-- = ' ';
}

static uint64_t cell_line(const struct vg_su2 *s, int kind)
{
  return 2 + (uint64_t)kinds[kind].n_node * (uint64_t)(1 + s->node_width) +
         (uint64_t)(1 + s->cell_width) + 1;
}

static uint64_t point_line(const struct vg_su2 *s)
{
  return 3 * REAL_WIDTH + (uint64_t)(1 + s->node_width) + 1;
}

static uint64_t count_of(const struct vg_su2 *s)
{
  return s->n_cell[0] + s->n_cell[1] + s->n_cell[2] + s->n_cell[3];
}

static void put_head(struct vg_output *out, const struct vg_su2 *s)
{
  vg_output_format(out, "NDIME= 3\nNELEM= %llu\n",
                   (unsigned long long)count_of(s));
}

static void put_points_head(struct vg_output *out, const struct vg_su2 *s)
{
  vg_output_format(out, "NPOIN= %zu\n", s->frame->n_point);
}

/* Determine the offsets of cells and points by writing the text before them
 * without a file. */
static vg_status find_places(struct vg_su2 *s, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(NULL, &out, err);

  if (st < 0) return st;
  put_head(&out, s);
  for (int k = 0; k < VG_SU2_KINDS; k++) {
    s->at[k] = out.written;
    vg_output_skip(&out, s->n_cell[k] * cell_line(s, k));
  }
  put_points_head(&out, s);
  s->at_point = out.written;
  vg_output_release(&out);
  return VG_OK;
}

/* Sort the faces by patch: triangles, then quadrilaterals, each in their order
 * in the mesh. */
static vg_status sort_faces(struct vg_su2 *s, struct vg_error *err)
{
  const struct vg_mesh *m = s->frame;
  size_t *first = vg_calloc(m->n_patch + 2, sizeof *first);

  s->face_first = first;
  s->face = vg_alloc(m->n_tri + m->n_quad, sizeof *s->face);
  if (!first || !s->face) return vg_fail_memory(err, "the markers");
  for (size_t i = 0; i < m->n_tri; i++) first[m->tri_patch[i] + 2]++;
  for (size_t i = 0; i < m->n_quad; i++) first[m->quad_patch[i] + 2]++;
  for (size_t p = 0; p < m->n_patch; p++) first[p + 2] += first[p + 1];
  /* Filling moves first[p + 1] to the end of p, which is the start of p + 1. */
  for (size_t i = 0; i < m->n_tri; i++)
    s->face[first[m->tri_patch[i] + 1]++] = i;
  for (size_t i = 0; i < m->n_quad; i++)
    s->face[first[m->quad_patch[i] + 1]++] = m->n_tri + i;
  return VG_OK;
}

vg_status vg_su2_plan(const char *path, const struct vg_mesh *frame,
                      struct vg_su2 *s, struct vg_error *err)
{
  vg_status st;

  *s = (struct vg_su2){ .frame = frame,
                        .n_cell = { frame->n_tet, frame->n_pyr, frame->n_pri,
                                    frame->n_hex } };
  for (int k = 1; k < VG_SU2_KINDS; k++)
    s->first[k] = s->first[k - 1] + s->n_cell[k - 1];
  if (!count_of(s))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the mesh has no cells, which a three-dimensional "
                   "SU2 file must have; write the surface as .stl or "
                   ".lb8.ugrid",
                   path);
  s->node_width = digits(frame->n_point - 1);
  s->cell_width = digits(count_of(s) - 1);
  s->word = vg_patch_words(frame, VG_PATCH_WORD_MOST);
  if (!s->word) return vg_fail_memory(err, "the names of the markers");
  VG_TRY(sort_faces(s, err));
  st = find_places(s, err);
done:
  if (st < 0) vg_su2_release(s);
  return st;
}

void vg_su2_release(struct vg_su2 *s)
{
  free(s->word);
  free(s->face_first);
  free(s->face);
  s->word = NULL;
  s->face_first = s->face = NULL;
}

void vg_su2_seek_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                      uint64_t cell)
{
  assert(kind >= 0 && kind < VG_SU2_KINDS);
  vg_output_seek(out, s->at[kind] + cell * cell_line(s, kind));
}

void vg_su2_seek_point(struct vg_output *out, const struct vg_su2 *s,
                       uint64_t point)
{
  vg_output_seek(out, s->at_point + point * point_line(s));
}

void vg_su2_put_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                     uint64_t cell, const uint32_t *node,
                     const uint32_t *number)
{
  char line[LINE], *to = line + 2;

  memcpy(line, kinds[kind].name, 2);
  for (int i = 0; i < kinds[kind].n_node; i++) {
    uint32_t v = node[kinds[kind].order[i]];

    column(&to, s->node_width, number ? number[v] : v);
  }
  column(&to, s->cell_width, s->first[kind] + cell);
  *to++ = '\n';
  vg_output_bytes(out, line, (size_t)(to - line));
}

void vg_su2_put_point(struct vg_output *out, const struct vg_su2 *s,
                      uint64_t point, const double x[3])
{
  char line[LINE], text[32], *to = line;

  memset(line, ' ', 3 * REAL_WIDTH);
  for (int k = 0; k < 3; k++) {
    size_t n = vg_format_real(x[k], text);

    to += REAL_WIDTH;
    memcpy(to - n, text, n);
  }
  column(&to, s->node_width, point);
  *to++ = '\n';
  vg_output_bytes(out, line, (size_t)(to - line));
}

static void put_face(struct vg_output *out, const struct vg_mesh *m, size_t i)
{
  int is_tri = i < m->n_tri;
  const uint32_t *node = is_tri ? m->tri[i] : m->quad[i - m->n_tri];
  char line[LINE], *to = line + 1;

  line[0] = is_tri ? '5' : '9';
  for (int k = 0; k < (is_tri ? 3 : 4); k++)
    column(&to, digits(node[k]), node[k]);
  *to++ = '\n';
  vg_output_bytes(out, line, (size_t)(to - line));
}

/* Patches without faces are not written as markers. */
static void put_markers(struct vg_output *out, const struct vg_su2 *s)
{
  size_t n = 0, n_patch = s->frame->n_patch;

  for (size_t p = 0; p < n_patch; p++)
    n += s->face_first[p + 1] > s->face_first[p];
  vg_output_format(out, "NMARK= %zu\n", n);
  for (size_t p = 0; p < n_patch; p++) {
    size_t first = s->face_first[p], end = s->face_first[p + 1];

    if (first == end) continue;
    vg_output_format(out, "MARKER_TAG= %s\nMARKER_ELEMS= %zu\n", s->word[p],
                     end - first);
    for (size_t i = first; i < end; i++) put_face(out, s->frame, s->face[i]);
  }
}

void vg_su2_put(struct vg_output *out, const struct vg_su2 *s)
{
  const struct vg_mesh *m = s->frame;

  put_head(out, s);
  for (int k = 0; k < VG_SU2_KINDS; k++)
    if (!m->point) vg_output_skip(out, s->n_cell[k] * cell_line(s, k));
    else
      for (uint64_t i = 0; i < s->n_cell[k]; i++)
        vg_su2_put_cell(out, s, k, i,
                        vg_mesh_nodes(m, k) + i * (uint64_t)kinds[k].n_node,
                        NULL);
  put_points_head(out, s);
  if (!m->point) vg_output_skip(out, m->n_point * point_line(s));
  else
    for (size_t i = 0; i < m->n_point; i++)
      vg_su2_put_point(out, s, i, m->point[i]);
  put_markers(out, s);
}

vg_status vg_su2_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_su2 s;
  vg_status st = vg_su2_plan(path, m, &s, err);

  if (st < 0) return st;
  VG_TRY(vg_output_open(path, &out, err));
  vg_su2_put(&out, &s);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  vg_su2_release(&s);
  return st;
}

/* --- a block for each zone ------------------------------------------------ */

static void put_words(struct vg_output *out, const char *key, size_t n,
                      const char (*word)[VG_PATCH_WORD], const char *end)
{
  if (!n) return;
  vg_output_format(out, "%% %s= ( ", key);
  for (size_t i = 0; i < n; i++)
    vg_output_format(out, "%s%s%s", i ? ", " : "", word[i], end);
  vg_output_text(out, " )\n");
}

/* Pairs of markers: the two sides of doubled interfaces, which follow each
 * other among the patches, and then those of other interfaces. */
static vg_status put_pairs(struct vg_output *out, const struct vg_zone_parts *p,
                           const char (*word)[VG_PATCH_WORD],
                           struct vg_error *err)
{
  char(*pair)[VG_PATCH_WORD] = vg_alloc(p->n_patch, sizeof *pair);
  size_t n = 0;

  if (!pair) return vg_fail_memory(err, "the names of the markers");
  for (size_t i = 0; i < p->n_patch; i++)
    if (i >= p->m->n_patch || vg_patch_is_sliding(&p->m->patch[i]))
      memcpy(pair[n++], word[i], VG_PATCH_WORD);
  put_words(out, "MARKER_ZONE_INTERFACE", n, (const char(*)[VG_PATCH_WORD])pair,
            "");
  free(pair);
  return VG_OK;
}

/* The lines that SU2's configuration needs, as comments. */
static vg_status put_zones_head(struct vg_output *out,
                                const struct vg_zone_parts *p,
                                struct vg_error *err)
{
  const struct vg_mesh patches = { .n_patch = p->n_patch, .patch = p->patch };
  char(*word)[VG_PATCH_WORD] = vg_patch_words(&patches, VG_PATCH_WORD_MOST);
  char(*zone)[VG_PATCH_WORD] = vg_zone_words(p->m, VG_PATCH_WORD_MOST);
  vg_status st = word && zone ? VG_OK
                              : vg_fail_memory(err, "the names of the markers");

  VG_TRY(st);
  vg_output_text(out, "% Zones of a mesh, by Vanguard. Lines for the "
                      "configuration of SU2:\n% MULTIZONE_MESH= YES\n");
  put_words(out, "CONFIG_LIST", p->m->n_zone,
            (const char(*)[VG_PATCH_WORD])zone, ".cfg");
  VG_TRY(put_pairs(out, p, (const char(*)[VG_PATCH_WORD])word, err));
  vg_output_format(out, "NZONE= %zu\n", p->m->n_zone);
done:
  free(word);
  free(zone);
  return st;
}

static vg_status put_zone(struct vg_output *out, const char *path,
                          struct vg_zone_parts *p, size_t z,
                          struct vg_error *err)
{
  struct vg_mesh part = VG_MESH_INIT;
  struct vg_su2 s;
  vg_status st;

  VG_TRY(vg_zone_part(p, z, &part, err));
  VG_TRY(vg_su2_plan(path, &part, &s, err));
  vg_output_format(out, "IZONE= %zu\n", z + 1);
  vg_su2_put(out, &s);
  vg_su2_release(&s);
done:
  vg_mesh_release(&part);
  return st;
}

vg_status vg_su2_write_zones(const char *path, const struct vg_mesh *m,
                             struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_zone_parts p = VG_ZONE_PARTS_INIT;
  vg_status st;

  if (!m->n_zone)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the mesh has no zones, of which this format has one "
                   "mesh each; write su2",
                   path);
  VG_TRY(vg_zone_parts_new(m, &p, err));
  VG_TRY(vg_output_open(path, &out, err));
  VG_TRY(put_zones_head(&out, &p, err));
  for (size_t z = 0; z < m->n_zone; z++)
    VG_TRY(put_zone(&out, path, &p, z, err));
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  vg_zone_parts_release(&p);
  return st;
}
