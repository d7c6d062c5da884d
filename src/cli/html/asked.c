/* Settings as they were asked for. Declared in cli/html/html.h. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/html/asked.h"

size_t vg_asked_params(const struct vg_settings *s, size_t i,
                       const struct vg_param **param, const void **base)
{
  const struct vg_table *far = vg_settings_table(VG_TABLE_FARFIELD);
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  if (i < n) {
    *param = &p[i];
    *base = s;
  } else if (i < n + far->n_column) {
    *param = &far->column[i - n];
    *base = &s->farfield;
  }
  return n + far->n_column;
}

vg_status vg_asked_take(const struct vg_settings *s, struct vg_asked *a,
                        struct vg_error *err)
{
  const struct vg_param *param;
  const void *base;
  char value[2 * VG_LIST_MAX + 4];
  size_t n = vg_asked_params(s, SIZE_MAX, &param, &base);

  vg_asked_release(a);
  a->value = vg_calloc(n, sizeof *a->value);
  if (!a->value) return vg_fail_memory(err, "the settings");
  a->n = n;
  for (size_t i = 0; i < n; i++) {
    vg_asked_params(s, i, &param, &base);
    vg_param_format(param, base, value, sizeof value);
    a->value[i] = strdup(value);
    if (!a->value[i]) {
      vg_asked_release(a);
      return vg_fail_memory(err, "the settings");
    }
  }
  return VG_OK;
}

void vg_asked_release(struct vg_asked *a)
{
  for (size_t i = 0; i < a->n; i++) free(a->value[i]);
  free(a->value);
  *a = (struct vg_asked)VG_ASKED_INIT;
}
