/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The surface check: repairs a copy of the surface where the repair is
 * unambiguous, then searches for the remaining defects, kind by kind. The steps
 * are in surface_parts.h. */
#include "core/surface/surface_check.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/surface/surface_parts.h"

struct check {
  struct vg_mesh *m;
  const struct vg_surface_check_options *o;
  struct vg_surface_report *r;
  struct vg_error *err;
  uint32_t *same;  /* [n_point] Lowest point with the same coordinates. */
  uint32_t *owner; /* [n_point] Lowest face that uses the point; UINT32_MAX:
                      none. */
  struct vg_faces s;
  struct vg_edges e;
  struct vg_box_tree tree;
  struct vg_crossing cross;
  uint32_t *first;    /* [s.n] Lowest face with the same nodes. */
  uint8_t *copy;      /* [s.n] enum vg_copy; NULL: no face is a copy. */
  uint32_t (*fan)[3]; /* [s.n] Umbrella of each corner. */
  uint8_t *flip;      /* [s.n] Faces to turn. */
  uint32_t *shell;    /* [s.n] Shell of each face. */
  uint8_t *shell_state, *shell_turn;
};

static void release(struct check *c)
{
  free(c->same);
  free(c->owner);
  free(c->first);
  free(c->copy);
  free(c->fan);
  free(c->flip);
  free(c->shell);
  free(c->shell_state);
  free(c->shell_turn);
  vg_faces_release(&c->s);
  vg_edges_release(&c->e);
  vg_box_tree_release(&c->tree);
  vg_crossing_release(&c->cross);
}

void vg_surface_report_release(struct vg_surface_report *r)
{
  assert(r);
  free(r->defect);
  free(r->face_kinds);
  free(r->shell);
  free(r->tri_shell);
  memset(r, 0, sizeof *r);
}

/* --- repair of points and triangles -------------------------------------- */

static void mark(uint8_t *used, const uint32_t *node, size_t n)
{
  for (size_t i = 0; i < n; i++) used[node[i]] = 1;
}

static void mark_cells(uint8_t *used, const struct vg_mesh *m)
{
  mark(used, (uint32_t *)m->tet, 4 * m->n_tet);
  mark(used, (uint32_t *)m->pyr, 5 * m->n_pyr);
  mark(used, (uint32_t *)m->pri, 6 * m->n_pri);
  mark(used, (uint32_t *)m->hex, 8 * m->n_hex);
}

static int has_cells(const struct vg_mesh *m)
{
  return vg_mesh_n_cell(m) > 0;
}

static int has_copies(const struct vg_faces *s, const uint32_t *first)
{
  for (size_t f = 0; f < s->n; f++)
    if (first[f] != f && !(s->state[f] & VG_FACE_COLLAPSED)) return 1;
  return 0;
}

/* Mark collapsed triangles, copies, and both sides of walls shared by bodies.
 * In a mesh with cells a two-sided face bounds cells on both sides and
 * stays. */
static void list_superfluous(const struct vg_mesh *m, const struct vg_faces *s,
                             const uint32_t *first, const uint8_t *copy,
                             int keeps_walls, uint8_t *drop,
                             struct vg_surface_report *r)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t f = first[t];
    int is_wall = !keeps_walls && copy && copy[t] == VG_COPY_WALL &&
                  f < m->n_tri && !has_cells(m);
    int is_copy = copy && f != t &&
                  (copy[t] == VG_COPY_SKIN ||
                   vg_faces_same_side(s->node[f], s->node[t]));

    drop[t] = s->state[t] & VG_FACE_COLLAPSED || is_wall || is_copy;
    r->n_removed_wall += is_wall;
    r->n_removed_tri += drop[t] && !is_wall;
  }
}

static vg_status tidy_triangles(struct vg_mesh *m, const uint32_t *same,
                                int keeps_walls, struct vg_surface_report *r,
                                struct vg_error *err)
{
  struct vg_faces s = VG_FACES_INIT;
  uint32_t *first = NULL;
  uint8_t *drop = vg_alloc(m->n_tri, 1), *copy = NULL;
  vg_status st = VG_OK;

