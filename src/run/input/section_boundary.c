/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The boundary of a mesh in two dimensions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/format.h"
#include "io/section/section.h"
#include "layers/expand/join.h"
#include "run/input/shape_parts.h"
#include "run/input/sizes.h"
#include "run/section/section_surface.h"
#include "run/settings/patch_names.h"
#include "run/settings/plan_options.h"

#define FAN_ANGLE 60.0  /* S96: sharp and blunt trailing edges */
#define SIZE 0.02       /* S96: largest edge over the length of the section */
#define SLOT_NOTE 0.5   /* S96: width of a slot over the edge there: noted, */
#define SLOT_LEAST 0.02 /* and refused */
#define COARSE 1.05     /* 60 degrees: smooth points are reported */
#define DEGREES 57.29577951308232

enum { EDGES_MIN = 3 };

/* Whether the input is a plane section by its name or by the settings. */
static int is_section(const struct vg_read *r, const struct vg_settings *s)
{
  return r->is_section ||
         (s->cad_section && vg_format_is_cad(r->files.surface));
}

void vg_section_complete(struct vg_read *read, struct vg_settings *s)
{
  read->is_section = is_section(read, s);
  if (!read->is_section) return;
  read->side = VG_SIDE_DEFINED;
  if (s->cells == VG_LAYER_TETS) s->cells = VG_LAYER_HEX;
  if (isnan(s->layer.fan_angle)) s->layer.fan_angle = FAN_ANGLE;
}

int vg_problem_is_section(const struct vg_problem *p)
{
  return is_section(&p->read, &p->asked);
}

vg_status vg_problem_refuse_section(const struct vg_problem *p,
                                    struct vg_error *err)
{
  if (!vg_problem_is_section(p)) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s is a plane section, and this command works on surfaces in "
                 "space; vanguard mesh makes the mesh in two dimensions, and "
                 "vanguard check checks the section",
                 p->read.files.surface);
}

/* Settings that only surfaces in space have. */
static vg_status refuse_settings(const struct vg_read *r, struct vg_error *err)
{
  const struct vg_settings *s = &r->settings;
  const char *bad = NULL;

  if (s->wrap > 0) bad = "wrap is given";
  else if (s->close_holes) bad = "close_holes is yes";
  else if (s->farfield.kind == VG_DOMAIN_NONE) bad = "farfield none is given";
  else if (s->farfield.kind == VG_DOMAIN_MACH) bad = "farfield mach is given";
  else if (s->flow == VG_FLOW_INTERNAL) bad = "flow is internal";
  else if (s->half != VG_HALF_AUTO && s->half != VG_HALF_NO)
    bad = "a half model is requested";
  else if (*s->baffles || *s->sheets) bad = "baffles or sheets are given";
  else if (s->n_surface) bad = "the table surface is given";
  else if (r->metrics) bad = "the file of sizes has metrics";
  for (size_t i = 0; i < s->n_source && !bad; i++)
    if (vg_source_is_stretched(&s->source[i])) bad = "a source is stretched";
  if (!bad) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s is a plane section, for a mesh in two dimensions, but %s, "
                 "which applies to surfaces in space only; remove this setting",
                 r->files.surface, bad);
}

vg_status vg_boundary_refuse_plane_farfield(const struct vg_read *r,
                                            struct vg_error *err)
{
  const int kind = r->settings.farfield.kind;

  if (kind != VG_DOMAIN_C && kind != VG_DOMAIN_TUNNEL) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: farfield %s is made around plane sections (.dat) only; "
                 "use sphere or box, or make the outer boundary part of the "
                 "surface",
                 r->files.stem, kind == VG_DOMAIN_C ? "c" : "tunnel");
}

/* The curves of a CAD model as the text of a section. */
static vg_status write_curves(const struct vg_cad_surface *c, char **text,
                              size_t *size, struct vg_error *err)
{
  FILE *to = open_memstream(text, size);
  int bad = !to;

  for (size_t i = 0; !bad && i < c->n_segment; i++) {
    if (i) fprintf(to, "999 999\n");
    for (uint32_t k = c->segment[i][0]; k <= c->segment[i][1]; k++)
      fprintf(to, "%.17g %.17g\n", c->mesh.point[k][0], c->mesh.point[k][1]);
    bad = ferror(to);
  }
  if (to) bad |= fclose(to) != 0;
  return bad ? vg_fail_memory(err, "the curves of a section") : VG_OK;
}

