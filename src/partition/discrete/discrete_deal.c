/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Assigns coarse cells to subdomains. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/shape.h"
#include "core/geometry/vector.h"
#include "partition/discrete/discrete_parts.h"
#include "partition/graph/bisect.h"
#include "partition/graph/graph.h"

/* Imbalance (maximum over mean) passed to METIS. */
static const double imbalance = 1.03; /* D2 */
/* Disconnected components below this share of a subdomain's weight move to an
 * adjacent subdomain. */
static const double small_piece = 0.1; /* D4 */
/* Maximum over mean while cells change sides, and the number of sweeps over
 * all cells. */
static const double evened = 1.04; /* D5 */
enum { EVEN_SWEEPS = 6 };
/* Additional cost, in triangles, of a face of a flat coarse cell. It falls
 * with growing angles, to zero at this sine. Interfaces through flat cells
 * leave slits, which fill with cells of a few degrees. */
static const double flat_costs = 10, flat_sine = 0.5; /* D11 */

/* --- weights ------------------------------------------------------------- */

struct weights {
  struct vg_coarse *c;
  const struct vg_load *load;
  struct vg_load_finder *finder;
  const struct vg_sizing *sizing;
  double per_cube;
  double *flat; /* [c->t.n_cell] out: triangles added to the cost of each
                   cell's faces. */
};

/* D3: cells per volume from the load or, where the load has no octant, as at a
 * wall, from the size. */
static double density_at(const struct weights *w, const double x[3])
{
  size_t k = vg_load_find(w->finder, x);
  double h;

  if (k != SIZE_MAX) {
    const struct vg_load_octant *c = &w->load->octant[k];
    const double half = (double)c->half;

    return (double)c->cells / (8 * half * half * half * (double)c->part);
  }
  h = vg_sizing_at(w->sizing, x);
  return w->per_cube / (h * h * h);
}

/* Mean density in a cell, at lattice points in it: four per edge, or only the
 * centre of a cell that is small relative to the size. */
static double density(const struct weights *w, double *const x[4])
{
  enum { N = 3 };
  double sum = 0, far = 0, mid[3], h;
  int n = 0;

  for (int k = 0; k < 3; k++)
    mid[k] = 0.25 * (x[0][k] + x[1][k] + x[2][k] + x[3][k]);
  h = vg_sizing_at(w->sizing, mid);
  for (int i = 0; i < 4; i++) far = fmax(far, vg_distance2(mid, x[i]));
  if (far < 0.25 * h * h) return density_at(w, mid);
  for (int a = 0; a <= N; a++)
    for (int b = 0; a + b <= N; b++)
      for (int c = 0; a + b + c <= N; c++) {
        double share[4] = { a + 0.25, b + 0.25, c + 0.25,
                            N - a - b - c + 0.25 };
        double at[3] = { 0, 0, 0 };

        for (int i = 0; i < 4; i++)
          for (int k = 0; k < 3; k++) at[k] += share[i] / (N + 1) * x[i][k];
        sum += density_at(w, at);
        n++;
      }
  return sum / n;
}

static double flatness(double *const x[4])
{
  double sine = sqrt(fmax(0, vg_shape(x[0], x[1], x[2], x[3])));

  return flat_costs * fmax(0, 1 - sine / flat_sine);
}

static void weigh(void *context, size_t first, size_t end, int worker)
{
  const struct weights *w = context;
  const struct vg_tets *t = &w->c->t;

  (void)worker;
  for (size_t q = first; q < end; q++) {
    const uint32_t *v = t->cell[q].v;
    double *const x[4] = { t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]] };
    double volume = vg_det(x[0], x[1], x[2], x[3]) / 6;
    double cells = fabs(volume) * density(w, x);

    w->c->weight[q] = cells > 0 ? cells : 1e-6;
    w->flat[q] = flatness(x);
  }
}

/* --- the dual graph ------------------------------------------------------ */

