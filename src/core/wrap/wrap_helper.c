/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Requests to the helper program vanguard-wrap, which contains CGAL
 * (base/helper/helper.h). */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "core/wrap/wrap_parts.h"

/* Seconds without a message after which a helper counts as hung. A request for
 * the largest wrap is answered within an hour. */
#define SILENCE 7200
#define TEXT_MAX 300 /* characters of an explanation */

/* A request, and the process that answers it. */
struct request {
  struct vg_helper_message m;
  uint64_t most; /* points of a wrap */
  struct vg_child child;
  struct vg_link link;
};

int vg_wrap_is_available(char *why, size_t size)
{
  struct vg_helper h;

  vg_helper_find(VG_HELPER_WRAPS, &h);
  if (why && size) {
    size_t n = strnlen(h.why, size - 1);

    memcpy(why, h.why, n);
    why[n] = 0;
  }
  return h.is_found;
}

static vg_status refuse(struct request *r, struct vg_error *err)
{
  char text[TEXT_MAX + 1];
  size_t n = r->m.n[0] < TEXT_MAX ? r->m.n[0] : TEXT_MAX;

  if (!vg_link_get(&r->link, text, n)) n = 0;
  text[n] = 0;
  for (size_t i = 0; i < n; i++)
    if (text[i] < ' ' || text[i] > '~') text[i] = ' ';
  switch (r->m.option) {
  case VG_HELPER_NO_MEMORY:
    return vg_fail_memory(err, "a wrap; take a larger size");
  case VG_HELPER_TOO_MANY:
    return vg_fail(err, VG_ERR_INPUT,
                   "a wrap was stopped at %llu points before it was complete: "
                   "take a larger size",
                   (unsigned long long)r->most);
  case VG_HELPER_DEGENERATE:
    return vg_fail(err, VG_ERR_INPUT,
                   "the surface cannot be wrapped: all triangles are "
                   "degenerate");
  case VG_HELPER_CRASHED:
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "CGAL crashed on the surface; take a larger size");
  default:
    return vg_fail(err, VG_ERR_GEOMETRY, "CGAL could not wrap the surface: %s",
                   text);
  }
}

static vg_status explain(const struct request *r, struct vg_error *err)
{
  return vg_helper_lost(&r->link, 0, "vanguard-wrap", err);
}

/* Start a helper and send it a request. */
static vg_status ask(struct request *r, const struct vg_mesh *m, size_t n_more,
                     const double (*more)[3], const struct vg_stop *stop,
                     struct vg_error *err)
{
  vg_status st = vg_helper_open(VG_HELPER_WRAPS, stop, SILENCE, &r->child,
                                &r->link, err);

  if (st < 0) return st;
  r->m.n[0] = m->n_point;
  r->m.n[1] = m->n_tri;
  if (vg_link_put(&r->link, &r->m, sizeof r->m) &&
      vg_link_put(&r->link, m->point, m->n_point * sizeof *m->point) &&
      vg_link_put(&r->link, m->tri, m->n_tri * sizeof *m->tri) &&
      vg_link_put(&r->link, more, n_more * sizeof *more))
    return VG_OK;
  st = explain(r, err);
  vg_helper_close(&r->child);
  return st;
}

/* Receive the head of a reply, which must be `what`. */
static vg_status receive(struct request *r, uint32_t what, struct vg_error *err)
{
  if (!vg_link_get(&r->link, &r->m, sizeof r->m)) return explain(r, err);
  if (r->m.what == VG_HELPER_FAILED) return refuse(r, err);
  if (r->m.what == what || r->m.what == VG_HELPER_PROGRESS) return VG_OK;
  return explain(r, err);
}

static vg_status damaged(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO,
                 "the answer of vanguard-wrap is damaged: counts or indices "
                 "are out of range");
}

vg_status vg_wrap_receive_surface(struct vg_link *l, uint64_t n_point,
                                  uint64_t n_tri, struct vg_mesh *out,
                                  struct vg_error *err)
{
  const uint64_t most = (uint64_t)VG_WRAP_MOST;
  vg_status st = VG_OK;

  if (n_point > most || n_tri > 2 * most) return damaged(err);
  out->point = vg_link_get_array(l, n_point, sizeof *out->point);
  if (out->point) out->tri = vg_link_get_array(l, n_tri, sizeof *out->tri);
  if (!out->tri) return VG_BLOCKED;
  out->tri_patch = vg_calloc(n_tri, sizeof *out->tri_patch);
  if (!out->tri_patch) return vg_fail_memory(err, "a wrap");
  out->n_point = n_point;
  out->n_tri = n_tri;
  for (size_t i = 0; i < n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (out->tri[i][k] >= n_point) st = damaged(err);
  return st;
}

vg_status vg_wrap_cgal(const struct vg_mesh *m, const struct vg_wrap_options *o,
                       size_t expected, struct vg_mesh *out,
                       struct vg_error *err)
{
  const uint64_t most = o->most ? o->most : (uint64_t)(VG_WRAP_MOST / 2);
  struct request r = { .most = most,
                       .m = {
                         .what = VG_HELPER_WRAP,
                         .n = { 0, 0, most },
                         .value = { o->size, o->size * VG_WRAP_OFFSET } } };
  vg_status st = ask(&r, m, 0, NULL, &o->stop, err);

