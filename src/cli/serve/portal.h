/* cli/serve/portal.h: runs from a browser. A portal is a web server in one
 * thread that lists the projects below a folder, starts vanguard mesh and
 * vanguard sweep as processes of their own, on this machine or through Slurm,
 * and shows how far they are: docs/reference/portal.md. Uses libmicrohttpd,
 * which is loaded when a portal is opened. */
#ifndef VG_CLI_SERVE_PORTAL_H
#define VG_CLI_SERVE_PORTAL_H

#include <stdint.h>

#include "base/status.h"

struct vg_portal_options {
  const char *root;     /* folder of the projects */
  const char *host;     /* address to listen on; NULL: 127.0.0.1 */
  int port;             /* 0: any that is free */
  int64_t max_upload;   /* bytes of a file that is brought */
  int jobs;             /* runs on this machine at a time */
  const char *launcher; /* of ranks, as for vanguard sweep; NULL: mpirun */
  const char *program;  /* that meshes; NULL: this one */
};
#define VG_PORTAL_OPTIONS_INIT                                                 \
  {                                                                            \
    ".", NULL, 8765, 1000000000, 1, NULL, NULL                                 \
  }

struct vg_portal;

/** Take the folder of the runs, root/vanguard-runs, for this portal, find the
 * runs in it, and listen. The address with its token is in
 * root/vanguard-runs/portal.url, for the owner alone, until the portal closes.
 *
 * @param o    borrowed until the portal is closed
 * VG_ERR_UNSUPPORTED: libmicrohttpd is absent; VG_ERR_IO: folder or port cannot
 * be had, or another portal has the folder. */
vg_status vg_portal_open(const struct vg_portal_options *o,
                         struct vg_portal **out, struct vg_error *err);

/** "http://127.0.0.1:8765/TOKEN/". Borrowed. */
const char *vg_portal_url(const struct vg_portal *p);

/** Answer what has come in, look after the runs, and wait for more, for so many
 * milliseconds at most. VG_ERR_IO: the server cannot go on. */
vg_status vg_portal_step(struct vg_portal *p, int milliseconds,
                         struct vg_error *err);

/** Runs that are at work or wait. */
int vg_portal_active(const struct vg_portal *p);

/** Take a connected stream socket as if it had come in; it is closed at its
 * end. For tests. */
vg_status vg_portal_connect(struct vg_portal *p, int fd, struct vg_error *err);

/** Runs go on; a portal opened in the same folder has them again. Accepts
 * NULL. */
void vg_portal_close(struct vg_portal *p);

#endif