/* Number of triangles that a face would have on an interface. */
static double face_size(const struct vg_coarse *c,
                        const struct vg_sizing *sizing, size_t q, int i)
{
  const struct vg_tets *t = &c->t;
  const double *a = t->x[t->cell[q].v[vg_face[i][0]]];
  const double *b = t->x[t->cell[q].v[vg_face[i][1]]];
  const double *d = t->x[t->cell[q].v[vg_face[i][2]]];
  double u[3], v[3], n[3], mid[3], h;

  vg_sub(b, a, u);
  vg_sub(d, a, v);
  vg_cross(u, v, n);
  for (int k = 0; k < 3; k++) mid[k] = (a[k] + b[k] + d[k]) / 3;
  h = vg_sizing_at(sizing, mid);
  return vg_norm(n) / (h * h);
}

struct dual {
  struct vg_graph g;
  uint64_t *begin;
  uint32_t *to;
  int32_t *edge;
};

static void dual_release(struct dual *d)
{
  free(d->begin);
  free(d->to);
  free(d->edge);
}

static vg_status make_dual(const struct weights *w, struct dual *d,
                           struct vg_error *err)
{
  const struct vg_coarse *c = w->c;
  size_t n = c->t.n_cell, m = 0;

  d->begin = vg_alloc(n + 1, sizeof *d->begin);
  d->to = vg_alloc(4 * n, sizeof *d->to);
  d->edge = vg_alloc(4 * n, sizeof *d->edge);
  if (!d->begin || !d->to || !d->edge)
    return vg_fail_memory(err, "assigning the coarse mesh to subdomains");
  for (size_t q = 0; q < n; q++) {
    d->begin[q] = m;
    for (int i = 0; i < 4; i++) {
      uint32_t link = c->t.cell[q].link[i];
      size_t low = q;
      int face = i;
      double cost;

      if (link == VG_NONE) continue;
      if (link >> 2 < q) { /* the same sum from both sides */
        low = link >> 2;
        face = (int)(link & 3);
      }
      cost = face_size(c, w->sizing, low, face) +
             fmax(w->flat[q], w->flat[link >> 2]);
      d->to[m] = link >> 2;
      d->edge[m++] = 1 + (int32_t)fmin(4 * cost, 1e6);
    }
  }
  d->begin[n] = m;
  d->g = (struct vg_graph){ n, d->begin, d->to, c->weight, d->edge };
  return VG_OK;
}

/* --- connected components ------------------------------------------------ */

/* Numbers the connected components of each subdomain: piece out: [n], in the
 * order of their first cells. */
static uint32_t find_pieces(const struct dual *d, const uint32_t *part,
                            uint32_t *piece, uint32_t *queue)
{
  uint32_t n_piece = 0;

  memset(piece, 0xff, d->g.n * sizeof *piece);
  for (size_t s = 0; s < d->g.n; s++) {
    size_t n = 0;

    if (piece[s] != VG_NONE) continue;
    piece[s] = n_piece;
    queue[n++] = (uint32_t)s;
    for (size_t at = 0; at < n; at++)
      for (uint64_t k = d->begin[queue[at]]; k < d->begin[queue[at] + 1]; k++) {
        uint32_t q = d->to[k];

        if (piece[q] != VG_NONE || part[q] != part[s]) continue;
        piece[q] = n_piece;
        queue[n++] = q;
      }
    n_piece++;
  }
  return n_piece;
}

/* The subdomain with the largest shared face cost to component n, or
 * VG_NONE. */
static uint32_t adjacent_part(const struct dual *d, const uint32_t *part,
                              const uint32_t *piece, size_t first, uint32_t n,
                              double *common, uint32_t n_part)
{
  uint32_t best = VG_NONE;

  memset(common, 0, n_part * sizeof *common);
  for (size_t q = first; q < d->g.n; q++) {
    if (piece[q] != n) continue;
    for (uint64_t k = d->begin[q]; k < d->begin[q + 1]; k++)
      if (piece[d->to[k]] != n) common[part[d->to[k]]] += d->edge[k];
  }
  for (uint32_t p = 0; p < n_part; p++)
    if (common[p] > 0 && (best == VG_NONE || common[p] > common[best]))
      best = p;
  return best;
}

