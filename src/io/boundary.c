#include "io/boundary.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/predicates.h"

/* --- tags --- */

static int by_value(const void *a, const void *b)
{
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;

  return (x > y) - (x < y);
}

static size_t sort_unique(int32_t *list, size_t n)
{
  size_t k = 0;

  qsort(list, n, sizeof *list, by_value);
  for (size_t i = 0; i < n; i++)
    if (!i || list[i] != list[i - 1]) list[k++] = list[i];
  return k;
}

/* The distinct tags, ascending. Only changes from one face to the next are
 * listed and the list is compacted when full, so that the common file, with
 * few patches in long runs, costs one pass. */
static vg_status distinct(const int32_t *tag, size_t n, int32_t **list,
                          size_t *n_list, struct vg_error *err)
{
  size_t cap = 0, k = 0, compact_at = 4096;
  int32_t *l = NULL;

  for (size_t i = 0; i < n; i++) {
    if (i && tag[i] == tag[i - 1]) continue;
    if (k == compact_at) {
      k = sort_unique(l, k);
      if (k > compact_at / 2) compact_at *= 2;
    }
    if (vg_reserve(&l, &cap, k + 1, sizeof *l)) {
      free(l);
      return vg_fail_memory(err, "the patches");
    }
    l[k++] = tag[i];
  }
  *list = l;
  *n_list = k ? sort_unique(l, k) : 0;
  return VG_OK;
}

static uint32_t rank_of(const int32_t *list, size_t n, int32_t tag)
{
  size_t lo = 0, hi = n;

  while (hi - lo > 1) {
    size_t mid = lo + (hi - lo) / 2;

    if (list[mid] <= tag) lo = mid;
    else hi = mid;
  }
  return (uint32_t)lo;
}

static void rank_all(const int32_t *list, size_t n_list, const int32_t *tag,
                     size_t n, uint32_t *out)
{
  for (size_t i = 0; i < n; i++)
    out[i] = i && tag[i] == tag[i - 1] ? out[i - 1]
                                       : rank_of(list, n_list, tag[i]);
}

vg_status vg_boundary_tag(struct vg_mesh *m, const int32_t *tag,
                          struct vg_error *err)
{
  struct vg_patch *patch = NULL;
  uint32_t *tri = NULL, *quad = NULL;
  int32_t *list = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(distinct(tag, m->n_tri + m->n_quad, &list, &n, err));
  patch = vg_calloc(n, sizeof *patch);
  tri = vg_alloc(m->n_tri, sizeof *tri);
  quad = vg_alloc(m->n_quad, sizeof *quad);
  if (!patch || !tri || !quad) {
    st = vg_fail_memory(err, "the patches");
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    patch[i].id = list[i];
    patch[i].bc = patch[i].bc_fun3d = patch[i].family = VG_BC_NONE;
  }
  rank_all(list, n, tag, m->n_tri, tri);
  rank_all(list, n, tag + m->n_tri, m->n_quad, quad);
  m->patch = patch;
  m->n_patch = n;
  m->tri_patch = tri;
  m->quad_patch = quad;
  patch = NULL;
  tri = quad = NULL;
done:
  free(patch);
  free(tri);
  free(quad);
  free(list);
  return st;
}

/* Stable counting sort; start[] is shifted by one while it is filled. */
vg_status vg_boundary_by_patch(const struct vg_mesh *m, size_t **start,
                               size_t **order, struct vg_error *err)
{
  size_t n = m->n_tri + m->n_quad;
  size_t *s = vg_calloc(m->n_patch + 2, sizeof *s);
  size_t *o = vg_alloc(n, sizeof *o);

  if (!s || !o) {
    free(s);
    free(o);
    return vg_fail_memory(err, "sorting faces by patch");
  }
#define PATCH(i) \
  ((i) < m->n_tri ? m->tri_patch[i] : m->quad_patch[(i) - m->n_tri])
  for (size_t i = 0; i < n; i++) s[PATCH(i) + 2]++;
  for (size_t p = 2; p < m->n_patch + 2; p++) s[p] += s[p - 1];
  for (size_t i = 0; i < n; i++) o[s[PATCH(i) + 1]++] = i;
#undef PATCH
  *start = s;
  *order = o;
  return VG_OK;
}

/* --- orientation --- */

/* Inward faces of the cells (formats.md 2.3, made 0-based); n is 3 or 4. */
struct face {
  uint8_t n, node[4];
};

struct shape {
  int n_node, n_face;
  uint8_t turn[2][2];       /* node slots to swap for the mirror image */
  int n_turn;
  struct face face[6];
};

