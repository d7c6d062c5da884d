/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks for contradictory settings and table rows. Declared in
 * run/settings/settings.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/flow/flow.h"
#include "layers/columns/growth_law.h"
#include "run/settings/settings.h"
#include "run/settings/surface_table.h"
#include "run/settings/periodic_table.h"
#include "run/settings/wake_table.h"

/* The word for the kind of the farfield, the first column of its table. */
static const char *kind_name(const struct vg_farfield_row *f)
{
  return vg_settings_table(VG_TABLE_FARFIELD)->column[0].words[f->kind];
}

static int n_given(const double v[3])
{
  return !isnan(v[0]) + !isnan(v[1]) + !isnan(v[2]);
}

static int compare_id(const void *a, const void *b)
{
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;

  return (x > y) - (x < y);
}

/* Rows of both tables begin with the patch number. Names are compared once the
 * surface is known. */
static vg_status check_numbers(const struct vg_settings *s,
                               enum vg_table_kind kind, struct vg_error *err)
{
  size_t n = vg_settings_rows(s, kind);
  int32_t *id = vg_alloc(n, sizeof *id), twice = 0;
  int found = 0;

  if (!id) return vg_fail_memory(err, "the patch table");
  for (size_t i = 0; i < n; i++)
    memcpy(&id[i], vg_settings_row(s, kind, i), sizeof *id);
  qsort(id, n, sizeof *id, compare_id);
  for (size_t i = 1; i < n && !found; i++)
    if (id[i] == id[i - 1] && id[i] != VG_BC_NONE) found = 1, twice = id[i];
  free(id);
  if (!found) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: patch %d is listed twice; "
                 "remove one of its lines",
                 vg_settings_table(kind)->name, (int)twice);
}

static vg_status check_layer_rows(const struct vg_settings *s,
                                  struct vg_error *err)
{
  char who[2 * VG_NAME_MAX + 4];

  for (size_t i = 0; i < s->n_layer; i++) {
    const struct vg_layer_row *r = &s->layer_row[i];

    vg_param_format(&vg_settings_table(VG_TABLE_LAYERS)->column[0], r, who,
                    sizeof who);
    if (!isnan(r->first) && !isnan(r->y_plus))
      return vg_fail(err, VG_ERR_INPUT,
                     "layers: patch %s has both first and "
                     "y_plus; give one",
                     who);
    if (!isnan(r->ratio) && (!isnan(r->rate1) || !isnan(r->rate2)))
      return vg_fail(err, VG_ERR_INPUT,
                     "layers: patch %s has both ratio and "
                     "rates; give one",
                     who);
    if (!isnan(r->y_plus) && !(s->layer.reynolds > 0))
      return vg_fail(err, VG_ERR_INPUT,
                     "layers: patch %s has y_plus, which "
                     "requires reynolds and reference_length",
                     who);
    if (!isnan(r->cap) && r->cap > 0 && r->cap < 1)
      return vg_fail(err, VG_ERR_INPUT,
                     "layers: cap of patch %s is %g; it "
                     "must be at least 1, or 0 for none",
                     who, r->cap);
  }
  return s->n_layer ? check_numbers(s, VG_TABLE_LAYERS, err) : VG_OK;
}

/* A solution corrects the heights of y_plus, and no others. */
static vg_status check_first_from(const struct vg_layer_settings *l,
                                  struct vg_error *err)
{
  if (!*l->first_from) return VG_OK;
  if (l->grow == VG_ANSWER_NO)
    return vg_fail(err, VG_ERR_INPUT,
                   "first_from is given, but layers is no; remove one of them");
  if (l->first > 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "first and first_from are both given; remove first, and "
                   "give y_plus, which first_from reaches, or remove "
                   "first_from");
  if (l->by_source)
    return vg_fail(err, VG_ERR_INPUT,
                   "layer_sources and first_from are both given; set "
                   "layer_sources to no or remove first_from");
  if (!(l->y_plus > 0) || !(l->reynolds > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "first_from requires y_plus, reynolds and "
                   "reference_length");
  return VG_OK;
}

static vg_status check_layers(const struct vg_settings *s, struct vg_error *err)
{
  const struct vg_layer_settings *l = &s->layer;
  double first = l->y_plus > 0 && l->reynolds > 0 && l->length > 0
                 ? vg_first_height(l->y_plus, l->reynolds, l->length)
                 : l->first;

  if (l->first > 0 && l->y_plus > 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "first and y_plus are both given; give "
                   "one");
  if (!isnan(l->ratio) && (!isnan(l->rate1) || !isnan(l->rate2)))
    return vg_fail(err, VG_ERR_INPUT,
                   "ratio and rates are both given; give "
                   "one (ratio is 1 + rate1)");
  if ((l->reynolds > 0) != (l->length > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "reynolds and reference_length must be given "
                   "together; give both or neither");
  if (l->y_plus > 0 && !(l->reynolds > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "y_plus requires reynolds and "
                   "reference_length");
  if (!isnan(l->cap) && l->cap > 0 && l->cap < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "layer_cap is %g; it must be at least "
                   "1, or 0 for none",
                   l->cap);
  if (l->total > 0 && first > l->total)
    return vg_fail(err, VG_ERR_INPUT,
                   "the first height, %g, exceeds "
                   "layer_total, %g: there is no room for a layer; reduce the "
                   "first height or increase layer_total",
                   first, l->total);
  if (check_first_from(l, err) < 0) return VG_ERR_INPUT;
  return check_layer_rows(s, err);
}

static vg_status check_sources(const struct vg_settings *s,
                               struct vg_error *err)
{
  for (size_t i = 0; i < s->n_source; i++) {
    const struct vg_source *a = &s->source[i];

    if (a->growth != 0 && !(a->growth > 1))
      return vg_fail(err, VG_ERR_INPUT,
                     "sources: growth of source %zu is %g; "
                     "it must be above 1, or 0 for the global growth",
                     i + 1, a->growth);
    if (a->mach != 0 && !(a->mach > 1))
      return vg_fail(err, VG_ERR_INPUT,
                     "sources: mach of source %zu is %g; it must be above 1, "
                     "or 0 for that of the farfield",
                     i + 1, a->mach);
  }
  return VG_OK;
}

/* Kind mach needs a Mach number; its other columns belong to it alone. */
static vg_status check_mach(const struct vg_farfield_row *f,
                            struct vg_error *err)
{
  const double own[4] = { f->mach, f->upstream, f->downstream, f->radial };
  static const char *const name[4] = { "mach", "upstream", "downstream",
                                       "radial" };
  struct vg_farfield_row plain;
  int flow = n_given(f->flow);

  vg_settings_row_default(VG_TABLE_FARFIELD, &plain);
  if (f->kind == VG_DOMAIN_MACH && isnan(f->mach))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: kind mach requires the Mach number of the flow "
                   "(column mach, option --farfield-mach)");
  for (int i = 0; i < 4 && f->kind != VG_DOMAIN_MACH; i++)
    if (!isnan(own[i]))
      return vg_fail(err, VG_ERR_INPUT,
                     "farfield: %s is given, but kind is %s; set kind to mach",
                     name[i], kind_name(f));
  if (flow && f->kind != VG_DOMAIN_MACH)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: the direction ux uy uz is given, but kind is "
                   "%s; set kind to mach",
                   kind_name(f));
  if (flow % 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: ux, uy and uz must be given together; give all "
                   "three or none");
  if (f->kind == VG_DOMAIN_MACH &&
      (f->size != plain.size || f->lengths != plain.lengths))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: %s has no effect with kind mach; set radial, in "
                   "body lengths",
                   f->size != plain.size ? "size" : "lengths");
  return VG_OK;
}

