/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The form of a run. Declared in cli/serve/form.h. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "cli/serve/form.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/rows.h"
#include "run/common/json_build.h"

#define VALUE_SIZE (2 * VG_LIST_MAX + 4)

/* The main settings, which most users change, by groups. */
static const struct main_setting {
  const char *group;  /* heading before this setting; NULL: none */
  const char *prefix; /* "s", or a one-line table */
  const char *name, *label;
} main_settings[] = {
  { "Boundary layer", "s", "layers", "Viscous layers" },
  { NULL, "s", "y_plus", "y+ of the first cell" },
  { NULL, "s", "reynolds", "Reynolds number" },
  { NULL, "s", "reference_length", "Reference length" },
  { NULL, "s", "first", "or first height" },
  { NULL, "s", "ratio", "Growth of the layers" },
  { "Volume", "s", "growth", "Growth in the volume" },
  { NULL, "s", "surface_size", "Largest surface edge" },
  { NULL, "s", "scale", "Scale of all edges" },
  { NULL, "farfield", "kind", "Farfield" },
  { NULL, "farfield", "lengths", "Farfield distance" },
  { "Files", "s", "cells", "Cells of the layers" },
  { NULL, "s", "write", "File formats" },
};

/* Settings are shown in the order of their rows; a group begins at the setting
 * that is named here. */
static const struct group {
  const char *first, *title;
} groups[] = {
  { "scale", "Edge lengths" },
  { "unit", "CAD" },
  { "weld", "Surface" },
  { "optimise", "Cells and files" },
  { "mesher", "Subdomains, ranks and threads" },
  { "layers", "Viscous layers" },
  { "min_full", "Limits on the layers" },
  { "max_non_orthogonality", "Limits on the mesh" },
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
                          const char *value, const char *otherwise,
                          int is_wrong)
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
  fputs(" aria-describedby=\"about.", to);
  vg_markup(to, name);
  if (is_wrong) fputs(" wrong", to);
  fputs(is_wrong ? "\" aria-invalid=\"true\" autofocus" : "\"", to);
  if (!is_choice) {
    vg_markup_attribute(to, "value", strcmp(value, otherwise) ? value : "");
    vg_markup_attribute(to, "placeholder", *otherwise ? otherwise : "none");
    if (p->type != VG_PARAM_TEXT) fputs(" class=\"number\"", to);
  }
  fputs(">", to);
  if (!is_choice) return;
  print_choice(to, p->type == VG_PARAM_FLAG ? yes_no : p->words, value);
  fputs("</select>", to);
}

/* The message at the field that is wrong. */
static void print_wrong(FILE *to, const char *message)
{
  fputs("<p class=\"wrong\" id=\"wrong\" role=\"alert\">", to);
  vg_markup(to, message);
  fputs("</p>", to);
}

static int is_wrong(const struct vg_form_view *v, const char *name)
{
  return v->message && !strcmp(v->fault->field, name);
}

/* Row of a setting: name, control, unit, help and default. label: another name
 * for people, or NULL. */
static void print_param(FILE *to, const struct vg_form_view *v,
                        const struct vg_param *p, const char *prefix,
                        const char *label, const void *base,
                        const void *defaults)
{
  char name[64], value[VALUE_SIZE], otherwise[VALUE_SIZE];
  const char *sent;

  snprintf(name, sizeof name, "%s.%s", prefix, p->name);
  value_of(p, defaults, otherwise);
  value_of(p, base, value);
  sent = vg_fields_get(v->posted, name);
  if (!sent) sent = value;
  fprintf(to, "<div class=\"row%s%s\"><label",
          *sent && strcmp(sent, otherwise) ? " changed" : "",
          is_wrong(v, name) ? " bad" : "");
  vg_markup_attribute(to, "for", name);
  fputs(">", to);
  vg_markup(to, label ? label : p->name);
  if (label) {
    fputs(" <code>", to);
    vg_markup(to, strcmp(prefix, "s") ? name : p->name);
    fputs("</code>", to);
  }
  fputs("</label><span class=\"value\">", to);
  print_control(to, p, name, sent, otherwise, is_wrong(v, name));
  fputs(" <i>", to);
  vg_markup(to, p->unit);
  fputs("</i></span><span class=\"helpbox\"><span class=\"help\" id=\"about.",
        to);
  vg_markup(to, name);
  fputs("\">", to);
  vg_markup(to, p->help);
  fputs(" <b>default ", to);
  vg_markup(to, *otherwise ? otherwise : "\"\"");
  fputs("</b></span></span>", to);
  if (is_wrong(v, name)) print_wrong(to, v->message);
  fputs("</div>\n", to);
}

/* The values and defaults of a one-line table, or of all plain settings, and
 * its columns. */
struct place {
  const struct vg_param *column;
  size_t n;
  const void *base, *defaults;
};

union one_row {
  struct vg_farfield_row f;
  struct vg_sweep_row w;
  struct vg_adapt_row a;
};

static void table_place(enum vg_table_kind kind, const struct vg_settings *s,
                        union one_row *defaults, struct place *out)
{
  const struct vg_setting_table *t = vg_settings_table(kind);

