/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/grow/grow.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/clock.h"
#include "base/memory.h"
#include "core/mesh/copies.h"
#include "core/mesh/mesh_defects.h"
#include "core/surface/surface_check.h"
#include "layers/expand/expand_defects.h"
#include "layers/grow/grow_parts.h"

#define ROUNDS_MAX 300 /* L2 */
/* Rounds after which columns that still fail lose all layers. */
#define LAST_RESORT 150
/* Rounds with valid cells in which heights are lowered only gradually. */
#define GENTLE 40
#define SHARE 0.75
#define TURNS_MAX 12 /* Rounds in which columns may be turned. */
/* L23: Fronts that approach each other end at least twice this share of the
 * local edge apart. */
#define MARGIN 0.25

static void work_release(struct vg_layer_work *w)
{
  vg_topology_release(&w->t);
  vg_twins_release(&w->twins);
  free(w->slide);
  free(w->is_wall);
  free(w->is_slide);
  free(w->noise);
  free(w->normal);
  free(w->cap);
  free(w->root_dir);
  free(w->visibility);
  free(w->edge);
  free(w->margin);
  free(w->wanted);
  free(w->allowed);
  free(w->slack);
  free(w->settled);
  free(w->own);
  free(w->why);
  free(w->by_size);
}

static vg_status check_request(const struct vg_mesh *m, size_t p,
                               const struct vg_layer_request *r,
                               struct vg_error *err)
{
  const struct vg_growth_law *l = &r->law;

  if (!r->is_wall) return VG_OK;
  if (!(l->delta1 > 0 && l->delta1 < 1e60))
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d: the first layer is %g thick; give a height "
                   "above 0",
                   (int)m->patch[p].id, l->delta1);
  if (!(l->rate1 >= 0 && l->rate1 <= 10 && l->rate2 >= 0 && l->rate2 <= 10))
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d: the growth rates are %g and %g; they must be "
                   "between 0 and 10",
                   (int)m->patch[p].id, l->rate1, l->rate2);
  if (!(l->cap >= 1))
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d: the cap on growth is %g; it must be at least 1",
                   (int)m->patch[p].id, l->cap);
  return VG_OK;
}

static double off_plane(const struct vg_slide *s, const double x[3])
{
  return s->normal[0] * x[0] + s->normal[1] * x[1] + s->normal[2] * x[2] -
         s->at;
}

static vg_status roughness(struct vg_layer_work *w, struct vg_error *err)
{
  w->noise = vg_alloc(w->n_slide, sizeof *w->noise);
  if (!w->noise) return vg_fail_memory(err, "the layers");
  for (size_t s = 0; s < w->n_slide; s++) {
    const struct vg_slide *slide = &w->slide[s];

    w->is_slide[slide->patch] = 1;
    w->noise[s] = slide->is_plane ? 0 : INFINITY;
    for (size_t t = 0; slide->is_plane && t < w->m->n_tri; t++)
      for (int k = 0; w->m->tri_patch[t] == slide->patch && k < 3; k++)
        w->noise[s] = fmax(w->noise[s],
                           fabs(
                             off_plane(slide, w->m->point[w->m->tri[t][k]])));
  }
  return VG_OK;
}

/* A periodic patch is plane if its image is. */
static void agree_on_planes(struct vg_layer_work *w)
{
  for (size_t p = 0; p < w->twins.n; p++) {
    struct vg_slide *s[2] = { NULL, NULL };

    for (size_t i = 0; i < w->n_slide; i++)
      for (int k = 0; k < 2; k++)
        if (w->slide[i].patch == w->twins.patch[p][k]) s[k] = &w->slide[i];
    if (!s[0] || !s[1] || s[0]->is_plane == s[1]->is_plane) continue;
    for (int k = 0; k < 2; k++) {
      s[k]->is_plane = 0;
      s[k]->axis = -1;
    }
  }
}

