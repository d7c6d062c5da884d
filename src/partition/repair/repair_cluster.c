/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Joins cells of several pieces by the global ids of their points, and repairs
 * them. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/delaunay/tets.h"
#include "partition/repair/repair_parts.h"

/* --- messages ------------------------------------------------------------ */

void vg_cluster_cells_release(struct vg_cluster_cells *b)
{
  free(b->name);
  free(b->x);
  free(b->hold);
  free(b->cell);
  memset(b, 0, sizeof *b);
}

void vg_cluster_cells_put(struct vg_writer *w, const struct vg_cluster_cells *b)
{
  uint64_t count[2] = { b->n_point, b->n_cell };

  vg_put(w, 1, sizeof b->cluster, &b->cluster);
  vg_put(w, 1, sizeof b->path, b->path);
  vg_put(w, 2, sizeof *count, count);
  vg_put(w, b->n_point, sizeof *b->name, b->name);
  vg_put(w, b->n_point, sizeof *b->x, b->x);
  vg_put(w, b->n_point, sizeof *b->hold, b->hold);
  vg_put(w, b->n_cell, sizeof *b->cell, b->cell);
}

void vg_cluster_cells_get(struct vg_reader *r, struct vg_cluster_cells *b)
{
  uint64_t count[2] = { 0, 0 };

  memset(b, 0, sizeof *b);
  vg_get(r, 1, sizeof b->cluster, &b->cluster);
  vg_get(r, 1, sizeof b->path, b->path);
  vg_get(r, 2, sizeof *count, count);
  b->n_point = count[0];
  b->n_cell = count[1];
  b->name = vg_get_array(r, b->n_point, sizeof *b->name);
  b->x = vg_get_array(r, b->n_point, sizeof *b->x);
  b->hold = vg_get_array(r, b->n_point, sizeof *b->hold);
  b->cell = vg_get_array(r, b->n_cell, sizeof *b->cell);
  if (r->bad) vg_cluster_cells_release(b);
}

void vg_repaired_release(struct vg_repaired *m)
{
  vg_piece_release(&m->piece);
  free(m->moved);
  free(m->x);
  free(m->spot);
  memset(m, 0, sizeof *m);
}

/* --- joining ------------------------------------------------------------- */

struct joint {
  size_t n_block;
  const struct vg_cluster_cells *block;
  const struct vg_spot_grid *balls;
  const struct vg_repair_boundary *boundary;
  const struct vg_sizing *sizing;
  const struct vg_repair_levels *level;
  /* points in the order of first use */
  size_t n_point, n_fixed, n_cell;
  uint64_t *name;
  double (*x)[3];
  uint8_t *fixed;
  uint32_t *number; /* [n_point] Index in the tetrahedra, fixed points first. */
  uint32_t *point;  /* [n_point] Inverse. */
  struct vg_table table; /* Points by global id. */
  uint32_t **local;      /* [n_block][block.n_point] */
  struct vg_tets t;
  struct vg_metrics *metrics; /* Of the points of t, or NULL. */
};

static void joint_free(struct joint *j)
{
  for (size_t k = 0; j->local && k < j->n_block; k++) free(j->local[k]);
  free(j->local);
  free(j->name);
  free(j->x);
  free(j->fixed);
  free(j->number);
  free(j->point);
  vg_table_release(&j->table);
  vg_metrics_free(j->metrics);
  vg_tets_release(&j->t);
}

static vg_status joint_new(struct joint *j, struct vg_error *err)
{
  size_t n = 0;

  for (size_t k = 0; k < j->n_block; k++) {
    n += j->block[k].n_point;
    j->n_cell += j->block[k].n_cell;
  }
  j->name = vg_alloc(n, sizeof *j->name);
  j->x = vg_alloc(n, sizeof *j->x);
  j->fixed = vg_calloc(n, 1);
  j->number = vg_alloc(n, sizeof *j->number);
  j->point = vg_alloc(n, sizeof *j->point);
  j->local = vg_calloc(j->n_block, sizeof *j->local);
  if (!j->name || !j->x || !j->fixed || !j->number || !j->point || !j->local ||
      vg_table_init(&j->table, n))
    return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < j->n_block; k++) {
    j->local[k] = vg_alloc(j->block[k].n_point, sizeof **j->local);
    if (!j->local[k]) return vg_fail_memory(err, "repairs");
  }
  return VG_OK;
}

/* Finds or adds the point with that global id. */
static uint32_t point_of(struct joint *j, uint64_t name, const double x[3])
{
  uint32_t *at;

  VG_TABLE_FIND(&j->table, at, vg_hash_1(name), j->name[*at] == name);
  if (*at != VG_TABLE_FREE) return *at;
  *at = (uint32_t)j->n_point;
  j->name[j->n_point] = name;
  memcpy(j->x[j->n_point], x, sizeof *j->x);
  return (uint32_t)j->n_point++;
}

/* Fixes points of the boundary, points outside the balls, and points of which
 * another cluster has cells. */
