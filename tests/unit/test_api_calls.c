/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Random sequences of calls of the library, with good and bad arguments, on two
 * jobs and on none: every call returns a status of the header and, if it fails,
 * has a message. The seed is fixed; an argument of the program replaces it. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <cmocka.h>

#include "api/vanguard.h"

#define FOLDER VG_TMP_DIR "/files of random calls"

enum { SEQUENCES = 60, CALLS = 24, N_JOB = 2, N_PIECE = 4 };

static uint64_t seed = 20261128;
static vanguard_job *job[N_JOB];
static struct vanguard_piece piece[N_PIECE];
static vanguard_job *inside; /* job whose callback runs */
static size_t n_done, n_failed, n_mesh, n_meshed;
static const char *last = "";

static unsigned pick(unsigned n)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (unsigned)(seed >> 33) % n;
}

#define ONE_OF(list) (list)[pick(sizeof(list) / sizeof *(list))]

/* Mostly a job of this sequence, sometimes none. */
static vanguard_job *some_job(void)
{
  return pick(40) ? job[pick(N_JOB)] : NULL;
}

/* A status of the header; after a failure, a message. */
static int expect(vanguard_job *j, vanguard_status st)
{
  if (st > 0 || st < VANGUARD_ERR_BUSY) fail_msg("%s: status %d", last, st);
  if (st < 0 && !*vanguard_message(j))
    fail_msg("%s: status %d without a message", last, st);
  n_done++;
  n_failed += st < 0;
  return !st;
}

/* --- surfaces ------------------------------------------------------------ */

enum { SIDE = 3, N_TRI = 12 * SIDE * SIDE };

static struct surface {
  size_t n;
  double x[8 * N_TRI][3];
  uint32_t tri[N_TRI][3];
  int32_t patch[N_TRI];
} box, ball;

static uint32_t point_of(struct surface *s, const double x[3])
{
  for (size_t i = 0; i < s->n; i++)
    if (!memcmp(s->x[i], x, sizeof s->x[i])) return (uint32_t)i;
  memcpy(s->x[s->n], x, sizeof *s->x);
  return (uint32_t)s->n++;
}

/* Normals point into the box; out: away from it. */
static void make_box(struct surface *s, int out)
{
  size_t n = 0;

  for (int face = 0; face < 6; face++)
    for (int i = 0; i < SIDE * SIDE; i++) {
      int a = face / 2, b = (a + 1) % 3, d = (a + 2) % 3;
      uint32_t p[4];

      for (int k = 0; k < 4; k++) {
        double x[3];

        x[a] = face % 2;
        x[b] = (i % SIDE + (k == 1 || k == 2)) / (double)SIDE;
        x[d] = (i / SIDE + (k > 1)) / (double)SIDE;
        p[k] = point_of(s, x);
      }
      for (int h = 0; h < 2; h++) {
        int flip = (face % 2) ^ out;

        s->tri[n][0] = p[0];
        s->tri[n][1] = p[1 + h + (flip ? 1 : 0)];
        s->tri[n][2] = p[2 + h - (flip ? 1 : 0)];
        s->patch[n++] = 10 + face;
      }
    }
}

static void make_surfaces(void)
{
  make_box(&box, 0);
  make_box(&ball, 1);
  for (size_t i = 0; i < ball.n; i++) {
    double r = 0;

    for (int k = 0; k < 3; k++) r += pow(ball.x[i][k] - 0.5, 2);
    for (int k = 0; k < 3; k++) ball.x[i][k] = (ball.x[i][k] - 0.5) / sqrt(r);
  }
}

static void put_text(const char *name, const char *text)
{
  char path[4096];
  FILE *to;

  snprintf(path, sizeof path, "%s/%s", FOLDER, name);
  to = fopen(path, "w");
  assert_non_null(to);
  fputs(text, to);
  assert_int_equal(fclose(to), 0);
}

