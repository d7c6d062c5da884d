/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Voids for the advancing partition, and the invariants of its mesh for any
 * distribution and timing of the tasks. Header only: one program per module. */
#ifndef TESTS_UNIT_ADVANCE_SUPPORT_H
#define TESTS_UNIT_ADVANCE_SUPPORT_H

#include "io_support.h"

#include <ftw.h>
#include <math.h>

#include "cli/examples/demo.h"
#include "core/judge/judge_slices.h"
#include "fill_shapes.h"
#include "io/mesh/format.h"
#include "partition/advance/advance.h"
#include "partition/cut/task_data.h"

struct scene {
  struct vg_mesh m;
  struct vg_sizing *sizing;
  double volume;
};

static inline double scene_volume(const struct vg_mesh *m)
{
  const struct vg_front f = vg_front_of(m);

  return vg_front_volume(&f);
}

static inline void scene_demo(struct scene *s, const char *name, size_t n)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;

  memset(s, 0, sizeof *s);
  if (vg_demo_make(name, n, &d, &err) < 0 ||
      vg_sizing_new(&d.sizing, d.n_source, d.source, &d.surface, &s->sizing,
                    &err) < 0)
    fail_msg("%s", err.text);
  vg_mesh_move(&s->m, &d.surface);
  vg_demo_release(&d);
  s->volume = scene_volume(&s->m);
}

static inline void scene_turn(struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_tri; i++) {
    uint32_t swap = m->tri[i][1];

    m->tri[i][1] = m->tri[i][2];
    m->tri[i][2] = swap;
  }
}

/* The boundary of a flow domain, from a file; either orientation. */
static inline void scene_file(struct scene *s, const char *path)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  memset(s, 0, sizeof *s);
  if (vg_surface_read(path, &s->m, NULL, &err) < 0) fail_msg("%s", err.text);
  if (scene_volume(&s->m) < 0) scene_turn(&s->m);
  if (vg_sizing_new(&o, 0, NULL, &s->m, &s->sizing, &err) < 0)
    fail_msg("%s", err.text);
  s->volume = scene_volume(&s->m);
}

static inline void scene_end(struct scene *s)
{
  vg_mesh_release(&s->m);
  vg_sizing_free(s->sizing);
  memset(s, 0, sizeof *s);
}

/* Options of most runs. */
static inline struct vg_partition_options options_of(double leaf, int threads,
                                                     uint64_t shuffle)
{
  struct vg_partition_options o = VG_PARTITION_OPTIONS_INIT;

  o.rule.leaf_cells = leaf;
  o.threads = threads;
  o.shuffle = shuffle;
  return o;
}

/* The load estimate expects a tenth of the actual cells. */
static inline struct vg_partition_options surprise_of(double leaf)
{
  struct vg_partition_options o = options_of(leaf, 1, 0);

  o.cells_per_cube = 0.1 * VG_LOAD_CELLS_PER_CUBE;
  return o;
}

/* --- digests ------------------------------------------------------------- */

struct item {
  uint64_t kind, number, id[4];
  double x[4][3];
};

static inline void add_item(uint64_t sum[4], const struct item *it, int at)
{
  const struct vg_digest zero = { { 0, 0 } };
  struct vg_digest d = vg_digest_of(zero, sizeof *it, it);

  sum[at] += d.word[0];
  sum[at + 1] += d.word[1];
}

/* Points and cells with their numbers. Each cell includes the coordinates of
 * its corners, so that every copy of a point counts. */
static inline void add_slice(const struct vg_slice *s, uint64_t sum[4])
{
  for (size_t k = 0; k < s->n_own; k++) {
    struct item it = { .kind = 1, .number = s->point_at + k };

    assert_true(s->id[s->own[k]] == it.number);
    memcpy(it.x[0], s->x[s->own[k]], sizeof it.x[0]);
    add_item(sum, &it, 0);
  }
  for (size_t c = 0; c < s->n_cell[VG_SLICE_TET]; c++) {
    struct item it = { .kind = 2, .number = s->cell_at[VG_SLICE_TET] + c };

    for (int i = 0; i < 4; i++) {
      uint32_t p = s->cell[VG_SLICE_TET][4 * c + (size_t)i];

      assert_true(p < s->n_point);
      it.id[i] = s->id[p];
      memcpy(it.x[i], s->x[p], sizeof it.x[i]);
    }
    add_item(sum, &it, 2);
  }
}

/* The boundary points come first, with unchanged coordinates. */
static inline void check_front(const struct vg_slice *s,
                               const struct vg_mesh *front)
{
  for (size_t k = 0; k < s->n_point; k++)
    if (s->id[k] < front->n_point)
      assert_memory_equal(s->x[k], front->point[s->id[k]], sizeof *s->x);
}

/* Sums over all slices of all ranks. They depend on the mesh, not on its
 * storage. */
struct mesh_digest {
  uint64_t n_point, n_cell, sum[4];
};

