/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: shells are connected by edges; where more than two triangles meet,
 * the two sides of a shared wall belong to different shells. Findings of the
 * check tell which of them meet; these form sets. The helper unites the shells
 * of one set after the other, and its result replaces them. */
#include "core/wrap/unite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "core/wrap/wrap_parts.h"

#define INSIDE 0.5 /* S83: a shell keeps less of its area: it is inside */
#define CROWD 64   /* triangles at an edge: more are not examined */
#define FULL 0.75  /* S83: of its bounding box: a tunnel or a room */

struct shell {
  size_t n_tri, first;         /* Number of its triangles, and the first. */
  double volume, lo[3], hi[3]; /* Signed volume; bounding box. */
  double area, left;           /* Area before, and in the result. */
  int is_faulty;               /* Open, not manifold, or intersects itself. */
};

struct work {
  const struct vg_mesh *m;
  const struct vg_unite_options *o;
  uint32_t *up;      /* [n_tri] union-find over edges. */
  uint32_t *of;      /* [n_tri] Shell. */
  uint32_t *set;     /* [n_shell] union-find over shells that meet. */
  uint32_t *members; /* [n_shell] Number of shells of the set of each root. */
  size_t n_shell;
  struct shell *shell;
};

static void release(struct work *w)
{
  free(w->up);
  free(w->of);
  free(w->set);
  free(w->members);
  free(w->shell);
}

/* --- shells and sets ------------------------------------------------------ */

static void measure(struct work *w)
{
  const struct vg_mesh *m = w->m;

  for (size_t t = 0; t < m->n_tri; t++) {
    struct shell *s = &w->shell[w->of[t]];
    const double *p[3];
    double n[3];

    for (int k = 0; k < 3; k++) p[k] = m->point[m->tri[t][k]];
    if (!s->n_tri++) {
      s->first = t;
      for (int d = 0; d < 3; d++) s->lo[d] = INFINITY, s->hi[d] = -INFINITY;
    }
    for (int k = 0; k < 3; k++)
      for (int d = 0; d < 3; d++) {
        s->lo[d] = fmin(s->lo[d], p[k][d]);
        s->hi[d] = fmax(s->hi[d], p[k][d]);
      }
    vg_cross(p[1], p[2], n);
    s->volume += vg_dot(p[0], n) / 6;
    s->area += vg_triangle_area(p[0], p[1], p[2]);
  }
}

static int are_copies(const uint32_t a[3], const uint32_t b[3])
{
  for (int i = 0; i < 3; i++)
    if (a[i] != b[0] && a[i] != b[1] && a[i] != b[2]) return 0;
  return 1;
}

/* The next triangle of the shell across an edge: the only one in the opposite
 * direction that is not a copy. Copies are the two sides of a wall that bodies
 * share. UINT32_MAX: no such triangle, or more than one. */
static uint32_t across(const struct vg_mesh *m, const uint32_t *half,
                       uint32_t n, uint32_t h)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])m->tri;
  uint32_t found = UINT32_MAX;

  for (uint32_t i = 0; i < n; i++) {
    if (vg_half_from(tri, half[i]) == vg_half_from(tri, h) ||
        (n > 2 && are_copies(tri[half[i] / 3], tri[h / 3])))
      continue;
    if (found != UINT32_MAX) return UINT32_MAX;
    found = half[i];
  }
  return found;
}

static void join(struct work *w, const struct vg_edges *e, size_t i)
{
  const uint32_t *half = e->half + e->start[i];
  const uint32_t n = vg_edges_count(e, i);

  for (uint32_t k = 0; k < n && n <= CROWD; k++) {
    const uint32_t g = across(w->m, half, n, half[k]);

    if (g != UINT32_MAX) vg_union(w->up, half[k] / 3, g / 3);
  }
}

static vg_status find_shells(struct work *w, const struct vg_edges *e,
                             struct vg_error *err)
{
  const size_t n = w->m->n_tri;

