/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Wraps the surface of a problem. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/volume.h"
#include "core/wrap/wrap.h"
#include "run/common/text.h"
#include "run/input/shape_parts.h"
#include "run/settings/plan_options.h"
#include "run/settings/patch_names.h"

#define LONG 60.0 /* Seconds above which a wrap is announced. */
/* S111: of the input area, and of the bounding box. */
#define ROOM_INSIDE 0.05
#define ROOM_FILL 0.7
/* S112: of the length of the body: larger wraps round off what a user would
 * miss, and are not applied without a request. */
#define FINE_WRAP 0.025

/* asked: [n_patch] 1: `walls` or the table layers names the patch. */
static vg_status find_asked(const struct vg_boundary *b, uint8_t *asked,
                            struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_mesh *m = &b->surface;
  vg_status st;

  VG_TRY(
    vg_patch_list_mark("walls", s->layer.walls, m, m->n_patch, asked, err));
  for (size_t i = 0; i < s->n_layer; i++) {
    const struct vg_layer_row *row = &s->layer_row[i];

    if (row->grow != VG_ANSWER_NO)
      VG_TRY(vg_patch_ref_mark("layers", row->id, row->id_name, m, m->n_patch,
                               asked, err));
  }
done:
  return st;
}

static vg_status check_empty(const struct vg_boundary *b, const uint8_t *empty,
                             const uint8_t *asked, struct vg_error *err)
{
  for (size_t i = 0; i < b->surface.n_patch; i++)
    if (empty[i] && asked[i])
      return vg_fail(err, VG_ERR_INPUT,
                     "wrap: nothing is left of patch %d, although walls or "
                     "the table layers names it: it lies inside other "
                     "patches, or is smaller than the wrap size; remove it "
                     "from the list, or reduce the size",
                     (int)b->surface.patch[i].id);
  return VG_OK;
}

/* A wrap that the program chose may be the outside of a room around bodies. */
static vg_status check_room(const struct vg_boundary *b,
                            const struct vg_wrap_report *r,
                            struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  double lo[3], hi[3], volume, box = 1;

  if (!b->read->is_cured || r->n_kept || !(r->inside > ROOM_INSIDE))
    return VG_OK;
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) box *= hi[k] - lo[k];
  volume = fabs(vg_enclosed6(m->n_tri, (const uint32_t(*)[3])m->tri,
                             (const double(*)[3])m->point, lo)) /
           6;
  if (!(volume > ROOM_FILL * box)) return VG_OK;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%.0f %% of the surface are inside the wrap, which fills %.0f "
                 "%% of its bounding box: it may be a room around bodies",
                 100 * r->inside, 100 * volume / box);
}

static void note_wrap(struct vg_boundary *b, const struct vg_wrap_report *r)
{
  vg_note(b->notes,
          "the surface was wrapped: %zu triangles replaced by %zu; of %zu "
          "points %zu lie on the input, the others about %.3g away; points "
          "merged where two sides meet in an edge: %zu; gaps narrower than %g "
          "were bridged; the farthest point of the wrap is %.3g away, at "
          "(%.6g, %.6g, %.6g); new triangles have the patch of the nearest "
          "input triangle; patches left without triangles: %zu",
          r->n_before, b->surface.n_tri - r->n_kept, r->n_point, r->n_fit,
          r->offset, r->n_zip, b->read->settings.wrap, r->distance, r->at[0],
          r->at[1], r->at[2], r->n_empty);
  vg_note(b->notes,
          "parts of the input that the wrap omits: no point of the input is "
          "farther than %.3g outside the wrap (at %.6g, %.6g, %.6g); %.1f %% "
          "of the input area is inside it, within other parts or behind gaps "
          "narrower than the wrap size",
          r->missing, r->missing_at[0], r->missing_at[1], r->missing_at[2],
          100 * r->inside);
  if (r->sheet > 0)
    vg_note(b->notes,
            "%.1f %% of the wrapped area consists of sheets: they have fluid "
            "on both sides, closer together than %.3g",
            100 * r->sheet, 10 * r->offset);
  if (r->sheet > 0 && r->widest > b->read->settings.wrap)
    vg_note(b->notes,
            "the surface has holes wider than the wrap size, up to %.3g, at "
            "(%.6g, %.6g, %.6g): a part that should be solid may have fluid "
            "inside it (close them with --close-holes yes, or use a larger "
            "wrap size)",
            r->widest, r->widest_at[0], r->widest_at[1], r->widest_at[2]);
  if (r->n_cavity || r->n_crumb)
    vg_note(b->notes,
            "shells of the wrap that were removed: %zu inside it, %zu of "
            "negligible volume",
            r->n_cavity, r->n_crumb);
  if (r->n_kept)
    vg_note(b->notes,
            "triangles of outer boundaries, which were not wrapped: %zu",
            r->n_kept);
}

