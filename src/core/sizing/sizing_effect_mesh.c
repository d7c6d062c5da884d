/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Does a mesh have points near the sample points of sources? */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_effect.h"

struct meeting {
  const struct vg_effects *effects;
  atomic_uchar *is_met; /* [n_place] */
};

static void box_of(const struct vg_slice *s, double lo[3], double hi[3])
{
  for (int k = 0; k < 3; k++) {
    lo[k] = hi[k] = s->x[0][k];
    for (size_t i = 1; i < s->n_point; i++) {
      if (s->x[i][k] < lo[k]) lo[k] = s->x[i][k];
      if (s->x[i][k] > hi[k]) hi[k] = s->x[i][k];
    }
  }
}

static int has_point(const struct vg_slice *s, const double x[3], double far)
{
  for (size_t i = 0; i < s->n_point; i++)
    if (vg_distance2(s->x[i], x) <= far * far) return 1;
  return 0;
}

static vg_status meet_slice(void *context, const struct vg_slice *s,
                            struct vg_error *err)
{
  const struct meeting *m = context;
  double lo[3], hi[3];

  (void)err;
  if (!s->n_point) return VG_OK;
  box_of(s, lo, hi);
  for (size_t i = 0; i < m->effects->n_place; i++) {
    const struct vg_steep_place *p = m->effects->place + i;
    double far = VG_MET_WITHIN * p->got;
    int may = !atomic_load_explicit(m->is_met + i, memory_order_relaxed);

    for (int k = 0; k < 3; k++)
      may = may && p->x[k] >= lo[k] - far && p->x[k] <= hi[k] + far;
    if (may && has_point(s, p->x, far))
      atomic_store_explicit(m->is_met + i, 1, memory_order_relaxed);
  }
  return VG_OK;
}

/* The sample points of a source are contiguous. */
static void conclude(struct vg_effects *h, const uint64_t *met)
{
  for (size_t i = 0, end; i < h->n_place; i = end) {
    struct vg_unmet_source *u = h->unmet + h->n_unmet;

    memset(u, 0, sizeof *u);
    u->source = h->place[i].source;
    for (end = i; end < h->n_place && h->place[end].source == u->source;
         end++) {
      u->n_place++;
      if (met[end]) continue;
      if (!u->n_unmet++) u->place = h->place[end];
    }
    if (u->n_unmet &&
        (double)u->n_unmet >= VG_LIMITED_SHARE * (double)u->n_place)
      h->n_unmet++;
  }
}

vg_status vg_effects_in_mesh(struct vg_comm *c, const struct vg_slices *s,
                             int threads, struct vg_effects *h,
                             struct vg_error *err)
{
  struct vg_bytes b = { h->n_place * sizeof *h->place, (void *)h->place };
  struct meeting m = { .effects = h };
  uint64_t *met = NULL;
  vg_status st;

  VG_TRY(vg_comm_bcast(c, 0, &b, err));
  h->place = (void *)b.data;
  h->n_place = b.n / sizeof *h->place;
  if (!h->n_place) goto done;
  m.is_met = vg_calloc(h->n_place, sizeof *m.is_met);
  met = vg_calloc(h->n_place, sizeof *met);
  h->unmet = vg_calloc(h->n_place, sizeof *h->unmet);
  st = m.is_met && met && h->unmet
       ? vg_slices_each(s, threads, meet_slice, &m, err)
       : vg_fail_memory(err, "the sources");
  VG_TRY(vg_comm_agree(c, st, err));
  for (size_t i = 0; i < h->n_place; i++) met[i] = m.is_met[i];
  VG_TRY(vg_comm_sum(c, h->n_place, met, err));
  conclude(h, met);
done:
  free(m.is_met);
  free(met);
  return st;
}