static vg_status read_curves(struct vg_read *r, struct vg_display *show,
                             struct vg_section *out, struct vg_error *err)
{
  struct vg_cad_options o = vg_options_cad(&r->settings, 0);
  struct vg_cad_model model = VG_CAD_MODEL_INIT;
  struct vg_read_info info = { .cad = &o, .model = &model };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_input in = VG_INPUT_INIT;
  char *text = NULL, name[300];
  size_t size = 0;
  vg_status st;

  o.note = vg_read_note_cad;
  o.user = r->notes;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  VG_TRY(vg_mesh_read(r->files.surface, &m, &info, err));
  if (info.unit) r->unit = info.unit;
  VG_TRY(write_curves(&model.surface, &text, &size, err));
  snprintf(name, sizeof name, "%.200s, points along its curves",
           r->files.surface);
  VG_TRY(vg_input_memory(name, text, size, &in, err));
  st = vg_section_parse(&in, out, err);
done:
  free(text);
  vg_input_release(&in);
  vg_mesh_release(&m);
  vg_cad_model_release(&model);
  return st == VG_ERR_STOPPED ? vg_display_stopped(show, err) : st;
}

void vg_read_note_cad(void *user, const char *text)
{
  vg_note(user, "CAD: %s", text);
}

vg_status vg_read_section(struct vg_read *r, struct vg_display *show,
                          struct vg_error *err)
{
  struct vg_section s = VG_SECTION_INIT;
  vg_status st;

  VG_TRY(refuse_settings(r, err));
  VG_TRY(vg_section_is(r->files.surface)
           ? vg_section_read(r->files.surface, &s, err)
           : read_curves(r, show, &s, err));
  VG_TRY(vg_section_strip(&s, &r->surface, err));
done:
  vg_section_release(&s);
  return st;
}

/* --- edges --------------------------------------------------------------- */

struct requests {
  const struct vg_boundary *b;
  struct vg_sizing_options options;
};

static double request_at(void *user, const double x[2])
{
  const struct requests *q = user;
  const struct vg_settings *s = &q->b->read->settings;
  const struct vg_size_map *map = q->b->map;
  const double p[3] = { x[0], x[1], 0 };
  double h = INFINITY;

  if (s->n_source)
    h = vg_sizing_sources_at(&q->options, s->n_source, s->source, p);
  return map && map->at ? fmin(h, map->at(map->user, p)) : h;
}

static double extent_of(const struct vg_mesh *m)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  return fmax(hi[0] - lo[0], hi[1] - lo[1]);
}

/* The features to which the spacings refer. */
static void note_found(const struct vg_boundary *b,
                       const struct vg_section_found *found)
{
  for (size_t i = 0; i < b->surface.n_patch; i++) {
    const struct vg_section_found *f = &found[i];
    char edge[120];

    if (f->base > 0)
      snprintf(edge, sizeof edge, "blunt, %.4g wide (%.3g %% of the chord)",
               f->base, 100 * f->base / f->chord);
    else snprintf(edge, sizeof edge, f->is_corner ? "sharp" : "smooth");
    vg_note(b->notes,
            "section %s: chord %.6g, trailing edge at (%.6g, %.6g) %s, %zu "
            "corners, %zu edges",
            b->surface.patch[i].name, f->chord, f->start[0], f->start[1], edge,
            f->n_corner, f->n_edge);
    if (f->turn > COARSE)
      vg_note(b->notes,
              "section %s: the curve is smooth at (%.6g, %.6g), where the "
              "points turn by %.0f degrees; if that is a corner, add a point "
              "in the middle of both sides, otherwise more points along the "
              "curve",
              b->surface.patch[i].name, f->at[0], f->at[1], f->turn * DEGREES);
  }
}

