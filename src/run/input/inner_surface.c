/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces: patches with fluid on both sides. They are taken out of the
 * surface before it is checked and closed, and put back, doubled, when it
 * bounds a fluid. */
#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"
#include "core/mesh/edges.h"
#include "core/sides/inner.h"
#include "run/input/shape_parts.h"
#include "run/input/zone_table.h"
#include "run/settings/patch_names.h"
#include "run/settings/plan_options.h"

/* --- out of the surface ----------------------------------------------------
 */

/* Settings that change triangles or points of the surface, so that sheets would
 * no longer share edges with it. */
static vg_status refuse_changes(const struct vg_boundary *b,
                                struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const char *what = s->weld > 0                  ? "weld"
                   : s->wrap > 0                  ? "wrap"
                   : s->swap == VG_ANSWER_YES     ? "surface_swap"
                   : strcmp(s->mesher, "builtin") ? "mesher"
                   : vg_boundary_is_stretched(b)  ? "stretched sizes"
                                                  : NULL;
  char from[VG_INNER_SOURCE];

  if (!what) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: inner surfaces (%s) cannot be combined with %s; "
                 "change that setting, and mesh a surface that has the "
                 "requested triangles already",
                 b->read->files.stem, vg_inner_source(s, from, sizeof from),
                 what);
}

static vg_status refuse_all(const struct vg_boundary *b, struct vg_error *err)
{
  char from[VG_INNER_SOURCE];

  return vg_fail(err, VG_ERR_INPUT,
                 "%s: all triangles are in inner surfaces (%s), so "
                 "that no surface bounds the fluid; add an outer boundary to "
                 "the surface, or remove patches from the list",
                 b->read->files.stem,
                 vg_inner_source(&b->read->settings, from, sizeof from));
}

static int has_name(const struct vg_mesh *m, const char *name)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (!strcmp(m->patch[i].name, name)) return 1;
  return 0;
}

/* NAME_back, or NAME_back_ID if another patch has this name. */
static void name_back(const struct vg_mesh *m, const char *front, int32_t id,
                      char name[VG_NAME_MAX])
{
  snprintf(name, VG_NAME_MAX, "%.*s_back", VG_NAME_MAX - 6, front);
  for (int64_t n = id; has_name(m, name); n++)
    snprintf(name, VG_NAME_MAX, "%.*s_back_%" PRId64, VG_NAME_MAX - 27, front,
             n);
}

/* Adds a patch for the other side of patch i, with a new number and the same
 * conditions. That of a sheet exists only until the mesh is complete. */
static vg_status add_back(struct vg_boundary *b, size_t i, int role,
                          struct vg_error *err)
{
  struct vg_mesh *m = &b->surface;
  struct vg_patch *back;
  char name[VG_NAME_MAX] = "";
  const int32_t id = vg_mesh_last_id(m);
  size_t at;

  if (id == INT32_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "no number is left for the back of patch %d; renumber the "
                   "patches",
                   (int)m->patch[i].id);
  if (*m->patch[i].name) name_back(m, m->patch[i].name, id + 1, name);
  at = vg_mesh_add_patch(m, id + 1, name);
  if (at == SIZE_MAX) return vg_fail_memory(err, "the patches");
  back = &m->patch[at];
  back->bc = m->patch[i].bc;
  back->bc_fun3d = m->patch[i].bc_fun3d;
  back->family = m->patch[i].family;
  m->patch[i].inner = VG_INNER_FRONT;
  back->inner = VG_INNER_BACK;
  m->patch[i].is_sheet = back->is_sheet = role >= VG_PATCH_SHEET;
  m->patch[i].is_interface = back->is_interface = role == VG_PATCH_INTERFACE;
  m->patch[i].is_split = back->is_split = role >= VG_PATCH_SHEET;
  return VG_OK;
}

