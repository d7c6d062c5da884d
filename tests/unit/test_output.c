/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/output*.c: each call for memory and files, of writers and between
 * ranks fails once. All files of a run appear, or none; a failure has a
 * message. The linker replaces the calls. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/helper/helper.h"
#include "io/cgns/cgns.h"
#include "io/mesh/foam.h"
#include "io/slices/slices.h"
#include "io/vgrid/mapbc.h"
#include "output_calls.h"
#include "run/common/text.h"
#include "run/stages/output.h"

#define ROOT VG_TMP_DIR "/outputs"
#define DIR_OUT ROOT "/out"
#define CASE DIR_OUT "/case.openfoam"
#define STEM ROOT "/case"

/* --- files ---------------------------------------------------------------- */

static int remove_one(const char *path, const struct stat *s, int flag,
                      struct FTW *at)
{
  (void)s;
  (void)flag;
  return at->level ? remove(path) : 0;
}

static void clean(void)
{
  mkdir(ROOT, 0777);
  nftw(ROOT, remove_one, 20, FTW_DEPTH | FTW_PHYS);
}

static void put(const char *path, const char *text)
{
  FILE *f = fopen(path, "w");

  assert_non_null(f);
  fputs(text, f);
  fclose(f);
}

static int exists(const char *path)
{
  struct stat s;

  return !lstat(path, &s);
}

static size_t n_files;

static int count_one(const char *path, const struct stat *s, int flag)
{
  (void)s;
  n_files += flag != FTW_D && !strstr(path, "/.vanguard-");
  return 0;
}

/* Files in all folders that are not hidden. */
static size_t count_files(void)
{
  n_files = 0;
  ftw(ROOT, count_one, 20);
  return n_files;
}

/* --- a mesh of two tetrahedra with a sheet between them ------------------- */

static double point[5][3] = {
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 1 }
};
static uint32_t tet[2][4] = { { 0, 1, 2, 3 }, { 1, 2, 3, 4 } };
static uint32_t tri[6][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 },
                              { 2, 1, 4 }, { 3, 2, 4 }, { 1, 3, 4 } };
static uint32_t tri_patch[6] = { 0, 1, 2, 3, 3, 3 };
static struct vg_patch patch[5] = {
  { 1, 5, 3000, 5, 0, 0, 0, 0, "floor" },
  { 2, 5, 3000, 5, 0, 0, 0, 0, "side" },
  { 3, 5, 3000, 5, 0, 0, 0, 0, "" },
  { 4, 3, 5000, 3, 0, 0, 0, 0, "far" },
  { 9, 0, 0, 0, 0, 1, 0, 0, "plate" } /* a sheet */
};
static uint32_t sheet_tri[1][3] = { { 1, 2, 3 } }, sheet_of[1] = { 0 };
static struct vg_zone zone[2] = { { 1, VG_ZONE_FLUID, { 1, 0, 0, 0 }, "one" },
                                  { 2, VG_ZONE_SOLID, { 1, 0, 0, 0 }, "two" } };

static vg_status get(const struct vg_slices *s, size_t i, struct vg_slice *out,
                     struct vg_error *err)
{
  static const uint32_t id[5] = { 0, 1, 2, 3, 4 }, part[2] = { 0, 1 };

  (void)i;
  (void)err;
  *out = (struct vg_slice){ .n_point = 5,
                            .x = (const double(*)[3])point,
                            .id = id,
                            .n_own = 5,
                            .own = id,
                            .n_cell = { 2 },
                            .cell = { &tet[0][0] },
                            .part = { s->n_part ? part : NULL } };
  return VG_OK;
}

static void put_back(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  (void)slice;
}

/* --- runs ----------------------------------------------------------------- */

enum old_case { NO_CASE, OWN_CASE, LINKED_CASE };
enum old { NO_SHEETS, OWN_SHEETS, OTHER_SHEETS };

struct scene {
  const char *list, *files; /* formats; suffixes of files, some of them */
  int is_guest, is_claimed, has_tail, has_layers, has_sheets, has_zones, n_part,
    has_pairs, has_plane, has_input;
  enum old old;
  enum old_case old_case;
};