  if (!drop) return vg_fail_memory(err, "a list of triangles");
  VG_TRY(vg_faces_build(&s, m, same, err));
  VG_TRY(vg_faces_duplicate(&s, &first, err));
  if (has_copies(&s, first)) VG_TRY(vg_faces_copies(&s, first, &copy, err));
  list_superfluous(m, &s, first, copy, keeps_walls, drop, r);
  vg_mesh_drop_tri(m, drop);
done:
  vg_faces_release(&s);
  free(first);
  free(copy);
  free(drop);
  return st;
}

/* Merge points, drop superfluous triangles, then drop unused points. */
static vg_status tidy(struct vg_mesh *m, int keeps_walls,
                      struct vg_surface_report *r, struct vg_error *err)
{
  size_t n_point = m->n_point;
  uint32_t *map = NULL;
  uint8_t *used;
  vg_status st = VG_OK;

  VG_TRY(vg_points_same(m, &map, err));
  VG_TRY(tidy_triangles(m, map, keeps_walls, r, err));
  used = vg_calloc(m->n_point, 1);
  if (!used) VG_TRY(vg_fail_memory(err, "a list of points"));
  mark(used, (uint32_t *)m->tri, 3 * m->n_tri);
  mark(used, (uint32_t *)m->quad, 4 * m->n_quad);
  mark_cells(used, m);
  for (size_t i = n_point; i--;)
    if (used[i]) used[map[i]] = 1;
  vg_mesh_renumber(m, map, used);
  r->n_removed_point = n_point - m->n_point;
  free(used);
done:
  free(map);
  return st;
}

/* --- findings ------------------------------------------------------------ */

static vg_status add(struct check *c, enum vg_defect_kind kind, size_t f,
                     size_t g, size_t p, size_t q, const double at[3])
{
  struct vg_surface_report *r = c->r;
  struct vg_defect *d;

  if (vg_reserve(&r->defect, &r->cap_defect, r->n_defect + 1, sizeof *d))
    return vg_fail_memory(c->err, "the list of findings");
  d = &r->defect[r->n_defect++];
  memset(d, 0, sizeof *d);
  d->kind = kind;
  d->face[0] = f;
  d->face[1] = g;
  d->point[0] = p;
  d->point[1] = q;
  memcpy(d->at, at, sizeof d->at);
  r->count[kind]++;
  if (f != SIZE_MAX) r->face_kinds[f] |= 1u << kind;
  if (g != SIZE_MAX) r->face_kinds[g] |= 1u << kind;
  return VG_OK;
}

static size_t source(const struct check *c, uint32_t f)
{
  return vg_faces_source(&c->s, f);
}

static void centre(const struct check *c, size_t f, double at[3])
{
  for (int k = 0; k < 3; k++) {
    at[k] = 0;
    for (int i = 0; i < 3; i++) at[k] += c->s.point[c->s.node[f][i]][k] / 3;
  }
}

static vg_status check_points(struct check *c)
{
  const struct vg_mesh *m = c->m;
  uint8_t *in_cell = vg_calloc(m->n_point, 1);
  vg_status st = VG_OK;

  if (!in_cell) return vg_fail_memory(c->err, "a list of points");
  mark_cells(in_cell, m);
  for (size_t i = 0; i < m->n_point; i++) {
    const double *p = m->point[i];
    size_t f = c->owner[i] == UINT32_MAX ? SIZE_MAX : c->owner[i];

    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
      VG_TRY(add(c, VG_DEFECT_NOT_FINITE, f, SIZE_MAX, i, SIZE_MAX, p));
    if (c->same[i] != i)
      VG_TRY(add(c, VG_DEFECT_DUPLICATE_POINT, f, SIZE_MAX, c->same[i], i, p));
    if (f == SIZE_MAX && !in_cell[i])
      VG_TRY(add(c, VG_DEFECT_UNUSED_POINT, f, SIZE_MAX, i, SIZE_MAX, p));
  }
done:
  free(in_cell);
  return st;
}

