/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matching of faces, edges and positions shared by slices. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/union_find.h"
#include "core/judge/judge_slices_parts.h"

/* --- faces ---------------------------------------------------------------- */

static void add_edge(struct vg_judge_worker *w, uint32_t a, uint32_t b)
{
  struct vg_edge_item *e = vg_item_blocks_add(&w->edge, sizeof *e);

  if (!e) {
    w->st = vg_fail_memory(&w->err, "the edges between slices");
    return;
  }
  e->node[0] = a < b ? a : b;
  e->node[1] = a < b ? b : a;
  e->ratio = -1;
}

/* Exclude the edges of a face on the boundary of the checked cells from the
 * statistics. */
static void bar_edges(struct vg_judge_worker *w, const struct vg_face_item *f)
{
  const uint32_t *n = f->node;

  add_edge(w, n[0], n[1]);
  add_edge(w, n[0], n[2]);
  if (n[3] == VG_NO_NODE) {
    add_edge(w, n[1], n[2]);
    return;
  }
  add_edge(w, n[1], n[3]);
  add_edge(w, n[2], n[3]);
}

/* A face that does not join exactly two sides may have further cells, which a
 * slice has already matched with each other. */
static void add_suspect(struct vg_judge_worker *w, const struct vg_face_item *f)
{
  struct vg_face_key *key = vg_items_add(&w->suspect, sizeof *key);

  if (key) memcpy(key, f->node, sizeof *key);
  else w->st = vg_fail_memory(&w->err, "the faces between slices");
}

/* Match a face in the whole mesh (q = VG_JUDGED_WHOLE) or in the field alone.
 */
static void match_face(const struct vg_slices_judgement *j,
                       struct vg_judge_worker *w, int q,
                       const struct vg_face_item *f, size_t n)
{
  const struct vg_face_item *pair[2] = { f, f };
  size_t n_cell = 0, n_boundary = 0, n_seen;

  for (size_t i = 0; i < n; i++) {
    int is_cell = !(f[i].flags & VG_FACE_BOUNDARY);

    if (q == VG_JUDGED_FIELD && !(f[i].flags & VG_FACE_FIELD)) continue;
    n_seen = n_cell + n_boundary;
    if (n_seen < 2) pair[n_seen] = &f[i];
    n_cell += is_cell;
    n_boundary += !is_cell;
  }
  n_seen = n_cell + n_boundary;
  if (!n_seen) return;
  if (q == VG_JUDGED_WHOLE && (n_seen != 2 || !n_cell)) add_suspect(w, f);
  if (j->sizing && j->edges_of == q &&
      (q == VG_JUDGED_FIELD ? n_cell == 1 : n_boundary > 0))
    bar_edges(w, f);
  if (!vg_stats_face(w->figures[q], n_cell, n_boundary,
                     !((pair[0]->flags ^ pair[1]->flags) & VG_FACE_WINDING)))
    return;
  vg_union(w->parent[q], pair[0]->component, pair[1]->component);
  vg_stats_ratio(w->figures[q], pair[0]->volume, pair[1]->volume);
}

static void meet_face(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  struct vg_slices_judgement *j = context;

  for (int q = 0; q < j->n_judged; q++)
    match_face(j, &j->worker[worker], q, (const void *)item, n);
}

/* A face is complete with two sides, unless there are suspect faces. */
static int is_whole_face(const void *context, const unsigned char *item,
                         size_t n)
{
  const struct vg_slices_judgement *j = context;

  (void)item;
  return n == 2 && !j->n_suspect;
}

static vg_status worst_status(struct vg_slices_judgement *j,
                              struct vg_error *err)
{
  for (int i = 0; i < j->n_worker; i++) {
    if (j->worker[i].st >= 0) continue;
    if (err) *err = j->worker[i].err;
    return j->worker[i].st;
  }
  return VG_OK;
}

