/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/topology/fan.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"
#include "layers/topology/most_normal.h"

/* L12: Thresholds as in direct.c. Where all faces are seen with at least
 * SMOOTH_WALL the direction is the mean normal, elsewhere it is the most normal
 * direction. */
#define LEAST_CLEAR 0.3 /* Least distance from the wall after a unit step. */
#define SMOOTH_WALL 0.95
/* Least cosine between the column of a sector and its faces. */
#define LEAST_VISIBILITY 0.1
/* L19: Fans that are made only where one column sees too little use ridges of
 * more than this angle, in degrees. */
#define NEEDED_ANGLE 60
/* L34: fans of sharp edges. A chain of edges that turn by more than CHAIN_ANGLE
 * degrees has fans if at least 1 in SHARP_OF is sharp: it turns by more than
 * SHARP_ANGLE. The tops of fans are as long as the edges of the wall: chains of
 * which more than 1 in STRETCHED_OF of the sharp edges is longer than STRETCHED
 * heights of an adjacent triangle have no fans. */
#define CHAIN_ANGLE 85
#define SHARP_ANGLE 110
#define SHARP_OF 8
#define STRETCHED 2.5
#define STRETCHED_OF 10
/* Least cosine between a single column and all faces. */
#define NEEDED_VISIBILITY 0.02

/* Which edges are ridges, and which points with ridges get fans. */
struct rule {
  double cos_fan, cos_half; /* Cosines of the fan angle and of half of it. */
  int if_needed;            /* Make fans only where no single direction sees all
                               faces. */
  int if_sharp;             /* Only edges of chains that are sharp and not
                               stretched. */
};

struct build {
  const struct vg_wall *w;
  size_t n_slide;
  const struct vg_slide *slide;
  struct vg_fans *f;
  int n_rule;
  struct rule rule[2]; /* The first one that makes a fan of a point holds. */
  double (*normal)[3]; /* [n_face] unit normals; 0 for a face of zero
                          area. */
  uint8_t *ridge;      /* [3 * n_face] Bit i: the half-edge is a ridge of
                          rule i. */
  uint8_t *at_ridge;   /* [n_point] Bit i: the point has such ridges. */
  double (*ring)[3];   /* Normals around one point, sector by sector. */
  size_t cap_ring, cap_chain, cap_fan, cap_preset;
};

void vg_fans_release(struct vg_fans *f)
{
  free(f->first);
  free(f->at);
  free(f->chain_of);
  free(f->chain);
  free(f->fan);
  free(f->preset);
  free(f->face);
  free(f->border);
  free(f->border_patch);
  memset(f, 0, sizeof *f);
}

/* Cosine of an angle of 0 to 180 degrees, the same on every machine. Evaluates
 * the series for a quarter of the angle (x < 0.79, the first omitted term is
 * 1e-15) and doubles the angle twice. */
static double cos_degrees(double angle)
{
  double x = angle * (3.14159265358979323846 / 720), x2 = x * x, c = 1;

  for (int n = 16; n > 0; n -= 2) c = 1 - c * x2 / (n * (n - 1));
  c = 2 * c * c - 1;
  return 2 * c * c - 1;
}

static void find_normals(struct build *b)
{
  const struct vg_mesh *m = b->w->surface;

  for (size_t f = 0; f < b->w->n_face; f++) {
    const uint32_t *t = m->tri[b->w->tri[f]];
    double u[3], v[3];

    vg_sub(m->point[t[1]], m->point[t[0]], u);
    vg_sub(m->point[t[2]], m->point[t[0]], v);
    vg_cross(u, v, b->normal[f]);
    vg_unit(b->normal[f]);
  }
}

/* Wall point at which half-edge h starts. */
static uint32_t corner_point(const struct vg_wall *w, uint32_t h)
{
  return w->face[h / 3][h % 3];
}

static const double *wall_point(const struct vg_wall *w, uint32_t h)
{
  return w->surface->point[w->point[corner_point(w, h)]];
}

/* Whether the edge turns by more than the fan angle and is convex. Convexity is
 * decided exactly: the opposite vertex of the neighbour lies behind the
 * face. */
static int is_ridge(const struct build *b, const struct rule *r, uint32_t h,
                    uint32_t g)
{
  const double *n = b->normal[h / 3], *o = b->normal[g / 3];
  uint32_t next = vg_half_next(h);

  if (!(vg_dot(n, n) > 0) || !(vg_dot(o, o) > 0)) return 0;
  if (vg_dot(n, o) >= r->cos_fan) return 0;
  return vg_orient3d(wall_point(b->w, h), wall_point(b->w, next),
                     wall_point(b->w, vg_half_next(next)),
                     wall_point(b->w, vg_half_prev(g))) < 0;
}

