/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/commit/commit.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/lock/lock.h"
#include "run/commit/commit_parts.h"
#include "run/commit/tree.h"

#define PREFIX ".vanguard-"

/* Files of the hidden folder. */
#define LOCK "lock"
#define NEW "new"
#define OLD "old"
#define JOURNAL "journal"
#define JOURNAL_PART "journal.part"
#define UNDO "undo"

/* Attempts to make a folder that another process is removing. */
#define ATTEMPTS 1000

static void release(struct vg_commit *c)
{
  free(c->dir);
  free(c->hidden);
  free(c->fresh);
  vg_journal_release(&c->moves);
  memset(c, 0, sizeof *c);
  c->lock = -1;
}

/* Path of a file of the hidden folder. */
static void path_in(const struct vg_commit *c, const char *name,
                    char path[VG_COMMIT_PATH])
{
  vg_commit_path(c->hidden, name, path);
}

/* 1, 0, or -1 with errno. */
static int has(const struct vg_commit *c, const char *name)
{
  char path[VG_COMMIT_PATH];
  struct stat is;

  path_in(c, name, path);
  return vg_path_look(path, &is);
}

static vg_status failed(const struct vg_commit *c, const char *what,
                        struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO, "%s: %s: %s", c->hidden, what,
                 strerror(errno));
}

/* Removes a file or folder of the hidden folder. */
static vg_status drop(const struct vg_commit *c, const char *name,
                      struct vg_error *err)
{
  char path[VG_COMMIT_PATH];

  path_in(c, name, path);
  return vg_tree_remove(path) ? failed(c, "cannot be removed", err) : VG_OK;
}

static vg_status drop_files(const struct vg_commit *c, struct vg_error *err)
{
  vg_status st;

  VG_TRY(drop(c, NEW, err));
  VG_TRY(drop(c, OLD, err));
  st = drop(c, JOURNAL_PART, err);
done:
  return st;
}

static vg_status rename_in(const struct vg_commit *c, const char *from,
                           const char *to, struct vg_error *err)
{
  char a[VG_COMMIT_PATH], b[VG_COMMIT_PATH];

  path_in(c, from, a);
  path_in(c, to, b);
  if (rename(a, b)) return failed(c, "cannot be written", err);
  return vg_folder_sync(c->hidden, err);
}

/* --- the moves ----------------------------------------------------------- */

/* Ends a commit: until the journal is gone from the disk, the files of the
 * hidden folder are needed. */
static vg_status end(struct vg_commit *c, const char *journal,
                     struct vg_error *err)
{
  vg_status st = drop(c, journal, err);

  if (st >= 0) st = vg_folder_sync(c->hidden, err);
  c->is_kept = st < 0;
  return st;
}

static vg_status undo(struct vg_commit *c, struct vg_error *err)
{
  vg_status st;

  c->is_kept = 1;
  VG_TRY(vg_moves_undo(c, err));
  VG_TRY(vg_moves_sync(c, err));
  st = end(c, UNDO, err);
done:
  return st;
}

/* After a failure of a move. With the journal under its other name, a later run
 * does not resume the moves, whose state on the disk is ambiguous from here
 * on. */
static vg_status turn_back(struct vg_commit *c, vg_status st,
                           struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  vg_status back;

  c->is_kept = 1;
  back = rename_in(c, JOURNAL, UNDO, &why);
  if (back >= 0) back = undo(c, &why);
  if (back >= 0) return st;
  if (!err) return st;
  why.text[400] = 0;
  err->text[400] = 0;
  return vg_fail(err, st,
                 "%s; and the earlier files could not be restored: %s; they "
                 "are kept in %s, and the next run that writes to this folder "
                 "tries again",
                 strdupa(err->text), why.text, c->hidden);
}

static vg_status write_journal(struct vg_commit *c, struct vg_error *err)
{
  char path[VG_COMMIT_PATH];
  vg_status st;

  path_in(c, JOURNAL_PART, path);
  VG_TRY(vg_journal_write(&c->moves, path, err));
  VG_TRY(vg_folder_sync(c->hidden, err));
  VG_TRY(rename_in(c, JOURNAL_PART, JOURNAL, err));
  st = vg_folder_sync(c->dir, err);
done:
  return st;
}

/* The disk may still have the journal. */
static vg_status explain_kept(const struct vg_commit *c, vg_status st,
                              struct vg_error *err)
{
  if (!err) return st;
  err->text[600] = 0;
  return vg_fail(err, st,
                 "%s; %s stays, and the next run that writes to this folder "
                 "removes it",
                 strdupa(err->text), c->hidden);
}

