/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The front of a void that is being cut, on fronts built by hand: front
 * updates, open places where blocks are still connected, and the division into
 * children. */
#include "io_support.h"

#include <pthread.h>

#include "fill_shapes.h"
#include "partition/cut/node.h"
#include "partition/engine/engine_memory.h"

/* --- scenes -------------------------------------------------------------- */

struct scene {
  struct vg_partition p;
  struct vg_sizing *sizing;
  struct vg_node *n;
  struct vg_front was; /* a copy of the front */
};

static void copy_front(struct vg_front *to, const struct vg_front *from)
{
  *to = (struct vg_front)VG_FRONT_INIT;
  assert_int_equal(vg_front_append(to, from, NULL), VG_OK);
}

/* Cut at x = 0 and y = 0. */
static void scene_of(struct scene *s, struct vg_mesh *m)
{
  const struct vg_front front = vg_front_of(m);
  struct vg_front f = VG_FRONT_INIT;

  memset(s, 0, sizeof *s);
  pthread_mutex_init(&s->p.lock, NULL);
  s->p.options = (struct vg_partition_options)VG_PARTITION_OPTIONS_INIT;
  s->p.options.rule.leaf_cells = 10;
  s->p.size = 1;
  s->sizing = shape_sizing(m, 1.2, 1);
  s->p.sizing = s->sizing;
  f.n_point = m->n_point;
  f.n_face = m->n_tri;
  f.x = vg_alloc(m->n_point, sizeof *f.x);
  f.id = vg_alloc(m->n_point, sizeof *f.id);
  f.face = vg_alloc(m->n_tri, sizeof *f.face);
  assert_true(f.x && f.id && f.face);
  memcpy(f.x, m->point, m->n_point * sizeof *f.x);
  memcpy(f.face, m->tri, m->n_tri * sizeof *f.face);
  for (size_t k = 0; k < m->n_point; k++) f.id[k] = VG_POINT_ID(0, k);
  copy_front(&s->was, &f);
  s->n = vg_node_new("0", &f);
  assert_non_null(s->n);
  assert_int_equal(vg_load_new(&front, s->sizing, VG_LOAD_CELLS_PER_CUBE, 1,
                               &s->n->load, NULL),
                   VG_OK);
  s->n->lattice.n[0] = s->n->lattice.n[1] = 1;
  vg_mesh_release(m);
}

static void scene_end(struct scene *s)
{
  vg_node_free(s->n);
  vg_front_release(&s->was);
  vg_sizing_free(s->sizing);
  pthread_mutex_destroy(&s->p.lock);
}

static void add_box(struct vg_mesh *m, int n, double x, double y, double half)
{
  const int count[3] = { n, n, n };
  const double lo[3] = { x - half, y - half, -half };
  const double hi[3] = { x + half, y + half, half };

  shape_block(m, count, lo, hi, shape_all);
}

/* A box in each of the four blocks, n edges of length 1 wide. */
static void four_boxes(struct vg_mesh *m, int n)
{
  *m = (struct vg_mesh)VG_MESH_INIT;
  for (int k = 0; k < 4; k++)
    add_box(m, n, k % 2 ? n : -n, k / 2 ? n : -n, 0.5 * n);
}

/* A small box that reaches from block 0 to block 1. */
static void bridge(struct vg_mesh *m, double y)
{
  add_box(m, 2, 0.1, y, 1);
}

/* --- invariants ---------------------------------------------------------- */

/* Each child has the faces of its blocks in their order, and points in the
 * order of their use. child: of each block. */
