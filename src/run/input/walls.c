/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/walls.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/copies.h"
#include "core/surface/surface_swap.h"
#include "io/stream/stream.h"
#include "io/vgrid/mapbc.h"
#include "layers/slide/slide.h"
#include "run/input/shape_parts.h"
#include "run/input/zone_table.h"
#include "run/settings/patch_names.h"

int vg_boundary_is_cap(const struct vg_boundary *b, size_t i)
{
  return b->n_given_patch && i >= b->n_given_patch &&
         !strncmp(b->surface.patch[i].name, "cap_", 4);
}

#define MESHING_WALL 2 /* Class of a .d3m patch on which layers grow. */
#define FLAT 1e-4      /* S50: height over the longest edge: 0.006 degrees. */

const char *vg_wall_reason_name(enum vg_wall_reason reason)
{
  static const char *const name[] = { "no",        "setting", "meshing class",
                                      "condition", "body",    "extended" };

  assert(reason <= VG_WALL_EXTENDED);
  return name[reason];
}

/* 41: moving wall, 44: blunt base. Codes of FUN3D without a translation also
 * begin with 4. */
int vg_is_viscous(const struct vg_patch *p)
{
  int32_t bc = p->bc;

  if (bc == VG_BC_NONE && p->bc_fun3d != VG_BC_NONE)
    bc = vg_bc_to_usm3d(p->bc_fun3d);
  if (bc == VG_BC_NONE) return strncasecmp(p->name, "BCWallViscous", 13) == 0;
  return bc == 4 || bc == 41 || bc == 44 || (bc >= 4000 && bc < 5000) ||
         (bc <= -4000 && bc > -5000);
}

int vg_has_limits(const struct vg_layer_limits *l)
{
  return !isnan(l->min_full) || !isnan(l->min_any) || !isnan(l->min_height) ||
         !isnan(l->max_first_error) || !isnan(l->max_top_ratio);
}

int vg_walls_asked(const struct vg_settings *s)
{
  const struct vg_layer_settings *l = &s->layer;

  if (l->grow == VG_ANSWER_NO) return 0;
  for (size_t i = 0; i < s->n_layer; i++)
    if (s->layer_row[i].grow == VG_ANSWER_YES ||
        vg_has_limits(&s->layer_row[i].limit))
      return 1;
  return l->grow == VG_ANSWER_YES || l->first > 0 || l->y_plus > 0 ||
       *l->walls || vg_has_limits(&l->limit);
}

/* Meshing class of patch id in the project; 0 if it has none. */
static int32_t meshing_class(const struct vg_project *p, int32_t id)
{
  for (size_t i = 0; i < p->n_shape; i++)
    if (p->shape[i].patch.id == id) return p->shape[i].meshing_class;
  return 0;
}

/* Whether a patch is part of the input; others complete the domain. */
static int is_given(const struct vg_boundary *b, int32_t id)
{
  for (size_t i = 0; i < b->n_row; i++)
    if (b->row[i].id == id) return 1;
  return 0;
}

/* Whether this program added the patch, as a farfield or symmetry plane. The
 * number of such a patch follows those of the surface, so a range may include
 * it by mistake. */
static int is_added(const struct vg_boundary *b, const struct vg_patch *patch)
{
  return !patch->inner && !is_given(b, patch->id) &&
         (patch->bc == 1 || patch->bc == 3);
}

/* Number of patches before those that this program added. */
static size_t n_own(const struct vg_boundary *b)
{
  size_t n = b->surface.n_patch;

  while (n && is_added(b, &b->surface.patch[n - 1])) n--;
  return n;
}

static vg_status refuse_added(const struct vg_boundary *b, const char *what,
                              size_t i, struct vg_error *err)
{
  const struct vg_patch *patch = &b->surface.patch[i];
  char list[600];

  vg_patch_list_text(&b->surface, n_own(b), list, sizeof list);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: patch %d is the %s that was added to the surface, and "
                 "no layers grow on it; remove it from the list. Patches: %s",
                 what, (int)patch->id,
                 patch->bc == 1 ? "symmetry plane" : "farfield", list);
}

/* Names refer to patches of the surface; only numbers can refer to an added
 * patch. */
static vg_status refuse_added_walls(const struct vg_boundary *b,
                                    struct vg_error *err)
{
  const char *at = b->read->settings.layer.walls;
  struct vg_patch_item item;

