/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard partition: partitions a volume mesh for the processes of a flow
 * solver. */
#define _GNU_SOURCE
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "core/mesh/zones.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/stream/metis_part.h"
#include "io/mesh/vtu.h"
#include "partition/solver/solver.h"
#include "run/common/progress.h"
#include "run/common/text.h"
#include "run/input/walls.h"
#include "run/report/report.h"
#include "run/stages/output.h"

enum { KEY_WEIGHTS = 500, KEY_ZONE_WEIGHTS, KEY_WHOLE_ZONES, KEY_WRITE };

struct arguments {
  struct vg_cli_one one;
  const char *out, *zone_weights, *whole_zones; /* NULL: not given */
  struct vg_solver_options options;
  struct vg_foam_options foam;
  int to_part, to_vtu, to_foam;
};

struct run {
  const struct arguments *a;
  char *path;  /* of the mesh */
  char *other; /* another mesh with the same stem, or NULL */
  struct vg_mesh mesh;
  struct vg_read_info info;
  size_t n_cell;
  struct vg_solver_layers layers;
  unsigned char *is_wall;
  double *zone_weight; /* [zones], or NULL; 0 until it is known */
  uint8_t *is_whole;   /* [zones], or NULL */
  uint32_t *part;
  struct vg_solver_report report;
  char *stem;
  struct vg_outputs outputs;
  struct vg_notes notes;
  double time_read, time_write;
};

/* --- options ------------------------------------------------------------- */

/* Parse "tet=1,pri=1.5"; cell types that are not listed have weight 1. */
static void read_weights(struct arguments *a, const char *list,
                         const struct argp_state *state)
{
  static const char *const kind[VG_SOLVER_KINDS] = { "tet", "pyr", "pri",
                                                     "hex" };

  for (const char *at = list; *at;) {
    int k = 0;
    char *end;

    while (k < VG_SOLVER_KINDS && (strncmp(at, kind[k], 3) || at[3] != '='))
      k++;
    if (k == VG_SOLVER_KINDS)
      argp_error(state,
                 "--weights %s: cell types are tet, pyr, pri and hex, as in "
                 "tet=1,pri=1.5",
                 list);
    a->options.weight[k] = strtod(at + 4, &end);
    if (end == at + 4 || (*end && *end != ',') ||
        !(a->options.weight[k] >= 1e-3 && a->options.weight[k] <= 1e3))
      argp_error(state,
                 "--weights %s: weights must be numbers from 0.001 to "
                 "1000",
                 list);
    at = *end ? end + 1 : end;
  }
}

static void read_forms(struct arguments *a, const char *list,
                       const struct argp_state *state)
{
  char copy[200], *rest = copy, *word;

  a->to_part = a->to_vtu = a->to_foam = 0;
  snprintf(copy, sizeof copy, "%s", list);
  while ((word = strsep(&rest, ",")))
    if (!strcmp(word, "part")) a->to_part = 1;
    else if (!strcmp(word, "vtu")) a->to_vtu = 1;
    else if (vg_foam_word(word, &a->foam)) a->to_foam = 1;
    else
      argp_error(state,
                 "--write %s: known formats are part, vtu, foam and "
                 "foam-ascii",
                 list);
}

static void read_count(struct arguments *a, const char *text,
                       const struct argp_state *state)
{
  char *end;
  unsigned long long n;

  errno = 0;
  n = strtoull(text, &end, 10);
  if (errno || end == text || *end || strchr(text, '-') || n < 1)
    argp_error(state, "-n %s: the number of partitions must be 1 or more",
               text);
  a->options.n_part = n;
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'n': read_count(a, arg, state); return 0;
  case 'o': a->out = arg; return 0;
  case KEY_WEIGHTS: read_weights(a, arg, state); return 0;
  case KEY_ZONE_WEIGHTS: a->zone_weights = arg; return 0;
  case KEY_WHOLE_ZONES: a->whole_zones = arg; return 0;
  case KEY_WRITE: read_forms(a, arg, state); return 0;
  default: break;
  }
  if (key == ARGP_KEY_END && a->one.file && !a->options.n_part)
    argp_error(state, "no number of partitions given; use -n N");
  return vg_cli_one(&a->one, "file", key, arg, state);
}

