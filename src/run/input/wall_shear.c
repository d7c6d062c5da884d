/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/input/wall_shear.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "core/mesh/cell_links.h"
#include "core/search/box_tree.h"
#include "io/mesh/vtu_read.h"
#include "run/common/text.h"
#include "run/input/solution.h"

/* L31: distance from a wall, relative to the longer of two local edges, up to
 * which its values hold; largest ratio of the edge of the wall to that of the
 * surface that counts; cosine of the angle between normals from which a wall
 * faces another way. */
#define REACH 0.25
#define COARSER 4.0
#define FACING 0.2

enum { NAMES = 1000, SAMPLES = 20000 };

/* Names in use: coefficients, then stresses, which need a factor. */
static const char *const usual[] = { "cf", "Cf", "skin_friction",
                                     "Skin_Friction_Coefficient",
                                     "wallShearStress" };
enum { N_USUAL = sizeof usual / sizeof *usual, N_COEFFICIENT = N_USUAL - 1 };

struct vg_wall_shear {
  char *field;
  size_t n_point, n_tri;
  double (*x)[3];     /* [n_point] */
  double *cf;         /* [n_point] */
  uint32_t (*tri)[3]; /* [n_tri] */
  size_t cap_x, cap_cf, cap_tri;
  struct vg_box_tree tree;
};

void vg_wall_shear_free(struct vg_wall_shear *w)
{
  if (!w) return;
  free(w->field);
  free(w->x);
  free(w->cf);
  free(w->tri);
  vg_box_tree_release(&w->tree);
  free(w);
}

const char *vg_wall_shear_field(const struct vg_wall_shear *w)
{
  return w->field;
}

void vg_wall_shear_box(const struct vg_wall_shear *w, double lo[3],
                       double hi[3])
{
  const struct vg_box *all = vg_box_tree_node(&w->tree, 0);

  memcpy(lo, all->lo, sizeof all->lo);
  memcpy(hi, all->hi, sizeof all->hi);
}

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "the wall shear of a solution");
}

/* --- values --------------------------------------------------------------- */

/* The array that the settings name, or the only one with a usual name. */
static vg_status choose_field(const struct vg_layer_settings *l,
                              const char *path, struct vg_input *in,
                              const char **out, struct vg_error *err)
{
  char names[NAMES];

  *out = *l->first_field ? l->first_field : NULL;
  for (int i = 0; i < N_USUAL && !*l->first_field; i++) {
    if (!vg_vtu_has_array(in, "PointData", usual[i])) continue;
    if (*out)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s has both point arrays '%s' and '%s': name the one to "
                     "use by --first-field",
                     path, *out, usual[i]);
    *out = usual[i];
  }
  if (*out && vg_vtu_has_array(in, "PointData", *out)) return VG_OK;
  vg_vtu_array_names(in, "PointData", names, sizeof names);
  if (*out || *names)
    return vg_solution_no_array(path, *out ? *out : "", "--first-field", in,
                                err);
  *out = usual[0]; /* The reader says what is wrong with the file. */
  return VG_OK;
}

/* A stress is not taken for a coefficient in silence. */
static vg_status factor_of(const struct vg_layer_settings *l, const char *path,
                           const char *field, double *factor,
                           struct vg_error *err)
{
  *factor = l->first_scale > 0 ? l->first_scale : 1;
  if (l->first_scale > 0 || strcmp(field, usual[N_COEFFICIENT]) != 0)
    return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: '%s' is a stress, not a skin friction coefficient: give "
                 "the factor between them as --first-scale, which is 2/U^2 if "
                 "the solver divides by the density (incompressible), else 2 "
                 "/ (rho U^2), with density and velocity of the free stream",
                 path, field);
}

/* Coefficient at a point: the value, or the length of the vector. */
static double coefficient(const double *v, int components, double factor)
{
  double sum = 0;

  if (components == 1) return factor * v[0];
  for (int k = 0; k < components; k++) sum += v[k] * v[k];
  return factor * sqrt(sum);
}

static vg_status reduce(const char *path, const char *field, int components,
                        double factor, size_t n, double *value,
                        struct vg_error *err)
{
  if (components > 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: '%s' has %d components; a skin friction has 1, or 2 or "
                   "3 as a vector",
                   path, field, components);
  for (size_t i = 0; i < n; i++)
    value[i] = coefficient(value + i * (size_t)components, components, factor);
  return VG_OK;
}

/* --- walls ---------------------------------------------------------------- */

struct walls {
  const struct vg_mesh *m;
  const double *cf; /* [m->n_point] */
  size_t n, cap;
  uint32_t (*tri)[3];
  int refused;
};

