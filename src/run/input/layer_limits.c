/* What layers must reach, once they and the field are known. */
#include <stdlib.h>

#include "base/memory.h"
#include "run/input/layers.h"

/* NAN compares false: no limit. */
static int is_missed(const struct vg_limit_missed *m)
{
  return m->is_least ? m->got < m->wanted : m->got > m->wanted;
}

vg_status vg_layer_stage_finish(struct vg_layer_stage *s,
                                const struct vg_mesh *surface,
                                struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_layers_tops(surface, &s->layers.columns, s->top, s->n_wall,
                        s->wall, &s->all, err));
  for (size_t i = 0; i < s->n_wall; i++) {
    const struct vg_patch_layers *w = &s->wall[i];
    const struct vg_layer_limits *l = &s->limit[w->patch];
    const struct vg_limit_missed limit[] = {
      { w->patch, "min_full", " %", 1, l->min_full, w->full },
      { w->patch, "min_any", " %", 1, l->min_any, w->any },
      { w->patch, "min_height", " %", 1, l->min_height,
        100 * w->share_mean },
      { w->patch, "max_first_error", " %", 0, l->max_first_error,
        100 * w->first_error },
      { w->patch, "max_top_ratio", "", 0, l->max_top_ratio,
        w->top_ratio[1] } };

    for (size_t k = 0; k < sizeof limit / sizeof *limit; k++) {
      if (!is_missed(&limit[k])) continue;
      if (vg_reserve(&s->missed, &s->cap_missed, s->n_missed + 1,
                     sizeof *s->missed)) {
        st = vg_fail_memory(err, "the limits");
        goto done;
      }
      s->missed[s->n_missed++] = limit[k];
    }
  }
done:
  return st;
}
