/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shells: their volumes, nesting and sides. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"

/* --- volume --------------------------------------------------------------- */

/* Sum with compensation of rounding (Neumaier), and the sum of magnitudes. */
struct total {
  double sum, low, size;
};

static void total_add(struct total *t, double x)
{
  double s = t->sum + x;

  t->low += fabs(t->sum) >= fabs(x) ? (t->sum - s) + x : (x - s) + t->sum;
  t->sum = s;
}

static void add_volume(struct total *t, const double o[3], const double *a,
                       const double *b, const double *c)
{
  double u[3], v[3], w[3];

  for (int k = 0; k < 3; k++) {
    u[k] = a[k] - o[k];
    v[k] = b[k] - o[k];
    w[k] = c[k] - o[k];
  }
  for (int k = 0; k < 3; k++) {
    double l = v[(k + 1) % 3] * w[(k + 2) % 3];
    double r = v[(k + 2) % 3] * w[(k + 1) % 3];

    total_add(t, u[k] * (l - r));
    t->size += fabs(u[k]) * (fabs(l) + fabs(r));
  }
}

static void grow_box(struct vg_shell *s, const double p[3])
{
  for (int k = 0; k < 3; k++) {
    if (p[k] < s->lo[k]) s->lo[k] = p[k];
    if (p[k] > s->hi[k]) s->hi[k] = p[k];
  }
}

static void measure_extent(struct vg_shell *shell, uint8_t *state,
                           const struct vg_faces *s, const struct vg_edges *e,
                           const uint32_t *of_face, const uint8_t *flip)
{
  for (size_t f = 0; f < s->n; f++) {
    struct vg_shell *x;

    if (of_face[f] == UINT32_MAX) continue;
    x = &shell[of_face[f]];
    if (!x->n_tri++) {
      x->face = vg_faces_source(s, f);
      x->is_closed = 1;
      memcpy(x->lo, s->point[s->node[f][0]], sizeof x->lo);
      memcpy(x->hi, x->lo, sizeof x->hi);
    }
    for (size_t k = 0; k < 3; k++) {
      uint32_t edge = e->of_half[3 * f + k], at = e->start[edge];

      grow_box(x, s->point[s->node[f][k]]);
      if (e->start[edge + 1] - at != 2) x->is_closed = 0;
      else if (vg_faces_disagree(s, e, edge) ^ flip[e->half[at] / 3] ^
               flip[e->half[at + 1] / 3])
        state[of_face[f]] |= VG_SHELL_MIXED;
    }
  }
}

vg_status vg_measure_shells(struct vg_shell *shell, uint8_t *state,
                            size_t n_shell, const struct vg_faces *s,
                            const struct vg_edges *e, const uint32_t *of_face,
                            const uint8_t *flip, struct vg_error *err)
{
  assert((shell && state) || !n_shell);

  struct total *sum = vg_calloc(n_shell, sizeof *sum);

  if (!sum) return vg_fail_memory(err, "the volumes of the shells");
  memset(shell, 0, n_shell * sizeof *shell);
  memset(state, 0, n_shell);
  for (size_t i = 0; i < n_shell; i++) shell[i].parent = SIZE_MAX;
  measure_extent(shell, state, s, e, of_face, flip);
  for (size_t f = 0; f < s->n; f++) {
    uint32_t i = of_face[f];
    const uint32_t *n = s->node[f];

    /* Relative to a corner of the shell's box, so that numbers are small
     * wherever the body is. */
    if (i != UINT32_MAX)
      add_volume(&sum[i], shell[i].lo, s->point[n[0]], s->point[n[1 + flip[f]]],
                 s->point[n[2 - flip[f]]]);
  }
  for (size_t i = 0; i < n_shell; i++) {
    double total = sum[i].sum + sum[i].low;

    shell[i].volume = total / 6;
    /* 8 roundings of 2^-53 per determinant; the compensated sum adds none. */
    if (!(fabs(total) > 1e-15 * sum[i].size)) state[i] |= VG_SHELL_FLAT;
  }
  free(sum);
  return VG_OK;
}

/* --- nesting ------------------------------------------------------------- */

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

/* Side of the line a b, projected along x, on which p + (0, e, e^2) lies for e
 * -> 0. Never 0 unless a and b project to the same point, so that a ray through
 * an edge or a node is counted once. */
static int side_of(const double *a, const double *b, const double *p)
{
  int s = sign(vg_orient2d(a + 1, b + 1, p + 1));

  if (!s) s = (a[2] > b[2]) - (a[2] < b[2]);
  if (!s) s = (b[1] > a[1]) - (b[1] < a[1]);
  return s;
}

