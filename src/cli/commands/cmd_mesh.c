/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard mesh: generates the volume mesh of a project. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/version.h"
#include "cli/commands/commands.h"
#include "cli/commands/mesh_log.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/html/html.h"
#include "cli/plot/plot.h"
#include "cli/plot/timeline.h"
#include "io/stream/stream.h"
#include "run/common/json_file.h"
#include "run/common/log.h"
#include "run/common/ranges.h"
#include "run/common/text.h"
#include "run/layers/layers.h"
#include "run/report/report.h"
#include "run/stages/output.h"
#include "run/stages/report_run.h"
#include "run/stages/run.h"

struct arguments {
  const char *project, *deck, *dir, *log;
  int argc;
  char **argv;
  int json, quiet, timeline;
  double every; /* seconds between progress lines; 0: 10 */
  struct vg_run_options run;
  struct vg_cli_overrides kept;
};

struct run {
  struct vg_problem problem;
  struct vg_outputs outputs;
  struct vg_display show;
  struct vg_layer_stage layers;
  struct vg_run mesh;
  struct vg_run_times time;
  struct vg_cure cure; /* Settings that the program chose. */
};

/* Options that are not settings: they do not change the mesh. */
enum {
  KEY_TIMELINE = 1,
  KEY_LOG,
  KEY_PROGRESS,
  KEY_RUN_DIR,
  KEY_RESUME,
  KEY_KEEP,
  KEY_LIMIT,
  KEY_SHUFFLE,
  KEY_NODE_RANKS,
  KEY_DIFFER,
  KEY_FAIL
};

static error_t limit(const char *text, uint64_t *to,
                     const struct argp_state *state)
{
  int64_t v;

  if (!vg_parse_count(text, strlen(text), &v) || v < 0)
    argp_error(state, "'%s' is not a non-negative integer", text);
  *to = (uint64_t)v;
  return 0;
}

static error_t differ(const char *text, enum vg_agree *to,
                      const struct argp_state *state)
{
  for (int k = 0; k < VG_AGREE_N; k++)
    if (!strcmp(text, vg_agree_name((enum vg_agree)k))) {
      *to = (enum vg_agree)k;
      return 0;
    }
  argp_error(state, "'%s' is not one of surface, layers, sizes", text);
  return 0;
}

static error_t fail_leaves(const char *text, struct vg_run_options *to,
                           const struct argp_state *state)
{
  char *end;

  to->fail_leaves = strtod(text, &end);
  to->fail_rounds = *end == ',' ? (int)strtol(end + 1, &end, 10) : 1;
  if (end == text || *end || !(to->fail_leaves >= 0 && to->fail_leaves <= 1))
    argp_error(state, "'%s' is not a fraction from 0 to 1", text);
  return 0;
}

static error_t seconds(const char *text, double *to,
                       const struct argp_state *state)
{
  if (!vg_parse_real(text, strlen(text), to) || !(*to >= 0.1 && *to <= 86400))
    argp_error(state, "'%s' is not a time from 0.1 to 86400 s", text);
  return 0;
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'p': a->project = arg; return 0;
  case 'd': a->deck = arg; return 0;
  case 'o': a->dir = arg; return 0;
  case 'j': a->json = 1; return 0;
  case 'q': a->quiet = 1; return 0;
  case KEY_TIMELINE: a->timeline = a->run.near = 1; return 0;
  case KEY_LOG: a->log = arg; return 0;
  case KEY_PROGRESS: return seconds(arg, &a->every, state);
  case KEY_RUN_DIR: a->run.dir = arg; return 0;
  case KEY_RESUME: a->run.resume = 1; return 0;
  case KEY_KEEP: a->run.keep = 1; return 0;
  case KEY_LIMIT: return limit(arg, &a->run.limit, state);
  case KEY_SHUFFLE: return limit(arg, &a->run.shuffle, state);
  case KEY_NODE_RANKS: return limit(arg, &a->run.node_ranks, state);
  case KEY_FAIL: return fail_leaves(arg, &a->run, state);
  case KEY_DIFFER: return differ(arg, &a->run.change, state);
  case 'L': key = vg_cli_option_key("bisections"); break;
  case 't': key = vg_cli_option_key("threads"); break;
  case ARGP_KEY_ARG:
    if (a->project) argp_error(state, "only one project is accepted: %s", arg);
    a->project = arg;
    return 0;
  case ARGP_KEY_END:
    if (!a->project) argp_error(state, "no project given; use -p PROJECT");
    if (a->run.resume && !a->run.dir)
      argp_error(state, "--resume requires the --run-dir of the run");
    return 0;
  default: break;
  }
  return vg_cli_add_override(&a->kept, key, arg, state);
}

