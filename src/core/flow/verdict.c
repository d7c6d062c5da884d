/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/flow/verdict.h"

#include <assert.h>
#include <stdio.h>

/* F3: thresholds of rule 5. */
#define CONVEX 0.7  /* of its hull's silhouette: an enclosure covers more */
#define HOLLOW 0.3  /* of its volume: a hollow shell contains more */
#define FILLED 0.02 /* of its volume: a tunnel is not filled more */
#define FINE 0.2    /* of its triangles: a tunnel contains more */
#define BUBBLE 1e-3 /* of its volume: a bubble is not larger */
#define COARSE 0.05 /* of its triangles: a bubble has no more */

static enum vg_flow_verdict say(char *why, enum vg_flow_verdict v,
                                const char *text)
{
  snprintf(why, VG_FLOW_TEXT, "%s", text);
  return v;
}

static enum vg_flow_verdict by_openings(const struct vg_flow_shell *s,
                                        char *why)
{
  const size_t n = s->n_opening;

  if (n > 1 && s->n_opening_end == n) {
    snprintf(why, VG_FLOW_TEXT,
             "the inlets and outlets, patches %s, are flat "
             "ends of the shell, and its walls meet them steeply",
             s->openings);
    return VG_FLOW_OUTER;
  }
  if (n > 1 && s->n_opening_flush &&
      s->n_opening_end + s->n_opening_flush == n) {
    snprintf(why, VG_FLOW_TEXT,
             "the inlets and outlets, patches %s, are on the outermost planes "
             "of the shell, flush with its walls or flat ends",
             s->openings);
    return VG_FLOW_OUTER;
  }
  if (!s->n_opening_end && !s->n_opening_flush) {
    snprintf(why, VG_FLOW_TEXT,
             "the inlets and outlets, patches %s, lie inside the body's "
             "silhouette like engine faces",
             s->openings);
    return VG_FLOW_BODY;
  }
  snprintf(why, VG_FLOW_TEXT,
           "of the openings, patches %s, %zu of %zu are flat ends of the shell "
           "or flush with its walls: a duct or a room has two or more, all of "
           "them such; a body with engines has none",
           s->openings, s->n_opening_end + s->n_opening_flush, n);
  return VG_FLOW_EITHER;
}

static int has_walls_only(const struct vg_flow_shell *s)
{
  size_t n = 0;

  for (int k = 0; k < VG_ROLE_N; k++) n += s->n_role[k];
  return n && s->n_role[VG_ROLE_WALL] == n;
}

static enum vg_flow_verdict by_orientation(const struct vg_flow_shell *s,
                                           enum vg_flow_side side, char *why)
{
  if (side == VG_SIDE_DEFINED || !has_walls_only(s))
    return say(why, VG_FLOW_OUTER,
               "its triangles point into it, which in this "
               "format is the side of the fluid");
  return say(why, VG_FLOW_EITHER,
             "its triangles point into it, which in this format is the side "
             "of the fluid, but all of its patches are walls, like those of "
             "a body");
}

static enum vg_flow_verdict by_contents(const struct vg_flow_shell *s,
                                        char *why)
{
  if (s->is_named_enclosure)
    return say(why, VG_FLOW_OUTER,
               "other shells lie inside it, and it has the "
               "name of an enclosure");
  if (s->covered < CONVEX) {
    snprintf(why, VG_FLOW_TEXT,
             "it covers %.0f %% of the silhouette of its convex hull, like a "
             "body; the shells inside it (%zu) are sealed cavities",
             100 * s->covered, s->n_inside);
    return VG_FLOW_BODY;
  }
  if (s->share >= HOLLOW) {
    snprintf(why, VG_FLOW_TEXT,
             "the shells inside it (%zu) fill %.0f %% of "
             "its volume: it is hollow",
             s->n_inside, 100 * s->share);
    return VG_FLOW_BODY;
  }
  if (s->share <= BUBBLE && s->detail <= COARSE) {
    snprintf(why, VG_FLOW_TEXT,
             "the shells inside it (%zu) fill %.2g of its "
             "volume and have few triangles: they are bubbles in a body",
             s->n_inside, s->share);
    return VG_FLOW_BODY;
  }
  snprintf(why, VG_FLOW_TEXT,
           "it is %s, and the shells inside it (%zu) fill "
           "%.2g %% of its volume",
           s->is_box ? "a box" : "convex", s->n_inside, 100 * s->share);
  return s->is_box && s->share <= FILLED && s->detail >= FINE ? VG_FLOW_OUTER
                                                              : VG_FLOW_EITHER;
}

enum vg_flow_verdict vg_flow_judge(const struct vg_flow_shell *s,
                                   enum vg_flow_side side, char *why)
{
  assert(s && why);
  if (s->n_role[VG_ROLE_FARFIELD]) {
    snprintf(why, VG_FLOW_TEXT, "patches %s have a farfield condition or name",
             s->far);
    return VG_FLOW_OUTER;
  }
  if (s->n_opening) return by_openings(s, why);
  if (side && s->points_in) return by_orientation(s, side, why);
  if (s->has_pocket) {
    snprintf(why, VG_FLOW_TEXT,
             "its outer part is a box, or part of a sphere, that covers at "
             "least %.0f %% of the silhouette of its hull in every view "
             "along x, y and z, and the rest of it is inside that part",
             100 * (s->covered < 1 ? s->covered : 1));
    return VG_FLOW_OUTER;
  }
  if (s->n_inside) return by_contents(s, why);
  if (s->n_role[VG_ROLE_WALL] && s->n_plain_end) {
    snprintf(why, VG_FLOW_TEXT,
             "patches %s are flat ends without condition "
             "and name next to named walls: they may be openings of a duct or "
             "walls of a body",
             s->plain);
    return VG_FLOW_EITHER;
  }
  if (s->n_symmetry_end > 1)
    return say(why, VG_FLOW_EITHER,
               "two or more flat ends have the condition "
               "or name of a symmetry plane: the surface may bound a channel, "
               "or a body between two planes");
  return say(why, VG_FLOW_BODY,
             "no patch has the condition or name of an outer boundary, inlet "
             "or outlet, and no other shell lies inside");
}