  while (vg_patch_list_next(&at, &item))
    for (size_t i = n_own(b); i < b->surface.n_patch && !*item.name; i++)
      if (b->surface.patch[i].id >= item.from &&
          b->surface.patch[i].id <= item.to)
        return refuse_added(b, "walls", i, err);
  return VG_OK;
}

static vg_status refuse_periodic(const struct vg_boundary *b,
                                 const enum vg_wall_reason *reason,
                                 struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;

  for (size_t i = 0; i < m->n_patch; i++)
    if (reason[i] != VG_WALL_NOT && vg_pairs_have(&b->pairs, m->patch[i].id))
      return vg_fail(err, VG_ERR_INPUT,
                     "patch %d%s%s is periodic, but layers would grow on it "
                     "(%s); remove it from the list walls, from the table "
                     "layers or from the table periodic, or correct its "
                     "boundary condition",
                     (int)m->patch[i].id, *m->patch[i].name ? " " : "",
                     m->patch[i].name, vg_wall_reason_name(reason[i]));
  return VG_OK;
}

/* Does the list contain a patch only within a pattern or a range? */
static int is_among(const char *list, const struct vg_patch *p)
{
  struct vg_patch_item item;
  int is = 0;

  while (vg_patch_list_next(&list, &item)) {
    const int one = *item.name ? !strpbrk(item.name, "*?")
                               : item.from == item.to;
    const int has = *item.name ? vg_patch_name_matches(item.name, p->name)
                               : item.from <= p->id && p->id <= item.to;

    if (has && one) return 0;
    is |= has;
  }
  return is;
}

/* A patch without faces cannot have layers, even if they are requested. One of
 * many that a pattern names is left out, such as the cap of a half model. */
static vg_status refuse_empty(const struct vg_boundary *b,
                              const uint8_t *has_faces,
                              enum vg_wall_reason *reason, struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  const int is_cut = vg_zones_lack_cells(&b->read->settings);

  for (size_t i = 0; i < m->n_patch; i++) {
    if (reason[i] != VG_WALL_SETTING || has_faces[i]) continue;
    if (is_among(b->read->settings.layer.walls, &m->patch[i]))
      reason[i] = VG_WALL_NOT;
    else
      return vg_fail(err, VG_ERR_INPUT,
                     "layers are requested on patch %d%s%s, but none of its "
                     "faces is left (%s removed them); name only the other "
                     "patches%s",
                     (int)m->patch[i].id, *m->patch[i].name ? " " : "",
                     m->patch[i].name,
                     is_cut ? "a zone without cells, the repair or the wrap"
                            : "the repair or the wrap",
                     is_cut ? ", or mesh the zone (mesh yes in the table zones)"
                            : "");
  }
  return VG_OK;
}

/* Which patches without conditions are walls when layers are requested: all of
 * a body; all of a duct except its ends; in another outer boundary, the bodies
 * inside it. A name that says wall always decides. */
static int is_bare_wall(const struct vg_boundary *b, size_t i)
{
  const struct vg_flow *f = &b->flow;
  const enum vg_flow_role role = vg_flow_role_of(&b->surface.patch[i]);

  if (f->kind != VG_FLOW_INTERNAL) return 1;
  if (role == VG_ROLE_WALL) return 1;
  if (role != VG_ROLE_NONE && role != VG_ROLE_OTHER) return 0;
  if (vg_boundary_is_cap(b, i)) return 0;
  return f->n_inlet + f->n_outlet || b->n_given_patch || !f->on_outer[i];
}

/* Classifies patch i by the input, without settings. */
static enum vg_wall_reason by_input(const struct vg_boundary *b, size_t i,
                                    int has_faces)
{
  const struct vg_patch *patch = &b->surface.patch[i];

  if (patch->is_sheet) return VG_WALL_NOT;
  if (meshing_class(&b->read->project, patch->id) == MESHING_WALL)
    return VG_WALL_CLASS;
  if (vg_is_viscous(patch)) return VG_WALL_CONDITION;
  if (has_faces && !b->require_bc && !vg_pairs_have(&b->pairs, patch->id) &&
      vg_walls_asked(&b->read->settings) && is_given(b, patch->id) &&
      is_bare_wall(b, i))
    return VG_WALL_BODY;
  return VG_WALL_NOT;
}

