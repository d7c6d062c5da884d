/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/patch_words.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "core/mesh/zones.h"

#define TAIL 12 /* length of "_-2147483648" */

struct named {
  char name[VG_PATCH_WORD];
  size_t patch;
};

static void clean_name(const struct vg_patch *p, char name[VG_PATCH_WORD])
{
  size_t n = 0;

  if (!isalpha((unsigned char)p->name[0]) && p->name[0] != '_')
    n = (size_t)sprintf(name, p->name[0] ? "patch_" : "patch_%d", p->id);
  for (const char *s = p->name; *s; s++) {
    unsigned char c = (unsigned char)*s;

    name[n++] = c < 128 && (isalnum(c) || strchr("_-.", c)) ? *s : '_';
  }
  name[n] = 0;
}

static int by_name(const void *a, const void *b)
{
  const struct named *p = a, *q = b;
  int order = strcmp(p->name, q->name);

  return order ? order : (p->patch > q->patch) - (p->patch < q->patch);
}

static void make_unique(const struct vg_mesh *m, struct named *list,
                        size_t most)
{
  size_t cut = most - TAIL < VG_NAME_MAX - 1 ? most - TAIL : VG_NAME_MAX - 1;
  int again = 1;

  for (int turn = 0; again && turn < 8; turn++) {
    qsort(list, m->n_patch, sizeof *list, by_name);
    again = 0;
    for (size_t i = 1, first = 0; i < m->n_patch; i++) {
      char *name = list[i].name;

      if (strcmp(list[first].name, name)) {
        first = i;
        continue;
      }
      again = 1;
      name[cut] = 0;
      sprintf(name + strlen(name), "_%d", m->patch[list[i].patch].id);
    }
  }
}

char (*vg_patch_words(const struct vg_mesh *m, size_t most))[VG_PATCH_WORD]
{
  assert(most >= 24 && most <= VG_PATCH_WORD_MOST);

  struct named *list = vg_alloc(m->n_patch, sizeof *list);
  char(*name)[VG_PATCH_WORD] = vg_alloc(m->n_patch, sizeof *name);

  if (list && name) {
    for (size_t i = 0; i < m->n_patch; i++) {
      list[i].patch = i;
      clean_name(m->patch + i, list[i].name);
      list[i].name[most] = 0;
    }
    make_unique(m, list, most);
    for (size_t i = 0; i < m->n_patch; i++)
      memcpy(name[list[i].patch], list[i].name, sizeof *name);
  } else {
    free(name);
    name = NULL;
  }
  free(list);
  return name;
}

void vg_patch_free_word(const char (*used)[VG_PATCH_WORD], size_t n,
                        const char *word, char out[VG_PATCH_WORD])
{
  assert(word && strlen(word) < VG_NAME_MAX && out);

  snprintf(out, VG_PATCH_WORD, "%s", word);
  for (size_t turn = 1, i = 0; i < n; i++)
    if (!strcasecmp(used[i], out)) {
      snprintf(out, VG_PATCH_WORD, "%s_%zu", word, turn++);
      i = SIZE_MAX; /* compare with all again */
    }
}

char (*vg_zone_words(const struct vg_mesh *m, size_t most))[VG_PATCH_WORD]
{
  struct vg_mesh zones = { .n_patch = m->n_zone };
  char(*word)[VG_PATCH_WORD];

  zones.patch = vg_calloc(m->n_zone, sizeof *zones.patch);
  if (!zones.patch) return NULL;
  for (size_t z = 0; z < m->n_zone; z++) {
    struct vg_patch *p = &zones.patch[z];

    p->id = m->zone[z].id;
    vg_zone_name(&m->zone[z], p->name);
  }
  word = vg_patch_words(&zones, most);
  free(zones.patch);
  return word;
}
