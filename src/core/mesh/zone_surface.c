/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/zone_surface.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/cell_links.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"

/* A triangle between two zones. */
struct face {
  uint64_t group; /* sheet, or after them the pair of zones */
  uint32_t node[3];
};

struct faces {
  const struct vg_mesh *m;
  struct vg_cell_links links;
  struct vg_sheet_table sheets;
  uint32_t *zone;    /* [links.n_cell] */
  struct face *face; /* [n], NULL: they are counted */
  size_t n, n_patch;
  int32_t last; /* highest number of a patch */
};

static vg_status find_zones(struct faces *f, struct vg_error *err)
{
  const struct vg_mesh *m = f->m;
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  uint32_t *to = f->zone = vg_alloc(f->links.n_cell, sizeof *to);

  if (!to) return vg_fail_memory(err, "the zones");
  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    size_t z = 0;
    uint64_t end = 0;

    for (size_t c = 0; c < n[k]; c++) {
      vg_mesh_zone_walk(m, k, c, &z, &end);
      *to++ = (uint32_t)z;
    }
  }
  return VG_OK;
}

static void take(struct faces *f, const uint32_t *node, int a, int b, int c,
                 uint32_t low, uint32_t high)
{
  const uint32_t v[3] = { node[a], node[b], node[c] };
  int is_same;
  const uint32_t t = vg_sheet_table_find(&f->sheets, v, &is_same);
  const uint64_t n_zone = f->m->n_zone;
  const int has_name = t != UINT32_MAX && *f->m->sheet[f->m->sheet_of[t]].name;

  if (f->face)
    f->face[f->n] = (struct face){ has_name
                                     ? f->m->sheet_of[t]
                                     : f->m->n_sheet + low * n_zone + high,
                                   { v[0], v[1], v[2] } };
  f->n++;
}

/* Faces of cells, seen from the lower zone. */
static void take_all(struct faces *f)
{
  f->n = 0;
  for (uint32_t cell = 0; cell < f->links.n_cell; cell++)
    for (int i = 0; i < vg_half_faces(&f->links, cell); i++) {
      const uint32_t code = cell << 3 | (uint32_t)i,
                     mate = vg_mate(&f->links, code);
      uint32_t node[4], low = f->zone[cell], high;

      if (mate == VG_NO_CELL) continue;
      high = f->zone[mate >> 3];
      if (low >= high) continue;
      if (vg_half_face_nodes(&f->links, code, node) == 4)
        take(f, node, 0, 2, 3, low, high);
      take(f, node, 0, 1, 2, low, high);
    }
}

static int by_group(const void *a, const void *b)
{
  const struct face *p = a, *q = b;

  if (p->group != q->group) return p->group < q->group ? -1 : 1;
  return memcmp(p->node, q->node, sizeof p->node);
}

static vg_status count_patches(struct faces *f, struct vg_error *err)
{
  const struct vg_mesh *m = f->m;

  for (size_t i = 0; i < f->n; i++)
    f->n_patch += !i || f->face[i].group != f->face[i - 1].group;
  f->last = vg_mesh_last_id(m);
  if (f->n_patch <= (size_t)(INT32_MAX - f->last)) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "no numbers are left for the interfaces of zones; renumber "
                 "the patches");
}

static struct vg_patch make_patch(struct faces *f, uint64_t group)
{
  const struct vg_mesh *m = f->m;
  struct vg_patch p = { .bc = VG_BC_NONE, .bc_fun3d = VG_BC_NONE };

  if (group < m->n_sheet) p = m->sheet[group];
  if (group >= m->n_sheet || vg_mesh_find_patch(m, p.id) != SIZE_MAX)
    p.id = ++f->last;
  p.is_sheet = p.is_split = 0;
  p.inner = VG_INNER_NOT;
  p.is_interface = 1;
  if (group >= m->n_sheet) {
    char a[VG_NAME_MAX], b[VG_NAME_MAX];

    group -= m->n_sheet;
    vg_zone_name(&m->zone[group / m->n_zone], a);
    vg_zone_name(&m->zone[group % m->n_zone], b);
    snprintf(p.name, sizeof p.name, "%.37s_to_%.37s", a, b);
  }
  return p;
}

