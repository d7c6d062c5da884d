/* Private to cli/serve: HTTP, by libmicrohttpd. One thread: whoever is called
 * back has the portal to itself. */
#ifndef VG_CLI_SERVE_HTTP_H
#define VG_CLI_SERVE_HTTP_H

#include <stddef.h>
#include <stdint.h>

#include "cli/serve/fields.h"
#include "cli/serve/upload.h"

/* What a client may take: connections, seconds of silence, bytes of a request
 * line with its headers, and headers. */
enum {
  VG_HTTP_CONNECTIONS = 64,
  VG_HTTP_SILENCE_S = 30,
  VG_HTTP_HEAD_BYTES = 32768,
  VG_HTTP_HEADERS = 64
};

struct vg_request {
  const char *method, *path; /* path: decoded, without the query */
  const char *host, *origin; /* headers; "" where absent */
  int64_t length;            /* of the body, as announced; -1: not said */
  struct vg_fields query, form;
  struct vg_upload upload;
  vg_status body; /* < 0: the body was refused, error says why */
  struct vg_error error;
};

/** What is answered: body of size bytes (malloc), or an open file. */
struct vg_reply {
  int status;
  const char *type;   /* media type; NULL: HTML */
  const char *policy; /* of content; NULL: the portal's own */
  char *location;     /* to go to, malloc; NULL */
  char *download;     /* name to save under, malloc; NULL: to show */
  char *body;
  size_t size;
  int fd; /* -1: body */
};
#define VG_REPLY_INIT                                                          \
  {                                                                            \
    200, NULL, NULL, NULL, NULL, NULL, 0, -1                                   \
  }

/** Called for each request: `begin` when its head is there (1: it is answered
 * before the body is read), `end` when all is. Pieces of files go through
 * vg_upload_put. */
struct vg_http_handler {
  int (*begin)(void *user, struct vg_request *r, struct vg_reply *a);
  /* A piece of a file; VG_ERR_INPUT, ... end the request's body. */
  vg_status (*file)(void *user, struct vg_request *r, const char *name,
                    const char *data, uint64_t offset, size_t size,
                    struct vg_error *err);
  void (*end)(void *user, struct vg_request *r, struct vg_reply *a);
  void *user;
};

struct vg_http;

/** @param fd  a socket that listens, taken over; -1: none
 * @param h   borrowed until the server ends
 * VG_ERR_UNSUPPORTED: no libmicrohttpd, in this build or on this machine. */
vg_status vg_http_open(int fd, const struct vg_http_handler *h,
                       struct vg_http **out, struct vg_error *err);
void vg_http_close(struct vg_http *http);

/** A connected socket as if it had come in; taken over. */
vg_status vg_http_connect(struct vg_http *http, int fd, struct vg_error *err);

/** Do what is to be done, after waiting for it so long at most. */
vg_status vg_http_step(struct vg_http *http, int milliseconds,
                       struct vg_error *err);

#endif
