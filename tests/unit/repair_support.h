/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A box of cells cut into slabs, which are the pieces of a partition as tasks
 * leave them. Slab g belongs to rank g % size. Header only. */
#ifndef TESTS_UNIT_REPAIR_SUPPORT_H
#define TESTS_UNIT_REPAIR_SUPPORT_H

#include <stdio.h>
#include <string.h>

#include "core/geometry/shape.h"
#include "partition/repair/repair.h"
#include "partition/store/store.h"
#include "tets_support.h"

enum { SLABS = 4 };

struct scene {
  int n[3];
  struct vg_tets t; /* all cells, as before the repair */
  struct vg_sizing *sizing;
  struct vg_partition p;
};

static inline int on_hull(const struct scene *s, const double x[3])
{
  int on = 0;

  for (int k = 0; k < 3; k++) on |= x[k] == 0 || x[k] == s->n[k];
  return on;
}

static inline double cell_shape(const struct vg_tets *t, size_t c)
{
  const uint32_t *v = t->cell[c].v;

  return vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
}

static inline void scene_sizes(struct scene *s, double stretch)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_source box = { .kind = VG_SOURCE_BOX,
                           .h0 = 1,
                           .p1 = { s->n[0], s->n[1], s->n[2] },
                           .stretch = stretch,
                           .u = { 0, 1, 0 } };

  vg_sizing_free(s->sizing);
  s->sizing = NULL;
  if (vg_sizing_new(&o, 1, &box, NULL, &s->sizing, NULL) != VG_OK) abort();
}

/* nx x ny x nz unit cubes; spacing 1 everywhere. */
static inline void scene_new(struct scene *s, int nx, int ny, int nz)
{
  memset(s, 0, sizeof *s);
  s->n[0] = nx;
  s->n[1] = ny;
  s->n[2] = nz;
  tets_grid(&s->t, s->n);
  scene_sizes(s, 1);
}

/* Stretch the cells and their sizes along y, which leaves all shapes in the
 * metric of the sizes as they are. Before scene_cut. */
static inline void scene_stretch(struct scene *s, int by)
{
  for (uint32_t p = 0; p < s->t.n_point; p++) s->t.x[p][1] *= by;
  s->n[1] *= by;
  scene_sizes(s, by);
}

/* Move a point, unless a cell around it would fall below quality `least`. */
static inline int scene_move(struct scene *s, uint32_t p, const double by[3],
                             double least)
{
  double old[3];

  memcpy(old, s->t.x[p], sizeof old);
  for (int k = 0; k < 3; k++) s->t.x[p][k] += by[k];
  for (size_t c = 0; c < s->t.n_cell; c++) {
    const uint32_t *v = s->t.cell[c].v;

    if (v[0] != p && v[1] != p && v[2] != p && v[3] != p) continue;
    if (cell_shape(&s->t, c) > least) continue;
    memcpy(s->t.x[p], old, sizeof old);
    return 0;
  }
  return 1;
}

static inline uint32_t scene_point(const struct scene *s, int i, int j, int k)
{
  return (uint32_t)(i + (s->n[0] + 1) * (j + (s->n[1] + 1) * k));
}

/* Move interior points at random, by at most `most`. */
static inline void scene_shake(struct scene *s, double most, uint64_t seed)
{
  for (uint32_t p = 0; p < s->t.n_point; p++) {
    double by[3];

    for (int k = 0; k < 3; k++) by[k] = most * (2 * tets_random(&seed) - 1);
    if (!on_hull(s, s->t.x[p])) scene_move(s, p, by, 1e-4);
  }
}

/* Slab of a cell: by its middle, in the regular box. */
static inline int slab_of_cell(const struct scene *s, size_t c)
{
  return (int)(c / 6) % s->n[0] * SLABS / s->n[0];
}

/* A point belongs to the first slab that uses it. */
static inline void own_points(const struct scene *s, int *owner,
                              uint32_t *place)
{
  uint32_t count[SLABS] = { 0 };

  for (size_t p = 0; p < s->t.n_point; p++) owner[p] = SLABS;
  for (size_t c = 0; c < s->t.n_cell; c++)
    for (int i = 0; i < 4; i++) {
      int *o = &owner[s->t.cell[c].v[i]], g = slab_of_cell(s, c);

      if (g < *o) *o = g;
    }
  for (size_t p = 0; p < s->t.n_point; p++) {
    if (on_hull(s, s->t.x[p])) owner[p] = -1;
    place[p] = owner[p] < 0 ? (uint32_t)p : count[owner[p]]++;
  }
}

