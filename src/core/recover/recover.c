/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/recover/recover.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"
#include "core/recover/cdt_tetgen.h"
#include "core/recover/recover_flip.h"

/* A pocket with more triangles than POCKET_MAX is refused. If flips leave that
 * many, the triangles of the surface are easier to recover than the border of
 * the pocket, which consists of faces of flipped cells. Some pockets of 10,000
 * triangles were worth closing. */
enum { ROUNDS = 4, POCKET_MAX = 40000 }; /* K1 */

struct recovery {
  struct vg_tets *t;
  size_t n_tri;
  const uint32_t (*tri)[3];
  size_t n_missing;
  uint32_t *missing; /* [n_missing] triangles missing from t */
  uint32_t *parent;  /* [n_missing] union-find forest of the pockets */
  uint32_t *owner;   /* [cells] missing triangle that claims each cell */
  uint32_t *star;    /* [points] a cell of each point */
  size_t n_cell, cap_cell;
  uint32_t *cell; /* cells of all pockets, in the order of discovery */
  int is_apart;   /* 1: pockets are not merged; a triangle whose pocket meets
                     another one waits for the next round */
  struct vg_boundary_report *report;
};

/* --- cells that a triangle passes through --------------------------------- */

/* Coordinates i, j of the projection in which a triangle has the largest area.
 */
static void project(const double *const x[3], int *i, int *j)
{
  double most = -1;

  for (int k = 0; k < 3; k++) {
    int u = (k + 1) % 3, v = (k + 2) % 3;
    double n = fabs((x[1][u] - x[0][u]) * (x[2][v] - x[0][v]) -
                    (x[1][v] - x[0][v]) * (x[2][u] - x[0][u]));

    if (n <= most) continue;
    most = n;
    *i = u;
    *j = v;
  }
}

/* Does the segment p q, in the plane of triangle x, run through the interior of
 * the triangle? If not, the line of the segment or of an edge separates the
 * two. */
static int runs_through(const double *const x[3], const double *p,
                        const double *q)
{
  double a[3][2], from[2], to[2], turn;
  int i = 0, j = 1, left = 0, right = 0;

  project(x, &i, &j);
  for (int k = 0; k < 3; k++) {
    a[k][0] = x[k][i];
    a[k][1] = x[k][j];
  }
  from[0] = p[i];
  from[1] = p[j];
  to[0] = q[i];
  to[1] = q[j];
  turn = vg_orient2d(a[0], a[1], a[2]);
  for (int k = 0; k < 3; k++) {
    double at = vg_orient2d(from, to, a[k]);
    double s = vg_orient2d(a[k], a[(k + 1) % 3], from);
    double e = vg_orient2d(a[k], a[(k + 1) % 3], to);

    left |= at > 0;
    right |= at < 0;
    if (turn > 0 ? s <= 0 && e <= 0 : s >= 0 && e >= 0) return 0;
  }
  return left && right;
}

/* Does the triangle pass through cell c? The test is conservative: contact at
 * a corner or along an edge does not count, but a cell near the triangle may
 * be reported although they do not intersect. A cell with a face in the plane
 * of the triangle counts, because that face must be replaced, and so does one
 * with an edge that runs through the triangle in its plane. */
static int passes_through(const struct vg_tets *t, const uint32_t tri[3],
                          uint32_t c)
{
  const double *a = t->x[tri[0]], *b = t->x[tri[1]], *d = t->x[tri[2]];
  const double *corner[3] = { a, b, d }, *within[4];
  const uint32_t *v = t->cell[c].v;
  int above = 0, below = 0, skip = -1, n_within = 0;

  for (int i = 0; i < 4; i++) {
    double side = vg_orient3d(a, b, d, t->x[v[i]]);

    above += side > 0;
    below += side < 0;
    if (side != 0) skip = i;
    else within[n_within++] = t->x[v[i]];
  }
  if (n_within == 2 && !(above && below))
    return runs_through(corner, within[0], within[1]);
  if (!(above && below) && above + below != 1) return 0;
  if (above && below) skip = -1;
  for (int i = 0; i < 4; i++) {
    const double *p = t->x[v[vg_face[i][0]]], *q = t->x[v[vg_face[i][1]]];
    const double *r = t->x[v[vg_face[i][2]]];

    if (i == skip) continue;
    if (!(vg_orient3d(p, q, r, a) > 0) && !(vg_orient3d(p, q, r, b) > 0) &&
        !(vg_orient3d(p, q, r, d) > 0))
      return 0;
  }
  return 1;
}

