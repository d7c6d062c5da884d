/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "base/rendezvous.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/wide.h"

/* Number of items per part: they fit into the second-level cache, where they
 * are sorted into small buckets and compared. */
#define PART_ITEMS 4096
#define BUCKET_ITEMS 4
#define MOST_PARTS ((size_t)1 << 20)

/* Bytes of the first block of a list, and of the largest ones. */
#define LEAST_BLOCK ((size_t)1 << 14)
#define MOST_BLOCK ((size_t)1 << 23)

void *vg_items_add(struct vg_items *list, size_t size)
{
  assert(list && size > 0);
  if (vg_reserve(&list->data, &list->room, list->n + 1, size)) return NULL;
  return list->data + size * list->n++;
}

vg_status vg_items_append(struct vg_items *to, const struct vg_items *more,
                          size_t size, struct vg_error *err)
{
  assert(to && more && to != more && size > 0);
  if (!more->n) return VG_OK;
  if (vg_reserve(&to->data, &to->room, to->n + more->n, size))
    return vg_fail_memory(err, "the data shared by slices");
  memcpy(to->data + size * to->n, more->data, size * more->n);
  to->n += more->n;
  return VG_OK;
}

void vg_items_release(struct vg_items *list)
{
  free(list->data);
  memset(list, 0, sizeof *list);
}

/* --- lists in blocks ------------------------------------------------------ */

static struct vg_items *new_block(struct vg_item_blocks *list, size_t size)
{
  size_t bytes = LEAST_BLOCK;
  struct vg_items *b;

  for (size_t k = 0; k < list->n_block && bytes < MOST_BLOCK; k++) bytes *= 2;
  if (vg_reserve(&list->block, &list->room, list->n_block + 1,
                 sizeof *list->block))
    return NULL;
  b = &list->block[list->n_block];
  b->n = 0;
  b->room = bytes / size + 1;
  b->data = vg_alloc(b->room, size);
  if (!b->data) return NULL;
  list->n_block++;
  return b;
}

void *vg_item_blocks_add(struct vg_item_blocks *list, size_t size)
{
  assert(list && size > 0);

  struct vg_items *b = list->n_block ? &list->block[list->n_block - 1] : NULL;

  if (!b || b->n == b->room) b = new_block(list, size);
  return b ? b->data + size * b->n++ : NULL;
}

size_t vg_item_blocks_n(const struct vg_item_blocks *list)
{
  size_t n = 0;

  assert(list);
  for (size_t k = 0; k < list->n_block; k++) n += list->block[k].n;
  return n;
}

vg_status vg_item_blocks_join(struct vg_item_blocks *to,
                              struct vg_item_blocks *more, struct vg_error *err)
{
  assert(to && more && to != more);
  if (!more->n_block) return VG_OK;
  if (vg_reserve(&to->block, &to->room, to->n_block + more->n_block,
                 sizeof *to->block))
    return vg_fail_memory(err, "the data shared by slices");
  memcpy(to->block + to->n_block, more->block,
         more->n_block * sizeof *more->block);
  to->n_block += more->n_block;
  more->n_block = 0;
  return VG_OK;
}

void vg_item_blocks_release(struct vg_item_blocks *list)
{
  for (size_t k = 0; k < list->n_block; k++) vg_items_release(&list->block[k]);
  free(list->block);
  memset(list, 0, sizeof *list);
}

/* Ranks, parts and buckets are selected by different bits of the hash: the
 * upper half, the lower 20 and the next 12. */
static int rank_of(uint64_t h, int size)
{
  return (int)((h >> 32) * (uint64_t)size >> 32);
}

int vg_rendezvous_rank(const struct vg_rendezvous *m, const void *key)
{
  assert(m->key > 0 && m->key % 4 == 0 && key);
  return rank_of(vg_rendezvous_hash(key, m->key), vg_comm_size(m->comm));
}

/* --- counting sort ------------------------------------------------------- */

/* Loops over items are compiled with constant sizes of items and keys for the
 * items that are most frequent: in the mesh check, keys of positions and faces.
 * `call` is a call with the arguments `size` and `key`. */