static void set_ridge(struct build *b, uint32_t h, uint32_t g, int rule)
{
  const uint8_t bit = (uint8_t)(1u << rule);

  b->ridge[h] |= bit;
  b->ridge[g] |= bit;
  b->at_ridge[corner_point(b->w, h)] |= bit;
  b->at_ridge[corner_point(b->w, g)] |= bit;
}

/* Height of the triangle of half-edge h over that edge. */
static double height_over(const struct vg_wall *w, uint32_t h)
{
  const double *o = wall_point(w, h);
  double e[3], f[3], n[3];

  vg_sub(wall_point(w, vg_half_next(h)), o, e);
  vg_sub(wall_point(w, vg_half_prev(h)), o, f);
  vg_cross(e, f, n);
  return vg_norm(n) / vg_norm(e);
}

static int is_stretched(const struct vg_wall *w, uint32_t h, uint32_t g)
{
  const double e = vg_distance(wall_point(w, h), wall_point(w, g));

  return e > STRETCHED * fmin(height_over(w, h), height_over(w, g));
}

/* Edges of a chain: all, sharp ones, sharp and stretched ones. */
struct chain {
  size_t n, n_sharp, n_stretched;
};

static int has_fans(const struct chain *c)
{
  return SHARP_OF * c->n_sharp >= c->n &&
         STRETCHED_OF * c->n_stretched <= c->n_sharp;
}

static void count_edge(const struct build *b, uint32_t h, double cos_sharp,
                       struct chain *c)
{
  const uint32_t g = b->w->opposite[h];

  c->n++;
  if (vg_dot(b->normal[h / 3], b->normal[g / 3]) >= cos_sharp) return;
  c->n_sharp++;
  c->n_stretched += (size_t)is_stretched(b->w, h, g);
}

/* Make ridges of the edges in `list` whose chains are sharp and not
 * stretched. */
static vg_status keep_sharp(struct build *b, int rule, size_t n,
                            const uint32_t *list, struct vg_error *err)
{
  const struct vg_wall *w = b->w;
  const double cos_sharp = cos_degrees(SHARP_ANGLE);
  uint32_t *up = vg_alloc(w->n_point, sizeof *up);
  struct chain *chain = vg_calloc(w->n_point, sizeof *chain);
  vg_status st = VG_OK;

  if (!up || !chain) {
    st = vg_fail_memory(err, "the fans at convex edges");
    goto done;
  }
  for (uint32_t p = 0; p < w->n_point; p++) up[p] = p;
  for (size_t i = 0; i < n; i++)
    vg_union(up, corner_point(w, list[i]),
             corner_point(w, w->opposite[list[i]]));
  for (size_t i = 0; i < n; i++)
    count_edge(b, list[i], cos_sharp,
               &chain[vg_root_of(up, corner_point(w, list[i]))]);
  for (size_t i = 0; i < n; i++)
    if (has_fans(&chain[vg_root_of(up, corner_point(w, list[i]))]))
      set_ridge(b, list[i], w->opposite[list[i]], rule);
done:
  free(up);
  free(chain);
  return st;
}

static vg_status find_ridges(struct build *b, int rule, struct vg_error *err)
{
  const struct vg_wall *w = b->w;
  const struct rule *r = &b->rule[rule];
  uint32_t *list = NULL;
  size_t n = 0, cap = 0;
  vg_status st = VG_OK;

  for (uint32_t h = 0; h < 3 * w->n_face; h++) {
    uint32_t g = w->opposite[h];

    if (g == VG_NO_INDEX || g < h || !is_ridge(b, r, h, g)) continue;
    if (!r->if_sharp) {
      set_ridge(b, h, g, rule);
      continue;
    }
    if (vg_reserve(&list, &cap, n + 1, sizeof *list) < 0) {
      st = vg_fail_memory(err, "the fans at convex edges");
      goto done;
    }
    list[n++] = h;
  }
  if (n) st = keep_sharp(b, rule, n, list, err);
done:
  free(list);
  return st;
}

