/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Errors of the schemes on all control volumes. Sums are kept for chunks of
 * control volumes and added up in their order, so that they do not depend on
 * the number of threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/accuracy/accuracy_parts.h"
#include "core/geometry/vector.h"

#define CHUNK ((size_t)8192)

/* Sums over control volumes: of volumes, and of errors and exact values with
 * the volumes as weights. */
struct sums {
  size_t n;
  double volume, error1, error2, error_max, exact1, exact2, exact_max;
};

struct chunk {
  struct sums sums[VG_SCHEMES][VG_ZONES_APART];
  size_t n_deficient;
};

struct sweep {
  struct vg_measurement *k;
  const struct vg_field *field;
  struct chunk *chunk;
};

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "the check of accuracy");
}

/* --- places and values ---------------------------------------------------- */

static uint8_t zone_of(const struct vg_measurement *k, const struct vg_place *p)
{
  const double unit = k->scale.viscous;
  const double y = unit > 0 ? p->distance / unit : INFINITY;

  if (y <= 5) return VG_ZONE_SUBLAYER;
  if (y <= 30) return VG_ZONE_BUFFER;
  if (y <= VG_LAYERS_Y_PLUS) return VG_ZONE_LOG;
  return vg_distance(p->x, k->scale.centre) <= k->scale.length ? VG_ZONE_FIELD
                                                               : VG_ZONE_FAR;
}

static void find_places(void *context, size_t first, size_t end, int worker)
{
  struct vg_measurement *k = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_place *p = &k->place[i];

    memcpy(p->x, k->volumes.x[i], sizeof p->x);
    vg_wall_search_ask(k->walls, p);
    k->zone[i] = zone_of(k, p);
  }
}

static void find_border(void *context, size_t first, size_t end, int worker)
{
  struct vg_measurement *k = context;

  (void)worker;
  for (size_t b = first; b < end; b++) {
    memcpy(k->border[b].x, k->volumes.at[b], sizeof k->border[b].x);
    vg_wall_search_ask(k->walls, &k->border[b]);
  }
}

/* The wall of a boundary face, or VG_NO_PATCH. Faces: triangles, then
 * quadrilaterals. */
static uint32_t wall_of(const struct vg_measurement *k, size_t face)
{
  const struct vg_mesh *m = k->m;
  uint32_t patch = face < m->n_tri ? m->tri_patch[face]
                                   : m->quad_patch[face - m->n_tri];

  return k->is_wall[patch] ? patch : VG_NO_PATCH;
}

static void find_patches(struct vg_measurement *k)
{
  const struct vg_volumes *v = &k->volumes;
  const size_t n_tri = k->m->n_tri;

  for (size_t i = 0; i < v->n; i++) k->patch[i] = VG_NO_PATCH;
  for (size_t b = 0; b < v->n_border; b++) {
    size_t face = b;
    uint32_t patch;

    if (v->in == VG_IN_NODES)
      face = b < 3 * n_tri ? b / 3 : n_tri + (b - 3 * n_tri) / 4;
    patch = wall_of(k, face);
    if (patch < k->patch[v->owner[b]]) k->patch[v->owner[b]] = patch;
  }
}

vg_status vg_measurement_open(struct vg_measurement *k, struct vg_error *err)
{
  const struct vg_volumes *v = &k->volumes;
  const size_t n_border = v->in == VG_IN_CELLS ? v->n_border : 0;

  k->place = vg_alloc(v->n, sizeof *k->place);
  k->border = vg_alloc(n_border, sizeof *k->border);
  k->zone = vg_alloc(v->n, sizeof *k->zone);
  k->patch = vg_alloc(v->n, sizeof *k->patch);
  k->gradient = vg_alloc(v->n, sizeof *k->gradient);
  k->values.v = v;
  k->values.at = vg_alloc(v->n, sizeof *k->values.at);
  k->values.border = vg_alloc(n_border, sizeof *k->values.border);
  if (!k->place || !k->border || !k->zone || !k->patch || !k->gradient ||
      !k->values.at || !k->values.border)
    return no_memory(err);
  vg_parallel_for(k->threads, v->n, CHUNK, find_places, k);
  vg_parallel_for(k->threads, n_border, CHUNK, find_border, k);
  find_patches(k);
  return VG_OK;
}

void vg_measurement_release(struct vg_measurement *k)
{
  free(k->place);
  free(k->border);
  free(k->zone);
  free(k->patch);
  free(k->gradient);
  free(k->values.at);
  free(k->values.border);
  vg_volumes_release(&k->volumes);
}

static void find_values(void *context, size_t first, size_t end, int worker)
{
  struct sweep *s = context;
  struct vg_field_value value;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    s->field->at(&s->k->scale, &s->k->place[i], &value);
    s->k->values.at[i] = value.value;
  }
}

static void find_border_values(void *context, size_t first, size_t end,
                               int worker)
{
  struct sweep *s = context;
  struct vg_field_value value;

  (void)worker;
  for (size_t b = first; b < end; b++) {
    s->field->at(&s->k->scale, &s->k->border[b], &value);
    s->k->values.border[b] = value.value;
  }
}

void vg_measure_values(struct vg_measurement *k, enum vg_accuracy_field field)
{
  struct sweep s = { .k = k, .field = &vg_fields[field] };
  const struct vg_volumes *v = &k->volumes;

  vg_parallel_for(k->threads, v->n, CHUNK, find_values, &s);
  if (v->in == VG_IN_CELLS)
    vg_parallel_for(k->threads, v->n_border, CHUNK, find_border_values, &s);
}

