#include "core/judge_meet.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

/* Items of a part fit the second-level cache; in it they are put into buckets
 * of few and compared. */
#define PART_ITEMS 4096
#define BUCKET_ITEMS 4
#define MOST_PARTS ((size_t)1 << 20)

void *vg_items_add(struct vg_items *list, size_t size)
{
  if (vg_reserve(&list->data, &list->room, list->n + 1, size)) return NULL;
  return list->data + size * list->n++;
}

void vg_items_release(struct vg_items *list)
{
  free(list->data);
  memset(list, 0, sizeof *list);
}

static uint64_t hash(const void *key, size_t n)
{
  uint64_t h = n;

  for (size_t i = 0; i < n; i += sizeof(uint32_t)) {
    uint32_t word;

    memcpy(&word, (const unsigned char *)key + i, sizeof word);
    h = (h ^ word) * UINT64_C(0x9E3779B97F4A7C15);
    h ^= h >> 32;
  }
  h *= UINT64_C(0xD6E8FEB86659FD93);
  return h ^ h >> 32;
}

/* Ranks, parts and buckets are named by different bits of the hash: upper
 * half, lower 20, the next 12. */
static int rank_of(uint64_t h, int size)
{
  return (int)((h >> 32) * (uint64_t)size >> 32);
}

int vg_meet_rank(const struct vg_meeting *m, const void *key)
{
  return rank_of(hash(key, m->key), vg_comm_size(m->comm));
}

static struct vg_items *list_at(struct vg_items *list, size_t i,
                                size_t stride)
{
  return (struct vg_items *)(void *)((unsigned char *)list + i * stride);
}

/* --- to their ranks ------------------------------------------------------ */

static vg_status pack(const struct vg_meeting *m, struct vg_items *list,
                      size_t n_list, size_t stride, struct vg_bytes *to,
                      struct vg_error *err)
{
  int size = vg_comm_size(m->comm);

  for (size_t l = 0; l < n_list; l++) {
    const struct vg_items *from = list_at(list, l, stride);

    for (size_t i = 0; i < from->n; i++)
      to[rank_of(hash(from->data + i * m->size, m->key), size)].n += m->size;
  }
  for (int r = 0; r < size; r++) {
    to[r].data = vg_alloc(to[r].n, 1);
    if (!to[r].data) return vg_fail_memory(err, "what slices share");
    to[r].n = 0;
  }
  for (size_t l = 0; l < n_list; l++) {
    struct vg_items *from = list_at(list, l, stride);

    for (size_t i = 0; i < from->n; i++) {
      const unsigned char *item = from->data + i * m->size;
      struct vg_bytes *b = &to[rank_of(hash(item, m->key), size)];

      memcpy(b->data + b->n, item, m->size);
      b->n += m->size;
    }
    vg_items_release(from);
  }
  return VG_OK;
}

static void release(struct vg_bytes *b, size_t n)
{
  for (size_t i = 0; b && i < n; i++) free(b[i].data);
  free(b);
}

/* *out: [size], what all ranks had for this one. */
static vg_status send(const struct vg_meeting *m, struct vg_items *list,
                      size_t n_list, size_t stride, struct vg_bytes **out,
                      struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(m->comm);
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = VG_OK;

  if (!to || !from) st = vg_fail_memory(err, "what slices share");
  else st = pack(m, list, n_list, stride, to, err);
  VG_TRY(vg_comm_agree(m->comm, st, err));
  VG_TRY(vg_comm_exchange(m->comm, to, from, err));
  *out = from;
  from = NULL;
done:
  release(to, size);
  release(from, size);
  return st;
}

/* --- on their rank ------------------------------------------------------- */

struct hall {
  const struct vg_meeting *m;
  unsigned char *item;       /* by part */
  size_t *end;               /* [n_part] */
  size_t n_part, most;       /* a power of two; items of the largest part */
  atomic_int refused;
};

static size_t part_of(const struct hall *h, const unsigned char *item)
{
  return (size_t)hash(item, h->m->key) & (h->n_part - 1);
}

static vg_status make_parts(struct hall *h, size_t n, struct vg_error *err)
{
  h->n_part = 1;
  while (h->n_part < MOST_PARTS && h->n_part * PART_ITEMS < n) h->n_part *= 2;
  h->end = vg_calloc(h->n_part, sizeof *h->end);
  h->item = vg_alloc(n, h->m->size);
  if (!h->end || !h->item) return vg_fail_memory(err, "what slices share");
  return VG_OK;
}

/* Counting sort by part; the sources are freed as they are done with. */
static vg_status gather(struct hall *h, struct vg_bytes *from, size_t n_from,
                        struct vg_error *err)
{
  size_t size = h->m->size, n = 0, at = 0;
  vg_status st;

