/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Loads as messages. The index is not sent, because it is rebuilt from the
 * octants. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/comm.h"
#include "base/memory.h"
#include "partition/load/load.h"

struct head {
  char magic[8];
  uint64_t n;
  double lo[3], unit;
  uint64_t is_block;
  double from[3], to[3];
};

static const char magic[8] = { 'V', 'G', 'L', 'O', 'A', 'D', '3', '\n' };

vg_status vg_load_pack(const struct vg_load *l, struct vg_bytes *out,
                       struct vg_error *err)
{
  assert(out);

  struct head h = { .n = l->n,
                    .unit = l->unit,
                    .is_block = (uint64_t)l->is_block };
  const size_t octants = l->n * sizeof *l->octant;
  unsigned char *data = vg_alloc(sizeof h + octants, 1);

  if (!data) return vg_fail_memory(err, "a message with a load");
  memcpy(h.magic, magic, sizeof magic);
  memcpy(h.lo, l->lo, sizeof h.lo);
  memcpy(h.from, l->from, sizeof h.from);
  memcpy(h.to, l->to, sizeof h.to);
  memcpy(data, &h, sizeof h);
  if (octants) memcpy(data + sizeof h, l->octant, octants);
  out->n = sizeof h + octants;
  out->data = data;
  return VG_OK;
}

static int is_sound(const struct vg_load_octant *c)
{
  for (int k = 0; k < 3; k++)
    if (!isfinite(c->at[k]) || !isfinite(c->across[k]) || !(c->across[k] > 0))
      return 0;
  return isfinite(c->half) && c->half > 0 && isfinite(c->h) && c->h > 0 &&
         isfinite(c->part) && c->part > 0 && isfinite(c->cells) &&
         c->cells >= 0;
}

vg_status vg_load_unpack(const struct vg_bytes *in, struct vg_load *out,
                         struct vg_error *err)
{
  struct vg_load l = VG_LOAD_INIT;
  struct head h;

  assert(in && out);
  if (in->n < sizeof h) goto damaged;
  memcpy(&h, in->data, sizeof h);
  if (memcmp(h.magic, magic, sizeof magic) ||
      h.n != (in->n - sizeof h) / sizeof *l.octant ||
      (in->n - sizeof h) % sizeof *l.octant || !isfinite(h.unit) ||
      !isfinite(h.lo[0] + h.lo[1] + h.lo[2]) || h.is_block > 1)
    goto damaged;
  for (int k = 0; k < 3; k++)
    if (h.is_block && !(h.from[k] < h.to[k])) goto damaged;
  l.n = h.n;
  l.unit = h.unit;
  l.is_block = (int)h.is_block;
  memcpy(l.lo, h.lo, sizeof l.lo);
  memcpy(l.from, h.from, sizeof l.from);
  memcpy(l.to, h.to, sizeof l.to);
  l.octant = vg_alloc(l.n, sizeof *l.octant);
  if (!l.octant) return vg_fail_memory(err, "a load from a message");
  if (l.n) memcpy(l.octant, in->data + sizeof h, l.n * sizeof *l.octant);
  for (size_t i = 0; i < l.n; i++) {
    if (!is_sound(&l.octant[i])) goto damaged;
    l.cells += (double)l.octant[i].cells;
  }
  if (vg_load_index(&l, 1, err) < 0) {
    vg_load_release(&l);
    return VG_ERR_MEMORY;
  }
  *out = l;
  return VG_OK;
damaged:
  vg_load_release(&l);
  return vg_fail(err, VG_ERR_FORMAT,
                 "a message with a load is damaged; the "
                 "ranks must run the same build of vanguard");
}
