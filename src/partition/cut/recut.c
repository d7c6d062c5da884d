/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repeated decomposition (recut) around leaves that could not be filled.
 * Outline: such a leaf is set aside, and all other tasks continue. When they
 * are done, the cells of the adjacent zones are removed. The boundary of these
 * cells and of the leaf is the front of a larger void, which is filled as one
 * leaf. If that fails too, more pieces are removed, including leaves, and so
 * on; voids that meet are merged. The cost is therefore local, whatever the
 * tree of cuts looks like, and a run without failures stores nothing for this
 * purpose. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "core/delaunay/tets.h"
#include "core/search/box.h"
#include "partition/cut/node.h"

/* Appended to the path of a void each time it is extended. */
static const char larger = '~';

vg_status vg_recut_note_leaf(struct vg_partition *p, struct vg_node *n,
                             const struct vg_error *why, struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(n && why);
  pthread_mutex_lock(&p->lock);
  if (vg_reserve(&p->unfilled, &p->cap_unfilled, p->n_unfilled + 1,
                 sizeof *p->unfilled)) {
    st = vg_fail_memory(err, "a void");
  } else {
    p->unfilled[p->n_unfilled].why = *why;
    p->unfilled[p->n_unfilled++].node = n;
  }
  pthread_mutex_unlock(&p->lock);
  return st;
}

void vg_recut_release(struct vg_partition *p)
{
  for (size_t k = 0; k < p->n_unfilled; k++) vg_node_free(p->unfilled[k].node);
  p->n_unfilled = 0;
  free(p->unfilled);
}

/* --- unfilled voids, known to all ranks ---------------------------------- */

struct corners {
  uint64_t id[3];
}; /* Corners of a face, ascending. */

struct unfilled {
  char path[VG_PATH_MAX];
  struct vg_error why;
  struct vg_box box;
  size_t n_face;
  struct corners *face; /* [n_face] Sorted. */
};

/* Exchange of pieces and voids. */
struct parcels {
  struct vg_partition *p;
  size_t n;
  struct unfilled *of; /* [n] Sorted by path. */
  uint32_t *up;        /* [n] Voids that meet (base/union_find.h); the root
                          is handled by rank root % size. */
  uint32_t *near;      /* [p->n_piece] An adjacent void, or n: none. */
  size_t n_gone, cap_gone;
  uint32_t *gone;       /* [n_gone] Serials of the pieces that this rank
                           removes, and of unfilled voids. */
  struct vg_writer *to; /* [size] */
};

static int by_path(const void *a, const void *b)
{
  const struct unfilled *s = a, *t = b;

  return strcmp(s->path, t->path);
}

static int by_corners(const void *a, const void *b)
{
  return memcmp(a, b, sizeof(struct corners));
}

static struct corners corners_of(const uint64_t a, const uint64_t b,
                                 const uint64_t c)
{
  uint64_t lo = a < b ? a : b, hi = a < b ? b : a;

  if (c < lo) return (struct corners){ { c, lo, hi } };
  if (c < hi) return (struct corners){ { lo, c, hi } };
  return (struct corners){ { lo, hi, c } };
}

static void put_void(struct vg_writer *w, const struct vg_node *n,
                     const struct vg_error *why)
{
  const struct vg_front *f = &n->front;
  struct vg_box box = VG_BOX_EMPTY;
  uint64_t n_face = f->n_face;

  for (size_t i = 0; i < f->n_point; i++) vg_box_add(&box, f->x[i]);
  vg_put(w, sizeof n->path, 1, n->path);
  vg_put(w, sizeof why->text, 1, why->text);
  vg_put(w, 1, sizeof box, &box);
  vg_put(w, 1, sizeof n_face, &n_face);
  for (size_t k = 0; k < f->n_face; k++) {
    const uint32_t *v = f->face[k];
    struct corners c = corners_of(f->id[v[0]], f->id[v[1]], f->id[v[2]]);

    vg_put(w, 3, sizeof *c.id, c.id);
  }
}

static void get_void(struct vg_reader *r, struct unfilled *u)
{
  uint64_t n_face = 0;

  vg_get(r, sizeof u->path, 1, u->path);
  vg_get(r, sizeof u->why.text, 1, u->why.text);
  vg_get(r, 1, sizeof u->box, &u->box);
  vg_get(r, 1, sizeof n_face, &n_face);
  u->path[sizeof u->path - 1] = u->why.text[sizeof u->why.text - 1] = 0;
  u->face = vg_get_array(r, (size_t)n_face, sizeof *u->face);
  u->n_face = r->bad ? 0 : (size_t)n_face;
  if (u->n_face) qsort(u->face, u->n_face, sizeof *u->face, by_corners);
}

