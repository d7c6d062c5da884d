/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One copy for the ranks of a node: bytes, the sizing field, layers and
 * surfaces. */
#include "../unit/layer_cases.h"
#include "base/comm_parts.h"
#include "run/input/share.h"
#include "core/sizing/sizing_octree.h"
#include "layers/columns/share.h"
#include "layers/grow/grow.h"
#include "mpi_support.h"
#include "partition/store/store.h"

static const size_t length[] = { 0, 1, 63, 64, 65, 4097, 3000001, 0, 7 };
enum { N_LENGTH = sizeof length / sizeof *length };

static unsigned char value(size_t part, size_t i)
{
  return (unsigned char)(31 * part + i + i / 251);
}

/* All ranks except the first contribute nothing, and read after other ranks
 * have released the memory. */
static void share_parts(int is_mapped)
{
  int leads = vg_comm_node_rank(job) == 0;
  struct vg_bytes part[N_LENGTH];
  struct vg_shmem common;
  const unsigned char *at;

  for (size_t p = 0; p < N_LENGTH && leads; p++) {
    part[p].n = length[p];
    part[p].data = vg_alloc(length[p], 1);
    for (size_t i = 0; i < length[p]; i++) part[p].data[i] = value(p, i);
  }
  assert_int_equal(vg_comm_node_shmem(job, leads ? N_LENGTH : 0,
                                      leads ? part : NULL, &common, NULL),
                   VG_OK);
  for (size_t p = 0; p < N_LENGTH && leads; p++) free(part[p].data);
  assert_int_equal(common.is_mapped, is_mapped);
  at = common.data;
  for (size_t p = 0; p < N_LENGTH; p++) {
    size_t n_bad = 0;

    for (size_t i = 0; i < length[p]; i++) n_bad += at[i] != value(p, i);
    assert_int_equal(n_bad, 0);
    at += vg_shmem_padded(length[p]);
  }
  assert_true(at == common.data + common.n);
  vg_shmem_release(&common);
  assert_null(common.data);
}

static void parts_are_shared_by_a_node(void **state)
{
  (void)state;
  for (int i = 0; i < 5; i++) share_parts(vg_comm_node_size(job) > 1);
}

static void parts_are_copied_without_shared_memory(void **state)
{
  (void)state;
  if (job) job->apart = 1;
  share_parts(0);
  if (job) job->apart = 0;
}

static void nothing_can_be_shared(void **state)
{
  struct vg_shmem common;

  (void)state;
  assert_int_equal(vg_comm_node_shmem(job, 0, NULL, &common, NULL), VG_OK);
  vg_shmem_release(&common);
}

/* --- sizes --------------------------------------------------------------- */

static struct vg_sizing *field(double stretch)
{
  const struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  const struct vg_source source[2] = {
    { .kind = VG_SOURCE_POINT, .h0 = 0.01, .p0 = { 1, 2, 3 } },
    { .kind = VG_SOURCE_SPHERE,
      .h0 = 0.3,
      .r0 = 2,
      .p0 = { 9, 0, 0 },
      .stretch = stretch,
      .u = { 1, 2, 0 } }
  };
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_sizing_new(&o, 2, source, NULL, &s, &err)) fail_msg("%s", err.text);
  return s;
}

/* Every rank also makes the field itself, to know the expected one. */
static void share_field(double stretch)
{
  struct vg_sizing *own = field(stretch);
  struct vg_sizing *s = vg_comm_node_rank(job) ? NULL : field(stretch);
  double h[2][2];

  assert_int_equal(vg_sizing_share(job, &s, NULL), VG_OK);
  assert_int_equal(vg_sizing_leaves(s), vg_sizing_leaves(own));
  assert_memory_equal(s->octree.child, own->octree.child,
                      own->octree.n_split * sizeof *own->octree.child);
  assert_memory_equal(s->octree.least, own->octree.least,
                      own->octree.n_split * sizeof *own->octree.least);
  assert_memory_equal(s->octree.leaf, own->octree.leaf,
                      own->octree.n_leaf * sizeof *own->octree.leaf);
  assert_int_equal(vg_sizing_is_stretched(s), stretch > 0);
  assert_true((s->octree.n_tensor > 0) == (stretch > 0));
  assert_memory_equal(s->octree.tensor, own->octree.tensor,
                      own->octree.n_tensor * sizeof *own->octree.tensor);
  vg_sizing_range(s, &h[0][0], &h[0][1]);
  vg_sizing_range(own, &h[1][0], &h[1][1]);
  assert_memory_equal(h[0], h[1], sizeof h[0]);
  assert_true(s->octree.side == own->octree.side);
  assert_memory_equal(s->octree.lo, own->octree.lo, sizeof s->octree.lo);
  assert_true(vg_sizing_slope(s) == vg_sizing_slope(own));
  for (int i = 0; i < 2000; i++) {
    const double x[3] = { 0.01 * i - 8, 2, 0.3 * (i % 11) };

    assert_true(vg_sizing_at(s, x) == vg_sizing_at(own, x));
  }
  vg_sizing_free(own);
  vg_sizing_free(s);
}

