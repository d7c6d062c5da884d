/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A solution at the points of a CGNS file: an array of a FlowSolution_t. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/cgns/cgns_read.h"
#include "io/cgns/cgns_tree.h"

enum { NAMES = 1000 };

struct search {
  struct vg_input *in;
  struct vg_cgns_tree *tree;
  const char *name;
  char names[NAMES]; /* arrays at points */
  int is_elsewhere;  /* an array of this name has its values elsewhere */
  size_t n_point;    /* of the mesh */
  size_t n;          /* values found */
  double *value;
};

static void add_name(char names[NAMES], const char *name)
{
  const size_t n = strlen(names);

  snprintf(names + n, NAMES - n, "%s%s", n ? ", " : "", name);
}

/* Where the values of a solution are; "Vertex" is the default. */
static vg_status location(struct search *s, int64_t id, char out[VG_CGNS_NAME],
                          struct vg_error *err)
{
  struct vg_cgns_node *list = NULL;
  char *text = NULL;
  size_t n, len;
  vg_status st = vg_cgns_tree_children(s->tree, id, "GridLocation_t", &list, &n,
                                       err);

  snprintf(out, VG_CGNS_NAME, "Vertex");
  if (st >= 0 && n)
    st = vg_cgns_tree_text(s->tree, list[0].id, list[0].name, &text, &len, err);
  if (text) snprintf(out, VG_CGNS_NAME, "%s", text);
  free(text);
  free(list);
  return st;
}

/* The array of the last solution that has it. */
static vg_status search_solution(struct search *s,
                                 const struct vg_cgns_node *solution,
                                 struct vg_error *err)
{
  struct vg_cgns_node *list = NULL;
  char at[VG_CGNS_NAME];
  size_t n = 0;
  int is_vertex;
  vg_status st;

  VG_TRY(location(s, solution->id, at, err));
  is_vertex = !strcmp(at, "Vertex");
  VG_TRY(vg_cgns_tree_children(s->tree, solution->id, "DataArray_t", &list, &n,
                               err));
  for (size_t i = 0; i < n; i++) {
    const int is_it = !strcmp(list[i].name, s->name);

    if (is_vertex) add_name(s->names, list[i].name);
    else s->is_elsewhere |= is_it;
    if (!is_vertex || !is_it) continue;
    free(s->value);
    s->value = NULL;
    VG_TRY(
      vg_cgns_tree_reals(s->tree, list[i].id, s->name, &s->value, &s->n, err));
  }
done:
  free(list);
  return st;
}

/* The only zone below the root. */
static vg_status find_zone(struct search *s, int64_t root, int64_t *zone,
                           struct vg_error *err)
{
  struct vg_cgns_node *base = NULL, *list = NULL;
  size_t n_base = 0, n = 0, n_zone = 0;
  vg_status st;

  VG_TRY(
    vg_cgns_tree_children(s->tree, root, "CGNSBase_t", &base, &n_base, err));
  for (size_t b = 0; b < n_base; b++) {
    VG_TRY(
      vg_cgns_tree_children(s->tree, base[b].id, "Zone_t", &list, &n, err));
    if (n) *zone = list[0].id;
    n_zone += n;
    free(list);
    list = NULL;
  }
  if (n_zone != 1)
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s has %zu zones; a solution is read from a file with one "
                 "zone",
                 s->in->path, n_zone);
done:
  free(base);
  free(list);
  return st;
}

static vg_status check_values(const struct search *s, struct vg_error *err)
{
  if (!s->value && s->is_elsewhere)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: '%s' is not at the points; write the solution with the "
                   "grid location Vertex",
                   s->in->path, s->name);
  if (!s->value)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: %s%s%s; its arrays at the points are: %s", s->in->path,
                   *s->name ? "there is no array '" : "give a field by --field",
                   s->name, *s->name ? "'" : "", *s->names ? s->names : "none");
  if (s->n == s->n_point) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: '%s' has %zu values, but there are %zu points (rind "
                 "points are not read)",
                 s->in->path, s->name, s->n, s->n_point);
}

vg_status vg_cgns_take_solution(struct vg_input *in, const char *name,
                                size_t n_point, double **value,
                                struct vg_error *err)
{
  struct search s = { .in = in, .name = name, .n_point = n_point };
  struct vg_cgns_node *list = NULL;
  int64_t root, zone = -1;
  size_t n = 0;
  vg_status st = vg_cgns_tree_open(in, &s.tree, &root, err);

  if (st < 0) return st;
  VG_TRY(find_zone(&s, root, &zone, err));
  VG_TRY(vg_cgns_tree_children(s.tree, zone, "FlowSolution_t", &list, &n, err));
  for (size_t i = 0; i < n; i++) VG_TRY(search_solution(&s, &list[i], err));
  VG_TRY(check_values(&s, err));
  *value = s.value;
  s.value = NULL;
done:
  free(s.value);
  free(list);
  vg_cgns_tree_close(s.tree, NULL);
  return st;
}
