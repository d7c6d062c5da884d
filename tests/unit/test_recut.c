/* Voids of the advancing partition that are cut elsewhere, because a part of
 * them cannot be filled. */
#define _GNU_SOURCE
#include "advance_support.h"
#include "refuse_support.h"

#include <pthread.h>

#include "core/recover/cdt_server.h"
#include "partition/cut/node.h"

/* --- which void ---------------------------------------------------------- */

static void the_next_larger_void(void **state)
{
  static const struct { const char *leaf, *path; int is_part; } is[] = {
    { "0.3.1.0", "0.3.1", 1 }, { "0.3.1.r", "0.3.1", 1 },
    { "0.3+.1", "0.3+", 1 }, { "0.3+.1+", "0.3+", 1 }, { "0.12", "0", 0 },
    { "0", "0", 0 }, { "0+", "0+", 0 }, { "0.3.1.2~", "0.3.1", 1 },
    { "0.3.1~.0", "0.3", 1 }, { "0.3.1~.0.1.2", "0.3", 1 },
    { "0.3~.1.1", "0", 0 } };
  char path[VG_PATH_MAX];

  (void)state;
  for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
    assert_int_equal(vg_recut_path(is[k].leaf, path), is[k].is_part);
    assert_string_equal(path, is[k].path);
  }
}

/* --- fronts -------------------------------------------------------------- */

/* Two cells on one triangle, in the points of one piece or of two. */
static struct vg_piece piece_of(size_t n_cell, const uint32_t (*cell)[4])
{
  static const double x[5][3] = {
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, -1} };
  struct vg_piece q = { .serial = 7, .n_in = 5, .n_cell = n_cell };

  q.in = vg_alloc(5, sizeof *q.in);
  q.x = vg_alloc(5, sizeof *q.x);
  q.cell = vg_alloc(n_cell, sizeof *q.cell);
  assert_true(q.in && q.x && q.cell);
  for (uint32_t k = 0; k < 5; k++) q.in[k] = VG_POINT_NAME(3, 9 - k);
  memcpy(q.x, x, sizeof x);
  memcpy(q.cell, cell, n_cell * sizeof *cell);
  return q;
}

/* Of one piece, and put together from two in either order, the same. */
static void what_bounds_cells(void **state)
{
  static const uint32_t cell[2][4] = { {0, 1, 2, 3}, {0, 2, 1, 4} };
  struct vg_piece both = piece_of(2, cell);
  struct vg_front whole = VG_FRONT_INIT;

  (void)state;
  assert_int_equal(vg_recut_front(&both, &whole, NULL), VG_OK);
  assert_int_equal(whole.n_face, 6);
  assert_int_equal(whole.n_point, 5);
  assert_true(fabs(vg_front_volume(&whole) - 1. / 6 - 1. / 6) < 1e-12);
  for (int k = 0; k < 2; k++) {
    struct vg_piece one = piece_of(1, &cell[k]), two = piece_of(1, &cell[!k]);
    struct vg_front f = VG_FRONT_INIT, g = VG_FRONT_INIT;

    assert_int_equal(vg_recut_front(&one, &f, NULL), VG_OK);
    assert_int_equal(vg_recut_front(&two, &g, NULL), VG_OK);
    assert_int_equal(f.n_face + g.n_face, 8);
    assert_int_equal(f.n_point + g.n_point, 8);
    assert_int_equal(vg_front_join(&f, &g, NULL), VG_OK);
    assert_int_equal(vg_front_weld(&f, NULL), VG_OK);
    assert_int_equal(vg_recut_settle(&f, NULL), VG_OK);
    assert_int_equal(f.n_face, whole.n_face);
    assert_int_equal(f.n_point, whole.n_point);
    assert_memory_equal(f.x, whole.x, 5 * sizeof *f.x);
    assert_memory_equal(f.name, whole.name, 5 * sizeof *f.name);
    assert_memory_equal(f.face, whole.face, 6 * sizeof *f.face);
    vg_front_release(&f);
    vg_front_release(&g);
    vg_piece_release(&one);
    vg_piece_release(&two);
  }
  assert_int_equal(vg_front_join(&whole, &whole, NULL), VG_OK);
  assert_int_equal(vg_front_weld(&whole, NULL), VG_OK);
  assert_int_equal(vg_recut_settle(&whole, NULL), VG_ERR_GEOMETRY);
  vg_front_release(&whole);
  vg_piece_release(&both);
}

/* --- whole runs ---------------------------------------------------------- */

