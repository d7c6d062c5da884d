/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/soup.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "io/stream/convention.h"

void vg_soup_release(struct vg_soup *s)
{
  vg_mesh_release(&s->m);
  vg_table_release(&s->weld);
  vg_table_release(&s->named);
  memset(s, 0, sizeof *s);
}

static vg_status room(void *list, size_t *cap, size_t n, size_t size,
                      const char *what, struct vg_error *err)
{
  if (n >= UINT32_MAX - 1)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "more than 4294967294 %s, the limit of 32-bit numbers; "
                   "split the file",
                   what);
  if (vg_reserve(list, cap, n + 1, size)) return vg_fail_memory(err, what);
  return VG_OK;
}

vg_status vg_soup_point(struct vg_soup *s, const double x[3], uint32_t *at,
                        struct vg_error *err)
{
  assert(at);

  struct vg_mesh *m = &s->m;
  vg_status st = room(&m->point, &s->cap_point, m->n_point, sizeof *m->point,
                      "points", err);

  if (st < 0) return st;
  for (int k = 0; k < 3; k++) m->point[m->n_point][k] = x[k] + 0.0;
  *at = (uint32_t)m->n_point++;
  return VG_OK;
}

static uint64_t hash_name(const char *name)
{
  uint64_t h = 0;

  for (; *name; name++) h = vg_hash_add(h, (unsigned char)*name);
  return h;
}

static uint64_t point_hash(const void *soup, uint32_t i)
{
  const struct vg_soup *s = soup;

  return vg_hash_point(s->m.point[i]);
}

static uint64_t patch_hash(const void *soup, uint32_t i)
{
  const struct vg_soup *s = soup;

  return hash_name(s->m.patch[i].name);
}

vg_status vg_soup_weld(struct vg_soup *s, const double x[3], uint32_t *at,
                       struct vg_error *err)
{
  assert(at);

  double p[3] = { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 };
  uint32_t *slot;
  vg_status st;

  if (vg_table_reserve(&s->weld, s->m.n_point + 1, point_hash, s))
    return vg_fail_memory(err, "welding the points of a surface");
  VG_TABLE_FIND(&s->weld, slot, vg_hash_point(p),
                !memcmp(s->m.point[*slot], p, sizeof p));
  if (*slot != VG_TABLE_FREE) {
    *at = *slot;
    return VG_OK;
  }
  st = vg_soup_point(s, p, at, err);
  if (st == VG_OK) *slot = *at;
  return st;
}

vg_status vg_soup_triangle(struct vg_soup *s, const uint32_t node[3],
                           uint32_t patch, struct vg_error *err)
{
  assert(patch < s->m.n_patch);

  struct vg_mesh *m = &s->m;
  vg_status st = room(&m->tri, &s->cap_tri, m->n_tri, sizeof *m->tri,
                      "triangles", err);

  if (st == VG_OK)
    st = room(&m->tri_patch, &s->cap_tri_patch, m->n_tri, sizeof *m->tri_patch,
              "triangles", err);
  if (st < 0) return st;
  memcpy(m->tri[m->n_tri], node, sizeof *m->tri);
  m->tri_patch[m->n_tri++] = patch;
  return VG_OK;
}

static int is_blank(char c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

static void clean_name(char *name, const char *text, size_t len)
{
  while (len && is_blank(text[len - 1])) len--;
  while (len && is_blank(*text)) text++, len--;
  vg_name_from_file(text, len, name, VG_NAME_MAX);
}

static vg_status append_patch(struct vg_soup *s, const struct vg_patch *p,
                              uint32_t *at, struct vg_error *err)
{
  struct vg_mesh *m = &s->m;
  vg_status st = room(&m->patch, &s->cap_patch, m->n_patch, sizeof *m->patch,
                      "patches", err);

  if (st == VG_OK && m->n_patch >= INT32_MAX)
    st = vg_fail(err, VG_ERR_UNSUPPORTED, "more than 2147483647 patches");
  if (st < 0) return st;
  m->patch[m->n_patch] = *p;
  m->patch[m->n_patch].id = (int32_t)m->n_patch + 1;
  *at = (uint32_t)m->n_patch++;
  return VG_OK;
}

static struct vg_patch make_patch(const char *name, size_t len)
{
  struct vg_patch p;

  memset(&p, 0, sizeof p);
  p.bc = p.bc_fun3d = p.family = VG_BC_NONE;
  clean_name(p.name, name, len);
  return p;
}

vg_status vg_soup_patch(struct vg_soup *s, const char *name, size_t len,
                        uint32_t *at, struct vg_error *err)
{
  assert((name || !len) && at);

  struct vg_patch p = make_patch(name, len);

  return append_patch(s, &p, at, err);
}

vg_status vg_soup_named_patch(struct vg_soup *s, const char *name, size_t len,
                              uint32_t *at, struct vg_error *err)
{
  assert((name || !len) && at);

  struct vg_patch p = make_patch(name, len);
  uint32_t *slot;
  vg_status st;

  if (vg_table_reserve(&s->named, s->m.n_patch + 1, patch_hash, s))
    return vg_fail_memory(err, "patches");
  VG_TABLE_FIND(&s->named, slot, hash_name(p.name),
                !strcmp(s->m.patch[*slot].name, p.name));
  if (*slot != VG_TABLE_FREE) {
    *at = *slot;
    return VG_OK;
  }
  st = append_patch(s, &p, at, err);
  if (st == VG_OK) *slot = *at;
  return st;
}

static void shrink(void *array, size_t n, size_t size)
{
  void *old, *fit;

  memcpy(&old, array, sizeof old);
  if (!old || !(fit = vg_realloc(old, n, size))) return;
  memcpy(array, &fit, sizeof fit);
}

void vg_soup_finish(struct vg_soup *s, struct vg_mesh *out)
{
  assert(out);

  struct vg_mesh *m = &s->m;

  shrink(&m->point, m->n_point, sizeof *m->point);
  shrink(&m->tri, m->n_tri, sizeof *m->tri);
  shrink(&m->tri_patch, m->n_tri, sizeof *m->tri_patch);
  shrink(&m->patch, m->n_patch, sizeof *m->patch);
  vg_mesh_move(out, m);
  vg_soup_release(s);
}
