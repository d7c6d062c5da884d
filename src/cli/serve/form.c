/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Converts form fields to settings. Declared in cli/serve/form.h. */
#define _GNU_SOURCE
#include "cli/serve/form.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/http/inside.h"
#include "cli/serve/rows.h"

/* --- settings ------------------------------------------------------------ */

/* Set the values at `base` from the fields "PREFIX.NAME". */
static vg_status take_params(const struct vg_fields *f, const char *prefix,
                             const struct vg_param *p, size_t n, void *base,
                             const void *defaults, struct vg_form_fault *fault,
                             struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < n && st >= 0; i++) {
    char name[64];
    const char *value;

    snprintf(name, sizeof name, "%s.%s", prefix, p[i].name);
    value = vg_fields_get(f, name);
    if (!value) continue;
    memcpy((char *)base + p[i].offset, (const char *)defaults + p[i].offset,
           p[i].size);
    if (*value) st = vg_param_set(&p[i], base, value, strlen(value), err);
    if (st < 0) strcpy(fault->field, name);
  }
  return st;
}

/* Whether a row has a value other than a default. */
static int is_given(const struct vg_setting_table *t, const void *row,
                    const void *defaults)
{
  for (size_t c = 0; c < t->n_column; c++)
    if (memcmp((const char *)row + t->column[c].offset,
               (const char *)defaults + t->column[c].offset,
               t->column[c].size) != 0)
      return 1;
  return 0;
}

/* Set the plain settings and the one-line tables. */
static vg_status take_values(const struct vg_fields *f, struct vg_settings *s,
                             struct vg_form_fault *fault, struct vg_error *err)
{
  const struct vg_setting_table *farfield = vg_settings_table(
    VG_TABLE_FARFIELD);
  const struct vg_setting_table *sweep = vg_settings_table(VG_TABLE_SWEEP);
  const struct vg_setting_table *adapt = vg_settings_table(VG_TABLE_ADAPT);
  struct vg_settings defaults;
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  vg_status st;

  vg_settings_default(&defaults);
  VG_TRY(take_params(f, "s", p, n, s, &defaults, fault, err));
  VG_TRY(take_params(f, "farfield", farfield->column, farfield->n_column,
                     &s->farfield, &defaults.farfield, fault, err));
  st = take_params(f, "sweep", sweep->column, sweep->n_column, &s->sweep,
                   &defaults.sweep, fault, err);
  s->n_sweep = is_given(sweep, &s->sweep, &defaults.sweep);
  if (st < 0) goto done;
  st = take_params(f, "adapt", adapt->column, adapt->n_column, &s->adapt,
                   &defaults.adapt, fault, err);
  s->n_adapt = is_given(adapt, &s->adapt, &defaults.adapt);
done:
  return st;
}

/* The line in a message such as "sources, line 3: ...". */
static int line_in(const char *message, const char *table)
{
  size_t n = strlen(table);
  int line = 0;

  if (!strncmp(message, table, n)) sscanf(message + n, ", line %9d", &line);
  return line;
}

static vg_status take_tables(const struct vg_fields *f, struct vg_settings *s,
                             struct vg_form_fault *fault, struct vg_error *err)
{
  static const enum vg_table_kind tables[] = {
    VG_TABLE_PATCHES, VG_TABLE_LAYERS,   VG_TABLE_SURFACE, VG_TABLE_WAKES,
    VG_TABLE_ZONES,   VG_TABLE_PERIODIC, VG_TABLE_SOURCES
  };
  vg_status st = VG_OK;

  for (size_t i = 0; i < sizeof tables / sizeof *tables && st >= 0; i++) {
    const char *name = vg_settings_table(tables[i])->name;
    const char *text = vg_fields_get(f, name);

    if (!text) continue;
    if (tables[i] == VG_TABLE_PATCHES) s->n_patch = 0;
    if (tables[i] == VG_TABLE_LAYERS) s->n_layer = 0;
    if (tables[i] == VG_TABLE_SURFACE) s->n_surface = 0;
    if (tables[i] == VG_TABLE_WAKES) s->n_wake = 0;
    if (tables[i] == VG_TABLE_ZONES) s->n_zone = 0;
    if (tables[i] == VG_TABLE_PERIODIC) s->n_periodic = 0;
    if (tables[i] == VG_TABLE_SOURCES) s->n_source = 0;
    st = vg_rows_read(text, tables[i], s, err);
    if (st >= 0) continue;
    strcpy(fault->field, name);
    fault->line = line_in(err->text, name);
  }
  return st;
}

static vg_status take_title(const struct vg_fields *f, struct vg_settings *s,
                            struct vg_error *err)
{
  const char *title = vg_fields_text(f, "title");

  if (strlen(title) > VG_TITLE_MAX || strpbrk(title, "\r\n\t"))
    return vg_fail(err, VG_ERR_INPUT,
                   "the title must be one line of at most %d "
                   "bytes",
                   VG_TITLE_MAX);
  title += strspn(title, " #"); /* a deck's title cannot be a comment */
  if (*title) snprintf(s->title, sizeof s->title, "%s", title);
  return VG_OK;
}

/* Check that a file given by a setting is below the root, and replace `to` by
 * its real path. */
static vg_status check_path(const char *root, const char *setting,
                            char to[VG_LIST_MAX], struct vg_error *err)
{
  const char *name = to;
  size_t n = strlen(root);
  char *real;
  vg_status st;

  if (!*name) return VG_OK;
  if (*name == '/' && vg_inside_holds(root, name)) name += n > 1 ? n + 1 : 1;
  st = vg_inside(root, name, &real, err);
  if (st < 0) return st;
  if (strlen(real) >= VG_LIST_MAX)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: the path %.100s... is longer than %d "
                 "bytes",
                 setting, real, VG_LIST_MAX - 1);
  else strcpy(to, real);
  free(real);
  return st;
}