static vg_status read_voids(struct parcels *q, const struct vg_bytes *all,
                            struct vg_error *err)
{
  size_t cap = 0;

  for (int k = 0; k < q->p->size; k++) {
    struct vg_reader r = { .data = all[k].data, .n = all[k].n };

    while (r.at < r.n) {
      if (vg_reserve(&q->of, &cap, q->n + 1, sizeof *q->of))
        return vg_fail_memory(err, "a void");
      q->of[q->n] = (struct unfilled){ .n_face = 0 };
      get_void(&r, &q->of[q->n]);
      q->n++;
      if (r.bad) return vg_fail_damaged(err, "a void");
    }
  }
  if (q->n) qsort(q->of, q->n, sizeof *q->of, by_path);
  return VG_OK;
}

/* Makes the same list on all ranks. Collective. */
static vg_status list_voids(struct parcels *q, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_partition *p = q->p;
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  struct vg_writer w = { .cap = 0 };
  vg_status st = all ? VG_OK : vg_fail_memory(err, "a void");

  for (size_t k = 0; k < p->n_unfilled; k++)
    put_void(&w, p->unfilled[k].node, &p->unfilled[k].why);
  if (w.refused) st = vg_fail_memory(err, "a message");
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &w.bytes, all, err));
  st = vg_comm_agree(comm, read_voids(q, all, err), err);
done:
  free(w.bytes.data);
  vg_bytes_release(all, (size_t)p->size);
  return st;
}

/* --- adjacent pieces ----------------------------------------------------- */

/* First the zones adjacent to a void are removed; in the next rounds these and
 * the leaf that shares most faces with the void; in the end all adjacent
 * pieces. If no zone is adjacent, as between the subdomains of a
 * decomposition, a leaf is removed in the first round. */
enum { NO_LEAF, ONE_LEAF, ALL_LEAVES };

enum { ONE_BY_ONE = 3 }; /* C17 */

static int leaves_taken(const struct unfilled *u)
{
  int rounds = 0;

  for (const char *c = u->path; *c; c++) rounds += *c == larger;
  return !rounds ? NO_LEAF : rounds <= ONE_BY_ONE ? ONE_LEAF : ALL_LEAVES;
}

static int boxes_meet(const struct unfilled *u, const struct vg_piece *q)
{
  struct vg_box box = VG_BOX_EMPTY;

  for (size_t i = 0; i < q->n_in + q->n_point; i++) vg_box_add(&box, q->x[i]);
  return vg_box_touch(&u->box, &box);
}

static uint64_t name_in(const struct vg_piece *q, uint32_t v)
{
  return v < q->n_in ? q->in[v] : VG_POINT_ID(q->serial, v - q->n_in);
}

/* Number of faces that a piece shares with a void, counted up to `most`. */
static uint64_t n_common(const struct unfilled *u, const struct vg_piece *q,
                         uint64_t most)
{
  uint64_t n = 0;

  for (size_t k = 0; k < 4 * q->n_cell && n < most; k++) {
    const uint8_t *f = vg_face[k % 4];
    struct corners c;
    uint32_t v[4];

    vg_piece_cell(q, k / 4, v);
    c = corners_of(name_in(q, v[f[0]]), name_in(q, v[f[1]]),
                   name_in(q, v[f[2]]));
    n += bsearch(&c, u->face, u->n_face, sizeof c, by_corners) != NULL;
  }
  return n;
}

static void take_back(struct parcels *q, size_t piece, uint32_t from)
{
  if (q->near[piece] < q->n) vg_union(q->up, q->near[piece], from);
  else q->near[piece] = from;
}

/* The leaf that shares most faces with a void. */
struct best {
  uint64_t n;
  vg_path path;
};

static int is_better(const struct best *a, const struct best *b)
{
  return a->n != b->n ? a->n > b->n : a->n && strcmp(a->path, b->path) < 0;
}

/* Finds the pieces of this rank that are adjacent to voids, and voids that
 * meet in one piece. best: [q->n] zeros; the best leaf of this rank, for voids
 * that take one leaf; n_zone: [q->n] zeros; adjacent zones of this rank. */
