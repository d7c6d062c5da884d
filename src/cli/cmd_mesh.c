/* vanguard mesh: a project in, a volume mesh out. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/cli.h"
#include "cli/layers.h"
#include "cli/output.h"
#include "cli/report.h"
#include "io/stream.h"

struct arguments {
  const char *project, *deck, *dir;
  int json, quiet;
  /* Settings wait until the deck has been read, which they win over. */
  size_t n_set, cap_set;
  struct { int key; const char *text; } *set;
};

struct run {
  struct vg_problem problem;
  struct vg_outputs outputs;
  struct vg_display show;
  struct vg_layer_stage layers;
  struct vg_mesh mesh;
  size_t n_field_cell;
  struct vg_fill_report fill;
  struct vg_mesh_report judge, field; /* all cells; with layers: the field's */
  double start, time_read, time_check, time_size, time_judge, time_write;
};

/* A value that cannot be is wrong usage, known before anything is read. */
static error_t keep_setting(struct arguments *a, int key, const char *text,
                            const struct argp_state *state)
{
  struct vg_settings scratch;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_settings_default(&scratch);
  st = vg_cli_option_set(key, text, &scratch, &err);
  vg_settings_release(&scratch);
  if (st == VG_BLOCKED) return ARGP_ERR_UNKNOWN;
  if (st < 0) argp_error(state, "%s", err.text);
  if (vg_reserve(&a->set, &a->cap_set, a->n_set + 1, sizeof *a->set))
    return ENOMEM;
  a->set[a->n_set].key = key;
  a->set[a->n_set++].text = text;
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
  case ARGP_KEY_ARG:
    if (a->project) argp_error(state, "one project at a time: %s", arg);
    a->project = arg;
    return 0;
  case ARGP_KEY_END:
    if (!a->project)
      argp_error(state, "which project? give -p PROJECT");
    return 0;
  default:
    break;
  }
  if (key < VG_KEY_SETTING) return ARGP_ERR_UNKNOWN;
  return keep_setting(a, key, arg, state);
}

static vg_status apply_options(const struct arguments *a,
                               struct vg_settings *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < a->n_set && st >= 0; i++)
    st = vg_cli_option_set(a->set[i].key, a->set[i].text, s, err);
  return st < 0 ? st : vg_settings_check(s, err);
}

static vg_status stopped(const struct run *r, struct vg_error *err)
{
  (void)r;
  if (!vg_display_interrupted()) return VG_OK;
  return vg_fail(err, VG_ERR_IO, "interrupted; nothing was written");
}

/* Stages up to a closed surface. */
static vg_status read_project(struct run *r, const struct arguments *a,
                              struct vg_error *err)
{
  struct vg_problem *p = &r->problem;
  double t = vg_display_now();
  vg_status st;

  vg_display_update(&r->show, "read", 0, 0);
  VG_TRY(vg_input_find(a->project, a->deck, &p->files, err));
  VG_TRY(vg_problem_deck(p, err));
  VG_TRY(apply_options(a, &p->settings, err));
  vg_settings_write(&p->settings);
  VG_TRY(vg_outputs_plan(p, a->dir, &r->outputs, err));
  VG_TRY(vg_problem_surface(p, err));
  r->time_read = vg_display_now() - t;
  VG_TRY(stopped(r, err));
  t = vg_display_now();
  VG_TRY(vg_problem_close(p, &r->show, err));
  VG_TRY(vg_layer_stage_plan(&r->layers, p, err));
  vg_problem_note_unset(p);
  VG_TRY(vg_walls_swap(p, r->layers.is_on ? r->layers.reason : NULL, err));
  r->time_check = vg_display_now() - t;
  VG_TRY(vg_outputs_check(p, &r->outputs, err));
  VG_TRY(stopped(r, err));
done:
  return st;
}

/* The size field over a boundary. */
static vg_status measure_sizes(struct run *r, const struct vg_mesh *boundary,
                               struct vg_sizing **sizing, struct vg_error *err)
{
  const struct vg_settings *s = &r->problem.settings;
  struct vg_sizing_options options = vg_settings_sizing(s);
  double t = vg_display_now();
  vg_status st;

  vg_display_update(&r->show, "sizes", 0, 0);
  st = vg_sizing_new(&options, s->n_source, s->source, boundary, sizing, err);
  r->time_size += vg_display_now() - t;
  return st < 0 ? st : stopped(r, err);
}

static vg_status fill(struct run *r, const struct vg_mesh *boundary,
                      const struct vg_sizing *sizing, struct vg_mesh *out,
                      struct vg_error *err)
{
  const struct vg_settings *s = &r->problem.settings;
  struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  vg_status st;

