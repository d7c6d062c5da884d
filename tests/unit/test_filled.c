/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The result of the kernel: serialized and restored, and each of its defects,
 * which must be detected. */
#include "zone_scene.h"

#include "base/bytes.h"

/* --- bytes --------------------------------------------------------------- */

static void same_array(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

static void same(const struct vg_filled *a, const struct vg_filled *b,
                 int cells)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_cell, b->n_cell);
  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_consumed, b->n_consumed);
  assert_int_equal(a->n_hole, b->n_hole);
  assert_memory_equal(&a->volume, &b->volume, sizeof a->volume);
  same_array(a->x, b->x, a->n_point, sizeof *a->x);
  same_array(a->face, b->face, a->n_face, sizeof *a->face);
  same_array(a->consumed, b->consumed, a->n_consumed, sizeof *a->consumed);
  if (cells) same_array(a->cell, b->cell, a->n_cell, sizeof *a->cell);
  else assert_null(b->cell);
}

/* Reads from an exact-size copy, so that the sanitizer detects reads beyond its
 * end. */
static void is_refused(const void *bytes, size_t n, int cells)
{
  const struct vg_filled empty = VG_FILLED_INIT;
  unsigned char *copy = vg_alloc(n, 1);
  struct vg_reader r = { .data = copy, .n = n };
  struct vg_filled f;

  assert_non_null(copy);
  if (n) memcpy(copy, bytes, n);
  vg_filled_get(&r, &f, cells);
  assert_true(r.bad);
  assert_memory_equal(&f, &empty, sizeof f);
  free(copy);
}

/* Impossible numbers of points, cells, faces and consumed faces; those of cells
 * only if there are cells. */
static void wrong_numbers_are_refused(struct vg_writer *w, int cells)
{
  const uint64_t huge[4] = { UINT64_MAX, (uint64_t)1 << 61, UINT32_MAX,
                             1 << 20 };

  for (size_t k = 0; k < 4; k++)
    for (int i = 0; i < 4 && (k != 1 || cells); i++) {
      unsigned char *at = w->bytes.data + 8 * k, keep[8];

      memcpy(keep, at, 8);
      memcpy(at, &huge[i], 8);
      is_refused(w->bytes.data, w->bytes.n, cells);
      memcpy(at, keep, 8);
    }
}

static void there_and_back(const struct vg_filled *f, int cells)
{
  struct vg_writer w = { .cap = 0 };
  struct vg_reader r = { .bad = 0 };
  struct vg_filled back;

  vg_filled_put(&w, f, cells);
  vg_filled_put(&w, f, cells);
  assert_false(w.refused);
  r.data = w.bytes.data;
  r.n = w.bytes.n;
  for (int k = 0; k < 2; k++) { /* one after the other */
    vg_filled_get(&r, &back, cells);
    assert_false(r.bad);
    same(f, &back, cells);
    vg_filled_release(&back);
  }
  assert_int_equal(r.at, r.n);
  for (size_t n = 0; n < w.bytes.n / 2; n++) is_refused(w.bytes.data, n, cells);
  w.bytes.n /= 2;
  wrong_numbers_are_refused(&w, cells);
  vg_filled_get(&r, &back, cells);
  assert_true(r.bad);
  r.at = 0; /* bad stays bad */
  vg_filled_get(&r, &back, cells);
  assert_true(r.bad);
  assert_null(back.x);
  free(w.bytes.data);
}

static void as_bytes(void **state)
{
  double x[2][3] = { { 1, 2, 3 }, { 4, 5, 6 } };
  uint32_t cell[3][4] = { { 0, 1, 2, 9 }, { 4, 5, 10, 3 }, { 6, 7, 9, 10 } };
  uint32_t face[3][3] = { { 0, 1, 2 }, { 9, 8, 7 }, { 3, 4, 10 } };
  uint32_t consumed[4] = { 1, 5, 6, 8 };
  const struct vg_filled f = { .n_point = 2,
                               .n_cell = 3,
                               .n_face = 3,
                               .n_consumed = 4,
                               .x = x,
                               .cell = cell,
                               .face = face,
                               .consumed = consumed,
                               .n_hole = 7,
                               .volume = 0.125 };
  const struct vg_filled empty = VG_FILLED_INIT;

  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    there_and_back(&f, cells);
    there_and_back(&empty, cells);
  }
}

/* --- defects ------------------------------------------------------------- */

/* A box so small that the separator zone needs its whole front, which is
 * closed. */
static void zone_of_box(struct scene *s, struct zone_part *p,
                        struct vg_filled *made)
{
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  const struct vg_region r = plane_at(2, 0.03);

  *made = (struct vg_filled)VG_FILLED_INIT;
  box_scene(s, 4);
  zone_select(s, &r, p);
  assert_int_equal(p->front.n_face, s->front.n_face);
  assert_int_equal(zone_make(s, p, &r, &options, made, NULL), VG_OK);
  assert_true(made->n_cell > 40 && made->n_face > 40);
  assert_true(made->n_consumed > 10 && made->n_point > 0);
  assert_int_equal(vg_filled_defects(&p->front, made, 1), 0);
}

static void swap(uint32_t *a, uint32_t *b)
{
  uint32_t keep = *a;

  *a = *b;
  *b = keep;
}

