/* What tasks that make cells do: look in the store, else grow, and keep. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "partition/cut/node.h"

/* Points to a cell in a field; a bound for the first, not an estimate. */
static const double cells_per_point = 5.5;   /* C12 */

/* What a task made, as the store keeps it: nothing in it depends on names or
 * serials. */
struct made {
  struct vg_change change;   /* ZONE */
  struct vg_fill_report report;  /* without times where it was kept */
  size_t n_in, n_point, n_cell;
  uint32_t *in;              /* [n_in] points of the front that cells use */
  double (*x)[3];            /* [n_point] new ones */
  uint32_t (*cell)[4];       /* [n_cell] indices into in, then x */
};

static void made_release(struct made *m)
{
  vg_change_release(&m->change);
  free(m->in);
  free(m->x);
  free(m->cell);
  memset(m, 0, sizeof *m);
}

/* So that a resumed run reports what was done of the whole mesh. */
enum { N_REPORT = 20 };

static void report_put(struct vg_writer *w, const struct vg_fill_report *r)
{
  const uint64_t v[N_REPORT] = {
    r->n_surface_face_lost, r->n_pocket, r->n_pocket_cell, r->n_retry,
    (uint64_t)r->whole_void, r->n_steiner, r->n_placed, r->n_inserted,
    r->n_refused, r->n_smoothed, r->n_flip, r->n_collapse, r->n_split,
    r->n_list_cut, r->n_left, r->n_other, r->n_other_cell,
    r->n_other_failed, r->n_other_ended, r->n_other_wrong };

  vg_put(w, N_REPORT, sizeof *v, v);
}

static void report_get(struct vg_reader *in, struct vg_fill_report *r)
{
  uint64_t v[N_REPORT] = {0};

  vg_get(in, N_REPORT, sizeof *v, v);
  *r = (struct vg_fill_report){
    .n_surface_face_lost = v[0], .n_pocket = v[1], .n_pocket_cell = v[2],
    .n_retry = v[3], .whole_void = (int)v[4], .n_steiner = v[5],
    .n_placed = v[6], .n_inserted = v[7], .n_refused = v[8],
    .n_smoothed = v[9], .n_flip = v[10], .n_collapse = v[11],
    .n_split = v[12], .n_list_cut = v[13], .n_left = v[14], .n_other = v[15],
    .n_other_cell = v[16], .n_other_failed = v[17], .n_other_ended = v[18],
    .n_other_wrong = v[19] };
}

static void made_put(struct vg_writer *w, const struct made *m)
{
  uint64_t count[3] = {m->n_in, m->n_point, m->n_cell};

  vg_change_put(w, &m->change);
  vg_put(w, 3, sizeof *count, count);
  vg_put(w, m->n_in, sizeof *m->in, m->in);
  vg_put(w, m->n_point, sizeof *m->x, m->x);
  vg_put(w, m->n_cell, sizeof *m->cell, m->cell);
  report_put(w, &m->report);
}

static void made_get(struct vg_reader *r, struct made *m)
{
  uint64_t count[3] = {0};

  vg_change_get(r, &m->change);
  vg_get(r, 3, sizeof *count, count);
  m->n_in = count[0];
  m->n_point = count[1];
  m->n_cell = count[2];
  m->in = vg_get_array(r, m->n_in, sizeof *m->in);
  m->x = vg_get_array(r, m->n_point, sizeof *m->x);
  m->cell = vg_get_array(r, m->n_cell, sizeof *m->cell);
  report_get(r, &m->report);
  if (r->bad) made_release(m);
}

/* --- the store ----------------------------------------------------------- */

/* Everything that decides what the task makes. */
static struct vg_digest key_of(const struct vg_partition *p,
                               const struct vg_front *f,
                               const struct vg_region *region, size_t limit)
{
  struct vg_digest d = p->options.job;
  uint64_t number[2] = {f->n_point, limit};

  d = vg_digest_of(d, sizeof number, number);
  d = vg_digest_of(d, f->n_point * sizeof *f->x, f->x);
  d = vg_digest_of(d, f->n_face * sizeof *f->face, f->face);
  return region ? vg_digest_of(d, sizeof *region, region) : d;
}

static int find(struct vg_partition *p, struct vg_digest key, struct made *m,
                struct vg_error *err)
{
  struct vg_bytes b = {0, NULL};
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
  if (!w.refused) vg_store_keep(p->options.store, key, w.bytes.n,
                                w.bytes.data);
  free(w.bytes.data);
}