/* Announces a wrap that takes minutes before it starts. */
static vg_status announce(struct vg_boundary *b,
                          const struct vg_wrap_options *o,
                          struct vg_display *show, struct vg_error *err)
{
  struct vg_wrap_forecast f;
  char stage[80], count[32];
  vg_status st = vg_wrap_foresee(&b->surface, o, &f, err);

  if (st < 0 || f.seconds < LONG) return st;
  vg_text_count((unsigned long long)f.triangles, count);
  snprintf(stage, sizeof stage, "wrap: %s triangles, %d min", count,
           (int)(f.seconds / 60 + 0.5));
  vg_display_update(show, stage, 0, 0);
  vg_note(b->notes,
          "forecast of the wrap: %s triangles, %.0f minutes; doubling the "
          "size reduces both to about a quarter",
          count, f.seconds / 60);
  return VG_OK;
}

static void progress(void *user, size_t done, size_t expected)
{
  vg_display_update(user, "wrap", done, expected);
}

vg_status vg_boundary_wrap(struct vg_boundary *b, const uint8_t *keep,
                           struct vg_display *show, struct vg_error *err)
{
  size_t n = b->surface.n_patch;
  uint8_t *empty = vg_alloc(n, 1), *asked = vg_calloc(n, 1);
  struct vg_wrap_options o = vg_options_wrap(&b->read->settings);
  struct vg_wrap_report r = { 0 };
  vg_status st;

  if (!empty || !asked) VG_TRY(vg_fail_memory(err, "the patches"));
  o.keep = keep;
  o.empty = empty;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  o.progress = progress;
  o.user = show;
  VG_TRY(find_asked(b, asked, err));
  VG_TRY(announce(b, &o, show, err));
  vg_display_update(show, "wrap", 0, 0);
  VG_TRY(vg_wrap(&b->surface, &o, &r, err));
  VG_TRY(check_empty(b, empty, asked, err));
  VG_TRY(check_room(b, &r, err));
  note_wrap(b, &r);
done:
  free(empty);
  free(asked);
  return st;
}

/* The size that a user takes from the message. */
static double as_printed(double wrap)
{
  char text[32];

  snprintf(text, sizeof text, "%.2g", wrap);
  return strtod(text, NULL);
}

void vg_boundary_suggest_wrap(struct vg_boundary *b, struct vg_display *show,
                              char *text, size_t size)
{
  const struct vg_stop stop = { vg_display_stop, show };
  const size_t *n = b->check.count;
  struct vg_error why = VG_ERROR_INIT;
  enum vg_wrap_reason reason;
  double wrap = 0;
  uint32_t far;
  size_t tri;

  *text = 0;
  if (b->remedy != VG_REMEDY_NOW) b->remedy = VG_REMEDY_ASKED;
  if (!b->model.cad && !b->read->settings.wrap && !b->read->settings.weld &&
      vg_boundary_suggest_inner(b, text, size))
    return;
  if (b->remedy != VG_REMEDY_NOW || !vg_wrap_is_available(NULL, 0) ||
      b->read->settings.wrap > 0 || vg_boundary_wants_inner(b) ||
      b->flow.kind == VG_FLOW_INTERNAL || n[VG_DEFECT_NOT_FINITE] ||
      n[VG_DEFECT_NO_BC] == b->check.n_defect)
    return;
  if (vg_wrap_far_point(&b->surface, &far, &tri) > 0) {
    const double *x = b->surface.point[far];

    snprintf(text, size,
             "; point %u (%g, %g, %g) of triangle %zu is far away from all "
             "others: correct it first",
             far + 1, x[0], x[1], x[2], tri + 1);
    return;
  }
  vg_display_update(show, "searching for a wrap size", 0, 0);
  if (vg_wrap_suggest(&b->surface, &stop, &wrap, &reason, &why) < 0) return;
  if (reason == VG_WRAP_SHEETS)
    snprintf(text, size,
             "; it consists of sheets without thickness that bound no body, "
             "so a wrap does not help");
  else
    snprintf(text, size, "; --wrap %.2g puts a closed surface around it%s",
             wrap, reason == VG_WRAP_HOLES ? " and bridges its holes" : "");
  /* Where caps were requested, a wrap would replace what they failed to do. */
  if (reason == VG_WRAP_FITS && !b->read->settings.close_holes &&
      wrap <= FINE_WRAP * vg_boundary_length(b))
    b->cure.wrap = as_printed(wrap);
}
