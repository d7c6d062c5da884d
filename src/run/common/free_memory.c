/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/free_memory.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH = 1024 };

/* The first number of a file. Infinite if the file has no number, as in a limit
 * `max`. */
static double number_in(const char *root, const char *folder, const char *name)
{
  char path[3 * PATH];
  double v = INFINITY;
  FILE *f;

  snprintf(path, sizeof path, "%s%s/%s", root, folder, name);
  f = fopen(path, "r");
  if (!f) return INFINITY;
  if (fscanf(f, "%30lf", &v) != 1) v = INFINITY;
  fclose(f);
  return v;
}

/* The number that follows `key` at the beginning of a line; 0: no line has one.
 */
static double number_after(const char *root, const char *folder,
                           const char *name, const char *key)
{
  const size_t n = strlen(key);
  char path[3 * PATH], line[256];
  double v = 0;
  FILE *f;

  snprintf(path, sizeof path, "%s%s/%s", root, folder, name);
  f = fopen(path, "r");
  if (!f) return 0;
  while (v == 0 && fgets(line, sizeof line, f))
    if (!strncmp(line, key, n)) v = strtod(line + n, NULL);
  fclose(f);
  return v;
}

/* Names of the files of a version of control groups. */
struct group {
  const char *mount, *limit, *used, *file_pages;
};

static const struct group version[2] = {
  { "/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
    "total_inactive_file " },
  { "/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file " }
};

/* The least free memory of a group and the groups around it. In a container
 * the path of the group may not exist, but the outermost folder does. */
static double free_in_groups(const char *root, const struct group *g,
                             const char *group)
{
  char folder[2 * PATH];
  double least = INFINITY;
  size_t n = (size_t)snprintf(folder, sizeof folder, "%s%s", g->mount, group);

  while (n < sizeof folder && n >= strlen(g->mount)) {
    const double limit = number_in(root, folder, g->limit);
    const double used = number_in(root, folder, g->used);
    const double pages = number_after(root, folder, "memory.stat",
                                      g->file_pages);

    if (isfinite(limit) && isfinite(used))
      least = fmin(least, fmax(0, limit - used + pages));
    while (n > 0 && folder[--n] != '/') continue;
    folder[n] = 0;
  }
  return least;
}

/* A line is NUMBER:CONTROLLERS:PATH, without controllers in version 2. */
static double free_of_line(const char *root, char *line)
{
  char *list = strchr(line, ':'), *path = list ? strchr(list + 1, ':') : NULL;
  int is_new;

  if (!path) return INFINITY;
  *path++ = 0;
  path[strcspn(path, "\n")] = 0;
  is_new = !strcmp(list, ":");
  if (!is_new && !strstr(list, "memory")) return INFINITY;
  if (!strcmp(path, "/")) *path = 0;
  return free_in_groups(root, &version[is_new], path);
}

double vg_free_memory(const char *root)
{
  char path[2 * PATH], line[PATH];
  double least = 1024 * number_after(root, "/proc", "meminfo", "MemAvailable:");
  FILE *f;

  if (!(least > 0)) least = INFINITY;
  snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
  f = fopen(path, "r");
  while (f && fgets(line, sizeof line, f))
    least = fmin(least, free_of_line(root, line));
  if (f) fclose(f);
  return least;
}

double vg_used_memory(double *heap)
{
  const struct mallinfo2 info = mallinfo2();
  double pages = 0;
  FILE *f = fopen("/proc/self/statm", "r");

  *heap = (double)info.fordblks;
  if (f && fscanf(f, "%*s %30lf", &pages) != 1) pages = 0;
  if (f) fclose(f);
  return fmax(0, pages * (double)sysconf(_SC_PAGESIZE) - *heap);
}
