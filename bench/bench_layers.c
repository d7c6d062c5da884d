/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The program of bench/layers.sh: cost of viscous layers, phase by phase.
 *
 * vg_bench_layers [OPTION...] --demo NAME --cells N
 * vg_bench_layers [OPTION...] SURFACE
 *   --name NAME     name of the case in the rows (default: that of the input)
 *   --walls LIST    patches with layers, as in 3-12,15 (default: condition 4,
 *                   or all if no patch has a condition)
 *   --domain yes    SURFACE bounds the fluid by itself (default: a body)
 *   --length L --reynolds R   y+ 1 (default 0.7 and 5e6)
 *   --rate1 A --rate2 B --cap C   the growth law (default 0.2, 0, 1.3)
 *   --threads N     (default 1)
 *   --runs N        runs of everything (default 3); medians are shown
 *   --fill no       without the cells outside the layers: only layers are
 *                   joined and written
 *   --out FILE      write the mesh here each time; the suffix gives the format,
 *                   and the file is removed at the end
 * Prints a row "grow | ..." and two rows "join | ..." for the tables of
 * bench/layers.sh. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/examples/demo.h"
#include "core/fill/fill.h"
#include "core/surface/surface_check.h"
#include "io/mesh/format.h"
#include "layers/expand/join.h"
#include "layers/grow/grow.h"

#define RUNS_MAX 99

struct options {
  const char *name, *demo, *surface, *walls, *out;
  double length, reynolds;
  struct vg_growth_law law;
  size_t n_cell;
  int domain, fill, threads, runs;
};

struct clocks {
  double wall, cpu;
}; /* cpu: user and system */

/* Results of one run; [0] tetrahedra, [1] mixed. */
struct figures {
  struct vg_layer_report grow;
  struct clocks grown, joined[2], written[2];
  struct vg_join_info join[2];
  size_t n_cell[2], n_byte[2];
};

struct bench {
  struct options o;
  struct vg_mesh surface;
  struct vg_sizing_options sizing;
  size_t n_source;
  const struct vg_source *source;
  struct vg_layer_request *request;
  struct figures run[RUNS_MAX];
};