static void look_around(struct parcels *q, struct best *best, uint64_t *n_zone)
{
  for (size_t k = 0; k < q->p->n_piece; k++) {
    const struct vg_piece *piece = &q->p->piece[k];
    int is_leaf = piece->kind == VG_SPAN_LEAF;

    q->near[k] = (uint32_t)q->n;
    for (uint32_t i = 0; i < q->n; i++) {
      int all = !is_leaf || leaves_taken(&q->of[i]) == ALL_LEAVES;
      struct best own = { .n = 0 };

      if (!boxes_meet(&q->of[i], piece)) continue;
      own.n = n_common(&q->of[i], piece, all ? 1 : UINT64_MAX);
      memcpy(own.path, piece->path, sizeof own.path);
      n_zone[i] += !is_leaf && own.n;
      if (all && own.n) take_back(q, k, i);
      if (!all && is_better(&own, &best[i])) best[i] = own;
    }
  }
}

/* Finds the best leaf of all ranks for each void that takes one. Collective. */
static vg_status take_best(struct parcels *q, struct vg_comm *comm,
                           struct best *best, uint64_t *n_zone,
                           struct vg_error *err)
{
  struct vg_bytes mine = { q->n * sizeof *best, (unsigned char *)best };
  struct vg_bytes *all = vg_calloc((size_t)q->p->size, sizeof *all);
  vg_status st = all ? VG_OK : vg_fail_memory(err, "a void");

  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_sum(comm, q->n, n_zone, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; r < q->p->size; r++) {
    const struct best *from = (const struct best *)(const void *)all[r].data;

    for (size_t i = 0; i < all[r].n / sizeof *from; i++)
      if (is_better(&from[i], &best[i])) best[i] = from[i];
  }
  for (size_t k = 0; k < q->p->n_piece; k++)
    for (uint32_t i = 0; i < q->n; i++)
      if ((leaves_taken(&q->of[i]) != NO_LEAF || !n_zone[i]) && best[i].n &&
          !strcmp(best[i].path, q->p->piece[k].path))
        take_back(q, k, i);
done:
  vg_bytes_release(all, (size_t)q->p->size);
  return st;
}

/* Merges voids that share a face. */
static void join_voids(struct parcels *q)
{
  for (uint32_t i = 0; i < q->n; i++)
    for (uint32_t k = 0; k < i; k++)
      for (size_t f = 0; f < q->of[i].n_face; f++)
        if (bsearch(&q->of[i].face[f], q->of[k].face, q->of[k].n_face,
                    sizeof(struct corners), by_corners)) {
          vg_union(q->up, i, k);
          break;
        }
}

/* Combines the groups that all ranks have found. VG_ERR_GEOMETRY if a void has
 * no adjacent piece that could be removed. Collective. */
static vg_status agree_on_groups(struct parcels *q, struct vg_comm *comm,
                                 struct vg_error *err)
{
  struct vg_bytes mine = { q->n * sizeof *q->up, (unsigned char *)q->up };
  struct vg_bytes *all = vg_calloc((size_t)q->p->size, sizeof *all);
  uint64_t *adjacent = vg_calloc(q->n, sizeof *adjacent);
  vg_status st = all && adjacent ? VG_OK : vg_fail_memory(err, "a void");

  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; r < q->p->size; r++) {
    const uint32_t *up = (const uint32_t *)(const void *)all[r].data;

    for (uint32_t k = 0; k < all[r].n / sizeof *up; k++)
      vg_union(q->up, k, up[k]);
  }
  for (size_t k = 0; k < q->p->n_piece; k++)
    if (q->near[k] < q->n) adjacent[vg_root_of(q->up, q->near[k])]++;
  for (uint32_t k = 0; k < q->n; k++)
    adjacent[k] += vg_root_of(q->up, k) != k; /* merged into another void */
  VG_TRY(vg_comm_sum(comm, q->n, adjacent, err));
  for (size_t k = 0; k < q->n; k++) {
    if (adjacent[k] && strlen(q->of[k].path) + 2 < VG_PATH_MAX) continue;
    st = vg_fail(err, VG_ERR_GEOMETRY, "%s", q->of[k].why.text);
    break;
  }
done:
  free(adjacent);
  vg_bytes_release(all, (size_t)q->p->size);
  return st;
}

/* --- transfer to the filling ranks --------------------------------------- */

