/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/input/solution.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "core/hessian/point_values.h"
#include "io/cgns/cgns.h"
#include "io/foam/foam_read.h"
#include "io/mesh/format.h"
#include "io/mesh/sol.h"
#include "io/mesh/vtu_read.h"
#include "io/stream/csv.h"
#include "run/common/text.h"
#include "run/input/sizes.h"

/* Coordinates of a table that agree with those of the mesh differ by less,
 * relative to the size of the mesh: files have at least six digits. */
#define SAME_PLACE 1e-5

enum { NAMES = 1000 };

void vg_solution_release(struct vg_solution *s)
{
  for (size_t i = 0; i < s->n_field; i++) {
    free(s->field[i].name);
    free(s->field[i].value);
  }
  free(s->mesh);
  vg_mesh_release(&s->m);
  *s = (struct vg_solution)VG_SOLUTION_INIT;
}

/* Take over the values of a field. */
static vg_status add_field(const char *path, struct vg_solution *s,
                           const char *name, double *value,
                           struct vg_error *err)
{
  struct vg_solution_field *f = &s->field[s->n_field];

  assert(s->n_field < VG_SOLUTION_FIELDS);
  f->value = value;
  f->name = strdup(name);
  s->n_field++;
  if (!f->name) return vg_fail_memory(err, "the name of a field");
  for (size_t p = 0; p < s->m.n_point; p++)
    if (!isfinite(value[p]))
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: the value of '%s' at point %zu, (%g %g %g), is not "
                     "finite; the solution must be complete",
                     path, name, p + 1, s->m.point[p][0], s->m.point[p][1],
                     s->m.point[p][2]);
  return VG_OK;
}

/* --- .vtu ----------------------------------------------------------------- */

/* Replace the vectors by a component, counted from 1, or by their lengths. */
static void reduce(double *value, size_t n, int components, int which)
{
  for (size_t i = 0; i < n; i++) {
    const double *v = value + (size_t)components * i;
    double sum = 0;

    for (int k = 0; k < components; k++) sum += v[k] * v[k];
    value[i] = which ? v[which - 1] : sqrt(sum);
  }
}

/* Keep the part of a field of n components that the name asks for. */
static vg_status take_part(const char *path, const char *name, size_t n_value,
                           int n, int part, double *value, struct vg_error *err)
{
  if ((part < 0 && n > 1) || part > n)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: '%s' has %d components; give one of them as NAME:1 to "
                   "NAME:%d, or the length as NAME:mag",
                   path, name, n, n);
  if (part >= 0) reduce(value, n_value, n, part);
  return VG_OK;
}

/* Part of NAME:PART: 0 for "mag", the number of a component, -1: none. */
static int part_of(const char *name, size_t *len)
{
  const char *colon = strrchr(name, ':');

  *len = colon ? (size_t)(colon - name) : strlen(name);
  if (!colon) return -1;
  if (!strcmp(colon, ":mag")) return 0;
  if (colon[1] >= '1' && colon[1] <= '9' && !colon[2]) return colon[1] - '0';
  *len = strlen(name);
  return -1;
}

vg_status vg_solution_no_array(const char *path, const char *name,
                               const char *option, struct vg_input *in,
                               struct vg_error *err)
{
  char point[NAMES], cell[NAMES];

  vg_vtu_array_names(in, "PointData", point, sizeof point);
  vg_vtu_array_names(in, "CellData", cell, sizeof cell);
  if (*name && vg_vtu_has_array(in, "CellData", name))
    return vg_fail(
      err, VG_ERR_INPUT,
      "%s: '%s' has values in the cells, but values at the points "
      "are needed: write point data, as foamToVTK does, or convert "
      "it with ParaView's filter Cell Data to Point Data",
      path, name);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: %s%s%s; its point arrays are: %s; its cell arrays are: "
                 "%s",
                 path, *name ? "there is no array '" : "give a field by ",
                 *name ? name : option, *name ? "'" : "",
                 *point ? point : "none", *cell ? cell : "none");
}

