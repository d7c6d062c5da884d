/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader of .d3m project files (formats.md 1.6). Lines with '#' are titles,
 * blank lines separate, and text after the numbers of a line is ignored. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/convention.h"
#include "io/vgrid/vgrid.h"

/* --- ids of points and curves, which need not be consecutive --- */

struct id_map {
  size_t n;
  struct id {
    int64_t id;
    size_t at;
  } * list; /* sorted by id */
};

static int compare_id(const void *a, const void *b)
{
  const struct id *p = a, *q = b;

  if (p->id != q->id) return p->id < q->id ? -1 : 1;
  return (p->at > q->at) - (p->at < q->at);
}

/* Sort by id. Returns the first id that occurs twice, or -1. */
static int64_t map_sort(struct id_map *m)
{
  qsort(m->list, m->n, sizeof *m->list, compare_id);
  for (size_t i = 1; i < m->n; i++)
    if (m->list[i].id == m->list[i - 1].id) return m->list[i].id;
  return -1;
}

static size_t map_find(const struct id_map *m, int64_t id)
{
  size_t lo = 0, hi = m->n;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (m->list[mid].id < id) lo = mid + 1;
    else hi = mid;
  }
  return lo < m->n && m->list[lo].id == id ? m->list[lo].at : SIZE_MAX;
}

struct reader {
  struct vg_input *in;
  struct vg_project *p;
  struct id_map point, curve;
};

/* --- lines --- */

/* Make *line a view of the next line that is neither a title nor blank. Its
 * tokens can be read from the view, whose messages give its line number. */
static vg_status content_line(struct vg_input *in, struct vg_input *line,
                              const char *what, struct vg_error *err)
{
  const char *text, *token;
  size_t len, token_len;

  for (;;) {
    struct vg_input look = *in;

    if (!vg_input_line(in, &text, &len))
      return vg_input_fail(in, err, "the file ends where %s was expected",
                           what);
    look.is_view = 1;
    look.size = look.at + len;
    *line = look;
    if (vg_input_token_in_line(&look, &token, &token_len) && *token != '#')
      return VG_OK;
  }
}

static vg_status values(struct vg_input *in, size_t n, double *v,
                        const char *what, struct vg_error *err)
{
  struct vg_input line;
  vg_status st = content_line(in, &line, what, err);

  for (size_t i = 0; i < n && st == VG_OK; i++)
    st = vg_input_real(&line, v + i, what, err);
  return st;
}

static vg_status count_value(struct vg_input *in, const char *what,
                             size_t bytes_each, size_t *n, struct vg_error *err)
{
  struct vg_input line;
  int64_t v;
  vg_status st = content_line(in, &line, what, err);

  if (st == VG_OK) st = vg_input_int(&line, &v, what, err);
  if (st < 0) return st;
  if (v < 0 || (uint64_t)v > vg_input_left(in) / bytes_each + 1)
    return vg_input_fail(&line, err,
                         "%s is %lld, but the file is too short for that "
                         "many",
                         what, (long long)v);
  *n = (size_t)v;
  return VG_OK;
}

static vg_status int_value(struct vg_input *in, const char *what, int32_t *out,
                           struct vg_error *err)
{
  struct vg_input line;
  int64_t v;
  vg_status st = content_line(in, &line, what, err);

  if (st == VG_OK) st = vg_input_int(&line, &v, what, err);
  if (st < 0) return st;
  if (v < -INT32_MAX || v > INT32_MAX)
    return vg_input_fail(&line, err, "%s is %lld: too large", what,
                         (long long)v);
  *out = (int32_t)v;
  return VG_OK;
}

static void copy_rest(struct vg_input *line, char *to, size_t size)
{
  const char *text;
  size_t len;

  *to = 0;
  if (!vg_input_line(line, &text, &len)) return;
  while (len && (*text == ' ' || *text == '\t')) {
    text++;
    len--;
  }
  while (len && (unsigned char)text[len - 1] <= 32) len--;
  vg_name_from_file(text, len, to, size);
}

/* --- blocks --- */