/* Requests that the sections found cannot meet. */
static vg_status check_found(const struct vg_boundary *b,
                             const struct vg_section_found *found,
                             struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const size_t n = b->surface.n_patch;
  double base = 0;

  for (size_t i = 0; i < n; i++) {
    base = fmax(base, found[i].base);
    if (found[i].n_edge >= EDGES_MIN) continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "section %s of chord %g would have only %zu edges with the "
                   "scale %g; reduce scale or surface_size, or raise "
                   "edges_per_turn",
                   b->surface.patch[i].name, found[i].chord, found[i].n_edge,
                   s->scale);
  }
  if (s->tail_cells && !(base > 0))
    vg_note(b->notes,
            "te_cells has no effect: no section has a blunt trailing edge");
  return VG_OK;
}

/* A slot far narrower than its edges has flat triangles. */
static vg_status check_slot(const struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_patch *patch = b->surface.patch;
  struct vg_section_slot slot;
  vg_status st = vg_section_slot_find(&b->surface, &slot, err);

  if (st < 0 || slot.width >= SLOT_NOTE * slot.edge) return st;
  if (slot.width < SLOT_LEAST * slot.edge)
    return vg_fail(err, VG_ERR_INPUT,
                   "the slot between section %s and section %s at (%.6g, %.6g) "
                   "is only %.3g wide, and the edges there are %.3g long; move "
                   "the sections apart, unite them, or request edges of that "
                   "width by a source",
                   patch[slot.patch[0]].name, patch[slot.patch[1]].name,
                   slot.at[0], slot.at[1], slot.width, slot.edge);
  vg_note(b->notes,
          "the slot between section %s and section %s at (%.6g, %.6g) is only "
          "%.3g wide, and the edges there are %.3g long; request shorter ones "
          "by a source",
          patch[slot.patch[0]].name, patch[slot.patch[1]].name, slot.at[0],
          slot.at[1], slot.width, slot.edge);
  return VG_OK;
}

vg_status vg_boundary_divide_section(struct vg_boundary *b,
                                     struct vg_display *show,
                                     struct vg_error *err)
{
  struct vg_section_found *found = vg_alloc(b->surface.n_patch, sizeof *found);
  vg_status st;
  const struct vg_settings *s = &b->read->settings;
  const struct vg_remesh_options o = vg_options_remesh(s);
  struct requests q = { b, vg_boundary_sizing(b) };
  const struct vg_section_shares shares = {
    .nose = s->nose_spacing / 100 * s->scale,
    .corner = s->tail_spacing / 100 * s->scale
  };
  const struct vg_outline_sizes sizes = {
    .largest = (o.h_max > 0 ? o.h_max : SIZE * extent_of(&b->surface)) *
               s->scale,
    .smallest = o.h_min * s->scale,
    .per_turn = o.per_turn / s->scale,
    .growth = vg_options_growth(s),
    .n_base = (size_t)(s->tail_cells
                         ? fmax(1,
                                floor((double)s->tail_cells / s->scale + 0.5))
                         : 0),
    .at = request_at,
    .user = &q
  };

  if (!found) return vg_fail_memory(err, "the edges of a section");
  b->flow.kind = VG_FLOW_EXTERNAL;
  b->flow.axis = -1;
  st = vg_boundary_gaps(b, show, err);
  if (st >= 0) st = vg_section_divide(&b->surface, &sizes, &shares, found, err);
  if (st >= 0) note_found(b, found);
  if (st >= 0) st = check_found(b, found, err);
  if (st >= 0) st = check_slot(b, err);
  free(found);
  return st;
}

/* --- farfield ------------------------------------------------------------ */

static struct vg_section_outer outer_of(const struct vg_boundary *b,
                                        const struct vg_farfield *f)
{
  const double size = f->size > 0 ? f->size
                                  : f->lengths * extent_of(&b->surface);
  const int kind = b->read->settings.farfield.kind;
  struct vg_section_outer o = { .shape = kind == VG_DOMAIN_BOX ? VG_SECTION_BOX
                                       : kind == VG_DOMAIN_C   ? VG_SECTION_C
                                       : kind == VG_DOMAIN_TUNNEL
                                         ? VG_SECTION_TUNNEL
                                         : VG_SECTION_CIRCLE,
                                .radius = size };
  double lo[3], hi[3];

  vg_mesh_bounds(&b->surface, lo, hi);
  for (int k = 0; k < 2; k++) {
    o.centre[k] = f->has_centre ? f->centre[k] : 0.5 * (lo[k] + hi[k]);
    o.lo[k] = f->has_box ? f->lo[k] : o.centre[k] - size;
    o.hi[k] = f->has_box ? f->hi[k] : o.centre[k] + size;
  }
  if (o.shape == VG_SECTION_C) o.lo[0] = o.centre[0];
  return o;
}