static void apply_cure(const struct run *r, struct vg_settings *s)
{
  if (r->cure.wrap > 0) s->wrap = r->cure.wrap;
  if (r->cure.close_holes) s->close_holes = 1;
}

static int is_cured(const struct run *r)
{
  return r->cure.wrap > 0 || r->cure.close_holes;
}

/* Find the files and read the settings, on each rank. */
static vg_status read_settings(struct run *r, const struct arguments *a,
                               struct vg_error *err)
{
  struct vg_problem *p = &r->problem;
  char list[VG_WRITE_MAX];
  vg_status st;

  VG_TRY(vg_display_stopped(&r->show, err));
  vg_display_update(&r->show, "read", 0, 0);
  VG_TRY(vg_problem_open(p, a->project, a->deck, err));
  VG_TRY(vg_cli_apply(&a->kept, &p->asked, err));
  apply_cure(r, &p->asked);
  vg_section_complete(&p->read, &p->asked);
  vg_mesh_log_settings(&r->mesh, &p->asked);
  if (r->outputs.dir) goto done;
  vg_resolve_write(&p->asked, list);
  st = vg_outputs_plan(p, p->read.files.stem, a->dir, list, &r->outputs, err);
  if (st >= 0 && !r->mesh.rank)
    st = vg_outputs_claim(&r->outputs, &p->notes, err);
done:
  return st;
}

/* Read settings and surface. */
static vg_status read_project(struct run *r, const struct arguments *a,
                              struct vg_error *err)
{
  struct vg_comm *comm = r->mesh.comm;
  double t = vg_display_now();
  vg_status st;

  VG_TRY(vg_comm_agree(comm, read_settings(r, a, err), err));
  st = vg_problem_read(&r->problem, comm, &r->show, err);
  r->time.read = vg_display_now() - t;
done:
  return st;
}

static vg_status close_surface(struct run *r, struct vg_error *err)
{
  struct vg_run *m = &r->mesh;
  double t = vg_display_now();
  vg_status st;

  VG_TRY(vg_run_surface(m, &r->problem, &r->layers, &r->show, err));
  r->time.check = vg_display_now() - t;
  st = vg_outputs_check(&r->problem, &r->outputs, err);
  if (st >= 0) st = vg_display_stopped(&r->show, err);
  st = vg_comm_agree(m->comm, st, err);
done:
  return st;
}

/* The remedy of the refused surface: rank 0 and the first rank of each node
 * found it. */
static vg_status share_cure(struct run *r, struct vg_error *err)
{
  const struct vg_cure *c = &r->problem.boundary.cure;
  double v[2] = { c->wrap, c->close_holes };
  vg_status st = vg_comm_max(r->mesh.comm, 2, v, err);

  if (!r->problem.asked.repair) return st;
  r->cure.wrap = v[0];
  r->cure.close_holes = !(v[0] > 0) && v[1] > 0;
  return st;
}

/* Reads and closes the surface again, with the remedy or without.
 * why: message that named the remedy */
static vg_status begin_again(struct run *r, const struct arguments *a,
                             const char *why, struct vg_error *err)
{
  vg_status st;

  vg_layer_stage_release(&r->layers);
  vg_problem_release(&r->problem);
  r->problem = (struct vg_problem)VG_PROBLEM_INIT;
  VG_TRY(read_project(r, a, err));
  r->problem.read.is_cured = is_cured(r);
  if (is_cured(r))
    vg_note(&r->problem.notes,
            "%s: the program does this by itself; repair no refuses such a "
            "surface",
            why);
  st = close_surface(r, err);
done:
  return st;
}

/* Starts again with the remedy of the refused surface if there is only one. If
 * it fails, the surface is refused with its own defects. */
static vg_status cure_surface(struct run *r, const struct arguments *a,
                              struct vg_error *err)
{
  const struct vg_error why = *err;
  vg_status st = share_cure(r, err);

