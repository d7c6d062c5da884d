/* The table `surface`: sizes of single patches, curves, leading edges and
 * strips of a surface that is made anew, as largest sizes at the points that it
 * has now, and curves along which edges are stretched. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "run/input/input.h"

#define SECTIONS 256      /* along the span of a patch */

static vg_status find_patch(const struct vg_mesh *m, int32_t id, size_t *at,
                            struct vg_error *err)
{
  *at = vg_mesh_find_patch(m, id);
  if (*at != SIZE_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "surface: there is no patch %d; vanguard "
                 "check lists those of the surface", (int)id);
}

static void lower(double *cap, uint32_t p, double size)
{
  cap[p] = fmin(cap[p], size);
}

/* --- curves -------------------------------------------------------------- */

struct side { uint32_t lo, hi, patch, half; };

static int by_ends(const void *pa, const void *pb)
{
  const struct side *a = pa, *b = pb;

  if (a->lo != b->lo) return a->lo < b->lo ? -1 : 1;
  if (a->hi != b->hi) return a->hi < b->hi ? -1 : 1;
  return (a->patch > b->patch) - (a->patch < b->patch);
}

/* Edges between patches a and b. */
static vg_status size_curve(const struct vg_mesh *m, size_t a, size_t b,
                            double size, double stretch,
                            struct vg_surface_sizes *to, struct vg_error *err)
{
  struct side *s = vg_alloc(3 * m->n_tri, sizeof *s);
  size_t n = 0, n_edge = 0;

  if (!s) return vg_fail_memory(err, "the edges of two patches");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = m->tri[t][k], q = m->tri[t][(k + 1) % 3];

      if (m->tri_patch[t] != a && m->tri_patch[t] != b) continue;
      s[n++] = (struct side){ p < q ? p : q, p < q ? q : p, m->tri_patch[t],
                              (uint32_t)(3 * t) + (uint32_t)k };
    }
  qsort(s, n, sizeof *s, by_ends);
  for (size_t i = 1; i < n; i++)
    if (s[i].lo == s[i - 1].lo && s[i].hi == s[i - 1].hi
        && s[i].patch != s[i - 1].patch) {
      lower(to->cap, s[i].lo, size);
      lower(to->cap, s[i].hi, size);
      for (size_t j = i - 1; stretch > 0 && j <= i; j++)
        to->stretch[s[j].half] = stretch;
      n_edge++;
    }
  free(s);
  if (n_edge) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "surface: patches %d and %d have no edge "
                 "in common, so there is no curve between them",
                 (int)m->patch[a].id, (int)m->patch[b].id);
}

/* --- leading edges ------------------------------------------------------- */

/* x from `lo` to `hi` of a patch in sections across y or z, whichever it is
 * longer along; the flow is along x. */
struct sections {
  int axis;
  double from, step;
  double lo[SECTIONS], hi[SECTIONS];
};

static double section_at(const struct sections *s, size_t i)
{
  return s->from + s->step * ((double)i + 0.5);
}

/* The line ab, where it crosses sections. */
static void cross(struct sections *s, const double *a, const double *b)
{
  const double *l = a[s->axis] < b[s->axis] ? a : b, *h = l == a ? b : a;
  double first = (l[s->axis] - s->from) / s->step - 0.5;

  for (size_t i = first > 0 ? (size_t)ceil(first) : 0; i < SECTIONS; i++) {
    double at = section_at(s, i), t, x;

    if (at > h[s->axis]) break;
    t = (at - l[s->axis]) / (h[s->axis] - l[s->axis]);
    x = isfinite(t) ? l[0] + t * (h[0] - l[0]) : l[0];
    s->lo[i] = fmin(s->lo[i], x);
    s->hi[i] = fmax(s->hi[i], x);
  }
}

