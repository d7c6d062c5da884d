/* The page of the portal. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "cli/serve/form.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "cli/serve/projects.h"

/* Without scripts the page reloads itself while runs are active, but not while
 * it shows the form, which the user may be filling in. */
static void print_head(const struct vg_portal *p, int may_reload, FILE *to)
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
  if (may_reload && vg_portal_active(p))
    fputs("<noscript><meta http-equiv=\"refresh\" content=\"5\"></noscript>\n",
          to);
  fputs("</head>\n<body>\n<header><h1>Vanguard</h1> <p class=\"about\">", to);
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

static void print_message(const char *message, FILE *to)
{
  if (!message || !*message) return;
  fputs("<p class=\"message\" role=\"alert\">", to);
  vg_markup(to, message);
  fputs("</p>\n", to);
}

/* The form shows the settings of a run from the deck of the run, else those of
 * the project from the deck of the project. */
static void print_form(const struct vg_portal *p, const struct vg_page_view *v,
                       FILE *to)
{
  static const struct vg_fields nothing = VG_FIELDS_INIT;
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char path[4096];
  const char *deck = v->from ? vg_run_path(v->from, "run.deck", path) : NULL;

  if (!v->project || !*v->project) {
    print_message(v->message, to);
    return;
  }
  fputs("<section id=\"form\"><h2>New run of ", to);
  vg_markup(to, v->project);
  fputs("</h2>\n", to);
  print_message(v->message, to);
  if (vg_project_settings(p->root, v->project, deck, &s, &err) < 0)
    print_message(err.text, to);
  else
    vg_form_print(to, v->project, &s, v->posted ? v->posted : &nothing,
                  p->has_slurm);
  vg_settings_release(&s);
  fputs("</section>\n", to);
}

void vg_page(const struct vg_portal *p, const struct vg_page_view *v, FILE *to)
{
  print_head(p, !v->project, to);
  fputs("<main>\n<div class=\"side\">\n", to);
  print_projects(p, v->project, to);
  fputs("</div>\n<div class=\"work\">\n", to);
  print_form(p, v, to);
  fputs("<section id=\"runs\"><h2>Runs</h2>\n", to);
  vg_page_runs(p, to);
  fputs("</section>\n</div>\n</main>\n</body>\n</html>\n", to);
}
