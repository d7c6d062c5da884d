/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones of the cells of a run. */
#include <stdlib.h>

#include "base/memory.h"
#include "run/common/text.h"
#include "run/input/zone_table.h"
#include "run/report/report.h"
#include "run/stages/run.h"

vg_status vg_run_sort_zones(struct vg_run *r, const struct vg_problem *p,
                            struct vg_error *err)
{
  const struct vg_mesh *surface = &p->boundary.surface;
  struct vg_zone_map map = VG_ZONE_MAP_INIT;
  double *hmax = NULL;
  vg_status st;

  if (!vg_mesh_has_interfaces(surface)) return VG_OK;
  st = vg_zones_make(&p->read.settings, surface, 1, &map, &hmax, err);
  if (st >= 0) r->zone_limit = vg_alloc(map.n, sizeof *r->zone_limit);
  if (st >= 0 && !r->zone_limit) st = vg_fail_memory(err, "the zones");
  VG_TRY(vg_comm_agree(r->comm, st, err));
  vg_zones_limits(&map, hmax, r->zone_limit);
  r->unsorted = r->slices;
  st = vg_zone_slices_open(r->comm, &map, &r->unsorted, r->threads, &r->slices,
                           &r->zones, err);
done:
  free(hmax);
  vg_zone_map_release(&map);
  return st;
}

vg_status vg_run_judge_zones(struct vg_run *r, const struct vg_zone_quality *q,
                             struct vg_error *err)
{
  const size_t n = r->slices.boundary->n_zone;
  vg_status st = VG_OK;

  if (!n) return VG_OK;
  r->zone_report = vg_calloc(n, sizeof *r->zone_report);
  if (!r->zone_report) st = vg_fail_memory(err, "the zones");
  VG_TRY(vg_comm_agree(r->comm, st, err));
  st = vg_zone_quality_sum(r->comm, q, r->zone_report, err);
done:
  return st;
}

/* Cells of the size h have edges from about h / 2 to 2 h, with a mean of h. */
static int misses(const struct vg_zone_limit *l, const struct vg_zone_report *r)
{
  return l->hmax > 0 &&
         (r->edge_mean > 1.1 * l->hmax || r->edge_max > 2.5 * l->hmax);
}

void vg_run_note_zones(const struct vg_run *r, const struct vg_mesh *surface,
                       struct vg_notes *notes)
{
  const struct vg_mesh *m = r->slices.boundary;

  for (size_t z = 0; r->zone_report && z < m->n_zone; z++) {
    const struct vg_zone_limit *l = &r->zone_limit[z];
    const struct vg_patch *p = &surface->patch[l->patch];
    char why[200] = "use a smaller growth or a smaller hmax";

    if (!misses(l, &r->zone_report[z])) continue;
    if (l->edge > l->hmax)
      snprintf(why, sizeof why,
               "because patch %d%s%.64s next to it has edges of up to %.3g; "
               "make these at most %.3g long",
               (int)p->id, *p->name ? " " : "", p->name, l->edge, l->hmax);
    vg_note(notes,
            "zone %s requests a size of %.3g, but its edges have a mean length "
            "of %.3g and are up to %.3g long%s %s",
            m->zone[z].name, l->hmax, r->zone_report[z].edge_mean,
            r->zone_report[z].edge_max, l->edge > l->hmax ? "," : ";", why);
  }
}

/* The request of a zone, and what limits it. */
static void add_limit(json_t *o, const struct vg_zone_limit *l,
                      const struct vg_zone_report *r,
                      const struct vg_patch *patch)
{
  json_object_set_new(o, "hmax", json_real(l->hmax));
  json_object_set_new(o, "hmax_missed", json_boolean(misses(l, r)));
  if (l->edge <= l->hmax) return;
  json_object_set_new(o, "patch", json_integer(patch->id));
  json_object_set_new(o, "patch_name", vg_text_json(patch->name));
  json_object_set_new(o, "edge", json_real(l->edge));
}

json_t *vg_run_zones_json(const struct vg_run *r, const struct vg_mesh *surface)
{
  const struct vg_mesh *m = r->slices.boundary;
  json_t *list = vg_report_zones_json(m, r->zone_report);

  for (size_t z = 0; r->zone_report && z < m->n_zone; z++) {
    const struct vg_zone_limit *l = &r->zone_limit[z];

    if (l->hmax > 0)
      add_limit(json_array_get(list, z), l, &r->zone_report[z],
                &surface->patch[l->patch]);
  }
  return list;
}
