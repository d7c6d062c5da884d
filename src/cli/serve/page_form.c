/* The form of a run. Declared in cli/serve/form.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "cli/serve/form.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/rows.h"

#define VALUE_SIZE (2 * VG_LIST_MAX + 4)

/* Settings are shown in the order of their rows; a group begins at the setting
 * that is named here. */
static const struct group {
  const char *first, *title;
  int is_open;
} groups[] = {
  { "scale", "Edge lengths", 1 },
  { "unit", "CAD", 0 },
  { "weld", "Surface", 0 },
  { "optimise", "Cells and files", 0 },
  { "mesher", "Subdomains, ranks and threads", 0 },
  { "layers", "Viscous layers", 1 },
  { "min_full", "Limits on the layers", 0 },
};

static const struct group *group_at(const char *name)
{
  for (size_t k = 0; k < sizeof groups / sizeof *groups; k++)
    if (!strcmp(groups[k].first, name)) return &groups[k];
  return NULL;
}

/* Value for the form: texts without quotes, all others as in the deck. */
static void value_of(const struct vg_param *p, const void *base, char *text)
{
  if (p->type == VG_PARAM_TEXT)
    snprintf(text, VALUE_SIZE, "%.*s", VALUE_SIZE - 1,
             (const char *)base + p->offset);
  else vg_param_format(p, base, text, VALUE_SIZE);
}

static void print_choice(FILE *to, const char *const *words, const char *value)
{
  for (size_t i = 0; words[i]; i++) {
    fprintf(to, "<option%s>", strcmp(words[i], value) ? "" : " selected");
    vg_markup(to, words[i]);
    fputs("</option>", to);
  }
}

static void print_control(FILE *to, const struct vg_param *p, const char *name,
                          const char *value, const char *otherwise)
{
  static const char *const yes_no[] = { "no", "yes", NULL };
  int is_choice = p->type == VG_PARAM_FLAG || p->type == VG_PARAM_WORD;

  fputs(is_choice ? "<select"
                  : "<input autocomplete=\"off\" "
                    "spellcheck=\"false\"",
        to);
  vg_markup_attribute(to, "id", name);
  vg_markup_attribute(to, "name", name);
  vg_markup_attribute(to, "data-default", otherwise);
  if (!is_choice) {
    vg_markup_attribute(to, "value", value);
    vg_markup_attribute(to, "placeholder", otherwise);
    if (p->type != VG_PARAM_TEXT) fputs(" class=\"number\"", to);
  }
  fputs(">", to);
  if (!is_choice) return;
  print_choice(to, p->type == VG_PARAM_FLAG ? yes_no : p->words, value);
  fputs("</select>", to);
}

/* Row of a setting: name, control, unit, help and default. */
static void print_param(FILE *to, const struct vg_param *p, const char *prefix,
                        const void *base, const void *defaults,
                        const struct vg_fields *posted)
{
  char name[64], value[VALUE_SIZE], otherwise[VALUE_SIZE];
  const char *sent;

  snprintf(name, sizeof name, "%s.%s", prefix, p->name);
  value_of(p, defaults, otherwise);
  value_of(p, base, value);
  sent = vg_fields_get(posted, name);
  if (!sent) sent = value;
  fprintf(to, "<div class=\"row%s\"><label",
          *sent && strcmp(sent, otherwise) ? " changed" : "");
  vg_markup_attribute(to, "for", name);
  fputs(">", to);
  vg_markup(to, p->name);
  fputs("</label><span class=\"value\">", to);
  print_control(to, p, name, sent, otherwise);
  fputs(" <i>", to);
  vg_markup(to, p->unit);
  fputs("</i></span><span class=\"help\">", to);
  vg_markup(to, p->help);
  fputs(" <b>default ", to);
  vg_markup(to, *otherwise ? otherwise : "\"\"");
  fputs("</b></span></div>\n", to);
}

static void begin_group(FILE *to, const char *title, int is_open,
                        const char *about)
{
  fprintf(to, "<details class=\"group\"%s><summary>%s</summary>\n",
          is_open ? " open" : "", title);
  if (!about) return;
  fputs("<p class=\"about\">", to);
  vg_markup(to, about);
  fputs("</p>\n", to);
}

static void print_settings(FILE *to, const struct vg_settings *s,
                           const struct vg_fields *posted)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  struct vg_settings defaults;

  vg_settings_default(&defaults);
  for (size_t i = 0; i < n; i++) {
    const struct group *g = group_at(p[i].name);

    if (g) {
      if (i) fputs("</details>\n", to);
      begin_group(to, g->title, g->is_open, NULL);
    }
    print_param(to, &p[i], "s", s, &defaults, posted);
  }
  fputs("</details>\n", to);
}

