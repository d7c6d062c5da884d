/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* .cogsg and its companion files (formats.md 1.2). */
#define _GNU_SOURCE
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/vgrid/cogsg_put.h"
#include "io/vgrid/mapbc.h"
#include "io/vgrid/vgrid.h"

#define BLOCK 4096

struct layout {
  int is_big, marker8, tc_size;
};

/* In the order in which the reader tries them. */
static const struct layout layouts[] = { { 1, 0, 8 }, { 0, 0, 8 }, { 1, 0, 4 },
                                         { 0, 0, 4 }, { 1, 1, 8 }, { 0, 1, 8 },
                                         { 1, 1, 4 }, { 0, 1, 4 } };

/* Does the first marker fit the cell count that follows it? A negative marker
 * belongs to the first of several subrecords, which together must be longer. */
static int layout_fits(const struct vg_input *file, const struct layout *l)
{
  struct vg_input in = *file;
  int64_t marker, full;
  int32_t narrow, head[2];

  in.at = 0;
  vg_input_order(&in, l->is_big);
  if (l->marker8) {
    if (vg_input_i64(&in, 1, &marker, "marker", NULL) < 0) return 0;
  } else {
    if (vg_input_i32(&in, 1, &narrow, "marker", NULL) < 0) return 0;
    marker = narrow;
  }
  /* In tests, the first subrecord may be too short to hold the cell count. */
  if (marker < 0 && marker > -8) return 0;
  if (vg_input_i32(&in, 2, head, "header", NULL) < 0 || head[1] < 0) return 0;
  full = 24 + l->tc_size + 16 * (int64_t)head[1];
  return marker < 0 ? marker > -full : marker == full;
}

static vg_status find_layout(const struct vg_input *in, struct layout *found,
                             struct vg_error *err)
{
  for (size_t i = 0; i < sizeof layouts / sizeof layouts[0]; i++)
    if (layout_fits(in, layouts + i)) {
      *found = layouts[i];
      return VG_OK;
    }
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: not a .cogsg: its first Fortran marker is not 32 + 16 x "
                 "the number of cells, in either byte order (%zu bytes)",
                 in->path, in->size);
}

struct header {
  int32_t inew, nc, npo, nbn, npv, nev;
  double tc;
};

static vg_status bad_header(const struct vg_input *in, const struct header *h,
                            const char *what, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: %s (header: %d cells, %d points, %d boundary points, "
                 "npv %d, nev %d)",
                 in->path, what, h->nc, h->npo, h->nbn, h->npv, h->nev);
}

static vg_status read_header(struct vg_input *record, const struct layout *l,
                             struct header *h, struct vg_error *err)
{
  int32_t v[6];
  vg_status st = vg_input_i32(record, 6, v, "header", err);

  if (st == VG_OK)
    st = l->tc_size == 8 ? vg_input_f64(record, 1, &h->tc, "tc", err)
                         : vg_input_f32(record, 1, &h->tc, "tc", err);
  if (st < 0) return st;
  h->inew = v[0];
  h->nc = v[1];
  h->npo = v[2];
  h->nbn = v[3];
  h->npv = v[4];
  h->nev = v[5];
  if (h->nc < 0 || h->npo < 0 || h->nbn < 0 || h->npv < 0 || h->nev < 0)
    return bad_header(record, h, "a negative count", err);
  if (vg_input_left(record) != 16 * (uint64_t)h->nc)
    return bad_header(record, h,
                      "the length of the first record does not match its "
                      "number of cells",
                      err);
  if (h->nbn > h->npo)
    return bad_header(record, h, "more boundary points than points", err);
  if (h->nev > h->nc)
    return bad_header(record, h, "more layer cells than cells", err);
  return VG_OK;
}

/* The file lists the first nodes of all cells, then all second nodes, ... */
static vg_status read_cells(struct vg_input *record, size_t n_point,
                            struct vg_mesh *m, struct vg_error *err)
{
  int32_t block[BLOCK];

  for (int slot = 0; slot < 4; slot++)
    for (size_t i = 0, len; i < m->n_tet; i += len) {
      vg_status st;

      len = m->n_tet - i < BLOCK ? m->n_tet - i : BLOCK;
      st = vg_input_i32(record, len, block, "cells", err);
      if (st < 0) return st;
      for (size_t k = 0; k < len; k++) m->tet[i + k][slot] = (uint32_t)block[k];
    }
  return vg_index_from_file(record->path, "cell", m->n_tet, 4, n_point,
                            (uint32_t *)m->tet, err);
}

static vg_status read_points(struct vg_input *record, struct vg_mesh *m,
                             struct vg_error *err)
{
  uint64_t left = vg_input_left(record);
  int real_size = left == 12 * (uint64_t)m->n_point ? 4 : 8;
  double block[BLOCK];