static vg_status read_parameters(struct reader *r, struct vg_error *err)
{
  struct vg_project *p = r->p;
  struct vg_input *in = r->in, line;
  double v;
  vg_status st;

  VG_TRY(values(in, 1, &v, "the VGRID version", err));
  VG_TRY(content_line(in, &line, "the project name", err));
  copy_rest(&line, p->name, sizeof p->name);
  VG_TRY(int_value(in, "grid", &p->grid, err));
  VG_TRY(values(in, 1, &p->layer.rate1, "rate1", err));
  VG_TRY(values(in, 1, &p->layer.rate2, "rate2", err));
  VG_TRY(values(in, 1, &p->layer.delta1, "delt1", err));
  VG_TRY(int_value(in, "nlayr", &p->layer.n_max, err));
  VG_TRY(int_value(in, "rstrt", &p->restart, err));
  VG_TRY(values(in, 1, &p->ifact, "ifact", err));
  if (!(p->ifact > 0)) {
    st = vg_input_fail(in, err, "ifact must be positive");
    goto done;
  }
  VG_TRY(values(in, 1, &p->vfact, "vfact", err));
  VG_TRY(int_value(in, "strch", &p->stretch, err));
  /* Minimum number of bytes of a point, a curve, a patch and a source. */
  VG_TRY(count_value(in, "npoli", 8, &p->n_point, err));
  VG_TRY(count_value(in, "nline", 8, &p->n_curve, err));
  VG_TRY(count_value(in, "nptch", 12, &p->n_shape, err));
  VG_TRY(count_value(in, "ms", 40, &p->n_source, err));
  VG_TRY(int_value(in, "ni", &p->n_background, err));
  VG_TRY(values(in, 1, &v, "mboun", err));
  VG_TRY(values(in, 1, &v, "mpoin", err));
done:
  return st;
}

static vg_status make_room(struct reader *r, struct vg_error *err)
{
  struct vg_project *p = r->p;

  p->point = vg_calloc(p->n_point, sizeof *p->point);
  p->curve = vg_calloc(p->n_curve, sizeof *p->curve);
  p->shape = vg_calloc(p->n_shape, sizeof *p->shape);
  p->source = vg_calloc(p->n_source, sizeof *p->source);
  r->point.list = vg_alloc(p->n_point, sizeof *r->point.list);
  r->curve.list = vg_alloc(p->n_curve, sizeof *r->curve.list);
  if (p->point && p->curve && p->shape && p->source && r->point.list &&
      r->curve.list)
    return VG_OK;
  /* On failure, release must not visit arrays that were not allocated. */
  if (!p->curve) p->n_curve = 0;
  if (!p->shape) p->n_shape = 0;
  return vg_fail_memory(err, "a project");
}

static vg_status map_done(const struct reader *r, struct id_map *m,
                          const char *what, struct vg_error *err)
{
  int64_t twice = map_sort(m);

  if (twice < 0) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "%s: %s number %lld occurs twice",
                 r->in->path, what, (long long)twice);
}

static vg_status read_points(struct reader *r, struct vg_error *err)
{
  struct vg_project *p = r->p;

  for (size_t i = 0; i < p->n_point; i++) {
    struct vg_input line;
    int64_t id;
    vg_status st = content_line(r->in, &line, "a point", err);

    if (st == VG_OK) st = vg_input_int(&line, &id, "point number", err);
    for (int k = 0; k < 3 && st == VG_OK; k++)
      st = vg_input_real(&line, &p->point[i][k], "coordinate", err);
    if (st < 0) return st;
    if (id < 0)
      return vg_input_fail(&line, err, "point number %lld is negative",
                           (long long)id);
    r->point.list[r->point.n++] = (struct id){ id, i };
  }
  return map_done(r, &r->point, "point", err);
}

static vg_status read_curve(struct reader *r, size_t i, struct vg_error *err)
{
  struct vg_curve *c = r->p->curve + i;
  struct vg_input *in = r->in;
  int64_t id, n;
  vg_status st = vg_input_int(in, &id, "curve number", err);

  if (st == VG_OK) st = vg_input_int(in, &n, "number of points", err);
  if (st < 0) return st;
  if (id < 1 || id > INT32_MAX)
    return vg_input_fail(in, err, "curve number %lld is not positive",
                         (long long)id);
  if (n < 2 || (uint64_t)n > vg_input_left(in) / 2 + 1)
    return vg_input_fail(in, err,
                         "curve %lld has %lld points; it must have at least "
                         "two, and no more than the file lists",
                         (long long)id, (long long)n);
  c->id = (int32_t)id;
  c->point = vg_alloc((size_t)n, sizeof *c->point);
  if (!c->point) return vg_fail_memory(err, "a curve");
  c->n = (size_t)n;
  for (size_t k = 0; k < c->n; k++) {
    size_t at;
    int64_t number;

    st = vg_input_int(in, &number, "point of a curve", err);
    if (st < 0) return st;
    at = map_find(&r->point, number);
    if (at == SIZE_MAX)
      return vg_input_fail(in, err,
                           "curve %lld refers to point %lld, which "
                           "is not listed",
                           (long long)id, (long long)number);
    c->point[k] = (uint32_t)at;
  }
  r->curve.list[r->curve.n++] = (struct id){ id, i };
  return VG_OK;
}

