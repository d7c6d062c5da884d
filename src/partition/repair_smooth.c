/* Points on interfaces smoothed, and bad cells beside them found.
 *
 * A task cannot move the points of the front that it is given, nor those that
 * its own zone leaves to others: here they get the sweep that they lack. Each
 * piece sends its cells with corners among the points of another to that one's
 * rank, where the owner moves its points one by one. Of two points of
 * different owners with a cell in common, that of the earlier path may move:
 * so owners do not depend on each other, and the outcome not on ranks. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/shape.h"
#include "core/tets.h"
#include "partition/repair_parts.h"

/* What came of a piece. */
struct outcome {
  size_t n_seam;
  struct vg_seam *seam;      /* [n_seam] its cells around others' points */
  uint8_t *moved;            /* [n_point] or NULL: no seams */
  size_t n_spot, cap_spot;
  struct vg_spot *spot;
  size_t n_moved;
  struct vg_span span[2];    /* its seams found, its points smoothed */
  vg_status st;
};

struct smoothing {
  struct vg_partition *p;
  const struct vg_owners *owners;
  struct outcome *out;       /* [n_piece] */
  size_t n_far, cap_far;
  struct vg_seam *far;       /* [n_far] that came from other ranks */
  size_t n_seam;
  struct vg_seam **seam;     /* [n_seam] around points of this rank, by owner
                                and the path of those who have the cells */
  size_t *first;             /* [n_piece + 1] seam */
};

static void smoothing_free(struct smoothing *s)
{
  for (size_t k = 0; s->out && k < s->p->n_piece; k++) {
    struct outcome *o = &s->out[k];

    for (size_t i = 0; i < o->n_seam; i++) vg_seam_release(&o->seam[i]);
    free(o->seam);
    free(o->moved);
    free(o->spot);
  }
  for (size_t i = 0; i < s->n_far; i++) vg_seam_release(&s->far[i]);
  free(s->out);
  free(s->far);
  free(s->seam);
  free(s->first);
}

/* --- seams to the owners of the points ----------------------------------- */

static void seam_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  for (size_t k = first; k < end; k++) {
    struct outcome *o = &s->out[k];
    const struct vg_piece *q = &s->p->piece[k];

    vg_repair_begin(&o->span[0], worker);
    o->st = vg_seams_of(s->p, k, s->owners, &o->n_seam, &o->seam);
    vg_repair_end(&o->span[0], "C", q->serial, q->n_cell);
  }
}

static vg_status agreed(const struct smoothing *s, struct vg_error *err)
{
  for (size_t k = 0; k < s->p->n_piece; k++)
    if (s->out[k].st < 0) return vg_fail_memory(err, "repairs");
  return VG_OK;
}

static vg_status make_seams(struct smoothing *s, struct vg_post *post,
                            struct vg_error *err)
{
  vg_status st;

  s->out = vg_calloc(s->p->n_piece, sizeof *s->out);
  if (!s->out) return vg_fail_memory(err, "repairs");
  vg_parallel_for(s->p->options.threads, s->p->n_piece, 1, seam_body, s);
  st = agreed(s, err);
  if (st == VG_OK) st = vg_post_new(post, s->p->size, err);
  for (size_t k = 0; st == VG_OK && k < s->p->n_piece; k++)
    for (size_t i = 0; i < s->out[k].n_seam; i++) {
      const struct vg_seam *seam = &s->out[k].seam[i];

      if (seam->to != (uint32_t)s->p->rank)
        vg_seam_put(&post->to[seam->to], seam);
      else s->n_seam++;
    }
  return st;
}

static vg_status take_far(struct smoothing *s, const struct vg_bytes *from,
                          struct vg_error *err)
{
  for (int r = 0; r < s->p->size; r++) {
    struct vg_reader in = { .data = from[r].data, .n = from[r].n };

    while (in.at < in.n) {
      if (vg_reserve(&s->far, &s->cap_far, s->n_far + 1, sizeof *s->far))
        return vg_fail_memory(err, "repairs");
      vg_seam_get(&in, &s->far[s->n_far]);
      if (in.bad) return vg_fail_memory(err, "repairs");
      s->n_far++;
    }
  }
  return VG_OK;
}

static int by_owner(const void *a, const void *b)
{
  const struct vg_seam *s = *(struct vg_seam *const *)a;
  const struct vg_seam *t = *(struct vg_seam *const *)b;

  if (s->owner != t->owner) return s->owner < t->owner ? -1 : 1;
  return s->order < t->order ? -1 : s->order > t->order;
}

