/* Voids cut elsewhere, where a part of them could not be filled. Outline: such
 * a leaf is laid aside and all other tasks go on. When they are done, the void
 * that it was cut from is put together again: what bounds the cells that were
 * made in it, and the parts that have none, is its front. These cells are
 * forgotten, and the void is cut by other planes. Where that does not help,
 * the next larger void follows; where that is the whole, the caller begins
 * anew. Nothing is kept for this while all goes well. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "partition/cut/node.h"

/* At the end of the path of a void that was cut elsewhere. */
static const char again = '~';

/* --- which void ---------------------------------------------------------- */

int vg_recut_path(const char *path, char void_path[VG_PATH_MAX])
{
  const char *mark = strchr(path, again);
  char *dot;

  snprintf(void_path, VG_PATH_MAX, "%.*s",
           (int)(mark ? (size_t)(mark - path) : strlen(path)), path);
  dot = strrchr(void_path, '.');
  if (dot) *dot = 0;
  return strchr(void_path, '.') != NULL;
}

/* Is it the path of the void, or of a task or a part of it? */
static int is_of(const char *path, const char *void_path)
{
  size_t n = strlen(void_path);

  return !strncmp(path, void_path, n) && !(path[n] >= '0' && path[n] <= '9');
}

vg_status vg_recut_note_leaf(struct vg_partition *p, struct vg_node *n,
                             const struct vg_error *why, struct vg_error *err)
{
  vg_status st = VG_OK;

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

vg_status vg_recut_note_cut(struct vg_partition *p, const struct vg_node *n,
                            struct vg_error *err)
{
  struct vg_recut_cut cut = { .levels = n->levels, .retry = n->retry,
                             .per_cube = n->per_cube };
  vg_status st = VG_OK;

  if (!strchr(n->path, '.')) return VG_OK;
  memcpy(cut.path, n->path, sizeof cut.path);
  pthread_mutex_lock(&p->lock);
  if (vg_reserve(&p->cut, &p->cap_cut, p->n_cut + 1, sizeof *p->cut))
    st = vg_fail_memory(err, "a void");
  else
    p->cut[p->n_cut++] = cut;
  pthread_mutex_unlock(&p->lock);
  return st;
}

void vg_recut_release(struct vg_partition *p)
{
  for (size_t k = 0; k < p->n_unfilled; k++)
    vg_node_free(p->unfilled[k].node);
  p->n_unfilled = 0;
  free(p->unfilled);
  free(p->cut);
}

typedef char path_type[VG_PATH_MAX];

static int by_path(const void *a, const void *b)
{
  return strcmp(a, b);
}

/* Of voids within each other the largest. */
static size_t keep_largest(size_t n, path_type *path)
{
  size_t left = 0;

  if (n) qsort(path, n, sizeof *path, by_path);
  for (size_t k = 0; k < n; k++) {
    int is_new = 1;

    for (size_t i = 0; i < left; i++) is_new &= !is_of(path[k], path[i]);
    if (is_new) memmove(path[left++], path[k], sizeof *path);
  }
  return left;
}

/* Voids to be cut elsewhere, the same list on all ranks. VG_ERR_GEOMETRY:
 * the whole is one. Collective. */
static vg_status list_voids(struct vg_partition *p, struct vg_comm *comm,
                            path_type **out, size_t *n, struct vg_error *err)
{
  struct vg_bytes mine = { .n = p->n_unfilled * sizeof **out };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  path_type *path = vg_calloc(p->n_unfilled, sizeof *path);
  size_t bytes = 0;
  vg_status st = all && path ? VG_OK : vg_fail_memory(err, "a void");

  for (size_t k = 0; st == VG_OK && k < p->n_unfilled; k++)
    if (!vg_recut_path(p->unfilled[k].node->path, path[k]))
      st = vg_fail(err, VG_ERR_GEOMETRY, "%s", p->unfilled[k].why.text);
  mine.data = (unsigned char *)path;
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; r < p->size; r++) bytes += all[r].n;
  *out = vg_alloc(bytes, 1);
  VG_TRY(vg_comm_agree(comm, *out ? VG_OK : vg_fail_memory(err, "a void"),
                       err));
  for (int r = 0; r < p->size; r++)
    if (all[r].n) {
      memcpy(*out + *n, all[r].data, all[r].n);
      *n += all[r].n / sizeof **out;
    }
  *n = keep_largest(*n, *out);
done:
  vg_bytes_release(all, (size_t)p->size);
  free(path);
  return st;
}