  for (size_t r = 0; r < n_from; r++) n += from[r].n / size;
  st = make_parts(h, n, err);
  if (st < 0) return st;
  for (size_t r = 0; r < n_from; r++)
    for (size_t i = 0; i < from[r].n; i += size)
      h->end[part_of(h, from[r].data + i)]++;
  for (size_t p = 0; p < h->n_part; p++) {
    size_t count = h->end[p];

    if (count > h->most) h->most = count;
    h->end[p] = at;
    at += count;
  }
  for (size_t r = 0; r < n_from; r++) {
    for (size_t i = 0; i < from[r].n; i += size) {
      const unsigned char *item = from[r].data + i;

      memcpy(h->item + size * h->end[part_of(h, item)]++, item, size);
    }
    free(from[r].data);
    from[r].data = NULL;
    from[r].n = 0;
  }
  return VG_OK;
}

static size_t bucket_of(const struct hall *h, const unsigned char *item,
                        size_t n_bucket)
{
  return (size_t)(hash(item, h->m->key) >> 20) & (n_bucket - 1);
}

/* Insertion by key; equal keys stay where they are, so that a crowd of them
 * is no trouble. */
static void sort_bucket(const struct vg_meeting *m, unsigned char *item,
                        size_t n, unsigned char *spare)
{
  size_t size = m->size;

  for (size_t i = 1; i < n; i++) {
    size_t j = i;

    while (j && memcmp(item + size * (j - 1), item + size * i, m->key) > 0)
      j--;
    if (j == i) continue;
    memcpy(spare, item + size * i, size);
    memmove(item + size * (j + 1), item + size * j, size * (i - j));
    memcpy(item + size * j, spare, size);
  }
}

static void call_groups(const struct vg_meeting *m, const unsigned char *item,
                        size_t n, int worker)
{
  for (size_t i = 0, j; i < n; i = j) {
    const unsigned char *first = item + m->size * i;

    for (j = i + 1; j < n; j++)
      if (memcmp(first, item + m->size * j, m->key)) break;
    m->group(m->context, first, j - i, worker);
  }
}

/* room: of the largest part and one item; bucket: [n_bucket]. */
static void meet_part(const struct hall *h, size_t p, unsigned char *room,
                      size_t *bucket, size_t n_bucket, int worker)
{
  size_t size = h->m->size, first = p ? h->end[p - 1] : 0;
  size_t n = h->end[p] - first, at = 0;
  const unsigned char *item = h->item + size * first;

  memset(bucket, 0, n_bucket * sizeof *bucket);
  for (size_t i = 0; i < n; i++)
    bucket[bucket_of(h, item + size * i, n_bucket)]++;
  for (size_t b = 0; b < n_bucket; b++) {
    size_t count = bucket[b];

    bucket[b] = at;
    at += count;
  }
  for (size_t i = 0; i < n; i++) {
    size_t b = bucket_of(h, item + size * i, n_bucket);

    memcpy(room + size * bucket[b]++, item + size * i, size);
  }
  for (size_t b = 0; b < n_bucket; b++) {
    size_t begin = b ? bucket[b - 1] : 0;

    sort_bucket(h->m, room + size * begin, bucket[b] - begin,
                room + size * h->most);
    call_groups(h->m, room + size * begin, bucket[b] - begin, worker);
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
      meet_part(h, p, room, bucket, n_bucket, worker);
  free(room);
  free(bucket);
}

static vg_status meet_here(const struct vg_meeting *m, struct vg_bytes *from,
                           size_t n_from, struct vg_error *err)
{
  struct hall h = { .m = m };
  vg_status st;

  VG_TRY(gather(&h, from, n_from, err));
  vg_parallel_for(m->threads, h.n_part, 8, meet_parts, &h);
  if (atomic_load(&h.refused)) st = vg_fail_memory(err, "what slices share");
done:
  free(h.item);
  free(h.end);
  return st;
}

vg_status vg_meet(const struct vg_meeting *m, struct vg_items *list,
                  size_t n_list, size_t stride, struct vg_error *err)
{
  size_t n_from = (size_t)vg_comm_size(m->comm);
  struct vg_bytes *from = NULL;
  vg_status st = VG_OK;

  if (n_from > 1) {
    VG_TRY(send(m, list, n_list, stride, &from, err));
  } else {             /* the lists are what there is to be gathered */
    n_from = n_list;
    from = vg_calloc(n_list, sizeof *from);
    for (size_t l = 0; from && l < n_list; l++) {
      struct vg_items *one = list_at(list, l, stride);

      from[l] = (struct vg_bytes){ one->n * m->size, one->data };
      memset(one, 0, sizeof *one);
    }
  }
  st = from ? meet_here(m, from, n_from, err)
            : vg_fail_memory(err, "what slices share");
  st = vg_comm_agree(m->comm, st, err);
done:
  release(from, n_from);
  for (size_t l = 0; l < n_list; l++)
    vg_items_release(list_at(list, l, stride));
  return st;
}
