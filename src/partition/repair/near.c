/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/repair/near.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/judge/quality.h"

/* Angles are counted in bins of this fraction of a degree, as in the mesh
 * check. */
enum { PER_DEGREE = 100, N_BIN = 180 * PER_DEGREE + 1 };

struct census {
  const struct vg_partition *p;
  uint64_t *count;   /* [threads][N_BIN] Counts per thread. */
  double *least;     /* [threads] Smallest angle in degrees. */
  atomic_int failed; /* 1: memory was refused. */
};

/* Points of other tasks, and adopted points, which other tasks use too.
 * Boundary points do not count. */
static int on_interface(const struct vg_piece *q, uint32_t v)
{
  if (v < q->n_in) return q->in[v] >> 32 != 0;
  return v - q->n_in < q->n_adopted;
}

static int touches(const uint8_t *ring, const uint32_t cell[4], int reach)
{
  for (int k = 0; k < 4; k++)
    if (ring[cell[k]] && ring[cell[k]] <= reach) return 1;
  return 0;
}

/* Lists the cells near interfaces. cell out: [q.n_cell], *n of them used. */
static void list_near(const struct vg_piece *q, uint8_t *ring,
                      uint32_t (*cell)[4], size_t *n)
{
  *n = 0;
  for (size_t v = 0; v < q->n_in + q->n_point; v++)
    ring[v] = (uint8_t)on_interface(q, (uint32_t)v);
  vg_packed_cells_all(&q->cell, q->n_cell, cell);
  for (size_t i = 0; i < q->n_cell; i++)
    for (int k = 0; k < 4 && touches(ring, cell[i], 1); k++)
      if (!ring[cell[i][k]]) ring[cell[i][k]] = 2;
  for (size_t i = 0; i < q->n_cell; i++)
    if (q->kind != VG_SPAN_LEAF || touches(ring, cell[i], 2))
      memmove(cell[(*n)++], cell[i], sizeof *cell);
}

static void count(struct census *c, const struct vg_piece *q, int worker)
{
  uint8_t *ring = vg_alloc(q->n_in + q->n_point, 1);
  uint32_t(*cell)[4] = vg_alloc(q->n_cell, sizeof *cell);
  float *angle = vg_alloc(q->n_cell, sizeof *angle);
  struct vg_mesh near = VG_MESH_INIT;
  uint64_t *bin = c->count + (size_t)worker * N_BIN;

  if (ring && cell && angle) {
    list_near(q, ring, cell, &near.n_tet);
    near.n_point = q->n_in + q->n_point;
    near.point = q->x;
    near.tet = cell;
    vg_mesh_cell_quality(&near, angle, NULL);
    for (size_t i = 0; i < near.n_tet; i++) {
      double a = fmin(fmax((double)angle[i], 0), 180);

      bin[(size_t)(a * PER_DEGREE)]++;
      if (a < c->least[worker]) c->least[worker] = a;
    }
  } else {
    c->failed = 1;
  }
  free(ring);
  free(cell);
  free(angle);
}

static void count_pieces(void *context, size_t first, size_t end, int worker)
{
  struct census *c = context;

  for (size_t k = first; k < end; k++)
    if (c->p->piece[k].n_cell) count(c, &c->p->piece[k], worker);
}

static void report(const uint64_t *bin, double least,
                   struct vg_near_report *out)
{
  uint64_t seen = bin[0];
  size_t at = 0;

  *out = (struct vg_near_report){ .angle_min = least };
  for (size_t k = 0; k < N_BIN; k++) out->n_cell += bin[k];
  while (at + 1 < N_BIN && 100 * seen < out->n_cell) seen += bin[++at];
  out->angle_min_p1 = out->n_cell ? (double)at / PER_DEGREE : least;
}

vg_status vg_partition_near(const struct vg_partition *p, struct vg_comm *comm,
                            struct vg_near_report *out, struct vg_error *err)
{
  assert(out);

  int threads = p->options.threads;
  struct census c = { .p = p };
  double least = -180;
  vg_status st = VG_OK;

  c.count = vg_calloc((size_t)threads * N_BIN, sizeof *c.count);
  c.least = vg_alloc((size_t)threads, sizeof *c.least);
  for (int t = 0; c.least && t < threads; t++) c.least[t] = 180;
  if (c.count && c.least)
    vg_parallel_for(threads, p->n_piece, 1, count_pieces, &c);
  if (!c.count || !c.least || c.failed)
    st = vg_fail_memory(err, "the cells near interfaces");
  st = vg_comm_agree(comm, st, err);
  for (int t = 0; st == VG_OK && t < threads; t++) {
    for (size_t k = 0; t && k < N_BIN; k++)
      c.count[k] += c.count[(size_t)t * N_BIN + k];
    least = fmax(least, -c.least[t]);
  }
  if (st == VG_OK) st = vg_comm_sum(comm, N_BIN, c.count, err);
  if (st == VG_OK) st = vg_comm_max(comm, 1, &least, err);
  if (st == VG_OK) report(c.count, -least, out);
  free(c.count);
  free(c.least);
  return st;
}