/* --- what the ranks have of the voids ------------------------------------ */

/* On the rank that cuts it again. */
struct recut {
  struct vg_front front;
  struct vg_recut_cut cut;
};

enum { CUT, FRONT };

struct parcels {
  struct vg_partition *p;
  size_t n;
  path_type *path;           /* [n] voids; that of void k is rank k % size */
  struct vg_writer *to;      /* [size] */
};

/* Where what belongs to this path goes, of which it is told; NULL: to none. */
static struct vg_writer *address(const struct parcels *q, const char *path,
                                 int what)
{
  for (size_t k = 0; k < q->n; k++) {
    const uint64_t head[2] = {k, (uint64_t)what};
    struct vg_writer *w = &q->to[k % (size_t)q->p->size];

    if (!is_of(path, q->path[k])) continue;
    vg_put(w, 2, sizeof *head, head);
    return w;
  }
  return NULL;
}

static void send_cuts(const struct parcels *q)
{
  for (size_t k = 0; k < q->p->n_cut; k++) {
    const struct vg_recut_cut *c = &q->p->cut[k];

    for (size_t i = 0; i < q->n; i++)
      if (!strcmp(c->path, q->path[i]))
        vg_put(address(q, c->path, CUT), 1, sizeof *c, c);
  }
}

static void send_unfilled(const struct parcels *q)
{
  struct vg_partition *p = q->p;

  for (size_t k = 0; k < p->n_unfilled; k++) {
    struct vg_node *n = p->unfilled[k].node;
    struct vg_writer *w = address(q, n->path, FRONT);

    if (w) vg_front_put(w, &n->front, 1);
    vg_node_free(n);
  }
  p->n_unfilled = 0;
}

static void count_forgotten(struct vg_partition *p, const struct vg_piece *q)
{
  p->report.n_elsewhere_cell += q->n_cell;
  if (q->kind != VG_SPAN_LEAF) p->report.n_zone_cell -= q->n_cell;
}

/* Pieces in the voids are sent as what bounds them, and forgotten. */
static vg_status send_pieces(const struct parcels *q, struct vg_error *err)
{
  struct vg_partition *p = q->p;
  size_t left = 0;
  vg_status st = VG_OK;

  for (size_t k = 0; k < p->n_piece; k++) {
    struct vg_front f = VG_FRONT_INIT;
    struct vg_writer *w = st < 0 ? NULL
                                 : address(q, p->piece[k].path, FRONT);

    if (!w) {
      p->piece[left++] = p->piece[k];
      continue;
    }
    st = vg_recut_front(&p->piece[k], &f, err);
    if (st == VG_OK) vg_front_put(w, &f, 1);
    vg_front_release(&f);
    count_forgotten(p, &p->piece[k]);
    vg_piece_release(&p->piece[k]);
  }
  p->n_piece = left;
  return st;
}

static vg_status receive(struct parcels *q, struct recut *recut,
                         const struct vg_bytes *b, struct vg_error *err)
{
  struct vg_reader r = { .data = b->data, .n = b->n };
  uint64_t head[2];
  vg_status st = VG_OK;

  while (st == VG_OK && !r.bad && r.at < r.n) {
    struct vg_front f = VG_FRONT_INIT;

    vg_get(&r, 2, sizeof *head, head);
    if (r.bad || head[0] >= q->n) break;
    if (head[1] == CUT) {
      vg_get(&r, 1, sizeof recut->cut, &recut[head[0]].cut);
      continue;
    }
    vg_front_get(&r, &f, 1);
    if (!r.bad) st = vg_front_join(&recut[head[0]].front, &f, err);
    vg_front_release(&f);
  }
  return r.bad ? vg_fail_damaged(err, "a front") : st;
}