/* Does the ray from p towards -x cross the triangle? */
static int ray_crosses(const double *a, const double *b, const double *c,
                       const double *p)
{
  int s = side_of(a, b, p);

  if (!s || side_of(b, c, p) != s || side_of(c, a, p) != s) return 0;
  return sign(vg_orient3d(a, b, c, p)) == s;
}

struct ray {
  const struct vg_faces *s;
  const struct vg_shell *shell;
  const uint32_t *of_face;
  const double *from;
  uint32_t own;  /* Shell from which the ray starts. */
  uint32_t *hit; /* [n] Shells crossed, with repetition. */
  size_t n, cap;
};

static int note_hit(void *context, uint32_t f)
{
  struct ray *r = context;
  const double(*p)[3] = r->s->point;
  const uint32_t *n = r->s->node[f];
  uint32_t i = r->of_face[f];

  if (i == r->own || !r->shell[i].is_closed ||
      !ray_crosses(p[n[0]], p[n[1]], p[n[2]], r->from))
    return VG_OK;
  if (vg_reserve(&r->hit, &r->cap, r->n + 1, sizeof *r->hit))
    return VG_ERR_MEMORY;
  r->hit[r->n++] = i;
  return VG_OK;
}

static int compare_id(const void *a, const void *b)
{
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;

  return (p > q) - (p < q);
}

/* Keep one of each id that occurs an odd number of times. */
static size_t keep_odd(uint32_t *id, size_t n)
{
  size_t kept = 0;

  if (n) qsort(id, n, sizeof *id, compare_id);
  for (size_t i = 0, j; i < n; i = j) {
    for (j = i; j < n && id[j] == id[i]; j++) {
    }
    if ((j - i) & 1) id[kept++] = id[i];
  }
  return kept;
}

struct nest {
  uint32_t *foot; /* [n_shell] Node of least x, from which rays towards -x are
                     short. */
  size_t *start;  /* [n_shell + 1] Ranges of `list`. */
  uint32_t *list; /* Shells around each shell. */
  size_t n, cap;
};

static void find_feet(struct nest *x, size_t n_shell, const struct vg_faces *s,
                      const uint32_t *of_face)
{
  memset(x->foot, 0xff, n_shell * sizeof *x->foot);
  for (size_t f = 0; f < s->n; f++) {
    if (of_face[f] == UINT32_MAX) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t *foot = &x->foot[of_face[f]], n = s->node[f][k];

      if (*foot == UINT32_MAX || s->point[n][0] < s->point[*foot][0]) *foot = n;
    }
  }
}

/* The ray from p towards -x. */
static struct vg_box line_from(const double p[3])
{
  return (struct vg_box){ { -INFINITY, p[1], p[2] }, { p[0], p[1], p[2] } };
}

static vg_status find_around(struct nest *x, struct ray *r, size_t n_shell,
                             const struct vg_box_tree *t)
{
  for (uint32_t i = 0; i < n_shell; i++) {
    struct vg_box line;

    x->start[i] = x->n;
    if (!r->shell[i].is_closed) continue;
    r->own = i;
    r->from = r->s->point[x->foot[i]];
    line = line_from(r->from);
    r->n = 0;
    if (vg_box_tree_touched(t, &line, note_hit, r) < 0) return VG_ERR_MEMORY;
    r->n = keep_odd(r->hit, r->n);
    if (vg_reserve(&x->list, &x->cap, x->n + r->n, sizeof *x->list))
      return VG_ERR_MEMORY;
    for (size_t k = 0; k < r->n; k++) x->list[x->n++] = r->hit[k];
  }
  x->start[n_shell] = x->n;
  return VG_OK;
}

vg_status vg_nest_shells(struct vg_shell *shell, size_t n_shell,
                         const struct vg_faces *s, const struct vg_box_tree *t,
                         const uint32_t *of_face, struct vg_error *err)
{
  struct nest x = { NULL, NULL, NULL, 0, 0 };
  struct ray r = { s, shell, of_face, NULL, 0, NULL, 0, 0 };
  vg_status st = VG_ERR_MEMORY;

  assert(shell || !n_shell);
  x.foot = vg_alloc(n_shell, sizeof *x.foot);
  x.start = vg_alloc(n_shell + 1, sizeof *x.start);
  if (x.foot && x.start) {
    find_feet(&x, n_shell, s, of_face);
    st = find_around(&x, &r, n_shell, t);
  }
  if (st < 0) {
    st = vg_fail_memory(err, "the nesting of the shells");
    goto done;
  }
  for (size_t i = 0; i < n_shell; i++)
    shell[i].depth = (int)(x.start[i + 1] - x.start[i]);
  for (size_t i = 0; i < n_shell; i++)
    for (size_t k = x.start[i]; k < x.start[i + 1]; k++) {
      size_t around = x.list[k];

      /* Of two shells that intersect, each can have a node inside the other. */
      if (shell[around].depth < shell[i].depth &&
          (shell[i].parent == SIZE_MAX ||
           shell[around].depth > shell[shell[i].parent].depth))
        shell[i].parent = around;
    }
done:
  free(x.foot);
  free(x.start);
  free(x.list);
  free(r.hit);
  return st;
}

