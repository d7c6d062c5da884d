/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "mixed_support.h"

#include <math.h>
#include <sys/stat.h>

#include "io/mesh/foam.h"
#include "run/commit/commit.h"
#include "run/commit/tree.h"

/* --- a reader of the written files, independent of the writer ------------ */

struct foam {
  size_t n_point, n_face, n_inner, n_cell;
  double (*point)[3];
  uint32_t (*face)[5]; /* width, nodes */
  uint32_t *owner, *neighbour;
  char *boundary;
};

static const char *in_case(const char *dir, const char *file)
{
  static char path[4][4400];
  static int turn;

  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "%s/%s", dir, file);
  return path[turn];
}

/* The file and the position after its header; *n is the length of the list
 * there, *at its first byte. */
static char *open_list(const char *dir, const char *file, size_t *n, char **at)
{
  char name[64];
  size_t size;
  char *data, *end;

  snprintf(name, sizeof name, "constant/polyMesh/%s", file);
  data = (char *)io_slurp(in_case(dir, name), &size);
  *at = strstr(data, "}\n\n");
  assert_non_null(*at);
  *n = strtoul(*at + 2, &end, 10);
  *at = strchr(end, '(');
  assert_non_null(*at);
  ++*at;
  return data;
}

static uint32_t *read_labels(const char *dir, const char *file, int is_ascii,
                             size_t *n)
{
  char *at, *data = open_list(dir, file, n, &at);
  uint32_t *v = malloc((*n + 1) * sizeof *v);

  if (is_ascii) {
    for (size_t i = 0; i < *n; i++) v[i] = (uint32_t)strtoul(at, &at, 10);
    assert_string_equal(at, "\n)\n");
  } else {
    memcpy(v, at, *n * sizeof *v);
    assert_string_equal(at + *n * sizeof *v, ")\n");
  }
  free(data);
  return v;
}

static void read_points(const char *dir, int is_ascii, struct foam *f)
{
  char *at, *data = open_list(dir, "points", &f->n_point, &at);

  f->point = malloc((f->n_point + 1) * sizeof *f->point);
  if (!is_ascii) {
    memcpy(f->point, at, f->n_point * sizeof *f->point);
    assert_string_equal(at + f->n_point * sizeof *f->point, ")\n");
  }
  for (size_t i = 0; is_ascii && i < f->n_point; i++)
    for (int k = 0; k < 3; k++) {
      at += strspn(at, " \n()");
      f->point[i][k] = strtod(at, &at);
    }
  free(data);
}

static void read_faces(const char *dir, int is_ascii, struct foam *f)
{
  size_t n, total;
  char *end, *at, *data = open_list(dir, "faces", &n, &at);
  const uint32_t *start = NULL, *node = NULL;

  if (!is_ascii) {
    start = memcpy(malloc(n * 4), at, n * 4);
    total = strtoul(at + n * 4 + 1, &end, 10);
    assert_int_equal(start[n - 1], total);
    assert_int_equal(start[0], 0);
    end++;
    assert_int_equal(*end, '(');
    node = memcpy(malloc(total * 4), end + 1, total * 4);
    assert_string_equal(end + 1 + total * 4, ")\n");
    n--;
  }
  f->n_face = n;
  f->face = malloc(n * sizeof *f->face);
  for (size_t i = 0; i < n; i++) {
    uint32_t *v = f->face[i];

    v[4] = UINT32_MAX;
    v[0] = is_ascii ? (uint32_t)strtoul(at, &at, 10) : start[i + 1] - start[i];
    assert_true(v[0] == 3 || v[0] == 4);
    for (uint32_t k = 0; k < v[0]; k++)
      v[1 + k] = is_ascii ? (uint32_t)strtoul(at + 1, &at, 10)
                          : node[start[i] + k];
    if (is_ascii) assert_memory_equal(at, ")\n", 2);
    at += is_ascii ? 2 : 0;
  }
  free((void *)start);
  free((void *)node);
  free(data);
}

static void load(const char *dir, int is_ascii, struct foam *f)
{
  size_t n, size;

  read_points(dir, is_ascii, f);
  read_faces(dir, is_ascii, f);
  f->owner = read_labels(dir, "owner", is_ascii, &n);
  assert_int_equal(n, f->n_face);
  f->neighbour = read_labels(dir, "neighbour", is_ascii, &f->n_inner);
  f->n_cell = 0;
  for (size_t i = 0; i < n; i++)
    if (f->owner[i] >= f->n_cell) f->n_cell = f->owner[i] + 1;
  f->boundary = (char *)io_slurp(in_case(dir, "constant/polyMesh/boundary"),
                                 &size);
}