static vg_status walls(struct vg_layer_work *w, struct vg_error *err)
{
  size_t n = 0;
  vg_status st = VG_OK;

  w->is_wall = vg_calloc(w->m->n_patch, 1);
  w->is_slide = vg_calloc(w->m->n_patch, 1);
  if (!w->is_wall || !w->is_slide) return vg_fail_memory(err, "the layers");
  for (size_t p = 0; p < w->m->n_patch; p++) {
    VG_TRY(check_request(w->m, p, &w->o->patch[p], err));
    w->is_wall[p] = w->o->patch[p].is_wall != 0;
    n += w->is_wall[p];
  }
  if (!n)
    return vg_fail(err, VG_ERR_INPUT,
                   "layers were requested, but no patch is a wall with layers");
  if (!(w->o->gap > 0 && w->o->gap < 0.5 && w->o->end > 0 && w->o->slope > 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "the share of a gap that layers may take is %g, the "
                   "thickness at which layers end is %g edges and their slope "
                   "is %g; the first must be between 0 and 0.5, the others "
                   "above 0",
                   w->o->gap, w->o->end, w->o->slope);
  if (!(w->o->jump >= 1))
    return vg_fail(err, VG_ERR_INPUT,
                   "the volume ratio across the tops to aim at is %g; it must "
                   "be at least 1",
                   w->o->jump);
  VG_TRY(vg_slides_find(w->m, w->is_wall, &w->n_slide, &w->slide, err));
  VG_TRY(vg_twins_open(w->m, w->o->n_periodic, w->o->periodic, &w->twins, err));
  agree_on_planes(w);
  st = roughness(w, err);
done:
  return st;
}

static vg_status arrays(struct vg_layer_work *w, struct vg_error *err)
{
  size_t n = w->c->n_column;

  w->normal = vg_alloc(w->c->n_face, sizeof *w->normal);
  w->cap = vg_calloc(w->c->n_face, 1);
  w->root_dir = vg_alloc(n, sizeof *w->root_dir);
  w->visibility = vg_alloc(n, sizeof *w->visibility);
  w->edge = vg_alloc(n, sizeof *w->edge);
  w->wanted = vg_alloc(n, sizeof *w->wanted);
  w->allowed = vg_alloc(n, sizeof *w->allowed);
  w->settled = vg_alloc(n, sizeof *w->settled);
  w->own = vg_calloc(n, sizeof *w->own);
  w->why = vg_calloc(n, 1);
  w->by_size = vg_calloc(n, 1);
  if (w->normal && w->cap && w->root_dir && w->visibility && w->edge &&
      w->wanted && w->allowed && w->settled && w->own && w->why && w->by_size)
    return VG_OK;
  return vg_fail_memory(err, "the layers");
}

/* Height of column i that leaves both its margin and that of the opposite front
 * free, if `allowed` is the share of the gap that it may take: at most a share,
 * and at least a quarter of the gap (vg_clear_tops). */
static double within_margins(const struct vg_layer_work *w, size_t i,
                             double allowed)
{
  double gap = allowed / w->o->gap;
  double rest = gap / 2 - w->margin[i] / vg_norm(w->c->column[i].dir);

  return fmin(allowed, fmax(rest, gap / 4));
}

/* Initial allowed heights: limited by visibility, corners, and the opposite
 * surface. */
static vg_status first_allowed(struct vg_layer_work *w,
                               struct vg_layer_report *r, struct vg_error *err)
{
  size_t n = w->c->n_column;
  double *allowed = vg_alloc(n, sizeof *allowed), t = vg_clock();
  double(*normal)[3] = vg_alloc(w->max_valence, sizeof *normal);
  vg_status st;

  if (!allowed || !normal) {
    st = vg_fail_memory(err, "the layers");
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    const enum vg_layer_cause cause = w->c->column[i].cause;

    if (w->visibility[i] == 0 && cause != VG_CAUSE_INNER)
      vg_heights_lower(w, i, 0, vg_unseen_cause(w, i, normal));
    if (cause) vg_heights_lower(w, i, 0, cause);
  }
  VG_TRY(vg_heights_slack(w, err));
  VG_TRY(vg_heights_corner(w, err));
  r->time_height += vg_clock() - t;
  t = vg_clock();
  VG_TRY(vg_clear_ahead(w->m, w->c, &w->t, w->o->gap, w->o->threads, w->allowed,
                        allowed, err));
  for (size_t i = 0; i < n; i++)
    if (allowed[i] < w->allowed[i])
      vg_heights_lower(w, i, within_margins(w, i, allowed[i]),
                       VG_CAUSE_PROXIMITY);
  r->time_clear += vg_clock() - t;
done:
  free(allowed);
  free(normal);
  return st;
}

static vg_status margins(struct vg_layer_work *w, struct vg_error *err)
{
  w->margin = vg_alloc(w->c->n_column, sizeof *w->margin);
  if (!w->margin) return vg_fail_memory(err, "the layers");
  for (size_t i = 0; i < w->c->n_column; i++)
    w->margin[i] = MARGIN * w->edge[i];
  return VG_OK;
}

/* Height to which one round lowers a column that failed. */
static double lowered(const struct vg_layer_work *w, size_t i, size_t round)
{
  const struct vg_column *c = &w->c->column[i];
  double d[VG_LEVELS_MAX + 1], h;

  if (round >= GENTLE || w->last_resort) return 0;
  vg_growth_law_heights(&w->c->law[c->law], c->cap, c->n, d);
  h = d[c->n] < w->allowed[i] ? d[c->n] : w->allowed[i];
  return SHARE * h;
}

static vg_status try_tops(struct vg_layer_work *w, const uint8_t *active,
                          const double *margin, uint8_t *bad, size_t round,
                          size_t *n_bad, struct vg_error *err)
{
  vg_status st = vg_clear_tops(w->m, w->c, w->is_slide, active, margin,
                               w->o->threads, bad, n_bad, err);

  for (size_t i = 0; st >= 0 && *n_bad && i < w->c->n_column; i++)
    if (bad[i])
      vg_heights_lower(w, i, lowered(w, i, round), VG_CAUSE_COLLISION);
  return st;
}

static vg_status try_slides(struct vg_layer_work *w, struct vg_front *front,
                            size_t round, size_t *n_bad, struct vg_error *err)
{
  struct vg_slide_failure failure = { 0 };
  vg_status st = vg_slide_front(w->m, w->n_slide, w->slide, &w->twins, w->c,
                                w->sizing, front, &failure, err);

  *n_bad = st == VG_BLOCKED ? failure.n : 0;
  for (size_t i = 0; st == VG_BLOCKED && i < failure.n; i++)
    vg_heights_lower(w, failure.column[i],
                     failure.never[i] ? 0
                                      : lowered(w, failure.column[i], round),
                     VG_CAUSE_SLIDE);
  free(failure.column);
  return st == VG_BLOCKED ? VG_OK : st;
}

/* Returns 1 if column i, which does not slide in patch p, starts in front of
 * the plane of the patch and ends on or behind it, and 2 if the patch is too
 * rough to decide. */
static int crosses(const struct vg_layer_work *w, uint32_t p, uint32_t i)
{
  const struct vg_column *c = &w->c->column[i];
  size_t s = 0;
  double top[3], root;

  if (c->slide[0] == p || c->slide[1] == p || !c->n) return 0;
  while (w->slide[s].patch != p) s++;
  root = off_plane(&w->slide[s], w->m->point[c->root]);
  if (fabs(root) <= 2 * w->noise[s]) return w->noise[s] > 0 ? 2 : 0;
  vg_column_top(w->c, w->m, i, top);
  return root > 0 && !(off_plane(&w->slide[s], top) > 2 * w->noise[s]);
}

/* Finds tops that touch a slide plane with an edge or corner and cross it
 * elsewhere. vg_clear_tops has tested all other pairs, so the front is free of
 * collisions if no such top exists, unless a patch was too rough. */
static void try_sides(struct vg_layer_work *w, uint8_t *bad, size_t round,
                      size_t *n_bad, int *is_unsure)
{
  memset(bad, 0, w->c->n_column);
  *n_bad = 0;
  *is_unsure = 0;
  for (size_t f = 0; f < w->c->n_face; f++)
    for (int k = 0; k < 3; k++) {
      const struct vg_column *c = &w->c->column[w->c->face[f][k]];

      for (int q = 0; q < 2 && c->slide[q] != VG_NO_INDEX; q++)
        for (int o = 1; o < 3; o++) {
          int how = crosses(w, c->slide[q], w->c->face[f][(k + o) % 3]);

          if (how == 1) bad[w->c->face[f][(k + o) % 3]] = 1;
          if (how == 2) *is_unsure = 1;
        }
    }
  for (size_t i = 0; i < w->c->n_column; i++) {
    if (!bad[i]) continue;
    vg_heights_lower(w, i, lowered(w, i, round), VG_CAUSE_COLLISION);
    ++*n_bad;
  }
}

/* A front to be checked, with one point for all copies of a point of an inner
 * surface, and one of two sides that lie back to back. */
struct closed {
  struct vg_mesh mesh; /* Without inner surfaces, its arrays are borrowed. */
  uint32_t *of;        /* [mesh.n_tri] face of the front; NULL: the same. */
};

static void closed_release(struct closed *c)
{
  if (!c->of) return;
  free(c->of);
  free(c->mesh.tri);
  free(c->mesh.tri_patch);
}

static vg_status close_front(const struct vg_front *front,
                             const struct vg_mesh *surface, struct closed *c,
                             struct vg_error *err)
{
  const struct vg_mesh m = vg_front_mesh(front, surface);
  uint32_t *first = NULL, *other = NULL;
  vg_status st;

  *c = (struct closed){ .mesh = m };
  VG_TRY(vg_mesh_inner_points(&m, &first, err));
  if (!first) return VG_OK;
  other = vg_alloc(m.n_tri, sizeof *other);
  c->of = vg_alloc(m.n_tri, sizeof *c->of);
  if (!other || !c->of) VG_TRY(vg_fail_memory(err, "the front of the layers"));
  c->mesh.tri = vg_alloc(m.n_tri, sizeof *m.tri);
  c->mesh.tri_patch = vg_alloc(m.n_tri, sizeof *m.tri_patch);
  if (!c->mesh.tri || !c->mesh.tri_patch)
    VG_TRY(vg_fail_memory(err, "the front of the layers"));
  VG_TRY(vg_mesh_inner_pairs(&m, first, other, err));
  c->mesh.n_tri = 0;
  for (uint32_t t = 0; t < m.n_tri; t++) {
    if (other[t] < t) continue;
    for (int k = 0; k < 3; k++)
      c->mesh.tri[c->mesh.n_tri][k] = first[m.tri[t][k]];
    c->mesh.tri_patch[c->mesh.n_tri] = m.tri_patch[t];
    c->of[c->mesh.n_tri++] = t;
  }
done:
  free(first);
  free(other);
  return st;
}

/* Marks the columns of faces that intersect or coincide. Any number of faces
 * may share an edge of an inner surface. Returns the number of defects. */
static size_t mark_crossing(const struct vg_front *front,
                            const struct closed *c,
                            const struct vg_surface_report *r, uint8_t *bad)
{
  static const enum vg_defect_kind kind[] = { VG_DEFECT_INTERSECTION,
                                              VG_DEFECT_DEGENERATE_TRIANGLE,
                                              VG_DEFECT_DUPLICATE_TRIANGLE,
                                              VG_DEFECT_NONMANIFOLD_EDGE,
                                              VG_DEFECT_SHARED_WALL };
  const size_t n_kind = c->of ? 3 : sizeof kind / sizeof *kind;
  size_t n = 0;
  uint32_t bits = 0;

  for (size_t i = 0; i < n_kind; i++) {
    n += r->count[kind[i]];
    bits |= 1u << kind[i];
  }
  for (size_t t = 0; n && t < c->mesh.n_tri; t++) {
    const uint32_t *v = front->face[c->of ? c->of[t] : t];

    for (int k = 0; k < 3 && r->face_kinds[t] & bits; k++) {
      const uint32_t i = vg_layer_column_of(front->id[v[k]]);

      if (i != VG_NO_INDEX) bad[i] = 1;
    }
  }
  return n;
}

/* Tests the final front: remeshed patches against tops. */
static vg_status try_front(struct vg_layer_work *w, struct vg_front *front,
                           uint8_t *bad, size_t round, size_t *n_bad,
                           struct vg_error *err)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct closed c;
  size_t n_cross;
  vg_status st;

  o.repair = 0; /* The arrays are borrowed. */
  o.threads = w->o->threads;
  *n_bad = 0;
  memset(bad, 0, w->c->n_column);
  VG_TRY(close_front(front, w->m, &c, err));
  VG_TRY(vg_surface_check(&c.mesh, &o, &r, err));
  n_cross = mark_crossing(front, &c, &r, bad);
  for (size_t i = 0; n_cross && i < w->c->n_column; i++) {
    if (!bad[i]) continue;
    vg_heights_lower(w, i, lowered(w, i, round), VG_CAUSE_COLLISION);
    ++*n_bad;
  }
  if (n_cross && !*n_bad)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "the surface intersects itself outside the layers; check it "
                 "with `vanguard check`");
