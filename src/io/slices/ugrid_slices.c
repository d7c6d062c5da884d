/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/slices/ugrid_slices.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/mesh/copies.h"
#include "io/mesh/ugrid.h"
#include "io/stream/convention.h"

/* Bytes at the start of a file by which its kind is checked. */
#define HEAD 65536
/* Points whose numbers differ by less are read at once. */
#define RUN 2048

struct vg_ugrid_slices {
  int fd;
  char *path;
  struct vg_ugrid_kind kind;
  uint64_t count[7];
  struct vg_mesh boundary; /* Faces and patches; no points, no cells. */
  struct vg_slices slices;
  double (*x)[3];      /* [slices.n_boundary_point] */
  double lo[3], hi[3]; /* Bounding box of the points. */
};

/* The arrays of a slice. */
struct part {
  size_t n_point, n_cap, n_own;
  uint64_t own_at;
  uint32_t *id, *own; /* [n_point], [n_own]; own points come first. */
  double (*x)[3];     /* [n_point] */
  uint32_t *cell[VG_SLICE_KINDS];
  size_t n_cell[VG_SLICE_KINDS], n_turned;
  struct vg_table table; /* Of the other points. */
};

/* --- bytes --------------------------------------------------------------- */

/* Read n bytes of the body into memory that the caller frees. */
static vg_status read_body(const struct vg_ugrid_slices *u, uint64_t at,
                           size_t n, struct vg_input *in, struct vg_error *err)
{
  const uint64_t start = 7 * (uint64_t)u->kind.int_size + at;
  size_t have = 0;

  *in = (struct vg_input){ .path = u->path, .size = n };
  in->data = vg_alloc(n + 1, 1);
  if (!in->data) return vg_fail_memory(err, "a slice of a .ugrid file");
  vg_input_order(in, u->kind.is_big);
  while (have < n) {
    ssize_t got = pread(u->fd, in->data + have, n - have,
                        (off_t)(start + have));

    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      return vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", u->path,
                     got ? strerror(errno) : "the file has become shorter");
    have += (size_t)got;
  }
  return VG_OK;
}

/* Read elements first .. first + n, with 0-based points. */
static vg_status read_nodes(const struct vg_ugrid_slices *u, int element,
                            uint64_t first, size_t n, uint32_t *node,
                            struct vg_error *err)
{
  const size_t n_int = n * (size_t)vg_ugrid_width[element];
  const size_t size = (size_t)u->kind.int_size;
  struct vg_input in;
  vg_status st;

  VG_TRY(read_body(u,
                   vg_ugrid_nodes_at(&u->kind, u->count, element) +
                     first * (uint64_t)vg_ugrid_width[element] * size,
                   n_int * size, &in, err));
  VG_TRY(vg_ugrid_ints(&in, u->kind.int_size, n_int, (int32_t *)node, 0,
                       vg_ugrid_element[element], err));
  st = vg_index_from_file(u->path, vg_ugrid_element[element], n,
                          vg_ugrid_width[element], u->count[0], node, err);
done:
  free(in.data);
  return st;
}

static vg_status read_points(const struct vg_ugrid_slices *u, uint64_t first,
                             size_t n, double (*x)[3], struct vg_error *err)
{
  const size_t size = (size_t)u->kind.real_size;
  struct vg_input in;
  vg_status st;

  VG_TRY(read_body(u, 3 * size * first, 3 * size * n, &in, err));
  VG_TRY(size == 8 ? vg_input_f64(&in, 3 * n, x[0], "points", err)
                   : vg_input_f32(&in, 3 * n, x[0], "points", err));
  st = vg_check_points(u->path, n, (const double(*)[3])x, err);
done:
  free(in.data);
  return st;
}

/* --- a slice ------------------------------------------------------------- */

static void free_part(struct part *p)
{
  if (!p) return;
  for (int k = 0; k < VG_SLICE_KINDS; k++) free(p->cell[k]);
  free(p->id);
  free(p->own);
  free(p->x);
  vg_table_release(&p->table);
  free(p);
}

