/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Findings of the surface check as text. */
#include <assert.h>
#include <stdio.h>

#include "core/surface/surface_check.h"

const char *vg_defect_name(enum vg_defect_kind kind)
{
  static const char *const name[VG_DEFECT_N] = {
    "open edge",          "non-manifold edge",     "orientation",
    "duplicate point",    "unused point",          "degenerate triangle",
    "duplicate triangle", "shared wall",           "self-intersection",
    "shell nesting",      "no boundary condition", "coordinate not finite",
    "quadrilateral"
  };

  return (unsigned)kind < VG_DEFECT_N ? name[kind] : "unknown";
}

const char *vg_defect_heading(enum vg_defect_kind kind)
{
  static const char *const heading[VG_DEFECT_N] = {
    "open edges",
    "non-manifold edges",
    "edges with inconsistent orientation",
    "duplicate points",
    "unused points",
    "degenerate triangles",
    "duplicate triangles",
    "triangles of shared walls",
    "self-intersections",
    "shells with inconsistent nesting",
    "patches without boundary condition",
    "non-finite coordinates",
    "quadrilaterals"
  };

  return (unsigned)kind < VG_DEFECT_N ? heading[kind] : "unknown";
}

/* "patch 3 (wing), face 17", or "" if the finding has no such face. */
/* The patch of a face, or NULL. */
static const struct vg_patch *patch_of(const struct vg_mesh *m, size_t f)
{
  int is_tri = f < m->n_tri;
  size_t q = f - m->n_tri;

  if (f == SIZE_MAX || (!is_tri && q >= m->n_quad)) return NULL;
  return &m->patch[is_tri ? m->tri_patch[f] : m->quad_patch[q]];
}

static int is_inner(const struct vg_mesh *m, size_t f)
{
  const struct vg_patch *p = patch_of(m, f);

  return p && (p->inner != VG_INNER_NOT || p->is_sheet);
}

static void face_text(const struct vg_mesh *m, size_t f, char *text,
                      size_t size)
{
  int is_tri = f < m->n_tri;
  size_t q = f - m->n_tri;
  const struct vg_patch *p = patch_of(m, f);

  text[0] = 0;
  if (!p) return;
  snprintf(text, size, "patch %d%s%.*s%s, %s %zu", (int)p->id,
           p->name[0] ? " (" : "", VG_NAME_MAX, p->name, p->name[0] ? ")" : "",
           is_tri ? "face" : "quadrilateral", is_tri ? f + 1 : q + 1);
}

static void where(const double at[3], char *text, size_t size)
{
  snprintf(text, size, "(%.9g, %.9g, %.9g)", at[0], at[1], at[2]);
}

static void points_text(const struct vg_defect *d, char *text, size_t size)
{
  text[0] = 0;
  if (d->point[0] != SIZE_MAX && d->point[1] != SIZE_MAX)
    snprintf(text, size, "points %zu and %zu", d->point[0] + 1,
             d->point[1] + 1);
  else if (d->point[0] != SIZE_MAX)
    snprintf(text, size, "point %zu", d->point[0] + 1);
}

static const char *shell_text(const struct vg_defect *d)
{
  if (d->face[1] != SIZE_MAX)
    return "this closed shell lies within another one with the solid on the "
           "same side; remove it, or turn it if it is a cavity with fluid";
  return "this closed shell encloses no volume, or has solid and fluid "
         "exchanged; remove or turn it";
}

static const char *remedy(const struct vg_mesh *m, const struct vg_defect *d)
{
  switch (d->kind) {
  case VG_DEFECT_OPEN_EDGE:
    return "only one face has this edge; close the gap, or weld the points "
           "with a tolerance";
  case VG_DEFECT_NONMANIFOLD_EDGE:
    return "three or more faces meet in this edge; remove inner walls and "
           "doubled faces, or separate the bodies";
  case VG_DEFECT_ORIENTATION:
    return "the faces on this edge have opposite orientations; turn one part "
           "of the surface (a one-sided surface bounds no volume)";
  case VG_DEFECT_DUPLICATE_POINT:
    return "two points have the same coordinates; weld the surface";
  case VG_DEFECT_UNUSED_POINT: return "no face uses this point; remove it";
  case VG_DEFECT_DEGENERATE_TRIANGLE:
    return "the triangle has no area; remove it by swapping or collapsing an "
           "edge";
  case VG_DEFECT_DUPLICATE_TRIANGLE:
    if (is_inner(m, d->face[0]) || is_inner(m, d->face[1]))
      return "two triangles have the same points; the file has to contain each "
             "triangle of an inner surface once: remove one of them there";
    return "two triangles have the same points; remove one, or both if they "
           "are a wall of zero thickness";
  case VG_DEFECT_SHARED_WALL:
    return "this triangle belongs to two bodies that touch; unite the "
           "bodies, or use --wrap";
  case VG_DEFECT_INTERSECTION:
    if (is_inner(m, d->face[0]) || is_inner(m, d->face[1]))
      return "these faces cross, overlap or touch; set remesh_surface to yes, "
             "which cuts the inner surface there, or let it end there with "
             "common edges, or move it away";
    return "these faces cross, overlap or touch; unite the bodies, or move "
           "the surfaces apart there";
  case VG_DEFECT_SHELL: return shell_text(d);
  case VG_DEFECT_NO_BC:
    return "this patch has no boundary condition; give it one in the .mapbc "
           "file or the deck";
  case VG_DEFECT_NOT_FINITE:
    return "a coordinate is NaN or infinite; repair the file";
  case VG_DEFECT_QUAD:
    return "the surface must consist of triangles; split the quadrilateral";
  default: return "";
  }
}

void vg_defect_text(const struct vg_mesh *m, const struct vg_defect *d,
                    char *text, size_t size)
{
  char one[VG_NAME_MAX + 64], two[VG_NAME_MAX + 64], points[64], at[96];

  assert(text && size > 0);
  face_text(m, d->face[0], one, sizeof one);
  face_text(m, d->face[1], two, sizeof two);
  points_text(d, points, sizeof points);
  where(d->at, at, sizeof at);
  snprintf(text, size, "%s: %s%s%s%s%s%s at %s: %s", vg_defect_name(d->kind),
           one, *one && *two ? "; " : "", two,
           (*one || *two) && *points ? "; " : "", points,
           *one || *two || *points ? "" : "surface", at, remedy(m, d));
}