done:
  closed_release(&c);
  vg_surface_report_release(&r);
  return st;
}

/* Columns on curved patches were bent onto them, so their cells are tested
 * again. */
static vg_status try_bent(struct vg_layer_work *w, uint8_t *bent,
                          uint8_t *turned, size_t *n_bad, struct vg_error *err)
{
  for (size_t i = 0; i < w->c->n_column; i++)
    bent[i] = w->c->column[i].bent != SIZE_MAX;
  return vg_cells_lower(w, bent, 0, turned, n_bad, err);
}

/* Straightens columns until the patches are remeshed again. */
static void unbend(struct vg_columns *c)
{
  for (size_t i = 0; c->n_path && i < c->n_column; i++)
    c->column[i].bent = SIZE_MAX;
  free(c->path);
  c->path = NULL;
  c->n_path = 0;
}

struct rounds {
  uint8_t *moved, *turned, *bad;
  /* Columns still to be tested: their cells, their tops, and their tops raised
   * by the margin. */
  uint8_t *cells, *tops, *near;
  size_t sound; /* Number of rounds in which all cells were valid. */
  int is_near;  /* Raised tops were tested before. */
};

static vg_status settle(struct vg_layer_work *w, struct rounds *q,
                        struct vg_error *err)
{
  vg_status st = vg_heights_settle(w, q->moved, err);