static uint64_t hash_point(const void *of, uint32_t i)
{
  const struct part *p = of;

  return vg_hash_1(p->id[i]);
}

/* Replace point numbers of the mesh by those of the slice; -1 if there is not
 * enough memory. */
static int localise(struct part *p, size_t n, uint32_t *node)
{
  for (size_t i = 0; i < n; i++) {
    const uint32_t id = node[i];
    uint32_t *at;

    if (id >= p->own_at && id - p->own_at < p->n_own) {
      node[i] = (uint32_t)(id - p->own_at);
      continue;
    }
    if (vg_table_reserve(&p->table, p->n_point - p->n_own + 1, hash_point, p) ||
        vg_reserve(&p->id, &p->n_cap, p->n_point + 1, sizeof *p->id))
      return -1;
    VG_TABLE_FIND(&p->table, at, vg_hash_1(id), p->id[*at] == id);
    if (*at == VG_TABLE_FREE) {
      *at = (uint32_t)p->n_point;
      p->id[p->n_point++] = id;
    }
    node[i] = *at;
  }
  return 0;
}

static int compare_key(const void *a, const void *b)
{
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

  return (x > y) - (x < y);
}

/* Read the other points in ascending order, neighbours at once. */
static vg_status read_others(const struct vg_ugrid_slices *u, struct part *p,
                             struct vg_error *err)
{
  const size_t n = p->n_point - p->n_own;
  uint64_t *key = vg_alloc(n, sizeof *key); /* number, place in the slice */
  double(*block)[3] = vg_alloc(RUN, sizeof *block);
  vg_status st = VG_OK;

  if (!key || !block) st = vg_fail_memory(err, "the points of a slice");
  for (size_t i = 0; i < n && st >= 0; i++)
    key[i] = (uint64_t)p->id[p->n_own + i] << 32 | (p->n_own + i);
  if (st >= 0) qsort(key, n, sizeof *key, compare_key);
  for (size_t i = 0, end; i < n && st >= 0; i = end) {
    const uint64_t first = key[i] >> 32;

    for (end = i + 1; end < n && (key[end] >> 32) - first < RUN; end++)
      ;
    st = read_points(u, first, (size_t)((key[end - 1] >> 32) - first) + 1,
                     block, err);
    for (size_t k = i; k < end && st >= 0; k++)
      memcpy(p->x[(uint32_t)key[k]], block[(key[k] >> 32) - first],
             sizeof *p->x);
  }
  free(key);
  free(block);
  return st;
}

/* Number of the first item of slice i. */
static uint64_t first_of(const struct vg_slices *s, uint64_t n, size_t i)
{
  return (uint64_t)((unsigned __int128)n * i / s->n_slice);
}

static vg_status make_room(const struct vg_slices *s, size_t i, struct part *p,
                           struct vg_error *err)
{
  int bad = 0;

  p->own_at = first_of(s, s->n_point, i);
  p->n_own = (size_t)(first_of(s, s->n_point, i + 1) - p->own_at);
  p->n_point = p->n_own;
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    p->n_cell[k] = (size_t)(first_of(s, s->n_cell[k], i + 1) -
                            first_of(s, s->n_cell[k], i));
    p->cell[k] = vg_alloc(p->n_cell[k] * (size_t)vg_ugrid_width[k + 2],
                          sizeof *p->cell[k]);
    bad |= !p->cell[k];
  }
  p->own = vg_alloc(p->n_own, sizeof *p->own);
  bad |= !p->own || vg_reserve(&p->id, &p->n_cap, p->n_own, sizeof *p->id);
  if (bad) return vg_fail_memory(err, "a slice of a .ugrid file");
  for (size_t k = 0; k < p->n_own; k++) {
    p->own[k] = (uint32_t)k;
    p->id[k] = (uint32_t)(p->own_at + k);
  }
  return VG_OK;
}

