/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sheets with one orientation for each connected piece, so that all triangles
 * of a patch are on one side. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/edges.h"
#include "core/sides/inner_parts.h"

enum { UNSEEN, KEPT, TURNED };

struct orient {
  const struct vg_inner_work *s;
  const uint32_t (*tri)[3];
  struct vg_edges e; /* of the triangles of sheets */
  uint8_t *way;      /* [m->n_tri] */
  uint32_t *stack;   /* [m->n_tri] */
};

/* The half-edge of the neighbour across h: that of the only other triangle of
 * the patch at this edge, or UINT32_MAX. */
static uint32_t mate_of(const struct orient *o, uint32_t h)
{
  const uint32_t *patch = o->s->m->tri_patch;
  const uint32_t i = o->e.of_half[h];
  uint32_t mate = UINT32_MAX;

  for (uint32_t k = 0; k < vg_edges_count(&o->e, i); k++) {
    const uint32_t g = vg_edges_at(&o->e, i)[k];

    if (g == h || patch[g / 3] != patch[h / 3]) continue;
    if (mate != UINT32_MAX) return UINT32_MAX;
    mate = g;
  }
  return mate;
}

static void middle_of(const struct orient *o, uint32_t t, double x[3])
{
  const double(*p)[3] = (const double(*)[3])o->s->m->point;

  for (int d = 0; d < 3; d++)
    x[d] = (p[o->tri[t][0]][d] + p[o->tri[t][1]][d] + p[o->tri[t][2]][d]) / 3;
}

static vg_status refuse_one_sided(const struct orient *o, uint32_t h,
                                  struct vg_error *err)
{
  const struct vg_mesh *m = o->s->m;
  const struct vg_patch *p = &m->patch[m->tri_patch[h / 3]];
  const double *a = m->point[vg_half_from(o->tri, h)];
  const double *b = m->point[vg_half_to(o->tri, h)];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "inner patch %d%s%s has only one side, like a Moebius strip, "
                 "so that its triangles cannot be oriented: a path on it "
                 "returns reversed across the edge from (%g, %g, %g) to "
                 "(%g, %g, %g); divide it into two patches",
                 (int)p->id, *p->name ? " " : "", p->name, a[0], a[1], a[2],
                 b[0], b[1], b[2]);
}

/* Orients the piece of triangle t, the first one of it, like t. */
static vg_status orient_piece(struct orient *o, uint32_t t,
                              struct vg_error *err)
{
  size_t n = 0;

  o->way[t] = KEPT;
  o->stack[n++] = t;
  while (n) {
    const uint32_t u = o->stack[--n];

    for (uint32_t h = 3 * u; h < 3 * u + 3; h++) {
      const uint32_t g = mate_of(o, h);
      int is_turned = o->way[u] == TURNED;

      if (g == UINT32_MAX || g / 3 == u) continue;
      is_turned ^= vg_half_from(o->tri, g) == vg_half_from(o->tri, h);
      if (o->way[g / 3] == UNSEEN) {
        o->way[g / 3] = is_turned ? TURNED : KEPT;
        o->stack[n++] = g / 3;
      } else if (o->way[g / 3] != (is_turned ? TURNED : KEPT)) {
        return refuse_one_sided(o, h, err);
      }
    }
  }
  return VG_OK;
}

static void turn(const struct orient *o)
{
  struct vg_mesh *m = o->s->m;
  struct vg_inner_report *r = o->s->report;

  for (uint32_t t = 0; t < m->n_tri; t++) {
    uint32_t *v = m->tri[t];
    const uint32_t second = v[1];

    if (o->way[t] != TURNED) continue;
    if (!r->n_turned++) middle_of(o, t, r->turned_at);
    v[1] = v[2];
    v[2] = second;
  }
}

vg_status vg_inner_orient(const struct vg_inner_work *s, struct vg_error *err)
{
  struct vg_mesh *m = s->m;
  struct orient o = { .s = s, .tri = (const uint32_t(*)[3])m->tri };
  vg_status st;

  o.way = vg_calloc(m->n_tri, 1);
  o.stack = vg_alloc(m->n_tri, sizeof *o.stack);
  if (!o.way || !o.stack) VG_TRY(vg_fail_memory(err, "the sides of a sheet"));
  for (size_t t = 0; t < m->n_tri; t++) o.way[t] = !vg_is_sheet(s, t);
  VG_TRY(vg_edges_build(&o.e, m->n_point, m->n_tri, o.tri, o.way, KEPT, err));
  for (uint32_t t = 0; t < m->n_tri; t++)
    if (o.way[t] == UNSEEN) VG_TRY(orient_piece(&o, t, err));
  turn(&o);
done:
  vg_edges_release(&o.e);
  free(o.way);
  free(o.stack);
  return st;
}

vg_status vg_inner_turn(struct vg_mesh *m, const uint8_t *is_inner,
                        struct vg_inner_report *report, struct vg_error *err)
{
  const struct vg_inner_work s = { .m = m,
                                   .is_inner = is_inner,
                                   .report = report };

  *report = (struct vg_inner_report){ 0 };
  return vg_inner_orient(&s, err);
}