  if (st < 0) return st;
  if (!is_cured(r)) return why.code;
  st = begin_again(r, a, why.text, err);
  if (st != VG_ERR_GEOMETRY && st != VG_ERR_INPUT) return st;
  r->cure = (struct vg_cure){ 0, 0 };
  return begin_again(r, a, NULL, err);
}

static struct vg_run_report report_of(const struct run *r)
{
  return (struct vg_run_report){ &r->problem, &r->layers, &r->mesh,
                                 &r->outputs, 1,          r->time };
}

static json_t *report_json(const struct run *r, int ok,
                           const struct vg_error *err)
{
  const struct vg_run_report report = report_of(r);

  return vg_run_report_json(&report, ok, err);
}

static void print_surface(FILE *to, const struct run *r)
{
  const struct vg_run_report report = report_of(r);

  vg_run_report_surface_text(to, &report);
}

static void print_report(FILE *to, const struct run *r)
{
  const struct vg_run_report report = report_of(r);

  vg_run_report_text(to, &report);
}

/* The timeline of the run; spans are borrowed. */
static struct vg_timeline timeline_of(const struct run *r)
{
  struct vg_timeline t = VG_TIMELINE_INIT;

  snprintf(t.title, sizeof t.title, "%s", r->problem.asked.title);
  t.seconds[VG_PHASE_READ] = r->time.read;
  t.seconds[VG_PHASE_CHECK] = r->time.check;
  t.seconds[VG_PHASE_SIZES] = r->mesh.time_size;
  t.seconds[VG_PHASE_LAYERS] = r->mesh.time_layers;
  t.seconds[VG_PHASE_ENGINE] = r->mesh.spans.wall;
  t.seconds[VG_PHASE_NUMBER] = r->mesh.partition.number;
  t.seconds[VG_PHASE_JUDGE] = r->mesh.time_judge;
  t.seconds[VG_PHASE_WRITE] = r->time.write + r->time.digest + r->time.sync;
  /* Work done only for the timeline is excluded. */
  t.seconds[VG_PHASE_TOTAL] = vg_display_now() - r->time.start -
                              r->mesh.time_near;
  t.n_cell = vg_run_cells(&r->mesh);
  t.n_point = r->mesh.slices.n_point;
  t.cyclic = r->problem.asked.cyclic;
  t.spans = r->mesh.spans;
  return t;
}

static vg_status write_timeline(struct run *r, struct vg_error *err)
{
  struct vg_timeline t = timeline_of(r);
  char *path;
  vg_status st;

  VG_TRY(vg_outputs_add(&r->outputs, "timeline.json", err));
  path = vg_outputs_temp_path(&r->outputs, "timeline.json");
  st = path ? vg_timeline_write(path, &t, err)
            : vg_fail_memory(err, "the record of tasks");
  free(path);
done:
  return st;
}

/* The HTML report embeds a drawing of the timeline, which is written to a
 * temporary file. */
static vg_status write_page(struct run *r, struct vg_error *err)
{
  struct vg_timeline t = timeline_of(r);
  double start = vg_display_now();
  struct vg_html page = { .problem = &r->problem,
                          .layers = &r->layers,
                          .run = &r->mesh };
  char *path = NULL, *svg = NULL;
  json_t *report = NULL;
  vg_status st;

  path = vg_outputs_temp_path(&r->outputs, "report.html");
  svg = vg_outputs_temp_path(&r->outputs, "timeline.svg");
  report = report_json(r, 1, NULL);
  if (!path || !svg || !report) {
    st = vg_fail_memory(err, "the report");
    goto done;
  }
  VG_TRY(vg_plot_timeline(svg, &t, err));
  page.report = report;
  page.timeline = svg;
  st = vg_html_write(path, &page, err);
done:
  if (svg) unlink(svg);
  json_decref(report);
  free(path);
  free(svg);
  r->time.page = vg_display_now() - start;
  return st;
}

/* Work of rank 0 at the end: write the reports and move all files to their
 * final names. */
static vg_status finish(struct run *r, const struct arguments *a,
                        struct vg_error *err)
{
  double t = vg_display_now();
  char *path = NULL;
  json_t *report = NULL;
  vg_status st;

