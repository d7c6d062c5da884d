/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Binary files that break their format, and files with a misleading name. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hostile.h"

static const double t1_point[4][3] = {
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
};
static const int32_t t1_tri[4][3] = {
  { 1, 3, 2 }, { 1, 2, 4 }, { 1, 4, 3 }, { 2, 3, 4 }
};

/* --- STL --- */

static void stl(struct bytes *b, int32_t count)
{
  char header[80] = "solid header that looks like text";

  memset(b, 0, sizeof *b);
  put_raw(b, header, sizeof header);
  put_i32(b, count);
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++) put_f32(b, 0);
    for (int k = 0; k < 9; k++)
      put_f32(b, (float)t1_point[t1_tri[i][k / 3] - 1][k % 3]);
    put_raw(b, "\0", 2);
  }
}

static void make_stl_truncated(const char *file)
{
  struct bytes b;

  stl(&b, 4);
  save(file, b.b, b.n - 7);
}

static void make_stl_huge(const char *file)
{
  struct bytes b;

  stl(&b, -1);
  save(file, b.b, b.n);
}

static void make_stl_nan(const char *file)
{
  struct bytes b;

  stl(&b, 4);
  b.n = 84 + 2 * 50 + 16;
  put_f32(&b, NAN);
  save(file, b.b, 84 + 4 * 50);
}

static void make_stl_big_endian(const char *file)
{
  struct bytes b;

  stl(&b, 4);
  b.n = 80;
  b.big = 1;
  put_i32(&b, 4);
  save(file, b.b, 84 + 4 * 50);
}

static void make_stl_noise(const char *file)
{
  struct bytes b = { .n = 0 };
  uint32_t x = 12345;

  for (int i = 0; i < 1000; i++) {
    x = x * 1664525u + 1013904223u;
    put_i32(&b, (int32_t)x);
  }
  save(file, b.b, b.n);
}

/* --- Cart3D --- */

static void record(struct bytes *b, const struct bytes *data)
{
  put_i32(b, (int32_t)data->n);
  put_raw(b, data->b, data->n);
  put_i32(b, (int32_t)data->n);
}

static void tri(struct bytes *b, int32_t n_point, int32_t node, double x)
{
  struct bytes part = { .big = 1 };

  memset(b, 0, sizeof *b);
  b->big = 1;
  put_i32(&part, n_point);
  put_i32(&part, 4);
  record(b, &part);
  part.n = 0;
  for (int i = 0; i < 12; i++)
    put_f64(&part, i == 5 ? x : t1_point[i / 3][i % 3]);
  record(b, &part);
  part.n = 0;
  for (int i = 0; i < 12; i++)
    put_i32(&part, i == 7 ? node : t1_tri[i / 3][i % 3]);
  record(b, &part);
}

static void make_tri_range(const char *file)
{
  struct bytes b;

  tri(&b, 4, 1000000, 0);
  save(file, b.b, b.n);
}

static void make_tri_infinite(const char *file)
{
  struct bytes b;

  tri(&b, 4, 2, INFINITY);
  save(file, b.b, b.n);
}

static void make_tri_truncated(const char *file)
{
  struct bytes b;

  tri(&b, 4, 2, 0);
  save(file, b.b, b.n - 20);
}

static void make_tri_marker(const char *file)
{
  struct bytes b;

  tri(&b, 4, 2, 0);
  b.b[16 + 3] = 97; /* the first marker of the vertices, low byte */
  save(file, b.b, b.n);
}

static void make_tri_huge(const char *file)
{
  struct bytes b;

  tri(&b, INT32_MAX, 2, 0);
  save(file, b.b, b.n);
}

/* --- Medit --- */

static void meshb(struct bytes *b, int32_t version, int32_t next, int32_t count)
{
  memset(b, 0, sizeof *b);
  put_i32(b, 1);
  put_i32(b, version);
  put_i32(b, 3);
  put_i32(b, 20);
  put_i32(b, 3);
  put_i32(b, 4);
  put_i32(b, next);
  put_i32(b, count);
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++) put_f64(b, t1_point[i][k]);
    put_i32(b, 0);
  }
  put_i32(b, 6);
  put_i32(b, 220);
  put_i32(b, 4);
  for (int i = 0; i < 16; i++) put_i32(b, i % 4 < 3 ? t1_tri[i / 4][i % 4] : 1);
  put_i32(b, 54);
  put_i32(b, 0);
}

static void make_meshb_loop(const char *file)
{
  struct bytes b;

  meshb(&b, 2, 8, 4); /* the next keyword would be the previous one */
  save(file, b.b, b.n);
}

static void make_meshb_far(const char *file)
{
  struct bytes b;

  meshb(&b, 2, INT32_MAX, 4);
  save(file, b.b, b.n);
}

static void make_meshb_count(const char *file)
{
  struct bytes b;

  meshb(&b, 2, 144, INT32_MAX);
  save(file, b.b, b.n);
}

