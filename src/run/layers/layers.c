/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/layers/layers.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"
#include "layers/grow/grow.h"
#include "run/settings/plan_options.h"

#define DEFAULT_RATE 0.2 /* Common in RANS practice; growth 1.2. */

/* Growth laws that vary in space. By source: each of first height and rates is
 * interpolated by the code that computes the spacing, with the same weights,
 * with the value in place of the spacing (formats.md 1.7). By point: the first
 * height is that of a .surf or of first_from, all other values are those of the
 * patch. */
struct vg_layer_laws {
  struct vg_point_heights at; /* First heights; empty: by source. */
  size_t n;
  struct vg_source *source[3]; /* [n] h0, h1 hold delta1, rate1, rate2. */
  double constant[3];          /* The value if it is equal at all sources,
                                  otherwise NAN. */
  double shift[3];             /* Added because a spacing cannot be 0. */
  double cap;
  int n_constant;
  enum vg_growth_law_rule rule; /* Rule of a grid family, with its scale. */
  double scale;
};

static void release_laws(struct vg_layer_laws *l)
{
  if (!l) return;
  for (int k = 0; k < 3; k++) free(l->source[k]);
  free(l->at.item);
  free(l);
}

void vg_layer_stage_release(struct vg_layer_stage *s)
{
  free(s->reason);
  free(s->request);
  free(s->limit);
  release_laws(s->laws);
  vg_layers_release(&s->layers);
  vg_wall_fields_release(&s->fields);
  free(s->wall);
  free(s->y_plus);
  free(s->missed);
  free(s->top);
  memset(s, 0, sizeof *s);
}

static void law_at(void *user, const double x[3], struct vg_growth_law *law)
{
  const struct vg_layer_laws *l = user;
  const struct vg_sizing_options o = {
    .h_max = INFINITY, .growth = 1.2, .scale = 1, .threads = 1, .coarseness = 1
  };
  double v[3];

  for (int k = 0; k < 3; k++)
    v[k] = isnan(l->constant[k])
           ? vg_sizing_sources_at(&o, l->n, l->source[k], x) - l->shift[k]
           : l->constant[k];
  law->delta1 = v[0];
  law->rate1 = v[1] > 0 ? v[1] : 0;
  law->rate2 = v[2] > 0 ? v[2] : 0;
  law->cap = l->cap;
  law->n_constant = l->n_constant;
  vg_growth_law_scale(law, l->rule, l->scale, &(int){ 0 });
}

static void height_at(void *user, const double x[3], struct vg_growth_law *law)
{
  const struct vg_layer_laws *l = user;
  const struct vg_point_height *h = vg_point_height(&l->at, x);

  if (h && h->first > 0) law->delta1 = h->first * l->scale;
}

static int has_law(const struct vg_source *s)
{
  return s->kind <= VG_SOURCE_VGRID_LINE && s->layer0[0] > 0;
}

/* Replaces the spacings of the sources by their values k. */
static void put_values(struct vg_layer_laws *l, int k)
{
  struct vg_source *s = l->source[k];
  double least = INFINITY, most = -INFINITY;

  for (size_t i = 0; i < l->n; i++) {
    const double *end = s[i].kind == VG_SOURCE_VGRID_LINE && s[i].layer1[0] > 0
                        ? s[i].layer1
                        : s[i].layer0;

    s[i].h0 = s[i].layer0[k];
    s[i].h1 = end[k];
    s[i].stretch = 0;
    least = fmin(least, fmin(s[i].h0, s[i].h1));
    most = fmax(most, fmax(s[i].h0, s[i].h1));
  }
  l->constant[k] = least == most ? least : NAN;
  l->shift[k] = least > 0 ? 0 : 1 - least;
  for (size_t i = 0; i < l->n; i++) {
    s[i].h0 += l->shift[k];
    s[i].h1 += l->shift[k];
  }
}

static void set_scale(const struct vg_settings *s, struct vg_layer_laws *l)
{
  l->rule = (enum vg_growth_law_rule)s->layer.scale_rule;
  l->scale = l->rule == VG_GROWTH_LAW_KEPT ? 1 : s->scale;
}