static vg_status check_faces(struct check *c)
{
  const uint32_t *first = c->first;
  double at[3];
  vg_status st = VG_OK;

  for (size_t f = 0; f < c->s.n; f++) {
    size_t g = source(c, (uint32_t)f);

    centre(c, f, at);
    if (f >= c->s.n_tri && (f - c->s.n_tri) % 2 == 0)
      VG_TRY(add(c, VG_DEFECT_QUAD, g, SIZE_MAX, SIZE_MAX, SIZE_MAX, at));
    if (c->s.state[f] & (VG_FACE_COLLAPSED | VG_FACE_FLAT))
      VG_TRY(add(c, VG_DEFECT_DEGENERATE_TRIANGLE, g, SIZE_MAX, SIZE_MAX,
                 SIZE_MAX, at));
    if (first[f] != f && !(c->s.state[f] & VG_FACE_COLLAPSED))
      VG_TRY(add(c,
                 c->copy[f] == VG_COPY_WALL || c->copy[f] == VG_COPY_PART
                   ? VG_DEFECT_SHARED_WALL
                   : VG_DEFECT_DUPLICATE_TRIANGLE,
                 source(c, first[f]), g, SIZE_MAX, SIZE_MAX, at));
  }
done:
  return st;
}

static vg_status add_edge(struct check *c, enum vg_defect_kind kind,
                          size_t edge)
{
  uint32_t from = c->e.start[edge], to = c->e.start[edge + 1];
  uint32_t g = c->e.half[from];
  uint32_t a = c->s.node[g / 3][g % 3], b = c->s.node[g / 3][(g + 1) % 3];
  double at[3];

  if (g % 3 == 2) b = c->s.node[g / 3][0];
  for (int k = 0; k < 3; k++)
    at[k] = .5 * c->s.point[a][k] + .5 * c->s.point[b][k];
  for (uint32_t i = from; i < to; i++)
    c->r->face_kinds[source(c, c->e.half[i] / 3)] |= 1u << kind;
  return add(c, kind, source(c, g / 3),
             to - from > 1 ? source(c, c->e.half[from + 1] / 3) : SIZE_MAX, a,
             b, at);
}

static vg_status check_edges(struct check *c)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->e.n; i++) {
    uint32_t at = c->e.start[i], n = c->e.start[i + 1] - at;

    if (n == 1) {
      VG_TRY(add_edge(c, VG_DEFECT_OPEN_EDGE, i));
    } else if (n > 2) {
      VG_TRY(add_edge(c, VG_DEFECT_NONMANIFOLD_EDGE, i));
    } else if (vg_faces_disagree(&c->s, &c->e, i) ^ c->flip[c->e.half[at] / 3] ^
               c->flip[c->e.half[at + 1] / 3]) {
      VG_TRY(add_edge(c, VG_DEFECT_ORIENTATION, i));
    }
  }
done:
  return st;
}

/* Centre of the overlap of the boxes of two faces. */
static void meeting_place(const struct check *c, uint32_t f, uint32_t g,
                          double at[3])
{
  for (int k = 0; k < 3; k++) {
    double lo = -INFINITY, hi = INFINITY;

    for (int side = 0; side < 2; side++) {
      const uint32_t *n = c->s.node[side ? g : f];
      double a = c->s.point[n[0]][k], b = c->s.point[n[1]][k];
      double d = c->s.point[n[2]][k];

      lo = fmax(lo, fmin(a, fmin(b, d)));
      hi = fmin(hi, fmax(a, fmax(b, d)));
    }
    at[k] = .5 * lo + .5 * hi;
  }
}

static vg_status add_meeting(struct check *c, uint32_t f, uint32_t g)
{
  double at[3];

  meeting_place(c, f, g, at);
  return add(c, VG_DEFECT_INTERSECTION, source(c, f), source(c, g), SIZE_MAX,
             SIZE_MAX, at);
}

