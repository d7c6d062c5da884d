/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Decomposition of a void by a maker: its subdomains become children, like
 * those of a cut. Interface points are on two or more subdomains. A subdomain
 * that is filled without a cut owns them: its leaf adopts them, as the leaves
 * of larger voids do (recut_ids.c), on whatever rank it is filled. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "partition/cut/node.h"

/* --- made, or read from the store ---------------------------------------- */

/* The load follows from the front and the sizes, which are part of the job's
 * digest, as are the options. */
static struct vg_digest key_of(const struct vg_partition *p,
                               const struct vg_front *f)
{
  struct vg_digest d = p->options.job;

  d = vg_digest_of(d, 4, "part");
  d = vg_digest_of(d, f->n_point * sizeof *f->x, f->x);
  return vg_digest_of(d, f->n_face * sizeof *f->face, f->face);
}

static int find(struct vg_partition *p, struct vg_digest key, uint32_t serial,
                struct vg_decomposition *out)
{
  struct vg_bytes b = { 0, NULL };
  struct vg_reader r;

  if (vg_store_find(p->options.store, key, &b, NULL) != VG_OK) return 0;
  r = (struct vg_reader){ .data = b.data, .n = b.n };
  vg_decomposition_get(&r, serial, out);
  free(b.data);
  return !r.bad;
}

static void keep(struct vg_partition *p, struct vg_digest key, uint32_t serial,
                 struct vg_decomposition *made)
{
  struct vg_writer w = { .cap = 0 };

  vg_decomposition_put(&w, made, serial);
  if (!w.refused) vg_store_keep(p->options.store, key, w.bytes.n, w.bytes.data);
  free(w.bytes.data);
}

/* The requested number of subdomains, or else the number of leaves that the
 * void needs. */
struct vg_decomposition_options vg_node_decomposition(
  const struct vg_partition *p, const struct vg_node *n)
{
  struct vg_decomposition_options o = p->options.decomposition;

  o.cells_per_cube = n->per_cube;
  if (!o.n_part)
    o.n_part = vg_decomposition_parts(n->load.cells,
                                      p->options.rule.leaf_cells);
  return o;
}

static vg_status find_or_make(struct vg_partition *p, struct vg_node *n,
                              uint32_t serial, const struct vg_engine *e,
                              struct vg_decomposition *out,
                              struct vg_error *err)
{
  struct vg_decomposition_options o = vg_node_decomposition(p, n);
  struct vg_digest key = { { 0, 0 } };
  int is_found = 0;
  vg_status st = VG_OK;

  if (p->options.store) {
    key = key_of(p, &n->front);
    is_found = find(p, key, serial, out);
  }
  if (!is_found)
    st = p->options.maker(&n->front, &n->load, p->sizing, &o, serial, e, out,
                          err);
  if (st == VG_OK) st = vg_decomposition_check(out, &n->front, serial, err);
  if (st == VG_OK && p->options.store && !is_found) keep(p, key, serial, out);
  pthread_mutex_lock(&p->lock);
  p->report.n_found += (uint64_t)is_found;
  if (st == VG_OK) {
    p->report.decomposition = out->report;
    p->report.n_part = out->n_part;
  }
  pthread_mutex_unlock(&p->lock);
  n->other_seconds = is_found ? 0 : out->report.other_seconds;
  return st;
}

/* --- owners of points ---------------------------------------------------- */

enum { NOBODY = UINT32_MAX };

struct shares {
  struct vg_decomposition *decomposition;
  uint32_t serial;  /* Serial of the decomposition's points. */
  uint32_t *owner;  /* [n_point] Subdomain that owns each point. */
  uint32_t *number; /* [n_point] Index among its owner's points. */
  uint32_t *of;     /* [n_part] Serials of the subdomains' leaves; 0: it may
                       be cut, and owns no points. */
};

/* Gives each unowned point to the first subdomain with it, among those that
 * are filled or those that may be cut. */
static void claim(struct shares *s, int may_cut)
{
  for (size_t k = 0; k < s->decomposition->n_part; k++) {
    const struct vg_part *q = &s->decomposition->part[k];

    if (!q->may_cut != !may_cut) continue;
    for (size_t v = 0; v < q->front.n_point; v++) {
      uint64_t id = q->front.id[v];

      if (id >> 32 == s->serial && s->owner[(uint32_t)id] == NOBODY)
        s->owner[(uint32_t)id] = (uint32_t)k;
    }
  }
}

static vg_status share_points(struct shares *s, struct vg_partition *p,
                              struct vg_error *err)
{
  struct vg_decomposition *q = s->decomposition;
  uint32_t *n = vg_calloc(q->n_part, sizeof *n);

