/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Partitions of a mesh in slices.
 *
 * Every rank finds the stacks and clusters in its slices, one slice at a time,
 * and the pairs of them that share a face. Faces on the rims of slices are
 * matched in a rendezvous. Units are numbered slice by slice along the mesh.
 * The graph, which rank 0 collects, is therefore independent of which rank
 * serves which slice. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/rendezvous.h"
#include "partition/solver/solver_parts.h"

struct unit_sum {
  double weight;
  uint64_t cells;
};

/* A slice that this rank serves. */
struct at {
  uint64_t place; /* Cells of all kinds before it; slices follow each other
                     in every kind. */
  size_t n_cell[VG_SLICE_KINDS], n_unit;
  uint64_t first;            /* Number of its first unit. */
  uint32_t *of;              /* [cells] Unit, later partition. */
  struct unit_sum *sum;      /* [n_unit] */
  struct vg_unit_pair *pair; /* [n_pair] Pairs of its own units, numbered
                                from 0. */
  size_t n_pair;
  struct vg_items rim; /* Items of struct rim_face. */
  uint64_t n_stack, n_stack_cell, most_stack;
};

struct rim_face {
  uint32_t node[4], unit;
};

struct vg_solver_slices {
  const struct vg_slices *s;
  size_t n;
  struct at *at; /* [n] */
};

struct sliced {
  struct vg_comm *comm;
  const struct vg_solver_options *o;
  struct vg_solver_slices *k;
  int threads;
  size_t cluster;
  uint64_t n_unit;         /* Units of all ranks. */
  struct vg_items *across; /* [threads] struct vg_unit_pair with global
                              numbers. */
  int refused;             /* 1: memory was refused in a rendezvous. */
};

static size_t cells_of(const struct at *a)
{
  size_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += a->n_cell[k];
  return n;
}

static void release_lists(struct at *a)
{
  free(a->sum);
  free(a->pair);
  vg_items_release(&a->rim);
  a->sum = NULL;
  a->pair = NULL;
}

void vg_solver_slices_close(struct vg_solver_slices *k)
{
  for (size_t i = 0; k && k->at && i < k->n; i++) {
    release_lists(&k->at[i]);
    free(k->at[i].of);
  }
  if (k) free(k->at);
  free(k);
}

/* --- a slice ------------------------------------------------------------- */

/* The arrays of a mesh are not const, but nothing writes to them. */
static struct vg_mesh view_of(const struct vg_slice *s)
{
  struct vg_mesh m = { .n_point = s->n_point,
                       .n_tet = s->n_cell[VG_SLICE_TET],
                       .n_pyr = s->n_cell[VG_SLICE_PYR],
                       .n_pri = s->n_cell[VG_SLICE_PRI],
                       .n_hex = s->n_cell[VG_SLICE_HEX] };

  memcpy(&m.point, &s->x, sizeof m.point);
  memcpy(&m.tet, &s->cell[VG_SLICE_TET], sizeof m.tet);
  memcpy(&m.pyr, &s->cell[VG_SLICE_PYR], sizeof m.pyr);
  memcpy(&m.pri, &s->cell[VG_SLICE_PRI], sizeof m.pri);
  memcpy(&m.hex, &s->cell[VG_SLICE_HEX], sizeof m.hex);
  return m;
}

static vg_status keep_pairs(struct at *a, const struct vg_unit_graph *g,
                            struct vg_error *err)
{
  a->pair = vg_alloc(g->begin[g->n] / 2, sizeof *a->pair);
  if (!a->pair) return vg_fail_memory(err, "the graph of a slice");
  for (uint32_t k = 0; k < g->n; k++)
    for (uint64_t i = g->begin[k]; i < g->begin[k + 1]; i++)
      if (g->to[i] > k)
        a->pair[a->n_pair++] = (struct vg_unit_pair){ k, g->to[i],
                                                      (uint32_t)g->faces[i] };
  return VG_OK;
}