static inline struct mesh_digest digest_of(struct vg_comm *comm,
                                           const struct vg_slices *s,
                                           const struct vg_mesh *front)
{
  struct mesh_digest d = { s->n_point, s->n_cell[VG_SLICE_TET], { 0 } };
  uint64_t seen[2] = { 0, 0 };

  for (size_t i = 0; i < s->n_slice; i++) {
    struct vg_slice slice;

    assert_int_equal(s->get(s, i, &slice, NULL), VG_OK);
    assert_int_equal(slice.n_cell[VG_SLICE_PYR], 0);
    assert_int_equal(slice.n_cell[VG_SLICE_PRI], 0);
    seen[0] += slice.n_own;
    seen[1] += slice.n_cell[VG_SLICE_TET];
    check_front(&slice, front);
    add_slice(&slice, d.sum);
    s->put(s, &slice);
  }
  assert_int_equal(vg_comm_sum(comm, 4, d.sum, NULL), VG_OK);
  assert_int_equal(vg_comm_sum(comm, 2, seen, NULL), VG_OK);
  assert_true(seen[0] == s->n_point);
  assert_true(seen[1] == s->n_cell[VG_SLICE_TET]);
  return d;
}

static inline void same_digest(const struct mesh_digest *a,
                               const struct mesh_digest *b)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_cell, b->n_cell);
  assert_memory_equal(a->sum, b->sum, sizeof a->sum);
}

/* --- meshes -------------------------------------------------------------- */

/* Checks for a valid mesh of the whole void. The volume is a sum with one
 * rounding per cell, so an error of about 1e-12 at most is expected. */
static inline void check_mesh(struct vg_comm *comm, const struct scene *s,
                              const struct vg_partition *p)
{
  const struct vg_slices *slices = vg_partition_slices(p);
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_slices_judge(comm, slices, 0, s->sizing, 1, &r, NULL, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(r.is_valid, 1);
  assert_int_equal(r.unused_point, 0);
  assert_int_equal(r.orphan_boundary, 0);
  assert_true(fabs(r.volume - s->volume) < 1e-10 * s->volume);
  assert_int_equal(slices->n_boundary_point, s->m.n_point);
  assert_int_equal(slices->boundary->n_tri, s->m.n_tri);
  assert_memory_equal(slices->boundary->tri, s->m.tri,
                      s->m.n_tri * sizeof *s->m.tri);
  assert_memory_equal(slices->boundary->tri_patch, s->m.tri_patch,
                      s->m.n_tri * sizeof *s->m.tri_patch);
}

/* Tasks that leave a record. */
static inline uint64_t n_task(const struct vg_partition_report *r)
{
  return r->n_pencil + r->n_tile + r->n_leaf;
}

static inline void check_report(struct vg_comm *comm,
                                const struct vg_partition *p,
                                const struct vg_partition_report *r)
{
  const struct vg_slices *s = vg_partition_slices(p);
  uint64_t *size, in_leaf = 0;
  size_t n;

  assert_int_equal(vg_partition_leaves(p, &n, &size, NULL), VG_OK);
  for (size_t i = 0; i < n; i++) in_leaf += size[i];
  free(size);
  assert_int_equal(vg_comm_sum(comm, 1, &in_leaf, NULL), VG_OK);
  assert_true(in_leaf + r->n_zone_cell <= s->n_cell[VG_SLICE_TET]);
  assert_true(r->estimate > 0 && r->wall >= 0 && r->number >= 0);
}

static inline vg_status grow(struct vg_comm *comm, const struct scene *s,
                             const struct vg_partition_options *o,
                             struct vg_partition **p,
                             struct vg_partition_report *r,
                             struct vg_error *err)
{
  memset(r, 0, sizeof *r);
  *p = NULL;
  return vg_partition_grow(comm, &s->m, s->sizing, o, p, r, NULL, err);
}

/* Grow, check, and release. judge: 1: check all, 0: only take the digest. */
static inline struct mesh_digest run_of(struct vg_comm *comm,
                                        const struct scene *s,
                                        const struct vg_partition_options *o,
                                        int judge,
                                        struct vg_partition_report *r)
{
  struct vg_partition *p;
  struct vg_error err = VG_ERROR_INIT;
  struct mesh_digest d;

  if (grow(comm, s, o, &p, r, &err) != VG_OK) fail_msg("%s", err.text);
  d = digest_of(comm, vg_partition_slices(p), &s->m);
  if (judge) check_mesh(comm, s, p);
  check_report(comm, p, r);
  vg_partition_free(p);
  return d;
}

/* --- run directories ----------------------------------------------------- */

static inline int remove_one(const char *path, const struct stat *s, int flag,
                             struct FTW *f)
{
  (void)s, (void)flag, (void)f;
  return remove(path);
}

static inline void remove_folder(const char *dir)
{
  nftw(dir, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

static inline struct vg_digest job_digest(uint64_t run)
{
  const struct vg_digest zero = { { 0, 0 } };

  return vg_digest_of(zero, sizeof run, &run);
}

static inline vg_status open_store(struct vg_comm *comm, const char *dir,
                                   uint64_t run, int resume,
                                   struct vg_store **s, struct vg_error *err)
{
  struct vg_store_options o = {
    .dir = dir, .job = job_digest(run), .what = "a run", .resume = resume
  };

  *s = NULL;
  return vg_store_open(comm, &o, s, err);
}

/* Stop once this rank has kept this number of records; 0: at once. */
struct stopper {
  struct vg_store *store;
  uint64_t after;
};

static inline int stop_after(void *user)
{
  const struct stopper *s = user;
  struct vg_store_report r;

  vg_store_state(s->store, &r);
  return r.n_kept >= s->after;
}

#endif
