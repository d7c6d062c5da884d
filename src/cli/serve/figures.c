/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/serve/figures.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/http/inside.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "run/common/text.h"

#define REPORT_MAX (64 << 20) /* bytes of a report */

char *vg_run_result(const struct vg_serve_run *run, const char *suffix)
{
  const char *folder = run->is_sweep ? "sweep" : "mesh";
  size_t m = strlen(suffix), n;
  char path[4096], *found = NULL;
  DIR *d = opendir(vg_run_path(run, folder, path));
  struct dirent *e;

  while (d && !found && (e = readdir(d))) {
    n = strlen(e->d_name);
    if (*e->d_name == '.' || n < m || strcmp(e->d_name + n - m, suffix) != 0)
      continue;
    if (asprintf(&found, "%s/%s", folder, e->d_name) < 0) found = NULL;
  }
  if (d) closedir(d);
  return found;
}

/* The content of a result, terminated by a zero; NULL: it is absent, too large
 * or not a file of the run. */
static char *content(const struct vg_serve_run *run, const char *suffix,
                     size_t *n)
{
  char *name = vg_run_result(run, suffix), *real = NULL, *text = NULL;
  struct vg_error err;
  int64_t whole;
  char none[2];

  if (name && vg_inside(run->dir, name, &real, &err) >= 0) {
    vg_file_tail(real, none, sizeof none, &whole);
    if (whole > 0 && whole <= REPORT_MAX) text = malloc((size_t)whole + 1);
    if (text) *n = vg_file_tail(real, text, (size_t)whole + 1, &whole);
  }
  free(real);
  free(name);
  return text;
}

json_t *vg_run_report(const struct vg_serve_run *run)
{
  size_t n = 0;
  char *text = content(run, run->is_sweep ? "sweep.json" : ".report.json", &n);
  json_error_t why;
  json_t *o = text ? json_loadb(text, n, 0, &why) : NULL;

  free(text);
  return o;
}

/* --- values -------------------------------------------------------------- */

const struct vg_figure vg_figure[] = {
  { "mesh.valid", "Valid", "", -2, 1 },
  { "mesh.cells", "Cells", "", -1, 0 },
  { "mesh.points", "Points", "", -1, 0 },
  { "field.cells", "Cells outside the layers", "", -1, 0 },
  { "layers.wall_triangles", "Wall triangles", "", -1, 0 },
  { "field.angle_min", "Smallest dihedral angle", "degrees", 2, 1 },
  { "field.angle_max", "Largest dihedral angle", "degrees", 2, -1 },
  { "field.angle_min_p1", "1st percentile of each cell's smallest angle",
    "degrees", 2, 1 },
  { "field.radius_ratio_mean", "Mean radius ratio", "", 4, 1 },
  { "field.edges.percent_within", "Edges of the requested length", "%", 2, 1 },
  { "layers.all.percent_full", "Wall faces with full layers", "%", 2, 1 },
  { "layers.all.height_over_growth_law.mean",
    "Layer height over that of the growth law", "", 3, 1 },
  { "layers.all.levels.mean", "Mean number of layers", "", 1, 0 },
  { "layers.all.y_plus.mean", "Mean y+", "", 3, 0 },
  { "layers.all.top_volume_ratio.percentile_95",
    "Volume ratio across the top of the layers, 95th percentile", "", 2, -1 },
  { "surface.quality.angle_min", "Smallest angle of the surface", "degrees", 2,
    1 },
  { "seconds.total", "Time", "s", 1, -1 },
  { "partition.memory_of_all_ranks_bytes", "Peak memory", "", -3, -1 },
};
const size_t vg_n_figure = sizeof vg_figure / sizeof *vg_figure;

const json_t *vg_figure_of(const json_t *report, const char *path)
{
  char key[80];

  while (report && *path) {
    size_t n = strcspn(path, ".");

    snprintf(key, sizeof key, "%.*s", (int)n, path);
    report = json_object_get(report, key);
    path += n + (path[n] == '.');
  }
  return report;
}

