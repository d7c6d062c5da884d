/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* SU2 in two dimensions: elements with VTK's types and 0-based points. */
#include <stdlib.h>

#include "io/plane/plane.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { LINE = 3, TRIANGLE = 5, QUADRILATERAL = 9 };

static void put_element(struct vg_output *out, int type, int n,
                        const uint32_t *node)
{
  vg_output_int(out, type);
  for (int k = 0; k < n; k++) {
    vg_output_text(out, " ");
    vg_output_int(out, node[k]);
  }
}

static void put_cells(struct vg_output *out, const struct vg_plane_mesh *m)
{
  vg_output_format(out, "NDIME= 2\nNELEM= %zu\n", m->n_quad + m->n_tri);
  for (size_t i = 0; i < m->n_quad + m->n_tri; i++) {
    if (i < m->n_quad) put_element(out, QUADRILATERAL, 4, m->quad[i]);
    else put_element(out, TRIANGLE, 3, m->tri[i - m->n_quad]);
    vg_output_format(out, " %zu\n", i);
  }
}

static void put_points(struct vg_output *out, const struct vg_plane_mesh *m)
{
  vg_output_format(out, "NPOIN= %zu\n", m->n_point);
  for (size_t i = 0; i < m->n_point; i++) {
    vg_output_real(out, m->x[i][0]);
    vg_output_text(out, " ");
    vg_output_real(out, m->x[i][1]);
    vg_output_format(out, " %zu\n", i);
  }
}

/* The edges are sorted by patch. */
static void put_markers(struct vg_output *out, const struct vg_plane_mesh *m,
                        const char (*word)[VG_PATCH_WORD])
{
  size_t n_mark = 0, end;

  for (size_t i = 0; i < m->n_edge; i++)
    n_mark += !i || m->edge_patch[i] != m->edge_patch[i - 1];
  vg_output_format(out, "NMARK= %zu\n", n_mark);
  for (size_t i = 0; i < m->n_edge; i = end) {
    const uint32_t patch = m->edge_patch[i];

    for (end = i; end < m->n_edge && m->edge_patch[end] == patch;) end++;
    vg_output_format(out, "MARKER_TAG= %s\nMARKER_ELEMS= %zu\n", word[patch],
                     end - i);
    for (size_t k = i; k < end; k++) {
      put_element(out, LINE, 2, m->edge[k]);
      vg_output_text(out, "\n");
    }
  }
}

vg_status vg_su2_plane_write(const char *path, const struct vg_plane_mesh *m,
                             struct vg_error *err)
{
  const struct vg_mesh patches = { .n_patch = m->n_patch, .patch = m->patch };
  struct vg_output out = VG_OUTPUT_INIT;
  char(*word)[VG_PATCH_WORD] = vg_patch_words(&patches, VG_PATCH_WORD_MOST);
  vg_status st;

  if (!word) return vg_fail_memory(err, "the names of the markers");
  VG_TRY(vg_output_open(path, &out, err));
  put_cells(&out, m);
  put_points(&out, m);
  put_markers(&out, m, (const char(*)[VG_PATCH_WORD])word);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(word);
  return st;
}