  for (size_t i = 0; st >= 0 && i < w->c->n_column; i++) {
    q->moved[i] |= q->turned[i];
    q->turned[i] = 0;
    q->cells[i] |= q->moved[i];
    q->tops[i] |= q->moved[i];
    q->near[i] |= q->moved[i];
  }
  return st;
}

/* The first test that fails lowers columns, and the next round starts with the
 * columns that moved. Heights never increase, so the loop ends. */
static vg_status one_round(struct vg_layer_work *w, struct rounds *q,
                           struct vg_front *front, struct vg_layer_report *r,
                           size_t *n_bad, struct vg_error *err)
{
  size_t round = q->sound;
  double t = vg_clock();
  int is_unsure = 0;
  vg_status st;

  VG_TRY(vg_cells_lower(w, r->n_round ? q->cells : NULL, r->n_round < TURNS_MAX,
                        q->turned, n_bad, err));
  memset(q->cells, 0, w->c->n_column);
  if (!*n_bad) {
    VG_TRY(try_tops(w, q->sound ? q->tops : NULL, NULL, q->bad, q->sound, n_bad,
                    err));
    memset(q->tops, 0, w->c->n_column);
    round = q->sound++;
  }
  if (!*n_bad) {
    VG_TRY(try_tops(w, q->is_near ? q->near : NULL, w->margin, q->bad, round,
                    n_bad, err));
    memset(q->near, 0, w->c->n_column);
    q->is_near = 1;
  }
  r->time_clear += vg_clock() - t;
  t = vg_clock();
  if (!*n_bad) VG_TRY(try_slides(w, front, round, n_bad, err));
  if (!*n_bad && w->c->n_path)
    VG_TRY(try_bent(w, q->bad, q->turned, n_bad, err));
  r->time_slide += vg_clock() - t;
  t = vg_clock();
  if (!*n_bad) try_sides(w, q->bad, round, n_bad, &is_unsure);
  if (!*n_bad && is_unsure)
    VG_TRY(try_front(w, front, q->bad, round, n_bad, err));
  r->time_clear += vg_clock() - t;
done:
  return st;
}