static void dealt_out(const struct scene *s, const struct vg_front *was,
                      const int child[4])
{
  const struct vg_node *n = s->n;
  size_t at[4] = { 0 }, seen[4] = { 0 };

  for (size_t i = 0; i < was->n_face; i++) {
    const uint32_t *v = was->face[i];
    const struct vg_front *c;
    uint32_t b;

    if (v[0] == VG_FACE_GONE) continue;
    b = vg_lattice_block(&n->lattice, was->x[v[0]], 0);
    c = &n->child[child[b]]->front;
    assert_true(at[child[b]] < c->n_face);
    for (int k = 0; k < 3; k++) {
      uint32_t p = c->face[at[child[b]]][k];

      assert_true(p <= seen[child[b]]);
      seen[child[b]] += p == seen[child[b]];
      assert_int_equal(c->id[p], was->id[v[k]]);
      assert_memory_equal(c->x[p], was->x[v[k]], sizeof *c->x);
    }
    at[child[b]]++;
  }
  for (size_t k = 0; k < n->n_child; k++) {
    assert_int_equal(n->child[k]->front.n_face, at[k]);
    assert_int_equal(n->child[k]->front.n_point, seen[k]);
    assert_true(n->child[k]->is_planned);
  }
}

static int crosses(const struct vg_front *f, size_t i)
{
  int below[2] = { 0, 0 };

  if (f->face[i][0] == VG_FACE_GONE) return 0;
  for (int axis = 0; axis < 2; axis++)
    for (int k = 0; k < 3; k++) {
      double x = f->x[f->face[i][k]][axis];

      below[axis] |= x < 0 ? 1 : x > 0 ? 2 : 3;
    }
  return below[0] == 3 || below[1] == 3;
}

/* The list of open faces equals that of a loop over all faces, in ascending
 * order. */
static void lists_open(struct vg_node *n)
{
  size_t k = 0;

  assert_int_equal(vg_node_list_open(n, NULL, NULL), VG_OK);
  for (size_t i = 0; i < n->front.n_face; i++)
    if (crosses(&n->front, i)) {
      assert_true(k < n->n_open);
      assert_int_equal(n->open[k++], i);
    }
  assert_int_equal(n->n_open, k);
}

/* --- division ------------------------------------------------------------ */

/* n 20: 19,200 faces, several chunks of each loop. */
static void a_front_splits_into_blocks(void **state)
{
  const int child[4] = { 0, 1, 2, 3 };

  (void)state;
  for (int n = 4; n <= 20; n += 16) {
    struct vg_mesh m;
    struct scene s;

    four_boxes(&m, n);
    scene_of(&s, &m);
    assert_int_equal(vg_node_put(&s.p, s.n, NULL, NULL), VG_OK);
    lists_open(s.n);
    assert_int_equal(s.n->n_open, 0);
    assert_int_equal(vg_node_split(&s.p, s.n, NULL, NULL), VG_OK);
    assert_int_equal(s.n->n_child, 4);
    dealt_out(&s, &s.was, child);
    for (int k = 0; k < 4; k++) {
      const struct vg_node *c = s.n->child[k];

      assert_int_equal(c->path[2], '0' + k);
      assert_true(fabs(vg_front_volume(&c->front) / pow(n, 3) - 1) < 1e-12);
      assert_true(fabs(c->load.cells / pow(n, 3) / VG_LOAD_CELLS_PER_CUBE - 1) <
                  0.1);
    }
    scene_end(&s);
  }
}

/* Blocks 0 and 1, which form a single void now, have a load from their
 * fronts. */
static void connected_blocks_stay_together(void **state)
{
  const int child[4] = { 0, 0, 1, 2 };
  struct vg_mesh m;
  struct scene s;

  (void)state;
  four_boxes(&m, 20);
  bridge(&m, -5);
  scene_of(&s, &m);
  assert_int_equal(vg_node_put(&s.p, s.n, NULL, NULL), VG_OK);
  lists_open(s.n);
  assert_true(s.n->n_open > 0);
  assert_int_equal(vg_node_split(&s.p, s.n, NULL, NULL), VG_OK);
  assert_int_equal(s.n->n_child, 3);
  dealt_out(&s, &s.was, child);
  for (int k = 0; k < 3; k++) {
    double volume = vg_front_volume(&s.n->child[k]->front);

    assert_true(
      fabs(s.n->child[k]->load.cells / volume / VG_LOAD_CELLS_PER_CUBE - 1) <
      0.1);
  }
  scene_end(&s);
}

/* --- open places --------------------------------------------------------- */

/* Each face that crosses a plane, except those farther than `most` from the
 * bridge, must be within a region with some margin. */