struct piece {
  double weight;
  size_t first;
  uint32_t part;
};

/* Moves small components, whose subdomain has a larger one, to an adjacent
 * subdomain. */
static int give_away(const struct dual *d, struct vg_coarse *c,
                     uint32_t n_piece, const uint32_t *piece, struct piece *of,
                     double *common)
{
  double mean = 0, *best = vg_calloc(c->n_part, sizeof *best);
  uint32_t n_given = 0;

  if (!best) return -1;
  memset(of, 0, n_piece * sizeof *of);
  for (size_t q = d->g.n; q-- > 0;) {
    of[piece[q]].weight += c->weight[q];
    of[piece[q]].first = q;
    of[piece[q]].part = c->part[q];
    mean += c->weight[q] / c->n_part;
  }
  for (uint32_t k = 0; k < n_piece; k++)
    best[of[k].part] = fmax(best[of[k].part], of[k].weight);
  for (uint32_t k = 0; k < n_piece; k++) {
    uint32_t to;

    if (of[k].weight >= best[of[k].part] || of[k].weight >= small_piece * mean)
      continue;
    to = adjacent_part(d, c->part, piece, of[k].first, k, common, c->n_part);
    if (to == VG_NONE) continue;
    for (size_t q = of[k].first; q < d->g.n; q++)
      if (piece[q] == k) c->part[q] = to;
    n_given++;
  }
  free(best);
  return n_given > 0;
}

/* Makes each component a subdomain, after moving small ones to adjacent
 * subdomains where there are any. */
static vg_status settle_pieces(const struct dual *d, struct vg_coarse *c,
                               struct vg_error *err)
{
  uint32_t *piece = vg_alloc(d->g.n, sizeof *piece);
  uint32_t *queue = vg_alloc(d->g.n, sizeof *queue);
  struct piece *of = vg_alloc(d->g.n, sizeof *of);
  double *common = vg_alloc(c->n_part, sizeof *common);
  int again = piece && queue && of && common ? 1 : -1;
  vg_status st = VG_OK;

  for (int round = 0; again > 0 && round < 4; round++) {
    uint32_t n = find_pieces(d, c->part, piece, queue);

    again = give_away(d, c, n, piece, of, common);
  }
  if (again < 0)
    st = vg_fail_memory(err, "assigning the coarse mesh to subdomains");
  else {
    c->n_part = find_pieces(d, c->part, piece, queue);
    memcpy(c->part, piece, d->g.n * sizeof *piece);
  }
  free(piece);
  free(queue);
  free(of);
  free(common);
  return st;
}

/* --- smooth interfaces --------------------------------------------------- */

/* Moves a cell that shares more with another subdomain than with its own to
 * that subdomain, if that subdomain does not grow too much. This removes the
 * teeth of interfaces. */
static vg_status even_out(const struct dual *d, struct vg_coarse *c,
                          struct vg_error *err)
{
  double *sum = vg_calloc(c->n_part, sizeof *sum), all = 0;
  size_t n_moved = 1;

  if (!sum)
    return vg_fail_memory(err, "assigning the coarse mesh to subdomains");
  for (size_t q = 0; q < d->g.n; q++) {
    sum[c->part[q]] += c->weight[q];
    all += c->weight[q];
  }
  for (int sweep = 0; sweep < EVEN_SWEEPS && n_moved; sweep++) {
    n_moved = 0;
    for (size_t q = 0; q < d->g.n; q++) {
      uint32_t own = c->part[q], best = own;
      double most = 0, here = 0;

      for (uint64_t k = d->begin[q]; k < d->begin[q + 1]; k++) {
        uint32_t p = c->part[d->to[k]];
        double common = 0;

        for (uint64_t j = d->begin[q]; j < d->begin[q + 1]; j++)
          if (c->part[d->to[j]] == p) common += d->edge[j];
        if (p == own) here = common;
        else if (common > most) {
          most = common;
          best = p;
        }
      }
      if (!(most > here) || sum[best] + c->weight[q] > evened * all / c->n_part)
        continue;
      sum[own] -= c->weight[q];
      sum[best] += c->weight[q];
      c->part[q] = best;
      n_moved++;
    }
  }
  free(sum);
  return VG_OK;
}