static vg_status read_curves(struct reader *r, struct vg_error *err)
{
  vg_status st = VG_OK;

  r->in->comment = '#';
  for (size_t i = 0; i < r->p->n_curve && st == VG_OK; i++)
    st = read_curve(r, i, err);
  r->in->comment = 0;
  return st < 0 ? st : map_done(r, &r->curve, "curve", err);
}

static uint32_t curve_end(const struct vg_project *p, int32_t signed_curve,
                          int is_tail)
{
  const struct vg_curve *c = p->curve + labs(signed_curve) - 1;

  return (signed_curve > 0) == is_tail ? c->point[c->n - 1] : c->point[0];
}

/* First curve, counted from 1, of the loop whose end is not the start of the
 * next curve; 0 if the loop is closed. */
static size_t loop_gap(const struct vg_project *p,
                       const struct vg_patch_shape *s)
{
  for (size_t i = 0; i < s->n; i++)
    if (curve_end(p, s->curve[i], 1) !=
        curve_end(p, s->curve[(i + 1) % s->n], 0))
      return i + 1;
  return 0;
}

static vg_status add_loop_curve(struct reader *r, struct vg_patch_shape *s,
                                size_t *cap, const struct vg_input *line,
                                int64_t number, struct vg_error *err)
{
  size_t at = map_find(&r->curve, number < 0 ? -number : number);

  if (at == SIZE_MAX)
    return vg_input_fail(line, err,
                         "patch %d refers to curve %lld, which is "
                         "not listed",
                         s->patch.id, (long long)number);
  if (vg_reserve(&s->curve, cap, s->n + 1, sizeof *s->curve) < 0)
    return vg_fail_memory(err, "a patch");
  s->curve[s->n++] = number < 0 ? -(int32_t)(at + 1) : (int32_t)(at + 1);
  return VG_OK;
}

/* A side may consist of several curves: lines are read until the loop is
 * closed. */
static vg_status read_loop(struct reader *r, struct vg_patch_shape *s,
                           struct vg_error *err)
{
  size_t cap = 0, gap;

  for (;;) {
    struct vg_input line;
    const char *text;
    size_t len;
    int64_t number;
    vg_status st = content_line(r->in, &line, "the curves of a patch", err);

    if (st < 0) return st;
    while (vg_input_token_in_line(&line, &text, &len) &&
           vg_parse_int(text, len, &number)) {
      st = add_loop_curve(r, s, &cap, &line, number, err);
      if (st < 0) return st;
    }
    if (s->n < (size_t)s->n_side && vg_input_left(r->in)) continue;
    if (!s->n)
      return vg_input_fail(&line, err, "patch %d has no curves", s->patch.id);
    gap = loop_gap(r->p, s);
    if (!gap) return VG_OK;
    if (s->n > 4 * (size_t)s->n_side + 64 || !vg_input_left(r->in) ||
        r->in->data[r->in->at] == '\n' || r->in->data[r->in->at] == '\r' ||
        r->in->data[r->in->at] == '#')
      return vg_input_fail(&line, err,
                           "the loop of patch %d does not close: curve %d "
                           "does not end where curve %d begins",
                           s->patch.id, s->curve[gap - 1],
                           s->curve[gap % s->n]);
  }
}

static vg_status read_patch(struct reader *r, struct vg_patch_shape *s,
                            struct vg_error *err)
{
  static const char *const name[5] = { "patch number", "patch type",
                                       "number of sides", "rotation",
                                       "meshing class" };
  struct vg_input line;
  int64_t v[5];
  vg_status st = content_line(r->in, &line, "a patch", err);

  for (int k = 0; k < 5 && st == VG_OK; k++) {
    st = vg_input_int(&line, v + k, name[k], err);
    if (st == VG_OK && (v[k] < -INT32_MAX || v[k] > INT32_MAX))
      st = vg_input_fail(&line, err, "%s %lld is too large", name[k],
                         (long long)v[k]);
  }
  if (st < 0) return st;
  if (v[2] < 1 || v[2] > 100000000)
    return vg_input_fail(&line, err, "patch %lld has %lld sides",
                         (long long)v[0], (long long)v[2]);
  s->patch.id = (int32_t)v[0];
  s->patch.bc = s->patch.bc_fun3d = s->patch.family = VG_BC_NONE;
  s->type = (int32_t)v[1];
  s->n_side = (int32_t)v[2];
  s->rotation = (int32_t)v[3];
  s->meshing_class = (int32_t)v[4];
  copy_rest(&line, s->patch.name, sizeof s->patch.name);
  return read_loop(r, s, err);
}