static struct vg_periodic pair = { .patch = 1,
                                   .image = 2,
                                   .is_rotation = 1,
                                   .n = 4,
                                   .axis = { 1, 0, 0 },
                                   .sine = 1,
                                   .n_face = 1 };
static double plane_x[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
static uint32_t plane_tri[1][3] = { { 0, 1, 2 } };
static uint32_t plane_edge[3][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 } };
static uint32_t edge_patch[3] = { 0, 1, 2 };
static struct vg_plane_mesh plane = { .n_point = 3,
                                      .n_tri = 1,
                                      .n_edge = 3,
                                      .n_patch = 3,
                                      .x = plane_x,
                                      .tri = plane_tri,
                                      .edge = plane_edge,
                                      .edge_patch = edge_patch,
                                      .patch = patch };

static void begin_problem(struct vg_problem *p)
{
  *p = (struct vg_problem)VG_PROBLEM_INIT;
  vg_settings_default(&p->asked);
  vg_settings_default(&p->resolved.settings);
  p->asked.cells = VG_LAYER_TETS;
  p->read.files = (struct vg_input_files){ .stem = (char *)STEM,
                                           .d3m = (char *)"",
                                           .front = (char *)"",
                                           .surface = (char *)"",
                                           .mapbc = (char *)"",
                                           .deck = (char *)"",
                                           .tags = (char *)"",
                                           .aflr = (char *)"" };
}

static void begin_mesh(const struct scene *s, struct vg_mesh *m,
                       struct vg_slices *slices)
{
  *m = (struct vg_mesh){
    .n_tri = 6, .n_patch = 4, .tri = tri, .tri_patch = tri_patch, .patch = patch
  };
  if (s->has_sheets) {
    m->n_sheet_tri = m->n_sheet = 1;
    m->sheet_tri = sheet_tri;
    m->sheet_of = sheet_of;
    m->sheet = patch + 4;
  }
  if (s->has_zones) {
    m->n_zone = 2;
    m->zone = zone;
  }
  *slices = (struct vg_slices){ .n_point = 5,
                                .n_cell = { 2 },
                                .n_boundary_point = 5,
                                .n_layer_cell = { 1 },
                                .n_part = (uint32_t)s->n_part,
                                .boundary = m,
                                .n_slice = 1,
                                .n_served = 2,
                                .get = get,
                                .put = put_back };
}

/* As vg_run_mesh does. */
static vg_status write_all(const struct scene *s, struct vg_problem *p,
                           struct vg_outputs *o, struct vg_error *err)
{
  struct vg_layer_stage layers = { .is_on = s->has_layers };
  struct vg_slices slices;
  struct vg_mesh m;
  vg_status st;

  begin_mesh(s, &m, &slices);
  st = vg_outputs_plan(p, STEM, DIR_OUT, s->list, o, err);
  if (st >= 0 && s->is_claimed) st = vg_outputs_claim(o, &p->notes, err);
  if (st >= 0) st = vg_outputs_check(p, o, err);
  if (st < 0) return st;
  if (s->has_plane) o->plane = &plane;
  st = vg_outputs_open(o, p, NULL, &slices, err);
  if (st < 0) return st;
  st = vg_slices_each(&slices, 1, vg_outputs_put, o, err);
  st = vg_outputs_close(o, st, err);
  if (st >= 0) st = vg_outputs_mesh(o, p, &layers, NULL, &slices, 1, err);
  if (st < 0 || s->is_guest) return st;
  st = vg_outputs_digest(o, err);
  if (st >= 0) st = vg_outputs_sync(o, err);
  return st < 0 ? st : vg_outputs_commit(o, err);
}

static vg_status run(const struct scene *s, struct vg_error *err)
{
  struct vg_outputs o = VG_OUTPUTS_INIT;
  struct vg_problem p;
  vg_status st;

  begin_problem(&p);
  p.asked.ugrid_tail = s->has_tail;
  p.read.settings.n_periodic = s->has_pairs;
  p.boundary.pairs = (struct vg_pairs){ (size_t)s->has_pairs, &pair };
  p.boundary.surface = (struct vg_mesh){ .n_patch = 5, .patch = patch };
  if (s->has_input) p.read.files.mapbc = (char *)DIR_OUT "/case.mapbc";
  if (s->has_input) p.read.files.surface = (char *)ROOT "/the case.tri";
  calls.is_on = 1;
  st = vg_outputs_failed(&o, write_all(s, &p, &o, err), err);
  vg_outputs_release(&o);
  calls.is_on = 0;
  vg_notes_release(&p.notes);
  vg_settings_release(&p.asked);
  vg_settings_release(&p.resolved.settings);
  return st;
}