/* --- steps --------------------------------------------------------------- */

/* Add the mesh STEM.suffix, if it exists: the first one is partitioned. */
static vg_status try_mesh(struct run *r, const char *stem, size_t n,
                          const char *suffix, struct vg_error *err)
{
  char *path;

  if (asprintf(&path, "%.*s.%s", (int)n, stem, suffix) < 0)
    return vg_fail_memory(err, "a file name");
  if (r->other || access(path, F_OK) || !vg_format_holds_cells(path) ||
      (r->path && !strcmp(r->path, path)))
    free(path);
  else if (r->path) r->other = path;
  else r->path = path;
  return VG_OK;
}

/* A file, or the volume mesh of a project. A .cogsg comes first, since it
 * contains the number of layer tetrahedra. */
static vg_status find_mesh(struct run *r, struct vg_error *err)
{
  const char *name = r->a->one.file, *suffix;
  size_t n = strlen(name);
  vg_status st;

  if (vg_text_ends(name, ".d3m")) n -= 4;
  else if (!access(name, F_OK) || vg_format_suffix_length(name)) {
    r->path = strdup(name);
    return r->path ? VG_OK : vg_fail_memory(err, "a file name");
  }
  VG_TRY(try_mesh(r, name, n, "cogsg", err));
  for (size_t i = 0; (suffix = vg_format_input_suffix(i)); i++)
    VG_TRY(try_mesh(r, name, n, suffix, err));
  if (!r->path)
    st = vg_fail(
      err, VG_ERR_INPUT,
      "%s: there is no such file, and no volume mesh of a project: "
      "there is neither %.*s.cogsg nor %.*s.b8.ugrid; 'vanguard mesh "
      "-p %.*s' generates them",
      name, (int)n, name, (int)n, name, (int)n, name);
done:
  return st;
}

static vg_status read_mesh(struct run *r, struct vg_error *err)
{
  const char *path = r->path;
  struct vg_mesh *m = &r->mesh;
  double t = vg_display_now();
  vg_status st;

  VG_TRY(vg_mesh_read(path, m, &r->info, err));
  r->n_cell = vg_mesh_n_cell(m);
  if (!r->n_cell) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: this is a surface; only a volume mesh can be "
                 "partitioned",
                 path);
    goto done;
  }
  VG_TRY(
    vg_format_layer_tets(path, &r->layers.is_known, &r->layers.n_tet, err));
  r->is_wall = vg_calloc(m->n_patch, 1);
  r->part = vg_alloc(r->n_cell, sizeof *r->part);
  if (!r->is_wall || !r->part) {
    st = vg_fail_memory(err, "the partition of a mesh");
    goto done;
  }
  for (size_t k = 0; k < m->n_patch; k++)
    r->is_wall[k] = (unsigned char)vg_is_viscous(&m->patch[k]);
  r->layers.is_wall = r->is_wall;
  r->time_read = vg_display_now() - t;
done:
  return st;
}

static vg_status write_vtu(const struct run *r, const char *path,
                           struct vg_error *err)
{
  struct vg_vtu_field field[2] = {
    { VG_VTU_SOLVER_PART, VG_VTU_CELL, VG_VTU_INT32, 1, r->part },
    { VG_VTU_ZONE, VG_VTU_CELL, VG_VTU_INT32, 1, NULL }
  };
  int32_t *id = NULL;
  vg_status st;

  VG_TRY(vg_mesh_zone_numbers(&r->mesh, &id, err));
  field[1].data = id;
  st = vg_vtu_write(path, &r->mesh, field, id ? 2 : 1, err);
done:
  free(id);
  return st;
}

/* The zone with this name or number. */
static vg_status find_zone(const struct run *r, const char *option,
                           const char *item, size_t *zone, struct vg_error *err)
{
  const struct vg_mesh *m = &r->mesh;
  size_t z = 0;

  while (z < m->n_zone && strcmp(m->zone[z].name, item) != 0) z++;
  if (z == m->n_zone && *item && strspn(item, "0123456789") == strlen(item))
    for (z = 0; z < m->n_zone && m->zone[z].id != atoll(item);) z++;
  *zone = z;
  if (z < m->n_zone) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: %s has no zone '%s'; 'vanguard check' lists its zones",
                 option, r->path, item);
}