static vg_status until_clear(struct vg_layer_work *w, struct vg_front *front,
                             struct vg_layer_report *r, struct vg_error *err)
{
  size_t n = w->c->n_column, n_bad = 1;
  struct rounds q = { .moved = vg_calloc(n, 1),
                      .turned = vg_calloc(n, 1),
                      .bad = vg_calloc(n, 1),
                      .cells = vg_calloc(n, 1),
                      .tops = vg_calloc(n, 1),
                      .near = vg_calloc(n, 1) };

  double t;
  vg_status st = VG_OK;

  if (!q.moved || !q.turned || !q.cells || !q.tops || !q.near || !q.bad) {
    st = vg_fail_memory(err, "the layers");
    goto done;
  }
  for (r->n_round = 0; n_bad && r->n_round < ROUNDS_MAX; r->n_round++) {
    vg_tell(&w->o->progress, "layers", r->n_round, 0);
    VG_TRY(vg_stopped(&w->o->stop, err));
    w->last_resort = r->n_round >= LAST_RESORT;
    t = vg_clock();
    vg_front_release(front);
    unbend(w->c);
    VG_TRY(settle(w, &q, err));
    r->time_height += vg_clock() - t;
    VG_TRY(one_round(w, &q, front, r, &n_bad, err));
  }
  if (n_bad)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "the layers still collide after %d rounds; please report "
                 "this with the project files",
                 ROUNDS_MAX);