/* Backs of baffles first: their numbers do not depend on sheets. */
static vg_status add_backs(struct vg_boundary *b, size_t n, const uint8_t *role,
                           struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int r = 0; r < 2; r++)
    for (size_t i = 0; i < n && st >= 0; i++)
      if (role[i] && (role[i] >= VG_PATCH_SHEET) == r)
        st = add_back(b, i, role[i], err);
  return st;
}

static void note_role(const struct vg_boundary *b, size_t i)
{
  const struct vg_mesh *m = &b->surface;
  const struct vg_patch *back = &m->patch[i], *p;
  const char *space;

  p = &m->patch[vg_mesh_front_patch(m, i)];
  space = *p->name ? " " : "";
  if (!p->is_sheet)
    vg_note(
      b->notes,
      "patch %d%s%s is an inner surface (baffles); its back is patch %d%s%s",
      (int)p->id, space, p->name, (int)back->id, space, back->name);
  else if (!p->is_split)
    vg_note(b->notes,
            "patch %d%s%s is %s: its triangles are faces between cells",
            (int)p->id, space, p->name,
            p->is_interface ? "an interface" : "a sheet");
  else
    vg_note(b->notes,
            "patch %d%s%s is %s with layers: its triangles are faces between "
            "cells, and patch %d%s%s stands for its back in lists and tables",
            (int)p->id, space, p->name,
            p->is_interface ? "an interface" : "a sheet", (int)back->id, space,
            back->name);
}

/* Drops the points of m that only triangles of `inner` have. Other points that
 * no triangle has are those of the input, which the check reports. */
static vg_status drop_points(struct vg_mesh *m, const struct vg_mesh *inner,
                             struct vg_error *err)
{
  uint8_t *keep = vg_alloc(m->n_point, 1);
  uint32_t *to = vg_alloc(m->n_point, sizeof *to);
  size_t n = 0;

  if (!keep || !to) {
    free(keep);
    free(to);
    return vg_fail_memory(err, "the inner surfaces");
  }
  memset(keep, 1, m->n_point);
  for (size_t t = 0; t < 3 * inner->n_tri; t++)
    keep[inner->tri[t / 3][t % 3]] = 0;
  for (size_t t = 0; t < 3 * m->n_tri; t++) keep[m->tri[t / 3][t % 3]] = 1;
  for (size_t p = 0; p < m->n_point; p++) {
    if (keep[p]) memmove(m->point[n], m->point[p], sizeof *m->point);
    to[p] = (uint32_t)n;
    n += keep[p];
  }
  for (size_t t = 0; t < 3 * m->n_tri; t++)
    m->tri[t / 3][t % 3] = to[m->tri[t / 3][t % 3]];
  m->n_point = n;
  free(keep);
  free(to);
  return VG_OK;
}

/* Moves the triangles of inner patches to `inner`, with copies of all points.
 */
static vg_status split_off(struct vg_mesh *m, struct vg_mesh *inner,
                           struct vg_error *err)
{
  size_t n = 0;

  inner->tri = vg_alloc(m->n_tri, sizeof *inner->tri);
  inner->tri_patch = vg_alloc(m->n_tri, sizeof *inner->tri_patch);
  inner->point = vg_alloc(m->n_point, sizeof *inner->point);
  if (!inner->tri || !inner->tri_patch || !inner->point)
    return vg_fail_memory(err, "the inner surfaces");
  if (m->n_point) memcpy(inner->point, m->point, m->n_point * sizeof *m->point);
  inner->n_point = m->n_point;
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t patch = m->tri_patch[t];
    struct vg_mesh *to = m->patch[patch].inner ? inner : m;
    const size_t at = to == m ? n++ : inner->n_tri++;

    memmove(to->tri[at], m->tri[t], sizeof *m->tri);
    to->tri_patch[at] = patch;
  }
  m->n_tri = n;
  return drop_points(m, inner, err);
}

vg_status vg_boundary_take_inner(struct vg_boundary *b, struct vg_settings *s,
                                 struct vg_error *err)
{
  struct vg_mesh *m = &b->surface;
  const size_t n_patch = m->n_patch;
  uint8_t *role = vg_calloc(n_patch, 1);
  vg_status st = VG_OK;

