/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Files written by all ranks equal those written by one rank. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <unistd.h>

#include "../unit/mixed_cut.h"
#include "io/cgns/cgns.h"
#include "io/slices/slices.h"
#include "io/slices/slices_parts.h"
#include "io/vgrid/mapbc.h"

#define N_SLICE 19
#define N_PIECE 12 /* more than there are */

enum { N_MESH = 3 };
static struct vg_mesh mesh[N_MESH]; /* tetrahedra, mixed, with hexahedra */
static struct vg_join_info info[N_MESH];

/* Distinct for this job: tests with other numbers of ranks may run at the same
 * time. */
static char all[4096], alone[4096], nowhere[4096];

static void set_stem(char stem[4096], const char *what)
{
  snprintf(stem, 4096, "%s/slices_%d_%s", VG_TMP_DIR, vg_comm_size(job), what);
}

static int set_up(void **state)
{
  if (open_job(state)) return -1;
  set_stem(all, "all");
  set_stem(alone, "alone");
  set_stem(nowhere, "no/folder");
  cut_mesh(&mesh[0], &info[0], VG_LAYER_TETS);
  cut_mesh(&mesh[1], &info[1], VG_LAYER_MIXED);
  mixed_cut_mesh(&mesh[2], &info[2]);
  return 0;
}

static int tear_down(void **state)
{
  for (int k = 0; k < N_MESH; k++) vg_mesh_release(&mesh[k]);
  return close_job(state);
}

static void same_bytes(const char *a, const char *b)
{
  FILE *f = fopen(a, "rb"), *g = fopen(b, "rb");
  long at = 0;
  int c, d;

  if (!f || !g) fail_msg("%s or %s is missing", a, b);
  do {
    c = getc(f);
    d = getc(g);
    if (c != d) fail_msg("%s and %s differ at byte %ld", a, b, at);
    at++;
  } while (c != EOF);
  fclose(f);
  fclose(g);
}

static char *path_of(const char *stem, const char *suffix)
{
  char *path;

  if (asprintf(&path, "%s.%s", stem, suffix) < 0) abort();
  return path;
}

/* Compare and remove STEM.suffix of both stems. Files that contain the names of
 * the stems are only removed. */
static void same_pair(const char *a, const char *b, const char *suffix,
                      int has_names)
{
  char *x = path_of(a, suffix), *y = path_of(b, suffix);

  if (!has_names) same_bytes(x, y);
  unlink(x);
  unlink(y);
  free(x);
  free(y);
}

static size_t same_pieces(const char *a, const char *b)
{
  size_t n = 0;

  for (size_t k = 0; k < N_PIECE; k++) {
    char *x = vg_slices_piece(a, k), *y = vg_slices_piece(b, k);

    assert_int_equal(access(x, F_OK), access(y, F_OK));
    if (!access(x, F_OK)) {
      same_bytes(x, y);
      unlink(x);
      unlink(y);
      n++;
    }
    free(x);
    free(y);
  }
  return n;
}

/* One format, distributed over the ranks and by rank 0 alone. */
static void check_form(int k, const char *form,
                       const struct vg_slices_options *o)
{
  struct vg_error err = VG_ERROR_INIT;
  size_t n_quad = k == 1 ? cut_close(&mesh[k], form) : mesh[k].n_quad;
  struct cut c;

  cut_make(&c, &mesh[k], N_SLICE, 0, &info[k], 11);
  if (!vg_comm_rank(job) &&
      vg_slices_write_with(NULL, &c.s, alone, form, o, &err) != VG_OK)
    fail_msg("%s: %s", form, err.text);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  if (vg_slices_write_with(job, &c.s, all, form, o, &err) != VG_OK)
    fail_msg("%s: %s", form, err.text);
  if (!vg_comm_rank(job)) {
    same_pair(alone, all, form, !strcmp(form, "pvtu"));
    if (!strcmp(form, "cogsg")) same_pair(alone, all, "bc", 0);
    if (!strcmp(form, "cogsg")) same_pair(alone, all, "mapbc", 1);
    if (!strcmp(form, "pvtu")) assert_true(same_pieces(alone, all) > 2);
  }
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  cut_release(&c);
  mesh[k].n_quad = n_quad;
}

static int is_built(const char *form)
{
  return strcmp(form, "cgns") != 0 || vg_cgns_is_built();
}

static void any_number_of_ranks(void **state)
{
  static const char *const form[] = { "b8.ugrid",    "lr4.ugrid", "lb8l.ugrid",
                                      "vtu",         "pvtu",      "su2",
                                      "msh",         "cgns",      "fluent.msh",
                                      "surface.vtu", "cogsg" };

  (void)state;
  for (size_t i = 0; i < sizeof form / sizeof *form; i++)
    for (int threads = 1; threads < 3 && is_built(form[i]); threads++) {
      const struct vg_slices_options o = { threads, 1, i % 2 ? 1000 : 0,
                                           400,     0, NULL };

      check_form(0, form[i], &o);
      for (int k = 1; k < N_MESH && strcmp(form[i], "cogsg") != 0; k++)
        check_form(k, form[i], &o);
    }
}