/* --- errors --------------------------------------------------------------- */

static void count(struct sums *s, double volume, double error, double exact)
{
  s->n++;
  s->volume += volume;
  s->error1 += volume * error;
  s->error2 += volume * error * error;
  s->error_max = fmax(s->error_max, error);
  s->exact1 += volume * exact;
  s->exact2 += volume * exact * exact;
  s->exact_max = fmax(s->exact_max, exact);
}

/* The wall profile is defined within the layers, except at sharp edges. */
static int counts(const struct vg_measurement *k, const struct vg_field *f,
                  size_t i)
{
  const double *n = k->place[i].normal;

  return !f->needs_walls || (k->zone[i] <= VG_ZONE_LOG && vg_dot(n, n) > 0);
}

static void find_gradients(void *context, size_t first, size_t end, int worker)
{
  struct sweep *s = context;
  struct vg_measurement *k = s->k;
  struct chunk *chunk = &s->chunk[first / CHUNK];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double gradient[VG_SCHEME_VISCOUS][3];
    struct vg_field_value exact;

    chunk->n_deficient += (size_t)vg_scheme_gradients(&k->values, i, gradient);
    memcpy(k->gradient[i], gradient[VG_SCHEME_WLSQ], sizeof k->gradient[i]);
    if (!counts(k, s->field, i)) continue;
    s->field->at(&k->scale, &k->place[i], &exact);
    for (int scheme = 0; scheme < VG_SCHEME_VISCOUS; scheme++)
      count(&chunk->sums[scheme][k->zone[i]], k->volumes.volume[i],
            vg_distance(gradient[scheme], exact.gradient),
            vg_norm(exact.gradient));
  }
}

static void find_laplacians(void *context, size_t first, size_t end, int worker)
{
  struct sweep *s = context;
  struct vg_measurement *k = s->k;
  struct chunk *chunk = &s->chunk[first / CHUNK];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_field_value exact;
    double laplacian;

    if (!counts(k, s->field, i) ||
        !vg_scheme_laplacian(&k->values, i, (const double(*)[3])k->gradient,
                             &laplacian))
      continue;
    s->field->at(&k->scale, &k->place[i], &exact);
    count(&chunk->sums[VG_SCHEME_VISCOUS][k->zone[i]], k->volumes.volume[i],
          fabs(laplacian - exact.laplacian), fabs(exact.laplacian));
  }
}

static void join(struct sums *s, const struct sums *more)
{
  s->n += more->n;
  s->volume += more->volume;
  s->error1 += more->error1;
  s->error2 += more->error2;
  s->error_max = fmax(s->error_max, more->error_max);
  s->exact1 += more->exact1;
  s->exact2 += more->exact2;
  s->exact_max = fmax(s->exact_max, more->exact_max);
}

static struct vg_accuracy_error error_of(const struct sums *s)
{
  struct vg_accuracy_error e = { s->n, s->volume, NAN, NAN, NAN };

  if (!s->n || !(s->exact_max > 0)) return e;
  e.l1 = s->error1 / s->exact1;
  e.l2 = sqrt(s->error2 / s->exact2);
  e.max = s->error_max / s->exact_max;
  return e;
}

static void report(const struct sweep *s, size_t n_chunk,
                   struct vg_accuracy_error out[VG_SCHEMES][VG_ZONES])
{
  for (int scheme = 0; scheme < VG_SCHEMES; scheme++) {
    struct sums sums[VG_ZONES];

    memset(sums, 0, sizeof sums);
    for (int z = 0; z < VG_ZONES_APART; z++) {
      for (size_t c = 0; c < n_chunk; c++)
        join(&sums[z], &s->chunk[c].sums[scheme][z]);
      if (z <= VG_ZONE_LOG) join(&sums[VG_ZONE_LAYERS], &sums[z]);
      join(&sums[VG_ZONE_ALL], &sums[z]);
    }
    for (int z = 0; z < VG_ZONES; z++) out[scheme][z] = error_of(&sums[z]);
  }
}

static void measure_field(struct vg_measurement *k,
                          enum vg_accuracy_field field, struct chunk *chunk,
                          struct vg_accuracy_report *r)
{
  struct sweep s = { .k = k, .field = &vg_fields[field], .chunk = chunk };
  const struct vg_volumes *v = &k->volumes;
  size_t n_chunk = (v->n + CHUNK - 1) / CHUNK, n_deficient = 0;

  if (n_chunk) memset(chunk, 0, n_chunk * sizeof *chunk);
  vg_measure_values(k, field);
  vg_parallel_for(k->threads, v->n, CHUNK, find_gradients, &s);
  if (s.field->has_laplacian)
    vg_parallel_for(k->threads, v->n, CHUNK, find_laplacians, &s);
  report(&s, n_chunk, r->error[v->in][field]);
  for (size_t c = 0; c < n_chunk; c++) n_deficient += chunk[c].n_deficient;
  r->n_deficient[v->in] = n_deficient;
}

vg_status vg_measure_fields(struct vg_measurement *k,
                            struct vg_accuracy_report *r, struct vg_error *err)
{
  struct chunk *chunk = vg_alloc(k->volumes.n / CHUNK + 1, sizeof *chunk);

  if (!chunk) return no_memory(err);
  for (int f = 0; f < VG_FIELDS; f++)
    if (vg_fields[f].needs_walls ? k->scale.viscous > 0 : !k->only_walls)
      measure_field(k, (enum vg_accuracy_field)f, chunk, r);
  free(chunk);
  return VG_OK;
}