/* --- all steps ----------------------------------------------------------- */

static vg_status bisect(struct vg_coarse *c, int n_part, struct vg_error *err)
{
  double(*mid)[3] = vg_calloc(c->t.n_cell, sizeof *mid);
  vg_status st;

  if (!mid)
    return vg_fail_memory(err, "assigning the coarse mesh to subdomains");
  for (size_t q = 0; q < c->t.n_cell; q++)
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++)
        mid[q][k] += 0.25 * c->t.x[c->t.cell[q].v[i]][k];
  st = vg_bisect(c->t.n_cell, (const double(*)[3])mid, c->weight, n_part,
                 c->part, err);
  free(mid);
  return st;
}

static int is_connected(const struct dual *d, uint32_t *part,
                        struct vg_error *err, vg_status *st)
{
  uint32_t *piece = vg_alloc(d->g.n, sizeof *piece);
  uint32_t *queue = vg_alloc(d->g.n, sizeof *queue);
  uint32_t n = 0;

  memset(part, 0, d->g.n * sizeof *part);
  if (piece && queue) n = find_pieces(d, part, piece, queue);
  else *st = vg_fail_memory(err, "assigning the coarse mesh to subdomains");
  free(piece);
  free(queue);
  return n == 1;
}

static vg_status assign_cells(struct vg_coarse *c, const struct dual *d,
                              const struct vg_decomposition_options *o,
                              struct vg_error *err)
{
  struct vg_graph_options how = { o->n_part, imbalance, 0, &c->other_seconds };
  vg_status st = VG_OK;

  if (o->partitioner == VG_PARTITIONER_RCB) return bisect(c, o->n_part, err);
  how.contiguous = is_connected(d, c->part, err, &st);
  return st < 0 ? st : vg_graph_part(&d->g, &how, c->part, err);
}

vg_status vg_coarse_assign(struct vg_coarse *c, const struct vg_load *load,
                           const struct vg_sizing *sizing,
                           const struct vg_decomposition_options *o,
                           const struct vg_engine *e, uint64_t *n_apart,
                           struct vg_error *err)
{
  struct weights w = { c,
                       load,
                       NULL,
                       sizing,
                       o->cells_per_cube,
                       vg_alloc(c->t.n_cell, sizeof *w.flat) };
  struct dual d = { .begin = NULL };
  vg_status st = VG_OK;

  assert(c->on && !c->weight && !c->part && o->n_part >= 1 && n_apart);
  c->weight = vg_alloc(c->t.n_cell, sizeof *c->weight);
  c->part = vg_alloc(c->t.n_cell, sizeof *c->part);
  c->n_part = (uint32_t)o->n_part;
  if (!c->weight || !c->part || !w.flat) {
    st = vg_fail_memory(err, "assigning the coarse mesh to subdomains");
    goto done;
  }
  VG_TRY(vg_load_finder_new(load, &w.finder, err));
  vg_engine_loop(e, c->t.n_cell, 256, weigh, &w);
  VG_TRY(make_dual(&w, &d, err));
  VG_TRY(assign_cells(c, &d, o, err));
  VG_TRY(even_out(&d, c, err));
  VG_TRY(settle_pieces(&d, c, err));
  *n_apart = c->n_part > (uint32_t)o->n_part ? c->n_part - (uint32_t)o->n_part
                                             : 0;
done:
  free(w.flat);
  vg_load_finder_free(w.finder);
  dual_release(&d);
  return st;
}
