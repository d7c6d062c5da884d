/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Divides the front that a cut leaves by the blocks of the lattice. Outline:
 * the remaining faces are on one side of every plane (node_close.c). The block
 * of a point is therefore the block of its faces, and the front of a void
 * inside one block never shares a point with another block. Where a face still
 * touches planes, the blocks on both sides are one void. The components of a
 * void, such as a body in it or a small component that a zone went around,
 * need not be distinguished: cutting and filling accept any number of them. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "partition/cut/node.h"
#include "partition/engine/engine_memory.h"

/* Faces or points per chunk of a loop. */
enum { CHUNK = 8192 };

enum { NONE = 0xffff };

struct split {
  struct vg_node *n;
  const struct vg_engine *e;
  size_t n_block, n_chunk; /* n_chunk: chunks of faces. */
  /* [n_chunk][n_block] Faces, later the index of the first face for a
   * child, stored at the child's first block. */
  uint32_t *count;
  uint32_t root[VG_LATTICE_BLOCKS];  /* Of blocks (base/union_find.h). */
  uint16_t child[VG_LATTICE_BLOCKS]; /* Child of a root, or NONE. */
  int is_merged;
  size_t n_part;
  struct vg_front *part; /* [n_part] Fronts of the children, in their order. */
};

/* --- connected blocks ---------------------------------------------------- */

static uint32_t block_of(const struct split *s, uint32_t point)
{
  return s->n->block[point] & ~VG_ON_PLANE;
}

static void unite_corners(struct split *s, const uint32_t v[3])
{
  const struct vg_node *n = s->n;

  for (int k = 0; k < 3; k++) {
    s->is_merged |= vg_union(s->root, block_of(s, v[k]), block_of(s, v[0]));
    if (n->block[v[k]] & VG_ON_PLANE)
      s->is_merged |= vg_union(s->root, block_of(s, v[k]),
                               vg_lattice_block(&n->lattice, n->front.x[v[k]],
                                                1));
  }
}

static void count_part(void *context, size_t first, size_t end, int worker)
{
  const struct split *s = context;
  uint32_t *count = s->count + first / CHUNK * s->n_block;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    uint32_t p = s->n->front.face[i][0];

    if (p != VG_FACE_GONE) count[block_of(s, p)]++;
  }
}

/* Counts the faces per chunk and block; totals in sum[]. */
static vg_status count_faces(struct split *s, size_t *sum, struct vg_error *err)
{
  s->n_block = vg_lattice_blocks(&s->n->lattice);
  s->n_chunk = (s->n->front.n_face + CHUNK - 1) / CHUNK;
  s->count = vg_calloc(s->n_chunk * s->n_block, sizeof *s->count);
  if (!s->count) return vg_fail_memory(err, "dividing a front");
  vg_engine_loop(s->e, s->n->front.n_face, CHUNK, count_part, s);
  for (size_t c = 0; c < s->n_chunk; c++)
    for (size_t b = 0; b < s->n_block; b++)
      sum[b] += s->count[c * s->n_block + b];
  return VG_OK;
}

/* Connected blocks become one child; blocks without faces have no child. */
static void number_children(struct split *s, const size_t *n_face)
{
  for (uint32_t b = 0; b < VG_LATTICE_BLOCKS; b++) s->root[b] = b;
  for (size_t k = 0; k < s->n->n_open; k++)
    unite_corners(s, s->n->front.face[s->n->open[k]]);
  s->n_part = 0;
  memset(s->child, 0xff, sizeof s->child);
  for (uint32_t b = 0; b < s->n_block; b++) {
    uint32_t r = vg_root_of(s->root, b);

    if (n_face[b] && s->child[r] == NONE) s->child[r] = (uint16_t)s->n_part++;
  }
  for (uint32_t b = 0; b < VG_LATTICE_BLOCKS; b++)
    s->child[b] = s->child[vg_root_of(s->root, b)];
}

static vg_status find_children(struct split *s, struct vg_error *err)
{
  size_t n_face[VG_LATTICE_BLOCKS] = { 0 };
  vg_status st;

  VG_TRY(vg_node_list_open(s->n, s->e, err));
  VG_TRY(count_faces(s, n_face, err));
  number_children(s, n_face);
  s->part = vg_calloc(s->n_part, sizeof *s->part);
  if (!s->part) return vg_fail_memory(err, "dividing a front");
  for (size_t b = 0; b < s->n_block; b++)
    if (n_face[b]) s->part[s->child[b]].n_face += n_face[b];
done:
  return st;
}

