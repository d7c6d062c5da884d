/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: each connected component of free leaves is divided into its share
 * of the subdomains. Disconnected components of a subdomain join an adjacent
 * subdomain, or become subdomains of their own. Each connected component of
 * the other leaves is a gap region. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "partition/graph/bisect.h"
#include "partition/graph/graph.h"
#include "partition/octree/octree_parts.h"

/* Share of the mean subdomain: a free component with less is left to the gap
 * region, and a disconnected component of a subdomain joins an adjacent one. */
#define SMALL 0.3 /* O2 */

/* Gradient from which the number of cells rises by VG_LOAD_GRADED, as in
 * load.c. */
#define GRADIENT 0.05 /* C15 */

/* Allowed ratio of METIS's largest subdomain to the mean. */
#define IMBALANCE 1.05

struct chooser {
  struct vg_octants *t;
  const struct vg_sizing *sizing;
  const struct vg_decomposition_options *options;
  double *cells;   /* [n_leaf] Cells of free leaves, in list order. */
  double *edge;    /* [n_leaf] Size at the centre. */
  uint32_t *up;    /* [n_leaf] Union-find of connected leaves. */
  uint32_t *local; /* [n_leaf] scratch */
  double *sum;     /* [n_leaf] Scratch: sums of sets, at their roots. */
  double per_cube; /* Expected cells per leaf of the size. */
  size_t n_asked;  /* Requested subdomains. */
};

static struct vg_octant *leaf_of(const struct chooser *c, size_t l)
{
  return &c->t->octant[c->t->leaf[l]];
}

static int is_free(const struct chooser *c, size_t l)
{
  return leaf_of(c, l)->state == VG_OCTANT_FREE;
}

/* --- cells and connected sets -------------------------------------------- */

/* Cells in a leaf: c / h^3, summed over its eight octants, and more where
 * sizes vary (C15). */
static void weigh(struct chooser *c, size_t l)
{
  const struct vg_octant *o = leaf_of(c, l);
  const double side = vg_octant_side(o) * c->t->unit;
  double x[3], g[3] = { 0, 0, 0 }, sum = 0, more;

  for (int i = 0; i < 8; i++) {
    double h;

    for (int k = 0; k < 3; k++)
      x[k] = vg_octants_place(c->t, k, o->at[k]) +
             (i >> k & 1 ? 0.75 : 0.25) * side;
    h = vg_sizing_at(c->sizing, x);
    sum += 1 / (h * h * h);
    for (int k = 0; k < 3; k++) g[k] += i >> k & 1 ? h : -h;
  }
  for (int k = 0; k < 3; k++)
    x[k] = vg_octants_place(c->t, k, o->at[k]) + 0.5 * side;
  c->edge[l] = vg_sizing_at(c->sizing, x);
  /* gradient between the octants' centres, half a side apart: four pairs
   * each */
  more = VG_LOAD_GRADED * fmin(vg_norm(g) / (2 * side) / GRADIENT, 1);
  c->cells[l] = c->per_cube * side * side * side * sum / 8 * (1 + more);
}

/* While ids are leaf indices: unites leaves that share a face and are alike. */
static void unite(struct chooser *c,
                  int (*alike)(const struct chooser *c, size_t a, size_t b))
{
  const struct vg_octants *t = c->t;

  for (size_t l = 0; l < t->n_leaf; l++) c->up[l] = (uint32_t)l;
  for (size_t f = 0; f < t->n_face; f++) {
    const uint32_t a = t->octant[t->face[f].leaf[0]].id;
    const uint32_t b = t->octant[t->face[f].leaf[1]].id;

    if (alike(c, a, b)) vg_union(c->up, a, b);
  }
}

static int both_free(const struct chooser *c, size_t a, size_t b)
{
  return is_free(c, a) && is_free(c, b);
}

static int both_gap(const struct chooser *c, size_t a, size_t b)
{
  return !is_free(c, a) && !is_free(c, b);
}

/* local: subdomains. */
static int one_part(const struct chooser *c, size_t a, size_t b)
{
  return both_free(c, a, b) && c->local[a] == c->local[b];
}

static double sum_sets(struct chooser *c)
{
  double all = 0;

  memset(c->sum, 0, c->t->n_leaf * sizeof *c->sum);
  for (size_t l = 0; l < c->t->n_leaf; l++)
    if (is_free(c, l)) {
      c->sum[vg_root_of(c->up, (uint32_t)l)] += c->cells[l];
      all += c->cells[l];
    }
  return all;
}

/* Leaves small sets to the gap region, but never the largest set. Returns the
 * remaining cells. */