static void unload(struct foam *f)
{
  free(f->point);
  free(f->face);
  free(f->owner);
  free(f->neighbour);
  free(f->boundary);
}

/* --- invariants --- */

static void upper_triangular(const struct foam *f)
{
  for (size_t i = 0; i < f->n_inner; i++) {
    assert_true(f->owner[i] < f->neighbour[i]);
    if (!i) continue;
    assert_true(f->owner[i - 1] <= f->owner[i]);
    assert_true(f->owner[i - 1] < f->owner[i] ||
                f->neighbour[i - 1] < f->neighbour[i]);
  }
}

/* Twice the area vector, and its product with a point of the face. */
static void area(const struct foam *f, size_t i, double n[3], double *volume)
{
  const uint32_t *v = f->face[i] + 1;
  const double *a = f->point[v[0]], *b = f->point[v[1]], *c = f->point[v[2]];
  const double *d = f->face[i][0] == 4 ? f->point[v[3]] : a;

  *volume = 0;
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;

    n[k] = (c[p] - a[p]) * (d[q] - b[q]) - (c[q] - a[q]) * (d[p] - b[p]);
  }
  for (int k = 0; k < 3; k++)
    *volume += n[k] * (f->face[i][0] == 4 ? (a[k] + b[k] + c[k] + d[k]) / 4
                                          : (a[k] + b[k] + c[k]) / 3);
}

/* The faces of every cell close it, seen from owner and neighbour. Its volume
 * is positive, so the faces point out; all volumes add up to `total`. */
static void closed_and_positive(const struct foam *f, double total)
{
  double(*sum)[4] = calloc(f->n_cell, sizeof *sum), all = 0;

  for (size_t i = 0; i < f->n_face; i++) {
    double n[3], v;

    area(f, i, n, &v);
    for (int k = 0; k < 4; k++) {
      double x = k < 3 ? n[k] : v / 6;

      sum[f->owner[i]][k] += x;
      if (i < f->n_inner) sum[f->neighbour[i]][k] -= x;
    }
  }
  for (size_t c = 0; c < f->n_cell; c++) {
    /* Sums of numbers of order one: rounding only. */
    for (int k = 0; k < 3; k++) assert_true(fabs(sum[c][k]) < 1e-12);
    assert_true(sum[c][3] > 1e-6);
    all += sum[c][3];
  }
  assert_true(fabs(all / total - 1) < 1e-12);
  free(sum);
}

static int count_text(const char *text, const char *what)
{
  int n = 0;

  for (; (text = strstr(text, what)); text++) n++;
  return n;
}

/* Value of an entry of a patch in the boundary file. */
static long patch_value(const struct foam *f, const char *name,
                        const char *entry)
{
  char head[200];
  const char *at;

  snprintf(head, sizeof head, "    %s\n    {", name);
  at = strstr(f->boundary, head);
  if (!at) fail_msg("no patch %s in %s", name, f->boundary);
  return strtol(strstr(at, entry) + strlen(entry), NULL, 10);
}

static int patch_is(const struct foam *f, const char *name, const char *type,
                    const char *physical)
{
  char text[400];

  snprintf(text, sizeof text,
           "    %s\n    {\n        type            %s;\n%s"
           "%s%s        nFaces ",
           name, type, *physical ? "        physicalType    " : "", physical,
           *physical ? ";\n" : "");
  return strstr(f->boundary, text) != NULL;
}

static const struct vg_foam_options as[2] = { { .is_ascii = 0 },
                                              { .is_ascii = 1 } };

static void write_case(const char *dir, const struct vg_mesh *m, int is_ascii)
{
  struct vg_error err = VG_ERROR_INIT;

  vg_tree_remove(dir);
  if (vg_foam_write(dir, m, as + is_ascii, &err)) fail_msg("%s", err.text);
}

static int exists(const char *path)
{
  return !access(path, F_OK);
}

/* A mesh that replaces the one of VG_TMP_DIR/NAME. */
struct replacing {
  struct vg_commit commit;
  const char *name;
};

