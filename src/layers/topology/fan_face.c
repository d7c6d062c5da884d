/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Virtual faces along ridges and at points, and boundary edges of fans. */
#include "base/memory.h"
#include "layers/topology/fan.h"

struct faces {
  const struct vg_wall *w;
  struct vg_fans *f;
  size_t cap_face, cap_border, cap_patch;
};

static vg_status add_face(struct faces *s, uint32_t a, uint32_t b, uint32_t c,
                          struct vg_error *err)
{
  struct vg_fans *f = s->f;
  uint32_t *face;

  if (vg_reserve(&f->face, &s->cap_face, f->n_face + 1, sizeof *f->face) < 0)
    return vg_fail_memory(err, "the virtual faces");
  face = f->face[f->n_face++];
  face[0] = a;
  face[1] = b;
  face[2] = c;
  return VG_OK;
}

/* Chain of a ridge as seen from the point at which half-edge h starts; a single
 * column if no fan of the point is across it. */
static struct vg_fan_chain chain_at(const struct faces *s, uint32_t h)
{
  const uint8_t at = s->f->at[h];
  struct vg_fan_chain none = { at, at, 0, 0 };
  uint32_t i = s->f->chain_of[h];

  return i == VG_NO_INDEX ? none : s->f->chain[i];
}

/* Virtual faces along ridge h from p to q. Its left face has the edge p to q,
 * its right face q to p. Both chains are followed from left to right, that of p
 * in reverse, and the chain that lags behind takes the next step. */
static vg_status strip(struct faces *s, uint32_t h, struct vg_error *err)
{
  const struct vg_wall *w = s->w;
  uint32_t g = w->opposite[h];
  struct vg_fan_chain p = chain_at(s, h), q = chain_at(s, g);
  uint32_t p0 = s->f->first[w->face[h / 3][h % 3]];
  uint32_t q0 = s->f->first[w->face[g / 3][g % 3]];
  uint32_t i = 0, j = 0;
  vg_status st = VG_OK;

  while (i < p.n_step || j < q.n_step) {
    uint32_t at_p = p0 + vg_fan_at(&p, p.n_step - i);
    uint32_t at_q = q0 + vg_fan_at(&q, j);

    if (j == q.n_step ||
        (i < p.n_step && (i + 1) * q.n_step <= (j + 1) * p.n_step))
      VG_TRY(add_face(s, at_p, p0 + vg_fan_at(&p, p.n_step - ++i), at_q, err));
    else VG_TRY(add_face(s, at_p, q0 + vg_fan_at(&q, ++j), at_q, err));
  }
done:
  return st;
}

/* Virtual faces of the polygon at a point where three or more sectors meet. */
static vg_status polygon(struct faces *s, const struct vg_fan_point *fan,
                         struct vg_error *err)
{
  uint32_t o = s->f->first[fan->point], n = fan->n_polygon;
  vg_status st = VG_OK;

  if (!fan->has_centre) return n ? add_face(s, o, o + 1, o + 2, err) : VG_OK;
  for (uint32_t i = 0; i < n; i++)
    VG_TRY(add_face(s, o + i, o + (i + 1) % n, o + n, err));
done:
  return st;
}

/* Where a fan meets a slide patch, its chains have virtual faces on one side
 * only. The edges on the other side are boundary edges, with the orientation of
 * these faces. */
static vg_status fan_rims(struct faces *s, const struct vg_fan_point *fan,
                          struct vg_error *err)
{
  struct vg_fans *f = s->f;
  uint32_t o = f->first[fan->point];

  for (uint32_t i = fan->n_column - 1u; fan->is_open && i > 0; i--) {
    if (vg_reserve(&f->border, &s->cap_border, f->n_border + 1,
                   sizeof *f->border) < 0 ||
        vg_reserve(&f->border_patch, &s->cap_patch, f->n_border + 1,
                   sizeof *f->border_patch) < 0)
      return vg_fail_memory(err, "the boundary edges of fans");
    f->border[f->n_border][0] = o + i;
    f->border[f->n_border][1] = o + i - 1;
    f->border_patch[f->n_border++] = s->w->slide[fan->point][0];
  }
  return VG_OK;
}

vg_status vg_fans_close(const struct vg_wall *w, struct vg_fans *f,
                        struct vg_error *err)
{
  struct faces s = { .w = w, .f = f };
  vg_status st = VG_OK;

  for (uint32_t h = 0; h < 3 * w->n_face; h++) {
    uint32_t g = w->opposite[h];

    if (g == VG_NO_INDEX) continue;
    if (h > g) continue;
    if (f->chain_of[h] == VG_NO_INDEX && f->chain_of[g] == VG_NO_INDEX)
      continue;
    VG_TRY(strip(&s, h, err));
  }
  for (size_t i = 0; i < f->n_fan; i++) VG_TRY(polygon(&s, &f->fan[i], err));
  for (size_t i = 0; i < f->n_fan; i++) VG_TRY(fan_rims(&s, &f->fan[i], err));
done:
  return st;
}
