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
#define MESH_PATH "constant/polyMesh"
#define PARTS_PATH "constant/" VG_FOAM_PARTS

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

/* --- moving a case over an earlier one ----------------------------------- */

struct merging {
  const char *from_case, *to_case;
  const struct vg_foam_mover *mover;
};

static vg_status merge(const struct merging *m, const char *path,
                       struct vg_error *err);

static vg_status add(const struct merging *m, enum vg_foam_move kind,
                     const char *path, const char *to, struct vg_error *err)
{
  return m->mover->add(m->mover->user, kind, path, to, err);
}

static int is_dot(const char *name)
{
  return !strcmp(name, ".") || !strcmp(name, "..");
}

/* Is it a file or folder of the earlier mesh? */
static int is_replaced(const char *name)
{
  size_t n = strlen(name);

  if (!strcmp(name, "sets")) return 1;
  if (n > 3 && !strcmp(name + n - 3, ".gz")) n -= 3;
  for (int i = 0; i < VG_FOAM_FILES; i++)
    if (strlen(vg_foam_file[i]) == n && !strncmp(name, vg_foam_file[i], n))
      return 1;
  for (size_t i = 0; i < sizeof belongs / sizeof *belongs; i++)
    if (strlen(belongs[i]) == n && !strncmp(name, belongs[i], n)) return 1;
  return 0;
}

/* Gives a file, or all files of a folder, a second name. */
static int link_all(const char *from, const char *to)
{
  struct stat is;
  struct dirent *entry;
  DIR *dir;
  int failed = 0;

  if (lstat(from, &is)) return -1;
  if (!S_ISDIR(is.st_mode)) return link(from, to);
  dir = mkdir(to, 0777) ? NULL : opendir(from);
  if (!dir) return -1;
  while (!failed && (entry = readdir(dir))) {
    char *a, *b;

    if (is_dot(entry->d_name)) continue;
    a = vg_foam_path(from, entry->d_name);
    b = vg_foam_path(to, entry->d_name);
    failed = a && b ? link_all(a, b) : -1;
    free(a);
    free(b);
  }
  closedir(dir);
  return failed;
}

/* The folder of the new mesh, which replaces the earlier one as a whole, also
 * gets the files there that belong to no mesh. */
static vg_status keep_others(const char *earlier, const char *mesh,
                             struct vg_error *err)
{
  DIR *dir = opendir(earlier);
  struct dirent *entry;
  vg_status st = VG_OK;

  if (!dir)
    return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", earlier,
                   strerror(errno));
  while (st >= 0 && (entry = readdir(dir))) {
    char *a, *b;

    if (is_dot(entry->d_name) || is_replaced(entry->d_name)) continue;
    a = vg_foam_path(earlier, entry->d_name);
    b = vg_foam_path(mesh, entry->d_name);
    if (!a || !b) st = vg_fail_memory(err, "a file name");
    else if (link_all(a, b))
      st = vg_fail(err, VG_ERR_IO,
                   "%s: cannot be kept with the new mesh: %s; move it to "
                   "another folder",
                   a, strerror(errno));
    free(a);
    free(b);
  }
  closedir(dir);
  return st;
}

/* Several cases may share a mesh by a link, which stays. */
static vg_status merge_mesh(const struct merging *m, const char *path,
                            const char *from, const char *to,
                            struct vg_error *err)
{
  char *real = realpath(to, NULL);
  struct stat is;
  vg_status st;

  if (!real)
    return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", to, strerror(errno));
  VG_TRY(keep_others(real, from, err));
  if (!stat(real, &is)) chmod(from, is.st_mode & 07777);
  st = add(m, VG_FOAM_FOLDER, path,
           !lstat(to, &is) && S_ISLNK(is.st_mode) ? real : NULL, err);
done:
  free(real);
  return st;
}

static vg_status merge_folder(const struct merging *m, const char *path,
                              const char *from, struct vg_error *err)
{
  DIR *dir = opendir(from);
  struct dirent *entry;
  vg_status st = VG_OK;

  if (!dir)
    return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", from,
                   strerror(errno));
  while (st >= 0 && (entry = readdir(dir))) {
    char *inner;

    if (is_dot(entry->d_name)) continue;
    inner = *path ? vg_foam_path(path, entry->d_name) : strdup(entry->d_name);
    st = inner ? merge(m, inner, err) : vg_fail_memory(err, "a file name");
    free(inner);
  }
  closedir(dir);
  return st;
}

/* Of existing files, only the subdomains of the cells are replaced. */
static vg_status merge_into(const struct merging *m, const char *path,
                            const char *from, const char *to,
                            const struct stat *is, struct vg_error *err)
{
  struct stat there;

  if (!S_ISDIR(is->st_mode))
    return strcmp(path, PARTS_PATH) ? VG_OK
                                    : add(m, VG_FOAM_FILE, path, NULL, err);
  if (stat(to, &there) || !S_ISDIR(there.st_mode))
    return vg_fail(err, VG_ERR_IO,
                   "%s: a file exists where a folder must be written; move it, "
                   "or choose another --out DIR",
                   to);
  return strcmp(path, MESH_PATH) ? merge_folder(m, path, from, err)
                                 : merge_mesh(m, path, from, to, err);
}

/* Adds the moves of `path`, a file or folder of the new case. */
static vg_status merge(const struct merging *m, const char *path,
                       struct vg_error *err)
{
  char *from = *path ? vg_foam_path(m->from_case, path) : strdup(m->from_case);
  char *to = *path ? vg_foam_path(m->to_case, path) : strdup(m->to_case);
  struct stat is, there;
  vg_status st;

  if (!from || !to) st = vg_fail_memory(err, "a file name");
  else if (lstat(from, &is))
    st = vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", from, strerror(errno));
  else if (!lstat(to, &there)) st = merge_into(m, path, from, to, &is, err);
  else
    st = add(m, S_ISDIR(is.st_mode) ? VG_FOAM_FOLDER : VG_FOAM_FILE, path, NULL,
             err);
  free(from);
  free(to);
  return st;
}

/* The subdomains of an earlier mesh do not fit this one. */
static vg_status remove_parts(const struct merging *m, struct vg_error *err)
{
  char *from = vg_foam_path(m->from_case, PARTS_PATH);
  char *to = vg_foam_path(m->to_case, PARTS_PATH);
  vg_status st = VG_OK;

  if (!from || !to) st = vg_fail_memory(err, "a file name");
  else if (access(from, F_OK) && !access(to, F_OK))
    st = add(m, VG_FOAM_REMOVE, PARTS_PATH, NULL, err);
  free(from);
  free(to);
  return st;
}

vg_status vg_foam_merge(const char *from_case, const char *to_case,
                        const struct vg_foam_mover *mover, struct vg_error *err)
{
  const struct merging m = { from_case, to_case, mover };
  vg_status st;

  assert(from_case && to_case && mover && mover->add);
  st = merge(&m, "", err);
  return st < 0 ? st : remove_parts(&m, err);
}

/* Write system/decomposeParDict if it is absent. */
static vg_status put_dict(const char *case_dir, size_t n_part,
                          struct vg_error *err)
{
  char *path = vg_foam_path(case_dir, "system/" DECOMPOSE_DICT), text[200];
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
  char *path = vg_foam_path(case_dir, PARTS_PATH);
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
