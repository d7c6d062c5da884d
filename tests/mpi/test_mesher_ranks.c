/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Other meshers in the subdomains, for all ways to decompose, on all ranks: the
 * mesh equals that of a single rank. */
#define _GNU_SOURCE
#include "digest_support.h"

#include "base/child.h"
#include "partition/advance/ways.h"

static struct vg_mesher_pool *open_mesher(const char *name, int may_lack)
{
  struct vg_mesher_pool *p = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_mesher_open(name, &p, &err) != VG_OK && !may_lack)
    fail_msg("%s", err.text);
  return p;
}

static struct vg_partition_options options(int way,
                                           struct vg_mesher_pool *mesher,
                                           int threads, uint64_t shuffle)
{
  struct vg_partition_options o = options_of(8000, threads, shuffle);

  o.maker = vg_ways[way].maker;
  o.decomposition.n_part = 5;
  o.mesher = mesher;
  return o;
}

/* The digest of rank 0's own mesh, broadcast to all. */
static struct mesh_digest alone(const struct scene *s,
                                const struct vg_partition_options *o)
{
  struct vg_partition_report r;
  struct mesh_digest d = { 0 };

  if (!vg_comm_rank(job)) d = run_of(NULL, s, o, 1, &r);
  return tell(&d);
}

/* is_whole: the mesher fills every subdomain. */
static void compare(struct vg_mesher_pool *mesher, int is_whole)
{
  struct scene s;

  scene_demo(&s, "sphere", 20000);
  for (int way = 0; way < VG_DECOMPOSITIONS; way++) {
    struct vg_partition_options o = options(way, mesher, 1, 0);
    struct mesh_digest expect = alone(&s, &o), d;
    struct vg_partition_report r;

    for (int threads = 1; threads < 3; threads++) {
      o = options(way, mesher, threads, 5 * (uint64_t)(threads - 1));
      d = run_of(job, &s, &o, 0, &r);
      same_digest(&expect, &d);
      assert_true(r.n_leaf > 2);
      assert_true(r.fill.n_other > 0);
      if (is_whole) assert_int_equal(r.fill.n_other, r.n_leaf);
    }
  }
  scene_end(&s);
}

static void tetgen(void **state)
{
  struct vg_mesher_pool *p = open_mesher("tetgen", 0);

  (void)state;
  compare(p, 1);
  vg_mesher_close(p);
}

/* HXT from gmsh's library, if it is installed. */
static void hxt(void **state)
{
  struct vg_mesher_pool *p = open_mesher("hxt", 1);

  (void)state;
  if (!p) skip();
  compare(p, 0);
  vg_mesher_close(p);
}

/* The example plug-in: it leaves voids that are not star-shaped to the
 * kernel. */
static void plug_in(void **state)
{
  struct vg_mesher_pool *p = open_mesher(VG_STAR, 0);
  struct vg_partition_report r;
  struct mesh_digest expect, d;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 5000);
  for (int way = 0; way < VG_DECOMPOSITIONS; way++) {
    struct vg_partition_options o = options(way, p, 1, 0);

    o.rule.leaf_cells = 2000;
    expect = alone(&s, &o);
    o.threads = 2;
    o.shuffle = 3;
    d = run_of(job, &s, &o, 0, &r);
    same_digest(&expect, &d);
    assert_true(r.fill.n_other + r.fill.n_other_failed + r.fill.n_other_wrong ==
                r.n_leaf);
  }
  scene_end(&s);
  vg_mesher_close(p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(tetgen),
    cmocka_unit_test(hxt),
    cmocka_unit_test(plug_in),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, open_job, close_job);
}