  VG_TRY(vg_outputs_digest(&r->outputs, err));
  r->time.digest = vg_display_now() - t;
  t = vg_display_now();
  VG_TRY(vg_outputs_sync(&r->outputs, err));
  r->time.sync = vg_display_now() - t;
  if (a->timeline) VG_TRY(write_timeline(r, err));
  if (r->problem.asked.report_html)
    VG_TRY(vg_outputs_add(&r->outputs, "report.html", err));
  VG_TRY(vg_outputs_add(&r->outputs, "report.json", err));
  if (r->problem.asked.report_html) VG_TRY(write_page(r, err));
  path = vg_outputs_temp_path(&r->outputs, "report.json");
  report = report_json(r, 1, NULL);
  st = path && report ? vg_json_write(path, report, "the report", err)
                      : vg_fail_memory(err, "the report");
  if (st < 0) goto done;
  VG_TRY(vg_display_stopped(&r->show, err));
  vg_display_commit();
  VG_TRY(vg_outputs_commit(&r->outputs, err));
done:
  json_decref(report);
  free(path);
  return st;
}

static vg_status write_all(struct run *r, const struct arguments *a,
                           struct vg_error *err)
{
  struct vg_run *m = &r->mesh;
  double t = vg_display_now();
  vg_status st;

  vg_display_update(&r->show, "write", vg_run_cells(m), 0);
  VG_TRY(vg_outputs_mesh(&r->outputs, &r->problem, &r->layers, m->comm,
                         vg_run_slices(m), m->threads, err));
  r->time.write = vg_display_now() - t + m->time_put;
  VG_TRY(vg_run_memory(m, err));
  st = m->rank ? VG_OK : finish(r, a, err);
  st = vg_comm_agree(m->comm, st, err);
done:
  return st;
}

/* Open edges of a half model are no defects: its symmetry plane closes them. */
static int has_defects(const struct vg_boundary *b)
{
  const int is_half = b->flow.kind != VG_FLOW_UNKNOWN && b->flow.axis >= 0;

  return b->check.n_defect >
         (is_half ? b->check.count[VG_DEFECT_OPEN_EDGE] : 0);
}

/* Write all faces with a defect to STEM.defects.vtu. */
static void show_defects(struct run *r, const struct arguments *a)
{
  const struct vg_boundary *b = &r->problem.boundary;
  struct vg_error err = VG_ERROR_INIT;
  char *path;

  if (!has_defects(b) || !r->outputs.dir) return;
  if (!a->json) print_surface(stdout, r);
  if (vg_log()) print_surface(vg_log(), r);
  path = vg_outputs_final(&r->outputs, "defects.vtu");
  if (!path) return;
  if (vg_write_defects(path, &b->surface, &b->check, &err) < 0)
    vg_cli_fail(&err);
  else if (!a->json) printf("  all faces with defects: %s\n", path);
  free(path);
}

static int print_json(const struct run *r, int ok, const struct vg_error *err)
{
  json_t *o = report_json(r, ok, err);
  int bad = json_dumpf(o, stdout, JSON_INDENT(2));

  printf("\n");
  json_decref(o);
  return bad || fflush(stdout) ? VG_EXIT_FAILED : VG_EXIT_DONE;
}

static vg_status run_stages(struct run *r, const struct arguments *a,
                            struct vg_error *err)
{
  struct vg_problem *p = &r->problem;
  struct vg_run *m = &r->mesh;
  struct vg_mesh front;
  vg_status st;

  r->mesh.options = a->run;
  VG_TRY(vg_run_resumable(m, err));
  VG_TRY(read_project(r, a, err));
  st = close_surface(r, err);
  if (st == VG_ERR_GEOMETRY) st = cure_surface(r, a, err);
  if (st < 0) goto done;
  VG_TRY(vg_run_mesh(m, p, &r->layers, &r->show, err));
  front = vg_layer_stage_front(&r->layers, &p->boundary.surface);
  vg_effects_note(&m->effects, &front, &p->resolved.settings, &p->notes);
  vg_run_note_zones(m, &p->boundary.surface, &p->notes);
  vg_problem_note_unused(p, r->layers.is_on, VG_USE_JUDGED_MESH);
  vg_report_layers_note(&r->layers, &p->boundary.surface, &p->notes);
  st = write_all(r, a, err);
done:
  return vg_outputs_failed(&r->outputs, st, err);
}

static int report_failure(struct run *r, const struct arguments *a,
                          const struct vg_error *err)
{
  if (r->mesh.rank) return vg_cli_exit(err);
  if (err->code != VG_ERR_MEMORY) show_defects(r, a);
  if (a->json) print_json(r, 0, err);
  return vg_cli_fail(err);
}

