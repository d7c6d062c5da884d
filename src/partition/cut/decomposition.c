/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/decomposition.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"

void vg_decomposition_release(struct vg_decomposition *p)
{
  for (size_t k = 0; k < p->n_part; k++) vg_front_release(&p->part[k].front);
  free(p->part);
  free(p->x);
  memset(p, 0, sizeof *p);
}

void vg_coarse_cells_release(struct vg_coarse_cells *c)
{
  free(c->x);
  free(c->cell);
  memset(c, 0, sizeof *c);
}

int vg_decomposition_parts(double cells, double leaf_cells)
{
  double parts = leaf_cells > 0 ? cells / leaf_cells : 1;

  return parts < 1 ? 1 : parts > 1e6 ? 1000000 : (int)(parts + 0.5);
}

/* Smallest leaves that are worth a cut, as measured. */
static const double least_leaf = 14000; /* C1 */

double vg_decomposition_leaf_cells(double cells, int n_part, int is_parted,
                                   double leaf_cells)
{
  double part = n_part > 0 ? cells / n_part : 0;

  if (!(part > 0) || !(leaf_cells > 0)) return leaf_cells;
  if (!is_parted) return part;
  return fmin(leaf_cells, fmax(part, least_leaf));
}

vg_status vg_decomposition_check_options(
  const struct vg_decomposition_options *o, double cells, struct vg_error *err)
{
  if (o->n_part < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "%d subdomains were requested; request at least 1",
                   o->n_part);
  if (o->n_part > 1 && o->n_part > cells)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%d subdomains were requested for a void in which "
                   "only %.0f cells are expected; request fewer subdomains, "
                   "or let leaf_cells determine their number",
                   o->n_part, cells);
  return VG_OK;
}

/* --- check --------------------------------------------------------------- */

/* A face by the global ids of its corners, ascending. */
struct side {
  uint64_t id[3];
  const double *x; /* Coordinates of one corner. */
  int8_t sense;    /* 1 or -1: parity of the sort. */
  int8_t is_part;  /* 0: a face of the void's front. */
};

static struct side side_of(const struct vg_front *f, const uint32_t v[3],
                           int is_part)
{
  struct side s = {
    { f->id[v[0]], f->id[v[1]], f->id[v[2]] }, f->x[v[0]], 1, (int8_t)is_part
  };

  for (int k = 0; k < 3; k++) {
    int i = k % 2; /* 0 1, 1 2, 0 1 */
    uint64_t swap = s.id[i];

    if (swap < s.id[i + 1]) continue;
    s.id[i] = s.id[i + 1];
    s.id[i + 1] = swap;
    s.sense = (int8_t)-s.sense;
  }
  return s;
}

static int by_corners(const void *a, const void *b)
{
  const struct side *s = a, *t = b;

  for (int k = 0; k < 3; k++)
    if (s->id[k] != t->id[k]) return s->id[k] < t->id[k] ? -1 : 1;
  return 0;
}

static void append_sides(const struct vg_front *f, int is_part, struct side *to)
{
  for (size_t k = 0; k < f->n_face; k++)
    to[k] = side_of(f, f->face[k], is_part);
}

/* Are the sides of one triangle consistent? Apart from the front, subdomains
 * have it once in each orientation or not at all. */
static int is_right(size_t n, const struct side *s)
{
  int over[2] = { 0, 0 };

  for (size_t k = 0; k < n; k++) over[s[k].sense > 0] += s[k].is_part ? 1 : -1;
  return over[0] == over[1] && (over[0] == 0 || over[0] == 1);
}

/* Checks that every point of a subdomain's front belongs to the void or to the
 * decomposition. */
