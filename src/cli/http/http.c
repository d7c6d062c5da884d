/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/http/http.h"

#include <dlfcn.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/memory.h"
#include "cli/http/visitors.h"

/* The library is loaded only when a portal is opened: it depends on GnuTLS,
 * which would slow down every start of the program. */
#define FUNCTIONS(f)                                                           \
  f(MHD_start_daemon) f(MHD_stop_daemon) f(MHD_add_connection) f(MHD_run_wait) \
    f(MHD_lookup_connection_value) f(MHD_get_connection_values)                \
      f(MHD_get_connection_info) f(MHD_create_post_processor)                  \
        f(MHD_post_process) f(MHD_destroy_post_processor)                      \
          f(MHD_create_response_from_buffer) f(MHD_create_response_from_fd64)  \
            f(MHD_add_response_header) f(MHD_create_response_from_callback)    \
              f(MHD_queue_response) f(MHD_destroy_response)

struct library {
  void *handle;
#define POINTER(name) __typeof__(&name) name;
  FUNCTIONS(POINTER)
};

struct vg_http {
  struct library lib;
  struct MHD_Daemon *daemon;
  const struct vg_http_handler *h;
  struct vg_visitors visitors;
};

/* A request in progress. */
struct call {
  struct vg_http *http;
  struct vg_request r;
  struct MHD_PostProcessor *post;
};

static const char own_policy[] =
  "default-src 'none'; img-src 'self' data:; "
  "style-src 'self'; "
  "script-src 'self'; connect-src 'self'; frame-src 'self'; "
  "form-action 'self'; "
  "frame-ancestors 'none'; base-uri 'none'";

static vg_status load(struct library *lib, struct vg_error *err)
{
  int missing = 0;

  lib->handle = dlopen(VG_MICROHTTPD, RTLD_NOW | RTLD_LOCAL);
#define FIND(name)                                                             \
  if (lib->handle) {                                                           \
    lib->name = (__typeof__(&name))dlsym(lib->handle, #name);                  \
    missing |= !lib->name;                                                     \
  }
  FUNCTIONS(FIND)
  if (lib->handle && !missing) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the portal needs " VG_MICROHTTPD
                 ", which was not found; install libmicrohttpd12");
}

void vg_library_microhttpd(struct vg_library *out)
{
  void *library = dlopen(VG_MICROHTTPD, RTLD_NOW | RTLD_LOCAL);
  __typeof__(MHD_get_version) *ask = library
                                     ? (__typeof__(MHD_get_version) *)
                                         dlsym(library, "MHD_get_version")
                                     : NULL;

  out->name = "libmicrohttpd";
  snprintf(out->version, sizeof out->version, "%.100s",
           ask ? ask() : VG_MICROHTTPD " was not found");
  if (library) dlclose(library);
}

/* --- requests ------------------------------------------------------------ */

static enum MHD_Result take_query(void *user, enum MHD_ValueKind kind,
                                  const char *key, const char *value)
{
  struct vg_request *r = user;

  (void)kind;
  if (!value) value = "";
  if (r->body >= 0)
    r->body = vg_fields_put(&r->query, key, value, 0, strlen(value), &r->error);
  return r->body < 0 ? MHD_NO : MHD_YES;
}

static enum MHD_Result take_field(void *user, enum MHD_ValueKind kind,
                                  const char *key, const char *filename,
                                  const char *type, const char *encoding,
                                  const char *data, uint64_t offset,
                                  size_t size)
{
  struct call *c = user;
  struct vg_request *r = &c->r;

  (void)kind, (void)type, (void)encoding;
  if (r->body < 0) return MHD_NO;
  if (filename)
    r->body = c->http->h->file(c->http->h->user, r, filename, data, offset,
                               size, &r->error);
  else
    r->body = vg_fields_put(&r->form, key ? key : "", data, (size_t)offset,
                            size, &r->error);
  return r->body < 0 ? MHD_NO : MHD_YES;
}

static struct call *begin_call(struct vg_http *http,
                               struct MHD_Connection *connection,
                               const char *path, const char *method)
{
  const struct library *lib = &http->lib;
  const struct vg_upload no_upload = VG_UPLOAD_INIT;
  struct call *c = vg_calloc(1, sizeof *c);
  const char *length;

  if (!c) return NULL;
  c->http = http;
  c->r.upload = no_upload;
  c->r.method = method;
  c->r.path = path;
  c->r.host = lib->MHD_lookup_connection_value(connection, MHD_HEADER_KIND,
                                               "Host");
  c->r.origin = lib->MHD_lookup_connection_value(connection, MHD_HEADER_KIND,
                                                 "Origin");
  length = lib->MHD_lookup_connection_value(connection, MHD_HEADER_KIND,
                                            "Content-Length");
  if (!c->r.host) c->r.host = "";
  if (!c->r.origin) c->r.origin = "";
  c->r.length = length ? strtoll(length, NULL, 10) : -1;
  lib->MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, take_query,
                                 &c->r);
  return c;
}