static double drop_small(struct chooser *c, double least)
{
  const size_t n = c->t->n_leaf;
  double most = 0;

  for (size_t l = 0; l < n; l++)
    if (c->sum[l] > most) most = c->sum[l];
  if (least > most) least = most;
  for (size_t l = 0; l < n; l++)
    if (is_free(c, l) && c->sum[vg_root_of(c->up, (uint32_t)l)] < least)
      leaf_of(c, l)->state = VG_OCTANT_GAP;
  return sum_sets(c);
}

/* --- subdomains ---------------------------------------------------------- */

/* The leaves of one set. */
struct set {
  size_t n;
  uint32_t *leaf; /* [n] Indices of leaves. */
  double *weight; /* [n] cells */
  double (*x)[3]; /* [n] Centres. */
};

static void set_release(struct set *s)
{
  free(s->leaf);
  free(s->weight);
  free(s->x);
}

static vg_status set_make(struct chooser *c, uint32_t root, size_t n,
                          struct set *s, struct vg_error *err)
{
  s->leaf = vg_alloc(n, sizeof *s->leaf);
  s->weight = vg_alloc(n, sizeof *s->weight);
  s->x = vg_alloc(n, sizeof *s->x);
  if (!s->leaf || !s->weight || !s->x)
    return vg_fail_memory(err, "the subdomains of octants");
  for (size_t l = root; s->n < n; l++) {
    const struct vg_octant *o = leaf_of(c, l);

    if (!is_free(c, l) || vg_root_of(c->up, (uint32_t)l) != root) continue;
    for (int k = 0; k < 3; k++)
      s->x[s->n][k] = vg_octants_place(c->t, k,
                                       o->at[k] + vg_octant_side(o) / 2);
    s->weight[s->n] = c->cells[l];
    c->local[l] = (uint32_t)s->n;
    s->leaf[s->n++] = (uint32_t)l;
  }
  return VG_OK;
}

/* Cost of a face: approximately its triangles. */
static int32_t price_of(const struct chooser *c, const struct vg_octant_face *f,
                        uint32_t a, uint32_t b)
{
  const double h = 0.5 * (c->edge[a] + c->edge[b]);
  const double side = f->side * c->t->unit / h;

  return (int32_t)fmin(1 + 2.3 * side * side, 1e6);
}

/* Graph of the faces within the set, in both directions. */
static vg_status set_graph(const struct chooser *c, const struct set *s,
                           struct vg_graph *g, struct vg_error *err)
{
  const struct vg_octants *t = c->t;
  uint64_t *begin = vg_calloc(s->n + 2, sizeof *begin);
  uint32_t *to = NULL;
  int32_t *edge = NULL;

  *g = (struct vg_graph){ .n = s->n, .begin = begin, .weight = s->weight };
  if (!begin) return vg_fail_memory(err, "the graph of octants");
  for (int fill = 0; fill < 2; fill++) {
    for (size_t f = 0; f < t->n_face; f++) {
      const uint32_t a = t->octant[t->face[f].leaf[0]].id;
      const uint32_t b = t->octant[t->face[f].leaf[1]].id;

      if (!both_free(c, a, b) || c->up[a] != c->up[s->leaf[0]] ||
          c->up[b] != c->up[a])
        continue;
      for (int k = 0; k < 2; k++) {
        const uint32_t from = c->local[k ? b : a], into = c->local[k ? a : b];

        if (!fill) {
          begin[from + 2]++;
          continue;
        }
        edge[begin[from + 1]] = price_of(c, &t->face[f], a, b);
        to[begin[from + 1]++] = into;
      }
    }
    if (fill) break;
    for (size_t k = 2; k < s->n + 2; k++) begin[k] += begin[k - 1];
    g->to = to = vg_alloc(begin[s->n + 1], sizeof *to);
    g->edge = edge = vg_alloc(begin[s->n + 1], sizeof *edge);
    if (!to || !edge) return vg_fail_memory(err, "the graph of octants");
  }
  return VG_OK;
}

static void graph_release(struct vg_graph *g)
{
  free((void *)(uintptr_t)g->begin);
  free((void *)(uintptr_t)g->to);
  free((void *)(uintptr_t)g->edge);
}

/* Divides the set of a root into n subdomains, numbered from *at: c->local. */
static vg_status part_set(struct chooser *c, uint32_t root, size_t n_leaf,
                          size_t n, uint32_t *at, struct vg_error *err)
{
  struct set s = { 0 };
  struct vg_graph g = { 0 };
  struct vg_graph_options o = { (int)n, IMBALANCE, 1, &c->t->other_seconds };
  uint32_t *part = vg_calloc(n_leaf, sizeof *part);
  vg_status st = part ? VG_OK
                      : vg_fail_memory(err, "the subdomains of octants");

  if (st == VG_OK) st = set_make(c, root, n_leaf, &s, err);
  if (st == VG_OK && n > 1) {
    if (c->options->partitioner == VG_PARTITIONER_RCB) {
      st = vg_bisect(s.n, (const double(*)[3])s.x, s.weight, (int)n, part, err);
    } else {
      st = set_graph(c, &s, &g, err);
      if (st == VG_OK) st = vg_graph_part(&g, &o, part, err);
    }
  }
  for (size_t k = 0; st == VG_OK && k < s.n; k++)
    c->local[s.leaf[k]] = *at + part[k];
  *at += (uint32_t)n;
  c->n_asked += n;
  graph_release(&g);
  set_release(&s);
  free(part);
  return st;
}

