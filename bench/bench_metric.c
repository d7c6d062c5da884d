/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vg_bench_metric CASE COMPLEXITY [OPTION...]: the kernel in the analytic
 * metrics of metric_cases.h, which CASE names: linear, polar1, polar2, each
 * also with -cylinder.
 *
 *   --surface FILE     surface of the domain (default: the cube); it is
 * remeshed in the metric first, unless --given
 *   --growth G         growth rate of the sizing field (default 2: the metric
 *                      itself)
 *   --sweeps N         sweeps of the optimisation (default 2)
 *   --write FILE       also write the mesh
 *   --measure FILE     measure this mesh instead of making one
 *   --seconds S        time of that mesh, for the table
 *   --background STEM  write a background mesh STEM.meshb with STEM.sol instead
 *   --head             print the head of the table before the row; as the only
 *                      argument: alone
 *
 * Remeshes the surface and fills it with one call of vg_fill_front, all on one
 * thread, and prints a row of a table: figures in the analytic metric, and the
 * time of sizing field, surface and fill. Lines on standard error have the
 * parts of the time and the figures of the mesh check. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "core/fill/fill.h"
#include "core/judge/quality.h"
#include "core/remesh/remesh.h"
#include "io/mesh/format.h"
#include "metric_cases.h"

struct options {
  const char *name, *surface, *out, *mesh, *background;
  double complexity, growth, seconds;
  int sweeps, head, given;
};

struct bench {
  struct options o;
  struct metric_case c;
  struct vg_mesh surface, mesh;
  struct vg_sizing *sizing;
  double sizing_time, surface_time, fill_time;
};

static double now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static vg_status make_sizing(struct bench *b, struct vg_error *err)
{
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_size_map map = metric_case_map(&b->c);
  double t = now();
  vg_status st;

  options.from_surface = 0;
  options.growth = b->o.growth;
  options.map = &map;
  st = vg_sizing_new(&options, 0, NULL, &b->surface, &b->sizing, err);
  b->sizing_time = now() - t;
  return st;
}

/* The unit cube with two triangles on each side, which are patches. */
static vg_status make_cube(struct vg_mesh *m, struct vg_error *err)
{
  m->n_point = 8;
  m->n_tri = 12;
  m->point = vg_alloc(8, sizeof *m->point);
  m->tri = vg_alloc(12, sizeof *m->tri);
  m->tri_patch = vg_alloc(12, sizeof *m->tri_patch);
  if (!m->point || !m->tri || !m->tri_patch)
    return vg_fail_memory(err, "the cube");
  for (uint32_t p = 0; p < 8; p++)
    for (int k = 0; k < 3; k++) m->point[p][k] = p >> k & 1;
  for (uint32_t f = 0; f < 6; f++) {
    uint32_t axis = f / 2, u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    uint32_t o = f % 2 ? 1u << axis : 0;
    uint32_t tri[2][3] = { { o, o + u, o + u + v }, { o, o + u + v, o + v } };

    for (uint32_t t = 0; t < 2; t++) {
      uint32_t *to = m->tri[2 * f + t];

      memcpy(to, tri[t], sizeof *m->tri);
      if (f % 2) {
        to[1] = tri[t][2];
        to[2] = tri[t][1];
      }
      m->tri_patch[2 * f + t] = f;
    }
    if (vg_mesh_add_patch(m, (int32_t)f + 1, "side") == SIZE_MAX)
      return vg_fail_memory(err, "the cube");
  }
  return VG_OK;
}

static vg_status make_surface(struct bench *b, struct vg_error *err)
{
  if (!b->o.surface) return make_cube(&b->surface, err);
  return vg_surface_read(b->o.surface, &b->surface, NULL, err);
}

static vg_status remesh(struct bench *b, struct vg_error *err)
{
  struct vg_remesh_options options = VG_REMESH_OPTIONS_INIT;
  double t = now();
  vg_status st;

  if (b->o.given) return VG_OK;
  options.field = b->sizing;
  options.h_max = 1;
  options.growth = b->o.growth;
  st = vg_remesh(&b->surface, &options, NULL, err);
  b->surface_time = now() - t;
  return st;
}

/* The points of the surface, the new points, and the cells. */
static vg_status join(struct bench *b, struct vg_filled *made,
                      struct vg_error *err)
{
  struct vg_mesh *m = &b->mesh;
  size_t cap, n_old = b->surface.n_point;
  vg_status st = vg_mesh_copy(m, &b->surface, err);

  if (st < 0) return st;
  cap = n_old;
  if (vg_reserve(&m->point, &cap, n_old + made->n_point, sizeof *m->point))
    return vg_fail_memory(err, "the mesh");
  if (made->n_point)
    memcpy(m->point + n_old, made->x, made->n_point * sizeof *m->point);
  m->n_point += made->n_point;
  free(m->tet);
  m->tet = made->cell;
  m->n_tet = made->n_cell;
  made->cell = NULL;
  return VG_OK;
}