static void send_front(const struct parcels *q, uint32_t of, double per_cube,
                       const struct vg_front *f)
{
  uint32_t root = vg_root_of(q->up, of);
  struct vg_writer *w = &q->to[root % (size_t)q->p->size];
  uint64_t head = root;

  vg_put(w, 1, sizeof head, &head);
  vg_put(w, 1, sizeof per_cube, &per_cube);
  vg_front_put(w, f, 1);
}

static vg_status add_gone(struct parcels *q, uint32_t serial,
                          struct vg_error *err)
{
  if (vg_reserve(&q->gone, &q->cap_gone, q->n_gone + 1, sizeof *q->gone))
    return vg_fail_memory(err, "a void");
  q->gone[q->n_gone++] = serial;
  return VG_OK;
}

static vg_status send_unfilled(struct parcels *q, struct vg_error *err)
{
  struct vg_partition *p = q->p;
  vg_status st = VG_OK;

  for (size_t k = 0; k < p->n_unfilled; k++) {
    struct vg_node *n = p->unfilled[k].node;
    struct unfilled key, *u;

    memcpy(key.path, n->path, sizeof key.path);
    u = bsearch(&key, q->of, q->n, sizeof *q->of, by_path);
    if (u) send_front(q, (uint32_t)(u - q->of), n->per_cube, &n->front);
    if (st == VG_OK) st = add_gone(q, n->serial, err);
    vg_node_free(n);
  }
  p->n_unfilled = 0;
  return st;
}

/* Sends the boundaries of the pieces adjacent to voids, and drops the pieces.
 * path: their paths. */
static vg_status send_pieces(struct parcels *q, vg_path *path, size_t *n_path,
                             struct vg_error *err)
{
  struct vg_partition *p = q->p;
  size_t left = 0;
  vg_status st = VG_OK;

  for (size_t k = 0; k < p->n_piece; k++) {
    struct vg_piece *piece = &p->piece[k];
    struct vg_front f = VG_FRONT_INIT;

    if (st < 0 || q->near[k] >= q->n) {
      p->piece[left++] = *piece;
      continue;
    }
    st = vg_recut_front(&p->doubled, piece, &f, err);
    if (st == VG_OK) send_front(q, q->near[k], 0, &f);
    if (st == VG_OK) st = add_gone(q, piece->serial, err);
    vg_front_release(&f);
    p->report.n_widened_cell += piece->n_cell;
    if (piece->kind != VG_SPAN_LEAF) p->report.n_zone_cell -= piece->n_cell;
    memcpy(path[(*n_path)++], piece->path, sizeof *path);
    vg_piece_release(piece);
  }
  p->n_piece = left;
  return st;
}

/* An extended void under construction, on the rank that fills it. */
struct wider {
  struct vg_front front;
  double per_cube;
};

static vg_status receive(const struct parcels *q, struct wider *wider,
                         const struct vg_bytes *b, struct vg_error *err)
{
  struct vg_reader r = { .data = b->data, .n = b->n };
  vg_status st = VG_OK;

  while (st == VG_OK && !r.bad && r.at < r.n) {
    struct vg_front f = VG_FRONT_INIT;
    double per_cube = 0;
    uint64_t head = 0;

    vg_get(&r, 1, sizeof head, &head);
    vg_get(&r, 1, sizeof per_cube, &per_cube);
    if (r.bad || head >= q->n) break;
    vg_front_get(&r, &f, 1);
    if (!r.bad) st = vg_front_join(&wider[head].front, &f, err);
    wider[head].per_cube = fmax(wider[head].per_cube, per_cube);
    vg_front_release(&f);
  }
  return st == VG_OK && r.at < r.n ? vg_fail_damaged(err, "a front") : st;
}

/* Sends the parts of the voids from all ranks to the ranks that fill them.
 * wider: [q->n]. Collective. */
static vg_status exchange(struct parcels *q, struct vg_comm *comm,
                          struct wider *wider, struct vg_spans *spans,
                          struct vg_error *err)
{
  size_t size = (size_t)q->p->size, n_path = 0;
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_path *path = vg_calloc(q->p->n_piece, sizeof *path);
  vg_status st = VG_OK;