/* Returns 1 if the cell belongs to another pocket and pockets are not merged.
 */
static int claim(struct recovery *r, uint32_t c, uint32_t k)
{
  if (r->owner[c] != VG_NONE) {
    if (r->is_apart) return r->owner[c] != k;
    vg_union(r->parent, r->owner[c], k);
    return 0;
  }
  if (vg_reserve(&r->cell, &r->cap_cell, r->n_cell + 1, sizeof *r->cell))
    return -1;
  r->owner[c] = k;
  r->cell[r->n_cell++] = c;
  return 0;
}

/* Cells visited for one triangle. They have the flag VG_MARK during the
 * search. */
struct visit {
  size_t n, cap;
  uint32_t *cell;
};

static int visit(struct recovery *r, struct visit *list, uint32_t c)
{
  if (r->t->flag[c] & VG_MARK) return 0;
  if (vg_reserve(&list->cell, &list->cap, list->n + 1, sizeof *list->cell))
    return -1;
  r->t->flag[c] |= VG_MARK;
  list->cell[list->n++] = c;
  return 0;
}

/* Does face i, between a cell and its neighbour, have a corner of the
 * triangle? */
static int share_corner(const struct vg_cell *c, int i, const uint32_t tri[3])
{
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 3; j++)
      if (c->v[vg_face[i][k]] == tri[j]) return 1;
  return 0;
}

/* The search runs around the corners of the triangle and through its pocket,
 * which is connected and begins at a corner. */
static int find_pocket(struct recovery *r, struct visit *list, uint32_t k)
{
  struct vg_tets *t = r->t;
  const uint32_t *tri = r->tri[r->missing[k]];
  size_t n_before = r->n_cell;
  int bad = 0;

  list->n = 0;
  for (int i = 0; i < 3 && !bad; i++) bad = visit(r, list, r->star[tri[i]]);
  for (size_t m = 0; m < list->n && !bad; m++) {
    uint32_t c = list->cell[m];
    int inside = passes_through(t, tri, c);

    if (inside) bad = claim(r, c, k);
    for (int i = 0; i < 4 && !bad; i++) {
      uint32_t link = t->cell[c].link[i];

      if (link != VG_NONE && (inside || share_corner(&t->cell[c], i, tri)))
        bad = visit(r, list, link >> 2);
    }
  }
  for (size_t m = 0; m < list->n; m++)
    t->flag[list->cell[m]] &= (uint8_t)~VG_MARK;
  while (bad > 0 && r->n_cell > n_before)
    r->owner[r->cell[--r->n_cell]] = VG_NONE;
  return bad < 0 ? -1 : 0;
}

/* Add one more layer of cells around every pocket. */
static int add_ring(struct recovery *r)
{
  size_t n = r->n_cell;

  for (size_t m = 0; m < n; m++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = r->t->cell[r->cell[m]].link[i];

      if (link != VG_NONE && claim(r, link >> 2, r->owner[r->cell[m]]) < 0)
        return -1;
    }
  return 0;
}

/* --- closing one pocket --------------------------------------------------- */

struct pocket {
  size_t n_cell, n_tri, cap_tri, n_border, n_point;
  const struct vg_key *cell; /* index: cell of the pocket */
  uint32_t (*tri)[3];        /* border faces, then fixed faces inside and
                                missing triangles */
  uint32_t *point;           /* [n_point] indices in t, sorted */
  double (*x)[3];            /* [n_point]; NULL: do not close the pocket in
                                this round */
};

static int add_tri(struct pocket *p, const uint32_t v[3])
{
  if (vg_reserve(&p->tri, &p->cap_tri, p->n_tri + 1, sizeof *p->tri)) return -1;
  memcpy(p->tri[p->n_tri++], v, 3 * sizeof *v);
  return 0;
}

static int add_faces(const struct vg_tets *t, struct pocket *p, int border)
{
  for (size_t m = 0; m < p->n_cell; m++) {
    uint32_t c = p->cell[m].index, v[3];

    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i], other = link >> 2;
      int is_border = link == VG_NONE || !(t->flag[other] & VG_MARK);

      if (is_border != border) continue;
      if (!border && (!(t->flag[c] >> i & 1) || c > other)) continue;
      for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
      if (add_tri(p, v)) return -1;
    }
  }
  if (border) p->n_border = p->n_tri;
  return 0;
}

