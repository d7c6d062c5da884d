/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/slices/slices.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/fluent.h"
#include "io/slices/slices_parts.h"
#include "io/stream/shared_file.h"
#include "io/vgrid/mapbc.h"

/* --- writing the slices of a file --- */

static void set_limit(const struct vg_slice_file *f, struct vg_output *out)
{
  if (f->record_limit) out->record_limit = f->record_limit;
}

vg_status vg_slice_file_size(const struct vg_slice_file *f, uint64_t *size,
                             struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(NULL, &out, err);

  set_limit(f, &out);
  if (st >= 0) {
    f->frame(f->of, &out);
    st = vg_output_flush(&out, err);
    *size = out.written;
  }
  vg_output_release(&out);
  return st;
}

vg_status vg_slice_file_put(const struct vg_slice_file *f,
                            struct vg_shared_file *to,
                            const struct vg_slice *slice, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(to, &out, err);

  set_limit(f, &out);
  if (st >= 0) {
    if (slice) f->slice(f->of, slice, &out);
    else f->frame(f->of, &out);
    st = vg_output_flush(&out, err);
  }
  vg_output_release(&out);
  return st;
}

struct fill {
  const struct vg_slice_file *f;
  struct vg_shared_file *to;
};

static vg_status fill_slice(void *context, const struct vg_slice *slice,
                            struct vg_error *err)
{
  const struct fill *fill = context;

  return vg_slice_file_put(fill->f, fill->to, slice, err);
}

vg_status vg_slice_file_fill(const struct vg_slice_file *f,
                             struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_shared_file *to,
                             struct vg_error *err)
{
  struct fill fill = { f, to };
  vg_status st = VG_OK;

  if (!vg_comm_rank(comm)) st = vg_slice_file_put(f, to, NULL, err);
  return st < 0 ? st : vg_slices_each(s, threads, fill_slice, &fill, err);
}

vg_status vg_slice_file_open(const struct vg_slice_file *f,
                             struct vg_comm *comm, struct vg_shared_file **to,
                             struct vg_error *err)
{
  uint64_t size = 0;
  vg_status st = vg_slice_file_size(f, &size, err);

  st = vg_comm_agree(comm, st, err);
  return st < 0 ? st : vg_shared_open(comm, f->path, size, to, err);
}

vg_status vg_slice_file_write(const struct vg_slice_file *f,
                              struct vg_comm *comm, const struct vg_slices *s,
                              int threads, struct vg_error *err)
{
  struct vg_shared_file *to;
  vg_status st = vg_slice_file_open(f, comm, &to, err);

  if (st < 0) return st;
  st = vg_slice_file_fill(f, comm, s, threads, to, err);
  return vg_shared_close(to, st, err);
}

struct vg_mesh vg_slices_frame(const struct vg_slices *s)
{
  struct vg_mesh m = *s->boundary;

  m.point = NULL;
  m.n_point = (size_t)s->n_point;
  m.n_tet = (size_t)s->n_cell[VG_SLICE_TET];
  m.n_pyr = (size_t)s->n_cell[VG_SLICE_PYR];
  m.n_pri = (size_t)s->n_cell[VG_SLICE_PRI];
  m.n_hex = (size_t)s->n_cell[VG_SLICE_HEX];
  return m;
}

static vg_status check_nodes(size_t n, int width, const uint32_t *node,
                             size_t n_point, const char *what,
                             struct vg_error *err)
{
  for (size_t i = 0; i < n * (size_t)width; i++)
    if (node[i] >= n_point)
      return vg_fail(err, VG_ERR_INPUT,
                     "boundary %s %zu of the mesh refers to point %lu, but "
                     "only the first %zu points are boundary points",
                     what, i / (size_t)width + 1, (unsigned long)node[i] + 1,
                     n_point);
  return VG_OK;
}

vg_status vg_slices_check_boundary(const struct vg_slices *s,
                                   struct vg_error *err)
{
  const struct vg_mesh *m = s->boundary;
  size_t n = (size_t)s->n_boundary_point;
  vg_status st = check_nodes(m->n_tri, 3, (const uint32_t *)m->tri, n,
                             "triangle", err);

  if (st >= 0)
    st = check_nodes(m->n_sheet_tri, 3, (const uint32_t *)m->sheet_tri, n,
                     "triangle of a sheet", err);
  return st < 0 ? st
                : check_nodes(m->n_quad, 4, (const uint32_t *)m->quad, n,
                              "quadrilateral", err);
}

