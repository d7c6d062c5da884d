/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/cuts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "run/picture/cuts_parts.h"

const int vg_cut_angle[VG_CUT_ANGLES] = { 5, 10, 20, 30, 40 };

/* Cosines of these angles. */
static const double cosine[VG_CUT_ANGLES] = {
  0.99619469809174555, 0.98480775301220802, 0.93969262078590843,
  0.86602540378443871, 0.76604444311897801
};

static const uint8_t n_edge[VG_SLICE_KINDS] = { 6, 8, 9, 12 };
static const uint8_t edge[VG_SLICE_KINDS][CORNERS_MAX][2] = {
  [VG_SLICE_TET] = { { 0, 1 },
                     { 0, 2 },
                     { 0, 3 },
                     { 1, 2 },
                     { 1, 3 },
                     { 2, 3 } },
  [VG_SLICE_PYR] = { { 0, 3 },
                     { 3, 4 },
                     { 4, 1 },
                     { 1, 0 },
                     { 0, 2 },
                     { 1, 2 },
                     { 3, 2 },
                     { 4, 2 } },
  [VG_SLICE_PRI] = { { 0, 1 },
                     { 1, 2 },
                     { 2, 0 },
                     { 3, 4 },
                     { 4, 5 },
                     { 5, 3 },
                     { 0, 3 },
                     { 1, 4 },
                     { 2, 5 } },
  [VG_SLICE_HEX] = { { 0, 1 },
                     { 1, 2 },
                     { 2, 3 },
                     { 3, 0 },
                     { 4, 5 },
                     { 5, 6 },
                     { 6, 7 },
                     { 7, 4 },
                     { 0, 4 },
                     { 1, 5 },
                     { 2, 6 },
                     { 3, 7 } }
};

vg_status vg_cuts_new(size_t n, const struct vg_cut *cut, struct vg_cuts **out,
                      struct vg_error *err)
{
  struct vg_cuts *c = vg_calloc(1, sizeof *c);

  assert(n <= VG_CUTS_MAX && (cut || !n) && out);
  if (c) c->at = vg_calloc(n * TILES, sizeof *c->at);
  if (!c || !c->at) {
    free(c);
    return vg_fail_memory(err, "pictures of cuts");
  }
  c->n = n;
  memcpy(c->cut, cut, n * sizeof *cut);
  *out = c;
  return VG_OK;
}

void vg_cuts_free(struct vg_cuts *c)
{
  if (!c) return;
  for (size_t i = 0; i < c->n * TILES; i++) {
    if (c->at[i]) pthread_mutex_destroy(&c->at[i]->lock);
    free(c->at[i]);
  }
  free(c->at);
  free(c);
}

/* --- cells of a slice ---------------------------------------------------- */

/* State of drawing a slice: the cuts whose windows may contain parts of it. For
 * each of these cuts a bit of above[p] is set if point p is above the plane or
 * in it, so that a plane never passes exactly through a point. */
struct drawing {
  struct vg_cuts *c;
  const struct vg_slice *s;
  size_t n, cut[VG_CUTS_MAX];
  uint16_t *above;
};

static void box_of(const struct vg_slice *s, double lo[3], double hi[3])
{
  for (int k = 0; k < 3; k++) lo[k] = hi[k] = s->n_point ? s->x[0][k] : 0;
  for (size_t p = 1; p < s->n_point; p++)
    for (int k = 0; k < 3; k++) {
      double v = s->x[p][k];

      lo[k] = v < lo[k] ? v : lo[k];
      hi[k] = v > hi[k] ? v : hi[k];
    }
}

static void choose_cuts(struct drawing *d)
{
  double lo[3], hi[3];

  box_of(d->s, lo, hi);
  for (size_t i = 0; i < d->c->n; i++) {
    const struct vg_cut *c = &d->c->cut[i];
    int u = c->axis == 0 ? 1 : 0, v = c->axis == 2 ? 1 : 2;
    double wide = c->width / 2, high = wide * VG_CUT_HEIGHT / VG_CUT_WIDTH;

    if (c->at >= lo[c->axis] && c->at <= hi[c->axis] &&
        c->centre[0] + wide >= lo[u] && c->centre[0] - wide <= hi[u] &&
        c->centre[1] + high >= lo[v] && c->centre[1] - high <= hi[v])
      d->cut[d->n++] = i;
  }
}

