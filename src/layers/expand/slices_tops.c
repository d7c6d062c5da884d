/* Volumes on both sides of the tops of layers.
 *
 * The front's points come first in the field, so a cell of the field that
 * stands on a top has three of the front's numbers; a table of the front's
 * triangles tells which top. The cell below follows from the columns. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/quality.h"
#include "layers/expand/slices_parts.h"

struct tops {
  const struct vg_join_plan *p;
  uint32_t *slot;          /* [mask + 1] triangle of the front, VG_NO_INDEX:
                              vacant */
  size_t mask;
  double *ratio;           /* [n_face]; a top has one cell of the field, so
                              one thread writes it */
};

static void sort3(const uint32_t v[3], uint32_t s[3])
{
  uint32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];

  s[0] = v[2] < low ? v[2] : low;
  s[2] = v[2] > high ? v[2] : high;
  s[1] = v[2] < low ? low : v[2] > high ? high : v[2];
}

/* Where a triangle is in the table, or would go. */
static size_t find(const struct tops *t, const uint32_t v[3])
{
  const uint32_t (*tri)[3] = (const uint32_t (*)[3])t->p->front->face;
  uint32_t key[3], other[3];
  uint64_t mix;
  size_t i;

  sort3(v, key);
  mix = ((uint64_t)key[0] << 32 | key[1]) * UINT64_C(0x9E3779B97F4A7C15) +
        key[2] * UINT64_C(0xC2B2AE3D27D4EB4F);
  for (i = (size_t)(mix >> 24) & t->mask; t->slot[i] != VG_NO_INDEX;
       i = (i + 1) & t->mask) {
    sort3(tri[t->slot[i]], other);
    if (!memcmp(key, other, sizeof key)) break;
  }
  return i;
}

static vg_status make_table(struct tops *t, struct vg_error *err)
{
  const struct vg_front *f = t->p->front;
  size_t size = 16;

  while (size < 2 * f->n_face) size *= 2;
  t->slot = vg_alloc(size, sizeof *t->slot);
  if (!t->slot) return vg_fail_memory(err, "the tops of the layers");
  t->mask = size - 1;
  memset(t->slot, 0xff, size * sizeof *t->slot);
  for (size_t i = 0; i < f->n_face; i++)
    if (f->face_id[i] != VG_NO_INDEX)
      t->slot[find(t, f->face[i])] = (uint32_t)i;
  return VG_OK;
}

/* Of the layers' cell that has the top of a face; 0: there is none. */
static double volume_below(const struct tops *t, size_t face)
{
  const struct vg_columns *c = t->p->columns;
  double d[VG_LEVELS_MAX + 1], column[VG_LEVELS_MAX + 1][3], x[6][3];
  uint32_t node[6];
  int n_node = vg_expand_top(&t->p->expand, face, node);

  if (!n_node) return 0;
  for (int k = 0; k < 3; k++) {
    uint32_t i = c->face[face][k];
    unsigned n = c->column[i].n;

    vg_column_points(c, t->p->surface, i, d, column);
    memcpy(x[k], column[n ? n - 1 : 0], sizeof *x);
    memcpy(x[3 + k], column[n], sizeof *x);
  }
  return vg_cell_volume((const double (*)[3])x, n_node - 4, node);
}

static void meet(const struct tops *t, const struct vg_slice *s,
                 const uint32_t cell[4], const uint32_t v[3])
{
  static const uint32_t whole[4] = { 0, 1, 2, 3 };
  const struct vg_front *f = t->p->front;
  uint32_t i = t->slot[find(t, v)];
  double x[4][3], above, below;

  if (i == VG_NO_INDEX) return;
  below = volume_below(t, f->face_id[i]);
  if (!(below > 0)) return;
  for (int k = 0; k < 4; k++) memcpy(x[k], s->x[cell[k]], sizeof *x);
  above = vg_cell_volume((const double (*)[3])x, 0, whole);
  t->ratio[f->face_id[i]] = above > below ? above / below : below / above;
}

static vg_status look_through(void *context, const struct vg_slice *s,
                              struct vg_error *err)
{
  const struct tops *t = context;
  const uint32_t (*tet)[4] = (const uint32_t (*)[4])s->cell[VG_SLICE_TET];
  size_t n_front = t->p->front->n_point;

  (void)err;
  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET]; i++) {
    uint32_t v[4];
    int n = 0;

    for (int k = 0; k < 4; k++) {
      v[k] = s->id[tet[i][k]];
      n += v[k] < n_front;
    }
    for (int k = 0; k < 4 && n >= 3; k++) {
      const uint32_t face[3] = { v[(k + 1) % 4], v[(k + 2) % 4],
                                 v[(k + 3) % 4] };

      if (n == 4 || v[k] >= n_front) meet(t, s, tet[i], face);
    }
  }
  return VG_OK;
}

vg_status vg_layer_tops(struct vg_comm *comm, const struct vg_join_plan *p,
                        const struct vg_slices *field, double *ratio,
                        struct vg_error *err)
{
  struct tops t = { .p = p, .ratio = ratio };
  vg_status st;

  memset(ratio, 0, p->columns->n_face * sizeof *ratio);
  VG_TRY(make_table(&t, err));
  st = vg_slices_each(field, p->expand.threads, look_through, &t, err);
done:
  free(t.slot);
  st = vg_comm_agree(comm, st, err);
  return st < 0 ? st : vg_comm_max(comm, p->columns->n_face, ratio, err);
}
