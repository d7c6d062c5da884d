/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/wakes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/flow/flow.h"
#include "core/geometry/vector.h"
#include "core/wake/wake_sheet.h"
#include "io/stream/convention.h"
#include "run/input/cones.h"
#include "run/input/shape_parts.h"
#include "run/settings/patch_names.h"
#include "run/settings/wake_table.h"

/* W4: extents along y and z with a smaller ratio do not tell which axis points
 * up. */
#define FLAT 1.25

/* Most lines across one wake at each station. */
#define MOST_PROBES 64

static const double stations[VG_WAKE_STATIONS] = VG_WAKE_STATION_CHORDS;

/* The body whose trailing edges are searched, and the current row. */
struct body {
  struct vg_read *read;
  struct vg_mesh m;      /* copy of the surface, points merged */
  uint8_t *is_body, *on; /* [n_patch] owned */
  struct vg_trailing edges;
  const struct vg_wake_row *row;
  size_t number; /* of the row, from 1 */
  struct vg_wake wake;
  struct vg_wake_panels panels;
  double n_cell; /* expected of all rows so far */
  size_t n_flow;
  double flow[VG_WAKE_ANGLES * VG_WAKE_ANGLES][3];
};

/* Zone interfaces are walls of a body where a zone is solid or has no cells. */
static int has_bodies_as_zones(const struct vg_settings *s)
{
  for (size_t i = 0; i < s->n_zone; i++)
    if (s->zone[i].kind == VG_ZONE_SOLID || s->zone[i].mesh == VG_ANSWER_NO)
      return 1;
  return 0;
}

/* Inner surfaces are no sides of the body, also where they are attached to its
 * trailing edge. */
static vg_status drop_inner(struct body *b, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const int keeps_interfaces = has_bodies_as_zones(s);
  struct vg_mesh *m = &b->m;
  uint8_t *role = vg_alloc(m->n_patch, 1);
  size_t n = 0;
  vg_status st;

  if (!role) return vg_fail_memory(err, "the patches");
  VG_TRY(vg_inner_roles(s, m, role, err));
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t patch = m->tri_patch[t];

    if (role[patch] == VG_PATCH_BAFFLE || role[patch] == VG_PATCH_SHEET ||
        (role[patch] == VG_PATCH_INTERFACE && !keeps_interfaces))
      continue;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n++] = patch;
  }
  m->n_tri = n;
done:
  free(role);
  return st;
}

static vg_status take_body(struct body *b, struct vg_error *err)
{
  const struct vg_mesh *m = &b->read->surface;
  vg_status st;

  VG_TRY(vg_mesh_copy(&b->m, m, err));
  VG_TRY(vg_split_quads(&b->m, err));
  VG_TRY(drop_inner(b, err));
  vg_mesh_keep_boundary(&b->m);
  VG_TRY(vg_surface_merge_points(&b->m, err));
  b->is_body = vg_alloc(m->n_patch, 1);
  b->on = vg_alloc(m->n_patch, 1);
  if (!b->is_body || !b->on) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_patch; i++)
    b->is_body[i] = !vg_patch_is_outer(&m->patch[i]);
done:
  return st;
}

/* Direction of the stream of a row at no angles. */
static void stream_of(const struct vg_wake_row *row, double stream[3])
{
  for (int k = 0; k < 3; k++)
    stream[k] = k != row->stream / 2 ? 0 : row->stream % 2 ? -1 : 1;
}

static double edge_length(const struct body *b)
{
  double sum = 0;

  for (size_t i = 0; i < b->edges.n; i++)
    sum += vg_distance(b->m.point[b->edges.edge[i].point[0]],
                       b->m.point[b->edges.edge[i].point[1]]);
  return sum;
}

/* The flow is not decided yet. If patches have no conditions, a body in its
 * tunnel looks like a body from the other side, on which the concave edges are
 * convex, but few of them lie across the stream. */
static vg_status compare_sides(struct body *b, const double stream[3],
                               struct vg_error *err)
{
  struct vg_trailing outside = b->edges;
  const double length = edge_length(b);
  vg_status st;

  b->edges = (struct vg_trailing)VG_TRAILING_INIT;
  st = vg_trailing_find(&b->m, b->is_body, 1, stream, &b->edges, err);
  if (st >= 0 && edge_length(b) > length) {
    vg_trailing_release(&outside);
    vg_note(b->read->notes,
            "wakes: trailing edges are those of a flow inside of the surface "
            "(--flow internal): outside of it, fewer were found");
  } else {
    vg_trailing_release(&b->edges);
    b->edges = outside;
  }
  return st;
}

