/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/projects.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/http/inside.h"
#include "io/mesh/format.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/settings/deck.h"

void vg_projects_release(struct vg_projects *p)
{
  for (size_t i = 0; i < p->n; i++) free(p->item[i].name);
  free(p->item);
  memset(p, 0, sizeof *p);
}

int vg_projects_is_name(const char *name)
{
  size_t suffix = vg_format_suffix_length(name), n = strlen(name);
  const char *known;

  if (vg_text_ends(name, ".d3m")) return 1;
  if (!suffix || suffix >= n) return 0;
  for (size_t i = 0; (known = vg_format_input_suffix(i)); i++)
    if (!strcasecmp(known, name + n - suffix + 1)) return 1;
  return 0;
}

/* A .front with a .d3m of the same name belongs to that project. */
static int is_part(const char *path)
{
  size_t n = strlen(path);
  char *d3m;
  int found;

  if (n < 6 || strcmp(path + n - 6, ".front") != 0) return 0;
  if (asprintf(&d3m, "%.*s.d3m", (int)n - 6, path) < 0) return 0;
  found = access(d3m, F_OK) == 0;
  free(d3m);
  return found;
}

static vg_status take_file(const char *root, const char *name, int64_t size,
                           struct vg_projects *p, struct vg_error *err)
{
  struct vg_error why;
  char *real, *copy;
  vg_status st = vg_inside(root, name, &real, &why);
  int is_one;

  if (st < 0) return VG_OK;
  is_one = vg_text_ends(name, ".d3m") ||
           (!vg_format_holds_cells(real) && !is_part(real));
  free(real);
  if (!is_one) return VG_OK;
  if (p->n == VG_PROJECTS_MAX) {
    p->is_cut = 1;
    return VG_OK;
  }
  copy = strdup(name);
  if (!copy || vg_reserve(&p->item, &p->cap, p->n + 1, sizeof *p->item)) {
    free(copy);
    return vg_fail_memory(err, "the projects");
  }
  p->item[p->n].name = copy;
  p->item[p->n++].size = size;
  return VG_OK;
}

/* Folders are opened relative to their parent and never through a link. */
static vg_status look(const char *root, int dir, const char *under, int depth,
                      struct vg_projects *p, struct vg_error *err);

static vg_status inspect_file(const char *root, int dir, const char *under,
                              const char *name, int depth,
                              struct vg_projects *p, struct vg_error *err)
{
  struct stat s;
  char *path;
  vg_status st = VG_OK;
  int fd;

  if (*name == '.' || fstatat(dir, name, &s, AT_SYMLINK_NOFOLLOW)) return VG_OK;
  if (asprintf(&path, "%s%s%s", under, *under ? "/" : "", name) < 0)
    return vg_fail_memory(err, "a path");
  if (S_ISLNK(s.st_mode) && fstatat(dir, name, &s, 0)) s.st_mode = 0;
  else if (S_ISDIR(s.st_mode) && depth < VG_PROJECTS_DEPTH &&
           strcmp(name, VG_RUNS_FOLDER) != 0) {
    fd = openat(dir, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (fd >= 0) st = look(root, fd, path, depth + 1, p, err);
  }
  if (S_ISREG(s.st_mode) && vg_projects_is_name(name))
    st = take_file(root, path, s.st_size, p, err);
  free(path);
  return st;
}

static vg_status look(const char *root, int dir, const char *under, int depth,
                      struct vg_projects *p, struct vg_error *err)
{
  DIR *d = fdopendir(dir);
  struct dirent *e;
  vg_status st = VG_OK;

  if (!d) {
    close(dir);
    return VG_OK;
  }
  while (st >= 0 && (e = readdir(d))) {
    if (p->looked_at++ >= VG_PROJECTS_LOOKED_AT) {
      p->is_cut = 1;
      break;
    }
    st = inspect_file(root, dirfd(d), under, e->d_name, depth, p, err);
  }
  closedir(d);
  return st;
}

static int by_name(const void *a, const void *b)
{
  return strcmp(((const struct vg_project_file *)a)->name,
                ((const struct vg_project_file *)b)->name);
}

vg_status vg_projects_list(const char *root, struct vg_projects *out,
                           struct vg_error *err)
{
  struct vg_projects p = VG_PROJECTS_INIT;
  int fd = open(root, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  vg_status st;

  if (fd < 0)
    return vg_fail(err, VG_ERR_IO, "%s: this folder cannot be read", root);
  st = look(root, fd, "", 0, &p, err);
  if (st < 0) {
    vg_projects_release(&p);
    return st;
  }
  if (p.n) qsort(p.item, p.n, sizeof *p.item, by_name);
  *out = p;
  return VG_OK;
}

/* --- one project --------------------------------------------------------- */

/* A file of a project may not be a link to a file outside the root. */
static vg_status check_inside(const char *root, const char *path,
                              struct vg_error *err)
{
  char *real;
  int ok;

  if (!path || !*path) return VG_OK;
  real = realpath(path, NULL);
  ok = real && vg_inside_holds(root, real);
  free(real);
  if (ok) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%.200s is outside the folder of the "
                 "projects",
                 path);
}

static vg_status check_files(const char *root, const struct vg_input_files *f,
                             struct vg_error *err)
{
  const char *const path[] = { f->d3m,  f->front, f->surface, f->mapbc,
                               f->deck, f->tags,  f->aflr };
  vg_status st = VG_OK;

  for (size_t i = 0; i < sizeof path / sizeof *path && st >= 0; i++)
    st = check_inside(root, path[i], err);
  return st;
}

vg_status vg_project_settings(const char *root, const char *name,
                              const char *deck, struct vg_settings *s,
                              struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  char *real = NULL, *path = NULL;
  size_t n = strlen(name);
  vg_status st;

  VG_TRY(vg_inside(root, name, &real, err));
  if (!vg_projects_is_name(name)) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "'%.100s' is neither a surface nor a "
                 ".d3m",
                 name);
    goto done;
  }
  if (vg_text_ends(name, ".d3m")) n -= 4;
  if (asprintf(&path, "%s/%.*s", root, (int)n, name) < 0) {
    path = NULL;
    st = vg_fail_memory(err, "a path");
    goto done;
  }
  VG_TRY(vg_input_find(path, deck, &p.read.files, err));
  VG_TRY(check_files(root, &p.read.files, err));
  VG_TRY(vg_problem_open_deck(&p, err));
  st = vg_settings_copy(s, &p.asked, err);
done:
  vg_problem_release(&p);
  free(real);
  free(path);
  return st;
}