static vg_status refuse_repeated(const struct run *r, const char *option,
                                 size_t zone, struct vg_error *err)
{
  const struct vg_zone *z = &r->mesh.zone[zone];

  return vg_fail(err, VG_ERR_USAGE,
                 "%s: zone %d%s%s occurs twice; give it once", option,
                 (int)z->id, *z->name ? " " : "", z->name);
}

/* The weight of one item of the list, "pipe=0.2" or "2=0.2", which is changed.
 */
static vg_status read_zone_weight(struct run *r, char *item,
                                  struct vg_error *err)
{
  char *value = strrchr(item, '='), *end;
  double weight;
  size_t z;
  vg_status st;

  if (!value || value == item)
    return vg_fail(err, VG_ERR_USAGE,
                   "--zone-weights %s: items are zones with weights, as in "
                   "rotor=1.5,2=0.3",
                   item);
  *value++ = 0;
  weight = strtod(value, &end);
  if (end == value || *end || !(weight >= 1e-3 && weight <= 1e3))
    return vg_fail(err, VG_ERR_USAGE,
                   "--zone-weights: the weight of zone %s must be a number "
                   "from 0.001 to 1000, not '%s'",
                   item, value);
  VG_TRY(find_zone(r, "--zone-weights", item, &z, err));
  if (r->zone_weight[z] > 0) st = refuse_repeated(r, "--zone-weights", z, err);
  else r->zone_weight[z] = weight;
done:
  return st;
}

/* One item of the list of zones that stay whole. */
static vg_status read_whole_zone(struct run *r, char *item,
                                 struct vg_error *err)
{
  size_t z;
  vg_status st;

  VG_TRY(find_zone(r, "--whole-zones", item, &z, err));
  if (r->is_whole[z]) st = refuse_repeated(r, "--whole-zones", z, err);
  else r->is_whole[z] = 1;
done:
  return st;
}

static vg_status read_items(struct run *r, const char *text,
                            vg_status (*take)(struct run *r, char *item,
                                              struct vg_error *err),
                            struct vg_error *err)
{
  char *list = strdup(text), *rest = list, *item;
  vg_status st = list ? VG_OK : vg_fail_memory(err, "a list of zones");

  while (st >= 0 && (item = strsep(&rest, ","))) st = take(r, item, err);
  free(list);
  return st;
}

/* Zones that are not listed have weight 1, and may be divided. */
static vg_status read_zone_lists(struct run *r, struct vg_error *err)
{
  const struct arguments *a = r->a;
  const size_t n = r->mesh.n_zone;
  vg_status st = VG_OK;

  if (a->zone_weights) r->zone_weight = vg_calloc(n, sizeof *r->zone_weight);
  if (a->whole_zones) r->is_whole = vg_calloc(n, 1);
  if ((a->zone_weights && !r->zone_weight) || (a->whole_zones && !r->is_whole))
    return vg_fail_memory(err, "the zones");
  if (a->zone_weights)
    VG_TRY(read_items(r, a->zone_weights, read_zone_weight, err));
  if (a->whole_zones)
    VG_TRY(read_items(r, a->whole_zones, read_whole_zone, err));
  for (size_t z = 0; z < n && r->zone_weight; z++)
    if (!(r->zone_weight[z] > 0)) r->zone_weight[z] = 1;
done:
  return st;
}

/* A list of parts has the order of the cells of the file. */
static vg_status check_order(const struct run *r, struct vg_error *err)
{
  if (!r->a->to_part || !r->mesh.is_resorted) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the cells of its zones are not together, so that a list "
                 "of parts would have another order; convert the mesh with "
                 "'vanguard convert' and partition the result",
                 r->path);
}

static vg_status write_foam(const struct run *r, const char *path,
                            struct vg_error *err)
{
  vg_status st = vg_foam_write(path, &r->mesh, &r->a->foam, err);