/* --- fronts of the children ---------------------------------------------- */

/* Sets the index at which each chunk writes its first face of each child. */
static void place_chunks(struct split *s)
{
  uint32_t at[VG_LATTICE_BLOCKS] = { 0 };

  for (size_t c = 0; c < s->n_chunk; c++) {
    uint32_t *count = s->count + c * s->n_block;
    uint32_t n[VG_LATTICE_BLOCKS] = { 0 };

    for (size_t b = 0; b < s->n_block; b++)
      if (count[b]) n[s->child[b]] += count[b];
    for (size_t k = 0; k < s->n_part; k++) {
      count[k] = at[k];
      at[k] += n[k];
    }
  }
}

struct distribution {
  struct split *s;
  uint32_t *number; /* [points of the front] Index in their child. */
  int *is_short;    /* [n_part] 1: memory was refused. */
};

/* There are no more children than blocks, so their indices fit in count[]. */
static void distribute_faces(void *context, size_t first, size_t end,
                             int worker)
{
  const struct distribution *d = context;
  const struct split *s = d->s;
  const struct vg_front *f = &s->n->front;
  uint32_t *at = s->count + first / CHUNK * s->n_block;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    uint16_t c;

    if (f->face[i][0] == VG_FACE_GONE) continue;
    c = s->child[block_of(s, f->face[i][0])];
    memcpy(s->part[c].face[at[c]++], f->face[i], sizeof *f->face);
  }
}

static void clear_numbers(void *context, size_t first, size_t end, int worker)
{
  const struct distribution *d = context;

  (void)worker;
  memset(d->number + first, 0xff, (end - first) * sizeof *d->number);
}

/* Numbers points in the order in which faces use them. All corners of a face
 * are in blocks of one child (unite_corners), so a point belongs to one child,
 * and only one thread writes its number. */
static int number_points(const struct distribution *d, struct vg_front *part)
{
  const struct vg_front *f = &d->s->n->front;
  size_t n = 0, cap = 0;
  uint32_t *point = NULL;
  int bad = 0;

  for (size_t i = 0; i < part->n_face && !bad; i++) {
    bad = vg_reserve(&point, &cap, n + 3, sizeof *point);
    for (int k = 0; k < 3 && !bad; k++) {
      uint32_t *p = &part->face[i][k];

      if (d->number[*p] == UINT32_MAX) {
        point[n] = *p;
        d->number[*p] = (uint32_t)n++;
      }
      *p = d->number[*p];
    }
  }
  part->x = bad ? NULL : vg_alloc(n, sizeof *part->x);
  part->id = bad ? NULL : vg_alloc(n, sizeof *part->id);
  bad = !part->x || !part->id;
  for (size_t k = 0; k < n && !bad; k++) {
    memcpy(part->x[k], f->x[point[k]], sizeof *part->x);
    part->id[k] = f->id[point[k]];
  }
  part->n_point = bad ? 0 : n;
  free(point);
  return bad;
}

static void distribute_points(void *context, size_t first, size_t end,
                              int worker)
{
  const struct distribution *d = context;

  (void)worker;
  for (size_t c = first; c < end; c++)
    d->is_short[c] = number_points(d, &d->s->part[c]);
}

static vg_status distribute(struct distribution *d, struct vg_error *err)
{
  struct split *s = d->s;
  const struct vg_front *f = &s->n->front;

  for (size_t k = 0; k < s->n_part; k++) {
    s->part[k].face = vg_alloc(s->part[k].n_face, sizeof *f->face);
    if (!s->part[k].face) return vg_fail_memory(err, "dividing a front");
  }
  place_chunks(s);
  vg_engine_loop(s->e, f->n_face, CHUNK, distribute_faces, d);
  vg_engine_loop(s->e, f->n_point, CHUNK, clear_numbers, d);
  vg_engine_loop(s->e, s->n_part, 1, distribute_points, d);
  for (size_t k = 0; k < s->n_part; k++)
    if (d->is_short[k]) return vg_fail_memory(err, "dividing a front");
  return VG_OK;
}

