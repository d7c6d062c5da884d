/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/discrete/discrete.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/discrete/discrete_parts.h"

/* Coarse cells per subdomain if all sizes are multiplied: few enough to be
 * made quickly, many enough for balanced subdomains. And the bounds of the
 * factor. */
static const double cells_per_part = 150; /* D1 */
static const double least_factor = 1.5, most_factor = 6;

double vg_discrete_coarsening(double cells,
                              const struct vg_decomposition_options *o)
{
  double f = least_factor;

  if (o->coarsening > 0) return o->coarsening;
  while (f < most_factor && f * f * f * cells_per_part * o->n_part < cells)
    f *= 1.125;
  return f;
}

/* --- fronts of the subdomains -------------------------------------------- */

struct fill {
  const struct vg_front *front;
  const struct vg_coarse *c;
  const struct vg_interface *f;
  const struct vg_sheets *s;
  uint32_t serial;
  size_t n_all;     /* Points of coarse mesh and sheets. */
  uint32_t *name;   /* [n_all] Index among the interface points, or VG_NONE. */
  uint32_t *number; /* [n_all] Index in a front. */
};

static const double *point_of(const struct fill *a, size_t k)
{
  size_t n = a->c->t.n_point;

  return k < n ? a->c->t.x[k] : a->s->x[k - n];
}

/* Numbers the interface points that are not on the front, in the order of all
 * points. */
static vg_status name_points(struct fill *a, struct vg_decomposition *out,
                             struct vg_error *err)
{
  size_t n_tri = a->s->begin[a->f->n_face];

  a->n_all = a->c->t.n_point + a->s->n_point;
  a->name = vg_alloc(a->n_all, sizeof *a->name);
  a->number = vg_alloc(a->n_all, sizeof *a->number);
  if (!a->name || !a->number) return vg_fail_memory(err, "the subdomains");
  memset(a->name, 0xff, a->n_all * sizeof *a->name);
  for (size_t k = 0; k < 3 * n_tri; k++) {
    uint32_t v = a->s->tri[k / 3][k % 3];

    if (v >= a->c->n_front) a->name[v] = 0;
  }
  for (size_t k = 0; k < a->n_all; k++)
    if (a->name[k] != VG_NONE) a->name[k] = (uint32_t)out->n_point++;
  out->x = vg_alloc(out->n_point, sizeof *out->x);
  if (!out->x) return vg_fail_memory(err, "the subdomains");
  for (size_t k = 0; k < a->n_all; k++)
    if (a->name[k] != VG_NONE)
      memcpy(out->x[a->name[k]], point_of(a, k), sizeof *out->x);
  return VG_OK;
}

/* Subdomains on both sides of face i. */
static void parts_of(const struct fill *a, size_t i, uint32_t part[2])
{
  uint32_t side = a->f->side[i];

  part[0] = a->c->part[side >> 2];
  part[1] = a->c->part[a->c->t.cell[side >> 2].link[side & 3] >> 2];
}

static vg_status make_faces(const struct fill *a, struct vg_decomposition *out,
                            struct vg_error *err)
{
  const struct vg_coarse *c = a->c;
  uint32_t p[2];

  for (size_t q = 0; q < 4 * c->t.n_cell; q++)
    out->part[c->part[q / 4]].front.n_face += c->on[q / 4][q % 4] != VG_NONE;
  for (size_t i = 0; i < a->f->n_face; i++) {
    parts_of(a, i, p);
    for (int k = 0; k < 2; k++)
      out->part[p[k]].front.n_face += a->s->begin[i + 1] - a->s->begin[i];
  }
  for (size_t k = 0; k < out->n_part; k++) {
    struct vg_front *f = &out->part[k].front;

    f->face = vg_alloc(f->n_face, sizeof *f->face);
    if (!f->face) return vg_fail_memory(err, "the subdomains");
    f->n_face = 0;
  }
  for (size_t q = 0; q < 4 * c->t.n_cell; q++)
    if (c->on[q / 4][q % 4] != VG_NONE) {
      struct vg_front *f = &out->part[c->part[q / 4]].front;

      memcpy(f->face[f->n_face++], a->front->face[c->on[q / 4][q % 4]],
             sizeof *f->face);
    }
  for (size_t i = 0; i < a->f->n_face; i++) {
    parts_of(a, i, p);
    for (size_t t = a->s->begin[i]; t < a->s->begin[i + 1]; t++)
      for (int k = 0; k < 2; k++) {
        struct vg_front *f = &out->part[p[k]].front;
        const uint32_t *v = a->s->tri[t];

        f->face[f->n_face][0] = v[0];
        f->face[f->n_face][1] = v[1 + k];
        f->face[f->n_face++][2] = v[2 - k];
      }
  }
  return VG_OK;
}

