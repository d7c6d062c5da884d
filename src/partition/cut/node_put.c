/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Front update: inserts the changes of a stage into the front of its node.
 * Outline: each task gets its range of indices behind the front, in the order
 * of the tasks. Points are then copied, and new faces are tested against the
 * front and inserted, in loops whose chunks write disjoint ranges. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/node.h"
#include "partition/engine/engine_memory.h"

/* Points or faces per chunk of a loop. */
enum { CHUNK = 8192 };

/* --- changes ------------------------------------------------------------- */

struct put {
  struct vg_node *n;
  struct place {
    size_t point, face;
  } * at; /* [n->n_work] Index of the first new point and face of each task. */
  int8_t *crosses;        /* [n->n_work] 1: the change crosses the front. */
  _Atomic size_t n_twice; /* Faces that two tasks consumed. */
};

/* Copies the new points, and tests the new faces while the whole front still
 * exists. */
static void test_part(void *context, size_t first, size_t end, int worker)
{
  const struct put *p = context;
  struct vg_front *f = &p->n->front;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const struct vg_change *c = &p->n->change[i];

    if (c->made.n_point)
      memcpy(f->x + p->at[i].point, c->made.x, c->made.n_point * sizeof *f->x);
    for (size_t k = 0; k < c->made.n_point; k++)
      f->id[p->at[i].point + k] = VG_POINT_ID(c->serial, k);
    p->crosses[i] = (int8_t)vg_node_crosses(p->n, i, p->at[i].point);
  }
}

/* Appends the faces that the task made, and marks consumed faces as gone. No
 * two tasks of a stage make cells on the same face, since walls keep them
 * apart. Nothing is kept of a change that crosses the front. Returns the number
 * of faces that were already gone. */
static size_t put_change(struct vg_node *n, size_t i, const struct place *at,
                         int crosses)
{
  struct vg_change *c = &n->change[i];
  struct vg_front *f = &n->front;
  size_t n_twice = 0;

  for (size_t k = 0; k < c->made.n_consumed && !crosses; k++) {
    uint32_t *face = f->face[n->face[i][c->made.consumed[k]]];

    n_twice += __atomic_exchange_n(&face[0], VG_FACE_GONE, __ATOMIC_RELAXED) ==
               VG_FACE_GONE;
  }
  for (size_t k = 0; k < c->made.n_face; k++)
    for (int j = 0; j < 3; j++)
      f->face[at->face + k][j] = crosses ? VG_FACE_GONE
                                         : vg_node_point(n, i, at->point,
                                                         c->made.face[k][j]);
  return n_twice;
}

static void put_part(void *context, size_t first, size_t end, int worker)
{
  struct put *p = context;
  struct vg_node *n = p->n;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    p->n_twice += put_change(n, i, &p->at[i], p->crosses[i]);
    vg_change_release(&n->change[i]);
    free(n->point[i]);
    free(n->face[i]);
    n->point[i] = n->face[i] = NULL;
  }
}

/* Reserves room, and sets the start of each range. */
static vg_status make_room(struct put *p, const struct vg_engine *e,
                           struct vg_error *err)
{
  struct vg_node *n = p->n;
  struct vg_front *f = &n->front;
  size_t np = f->n_point, nf = f->n_face;

  p->at = vg_alloc(n->n_work, sizeof *p->at);
  p->crosses = vg_calloc(n->n_work, sizeof *p->crosses);
  if (!p->at || !p->crosses) return vg_fail_memory(err, "cutting a front");
  for (size_t i = 0; i < n->n_work; i++) {
    p->at[i] = (struct place){ np, nf };
    np += n->change[i].made.n_point;
    nf += n->change[i].made.n_face;
  }
  if (!n->cap_x) n->cap_x = n->cap_id = f->n_point;
  if (!n->cap_face) n->cap_face = f->n_face;
  if (vg_engine_reserve(e, &f->x, &n->cap_x, f->n_point, np, sizeof *f->x) ||
      vg_engine_reserve(e, &f->id, &n->cap_id, f->n_point, np, sizeof *f->id) ||
      vg_engine_reserve(e, &f->face, &n->cap_face, f->n_face, nf,
                        sizeof *f->face))
    return vg_fail_memory(err, "cutting a front");
  f->n_point = np;
  f->n_face = nf;
  return VG_OK;
}

/* Counts the changes of the stage, and notes those that cross the front for
 * dropping. */
static vg_status count_changes(const struct put *put, struct vg_partition *p,
                               struct vg_error *err)
{
  struct vg_node *n = put->n;
  vg_status st = VG_OK;

