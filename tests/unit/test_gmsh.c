/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Gmsh's .msh: written meshes are read back; every layout that Gmsh itself
 * writes is read; damaged files are refused. */
#define _GNU_SOURCE
#include "mixed_support.h"

#include "io/mesh/gmsh.h"

/* --- files as Gmsh lays them out, written independently of the library --- */

struct layout {
  int version, binary, big, wide;
};

struct file {
  const struct layout *l;
  unsigned char b[8192];
  size_t n;
};

static void put_bytes(struct file *f, const void *data, size_t n)
{
  assert_true(f->n + n <= sizeof f->b);
  memcpy(f->b + f->n, data, n);
  f->n += n;
}

static void text(struct file *f, const char *s)
{
  put_bytes(f, s, strlen(s));
}

static void word(struct file *f, uint64_t v, int size)
{
  for (int i = 0; i < size; i++) {
    unsigned char c = (unsigned char)(v >> 8 * (f->l->big ? size - 1 - i : i));

    put_bytes(f, &c, 1);
  }
}

static void number(struct file *f, int64_t v, int size)
{
  char s[32];

  if (f->l->binary) {
    word(f, (uint64_t)v, size);
    return;
  }
  sprintf(s, "%lld ", (long long)v);
  text(f, s);
}

static void put_int(struct file *f, int64_t v)
{
  number(f, v, 4);
}

static void put_count(struct file *f, int64_t v)
{
  number(f, v, f->l->wide ? 8 : 4);
}

static void put_real(struct file *f, double v)
{
  char s[40];
  uint64_t bits;

  memcpy(&bits, &v, sizeof bits);
  if (f->l->binary) {
    word(f, bits, 8);
    return;
  }
  sprintf(s, "%.17g ", v);
  text(f, s);
}

static void start(struct file *f, const struct layout *l)
{
  char s[80];

  f->l = l;
  f->n = 0;
  sprintf(s, "$MeshFormat\n%s %d %d\n", l->version == 4 ? "4.1" : "2.2",
          l->binary, l->wide || l->version == 2 ? 8 : 4);
  text(f, s);
  if (l->binary) word(f, 1, 4);
  text(f, l->binary ? "\n$EndMeshFormat\n" : "$EndMeshFormat\n");
  text(f, "$PhysicalNames\n3\n2 7 \"left wing\"\n1 7 \"an edge\"\n"
          "3 1 \"fluid\"\n$EndPhysicalNames\n");
}

