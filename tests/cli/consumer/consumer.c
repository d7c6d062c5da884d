/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A program outside the project that calls every function of the library, also
 * with input that the library must refuse. Usage: consumer FOLDER */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vanguard/vanguard.h>

static int n_bad;

#define CHECK(what) check(!!(what), #what, __LINE__)

static int check(int ok, const char *what, int line)
{
  if (!ok) printf("consumer.c:%d: %s\n", line, what);
  n_bad += !ok;
  return ok;
}

static int says(const vanguard_job *job, const char *word)
{
  if (strstr(vanguard_message(job), word)) return 1;
  printf("message: %s\n", vanguard_message(job));
  return 0;
}

static int notes_say(const vanguard_job *job, const char *words)
{
  const char *note;

  for (size_t i = 0; (note = vanguard_note(job, i)); i++)
    if (strstr(note, words)) return 1;
  return 0;
}

/* --- a cube of N x N squares a side -------------------------------------- */

enum { N = 12, SIDE = 6 * N * N };

struct cube {
  size_t n_point;
  double x[8 * SIDE][3];
  uint32_t tri[2 * SIDE][3];
  int32_t patch[2 * SIDE];
};

static uint32_t point_of(struct cube *c, const double x[3])
{
  for (size_t i = 0; i < c->n_point; i++)
    if (!memcmp(c->x[i], x, sizeof c->x[i])) return (uint32_t)i;
  memcpy(c->x[c->n_point], x, sizeof *c->x);
  return (uint32_t)c->n_point++;
}

/* Normals point in: the cube is the domain. */
static void make_cube(struct cube *c)
{
  size_t n = 0;

  memset(c, 0, sizeof *c);
  for (int face = 0; face < 6; face++)
    for (int i = 0; i < N * N; i++) {
      int a = face / 2, b = (a + 1) % 3, d = (a + 2) % 3;
      uint32_t p[4];

      for (int k = 0; k < 4; k++) {
        double x[3];

        x[a] = face % 2;
        x[b] = (i % N + (k == 1 || k == 2)) / (double)N;
        x[d] = (i / N + (k > 1)) / (double)N;
        p[k] = point_of(c, x);
      }
      for (int h = 0; h < 2; h++) {
        uint32_t t[3] = { p[0], p[1 + h], p[2 + h] };
        int flip = face % 2;

        memcpy(c->tri[n], (uint32_t[3]){ t[0], t[1 + flip], t[2 - flip] },
               sizeof *c->tri);
        c->patch[n++] = 10 + face;
      }
    }
}

static struct cube cube;

static vanguard_job *new_cube(void)
{
  vanguard_job *job;

  CHECK(vanguard_new(VANGUARD_ABI, &job) == VANGUARD_OK);
  CHECK(vanguard_surface(job, "cube", cube.n_point, cube.x[0], 2 * SIDE,
                         cube.tri[0], cube.patch) == VANGUARD_OK);
  return job;
}

/* --- a mesh in arrays ---------------------------------------------------- */

struct arrays {
  struct vanguard_counts n;
  double *x;
  uint32_t *cell[4];
};

static void take(vanguard_job *job, struct arrays *a)
{
  a->n = (struct vanguard_counts)VANGUARD_INIT(a->n);
  CHECK(vanguard_count(job, &a->n) == VANGUARD_OK);
  a->x = calloc(a->n.n_point + 1, 3 * sizeof *a->x);
  a->cell[0] = calloc(a->n.n_tet + 1, 4 * sizeof *a->cell[0]);
  a->cell[1] = calloc(a->n.n_pyr + 1, 5 * sizeof *a->cell[1]);
  a->cell[2] = calloc(a->n.n_pri + 1, 6 * sizeof *a->cell[2]);
  a->cell[3] = calloc(a->n.n_hex + 1, 8 * sizeof *a->cell[3]);
  CHECK(vanguard_arrays(job, a->x, a->cell[0], a->cell[1], a->cell[2]) ==
        VANGUARD_OK);
  CHECK(vanguard_hexahedra(job, a->cell[3]) == VANGUARD_OK);
}

static void drop(struct arrays *a)
{
  free(a->x);
  for (int k = 0; k < 4; k++) free(a->cell[k]);
}