struct boundary {
  struct vg_slices_judgement *j;
  const struct vg_rendezvous *m;
};

static void boundary_body(void *context, size_t first, size_t end, int worker)
{
  const struct boundary *c = context;
  const struct vg_mesh *b = c->j->s->boundary;
  struct vg_judge_worker *w = &c->j->worker[worker];
  int me = vg_comm_rank(c->j->comm);

  for (size_t i = first; i < end && w->st >= 0; i++) {
    uint32_t node[4];
    struct vg_face_item f = { .component = 0 }, *to;

    if (i < b->n_tri) {
      memcpy(node, b->tri[i], sizeof *b->tri);
      node[3] = VG_NO_NODE;
    } else memcpy(node, b->quad[i - b->n_tri], sizeof *b->quad);
    vg_face_item_set(&f, node);
    if (vg_rendezvous_rank(c->m, &f) != me) continue;
    f.flags |= VG_FACE_BOUNDARY;
    to = vg_item_blocks_add(&w->face, sizeof f);
    if (to) *to = f;
    else w->st = vg_fail_memory(&w->err, "the faces of the boundary");
  }
}

/* Add the faces of the boundary, which all ranks know, that are matched on
 * this rank. */
static vg_status add_boundary(struct vg_slices_judgement *j,
                              const struct vg_rendezvous *m,
                              struct vg_error *err)
{
  struct boundary c = { j, m };

  vg_parallel_for(j->threads, j->s->boundary->n_tri + j->s->boundary->n_quad,
                  4096, boundary_body, &c);
  return worst_status(j, err);
}

/* Least number of faces that a thread hands over at once. */
enum { HANDED_FACES = 1 << 13 };

/* Two cells of the layers, or two of the field. A face between both waits until
 * the end, since it counts as a boundary of the field. */
static int is_pair(const void *context, const unsigned char *item, size_t n)
{
  const struct vg_face_item *f = (const void *)item;

  (void)context;
  return n == 2 && !((f[0].flags ^ f[1].flags) & VG_FACE_FIELD);
}

/* The figures of the field are added to those of the whole mesh later. */
static void meet_pair(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  const struct vg_slices_judgement *j = context;
  struct vg_judge_worker *w = &j->worker[worker];
  const struct vg_face_item *f = (const void *)item;
  int in_field = j->n_judged > 1 && f->flags & VG_FACE_FIELD;
  struct vg_stats
    *stats = w->figures[in_field ? VG_JUDGED_FIELD : VG_JUDGED_WHOLE];

  assert(n == 2);
  if (!vg_stats_face(stats, n, 0,
                     !((f[0].flags ^ f[1].flags) & VG_FACE_WINDING)))
    return;
  vg_stats_ratio(stats, f[0].volume, f[1].volume);
  for (int q = 0; q <= in_field; q++)
    vg_union(w->parent[q], f[0].component, f[1].component);
}

/* Extend the forests of a thread to all components of this rank that faces may
 * have. */
static vg_status extend_parents(struct vg_slices_judgement *j,
                                struct vg_judge_worker *w, struct vg_error *err)
{
  size_t n = (size_t)atomic_load(&j->n_here);

  for (int q = 0; q < j->n_judged; q++) {
    if (vg_reserve(&w->parent[q], &w->room_parent[q], n, sizeof **w->parent))
      return vg_fail_memory(err, "the components of the mesh");
    for (size_t k = w->n_parent; k < n; k++) w->parent[q][k] = (uint32_t)k;
  }
  w->n_parent = n;
  return VG_OK;
}

/* Most faces between slices join two slices that are checked one shortly after
 * the other. Matching them early keeps the memory of the check small. */
vg_status vg_judge_thin(struct vg_slices_judgement *j, int worker,
                        struct vg_error *err)
{
  struct vg_judge_worker *w = &j->worker[worker];
  struct vg_rendezvous m = {
    j->comm, 1, sizeof(struct vg_face_item), 4 * sizeof(uint32_t), meet_pair, j,
    is_pair
  };
  struct vg_item_blocks all;
  vg_status st;