static vg_status make_laws(const struct vg_settings *s, double cap,
                           struct vg_layer_laws **out, struct vg_error *err)
{
  struct vg_layer_laws *l = vg_calloc(1, sizeof *l);
  vg_status st = VG_OK;

  if (!l) return vg_fail_memory(err, "the laws of the layers");
  for (int k = 0; k < 3 && st >= 0; k++) {
    l->source[k] = vg_alloc(s->n_source, sizeof **l->source);
    if (!l->source[k]) st = vg_fail_memory(err, "the laws of the layers");
    l->n = 0;
    for (size_t i = 0; i < s->n_source && st >= 0; i++)
      if (has_law(&s->source[i])) l->source[k][l->n++] = s->source[i];
    if (st >= 0 && l->n) put_values(l, k);
  }
  if (st >= 0 && !l->n)
    st = vg_fail(err, VG_ERR_INPUT,
                 "layer_sources: no VGRID source has a first height "
                 "(delta1_0); give a first height (setting first), and set "
                 "layer_sources to no");
  l->cap = cap;
  l->n_constant = (int)s->layer.constant;
  set_scale(s, l);
  if (st < 0) release_laws(l);
  else *out = l;
  return st;
}

static double choose(double own, double global)
{
  return isnan(own) ? global : own;
}

double vg_layer_cap(double cap)
{
  if (isnan(cap)) return VG_LAYER_CAP;
  return cap > 0 ? cap : INFINITY;
}

/* 0 if it is not known. */
static double first_height(const struct vg_layer_settings *l,
                           const struct vg_layer_row *r)
{
  double own = vg_settings_first(l, r->first, r->y_plus);

  return own > 0 ? own : vg_settings_first(l, l->first, l->y_plus);
}

/* Rate from number of layers and total height, limited by the cap. */
static vg_status rate_for_total(const struct vg_layer_request *q, int32_t id,
                                double *rate, struct vg_error *err)
{
  double r;

  r = vg_growth_law_rate_for_total(q->law.delta1, q->law.n_constant, q->n_max,
                                   q->total);
  if (r < 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "layers of patch %d: %d layers of thickness %g are already "
                   "higher than the total height %g; reduce the number of "
                   "layers or the first height",
                   (int)id, q->n_max, q->law.delta1, q->total);
  if (1 + r > q->law.cap)
    return vg_fail(err, VG_ERR_INPUT,
                   "layers of patch %d: %d layers from first height %g to "
                   "total height %g need a growth of %.4f, above layer_cap "
                   "%g; request more layers or increase the cap",
                   (int)id, q->n_max, q->law.delta1, q->total, 1 + r,
                   q->law.cap);
  *rate = r;
  return VG_OK;
}

/* The rate of a patch belongs to one first height. */
static vg_status no_rate(int32_t id, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "layers of patch %d: the growth ratio follows from number and "
                 "total height of the layers, but first_from gives each point "
                 "another first height; set ratio, and layer_count or "
                 "layer_total",
                 (int)id);
}

/* Sets the rates, scaled for the member of a grid family. */
static vg_status set_rates(const struct vg_settings *s,
                           const struct vg_layer_row *r,
                           struct vg_layer_request *q, struct vg_error *err)
{
  const struct vg_layer_settings *l = &s->layer;
  double ratio = choose(r->ratio, l->ratio);
  enum vg_growth_law_rule rule = (enum vg_growth_law_rule)l->scale_rule;

  q->law.rate1 = DEFAULT_RATE;
  q->law.rate2 = 0;
  if (!isnan(r->rate1) || !isnan(r->rate2) ||
      (isnan(r->ratio) && (!isnan(l->rate1) || !isnan(l->rate2)))) {
    q->law.rate1 = choose(choose(r->rate1, l->rate1),
                          isnan(ratio) ? DEFAULT_RATE : ratio - 1);
    q->law.rate2 = choose(choose(r->rate2, l->rate2), 0);
  } else if (!isnan(ratio)) {
    q->law.rate1 = ratio - 1;
  } else if (q->n_exact && q->total > 0) {
    if (*l->first_from && isnan(r->first)) return no_rate(r->id, err);
    vg_growth_law_scale(&q->law, rule, s->scale, &q->n_max);
    return rate_for_total(q, r->id, &q->law.rate1, err);
  }
  vg_growth_law_scale(&q->law, rule, s->scale, &q->n_max);
  return VG_OK;
}

