/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Conformity: every face of every cell must match a face of a neighbour or a
 * boundary face.
 *
 * A face is put into the bucket of its lowest node (counting sort), where it
 * is matched by its other nodes. There is no global sort, so the cost is O(n).
 * The records of all buckets would need 64 bytes per tetrahedron. Buckets are
 * therefore made and matched for one range of nodes after the other, in enough
 * passes over the cells to keep the records of a range small.
 *
 * Meshes of tetrahedra only are first passed to quality_pairs.c. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/judge/quality_solver.h"

/* Records per pass: a quarter of all, but not fewer than this. */
#define LEAST_RECORDS ((size_t)1 << 18)
#define N_PASS 4

/* Buckets up to this size are sorted by insertion. Nodes that are the lowest
 * of more faces are hubs, which are rare. */
#define SMALL_BUCKET 48

struct record {
  uint32_t a, b, c; /* the other nodes; c is VG_NO_NODE for triangles */
  uint32_t owner;   /* 2 * (cell, or n_cell + boundary face) + winding */
};

struct table {
  const struct vg_mesh *m;
  uint32_t *start; /* [n_point + 1] number of faces by lowest node; then the
                      end of each bucket of the present range */
  struct record *record;
  uint32_t lo, n; /* nodes of the present range: lo .. lo + n - 1 */
  size_t n_cell;
  uint32_t *parent; /* [n_cell] components */
  const float *volume;
  struct vg_stats *f;
  struct vg_solver_sweep *solver; /* may be NULL */
  struct vg_unpaired *unpaired;   /* NULL: m is a whole mesh */
  int refused;                    /* memory for unpaired faces was refused */
};

static uint32_t lower(uint32_t a, uint32_t b)
{
  return a < b ? a : b;
}
static uint32_t upper(uint32_t a, uint32_t b)
{
  return a < b ? b : a;
}

static void put(struct table *t, uint32_t lowest, uint32_t a, uint32_t b,
                uint32_t c, uint32_t owner)
{
  struct record *r = &t->record[t->start[lowest]++];

  r->a = a;
  r->b = b;
  r->c = c;
  r->owner = owner;
}

/* The winding bit is 1 if the lowest node is followed by the higher one of its
 * two neighbours in the cycle. */
static void put_tri(struct table *t, uint32_t a, uint32_t b, uint32_t c,
                    uint32_t owner)
{
  uint32_t low = lower(lower(a, b), c), next, last;

  if (low - t->lo >= t->n) return;
  if (low == a) next = b, last = c;
  else if (low == b) next = c, last = a;
  else next = a, last = b;
  put(t, low, lower(next, last), upper(next, last), VG_NO_NODE,
      2 * owner + (next > last));
}

static void put_quad(struct table *t, const uint32_t n[4], uint32_t owner)
{
  int s = 0;
  uint32_t next, last;

  for (int i = 1; i < 4; i++)
    if (n[i] < n[s]) s = i;
  if (n[s] - t->lo >= t->n) return;
  next = n[(s + 1) & 3];
  last = n[(s + 3) & 3];
  put(t, n[s], lower(next, last), upper(next, last), n[(s + 2) & 3],
      2 * owner + (next > last));
}

static void put_tets(struct table *t)
{
  const struct vg_mesh *m = t->m;

  for (size_t i = 0; i < m->n_tet; i++) {
    const uint32_t *n = m->tet[i];
    uint32_t owner = (uint32_t)i;
    uint32_t ab = lower(n[0], n[1]), cd = lower(n[2], n[3]);
    uint32_t low = lower(ab, cd);
    uint32_t second = lower(upper(ab, cd),
                            lower(upper(n[0], n[1]), upper(n[2], n[3])));

    /* three faces have the lowest node, the fourth has the second lowest */
    if (low - t->lo >= t->n && second - t->lo >= t->n) continue;
    put_tri(t, n[0], n[2], n[1], owner);
    put_tri(t, n[0], n[1], n[3], owner);
    put_tri(t, n[1], n[2], n[3], owner);
    put_tri(t, n[0], n[3], n[2], owner);
  }
}

