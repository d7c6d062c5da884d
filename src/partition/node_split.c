/* What a cut leaves: the front, parted by the blocks of the lattice. Outline:
 * faces that are left lie on one side of every plane (node_close.c), so the
 * block of a point tells that of its faces, and what bounds a void within a
 * block never shares a point with another block. Where a face still touches
 * planes, the blocks on both sides are one void. A void's parts, a body in it
 * or a crumb that a zone went around, need not be told apart: cutting and
 * filling take any number of them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/node.h"

/* Voids below this share of a leaf are filled together. */
static const double small_share = 0.02;
/* A cut that leaves more than this in one part did not part its void. */
static const double not_parted = 0.9;
/* Cells that zones make of it are not the blocks': spacings to each side. */
static const double zone_reach = 0.68;

enum { NONE = 0xffff };

struct split {
  struct vg_node *n;
  uint16_t root[VG_LATTICE_BLOCKS];   /* union-find of blocks */
  uint16_t child[VG_LATTICE_BLOCKS];  /* of a root, or NONE */
  int is_merged;
  size_t n_part;
  struct vg_front *part;     /* [n_part] of the children, in their order */
};

/* --- blocks that hang together -------------------------------------------- */

static uint16_t root_of(struct split *s, uint32_t b)
{
  while (s->root[b] != b) b = s->root[b] = s->root[s->root[b]];
  return (uint16_t)b;
}

static void unite(struct split *s, uint32_t a, uint32_t b)
{
  a = root_of(s, a);
  b = root_of(s, b);
  if (a == b) return;
  s->is_merged = 1;
  s->root[a < b ? b : a] = (uint16_t)(a < b ? a : b);
}

static uint32_t block_of(const struct split *s, uint32_t point)
{
  return s->n->block[point] & ~VG_ON_PLANE;
}

static void unite_corners(struct split *s, const uint32_t v[3])
{
  const struct vg_node *n = s->n;

  for (int k = 0; k < 3; k++) {
    unite(s, block_of(s, v[k]), block_of(s, v[0]));
    if (n->block[v[k]] & VG_ON_PLANE)
      unite(s, block_of(s, v[k]),
            vg_lattice_block(&n->lattice, n->front.x[v[k]], 1));
  }
}

/* Blocks that hang together become one; those without faces none. */
static void find_children(struct split *s)
{
  const struct vg_front *f = &s->n->front;
  uint8_t is_used[VG_LATTICE_BLOCKS] = {0};

  for (uint32_t b = 0; b < VG_LATTICE_BLOCKS; b++) s->root[b] = (uint16_t)b;
  for (size_t i = 0; i < f->n_face; i++) {
    const uint32_t *v = f->face[i];

    if (v[0] == VG_FACE_GONE) continue;
    if (!vg_node_is_in_block(s->n->block, v)) unite_corners(s, v);
    is_used[block_of(s, v[0])] = 1;
  }
  s->n_part = 0;
  memset(s->child, 0xff, sizeof s->child);
  for (uint32_t b = 0; b < VG_LATTICE_BLOCKS; b++) {
    uint16_t r = root_of(s, b);

    if (is_used[b] && s->child[r] == NONE)
      s->child[r] = (uint16_t)s->n_part++;
  }
  for (uint32_t b = 0; b < VG_LATTICE_BLOCKS; b++)
    s->child[b] = s->child[root_of(s, b)];
}

/* --- fronts of the children ---------------------------------------------- */

static vg_status make_room(struct split *s, const size_t *n_face,
                           const size_t *n_point, struct vg_error *err)
{
  s->part = vg_calloc(s->n_part, sizeof *s->part);
  if (!s->part) return vg_fail_memory(err, "the parts of a front");
  for (size_t k = 0; k < s->n_part; k++) {
    struct vg_front *part = &s->part[k];

    part->x = vg_alloc(n_point[k], sizeof *part->x);
    part->name = vg_alloc(n_point[k], sizeof *part->name);
    part->face = vg_alloc(n_face[k], sizeof *part->face);
    if (!part->x || !part->name || !part->face)
      return vg_fail_memory(err, "the parts of a front");
  }
  return VG_OK;
}

/* Points in the order in which faces use them. */
static void deal_out(struct split *s, uint32_t *number)
{
  const struct vg_front *f = &s->n->front;

  for (size_t i = 0; i < f->n_face; i++) {
    struct vg_front *part;
    uint32_t *to;

    if (f->face[i][0] == VG_FACE_GONE) continue;
    part = &s->part[s->child[block_of(s, f->face[i][0])]];
    to = part->face[part->n_face++];
    for (int k = 0; k < 3; k++) {
      uint32_t p = f->face[i][k];

      if (number[p] == UINT32_MAX) {
        memcpy(part->x[part->n_point], f->x[p], sizeof *part->x);
        part->name[part->n_point] = f->name[p];
        number[p] = (uint32_t)part->n_point++;
      }
      to[k] = number[p];
    }
  }
}