/* Points that extend the box of the view to the outer boundary, so that sources
 * and maps of sizes count in the whole plane. */
static void reach_outer(struct vg_mesh *view,
                        const struct vg_section_outer *outer)
{
  double *lo = view->point[view->n_point++];
  double *hi = view->point[view->n_point++];

  for (int k = 0; k < 2; k++) {
    lo[k] = outer->lo[k];
    hi[k] = outer->hi[k];
  }
  if (outer->shape == VG_SECTION_C) lo[0] = outer->centre[0] - outer->radius;
  lo[2] = hi[2] = 0;
}

/* Walls of a tunnel that grow no layers are inviscid. */
static vg_status give_conditions(struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_mesh *m = &b->surface;
  uint8_t *on = vg_calloc(m->n_patch, 1);
  vg_status st;

  if (!on) return vg_fail_memory(err, "the patches");
  VG_TRY(vg_patch_list_mark("walls", s->layer.walls, m, b->n_row + 2, on, err));
  for (size_t i = b->n_row; i < b->n_row + 2; i++) {
    struct vg_patch *p = &m->patch[i];

    if (on[i] || vg_settings_layer_row(s, p->id).grow == VG_ANSWER_YES)
      continue;
    p->bc = p->family = 5;
    p->bc_fun3d = 3000;
  }
done:
  free(on);
  return st;
}

struct edges {
  const struct vg_sizing *sizing;
  double most;
};

static double edge_at(void *user, const double x[3])
{
  const struct edges *e = user;

  return fmin(vg_sizing_at(e->sizing, x), e->most);
}

vg_status vg_boundary_close_section(struct vg_boundary *b,
                                    struct vg_display *show,
                                    struct vg_error *err)
{
  const struct vg_farfield far = vg_boundary_farfield(b);
  const struct vg_section_outer outer = outer_of(b, &far);
  struct vg_sizing_options options = vg_boundary_sizing(b);
  struct vg_mesh view = VG_MESH_INIT;
  struct vg_sizing *sizing = NULL;
  struct edges edges;
  struct vg_size_function size = { edge_at, &edges, { vg_display_stop, show } };
  const size_t n_tri = b->surface.n_tri;
  vg_status st;

  vg_display_update(show, "farfield", 0, 0);
  VG_TRY(vg_section_sizes(&b->surface, &view, err));
  reach_outer(&view, &outer);
  if (!(options.h_max > 0)) options.h_max = INFINITY;
  options.threads = b->threads;
  VG_TRY(
    vg_boundary_measure(b, &options, &b->read->settings, &view, &sizing, err));
  edges = (struct edges){ sizing, far.spacing > 0 ? far.spacing : INFINITY };
  VG_TRY(vg_section_close(&b->surface, &outer, &size, err));
  if (outer.shape == VG_SECTION_TUNNEL) VG_TRY(give_conditions(b, err));
  b->domain.added_farfield = 1;
  b->domain.symmetry_axis = -1;
  b->domain.n_added_tri = b->surface.n_tri - n_tri;
done:
  free(view.point);
  free(view.tri);
  free(view.tri_patch);
  vg_sizing_free(sizing);
  return st;
}

double vg_section_width(const struct vg_settings *s, const struct vg_mesh *slab,
                        size_t n_element)
{
  const size_t n = vg_section_points(slab);
  double most = 0;
  size_t t = 0;

  if (s->section_width > 0) return s->section_width;
  for (size_t patch = 0; patch < n_element; patch++) {
    double lo = INFINITY, hi = -INFINITY;

    for (; t < slab->n_tri && slab->tri_patch[t] == patch; t++)
      for (int k = 0; k < 3; k++) {
        const uint32_t v = slab->tri[t][k];

        if (v >= n) continue;
        lo = fmin(lo, slab->point[v][0]);
        hi = fmax(hi, slab->point[v][0]);
      }
    most = fmax(most, hi - lo);
  }
  return most;
}
