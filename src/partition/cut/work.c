/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tasks that make cells: look in the store, otherwise make the cells, and keep
 * the result. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/memory.h"
#include "partition/cut/node.h"

/* Cells per point in isotropic regions; used for a bound on points, not as an
 * estimate. */
static const double cells_per_point = 5.5; /* C12 */

/* Result of a task, as the store keeps it. It does not depend on any id or
 * serial. */
struct made {
  int is_blocked; /* 1: no cells can be made along the zone's region. */
  struct vg_filled filled;      /* The front's points are those of the task. */
  struct vg_fill_report report; /* Without times if it comes from the store. */
};
#define MADE_INIT                                                              \
  {                                                                            \
    .is_blocked = 0                                                            \
  }

/* Stores the report too, so that a resumed run reports on the whole mesh. */
static void made_put(struct vg_writer *w, const struct made *m)
{
  uint64_t is_blocked = (uint64_t)m->is_blocked;

  vg_put(w, 1, sizeof is_blocked, &is_blocked);
  vg_filled_put(w, &m->filled, 1);
  vg_entries_put(&vg_fill_entries, w, &m->report);
}

static void made_get(struct vg_reader *r, struct made *m)
{
  uint64_t is_blocked = 0;

  vg_get(r, 1, sizeof is_blocked, &is_blocked);
  m->is_blocked = is_blocked != 0;
  vg_filled_get(r, &m->filled, 1);
  vg_entries_get(&vg_fill_entries, r, &m->report);
  if (!r->bad) return;
  vg_filled_release(&m->filled);
  *m = (struct made)MADE_INIT;
}

/* --- the store ----------------------------------------------------------- */

/* Digest of everything that determines the result of the task. */
static struct vg_digest key_of(const struct vg_partition *p,
                               const struct vg_front *f,
                               const struct vg_region *region, size_t limit)
{
  struct vg_digest d = p->options.job;
  uint64_t number[2] = { f->n_point, limit };

  d = vg_digest_of(d, sizeof number, number);
  d = vg_digest_of(d, f->n_point * sizeof *f->x, f->x);
  d = vg_digest_of(d, f->n_face * sizeof *f->face, f->face);
  return region ? vg_digest_of(d, sizeof *region, region) : d;
}

static int find(struct vg_partition *p, struct vg_digest key, struct made *m,
                struct vg_error *err)
{
  struct vg_bytes b = { 0, NULL };
  struct vg_reader r;

  if (!p->options.store ||
      vg_store_find(p->options.store, key, &b, err) != VG_OK)
    return 0;
  r = (struct vg_reader){ .data = b.data, .n = b.n };
  made_get(&r, m);
  free(b.data);
  if (r.bad) return 0;
  pthread_mutex_lock(&p->lock);
  p->report.n_found++;
  pthread_mutex_unlock(&p->lock);
  return 1;
}

static void keep(struct vg_partition *p, struct vg_digest key,
                 const struct made *m)
{
  struct vg_writer w = { .cap = 0 };

  if (!p->options.store) return;
  made_put(&w, m);
  if (!w.refused) vg_store_keep(p->options.store, key, w.bytes.n, w.bytes.data);
  free(w.bytes.data);
}

/* --- conversion of cells to a piece -------------------------------------- */

static int add_piece(struct vg_partition *p, const struct vg_piece *piece)
{
  int bad;

  pthread_mutex_lock(&p->lock);
  bad = vg_reserve(&p->piece, &p->cap_piece, p->n_piece + 1, sizeof *p->piece);
  if (!bad) p->piece[p->n_piece++] = *piece;
  pthread_mutex_unlock(&p->lock);
  return bad;
}

/* Numbers the front's points that the cells use, ascending; UINT32_MAX for the
 * others. Returns the number of points used. */