static int same(const struct arrays *a, const struct arrays *b)
{
  return a->n.n_point == b->n.n_point && a->n.n_tet == b->n.n_tet &&
         a->n.n_pri == b->n.n_pri && a->n.n_pyr == b->n.n_pyr &&
         a->n.n_hex == b->n.n_hex &&
         !memcmp(a->x, b->x, a->n.n_point * 3 * sizeof *a->x) &&
         !memcmp(a->cell[0], b->cell[0], a->n.n_tet * 16) &&
         !memcmp(a->cell[1], b->cell[1], a->n.n_pyr * 20) &&
         !memcmp(a->cell[2], b->cell[2], a->n.n_pri * 24) &&
         !memcmp(a->cell[3], b->cell[3], a->n.n_hex * 32);
}

static double volume_of(const struct arrays *a)
{
  double sum = 0;

  for (uint64_t c = 0; c < a->n.n_tet; c++) {
    const double *o = a->x + 3 * a->cell[0][4 * c];
    double e[3][3];

    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        e[j][k] = a->x[3 * a->cell[0][4 * c + 1 + (unsigned)j] + (unsigned)k] -
                  o[k];
    sum += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
            e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
  }
  return sum;
}

/* --- tests --------------------------------------------------------------- */

static void refuses_another_abi(void)
{
  vanguard_job *job;

  CHECK(vanguard_new(VANGUARD_ABI + 1, &job) == VANGUARD_ERR_UNSUPPORTED);
  CHECK(says(job, "ABI"));
  CHECK(vanguard_set(job, "growth", "1.3") == VANGUARD_ERR_USAGE);
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_USAGE);
  vanguard_free(job);
  vanguard_free(NULL);
  CHECK(*vanguard_message(NULL));
}

static void sets_by_name(void)
{
  const char *column[] = { "kind", "x0", "h0" };
  const char *value[] = { "point", "0.5", "0.1" };
  struct vanguard_setting s = VANGUARD_INIT(s);
  vanguard_job *job;
  char text[512];
  size_t n = 0;

  CHECK(vanguard_new(VANGUARD_ABI, &job) == VANGUARD_OK);
  CHECK(vanguard_set(job, "growth", "1.35") == VANGUARD_OK);
  CHECK(vanguard_get(job, "growth", text, sizeof text) == VANGUARD_OK &&
        !strcmp(text, "1.35"));
  CHECK(vanguard_get(job, "growth", text, 4) == VANGUARD_ERR_USAGE);
  CHECK(vanguard_set(job, "growht", "1.2") == VANGUARD_ERR_INPUT &&
        says(job, "did you mean 'growth'"));
  CHECK(vanguard_set(job, "growth", "0.5") == VANGUARD_ERR_INPUT &&
        says(job, "above 1"));
  CHECK(vanguard_set(job, "farfield-lengths", "7") == VANGUARD_OK);
  CHECK(vanguard_add(job, "sources", 3, column, value) == VANGUARD_OK);
  CHECK(vanguard_add(job, "sources", 2, column, value) == VANGUARD_ERR_INPUT &&
        says(job, "h0"));
  CHECK(vanguard_add(job, "source", 3, column, value) == VANGUARD_ERR_INPUT);
  CHECK(vanguard_deck(job, "title\nhmax\n0.5\n") == VANGUARD_OK);
  CHECK(vanguard_deck(job, "title\nhmax\nlarge\n") < 0 && says(job, "deck:3"));
  while (vanguard_setting(n, &s)) n++, CHECK(s.name && s.help && s.kind);
  CHECK(n > 40);
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_USAGE &&
        says(job, "vanguard_surface"));
  CHECK(vanguard_count(job, &(struct vanguard_counts){ .struct_size = 8 }) ==
        VANGUARD_ERR_USAGE);
  CHECK(!vanguard_triangles(job) && !vanguard_pieces(job));
  vanguard_free(job);
}

static void refuses_bad_surfaces(void)
{
  vanguard_job *job = new_cube();
  struct cube bad = cube;

  bad.tri[7][1] = (uint32_t)bad.n_point;
  CHECK(vanguard_surface(job, "bad", bad.n_point, bad.x[0], 2 * SIDE,
                         bad.tri[0], NULL) == VANGUARD_ERR_INPUT &&
        says(job, "triangle 7"));
  bad = cube;
  bad.x[3][1] = NAN;
  CHECK(!vanguard_surface(job, "nan", bad.n_point, bad.x[0], 2 * SIDE,
                          bad.tri[0], NULL));
  CHECK(vanguard_mesh(job, NULL, NULL) < 0 && *vanguard_message(job));
  /* A hole in the middle of a side. */
  memcpy(bad.tri[SIDE / 12], cube.tri[0], sizeof *bad.tri);
  CHECK(!vanguard_surface(job, "open", cube.n_point, cube.x[0], 2 * SIDE - 1,
                          cube.tri[0], cube.patch));
  CHECK(!vanguard_set(job, "farfield", "none"));
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_GEOMETRY &&
        says(job, "the surface is open"));
  CHECK(strstr(vanguard_details(job), "open"));
  vanguard_free(job);
}

