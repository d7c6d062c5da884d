#include "partition/node.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static void drop_stage(struct vg_node *n)
{
  for (size_t k = 0; k < n->n_work; k++) {
    vg_work_free(n->work[k]);
    free(n->point[k]);
    free(n->face[k]);
    vg_change_release(&n->change[k]);
  }
  free(n->work);
  free(n->point);
  free(n->face);
  free(n->change);
  n->work = NULL;
  n->point = n->face = NULL;
  n->change = NULL;
  n->n_work = 0;
}

void vg_node_free(struct vg_node *n)
{
  if (!n) return;
  drop_stage(n);
  for (size_t k = 0; k < n->n_child; k++)
    if (n->child[k] != n) vg_node_free(n->child[k]);
  free(n->child);
  vg_select_release(&n->select);
  free(n->block);
  vg_front_release(&n->front);
  vg_load_release(&n->load);
  free(n);
}

void vg_work_free(struct vg_work *w)
{
  if (!w) return;
  if (w->what == VG_WORK_START || w->what == VG_WORK_LEAF)
    vg_node_free(w->node);
  vg_front_release(&w->part);
  free(w);
}

struct vg_node *vg_node_new(const char *path, struct vg_front *front)
{
  struct vg_node *n = vg_calloc(1, sizeof *n);

  if (!n) return NULL;
  snprintf(n->path, sizeof n->path, "%s", path);
  n->front = *front;
  memset(front, 0, sizeof *front);
  n->per_cube = VG_LOAD_CELLS_PER_CUBE;
  return n;
}

int vg_node_wants_cut(const struct vg_partition *p, struct vg_node *n)
{
  if (n->is_final || n->retry >= VG_RETRIES ||
      strlen(n->path) + 8 >= VG_PATH_MAX)
    return 0;
  if (!n->is_planned)
    n->n_bisection = vg_lattice_plan(&n->load, &p->options.rule, n->levels,
                                     n->retry, &n->lattice);
  n->is_planned = 1;
  return n->n_bisection > 0;
}

/* --- the works of a stage ------------------------------------------------ */

/* Behind the stages of the lattice: places that hang together, as boxes, then
 * across x, y and z. */
enum { STAGES = VG_LATTICE_STAGES + 4 };

static vg_status make_room(struct vg_node *n, size_t n_work,
                           struct vg_error *err)
{
  n->work = vg_calloc(n_work, sizeof *n->work);
  n->point = vg_calloc(n_work, sizeof *n->point);
  n->face = vg_calloc(n_work, sizeof *n->face);
  n->change = vg_calloc(n_work, sizeof *n->change);
  if (n->work && n->point && n->face && n->change) return VG_OK;
  return vg_fail_memory(err, "cutting a front");
}

/* Its number among the pencils or tiles of the node. */
static size_t number_of(struct vg_node *n, size_t k)
{
  if (n->stage < 2) return n->n_pencil++;
  if (n->stage < VG_LATTICE_STAGES) return k;
  return vg_lattice_count(&n->lattice, 2) + n->n_patch++;
}

static vg_status add_work(struct vg_partition *p, struct vg_node *n,
                          size_t k, const struct vg_region *region,
                          struct vg_error *err)
{
  struct vg_work *w = vg_calloc(1, sizeof *w);
  size_t i = n->n_work;
  vg_status st;

  if (!w) return vg_fail_memory(err, "cutting a front");
  w->what = VG_WORK_ZONE;
  w->kind = n->stage < 2 ? VG_SPAN_PENCIL : VG_SPAN_TILE;
  w->node = n;
  w->index = i;
  w->region = *region;
  st = vg_select_part(&n->select, &w->region, &w->part, &n->point[i],
                      &n->face[i], err);
  if (st < 0 || !w->part.n_face) {
    free(n->point[i]);
    free(n->face[i]);
    n->point[i] = n->face[i] = NULL;
    vg_work_free(w);
    return st;
  }
  snprintf(w->path, sizeof w->path, "%.*s%c%zu", VG_PATH_MAX - 12, n->path,
           w->kind, number_of(n, k));
  w->serial = vg_partition_serial(p);
  n->work[n->n_work++] = w;
  return VG_OK;
}

/* What the tiles of a plane are expected to make, shared out evenly: it
 * decides the order of tasks only. */
static void estimate_works(struct vg_node *n)
{
  for (size_t i = 0; i < n->n_work; i++) {
    struct vg_work *w = n->work[i];
    const struct vg_plane *plane = &w->region.plane[0];
    int axis = plane->normal[0] > 0 ? 0 : plane->normal[1] > 0 ? 1 : 2;
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    double cells;

    if (n->stage >= VG_LATTICE_STAGES) {
      w->estimate = (double)w->part.n_face;
      continue;
    }
    cells = vg_load_zone(&n->load, axis, plane->offset, 1);
    w->estimate = w->kind == VG_SPAN_TILE
                    ? cells / ((n->lattice.n[b] + 1) * (n->lattice.n[c] + 1))
                    : 0.1 * cells / (n->lattice.n[b] + n->lattice.n[c] + 1);
  }
}

/* Regions of the node's stage. */
static vg_status list_regions(const struct vg_partition *p,
                              const struct vg_node *n,
                              struct vg_region **region, size_t *count,
                              struct vg_error *err)
{
  *region = NULL;
  if (n->stage >= VG_LATTICE_STAGES)
    return vg_node_open_places(p, n, n->stage - VG_LATTICE_STAGES - 1, region,
                               count, err);
  *count = vg_lattice_count(&n->lattice, n->stage);
  *region = vg_alloc(*count, sizeof **region);
  if (!*region) return vg_fail_memory(err, "cutting a front");
  for (size_t k = 0; k < *count; k++)
    vg_lattice_region(&n->lattice, n->stage, k, &(*region)[k]);
  return VG_OK;
}