/* Adds a triangle of a wall: at most one of its corners may have the value
 * zero, as a stagnation point has. */
static void add(struct walls *w, uint32_t a, uint32_t b, uint32_t c)
{
  const uint32_t node[3] = { a, b, c };
  int n = 0;

  for (int k = 0; k < 3; k++) n += !(w->cf[node[k]] == 0);
  if (n < 2 || w->refused) return;
  if (vg_reserve(&w->tri, &w->cap, w->n + 1, sizeof *w->tri)) w->refused = 1;
  else memcpy(w->tri[w->n++], node, sizeof node);
}

static void add_quad(struct walls *w, const uint32_t q[4])
{
  add(w, q[0], q[1], q[2]);
  add(w, q[0], q[2], q[3]);
}

/* The boundary of the cells. */
static vg_status add_boundary(struct walls *w, const char *path,
                              struct vg_error *err)
{
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  vg_status st = vg_cell_links_build(&l, w->m, 1, path, err);

  for (uint32_t c = 0; st >= 0 && c < l.n_cell; c++)
    for (int f = 0; f < vg_half_faces(&l, c); f++) {
      const uint32_t code = 8 * c + (uint32_t)f;
      uint32_t node[4];

      if (vg_mate(&l, code) != VG_NO_CELL) continue;
      if (vg_half_face_nodes(&l, code, node) == 4) add_quad(w, node);
      else add(w, node[0], node[1], node[2]);
    }
  vg_cell_links_release(&l);
  return st;
}

static vg_status find_walls(struct walls *w, const char *path,
                            struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  vg_status st = VG_OK;

  for (size_t i = 0; i < m->n_tri; i++)
    add(w, m->tri[i][0], m->tri[i][1], m->tri[i][2]);
  for (size_t i = 0; i < m->n_quad; i++) add_quad(w, m->quad[i]);
  if (!m->n_tri && !m->n_quad) st = add_boundary(w, path, err);
  if (st < 0) return st;
  if (w->refused) return no_memory(err);
  return VG_OK;
}

static vg_status check(const struct walls *w, const char *path,
                       const char *field, struct vg_error *err)
{
  for (size_t i = 0; i < 3 * w->n; i++) {
    const uint32_t p = w->tri[i / 3][i % 3];
    const double *x = w->m->point[p], v = w->cf[p];

    if (v >= 0 && isfinite(v)) continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: '%s' gives the skin friction coefficient %g at point "
                   "%u, (%g %g %g): %s",
                   path, field, v, p + 1, x[0], x[1], x[2],
                   isfinite(v) ? "it must not be negative; write the vector, "
                                 "whose length counts, or the absolute value"
                               : "the solution must be complete");
  }
  return VG_OK;
}

/* Adds the walls and the points that they use to the result. */
static vg_status keep(struct walls *w, const char *path,
                      struct vg_wall_shear *out, struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  uint32_t *number = vg_calloc(m->n_point, sizeof *number);
  size_t n = out->n_point;

  if (!number) return no_memory(err);
  for (size_t i = 0; i < 3 * w->n; i++) number[w->tri[i / 3][i % 3]] = 1;
  for (size_t p = 0; p < m->n_point; p++)
    if (number[p]) number[p] = (uint32_t)n++;
  if (n > UINT32_MAX / 2 || out->n_tri + w->n > UINT32_MAX / 4) {
    free(number);
    return vg_fail(err, VG_ERR_UNSUPPORTED, "%s: more than 2^30 wall faces",
                   path);
  }
  if (vg_reserve(&out->x, &out->cap_x, n, sizeof *out->x) ||
      vg_reserve(&out->cf, &out->cap_cf, n, sizeof *out->cf) ||
      vg_reserve(&out->tri, &out->cap_tri, out->n_tri + w->n,
                 sizeof *out->tri)) {
    free(number);
    return no_memory(err);
  }
  for (size_t i = 0; i < 3 * w->n; i++) {
    const uint32_t p = w->tri[i / 3][i % 3], to = number[p];

    out->tri[out->n_tri + i / 3][i % 3] = to;
    memcpy(out->x[to], m->point[p], sizeof *out->x);
    out->cf[to] = w->cf[p];
  }
  free(number);
  out->n_point = n;
  out->n_tri += w->n;
  return VG_OK;
}