static const struct shape tet_shape = {
  4, 4, {{1, 2}}, 1,
  {{3, {1, 3, 2}}, {3, {0, 2, 3}}, {3, {0, 3, 1}}, {3, {0, 1, 2}}}
};
static const struct shape pyr_shape = {
  5, 5, {{3, 1}}, 1,
  {{3, {0, 1, 2}}, {3, {1, 4, 2}}, {3, {2, 4, 3}}, {3, {0, 2, 3}},
   {4, {0, 3, 4, 1}}}
};
static const struct shape pri_shape = {
  6, 5, {{1, 2}, {4, 5}}, 2,
  {{4, {0, 3, 4, 1}}, {4, {1, 4, 5, 2}}, {4, {0, 2, 5, 3}}, {3, {0, 1, 2}},
   {3, {3, 5, 4}}}
};
static const struct shape hex_shape = {
  8, 6, {{1, 3}, {5, 7}}, 2,
  {{4, {0, 3, 7, 4}}, {4, {1, 5, 6, 2}}, {4, {0, 4, 5, 1}}, {4, {2, 6, 7, 3}},
   {4, {0, 1, 2, 3}}, {4, {4, 7, 6, 5}}}
};

/* The cells of m by type, as flat arrays of nodes. */
struct cells {
  const struct shape *shape;
  uint32_t *node;
  size_t n;
};

static void list_cells(const struct vg_mesh *m, struct cells c[4])
{
  c[0] = (struct cells){ &tet_shape, m->tet ? m->tet[0] : NULL, m->n_tet };
  c[1] = (struct cells){ &pyr_shape, m->pyr ? m->pyr[0] : NULL, m->n_pyr };
  c[2] = (struct cells){ &pri_shape, m->pri ? m->pri[0] : NULL, m->n_pri };
  c[3] = (struct cells){ &hex_shape, m->hex ? m->hex[0] : NULL, m->n_hex };
}

/* Six times the signed volume of the tetrahedron o a b c. */
static double volume6(const double o[3], const double a[3], const double b[3],
                      const double c[3])
{
  double u[3], v[3], w[3];

  for (int k = 0; k < 3; k++) {
    u[k] = a[k] - o[k];
    v[k] = b[k] - o[k];
    w[k] = c[k] - o[k];
  }
  return (u[1] * v[2] - u[2] * v[1]) * w[0] +
         (u[2] * v[0] - u[0] * v[2]) * w[1] +
         (u[0] * v[1] - u[1] * v[0]) * w[2];
}

/* A number with the sign of the cell's volume: exact for a tetrahedron, else
 * the sum over the inward faces, a quadrilateral being the mean of its two
 * splits. */
static double cell_sign(const struct vg_mesh *m, const struct shape *s,
                            const uint32_t *cell)
{
  const double *o = m->point[cell[0]];
  double sum = 0;

  if (s == &tet_shape)
    return vg_orient3d(o, m->point[cell[1]], m->point[cell[2]],
                       m->point[cell[3]]);
  for (int i = 0; i < s->n_face; i++) {
    const struct face *f = &s->face[i];
    const double *p[4];

    for (int k = 0; k < f->n; k++) p[k] = m->point[cell[f->node[k]]];
    if (f->n == 3) {
      sum -= 2 * volume6(o, p[0], p[1], p[2]);
      continue;
    }
    sum -= volume6(o, p[0], p[1], p[2]) + volume6(o, p[0], p[2], p[3]) +
           volume6(o, p[0], p[1], p[3]) + volume6(o, p[1], p[2], p[3]);
  }
  return sum;
}

static size_t turn_cells(const struct vg_mesh *m, const struct cells *c)
{
  const struct shape *s = c->shape;
  size_t n = 0;

  for (size_t i = 0; i < c->n; i++) {
    uint32_t *cell = c->node + i * (size_t)s->n_node;

    if (!(cell_sign(m, s, cell) < 0)) continue;
    for (int k = 0; k < s->n_turn; k++) {
      uint32_t t = cell[s->turn[k][0]];

      cell[s->turn[k][0]] = cell[s->turn[k][1]];
      cell[s->turn[k][1]] = t;
    }
    n++;
  }
  return n;
}

/* A face as a key: its nodes ascending, a triangle with UINT32_MAX last, and
 * the node that follows the lowest one, which tells the two orientations. */
struct key {
  uint32_t node[4];
  uint32_t next;
};

static struct key make_key(const uint32_t *node, int n)
{
  struct key k = { { 0, 0, 0, UINT32_MAX }, 0 };
  int low = 0;

  for (int i = 0; i < n; i++) {
    int j = i;

    if (node[i] < node[low]) low = i;
    for (; j && k.node[j - 1] > node[i]; j--) k.node[j] = k.node[j - 1];
    k.node[j] = node[i];
  }
  k.next = node[(low + 1) % n];
  return k;
}

/* Boundary faces by their nodes: open addressing, entries are face + 1.
 * Triangles come first. `first` leads from a repeated face to its first
 * appearance, which alone is in the table. */
struct table {
  const struct vg_mesh *m;
  size_t n, mask;
  uint32_t *slot, *first;
  uint32_t *next;           /* of the cell's face: the right orientation */
  uint8_t *n_cell;          /* cells at the face, at most 2 counted */
  uint8_t *on_boundary;     /* [n_point] */
};

static size_t hash_key(const struct key *k)
{
  uint64_t h = 0;

  for (int i = 0; i < 4; i++)
    h = (h ^ k->node[i]) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
  return (size_t)h;
}