  s->owner = vg_alloc(q->n_point, sizeof *s->owner);
  s->number = vg_alloc(q->n_point, sizeof *s->number);
  s->of = vg_calloc(q->n_part, sizeof *s->of);
  if (!n || !s->owner || !s->number || !s->of) {
    free(n);
    return vg_fail_memory(err, "the subdomains of a void");
  }
  memset(s->owner, 0xff, q->n_point * sizeof *s->owner);
  claim(s, 0);
  claim(s, 1);
  for (size_t v = 0; v < q->n_point; v++) {
    if (s->owner[v] == NOBODY) continue;
    s->number[v] = n[s->owner[v]]++;
    q->part[s->owner[v]].may_cut = 0;
  }
  for (size_t k = 0; k < q->n_part; k++)
    if (!q->part[k].may_cut) s->of[k] = vg_partition_serial(p);
  free(n);
  return VG_OK;
}

/* Moves the subdomain's own points behind the others, by their numbers, and
 * gives all interface points the global ids of their owners. */
static vg_status rename_front(const struct shares *s, size_t part,
                              struct vg_error *err)
{
  struct vg_front *f = &s->decomposition->part[part].front;
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  double(*x)[3] = vg_alloc(f->n_point, sizeof *x);
  uint64_t *id = vg_alloc(f->n_point, sizeof *id);
  size_t n = f->n_point;

  if (!to || !x || !id) {
    free(to);
    free(x);
    free(id);
    return vg_fail_memory(err, "the subdomains of a void");
  }
  for (size_t v = 0; v < f->n_point; v++)
    n -= f->id[v] >> 32 == s->serial && s->owner[(uint32_t)f->id[v]] == part;
  for (size_t v = 0, other = 0; v < f->n_point; v++) {
    uint32_t q = (uint32_t)f->id[v], owner = NOBODY;
    size_t at;

    if (f->id[v] >> 32 == s->serial) owner = s->owner[q];
    at = owner == part ? n + s->number[q] : other++;
    to[v] = (uint32_t)at;
    memcpy(x[at], f->x[v], sizeof *x);
    id[at] = owner == NOBODY ? f->id[v]
                             : VG_POINT_ID(s->of[owner], s->number[q]);
  }
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[f->face[i][k]];
  free(f->x);
  free(f->id);
  free(to);
  f->x = x;
  f->id = id;
  return VG_OK;
}

/* --- children ------------------------------------------------------------ */

static vg_status make_child(const struct shares *s, struct vg_node *n, size_t k,
                            struct vg_error *err)
{
  struct vg_part *q = &s->decomposition->part[k];
  char path[VG_PATH_MAX];
  struct vg_node *c;
  vg_status st = vg_select_sort(&q->front, err);

  if (st == VG_OK) st = rename_front(s, k, err);
  if (st < 0) return st;
  snprintf(path, sizeof path, "%.*s.%zu", VG_PATH_MAX - 24, n->path, k);
  c = vg_node_new(path, &q->front);
  if (!c) return vg_fail_memory(err, "the subdomains of a void");
  c->per_cube = n->per_cube;
  c->levels = n->levels;
  c->serial = s->of[k];
  c->is_final = !q->may_cut;
  n->child[n->n_child++] = c;
  return VG_OK;
}

vg_status vg_node_part(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err)
{
  struct vg_decomposition decomposition = VG_DECOMPOSITION_INIT;
  struct shares s = { &decomposition, vg_partition_serial(p), NULL, NULL,
                      NULL };
  vg_status st;

  assert(n->to_part && p->options.maker && !n->n_child);
  st = find_or_make(p, n, s.serial, e, &decomposition, err);
  if (st != VG_OK) goto done; /* or stopped */
  if (!decomposition.n_part) {
    st = vg_fail(err, VG_ERR_GEOMETRY,
                 "the decomposition of a void gave no subdomains");
    goto done;
  }
  VG_TRY(share_points(&s, p, err));
  n->child = vg_calloc(decomposition.n_part, sizeof *n->child);
  if (!n->child) st = vg_fail_memory(err, "the subdomains of a void");
  for (size_t k = 0; st == VG_OK && k < decomposition.n_part; k++)
    st = make_child(&s, n, k, err);
  if (st == VG_OK) st = vg_node_share_load(n, 1, e, err);
  if (st == VG_OK) vg_node_plan_children(p, n, e);
done:
  vg_decomposition_release(&decomposition);
  free(s.owner);
  free(s.number);
  free(s.of);
  return st;
}
