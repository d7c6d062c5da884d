/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* First heights at the points of a .surf. Declared in run/input/input.h and
 * run/input/mesh_unit.h. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "io/mesh/aflr.h"
#include "run/input/mesh_unit.h"

static int compare_height(const void *a, const void *b)
{
  const struct vg_point_height *p = a, *q = b;

  for (int k = 0; k < 3; k++)
    if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
  return (p->first > q->first) - (p->first < q->first);
}

static int compare_place(const void *a, const void *b)
{
  const struct vg_point_height *p = a, *q = b;

  for (int k = 0; k < 3; k++)
    if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
  return 0;
}

void vg_point_heights_sort(struct vg_point_heights *h)
{
  qsort(h->item, h->n, sizeof *h->item, compare_height);
}

struct vg_point_height *vg_point_height(const struct vg_point_heights *h,
                                        const double x[3])
{
  const struct vg_point_height key = { { x[0], x[1], x[2] }, 0, -1 };

  return h->n ? bsearch(&key, h->item, h->n, sizeof *h->item, compare_place)
              : NULL;
}

/* Patches with the flag of transparent surfaces, with layers (below 0) or
 * without, are sheets. */
static void mark_sheets(struct vg_read *r, const struct vg_aflr *a)
{
  struct vg_mesh *m = &r->surface;

  for (size_t i = 0; i < a->n; i++) {
    const int32_t flag = a->patch[i].flag;
    const size_t at = vg_mesh_find_patch(m, a->patch[i].id);

    if (flag == VG_AFLR_NONE || abs(flag) < 4 || abs(flag) > 6 ||
        at == SIZE_MAX)
      continue;
    m->patch[at].is_sheet = 1;
    vg_note(r->notes,
            "patch %d is a sheet by the flag %d of the .surf, unless a list or "
            "the table `patches` gives it another role",
            (int)a->patch[i].id, (int)flag);
  }
}

/* Heights are looked up by coordinates, since repairs renumber points. */
static vg_status take_heights(struct vg_read *r, const struct vg_mesh *m,
                              const struct vg_aflr *a, struct vg_error *err)
{
  r->heights.item = vg_alloc(a->n_point, sizeof *r->heights.item);
  if (!r->heights.item) return vg_fail_memory(err, "the heights of a .surf");
  for (size_t i = 0; i < a->n_point; i++) {
    struct vg_point_height *to = &r->heights.item[r->heights.n];

    if (!(a->spacing[i] > 0)) continue;
    for (int k = 0; k < 3; k++) to->x[k] = vg_units_of_file(r, m->point[i][k]);
    to->first = vg_units_of_file(r, a->spacing[i]);
    to->friction = -1;
    r->heights.n++;
  }
  vg_point_heights_sort(&r->heights);
  return VG_OK;
}

vg_status vg_read_surf_settings(struct vg_read *r, struct vg_error *err)
{
  const char *path = r->files.surface;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_aflr a = VG_AFLR_INIT;
  size_t len = strlen(path);
  vg_status st = VG_OK;

  if (len > 3 && !strcasecmp(path + len - 3, ".gz")) len -= 3;
  if (len < 5 || strncasecmp(path + len - 5, ".surf", 5) || *r->files.front ||
      *r->files.d3m)
    return VG_OK;
  VG_TRY(vg_aflr_surf_read(path, &m, &a, err));
  mark_sheets(r, &a);
  if (a.spacing && r->settings.layer.from_files)
    st = take_heights(r, &m, &a, err);
done:
  vg_mesh_release(&m);
  vg_aflr_release(&a);
  return st;
}