/* The trailing edges of the previous row serve this one if the stream is the
 * same. */
static vg_status find_edges(struct body *b, struct vg_error *err)
{
  const enum vg_flow_kind flow = b->read->settings.flow;
  double stream[3];
  vg_status st;

  if (b->number > 1 && b->row->stream == b->row[-1].stream) return VG_OK;
  stream_of(b->row, stream);
  vg_trailing_release(&b->edges);
  st = vg_trailing_find(&b->m, b->is_body, flow == VG_FLOW_INTERNAL, stream,
                        &b->edges, err);
  if (st < 0 || flow != VG_FLOW_UNKNOWN) return st;
  return compare_sides(b, stream, err);
}

/* Extent of the body along an axis. */
static double extent(const struct body *b, int axis)
{
  double lo = INFINITY, hi = -INFINITY;

  for (size_t i = 0; i < 3 * b->m.n_tri; i++) {
    const double x = b->m.point[b->m.tri[i / 3][i % 3]][axis];

    if (!b->is_body[b->m.tri_patch[i / 3]]) continue;
    lo = fmin(lo, x);
    hi = fmax(hi, x);
  }
  return hi > lo ? hi - lo : 0;
}

/* The axis that points up for a section, whose stream along z would have no
 * trailing edges. */
static vg_status find_up_in_plane(const struct body *b, int yaws, double up[3],
                                  struct vg_error *err)
{
  const int axis = b->row->stream / 2 ? 0 : 1;
  const int is_other = b->row->up != VG_UP_AUTO && b->row->up != VG_UP_X + axis;

  if (is_other || yaws)
    return vg_fail(err, VG_ERR_INPUT,
                   "wakes: line %zu: a section lies in the plane of x and y, "
                   "but %s; leave it out: up is %c, and alpha is the angle of "
                   "attack",
                   b->number,
                   is_other ? "the column up names another axis"
                            : "beta turns the stream out of this plane",
                   "xy"[axis]);
  for (int k = 0; k < 3; k++) up[k] = k == axis;
  return VG_OK;
}

/* The axis that points up. Without angles it does not matter. */
static vg_status find_up(const struct body *b, int turns, double up[3],
                         struct vg_error *err)
{
  const int one = (b->row->stream / 2 + 1) % 3, two = (one + 1) % 3;
  const double a = extent(b, one), c = extent(b, two);
  int axis = a < c ? one : two;

  if (b->row->up != VG_UP_AUTO) axis = b->row->up - VG_UP_X;
  else if (turns && fmax(a, c) < FLAT * fmin(a, c))
    return vg_fail(err, VG_ERR_INPUT,
                   "wakes: line %zu: alpha or beta is given, but the body is "
                   "about as large along %c (%.4g) as along %c (%.4g), so that "
                   "either axis may point up; give the column up (%c or %c)",
                   b->number, "xyz"[one], a, "xyz"[two], c, "xyz"[one],
                   "xyz"[two]);
  for (int k = 0; k < 3; k++) up[k] = k == axis;
  return VG_OK;
}

static vg_status find_flows(struct body *b, struct vg_error *err)
{
  double alpha[VG_WAKE_ANGLES], beta[VG_WAKE_ANGLES];
  const size_t n_alpha = vg_wake_angles(b->row->alpha, alpha);
  const size_t n_beta = vg_wake_angles(b->row->beta, beta);
  double stream[3], up[3];
  int turns = 0, yaws = 0;
  vg_status st;

  stream_of(b->row, stream);
  for (size_t i = 0; i < n_alpha; i++) turns |= alpha[i] != 0;
  for (size_t i = 0; i < n_beta; i++) yaws |= beta[i] != 0;
  st = b->read->is_section ? find_up_in_plane(b, yaws, up, err)
                           : find_up(b, turns | yaws, up, err);
  b->n_flow = 0;
  for (size_t i = 0; i < n_alpha && st >= 0; i++)
    for (size_t j = 0; j < n_beta; j++)
      vg_wake_direction(alpha[i], beta[j], stream, up, b->flow[b->n_flow++]);
  return st;
}

static void row_name(const struct body *b, char *name, size_t size)
{
  vg_param_format(&vg_wake_table.column[0], b->row, name, size);
}

