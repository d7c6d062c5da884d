/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/serve/portal.h: the portal, from which runs are started in a browser: a
 * single-threaded web server that lists the projects below a folder, starts
 * vanguard mesh and vanguard sweep as separate processes, on this machine or
 * through Slurm, and shows their progress; see docs/reference/portal.md. Uses
 * libmicrohttpd, which is loaded when a portal is opened. */
#ifndef VG_CLI_SERVE_PORTAL_H
#define VG_CLI_SERVE_PORTAL_H

#include <stdint.h>

#include "base/status.h"

struct vg_portal_options {
  const char *root;     /* folder of the projects */
  const char *host;     /* address to listen on; NULL: 127.0.0.1 */
  int port;             /* 0: any free port */
  int64_t max_upload;   /* largest uploaded file, bytes */
  int jobs;             /* simultaneous runs on this machine */
  const char *launcher; /* of ranks, as for vanguard sweep; NULL: mpirun */
  const char *program;  /* program that meshes; NULL: this one */
};
#define VG_PORTAL_OPTIONS_INIT                                                 \
  {                                                                            \
    ".", NULL, 8765, 1000000000, 1, NULL, NULL                                 \
  }

struct vg_portal;

/** Lock the folder of the runs, root/vanguard-runs, for this portal, find the
 * runs in it, and listen. The address with its token is in
 * root/vanguard-runs/portal.url, readable by the owner only, until the portal
 * closes.
 *
 * @param o    borrowed until the portal is closed
 * VG_ERR_UNSUPPORTED: libmicrohttpd is missing; VG_ERR_IO: folder or port is
 * not available, or another portal uses the folder. */
vg_status vg_portal_open(const struct vg_portal_options *o,
                         struct vg_portal **out, struct vg_error *err);

/** "http://127.0.0.1:8765/TOKEN/". Borrowed. */
const char *vg_portal_url(const struct vg_portal *p);

/** Check the runs, then wait for requests for at most the given time and answer
 * them. VG_ERR_IO: the server has failed. */
vg_status vg_portal_step(struct vg_portal *p, int milliseconds,
                         struct vg_error *err);

/** Number of runs that are running or waiting. */
int vg_portal_active(const struct vg_portal *p);

/** Handle a connected stream socket like an accepted connection; it is closed
 * when the connection ends. For tests. */
vg_status vg_portal_connect(struct vg_portal *p, int fd, struct vg_error *err);

/** Close the portal. Its runs continue; a portal opened in the same folder
 * finds them again. Accepts NULL. */
void vg_portal_close(struct vg_portal *p);

#endif
