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
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "run/commit/commit_parts.h"
#include "run/commit/tree.h"

/* Paths of a move: the new file, the target, the replaced file and its
 * folder. */
struct paths {
  char from[VG_COMMIT_PATH], to[VG_COMMIT_PATH], old[VG_COMMIT_PATH];
  char folder[VG_COMMIT_PATH];
};

void vg_commit_path(const char *a, const char *b, char path[VG_COMMIT_PATH])
{
  snprintf(path, VG_COMMIT_PATH, "%s%s%s", *b == '/' ? "" : a,
           *b == '/' ? "" : "/", b);
}

int vg_path_look(const char *path, struct stat *is)
{
  if (!lstat(path, is)) return 1;
  return errno == ENOENT ? 0 : -1;
}

static void paths_of(const struct vg_commit *c, size_t i, struct paths *p)
{
  const struct vg_move *m = &c->moves.move[i];

  vg_commit_path(c->fresh, m->from, p->from);
  vg_commit_path(c->dir, m->to, p->to);
  vg_commit_path(c->hidden, "old", p->folder);
  snprintf(p->old, sizeof p->old, "%s/old/%zu", c->hidden, i);
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

  m->had_old = vg_path_look(p->to, &is);
  if (m->had_old < 0) return not_moved(p, errno, err);
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
  char old[VG_COMMIT_PATH];
  struct paths p;
  vg_status st = VG_OK;

  vg_commit_path(c->hidden, "old", old);
  if (mkdir(old, 0777))
    return vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", old,
                   strerror(errno));
  for (size_t i = 0; i < c->moves.n && st >= 0; i++) {
    paths_of(c, i, &p);
    st = prepare_one(&c->moves.move[i], &p, err);
  }
  return st < 0 ? st : vg_folder_sync(old, err);
}

/* --- forward ------------------------------------------------------------- */

/* How far a move is. */
struct seen {
  int from, to, old; /* 1: the path exists. */
  int is_new_folder; /* 1: `to` is the new folder. */
};

/* A path that cannot be looked up counts neither as present nor as absent: the
 * next step could destroy the only copy of a file. Returns 0, or -1 with
 * errno. */
static int look(const struct vg_move *m, const struct paths *p,
                struct seen *seen)
{
  struct stat is;

  if ((seen->from = vg_path_look(p->from, &is)) < 0 ||
      (seen->old = vg_path_look(p->old, &is)) < 0 ||
      (seen->to = vg_path_look(p->to, &is)) < 0)
    return -1;
  seen->is_new_folder = seen->to && is.st_ino == m->ino;
  return 0;
}

/* Gives the old file its place in `old`, on the disk before the new one takes
 * its name. Returns 0, or -1 with errno. */
static int set_aside(const struct paths *p, const struct seen *is)
{
  if (!is->to) return 0;
  if (rename(p->to, p->old)) return -1;
  return vg_folder_sync(p->folder, NULL) < 0 ? -1 : 0;
}

static int is_done(const struct vg_move *m, const struct seen *is)
{
  if (m->kind == VG_MOVE_REMOVE) return is->old || !is->to;
  return is->is_new_folder || !is->from;
}

static int do_file(const struct vg_move *m, const struct paths *p,
                   const struct seen *is)
{
  if (is_done(m, is)) return 0;
  if (m->had_old && !is->old && set_aside(p, is)) return -1;
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

static int do_folder(const struct vg_move *m, const struct paths *p,
                     const struct seen *is)
{
  if (is_done(m, is)) return 0;
  if (m->had_old && !is->old && is->to) {
    if (!exchange(p)) return 0;
    if (!cannot_exchange(errno) || set_aside(p, is)) return -1;
  }
  return rename(p->from, p->to);
}

static int do_removal(const struct vg_move *m, const struct paths *p,
                      const struct seen *is)
{
  return is_done(m, is) ? 0 : set_aside(p, is);
}

/* --- backward ------------------------------------------------------------ */

static int undo_file(const struct vg_move *m, const struct paths *p,
                     const struct seen *is)
{
  if (is->old) return rename(p->old, p->to);
  return m->had_old || is->from || !is->to ? 0 : unlink(p->to);
}

static int undo_folder(const struct vg_move *m, const struct paths *p,
                       const struct seen *is)
{
  if (is->is_new_folder) {
    if (m->had_old && !is->old) return exchange(p);
    if (rename(p->to, p->from)) return -1;
  }
  return is->old ? rename(p->old, p->to) : 0;
}

static int undo_removal(const struct vg_move *m, const struct paths *p,
                        const struct seen *is)
{
  (void)m;
  return is->old ? rename(p->old, p->to) : 0;
}

/* --- both ---------------------------------------------------------------- */

typedef int step(const struct vg_move *m, const struct paths *p,
                 const struct seen *is);

static step *const steps[2][3] = {
  { [VG_MOVE_FILE] = do_file,
    [VG_MOVE_FOLDER] = do_folder,
    [VG_MOVE_REMOVE] = do_removal },
  { [VG_MOVE_FILE] = undo_file,
    [VG_MOVE_FOLDER] = undo_folder,
    [VG_MOVE_REMOVE] = undo_removal },
};

static vg_status move_one(const struct vg_commit *c, size_t i, int is_undone,
                          struct vg_error *err)
{
  const struct vg_move *m = &c->moves.move[i];
  struct paths p;
  struct seen is;

  paths_of(c, i, &p);
  if (!look(m, &p, &is) && !steps[is_undone][m->kind](m, &p, &is)) return VG_OK;
  if (!is_undone) return not_moved(&p, errno, err);
  return vg_fail(err, VG_ERR_IO, "%s: cannot be restored: %s", shown(p.to),
                 strerror(errno));
}

int vg_moves_left(const struct vg_commit *c)
{
  int n = 0;

  for (size_t i = 0; i < c->moves.n; i++) {
    struct paths p;
    struct seen is;

    paths_of(c, i, &p);
    if (look(&c->moves.move[i], &p, &is)) return -1;
    n |= !is_done(&c->moves.move[i], &is);
  }
  return n;
}

vg_status vg_moves_do(const struct vg_commit *c, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->moves.n && st >= 0; i++)
    st = move_one(c, i, 0, err);
  return st;
}

vg_status vg_moves_undo(const struct vg_commit *c, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = c->moves.n; i-- > 0 && st >= 0;) st = move_one(c, i, 1, err);
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
  char folder[2][VG_COMMIT_PATH] = { "", "" };
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->moves.n && st >= 0; i++) {
    char *now = folder[i % 2];

    vg_commit_path(c->dir, c->moves.move[i].to, now);
    cut_name(now);
    if (strcmp(now, folder[1 - i % 2]) != 0) st = vg_folder_sync(now, err);
  }
  return st;
}