static vg_status split_front(struct split *s, struct vg_error *err)
{
  struct distribution d = { s, vg_alloc(s->n->front.n_point, sizeof *d.number),
                            vg_calloc(s->n_part, sizeof *d.is_short) };
  struct vg_front *f = &s->n->front;
  vg_status st = d.number && d.is_short
                 ? distribute(&d, err)
                 : vg_fail_memory(err, "dividing a front");
  void *const whole[] = { f->x, f->id, f->face, d.number, d.is_short };

  vg_engine_free(s->e, sizeof whole / sizeof *whole, whole);
  memset(f, 0, sizeof *f);
  return st;
}

struct volumes {
  const struct split *s;
  double *of; /* [n_part] Volumes. */
};

static void measure_part(void *context, size_t first, size_t end, int worker)
{
  const struct volumes *v = context;

  (void)worker;
  for (size_t k = first; k < end; k++)
    v->of[k] = vg_front_volume(&v->s->part[k]);
}

/* If a zone next to a block failed, a body in the block may be left without a
 * surrounding void. In that case the front is not divided. */
static vg_status find_nothing(const struct split *s, int *found,
                              struct vg_error *err)
{
  struct volumes v = { s, vg_alloc(s->n_part, sizeof *v.of) };

  *found = 0;
  if (!v.of) return vg_fail_memory(err, "dividing a front");
  if (s->n->n_blocked) {
    vg_engine_loop(s->e, s->n_part, 1, measure_part, &v);
    for (size_t k = 0; k < s->n_part; k++) *found |= !(v.of[k] > 0);
  }
  free(v.of);
  return VG_OK;
}

/* Merges everything into one part again. */
static vg_status undo(struct split *s, struct vg_error *err)
{
  for (size_t k = 1; k < s->n_part; k++) {
    vg_status st = vg_front_append(&s->part[0], &s->part[k], err);

    if (st < 0) return st;
    vg_front_release(&s->part[k]);
  }
  s->n_part = 1;
  s->is_merged = 1;
  return VG_OK;
}

/* --- children ------------------------------------------------------------ */

/* Makes a child with path number k or, for small voids filled together, "r".
 * path[] has room (vg_node_wants_cut). */
static struct vg_node *new_child(const struct vg_node *n, size_t k, int is_rest,
                                 struct vg_front *front)
{
  char path[VG_PATH_MAX];
  struct vg_node *child;

  if (is_rest) snprintf(path, sizeof path, "%.*s.r", VG_PATH_MAX - 8, n->path);
  else snprintf(path, sizeof path, "%.*s.%zu", VG_PATH_MAX - 24, n->path, k);
  child = vg_node_new(path, front);
  if (!child) return NULL;
  child->per_cube = n->per_cube;
  child->levels = n->levels - n->n_bisection;
  if (child->levels < 0) child->levels = 0;
  return child;
}

static vg_status make_children(struct split *s, struct vg_error *err)
{
  struct vg_node *n = s->n;

  n->child = vg_calloc(s->n_part + 1, sizeof *n->child);
  if (!n->child) return vg_fail_memory(err, "dividing a front");
  for (size_t k = 0; k < s->n_part; k++) {
    n->child[k] = new_child(n, k, 0, &s->part[k]);
    if (!n->child[k]) return vg_fail_memory(err, "dividing a front");
    n->n_child++;
  }
  return VG_OK;
}

/* Corrects the cells per cube of the spacing from the zones, by half of the
 * difference, since zones are along planes only. */
static double correction(struct vg_node *n)
{
  double was = n->per_cube, seen = n->separator_cells / n->zone_volume;

  if (!(n->separator_cells > 1000) || !(seen > 0.5 * was && seen < 2 * was))
    return 1;
  n->per_cube = 0.5 * (was + seen);
  return n->per_cube / was;
}

/* Every child is the remaining void of one block. */
static vg_status load_of_blocks(struct split *s, struct vg_error *err)
{
  struct vg_node *n = s->n;
  const double *at[3];
  size_t n_block = vg_lattice_blocks(&n->lattice);
  struct vg_load *load = vg_calloc(n_block, sizeof *load);
  vg_status st;

  if (!load) return vg_fail_memory(err, "the load of a void");
  for (int k = 0; k < 3; k++) at[k] = n->lattice.at[k];
  st = vg_load_split_blocks(&n->load, n->lattice.n, at, VG_TILE_REACH,
                            correction(n), s->e, load, err);
  for (size_t b = 0; st == VG_OK && b < n_block; b++) {
    if (s->child[b] == NONE) {
      vg_load_release(&load[b]);
      continue;
    }
    n->child[s->child[b]]->load = load[b];
    n->child[s->child[b]]->per_cube = n->per_cube;
  }
  free(load);
  return st;
}