/* --- orientation of shells ------------------------------------------------ */

struct sides {
  size_t *order; /* [n] Closed shells, outer before inner. */
  size_t n;
  uint8_t *wrong;     /* [n_shell] 1: not the side that its depth requires. */
  uint8_t *all_wrong; /* [n_shell] 1: neither this shell nor any inside it is
                         right. */
  uint8_t *whole;     /* [n_shell] 1: turned with all shells inside it. */
};

/* Sort by depth, then by number (counting sort; depths are below n_shell). */
static void sort_by_depth(struct sides *x, const struct vg_shell *shell,
                          const uint8_t *state, size_t n_shell, size_t *at)
{
  memset(at, 0, (n_shell + 1) * sizeof *at);
  for (size_t i = 0; i < n_shell; i++) at[shell[i].depth + 1]++;
  for (size_t i = 0; i < n_shell; i++) at[i + 1] += at[i];
  for (size_t i = 0; i < n_shell; i++) x->order[at[shell[i].depth]++] = i;
  for (size_t i = 0; i < n_shell; i++) {
    size_t k = x->order[i];

    if (shell[k].is_closed && !(state[k] & (VG_SHELL_FLAT | VG_SHELL_MIXED)))
      x->order[x->n++] = k;
  }
}

/* The fluid is outside the outermost shells if external, else inside them, and
 * alternates with each nested shell. */
static void judge(struct sides *x, const struct vg_shell *shell, int external)
{
  for (size_t i = 0; i < x->n; i++) {
    const struct vg_shell *s = &shell[x->order[i]];
    int outward = (s->depth & 1) == !external;

    x->wrong[x->order[i]] = outward != (s->volume > 0);
    x->all_wrong[x->order[i]] = x->wrong[x->order[i]];
  }
  for (size_t i = x->n; i--;) {
    size_t s = x->order[i], p = shell[s].parent;

    if (p != SIZE_MAX && !x->all_wrong[s]) x->all_wrong[p] = 0;
  }
}

/* The shells that certainly bound the fluid are the outermost ones and, within
 * a farfield, those directly inside it. They are turned as needed, together
 * with all shells inside them if all of these are wrong as well. */
static void settle(struct sides *x, const struct vg_shell *shell,
                   uint8_t *state, int external, int repair,
                   const uint8_t *crossed, uint8_t *turn)
{
  for (size_t i = 0; i < x->n; i++) {
    size_t s = x->order[i], p = shell[s].parent;
    int is_certain = shell[s].depth <= !external &&
                     (!shell[s].depth || !crossed[s]);

    if (p != SIZE_MAX && x->whole[p]) {
      turn[s] = x->whole[s] = 1;
    } else if (x->wrong[s] && is_certain) {
      if (!repair) {
        state[s] |= VG_SHELL_REVERSED;
      } else {
        turn[s] = 1;
        x->whole[s] = x->all_wrong[s];
      }
    } else if (x->wrong[s] && !crossed[s]) {
      int with_parent = p != SIZE_MAX && x->wrong[p] && !turn[p];

      state[s] |= with_parent ? VG_SHELL_REVERSED : VG_SHELL_STRAY;
    }
  }
}

vg_status vg_orient_shells(struct vg_shell *shell, uint8_t *state,
                           size_t n_shell, int external, int repair,
                           const uint8_t *crossed, uint8_t *turn,
                           struct vg_error *err)
{
  assert(external >= -1 && external <= 1);

  struct sides x = { NULL, 0, NULL, NULL, NULL };
  size_t *at = vg_alloc(n_shell + 1, sizeof *at);
  vg_status st = VG_OK;

  x.order = vg_alloc(n_shell, sizeof *x.order);
  x.wrong = vg_calloc(n_shell, 1);
  x.all_wrong = vg_calloc(n_shell, 1);
  x.whole = vg_calloc(n_shell, 1);
  if (!at || !x.order || !x.wrong || !x.all_wrong || !x.whole) {
    st = vg_fail_memory(err, "the sides of the shells");
    goto done;
  }
  memset(turn, 0, n_shell);
  if (external < 0) goto done;
  external = external != 0;
  sort_by_depth(&x, shell, state, n_shell, at);
  judge(&x, shell, external);
  settle(&x, shell, state, external, repair, crossed, turn);
  for (size_t i = 0; i < n_shell; i++)
    if (turn[i]) shell[i].volume = -shell[i].volume;
done:
  free(at);
  free(x.order);
  free(x.wrong);
  free(x.all_wrong);
  free(x.whole);
  return st;
}
