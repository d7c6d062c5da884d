/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/json_file.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

#include "io/stream/stream.h"

static int digits_of(const json_t *o)
{
  int most = 15;
  const char *name;
  json_t *value;
  char text[40];
  size_t i;

  if (json_is_real(o)) {
    double v = json_real_value(o);

    for (; most < 17; most++) {
      snprintf(text, sizeof text, "%.*g", most, v);
      if (strtod(text, NULL) == v) break;
    }
  }
  json_object_foreach((json_t *)o, name, value) if (digits_of(value) > most)
    most = digits_of(value);
  json_array_foreach(o, i, value) if (digits_of(value) > most)
    most = digits_of(value);
  return most;
}

size_t vg_json_digits(const json_t *o)
{
  return JSON_REAL_PRECISION(digits_of(o));
}

vg_status vg_json_write(const char *path, const json_t *o, const char *what,
                        struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *text = json_dumps(o, JSON_INDENT(2) | vg_json_digits(o));
  vg_status st;

  assert(path && what);
  if (!text) return vg_fail_memory(err, what);
  st = vg_output_open(path, &out, err);
  if (st >= 0) {
    vg_output_text(&out, text);
    vg_output_text(&out, "\n");
    st = vg_output_commit(&out, err);
  }
  vg_output_release(&out);
  free(text);
  return st;
}

vg_status vg_json_print(FILE *to, const json_t *o, size_t flags,
                        const char *what, struct vg_error *err)
{
  char *text = json_dumps(o, JSON_INDENT(2) | flags);

  assert(to && what);
  if (!text) return vg_fail_memory(err, what);
  fprintf(to, "%s\n", text);
  free(text);
  return VG_OK;
}
