/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matchings. A general maximum-weight matching takes O(n^2 log n) with
 * blossoms. Here, paths and cycles are short, so that a search visits all of
 * them: those of a node with three links and k links outside the matching are
 * at most 3 * 2^(k - 1). */
#include "layers/expand/matching.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define NONE UINT32_MAX
#define MOST_NODES 12
_Static_assert(VG_MATCHING_PATH < MOST_NODES && VG_MATCHING_CYCLE < MOST_NODES,
               "a path fits into its array");

struct link {
  uint16_t weight;
  uint32_t low, high;
};

/* A path of links outside and inside the matching in turn, and the best that
 * was found. gain: weight of the links outside minus that of those inside. */
struct search {
  const struct vg_links *l;
  uint32_t *partner;
  uint32_t node[MOST_NODES], best[MOST_NODES];
  int n_best, most;
  int32_t gain_best;
};

static int by_weight(const void *a, const void *b)
{
  const struct link *s = a, *t = b;

  if (s->weight != t->weight) return s->weight > t->weight ? -1 : 1;
  if (s->low != t->low) return s->low < t->low ? -1 : 1;
  return s->high < t->high ? -1 : s->high > t->high;
}

static vg_status take_heaviest(const struct vg_links *l, uint32_t *partner,
                               struct vg_error *err)
{
  struct link *link = vg_alloc(3 * l->n / 2 + 1, sizeof *link);
  size_t n = 0;

  if (!link) return vg_fail_memory(err, "the pairs of wall faces");
  for (size_t i = 0; i < l->n; i++)
    for (int k = 0; k < 3; k++)
      if (l->to[i][k] != NONE && l->to[i][k] > i)
        link[n++] = (struct link){ l->weight[i][k], (uint32_t)i, l->to[i][k] };
  if (n) qsort(link, n, sizeof *link, by_weight);
  for (size_t i = 0; i < n; i++) {
    if (partner[link[i].low] != NONE || partner[link[i].high] != NONE) continue;
    partner[link[i].low] = link[i].high;
    partner[link[i].high] = link[i].low;
  }
  free(link);
  return VG_OK;
}

static int32_t weight_of(const struct vg_links *l, uint32_t a, uint32_t b)
{
  int k = 0;

  while (l->to[a][k] != b) k++;
  return l->weight[a][k];
}

static int is_on_path(const struct search *s, int n, uint32_t node)
{
  for (int i = 0; i < n; i++)
    if (s->node[i] == node) return 1;
  return 0;
}

static void keep(struct search *s, int n, int32_t gain)
{
  if (gain <= s->gain_best) return;
  memcpy(s->best, s->node, (size_t)n * sizeof *s->best);
  s->n_best = n;
  s->gain_best = gain;
}

/* Continues a path of n nodes, whose last link is in the matching or which is a
 * node without partner, to nodes without partner. */
static void extend(struct search *s, int n, int32_t gain)
{
  const uint32_t end = s->node[n - 1];

  for (int k = 0; k < 3; k++) {
    const uint32_t to = s->l->to[end][k];
    int32_t more;

    if (to == NONE || is_on_path(s, n, to)) continue;
    more = gain + s->l->weight[end][k];
    s->node[n] = to;
    if (s->partner[to] == NONE) {
      if (n == s->most) keep(s, n + 1, more);
    } else if (n + 2 <= s->most && n + 2 < MOST_NODES) {
      s->node[n + 1] = s->partner[to];
      extend(s, n + 2, more - weight_of(s->l, to, s->partner[to]));
    }
  }
}

/* Pairs the nodes of a path two by two, from the first or second on. */
static void pair_up(uint32_t *partner, const uint32_t *node, int n)
{
  for (int i = 0; i + 1 < n; i += 2) {
    partner[node[i]] = node[i + 1];
    partner[node[i + 1]] = node[i];
  }
}

/* The shortest paths come first. After that, none is left from nodes that were
 * visited: paths of one length that a path of this length leaves behind have no
 * common node with it (Hopcroft and Karp 1973), so they existed before. */
static void augment(struct search *s)
{
  for (s->most = 1; s->most <= VG_MATCHING_PATH; s->most += 2)
    for (size_t i = 0; i < s->l->n; i++) {
      if (s->partner[i] != NONE) continue;
      s->node[0] = (uint32_t)i;
      s->n_best = 0;
      s->gain_best = INT32_MIN;
      extend(s, 1, 0);
      pair_up(s->partner, s->best, s->n_best);
    }
}

/* Continues a path of n nodes whose last link is in the matching: back to its
 * first node, whose partner is the second, or, if the first has no partner, to
 * any end. */
static void exchange(struct search *s, int n, int32_t gain)
{
  const uint32_t end = s->node[n - 1];

  if (s->partner[s->node[0]] == NONE) keep(s, n, gain);
  for (int k = 0; k < 3; k++) {
    const uint32_t to = s->l->to[end][k];
    int32_t more;

    if (to == NONE || s->partner[to] == NONE) continue;
    more = gain + s->l->weight[end][k];
    if (to == s->node[0] && n > 2) keep(s, n, more);
    if (is_on_path(s, n, to) || n + 2 > VG_MATCHING_CYCLE) continue;
    s->node[n] = to;
    s->node[n + 1] = s->partner[to];
    exchange(s, n + 2, more - weight_of(s->l, to, s->partner[to]));
  }
}

static void apply(struct search *s, int is_cycle)
{
  if (is_cycle) {
    const uint32_t first = s->best[0];

    memmove(s->best, s->best + 1, (size_t)(s->n_best - 1) * sizeof *s->best);
    s->best[s->n_best - 1] = first;
  } else s->partner[s->best[s->n_best - 1]] = NONE;
  pair_up(s->partner, s->best, s->n_best);
}

/* Each exchange increases the sum of the weights. Returns whether there was
 * one. */
static int improve(struct search *s)
{
  int changed = 0;

  for (size_t i = 0; i < s->l->n; i++) {
    const uint32_t mate = s->partner[i];

    s->node[0] = (uint32_t)i;
    s->node[1] = mate;
    s->n_best = 0;
    s->gain_best = 0;
    if (mate == NONE) exchange(s, 1, 0);
    else exchange(s, 2, -weight_of(s->l, (uint32_t)i, mate));
    if (!s->n_best) continue;
    apply(s, mate != NONE);
    changed = 1;
  }
  return changed;
}

vg_status vg_links_match(const struct vg_links *l, uint32_t *partner,
                         struct vg_error *err)
{
  assert(l && partner);

  struct search s = { .l = l, .partner = partner };
  vg_status st;

  memset(partner, 0xff, l->n * sizeof *partner);
  st = take_heaviest(l, partner, err);
  if (st < 0) return st;
  augment(&s);
  for (int i = 0; i < VG_MATCHING_SWEEPS && improve(&s); i++) augment(&s);
  return VG_OK;
}
