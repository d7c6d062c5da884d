/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Gmsh 4.1, text: a curve for each patch and a surface, each with its physical
 * group. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/plane/plane.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { LINE = 1, TRIANGLE = 2, QUADRILATERAL = 3 };

/* Number of the curve and the group of a patch; the surface follows. */
static int tag_of(size_t patch)
{
  return (int)patch + 1;
}

static size_t patch_end(const struct vg_plane_mesh *m, size_t first)
{
  size_t end = first;

  while (end < m->n_edge && m->edge_patch[end] == m->edge_patch[first]) end++;
  return end;
}

static size_t count_patches(const struct vg_plane_mesh *m)
{
  size_t n = 0;

  for (size_t i = 0; i < m->n_edge; i = patch_end(m, i)) n++;
  return n;
}

static void put_names(struct vg_output *out, const struct vg_plane_mesh *m,
                      const char (*word)[VG_PATCH_WORD])
{
  char fluid[VG_PATCH_WORD];

  vg_patch_free_word(word, m->n_patch, "fluid", fluid);
  vg_output_format(out,
                   "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n"
                   "%zu\n",
                   count_patches(m) + 1);
  for (size_t i = 0; i < m->n_edge; i = patch_end(m, i))
    vg_output_format(out, "1 %d \"%s\"\n", tag_of(m->edge_patch[i]),
                     word[m->edge_patch[i]]);
  vg_output_format(out, "2 %d \"%s\"\n$EndPhysicalNames\n", tag_of(m->n_patch),
                   fluid);
}

/* Tag, box of n points, and the group of an entity. */
static void put_entity(struct vg_output *out, const struct vg_plane_mesh *m,
                       int tag, size_t n, const uint32_t *point)
{
  double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };

  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 2; k++) {
      const double x = m->x[point ? point[i] : i][k];

      lo[k] = fmin(lo[k], x);
      hi[k] = fmax(hi[k], x);
    }
  vg_output_int(out, tag);
  for (int k = 0; k < 6; k++) {
    vg_output_text(out, " ");
    vg_output_real(out, k % 3 == 2 ? 0 : k < 3 ? lo[k] : hi[k - 3]);
  }
  vg_output_format(out, " 1 %d", tag);
}

static void put_entities(struct vg_output *out, const struct vg_plane_mesh *m)
{
  vg_output_format(out, "$Entities\n0 %zu 1 0\n", count_patches(m));
  for (size_t i = 0, end; i < m->n_edge; i = end) {
    end = patch_end(m, i);
    put_entity(out, m, tag_of(m->edge_patch[i]), 2 * (end - i), m->edge[i]);
    vg_output_text(out, " 0\n");
  }
  put_entity(out, m, tag_of(m->n_patch), m->n_point, NULL);
  vg_output_format(out, " %zu", count_patches(m));
  for (size_t i = 0; i < m->n_edge; i = patch_end(m, i))
    vg_output_format(out, " %d", tag_of(m->edge_patch[i]));
  vg_output_text(out, "\n$EndEntities\n");
}

static void put_nodes(struct vg_output *out, const struct vg_plane_mesh *m)
{
  vg_output_format(out, "$Nodes\n1 %zu 1 %zu\n2 %d 0 %zu\n", m->n_point,
                   m->n_point, tag_of(m->n_patch), m->n_point);
  for (size_t i = 0; i < m->n_point; i++) vg_output_format(out, "%zu\n", i + 1);
  for (size_t i = 0; i < m->n_point; i++) {
    vg_output_real(out, m->x[i][0]);
    vg_output_text(out, " ");
    vg_output_real(out, m->x[i][1]);
    vg_output_text(out, " 0\n");
  }
  vg_output_text(out, "$EndNodes\n");
}

/* A block of n elements with n_node points each; *tag: the next number. */
static void put_block(struct vg_output *out, int dimension, int entity,
                      int type, size_t n, int n_node, const uint32_t *node,
                      size_t *tag)
{
  if (!n) return;
  vg_output_format(out, "%d %d %d %zu\n", dimension, entity, type, n);
  for (size_t i = 0; i < n; i++) {
    vg_output_format(out, "%zu", (*tag)++);
    for (int k = 0; k < n_node; k++, node++) {
      vg_output_text(out, " ");
      vg_output_int(out, (int64_t)*node + 1);
    }
    vg_output_text(out, "\n");
  }
}

static void put_elements(struct vg_output *out, const struct vg_plane_mesh *m)
{
  const size_t n = m->n_edge + m->n_quad + m->n_tri;
  const int fluid = tag_of(m->n_patch);
  size_t tag = 1;

  vg_output_format(out, "$Elements\n%zu %zu 1 %zu\n",
                   count_patches(m) + (m->n_quad > 0) + (m->n_tri > 0), n, n);
  for (size_t i = 0, end; i < m->n_edge; i = end) {
    end = patch_end(m, i);
    put_block(out, 1, tag_of(m->edge_patch[i]), LINE, end - i, 2, m->edge[i],
              &tag);
  }
  put_block(out, 2, fluid, QUADRILATERAL, m->n_quad, 4,
            (const uint32_t *)m->quad, &tag);
  put_block(out, 2, fluid, TRIANGLE, m->n_tri, 3, (const uint32_t *)m->tri,
            &tag);
  vg_output_text(out, "$EndElements\n");
}

vg_status vg_gmsh_plane_write(const char *path, const struct vg_plane_mesh *m,
                              struct vg_error *err)
{
  const struct vg_mesh patches = { .n_patch = m->n_patch, .patch = m->patch };
  struct vg_output out = VG_OUTPUT_INIT;
  char(*word)[VG_PATCH_WORD] = vg_patch_words(&patches, VG_PATCH_WORD_MOST);
  vg_status st;

  if (!word) return vg_fail_memory(err, "the names of the patches");
  VG_TRY(vg_output_open(path, &out, err));
  put_names(&out, m, (const char(*)[VG_PATCH_WORD])word);
  put_entities(&out, m);
  put_nodes(&out, m);
  put_elements(&out, m);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(word);
  return st;
}