static vg_status check_crossings(struct check *c)
{
  const struct vg_crossing *x = &c->cross;
  vg_status st = VG_OK;

  for (size_t i = 0; i < x->n_listed; i++)
    VG_TRY(add_meeting(c, x->pair[i][0], x->pair[i][1]));
  if (x->n_listed < x->n_pair)
    for (uint32_t f = 0; f < c->s.n; f++)
      if (x->partner[f] != UINT32_MAX) VG_TRY(add_meeting(c, f, x->partner[f]));
  c->r->count[VG_DEFECT_INTERSECTION] = x->n_pair;
done:
  return st;
}

static vg_status check_shells(struct check *c)
{
  const struct vg_surface_report *r = c->r;
  vg_status st = VG_OK;

  for (size_t i = 0; i < r->n_shell; i++) {
    const struct vg_shell *x = &r->shell[i];
    uint8_t state = c->shell_state[i];
    size_t around = SIZE_MAX;
    double at[3];

    if (!x->is_closed || state & VG_SHELL_MIXED || !isfinite(x->volume) ||
        !(state & (VG_SHELL_FLAT | VG_SHELL_REVERSED | VG_SHELL_STRAY)))
      continue;
    if (state & VG_SHELL_STRAY && x->parent != SIZE_MAX)
      around = r->shell[x->parent].face;
    for (int k = 0; k < 3; k++) at[k] = .5 * x->lo[k] + .5 * x->hi[k];
    VG_TRY(add(c, VG_DEFECT_SHELL, x->face, around, SIZE_MAX, SIZE_MAX, at));
  }
done:
  return st;
}

static vg_status check_conditions(struct check *c)
{
  const struct vg_mesh *m = c->m;
  uint8_t *seen = vg_calloc(m->n_patch, 1);
  vg_status st = VG_OK;

  if (!seen) return vg_fail_memory(c->err, "a list of patches");
  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    uint32_t p = f < m->n_tri ? m->tri_patch[f] : m->quad_patch[f - m->n_tri];
    double at[3];

    if (seen[p]) continue;
    seen[p] = 1;
    if (m->patch[p].bc != VG_BC_NONE || m->patch[p].bc_fun3d != VG_BC_NONE)
      continue;
    centre(c, f < m->n_tri ? f : m->n_tri + 2 * (f - m->n_tri), at);
    VG_TRY(add(c, VG_DEFECT_NO_BC, f, SIZE_MAX, SIZE_MAX, SIZE_MAX, at));
  }
done:
  free(seen);
  return st;
}

static int compare_size(size_t a, size_t b)
{
  return (a > b) - (a < b);
}

static int compare_defect(const void *a, const void *b)
{
  const struct vg_defect *p = a, *q = b;
  int order = (p->kind > q->kind) - (p->kind < q->kind);

  for (int k = 0; k < 2 && !order; k++)
    order = compare_size(p->face[k], q->face[k]);
  for (int k = 0; k < 2 && !order; k++)
    order = compare_size(p->point[k], q->point[k]);
  return order;
}

/* --- whole check ---------------------------------------------------------- */

static vg_status list_owners(struct check *c)
{
  const struct vg_mesh *m = c->m;

  c->owner = vg_alloc(m->n_point, sizeof *c->owner);
  if (!c->owner) return vg_fail_memory(c->err, "the faces of the points");
  memset(c->owner, 0xff, m->n_point * sizeof *c->owner);
  for (size_t q = m->n_quad; q--;)
    for (int k = 0; k < 4; k++)
      c->owner[m->quad[q][k]] = (uint32_t)(m->n_tri + q);
  for (size_t t = m->n_tri; t--;)
    for (int k = 0; k < 3; k++) c->owner[m->tri[t][k]] = (uint32_t)t;
  return VG_OK;
}