done:
  free(q.moved);
  free(q.turned);
  free(q.cells);
  free(q.tops);
  free(q.near);
  free(q.bad);
  return st;
}

/* Number of cells of a face by the lift rule. Cells at the wall in which
 * columns of one root are the same point are not counted, nor any cell if such
 * columns have no level. */
static size_t face_cells(const struct vg_columns *c, const uint32_t face[3])
{
  const struct vg_column *k[3];
  size_t n = 0;
  int up[3] = { 0, 0, 0 };

  for (int i = 0; i < 3; i++) n += (k[i] = &c->column[face[i]])->n;
  for (int i = 0; i < 3; i++)
    if (k[i]->root == k[(i + 1) % 3]->root && !k[i]->n && !k[(i + 1) % 3]->n)
      return 0;
  for (int step = 0; step < 3; step++) {
    int a = -1, q, r;

    for (int i = 0; i < 3; i++)
      if (!up[i] && (a < 0 || face[i] < face[a])) a = i;
    up[a] = 1;
    q = (a + 1) % 3, r = (a + 2) % 3;
    if (k[a]->n && ((k[q]->root == k[a]->root && !(up[q] && k[q]->n)) ||
                    (k[r]->root == k[a]->root && !(up[r] && k[r]->n)) ||
                    (k[q]->root == k[r]->root && !(up[q] && k[q]->n) &&
                     !(up[r] && k[r]->n))))
      n--;
  }
  return n;
}

static void count(const struct vg_layer_work *w, const struct vg_front *front,
                  struct vg_layer_report *r)
{
  const struct vg_columns *c = w->c;

  r->n_column = c->n_column;
  for (size_t i = 0; i < c->n_column; i++)
    r->n_many_faces += w->t.first[i + 1] - w->t.first[i] > VG_AHEAD_FACES;
  for (size_t i = 0; i < c->n_column; i++) {
    r->n_wall_point += i == 0 || c->column[i].root != c->column[i - 1].root;
    r->n_layer_point += c->column[i].n;
    r->cause[c->column[i].cause]++;
    r->compressed[c->column[i].compressed]++;
  }
  for (size_t f = 0; f < c->n_face; f++) {
    if (c->face_tri[f] == VG_NO_INDEX) r->n_virtual_face++;
    else r->n_wall_tri++;
    r->n_cell += face_cells(c, c->face[f]);
  }
  r->n_slide_patch = w->n_slide;
  for (size_t t = 0; t < front->n_face; t++)
    r->n_slide_tri += front->face_id[t] == VG_NO_INDEX &&
                      w->is_slide[front->patch[t]];
}