static void covered(const struct vg_node *n, const struct vg_region *r,
                    size_t n_region)
{
  for (size_t i = 0; i < n->front.n_face; i++) {
    int found = 0;

    if (!crosses(&n->front, i)) continue;
    for (size_t k = 0; k < n_region; k++) {
      int within = 1;

      for (int j = 0; j < 3; j++)
        within &= vg_region_within(&r[k], n->front.x[n->front.face[i][j]]);
      found += within;
    }
    assert_int_equal(found, 1);
  }
}

/* Two separate bridges: two boxes, or two patches of the plane x = 0; none of y
 * = 0. Removed faces cause no place. */
static void places_are_found(void **state)
{
  struct vg_region *r;
  struct vg_mesh m;
  struct scene s;
  size_t n_region;

  (void)state;
  four_boxes(&m, 30);
  bridge(&m, -5);
  bridge(&m, 8);
  scene_of(&s, &m);
  assert_int_equal(vg_node_put(&s.p, s.n, NULL, NULL), VG_OK);
  for (int axis = -1; axis < 1; axis++) {
    assert_int_equal(vg_node_open_places(&s.p, s.n, axis, NULL, &r, &n_region,
                                         NULL),
                     VG_OK);
    assert_int_equal(n_region, 2);
    covered(s.n, r, n_region);
    for (size_t k = 0; k < n_region; k++)
      assert_int_equal(r[k].n_plane, axis + 1);
    free(r);
  }
  for (int axis = 1; axis < 3; axis++) {
    assert_int_equal(vg_node_open_places(&s.p, s.n, axis, NULL, &r, &n_region,
                                         NULL),
                     VG_OK);
    assert_int_equal(n_region, 0);
    free(r);
  }
  for (size_t k = 0; k < s.n->n_open; k++) {
    uint32_t *v = s.n->front.face[s.n->open[k]];

    if (s.n->front.x[v[0]][1] < 0) v[0] = VG_FACE_GONE;
  }
  assert_int_equal(vg_node_open_places(&s.p, s.n, -1, NULL, &r, &n_region,
                                       NULL),
                   VG_OK);
  assert_int_equal(n_region, 1);
  covered(s.n, r, n_region);
  free(r);
  lists_open(s.n);
  scene_end(&s);
}

/* If the load expects many cells in a corner of a box, that box is not an open
 * place; patches still are. */
static void patches_stay_open_near_many_cells(void **state)
{
  const double at[3] = { 0.1 + 1.3, -5 + 1.9, 1.9 };
  struct vg_region *r;
  struct vg_mesh m;
  struct scene s;
  size_t n_region;

  (void)state;
  four_boxes(&m, 30);
  bridge(&m, -5);
  scene_of(&s, &m);
  assert_int_equal(vg_node_put(&s.p, s.n, NULL, NULL), VG_OK);
  for (int k = 0; k < 3; k++) {
    struct vg_load_octant *c = &s.n->load.octant[0];

    if (k)
      *c = (struct vg_load_octant){ { (float)at[0], (float)at[1],
                                      (float)at[2] },
                                    0.1f,
                                    0.01f,
                                    { 0.01f, 0.01f, 0.01f },
                                    1,
                                    1e6f };
    assert_int_equal(vg_node_open_places(&s.p, s.n, k > 1 ? 0 : -1, NULL, &r,
                                         &n_region, NULL),
                     VG_OK);
    assert_int_equal(n_region, k != 1);
    free(r);
  }
  scene_end(&s);
}

/* --- front updates ------------------------------------------------------- */

/* Work i has made a cell on face `gone` of the front, with a new point above it
 * and three new faces. */