/* Build everything that depends on the nodes of the faces only. */
static vg_status build_topology(struct check *c, struct vg_error *err)
{
  struct vg_surface_report *r = c->r;
  vg_status st;

  VG_TRY(vg_faces_edges(&c->s, &c->e, err));
  VG_TRY(vg_orient_faces(&c->s, &c->e, c->flip, err));
  VG_TRY(vg_label_fans(&c->s, &c->e, &c->fan, err));
  if (!c->o->repair) memset(c->flip, 0, c->s.n);
  VG_TRY(vg_count_components(&c->s, &r->n_piece, err));
  VG_TRY(vg_label_shells(&c->s, &c->e, c->shell, &r->n_shell, err));
  for (size_t t = 0; t < c->m->n_tri; t++) r->tri_shell[t] = c->shell[t];
done:
  return st;
}

/* The tree depends on coordinates, all else on nodes: a thread builds each of
 * the two. */
struct halves {
  struct check *c;
  vg_status st[2];
  struct vg_error err[2];
};

static void build_half(void *context, size_t first, size_t end, int worker)
{
  struct halves *h = context;
  struct check *c = h->c;

  (void)worker;
  for (size_t i = first; i < end; i++)
    h->st[i] = i ? vg_faces_tree(&c->tree, &c->s, &h->err[i])
                 : build_topology(c, &h->err[i]);
}

static vg_status build_halves(struct check *c)
{
  struct halves h = { .c = c };

  vg_parallel_for(c->o->threads, 2, 1, build_half, &h);
  for (int i = 0; i < 2; i++)
    if (h.st[i] < 0) {
      if (c->err) *c->err = h.err[i];
      return h.st[i];
    }
  return VG_OK;
}

/* Copies that are reported are excluded from the following tests, so that they
 * are not also reported as edges and intersections: all but the first face of a
 * skin, and both faces of a wall that bodies share. */
static vg_status find_copies(struct check *c)
{
  struct vg_faces *s = &c->s;
  vg_status st;

  VG_TRY(vg_faces_duplicate(s, &c->first, c->err));
  if (!has_copies(s, c->first)) goto done;
  VG_TRY(vg_faces_copies(s, c->first, &c->copy, c->err));
  for (size_t f = 0; f < s->n; f++)
    if (c->copy[f] == VG_COPY_WALL ||
        (c->copy[f] == VG_COPY_SKIN && c->first[f] != f))
      s->state[f] |= VG_FACE_COPY;
done:
  return st;
}

static vg_status build(struct check *c)
{
  struct vg_surface_report *r = c->r;
  vg_status st;

  VG_TRY(vg_points_same(c->m, &c->same, c->err));
  VG_TRY(vg_stopped(&c->o->stop, c->err));
  VG_TRY(list_owners(c));
  VG_TRY(vg_faces_build(&c->s, c->m, c->same, c->err));
  VG_TRY(find_copies(c));
  c->flip = vg_calloc(c->s.n, 1);
  c->shell = vg_alloc(c->s.n, sizeof *c->shell);
  r->face_kinds = vg_calloc(c->m->n_tri + c->m->n_quad, sizeof *r->face_kinds);
  r->tri_shell = vg_alloc(c->m->n_tri, sizeof *r->tri_shell);
  if (!c->flip || !c->shell || !r->face_kinds || !r->tri_shell)
    VG_TRY(vg_fail_memory(c->err, "the surface check"));
  VG_TRY(vg_stopped(&c->o->stop, c->err));
  st = build_halves(c);
done:
  return st;
}

static vg_status build_shells(struct check *c)
{
  struct vg_surface_report *r = c->r;
  size_t n_closed = 0, n_turned = 0;
  vg_status st;

  r->shell = vg_alloc(r->n_shell, sizeof *r->shell);
  c->shell_state = vg_alloc(r->n_shell, 1);
  c->shell_turn = vg_alloc(r->n_shell, 1);
  if (!r->shell || !c->shell_state || !c->shell_turn)
    VG_TRY(vg_fail_memory(c->err, "the shells of the surface"));
  VG_TRY(vg_measure_shells(r->shell, c->shell_state, r->n_shell, &c->s, &c->e,
                           c->shell, c->flip, c->err));
  VG_TRY(vg_find_crossings(&c->cross, &c->s, c->first,
                           (const uint32_t(*)[3])c->fan, &c->tree, c->shell,
                           r->n_shell, c->o->threads, &c->o->stop, c->err));
  VG_TRY(
    vg_nest_shells(r->shell, r->n_shell, &c->s, &c->tree, c->shell, c->err));
  VG_TRY(vg_orient_shells(r->shell, c->shell_state, r->n_shell, c->o->external,
                          c->o->repair, c->cross.other_shell, c->shell_turn,
                          c->err));
  for (size_t f = 0; f < c->s.n; f++)
    if (c->shell[f] != UINT32_MAX) c->flip[f] ^= c->shell_turn[c->shell[f]];
  for (size_t i = 0; i < r->n_shell; i++) {
    n_closed += r->shell[i].is_closed != 0;
    n_turned += c->shell_turn[i];
  }
  r->shells_reoriented = n_closed && n_turned == n_closed;
done:
  return st;
}