static vg_status keep_rim(struct at *a, const struct vg_slice *s,
                          const struct vg_cell_links *l,
                          const struct vg_units *u, struct vg_error *err)
{
  for (uint32_t cell = 0; cell < l->n_cell; cell++)
    for (int i = 0; i < vg_half_faces(l, cell); i++) {
      struct rim_face *f;
      uint32_t node[4];
      int n;

      if (vg_mate(l, cell << 3 | (uint32_t)i) != VG_NO_CELL) continue;
      f = vg_items_add(&a->rim, sizeof *f);
      if (!f) return vg_fail_memory(err, "the rim of a slice");
      n = vg_half_face_nodes(l, cell << 3 | (uint32_t)i, node);
      f->node[3] = UINT32_MAX;
      f->unit = u->of[cell];
      for (int k = 0; k < n; k++) { /* in ascending order */
        uint32_t v = s->id[node[k]];
        int c = k;

        for (; c && f->node[c - 1] > v; c--) f->node[c] = f->node[c - 1];
        f->node[c] = v;
      }
    }
  return VG_OK;
}

static vg_status keep_sums(struct at *a, struct vg_units *u,
                           struct vg_error *err)
{
  size_t n = cells_of(a);

  a->sum = vg_calloc(u->n_unit, sizeof *a->sum);
  if (!a->sum) return vg_fail_memory(err, "the weights of a slice");
  for (size_t k = 0; k < u->n_unit; k++) a->sum[k].weight = u->weight[k];
  for (size_t c = 0; c < n; c++) a->sum[u->of[c]].cells++;
  a->n_unit = u->n_unit;
  a->n_stack = u->n_stack;
  a->n_stack_cell = u->n_stack_cell;
  a->most_stack = u->most_stack;
  a->of = u->of;
  u->of = NULL;
  return VG_OK;
}

/* Number of a slice's first cells of each kind that are layer cells. */
static struct vg_unit_options unit_options(const struct sliced *w,
                                           const struct vg_slice *s)
{
  struct vg_unit_options u = {
    .is_known = 1, .is_ours = 1, .cluster = w->cluster, .weight = w->o->weight
  };

  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    uint64_t end = w->k->s->n_layer_cell[k];

    end = end > s->cell_at[k] ? end - s->cell_at[k] : 0;
    u.n_layer[k] = end < s->n_cell[k] ? end : s->n_cell[k];
  }
  return u;
}

static vg_status inspect_slice(const struct sliced *w, const struct vg_slice *s,
                               struct at *a, struct vg_error *err)
{
  struct vg_unit_options o = unit_options(w, s);
  struct vg_mesh m = view_of(s);
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  struct vg_units u = VG_UNITS_INIT;
  struct vg_unit_graph g = { 0 };
  vg_status st;

  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    a->place += s->cell_at[k];
    a->n_cell[k] = s->n_cell[k];
  }
  VG_TRY(vg_cell_links_build(&l, &m, 1, "a slice", err));
  VG_TRY(vg_units_make(&l, &o, &u, err));
  VG_TRY(vg_unit_graph_of_links(&l, &u, &g, err));
  VG_TRY(keep_pairs(a, &g, err));
  VG_TRY(keep_rim(a, s, &l, &u, err));
  st = keep_sums(a, &u, err);
done:
  vg_unit_graph_release(&g);
  vg_units_release(&u);
  vg_cell_links_release(&l);
  return st;
}

struct looking {
  const struct sliced *w;
  vg_status *st;
  struct vg_error *err;
};

static void inspect_range(void *context, size_t first, size_t end, int worker)
{
  struct looking *c = context;
  const struct sliced *w = c->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_slice s;

    c->st[i] = w->k->s->get(w->k->s, i, &s, &c->err[i]);
    if (c->st[i] < 0) continue;
    c->st[i] = inspect_slice(w, &s, &w->k->at[i], &c->err[i]);
    w->k->s->put(w->k->s, &s);
  }
}

