/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Folders of an OpenFOAM case; see io/mesh/foam.h. */
#include "io/mesh/foam.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/mesh/foam_parts.h"
#include "io/stream/stream.h"

/* `boundary` is last: without it OpenFOAM does not read the mesh. */
const char *const vg_foam_file[VG_FOAM_FILES] = { "points", "faces", "owner",
                                                  "neighbour", "boundary" };

/* Files that belong to a mesh in addition to its five files, compressed or not.
 * They would be wrong with another mesh (OpenFOAM's polyMesh::removeFiles, plus
 * the files of its tools for refinement and decomposition). */
static const char *const belongs[] = { "cells",
                                       "cellZones",
                                       "faceZones",
                                       "pointZones",
                                       "meshModifiers",
                                       "parallelData",
                                       "cellLevel",
                                       "pointLevel",
                                       "level0Edge",
                                       "surfaceIndex",
                                       "refinementHistory",
                                       "cellDecomposition",
                                       "cellMap",
                                       "faceMap",
                                       "pointMap",
                                       "cellProcAddressing",
                                       "faceProcAddressing",
                                       "pointProcAddressing",
                                       "boundaryProcAddressing",
                                       "tetBasePtIs",
                                       "points0" };

static const struct {
  const char *name, *text;
} system_file[] = {
  { "controlDict",
    "application     simpleFoam;\n"
    "startFrom       latestTime;\nstartTime       0;\n"
    "stopAt          endTime;\nendTime         1000;\ndeltaT          1;\n"
    "writeControl    timeStep;\nwriteInterval   100;\npurgeWrite      2;\n"
    "writeFormat     binary;\nwritePrecision  8;\n" },
  { "fvSchemes", "ddtSchemes      { default steadyState; }\n"
                 "gradSchemes     { default Gauss linear; }\n"
                 "divSchemes      { default none; }\n"
                 "laplacianSchemes { default Gauss linear limited 0.5; }\n"
                 "interpolationSchemes { default linear; }\n"
                 "snGradSchemes   { default limited 0.5; }\n"
                 "wallDist        { method meshWave; }\n" },
  { "fvSolution", "solvers         {}\n" }
};
#define N_SYSTEM (sizeof system_file / sizeof *system_file)

#define DECOMPOSE_DICT "decomposeParDict"

char *vg_foam_path(const char *a, const char *b)
{
  size_t n = strlen(a), m = strlen(b) + 1;
  char *to;

  while (n > 1 && a[n - 1] == '/') n--;
  to = vg_alloc(n + m + 1, 1);
  if (to) {
    memcpy(to, a, n);
    to[n] = '/';
    memcpy(to + n + 1, b, m);
  }
  return to;
}

vg_status vg_foam_folder(const char *path, struct vg_error *err)
{
  struct stat s;

  if (!mkdir(path, 0777)) return VG_OK;
  if (errno == EEXIST && !stat(path, &s) && S_ISDIR(s.st_mode)) return VG_OK;
  return vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", path,
                 strerror(errno));
}

void vg_foam_header(struct vg_output *out, const char *class_name,
                    const char *location, const char *object, int is_ascii,
                    const char *note)
{
  vg_output_format(out,
                   "FoamFile\n{\n    version     2.0;\n"
                   "    format      %s;\n    class       %s;\n",
                   is_ascii ? "ascii" : "binary", class_name);
  if (!is_ascii)
    vg_output_format(out, "    arch        \"%s;label=32;scalar=64\";\n",
                     vg_host_is_little() ? "LSB" : "MSB");
  if (note) vg_output_format(out, "    note        \"%s\";\n", note);
  vg_output_format(out, "    location    \"%s\";\n    object      %s;\n}\n\n",
                   location, object);
}

/* Remove "folder/name" and "folder/name.gz". */
static void unlink_both(const char *folder, const char *name)
{
  char *path = vg_foam_path(folder, name), *packed;

  if (!path) return;
  unlink(path);
  packed = vg_alloc(strlen(path) + 4, 1);
  if (packed) {
    sprintf(packed, "%s.gz", path);
    unlink(packed);
  }
  free(packed);
  free(path);
}

static void empty_sets(const char *folder)
{
  char *sets = vg_foam_path(folder, "sets");
  DIR *dir = sets ? opendir(sets) : NULL;
  struct dirent *entry;

  while (dir && (entry = readdir(dir))) {
    char *path = vg_foam_path(sets, entry->d_name);

    if (path) unlink(path); /* fails for folders, and so for . and .. */
    free(path);
  }
  if (dir) closedir(dir);
  if (sets) rmdir(sets);
  free(sets);
}