/* The files of a folder could be links to other places. */
static int is_folder(const char *path)
{
  struct stat s;

  return *path && stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

/* Check the resulting settings, whether they come from the form or a deck. */
static vg_status check_paths(const char *root, struct vg_settings *s,
                             struct vg_form_fault *fault, struct vg_error *err)
{
  vg_status st;

  strcpy(fault->field, "s.mesher");
  if (strcmp(s->mesher, "builtin") != 0 && strcmp(s->mesher, "tetgen") != 0 &&
      strcmp(s->mesher, "hxt") != 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "mesher: the portal does not run plug-ins, since they are "
                   "programs; choose builtin, tetgen or hxt");
  strcpy(fault->field, "s.helpers");
  if (*s->helpers)
    return vg_fail(err, VG_ERR_INPUT,
                   "helpers: the portal only runs the helper programs of its "
                   "own installation; leave the setting empty");
  strcpy(fault->field, "s.sizes");
  VG_TRY(check_path(root, "sizes", s->sizes, err));
  strcpy(fault->field, "s.first_from");
  VG_TRY(check_path(root, "first_from", s->layer.first_from, err));
  if (is_folder(s->layer.first_from))
    return vg_fail(err, VG_ERR_INPUT,
                   "first_from: %s is a folder; the portal takes one file",
                   s->layer.first_from);
  strcpy(fault->field, "s.mapbc");
  VG_TRY(check_path(root, "mapbc", s->mapbc, err));
  fault->field[0] = 0;
done:
  return st;
}

static int is_word_at(const char *text, const char *at, size_t n)
{
  static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

  return (at == text || !strchr(letters, at[-1])) &&
         (!at[n] || !strchr(letters, at[n]));
}

/* The table with which a message begins, as in "patches: patch 3 ...". */
static int find_table(const char *message, struct vg_form_fault *fault)
{
  for (int k = 0; k < VG_TABLE_N; k++) {
    const char *name = vg_settings_table((enum vg_table_kind)k)->name;
    size_t n = strlen(name);

    if (strncmp(message, name, n) != 0 || message[n] != ':') continue;
    snprintf(fault->field, sizeof fault->field,
             k == VG_TABLE_FARFIELD ? "%s.kind" : "%s", name);
    return 1;
  }
  return 0;
}

/* The setting that a message about several settings names first. */
static void find_setting(const char *message, struct vg_form_fault *fault)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  const char *first = NULL;

  for (size_t i = 0; i < n; i++) {
    size_t len = strlen(p[i].name);

    for (const char *at = message; (at = strstr(at, p[i].name)); at++) {
      if (!is_word_at(message, at, len)) continue;
      if (!first || at < first) {
        first = at;
        snprintf(fault->field, sizeof fault->field, "s.%s", p[i].name);
      }
      break;
    }
  }
}

vg_status vg_form_settings(const struct vg_fields *f, const char *root,
                           struct vg_settings *s, struct vg_form_fault *fault,
                           struct vg_error *err)
{
  vg_status st;

  strcpy(fault->field, "title");
  VG_TRY(take_title(f, s, err));
  fault->field[0] = 0;
  VG_TRY(take_values(f, s, fault, err));
  VG_TRY(take_tables(f, s, fault, err));
  st = vg_settings_check(s, err);
  if (st < 0 && !find_table(err->text, fault)) find_setting(err->text, fault);
  if (st >= 0) st = check_paths(root, s, fault, err);
done:
  return st;
}

/* --- machine ------------------------------------------------------------- */

static vg_status take_word(const struct vg_fields *f, const char *name,
                           const char *what, const char *allowed, char *to,
                           size_t size, struct vg_error *err)
{
  const char *text = vg_fields_text(f, name);

  if (strlen(text) >= size || strspn(text, allowed) != strlen(text) ||
      *text == '-')
    return vg_fail(err, VG_ERR_INPUT, "%s: invalid value '%.40s'", what, text);
  strcpy(to, text);
  return VG_OK;
}

vg_status vg_form_run(const struct vg_fields *f, struct vg_serve_run *run,
                      struct vg_form_fault *fault, struct vg_error *err)
{
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                "abcdefghijklmnopqrstuvwxyz0123456789_.-";
  const char *where = vg_fields_text(f, "where");
  vg_status st;

  run->is_sweep = !strcmp(vg_fields_text(f, "what"), "sweep");
  run->is_slurm = !strcmp(where, "slurm");
  strcpy(fault->field, "where");
  if (!run->is_slurm && *where && strcmp(where, "here") != 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "a run must be on 'here' or 'slurm', not "
                   "'%.40s'",
                   where);
  if (run->is_slurm && run->is_sweep)
    return vg_fail(err, VG_ERR_INPUT,
                   "the portal runs sweeps on this machine only; use 'vanguard "
                   "sweep --launcher' in a job of your own");
  strcpy(fault->field, "ranks");
  VG_TRY(vg_fields_count(f, "ranks", "ranks", 1, 100000, 1, &run->ranks, err));
  strcpy(fault->field, "nodes");
  VG_TRY(vg_fields_count(f, "nodes", "nodes", 1, 100000, 1, &run->nodes, err));
  strcpy(fault->field, "cpus");
  VG_TRY(
    vg_fields_count(f, "cpus", "CPUs per rank", 1, 4096, 1, &run->cpus, err));
  strcpy(fault->field, "time");
  VG_TRY(take_word(f, "time", "the time limit", "0123456789:-", run->time,
                   sizeof run->time, err));
  strcpy(fault->field, "partition");
  st = take_word(f, "partition", "the partition", letters, run->partition,
                 sizeof run->partition, err);
done:
  return st;
}
