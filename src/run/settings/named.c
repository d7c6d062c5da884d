/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Access to settings and table rows by name. Declared in
 * run/settings/settings.h. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "run/settings/names.h"
#include "run/settings/settings.h"

/* Columns of the farfield table that are also plain settings, with their
 * names. */
static const struct {
  const char *column, *name, *place;
} farfield_names[] = {
  { "kind", "farfield", "farfield.kind" },
  { "lengths", "farfield_lengths", "farfield.lengths" },
  { "size", "farfield_size", "farfield.size" },
  { "spacing", "farfield_spacing", "farfield.spacing" },
  { "mach", "farfield_mach", "farfield.mach" },
  { "upstream", "farfield_upstream", "farfield.upstream" },
  { "downstream", "farfield_downstream", "farfield.downstream" },
  { "radial", "farfield_radial", "farfield.radial" },
};
#define N_FARFIELD (sizeof farfield_names / sizeof *farfield_names)

static const struct vg_param *column_of(const struct vg_setting_table *t,
                                        const char *name)
{
  for (size_t c = 0; c < t->n_column; c++)
    if (!strcmp(t->column[c].name, name)) return &t->column[c];
  return NULL;
}

const struct vg_param *vg_settings_name(size_t i, const char **name,
                                        int *in_farfield)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  assert(name && in_farfield);
  *in_farfield = i >= n;
  if (i < n) {
    *name = p[i].name;
    return &p[i];
  }
  if (i >= n + N_FARFIELD) return NULL;
  *name = farfield_names[i - n].name;
  return column_of(vg_settings_table(VG_TABLE_FARFIELD),
                   farfield_names[i - n].column);
}

enum vg_use vg_param_use(const struct vg_param *p, int in_farfield)
{
  const struct vg_settings *s = NULL;
  const size_t cad = offsetof(struct vg_settings, cad);
  const size_t layer = offsetof(struct vg_settings, layer);

  if (p->use != VG_USE_BY_PLACE) return p->use;
  if (in_farfield) return VG_USE_FARFIELD;
  if (p->offset >= cad && p->offset < cad + sizeof s->cad) return VG_USE_CAD;
  if (p->offset >= layer && p->offset < layer + sizeof s->layer)
    return VG_USE_LAYERS;
  return VG_USE_ALWAYS;
}

enum vg_topic vg_param_topic(const struct vg_param *p, int in_farfield)
{
  const struct vg_settings *s = NULL;
  const size_t limit = offsetof(struct vg_settings, layer.limit);

  if (p->topic != VG_TOPIC_BY_USE) return p->topic;
  if (in_farfield) return VG_TOPIC_FARFIELD;
  if (p->offset >= limit && p->offset < limit + sizeof s->layer.limit)
    return VG_TOPIC_LIMITS;
  switch (vg_param_use(p, 0)) {
  case VG_USE_CAD: return VG_TOPIC_CAD;
  case VG_USE_REMESH: return VG_TOPIC_REMESH;
  case VG_USE_SECTION: return VG_TOPIC_SECTION;
  case VG_USE_LAYERS: return VG_TOPIC_LAYERS;
  case VG_USE_PLANES:
  case VG_USE_PARTS: return VG_TOPIC_PARALLEL;
  default: return VG_TOPIC_VOLUME;
  }
}

uint8_t *vg_settings_given(const struct vg_settings *s)
{
  char a[2 * VG_LIST_MAX + 4], b[2 * VG_LIST_MAX + 4];
  const struct vg_param *p;
  struct vg_settings plain;
  const char *name;
  uint8_t *given;
  size_t n = 0;
  int far;

  while (vg_settings_name(n, &name, &far)) n++;
  given = vg_calloc(n, 1);
  if (!given) return NULL;
  vg_settings_default(&plain);
  for (size_t i = 0; (p = vg_settings_name(i, &name, &far)); i++) {
    vg_param_format(p, far ? (const void *)&s->farfield : (const void *)s, a,
                    sizeof a);
    vg_param_format(p,
                    far ? (const void *)&plain.farfield : (const void *)&plain,
                    b, sizeof b);
    given[i] = strcmp(a, b) != 0;
  }
  return given;
}

static int same_name(const char *a, const char *b)
{
  while (*a && (*a == *b || (*a == '-' && *b == '_'))) a++, b++;
  return !*a && !*b;
}

static const char *name_at(const void *user, size_t i)
{
  const char *name = "";
  int in_farfield;

  (void)user;
  vg_settings_name(i, &name, &in_farfield);
  return name;
}

void vg_suggest_place(struct vg_suggestion *s)
{
  for (size_t i = 0; i < s->n; i++)
    for (size_t k = 0; k < N_FARFIELD; k++)
      if (!strcmp(s->name[i], farfield_names[k].name))
        s->name[i] = farfield_names[k].place;
}

void vg_suggest_setting(const char *text, struct vg_suggestion *out)
{
  struct vg_names names = { 0, name_at, NULL };
  const char *name;
  int in_farfield;

  while (vg_settings_name(names.n, &name, &in_farfield)) names.n++;
  vg_suggest(text, &names, out);
}

static const struct vg_param *find(const char *name, int *in_farfield,
                                   struct vg_error *err)
{
  struct vg_suggestion near;
  char hint[VG_HINT_SIZE];
  const struct vg_param *p;
  const char *known;