static int by_number(const void *a, const void *b)
{
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

  return (x > y) - (x < y);
}

/* Collect the points of the pocket, and replace the corners of its triangles
 * by indices into them. */
static int number_points(const struct vg_tets *t, struct pocket *p)
{
  size_t n = 0;

  p->point = vg_alloc(4 * p->n_cell, sizeof *p->point);
  if (!p->point) return -1;
  for (size_t m = 0; m < p->n_cell; m++)
    for (int i = 0; i < 4; i++) p->point[n++] = t->cell[p->cell[m].index].v[i];
  qsort(p->point, n, sizeof *p->point, by_number);
  for (size_t m = 0; m < n; m++)
    if (!m || p->point[m] != p->point[m - 1])
      p->point[p->n_point++] = p->point[m];
  for (size_t m = 0; m < p->n_tri; m++)
    for (int k = 0; k < 3; k++) {
      const uint32_t *at = bsearch(&p->tri[m][k], p->point, p->n_point,
                                   sizeof *at, by_number);

      if (!at) return 1; /* corner outside: the pocket is too small */
      p->tri[m][k] = (uint32_t)(at - p->point);
    }
  return 0;
}

/* Do two cells lie on the same side of their common face? */
static int is_folded(const struct vg_tets *t)
{
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i], v[3], w[3];
      int k = 0;

      if (link == VG_NONE) continue;
      for (int m = 0; m < 3; m++) {
        v[m] = t->cell[c].v[vg_face[i][m]];
        w[m] = t->cell[link >> 2].v[vg_face[link & 3][m]];
      }
      while (w[k] != v[0]) k++;
      if (w[(k + 1) % 3] == v[1]) return 1;
    }
  return 0;
}

/* Flag the cells outside the border, then check that every triangle is a face.
 */
static vg_status verify(struct vg_tets *local, const struct pocket *p,
                        struct vg_error *err)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])p->tri;
  size_t n_missing;
  vg_status st = vg_boundary_fix(local, p->n_border, tri, NULL, &n_missing,
                                 err);

  if (st == VG_OK && !n_missing)
    st = vg_boundary_sides(local, p->n_border, tri, NULL, 0, NULL, err);
  if (st == VG_OK && !n_missing)
    st = vg_boundary_fix(local, p->n_tri, tri, NULL, &n_missing, err);
  if (st == VG_OK && (n_missing || is_folded(local)))
    st = vg_fail(err, VG_ERR_GEOMETRY, "TetGen closed a pocket incorrectly");
  return st;
}

/* Remove cell c, whose neighbours then have open faces. */
static vg_status remove_cell(struct vg_tets *t, uint32_t c,
                             struct vg_error *err)
{
  for (int i = 0; i < 4; i++) {
    uint32_t link = t->cell[c].link[i];

    if (link != VG_NONE) t->cell[link >> 2].link[link & 3] = VG_NONE;
  }
  return vg_tets_free_cell(t, c) ? vg_fail_memory(err, "boundary recovery")
                                 : VG_OK;
}

/* Replace the pocket's cells by the local cells, whose faces are linked later.
 */
static vg_status replace(struct recovery *r, const struct pocket *p,
                         const struct vg_tets *local, struct vg_error *err)
{
  struct vg_tets *t = r->t;
  size_t added = local->n_point - p->n_point, first = t->n_point;
  vg_status st = VG_OK;

  if (vg_tets_reserve_points(t, added) ||
      vg_tets_reserve_cells(t, local->n_cell))
    return vg_fail_memory(err, "boundary recovery");
  memcpy(t->x + first, local->x + p->n_point, added * sizeof *t->x);
  t->n_point += added;
  for (size_t m = 0; m < p->n_cell; m++)
    VG_TRY(remove_cell(t, p->cell[m].index, err));
  for (size_t c = 0; c < local->n_cell; c++) {
    uint32_t slot;

    if (local->flag[c] & VG_OUTSIDE) continue;
    slot = vg_tets_alloc_cell(t);
    for (int i = 0; i < 4; i++) {
      uint32_t v = local->cell[c].v[i];

      t->cell[slot].v[i] = v < p->n_point ? p->point[v]
                                          : (uint32_t)(first + v - p->n_point);
      t->cell[slot].link[i] = VG_NONE;
    }
    t->flag[slot] = 0;
  }
  r->report->n_pocket++;
  r->report->n_pocket_cell += local->n_cell;
  r->report->n_steiner += added;
done:
  return st;
}

