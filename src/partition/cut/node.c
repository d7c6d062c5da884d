/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/node.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/needles.h"

uint32_t vg_partition_serial(struct vg_partition *p)
{
  uint32_t k = (uint32_t)atomic_fetch_add(&p->n_serial, 1);

  assert(p->rank >= 0 && p->rank < p->size);
  return 1 + k * (uint32_t)p->size + (uint32_t)p->rank;
}

static void drop_stage(struct vg_node *n)
{
  for (size_t k = 0; k < n->n_work; k++) {
    vg_work_free(n->work[k]);
    free(n->point[k]);
    free(n->face[k]);
    vg_change_release(&n->change[k]);
  }
  free(n->work);
  free(n->region);
  free(n->point);
  free(n->face);
  free(n->change);
  n->work = NULL;
  n->region = NULL;
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
  vg_lattice_release(&n->lattice);
  free(n->block);
  free(n->open);
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

  assert(strlen(path) < VG_PATH_MAX && front);
  if (!n) return NULL;
  snprintf(n->path, sizeof n->path, "%s", path);
  n->front = *front;
  memset(front, 0, sizeof *front);
  n->per_cube = VG_LOAD_CELLS_PER_CUBE;
  return n;
}

int vg_node_wants_cut(const struct vg_partition *p, struct vg_node *n)
{
  if (n->is_final || n->retry >= VG_RETRIES || strlen(n->path) > VG_PATH_CUT)
    return 0;
  if (!n->is_planned) {
    vg_lattice_release(&n->lattice);
    n->n_bisection = vg_lattice_plan(&n->load, &p->options.rule, n->levels,
                                     n->retry, &n->lattice);
    if (vg_crosses_needles(&n->front, &n->lattice)) n->n_bisection = 0;
  }
  n->is_planned = 1;
  return n->n_bisection > 0;
}

/* --- tasks of a stage ---------------------------------------------------- */

/* Behind the stages of the lattice: places where the void is still connected,
 * as boxes, then across x, y and z. Boxes around cells that are oblique and
 * long overlap, and those of a round do not: in a metric, there are more
 * rounds. Cells that close a place may cross other planes: all this is done
 * twice. */
enum { BOX_ROUNDS = 6, CYCLES = 2 /* C20 */, AXES = 3 };

static int box_rounds(const struct vg_partition *p)
{
  return vg_sizing_is_stretched(p->sizing) ? BOX_ROUNDS : 1;
}

static int count_stages(const struct vg_partition *p)
{
  int cycles = vg_sizing_is_stretched(p->sizing) ? CYCLES : 1;

  return VG_LATTICE_STAGES + cycles * (box_rounds(p) + AXES);
}

/* Axis of the patches of the node's stage; -1: boxes. */
static int closing_axis(const struct vg_partition *p, const struct vg_node *n)
{
  int rounds = box_rounds(p);
  int at = (n->stage - VG_LATTICE_STAGES) % (rounds + AXES);

  return at < rounds ? -1 : at - rounds;
}

static vg_status make_room(struct vg_node *n, size_t n_work,
                           struct vg_error *err)
{
  n->work = vg_calloc(n_work, sizeof *n->work);
  n->region = vg_calloc(n_work, sizeof *n->region);
  n->point = vg_calloc(n_work, sizeof *n->point);
  n->face = vg_calloc(n_work, sizeof *n->face);
  n->change = vg_calloc(n_work, sizeof *n->change);
  if (n->work && n->region && n->point && n->face && n->change) return VG_OK;
  return vg_fail_memory(err, "cutting a front");
}

/* Number of task k among the pencils or tiles of the node. */
static size_t number_of(struct vg_node *n, size_t k)
{
  if (n->stage < VG_LATTICE_TILES) return n->n_pencil++;
  if (n->stage < VG_LATTICE_STAGES) return k;
  return vg_lattice_count(&n->lattice, VG_LATTICE_TILES) + n->n_patch++;
}

/* A part with more faces than this costs more than the patches that it
 * saves. */
enum { MOST_WIDE = 100000 }; /* C9 */

/* Selects the part of the front for task i, as far as the faces reach that
 * cross the lattice's planes there. */
static vg_status select_part(struct vg_node *n, struct vg_work *w, size_t i,
                             struct vg_error *err)
{
  vg_status st;

  if (n->stage < VG_LATTICE_STAGES)
    VG_TRY(vg_select_widen(&n->select, &w->region, err));
  VG_TRY(vg_select_part(&n->select, &w->region, &w->part, &n->point[i],
                        &n->face[i], err));
  if (w->region.wide == 0 || w->part.n_face <= MOST_WIDE ||
      n->stage >= VG_LATTICE_STAGES)
    goto done;
  vg_front_release(&w->part);
  free(n->point[i]);
  free(n->face[i]);
  w->region.wide = 0;
  st = vg_select_part(&n->select, &w->region, &w->part, &n->point[i],
                      &n->face[i], err);
done:
  return st;
}

/* Selects by the boxes around runs of faces first, then by single faces.
 * n->face[i] is NULL if the boxes contain no face. */
static vg_status find_part(struct vg_node *n, struct vg_work *w, size_t i)
{
  vg_status st = select_part(n, w, i, NULL);

  if (st < 0) return st;
  if (w->part.n_face)
    return vg_select_near(&w->part, &w->region, n->select.sizing, &n->point[i],
                          &n->face[i], NULL);
  free(n->face[i]);
  n->face[i] = NULL;
  return VG_OK;
}