/* Failures before the surface has been checked, and arguments that are NULL. */
static void survives_early_failures(void)
{
  const char *column[] = { "id", "bc" }, *value[] = { "99", "4" };
  vanguard_job *job = new_cube();
  struct vanguard_counts n = { 0 };
  struct vanguard_piece s = VANGUARD_INIT(s);

  CHECK(!vanguard_add(job, "patches", 2, column, value));
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_INPUT &&
        says(job, "no patch 99") && !*vanguard_details(job));
  vanguard_free(job);
  job = new_cube();
  CHECK(!vanguard_set(job, "sizes", "/nowhere/sizes.vtu"));
  CHECK(vanguard_mesh(job, NULL, NULL) < 0 && says(job, "/nowhere/sizes.vtu"));
  CHECK(!vanguard_set(job, "sizes", "") && !vanguard_mesh(job, NULL, NULL));
  CHECK(vanguard_set(job, NULL, "1") == VANGUARD_ERR_USAGE &&
        says(job, "'name' is NULL"));
  CHECK(vanguard_set(NULL, "growth", "1") == VANGUARD_ERR_USAGE);
  CHECK(vanguard_count(job, &n) == VANGUARD_ERR_USAGE &&
        says(job, "VANGUARD_INIT"));
  CHECK(!vanguard_piece_get(job, 0, &s) && !vanguard_mesh(job, NULL, NULL));
  vanguard_piece_put(job, &s); /* a piece of the mesh before */
  vanguard_free(job);
}

static void gives_arrays_and_pieces(void)
{
  vanguard_job *job = new_cube();
  struct {
    struct vanguard_counts n;
  } old = { VANGUARD_INIT(old.n) };
  struct vanguard_quality q = VANGUARD_INIT(q);
  struct vanguard_patch p = VANGUARD_INIT(p);
  struct vanguard_wall_points walls = VANGUARD_INIT(walls);
  struct arrays a;
  uint64_t n_tet = 0, n_own = 0;

  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &a);
  CHECK(a.n.n_tet > 100 && !a.n.n_pri && a.n.n_tri == 2 * SIDE);
  CHECK(a.n.n_patch == 6 && !vanguard_patch(job, 2, &p) && p.id == 12);
  CHECK(vanguard_patch(job, 6, &p) == VANGUARD_ERR_USAGE);
  CHECK(fabs(volume_of(&a) - 1) < 1e-12); /* a sum of thousands of terms */
  CHECK(!vanguard_measure(job, &q) && fabs(q.volume - 1) < 1e-12 &&
        q.angle_min > 5 && q.angle_max < 175);
  for (size_t i = 0; i < vanguard_pieces(job); i++) {
    struct vanguard_piece s = VANGUARD_INIT(s);

    CHECK(!vanguard_piece_get(job, i, &s));
    for (size_t k = 0; k < s.n_own; k++, n_own++)
      CHECK(!memcmp(s.xyz + 3 * s.own[k], a.x + 3 * (s.own_at + k), 24));
    for (size_t k = 0; k < 4 * s.n_tet; k++)
      if (s.id[s.tet[k]] != a.cell[0][4 * s.tet_at + k]) n_bad++;
    n_tet += s.n_tet;
    vanguard_piece_put(job, &s);
    vanguard_piece_put(job, &s);
  }
  CHECK(n_tet == a.n.n_tet && n_own == a.n.n_point);
  /* A program compiled against an older, shorter structure. */
  old.n.struct_size = offsetof(struct vanguard_counts, n_pyr);
  old.n.n_tri = 77;
  CHECK(!vanguard_count(job, &old.n) && old.n.n_tet == n_tet &&
        old.n.n_tri == 77);
  CHECK(!vanguard_walls(job));
  CHECK(!vanguard_wall_points(job, &walls) && !walls.n_point && !walls.level);
  drop(&a);
  vanguard_free(job);
}