static vg_status make_tree(struct vg_wall_shear *w, struct vg_error *err)
{
  struct vg_box *box = vg_alloc(w->n_tri, sizeof *box);
  vg_status st;

  if (!box) return no_memory(err);
  for (size_t t = 0; t < w->n_tri; t++) {
    box[t] = (struct vg_box)VG_BOX_EMPTY;
    for (int k = 0; k < 3; k++) vg_box_add(&box[t], w->x[w->tri[t][k]]);
  }
  st = vg_box_tree_build_items(&w->tree, w->n_tri, box, NULL, err);
  free(box);
  return st;
}

/* Adds the walls of a file. */
static vg_status read_file(const struct vg_layer_settings *l, const char *path,
                           struct vg_wall_shear *out, struct vg_error *err)
{
  const char *field = NULL;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct walls w = { &m, NULL, 0, 0, NULL, 0 };
  double *value = NULL, factor = 1;
  int components = 0;
  vg_status st;

  if (!vg_text_ends(path, ".vtu") && !vg_text_ends(path, ".vtp"))
    return vg_fail(err, VG_ERR_INPUT,
                   "first_from: %s is neither a .vtu nor a .vtp, nor a folder "
                   "of them; SU2 writes surface_flow.vtu (SURFACE_PARAVIEW), "
                   "OpenFOAM's foamToVTK internal.vtu and a folder boundary",
                   path);
  VG_TRY(vg_input_open(path, &in, err));
  VG_TRY(choose_field(l, path, &in, &field, err));
  VG_TRY(
    vg_vtu_values_parse(&in, "PointData", field, &m, &components, &value, err));
  VG_TRY(factor_of(l, path, field, &factor, err));
  VG_TRY(reduce(path, field, components, factor, m.n_point, value, err));
  w.cf = value;
  VG_TRY(find_walls(&w, path, err));
  VG_TRY(check(&w, path, field, err));
  VG_TRY(keep(&w, path, out, err));
  if (!out->field) out->field = strdup(field);
  if (!out->field) st = no_memory(err);
done:
  free(value);
  free(w.tri);
  vg_mesh_release(&m);
  vg_input_release(&in);
  return st;
}

static int is_vtk(const struct dirent *d)
{
  return vg_text_ends(d->d_name, ".vtu") || vg_text_ends(d->d_name, ".vtp");
}

/* In the same order for all locales. */
static int by_name(const struct dirent **a, const struct dirent **b)
{
  return strcmp((*a)->d_name, (*b)->d_name);
}

/* Adds the walls of all files in a folder, such as one for each patch. */
static vg_status read_folder(const struct vg_layer_settings *l,
                             struct vg_wall_shear *out, struct vg_error *err)
{
  struct dirent **list = NULL;
  const int n = scandir(l->first_from, &list, is_vtk, by_name);
  vg_status st = VG_OK;

  if (n < 0)
    return vg_fail(err, errno == ENOMEM ? VG_ERR_MEMORY : VG_ERR_IO,
                   "%s: cannot list the folder: %s", l->first_from,
                   strerror(errno));
  if (!n)
    st = vg_fail(err, VG_ERR_INPUT,
                 "first_from: there is no .vtu or .vtp in the folder %s",
                 l->first_from);
  for (int i = 0; i < n; i++) {
    char *path = NULL;

    if (st >= 0 && asprintf(&path, "%s/%s", l->first_from, list[i]->d_name) < 0)
      path = NULL, st = no_memory(err);
    if (st >= 0) st = read_file(l, path, out, err);
    free(path);
    free(list[i]);
  }
  free(list);
  return st;
}

static vg_status read_walls(const struct vg_layer_settings *l,
                            struct vg_wall_shear *out, struct vg_error *err)
{
  struct stat s;
  vg_status st = stat(l->first_from, &s) == 0 && S_ISDIR(s.st_mode)
                 ? read_folder(l, out, err)
                 : read_file(l, l->first_from, out, err);

  if (st < 0) return st;
  if (!out->n_tri)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s has no walls: '%s' is zero on all of its triangles and "
                   "quadrilaterals, or on the boundary of its tetrahedra, "
                   "pyramids, wedges and hexahedra",
                   l->first_from, out->field);
  return make_tree(out, err);
}

vg_status vg_read_shear(struct vg_read *r, struct vg_error *err)
{
  const struct vg_layer_settings *l = &r->settings.layer;
  struct vg_wall_shear *w;
  vg_status st;

  if (!*l->first_from || r->shear) return VG_OK;
  w = vg_calloc(1, sizeof *w);
  if (!w) return no_memory(err);
  st = read_walls(l, w, err);
  if (st < 0) vg_wall_shear_free(w);
  else r->shear = w;
  return st;
}

/* --- search --------------------------------------------------------------- */

