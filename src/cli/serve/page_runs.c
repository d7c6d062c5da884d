/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The list of runs. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "cli/serve/figures.h"
#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
#include "run/common/json_build.h"
#include "run/common/text.h"

/* Limits of a page: runs, bytes and lines of the end of a log, files of a
 * run. */
enum { RUNS_SHOWN = 60, TAIL_BYTES = 3000, TAIL_LINES = 14, FILES_SHOWN = 60 };

static void print_time(FILE *to, int64_t when)
{
  time_t t = (time_t)when;
  struct tm local;
  char text[40];

  if (!localtime_r(&t, &local) ||
      !strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local))
    return;
  fputs(text, to);
}

static void print_duration(FILE *to, int64_t s)
{
  long long t = s > 0 ? (long long)s : 0;

  if (t < 60) fprintf(to, "%lld s", t);
  else if (t < 3600) fprintf(to, "%lld min %02lld s", t / 60, t % 60);
  else fprintf(to, "%lld h %02lld min", t / 3600, t / 60 % 60);
}

/* Project, machine and times in one line. */
static void print_about(FILE *to, const struct vg_serve_run *run)
{
  fputs("<p class=\"about\">", to);
  fputs(run->is_sweep ? "sweep of " : "mesh of ", to);
  vg_markup(to, run->project);
  if (!run->is_slurm && !run->is_sweep)
    fprintf(to, " &middot; this machine, %d rank%s", run->ranks,
            run->ranks > 1 ? "s" : "");
  if (run->is_slurm) {
    fprintf(to, " &middot; Slurm, %d node%s with %d rank%s of %d CPU%s",
            run->nodes, run->nodes > 1 ? "s" : "", run->ranks,
            run->ranks > 1 ? "s" : "", run->cpus, run->cpus > 1 ? "s" : "");
    if (*run->job) fprintf(to, ", job %s", run->job);
  }
  if (run->started) {
    fputs(" &middot; started ", to);
    print_time(to, run->started);
  }
  if (run->started && run->ended) {
    fputs(" &middot; duration ", to);
    print_duration(to, run->ended - run->started);
  }
  if (run->exit_status > 0)
    fprintf(to, " &middot; exit status %d", run->exit_status);
  fputs("</p>\n", to);
}

/* Progress bar of the current stage, with rate and time left. */
static void print_progress(FILE *to, const struct vg_serve_run *run)
{
  const struct vg_tell *t = &run->tell;

  if (run->state != VG_SERVE_RUNNING && run->state != VG_SERVE_STOPPING) return;
  fputs("<div class=\"progress\"><progress max=\"100\"", to);
  if (t->share >= 0) fprintf(to, " value=\"%d\"", (int)(100 * t->share));
  fputs("></progress> <span><b>", to);
  vg_markup(to, *t->stage ? t->stage : "starting");
  fputs("</b>", to);
  if (t->share >= 0) fprintf(to, " %d %%", (int)(100 * t->share));
  if (*t->count) fputs(" &middot; ", to);
  vg_markup(to, t->count);
  if (*t->rate) fputs(" &middot; ", to);
  vg_markup(to, t->rate);
  if (*t->left) fputs(" &middot; time left: ", to);
  vg_markup(to, t->left);
  fputs("</span></div>\n", to);
}

static void print_button(FILE *to, const struct vg_serve_run *run,
                         const char *what, const char *label)
{
  fprintf(to,
          "<form method=\"post\" action=\"runs/%d/%s\"><button>%s</button>"
          "</form>\n",
          run->id, what, label);
}

static void print_buttons(FILE *to, const struct vg_serve_run *run)
{
  if (run->state == VG_SERVE_STOPPING)
    print_button(to, run, "kill", "Stop immediately");
  else if (vg_run_is_active(run)) print_button(to, run, "stop", "Stop");
  if (vg_run_can_resume(run))
    print_button(to, run, "resume",
                 vg_run_has_kept(run) ? "Resume" : "Restart");
  if (!vg_run_is_active(run) && run->is_sweep)
    fprintf(to, "<a class=\"result\" href=\"?sweep=%d\">Figures</a>\n",
            run->id);
  else if (run->figures.is_known)
    fprintf(to, "<a class=\"result\" href=\"?report=%d\">Report</a>\n",
            run->id);
  fprintf(to,
          "<a href=\"?from=%d#form\">Settings</a> <a href=\"runs/%d/log\">"
          "Log</a> <a href=\"runs/%d/output\">Output</a> <a "
          "href=\"runs/%d/deck\">Deck</a>\n",
          run->id, run->id, run->id, run->id);
}

/* --- results ------------------------------------------------------------- */