static void find_sides(struct drawing *d)
{
  memset(d->above, 0, d->s->n_point * sizeof *d->above);
  for (size_t j = 0; j < d->n; j++) {
    const struct vg_cut *c = &d->c->cut[d->cut[j]];
    const double *x = &d->s->x[0][c->axis];

    for (size_t p = 0; p < d->s->n_point; p++)
      d->above[p] |= (uint16_t)((x[3 * p] >= c->at) << j);
  }
}

/* Intersection of the plane with an edge, from below to above: the same
 * position for all cells at the edge. */
static void meet(const struct vg_cut *c, const double *below,
                 const double *above, double p[2])
{
  int u = c->axis == 0 ? 1 : 0, v = c->axis == 2 ? 1 : 2;
  double t = (c->at - below[c->axis]) / (above[c->axis] - below[c->axis]);
  double scale = SAMPLES * VG_CUT_WIDTH / c->width;

  p[0] = (below[u] + t * (above[u] - below[u]) - c->centre[0]) * scale +
         SAMPLES * VG_CUT_WIDTH / 2.0;
  p[1] = SAMPLES * VG_CUT_HEIGHT / 2.0 -
         (below[v] + t * (above[v] - below[v]) - c->centre[1]) * scale;
}

/* Colour step of the smallest dihedral angle of a tetrahedron. */
static int angle_step(const double *const x[4])
{
  double normal[4][3], most = -1;
  int step = VG_CUT_ANGLES;

  for (int f = 0; f < 4; f++) {
    const double *o = x[(f + 1) % 4];
    double a[3], b[3], in[3];

    vg_sub(x[(f + 2) % 4], o, a);
    vg_sub(x[(f + 3) % 4], o, b);
    vg_sub(x[f], o, in);
    vg_cross(a, b, normal[f]);
    if (vg_dot(normal[f], in) > 0)
      for (int k = 0; k < 3; k++) normal[f][k] = -normal[f][k];
    vg_unit(normal[f]);
  }
  for (int f = 0; f < 4; f++)
    for (int g = f + 1; g < 4; g++)
      if (-vg_dot(normal[f], normal[g]) > most)
        most = -vg_dot(normal[f], normal[g]);
  while (step && most > cosine[step - 1]) step--;
  return step;
}

static uint16_t code_of(const struct vg_slice *s, int kind,
                        const uint32_t *node)
{
  const double *x[4];
  int part = PART_LAYER;

  if (s->kind == 0)
    return CODE(kind == VG_SLICE_TET   ? VG_CUT_LAYER_TET
                : kind == VG_SLICE_PYR ? VG_CUT_PYRAMID
                : kind == VG_SLICE_PRI ? VG_CUT_PRISM
                                       : VG_CUT_HEXAHEDRON,
                0, VG_CUT_ANGLES, PART_LAYER);
  for (int k = 0; k < 4; k++) x[k] = s->x[node[k]];
  part = s->kind == 2 ? PART_ZONE
                      : PART_FIRST + (int)(s->domain % (PARTS - PART_FIRST));
  return CODE(VG_CUT_FIELD, 0, angle_step(x), part);
}

static vg_status cut_cell(const struct drawing *d, size_t j, int kind,
                          const uint32_t *node, uint16_t code,
                          struct vg_error *err)
{
  size_t i = d->cut[j];
  struct polygon g = { .n = 0 };

  for (int e = 0; e < n_edge[kind]; e++) {
    uint32_t a = node[edge[kind][e][0]], b = node[edge[kind][e][1]];
    int up = d->above[a] >> j & 1;

    if (up != (d->above[b] >> j & 1))
      meet(&d->c->cut[i], d->s->x[up ? b : a], d->s->x[up ? a : b], g.p[g.n++]);
  }
  return vg_cuts_draw(d->c->at + i * TILES, &g, code, err);
}

