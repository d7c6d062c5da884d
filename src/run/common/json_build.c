/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/json_build.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "run/common/text.h"

#undef json_dumps

static _Thread_local int is_lost;

int vg_json_kept(int status)
{
  if (status && errno == ENOMEM) is_lost = 1;
  return status;
}

char *vg_json_text(const json_t *o, size_t flags)
{
  return is_lost ? NULL : json_dumps(o, flags);
}

void vg_json_forget(void)
{
  is_lost = 0;
}

int vg_json_dump(const json_t *o, FILE *to, size_t flags)
{
  char *text = vg_json_text(o, flags);
  int status;

  assert(to);
  if (!text) vg_print_lose();
  status = !text || fputs(text, to) == EOF ? -1 : 0;
  free(text);
  return status;
}

double vg_json_number_at(const json_t *o, const char *const *key)
{
  for (; *key; key++) o = json_object_get(o, *key);
  return json_is_number(o) ? json_number_value(o) : NAN;
}
