/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "base/child.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* A message requests one child; the child's socket is sent along with it. */
struct request {
  vg_child_body *body;
  int has_affinity;
  cpu_set_t affinity;
};

union ticket { /* control data that carries one descriptor */
  char bytes[CMSG_SPACE(sizeof(int))];
  struct cmsghdr aligned;
};

static atomic_int control = -1; /* our end of the socket; closed by
                                   vg_child_server_stop only */
static atomic_int server;       /* process id of the server; 0: not running, or
                                   already waited for */
static atomic_int server_died;

/* --- a process that shares nothing --------------------------------------- */

static void close_from(unsigned first, unsigned end)
{
  struct rlimit limit;

  if (first >= end) return;
#ifdef SYS_close_range
  if (!syscall(SYS_close_range, first, end - 1, 0)) return;
#endif
  /* close_range needs Linux 5.9. Few processes have opened more descriptors
   * than this limit. */
  if (getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur > 65536)
    limit.rlim_cur = 65536;
  for (unsigned fd = first; fd < end && fd < limit.rlim_cur; fd++)
    close((int)fd);
}

/* Close all inherited descriptors except a and b (-1: none). Otherwise they
 * would keep files, pipes and sockets of the parent open. */
static void keep_only(int a, int b)
{
  const int lo = a < b ? a : b, hi = a < b ? b : a;
  unsigned next = STDERR_FILENO + 1;
  int nowhere = open("/dev/null", O_RDWR);

  for (int k = 0; k <= STDERR_FILENO; k++)
    if (k != a && k != b && nowhere >= 0 && k != nowhere) dup2(nowhere, k);
  for (int k = 0; k < 2; k++) {
    int keep = k ? hi : lo;

    if (keep <= STDERR_FILENO) continue;
    close_from(next, (unsigned)keep);
    next = (unsigned)keep + 1;
  }
  close_from(next, ~0u);
}

/* Ignore the signals that a terminal or a batch system sends to the whole
 * process group: the parent decides when this process ends. All other signals
 * get their default action, and none is blocked. */
static void set_signals(void)
{
  static const int others[] = { SIGINT,  SIGTERM, SIGHUP,
                                SIGQUIT, SIGUSR1, SIGUSR2 };
  static const int own[] = { SIGSEGV, SIGABRT, SIGBUS,  SIGFPE, SIGILL,
                             SIGPROF, SIGPIPE, SIGCHLD, SIGALRM };
  sigset_t none;

  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    signal(others[k], SIG_IGN);
  for (size_t k = 0; k < sizeof own / sizeof *own; k++) signal(own[k], SIG_DFL);
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
}

static void detach(int fd, int line)
{
  struct rlimit none = { 0, 0 };

  setrlimit(RLIMIT_CORE, &none);
  keep_only(fd, line);
}

/* End this process when `parent` ends, which must have a single thread:
 * PR_SET_PDEATHSIG follows the thread that forked, not its process. */
static void end_with(pid_t parent)
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
    _exit(1); /* the parent ended before PR_SET_PDEATHSIG took effect */
}

/* End this process when the last copy of the other end of a pipe is closed.
 * This holds for whatever the process does, also after exec. */
static void end_with_line(int line)
{
  struct pollfd p = { .fd = line, .events = 0 };

  fcntl(line, F_SETFD, 0);
  fcntl(line, F_SETOWN, getpid());
  fcntl(line, F_SETSIG, SIGKILL);
  fcntl(line, F_SETFL, O_ASYNC);
  if (poll(&p, 1, 0) > 0) _exit(1); /* closed before O_ASYNC took effect */
}

/* --- the server ---------------------------------------------------------- */

/* Receive a request and the descriptor sent with it. Returns the size of the
 * message, 0 at the end, -1 on failure; *fd is -1 if the message has no
 * descriptor. */
static ssize_t take_request(int from, struct request *r, int *fd)
{
  union ticket t;
  struct iovec part = { r, sizeof *r };
  struct msghdr m = { .msg_iov = &part,
                      .msg_iovlen = 1,
                      .msg_control = t.bytes,
                      .msg_controllen = sizeof t };
  struct cmsghdr *c;
  ssize_t n;

  *fd = -1;
  do n = recvmsg(from, &m, MSG_CMSG_CLOEXEC);
  while (n < 0 && errno == EINTR);
  c = n > 0 ? CMSG_FIRSTHDR(&m) : NULL;
  if (c && c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_RIGHTS &&
      c->cmsg_len == CMSG_LEN(sizeof *fd))
    memcpy(fd, CMSG_DATA(c), sizeof *fd);
  return n;
}

__attribute__((noreturn)) static void be_child(pid_t parent, int fd,
                                               const struct request *r)
{
  set_signals();
  end_with(parent);
  detach(fd, -1);
  if (r->has_affinity) sched_setaffinity(0, sizeof r->affinity, &r->affinity);
  if (send(fd, "", 1, MSG_NOSIGNAL) != 1) _exit(1);
  r->body(fd);
  _exit(1);
}