static vg_status make_request(const struct vg_settings *s,
                              const struct vg_layer_row *r,
                              struct vg_layer_request *q, struct vg_error *err)
{
  const struct vg_layer_settings *l = &s->layer;
  int64_t count = r->count == VG_COUNT_NONE ? l->count : r->count;

  q->is_wall = 1;
  q->law.delta1 = first_height(l, r);
  q->law.cap = vg_layer_cap(choose(r->cap, l->cap));
  q->law.n_constant = (int)(r->constant == VG_COUNT_NONE ? l->constant
                                                         : r->constant);
  q->n_exact = count > 0;
  q->n_max = (int)(count > 0 ? count : l->most);
  if (l->most > 0 && q->n_max > l->most) q->n_max = (int)l->most;
  q->total = choose(r->total, l->total);
  if (!l->by_source && q->total > 0 && q->law.delta1 > q->total)
    return vg_fail(
      err, VG_ERR_INPUT,
      "layers: on patch %d the first height, %g, exceeds the total "
      "height, %g: there is no room for a layer; reduce the first "
      "height or increase the total",
      (int)r->id, q->law.delta1, q->total);
  return set_rates(s, r, q, err);
}

static vg_status no_first(const struct vg_mesh *m, size_t i,
                          struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "layers on patch %d %s: the first height is not known; give "
                 "--first, or --y-plus with --reynolds and --reference-length "
                 "(or turn layers off with --layers no)",
                 (int)m->patch[i].id, m->patch[i].name);
}

/* A patch cannot have its own law if the sources define the law. */
static vg_status check_row(const struct vg_layer_row *r, int by_source,
                           struct vg_error *err)
{
  if (!by_source || (isnan(r->first) && isnan(r->y_plus) && isnan(r->ratio) &&
                     isnan(r->rate1) && isnan(r->rate2) && isnan(r->cap) &&
                     r->constant == VG_COUNT_NONE))
    return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "layers: patch %d has a growth law of its own, but "
                 "layer_sources takes the law from the sources; set "
                 "layer_sources to no or remove the values of the patch",
                 (int)r->id);
}

/* First heights at points. */
struct by_point {
  double *least;              /* [n_patch] least height; 0 for a patch that uses
                                 none. */
  struct vg_point_heights at; /* Heights; 0 at points of patches with a height
                                 of their own. */
};

/* Moves the heights into the laws. */
static vg_status use_heights(struct vg_layer_stage *s,
                             const struct vg_boundary *b, struct by_point *h,
                             struct vg_error *err)
{
  struct vg_layer_laws laws;
  int used = 0;

  set_scale(&b->read->settings, &laws);
  for (size_t i = 0; i < s->n_patch; i++)
    if (h->least[i] > 0 && s->reason[i] != VG_WALL_NOT) {
      s->request[i].law.delta1 = h->least[i] * laws.scale;
      used = 1;
    }
  if (!used) return VG_OK;
  s->laws = vg_calloc(1, sizeof *s->laws);
  if (!s->laws) return vg_fail_memory(err, "the laws of the layers");
  s->laws->at = h->at;
  h->at = (struct vg_point_heights){ 0, NULL };
  set_scale(&b->read->settings, s->laws);
  return VG_OK;
}

static struct vg_layer_limits limits_of(const struct vg_layer_limits *own,
                                        const struct vg_layer_limits *global)
{
  return (struct vg_layer_limits){
    .min_full = choose(own->min_full, global->min_full),
    .min_any = choose(own->min_any, global->min_any),
    .min_height = choose(own->min_height, global->min_height),
    .max_first_error = choose(own->max_first_error, global->max_first_error),
    .max_top_ratio = choose(own->max_top_ratio, global->max_top_ratio)
  };
}

static vg_status make_requests(struct vg_layer_stage *s,
                               const struct vg_boundary *b, struct by_point *h,
                               struct vg_error *err)
{
  const struct vg_settings *set = &b->read->settings;
  const struct vg_layer_settings *l = &set->layer;
  const struct vg_mesh *m = &b->surface;
  vg_status st = VG_OK;