/* Own seams stay where they are. */
static vg_status sort_seams(struct smoothing *s, struct vg_error *err)
{
  size_t n = 0, n_piece = s->p->n_piece;

  s->n_seam += s->n_far;
  s->seam = vg_alloc(s->n_seam, sizeof *s->seam);
  s->first = vg_calloc(n_piece + 1, sizeof *s->first);
  if (!s->seam || !s->first) return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < n_piece; k++)
    for (size_t i = 0; i < s->out[k].n_seam; i++) {
      struct vg_seam *seam = &s->out[k].seam[i];

      if (seam->to == (uint32_t)s->p->rank) s->seam[n++] = seam;
    }
  for (size_t i = 0; i < s->n_far; i++) s->seam[n++] = &s->far[i];
  if (n) qsort(s->seam, n, sizeof *s->seam, by_owner);
  for (size_t i = 0; i < n; i++) s->first[s->seam[i]->owner + 1] = i + 1;
  for (size_t k = 0; k < n_piece; k++)
    if (s->first[k + 1] < s->first[k]) s->first[k + 1] = s->first[k];
  return VG_OK;
}

static vg_status send_seams(struct smoothing *s, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_post post = {0};
  struct vg_bytes *from = NULL;
  vg_status st = make_seams(s, &post, err);

  st = vg_post_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  st = take_far(s, from, err);
  if (st == VG_OK) st = sort_seams(s, err);
  vg_bytes_release(from, s->p->size);
  return vg_comm_agree(comm, st, err);
}

/* --- the points of one owner --------------------------------------------- */

/* All cells with a corner among the owner's points on interfaces. */
struct field {
  const struct vg_piece *q;
  const struct vg_owner *self;
  size_t n, n_seam;
  struct vg_seam *const *seam;
  uint8_t *shared;           /* [q.n_point] on an interface */
  uint8_t *stays;            /* [q.n_point] an earlier owner's point is near */
  uint8_t *told;             /* [t.n_cell] an earlier owner looks at it */
  struct vg_tets t;          /* vertices of q, then those of the seams */
  uint32_t *point;           /* [n] that may move */
  float *shape;              /* [t.n_cell] */
};

static void field_release(struct field *f)
{
  vg_tets_release(&f->t);
  free(f->shared);
  free(f->stays);
  free(f->told);
  free(f->point);
  free(f->shape);
}

static int is_shared(const struct field *f, uint32_t v)
{
  return v >= f->q->n_in && v - f->q->n_in < f->q->n_point &&
         f->shared[v - f->q->n_in];
}

static int has_shared(const struct field *f, const uint32_t *v)
{
  return is_shared(f, v[0]) || is_shared(f, v[1]) || is_shared(f, v[2]) ||
         is_shared(f, v[3]);
}

static vg_status field_new(struct field *f)
{
  const struct vg_piece *q = f->q;
  size_t n_point = q->n_in + q->n_point, n_cell = 0;

  f->shared = vg_calloc(q->n_point, 1);
  f->stays = vg_calloc(q->n_point, 1);
  if (!f->shared || !f->stays) return VG_ERR_MEMORY;
  for (size_t k = 0; k < f->n_seam; k++) {
    const struct vg_seam *s = f->seam[k];

    for (size_t i = 0; i < s->n_known; i++) f->shared[s->known[i]] = 1;
    n_cell += s->n_cell;
    n_point += s->n_other;
  }
  for (size_t c = 0; c < q->n_cell; c++)
    n_cell += (size_t)has_shared(f, q->cell[c]);
  f->t.x = vg_alloc(n_point, sizeof *f->t.x);
  f->t.cell = vg_alloc(n_cell, sizeof *f->t.cell);
  f->t.flag = vg_calloc(n_cell, 1);
  f->told = vg_calloc(n_cell, 1);
  f->shape = vg_alloc(n_cell, sizeof *f->shape);
  if (!f->t.x || !f->t.cell || !f->t.flag || !f->told || !f->shape)
    return VG_ERR_MEMORY;
  f->t.n_point = q->n_in + q->n_point;
  memcpy(f->t.x, q->x, f->t.n_point * sizeof *q->x);
  return VG_OK;
}

static void hold(struct field *f, const uint32_t *v)
{
  for (int i = 0; i < 4; i++)
    if (is_shared(f, v[i])) f->stays[v[i] - f->q->n_in] = 1;
}

