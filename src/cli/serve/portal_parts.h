/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: the structure of a portal. */
#ifndef VG_CLI_SERVE_PORTAL_PARTS_H
#define VG_CLI_SERVE_PORTAL_PARTS_H

#include <stdio.h>

#include "cli/serve/form.h"
#include "cli/http/http.h"
#include "cli/serve/looks.h"
#include "cli/serve/portal.h"
#include "cli/serve/runs.h"

enum { VG_TOKEN_DIGITS = 32 };

struct vg_portal {
  struct vg_portal_options o;
  char *root, *dir; /* real paths: projects, runs */
  char token[VG_TOKEN_DIGITS + 1];
  char *url, *url_file;
  char *host[6]; /* accepted values of the header Host */
  int n_host, lock, has_slurm;
  struct vg_http *http;
  struct vg_http_handler handler;
  struct vg_serve_runs runs;
  struct vg_looks looks;
};

/** gate.c: decides from the headers whether a request is accepted. Returns 1,
 * with *rest the part of the path after the token, or 0, with the reason in
 * *a. The size of bodies is limited, and POST requests must come from the
 * portal's own pages. */
int vg_gate(const struct vg_portal *p, const struct vg_request *r,
            const char **rest, struct vg_reply *a);

/** Returns 1 if the header Host names one of the hosts. Any port is accepted,
 * since tunnels change it. */
int vg_gate_host(const struct vg_portal *p, const char *host);

/** reply.c: a reply with one line of text; a redirection. */
void vg_reply_text(struct vg_reply *a, int status, const char *text);
void vg_reply_go(const struct vg_portal *p, struct vg_reply *a, const char *to);

/** Reply with a file of a run, which stays open until it is sent; `name` is
 * relative to the folder of the run. */
void vg_reply_file(const struct vg_serve_run *run, const char *name,
                   struct vg_reply *a);

void vg_reply_missing(struct vg_reply *a);

/** Reply with a file of this folder for scripts of the portal, as bytes. */
void vg_reply_bytes(const char *dir, const char *name, struct vg_reply *a);

/** routes.c: answers an accepted request. */
void vg_route(struct vg_portal *p, struct vg_request *r, const char *rest,
              struct vg_reply *a);

/** routes_looks.c: the paths below looks/, by GET and POST. */
void vg_route_look(const struct vg_portal *p, const char *path,
                   struct vg_reply *a);
void vg_route_to_look(struct vg_portal *p, const struct vg_request *r,
                      const char *path, struct vg_reply *a);

/** The settings of a form and how to run it; a message for the user and the
 * field that is wrong on failure. *s must hold no rows; the caller releases
 * it. */
vg_status vg_take_form(const struct vg_portal *p, const struct vg_fields *f,
                       struct vg_settings *s, struct vg_serve_run *run,
                       struct vg_form_fault *fault, struct vg_error *err);

/** Runs of a comparison. */
enum { VG_COMPARED_MAX = 4 };
struct vg_compared {
  size_t n;
  const struct vg_serve_run *run[VG_COMPARED_MAX];
};

/** page.c: the page, with the form of a project or with the settings of a run
 * (NULL: no form). If a form was rejected, the page shows the message, at its
 * field if it is known, and the values that were posted.
 * page_runs.c: the list of runs, as part of the page and as JSON.
 * page_results.c: what pages of results show instead of projects and runs. */
struct vg_page_view {
  const char *project, *message;
  const struct vg_fields *posted;
  const struct vg_form_fault *fault;
  const struct vg_serve_run *from;
  const char *uploaded;               /* Uploaded file that is no project. */
  const struct vg_serve_run *report;  /* Show its report. */
  const struct vg_serve_run *sweep;   /* Show its figures. */
  const struct vg_compared *compared; /* Compare them. */
};
void vg_page_report(const struct vg_serve_run *run, FILE *to);
void vg_page_compare(const struct vg_compared *c, FILE *to);
void vg_page_sweep(const struct vg_serve_run *run, FILE *to);
void vg_page(const struct vg_portal *p, const struct vg_page_view *v, FILE *to);
void vg_page_runs(const struct vg_portal *p, FILE *to);
char *vg_page_runs_json(const struct vg_portal *p);

#endif
