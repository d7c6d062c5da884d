/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/portal.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/common/process.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/projects.h"

/* --- requests ------------------------------------------------------------ */

static int begin(void *user, struct vg_request *r, struct vg_reply *a)
{
  const char *rest;

  r->is_trusted = vg_gate(user, r, &rest, a);
  return !r->is_trusted;
}

static vg_status file(void *user, struct vg_request *r, const char *name,
                      const char *data, uint64_t offset, size_t size,
                      struct vg_error *err)
{
  const struct vg_portal *p = user;
  const char *rest = "";
  struct vg_upload *u = &r->upload;
  int goes_on = u->fd >= 0 && (offset || !u->size) && !strcmp(u->name, name);
  struct vg_reply a = VG_REPLY_INIT;
  vg_status st = VG_OK;

  if (!vg_gate(p, r, &rest, &a) || strcmp(rest, "/upload") != 0) {
    free(a.body);
    return vg_fail(err, VG_ERR_INPUT,
                   "files can be uploaded by the upload form "
                   "only");
  }
  if (!goes_on)
    st = vg_upload_begin(u, p->root, vg_fields_text(&r->form, "folder"), name,
                         err);
  if (st >= 0 && size)
    st = vg_upload_put(u, data, size, (uint64_t)p->o.max_upload, err);
  return st;
}

static void end(void *user, struct vg_request *r, struct vg_reply *a)
{
  const char *rest;

  if (vg_gate(user, r, &rest, a)) vg_route(user, r, rest, a);
}

/* --- opening ------------------------------------------------------------- */

static vg_status make_token(struct vg_portal *p, struct vg_error *err)
{
  unsigned char bytes[VG_TOKEN_DIGITS / 2];

  if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
    return vg_fail(err, VG_ERR_IO,
                   "cannot obtain random numbers for the "
                   "token: %s",
                   strerror(errno));
  for (size_t i = 0; i < sizeof bytes; i++)
    snprintf(p->token + 2 * i, 3, "%02x", bytes[i]);
  return VG_OK;
}

/* Create and lock the folder of the runs, which must belong to this user. */
static vg_status take_folder(struct vg_portal *p, struct vg_error *err)
{
  char *path = NULL;
  struct stat s;
  vg_status st = VG_OK;

  p->root = realpath(p->o.root, NULL);
  if (!p->root)
    return vg_fail(err, VG_ERR_IO, "%s: %s", p->o.root, strerror(errno));
  if (asprintf(&p->dir, "%s/" VG_RUNS_FOLDER, p->root) < 0) p->dir = NULL;
  if (!p->dir || asprintf(&path, "%s/lock", p->dir) < 0)
    return vg_fail_memory(err, "a path");
  if ((mkdir(p->dir, 0777) && errno != EEXIST) || lstat(p->dir, &s) ||
      !S_ISDIR(s.st_mode))
    st = vg_fail(err, VG_ERR_IO,
                 "%s: cannot create this folder for the runs; give --root a "
                 "folder in which you can write",
                 p->dir);
  else if (s.st_uid != geteuid())
    st = vg_fail(err, VG_ERR_IO,
                 "%s belongs to another user; give --root a "
                 "folder of your own",
                 p->dir);
  if (st >= 0) {
    p->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (p->lock < 0)
      st = vg_fail(err, VG_ERR_IO, "%s: %s", path, strerror(errno));
    else if (flock(p->lock, LOCK_EX | LOCK_NB))
      st = vg_fail(err, VG_ERR_IO,
                   "another portal uses %s; its address is in "
                   "the file portal.url there",
                   p->dir);
  }
  free(path);
  return st;
}

static vg_status add_host(struct vg_portal *p, const char *name,
                          struct vg_error *err)
{
  char *copy = NULL;
  int is_v6 = strchr(name, ':') != NULL;

  if (asprintf(&copy, is_v6 ? "[%s]" : "%s", name) < 0)
    return vg_fail_memory(err, "the name of a host");
  p->host[p->n_host++] = copy;
  return VG_OK;
}

/* The name of this machine is accepted only if the portal listens for other
 * machines. */
static vg_status name_hosts(struct vg_portal *p, struct vg_error *err)
{
  char own[256] = "";
  vg_status st;

  VG_TRY(add_host(p, p->o.host ? p->o.host : "127.0.0.1", err));
  VG_TRY(add_host(p, "localhost", err));
  VG_TRY(add_host(p, "127.0.0.1", err));
  VG_TRY(add_host(p, "::1", err));
  if (p->o.host && !gethostname(own, sizeof own - 1))
    VG_TRY(add_host(p, own, err));
done:
  return st;
}

/* Open a socket that listens on the first address of the host for which this
 * succeeds. */
static vg_status listen_on(const struct vg_portal *p, int *out,
                           struct vg_error *err)
{
  const char *host = p->o.host ? p->o.host : "127.0.0.1";
  struct addrinfo want = { .ai_socktype = SOCK_STREAM,
                           .ai_flags = AI_NUMERICSERV },
                  *list;
  char port[16];
  int fd = -1, on = 1, why, failed = 0;