/* The cells of the slice as a mesh with its points; arrays are borrowed. */
static struct vg_mesh view_of(const struct part *p)
{
  return (struct vg_mesh){ .n_point = p->n_point,
                           .point = p->x,
                           .n_tet = p->n_cell[VG_SLICE_TET],
                           .tet = (uint32_t(*)[4])p->cell[VG_SLICE_TET],
                           .n_pyr = p->n_cell[VG_SLICE_PYR],
                           .pyr = (uint32_t(*)[5])p->cell[VG_SLICE_PYR],
                           .n_pri = p->n_cell[VG_SLICE_PRI],
                           .pri = (uint32_t(*)[6])p->cell[VG_SLICE_PRI],
                           .n_hex = p->n_cell[VG_SLICE_HEX],
                           .hex = (uint32_t(*)[8])p->cell[VG_SLICE_HEX] };
}

static vg_status read_part(const struct vg_ugrid_slices *u, size_t i,
                           struct part *p, struct vg_error *err)
{
  const struct vg_slices *s = &u->slices;
  struct vg_mesh view;
  vg_status st;

  VG_TRY(make_room(s, i, p, err));
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    VG_TRY(read_nodes(u, k + 2, first_of(s, s->n_cell[k], i), p->n_cell[k],
                      p->cell[k], err));
    if (localise(p, p->n_cell[k] * (size_t)vg_ugrid_width[k + 2], p->cell[k]))
      return vg_fail_memory(err, "the points of a slice");
  }
  p->x = vg_alloc(p->n_point, sizeof *p->x);
  if (!p->x) return vg_fail_memory(err, "the points of a slice");
  VG_TRY(read_points(u, p->own_at, p->n_own, p->x, err));
  VG_TRY(read_others(u, p, err));
  view = view_of(p);
  p->n_turned = vg_mesh_turn_cells(&view);
done:
  return st;
}

static vg_status get_slice(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  struct part *p = vg_calloc(1, sizeof *p);
  vg_status st = p ? read_part(s->user, i, p, err)
                   : vg_fail_memory(err, "a slice of a .ugrid file");

  if (st < 0) {
    free_part(p);
    return st;
  }
  *out = (struct vg_slice){ .n_point = p->n_point,
                            .x = (const double(*)[3])p->x,
                            .id = p->id,
                            .point_at = p->own_at,
                            .n_own = p->n_own,
                            .own = p->own,
                            .keep = p };
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    out->cell_at[k] = first_of(s, s->n_cell[k], i);
    out->n_cell[k] = p->n_cell[k];
    out->cell[k] = p->cell[k];
  }
  return VG_OK;
}

static void put_slice(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  free_part(slice->keep);
  slice->keep = NULL;
}

/* --- the file ------------------------------------------------------------ */

/* Is it a file that can be read in slices? Sets kind, counts and the number of
 * layer tetrahedra. */
static int is_suitable(struct vg_ugrid_slices *u)
{
  struct vg_input in = VG_INPUT_INIT, tail;
  unsigned char magic[2] = { 0, 0 };
  struct stat s;
  uint64_t end;
  int fits, is_tail;
  int32_t n = -1;

  if (!vg_ugrid_kind(u->path, &u->kind) || u->kind.is_text ||
      u->kind.is_record || fstat(u->fd, &s) || !S_ISREG(s.st_mode) ||
      pread(u->fd, magic, 2, 0) != 2 ||
      (magic[0] == 0x1f && magic[1] == 0x8b) ||
      vg_input_open_head(u->path, HEAD, &in, NULL) < 0)
    return 0;
  in.size = (size_t)s.st_size;
  fits = vg_ugrid_check_kind(&in, &u->kind, NULL) >= 0 &&
         vg_ugrid_counts(&in, &u->kind, u->count);
  vg_input_release(&in);
  if (!fits || !(u->count[3] + u->count[4] + u->count[5] + u->count[6]))
    return 0;
  end = vg_ugrid_nodes_at(&u->kind, u->count, 6);
  is_tail = 8 * (uint64_t)u->kind.int_size + end <= (uint64_t)s.st_size;
  if (is_tail &&
      read_body(u, end, (size_t)u->kind.int_size, &tail, NULL) >= 0) {
    if (vg_ugrid_ints(&tail, u->kind.int_size, 1, &n, -1, "tail", NULL) >= 0 &&
        n >= 0 && (uint64_t)n <= u->count[3])
      u->slices.n_layer_cell[VG_SLICE_TET] = (uint64_t)n;
    free(tail.data);
  }
  return 1;
}