struct stage {
  struct vg_node *n;
  const struct vg_region *region; /* [n->n_work] Regions of the tasks. */
};

/* Selects the part of the front that each region needs. On failure n->work[k]
 * is NULL. */
static void make_works(void *context, size_t first, size_t end, int worker)
{
  const struct stage *s = context;
  struct vg_node *n = s->n;

  (void)worker;
  for (size_t k = first; k < end; k++) {
    struct vg_work *w = vg_calloc(1, sizeof *w);

    if (!w) continue;
    w->what = VG_WORK_ZONE;
    w->kind = n->stage < VG_LATTICE_TILES ? VG_SPAN_PENCIL : VG_SPAN_TILE;
    w->node = n;
    w->region = s->region[k];
    if (find_part(n, w, k) < 0) vg_work_free(w);
    else n->work[k] = w;
  }
}

/* Keeps the tasks whose boxes contain a part of the front, and names them. */
static void name_works(struct vg_partition *p, struct vg_node *n)
{
  size_t left = 0;

  for (size_t k = 0; k < n->n_work; k++) {
    struct vg_work *w = n->work[k];

    if (!n->face[k]) {
      vg_work_free(w);
      free(n->point[k]);
      continue;
    }
    snprintf(w->path, sizeof w->path, "%.*s%c%zu", VG_PATH_MAX - 12, n->path,
             w->kind, number_of(n, k));
    w->serial = vg_partition_serial(p);
    w->index = left;
    n->work[left] = w;
    n->region[left] = w->region;
    n->point[left] = n->point[k];
    n->face[left++] = n->face[k];
  }
  n->n_work = left;
}

static vg_status add_works(struct vg_partition *p, struct vg_node *n,
                           size_t count, const struct vg_region *region,
                           const struct vg_engine *e, struct vg_error *err)
{
  struct stage s = { n, region };

  n->n_work = count;
  vg_engine_loop(e, count, 1, make_works, &s);
  for (size_t k = 0; k < count; k++)
    if (!n->work[k]) return vg_fail_memory(err, "cutting a front");
  name_works(p, n);
  return VG_OK;
}

/* Distributes the expected cells of a plane evenly among its tiles. The
 * estimate affects only the order of tasks. */
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

/* Lists the regions of the node's stage. */
static vg_status list_regions(struct vg_partition *p, struct vg_node *n,
                              const struct vg_engine *e,
                              struct vg_region **region, size_t *count,
                              struct vg_error *err)
{
  *region = NULL;
  if (n->stage >= VG_LATTICE_STAGES)
    return vg_node_open_places(p, n, closing_axis(p, n), e, region, count, err);
  *count = vg_lattice_count(&n->lattice, n->stage);
  *region = vg_alloc(*count, sizeof **region);
  if (!*region) return vg_fail_memory(err, "cutting a front");
  for (size_t k = 0; k < *count; k++)
    vg_lattice_region(&n->lattice, n->stage, k, &(*region)[k]);
  return VG_OK;
}

static vg_status prepare_stage(struct vg_partition *p, struct vg_node *n,
                               const struct vg_engine *e, struct vg_error *err)
{
  struct vg_region *region;
  size_t count;
  vg_status st = list_regions(p, n, e, &region, &count, err);

  if (st == VG_OK && count) st = vg_select_update(&n->select, e, err);
  if (st == VG_OK && count) st = make_room(n, count, err);
  if (st == VG_OK && count) st = add_works(p, n, count, region, e, err);
  if (st == VG_OK) estimate_works(n);
  free(region);
  return st;
}

static vg_status prepare(struct vg_partition *p, struct vg_node *n,
                         const struct vg_engine *e, struct vg_error *err)
{
  const int stages = count_stages(p);
  vg_status st = VG_OK;

  for (; !n->n_work && n->stage < stages && st == VG_OK; n->stage++) {
    drop_stage(n);
    st = prepare_stage(p, n, e, err);
  }
  n->n_left = n->n_work;
  return st;
}

/* Nothing to cut: the void is its only child, to be filled whole. */
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
                        const struct vg_engine *e, struct vg_error *err)
{
  vg_status st;

  assert(!n->n_work && !n->work && !n->n_child);
  if (n->to_part) return vg_node_part(p, n, e, err);
  n->stage = 0;
  if (!vg_node_wants_cut(p, n)) return keep_whole(n, err);
  if (!n->retry)
    VG_TRY(vg_lattice_add_ribs(&n->load, &p->options.rule, &n->lattice, err));
  vg_select_init(&n->select, &n->front, p->sizing);
  VG_TRY(prepare(p, n, e, err));
  if (!n->n_work) {
    vg_select_release(&n->select);
    st = keep_whole(n, err);
  }
done:
  return st;
}

vg_status vg_node_join(struct vg_partition *p, struct vg_node *n,
                       const struct vg_engine *e, struct vg_error *err)
{
  vg_status st;

  assert(n->n_work && !n->n_left && !n->n_child);
  VG_TRY(vg_node_put(p, n, e, err));
  drop_stage(n);
  VG_TRY(prepare(p, n, e, err));
  if (!n->n_work) {
    vg_select_release(&n->select);
    st = vg_node_split(p, n, e, err);
  }
done:
  return st;
}
