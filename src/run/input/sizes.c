/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/input/sizes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/mesh/format.h"
#include "io/mesh/sol.h"
#include "io/mesh/vtu_read.h"
#include "run/settings/plan_options.h"

/* H8: pairs of points of a cell that are farther apart than FAR times the
 * smaller of their sizes get samples between them, at most PARTS - 1. */
#define FAR 2
#define PARTS 8

struct samples {
  size_t n, cap_x, cap_h;
  double (*x)[3], *h;
  int refused;
};

static void add(struct samples *s, const double x[3], double h)
{
  if (s->refused) return;
  if (vg_reserve(&s->x, &s->cap_x, s->n + 1, sizeof *s->x) ||
      vg_reserve(&s->h, &s->cap_h, s->n + 1, sizeof *s->h)) {
    s->refused = 1;
    return;
  }
  memcpy(s->x[s->n], x, sizeof *s->x);
  s->h[s->n++] = h;
}

static void add_between(struct samples *s, const double a[3], const double b[3],
                        double ha, double hb)
{
  double d2 = 0, least = ha < hb ? ha : hb, ratio, x[3];
  int parts;

  for (int k = 0; k < 3; k++) d2 += (b[k] - a[k]) * (b[k] - a[k]);
  ratio = sqrt(d2) / least;
  if (!(ratio > FAR)) return;
  parts = ratio < PARTS ? (int)ratio : PARTS;
  for (int i = 1; i < parts; i++) {
    double t = (double)i / parts;

    for (int k = 0; k < 3; k++) x[k] = a[k] + t * (b[k] - a[k]);
    add(s, x, ha + t * (hb - ha));
  }
}

/* Adds samples between all pairs of points of each cell, or of each face if
 * there are no cells. */
static void add_cells(struct samples *s, const struct vg_mesh *m,
                      const double *h, size_t n, int width,
                      const uint32_t *node)
{
  for (size_t i = 0; i < n && !s->refused; i++, node += width)
    for (int a = 0; a < width; a++)
      for (int b = a + 1; b < width; b++)
        add_between(s, m->point[node[a]], m->point[node[b]], h[node[a]],
                    h[node[b]]);
}

static vg_status make_samples(const struct vg_mesh *m, const double *h,
                              struct samples *s, struct vg_error *err)
{
  for (size_t i = 0; i < m->n_point; i++) add(s, m->point[i], h[i]);
  if (m->n_tet) add_cells(s, m, h, m->n_tet, 4, m->tet[0]);
  if (m->n_pyr) add_cells(s, m, h, m->n_pyr, 5, m->pyr[0]);
  if (m->n_pri) add_cells(s, m, h, m->n_pri, 6, m->pri[0]);
  if (m->n_hex) add_cells(s, m, h, m->n_hex, 8, m->hex[0]);
  if (m->n_tri) add_cells(s, m, h, m->n_tri, 3, m->tri[0]);
  if (m->n_quad) add_cells(s, m, h, m->n_quad, 4, m->quad[0]);
  return s->refused ? vg_fail_memory(err, "the sizes of a mesh") : VG_OK;
}

vg_status vg_sizes_meshes(const char *path, char *found[2],
                          struct vg_error *err)
{
  const char *dot = strrchr(path, '.'), *suffix;
  char *name;
  int n = 0;

  found[0] = found[1] = NULL;
  for (size_t i = 0; (suffix = vg_format_input_suffix(i)) && n < 2; i++) {
    if (asprintf(&name, "%.*s.%s", (int)(dot - path), path, suffix) < 0) {
      free(found[0]);
      found[0] = NULL;
      return vg_fail_memory(err, "a path");
    }
    if (access(name, F_OK)) free(name);
    else found[n++] = name;
  }
  return VG_OK;
}

vg_status vg_sizes_find_mesh(const char *path, char **out, struct vg_error *err)
{
  const char *dot = strrchr(path, '.');
  char *found[2];
  vg_status st = vg_sizes_meshes(path, found, err);

  if (st < 0) return st;
  if (found[1])
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: both %s and %s could be the mesh of these values; keep "
                 "only one of them next to the file",
                 path, found[0], found[1]);
  else if (!found[0])
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: the values belong to the points of a mesh, but there is "
                 "no %.*s.mesh, .meshb, .b8.ugrid, ... in the same folder",
                 path, (int)(dot - path), path);
  free(found[1]);
  if (st < 0) free(found[0]);
  else *out = found[0];
  return st;
}

static int ends_in(const char *path, const char *suffix)
{
  size_t n = strlen(path), len = strlen(suffix);

  return n > len && !strcasecmp(path + n - len, suffix);
}

/* Values of a file at the points of a mesh. */
struct values {
  struct vg_mesh m;
  int components; /* 1: sizes; 6 or 9: metrics */
  double *value;  /* [n_point][components] */
  int is_vtk;
};

static vg_status check_components(const char *path, int is_metric,
                                  const struct values *v, struct vg_error *err)
{
  if (!is_metric && v->components != 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the array 'size' has %d components; an edge length "
                   "has 1",
                   path, v->components);
  if (is_metric && v->components != 6 && v->components != 9)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the array 'metric' has %d components; a metric has 6 "
                   "(symmetric) or 9",
                   path, v->components);
  return VG_OK;
}