  w->up = vg_alloc(n, sizeof *w->up);
  w->of = vg_alloc(n, sizeof *w->of);
  if (!w->up || !w->of) return vg_fail_memory(err, "the shells");
  for (size_t t = 0; t < n; t++) w->up[t] = (uint32_t)t;
  for (size_t i = 0; i < e->n; i++) join(w, e, i);
  for (size_t t = 0; t < n; t++) {
    const uint32_t root = vg_root_of(w->up, (uint32_t)t);

    w->of[t] = root == t ? (uint32_t)w->n_shell++ : w->of[root];
  }
  w->shell = vg_calloc(w->n_shell, sizeof *w->shell);
  w->set = vg_alloc(w->n_shell, sizeof *w->set);
  w->members = vg_calloc(w->n_shell, sizeof *w->members);
  if (!w->shell || !w->set || !w->members)
    return vg_fail_memory(err, "the shells");
  for (size_t i = 0; i < w->n_shell; i++) w->set[i] = (uint32_t)i;
  measure(w);
  return VG_OK;
}

/* The shells around an edge meet. Each must have two triangles there, one in
 * each direction. */
static void examine_edge(struct work *w, const struct vg_edges *e, size_t i)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])w->m->tri;
  const uint32_t *half = e->half + e->start[i];
  const uint32_t n = vg_edges_count(e, i);

  for (uint32_t a = 0; a < n; a++) {
    const uint32_t own = w->of[half[a] / 3];
    int along = 0, against = 0;

    for (uint32_t b = 0; b < n && n <= CROWD; b++) {
      const uint32_t other = w->of[half[b] / 3];

      if (other != own) vg_union(w->set, own, other);
      else if (vg_half_from(tri, half[b]) == vg_half_from(tri, half[a]))
        along++;
      else against++;
    }
    if (along != 1 || against != 1) w->shell[own].is_faulty = 1;
  }
}

static void find_sets(struct work *w, const struct vg_edges *e,
                      const struct vg_surface_report *check)
{
  for (size_t i = 0; i < e->n; i++) examine_edge(w, e, i);
  for (size_t i = 0; i < check->n_defect; i++) {
    const struct vg_defect *d = &check->defect[i];
    const size_t a = d->face[0], b = d->face[1];

    if (a >= w->m->n_tri || b >= w->m->n_tri) continue;
    if (w->of[a] != w->of[b]) vg_union(w->set, w->of[a], w->of[b]);
    else if (d->kind == VG_DEFECT_INTERSECTION)
      w->shell[w->of[a]].is_faulty = 1;
  }
  for (size_t i = 0; i < w->n_shell; i++)
    w->members[vg_root_of(w->set, (uint32_t)i)]++;
}

static size_t members_of(const struct work *w, size_t shell)
{
  return w->members[vg_root_of(w->set, (uint32_t)shell)];
}

/* Whether some shells meet and all of them can be united. */
static int is_possible(const struct work *w)
{
  int any = 0;

  for (size_t i = 0; i < w->n_shell; i++) {
    if (members_of(w, i) < 2) continue;
    if (w->shell[i].is_faulty || !(fabs(w->shell[i].volume) > 0)) return 0;
    any = 1;
  }
  return any;
}

/* --- one set -------------------------------------------------------------- */

/* The surface sent to the helper, and the triangles of w->m it is made of. */
struct request {
  struct vg_mesh mesh;
  uint32_t *from; /* [mesh.n_tri] */
};

static void request_release(struct request *q)
{
  vg_mesh_release(&q->mesh);
  free(q->from);
}

/* Append a shell, pointing outwards, with points of its own. number: [n_point]
 * of w->m, UINT32_MAX on entry and on return. */
static void add_shell(const struct work *w, uint32_t shell, uint32_t *number,
                      struct request *q)
{
  const struct vg_mesh *m = w->m;
  const struct shell *own = &w->shell[shell];
  const size_t begin = q->mesh.n_tri, end = begin + own->n_tri;

  for (size_t t = own->first; q->mesh.n_tri < end; t++) {
    uint32_t *v = q->mesh.tri[q->mesh.n_tri];

    if (w->of[t] != shell) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t p = m->tri[t][own->volume < 0 ? 2 - k : k];

      if (number[p] == UINT32_MAX) {
        number[p] = (uint32_t)q->mesh.n_point;
        memcpy(q->mesh.point[q->mesh.n_point++], m->point[p], sizeof *m->point);
      }
      v[k] = number[p];
    }
    q->from[q->mesh.n_tri++] = (uint32_t)t;
  }
  for (size_t i = begin; i < end; i++)
    for (int k = 0; k < 3; k++) number[m->tri[q->from[i]][k]] = UINT32_MAX;
}