static vg_status append(struct faces *f, struct vg_mesh *m,
                        struct vg_error *err)
{
  size_t cap[3] = { m->n_tri, m->n_tri, m->n_patch };

  if (vg_reserve(&m->tri, &cap[0], m->n_tri + f->n, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &cap[1], m->n_tri + f->n,
                 sizeof *m->tri_patch) ||
      vg_reserve(&m->patch, &cap[2], m->n_patch + f->n_patch, sizeof *m->patch))
    return vg_fail_memory(err, "the interfaces of zones");
  for (size_t i = 0; i < f->n; i++) {
    if (!i || f->face[i].group != f->face[i - 1].group) {
      const struct vg_patch p = make_patch(f, f->face[i].group);

      m->patch[m->n_patch++] = p;
    }
    memcpy(m->tri[m->n_tri], f->face[i].node, sizeof *m->tri);
    m->tri_patch[m->n_tri++] = (uint32_t)m->n_patch - 1;
  }
  return VG_OK;
}

vg_status vg_mesh_add_interfaces(struct vg_mesh *m, const char *name,
                                 struct vg_error *err)
{
  struct faces f = { .m = m,
                     .links = VG_CELL_LINKS_INIT,
                     .sheets = VG_SHEET_TABLE_INIT };
  vg_status st;

  assert(m->n_zone && name);
  VG_TRY(vg_cell_links_build(&f.links, m, 0, name, err));
  VG_TRY(vg_sheet_table_new(&f.sheets, m, err));
  VG_TRY(find_zones(&f, err));
  take_all(&f);
  f.face = vg_alloc(f.n, sizeof *f.face);
  if (!f.face) VG_TRY(vg_fail_memory(err, "the interfaces of zones"));
  take_all(&f);
  if (f.n) qsort(f.face, f.n, sizeof *f.face, by_group);
  VG_TRY(count_patches(&f, err));
  st = append(&f, m, err);
done:
  vg_cell_links_release(&f.links);
  vg_sheet_table_release(&f.sheets);
  free(f.zone);
  free(f.face);
  return st;
}

/* Six times the volume of a cell, about its centre. */
static double volume(const struct vg_mesh *m, int kind, const uint32_t *node,
                     double centre[3])
{
  const int width = vg_cell_faces[kind].width;
  double sum = 0;

  memset(centre, 0, 3 * sizeof *centre);
  for (int k = 0; k < width; k++)
    for (int d = 0; d < 3; d++) centre[d] += m->point[node[k]][d] / width;
  for (int f = 0; f < vg_cell_faces[kind].n_face; f++) {
    const unsigned char *v = vg_cell_faces[kind].face[f];

    for (int k = 1; k < (v[2] == v[3] ? 2 : 3); k++) {
      const double *p[3] = { m->point[node[v[0]]], m->point[node[v[k]]],
                             m->point[node[v[k + 1]]] };
      double e[3][3];

      for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) e[i][d] = p[i][d] - centre[d];
      for (int d = 0; d < 3; d++)
        sum -= e[0][d] * (e[1][(d + 1) % 3] * e[2][(d + 2) % 3] -
                          e[1][(d + 2) % 3] * e[2][(d + 1) % 3]);
    }
  }
  return sum;
}

void vg_mesh_zone_seed(const struct vg_mesh *m, size_t z, double seed[3])
{
  double most = -INFINITY, centre[3];

  assert(z < m->n_zone && vg_mesh_zone_cells(m, z));
  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    const uint32_t *node = vg_mesh_nodes(m, k);
    const size_t w = (size_t)vg_cell_faces[k].width;
    const uint64_t first = vg_mesh_zone_start(m, z, k);

    for (uint64_t c = first; c < first + m->zone[z].n_cell[k]; c++) {
      const double v = volume(m, k, node + w * c, centre);

      if (v <= most) continue;
      most = v;
      memcpy(seed, centre, sizeof centre);
    }
  }
}
