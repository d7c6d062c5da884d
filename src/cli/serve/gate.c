/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Access control of requests. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/serve/portal_parts.h"

/* Bytes that a form adds to its files. */
#define FORM_AROUND 65536

/* Length of the host in "[::1]:80" or "localhost:80", without the port; 0: not
 * a host. */
static size_t host_length(const char *host)
{
  size_t n = *host == '[' ? strcspn(host, "]") + 1 : strcspn(host, ":");

  if (n > strlen(host)) return 0;
  if (!host[n]) return n;
  return host[n] == ':' &&
             strspn(host + n + 1, "0123456789") == strlen(host + n + 1)
         ? n
         : 0;
}

int vg_gate_host(const struct vg_portal *p, const char *host)
{
  size_t n = host_length(host);

  for (int i = 0; n && i < p->n_host; i++)
    if (strlen(p->host[i]) == n && !strncasecmp(p->host[i], host, n)) return 1;
  return 0;
}

/* Comparison in constant time. */
static int is_token(const struct vg_portal *p, const char *text, size_t n)
{
  unsigned differ = n != VG_TOKEN_DIGITS;

  for (size_t i = 0; i < VG_TOKEN_DIGITS; i++)
    differ |= (unsigned)(p->token[i] ^ (i < n ? text[i] : 0));
  return !differ;
}

/* A page of another origin cannot send the portal's origin in this header. */
static int is_own_origin(const struct vg_request *r)
{
  return !strncmp(r->origin, "http://", 7) &&
         !strcasecmp(r->origin + 7, r->host);
}

int vg_gate(const struct vg_portal *p, const struct vg_request *r,
            const char **rest, struct vg_reply *a)
{
  int is_post = !strcmp(r->method, "POST");
  const char *path = r->path + (*r->path == '/');
  size_t n = strcspn(path, "/");
  int64_t most;

  if (!vg_gate_host(p, r->host)) {
    vg_reply_text(a, 403, "Requests with this host name are not accepted.");
    return 0;
  }
  if (!is_post && strcmp(r->method, "GET") && strcmp(r->method, "HEAD")) {
    vg_reply_text(a, 405, "Only GET, HEAD and POST are supported.");
    return 0;
  }
  if (!is_token(p, path, n)) {
    vg_reply_text(a, 403,
                  "The token in the address is missing or wrong. Open the "
                  "address that vanguard serve printed.");
    return 0;
  }
  *rest = path + n;
  most = !strcmp(*rest, "/upload") ? p->o.max_upload + FORM_AROUND
                                   : VG_FIELDS_BYTES;
  if (is_post && !is_own_origin(r)) {
    vg_reply_text(a, 403,
                  "Forms are accepted from the portal's own pages only "
                  "(header Origin).");
    return 0;
  }
  if (r->length > (is_post ? most : 0)) {
    vg_reply_text(a, 413,
                  "The request is too large: the limit is 1 MB for a form, "
                  "and --max-upload for files.");
    return 0;
  }
  return 1;
}