static void add_patch(vanguard_job *job, const char *id, const char *bc,
                      const char *name)
{
  const char *column[] = { "id", "bc", "name" };
  const char *value[] = { id, bc, name };

  CHECK(!vanguard_add(job, "patches", 3, column, value));
}

/* The values at the points of the floor must agree with the statistics of the
 * patch. */
static void tells_wall_points(vanguard_job *job, const struct arrays *a,
                              const struct vanguard_wall *w)
{
  struct vanguard_wall_points p = VANGUARD_INIT(p);
  double first[2] = { INFINITY, 0 }, level = 0;
  size_t n = 0;

  CHECK(!vanguard_wall_points(job, &p) && p.n_point == (N + 1) * (N + 1));
  for (size_t i = 0; i < p.n_point; i++) {
    if (!CHECK(p.point[i] < a->n.n_boundary_point)) return;
    CHECK(!i || p.point[i] > p.point[i - 1]);
    CHECK(a->x[3 * p.point[i] + 2] == 0); /* the floor is z = 0 */
    CHECK(p.level[i] <= p.wanted[i] && p.total[i] >= p.first[i]);
    CHECK(vanguard_cause(p.cause[i]) && vanguard_cause(p.compressed[i]));
    if (!p.level[i]) continue;
    CHECK(p.asked[i] == 0.01 && p.growth[i] >= 1 && p.share[i] > 0);
    first[0] = fmin(first[0], p.first[i]);
    first[1] = fmax(first[1], p.first[i]);
    level += p.level[i];
    n++;
  }
  CHECK(n == w->n_point && first[0] == w->first[0] && first[1] == w->first[2]);
  CHECK(fabs(level / (double)n - w->level[1]) <
        1e-9); /* depends on the order of summation */
}

static void names_causes(void)
{
  CHECK(!strcmp(vanguard_cause(0), "none") &&
        !strcmp(vanguard_cause(6), "collision"));
  CHECK(!vanguard_cause(-1) && !vanguard_cause(11));
}

static void grows_layers(void)
{
  vanguard_job *job = new_cube();
  struct vanguard_wall w = VANGUARD_INIT(w);
  struct vanguard_patch p = VANGUARD_INIT(p);
  struct vanguard_zone zone = VANGUARD_INIT(zone);
  struct arrays a;

  add_patch(job, "14", "4", "floor");
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_GEOMETRY &&
        strstr(vanguard_details(job), "condition"));
  for (int i = 0; i < 5; i++)
    add_patch(job, (const char *[]){ "10", "11", "12", "13", "15" }[i], "1",
              "side");
  CHECK(!vanguard_set(job, "cells", "mixed") &&
        !vanguard_set(job, "first", "0.01") &&
        !vanguard_set(job, "layers", "yes"));
  CHECK(!vanguard_mesh(job, NULL, NULL) || says(job, "?"));
  take(job, &a);
  CHECK(a.n.n_pri > 0 && a.n.n_layer_pri == a.n.n_pri);
  CHECK(vanguard_walls(job) == 1 && !vanguard_wall(job, 0, &w));
  CHECK(!vanguard_patch(job, w.patch, &p) && !strcmp(p.name, "floor"));
  CHECK(w.level[0] >= 1 && fabs(w.first[1] - 0.01) < 1e-3);
  tells_wall_points(job, &a, &w);
  CHECK(!vanguard_wall(job, 1, &w) && w.patch == SIZE_MAX);
  CHECK(vanguard_wall(job, 2, &w) == VANGUARD_ERR_USAGE);
  CHECK(a.n.n_quad && vanguard_quads(job) && vanguard_quad_patches(job));
  CHECK(!a.n.n_sheet && !a.n.n_sheet_tri && !vanguard_sheet_triangles(job) &&
        !vanguard_sheet_numbers(job));
  CHECK(vanguard_sheet(job, 0, &p) == VANGUARD_ERR_USAGE);
  CHECK(!a.n.n_zone && vanguard_zone(job, 0, &zone) == VANGUARD_ERR_USAGE);
  drop(&a);
  vanguard_free(job);
}

static int stop_at(void *user, const char *phase, uint64_t done,
                   uint64_t expected)
{
  (void)done;
  (void)expected;
  return !strcmp(phase, user);
}