static vg_status read_boundary(struct vg_ugrid_slices *u, struct vg_error *err)
{
  struct vg_mesh *m = &u->boundary;
  const size_t n = (size_t)(u->count[1] + u->count[2]);
  const size_t size = (size_t)u->kind.int_size;
  int32_t *tag = vg_alloc(n, sizeof *tag);
  struct vg_input in = VG_INPUT_INIT;
  vg_status st;

  m->n_tri = u->count[1];
  m->n_quad = u->count[2];
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->quad = vg_alloc(m->n_quad, sizeof *m->quad);
  if (!tag || !m->tri || !m->quad) {
    st = vg_fail_memory(err, "the boundary of a .ugrid file");
    goto done;
  }
  VG_TRY(read_nodes(u, 0, 0, m->n_tri, (uint32_t *)m->tri, err));
  VG_TRY(read_nodes(u, 1, 0, m->n_quad, (uint32_t *)m->quad, err));
  VG_TRY(read_body(u, vg_ugrid_nodes_at(&u->kind, u->count, 2) - n * size,
                   n * size, &in, err));
  VG_TRY(vg_ugrid_ints(&in, u->kind.int_size, n, tag, INT32_MAX, "surface tags",
                       err));
  st = vg_patches_from_tags(m, tag, err);
done:
  free(in.data);
  free(tag);
  return st;
}

/* Points up to the last one of the boundary. */
static vg_status read_boundary_points(struct vg_ugrid_slices *u,
                                      struct vg_error *err)
{
  const size_t n = (size_t)u->slices.n_boundary_point;
  vg_status st = VG_OK;

  u->x = vg_alloc(n, sizeof *u->x);
  if (!u->x) return vg_fail_memory(err, "the points of the boundary");
  for (size_t i = 0; i < n && st >= 0; i += RUN)
    st = read_points(u, i, n - i < RUN ? n - i : RUN, u->x + i, err);
  return st;
}

static void serve(struct vg_ugrid_slices *u, size_t slice_cells)
{
  struct vg_slices *s = &u->slices;

  s->n_point = u->count[0];
  for (int k = 0; k < VG_SLICE_KINDS; k++) {
    s->n_cell[k] = u->count[3 + k];
    s->n_served += s->n_cell[k];
  }
  s->n_boundary_point = vg_mesh_boundary_end(&u->boundary);
  s->boundary = &u->boundary;
  s->n_slice = (size_t)((s->n_served > s->n_point ? s->n_served : s->n_point) /
                        slice_cells) +
               1;
  s->get = get_slice;
  s->put = put_slice;
  s->user = u;
}

static void add_bounds(struct vg_ugrid_slices *u, const struct part *p)
{
  const struct vg_mesh own = { .n_point = p->n_own, .point = p->x };
  double lo[3], hi[3];

  if (!p->n_own) return;
  vg_mesh_bounds(&own, lo, hi);
  for (int k = 0; k < 3; k++) {
    if (!p->own_at || lo[k] < u->lo[k]) u->lo[k] = lo[k];
    if (!p->own_at || hi[k] > u->hi[k]) u->hi[k] = hi[k];
  }
}

/* Meet all cells once: their boundary faces, and errors of the file. *is_whole:
 * a face lies between two cells. */