  vg_settings_row_default(kind, defaults);
  out->column = t->column;
  out->n = t->n_column;
  out->base = vg_settings_rows(s, kind) ? vg_settings_row(s, kind, 0)
                                        : (const void *)defaults;
  out->defaults = defaults;
}

static int is_main(const char *prefix, const char *name)
{
  for (size_t i = 0; i < sizeof main_settings / sizeof *main_settings; i++)
    if (!strcmp(main_settings[i].prefix, prefix) &&
        !strcmp(main_settings[i].name, name))
      return 1;
  return 0;
}

static void print_main(FILE *to, const struct vg_form_view *v)
{
  struct vg_settings defaults;
  union one_row far;
  struct place plain = { NULL, 0, v->s, &defaults }, farfield;

  vg_settings_default(&defaults);
  plain.column = vg_settings_params(&plain.n);
  table_place(VG_TABLE_FARFIELD, v->s, &far, &farfield);
  fputs("<div id=\"main-settings\">\n", to);
  for (size_t i = 0; i < sizeof main_settings / sizeof *main_settings; i++) {
    const struct main_setting *m = &main_settings[i];
    const struct place *in = strcmp(m->prefix, "s") ? &farfield : &plain;

    if (m->group)
      fprintf(to, "%s<fieldset class=\"group\"><legend>%s</legend>\n",
              i ? "</fieldset>\n" : "", m->group);
    for (size_t c = 0; c < in->n; c++)
      if (!strcmp(in->column[c].name, m->name))
        print_param(to, v, &in->column[c], m->prefix, m->label, in->base,
                    in->defaults);
  }
  fputs("</fieldset>\n</div>\n", to);
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

/* Whether the field that is wrong is one of the columns from `first` up to the
 * next group. */
static int has_fault(const struct vg_form_view *v, const struct vg_param *p,
                     size_t n, size_t first)
{
  const char *field = v->message ? v->fault->field : "";

  if (strncmp(field, "s.", 2) != 0) return 0;
  for (size_t i = first; i < n && (i == first || !group_at(p[i].name)); i++)
    if (!strcmp(field + 2, p[i].name)) return 1;
  return 0;
}

/* All plain settings that are not main settings. */
static void print_settings(FILE *to, const struct vg_form_view *v)
{
  struct vg_settings defaults;
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  vg_settings_default(&defaults);
  for (size_t i = 0; i < n; i++) {
    const struct group *g = group_at(p[i].name);

    if (g) {
      if (i) fputs("</details>\n", to);
      begin_group(to, g->title, has_fault(v, p, n, i), NULL);
    }
    if (!is_main("s", p[i].name))
      print_param(to, v, &p[i], "s", NULL, v->s, &defaults);
  }
  fputs("</details>\n", to);
}

/* A table of one line. */
static void print_row(FILE *to, const struct vg_form_view *v,
                      enum vg_table_kind kind, const char *title)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  const char *field = v->message ? v->fault->field : "";
  size_t len = strlen(t->name);
  union one_row defaults;
  struct place in;

  table_place(kind, v->s, &defaults, &in);
  begin_group(to, title, !strncmp(field, t->name, len) && field[len] == '.',
              t->help);
  for (size_t c = 0; c < in.n; c++)
    if (!is_main(t->name, in.column[c].name))
      print_param(to, v, &in.column[c], t->name, NULL, in.base, in.defaults);
  fputs("</details>\n", to);
}

/* --- tables of many lines ------------------------------------------------ */

/* The columns of a table, from which the script of the page makes an editor. */
static void print_columns(FILE *to, const struct vg_setting_table *t)
{
  json_t *list = json_array();
  char *text;

  for (size_t c = 0; c < t->n_column; c++) {
    const struct vg_param *p = &t->column[c];
    json_t *words = json_array();

    for (size_t i = 0; p->words && p->words[i]; i++)
      json_array_append_new(words, json_string(p->words[i]));
    if (p->type == VG_PARAM_FLAG) {
      json_array_append_new(words, json_string("no"));
      json_array_append_new(words, json_string("yes"));
    }
    json_array_append_new(list,
                          json_pack("{s:s s:s s:s s:b s:o}", "name", p->name,
                                    "help", p->help, "unit", p->unit,
                                    "required", p->required, "words", words));
  }
  text = json_dumps(list, JSON_COMPACT);
  vg_markup_attribute(to, "data-columns", text ? text : "[]");
  free(text);
  json_decref(list);
}

static void print_table(FILE *to, const struct vg_form_view *v,
                        enum vg_table_kind kind, const char *title,
                        const char *example)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  const char *sent = vg_fields_get(v->posted, t->name);
  int wrong = is_wrong(v, t->name);

  begin_group(to, title,
              (sent && *sent) || vg_settings_rows(v->s, kind) || wrong,
              t->help);
  if (wrong) print_wrong(to, v->message);
  fputs("<textarea class=\"table\" rows=\"6\" spellcheck=\"false\" "
        "wrap=\"off\"",
        to);
  vg_markup_attribute(to, "id", t->name);
  vg_markup_attribute(to, "name", t->name);
  vg_markup_attribute(to, "aria-label", title);
  vg_markup_attribute(to, "placeholder", example);
  if (wrong)
    fprintf(to, " aria-invalid=\"true\" data-wrong=\"%d\"", v->fault->line);
  print_columns(to, t);
  fputs(">\n", to); /* browsers drop the first line break */
  if (sent) vg_markup(to, sent);
  else vg_rows_print(to, v->s, kind);
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

