/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Units of cells that stay together: stacks of layer cells, and clusters of
 * the other cells.
 *
 * Vanguard's layer cells stand with the triangle of nodes 0, 1, 2 on the cell
 * below, which is the last cell that raised one of the three points; a
 * tetrahedron raises its node 3, a pyramid 3 and 4, a prism 3, 4, 5
 * (layers/expand/expand_cells.c). If this holds for all cells that are
 * declared as layer cells, joining each cell to the one below gives the
 * stacks. Stacks between the columns of a fan start on the side face of
 * another stack. Its hexahedra stand with the nodes 0 to 3 on the one below.
 * Prisms of any origin are joined across triangles, and hexahedra from walls
 * upwards. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "partition/solver/solver_parts.h"

#define NONE VG_NO_CELL
#define MOST_CLUSTER 64

void vg_units_release(struct vg_units *u)
{
  free(u->of);
  free(u->weight);
  free(u->alone);
  memset(u, 0, sizeof *u);
}

size_t vg_unit_cluster(const struct vg_solver_options *o, uint64_t n_field)
{
  assert(o);

  uint64_t n = o->cluster_above
               ? (n_field + o->cluster_above - 1) / o->cluster_above
               : 1;

  return n < 1 ? 1 : n > MOST_CLUSTER ? MOST_CLUSTER : (size_t)n;
}

struct work {
  const struct vg_cell_links *l;
  const struct vg_unit_options *o;
  uint32_t *up; /* [n_cell] Stacks, as union-find of base/union_find.h. */
  unsigned char *stands; /* [n_cell] 1: in a stack, or alone in a layer. */
  struct vg_units *u;
};

enum kind { TET, PYR, PRI, HEX };

static enum kind kind_of(const struct vg_cell_links *l, uint32_t cell)
{
  return cell < l->end_tet ? TET
       : cell < l->end_pyr ? PYR
       : cell < l->end_pri ? PRI
                           : HEX;
}

/* --- stacks -------------------------------------------------------------- */

static int is_layer(const struct work *w, uint32_t cell)
{
  const struct vg_cell_links *l = w->l;

  switch (kind_of(l, cell)) {
  case TET: return w->o->is_known && cell < w->o->n_layer[0];
  case PYR: return w->o->is_known && cell - l->end_tet < w->o->n_layer[1];
  case PRI: return 1;
  default: return w->o->is_known && cell - l->end_pri < w->o->n_layer[3];
  }
}

/* Bottom face; faces are numbered as in core/mesh/cell_faces.h. */
static uint32_t bottom_of(const struct vg_cell_links *l, uint32_t cell)
{
  return cell << 3 | (kind_of(l, cell) == PYR ? 0 : 3);
}

static int may_carry(const struct vg_cell_links *l, uint32_t code)
{
  switch (kind_of(l, code >> 3)) {
  case TET: return (code & 7) != 3;
  case PYR: return (code & 7) == 2;
  default: return (code & 7) == 4;
  }
}

enum footing { FIRM, ASIDE, NOWHERE };

/* Joins a cell to the cell that carries it. FIRM: it stands on a wall or on a
 * layer cell (a tetrahedron on the preceding one, the order within a stack).
 * ASIDE: on the side face of another stack, as stacks between the columns of a
 * fan start. NOWHERE: at a place where no layer cell of Vanguard stands. */
static enum footing stand(struct work *w, uint32_t cell)
{
  uint32_t below = vg_mate(w->l, bottom_of(w->l, cell));

  if (below == NONE) return FIRM;
  if (!is_layer(w, below >> 3)) return NOWHERE;
  if (kind_of(w->l, cell) == TET && kind_of(w->l, below >> 3) == TET &&
      (below >> 3) + 1 != cell)
    return ASIDE;
  if (may_carry(w->l, below)) vg_union(w->up, cell, below >> 3);
  return FIRM;
}

/* Joins prisms of any origin across both triangles. */
static void join_prisms(struct work *w)
{
  const struct vg_cell_links *l = w->l;

  for (uint32_t cell = l->end_pyr; cell < l->end_pri; cell++)
    for (uint32_t face = 3; face < 5; face++) {
      uint32_t mate = vg_mate(l, cell << 3 | face);

      w->stands[cell] = 1;
      if (mate != NONE && mate >> 3 < cell && kind_of(l, mate >> 3) == PRI &&
          (mate & 7) >= 3)
        vg_union(w->up, cell, mate >> 3);
    }
}

static void forget(struct work *w)
{
  for (uint32_t cell = 0; cell < w->l->n_cell; cell++) {
    w->up[cell] = cell;
    w->stands[cell] = 0;
  }
}

/* Joins a cell to the stack of another one. */
static void add_to_stack(struct work *w, uint32_t cell, uint32_t mate)
{
  w->stands[mate] = 1;
  vg_union(w->up, mate, cell);
}

