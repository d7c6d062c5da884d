/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/graph/graph.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <metis.h>

#include "base/child.h"
#include "base/clock.h"
#include "base/memory.h"

_Static_assert(sizeof(idx_t) == 4, "METIS with indices of 4 bytes");

/* Sum of the weights passed to METIS, which adds them in idx_t. */
#define ALL_WEIGHTS 1e9

/* For few subdomains recursive bisection gives better results (METIS's
 * manual). */
#define MOST_BISECTED 8

struct question {
  idx_t n, n_edge, n_part, has_edge_weights, contiguous, imbalance;
};

/* --- in the child -------------------------------------------------------- */

static idx_t *get_array(int fd, size_t n)
{
  idx_t *a = vg_alloc(n, sizeof *a);

  if (a && !vg_child_get(fd, a, n * sizeof *a)) _exit(1);
  return a;
}

static int run_metis(struct question *q, idx_t *begin, idx_t *to, idx_t *weight,
                     idx_t *edge, idx_t *part)
{
  idx_t options[METIS_NOPTIONS], n_con = 1, cut;

  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_UFACTOR] = q->imbalance;
  if (q->n_part <= MOST_BISECTED && !q->contiguous)
    return METIS_PartGraphRecursive(&q->n, &n_con, begin, to, weight, NULL,
                                    edge, &q->n_part, NULL, NULL, options, &cut,
                                    part);
  options[METIS_OPTION_CONTIG] = q->contiguous;
  return METIS_PartGraphKway(&q->n, &n_con, begin, to, weight, NULL, edge,
                             &q->n_part, NULL, NULL, options, &cut, part);
}

static void serve(int fd)
{
  struct question q;
  idx_t *begin, *to, *weight, *edge = NULL, *part;
  double seconds;

  if (!vg_child_get(fd, &q, sizeof q)) _exit(1);
  begin = get_array(fd, (size_t)q.n + 1);
  to = begin ? get_array(fd, (size_t)q.n_edge) : NULL;
  weight = to ? get_array(fd, (size_t)q.n) : NULL;
  if (weight && q.has_edge_weights) edge = get_array(fd, (size_t)q.n_edge);
  part = vg_alloc((size_t)q.n, sizeof *part);
  if (!weight || !part || (q.has_edge_weights && !edge)) _exit(1);
  if (run_metis(&q, begin, to, weight, edge, part) != METIS_OK) _exit(1);
  seconds = vg_clock_process();
  _exit(!vg_child_put(fd, part, (size_t)q.n * sizeof *part) ||
        !vg_child_put(fd, &seconds, sizeof seconds));
}

/* --- passing the graph to the child -------------------------------------- */

static int send_begins(int fd, const struct vg_graph *g)
{
  idx_t chunk[4096];
  size_t n = 0;

  for (size_t k = 0; k <= g->n; k++) {
    chunk[n++] = (idx_t)g->begin[k];
    if (n == sizeof chunk / sizeof *chunk || k == g->n) {
      if (!vg_child_put(fd, chunk, n * sizeof *chunk)) return 0;
      n = 0;
    }
  }
  return 1;
}

static int send_weights(int fd, const struct vg_graph *g)
{
  idx_t chunk[4096];
  double sum = 0, scale;
  size_t n = 0;

  for (size_t k = 0; k < g->n; k++) sum += g->weight ? g->weight[k] : 1;
  scale = (ALL_WEIGHTS - (double)g->n) / sum;
  if (!g->weight) scale = 0;
  for (size_t k = 0; k < g->n; k++) {
    chunk[n++] = 1 + (idx_t)(scale * (g->weight ? g->weight[k] : 1));
    if (n == sizeof chunk / sizeof *chunk || k + 1 == g->n) {
      if (!vg_child_put(fd, chunk, n * sizeof *chunk)) return 0;
      n = 0;
    }
  }
  return 1;
}

static int ask(int fd, const struct vg_graph *g,
               const struct vg_graph_options *o)
{
  double over = 1000 * (o->imbalance - 1);
  size_t n_edge = g->begin[g->n];
  struct question q = {
    (idx_t)g->n,        (idx_t)n_edge,
    o->n_part,          g->edge != NULL,
    o->contiguous != 0, over < 1 ? 1 : over > 1000 ? 1000 : (idx_t)over
  };

  return vg_child_put(fd, &q, sizeof q) && send_begins(fd, g) &&
         vg_child_put(fd, g->to, n_edge * sizeof *g->to) &&
         send_weights(fd, g) &&
         (!g->edge || vg_child_put(fd, g->edge, n_edge * sizeof *g->edge));
}

int vg_graph_is_built(void)
{
  return 1;
}

vg_status vg_graph_part(const struct vg_graph *g,
                        const struct vg_graph_options *o, uint32_t *part,
                        struct vg_error *err)
{
  struct vg_child c;
  double seconds = 0;
  int ok;

  assert(g && o && (part || !g->n));
  if (o->n_part < 1 || (size_t)o->n_part > g->n)
    return vg_fail(err, VG_ERR_INPUT,
                   "%d subdomains of %zu vertices: there must be "
                   "at least one subdomain, and a vertex for each",
                   o->n_part, g->n);
  /* half of the 4-byte integer range is left for the weights */
  if (g->n > 500000000 || g->begin[g->n] > INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "a graph of %zu vertices is too large for "
                   "METIS with 4-byte indices",
                   g->n);
  memset(part, 0, g->n * sizeof *part);
  if (o->n_part == 1) return VG_OK;
  if (vg_child_open(serve, &c) < 0)
    return vg_fail_memory(err, "a process for METIS");
  ok = ask(c.fd, g, o) && vg_child_get(c.fd, part, g->n * sizeof *part) &&
       vg_child_get(c.fd, &seconds, sizeof seconds);
  vg_child_close(&c);
  for (size_t k = 0; ok && k < g->n; k++) ok = part[k] < (uint32_t)o->n_part;
  if (!ok)
    return vg_fail(err, VG_ERR_MEMORY,
                   "METIS failed on a graph of %zu "
                   "vertices; it may have run out of memory",
                   g->n);
  if (o->seconds) *o->seconds += seconds;
  return VG_OK;
}

void vg_library_metis(struct vg_library *out)
{
  out->name = "METIS";
  snprintf(out->version, sizeof out->version, "%d.%d.%d", METIS_VER_MAJOR,
           METIS_VER_MINOR, METIS_VER_SUBMINOR);
}