static void print_tables(FILE *to, const struct vg_form_view *v)
{
  print_table(to, v, VG_TABLE_PATCHES, "Patches", "id  bc  name\n1   4   wing");
  print_table(to, v, VG_TABLE_LAYERS, "Layers of individual patches",
              "id  grow  first  min_full\n1   yes   1e-5   98");
  print_table(to, v, VG_TABLE_SURFACE, "Surface edges of individual patches",
              "patch  adjacent  size\n1      -         0.01");
  print_table(to, v, VG_TABLE_WAKES, "Wakes of trailing edges",
              "patch  length  alpha\n*      2       0,4");
  print_table(to, v, VG_TABLE_ZONES, "Zones",
              "name   x  y  z  kind\nrotor  0  0  0  rotating");
  print_table(to, v, VG_TABLE_PERIODIC, "Periodic patches",
              "patch  image\nlo     hi");
  print_table(to, v, VG_TABLE_SOURCES, "Sources",
              "kind   x0  y0  z0  r0  h0\npoint  0   0   0   0   0.01");
}

/* --- machine ------------------------------------------------------------- */

static void print_number(FILE *to, const struct vg_form_view *v,
                         const char *name, const char *label,
                         const char *otherwise)
{
  const char *sent = vg_fields_get(v->posted, name);

  fprintf(to,
          "<label%s>%s <input class=\"number\" autocomplete=\"off\" "
          "id=\"%s\" name=\"%s\"%s",
          is_wrong(v, name) ? " class=\"bad\"" : "", label, name, name,
          is_wrong(v, name) ? " aria-invalid=\"true\" autofocus" : "");
  vg_markup_attribute(to, "value", sent ? sent : otherwise);
  fputs("></label>\n", to);
  if (is_wrong(v, name)) print_wrong(to, v->message);
}

static void print_where(FILE *to, const struct vg_form_view *v)
{
  int is_slurm = !strcmp(vg_fields_text(v->posted, "where"), "slurm");

  fprintf(to,
          "<fieldset class=\"where\"><legend>Run on</legend>\n"
          "<label><input type=\"radio\" name=\"where\" value=\"here\"%s> this "
          "machine</label>\n",
          is_slurm ? "" : " checked");
  if (v->slurm)
    fprintf(to,
            "<label><input type=\"radio\" name=\"where\" value=\"slurm\""
            "%s> Slurm</label>\n",
            is_slurm ? " checked" : "");
  print_number(to, v, "ranks", v->slurm ? "ranks (Slurm: per node)" : "ranks",
               "1");
  if (v->slurm) {
    fputs("<span class=\"slurm\">\n", to);
    print_number(to, v, "nodes", "nodes", "1");
    print_number(to, v, "cpus", "CPUs per rank", "1");
    print_number(to, v, "time", "time limit", "02:00:00");
    print_number(to, v, "partition", "partition", "");
    fputs("</span>\n", to);
  }
  fputs("</fieldset>\n", to);
}

/* The buttons that need scripts are added by the page's own script. */
static void print_start(FILE *to)
{
  fputs("<div class=\"start\" id=\"start\">"
        "<button name=\"what\" value=\"mesh\" class=\"main\">Start run"
        "</button> <button name=\"what\" value=\"sweep\" title=\"Runs these "
        "settings with all combinations of the table Sweep, on this machine\">"
        "Start sweep</button></div>\n",
        to);
}

void vg_form_print(FILE *to, const struct vg_form_view *v)
{
  const char *title = vg_fields_get(v->posted, "title");

  fputs("<form id=\"settings\" method=\"post\" action=\"runs\">\n"
        "<input type=\"hidden\" name=\"project\"",
        to);
  vg_markup_attribute(to, "value", v->project);
  fputs(">\n<p class=\"title\"><label for=\"title\">Title</label> <input "
        "id=\"title\" name=\"title\" maxlength=\"80\" autocomplete=\"off\"",
        to);
  vg_markup_attribute(to, "value", title ? title : v->s->title);
  fputs("></p>\n", to);
  print_main(to, v);
  fputs("<details id=\"all\" open><summary>All other settings</summary>\n", to);
  print_settings(to, v);
  print_row(to, v, VG_TABLE_FARFIELD, "Farfield");
  print_tables(to, v);
  print_row(to, v, VG_TABLE_SWEEP, "Sweep");
  print_row(to, v, VG_TABLE_ADAPT, "Adaptation");
  fputs("</details>\n", to);
  print_where(to, v);
  print_start(to);
  fputs("</form>\n", to);
}
