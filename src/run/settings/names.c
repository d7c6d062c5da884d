/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/names.h"

#include <assert.h>
#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/settings/names_parts.h"

#define PARTS_MAX 8
#define WORD_MAX 70 /* longest word that is compared */

/* --- parts of words ------------------------------------------------------ */

/* Parts with the same meaning in names of settings; "": not significant. */
static const char *const synonym[][2] = {
  { "number", "n" },
  { "num", "n" },
  { "count", "n" },
  { "maximum", "max" },
  { "minimum", "min" },
  { "largest", "max" },
  { "smallest", "min" },
  { "prism", "layer" },
  { "inflation", "layer" },
  { "bl", "layer" },
  { "length", "size" },
  { "spacing", "size" },
  { "thickness", "height" },
  { "element", "cell" },
  { "expansion", "growth" },
  { "stretching", "growth" },
  { "rate", "ratio" },
  { "factor", "ratio" },
  { "initial", "first" },
  { "output", "out" },
  { "directory", "dir" },
  { "folder", "dir" },
  { "processe", "rank" },
  { "processor", "rank" },
  { "proc", "rank" },
  { "cpu", "core" },
  { "of", "" },
  { "the", "" },
  { "boundary", "" },
  { "mesh", "" },
  { "grid", "" },
  { "global", "" },
  { "edge", "" },
};

static int by_text(const void *a, const void *b)
{
  return strcmp(a, b);
}

/* Singular, and the common synonym. */
static const char *meaning(char *part)
{
  size_t n = strlen(part);

  if (n > 3 && part[n - 1] == 's' && part[n - 2] != 's') part[n - 1] = 0;
  for (size_t i = 0; i < sizeof synonym / sizeof *synonym; i++)
    if (!strcmp(part, synonym[i][0])) return synonym[i][1];
  return part;
}

static int begins_part(const char *text, size_t i)
{
  return isupper((unsigned char)text[i]) && i > 0 &&
         !isupper((unsigned char)text[i - 1]);
}

void vg_field_canonical(const char *text, char out[VG_CANONICAL_SIZE])
{
  char part[PARTS_MAX][WORD_MAX + 1], word[WORD_MAX + 1];
  size_t n = 0, len = 0, at = 0, end = strlen(text);

  *out = 0;
  if (end > WORD_MAX) return;
  for (size_t i = 0; i <= end; i++) {
    if ((!isalnum((unsigned char)text[i]) || begins_part(text, i)) && len) {
      word[len] = 0;
      len = 0;
      if (n == PARTS_MAX) return;
      strcpy(part[n], meaning(word));
      n += *part[n] != 0;
    }
    if (isalnum((unsigned char)text[i]))
      word[len++] = (char)tolower((unsigned char)text[i]);
  }
  qsort(part, n, sizeof *part, by_text);
  for (size_t i = 0; i < n; i++)
    if (!i || strcmp(part[i], part[i - 1]) != 0)
      at += (size_t)snprintf(out + at, VG_CANONICAL_SIZE - at, "%s%s",
                             at ? " " : "", part[i]);
}

/* --- distances ----------------------------------------------------------- */

static char folded(char c)
{
  return c == '-' || c == ' ' ? '_' : (char)tolower((unsigned char)c);
}

/* Edit distance with transpositions (optimal string alignment). */
static size_t distance(const char *a, const char *b)
{
  size_t row[3][WORD_MAX + 2], n = strlen(a), m = strlen(b);

  if (n > WORD_MAX || m > WORD_MAX) return SIZE_MAX;
  for (size_t j = 0; j <= m; j++) row[0][j] = j;
  for (size_t i = 1; i <= n; i++) {
    size_t *now = row[i % 3], *up = row[(i + 2) % 3], *two = row[(i + 1) % 3];
    char c = folded(a[i - 1]);

    now[0] = i;
    for (size_t j = 1; j <= m; j++) {
      char d = folded(b[j - 1]);
      size_t best = up[j - 1] + (c != d);

      if (up[j] + 1 < best) best = up[j] + 1;
      if (now[j - 1] + 1 < best) best = now[j - 1] + 1;
      if (i > 1 && j > 1 && c == folded(b[j - 2]) && folded(a[i - 2]) == d &&
          two[j - 2] + 1 < best)
        best = two[j - 2] + 1;
      now[j] = best;
    }
  }
  return row[n % 3][m];
}