#define WITH_SIZES(m, call)                                                    \
  do {                                                                         \
    if ((m)->size == 8 && (m)->key == 8) {                                     \
      const size_t size = 8, key = 8;                                          \
      call;                                                                    \
    } else if ((m)->size == 28 && (m)->key == 16) {                            \
      const size_t size = 28, key = 16;                                        \
      call;                                                                    \
    } else {                                                                   \
      const size_t size = (m)->size, key = (m)->key;                           \
      call;                                                                    \
    }                                                                          \
  } while (0)

/* Items of several sources to be sorted by bin. */
struct sorting {
  const struct vg_rendezvous *m;
  int by_rank;           /* 1: a bin is a rank; 0: a part */
  struct vg_bytes *from; /* [n_from] */
  size_t n_from, n_bin;
  size_t *at; /* [n_from][n_bin + 1] offsets of the bins, the first 0 */
};

VG_WITHIN size_t bin_of(const struct sorting *s, const unsigned char *item,
                        size_t key)
{
  uint64_t h = vg_rendezvous_hash(item, key);

  return s->by_rank ? (size_t)rank_of(h, (int)s->n_bin)
                    : (size_t)h & (s->n_bin - 1);
}

/* Add the number of items in each bin to at[bin + 1]. */
VG_WITHIN void count_items(const struct sorting *s, const struct vg_bytes *from,
                           size_t *at, size_t size, size_t key)
{
  for (size_t i = 0; i < from->n; i += size)
    at[bin_of(s, from->data + i, key) + 1]++;
}

/* Compute where each bin begins in each source after sorting. */
static void count_sources(void *context, size_t first, size_t end, int worker)
{
  const struct sorting *s = context;

  (void)worker;
  for (size_t r = first; r < end; r++) {
    size_t *at = s->at + r * (s->n_bin + 1);

    WITH_SIZES(s->m, count_items(s, &s->from[r], at, size, key));
    for (size_t b = 0; b < s->n_bin; b++) at[b + 1] += at[b];
  }
}

VG_WITHIN void swap_items(unsigned char *a, unsigned char *b, size_t size)
{
  for (size_t i = 0; i < size; i += sizeof(uint32_t)) {
    uint32_t x, y;

    memcpy(&x, a + i, sizeof x);
    memcpy(&y, b + i, sizeof y);
    memcpy(a + i, &y, sizeof y);
    memcpy(b + i, &x, sizeof x);
  }
}

/* Groups of 2^shift bins, from bin `low` on. next, end: [n] item offsets */
struct groups {
  size_t low, n, *next;
  const size_t *end;
  unsigned shift;
};

/* Sort the items of the groups in place: every swap moves one item to its
 * group. */
VG_WITHIN void order_items(const struct sorting *s, unsigned char *item,
                           const struct groups *g, size_t size, size_t key)
{
  for (size_t k = 0; k < g->n; k++)
    while (g->next[k] < g->end[k]) {
      unsigned char *here = item + size * g->next[k];
      size_t to = (bin_of(s, here, key) - g->low) >> g->shift;
      size_t at = g->next[to]++;

      if (to != k) swap_items(here, item + size * at, size);
    }
}

static void order_groups(const struct sorting *s, unsigned char *item,
                         const struct groups *g)
{
  WITH_SIZES(s->m, order_items(s, item, g, size, key));
}

/* Sort the items of a source by bin, first by groups of bins, so that each
 * group then stays in the caches. next, end: [n_bin] */
static void order_source(const struct sorting *s, size_t r, size_t *next,
                         size_t *end)
{
  const size_t *at = s->at + r * (s->n_bin + 1);
  unsigned shift = 0;
  size_t width, n_group;

  while ((size_t)1 << 2 * shift < s->n_bin) shift++;
  width = (size_t)1 << shift;
  n_group = (s->n_bin - 1) / width + 1;
  for (size_t g = 0, b = 0; g < n_group; g++) {
    next[g] = at[b];
    b = b + width < s->n_bin ? b + width : s->n_bin;
    end[g] = at[b];
  }
  order_groups(s, s->from[r].data,
               &(struct groups){ 0, n_group, next, end, shift });
  memcpy(next, at, s->n_bin * sizeof *next);
  for (size_t b = 0; b < s->n_bin; b += width) {
    size_t n = s->n_bin - b < width ? s->n_bin - b : width;

    order_groups(s, s->from[r].data,
                 &(struct groups){ b, n, next + b, at + b + 1, 0 });
  }
}

struct ordering {
  const struct sorting *s;
  atomic_int refused;
};

