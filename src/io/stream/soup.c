#include "io/stream/soup.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/convention.h"

void vg_soup_release(struct vg_soup *s)
{
  vg_mesh_release(&s->m);
  free(s->weld);
  free(s->named);
  memset(s, 0, sizeof *s);
}

static vg_status room(void *list, size_t *cap, size_t n, size_t size,
                      const char *what, struct vg_error *err)
{
  if (n >= UINT32_MAX - 1)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "more than 4294967294 %s: beyond 32-bit numbers; split the "
                   "file", what);
  if (vg_reserve(list, cap, n + 1, size)) return vg_fail_memory(err, what);
  return VG_OK;
}

vg_status vg_soup_point(struct vg_soup *s, const double x[3], uint32_t *at,
                        struct vg_error *err)
{
  struct vg_mesh *m = &s->m;
  vg_status st = room(&m->point, &s->cap_point, m->n_point, sizeof *m->point,
                      "points", err);

  if (st < 0) return st;
  for (int k = 0; k < 3; k++) m->point[m->n_point][k] = x[k] + 0.0;
  *at = (uint32_t)m->n_point++;
  return VG_OK;
}

static uint64_t mix(uint64_t h, uint64_t v)
{
  h = (h ^ v) * 0x9e3779b97f4a7c15u;
  return h ^ h >> 32;
}

static uint64_t hash_point(const double x[3])
{
  uint64_t bits[3];

  memcpy(bits, x, sizeof bits);
  return mix(mix(mix(0, bits[0]), bits[1]), bits[2]);
}

static uint64_t hash_name(const char *name)
{
  uint64_t h = 0;

  for (; *name; name++) h = mix(h, (unsigned char)*name);
  return h;
}

/* Double a table whose items (0 .. n-1) hash by `hash(item)`. */
static vg_status grow(uint32_t **table, size_t *size, size_t n,
                      const struct vg_soup *s,
                      uint64_t (*hash)(const struct vg_soup *, size_t),
                      struct vg_error *err)
{
  size_t new_size = *size ? 2 * *size : 64, mask = new_size - 1;
  uint32_t *t;

  if (2 * n < *size) return VG_OK;
  t = vg_calloc(new_size, sizeof *t);
  if (!t) return vg_fail_memory(err, "welding the points of a surface");
  for (size_t i = 0; i < n; i++) {
    size_t at = (size_t)hash(s, i) & mask;

    while (t[at]) at = (at + 1) & mask;
    t[at] = (uint32_t)i + 1;
  }
  free(*table);
  *table = t;
  *size = new_size;
  return VG_OK;
}

static uint64_t point_hash(const struct vg_soup *s, size_t i)
{
  return hash_point(s->m.point[i]);
}

static uint64_t patch_hash(const struct vg_soup *s, size_t i)
{
  return hash_name(s->m.patch[i].name);
}

vg_status vg_soup_weld(struct vg_soup *s, const double x[3], uint32_t *at,
                       struct vg_error *err)
{
  double p[3] = { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 };
  size_t slot, mask;
  vg_status st = grow(&s->weld, &s->weld_size, s->m.n_point, s, point_hash,
                      err);

  if (st < 0) return st;
  mask = s->weld_size - 1;
  slot = (size_t)hash_point(p) & mask;
  for (; s->weld[slot]; slot = (slot + 1) & mask)
    if (!memcmp(s->m.point[s->weld[slot] - 1], p, sizeof p)) {
      *at = s->weld[slot] - 1;
      return VG_OK;
    }
  st = vg_soup_point(s, p, at, err);
  if (st == VG_OK) s->weld[slot] = *at + 1;
  return st;
}

vg_status vg_soup_triangle(struct vg_soup *s, const uint32_t node[3],
                           uint32_t patch, struct vg_error *err)
{
  struct vg_mesh *m = &s->m;
  vg_status st = room(&m->tri, &s->cap_tri, m->n_tri, sizeof *m->tri,
                      "triangles", err);

  if (st == VG_OK)
    st = room(&m->tri_patch, &s->cap_tri_patch, m->n_tri,
              sizeof *m->tri_patch, "triangles", err);
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
  struct vg_patch p = make_patch(name, len);

  return append_patch(s, &p, at, err);
}

vg_status vg_soup_named_patch(struct vg_soup *s, const char *name, size_t len,
                              uint32_t *at, struct vg_error *err)
{
  struct vg_patch p = make_patch(name, len);
  size_t slot, mask;
  vg_status st = grow(&s->named, &s->named_size, s->m.n_patch, s, patch_hash,
                      err);

  if (st < 0) return st;
  mask = s->named_size - 1;
  slot = (size_t)hash_name(p.name) & mask;
  for (; s->named[slot]; slot = (slot + 1) & mask)
    if (!strcmp(s->m.patch[s->named[slot] - 1].name, p.name)) {
      *at = s->named[slot] - 1;
      return VG_OK;
    }
  st = append_patch(s, &p, at, err);
  if (st == VG_OK) s->named[slot] = *at + 1;
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
  struct vg_mesh *m = &s->m;

  shrink(&m->point, m->n_point, sizeof *m->point);
  shrink(&m->tri, m->n_tri, sizeof *m->tri);
  shrink(&m->tri_patch, m->n_tri, sizeof *m->tri_patch);
  shrink(&m->patch, m->n_patch, sizeof *m->patch);
  vg_mesh_move(out, m);
  vg_soup_release(s);
}