static vg_status fill(struct bench *b, struct vg_error *err)
{
  const struct vg_front front = vg_front_of(&b->surface);
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_filled made = VG_FILLED_INIT;
  struct vg_fill_report report;
  double t = now();
  vg_status st;

  memset(&report, 0, sizeof report);
  options.sweeps = b->o.sweeps;
  st = vg_fill_front(&front, NULL, b->sizing, &options, &made, &report, err);
  b->fill_time = now() - t;
  if (st == VG_OK) st = join(b, &made, err);
  vg_filled_release(&made);
  if (st < 0) return st;
  fprintf(stderr,
          "sizing field %.1f s; surface of %zu triangles %.1f s; fill %.1f s: "
          "boundary %.1f, placement %.1f, insertion %.1f, optimisation %.1f; "
          "%.0f cells/s\n",
          b->sizing_time, b->surface.n_tri, b->surface_time, b->fill_time,
          report.time_boundary, report.time_place, report.time_insert,
          report.time_optimise, (double)b->mesh.n_tet / b->fill_time);
  return VG_OK;
}

/* The same figures by the mesh check, in the sizing field. */
static vg_status judge(const struct bench *b, struct vg_error *err)
{
  struct vg_mesh_report r;
  vg_status st = vg_mesh_judge(&b->mesh, b->sizing, &r, err);
  const struct vg_metric_report *m = &r.metric;

  if (st < 0) return st;
  fprintf(stderr,
          "mesh check: %s; edges in [0.7, 1.4] %.2f %%, [0.71, 1.41] %.2f %%, "
          "[0.5, 2] %.2f %%, %.3f .. %.2f; mean ratio %.4f, %.3f, %.4f %%, "
          "%.4f %%; complexity %.0f, cells / ideal %.3f\n",
          r.is_valid ? "valid" : "NOT VALID", m->within[0], m->within[1],
          m->within[2], m->length_min, m->length_max, m->mean_ratio_mean,
          m->mean_ratio_min, m->below[0], m->below[1], m->complexity,
          (double)m->n_cell / m->ideal);
  return r.is_valid ? VG_OK
                    : vg_fail(err, VG_ERR_GEOMETRY, "the mesh is not valid");
}

static vg_status make(struct bench *b, struct vg_error *err)
{
  vg_status st = make_surface(b, err);

  VG_TRY(st);
  VG_TRY(make_sizing(b, err));
  VG_TRY(remesh(b, err));
  VG_TRY(fill(b, err));
  VG_TRY(judge(b, err));
  if (b->o.out) VG_TRY(vg_format_write(b->o.out, &b->mesh, err));
done:
  return st;
}

static vg_status run(struct bench *b, struct vg_error *err)
{
  struct vg_read_info info = { .mapbc = NULL };
  struct metric_figures f;
  double seconds = b->o.seconds;
  vg_status st = VG_OK;

  if (b->o.background) return metric_background(&b->c, b->o.background, err);
  if (b->o.mesh) {
    VG_TRY(vg_mesh_read(b->o.mesh, &b->mesh, &info, err));
  } else {
    VG_TRY(make(b, err));
    seconds = b->sizing_time + b->surface_time + b->fill_time;
  }
  VG_TRY(metric_measure(&b->c, &b->mesh, &f, err));
  if (b->o.head) metric_head(stdout);
  metric_row(stdout, b->o.name, b->o.complexity, &f, seconds);
done:
  return st;
}

static int set_option(struct options *o, const char *name, const char *value)
{
  const struct {
    const char *name, **to;
  } text[] = {
    { "--surface", &o->surface },
    { "--write", &o->out },
    { "--measure", &o->mesh },
    { "--background", &o->background },
  };

  for (size_t i = 0; i < sizeof text / sizeof *text; i++)
    if (!strcmp(name, text[i].name)) return *text[i].to = value, 0;
  if (!strcmp(name, "--growth")) o->growth = atof(value);
  else if (!strcmp(name, "--seconds")) o->seconds = atof(value);
  else if (!strcmp(name, "--sweeps")) o->sweeps = atoi(value);
  else return -1;
  return 0;
}

static int parse(int argc, char **argv, struct bench *b)
{
  struct options *o = &b->o;

  if (argc < 3 || metric_case_find(argv[1], &b->c)) return -1;
  o->name = argv[1];
  o->complexity = atof(argv[2]);
  for (int i = 3; i < argc; i++) {
    if (!strcmp(argv[i], "--head")) o->head = 1;
    else if (!strcmp(argv[i], "--given")) o->given = 1;
    else if (i + 1 >= argc || set_option(o, argv[i], argv[i + 1])) return -1;
    else i++;
  }
  return o->complexity > 0 && o->growth > 1 ? 0 : -1;
}

int main(int argc, char **argv)
{
  struct bench b = { .o = { .growth = 2, .sweeps = 2, .seconds = -1 } };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (argc == 2 && !strcmp(argv[1], "--head")) {
    metric_head(stdout);
    return 0;
  }
  if (parse(argc, argv, &b)) {
    fprintf(stderr, "wrong usage: see the head of bench/bench_metric.c\n");
    return 2;
  }
  metric_case_scale(&b.c, b.o.complexity);
  st = run(&b, &err);
  if (st < 0) fprintf(stderr, "%s: %s\n", b.o.name, err.text);
  vg_mesh_release(&b.surface);
  vg_mesh_release(&b.mesh);
  vg_sizing_free(b.sizing);
  return st < 0;
}
