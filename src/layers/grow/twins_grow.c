/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Directions and heights of columns in periodic patches, which their twins
 * share. Declared in layers/grow/grow_parts.h. */
#include <math.h>
#include <string.h>

#include "layers/grow/direct.h"

/* A column and its twin by a pair. */
struct both {
  const struct vg_periodic *pair;
  uint32_t i, k;
};

/* Calls `visit` for all columns with twins, except those on the axis of a
 * rotation. Returns the number of calls that returned 1. */
static size_t each(struct vg_layer_work *w,
                   int (*visit)(struct vg_layer_work *, const struct both *,
                                void *),
                   void *context)
{
  size_t n = 0;

  for (size_t p = 0; p < w->twins.n; p++)
    for (uint32_t i = 0; i < w->c->n_column; i++) {
      const struct both b = { &w->twins.pair[p], i, w->twins.column[p][i] };

      if (b.k == VG_NO_INDEX || b.k == i) continue;
      n += (size_t)visit(w, &b, context);
    }
  return n;
}

/* --- directions ----------------------------------------------------------- */

/* Directions that both columns may take, the best first, and the visibility
 * that each of them must keep. */
struct choice {
  double (*scratch)[3]; /* [max_valence] */
  const uint8_t *turned;
  double (*from)[3]; /* [n_column] directions that are kept otherwise. */
  double kept;       /* Share of the visibility that is kept; 0: the visibility
                        is computed. */
};

/* Visibility of direction v at column i. */
static double visibility(const struct vg_layer_work *w, uint32_t i,
                         const double v[3], double (*scratch)[3])
{
  const int n = vg_face_normals(w, i, scratch);

  return vg_least_visibility(n, scratch, v) / vg_norm(v);
}

/* Gives both columns the direction v and its image if they see their faces. */
static int take(struct vg_layer_work *w, const struct both *b,
                const double v[3], const struct choice *c)
{
  const uint32_t at[2] = { b->i, b->k };
  double dir[2][3], seen[2];

  memcpy(dir[0], v, sizeof dir[0]);
  vg_periodic_vector(b->pair, 0, v, dir[1]);
  if (!(vg_norm(v) > 0)) return 0;
  for (int s = 0; s < 2; s++) {
    const double least = c->kept > 0 ? c->kept * w->visibility[at[s]]
                                     : VG_VISIBILITY_MIN;

    seen[s] = visibility(w, at[s], dir[s], c->scratch);
    if (!(seen[s] >= least)) return 0;
  }
  for (int s = 0; s < 2; s++) {
    memcpy(w->c->column[at[s]].dir, dir[s], sizeof dir[s]);
    if (!(c->kept > 0)) w->visibility[at[s]] = seen[s];
  }
  return 1;
}

/* The mean of both directions, or one of them. */
static int agree(struct vg_layer_work *w, const struct both *b, void *context)
{
  const struct choice *c = context;
  double v[3][3], length;

  if (c->turned && !c->turned[b->i] && !c->turned[b->k]) return 0;
  memcpy(v[1], w->c->column[b->i].dir, sizeof v[1]);
  vg_periodic_vector(b->pair, 1, w->c->column[b->k].dir, v[2]);
  length = fmax(vg_norm(v[1]), vg_norm(v[2]));
  for (int k = 0; k < 3; k++) v[0][k] = v[1][k] + v[2][k];
  vg_unit(v[0]);
  for (int k = 0; k < 3; k++) v[0][k] *= length;
  for (int k = 0; k < 3; k++)
    if (take(w, b, v[k], c)) return 1;
  if (c->from) {
    memcpy(w->c->column[b->i].dir, c->from[b->i], sizeof v[0]);
    vg_periodic_vector(b->pair, 0, c->from[b->i], w->c->column[b->k].dir);
  } else {
    w->visibility[b->i] = w->visibility[b->k] = 0;
    vg_periodic_vector(b->pair, 0, v[1], w->c->column[b->k].dir);
  }
  return 1;
}

/* The directions on which both agree are those before smoothing. */
static int keep_root(struct vg_layer_work *w, const struct both *b,
                     void *unused)
{
  (void)unused;
  memcpy(w->root_dir[b->i], w->c->column[b->i].dir, sizeof *w->root_dir);
  memcpy(w->root_dir[b->k], w->c->column[b->k].dir, sizeof *w->root_dir);
  return 1;
}

void vg_twins_first(struct vg_layer_work *w, double (*scratch)[3])
{
  struct choice c = { scratch, NULL, NULL, 0 };

  each(w, agree, &c);
  each(w, keep_root, NULL);
}

void vg_twins_agree(struct vg_layer_work *w, const uint8_t *turned,
                    double (*from)[3], double kept, double (*scratch)[3])
{
  struct choice c = { scratch, turned, from, kept };

  each(w, agree, &c);
}