static vg_status refuse(const struct body *b, struct vg_error *err)
{
  char patch[2 * VG_NAME_MAX + 4];

  row_name(b, patch, sizeof patch);
  return vg_fail(
    err, VG_ERR_INPUT,
    "wakes: line %zu: patch %s has no trailing edge (the surface has %zu such "
    "edges of triangles in all); with the stream along %s, sharp convex edges "
    "of walls were sought, of at most 60 degrees, from which both sides extend "
    "upstream, and bases of at most 5 %% of the chord that face downstream; "
    "give the stream in the column stream, name another patch, or refine the "
    "wake by rows of the table sources",
    b->number, patch, b->edges.n, vg_wake_stream_word(b->row));
}

static double panel_length(const struct body *b)
{
  double length = 0;

  for (size_t i = 0; i < b->panels.n; i++)
    length += vg_distance(b->panels.item[i].x[0], b->panels.item[i].x[1]);
  return length;
}

/* The wakes of all directions lie on each other next to the body. */
static double expected_cells(const struct body *b)
{
  double n = 0;

  for (size_t i = 0; i < b->panels.n; i++)
    n += vg_wake_cells(&b->wake, &b->panels.item[i], b->read->settings.scale);
  return n;
}

static vg_status check_cells(struct body *b, struct vg_error *err)
{
  const int64_t most = b->read->settings.max_cells;

  if (b->read->is_section) return VG_OK;
  b->n_cell += expected_cells(b);
  if (!most || b->n_cell <= (double)most) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "wakes: up to line %zu, the wakes request at least %.2g "
                 "cells, but only %lld are allowed (max_cells); increase size "
                 "or growth, reduce length or height, or give stretch",
                 b->number, b->n_cell, (long long)most);
}

static void note_wake(const struct body *b, size_t n_source)
{
  char cells[40] = "";

  char patch[2 * VG_NAME_MAX + 4];
  double least = INFINITY, most = 0, size = b->wake.size;
  const double growth = b->wake.growth - 1;

  for (size_t i = 0; i < b->panels.n; i++)
    for (int k = 0; k < 2; k++) {
      least = fmin(least, b->panels.item[i].chord[k]);
      most = fmax(most, b->panels.item[i].chord[k]);
    }
  row_name(b, patch, sizeof patch);
  if (!b->read->is_section)
    snprintf(cells, sizeof cells, ", at least %.2g cells", expected_cells(b));
  vg_note(b->read->notes,
          "wake %zu (patch %s): trailing edges of %.4g in total, with chords "
          "of %.4g to %.4g, and %zu direction%s of the stream; sizes of %.3g "
          "to %.3g, %zu sources%s",
          b->number, patch, panel_length(b), least, most, b->n_flow,
          b->n_flow > 1 ? "s" : "", size * least,
          (size + growth * b->wake.length) * most, n_source, cells);
}

static vg_status add_sources(struct body *b, struct vg_error *err)
{
  struct vg_settings *s = &b->read->settings;
  const size_t per_panel = vg_wake_sources_count(&b->wake);
  const double n = (double)per_panel * (double)b->panels.n * (double)b->n_flow;
  size_t at = s->n_source;

  if (n + (double)at > VG_WAKE_SOURCES)
    return vg_fail(err, VG_ERR_INPUT,
                   "wakes: line %zu requests %.0f sources, and the limit is "
                   "%d; increase height, or reduce length or the number of "
                   "angles",
                   b->number, n, VG_WAKE_SOURCES);
  if (vg_reserve(&s->source, &s->cap_source, at + (size_t)n, sizeof *s->source))
    return vg_fail_memory(err, "the wakes");
  for (size_t k = 0; k < b->n_flow; k++)
    for (size_t i = 0; i < b->panels.n; i++, at += per_panel)
      vg_wake_sources(&b->wake, &b->panels.item[i], b->flow[k], s->source + at);
  for (size_t i = s->n_source; i < at; i++)
    snprintf(s->source[i].group, sizeof s->source[i].group, "wake %zu",
             b->number);
  s->n_source = at;
  note_wake(b, (size_t)n);
  return VG_OK;
}

