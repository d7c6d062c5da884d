/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A journal is text: a line with the version, two lines and a count per move
 * ("KIND HAD_OLD INODE LENGTH LENGTH", and both paths, which may contain any
 * character), and "end". */
#define _GNU_SOURCE
#include "run/commit/journal.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

#define FIRST_LINE "vanguard commit 1\n"
#define LAST_LINE "end\n"

void vg_journal_release(struct vg_journal *j)
{
  for (size_t i = 0; i < j->n; i++) {
    free(j->move[i].from);
    free(j->move[i].to);
  }
  free(j->move);
  memset(j, 0, sizeof *j);
}

vg_status vg_journal_add(struct vg_journal *j, enum vg_move_kind kind,
                         const char *from, const char *to, struct vg_error *err)
{
  struct vg_move m = { .kind = kind };

  assert(from && to);
  m.from = strdup(from);
  m.to = strdup(to);
  if (!m.from || !m.to ||
      vg_reserve(&j->move, &j->cap, j->n + 1, sizeof *j->move)) {
    free(m.from);
    free(m.to);
    return vg_fail_memory(err, "the output paths");
  }
  j->move[j->n++] = m;
  return VG_OK;
}

/* --- writing ------------------------------------------------------------- */

static char *text_of(const struct vg_journal *j, size_t *size)
{
  char *text = NULL;
  FILE *f = vg_text_open(&text, size);

  if (!f) return NULL;
  fputs(FIRST_LINE, f);
  for (size_t i = 0; i < j->n; i++) {
    const struct vg_move *m = &j->move[i];

    fprintf(f, "%d %d %llu %zu %zu\n%s\n%s\n", (int)m->kind, m->had_old, m->ino,
            strlen(m->from), strlen(m->to), m->from, m->to);
  }
  fputs(LAST_LINE, f);
  fclose(f);
  return text;
}

/* Returns 0 or errno. */
static int put(int fd, const char *text, size_t n)
{
  while (n) {
    ssize_t m = write(fd, text, n);

    if (m < 0 && errno == EINTR) continue;
    if (m <= 0) return m ? errno : ENOSPC;
    text += m;
    n -= (size_t)m;
  }
  return 0;
}

vg_status vg_journal_write(const struct vg_journal *j, const char *path,
                           struct vg_error *err)
{
  size_t n = 0;
  char *text = text_of(j, &n);
  int fd, why;

  if (!text) return vg_fail_memory(err, "the output paths");
  fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  why = fd < 0 ? errno : put(fd, text, n);
  if (!why && fsync(fd)) why = errno;
  if (fd >= 0 && close(fd) && !why) why = errno;
  free(text);
  if (!why) return VG_OK;
  return vg_fail(err, VG_ERR_IO, "%s: cannot write: %s", path, strerror(why));
}

/* --- reading ------------------------------------------------------------- */

/* The file with a terminating zero; NULL: errno. */
static char *slurp(const char *path, size_t *size)
{
  FILE *f = fopen(path, "re");
  char *text = NULL;
  size_t cap = 0, n = 0, got = 0;
  int is_bad, why;

  if (!f) return NULL;
  do {
    is_bad = vg_reserve(&text, &cap, n + 4097, 1);
    if (!is_bad) n += got = fread(text + n, 1, 4096, f);
  } while (!is_bad && got);
  is_bad |= ferror(f);
  why = errno;
  fclose(f);
  errno = why;
  *size = n;
  if (is_bad) free(text);
  else text[n] = 0;
  return is_bad ? NULL : text;
}

/* Reads one move at *at and advances it. VG_BLOCKED: it is damaged. */
static vg_status parse_move(struct vg_journal *j, char **at, const char *end,
                            struct vg_error *err)
{
  struct vg_move m;
  size_t a, b, left;
  char *from, *to;
  int kind, n = 0;
  vg_status st;

  if (sscanf(*at, "%d %d %llu %zu %zu%n", &kind, &m.had_old, &m.ino, &a, &b,
             &n) != 5 ||
      kind < VG_MOVE_FILE || kind > VG_MOVE_REMOVE || (*at)[n] != '\n')
    return VG_BLOCKED;
  from = *at + n + 1;
  left = (size_t)(end - from);
  if (a > left || b > left || a + b + 2 > left || from[a] != '\n')
    return VG_BLOCKED;
  to = from + a + 1;
  if (to[b] != '\n') return VG_BLOCKED;
  from[a] = to[b] = 0;
  *at = to + b + 1;
  if (strlen(from) != a || strlen(to) != b) return VG_BLOCKED;
  st = vg_journal_add(j, (enum vg_move_kind)kind, from, to, err);
  if (st < 0) return st;
  j->move[j->n - 1].had_old = m.had_old;
  j->move[j->n - 1].ino = m.ino;
  return VG_OK;
}

vg_status vg_journal_read(const char *path, struct vg_journal *j,
                          struct vg_error *err)
{
  size_t n, first = strlen(FIRST_LINE);
  char *text = slurp(path, &n), *at;
  vg_status st = VG_OK;

  assert(!j->n);
  if (!text)
    return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", path,
                   strerror(errno));
  at = text + first;
  if (n < first || memcmp(text, FIRST_LINE, first) != 0) st = VG_BLOCKED;
  while (st == VG_OK && strcmp(at, LAST_LINE) != 0)
    st = parse_move(j, &at, text + n, err);
  free(text);
  if (st == VG_BLOCKED)
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: is damaged, or was written by another version", path);
  if (st < 0) vg_journal_release(j);
  return st;
}