  if (j->n_suspect || vg_item_blocks_n(&w->face) < HANDED_FACES) return VG_OK;
  st = vg_waiting_items_add(&j->waiting, &w->face, &all, err);
  if (st < 0 || !all.n_block) return st;
  st = extend_parents(j, w, err);
  if (st >= 0) st = vg_rendezvous_thin(&m, worker, &all, err);
  if (st >= 0) return vg_waiting_items_return(&j->waiting, &all, err);
  vg_item_blocks_release(&all);
  return st;
}

/* Take the faces that still wait, and convert the component numbers of this
 * rank to those of the mesh. */
static vg_status number_components(struct vg_slices_judgement *j,
                                   struct vg_error *err)
{
  vg_status st = vg_item_blocks_join(&j->worker[0].face, &j->waiting.items,
                                     err);

  for (int i = 0; i < j->n_worker; i++) {
    const struct vg_item_blocks *list = &j->worker[i].face;

    for (size_t b = 0; b < list->n_block; b++) {
      struct vg_face_item *f = (void *)list->block[b].data;

      for (size_t k = 0; k < list->block[b].n; k++)
        f[k].component += (uint32_t)j->first_here;
    }
  }
  return st;
}

static vg_status meet_faces(struct vg_slices_judgement *j, struct vg_error *err)
{
  struct vg_rendezvous m = { j->comm,
                             j->threads,
                             sizeof(struct vg_face_item),
                             4 * sizeof(uint32_t),
                             meet_face,
                             j,
                             is_whole_face };
  size_t bytes = 0;
  vg_status st = number_components(j, err);

  j->waiting.most = 0;
  if (st >= 0) st = add_boundary(j, &m, err);
  VG_TRY(vg_comm_agree(j->comm, st, err));
  for (int i = 0; i < j->n_worker; i++)
    bytes += vg_item_blocks_n(&j->worker[i].face) * m.size;
  VG_TRY(vg_rendezvous_blocks(&m, &j->worker[0].face, (size_t)j->n_worker,
                              sizeof *j->worker, err));
  vg_judge_note_bytes(j, bytes); /* edges were added before faces were freed */
  st = vg_comm_agree(j->comm, worst_status(j, err), err);
done:
  return st;
}

/* --- edges and positions -------------------------------------------------- */

static void meet_edge(void *context, const unsigned char *item, size_t n,
                      int worker)
{
  struct vg_slices_judgement *j = context;
  struct vg_stats *f = j->worker[worker].figures[j->edges_of];
  const struct vg_edge_item *e = (const void *)item;
  double least = e[0].ratio, most = least;

  for (size_t i = 1; i < n; i++) {
    if (e[i].ratio < least) least = e[i].ratio;
    if (e[i].ratio > most) most = e[i].ratio;
  }
  if (least >= 0) vg_stats_edge(f, least);
  if (j->in_metric && most >= 0) vg_stats_length(f, most);
}

static void meet_place(void *context, const unsigned char *item, size_t n,
                       int worker)
{
  struct vg_slices_judgement *j = context;

  (void)item;
  j->worker[worker].figures[VG_JUDGED_WHOLE]->n.duplicate_point += n - 1;
}

/* Points that may coincide: their positions have equal keys. */
static void meet_place_key(void *context, const unsigned char *item, size_t n,
                           int worker)
{
  struct vg_slices_judgement *j = context;
  struct vg_judge_worker *w = &j->worker[worker];
  uint64_t *key;

  if (n == 1) return;
  key = vg_items_add(&w->crowd, sizeof *key);
  if (key) memcpy(key, item, sizeof *key);
  else w->st = vg_fail_memory(&w->err, "coincident points");
}