struct search {
  const struct vg_wall_shear *w;
  const double *x, *normal; /* normal NULL: all triangles count */
  int side;
  double d2;
  uint32_t tri; /* UINT32_MAX: none */
};

static int enter(void *context, size_t node, double d2)
{
  const struct search *s = context;

  (void)node;
  return d2 <= s->d2;
}

static void normal_of(const struct vg_wall_shear *w, uint32_t t, double n[3])
{
  const uint32_t *v = w->tri[t];
  double a[3], b[3];

  vg_sub(w->x[v[1]], w->x[v[0]], a);
  vg_sub(w->x[v[2]], w->x[v[0]], b);
  vg_cross(a, b, n);
}

/* Does triangle t have an area and face the way of the search? */
static int faces(const struct search *s, uint32_t t)
{
  double n[3], area2;

  normal_of(s->w, t, n);
  area2 = vg_norm(n);
  return area2 > 0 &&
         (!s->normal || s->side * vg_dot(n, s->normal) > FACING * area2);
}

/* Of equally near triangles, the first one is found. */
static void leaf(void *context, size_t node)
{
  struct search *s = context;
  const struct vg_wall_shear *w = s->w;
  const size_t end = vg_box_tree_end(&w->tree, node);

  for (size_t i = vg_box_tree_first(&w->tree, node); i < end; i++) {
    const uint32_t t = w->tree.item[i], *v = w->tri[t];
    double d2;

    if (vg_box_distance2(&w->tree.box[i], s->x) > s->d2) continue;
    if (!faces(s, t)) continue;
    d2 = vg_to_triangle2(s->x, w->x[v[0]], w->x[v[1]], w->x[v[2]]);
    if (d2 < s->d2 || (d2 == s->d2 && t < s->tri)) s->d2 = d2, s->tri = t;
  }
}

/* Value at the nearest triangle of a search; negative if it is too far. */
static double ask(const struct vg_wall_shear *w, const double x[3],
                  const double *normal, int side, double edge)
{
  struct search s = { w, x, normal, side, INFINITY, UINT32_MAX };
  const uint32_t *v;
  double weight[3], sum = 0, own = edge;

  vg_box_tree_approach(&w->tree, x, enter, leaf, &s);
  if (s.tri == UINT32_MAX) return -1;
  v = w->tri[s.tri];
  for (int k = 0; k < 3; k++)
    edge = fmax(edge, vg_distance(w->x[v[k]], w->x[v[(k + 1) % 3]]));
  edge = fmin(edge, COARSER * own);
  if (!(s.d2 <= REACH * REACH * edge * edge)) return -1;
  vg_nearest_weights(x, w->x[v[0]], w->x[v[1]], w->x[v[2]], weight);
  for (int k = 0; k < 3; k++) sum += weight[k] * w->cf[v[k]];
  return fmax(sum, 0);
}

double vg_wall_shear_at(const struct vg_wall_shear *w, const double x[3],
                        const double normal[3], int side, double edge)
{
  double unit[3] = { normal[0], normal[1], normal[2] }, cf = -1;

  assert(side >= -1 && side <= 1 && edge >= 0);
  if (side && vg_unit(unit) > 0) cf = ask(w, x, unit, side, edge);
  return cf < 0 ? ask(w, x, NULL, 0, edge) : cf;
}

double vg_wall_shear_side(const struct vg_wall_shear *w,
                          const struct vg_mesh *m, const uint8_t *on)
{
  const size_t step = 1 + m->n_tri / SAMPLES;
  double sum = 0, all = 0;

  for (size_t t = 0; t < m->n_tri; t += step) {
    const uint32_t *v = m->tri[t];
    double a[3], b[3], n[3], x[3], to[3], cosine;
    struct search s = { w, x, NULL, 0, INFINITY, UINT32_MAX };

    if (!on[t]) continue;
    vg_sub(m->point[v[1]], m->point[v[0]], a);
    vg_sub(m->point[v[2]], m->point[v[0]], b);
    vg_cross(a, b, n);
    for (int k = 0; k < 3; k++) x[k] = m->point[v[0]][k] + (a[k] + b[k]) / 3;
    vg_box_tree_approach(&w->tree, x, enter, leaf, &s);
    if (s.tri == UINT32_MAX) continue;
    normal_of(w, s.tri, to);
    cosine = vg_unit(to) > 0 ? vg_dot(n, to) / vg_norm(n) : 0;
    if (!(fabs(cosine) > FACING)) continue;
    all += vg_norm(n);
    sum += copysign(vg_norm(n), cosine);
  }
  return all > 0 ? sum / all : 0;
}