static vg_status apply_row(const struct vg_boundary *b,
                           const struct vg_layer_row *row, const uint8_t *wall,
                           const uint8_t *slip, enum vg_wall_reason *reason,
                           struct vg_error *err)
{
  size_t i = vg_mesh_find_patch(&b->surface, row->id);

  if (i == SIZE_MAX)
    return vg_patch_ref_mark("layers", row->id, "", &b->surface, n_own(b), NULL,
                             err);
  if (i >= n_own(b) &&
      (row->grow == VG_ANSWER_YES || vg_has_limits(&row->limit)))
    return refuse_added(b, "layers", i, err);
  if (row->grow == VG_ANSWER_NO && wall[i])
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d is in the list walls, but the table layers has "
                   "grow no for it; remove one of them",
                   (int)row->id);
  if (row->grow == VG_ANSWER_YES && slip[i])
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d is in the list slip, but the table layers has "
                   "grow yes for it; remove one of them",
                   (int)row->id);
  if (row->grow == VG_ANSWER_YES) reason[i] = VG_WALL_SETTING;
  if (row->grow == VG_ANSWER_NO) reason[i] = VG_WALL_NOT;
  return VG_OK;
}

/* The back of an inner surface is as its front, unless a list or the column
 * grow names it. */
static void follow_fronts(const struct vg_boundary *b, const uint8_t *wall,
                          const uint8_t *slip, enum vg_wall_reason *reason)
{
  const struct vg_mesh *m = &b->surface;

  for (size_t i = 0; i < m->n_patch; i++) {
    const struct vg_layer_row row = vg_settings_layer_row(&b->read->settings,
                                                          m->patch[i].id);

    if (wall[i] || slip[i] || row.grow != VG_ANSWER_AUTO) continue;
    reason[i] = reason[vg_mesh_front_patch(m, i)];
  }
}

struct vg_layer_row vg_wall_layer_row(const struct vg_settings *s,
                                      const struct vg_mesh *m, size_t i)
{
  const size_t front = vg_mesh_front_patch(m, i);

  return vg_settings_layer_row_like(s, m->patch[i].id, m->patch[front].id);
}

static vg_status by_settings(const struct vg_boundary *b, uint8_t *wall,
                             uint8_t *slip, enum vg_wall_reason *reason,
                             struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_mesh *m = &b->surface;
  vg_status st;

  VG_TRY(refuse_added_walls(b, err));
  VG_TRY(vg_patch_list_mark("walls", s->layer.walls, m, n_own(b), wall, err));
  VG_TRY(vg_patch_list_mark("slip", s->layer.slip, m, m->n_patch, slip, err));
  for (size_t i = 0; i < m->n_patch; i++) {
    if (wall[i] && slip[i]) {
      st = vg_fail(err, VG_ERR_INPUT,
                   "patch %d is in both lists, walls and slip; remove it from "
                   "one of them",
                   (int)m->patch[i].id);
      goto done;
    }
    if (wall[i]) reason[i] = VG_WALL_SETTING;
    else if (slip[i] || *s->layer.walls) reason[i] = VG_WALL_NOT;
  }
  for (size_t i = 0; i < s->n_layer; i++)
    VG_TRY(apply_row(b, &s->layer_row[i], wall, slip, reason, err));
  follow_fronts(b, wall, slip, reason);
done:
  return st;
}

static vg_status no_walls(const struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  char list[600];

  vg_patch_list_text(m, n_own(b), list, sizeof list);
  return vg_fail(
    err, VG_ERR_INPUT,
    "%s: layers are requested, but no patch is known to be a wall; name the "
    "walls with --walls (such as --walls 3-12,wing*), set condition 4 in a "
    ".mapbc or the deck, or turn layers off with --layers no. Patches: %s",
    b->read->files.stem, list);
}

