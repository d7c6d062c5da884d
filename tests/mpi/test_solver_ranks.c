/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Solver partitions of a mesh in slices: the same for any number of ranks and
 * threads; the files written by all ranks equal those written by one. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <unistd.h>

#include "../unit/mixed_cut.h"
#include "io/stream/metis_part.h"
#include "io/slices/slices.h"
#include "partition/solver/solver.h"

enum { N_SLICE = 17, N_PART = 6 };

/* Partitions of the whole mesh on rank 0 alone, and of all ranks. */
struct parts {
  struct vg_solver_report report;
  uint32_t *part;
};

static vg_status keep(void *context, const struct vg_slice *slice,
                      struct vg_error *err)
{
  uint32_t **at = context;

  (void)err;
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    for (size_t i = 0; i < slice->n_cell[k]; i++)
      at[k][slice->cell_at[k] + i] = slice->part[k][i] + 1;
  return VG_OK;
}

static void find_parts(struct vg_comm *comm, const struct vg_mesh *m,
                       const struct vg_slices *s, int threads,
                       uint64_t cluster_above, const char *path,
                       struct parts *out)
{
  struct vg_solver_options o = VG_SOLVER_OPTIONS_INIT;
  size_t n = mixed_n_cell(m);
  uint64_t *v = vg_calloc(n, sizeof *v);
  struct vg_solver_slices *k = NULL;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_slices parted;
  uint32_t *at[VG_SLICE_KINDS];

  o.n_part = N_PART;
  o.threads = threads;
  o.cluster_above = cluster_above;
  out->part = vg_calloc(n, sizeof *out->part);
  if (vg_solver_part_slices(comm, s, &o, &parted, &k, &out->report, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(parted.n_part, N_PART);
  at[0] = out->part;
  at[1] = at[0] + m->n_tet;
  at[2] = at[1] + m->n_pyr;
  at[3] = at[2] + m->n_pri;
  assert_int_equal(vg_slices_each(&parted, 1, keep, at, &err), VG_OK);
  for (size_t i = 0; i < n; i++) v[i] = out->part[i];
  assert_int_equal(vg_comm_sum(comm, n, v, &err), VG_OK);
  for (size_t i = 0; i < n; i++) {
    assert_in_range(v[i], 1, N_PART);
    out->part[i] = (uint32_t)v[i] - 1;
  }
  if (vg_slices_write(comm, &parted, path, "part.6", threads, &err) < 0)
    fail_msg("%s", err.text);
  vg_solver_slices_close(k);
  free(v);
}

static void same_file(const char *stem, size_t n, const uint32_t *part)
{
  char path[4200];
  FILE *f;

  snprintf(path, sizeof path, "%s.part.6", stem);
  f = fopen(path, "r");
  assert_non_null(f);
  for (size_t i = 0; i < n; i++) {
    unsigned p;

    assert_int_equal(fscanf(f, "%u", &p), 1);
    assert_int_equal(p, part[i]);
  }
  assert_int_equal(fgetc(f), '\n');
  assert_int_equal(fgetc(f), EOF);
  fclose(f);
  unlink(path);
}

enum mesh { TETS, MIXED, HEXAHEDRA };

static void check(enum mesh which, int threads, uint64_t above)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_join_info info;
  struct parts one, all;
  char alone[4096], stem[4096];
  struct cut c;
  size_t n;

  snprintf(alone, sizeof alone, "%s/solver_%d_alone_%d", VG_TMP_DIR,
           vg_comm_size(job), vg_comm_rank(job));
  snprintf(stem, sizeof stem, "%s/solver_%d_all", VG_TMP_DIR,
           vg_comm_size(job));
  if (which == HEXAHEDRA) mixed_cut_mesh(&m, &info);
  else cut_mesh(&m, &info, which == TETS ? VG_LAYER_TETS : VG_LAYER_MIXED);
  n = mixed_n_cell(&m);
  cut_make(&c, &m, N_SLICE, 0, &info, 11);
  c.s.n_layer_cell[VG_SLICE_HEX] = m.n_hex;
  find_parts(NULL, &m, &c.s, 1, above, alone, &one);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  find_parts(job, &m, &c.s, threads, above, stem, &all);
  assert_memory_equal(one.part, all.part, n * sizeof *one.part);
  assert_int_equal(one.report.n_cut, all.report.n_cut);
  assert_int_equal(one.report.n_stack_cell, all.report.n_stack_cell);
  assert_true(one.report.balance == all.report.balance);
  assert_int_equal(all.report.n_cell, n);
  assert_true(all.report.balance < 1.1);
  same_file(alone, n, one.part);
  if (!vg_comm_rank(job)) same_file(stem, n, all.part);
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  free(one.part);
  free(all.part);
  cut_release(&c);
  vg_mesh_release(&m);
}

static void same_parts_for_any_ranks_and_threads(void **state)
{
  (void)state;
  for (int threads = 1; threads < 3; threads++) {
    check(TETS, threads, 0);
    check(MIXED, threads, 0);
    check(HEXAHEDRA, threads, 0);
    check(TETS, threads, 300);
  }
}

/* An unreadable slice, more partitions than cells: all ranks learn of it. */
static void a_failure_fails_all_ranks(void **state)
{
  struct vg_solver_options o = VG_SOLVER_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_join_info info;
  struct vg_solver_slices *k = NULL;
  struct vg_solver_report r;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_slices out;
  struct cut c;

  (void)state;
  cut_mesh(&m, &info, VG_LAYER_TETS);
  cut_make(&c, &m, N_SLICE, 0, &info, 11);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  o.n_part = m.n_tet + 1;
  assert_int_equal(vg_solver_part_slices(job, &c.s, &o, &out, &k, &r, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "request 1 to"));
  o.n_part = 2;
  c.bad = 3;
  assert_int_equal(vg_solver_part_slices(job, &c.s, &o, &out, &k, &r, &err),
                   VG_ERR_IO);
  assert_non_null(strstr(err.text, "slice 3 is bad"));
  assert_null(k);
  cut_release(&c);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(same_parts_for_any_ranks_and_threads),
    cmocka_unit_test(a_failure_fails_all_ranks),
  };

  return RUN_IN_JOB(tests);
}