static vg_status check_names(const struct vg_decomposition *p, uint32_t serial,
                             struct vg_error *err)
{
  for (size_t k = 0; k < p->n_part; k++) {
    const struct vg_front *f = &p->part[k].front;

    for (size_t v = 0; v < f->n_point; v++) {
      uint32_t at = (uint32_t)f->id[v];

      if (f->id[v] >> 32 != serial) continue;
      if (at < p->n_point && !memcmp(p->x[at], f->x[v], sizeof *f->x)) continue;
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "subdomain %zu of %zu has a point at "
                     "(%g, %g, %g) that is on no interface",
                     k + 1, p->n_part, f->x[v][0], f->x[v][1], f->x[v][2]);
    }
  }
  return VG_OK;
}

vg_status vg_decomposition_check(const struct vg_decomposition *p,
                                 const struct vg_front *front, uint32_t serial,
                                 struct vg_error *err)
{
  size_t n = front->n_face, end;
  struct side *s;
  vg_status st = check_names(p, serial, err);

  assert(front && (p->part || !p->n_part) && (p->x || !p->n_point));
  if (st < 0) return st;
  for (size_t k = 0; k < p->n_part; k++) n += p->part[k].front.n_face;
  s = vg_alloc(n, sizeof *s);
  if (!s) return vg_fail_memory(err, "the subdomains of a void");
  append_sides(front, 0, s);
  n = front->n_face;
  for (size_t k = 0; k < p->n_part; k++) {
    append_sides(&p->part[k].front, 1, s + n);
    n += p->part[k].front.n_face;
  }
  if (n) qsort(s, n, sizeof *s, by_corners);
  for (size_t k = 0; st == VG_OK && k < n; k = end) {
    for (end = k + 1; end < n && !by_corners(&s[k], &s[end]);) end++;
    if (!is_right(end - k, s + k))
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "the interfaces of the %zu subdomains of a void do not "
                   "match at (%g, %g, %g)",
                   p->n_part, s[k].x[0], s[k].x[1], s[k].x[2]);
  }
  free(s);
  return st;
}

/* --- for the store ------------------------------------------------------- */

/* Global ids of interface points are stored with this serial, which no task
 * has, since a resumed run uses other serials. */
static const uint32_t any_serial = UINT32_MAX;

static void give_names(struct vg_front *f, uint32_t from, uint32_t to)
{
  for (size_t k = 0; k < f->n_point; k++)
    if (f->id[k] >> 32 == from) f->id[k] = VG_POINT_ID(to, f->id[k]);
}

void vg_decomposition_put(struct vg_writer *w, struct vg_decomposition *p,
                          uint32_t serial)
{
  uint64_t count[2] = { p->n_point, p->n_part };

  assert(w && (p->part || !p->n_part));
  vg_put(w, 2, sizeof *count, count);
  vg_put(w, p->n_point, sizeof *p->x, p->x);
  vg_put(w, 1, sizeof p->report, &p->report);
  for (size_t k = 0; k < p->n_part; k++) {
    struct vg_front *f = &p->part[k].front;

    vg_put(w, 1, sizeof p->part[k].may_cut, &p->part[k].may_cut);
    give_names(f, serial, any_serial);
    vg_front_put(w, f, 1);
    give_names(f, any_serial, serial);
  }
}

void vg_decomposition_get(struct vg_reader *r, uint32_t serial,
                          struct vg_decomposition *p)
{
  uint64_t count[2] = { 0, 0 };

  assert(r && p);
  memset(p, 0, sizeof *p);
  vg_get(r, 2, sizeof *count, count);
  p->n_point = count[0];
  p->x = vg_get_array(r, p->n_point, sizeof *p->x);
  vg_get(r, 1, sizeof p->report, &p->report);
  if (!r->bad && count[1] > r->n) r->bad = 1;
  p->part = r->bad ? NULL : vg_calloc(count[1], sizeof *p->part);
  if (!p->part) r->bad = 1;
  for (; !r->bad && p->n_part < count[1]; p->n_part++) {
    struct vg_part *q = &p->part[p->n_part];

    vg_get(r, 1, sizeof q->may_cut, &q->may_cut);
    vg_front_get(r, &q->front, 1);
    give_names(&q->front, any_serial, serial);
  }
  if (r->bad) vg_decomposition_release(p);
}