  if (l->by_source) VG_TRY(make_laws(set, vg_layer_cap(l->cap), &s->laws, err));
  for (size_t i = 0; i < m->n_patch; i++) {
    struct vg_layer_row own = vg_settings_layer_row(set, m->patch[i].id);
    struct vg_layer_row row = vg_wall_layer_row(set, m, i);
    struct vg_layer_request *q = &s->request[i];

    s->limit[i] = limits_of(&row.limit, &l->limit);
    if (s->reason[i] == VG_WALL_NOT && vg_has_limits(&own.limit))
      st = vg_fail(err, VG_ERR_INPUT,
                   "layers: patch %d has a limit on layers, but it is not a "
                   "wall; set grow to yes or remove the limit",
                   (int)row.id);
    if (st < 0) break;
    if (s->reason[i] == VG_WALL_NOT) continue;
    VG_TRY(check_row(&row, l->by_source, err));
    VG_TRY(make_request(set, &row, q, err));
    if (l->by_source) {
      q->law.delta1 = s->laws->source[0][0].h0 * s->laws->scale;
      q->law.rate1 = s->laws->source[1][0].h0 - s->laws->shift[1];
      q->law.rate2 = s->laws->source[2][0].h0 - s->laws->shift[2];
    }
    if (!(q->law.delta1 > 0) && !(h->least[i] > 0)) st = no_first(m, i, err);
    if (st < 0) break;
  }
  if (st >= 0) st = use_heights(s, b, h, err);
done:
  return st;
}

/* Heights by point apply to patches whose settings give none. */
static int uses_points(const struct vg_layer_settings *l,
                       const struct vg_layer_row *r)
{
  return !l->by_source && l->first == 0 && l->y_plus == 0 && isnan(r->first) &&
         isnan(r->y_plus);
}

/* Drops the heights at points of patches that have their own. The least height
 * of each other patch applies to its points without a height. */
static vg_status sort_heights(const struct vg_boundary *b, struct by_point *h,
                              struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  const struct vg_point_heights *from = &b->read->heights;
  const struct vg_mesh *m = &b->surface;
  uint8_t *uses;

  if (!from->n) return VG_OK;
  h->at.item = vg_alloc(from->n, sizeof *h->at.item);
  uses = vg_calloc(m->n_patch, 1);
  if (!uses || !h->at.item) {
    free(uses);
    return vg_fail_memory(err, "the heights of layers");
  }
  h->at.n = from->n;
  memcpy(h->at.item, from->item, from->n * sizeof *from->item);
  for (size_t i = 0; i < m->n_patch; i++) {
    struct vg_layer_row row = vg_wall_layer_row(s, m, i);

    uses[i] = (uint8_t)uses_points(&s->layer, &row);
  }
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < m->n_tri; i++) {
      const uint32_t of = m->tri_patch[i];

      for (int k = 0; k < 3 && uses[of] == pass; k++) {
        struct vg_point_height *at = vg_point_height(&h->at,
                                                     m->point[m->tri[i][k]]);

        if (at && !pass) at->first = 0;
        else if (at && at->first > 0 &&
                 (h->least[of] == 0 || at->first < h->least[of]))
          h->least[of] = at->first;
      }
    }
  free(uses);
  return VG_OK;
}

/* 1 if every wall has a first height. */
static int first_is_known(const struct vg_layer_stage *s,
                          const struct vg_boundary *b, const double *least)
{
  const struct vg_layer_settings *l = &b->read->settings.layer;

  for (size_t i = 0; i < s->n_patch && !l->by_source; i++) {
    struct vg_layer_row row = vg_wall_layer_row(&b->read->settings, &b->surface,
                                                i);

    if (s->reason[i] != VG_WALL_NOT && !(first_height(l, &row) > 0) &&
        !(least[i] > 0))
      return 0;
  }
  return 1;
}

/* A wall with layers and without a condition gets a viscous one; otherwise it
 * would be written as inviscid. */
static void give_conditions(const struct vg_layer_stage *s,
                            struct vg_boundary *b)
{
  size_t n = 0;

