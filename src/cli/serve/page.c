/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The page of the portal. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "cli/serve/form.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/projects.h"
#include "io/mesh/format.h"

/* Without scripts the page reloads itself while runs are active, but not while
 * it shows the form, which the user may be filling in. */
static void print_head(const struct vg_portal *p, int has_form, int may_reload,
                       FILE *to)
{
  fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
        "<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n"
        "<title>Vanguard</title>\n"
        "<link rel=\"stylesheet\" href=\"portal.css\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n"
        "<script src=\"portal.js\" defer></script>\n",
        to);
  if (has_form)
    fputs("<script src=\"view.js\" defer></script>\n"
          "<script type=\"module\" src=\"form.js\"></script>\n"
          "<script type=\"module\" src=\"case.js\"></script>\n",
          to);
  if (may_reload && vg_portal_active(p))
    fputs("<noscript><meta http-equiv=\"refresh\" content=\"5\"></noscript>\n",
          to);
  fputs("</head>\n<body>\n<header><h1><a href=\"./\">Vanguard</a></h1> "
        "<p class=\"about\">",
        to);
  vg_markup(to, p->root);
  fprintf(to, " &middot; %d simultaneous run%s%s</p></header>\n", p->o.jobs,
          p->o.jobs > 1 ? "s" : "", p->has_slurm ? " &middot; Slurm" : "");
}

static void print_upload(const struct vg_portal *p, FILE *to)
{
  fputs("<form class=\"upload\" method=\"post\" action=\"upload\" "
        "enctype=\"multipart/form-data\">\n<label>Folder <input "
        "name=\"folder\" placeholder=\"folder of all projects\" "
        "autocomplete=\"off\"></label>\n<label>Files (at most ",
        to);
  vg_markup_size(to, p->o.max_upload);
  fputs(") <input type=\"file\" name=\"file\" multiple required></label>\n"
        "<button>Upload</button>\n</form>\n",
        to);
}

static void print_projects(const struct vg_portal *p, const char *chosen,
                           FILE *to)
{
  struct vg_projects list = VG_PROJECTS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  fputs("<section id=\"projects\"><h2>Projects</h2>\n", to);
  if (vg_projects_list(p->root, &list, &err) < 0) {
    fputs("<p class=\"note\">", to);
    vg_markup(to, err.text);
    fputs("</p>\n", to);
  }
  fputs(list.n
          ? "<ul>\n"
          : "<p class=\"about\">There is no surface or .d3m file "
            "yet. Upload one, or write an example with 'vanguard demo'.</p>\n",
        to);
  for (size_t i = 0; i < list.n; i++) {
    int is_it = chosen && !strcmp(chosen, list.item[i].name);

    fprintf(to, "<li%s><a href=\"?project=",
            is_it ? " class=\"chosen\" aria-current=\"true\"" : "");
    vg_markup_path(to, list.item[i].name);
    fputs("#form\">", to);
    vg_markup(to, list.item[i].name);
    fputs("</a> <i>", to);
    vg_markup_size(to, list.item[i].size);
    fputs("</i></li>\n", to);
  }
  if (list.n) fputs("</ul>\n", to);
  if (list.is_cut)
    fputs("<p class=\"about\">The list may be incomplete.</p>\n", to);
  vg_projects_release(&list);
  print_upload(p, to);
  fputs("</section>\n", to);
}

/* Says that an uploaded file is not a project, and where it can be of use. */
static void print_uploaded(const char *name, FILE *to)
{
  if (!name) return;
  fputs("<p class=\"message warn\" role=\"status\"><b>", to);
  vg_markup(to, name);
  fputs("</b> was uploaded, but it is not a project: the "
        "suffix belongs neither to a surface (",
        to);
  vg_markup(to, vg_format_list());
  fputs(") nor to a VGRID project (d3m). It stays in its folder. A .mapbc, "
        ".deck, .front, .tags or .bc file belongs to the project with the same "
        "stem.</p>\n",
        to);
}

static void print_message(const char *message, FILE *to)
{
  if (!message || !*message) return;
  fputs("<p class=\"message\" role=\"alert\">", to);
  vg_markup(to, message);
  fputs("</p>\n", to);
}

/* The part that the scripts fill: 3-D view, patches, findings. */
static void print_geometry(FILE *to)
{
  fputs("<div id=\"geometry\"><noscript><p class=\"about\">With scripts, the "
        "surface with its patches and the buttons Check and Plan are here."
        "</p></noscript></div>\n",
        to);
}

/* A link from the message to the field that is wrong. */
static void print_fault(const struct vg_page_view *v, FILE *to)
{
  if (!v->message || !*v->message) return;
  fputs("<p class=\"message\" role=\"alert\">", to);
  vg_markup(to, v->message);
  if (v->fault && *v->fault->field) {
    fputs(" <a href=\"#", to);
    vg_markup(to, v->fault->field);
    fputs("\">Go to the field</a>", to);
  }
  fputs("</p>\n", to);
}

/* The form shows the settings of a run from the deck of the run, else those of
 * the project from the deck of the project. */
static void print_form(const struct vg_portal *p, const struct vg_page_view *v,
                       FILE *to)
{
  static const struct vg_fields nothing = VG_FIELDS_INIT;
  static const struct vg_form_fault no_fault = VG_FORM_FAULT_INIT;
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char path[4096];
  const char *deck = v->from ? vg_run_path(v->from, "run.deck", path) : NULL;
  const struct vg_form_view form = { v->project,
                                     &s,
                                     v->posted ? v->posted : &nothing,
                                     v->fault ? v->fault : &no_fault,
                                     v->message,
                                     p->has_slurm };

  if (!v->project || !*v->project) {
    print_message(v->message, to);
    return;
  }
  fputs("<section id=\"form\"><h2>", to);
  vg_markup(to, v->project);
  fputs("</h2>\n", to);
  print_fault(v, to);
  if (vg_project_settings(p->root, v->project, deck, &s, &err) < 0) {
    print_message(err.text, to);
  } else {
    fputs("<div class=\"case\">\n", to);
    print_geometry(to);
    vg_form_print(to, &form);
    fputs("</div>\n", to);
  }
  vg_settings_release(&s);
  fputs("</section>\n", to);
}

/* Projects, form and runs. */
static void print_home(const struct vg_portal *p, const struct vg_page_view *v,
                       FILE *to)
{
  fputs("<main>\n<div class=\"side\">\n", to);
  print_projects(p, v->project, to);
  fputs("</div>\n<div class=\"work\">\n", to);
  print_uploaded(v->uploaded, to);
  print_form(p, v, to);
  fputs("<section id=\"runs\"><h2>Runs</h2>\n"
        "<form id=\"compare\" method=\"get\" action=\"./\"><button>Compare "
        "selected runs</button> <span class=\"about\">two to four finished "
        "meshes</span></form>\n",
        to);
  vg_page_runs(p, to);
  fputs("</section>\n</div>\n</main>\n", to);
}

void vg_page(const struct vg_portal *p, const struct vg_page_view *v, FILE *to)
{
  int is_result = v->report || v->sweep || v->compared;

  print_head(p, v->project && !is_result, !v->project && !is_result, to);
  if (is_result) {
    fputs("<main class=\"results\">\n<p class=\"back\"><a href=\"./#runs\">"
          "&larr; Runs</a></p>\n",
          to);
    if (v->report) vg_page_report(v->report, to);
    else if (v->sweep) vg_page_sweep(v->sweep, to);
    else vg_page_compare(v->compared, to);
    fputs("</main>\n", to);
  } else {
    print_home(p, v, to);
  }
  fputs("</body>\n</html>\n", to);
}
