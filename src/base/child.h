/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/child.h: child processes for third-party libraries that must not run in
 * this process, because they keep state in static variables, end the process,
 * take over signals or never return.
 *
 * fork copies the page tables of the caller. In a process of many gigabytes
 * this takes seconds, under MPI it is discouraged, and if other threads are
 * running the child may inherit locks that are never released. The program
 * therefore forks a small, single-threaded server process at its start, and
 * that server forks again for each call of vg_child_open. Without the server,
 * vg_child_open forks the calling process.
 *
 * There is one server per process, just as there is one standard output. It is
 * the only mutable global state of the library, since its callers are too deep
 * in the call tree to receive a handle. Results do not depend on it. */
#ifndef VG_BASE_CHILD_H
#define VG_BASE_CHILD_H

#include <stddef.h>
#include <sys/types.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Start the server. Call it at program start, before any thread is started and
 * before MPI is initialised.
 *
 * The server ends when this process ends for whatever reason. It ignores
 * SIGINT, SIGTERM and similar signals sent to the process group, which are for
 * this process to handle, and holds none of its files. A second call does
 * nothing.
 * VG_ERR_MEMORY: the system refused a process or a socket. The program may go
 * on; children are then forked from the calling process. */
vg_status vg_child_server_start(struct vg_error *err);

/** End the server and wait for it; does nothing without one. No child may be
 * running. */
void vg_child_server_stop(void);

/** Returns 1 if the server has just proved that it is alive by starting a new
 * child. A child that has disappeared must then have ended by itself. The state
 * of the server's socket proves nothing: it may stay open for a moment after
 * the server's children were told to end. Threads: safe. */
int vg_child_server_is_alive(void);

/** Function that a child runs. `fd` is the stream socket to the parent; the
 * function serves it until the parent shuts the other end, and does not return.
 * The child shares nothing else with the parent: it has no other open files,
 * default signal actions (except for the ignored signals that the parent
 * handles), discarded output, and it ends when the parent process ends,
 * whatever becomes of the thread that started it. */
typedef void vg_child_body(int fd);

struct vg_child {
  int fd;    /* stream socket; the child ends when the other end is shut */
  int line;  /* write end of a pipe at whose end the child is killed, if forked
                by this process; -1: child of the server */
  pid_t pid; /* process id if forked by this process; 0: child of the server */
};

/** Start a new child that runs `body`, a function of this program; the server
 * has it at the same address. The child gets the CPU affinity of the calling
 * thread. Returns -1 if the system refuses. Threads: safe. */
int vg_child_open(vg_child_body *body, struct vg_child *out);

/** Shut the child's socket, at which its body ends. Waits for the child only if
 * this process forked it. */
void vg_child_close(struct vg_child *c);

/** Send all of these bytes over a child's socket, from either end. Returns 0 if
 * the other end is closed; never raises SIGPIPE on a socket. */
int vg_child_put(int fd, const void *data, size_t size);
int vg_child_get(int fd, void *data, size_t size);

/** From now on, send `size` bytes over fd before this process ends by SIGSEGV,
 * SIGBUS, SIGFPE, SIGILL or SIGABRT (`crash`) or by SIGPROF (`time`; NULL: not
 * for this signal). A crash is thus an answer about the input, since it happens
 * again, while a process that ends without a word was ended from outside. */
void vg_child_answer_crashes(int fd, const void *crash, const void *time,
                             size_t size);

#ifdef __cplusplus
}
#endif

#endif