static vg_status read_vtk(const char *path, struct values *v,
                          struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error inner = VG_ERROR_INIT;
  int has_size, is_metric;
  vg_status st;

  v->is_vtk = 1;
  VG_TRY(vg_input_open(path, &in, err));
  has_size = vg_vtu_has_array(&in, "PointData", "size");
  is_metric = vg_vtu_has_array(&in, "PointData", "metric");
  if (has_size && is_metric) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s has both arrays 'size' and 'metric'; keep only one of "
                 "them",
                 path);
    goto done;
  }
  st = vg_vtu_values_parse(&in, "PointData", is_metric ? "metric" : "size",
                           &v->m, &v->components, &v->value, &inner);
  if (st >= 0) st = check_components(path, is_metric, v, &inner);
  if (st < 0)
    vg_fail(err, st, "%s%s", inner.text,
            has_size || is_metric
              ? ""
              : "; edge lengths are read from a point array 'size', metrics "
                "from 'metric'");
done:
  vg_input_release(&in);
  return st;
}

static vg_status read_values(const char *path, struct values *v,
                             struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  char *mesh = NULL;
  size_t n = 0;
  vg_status st;

  if (ends_in(path, ".vtu") || ends_in(path, ".vtp"))
    return read_vtk(path, v, err);
  if (!ends_in(path, ".sol") && !ends_in(path, ".solb"))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: sizes can be read from Medit's .sol and .solb next to "
                   "a mesh, and from a point array 'size' or 'metric' in VTK's "
                   ".vtu",
                   path);
  VG_TRY(vg_sol_read(path, &n, &v->components, &v->value, err));
  VG_TRY(vg_sizes_find_mesh(path, &mesh, err));
  st = vg_format_read(mesh, &v->m, &why);
  if (st < 0)
    vg_fail(err, st, "%s: the mesh of these sizes cannot be read: %s", path,
            why.text);
  if (st < 0) goto done;
  if (n != v->m.n_point)
    st = vg_fail(err, VG_ERR_INPUT, "%s has %zu %s, but %s has %zu points",
                 path, n, v->components == 1 ? "sizes" : "metrics", mesh,
                 v->m.n_point);
done:
  free(mesh);
  return st;
}

static vg_status use_sizes(struct vg_read *r, const struct values *v,
                           struct vg_error *err)
{
  const struct vg_settings *set = &r->settings;
  struct samples s = { 0 };
  vg_status st;

  VG_TRY(vg_size_samples_check(set->sizes, v->m.n_point,
                               (const double(*)[3])v->m.point, v->value, err));
  VG_TRY(make_samples(&v->m, v->value, &s, err));
  VG_TRY(vg_size_samples_new(s.n, (const double(*)[3])s.x, s.h,
                             vg_options_growth(set), (int)set->threads,
                             &r->samples, err));
  r->map = vg_size_samples_map(r->samples);
  vg_note(r->notes, "sizes at %zu points were read from %s", v->m.n_point,
          set->sizes);
done:
  free(s.x);
  free(s.h);
  return st;
}

void vg_note_aspects(struct vg_notes *notes, size_t n,
                     const double (*metric)[6], double aspect_max)
{
  size_t beyond = vg_size_metrics_beyond(n, metric, aspect_max);

  if (beyond)
    vg_note(notes,
            "%zu of these metrics have an aspect above %g (aspect_max): their "
            "larger edge lengths are reduced",
            beyond, aspect_max);
}

static vg_status use_metrics(struct vg_read *r, const struct values *v,
                             struct vg_error *err)
{
  const struct vg_settings *set = &r->settings;
  enum vg_tensor_order order = (enum vg_tensor_order)set->metric_order;
  double(*metric)[6] = vg_alloc(v->m.n_point, sizeof *metric);
  vg_status st;

  if (!metric) return vg_fail_memory(err, "the metrics of a mesh");
  if (order == VG_TENSOR_FILE)
    order = v->is_vtk ? VG_TENSOR_VTK : VG_TENSOR_MEDIT;
  VG_TRY(vg_size_metrics_read(set->sizes, v->m.n_point,
                              (const double(*)[3])v->m.point, v->components,
                              order, v->value, metric, err));
  VG_TRY(vg_size_mesh_new(&v->m, (const double(*)[6])metric,
                          vg_options_growth(set), &r->metrics, err));
  r->map = vg_size_mesh_map(r->metrics);
  vg_note(r->notes, "metrics at %zu points were read from %s", v->m.n_point,
          set->sizes);
  vg_note_aspects(r->notes, v->m.n_point, (const double(*)[6])metric,
                  set->aspect_max);
done:
  free(metric);
  return st;
}

vg_status vg_read_sizes(struct vg_read *r, struct vg_error *err)
{
  const struct vg_settings *set = &r->settings;
  struct values v = { VG_MESH_INIT, 0, NULL, 0 };
  vg_status st;

  if (!*set->sizes || r->samples || r->metrics) return VG_OK;
  if (r->map)
    return vg_fail(err, VG_ERR_INPUT,
                   "sizes are given both by the file %s and by the calling "
                   "program; give only one of them",
                   set->sizes);
  st = read_values(set->sizes, &v, err);
  if (st >= 0)
    st = v.components == 1 ? use_sizes(r, &v, err) : use_metrics(r, &v, err);
  free(v.value);
  vg_mesh_release(&v.m);
  return st;
}