/* An earlier case with subdomains, and a file that belongs to no mesh. The mesh
 * is in another folder if the case is linked. */
static void put_case(enum old_case which)
{
  mkdir(CASE, 0777);
  mkdir(CASE "/constant", 0777);
  if (which == LINKED_CASE) {
    mkdir(ROOT "/mesh", 0777);
    assert_int_equal(symlink(ROOT "/mesh", CASE "/constant/polyMesh"), 0);
  } else {
    mkdir(CASE "/constant/polyMesh", 0777);
  }
  put(CASE "/constant/polyMesh/points", "old");
  put(CASE "/constant/polyMesh/mine", "mine");
  put(CASE "/constant/" VG_FOAM_PARTS, "old");
}

static void prepare(const struct scene *s)
{
  clean();
  if (!s->has_layers) mkdir(DIR_OUT, 0777);
  if (s->has_input)
    put(DIR_OUT "/case.mapbc", "conditions\n.\n.\n.\n"
                               "1 5 5 0 0\n2 5 5 0 0\n3 5 5 0 0\n4 3 3 0 0\n");
  if (s->old_case) put_case(s->old_case);
  if (s->old == OWN_SHEETS)
    put(DIR_OUT "/case.sheets", "# Vanguard sheets 1\nmesh 5 2\n");
  if (s->old == OTHER_SHEETS) put(DIR_OUT "/case.sheets", "mine\n");
  if (!s->has_layers) { /* remains of a run that was killed */
    mkdir(DIR_OUT "/.vanguard-case", 0777);
    mkdir(DIR_OUT "/.vanguard-case/new", 0777);
    put(DIR_OUT "/.vanguard-case/new/case.vtu", "half");
  }
  vg_print_forget();
}

static void check_files(const struct scene *s)
{
  char *list = strdup(s->files), *state = list, *suffix;

  while ((suffix = strsep(&state, ","))) {
    char path[600];

    snprintf(path, sizeof path, DIR_OUT "/case%s", suffix);
    if (*suffix && !exists(path)) fail_msg("no %s", path);
  }
  free(list);
  assert_false(exists(DIR_OUT "/.vanguard-case"));
}

static const struct scene scene[] = {
  { .list = "b8.ugrid,lb8.ugrid,cogsg,vtu,pvtu,su2,foam,msh,meshb,mapbc,ugrid",
    .files = ".b8.ugrid,.lb8.ugrid,.cogsg,.bc,.mapbc,.vtu,.surface.vtu,.pvtu,"
             "_0.vtu,.su2,.openfoam,.msh,.meshb,.ugrid,.part.2,.wall.vtu,"
             ".resolved.deck",
    .is_claimed = 1,
    .has_tail = 1,
    .has_layers = 1,
    .n_part = 2 },
  { .list = "foam-ascii,fluent.msh,mesh,ugrid,fun3d.mapbc,vtu,stl,pvtu",
    .files = ".openfoam,.fluent.msh,.mesh,.ugrid,.fun3d.mapbc,.sheets,.stl",
    .has_sheets = 1,
    .has_zones = 1 },
  { .list = "fluent.msh,mesh,stl", .files = ".mesh,.mapbc", .has_tail = 1 },
  { .list = "cgns,mesh", .files = ".cgns", .has_zones = 1, .has_input = 1 },
  { .list = "cgns,foam", .files = ".cgns", .n_part = 2, .old_case = OWN_CASE },
  { .list = "foam", .files = ".openfoam", .old_case = LINKED_CASE },
  { .list = "su2,msh,vtu", .files = ".su2,.msh,.vtu", .has_plane = 1 },
  { .list = "su2,foam,mesh,b8.ugrid,mapbc,cogsg",
    .files = ".su2,.periodic.cfg,.openfoam,.mesh,.mapbc",
    .has_pairs = 1,
    .has_input = 1,
    .old = OTHER_SHEETS },
  { .list = "su2", .files = ".su2", .old = OWN_SHEETS, .is_claimed = 1 },
  { .list = "pvtu", .files = ".pvtu", .has_pairs = 1, .is_claimed = 1 },
  { .list = "b8.ugrid,foam,mapbc,fun3d.mapbc,vtu,pvtu,su2,meshb",
    .files = "",
    .is_guest = 1,
    .has_layers = 1,
    .has_pairs = 1,
    .n_part = 2 },
  { .list = "su2,mesh", .files = "", .is_guest = 1, .has_plane = 1 },
  { .list = "vtu", .files = ".sheets", .has_zones = 1, .is_claimed = 1 },
};
enum { N_SCENE = sizeof scene / sizeof *scene };

