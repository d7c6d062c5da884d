/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surface files of AFLR3; see io/mesh/aflr.h and formats.md 2.5. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/aflr.h"
#include "io/stream/convention.h"

/* All flags of AFLR3 are well within this range. */
enum { FLAG_LOW = -8, FLAG_HIGH = 15, N_FLAG = FLAG_HIGH - FLAG_LOW + 1 };

/* Value of a patch before any of its points. */
static const double unset = INFINITY;

struct reading {
  struct vg_input *in;
  struct vg_mesh m;
  struct vg_aflr a;
  int n_column;      /* numbers per point: 3 to 5 */
  int32_t *tag;      /* [n_tri + n_quad] */
  signed char *flag; /* [n_tri + n_quad] flags; FLAG_HIGH + 1: none */
};

static const signed char no_flag = FLAG_HIGH + 1;

static vg_status read_header(struct reading *r, struct vg_error *err)
{
  static const char *const name[3] = { "number of triangles",
                                       "number of quadrilaterals",
                                       "number of points" };
  uint64_t count[3];

  for (int k = 0; k < 3; k++) {
    int64_t v;
    vg_status st = vg_input_int(r->in, &v, name[k], err);

    if (st < 0) return st;
    if (v < 0 || v > (int64_t)UINT32_MAX - 2)
      return vg_input_fail(r->in, err,
                           "the %s is %lld; it must be between 0 and "
                           "4294967293",
                           name[k], (long long)v);
    count[k] = (uint64_t)v;
  }
  /* Each number takes at least two bytes, except that the last may take one. */
  if (8 * count[0] + 10 * count[1] + 6 * count[2] >
      (uint64_t)vg_input_left(r->in) + 1)
    return vg_input_fail(r->in, err,
                         "truncated: %llu triangles, %llu quadrilaterals "
                         "and %llu points do not fit into the remaining %zu "
                         "bytes",
                         (unsigned long long)count[0],
                         (unsigned long long)count[1],
                         (unsigned long long)count[2], vg_input_left(r->in));
  r->m.n_tri = count[0];
  r->m.n_quad = count[1];
  r->m.n_point = r->a.n_point = count[2];
  return VG_OK;
}

static vg_status make_room(struct reading *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  size_t n = m->n_tri + m->n_quad;

  m->point = vg_alloc(m->n_point, sizeof *m->point);
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->quad = vg_alloc(m->n_quad, sizeof *m->quad);
  r->tag = vg_alloc(n, sizeof *r->tag);
  r->flag = vg_alloc(n, 1);
  if (r->n_column > 3)
    r->a.spacing = vg_alloc(m->n_point, sizeof *r->a.spacing);
  if (r->n_column > 4)
    r->a.thickness = vg_alloc(m->n_point, sizeof *r->a.thickness);
  if (m->point && m->tri && m->quad && r->tag && r->flag &&
      (r->n_column < 4 || r->a.spacing) && (r->n_column < 5 || r->a.thickness))
    return VG_OK;
  return vg_fail_memory(err, "the surface of a .surf file");
}

/* Count the numbers of the first point; all points have the same number. */
static vg_status count_columns(struct reading *r, struct vg_error *err)
{
  struct vg_input look = *r->in;
  const char *text;
  size_t len;

  r->n_column = 3;
  if (!r->m.n_point) return VG_OK;
  if (!vg_input_token(&look, &text, &len)) return VG_OK;
  for (r->n_column = 1; r->n_column < 7; r->n_column++)
    if (!vg_input_token_in_line(&look, &text, &len)) break;
  if (r->n_column >= 3 && r->n_column <= 5) return VG_OK;
  return vg_input_fail(&look, err,
                       "the line of a point must have 3 to 5 numbers: x y z "
                       "[spacing [thickness]]");
}

static vg_status read_points(struct reading *r, struct vg_error *err)
{
  static const char *const name[5] = { "coordinate", "coordinate", "coordinate",
                                       "spacing", "thickness" };

  for (size_t i = 0; i < r->m.n_point; i++) {
    double v[5];

    for (int k = 0; k < r->n_column; k++) {
      vg_status st = vg_input_real(r->in, v + k, name[k], err);

      if (st < 0) return st;
    }
    memcpy(r->m.point[i], v, sizeof r->m.point[i]);
    if (r->n_column > 3) r->a.spacing[i] = v[3];
    if (r->n_column > 4) r->a.thickness[i] = v[4];
  }
  return VG_OK;
}

static vg_status face_line(struct reading *r, const char *what, size_t face,
                           struct vg_error *err)
{
  return vg_input_fail(r->in, err,
                       "the line of %s %zu does not hold 'points tag [recon "
                       "[bc]]' as integers",
                       what, face + 1);
}

static vg_status read_face(struct reading *r, const char *what, size_t face,
                           size_t place, int width, uint32_t *node,
                           struct vg_error *err)
{
  int64_t v[7];
  const char *text;
  size_t len;
  int n = 1;
  vg_status st = vg_input_int(r->in, v, what, err);