static void stops(void)
{
  const char *const phase[] = { "surface check", "sizing field",
                                "load estimate", "mesh check" };
  vanguard_job *job = new_cube();
  struct arrays before, after;

  CHECK(!vanguard_set(job, "hmax", "0.05"));
  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &before);
  for (int i = 0; i < 4; i++) {
    CHECK(vanguard_mesh(job, stop_at, (void *)phase[i]) ==
          VANGUARD_ERR_STOPPED);
    CHECK(vanguard_count(job, &after.n) == VANGUARD_ERR_USAGE);
  }
  vanguard_cancel(job); /* no run is active */
  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &after);
  CHECK(same(&before, &after));
  drop(&before);
  drop(&after);
  vanguard_free(job);
}

/* Every call with the job of a run that is in progress is refused. */
static int use_job_in_use(void *user, const char *phase, uint64_t done,
                          uint64_t expected)
{
  vanguard_job *job = user;
  struct vanguard_counts n = VANGUARD_INIT(n);

  (void)phase, (void)done, (void)expected;
  CHECK(vanguard_close(job) == VANGUARD_ERR_BUSY && says(job, "in use"));
  vanguard_free(job);
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_BUSY);
  CHECK(vanguard_set(job, "growth", "1.3") == VANGUARD_ERR_BUSY);
  CHECK(vanguard_count(job, &n) == VANGUARD_ERR_BUSY);
  CHECK(!vanguard_triangles(job) && !vanguard_note(job, 0));
  CHECK(!vanguard_pieces(job) && !*vanguard_details(job));
  return 0;
}

static void refuses_a_second_call(void)
{
  vanguard_job *job = new_cube();
  struct vanguard_counts n = VANGUARD_INIT(n);

  CHECK(!vanguard_mesh(job, use_job_in_use, job));
  CHECK(!vanguard_count(job, &n) && n.n_tet > 0);
  CHECK(vanguard_set(job, "growth", "0") == VANGUARD_ERR_INPUT &&
        says(job, "above 1"));
  CHECK(!vanguard_close(job));
}

static double focus(void *user, const double x[3])
{
  double d2 = 0;

  (void)user;
  for (int k = 0; k < 3; k++) d2 += (x[k] - 0.5) * (x[k] - 0.5);
  return 0.006 + 0.3 * sqrt(d2);
}

static double nowhere(void *user, const double x[3])
{
  (void)user;
  return x[0] > 0.5 ? -1 : 1;
}

static void takes_sizes(void)
{
  const double at[2][3] = { { 0.5, 0.5, 0.5 }, { 0.2, 0.2, 0.2 } };
  const double size[2] = { 0.006, 0.2 }, bad[2] = { 0.1, -2 };
  vanguard_job *job = new_cube();
  struct arrays plain, by_function, by_points;

  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &plain);
  CHECK(!vanguard_sizes(job, focus, NULL) && !vanguard_mesh(job, NULL, NULL));
  take(job, &by_function);
  CHECK(by_function.n.n_tet > 2 * plain.n.n_tet);
  CHECK(vanguard_size_points(job, 2, at[0], bad) == VANGUARD_ERR_INPUT &&
        says(job, "point 2"));
  CHECK(!vanguard_size_points(job, 2, at[0], size));
  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &by_points);
  CHECK(by_points.n.n_tet > 2 * plain.n.n_tet);
  CHECK(!vanguard_sizes(job, nowhere, NULL));
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_INPUT &&
        says(job, "is -1; it must be above 0"));
  CHECK(!vanguard_sizes(job, NULL, NULL) && !vanguard_mesh(job, NULL, NULL));
  drop(&by_points);
  take(job, &by_points);
  CHECK(same(&plain, &by_points));
  drop(&plain);
  drop(&by_function);
  drop(&by_points);
  vanguard_free(job);
}

/* Edges of 0.025 along z, and of 0.1 across. */
static const double flat[6] = { 100, 0, 0, 100, 0, 1600 };

static void flat_metric(void *user, const double x[3], double m[6])
{
  (void)x;
  memcpy(m, flat, sizeof flat);
  if (user) m[5] = *(const double *)user;
}

/* Mean of |z| over that of |x|, of the edges in the middle of the cube. */
static double flatness(const struct arrays *a)
{
  double sum[3] = { 0 };

  for (uint64_t c = 0; c < a->n.n_tet; c++)
    for (int e = 0; e < 6; e++) {
      static const int end[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                     { 1, 2 }, { 1, 3 }, { 2, 3 } };
      const double *p = a->x + 3 * a->cell[0][4 * c + (size_t)end[e][0]];
      const double *q = a->x + 3 * a->cell[0][4 * c + (size_t)end[e][1]];
      int k = 0;

      while (k < 3 && fabs(p[k] - 0.5) < 0.25 && fabs(q[k] - 0.5) < 0.25) k++;
      for (int d = 0; k == 3 && d < 3; d++) sum[d] += fabs(p[d] - q[d]);
    }
  return sum[2] / sum[0];
}