  return st < 0
         ? st
         : vg_foam_write_parts(path, r->n_cell, r->part, r->report.n_part, err);
}

typedef vg_status writer(const struct run *r, const char *path,
                         struct vg_error *err);

static vg_status write_part(const struct run *r, const char *path,
                            struct vg_error *err)
{
  return vg_metis_part_write(path, r->n_cell, r->part, err);
}

static vg_status write_file(struct run *r, const char *suffix, writer *write,
                            struct vg_error *err)
{
  char *path = vg_outputs_temp_path(&r->outputs, suffix);
  vg_status st = path ? vg_outputs_add(&r->outputs, suffix, err)
                      : vg_fail_memory(err, "a file name");

  if (st >= 0) st = vg_outputs_failed(&r->outputs, write(r, path, err), err);
  free(path);
  return st;
}

static vg_status write_files(struct run *r, struct vg_display *show,
                             struct vg_error *err)
{
  const struct arguments *a = r->a;
  char suffix[40];
  double t = vg_display_now();
  vg_status st;

  snprintf(suffix, sizeof suffix, "part.%llu",
           (unsigned long long)a->options.n_part);
  VG_TRY(vg_outputs_begin(&r->outputs, NULL, err));
  if (a->to_part) VG_TRY(write_file(r, suffix, write_part, err));
  if (a->to_vtu) {
    VG_TRY(write_file(r, "vtu", write_vtu, err));
    st = vg_outputs_sheets(&r->outputs, &r->mesh, r->mesh.n_point, r->n_cell,
                           &r->notes, err);
    VG_TRY(vg_outputs_failed(&r->outputs, st, err));
  }
  if (a->to_foam) {
    VG_TRY(write_file(r, VG_FOAM_SUFFIX, write_foam, err));
    r->outputs.file[r->outputs.n_file - 1].is_case = 1;
  }
  VG_TRY(vg_display_stopped(show, err));
  vg_display_commit();
  st = vg_outputs_commit(&r->outputs, err);
  r->time_write = vg_display_now() - t;
done:
  return st;
}

static vg_status run_all(struct run *r, struct vg_display *show,
                         struct vg_error *err)
{
  struct vg_solver_options options = r->a->options;
  const char *path;
  size_t n;
  vg_status st;

  VG_TRY(find_mesh(r, err));
  path = r->path;
  n = strlen(path) - vg_format_suffix_length(path);
  r->stem = r->a->out ? strdup(r->a->out) : strndup(path, n);
  if (!r->stem) return vg_fail_memory(err, "a file name");
  VG_TRY(vg_outputs_place(r->stem, NULL, &r->outputs, err));
  VG_TRY(vg_outputs_claim(&r->outputs, &r->notes, err));
  vg_display_update(show, "read", 0, 0);
  VG_TRY(read_mesh(r, err));
  VG_TRY(check_order(r, err));
  VG_TRY(read_zone_lists(r, err));
  options.zone_weight = r->zone_weight;
  options.is_whole = r->is_whole;
  vg_display_update(show, "partition", r->n_cell, 0);
  VG_TRY(vg_solver_part(&r->mesh, &r->layers, &options, path, r->part,
                        &r->report, err));
  vg_display_update(show, "write", r->n_cell, 0);
  st = write_files(r, show, err);
done:
  return st;
}

/* --- report -------------------------------------------------------------- */

static void print_json(const struct run *r)
{
  json_t *files = json_array(), *o;

  for (size_t i = 0; i < r->outputs.n_file; i++) {
    char *file = vg_outputs_final(&r->outputs, r->outputs.file[i].suffix);

    json_array_append_new(files, vg_text_json(file ? file : ""));
    free(file);
  }
  o = json_pack("{s:o s:I s:o s:f s:f s:f s:o}", "file", vg_text_json(r->path),
                "inner_faces",
                (json_int_t)(r->info.inner.n_face + r->info.inner.n_sheet_face),
                "solver_parts", vg_report_solver_json(&r->report),
                "seconds_read", r->time_read, "seconds_write", r->time_write,
                "peak_memory_bytes", vg_report_peak_memory(), "files", files);
  json_dumpf(o, stdout, JSON_INDENT(2));
  printf("\n");
  json_decref(o);
}