static size_t number_used(const struct vg_filled *m, size_t n_front,
                          uint32_t *number)
{
  size_t n_used = 0;

  memset(number, 0xff, n_front * sizeof *number);
  for (size_t c = 0; c < m->n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (m->cell[c][i] < n_front) number[m->cell[c][i]] = 0;
  for (size_t q = 0; q < n_front; q++)
    if (number[q] != UINT32_MAX) number[q] = (uint32_t)n_used++;
  return n_used;
}

/* Copies the points of the front that the cells use, then the new points, and
 * renumbers the cells. */
static void take_points(struct vg_piece *piece, struct vg_filled *m,
                        const struct vg_front *f, const uint32_t *number,
                        size_t n_used)
{
  for (size_t q = 0; q < f->n_point; q++) {
    if (number[q] == UINT32_MAX) continue;
    piece->in[number[q]] = f->id[q];
    memcpy(piece->x[number[q]], f->x[q], sizeof *piece->x);
  }
  if (m->n_point)
    memcpy(piece->x + n_used, m->x, m->n_point * sizeof *piece->x);
  for (size_t c = 0; c < m->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t *v = &m->cell[c][i];

      *v = *v < f->n_point ? number[*v] : (uint32_t)(*v - f->n_point + n_used);
    }
}

/* Keeps the cells on this rank. */
static vg_status to_piece(struct vg_partition *p, struct vg_filled *m,
                          const struct vg_front *f, uint32_t serial,
                          const char *path, char kind, struct vg_error *err)
{
  struct vg_piece piece = {
    .kind = kind, .serial = serial, .n_point = m->n_point, .n_cell = m->n_cell
  };
  uint32_t *number;
  size_t n_used;

  if (!m->n_cell) return VG_OK;
  number = vg_alloc(f->n_point, sizeof *number);
  if (!number) return vg_fail_memory(err, "the cells of a task");
  n_used = number_used(m, f->n_point, number);
  snprintf(piece.path, sizeof piece.path, "%s", path);
  piece.in = vg_alloc(n_used, sizeof *piece.in);
  piece.x = vg_alloc(n_used + m->n_point, sizeof *piece.x);
  if (!piece.in || !piece.x) goto refused;
  take_points(&piece, m, f, number, n_used);
  if (vg_packed_cells_new(m->n_cell, (const uint32_t(*)[4])m->cell,
                          n_used + m->n_point, &piece.cell))
    goto refused;
  free(m->cell);
  m->cell = NULL;
  /* points that a leaf adopts are the last ones of its front (recut_ids.c) */
  piece.n_in = n_used;
  while (piece.n_in && piece.in[piece.n_in - 1] >> 32 == serial) piece.n_in--;
  piece.n_adopted = n_used - piece.n_in;
  piece.n_point += piece.n_adopted;
  if (add_piece(p, &piece)) goto refused;
  free(number);
  return VG_OK;
refused:
  free(number);
  vg_piece_release(&piece);
  return vg_fail_memory(err, "the cells of a task");
}

/* --- making cells -------------------------------------------------------- */

static void add_report(struct vg_partition *p, const struct vg_fill_report *r)
{
  pthread_mutex_lock(&p->lock);
  vg_entries_add(&vg_fill_entries, &p->report.fill, r);
  pthread_mutex_unlock(&p->lock);
}

/* An external mesher may fill the void of a leaf. */
static vg_status make(struct vg_partition *p, const struct vg_front *f,
                      const struct vg_region *region, size_t limit,
                      struct made *m, const struct vg_engine *e,
                      struct vg_error *err)
{
  const struct vg_fill_options o = { p->options.sweeps, limit,
                                     vg_engine_stop(e) };
  vg_status st = VG_NOT_BETTER;

  if (!region && p->options.mesher)
    st = vg_mesher_fill(p->options.mesher, f, p->sizing, &o, &m->filled,
                        &m->report, err);
  if (st == VG_NOT_BETTER)
    st = vg_fill_front(f, region, p->sizing, &o, &m->filled, &m->report, err);
  if (st != VG_BLOCKED) return st;
  m->is_blocked = 1;
  return VG_OK;
}

static vg_status find_or_make(struct vg_partition *p, const struct vg_front *f,
                              const struct vg_region *region, size_t limit,
                              struct made *m, const struct vg_engine *e,
                              struct vg_error *err)
{
  struct vg_digest key = { { 0, 0 } };
  vg_status st = VG_OK;

  if (p->options.store) key = key_of(p, f, region, limit);
  if (!find(p, key, m, err)) {
    st = make(p, f, region, limit, m, e, err);
    if (st == VG_OK) keep(p, key, m);
  }
  add_report(p, &m->report);
  return st;
}

vg_status vg_work_zone(struct vg_partition *p, const struct vg_work *w,
                       struct vg_change *change, const struct vg_engine *e,
                       struct vg_error *err)
{
  struct made m = MADE_INIT;
  vg_status st = VG_OK;

  assert(w->what == VG_WORK_ZONE && change);
  if (w->part.n_face) st = find_or_make(p, &w->part, &w->region, 0, &m, e, err);
  if (st == VG_OK)
    st = to_piece(p, &m.filled, &w->part, w->serial, w->path, w->kind, err);
  if (st < 0) {
    vg_filled_release(&m.filled);
    return st;
  }
  *change = (struct vg_change){ m.is_blocked, w->serial, w->part.n_point,
                                m.filled };
  return VG_OK;
}

/* Maximum number of points of a leaf before it is cut again; 0: no limit. */
static size_t limit_of(const struct vg_partition *p, const struct vg_node *n)
{
  double leaf = p->options.rule.leaf_cells;
  double most = VG_OUTGROWN * (n->load.cells > leaf ? n->load.cells : leaf);

  if (n->is_final || !(leaf > 0) || n->retry >= VG_RETRIES) return 0;
  return (size_t)(most / cells_per_point) + 1000;
}

/* Selects by the path before the leaf was extended (FNV-1a). */
static int fails_on_purpose(const struct vg_partition *p, const char *path)
{
  uint64_t h = 14695981039346656037u;
  int rounds = 0;

  for (; *path; path++) {
    rounds += *path == '~';
    if (*path != '~') h = (h ^ (unsigned char)*path) * 1099511628211u;
  }
  h ^= h >> 29;
  return rounds < p->options.fail_rounds &&
         (double)(h * VG_GOLDEN >> 11) * 0x1p-53 < p->options.fail_leaves;
}

vg_status vg_work_leaf(struct vg_partition *p, const struct vg_work *w,
                       int *outgrown, size_t *n_cell, const struct vg_engine *e,
                       struct vg_error *err)
{
  const struct vg_node *n = w->node;
  struct made m = MADE_INIT;
  size_t limit = limit_of(p, n);
  char path[VG_PATH_MAX];
  vg_status st;

  assert(w->what == VG_WORK_LEAF && w->node && outgrown && n_cell);
  *outgrown = 0;
  if (p->options.fail_leaves > 0 && fails_on_purpose(p, n->path))
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s: not filled, as requested for a test", n->path);
  st = find_or_make(p, &n->front, NULL, limit, &m, e, err);
  *outgrown = limit && st == VG_ERR_UNSUPPORTED;
  if (*outgrown) return VG_OK;
  *n_cell = m.filled.n_cell;
  snprintf(path, sizeof path, "%.*sL", VG_PATH_MAX - 2, n->path);
  if (st == VG_OK)
    st = to_piece(p, &m.filled, &n->front, w->serial, path, VG_SPAN_LEAF, err);
  vg_filled_release(&m.filled);
  return st;
}