static const double t1_point[5][3] = {
  { 9, 9, 9 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
};
/* Node numbers are neither in order nor contiguous; no face uses the first
 * node. */
static const int64_t t1_tag[5] = { 3, 40, 20, 30, 10 };
static const int64_t t1_face[4][3] = {
  { 40, 20, 30 }, { 40, 10, 20 }, { 40, 30, 10 }, { 20, 10, 30 }
};

/* Surfaces 5 (in group 7, reversed), 6 (in no group); points and lines. */
static void make_4(struct file *f, const struct layout *l)
{
  start(f, l);
  text(f, "$Entities\n");
  put_count(f, 1), put_count(f, 1), put_count(f, 2), put_count(f, 0);
  put_int(f, 1);
  for (int k = 0; k < 3; k++) put_real(f, 9);
  put_count(f, 0);
  for (int e = 0; e < 3; e++) {
    put_int(f, e ? 4 + e : 2);
    for (int k = 0; k < 6; k++) put_real(f, k);
    put_count(f, e < 2);
    if (e < 2) put_int(f, e ? -7 : 7);
    put_count(f, e ? 1 : 2);
    put_int(f, e ? 2 : 1);
    if (!e) put_int(f, -1);
  }
  text(f, "\n$EndEntities\n$Nodes\n");
  put_count(f, 3), put_count(f, 5), put_count(f, 3), put_count(f, 40);
  put_int(f, 0), put_int(f, 1), put_int(f, 0), put_count(f, 1);
  put_count(f, t1_tag[0]);
  for (int k = 0; k < 3; k++) put_real(f, t1_point[0][k]);
  put_int(f, 2), put_int(f, 5), put_int(f, 1), put_count(f, 4);
  for (int i = 1; i < 5; i++) put_count(f, t1_tag[i]);
  for (int i = 1; i < 5; i++) {
    for (int k = 0; k < 3; k++) put_real(f, t1_point[i][k]);
    put_real(f, 0.5), put_real(f, 0.25); /* parameters */
  }
  put_int(f, 2), put_int(f, 6), put_int(f, 0), put_count(f, 0);
  text(f, "\n$EndNodes\n$Elements\n");
  put_count(f, 4), put_count(f, 6), put_count(f, 1), put_count(f, 6);
  put_int(f, 0), put_int(f, 1), put_int(f, 15), put_count(f, 1);
  put_count(f, 1), put_count(f, 3);
  put_int(f, 1), put_int(f, 2), put_int(f, 1), put_count(f, 1);
  put_count(f, 2), put_count(f, 40), put_count(f, 20);
  for (int s = 0; s < 2; s++) {
    put_int(f, 2), put_int(f, 5 + s), put_int(f, 2), put_count(f, 2);
    for (int i = 0; i < 2; i++) {
      put_count(f, 10 + 2 * s + i);
      for (int k = 0; k < 3; k++) put_count(f, t1_face[2 * s + i][k]);
    }
  }
  text(f, "\n$EndElements\n");
}

/* The number of elements in a block and the first values of each of them. */
static void block_2(struct file *f, int type, int n, int n_tag)
{
  if (!f->l->binary) return;
  put_int(f, type), put_int(f, n), put_int(f, n_tag);
}

static void head_2(struct file *f, int element, int type, int n_tag)
{
  put_int(f, element);
  if (!f->l->binary) put_int(f, type), put_int(f, n_tag);
}

static void make_2(struct file *f, const struct layout *l)
{
  start(f, l);
  text(f, "$Nodes\n5\n");
  for (int i = 0; i < 5; i++) {
    put_int(f, t1_tag[i]);
    for (int k = 0; k < 3; k++) put_real(f, t1_point[i][k]);
    if (!l->binary) text(f, "\n");
  }
  text(f, "\n$EndNodes\n$Elements\n5\n");
  block_2(f, 15, 1, 2);
  head_2(f, 1, 15, 2);
  put_int(f, 0), put_int(f, 1), put_int(f, 3);
  for (int s = 0; s < 2; s++) {
    int n_tag = 3 - s;

    block_2(f, 2, 2, n_tag);
    for (int i = 0; i < 2; i++) {
      head_2(f, 10 + 2 * s + i, 2, n_tag);
      put_int(f, s ? 0 : -7), put_int(f, 5 + s);
      if (n_tag == 3) put_int(f, 0);
      for (int k = 0; k < 3; k++) put_int(f, t1_face[2 * s + i][k]);
      if (!l->binary) text(f, "\n");
    }
  }
  text(f, "\n$EndElements\n$NodeData\n1\n\"$Nodes of a kind\"\n$EndNodeData\n");
}

static const struct layout layouts[] = { { 2, 0, 0, 0 }, { 2, 1, 0, 0 },
                                         { 2, 1, 1, 0 }, { 4, 0, 0, 1 },
                                         { 4, 1, 0, 1 }, { 4, 1, 1, 1 },
                                         { 4, 1, 0, 0 }, { 4, 1, 1, 0 },
                                         { 4, 0, 0, 0 } };

static void make_file(struct file *f, const struct layout *l)
{
  if (l->version == 2) make_2(f, l);
  else make_4(f, l);
}

static void every_layout_is_read(void **state)
{
  struct vg_mesh t1;

  (void)state;
  io_make_t1(&t1, 0);
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_mesh m = VG_MESH_INIT;
    struct file f;

    make_file(&f, layouts + i);
    if (io_parse_bytes(vg_gmsh_parse, f.b, f.n, &m, &err) != VG_OK)
      fail_msg("layout %zu: %s", i, err.text);
    /* the point without faces is removed, the others keep their order */
    assert_int_equal(m.n_point, 4);
    assert_memory_equal(m.point, t1.point, 4 * sizeof *m.point);
    assert_int_equal(m.n_tri, 4);
    assert_memory_equal(m.tri, t1.tri, 4 * sizeof *m.tri);
    assert_int_equal(m.n_patch, 2);
    assert_int_equal(m.patch[0].id, 0);
    assert_string_equal(m.patch[0].name, "");
    assert_int_equal(m.patch[1].id, 7);
    assert_string_equal(m.patch[1].name, "left wing");
    assert_int_equal(m.patch[1].bc, VG_BC_NONE);
    for (size_t k = 0; k < 4; k++) assert_int_equal(m.tri_patch[k], k < 2);
    vg_mesh_release(&m);
  }
  vg_mesh_release(&t1);
}

/* A file truncated anywhere, or with any byte modified, is refused with a
 * message or read as a consistent mesh. */
static void damage_is_always_reported(void **state)
{
  (void)state;
  for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
    struct file f;

    make_file(&f, layouts + i);
    for (size_t n = 1; n < f.n; n++) {
      struct vg_error err = VG_ERROR_INIT;
      struct vg_mesh m = VG_MESH_INIT;
      vg_status st = io_parse_bytes(vg_gmsh_parse, f.b, n, &m, &err);

      if (st == VG_OK && m.n_tri != 4) fail_msg("cut at %zu", n);
      if (st != VG_OK) assert_non_null(strstr(err.text, "case"));
      vg_mesh_release(&m);
      f.b[n] ^= 0x80;
      st = io_parse_bytes(vg_gmsh_parse, f.b, f.n, &m, &err);
      for (size_t k = 0; st == VG_OK && k < 3 * m.n_tri; k++)
        assert_true(m.tri[k / 3][k % 3] < m.n_point);
      vg_mesh_release(&m);
      f.b[n] ^= 0x80;
    }
  }
}

