/* Faces and edges between parts. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/discrete/discrete_parts.h"

void vg_interface_release(struct vg_interface *f)
{
  free(f->side);
  free(f->edge);
  free(f->end);
  free(f->n_around);
  memset(f, 0, sizeof *f);
}

void vg_interface_corners(const struct vg_coarse *c,
                          const struct vg_interface *f, size_t i,
                          uint32_t v[3])
{
  const struct vg_cell *cell = &c->t.cell[f->side[i] >> 2];

  for (int k = 0; k < 3; k++) v[k] = cell->v[vg_face[f->side[i] & 3][k]];
}

/* An edge of a face: place is 3 * face + k. */
struct listed { uint32_t end[2], place; };

static int by_ends(const void *a, const void *b)
{
  const struct listed *s = a, *t = b;

  for (int k = 0; k < 2; k++)
    if (s->end[k] != t->end[k]) return s->end[k] < t->end[k] ? -1 : 1;
  return (s->place > t->place) - (s->place < t->place);
}

static vg_status list_sides(const struct vg_coarse *c, struct vg_interface *f,
                            struct vg_error *err)
{
  size_t cap = 0;

  for (size_t q = 0; q < c->t.n_cell; q++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = c->t.cell[q].link[i];

      if (link == VG_NONE || link >> 2 < q || c->part[link >> 2] == c->part[q])
        continue;
      if (vg_reserve(&f->side, &cap, f->n_face + 1, sizeof *f->side))
        return vg_fail_memory(err, "the interfaces");
      f->side[f->n_face++] = (uint32_t)(4 * q + i);
    }
  return VG_OK;
}

static void number_edges(struct vg_interface *f, size_t n,
                         const struct listed *l)
{
  for (size_t k = 0; k < n; k++) {
    if (!k || memcmp(l[k].end, l[k - 1].end, sizeof l[k].end)) {
      memcpy(f->end[f->n_edge], l[k].end, sizeof *f->end);
      f->n_around[f->n_edge++] = 0;
    }
    f->n_around[f->n_edge - 1]++;
    f->edge[l[k].place / 3][l[k].place % 3] = (uint32_t)(f->n_edge - 1);
  }
}

vg_status vg_interface_list(const struct vg_coarse *c,
                            struct vg_interface *f, struct vg_error *err)
{
  struct listed *l;
  size_t n;
  vg_status st = list_sides(c, f, err);

  if (st < 0) return st;
  n = 3 * f->n_face;
  l = vg_alloc(n, sizeof *l);
  f->edge = vg_alloc(f->n_face, sizeof *f->edge);
  f->end = vg_alloc(n, sizeof *f->end);
  f->n_around = vg_alloc(n, sizeof *f->n_around);
  if (!l || !f->edge || !f->end || !f->n_around) {
    free(l);
    return vg_fail_memory(err, "the interfaces");
  }
  for (size_t i = 0; i < f->n_face; i++) {
    uint32_t v[3];

    vg_interface_corners(c, f, i, v);
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t a = v[k], b = v[(k + 1) % 3];

      l[3 * i + k] = (struct listed){ { a < b ? a : b, a < b ? b : a },
                                      (uint32_t)(3 * i + k) };
    }
  }
  if (n) qsort(l, n, sizeof *l, by_ends);
  number_edges(f, n, l);
  free(l);
  return VG_OK;
}