static void join_points(struct joint *j)
{
  size_t n_free = 0;

  for (size_t k = 0; k < j->n_block; k++) {
    const struct vg_cluster_cells *b = &j->block[k];

    for (size_t i = 0; i < b->n_point; i++) {
      uint32_t q = j->local[k][i] = point_of(j, b->name[i], b->x[i]);

      j->fixed[q] |= b->hold[i];
    }
  }
  for (size_t q = 0; q < j->n_point; q++) {
    if (!(j->name[q] >> 32) ||
        vg_spot_grid_at(j->balls, j->x[q]) != j->block[0].cluster)
      j->fixed[q] = 1;
    j->n_fixed += j->fixed[q];
  }
  for (size_t q = 0, n = 0; q < j->n_point; q++) {
    j->number[q] = (uint32_t)(j->fixed[q] ? n++ : j->n_fixed + n_free++);
    j->point[j->number[q]] = (uint32_t)q;
  }
}

/* Is face i of cell c a triangle of the boundary? */
static int on_rim(const struct joint *j, uint32_t c, int i)
{
  const uint32_t *v = j->t.cell[c].v;
  uint32_t at[3];

  for (int m = 0; m < 3; m++) {
    uint64_t name = j->name[j->point[v[vg_face[i][m]]]];

    if (name >> 32) return 0;
    at[m] = (uint32_t)name;
  }
  return vg_repair_boundary_has(j->boundary, at);
}

/* Fixes the outer faces of the cells and sheets of the boundary. Other faces
 * of three boundary points are free: between them are flat cells over edges
 * that the boundary has swapped. */
static void fix_faces(struct joint *j)
{
  struct vg_tets *t = &j->t;

  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (t->cell[c].link[i] == VG_NONE || on_rim(j, c, i))
        t->flag[c] |= (uint8_t)(1 << i);
}

static vg_status join_cells(struct joint *j, struct vg_error *err)
{
  double(*x)[3] = vg_alloc(j->n_point, sizeof *x);
  uint32_t(*cell)[4] = vg_alloc(j->n_cell, sizeof *cell);
  size_t n = 0;
  vg_status st;

  if (!x || !cell) {
    free(x);
    free(cell);
    return vg_fail_memory(err, "repairs");
  }
  for (size_t q = 0; q < j->n_point; q++)
    memcpy(x[j->number[q]], j->x[q], sizeof *x);
  for (size_t k = 0; k < j->n_block; k++)
    for (size_t c = 0; c < j->block[k].n_cell; c++, n++)
      for (int i = 0; i < 4; i++)
        cell[n][i] = j->number[j->local[k][j->block[k].cell[c][i]]];
  st = vg_tets_from_cells(&j->t, j->n_point, x, n, (const uint32_t(*)[4])cell,
                          err);
  free(cell);
  if (st < 0) return st;
  fix_faces(j);
  return vg_metrics_of_corners(j->sizing, &j->t, &j->metrics) < 0
         ? vg_fail_memory(err, "repairs")
         : VG_OK;
}

/* --- results ------------------------------------------------------------- */

enum { CLASSES = VG_REPAIR_CLASSES };

/* Shape of the worst cell, and number of cells in each class. */
struct tally {
  double worst;
  uint64_t n[CLASSES];
};

static struct tally measure(const struct joint *j)
{
  const struct vg_tets *t = &j->t;
  struct tally s = { .worst = 2 };

  for (size_t c = 0; c < t->n_cell; c++) {
    double q;

    if (t->flag[c] & VG_DEAD) continue;
    q = vg_cell_shape(j->metrics, t, t->cell[c].v);
    if (q < s.worst) s.worst = q;
    for (int k = 0; k < CLASSES; k++) s.n[k] += q < j->level->tally[k];
  }
  return s;
}

/* The worst cell and the very bad ones decide: a point inserted for them may
 * leave a few more cells that are only bad. */
static int is_better(const struct tally *now, const struct tally *old)
{
  int fewer = 0;

  if (now->worst < old->worst) return 0;
  for (int k = 0; k < CLASSES - 1; k++) {
    if (now->n[k] > old->n[k]) return 0;
    fewer |= now->n[k] < old->n[k];
  }
  if (fewer || now->n[CLASSES - 1] != old->n[CLASSES - 1])
    return fewer || now->n[CLASSES - 1] < old->n[CLASSES - 1];
  return now->worst > old->worst;
}

/* Numbers the points that cells use for a piece, points of other pieces first.
 * to out: [t.n_point] or VG_NONE. Returns 0 if a point of another piece lost
 * all its cells. */
static int number_points(const struct joint *j, struct vg_piece *piece,
                         uint32_t *to)
{
  const struct vg_tets *t = &j->t;

  memset(to, 0xff, t->n_point * sizeof *to);
  for (size_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    piece->n_cell++;
    for (int i = 0; i < 4; i++) to[t->cell[c].v[i]] = 0;
  }
  for (size_t q = 0; q < j->n_point; q++) {
    if (to[q] != VG_NONE) to[q] = (uint32_t)piece->n_in++;
    else if (q >= j->n_fixed) return 0;
  }
  for (size_t q = j->n_point; q < t->n_point; q++)
    if (to[q] != VG_NONE) to[q] = (uint32_t)(piece->n_in + piece->n_point++);
  return 1;
}

