/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Points of removed pieces. Their cells are gone, but other pieces share
 * points with them, by ids with the serial of the removed piece. The void that
 * is filled there has all of these points on its front, and its leaf adopts
 * them. Of voids that touch in a point, the first one adopts it. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/node.h"

/* A global id that void k has on its front. */
struct claim {
  uint64_t id;
  uint64_t k;
};

struct rename {
  uint64_t from, to;
};

static int by_value(const void *a, const void *b)
{
  const uint32_t *s = a, *t = b;

  return (*s > *t) - (*s < *t);
}

static int by_claim(const void *a, const void *b)
{
  const struct claim *s = a, *t = b;

  if (s->id != t->id) return s->id < t->id ? -1 : 1;
  return (s->k > t->k) - (s->k < t->k);
}

static int by_from(const void *a, const void *b)
{
  const struct rename *s = a, *t = b;

  return (s->from > t->from) - (s->from < t->from);
}

/* Gathers the items of all ranks in one list. Collective. */
static vg_status gather(struct vg_partition *p, struct vg_comm *comm, size_t n,
                        size_t size, const void *mine, void **out,
                        size_t *n_out, struct vg_error *err)
{
  struct vg_bytes own = { n * size, NULL };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  size_t bytes = 0;
  vg_status st;

  *out = NULL;
  *n_out = 0;
  own.data = vg_alloc(own.n, 1);
  if (own.data && own.n) memcpy(own.data, mine, own.n);
  VG_TRY(vg_comm_agree(comm,
                       all && own.data
                         ? VG_OK
                         : vg_fail_memory(err, "the global ids of points"),
                       err));
  VG_TRY(vg_comm_allgather(comm, &own, all, err));
  for (int r = 0; r < p->size; r++) bytes += all[r].n;
  *out = vg_alloc(bytes, 1);
  VG_TRY(vg_comm_agree(
    comm, *out ? VG_OK : vg_fail_memory(err, "the global ids of points"), err));
  for (int r = 0; r < p->size; r++) {
    if (all[r].n) memcpy((char *)*out + *n_out * size, all[r].data, all[r].n);
    *n_out += all[r].n / size;
  }
done:
  free(own.data);
  vg_bytes_release(all, (size_t)p->size);
  return st;
}

static int is_gone(size_t n, const uint32_t *gone, uint64_t id)
{
  uint32_t serial = (uint32_t)(id >> 32);

  return serial && bsearch(&serial, gone, n, sizeof serial, by_value);
}

/* Lists the ids on the fronts of this rank's voids whose pieces are gone. */
static vg_status list_claims(size_t n_gone, const uint32_t *gone, size_t n,
                             struct vg_node *const *node, const uint32_t *k,
                             struct claim **out, size_t *n_out,
                             struct vg_error *err)
{
  size_t cap = 0;

  for (size_t i = 0; i < n; i++)
    for (size_t v = 0; v < node[i]->front.n_point; v++) {
      uint64_t id = node[i]->front.id[v];

      if (!is_gone(n_gone, gone, id)) continue;
      if (vg_reserve(out, &cap, *n_out + 1, sizeof **out))
        return vg_fail_memory(err, "the global ids of points");
      (*out)[(*n_out)++] = (struct claim){ id, k[i] };
    }
  return VG_OK;
}

static int is_won(size_t n, const struct claim *all, uint64_t id, uint32_t k)
{
  const struct claim key = { id, k };
  const struct claim *at = bsearch(&key, all, n, sizeof key, by_claim);

  return at && (at == all || at[-1].id != id);
}

/* Moves the points that a front adopts behind the others, in their order, and
 * gives them the ids of the leaf's first own points. */
static vg_status adopt(struct vg_node *node, uint32_t k, size_t n_claim,
                       const struct claim *all, struct rename **map,
                       size_t *n_map, size_t *cap_map, struct vg_error *err)
{
  struct vg_front *f = &node->front;
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  double(*x)[3] = vg_alloc(f->n_point, sizeof *x);
  uint64_t *id = vg_alloc(f->n_point, sizeof *id);
  size_t n = 0, n_own = 0;
  vg_status st = VG_OK;

  if (!to || !x || !id) {
    st = vg_fail_memory(err, "the global ids of points");
    goto done;
  }
  for (int own = 0; own < 2; own++)
    for (size_t v = 0; v < f->n_point; v++) {
      if (is_won(n_claim, all, f->id[v], k) != own) continue;
      to[v] = (uint32_t)n;
      memcpy(x[n], f->x[v], sizeof *x);
      id[n] = f->id[v];
      if (own) {
        if (vg_reserve(map, cap_map, *n_map + 1, sizeof **map)) {
          st = vg_fail_memory(err, "the global ids of points");
          goto done;
        }
        id[n] = VG_POINT_ID(node->serial, n_own++);
        (*map)[(*n_map)++] = (struct rename){ f->id[v], id[n] };
      }
      n++;
    }
  memcpy(f->x, x, n * sizeof *x);
  memcpy(f->id, id, n * sizeof *id);
  for (size_t i = 0; i < f->n_face; i++)
    for (int j = 0; j < 3; j++) f->face[i][j] = to[f->face[i][j]];
done:
  free(to);
  free(x);
  free(id);
  return st;
}

static void rename_all(size_t n_map, const struct rename *map, size_t n_gone,
                       const uint32_t *gone, size_t n, uint64_t *id)
{
  for (size_t k = 0; k < n; k++) {
    const struct rename key = { id[k], 0 }, *at;

    if (!is_gone(n_gone, gone, id[k])) continue;
    at = bsearch(&key, map, n_map, sizeof key, by_from);
    if (at) id[k] = at->to;
  }
}

vg_status vg_recut_adopt(struct vg_partition *p, struct vg_comm *comm,
                         size_t n_own, const uint32_t *own, size_t n,
                         struct vg_node *const *node, const uint32_t *k,
                         struct vg_error *err)
{
  struct claim *claim = NULL, *all = NULL;
  struct rename *map = NULL, *every = NULL;
  uint32_t *gone = NULL;
  size_t n_gone, n_claim = 0, n_all = 0, n_map = 0, cap_map = 0, n_every = 0;
  vg_status st;

  assert((own || !n_own) && ((node && k) || !n));
  VG_TRY(
    gather(p, comm, n_own, sizeof *own, own, (void **)&gone, &n_gone, err));
  if (n_gone) qsort(gone, n_gone, sizeof *gone, by_value);
  st = list_claims(n_gone, gone, n, node, k, &claim, &n_claim, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(
    gather(p, comm, n_claim, sizeof *claim, claim, (void **)&all, &n_all, err));
  if (n_all) qsort(all, n_all, sizeof *all, by_claim);
  for (size_t i = 0; i < n && st == VG_OK; i++)
    st = adopt(node[i], k[i], n_all, all, &map, &n_map, &cap_map, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(
    gather(p, comm, n_map, sizeof *map, map, (void **)&every, &n_every, err));
  if (n_every) qsort(every, n_every, sizeof *every, by_from);
  for (size_t i = 0; i < p->n_piece; i++)
    rename_all(n_every, every, n_gone, gone, p->piece[i].n_in, p->piece[i].in);
  for (size_t i = 0; i < n; i++)
    rename_all(n_every, every, n_gone, gone, node[i]->front.n_point,
               node[i]->front.id);
done:
  free(claim);
  free(all);
  free(map);
  free(every);
  free(gone);
  return st;
}