  if (left != 3 * (uint64_t)real_size * m->n_point)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the record of the coordinates has %llu bytes; %zu "
                   "points need %zu",
                   record->path, (unsigned long long)left, m->n_point,
                   24 * m->n_point);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0, len; i < m->n_point; i += len) {
      vg_status st;

      len = m->n_point - i < BLOCK ? m->n_point - i : BLOCK;
      st = real_size == 8
           ? vg_input_f64(record, len, block, "coordinates", err)
           : vg_input_f32(record, len, block, "coordinates", err);
      if (st < 0) return st;
      for (size_t k = 0; k < len; k++) m->point[i + k][axis] = block[k];
    }
  return vg_check_points(record->path, m->n_point, m->point, err);
}

static int count_trailing(struct vg_input *in)
{
  struct vg_input record;
  int n = 0;

  while (vg_input_left(in) && n < 1000 &&
         vg_input_record(in, &record, "trailing data", NULL) == VG_OK)
    n++;
  return n;
}

static vg_status parse_volume(struct vg_input *in, struct vg_mesh *m,
                              struct vg_cogsg_info *info, struct vg_error *err)
{
  struct vg_input record;
  struct layout l = layouts[0];
  struct header h;
  vg_status st = find_layout(in, &l, err);

  if (st < 0) return st;
  in->at = 0;
  in->marker8 = l.marker8;
  vg_input_order(in, l.is_big);
  st = vg_input_record(in, &record, "the cells", err);
  if (st == VG_OK) st = read_header(&record, &l, &h, err);
  /* After the cells there must be three reals of at least four bytes per
   * point. */
  if (st == VG_OK)
    st = vg_input_need(in, (uint64_t)h.npo, 12, "the coordinates", err);
  if (st < 0) return st;
  m->tet = vg_alloc((size_t)h.nc, sizeof *m->tet);
  m->point = vg_alloc((size_t)h.npo, sizeof *m->point);
  if (!m->tet || !m->point) return vg_fail_memory(err, "a .cogsg mesh");
  m->n_tet = (size_t)h.nc;
  m->n_point = (size_t)h.npo;
  st = read_cells(&record, m->n_point, m, err);
  if (st == VG_OK) st = vg_input_record(in, &record, "the coordinates", err);
  if (st == VG_OK) st = read_points(&record, m, err);
  if (st < 0) return st;
  info->inew = h.inew;
  info->n_boundary = (size_t)h.nbn;
  info->n_layer_point = (size_t)h.npv;
  info->n_layer_cell = (size_t)h.nev;
  info->tc = h.tc;
  info->n_trailing = count_trailing(in);
  return VG_OK;
}

vg_status vg_cogsg_layer_tets(const char *path, int *is_known, size_t *n,
                              struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  struct layout l = layouts[0];
  int32_t v[6];
  vg_status st;

  assert(path && is_known && n);
  *is_known = 0;
  VG_TRY(vg_input_open_head(path, 65536, &in, err));
  VG_TRY(find_layout(&in, &l, err));
  vg_input_order(&in, l.is_big);
  in.at = l.marker8 ? 8 : 4;
  VG_TRY(vg_input_i32(&in, 6, v, "header", err));
  *is_known = v[5] >= 0 && v[5] <= v[1];
  if (*is_known) *n = (size_t)v[5];
done:
  vg_input_release(&in);
  return st;
}

vg_status vg_cogsg_parse(struct vg_input *cogsg, struct vg_input *bc,
                         struct vg_mesh *out, struct vg_cogsg_info *info,
                         struct vg_turned *turned, struct vg_error *err)
{
  struct vg_cogsg_info found = VG_COGSG_INFO_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  assert(cogsg && out);
  VG_TRY(parse_volume(cogsg, &m, &found, err));
  if (bc) VG_TRY(vg_bc_parse(bc, found.n_boundary, &m, &found, err));
  VG_TRY(vg_mesh_turn(&m, turned, err));
  vg_mesh_move(out, &m);
  if (info) *info = found;
done:
  vg_mesh_release(&m);
  return st;
}

/* Length of STEM in a path that is STEM, STEM.cogsg or STEM.cogsg.gz. */
static size_t stem_length(const char *path)
{
  size_t n = strlen(path);

  if (n > 3 && !strcasecmp(path + n - 3, ".gz")) n -= 3;
  if (n > 6 && !strncasecmp(path + n - 6, ".cogsg", 6)) n -= 6;
  return n;
}

/* STEM + suffix. */
static char *adjacent(const char *path, const char *suffix)
{
  char *to;

  return asprintf(&to, "%.*s%s", (int)stem_length(path), path, suffix) < 0
         ? NULL
         : to;
}