static vg_status inspect_all(struct sliced *w, struct vg_error *err)
{
  size_t n = w->k->n;
  struct looking c = { w, vg_calloc(n, sizeof *c.st),
                       vg_calloc(n, sizeof *c.err) };
  vg_status st = VG_OK;

  if (!c.st || !c.err) {
    st = vg_fail_memory(err, "the slices of the mesh");
  } else {
    vg_parallel_for(w->threads, n, 1, inspect_range, &c);
    for (size_t i = 0; i < n && st >= 0; i++)
      if ((st = c.st[i]) < 0 && err) *err = c.err[i];
  }
  free(c.st);
  free(c.err);
  return vg_comm_agree(w->comm, st, err);
}

/* --- numbers ------------------------------------------------------------- */

struct counted {
  uint64_t place, n_unit;
};

static int by_place(const void *a, const void *b)
{
  uint64_t x = ((const struct counted *)a)->place;
  uint64_t y = ((const struct counted *)b)->place;

  return (x > y) - (x < y);
}

/* The slices of all ranks in order; n_unit becomes the number of the first
 * unit. */
static vg_status order_slices(struct sliced *w, const struct vg_bytes *all,
                              struct counted **out, size_t *n_out,
                              struct vg_error *err)
{
  struct vg_writer list = { .cap = 0 };
  struct counted *c;
  uint64_t sum = 0;
  size_t n;

  for (int r = 0; r < vg_comm_size(w->comm); r++)
    vg_put(&list, all[r].n, 1, all[r].data);
  if (list.refused) {
    free(list.bytes.data);
    return vg_fail_memory(err, "the slices of the mesh");
  }
  c = (void *)list.bytes.data;
  n = list.bytes.n / sizeof *c;
  if (n) qsort(c, n, sizeof *c, by_place);
  for (size_t i = 0; i < n; i++) {
    uint64_t here = c[i].n_unit;

    c[i].n_unit = sum;
    sum += here;
  }
  w->n_unit = sum;
  *out = c;
  *n_out = n;
  if (sum < UINT32_MAX) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "solver partitions: %llu stacks "
                 "and cells exceed the range of 32-bit numbers",
                 (unsigned long long)sum);
}

static vg_status number(struct sliced *w, struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(w->comm), n = 0;
  struct vg_bytes *all = vg_calloc(size, sizeof *all);
  struct vg_writer mine = { .cap = 0 };
  struct counted *list = NULL;
  vg_status st;

  for (size_t i = 0; i < w->k->n; i++) {
    const struct counted c = { w->k->at[i].place, w->k->at[i].n_unit };

    if (c.n_unit) vg_put(&mine, 1, sizeof c, &c);
  }
  st = mine.refused || !all ? vg_fail_memory(err, "the slices of the mesh")
                            : VG_OK;
  st = vg_comm_agree(w->comm, st, err);
  if (st >= 0) st = vg_comm_allgather(w->comm, &mine.bytes, all, err);
  if (st >= 0) st = order_slices(w, all, &list, &n, err);
  for (size_t i = 0; i < w->k->n && st >= 0; i++) {
    struct at *a = &w->k->at[i];
    const struct counted key = { a->place, 0 }, *c = NULL;

    if (a->n_unit) c = bsearch(&key, list, n, sizeof key, by_place);
    if (c) a->first = c->n_unit;
  }
  free(list);
  free(mine.bytes.data);
  vg_bytes_release(all, all ? size : 0);
  return vg_comm_agree(w->comm, st, err);
}

/* --- pairs across slices ------------------------------------------------- */

