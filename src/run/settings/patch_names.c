/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/settings/patch_names.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "io/stream/stream.h"
#include "run/settings/names.h"

#define SHOWN_PATCHES 30

/* --- lists --------------------------------------------------------------- */

static int take_number(const char **text, int64_t *out)
{
  size_t sign = **text == '-', n = sign;

  n += strspn(*text + n, "0123456789");
  if (n - sign > 18) return 0;
  if (!vg_parse_int(*text, n, out)) return 0;
  *text += n;
  return 1;
}

static int take_range(const char **text, struct vg_patch_item *item)
{
  if (!take_number(text, &item->from)) return 0;
  item->to = item->from;
  if (**text == '-' && (++*text, !take_number(text, &item->to))) return 0;
  return item->to >= item->from;
}

/* A name up to a separator, or up to the closing quotation mark. */
static int take_name(const char **text, struct vg_patch_item *item)
{
  const char *at = *text;
  int quote = *at == '"' || *at == '\'' ? *at++ : 0;
  size_t n = quote ? strcspn(at, (const char[]){ (char)quote, 0 })
                   : strcspn(at, ", ");

  if (!n || n >= VG_NAME_MAX || (quote && !at[n])) return 0;
  memcpy(item->name, at, n);
  *text = at + n + (quote != 0);
  return 1;
}

int vg_patch_list_next(const char **text, struct vg_patch_item *item)
{
  const char *at = *text + strspn(*text, ", ");
  const char *digit = at + (*at == '-');

  assert(text && *text && item);
  *text = at;
  memset(item, 0, sizeof *item);
  if (!*at) return 0;
  if (!(*digit >= '0' && *digit <= '9' ? take_range(&at, item)
                                       : take_name(&at, item)))
    return 0;
  if (*at && !strchr(", ", *at)) return 0;
  *text = at;
  return 1;
}

vg_status vg_patch_list_check(const char *name, const char *list,
                              struct vg_error *err)
{
  const char *at = list;
  struct vg_patch_item item;

  while (vg_patch_list_next(&at, &item)) continue;
  if (!*at) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: '%s' is not a list of patches; separate numbers, "
                 "ranges and names by commas, as in "
                 "3-12,15,wing*; quote a name that contains blanks or commas "
                 "or begins with a digit",
                 name, list);
}

/* `$` alone also matches before a line feed at the end. */
char *vg_patch_list_pattern(void)
{
#define NUMBER "-?[0-9]{1,18}"
#define OTHER "\\u0000-\\u001f\\u007f"
#define ITEM                                                                   \
  "(?:" NUMBER "(?:-" NUMBER ")?|\"[^\"" OTHER "]{1,79}\"|'[^'" OTHER          \
  "]{1,79}'|(?!-?[0-9])[^, \"'" OTHER "][^, " OTHER "]{0,78})"

  return strdup("^[, ]*(?:" ITEM "(?:[, ]+" ITEM ")*[, ]*)?$(?!\\n)");
}

int vg_patch_name_matches(const char *pattern, const char *name)
{
  const char *star = NULL, *from = NULL;

  while (*name) {
    if (*pattern == '*') {
      star = pattern++;
      from = name;
    } else if (*pattern == '?' || *pattern == *name) {
      pattern++;
      name++;
    } else if (star) {
      pattern = star + 1;
      name = ++from;
    } else {
      return 0;
    }
  }
  while (*pattern == '*') pattern++;
  return !*pattern;
}

/* --- on a surface -------------------------------------------------------- */

void vg_patch_list_text(const struct vg_mesh *m, size_t n, char *text,
                        size_t size)
{
  size_t at = 0, shown = 0;

  assert(n <= m->n_patch && text && size > 0);
  *text = 0;
  for (size_t i = 0; i < n; i++) {
    const struct vg_patch *p = &m->patch[i];
    char bc[24] = "no condition";

    if (vg_patch_is_sheet_back(p)) continue;
    if (shown == SHOWN_PATCHES || at + 60 >= size) {
      snprintf(text + at, size - at, ", ...");
      return;
    }
    if (p->bc != VG_BC_NONE) snprintf(bc, sizeof bc, "bc %d", (int)p->bc);
    at += (size_t)snprintf(text + at, size - at, "%s%d%s%.20s (%s)",
                           shown++ ? ", " : "", (int)p->id, *p->name ? " " : "",
                           p->name, bc);
  }
}

static const char *name_of(const void *mesh, size_t i)
{
  const struct vg_patch *p = &((const struct vg_mesh *)mesh)->patch[i];

  return vg_patch_is_sheet_back(p) ? "" : p->name;
}

