/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/foam/foam_read.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/foam/foam_mesh.h"
#include "io/foam/foam_text.h"

/* The path of a file below a folder; NULL if there is not enough memory. */
static char *below(const char *folder, const char *file)
{
  char *path;

  return asprintf(&path, "%s/%s", folder, file) < 0 ? NULL : path;
}

static int has_file(const char *folder, const char *name)
{
  int has = 0;

  free(vg_foam_find_file(folder, name, &has));
  return has;
}

/* --- lists of polyMesh ---------------------------------------------------- */

/* Labels as numbers below `end`, in place of 64-bit labels. */
static vg_status narrow(const struct vg_foam_text *f, const char *what,
                        size_t n, const int64_t *label, size_t end,
                        uint32_t *out, struct vg_error *err)
{
  for (size_t i = 0; i < n; i++) {
    if (label[i] < 0 || (uint64_t)label[i] >= end)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: %s %zu is %lld, which is not in [0, %zu)", f->in.path,
                     what, i, (long long)label[i], end);
    out[i] = (uint32_t)label[i];
  }
  return VG_OK;
}

static vg_status read_points(const char *folder, struct vg_foam_lists *l,
                             struct vg_error *err)
{
  struct vg_foam_text f = VG_FOAM_TEXT_INIT;
  vg_status st;

  VG_TRY(vg_foam_text_open(folder, "points", &f, err));
  st = vg_foam_reals(&f, "points", 3, INT32_MAX, &l->n_point, &l->point, err);
done:
  vg_foam_text_release(&f);
  return st;
}

/* Text: the number of corners of each face and the corners in parentheses. */
static vg_status face_list(struct vg_foam_text *f, struct vg_foam_lists *l,
                           int64_t **corner, struct vg_error *err)
{
  const char *text;
  size_t len, room = 0;
  int64_t n;
  vg_status st;

  if (!vg_foam_token(f, &text, &len) || !vg_parse_int(text, len, &n) || n < 0)
    return vg_input_fail(&f->in, err, "no number of faces");
  VG_TRY(vg_input_need(&f->in, (uint64_t)n, 4, "faces", err));
  VG_TRY(vg_foam_expect(f, "(", "the faces", err));
  l->n_face = (size_t)n;
  l->first = vg_alloc(l->n_face + 1, sizeof *l->first);
  if (!l->first) return vg_fail_memory(err, "faces");
  l->first[0] = 0;
  for (size_t i = 0; i < l->n_face; i++) {
    int64_t *one = NULL;
    size_t w = 0;

    VG_TRY(vg_foam_labels(f, "corners of a face", INT32_MAX, &w, &one, err));
    if (vg_reserve(corner, &room, l->n_corner + w, sizeof **corner))
      st = vg_fail_memory(err, "faces");
    else if (w) memcpy(*corner + l->n_corner, one, w * sizeof *one);
    free(one);
    if (st < 0) goto done;
    l->n_corner += w;
    l->first[i + 1] = l->n_corner;
  }
  st = vg_foam_expect(f, ")", "the faces", err);
done:
  return st;
}

/* Binary files, and some text files: where the corners of each face begin, and
 * all corners. */
static vg_status compact_list(struct vg_foam_text *f, struct vg_foam_lists *l,
                              int64_t **corner, struct vg_error *err)
{
  int64_t *start = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_foam_labels(f, "starts of faces", SIZE_MAX / 16, &n, &start, err));
  VG_TRY(vg_foam_labels(f, "corners of faces", SIZE_MAX / 16, &l->n_corner,
                        corner, err));
  l->n_face = n ? n - 1 : 0;
  l->first = vg_calloc(l->n_face + 1, sizeof *l->first);
  if (!l->first) {
    st = vg_fail_memory(err, "faces");
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    if (start[i] < (i ? start[i - 1] : 0) || (uint64_t)start[i] > l->n_corner ||
        (!i && start[i]) || (i == n - 1 && (uint64_t)start[i] != l->n_corner)) {
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: face %zu begins at corner %lld of %zu", f->in.path, i,
                   (long long)start[i], l->n_corner);
      goto done;
    }
    l->first[i] = (size_t)start[i];
  }
done:
  free(start);
  return st;
}

static vg_status read_faces(const char *folder, struct vg_foam_lists *l,
                            struct vg_error *err)
{
  struct vg_foam_text f = VG_FOAM_TEXT_INIT;
  int64_t *corner = NULL;
  vg_status st;

