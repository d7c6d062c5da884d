/* The parts of a portal. */
#ifndef VG_CLI_SERVE_PORTAL_PARTS_H
#define VG_CLI_SERVE_PORTAL_PARTS_H

#include <stdio.h>

#include "cli/serve/http.h"
#include "cli/serve/portal.h"
#include "cli/serve/runs.h"

enum { VG_TOKEN_DIGITS = 32 };

struct vg_portal {
  struct vg_portal_options o;
  char *root, *dir; /* real paths: projects, runs */
  char token[VG_TOKEN_DIGITS + 1];
  char *url, *url_file;
  char *host[6]; /* names by which it may be called */
  int n_host, lock, has_slurm;
  struct vg_http *http;
  struct vg_http_handler handler;
  struct vg_serve_runs runs;
};

/** gate.c: whether a request may pass, by its head alone: 1 and *rest is what
 * follows the token in its path; 0 and *a says why not. Bodies are bounded,
 * POSTs come from the portal's own pages. */
int vg_gate(const struct vg_portal *p, const struct vg_request *r,
            const char **rest, struct vg_reply *a);

/** 1 when the header Host names one of the hosts, with any port: tunnels
 * change it. */
int vg_gate_host(const struct vg_portal *p, const char *host);

/** reply.c: an answer of one line; a page of a message; the address to go
 * to. */
void vg_reply_text(struct vg_reply *a, int status, const char *text);
void vg_reply_go(const struct vg_portal *p, struct vg_reply *a, const char *to);

/** A file of a run, which stays open until it is sent: `name` relative to its
 * folder. */
void vg_reply_file(const struct vg_serve_run *run, const char *name,
                   struct vg_reply *a);

/** routes.c: what is asked for. */
void vg_route(struct vg_portal *p, struct vg_request *r, const char *rest,
              struct vg_reply *a);

/** page.c: the page, for a project or from the settings of a run (NULL: none);
 * with a message and what was sent where that was refused.
 * page_runs.c: the list of runs, as a part of the page and as JSON. */
struct vg_page_view {
  const char *project, *message;
  const struct vg_fields *posted;
  const struct vg_serve_run *from;
};
void vg_page(const struct vg_portal *p, const struct vg_page_view *v, FILE *to);
void vg_page_runs(const struct vg_portal *p, FILE *to);
char *vg_page_runs_json(const struct vg_portal *p);

#endif
