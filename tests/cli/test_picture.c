/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Pictures: PNG files read back, cuts of known cells, surfaces seen from known
 * directions, decimated surfaces, worst cells with their neighbours. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include <cmocka.h>

#include "run/picture/body.h"
#include "run/picture/cuts.h"
#include "run/picture/decimate.h"
#include "run/picture/image.h"
#include "run/picture/shot.h"
#include "run/picture/worst.h"

/* --- PNG ----------------------------------------------------------------- */

static unsigned long get32(const uint8_t *at)
{
  return (unsigned long)at[0] << 24 | (unsigned long)at[1] << 16 |
         (unsigned long)at[2] << 8 | at[3];
}

/* The data of the chunk with this name; *n: number of its bytes. Checks its
 * checksum. */
static const uint8_t *chunk(const struct vg_bytes *png, const char *name,
                            size_t *n)
{
  for (size_t at = 8; at + 12 <= png->n; at += *n + 12) {
    const uint8_t *c = png->data + at;

    *n = get32(c);
    assert_true(at + 12 + *n <= png->n);
    assert_int_equal(get32(c + 8 + *n),
                     crc32(crc32(0, NULL, 0), c + 4, (unsigned)*n + 4));
    if (!memcmp(c + 4, name, 4)) return c + 8;
  }
  fail_msg("no chunk %s", name);
  return NULL;
}

/* Pixel i of a PNG as red, green, blue, opacity. */
static void read_png(const struct vg_bytes *png, int width, int height,
                     uint8_t (*to)[4])
{
  size_t n, n_alpha, n_data;
  const uint8_t *head = chunk(png, "IHDR", &n);
  const uint8_t *palette, *alpha, *data;
  uLongf size = (uLongf)((width + 1) * height);
  uint8_t *raw = malloc(size);

  assert_int_equal(get32(head), width);
  assert_int_equal(get32(head + 4), height);
  palette = chunk(png, "PLTE", &n);
  alpha = chunk(png, "tRNS", &n_alpha);
  data = chunk(png, "IDAT", &n_data);
  assert_int_equal(uncompress(raw, &size, data, n_data), Z_OK);
  assert_int_equal(size, (width + 1) * height);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      size_t k = raw[y * (width + 1) + x + 1];

      assert_int_equal(raw[y * (width + 1)], 0);
      assert_true(3 * k < n && k < n_alpha);
      memcpy(to[y * width + x], palette + 3 * k, 3);
      to[y * width + x][3] = alpha[k];
    }
  free(raw);
}

/* Colours keep all but the 3 lowest bits of brightness; opacity is rounded to
 * quarters. */
static void test_png(void **state)
{
  enum { W = 37, H = 23 };
  struct vg_image m = VG_IMAGE_INIT;
  struct vg_bytes png = { 0, NULL };
  uint8_t back[W * H][4];

  (void)state;
  assert_int_equal(vg_image_new(W, H, &m, NULL), VG_OK);
  for (int i = 0; i < W * H; i++) {
    const uint8_t rgba[4] = { (uint8_t)(40 * (i % 5)), (uint8_t)(i % W),
                              (uint8_t)(i % 3 * 100), i % 4 ? 255 : 0 };

    memcpy(m.rgba[i], rgba, 4);
  }
  assert_int_equal(vg_image_png(&m, &png, NULL), VG_OK);
  assert_memory_equal(png.data, "\211PNG\r\n\032\n", 8);
  read_png(&png, W, H, back);
  for (int i = 0; i < W * H; i++) {
    for (int k = 0; k < 3; k++)
      assert_true(abs(back[i][k] - m.rgba[i][k]) <= 7);
    assert_int_equal(back[i][3], m.rgba[i][3]);
  }
  free(png.data);
  vg_image_release(&m);
}

/* An image with more colours than a palette: the rarest ones are replaced by
 * similar colours. */