/* Divides all sets. local out: subdomains of free leaves. */
static vg_status part_sets(struct chooser *c, double mean, struct vg_error *err)
{
  const size_t n = c->t->n_leaf;
  uint32_t *count = vg_calloc(n, sizeof *count), at = 0;
  vg_status st = count ? VG_OK
                       : vg_fail_memory(err, "the subdomains of octants");

  for (size_t l = 0; l < n; l++) {
    c->up[l] = vg_root_of(c->up, (uint32_t)l);
    if (st == VG_OK && is_free(c, l)) count[c->up[l]]++;
  }
  for (size_t l = 0; st == VG_OK && l < n; l++) {
    const double n_wanted = c->sum[l] / mean;
    size_t parts = n_wanted < 1 ? 1 : (size_t)(n_wanted + 0.5);

    if (!count[l]) continue;
    if (parts > count[l]) parts = count[l];
    st = part_set(c, (uint32_t)l, count[l], parts, &at, err);
  }
  free(count);
  return st;
}

/* Scratch for components that join subdomains, stored at roots. */
struct pieces {
  uint32_t *largest; /* [subdomains] Root of its largest component. */
  uint32_t *into;    /* Subdomain that a component joins. */
  double *shared;    /* Face cost that they share. */
};

static void pieces_release(struct pieces *p)
{
  free(p->largest);
  free(p->into);
  free(p->shared);
}

/* Finds the subdomain that each component joins: p->into. */
static void match_pieces(struct chooser *c, double least, struct pieces *p)
{
  const struct vg_octants *t = c->t;

  for (uint32_t l = 0; l < t->n_leaf; l++) {
    uint32_t *best;

    if (!is_free(c, l) || c->up[l] != l) continue;
    best = &p->largest[c->local[l]];
    if (*best == UINT32_MAX || c->sum[l] > c->sum[*best]) *best = l;
  }
  for (size_t f = 0; f < t->n_face; f++)
    for (int k = 0; k < 2; k++) {
      const uint32_t a = t->octant[t->face[f].leaf[k]].id;
      const uint32_t b = t->octant[t->face[f].leaf[!k]].id;
      const uint32_t root = vg_root_of(c->up, a);
      double price;

      if (!both_free(c, a, b) || c->local[a] == c->local[b] ||
          root == p->largest[c->local[a]] || c->sum[root] >= least ||
          vg_root_of(c->up, b) != p->largest[c->local[b]])
        continue;
      price = price_of(c, &t->face[f], a, b);
      if (price < p->shared[root] ||
          (price == p->shared[root] && c->local[b] >= p->into[root]))
        continue;
      p->shared[root] = price;
      p->into[root] = c->local[b];
    }
}

/* Joins disconnected components: all small ones, except the largest of each
 * subdomain, join the largest component of the subdomain with the most
 * expensive shared face. local: subdomains, in and out. Returns 1 if something
 * was joined, 0 if not, or -1. */
static int join_pieces(struct chooser *c, double least)
{
  const size_t n = c->t->n_leaf;
  struct pieces p = { vg_alloc(n, sizeof *p.largest),
                      vg_alloc(n, sizeof *p.into),
                      vg_calloc(n, sizeof *p.shared) };
  int joined = 0;

  if (!p.largest || !p.into || !p.shared) {
    pieces_release(&p);
    return -1;
  }
  memset(p.largest, 0xff, n * sizeof *p.largest);
  memset(p.into, 0xff, n * sizeof *p.into);
  unite(c, one_part);
  sum_sets(c);
  match_pieces(c, least, &p);
  for (uint32_t l = 0; l < n; l++) {
    const uint32_t root = vg_root_of(c->up, l);

    if (!is_free(c, l) || p.into[root] == UINT32_MAX) continue;
    c->local[l] = p.into[root];
    joined = 1;
  }
  pieces_release(&p);
  return joined;
}

/* --- the gap region ------------------------------------------------------ */