  for (size_t i = 0; i < s->n_patch; i++) {
    struct vg_patch *patch = &b->surface.patch[i];

    if (s->reason[i] == VG_WALL_NOT || s->reason[i] == VG_WALL_EXTENDED ||
        patch->is_sheet || patch->bc != VG_BC_NONE ||
        patch->bc_fun3d != VG_BC_NONE)
      continue;
    patch->bc = patch->family = 4;
    patch->bc_fun3d = 4000;
    n++;
  }
  if (n)
    vg_note(b->notes,
            "%zu patch%s with layers but without a boundary condition %s "
            "written as viscous (4, FUN3D 4000)",
            n, n > 1 ? "es" : "", n > 1 ? "are" : "is");
}

/* Layers of walls that end in the plane of another patch continue over that
 * patch, on which no limits apply. */
static vg_status extend_walls(struct vg_layer_stage *s, struct vg_boundary *b,
                              struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  uint32_t *from = vg_alloc(s->n_patch, sizeof *from);
  vg_status st = from ? vg_walls_extend(b, s->reason, from, err)
                      : vg_fail_memory(err, "the patches");

  for (size_t i = 0; st >= 0 && i < s->n_patch; i++) {
    if (from[i] == VG_NO_INDEX) continue;
    s->request[i] = s->request[from[i]];
    s->limit[i] = VG_NO_LIMITS;
    vg_note(b->notes,
            "the layers of patch %d %s continue over patch %d %s, because both "
            "lie in one plane (grow no for patch %d in the table layers ends "
            "them at its edge)",
            (int)m->patch[from[i]].id, m->patch[from[i]].name,
            (int)m->patch[i].id, m->patch[i].name, (int)m->patch[i].id);
  }
  free(from);
  return st;
}

static void set_options(struct vg_layer_stage *s, const struct vg_boundary *b)
{
  const struct vg_read *read = b->read;
  const struct vg_settings *set = &read->settings;
  struct vg_layer_options *o = &s->options;

  *o = vg_options_layers(set);
  o->is_slab = read->is_section;
  o->patch = s->request;
  o->n_periodic = b->pairs.n;
  o->periodic = b->pairs.pair;
  o->law_at = !s->laws ? NULL : s->laws->at.n ? height_at : law_at;
  o->law_user = s->laws;
  s->reynolds = set->layer.reynolds;
  s->length = set->layer.length;
}

static vg_status allocate(struct vg_layer_stage *s, size_t n,
                          struct vg_error *err)
{
  s->n_patch = n;
  s->reason = vg_calloc(n, sizeof *s->reason);
  s->request = vg_calloc(n, sizeof *s->request);
  s->limit = vg_calloc(n, sizeof *s->limit);
  return s->reason && s->request && s->limit
         ? VG_OK
         : vg_fail_memory(err, "the patches");
}

/* A limit on layers cannot be met without layers. */
static vg_status refuse_limits(const struct vg_settings *s,
                               struct vg_error *err)
{
  int found = vg_has_limits(&s->layer.limit);

  for (size_t i = 0; i < s->n_layer; i++)
    found |= vg_has_limits(&s->layer_row[i].limit);
  if (!found) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "layers is no, but a limit on layers is set (min_full, "
                 "min_any, min_height, max_first_error or max_top_ratio); "
                 "remove the limit or turn layers on");
}

/* Corrects the first heights by the solution of first_from. */
static vg_status use_shear(struct vg_layer_stage *s, struct vg_boundary *b,
                           struct vg_error *err)
{
  if (!b->read->shear) return VG_OK;
  if (s->laws)
    return vg_fail(err, VG_ERR_INPUT,
                   "first_from corrects the heights of y_plus, but %s has "
                   "first heights at its points; set file_layers to no or "
                   "remove first_from",
                   b->read->files.surface);
  s->laws = vg_calloc(1, sizeof *s->laws);
  if (!s->laws) return vg_fail_memory(err, "the laws of the layers");
  s->laws->scale = 1; /* The requests have it. */
  s->has_shear = 1;
  return vg_first_from(s, b, &s->laws->at, err);
}