  if (!role) return vg_fail_memory(err, "the patches");
  VG_TRY(refuse_changes(b, err));
  VG_TRY(vg_inner_roles(&b->read->settings, m, role, err));
  VG_TRY(add_backs(b, n_patch, role, err));
  VG_TRY(vg_patch_rows_resolve(s, m, err));
  VG_TRY(vg_inner_split(s, m, err));
  for (size_t i = n_patch; i < m->n_patch; i++) note_role(b, i);
  VG_TRY(split_off(m, &b->inner, err));
  if (!m->n_tri) VG_TRY(refuse_all(b, err));
  vg_note(
    b->notes,
    "the figures of the surface do not include the %zu triangles of inner "
    "surfaces, which are checked when the surface is closed",
    b->inner.n_tri);
done:
  free(role);
  return st;
}

/* --- suggested -------------------------------------------------------------
 */

/* Whether the triangles that are not marked close the surface. */
static int is_closed_without(const struct vg_mesh *m, const uint8_t *is_sheet)
{
  struct vg_edges e = VG_EDGES_INIT;
  struct vg_error why = VG_ERROR_INIT;
  int is_closed;

  if (vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                     is_sheet, 1, &why) < 0)
    return 0;
  is_closed = e.n > 0;
  for (size_t i = 0; i < e.n; i++)
    is_closed &= e.start[i + 1] - e.start[i] == 2;
  vg_edges_release(&e);
  return is_closed;
}

/* The numbers of the marked patches, "" if they are too many for a message. */
static void list_sheets(const struct vg_mesh *m, const uint8_t *on, char *list,
                        size_t size)
{
  size_t n = 0;

  *list = 0;
  for (size_t i = 0; i < m->n_patch && n < size; i++)
    if (on[i])
      n += (size_t)snprintf(list + n, size - n, "%s%d", n ? "," : "",
                            (int)m->patch[i].id);
  if (n >= size) *list = 0;
}

int vg_boundary_suggest_inner(const struct vg_boundary *b, char *text,
                              size_t size)
{
  const struct vg_mesh *m = &b->surface;
  const struct vg_surface_report *r = &b->check;
  uint8_t *on = vg_calloc(m->n_patch, 1), *is_sheet = vg_calloc(m->n_tri, 1);
  const struct vg_settings *s = &b->read->settings;
  const int has_list = *s->baffles || *s->sheets || *s->zone_interfaces;
  char list[48] = "";

  for (size_t i = 0; on && i < r->n_defect; i++)
    if (r->defect[i].kind == VG_DEFECT_OPEN_EDGE)
      on[m->tri_patch[r->defect[i].face[0]]] = 1;
  for (size_t t = 0; on && is_sheet && t < m->n_tri; t++)
    is_sheet[t] = on[m->tri_patch[t]];
  if (on && is_sheet && r->count[VG_DEFECT_OPEN_EDGE] &&
      is_closed_without(m, is_sheet))
    list_sheets(m, on, list, sizeof list);
  free(on);
  free(is_sheet);
  if (*list)
    snprintf(text, size,
             has_list ? "; if fluid is on both sides of its open sheets, add "
                        "%s to --baffles, --sheets or --zone-interfaces"
                      : "; if fluid is on both sides of its open sheets, give "
                        "--baffles %s (or --sheets, or --zone-interfaces "
                        "where it separates zones)",
             list);
  return *list != 0;
}

