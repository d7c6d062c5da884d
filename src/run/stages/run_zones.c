/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones of the cells of a run. */
#include <stdlib.h>

#include "base/memory.h"
#include "run/input/zone_table.h"
#include "run/stages/run.h"

vg_status vg_run_sort_zones(struct vg_run *r, const struct vg_problem *p,
                            struct vg_error *err)
{
  const struct vg_mesh *surface = &p->boundary.surface;
  struct vg_zone_map map = VG_ZONE_MAP_INIT;
  vg_status st;

  if (!vg_mesh_has_interfaces(surface)) return VG_OK;
  st = vg_zones_make(&p->read.settings, surface, 1, &map, NULL, err);
  VG_TRY(vg_comm_agree(r->comm, st, err));
  r->unsorted = r->slices;
  st = vg_zone_slices_open(r->comm, &map, &r->unsorted, r->threads, &r->slices,
                           &r->zones, err);
done:
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