/* With one fault, or with all calls failing from one on. */
static void run_with_faults(const struct scene *s, int is_sticky)
{
  long n = 0;
  size_t n_before, n_all = 0;

  if (strstr(s->list, "cgns") && !vg_cgns_is_built()) return;
  calls.is_guest = s->is_guest;
  calls.is_sticky = is_sticky;
  for (calls.at = 0; calls.at <= n; calls.at++) {
    struct vg_error err = VG_ERROR_INIT;
    vg_status st;

    prepare(s);
    n_before = count_files();
    calls.n = 0;
    st = run(s, &err);
    if (calls.n > n) n = calls.n;
    if (!calls.at && st < 0) fail_msg("%s: %s", s->list, err.text);
    if (!calls.at) n_all = count_files();
    if (st < 0) assert_true(*err.text);
    if (s->is_guest) continue;
    if (st >= 0) check_files(s);
    if (st >= 0 && count_files() != n_all)
      fail_msg("%s: call %ld: %zu files of %zu", s->list, calls.at,
               count_files(), n_all);
    if (st < 0 && count_files() != n_before)
      fail_msg("%s: call %ld: %zu files after '%s', %zu before", s->list,
               calls.at, count_files(), err.text, n_before);
  }
  calls.at = 0;
  assert_true(n > 10);
}

static void every_call_fails(void **state)
{
  (void)state;
  for (int i = 0; i < N_SCENE; i++) run_with_faults(&scene[i], 0);
}

static void all_calls_fail_from_one_on(void **state)
{
  (void)state;
  for (int i = 1; i < N_SCENE; i++) run_with_faults(&scene[i], 1);
}

/* --- paths and messages --------------------------------------------------- */

static struct vg_outputs placed(const char *dir)
{
  return (struct vg_outputs){ .dir = (char *)dir,
                              .name = (char *)"case",
                              .temp_dir = (char *)"out/.hidden/new" };
}

static void is_path(char *path, const char *wanted)
{
  assert_string_equal(path, wanted);
  free(path);
}

static void paths(void **state)
{
  struct vg_outputs here = placed("."), there = placed("out");

  (void)state;
  is_path(vg_outputs_final(&here, "vtu"), "case.vtu");
  is_path(vg_outputs_final(&here, "_0.vtu"), "case_0.vtu");
  is_path(vg_outputs_final(&there, "vtu"), "out/case.vtu");
  is_path(vg_outputs_final(&there, "_0.vtu"), "out/case_0.vtu");
  is_path(vg_outputs_temp_path(&there, "su2"), "out/.hidden/new/case.su2");
  calls_reset();
  calls.is_on = calls.at = 1;
  assert_null(vg_outputs_final(&here, "vtu"));
  assert_true(vg_print_is_lost());
  vg_print_forget();
  calls.is_on = 0;
}

static void is_message(const struct vg_outputs *o, vg_status st,
                       const char *text, const char *wanted)
{
  struct vg_error err = VG_ERROR_INIT;

  snprintf(err.text, sizeof err.text, "%s", text);
  assert_int_equal(vg_outputs_failed(o, st, &err), st);
  assert_string_equal(err.text, wanted);
}