  VG_TRY(vg_foam_text_open(folder, "faces", &f, err));
  if (!strcmp(f.class_name, "faceCompactList")) {
    VG_TRY(compact_list(&f, l, &corner, err));
  } else if (f.is_binary) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: a binary list of class %s; foamFormatConvert writes it "
                 "as faceCompactList or as text",
                 f.in.path, f.class_name);
    goto done;
  } else VG_TRY(face_list(&f, l, &corner, err));
  l->corner = vg_alloc(l->n_corner, sizeof *l->corner);
  if (!l->corner) st = vg_fail_memory(err, "faces");
  else
    st = narrow(&f, "corner", l->n_corner, corner, l->n_point, l->corner, err);
done:
  free(corner);
  vg_foam_text_release(&f);
  return st;
}

/* Cells at both sides of the faces. Old files have -1 for faces without a
 * neighbour. */
static vg_status read_sides(const char *folder, struct vg_foam_lists *l,
                            struct vg_error *err)
{
  struct vg_foam_text f = VG_FOAM_TEXT_INIT;
  int64_t *label = NULL;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_foam_text_open(folder, "owner", &f, err));
  VG_TRY(vg_foam_labels(&f, "owners", l->n_face, &n, &label, err));
  if (n != l->n_face) {
    st = vg_fail(err, VG_ERR_FORMAT, "%s has %zu owners of %zu faces",
                 f.in.path, n, l->n_face);
    goto done;
  }
  for (size_t i = 0; i < n; i++)
    if (label[i] >= 0 && (uint64_t)label[i] >= l->n_cell)
      l->n_cell = (size_t)label[i] + 1;
  l->owner = vg_alloc(n, sizeof *l->owner);
  l->neighbour = vg_alloc(n, sizeof *l->neighbour);
  if (!l->owner || !l->neighbour) {
    st = vg_fail_memory(err, "faces");
    goto done;
  }
  /* Each cell owns a face or is a neighbour; it has at least four faces. */
  if (l->n_cell > 2 * l->n_face) l->n_cell = 2 * l->n_face;
  VG_TRY(narrow(&f, "owner", n, label, l->n_cell, l->owner, err));
  free(label);
  label = NULL;
  vg_foam_text_release(&f);
  VG_TRY(vg_foam_text_open(folder, "neighbour", &f, err));
  VG_TRY(vg_foam_labels(&f, "neighbours", l->n_face, &n, &label, err));
  while (n && label[n - 1] == -1) n--;
  l->n_inner = n;
  st = narrow(&f, "neighbour", n, label, 2 * l->n_face, l->neighbour, err);
  for (size_t i = 0; i < n && st >= 0; i++)
    if (l->neighbour[i] >= l->n_cell) l->n_cell = l->neighbour[i] + 1;
done:
  free(label);
  vg_foam_text_release(&f);
  return st;
}

/* The entries nFaces and startFace of a patch. */
static vg_status read_patch(struct vg_foam_text *f, struct vg_foam_patch *p,
                            struct vg_error *err)
{
  const char *text;
  size_t len;
  int64_t value;
  vg_status st;

  VG_TRY(vg_foam_expect(f, "{", "a patch", err));
  while (vg_foam_token(f, &text, &len)) {
    size_t *to = vg_token_is(text, len, "nFaces")    ? &p->n
               : vg_token_is(text, len, "startFace") ? &p->start
                                                     : NULL;

    if (*text == '}') return VG_OK;
    if (to) {
      const size_t back = f->in.at, line = f->in.line;

      if (!vg_foam_token(f, &text, &len) || !vg_parse_int(text, len, &value) ||
          value < 0)
        return vg_input_fail(&f->in, err, "patch %s: not a number of faces",
                             p->name);
      *to = (size_t)value;
      f->in.at = back;
      f->in.line = line;
    }
    VG_TRY(vg_foam_skip_value(f, err));
  }
  st = vg_input_fail(&f->in, err, "patch %s has no end", p->name);
done:
  return st;
}

static vg_status read_boundary(const char *folder, struct vg_foam_lists *l,
                               struct vg_error *err)
{
  struct vg_foam_text f = VG_FOAM_TEXT_INIT;
  const char *text;
  size_t len, next = l->n_inner;
  int64_t n;
  vg_status st;

