/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Replies other than pages. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/http/inside.h"
#include "cli/serve/portal_parts.h"

/* Policy for files that a run has written: the sandbox gives them an origin of
 * their own, so that scripts in them cannot access the portal; they load no
 * external resources. */
#define BOXED                                                                  \
  "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "             \
  "base-uri 'none'; form-action 'none'; "
static const char page_policy[] = BOXED
  "frame-ancestors 'self'; script-src "
  "'unsafe-inline'; sandbox allow-scripts";
static const char still_policy[] = BOXED "frame-ancestors 'none'; sandbox";

static const struct {
  const char *end, *type, *policy;
} shown[] = {
  { ".report.html", "text/html; charset=utf-8", page_policy },
  { ".svg", "image/svg+xml", still_policy },
  { ".png", "image/png", still_policy },
  { ".log", "text/plain; charset=utf-8", still_policy },
  { ".txt", "text/plain; charset=utf-8", still_policy },
  { ".deck", "text/plain; charset=utf-8", still_policy },
  { ".csv", "text/plain; charset=utf-8", still_policy },
  { ".json", "text/plain; charset=utf-8", still_policy },
  { ".mapbc", "text/plain; charset=utf-8", still_policy },
};

void vg_reply_text(struct vg_reply *a, int status, const char *text)
{
  a->status = status;
  a->type = "text/plain; charset=utf-8";
  free(a->body);
  a->body = NULL;
  if (asprintf(&a->body, "%s\n", text) < 0) a->body = NULL;
  a->size = a->body ? strlen(a->body) : 0;
}

void vg_reply_go(const struct vg_portal *p, struct vg_reply *a, const char *to)
{
  vg_reply_text(a, 303, "See other");
  if (asprintf(&a->location, "/%s/%s", p->token, to) < 0) a->location = NULL;
}

/* File name for the header Content-Disposition, without characters that would
 * end its value. */
static char *plain_name(const char *name)
{
  const char *base = strrchr(name, '/');
  char *copy = strdup(base ? base + 1 : name);

  for (char *c = copy; c && *c; c++)
    if (*c < ' ' || *c == '"' || *c == '\\' || *c == 127) *c = '_';
  return copy;
}

static void choose_type(const char *name, struct vg_reply *a)
{
  size_t n = strlen(name);

  a->type = "application/octet-stream";
  a->policy = still_policy;
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
    size_t m = strlen(shown[i].end);

    if (n < m || strcasecmp(name + n - m, shown[i].end)) continue;
    a->type = shown[i].type;
    a->policy = shown[i].policy;
    a->in_frame = a->policy == page_policy;
    return;
  }
  a->download = plain_name(name);
}

void vg_reply_missing(struct vg_reply *a)
{
  vg_reply_text(a, 404, "Not found.");
}

/* Open a file below a folder; -1: there is no such file. */
static int open_inside(const char *dir, const char *name)
{
  struct vg_error err;
  struct stat s;
  char *real;
  int fd;

  if (!*name || vg_inside(dir, name, &real, &err) < 0) return -1;
  fd = open(real, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  free(real);
  if (fd < 0 || (!fstat(fd, &s) && S_ISREG(s.st_mode))) return fd;
  close(fd);
  return -1;
}

void vg_reply_bytes(const char *dir, const char *name, struct vg_reply *a)
{
  a->fd = open_inside(dir, name);
  a->type = "application/octet-stream";
  a->policy = still_policy;
  if (a->fd < 0) vg_reply_missing(a);
}

void vg_reply_file(const struct vg_serve_run *run, const char *name,
                   struct vg_reply *a)
{
  int fd = open_inside(run->dir, name);

  if (fd < 0) {
    vg_reply_text(a, 404, "This run has no such file.");
    return;
  }
  choose_type(name, a);
  a->fd = fd;
}