static void make_meshb_version(const char *file)
{
  struct bytes b;

  meshb(&b, 77, 144, 4);
  save(file, b.b, b.n);
}

static void make_meshb_truncated(const char *file)
{
  struct bytes b;

  meshb(&b, 2, 144, 4);
  save(file, b.b, 100);
}

/* --- Gmsh --- */

/* Nodes of version 4.1: a block that claims n nodes, and one point. */
static void gmsh(struct bytes *b, int32_t one, int64_t n)
{
  memset(b, 0, sizeof *b);
  put_raw(b, "$MeshFormat\n4.1 1 8\n", 20);
  put_i32(b, one);
  put_raw(b, "\n$EndMeshFormat\n$Nodes\n", 23);
  for (int i = 0; i < 4; i++) put_i64(b, 1);
  put_i32(b, 2);
  put_i32(b, 1);
  put_i32(b, 0);
  put_i64(b, n);
  put_i64(b, 1);
  for (int k = 0; k < 3; k++) put_f64(b, 0);
}

static void make_gmsh_count(const char *file)
{
  struct bytes b;

  gmsh(&b, 1, INT64_MAX);
  save(file, b.b, b.n);
}

static void make_gmsh_order(const char *file)
{
  struct bytes b;

  gmsh(&b, 77, 1);
  save(file, b.b, b.n);
}

static void make_gmsh_end(const char *file)
{
  struct bytes b;

  gmsh(&b, 1, 1);
  put_raw(&b, "\n$EndElements\n", 14);
  save(file, b.b, b.n);
}

/* --- UGRID --- */

static void ugrid(struct bytes *b, int big, int32_t n_point, double x)
{
  static const int32_t tet[4] = { 1, 2, 3, 4 };

  memset(b, 0, sizeof *b);
  b->big = big;
  put_i32(b, n_point);
  put_i32(b, 4);
  put_i32(b, 0);
  put_i32(b, 1);
  for (int i = 0; i < 3; i++) put_i32(b, 0);
  for (int i = 0; i < 12; i++) put_f64(b, i == 8 ? x : t1_point[i / 3][i % 3]);
  for (int i = 0; i < 12; i++) put_i32(b, t1_tri[i / 3][i % 3]);
  for (int i = 0; i < 4; i++) put_i32(b, 1);
  for (int i = 0; i < 4; i++) put_i32(b, tet[i]);
}

static void make_ugrid_endian(const char *file)
{
  struct bytes b;

  ugrid(&b, 0, 4, 0); /* little-endian, but named as big-endian */
  save(file, b.b, b.n);
}

static void make_ugrid_huge(const char *file)
{
  struct bytes b;

  ugrid(&b, 1, INT32_MAX, 0);
  save(file, b.b, b.n);
}

static void make_ugrid_negative(const char *file)
{
  struct bytes b;

  ugrid(&b, 1, -4, 0);
  save(file, b.b, b.n);
}

static void make_ugrid_nan(const char *file)
{
  struct bytes b;

  ugrid(&b, 0, 4, NAN);
  save(file, b.b, b.n);
}

static void make_ugrid_truncated(const char *file)
{
  struct bytes b;

  ugrid(&b, 0, 4, 0);
  save(file, b.b, b.n - 9);
}

static void make_ugrid_text(const char *file)
{
  save_text(file, "4 4 0 1 0 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
}

static void make_ugrid_as_text(const char *file)
{
  struct bytes b;

  ugrid(&b, 1, 4, 0);
  save(file, b.b, b.n);
}

/* --- VGRID --- */

static const char t1_bc[] =
  "4 4 4 1\n Triangle Patch Nodes\n1 1 1 2 3\n2 2 1 4 2\n3 3 1 3 4\n"
  "4 4 2 4 3\n";

static void cogsg(struct bytes *b, int32_t n_cell, int32_t n_point,
                  int32_t node)
{
  struct bytes part = { .big = 1 };
  const int32_t head[6] = { -1, n_cell, n_point, 4, 0, 0 };

  memset(b, 0, sizeof *b);
  b->big = 1;
  for (int i = 0; i < 6; i++) put_i32(&part, head[i]);
  put_f64(&part, 0);
  for (int i = 0; i < 4; i++) put_i32(&part, i == 3 ? node : i + 1);
  record(b, &part);
  part.n = 0;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 4; i++) put_f64(&part, t1_point[i][k]);
  record(b, &part);
}

static void save_cogsg(const char *file, const struct bytes *b, size_t n,
                       const char *bc)
{
  char name[80];

  save(file, b->b, n);
  if (!bc) return;
  strcpy(name, file);
  strcpy(strrchr(name, '.'), ".bc");
  save_text(name, bc);
}

static void make_cogsg_alone(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 4);
  save_cogsg(file, &b, b.n, NULL);
}

static void make_cogsg_truncated(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 4);
  save_cogsg(file, &b, b.n - 30, t1_bc);
}

static void make_cogsg_points(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, INT32_MAX, 4);
  save_cogsg(file, &b, b.n, t1_bc);
}