  o.optimise = (int)s->optimise;
  o.max_cells = (uint64_t)s->max_cells;
  o.progress = vg_display_update;
  o.user = &r->show;
  st = vg_fill(boundary, sizing, &o, out, &r->fill, err);
  r->n_field_cell = out->n_tet;
  if (st == VG_BLOCKED)
    st = vg_fail(err, VG_ERR_IO, "interrupted; nothing was written");
  return st;
}

static size_t cell_count(const struct vg_mesh *m)
{
  return m->n_tet + m->n_pyr + m->n_pri + m->n_hex;
}

static vg_status judge(struct run *r, const struct vg_mesh *m,
                       const struct vg_sizing *sizing,
                       struct vg_mesh_report *report, struct vg_error *err)
{
  double t = vg_display_now();
  char faults[300];
  vg_status st;

  vg_display_update(&r->show, "judge", cell_count(m), 0);
  st = vg_mesh_judge(m, sizing, report, err);
  r->time_judge += vg_display_now() - t;
  if (st < 0) return st;
  if (report->is_valid) return stopped(r, err);
  vg_report_faults(report, faults, sizeof faults);
  return vg_fail(err, VG_ERR_GEOMETRY, "the mesh did not pass its own check "
                 "(%s) and was not written; please report this with the "
                 "project files", faults);
}

static vg_status mesh_plain(struct run *r, struct vg_error *err)
{
  const struct vg_mesh *surface = &r->problem.surface;
  struct vg_sizing *sizing = NULL;
  vg_status st;

  VG_TRY(measure_sizes(r, surface, &sizing, err));
  VG_TRY(fill(r, surface, sizing, &r->mesh, err));
  VG_TRY(judge(r, &r->mesh, sizing, &r->judge, err));
done:
  vg_sizing_free(sizing);
  return st;
}

/* The second size field is that of the front, so that the fill fits the tops
 * of the layers. Edges are held against it; within layers there is no
 * isotropic size to meet. */
static vg_status mesh_layers(struct run *r, struct vg_error *err)
{
  const struct vg_mesh *surface = &r->problem.surface;
  const struct vg_mesh *front = &r->layers.layers.front.mesh;
  struct vg_mesh field = VG_MESH_INIT, view = VG_MESH_INIT;
  struct vg_sizing *sizing = NULL;
  vg_status st;

  VG_TRY(vg_layer_stage_sizes(&r->layers, &r->problem, &view, err));
  VG_TRY(measure_sizes(r, &view, &sizing, err));
  VG_TRY(vg_layer_stage_grow(&r->layers, surface, sizing, &r->show, err));
  VG_TRY(stopped(r, err));
  vg_sizing_free(sizing);
  sizing = NULL;
  VG_TRY(measure_sizes(r, front, &sizing, err));
  VG_TRY(fill(r, front, sizing, &field, err));
  VG_TRY(judge(r, &field, sizing, &r->field, err));
  vg_display_update(&r->show, "join", 0, 0);
  VG_TRY(vg_layer_stage_join(&r->layers, surface, &field,
                             r->problem.settings.cells, &r->mesh, err));
  vg_mesh_release(&field);
  VG_TRY(judge(r, &r->mesh, NULL, &r->judge, err));
done:
  free(view.tri);
  free(view.tri_patch);
  vg_mesh_release(&field);
  vg_sizing_free(sizing);
  return st;
}

static json_t *strings(const struct vg_notes *notes)
{
  json_t *list = json_array();

  for (size_t i = 0; i < notes->n; i++)
    json_array_append_new(list, vg_report_string(notes->text[i]));
  return list;
}

static json_t *files_json(const struct run *r)
{
  json_t *list = json_array();

  for (size_t i = 0; i < r->outputs.n_file; i++) {
    char *path = vg_outputs_final(&r->outputs, r->outputs.file[i].suffix);

    if (path) json_array_append_new(list, vg_report_string(path));
    free(path);
  }
  return list;
}