static void put_mixed(struct table *t, int kind)
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  struct vg_cells c = vg_mesh_cells(t->m, kind);

  for (size_t i = 0; i < c.n; i++) {
    const uint32_t *n = c.node + i * (size_t)f->n_node;
    uint32_t owner = (uint32_t)(c.first + i);

    for (int j = 0; j < f->n_face; j++) {
      const uint8_t *at = f->node[j];
      uint32_t quad[4];

      if (j < f->n_tri) {
        put_tri(t, n[at[0]], n[at[1]], n[at[2]], owner);
        continue;
      }
      for (int k = 0; k < 4; k++) quad[k] = n[at[k]];
      put_quad(t, quad, owner);
    }
  }
}

static void put_range(struct table *t)
{
  const struct vg_mesh *m = t->m;
  size_t owner = t->n_cell;

  put_tets(t);
  for (int kind = VG_CELL_PYR; kind < VG_CELL_KINDS; kind++) put_mixed(t, kind);
  for (size_t i = 0; i < m->n_tri; i++, owner++)
    put_tri(t, m->tri[i][0], m->tri[i][1], m->tri[i][2], (uint32_t)owner);
  for (size_t i = 0; i < m->n_quad; i++, owner++)
    put_quad(t, m->quad[i], (uint32_t)owner);
}

/* count[v]: number of faces whose lowest node is v. */
static void count_faces(const struct vg_mesh *m, uint32_t *count)
{
  for (size_t i = 0; i < m->n_tet; i++) {
    const uint32_t *n = m->tet[i];
    uint32_t ab = lower(n[0], n[1]), cd = lower(n[2], n[3]);

    count[lower(ab, n[2])]++;
    count[lower(ab, n[3])]++;
    count[lower(n[1], cd)]++;
    count[lower(n[0], cd)]++;
  }
  for (int kind = VG_CELL_PYR; kind < VG_CELL_KINDS; kind++) {
    const struct vg_cell_faces *f = &vg_cell_faces[kind];
    struct vg_cells c = vg_mesh_cells(m, kind);

    for (size_t i = 0; i < c.n; i++)
      for (int j = 0; j < f->n_face; j++) {
        const uint32_t *n = c.node + i * (size_t)f->n_node;
        uint32_t low = n[f->node[j][0]];

        for (int k = 1; k < (j < f->n_tri ? 3 : 4); k++)
          low = lower(low, n[f->node[j][k]]);
        count[low]++;
      }
  }
  for (size_t i = 0; i < m->n_tri; i++)
    count[lower(lower(m->tri[i][0], m->tri[i][1]), m->tri[i][2])]++;
  for (size_t i = 0; i < m->n_quad; i++)
    count[lower(lower(m->quad[i][0], m->quad[i][1]),
                lower(m->quad[i][2], m->quad[i][3]))]++;
}

static int order(const struct record *p, const struct record *q)
{
  if (p->a != q->a) return p->a < q->a ? -1 : 1;
  if (p->b != q->b) return p->b < q->b ? -1 : 1;
  return (p->c > q->c) - (p->c < q->c);
}

/* Equal faces are sorted by owner: cells before boundary faces. */
static int order_all(const void *a, const void *b)
{
  const struct record *p = a, *q = b;
  int o = order(p, q);

  return o ? o : (p->owner > q->owner) - (p->owner < q->owner);
}

static void sort_bucket(struct record *r, size_t n)
{
  if (n > SMALL_BUCKET) {
    qsort(r, n, sizeof *r, order_all);
    return;
  }
  for (size_t i = 1; i < n; i++) {
    struct record x = r[i];
    uint64_t key = (uint64_t)x.a << 32 | x.b;
    size_t j = i;

    for (; j; j--) {
      uint64_t other = (uint64_t)r[j - 1].a << 32 | r[j - 1].b;

      if (other < key || (other == key && r[j - 1].c <= x.c)) break;
      r[j] = r[j - 1];
    }
    r[j] = x;
  }
}

