/* Where parts of a void hang together across a lattice. Outline: every cell
 * that touches a plane is made by a stage, so the faces that are left lie on
 * one side of each plane, except where cells could not be kept, because they
 * would have reached into another region. Faces that touch a plane there are
 * put together to places, and the boxes around these are filled: few cells,
 * which no plane needs to cross any more. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/node.h"

/* A box ends so many spacings beyond the faces that it is made for. */
static const double margin = 1.5;
/* Places with more faces are where a region was given up; more places: the
 * planes do not suit this void. */
enum { MOST_FACES = 600, MOST_PLACES = 512, MOST_TOUCHING = 16384 };

struct place {
  size_t n_face;             /* 0: became part of another one */
  double lo[3], hi[3];
};

struct search {
  const struct vg_node *n;
  const struct vg_sizing *sizing;
  size_t n_touching, cap_touching;
  uint32_t *touching;        /* [n_touching] faces */
  uint32_t *parent;          /* [n_touching] those with a point in common */
  size_t n_place, cap_place;
  struct place *place;
};

static void extent_of(const struct search *s, uint32_t face, int axis,
                      double *lo, double *hi)
{
  const struct vg_front *f = &s->n->front;
  const uint32_t *v = f->face[face];
  double a = f->x[v[0]][axis], b = f->x[v[1]][axis], c = f->x[v[2]][axis];

  *lo = fmin(fmin(a, b), c);
  *hi = fmax(fmax(a, b), c);
}

static vg_status list_touching(struct search *s, struct vg_error *err)
{
  for (uint32_t i = 0; i < s->n->front.n_face; i++) {
    const uint32_t *v = s->n->front.face[i];
    const uint16_t *block = s->n->block;

    if (v[0] == VG_FACE_GONE || vg_node_is_in_block(block, v)) continue;
    if (s->n_touching == MOST_TOUCHING) {
      s->n_touching = 0;
      return VG_OK;
    }
    if (vg_reserve(&s->touching, &s->cap_touching, s->n_touching + 1,
                   sizeof *s->touching))
      return vg_fail_memory(err, "cutting a front");
    s->touching[s->n_touching++] = i;
  }
  return VG_OK;
}

