/* Points of columns: numbers and places. */
#include "layers/expand.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

static void mark_columns(struct vg_expand *e)
{
  const struct vg_columns *c = e->columns;

  for (size_t i = 0; i < c->n_column; i++) {
    e->mark[i] = c->column[i].n;
    if (c->column[i].n > e->n_level) e->n_level = c->column[i].n;
    if (vg_shares_root(c, i)) e->mark[i] |= VG_MARK_SHARED;
  }
  for (size_t r = 0; r < c->n_rim; r++)
    for (int k = 0; k < 2; k++) e->mark[c->rim[r][k]] |= VG_MARK_FLANK;
}

static int group_of(uint16_t mark)
{
  return mark & VG_MARK_FLANK ? VG_FLANK : VG_INNER;
}

/* Columns of a chunk that reach each level. */
static void count_chunk(void *context, size_t first, size_t end, int worker)
{
  struct vg_expand *e = context;
  size_t count[2][VG_LEVELS_MAX + 1] = {{0}}, chunk = first / VG_COLUMN_CHUNK;

  (void)worker;
  for (size_t i = first; i < end; i++)
    count[group_of(e->mark[i])][vg_mark_n(e->mark[i])]++;
  for (int g = 0; g < 2; g++) {
    size_t sum = 0;

    for (size_t l = e->n_level; l; l--) {
      sum += count[g][l];
      e->point[g][(l - 1) * e->n_chunk + chunk] = sum;
    }
  }
}

/* Counts into first indices; returns the total. */
static size_t add_up(size_t *count, size_t n)
{
  size_t sum = 0;

  for (size_t i = 0; i < n; i++) {
    size_t here = count[i];

    count[i] = sum;
    sum += here;
  }
  count[n] = sum;
  return sum;
}

vg_status vg_expand_open(struct vg_expand *e, const struct vg_columns *columns,
                         int mixed, int threads, struct vg_error *err)
{
  size_t n = columns->n_column;

  memset(e, 0, sizeof *e);
  e->columns = columns;
  e->mixed = mixed;
  e->threads = threads;
  for (size_t i = 0; i < n; i++)
    if (columns->column[i].n > VG_LEVELS_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "the column on point %zu has %u levels; at most %d can "
                     "be made", (size_t)columns->column[i].root + 1,
                     columns->column[i].n, VG_LEVELS_MAX);
  e->mark = vg_alloc(n, sizeof *e->mark);
  if (!e->mark) return vg_fail_memory(err, "the levels of the columns");
  mark_columns(e);
  e->n_chunk = n / VG_COLUMN_CHUNK + 1;
  e->n_block = columns->n_face / VG_FACE_BLOCK + 1;
  for (int g = 0; g < 2; g++) {
    e->point[g] = vg_calloc(e->n_level * e->n_chunk + 1, sizeof *e->point[g]);
    if (!e->point[g]) {
      vg_expand_close(e);
      return vg_fail_memory(err, "the numbers of the layer points");
    }
  }
  vg_parallel_for(threads, n, VG_COLUMN_CHUNK, count_chunk, e);
  for (int g = 0; g < 2; g++)
    e->n_point[g] = add_up(e->point[g], e->n_level * e->n_chunk);
  return VG_OK;
}

void vg_expand_close(struct vg_expand *e)
{
  free(e->mark);
  for (int g = 0; g < 2; g++) free(e->point[g]);
  for (int k = 0; k < VG_N_KIND; k++) free(e->cell[k]);
  memset(e, 0, sizeof *e);
}

void vg_expand_place(struct vg_expand *e, int group, size_t first)
{
  for (size_t i = 0; i <= e->n_level * e->n_chunk; i++)
    e->point[group][i] += first;
}

struct points {
  const struct vg_expand *e;
  const struct vg_mesh *surface;
  const uint32_t *root;
  double (*point)[3];
  uint32_t *top;
};

static void place_chunk(void *context, size_t first, size_t end, int worker)
{
  const struct points *p = context;
  const struct vg_expand *e = p->e;
  size_t next[2][VG_LEVELS_MAX + 1], chunk = first / VG_COLUMN_CHUNK;
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];

  (void)worker;
  for (int g = 0; g < 2; g++)
    for (size_t l = 1; l <= e->n_level; l++)
      next[g][l] = e->point[g][(l - 1) * e->n_chunk + chunk];
  for (size_t i = first; i < end; i++) {
    size_t *at = next[group_of(e->mark[i])];
    unsigned n = vg_mark_n(e->mark[i]);

    p->top[i] = p->root[e->columns->column[i].root];
    if (!n) continue;
    vg_column_points(e->columns, p->surface, i, d, x);
    p->top[i] = (uint32_t)at[n];
    for (unsigned l = 1; l <= n; l++)
      memcpy(p->point[at[l]++], x[l], sizeof x[l]);
  }
}

void vg_expand_points(const struct vg_expand *e, const struct vg_mesh *surface,
                      const uint32_t *root, double (*point)[3], uint32_t *top)
{
  struct points p = { e, surface, root, point, top };

  vg_parallel_for(e->threads, e->columns->n_column, VG_COLUMN_CHUNK,
                  place_chunk, &p);
}

struct numbers {
  const struct vg_expand *e;
  size_t level;
  uint32_t *id;
};

static void number_chunk(void *context, size_t first, size_t end, int worker)
{
  const struct numbers *n = context;
  const struct vg_expand *e = n->e;
  size_t at = (n->level - 1) * e->n_chunk + first / VG_COLUMN_CHUNK;
  size_t next[2] = { e->point[0][at], e->point[1][at] };

  (void)worker;
  for (size_t i = first; i < end; i++)
    n->id[i] = vg_mark_n(e->mark[i]) < n->level
             ? VG_NO_INDEX : (uint32_t)next[group_of(e->mark[i])]++;
}

void vg_expand_level(const struct vg_expand *e, size_t l, uint32_t *id)
{
  struct numbers n = { e, l, id };

  vg_parallel_for(e->threads, e->columns->n_column, VG_COLUMN_CHUNK,
                  number_chunk, &n);
}