static vg_status to_piece(const struct joint *j, struct vg_repaired *m,
                          const uint32_t *to, struct vg_error *err)
{
  const struct vg_tets *t = &j->t;
  struct vg_piece *p = &m->piece;
  uint32_t(*cell)[4] = vg_alloc(p->n_cell, sizeof *cell);
  size_t n = 0;
  int refused;

  p->in = vg_alloc(p->n_in, sizeof *p->in);
  p->x = vg_alloc(p->n_in + p->n_point, sizeof *p->x);
  m->moved = vg_alloc(p->n_in, sizeof *m->moved);
  m->x = vg_alloc(p->n_in, sizeof *m->x);
  refused = !p->in || !p->x || !cell || !m->moved || !m->x;
  if (refused) goto done;
  for (size_t q = 0; q < t->n_point; q++)
    if (to[q] != VG_NONE) memcpy(p->x[to[q]], t->x[q], sizeof *p->x);
  for (size_t q = 0; q < j->n_point; q++) {
    const double *old = j->x[j->point[q]];

    if (to[q] == VG_NONE) continue;
    p->in[to[q]] = j->name[j->point[q]];
    if (t->x[q][0] == old[0] && t->x[q][1] == old[1] && t->x[q][2] == old[2])
      continue;
    m->moved[m->n_moved] = p->in[to[q]];
    memcpy(m->x[m->n_moved++], t->x[q], sizeof *m->x);
  }
  for (size_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    for (int i = 0; i < 4; i++) cell[n][i] = to[t->cell[c].v[i]];
    n++;
  }
  refused = vg_packed_cells_new(n, (const uint32_t(*)[4])cell,
                                p->n_in + p->n_point, &p->cell);
done:
  free(cell);
  return refused ? vg_fail_memory(err, "repairs") : VG_OK;
}

/* Lists balls around cells for which another attempt needs more room. */
static vg_status list_left(const struct joint *j, struct vg_repaired *m,
                           struct vg_error *err)
{
  const struct vg_tets *t = &j->t;

  for (size_t c = 0; c < t->n_cell; c++) {
    const double *x[4];

    if (t->flag[c] & VG_DEAD) continue;
    if (vg_cell_shape(j->metrics, t, t->cell[c].v) >= j->level->hopeless)
      continue;
    for (int i = 0; i < 4; i++) x[i] = t->x[t->cell[c].v[i]];
    if (vg_reserve(&m->spot, &m->cap_spot, m->n_spot + 1, sizeof *m->spot))
      return vg_fail_memory(err, "repairs");
    m->spot[m->n_spot++] = vg_spot_around(j->sizing, x, VG_SPOT_LARGE);
  }
  return VG_OK;
}

static vg_status take(const struct joint *j, const struct tally *old,
                      struct vg_repaired *m, struct vg_error *err)
{
  struct tally now = measure(j);
  uint32_t *to;
  vg_status st = VG_OK;

  m->worst_left = now.worst;
  m->n_bad_left = now.n[CLASSES - 1];
  m->better = is_better(&now, old);
  if (!m->better) {
    m->worst_left = m->worst;
    m->n_bad_left = m->n_bad;
    return VG_OK;
  }
  to = vg_alloc(j->t.n_point, sizeof *to);
  if (!to) return vg_fail_memory(err, "repairs");
  m->better = number_points(j, &m->piece, to);
  if (m->better) st = to_piece(j, m, to, err);
  free(to);
  return st;
}

vg_status vg_repair_cluster(size_t n, const struct vg_cluster_cells *block,
                            const struct vg_spot_grid *balls,
                            const struct vg_repair_boundary *boundary,
                            const struct vg_sizing *sizing,
                            struct vg_repaired *out, struct vg_error *err)
{
  assert(n > 0 && block && balls && boundary && out);

  struct joint j = { .n_block = n,
                     .block = block,
                     .balls = balls,
                     .boundary = boundary,
                     .sizing = sizing,
                     .level = vg_repair_levels(sizing) };
  struct vg_optimise_report r;
  struct vg_repaired m = { .better = 0 };
  struct tally old;
  vg_status st = joint_new(&j, err);

  m.n_cell = j.n_cell;
  if (st == VG_OK) {
    join_points(&j);
    st = join_cells(&j, err);
  }
  if (st == VG_OK) {
    old = measure(&j);
    m.worst = m.worst_left = old.worst;
    m.n_bad = m.n_bad_left = old.n[CLASSES - 1];
    st = vg_optimise_bad(&j.t, j.n_fixed, j.n_point, j.metrics, &r, err);
  }
  if (st == VG_OK) st = take(&j, &old, &m, err);
  if (st == VG_OK) st = list_left(&j, &m, err);
  if (st == VG_ERR_GEOMETRY) {
    /* inconsistent or flat cells are left to the mesh check */
    m.better = 0;
    m.worst_left = m.worst;
    st = VG_OK;
  }
  joint_free(&j);
  if (st == VG_OK) *out = m;
  else vg_repaired_release(&m);
  return st;
}