static vg_status meet_edges(struct vg_slices_judgement *j, struct vg_error *err)
{
  struct vg_rendezvous m = { j->comm,
                             j->threads,
                             sizeof(struct vg_edge_item),
                             2 * sizeof(uint32_t),
                             meet_edge,
                             j,
                             NULL };

  return vg_rendezvous_blocks(&m, &j->worker[0].edge, (size_t)j->n_worker,
                              sizeof *j->worker, err);
}

static int by_key(const void *a, const void *b)
{
  uint64_t x, y;

  memcpy(&x, a, sizeof x);
  memcpy(&y, b, sizeof y);
  return (x > y) - (x < y);
}

/* Gather from all ranks the keys of the positions that several points may
 * have. */
static vg_status gather_crowds(struct vg_slices_judgement *j,
                               struct vg_bytes *out, struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(j->comm);
  struct vg_items mine = { 0 }, got = { 0 };
  struct vg_bytes *all = vg_calloc(size, sizeof *all), b;
  vg_status st = all ? VG_OK : vg_fail_memory(err, "coincident points");

  for (int i = 0; i < j->n_worker && st >= 0; i++)
    st = vg_items_append(&mine, &j->worker[i].crowd, sizeof(uint64_t), err);
  VG_TRY(vg_comm_agree(j->comm, st, err));
  b = (struct vg_bytes){ mine.n * sizeof(uint64_t), mine.data };
  VG_TRY(vg_comm_allgather(j->comm, &b, all, err));
  for (size_t r = 0; r < size && st >= 0; r++) {
    struct vg_items one = { all[r].n / sizeof(uint64_t), 0, all[r].data };

    st = vg_items_append(&got, &one, sizeof(uint64_t), err);
  }
  if (got.n) qsort(got.data, got.n, sizeof(uint64_t), by_key);
  *out = (struct vg_bytes){ got.n, got.data };
  got.data = NULL;
  st = vg_comm_agree(j->comm, st, err);
done:
  vg_bytes_release(all, size);
  vg_items_release(&mine);
  vg_items_release(&got);
  return st;
}

/* The positions of points that may coincide with another point. */
struct crowd {
  struct vg_slices_judgement *j;
  const struct vg_bytes *key; /* n keys, sorted */
  struct vg_items place;
};

static vg_status list_crowded(void *context, const struct vg_slice *s,
                              struct vg_error *err)
{
  struct crowd *c = context;

  for (size_t i = 0; i < s->n_own; i++) {
    struct vg_place_item place = vg_place_item(s->x[s->own[i]]), *to;
    uint64_t key = vg_rendezvous_hash(&place, sizeof place);

    if (!bsearch(&key, c->key->data, c->key->n, sizeof key, by_key)) continue;
    to = vg_items_add(&c->place, sizeof *to);
    if (!to) return vg_fail_memory(err, "coincident points");
    *to = place;
  }
  return VG_OK;
}

static vg_status count_duplicates(struct vg_slices_judgement *j,
                                  const struct vg_bytes *key,
                                  struct vg_error *err)
{
  struct vg_rendezvous m = { j->comm,
                             j->threads,
                             sizeof(struct vg_place_item),
                             sizeof(struct vg_place_item),
                             meet_place,
                             j,
                             NULL };
  struct crowd c = { j, key, { 0 } };
  vg_status st = vg_slices_each(j->s, 1, list_crowded, &c, err);

  VG_TRY(vg_comm_agree(j->comm, st, err));
  st = vg_rendezvous_run(&m, &c.place, 1, sizeof c.place, err);
done:
  vg_items_release(&c.place);
  return st;
}

/* Only the keys of positions are exchanged, a third of their bytes. The
 * positions themselves are only compared if keys are equal, which in a good
 * mesh happens only accidentally. */
