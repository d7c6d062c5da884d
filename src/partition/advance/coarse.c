/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/advance/coarse.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/clock.h"
#include "base/memory.h"
#include "partition/advance/advance.h"
#include "partition/discrete/discrete.h"

/* Cells per leaf of the coarse mesh: small leaves, several per worker, since
 * all ranks wait for this mesh. */
static const double leaf_cells = 20000; /* D10 */

/* --- transfer to rank 0 -------------------------------------------------- */

/* Header of one slice, followed by its points and cells. */
struct head {
  uint64_t point_at, n_point, cell_at, n_cell;
};

static vg_status pack_slice(const struct vg_slice *s, struct vg_writer *w,
                            struct vg_error *err)
{
  const struct head h = { s->point_at, s->n_own, s->cell_at[VG_SLICE_TET],
                          s->n_cell[VG_SLICE_TET] };
  uint32_t(*cell)[4] = vg_alloc(h.n_cell, sizeof *cell);

  if (!cell) return vg_fail_memory(err, "the coarse mesh");
  for (size_t k = 0; k < 4 * h.n_cell; k++)
    cell[k / 4][k % 4] = s->id[s->cell[VG_SLICE_TET][k]];
  vg_put(w, 1, sizeof h, &h);
  for (size_t k = 0; k < h.n_point; k++)
    vg_put(w, 1, sizeof *s->x, s->x[s->own[k]]);
  vg_put(w, h.n_cell, sizeof *cell, cell);
  free(cell);
  return w->refused ? vg_fail_memory(err, "the coarse mesh") : VG_OK;
}

static vg_status pack(const struct vg_slices *s, struct vg_bytes *out,
                      struct vg_error *err)
{
  struct vg_writer w = { .cap = 0 };
  vg_status st = VG_OK;

  for (size_t i = 0; st == VG_OK && i < s->n_slice; i++) {
    struct vg_slice slice;

    st = s->get(s, i, &slice, err);
    if (st < 0) break;
    st = pack_slice(&slice, &w, err);
    s->put(s, &slice);
  }
  if (st == VG_OK) *out = w.bytes;
  else free(w.bytes.data);
  return st;
}

/* Unpacks into the numbering of the mesh, which has the boundary's points
 * first. */
static vg_status unpack(const struct vg_bytes *b, struct vg_coarse_cells *c,
                        struct vg_error *err)
{
  struct vg_reader r = { .data = b->data, .n = b->n };
  struct head h = { 0, 0, 0, 0 };

  while (!r.bad && r.at < r.n) {
    vg_get(&r, 1, sizeof h, &h);
    if (r.bad || h.n_point > c->n_point || h.n_cell > c->n_cell ||
        h.point_at > c->n_point - h.n_point || h.cell_at > c->n_cell - h.n_cell)
      return vg_fail_damaged(err, "the coarse mesh");
    vg_get(&r, h.n_point, sizeof *c->x, c->x + h.point_at);
    vg_get(&r, h.n_cell, sizeof *c->cell, c->cell + h.cell_at);
  }
  return r.bad ? vg_fail_damaged(err, "the coarse mesh") : VG_OK;
}

static vg_status gather(const struct vg_partition *p, struct vg_comm *comm,
                        const struct vg_slices *s, struct vg_coarse_cells *c,
                        struct vg_error *err)
{
  size_t n = (size_t)p->size;
  struct vg_bytes *to = vg_calloc(n, sizeof *to);
  struct vg_bytes *from = vg_calloc(n, sizeof *from);
  vg_status st = to && from ? pack(s, to, err)
                            : vg_fail_memory(err, "the coarse mesh");

  if (st == VG_OK && p->rank == 0) {
    c->x = vg_alloc(s->n_point, sizeof *c->x);
    c->cell = vg_alloc(s->n_cell[VG_SLICE_TET], sizeof *c->cell);
    if (!c->x || !c->cell) st = vg_fail_memory(err, "the coarse mesh");
    c->n_point = s->n_point;
    c->n_cell = s->n_cell[VG_SLICE_TET];
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_exchange(comm, to, from, err));
  for (size_t k = 0; st == VG_OK && p->rank == 0 && k < n; k++)
    st = unpack(&from[k], c, err);
  st = vg_comm_agree(comm, st, err);
done:
  vg_bytes_release(to, n);
  vg_bytes_release(from, n);
  return st;
}

/* The front has the boundary's points in its own order, which its global ids
 * give. */
static vg_status renumber(const struct vg_doubled *d, const struct vg_front *f,
                          size_t n_boundary, struct vg_coarse_cells *c,
                          struct vg_error *err)
{
  uint32_t *to = vg_alloc(n_boundary, sizeof *to);
  size_t n = f->n_point + c->n_point - n_boundary;
  double(*x)[3] = vg_alloc(n, sizeof *x);