static json_t *report_json(const struct run *r, int ok,
                           const struct vg_error *err)
{
  const struct vg_problem *p = &r->problem;
  json_t *o = json_object();

  json_object_set_new(o, "vanguard", json_string(VG_VERSION));
  json_object_set_new(o, "title", vg_report_string(p->settings.title));
  json_object_set_new(o, "ok", json_boolean(ok));
  if (!ok) json_object_set_new(o, "error", vg_report_string(err->text));
  json_object_set_new(o, "input", vg_report_size_json(&p->surface));
  json_object_set_new(o, "patches", vg_report_patches_json(&p->surface));
  json_object_set_new(o, "surface", vg_report_surface_json(&p->surface,
                      &p->check, VG_SHOWN_DEFECTS));
  json_object_set_new(o, "domain", vg_report_domain_json(&p->domain));
  json_object_set_new(o, "notes", strings(&p->notes));
  if (ok) {
    json_object_set_new(o, "mesh", vg_report_mesh_json(&r->judge));
    json_object_set_new(o, "fill", vg_report_fill_json(&r->fill,
                                                       r->n_field_cell));
    if (r->layers.is_on) {
      json_object_set_new(o, "field", vg_report_mesh_json(&r->field));
      json_object_set_new(o, "layers",
                          vg_report_layers_json(&r->layers, &p->surface));
    }
    json_object_set_new(o, "files", files_json(r));
  }
  json_object_set_new(o, "seconds", json_pack(
    "{s:f s:f s:f s:f s:f s:f s:f s:f s:f}",
    "read", r->time_read, "check", r->time_check, "sizes", r->time_size,
    "layers", r->layers.report.time_total + r->layers.time_measure, "join",
    r->layers.join.time, "fill", r->fill.time_total,
    "judge", r->time_judge, "write", r->time_write,
    "total", vg_display_now() - r->start));
  json_object_set_new(o, "peak_memory_bytes",
                      json_real(vg_report_peak_memory()));
  return o;
}

static vg_status write_json(const char *path, const json_t *o,
                            struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *text = json_dumps(o, JSON_INDENT(2));
  vg_status st;

  if (!text) return vg_fail_memory(err, "the report");
  st = vg_output_open(path, &out, err);
  if (st >= 0) {
    vg_output_text(&out, text);
    vg_output_text(&out, "\n");
    st = vg_output_commit(&out, err);
  }
  vg_output_release(&out);
  free(text);
  return st;
}

static vg_status write_all(struct run *r, struct vg_error *err)
{
  double t = vg_display_now();
  char *path = NULL;
  json_t *report = NULL;
  vg_status st;

  vg_display_update(&r->show, "write", cell_count(&r->mesh), 0);
  VG_TRY(vg_outputs_mesh(&r->outputs, &r->problem, &r->layers, &r->mesh,
                         err));
  r->time_write = vg_display_now() - t;
  VG_TRY(vg_outputs_add(&r->outputs, "report.json", err));
  path = vg_outputs_aside(&r->outputs, "report.json");
  report = report_json(r, 1, NULL);
  st = path && report ? write_json(path, report, err)
                      : vg_fail_memory(err, "the report");
  if (st < 0) goto done;
  VG_TRY(stopped(r, err));
  VG_TRY(vg_outputs_commit(&r->outputs, err));
done:
  json_decref(report);
  free(path);
  return st;
}

static void print_surface(const struct run *r)
{
  const struct vg_problem *p = &r->problem;

  printf("%s\n\nSurface\n", p->settings.title);
  vg_report_size_text(stdout, &p->surface);
  if (p->n_welded || p->n_dropped)
    printf("  welded: %zu points merged, %zu triangles dropped\n",
           p->n_welded, p->n_dropped);
  vg_report_domain_text(stdout, &p->domain);
  vg_report_surface_text(stdout, &p->surface, &p->check, VG_SHOWN_DEFECTS);
  for (size_t i = 0; i < p->notes.n; i++)
    printf("  note: %s\n", p->notes.text[i]);
}

static void print_count(const char *name, size_t n)
{
  char count[32];

  printf("  %-24s %15s\n", name, vg_cli_count(n, count));
}

static void print_times(const struct run *r)
{
  printf("\nTime in seconds: read %.2f, check %.2f, sizes %.2f, ",
         r->time_read, r->time_check, r->time_size);
  if (r->layers.is_on)
    printf("layers %.2f, ", r->layers.report.time_total +
           r->layers.time_measure + r->layers.join.time);
  printf("fill %.2f, judge %.2f, write %.2f, total %.2f\n",
         r->fill.time_total, r->time_judge, r->time_write,
         vg_display_now() - r->start);
  printf("Peak memory: %.0f MB\n", vg_report_peak_memory() / 1e6);
}

static void print_files(const struct run *r)
{
  printf("\nFiles\n");
  for (size_t i = 0; i < r->outputs.n_file; i++) {
    char *path = vg_outputs_final(&r->outputs, r->outputs.file[i].suffix);

    printf("  %s%s\n", path ? path : "",
           r->outputs.file[i].keep_old ? "  (input, kept)" : "");
    free(path);
  }
}

static void print_report(const struct run *r)
{
  print_surface(r);
  if (r->layers.is_on) {
    printf("\nLayers\n");
    vg_report_layers_text(stdout, &r->layers, &r->problem.surface);
  }
  printf("\nFill\n");
  vg_report_fill_text(stdout, &r->fill, r->n_field_cell);
  if (r->layers.is_on) {
    printf("\nField outside the layers\n");
    print_count("tetrahedra", r->n_field_cell);
    vg_report_mesh_text(stdout, &r->field, 0);
  }
  printf("\nMesh\n");
  print_count("points", r->mesh.n_point);
  print_count("tetrahedra", r->mesh.n_tet);
  if (r->mesh.n_pyr) print_count("pyramids", r->mesh.n_pyr);
  if (r->mesh.n_pri) print_count("prisms", r->mesh.n_pri);
  if (r->layers.is_on) vg_report_whole_text(stdout, &r->judge);
  else vg_report_mesh_text(stdout, &r->judge, 0);
  print_times(r);
  print_files(r);
}