static vg_status add_move(void *replacing, enum vg_foam_move kind,
                          const char *path, const char *to,
                          struct vg_error *err)
{
  const enum vg_move_kind kind_of[] = { VG_MOVE_FILE, VG_MOVE_FOLDER,
                                        VG_MOVE_REMOVE };
  struct replacing *r = replacing;
  char name[400];

  snprintf(name, sizeof name, "%s%s%s", r->name, *path ? "/" : "", path);
  return vg_commit_add(&r->commit, kind_of[kind],
                       kind == VG_FOAM_REMOVE ? "" : name, to ? to : name, err);
}

static void replace_case(const char *name, const struct vg_mesh *m,
                         int is_ascii)
{
  struct replacing r = { .name = name };
  const struct vg_foam_mover mover = { add_move, &r };
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_commit_open(VG_TMP_DIR, name, NULL, NULL, &r.commit,
                                  &err),
                   VG_OK);
  write_case(in_case(r.commit.fresh, name), m, is_ascii);
  if (vg_foam_merge(in_case(r.commit.fresh, name), io_temp(name), &mover,
                    &err) ||
      vg_commit_run(&r.commit, &err))
    fail_msg("%s", err.text);
  vg_commit_close(&r.commit);
}

/* --- tests --- */

/* The two tetrahedra of formats.md 4.3. */
static void two_tetrahedra_as_documented(void **state)
{
  static const double fifth[3] = { 1, 1, 1 };
  static const uint32_t tri[6][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 },
                                      { 1, 4, 2 }, { 1, 3, 4 }, { 2, 4, 3 } };
  static const uint32_t owner[7] = { 0, 0, 0, 0, 1, 1, 1 };
  const char *dir = io_temp("two.openfoam");
  struct vg_mesh m;
  struct foam f;

  (void)state;
  io_make_t1(&m, 1);
  m.point = realloc(m.point, 5 * sizeof *m.point);
  memcpy(m.point[4], fifth, sizeof fifth);
  m.n_point = 5;
  m.tri = realloc(m.tri, sizeof tri);
  memcpy(m.tri, tri, sizeof tri);
  m.n_tri = 6;
  m.tri_patch = realloc(m.tri_patch, 6 * sizeof *m.tri_patch);
  for (uint32_t i = 0; i < 6; i++) m.tri_patch[i] = i > 0;
  m.n_patch = 2;
  m.tet = realloc(m.tet, 2 * sizeof *m.tet);
  for (uint32_t k = 0; k < 4; k++) m.tet[1][k] = k + 1;
  m.n_tet = 2;
  write_case(dir, &m, 1);
  load(dir, 1, &f);
  assert_int_equal(f.n_point, 5);
  assert_int_equal(f.n_face, 7);
  assert_int_equal(f.n_inner, 1);
  assert_memory_equal(f.owner, owner, sizeof owner);
  assert_int_equal(f.neighbour[0], 1);
  assert_int_equal(patch_value(&f, "patch_1", "startFace"), 1);
  assert_int_equal(patch_value(&f, "patch_1", "nFaces"), 1);
  assert_int_equal(patch_value(&f, "patch_2", "startFace"), 2);
  assert_int_equal(patch_value(&f, "patch_2", "nFaces"), 5);
  closed_and_positive(&f, 0.5);
  unload(&f);
  vg_tree_remove(dir);
  assert_false(exists(dir));
  vg_mesh_release(&m);
}