static void end_call(struct call *c)
{
  if (c->post) c->http->lib.MHD_destroy_post_processor(c->post);
  vg_upload_release(&c->r.upload);
  vg_fields_release(&c->r.query);
  vg_fields_release(&c->r.form);
  free(c);
}

static void completed(void *user, struct MHD_Connection *connection,
                      void **state, enum MHD_RequestTerminationCode why)
{
  (void)user, (void)connection, (void)why;
  if (*state) end_call(*state);
  *state = NULL;
}

/* --- connections --------------------------------------------------------- */

static void connected(void *user, struct MHD_Connection *connection,
                      void **state, enum MHD_ConnectionNotificationCode what)
{
  struct vg_http *http = user;
  const union MHD_ConnectionInfo *info;

  if (what == MHD_CONNECTION_NOTIFY_STARTED) {
    info = http->lib.MHD_get_connection_info(connection,
                                             MHD_CONNECTION_INFO_CONNECTION_FD);
    *state = info ? vg_calloc(1, sizeof(struct vg_visitor)) : NULL;
    if (*state) vg_visitors_add(&http->visitors, *state, info->connect_fd);
  } else if (*state) {
    vg_visitors_remove(&http->visitors, *state);
    free(*state);
    *state = NULL;
  }
}

static void trust(struct vg_http *http, struct MHD_Connection *connection)
{
  const union MHD_ConnectionInfo *info = http->lib.MHD_get_connection_info(
    connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);

  if (info && info->socket_context)
    vg_visitors_remove(&http->visitors, info->socket_context);
}

/* --- replies ------------------------------------------------------------- */

static ssize_t read_archive(void *user, uint64_t at, char *to, size_t most)
{
  ssize_t n = vg_archive_read(user, to, most);

  (void)at;
  if (n > 0) return n;
  return n ? MHD_CONTENT_READER_END_WITH_ERROR
           : MHD_CONTENT_READER_END_OF_STREAM;
}

static void free_archive(void *user)
{
  vg_archive_free(user);
}

static struct MHD_Response *response_of(const struct library *lib,
                                        struct vg_reply *a)
{
  struct MHD_Response *response;
  struct stat s;

  if (a->archive) {
    response = lib->MHD_create_response_from_callback(vg_archive_size(
                                                        a->archive),
                                                      65536, read_archive,
                                                      a->archive, free_archive);
    if (response) a->archive = NULL;
    return response;
  }
  if (a->fd < 0) {
    response = lib->MHD_create_response_from_buffer(a->size, a->body,
                                                    MHD_RESPMEM_MUST_FREE);
    if (response) a->body = NULL;
    return response;
  }
  if (fstat(a->fd, &s)) return NULL;
  response = lib->MHD_create_response_from_fd64((uint64_t)s.st_size, a->fd);
  if (response) a->fd = -1;
  return response;
}

/* The headers forbid framing, caching and guessing of the media type. */
static void add_headers(const struct library *lib,
                        struct MHD_Response *response, const struct vg_reply *a)
{
  const struct {
    const char *name, *value;
  } fixed[] = {
    { "Content-Type", a->type ? a->type : "text/html; charset=utf-8" },
    { "Content-Security-Policy", a->policy ? a->policy : own_policy },
    { "X-Content-Type-Options", "nosniff" },
    { "X-Frame-Options", a->in_frame ? "SAMEORIGIN" : "DENY" },
    { "Referrer-Policy", "same-origin" },
    { "Cross-Origin-Resource-Policy", "same-origin" },
    { "Cross-Origin-Opener-Policy", "same-origin" },
    { "Cache-Control", a->is_fixed ? "private, max-age=86400" : "no-store" }
  };
  char *save;

  for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
    lib->MHD_add_response_header(response, fixed[i].name, fixed[i].value);
  if (a->location)
    lib->MHD_add_response_header(response, "Location", a->location);
  if (a->status == 405)
    lib->MHD_add_response_header(response, "Allow", "GET, HEAD, POST");
  if (a->download &&
      asprintf(&save, "attachment; filename=\"%s\"", a->download) >= 0) {
    lib->MHD_add_response_header(response, "Content-Disposition", save);
    free(save);
  }
}

static enum MHD_Result answer(const struct vg_http *http,
                              struct MHD_Connection *connection,
                              struct vg_reply *a)
{
  struct MHD_Response *response = response_of(&http->lib, a);
  enum MHD_Result queued = MHD_NO;

  if (response) {
    add_headers(&http->lib, response, a);
    queued = http->lib.MHD_queue_response(connection, (unsigned)a->status,
                                          response);
    http->lib.MHD_destroy_response(response);
  }
  if (a->fd >= 0) close(a->fd);
  vg_archive_free(a->archive);
  free(a->body);
  free(a->location);
  free(a->download);
  return queued;
}

static enum MHD_Result too_many_headers(const struct vg_http *http,
                                        struct MHD_Connection *connection)
{
  struct vg_reply a = VG_REPLY_INIT;

  a.status = 431;
  a.type = "text/plain; charset=utf-8";
  a.body = strdup("too many headers\n");
  a.size = a.body ? strlen(a.body) : 0;
  return answer(http, connection, &a);
}