  q->to = vg_calloc(size, sizeof *q->to);
  if (!to || !from || !q->to || !path) {
    st = vg_fail_memory(err, "a void");
  } else {
    st = send_unfilled(q, err);
    if (st == VG_OK) st = send_pieces(q, path, &n_path, err);
  }
  for (size_t r = 0; st == VG_OK && r < size; r++) {
    to[r] = q->to[r].bytes;
    if (q->to[r].refused) st = vg_fail_memory(err, "a message");
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_exchange(comm, to, from, err));
  for (size_t r = 0; r < size && st == VG_OK; r++)
    st = receive(q, wider, &from[r], err);
  VG_TRY(vg_comm_agree(comm, st, err));
  st = vg_partition_forget_spans(q->p, comm, n_path, path, spans, err);
done:
  for (size_t r = 0; q->to && r < size; r++) free(q->to[r].bytes.data);
  free(q->to);
  free(to);
  free(path);
  vg_bytes_release(from, size);
  return st;
}

/* --- extended voids ------------------------------------------------------ */

static vg_status new_node(struct vg_partition *p, const char *path,
                          struct wider *wider, struct vg_node **out,
                          struct vg_error *err)
{
  struct vg_front *f = &wider->front;
  char longer[VG_PATH_MAX];
  struct vg_node *n;
  vg_status st;

  VG_TRY(vg_front_weld(f, err));
  VG_TRY(vg_recut_settle(&p->doubled, f, err));
  snprintf(longer, sizeof longer, "%.*s%c", VG_PATH_MAX - 2, path, larger);
  n = *out = vg_node_new(longer, f);
  if (!n) return vg_fail_memory(err, "a void");
  n->per_cube = wider->per_cube;
  n->is_final = 1;
  n->serial = vg_partition_serial(p);
  VG_TRY(vg_load_new(&n->front, p->sizing, n->per_cube, p->options.threads,
                     &n->load, err));
  st = vg_select_sort(&n->front, err);
done:
  return st;
}

static vg_status prepare(struct parcels *q, struct vg_comm *comm,
                         struct vg_error *err)
{
  struct best *best = vg_calloc(q->n, sizeof *best);
  uint64_t *n_zone = vg_calloc(q->n, sizeof *n_zone);
  vg_status st;

  q->up = vg_alloc(q->n, sizeof *q->up);
  q->near = vg_alloc(q->p->n_piece, sizeof *q->near);
  st = q->up && q->near && best && n_zone ? VG_OK
                                          : vg_fail_memory(err, "a void");
  VG_TRY(vg_comm_agree(comm, st, err));
  for (uint32_t k = 0; k < q->n; k++) q->up[k] = k;
  join_voids(q);
  look_around(q, best, n_zone);
  VG_TRY(take_best(q, comm, best, n_zone, err));
  st = agree_on_groups(q, comm, err);
done:
  free(best);
  free(n_zone);
  return st;
}

static void release(struct parcels *q)
{
  for (size_t k = 0; k < q->n; k++) free(q->of[k].face);
  free(q->of);
  free(q->up);
  free(q->near);
  free(q->gone);
}

vg_status vg_recut_voids(struct vg_partition *p, struct vg_comm *comm,
                         struct vg_spans *spans, size_t *n_void,
                         struct vg_node ***node, size_t *n,
                         struct vg_error *err)
{
  struct parcels q = { .p = p };
  struct wider *wider = NULL;
  uint32_t *own = NULL;
  uint64_t all = p->n_unfilled;
  vg_status st;

  assert(n_void && node && n);
  *n_void = *n = 0;
  *node = NULL;
  VG_TRY(vg_comm_sum(comm, 1, &all, err));
  if (!all) return VG_OK;
  VG_TRY(list_voids(&q, comm, err));
  VG_TRY(prepare(&q, comm, err));
  wider = vg_calloc(q.n, sizeof *wider);
  own = vg_calloc(q.n, sizeof *own);
  *node = vg_calloc(q.n, sizeof **node);
  st = wider && own && *node ? VG_OK : vg_fail_memory(err, "a void");
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(exchange(&q, comm, wider, spans, err));
  for (uint32_t k = 0; k < q.n; k++) {
    if (vg_root_of(q.up, k) != k) continue;
    ++*n_void;
    if (k % (uint32_t)p->size != (uint32_t)p->rank || st < 0) continue;
    own[*n] = k;
    st = new_node(p, q.of[k].path, &wider[k], &(*node)[(*n)++], err);
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_recut_adopt(p, comm, q.n_gone, q.gone, *n, *node, own, err));
  if (!p->rank) p->report.n_widened += *n_void;
done:
  for (size_t k = 0; wider && k < q.n; k++) vg_front_release(&wider[k].front);
  free(wider);
  free(own);
  release(&q);
  return st;
}