static vg_status check(const struct vg_settings *s, struct vg_error *err)
{
  const struct vg_farfield_row *f = &s->farfield;
  int centre = n_given(f->centre), lo = n_given(f->lo), hi = n_given(f->hi);

  if (s->flow == VG_FLOW_INTERNAL && f->kind > VG_DOMAIN_NONE)
    return vg_fail(err, VG_ERR_INPUT,
                   "flow is internal, but farfield is %s; "
                   "remove one of the two",
                   kind_name(f));
  if (s->flow == VG_FLOW_EXTERNAL && f->kind == VG_DOMAIN_NONE)
    return vg_fail(err, VG_ERR_INPUT,
                   "flow is external, but farfield is none; "
                   "remove one of the two");
  if (s->constant_direction && !s->split_direction)
    return vg_fail(err, VG_ERR_INPUT,
                   "constant_direction requires a "
                   "split_direction of 1, 2 or 3");
  if (s->coarsening != 0 && s->coarsening < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "coarsening is %g; it must be at least 1, or 0 to "
                   "derive it from the number of subdomains",
                   s->coarsening);
  if (s->hmin > 0 && s->hmax > 0 && s->hmin > s->hmax)
    return vg_fail(err, VG_ERR_INPUT,
                   "hmin %g is larger than hmax %g; "
                   "swap them or set one to 0",
                   s->hmin, s->hmax);
  if (centre % 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: x, y and z must be given together; "
                   "give all three or none");
  if (lo != hi || lo % 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: the corners xlo ylo zlo and "
                   "xhi yhi zhi must be given together; give all six or none");
  for (int k = 0; lo && k < 3; k++)
    if (!(f->lo[k] < f->hi[k]))
      return vg_fail(err, VG_ERR_INPUT,
                     "farfield: in %c the lower corner must be "
                     "below the upper corner",
                     "xyz"[k]);
  if (lo && f->kind != VG_DOMAIN_BOX && f->kind != VG_DOMAIN_TUNNEL)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield: corners are given, but kind "
                   "is %s; set kind to box or tunnel",
                   kind_name(f));
  if (check_mach(f, err) < 0) return VG_ERR_INPUT;
  if (check_sources(s, err) < 0) return VG_ERR_INPUT;
  if (vg_surface_rows_check(s, err) < 0) return VG_ERR_INPUT;
  if (vg_wake_rows_check(s, err) < 0) return VG_ERR_INPUT;
  if (vg_periodic_rows_check(s, err) < 0) return VG_ERR_INPUT;
  if (s->n_patch && check_numbers(s, VG_TABLE_PATCHES, err) < 0)
    return VG_ERR_INPUT;
  return check_layers(s, err);
}

vg_status vg_settings_check(const struct vg_settings *s, struct vg_error *err)
{
  const int unit = vg_settings_unit(s);
  struct vg_settings copy = VG_SETTINGS_INIT;
  double value;
  vg_status st;

  if (!vg_settings_find_unit(s, &value)) return check(s, err);
  if (!unit) return VG_OK;
  st = vg_settings_copy(&copy, s, err);
  if (st < 0) return st;
  vg_settings_convert(&copy, unit);
  st = check(&copy, err);
  vg_settings_release(&copy);
  return st;
}