/* What all ranks have of the voids to those that cut them. recut: [q->n].
 * Collective. */
static vg_status exchange(struct parcels *q, struct vg_comm *comm,
                          struct recut *recut, struct vg_error *err)
{
  size_t size = (size_t)q->p->size;
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = VG_OK;

  q->to = vg_calloc(size, sizeof *q->to);
  if (!to || !from || !q->to) {
    st = vg_fail_memory(err, "a void");
  } else {
    send_cuts(q);
    send_unfilled(q);
    st = send_pieces(q, err);
  }
  for (size_t r = 0; st == VG_OK && r < size; r++) {
    to[r] = q->to[r].bytes;
    if (q->to[r].refused) st = vg_fail_memory(err, "a message");
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_exchange(comm, to, from, err));
  for (size_t r = 0; r < size && st == VG_OK; r++)
    st = receive(q, recut, &from[r], err);
  st = vg_comm_agree(comm, st, err);
done:
  for (size_t r = 0; q->to && r < size; r++) free(q->to[r].bytes.data);
  free(q->to);
  free(to);
  vg_bytes_release(from, size);
  return st;
}

/* --- to be cut again ----------------------------------------------------- */

static vg_status new_node(struct vg_partition *p, struct recut *recut,
                          struct vg_node **out, struct vg_error *err)
{
  struct vg_front *f = &recut->front;
  char path[VG_PATH_MAX];
  struct vg_node *n;
  struct vg_void v;
  vg_status st;

  VG_TRY(vg_front_weld(f, err));
  VG_TRY(vg_recut_settle(f, err));
  snprintf(path, sizeof path, "%.*s%c", VG_PATH_MAX - 2, recut->cut.path,
           again);
  n = *out = vg_node_new(path, f);
  if (!n) return vg_fail_memory(err, "a void");
  n->levels = recut->cut.levels;
  n->retry = recut->cut.retry + 1;
  n->per_cube = recut->cut.per_cube;
  v = (struct vg_void){ .n_point = n->front.n_point, .x = n->front.x,
                        .n_face = n->front.n_face, .face = n->front.face };
  VG_TRY(vg_load_new(&v, p->sizing, n->per_cube, p->options.threads,
                     &n->load, err));
  st = vg_select_sort(&n->front, err);
done:
  return st;
}

/* Cells that were made for nothing are in no leaf. */
static void forget_spans(struct vg_spans *s, size_t n, path_type *path)
{
  for (size_t i = 0; i < s->n; i++)
    for (size_t k = 0; k < n; k++)
      if (is_of(s->span[i].path, path[k])) s->span[i].n_cell = 0;
}

vg_status vg_recut_voids(struct vg_partition *p, struct vg_comm *comm,
                         struct vg_spans *spans, size_t *n_void,
                         struct vg_node ***node, size_t *n,
                         struct vg_error *err)
{
  struct parcels q = { .p = p };
  struct recut *recut = NULL;
  vg_status st;

  *n_void = *n = 0;
  *node = NULL;
  VG_TRY(list_voids(p, comm, &q.path, &q.n, err));
  if (!q.n) goto done;
  recut = vg_calloc(q.n, sizeof *recut);
  *node = vg_calloc(q.n, sizeof **node);
  st = recut && *node ? VG_OK : vg_fail_memory(err, "a void");
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(exchange(&q, comm, recut, err));
  for (size_t k = (size_t)p->rank; k < q.n && st == VG_OK;
       k += (size_t)p->size)
    st = new_node(p, &recut[k], &(*node)[(*n)++], err);
  VG_TRY(vg_comm_agree(comm, st, err));
  if (spans) forget_spans(spans, q.n, q.path);
  if (!p->rank) p->report.n_elsewhere += q.n;
  *n_void = q.n;
done:
  for (size_t k = 0; recut && k < q.n; k++) vg_front_release(&recut[k].front);
  free(recut);
  free(q.path);
  return st;
}
