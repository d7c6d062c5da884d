/* Which cells beside interfaces are bad, and who has which piece. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/shape.h"
#include "partition/repair_parts.h"

/* The worse a cell, the larger its ball: `reach` local spacings, and `most`
 * times as far as its own corners. Beside long triangles of a sharp edge, what
 * stayed bad needs much room. */
static const struct { double reach, most; } ball[VG_BALL_SIZES] = {
  { 1.2, 1.01 }, { 2.5, 1.01 }, { 4, 2 } };
/* As vg_shape: dihedral angles below 18 or above 162 degrees. */
static const double bad = 0.0955;

/* --- owners -------------------------------------------------------------- */

static int by_serial(const void *a, const void *b)
{
  const struct vg_owner *s = a, *t = b;

  return s->serial < t->serial ? -1 : s->serial > t->serial;
}

static vg_status list_owners(struct vg_bytes *all, int size,
                             struct vg_owners *out, struct vg_error *err)
{
  size_t n = 0;

  for (int r = 0; r < size; r++) n += all[r].n / sizeof *out->at;
  out->at = vg_alloc(n, sizeof *out->at);
  if (!out->at) return vg_fail_memory(err, "repairs");
  for (int r = 0; r < size; r++) {
    if (all[r].n) memcpy(out->at + out->n, all[r].data, all[r].n);
    out->n += all[r].n / sizeof *out->at;
  }
  if (n) qsort(out->at, n, sizeof *out->at, by_serial);
  return VG_OK;
}

vg_status vg_owners_gather(const struct vg_partition *p, struct vg_comm *comm,
                           struct vg_owners *out, struct vg_error *err)
{
  struct vg_owner *own = vg_alloc(p->n_piece, sizeof *own);
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  struct vg_bytes mine = {p->n_piece * sizeof *own, (unsigned char *)own};
  vg_status st = own && all ? VG_OK : vg_fail_memory(err, "repairs");

  memset(out, 0, sizeof *out);
  for (size_t k = 0; st == VG_OK && k < p->n_piece; k++)
    own[k] = (struct vg_owner){ p->piece[k].serial, (uint32_t)p->rank,
                                (uint32_t)k };
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &mine, all, err);
  if (st == VG_OK) st = list_owners(all, p->size, out, err);
  if (all) vg_bytes_release(all, p->size);
  free(own);
  return vg_comm_agree(comm, st, err);
}

const struct vg_owner *vg_owners_find(const struct vg_owners *o, uint64_t name)
{
  struct vg_owner key = { .serial = (uint32_t)(name >> 32) };

  if (!key.serial) return NULL;
  return bsearch(&key, o->at, o->n, sizeof key, by_serial);
}

/* --- letters ------------------------------------------------------------- */

vg_status vg_post_new(struct vg_post *post, int size, struct vg_error *err)
{
  post->size = size;
  post->to = vg_calloc((size_t)size, sizeof *post->to);
  return post->to ? VG_OK : vg_fail_memory(err, "repairs");
}

void vg_post_release(struct vg_post *post)
{
  for (int r = 0; post->to && r < post->size; r++)
    free(post->to[r].bytes.data);
  free(post->to);
  post->to = NULL;
}

void vg_bytes_release(struct vg_bytes *b, int size)
{
  for (int r = 0; b && r < size; r++) free(b[r].data);
  free(b);
}

vg_status vg_post_send(struct vg_post *post, struct vg_comm *comm,
                       vg_status st, struct vg_bytes **from,
                       struct vg_error *err)
{
  struct vg_bytes *to = vg_calloc((size_t)post->size, sizeof *to);
  struct vg_bytes *got = vg_calloc((size_t)post->size, sizeof *got);

  if (st == VG_OK && (!to || !got)) st = vg_fail_memory(err, "repairs");
  for (int r = 0; st == VG_OK && r < post->size; r++) {
    if (post->to[r].refused) st = vg_fail_memory(err, "repairs");
    to[r] = post->to[r].bytes;
  }
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_exchange(comm, to, got, err);
  free(to);
  vg_post_release(post);
  if (st == VG_OK) *from = got;
  else vg_bytes_release(got, post->size);
  return st;
}

/* --- points on interfaces ------------------------------------------------ */

struct search {
  const struct vg_partition *p;
  uint8_t **shared;          /* [n_piece][n_in + n_point] */
  struct found { size_t n, cap; struct vg_spot *spot; int refused; } *found;
};

static void search_free(struct search *s)
{
  for (size_t k = 0; k < s->p->n_piece; k++) {
    if (s->shared) free(s->shared[k]);
    if (s->found) free(s->found[k].spot);
  }
  free(s->shared);
  free(s->found);
}

static vg_status search_new(struct search *s, struct vg_error *err)
{
  size_t n = s->p->n_piece;

  s->shared = vg_calloc(n, sizeof *s->shared);
  s->found = vg_calloc(n, sizeof *s->found);
  if (!s->shared || !s->found) return vg_fail_memory(err, "repairs");
  for (size_t k = 0; k < n; k++) {
    const struct vg_piece *q = &s->p->piece[k];

    s->shared[k] = vg_calloc(q->n_in + q->n_point, 1);
    if (!s->shared[k]) return vg_fail_memory(err, "repairs");
  }
  return VG_OK;
}

/* Points of others are on an interface, and their owners hear of it. */
static void mark_foreign(struct search *s, const struct vg_owners *owners,
                         struct vg_post *post)
{
  const struct vg_owner *o = NULL;

  for (size_t k = 0; k < s->p->n_piece; k++) {
    const struct vg_piece *q = &s->p->piece[k];

    for (size_t i = 0; i < q->n_in; i++) {
      if (!(q->in[i] >> 32)) continue;
      s->shared[k][i] = 1;
      if (!o || o->serial != q->in[i] >> 32)
        o = vg_owners_find(owners, q->in[i]);
      if (o) vg_put(&post->to[o->rank], 1, sizeof q->in[i], &q->in[i]);
    }
  }
}

