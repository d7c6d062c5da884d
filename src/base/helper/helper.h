/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/helper/helper.h: helper programs, which contain the libraries whose
 * licences must not apply to this program: vanguard-tetgen (TetGen) and
 * vanguard-wrap (CGAL). Each runs in a child process (base/child.h) and
 * exchanges the messages of base/helper/helper_format.h, so that it may crash
 * and hang.
 *
 * Search order: the folder of vg_helper_set_folder, or else of the environment
 * variable VANGUARD_HELPERS; without either, the folder of the file that
 * contains this code, the folder libexec/vanguard of the installation, and the
 * folder bin of a build tree.
 *
 * The folder belongs to the calling thread and to the threads that it starts
 * (vg_thread_data), so that two runs in one process can have different ones.
 * The helpers that were found are state of the process, as is the child server.
 * Meshes depend on the helpers: their identities belong to
 * the digest of a job.
 *
 * Only an answer of a helper may decide how a mesh is made. If none arrives,
 * because the helper was killed, refused memory or not started, the request is
 * repeated once (vg_helper_repeat), and then the run stops. */
#ifndef VG_BASE_HELPER_H
#define VG_BASE_HELPER_H

#include "base/child.h"
#include "base/helper/helper_format.h"
#include "base/helper/link.h"

#ifdef __cplusplus
extern "C" {
#endif

enum vg_helper_kind { VG_HELPER_TETGEN, VG_HELPER_WRAPS, VG_HELPER_N };

struct vg_helper {
  int is_found;
  int is_unusable;    /* it is installed, but cannot be used */
  const char *name;   /* of the program: "vanguard-tetgen" */
  const char *holds;  /* library that it contains: "TetGen" */
  char path[4096];    /* "": not found */
  char library[48];   /* name and version of the library: "TetGen 1.5" */
  char identity[192]; /* of the helper, its sources and its library; "none" */
  char why[1024];     /* not found: the reason and a remedy, a sentence without
                         a full stop */
};

/** Set the folder with the helpers for this thread and the threads that it
 * starts later; "": the default search. If the folder changes, helpers are
 * searched again. Threads: safe. */
void vg_helper_set_folder(const char *folder);

/** Name of the program. Static string. */
const char *vg_helper_name(enum vg_helper_kind kind);

/** Find a helper and start it as a test. The result is kept until the folder
 * changes, except for that of an unusable helper. Threads: safe. Costs a few
 * milliseconds the first time. */
void vg_helper_find(enum vg_helper_kind kind, struct vg_helper *out);

/** Start a helper: a new process, whose first message has been read.
 *
 * @param stop     may be NULL; must stay valid while the link is in use
 * @param silence  seconds without any transfer after which the link ends
 * VG_ERR_UNSUPPORTED: the helper is not installed, with the reason and a
 * remedy; VG_ERR_IO: it is installed, but it does not start or has changed;
 * VG_ERR_MEMORY; VG_ERR_STOPPED. Threads: safe. */
vg_status vg_helper_open(enum vg_helper_kind kind, const struct vg_stop *stop,
                         double silence, struct vg_child *child,
                         struct vg_link *link, struct vg_error *err);

/** Why no answer arrived, with a remedy. who: name of the program; cause: of
 * VG_HELPER_FAILED, or 0. Returns VG_ERR_STOPPED, VG_ERR_MEMORY or VG_ERR_IO.
 */
vg_status vg_helper_lost(const struct vg_link *link, uint32_t cause,
                         const char *who, struct vg_error *err);

/** Call `attempt`. If it returns VG_ERR_IO or VG_ERR_MEMORY, call it once more
 * after a pause, while no other thread repeats an attempt. Threads: safe. */
typedef vg_status vg_helper_attempt(void *user, struct vg_error *err);
vg_status vg_helper_repeat(vg_helper_attempt *attempt, void *user,
                           const struct vg_stop *stop, struct vg_error *err);

/** End a helper. */
void vg_helper_close(struct vg_child *child);

/** Check the first message of a helper. Returns NULL if it is valid, otherwise
 * what is wrong with it, a static string. */
const char *vg_helper_hello_wrong(const struct vg_helper_hello *hello,
                                  const char *name);

#ifdef __cplusplus
}
#endif

#endif