static void meet(void *context, const unsigned char *item, size_t n, int worker)
{
  struct sliced *w = context;
  struct vg_unit_pair *p;
  uint32_t unit[2];

  if (n != 2) return; /* on the boundary */
  for (size_t k = 0; k < 2; k++)
    memcpy(&unit[k],
           item + k * sizeof(struct rim_face) + offsetof(struct rim_face, unit),
           sizeof *unit);
  p = vg_items_add(&w->across[worker], sizeof *p);
  if (!p) __atomic_store_n(&w->refused, 1, __ATOMIC_RELAXED);
  else if (unit[0] < unit[1]) *p = (struct vg_unit_pair){ unit[0], unit[1], 1 };
  else *p = (struct vg_unit_pair){ unit[1], unit[0], 1 };
}

static vg_status match_rims(struct sliced *w, struct vg_error *err)
{
  const struct vg_rendezvous m = { .comm = w->comm,
                                   .threads = w->threads,
                                   .size = sizeof(struct rim_face),
                                   .key = sizeof((struct rim_face *)0)->node,
                                   .group = meet,
                                   .context = w };
  struct vg_items none = { 0, 0, NULL };
  vg_status st;

  for (size_t i = 0; i < w->k->n; i++) {
    struct at *a = &w->k->at[i];
    struct rim_face *f = (void *)a->rim.data;

    for (size_t k = 0; k < a->rim.n; k++) f[k].unit += (uint32_t)a->first;
  }
  st = vg_rendezvous_run(&m, w->k->n ? &w->k->at[0].rim : &none,
                         w->k->n ? w->k->n : 1, sizeof *w->k->at, err);
  if (st >= 0 && w->refused) st = vg_fail_memory(err, "the rims of slices");
  return vg_comm_agree(w->comm, st, err);
}

/* --- the graph on rank 0 ------------------------------------------------- */

/* Packs pairs and weights of units, each slice preceded by its counts. */
static void pack(const struct sliced *w, struct vg_writer *to)
{
  for (size_t i = 0; i < w->k->n; i++) {
    struct at *a = &w->k->at[i];
    uint64_t head[3] = { a->first, a->n_unit, a->n_pair };

    for (size_t k = 0; k < a->n_pair; k++) {
      a->pair[k].a += (uint32_t)a->first;
      a->pair[k].b += (uint32_t)a->first;
    }
    vg_put(to, 3, sizeof *head, head);
    vg_put(to, a->n_unit, sizeof *a->sum, a->sum);
    vg_put(to, a->n_pair, sizeof *a->pair, a->pair);
    release_lists(a);
  }
  for (int k = 0; k < w->threads; k++) {
    uint64_t head[3] = { 0, 0, w->across[k].n };

    vg_put(to, 3, sizeof *head, head);
    vg_put(to, w->across[k].n, sizeof(struct vg_unit_pair), w->across[k].data);
    vg_items_release(&w->across[k]);
  }
}

struct collected {
  struct unit_sum *sum;
  struct vg_unit_pair *pair;
  size_t n_pair, room;
};

static vg_status unpack(struct vg_bytes *from, uint64_t n_unit,
                        struct collected *c, struct vg_error *err)
{
  struct vg_reader r = { .data = from->data, .n = from->n };

  while (r.at < r.n && !r.bad) {
    uint64_t head[3] = { 0, 0, 0 };

    vg_get(&r, 3, sizeof *head, head);
    if (head[0] > n_unit || head[1] > n_unit - head[0]) break;
    vg_get(&r, head[1], sizeof *c->sum, c->sum + head[0]);
    if (vg_reserve(&c->pair, &c->room, c->n_pair + head[2], sizeof *c->pair))
      return vg_fail_memory(err, "the graph of a mesh");
    vg_get(&r, head[2], sizeof *c->pair, c->pair + c->n_pair);
    c->n_pair += head[2];
  }
  if (r.bad || r.at != r.n) return vg_fail_damaged(err, "a graph");
  free(from->data);
  *from = (struct vg_bytes){ 0, NULL };
  return VG_OK;
}