static vg_status no_name(const char *what, const char *name,
                         const struct vg_mesh *m, size_t n,
                         struct vg_error *err)
{
  const struct vg_names names = { n, name_of, m };
  char list[600], hint[VG_HINT_SIZE];

  vg_patch_list_text(m, n, list, sizeof list);
  vg_hint_for(name, &names, "", "", hint);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: no patch of the surface is named '%s'%s%s Patches: %s",
                 what, name, *hint ? "; " : ".", hint, list);
}

static vg_status no_number(const char *what, int64_t from, int64_t to,
                           const struct vg_mesh *m, size_t n,
                           struct vg_error *err)
{
  char list[600];

  vg_patch_list_text(m, n, list, sizeof list);
  if (from == to)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the surface has no patch %lld. "
                   "Patches: %s",
                   what, (long long)from, list);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the surface has no patch in the range "
                 "%lld-%lld. Patches: %s",
                 what, (long long)from, (long long)to, list);
}

static vg_status mark(const char *what, const struct vg_patch_item *item,
                      const struct vg_mesh *m, size_t n, uint8_t *on,
                      struct vg_error *err)
{
  int found = 0;

  for (size_t i = 0; i < n; i++) {
    const struct vg_patch *p = &m->patch[i];

    if (vg_patch_is_sheet_back(p) ||
        (*item->name ? !vg_patch_name_matches(item->name, p->name)
                     : p->id < item->from || p->id > item->to))
      continue;
    on[i] = 1;
    found = 1;
  }
  if (found) return VG_OK;
  return *item->name ? no_name(what, item->name, m, n, err)
                     : no_number(what, item->from, item->to, m, n, err);
}

vg_status vg_patch_list_mark(const char *what, const char *list,
                             const struct vg_mesh *m, size_t n, uint8_t *on,
                             struct vg_error *err)
{
  const char *at = list;
  struct vg_patch_item item;
  vg_status st = vg_patch_list_check(what, list, err);

  assert(n <= m->n_patch);
  while (st >= 0 && vg_patch_list_next(&at, &item))
    st = mark(what, &item, m, n, on, err);
  return st;
}

vg_status vg_patch_ref_mark(const char *what, int32_t id, const char *name,
                            const struct vg_mesh *m, size_t n, uint8_t *on,
                            struct vg_error *err)
{
  struct vg_patch_item item = { .from = id, .to = id };

  assert(n <= m->n_patch);
  snprintf(item.name, sizeof item.name, "%s", name);
  return mark(what, &item, m, n, on, err);
}

/* --- rows of tables ------------------------------------------------------ */

/* Pointers to the number and the name in a row of patches or layers. */
struct ref {
  int32_t *id;
  char *name;
};

static struct ref ref_of(enum vg_table_kind kind, void *row)
{
  struct vg_layer_row *l = row;
  struct vg_patch_row *p = row;

  return kind == VG_TABLE_LAYERS ? (struct ref){ &l->id, l->id_name }
                                 : (struct ref){ &p->id, p->id_name };
}

static vg_status is_twice(enum vg_table_kind kind, const struct vg_patch *p,
                          const struct vg_settings *old, size_t a, size_t b,
                          struct vg_error *err)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  char one[2 * VG_NAME_MAX + 4], two[2 * VG_NAME_MAX + 4];

  vg_param_format(&t->column[0], vg_settings_row(old, kind, a), one,
                  sizeof one);
  vg_param_format(&t->column[0], vg_settings_row(old, kind, b), two,
                  sizeof two);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: patch %d%s%s is listed twice, as %s "
                 "and as %s; change or remove one of the lines",
                 t->name, (int)p->id, *p->name ? " " : "", p->name, one, two);
}

static size_t *each_unset(size_t n)
{
  size_t *of = vg_alloc(n, sizeof *of);

  for (size_t i = 0; of && i < n; i++) of[i] = SIZE_MAX;
  return of;
}

static int has_inner_row(const struct vg_settings *s)
{
  for (size_t i = 0; i < s->n_patch; i++)
    if (s->patch[i].role > VG_PATCH_WALL) return 1;
  return 0;
}

/* Whether a name of the table layers may be that of the back of an inner
 * surface, which the surface does not have yet. */