static vg_status split_front(struct split *s, struct vg_error *err)
{
  const struct vg_front *f = &s->n->front;
  uint32_t *number = vg_alloc(f->n_point, sizeof *number);
  size_t *count = vg_calloc(2 * s->n_part + 1, sizeof *count);
  vg_status st = VG_OK;

  if (!number || !count) st = vg_fail_memory(err, "the parts of a front");
  if (st == VG_OK) {
    for (size_t i = 0; i < f->n_face; i++)
      if (f->face[i][0] != VG_FACE_GONE)
        count[s->child[block_of(s, f->face[i][0])]]++;
    for (size_t p = 0; p < f->n_point; p++) {
      uint16_t c = s->child[block_of(s, (uint32_t)p)];

      if (c != NONE) count[s->n_part + c]++;
    }
    st = make_room(s, count, count + s->n_part, err);
  }
  if (st == VG_OK) {
    memset(number, 0xff, f->n_point * sizeof *number);
    deal_out(s, number);
    vg_front_release(&s->n->front);
  }
  free(number);
  free(count);
  return st;
}

/* Where nothing could be grown beside a block, a body in it may have lost its
 * void: then the front stays as it is. */
static int bounds_nothing(const struct split *s)
{
  for (size_t k = 0; s->n->n_blocked && k < s->n_part; k++)
    if (!(vg_front_volume(&s->part[k]) > 0)) return 1;
  return 0;
}

/* One part again. */
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

/* The child's name, number k or, for what is put together, "r"; path[] has
 * room (vg_node_wants_cut). */
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
  if (!n->child) return vg_fail_memory(err, "the parts of a front");
  for (size_t k = 0; k < s->n_part; k++) {
    n->child[k] = new_child(n, k, 0, &s->part[k]);
    if (!n->child[k]) return vg_fail_memory(err, "the parts of a front");
    n->n_child++;
  }
  return VG_OK;
}

/* How many cells a cube of the spacing gets is read off the zones; halfway,
 * since these are along planes. */
static double correction(struct vg_node *n)
{
  double was = n->per_cube, seen = n->zone_cells / n->zone_volume;

  if (!(n->zone_cells > 1000) || !(seen > 0.5 * was && seen < 2 * was))
    return 1;
  n->per_cube = 0.5 * (was + seen);
  return n->per_cube / was;
}

/* Every child is what was left of one block. */
static vg_status load_of_blocks(struct split *s, struct vg_error *err)
{
  struct vg_node *n = s->n;
  const double *at[3];
  size_t n_block = vg_lattice_blocks(&n->lattice);
  struct vg_load *load = vg_calloc(n_block, sizeof *load);
  vg_status st;

  if (!load) return vg_fail_memory(err, "the load of a void");
  for (int k = 0; k < 3; k++) at[k] = n->lattice.at[k];
  st = vg_load_split_blocks(&n->load, n->lattice.n, at, zone_reach,
                            correction(n), 1, load, err);
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

static vg_status load_of_fronts(struct vg_node *n, struct vg_error *err)
{
  struct vg_void *v = vg_calloc(n->n_child, sizeof *v);
  struct vg_load *load = vg_calloc(n->n_child, sizeof *load);
  vg_status st = VG_OK;

  if (!v || !load) st = vg_fail_memory(err, "the load of a void");
  for (size_t k = 0; st == VG_OK && k < n->n_child; k++) {
    v[k].n_point = n->child[k]->front.n_point;
    v[k].x = n->child[k]->front.x;
    v[k].n_face = n->child[k]->front.n_face;
    v[k].face = n->child[k]->front.face;
  }
  if (st == VG_OK)
    st = vg_load_split(&n->load, n->n_child, v, correction(n), load, err);
  for (size_t k = 0; st == VG_OK && k < n->n_child; k++) {
    n->child[k]->load = load[k];
    n->child[k]->per_cube = n->per_cube;
  }
  free(v);
  free(load);
  return st;
}

/* A void that a cut left nearly whole is cut elsewhere next time. */
static void count_retry(struct vg_partition *p, struct vg_node *n)
{
  double sum = 0;

  for (size_t k = 0; k < n->n_child; k++) sum += n->child[k]->load.cells;
  for (size_t k = 0; k < n->n_child; k++)
    if (n->child[k]->load.cells > not_parted * sum) {
      n->child[k]->retry = n->retry + 1;
      n->child[k]->levels = n->levels;
      pthread_mutex_lock(&p->lock);
      p->report.n_retry++;
      pthread_mutex_unlock(&p->lock);
    }
}

/* Put small children together. */
static vg_status bundle(struct vg_partition *p, struct vg_node *n,
                        struct vg_error *err)
{
  double least = small_share * p->options.rule.leaf_cells, cells = 0;
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

    if (!r) st = vg_fail_memory(err, "the parts of a front");
    else {
      r->is_final = 1;
      r->load.cells = cells;
      n->child[n->n_child++] = r;
    }
  }
  vg_front_release(&rest);
  return st;
}

vg_status vg_node_split(struct vg_partition *p, struct vg_node *n,
                        struct vg_error *err)
{
  struct split s = { .n = n };
  vg_status st;

  find_children(&s);
  VG_TRY(split_front(&s, err));
  if (bounds_nothing(&s)) VG_TRY(undo(&s, err));
  VG_TRY(make_children(&s, err));
  VG_TRY(s.is_merged ? load_of_fronts(n, err) : load_of_blocks(&s, err));
  count_retry(p, n);
  st = bundle(p, n, err);
done:
  for (size_t k = 0; s.part && k < s.n_part; k++)
    vg_front_release(&s.part[k]);
  free(s.part);
  return st;
}