static vg_status read_patches(struct reader *r, struct vg_error *err)
{
  struct vg_project *p = r->p;
  struct id_map ids = { 0, NULL };
  vg_status st = VG_OK;

  ids.list = vg_alloc(p->n_shape, sizeof *ids.list);
  if (!ids.list) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < p->n_shape && st == VG_OK; i++) {
    st = read_patch(r, p->shape + i, err);
    ids.list[ids.n++] = (struct id){ p->shape[i].patch.id, i };
  }
  if (st == VG_OK) st = map_done(r, &ids, "patch", err);
  free(ids.list);
  return st;
}

static vg_status check_source(const struct vg_input *in,
                              const struct vg_source *s, size_t number,
                              struct vg_error *err)
{
  int is_line = s->kind == VG_SOURCE_VGRID_LINE;

  if (!(s->h0 > 0) || (is_line && !(s->h1 > 0)))
    return vg_input_fail(in, err, "source %zu: the spacing S must be positive",
                         number);
  if (!(s->an > 0))
    return vg_input_fail(in, err, "source %zu: an must be positive", number);
  return VG_OK;
}

static vg_status read_source(struct reader *r, size_t i, struct vg_error *err)
{
  struct vg_source *s = r->p->source + i;
  struct vg_input *in = r->in, line;
  const char *text;
  size_t len;
  double v[3];
  vg_status st = VG_OK;

  VG_TRY(content_line(in, &line, "source_number", err));
  vg_input_token(&line, &text, &len);
  if (!vg_token_is(text, len, "source_number")) {
    st = vg_input_fail(&line, err,
                       "expected 'source_number' of source %zu of %zu", i + 1,
                       r->p->n_source);
    goto done;
  }
  vg_input_token_in_line(&line, &text, &len);
  copy_rest(&line, s->group, sizeof s->group);
  VG_TRY(values(in, 2, v, "type and stretching of a source", err));
  if (v[0] != 0 && v[0] != 1) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s:%zu: source %zu has type %g; valid types are 0 (node) "
                 "and 1 (line)",
                 in->path, in->line - 1, i + 1, v[0]);
    goto done;
  }
  s->kind = v[0] == 0 ? VG_SOURCE_VGRID_NODE : VG_SOURCE_VGRID_LINE;
  s->stretch = v[1];
  VG_TRY(values(in, 3, v, "an bn alpha", err));
  s->an = v[0];
  s->bn = v[1];
  s->alpha = v[2];
  VG_TRY(values(in, 2, v, "S SP of point 1", err));
  s->h0 = v[0];
  s->sp0 = v[1];
  VG_TRY(values(in, 3, s->layer0, "layer law of point 1", err));
  VG_TRY(values(in, 2, v, "S SP of point 2", err));
  s->h1 = v[0];
  s->sp1 = v[1];
  VG_TRY(values(in, 3, s->layer1, "layer law of point 2", err));
  VG_TRY(values(in, 3, s->u, "vector U", err));
  VG_TRY(values(in, 3, s->p, "vector P", err));
  VG_TRY(values(in, 3, s->p0, "point 1 of a source", err));
  VG_TRY(values(in, 3, s->p1, "point 2 of a source", err));
  VG_TRY(check_source(in, s, i + 1, err));
done:
  return st;
}

vg_status vg_d3m_parse(struct vg_input *in, struct vg_project *out,
                       struct vg_error *err)
{
  struct vg_project p = VG_PROJECT_INIT;
  struct reader r = { in, &p, { 0, NULL }, { 0, NULL } };
  vg_status st;

  assert(in && out);
  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: contains binary data; a .d3m is text", in->path);
  st = read_parameters(&r, err);
  if (st < 0) {
    p.n_curve = p.n_shape = 0; /* announced by the header, but not yet
                                  allocated */
    goto done;
  }
  VG_TRY(make_room(&r, err));
  VG_TRY(read_points(&r, err));
  VG_TRY(read_curves(&r, err));
  VG_TRY(read_patches(&r, err));
  for (size_t i = 0; i < p.n_source; i++) VG_TRY(read_source(&r, i, err));
  vg_project_release(out);
  *out = p;
  p = (struct vg_project)VG_PROJECT_INIT;
done:
  free(r.point.list);
  free(r.curve.list);
  vg_project_release(&p);
  return st;
}

vg_status vg_d3m_read(const char *path, struct vg_project *out,
                      struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = vg_d3m_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}
