/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/tell.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STAGE_MAX 30

static int is_stage(const char *text, size_t n)
{
  if (!n || n > STAGE_MAX || !islower((unsigned char)*text)) return 0;
  for (size_t i = 0; i < n; i++)
    if (!islower((unsigned char)text[i]) && text[i] != ' ' && text[i] != '-' &&
        text[i] != ',')
      return 0;
  return 1;
}

static size_t digits(const char *text)
{
  return strspn(text, "0123456789,");
}

/* A line of a sweep: "3 of 12: n2-t1". */
static int sweep_line(const char *line, struct vg_tell *t)
{
  unsigned i, n;
  int at = 0;

  if (sscanf(line, "%9u of %9u: %n", &i, &n, &at) != 2 || !at || !line[at] ||
      !i || i > n)
    return 0;
  snprintf(t->stage, sizeof t->stage, "%s", line + at);
  snprintf(t->count, sizeof t->count, "case %u of %u", i, n);
  t->share = (double)(i - 1) / n;
  return 1;
}

/* The counts after the stage: "12,345 of ~27,000   45%  350,000/s  ETA 20 s".
 * Blanks precede each part, and all parts but the first are optional. */
static int counts(const char *at, struct vg_tell *t)
{
  size_t n;

  at += strspn(at, " ");
  n = digits(at);
  if (!n) return 0;
  snprintf(t->count, sizeof t->count, "%.*s", (int)(n < 30 ? n : 30), at);
  at += n;
  if (!strncmp(at, " of ~", 5)) {
    size_t used = strlen(t->count);
    char *end;

    at += 5;
    n = digits(at);
    snprintf(t->count + used, sizeof t->count - used, " of %.*s",
             (int)(n < 30 ? n : 30), at);
    at += n;
    t->share = strtod(at, &end) / 100;
    if (end == at || *end != '%') return 0;
    if (!(t->share >= 0)) t->share = 0;
    if (t->share > 1) t->share = 1;
    at = end + 1;
  }
  at += strspn(at, " ");
  n = digits(at);
  if (n && !strncmp(at + n, "/s", 2)) {
    snprintf(t->rate, sizeof t->rate, "%.*s", (int)n + 2, at);
    at += n + 2;
  }
  at += strspn(at, " ");
  if (!strncmp(at, "ETA ", 4)) {
    snprintf(t->left, sizeof t->left, "%.20s", at + 4);
    at += strlen(at);
  }
  return !*at;
}

int vg_tell_line(const char *line, size_t n, struct vg_tell *out)
{
  struct vg_tell t = VG_TELL_INIT;
  char text[200];
  size_t stage;

  if (n >= sizeof text) return 0;
  memcpy(text, line, n);
  text[n] = 0;
  if (strlen(text) != n) return 0;
  if (!sweep_line(text, &t)) {
    for (stage = 0; text[stage] && !isdigit((unsigned char)text[stage]);)
      stage++;
    if (text[stage] && !counts(text + stage, &t)) return 0;
    while (stage && text[stage - 1] == ' ') stage--;
    if (!is_stage(text, stage)) return 0;
    snprintf(t.stage, sizeof t.stage, "%.*s", (int)stage, text);
  }
  *out = t;
  return 1;
}

int vg_tell_tail(const char *data, size_t n, int is_cut, struct vg_tell *out)
{
  int found = 0;

  for (size_t at = 0; at < n;) {
    const char *end = memchr(data + at, '\n', n - at);

    if (!end) break;
    if (at || !is_cut)
      found |= vg_tell_line(data + at, (size_t)(end - data) - at, out);
    at = (size_t)(end - data) + 1;
  }
  return found;
}

int vg_tell_status(const char *data, size_t n)
{
  static const char words[] = "\nexit status ";
  const char *found = NULL, *at = data, *end = data + n;
  int status = 0, digits_seen = 0;

  while ((at = memmem(at, (size_t)(end - at), words, sizeof words - 1))) {
    at += sizeof words - 1;
    found = at;
  }
  if (!found) return -1;
  for (; found < end && isdigit((unsigned char)*found) && digits_seen < 3;
       found++, digits_seen++)
    status = 10 * status + (*found - '0');
  return digits_seen && found < end && *found == ' ' ? status : -1;
}
