/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The settings of a run as lines of "name=value", kept next to run.txt so that
 * a refusal can list the differences. No decision depends on them. */
#define _GNU_SOURCE
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "partition/store/store_parts.h"

#define SETTINGS "run.settings"
enum { SETTINGS_MAX = 1 << 20 };

vg_status vg_store_write_settings(const struct vg_store *s, const char *text,
                                  struct vg_error *err)
{
  int fd = openat(s->fd, SETTINGS, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC,
                  0666);
  int error = fd < 0 ? errno : 0;
  char reason[64];

  if (!error && text) error = vg_store_put(fd, text, strlen(text));
  if (fd >= 0 && close(fd) && !error && errno != EINTR) error = errno;
  if (!error) return VG_OK;
  return vg_fail(err, VG_ERR_IO,
                 "%s: the run directory cannot be written: "
                 "%s; choose another one",
                 s->dir, strerror_r(error, reason, sizeof reason));
}

void vg_store_remove_settings(const struct vg_store *s)
{
  unlinkat(s->fd, SETTINGS, 0);
}

/* Returns NULL if there are no settings or they cannot be read. */
static char *read_settings(const struct vg_store *s)
{
  int fd = openat(s->fd, SETTINGS, O_RDONLY | O_CLOEXEC);
  off_t n = fd < 0 ? -1 : lseek(fd, 0, SEEK_END);
  char *text = NULL;

  if (n >= 0 && n < SETTINGS_MAX && lseek(fd, 0, SEEK_SET) == 0)
    text = vg_alloc((size_t)n + 1, 1);
  if (text && vg_store_get(fd, text, (size_t)n)) {
    free(text);
    text = NULL;
  }
  if (text) text[n] = 0;
  if (fd >= 0) close(fd);
  return text;
}

/* Finds the setting that starts at `line` in another text. Returns its value
 * and length, or NULL if it is absent. */
static const char *value_in(const char *text, const char *line, size_t name,
                            size_t *n)
{
  for (; text && *text; text = strchr(text, '\n')) {
    text += *text == '\n';
    if (strncmp(text, line, name) || text[name] != '=') continue;
    *n = strcspn(text + name + 1, "\n");
    return text + name + 1;
  }
  return NULL;
}

struct list {
  char *at;
  size_t size;
  int more;
};

static void add(struct list *to, size_t n_name, const char *name, size_t n_was,
                const char *was, size_t n_is, const char *is)
{
  enum { SHOWN = 60 };
  int n;

  if (to->more) {
    to->more++;
    return;
  }
  n = snprintf(to->at, to->size, "%.*s was %.*s, is %.*s; ", (int)n_name, name,
               n_was < SHOWN ? (int)n_was : SHOWN, was,
               n_is < SHOWN ? (int)n_is : SHOWN, is);
  if ((size_t)n >= to->size) {
    *to->at = 0;
    to->more = 1;
  } else {
    to->at += n;
    to->size -= (size_t)n;
  }
}

void vg_store_compare_settings(const struct vg_store *s, const char *ours,
                               char *out, size_t size)
{
  assert(out && size >= 64);

  struct list to = { out, size - 32, 0 };
  char *there = read_settings(s);

  *out = 0;
  for (const char *line = ours; there && line && *line;) {
    size_t n = strcspn(line, "\n"), name = strcspn(line, "=\n"), n_was = 0;
    const char *was = value_in(there, line, name, &n_was);

    if (name < n && !was)
      add(&to, name, line, 9, "not known", n - name - 1, line + name + 1);
    else if (name < n &&
             (n_was != n - name - 1 || strncmp(was, line + name + 1, n_was)))
      add(&to, name, line, n_was, was, n - name - 1, line + name + 1);
    line += n + (line[n] == '\n');
  }
  if (to.more) snprintf(to.at, 32, "and %d more; ", to.more);
  free(there);
}