/* The mesh as a whole has the cells of the layers, whose angles are small by
 * design, so the quality is that of the field; without layers there is only the
 * mesh. */
static const json_t *judged(const json_t *report, const char *path)
{
  const json_t *v = vg_figure_of(report, path);
  char other[80];

  if (v || strncmp(path, "field.", 6) != 0) return v;
  snprintf(other, sizeof other, "mesh.%s", path + 6);
  return vg_figure_of(report, other);
}

void vg_figure_print(FILE *to, const struct vg_figure *f, const json_t *v)
{
  char text[32];

  if (f->decimals == -2 && json_is_boolean(v))
    fputs(json_is_true(v) ? "yes" : "no", to);
  else if (!json_is_number(v)) fputs("&ndash;", to);
  else if (f->decimals == -1)
    fputs(vg_text_count((unsigned long long)fmax(json_number_value(v), 0),
                        text),
          to);
  else if (f->decimals == -3)
    vg_markup_size(to, (long long)json_number_value(v));
  else fprintf(to, "%.*f", f->decimals, json_number_value(v));
  if (*f->unit && json_is_number(v)) fprintf(to, " %s", f->unit);
}

void vg_figures_read(struct vg_serve_run *run)
{
  struct vg_serve_figures *f = &run->figures;
  const json_t *angle;
  json_t *o;

  if (f->is_read || vg_run_is_active(run)) return;
  f->is_read = 1;
  if (run->is_sweep) return;
  o = vg_run_report(run);
  angle = judged(o, "field.angle_min");
  f->is_known = json_is_boolean(vg_figure_of(o, "mesh.valid"));
  f->is_valid = json_is_true(vg_figure_of(o, "mesh.valid"));
  f->cells = json_number_value(vg_figure_of(o, "mesh.cells"));
  f->points = json_number_value(vg_figure_of(o, "mesh.points"));
  f->angle = json_is_number(angle) ? json_number_value(angle) : NAN;
  f->seconds = json_number_value(vg_figure_of(o, "seconds.total"));
  f->memory = json_number_value(
    vg_figure_of(o, "partition.memory_of_all_ranks_bytes"));
  json_decref(o);
}

/* --- pictures ------------------------------------------------------------ */

static int digit_of(int c)
{
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                               "abcdefghijklmnopqrstuvwxyz0123456789+/";
  const char *at = c ? strchr(digits, c) : NULL;

  return at ? (int)(at - digits) : -1;
}

/* Decode base64 in place; returns the number of bytes. */
static size_t decode(char *text, size_t n)
{
  unsigned bits = 0;
  size_t size = 0;
  int held = 0;

  for (size_t i = 0; i < n; i++) {
    int d = digit_of((unsigned char)text[i]);

    if (d < 0) break;
    bits = bits << 6 | (unsigned)d;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    text[size++] = (char)(bits >> held & 255);
  }
  return size;
}

/* The pictures are in the report as PNG: first the surface by patches, and the
 * first section with this id. */
void vg_reply_picture(const struct vg_serve_run *run, int which,
                      struct vg_reply *a)
{
  static const char start[] = "data:image/png;base64,";
  static const char *const after[VG_PICTURES] = { "<figure>", "id=\"cut0\"" };
  size_t n = 0;
  char *text = content(run, ".report.html", &n), *at = NULL;

  if (text) at = memmem(text, n, after[which], strlen(after[which]));
  if (at) at = memmem(at, n - (size_t)(at - text), start, sizeof start - 1);
  if (!at) {
    free(text);
    vg_reply_text(a, 404, "This run has no such picture.");
    return;
  }
  at += sizeof start - 1;
  a->size = decode(at, n - (size_t)(at - text));
  memmove(text, at, a->size);
  a->body = text;
  a->type = "image/png";
  a->is_fixed = 1;
}