static void order_sources(void *context, size_t first, size_t end, int worker)
{
  struct ordering *o = context;
  size_t *next = vg_alloc(o->s->n_bin, sizeof *next);
  size_t *limit = vg_alloc(o->s->n_bin, sizeof *limit);

  (void)worker;
  if (!next || !limit) atomic_store(&o->refused, 1);
  else
    for (size_t r = first; r < end; r++) order_source(o->s, r, next, limit);
  free(next);
  free(limit);
}

static vg_status sort_items(struct sorting *s, struct vg_error *err)
{
  struct ordering o = { .s = s };

  s->at = vg_calloc(s->n_from, (s->n_bin + 1) * sizeof *s->at);
  if (!s->at) return vg_fail_memory(err, "the data shared by slices");
  vg_parallel_for(s->m->threads, s->n_from, 1, count_sources, s);
  vg_parallel_for(s->m->threads, s->n_from, 1, order_sources, &o);
  if (atomic_load(&o.refused))
    return vg_fail_memory(err, "the data shared by slices");
  return VG_OK;
}

/* --- exchange between ranks ---------------------------------------------- */

static void release(struct vg_bytes *b, size_t n)
{
  for (size_t i = 0; b && i < n; i++) free(b[i].data);
  free(b);
}

/* Concatenate, for each rank, the data that the sources have for it, in
 * *all. */
static vg_status join_sources(struct sorting *s, struct vg_bytes *to,
                              unsigned char **all, struct vg_error *err)
{
  size_t size = s->m->size, n = 0;

  for (size_t r = 0; r < s->n_from; r++) n += s->from[r].n;
  *all = vg_alloc(n, 1);
  if (!*all) return vg_fail_memory(err, "the data shared by slices");
  n = 0;
  for (size_t b = 0; b < s->n_bin; b++) {
    to[b].data = *all + n;
    for (size_t r = 0; r < s->n_from; r++) {
      const size_t *at = s->at + r * (s->n_bin + 1) + b;
      size_t bytes = size * (at[1] - at[0]);

      if (bytes) memcpy(*all + n, s->from[r].data + size * at[0], bytes);
      n += bytes;
    }
    to[b].n = (size_t)(*all + n - to[b].data);
  }
  return VG_OK;
}

/* Exchange the items. *out: [size] lists that this rank received. */
static vg_status send(const struct vg_rendezvous *m, struct vg_bytes *list,
                      size_t n_list, struct vg_bytes **out,
                      struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(m->comm);
  struct sorting s = {
    .m = m, .by_rank = 1, .from = list, .n_from = n_list, .n_bin = size
  };
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  unsigned char *all = NULL;
  vg_status st = VG_OK;

  if (!to || !from || !list)
    st = vg_fail_memory(err, "the data shared by slices");
  if (st >= 0) st = sort_items(&s, err);
  if (st >= 0) st = join_sources(&s, to, &all, err);
  VG_TRY(vg_comm_agree(m->comm, st, err));
  VG_TRY(vg_comm_exchange(m->comm, to, from, err));
  *out = from;
  from = NULL;
done:
  free(s.at);
  free(all);
  free(to);
  release(from, size);
  return st;
}

/* --- matching on the receiving rank -------------------------------------- */

struct hall {
  const struct vg_rendezvous *m;
  struct sorting s; /* sorts items by part; the number of parts is a power of
                       two */
  size_t most;      /* number of items of the largest part */
  /* NULL, or [threads]: lists for groups that are not complete */
  struct vg_item_blocks *left;
  int first_worker; /* number of the first thread for m->group */
  atomic_int refused;
};

VG_WITHIN size_t bucket_of(const unsigned char *item, size_t n_bucket,
                           size_t key)
{
  return (size_t)(vg_rendezvous_hash(item, key) >> 20) & (n_bucket - 1);
}

/* An arbitrary total order of keys of n bytes. */
VG_WITHIN int key_order(const unsigned char *a, const unsigned char *b,
                        size_t n)
{
  for (size_t i = 0; i < n; i += sizeof(uint32_t)) {
    uint32_t x, y;

    memcpy(&x, a + i, sizeof x);
    memcpy(&y, b + i, sizeof y);
    if (x != y) return x < y ? -1 : 1;
  }
  return 0;
}

/* Insertion sort by key. Items with equal keys are not moved, so that many
 * equal keys cost nothing extra. */
