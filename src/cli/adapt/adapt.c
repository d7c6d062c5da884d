/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Opens a loop and keeps the record of its steps. */
#define _GNU_SOURCE
#include "cli/adapt/adapt.h"

#include <errno.h>
#include <libgen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/common/process.h"
#include "io/stream/stream.h"
#include "partition/store/store.h"
#include "run/common/folder.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/input/input.h"

#define RECORD "adapt.json"
#define VERSION 2
#define DIGEST "_digest" /* after the name of a file in the record */

static const char *const step_names[VG_ADAPT_N] = { "metric", "mesh", "solve" };

void vg_adapt_attempt(const struct vg_adapt_row *row, int attempt,
                      double *growth, double *aspect_max)
{
  static const double most[VG_ADAPT_ATTEMPTS][2] = { { INFINITY, INFINITY },
                                                     { 1.3, 20 },
                                                     { 1.2, 5 } };

  *growth = row->growth;
  *aspect_max = row->aspect_max;
  if (attempt < 2) return;
  *growth = fmin(most[attempt - 1][0], row->growth); /* fmin ignores NAN */
  *aspect_max = fmin(most[attempt - 1][1], row->aspect_max);
}

/* --- settings ------------------------------------------------------------- */

static json_t *real_json(double v)
{
  return isfinite(v) ? json_real(v) : json_null();
}

/* A file as it is now: its digest, or null. */
static json_t *file_json(const char *path)
{
  struct vg_input in = VG_INPUT_INIT;
  char text[40];
  struct vg_digest d = { { 0, 0 } };

  if (!path || vg_input_open(path, &in, NULL) < 0) return json_null();
  d = vg_digest_of(d, in.size, in.data);
  vg_input_release(&in);
  snprintf(text, sizeof text, "%016llx%016llx", (unsigned long long)d.word[0],
           (unsigned long long)d.word[1]);
  return json_string(text);
}

/* The digests of all files of the project, whether they are options or were
 * found next to the surface. */
static void add_files(json_t *o, const struct vg_input_files *f)
{
  json_object_set_new(o, "surface" DIGEST, file_json(f->surface));
  json_object_set_new(o, "deck" DIGEST, file_json(f->deck));
  json_object_set_new(o, "mapbc" DIGEST, file_json(f->mapbc));
  json_object_set_new(o, "tags" DIGEST, file_json(f->tags));
  json_object_set_new(o, "bc" DIGEST, file_json(f->aflr));
  json_object_set_new(o, "d3m" DIGEST, file_json(f->d3m));
  json_object_set_new(o, "front" DIGEST, file_json(f->front));
}

/* Everything that decides the results, except for the number of cycles: more
 * cycles continue a loop. */
static json_t *settings_json(const struct vg_adapt_options *o,
                             const struct vg_input_files *f)
{
  const struct vg_adapt_row *r = &o->row;
  json_t *extra = json_array(), *all;

  for (int i = 0; i < o->n_extra; i++)
    json_array_append_new(extra, vg_text_json(o->extra[i]));
  all = json_pack("{s:i s:o s:o s:o s:o s:o s:o s:o s:o s:o s:o s:o}",
                  "version", VERSION, "project", vg_text_json(o->project),
                  "deck", vg_text_json(f->deck), "solver",
                  vg_text_json(r->solver), "field", vg_text_json(r->field),
                  "norm", vg_text_json(r->norm), "cells", real_json(r->cells),
                  "cells_ratio", real_json(r->cells_ratio), "growth",
                  real_json(r->growth), "edge_bounds",
                  json_pack("[o,o]", real_json(r->h_min), real_json(r->h_max)),
                  "aspect_max", real_json(r->aspect_max), "mesh_options",
                  extra);
  if (all) add_files(all, f);
  return all;
}