static void a_field_is_shared_by_a_node(void **state)
{
  (void)state;
  share_field(0);
  share_field(5);
  if (job) job->apart = 1;
  share_field(0);
  share_field(5);
  if (job) job->apart = 0;
}

/* --- layers and surfaces ------------------------------------------------- */

/* A post on a plane: columns, fans, boundary edges on slide patches. */
static void grow(const struct vg_mesh *surface, struct vg_layers *out)
{
  struct vg_layer_options options = VG_LAYER_OPTIONS_INIT;
  struct vg_layer_request request[16] = { 0 };
  struct vg_layer_report report;
  struct vg_sizing *sizing = shape_sizing(surface, 1.2, 0);
  struct vg_error err = VG_ERROR_INIT;

  for (size_t p = 0; p < surface->n_patch; p++) {
    struct vg_growth_law law = VG_GROWTH_LAW_INIT;

    law.delta1 = 2e-4;
    request[p].is_wall = surface->patch[p].bc == CASE_WALL;
    request[p].law = law;
  }
  options.patch = request;
  options.fan_angle = 60;
  if (vg_layers_grow(surface, sizing, &options, out, &report, &err) < 0)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
}

static void add(void *user, size_t n, const void *data)
{
  struct vg_digest *d = user;

  *d = vg_digest_of(*d, n, data);
}

static struct vg_digest digest(const struct vg_layers *l)
{
  struct vg_digest d = { { 0, 0 } };

  vg_layers_show(l, add, &d);
  return d;
}

/* Every rank also grows the layers itself, to know the expected ones. On the
 * first rank of each node the shared copy replaces the original. */
static void share_layers(const struct vg_mesh *surface)
{
  struct vg_layers own = VG_LAYERS_INIT, got = VG_LAYERS_INIT;
  struct vg_digest was, is;

  grow(surface, &own);
  if (!vg_comm_node_rank(job)) grow(surface, &got);
  was = digest(&own);
  assert_int_equal(vg_layers_share(job, &got, NULL), VG_OK);
  is = digest(&got);
  assert_memory_equal(&was, &is, sizeof was);
  assert_int_equal(own.columns.n_border, got.columns.n_border);
  assert_int_equal(!got.common.data, vg_comm_node_size(job) == 1);
  vg_layers_release(&own);
  vg_layers_release(&got);
  assert_null(got.columns.column);
}

static void share_surface(const struct vg_mesh *m)
{
  struct vg_mesh got = VG_MESH_INIT;
  struct vg_shmem common = { 0 };
  uint64_t number = vg_comm_node_rank(job) ? 0 : 5;

  if (!vg_comm_node_rank(job))
    assert_int_equal(vg_mesh_copy(&got, m, NULL), VG_OK);
  assert_int_equal(vg_surface_share(job, &got, &number, &common, NULL), VG_OK);
  assert_int_equal(number, 5);
  assert_int_equal(got.n_tri, m->n_tri);
  assert_memory_equal(got.point, m->point, m->n_point * sizeof *m->point);
  assert_memory_equal(got.tri, m->tri, m->n_tri * sizeof *m->tri);
  assert_memory_equal(got.tri_patch, m->tri_patch,
                      m->n_tri * sizeof *m->tri_patch);
  assert_memory_equal(got.patch, m->patch, m->n_patch * sizeof *m->patch);
  if (common.data) vg_shmem_release(&common);
  else vg_mesh_release(&got);
}

static void layers_are_shared(void **state)
{
  struct vg_mesh surface = VG_MESH_INIT;

  (void)state;
  case_post(&surface, 0.1, 0.3);
  for (int apart = 0; apart < 2; apart++) {
    if (job) job->apart = apart;
    share_layers(&surface);
    share_surface(&surface);
  }
  if (job) job->apart = 0;
  vg_mesh_release(&surface);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(parts_are_shared_by_a_node),
    cmocka_unit_test(parts_are_copied_without_shared_memory),
    cmocka_unit_test(nothing_can_be_shared),
    cmocka_unit_test(a_field_is_shared_by_a_node),
    cmocka_unit_test(layers_are_shared)
  };

  return RUN_IN_JOB(tests);
}