/* Joins the level between a hexahedron and the two triangles on top of a pair
 * of wall faces: a pyramid on the hexahedron, pyramids on its triangles, and
 * tetrahedra on theirs, whose face 3 is the top. */
static void join_last_level(struct work *w, uint32_t hex)
{
  const struct vg_cell_links *l = w->l;
  const uint32_t low = vg_mate(l, hex << 3 | 5) >> 3;

  if (low == NONE >> 3 || kind_of(l, low) != PYR || !is_layer(w, low)) return;
  add_to_stack(w, hex, low);
  for (uint32_t i = 0; i < 16; i++) {
    const uint32_t side = vg_mate(l, low << 3 | i / 4) >> 3;
    uint32_t tet, above;

    if (side == NONE >> 3 || kind_of(l, side) != PYR) continue;
    add_to_stack(w, hex, side);
    tet = vg_mate(l, side << 3 | i % 4) >> 3;
    if (tet == NONE >> 3 || kind_of(l, tet) != TET || !is_layer(w, tet))
      continue;
    add_to_stack(w, hex, tet);
    above = vg_mate(l, tet << 3 | 3);
    if (above != NONE && is_layer(w, above >> 3) &&
        bottom_of(l, above >> 3) == above)
      add_to_stack(w, hex, above >> 3);
  }
}

/* Joins the hexahedra of Vanguard's layers, whose nodes 0 to 3 are below. */
static void join_layer_hexahedra(struct work *w)
{
  const struct vg_cell_links *l = w->l;

  if (!w->o->is_known) return;
  for (uint32_t i = 0; i < w->o->n_layer[3]; i++) {
    uint32_t cell = l->end_pri + i, mate = vg_mate(l, cell << 3 | 4);

    w->stands[cell] = 1;
    if (mate != NONE && kind_of(l, mate >> 3) == HEX &&
        is_layer(w, mate >> 3) && (mate & 7) == 5)
      vg_union(w->up, cell, mate >> 3);
  }
  for (uint32_t i = 0; i < w->o->n_layer[3]; i++) {
    uint32_t cell = l->end_pri + i, up;

    if (vg_mate(l, cell << 3 | 4) != NONE) continue;
    while ((up = vg_mate(l, cell << 3 | 5)) != NONE &&
           kind_of(l, up >> 3) == HEX)
      cell = up >> 3;
    join_last_level(w, cell);
  }
}

/* Returns 0 if the declared layer cells of a file are not built like
 * Vanguard's: some stand NOWHERE, or too many are ASIDE. In Vanguard's layers
 * only the first cells of stacks in fans are ASIDE, one cell in dozens. */
static int join_layers(struct work *w)
{
  const struct vg_cell_links *l = w->l;
  const uint32_t first[2] = { 0, l->end_tet };
  uint64_t n[3] = { 0, 0, 0 };

  for (int k = 0; k < 2; k++)
    for (uint32_t i = 0; i < w->o->n_layer[k]; i++) {
      if (w->stands[first[k] + i]) continue; /* On hexahedra. */
      w->stands[first[k] + i] = 1;
      n[stand(w, first[k] + i)]++;
    }
  return w->o->is_ours || (!n[NOWHERE] && n[ASIDE] <= n[FIRM] / 2);
}

/* Climbs from a face of a hexahedron on a wall to the hexahedra above.
 * Opposite faces are 0 and 1, 2 and 3, 4 and 5. */
static void climb(struct work *w, uint32_t code)
{
  uint32_t below = NONE;

  while (code != NONE && kind_of(w->l, code >> 3) == HEX &&
         !w->stands[code >> 3]) {
    w->stands[code >> 3] = 1;
    if (below != NONE) vg_union(w->up, code >> 3, below);
    below = code >> 3;
    code = vg_mate(w->l, code ^ 1);
  }
}

static void join_hexahedra(struct work *w)
{
  const struct vg_mesh *m = w->l->m;

  if (!w->o->is_wall || !w->l->boundary) return;
  for (size_t i = 0; i < m->n_quad; i++)
    if (w->o->is_wall[m->quad_patch[i]]) climb(w, w->l->boundary[m->n_tri + i]);
}

/* Zones that are one unit each. */
static void join_zones(struct work *w)
{
  const uint32_t *to = w->o->together;

  for (uint32_t cell = 0; to && cell < w->l->n_cell; cell++) {
    if (to[cell] == UINT32_MAX) continue;
    w->stands[cell] = 1;
    vg_union(w->up, to[cell], cell);
  }
}

static void join_all(struct work *w)
{
  const struct vg_cell_links *l = w->l;
  uint32_t n_loose = l->end_tet;

  forget(w);
  join_layer_hexahedra(w);
  if (w->o->is_known && !join_layers(w)) {
    forget(w);
    w->u->has_loose = 1;
  }
  if (!w->o->is_known && n_loose) w->u->has_loose = 1;
  join_prisms(w);
  /* join prisms with the layer cells above and below them */
  for (uint32_t cell = l->end_pyr;
       w->o->is_known && !w->u->has_loose && cell < l->end_pri; cell++)
    stand(w, cell);
  join_hexahedra(w);
  join_zones(w);
}

