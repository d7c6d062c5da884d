/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Check of one slice: measures the figures within it, and keeps the data that
 * other slices need. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/dual.h"
#include "core/judge/judge_slices_parts.h"

_Static_assert((int)VG_SLICE_HEX == VG_CELL_HEX &&
                 (int)VG_SLICE_KINDS == VG_CELL_KINDS,
               "kinds by the same number");

struct work {
  struct vg_slices_judgement *j;
  struct vg_judge_worker *w;
  const struct vg_slice *slice;
  struct vg_mesh view; /* view of the slice: borrowed points and cells */
  struct vg_stats *f;
  struct vg_unpaired unpaired;
  size_t n_cell;            /* number of cells of the slice */
  uint32_t first_component; /* number of its first component on this rank */
  int is_field;
};

static int has_field(const struct vg_slices_judgement *j)
{
  return j->n_judged > 1;
}

void vg_face_item_set(struct vg_face_item *f, const uint32_t node[4])
{
  int n = node[3] == VG_NO_NODE ? 3 : 4, low = 0;
  uint32_t next, last;

  for (int i = 1; i < n; i++)
    if (node[i] < node[low]) low = i;
  next = node[(low + 1) % n];
  last = node[(low + n - 1) % n];
  f->node[0] = node[low];
  f->node[1] = next < last ? next : last;
  f->node[2] = next < last ? last : next;
  f->node[3] = n == 3 ? VG_NO_NODE : node[(low + 2) % n];
  f->flags = next > last ? VG_FACE_WINDING : 0;
}

int vg_face_key_order(const void *a, const void *b)
{
  return memcmp(a, b, sizeof(struct vg_face_key));
}

static void item_of_local(const struct work *k, const uint32_t local[4],
                          struct vg_face_item *f)
{
  uint32_t node[4];

  for (int c = 0; c < 4; c++)
    node[c] = local[c] == VG_NO_NODE ? VG_NO_NODE : k->slice->id[local[c]];
  vg_face_item_set(f, node);
}

static int is_suspect(const void *context, const uint32_t local[4])
{
  const struct work *k = context;
  struct vg_face_item f;

  item_of_local(k, local, &f);
  return bsearch(f.node, k->j->suspect, k->j->n_suspect, sizeof *k->j->suspect,
                 vg_face_key_order) != NULL;
}

/* The arrays of a mesh are not const, but none of the checks modifies them. */
static void make_view(struct work *k)
{
  const struct vg_slice *s = k->slice;
  struct vg_mesh *m = &k->view;

  m->n_point = s->n_point;
  m->n_tet = s->n_cell[VG_SLICE_TET];
  m->n_pyr = s->n_cell[VG_SLICE_PYR];
  m->n_pri = s->n_cell[VG_SLICE_PRI];
  m->n_hex = s->n_cell[VG_SLICE_HEX];
  memcpy(&m->point, &s->x, sizeof m->point);
  memcpy(&m->tet, &s->cell[VG_SLICE_TET], sizeof m->tet);
  memcpy(&m->pyr, &s->cell[VG_SLICE_PYR], sizeof m->pyr);
  memcpy(&m->pri, &s->cell[VG_SLICE_PRI], sizeof m->pri);
  memcpy(&m->hex, &s->cell[VG_SLICE_HEX], sizeof m->hex);
}

/* Count indices out of range and points that are not finite. Returns 1 if
 * there are no such entries. */
static int check(struct work *k)
{
  const struct vg_slice *s = k->slice;
  uint64_t n_point = k->j->s->n_point, bad = vg_count_bad_index(&k->view);
  size_t lost = vg_count_not_finite(s->n_point, s->x), own = 0;

  for (size_t i = 0; i < s->n_point; i++) bad += s->id[i] >= n_point;
  for (size_t i = 0; i < s->n_own; i++) {
    if (s->own[i] >= s->n_point || s->id[s->own[i]] != s->point_at + i) {
      bad++;
      continue;
    }
    own += vg_count_not_finite(1, s->x + s->own[i]);
  }
  k->f->n.bad_index += bad;
  /* Points owned by other slices are counted there. */
  k->f->n.not_finite += own;
  return !bad && !lost;
}

