/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/source_effect.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "run/common/text.h"
#include "run/settings/plan_options.h"

vg_status vg_boundary_effects(const struct vg_boundary *b,
                              const struct vg_mesh *front,
                              const struct vg_sizing *sizing,
                              struct vg_effects *out, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_sizing_options o = vg_options_sizing(s, NULL);

  return vg_effects_find(&o, s->n_source, s->source, front, &b->surface, sizing,
                         out, err);
}

static const char *kind_of(const struct vg_source *s)
{
  static const char *const name[] = { [VG_SOURCE_VGRID_NODE] = "vgrid_node",
                                      [VG_SOURCE_VGRID_LINE] = "vgrid_line",
                                      [VG_SOURCE_POINT] = "point",
                                      [VG_SOURCE_LINE] = "line",
                                      [VG_SOURCE_TRIANGLE] = "triangle",
                                      [VG_SOURCE_BOX] = "box",
                                      [VG_SOURCE_SPHERE] = "sphere",
                                      [VG_SOURCE_CYLINDER] = "cylinder",
                                      [VG_SOURCE_MACHCONE] = "machcone" };

  return name[s->kind];
}

static const struct vg_patch *patch_of(const struct vg_limited_source *h,
                                       const struct vg_mesh *front)
{
  return h->face == SIZE_MAX || !front->tri_patch
         ? NULL
         : front->patch + front->tri_patch[h->face];
}

static int is_wholly(const struct vg_limited_source *h)
{
  return h->n_limited == h->n_place;
}

/* What limits the source, and a remedy. */
static void explain(const struct vg_limited_source *h,
                    const struct vg_mesh *front, char *text, size_t size)
{
  const struct vg_patch *patch = patch_of(h, front);
  int n;

  if (!patch) {
    snprintf(text, size,
             "the octree of the sizing field is at its limit and no face "
             "limits it; use fewer or coarser sources");
    return;
  }
  n = snprintf(text, size,
               "faces with edges of length %.3g on patch %d%s%.40s%s, at a "
               "distance of %.3g, limit it; make their edges no longer than "
               "%.3g",
               h->edge, (int)patch->id, patch->name[0] ? " (" : "", patch->name,
               patch->name[0] ? ")" : "", h->distance, h->edge_wanted);
  if (h->growth_wanted > 0 && n > 0 && (size_t)n < size)
    snprintf(text + n, size - (size_t)n, ", or increase growth to %.3g",
             h->growth_wanted);
}

static void note_limited(const struct vg_limited_source *h,
                         const struct vg_mesh *front, const struct vg_source *s,
                         struct vg_notes *notes)
{
  char name[160], why[320];

  snprintf(name, sizeof name, "source %zu (%s%s%.32s, from %.4g %.4g %.4g)",
           h->source + 1, kind_of(s), s->group[0] ? " of " : "", s->group,
           s->p0[0], s->p0[1], s->p0[2]);
  explain(h, front, why, sizeof why);
  if (is_wholly(h))
    vg_note(notes,
            "%s is limited everywhere: it requests a size of %.3g but gets "
            "%.3g at best, at (%.4g, %.4g, %.4g), where %s",
            name, h->asked, h->got, h->at[0], h->at[1], h->at[2], why);
  else
    vg_note(notes,
            "%s is limited at %zu of %zu sample points: at (%.4g, %.4g, %.4g) "
            "it requests a size of %.3g but gets %.3g, where %s",
            name, h->n_limited, h->n_place, h->at[0], h->at[1], h->at[2],
            h->asked, h->got, why);
}

static void note_unmet(const struct vg_unmet_source *u,
                       const struct vg_source *s, struct vg_notes *notes)
{
  vg_note(notes,
          "source %zu (%s%s%.32s) is not resolved at %zu of %zu sample "
          "points: at (%.4g, %.4g, %.4g) the size is %.3g, but no point of "
          "the mesh is within twice that distance, because sizes increase "
          "faster around it than cells can follow; use a larger radius, or a "
          "growth of at most 2",
          u->source + 1, kind_of(s), s->group[0] ? " of " : "", s->group,
          u->n_unmet, u->n_place, u->place.x[0], u->place.x[1], u->place.x[2],
          u->place.got);
}

static void note_outside(const struct vg_effects *h, int is_beyond,
                         struct vg_notes *notes)
{
  char list[200] = "";
  size_t n = 0, at = 0;