vg_status vg_commit_run(struct vg_commit *c, struct vg_error *err)
{
  vg_status st;

  assert(c->hidden && !c->is_kept);
  VG_TRY(vg_commit_sync(c, err));
  VG_TRY(vg_moves_prepare(c, err));
  st = write_journal(c, err);
  if (st < 0) {
    if (has(c, JOURNAL)) end(c, JOURNAL, NULL);
    return c->is_kept ? explain_kept(c, st, err) : st;
  }
  st = vg_moves_do(c, err);
  if (st >= 0) st = vg_moves_sync(c, err);
  if (st < 0) return turn_back(c, st, err);
  end(c, JOURNAL, NULL); /* All files are in place, whether or not it fails. */
done:
  return st;
}

vg_status vg_commit_sync(const struct vg_commit *c, struct vg_error *err)
{
  assert(c->fresh);
  return vg_tree_sync(c->fresh, err);
}

vg_status vg_commit_add(struct vg_commit *c, enum vg_move_kind kind,
                        const char *from, const char *to, struct vg_error *err)
{
  assert(c->hidden && *to);
  return vg_journal_add(&c->moves, kind, from, to, err);
}

/* --- after an interruption ----------------------------------------------- */

struct listener {
  vg_commit_note *note;
  void *user;
};

__attribute__((format(printf, 2, 3))) static void tell(struct listener to,
                                                       const char *format, ...)
{
  char text[1500];
  va_list args;

  if (!to.note) return;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  to.note(to.user, text);
}

static vg_status complete(struct vg_commit *c, struct listener to,
                          struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_moves_sync(c, err));
  VG_TRY(end(c, JOURNAL, err));
  tell(to,
       "%s: a run was interrupted while it moved its files into place; its "
       "%zu moves were completed",
       c->hidden, c->moves.n);
done:
  return st;
}

/* Completes the moves of a process that has ended, or undoes them if one of
 * them fails. If all have been done, that process may have reported success, so
 * they are not undone. */
static vg_status resume_moves(struct vg_commit *c, int is_undone,
                              struct listener to, struct vg_error *err)
{
  char path[VG_COMMIT_PATH];
  int left;
  vg_status st;

  path_in(c, is_undone ? UNDO : JOURNAL, path);
  VG_TRY(vg_journal_read(path, &c->moves, err));
  if (!is_undone) {
    left = vg_moves_left(c);
    if (left < 0) return failed(c, "its files cannot be found", err);
    if (!left || vg_moves_do(c, err) >= 0) return complete(c, to, err);
    VG_TRY(rename_in(c, JOURNAL, UNDO, err));
  }
  VG_TRY(undo(c, err));
  tell(to,
       "%s: a run was interrupted while it moved its files into place; the "
       "files that it had replaced were restored",
       c->hidden);
done:
  return st;
}

/* The hidden folder stays if its journal cannot be resumed, or if it is not
 * known whether it has one. */
static vg_status clear_remains(struct vg_commit *c, struct listener to,
                               struct vg_error *err)
{
  const int is_undone = has(c, UNDO), is_moved = has(c, JOURNAL);
  uint64_t bytes;
  vg_status st;

  c->is_kept = is_undone || is_moved;
  if (is_undone < 0 || is_moved < 0)
    return failed(c, "its journal cannot be read", err);
  if (c->is_kept) {
    VG_TRY(resume_moves(c, is_undone, to, err));
    vg_journal_release(&c->moves);
    st = drop_files(c, err);
  } else {
    bytes = vg_tree_bytes(c->fresh);
    VG_TRY(drop_files(c, err));
    if (bytes)
      tell(to,
           "removed %s (%.1f MB), the incomplete files of a run that was "
           "killed",
           c->hidden, (double)bytes / 1e6);
  }
done:
  return st;
}

/* --- the hidden folder --------------------------------------------------- */

static vg_status set_paths(const char *dir, const char *prefix,
                           const char *name, struct vg_commit *c,
                           struct vg_error *err)
{
  memset(c, 0, sizeof *c);
  c->lock = -1;
  c->dir = strdup(dir);
  if (asprintf(&c->hidden, "%s/%s%s", dir, prefix, name) < 0) c->hidden = NULL;
  if (asprintf(&c->fresh, "%s/%s%s/" NEW, dir, prefix, name) < 0)
    c->fresh = NULL;
  if (c->dir && c->hidden && c->fresh) return VG_OK;
  release(c);
  return vg_fail_memory(err, "the output paths");
}