/* Renumbers the faces from all points to the points of their front. */
static vg_status make_points(const struct fill *a, struct vg_front *f,
                             struct vg_error *err)
{
  f->x = vg_alloc(3 * f->n_face, sizeof *f->x);
  f->id = vg_alloc(3 * f->n_face, sizeof *f->id);
  if (!f->x || !f->id) return vg_fail_memory(err, "the subdomains");
  for (size_t k = 0; k < 3 * f->n_face; k++)
    a->number[f->face[k / 3][k % 3]] = VG_NONE;
  for (size_t k = 0; k < 3 * f->n_face; k++) {
    uint32_t v = f->face[k / 3][k % 3];

    if (a->number[v] == VG_NONE) {
      memcpy(f->x[f->n_point], point_of(a, v), sizeof *f->x);
      f->id[f->n_point] = v < a->c->n_front
                          ? a->front->id[v]
                          : VG_POINT_ID(a->serial, a->name[v]);
      a->number[v] = (uint32_t)f->n_point++;
    }
    f->face[k / 3][k % 3] = a->number[v];
  }
  return VG_OK;
}

static vg_status make_parts(struct fill *a, struct vg_decomposition *out,
                            struct vg_error *err)
{
  vg_status st = name_points(a, out, err);

  if (st == VG_OK) {
    out->part = vg_calloc(a->c->n_part, sizeof *out->part);
    if (!out->part) st = vg_fail_memory(err, "the subdomains");
    else out->n_part = a->c->n_part;
  }
  if (st == VG_OK) st = make_faces(a, out, err);
  for (size_t k = 0; st == VG_OK && k < out->n_part; k++)
    st = make_points(a, &out->part[k].front, err);
  free(a->name);
  free(a->number);
  return st;
}

/* --- all steps ----------------------------------------------------------- */

vg_status vg_discrete_refuse(vg_status st, const char *why, double factor,
                             struct vg_error *err)
{
  char text[300]; /* copy, because why may point into *err */

  assert(st < 0 && why);
  snprintf(text, sizeof text, "%s", why);
  return vg_fail(err, st,
                 "the coarse mesh for the discrete decomposition failed "
                 "(%s); try another coarsening than %g, or set decompose "
                 "to advancing",
                 text, factor);
}

static vg_status coarse(const struct vg_front *front,
                        const struct vg_sizing *sizing,
                        const struct vg_decomposition_options *o,
                        const struct vg_engine *e, struct vg_coarse *c,
                        struct vg_decomposition_report *r, struct vg_error *err)
{
  struct vg_error why = { .text = "" };
  vg_status st = vg_coarse_fill(front, sizing, r->coarsening, o->coarse, e, c,
                                &why);

  if (st == VG_ERR_GEOMETRY || st == VG_ERR_UNSUPPORTED)
    return vg_discrete_refuse(st, why.text, r->coarsening, err);
  if (st != VG_OK) {
    *err = why;
    return st;
  }
  r->n_coarse = c->t.n_cell;
  if (c->t.n_cell >= (size_t)o->n_part) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%d subdomains were requested, but the coarse mesh has "
                 "only %zu cells; request fewer subdomains, or a smaller "
                 "coarsening than %g",
                 o->n_part, c->t.n_cell, r->coarsening);
}

vg_status vg_discrete_part(const struct vg_front *front,
                           const struct vg_load *load,
                           const struct vg_sizing *sizing,
                           const struct vg_decomposition_options *o,
                           uint32_t serial, const struct vg_engine *e,
                           struct vg_decomposition *out, struct vg_error *err)
{
  struct vg_coarse c = { 0 };
  struct vg_interface f = { 0 };
  struct vg_sheets s = { 0 };
  struct vg_decomposition made = VG_DECOMPOSITION_INIT;
  struct vg_decomposition_report *r = &made.report;
  struct fill a = { front, &c, &f, &s, serial, 0, NULL, NULL };
  double t[VG_DECOMPOSITION_STEPS + 1];
  vg_status st = vg_decomposition_check_options(o, load->cells, err);

  assert(front && sizing && !out->n_point && !out->n_part && !out->part);
  if (st < 0) return st;
  t[0] = vg_clock();
  r->n_asked = (uint64_t)o->n_part;
  r->coarsening = vg_discrete_coarsening(load->cells, o);
  st = coarse(front, sizing, o, e, &c, r, err);
  if (st != VG_OK) goto done;
  t[1] = vg_clock();
  VG_TRY(vg_coarse_assign(&c, load, sizing, o, e, &r->n_apart, err));
  r->other_seconds = c.other_seconds;
  VG_TRY(vg_interface_list(&c, &f, err));
  t[2] = vg_clock();
  VG_TRY(vg_interface_smooth(&c, &f, err));
  t[3] = vg_clock();
  VG_TRY(o->h_refine ? vg_sheets_halve(&c, &f, sizing, &s, err)
                     : vg_sheets_remesh(&c, &f, sizing, e, &s, err));
  r->n_face = s.begin[f.n_face];
  VG_TRY(make_parts(&a, &made, err));
  t[4] = vg_clock();
  for (int k = 0; k < VG_DECOMPOSITION_STEPS; k++) r->time[k] = t[k + 1] - t[k];
  if (o->coarse) r->time[VG_DECOMPOSITION_COARSE] += o->coarse->seconds;
  *out = made;
  memset(&made, 0, sizeof made);
done:
  vg_decomposition_release(&made);
  vg_sheets_release(&s);
  vg_interface_release(&f);
  vg_coarse_release(&c);
  return st;
}