void vg_foam_remove_mesh(const char *folder)
{
  for (int i = VG_FOAM_FILES - 1; i >= 0; i--)
    unlink_both(folder, vg_foam_file[i]);
  rmdir(folder);
}

static vg_status move(const char *from, const char *to, struct vg_error *err)
{
  if (!rename(from, to)) return VG_OK;
  return vg_fail(err, VG_ERR_IO, "%s: cannot be moved to its final place: %s",
                 to, strerror(errno));
}

vg_status vg_foam_place_mesh(const char *from, const char *to,
                             struct vg_error *err)
{
  vg_status st = VG_OK;
  struct stat s;

  /* If the target is absent or empty, the whole mesh appears at once. */
  if (!rename(from, to)) return VG_OK;
  /* ENOTDIR: may be a link to a folder that several cases share. */
  if (errno != ENOTEMPTY && errno != EEXIST &&
      (errno != ENOTDIR || stat(to, &s) || !S_ISDIR(s.st_mode)))
    return vg_fail(err, VG_ERR_IO, "%s: cannot be moved to its final place: %s",
                   to, strerror(errno));
  /* If the program is stopped from here on, it leaves a mesh without
   * `boundary`, which no program reads, rather than a mixture of two meshes. */
  for (int i = VG_FOAM_FILES - 1; i >= 0; i--) unlink_both(to, vg_foam_file[i]);
  for (size_t i = 0; i < sizeof belongs / sizeof *belongs; i++)
    unlink_both(to, belongs[i]);
  empty_sets(to);
  for (int i = 0; i < VG_FOAM_FILES && st == VG_OK; i++) {
    char *source = vg_foam_path(from, vg_foam_file[i]);
    char *target = vg_foam_path(to, vg_foam_file[i]);

    st = source && target ? move(source, target, err)
                          : vg_fail_memory(err, "a file name");
    free(source);
    free(target);
  }
  rmdir(from);
  return st;
}

/* NAME.foam for this case; NULL if there is not enough memory. */
static char *marker_name(const char *case_dir)
{
  static const char tail[] = "." VG_FOAM_SUFFIX;
  size_t end = strlen(case_dir), at, n;
  char *name;

  while (end > 1 && case_dir[end - 1] == '/') end--;
  for (at = end; at && case_dir[at - 1] != '/'; at--) {
  }
  n = end - at;
  if (n >= sizeof tail &&
      !strncmp(case_dir + end - (sizeof tail - 1), tail, sizeof tail - 1))
    n -= sizeof tail - 1;
  if (!n || case_dir[at] == '.') {
    case_dir = "case"; /* for ".", ".." and hidden folders */
    at = 0;
    n = 4;
  }
  name = vg_alloc(n + 6, 1);
  if (!name) return NULL;
  memcpy(name, case_dir + at, n);
  strcpy(name + n, ".foam");
  return name;
}

static vg_status put_file(const char *path, const char *object,
                          const char *text, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st;

  if (!access(path, F_OK)) return VG_OK;
  st = vg_output_open(path, &out, err);
  if (st < 0) return st;
  if (object) {
    vg_foam_header(&out, "dictionary", "system", object, 1, NULL);
    vg_output_text(&out, text);
  }
  return vg_output_commit(&out, err);
}

vg_status vg_foam_surroundings(const char *case_dir, struct vg_error *err)
{
  char *folder = vg_foam_path(case_dir, "system");
  char *marker = marker_name(case_dir);
  char *path = marker ? vg_foam_path(case_dir, marker) : NULL;
  vg_status st;

  if (!folder || !path) {
    st = vg_fail_memory(err, "a file name");
    goto done;
  }
  VG_TRY(put_file(path, NULL, NULL, err));
  VG_TRY(vg_foam_folder(folder, err));
  for (size_t i = 0; i < N_SYSTEM && st == VG_OK; i++) {
    char *file = vg_foam_path(folder, system_file[i].name);

    st = file ? put_file(file, system_file[i].name, system_file[i].text, err)
              : vg_fail_memory(err, "a file name");
    free(file);
  }
done:
  free(folder);
  free(marker);
  free(path);
  return st;
}

/* CASE/a, or CASE/a/b if b is not NULL. */
static char *inside(const char *case_dir, const char *a, const char *b)
{
  char *first = vg_foam_path(case_dir, a), *both;

  if (!first || !b) return first;
  both = vg_foam_path(first, b);
  free(first);
  return both;
}

