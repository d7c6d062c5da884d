/* The list of runs. Declared in cli/serve/portal_parts.h. */
#define _GNU_SOURCE
#include <dirent.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "cli/serve/page_markup.h"
#include "cli/serve/portal_parts.h"
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
  size_t n = strlen(name);
  int is_report = n > 12 && !strcmp(name + n - 12, ".report.html");
  char path[4096];
  struct stat s;
  int known;

  snprintf(path, sizeof path, "%s/%s/%s", run->dir, folder, name);
  known = !stat(path, &s);
  fprintf(to, "<a%s href=\"runs/%d/file/%s/",
          is_report ? " class=\"report\" target=\"_blank\" rel=\"noopener\""
                    : "",
          run->id, folder);
  vg_markup_path(to, name);
  fputs("\">", to);
  vg_markup(to, is_report ? "Report" : name);
  fputs("</a>", to);
  if (known && !is_report) {
    fputs(" <i>", to);
    vg_markup_size(to, s.st_size);
    fputs("</i>", to);
  }
  fputs("\n", to);
}

static void print_files(FILE *to, const struct vg_serve_run *run)
{
  const char *folder = run->is_sweep ? "sweep" : "mesh";
  char *name[FILES_SHOWN];
  size_t n;

  if (vg_run_is_active(run)) return;
  n = list_files(run, folder, name);
  if (n) fputs("<p class=\"files\">", to);
  for (size_t i = 0; i < n; i++) {
    print_file(to, run, folder, name[i]);
    free(name[i]);
  }
  if (n) fputs("</p>\n", to);
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

static void print_run(FILE *to, const struct vg_serve_run *run)
{
  const char *word = vg_run_state_word(run->state);

  fprintf(to,
          "<article id=\"run-%d\" class=\"run %s\" data-state=\"%s\">\n"
          "<h3><span class=\"id\">%d</span> ",
          run->id, word, word, run->id);
  vg_markup(to, run->title);
  fprintf(to, " <span class=\"state\">%s</span></h3>\n",
          run->state == VG_SERVE_LIMIT ? "done, but limit not met" : word);
  print_about(to, run);
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
      const struct vg_serve_run *run = r->item[r->n - 1 - i];

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

static json_t *json_of(const struct vg_serve_run *run)
{
  json_t *o = json_object();

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