  if (st < 0) return st;
  for (;;) {
    VG_TRY(receive(&r, VG_HELPER_SURFACE, err));
    if (r.m.what == VG_HELPER_SURFACE) break;
    if (o->progress) o->progress(o->user, r.m.n[0], expected);
  }
  st = vg_wrap_receive_surface(&r.link, r.m.n[0], r.m.n[1], out, err);
  if (st == VG_BLOCKED) st = explain(&r, err);
done:
  vg_helper_close(&r.child);
  return st;
}

/* A request that is answered by a surface, and the triangle of m of each of its
 * triangles. */
static vg_status combine(const struct vg_mesh *m, uint32_t what,
                         uint32_t option, const struct vg_stop *stop,
                         struct vg_mesh *out, uint32_t **from,
                         struct vg_error *err)
{
  struct request r = { .m = { .what = what, .option = option } };
  vg_status st = ask(&r, m, 0, NULL, stop, err);

  if (st < 0) return st;
  st = receive(&r, VG_HELPER_SURFACE, err);
  if (st < 0 && r.m.what == VG_HELPER_FAILED && r.m.option == VG_HELPER_ERROR)
    st = VG_BLOCKED;
  if (st != VG_OK) goto done;
  if (r.m.what != VG_HELPER_SURFACE) VG_TRY(damaged(err));
  st = vg_wrap_receive_surface(&r.link, r.m.n[0], r.m.n[1], out, err);
  if (st == VG_BLOCKED) st = explain(&r, err);
  if (st < 0) goto done;
  VG_TRY(receive(&r, VG_HELPER_COUNTS, err));
  if (r.m.what != VG_HELPER_COUNTS || r.m.n[0] != out->n_tri)
    VG_TRY(damaged(err));
  *from = vg_link_get_array(&r.link, out->n_tri, sizeof **from);
  if (!*from) VG_TRY(explain(&r, err));
  for (size_t i = 0; i < out->n_tri; i++)
    if ((*from)[i] >= m->n_tri) st = damaged(err);
done:
  vg_helper_close(&r.child);
  return st;
}

vg_status vg_wrap_unite(const struct vg_mesh *m, int subtracts,
                        const struct vg_stop *stop, struct vg_mesh *out,
                        uint32_t **from, struct vg_error *err)
{
  return combine(m, VG_HELPER_UNITE, subtracts != 0, stop, out, from, err);
}

vg_status vg_wrap_imprint(const struct vg_mesh *m, size_t n_wall,
                          const struct vg_stop *stop, struct vg_mesh *out,
                          uint32_t **from, struct vg_error *err)
{
  assert(n_wall <= m->n_tri && n_wall <= UINT32_MAX);
  return combine(m, VG_HELPER_IMPRINT, (uint32_t)n_wall, stop, out, from, err);
}

/* Ask for a count for each of n items, which have n_more points. */
static vg_status count(uint32_t what, const struct vg_mesh *m, size_t n,
                       size_t n_more, const double (*more)[3],
                       const struct vg_stop *stop, uint32_t *out,
                       struct vg_error *err)
{
  struct request r = { .m = { .what = what, .n = { 0, 0, n } } };
  vg_status st = ask(&r, m, n_more, more, stop, err);

  if (st < 0) return st;
  VG_TRY(receive(&r, VG_HELPER_COUNTS, err));
  if (r.m.what != VG_HELPER_COUNTS || r.m.n[0] != n) st = damaged(err);
  else if (!vg_link_get(&r.link, out, n * sizeof *out)) st = explain(&r, err);
done:
  vg_helper_close(&r.child);
  return st;
}

vg_status vg_wrap_outside(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          uint8_t *outside, struct vg_error *err)
{
  uint32_t *is = vg_alloc(n, sizeof *is);
  vg_status st;

  if (!is) return vg_fail_memory(err, "a wrap");
  st = count(VG_HELPER_OUTSIDE, m, n, n, x, stop, is, err);
  for (size_t i = 0; st == VG_OK && i < n; i++) outside[i] = is[i] != 0;
  free(is);
  return st;
}

vg_status vg_wrap_crossings(const struct vg_mesh *m, size_t n,
                            const double (*a)[3], const double (*b)[3],
                            const struct vg_stop *stop, uint32_t *out,
                            struct vg_error *err)
{
  double(*ends)[3] = vg_alloc(2 * n, sizeof *ends);
  vg_status st;

  if (!ends) return vg_fail_memory(err, "a wrap");
  if (n) {
    memcpy(ends, a, n * sizeof *ends);
    memcpy(ends + n, b, n * sizeof *ends);
  }
  st = count(VG_HELPER_CROSSINGS, m, n, 2 * n, (const double(*)[3])ends, stop,
             out, err);
  free(ends);
  return st;
}

vg_status vg_wrap_nearest(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          double (*foot)[3], uint32_t *tri,
                          struct vg_error *err)
{
  struct request r = { .m = { .what = VG_HELPER_NEAREST, .n = { 0, 0, n } } };
  vg_status st = ask(&r, m, n, x, stop, err);

  if (st < 0) return st;
  VG_TRY(receive(&r, VG_HELPER_FEET, err));
  if (r.m.what != VG_HELPER_FEET || r.m.n[0] != n) st = damaged(err);
  else if (!vg_link_get(&r.link, foot, n * sizeof *foot) ||
           !vg_link_get(&r.link, tri, n * sizeof *tri))
    st = explain(&r, err);
  for (size_t i = 0; st == VG_OK && i < n; i++)
    if (tri[i] >= m->n_tri) st = damaged(err);
done:
  vg_helper_close(&r.child);
  return st;
}