/* Does a point of an earlier zone stand at vertex v < q.n_in? */
static int is_before(const struct field *f, const struct vg_owners *owners,
                     uint32_t v, const struct vg_owner **last)
{
  uint64_t name = f->q->in[v];

  if (!(name >> 32)) return 0;
  if (!*last || (*last)->serial != name >> 32)
    *last = vg_owners_find(owners, name);
  return *last && (*last)->is_zone && (*last)->order < f->self->order;
}

static void add_own(struct field *f, const struct vg_owners *owners)
{
  const struct vg_owner *last = NULL;

  for (size_t c = 0; c < f->q->n_cell; c++) {
    const uint32_t *v = f->q->cell[c];
    int earlier = 0;

    if (!has_shared(f, v)) continue;
    for (int i = 0; i < 4; i++)
      if (v[i] < f->q->n_in) earlier |= is_before(f, owners, v[i], &last);
    if (earlier) hold(f, v);
    f->told[f->t.n_cell] = (uint8_t)earlier;
    memcpy(f->t.cell[f->t.n_cell++].v, v, sizeof f->t.cell->v);
  }
}

static void add_seam(struct field *f, const struct vg_seam *s)
{
  uint32_t at = (uint32_t)f->t.n_point, n_in = (uint32_t)f->q->n_in;

  if (s->n_other) memcpy(f->t.x + at, s->x, s->n_other * sizeof *s->x);
  f->t.n_point += s->n_other;
  for (size_t c = 0; c < s->n_cell; c++) {
    uint32_t *v = f->t.cell[f->t.n_cell].v;
    int earlier = VG_BEFORE_NOT;

    for (int i = 0; i < 4; i++) {
      uint32_t k = s->cell[c][i], o = k - s->n_known;

      if (k < s->n_known) {
        v[i] = n_in + s->known[k];
        continue;
      }
      v[i] = at + o;
      if (s->before[o] > earlier) earlier = s->before[o];
    }
    if (earlier) hold(f, v);
    f->told[f->t.n_cell++] = earlier == VG_BEFORE_OTHER;
  }
}

static vg_status smooth(struct field *f, struct outcome *out)
{
  struct vg_optimise_report r;
  size_t n_in = f->q->n_in;

  f->point = vg_alloc(f->q->n_point, sizeof *f->point);
  if (!f->point) return VG_ERR_MEMORY;
  for (size_t i = 0; f->self->is_zone && i < f->q->n_point; i++)
    if (f->shared[i] && !f->stays[i]) f->point[f->n++] = (uint32_t)(n_in + i);
  if (vg_optimise_points(&f->t, f->n, f->point, f->shape, &r, NULL) < 0)
    return VG_ERR_MEMORY;
  for (size_t i = 0; i < f->n; i++) {
    uint32_t v = f->point[i];
    double *x = f->q->x[v];

    if (!memcmp(x, f->t.x[v], sizeof *f->t.x)) continue;
    memcpy(x, f->t.x[v], sizeof *f->t.x);
    out->moved[v - n_in] = 1;
    out->n_moved++;
  }
  return VG_OK;
}

static vg_status list_bad(const struct field *f, const struct vg_sizing *sizing,
                          struct outcome *out)
{
  for (size_t c = 0; c < f->t.n_cell; c++) {
    const uint32_t *v = f->t.cell[c].v;
    const double *x[4];

    if (f->told[c] || f->shape[c] >= VG_SHAPE_AIM) continue;
    for (int i = 0; i < 4; i++) x[i] = f->t.x[v[i]];
    if (vg_reserve(&out->spot, &out->cap_spot, out->n_spot + 1,
                   sizeof *out->spot))
      return VG_ERR_MEMORY;
    out->spot[out->n_spot++] =
        vg_spot_around(sizing, x, f->shape[c] < VG_SHAPE_BAD
                                      ? VG_BALL_MIDDLE : VG_BALL_SMALL);
  }
  return VG_OK;
}

static vg_status smooth_piece(const struct smoothing *s, size_t k,
                              struct outcome *out)
{
  const struct vg_piece *q = &s->p->piece[k];
  struct field f = { .q = q, .seam = s->seam + s->first[k],
                     .n_seam = s->first[k + 1] - s->first[k],
                     .self = vg_owners_find(s->owners,
                                            VG_POINT_NAME(q->serial, 0)) };
  vg_status st;