static inline void fill_slab(const struct scene *s, int g, const int *owner,
                             const uint32_t *place, struct vg_piece *q)
{
  const struct vg_tets *t = &s->t;
  uint32_t *to = vg_alloc(t->n_point, sizeof *to);
  uint32_t(*cell)[4] = vg_alloc(t->n_cell, sizeof *cell);
  int pass;

  memset(q, 0, sizeof *q);
  q->in = vg_alloc(t->n_point, sizeof *q->in);
  q->x = vg_alloc(t->n_point, sizeof *q->x);
  if (!to || !q->in || !q->x || !cell) abort();
  memset(to, 0xff, t->n_point * sizeof *to);
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (slab_of_cell(s, c) == g) to[t->cell[c].v[i]] = 0;
  for (pass = 0; pass < 2; pass++)
    for (size_t p = 0; p < t->n_point; p++) {
      if (to[p] == VG_NONE || (owner[p] == g) != pass) continue;
      if (pass == 0) q->in[q->n_in] = VG_POINT_ID(owner[p] + 1, place[p]);
      to[p] = (uint32_t)(q->n_in + q->n_point);
      memcpy(q->x[to[p]], t->x[p], sizeof *q->x);
      if (pass) q->n_point++;
      else q->n_in++;
    }
  for (size_t c = 0; c < t->n_cell; c++) {
    if (slab_of_cell(s, c) != g) continue;
    for (int i = 0; i < 4; i++) cell[q->n_cell][i] = to[t->cell[c].v[i]];
    q->n_cell++;
  }
  if (vg_packed_cells_new(q->n_cell, (const uint32_t(*)[4])cell,
                          q->n_in + q->n_point, &q->cell))
    abort();
  free(to);
  free(cell);
}

/* The pieces of this rank. */
static inline void scene_cut(struct scene *s, struct vg_comm *comm, int threads)
{
  struct vg_partition *p = &s->p;
  int *owner = vg_alloc(s->t.n_point, sizeof *owner);
  uint32_t *place = vg_alloc(s->t.n_point, sizeof *place);

  if (!owner || !place) abort();
  p->rank = vg_comm_rank(comm);
  p->size = vg_comm_size(comm);
  p->sizing = s->sizing;
  p->options.threads = threads;
  pthread_mutex_init(&p->lock, NULL);
  own_points(s, owner, place);
  for (int g = p->rank; g < SLABS; g += p->size) {
    struct vg_piece q;

    fill_slab(s, g, owner, place, &q);
    q.kind = VG_SPAN_LEAF;
    q.serial = vg_partition_serial(p);
    snprintf(q.path, sizeof q.path, "0.%dL", g);
    if (q.serial != (uint32_t)g + 1 ||
        vg_reserve(&p->piece, &p->cap_piece, p->n_piece + 1, sizeof *p->piece))
      abort();
    p->piece[p->n_piece++] = q;
  }
  free(owner);
  free(place);
}

/* Treat the slabs as separator zones: their points on interfaces may move. */
static inline void scene_zones(struct scene *s)
{
  for (size_t k = 0; k < s->p.n_piece; k++) s->p.piece[k].kind = VG_SPAN_TILE;
}

static inline void scene_end(struct scene *s)
{
  for (size_t k = 0; k < s->p.n_piece; k++) vg_piece_release(&s->p.piece[k]);
  free(s->p.piece);
  pthread_mutex_destroy(&s->p.lock);
  vg_sizing_free(s->sizing);
  vg_tets_release(&s->t);
}

/* --- results ------------------------------------------------------------- */

struct print {
  char path[VG_PATH_MAX];
  struct vg_digest d;
};

static inline int by_print(const void *a, const void *b)
{
  return strcmp(((const struct print *)a)->path,
                ((const struct print *)b)->path);
}

/* Cells, points and their coordinates, by path; without the serials of ids. */
static inline struct print print_of(const struct vg_piece *q)
{
  struct print p = { .path = "" };
  uint64_t n[3] = { q->n_in, q->n_point, q->n_cell };

  memcpy(p.path, q->path, sizeof p.path);
  p.d = vg_digest_of(p.d, sizeof n, n);
  p.d = vg_digest_of(p.d, (q->n_in + q->n_point) * sizeof *q->x, q->x);
  for (size_t c = 0; c < q->n_cell; c++) {
    uint32_t v[4];

    vg_piece_cell(q, c, v);
    p.d = vg_digest_of(p.d, sizeof v, v);
  }
  for (size_t k = 0; k < q->n_in; k++) {
    uint32_t place = (uint32_t)q->in[k];

    p.d = vg_digest_of(p.d, sizeof place, &place);
  }
  return p;
}

/* Digest of all pieces of all ranks, equal for any number of ranks. */
static inline struct vg_digest scene_digest(const struct scene *s,
                                            struct vg_comm *comm)
{
  struct vg_digest d = { { 0, 0 } };
  struct vg_bytes all[64], mine = { 0, NULL };
  struct print *own = vg_alloc(s->p.n_piece, sizeof *own), *list;
  size_t n = 0, at = 0;

  if (!own || s->p.size > 64) abort();
  for (size_t k = 0; k < s->p.n_piece; k++) own[k] = print_of(&s->p.piece[k]);
  mine.n = s->p.n_piece * sizeof *own;
  mine.data = (unsigned char *)own;
  if (vg_comm_allgather(comm, &mine, all, NULL) != VG_OK) abort();
  for (int r = 0; r < s->p.size; r++) n += all[r].n;
  if (!(list = vg_alloc(n, 1))) abort();
  for (int r = 0; r < s->p.size; r++) {
    if (all[r].n) memcpy((char *)list + at, all[r].data, all[r].n);
    at += all[r].n;
    free(all[r].data);
  }
  n /= sizeof *list;
  qsort(list, n, sizeof *list, by_print);
  d = vg_digest_of(d, n * sizeof *list, list);
  free(list);
  free(own);
  return d;
}

#endif