/* Set up the input to TetGen for one pocket. tri: its missing triangles.
 * VG_BLOCKED if a corner of them lies outside the pocket. */
static vg_status describe(struct recovery *r, struct pocket *p, size_t n_tri,
                          const struct vg_key *tri, struct vg_error *err)
{
  double(*x)[3] = NULL;
  int bad;

  for (size_t m = 0; m < p->n_cell; m++)
    r->t->flag[p->cell[m].index] |= VG_MARK;
  bad = add_faces(r->t, p, 1);
  if (!bad) bad = add_faces(r->t, p, 0);
  for (size_t m = 0; m < p->n_cell; m++)
    r->t->flag[p->cell[m].index] &= (uint8_t)~VG_MARK;
  for (size_t m = 0; m < n_tri && !bad; m++)
    bad = add_tri(p, r->tri[r->missing[tri[m].index]]);
  if (!bad) bad = number_points(r->t, p);
  if (!bad) {
    x = vg_alloc(p->n_point, sizeof *x);
    bad = x ? 0 : -1;
  }
  if (bad)
    return bad > 0 ? VG_BLOCKED : vg_fail_memory(err, "boundary recovery");
  for (size_t k = 0; k < p->n_point; k++)
    memcpy(x[k], r->t->x[p->point[k]], sizeof *x);
  p->x = x;
  return VG_OK;
}

/* Use TetGen's result for one pocket if it is correct. */
static vg_status accept(struct recovery *r, struct pocket *p,
                        struct vg_cdt_job *job, struct vg_error *err)
{
  struct vg_tets local = VG_TETS_INIT;
  vg_status st = job->st;

  if (st == VG_OK)
    st = vg_tets_from_cells(&local, job->n_all, job->all, job->n_tet,
                            (const uint32_t(*)[4])job->tet, err);
  if (st == VG_OK) st = verify(&local, p, err);
  if (st == VG_OK) st = replace(r, p, &local, err);
  vg_tets_release(&local);
  free(job->tet);
  if (st != VG_ERR_GEOMETRY) return st;
  r->report->n_retry++;
  return VG_OK;
}

/* --- rounds --------------------------------------------------------------- */

/* Split the cells and the missing triangles, both sorted by pocket, into
 * pockets. */
static vg_status describe_all(struct recovery *r, const struct vg_key *cell,
                              const struct vg_key *tri, struct pocket *pocket,
                              size_t *n_pocket, struct vg_error *err)
{
  size_t c = 0, k = 0;
  vg_status st = VG_OK;

  *n_pocket = 0;
  while (st == VG_OK && c < r->n_cell) {
    struct pocket *p = &pocket[*n_pocket];
    uint64_t id = cell[c].key;
    size_t c1 = c, k1;

    memset(p, 0, sizeof *p);
    while (c1 < r->n_cell && cell[c1].key == id) c1++;
    while (k < r->n_missing && tri[k].key < id) k++;
    for (k1 = k; k1 < r->n_missing && tri[k1].key == id; k1++) {
    }
    p->cell = cell + c;
    p->n_cell = c1 - c;
    ++*n_pocket;
    st = describe(r, p, k1 - k, tri + k, err);
    if (st == VG_BLOCKED) {
      p->n_tri = 0; /* not closed in this round */
      r->report->n_retry++;
      st = VG_OK;
    }
    c = c1;
    k = k1;
  }
  for (size_t m = 0; st == VG_OK && m < *n_pocket; m++)
    if (pocket[m].n_tri > POCKET_MAX)
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "%zu of %zu surface triangles are "
                   "missing, too many to recover in pockets",
                   r->n_missing, r->n_tri);
  return st;
}

/* A pocket that TetGen could not close waits for the next round. */
static vg_status close_all(struct recovery *r, size_t n, struct pocket *pocket,
                           struct vg_error *err)
{
  struct vg_cdt_job *job = vg_calloc(n, sizeof *job);
  struct vg_error why = VG_ERROR_INIT;
  size_t n_job = 0;
  vg_status st = VG_OK;

