/* A field of sizes as bytes and back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "core/sizing_parts.h"

#define MAGIC 0x31657a6973677676ull

struct head {
  uint64_t magic, n_split, n_leaf, root;
  double slope, cap, least, most, lo[3], side;
};

vg_status vg_sizing_pack(const struct vg_sizing *s, struct vg_bytes *out,
                         struct vg_error *err)
{
  const struct vg_octree *t = &s->octree;
  struct vg_writer w = { { 0, NULL }, 0, 0 };
  struct head h = { MAGIC, t->n_split, t->n_leaf, t->root, s->slope, s->cap,
                    s->least, s->most, { t->lo[0], t->lo[1], t->lo[2] },
                    t->side };

  w.refused = vg_reserve(&w.bytes.data, &w.cap, sizeof h +
                         t->n_split * sizeof *t->child +
                         t->n_leaf * sizeof *t->leaf, 1) != 0;
  vg_put(&w, 1, sizeof h, &h);
  vg_put(&w, t->n_split, sizeof *t->child, t->child);
  vg_put(&w, t->n_leaf, sizeof *t->leaf, t->leaf);
  if (w.refused) {
    free(w.bytes.data);
    return vg_fail_memory(err, "the field of sizes as bytes");
  }
  *out = w.bytes;
  return VG_OK;
}

static int is_head(const struct head *h)
{
  const int has_leaf = h->n_leaf > 0 && h->n_leaf < VG_OCTREE_LEAF;

  return h->magic == MAGIC && has_leaf && h->n_split < VG_OCTREE_LEAF &&
         h->root == (h->n_split ? 0 : VG_OCTREE_LEAF) &&
         isfinite(h->slope) && h->slope > 0 && h->cap > 0 &&
         isfinite(h->most) && h->least > 0 && h->least <= h->most &&
         isfinite(h->lo[0]) && isfinite(h->lo[1]) && isfinite(h->lo[2]) &&
         isfinite(h->side) && h->side > 0;
}

/* Depth first, children come behind their parent, so there are no rings; and
 * none may be deeper than positions have bits. */
static int is_tree(const struct vg_octree *t, uint8_t *depth)
{
  memset(depth, 0, t->n_split);
  for (size_t i = 0; i < t->n_split; i++)
    for (int j = 0; j < 8; j++) {
      uint32_t e = t->child[i][j];

      if (e & VG_OCTREE_LEAF) {
        if ((e & ~VG_OCTREE_LEAF) >= t->n_leaf) return 0;
        continue;
      }
      if (e <= i || e >= t->n_split || depth[e] ||
          depth[i] + 1 >= VG_OCTREE_DEPTH)
        return 0;
      depth[e] = (uint8_t)(depth[i] + 1);
    }
  return 1;
}

static int are_sizes(const struct vg_sizing *s)
{
  const float *h = s->octree.leaf[0];
  float least = (float)s->least, most = (float)s->most;
  int good = 1;

  for (size_t i = 0; i < 8 * s->octree.n_leaf; i++)
    good &= h[i] >= least && h[i] <= most;
  return good;
}

vg_status vg_sizing_unpack(const struct vg_bytes *bytes,
                           struct vg_sizing **out, struct vg_error *err)
{
  struct vg_reader r = { bytes->data, bytes->n, 0, 0 };
  struct vg_sizing *s = vg_calloc(1, sizeof *s);
  struct head h = { 0 };
  uint8_t *depth = NULL;
  vg_status st = VG_OK;

  if (!s) return vg_fail_memory(err, "the field of sizes");
  vg_get(&r, 1, sizeof h, &h);
  if (r.bad || !is_head(&h) ||
      bytes->n - sizeof h != h.n_split * sizeof *s->octree.child +
                             h.n_leaf * sizeof *s->octree.leaf)
    goto damaged;
  *s = (struct vg_sizing){ .slope = h.slope, .cap = h.cap, .least = h.least,
    .most = h.most, .octree = { .lo = { h.lo[0], h.lo[1], h.lo[2] },
      .side = h.side, .root = (uint32_t)h.root, .n_split = h.n_split,
      .n_leaf = h.n_leaf } };
  s->octree.child = vg_get_array(&r, h.n_split, sizeof *s->octree.child);
  s->octree.leaf = vg_get_array(&r, h.n_leaf, sizeof *s->octree.leaf);
  depth = vg_alloc(h.n_split, 1);
  if (!s->octree.child || !s->octree.leaf || !depth) {
    st = vg_fail_memory(err, "the field of sizes");
    goto done;
  }
  if (!is_tree(&s->octree, depth) || !are_sizes(s)) goto damaged;
  *out = s;
  s = NULL;
  goto done;
damaged:
  st = vg_fail(err, VG_ERR_FORMAT, "%zu bytes are no field of sizes, or a "
               "damaged one; run again", bytes->n);
done:
  free(depth);
  vg_sizing_free(s);
  return st;
}