static void turn_tri(uint32_t node[3])
{
  uint32_t n = node[1];

  node[1] = node[2];
  node[2] = n;
}

static void turn_quad(uint32_t node[4])
{
  uint32_t n = node[1];

  node[1] = node[3];
  node[3] = n;
}

static void count_flip(struct check *c, size_t face)
{
  c->r->n_flipped++;
  if (c->shell[face] != UINT32_MAX) c->r->shell[c->shell[face]].n_flipped++;
}

/* A quadrilateral is turned only if both its halves are. */
static void apply_flips(struct check *c)
{
  struct vg_mesh *m = c->m;

  for (size_t i = 0; i < c->r->n_shell; i++) c->r->shell[i].n_flipped = 0;
  for (size_t t = 0; t < m->n_tri; t++)
    if (c->flip[t]) {
      turn_tri(m->tri[t]);
      count_flip(c, t);
    }
  for (size_t q = 0; q < m->n_quad; q++)
    if (c->flip[m->n_tri + 2 * q] && c->flip[m->n_tri + 2 * q + 1]) {
      turn_quad(m->quad[q]);
      count_flip(c, m->n_tri + 2 * q);
    }
}

static vg_status run(struct check *c)
{
  struct vg_surface_report *r = c->r;
  vg_status st;

  if (c->o->repair) VG_TRY(tidy(c->m, c->o->keeps_walls, r, c->err));
  VG_TRY(vg_stopped(&c->o->stop, c->err));
  VG_TRY(build(c));
  VG_TRY(vg_stopped(&c->o->stop, c->err));
  VG_TRY(build_shells(c));
  VG_TRY(vg_stopped(&c->o->stop, c->err));
  VG_TRY(check_edges(c));
  VG_TRY(check_points(c));
  VG_TRY(check_faces(c));
  VG_TRY(check_crossings(c));
  VG_TRY(check_shells(c));
  if (c->o->require_bc) VG_TRY(check_conditions(c));
  r->is_closed = c->s.n && !r->count[VG_DEFECT_OPEN_EDGE] &&
                 !r->count[VG_DEFECT_NONMANIFOLD_EDGE];
  if (r->n_defect)
    qsort(r->defect, r->n_defect, sizeof *r->defect, compare_defect);
  apply_flips(c);
done:
  return st;
}

vg_status vg_surface_check(struct vg_mesh *m,
                           const struct vg_surface_check_options *options,
                           struct vg_surface_report *report,
                           struct vg_error *err)
{
  struct vg_mesh work = VG_MESH_INIT;
  struct check c;
  vg_status st = VG_OK;

  assert(options && report && options->threads >= 0);
  memset(&c, 0, sizeof c);
  c.m = m;
  c.o = options;
  c.r = report;
  c.err = err;
  vg_surface_report_release(report);
  VG_TRY(vg_mesh_check_index(m, err));
  if (options->repair) { /* A failure must not leave a partial repair. */
    VG_TRY(vg_mesh_copy(&work, m, err));
    c.m = &work;
  }
  VG_TRY(run(&c));
  if (options->repair) vg_mesh_move(m, &work);
done:
  if (st < 0) vg_surface_report_release(report);
  release(&c);
  vg_mesh_release(&work);
  return st;
}
