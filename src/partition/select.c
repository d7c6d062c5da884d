#include "partition/select.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/hilbert.h"

enum { RUN = 64 };           /* faces to a box */

vg_status vg_select_open(struct vg_select *s, const struct vg_front *front,
                         const struct vg_sizing *sizing, struct vg_error *err)
{
  s->front = front;
  s->sizing = sizing;
  s->n_box = (front->n_face + RUN - 1) / RUN;
  s->box = vg_alloc(s->n_box, sizeof *s->box);
  s->local = vg_alloc(front->n_point, sizeof *s->local);
  if (!s->box || !s->local) {
    vg_select_close(s);
    return vg_fail_memory(err, "cutting a front");
  }
  memset(s->local, 0xff, front->n_point * sizeof *s->local);
  for (size_t i = 0; i < front->n_face; i++)
    for (int j = 0; j < 3; j++) {
      struct vg_select_box *b = &s->box[i / RUN];
      const double *x = front->x[front->face[i][j]];

      for (int k = 0; k < 3; k++) {
        if ((i % RUN == 0 && j == 0) || x[k] < b->lo[k]) b->lo[k] = x[k];
        if ((i % RUN == 0 && j == 0) || x[k] > b->hi[k]) b->hi[k] = x[k];
      }
    }
  return VG_OK;
}

void vg_select_close(struct vg_select *s)
{
  free(s->box);
  free(s->local);
  memset(s, 0, sizeof *s);
}

/* Faces that the region needs into *face; the number of them. */
static vg_status list_faces(const struct vg_select *s,
                            const struct vg_region *r, uint32_t **face,
                            size_t *n, struct vg_error *err)
{
  const struct vg_front *f = s->front;
  size_t cap = 0;

  *face = NULL;
  *n = 0;
  for (size_t b = 0; b < s->n_box; b++) {
    size_t end = (b + 1) * RUN < f->n_face ? (b + 1) * RUN : f->n_face;

    if (!vg_region_meets_box(r, s->sizing, s->box[b].lo, s->box[b].hi,
                             VG_BAND_FRONT))
      continue;
    if (vg_reserve(face, &cap, *n + RUN, sizeof **face)) {
      free(*face);
      *face = NULL;
      return vg_fail_memory(err, "cutting a front");
    }
    for (size_t i = b * RUN; i < end; i++)
      if (vg_region_may_meet(r, s->sizing, f->x[f->face[i][0]],
                             f->x[f->face[i][1]], f->x[f->face[i][2]],
                             VG_BAND_FRONT))
        (*face)[(*n)++] = (uint32_t)i;
  }
  return VG_OK;
}

/* Points of the listed faces, numbered as they come. */
static void number_points(struct vg_select *s, size_t n, const uint32_t *face,
                          struct vg_front *part, uint32_t *point)
{
  const struct vg_front *f = s->front;

  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = f->face[face[i]][k];

      if (s->local[p] == UINT32_MAX) {
        point[part->n_point] = p;
        memcpy(part->x[part->n_point], f->x[p], sizeof *part->x);
        part->name[part->n_point] = f->name[p];
        s->local[p] = (uint32_t)part->n_point++;
      }
      part->face[i][k] = s->local[p];
    }
  part->n_face = n;
  for (size_t i = 0; i < part->n_point; i++) s->local[point[i]] = UINT32_MAX;
}

vg_status vg_select_part(struct vg_select *s, const struct vg_region *region,
                         struct vg_front *part, uint32_t **point,
                         uint32_t **face, struct vg_error *err)
{
  size_t n;
  vg_status st;

  memset(part, 0, sizeof *part);
  *point = NULL;
  st = list_faces(s, region, face, &n, err);
  if (st < 0) return st;
  part->x = vg_alloc(3 * n, sizeof *part->x);
  part->name = vg_alloc(3 * n, sizeof *part->name);
  part->face = vg_alloc(n, sizeof *part->face);
  *point = vg_alloc(3 * n, sizeof **point);
  if (!part->x || !part->name || !part->face || !*point) {
    vg_front_release(part);
    free(*point);
    free(*face);
    *point = *face = NULL;
    return vg_fail_memory(err, "cutting a front");
  }
  number_points(s, n, *face, part, *point);
  return VG_OK;
}

vg_status vg_select_sort(struct vg_front *f, struct vg_error *err)
{
  double (*middle)[3] = vg_alloc(f->n_face, sizeof *middle);
  uint32_t *order = vg_alloc(f->n_face, sizeof *order);
  uint32_t (*face)[3] = vg_alloc(f->n_face, sizeof *face);
  vg_status st = VG_OK;

  if (!middle || !order || !face) {
    st = vg_fail_memory(err, "ordering a front");
    goto done;
  }
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++)
      middle[i][k] = (f->x[f->face[i][0]][k] + f->x[f->face[i][1]][k] +
                      f->x[f->face[i][2]][k]) / 3;
  VG_TRY(vg_hilbert_order(f->n_face, (const double (*)[3])middle, order,
                          err));
  for (size_t i = 0; i < f->n_face; i++)
    memcpy(face[i], f->face[order[i]], sizeof *face);
  free(f->face);
  f->face = face;
  face = NULL;
done:
  free(middle);
  free(order);
  free(face);
  return st;
}