/* Weight of a face at corner h: the chord of its angle. */
static double corner_weight(const struct vg_wall *w, uint32_t h)
{
  double a[3], b[3];

  vg_sub(wall_point(w, vg_half_next(h)), wall_point(w, h), a);
  vg_sub(wall_point(w, vg_half_prev(h)), wall_point(w, h), b);
  vg_unit(a);
  vg_unit(b);
  return vg_distance(a, b);
}

static void into_plane(const struct vg_fan_shape *s, double v[3])
{
  double d;

  if (!s->has_plane) return;
  d = vg_dot(v, s->plane);
  for (int k = 0; k < 3; k++)
    v[k] = fabs(s->plane[k]) == 1 ? 0 : v[k] - d * s->plane[k];
}

static double least_visibility(size_t n, const double (*normal)[3],
                               const double *v)
{
  double least = 1;

  for (size_t i = 0; i < n; i++) {
    double d = vg_dot(normal[i], v);

    if (d < least) least = d;
  }
  return least;
}

/* Initial direction of the column of `n` faces of the ring, from corner h on.
 * Returns 0 if no direction sees them all with a cosine of at least `least`. */
static int direct(struct build *b, const struct vg_fan_shape *s, uint32_t h,
                  size_t n, double least, double dir[3])
{
  size_t k = 0;
  double best[3];

  memset(dir, 0, 3 * sizeof *dir);
  for (size_t i = 0; i < n; i++, h = vg_wall_turn(b->w, h)) {
    const double *normal = b->normal[h / 3];
    double weight = corner_weight(b->w, h);

    if (!(vg_dot(normal, normal) > 0)) continue;
    memcpy(b->ring[k++], normal, sizeof *b->ring);
    for (int c = 0; c < 3; c++) dir[c] += weight * normal[c];
  }
  into_plane(s, dir);
  if (vg_unit(dir) > 0 &&
      least_visibility(k, (const double(*)[3])b->ring, dir) >= SMOOTH_WALL)
    return 1;
  for (size_t i = 0; i < k; i++) into_plane(s, b->ring[i]);
  if (!vg_most_normal((int)k, (const double(*)[3])b->ring, best)) return 0;
  into_plane(s, best);
  if (!(vg_unit(best) > 0)) return 0;
  memcpy(dir, best, sizeof best);
  return least_visibility(k, (const double(*)[3])b->ring, dir) >= least;
}

/* Splits the ring of p at its ridges of a rule into sectors: the first corner
 * of each sector and its number of faces. In a closed ring the first sector
 * starts at a ridge. Returns the number of sectors. */
static int cut(const struct build *b, uint32_t p, int rule,
               uint32_t corner[VG_FAN_SECTORS], size_t size[VG_FAN_SECTORS],
               int *is_open)
{
  const struct vg_wall *w = b->w;
  const unsigned bit = 1u << rule;
  uint32_t start = w->start[p], h;
  int n = 0;

  *is_open = w->opposite[start] == VG_NO_INDEX;
  while (!*is_open && !(b->ridge[start] & bit)) start = vg_wall_turn(w, start);
  h = start;
  do {
    if (h == start || b->ridge[h] & bit) {
      if (n == VG_FAN_SECTORS) return 0;
      corner[n] = h;
      size[n++] = 0;
    }
    size[n - 1]++;
    h = vg_wall_turn(w, h);
  } while (h != VG_NO_INDEX && h != start);
  return n;
}

/* One direction suffices if it is as close to those of all sectors as the
 * single direction at an edge just below the fan angle would be. */
static int one_direction_suffices(struct build *b, const struct rule *r,
                                  const struct vg_fan_shape *s, uint32_t start,
                                  size_t n)
{
  double dir[3];

  if (!direct(b, s, start, n, LEAST_VISIBILITY, dir)) return 0;
  for (int i = 0; i < s->n_sector; i++)
    if (vg_dot(dir, s->sector[i]) < r->cos_half) return 0;
  return 1;
}

static void set_plane(const struct build *b, uint32_t p, struct vg_fan_shape *s)
{
  s->has_plane = b->w->slide[p][0] != VG_NO_INDEX;
  for (size_t i = 0; s->has_plane && i < b->n_slide; i++)
    if (b->slide[i].patch == b->w->slide[p][0])
      vg_slide_normal(&b->slide[i], b->w->surface, b->w->point[p], s->plane);
}

static vg_status reserve(struct build *b, const struct vg_fan_shape *s,
                         struct vg_error *err)
{
  struct vg_fans *f = b->f;