static vg_status collect(struct sliced *w, struct collected *c,
                         struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(w->comm);
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  struct vg_writer mine = { .cap = 0 };
  int leads = !vg_comm_rank(w->comm);
  vg_status st = VG_OK;

  pack(w, &mine);
  if (leads) c->sum = vg_calloc(w->n_unit, sizeof *c->sum);
  if (mine.refused || !to || !from || (leads && !c->sum))
    st = vg_fail_memory(err, "the graph of a mesh");
  st = vg_comm_agree(w->comm, st, err);
  if (st >= 0) {
    to[0] = mine.bytes;
    st = vg_comm_exchange(w->comm, to, from, err);
  }
  free(mine.bytes.data);
  for (size_t r = 0; r < size && leads && st >= 0; r++)
    st = unpack(&from[r], w->n_unit, c, err);
  vg_bytes_release(from, from ? size : 0);
  free(to);
  return vg_comm_agree(w->comm, st, err);
}

/* --- partitions ---------------------------------------------------------- */

static vg_status tally(const struct vg_unit_graph *g,
                       const struct unit_sum *sum, const uint32_t *part,
                       uint64_t n_part, struct vg_solver_report *r,
                       struct vg_error *err)
{
  struct vg_tally *t = vg_tally_new(n_part);
  int bad = !t;

  for (uint32_t k = 0; k < g->n && !bad; k++) {
    vg_tally_cells(t, part[k], sum[k].cells, sum[k].weight);
    for (uint64_t i = g->begin[k]; i < g->begin[k + 1] && !bad; i++)
      if (g->to[i] > k)
        bad = vg_tally_faces(t, part[k], part[g->to[i]], (uint64_t)g->faces[i]);
  }
  if (!bad) vg_tally_report(t, r);
  vg_tally_free(t);
  return bad ? vg_fail_memory(err, "counting the faces of partitions") : VG_OK;
}

/* Partitions the units, on rank 0. */
static vg_status part_units(const struct sliced *w, struct collected *c,
                            uint32_t *part, struct vg_solver_report *r,
                            struct vg_error *err)
{
  struct vg_unit_graph g = { 0 };
  double *weight = vg_alloc(w->n_unit, sizeof *weight);
  vg_status st = weight ? VG_OK : vg_fail_memory(err, "the graph of a mesh");

  for (size_t k = 0; k < w->n_unit && st >= 0; k++)
    weight[k] = c->sum[k].weight;
  if (st >= 0)
    st = vg_unit_graph_of_pairs(w->n_unit, c->pair, c->n_pair, &g, err);
  free(c->pair);
  c->pair = NULL;
  r->time_graph = vg_clock() - r->time_graph;
  if (st >= 0) st = vg_unit_graph_part(&g, weight, w->o->n_part, part, r, err);
  if (st >= 0) st = tally(&g, c->sum, part, w->o->n_part, r, err);
  vg_unit_graph_release(&g);
  free(weight);
  return st;
}

static void take_parts(struct sliced *w, const uint32_t *part)
{
  for (size_t i = 0; i < w->k->n; i++) {
    struct at *a = &w->k->at[i];
    size_t n = cells_of(a);

    for (size_t c = 0; c < n; c++) a->of[c] = part[a->first + a->of[c]];
  }
}

static vg_status share_parts(struct sliced *w, struct collected *c,
                             struct vg_solver_report *r, struct vg_error *err)
{
  struct vg_bytes parts = { 0, NULL }, told = { 0, NULL };
  vg_status st = VG_OK;

  if (!vg_comm_rank(w->comm)) {
    parts.n = w->n_unit * sizeof(uint32_t);
    parts.data = vg_alloc(w->n_unit, sizeof(uint32_t));
    told.data = vg_alloc(1, sizeof *r);
    if (!parts.data || !told.data)
      st = vg_fail_memory(err, "the solver partitions");
    else st = part_units(w, c, (uint32_t *)(void *)parts.data, r, err);
    told.n = sizeof *r;
    if (told.data) memcpy(told.data, r, sizeof *r);
  }
  st = vg_comm_agree(w->comm, st, err);
  if (st >= 0) st = vg_comm_bcast(w->comm, 0, &parts, err);
  if (st >= 0) st = vg_comm_bcast(w->comm, 0, &told, err);
  if (st >= 0) {
    memcpy(r, told.data, sizeof *r);
    take_parts(w, (const uint32_t *)(const void *)parts.data);
  }
  free(parts.data);
  free(told.data);
  return st;
}

