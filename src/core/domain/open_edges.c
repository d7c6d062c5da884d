#include "core/domain/open_edges.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

struct edge_end {
  uint32_t other;
  int32_t way;   /* +1 from the lower to the higher vertex, -1 back */
};

static int by_other(const void *pa, const void *pb)
{
  const struct edge_end *a = pa, *b = pb;

  if (a->other != b->other) return a->other < b->other ? -1 : 1;
  return a->way - b->way;
}

static size_t n_side(const struct vg_mesh *m)
{
  return 3 * m->n_tri + 4 * m->n_quad;
}

static void side_at(const struct vg_mesh *m, size_t i, uint32_t *a,
                    uint32_t *b)
{
  if (i < 3 * m->n_tri) {
    *a = m->tri[i / 3][i % 3];
    *b = m->tri[i / 3][(i + 1) % 3];
  } else {
    i -= 3 * m->n_tri;
    *a = m->quad[i / 4][i % 4];
    *b = m->quad[i / 4][(i + 1) % 4];
  }
}

/* Edges of a vertex whose two directions do not cancel. */
static vg_status open_of_vertex(const struct vg_mesh *m, uint32_t v, size_t n,
                                struct edge_end *list, struct vg_border *open,
                                struct vg_error *err)
{
  vg_status st = VG_OK;

  qsort(list, n, sizeof *list, by_other);
  for (size_t i = 0, j; st == VG_OK && i < n; i = j) {
    const double *x = m->point[v], *y = m->point[list[i].other];
    int32_t sum = 0;

    for (j = i; j < n && list[j].other == list[i].other; j++)
      sum += list[j].way;
    if (sum < -1 || sum > 1)
      return vg_fail(err, VG_ERR_GEOMETRY, "edge from (%.9g, %.9g, %.9g) to "
                     "(%.9g, %.9g, %.9g): its triangles run the same way; "
                     "run `vanguard check` on the surface", x[0], x[1], x[2],
                     y[0], y[1], y[2]);
    if (sum > 0) st = vg_border_add(open, list[i].other, v, err);
    if (sum < 0) st = vg_border_add(open, v, list[i].other, err);
  }
  return st;
}

vg_status vg_open_edges(const struct vg_mesh *m, struct vg_border *open,
                        struct vg_error *err)
{
  assert(m && open);

  const size_t n = n_side(m);
  size_t *start = vg_calloc(m->n_point + 2, sizeof *start);
  struct edge_end *list = vg_alloc(n, sizeof *list);
  vg_status st = VG_OK;
  uint32_t a, b;

  if (!start || !list) {
    st = vg_fail_memory(err, "the edges of the surface");
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    side_at(m, i, &a, &b);
    start[(a < b ? a : b) + 2]++;
  }
  for (size_t v = 2; v < m->n_point + 2; v++) start[v] += start[v - 1];
  for (size_t i = 0; i < n; i++) {
    side_at(m, i, &a, &b);
    if (a < b) list[start[a + 1]++] = (struct edge_end){ b, 1 };
    else list[start[b + 1]++] = (struct edge_end){ a, -1 };
  }
  for (uint32_t v = 0; st == VG_OK && v < m->n_point; v++)
    st = open_of_vertex(m, v, start[v + 1] - start[v], list + start[v], open,
                        err);
done:
  free(start);
  free(list);
  return st;
}