  for (size_t i = 0; i < h->n_outside; i++) {
    if (h->outside[i].is_beyond != is_beyond) continue;
    n++;
    if (at + 24 < sizeof list)
      at += (size_t)snprintf(list + at, sizeof list - at, " %zu",
                             h->outside[i].source + 1);
    else if (list[at - 1] != '.')
      at += (size_t)snprintf(list + at, sizeof list - at, " ...");
  }
  if (!n) return;
  vg_note(notes,
          "%zu source%s (number%s%s) %s completely %s; only the growth of "
          "sizes around %s affects the fluid",
          n, n > 1 ? "s" : "", n > 1 ? "s" : "", list, n > 1 ? "lie" : "lies",
          is_beyond ? "outside the domain"
                    : "inside a body or beyond the boundary",
          n > 1 ? "them" : "it");
}

/* Of consecutive sources of one group, as those of a wake, only the first is
 * described. */
static int is_described(const struct vg_effects *h, size_t i,
                        const struct vg_source *source)
{
  const char *group = source[h->item[i].source].group;

  return !i || !*group || strcmp(source[h->item[i - 1].source].group, group);
}

void vg_effects_note(const struct vg_effects *h, const struct vg_mesh *front,
                     const struct vg_settings *s, struct vg_notes *notes)
{
  size_t shown = 0;

  for (size_t i = 0; i < h->n && shown < VG_SHOWN_LIMITED; i++) {
    if (!is_described(h, i, s->source)) continue;
    note_limited(h->item + i, front, s->source + h->item[i].source, notes);
    shown++;
  }
  if (h->n > shown)
    vg_note(notes,
            "%zu further sources are limited by the surface; the JSON report "
            "lists them all",
            h->n - shown);
  for (size_t i = 0; i < h->n_unmet && i < VG_SHOWN_LIMITED; i++)
    note_unmet(h->unmet + i, s->source + h->unmet[i].source, notes);
  if (h->n_unmet > VG_SHOWN_LIMITED)
    vg_note(notes,
            "%zu further sources are not resolved; the JSON report lists them "
            "all",
            h->n_unmet - VG_SHOWN_LIMITED);
  note_outside(h, 0, notes);
  note_outside(h, 1, notes);
}

static json_t *item_json(const struct vg_limited_source *h,
                         const struct vg_mesh *front, const struct vg_source *s)
{
  const struct vg_patch *patch = patch_of(h, front);
  json_t *o = json_pack("{s:I s:s s:b s:I s:I s:[f,f,f] s:f s:f}", "source",
                        (json_int_t)h->source + 1, "kind", kind_of(s),
                        "everywhere", is_wholly(h), "sample_points",
                        (json_int_t)h->n_place, "sample_points_limited",
                        (json_int_t)h->n_limited, "at", h->at[0], h->at[1],
                        h->at[2], "requested", h->asked, "actual", h->got);

  if (s->group[0]) json_object_set_new(o, "group", vg_text_json(s->group));
  if (!patch) return o;
  json_object_set_new(o, "patch", json_integer(patch->id));
  json_object_set_new(o, "patch_name", vg_text_json(patch->name));
  json_object_set_new(o, "edge", json_real(h->edge));
  json_object_set_new(o, "distance", json_real(h->distance));
  json_object_set_new(o, "edge_required", json_real(h->edge_wanted));
  if (h->growth_wanted > 0)
    json_object_set_new(o, "growth_required", json_real(h->growth_wanted));
  return o;
}

json_t *vg_effects_json(const struct vg_effects *h, const struct vg_mesh *front,
                        const struct vg_settings *s)
{
  json_t *o = json_object(), *held = json_array(), *outside[2];
  json_t *unmet = json_array();

  for (size_t i = 0; i < h->n; i++)
    json_array_append_new(held, item_json(h->item + i, front,
                                          s->source + h->item[i].source));
  for (int k = 0; k < 2; k++) outside[k] = json_array();
  for (size_t i = 0; i < h->n_outside; i++)
    json_array_append_new(outside[h->outside[i].is_beyond],
                          json_integer((json_int_t)h->outside[i].source + 1));
  for (size_t i = 0; i < h->n_unmet; i++) {
    const struct vg_unmet_source *u = h->unmet + i;

    json_array_append_new(
      unmet, json_pack("{s:I s:s s:I s:I s:[f,f,f] s:f}", "source",
                       (json_int_t)u->source + 1, "kind",
                       kind_of(s->source + u->source), "sample_points",
                       (json_int_t)u->n_place, "sample_points_unresolved",
                       (json_int_t)u->n_unmet, "at", u->place.x[0],
                       u->place.x[1], u->place.x[2], "actual", u->place.got));
  }
  json_object_set_new(o, "limited", held);
  json_object_set_new(o, "unresolved", unmet);
  json_object_set_new(o, "inside_body", outside[0]);
  json_object_set_new(o, "outside_domain", outside[1]);
  return o;
}