void vg_boundary_name_inner(const struct vg_boundary *b, char *text,
                            size_t size)
{
  const struct vg_mesh *m = &b->surface;
  char list[120] = "";
  size_t n = 0;

  *text = 0;
  for (size_t i = 0; i < m->n_patch && n < sizeof list; i++)
    if (m->patch[i].inner == VG_INNER_FRONT)
      n += (size_t)snprintf(list + n, sizeof list - n, "%s%d%s%.24s",
                            n ? ", " : "", (int)m->patch[i].id,
                            *m->patch[i].name ? " " : "", m->patch[i].name);
  if (n)
    snprintf(text, size,
             ". These patches are inner surfaces and close nothing: %s%s; if "
             "one of them bounds the fluid, remove it from the list of "
             "baffles, sheets or zone_interfaces",
             list, n < sizeof list ? "" : "...");
}

/* --- check -----------------------------------------------------------------
 */

vg_status vg_boundary_with_inner(const struct vg_boundary *b,
                                 struct vg_mesh *out, struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface, *inner = &b->inner;
  const size_t n_point = m->n_point + inner->n_point;
  const size_t n_tri = m->n_tri + inner->n_tri;
  size_t cap[3] = { m->n_point, m->n_tri, m->n_tri };
  vg_status st;

  VG_TRY(vg_mesh_copy(out, m, err));
  if (vg_reserve(&out->point, &cap[0], n_point, sizeof *out->point) ||
      vg_reserve(&out->tri, &cap[1], n_tri, sizeof *out->tri) ||
      vg_reserve(&out->tri_patch, &cap[2], n_tri, sizeof *out->tri_patch))
    return vg_fail_memory(err, "the inner surfaces");
  memcpy(out->point + m->n_point, inner->point,
         inner->n_point * sizeof *inner->point);
  for (size_t t = 0; t < inner->n_tri; t++) {
    for (int k = 0; k < 3; k++)
      out->tri[m->n_tri + t][k] = (uint32_t)m->n_point + inner->tri[t][k];
    out->tri_patch[m->n_tri + t] = inner->tri_patch[t];
  }
  out->n_point = n_point;
  out->n_tri = n_tri;
  st = vg_surface_merge_points(out, err);
done:
  return st;
}

/* Findings that are not defects of inner surfaces: free edges, edges of three
 * and more triangles, any orientation. The surface without them has no defects,
 * and its conditions and shells are known. */
static int is_legal(const struct vg_defect *d, size_t n_wall)
{
  switch (d->kind) {
  case VG_DEFECT_OPEN_EDGE:
  case VG_DEFECT_ORIENTATION: return d->face[0] >= n_wall;
  case VG_DEFECT_NONMANIFOLD_EDGE:
  case VG_DEFECT_SHELL:
  case VG_DEFECT_NO_BC: return 1;
  default: return 0;
  }
}

static void drop_legal(struct vg_surface_report *r, size_t n_wall, size_t n_tri)
{
  size_t n = 0;

  memset(r->face_kinds, 0, n_tri * sizeof *r->face_kinds);
  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];

    if (is_legal(d, n_wall)) {
      r->count[d->kind]--;
      continue;
    }
    for (int k = 0; k < 2; k++)
      if (d->face[k] != SIZE_MAX) r->face_kinds[d->face[k]] |= 1u << d->kind;
    r->defect[n++] = *d;
  }
  r->n_defect = n;
}

struct vg_surface_check_options vg_inner_check_options(
  const struct vg_boundary *b, struct vg_display *show)
{
  struct vg_surface_check_options o = vg_options_check(&b->read->settings);

  o.repair = 0;
  o.require_bc = 0;
  o.external = -1;
  o.threads = b->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return o;
}

/* Checks surface and inner surfaces together. Only if there are defects, do
 * they replace surface and check of b, for reports. */
static vg_status check_together(struct vg_boundary *b, struct vg_mesh *all,
                                struct vg_display *show, struct vg_error *err)
{
  struct vg_surface_check_options o = vg_inner_check_options(b, show);
  struct vg_surface_report r = { .n_defect = 0 };
  const size_t n_wall = b->surface.n_tri;
  vg_status st;