/* Nodes in cyclic order, with the winding of the cell. */
static void face_nodes(uint32_t lowest, const struct record *r,
                       uint32_t node[4])
{
  uint32_t next = r->owner & 1 ? r->b : r->a;
  uint32_t last = r->owner & 1 ? r->a : r->b;
  int quad = r->c != VG_NO_NODE;

  node[0] = lowest;
  node[1] = next;
  node[2] = quad ? r->c : last;
  node[3] = quad ? last : VG_NO_NODE;
}

static int is_shared(const struct vg_unpaired *unpaired, uint32_t lowest,
                     const struct record *r)
{
  uint32_t node[4];

  if (!unpaired->is_shared) return 0;
  face_nodes(lowest, r, node);
  return unpaired->is_shared(unpaired->context, node);
}

/* In a part of a mesh: list the n records of one face, which must be matched
 * with other parts. The cell stands for its component until all components are
 * known. */
static void pass_on(struct table *t, uint32_t lowest, const struct record *r,
                    size_t n)
{
  struct vg_unpaired *unpaired = t->unpaired;

  if (vg_reserve(&unpaired->face, &unpaired->cap_face, unpaired->n_face + n,
                 sizeof *unpaired->face)) {
    t->refused = 1;
    return;
  }
  for (size_t i = 0; i < n; i++, r++) {
    struct vg_unpaired_face *face = &unpaired->face[unpaired->n_face++];

    face_nodes(lowest, r, face->node);
    face->component = face->cell = r->owner >> 1;
    face->volume = t->volume[r->owner >> 1];
  }
}

/* Match the n records of one face. */
static void match(struct table *t, uint32_t lowest, const struct record *r,
                  size_t n)
{
  int same_side = n > 1 && (r[0].owner & 1) == (r[1].owner & 1);
  uint32_t a = r[0].owner >> 1, b;
  size_t n_boundary = 0;

  if (t->unpaired && (n != 2 || is_shared(t->unpaired, lowest, r))) {
    pass_on(t, lowest, r, n);
    return;
  }
  for (size_t i = 0; i < n; i++) n_boundary += r[i].owner >> 1 >= t->n_cell;
  if (t->solver && n == 2 && n_boundary == 1) {
    uint32_t node[4];

    face_nodes(lowest, r, node);
    vg_solver_bound(t->solver, lower(a, r[1].owner >> 1), node);
  }
  if (!vg_stats_face(t->f, n - n_boundary, n_boundary, same_side)) return;
  b = r[1].owner >> 1;
  vg_union(t->parent, a, b);
  vg_stats_ratio(t->f, t->volume[a], t->volume[b]);
  if (t->solver) vg_solver_join(t->solver, a, b);
}

static void match_range(struct table *t)
{
  size_t begin = 0;

  for (uint32_t v = 0; v < t->n; v++) {
    size_t end = t->start[t->lo + v];

    sort_bucket(t->record + begin, end - begin);
    while (begin < end) {
      size_t next = begin + 1;

      while (next < end && !order(t->record + begin, t->record + next)) next++;
      match(t, t->lo + v, t->record + begin, next - begin);
      begin = next;
    }
  }
}

/* Number the components in the order of their first cells. */
static vg_status number_unpaired(struct table *t, struct vg_error *err)
{
  uint32_t *number, n = 0;

  if (!t->unpaired->n_face) return VG_OK;
  number = vg_alloc(t->n_cell, sizeof *number);
  if (!number) return vg_fail_memory(err, "the components of the mesh");
  for (size_t i = 0; i < t->n_cell; i++)
    if (t->parent[i] == i) number[i] = n++;
  for (size_t i = 0; i < t->unpaired->n_face; i++) {
    uint32_t *component = &t->unpaired->face[i].component;

    *component = number[vg_root_of(t->parent, *component)];
  }
  free(number);
  return VG_OK;
}