vg_status vg_node_share_load(struct vg_node *n, double correction,
                             const struct vg_engine *e, struct vg_error *err)
{
  struct vg_front *v = vg_calloc(n->n_child, sizeof *v);
  struct vg_load *load = vg_calloc(n->n_child, sizeof *load);
  vg_status st = VG_OK;

  assert(n->child || !n->n_child);
  assert(correction > 0);
  if (!v || !load) st = vg_fail_memory(err, "the load of a void");
  for (size_t k = 0; st == VG_OK && k < n->n_child; k++)
    v[k] = n->child[k]->front;
  if (st == VG_OK)
    st = vg_load_split(&n->load, n->n_child, v, correction, e, load, err);
  for (size_t k = 0; st == VG_OK && k < n->n_child; k++) {
    n->child[k]->load = load[k];
    n->child[k]->per_cube = n->per_cube;
  }
  free(v);
  free(load);
  return st;
}

/* A void that a cut left nearly whole is cut elsewhere at the next attempt. */
static void count_retry(struct vg_partition *p, struct vg_node *n)
{
  double sum = 0;

  for (size_t k = 0; k < n->n_child; k++) sum += n->child[k]->load.cells;
  for (size_t k = 0; k < n->n_child; k++)
    if (n->child[k]->load.cells > VG_NOT_PARTED * sum) {
      n->child[k]->retry = n->retry + 1;
      n->child[k]->levels = n->levels;
      pthread_mutex_lock(&p->lock);
      p->report.n_retry++;
      pthread_mutex_unlock(&p->lock);
    }
}

/* Merges small children. */
static vg_status bundle(struct vg_partition *p, struct vg_node *n,
                        struct vg_error *err)
{
  double least = VG_SMALL_SHARE * p->options.rule.leaf_cells, cells = 0;
  struct vg_front rest = VG_FRONT_INIT;
  size_t left = 0;
  vg_status st = VG_OK;

  for (size_t k = 0; k < n->n_child; k++) {
    struct vg_node *c = n->child[k];

    n->child[k] = NULL;
    if (st < 0 || c->load.cells >= least) {
      n->child[left++] = c;
      continue;
    }
    cells += c->load.cells;
    st = vg_front_append(&rest, &c->front, err);
    vg_node_free(c);
  }
  n->n_child = left;
  if (st == VG_OK && rest.n_face) {
    struct vg_node *r = new_child(n, 0, 1, &rest);

    if (!r) st = vg_fail_memory(err, "dividing a front");
    else {
      r->is_final = 1;
      r->load.cells = cells;
      n->child[n->n_child++] = r;
    }
  }
  vg_front_release(&rest);
  return st;
}

struct plans {
  const struct vg_partition *p;
  struct vg_node **child;
};

static void plan_part(void *context, size_t first, size_t end, int worker)
{
  const struct plans *q = context;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    struct vg_node *c = q->child[k];

    if (!vg_node_wants_cut(q->p, c)) c->fill_work = vg_front_work(&c->front);
  }
}

void vg_node_plan_children(const struct vg_partition *p, struct vg_node *n,
                           const struct vg_engine *e)
{
  struct plans plans = { p, n->child };

  assert(n->child || !n->n_child);
  vg_engine_loop(e, n->n_child, 1, plan_part, &plans);
}

vg_status vg_node_split(struct vg_partition *p, struct vg_node *n,
                        const struct vg_engine *e, struct vg_error *err)
{
  struct split s = { .n = n, .e = e };
  int nothing;
  vg_status st;

  assert(!n->n_work && !n->n_child && !n->child);
  VG_TRY(find_children(&s, err));
  VG_TRY(split_front(&s, err));
  VG_TRY(find_nothing(&s, &nothing, err));
  if (nothing) VG_TRY(undo(&s, err));
  VG_TRY(make_children(&s, err));
  VG_TRY(s.is_merged ? vg_node_share_load(n, correction(n), e, err)
                     : load_of_blocks(&s, err));
  count_retry(p, n);
  VG_TRY(bundle(p, n, err));
  vg_node_plan_children(p, n, e);
done:
  for (size_t k = 0; s.part && k < s.n_part; k++) vg_front_release(&s.part[k]);
  free(s.part);
  free(s.count);
  return st;
}