static void report_missed(FILE *to, const struct run *r)
{
  vg_report_missed_text(to, &r->layers, &r->problem.boundary.surface);
  vg_report_mesh_limits_text(to, &r->problem.asked, &r->mesh.judge);
}

static int report_success(struct run *r, const struct arguments *a)
{
  struct vg_mesh_limit limit[VG_MESH_LIMITS];
  int status = VG_EXIT_DONE;

  if (r->mesh.rank) return status;
  r->time.total = vg_display_now() - r->time.start;
  if (a->json) status = print_json(r, 1, NULL);
  else print_report(stdout, r);
  if (vg_log()) print_report(vg_log(), r);
  if (status != VG_EXIT_DONE) return status;
  if (!r->layers.n_missed &&
      !vg_mesh_limits_missed(&r->problem.asked, &r->mesh.judge, limit))
    return status;
  fflush(stdout);
  report_missed(stderr, r);
  if (vg_log()) report_missed(vg_log(), r);
  return VG_EXIT_LIMIT;
}

/* Open the log, on rank 0. */
static vg_status open_log(struct run *r, const struct arguments *a,
                          struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!a->log) return VG_OK;
  if (!r->mesh.rank) st = vg_log_open(a->log, err);
  if (st >= 0) vg_mesh_log_start(&r->mesh, a->argc, a->argv);
  return vg_comm_agree(r->mesh.comm, st, err);
}

static int close_log(const struct run *r, int status)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_log())
    fprintf(vg_log(), "\nexit status %d after %.2f s\n", status,
            vg_display_now() - r->time.start);
  return vg_log_close(&err) < 0 ? vg_cli_fail(&err) : status;
}

static int run(const struct arguments *a)
{
  struct run r = { .problem = VG_PROBLEM_INIT };
  struct vg_error err = VG_ERROR_INIT;
  int status;

  r.time.start = vg_display_now();
  if (vg_comm_open(&r.mesh.comm, &err) < 0) return vg_cli_fail(&err);
  if (a->run.node_ranks &&
      vg_comm_take_for_nodes(r.mesh.comm, (int)a->run.node_ranks, &err) < 0)
    return vg_cli_fail(&err);
  r.mesh.outputs = &r.outputs;
  r.mesh.rank = vg_comm_rank(r.mesh.comm);
  r.mesh.size = vg_comm_size(r.mesh.comm);
  if (open_log(&r, a, &err) < 0) {
    status = r.mesh.rank ? vg_cli_exit(&err) : vg_cli_fail(&err);
    vg_comm_close(r.mesh.comm);
    return status;
  }
  vg_display_init(&r.show, a->quiet || r.mesh.rank);
  if (a->every > 0) r.show.every = a->every;
  /* Rank 0 moves the files to their final names; the other ranks end when it
   * ends. */
  vg_display_deadline(r.mesh.rank ? 1.8 : 1.5);
  if (run_stages(&r, a, &err) < 0) {
    vg_display_clear(&r.show);
    status = report_failure(&r, a, &err);
  } else {
    vg_display_clear(&r.show);
    status = report_success(&r, a);
  }
  vg_run_release(&r.mesh, status == VG_EXIT_DONE || status == VG_EXIT_LIMIT);
  vg_outputs_release(&r.outputs);
  vg_layer_stage_release(&r.layers);
  vg_problem_release(&r.problem);
  vg_comm_close(r.mesh.comm);
  return close_log(&r, status);
}