static void mark_own(struct search *s, const struct vg_owners *owners,
                     const struct vg_bytes *names)
{
  const struct vg_owner *o = NULL;
  uint64_t name;

  for (size_t at = 0; at + sizeof name <= names->n; at += sizeof name) {
    memcpy(&name, names->data + at, sizeof name);
    if (!o || o->serial != name >> 32) o = vg_owners_find(owners, name);
    if (o)
      s->shared[o->piece][s->p->piece[o->piece].n_in + (uint32_t)name] = 1;
  }
}

static vg_status mark(struct search *s, struct vg_comm *comm,
                      const struct vg_owners *owners, struct vg_error *err)
{
  struct vg_post post = {0};
  struct vg_bytes *from = NULL;
  vg_status st = search_new(s, err);

  if (st == VG_OK) st = vg_post_new(&post, s->p->size, err);
  if (st == VG_OK) mark_foreign(s, owners, &post);
  st = vg_post_send(&post, comm, st, &from, err);
  for (int r = 0; st == VG_OK && r < s->p->size; r++)
    mark_own(s, owners, &from[r]);
  vg_bytes_release(from, s->p->size);
  return st;
}

/* --- bad cells ----------------------------------------------------------- */

static double distance2(const double a[3], const double b[3])
{
  double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];

  return x * x + y * y + z * z;
}

struct vg_spot vg_spot_around(const struct vg_sizing *sizing,
                              const double *const x[4], enum vg_ball_size k)
{
  struct vg_spot s;
  double far = 0, reach;

  for (int a = 0; a < 3; a++)
    s.at[a] = 0.25 * (x[0][a] + x[1][a] + x[2][a] + x[3][a]);
  for (int i = 0; i < 4; i++) {
    double d = distance2(s.at, x[i]);

    if (d > far) far = d;
  }
  reach = ball[k].reach * vg_sizing_at(sizing, s.at);
  s.radius = ball[k].most * sqrt(far);
  if (s.radius < reach) s.radius = reach;
  return s;
}

static void find_in(const struct search *s, size_t k)
{
  const struct vg_piece *q = &s->p->piece[k];
  const uint8_t *shared = s->shared[k];
  struct found *f = &s->found[k];

  for (size_t c = 0; c < q->n_cell; c++) {
    const uint32_t *v = q->cell[c];
    const double *x[4];
    double shape;

    if (!(shared[v[0]] | shared[v[1]] | shared[v[2]] | shared[v[3]])) continue;
    for (int i = 0; i < 4; i++) x[i] = q->x[v[i]];
    shape = vg_shape(x[0], x[1], x[2], x[3]);
    if (shape >= VG_SHAPE_AIM) continue;
    if (vg_reserve(&f->spot, &f->cap, f->n + 1, sizeof *f->spot)) {
      f->refused = 1;
      return;
    }
    f->spot[f->n++] = vg_spot_around(s->p->sizing, x, shape < bad
                                                        ? VG_BALL_MIDDLE
                                                        : VG_BALL_SMALL);
  }
}

static void find_body(void *context, size_t first, size_t end, int worker)
{
  (void)worker;
  for (size_t k = first; k < end; k++) find_in(context, k);
}

/* --- of all ranks -------------------------------------------------------- */

static int by_place(const void *a, const void *b)
{
  const struct vg_spot *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->at[k] != t->at[k]) return s->at[k] < t->at[k] ? -1 : 1;
  return s->radius < t->radius ? -1 : s->radius > t->radius;
}

vg_status vg_spots_gather(struct vg_writer *w, int n_rank, struct vg_comm *comm,
                          size_t *n, struct vg_spot **out,
                          struct vg_error *err)
{
  struct vg_bytes *all = vg_calloc((size_t)n_rank, sizeof *all);
  size_t bytes = 0, at = 0;
  vg_status st;

  *out = NULL;
  st = vg_comm_agree(comm, w->refused || !all ? vg_fail_memory(err, "repairs")
                                              : VG_OK, err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &w->bytes, all, err);
  for (int r = 0; st == VG_OK && r < n_rank; r++) bytes += all[r].n;
  if (st == VG_OK && !(*out = vg_alloc(bytes, 1)))
    st = vg_fail_memory(err, "repairs");
  for (int r = 0; st == VG_OK && r < n_rank; r++) {
    if (all[r].n) memcpy((char *)*out + at, all[r].data, all[r].n);
    at += all[r].n;
  }
  vg_bytes_release(all, n_rank);
  *n = at / sizeof **out;
  if (*n) qsort(*out, *n, sizeof **out, by_place);
  if (st == VG_OK) st = vg_spots_thin(n, *out, err);
  return vg_comm_agree(comm, st, err);
}

vg_status vg_repair_find(struct vg_partition *p, struct vg_comm *comm,
                         const struct vg_owners *owners, size_t *n,
                         struct vg_spot **out, struct vg_error *err)
{
  struct search s = { .p = p };
  struct vg_writer w = { .cap = 0 };
  vg_status st = mark(&s, comm, owners, err);

  *n = 0;
  if (st == VG_OK) {
    vg_parallel_for(p->options.threads, p->n_piece, 1, find_body, &s);
    for (size_t k = 0; k < p->n_piece; k++) {
      w.refused |= s.found[k].refused;
      vg_put(&w, s.found[k].n, sizeof **out, s.found[k].spot);
    }
    st = vg_spots_gather(&w, p->size, comm, n, out, err);
    free(w.bytes.data);
  }
  search_free(&s);
  return st;
}
