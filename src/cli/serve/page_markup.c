/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/page_markup.h"

#include <stdlib.h>
#include <string.h>

#include "base/markup.h"
#include "run/common/text.h"

static void put(FILE *to, const char *text, size_t n)
{
  const char *entity = vg_markup_entity(*text);
  unsigned char c = (unsigned char)*text;

  if (n > 1) fwrite(text, 1, n, to);
  else if (!n) fputc('?', to);
  else if (entity) fputs(entity, to);
  else if (c == '\'') fputs("&#39;", to);
  else if ((c < ' ' && c != '\n' && c != '\t') || c == 127) fputc(' ', to);
  else fputc(c, to);
}

void vg_markup(FILE *to, const char *text)
{
  while (*text) {
    size_t n = vg_text_character(text);

    put(to, text, n);
    text += n ? n : 1;
  }
}

void vg_markup_bytes(FILE *to, const char *text, size_t n)
{
  char *copy = strndup(text, n);

  if (copy) vg_markup(to, copy);
  free(copy);
}

void vg_markup_path(FILE *to, const char *path)
{
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "abcdefghijklmnopqrstuvwxyz0123456789-._~/";

  for (; *path; path++) {
    if (strchr(plain, *path)) fputc(*path, to);
    else fprintf(to, "%%%02X", (unsigned)(unsigned char)*path);
  }
}

void vg_markup_attribute(FILE *to, const char *name, const char *value)
{
  fprintf(to, " %s=\"", name);
  vg_markup(to, value);
  fputc('"', to);
}

void vg_markup_size(FILE *to, long long bytes)
{
  static const char *const unit[] = { "kB", "MB", "GB", "TB" };
  double v = (double)bytes / 1000;
  int k = 0;

  if (bytes < 1000) {
    fprintf(to, "%lld B", bytes);
    return;
  }
  for (; v >= 999.5 && k < 3; k++) v /= 1000;
  fprintf(to, v < 9.95 ? "%.1f %s" : "%.0f %s", v, unit[k]);
}