VG_WITHIN void sort_bucket(unsigned char *item, size_t n, unsigned char *spare,
                           size_t size, size_t key)
{
  for (size_t i = 1; i < n; i++) {
    size_t j = i;

    while (j && key_order(item + size * (j - 1), item + size * i, key) > 0) j--;
    if (j == i) continue;
    memcpy(spare, item + size * i, size);
    memmove(item + size * (j + 1), item + size * j, size * (i - j));
    memcpy(item + size * j, spare, size);
  }
}

static void inspect(struct hall *h, const unsigned char *item, size_t n,
                    int worker)
{
  const struct vg_rendezvous *m = h->m;

  if (!h->left || m->is_whole(m->context, item, n)) {
    m->group(m->context, item, n, h->first_worker + worker);
    return;
  }
  for (size_t i = 0; i < n; i++) {
    unsigned char *to = vg_item_blocks_add(&h->left[worker], m->size);

    if (to) memcpy(to, item + m->size * i, m->size);
    else atomic_store(&h->refused, 1);
  }
}

VG_WITHIN void inspect_all(struct hall *h, const unsigned char *item, size_t n,
                           int worker, size_t size, size_t key)
{
  for (size_t i = 0, j; i < n; i = j) {
    const unsigned char *first = item + size * i;

    for (j = i + 1; j < n; j++)
      if (key_order(first, item + size * j, key)) break;
    inspect(h, first, j - i, worker);
  }
}

/* Begin and end of the part's items in a source. */
static const unsigned char *part_of(const struct hall *h, size_t r, size_t p,
                                    const unsigned char **end)
{
  const size_t *at = h->s.at + r * (h->s.n_bin + 1) + p;
  const unsigned char *item = h->s.from[r].data;

  if (!item) return *end = NULL;
  *end = item + h->m->size * at[1];
  return item + h->m->size * at[0];
}

/* Copy the items of a part into `room`, sorted by bucket. On return, each
 * bucket [n_bucket] holds the end of its items. */
VG_WITHIN void fill_buckets(const struct hall *h, size_t p, unsigned char *room,
                            size_t *bucket, size_t n_bucket, size_t size,
                            size_t key)
{
  size_t at = 0;
  const unsigned char *item, *end;

  memset(bucket, 0, n_bucket * sizeof *bucket);
  for (size_t r = 0; r < h->s.n_from; r++)
    for (item = part_of(h, r, p, &end); item < end; item += size)
      bucket[bucket_of(item, n_bucket, key)]++;
  for (size_t b = 0; b < n_bucket; b++) {
    size_t count = bucket[b];

    bucket[b] = at;
    at += count;
  }
  for (size_t r = 0; r < h->s.n_from; r++)
    for (item = part_of(h, r, p, &end); item < end; item += size)
      memcpy(room + size * bucket[bucket_of(item, n_bucket, key)]++, item,
             size);
}

/* Process a part. room: space for the largest part and one more item; bucket:
 * [n_bucket]. */
VG_WITHIN void meet_part(struct hall *h, size_t p, unsigned char *room,
                         size_t *bucket, size_t n_bucket, int worker,
                         size_t size, size_t key)
{
  fill_buckets(h, p, room, bucket, n_bucket, size, key);
  for (size_t b = 0; b < n_bucket; b++) {
    size_t begin = b ? bucket[b - 1] : 0, n = bucket[b] - begin;

    sort_bucket(room + size * begin, n, room + size * h->most, size, key);
    inspect_all(h, room + size * begin, n, worker, size, key);
  }
}

static void meet_parts(void *context, size_t first, size_t end, int worker)
{
  struct hall *h = context;
  size_t n_bucket = PART_ITEMS / BUCKET_ITEMS;
  unsigned char *room = vg_alloc(h->most + 1, h->m->size);
  size_t *bucket = vg_alloc(n_bucket, sizeof *bucket);

  if (!room || !bucket) atomic_store(&h->refused, 1);
  else
    for (size_t p = first; p < end; p++)
      WITH_SIZES(h->m,
                 meet_part(h, p, room, bucket, n_bucket, worker, size, key));
  free(room);
  free(bucket);
}