void vg_slice_points(const struct vg_slice *slice, size_t k, size_t n,
                     double (*x)[3])
{
  for (size_t i = 0; i < n; i++)
    memcpy(x[i], slice->x[slice->own[k + i]], sizeof x[i]);
}

/* --- the boundary with its points --- */

vg_status vg_boundary_points_new(const struct vg_slices *s,
                                 struct vg_boundary_points *b,
                                 struct vg_error *err)
{
  b->n = (size_t)s->n_boundary_point;
  b->x = vg_alloc(b->n, sizeof *b->x);
  b->known = vg_calloc(b->n, 1);
  if (b->x && b->known) return VG_OK;
  return vg_fail_memory(err, "the points of the boundary");
}

void vg_boundary_points_release(struct vg_boundary_points *b)
{
  free(b->x);
  free(b->known);
  memset(b, 0, sizeof *b);
}

void vg_boundary_points_add(struct vg_boundary_points *b,
                            const struct vg_slice *slice)
{
  for (size_t k = 0; k < slice->n_own && slice->point_at + k < b->n; k++) {
    vg_slice_points(slice, k, 1, b->x + slice->point_at + k);
    b->known[slice->point_at + k] = 1;
  }
}

struct sent_point {
  uint64_t at;
  double x[3];
};

static vg_status pack_points(const struct vg_boundary_points *b,
                             struct vg_bytes *to, struct vg_error *err)
{
  struct sent_point *p;
  size_t n = 0;

  for (size_t i = 0; i < b->n; i++) n += b->known[i];
  p = vg_alloc(n, sizeof *p);
  if (!p) return vg_fail_memory(err, "the points of the boundary");
  to->data = (unsigned char *)p;
  to->n = n * sizeof *p;
  for (size_t i = 0; i < b->n; i++)
    if (b->known[i]) {
      p->at = i;
      memcpy((p++)->x, b->x[i], sizeof p->x);
    }
  return VG_OK;
}

static void take_points(struct vg_boundary_points *b,
                        const struct vg_bytes *from)
{
  const struct sent_point *p = (const void *)from->data;

  for (size_t i = 0; i < from->n / sizeof *p; i++) {
    memcpy(b->x[p[i].at], p[i].x, sizeof *b->x);
    b->known[p[i].at] = 1;
  }
}

vg_status vg_boundary_points_share(struct vg_comm *comm,
                                   struct vg_boundary_points *b,
                                   struct vg_error *err)
{
  size_t n = (size_t)vg_comm_size(comm);
  struct vg_bytes mine = { 0, NULL }, *all = vg_calloc(n, sizeof *all);
  vg_status st = all ? pack_points(b, &mine, err)
                     : vg_fail_memory(err, "the points of the boundary");

  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_comm_allgather(comm, &mine, all, err);
  for (size_t r = 0; r < n && st >= 0; r++) take_points(b, &all[r]);
  vg_bytes_release(all, n);
  free(mine.data);
  for (size_t i = 0; i < b->n && st >= 0; i++)
    if (!b->known[i])
      st = vg_fail(err, VG_ERR_INPUT,
                   "boundary point %zu is not in any slice of the mesh", i + 1);
  return st;
}

static vg_status add_points(void *context, const struct vg_slice *slice,
                            struct vg_error *err)
{
  (void)err;
  vg_boundary_points_add(context, slice);
  return VG_OK;
}

vg_status vg_slices_boundary(struct vg_comm *comm, const struct vg_slices *s,
                             int threads, struct vg_mesh *out,
                             struct vg_error *err)
{
  assert(out && threads >= 0);

  struct vg_boundary_points b = { 0, NULL, NULL };
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st = vg_boundary_points_new(s, &b, err);

  if (st >= 0) st = vg_slices_each(s, threads, add_points, &b, err);
  if (st >= 0) st = vg_mesh_copy(&m, s->boundary, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_boundary_points_share(comm, &b, err));
  m.n_point = b.n;
  m.point = b.x;
  b.x = NULL;
  vg_mesh_move(out, &m);
done:
  vg_mesh_release(&m);
  vg_boundary_points_release(&b);
  return st;
}

/* --- forms --- */

enum form {
  FORM_NONE,
  FORM_UGRID,
  FORM_COGSG,
  FORM_VTU,
  FORM_PVTU,
  FORM_SU2,
  FORM_GMSH,
  FORM_CGNS,
  FORM_FLUENT,
  FORM_PART,
  FORM_BOUNDARY
};

static enum form form_of(const char *word)
{
  struct vg_ugrid_kind kind;