static void test_png_of_many_colours(void **state)
{
  enum { W = 64, H = 64 };
  struct vg_image m = VG_IMAGE_INIT;
  struct vg_bytes png = { 0, NULL };
  uint8_t back[W * H][4];
  long off = 0;

  (void)state;
  assert_int_equal(vg_image_new(W, H, &m, NULL), VG_OK);
  for (int i = 0; i < W * H; i++) {
    const uint8_t rgba[4] = { (uint8_t)(i % 16 * 16),
                              (uint8_t)(i / 16 % 16 * 16),
                              (uint8_t)(i / 256 * 16), 255 };

    memcpy(m.rgba[i], rgba, 4);
  }
  assert_int_equal(vg_image_png(&m, &png, NULL), VG_OK);
  read_png(&png, W, H, back);
  /* 256 of the 4096 colours are kept, and in this image they fill one side of
   * the colour cube. The mean error must not exceed the distance to the nearest
   * of them, half a side. */
  for (int i = 0; i < W * H; i++)
    for (int k = 0; k < 3; k++) off += abs(back[i][k] - m.rgba[i][k]);
  assert_true(off / (3 * W * H) < 64);
  free(png.data);
  vg_image_release(&m);
}

/* --- cuts ---------------------------------------------------------------- */

/* A cube of side 1 as six tetrahedra around a diagonal. */
static const double cube[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
                                   { 1, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
                                   { 0, 1, 1 }, { 1, 1, 1 } };
static const uint32_t six[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 },
                                    { 0, 2, 6, 7 }, { 0, 6, 4, 7 },
                                    { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
static const uint32_t ids[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };

static struct vg_slice part_of_cube(size_t from, size_t to)
{
  return (struct vg_slice){ .n_point = 8,
                            .x = cube,
                            .id = ids,
                            .cell_at = { from },
                            .n_cell = { to - from },
                            .cell = { six[from] },
                            .kind = 1,
                            .domain = 1 };
}

static struct vg_cuts *cuts_of(size_t n, const struct vg_cut *cut)
{
  struct vg_cuts *c = NULL;

  assert_int_equal(vg_cuts_new(n, cut, &c, NULL), VG_OK);
  return c;
}

/* In a window twice as wide as the cube, the cut covers exactly the pixels of
 * its square. */
static void test_cut_of_a_cube(void **state)
{
  const struct vg_cut cut = {
    .axis = 1, .at = 0.4, .centre = { 0.5, 0.5 }, .width = 2
  };
  struct vg_cuts *c = cuts_of(1, &cut);
  struct vg_slice s = part_of_cube(0, 6);
  struct vg_image m = VG_IMAGE_INIT;
  size_t wrong = 0;

  (void)state;
  assert_int_equal(vg_cuts_put(c, &s, NULL), VG_OK);
  assert_int_equal(vg_cuts_gather(c, NULL, NULL), VG_OK);
  assert_int_equal(vg_cuts_image(c, 0, VG_CUT_BY_KIND, &m, NULL), VG_OK);
  for (int y = 0; y < VG_CUT_HEIGHT; y++)
    for (int x = 0; x < VG_CUT_WIDTH; x++) {
      int is_in = abs(2 * x + 1 - VG_CUT_WIDTH) < VG_CUT_WIDTH / 2 &&
                  abs(2 * y + 1 - VG_CUT_HEIGHT) < VG_CUT_WIDTH / 2;

      wrong += m.rgba[y * VG_CUT_WIDTH + x][3] != (is_in ? 255 : 0);
    }
  assert_int_equal(wrong, 0);
  assert_int_equal(vg_cuts_in_parts(c, 0),
                   VG_CUT_WIDTH *
                     VG_CUT_WIDTH); /* 4 samples of every fourth pixel */
  vg_image_release(&m);
  vg_cuts_free(c);
}

/* Area of the cut of a hexahedron of the layers with these corners. */
static double area_of_cut(const double (*x)[3], double at)
{
  static const uint32_t hex[8] = { 0, 1, 3, 2, 4, 5, 7, 6 };
  const struct vg_cut cut = { .axis = 2, .at = at, .width = 4 };
  const struct vg_slice s = { .n_point = 8,
                              .x = x,
                              .id = ids,
                              .n_cell = { [VG_SLICE_HEX] = 1 },
                              .cell = { [VG_SLICE_HEX] = hex } };
  struct vg_cuts *c = cuts_of(1, &cut);
  struct vg_image m = VG_IMAGE_INIT;
  size_t n = 0;

  assert_int_equal(vg_cuts_put(c, &s, NULL), VG_OK);
  assert_int_equal(vg_cuts_gather(c, NULL, NULL), VG_OK);
  assert_int_equal(vg_cuts_image(c, 0, VG_CUT_BY_KIND, &m, NULL), VG_OK);
  assert_memory_equal(m.rgba[VG_CUT_WIDTH * (VG_CUT_HEIGHT + 1) / 2],
                      vg_cut_kind_colour[VG_CUT_HEXAHEDRON], 3);
  for (size_t i = 0; i < VG_CUT_WIDTH * VG_CUT_HEIGHT; i++)
    n += m.rgba[i][3] > 127;
  vg_image_release(&m);
  vg_cuts_free(c);
  return (double)n * 16 / VG_CUT_WIDTH / VG_CUT_WIDTH;
}

/* Across an axis a square, across a diagonal a triangle or a hexagon. */
static void test_cut_of_a_hexahedron(void **state)
{
  static const double turn[3][3] = {
    { M_SQRT1_2, -M_SQRT1_2, 0 },
    { 0.40824829046386302, 0.40824829046386302, -0.81649658092772603 },
    { 0.57735026918962576, 0.57735026918962576, 0.57735026918962576 }
  };
  double x[8][3], y[8][3];

  (void)state;
  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < 3; k++) x[i][k] = cube[i][k] - 0.5;
    for (int k = 0; k < 3; k++)
      y[i][k] = turn[k][0] * x[i][0] + turn[k][1] * x[i][1] +
                turn[k][2] * x[i][2];
  }
  assert_true(fabs(area_of_cut((const double(*)[3])x, 0.2) - 1) < 0.01);
  assert_true(fabs(area_of_cut((const double(*)[3])y, 0) - 0.75 * sqrt(3)) <
              0.01);
  assert_true(fabs(area_of_cut((const double(*)[3])y, 0.5) -
                   1.5 * sqrt(3) * pow(0.5 * sqrt(3) - 0.5, 2)) < 0.01);
}