  if (vg_reserve(&f->fan, &b->cap_fan, f->n_fan + 1, sizeof *f->fan) < 0 ||
      vg_reserve(&f->preset, &b->cap_preset, f->n_preset + (size_t)s->n_column,
                 sizeof *f->preset) < 0 ||
      vg_reserve(&f->chain, &b->cap_chain, f->n_chain + (size_t)s->n_sector,
                 sizeof *f->chain) < 0)
    return vg_fail_memory(err, "the fans at convex edges");
  return VG_OK;
}

/* Stores a fan: the columns of its corners, its chains and its preset
 * directions. */
static void keep(struct build *b, uint32_t p, const struct vg_fan_shape *s,
                 const uint32_t *corner, const size_t *size)
{
  struct vg_fans *f = b->f;
  uint8_t is_sector[VG_FAN_COLUMNS] = { 0 };

  f->fan[f->n_fan++] = (struct vg_fan_point){ p, (uint8_t)s->n_column,
                                              (uint8_t)s->n_polygon,
                                              (uint8_t)s->has_centre,
                                              (uint8_t)s->is_open };
  f->first[p + 1] = (uint32_t)s->n_column;
  for (int i = 0; i < s->n_sector; i++) {
    int o = (i + s->n_sector - 1) % s->n_sector;
    uint32_t h = corner[i];

    for (size_t j = 0; j < size[i]; j++, h = vg_wall_turn(b->w, h))
      f->at[h] = (uint8_t)s->at[i];
    is_sector[s->at[i]] = 1;
    if (s->is_open && i == 0) continue;
    f->chain_of[corner[i]] = (uint32_t)f->n_chain;
    f->chain[f->n_chain++] = (struct vg_fan_chain){ (uint8_t)s->at[o],
                                                    (uint8_t)s->at[i],
                                                    (uint8_t)s->n_step[o],
                                                    o == s->shared };
  }
  for (int i = 0; i < s->n_column; i++) {
    struct vg_fan_preset *preset = &f->preset[f->n_preset];

    if (is_sector[i]) continue;
    preset->point = p;
    preset->at = (uint32_t)i;
    memcpy(preset->dir, s->dir[i], sizeof preset->dir);
    f->n_preset++;
  }
}

/* Whether all directions lead away from all triangles at p. At a ridge that
 * ends in a concave corner a direction may lead into the other wall. */
static int is_clear(const struct build *b, uint32_t p,
                    const struct vg_fan_shape *s)
{
  const struct vg_wall *w = b->w;
  uint32_t h = w->start[p];

  do {
    const double *o = wall_point(w, h), *a = wall_point(w, vg_half_next(h));
    const double *c = wall_point(w, vg_half_prev(h));
    double e[3], f[3], n[3];

    vg_sub(a, o, e);
    vg_sub(c, o, f);
    vg_cross(e, f, n);
    vg_unit(n);
    for (int i = 0; i < s->n_column; i++)
      if (vg_off_corner(o, a, c, n, s->dir[i]) < LEAST_CLEAR) return 0;
    h = vg_wall_turn(w, h);
  } while (h != VG_NO_INDEX && h != w->start[p]);
  return 1;
}

/* Whether no direction sees all faces at p. */
static int is_needed(struct build *b, const struct vg_fan_shape *s,
                     uint32_t start, size_t n)
{
  double dir[3];

  return !direct(b, s, start, n, NEEDED_VISIBILITY, dir);
}

/* Make the fan of point p by a rule, if it has one. */
static vg_status visit(struct build *b, uint32_t p, int rule,
                       struct vg_error *err)
{
  const struct vg_wall *w = b->w;
  const struct rule *r = &b->rule[rule];
  struct vg_fan_shape s = { .n_sector = 0 };
  uint32_t corner[VG_FAN_SECTORS];
  size_t size[VG_FAN_SECTORS], n = 0;
  vg_status st;

  if (w->cause[p] || w->slide[p][1] != VG_NO_INDEX) return VG_OK;
  s.n_sector = cut(b, p, rule, corner, size, &s.is_open);
  if (s.n_sector < 2) return VG_OK;
  set_plane(b, p, &s);
  for (int i = 0; i < s.n_sector; i++) n += size[i];
  if (vg_reserve(&b->ring, &b->cap_ring, n, sizeof *b->ring) < 0)
    return vg_fail_memory(err, "the fans at convex edges");
  if (r->if_needed && !is_needed(b, &s, corner[0], n)) return VG_OK;
  for (int i = 0; i < s.n_sector; i++) {
    uint32_t at = corner[(i + 1) % s.n_sector];

    if (!direct(b, &s, corner[i], size[i], LEAST_VISIBILITY, s.sector[i]))
      return VG_OK;
    vg_sub(wall_point(w, vg_half_next(at)), wall_point(w, at), s.ridge[i]);
    vg_unit(s.ridge[i]);
  }
  if (one_direction_suffices(b, r, &s, corner[0], n) || !vg_fan_spread(&s) ||
      !is_clear(b, p, &s))
    return VG_OK;
  if ((st = reserve(b, &s, err)) < 0) return st;
  keep(b, p, &s, corner, size);
  return VG_OK;
}