static double read_clock(clockid_t id)
{
  struct timespec t;

  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct clocks now(void)
{
  return (struct clocks){ read_clock(CLOCK_MONOTONIC),
                          read_clock(CLOCK_PROCESS_CPUTIME_ID) };
}

static struct clocks since(struct clocks start)
{
  struct clocks end = now();

  return (struct clocks){ end.wall - start.wall, end.cpu - start.cpu };
}

/* 1 if id is in a list such as "3-12,15". */
static int in_list(const char *list, long id)
{
  while (*list) {
    char *end;
    long a = strtol(list, &end, 10), b = a;

    if (end == list) return 0;
    if (*end == '-') b = strtol(end + 1, &end, 10);
    if (id >= a && id <= b) return 1;
    list = *end == ',' ? end + 1 : end;
  }
  return 0;
}

static int is_wall(const struct bench *b, size_t p, int any_bc)
{
  const struct vg_patch *patch = &b->surface.patch[p];

  if (b->o.walls) return in_list(b->o.walls, patch->id);
  return !any_bc || patch->bc == 4;
}

static int make_requests(struct bench *b)
{
  int any_bc = 0, n = 0;

  b->request = calloc(b->surface.n_patch, sizeof *b->request);
  if (!b->request) return -1;
  for (size_t p = 0; p < b->surface.n_patch; p++)
    any_bc |= b->surface.patch[p].bc != VG_BC_NONE;
  for (size_t p = 0; p < b->surface.n_patch; p++) {
    struct vg_layer_request *r = &b->request[p];

    r->law = b->o.law;
    r->law.delta1 = vg_first_height(1, b->o.reynolds, b->o.length);
    n += r->is_wall = is_wall(b, p, any_bc);
  }
  if (!n) fprintf(stderr, "%s: no walls\n", b->o.name);
  return n ? 0 : -1;
}

static vg_status read_surface(struct bench *b, struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  vg_status st = vg_surface_read(b->o.surface, &b->surface, NULL, err);

  if (st < 0) return st;
  o.external = !b->o.domain;
  st = vg_surface_check(&b->surface, &o, &r, err);
  if (st >= 0 && r.n_defect)
    st = vg_fail(err, VG_ERR_GEOMETRY, "%s has %zu defects", b->o.surface,
                 r.n_defect);
  vg_surface_report_release(&r);
  return st;
}

/* Boundary and points of the front, with the new points and the cells. */
static vg_status fill(const struct vg_mesh *surface,
                      const struct vg_sizing *sizing, struct vg_mesh *field,
                      struct vg_error *err)
{
  const struct vg_front front = vg_front_of(surface);
  const struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report r = { 0 };
  struct vg_filled made = VG_FILLED_INIT;
  size_t cap = surface->n_point;
  vg_status st = vg_mesh_copy(field, surface, err);

  if (st >= 0) st = vg_fill_front(&front, NULL, sizing, &o, &made, &r, err);
  if (st >= 0 &&
      vg_reserve(&field->point, &cap, cap + made.n_point, sizeof *field->point))
    st = vg_fail_memory(err, "the field");
  if (st >= 0) {
    memcpy(field->point + field->n_point, made.x,
           made.n_point * sizeof *made.x);
    field->n_point += made.n_point;
    free(field->tet);
    field->tet = made.cell;
    field->n_tet = made.n_cell;
    made.cell = NULL;
  }
  vg_filled_release(&made);
  return st;
}

/* A mesh of the front without cells, to which only layers are joined. */
static vg_status make_field(const struct bench *b,
                            const struct vg_layers *layers,
                            struct vg_mesh *field, struct vg_error *err)
{
  const struct vg_mesh front = vg_front_mesh(&layers->front, &b->surface);
  struct vg_sizing *sizing = NULL;
  vg_status st;

  if (!b->o.fill) return vg_mesh_copy(field, &front, err);
  st = vg_sizing_new(&b->sizing, b->n_source, b->source, &front, &sizing, err);
  if (st >= 0) st = fill(&front, sizing, field, err);
  vg_sizing_free(sizing);
  return st;
}

static vg_status join(const struct bench *b, const struct vg_layers *layers,
                      const struct vg_mesh *field, int kind, struct figures *f,
                      struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct clocks start = now();
  FILE *file;
  vg_status st;

  st = vg_layers_join(&b->surface, layers, field, (enum vg_layer_cells)kind,
                      b->o.threads, &m, &f->join[kind], err);
  f->joined[kind] = since(start);
  f->n_cell[kind] = m.n_tet + m.n_pyr + m.n_pri + m.n_hex;
  if (st < 0 || !b->o.out) goto done;
  unlink(b->o.out);
  start = now();
  st = vg_format_write(b->o.out, &m, err);
  f->written[kind] = since(start);
  file = fopen(b->o.out, "rb");
  if (file && !fseek(file, 0, SEEK_END)) f->n_byte[kind] = (size_t)ftell(file);
  if (file) fclose(file);
done:
  vg_mesh_release(&m);
  return st;
}

/* Only the first run fills the void, because the layers are always the
 * same. */
static vg_status one_run(struct bench *b, const struct vg_sizing *sizing,
                         struct vg_mesh *field, struct figures *f,
                         struct vg_error *err)
{
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;
  struct vg_layers layers = VG_LAYERS_INIT;
  struct clocks start;
  vg_status st;

  o.patch = b->request;
  o.threads = b->o.threads;
  start = now();
  st = vg_layers_grow(&b->surface, sizing, &o, &layers, &f->grow, err);
  f->grown = since(start);
  if (st >= 0 && !field->n_point) st = make_field(b, &layers, field, err);
  for (int kind = 0; kind < 2 && st >= 0; kind++)
    st = join(b, &layers, field, kind, f, err);
  vg_layers_release(&layers);
  return st;
}

static double phases(const struct vg_layer_report *r)
{
  return r->time_direction + r->time_height + r->time_clear;
}

static int by_phases(const void *a, const void *b)
{
  const struct figures *x = a, *y = b;
  double p = phases(&x->grow), q = phases(&y->grow);

  return (p > q) - (p < q);
}

static void print_grow(const struct bench *b, const struct figures *f)
{
  const struct vg_layer_report *r = &f->grow;
  double n = (double)r->n_wall_point, us = 1e6 / n, t = phases(r);

  printf("grow | %s | %d | %zu | %zu | %.1f | %.2f | %.2f | %.2f | %.2f "
         "| %.2f | %.0f | %.0f | %.3f / %.3f | %.0f | %.1f | %zu |\n",
         b->o.name, b->o.threads, r->n_wall_point, r->n_cell,
         (double)r->n_layer_point / (double)r->n_column, us * r->time_topology,
         us * r->time_direction, us * r->time_height, us * r->time_clear,
         us * r->time_slide, n / t, n / (t * f->grown.cpu / f->grown.wall),
         f->grown.wall, f->grown.cpu, n / r->time_total,
         1e-6 * (double)r->n_cell / r->time_total, r->n_round);
}

static int by_joined(const void *a, const void *b, int kind)
{
  const struct figures *x = a, *y = b;
  double p = x->joined[kind].wall + x->written[kind].wall;
  double q = y->joined[kind].wall + y->written[kind].wall;

  return (p > q) - (p < q);
}

static int by_joined_tets(const void *a, const void *b)
{
  return by_joined(a, b, 0);
}

static int by_joined_mixed(const void *a, const void *b)
{
  return by_joined(a, b, 1);
}

static void print_join(const struct bench *b, const struct figures *f, int kind)
{
  const struct vg_join_info *j = &f->join[kind];
  double n = (double)f->n_cell[kind];
  double wall = f->joined[kind].wall + f->written[kind].wall;
  double layer = (double)(j->n_layer_tet + j->n_layer_pyr + j->n_layer_pri);

  printf("join | %s | %d | %s | %zu | %.0f | %.1f | %.1f | %.3f / %.3f | ",
         b->o.name, b->o.threads, kind ? "mixed" : "tets", f->n_cell[kind],
         layer, layer > 0 ? 100 * (double)j->n_layer_pri / layer : 0.,
         1e-6 * n / f->joined[kind].wall, f->joined[kind].wall,
         f->joined[kind].cpu);
  if (b->o.out)
    printf("%.3f / %.3f | %.0f | %.1f |\n", f->written[kind].wall,
           f->written[kind].cpu,
           1e-6 * (double)f->n_byte[kind] / f->written[kind].wall,
           1e-6 * n / wall);
  else printf("- | - | - |\n");
}

static vg_status measure(struct bench *b, struct vg_error *err)
{
  struct vg_mesh field = VG_MESH_INIT;
  struct vg_sizing *sizing = NULL;
  const int n = b->o.runs;
  vg_status st = vg_sizing_new(&b->sizing, b->n_source, b->source, &b->surface,
                               &sizing, err);

  for (int i = 0; i < n && st >= 0; i++)
    st = one_run(b, sizing, &field, &b->run[i], err);
  vg_sizing_free(sizing);
  vg_mesh_release(&field);
  if (st < 0) return st;
  qsort(b->run, (size_t)n, sizeof *b->run, by_phases);
  print_grow(b, &b->run[n / 2]);
  qsort(b->run, (size_t)n, sizeof *b->run, by_joined_tets);
  print_join(b, &b->run[n / 2], 0);
  qsort(b->run, (size_t)n, sizeof *b->run, by_joined_mixed);
  print_join(b, &b->run[n / 2], 1);
  return st;
}

static int is_yes(const char *text)
{
  return !strcmp(text, "yes");
}

static int set_option(struct options *o, const char *name, const char *value)
{
  const struct {
    const char *name;
    const char **to;
  } text[] = {
    { "--name", &o->name },
    { "--demo", &o->demo },
    { "--walls", &o->walls },
    { "--out", &o->out },
  };
  const struct {
    const char *name;
    double *to;
  } number[] = {
    { "--length", &o->length },   { "--reynolds", &o->reynolds },
    { "--rate1", &o->law.rate1 }, { "--rate2", &o->law.rate2 },
    { "--cap", &o->law.cap },
  };

  for (size_t i = 0; i < sizeof text / sizeof *text; i++)
    if (!strcmp(name, text[i].name)) return *text[i].to = value, 0;
  for (size_t i = 0; i < sizeof number / sizeof *number; i++)
    if (!strcmp(name, number[i].name))
      return *number[i].to = strtod(value, NULL), 0;
  if (!strcmp(name, "--cells")) o->n_cell = strtoull(value, NULL, 10);
  else if (!strcmp(name, "--threads")) o->threads = atoi(value);
  else if (!strcmp(name, "--runs")) o->runs = atoi(value);
  else if (!strcmp(name, "--domain")) o->domain = is_yes(value);
  else if (!strcmp(name, "--fill")) o->fill = is_yes(value);
  else return -1;
  return 0;
}

static int parse(int argc, char **argv, struct options *o)
{
  for (int i = 1; i < argc; i++) {
    if (argv[i][0] != '-') o->surface = argv[i];
    else if (i + 1 >= argc || set_option(o, argv[i], argv[i + 1])) return -1;
    else i++;
  }
  if (!o->name) o->name = o->demo ? o->demo : o->surface;
  return !o->demo == !o->surface || o->runs < 1 || o->runs > RUNS_MAX ||
             o->threads < 0 || !(o->length > 0 && o->reynolds > 0)
         ? -1
         : 0;
}

int main(int argc, char **argv)
{
  struct vg_demo demo = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct bench b = { .o = { .length = 0.7,
                            .reynolds = 5e6,
                            .fill = 1,
                            .law = VG_GROWTH_LAW_INIT,
                            .threads = 1,
                            .runs = 3 },
                     .sizing = VG_SIZING_OPTIONS_INIT };
  vg_status st;
  int bad;

  if (parse(argc, argv, &b.o)) {
    fprintf(stderr, "wrong usage: see the head of bench/bench_layers.c\n");
    return 2;
  }
  if (b.o.demo) {
    st = vg_demo_make(b.o.demo, b.o.n_cell, &demo, &err);
    vg_mesh_move(&b.surface, &demo.surface);
    b.sizing = demo.sizing;
    b.n_source = demo.n_source;
    b.source = demo.source;
  } else {
    st = read_surface(&b, &err);
  }
  bad = st < 0 || make_requests(&b) || (st = measure(&b, &err)) < 0;
  if (st < 0) fprintf(stderr, "%s: %s\n", b.o.name, err.text);
  if (b.o.out) unlink(b.o.out);
  vg_mesh_release(&b.surface);
  vg_demo_release(&demo);
  free(b.request);
  return bad;
}