static vg_status meet_places(struct vg_slices_judgement *j,
                             struct vg_error *err)
{
  struct vg_rendezvous m = {
    j->comm, j->threads, sizeof(uint64_t), sizeof(uint64_t), meet_place_key,
    j,       NULL
  };
  struct vg_bytes crowd = { 0, NULL };
  vg_status st;

  VG_TRY(vg_rendezvous_blocks(&m, &j->worker[0].place, (size_t)j->n_worker,
                              sizeof *j->worker, err));
  st = vg_comm_agree(j->comm, worst_status(j, err), err);
  if (st >= 0) st = gather_crowds(j, &crowd, err);
  if (st >= 0 && crowd.n) st = count_duplicates(j, &crowd, err);
done:
  free(crowd.data);
  return st;
}

vg_status vg_judge_match(struct vg_slices_judgement *j, struct vg_error *err)
{
  vg_status st;

  VG_TRY(meet_places(j, err)); /* first: meeting faces adds edges */
  VG_TRY(vg_judge_solver_match(j, err));
  if (j->has_dual) VG_TRY(vg_judge_dual_match(j, err));
  VG_TRY(meet_faces(j, err));
  if (j->sizing) VG_TRY(meet_edges(j, err));
done:
  return st;
}

/* --- components ----------------------------------------------------------- */

struct link {
  uint32_t a, b;
};

/* Links that this rank found between components of slices. */
static vg_status list_links(const struct vg_slices_judgement *j, int q,
                            struct vg_bytes *out, struct vg_error *err)
{
  uint32_t *parent = j->worker[0].parent[q];
  struct link *link;
  size_t n = 0;

  for (int w = 1; w < j->n_worker; w++)
    for (uint32_t i = 0; i < j->n_all; i++)
      vg_union(parent, i, j->worker[w].parent[q][i]);
  for (uint32_t i = 0; i < j->n_all; i++) n += parent[i] != i;
  link = vg_alloc(n, sizeof *link);
  if (!link) return vg_fail_memory(err, "the components of the mesh");
  n = 0;
  for (uint32_t i = 0; i < j->n_all; i++) {
    if (parent[i] == i) continue;
    link[n++] = (struct link){ i, parent[i] };
  }
  out->data = (unsigned char *)link;
  out->n = n * sizeof *link;
  return VG_OK;
}

static size_t join_links(uint32_t *parent, uint64_t n_all,
                         const struct vg_bytes *all, int size)
{
  size_t n_joined = 0;

  for (uint32_t i = 0; i < n_all; i++) parent[i] = i;
  for (int r = 0; r < size; r++) {
    const struct link *link = (const void *)all[r].data;

    for (size_t i = 0; i < all[r].n / sizeof *link; i++)
      n_joined += (size_t)vg_union(parent, link[i].a, link[i].b);
  }
  return n_joined;
}

static vg_status count_joined(struct vg_slices_judgement *j, int q,
                              size_t *n_joined, struct vg_error *err)
{
  int size = vg_comm_size(j->comm);
  struct vg_bytes mine = { 0, NULL };
  struct vg_bytes *all = vg_calloc((size_t)size, sizeof *all);
  vg_status st = all ? list_links(j, q, &mine, err)
                     : vg_fail_memory(err, "the components of the mesh");

  VG_TRY(vg_comm_agree(j->comm, st, err));
  VG_TRY(vg_comm_allgather(j->comm, &mine, all, err));
  *n_joined = join_links(j->worker[0].parent[q], j->n_all, all, size);
done:
  vg_bytes_release(all, size);
  free(mine.data);
  return st;
}

vg_status vg_judge_components(struct vg_slices_judgement *j,
                              size_t *n_component, struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(n_component && j->n_judged > 0);
  for (int q = 0; q < j->n_judged; q++) {
    size_t n_joined = 0;

    VG_TRY(count_joined(j, q, &n_joined, err));
    n_component[q] = (q ? j->n_all_field : j->n_all) - n_joined;
  }
done:
  return st;
}