  for (size_t i = 0; (p = vg_settings_name(i, &known, in_farfield)); i++)
    if (same_name(name, known)) return p;
  vg_suggest_setting(name, &near);
  vg_fail(err, VG_ERR_INPUT, "unknown setting '%s'; %s", name,
          vg_hint(&near, "", "'vanguard deck' lists all settings", hint));
  return NULL;
}

vg_status vg_settings_set(struct vg_settings *s, const char *name,
                          const char *text, struct vg_error *err)
{
  int in_farfield;
  const struct vg_param *p = find(name, &in_farfield, err);
  vg_status st;

  if (!p) return VG_ERR_INPUT;
  st = vg_param_set(p, in_farfield ? (void *)&s->farfield : (void *)s, text,
                    strlen(text), err);
  if (st >= 0 && !in_farfield) vg_settings_override(s, p);
  return st;
}

vg_status vg_settings_get(const struct vg_settings *s, const char *name,
                          char *out, size_t size, struct vg_error *err)
{
  int in_farfield;
  const struct vg_param *p = find(name, &in_farfield, err);

  if (!p) return VG_ERR_INPUT;
  vg_param_format(p, in_farfield ? (const void *)&s->farfield : (const void *)s,
                  out, size);
  return VG_OK;
}

/* --- rows ---------------------------------------------------------------- */

static const char *table_name(const void *user, size_t i)
{
  (void)user;
  return vg_settings_table((enum vg_table_kind)i)->name;
}

static const char *column_name(const void *table, size_t i)
{
  return ((const struct vg_setting_table *)table)->column[i].name;
}

static vg_status find_table(const char *name, enum vg_table_kind *kind,
                            struct vg_error *err)
{
  const struct vg_names names = { VG_TABLE_N, table_name, NULL };
  char hint[VG_HINT_SIZE];

  for (int k = 0; k < VG_TABLE_N; k++)
    if (!strcmp(name, vg_settings_table((enum vg_table_kind)k)->name)) {
      *kind = (enum vg_table_kind)k;
      return VG_OK;
    }
  return vg_fail(err, VG_ERR_INPUT, "unknown table '%s'; %s", name,
                 vg_hint_for(name, &names, "",
                             "the tables are farfield, patches, layers, "
                             "surface, sources and sweep",
                             hint));
}

static vg_status set_columns(const struct vg_setting_table *t, void *row,
                             size_t n, const char *const *column,
                             const char *const *value, struct vg_error *err)
{
  const struct vg_names names = { t->n_column, column_name, t };
  struct vg_error why = VG_ERROR_INIT;
  char hint[VG_HINT_SIZE];

  for (size_t i = 0; i < n; i++) {
    const struct vg_param *p = column_of(t, column[i]);

    if (!p)
      return vg_fail(err, VG_ERR_INPUT, "%s: unknown column '%s'; %s", t->name,
                     column[i],
                     vg_hint_for(column[i], &names, "",
                                 "'vanguard deck' lists the columns", hint));
    if (vg_param_set(p, row, value[i], strlen(value[i]), &why) < 0)
      return vg_fail(err, why.code, "%s: %s", t->name, why.text);
  }
  for (size_t c = 0; c < t->n_column; c++) {
    int given = !t->column[c].required;

    for (size_t i = 0; i < n && !given; i++)
      given = !strcmp(column[i], t->column[c].name);
    if (!given)
      return vg_fail(err, VG_ERR_INPUT, "%s: a row needs a value for %s",
                     t->name, t->column[c].name);
  }
  return VG_OK;
}

vg_status vg_settings_add_named(struct vg_settings *s, const char *name,
                                size_t n, const char *const *column,
                                const char *const *value, struct vg_error *err)
{
  enum vg_table_kind kind = VG_TABLE_N;
  void *row = NULL;
  vg_status st;

  VG_TRY(find_table(name, &kind, err));
  row = vg_alloc(1, vg_settings_table(kind)->row_size);
  if (!row) return vg_fail_memory(err, "the settings");
  vg_settings_row_default(kind, row);
  VG_TRY(set_columns(vg_settings_table(kind), row, n, column, value, err));
  st = vg_settings_add(s, kind, row, err);
done:
  free(row);
  return st;
}

vg_status vg_settings_copy(struct vg_settings *to,
                           const struct vg_settings *from, struct vg_error *err)
{
  struct vg_settings s = *from;
  vg_status st = VG_OK;

  assert(to != from && !to->source && !to->patch);
  assert(!to->layer_row && !to->surface_row && !to->wake_row && !to->zone);
  assert(!to->periodic_row);
  s.source = NULL;
  s.patch = NULL;
  s.layer_row = NULL;
  s.surface_row = NULL;
  s.wake_row = NULL;
  s.n_wake = s.cap_wake = 0;
  s.zone = NULL;
  s.periodic_row = NULL;
  s.n_periodic = s.cap_periodic = 0;
  s.n_source = s.cap_source = s.n_patch = s.cap_patch = 0;
  s.n_layer = s.cap_layer = s.n_surface = s.cap_surface = 0;
  s.n_zone = s.cap_zone = 0;
  for (int k = VG_TABLE_PATCHES; k <= VG_TABLE_SOURCES; k++) {
    enum vg_table_kind kind = (enum vg_table_kind)k;

    for (size_t i = 0; i < vg_settings_rows(from, kind); i++)
      VG_TRY(vg_settings_add(&s, kind, vg_settings_row(from, kind, i), err));
  }
  *to = s;
  return VG_OK;
done:
  vg_settings_release(&s);
  return st;
}