  if (!job) return vg_fail_memory(err, "boundary recovery");
  for (size_t k = 0; k < n; k++)
    if (pocket[k].x)
      job[n_job++] = (struct vg_cdt_job){
        .n = pocket[k].n_point,
        .n_tri = pocket[k].n_tri,
        .x = (const double(*)[3])pocket[k].x,
        .tri = (const uint32_t(*)[3])pocket[k].tri
      };
  st = vg_cdt_tetgen(n_job, job, &why);
  if (st == VG_BLOCKED) {
    r->report->n_unassisted += n_job;
    st = VG_ERR_GEOMETRY;
  }
  if (st < 0) vg_fail(err, st, "%s", why.text);
  n_job = 0;
  for (size_t k = 0; k < n; k++) {
    if (!pocket[k].x) continue;
    if (st == VG_OK) {
      st = accept(r, &pocket[k], &job[n_job], err);
    } else {
      free(job[n_job].all);
      free(job[n_job].tet);
    }
    n_job++;
  }
  free(job);
  return st;
}

static vg_status close_pockets(struct recovery *r, struct vg_error *err)
{
  struct vg_key *cell = vg_alloc(r->n_cell, sizeof *cell);
  struct vg_key *tri = vg_alloc(r->n_missing, sizeof *tri);
  struct pocket *pocket = vg_alloc(r->n_missing, sizeof *pocket);
  size_t n = 0;
  vg_status st = VG_OK;

  if (!cell || !tri || !pocket) st = vg_fail_memory(err, "boundary recovery");
  for (uint32_t m = 0; st == VG_OK && m < r->n_missing; m++) {
    tri[m].key = vg_root_of(r->parent, m);
    tri[m].index = m;
  }
  for (size_t m = 0; st == VG_OK && m < r->n_cell; m++) {
    cell[m].key = vg_root_of(r->parent, r->owner[r->cell[m]]);
    cell[m].index = r->cell[m];
  }
  if (st == VG_OK) st = vg_sort_keys(r->n_missing, tri, err);
  if (st == VG_OK) st = vg_sort_keys(r->n_cell, cell, err);
  if (st == VG_OK) st = describe_all(r, cell, tri, pocket, &n, err);
  if (st == VG_OK) st = close_all(r, n, pocket, err);
  for (size_t k = 0; k < n; k++) {
    free(pocket[k].x);
    free(pocket[k].tri);
    free(pocket[k].point);
  }
  free(pocket);
  free(cell);
  free(tri);
  return st;
}

static vg_status find_pockets(struct recovery *r, int rings,
                              struct vg_error *err)
{
  struct visit list = { 0 };
  struct vg_tets *t = r->t;
  int bad = 0;

  r->n_cell = 0;
  free(r->owner);
  free(r->star);
  r->owner = vg_alloc(t->n_cell, sizeof *r->owner);
  r->star = vg_alloc(t->n_point, sizeof *r->star);
  if (!r->owner || !r->star) return vg_fail_memory(err, "boundary recovery");
  memset(r->owner, 0xff, t->n_cell * sizeof *r->owner);
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++)
      r->star[t->cell[c].v[i]] = c;
  for (uint32_t k = 0; k < r->n_missing; k++) r->parent[k] = k;
  for (uint32_t k = 0; k < r->n_missing && !bad; k++)
    bad = find_pocket(r, &list, k);
  for (int k = 0; k < rings && !bad; k++) bad = add_ring(r);
  free(list.cell);
  return bad ? vg_fail_memory(err, "boundary recovery") : VG_OK;
}

static vg_status list_missing(struct recovery *r, uint8_t *missing,
                              struct vg_error *err)
{
  size_t n = 0;
  vg_status st;

  for (size_t c = 0; c < r->t->n_cell; c++)
    r->t->flag[c] &= (uint8_t)~VG_FIXED_FACES;
  st = vg_boundary_fix(r->t, r->n_tri, r->tri, missing, &r->n_missing, err);
  for (size_t k = 0; st == VG_OK && k < r->n_tri; k++)
    if (missing[k]) r->missing[n++] = (uint32_t)k;
  return st;
}

/* Every flip maintains the fixed faces. Their number therefore shows whether
 * all triangles are present, provided that no triangle occurs twice. */