static void messages_name_the_target(void **state)
{
  struct vg_outputs here = placed("."), there = placed("out"),
                    none = VG_OUTPUTS_INIT;

  (void)state;
  is_message(&here, VG_ERR_IO, "out/.hidden/new/a: full", "a: full");
  is_message(&there, VG_ERR_IO, "out/.hidden/new/a: full", "out/a: full");
  is_message(&there, VG_ERR_IO, "out/.hidden/newer: full",
             "out/.hidden/newer: full");
  is_message(&there, VG_ERR_IO, "another", "another");
  is_message(&none, VG_ERR_IO, "another", "another");
  is_message(&there, VG_OK, "out/.hidden/new/a", "out/.hidden/new/a");
  assert_int_equal(vg_outputs_failed(&there, VG_ERR_IO, NULL), VG_ERR_IO);
  calls_reset();
  calls.is_on = calls.at = 1;
  is_message(&there, VG_ERR_IO, "out/.hidden/new/a", "out/.hidden/new/a");
  calls.is_on = 0;
}

static void same_files(void **state)
{
  (void)state;
  clean();
  put(ROOT "/a", "");
  put(ROOT "/b", "");
  assert_int_equal(link(ROOT "/a", ROOT "/c"), 0);
  assert_true(vg_is_same_file(ROOT "/a", ROOT "/c"));
  assert_false(vg_is_same_file(ROOT "/a", ROOT "/b"));
  assert_false(vg_is_same_file(ROOT "/a", "/proc/self/status"));
  assert_false(vg_is_same_file(ROOT "/a", ROOT "/none"));
  assert_false(vg_is_same_file(ROOT "/none", ROOT "/a"));
  assert_false(vg_is_same_file(NULL, ROOT "/a"));
  assert_false(vg_is_same_file("", ROOT "/a"));
  assert_false(vg_is_same_file(ROOT "/a", NULL));
  assert_false(vg_is_same_file(ROOT "/a", ""));
}

/* --- refusals ------------------------------------------------------------- */

/* The message has this phrase; NULL: not refused. */
static void plans(const struct vg_problem *p, const char *stem, const char *dir,
                  const char *list, const char *phrase)
{
  struct vg_outputs o = VG_OUTPUTS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_outputs_plan(p, stem, dir, list, &o, &err);

  vg_outputs_release(&o);
  if (!phrase && st < 0) fail_msg("%s: refused: %s", list, err.text);
  if (phrase && (st >= 0 || !strstr(err.text, phrase)))
    fail_msg("%s: '%s' has no '%s'", list, err.text, phrase);
}

static void cells_that_a_format_lacks(void **state)
{
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  plans(&p, STEM, NULL, "cogsg", NULL);
  p.asked.cells = VG_LAYER_MIXED;
  plans(&p, STEM, NULL, "cogsg", "cells is mixed");
  p.asked.cells = VG_LAYER_HEX;
  plans(&p, STEM, NULL, "cogsg", "cells is hex");
  plans(&p, STEM, NULL, "vtu", NULL);
  if (vg_cgns_is_built()) plans(&p, STEM, NULL, "cgns", NULL);
  p.read.is_section = 1;
  plans(&p, STEM, NULL, "cogsg", "section");
  calls.has_no_cgns = 1;
  plans(&p, STEM, NULL, "cgns", "libhdf5-dev");
  calls.has_no_cgns = 0;
  plans(&p, STEM, NULL, "vtu,none", "unknown format");
}

static void inputs_are_not_overwritten(void **state)
{
  struct vg_input_files *f;
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  f = &p.read.files;
  put(ROOT "/case.b8.ugrid", "");
  put(ROOT "/case.bc", "");
  f->surface = (char *)ROOT "/case.b8.ugrid";
  plans(&p, STEM, NULL, "b8.ugrid", "would overwrite the input");
  plans(&p, STEM, NULL, "vtu", NULL);
  f->aflr = (char *)ROOT "/case.bc";
  plans(&p, STEM, NULL, "cogsg", "writing bc would overwrite");
  mkdir(ROOT "/case.vtu", 0777);
  plans(&p, STEM, NULL, "vtu", "a folder exists");
  mkdir(ROOT "/case.openfoam", 0777);
  plans(&p, STEM, NULL, "foam", NULL);
}