  if (vg_ugrid_kind(word, &kind)) return kind.is_text ? FORM_NONE : FORM_UGRID;
  if (!strcmp(word, "cogsg")) return FORM_COGSG;
  if (!strcmp(word, "vtu")) return FORM_VTU;
  if (!strcmp(word, "pvtu")) return FORM_PVTU;
  if (!strcmp(word, "su2")) return FORM_SU2;
  if (!strncmp(word, "part.", 5)) return FORM_PART;
  if (!strcmp(word, "msh")) return FORM_GMSH;
  if (!strcmp(word, "cgns")) return FORM_CGNS;
  if (!strcmp(word, VG_FLUENT_SUFFIX)) return FORM_FLUENT;
  if (!strcmp(word, "mapbc") || !strcmp(word, "fun3d.mapbc") ||
      !strcmp(word, "surface.vtu"))
    return FORM_BOUNDARY;
  return FORM_NONE;
}

int vg_slices_can_write(const char *form)
{
  return form_of(form) != FORM_NONE;
}

/* Write a form that shows only the boundary: on rank 0, with the writers of
 * whole meshes. */
static vg_status write_boundary(struct vg_comm *comm, const struct vg_slices *s,
                                const char *path, const char *stem,
                                const char *form, int threads,
                                struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st = vg_slices_boundary(comm, s, threads, &m, err);

  if (st < 0) return st;
  if (vg_comm_rank(comm)) st = VG_OK;
  else if (!strcmp(form, "mapbc"))
    st = vg_cogsg_write_mapbc(stem, &m, NULL, err);
  else if (!strcmp(form, "fun3d.mapbc"))
    st = vg_mapbc_write(path, &m, VG_MAPBC_FUN3D, NULL, NULL, err);
  else st = vg_vtu_write_boundary(path, &m, NULL, 0, err);
  vg_mesh_release(&m);
  return vg_comm_agree(comm, st, err);
}

static vg_status write_ugrid(struct vg_comm *comm, const struct vg_slices *s,
                             const char *path,
                             const struct vg_slices_options *o,
                             struct vg_error *err)
{
  struct vg_slices_ugrid *u = NULL;
  vg_status st = vg_slices_ugrid_open(comm, s, path, o, &u, err);

  if (st < 0) return st;
  st = vg_slices_each(s, o->threads, vg_slices_ugrid_put, u, err);
  return vg_slices_ugrid_close(u, st, err);
}

vg_status vg_slices_write_with(struct vg_comm *comm, const struct vg_slices *s,
                               const char *stem, const char *form,
                               const struct vg_slices_options *o,
                               struct vg_error *err)
{
  char *path;
  vg_status st = VG_OK;

  assert(s && stem && form && o && o->threads >= 0);
  if (asprintf(&path, "%s.%s", stem, form) < 0) {
    path = NULL;
    st = vg_fail_memory(err, "the output paths");
  }
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) switch (form_of(form)) {
    case FORM_UGRID: st = write_ugrid(comm, s, path, o, err); break;
    case FORM_COGSG: st = vg_slices_write_cogsg(comm, s, stem, o, err); break;
    case FORM_VTU: st = vg_slices_write_vtu(comm, s, path, o, err); break;
    case FORM_PVTU: st = vg_slices_write_pvtu(comm, s, stem, o, err); break;
    case FORM_SU2:
      st = vg_slices_write_su2(comm, s, path, o->threads, err);
      break;
    case FORM_PART:
      st = vg_slices_write_part(comm, s, path, o->threads, err);
      break;
    case FORM_GMSH: st = vg_slices_write_gmsh(comm, s, path, o, err); break;
    case FORM_CGNS: st = vg_slices_write_cgns(comm, s, path, o, err); break;
    case FORM_FLUENT: st = vg_slices_write_fluent(comm, s, path, o, err); break;
    case FORM_BOUNDARY:
      st = write_boundary(comm, s, path, stem, form, o->threads, err);
      break;
    default:
      st = vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: a distributed mesh cannot be written in this form; "
                   "possible forms are cgns, cogsg, fluent.msh, msh, pvtu, "
                   "su2, vtu and the binary kinds of .ugrid, such as "
                   "lb8.ugrid",
                   path);
    }
  free(path);
  return st;
}

vg_status vg_slices_write(struct vg_comm *comm, const struct vg_slices *s,
                          const char *stem, const char *form, int threads,
                          struct vg_error *err)
{
  struct vg_slices_options o = VG_SLICES_OPTIONS_INIT;

  assert(s && stem && form && threads >= 0);
  o.threads = threads;
  return vg_slices_write_with(comm, s, stem, form, &o, err);
}