static vg_status meet_here(const struct vg_rendezvous *m, struct vg_bytes *from,
                           size_t n_from, struct vg_item_blocks *left,
                           int first_worker, struct vg_error *err)
{
  struct hall h = { .m = m,
                    .left = left,
                    .first_worker = first_worker,
                    .s = {
                      .m = m, .from = from, .n_from = n_from, .n_bin = 1 } };
  size_t n = 0;
  vg_status st;

  for (size_t r = 0; r < n_from; r++) n += from[r].n / m->size;
  while (h.s.n_bin < MOST_PARTS && h.s.n_bin * PART_ITEMS < n) h.s.n_bin *= 2;
  VG_TRY(sort_items(&h.s, err));
  for (size_t p = 0; p < h.s.n_bin; p++) {
    size_t count = 0;

    for (size_t r = 0; r < n_from; r++) {
      const size_t *at = h.s.at + r * (h.s.n_bin + 1) + p;

      count += at[1] - at[0];
    }
    if (count > h.most) h.most = count;
  }
  vg_parallel_for(m->threads, h.s.n_bin, 8, meet_parts, &h);
  if (atomic_load(&h.refused))
    st = vg_fail_memory(err, "the data shared by slices");
done:
  free(h.s.at);
  return st;
}

/* Take over the memory of the lists as sources; NULL if there is not enough
 * memory. */
static struct vg_bytes *take_lists(const struct vg_rendezvous *m,
                                   struct vg_items *list, size_t n_list,
                                   size_t stride)
{
  struct vg_bytes *from = vg_calloc(n_list, sizeof *from);

  for (size_t l = 0; l < n_list; l++) {
    struct vg_items *one = (void *)((unsigned char *)list + l * stride);

    if (from) from[l] = (struct vg_bytes){ one->n * m->size, one->data };
    else free(one->data);
    memset(one, 0, sizeof *one);
  }
  return from;
}

/* The same for lists in blocks; *n_from out: number of blocks. */
static struct vg_bytes *take_blocks(const struct vg_rendezvous *m,
                                    struct vg_item_blocks *list, size_t n_list,
                                    size_t *n_from)
{
  struct vg_bytes *from;
  size_t n = 0;

  for (size_t l = 0; l < n_list; l++) n += list[l].n_block;
  from = vg_calloc(n, sizeof *from);
  *n_from = from ? n : 0;
  for (size_t l = 0, at = 0; l < n_list; l++) {
    for (size_t k = 0; from && k < list[l].n_block; k++, at++) {
      struct vg_items *b = &list[l].block[k];

      from[at] = (struct vg_bytes){ b->n * m->size, b->data };
      b->data = NULL;
    }
    vg_item_blocks_release(&list[l]);
  }
  return from;
}

vg_status vg_rendezvous_thin(const struct vg_rendezvous *m, int worker,
                             struct vg_item_blocks *list, struct vg_error *err)
{
  assert(m->is_whole && worker >= 0 && list);

  struct vg_rendezvous one = *m;
  size_t n_from;
  struct vg_bytes *from = take_blocks(m, list, 1, &n_from);
  vg_status st;

  one.threads = 1;
  st = from ? meet_here(&one, from, n_from, list, worker, err)
            : vg_fail_memory(err, "the data shared by slices");
  release(from, n_from);
  if (st < 0) vg_item_blocks_release(list);
  return st;
}

/* Process the groups that are complete on this rank. *from, *n_from: the items
 * of the other groups. Local. */
static vg_status meet_first(const struct vg_rendezvous *m,
                            struct vg_bytes **from, size_t *n_from,
                            struct vg_error *err)
{
  size_t n = (size_t)(m->threads > 0 ? m->threads : 1);
  struct vg_item_blocks *left = vg_calloc(n, sizeof *left);
  struct vg_rendezvous one = *m;
  vg_status st = *from && left
                 ? VG_OK
                 : vg_fail_memory(err, "the data shared by slices");

  one.threads = (int)n;
  if (st >= 0) st = meet_here(&one, *from, *n_from, left, 0, err);
  release(*from, *n_from);
  *from = NULL;
  *n_from = 0;
  if (left) *from = take_blocks(m, left, n, n_from);
  if (st >= 0 && !*from) st = vg_fail_memory(err, "the data shared by slices");
  free(left);
  return st;
}

vg_status vg_rendezvous_run(const struct vg_rendezvous *m,
                            struct vg_items *list, size_t n_list, size_t stride,
                            struct vg_error *err)
{
  assert(m->group && m->threads >= 0);
  assert(m->key > 0 && m->key <= m->size);
  assert(m->key % 4 == 0 && m->size % 4 == 0);
  assert(list || !n_list);
  assert(stride >= sizeof *list && stride % _Alignof(struct vg_items) == 0);