  for (size_t i = 0; i < n->n_work && st == VG_OK; i++) {
    const struct vg_change *c = &n->change[i];

    if (put->crosses[i] < 0) return vg_fail_memory(err, "cutting a front");
    n->n_blocked += c->blocked || put->crosses[i];
    if (put->crosses[i]) {
      st = vg_partition_note_drop(p, c, err);
      continue;
    }
    n->separator_cells += (double)c->made.n_cell;
    n->zone_volume += c->made.volume;
  }
  return st;
}

/* --- blocks of points ---------------------------------------------------- */

static void label_part(void *context, size_t first, size_t end, int worker)
{
  struct vg_node *n = context;

  (void)worker;
  for (size_t i = n->n_block + first; i < n->n_block + end; i++) {
    const double *x = n->front.x[i];
    uint32_t b = vg_lattice_block(&n->lattice, x, 0);

    if (vg_lattice_block(&n->lattice, x, 1) != b) b |= VG_ON_PLANE;
    n->block[i] = (uint16_t)b;
  }
}

/* Sets the blocks of new points. */
static vg_status label_points(struct vg_node *n, const struct vg_engine *e,
                              struct vg_error *err)
{
  size_t all = n->front.n_point;

  if (vg_engine_reserve(e, &n->block, &n->cap_block, n->n_block, all,
                        sizeof *n->block))
    return vg_fail_memory(err, "cutting a front");
  vg_engine_loop(e, all - n->n_block, CHUNK, label_part, n);
  n->n_block = all;
  return VG_OK;
}

vg_status vg_node_put(struct vg_partition *p, struct vg_node *n,
                      const struct vg_engine *e, struct vg_error *err)
{
  struct put put = { .n = n };
  vg_status st = make_room(&put, e, err);

  assert((n->change && n->point && n->face) || !n->n_work);
  if (st == VG_OK) {
    vg_engine_loop(e, n->n_work, 1, test_part, &put);
    st = count_changes(&put, p, err);
  }
  if (st == VG_OK) {
    vg_engine_loop(e, n->n_work, 1, put_part, &put);
    st = put.n_twice
         ? vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: %zu faces of the front were consumed twice; please "
                   "report this with the project files",
                   n->path, put.n_twice)
         : label_points(n, e, err);
  }
  free(put.at);
  free(put.crosses);
  return st;
}

/* --- faces in no block --------------------------------------------------- */

/* Each chunk writes its list from the index of its first face on. */
struct look {
  const struct vg_node *n;
  uint32_t *face; /* [faces not yet examined] */
  size_t *count;  /* [chunks] */
};

static void look_part(void *context, size_t first, size_t end, int worker)
{
  const struct look *l = context;
  const struct vg_node *n = l->n;
  size_t m = first;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const uint32_t *v = n->front.face[n->n_seen + i];

    if (v[0] != VG_FACE_GONE && !vg_node_is_in_block(n->block, v))
      l->face[m++] = (uint32_t)(n->n_seen + i);
  }
  l->count[first / CHUNK] = m - first;
}

static int append_open(struct vg_node *n, const struct look *l, size_t n_chunk)
{
  size_t all = n->n_open;

  for (size_t c = 0; c < n_chunk; c++) all += l->count[c];
  if (vg_reserve(&n->open, &n->cap_open, all, sizeof *n->open)) return -1;
  for (size_t c = 0; c < n_chunk; c++) {
    if (!l->count[c]) continue;
    memcpy(n->open + n->n_open, l->face + c * CHUNK,
           l->count[c] * sizeof *n->open);
    n->n_open += l->count[c];
  }
  return 0;
}

vg_status vg_node_list_open(struct vg_node *n, const struct vg_engine *e,
                            struct vg_error *err)
{
  size_t new = n->front.n_face - n->n_seen, left = 0;
  size_t n_chunk = (new + CHUNK - 1) / CHUNK;
  struct look l = { n, vg_alloc(new, sizeof *l.face),
                    vg_alloc(n_chunk, sizeof *l.count) };
  int bad = !l.face || !l.count;

  assert(n->n_seen <= n->front.n_face);
  /* if no region contained a face, vg_node_put did not set their blocks */
  if (!bad) bad = label_points(n, e, err) != VG_OK;
  for (size_t k = 0; k < n->n_open; k++)
    if (n->front.face[n->open[k]][0] != VG_FACE_GONE)
      n->open[left++] = n->open[k];
  n->n_open = left;
  if (!bad) {
    vg_engine_loop(e, new, CHUNK, look_part, &l);
    bad = append_open(n, &l, n_chunk);
  }
  free(l.face);
  free(l.count);
  if (bad) return vg_fail_memory(err, "cutting a front");
  n->n_seen = n->front.n_face;
  return VG_OK;
}