static vg_status scan(struct vg_ugrid_slices *u, struct vg_turned *turned,
                      int *is_whole, struct vg_error *err)
{
  struct vg_face_sides *sides = NULL;
  struct vg_slice slice;
  vg_status st = vg_face_sides_new(&u->boundary, &sides, err);

  for (size_t i = 0; i < u->slices.n_slice && st >= 0; i++) {
    struct vg_mesh view;
    struct part *p;

    st = get_slice(&u->slices, i, &slice, err);
    if (st < 0) break;
    p = slice.keep;
    turned->cell += p->n_turned;
    add_bounds(u, p);
    for (int k = 0; k < VG_SLICE_KINDS; k++)
      for (size_t j = 0; j < p->n_cell[k] * (size_t)vg_ugrid_width[k + 2]; j++)
        p->cell[k][j] = p->id[p->cell[k][j]];
    view = view_of(p);
    vg_face_sides_meet(sides, &view);
    put_slice(&u->slices, &slice);
  }
  if (st >= 0)
    *is_whole = !vg_face_sides_turn(sides, &u->boundary, &turned->face);
  vg_face_sides_free(sides);
  return st;
}

/* *is_whole as by `scan`, also for a file that has another layout. */
static vg_status open_file(struct vg_ugrid_slices *u, size_t slice_cells,
                           struct vg_turned *turned, int *is_whole,
                           struct vg_error *err)
{
  struct vg_mesh boundary;
  vg_status st;

  *is_whole = 1;
  if (!u->path) return vg_fail_memory(err, "a .ugrid file");
  u->fd = open(u->path, O_RDONLY | O_CLOEXEC);
  if (u->fd < 0 || !is_suitable(u)) return VG_OK;
  VG_TRY(read_boundary(u, err));
  serve(u, slice_cells);
  VG_TRY(read_boundary_points(u, err));
  boundary = vg_ugrid_slices_boundary(u);
  VG_TRY(vg_mesh_copies(&boundary, &u->slices.n_copy, err));
  st = scan(u, turned, is_whole, err);
done:
  return st;
}

vg_status vg_ugrid_slices_open(const char *path, size_t slice_cells,
                               struct vg_ugrid_slices **out,
                               struct vg_read_info *info, struct vg_error *err)
{
  struct vg_ugrid_slices *u;
  struct vg_read_info found = { .mapbc = info->mapbc, .format = "ugrid" };
  struct vg_error why = VG_ERROR_INIT;
  struct vg_mesh m;
  char *sheets;
  int is_whole;
  vg_status st;

  assert(path && slice_cells && out);
  *out = NULL;
  VG_TRY(vg_format_sheet_file(path, &sheets, err));
  is_whole = *sheets != 0;
  free(sheets);
  if (is_whole) return VG_OK;
  u = vg_calloc(1, sizeof *u);
  if (!u) return vg_fail_memory(err, "a .ugrid file");
  u->fd = -1;
  u->path = strdup(path);
  st = open_file(u, slice_cells, &found.turned, &is_whole, &why);
  if (st < 0 || is_whole) {
    vg_ugrid_slices_close(u);
    if (st >= 0 || st == VG_ERR_FORMAT || st == VG_ERR_INPUT) return VG_OK;
    if (err) *err = why;
    return st;
  }
  found.n_cell = (size_t)u->slices.n_served;
  m = vg_ugrid_slices_boundary(u);
  st = vg_format_use_mapbc(path, &m, &found, err);
  u->boundary.patch = m.patch;
  u->boundary.n_patch = m.n_patch;
  if (st < 0) {
    vg_ugrid_slices_close(u);
    return st;
  }
  *info = found;
  *out = u;
done:
  return st;
}

void vg_ugrid_slices_close(struct vg_ugrid_slices *u)
{
  if (!u) return;
  if (u->fd >= 0) close(u->fd);
  vg_mesh_release(&u->boundary);
  free(u->x);
  free(u->path);
  free(u);
}

const struct vg_slices *vg_ugrid_slices(const struct vg_ugrid_slices *u)
{
  return &u->slices;
}

void vg_ugrid_slices_bounds(const struct vg_ugrid_slices *u, double lo[3],
                            double hi[3])
{
  memcpy(lo, u->lo, sizeof u->lo);
  memcpy(hi, u->hi, sizeof u->hi);
}

struct vg_mesh vg_ugrid_slices_boundary(const struct vg_ugrid_slices *u)
{
  struct vg_mesh m = u->boundary;

  m.point = u->x;
  m.n_point = (size_t)u->slices.n_boundary_point;
  return m;
}