static int is_empty(struct vg_input *in)
{
  char point[16], cell[16];

  vg_vtu_array_names(in, "PointData", point, sizeof point);
  vg_vtu_array_names(in, "CellData", cell, sizeof cell);
  return !*point && !*cell;
}

/* Add a field whose values, [number of cells], are in the cells. */
static vg_status add_cell_field(const char *path, struct vg_solution *s,
                                const char *name, const double *cell,
                                struct vg_error *err)
{
  double *value = vg_alloc(s->m.n_point, sizeof *value);
  vg_status st = value ? vg_point_values(&s->m, cell, value, err)
                       : vg_fail_memory(err, "values at points");

  if (st >= 0) return add_field(path, s, name, value, err);
  free(value);
  return st;
}

/* Where the field is: at the points, or in the cells. */
static const char *section_of(struct vg_input *in, const char *name)
{
  return !vg_vtu_has_array(in, "PointData", name) &&
             vg_vtu_has_array(in, "CellData", name)
         ? "CellData"
         : "PointData";
}

static int has_array(struct vg_input *in, const char *name)
{
  return vg_vtu_has_array(in, section_of(in, name), name);
}

static vg_status read_array(const char *path, void *from, const char *name,
                            struct vg_solution *s, struct vg_error *err)
{
  struct vg_input *in = from;
  size_t len;
  int part = has_array(in, name) ? -1 : part_of(name, &len), n = 0;
  char *array = part < 0 ? strdup(name) : strndup(name, len);
  const char *section = array ? section_of(in, array) : "";
  struct vg_mesh m = VG_MESH_INIT;
  double *value = NULL;
  vg_status st = VG_OK;

  if (!array) return vg_fail_memory(err, "the name of a field");
  /* A file that cannot be read has no arrays: the reader says why. */
  st = vg_vtu_values_parse(in, section, array, &m, &n, &value, err);
  if (st == VG_ERR_FORMAT && !has_array(in, array) && !is_empty(in))
    st = vg_solution_no_array(path, name, "--field", in, err);
  free(array);
  if (st < 0) return st;
  if (s->n_field) vg_mesh_release(&m);
  else vg_mesh_move(&s->m, &m);
  st = take_part(path, name,
                 *section == 'P' ? s->m.n_point : vg_mesh_n_cell(&s->m), n,
                 part, value, err);
  if (st >= 0 && *section == 'P') return add_field(path, s, name, value, err);
  if (st >= 0) st = add_cell_field(path, s, name, value, err);
  free(value);
  return st;
}

/* --- .csv ----------------------------------------------------------------- */

static vg_status read_column(const char *path, void *from, const char *name,
                             struct vg_solution *s, struct vg_error *err)
{
  struct vg_input *in = from;
  struct vg_error inner = VG_ERROR_INIT;
  char names[NAMES];
  double *value = NULL;
  size_t n = 0;
  vg_status st = vg_csv_column(in, name, &n, &value, &inner);

  if (st == VG_ERR_FORMAT && strstr(inner.text, "column named")) {
    vg_csv_names(in, names, sizeof names);
    return vg_fail(err, st, "%s; its columns are: %s", inner.text, names);
  }
  if (st < 0) return vg_fail(err, st, "%s", inner.text);
  if (n == s->m.n_point) return add_field(path, s, name, value, err);
  free(value);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s has %zu lines of values, but %s has %zu points", path, n,
                 s->mesh, s->m.n_point);
}

/* Lines with numbers of points must be in their order. */
static vg_status check_numbers(const char *path, struct vg_input *in,
                               struct vg_error *err)
{
  struct vg_error none = VG_ERROR_INIT;
  double *id = NULL;
  size_t n = 0;
  vg_status st = vg_csv_column(in, "PointID", &n, &id, &none);

  if (st == VG_ERR_MEMORY) return vg_fail_memory(err, "numbers of points");
  st = VG_OK; /* a table need not have numbers */
  for (size_t p = 0; id && p < n && st >= 0; p++)
    if (id[p] != id[0] + (double)p || id[0] > 1)
      st = vg_fail(err, VG_ERR_INPUT,
                   "%s: line %zu has the PointID %g: the lines must be in the "
                   "order of the points, from 0 or 1; sort them",
                   path, p + 2, id[p]);
  free(id);
  return st;
}