/* As vanguard metric checks its options, but before the first mesh. */
static vg_status check_metric(const struct vg_adapt_row *r,
                              struct vg_error *err)
{
  const struct {
    const char *name;
    double value, least;
  } bound[] = {
    { "cells", r->cells, 0 },   { "cells_ratio", r->cells_ratio, 0 },
    { "growth", r->growth, 1 }, { "aspect_max", r->aspect_max, 1 },
    { "h_min", r->h_min, 0 },   { "h_max", r->h_max, 0 }
  };
  int64_t norm = 0;

  if (*r->norm && strcmp(r->norm, "max") &&
      (!vg_parse_int(r->norm, strlen(r->norm), &norm) || norm < 1 || norm > 16))
    return vg_fail(err, VG_ERR_INPUT,
                   "adapt: norm '%s' is neither a number from 1 to 16 nor "
                   "'max'",
                   r->norm);
  for (size_t i = 0; i < sizeof bound / sizeof *bound; i++)
    if (bound[i].value <= bound[i].least) /* false for NAN: not given */
      return vg_fail(err, VG_ERR_INPUT, "adapt: %s %g must be above %g",
                     bound[i].name, bound[i].value, bound[i].least);
  if (r->h_min >= r->h_max)
    return vg_fail(err, VG_ERR_INPUT, "adapt: h_min %g must be below h_max %g",
                   r->h_min, r->h_max);
  return VG_OK;
}

/* Options after '--' that the loop sets itself. */
static const char *const own_options[] = {
  "-p",    "--project", "-d",        "--deck",   "-o",
  "--out", "--sizes",   "--run-dir", "--resume", "--first-from"
};

static vg_status check_extra(const struct vg_adapt_options *o,
                             struct vg_error *err)
{
  for (int i = 0; i < o->n_extra; i++)
    for (size_t k = 0; k < sizeof own_options / sizeof *own_options; k++) {
      const size_t n = strlen(own_options[k]);

      if (strncmp(o->extra[i], own_options[k], n) != 0 ||
          (o->extra[i][n] && o->extra[i][n] != '='))
        continue;
      return vg_fail(err, VG_ERR_USAGE,
                     "%s after '--' would override what the loop sets; give "
                     "it before '--' if it is an option of vanguard adapt",
                     own_options[k]);
    }
  return VG_OK;
}

static vg_status check_options(const struct vg_adapt_options *o,
                               struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  vg_status st;

  if (!*o->row.solver)
    return vg_fail(err, VG_ERR_INPUT,
                   "no solver: give the program by --solver or in the table "
                   "adapt of the deck");
  VG_TRY(vg_words_launcher(&w, o->row.solver, o->ranks, o->threads, err));
  VG_TRY(check_metric(&o->row, err));
  st = check_extra(o, err);
done:
  vg_words_release(&w);
  return st;
}

/* --- the record ----------------------------------------------------------- */

static json_t *cycle_json(const struct vg_adapt_cycle *c)
{
  json_t *o = json_object(), *steps = json_object(), *outputs = json_object();

  for (int k = 0; k < VG_ADAPT_N; k++)
    if (c->is_done[k])
      json_object_set_new(steps, step_names[k], json_real(c->seconds[k]));
  for (size_t i = 0; i < c->n_output; i++)
    json_object_set_new(outputs, c->output[i].name,
                        json_real(c->output[i].value));
  json_object_set_new(o, "cycle", json_integer(c->number));
  json_object_set_new(o, "seconds", steps);
  json_object_set_new(o, "requested_cells", real_json(c->requested));
  json_object_set_new(o, "attempt", json_integer(c->attempt));
  json_object_set_new(o, "meets_limits", json_boolean(!c->exit_status));
  json_object_set_new(o, "cells", real_json(c->cells));
  json_object_set_new(o, "points", real_json(c->points));
  json_object_set_new(o, "field_cells", real_json(c->field_cells));
  json_object_set_new(o, "angle_min", real_json(c->angle_min));
  json_object_set_new(o, "outputs", outputs);
  return o;
}