static const struct argp_option own[] = {
  { "project", 'p', "PROJECT", 0,
    "Stem of the project files, or the full "
    "name of a surface file",
    VG_GROUP_COMMON },
  { "deck", 'd', "FILE", 0,
    "Run deck [default PROJECT.deck if it "
    "exists]",
    VG_GROUP_COMMON },
  { "out", 'o', "DIR", 0,
    "Folder for the results [default: that of the "
    "input]",
    VG_GROUP_COMMON },
  { "json", 'j', NULL, 0, "Write the report as JSON to standard output",
    VG_GROUP_OWN },
  { "quiet", 'q', NULL, 0, "Do not show progress", VG_GROUP_OWN },
  { "progress", KEY_PROGRESS, "SECONDS", 0,
    "Interval between progress lines if "
    "standard error is not a terminal [s, default 10]",
    VG_GROUP_OWN },
  { "timeline", KEY_TIMELINE, NULL, 0,
    "Write the trace of all workers to "
    "PROJECT.timeline.json, for 'vanguard plan' and 'vanguard sweep', and "
    "report the quality of cells near interfaces",
    VG_GROUP_OWN },
  { "log", KEY_LOG, "FILE", 0,
    "Also write all output to FILE, "
    "with versions, host, ranks, threads and settings",
    VG_GROUP_OWN },
  { "run-dir", KEY_RUN_DIR, "DIR", 0,
    "Store finished tasks in DIR, so that a "
    "run that is stopped or killed can be resumed; removed on success",
    VG_GROUP_OWN },
  { "resume", KEY_RESUME, NULL, 0,
    "Resume the run stored in --run-dir, "
    "on any number of ranks and threads",
    VG_GROUP_OWN },
  { "keep-run", KEY_KEEP, NULL, 0, "Keep --run-dir on success", VG_GROUP_OWN },
  { "run-limit", KEY_LIMIT, "BYTES", 0,
    "Largest total size of --run-dir, over all "
    "ranks [bytes, default 0: no limit]",
    VG_GROUP_OWN },
  { "shuffle-tasks", KEY_SHUFFLE, "SEED", 0,
    "Execute tasks in a random order; "
    "the files do not change (for tests) [default 0: heaviest first]",
    VG_GROUP_OWN },
  { "test-node-ranks", KEY_NODE_RANKS, "N", OPTION_HIDDEN,
    "Treat every N consecutive ranks as those of one node (for tests)",
    VG_GROUP_OWN },
  { "test-differ", KEY_DIFFER, "WHAT", OPTION_HIDDEN,
    "Let the last node report a different surface, layers or sizes (for "
    "tests)",
    VG_GROUP_OWN },
  { "test-fail-leaves", KEY_FAIL, "SHARE[,ROUNDS]", OPTION_HIDDEN,
    "Let this fraction of the leaves fail in the first ROUNDS attempts (for "
    "tests)",
    VG_GROUP_OWN },
  { NULL, 't', "N", 0, "Same as --threads", VG_GROUP_COMMON },
  { NULL, 'L', "N", 0, "Same as --bisections",
    VG_GROUP_TOPIC + VG_TOPIC_PARALLEL },
  { 0 }
};

int vg_cmd_mesh(int argc, char **argv)
{
  struct vg_cli_options options;
  struct vg_error err = VG_ERROR_INIT;
  struct argp argp = {
    .parser = option,
    .args_doc = "-p PROJECT",
    .doc =
      "Generate the volume mesh of a project: viscous layers on the walls "
      "that request them, and tetrahedra elsewhere.\v"
      "A project is a VGRID project (PROJECT.d3m with PROJECT.front, or with "
      "planar patches only) or a surface (UGRID, AFLR, STL, Cart3D, OBJ, "
      "Medit; STEP, IGES, BREP, EGADS) or a plane section (coordinates in "
      "a .dat, for a mesh in two dimensions), with boundary conditions in "
      "PROJECT.mapbc and settings in PROJECT.deck. "
      "The command writes PROJECT.cogsg, .bc, .mapbc and .b8.ugrid (see "
      "--write), .resolved.deck with all settings, and the report as "
      ".report.json and .report.html. A "
      "surface with defects is rejected, and its defective faces are written "
      "to PROJECT.defects.vtu. Layers "
      "grow on viscous walls (condition 4, class 2 of a .d3m, or --walls) if "
      "a first height is known (--first, or --y-plus with --reynolds and "
      "--reference-length); PROJECT.wall.vtu shows them. Under mpirun or srun "
      "all ranks generate one mesh; its files are byte-identical for "
      "any number of ranks and threads. Exit status: 0 "
      "success, 1 failure, 2 wrong usage, 4 finished, but a limit on the "
      "layers (--min-full, ...) is not met."
  };
  struct arguments a = { .argc = argc,
                         .argv = argv,
                         .run = { .change = VG_AGREE_NOTHING } };
  int status;

  if (vg_cli_options(own, &options, &err) < 0) return vg_cli_fail(&err);
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &a);
  status = run(&a);
  free(a.kept.set);
  vg_cli_options_free(&options);
  return status;
}