/* Points of the table, if it has coordinates, must be those of the mesh. */
static vg_status compare_points(const char *path, struct vg_input *in,
                                const struct vg_solution *s,
                                struct vg_error *err)
{
  static const char *const axis[3] = { "x", "y", "z" };
  const double size = vg_mesh_length(&s->m);
  vg_status st = VG_OK;

  for (int k = 0; k < 3 && st >= 0; k++) {
    struct vg_error none = VG_ERROR_INIT;
    double *x = NULL;
    size_t n = 0;

    st = vg_csv_column(in, axis[k], &n, &x, &none);
    if (st == VG_ERR_MEMORY) return vg_fail_memory(err, "coordinates");
    st = VG_OK; /* a table need not have coordinates */
    for (size_t p = 0; x && p < n && p < s->m.n_point && st >= 0; p++)
      if (!(fabs(x[p] - s->m.point[p][k]) <= SAME_PLACE * size))
        st = vg_fail(err, VG_ERR_INPUT,
                     "%s: the %s of point %zu is %g, but %g in %s: the values "
                     "belong to another mesh, or the points are in another "
                     "order",
                     path, axis[k], p + 1, x[p], s->m.point[p][k], s->mesh);
    free(x);
  }
  return st;
}

static vg_status read_mesh(const char *path, struct vg_solution *s,
                           struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = vg_format_read(s->mesh, &s->m, &why);
  int is_known;

  if (st >= 0)
    st = vg_format_layer_tets(s->mesh, &is_known, &s->n_layer_tet, &why);
  if (st < 0)
    return vg_fail(err, st, "%s: the mesh of this solution cannot be read: %s",
                   path, why.text);
  if (!is_known || s->n_layer_tet > s->m.n_tet) s->n_layer_tet = 0;
  return VG_OK;
}

/* --- fields --------------------------------------------------------------- */

/* Reads a field; from: the file or case that the reader of the format opened.
 */
typedef vg_status read_field(const char *path, void *from, const char *name,
                             struct vg_solution *s, struct vg_error *err);

static vg_status read_fields(const char *path, void *from, const char *names,
                             read_field *read, struct vg_solution *s,
                             struct vg_error *err)
{
  char *list = strdup(names ? names : ""), *rest = list, *name;
  vg_status st = VG_OK;

  if (!list) return vg_fail_memory(err, "the names of fields");
  if (!*list) st = read(path, from, "", s, err);
  while (st >= 0 && *list && (name = strsep(&rest, ","))) {
    if (s->n_field == VG_SOLUTION_FIELDS)
      st = vg_fail(err, VG_ERR_INPUT, "--field: more than %d fields",
                   VG_SOLUTION_FIELDS);
    else if (!*name)
      st = vg_fail(err, VG_ERR_INPUT, "--field: an empty name in '%s'", names);
    else st = read(path, from, name, s, err);
  }
  free(list);
  return st;
}

static vg_status read_sol(const char *path, const char *names,
                          struct vg_solution *s, struct vg_error *err)
{
  int components = 0;
  double *value = NULL;
  size_t n = 0;
  vg_status st;

  if (names && *names)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the fields of a .sol have no names; omit --field",
                   path);
  VG_TRY(vg_sizes_find_mesh(path, &s->mesh, err));
  VG_TRY(vg_sol_read(path, &n, &components, &value, err));
  VG_TRY(read_mesh(path, s, err));
  if (components != 1)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s has a tensor at each point; a solution is a scalar (kind "
                 "1)",
                 path);
  else if (n != s->m.n_point)
    st = vg_fail(err, VG_ERR_INPUT, "%s has %zu values, but %s has %zu points",
                 path, n, s->mesh, s->m.n_point);
  if (st < 0) goto done;
  st = add_field(path, s, "solution", value, err);
  value = NULL;
