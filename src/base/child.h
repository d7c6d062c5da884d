/* base/child.h: child processes for libraries that cannot be trusted with this
 * one: that hold state in statics, end the process, take signals for themselves
 * or never return.
 *
 * fork copies the page tables of the caller, takes seconds in a process of
 * many gigabytes, is discouraged under MPI and, with other threads at work,
 * may leave a child whose locks are held for ever. So a program that meshes
 * forks a small process of one thread at its start; that one forks again for
 * each call of vg_child_open. Without it vg_child_open forks in place.
 *
 * There is one server per process, as there is one standard output: the only
 * mutable state of the library, since callers lie too deep for a handle.
 * Results do not depend on it. */
#ifndef VG_BASE_CHILD_H
#define VG_BASE_CHILD_H

#include <stddef.h>
#include <sys/types.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Start the server. Call at program start, before any thread, before MPI.
 *
 * It ends when this process ends, however that comes, leaves its signals to
 * this process (SIGINT, SIGTERM and the like sent to the group are ignored)
 * and holds none of its files. A second call does nothing.
 * VG_ERR_MEMORY: the system refuses a process or a socket; the program may go
 * on, children are then forked in place. */
vg_status vg_child_server_start(struct vg_error *err);

/** End the server and wait for it; nothing happens without one. No child may
 * be at work. */
void vg_child_server_stop(void);

/** 1 when the server has just given proof of life by a fresh child: then one
 * that is gone went by itself. The socket of a server is no such proof, since
 * it may stay open for a moment after its children were told of its end.
 * Threads: safe. */
int vg_child_server_is_alive(void);

/** What a child does with the stream socket to its parent, until the other end
 * shuts it; it does not return. The child shares nothing else with the parent:
 * no other files, default signals save those that the parent decides about
 * (ignored), output to nowhere, and an end with the parent. */
typedef void vg_child_body(int fd);

struct vg_child {
  int fd;    /* a stream socket; the end of its other end is the
                end of the child */
  pid_t pid; /* forked in place; 0: the server's */
};

/** A fresh child that runs `body`, a function of this program: the server has
 * it at the same address. It takes on the affinity of the calling thread.
 * Returns -1 when the system refuses. Threads: safe. */
int vg_child_open(vg_child_body *body, struct vg_child *out);

/** The child ends, by itself if its body ends when the socket is shut; one that
 * was forked in place is waited for. */
void vg_child_close(struct vg_child *c);

/** All of these bytes over a child's socket, at either end. Returns 0 when the
 * other end is gone; never raises SIGPIPE. */
int vg_child_put(int fd, const void *data, size_t size);
int vg_child_get(int fd, void *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