static vg_status open_bc(const char *path, struct vg_input *bc,
                         struct vg_error *err)
{
  char *name = adjacent(path, ".bc"), *packed = adjacent(path, ".bc.gz");
  vg_status st;

  if (!name || !packed) st = vg_fail_memory(err, "a file name");
  else if (!access(name, F_OK)) st = vg_input_open(name, bc, err);
  else if (!access(packed, F_OK)) st = vg_input_open(packed, bc, err);
  else
    st = vg_fail(err, VG_ERR_IO,
                 "%s: not found; it should contain the boundary triangles "
                 "of %s",
                 name, path);
  free(name);
  free(packed);
  return st;
}

vg_status vg_cogsg_read(const char *path, struct vg_mesh *out,
                        struct vg_cogsg_info *info, struct vg_turned *turned,
                        struct vg_error *err)
{
  struct vg_input cogsg = VG_INPUT_INIT, bc = VG_INPUT_INIT;
  vg_status st;

  VG_TRY(open_bc(path, &bc, err));
  VG_TRY(vg_input_open(path, &cogsg, err));
  VG_TRY(vg_cogsg_parse(&cogsg, &bc, out, info, turned, err));
done:
  vg_input_release(&cogsg);
  vg_input_release(&bc);
  return st;
}

/* --- writing --- */

static void put_slot(struct vg_output *out, const struct vg_mesh *m, int slot,
                     const uint32_t *new_index)
{
  int32_t block[BLOCK];

  if (!m->tet) {
    vg_output_skip(out, 4 * (uint64_t)m->n_tet);
    return;
  }
  for (size_t i = 0, len; i < m->n_tet; i += len) {
    len = m->n_tet - i < BLOCK ? m->n_tet - i : BLOCK;
    if (new_index)
      for (size_t k = 0; k < len; k++)
        block[k] = (int32_t)(new_index[m->tet[i + k][slot]] + 1);
    else
      for (size_t k = 0; k < len; k++)
        block[k] = (int32_t)(m->tet[i + k][slot] + 1);
    vg_output_i32(out, len, block);
  }
}

static void put_axis(struct vg_output *out, const struct vg_mesh *m, int axis,
                     const uint32_t *old_index)
{
  double block[BLOCK];

  if (!m->point) {
    vg_output_skip(out, 8 * (uint64_t)m->n_point);
    return;
  }
  for (size_t i = 0, len; i < m->n_point; i += len) {
    len = m->n_point - i < BLOCK ? m->n_point - i : BLOCK;
    for (size_t k = 0; k < len; k++)
      block[k] = m->point[old_index ? old_index[i + k] : i + k][axis];
    vg_output_f64(out, len, block);
  }
}

#define HEAD_BYTES 32u /* six integers and tc */

void vg_cogsg_put(struct vg_output *out, const struct vg_mesh *m,
                  const struct vg_cogsg_info *info, const uint32_t *new_to_old,
                  const uint32_t *old_to_new)
{
  const int32_t head[6] = { info->inew,
                            (int32_t)m->n_tet,
                            (int32_t)m->n_point,
                            (int32_t)info->n_boundary,
                            (int32_t)info->n_layer_point,
                            (int32_t)info->n_layer_cell };
  const int32_t zero = 0;

  assert(!new_to_old == !old_to_new);
  vg_output_order(out, 1);
  vg_output_record(out, HEAD_BYTES + 16 * (uint64_t)m->n_tet);
  vg_output_i32(out, 6, head);
  vg_output_f64(out, 1, &info->tc);
  for (int slot = 0; slot < 4; slot++) put_slot(out, m, slot, old_to_new);
  vg_output_record_end(out);
  vg_output_record(out, 24 * (uint64_t)m->n_point);
  for (int axis = 0; axis < 3; axis++) put_axis(out, m, axis, new_to_old);
  vg_output_record_end(out);
  for (int i = 0; i < info->n_trailing; i++) {
    vg_output_record(out, sizeof zero);
    vg_output_i32(out, 1, &zero);
    vg_output_record_end(out);
  }
}

void vg_cogsg_seek(struct vg_output *out, uint64_t n_tet, uint64_t n_point,
                   enum vg_cogsg_part part, int column, uint64_t first)
{
  uint64_t cells = HEAD_BYTES + 16 * n_tet;

  assert(column >= 0 && column < (part == VG_COGSG_CELLS ? 4 : 3));
  assert(first <= (part == VG_COGSG_CELLS ? n_tet : n_point));
  vg_output_order(out, 1);
  if (part == VG_COGSG_CELLS)
    vg_output_seek_record(out, 0, cells,
                          HEAD_BYTES + 4 * ((uint64_t)column * n_tet + first));
  else
    vg_output_seek_record(out, vg_record_size(cells, out->record_limit),
                          24 * n_point,
                          8 * ((uint64_t)column * n_point + first));
}