/* These files contain the names of the stems, so compare with the expected
 * text. */
static void names_and_conditions(void **state)
{
  static const char *const form[] = { "cogsg", "fun3d.mapbc", "mapbc" };
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  (void)state;
  for (int i = 0; i < 3; i++) {
    const char *suffix = i ? form[i] : "mapbc";
    char *path = path_of(all, suffix), *whole = path_of(alone, suffix);

    cut_make(&c, &mesh[0], N_SLICE, 0, &info[0], 12);
    cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
    if (vg_slices_write(job, &c.s, all, form[i], 1, &err) != VG_OK)
      fail_msg("%s: %s", form[i], err.text);
    if (!vg_comm_rank(job)) {
      assert_int_equal(i == 1 ? vg_mapbc_write(whole, &mesh[0], VG_MAPBC_FUN3D,
                                               NULL, NULL, NULL)
                              : vg_mapbc_write_output(whole, &mesh[0],
                                                      strrchr(all, '/') + 1,
                                                      NULL, NULL),
                       VG_OK);
      same_bytes(path, whole);
      unlink(path);
      unlink(whole);
    }
    free(path);
    free(whole);
    cut_release(&c);
  }
  if (!vg_comm_rank(job)) {
    char *path = path_of(all, "cogsg");

    unlink(path);
    free(path);
    path = path_of(all, "bc");
    unlink(path);
    free(path);
  }
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
}

static void boundary_is_everywhere(void **state)
{
  struct vg_mesh b = VG_MESH_INIT;
  struct cut c;

  (void)state;
  cut_make(&c, &mesh[1], N_SLICE, 0, &info[1], 13);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  assert_int_equal(vg_slices_boundary(job, &c.s, 2, &b, NULL), VG_OK);
  assert_int_equal(b.n_point, info[1].n_boundary_point);
  assert_int_equal(b.n_tri, mesh[1].n_tri);
  assert_int_equal(b.n_quad, mesh[1].n_quad);
  assert_memory_equal(b.point, mesh[1].point, b.n_point * sizeof *b.point);
  assert_memory_equal(b.tri, mesh[1].tri, b.n_tri * sizeof *b.tri);
  vg_mesh_release(&b);
  cut_release(&c);
}

static void assert_gone(const char *stem, const char *form)
{
  char *path = path_of(stem, form), *part = path_of(path, "part");

  if (!access(path, F_OK)) fail_msg("%s is there", path);
  if (!access(part, F_OK)) fail_msg("%s is there", part);
  free(path);
  free(part);
}

/* One slice of one rank cannot be read: all ranks fail, and no file is left. */
static void one_failure_fails_all_ranks(void **state)
{
  static const char *const form[] = { "b8.ugrid", "vtu",        "pvtu",
                                      "cogsg",    "su2",        "msh",
                                      "cgns",     "fluent.msh", "surface.vtu" };
  const struct vg_slices_options o = { 2, 0, 0, 400, 0, NULL };

  (void)state;
  for (size_t i = 0; i < sizeof form / sizeof *form; i++) {
    struct vg_error err = VG_ERROR_INIT;
    struct cut c;

    if (!is_built(form[i])) continue;
    cut_make(&c, &mesh[0], N_SLICE, 0, &info[0], 14);
    cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
    c.bad = 7;
    assert_true(vg_slices_write_with(job, &c.s, all, form[i], &o, &err) < 0);
    if (!strstr(err.text, "slice 7 is bad"))
      fail_msg("%s: %s", form[i], err.text);
    /* rank 0 removes the files after all ranks have reported their status */
    vg_comm_agree(job, VG_OK, NULL);
    assert_gone(all, form[i]);
    assert_gone(all, "bc");
    assert_gone(all, "mapbc");
    for (size_t k = 0; k < N_PIECE; k++) {
      char *piece = vg_slices_piece(all, k);

      assert_int_not_equal(access(piece, F_OK), 0);
      free(piece);
    }
    assert_true(vg_slices_write_with(job, &c.s, nowhere, form[i], &o, &err) <
                0);
    cut_release(&c);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(any_number_of_ranks),
    cmocka_unit_test(names_and_conditions),
    cmocka_unit_test(boundary_is_everywhere),
    cmocka_unit_test(one_failure_fails_all_ranks),
  };

  return cmocka_run_group_tests(tests, set_up, tear_down);
}