/* Lines across the wake at each station, evenly over its panels. */
static vg_status add_probes(struct body *b, struct vg_error *err)
{
  struct vg_read_wakes *to = &b->read->wakes;
  const size_t n = b->panels.n * b->n_flow;
  const size_t step = (n + MOST_PROBES - 1) / MOST_PROBES;

  for (size_t k = 0; k < VG_WAKE_STATIONS; k++)
    for (size_t i = step / 2; i < n; i += step) {
      struct vg_wake_probe *p;

      if (vg_reserve(&to->probe, &to->cap_probe, to->n_probe + 1,
                     sizeof *to->probe))
        return vg_fail_memory(err, "the wakes");
      p = to->probe + to->n_probe;
      if (!vg_wake_probe(&b->wake, &b->panels.item[i % b->panels.n],
                         b->flow[i / b->panels.n], stations[k],
                         b->read->settings.scale, p))
        continue;
      p->wake = b->number - 1;
      p->station = k;
      to->n_probe++;
    }
  return VG_OK;
}

/* --- sheets --------------------------------------------------------------- */

int vg_patch_is_marked_sheet(const struct vg_patch *p)
{
  return p->is_sheet == 1 && p->inner == VG_INNER_NOT;
}

static int has_name(const struct vg_mesh *m, const char *name)
{
  int has = 0;

  for (size_t i = 0; i < m->n_patch; i++)
    has |= strcmp(m->patch[i].name, name) == 0;
  return has;
}

/* Adds the patch wakeN, or wakeN_2 and so on; N: number of the row. */
static vg_status add_patch(struct vg_mesh *m, size_t number,
                           struct vg_error *err)
{
  char name[VG_NAME_MAX];
  const int32_t id = vg_mesh_last_id(m);
  size_t at;

  snprintf(name, sizeof name, "wake%zu", number);
  for (int k = 2; has_name(m, name); k++)
    snprintf(name, sizeof name, "wake%zu_%d", number, k);
  at = id < INT32_MAX ? vg_mesh_add_patch(m, id + 1, name) : SIZE_MAX;
  if (at == SIZE_MAX) return vg_fail_memory(err, "a wake sheet");
  m->patch[at].is_sheet = 1;
  return VG_OK;
}

vg_status vg_read_add_wake_patches(struct vg_read *r, struct vg_error *err)
{
  const struct vg_settings *s = &r->settings;
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n_wake && st >= 0; i++)
    if (s->wake_row[i].kind == VG_WAKE_SHEET)
      st = add_patch(&r->surface, i + 1, err);
  return st;
}

/* The patch of the current row: wakes have theirs in the order of the rows,
 * after the sheets of the file. */
static size_t patch_of(const struct body *b)
{
  const struct vg_read_wakes *w = &b->read->wakes;
  const struct vg_mesh *m = &b->read->surface;
  size_t left = 0, at = m->n_patch;

  for (const struct vg_wake_row *row = b->row; row < w->row + w->n; row++)
    left += row->kind == VG_WAKE_SHEET;
  while (left > 0) left -= (size_t)vg_patch_is_marked_sheet(&m->patch[--at]);
  return at;
}

/* Earlier rows with a sheet along the same stream from one of the edges. */
static vg_status refuse_same(const struct body *b, struct vg_error *err)
{
  const struct vg_wake_row *first = b->read->wakes.row;
  uint8_t *on = vg_alloc(b->m.n_patch, 1);
  int same = 0;
  vg_status st = on ? VG_OK : vg_fail_memory(err, "the wakes");

  for (const struct vg_wake_row *r = first; r < b->row && st >= 0; r++) {
    if (r->kind != VG_WAKE_SHEET || r->stream != b->row->stream ||
        strcmp(r->alpha, b->row->alpha) || strcmp(r->beta, b->row->beta))
      continue;
    memset(on, 0, b->m.n_patch);
    st = vg_patch_ref_mark("wakes", r->patch, r->patch_name, &b->m,
                           b->m.n_patch, on, err);
    for (size_t i = 0; i < b->edges.n; i++) {
      const uint32_t *p = b->edges.edge[i].patch;

      same |= (on[p[0]] || on[p[1]]) && (b->on[p[0]] || b->on[p[1]]);
    }
    if (st >= 0 && same)
      st = vg_fail(err, VG_ERR_INPUT,
                   "wakes: lines %zu and %zu make a sheet from the same "
                   "trailing edge, which belongs to the patches on both of its "
                   "sides; remove one of the lines",
                   (size_t)(r - first) + 1, b->number);
  }
  free(on);
  return st;
}