/* All faces with a defect go into STEM.defects.vtu. */
static void show_defects(struct run *r, const struct arguments *a)
{
  struct vg_error err = VG_ERROR_INIT;
  char *path;

  if (!r->problem.check.n_defect || !r->outputs.dir) return;
  if (!a->json) print_surface(r);
  path = vg_outputs_final(&r->outputs, "defects.vtu");
  if (!path) return;
  if (vg_write_defects(path, &r->problem.surface, &r->problem.check,
                       &err) < 0)
    vg_cli_fail(&err);
  else if (!a->json)
    printf("  all faces with a defect: %s\n", path);
  free(path);
}

static int print_json(const struct run *r, int ok, const struct vg_error *err)
{
  json_t *o = report_json(r, ok, err);
  int bad = !o || json_dumpf(o, stdout, JSON_INDENT(2));

  printf("\n");
  json_decref(o);
  return bad || fflush(stdout) ? VG_EXIT_FAILED : VG_EXIT_DONE;
}

static vg_status run_stages(struct run *r, const struct arguments *a,
                            struct vg_error *err)
{
  vg_status st = read_project(r, a, err);

  if (st >= 0)
    st = r->layers.is_on ? mesh_layers(r, err) : mesh_plain(r, err);
  return st < 0 ? st : write_all(r, err);
}

static int run(const struct arguments *a)
{
  struct run r = { .problem = VG_PROBLEM_INIT };
  struct vg_error err = VG_ERROR_INIT;
  int status = VG_EXIT_DONE;

  r.start = vg_display_now();
  vg_display_init(&r.show, a->quiet);
  if (run_stages(&r, a, &err) < 0) {
    vg_display_clear(&r.show);
    show_defects(&r, a);
    if (a->json) print_json(&r, 0, &err);
    status = vg_cli_fail(&err);
  } else {
    vg_display_clear(&r.show);
    if (a->json) status = print_json(&r, 1, &err);
    else print_report(&r);
    if (r.layers.n_missed && status == VG_EXIT_DONE) {
      fflush(stdout);
      vg_report_missed_text(stderr, &r.layers, &r.problem.surface);
      status = VG_EXIT_LIMIT;
    }
  }
  vg_outputs_release(&r.outputs);
  vg_layer_stage_release(&r.layers);
  vg_mesh_release(&r.mesh);
  vg_problem_release(&r.problem);
  return status;
}

int vg_cmd_mesh(int argc, char **argv)
{
  const struct argp_option own[] = {
    { "project", 'p', "PROJECT", 0, "stem of the project files, or the full "
      "name of a surface file", 1 },
    { "deck", 'd', "FILE", 0, "run deck [default PROJECT.deck if there is "
      "one]", 1 },
    { "out", 'o', "DIR", 0, "folder for the results [default beside the "
      "input]", 1 },
    { "json", 'j', NULL, 0, "report as JSON on standard output", 1 },
    { "quiet", 'q', NULL, 0, "no progress", 1 },
    { 0 }
  };
  struct vg_cli_options options;
  struct argp argp = { .parser = option, .args_doc = "-p PROJECT",
    .doc = "Mesh the volume of a project: viscous layers on its walls "
      "where they are asked for, tetrahedra in the rest.\v"
      "A project is a VGRID project (PROJECT.d3m with PROJECT.front, or "
      "planar patches alone) or a surface (UGRID, STL, Cart3D, OBJ, Medit), "
      "with conditions in PROJECT.mapbc and settings in PROJECT.deck. Written "
      "are PROJECT.cogsg, .bc, .mapbc and .b8.ugrid, PROJECT.resolved.deck "
      "with all settings, and PROJECT.report.json; a surface with defects is "
      "refused and its bad faces are put into PROJECT.defects.vtu. Layers "
      "grow on viscous walls (condition 4, class 2 of a .d3m, --walls) once "
      "a first height is known (--first, or --y-plus with --reynolds and "
      "--reference-length); PROJECT.wall.vtu shows them. Exit status: 0 "
      "done, 1 failed, 2 wrong usage, 4 done but a limit on the layers "
      "(--min-full, ...) is not met." };
  struct arguments a = { 0 };
  int status;

  if (vg_cli_options(own, &options) < 0) return VG_EXIT_FAILED;
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &a);
  status = run(&a);
  free(a.set);
  vg_cli_options_free(&options);
  return status;
}