/* Plans the layers of the walls found. */
static vg_status plan_walls(struct vg_layer_stage *s, struct vg_boundary *b,
                            struct by_point *h, struct vg_error *err)
{
  const struct vg_settings *set = &b->read->settings;
  size_t n_wall;
  vg_status st;

  VG_TRY(sort_heights(b, h, err));
  VG_TRY(vg_walls_find(b, s->reason, &n_wall, err));
  if (n_wall && !vg_walls_asked(set) && !first_is_known(s, b, h->least)) {
    vg_note_missing_first(s, b);
    n_wall = 0;
  }
  if (!n_wall) return VG_OK;
  VG_TRY(make_requests(s, b, h, err));
  VG_TRY(extend_walls(s, b, err));
  VG_TRY(use_shear(s, b, err));
  vg_note_layers(s, b);
  give_conditions(s, b);
  set_options(s, b);
  if (!s->laws || s->has_shear) vg_note_first_heights(s, b);
  s->is_on = 1;
done:
  return st;
}

vg_status vg_layer_stage_plan(struct vg_layer_stage *s, struct vg_boundary *b,
                              struct vg_error *err)
{
  struct by_point h = { vg_calloc(b->surface.n_patch, sizeof *h.least),
                        { 0, NULL } };
  vg_status st = h.least ? VG_OK : vg_fail_memory(err, "the patches");

  assert(!s->is_on && !s->reason && !s->request && !s->limit);
  if (st >= 0) st = allocate(s, b->surface.n_patch, err);
  if (st >= 0)
    st = b->read->settings.layer.grow == VG_ANSWER_NO
         ? refuse_limits(&b->read->settings, err)
         : plan_walls(s, b, &h, err);
  free(h.least);
  free(h.at.item);
  return st;
}

/* Whether layers grow, for each patch of the input and each back of an inner
 * surface. */
static vg_status list_grows(const struct vg_layer_stage *s,
                            const struct vg_boundary *b,
                            struct vg_patch_grows **out, size_t *n,
                            struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  struct vg_patch_grows *list = vg_alloc(b->n_row + m->n_patch, sizeof *list);

  if (!list) return vg_fail_memory(err, "the patches");
  *n = 0;
  for (size_t i = 0; s->is_on && i < b->n_row + m->n_patch; i++) {
    const size_t at = i < b->n_row ? vg_mesh_find_patch(m, b->row[i].id)
                                   : i - b->n_row;
    size_t like;

    if (at == SIZE_MAX) continue;
    if (i >= b->n_row && m->patch[at].inner != VG_INNER_BACK) continue;
    like = vg_mesh_front_patch(m, at);
    list[(*n)++] = (struct vg_patch_grows){ m->patch[at].id, m->patch[like].id,
                                            s->reason[at] != VG_WALL_NOT,
                                            s->reason[at] == VG_WALL_EXTENDED };
  }
  *out = list;
  return VG_OK;
}

vg_status vg_problem_settle(struct vg_problem *p,
                            const struct vg_layer_stage *s,
                            struct vg_error *err)
{
  struct vg_boundary *b = &p->boundary;
  struct vg_patch_grows *grows = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_walls_swap(b, s->is_on ? s->reason : NULL, err));
  VG_TRY(list_grows(s, b, &grows, &n, err));
  st = vg_resolve(&p->read.settings,
                  &(struct vg_decisions){ .is_remeshed = b->is_remeshed,
                                          .is_swapped = b->is_swapped,
                                          .flow = (int)b->flow.kind,
                                          .axis = b->flow.axis,
                                          .n_patch = b->n_row,
                                          .patch = b->row,
                                          .has_layers = s->is_on,
                                          .n_grows = n,
                                          .grows = grows },
                  &p->resolved, err);
done:
  free(grows);
  return st;
}

/* Marks patches without layers that share an edge with a wall. */
static void mark_adjacent(const struct vg_layer_stage *s,
                          const struct vg_mesh *m, uint8_t *on_wall,
                          uint8_t *adjacent)
{
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3 && s->reason[m->tri_patch[i]] != VG_WALL_NOT; k++)
      on_wall[m->tri[i][k]] = 1;
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];

    if (s->reason[m->tri_patch[i]] == VG_WALL_NOT &&
        on_wall[t[0]] + on_wall[t[1]] + on_wall[t[2]] > 1)
      adjacent[m->tri_patch[i]] = 1;
  }
}