  snprintf(port, sizeof port, "%d", p->o.port);
  why = getaddrinfo(host, port, &want, &list);
  if (why) return vg_fail(err, VG_ERR_IO, "%s: %s", host, gai_strerror(why));
  for (struct addrinfo *a = list; a && fd < 0; a = a->ai_next) {
    fd = socket(a->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) continue;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (!bind(fd, a->ai_addr, a->ai_addrlen) && !listen(fd, 32)) break;
    failed = errno;
    close(fd);
    fd = -1;
  }
  freeaddrinfo(list);
  if (fd < 0)
    return vg_fail(err, VG_ERR_IO,
                   "cannot listen on port %s of %s: %s; give "
                   "another --port, or 0 for any free port",
                   port, host, strerror(failed));
  *out = fd;
  return VG_OK;
}

static int port_of(int fd)
{
  union {
    struct sockaddr any;
    struct sockaddr_storage room;
  } a;
  socklen_t size = sizeof a;
  char port[16] = "0";

  if (!getsockname(fd, &a.any, &size))
    getnameinfo(&a.any, size, NULL, 0, port, sizeof port, NI_NUMERICSERV);
  return atoi(port);
}

/* Write the address to a file that only the owner can read. */
static vg_status publish(struct vg_portal *p, int port, struct vg_error *err)
{
  int fd;

  if (asprintf(&p->url, "http://%s:%d/%s/", p->host[0], port, p->token) < 0)
    p->url = NULL;
  if (asprintf(&p->url_file, "%s/portal.url", p->dir) < 0) p->url_file = NULL;
  if (!p->url || !p->url_file) return vg_fail_memory(err, "an address");
  unlink(p->url_file);
  fd = open(p->url_file, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
            0600);
  if (fd < 0 || dprintf(fd, "%s\n", p->url) < 0) {
    if (fd >= 0) close(fd);
    return vg_fail(err, VG_ERR_IO, "%s: %s", p->url_file, strerror(errno));
  }
  close(fd);
  return VG_OK;
}

static int has_program(const char *name)
{
  const char *path = getenv("PATH");
  char file[4096];

  for (; path && *path; path += strcspn(path, ":"), path += *path == ':') {
    snprintf(file, sizeof file, "%.*s/%s", (int)strcspn(path, ":"), path, name);
    if (!access(file, X_OK)) return 1;
  }
  return 0;
}

static vg_status open_runs(struct vg_portal *p, struct vg_error *err)
{
  struct vg_serve_runs *r = &p->runs;

  r->o = &p->o;
  r->root = p->root;
  r->dir = strdup(p->dir);
  r->program = p->o.program ? realpath(p->o.program, NULL) : vg_own_path();
  p->has_slurm = has_program("sbatch") && has_program("squeue");
  if (!r->dir) return vg_fail_memory(err, "a path");
  if (!r->program)
    return vg_fail(err, VG_ERR_IO, "%s: %s",
                   p->o.program ? p->o.program : "vanguard", strerror(errno));
  return vg_runs_open(r, err);
}

vg_status vg_portal_open(const struct vg_portal_options *o,
                         struct vg_portal **out, struct vg_error *err)
{
  struct vg_portal *p = vg_calloc(1, sizeof *p);
  int fd = -1;
  vg_status st;

  if (!p) return vg_fail_memory(err, "the portal");
  p->o = *o;
  p->lock = -1;
  p->handler = (struct vg_http_handler){ begin, file, end, p };
  signal(SIGPIPE, SIG_IGN);
  VG_TRY(take_folder(p, err));
  VG_TRY(make_token(p, err));
  VG_TRY(name_hosts(p, err));
  VG_TRY(open_runs(p, err));
  VG_TRY(vg_looks_open(&p->looks, p->dir, err));
  if (o->port >= 0) VG_TRY(listen_on(p, &fd, err));
  VG_TRY(publish(p, fd >= 0 ? port_of(fd) : 0, err));
  st = vg_http_open(fd, &p->handler, &p->http, err);
done:
  if (st < 0) vg_portal_close(p);
  else *out = p;
  return st;
}

const char *vg_portal_url(const struct vg_portal *p)
{
  return p->url;
}

vg_status vg_portal_step(struct vg_portal *p, int milliseconds,
                         struct vg_error *err)
{
  vg_runs_watch(&p->runs);
  vg_looks_watch(&p->looks);
  return vg_http_step(p->http, milliseconds, err);
}

int vg_portal_active(const struct vg_portal *p)
{
  int n = 0;

  for (size_t i = 0; i < p->runs.n; i++) n += vg_run_is_active(p->runs.item[i]);
  return n;
}

vg_status vg_portal_connect(struct vg_portal *p, int fd, struct vg_error *err)
{
  return vg_http_connect(p->http, fd, err);
}

void vg_portal_close(struct vg_portal *p)
{
  if (!p) return;
  vg_http_close(p->http);
  if (p->url_file) unlink(p->url_file);
  if (p->lock >= 0) close(p->lock);
  for (int i = 0; i < p->n_host; i++) free(p->host[i]);
  vg_runs_release(&p->runs);
  vg_looks_release(&p->looks);
  free(p->root);
  free(p->dir);
  free(p->url);
  free(p->url_file);
  free(p);
}