/* Unites the leaves that the box meets. Returns one of them. */
static uint32_t unite_box(struct chooser *c, uint32_t i, const double lo[3],
                          const double hi[3], uint32_t first)
{
  const struct vg_octants *t = c->t;
  const struct vg_octant *o = &t->octant[i];

  for (int k = 0; k < 3; k++)
    if (vg_octants_place(t, k, o->at[k]) > hi[k] ||
        vg_octants_place(t, k, o->at[k] + vg_octant_side(o)) < lo[k])
      return first;
  if (o->child) {
    for (uint32_t k = 0; k < 8; k++)
      first = unite_box(c, o->child + k, lo, hi, first);
  } else if (o->state == VG_OCTANT_GAP) {
    if (first == UINT32_MAX) first = o->id;
    vg_union(c->up, first, o->id);
  }
  return first;
}

static void box_of(const struct vg_front *v, size_t i, double lo[3],
                   double hi[3])
{
  for (int k = 0; k < 3; k++) {
    lo[k] = hi[k] = v->x[v->face[i][0]][k];
    for (int j = 1; j < 3; j++) {
      const double x = v->x[v->face[i][j]][k];

      if (x < lo[k]) lo[k] = x;
      if (x > hi[k]) hi[k] = x;
    }
  }
}

/* Sets the ids of all leaves, and of the gap region at each triangle. up:
 * sets. */
static vg_status give_ids(struct chooser *c, const struct vg_front *v,
                          uint32_t *gap, struct vg_error *err)
{
  struct vg_octants *t = c->t;
  const size_t n = t->n_leaf;
  uint32_t *id = vg_alloc(n, sizeof *id);

  if (!id) return vg_fail_memory(err, "the subdomains of octants");
  unite(c, one_part);
  memset(id, 0xff, n * sizeof *id);
  t->n_part = t->n_gap = 0;
  for (uint32_t l = 0; l < n; l++)
    if (is_free(c, l) && vg_root_of(c->up, l) == l)
      id[l] = (uint32_t)t->n_part++;
  for (uint32_t l = 0; l < n; l++)
    if (is_free(c, l)) c->local[l] = id[vg_root_of(c->up, l)];
  unite(c, both_gap);
  for (size_t i = 0; i < v->n_face; i++) {
    double lo[3], hi[3];

    box_of(v, i, lo, hi);
    gap[i] = unite_box(c, 0, lo, hi, UINT32_MAX);
  }
  for (uint32_t l = 0; l < n; l++)
    if (!is_free(c, l) && vg_root_of(c->up, l) == l)
      id[l] = (uint32_t)(t->n_part + t->n_gap++);
  for (size_t i = 0; i < v->n_face; i++)
    if (gap[i] != UINT32_MAX) gap[i] = id[vg_root_of(c->up, gap[i])];
  for (uint32_t l = 0; l < n; l++)
    leaf_of(c, l)->id = is_free(c, l) ? c->local[l] : id[vg_root_of(c->up, l)];
  free(id);
  return VG_OK;
}

/* --- all steps ----------------------------------------------------------- */

static vg_status choose(struct chooser *c, const struct vg_front *v,
                        double cells, uint32_t *gap, struct vg_error *err)
{
  const double mean = cells / c->options->n_part;
  vg_status st;

  for (size_t l = 0; l < c->t->n_leaf; l++) {
    leaf_of(c, l)->id = (uint32_t)l;
    if (is_free(c, l)) weigh(c, l);
  }
  unite(c, both_free);
  sum_sets(c);
  c->t->cells = drop_small(c, SMALL * mean);
  st = part_sets(c, mean, err);
  for (int joined = 1; st == VG_OK && joined;) {
    joined = join_pieces(c, SMALL * mean);
    if (joined < 0) st = vg_fail_memory(err, "the subdomains of octants");
  }
  if (st == VG_OK) st = give_ids(c, v, gap, err);
  c->t->n_apart = c->t->n_part > c->n_asked ? c->t->n_part - c->n_asked : 0;
  return st;
}

vg_status vg_octants_part(struct vg_octants *t, const struct vg_front *v,
                          const struct vg_sizing *sizing, double cells,
                          const struct vg_decomposition_options *o,
                          uint32_t *gap, struct vg_error *err)
{
  struct chooser c = {
    .t = t, .sizing = sizing, .options = o, .per_cube = o->cells_per_cube
  };
  const size_t n = t->n_leaf;
  vg_status st;

  assert(t->octant && o->n_part >= 1 && (gap || !v->n_face));
  c.cells = vg_alloc(n, sizeof *c.cells);
  c.edge = vg_alloc(n, sizeof *c.edge);
  c.up = vg_alloc(n, sizeof *c.up);
  c.local = vg_alloc(n, sizeof *c.local);
  c.sum = vg_alloc(n, sizeof *c.sum);
  if (!c.cells || !c.edge || !c.up || !c.local || !c.sum)
    st = vg_fail_memory(err, "the subdomains of octants");
  else st = choose(&c, v, cells, gap, err);
  free(c.cells);
  free(c.edge);
  free(c.up);
  free(c.local);
  free(c.sum);
  return st;
}
