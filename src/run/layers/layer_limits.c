/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks the limits on layers, once layers and field are known. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "run/layers/layers.h"

/* NAN compares false: no limit. A patch without layers misses every limit. */
static int is_missed(const struct vg_limit_missed *m)
{
  if (m->is_bare) return !isnan(m->wanted);
  return m->is_least ? m->got < m->wanted : m->got > m->wanted;
}

static vg_status add_missed(struct vg_layer_stage *s,
                            const struct vg_limit_missed *m,
                            struct vg_error *err)
{
  if (vg_reserve(&s->missed, &s->cap_missed, s->n_missed + 1,
                 sizeof *s->missed))
    return vg_fail_memory(err, "the limits");
  s->missed[s->n_missed++] = *m;
  return VG_OK;
}

/* Checks the limits of patch i. w: its measured layers; NULL: it has no face
 * from which layers grow. */
static vg_status check_patch(struct vg_layer_stage *s, uint32_t i,
                             const struct vg_patch_layers *w,
                             struct vg_error *err)
{
  static const struct vg_patch_layers none = { .n_face = 0 };
  const struct vg_layer_limits *l = &s->limit[i];
  const int bare = !w || !(w->any > 0);
  const size_t before = s->n_missed;
  vg_status st = VG_OK;
  struct vg_limit_missed limit[] = {
    { i, "min_full", " %", 1, bare, l->min_full, 0 },
    { i, "min_any", " %", 1, bare, l->min_any, 0 },
    { i, "min_height", " %", 1, bare, l->min_height, 0 },
    { i, "max_first_error", " %", 0, bare, l->max_first_error, 0 },
    { i, "max_top_ratio", "", 0, bare, l->max_top_ratio, 0 }
  };

  if (!w) w = &none;
  limit[0].got = w->full;
  limit[1].got = w->any;
  limit[2].got = 100 * w->share_mean;
  limit[3].got = 100 * w->first_error;
  limit[4].got = w->top_ratio[1];
  for (size_t k = 0; k < sizeof limit / sizeof *limit; k++)
    if (is_missed(&limit[k])) VG_TRY(add_missed(s, &limit[k], err));
  /* Requested layers of which none grow are a missed limit, too. */
  if (s->n_missed == before && !(s->all.any > 0))
    VG_TRY(
      add_missed(s, &(struct vg_limit_missed){ i, "layers", "", 1, 1, NAN, 0 },
                 err));
done:
  return st;
}

vg_status vg_layer_stage_finish(struct vg_layer_stage *s,
                                const struct vg_mesh *surface,
                                struct vg_error *err)
{
  size_t at = 0;
  vg_status st;

  assert(s->is_on && s->top);
  VG_TRY(vg_layers_tops(surface, &s->layers.columns, s->top, s->n_wall, s->wall,
                        &s->all, err));
  for (uint32_t i = 0; i < s->n_patch; i++) { /* s->wall is sorted by patch. */
    while (at < s->n_wall && s->wall[at].patch < i) at++;
    if (s->reason[i] == VG_WALL_NOT) continue;
    VG_TRY(check_patch(s, i,
                       at < s->n_wall && s->wall[at].patch == i ? &s->wall[at]
                                                                : NULL,
                       err));
  }
done:
  return st;
}