/* The picture is the same for any order and any grouping of the cells. */
static void test_cut_in_any_order(void **state)
{
  const struct vg_cut cut[2] = {
    { .axis = 2, .at = 0.31, .centre = { 0.4, 0.6 }, .width = 0.9 },
    { .axis = 0, .at = 0, .centre = { 0.5, 0.5 }, .width = 3 }
  };
  struct vg_cuts *a = cuts_of(2, cut), *b = cuts_of(2, cut);
  struct vg_slice whole = part_of_cube(0, 6);

  (void)state;
  assert_int_equal(vg_cuts_put(a, &whole, NULL), VG_OK);
  for (int i = 5; i >= 0; i--) {
    struct vg_slice s = part_of_cube((size_t)i, (size_t)i + 1);

    assert_int_equal(vg_cuts_put(b, &s, NULL), VG_OK);
  }
  for (size_t i = 0; i < 2; i++) {
    struct vg_image x = VG_IMAGE_INIT, y = VG_IMAGE_INIT;

    assert_int_equal(vg_cuts_image(a, i, VG_CUT_BY_ANGLE, &x, NULL), VG_OK);
    assert_int_equal(vg_cuts_image(b, i, VG_CUT_BY_ANGLE, &y, NULL), VG_OK);
    assert_memory_equal(x.rgba, y.rgba,
                        VG_CUT_WIDTH * VG_CUT_HEIGHT * sizeof *x.rgba);
    vg_image_release(&x);
    vg_image_release(&y);
  }
  vg_cuts_free(a);
  vg_cuts_free(b);
}

