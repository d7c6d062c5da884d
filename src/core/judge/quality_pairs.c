/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matching of the faces of tetrahedra in the order of the cells.
 *
 * A face waits in a hash table until its other side arrives, and then leaves
 * the table. Cells are written in an order in which neighbours follow each
 * other closely, so that few faces wait at a time and the table stays in the
 * cache. In a column of layer cells, each cell shares a face with the next
 * one, and these faces are not entered in the table at all. This takes less
 * than two thirds of the time of quality_faces.c, which collects all sides of
 * a face.
 *
 * Items cannot be removed from a table of base/table.h. For 2,076,831
 * tetrahedra of a wing, it would need 67 MB of slots for 4.2 million faces;
 * these buckets take 2.1 MB.
 *
 * A face with four sides, two on each side, is not detected. But if all cells
 * are positive and all faces leave in pairs of opposite sides, the cells cover
 * each position equally often. The mesh then has a multiple of the volume
 * enclosed by its boundary, which is detected. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "base/union_find.h"
#include "core/judge/quality_parts.h"

#define VACANT UINT64_MAX
#define FIRST_BITS 10
#define SLOTS 4

/* Number of tetrahedra whose faces are prefetched from memory. */
#define AHEAD 16

struct face {
  uint64_t key; /* lowest node << 32 | second node */
  uint32_t high, owner;
};

/* Waiting faces that share a cache line. */
struct bucket {
  uint64_t key[SLOTS];   /* lowest node << 32 | second node; or VACANT */
  uint32_t high[SLOTS];  /* highest node */
  uint32_t owner[SLOTS]; /* 2 * (cell, or n_cell + boundary face) + side */
};

struct pairing {
  const struct vg_mesh *m;
  const float *volume;
  struct vg_stats *f;
  uint32_t *parent; /* [n_cell] components */
  size_t n_cell;
  size_t n, mask; /* number of waiting faces; number of buckets - 1 */
  unsigned shift;
  struct bucket *bucket;
  uint8_t *is_over;    /* [buckets] 1: a face overflowed to the next bucket */
  int refused, is_odd; /* memory was refused; two boundary faces matched */
};

static size_t home(const struct pairing *p, uint64_t key, uint32_t high)
{
  struct vg_tri_key k = { key, high };

  return (size_t)(vg_tri_key_hash(k) >> p->shift);
}

static int make_buckets(struct pairing *p, unsigned bits)
{
  size_t n = (size_t)1 << bits;

  p->bucket = vg_alloc(n, sizeof *p->bucket);
  p->is_over = vg_calloc(n, 1);
  if (!p->bucket || !p->is_over) return 0;
  memset(p->bucket, 0xff, n * sizeof *p->bucket);
  p->mask = n - 1;
  p->shift = 64 - bits;
  return 1;
}

/* Bit k: slot k has this key. */
static unsigned keyed(const struct bucket *b, uint64_t key)
{
  unsigned found = 0;

  for (unsigned k = 0; k < SLOTS; k++)
    found |= (unsigned)(b->key[k] == key) << k;
  return found;
}

static unsigned matching_slots(const struct bucket *b, uint64_t key,
                               uint32_t high)
{
  unsigned found = 0;

  for (unsigned k = 0; k < SLOTS; k++)
    found |= (unsigned)((b->key[k] == key) & (b->high[k] == high)) << k;
  return found;
}

static void wait_at(struct pairing *p, size_t i, const struct face *f)
{
  unsigned vacant;

  while (!(vacant = keyed(&p->bucket[i], VACANT))) {
    p->is_over[i] = 1;
    i = (i + 1) & p->mask;
  }
  vacant = (unsigned)__builtin_ctz(vacant);
  p->bucket[i].key[vacant] = f->key;
  p->bucket[i].high[vacant] = f->high;
  p->bucket[i].owner[vacant] = f->owner;
}

/* Double the number of buckets, so that at most half of the slots are used. */
static void grow(struct pairing *p)
{
  struct bucket *old = p->bucket;
  uint8_t *over = p->is_over;
  size_t n = p->mask + 1;

  if (!make_buckets(p, 65 - p->shift)) p->refused = 1;
  for (size_t i = 0; i < n && !p->refused; i++)
    for (unsigned k = 0; k < SLOTS; k++) {
      struct face f = { old[i].key[k], old[i].high[k], old[i].owner[k] };

      if (f.key != VACANT) wait_at(p, home(p, f.key, f.high), &f);
    }
  free(old);
  free(over);
}

static void meet(struct pairing *p, uint32_t first, uint32_t second)
{
  int same_side = (first & 1) == (second & 1);
  uint32_t a = first >> 1, b = second >> 1;
  size_t n_boundary = (size_t)(a >= p->n_cell) + (b >= p->n_cell);

  p->is_odd |= n_boundary > 1;
  if (!vg_stats_face(p->f, 2 - n_boundary, n_boundary, same_side)) return;
  vg_union(p->parent, a, b);
  vg_stats_ratio(p->f, p->volume[a], p->volume[b]);
}

static void add_face(struct pairing *p, const struct face *f)
{
  size_t first = home(p, f->key, f->high), i = first;
  unsigned found;

  while (!(found = matching_slots(&p->bucket[i], f->key, f->high)) &&
         p->is_over[i])
    i = (i + 1) & p->mask;
  if (found) {
    found = (unsigned)__builtin_ctz(found);
    p->bucket[i].key[found] = VACANT;
    p->n--;
    meet(p, p->bucket[i].owner[found], f->owner);
    return;
  }
  wait_at(p, first, f);
  if (++p->n > p->mask * (SLOTS / 2)) grow(p);
}