#define HEAD "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NODES                                                                  \
  "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n"                   \
  "$EndNodes\n"

static void surfaces_where_there_are_no_groups(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_gmsh_parse,
            HEAD NODES "$Elements\n2 2 1 2\n2 12 2 1\n1 1 2 3\n"
                       "2 11 2 1\n2 1 3 2\n$EndElements\n",
            &m);
  assert_int_equal(m.n_patch, 2);
  assert_int_equal(m.patch[0].id, 11);
  assert_int_equal(m.patch[m.tri_patch[0]].id, 12);
  vg_mesh_release(&m);
}

static void refusals(void **state)
{
  static const struct {
    const char *text;
    vg_status code;
    const char *phrase;
  } bad[] = {
    { "(0 \"fluent\")\n", VG_ERR_FORMAT, "Fluent" },
    { "solid x\n", VG_ERR_FORMAT, "$MeshFormat" },
    { "\n", VG_ERR_FORMAT, "no $MeshFormat" },
    { "$NOD\n1\n", VG_ERR_UNSUPPORTED, "version 1" },
    { "$MeshFormat\n4 0 8\n$EndMeshFormat\n", VG_ERR_UNSUPPORTED, "msh41" },
    { "$MeshFormat\n4.1 2 8\n", VG_ERR_FORMAT, "0 or 1" },
    { "$MeshFormat\n2.2 0 4\n", VG_ERR_FORMAT, "8" },
    { "$Nodes\n0\n", VG_ERR_FORMAT, "precedes $MeshFormat" },
    { HEAD HEAD, VG_ERR_FORMAT, "twice" },
    { HEAD "garbage\n", VG_ERR_FORMAT, "outside of a section" },
    { HEAD "$Comments\n", VG_ERR_FORMAT, "the end of" },
    { HEAD NODES, VG_ERR_INPUT, "nothing to mesh" },
    { HEAD NODES NODES, VG_ERR_FORMAT, "twice" },
    { HEAD "$Elements\n0 0 0 0\n$EndElements\n", VG_ERR_FORMAT, "precede" },
    { HEAD "$PartitionedEntities\n", VG_ERR_UNSUPPORTED, "partitioned" },
    { HEAD "$PhysicalNames\n1\n2 1 wing\n", VG_ERR_FORMAT, "quotes" },
    { HEAD "$PhysicalNames\n1\n2 1 \"wing\n", VG_ERR_FORMAT, "quote" },
    { HEAD "$Nodes\n1 1 1 1\n2 1 0 99999999999\n", VG_ERR_FORMAT, "count" },
    { HEAD "$Nodes\n1 1 1 1\n2 1 0 3000\n1\n", VG_ERR_FORMAT, "truncated" },
    { HEAD "$Nodes\n1 1 1 1\n5 1 0 1\n1\n0 0 0\n", VG_ERR_FORMAT, "entity" },
    { HEAD "$Nodes\n1 2 1 1\n2 1 0 1\n1\n0 0 0\n$EndNodes\n", VG_ERR_FORMAT,
      "announces 2" },
    { HEAD "$Nodes\n1 2 1 1\n2 1 0 2\n1\n1\n0 0 0\n1 1 1\n$EndNodes\n",
      VG_ERR_FORMAT, "defined twice" },
    { HEAD "$Nodes\n1 1 1 1\n2 1 0 1\n1\n0 0 nan\n$EndNodes\n", VG_ERR_FORMAT,
      "nan" },
    { HEAD "$Nodes\n1 1 1 1\n2 1 0 1\n1\n0 0 0 7 7\n$EndNodes\n", VG_ERR_FORMAT,
      "does not end" },
    { HEAD NODES "$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 4\n$EndElements\n",
      VG_ERR_INPUT, "node 4" },
    { HEAD NODES "$Elements\n1 1 1 1\n2 1 9 1\n1 1 2 3 1 2 3\n$EndElements\n",
      VG_ERR_UNSUPPORTED, "setorder 1" },
    { HEAD NODES "$Elements\n1 1 1 1\n2 3000000000 2 1\n1 1 2 3\n"
                 "$EndElements\n",
      VG_ERR_UNSUPPORTED, "32-bit" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    io_refuse(vg_gmsh_parse, bad[i].text, bad[i].code, bad[i].phrase);
}

/* --- round trips --- */

static void go_round(const struct vg_mesh *m, struct vg_mesh *back)
{
  const char *path = io_temp("round.msh");
  struct vg_error err = VG_ERROR_INIT;

  if (vg_gmsh_write(path, m, &err) != VG_OK ||
      vg_gmsh_read(path, back, &err) != VG_OK)
    fail_msg("%s", err.text);
  unlink(path);
}

static void all_kinds_come_back(void **state)
{
  static const char *const name[3] = { "low_end", "top", "patch_13" };
  struct vg_mesh m = VG_MESH_INIT, back = VG_MESH_INIT;

  (void)state;
  mixed_make(&m, 5, 4);
  go_round(&m, &back);
  mixed_same(&back, &m);
  for (size_t p = 0; p < 3; p++) {
    size_t n[2] = { 0, 0 };

    assert_int_equal(back.patch[p].id, m.patch[p].id);
    assert_string_equal(back.patch[p].name, name[p]);
    for (size_t i = 0; i < m.n_tri; i++) {
      n[0] += m.tri_patch[i] == p;
      n[1] += back.tri_patch[i] == p;
    }
    assert_int_equal(n[0], n[1]);
  }
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

/* The order of faces and their orientation are kept if no cells determine it;
 * numbers that Gmsh does not permit become 1, 2, ... */
static void surfaces_come_back(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, back = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 0);
  go_round(&m, &back);
  for (int p = 0; p < 4; p++) sprintf(m.patch[p].name, "patch_%d", p + 1);
  io_same(&m, &back, 1);
  for (int p = 0; p < 4; p++) m.patch[p].id = -p;
  go_round(&m, &back);
  for (int p = 0; p < 4; p++) m.patch[p].id = p + 1;
  io_same(&m, &back, 1);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

/* The first occurrence of text in the bytes of a file. */
static const char *find_text(const unsigned char *data, size_t n,
                             const char *text)
{
  return memmem(data, n, text, strlen(text));
}

/* Programs look up a group by its number or its name without the dimension, so
 * the group of the cells differs from all patches in both. */
static void the_volume_has_its_own_number_and_name(void **state)
{
  static const struct {
    int32_t id[3];
    const char *name[3], *volume;
  } c[] = {
    { { 1, 2, 3 }, { "low", "top", "far" }, "3 4 \"fluid\"\n" },
    { { 1, 7, 3 }, { "low", "fluid", "far" }, "3 8 \"fluid_1\"\n" },
    { { 3, 2, 1 }, { "Fluid", "fluid_1", "x" }, "3 4 \"fluid_2\"\n" },
    { { -5, 2, 9 }, { "low", "top", "far" }, "3 4 \"fluid\"\n" },
    { { INT32_MAX, 2, 9 }, { "a", "b", "c" }, "3 4 \"fluid\"\n" },
  };
  const char *path = io_temp("volume.msh");

  (void)state;
  for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
    struct vg_mesh m = VG_MESH_INIT, back = VG_MESH_INIT;
    unsigned char *data;
    size_t n;

    mixed_make(&m, 2, 2);
    for (int p = 0; p < 3; p++) {
      m.patch[p].id = c[i].id[p];
      strcpy(m.patch[p].name, c[i].name[p]);
    }
    assert_int_equal(vg_gmsh_write(path, &m, NULL), VG_OK);
    data = io_slurp(path, &n);
    if (!find_text(data, n, c[i].volume))
      fail_msg("case %zu has no %s", i, c[i].volume);
    free(data);
    assert_int_equal(vg_gmsh_read(path, &back, NULL), VG_OK);
    assert_int_equal(back.n_patch, 3);
    for (int p = 0; p < 3; p++) {
      int k = 0;

      while (k < 3 && strcmp(back.patch[k].name, c[i].name[p])) k++;
      assert_true(k < 3);
    }
    vg_mesh_release(&m);
    vg_mesh_release(&back);
  }
  unlink(path);
}

static void writes_nothing_for_an_empty_mesh(void **state)
{
  const char *path = io_temp("nothing.msh");
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  assert_int_equal(vg_gmsh_write(path, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "neither faces nor cells"));
  assert_int_equal(access(path, F_OK), -1);
  io_make_t1(&m, 1);
  assert_int_equal(vg_gmsh_write("/nowhere/at/all.msh", &m, &err), VG_ERR_IO);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_layout_is_read),
    cmocka_unit_test(damage_is_always_reported),
    cmocka_unit_test(surfaces_where_there_are_no_groups),
    cmocka_unit_test(refusals),
    cmocka_unit_test(all_kinds_come_back),
    cmocka_unit_test(surfaces_come_back),
    cmocka_unit_test(the_volume_has_its_own_number_and_name),
    cmocka_unit_test(writes_nothing_for_an_empty_mesh),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