  struct vg_bytes *from = take_lists(m, list, n_list, stride), *got = NULL;
  size_t n_from = n_list;
  vg_status st = VG_OK;

  if (vg_comm_size(m->comm) > 1) {
    if (m->is_whole) st = meet_first(m, &from, &n_from, err);
    VG_TRY(vg_comm_agree(m->comm, st, err));
    VG_TRY(send(m, from, n_from, &got, err));
    release(from, n_from);
    from = got;
    n_from = (size_t)vg_comm_size(m->comm);
  }
  st = from ? meet_here(m, from, n_from, NULL, 0, err)
            : vg_fail_memory(err, "the data shared by slices");
  st = vg_comm_agree(m->comm, st, err);
done:
  release(from, n_from);
  return st;
}

/* Moves the blocks of all lists to *all, which has space for them. */
static void join_blocks(struct vg_item_blocks *list, size_t n_list,
                        size_t stride, struct vg_item_blocks *all)
{
  for (size_t l = 0; l < n_list; l++) {
    struct vg_item_blocks *one = (void *)((unsigned char *)list + l * stride);

    if (one->n_block)
      memcpy(all->block + all->n_block, one->block,
             one->n_block * sizeof *one->block);
    all->n_block += one->n_block;
    one->n_block = 0;
    vg_item_blocks_release(one);
  }
}

vg_status vg_rendezvous_blocks(const struct vg_rendezvous *m,
                               struct vg_item_blocks *list, size_t n_list,
                               size_t stride, struct vg_error *err)
{
  assert(list || !n_list);
  assert(stride >= sizeof *list &&
         stride % _Alignof(struct vg_item_blocks) == 0);

  struct vg_item_blocks all = { 0 };
  vg_status st = VG_OK;

  for (size_t l = 0; l < n_list; l++)
    all.room += ((struct vg_item_blocks *)(void *)((unsigned char *)list +
                                                   l * stride))
                  ->n_block;
  all.block = vg_calloc(all.room, sizeof *all.block);
  if (all.block) join_blocks(list, n_list, stride, &all);
  else st = vg_fail_memory(err, "the data shared by slices");
  VG_TRY(vg_comm_agree(m->comm, st, err));
  st = vg_rendezvous_run(m, all.block, all.n_block, sizeof *all.block, err);
done:
  vg_item_blocks_release(&all);
  return st;
}

/* --- items that wait ------------------------------------------------------ */

void vg_waiting_items_init(struct vg_waiting_items *w, size_t limit)
{
  assert(w);
  memset(w, 0, sizeof *w);
  pthread_mutex_init(&w->lock, NULL);
  w->limit = limit;
}

void vg_waiting_items_release(struct vg_waiting_items *w)
{
  vg_item_blocks_release(&w->items);
  pthread_mutex_destroy(&w->lock);
}

vg_status vg_waiting_items_add(struct vg_waiting_items *w,
                               struct vg_item_blocks *list,
                               struct vg_item_blocks *taken,
                               struct vg_error *err)
{
  size_t n;
  vg_status st;

  assert(w && list && taken);
  memset(taken, 0, sizeof *taken);
  pthread_mutex_lock(&w->lock);
  st = vg_item_blocks_join(&w->items, list, err);
  n = vg_item_blocks_n(&w->items);
  if (n > w->most) w->most = n;
  if (st >= 0 && !w->is_taken && n > w->limit) {
    w->is_taken = 1;
    *taken = w->items;
    memset(&w->items, 0, sizeof w->items);
  }
  pthread_mutex_unlock(&w->lock);
  return st;
}

vg_status vg_waiting_items_return(struct vg_waiting_items *w,
                                  struct vg_item_blocks *list,
                                  struct vg_error *err)
{
  size_t n = vg_item_blocks_n(list);
  vg_status st;

  pthread_mutex_lock(&w->lock);
  assert(w->is_taken);
  if (2 * n > w->limit) w->limit = 2 * n;
  st = vg_item_blocks_join(&w->items, list, err);
  w->is_taken = 0;
  pthread_mutex_unlock(&w->lock);
  vg_item_blocks_release(list);
  return st;
}
