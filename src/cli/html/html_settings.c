/* What was asked, what was settled by the program, and all the rest. */
#include <stdio.h>
#include <string.h>

#include "cli/html/asked.h"
#include "cli/html/page.h"

enum which { ASKED, SETTLED, REST, WHICH_N };

static enum which which_of(const char *usual, const char *asked,
                           const char *now)
{
  if (asked && strcmp(usual, asked) != 0) return ASKED;
  return strcmp(asked ? asked : usual, now) ? SETTLED : REST;
}

static void row(struct page *p, const struct vg_param *param, int is_far,
                const char *asked, const char *now)
{
  vg_page_format(p, "<tr><th scope=\"row\"><code>%s%s</code></th><td>",
                 is_far ? "farfield " : "", param->name);
  vg_page_text(p, asked && *asked ? asked : *now ? now : "\"\"");
  if (*param->unit) vg_page_format(p, " %s", param->unit);
  if (asked && strcmp(asked, now) != 0) {
    vg_page_markup(p, ", settled as ");
    vg_page_text(p, *now ? now : "\"\"");
  }
  vg_page_markup(p, "</td><td class=\"words\">");
  vg_page_text(p, param->help);
  vg_page_markup(p, "</td></tr>\n");
}

/* Rows of one kind; `threads` tells of the run, not of the mesh. */
static size_t rows(struct page *p, const struct vg_settings *usual,
                   enum which which)
{
  const struct vg_settings *s = &p->h->problem->settings;
  const struct vg_asked *a = p->h->asked;
  const struct vg_param *param;
  const void *base, *usual_base;
  char now[2 * VG_LIST_MAX + 4], was[2 * VG_LIST_MAX + 4];
  size_t n = 0, all = vg_asked_params(s, SIZE_MAX, &param, &base), plain;

  vg_settings_params(&plain);
  for (size_t i = 0; i < all; i++) {
    const char *asked = i < a->n ? a->value[i] : NULL;

    vg_asked_params(usual, i, &param, &usual_base);
    vg_asked_params(s, i, &param, &base);
    if (!strcmp(param->name, "threads") || !strcmp(param->name, "schedule"))
      continue;            /* no part of what the mesh follows from */
    vg_param_format(param, base, now, sizeof now);
    vg_param_format(param, usual_base, was, sizeof was);
    if (which_of(was, asked, now) != which) continue;
    row(p, param, i >= plain, which == ASKED ? asked : NULL, now);
    n++;
  }
  return n;
}

static void table(struct page *p, const struct vg_settings *usual,
                  enum which which, const char *none)
{
  vg_page_markup(p, "<div class=\"wide\"><table class=\"settings\">\n");
  if (!rows(p, usual, which))
    vg_page_format(p, "<tr><td>%s</td></tr>\n", none);
  vg_page_markup(p, "</table></div>\n");
}

void vg_html_settings(struct page *p)
{
  const struct vg_settings *s = &p->h->problem->settings;
  struct vg_settings usual;

  vg_settings_default(&usual);
  vg_page_section(p, "settings", "What was asked and what was assumed");
  vg_page_markup(p, "<h3>Asked, by deck, project and command line</h3>\n");
  table(p, &usual, ASKED, "Nothing: all settings had their defaults.");
  vg_page_markup(p, "<h3>Settled by the program</h3>\n");
  table(p, &usual, SETTLED, "Nothing.");
  if (s->n_source)
    vg_page_format(p, "<p>Sources of spacing: %zu. They are listed in "
                   "PROJECT.resolved.deck, as is every setting of single "
                   "patches.</p>\n", s->n_source);
  vg_page_markup(p, "<details><summary>All other settings, at their "
                    "defaults</summary>\n");
  table(p, &usual, REST, "None.");
  vg_page_markup(p, "</details>\n");
  vg_page_end_section(p);
  vg_settings_release(&usual);
}