static void add_rule(struct build *b, double angle, int if_needed, int if_sharp)
{
  b->rule[b->n_rule++] = (struct rule){ cos_degrees(angle),
                                        cos_degrees(0.5 * angle), if_needed,
                                        if_sharp };
}

static vg_status start(struct build *b, double fan_angle, struct vg_error *err)
{
  const struct vg_wall *w = b->w;
  struct vg_fans *f = b->f;

  if (fan_angle == VG_FANS_SHARP) add_rule(b, CHAIN_ANGLE, 0, 1);
  if (fan_angle > 0) add_rule(b, fan_angle, 0, 0);
  else add_rule(b, NEEDED_ANGLE, 1, 0);
  b->normal = vg_alloc(w->n_face, sizeof *b->normal);
  b->ridge = vg_calloc(3 * w->n_face, sizeof *b->ridge);
  b->at_ridge = vg_calloc(w->n_point, sizeof *b->at_ridge);
  f->at = vg_calloc(3 * w->n_face, sizeof *f->at);
  f->chain_of = vg_alloc(3 * w->n_face, sizeof *f->chain_of);
  if (!b->normal || !b->ridge || !b->at_ridge || !f->at || !f->chain_of)
    return vg_fail_memory(err, "the fans at convex edges");
  memset(f->chain_of, 0xff, 3 * w->n_face * sizeof *f->chain_of);
  return VG_OK;
}

static vg_status find_fans(struct build *b, double fan_angle,
                           struct vg_error *err)
{
  vg_status st = start(b, fan_angle, err);

  if (st < 0) return st;
  find_normals(b);
  for (int i = 0; i < b->n_rule; i++) VG_TRY(find_ridges(b, i, err));
  for (uint32_t p = 0; p < b->w->n_point; p++) {
    const size_t n = b->f->n_fan;

    for (int i = 0; i < b->n_rule && b->f->n_fan == n; i++)
      if (b->at_ridge[p] & 1u << i) VG_TRY(visit(b, p, i, err));
  }
done:
  return st;
}

vg_status vg_fans_build(const struct vg_wall *w, size_t n_slide,
                        const struct vg_slide *slide, double fan_angle,
                        struct vg_fans *out, struct vg_error *err)
{
  struct vg_fans f = VG_FANS_INIT;
  struct build b = { .w = w, .n_slide = n_slide, .slide = slide, .f = &f };
  vg_status st = VG_OK;
  size_t total = 0;

  assert(!out->first && !out->fan);
  assert(slide || !n_slide);
  if (!(fan_angle >= 0) && fan_angle != VG_FANS_SHARP)
    return vg_fail(err, VG_ERR_INPUT,
                   "the fan angle is %g degrees; it must be at least 0 (0: "
                   "fans only where a single column fails, 180: no fans)",
                   fan_angle);
  f.first = vg_alloc(w->n_point + 1, sizeof *f.first);
  if (!f.first) return vg_fail_memory(err, "the columns");
  for (size_t p = 0; p <= w->n_point; p++) f.first[p] = p > 0;
  if (fan_angle < 180) VG_TRY(find_fans(&b, fan_angle, err));
  for (size_t p = 0; p <= w->n_point; p++) {
    total += f.first[p];
    f.first[p] = (uint32_t)total;
  }
  if (total > UINT32_MAX / 8) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the layers need %zu columns, but at most %u are supported; "
                 "raise the fan angle or coarsen the surface",
                 total, UINT32_MAX / 8);
    goto done;
  }
  if (f.n_fan) VG_TRY(vg_fans_close(w, &f, err));
  *out = f;
  f = (struct vg_fans)VG_FANS_INIT;
done:
  free(b.normal);
  free(b.ridge);
  free(b.at_ridge);
  free(b.ring);
  vg_fans_release(&f);
  return st;
}