done:
  free(value);
  return st;
}

static vg_status read_csv(const char *path, const char *names, const char *mesh,
                          struct vg_solution *s, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  char list[NAMES];
  vg_status st;

  if (!mesh)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s has no cells: give the mesh of its points by --mesh",
                   path);
  s->mesh = strdup(mesh);
  if (!s->mesh) return vg_fail_memory(err, "a file name");
  VG_TRY(vg_input_open(path, &in, err));
  if (!names || !*names) {
    vg_csv_names(&in, list, sizeof list);
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: give a field by --field; its columns are: %s", path,
                 list);
    goto done;
  }
  VG_TRY(read_mesh(path, s, err));
  VG_TRY(read_fields(path, &in, names, read_column, s, err));
  VG_TRY(check_numbers(path, &in, err));
  st = compare_points(path, &in, s, err);
done:
  vg_input_release(&in);
  return st;
}

/* --- CGNS ------------------------------------------------------------------
 */

static vg_status read_cgns_array(const char *path, void *from, const char *name,
                                 struct vg_solution *s, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  double *value = NULL;
  vg_status st = vg_cgns_solution_parse(from, name, &m, &value, err);

  if (st < 0) return st;
  if (s->n_field) vg_mesh_release(&m);
  else vg_mesh_move(&s->m, &m);
  return add_field(path, s, name, value, err);
}

/* --- OpenFOAM ------------------------------------------------------------- */

static vg_status read_volume_field(const char *path, void *from,
                                   const char *name, struct vg_solution *s,
                                   struct vg_error *err)
{
  size_t len;
  int part = part_of(name, &len), n;
  char *file = strndup(name, len);
  double *cell = NULL;
  vg_status st;

  if (!file) return vg_fail_memory(err, "the name of a field");
  VG_TRY(vg_foam_field_read(from, file, &n, &cell, err));
  VG_TRY(take_part(path, name, vg_mesh_n_cell(&s->m), n, part, cell, err));
  st = add_cell_field(path, s, name, cell, err);
done:
  free(file);
  free(cell);
  return st;
}

static vg_status read_case(const char *path, const char *names,
                           struct vg_solution *s, struct vg_error *err)
{
  struct vg_foam_case c = VG_FOAM_CASE_INIT;
  vg_status st;

  VG_TRY(vg_foam_case_read(path, &c, err));
  vg_mesh_move(&s->m, &c.m);
  st = read_fields(path, &c, names, read_volume_field, s, err);
done:
  vg_foam_case_release(&c);
  return st;
}

vg_status vg_solution_read(const char *path, const char *names,
                           const char *mesh, struct vg_solution *s,
                           struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  struct stat about;
  vg_status st;

  if (vg_text_ends(path, ".csv")) return read_csv(path, names, mesh, s, err);
  if (mesh)
    return vg_fail(
      err, VG_ERR_INPUT,
      "--mesh is for a .csv; the mesh of %s is in the file or next "
      "to it",
      path);
  if (vg_foam_is_case(path)) return read_case(path, names, s, err);
  if (!stat(path, &about) && S_ISDIR(about.st_mode))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: this folder is neither an OpenFOAM case with a mesh in "
                   "constant/polyMesh nor one of its times; the parts of a "
                   "decomposed case are joined by reconstructPar",
                   path);
  if (vg_text_ends(path, ".sol") || vg_text_ends(path, ".solb"))
    return read_sol(path, names, s, err);
  if (!vg_text_ends(path, ".vtu") && !vg_text_ends(path, ".cgns"))
    return vg_fail(
      err, VG_ERR_INPUT,
      "%s: a solution is read from VTK's .vtu, .cgns, the folder "
      "of an OpenFOAM case, Medit's .sol or .solb next to a mesh, or a "
      ".csv with --mesh",
      path);
  VG_TRY(vg_input_open(path, &in, err));
  st = read_fields(path, &in, names,
                   vg_text_ends(path, ".cgns") ? read_cgns_array : read_array,
                   s, err);
done:
  vg_input_release(&in);
  return st;
}