/* --- clusters ------------------------------------------------------------ */

/* Gathers cells without a unit, outside layers, around one cell, nearest by
 * faces first. */
static size_t gather(const struct work *w, uint32_t cell, uint32_t *list)
{
  uint32_t *of = w->u->of, unit = of[cell];
  size_t n = 1;

  list[0] = cell;
  for (size_t k = 0; k < n && n < w->o->cluster; k++)
    for (int i = 0; i < vg_half_faces(w->l, list[k]); i++) {
      uint32_t mate = vg_mate(w->l, list[k] << 3 | (uint32_t)i) >> 3;

      if (mate == NONE >> 3 || w->stands[mate] || of[mate] != NONE) continue;
      of[mate] = unit;
      list[n++] = mate;
      if (n == w->o->cluster) break;
    }
  return n;
}

/* The lowest cluster that shares a face with these few cells; NONE: there is
 * none. It avoids small remainders between clusters. */
static uint32_t adjacent(const struct work *w, const uint32_t *list, size_t n)
{
  uint32_t *of = w->u->of, best = NONE;

  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < vg_half_faces(w->l, list[k]); i++) {
      uint32_t mate = vg_mate(w->l, list[k] << 3 | (uint32_t)i) >> 3;

      if (mate == NONE >> 3 || w->stands[mate] || of[mate] == NONE) continue;
      if (of[mate] != of[list[0]] && of[mate] < best) best = of[mate];
    }
  return best;
}

static void number(struct work *w)
{
  struct vg_units *u = w->u;
  uint32_t list[MOST_CLUSTER], next = 0;

  for (uint32_t cell = 0; cell < w->l->n_cell; cell++) {
    if (u->of[cell] != NONE) continue;
    if (w->stands[cell]) { /* roots are the lowest cells of their stacks */
      uint32_t root = vg_root_of(w->up, cell);

      u->of[cell] = root == cell ? next++ : u->of[root];
      continue;
    }
    u->of[cell] = next++;
    if (w->o->cluster > 1) {
      size_t n = gather(w, cell, list);
      uint32_t other = 4 * n < w->o->cluster ? adjacent(w, list, n) : NONE;

      if (other == NONE) continue;
      for (size_t k = 0; k < n; k++) u->of[list[k]] = other;
      next--;
    }
  }
  u->n_unit = next;
}

/* --- all units ----------------------------------------------------------- */

/* Weights of units, and the statistics of stacks by their cells. */
static vg_status weigh(struct work *w, struct vg_error *err)
{
  struct vg_units *u = w->u;
  uint32_t *n = vg_calloc(u->n_unit, sizeof *n);

  u->weight = vg_calloc(u->n_unit, sizeof *u->weight);
  u->alone = vg_alloc(u->n_unit, 1);
  if (!n || !u->weight || !u->alone) {
    free(n);
    return vg_fail_memory(err, "the weights of stacks and cells");
  }
  for (uint32_t cell = 0; cell < w->l->n_cell; cell++) {
    u->weight[u->of[cell]] += w->o->cell_weight
                              ? w->o->cell_weight[cell]
                              : w->o->weight[kind_of(w->l, cell)];
    if (w->stands[cell]) n[u->of[cell]]++;
  }
  for (uint32_t cell = 0; w->o->together && cell < w->l->n_cell; cell++)
    if (w->o->together[cell] != UINT32_MAX) n[u->of[cell]] = 1; /* no stack */
  for (size_t k = 0; k < u->n_unit; k++) {
    u->alone[k] = !n[k];
    if (n[k] < 2) continue;
    u->n_stack++;
    u->n_stack_cell += n[k];
    if (n[k] > u->most_stack) u->most_stack = n[k];
  }
  free(n);
  return VG_OK;
}

vg_status vg_units_make(const struct vg_cell_links *l,
                        const struct vg_unit_options *o, struct vg_units *out,
                        struct vg_error *err)
{
  assert(o->weight && o->cluster >= 1);
  assert(!out->of && !out->weight);

  struct vg_units u = VG_UNITS_INIT;
  struct work w = { l, o, vg_alloc(l->n_cell, sizeof *w.up),
                    vg_alloc(l->n_cell, 1), &u };
  vg_status st = VG_OK;

  u.of = vg_alloc(l->n_cell, sizeof *u.of);
  if (!w.up || !w.stands || !u.of) {
    st = vg_fail_memory(err, "the stacks of a mesh");
  } else {
    memset(u.of, 0xff, l->n_cell * sizeof *u.of);
    join_all(&w);
    number(&w);
    st = weigh(&w, err);
  }
  free(w.up);
  free(w.stands);
  if (st < 0) vg_units_release(&u);
  else *out = u;
  return st;
}