static int mark_turned(struct vg_layer_work *w, const struct both *b,
                       void *context)
{
  uint8_t *turned = context;

  (void)w;
  if (turned[b->i] == turned[b->k]) return 0;
  turned[b->i] = turned[b->k] = 1;
  return 1;
}

void vg_twins_turned(struct vg_layer_work *w, uint8_t *turned)
{
  while (each(w, mark_turned, turned)) continue;
}

/* Distance of the first point from the root, relative to its height. */
static double first_reach(const struct vg_layer_work *w, uint32_t i)
{
  const struct vg_column *c = &w->c->column[i];
  double v[3];

  for (int k = 0; k < 3; k++)
    v[k] = c->dir[k] + c->shift[k] / w->c->law[c->law].delta1;
  return vg_norm(v);
}

/* Both columns take length and shift of that whose first point is farther. */
static int take_farther(struct vg_layer_work *w, const struct both *b,
                        void *unused)
{
  struct vg_column *i = &w->c->column[b->i], *k = &w->c->column[b->k];

  (void)unused;
  if (first_reach(w, b->k) > first_reach(w, b->i)) {
    vg_periodic_vector(b->pair, 1, k->dir, i->dir);
    vg_periodic_vector(b->pair, 1, k->shift, i->shift);
  }
  vg_periodic_vector(b->pair, 0, i->dir, k->dir);
  vg_periodic_vector(b->pair, 0, i->shift, k->shift);
  return 1;
}

void vg_twins_farther(struct vg_layer_work *w)
{
  each(w, take_farther, NULL);
}

/* --- heights -------------------------------------------------------------- */

static int share_law(struct vg_layer_work *w, const struct both *b,
                     void *unused)
{
  struct vg_column *i = &w->c->column[b->i], *k = &w->c->column[b->k];
  struct vg_growth_law *law = w->c->law;
  const int differs = k->law != i->law;

  (void)unused;
  if (w->o->law_at) law[k->law] = law[i->law];
  else k->law = i->law;
  k->cap = i->cap;
  return differs && !w->o->law_at;
}

void vg_twins_laws(struct vg_layer_work *w)
{
  each(w, share_law, NULL);
}

static int lower_wanted(struct vg_layer_work *w, const struct both *b,
                        void *unused)
{
  struct vg_column *i = &w->c->column[b->i], *k = &w->c->column[b->k];
  const uint32_t from = i->n_wanted < k->n_wanted ? b->i : b->k;

  (void)unused;
  if (i->n_wanted == k->n_wanted && w->by_size[b->i] == w->by_size[b->k])
    return 0;
  i->n_wanted = k->n_wanted = w->c->column[from].n_wanted;
  w->by_size[b->i] = w->by_size[b->k] = w->by_size[from];
  return 1;
}

size_t vg_twins_wanted(struct vg_layer_work *w)
{
  return each(w, lower_wanted, NULL);
}

static int share_edge(struct vg_layer_work *w, const struct both *b,
                      void *unused)
{
  const double least = fmin(w->edge[b->i], w->edge[b->k]);

  (void)unused;
  w->edge[b->i] = w->edge[b->k] = least;
  return 1;
}

void vg_twins_edges(struct vg_layer_work *w)
{
  each(w, share_edge, NULL);
}

static int lower_allowed(struct vg_layer_work *w, const struct both *b,
                         void *unused)
{
  const uint32_t from = w->allowed[b->i] < w->allowed[b->k] ? b->i : b->k;
  const uint32_t to = from == b->i ? b->k : b->i;

  (void)unused;
  if (!(w->allowed[from] < w->allowed[to])) return 0;
  w->allowed[to] = w->allowed[from];
  w->why[to] = w->why[from];
  return 1;
}

size_t vg_twins_allowed(struct vg_layer_work *w)
{
  return each(w, lower_allowed, NULL);
}

static int lower_levels(struct vg_layer_work *w, const struct both *b,
                        void *unused)
{
  struct vg_column *i = &w->c->column[b->i], *k = &w->c->column[b->k];
  const int is_i = i->n < k->n || (i->n == k->n && i->cap < k->cap);
  const struct vg_column *from = is_i ? i : k;
  struct vg_column *to = is_i ? k : i;

  (void)unused;
  if (i->n == k->n && !(i->cap < k->cap) && !(k->cap < i->cap)) return 0;
  to->n = from->n;
  to->n_fit = from->n_fit;
  to->cap = from->cap;
  to->cause = from->cause;
  to->compressed = from->compressed;
  return 1;
}

size_t vg_twins_levels(struct vg_layer_work *w)
{
  return each(w, lower_levels, NULL);
}