/* Move a file from one case to the other. With keep_old an existing target is
 * kept. Without it, the target is replaced, or removed if there is no
 * source. */
static vg_status place_file(const char *from_case, const char *to_case,
                            const char *folder, const char *name, int keep_old,
                            struct vg_error *err)
{
  char *from = inside(from_case, folder, name);
  char *to = inside(to_case, folder, name);
  vg_status st = VG_OK;

  if (!from || !to) st = vg_fail_memory(err, "a file name");
  else if (keep_old && !access(to, F_OK)) st = VG_OK;
  else if (!access(from, F_OK)) st = move(from, to, err);
  else if (!keep_old) unlink(to);
  free(from);
  free(to);
  return st;
}

/* The subdomains of an earlier mesh do not fit this one. */
static vg_status place_parts(const char *from_case, const char *to_case,
                             struct vg_error *err)
{
  vg_status st = place_file(from_case, to_case, "constant", VG_FOAM_PARTS, 0,
                            err);

  return st < 0
         ? st
         : place_file(from_case, to_case, "system", DECOMPOSE_DICT, 1, err);
}

vg_status vg_foam_place(const char *from_case, const char *to_case,
                        struct vg_error *err)
{
  char *from = inside(from_case, "constant", "polyMesh");
  char *to = inside(to_case, "constant", "polyMesh");
  char *constant = inside(to_case, "constant", NULL);
  vg_status st;

  if (!from || !to || !constant) {
    st = vg_fail_memory(err, "a file name");
    goto done;
  }
  VG_TRY(vg_foam_folder(to_case, err));
  VG_TRY(vg_foam_folder(constant, err));
  VG_TRY(vg_foam_surroundings(to_case, err));
  VG_TRY(vg_foam_place_mesh(from, to, err));
  VG_TRY(place_parts(from_case, to_case, err));
  vg_foam_remove(from_case);
done:
  free(from);
  free(to);
  free(constant);
  return st;
}

static void drop(const char *case_dir, const char *a, const char *b)
{
  char *path = inside(case_dir, a, b);

  if (path && unlink(path)) rmdir(path);
  free(path);
}

void vg_foam_remove(const char *case_dir)
{
  char *mesh = inside(case_dir, "constant", "polyMesh");
  char *marker = marker_name(case_dir);

  if (mesh) vg_foam_remove_mesh(mesh);
  for (size_t i = 0; i < N_SYSTEM; i++)
    drop(case_dir, "system", system_file[i].name);
  if (marker) drop(case_dir, marker, NULL);
  drop(case_dir, "constant", VG_FOAM_PARTS);
  drop(case_dir, "system", DECOMPOSE_DICT);
  drop(case_dir, "system", NULL);
  drop(case_dir, "constant", NULL);
  rmdir(case_dir);
  free(mesh);
  free(marker);
}

/* Write system/decomposeParDict if it is absent. */
static vg_status put_dict(const char *case_dir, size_t n_part,
                          struct vg_error *err)
{
  char *path = inside(case_dir, "system", DECOMPOSE_DICT), text[200];
  vg_status st;

  snprintf(text, sizeof text,
           "numberOfSubdomains %zu;\n"
           "method          manual;\n"
           "manualCoeffs    { dataFile \"" VG_FOAM_PARTS "\"; }\n",
           n_part);
  st = path ? put_file(path, DECOMPOSE_DICT, text, err)
            : vg_fail_memory(err, "a file name");
  free(path);
  return st;
}

vg_status vg_foam_write_parts(const char *case_dir, size_t n_cell,
                              const uint32_t *part, size_t n_part,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = inside(case_dir, "constant", VG_FOAM_PARTS);
  vg_status st;

  assert(part || !n_cell);
  if (!path) return vg_fail_memory(err, "a file name");
  VG_TRY(vg_output_open(path, &out, err));
  vg_foam_header(&out, "labelList", "constant", VG_FOAM_PARTS, 1, NULL);
  vg_output_format(&out, "%zu\n(\n", n_cell);
  for (size_t i = 0; i < n_cell; i++) {
    vg_output_int(&out, part[i]);
    vg_output_bytes(&out, "\n", 1);
  }
  vg_output_text(&out, ")\n");
  VG_TRY(vg_output_commit(&out, err));
  st = put_dict(case_dir, n_part, err);
done:
  vg_output_release(&out);
  free(path);
  return st;
}