/* If the nodes a < b < c < d of a tetrahedron are in a positive order, b c d
 * and a b d wind in ascending order seen from outside, and the other faces in
 * the opposite direction. Each exchange of two nodes reverses all four. The
 * side is 1 under the same condition as in quality_faces.c: the lowest node is
 * followed by the higher one of the others. */
static void faces_of_tet(const uint32_t n[4], uint32_t cell, struct face f[4])
{
  uint32_t v[4] = { n[0], n[1], n[2], n[3] };
  uint32_t side = 2 * cell ^ vg_order4(v);
  uint64_t a = v[0], b = v[1], c = v[2];

  f[0] = (struct face){ a << 32 | b, v[2], side ^ 1 };
  f[1] = (struct face){ a << 32 | b, v[3], side };
  f[2] = (struct face){ a << 32 | c, v[3], side ^ 1 };
  f[3] = (struct face){ b << 32 | c, v[3], side };
}

static struct face face_of_tri(const uint32_t n[3], uint32_t owner)
{
  uint32_t v[3] = { n[0], n[1], n[2] }, side = 2 * owner ^ vg_order3(v);

  return (struct face){ (uint64_t)v[0] << 32 | v[1], v[2], side };
}

/* The face opposite a node, among those of faces_of_tet. */
static struct face *opposite(struct face f[4], const uint32_t n[4],
                             uint32_t node)
{
  return f + 3 -
         ((n[0] < node) + (n[1] < node) + (n[2] < node) + (n[3] < node));
}

/* In a column of layer cells, a cell stands on the previous one: two nodes
 * keep their positions, and the top node replaces the third. Matched faces get
 * the key VACANT. */
static void meet_in_columns(struct pairing *p, uint32_t (*n)[4], size_t n_cell,
                            struct face *f)
{
  for (size_t i = 1; i < n_cell; i++) {
    const uint32_t *was = n[i - 1], *is = n[i];
    int same[3] = { is[0] == was[0], is[1] == was[1], is[2] == was[2] };
    int gone = !same[0] ? 0 : !same[1] ? 1 : 2;
    struct face *a, *b;

    if (same[0] + same[1] + same[2] != 2 || is[gone] != was[3]) continue;
    a = opposite(f + 4 * i - 4, was, was[gone]);
    b = opposite(f + 4 * i, is, is[3]);
    if (a->key != b->key || a->high != b->high) continue;
    meet(p, a->owner, b->owner);
    a->key = b->key = VACANT;
  }
}

static void add_all_faces(struct pairing *p)
{
  const struct vg_mesh *m = p->m;
  struct face f[4 * AHEAD];

  for (size_t i = 0, n; i < m->n_tet && !p->refused; i += n) {
    n = m->n_tet - i < AHEAD ? m->n_tet - i : AHEAD;
    for (size_t k = 0; k < n; k++)
      faces_of_tet(m->tet[i + k], (uint32_t)(i + k), f + 4 * k);
    meet_in_columns(p, m->tet + i, n, f);
    for (size_t k = 0; k < 4 * n; k++)
      __builtin_prefetch(&p->bucket[home(p, f[k].key, f[k].high)], 1);
    for (size_t k = 0; k < 4 * n && !p->refused; k++)
      if (f[k].key != VACANT) add_face(p, &f[k]);
  }
  for (size_t i = 0; i < m->n_tri && !p->refused; i++) {
    f[0] = face_of_tri(m->tri[i], (uint32_t)(p->n_cell + i));
    add_face(p, &f[0]);
  }
}

/* List the faces that still wait, for matching with other slices. */
static vg_status list_unpaired(const struct pairing *p,
                               struct vg_unpaired *unpaired,
                               struct vg_error *err)
{
  if (vg_reserve(&unpaired->face, &unpaired->cap_face, unpaired->n_face + p->n,
                 sizeof *unpaired->face))
    return vg_fail_memory(err, "the unmatched faces of a slice");
  for (size_t i = 0; i <= p->mask; i++)
    for (unsigned k = 0; k < SLOTS; k++) {
      const struct bucket *b = &p->bucket[i];
      uint32_t cell = b->owner[k] >> 1,
               node[2] = { (uint32_t)b->key[k], b->high[k] };

      if (b->key[k] == VACANT) continue;
      unpaired->face[unpaired->n_face++] = (struct vg_unpaired_face){
        { (uint32_t)(b->key[k] >> 32), node[b->owner[k] & 1],
          node[~b->owner[k] & 1], VG_NO_NODE },
        cell,
        p->volume[cell]
      };
    }
  return VG_OK;
}

int vg_faces_can_pair(const struct vg_mesh *m,
                      const struct vg_unpaired *unpaired)
{
  return !(m->n_pyr + m->n_pri + m->n_hex + m->n_quad) &&
         !(unpaired && (unpaired->is_shared || m->n_tri));
}

vg_status vg_pair_faces(const struct vg_mesh *m, const float *volume,
                        struct vg_stats *f, struct vg_unpaired *unpaired,
                        uint32_t *parent, struct vg_error *err)
{
  assert(vg_faces_can_pair(m, unpaired));
  assert(parent || !m->n_tet);

  struct pairing p = {
    .m = m, .volume = volume, .parent = parent, .n_cell = m->n_tet
  };
  vg_status st = VG_OK;

  p.f = vg_stats_new();
  if (!p.f || !make_buckets(&p, FIRST_BITS)) p.refused = 1;
  else add_all_faces(&p);
  if (p.refused) st = vg_fail_memory(err, "the table of faces");
  else if (unpaired) st = list_unpaired(&p, unpaired, err);
  else if (p.n || p.is_odd) st = VG_BLOCKED;
  if (st == VG_OK) vg_stats_add(f, p.f);
  free(p.f);
  free(p.bucket);
  free(p.is_over);
  return st;
}
