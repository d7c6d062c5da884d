/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* .bc: boundary triangles of a VGRID mesh, text (formats.md 1.3). */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "io/vgrid/vgrid.h"

static vg_status bc_header(struct vg_input *in, int64_t head[4],
                           struct vg_error *err)
{
  const char *text;
  size_t len;

  for (int k = 0; k < 4; k++)
    if (!vg_input_token_in_line(in, &text, &len) ||
        !vg_parse_int(text, len, head + k))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: line 1 must hold four integers (faces, curve "
                     "points, patches, igrid); this is not a VGRID .bc "
                     "(AFLR uses the same suffix for another format)",
                     in->path);
  vg_input_line(in, &text, &len);
  vg_input_line(in, &text, &len); /* a title */
  /* Each face line has five numbers and five separators. */
  if (head[0] < 0 || (uint64_t)head[0] > (vg_input_left(in) + 1) / 10)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: truncated: line 1 announces %lld faces, but the "
                   "file is too short for them",
                   in->path, (long long)head[0]);
  return VG_OK;
}

static vg_status bc_face(struct vg_input *in, size_t face, size_t n_boundary,
                         uint32_t node[3], int32_t *tag, struct vg_error *err)
{
  int64_t v;
  vg_status st = vg_input_int(in, &v, "face number", err);

  if (st == VG_OK) st = vg_input_int(in, &v, "patch number", err);
  if (st < 0) return st;
  if (v < -INT32_MAX || v > INT32_MAX)
    return vg_input_fail(in, err,
                         "patch number %lld of face %zu does not fit "
                         "32 bits",
                         (long long)v, face);
  *tag = (int32_t)v;
  for (int k = 0; k < 3; k++) {
    st = vg_input_int(in, &v, "node of a face", err);
    if (st < 0) return st;
    if (v < 1 || (uint64_t)v > n_boundary) {
      vg_input_fail(in, err,
                    "face %zu refers to point %lld; boundary points "
                    "are 1 to %zu in the .cogsg",
                    face, (long long)v, n_boundary);
      if (err) err->code = VG_ERR_INPUT;
      return VG_ERR_INPUT;
    }
    node[k] = (uint32_t)(v - 1);
  }
  return VG_OK;
}

vg_status vg_bc_parse(struct vg_input *in, size_t n_boundary, struct vg_mesh *m,
                      struct vg_cogsg_info *info, struct vg_error *err)
{
  uint32_t(*tri)[3] = NULL;
  int32_t *tag = NULL;
  int64_t head[4];
  size_t n;
  vg_status st = VG_OK;

  assert(in && m && info);
  VG_TRY(bc_header(in, head, err));
  n = (size_t)head[0];
  tri = vg_alloc(n, sizeof *tri);
  tag = vg_alloc(n, sizeof *tag);
  if (!tri || !tag) {
    st = vg_fail_memory(err, "the faces of a .bc");
    goto done;
  }
  for (size_t f = 0; f < n; f++)
    VG_TRY(bc_face(in, f + 1, n_boundary, tri[f], tag + f, err));
  free(m->tri);
  m->tri = tri;
  m->n_tri = n;
  tri = NULL;
  VG_TRY(vg_patches_from_tags(m, tag, err));
  if (info) {
    info->n_curve_point = head[1] > 0 ? (size_t)head[1] : 0;
    info->igrid = head[3] == 1 || head[3] == 2 ? (int32_t)head[3] : 0;
  }
done:
  free(tri);
  free(tag);
  return st;
}