static void cell_on(struct vg_node *n, size_t i, uint32_t gone, uint32_t serial)
{
  struct vg_change *c = &n->change[i];
  struct vg_filled *f = &c->made;

  *c = (struct vg_change){ .serial = serial,
                           .n_part = 3,
                           .made = { .n_point = 1,
                                     .n_face = 3,
                                     .n_cell = 1,
                                     .n_consumed = 1,
                                     .volume = 0.25 } };
  n->point[i] = vg_alloc(3, sizeof **n->point);
  n->face[i] = vg_alloc(1, sizeof **n->face);
  f->x = vg_calloc(1, sizeof *f->x);
  f->face = vg_alloc(3, sizeof *f->face);
  f->consumed = vg_calloc(1, sizeof *f->consumed);
  assert_true(n->point[i] && n->face[i] && f->x && f->face && f->consumed);
  n->face[i][0] = gone;
  memcpy(n->point[i], n->front.face[gone], 3 * sizeof **n->point);
  for (int k = 0; k < 3; k++) {
    f->face[k][0] = (uint32_t)k;
    f->face[k][1] = (uint32_t)(k + 1) % 3;
    f->face[k][2] = 3;
    for (int j = 0; j < 3; j++) f->x[0][j] += n->front.x[n->point[i][k]][j] / 3;
  }
}

static void works_of(struct vg_node *n, size_t count)
{
  n->n_work = count;
  n->work = vg_calloc(count, sizeof *n->work);
  n->region = vg_calloc(count, sizeof *n->region);
  n->point = vg_calloc(count, sizeof *n->point);
  n->face = vg_calloc(count, sizeof *n->face);
  n->change = vg_calloc(count, sizeof *n->change);
  assert_true(n->work && n->region && n->point && n->face && n->change);
}

/* Changes are applied in the order of the works. Added faces that cross planes
 * are listed too, without visiting the earlier faces again. */
static void changes_are_applied(void **state)
{
  enum { WORKS = 5 };
  struct vg_mesh m;
  struct scene s;
  struct vg_node *n;

  (void)state;
  four_boxes(&m, 8);
  bridge(&m, -5);
  scene_of(&s, &m);
  n = s.n;
  assert_int_equal(vg_node_put(&s.p, n, NULL, NULL), VG_OK);
  lists_open(n);
  works_of(n, WORKS);
  for (uint32_t i = 0; i < WORKS; i++)
    cell_on(n, i, i < 2 ? n->open[3 * i] : 7 * i, 9 - i);
  n->change[WORKS - 1].blocked = 1;
  assert_int_equal(vg_node_put(&s.p, n, NULL, NULL), VG_OK);
  assert_int_equal(n->front.n_point, s.was.n_point + WORKS);
  assert_int_equal(n->front.n_face, s.was.n_face + 3 * WORKS);
  assert_true(n->separator_cells == WORKS && n->zone_volume == WORKS * 0.25);
  assert_int_equal(n->n_blocked, 1);
  for (uint32_t i = 0; i < WORKS; i++) {
    size_t new = s.was.n_point + i;
    uint32_t gone = i < 2 ? n->open[3 * i] : 7 * i;

    assert_int_equal(n->front.id[new], VG_POINT_ID(9 - i, 0));
    assert_int_equal(n->front.face[gone][0], VG_FACE_GONE);
    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t *v = n->front.face[s.was.n_face + 3 * i + k];

      assert_int_equal(v[0], s.was.face[gone][k]);
      assert_int_equal(v[1], s.was.face[gone][(k + 1) % 3]);
      assert_int_equal(v[2], new);
    }
  }
  lists_open(n);
  scene_end(&s);
}

/* Two cells on one face. */
static void faces_are_consumed_once(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  struct scene s;

  (void)state;
  four_boxes(&m, 4);
  scene_of(&s, &m);
  works_of(s.n, 2);
  for (uint32_t i = 0; i < 2; i++) cell_on(s.n, i, 7, 5 + i);
  assert_int_equal(vg_node_put(&s.p, s.n, NULL, &err), VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "1 faces of the front were consumed twice"));
  scene_end(&s);
}

/* --- changes that intersect the front ------------------------------------ */

/* A box with edges of 1 at x = -6, and a fine one at the origin, 1 away from
 * the zone. At the spacing there, this is farther than the part of the front
 * that a zone is given. */
static void coarse_and_fine(struct scene *s, double half)
{
  struct vg_mesh m = VG_MESH_INIT;

  add_box(&m, 2, -6, 0, 1);
  add_box(&m, 2, 0, 0, half);
  scene_of(s, &m);
  vg_select_init(&s->n->select, &s->n->front, s->sizing);
  assert_int_equal(vg_node_put(&s->p, s->n, NULL, NULL), VG_OK);
  assert_int_equal(vg_select_update(&s->n->select, NULL, NULL), VG_OK);
}