static void print_text(const struct run *r)
{
  printf("%s: solver partition\n", r->path);
  if (r->other)
    printf("  note: %s is also a volume mesh; its complete name selects it\n",
           r->other);
  vg_report_size_text(stdout, &r->mesh);
  if (r->info.inner.n_sheet_face)
    printf("  note: " VG_SHEET_FACES_NOTE "\n", r->path,
           r->info.inner.n_sheet_face);
  if (r->info.inner.n_face)
    printf("  note: " VG_INNER_FACES_NOTE "\n", r->path, r->info.inner.n_face,
           r->info.inner.patches);
  vg_report_solver_text(stdout, &r->report);
  printf("  time (s): read %.2f, write %.2f; peak memory %.0f MB\n",
         r->time_read, r->time_write, vg_report_peak_memory() / 1e6);
  for (size_t i = 0; i < r->notes.n; i++)
    printf("  note: %s\n", r->notes.text[i]);
  for (size_t i = 0; i < r->outputs.n_file; i++) {
    char *file = vg_outputs_final(&r->outputs, r->outputs.file[i].suffix);

    printf("  %s\n", file ? file : "");
    free(file);
  }
}

static void release(struct run *r)
{
  vg_mesh_release(&r->mesh);
  free(r->path);
  free(r->other);
  free(r->is_wall);
  free(r->zone_weight);
  free(r->is_whole);
  free(r->part);
  free(r->stem);
  vg_outputs_release(&r->outputs);
  vg_notes_release(&r->notes);
}

int vg_cmd_partition(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "project", 'p', "PROJECT", 0,
      "Same as MESH: a file, or the stem of a project with one", 0 },
    { "parts", 'n', "N", 0, "Number of partitions", 0 },
    { "out", 'o', "STEM", 0,
      "Stem of the names of the output files [default: that "
      "of MESH]",
      0 },
    { "write", KEY_WRITE, "LIST", 0,
      "Output: part (STEM.part.N, one line with the partition number of each "
      "cell, as METIS writes it), vtu (STEM.vtu with the cell "
      "array solver_part), foam or foam-ascii (the case STEM.openfoam with "
      "constant/cellDecomposition) [default part]",
      0 },
    { "weights", KEY_WEIGHTS, "LIST", 0,
      "Work per cell by cell type, as in "
      "tet=1,pyr=1.2,pri=1.5,hex=2 [default 1 for all]",
      0 },
    { "zone-weights", KEY_ZONE_WEIGHTS, "LIST", 0,
      "Factors on the work of the cells of zones, by name or number, as in "
      "rotor=1.5,2=0.3 [default 1 for all]",
      0 },
    { "whole-zones", KEY_WHOLE_ZONES, "LIST", 0,
      "Zones of which each is in a single partition, by name or number", 0 },
    { "json", 'j', NULL, 0, "Write the report as JSON to standard output", 0 },
    { "quiet", 'q', NULL, 0, "Do not show progress", 0 },
    { 0 }
  };
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "MESH",
    .doc =
      "Partition the cells of MESH for N processes of a flow solver: equal "
      "work, few faces between partitions, and no stack of layer cells is "
      "cut.\vStacks are recognised for prisms, for hexahedra on viscous "
      "walls, and for Vanguard's layer tetrahedra if the file contains their "
      "number (.cogsg, and .ugrid written with --ugrid-tail). OpenFOAM reads "
      "the partition by decomposePar with the method manual; the case "
      "contains the decomposeParDict for it. 'vanguard mesh --solver-parts N' "
      "partitions the mesh that it generates in the same way."
  };
  struct arguments a = { .options = VG_SOLVER_OPTIONS_INIT, .to_part = 1 };
  struct run r = { .a = &a };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_cli_parse(&argp, argc, argv, &a);
  vg_display_init(&show, a.one.quiet);
  vg_display_deadline(VG_DISPLAY_SOON_S);
  st = run_all(&r, &show, &err);
  vg_display_clear(&show);
  if (st >= 0) {
    if (a.one.json) print_json(&r);
    else print_text(&r);
  }
  release(&r);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