static int is_complete(const struct recovery *r)
{
  static const uint8_t bits[16] = { 0, 1, 1, 2, 1, 2, 2, 3,
                                    1, 2, 2, 3, 2, 3, 3, 4 };
  size_t n = 0;

  for (size_t c = 0; c < r->t->n_cell; c++)
    n += bits[r->t->flag[c] & VG_FIXED_FACES];
  return !r->n_missing && n == 2 * r->n_tri;
}

static vg_status flip_missing(struct recovery *r, uint8_t *missing,
                              struct vg_error *err)
{
  vg_status st = vg_recover_flips(r->t, r->n_tri, r->tri, &r->n_missing,
                                  r->missing, err);

  if (st == VG_OK && !is_complete(r)) st = list_missing(r, missing, err);
  return st;
}

/* Close pockets with this number of rings of cells around them. */
static vg_status close_round(struct recovery *r, int rings, uint8_t *missing,
                             struct vg_error *err)
{
  vg_status st = find_pockets(r, rings, err);

  if (st == VG_OK) st = close_pockets(r, err);
  if (st == VG_OK) st = vg_tets_link_open(r->t, err);
  if (st == VG_OK) st = list_missing(r, missing, err);
  return st;
}

/* TetGen closes small pockets more reliably than large ones. While that helps,
 * close the pocket of each missing triangle by itself, without or with rings,
 * and try flips again among the changed cells. */
static vg_status close_apart(struct recovery *r, uint8_t *missing,
                             struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int rings = 0; st == VG_OK && r->n_missing && rings < ROUNDS;) {
    size_t before = r->n_missing;

    r->is_apart = 1;
    st = close_round(r, rings, missing, err);
    r->is_apart = 0;
    if (st == VG_OK && r->n_missing) st = flip_missing(r, missing, err);
    rings = r->n_missing < before ? 0 : rings + 1;
  }
  return st;
}

/* Dead cells get a value that differs from every live cell. */
static struct vg_cell *copy_of_cells(const struct vg_tets *t)
{
  struct vg_cell *copy = vg_alloc(t->n_cell, sizeof *copy);

  if (!copy) return NULL;
  memcpy(copy, t->cell, t->n_cell * sizeof *copy);
  for (size_t k = 0; k < t->n_free; k++) copy[t->free[k]].v[0] = VG_NONE;
  return copy;
}

vg_status vg_recover(struct vg_tets *t, size_t n_tri, const uint32_t (*tri)[3],
                     int is_delaunay, int has_inner,
                     struct vg_boundary_report *report, struct vg_error *err)
{
  assert(t->n_cell > 0 && (tri || !n_tri) && report);

  struct recovery r = { 0 };
  struct vg_cell *before = NULL;
  size_t n_before = 0;
  uint8_t *missing = vg_alloc(n_tri, 1);
  vg_status st = VG_OK;

  r.t = t;
  r.n_tri = n_tri;
  r.tri = tri;
  r.report = report;
  r.missing = vg_alloc(n_tri, sizeof *r.missing);
  r.parent = vg_alloc(n_tri, sizeof *r.parent);
  if (!missing || !r.missing || !r.parent)
    st = vg_fail_memory(err, "boundary recovery");
  if (st == VG_OK) st = list_missing(&r, missing, err);
  report->n_face_lost = r.n_missing;
  if (st == VG_OK && r.n_missing) {
    n_before = t->n_cell;
    before = copy_of_cells(t);
    if (!before) st = vg_fail_memory(err, "boundary recovery");
  }
  if (st == VG_OK && r.n_missing) st = flip_missing(&r, missing, err);
  report->n_face_left = r.n_missing;
  if (st == VG_OK && has_inner) st = close_apart(&r, missing, err);
  for (int rings = 0; st == VG_OK && r.n_missing && rings < ROUNDS; rings++) {
    st = close_round(&r, rings, missing, err);
    if (st == VG_OK && !rings) st = close_apart(&r, missing, err);
  }
  if (st == VG_OK && r.n_missing)
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "%zu surface triangles could not be "
                 "recovered in pockets",
                 r.n_missing);
  if (st == VG_OK && is_delaunay && report->n_face_lost)
    st = vg_recover_delaunay(t, n_before, before, &report->n_restored, err);
  if (st == VG_OK) VG_CHECK("the recovery of faces", vg_tets_defects(t));
  free(before);
  free(missing);
  free(r.missing);
  free(r.parent);
  free(r.owner);
  free(r.star);
  free(r.cell);
  return st;
}