static void release(struct table *t)
{
  free(t->start);
  free(t->record);
  free(t->parent);
}

/* Find the range of nodes lo .. hi - 1 with at most `room` faces, but at least
 * one node. If change is set, turns the counts of the nodes into starts of
 * buckets. *n_record: number of faces. */
static uint32_t make_range(struct table *t, uint32_t lo, size_t room,
                           int change, size_t *n_record)
{
  size_t n = 0, hi = lo;

  for (; hi < t->m->n_point; hi++) {
    uint32_t count = t->start[hi];

    if (hi > lo && n + count > room) break;
    if (change) t->start[hi] = (uint32_t)n;
    n += count;
  }
  *n_record = n;
  return (uint32_t)hi;
}

static vg_status prepare(struct table *t, size_t room, struct vg_error *err)
{
  size_t most = 0, n;

  count_faces(t->m, t->start);
  for (uint32_t lo = 0; lo < t->m->n_point;) {
    lo = make_range(t, lo, room, 0, &n);
    if (n > most) most = n;
  }
  t->record = vg_alloc(most, sizeof *t->record);
  return t->record ? VG_OK : vg_fail_memory(err, "the table of faces");
}

void vg_unpaired_release(struct vg_unpaired *unpaired)
{
  free(unpaired->face);
  free(unpaired->edge);
  memset(unpaired, 0, sizeof *unpaired);
}

static void part_cells(struct table *t)
{
  for (size_t i = 0; i < t->n_cell; i++) t->parent[i] = (uint32_t)i;
}

/* Collect all sides of each face before matching: works for all kinds of cells
 * and all defects. */
static vg_status match_all(struct table *t, size_t n_record,
                           struct vg_error *err)
{
  size_t room = n_record / N_PASS, n;
  vg_status st;

  if (room < LEAST_RECORDS) room = LEAST_RECORDS;
  t->start = vg_calloc(t->m->n_point, sizeof *t->start);
  if (!t->start) return vg_fail_memory(err, "the faces of the mesh");
  st = prepare(t, room, err);
  if (st < 0) return st;
  part_cells(t);
  for (uint32_t lo = 0, hi; lo < t->m->n_point; lo = hi) {
    hi = make_range(t, lo, room, 1, &n);
    t->lo = lo;
    t->n = hi - lo;
    put_range(t);
    match_range(t);
  }
  return t->refused ? vg_fail_memory(err, "the unmatched faces of a slice")
                    : VG_OK;
}

vg_status vg_judge_faces(const struct vg_mesh *m, const float *volume,
                         struct vg_stats *f, struct vg_solver_sweep *solver,
                         struct vg_unpaired *unpaired, size_t *n_component,
                         struct vg_error *err)
{
  assert(f && n_component);

  struct table t = {
    .m = m, .volume = volume, .f = f, .solver = solver, .unpaired = unpaired
  };
  size_t n_record = 4 * m->n_tet + 5 * (m->n_pyr + m->n_pri) + 6 * m->n_hex +
                    m->n_tri + m->n_quad;
  vg_status st = VG_BLOCKED;

  t.n_cell = vg_mesh_n_cell(m);
  if (t.n_cell + m->n_tri + m->n_quad > UINT32_MAX / 2 || n_record > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "a mesh of %zu cells is too large for the check of its "
                   "faces (limit 2^30); check parts of it separately",
                   t.n_cell);
  t.parent = vg_alloc(t.n_cell, sizeof *t.parent);
  if (!t.parent) return vg_fail_memory(err, "the faces of the mesh");
  part_cells(&t);
  if (vg_faces_can_pair(m, unpaired))
    VG_TRY(vg_pair_faces(m, volume, f, solver, unpaired, t.parent, err));
  if (st == VG_BLOCKED) VG_TRY(match_all(&t, n_record, err));
  if (unpaired) VG_TRY(number_unpaired(&t, err));
  *n_component = 0;
  for (size_t i = 0; i < t.n_cell; i++) *n_component += t.parent[i] == i;
done:
  release(&t);
  return st;
}
