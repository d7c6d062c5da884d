/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Readers for meshes of other programs. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "io/stream/convention.h"
#include "io/stream/stream.h"
#include "peers.h"

#define NAME_MAX_LEN 4096

static vg_status open_part(const char *stem, const char *suffix,
                           struct vg_input *in, int64_t *n,
                           struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  const char *rest;
  size_t len;
  vg_status st;

  snprintf(name, sizeof name, "%s%s", stem, suffix);
  st = vg_input_open(name, in, err);
  if (st < 0) return st;
  in->comment = '#';
  st = vg_input_int(in, n, "count", err);
  if (st < 0) return st;
  if (*n < 0 || *n > UINT32_MAX / 4)
    return vg_input_fail(in, err, "count %lld", (long long)*n);
  vg_input_line(in, &rest, &len);
  return VG_OK;
}

static vg_status read_nodes(const char *stem, struct vg_mesh *m, int64_t *first,
                            struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  const char *rest;
  size_t len;
  int64_t n, id;
  vg_status st;

  VG_TRY(open_part(stem, ".node", &in, &n, err));
  m->point = vg_alloc((size_t)n, sizeof *m->point);
  if (!m->point) {
    st = vg_fail_memory(err, "points");
    goto done;
  }
  m->n_point = (size_t)n;
  for (size_t i = 0; i < m->n_point; i++) {
    VG_TRY(vg_input_int(&in, &id, "number of a point", err));
    if (!i) *first = id;
    for (int k = 0; k < 3; k++)
      VG_TRY(vg_input_real(&in, &m->point[i][k], "coordinate", err));
    vg_input_line(&in, &rest, &len);
  }
done:
  vg_input_release(&in);
  return st;
}

/* The orientation of TetGen's cells differs between versions; use the sign of
 * the volume. */
static void make_positive(struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_tet; i++) {
    uint32_t *t = m->tet[i], swap = t[0];

    if (vg_orient3d(m->point[t[0]], m->point[t[1]], m->point[t[2]],
                    m->point[t[3]]) >= 0)
      continue;
    t[0] = t[1];
    t[1] = swap;
  }
}

static vg_status read_elements(const char *stem, int64_t first,
                               struct vg_mesh *m, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  const char *rest;
  size_t len;
  int64_t n, node;
  vg_status st;

  VG_TRY(open_part(stem, ".ele", &in, &n, err));
  m->tet = vg_alloc((size_t)n, sizeof *m->tet);
  if (!m->tet) {
    st = vg_fail_memory(err, "tetrahedra");
    goto done;
  }
  m->n_tet = (size_t)n;
  for (size_t i = 0; i < m->n_tet; i++) {
    VG_TRY(vg_input_int(&in, &node, "number of a cell", err));
    for (int k = 0; k < 4; k++) {
      VG_TRY(vg_input_int(&in, &node, "node", err));
      node -= first;
      if (node < 0 || (size_t)node >= m->n_point) {
        st = vg_input_fail(&in, err, "no such node");
        goto done;
      }
      m->tet[i][k] = (uint32_t)node;
    }
    vg_input_line(&in, &rest, &len);
  }
done:
  vg_input_release(&in);
  return st;
}

vg_status peer_read_tetgen(const char *stem, const struct vg_mesh *surface,
                           struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT, s = VG_MESH_INIT;
  int64_t first = 1;
  vg_status st = VG_OK;

  VG_TRY(vg_mesh_copy(&s, surface, err));
  VG_TRY(read_nodes(stem, &m, &first, err));
  VG_TRY(read_elements(stem, first, &m, err));
  make_positive(&m);
  m.n_tri = s.n_tri;
  m.n_patch = s.n_patch;
  m.tri = s.tri;
  m.tri_patch = s.tri_patch;
  m.patch = s.patch;
  s.tri = NULL;
  s.tri_patch = NULL;
  s.patch = NULL;
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  vg_mesh_release(&s);
  return st;
}

/* Skip to the line after a line that is exactly `word`. */
static vg_status seek(struct vg_input *in, const char *word,
                      struct vg_error *err)
{
  const char *text;
  size_t len, n = strlen(word);

  while (vg_input_line(in, &text, &len))
    if (len == n && !memcmp(text, word, n)) return VG_OK;
  return vg_input_fail(in, err, "no %s", word);
}

static vg_status count_line(struct vg_input *in, int64_t *n,
                            struct vg_error *err)
{
  const char *text;
  size_t len;