/* Right-justified to 8 columns; a number of 8 digits is still preceded by a
 * blank. */
static void put_column(struct vg_output *out, int64_t v)
{
  char text[32];
  int n = snprintf(text, sizeof text, " %7lld", (long long)v);

  vg_output_bytes(out, text, (size_t)n);
}

void vg_cogsg_put_faces(struct vg_output *out, const struct vg_mesh *m,
                        const struct vg_cogsg_info *info,
                        const uint32_t *old_to_new)
{
  int32_t igrid = info->igrid ? info->igrid : info->n_layer_cell ? 2 : 1;

  put_column(out, (int64_t)m->n_tri);
  put_column(out, (int64_t)info->n_curve_point);
  put_column(out, (int64_t)m->n_patch);
  put_column(out, igrid);
  vg_output_text(out, "\n Triangle   Surface Patch       Nodes\n");
  for (size_t f = 0; f < m->n_tri; f++) {
    put_column(out, (int64_t)f + 1);
    put_column(out, m->patch[m->tri_patch[f]].id);
    for (int k = 0; k < 3; k++) {
      uint32_t p = m->tri[f][k];

      put_column(out, (int64_t)(old_to_new ? old_to_new[p] : p) + 1);
    }
    vg_output_bytes(out, "\n", 1);
  }
}

vg_status vg_cogsg_check(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info, struct vg_error *err)
{
  const int n = (int)stem_length(stem);

  if (m->n_pyr || m->n_pri || m->n_hex || m->n_quad)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%.*s.cogsg: the format holds only tetrahedra and "
                   "triangles, but the mesh has other elements; write "
                   ".b8.ugrid",
                   n, stem);
  if (m->n_tet > INT32_MAX || m->n_point > INT32_MAX || m->n_tri > INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%.*s.cogsg: %zu cells and %zu points are too many for its "
                   "32-bit counts; write .b8l.ugrid",
                   n, stem, m->n_tet, m->n_point);
  if (info->n_layer_cell > m->n_tet || info->n_layer_point > m->n_point ||
      info->n_trailing < 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "%.*s.cogsg: more layer cells or points than the mesh has",
                   n, stem);
  return VG_OK;
}

vg_status vg_cogsg_write_mapbc(const char *stem, const struct vg_mesh *m,
                               size_t *n_unset, struct vg_error *err)
{
  const char *slash = strrchr(stem, '/');
  char *name = adjacent(stem, ".mapbc");
  vg_status st;

  if (!name) return vg_fail_memory(err, "a file name");
  st = vg_mapbc_write_output(name, m, slash ? slash + 1 : stem, n_unset, err);
  free(name);
  return st;
}

vg_status vg_cogsg_write(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info,
                         uint32_t record_limit, size_t *n_unset,
                         struct vg_error *err)
{
  struct vg_cogsg_info full = VG_COGSG_INFO_INIT;
  struct vg_output cogsg = VG_OUTPUT_INIT, bc = VG_OUTPUT_INIT;
  uint32_t *new_to_old = NULL, *old_to_new = NULL;
  char *cogsg_name = adjacent(stem, ".cogsg"), *bc_name = adjacent(stem, ".bc");
  vg_status st = VG_OK;

  if (info) full = *info;
  if (record_limit) cogsg.record_limit = record_limit;
  if (!cogsg_name || !bc_name) {
    st = vg_fail_memory(err, "a file name");
    goto done;
  }
  VG_TRY(vg_cogsg_check(stem, m, &full, err));
  VG_TRY(vg_vgrid_order(m, &new_to_old, &old_to_new, &full.n_curve_point,
                        &full.n_boundary, err));
  VG_TRY(vg_output_open(cogsg_name, &cogsg, err));
  VG_TRY(vg_output_open(bc_name, &bc, err));
  vg_cogsg_put(&cogsg, m, &full, new_to_old, old_to_new);
  vg_cogsg_put_faces(&bc, m, &full, old_to_new);
  VG_TRY(vg_output_flush(&bc, err));
  VG_TRY(vg_output_flush(&cogsg, err));
  VG_TRY(vg_cogsg_write_mapbc(stem, m, n_unset, err));
  VG_TRY(vg_output_commit(&bc, err));
  VG_TRY(vg_output_commit(&cogsg, err));
done:
  vg_output_release(&cogsg);
  vg_output_release(&bc);
  free(new_to_old);
  free(old_to_new);
  free(cogsg_name);
  free(bc_name);
  return st;
}
