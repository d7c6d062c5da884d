/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Settings: requested ones, those resolved by the program, and the rest. */
#include <stdio.h>
#include <string.h>

#include "cli/html/page.h"

enum which { ASKED, SETTLED, REST, WHICH_N };

static enum which which_of(const char *usual, const char *asked,
                           const char *now)
{
  if (strcmp(usual, asked) != 0) return ASKED;
  return strcmp(asked, now) ? SETTLED : REST;
}

static void row(struct page *p, const struct vg_param *param, int is_far,
                const char *asked, const char *now)
{
  vg_page_format(p, "<tr><th scope=\"row\"><code>%s%s</code></th><td>",
                 is_far ? "farfield " : "", param->name);
  vg_page_text(p, asked && *asked ? asked : *now ? now : "\"\"");
  if (*param->unit) vg_page_format(p, " %s", param->unit);
  if (asked && strcmp(asked, now) != 0) {
    vg_page_markup(p, ", resolved to ");
    vg_page_text(p, *now ? now : "\"\"");
  }
  vg_page_markup(p, "</td><td class=\"words\">");
  vg_page_text(p, param->help);
  vg_page_markup(p, "</td></tr>\n");
}

/* Description of setting i: plain settings, then columns of the farfield table.
 * *base is the structure in s to which its offset refers. NULL past the last
 * setting. */
static const struct vg_param *param_of(const struct vg_settings *s, size_t i,
                                       int *is_far, const void **base)
{
  const struct vg_setting_table *far = vg_settings_table(VG_TABLE_FARFIELD);
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  *is_far = i >= n;
  *base = *is_far ? (const void *)&s->farfield : (const void *)s;
  if (i < n) return &p[i];
  return i - n < far->n_column ? &far->column[i - n] : NULL;
}

/* Write the rows of one kind; returns their number. */
static size_t rows(struct page *p, const struct vg_settings *usual,
                   enum which which)
{
  const struct vg_problem *q = p->h->problem;
  const struct vg_settings *of[3] = { usual, &q->asked, &q->resolved.settings };
  const struct vg_param *param;
  char value[3][2 * VG_LIST_MAX + 4];
  const void *base;
  size_t n = 0;
  int far;

  for (size_t i = 0; (param = param_of(usual, i, &far, &base)); i++) {
    if (!strcmp(param->name, "threads") || !strcmp(param->name, "schedule"))
      continue; /* may differ between runs that make the same page */
    for (int k = 0; k < 3; k++) {
      param_of(of[k], i, &far, &base);
      vg_param_format(param, base, value[k], sizeof value[k]);
    }
    if (which_of(value[0], value[1], value[2]) != which) continue;
    row(p, param, far, which == ASKED ? value[1] : NULL, value[2]);
    n++;
  }
  return n;
}

static void table(struct page *p, const struct vg_settings *usual,
                  enum which which, const char *none)
{
  vg_page_markup(p, "<div class=\"wide\"><table class=\"settings\">\n");
  if (!rows(p, usual, which)) vg_page_format(p, "<tr><td>%s</td></tr>\n", none);
  vg_page_markup(p, "</table></div>\n");
}

void vg_html_settings(struct page *p)
{
  const struct vg_settings *s = &p->h->problem->resolved.settings;
  struct vg_settings usual;

  vg_settings_default(&usual);
  vg_page_section(p, "settings", "Settings");
  vg_page_markup(p, "<h3>Requested by deck, project or command line</h3>\n");
  table(p, &usual, ASKED, "None: all settings have their defaults.");
  vg_page_markup(p, "<h3>Resolved by the program</h3>\n");
  table(p, &usual, SETTLED, "None.");
  if (s->n_source)
    vg_page_format(p,
                   "<p>Sources of spacing: %zu. They are listed in "
                   "PROJECT.resolved.deck, together with the settings of "
                   "individual patches.</p>\n",
                   s->n_source);
  vg_page_markup(p, "<details><summary>All other settings (defaults)"
                    "</summary>\n");
  table(p, &usual, REST, "None.");
  vg_page_markup(p, "</details>\n");
  vg_page_end_section(p);
  vg_settings_release(&usual);
}