/* --- surfaces ------------------------------------------------------------ */

/* Two squares across y, both facing an eye at small y. The second one is nearer
 * to it. */
static double square_point[8][3] = { { 0, 0, 0 },    { 1, 0, 0 },
                                     { 1, 0, 1 },    { 0, 0, 1 },
                                     { 0, -1, 0 },   { 0.5, -1, 0 },
                                     { 0.5, -1, 1 }, { 0, -1, 1 } };
static uint32_t square_tri[4][3] = {
  { 0, 1, 2 }, { 0, 2, 3 }, { 4, 5, 6 }, { 4, 6, 7 }
};
static uint32_t square_patch[4] = { 0, 0, 1, 1 };

static struct vg_mesh squares(void)
{
  return (struct vg_mesh){ .n_point = 8,
                           .n_tri = 4,
                           .point = square_point,
                           .tri = square_tri,
                           .tri_patch = square_patch };
}

/* The shares of a picture of the squares that are covered, and that are red. */
static void look(const double toward[3], double *covered, double *red)
{
  struct vg_mesh m = squares();
  const uint8_t seen[4] = { 1, 1, 1, 1 }, colour[4] = { 0, 0, 1, 1 };
  const uint8_t palette[256][3] = { { 0, 0, 255 }, { 255, 0, 0 } };
  struct vg_camera c;
  struct vg_shot s = VG_SHOT_INIT;
  struct vg_image image = VG_IMAGE_INIT;

  vg_camera_aim(&m, seen, toward, 200, 200, &c);
  assert_int_equal(vg_shot_take(&m, seen, &c, 2, &s, NULL), VG_OK);
  assert_int_equal(vg_shot_image(&s, colour, palette, &image, NULL), VG_OK);
  *covered = *red = 0;
  for (int i = 0; i < 200 * 200; i++) {
    *covered += image.rgba[i][3] / 255.0 / (200 * 200);
    *red += (image.rgba[i][0] > image.rgba[i][2]) / (200.0 * 200);
  }
  vg_shot_release(&s);
  vg_image_release(&image);
}

/* The squares fill 0.94 of the picture's width and height, and the nearer one
 * hides half of the other. Seen from behind, neither is drawn. A row of samples
 * is 0.25 % of the height. */
static void test_shot(void **state)
{
  const double ahead[3] = { 0, -1, 0 }, behind[3] = { 0, 1, 0 };
  double covered, red;

  (void)state;
  look(ahead, &covered, &red);
  assert_true(fabs(covered - 0.94 * 0.94) < 0.01);
  assert_true(fabs(red - 0.94 * 0.94 / 2) < 0.01);
  look(behind, &covered, &red);
  assert_true(covered == 0);
}

/* A wavy sheet of 2 n n triangles. */
static struct vg_mesh sheet(size_t n)
{
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = (n + 1) * (n + 1);
  m.n_tri = 2 * n * n;
  m.point = malloc(m.n_point * sizeof *m.point);
  m.tri = malloc(m.n_tri * sizeof *m.tri);
  for (size_t i = 0; i < m.n_point; i++) {
    double x = (double)(i % (n + 1)) / (double)n;
    double y = (double)(i / (n + 1)) / (double)n;
    const double p[3] = { x, y, x * y };

    memcpy(m.point[i], p, sizeof p);
  }
  for (size_t i = 0; i < n * n; i++) {
    uint32_t a = (uint32_t)(i / n * (n + 1) + i % n);
    uint32_t b = a + 1, c = a + (uint32_t)n + 1;
    const uint32_t t[2][3] = { { a, b, c }, { b, c + 1, c } };

    memcpy(m.tri[2 * i], t, sizeof t);
  }
  return m;
}

