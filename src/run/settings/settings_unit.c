/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths with units in all settings. Declared in run/settings/settings.h. */
#include <stdint.h>
#include <string.h>

#include "io/cad/cad.h"
#include "run/settings/length.h"
#include "run/settings/settings.h"

int vg_param_is_length(const struct vg_param *p)
{
  return p->type == VG_PARAM_REAL && !strcmp(p->unit, "length");
}

int vg_settings_unit(const struct vg_settings *s)
{
  return s->cad.unit != VG_CAD_UNIT_FILE ? s->cad.unit : s->cad.file_unit;
}

/* Called for each length with a unit, until it returns 1. */
typedef int visit(void *user, const struct vg_param *p, double *value);

static int walk_values(const struct vg_param *p, size_t n, void *base,
                       visit *call, void *user)
{
  for (size_t i = 0; i < n; i++) {
    double *value = (double *)(void *)((char *)base + p[i].offset);

    if (vg_param_is_length(&p[i]) && vg_length_has_unit(*value) &&
        call(user, &p[i], value))
      return 1;
  }
  return 0;
}

static void walk(struct vg_settings *s, visit *call, void *user)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  if (walk_values(p, n, s, call, user)) return;
  for (int k = 0; k < VG_TABLE_N; k++) {
    const enum vg_table_kind kind = (enum vg_table_kind)k;
    const struct vg_setting_table *t = vg_settings_table(kind);

    for (size_t i = 0; i < vg_settings_rows(s, kind); i++)
      if (walk_values(t->column, t->n_column,
                      (void *)(uintptr_t)vg_settings_row(s, kind, i), call,
                      user))
        return;
  }
}

struct found {
  const struct vg_param *p;
  double value;
};

static int take_first(void *user, const struct vg_param *p, double *value)
{
  struct found *f = user;

  *f = (struct found){ p, *value };
  return 1;
}

const struct vg_param *vg_settings_find_unit(const struct vg_settings *s,
                                             double *value)
{
  struct found f = { NULL, 0 };

  walk((struct vg_settings *)(uintptr_t)s, take_first, &f);
  *value = f.value;
  return f.p;
}

static int convert(void *user, const struct vg_param *p, double *value)
{
  (void)p;
  *value = vg_length_in(*value, *(const int *)user);
  return 0;
}

void vg_settings_convert(struct vg_settings *s, int unit)
{
  walk(s, convert, &unit);
}