  VG_TRY(vg_surface_check(all, &o, &r, err));
  drop_legal(&r, n_wall, all->n_tri);
  if (!r.n_defect) goto done;
  vg_surface_report_release(&b->check);
  b->check = r;
  r = (struct vg_surface_report){ .n_defect = 0 };
  vg_mesh_move(&b->surface, all);
done:
  vg_surface_report_release(&r);
  return st;
}

/* --- into the boundary ------------------------------------------------------
 */

/* The check of the boundary also has the triangles that were added. */
static vg_status extend_check(struct vg_surface_report *r, size_t from,
                              size_t to, struct vg_error *err)
{
  uint32_t *kinds = vg_realloc(r->face_kinds, to, sizeof *kinds), *shell;

  if (kinds) r->face_kinds = kinds;
  shell = vg_realloc(r->tri_shell, to, sizeof *shell);
  if (shell) r->tri_shell = shell;
  if (!kinds || !shell) return vg_fail_memory(err, "the surface check");
  for (size_t t = from; t < to; t++) {
    kinds[t] = 0;
    shell[t] = UINT32_MAX;
  }
  return VG_OK;
}

static vg_status put_sides(struct vg_boundary *b, struct vg_mesh *all,
                           struct vg_error *err)
{
  const size_t n_patch = all->n_patch;
  uint8_t *is_inner = vg_calloc(n_patch, 1);
  uint32_t *back = vg_calloc(n_patch, sizeof *back);
  struct vg_inner_report r;
  vg_status st = is_inner && back ? VG_OK : vg_fail_memory(err, "the patches");

  VG_TRY(st);
  for (size_t i = 0; i < n_patch; i++) {
    is_inner[i] = all->patch[i].inner == VG_INNER_FRONT;
    if (all->patch[i].inner == VG_INNER_BACK)
      back[vg_mesh_front_patch(all, i)] = (uint32_t)i;
  }
  VG_TRY(vg_inner_double(all, is_inner, back, &r, err));
  VG_TRY(extend_check(&b->check, b->surface.n_tri, all->n_tri, err));
  vg_mesh_move(&b->surface, all);
  vg_note(b->notes,
          "inner surfaces: %zu triangles with fluid on both sides; %zu copies "
          "of points were added",
          r.n_tri, r.n_point);
  if (r.n_turned)
    vg_note(b->notes, VG_INNER_TURNED, r.n_turned, r.turned_at[0],
            r.turned_at[1], r.turned_at[2]);
  if (r.n_cut)
    vg_note(b->notes,
            "%zu edges of inner surfaces were cut, because triangles or edges "
            "between free edges would have the same points on both sides",
            r.n_cut);
  if (r.n_sealed)
    vg_note(b->notes,
            "regions of the fluid that inner surfaces seal off from the rest: "
            "%zu; all are meshed, and no fluid passes between them",
            r.n_sealed);
  if (r.n_near)
    vg_note(b->notes,
            "gaps next to inner surfaces that are narrower than 1e-3 of the "
            "edges: %zu pairs of triangles, the narrowest %.3g wide near "
            "(%g, %g, %g); cells in them are flat",
            r.n_near, r.gap, r.at[0], r.at[1], r.at[2]);
  st = vg_boundary_add_zones(b, err);
done:
  free(is_inner);
  free(back);
  return st;
}

vg_status vg_boundary_put_inner(struct vg_boundary *b, struct vg_display *show,
                                struct vg_error *err)
{
  struct vg_mesh all = VG_MESH_INIT;
  struct vg_error why = VG_ERROR_INIT;
  vg_status st;

  assert(b->inner.n_tri);
  vg_display_update(show, "inner surfaces", b->inner.n_tri, 0);
  VG_TRY(vg_boundary_with_inner(b, &all, err));
  VG_TRY(check_together(b, &all, show, err));
  if (b->check.n_defect) goto done;
  st = put_sides(b, &all, &why);
  if (st < 0) st = vg_fail(err, st, "%s: %s", b->read->files.stem, why.text);
  else vg_mesh_release(&b->inner);
done:
  vg_mesh_release(&all);
  return st;
}