/* The face of the coarse box towards the fine one with its middle nearest to
 * (-5, -0.5, -0.5). */
static uint32_t face_towards(const struct vg_front *f)
{
  uint32_t best = 0;
  double least = 1e9;

  for (size_t i = 0; i < f->n_face; i++) {
    double d = 0;

    for (int k = 0; k < 3; k++) {
      const uint32_t *v = f->face[i];
      double x = (f->x[v[0]][k] + f->x[v[1]][k] + f->x[v[2]][k]) / 3;

      d += fabs(x + (k ? 0.5 : 5));
    }
    if (d < least) best = (uint32_t)i;
    least = fmin(least, d);
  }
  return best;
}

/* Apply two changes: a cell on that face with its tip at x, y, z, and one on
 * another face. */
static void put_long_cell(struct scene *s, double x, double y, double z,
                          const struct vg_region *region)
{
  const double tip[3] = { x, y, z };
  struct vg_node *n = s->n;

  works_of(n, 2);
  cell_on(n, 0, face_towards(&n->front), 5);
  cell_on(n, 1, 0, 6);
  memcpy(n->change[0].made.x, tip, sizeof tip);
  n->region[0] = n->region[1] = *region;
  s->p.report.n_zone_cell = 2;
  assert_int_equal(vg_node_put(&s->p, n, NULL, NULL), VG_OK);
}

/* A change that intersects a part of the front that its zone was not given is
 * dropped. The other change of the stage is applied, and both are if nothing
 * intersects. */
static void intersecting_changes_are_dropped(void **state)
{
  const struct vg_region r = { .n_plane = 1, .plane = { { { 0, 1, 0 }, -1 } } };

  (void)state;
  for (int is_crossing = 0; is_crossing < 2; is_crossing++) {
    struct scene s;
    size_t left = 0;
    uint32_t gone;

    coarse_and_fine(&s, 0.2);
    gone = face_towards(&s.n->front);
    put_long_cell(&s, 5, is_crossing ? 0.5 : -1.5, 0.5, &r);
    assert_int_equal(s.n->front.face[gone][0] == VG_FACE_GONE, !is_crossing);
    assert_int_equal(s.n->front.face[0][0], VG_FACE_GONE);
    for (size_t i = 0; i < s.n->front.n_face; i++)
      left += s.n->front.face[i][0] != VG_FACE_GONE;
    assert_int_equal(left, s.was.n_face + (is_crossing ? 2 : 4));
    assert_int_equal(s.n->n_blocked, is_crossing);
    assert_true(s.n->separator_cells == 2 - is_crossing);
    assert_int_equal(s.p.report.n_crossing, is_crossing);
    assert_int_equal(s.p.report.n_blocked, is_crossing);
    assert_int_equal(s.p.report.n_zone_cell, 2 - is_crossing);
    assert_int_equal(s.p.n_drop, is_crossing);
    if (is_crossing) assert_int_equal(s.p.drop[0], 5);
    lists_open(s.n);
    free(s.p.drop);
    scene_end(&s);
  }
}

/* A body that the zone was not given may intersect no face of a cell and still
 * be inside the cell, or just outside. */
static void cells_containing_a_body_are_dropped(void **state)
{
  static const struct {
    double half, aside[2];
    int is_limited;
  } is[] = { { 0.05, { 0, 0 }, 1 },      { 1e-3, { 0, 0 }, 1 },
             { 1e-3, { 0.1, 0.1 }, 1 },  { 1e-3, { 0.5, 0 }, 0 },
             { 1e-3, { -0.4, 0.4 }, 0 }, { 1e-3, { 0, -0.9 }, 0 } };
  const struct vg_region r = { .n_plane = 1, .plane = { { { 0, 1, 0 }, -1 } } };

  (void)state;
  for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
    struct scene s;
    double tip[2] = { 0, 0 };
    uint32_t gone;

    coarse_and_fine(&s, is[k].half);
    gone = face_towards(&s.n->front);
    for (int j = 0; j < 6; j++)
      tip[j % 2] -= s.n->front.x[s.n->front.face[gone][j / 2]][1 + j % 2] / 3;
    put_long_cell(&s, 5, tip[0] + 2 * is[k].aside[0],
                  tip[1] + 2 * is[k].aside[1], &r);
    assert_int_equal(s.p.report.n_crossing, is[k].is_limited);
    assert_int_equal(s.n->front.face[gone][0] == VG_FACE_GONE,
                     !is[k].is_limited);
    free(s.p.drop);
    scene_end(&s);
  }
}