static void surfaces_stay_unique(void **state)
{
  struct vg_input_files *f;
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  f = &p.read.files;
  plans(&p, STEM, NULL, "stl", NULL); /* no input, but calls of the library */
  f->d3m = (char *)ROOT "/case.d3m";
  plans(&p, STEM, NULL, "stl", "ambiguous");
  f->surface = (char *)ROOT "/case.tri";
  plans(&p, STEM, NULL, "stl", "ambiguous");
  plans(&p, STEM, NULL, "vtu", NULL);
  plans(&p, ROOT "/other", NULL, "stl", NULL);
  plans(&p, STEM, DIR_OUT, "stl", NULL);
  f->front = (char *)ROOT "/case.front";
  plans(&p, STEM, NULL, "stl", NULL);
  f->front = (char *)"";
  f->stem = (char *)"case";
  plans(&p, "case", NULL, "stl", "ambiguous");
  f->stem = (char *)"/case";
  plans(&p, "/case", NULL, "stl", "ambiguous");
  plans(&p, STEM "/", NULL, "vtu", "has no name");
}

static void conditions_are_added(void **state)
{
  struct vg_outputs o = VG_OUTPUTS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  for (int k = 0; k < 2; k++) {
    assert_int_equal(vg_outputs_plan(&p, STEM, NULL, "b8.ugrid", &o, &err),
                     VG_OK);
    assert_int_equal(o.n_item, 2 - k);
    vg_outputs_release(&o);
    put(ROOT "/case.mapbc", "title\n.\n.\n.\n1 4 4 0 0\n"); /* not ours */
  }
  for (int i = 0; i < VG_WRITE_ITEMS; i++) strcpy(o.item[i], "b8.ugrid");
  o.n_item = VG_WRITE_ITEMS;
  assert_int_equal(vg_outputs_plan(&p, STEM, NULL, "", &o, &err), VG_OK);
  assert_int_equal(o.n_item, VG_WRITE_ITEMS);
  vg_outputs_release(&o);
}

static void conditions_of_all_patches(void **state)
{
  struct vg_outputs o = placed(ROOT);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  p.boundary.surface = (struct vg_mesh){ .n_patch = 5, .patch = patch };
  p.read.files.mapbc = (char *)ROOT "/case.mapbc";
  put(ROOT "/case.mapbc", "title\n.\n.\n.\n1 4 4 0 0\n");
  assert_int_equal(vg_outputs_check(&p, &o, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "patch 2 (side)"));
  put(ROOT "/case.mapbc", "nothing\n");
  assert_true(vg_outputs_check(&p, &o, &err) < 0);
}

static void sheets_need_a_format(void **state)
{
  struct vg_patch_row row = { .role = VG_PATCH_WALL };
  struct vg_problem p;

  (void)state;
  clean();
  begin_problem(&p);
  p.asked.n_patch = 1;
  p.asked.patch = &row;
  plans(&p, STEM, NULL, "cogsg", NULL);
  row.role = VG_PATCH_SHEET;
  plans(&p, STEM, NULL, "cogsg,pvtu", "none of these formats holds sheets");
  plans(&p, STEM, NULL, "cogsg,su2", NULL);
  plans(&p, STEM, NULL, "foam", NULL);
  plans(&p, STEM, NULL, "msh", NULL);
  plans(&p, STEM, NULL, "", NULL);
  p.asked.n_patch = 0;
  strcpy(p.asked.zone_interfaces, "plate");
  plans(&p, STEM, NULL, "cogsg", "none of these formats holds sheets");
  strcpy(p.asked.sheets, "plate");
  plans(&p, STEM, NULL, "cogsg", "none of these formats holds sheets");
}

static void no_outputs(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_slice slice = { .n_point = 0 };

  (void)state;
  assert_int_equal(vg_outputs_open(NULL, NULL, NULL, NULL, &err), VG_OK);
  assert_int_equal(vg_outputs_put(NULL, &slice, &err), VG_OK);
  assert_int_equal(vg_outputs_close(NULL, VG_ERR_IO, &err), VG_ERR_IO);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_call_fails),
    cmocka_unit_test(all_calls_fail_from_one_on),
    cmocka_unit_test(paths),
    cmocka_unit_test(messages_name_the_target),
    cmocka_unit_test(same_files),
    cmocka_unit_test(cells_that_a_format_lacks),
    cmocka_unit_test(inputs_are_not_overwritten),
    cmocka_unit_test(surfaces_stay_unique),
    cmocka_unit_test(conditions_are_added),
    cmocka_unit_test(conditions_of_all_patches),
    cmocka_unit_test(sheets_need_a_format),
    cmocka_unit_test(no_outputs),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
