/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/http.h: HTTP server for the portal, by libmicrohttpd. It is
 * single-threaded, so callbacks need no locks. */
#ifndef VG_CLI_HTTP_HTTP_H
#define VG_CLI_HTTP_HTTP_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "cli/http/archive.h"
#include "cli/http/fields.h"
#include "cli/http/upload.h"

/* Limits for clients: connections, those of them that the handler does not
 * trust, and seconds until it must; seconds without data, bytes of request line
 * and headers, number of headers. */
enum {
  VG_HTTP_CONNECTIONS = 64,
  VG_HTTP_VISITORS = 16,
  VG_HTTP_VISIT_S = 10,
  VG_HTTP_SILENCE_S = 30,
  VG_HTTP_HEAD_BYTES = 32768,
  VG_HTTP_HEADERS = 64
};

struct vg_request {
  const char *method, *path; /* path: decoded, without the query */
  const char *host, *origin; /* headers; "" if absent */
  int64_t length;            /* announced length of the body; -1: unknown */
  int is_trusted;            /* set by `begin`: its connection may stay */
  struct vg_fields query, form;
  struct vg_upload upload;
  vg_status body; /* < 0: the body was rejected, see error */
  struct vg_error error;
};

/** A reply: a body of `size` bytes (from malloc), an open file, or an
 * archive. */
struct vg_reply {
  int status;
  const char *type;   /* media type; NULL: HTML */
  const char *policy; /* content security policy; NULL: the portal's own */
  char *location;     /* target of a redirection, from malloc; NULL: none */
  char *download;     /* name to save under, from malloc; NULL: display it */
  char *body;
  size_t size;
  int fd;                     /* -1: body or archive */
  struct vg_archive *archive; /* owned; NULL: body or file */
  int is_fixed; /* 1: the content at this address never changes, and the browser
                   may keep it */
  int in_frame; /* 1: pages of the portal may show it in a frame */
};
#define VG_REPLY_INIT                                                          \
  {                                                                            \
    200, NULL, NULL, NULL, NULL, NULL, 0, -1, NULL, 0, 0                       \
  }

/** Called for each request: `begin` when its headers have arrived (returns 1 if
 * it is answered without reading the body), `end` when it is complete. Pieces
 * of files are passed to `file`. */
struct vg_http_handler {
  int (*begin)(void *user, struct vg_request *r, struct vg_reply *a);
  /* A piece of a file; an error rejects the body of the request. */
  vg_status (*file)(void *user, struct vg_request *r, const char *name,
                    const char *data, uint64_t offset, size_t size,
                    struct vg_error *err);
  void (*end)(void *user, struct vg_request *r, struct vg_reply *a);
  void *user;
};

struct vg_http;

/** @param fd  a listening socket, owned by the server from now on; -1: none
 * @param h   borrowed until the server is closed
 * VG_ERR_UNSUPPORTED: libmicrohttpd is missing in this build or on this
 * machine. */
vg_status vg_http_open(int fd, const struct vg_http_handler *h,
                       struct vg_http **out, struct vg_error *err);
void vg_http_close(struct vg_http *http);

/** Handle a connected socket like an accepted connection; takes ownership. */
vg_status vg_http_connect(struct vg_http *http, int fd, struct vg_error *err);

/** Wait for events for at most the given time and handle them. */
vg_status vg_http_step(struct vg_http *http, int milliseconds,
                       struct vg_error *err);

/** The library is loaded for this. */
void vg_library_microhttpd(struct vg_library *out);

#endif