static void print_row(FILE *to, enum vg_table_kind kind, const char *title,
                      const struct vg_settings *s,
                      const struct vg_fields *posted)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  union {
    struct vg_farfield_row f;
    struct vg_sweep_row w;
  } defaults;

  vg_settings_row_default(kind, &defaults);
  begin_group(to, title, 0, t->help);
  for (size_t c = 0; c < t->n_column; c++)
    print_param(to, &t->column[c], t->name,
                vg_settings_rows(s, kind) ? vg_settings_row(s, kind, 0)
                                          : (const void *)&defaults,
                &defaults, posted);
  fputs("</details>\n", to);
}

/* --- tables of many lines ------------------------------------------------ */

static void print_table(FILE *to, enum vg_table_kind kind, const char *title,
                        const char *example, const struct vg_settings *s,
                        const struct vg_fields *posted)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  const char *sent = vg_fields_get(posted, t->name);

  begin_group(to, title, (sent && *sent) || vg_settings_rows(s, kind), t->help);
  fputs("<textarea rows=\"6\" spellcheck=\"false\" wrap=\"off\"", to);
  vg_markup_attribute(to, "name", t->name);
  vg_markup_attribute(to, "aria-label", title);
  vg_markup_attribute(to, "placeholder", example);
  fputs(">\n", to); /* browsers drop the first line break */
  if (sent) vg_markup(to, sent);
  else vg_rows_print(to, s, kind);
  fputs("</textarea>\n<dl class=\"columns\">", to);
  for (size_t c = 0; c < t->n_column; c++) {
    fputs("<dt>", to);
    vg_markup(to, t->column[c].name);
    fputs("</dt><dd>", to);
    vg_markup(to, t->column[c].help);
    if (*t->column[c].unit) fputs(" <i>", to);
    vg_markup(to, t->column[c].unit);
    fputs(*t->column[c].unit ? "</i></dd>" : "</dd>", to);
  }
  fputs("</dl></details>\n", to);
}

/* --- machine ------------------------------------------------------------- */

static void print_number(FILE *to, const char *name, const char *label,
                         const struct vg_fields *posted, const char *otherwise)
{
  const char *sent = vg_fields_get(posted, name);

  fprintf(to,
          "<label>%s <input class=\"number\" autocomplete=\"off\" "
          "name=\"%s\"",
          label, name);
  vg_markup_attribute(to, "value", sent ? sent : otherwise);
  fputs("></label>\n", to);
}

static void print_where(FILE *to, const struct vg_fields *posted, int slurm)
{
  int is_slurm = !strcmp(vg_fields_text(posted, "where"), "slurm");

  fprintf(to,
          "<fieldset class=\"where\"><legend>Run on</legend>\n"
          "<label><input type=\"radio\" name=\"where\" value=\"here\"%s> this "
          "machine</label>\n",
          is_slurm ? "" : " checked");
  if (slurm)
    fprintf(to,
            "<label><input type=\"radio\" name=\"where\" value=\"slurm\""
            "%s> Slurm</label>\n",
            is_slurm ? " checked" : "");
  print_number(to, "ranks", slurm ? "ranks (Slurm: per node)" : "ranks", posted,
               "1");
  if (slurm) {
    fputs("<span class=\"slurm\">\n", to);
    print_number(to, "nodes", "nodes", posted, "1");
    print_number(to, "cpus", "CPUs per rank", posted, "1");
    print_number(to, "time", "time limit", posted, "02:00:00");
    print_number(to, "partition", "partition", posted, "");
    fputs("</span>\n", to);
  }
  fputs("</fieldset>\n<p class=\"start\"><button name=\"what\" value=\"mesh\" "
        "class=\"main\">Start run</button> <button name=\"what\" "
        "value=\"sweep\">Start sweep</button> <span class=\"about\">A "
        "sweep runs these settings with all combinations of the table Sweep, "
        "on this machine.</span></p>\n",
        to);
}

void vg_form_print(FILE *to, const char *project, const struct vg_settings *s,
                   const struct vg_fields *posted, int slurm)
{
  const char *title = vg_fields_get(posted, "title");

  fputs("<form id=\"settings\" method=\"post\" action=\"runs\">\n"
        "<input type=\"hidden\" name=\"project\"",
        to);
  vg_markup_attribute(to, "value", project);
  fputs(">\n<p class=\"title\"><label for=\"title\">Title</label> <input "
        "id=\"title\" name=\"title\" maxlength=\"80\" autocomplete=\"off\"",
        to);
  vg_markup_attribute(to, "value", title ? title : s->title);
  fputs("></p>\n", to);
  print_settings(to, s, posted);
  print_row(to, VG_TABLE_FARFIELD, "Farfield", s, posted);
  print_table(to, VG_TABLE_PATCHES, "Patches", "id  bc  name\n1   4   wing", s,
              posted);
  print_table(to, VG_TABLE_LAYERS, "Layers of individual patches",
              "id  grow  first  min_full\n1   yes   1e-5   98", s, posted);
  print_table(to, VG_TABLE_SOURCES, "Sources",
              "kind   x0  y0  z0  r0  h0\npoint  0   0   0   0   0.01", s,
              posted);
  print_row(to, VG_TABLE_SWEEP, "Sweep", s, posted);
  print_where(to, posted, slurm);
  fputs("</form>\n", to);
}
