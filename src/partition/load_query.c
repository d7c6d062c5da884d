#include "partition/load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/comm.h"
#include "base/memory.h"

/* Bins of a histogram, and how many histograms, each within a bin of the one
 * before: so cells count as even within 1 / 2^16 of the extent. */
enum { BINS = 256, ZOOMS = 2 };

/* Part of a cube's cells below x. */
static inline double below(const struct vg_load_cube *c, int axis, double x)
{
  const double s = (x - (double)c->at[axis]) / (double)c->half;

  return s <= -1 ? 0 : s >= 1 ? 1 : 0.5 * (1 + s);
}

static void extent(const struct vg_load *l, int axis, double *lo, double *hi)
{
  *lo = INFINITY;
  *hi = -INFINITY;
  for (size_t i = 0; i < l->n; i++) {
    const double x = (double)l->cube[i].at[axis];
    const double half = (double)l->cube[i].half;

    if (x - half < *lo) *lo = x - half;
    if (x + half > *hi) *hi = x + half;
  }
}

/* Cells in each bin of [lo, hi]; returns those below lo. */
static double histogram(const struct vg_load *l, int axis, double lo,
                        double hi, double bin[BINS])
{
  const double width = (hi - lo) / BINS, scale = 1 / width;
  double under = 0;

  memset(bin, 0, BINS * sizeof *bin);
  for (size_t i = 0; i < l->n; i++) {
    const struct vg_load_cube *c = &l->cube[i];
    const double half = (double)c->half, cells = (double)c->cells;
    const double from = ((double)c->at[axis] - half - lo) * scale;
    const double to = ((double)c->at[axis] + half - lo) * scale;
    double density, last = from;

    if (from >= BINS) continue;
    if (to <= 0) {
      under += cells;
      continue;
    }
    density = cells / (to - from);
    if (from < 0) {
      under -= density * from;
      last = 0;
    }
    for (int b = (int)last; b < BINS && b < to; b++) {
      const double next = b + 1 < to ? b + 1 : to;

      bin[b] += density * (next - last);
      last = next;
    }
  }
  return under;
}

double vg_load_quantile(const struct vg_load *l, int axis, double part)
{
  double bin[BINS], lo, hi, target = part * l->cells, rest = 0;

  if (!l->n) return 0;
  extent(l, axis, &lo, &hi);
  if (!(part > 0)) return lo;
  if (!(part < 1)) return hi;
  for (int zoom = 0; zoom < ZOOMS && hi > lo; zoom++) {
    const double width = (hi - lo) / BINS;
    double sum = histogram(l, axis, lo, hi, bin);
    int b = 0;

    while (b < BINS - 1 && sum + bin[b] < target) sum += bin[b++];
    lo += b * width;
    hi = lo + width;
    rest = bin[b] > 0 ? (target - sum) / bin[b] : 0;
  }
  return lo + fmin(fmax(rest, 0), 1) * (hi - lo);
}

double vg_load_zone(const struct vg_load *l, int axis, double at,
                    double width)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    const struct vg_load_cube *c = &l->cube[i];
    const double reach = width * (double)c->h;

    if (fabs((double)c->at[axis] - at) < (double)c->half + reach)
      sum += (double)c->cells * (below(c, axis, at + reach)
                                 - below(c, axis, at - reach));
  }
  return sum;
}

double vg_load_coarsest(const struct vg_load *l, int axis, double at)
{
  double most = 0;

  for (size_t i = 0; i < l->n; i++) {
    const struct vg_load_cube *c = &l->cube[i];

    if (fabs((double)c->at[axis] - at) <= (double)c->half
        && (double)c->h > most)
      most = (double)c->h;
  }
  return most;
}

/* --- bytes --------------------------------------------------------------- */

struct head {
  char magic[8];
  uint64_t n;
  double lo[3], unit;
};

static const char magic[8] = { 'V', 'G', 'L', 'O', 'A', 'D', '1', '\n' };

vg_status vg_load_pack(const struct vg_load *l, struct vg_bytes *out,
                       struct vg_error *err)
{
  struct head h = { .n = l->n, .unit = l->unit };
  const size_t cubes = l->n * sizeof *l->cube;
  unsigned char *data = vg_alloc(sizeof h + cubes, 1);

  if (!data) return vg_fail_memory(err, "a message with a load");
  memcpy(h.magic, magic, sizeof magic);
  memcpy(h.lo, l->lo, sizeof h.lo);
  memcpy(data, &h, sizeof h);
  if (cubes) memcpy(data + sizeof h, l->cube, cubes);
  out->n = sizeof h + cubes;
  out->data = data;
  return VG_OK;
}

static int is_sound(const struct vg_load_cube *c)
{
  for (int k = 0; k < 3; k++)
    if (!isfinite(c->at[k])) return 0;
  return isfinite(c->half) && c->half > 0 && isfinite(c->h) && c->h > 0
         && isfinite(c->part) && c->part > 0 && isfinite(c->cells)
         && c->cells >= 0;
}

vg_status vg_load_unpack(const struct vg_bytes *in, struct vg_load *out,
                         struct vg_error *err)
{
  struct vg_load l = VG_LOAD_INIT;
  struct head h;

  if (in->n < sizeof h) goto damaged;
  memcpy(&h, in->data, sizeof h);
  if (memcmp(h.magic, magic, sizeof magic)
      || h.n != (in->n - sizeof h) / sizeof *l.cube
      || (in->n - sizeof h) % sizeof *l.cube || !isfinite(h.unit)
      || !isfinite(h.lo[0] + h.lo[1] + h.lo[2]))
    goto damaged;
  l.n = h.n;
  l.unit = h.unit;
  memcpy(l.lo, h.lo, sizeof l.lo);
  l.cube = vg_alloc(l.n, sizeof *l.cube);
  if (!l.cube) return vg_fail_memory(err, "a load from a message");
  if (l.n) memcpy(l.cube, in->data + sizeof h, l.n * sizeof *l.cube);
  for (size_t i = 0; i < l.n; i++) {
    if (!is_sound(&l.cube[i])) goto damaged;
    l.cells += (double)l.cube[i].cells;
  }
  *out = l;
  return VG_OK;
damaged:
  vg_load_release(&l);
  return vg_fail(err, VG_ERR_FORMAT, "a message with a load is damaged; the "
                 "ranks must run the same build of vanguard");
}
