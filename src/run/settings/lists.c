/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/settings/lists.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/stream/stream.h"

static int is_case(const char *item)
{
  struct vg_foam_options options;

  return vg_foam_word(item, &options);
}

/* Words of the write list that are not suffixes of a mesh format. */
static const char *const own_word[] = { "mapbc", "fun3d.mapbc", "pvtu", "foam",
                                        "foam-ascii" };
#define N_OWN (sizeof own_word / sizeof *own_word)

const char *vg_write_word(size_t i)
{
  return i < N_OWN ? own_word[i] : vg_format_output_suffix(i - N_OWN);
}

static int is_write_word(const char *item)
{
  const char *word;

  for (size_t i = 0; (word = vg_write_word(i)); i++)
    if (!strcmp(word, item)) return 1;
  return 0;
}

static vg_status add_item(const char *name, size_t len, size_t *n,
                          char (*item)[VG_WRITE_NAME], struct vg_error *err)
{
  char *to = item[*n];

  if (!len)
    return vg_fail(err, VG_ERR_INPUT,
                   "write: the list has an empty entry; give formats such as "
                   "b8.ugrid, separated by commas");
  assert(*n < VG_WRITE_ITEMS);
  if (len >= VG_WRITE_NAME)
    return vg_fail(err, VG_ERR_INPUT,
                   "write: '%.*s' is not the name of a format", (int)len, name);
  memcpy(to, name, len);
  to[len] = 0;
  for (size_t i = 0; i < *n; i++)
    if (!strcmp(item[i], to)) return VG_OK;
  for (size_t i = 0; i < *n; i++)
    if (is_case(to) && is_case(item[i]))
      return vg_fail(err, VG_ERR_INPUT,
                     "write: foam, openfoam and foam-ascii write to "
                     "the same folder; give only one of them");
  if (!is_write_word(to))
    return vg_fail(err, VG_ERR_INPUT,
                   "write: unknown format '%s'; known formats are "
                   "cogsg (with bc and mapbc), mapbc, fun3d.mapbc, vtu, "
                   "pvtu, foam, foam-ascii and suffixes such as b8.ugrid, "
                   "lb8.ugrid, ugrid, cgns, su2, zones.su2, msh, fluent.msh, "
                   "meshb",
                   to);
  ++*n;
  return VG_OK;
}

vg_status vg_write_list(const char *list, size_t *n,
                        char (*item)[VG_WRITE_NAME], struct vg_error *err)
{
  vg_status st = VG_OK;
  int has_more;

  assert(*n <= VG_WRITE_ITEMS && item);
  list += strspn(list, " ");
  do {
    size_t len = strcspn(list, ", ");

    st = add_item(list, len, n, item, err);
    list += len;
    list += strspn(list, " ");
    has_more = *list == ',';
    list += has_more;
    list += strspn(list, " ");
  } while (st >= 0 && (has_more || *list));
  return st;
}

vg_status vg_write_list_check(const char *name, const char *list,
                              struct vg_error *err)
{
  char item[VG_WRITE_ITEMS][VG_WRITE_NAME];
  size_t n = 0;

  (void)name;
  return strcmp(list, "auto") ? vg_write_list(list, &n, item, err) : VG_OK;
}

/* `$` alone also matches before a line feed at the end. */
#define END "$(?!\\n)"

char *vg_write_list_pattern(void)
{
  char *text = NULL;
  size_t size;
  FILE *to = vg_text_open(&text, &size);
  const char *word;

  if (!to) return NULL;
  fprintf(to, "^(?:auto| *(?:(?:");
  for (size_t i = 0; (word = vg_write_word(i)); i++) {
    if (i) fputc('|', to);
    for (; *word; word++) fprintf(to, *word == '.' ? "\\%c" : "%c", *word);
  }
  fprintf(to, ")(?: *, *(?!$)| +| *$))+)" END);
  fclose(to);
  return text;
}

char *vg_mesher_name_pattern(void)
{
#define ANY "[^\\u0000-\\u001f\\u007f]*"
  return strdup("^(?:builtin|tetgen|hxt|" ANY "/" ANY ")" END);
}

vg_status vg_mesher_name_check(const char *name, const char *mesher,
                               struct vg_error *err)
{
  static const char *const known[] = { "builtin", "tetgen", "hxt" };

  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (!strcmp(mesher, known[i])) return VG_OK;
  if (strchr(mesher, '/')) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: unknown mesher '%s'; give builtin, "
                 "tetgen, hxt or the path of a plug-in, which contains a '/', "
                 "as in ./mymesher.so",
                 name, mesher);
}