/* --- from what was made to a piece --------------------------------------- */

/* Cells in the numbers of a front of n points, then new ones, become cells of
 * the points that they use. */
static vg_status compact(struct made *m, size_t n, struct vg_error *err)
{
  uint32_t *to = vg_alloc(n, sizeof *to);

  m->in = vg_alloc(n, sizeof *m->in);
  if (!to || !m->in) {
    free(to);
    return vg_fail_memory(err, "the cells of a task");
  }
  memset(to, 0xff, n * sizeof *to);
  for (size_t c = 0; c < m->n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (m->cell[c][i] < n) to[m->cell[c][i]] = 0;
  for (size_t q = 0; q < n; q++)
    if (to[q] != UINT32_MAX) {
      to[q] = (uint32_t)m->n_in;
      m->in[m->n_in++] = (uint32_t)q;
    }
  for (size_t c = 0; c < m->n_cell; c++)
    for (int i = 0; i < 4; i++)
      m->cell[c][i] = m->cell[c][i] < n
                        ? to[m->cell[c][i]]
                        : (uint32_t)(m->cell[c][i] - n + m->n_in);
  free(to);
  return VG_OK;
}

static int add_piece(struct vg_partition *p, const struct vg_piece *piece)
{
  int bad;

  pthread_mutex_lock(&p->lock);
  bad = vg_reserve(&p->piece, &p->cap_piece, p->n_piece + 1,
                   sizeof *p->piece);
  if (!bad) p->piece[p->n_piece++] = *piece;
  pthread_mutex_unlock(&p->lock);
  return bad;
}

/* Takes the cells over. */
static vg_status to_piece(struct vg_partition *p, struct made *m,
                          const struct vg_front *f, uint32_t serial,
                          const char *path, char kind, struct vg_error *err)
{
  struct vg_piece piece = { .kind = kind, .serial = serial, .n_in = m->n_in,
                            .n_point = m->n_point, .n_cell = m->n_cell };

  if (!m->n_cell) return VG_OK;
  /* points that a leaf adopts are the last of its front (recut_names.c) */
  while (piece.n_in && f->name[m->in[piece.n_in - 1]] >> 32 == serial)
    piece.n_in--;
  piece.n_adopted = m->n_in - piece.n_in;
  piece.n_point += piece.n_adopted;
  snprintf(piece.path, sizeof piece.path, "%s", path);
  piece.in = vg_alloc(m->n_in, sizeof *piece.in);
  piece.x = vg_alloc(m->n_in + m->n_point, sizeof *piece.x);
  if (!piece.in || !piece.x) goto refused;
  for (size_t k = 0; k < m->n_in; k++) {
    piece.in[k] = f->name[m->in[k]];
    memcpy(piece.x[k], f->x[m->in[k]], sizeof *piece.x);
  }
  if (m->n_point)
    memcpy(piece.x + m->n_in, m->x, m->n_point * sizeof *piece.x);
  piece.cell = m->cell;
  if (add_piece(p, &piece)) goto refused;
  m->cell = NULL;
  return VG_OK;
refused:
  free(piece.in);
  free(piece.x);
  return vg_fail_memory(err, "the cells of a task");
}

/* --- growing ------------------------------------------------------------- */

static int stop(void *user, const char *stage, size_t done, size_t expected)
{
  (void)stage;
  (void)done;
  (void)expected;
  return vg_engine_stopping(user);
}

static void add_report(struct vg_partition *p, const struct vg_fill_report *r)
{
  struct vg_fill_report *to = &p->report.fill;

  pthread_mutex_lock(&p->lock);
  to->n_surface_face_lost += r->n_surface_face_lost;
  to->n_pocket += r->n_pocket;
  to->n_pocket_cell += r->n_pocket_cell;
  to->n_retry += r->n_retry;
  to->whole_void += r->whole_void;
  to->n_steiner += r->n_steiner;
  to->n_placed += r->n_placed;
  to->n_inserted += r->n_inserted;
  to->n_refused += r->n_refused;
  to->n_smoothed += r->n_smoothed;
  to->n_flip += r->n_flip;
  to->n_collapse += r->n_collapse;
  to->n_split += r->n_split;
  to->n_list_cut += r->n_list_cut;
  to->n_left += r->n_left;
  to->n_other += r->n_other;
  to->n_other_cell += r->n_other_cell;
  to->n_other_failed += r->n_other_failed;
  to->n_other_ended += r->n_other_ended;
  to->n_other_wrong += r->n_other_wrong;
  to->time_other += r->time_other;
  to->time_boundary += r->time_boundary;
  to->time_place += r->time_place;
  to->time_insert += r->time_insert;
  to->time_optimise += r->time_optimise;
  to->time_total += r->time_total;
  pthread_mutex_unlock(&p->lock);
}

/* What its home hears of a zone. The points stay with the piece too. */
static vg_status to_change(struct vg_zone *z, const struct vg_front *f,
                           struct made *m, struct vg_error *err)
{
  struct vg_change *c = &m->change;

  c->n_part = f->n_point;
  c->n_point = z->n_point;
  c->n_face = z->n_face;
  c->n_cell = z->n_cell;
  c->n_hole = z->n_hole;
  c->volume = z->volume;
  c->x = vg_alloc(z->n_point, sizeof *c->x);
  c->gone = vg_alloc(f->n_face, sizeof *c->gone);
  if (!c->x || !c->gone) return vg_fail_memory(err, "the front of a zone");
  if (z->n_point) memcpy(c->x, z->x, z->n_point * sizeof *c->x);
  for (size_t i = 0; i < f->n_face; i++)
    if (z->gone[i]) c->gone[c->n_gone++] = (uint32_t)i;
  c->face = z->face;
  z->face = NULL;
  m->n_point = z->n_point;
  m->n_cell = z->n_cell;
  m->x = z->x;
  m->cell = z->cell;
  z->x = NULL;
  z->cell = NULL;
  return compact(m, f->n_point, err);
}

static vg_status grow_zone(struct vg_partition *p, const struct vg_front *f,
                           const struct vg_region *region, struct made *m,
                           const struct vg_engine *e, struct vg_error *err)
{
  struct vg_grow_options o = VG_GROW_OPTIONS_INIT;
  struct vg_zone z = VG_ZONE_INIT;
  vg_status st;

  o.sweeps = p->options.sweeps;
  o.progress = stop;
  o.user = (void *)(uintptr_t)e;
  st = vg_zone_grow(f->n_point, (const double (*)[3])f->x, f->n_face,
                    (const uint32_t (*)[3])f->face, region, p->sizing,
                    &o, &z, &m->report, err);
  if (st == VG_BLOCKED && !vg_engine_stopping(e)) {
    m->change.n_part = f->n_point;
    m->change.blocked = 1;
    st = VG_OK;
  } else if (st == VG_OK) {
    st = to_change(&z, f, m, err);
  }
  vg_zone_release(&z);
  return st;
}

static vg_status find_or_grow(struct vg_partition *p,
                              const struct vg_front *f,
                              const struct vg_region *region, struct made *m,
                              const struct vg_engine *e, struct vg_error *err)
{
  struct vg_digest key = {{0, 0}};
  vg_status st = VG_OK;

  if (p->options.store) key = key_of(p, f, region, 0);
  if (!find(p, key, m, err)) {
    st = grow_zone(p, f, region, m, e, err);
    if (st == VG_OK) keep(p, key, m);
  }
  add_report(p, &m->report);
  return st;
}

/* In the numbers of the part that the work was given: it was made of the
 * points and faces listed. */
static void renumber(struct vg_change *c, size_t n_given,
                     const uint32_t *point, const uint32_t *face)
{
  for (size_t i = 0; i < c->n_face; i++)
    for (int k = 0; k < 3; k++) {
      size_t v = c->face[i][k];

      c->face[i][k] = v < c->n_part ? point[v]
                                    : (uint32_t)(v - c->n_part + n_given);
    }
  for (size_t i = 0; i < c->n_gone; i++) c->gone[i] = face[c->gone[i]];
  c->n_part = n_given;
}

vg_status vg_work_zone(struct vg_partition *p, const struct vg_work *w,
                       struct vg_change *change, const struct vg_engine *e,
                       struct vg_error *err)
{
  struct vg_front f = VG_FRONT_INIT;
  struct made m = { .n_in = 0 };
  uint32_t *point = NULL, *face = NULL;
  vg_status st;

  VG_TRY(vg_select_near(&w->part, &w->region, p->sizing, &f, &point, &face,
                        err));
  if (f.n_face)
    VG_TRY(find_or_grow(p, &f, &w->region, &m, e, err));
  VG_TRY(to_piece(p, &m, &f, w->serial, w->path, w->kind, err));
  *change = m.change;
  change->serial = w->serial;
  memset(&m.change, 0, sizeof m.change);
  renumber(change, w->part.n_point, point, face);
done:
  vg_front_release(&f);
  free(point);
  free(face);
  made_release(&m);
  return st;
}

/* Points beyond which a leaf is cut again; 0: none. */
static size_t limit_of(const struct vg_partition *p, const struct vg_node *n)
{
  double leaf = p->options.rule.leaf_cells;
  double most = VG_OUTGROWN * (n->load.cells > leaf ? n->load.cells : leaf);

  if (n->is_final || !(leaf > 0) || n->retry >= VG_RETRIES) return 0;
  return (size_t)(most / cells_per_point) + 1000;
}

static vg_status grow_leaf(struct vg_partition *p, const struct vg_node *n,
                           size_t limit, struct made *m, int *outgrown,
                           const struct vg_engine *e, struct vg_error *err)
{
  const struct vg_front *f = &n->front;
  struct vg_grow_options o = VG_GROW_OPTIONS_INIT;
  struct vg_void v = VG_VOID_INIT;
  vg_status st;

  o.sweeps = p->options.sweeps;
  o.point_limit = limit;
  o.progress = stop;
  o.user = (void *)(uintptr_t)e;
  if (vg_reserve(&v.x, &v.cap_point, f->n_point, sizeof *v.x) ||
      vg_reserve(&v.face, &v.cap_face, f->n_face, sizeof *v.face)) {
    vg_void_release(&v);
    return vg_fail_memory(err, "the front of a leaf");
  }
  memcpy(v.x, f->x, f->n_point * sizeof *v.x);
  memcpy(v.face, f->face, f->n_face * sizeof *v.face);
  v.n_point = f->n_point;
  v.n_face = f->n_face;
  st = p->options.mesher
         ? vg_mesher_fill(p->options.mesher, &v, p->sizing, &o, &m->report, err)
         : VG_NOT_BETTER;
  if (st == VG_NOT_BETTER) st = vg_grow(&v, p->sizing, &o, &m->report, err);
  *outgrown = limit && st == VG_ERR_UNSUPPORTED;
  if (st == VG_OK) {
    m->n_point = v.n_point - f->n_point;
    m->n_cell = v.n_cell;
    m->cell = v.cell;
    v.cell = NULL;
    m->x = vg_alloc(m->n_point, sizeof *m->x);
    if (!m->x) st = vg_fail_memory(err, "the points of a leaf");
    else if (m->n_point)
      memcpy(m->x, v.x + f->n_point, m->n_point * sizeof *m->x);
  }
  vg_void_release(&v);
  return st == VG_OK ? compact(m, f->n_point, err) : st;
}

/* By the path as it was before the leaf was made larger (FNV-1a). */
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
         (double)(h * 0x9e3779b97f4a7c15u >> 11) * 0x1p-53 <
           p->options.fail_leaves;
}