  if (!vg_input_line(in, &text, &len) || !vg_parse_int(text, len, n) ||
      *n < 0 || *n > UINT32_MAX / 4)
    return vg_input_fail(in, err, "a count was expected");
  return VG_OK;
}

static vg_status msh_nodes(struct vg_input *in, struct vg_mesh *m,
                           uint32_t **index, size_t *n_index,
                           struct vg_error *err)
{
  int64_t n;
  int32_t id;
  vg_status st = VG_OK;

  VG_TRY(seek(in, "$Nodes", err));
  VG_TRY(count_line(in, &n, err));
  VG_TRY(vg_input_need(in, (uint64_t)n, 28, "nodes", err));
  *n_index = 4 * (size_t)n + 1;
  m->point = vg_alloc((size_t)n, sizeof *m->point);
  *index = vg_calloc(*n_index, sizeof **index);
  if (!m->point || !*index) return vg_fail_memory(err, "points");
  m->n_point = (size_t)n;
  for (size_t i = 0; i < m->n_point; i++) {
    VG_TRY(vg_input_i32(in, 1, &id, "number of a node", err));
    if (id < 1 || (size_t)id >= *n_index)
      return vg_input_fail(in, err, "node number %d", id);
    (*index)[id] = (uint32_t)i + 1;
    VG_TRY(vg_input_f64(in, 3, m->point[i], "coordinates", err));
  }
done:
  return st;
}

static vg_status msh_element(struct vg_input *in, struct vg_mesh *m,
                             int32_t type, int32_t n_tag, const uint32_t *index,
                             size_t n_index, int32_t *tag, struct vg_error *err)
{
  static const int n_node[16] = { 0, 2, 3, 4,  4,  8,  6,  5,
                                  3, 6, 9, 10, 27, 18, 14, 1 };
  int32_t v[64];
  uint32_t *to = NULL;
  int n = n_node[type & 15];
  vg_status st = vg_input_i32(in, (size_t)(1 + n_tag + n), v, "element", err);

  if (st < 0) return st;
  if (type == 2) {
    tag[m->n_tri] = n_tag > 1 ? v[2] : 0;
    to = m->tri[m->n_tri++];
  }
  if (type == 4) to = m->tet[m->n_tet++];
  for (int k = 0; to && k < n; k++) {
    int32_t id = v[1 + n_tag + k];

    if (id < 1 || (size_t)id >= n_index || !index[id])
      return vg_input_fail(in, err, "no node %d", id);
    to[k] = index[id] - 1;
  }
  return VG_OK;
}

static vg_status msh_elements(struct vg_input *in, struct vg_mesh *m,
                              const uint32_t *index, size_t n_index,
                              int32_t **tag, struct vg_error *err)
{
  int64_t n;
  int32_t head[3];
  vg_status st = VG_OK;

  VG_TRY(seek(in, "$Elements", err));
  VG_TRY(count_line(in, &n, err));
  m->tri = vg_alloc((size_t)n, sizeof *m->tri);
  m->tet = vg_alloc((size_t)n, sizeof *m->tet);
  *tag = vg_alloc((size_t)n, sizeof **tag);
  if (!m->tri || !m->tet || !*tag) return vg_fail_memory(err, "elements");
  for (int64_t i = 0; i < n;) {
    VG_TRY(vg_input_i32(in, 3, head, "element header", err));
    if (head[0] < 1 || head[0] > 15 || head[1] < 1 || head[1] > n - i ||
        head[2] < 0 || head[2] > 16)
      return vg_input_fail(in, err, "element header of element %lld",
                           (long long)i);
    for (int32_t j = 0; j < head[1]; j++, i++)
      VG_TRY(msh_element(in, m, head[0], head[2], index, n_index, *tag, err));
  }
done:
  return st;
}

vg_status peer_read_msh(const char *path, struct vg_mesh *out,
                        struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_input in = VG_INPUT_INIT;
  uint32_t *index = NULL;
  int32_t *tag = NULL;
  size_t n_index;
  vg_status st = VG_OK;

  VG_TRY(vg_input_open(path, &in, err));
  vg_input_order(&in, !vg_host_is_little());
  VG_TRY(msh_nodes(&in, &m, &index, &n_index, err));
  VG_TRY(msh_elements(&in, &m, index, n_index, &tag, err));
  VG_TRY(vg_patches_from_tags(&m, tag, err));
  VG_TRY(vg_mesh_turn(&m, NULL, err));
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  vg_input_release(&in);
  free(index);
  free(tag);
  return st;
}