/* A cell that is inverted, flat, or has a corner that does not exist. */
static void bad_cells_are_detected(void **state)
{
  struct vg_filled f;
  struct zone_part p;
  struct scene s;
  uint32_t keep;

  (void)state;
  zone_of_box(&s, &p, &f);
  swap(&f.cell[3][0], &f.cell[3][1]);
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 1);
  swap(&f.cell[7][2], &f.cell[7][1]);
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 2);
  swap(&f.cell[3][0], &f.cell[3][1]);
  swap(&f.cell[7][2], &f.cell[7][1]);
  keep = f.cell[0][2];
  f.cell[0][2] = f.cell[0][3];
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 1);
  f.cell[0][2] = (uint32_t)(p.front.n_point + f.n_point);
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 1);
  f.cell[0][2] = UINT32_MAX;
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 1);
  f.cell[0][2] = keep;
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 0);
  vg_filled_release(&f);
  zone_part_release(&p);
  scene_end(&s);
}

/* A front that is not closed has three unbalanced edges for each face that is
 * missing, reversed, or duplicated. */
static void open_fronts_are_detected(void **state)
{
  struct vg_filled f;
  struct zone_part p;
  struct scene s;
  uint32_t keep;

  (void)state;
  zone_of_box(&s, &p, &f);
  f.n_face--; /* a new face is missing */
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 3);
  f.n_face++;
  swap(&f.face[9][0], &f.face[9][2]); /* one is reversed */
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 3);
  swap(&f.face[9][0], &f.face[9][2]);
  f.n_consumed--; /* one is not consumed */
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 3);
  f.n_consumed++;
  keep = f.face[9][1]; /* no such point */
  f.face[9][1] = (uint32_t)(p.front.n_point + f.n_point);
  assert_true(vg_filled_defects(&p.front, &f, 1) > 0);
  f.face[9][1] = keep;
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 0);
  vg_filled_release(&f);
  zone_part_release(&p);
  scene_end(&s);
}

/* A region gets only the part of a front that it needs, which is open; the
 * boundary of its cells is closed all the same. */
static void open_parts_of_a_front_are_no_defect(void **state)
{
  struct vg_filled f;
  struct zone_part p;
  struct scene s;
  size_t next = 0, n = 0;

  (void)state;
  zone_of_box(&s, &p, &f);
  for (size_t i = 0; i < p.front.n_face; i++) {
    int is_consumed = next < f.n_consumed && f.consumed[next] == i;

    if (!is_consumed && i % 2) continue;
    if (is_consumed) f.consumed[next++] = (uint32_t)n;
    memmove(p.front.face[n++], p.front.face[i], sizeof *p.front.face);
  }
  assert_true(n < p.front.n_face);
  p.front.n_face = n;
  assert_true(vg_front_open_edges(&p.front) > 0);
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 0);
  vg_filled_release(&f);
  zone_part_release(&p);
  scene_end(&s);
}

/* Consumed faces are a set, in ascending order, of faces that exist. */
static void bad_lists_are_detected(void **state)
{
  struct vg_filled f;
  struct zone_part p;
  struct scene s;
  uint32_t keep;

  (void)state;
  zone_of_box(&s, &p, &f);
  swap(&f.consumed[4], &f.consumed[5]);
  assert_true(vg_filled_defects(&p.front, &f, 1) > 0);
  swap(&f.consumed[4], &f.consumed[5]);
  keep = f.consumed[4];
  f.consumed[4] = f.consumed[3];
  assert_true(vg_filled_defects(&p.front, &f, 1) > 0);
  f.consumed[4] = keep;
  keep = f.consumed[f.n_consumed - 1];
  f.consumed[f.n_consumed - 1] = (uint32_t)p.front.n_face;
  assert_true(vg_filled_defects(&p.front, &f, 1) > 0);
  f.consumed[f.n_consumed - 1] = keep;
  assert_int_equal(vg_filled_defects(&p.front, &f, 1), 0);
  vg_filled_release(&f);
  zone_part_release(&p);
  scene_end(&s);
}

/* A filled void leaves no front: neither list may contain a face. */
static void nothing_is_left_without_a_region(void **state)
{
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  uint32_t face[1][3] = { { 0, 1, 2 } }, consumed[2] = { 0, 1 };
  struct vg_filled f = VG_FILLED_INIT;
  struct zone_part p;
  struct scene s;

  (void)state;
  box_scene(&s, 4);
  zone_select(&s, NULL, &p);
  assert_int_equal(zone_make(&s, &p, NULL, &options, &f, NULL), VG_OK);
  assert_null(f.face);
  assert_null(f.consumed);
  assert_int_equal(vg_filled_defects(&p.front, &f, 0), 0);
  swap(&f.cell[3][0], &f.cell[3][1]);
  assert_int_equal(vg_filled_defects(&p.front, &f, 0), 1);
  swap(&f.cell[3][0], &f.cell[3][1]);
  f.n_face = 1;
  f.face = face;
  assert_int_equal(vg_filled_defects(&p.front, &f, 0), 1);
  f.n_consumed = 2;
  f.consumed = consumed;
  assert_int_equal(vg_filled_defects(&p.front, &f, 0), 3);
  f.face = NULL;
  f.consumed = NULL;
  vg_filled_release(&f);
  zone_part_release(&p);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(as_bytes),
    cmocka_unit_test(bad_cells_are_detected),
    cmocka_unit_test(open_fronts_are_detected),
    cmocka_unit_test(open_parts_of_a_front_are_no_defect),
    cmocka_unit_test(bad_lists_are_detected),
    cmocka_unit_test(nothing_is_left_without_a_region),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