static void make_cogsg_cells(const char *file)
{
  struct bytes b;

  cogsg(&b, INT32_MAX, 4, 4);
  save_cogsg(file, &b, b.n, t1_bc);
}

static void make_cogsg_range(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 5);
  save_cogsg(file, &b, b.n, t1_bc);
}

static void make_bc_range(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 4);
  save_cogsg(file, &b, b.n, "1 4 1 1\ntitle\n1 1 1 2 99\n");
}

static void make_bc_huge(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 4);
  save_cogsg(file, &b, b.n, "2000000000 4 1 1\ntitle\n1 1 1 2 3\n");
}

static void make_bc_binary(const char *file)
{
  struct bytes b;

  cogsg(&b, 1, 4, 4);
  save_cogsg(file, &b, b.n, "\001\002\003 \377");
}

static void make_cogsg_text(const char *file)
{
  save_text(file, "this is not a mesh, but a letter about one\n");
  save_text("text_bc.bc", t1_bc);
}

const struct hostile hostile_binaries[] = {
  { .file = "truncated_binary.stl",
    .phrase = "50 x 4",
    .make = make_stl_truncated },
  { .file = "huge_binary.stl",
    .phrase = "50 x 4294967295",
    .make = make_stl_huge },
  { .file = "nan_binary.stl", .phrase = "facet 3", .make = make_stl_nan },
  { .file = "big_endian.stl",
    .phrase = "neither text nor binary",
    .make = make_stl_big_endian },
  { .file = "noise.stl",
    .phrase = "neither text nor binary",
    .make = make_stl_noise },
  { .file = "noise.obj", .phrase = "binary", .make = make_stl_noise },
  { .file = "noise.tri", .phrase = "neither text nor", .make = make_stl_noise },
  { .file = "noise.meshb",
    .phrase = "neither text nor",
    .make = make_stl_noise },
  { .file = "noise.front", .phrase = "binary", .make = make_stl_noise },
  { .file = "binary_range.tri",
    .phrase = "vertex 1000000",
    .make = make_tri_range },
  { .file = "binary_infinite.tri",
    .phrase = "point 2",
    .make = make_tri_infinite },
  { .file = "binary_truncated.tri",
    .phrase = "triangles",
    .make = make_tri_truncated },
  { .file = "binary_marker.tri",
    .phrase = "vertices",
    .make = make_tri_marker },
  { .file = "binary_huge.tri", .phrase = "truncated", .make = make_tri_huge },
  { .file = "loop.meshb",
    .phrase = "before it begins",
    .make = make_meshb_loop },
  { .file = "far.meshb", .phrase = "beyond the end", .make = make_meshb_far },
  { .file = "count.meshb", .phrase = "truncated", .make = make_meshb_count },
  { .file = "version.meshb", .phrase = "version", .make = make_meshb_version },
  { .file = "truncated.meshb",
    .phrase = "beyond the end",
    .make = make_meshb_truncated },
  { .file = "count.msh", .phrase = "beyond 32 bits", .make = make_gmsh_count },
  { .file = "order.msh", .phrase = "byte order", .make = make_gmsh_order },
  { .file = "wrong_end.msh", .phrase = "does not end", .make = make_gmsh_end },
  { .file = "endian.b8.ugrid", .phrase = "lb8", .make = make_ugrid_endian },
  { .file = "huge.b8.ugrid", .phrase = "cannot hold", .make = make_ugrid_huge },
  { .file = "negative.b8.ugrid",
    .phrase = "negative",
    .make = make_ugrid_negative },
  { .file = "nan.lb8.ugrid", .phrase = "point 3", .make = make_ugrid_nan },
  { .file = "truncated.lb8.ugrid",
    .phrase = "truncated",
    .make = make_ugrid_truncated },
  { .file = "text.lb8.ugrid", .phrase = "text", .make = make_ugrid_text },
  { .file = "binary_as_text.ugrid",
    .phrase = "binary data",
    .make = make_ugrid_as_text },
  { .file = "no_bc_file.cogsg",
    .phrase = "no_bc_file.bc",
    .make = make_cogsg_alone },
  { .file = "truncated.cogsg",
    .phrase = "truncated",
    .make = make_cogsg_truncated },
  { .file = "huge_points.cogsg",
    .phrase = "truncated",
    .make = make_cogsg_points },
  { .file = "huge_cells.cogsg",
    .phrase = "not a .cogsg",
    .make = make_cogsg_cells },
  { .file = "range.cogsg", .phrase = "point 5", .make = make_cogsg_range },
  { .file = "bc_range.cogsg", .phrase = "99", .make = make_bc_range },
  { .file = "bc_huge.cogsg", .phrase = "too short", .make = make_bc_huge },
  { .file = "bc_binary.cogsg",
    .phrase = "bc_binary.bc",
    .make = make_bc_binary },
  { .file = "text_bc.cogsg",
    .phrase = "not a .cogsg",
    .make = make_cogsg_text },
  { 0 }
};