static int by_name(const void *a, const void *b)
{
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Store the sorted names of the regular files in a folder of a run; returns
 * their number. */
static size_t list_files(const struct vg_serve_run *run, const char *folder,
                         char *name[FILES_SHOWN])
{
  char path[4096];
  DIR *d = opendir(vg_run_path(run, folder, path));
  struct dirent *e;
  size_t n = 0;

  while (d && n < FILES_SHOWN && (e = readdir(d)))
    if (*e->d_name != '.' && e->d_type != DT_DIR &&
        (name[n] = strdup(e->d_name)))
      n++;
  if (d) closedir(d);
  qsort(name, n, sizeof *name, by_name);
  return n;
}

static void print_file(FILE *to, const struct vg_serve_run *run,
                       const char *folder, const char *name)
{
  char path[4096];
  struct stat s;

  fprintf(to, "<li><a href=\"runs/%d/file/%s/", run->id, folder);
  vg_markup_path(to, name);
  fputs("\">", to);
  vg_markup(to, name);
  fputs("</a>", to);
  snprintf(path, sizeof path, "%s/%s/%s", run->dir, folder, name);
  if (!stat(path, &s)) {
    fputs(" <i>", to);
    vg_markup_size(to, s.st_size);
    fputs("</i>", to);
  }
  fputs("</li>\n", to);
}

static void print_files(FILE *to, const struct vg_serve_run *run)
{
  const char *folder = run->is_sweep ? "sweep" : "mesh";
  char *name[FILES_SHOWN];
  size_t n;

  if (vg_run_is_active(run)) return;
  n = list_files(run, folder, name);
  if (!n) return;
  fprintf(to,
          "<details class=\"files\" id=\"files-%d\"><summary>%zu file%s"
          "</summary><ul>\n",
          run->id, n, n > 1 ? "s" : "");
  for (size_t i = 0; i < n; i++) {
    print_file(to, run, folder, name[i]);
    free(name[i]);
  }
  fputs("</ul></details>\n", to);
}

/* The archive, and the removal, which needs two presses. */
static void print_disposal(FILE *to, const struct vg_serve_run *run)
{
  if (vg_run_is_active(run)) return;
  fprintf(to,
          "<div class=\"disposal\"><a href=\"runs/%d/archive.tar\" download>"
          "Download all files</a>\n<details class=\"delete\" id=\"delete-%d\">"
          "<summary>Delete</summary><form method=\"post\" "
          "action=\"runs/%d/delete\"><button class=\"bad\">Delete run %d and "
          "all its files</button></form></details></div>\n",
          run->id, run->id, run->id, run->id);
}

/* --- figures ------------------------------------------------------------- */

static void print_figure(FILE *to, const char *name, const char *value)
{
  fprintf(to, "<div><dt>%s</dt><dd>%s</dd></div>\n", name, value);
}

/* A picture, and the figures that show at once what came out. */
static void print_figures(FILE *to, const struct vg_serve_run *run)
{
  const struct vg_serve_figures *f = &run->figures;
  char text[48];

  if (!f->is_known) return;
  fprintf(
    to,
    "<a class=\"thumb\" href=\"?report=%d\"><img alt=\"Surface of run "
    "%d; opens the report\" width=\"864\" height=\"576\" loading=\"lazy\" "
    "src=\"runs/%d/picture/0?t=%lld\"></a>\n<dl class=\"figures\">\n",
    run->id, run->id, run->id, (long long)run->ended);
  print_figure(to, "Cells", vg_text_count((unsigned long long)f->cells, text));
  fprintf(to, "<div><dt>Mesh</dt><dd class=\"%s\">%s</dd></div>\n",
          f->is_valid ? "good" : "bad", f->is_valid ? "valid" : "not valid");
  if (isfinite(f->angle)) {
    snprintf(text, sizeof text, "%.1f&deg;", f->angle);
    print_figure(to, "Smallest angle", text);
  }
  snprintf(text, sizeof text, "%.3g s", f->seconds);
  print_figure(to, "Time", text);
  fputs("</dl>\n", to);
}

static void print_choice(FILE *to, const struct vg_serve_run *run)
{
  if (!run->figures.is_known) return;
  fprintf(to,
          "<label class=\"pick\"><input type=\"checkbox\" form=\"compare\" "
          "name=\"compare\" value=\"%d\"> compare</label>",
          run->id);
}

/* --- end of the log ------------------------------------------------------ */

static void print_tail(FILE *to, const struct vg_serve_run *run)
{
  char path[4096], text[TAIL_BYTES], *at = text;
  int64_t whole;
  size_t n = vg_file_tail(vg_run_path(run, "run.log", path), text, sizeof text,
                          &whole),
         lines = 0;

  if (!n || run->is_sweep)
    n = vg_file_tail(vg_run_path(run, "output.log", path), text, sizeof text,
                     &whole);
  if (!n) return;
  for (size_t i = n; i-- > 0;)
    if (text[i] == '\n' && i + 1 < n && ++lines == TAIL_LINES) {
      at = text + i + 1;
      break;
    }
  fprintf(to, "<details id=\"log-%d\"%s><summary>Log</summary><pre>\n", run->id,
          vg_run_is_active(run) ? " open" : "");
  vg_markup_bytes(to, at, n - (size_t)(at - text));
  fputs("</pre></details>\n", to);
}

static void print_run(FILE *to, struct vg_serve_run *run)
{
  const char *word = vg_run_state_word(run->state);

  vg_figures_read(run);
  fprintf(to,
          "<article id=\"run-%d\" class=\"run %s\" data-state=\"%s\">\n"
          "<h3><span class=\"id\">%d</span> ",
          run->id, word, word, run->id);
  vg_markup(to, run->title);
  fprintf(to, " <span class=\"state\">%s</span></h3>\n",
          run->state == VG_SERVE_LIMIT ? "done, but limit not met" : word);
  print_choice(to, run);
  print_about(to, run);
  print_figures(to, run);
  print_progress(to, run);
  if (*run->note) {
    fputs("<p class=\"note\">", to);
    vg_markup(to, run->note);
    fputs("</p>\n", to);
  }
  fputs("<div class=\"buttons\">", to);
  print_buttons(to, run);
  fputs("</div>\n", to);
  print_files(to, run);
  print_tail(to, run);
  print_disposal(to, run);
  fputs("</article>\n", to);
}

static int is_at_work(const struct vg_serve_run *run)
{
  return vg_run_is_active(run) && run->state != VG_SERVE_QUEUED;
}

void vg_page_runs(const struct vg_portal *p, FILE *to)
{
  const struct vg_serve_runs *r = &p->runs;
  size_t n = r->n < RUNS_SHOWN ? r->n : RUNS_SHOWN;

  fprintf(to, "<div id=\"list\" data-active=\"%d\">\n", vg_portal_active(p));
  if (!r->n) fputs("<p class=\"about\">No run yet.</p>\n", to);
  /* Running ones first, then the newest. */
  for (int at_work = 1; at_work >= 0; at_work--)
    for (size_t i = 0; i < r->n; i++) {
      struct vg_serve_run *run = r->item[r->n - 1 - i];

      if (is_at_work(run) == at_work && (i < n || vg_run_is_active(run)))
        print_run(to, run);
    }
  if (n < r->n)
    fprintf(
      to,
      "<p class=\"about\">Of %zu runs, the active and the latest ones are "
      "shown; the folder vanguard-runs contains all of them.</p>\n",
      r->n);
  fputs("</div>\n", to);
}

/* --- JSON ---------------------------------------------------------------- */

static json_t *json_of(struct vg_serve_run *run)
{
  const struct vg_serve_figures *f = &run->figures;
  json_t *o = json_object();

  vg_figures_read(run);
  json_object_set_new(o, "id", json_integer(run->id));
  json_object_set_new(o, "state", json_string(vg_run_state_word(run->state)));
  json_object_set_new(o, "project", vg_text_json(run->project));
  json_object_set_new(o, "title", vg_text_json(run->title));
  json_object_set_new(o, "kind", json_string(run->is_sweep ? "sweep" : "mesh"));
  json_object_set_new(o, "where",
                      json_string(run->is_slurm ? "slurm" : "here"));
  json_object_set_new(o, "job", json_string(run->job));
  json_object_set_new(o, "exit_status", json_integer(run->exit_status));
  json_object_set_new(o, "note", vg_text_json(run->note));
  json_object_set_new(o, "stage", vg_text_json(run->tell.stage));
  json_object_set_new(o, "share",
                      run->tell.share >= 0 ? json_real(run->tell.share)
                                           : json_null());
  json_object_set_new(o, "left", vg_text_json(run->tell.left));
  if (f->is_known) {
    json_object_set_new(o, "cells", json_integer((json_int_t)f->cells));
    json_object_set_new(o, "valid", json_boolean(f->is_valid));
    json_object_set_new(o, "angle_min", json_real(f->angle));
    json_object_set_new(o, "seconds", json_real(f->seconds));
  }
  return o;
}

char *vg_page_runs_json(const struct vg_portal *p)
{
  json_t *list = json_array();
  char *text;

  for (size_t i = 0; i < p->runs.n; i++)
    json_array_append_new(list, json_of(p->runs.item[i]));
  text = json_dumps(list, JSON_INDENT(1));
  json_decref(list);
  return text;
}