static int may_be_back(enum vg_table_kind kind, const struct vg_settings *s,
                       const char *name, const struct vg_mesh *m)
{
  if (kind != VG_TABLE_LAYERS || !*name) return 0;
  if (!*s->baffles && !*s->sheets && !*s->zone_interfaces && !has_inner_row(s))
    return 0;
  for (size_t k = 0; k < m->n_patch; k++)
    if (m->patch[k].inner || vg_patch_name_matches(name, m->patch[k].name))
      return 0;
  return 1;
}

/* Add row i of `old` to s, once for each patch that its name matches. */
static vg_status resolve_row(struct vg_settings *s, enum vg_table_kind kind,
                             const struct vg_settings *old, size_t i,
                             const struct vg_mesh *m, uint8_t *on, size_t *of,
                             struct vg_error *err)
{
  union {
    struct vg_layer_row l;
    struct vg_patch_row p;
  } row;
  const struct vg_setting_table *t = vg_settings_table(kind);
  struct ref r;
  vg_status st = VG_OK;

  memcpy(&row, vg_settings_row(old, kind, i), t->row_size);
  r = ref_of(kind, &row);
  memset(on, 0, m->n_patch);
  if (may_be_back(kind, old, r.name, m) ||
      (!*r.name && vg_mesh_find_patch(m, *r.id) == SIZE_MAX))
    return vg_settings_add(s, kind, &row, err); /* rejected where it is used */
  VG_TRY(vg_patch_ref_mark(t->name, *r.id, r.name, m, m->n_patch, on, err));
  *r.name = 0;
  for (size_t k = 0; k < m->n_patch; k++) {
    if (!on[k]) continue;
    if (of[k] != SIZE_MAX)
      return is_twice(kind, &m->patch[k], old, of[k], i, err);
    of[k] = i;
    *r.id = m->patch[k].id;
    VG_TRY(vg_settings_add(s, kind, &row, err));
  }
done:
  return st;
}

static int has_names(const struct vg_settings *s)
{
  for (size_t i = 0; i < s->n_patch; i++)
    if (*s->patch[i].id_name) return 1;
  for (size_t i = 0; i < s->n_layer; i++)
    if (*s->layer_row[i].id_name) return 1;
  return 0;
}

static vg_status resolve_table(struct vg_settings *to, enum vg_table_kind kind,
                               const struct vg_settings *old,
                               const struct vg_mesh *m, struct vg_error *err)
{
  size_t *of = each_unset(m->n_patch);
  uint8_t *on = vg_alloc(m->n_patch, 1);
  vg_status st = of && on ? VG_OK : vg_fail_memory(err, "the patch table");

  for (size_t i = 0; st >= 0 && i < vg_settings_rows(old, kind); i++)
    st = resolve_row(to, kind, old, i, m, on, of, err);
  free(of);
  free(on);
  return st;
}

/* Copy the patches of m, with the names that the table `patches` gives. */
static vg_status rename_patches(const struct vg_settings *s,
                                const struct vg_mesh *m, struct vg_mesh *to,
                                struct vg_error *err)
{
  to->patch = vg_alloc(m->n_patch, sizeof *to->patch);
  if (!to->patch) return vg_fail_memory(err, "the patches");
  if (m->n_patch) memcpy(to->patch, m->patch, m->n_patch * sizeof *m->patch);
  to->n_patch = m->n_patch;
  for (size_t i = 0; i < s->n_patch; i++) {
    size_t at = vg_mesh_find_patch(to, s->patch[i].id);

    if (at != SIZE_MAX && *s->patch[i].name)
      snprintf(to->patch[at].name, sizeof to->patch[at].name, "%s",
               s->patch[i].name);
  }
  return VG_OK;
}

vg_status vg_patch_rows_resolve(struct vg_settings *s, const struct vg_mesh *m,
                                struct vg_error *err)
{
  struct vg_settings with = { .n_patch = 0 };
  struct vg_mesh named = VG_MESH_INIT;
  vg_status st;

  if (!has_names(s)) return VG_OK;
  VG_TRY(resolve_table(&with, VG_TABLE_PATCHES, s, m, err));
  VG_TRY(rename_patches(&with, m, &named, err));
  VG_TRY(resolve_table(&with, VG_TABLE_LAYERS, s, &named, err));
  free(s->patch);
  free(s->layer_row);
  s->patch = with.patch;
  s->n_patch = with.n_patch;
  s->cap_patch = with.cap_patch;
  s->layer_row = with.layer_row;
  s->n_layer = with.n_layer;
  s->cap_layer = with.cap_layer;
  with.patch = NULL;
  with.layer_row = NULL;
done:
  free(named.patch);
  vg_settings_release(&with);
  return st;
}