  if (!to || !x) {
    free(to);
    free(x);
    return vg_fail_memory(err, "the coarse mesh");
  }
  for (size_t k = 0; k < f->n_point; k++) to[(uint32_t)f->id[k]] = (uint32_t)k;
  memcpy(x, f->x, f->n_point * sizeof *x);
  memcpy(x + f->n_point, c->x + n_boundary,
         (c->n_point - n_boundary) * sizeof *x);
  for (size_t k = 0; k < 4 * c->n_cell; k++) {
    uint32_t *v = &c->cell[k / 4][k % 4];

    *v = *v < n_boundary ? to[vg_doubled_first(d, *v)]
                         : (uint32_t)(*v - n_boundary + f->n_point);
  }
  free(c->x);
  free(to);
  c->x = x;
  c->n_point = n;
  return VG_OK;
}

/* --- generation ---------------------------------------------------------- */

static void progress(void *user, const char *stage, size_t done,
                     size_t expected)
{
  (void)stage;
  vg_partition_tell(user, "coarse mesh", done, expected);
}

/* Its sizing field, shared by the ranks of a node. */
static vg_status sizes(const struct vg_partition *p, struct vg_comm *comm,
                       double factor, struct vg_sizing **out,
                       struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!vg_comm_node_rank(comm))
    st = vg_discrete_sizes(&p->boundary, p->sizing, factor, out, err);
  st = vg_comm_agree(comm, st, err);
  return st == VG_OK ? vg_sizing_share(comm, out, err) : st;
}

static vg_status grow(struct vg_partition *p, struct vg_comm *comm,
                      double factor, struct vg_partition **out,
                      struct vg_spans *spans, struct vg_error *err)
{
  struct vg_partition_options o = p->options;
  struct vg_partition_report report = { 0 };
  struct vg_sizing *coarse = NULL;
  vg_status st = sizes(p, comm, factor, &coarse, err);

  o.rule = (struct vg_cut_rule){ leaf_cells, -1, 0 };
  o.levels = 0;
  o.cyclic = 0;
  o.maker = NULL;
  o.decomposition.n_part = 0;
  o.mesher = NULL;
  o.max_cells = 0;
  o.admit = NULL;
  o.fail_leaves = 0;
  o.job = vg_digest_of(o.job, 6, "coarse");
  o.progress = (struct vg_progress){ progress, p };
  if (st == VG_OK)
    st = vg_partition_grow(comm, &p->boundary, coarse, &o, out, &report, spans,
                           err);
  if (st == VG_ERR_GEOMETRY || st == VG_ERR_UNSUPPORTED)
    vg_discrete_refuse(st, err->text, factor, err);
  p->report.n_found += report.n_found;
  vg_sizing_free(coarse);
  return st;
}

/* Moves the paths of the tasks from "0", the whole void, to "1". Their cells
 * are not part of the final mesh. */
static void rename_tasks(struct vg_spans *s)
{
  for (size_t k = 0; k < s->n; k++) {
    s->span[k].path[0] = '1';
    if (s->span[k].after[0]) s->span[k].after[0] = '1';
    s->span[k].n_cell = 0;
    s->span[k].work = 0;
  }
  for (size_t k = 0; k < s->n_help; k++) s->help[k].path[0] = '1';
}

/* Returns a repair task, all of which wait for all leaves, or else the only
 * leaf. */
static const char *last_task(const struct vg_spans *s)
{
  const char *last = "";

  for (size_t k = 0; k < s->n; k++)
    if (s->span[k].kind == VG_SPAN_REPAIR) return s->span[k].path;
    else if (s->span[k].kind == VG_SPAN_LEAF) last = s->span[k].path;
  return last;
}

vg_status vg_coarse_record(struct vg_spans *before, struct vg_spans *spans,
                           struct vg_error *err)
{
  const char *last = last_task(before);
  vg_status st;

  assert(before && spans);
  for (size_t k = 0; k < spans->n; k++)
    if (!spans->span[k].after[0])
      memcpy(spans->span[k].after, last, strlen(last) + 1);
  st = vg_spans_append(before, spans, err);
  if (st < 0) return st;
  vg_spans_release(spans);
  *spans = *before;
  *before = (struct vg_spans)VG_SPANS_INIT;
  return VG_OK;
}

vg_status vg_coarse_mesh(struct vg_partition *p, struct vg_comm *comm,
                         const struct vg_node *root, struct vg_coarse_cells *c,
                         struct vg_spans *spans, struct vg_error *err)
{
  struct vg_decomposition_options o = VG_DECOMPOSITION_OPTIONS_INIT;
  struct vg_partition *made = NULL;
  double t = vg_clock(), factor = 0;
  vg_status st = VG_OK;

  assert(!root == (p->rank != 0));
  assert(!c->n_point && !c->n_cell && !c->x && !c->cell);
  assert(!spans || !spans->n);
  if (root) {
    o = vg_node_decomposition(p, root);
    st = vg_decomposition_check_options(&o, root->load.cells, err);
    factor = vg_discrete_coarsening(root->load.cells, &o);
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_max(comm, 1, &factor, err));
  st = grow(p, comm, factor, &made, spans, err);
  if (spans) rename_tasks(spans);
  if (st != VG_OK) goto done; /* or stopped */
  VG_TRY(gather(p, comm, vg_partition_slices(made), c, err));
  if (root)
    st = renumber(&p->doubled, &root->front, p->boundary.n_point, c, err);
  c->seconds = vg_clock() - t;
  st = vg_comm_agree(comm, st, err);
done:
  vg_partition_free(made);
  return st;
}