static void refuse(const struct refusal *one, const struct refusal *two)
{
  n_refusal = 1 + (two != NULL);
  refusal[0] = *one;
  if (two) refusal[1] = *two;
}

/* A valid mesh, the same in any order, in threads, and when resumed. Returns
 * what happened. */
static struct vg_partition_report always(const struct scene *s)
{
  const char *dir = VG_TMP_DIR "/redo_run";
  struct vg_partition_options o = options_of(2000, 1, 0);
  struct vg_partition_report first, r;
  struct mesh_digest expect = run_of(NULL, s, &o, 1, &first), d;

  assert_true(n_refused > 0);
  remove_folder(dir);
  o.threads = 3;
  o.job = job_digest(1);
  for (int resume = 0; resume < 2; resume++) {
    o.shuffle = resume ? 5 : 77;
    assert_int_equal(open_store(NULL, dir, 1, resume, &o.store, NULL), VG_OK);
    d = run_of(NULL, s, &o, 0, &r);
    same_digest(&expect, &d);
    assert_int_equal(r.n_elsewhere, first.n_elsewhere);
    assert_int_equal(r.n_elsewhere_cell, first.n_elsewhere_cell);
    assert_int_equal(r.cuts_elsewhere, first.cuts_elsewhere);
    assert_int_equal(r.n_zone_cell, first.n_zone_cell);
    if (resume && !r.cuts_elsewhere) assert_true(r.n_found + 4 > n_task(&r));
    vg_store_close(o.store, resume);
  }
  return first;
}

static void only_the_void(void **state)
{
  struct vg_partition_report r;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  refuse(&refuse_once, NULL);
  r = always(&s);
  assert_int_equal(r.n_elsewhere, 1);
  assert_true(r.n_elsewhere_cell > 1000 && r.n_elsewhere_cell < 4000);
  assert_int_equal(r.cuts_elsewhere, 0);
  refuse(&refuse_once, &refuse_once_too);
  r = always(&s);
  assert_int_equal(r.n_elsewhere, 2);
  assert_int_equal(r.cuts_elsewhere, 0);
  scene_end(&s);
}

static void then_the_next_larger_one(void **state)
{
  struct vg_partition_report r;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  refuse(&refuse_twice, NULL);
  r = always(&s);
  assert_int_equal(r.n_elsewhere, 2);
  assert_int_equal(r.cuts_elsewhere, 0);
  scene_end(&s);
}

static void then_the_whole(void **state)
{
  struct vg_partition_report r;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  refuse(&refuse_often, NULL);
  r = always(&s);
  assert_int_equal(r.cuts_elsewhere, 1);
  assert_int_equal(r.cuts_given_up, 0);
  refuse(&refuse_all, NULL);
  r = always(&s);
  assert_int_equal(r.cuts_elsewhere, 2);
  assert_int_equal(r.cuts_given_up, 1);
  assert_int_equal(r.n_leaf, 1);
  scene_end(&s);
}

/* The record goes on behind the first tasks; cells that were made for nothing
 * are in none of it. */
static void the_record_is_one(void **state)
{
  struct vg_partition_options o = options_of(2000, 2, 0);
  struct vg_spans spans = VG_SPANS_INIT;
  struct vg_partition_report r;
  struct vg_partition *p;
  struct scene s;
  uint64_t n_cell = 0, n_mesh, n_again = 0;

  (void)state;
  scene_demo(&s, "box", 40000);
  refuse(&refuse_twice, NULL);
  assert_int_equal(vg_partition_grow(NULL, &s.m, s.sizing, &o, &p, &r, &spans,
                                     NULL), VG_OK);
  for (size_t k = 0; k < spans.n; k++) {
    const struct vg_span *t = &spans.span[k];

    assert_true(t->start >= 0 && t->end <= spans.wall);
    if (t->kind == VG_SPAN_REPAIR) continue;
    n_cell += t->n_cell;
    n_again += strchr(t->path, '~') != NULL;
  }
  n_mesh = vg_partition_slices(p)->n_cell[VG_SLICE_TET];
  assert_true(n_cell > 0.99 * n_mesh && n_cell < 1.01 * n_mesh); /* repairs */
  assert_true(n_again > 4);
  vg_spans_release(&spans);
  vg_partition_free(p);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_next_larger_void),
    cmocka_unit_test(what_bounds_cells),
    cmocka_unit_test(only_the_void),
    cmocka_unit_test(then_the_next_larger_one),
    cmocka_unit_test(then_the_whole),
    cmocka_unit_test(the_record_is_one),
  };

  if (vg_cdt_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
