/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* .front: VGRID's surface mesh and restart file (formats.md 1.9). Points, faces
 * and curve edges are read; everything else is skipped. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/vgrid/vgrid.h"

/* Positions of the values of line 2. */
enum {
  NPOIT,
  NELET,
  NPOIF,
  NFACE,
  NBOUN,
  NFACS,
  NBOUC,
  NFACI,
  NPOIV,
  NELEV,
  NBOU0,
  N_HEADER
};

static vg_status front_header(struct vg_input *in, int64_t head[N_HEADER],
                              struct vg_error *err)
{
  const char *text;
  size_t len;
  int n = 0;

  memset(head, 0, N_HEADER * sizeof *head);
  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: contains binary data; a .front is text", in->path);
  vg_input_line(in, &text, &len);
  while (n < N_HEADER && vg_input_token_in_line(in, &text, &len) &&
         vg_parse_int(text, len, head + n))
    n++;
  if (n < NBOU0)
    return vg_input_fail(in, err,
                         "expected ten or eleven counts (npoit nelet npoif "
                         "nface ...)");
  vg_input_line(in, &text, &len);
  for (int k = 0; k < n; k++)
    if (head[k] < 0 || head[k] > INT32_MAX)
      return vg_input_fail(in, err, "count %d of line 2 is %lld", k + 1,
                           (long long)head[k]);
  if (head[NELET] || head[NELEV] || head[NFACE] != head[NFACS])
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: this is the front of a volume run (%lld cells "
                   "generated, %lld of %lld faces left), not a surface; run "
                   "VGRID with rstrt = -1, or use another file for the "
                   "surface",
                   in->path, (long long)head[NELET], (long long)head[NFACE],
                   (long long)head[NFACS]);
  if (!head[NFACE] || !head[NPOIT])
    return vg_fail(err, VG_ERR_FORMAT, "%s: the front has no faces", in->path);
  /* A face takes at least eight bytes, and so does a point. */
  if ((uint64_t)(head[NFACE] + head[NPOIT]) > vg_input_left(in) / 8 + 1)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: truncated: the header announces %lld faces and %lld "
                   "points",
                   in->path, (long long)head[NFACE], (long long)head[NPOIT]);
  return VG_OK;
}

static vg_status read_index(struct vg_input *in, size_t n_point, uint32_t *v,
                            const char *what, struct vg_error *err)
{
  int64_t wide;
  vg_status st = vg_input_int(in, &wide, what, err);

  if (st < 0) return st;
  if (wide < 1 || (uint64_t)wide > n_point) {
    vg_input_fail(in, err, "%s is %lld; points are numbered 1 to %zu", what,
                  (long long)wide, n_point);
    if (err) err->code = VG_ERR_INPUT;
    return VG_ERR_INPUT;
  }
  *v = (uint32_t)(wide - 1);
  return VG_OK;
}

static vg_status read_surface(struct vg_input *in, struct vg_mesh *m,
                              struct vg_error *err)
{
  int64_t number;
  vg_status st = VG_OK;

  for (size_t f = 0; f < m->n_tri && st == VG_OK; f++) {
    st = vg_input_int(in, &number, "face number", err);
    for (int k = 0; k < 3 && st == VG_OK; k++)
      st = read_index(in, m->n_point, &m->tri[f][k], "node of a face", err);
  }
  for (size_t i = 0; i < m->n_point && st == VG_OK; i++) {
    st = vg_input_int(in, &number, "point number", err);
    if (st == VG_OK && number != (int64_t)i + 1)
      return vg_input_fail(in, err, "expected point %zu, not %lld", i + 1,
                           (long long)number);
    for (int k = 0; k < 3 && st == VG_OK; k++)
      st = vg_input_real(in, &m->point[i][k], "coordinate", err);
  }
  return st;
}

static vg_status skip_lines(struct vg_input *in, size_t n, const char *what,
                            struct vg_error *err)
{
  const char *text;
  size_t len;

  for (size_t i = 0; i < n; i++)
    if (!vg_input_line(in, &text, &len))
      return vg_input_fail(in, err, "truncated: %s are missing", what);
  return VG_OK;
}

/* Skip pairs of numbers (tokens), then lines of flags and of two arrays. */
static vg_status skip_to_edges(struct vg_input *in, const struct vg_mesh *m,
                               struct vg_error *err)
{
  size_t lines = (m->n_tri + 24) / 25 + 2 * ((m->n_point + 19) / 20);
  vg_status st = skip_lines(in, 1 + m->n_point, "point numbers", err);

  return st < 0 ? st : skip_lines(in, lines, "flags and layer lines", err);
}

static vg_status read_edges(struct vg_input *in, const struct vg_mesh *m,
                            size_t *n_edge, uint32_t (**edge)[2],
                            struct vg_error *err)
{
  uint32_t(*list)[2];
  int64_t n;
  vg_status st = vg_input_int(in, &n, "number of curve edges", err);

  if (st < 0) return st;
  if (n < 1 || (uint64_t)n > vg_input_left(in) / 4 + 1)
    return vg_input_fail(in, err,
                         "the number of curve edges is %lld: not positive, "
                         "or more than the file can hold",
                         (long long)n);
  list = vg_alloc((size_t)n, sizeof *list);
  if (!list) return vg_fail_memory(err, "the curve edges");
  for (int side = 0; side < 2 && st == VG_OK; side++)
    for (int64_t i = 0; i < n && st == VG_OK; i++)
      st = read_index(in, m->n_point, &list[i][side], "end of a curve edge",
                      err);
  if (st < 0) {
    free(list);
    return st;
  }
  *edge = list;
  *n_edge = (size_t)n;
  return VG_OK;
}

vg_status vg_front_parse(struct vg_input *in, const struct vg_project *project,
                         struct vg_mesh *out, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  uint32_t(*edge)[2] = NULL;
  int64_t head[N_HEADER];
  size_t n_edge = 0;
  vg_status st;

  assert(in && out);
  VG_TRY(front_header(in, head, err));
  m.n_tri = (size_t)head[NFACE];
  m.n_point = (size_t)head[NPOIT];
  m.tri = vg_alloc(m.n_tri, sizeof *m.tri);
  m.tri_patch = vg_alloc(m.n_tri, sizeof *m.tri_patch);
  m.point = vg_alloc(m.n_point, sizeof *m.point);
  if (!m.tri || !m.tri_patch || !m.point) {
    st = vg_fail_memory(err, "a front");
    goto done;
  }
  VG_TRY(read_surface(in, &m, err));
  VG_TRY(vg_check_points(in->path, m.n_point, m.point, err));
  VG_TRY(skip_to_edges(in, &m, err));
  VG_TRY(read_edges(in, &m, &n_edge, &edge, err));
  VG_TRY(vg_front_patches(&m, n_edge, edge, project, in->path, err));
  vg_mesh_move(out, &m);
done:
  free(edge);
  vg_mesh_release(&m);
  return st;
}

vg_status vg_front_read(const char *path, const struct vg_project *project,
                        struct vg_mesh *out, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = vg_front_parse(&in, project, out, err);
  vg_input_release(&in);
  return st;
}