  out->moved = vg_calloc(q->n_point, 1);
  st = out->moved ? field_new(&f) : VG_ERR_MEMORY;
  if (st == VG_OK) {
    add_own(&f, s->owners);
    for (size_t i = 0; i < f.n_seam; i++) add_seam(&f, f.seam[i]);
    st = smooth(&f, out);
  }
  if (st == VG_OK) st = list_bad(&f, s->p->sizing, out);
  field_release(&f);
  return st;
}

static void smooth_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  for (size_t k = first; k < end; k++) {
    struct outcome *o = &s->out[k];

    if (s->first[k + 1] == s->first[k]) continue;
    vg_repair_begin(&o->span[1], worker);
    o->st = smooth_piece(s, k, o);
    vg_repair_end(&o->span[1], "S", s->p->piece[k].serial, o->n_moved);
  }
}

/* --- back to those who use the points ------------------------------------ */

/* A point of a piece that is another's, and where it is now. */
struct news { uint32_t piece, vertex; double x[3]; };

static void put_news(const struct smoothing *s, const struct vg_seam *seam,
                     struct vg_writer *w)
{
  const struct vg_piece *q = &s->p->piece[seam->owner];

  for (size_t i = 0; i < seam->n_known; i++) {
    struct news n = { .piece = seam->from, .vertex = seam->vertex[i] };

    if (!s->out[seam->owner].moved[seam->known[i]]) continue;
    memcpy(n.x, q->x[q->n_in + seam->known[i]], sizeof n.x);
    vg_put(w, 1, sizeof n, &n);
  }
}

/* On this rank: nobody else writes to those vertices. */
static void tell_body(void *context, size_t first, size_t end, int worker)
{
  struct smoothing *s = context;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    const struct vg_seam *seam = s->seam[k];
    const struct vg_piece *q = &s->p->piece[seam->owner];
    const struct vg_piece *to = &s->p->piece[seam->from];

    if (seam->rank != (uint32_t)s->p->rank) continue;
    for (size_t i = 0; i < seam->n_known; i++)
      if (s->out[seam->owner].moved[seam->known[i]])
        memcpy(to->x[seam->vertex[i]], q->x[q->n_in + seam->known[i]],
               sizeof *to->x);
  }
}

static vg_status tell(struct smoothing *s, struct vg_comm *comm,
                      vg_status st, struct vg_error *err)
{
  struct vg_post post = {0};
  struct vg_bytes *from = NULL;

  if (st == VG_OK) st = vg_post_new(&post, s->p->size, err);
  for (size_t i = 0; st == VG_OK && i < s->n_far; i++)
    put_news(s, &s->far[i], &post.to[s->far[i].rank]);
  st = vg_post_send(&post, comm, st, &from, err);
  if (st < 0) return st;
  vg_parallel_for(s->p->options.threads, s->n_seam, 16, tell_body, s);
  for (int r = 0; r < s->p->size; r++) {
    struct vg_reader in = { .data = from[r].data, .n = from[r].n };
    struct news n;

    while (in.at < in.n) {
      vg_get(&in, 1, sizeof n, &n);
      if (in.bad) break;
      memcpy(s->p->piece[n.piece].x[n.vertex], n.x, sizeof n.x);
    }
  }
  vg_bytes_release(from, s->p->size);
  return VG_OK;
}

vg_status vg_repair_smooth(struct vg_partition *p, struct vg_comm *comm,
                           const struct vg_owners *owners,
                           struct vg_spans *spans, size_t *n,
                           struct vg_spot **out, struct vg_error *err)
{
  struct smoothing s = { .p = p, .owners = owners };
  struct vg_writer w = { .cap = 0 };
  vg_status st = send_seams(&s, comm, err);

  *n = 0;
  if (st == VG_OK) {
    vg_parallel_for(p->options.threads, p->n_piece, 1, smooth_body, &s);
    st = tell(&s, comm, agreed(&s, err), err);
  }
  for (size_t k = 0; st == VG_OK && k < p->n_piece; k++) {
    vg_put(&w, s.out[k].n_spot, sizeof **out, s.out[k].spot);
    p->report.n_repair_moved += s.out[k].n_moved;
    for (int i = 0; i < 2 && !w.refused; i++)
      if (s.out[k].span[i].kind &&
          vg_spans_add(spans, &s.out[k].span[i], err) < 0)
        w.refused = 1;
  }
  if (st == VG_OK) st = vg_spots_gather(&w, p->size, comm, n, out, err);
  free(w.bytes.data);
  smoothing_free(&s);
  return st;
}
