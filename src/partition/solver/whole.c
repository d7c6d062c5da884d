/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Partitions of a mesh in one piece. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/mesh/zones.h"
#include "partition/solver/solver_parts.h"

/* With clusters, the boundaries of partitions follow the ragged boundaries of
 * clusters. This many rounds of moving single cells straighten them. */
#define ROUNDS 4 /* P3 */

struct smoothing {
  const struct vg_cell_links *l;
  const struct vg_units *u;
  const struct vg_unit_options *o;
  double *load;   /* [n_part] */
  double most;    /* Upper limit of the load of a partition. */
  uint32_t *part; /* [n_cell] */
};

static double weight_of(const struct vg_cell_links *l,
                        const struct vg_unit_options *o, uint32_t cell)
{
  return o->cell_weight    ? o->cell_weight[cell]
       : cell < l->end_tet ? o->weight[0]
       : cell < l->end_pyr ? o->weight[1]
       : cell < l->end_pri ? o->weight[2]
                           : o->weight[3];
}

/* Weights of the cells by kinds and zones; NULL if zones have no weights. */
static vg_status weigh_zones(const struct vg_mesh *m,
                             const struct vg_solver_options *o, double **weight,
                             struct vg_error *err)
{
  const size_t n[VG_SOLVER_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  double *to;

  *weight = NULL;
  if (!o->zone_weight || !m->n_zone) return VG_OK;
  to = *weight = vg_alloc(n[0] + n[1] + n[2] + n[3], sizeof *to);
  if (!to) return vg_fail_memory(err, "the weights of the cells");
  for (int k = 0; k < VG_SOLVER_KINDS; k++) {
    size_t z = 0;
    uint64_t end = 0;

    for (size_t c = 0; c < n[k]; c++) {
      vg_mesh_zone_walk(m, k, c, &z, &end);
      *to++ = o->weight[k] * o->zone_weight[z];
    }
  }
  return VG_OK;
}

/* The first cells of the zones that stay whole; NULL if none does. */
static vg_status keep_zones(const struct vg_mesh *m,
                            const struct vg_solver_options *o, uint32_t **first,
                            struct vg_error *err)
{
  const size_t n[VG_SOLVER_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  uint32_t *of_zone, cell = 0;

  *first = NULL;
  if (!o->is_whole || !m->n_zone) return VG_OK;
  *first = vg_alloc(n[0] + n[1] + n[2] + n[3], sizeof **first);
  of_zone = vg_alloc(m->n_zone, sizeof *of_zone);
  if (!*first || !of_zone) {
    free(of_zone);
    return vg_fail_memory(err, "the zones of the cells");
  }
  memset(of_zone, 0xff, m->n_zone * sizeof *of_zone);
  for (int k = 0; k < VG_SOLVER_KINDS; k++) {
    size_t z = 0;
    uint64_t end = 0;

    for (size_t c = 0; c < n[k]; c++, cell++) {
      vg_mesh_zone_walk(m, k, c, &z, &end);
      if (o->is_whole[z] && of_zone[z] == UINT32_MAX) of_zone[z] = cell;
      (*first)[cell] = of_zone[z];
    }
  }
  free(of_zone);
  return VG_OK;
}

/* The partition that contains most of a cell's neighbours: its own unless
 * another one is better, the lowest of equals. */
static uint32_t better(const struct smoothing *s, uint32_t cell)
{
  uint32_t own = s->part[cell], best = own, part[6];
  int faces[6], n = 0, most;

  part[n] = own;
  faces[n++] = 0;
  for (int i = 0; i < vg_half_faces(s->l, cell); i++) {
    uint32_t mate = vg_mate(s->l, cell << 3 | (uint32_t)i), p;
    int k = 0;

    if (mate == VG_NO_CELL) continue;
    p = s->part[mate >> 3];
    while (k < n && part[k] != p) k++;
    if (k == 6) continue; /* a hexahedron next to seven partitions */
    if (k == n) {
      part[n] = p;
      faces[n++] = 0;
    }
    faces[k]++;
  }
  most = faces[0];
  for (int k = 1; k < n; k++)
    if (faces[k] > most ||
        (faces[k] == most && best != own && part[k] < best)) {
      most = faces[k];
      best = part[k];
    }
  return best;
}

static void smooth(struct smoothing *s)
{
  for (int round = 0; round < ROUNDS; round++)
    for (uint32_t cell = 0; cell < s->l->n_cell; cell++) {
      uint32_t own = s->part[cell], to;
      double weight;

      if (!s->u->alone[s->u->of[cell]]) continue;
      to = better(s, cell);
      if (to == own) continue;
      weight = weight_of(s->l, s->o, cell);
      if (s->load[to] + weight > s->most || !(s->load[own] > weight)) continue;
      s->load[to] += weight;
      s->load[own] -= weight;
      s->part[cell] = to;
    }
}

static vg_status straighten(const struct vg_cell_links *l,
                            const struct vg_units *u,
                            const struct vg_unit_options *o, uint64_t n_part,
                            uint32_t *part, struct vg_error *err)
{
  struct smoothing s = { l, u, o, NULL, 0, part };

  s.load = vg_calloc(n_part, sizeof *s.load);
  if (!s.load) return vg_fail_memory(err, "the loads of partitions");
  for (uint32_t cell = 0; cell < l->n_cell; cell++)
    s.load[part[cell]] += weight_of(l, o, cell);
  for (uint64_t p = 0; p < n_part; p++)
    if (s.load[p] > s.most) s.most = s.load[p];
  smooth(&s);
  free(s.load);
  return VG_OK;
}

static vg_status tally(const struct vg_cell_links *l,
                       const struct vg_unit_options *o, uint64_t n_part,
                       const uint32_t *part, struct vg_solver_report *r,
                       struct vg_error *err)
{
  struct vg_tally *t = vg_tally_new(n_part);
  int bad = !t;