static vg_status make_request(const struct work *w, uint32_t root,
                              struct request *q, struct vg_error *err)
{
  uint32_t *number = vg_alloc(w->m->n_point, sizeof *number);
  size_t n = 0, largest = root;

  for (size_t i = 0; i < w->n_shell; i++) {
    if (vg_root_of(w->set, (uint32_t)i) != root) continue;
    n += w->shell[i].n_tri;
    if (fabs(w->shell[i].volume) > fabs(w->shell[largest].volume)) largest = i;
  }
  q->mesh.point = vg_alloc(3 * n, sizeof *q->mesh.point);
  q->mesh.tri = vg_alloc(n, sizeof *q->mesh.tri);
  q->from = vg_alloc(n, sizeof *q->from);
  if (!number || !q->mesh.point || !q->mesh.tri || !q->from) {
    free(number);
    return vg_fail_memory(err, "the union of shells");
  }
  memset(number, 0xff, w->m->n_point * sizeof *number);
  add_shell(w, (uint32_t)largest, number, q);
  for (size_t i = 0; i < w->n_shell; i++)
    if (i != largest && vg_root_of(w->set, (uint32_t)i) == root)
      add_shell(w, (uint32_t)i, number, q);
  free(number);
  return VG_OK;
}

/* --- the result ----------------------------------------------------------- */

/* Append a united set to `to`. from: [u->n_tri] triangles of the request. */
static vg_status append(struct work *w, const struct vg_mesh *u,
                        const uint32_t *from, const struct request *q,
                        struct vg_mesh *to, struct vg_error *err)
{
  const size_t n_point = to->n_point + u->n_point;
  const size_t n_tri = to->n_tri + u->n_tri;
  void *point = realloc(to->point, n_point * sizeof *to->point + 1), *tri,
       *patch;

  if (point) to->point = point;
  tri = realloc(to->tri, n_tri * sizeof *to->tri + 1);
  if (tri) to->tri = tri;
  patch = realloc(to->tri_patch, n_tri * sizeof *to->tri_patch + 1);
  if (patch) to->tri_patch = patch;
  if (!point || !tri || !patch)
    return vg_fail_memory(err, "the union of shells");
  for (size_t t = 0; t < u->n_tri; t++) {
    const uint32_t given = q->from[from[t]];
    const size_t at = to->n_tri + t;

    for (int k = 0; k < 3; k++)
      to->tri[at][k] = u->tri[t][k] + (uint32_t)to->n_point;
    to->tri_patch[at] = w->m->tri_patch[given];
    w->shell[w->of[given]].left += vg_triangle_area(u->point[u->tri[t][0]],
                                                    u->point[u->tri[t][1]],
                                                    u->point[u->tri[t][2]]);
  }
  if (u->n_point)
    memcpy(to->point + to->n_point, u->point, u->n_point * sizeof *u->point);
  to->n_point = n_point;
  to->n_tri = n_tri;
  return VG_OK;
}

static vg_status unite_set(struct work *w, uint32_t root, struct vg_mesh *to,
                           struct vg_error *err)
{
  struct request q = { .mesh = VG_MESH_INIT };
  struct vg_mesh united = VG_MESH_INIT;
  uint32_t *from = NULL;
  vg_status st;

  VG_TRY(make_request(w, root, &q, err));
  st = vg_wrap_unite(&q.mesh, w->o->subtracts, &w->o->stop, &united, &from,
                     err);
  if (st != VG_OK) goto done;
  VG_TRY(append(w, &united, from, &q, to, err));
done:
  request_release(&q);
  vg_mesh_release(&united);
  free(from);
  return st;
}

/* The triangles of shells that meet no other one. */
static vg_status take_rest(const struct work *w, struct vg_mesh *to,
                           struct vg_error *err)
{
  uint8_t *stays = vg_alloc(w->m->n_tri, 1);
  vg_status st;