/* --- points --------------------------------------------------------------- */

static void extend_box(struct vg_judge_worker *w, const double x[3])
{
  for (int c = 0; c < 3; c++) {
    if (x[c] < w->lo[c]) w->lo[c] = x[c];
    if (x[c] > w->hi[c]) w->hi[c] = x[c];
  }
}

static vg_status note_points(struct work *k, struct vg_error *err)
{
  const struct vg_slice *s = k->slice;

  for (size_t i = 0; i < s->n_own; i++) {
    const double *x = s->x[s->own[i]];
    struct vg_place_item place = vg_place_item(x);
    uint64_t *key = vg_item_blocks_add(&k->w->place, sizeof *key);

    if (!key) return vg_fail_memory(err, "the points of slices");
    *key = vg_rendezvous_hash(&place, sizeof place);
    extend_box(k->w, x);
    if (s->point_at + i < k->j->n_place)
      memcpy(k->j->place[s->point_at + i], x, sizeof *k->j->place);
  }
  return VG_OK;
}

static vg_status note_used(struct work *k, struct vg_error *err)
{
  const struct vg_slice *s = k->slice;
  uint8_t *used = vg_calloc(s->n_point, 1);

  if (!used) return vg_fail_memory(err, "the points in use");
  vg_mark_used(&k->view, used);
  for (size_t i = 0; i < s->n_point; i++) {
    uint64_t bit = UINT64_C(1) << (s->id[i] & 63);

    if (!used[i]) continue;
    for (int q = 0; q <= (k->is_field && has_field(k->j)); q++)
      __atomic_fetch_or(&k->j->used[q][s->id[i] >> 6], bit, __ATOMIC_RELAXED);
  }
  free(used);
  return VG_OK;
}

/* --- data for other slices ------------------------------------------------ */

static vg_status keep_faces(struct work *k, struct vg_error *err)
{
  for (size_t i = 0; i < k->unpaired.n_face; i++) {
    const struct vg_unpaired_face *from = &k->unpaired.face[i];
    struct vg_face_item *f = vg_item_blocks_add(&k->w->face, sizeof *f);

    if (!f) return vg_fail_memory(err, "the faces between slices");
    item_of_local(k, from->node, f);
    f->component = k->first_component + from->component;
    f->volume = from->volume;
    if (k->is_field) f->flags |= VG_FACE_FIELD;
  }
  return vg_judge_thin(k->j, (int)(k->w - k->j->worker), err);
}

static vg_status keep_edges(struct work *k, struct vg_error *err)
{
  for (size_t i = 0; i < k->unpaired.n_edge; i++) {
    const struct vg_unpaired_edge *from = &k->unpaired.edge[i];
    struct vg_edge_item *e = vg_item_blocks_add(&k->w->edge, sizeof *e);
    uint32_t a = k->slice->id[from->node[0]], b = k->slice->id[from->node[1]];

    if (!e) return vg_fail_memory(err, "the edges between slices");
    e->node[0] = a < b ? a : b;
    e->node[1] = a < b ? b : a;
    e->ratio = from->ratio;
  }
  return VG_OK;
}

/* Compare the edges of the slice with the field; in its metric, measure cells,
 * too. */
static vg_status judge_sizes(struct work *k, struct vg_error *err)
{
  const struct vg_sizing *sizing = k->j->sizing;
  struct vg_point_metrics metrics;
  vg_status st;

  if (!sizing || !(k->is_field || k->j->edges_of == VG_JUDGED_WHOLE))
    return VG_OK;
  if (!k->j->in_metric)
    return vg_judge_edges(&k->view, sizing, NULL, k->f, &k->unpaired, err);
  st = vg_point_metrics_init(&metrics, sizing, &k->view, 0, err);
  if (st < 0) return st;
  vg_judge_metric(&metrics, k->f);
  st = vg_judge_edges(&k->view, sizing, &metrics, k->f, &k->unpaired, err);
  vg_point_metrics_release(&metrics);
  return st;
}