/* Cells of dropped zones are removed; the others keep their order. */
static void dropped_cells_are_forgotten(void **state)
{
  struct vg_partition p = { .size = 1 };
  const struct vg_change c = { .serial = 5, .made.n_cell = 3 };
  struct vg_spans spans = VG_SPANS_INIT;

  (void)state;
  pthread_mutex_init(&p.lock, NULL);
  p.report.n_zone_cell = 10;
  p.n_piece = p.cap_piece = 3;
  p.piece = vg_calloc(3, sizeof *p.piece);
  assert_non_null(p.piece);
  for (uint32_t k = 0; k < 3; k++) {
    struct vg_span span = { .kind = VG_SPAN_TILE, .n_cell = 3 + k };

    snprintf(span.path, sizeof span.path, "0T%d", (int)k);
    assert_int_equal(vg_spans_add(&spans, &span, NULL), VG_OK);
    memcpy(p.piece[k].path, span.path, sizeof span.path);
    p.piece[k].serial = 4 + k;
    assert_int_equal(vg_packed_cells_new(0, NULL, 1, &p.piece[k].cell), 0);
  }
  assert_int_equal(vg_partition_drop(&p, NULL, &spans, NULL), VG_OK);
  assert_int_equal(p.n_piece, 3);
  assert_int_equal(spans.span[1].n_cell, 4);
  assert_int_equal(vg_partition_note_drop(&p, &c, NULL), VG_OK);
  assert_int_equal(p.report.n_zone_cell, 7);
  assert_int_equal(vg_partition_drop(&p, NULL, &spans, NULL), VG_OK);
  assert_int_equal(p.n_piece, 2);
  for (size_t k = 0; k < 3; k++)
    assert_int_equal(spans.span[k].n_cell, k == 1 ? 0 : 3 + k);
  vg_spans_release(&spans);
  assert_int_equal(p.piece[0].serial, 4);
  assert_int_equal(p.piece[1].serial, 6);
  for (int k = 0; k < 2; k++) vg_piece_release(&p.piece[k]);
  free(p.piece);
  free(p.drop);
  pthread_mutex_destroy(&p.lock);
}

/* --- arrays -------------------------------------------------------------- */

static void arrays_keep_what_is_in_use(void **state)
{
  size_t cap = 0, n = 0;
  uint32_t *a = NULL;

  (void)state;
  for (size_t need = 1; need < 3000000; need = 3 * need + 1) {
    assert_int_equal(vg_engine_reserve(NULL, &a, &cap, n, need, sizeof *a), 0);
    assert_true(cap >= need);
    for (size_t k = 0; k < n; k++) assert_true(a[k] == 5 * (uint32_t)k);
    for (; n < need; n++) a[n] = 5 * (uint32_t)n;
  }
  assert_int_equal(vg_engine_reserve(NULL, &a, &cap, n, SIZE_MAX / 2,
                                     sizeof *a),
                   -1);
  assert_true(a[n - 1] == 5 * (uint32_t)(n - 1));
  vg_engine_free(NULL, 1, (void *const[]){ a });
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_front_splits_into_blocks),
    cmocka_unit_test(connected_blocks_stay_together),
    cmocka_unit_test(places_are_found),
    cmocka_unit_test(patches_stay_open_near_many_cells),
    cmocka_unit_test(changes_are_applied),
    cmocka_unit_test(faces_are_consumed_once),
    cmocka_unit_test(intersecting_changes_are_dropped),
    cmocka_unit_test(cells_containing_a_body_are_dropped),
    cmocka_unit_test(dropped_cells_are_forgotten),
    cmocka_unit_test(arrays_keep_what_is_in_use),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
