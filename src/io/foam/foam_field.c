/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/foam/foam_read.h"
#include "io/foam/foam_text.h"

enum { NAMES = 1000, MOST_COMPONENTS = 9 };

/* Components of volScalarField or List<scalar>; 0: not a field in the cells. */
static int components_of(const char *name, const char *before,
                         const char *after, int is_upper)
{
  static const struct {
    const char *lower, *upper;
    int n;
  } kind[] = { { "scalar", "Scalar", 1 },
               { "vector", "Vector", 3 },
               { "symmTensor", "SymmTensor", 6 },
               { "tensor", "Tensor", 9 } };
  char text[64];

  for (size_t i = 0; i < sizeof kind / sizeof *kind; i++) {
    snprintf(text, sizeof text, "%s%s%s", before,
             is_upper ? kind[i].upper : kind[i].lower, after);
    if (!strcmp(name, text)) return kind[i].n;
  }
  return 0;
}

/* uniform V, or nonuniform List<TYPE> N (...). */
static vg_status internal_field(struct vg_foam_text *f, size_t n_cell, int n,
                                double **value, struct vg_error *err)
{
  const char *text;
  char type[64];
  size_t len, count = 0;
  double one[MOST_COMPONENTS];
  vg_status st = VG_OK;

  if (!vg_foam_token(f, &text, &len))
    return vg_input_fail(&f->in, err, "internalField has no value");
  if (vg_token_is(text, len, "nonuniform")) {
    if (!vg_foam_token(f, &text, &len)) len = 0;
    snprintf(type, sizeof type, "%.*s", (int)(len < 60 ? len : 60), text);
    if (components_of(type, "List<", ">", 0) != n)
      return vg_input_fail(&f->in, err, "a list of the type '%s' in a %s", type,
                           f->class_name);
    st = vg_foam_reals(f, "values", n, n_cell, &count, value, err);
    if (st < 0 || count == n_cell) return st;
    free(*value);
    *value = NULL;
    return vg_input_fail(&f->in, err, "%zu values, but the mesh has %zu cells",
                         count, n_cell);
  }
  if (!vg_token_is(text, len, "uniform"))
    return vg_input_fail(&f->in, err,
                         "internalField is neither uniform nor nonuniform");
  VG_TRY(vg_foam_item(f, "the uniform value", n, one, err));
  *value = vg_alloc(n_cell, (size_t)n * sizeof **value);
  if (!*value) return vg_fail_memory(err, "a field");
  for (size_t i = 0; i < n_cell * (size_t)n; i++)
    (*value)[i] = one[i % (size_t)n];
done:
  return st;
}

static vg_status parse_field(struct vg_foam_text *f, size_t n_cell,
                             int *components, double **value,
                             struct vg_error *err)
{
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  *components = components_of(f->class_name, "vol", "Field", 1);
  if (!*components)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s is a %s; fields in the cells are volScalarField, "
                   "volVectorField, volSymmTensorField and volTensorField",
                   f->in.path, f->class_name);
  while (vg_foam_token(f, &text, &len)) {
    if (vg_token_is(text, len, "internalField"))
      return internal_field(f, n_cell, *components, value, err);
    if (*text == '#') /* a directive takes its line */
      vg_input_line(&f->in, &text, &len);
    else VG_TRY(vg_foam_skip_value(f, err));
  }
  st = vg_input_fail(&f->in, err, "there is no internalField");
done:
  return st;
}

vg_status vg_foam_field_parse(struct vg_input *in, size_t n_cell,
                              int *components, double **value,
                              struct vg_error *err)
{
  struct vg_foam_text f = { .in = *in };
  vg_status st = vg_foam_text_head(&f, err);

  *value = NULL;
  if (st >= 0) st = parse_field(&f, n_cell, components, value, err);
  *in = f.in;
  return st;
}

/* --- the folder of a time ------------------------------------------------- */

static int by_name(const struct dirent **a, const struct dirent **b)
{
  return strcmp((*a)->d_name, (*b)->d_name);
}

static int is_plain(const struct dirent *d)
{
  return d->d_name[0] != '.' && d->d_type != DT_DIR;
}

static vg_status no_field(const char *folder, const char *name,
                          struct vg_error *err)
{
  struct dirent **list = NULL;
  int n = scandir(folder, &list, is_plain, by_name);
  char names[NAMES] = "";
  size_t len = 0;

  for (int i = 0; i < n; i++) {
    if (len < sizeof names)
      len += (size_t)snprintf(names + len, sizeof names - len, "%s%s",
                              len ? ", " : "", list[i]->d_name);
    free(list[i]);
  }
  free(list);
  return vg_fail(err, VG_ERR_INPUT, "%s: %s%s%s; its files are: %s", folder,
                 *name ? "there is no field '" : "give a field by --field",
                 name, *name ? "'" : "", *names ? names : "none");
}

/* Values in the order of the cells of the mesh. */
static vg_status sort_values(const struct vg_foam_case *c, size_t width,
                             double **value, struct vg_error *err)
{
  double *sorted = vg_alloc(c->n_cell, width * sizeof *sorted);

  if (!sorted) return vg_fail_memory(err, "a field");
  for (size_t i = 0; i < c->n_cell; i++)
    memcpy(sorted + width * c->cell[i], *value + width * i,
           width * sizeof *sorted);
  free(*value);
  *value = sorted;
  return VG_OK;
}

vg_status vg_foam_field_read(const struct vg_foam_case *c, const char *name,
                             int *components, double **value,
                             struct vg_error *err)
{
  struct vg_foam_text f = VG_FOAM_TEXT_INIT;
  char *path;
  int has = 0;
  vg_status st = VG_OK;

  *value = NULL;
  if (!*c->time)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s has no folder of a time (0, 0.5, 100, ...)", c->folder);
  path = vg_foam_find_file(c->time, name, &has);
  if (!path) return vg_fail_memory(err, "a file name");
  free(path);
  if (!*name || !has) return no_field(c->time, name, err);
  VG_TRY(vg_foam_text_open(c->time, name, &f, err));
  VG_TRY(parse_field(&f, c->n_cell, components, value, err));
  st = sort_values(c, (size_t)*components, value, err);
done:
  if (st < 0) {
    free(*value);
    *value = NULL;
  }
  vg_foam_text_release(&f);
  return st;
}