static uint32_t root_of(uint32_t *parent, uint32_t k)
{
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

static int by_point(const void *a, const void *b)
{
  const uint64_t *s = a, *t = b;

  return (*s > *t) - (*s < *t);
}

/* Faces that have a point in common are of one place. The lowest of them is
 * their root. */
static vg_status unite_touching(struct search *s, struct vg_error *err)
{
  size_t m = 0;
  uint64_t *key = vg_alloc(3 * s->n_touching, sizeof *key);

  s->parent = vg_alloc(s->n_touching, sizeof *s->parent);
  if (!key || !s->parent) {
    free(key);
    return vg_fail_memory(err, "cutting a front");
  }
  for (uint32_t i = 0; i < s->n_touching; i++) {
    const uint32_t *v = s->n->front.face[s->touching[i]];

    s->parent[i] = i;
    for (int k = 0; k < 3; k++) key[m++] = (uint64_t)v[k] << 32 | i;
  }
  qsort(key, m, sizeof *key, by_point);
  for (size_t i = 1; i < m; i++) {
    uint32_t a = (uint32_t)key[i - 1], b = (uint32_t)key[i];

    if (key[i - 1] >> 32 != key[i] >> 32) continue;
    a = root_of(s->parent, a);
    b = root_of(s->parent, b);
    s->parent[a > b ? a : b] = a > b ? b : a;
  }
  free(key);
  return VG_OK;
}

static void widen(struct place *p, const struct place *by)
{
  for (int k = 0; k < 3; k++) {
    p->lo[k] = fmin(p->lo[k], by->lo[k]);
    p->hi[k] = fmax(p->hi[k], by->hi[k]);
  }
  p->n_face += by->n_face;
}

static void place_of_face(const struct search *s, uint32_t face,
                          struct place *out)
{
  double middle[3], h;

  out->n_face = 1;
  for (int k = 0; k < 3; k++) {
    extent_of(s, face, k, &out->lo[k], &out->hi[k]);
    middle[k] = 0.5 * (out->lo[k] + out->hi[k]);
  }
  h = margin * vg_sizing_at(s->sizing, middle);
  for (int k = 0; k < 3; k++) {
    out->lo[k] -= h;
    out->hi[k] += h;
  }
}

static vg_status make_places(struct search *s, struct vg_error *err)
{
  uint32_t *place = vg_alloc(s->n_touching, sizeof *place);
  vg_status st = place ? VG_OK : vg_fail_memory(err, "cutting a front");

  for (uint32_t i = 0; st == VG_OK && i < s->n_touching; i++) {
    uint32_t root = root_of(s->parent, i);
    struct place one;

    place_of_face(s, s->touching[i], &one);
    if (root != i) {
      widen(&s->place[place[root]], &one);
      continue;
    }
    if (vg_reserve(&s->place, &s->cap_place, s->n_place + 1,
                   sizeof *s->place)) {
      st = vg_fail_memory(err, "cutting a front");
      break;
    }
    place[i] = (uint32_t)s->n_place;
    s->place[s->n_place++] = one;
  }
  free(place);
  return st;
}

static int overlap(const struct place *a, const struct place *b)
{
  if (!a->n_face || !b->n_face) return 0;
  for (int k = 0; k < 3; k++)
    if (a->lo[k] >= b->hi[k] || b->lo[k] >= a->hi[k]) return 0;
  return 1;
}

/* Until no two overlap. */
static void merge_places(struct search *s)
{
  int again = 1;

  while (again) {
    again = 0;
    for (size_t a = 0; a < s->n_place; a++)
      for (size_t b = a + 1; b < s->n_place; b++) {
        if (!overlap(&s->place[a], &s->place[b])) continue;
        widen(&s->place[a], &s->place[b]);
        s->place[b].n_face = 0;
        again = 1;
      }
  }
}

static void box_region(const struct place *p, struct vg_region *r)
{
  memset(r, 0, sizeof *r);
  for (int k = 0; k < 3; k++) {
    r->wall[r->n_wall].normal[k] = 1;
    r->wall[r->n_wall++].offset = p->lo[k];
    r->wall[r->n_wall].normal[k] = -1;
    r->wall[r->n_wall++].offset = -p->hi[k];
  }
}

static vg_status to_regions(const struct search *s, struct vg_region **region,
                            size_t *n_region, struct vg_error *err)
{
  *region = vg_alloc(s->n_place, sizeof **region);
  if (!*region) return vg_fail_memory(err, "cutting a front");
  for (size_t k = 0; k < s->n_place; k++)
    if (s->place[k].n_face && s->place[k].n_face <= MOST_FACES)
      box_region(&s->place[k], &(*region)[(*n_region)++]);
  return VG_OK;
}

vg_status vg_node_open_places(const struct vg_partition *p,
                              const struct vg_node *n,
                              struct vg_region **region, size_t *n_region,
                              struct vg_error *err)
{
  struct search s = { .n = n, .sizing = p->sizing };
  int n_axis = 0;
  vg_status st;

  *region = NULL;
  *n_region = 0;
  /* planes that none crosses are grown whole: there is nothing to add */
  for (int k = 0; k < 3; k++) n_axis += n->lattice.n[k] > 0;
  if (n_axis < 2) return VG_OK;
  VG_TRY(list_touching(&s, err));
  if (!s.n_touching) goto done;
  VG_TRY(unite_touching(&s, err));
  VG_TRY(make_places(&s, err));
  if (s.n_place > MOST_PLACES) goto done;
  merge_places(&s);
  st = to_regions(&s, region, n_region, err);
done:
  free(s.touching);
  free(s.parent);
  free(s.place);
  return st;
}