/* Bits of the cuts that intersect a cell of n points. */
static inline unsigned cuts_of(const uint16_t *above, const uint32_t *node,
                               int n)
{
  unsigned any = 0, all = ~0u;

  for (int k = 0; k < n; k++) {
    any |= above[node[k]];
    all &= above[node[k]];
  }
  return any & ~all;
}

static vg_status draw_kind(const struct drawing *d, int kind,
                           struct vg_error *err)
{
  int n = vg_slice_width[kind];
  vg_status st = VG_OK;

  for (size_t j = 0; j < d->s->n_cell[kind]; j++) {
    const uint32_t *node = d->s->cell[kind] + j * (size_t)n;
    unsigned cut = kind == VG_SLICE_TET ? cuts_of(d->above, node, 4)
                                        : cuts_of(d->above, node, n);
    uint16_t code;

    if (!cut) continue;
    code = code_of(d->s, kind, node);
    for (size_t i = 0; cut >> i; i++)
      if (cut >> i & 1) VG_TRY(cut_cell(d, i, kind, node, code, err));
  }
done:
  return st;
}

vg_status vg_cuts_put(void *cuts, const struct vg_slice *slice,
                      struct vg_error *err)
{
  struct drawing d = { .c = cuts, .s = slice };
  vg_status st = VG_OK;

  choose_cuts(&d);
  if (!d.n) return VG_OK;
  d.above = vg_alloc(slice->n_point, sizeof *d.above);
  if (d.above) find_sides(&d);
  else st = vg_fail_memory(err, "pictures of cuts");
  for (int kind = 0; kind < VG_SLICE_KINDS && st >= 0; kind++)
    st = draw_kind(&d, kind, err);
  free(d.above);
  return st;
}

/* --- gathering from ranks ------------------------------------------------ */

/* A tile in a message: its position and its samples. */
struct sent {
  uint32_t at;
  uint16_t code[TILE * TILE];
};

static vg_status pack(const struct vg_cuts *c, struct vg_bytes *b,
                      struct vg_error *err)
{
  size_t n = 0, k = 0;
  struct sent *to;

  for (size_t i = 0; i < c->n * TILES; i++) n += c->at[i] != NULL;
  to = vg_alloc(n, sizeof *to);
  if (!to) return vg_fail_memory(err, "pictures of cuts");
  for (size_t i = 0; i < c->n * TILES; i++) {
    if (!c->at[i]) continue;
    to[k].at = (uint32_t)i;
    memcpy(to[k++].code, c->at[i]->code, sizeof to->code);
  }
  *b = (struct vg_bytes){ n * sizeof *to, (unsigned char *)to };
  return VG_OK;
}

static vg_status unpack(struct vg_cuts *c, const struct vg_bytes *b,
                        struct vg_error *err)
{
  const struct sent *from = (const struct sent *)b->data;

  for (size_t k = 0; k < b->n / sizeof *from; k++) {
    struct tile *t = vg_cuts_tile(&c->at[from[k].at]);

    if (!t) return vg_fail_memory(err, "pictures of cuts");
    for (size_t i = 0; i < TILE * TILE; i++)
      if (t->code[i] < from[k].code[i]) t->code[i] = from[k].code[i];
  }
  return VG_OK;
}

vg_status vg_cuts_gather(struct vg_cuts *c, struct vg_comm *comm,
                         struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(comm);
  int rank = vg_comm_rank(comm);
  struct vg_bytes *to = vg_calloc(size, sizeof *to);
  struct vg_bytes *from = vg_calloc(size, sizeof *from);
  vg_status st = to && from ? VG_OK : vg_fail_memory(err, "pictures of cuts");

  if (st >= 0 && rank) st = pack(c, &to[0], err);
  VG_TRY(vg_comm_agree(comm, st, err));
  if (size > 1) VG_TRY(vg_comm_exchange(comm, to, from, err));
  for (size_t i = 0; i < size && st >= 0 && !rank; i++)
    st = unpack(c, &from[i], err);
  st = vg_comm_agree(comm, st, err);
done:
  vg_bytes_release(to, to ? size : 0);
  vg_bytes_release(from, from ? size : 0);
  return st;
}
