/* What a cut leaves: the parts of the front, grouped into voids. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/node.h"

/* A part with fewer faces is a cell or two that a zone went around. */
enum { CRUMB_FACES = 24 };
#define REST SIZE_MAX
/* Voids below this share of a leaf are filled together. */
static const double small_share = 0.02;
/* A cut that leaves more than this in one part did not part its void. */
static const double not_parted = 0.9;

struct split {
  struct vg_node *n;
  size_t n_part;
  struct vg_front *part;     /* [n_part] fronts, without an edge in common */
  double *volume;            /* [n_part] enclosed; negative: around a body */
  uint32_t *owner;           /* [n_part] the part it is put to */
};

static vg_status find_parts(struct split *s, struct vg_error *err)
{
  struct vg_front *f = &s->n->front;
  uint32_t *part = vg_alloc(f->n_face, sizeof *part);
  vg_status st = part ? VG_OK : vg_fail_memory(err, "the parts of a front");

  if (st == VG_OK) st = vg_front_parts(f, part, &s->n_part, err);
  if (st == VG_OK) {
    s->part = vg_calloc(s->n_part, sizeof *s->part);
    s->volume = vg_alloc(s->n_part, sizeof *s->volume);
    s->owner = vg_alloc(s->n_part, sizeof *s->owner);
    if (!s->part || !s->volume || !s->owner)
      st = vg_fail_memory(err, "the parts of a front");
  }
  if (st == VG_OK) st = vg_front_split(f, part, s->n_part, s->part, err);
  if (st == VG_OK) vg_front_release(f);
  free(part);
  return st;
}

/* A shell around a body belongs to the void that holds it: the smallest one
 * that encloses a point of it. */
static void find_owners(struct split *s)
{
  for (size_t k = 0; k < s->n_part; k++) {
    s->owner[k] = (uint32_t)k;
    s->volume[k] = vg_front_volume(&s->part[k]);
  }
  for (size_t k = 0; k < s->n_part; k++) {
    double least = INFINITY;

    if (s->volume[k] > 0) continue;
    for (size_t m = 0; m < s->n_part; m++)
      if (s->volume[m] > 0 && s->volume[m] < least &&
          s->volume[m] > -s->volume[k] &&
          vg_front_encloses(&s->part[m], s->part[k].x[0])) {
        least = s->volume[m];
        s->owner[k] = (uint32_t)m;
      }
  }
}

static vg_status put_shells(struct split *s, struct vg_error *err)
{
  for (size_t k = 0; k < s->n_part; k++) {
    vg_status st;

    if (s->owner[k] == k) continue;
    st = vg_front_append(&s->part[s->owner[k]], &s->part[k], err);
    if (st < 0) return st;
    vg_front_release(&s->part[k]);
  }
  return VG_OK;
}

/* The child's name, number k or, for what is put together, "r"; path[] has
 * room (vg_node_wants_cut). */
static struct vg_node *new_child(const struct vg_node *n, size_t k,
                                 struct vg_front *front)
{
  char path[VG_PATH_MAX];
  struct vg_node *child;

  if (k == REST) snprintf(path, sizeof path, "%.*s.r", VG_PATH_MAX - 8,
                          n->path);
  else snprintf(path, sizeof path, "%.*s.%zu", VG_PATH_MAX - 24, n->path, k);
  child = vg_node_new(path, front);
  if (!child) return NULL;
  child->per_cube = n->per_cube;
  child->levels = n->levels - n->n_bisection;
  if (child->levels < 0) child->levels = 0;
  return child;
}

/* All parts but crumbs become children. */
static vg_status make_children(struct split *s, struct vg_front *crumbs,
                               struct vg_error *err)
{
  struct vg_node *n = s->n;

  n->child = vg_calloc(s->n_part + 1, sizeof *n->child);
  if (!n->child) return vg_fail_memory(err, "the parts of a front");
  for (size_t k = 0; k < s->n_part; k++) {
    vg_status st;

    if (!s->part[k].n_face) continue;
    if (s->part[k].n_face < CRUMB_FACES) {
      st = vg_front_append(crumbs, &s->part[k], err);
      if (st < 0) return st;
      continue;
    }
    n->child[n->n_child] = new_child(n, n->n_child, &s->part[k]);
    if (!n->child[n->n_child])
      return vg_fail_memory(err, "the parts of a front");
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

static vg_status share_load(struct vg_node *n, struct vg_error *err)
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

/* Put small children together with the crumbs. Returns how many stay. */
static vg_status bundle(struct vg_partition *p, struct vg_node *n,
                        struct vg_front *crumbs, struct vg_error *err)
{
  double least = small_share * p->options.rule.leaf_cells;
  struct vg_node *rest = NULL;
  size_t left = 0;
  double cells = 0;

  for (size_t k = 0; k < n->n_child; k++) {
    struct vg_node *c = n->child[k];
    vg_status st;

    n->child[k] = NULL;
    if (c->load.cells >= least) {
      n->child[left++] = c;
      continue;
    }
    cells += c->load.cells;
    st = vg_front_append(crumbs, &c->front, err);
    vg_node_free(c);
    if (st < 0) {
      n->n_child = k + 1;
      return st;
    }
  }
  n->n_child = left;
  if (!crumbs->n_face) return VG_OK;
  rest = new_child(n, REST, crumbs);
  if (!rest) return vg_fail_memory(err, "the parts of a front");
  rest->is_final = 1;
  rest->load.cells = cells;
  n->child[n->n_child++] = rest;
  return VG_OK;
}

vg_status vg_node_split(struct vg_partition *p, struct vg_node *n,
                        struct vg_error *err)
{
  struct split s = { .n = n };
  struct vg_front crumbs = VG_FRONT_INIT;
  vg_status st;

  VG_TRY(find_parts(&s, err));
  find_owners(&s);
  VG_TRY(put_shells(&s, err));
  VG_TRY(make_children(&s, &crumbs, err));
  VG_TRY(share_load(n, err));
  count_retry(p, n);
  st = bundle(p, n, &crumbs, err);
done:
  for (size_t k = 0; s.part && k < s.n_part; k++)
    vg_front_release(&s.part[k]);
  free(s.part);
  free(s.volume);
  free(s.owner);
  vg_front_release(&crumbs);
  return st;
}
