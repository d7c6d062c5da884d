/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/resolved.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/flow/flow.h"
#include "layers/columns/growth_law.h"
#include "layers/expand/join.h"

struct vg_layer_row vg_settings_layer_row(const struct vg_settings *s,
                                          int32_t id)
{
  struct vg_layer_row row;

  for (size_t i = 0; i < s->n_layer; i++)
    if (s->layer_row[i].id == id) return s->layer_row[i];
  vg_settings_row_default(VG_TABLE_LAYERS, &row);
  row.id = id;
  return row;
}

struct vg_layer_row vg_settings_layer_row_like(const struct vg_settings *s,
                                               int32_t id, int32_t like)
{
  struct vg_layer_row row;

  for (size_t i = 0; i < s->n_layer; i++)
    if (s->layer_row[i].id == id) return s->layer_row[i];
  row = vg_settings_layer_row(s, like);
  row.id = id;
  return row;
}

double vg_settings_first(const struct vg_layer_settings *l, double first,
                         double y_plus)
{
  if (first > 0) return first;
  return y_plus > 0 && l->reynolds > 0
         ? vg_first_height(y_plus, l->reynolds, l->length)
         : 0;
}

/* Replace values that are not given by their defaults. */
static void resolve_mach(struct vg_farfield_row *f)
{
  const struct vg_farfield plain = VG_FARFIELD_INIT;

  if (isnan(f->upstream)) f->upstream = plain.extent.upstream;
  if (isnan(f->downstream)) f->downstream = plain.extent.downstream;
  if (isnan(f->radial)) f->radial = plain.extent.radial;
  for (int k = 0; k < 3; k++)
    if (isnan(f->flow[k])) f->flow[k] = plain.extent.flow[k];
}

void vg_resolve_flow(struct vg_settings *s, int flow, int axis)
{
  assert(axis >= -1 && axis < 3);
  if (flow == VG_FLOW_UNKNOWN) return;
  if (s->farfield.kind == VG_DOMAIN_AUTO)
    s->farfield.kind = flow == VG_FLOW_EXTERNAL ? VG_DOMAIN_SPHERE
                                                : VG_DOMAIN_NONE;
  if (s->farfield.kind == VG_DOMAIN_MACH) resolve_mach(&s->farfield);
  s->flow = flow;
  s->half = axis < 0 ? VG_HALF_NO : (int)VG_HALF_X + axis;
}

void vg_resolve_write(const struct vg_settings *s, char write[VG_WRITE_MAX])
{
  snprintf(write, VG_WRITE_MAX, "%s",
           strcmp(s->write, "auto") != 0 ? s->write
           : s->cells != VG_LAYER_TETS   ? "b8.ugrid"
                                         : "cogsg,b8.ugrid");
}

/* Replace the rows of the table `patches`. */
static vg_status replace_patches(struct vg_settings *s,
                                 const struct vg_decisions *d,
                                 struct vg_error *err)
{
  vg_status st = VG_OK;

  s->n_patch = 0;
  for (size_t i = 0; i < d->n_patch && st >= 0; i++)
    st = vg_settings_add(s, VG_TABLE_PATCHES, &d->patch[i], err);
  return st;
}

/* Adds a patch to the list slip. */
static vg_status add_slip(struct vg_layer_settings *l, int32_t id,
                          struct vg_error *err)
{
  size_t at = strlen(l->slip);
  int n = snprintf(l->slip + at, sizeof l->slip - at, at ? ",%d" : "%d",
                   (int)id);

  if (n > 0 && (size_t)n < sizeof l->slip - at) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the layers of walls continue over more than %zu patches; "
                 "join some of the patches, or set grow no for them in the "
                 "table layers",
                 at / 2);
}

/* Replace y+ by heights, unless a solution corrects them, and lists and
 * conditions by a row for each patch; these lead to the same layers. Patches
 * over which layers continue are in the list slip, so that a second run finds
 * them again. */
static vg_status resolve_layers(const struct vg_settings *read,
                                const struct vg_decisions *d,
                                struct vg_settings *s, struct vg_error *err)
{
  struct vg_layer_settings *l = &s->layer;
  vg_status st = VG_OK;

  if (!d->has_layers) {
    l->grow = VG_ANSWER_NO;
    *l->first_from = 0;
    return VG_OK;
  }
  s->n_layer = 0;
  *l->walls = *l->slip = 0;
  for (size_t i = 0; i < d->n_grows && st >= 0; i++) {
    struct vg_layer_row row = vg_settings_layer_row_like(read, d->grows[i].id,
                                                         d->grows[i].like);

    if (d->grows[i].is_extended) {
      st = add_slip(l, d->grows[i].id, err);
      continue;
    }
    row.grow = d->grows[i].grows ? VG_ANSWER_YES : VG_ANSWER_NO;
    st = vg_settings_add(s, VG_TABLE_LAYERS, &row, err);
  }
  l->grow = VG_ANSWER_YES;
  if (!*l->first_from) {
    l->first = vg_settings_first(l, l->first, l->y_plus);
    l->y_plus = 0;
  }
  l->cap = isnan(l->cap) ? VG_LAYER_CAP : l->cap;
  return st;
}

static int answer(int is_yes)
{
  return is_yes ? VG_ANSWER_YES : VG_ANSWER_NO;
}

vg_status vg_resolve_nothing(const struct vg_settings *read,
                             struct vg_resolved *out, struct vg_error *err)
{
  vg_status st = vg_settings_copy(&out->settings, read, err);

  if (st >= 0) vg_resolve_write(read, out->settings.write);
  return st;
}

vg_status vg_resolve(const struct vg_settings *read,
                     const struct vg_decisions *decided,
                     struct vg_resolved *out, struct vg_error *err)
{
  struct vg_resolved r = VG_RESOLVED_INIT;
  struct vg_settings *s = &r.settings;
  vg_status st;

  assert((decided->patch || !decided->n_patch) && out);
  assert(decided->grows || !decided->n_grows);
  VG_TRY(vg_resolve_nothing(read, &r, err));
  s->remesh = answer(decided->is_remeshed);
  s->swap = answer(decided->is_swapped);
  vg_resolve_flow(s, decided->flow, decided->axis);
  VG_TRY(replace_patches(s, decided, err));
  VG_TRY(resolve_layers(read, decided, s, err));
  *out = r;
  return VG_OK;
done:
  vg_resolved_release(&r);
  return st;
}

void vg_resolved_release(struct vg_resolved *r)
{
  vg_settings_release(&r->settings);
}
