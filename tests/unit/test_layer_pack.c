/* Layers as bytes: what is unpacked is what was packed, and damaged bytes do
 * no harm. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "layer_cases.h"
#include "layers/columns/pack.h"
#include "layers/grow/grow.h"

struct bench {
  struct vg_mesh surface;
  struct vg_layers layers;
  struct vg_bytes bytes;
};

/* One column as if it were bent: its points one by one. */
static int bend(const struct vg_mesh *surface, struct vg_columns *c)
{
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
  size_t n = (size_t)c->column[5].n + 1;

  if (c->n_path) return 0;
  c->path = malloc(n * sizeof *c->path);
  if (!c->path) return -1;
  vg_column_points(c, surface, 5, d, x);
  memcpy(c->path, x, n * sizeof *x);
  c->n_path = n;
  c->column[5].bent = 0;
  return 0;
}

/* A post on a plane: columns, fans, borders on slide patches, a bent column. */
static int grow(void **state)
{
  static struct bench b;
  struct vg_layer_options options = VG_LAYER_OPTIONS_INIT;
  struct vg_layer_request request[16] = { 0 };
  struct vg_layer_report report;
  struct vg_sizing *sizing;
  struct vg_error err = VG_ERROR_INIT;

  memset(&b, 0, sizeof b);
  case_post(&b.surface, 0.1, 0.3);
  sizing = shape_sizing(&b.surface, 1.2, 0);
  for (size_t p = 0; p < b.surface.n_patch; p++) {
    struct vg_law law = VG_LAW_INIT;

    law.delta1 = 2e-4;
    request[p].is_wall = b.surface.patch[p].bc == CASE_WALL;
    request[p].law = law;
  }
  options.patch = request;
  options.fan_angle = 60;
  if (vg_layers_grow(&b.surface, sizing, &options, &b.layers, &report,
                     &err) < 0 ||
      bend(&b.surface, &b.layers.columns) < 0 ||
      vg_layers_pack(&b.layers, &b.bytes, &err) < 0) {
    print_error("%s\n", err.text);
    return -1;
  }
  vg_sizing_free(sizing);
  *state = &b;
  return 0;
}

static int finish(void **state)
{
  struct bench *b = *state;

  free(b->bytes.data);
  vg_layers_release(&b->layers);
  vg_mesh_release(&b->surface);
  return 0;
}

#define SAME(a, b, n) \
  assert_memory_equal((a), (b), (n) * sizeof *(a))

static void unpacked_are_the_layers(void **state)
{
  struct bench *b = *state;
  struct vg_layers got = VG_LAYERS_INIT;
  const struct vg_columns *c = &b->layers.columns, *d = &got.columns;
  const struct vg_layer_front *f = &b->layers.front, *g = &got.front;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_layers_unpack(&b->bytes, &b->surface, &got, &err) < 0)
    fail_msg("%s", err.text);
  assert_true(c->n_column && c->n_face && c->n_border && c->n_law &&
              c->n_path);
  assert_int_equal(c->n_column, d->n_column);
  assert_int_equal(c->n_face, d->n_face);
  assert_int_equal(c->n_border, d->n_border);
  assert_int_equal(c->n_law, d->n_law);
  assert_int_equal(c->n_path, d->n_path);
  SAME(c->column, d->column, c->n_column);
  SAME(c->face, d->face, c->n_face);
  SAME(c->face_tri, d->face_tri, c->n_face);
  SAME(c->border, d->border, c->n_border);
  SAME(c->border_patch, d->border_patch, c->n_border);
  SAME(c->law, d->law, c->n_law);
  SAME(c->path, d->path, c->n_path);
  assert_int_equal(f->mesh.n_point, g->mesh.n_point);
  assert_int_equal(f->mesh.n_tri, g->mesh.n_tri);
  assert_int_equal(f->mesh.n_patch, g->mesh.n_patch);
  SAME(f->mesh.point, g->mesh.point, f->mesh.n_point);
  SAME(f->mesh.tri, g->mesh.tri, f->mesh.n_tri);
  SAME(f->mesh.tri_patch, g->mesh.tri_patch, f->mesh.n_tri);
  SAME(f->mesh.patch, g->mesh.patch, f->mesh.n_patch);
  SAME(f->column, g->column, f->mesh.n_point);
  SAME(f->point, g->point, f->mesh.n_point);
  SAME(f->face, g->face, f->mesh.n_tri);
  vg_layers_release(&got);
}

static void a_part_is_refused(void **state)
{
  struct bench *b = *state;
  size_t step = b->bytes.n / 500;

  for (size_t n = 0; n < b->bytes.n; n += n < 200 ? 1 : step) {
    struct vg_bytes cut = { n, b->bytes.data };
    struct vg_layers got = VG_LAYERS_INIT;
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(vg_layers_unpack(&cut, &b->surface, &got, &err),
                     VG_ERR_FORMAT);
    assert_null(got.columns.column);
    assert_true(err.text[0]);
  }
}

/* Every use that the columns promise: the points of each. */
static void use(const struct bench *b, const struct vg_layers *l)
{
  for (size_t i = 0; i < l->columns.n_column; i++) {
    double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];

    vg_column_points(&l->columns, &b->surface, i, d, x);
  }
}

static void changed_bytes_are_refused_or_harmless(void **state)
{
  struct bench *b = *state;
  size_t step = b->bytes.n / 1500, n_bad = 0;

  for (size_t i = 0; i < b->bytes.n; i += i < 72 ? 1 : step | 1) {
    unsigned char was = b->bytes.data[i];
    struct vg_layers got = VG_LAYERS_INIT;

    b->bytes.data[i] ^= (unsigned char)(0x80u >> i % 8);
    if (vg_layers_unpack(&b->bytes, &b->surface, &got, NULL) < 0) n_bad++;
    else use(b, &got);
    vg_layers_release(&got);
    b->bytes.data[i] = was;
  }
  assert_true(n_bad > 72);
}

/* Indices into the surface are held against the surface at hand. */
static void another_surface_is_refused(void **state)
{
  struct bench *b = *state;
  struct vg_mesh small = b->surface;
  struct vg_layers got = VG_LAYERS_INIT;

  small.n_point = 3;
  assert_int_equal(vg_layers_unpack(&b->bytes, &small, &got, NULL),
                   VG_ERR_FORMAT);
  small = b->surface;
  small.n_tri = 3;
  assert_int_equal(vg_layers_unpack(&b->bytes, &small, &got, NULL),
                   VG_ERR_FORMAT);
  small = b->surface;
  small.n_patch--;
  assert_int_equal(vg_layers_unpack(&b->bytes, &small, &got, NULL),
                   VG_ERR_FORMAT);
  assert_null(got.columns.column);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(unpacked_are_the_layers),
    cmocka_unit_test(a_part_is_refused),
    cmocka_unit_test(changed_bytes_are_refused_or_harmless),
    cmocka_unit_test(another_surface_is_refused)
  };

  return cmocka_run_group_tests(tests, grow, finish);
}