  if (!stays) return vg_fail_memory(err, "the union of shells");
  for (size_t t = 0; t < w->m->n_tri; t++)
    stays[t] = members_of(w, w->of[t]) < 2;
  VG_TRY(vg_mesh_copy(to, w->m, err));
  VG_TRY(vg_wrap_select(to, stays, err));
done:
  free(stays);
  return st;
}

static int is_full(const struct shell *s)
{
  double box = 1;

  for (int d = 0; d < 3; d++) box *= s->hi[d] - s->lo[d];
  return fabs(s->volume) > FULL * box;
}

static void report(const struct work *w, struct vg_unite_report *r)
{
  *r = (struct vg_unite_report){ 0 };
  for (size_t i = 0; i < w->n_shell; i++) {
    const uint32_t root = vg_root_of(w->set, (uint32_t)i);
    const struct shell *s = &w->shell[i];

    if (w->members[root] < 2) continue;
    r->n_shell++;
    r->n_set += root == i;
    r->n_before += s->n_tri;
    if (!(s->left < INSIDE * s->area)) continue;
    for (size_t j = 0; j < w->n_shell && !r->is_ambiguous; j++) {
      if (j == i || vg_root_of(w->set, (uint32_t)j) != root ||
          !is_full(&w->shell[j]) ||
          !(fabs(w->shell[j].volume) > fabs(s->volume)))
        continue;
      r->is_ambiguous = 1;
      memcpy(r->at, w->m->point[w->m->tri[s->first][0]], sizeof r->at);
      r->inside = w->m->tri_patch[s->first];
      r->around = w->m->tri_patch[w->shell[j].first];
    }
  }
}

/* Without the helper another surface would be made, or none. */
static vg_status check_helper(const char *what, struct vg_error *err)
{
  char why[200];

  if (vg_wrap_is_available(why, sizeof why)) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED, "%s needs vanguard-wrap: %s", what,
                 why);
}

vg_status vg_unite(struct vg_mesh *m, const struct vg_surface_report *check,
                   const struct vg_unite_options *o, struct vg_unite_report *r,
                   struct vg_error *err)
{
  struct work w = { .m = m, .o = o };
  struct vg_edges e = VG_EDGES_INIT;
  struct vg_mesh made = VG_MESH_INIT;
  size_t n_rest;
  vg_status st;

  if (m->n_quad || !m->n_tri) return VG_BLOCKED;
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  VG_TRY(find_shells(&w, &e, err));
  find_sets(&w, &e, check);
  if (!is_possible(&w)) {
    st = VG_BLOCKED;
    goto done;
  }
  VG_TRY(check_helper("closed parts of the surface cross or touch each other, "
                      "and uniting them",
                      err));
  VG_TRY(take_rest(&w, &made, err));
  n_rest = made.n_tri;
  for (uint32_t i = 0; i < w.n_shell; i++) {
    if (vg_root_of(w.set, i) != i || w.members[i] < 2) continue;
    st = unite_set(&w, i, &made, err);
    if (st != VG_OK) goto done;
  }
  report(&w, r);
  r->n_after = made.n_tri - n_rest;
  vg_mesh_move(m, &made);
done:
  release(&w);
  vg_edges_release(&e);
  vg_mesh_release(&made);
  return st;
}

vg_status vg_imprint(struct vg_mesh *m, size_t n_wall,
                     const struct vg_stop *stop, size_t *n_made,
                     struct vg_error *err)
{
  struct vg_mesh made = VG_MESH_INIT;
  uint32_t *from = NULL;
  vg_status st;

  VG_TRY(check_helper("inner surfaces cross other surfaces, and finding the "
                      "common curves",
                      err));
  st = vg_wrap_imprint(m, n_wall, stop, &made, &from, err);
  if (st != VG_OK) goto done;
  made.patch = vg_alloc(m->n_patch, sizeof *made.patch);
  if (!made.patch) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  if (m->n_patch) memcpy(made.patch, m->patch, m->n_patch * sizeof *m->patch);
  made.n_patch = m->n_patch;
  *n_made = 0;
  for (size_t t = 0; t < made.n_tri; t++) {
    made.tri_patch[t] = m->tri_patch[from[t]];
    *n_made += from[t] < n_wall;
  }
  vg_mesh_move(m, &made);
done:
  vg_mesh_release(&made);
  free(from);
  return st;
}
