/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/http/fields.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/stream.h"

void vg_fields_release(struct vg_fields *f)
{
  for (size_t i = 0; i < f->n; i++) {
    free(f->item[i].name);
    free(f->item[i].value);
  }
  free(f->item);
  memset(f, 0, sizeof *f);
}

static vg_status begin(struct vg_fields *f, const char *name,
                       struct vg_error *err)
{
  struct vg_form_field one = { NULL, NULL, 0 };

  if (f->n == VG_FIELDS_MAX)
    return vg_fail(err, VG_ERR_INPUT, "the form has more than %d fields",
                   VG_FIELDS_MAX);
  one.name = strdup(name);
  one.value = vg_calloc(1, 1);
  if (!one.name || !one.value ||
      vg_reserve(&f->item, &f->cap, f->n + 1, sizeof *f->item)) {
    free(one.name);
    free(one.value);
    return vg_fail_memory(err, "a form");
  }
  f->item[f->n++] = one;
  return VG_OK;
}

vg_status vg_fields_put(struct vg_fields *f, const char *name, const char *data,
                        size_t offset, size_t size, struct vg_error *err)
{
  struct vg_form_field *at;
  size_t more = size + (offset ? 0 : strlen(name));
  char *longer;

  if (more > VG_FIELDS_BYTES - f->bytes)
    return vg_fail(err, VG_ERR_INPUT, "the form has more than %d bytes",
                   VG_FIELDS_BYTES);
  if (size && memchr(data, 0, size))
    return vg_fail(err, VG_ERR_INPUT, "the form contains a zero byte");
  if (!offset && begin(f, name, err) < 0) return VG_ERR_INPUT;
  at = f->n ? &f->item[f->n - 1] : NULL;
  if (!at || strcmp(at->name, name) != 0 || at->size != offset)
    return vg_fail(err, VG_ERR_INPUT,
                   "the pieces of the form are inconsistent");
  longer = vg_realloc(at->value, offset + size + 1, 1);
  if (!longer) return vg_fail_memory(err, "a form");
  at->value = longer;
  if (size) memcpy(longer + offset, data, size);
  longer[offset + size] = 0;
  at->size = offset + size;
  f->bytes += more;
  return VG_OK;
}

const char *vg_fields_get(const struct vg_fields *f, const char *name)
{
  for (size_t i = 0; i < f->n; i++)
    if (!strcmp(f->item[i].name, name)) return f->item[i].value;
  return NULL;
}

const char *vg_fields_text(const struct vg_fields *f, const char *name)
{
  const char *value = vg_fields_get(f, name);

  return value ? value : "";
}

vg_status vg_fields_count(const struct vg_fields *f, const char *name,
                          const char *what, int lo, int hi, int otherwise,
                          int *out, struct vg_error *err)
{
  const char *text = vg_fields_text(f, name);
  int64_t v = otherwise;

  if (*text && (!vg_parse_int(text, strlen(text), &v) || v < lo || v > hi))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s must be an integer from %d to %d, not "
                   "'%.40s'",
                   what, lo, hi, text);
  *out = (int)v;
  return VG_OK;
}