  for (uint32_t cell = 0; cell < l->n_cell && !bad; cell++) {
    vg_tally_cells(t, part[cell], 1, weight_of(l, o, cell));
    for (int i = 0; i < vg_half_faces(l, cell) && !bad; i++) {
      uint32_t mate = vg_mate(l, cell << 3 | (uint32_t)i) >> 3;

      if (mate < cell) bad = vg_tally_faces(t, part[cell], part[mate], 1);
    }
  }
  if (!bad) vg_tally_report(t, r);
  vg_tally_free(t);
  return bad ? vg_fail_memory(err, "counting the faces of partitions") : VG_OK;
}

static struct vg_unit_options unit_options(const struct vg_mesh *m,
                                           const struct vg_solver_layers *at,
                                           const struct vg_solver_options *o)
{
  struct vg_unit_options u = { .cluster = 1, .weight = o->weight };
  uint64_t n_layer = m->n_pri;

  if (at && at->is_known) {
    u.is_known = 1;
    u.n_layer[0] = at->n_tet < m->n_tet ? at->n_tet : m->n_tet;
    u.n_layer[1] = m->n_pyr;
    u.n_layer[3] = m->n_hex;
    n_layer += u.n_layer[0] + u.n_layer[1] + u.n_layer[3];
  }
  if (at) u.is_wall = at->is_wall;
  u.cluster = vg_unit_cluster(o, (uint64_t)vg_mesh_n_cell(m) - n_layer);
  return u;
}

static vg_status part_units(const struct vg_cell_links *l,
                            const struct vg_units *u,
                            const struct vg_solver_options *o, uint32_t *part,
                            struct vg_solver_report *r, struct vg_error *err)
{
  struct vg_unit_graph g = { 0 };
  uint32_t *of_unit = vg_alloc(u->n_unit, sizeof *of_unit);
  vg_status st = of_unit ? VG_OK : vg_fail_memory(err, "the solver partitions");

  if (st >= 0) st = vg_unit_graph_of_links(l, u, &g, err);
  r->time_graph = vg_clock() - r->time_graph;
  if (st >= 0)
    st = vg_unit_graph_part(&g, u->weight, o->n_part, of_unit, r, err);
  for (uint32_t cell = 0; st >= 0 && cell < l->n_cell; cell++)
    part[cell] = of_unit[u->of[cell]];
  vg_unit_graph_release(&g);
  free(of_unit);
  return st;
}

vg_status vg_solver_part(const struct vg_mesh *m,
                         const struct vg_solver_layers *layers,
                         const struct vg_solver_options *o, const char *name,
                         uint32_t *part, struct vg_solver_report *report,
                         struct vg_error *err)
{
  assert(o && name && report);
  assert(part || !vg_mesh_n_cell(m));

  struct vg_solver_report r = { .time_graph = vg_clock() };
  struct vg_unit_options uo = unit_options(m, layers, o);
  struct vg_cell_links l = VG_CELL_LINKS_INIT;
  struct vg_units u = VG_UNITS_INIT;
  double *weight = NULL;
  uint32_t *together = NULL;
  vg_status st;

  VG_TRY(weigh_zones(m, o, &weight, err));
  VG_TRY(keep_zones(m, o, &together, err));
  uo.cell_weight = weight;
  uo.together = together;
  VG_TRY(vg_cell_links_build(&l, m, 0, name, err));
  VG_TRY(vg_units_make(&l, &uo, &u, err));
  VG_TRY(part_units(&l, &u, o, part, &r, err));
  if (uo.cluster > 1) VG_TRY(straighten(&l, &u, &uo, o->n_part, part, err));
  VG_TRY(tally(&l, &uo, o->n_part, part, &r, err));
  r.n_stack = u.n_stack;
  r.n_stack_cell = u.n_stack_cell;
  r.most_stack = u.most_stack;
  r.has_loose = u.has_loose;
  *report = r;
done:
  free(weight);
  free(together);
  vg_units_release(&u);
  vg_cell_links_release(&l);
  return st;
}