static void put_stl(void)
{
  FILE *to = fopen(FOLDER "/box.stl", "w");

  assert_non_null(to);
  fprintf(to, "solid box\n");
  for (int t = 0; t < N_TRI; t++) {
    fprintf(to, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      const double *x = box.x[box.tri[t][k]];

      fprintf(to, "vertex %.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    fprintf(to, "endloop\nendfacet\n");
  }
  fprintf(to, "endsolid box\n");
  assert_int_equal(fclose(to), 0);
}

static void put_files(void)
{
  mkdir(FOLDER, 0755);
  mkdir(FOLDER "/folder", 0755);
  put_stl();
  put_text("damaged.stl", "solid x\nfacet normal 0 0 0\nouter loop\nver");
  put_text("empty.stl", "");
  put_text("damaged.lb8.ugrid", "1 2 3 4 5");
  put_text("damaged.vtu", "<VTKFile><Piece NumberOfPoints='9'>");
  put_text("text.txt", "neither a surface nor a deck\n");
  put_text("good.deck", "title\ngrowth hmax\n1.4 0.4\n");
  put_text("bad.deck", "title\ngrowth hmax\n1.4\n");
  put_text("patches.mapbc", "text\n10 4 0 0 0 0 a\n");
}

static const char *const files[] = {
  FOLDER "/box.stl",       FOLDER "/box",         FOLDER "/damaged.stl",
  FOLDER "/empty.stl",     FOLDER "/damaged.vtu", FOLDER "/damaged.lb8.ugrid",
  FOLDER "/text.txt",      FOLDER "/missing.stl", FOLDER "/missing",
  FOLDER "/folder",        "/nowhere/box.stl",    "",
  FOLDER "/good.deck",     FOLDER "/bad.deck",    NULL,
  FOLDER "/patches.mapbc", FOLDER "/box.stl",     FOLDER "/box.stl"
};

/* Most jobs begin with a surface that can be meshed. */
static void begin_job(unsigned k)
{
  assert_int_equal(vanguard_new(VANGUARD_ABI, &job[k]), VANGUARD_OK);
  if (!pick(4)) return;
  assert_int_equal(vanguard_surface(job[k], "box", box.n, box.x[0], N_TRI,
                                    box.tri[0], box.patch),
                   VANGUARD_OK);
  assert_int_equal(vanguard_set(job[k], "farfield_lengths", "2"), VANGUARD_OK);
}

/* --- callbacks ----------------------------------------------------------- */

static unsigned bits_of(const double x[3])
{
  uint64_t b[3];

  memcpy(b, x, sizeof b);
  return (unsigned)((b[0] ^ b[1] >> 7 ^ b[2] >> 13) % 1000);
}

/* Called by several threads at once. */
static double size_at(void *user, const double x[3])
{
  const char *kind = user;
  unsigned at = bits_of(x);

  if (*kind == 'n') return at ? 0.4 : NAN;
  if (*kind == '-') return at ? 0.5 : -1;
  if (*kind == '0') return 0;
  if (*kind == 'i') return INFINITY;
  return 0.3;
}

static void metric_at(void *user, const double x[3], double m[6])
{
  const double plain[6] = { 10, 0, 0, 10, 0, 30 };
  const char *kind = user;

  memcpy(m, plain, sizeof plain);
  if (*kind == 'n' && !bits_of(x)) m[0] = NAN;
  if (*kind == '-') m[5] = -1;
  if (*kind == '0') memset(m, 0, sizeof plain);
}

static const char *const kinds[] = { "good", "nan",      "-1",
                                     "0",    "infinity", "good" };

static void call(void);

/* Calls the library with the job that runs, and with the other one. */
static int progress(void *user, const char *phase, uint64_t done,
                    uint64_t expected)
{
  vanguard_job *outer = inside;
  int stop = 0;

  (void)phase, (void)done, (void)expected;
  if (user && !outer) {
    inside = user;
    if (!pick(8)) call();
    if (!pick(60)) vanguard_cancel(user);
    stop = !pick(60);
    inside = NULL;
  }
  return stop;
}

/* --- calls --------------------------------------------------------------- */

static void call_new(void)
{
  unsigned i = pick(N_JOB);
  vanguard_status st;

  if (job[i] == inside && inside) return;
  for (int k = 0; k < N_PIECE && pick(2); k++)
    vanguard_piece_put(job[i], &piece[k]);
  if (vanguard_close(job[i]) != VANGUARD_OK) return; /* further up in use */
  begin_job(i);
  if (!pick(10)) {
    vanguard_free(job[i]);
    st = vanguard_new((int)pick(1000) - 3, &job[i]);
    expect(job[i], st);
  }
  assert_int_equal(vanguard_new(VANGUARD_ABI, NULL), VANGUARD_ERR_USAGE);
}

static void call_set(void)
{
  static const char *const row[][2] = { { "growth", "1.4" },
                                        { "growth", "0.2" },
                                        { "growth", "" },
                                        { "hmax", "0.5" },
                                        { "hmax", "nan" },
                                        { "hmax", "-1e400" },
                                        { "layers", "yes" },
                                        { "layers", "no" },
                                        { "first", "0.01" },
                                        { "first", "1e-300" },
                                        { "farfield", "none" },
                                        { "farfield", "sphere" },
                                        { "sizes", FOLDER "/missing.vtu" },
                                        { "sizes", FOLDER "/damaged.vtu" },
                                        { "sizes", "" },
                                        { "mapbc", FOLDER "/missing.mapbc" },
                                        { "mapbc", FOLDER "/patches.mapbc" },
                                        { "mapbc", "" },
                                        { "mesher", "./missing.so" },
                                        { "mesher", "builtin" },
                                        { "helpers", FOLDER "/folder" },
                                        { "helpers", "" },
                                        { "write", "vtu,nothing" },
                                        { "write", "vtu" },
                                        { "threads", "2" },
                                        { "threads", "-1" },
                                        { "max_cells", "50" },
                                        { "max_cells", "0" },
                                        { "walls", "10,11" },
                                        { "walls", "wing" },
                                        { "walls", "" },
                                        { "surface_size", "0.4" },
                                        { "surface_size", "0" },
                                        { "half", "yes" },
                                        { "half", "auto" },
                                        { "parts", "3" },
                                        { "parts", "0" },
                                        { "nothing", "1" },
                                        { "", "" },
                                        { "close_holes", "yes" },
                                        { "cells", "mixed" },
                                        { "scale", "0" },
                                        { "scale", "2" },
                                        { NULL, "1" },
                                        { "growth", NULL } };
  vanguard_job *j = some_job();
  const char *const *r = ONE_OF(row);

  expect(j, vanguard_set(j, r[0], r[1]));
}

static void call_get(void)
{
  static const char *const name[] = { "growth", "sizes", "nothing", "", NULL };
  vanguard_job *j = some_job();
  char text[512];

  expect(j, vanguard_get(j, ONE_OF(name), pick(8) ? text : NULL,
                         pick(3) ? sizeof text : pick(3)));
}

static void call_add(void)
{
  static const char *const table[] = { "sources",  "patches", "layers",
                                       "farfield", "sweep",   "surface",
                                       "nothing",  "patches", NULL };
  static const char *const word[] = { "id",      "bc", "name", "kind",
                                      "x0",      "r0", "h0",   "first",
                                      "nothing", NULL, "" };
  static const char *const value[] = { "10", "99",   "4", "1",  "sphere", "0.2",
                                       "-1", "wing", "",  NULL, "1e999" };
  const char *column[4], *of[4];
  vanguard_job *j = some_job();
  unsigned n = pick(5);

  for (unsigned k = 0; k < 4; k++) {
    column[k] = ONE_OF(word);
    of[k] = ONE_OF(value);
  }
  if (pick(2)) { /* a row of the patches that may be right */
    column[0] = "id", column[1] = "bc";
    of[0] = pick(3) ? "14" : "99", of[1] = "4";
    expect(j, vanguard_add(j, "patches", 2, column, of));
    return;
  }
  expect(j, vanguard_add(j, ONE_OF(table), n, pick(9) ? column : NULL,
                         pick(9) ? of : NULL));
}

static void call_deck(void)
{
  static const char *const text[] = {
    "title\nhmax\n0.5\n",
    "title\nhmax growth\n0.5\n",
    "title\nhmax\nlarge\n",
    "title\npatches\nid bc name\n10 4 wall\n11 x\n\n",
    "title\nsources\nkind x0 h0\nsphere 0\n",
    "title\nfarfield\nkind\nnone\n",
    "",
    "\n\n#\n",
    "\"",
    "title\n\x01\x02\xff\n",
    NULL
  };
  vanguard_job *j = some_job();

  expect(j, vanguard_deck(j, ONE_OF(text)));
}

static void call_open(void)
{
  static const char *const deck[] = { NULL,
                                      NULL,
                                      NULL,
                                      FOLDER "/good.deck",
                                      FOLDER "/bad.deck",
                                      FOLDER "/missing.deck",
                                      FOLDER "/folder",
                                      "" };
  vanguard_job *j = some_job();

  expect(j, vanguard_open(j, ONE_OF(files), ONE_OF(deck)));
}

static void call_surface(void)
{
  static const char *const name[] = { "box",        "box", "",
                                      "/nowhere/x", "a b", NULL };
  static struct surface s;
  vanguard_job *j = some_job();
  size_t n_tri = N_TRI;

  s = pick(3) ? box : ball;
  switch (pick(12)) {
  case 0: s.tri[5][1] = (uint32_t)s.n; break;
  case 1: s.x[3][1] = NAN; break;
  case 2: s.x[3][1] = 1e300; break;
  case 3: n_tri--; break;
  case 4: n_tri = pick(3); break;
  case 5: memset(s.x, 0, sizeof s.x); break;
  case 6: memset(s.tri, 0, sizeof s.tri); break;
  case 7: s.patch[0] = INT32_MIN, s.patch[1] = INT32_MAX; break;
  default: break;
  }
  expect(j, vanguard_surface(j, ONE_OF(name), pick(30) ? s.n : 0,
                             pick(20) ? s.x[0] : NULL, n_tri,
                             pick(20) ? s.tri[0] : NULL,
                             pick(4) ? s.patch : NULL));
}

static void call_sizes(void)
{
  static const double bad[] = { 0.3, 0.5, -1, 0, NAN, INFINITY, 0.3, 0.4 };
  static const uint32_t tet[2][4] = { { 0, 1, 2, 3 }, { 0, 1, 2, 9 } };
  static const double at[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  double metric[4][6] = { { 0 } }, size[4];
  vanguard_job *j = some_job();
  unsigned n = pick(5);

  for (int i = 0; i < 4; i++) {
    size[i] = pick(4) ? 0.4 : ONE_OF(bad);
    metric[i][0] = metric[i][3] = 9, metric[i][5] = pick(4) ? 16 : ONE_OF(bad);
  }
  switch (pick(4)) {
  case 0:
    expect(j, vanguard_sizes(j, pick(5) ? size_at : NULL,
                             (void *)(uintptr_t)ONE_OF(kinds)));
    break;
  case 1:
    expect(j, vanguard_metrics(j, pick(5) ? metric_at : NULL,
                               (void *)(uintptr_t)ONE_OF(kinds)));
    break;
  case 2:
    expect(j, vanguard_size_points(j, n, pick(9) ? at[0] : NULL,
                                   pick(9) ? size : NULL));
    break;
  default:
    expect(j, vanguard_metric_points(j, n, pick(9) ? at[0] : NULL,
                                     pick(9) ? metric[0] : NULL, pick(3),
                                     pick(9) ? tet[0] : NULL));
  }
}

/* A size of a structure that is right, not set, or that of an older program. */
static size_t some_size(size_t whole)
{
  return pick(6) ? whole : pick(3) ? whole / 2 / 8 * 8 : pick(9);
}

static void call_forecast(vanguard_job *j)
{
  static const int ranks[] = { 1, 1, 3, 64, 0, -1, INT32_MAX };
  static const int threads[] = { 0, 1, 2, 8, -1, INT32_MAX };
  struct vanguard_forecast f = { .struct_size = some_size(sizeof f) };

  if (expect(j, vanguard_forecast(j, ONE_OF(ranks), ONE_OF(threads),
                                  pick(2) ? progress : NULL, j,
                                  pick(12) ? &f : NULL)) &&
      f.struct_size == sizeof f)
    assert_true(f.n_cell > 0 && f.seconds > 0 && f.memory > 0 && *f.peak_stage);
}

static void call_mesh(void)
{
  vanguard_job *j = some_job();

  if (!pick(5)) {
    expect(j, vanguard_check(j, pick(2) ? progress : NULL, j));
    return;
  }
  if (!pick(8)) {
    expect(j, vanguard_make_surface(j, pick(2) ? progress : NULL, j));
    return;
  }
  if (!pick(8)) {
    static const char *const file[] = { FOLDER "/out.b8.ugrid",
                                        FOLDER "/damaged.lb8.ugrid",
                                        FOLDER "/box.stl",
                                        "/nowhere/a.ugrid",
                                        FOLDER "/folder",
                                        "",
                                        NULL };

    expect(j, vanguard_read(j, ONE_OF(file)));
    return;
  }
  if (!pick(8)) {
    call_forecast(j);
    return;
  }
  if (pick(3)) vanguard_set(j, "max_cells", "20000");
  n_mesh++;
  n_meshed += (size_t)expect(j, vanguard_mesh(j, pick(2) ? progress : NULL, j));
}

static size_t some_index(void)
{
  return pick(4) ? pick(3) : pick(2) ? SIZE_MAX : 1000;
}

#define ASK(function, type, ...)                                               \
  do {                                                                         \
    struct type out;                                                           \
    memset(&out, 0, sizeof out);                                               \
    out.struct_size = some_size(sizeof out);                                   \
    expect(j, function(j, __VA_ARGS__ pick(12) ? &out : NULL));                \
  } while (0)

static void call_report(vanguard_job *j)
{
  static const char *const form[] = { "json", "text", "html", NULL };
  const char *text = NULL;

  if (expect(j, vanguard_report(j, ONE_OF(form), pick(9) ? &text : NULL)))
    assert_true(*text);
}

static void call_figures(void)
{
  vanguard_job *j = some_job();
  struct vanguard_setting s = { .struct_size = some_size(sizeof s) };

  switch (pick(10)) {
  case 7: ASK(vanguard_boundary, vanguard_boundary, ); break;
  case 8: ASK(vanguard_boundary_patch, vanguard_patch, some_index(), ); break;
  case 9: call_report(j); break;
  case 0: ASK(vanguard_count, vanguard_counts, ); break;
  case 1: ASK(vanguard_measure, vanguard_quality, ); break;
  case 2: ASK(vanguard_patch, vanguard_patch, some_index(), ); break;
  case 3: ASK(vanguard_wall, vanguard_wall, some_index(), ); break;
  case 4: ASK(vanguard_wall_points, vanguard_wall_points, ); break;
  case 5:
    assert_non_null(vanguard_details(j));
    vanguard_note(j, some_index());
    vanguard_cause((int32_t)some_index());
    break;
  default: vanguard_setting(some_index(), pick(8) ? &s : NULL);
  }
}

static void call_arrays(void)
{
  vanguard_job *j = some_job();
  struct vanguard_counts n = VANGUARD_INIT(n);
  struct vanguard_boundary b = VANGUARD_INIT(b);
  const uint32_t *tri;
  double *x;
  uint32_t *tet;

  if (!vanguard_boundary(j, &b)) {
    tet = malloc((b.n_tri + 1) * 3 * sizeof *tet);
    assert_true(expect(j, vanguard_boundary_arrays(j, NULL, tet, NULL)));
    for (size_t i = 0; i < 3 * b.n_tri; i++) assert_true(tet[i] < b.n_point);
    free(tet);
  }
  if (vanguard_count(j, &n) < 0) {
    expect(j, vanguard_arrays(j, NULL, NULL, NULL, NULL));
    expect(j, vanguard_hexahedra(j, NULL));
    assert_null(vanguard_triangles(j));
    assert_null(vanguard_quads(j));
    assert_null(vanguard_quad_patches(j));
    assert_null(vanguard_triangle_patches(j));
    return;
  }
  x = malloc((n.n_point + 1) * 3 * sizeof *x);
  tet = malloc((n.n_tet + 1) * 4 * sizeof *tet);
  assert_true(
    expect(j, vanguard_arrays(j, pick(4) ? x : NULL, tet, NULL, NULL)));
  for (size_t i = 0; i < 4 * n.n_tet; i++) assert_true(tet[i] < n.n_point);
  assert_true(expect(j, vanguard_hexahedra(j, NULL)));
  tri = vanguard_triangles(j);
  for (size_t i = 0; i < 3 * n.n_tri; i++) assert_true(tri[i] < n.n_point);
  free(x);
  free(tet);
}

/* Pieces are returned in any order, also to another job and after the mesh. */
static void call_pieces(void)
{
  vanguard_job *j = some_job();
  struct vanguard_piece *p = &piece[pick(N_PIECE)];

  if (pick(2)) {
    vanguard_piece_put(j, pick(9) ? p : NULL);
    return;
  }
  if (!pick(9)) {
    expect(j, vanguard_piece_get(j, 0, NULL));
    return;
  }
  memset(p, 0, sizeof *p);
  p->struct_size = some_size(sizeof *p);
  expect(j, vanguard_piece_get(j,
                               pick(3) ? pick((unsigned)vanguard_pieces(j) + 1)
                                       : 1u << 20,
                               p));
}

static void call_write(void)
{
  static const char *const stem[] = {
    FOLDER "/out", FOLDER "/out", "/nowhere/out", FOLDER "/folder", "",
    FOLDER "/",    NULL
  };
  static const char *const form[] = { "vtu", "b8.ugrid,su2", "nothing", "", ",",
                                      NULL,  "foam",         "wall.vtu" };
  vanguard_job *j = some_job();

  expect(j, vanguard_write(j, ONE_OF(stem), ONE_OF(form)));
}

static void call(void)
{
  static const struct {
    const char *name;
    void (*make)(void);
  } calls[] = { { "new", call_new },         { "set", call_set },
                { "set", call_set },         { "get", call_get },
                { "add", call_add },         { "deck", call_deck },
                { "open", call_open },       { "surface", call_surface },
                { "surface", call_surface }, { "sizes", call_sizes },
                { "mesh", call_mesh },       { "mesh", call_mesh },
                { "mesh", call_mesh },       { "mesh", call_mesh },
                { "figures", call_figures }, { "figures", call_figures },
                { "arrays", call_arrays },   { "pieces", call_pieces },
                { "pieces", call_pieces },   { "write", call_write } };
  unsigned i = pick(sizeof calls / sizeof *calls);

  last = calls[i].name;
  calls[i].make();
}

static void every_sequence_gives_statuses(void **state)
{
  (void)state;
  for (int i = 0; i < SEQUENCES; i++) {
    const uint64_t start = seed;

    if (getenv("VG_SHOW_CALLS")) printf("sequence %d: %ju\n", i, start);
    fflush(stdout);
    for (unsigned k = 0; k < N_JOB; k++) begin_job(k);
    for (int k = 0; k < CALLS; k++) call();
    for (int k = 0; k < N_JOB; k++) vanguard_free(job[k]);
    memset(piece, 0, sizeof piece);
  }
  printf("%zu calls, %zu failed; %zu of %zu runs made a mesh\n", n_done,
         n_failed, n_meshed, n_mesh);
  assert_true(n_failed > n_done / 10 && n_failed < n_done);
  assert_true(n_meshed > n_mesh / 10);
}

/* MPI itself would abort the process. */
static void communicators_need_mpi(void **state)
{
  vanguard_job *made = NULL;
  int word = 0;

  (void)state;
  assert_int_equal(vanguard_new_fortran(VANGUARD_ABI, 0, &made),
                   VANGUARD_ERR_USAGE);
  assert_non_null(strstr(vanguard_message(made), "MPI is not initialised"));
  vanguard_free(made);
  assert_int_equal(vanguard_new_mpi(VANGUARD_ABI, &word, &made),
                   VANGUARD_ERR_USAGE);
  vanguard_free(made);
}

static void surfaces_have_triangles(void **state)
{
  vanguard_job *made;

  (void)state;
  assert_int_equal(vanguard_new(VANGUARD_ABI, &made), VANGUARD_OK);
  assert_int_equal(vanguard_surface(made, "none", 0, NULL, 0, NULL, NULL),
                   VANGUARD_ERR_INPUT);
  assert_non_null(strstr(vanguard_message(made), "has no triangles"));
  vanguard_free(made);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(communicators_need_mpi),
    cmocka_unit_test(surfaces_have_triangles),
    cmocka_unit_test(every_sequence_gives_statuses),
  };

  if (argc > 1) seed = strtoull(argv[1], NULL, 10);
  make_surfaces();
  put_files();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