json_t *vg_adapt_json(const struct vg_adapt *a)
{
  json_t *o = json_object(), *list = json_array(), *notes = json_array();
  char note[VG_ADAPT_NOTE];

  for (size_t i = 0; i < a->n; i++)
    json_array_append_new(list, cycle_json(&a->cycle[i]));
  for (size_t i = 0; i < a->n; i++)
    for (int k = 0; vg_adapt_note(a, &a->cycle[i], k, note); k++)
      if (*note) json_array_append_new(notes, vg_text_json(note));
  json_object_set(o, "settings", a->settings);
  json_object_set_new(o, "cycles", list);
  json_object_set_new(o, "notes", notes);
  return o;
}

vg_status vg_adapt_record(const struct vg_adapt *a, struct vg_error *err)
{
  json_t *o = vg_adapt_json(a);
  char *path = NULL;
  vg_status st = vg_folder_path(a->dir, RECORD, &path, err);

  if (st >= 0) st = vg_json_write(path, o, "the record of the loop", err);
  json_decref(o);
  free(path);
  return st;
}

static void take_outputs(const json_t *o, struct vg_adapt_cycle *c)
{
  const char *name;
  const json_t *v;

  json_object_foreach((json_t *)(uintptr_t)o, name, v)
  {
    struct vg_adapt_output *to = &c->output[c->n_output];

    if (c->n_output == VG_ADAPT_OUTPUTS || !json_is_number(v)) continue;
    snprintf(to->name, sizeof to->name, "%s", name);
    to->value = json_number_value(v);
    c->n_output++;
  }
}

/* Steps count up to the first one that is not done. A folder that was removed
 * has none. */
static int take_cycle(const json_t *o, struct vg_adapt_cycle *c)
{
  const json_t *steps = json_object_get(o, "seconds");
  int goes_on = json_is_object(o) && !access(c->dir, F_OK);

  for (int k = 0; k < VG_ADAPT_N; k++) {
    const double s = c->is_done[k] ? 0 : vg_json_number(steps, step_names[k]);

    goes_on = goes_on && isfinite(s);
    c->is_done[k] = goes_on;
    if (goes_on) c->seconds[k] = s;
  }
  if (c->is_done[VG_ADAPT_METRIC]) {
    c->requested = vg_json_number(o, "requested_cells");
    c->attempt = (int)vg_json_number(o, "attempt");
  }
  if (c->is_done[VG_ADAPT_MESH]) {
    c->attempt = (int)vg_json_number(o, "attempt");
    c->exit_status = json_is_false(json_object_get(o, "meets_limits"));
    c->cells = vg_json_number(o, "cells");
    c->points = vg_json_number(o, "points");
    c->field_cells = vg_json_number(o, "field_cells");
    c->angle_min = vg_json_number(o, "angle_min");
  }
  if (c->is_done[VG_ADAPT_SOLVE])
    take_outputs(json_object_get(o, "outputs"), c);
  return goes_on;
}

/* The first setting that differs. */
static const char *changed(const json_t *now, const json_t *then)
{
  const char *name;
  const json_t *v;

  json_object_foreach((json_t *)(uintptr_t)now, name, v)
  {
    if (!json_equal(v, json_object_get(then, name))) return name;
  }
  return NULL;
}

/* Length of the name of a setting; a digest has the name of its file. */
static int name_length(const char *name)
{
  const size_t n = strlen(name);

  return (int)(vg_text_ends(name, DIGEST) ? n - strlen(DIGEST) : n);
}

static vg_status take_record(struct vg_adapt *a, struct vg_error *err)
{
  char *path = NULL;
  const char *other;
  json_error_t why;
  json_t *o;
  vg_status st = vg_folder_path(a->dir, RECORD, &path, err);

  if (st < 0) return st;
  if (access(path, F_OK)) {
    free(path);
    return VG_OK;
  }
  o = json_load_file(path, 0, &why);
  other = changed(a->settings, json_object_get(o, "settings"));
  if (!o)
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s:%d: %s; remove the file to begin "
                 "again",
                 path, why.line, why.text);
  else if (other)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s is the record of a loop with another %.*s; give another "
                 "folder by --out, or remove this one",
                 path, name_length(other), other);
  for (size_t i = 0; i < a->n && st >= 0; i++)
    if (!take_cycle(json_array_get(json_object_get(o, "cycles"), i),
                    &a->cycle[i]))
      break;
  json_decref(o);
  free(path);
  return st;
}