static vg_status sum_stacks(const struct sliced *w, struct vg_solver_report *r,
                            struct vg_error *err)
{
  uint64_t v[2] = { 0, 0 };
  double most = 0;
  vg_status st;

  for (size_t i = 0; i < w->k->n; i++) {
    const struct at *a = &w->k->at[i];

    v[0] += a->n_stack;
    v[1] += a->n_stack_cell;
    if ((double)a->most_stack > most) most = (double)a->most_stack;
  }
  st = vg_comm_sum(w->comm, 2, v, err);
  if (st >= 0) st = vg_comm_max(w->comm, 1, &most, err);
  r->n_stack = v[0];
  r->n_stack_cell = v[1];
  r->most_stack = (uint64_t)most;
  return st;
}

/* --- slices with partitions ---------------------------------------------- */

static vg_status get_slice(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  const struct vg_solver_slices *k = s->user;
  const struct at *a = &k->at[i];
  const uint32_t *part = a->of;
  vg_status st = k->s->get(k->s, i, out, err);

  for (int c = 0; c < VG_SLICE_KINDS && st >= 0; c++) {
    out->part[c] = part;
    part += a->n_cell[c];
  }
  return st;
}

static void put_slice(const struct vg_slices *s, struct vg_slice *slice)
{
  const struct vg_solver_slices *k = s->user;

  k->s->put(k->s, slice);
}

static struct vg_solver_slices *new_slices(const struct vg_slices *s)
{
  struct vg_solver_slices *k = vg_calloc(1, sizeof *k);

  if (!k) return NULL;
  k->s = s;
  k->n = s->n_slice;
  k->at = vg_calloc(k->n, sizeof *k->at);
  if (k->at) return k;
  free(k);
  return NULL;
}

static size_t cluster_of(const struct vg_slices *s,
                         const struct vg_solver_options *o)
{
  uint64_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++)
    n += s->n_cell[k] - s->n_layer_cell[k];
  return vg_unit_cluster(o, n);
}

vg_status vg_solver_part_slices(struct vg_comm *comm, const struct vg_slices *s,
                                const struct vg_solver_options *o,
                                struct vg_slices *out,
                                struct vg_solver_slices **keep,
                                struct vg_solver_report *report,
                                struct vg_error *err)
{
  assert(o && out && keep && report);

  struct vg_solver_report r = { .time_graph = vg_clock() };
  struct sliced w = { .comm = comm,
                      .o = o,
                      .k = new_slices(s),
                      .threads = o->threads > 0 ? o->threads : vg_cores(),
                      .cluster = cluster_of(s, o) };
  struct collected c = { NULL, NULL, 0, 0 };
  vg_status st;

  w.across = vg_calloc((size_t)w.threads, sizeof *w.across);
  st = w.k && w.across ? VG_OK : vg_fail_memory(err, "the solver partitions");
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(inspect_all(&w, err));
  VG_TRY(number(&w, err));
  VG_TRY(match_rims(&w, err));
  VG_TRY(collect(&w, &c, err));
  VG_TRY(share_parts(&w, &c, &r, err));
  VG_TRY(sum_stacks(&w, &r, err));
  *out = *s;
  out->n_part = (uint32_t)o->n_part;
  out->get = get_slice;
  out->put = put_slice;
  out->user = w.k;
  *keep = w.k;
  *report = r;
  w.k = NULL;
done:
  for (int k = 0; w.across && k < w.threads; k++)
    vg_items_release(&w.across[k]);
  free(w.across);
  free(c.sum);
  free(c.pair);
  vg_solver_slices_close(w.k);
  return st;
}