static void takes_metrics(void)
{
  static const uint32_t tet[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 },
                                      { 0, 2, 6, 7 }, { 0, 6, 4, 7 },
                                      { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
  const uint32_t beyond[4] = { 0, 1, 2, 8 };
  double at[8][3], metric[8][6], negative = -1;
  vanguard_job *job = new_cube();
  struct arrays plain, made;

  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < 3; k++) at[i][k] = i >> k & 1;
    memcpy(metric[i], flat, sizeof flat);
  }
  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &plain);
  CHECK(!vanguard_metrics(job, flat_metric, NULL));
  for (int k = 0; k < 2; k++) {
    CHECK(!vanguard_mesh(job, NULL, NULL));
    take(job, &made);
    CHECK(made.n.n_tet > 1.5 * (double)plain.n.n_tet && flatness(&made) < 0.5);
    CHECK(flatness(&plain) > 0.8);
    drop(&made);
    CHECK(!vanguard_metric_points(job, 8, at[0], metric[0], 6, tet[0]));
  }
  CHECK(vanguard_metric_points(job, 8, at[0], metric[0], 1, beyond) ==
          VANGUARD_ERR_INPUT &&
        says(job, "tetrahedron 1 has point 8"));
  metric[5][5] = 100 * 101 * 101;
  CHECK(!vanguard_metric_points(job, 8, at[0], metric[0], 6, tet[0]));
  CHECK(!vanguard_set(job, "aspect_max", "20"));
  CHECK(!vanguard_mesh(job, NULL, NULL) &&
        notes_say(job, "1 of these metrics have an aspect above 20"));
  metric[3][1] = 101;
  CHECK(vanguard_metric_points(job, 8, at[0], metric[0], 0, NULL) ==
          VANGUARD_ERR_INPUT &&
        says(job, "point 4") && says(job, "not positive"));
  CHECK(!vanguard_metrics(job, flat_metric, &negative));
  CHECK(vanguard_mesh(job, NULL, NULL) == VANGUARD_ERR_INPUT &&
        says(job, "not positive"));
  CHECK(!vanguard_metric_points(job, 0, NULL, NULL, 0, NULL));
  CHECK(!vanguard_mesh(job, NULL, NULL));
  take(job, &made);
  CHECK(same(&plain, &made));
  drop(&plain);
  drop(&made);
  vanguard_free(job);
}

static void writes(const char *dir)
{
  vanguard_job *job = new_cube();
  char stem[4096], path[4200];
  FILE *f;

  snprintf(stem, sizeof stem, "%s/cube", dir);
  CHECK(vanguard_write(job, stem, "b8.ugrid") == VANGUARD_ERR_USAGE);
  CHECK(!vanguard_mesh(job, NULL, NULL));
  CHECK(vanguard_write(job, stem, "b8.ugird") == VANGUARD_ERR_INPUT);
  CHECK(vanguard_write(job, "/nowhere/cube", "vtu") == VANGUARD_ERR_IO);
  CHECK(!vanguard_write(job, stem, "lb8.ugrid,vtu,su2"));
  CHECK(!vanguard_write(job, stem, NULL));
  for (int i = 0; i < 4; i++) {
    const char *suffix[] = { "lb8.ugrid", "vtu", "su2", "cogsg" };

    snprintf(path, sizeof path, "%s.%s", stem, suffix[i]);
    f = fopen(path, "rb");
    CHECK(f);
    if (f) fclose(f);
  }
  /* The written mesh can be read and meshed again, and is not overwritten. */
  snprintf(path, sizeof path, "%s.lb8.ugrid", stem);
  CHECK(!vanguard_open(job, path, NULL) && !vanguard_mesh(job, NULL, NULL));
  CHECK(vanguard_write(job, stem, "lb8.ugrid") == VANGUARD_ERR_INPUT &&
        says(job, "overwrite"));
  CHECK(vanguard_open(job, "/nowhere/cube.stl", NULL) == VANGUARD_ERR_INPUT);
  vanguard_free(job);
}