/* --- suggestions --------------------------------------------------------- */

static const char *named(const struct vg_names *names, const char *name)
{
  for (size_t i = 0; i < names->n; i++) {
    const char *candidate = names->get(names->user, i);

    if (!distance(name, candidate)) return candidate;
  }
  return NULL;
}

/* Add the name `target` to the suggestion, once, if it is in the list. */
static void add(struct vg_suggestion *s, const struct vg_names *names,
                const char *target)
{
  const char *name = s->n < VG_SUGGESTED_MAX ? named(names, target) : NULL;

  for (size_t i = 0; i < s->n && name; i++)
    if (name == s->name[i]) return;
  if (name) s->name[s->n++] = name;
}

/* Suggest the targets of the nearest word of the field, if it is within `limit`
 * edits. Returns its distance. */
static size_t nearest_field(const char *text, const struct vg_names *names,
                            size_t limit, struct vg_suggestion *out)
{
  char given[VG_CANONICAL_SIZE], known[VG_CANONICAL_SIZE];
  char best[VG_CANONICAL_SIZE] = "";
  const char *word, *target;

  out->n = 0;
  vg_field_canonical(text, given);
  for (size_t i = 0; *given && (word = vg_field_word(i, &target)); i++) {
    size_t d, as_written = distance(text, word);

    vg_field_canonical(word, known);
    d = distance(given, known);
    if (as_written < d) d = as_written;
    if (d > limit || !named(names, target)) continue;
    if (out->n && d == limit && strcmp(known, best) != 0) continue;
    if (d < limit || !out->n) out->n = 0;
    limit = d;
    strcpy(best, known);
    add(out, names, target);
  }
  return limit;
}

/* Greatest number of edits in a misspelling of `text`. */
static size_t edits(const char *text)
{
  size_t n = strlen(text);

  return n < 2 ? 0 : n < 5 ? 1 : (n + 1) / 3;
}

void vg_suggest_field(const char *text, const struct vg_names *names,
                      struct vg_suggestion *out)
{
  assert(text && names && out);
  nearest_field(text, names, 0, out);
}

void vg_suggest(const char *text, const struct vg_names *names,
                struct vg_suggestion *out)
{
  size_t best = SIZE_MAX, limit = strlen(text) < 12 ? 1 : 2;
  const char *near = NULL;
  struct vg_suggestion field;

  vg_suggest_field(text, names, out);
  if (out->n) return;
  for (size_t i = 0; i < names->n; i++) {
    const char *candidate = names->get(names->user, i);
    size_t d = distance(text, candidate);

    if (d < best) best = d, near = candidate;
  }
  if (best > edits(text)) near = NULL;
  if (!near || best > 1) {
    if (near && best <= limit) limit = best - 1;
    nearest_field(text, names, limit, &field);
    if (field.n) {
      *out = field;
      return;
    }
  }
  if (near) *out = (struct vg_suggestion){ .n = 1, .name = { near } };
}

const char *vg_hint(const struct vg_suggestion *s, const char *before,
                    const char *otherwise, char out[VG_HINT_SIZE])
{
  if (!s->n) snprintf(out, VG_HINT_SIZE, "%s", otherwise);
  else if (s->n == 1)
    snprintf(out, VG_HINT_SIZE, "did you mean '%s%.*s'?", before, WORD_MAX,
             s->name[0]);
  else
    snprintf(out, VG_HINT_SIZE, "did you mean '%s%.*s' or '%s%.*s'?", before,
             WORD_MAX, s->name[0], before, WORD_MAX, s->name[1]);
  return out;
}

const char *vg_hint_for(const char *text, const struct vg_names *names,
                        const char *before, const char *otherwise,
                        char out[VG_HINT_SIZE])
{
  struct vg_suggestion s;

  vg_suggest(text, names, &s);
  return vg_hint(&s, before, otherwise, out);
}