  VG_TRY(vg_foam_text_open(folder, "boundary", &f, err));
  if (!vg_foam_token(&f, &text, &len) || !vg_parse_int(text, len, &n) ||
      n < 0) {
    st = vg_input_fail(&f.in, err, "no number of patches");
    goto done;
  }
  VG_TRY(vg_input_need(&f.in, (uint64_t)n, 4, "patches", err));
  VG_TRY(vg_foam_expect(&f, "(", "the patches", err));
  l->patch = vg_calloc((size_t)n, sizeof *l->patch);
  if (!l->patch) {
    st = vg_fail_memory(err, "patches");
    goto done;
  }
  for (; l->n_patch < (size_t)n; l->n_patch++) {
    struct vg_foam_patch *p = &l->patch[l->n_patch];

    if (!vg_foam_token(&f, &text, &len)) break;
    snprintf(p->name, sizeof p->name, "%.*s",
             (int)(len < VG_NAME_MAX ? len : VG_NAME_MAX - 1), text);
    VG_TRY(read_patch(&f, p, err));
    if (p->start != next && p->n) break;
    if (p->n > l->n_face - next) break;
    next += p->n;
  }
  st = l->n_patch == (size_t)n && next == l->n_face
       ? VG_OK
       : vg_input_fail(&f.in, err,
                       "the patches do not cover the faces %zu to %zu of the "
                       "boundary one after the other",
                       l->n_inner, l->n_face - 1);
done:
  vg_foam_text_release(&f);
  return st;
}

/* --- cases ---------------------------------------------------------------- */

void vg_foam_case_release(struct vg_foam_case *c)
{
  free(c->folder);
  free(c->time);
  free(c->cell);
  vg_mesh_release(&c->m);
  *c = (struct vg_foam_case)VG_FOAM_CASE_INIT;
}

static int has_mesh(const char *folder)
{
  return has_file(folder, "constant/polyMesh/owner");
}

int vg_foam_is_case(const char *path)
{
  char *parent = below(path, "..");
  int is = has_mesh(path) || (parent && has_mesh(parent));

  free(parent);
  return is;
}

/* The folder with the largest number as its name; "" without one. */
static vg_status last_time(const char *folder, char **time,
                           struct vg_error *err)
{
  DIR *dir = opendir(folder);
  struct dirent *d;
  char last[256] = "";
  double most = -1, value;

  while (dir && (d = readdir(dir)) != NULL) {
    if (!vg_parse_real(d->d_name, strlen(d->d_name), &value) || value < most ||
        (value == most && strcmp(d->d_name, last) > 0))
      continue;
    snprintf(last, sizeof last, "%s", d->d_name);
    most = value;
  }
  if (dir) closedir(dir);
  *time = *last ? below(folder, last) : strdup("");
  return *time ? VG_OK : vg_fail_memory(err, "a file name");
}

static vg_status find_case(const char *path, struct vg_foam_case *c,
                           struct vg_error *err)
{
  if (has_mesh(path)) {
    c->folder = strdup(path);
    if (c->folder) return last_time(path, &c->time, err);
  } else {
    c->folder = below(path, "..");
    c->time = strdup(path);
    if (c->folder && c->time) return VG_OK;
  }
  return vg_fail_memory(err, "a file name");
}

vg_status vg_foam_case_read(const char *path, struct vg_foam_case *c,
                            struct vg_error *err)
{
  struct vg_foam_lists l = VG_FOAM_LISTS_INIT;
  char *folder = NULL, *moved = NULL;
  vg_status st;

  VG_TRY(find_case(path, c, err));
  folder = below(c->folder, "constant/polyMesh");
  moved = below(*c->time ? c->time : c->folder, "polyMesh");
  if (!folder || !moved) {
    st = vg_fail_memory(err, "a file name");
    goto done;
  }
  if (has_file(moved, "faces")) {
    st = vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: the faces of the mesh change with time, which is not "
                 "read; write the solution with foamToVTK",
                 moved);
    goto done;
  }
  /* A mesh that moves has points of its own at each time. */
  VG_TRY(read_points(has_file(moved, "points") ? moved : folder, &l, err));
  VG_TRY(read_faces(folder, &l, err));
  VG_TRY(read_sides(folder, &l, err));
  VG_TRY(read_boundary(folder, &l, err));
  VG_TRY(vg_foam_mesh(folder, &l, &c->m, &c->cell, err));
  c->n_cell = l.n_cell;
done:
  vg_foam_lists_release(&l);
  free(folder);
  free(moved);
  return st;
}