/* --- one request --------------------------------------------------------- */

/* The headers of a request have arrived. */
static enum MHD_Result head(struct vg_http *http,
                            struct MHD_Connection *connection, const char *path,
                            const char *method, void **state)
{
  struct vg_reply a = VG_REPLY_INIT;
  struct call *c;
  int is_answered;
  int n = http->lib.MHD_get_connection_values(connection, MHD_HEADER_KIND, NULL,
                                              NULL);

  if (n > VG_HTTP_HEADERS) return too_many_headers(http, connection);
  c = begin_call(http, connection, path, method);
  if (!c) return MHD_NO;
  *state = c;
  is_answered = http->h->begin(http->h->user, &c->r, &a);
  if (c->r.is_trusted) trust(http, connection);
  if (is_answered) return answer(http, connection, &a);
  if (!strcmp(method, "POST")) /* NULL if the body is not a form, or absent */
    c->post = http->lib.MHD_create_post_processor(connection, 65536, take_field,
                                                  c);
  return MHD_YES;
}

/* Handle the pieces of the body, and its end. A rejected body is read to its
 * end and discarded, so that the browser receives the reply. */
static enum MHD_Result handle(void *user, struct MHD_Connection *connection,
                              const char *path, const char *method,
                              const char *version, const char *data,
                              size_t *size, void **state)
{
  struct vg_http *http = user;
  struct vg_reply a = VG_REPLY_INIT;
  struct call *c = *state;

  (void)version;
  if (!c) return head(http, connection, path, method, state);
  if (*size) {
    if (c->r.body >= 0 &&
        (!c->post ||
         http->lib.MHD_post_process(c->post, data, *size) == MHD_NO) &&
        c->r.body >= 0)
      c->r.body = vg_fail(&c->r.error, VG_ERR_INPUT,
                          "the body is not a form, or "
                          "it is damaged");
    *size = 0;
    return MHD_YES;
  }
  if (c->post) { /* destroying it delivers a last piece */
    http->lib.MHD_destroy_post_processor(c->post);
    c->post = NULL;
  }
  http->h->end(http->h->user, &c->r, &a);
  return answer(http, connection, &a);
}

/* --- the server ---------------------------------------------------------- */

static void say_nothing(void *user, const char *format, va_list args)
{
  (void)user, (void)format, (void)args;
}

vg_status vg_http_open(int fd, const struct vg_http_handler *h,
                       struct vg_http **out, struct vg_error *err)
{
  struct vg_http *http = vg_calloc(1, sizeof *http);
  unsigned flags = MHD_USE_ERROR_LOG | MHD_USE_EPOLL;
  vg_status st;

  if (!http) return vg_fail_memory(err, "the server");
  http->h = h;
  vg_visitors_init(&http->visitors);
  st = load(&http->lib, err);
  if (st < 0 && fd >= 0) close(fd);
  if (st < 0) goto done;
  if (fd < 0) flags |= MHD_USE_NO_LISTEN_SOCKET;
  http->daemon = http->lib.MHD_start_daemon(
    flags, 0, NULL, NULL, handle, http, MHD_OPTION_EXTERNAL_LOGGER, say_nothing,
    NULL, MHD_OPTION_NOTIFY_COMPLETED, completed, NULL,
    MHD_OPTION_NOTIFY_CONNECTION, connected, http, MHD_OPTION_CONNECTION_LIMIT,
    (unsigned)VG_HTTP_CONNECTIONS, MHD_OPTION_CONNECTION_TIMEOUT,
    (unsigned)VG_HTTP_SILENCE_S, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
    (size_t)VG_HTTP_HEAD_BYTES, MHD_OPTION_STRICT_FOR_CLIENT, 1,
    fd < 0 ? MHD_OPTION_END : MHD_OPTION_LISTEN_SOCKET, fd, MHD_OPTION_END);
  if (!http->daemon) {
    st = vg_fail(err, VG_ERR_IO, "the web server cannot be started");
    goto done;
  }
  *out = http;
  return VG_OK;
done:
  vg_http_close(http);
  return st;
}

void vg_http_close(struct vg_http *http)
{
  if (!http) return;
  if (http->daemon) http->lib.MHD_stop_daemon(http->daemon);
  /* The library is not unloaded: GnuTLS may have left handlers behind. */
  free(http);
}

vg_status vg_http_connect(struct vg_http *http, int fd, struct vg_error *err)
{
  struct sockaddr from = { .sa_family = AF_UNIX };

  if (http->lib.MHD_add_connection(http->daemon, fd, &from, sizeof from) ==
      MHD_YES)
    return VG_OK;
  return vg_fail(err, VG_ERR_IO, "the web server rejected a connection");
}

vg_status vg_http_step(struct vg_http *http, int milliseconds,
                       struct vg_error *err)
{
  vg_visitors_expire(&http->visitors, vg_clock() - VG_HTTP_VISIT_S);
  if (http->lib.MHD_run_wait(http->daemon, milliseconds) == MHD_YES)
    return VG_OK;
  return vg_fail(err, VG_ERR_IO, "the web server has failed");
}
