/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Draws all pictures of a page in parallel on threads. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "cli/html/page.h"

/* Thinner layers have the colour of fewer layers of the same cause, at half
 * strength. */
static void thinner(struct palette *to)
{
  for (int c = 0; c < VG_CAUSE_N; c++)
    for (int k = 0; k < 3; k++)
      to->rgb[VG_CAUSE_N + c][k] = (uint8_t)((to->rgb[c][k] + 245) / 2);
}

void vg_html_palette(enum by by, struct palette *to)
{
  memset(to, 0, sizeof *to);
  if (by == BY_PATCH) memcpy(to->rgb, vg_patch_colour, sizeof vg_patch_colour);
  else if (by == BY_LEVEL)
    memcpy(to->rgb, vg_level_colour, sizeof vg_level_colour);
  else memcpy(to->rgb, vg_cause_colour, sizeof vg_cause_colour);
  if (by == BY_CAUSE) thinner(to);
  memcpy(to->rgb[GREY], vg_adjacent_colour, sizeof vg_adjacent_colour);
}

/* Twice the area of the symmetry planes projected along y; negative if the
 * fluid is on their side of smaller y. */
static double faces_y(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *n = m->tri[t];
    const double *a = m->point[n[0]], *b = m->point[n[1]], *c = m->point[n[2]];

    if (m->patch[m->tri_patch[t]].bc == 1)
      sum += (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
  }
  return sum;
}

/* Choose views from the front and from behind, on the fluid side of a symmetry
 * plane. */
static vg_status choose_views(struct page *p, struct vg_error *err)
{
  static const double toward[VIEWS][3] = { { -0.62, -0.55, 0.56 },
                                           { 0.66, -0.52, -0.54 } };
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  int is_turned = faces_y(m) > 0;
  uint8_t *seen = vg_alloc(m->n_tri, 1);

  if (!seen) return vg_fail_memory(err, "the pictures");
  for (size_t t = 0; t < m->n_tri; t++) seen[t] = p->body[m->tri_patch[t]];
  for (int k = 0; k < VIEWS; k++) {
    double from[3] = { toward[k][0], toward[k][1], toward[k][2] };

    if (is_turned) from[1] = -from[1];
    vg_camera_aim(m, seen, from, VG_CUT_WIDTH, VG_CUT_HEIGHT, &p->camera[k]);
  }
  free(seen);
  return VG_OK;
}

struct drawing {
  struct page *p;
  struct vg_shot shot[VIEWS];
  vg_status st[PICTURES];
};

static vg_status surface(const struct drawing *d, int k, struct vg_image *to,
                         struct vg_error *err)
{
  enum by by = (enum by)((k - PICTURE_SURFACE) / VIEWS);
  struct palette palette;

  if (by != BY_PATCH && !d->p->has_layers) return VG_BLOCKED;
  vg_html_palette(by, &palette);
  return vg_shot_image(&d->shot[k % VIEWS], d->p->walls.by[by], palette.rgb, to,
                       err);
}

static vg_status cut(const struct drawing *d, int k, struct vg_image *to,
                     struct vg_error *err)
{
  const struct vg_run_pictures *r = &d->p->h->run->pictures;
  size_t i = k < PICTURE_ANGLE ? (size_t)(k - PICTURE_CUT)
           : k == PICTURE_PART ? d->p->part_cut
                               : 0;

  if (i >= r->plan.n) return VG_BLOCKED;
  return vg_cuts_image(r->cuts, i,
                       k == PICTURE_ANGLE  ? VG_CUT_BY_ANGLE
                       : k == PICTURE_PART ? VG_CUT_BY_PART
                                           : VG_CUT_BY_KIND,
                       to, err);
}

/* Draw pictures. Out of memory is the only possible failure; the caller reports
 * it. */
static void draw(void *context, size_t first, size_t end, int worker)
{
  struct drawing *d = context;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    struct vg_image image = VG_IMAGE_INIT;

    d->st[k] = (k < PICTURE_CUT ? surface : cut)(d, (int)k, &image, NULL);
    if (d->st[k] == VG_OK) d->st[k] = vg_image_png(&image, &d->p->png[k], NULL);
    vg_image_release(&image);
  }
}

/* Choose the section of the body that shows the most subdomains: one that runs
 * along a separator would show little else. */
static void choose_part_cut(struct page *p)
{
  const struct vg_run_pictures *r = &p->h->run->pictures;
  size_t most = 0;

  for (size_t i = 0; i < r->plan.n; i++) {
    size_t n = r->plan.view[i] == VG_VIEW_BODY ? vg_cuts_in_parts(r->cuts, i)
                                               : 0;

    if (n <= most) continue;
    most = n;
    p->part_cut = i;
  }
}

vg_status vg_html_draw(struct page *p, struct vg_error *err)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  struct drawing d = { .p = p };
  int threads = p->h->run->threads;
  vg_status st;

  VG_TRY(vg_walls_colour(p, &p->walls, err));
  VG_TRY(choose_views(p, err));
  choose_part_cut(p);
  for (int k = 0; k < VIEWS; k++)
    VG_TRY(vg_shot_take(m, p->walls.is_seen, &p->camera[k], threads, &d.shot[k],
                        err));
  vg_parallel_for(threads, PICTURES, 1, draw, &d);
  for (int k = 0; k < PICTURES && st >= 0; k++)
    if (d.st[k] < 0) st = vg_fail_memory(err, "the pictures");
done:
  for (int k = 0; k < VIEWS; k++) vg_shot_release(&d.shot[k]);
  return st;
}
