/* core/recover/cdt_server.h: where the child processes for TetGen come from.
 *
 * fork copies the page tables of the caller, takes seconds in a process of
 * many gigabytes, is discouraged under MPI and, with other threads at work,
 * may leave a child whose locks are held for ever. So a program that meshes
 * forks a small process of one thread at its start; that one forks again for
 * each call of vg_cdt_tetgen. Without it vg_cdt_tetgen forks in place.
 *
 * There is one server per process, as there is one standard output: the only
 * mutable state of the library, since callers of TetGen lie too deep for a
 * handle. Results do not depend on it. */
#ifndef VG_CORE_RECOVER_CDT_SERVER_H
#define VG_CORE_RECOVER_CDT_SERVER_H

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
 * on, TetGen then runs in children of its own. */
vg_status vg_cdt_server_start(struct vg_error *err);

/** End the server and wait for it; nothing happens without one. No call of
 * vg_cdt_tetgen may be under way. */
void vg_cdt_server_stop(void);

/* --- for cdt_tetgen.cpp -------------------------------------------------- */

/** A socket to a fresh child of the server that runs vg_cdt_serve on the
 * other end; -1 when there is no server, or it cannot. The child takes on the
 * affinity of the calling thread. Threads: safe. */
int vg_cdt_server_connect(void);

/** 1 when the server has just given proof of life by a fresh child: then one
 * that is gone went by itself. The socket of a server is no such proof, since
 * it may stay open for a moment after its children were told of its end.
 * Threads: safe. */
int vg_cdt_server_is_alive(void);

/** Make the calling process, just forked by `parent`, a child that shares
 * nothing with it but `fd`: no other files, default signals save those that
 * the parent decides about, output to nowhere, and an end with the parent. */
void vg_cdt_server_detach(pid_t parent, int fd);

#ifdef __cplusplus
}
#endif

#endif