static struct key face_key(const struct vg_mesh *m, size_t face)
{
  return face < m->n_tri ? make_key(m->tri[face], 3)
                         : make_key(m->quad[face - m->n_tri], 4);
}

/* Slot of the key: that of the face with these nodes, or a free one. */
static size_t find(const struct table *t, const struct key *k)
{
  size_t at = hash_key(k) & t->mask;

  for (; t->slot[at]; at = (at + 1) & t->mask) {
    struct key other = face_key(t->m, t->slot[at] - 1);

    if (!memcmp(other.node, k->node, sizeof k->node)) break;
  }
  return at;
}

static void table_release(struct table *t)
{
  free(t->slot);
  free(t->first);
  free(t->next);
  free(t->n_cell);
  free(t->on_boundary);
}

static vg_status table_fill(struct table *t, const struct vg_mesh *m,
                            struct vg_error *err)
{
  size_t size = 16;

  t->m = m;
  t->n = m->n_tri + m->n_quad;
  if (t->n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%zu boundary faces: more than 32-bit numbers allow",
                   t->n);
  while (size < 2 * t->n) size *= 2;
  t->mask = size - 1;
  t->slot = vg_calloc(size, sizeof *t->slot);
  t->first = vg_alloc(t->n, sizeof *t->first);
  t->next = vg_alloc(t->n, sizeof *t->next);
  t->n_cell = vg_calloc(t->n, sizeof *t->n_cell);
  t->on_boundary = vg_calloc(m->n_point, sizeof *t->on_boundary);
  if (!t->slot || !t->first || !t->next || !t->n_cell || !t->on_boundary)
    return vg_fail_memory(err, "the table of boundary faces");
  for (size_t i = 0; i < t->n; i++) {
    struct key k = face_key(m, i);
    size_t at = find(t, &k);

    if (!t->slot[at]) t->slot[at] = (uint32_t)i + 1;
    t->first[i] = t->slot[at] - 1;
    for (int j = 0; j < 4; j++)
      if (k.node[j] != UINT32_MAX) t->on_boundary[k.node[j]] = 1;
  }
  return VG_OK;
}

static void meet_cells(struct table *t, const struct cells *c)
{
  const struct shape *s = c->shape;

  for (size_t i = 0; i < c->n; i++) {
    const uint32_t *cell = c->node + i * (size_t)s->n_node;

    for (int j = 0; j < s->n_face; j++) {
      const struct face *f = &s->face[j];
      uint32_t node[4];
      struct key k;
      size_t at;
      int all = 1;

      for (int l = 0; l < f->n; l++) {
        node[l] = cell[f->node[l]];
        all &= t->on_boundary[node[l]];
      }
      if (!all) continue;
      k = make_key(node, f->n);
      at = find(t, &k);
      if (!t->slot[at]) continue;
      at = t->slot[at] - 1;
      if (t->n_cell[at] < 2) t->n_cell[at]++;
      t->next[at] = k.next;
    }
  }
}

static void swap_nodes(uint32_t *a, uint32_t *b)
{
  uint32_t t = *a;

  *a = *b;
  *b = t;
}

/* Turn the faces [0, n) of one kind, which are number `base` on in the table,
 * and drop those between two cells. Returns how many stay. */
static size_t turn_faces(const struct table *t, size_t base, size_t n,
                         uint32_t *node, size_t width, uint32_t *patch,
                         struct vg_orient_report *r)
{
  size_t kept = 0;

  for (size_t i = 0; i < n; i++) {
    uint32_t *f = node + i * width;
    size_t first = t->first[base + i];
    int n_cell = t->n_cell[first];

    if (n_cell == 2) {
      r->n_face_inner++;
      continue;
    }
    if (!n_cell) {
      r->n_face_loose++;
    } else if (make_key(f, (int)width).next != t->next[first]) {
      swap_nodes(&f[1], &f[width - 1]);
      r->n_face_turned++;
    }
    memmove(node + kept * width, f, width * sizeof *f);
    patch[kept++] = patch[i];
  }
  return kept;
}

vg_status vg_boundary_orient(struct vg_mesh *m, struct vg_orient_report *report,
                             struct vg_error *err)
{
  struct vg_orient_report r = { 0, 0, 0, 0 };
  struct table t = { 0 };
  struct cells cells[4];
  size_t n_tri = m->n_tri;
  vg_status st = VG_OK;

  if (report) *report = r;
  if (!(m->n_tet + m->n_pyr + m->n_pri + m->n_hex)) return VG_OK;
  list_cells(m, cells);
  for (int i = 0; i < 4; i++) r.n_cell_turned += turn_cells(m, &cells[i]);
  if (n_tri + m->n_quad) {
    VG_TRY(table_fill(&t, m, err));
    for (int i = 0; i < 4; i++) meet_cells(&t, &cells[i]);
    if (n_tri)
      m->n_tri = turn_faces(&t, 0, n_tri, m->tri[0], 3, m->tri_patch, &r);
    if (m->n_quad)
      m->n_quad = turn_faces(&t, n_tri, m->n_quad, m->quad[0], 4,
                             m->quad_patch, &r);
  }
  if (report) *report = r;
done:
  table_release(&t);
  return st;
}