static vg_status place_sheet(struct body *b, struct vg_error *err)
{
  struct vg_mesh *m = &b->read->surface;
  struct vg_wake_sheet s = { .length = b->row->length, .row = b->row->size };
  const size_t n = m->n_tri;
  char patch[2 * VG_NAME_MAX + 4];
  size_t at;
  vg_status st;

  if (b->read->is_section)
    return vg_fail(err, VG_ERR_INPUT,
                   "wakes: line %zu: a section has no sheets; give kind "
                   "sources",
                   b->number);
  VG_TRY(refuse_same(b, err));
  VG_TRY(find_flows(b, err));
  memcpy(s.flow, b->flow[0], sizeof s.flow);
  VG_TRY(find_up(b, 0, s.up, err));
  at = patch_of(b);
  VG_TRY(vg_wake_sheet_add(&b->m, &b->edges, b->on, &s, m, (uint32_t)at, err));
  row_name(b, patch, sizeof patch);
  vg_note(b->read->notes,
          "wake %zu (patch %s): a sheet of %zu triangles, patch %d (%s)",
          b->number, patch, m->n_tri - n, (int)m->patch[at].id,
          m->patch[at].name);
  st = vg_settings_add(&b->read->settings, VG_TABLE_WAKES, b->row, err);
done:
  return st;
}

/* --- rows ----------------------------------------------------------------- */

static vg_status refuse_stretch(const struct body *b, struct vg_error *err)
{
  if (!b->read->is_section || b->row->stretch == 1) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "wakes: line %zu: stretch is %g, but cells of a section do "
                 "not stretch; leave the column out",
                 b->number, b->row->stretch);
}

static vg_status place_row(struct body *b, struct vg_error *err)
{
  const struct vg_wake_row *row = b->row;
  const size_t n_patch = b->m.n_patch;
  vg_status st;

  b->wake = (struct vg_wake){ row->length, row->size,  row->height,
                              row->growth, row->chord, row->stretch };
  memset(b->on, 0, n_patch);
  VG_TRY(refuse_stretch(b, err));
  VG_TRY(vg_patch_ref_mark("wakes", row->patch, row->patch_name, &b->m, n_patch,
                           b->on, err));
  VG_TRY(find_edges(b, err));
  VG_TRY(
    vg_wake_panels_make(&b->m, &b->edges, b->on, &b->wake, &b->panels, err));
  if (!b->panels.n) VG_TRY(refuse(b, err));
  if (row->kind == VG_WAKE_SHEET) VG_TRY(place_sheet(b, err));
  if (row->kind == VG_WAKE_SHEET) goto done;
  VG_TRY(find_flows(b, err));
  VG_TRY(check_cells(b, err));
  VG_TRY(add_sources(b, err));
  st = add_probes(b, err);
done:
  vg_wake_panels_release(&b->panels);
  return st;
}

/* The setting `wakes` is a row of its own. */
static vg_status take_rows(struct vg_read *r, struct vg_error *err)
{
  struct vg_settings *s = &r->settings;
  struct vg_wake_row row;
  vg_status st = VG_OK;

  if (s->wakes) {
    vg_settings_row_default(VG_TABLE_WAKES, &row);
    st = vg_settings_add(s, VG_TABLE_WAKES, &row, err);
  }
  s->wakes = 0;
  r->wakes.n = s->n_wake;
  r->wakes.row = s->wake_row;
  s->n_wake = s->cap_wake = 0;
  s->wake_row = NULL;
  return st;
}

vg_status vg_read_place_wakes(struct vg_read *r, struct vg_error *err)
{
  struct body *b;
  vg_status st;

  VG_TRY(take_rows(r, err));
  if (!r->wakes.n) return VG_OK;
  b = vg_calloc(1, sizeof *b);
  if (!b) return vg_fail_memory(err, "the wakes");
  b->read = r;
  st = take_body(b, err);
  for (size_t i = 0; i < r->wakes.n && st >= 0; i++) {
    b->row = r->wakes.row + i;
    b->number = i + 1;
    st = place_row(b, err);
  }
  vg_trailing_release(&b->edges);
  vg_mesh_release(&b->m);
  free(b->is_body);
  free(b->on);
  free(b);
done:
  return st;
}

void vg_read_wakes_release(struct vg_read_wakes *w)
{
  free(w->row);
  free(w->probe);
  memset(w, 0, sizeof *w);
}