vg_status vg_walls_find(const struct vg_boundary *b,
                        enum vg_wall_reason *reason, size_t *n_wall,
                        struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  uint8_t *mark_of = vg_calloc(3 * m->n_patch, 1);
  uint8_t *has_faces = mark_of ? mark_of + 2 * m->n_patch : NULL;
  vg_status st;

  assert((reason || !m->n_patch) && n_wall);
  *n_wall = 0;
  if (!mark_of) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_tri; i++) has_faces[m->tri_patch[i]] = 1;
  for (size_t i = 0; i < m->n_patch; i++)
    reason[i] = by_input(b, i, has_faces[i]);
  VG_TRY(by_settings(b, mark_of, mark_of + m->n_patch, reason, err));
  if (vg_walls_asked(&b->read->settings) || b->require_bc)
    VG_TRY(refuse_periodic(b, reason, err));
  VG_TRY(refuse_empty(b, has_faces, reason, err));
  for (size_t i = 0; i < m->n_patch; i++) *n_wall += reason[i] != VG_WALL_NOT;
  if (!*n_wall && vg_walls_asked(&b->read->settings)) st = no_walls(b, err);
done:
  free(mark_of);
  return st;
}

vg_status vg_walls_extend(const struct vg_boundary *b,
                          enum vg_wall_reason *reason, uint32_t *from,
                          struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  uint8_t *is_wall = vg_calloc(2 * m->n_patch, 1);
  uint8_t *may = is_wall ? is_wall + m->n_patch : NULL;
  vg_status st;

  if (!is_wall) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < m->n_patch; i++) {
    is_wall[i] = reason[i] != VG_WALL_NOT && !m->patch[i].inner;
    may[i] = reason[i] == VG_WALL_NOT && i < n_own(b) && !m->patch[i].inner &&
             !vg_pairs_have(&b->pairs, m->patch[i].id) &&
             vg_settings_layer_row(&b->read->settings, m->patch[i].id).grow !=
               VG_ANSWER_NO;
  }
  st = vg_slides_extend(m, is_wall, may, from, err);
  for (size_t i = 0; st >= 0 && i < m->n_patch; i++)
    if (from[i] != VG_NO_INDEX) reason[i] = VG_WALL_EXTENDED;
  free(is_wall);
  return st;
}

/* Whether the height is below this share of the longest edge. */
static int is_sliver(const struct vg_mesh *m, const uint32_t t[3], double share)
{
  double e[3][3], n[3], longest = 0;

  for (int k = 0; k < 3; k++) {
    vg_sub(m->point[t[(k + 1) % 3]], m->point[t[k]], e[k]);
    longest = fmax(longest, vg_dot(e[k], e[k]));
  }
  vg_cross(e[0], e[1], n);
  return vg_norm(n) < share * longest;
}

/* On walls, layers would invert on slivers. Elsewhere only flat triangles
 * degrade the cells on them. Patches next to walls are remeshed anyway. */
static int has_slivers(const struct vg_mesh *m,
                       const enum vg_wall_reason *reason)
{
  for (size_t i = 0; i < m->n_tri; i++)
    if (!reason || reason[m->tri_patch[i]] != VG_WALL_NOT) {
      if (is_sliver(m, m->tri[i], reason ? VG_SWAP_SLIVER : FLAT)) return 1;
    }
  return 0;
}

vg_status vg_walls_swap(struct vg_boundary *b,
                        const enum vg_wall_reason *reason, struct vg_error *err)
{
  const struct vg_swap_options o = VG_SWAP_OPTIONS_INIT;
  struct vg_swap_report r = VG_SWAP_REPORT_INIT;
  const int answer = b->read->settings.swap;
  vg_status st;

  /* Triangles in a stretched metric may have small angles. */
  if (vg_mesh_has_inner(&b->surface) || b->read->is_section || b->pairs.n)
    return VG_OK;
  b->is_swapped = answer == VG_ANSWER_AUTO ? !vg_boundary_is_stretched(b) &&
                                               has_slivers(&b->surface, reason)
                                           : answer == VG_ANSWER_YES;
  if (!b->is_swapped) return VG_OK;
  st = vg_surface_swap(&b->surface, &o, &r, err);
  if (st < 0) return st;
  vg_note(b->notes,
          "slivers of the surface: caps reduced from %zu to %zu, needles "
          "from %zu to %zu, by %zu swaps and %zu collapses of edges that "
          "move the surface by at most %.2g (--surface-swap no keeps it "
          "unchanged)",
          r.n_cap[0], r.n_cap[1], r.n_needle[0], r.n_needle[1], r.n_swapped,
          r.n_collapsed, r.moved);
  return st;
}
