/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Stub of cli/http/http.h for builds without libmicrohttpd. */
#include <string.h>
#include <unistd.h>

#include "cli/http/http.h"

static vg_status absent(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "this build has no portal (CMake option VG_PORTAL); install "
                 "libmicrohttpd-dev, then configure and build again");
}

void vg_library_microhttpd(struct vg_library *out)
{
  out->name = "libmicrohttpd";
  strcpy(out->version, VG_NOT_IN_BUILD " (VG_PORTAL=OFF)");
}

vg_status vg_http_open(int fd, const struct vg_http_handler *h,
                       struct vg_http **out, struct vg_error *err)
{
  (void)h, (void)out;
  if (fd >= 0) close(fd);
  return absent(err);
}

void vg_http_close(struct vg_http *http)
{
  (void)http;
}

vg_status vg_http_connect(struct vg_http *http, int fd, struct vg_error *err)
{
  (void)http, (void)fd;
  return absent(err);
}

vg_status vg_http_step(struct vg_http *http, int milliseconds,
                       struct vg_error *err)
{
  (void)http, (void)milliseconds;
  return absent(err);
}