/* Columns, of which those without twins in periodic patches have no levels. The
 * columns of a fan are in the order of their twins. */
static vg_status topology(struct vg_layer_work *w, struct vg_error *err)
{
  uint8_t *is_image = NULL, *alone = NULL;
  struct vg_columns *c = w->c;
  vg_status st = VG_OK;

  if (w->twins.n) {
    is_image = vg_calloc(w->m->n_point, 1);
    if (!is_image) return vg_fail_memory(err, "the layers");
    vg_twins_mark_images(&w->twins, w->m->n_point, is_image);
  }
  VG_TRY(vg_topology_build(w->m, w->is_wall, w->n_slide, w->slide,
                           w->o->fan_angle, is_image, c, &w->t, err));
  if (!w->twins.n) return VG_OK;
  c->is_twin = vg_calloc(c->n_column, 1);
  alone = vg_calloc(c->n_column, 1);
  if (!c->is_twin || !alone) VG_TRY(vg_fail_memory(err, "the layers"));
  c->n_twin = c->n_column;
  VG_TRY(vg_twins_find(&w->twins, w->m, c, alone, err));
  for (size_t i = 0; i < c->n_column; i++)
    if (alone[i] && !c->column[i].cause) c->column[i].cause = VG_CAUSE_SLIDE;
done:
  free(is_image);
  free(alone);
  return st;
}

static vg_status columns(struct vg_layer_work *w, struct vg_layer_report *r,
                         struct vg_error *err)
{
  double t = vg_clock();
  vg_status st;

  VG_TRY(walls(w, err));
  VG_TRY(topology(w, err));
  VG_TRY(arrays(w, err));
  r->time_topology = vg_clock() - t;
  t = vg_clock();
  VG_TRY(vg_directions_first(w, err));
  r->time_direction = vg_clock() - t;
  t = vg_clock();
  VG_TRY(vg_heights_wanted(w, err));
  VG_TRY(margins(w, err));
  r->time_height = vg_clock() - t;
  t = vg_clock();
  VG_TRY(vg_directions_smooth(w, err));
  VG_TRY(vg_directions_scale(w, err));
  vg_directions_shift(w, NULL);
  r->time_direction += vg_clock() - t;
done:
  return st;
}

/* The front of a closed surface must be closed. */
static void check_layers(const struct vg_mesh *surface,
                         const struct vg_layers *l)
{
  const struct vg_mesh front = vg_front_mesh(&l->front, surface);

  VG_CHECK("the layers", vg_columns_defects(&l->columns, surface));
  VG_CHECK("the layers", vg_mesh_bad_faces(&front));
  if (VG_CHECKS_ON && !vg_mesh_open_edges(surface))
    VG_CHECK("the layers", vg_mesh_open_edges(&front));
}

vg_status vg_layers_grow(const struct vg_mesh *surface,
                         const struct vg_sizing *sizing,
                         const struct vg_layer_options *options,
                         struct vg_layers *out, struct vg_layer_report *report,
                         struct vg_error *err)
{
  assert(sizing && options && out && report);

  struct vg_layers l = VG_LAYERS_INIT;
  struct vg_layer_work w = { .m = surface,
                             .sizing = sizing,
                             .o = options,
                             .c = &l.columns,
                             .t = VG_TOPOLOGY_INIT };
  struct vg_layer_report r = { 0 };
  double start = vg_clock();
  vg_status st;

  VG_TRY(columns(&w, &r, err));
  VG_TRY(first_allowed(&w, &r, err));
  VG_TRY(until_clear(&w, &l.front, &r, err));
  count(&w, &l.front, &r);
  VG_TRY(vg_layers_order(surface, &l, err));
  check_layers(surface, &l);
  r.time_total = vg_clock() - start;
  *report = r;
  vg_layers_release(out);
  *out = l;
  l = (struct vg_layers)VG_LAYERS_INIT;
done:
  work_release(&w);
  vg_layers_release(&l);
  return st;
}