/* The surface with its farfield, without a mesh. */
static void checks_surfaces(void)
{
  vanguard_job *job = new_cube();
  struct vanguard_boundary b = VANGUARD_INIT(b);
  struct vanguard_patch p = VANGUARD_INIT(p);
  struct vanguard_counts n = VANGUARD_INIT(n);
  const char *text;
  uint32_t *tri, *patch, turned[2 * SIDE][3];
  double *x;

  CHECK(vanguard_boundary(job, &b) == VANGUARD_ERR_USAGE);
  CHECK(vanguard_report(job, "json", &text) == VANGUARD_ERR_USAGE);
  CHECK(!vanguard_check(job, NULL, NULL) && !vanguard_boundary(job, &b));
  CHECK(!strcmp(b.flow, "internal") && b.n_tri == 2 * SIDE && b.n_patch == 6);
  CHECK(!b.has_farfield && !b.n_defect && b.half_axis == -1);
  CHECK(vanguard_count(job, &n) == VANGUARD_ERR_USAGE);
  CHECK(!vanguard_boundary_patch(job, 5, &p) && p.id == 15);
  CHECK(vanguard_boundary_patch(job, 6, &p) == VANGUARD_ERR_USAGE);
  CHECK(!vanguard_report(job, "json", &text) && strstr(text, "\"ok\": true"));
  CHECK(!vanguard_report(job, "text", &text) && strstr(text, "Surface"));
  CHECK(vanguard_report(job, "html", &text) == VANGUARD_ERR_INPUT);
  /* Turned inside out, the cube is a body in a farfield. */
  for (int i = 0; i < 2 * SIDE; i++)
    for (int k = 0; k < 3; k++) turned[i][k] = cube.tri[i][2 - k];
  CHECK(!vanguard_surface(job, "body", cube.n_point, cube.x[0], 2 * SIDE,
                          turned[0], NULL));
  CHECK(!vanguard_set(job, "remesh_surface", "yes"));
  CHECK(!vanguard_make_surface(job, NULL, NULL) && !vanguard_boundary(job, &b));
  CHECK(b.is_remeshed && !b.has_farfield);
  CHECK(!vanguard_check(job, NULL, NULL) && !vanguard_boundary(job, &b));
  CHECK(!strcmp(b.flow, "external") && b.has_farfield && b.n_patch == 2);
  x = calloc(b.n_point, 3 * sizeof *x);
  tri = calloc(b.n_tri, 3 * sizeof *tri);
  patch = calloc(b.n_tri, sizeof *patch);
  CHECK(!vanguard_boundary_arrays(job, x, tri, patch));
  for (size_t i = 0; i < b.n_tri; i++)
    CHECK(tri[3 * i] < b.n_point && patch[i] < 2);
  free(x);
  free(tri);
  free(patch);
  /* A refused surface: its defects are reported. */
  CHECK(!vanguard_surface(job, "open", cube.n_point, cube.x[0], 2 * SIDE - 1,
                          cube.tri[0], NULL));
  CHECK(vanguard_check(job, NULL, NULL) == VANGUARD_ERR_GEOMETRY);
  CHECK(!vanguard_boundary(job, &b) && b.n_open_edge == 3);
  CHECK(!vanguard_report(job, "json", &text) && strstr(text, "\"error\""));
  vanguard_free(job);
}

/* The expected mesh and its run, without a mesh; a mesh made before is
 * discarded. */
static void forecasts(void)
{
  vanguard_job *job = new_cube();
  struct vanguard_forecast f = VANGUARD_INIT(f), part = { 0 };
  struct vanguard_boundary b = VANGUARD_INIT(b);
  struct vanguard_counts n = VANGUARD_INIT(n);

  CHECK(!vanguard_set(job, "hmax", "0.1") && !vanguard_mesh(job, NULL, NULL));
  CHECK(!vanguard_count(job, &n));
  CHECK(vanguard_forecast(job, 1, 1, NULL, NULL, NULL) == VANGUARD_ERR_USAGE);
  CHECK(vanguard_forecast(job, 1, 1, NULL, NULL, &part) == VANGUARD_ERR_USAGE);
  CHECK(vanguard_forecast(job, 0, 1, NULL, NULL, &f) == VANGUARD_ERR_INPUT);
  CHECK(vanguard_forecast(job, 1, -1, NULL, NULL, &f) == VANGUARD_ERR_INPUT);
  CHECK(vanguard_forecast(job, 1 << 20, 2, NULL, NULL, &f) ==
        VANGUARD_ERR_INPUT);
  CHECK(!vanguard_count(job, &n));
  CHECK(!vanguard_forecast(job, 4, 2, NULL, NULL, &f));
  CHECK(vanguard_count(job, &n) == VANGUARD_ERR_USAGE);
  CHECK(f.ranks == 4 && f.threads == 2 && f.n_tet == f.n_cell && !f.n_pri);
  CHECK(f.n_tet > 0.75 * (double)n.n_tet && f.n_tet < 1.33 * (double)n.n_tet);
  CHECK(f.seconds > 0 && f.work >= f.seconds && f.n_subdomain > 0);
  CHECK(f.memory > f.memory_shared && f.memory >= f.memory_fill);
  CHECK(strstr("surface sizes fill check", f.peak_stage));
  CHECK(!vanguard_boundary(job, &b) && b.n_tri == 2 * SIDE);
  /* An older program knows fewer members. */
  part.struct_size = offsetof(struct vanguard_forecast, n_tet);
  CHECK(!vanguard_forecast(job, 1, 0, NULL, NULL, &part));
  CHECK(part.n_cell == f.n_cell && part.threads > 0 && !part.n_tet);
  vanguard_free(job);
}

