#include "partition/cut/task_data.h"

#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"

void vg_front_release(struct vg_front *f)
{
  free(f->x);
  free(f->name);
  free(f->face);
  memset(f, 0, sizeof *f);
}

void vg_front_put(struct vg_writer *w, const struct vg_front *f, int names)
{
  uint64_t count[2] = {f->n_point, f->n_face};

  vg_put(w, 2, sizeof *count, count);
  vg_put(w, f->n_point, sizeof *f->x, f->x);
  vg_put(w, f->n_face, sizeof *f->face, f->face);
  if (names) vg_put(w, f->n_point, sizeof *f->name, f->name);
}

static int all_below(size_t n, const uint32_t *v, size_t limit)
{
  for (size_t i = 0; i < n; i++)
    if (v[i] >= limit) return 0;
  return 1;
}

void vg_front_get(struct vg_reader *r, struct vg_front *f, int names)
{
  uint64_t count[2] = {0, 0};

  memset(f, 0, sizeof *f);
  vg_get(r, 2, sizeof *count, count);
  f->n_point = count[0];
  f->n_face = count[1];
  f->x = vg_get_array(r, f->n_point, sizeof *f->x);
  f->face = vg_get_array(r, f->n_face, sizeof *f->face);
  if (names) f->name = vg_get_array(r, f->n_point, sizeof *f->name);
  if (!r->bad && !all_below(3 * f->n_face, f->face[0], f->n_point))
    r->bad = 1;
  if (r->bad) vg_front_release(f);
}

double vg_front_volume(const struct vg_front *f)
{
  double sum = 0;

  for (size_t i = 0; i < f->n_face; i++) {
    double a[3], b[3], c[3];

    vg_sub(f->x[f->face[i][0]], f->x[0], a);
    vg_sub(f->x[f->face[i][1]], f->x[0], b);
    vg_sub(f->x[f->face[i][2]], f->x[0], c);
    sum -= vg_triple(a, b, c) / 6;
  }
  return sum;
}

double vg_front_work(const struct vg_front *f)
{
  double area = 0, volume = vg_front_volume(f);

  for (size_t i = 0; i < f->n_face; i++) {
    const double *x = f->x[f->face[i][0]];
    double a[3], b[3], n[3];

    vg_sub(f->x[f->face[i][1]], x, a);
    vg_sub(f->x[f->face[i][2]], x, b);
    vg_cross(a, b, n);
    area += vg_norm(n) / 2;
  }
  return volume > 0 && area > 0 ? volume * (double)f->n_face / area : 0;
}

/* Two points of one name are one point: parts that were one front may touch.
 * to out: [n_point] the first point of the same name. */
static vg_status find_twins(const struct vg_front *f, uint32_t *to,
                            struct vg_error *err)
{
  struct vg_key *key = vg_alloc(f->n_point, sizeof *key);
  vg_status st;

  if (!key) return vg_fail_memory(err, "a front");
  for (size_t k = 0; k < f->n_point; k++)
    key[k] = (struct vg_key){ f->name[k], (uint32_t)k };
  st = vg_sort_keys(f->n_point, key, err);
  for (size_t k = 0; st == VG_OK && k < f->n_point; k++)
    to[key[k].index] = k && key[k].key == key[k - 1].key
                         ? to[key[k - 1].index] : key[k].index;
  free(key);
  return st;
}

vg_status vg_front_weld(struct vg_front *f, struct vg_error *err)
{
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  size_t n = 0;
  vg_status st = to ? find_twins(f, to, err) : vg_fail_memory(err, "a front");

  for (size_t k = 0; st == VG_OK && k < f->n_point; k++) {
    if (to[k] != k) {
      to[k] = to[to[k]];
      continue;
    }
    memmove(f->x[n], f->x[k], sizeof *f->x);
    f->name[n] = f->name[k];
    to[k] = (uint32_t)n++;
  }
  for (size_t i = 0; st == VG_OK && i < f->n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[f->face[i][k]];
  if (st == VG_OK) f->n_point = n;
  free(to);
  return st;
}

vg_status vg_front_join(struct vg_front *to, const struct vg_front *from,
                        struct vg_error *err)
{
  size_t cap_x = to->n_point, cap_name = to->n_point, cap_face = to->n_face;
  size_t np = to->n_point + from->n_point, nf = to->n_face + from->n_face;

  if (vg_reserve(&to->x, &cap_x, np, sizeof *to->x) ||
      vg_reserve(&to->name, &cap_name, np, sizeof *to->name) ||
      vg_reserve(&to->face, &cap_face, nf, sizeof *to->face))
    return vg_fail_memory(err, "a front");
  if (from->n_point) {
    memcpy(to->x + to->n_point, from->x, from->n_point * sizeof *to->x);
    memcpy(to->name + to->n_point, from->name,
           from->n_point * sizeof *to->name);
  }
  for (size_t i = 0; i < from->n_face; i++)
    for (int k = 0; k < 3; k++)
      to->face[to->n_face + i][k] =
        (uint32_t)to->n_point + from->face[i][k];
  to->n_point = np;
  to->n_face = nf;
  return VG_OK;
}

vg_status vg_front_append(struct vg_front *to, const struct vg_front *from,
                          struct vg_error *err)
{
  vg_status st = vg_front_join(to, from, err);

  return st == VG_OK ? vg_front_weld(to, err) : st;
}

/* --- outcomes ------------------------------------------------------------ */

void vg_piece_release(struct vg_piece *p)
{
  free(p->in);
  free(p->x);
  free(p->cell);
  memset(p, 0, sizeof *p);
}

void vg_change_release(struct vg_change *c)
{
  free(c->x);
  free(c->face);
  free(c->gone);
  memset(c, 0, sizeof *c);
}

void vg_change_put(struct vg_writer *w, const struct vg_change *c)
{
  uint64_t count[8] = {(uint64_t)c->blocked, c->serial, c->n_point, c->n_face,
                       c->n_gone, c->n_cell, c->n_hole, c->n_part};

  vg_put(w, 8, sizeof *count, count);
  vg_put(w, 1, sizeof c->volume, &c->volume);
  vg_put(w, c->n_point, sizeof *c->x, c->x);
  vg_put(w, c->n_face, sizeof *c->face, c->face);
  vg_put(w, c->n_gone, sizeof *c->gone, c->gone);
}

void vg_change_get(struct vg_reader *r, struct vg_change *c)
{
  uint64_t count[8] = {0};

  memset(c, 0, sizeof *c);
  vg_get(r, 8, sizeof *count, count);
  vg_get(r, 1, sizeof c->volume, &c->volume);
  c->blocked = count[0] != 0;
  c->serial = (uint32_t)count[1];
  c->n_point = count[2];
  c->n_face = count[3];
  c->n_gone = count[4];
  c->n_cell = count[5];
  c->n_hole = count[6];
  c->n_part = count[7];
  c->x = vg_get_array(r, c->n_point, sizeof *c->x);
  c->face = vg_get_array(r, c->n_face, sizeof *c->face);
  c->gone = vg_get_array(r, c->n_gone, sizeof *c->gone);
  if (r->bad) vg_change_release(c);
}