static vg_status prepare_stage(struct vg_partition *p, struct vg_node *n,
                               struct vg_error *err)
{
  struct vg_region *region;
  size_t count;
  vg_status st = list_regions(p, n, &region, &count, err);

  if (st == VG_OK && count) st = vg_select_update(&n->select, err);
  if (st == VG_OK && count) st = make_room(n, count, err);
  for (size_t k = 0; st == VG_OK && k < count; k++)
    st = add_work(p, n, k, &region[k], err);
  if (st == VG_OK) estimate_works(n);
  free(region);
  return st;
}

static vg_status prepare(struct vg_partition *p, struct vg_node *n,
                         struct vg_error *err)
{
  vg_status st = VG_OK;

  for (; !n->n_work && n->stage < STAGES && st == VG_OK; n->stage++) {
    drop_stage(n);
    st = prepare_stage(p, n, err);
  }
  n->n_left = n->n_work;
  return st;
}

/* Nothing to cut: the void is its own only part, to be filled as it is. */
static vg_status keep_whole(struct vg_node *n, struct vg_error *err)
{
  n->child = vg_alloc(1, sizeof *n->child);
  if (!n->child) return vg_fail_memory(err, "cutting a front");
  n->child[0] = n;
  n->n_child = 1;
  n->is_final = 1;
  return VG_OK;
}

vg_status vg_node_start(struct vg_partition *p, struct vg_node *n,
                        struct vg_error *err)
{
  vg_status st;

  n->stage = 0;
  if (!vg_node_wants_cut(p, n)) return keep_whole(n, err);
  vg_select_init(&n->select, &n->front, p->sizing);
  VG_TRY(prepare(p, n, err));
  if (!n->n_work) {
    vg_select_release(&n->select);
    st = keep_whole(n, err);
  }
done:
  return st;
}

/* --- putting a stage into the front -------------------------------------- */

static uint32_t point_of(const struct vg_node *n, size_t i, size_t base,
                         uint32_t v, size_t n_part)
{
  return v < n_part ? n->point[i][v] : (uint32_t)(base + v - n_part);
}

/* Points and faces that the stage made, behind those that stay. */
static void add_change(struct vg_node *n, size_t i, size_t n_part)
{
  const struct vg_change *c = &n->change[i];
  struct vg_front *f = &n->front;
  size_t base = f->n_point;

  if (c->n_point) memcpy(f->x + base, c->x, c->n_point * sizeof *f->x);
  for (size_t k = 0; k < c->n_point; k++)
    f->name[base + k] = VG_POINT_NAME(c->serial, k);
  f->n_point += c->n_point;
  for (size_t k = 0; k < c->n_face; k++, f->n_face++)
    for (int j = 0; j < 3; j++)
      f->face[f->n_face][j] = point_of(n, i, base, c->face[k][j], n_part);
}

/* Faces that have a cell now. */
static void drop_gone(struct vg_node *n)
{
  for (size_t i = 0; i < n->n_work; i++)
    for (size_t k = 0; k < n->change[i].n_gone; k++)
      n->front.face[n->face[i][n->change[i].gone[k]]][0] = VG_FACE_GONE;
}

/* Blocks of the points that are new. */
static vg_status label_points(struct vg_node *n, struct vg_error *err)
{
  const struct vg_front *f = &n->front;

  if (vg_reserve(&n->block, &n->cap_block, f->n_point, sizeof *n->block))
    return vg_fail_memory(err, "cutting a front");
  for (; n->n_block < f->n_point; n->n_block++) {
    const double *x = f->x[n->n_block];
    uint32_t b = vg_lattice_block(&n->lattice, x, 0);

    if (vg_lattice_block(&n->lattice, x, 1) != b) b |= VG_ON_PLANE;
    n->block[n->n_block] = (uint16_t)b;
  }
  return VG_OK;
}

static vg_status put_in(struct vg_node *n, struct vg_error *err)
{
  struct vg_front *f = &n->front;
  size_t np = f->n_point, nf = f->n_face, cap_x = np, cap_name = np;
  size_t cap_face = nf;

  drop_gone(n);
  for (size_t i = 0; i < n->n_work; i++) {
    np += n->change[i].n_point;
    nf += n->change[i].n_face;
    n->zone_cells += (double)n->change[i].n_cell;
    n->zone_volume += n->change[i].volume;
    n->n_blocked += n->change[i].blocked != 0;
  }
  if (vg_reserve(&f->x, &cap_x, np, sizeof *f->x) ||
      vg_reserve(&f->name, &cap_name, np, sizeof *f->name) ||
      vg_reserve(&f->face, &cap_face, nf, sizeof *f->face))
    return vg_fail_memory(err, "cutting a front");
  for (size_t i = 0; i < n->n_work; i++)
    add_change(n, i, n->change[i].n_part);
  return label_points(n, err);
}

vg_status vg_node_join(struct vg_partition *p, struct vg_node *n,
                       struct vg_error *err)
{
  vg_status st;

  VG_TRY(put_in(n, err));
  drop_stage(n);
  VG_TRY(prepare(p, n, err));
  if (!n->n_work) {
    vg_select_release(&n->select);
    st = vg_node_split(p, n, err);
  }
done:
  return st;
}
