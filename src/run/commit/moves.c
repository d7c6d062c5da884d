/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The moves of a commit. A move knows from the disk alone how far it is: a new
 * file leaves `new` by rename(2), which replaces the target at once; its old
 * file has had a second name in `old` since before the journal was written, or,
 * without hard links, gets it right before. A new folder changes places with
 * the old one (RENAME_EXCHANGE) and is recognised by its inode. */
#define _GNU_SOURCE
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "run/commit/commit_parts.h"
#include "run/commit/tree.h"

/* Paths of a move: the new file, the target, the replaced file. */
struct paths {
  char *from, *to, *old;
};

static void release(struct paths *p)
{
  free(p->from);
  free(p->to);
  free(p->old);
}

char *vg_commit_path(const char *a, const char *b)
{
  char *path;

  if (*b == '/') return strdup(b);
  return asprintf(&path, "%s/%s", a, b) < 0 ? NULL : path;
}

int vg_path_exists(const char *path)
{
  struct stat s;

  return !lstat(path, &s);
}

static vg_status paths_of(const struct vg_commit *c, size_t i, struct paths *p,
                          struct vg_error *err)
{
  const struct vg_move *m = &c->moves.move[i];

  p->from = vg_commit_path(c->fresh, m->from);
  p->to = vg_commit_path(c->dir, m->to);
  if (asprintf(&p->old, "%s/old/%zu", c->hidden, i) < 0) p->old = NULL;
  if (p->from && p->to && p->old) return VG_OK;
  release(p);
  return vg_fail_memory(err, "the output paths");
}

/* A path as people write it: without the "./" of the current folder. */
static const char *shown(const char *path)
{
  return strncmp(path, "./", 2) ? path : path + 2;
}

static vg_status not_moved(const struct paths *p, int why, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO, "%s: cannot be moved into place: %s",
                 shown(p->to), strerror(why));
}

/* --- before the journal -------------------------------------------------- */

static vg_status refuse_kind(const struct vg_move *m, const struct paths *p,
                             const struct stat *is, struct vg_error *err)
{
  int is_folder = S_ISDIR(is->st_mode);

  if (m->kind == VG_MOVE_FILE && is_folder)
    return vg_fail(err, VG_ERR_IO,
                   "%s: a folder exists where a file must be written; move it, "
                   "or choose another folder",
                   shown(p->to));
  if (m->kind == VG_MOVE_FOLDER && !is_folder)
    return vg_fail(err, VG_ERR_IO,
                   "%s: a file exists where a folder must be written; move it, "
                   "or choose another folder",
                   shown(p->to));
  return VG_OK;
}

/* Hard links may be unknown to the file system, or not permitted for a file of
 * somebody else. */
static int cannot_link(int why)
{
  return why == EPERM || why == ENOSYS || why == EOPNOTSUPP || why == EMLINK ||
         why == EACCES;
}

static vg_status prepare_one(struct vg_move *m, const struct paths *p,
                             struct vg_error *err)
{
  struct stat is;
  vg_status st;

  m->had_old = !lstat(p->to, &is);
  if (!m->had_old && errno != ENOENT) return not_moved(p, errno, err);
  if (m->had_old && (st = refuse_kind(m, p, &is, err)) < 0) return st;
  if (m->kind == VG_MOVE_FOLDER) {
    if (lstat(p->from, &is)) return not_moved(p, errno, err);
    m->ino = is.st_ino;
  }
  if (m->kind == VG_MOVE_FILE && m->had_old && link(p->to, p->old) &&
      !cannot_link(errno))
    return not_moved(p, errno, err);
  return VG_OK;
}

vg_status vg_moves_prepare(struct vg_commit *c, struct vg_error *err)
{
  char *old = vg_commit_path(c->hidden, "old");
  vg_status st = VG_OK;

  if (!old) return vg_fail_memory(err, "the output paths");
  if (mkdir(old, 0777))
    st = vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", old,
                 strerror(errno));
  for (size_t i = 0; i < c->moves.n && st >= 0; i++) {
    struct paths p;

    st = paths_of(c, i, &p, err);
    if (st < 0) break;
    st = prepare_one(&c->moves.move[i], &p, err);
    release(&p);
  }
  if (st >= 0) st = vg_folder_sync(old, err);
  free(old);
  return st;
}

/* --- forward ------------------------------------------------------------- */

static int is_new_folder(const struct vg_move *m, const char *path)
{
  struct stat s;

  return !lstat(path, &s) && s.st_ino == m->ino;
}