  if (st < 0) return st;
  while (vg_input_token_in_line(r->in, &text, &len))
    if (n == width + 3 || !vg_parse_int(text, len, v + n++))
      return face_line(r, what, face, err);
  if (n <= width || v[width] < INT32_MIN || v[width] > INT32_MAX)
    return face_line(r, what, face, err);
  for (int k = 0; k < width; k++) {
    if (v[k] < 1 || (uint64_t)v[k] > r->m.n_point) {
      vg_input_fail(r->in, err,
                    "%s %zu refers to point %lld; points are "
                    "numbered 1 to %zu",
                    what, face + 1, (long long)v[k], r->m.n_point);
      if (err) err->code = VG_ERR_INPUT;
      return VG_ERR_INPUT;
    }
    node[k] = (uint32_t)(v[k] - 1);
  }
  r->tag[place] = (int32_t)v[width];
  r->flag[place] = no_flag;
  if (n < width + 3) return VG_OK;
  if (v[width + 2] < FLAG_LOW || v[width + 2] > FLAG_HIGH)
    return vg_input_fail(r->in, err,
                         "%s %zu has the boundary flag %lld; flags are -6 "
                         "to 7",
                         what, face + 1, (long long)v[width + 2]);
  r->flag[place] = (signed char)v[width + 2];
  return VG_OK;
}

/* --- settings of patches, collected from faces and points --- */

static void set_patch(struct vg_aflr_patch *p, struct vg_patch *to,
                      const uint32_t count[N_FLAG])
{
  uint32_t most = 0;

  memset(p, 0, sizeof *p);
  p->id = to->id;
  p->flag = VG_AFLR_NONE;
  for (int k = 0; k < N_FLAG; k++)
    if (count[k] > most) {
      most = count[k];
      p->flag = k + FLAG_LOW;
    }
  if (p->flag == VG_AFLR_NONE) return;
  p->is_viscous = p->flag < 0;
  if (p->is_viscous) {
    to->bc = to->family = 4;
    to->bc_fun3d = 4000;
  } else if (p->flag == 1) {
    to->bc = to->family = 3;
    to->bc_fun3d = 5000;
  }
}

static vg_status set_patches(struct reading *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  uint32_t(*count)[N_FLAG] = vg_calloc(m->n_patch, sizeof *count);

  r->a.n = m->n_patch;
  r->a.patch = vg_calloc(m->n_patch, sizeof *r->a.patch);
  if (!count || !r->a.patch) {
    free(count);
    return vg_fail_memory(err, "the patches of a .surf file");
  }
  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
    uint32_t p = i < m->n_tri ? m->tri_patch[i] : m->quad_patch[i - m->n_tri];

    if (r->flag[i] != no_flag) count[p][r->flag[i] - FLAG_LOW]++;
  }
  for (size_t i = 0; i < m->n_patch; i++)
    set_patch(r->a.patch + i, m->patch + i, count[i]);
  free(count);
  return VG_OK;
}

/* Common value of all points of a patch; -1 if they differ. */
static void meet(double *common, double v)
{
  v = v > 0 ? v : 0;
  if (*common == unset) *common = v;
  else if (*common != v) *common = -1;
}

static void common_values(struct reading *r)
{
  const struct vg_mesh *m = &r->m;
  struct vg_aflr *a = &r->a;

  for (size_t i = 0; i < a->n; i++)
    a->patch[i].spacing = a->patch[i].thickness = unset;
  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
    int is_tri = i < m->n_tri;
    const uint32_t *node = is_tri ? m->tri[i] : m->quad[i - m->n_tri];
    struct vg_aflr_patch *p = a->patch + (is_tri ? m->tri_patch[i]
                                                 : m->quad_patch[i - m->n_tri]);

    for (int k = 0; k < (is_tri ? 3 : 4); k++) {
      if (a->spacing) meet(&p->spacing, a->spacing[node[k]]);
      if (a->thickness) meet(&p->thickness, a->thickness[node[k]]);
    }
  }
  for (size_t i = 0; i < a->n; i++) {
    struct vg_aflr_patch *p = a->patch + i;

    if (p->spacing < 0 || p->spacing == unset) p->spacing = 0;
    if (p->thickness < 0 || p->thickness == unset) p->thickness = 0;
  }
}

static vg_status parse(struct reading *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  vg_status st;

  VG_TRY(read_header(r, err));
  VG_TRY(count_columns(r, err));
  VG_TRY(make_room(r, err));
  VG_TRY(read_points(r, err));
  for (size_t i = 0; i < m->n_tri; i++)
    VG_TRY(read_face(r, "triangle", i, i, 3, m->tri[i], err));
  for (size_t i = 0; i < m->n_quad; i++)
    VG_TRY(read_face(r, "quadrilateral", i, m->n_tri + i, 4, m->quad[i], err));
  VG_TRY(vg_check_points(r->in->path, m->n_point, (const double(*)[3])m->point,
                         err));
  VG_TRY(vg_patches_from_tags(m, r->tag, err));
  VG_TRY(set_patches(r, err));
  common_values(r);
done:
  return st;
}

vg_status vg_aflr_surf_parse(struct vg_input *in, struct vg_mesh *out,
                             struct vg_aflr *a, struct vg_error *err)
{
  struct reading r = { .in = in, .m = VG_MESH_INIT, .a = VG_AFLR_INIT };
  vg_status st;

  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: contains binary data; only text .surf files are read",
                   in->path);
  st = parse(&r, err);
  if (st == VG_OK) {
    const struct vg_aflr empty = VG_AFLR_INIT;

    vg_mesh_move(out, &r.m);
    if (a) {
      vg_aflr_release(a);
      *a = r.a;
      r.a = empty;
    }
  }
  vg_mesh_release(&r.m);
  vg_aflr_release(&r.a);
  free(r.tag);
  free(r.flag);
  return st;
}

vg_status vg_aflr_surf_read(const char *path, struct vg_mesh *m,
                            struct vg_aflr *a, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = vg_aflr_surf_parse(&in, m, a, err);
  vg_input_release(&in);
  return st;
}