vg_status vg_work_leaf(struct vg_partition *p, const struct vg_work *w,
                       int *outgrown, size_t *n_cell,
                       const struct vg_engine *e, struct vg_error *err)
{
  const struct vg_node *n = w->node;
  struct vg_digest key = {{0, 0}};
  struct made m = { .n_in = 0 };
  size_t limit = limit_of(p, n);
  char path[VG_PATH_MAX];
  vg_status st = VG_OK;

  *outgrown = 0;
  if (p->options.fail_leaves > 0 && fails_on_purpose(p, n->path))
    return vg_fail(err, VG_ERR_GEOMETRY, "%s is not filled on purpose",
                   n->path);
  if (p->options.store) key = key_of(p, &n->front, NULL, limit);
  if (!find(p, key, &m, err)) {
    st = grow_leaf(p, n, limit, &m, outgrown, e, err);
    if (st == VG_OK) keep(p, key, &m);
  }
  add_report(p, &m.report);
  if (*outgrown) return VG_OK;
  *n_cell = m.n_cell;
  snprintf(path, sizeof path, "%.*sL", VG_PATH_MAX - 2, n->path);
  if (st == VG_OK)
    st = to_piece(p, &m, &n->front, w->serial, path, VG_SPAN_LEAF, err);
  made_release(&m);
  return st;
}