/* VG_BLOCKED: another process has the lock. VG_ERR_IO: errno. */
static vg_status lock(struct vg_commit *c, int makes, char *holder)
{
  char path[VG_COMMIT_PATH];
  vg_status st = VG_ERR_IO;

  path_in(c, LOCK, path);
  for (int i = 0; i < ATTEMPTS && st == VG_ERR_IO; i++) {
    if (makes && mkdir(c->hidden, 0777) && errno != EEXIST) break;
    st = vg_lock_take(AT_FDCWD, path, &c->lock, holder);
    if (!makes || errno != ENOENT) break;
  }
  return st;
}

static void unlock(struct vg_commit *c)
{
  char path[VG_COMMIT_PATH];

  path_in(c, LOCK, path);
  if (!c->is_kept) {
    vg_lock_drop(AT_FDCWD, path, c->lock);
    rmdir(c->hidden);
  } else close(c->lock);
}

static vg_status is_busy(const struct vg_commit *c, const char *name,
                         const char *holder, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: another run is writing %s.* to this folder (%s); wait "
                 "for its end, or choose another folder (if that process no "
                 "longer exists, remove %s)",
                 c->dir, name, holder, c->hidden);
}

static vg_status cannot_write(const char *dir, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO,
                 "%s: cannot write in this folder: %s; choose another one", dir,
                 strerror(errno));
}

/* Locks the folder and makes it ready for new files. */
static vg_status enter(struct vg_commit *c, const char *name,
                       struct listener to, struct vg_error *err)
{
  char holder[VG_LOCK_HOLDER];
  vg_status st = lock(c, 1, holder);

  if (st == VG_BLOCKED) return is_busy(c, name, holder, err);
  if (st == VG_ERR_IO) {
    st = cannot_write(c->dir, err);
    rmdir(c->hidden); /* Fails unless the folder is new. */
  }
  if (st < 0) return st;
  st = clear_remains(c, to, err);
  if (st >= 0 && mkdir(c->fresh, 0777)) st = cannot_write(c->dir, err);
  if (st < 0) unlock(c);
  return st;
}

vg_status vg_commit_open(const char *dir, const char *name,
                         vg_commit_note *note, void *user,
                         struct vg_commit *out, struct vg_error *err)
{
  struct listener to = { note, user };
  vg_status st = set_paths(dir, PREFIX, name, out, err);

  if (st < 0) return st;
  st = enter(out, name, to, err);
  if (st < 0) release(out);
  return st;
}

void vg_commit_close(struct vg_commit *c)
{
  if (!c->hidden) return;
  if (!c->is_kept) drop_files(c, NULL);
  unlock(c);
  release(c);
}

/* --- other names --------------------------------------------------------- */

static void sweep_one(const char *dir, const char *name, struct listener to)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_commit c;
  char holder[VG_LOCK_HOLDER];
  int is_locked;

  if (set_paths(dir, "", name, &c, NULL) < 0) return;
  is_locked = has(&c, LOCK);
  if (is_locked) {
    vg_status st = is_locked < 0 ? VG_ERR_IO : lock(&c, 0, holder);

    if (st == VG_OK) {
      if (clear_remains(&c, to, &err) < 0) {
        c.is_kept = 1;
        tell(to, "%s of a run that was killed: %s", c.hidden, err.text);
      }
      unlock(&c);
    } else if (st < 0 && errno != ENOENT)
      tell(to,
           "%s may have been left behind by a run that was killed, but its "
           "lock cannot be opened: %s",
           c.hidden, strerror(errno));
  }
  release(&c);
}

static int is_hidden(const struct dirent *entry)
{
  return !strncmp(entry->d_name, PREFIX, strlen(PREFIX));
}

void vg_commit_sweep(const char *dir, const struct vg_commit *own,
                     vg_commit_note *note, void *user)
{
  const char *but = own ? strrchr(own->hidden, '/') + 1 : "";
  struct listener to = { note, user };
  struct dirent **entry = NULL;
  int n = scandir(dir, &entry, is_hidden, alphasort);

  for (int i = 0; i < n; i++) {
    if (strcmp(entry[i]->d_name, but) != 0)
      sweep_one(dir, entry[i]->d_name, to);
    free(entry[i]);
  }
  free(entry);
}