/* --- opening -------------------------------------------------------------- */

static vg_status absolute(const char *path, char **out, struct vg_error *err)
{
  *out = realpath(path, NULL);
  if (*out) return VG_OK;
  return errno == ENOMEM
         ? vg_fail_memory(err, "a path")
         : vg_fail(err, VG_ERR_IO, "%s: %s", path, strerror(errno));
}

/* The solver runs in the folder of the deck, so that a deck can name it by a
 * relative path. */
static vg_status find_home(struct vg_adapt *a, struct vg_error *err)
{
  char *copy = strdup(a->o->deck ? a->o->deck : "./.");
  vg_status st = copy ? absolute(dirname(copy), &a->home, err)
                      : vg_fail_memory(err, "a path");

  free(copy);
  return st;
}

static vg_status make_cycles(struct vg_adapt *a, struct vg_error *err)
{
  const struct vg_adapt_row *r = &a->o->row;
  const size_t n = r->cycles ? (size_t)r->cycles : 4;
  vg_status st = VG_OK;

  a->cycle = vg_calloc(n, sizeof *a->cycle);
  if (!a->cycle) return vg_fail_memory(err, "the cycles");
  a->n = n;
  for (size_t i = 0; i < n && st >= 0; i++) {
    struct vg_adapt_cycle *c = &a->cycle[i];
    char name[32];

    *c = (struct vg_adapt_cycle){ .number = (int)i + 1, .attempt = 1 };
    c->requested = c->cells = c->points = c->field_cells = c->angle_min = NAN;
    c->is_done[VG_ADAPT_METRIC] = !vg_adapt_has_metric(a, c);
    snprintf(name, sizeof name, "cycle-%zu", i + 1);
    st = vg_folder_path(a->dir, name, &c->dir, err);
  }
  return st;
}

/* The stem of the meshes, and the settings with the files as they are now. */
static vg_status find_files(struct vg_adapt *a, struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  const struct vg_input_files *f = &p.read.files;
  const char *slash;
  vg_status st;

  VG_TRY(vg_input_find(a->o->project, a->o->deck, &p.read.files, err));
  if (*a->o->row.field && f->is_section)
    VG_TRY(vg_fail(err, VG_ERR_INPUT,
                   "%s is a plane section, on which metrics do not act: leave "
                   "out the field, so that only first heights follow the "
                   "solution",
                   f->surface));
  slash = strrchr(f->stem, '/');
  a->stem = strdup(slash ? slash + 1 : f->stem);
  a->settings = settings_json(a->o, f);
  if (!a->stem || !a->settings) st = vg_fail_memory(err, "the settings");
done:
  vg_problem_release(&p);
  return st;
}

vg_status vg_adapt_open(const struct vg_adapt_options *o, struct vg_adapt *a,
                        struct vg_error *err)
{
  vg_status st;

  *a = (struct vg_adapt){ .o = o };
  VG_TRY(check_options(o, err));
  VG_TRY(find_files(a, err));
  VG_TRY(vg_make_folder(o->dir, err));
  VG_TRY(absolute(o->dir, &a->dir, err));
  VG_TRY(find_home(a, err));
  VG_TRY(make_cycles(a, err));
  st = take_record(a, err);
done:
  return st;
}

void vg_adapt_release(struct vg_adapt *a)
{
  for (size_t i = 0; i < a->n; i++) free(a->cycle[i].dir);
  free(a->cycle);
  free(a->dir);
  free(a->home);
  free(a->stem);
  json_decref(a->settings);
  *a = (struct vg_adapt){ .o = NULL };
}