static void test_decimate(void **state)
{
  struct vg_mesh m = sheet(100);
  struct vg_decimated c = VG_DECIMATED_INIT;

  (void)state;
  assert_int_equal(vg_decimate(&m, m.n_tri, &c, NULL), VG_OK);
  assert_true(c.n_tri == m.n_tri && c.n_point == m.n_point && c.step == 0);
  assert_memory_equal(c.tri, m.tri, m.n_tri * sizeof *m.tri);
  assert_int_equal(vg_decimate(&m, 2000, &c, NULL), VG_OK);
  /* No more triangles than requested. The lower bound allows for a lattice that
   * is a quarter too coarse and leaves fewer triangles per square than the
   * sheet has. */
  assert_true(c.n_tri <= 2000 && c.n_tri > 500 && c.step > 0);
  for (size_t t = 0; t < c.n_tri; t++) {
    const uint32_t *n = c.tri[t];

    assert_true(n[0] < c.n_point && n[1] < c.n_point && n[2] < c.n_point);
    assert_true(n[0] != n[1] && n[1] != n[2] && n[2] != n[0]);
    assert_true(c.from[t] < m.n_tri && (!t || c.from[t] > c.from[t - 1]));
  }
  vg_decimated_release(&c);
  vg_mesh_release(&m);
}

/* --- choice of cuts ------------------------------------------------------ */

static void test_body(void **state)
{
  struct vg_patch patch[2] = { { .bc = 3, .bc_fun3d = VG_BC_NONE },
                               { .bc = 4, .bc_fun3d = VG_BC_NONE } };
  struct vg_mesh m = squares();
  struct vg_cut_plan plan;
  uint8_t on[2];

  (void)state;
  m.n_patch = 2;
  m.patch = patch;
  vg_body_patches(&m, NULL, on);
  assert_true(!on[0] && on[1]);
  assert_int_equal(vg_cut_plan(&m, NULL, 0, &plan, NULL), VG_OK);
  /* The body is flat across y, so there is no cut across y and no close-up of
   * its ends. The cuts across x and z and the cut of the domain remain. */
  for (size_t i = 0; i < plan.n; i++) {
    assert_true(plan.cut[i].width > 0);
    assert_true(plan.view[i] != VG_VIEW_POOREST);
  }
  assert_true(plan.n >= 3);
  patch[1].bc = 3;
  vg_body_patches(&m, NULL, on);
  assert_true(on[0] && on[1]);
}

static vg_status get_cube(const struct vg_slices *s, size_t i,
                          struct vg_slice *out, struct vg_error *err)
{
  (void)s;
  (void)err;
  *out = part_of_cube(3 * i, 3 * i + 3);
  return VG_OK;
}

static void put_cube(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  (void)slice;
}

/* All cells of the cube touch each other: the neighbours in the same slice are
 * found. */
static void test_around(void **state)
{
  const struct vg_slices s = { .n_slice = 2, .get = get_cube, .put = put_cube };
  const uint64_t id[3] = { 4, 0, 6 };
  struct vg_around a[3];

  (void)state;
  assert_int_equal(vg_around_find(NULL, &s, 2, 3, id, a, NULL), VG_OK);
  assert_true(a[0].n == 3 && a[1].n == 3 && a[2].n == 0);
  for (int k = 0; k < 4; k++)
    assert_memory_equal(a[0].cell[0][k], cube[six[4][k]], sizeof cube[0]);
  vg_around_release(a, 3);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_png),
    cmocka_unit_test(test_png_of_many_colours),
    cmocka_unit_test(test_cut_of_a_cube),
    cmocka_unit_test(test_cut_of_a_hexahedron),
    cmocka_unit_test(test_cut_in_any_order),
    cmocka_unit_test(test_shot),
    cmocka_unit_test(test_decimate),
    cmocka_unit_test(test_body),
    cmocka_unit_test(test_around)
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
