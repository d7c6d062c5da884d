/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Divides a void of a forecast into the blocks of its lattice. */
#include <stdlib.h>

#include "base/memory.h"
#include "partition/model/forecast_parts.h"

static int side_of(const struct vg_lattice *l, int axis, double x)
{
  int k = 0;

  while (k < l->n[axis] && x > l->at[axis][k]) k++;
  return k;
}

static struct vg_subdomain *block_at(struct vg_blocks *b, const int at[3])
{
  return &b->part[at[0] +
                  (b->l->n[0] + 1) * (at[1] + (b->l->n[1] + 1) * at[2])];
}

static vg_status share_load(struct vg_blocks *b, const struct vg_load *load,
                            struct vg_error *err)
{
  const double *const at[3] = { b->l->at[0], b->l->at[1], b->l->at[2] };
  struct vg_load *out = vg_calloc(b->n, sizeof *out);
  vg_status st = out ? VG_OK : vg_fail_memory(err, "a forecast");

  if (st >= 0)
    st = vg_load_split_blocks(load, b->l->n, at, 0, 1, NULL, out, err);
  for (size_t i = 0; st >= 0 && i < b->n; i++) b->part[i].load = out[i];
  free(out);
  return st;
}

static vg_status share_front(struct vg_blocks *b, const struct vg_bins *f,
                             struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; st >= 0 && i < f->n; i++) {
    int at[3];

    for (int k = 0; k < 3; k++)
      at[k] = side_of(b->l, k, (double)f->bit[i].x[k]);
    st = vg_bins_add(&block_at(b, at)->front, &f->bit[i], err);
  }
  return st;
}

static void set_box(const struct vg_blocks *b, const struct vg_subdomain *from,
                    size_t i)
{
  struct vg_subdomain *p = &b->part[i];

  for (int k = 0; k < 3; k++) {
    int n = b->l->n[k], at = (int)(i % (size_t)(n + 1));

    i /= (size_t)(n + 1);
    p->lo[k] = at > 0 ? b->l->at[k][at - 1] : from->lo[k];
    p->hi[k] = at < n ? b->l->at[k][at] : from->hi[k];
  }
}

void vg_blocks_release(struct vg_blocks *b)
{
  for (size_t i = 0; i < b->n; i++) vg_subdomain_release(&b->part[i]);
  free(b->part);
}

vg_status vg_blocks_open(struct vg_blocks *b, const struct vg_lattice *l,
                         const struct vg_subdomain *p, struct vg_error *err)
{
  vg_status st;

  b->l = l;
  b->n = (size_t)((l->n[0] + 1) * (l->n[1] + 1) * (l->n[2] + 1));
  b->part = vg_calloc(b->n, sizeof *b->part);
  if (!b->part) {
    b->n = 0;
    return vg_fail_memory(err, "a forecast");
  }
  st = share_load(b, &p->load, err);
  if (st >= 0) st = share_front(b, &p->front, err);
  for (size_t i = 0; i < b->n; i++) set_box(b, p, i);
  return st;
}