static void all_kinds_of_cells(void **state)
{
  const char *dir = io_temp("mixed.openfoam");
  struct vg_mesh m;
  struct foam f, text;

  (void)state;
  mixed_make(&m, 5, 4);
  write_case(dir, &m, 0);
  load(dir, 0, &f);
  assert_int_equal(f.n_point, m.n_point);
  assert_memory_equal(f.point, m.point, m.n_point * sizeof *m.point);
  assert_int_equal(f.n_cell, mixed_n_cell(&m));
  assert_int_equal(f.n_face - f.n_inner, m.n_tri + m.n_quad);
  upper_triangular(&f);
  closed_and_positive(&f, mixed_volume(5, 4));
  assert_int_equal(count_text(f.boundary, "startFace"), 3);
  assert_int_equal(patch_value(&f, "low_end", "startFace"), f.n_inner);
  assert_int_equal(patch_value(&f, "low_end", "nFaces"), 20);
  assert_int_equal(patch_value(&f, "top", "nFaces"), 40);
  assert_int_equal(patch_value(&f, "patch_13", "nFaces"), 54);
  assert_true(patch_is(&f, "low_end", "wall", "viscousWall"));
  assert_true(patch_is(&f, "top", "patch", ""));
  for (size_t i = f.n_inner; i < f.n_inner + 20; i++)
    for (uint32_t k = 1; k <= f.face[i][0]; k++)
      assert_true(f.point[f.face[i][k]][2] == 0);
  /* The text file has the same values, to the last bit. */
  write_case(dir, &m, 1);
  load(dir, 1, &text);
  assert_memory_equal(f.point, text.point, m.n_point * sizeof *m.point);
  assert_int_equal(f.n_face, text.n_face);
  assert_int_equal(f.n_inner, text.n_inner);
  assert_memory_equal(f.face, text.face, f.n_face * sizeof *f.face);
  assert_memory_equal(f.owner, text.owner, f.n_face * sizeof *f.owner);
  assert_memory_equal(f.neighbour, text.neighbour,
                      f.n_inner * sizeof *f.neighbour);
  unload(&f);
  unload(&text);
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

/* The order of cells and points must not matter; faces between distant numbers
 * are found. */
static void cells_in_any_order(void **state)
{
  const char *dir = io_temp("order.openfoam");
  struct vg_mesh m;
  struct foam f;
  uint32_t seed = 7;

  (void)state;
  mixed_make(&m, 12, 10);
  for (size_t i = m.n_tet; i-- > 1;) {
    uint32_t t[4];
    size_t k;

    seed = seed * 1664525u + 1013904223u;
    k = (seed >> 8) % (i + 1);
    memcpy(t, m.tet[i], sizeof t);
    memcpy(m.tet[i], m.tet[k], sizeof t);
    memcpy(m.tet[k], t, sizeof t);
  }
  write_case(dir, &m, 0);
  load(dir, 0, &f);
  upper_triangular(&f);
  closed_and_positive(&f, mixed_volume(12, 10));
  unload(&f);
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

static void names_and_types(void **state)
{
  static const struct {
    const char *name;
    int32_t bc, fun3d;
  } given[] = { { "wing upper/lower;{x}", 4, 4000 },
                { "wing upper/lower (x)", 5, 3000 },
                { "3rd", 3, 5000 },
                { "sym", 1, 6662 },
                { "roof", VG_BC_NONE, 6663 },
                { "wing_upper_lower__x_", VG_BC_NONE, VG_BC_NONE } };
  const char *dir = io_temp("names.openfoam");
  struct vg_mesh m;
  struct foam f;

  (void)state;
  mixed_make(&m, 2, 2);
  for (int k = 0; k < 3; k++) vg_mesh_add_patch(&m, 20 + k, NULL);
  for (int k = 0; k < 6; k++) {
    snprintf(m.patch[k].name, VG_NAME_MAX, "%s", given[k].name);
    m.patch[k].bc = given[k].bc;
    m.patch[k].bc_fun3d = given[k].fun3d;
  }
  /* Top (planar), one side of five planes, and an empty patch. */
  for (size_t i = 0; i < m.n_tri; i++) m.tri_patch[i] = 4;
  for (size_t i = 0; i < m.n_quad; i++)
    if (m.quad_patch[i] == 2) m.quad_patch[i] = 3;
  write_case(dir, &m, 0);
  load(dir, 0, &f);
  assert_int_equal(count_text(f.boundary, "    {\n"), 6);
  assert_true(patch_is(&f, "wing_upper_lower__x_", "wall", "viscousWall"));
  assert_true(patch_is(&f, "wing_upper_lower__x__12", "wall", "inviscidWall"));
  assert_true(patch_is(&f, "patch_3rd", "patch", "farfield"));
  assert_true(patch_is(&f, "sym", "symmetry", "symmetry"));
  assert_true(patch_is(&f, "roof", "symmetryPlane", "symmetry"));
  assert_true(patch_is(&f, "wing_upper_lower__x__22", "patch", ""));
  unload(&f);
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

static void refuse(const struct vg_mesh *m, vg_status code, const char *phrase)
{
  const char *dir = io_temp("refused.openfoam");
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_foam_write(dir, m, NULL, &err), code);
  if (!strstr(err.text, phrase) || !strstr(err.text, "refused.openfoam"))
    fail_msg("'%s' has no '%s'", err.text, phrase);
  assert_false(exists(dir));
}

static void open_meshes_are_refused(void **state)
{
  struct vg_mesh m;

  (void)state;
  mixed_make(&m, 3, 2);
  m.n_tri--;
  refuse(&m, VG_ERR_INPUT, "prism");
  m.n_tri++;
  m.n_tet--;
  refuse(&m, VG_ERR_INPUT, "has neither a neighbouring");
  m.n_tet++;
  memcpy(m.hex[1], m.hex[0], sizeof m.hex[0]);
  refuse(&m, VG_ERR_INPUT, "boundary quadrilateral");
  vg_mesh_release(&m);
  mixed_make(&m, 1, 1);
  memcpy(m.tri[1], m.tri[0], sizeof m.tri[0]);
  refuse(&m, VG_ERR_INPUT, "boundary triangle 2");
  m.n_tet = m.n_pyr = m.n_pri = m.n_hex = 0;
  refuse(&m, VG_ERR_INPUT, "without cells");
  vg_mesh_release(&m);
}

static void unwritable_paths_are_reported(void **state)
{
  const char *file = io_temp("occupied.openfoam");
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_make_t1(&m, 1);
  io_write_file(file, "x", 1);
  assert_int_equal(vg_foam_write(file, &m, NULL, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "occupied.openfoam"));
  unlink(file);
  assert_int_equal(vg_foam_write(io_temp("none/such.openfoam"), &m, NULL, &err),
                   VG_ERR_IO);
  vg_mesh_release(&m);
}

/* Files that a user added to a case stay; files of the old mesh are removed. */
static void a_case_is_remeshed_in_place(void **state)
{
  const char *dir = io_temp("again.openfoam");
  static const char *const stale[] = { "constant/polyMesh/cellZones",
                                       "constant/polyMesh/points.gz",
                                       "constant/polyMesh/sets/bad" };
  static const char *const kept[] = { "constant/polyMesh/blockMeshDict",
                                      "constant/transportProperties",
                                      "system/controlDict", "0/U" };
  struct vg_mesh one, many;
  struct vg_error err = VG_ERROR_INIT;
  unsigned char *data;
  size_t size;
  struct foam f;

  (void)state;
  io_make_t1(&one, 1);
  mixed_make(&many, 2, 2);
  write_case(dir, &one, 0);
  assert_true(exists(in_case(dir, "again.foam")));
  assert_int_equal(mkdir(in_case(dir, "0"), 0777), 0);
  assert_int_equal(mkdir(in_case(dir, "constant/polyMesh/sets"), 0777), 0);
  for (int i = 0; i < 3; i++) io_write_file(in_case(dir, stale[i]), "old", 3);
  for (int i = 0; i < 4; i++) io_write_file(in_case(dir, kept[i]), "mine", 4);
  for (int turn = 0; turn < 2; turn++) {
    replace_case("again.openfoam", turn ? &one : &many, turn);
    load(dir, turn, &f);
    assert_int_equal(f.n_cell, turn ? 1 : mixed_n_cell(&many));
    unload(&f);
    for (int i = 0; i < 3; i++) assert_false(exists(in_case(dir, stale[i])));
    for (int i = 0; i < 4; i++) {
      data = io_slurp(in_case(dir, kept[i]), &size);
      assert_string_equal((char *)data, "mine");
      free(data);
    }
  }
  vg_tree_remove(dir);
  assert_int_equal(vg_foam_write(dir, &one, NULL, &err), VG_OK);
  assert_int_equal(vg_foam_write(dir, &one, NULL, &err), VG_ERR_IO);
  vg_tree_remove(dir);
  vg_mesh_release(&one);
  vg_mesh_release(&many);
}

/* The subdomains of an earlier mesh are removed, or replaced. */
static void subdomains_follow_their_mesh(void **state)
{
  const uint32_t part[1] = { 0 };
  const char *dir = io_temp("parted.openfoam");
  struct vg_mesh m;

  (void)state;
  io_make_t1(&m, 1);
  write_case(dir, &m, 0);
  assert_int_equal(vg_foam_write_parts(dir, 1, part, 1, NULL), VG_OK);
  replace_case("parted.openfoam", &m, 0);
  assert_false(exists(in_case(dir, "constant/cellDecomposition")));
  assert_true(exists(in_case(dir, "system/decomposeParDict")));
  vg_tree_remove(dir);
  replace_case("parted.openfoam", &m, 0); /* A new case. */
  assert_true(exists(in_case(dir, "parted.foam")));
  assert_true(exists(in_case(dir, "system/fvSchemes")));
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

/* Several cases may share a mesh by a link. */
static void a_linked_mesh_stays_linked(void **state)
{
  const char *dir = io_temp("linked.openfoam"), *mesh = io_temp("shared_mesh");
  struct vg_mesh m;
  struct stat s;
  struct foam f;

  (void)state;
  io_make_t1(&m, 1);
  write_case(dir, &m, 0);
  assert_int_equal(rename(in_case(dir, "constant/polyMesh"), mesh), 0);
  assert_int_equal(symlink(mesh, in_case(dir, "constant/polyMesh")), 0);
  replace_case("linked.openfoam", &m, 1);
  load(dir, 1, &f);
  assert_int_equal(f.n_cell, 1);
  unload(&f);
  assert_int_equal(lstat(in_case(dir, "constant/polyMesh"), &s), 0);
  assert_true(S_ISLNK(s.st_mode));
  vg_tree_remove(dir);
  assert_true(exists(in_case(mesh, "boundary")));
  vg_tree_remove(mesh);
  vg_mesh_release(&m);
}

/* A pole that every cell uses: chains by a single point would make this
 * quadratic, taking minutes. */
static void a_point_of_many_cells(void **state)
{
  const uint32_t n = 60000;
  const char *dir = io_temp("pole.openfoam");
  struct vg_mesh m = VG_MESH_INIT;
  struct foam f;

  (void)state;
  m.n_point = n + 2;
  m.n_tet = n;
  m.n_tri = 2 * n;
  m.point = malloc(m.n_point * sizeof *m.point);
  m.tet = malloc(n * sizeof *m.tet);
  m.tri = malloc(m.n_tri * sizeof *m.tri);
  m.tri_patch = calloc(m.n_tri, sizeof *m.tri_patch);
  vg_mesh_add_patch(&m, 1, "all");
  for (uint32_t i = 0; i < n; i++) {
    double turn = 2 * 3.14159265358979 * i / n, *p = m.point[i + 2];
    /* Every other cell has a distant number: few neighbours are consecutive. */
    uint32_t at = i % 2 ? n - 1 - i / 2 : i / 2;
    uint32_t a = at + 2, b = (at + 1) % n + 2;
    const uint32_t cell[4] = { 0, a, b, 1 };

    p[0] = 1e5 * cos(turn);
    p[1] = 1e5 * sin(turn);
    p[2] = 0;
    memcpy(m.tet[i], cell, sizeof cell);
    memcpy(m.tri[2 * i], (uint32_t[3]){ 0, a, b }, 12);
    memcpy(m.tri[2 * i + 1], (uint32_t[3]){ 1, b, a }, 12);
  }
  memcpy(m.point[0], (double[3]){ 0, 0, -1 }, 24);
  memcpy(m.point[1], (double[3]){ 0, 0, 1 }, 24);
  write_case(dir, &m, 0);
  load(dir, 0, &f);
  assert_int_equal(f.n_inner, n);
  upper_triangular(&f);
  unload(&f);
  vg_tree_remove(dir);
  vg_mesh_release(&m);
}

static void format_words(void **state)
{
  struct vg_foam_options o = { .is_ascii = 7 };

  (void)state;
  assert_false(vg_foam_word("open", &o));
  assert_false(vg_foam_word("foamy", &o));
  assert_int_equal(o.is_ascii, 7);
  assert_true(vg_foam_word("foam", &o) && !o.is_ascii);
  assert_true(vg_foam_word("openfoam", &o) && !o.is_ascii);
  assert_true(vg_foam_word("foam-ascii", &o) && o.is_ascii);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_tetrahedra_as_documented),
    cmocka_unit_test(all_kinds_of_cells),
    cmocka_unit_test(cells_in_any_order),
    cmocka_unit_test(names_and_types),
    cmocka_unit_test(open_meshes_are_refused),
    cmocka_unit_test(unwritable_paths_are_reported),
    cmocka_unit_test(a_case_is_remeshed_in_place),
    cmocka_unit_test(subdomains_follow_their_mesh),
    cmocka_unit_test(a_linked_mesh_stays_linked),
    cmocka_unit_test(a_point_of_many_cells),
    cmocka_unit_test(format_words),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