/* Gives the old file its place in `old`, on the disk before the new one takes
 * its name. Returns 0, or -1 with errno. */
static int set_aside(const struct paths *p)
{
  char *slash = strrchr(p->old, '/');
  vg_status st;

  if (!vg_path_exists(p->to)) return 0;
  if (rename(p->to, p->old)) return -1;
  *slash = 0;
  st = vg_folder_sync(p->old, NULL);
  *slash = '/';
  return st < 0 ? -1 : 0;
}

static int do_file(const struct vg_move *m, const struct paths *p)
{
  if (!vg_path_exists(p->from)) return 0;
  if (m->had_old && !vg_path_exists(p->old) && set_aside(p)) return -1;
  return rename(p->from, p->to);
}

static int cannot_exchange(int why)
{
  return why == EINVAL || why == ENOSYS || why == EOPNOTSUPP;
}

static int exchange(const struct paths *p)
{
  return renameat2(AT_FDCWD, p->from, AT_FDCWD, p->to, RENAME_EXCHANGE);
}

static int do_folder(const struct vg_move *m, const struct paths *p)
{
  if (is_new_folder(m, p->to) || !vg_path_exists(p->from)) return 0;
  if (m->had_old && !vg_path_exists(p->old) && vg_path_exists(p->to)) {
    if (!exchange(p)) return 0;
    if (!cannot_exchange(errno) || set_aside(p)) return -1;
  }
  return rename(p->from, p->to);
}

static int do_removal(const struct paths *p)
{
  return vg_path_exists(p->old) ? 0 : set_aside(p);
}

vg_status vg_moves_do(const struct vg_commit *c, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->moves.n && st >= 0; i++) {
    const struct vg_move *m = &c->moves.move[i];
    struct paths p;
    int failed;

    st = paths_of(c, i, &p, err);
    if (st < 0) break;
    failed = m->kind == VG_MOVE_FILE   ? do_file(m, &p)
           : m->kind == VG_MOVE_FOLDER ? do_folder(m, &p)
                                       : do_removal(&p);
    if (failed) st = not_moved(&p, errno, err);
    release(&p);
  }
  return st;
}

/* --- backward ------------------------------------------------------------ */

static int undo_file(const struct vg_move *m, const struct paths *p)
{
  if (vg_path_exists(p->old)) return rename(p->old, p->to);
  if (m->had_old || vg_path_exists(p->from)) return 0;
  return unlink(p->to) && errno != ENOENT ? -1 : 0;
}

static int undo_folder(const struct vg_move *m, const struct paths *p)
{
  if (is_new_folder(m, p->to)) {
    if (m->had_old && !vg_path_exists(p->old)) return exchange(p);
    if (rename(p->to, p->from)) return -1;
  }
  return vg_path_exists(p->old) ? rename(p->old, p->to) : 0;
}

static int undo_removal(const struct paths *p)
{
  return vg_path_exists(p->old) ? rename(p->old, p->to) : 0;
}

vg_status vg_moves_undo(const struct vg_commit *c, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = c->moves.n; i-- > 0 && st >= 0;) {
    const struct vg_move *m = &c->moves.move[i];
    struct paths p;
    int failed;

    st = paths_of(c, i, &p, err);
    if (st < 0) break;
    failed = m->kind == VG_MOVE_FILE   ? undo_file(m, &p)
           : m->kind == VG_MOVE_FOLDER ? undo_folder(m, &p)
                                       : undo_removal(&p);
    if (failed)
      st = vg_fail(err, VG_ERR_IO, "%s: cannot be restored: %s", shown(p.to),
                   strerror(errno));
    release(&p);
  }
  return st;
}

/* --- on the disk --------------------------------------------------------- */

/* Turns a path into that of its folder. */
static void cut_name(char *path)
{
  char *slash = strrchr(path, '/');

  assert(slash);
  slash[slash == path] = 0;
}

vg_status vg_moves_sync(const struct vg_commit *c, struct vg_error *err)
{
  char *last = NULL;
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->moves.n && st >= 0; i++) {
    char *folder = vg_commit_path(c->dir, c->moves.move[i].to);

    if (!folder) return free(last), vg_fail_memory(err, "the output paths");
    cut_name(folder);
    if (!last || strcmp(folder, last) != 0) st = vg_folder_sync(folder, err);
    free(last);
    last = folder;
  }
  free(last);
  return st;
}