vg_status vg_layer_stage_sizes(const struct vg_layer_stage *s,
                               const struct vg_boundary *b, struct vg_mesh *out,
                               struct vg_error *err)
{
  const struct vg_mesh *m = &b->surface;
  int is_front = *b->read->files.front && b->read->project.grid > 0;
  uint8_t *on_wall = vg_calloc(m->n_point, 1);
  uint8_t *adjacent = vg_calloc(m->n_patch, 1);
  vg_status st = VG_OK;

  *out = *m;
  out->n_tri = 0;
  out->tri = vg_alloc(m->n_tri, sizeof *out->tri);
  out->tri_patch = vg_alloc(m->n_tri, sizeof *out->tri_patch);
  if (!on_wall || !adjacent || !out->tri || !out->tri_patch) {
    st = vg_fail_memory(err, "the sizes");
    goto done;
  }
  if (is_front) mark_adjacent(s, m, on_wall, adjacent);
  for (size_t i = 0; i < m->n_tri; i++) {
    if (adjacent[m->tri_patch[i]]) continue;
    memcpy(out->tri[out->n_tri], m->tri[i], sizeof *out->tri);
    out->tri_patch[out->n_tri++] = m->tri_patch[i];
  }
done:
  free(on_wall);
  free(adjacent);
  return st;
}

static vg_status judge(struct vg_layer_stage *s, const struct vg_mesh *surface,
                       struct vg_error *err)
{
  const struct vg_layer_judgement *j = &s->judgement;
  vg_status st = vg_layers_judge(surface, &s->layers.columns,
                                 s->options.threads, s->options.team,
                                 &s->judgement, err);

  if (st < 0 || !(j->n_negative + j->n_off_plane)) return st;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the layers failed their final check (%zu cells with "
                 "negative volume, %zu columns that leave their plane), and "
                 "nothing was written; please report this with the project "
                 "files, and try --layers no",
                 j->n_negative, j->n_off_plane);
}

static vg_status measure(struct vg_layer_stage *s,
                         const struct vg_mesh *surface, struct vg_error *err)
{
  double t = vg_display_now();
  vg_status st;

  VG_TRY(judge(s, surface, err));
  VG_TRY(vg_layers_fields(surface, &s->layers.columns, s->options.n_periodic,
                          s->options.periodic, s->options.threads, &s->fields,
                          err));
  VG_TRY(vg_layers_patches(surface, &s->layers.columns, &s->fields, s->reynolds,
                           s->length, &s->n_wall, &s->wall, &s->all, err));
  if (s->has_shear) VG_TRY(vg_first_measure(s, surface, &s->laws->at, err));
  s->time_measure += vg_display_now() - t;
done:
  return st;
}

vg_status vg_layer_stage_grow(struct vg_layer_stage *s,
                              const struct vg_mesh *surface,
                              const struct vg_sizing *sizing,
                              struct vg_display *show, struct vg_error *err)
{
  vg_status st;

  assert(s->is_on);
  s->options.progress = (struct vg_progress){ vg_display_update, show };
  s->options.stop = (struct vg_stop){ vg_display_stop, show };
  st = vg_layers_grow(surface, sizing, &s->options, &s->layers, &s->report,
                      err);
  if (st == VG_ERR_STOPPED) st = vg_display_stopped(show, err);
  VG_TRY(st);
  vg_display_update(show, "layer measurement", s->report.n_cell, 0);
  st = measure(s, surface, err);
done:
  return st;
}

vg_status vg_layer_stage_relaxed(struct vg_layer_stage *s,
                                 const struct vg_mesh *surface,
                                 struct vg_error *err)
{
  const struct vg_columns *c = &s->layers.columns;

  vg_wall_fields_release(&s->fields);
  free(s->wall);
  s->wall = NULL;
  memset(s->report.compressed, 0, sizeof s->report.compressed);
  for (size_t i = 0; i < c->n_column; i++)
    s->report.compressed[c->column[i].compressed]++;
  return measure(s, surface, err);
}