static vg_status judge_cells(struct work *k, struct vg_error *err)
{
  struct vg_slices_judgement *j = k->j;
  const struct vg_slice *s = k->slice;
  const struct vg_flat_part part = { j->flat, s->id, s->point_at, s->n_own,
                                     s->kind > 1 };
  int classify = j->flat && (k->is_field || j->edges_of == VG_JUDGED_WHOLE);
  uint64_t first[VG_CELL_KINDS], end = 0;
  float *volume = vg_alloc(k->n_cell, sizeof *volume);
  struct vg_solver_sweep *solver = &k->w->solver;
  size_t n_component = 0;
  vg_status st = VG_OK;

  if (!volume) return vg_fail_memory(err, "the volumes of the cells");
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    first[kind] = end + s->cell_at[kind];
    end += j->s->n_cell[kind];
  }
  VG_TRY(vg_solver_begin(solver, &k->view, first, volume, k->f, err));
  vg_judge_shape(&k->view, s->cell_at[VG_SLICE_TET], classify ? &part : NULL,
                 volume, k->f, solver);
  VG_TRY(vg_judge_faces(&k->view, volume, k->f, solver, &k->unpaired,
                        &n_component, err));
  VG_TRY(vg_judge_solver_slice(j, (int)(k->w - j->worker), s, solver,
                               &k->unpaired, err));
  if (j->has_dual)
    VG_TRY(vg_judge_dual_slice(j, (int)(k->w - j->worker), s, &k->view, k->f,
                               &k->unpaired, err));
  k->first_component = (uint32_t)atomic_fetch_add(&j->n_here, n_component);
  if (k->is_field) k->w->n_field_component += n_component;
  VG_TRY(judge_sizes(k, err));
  VG_TRY(note_used(k, err));
  VG_TRY(keep_faces(k, err));
  VG_TRY(keep_edges(k, err));
done:
  free(volume);
  return st;
}

/* Note the bytes of the arrays of a slice and of the volumes of its cells. */
static void note_size(const struct work *k)
{
  const struct vg_slice *s = k->slice;
  size_t n = s->n_point * (sizeof *s->x + sizeof *s->id) +
             s->n_own * sizeof *s->own + k->n_cell * sizeof(float) +
             vg_solver_bytes(&k->view) +
             (k->j->has_dual ? vg_dual_bytes(&k->view) : 0);

  for (size_t kind = 0; kind < VG_SLICE_KINDS; kind++)
    n += s->n_cell[kind] * vg_slice_width[kind] * sizeof(uint32_t);
  if (n > k->w->slice_bytes) k->w->slice_bytes = n;
}

static vg_status judge_slice(struct vg_slices_judgement *j,
                             struct vg_judge_worker *w, size_t at,
                             struct vg_error *err)
{
  struct vg_slice slice;
  struct work k = { .j = j, .w = w, .slice = &slice };
  vg_status st = j->s->get(j->s, at, &slice, err);

  if (st < 0) return st;
  k.is_field = slice.kind != 0;
  k.f = w->figures[k.is_field && has_field(j)];
  make_view(&k);
  k.unpaired.context = &k;
  k.unpaired.is_shared = j->n_suspect ? is_suspect : NULL;
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++) {
    w->n_cell[kind] += slice.n_cell[kind];
    k.n_cell += slice.n_cell[kind];
  }
  note_size(&k);
  k.f->n.n_cell += k.n_cell;
  k.f->n.n_point += slice.n_own;
  if (!check(&k)) goto done;
  if (j->body) VG_TRY(j->body(j->context, &slice, err));
  VG_TRY(note_points(&k, err));
  if (k.n_cell) VG_TRY(judge_cells(&k, err));
done:
  vg_unpaired_release(&k.unpaired);
  j->s->put(j->s, &slice);
  return st;
}

void vg_judge_some_slices(void *context, size_t first, size_t end, int worker)
{
  struct vg_slices_judgement *j = context;
  struct vg_judge_worker *w = &j->worker[worker];

  for (size_t i = first; i < end && w->st >= 0; i++)
    w->st = judge_slice(j, w, i, &w->err);
}