/* A mesh that was written is read back: the same arrays. */
static void reads(const char *dir)
{
  vanguard_job *job = new_cube(), *other;
  struct vanguard_quality q = VANGUARD_INIT(q);
  struct vanguard_piece s = VANGUARD_INIT(s);
  struct arrays made, read;
  char stem[4096], path[4200];
  const char *text;

  snprintf(stem, sizeof stem, "%s/again", dir);
  snprintf(path, sizeof path, "%s/again.lb8.ugrid", dir);
  CHECK(!vanguard_mesh(job, NULL, NULL));
  CHECK(!vanguard_report(job, "json", &text) && strstr(text, "\"mesh\": {"));
  CHECK(!vanguard_write(job, stem, "lb8.ugrid"));
  take(job, &made);
  CHECK(!vanguard_new(VANGUARD_ABI, &other));
  CHECK(!vanguard_read(other, path));
  take(other, &read);
  CHECK(same(&made, &read));
  CHECK(read.n.n_boundary_point == made.n.n_boundary_point);
  CHECK(!vanguard_measure(other, &q) && q.is_valid == 1 &&
        fabs(q.volume - 1) < 1e-12);
  CHECK(vanguard_pieces(other) == 1 && !vanguard_piece_get(other, 0, &s) &&
        s.n_tet == made.n.n_tet && s.n_own == made.n.n_point);
  CHECK(!vanguard_report(other, "text", &text) && strstr(text, "valid"));
  CHECK(!vanguard_walls(other));
  CHECK(vanguard_write(other, stem, "vtu") == VANGUARD_ERR_USAGE);
  CHECK(vanguard_read(other, "/nowhere/mesh.lb8.ugrid") < 0);
  CHECK(vanguard_count(other, &read.n) == VANGUARD_ERR_USAGE);
  vanguard_piece_put(other, &s);
  drop(&made);
  drop(&read);
  vanguard_free(job);
  vanguard_free(other);
}

static void *mesh_in_thread(void *out)
{
  vanguard_job *job = new_cube();

  CHECK(!vanguard_set(job, "hmax", "0.05") && !vanguard_mesh(job, NULL, NULL));
  take(job, out);
  vanguard_free(job);
  return NULL;
}

static void meshes_in_threads(void)
{
  struct arrays a[3];
  pthread_t thread[3];

  for (int i = 0; i < 3; i++)
    pthread_create(&thread[i], NULL, mesh_in_thread, &a[i]);
  for (int i = 0; i < 3; i++) pthread_join(thread[i], NULL);
  CHECK(same(&a[0], &a[1]) && same(&a[0], &a[2]));
  for (int i = 0; i < 3; i++) drop(&a[i]);
}

int main(int argc, char **argv)
{
  make_cube(&cube);
  refuses_another_abi();
  sets_by_name();
  refuses_bad_surfaces();
  survives_early_failures();
  gives_arrays_and_pieces();
  names_causes();
  grows_layers();
  stops();
  refuses_a_second_call();
  takes_sizes();
  takes_metrics();
  checks_surfaces();
  forecasts();
  if (argc > 1) writes(argv[1]);
  if (argc > 1) reads(argv[1]);
  CHECK(!vanguard_prepare());
  meshes_in_threads();
  if (!n_bad) printf("libvanguard %s works\n", vanguard_version());
  return n_bad != 0;
}