static void cut(struct sections *s, const struct vg_mesh *m, size_t patch)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++)
      for (int d = 0; d < 3; d++) {
        lo[d] = fmin(lo[d], m->point[m->tri[t][k]][d]);
        hi[d] = fmax(hi[d], m->point[m->tri[t][k]][d]);
      }
  s->axis = hi[1] - lo[1] >= hi[2] - lo[2] ? 1 : 2;
  s->from = lo[s->axis];
  s->step = (hi[s->axis] - s->from) / SECTIONS;
  for (int i = 0; i < SECTIONS; i++) s->lo[i] = INFINITY, s->hi[i] = -INFINITY;
  for (size_t t = 0; t < m->n_tri && s->step > 0; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++)
      cross(s, m->point[m->tri[t][k]], m->point[m->tri[t][(k + 1) % 3]]);
}

/* Chord of the patch where x is, and how far x is behind its front. */
static int chord_at(const struct sections *s, const double x[3],
                    double *chord, double *behind)
{
  double at = (x[s->axis] - s->from) / s->step - 0.5, t;
  size_t i = at > 0 ? (size_t)at : 0;

  if (!(s->step > 0)) return 0;
  if (i > SECTIONS - 2) i = SECTIONS - 2;
  t = at - (double)i;
  if (!(s->hi[i] >= s->lo[i] && s->hi[i + 1] >= s->lo[i + 1])) return 0;
  *behind = x[0] - (s->lo[i] + t * (s->lo[i + 1] - s->lo[i]));
  *chord = s->hi[i] - s->lo[i]
           + t * (s->hi[i + 1] - s->lo[i + 1] - s->hi[i] + s->lo[i]);
  return *chord > 0;
}

static void size_lead(const struct vg_mesh *m, size_t patch, double share,
                      double growth, double *cap)
{
  struct sections s;

  cut(&s, m, patch);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == patch; k++) {
      uint32_t p = m->tri[t][k];
      double chord, behind;

      if (chord_at(&s, m->point[p], &chord, &behind))
        lower(cap, p, share * chord + (growth - 1) * fmax(behind, 0));
    }
}

/* --- all ----------------------------------------------------------------- */

static vg_status take_row(const struct vg_problem *p,
                          const struct vg_surface_row *row,
                          struct vg_surface_sizes *s, struct vg_error *err)
{
  const struct vg_mesh *m = &p->surface;
  const double size = row->size > 0 ? row->size : INFINITY;
  size_t a, b;
  vg_status st;

  VG_TRY(find_patch(m, row->patch, &a, err));
  if (row->beside != VG_BC_NONE) {
    VG_TRY(find_patch(m, row->beside, &b, err));
    if (row->stretch > 0 && !s->stretch) {
      s->stretch = vg_calloc(3 * m->n_tri, sizeof *s->stretch);
      if (!s->stretch) VG_TRY(vg_fail_memory(err, "the stretched edges"));
    }
    st = size_curve(m, a, b, size, row->stretch, s, err);
    goto done;
  }
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && m->tri_patch[t] == a; k++)
      lower(s->cap, m->tri[t][k], size);
  if (row->lead > 0) size_lead(m, a, row->lead, p->settings.growth, s->cap);
  if (row->across > 0) s->across[a] = row->across;
done:
  return st;
}

vg_status vg_surface_sizes_make(const struct vg_problem *p,
                                struct vg_surface_sizes *s,
                                struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!p->settings.n_surface) return VG_OK;
  s->cap = vg_alloc(p->surface.n_point, sizeof *s->cap);
  s->across = vg_alloc(p->surface.n_patch, sizeof *s->across);
  if (!s->cap || !s->across)
    return vg_fail_memory(err, "the sizes on the surface");
  for (size_t i = 0; i < p->surface.n_point; i++) s->cap[i] = INFINITY;
  for (size_t i = 0; i < p->surface.n_patch; i++) s->across[i] = 1;
  for (size_t i = 0; i < p->settings.n_surface; i++)
    VG_TRY(take_row(p, &p->settings.surface_row[i], s, err));
  for (size_t i = 0; i < p->surface.n_point; i++)
    s->cap[i] *= p->settings.scale;
done:
  return st;
}

void vg_surface_sizes_release(struct vg_surface_sizes *s)
{
  free(s->cap);
  free(s->across);
  free(s->stretch);
  memset(s, 0, sizeof *s);
}
