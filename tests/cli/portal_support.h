/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A portal in a folder of its own, queried over a socket pair instead of a
 * network. Used by tests and the fuzzer. */
#ifndef VG_TESTS_PORTAL_SUPPORT_H
#define VG_TESTS_PORTAL_SUPPORT_H

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/serve/portal.h"

#define PORTAL_SECRET "SECRET-OF-ANOTHER-FOLDER"

/* Maximum length of a response. */
#define PORTAL_ANSWER_MAX (4 << 20)

struct portal_scene {
  char dir[200], root[256];
  struct vg_portal *p;
  const char *token; /* part of the portal's address */
  char *answer;      /* [PORTAL_ANSWER_MAX] */
};

static inline void portal_file(const char *dir, const char *name,
                               const char *text)
{
  char path[1024];
  FILE *f;

  snprintf(path, sizeof path, "%s/%s", dir, name);
  f = fopen(path, "w");
  if (!f || fputs(text, f) < 0 || fclose(f)) {
    fprintf(stderr, "%s cannot be written\n", path);
    abort();
  }
}

static inline int portal_remove(const char *path, const struct stat *s,
                                int type, struct FTW *at)
{
  (void)s, (void)type, (void)at;
  return remove(path);
}

/* Open a portal on dir/root, a folder with a surface and with links to files
 * outside the folder, one of which contains PORTAL_SECRET. The portal never
 * starts a run, because it allows no jobs. */
static inline vg_status portal_scene_open(struct portal_scene *s,
                                          struct vg_error *err)
{
  static const char octahedron[] =
    "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\ng body\n"
    "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
  struct vg_portal_options o = VG_PORTAL_OPTIONS_INIT;
  char path[512];
  vg_status st;

  snprintf(s->dir, sizeof s->dir, "%s/vg_portal.XXXXXX",
           getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (!mkdtemp(s->dir)) abort();
  snprintf(s->root, sizeof s->root, "%s/root", s->dir);
  snprintf(path, sizeof path, "%s/other", s->dir);
  if (mkdir(s->root, 0777) || mkdir(path, 0777)) abort();
  portal_file(path, "secret.obj", PORTAL_SECRET "\n");
  portal_file(s->root, "octa.obj", octahedron);
  snprintf(path, sizeof path, "%s/root/out.obj", s->dir);
  if (symlink("../other/secret.obj", path)) abort();
  snprintf(path, sizeof path, "%s/root/away", s->dir);
  if (symlink("../other", path)) abort();
  o.root = s->root;
  o.port = -1; /* no port: the test passes connections to it */
  o.jobs = 0;
  o.max_upload = 1000;
  st = vg_portal_open(&o, &s->p, err);
  if (st < 0) return st;
  s->token = strchr(vg_portal_url(s->p) + 7, '/') + 1;
  s->answer = malloc(PORTAL_ANSWER_MAX);
  return s->answer ? VG_OK : vg_fail_memory(err, "a test");
}

static inline void portal_scene_close(struct portal_scene *s)
{
  vg_portal_close(s->p);
  free(s->answer);
  nftw(s->dir, portal_remove, 16, FTW_DEPTH | FTW_PHYS);
}

/* Send these bytes and store the portal's complete response in s->answer,
 * terminated by a zero. Returns the length of the response. */
static inline size_t portal_ask(struct portal_scene *s, const char *request,
                                size_t size)
{
  struct vg_error err = VG_ERROR_INIT;
  int fd[2], quiet = 0;
  size_t sent = 0, got = 0;

  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fd))
    abort();
  if (vg_portal_connect(s->p, fd[1], &err) < 0) abort();
  while (quiet < 20) {
    ssize_t n;
    int moved = 0;

    if (sent < size &&
        (n = send(fd[0], request + sent, size - sent, MSG_NOSIGNAL)) > 0) {
      sent += (size_t)n;
      moved = 1;
    }
    if (sent == size) shutdown(fd[0], SHUT_WR);
    if (vg_portal_step(s->p, 0, &err) < 0) abort();
    n = read(fd[0], s->answer + got, PORTAL_ANSWER_MAX - 1 - got);
    if (n == 0 || (n < 0 && errno != EAGAIN)) break;
    if (n > 0) {
      got += (size_t)n;
      moved = 1;
    }
    quiet = moved ? 0 : quiet + 1;
  }
  close(fd[0]);
  vg_portal_step(s->p, 0, &err);
  s->answer[got] = 0;
  return got;
}

#endif