__attribute__((noreturn)) static void serve(int from)
{
  struct request r;
  pid_t self = getpid();
  ssize_t n;
  int fd;

  set_signals();
  signal(SIGPIPE, SIG_IGN);
  signal(SIGCHLD, SIG_IGN); /* children leave no zombies */
  prctl(PR_SET_NAME, "vanguard-child");
  keep_only(from, -1);
  while ((n = take_request(from, &r, &fd)) > 0) {
    if (fd < 0) continue;
    if (n == sizeof r && fork() == 0) be_child(self, fd, &r);
    close(fd);
  }
  _exit(0);
}

vg_status vg_child_server_start(struct vg_error *err)
{
  int ends[2];
  pid_t pid;

  if (control >= 0) return VG_OK;
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends))
    return vg_fail_memory(err, "a socket for child processes");
  pid = fork();
  if (pid == 0) serve(ends[1]);
  close(ends[1]);
  if (pid < 0) {
    close(ends[0]);
    return vg_fail_memory(err, "a process for child processes");
  }
  server = pid;
  server_died = 0;
  control = ends[0];
  return VG_OK;
}

/* --- functions for the users of children --------------------------------- */

static void wait_for(int options)
{
  pid_t pid = atomic_exchange(&server, 0);

  while (pid > 0 && waitpid(pid, NULL, options) < 0 && errno == EINTR) {
  }
}

void vg_child_server_stop(void)
{
  int fd = atomic_exchange(&control, -1);

  if (fd < 0) return;
  shutdown(fd, SHUT_RDWR); /* ends the server even if another process holds a
                              copy of fd */
  close(fd);
  wait_for(0);
}

static void note_death(void)
{
  struct pollfd p = { .fd = control, .events = 0 };

  if (p.fd < 0 || server_died) return;
  if (poll(&p, 1, 0) <= 0 || !(p.revents & (POLLHUP | POLLERR))) return;
  server_died = 1;
  wait_for(0); /* returns soon, since its socket is closed */
}

static int send_ticket(int to, int fd, vg_child_body *body)
{
  struct request r = { .body = body };
  struct iovec part = { &r, sizeof r };
  union ticket t = { { 0 } };
  struct msghdr m = { .msg_iov = &part,
                      .msg_iovlen = 1,
                      .msg_control = t.bytes,
                      .msg_controllen = sizeof t };
  struct cmsghdr *c = CMSG_FIRSTHDR(&m);
  ssize_t n;

  /* fails on machines with more processors than a cpu_set_t holds */
  r.has_affinity = !sched_getaffinity(0, sizeof r.affinity, &r.affinity);
  c->cmsg_level = SOL_SOCKET;
  c->cmsg_type = SCM_RIGHTS;
  c->cmsg_len = CMSG_LEN(sizeof fd);
  memcpy(CMSG_DATA(c), &fd, sizeof fd);
  do n = sendmsg(to, &m, MSG_NOSIGNAL);
  while (n < 0 && errno == EINTR);
  return n == sizeof r;
}

/* Ask the server for a child. Returns its socket, or -1 if there is no server
 * or it cannot make one. */
static int ask_server(vg_child_body *body)
{
  int ends[2], to = control, sent;
  ssize_t n = 0;
  char hello;

  if (to < 0 || server_died) return -1;
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) return -1;
  sent = send_ticket(to, ends[1], body);
  close(ends[1]);
  if (sent) {
    do n = read(ends[0], &hello, 1);
    while (n < 0 && errno == EINTR);
  }
  if (n == 1) return ends[0];
  close(ends[0]);
  note_death();
  return -1;
}

/* The child may outlive the calling thread, but not this process. */
static int fork_here(vg_child_body *body, struct vg_child *out)
{
  int ends[2], line[2];

  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) return -1;
  if (pipe2(line, O_CLOEXEC)) {
    close(ends[0]);
    close(ends[1]);
    return -1;
  }
  out->pid = fork();
  if (out->pid == 0) {
    set_signals();
    close(line[1]);
    end_with_line(line[0]);
    detach(ends[1], line[0]);
    body(ends[1]);
    _exit(1);
  }
  close(ends[1]);
  close(line[0]);
  out->fd = ends[0];
  out->line = line[1];
  if (out->pid > 0) return 0;
  close(ends[0]);
  close(line[1]);
  return -1;
}

int vg_child_open(vg_child_body *body, struct vg_child *out)
{
  assert(body && out);
  out->pid = 0;
  out->line = -1;
  out->fd = ask_server(body);
  return out->fd < 0 ? fork_here(body, out) : 0;
}

void vg_child_close(struct vg_child *c)
{
  assert(c);
  shutdown(c->fd, SHUT_RDWR);
  close(c->fd);
  while (c->pid > 0 && waitpid(c->pid, NULL, 0) < 0 && errno == EINTR) {
  }
  if (c->line >= 0) close(c->line);
}

/* A child body that ends at once. */
static void only_hello(int fd)
{
  (void)fd;
  _exit(0);
}

int vg_child_server_is_alive(void)
{
  int fd = ask_server(only_hello);

  if (fd >= 0) close(fd);
  return fd >= 0;
}
