/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Faces between cells of different zones that are in no interface. Only faces
 * of which all points are in several zones are compared. Declared in
 * core/judge/zone_quality.h. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/judge/zone_quality.h"
#include "core/mesh/cell_faces.h"

enum { NO_ZONE = UINT32_MAX, SEVERAL = UINT32_MAX - 1 };

/* A face of a cell, or with the zone NO_ZONE a triangle of an interface. */
struct face {
  uint32_t node[3]; /* its lowest ones, ascending */
  uint32_t zone;
};

/* Two zones that meet in a face. */
struct meeting {
  uint32_t zone[2]; /* ascending */
  uint32_t is_free; /* 1: the face is in no interface */
  uint32_t node[3];
};

struct work {
  const struct vg_mesh *m;
  uint32_t *in; /* [n_point] zone of each point */
  struct face *face;
  size_t n, cap;
  int is_bad; /* memory */
};

static void put_face(struct work *w, const uint32_t node[4], uint32_t zone)
{
  struct face f = { .zone = zone };
  uint32_t v[4];

  memcpy(v, node, sizeof v);
  if (v[2] == v[3]) vg_order3(v);
  else vg_order4(v);
  memcpy(f.node, v, sizeof f.node);
  if (vg_reserve(&w->face, &w->cap, w->n + 1, sizeof f)) w->is_bad = 1;
  else w->face[w->n++] = f;
}

static void mark(struct work *w, const uint32_t *cell, int kind, uint32_t zone)
{
  for (int k = 0; k < vg_cell_faces[kind].width; k++) {
    uint32_t *in = &w->in[cell[k]];

    if (*in == NO_ZONE) *in = zone;
    else if (*in != zone) *in = SEVERAL;
  }
}

static void put_faces(struct work *w, const uint32_t *cell, int kind,
                      uint32_t zone)
{
  for (int f = 0; f < vg_cell_faces[kind].n_face && !w->is_bad; f++) {
    uint32_t node[4];
    int n = 0;

    for (int k = 0; k < 4; k++) {
      node[k] = cell[vg_cell_faces[kind].face[f][k]];
      n += w->in[node[k]] == SEVERAL;
    }
    if (n == 4) put_face(w, node, zone);
  }
}

static void each_cell(struct work *w,
                      void (*visit)(struct work *w, const uint32_t *cell,
                                    int kind, uint32_t zone))
{
  const struct vg_mesh *m = w->m;
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };

  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    const uint32_t *node = vg_mesh_nodes(m, k);
    const size_t width = (size_t)vg_cell_faces[k].width;
    uint64_t end = 0;
    size_t zone = 0;

    for (size_t c = 0; c < n[k] && !w->is_bad; c++) {
      vg_mesh_zone_walk(m, k, c, &zone, &end);
      visit(w, node + c * width, k, (uint32_t)zone);
    }
  }
}

/* Interfaces come last among equal faces. */
static int by_node(const void *a, const void *b)
{
  const struct face *p = a, *q = b;

  for (int k = 0; k < 3; k++)
    if (p->node[k] != q->node[k]) return p->node[k] < q->node[k] ? -1 : 1;
  return p->zone < q->zone ? -1 : p->zone > q->zone;
}

/* Those of interfaces come first. */
static int by_zone(const void *a, const void *b)
{
  const struct meeting *p = a, *q = b;

  for (int k = 0; k < 2; k++)
    if (p->zone[k] != q->zone[k]) return p->zone[k] < q->zone[k] ? -1 : 1;
  if (p->is_free != q->is_free) return p->is_free < q->is_free ? -1 : 1;
  return memcmp(p->node, q->node, sizeof p->node);
}

/* to: [w->n]; returns their number. */
static size_t find_meetings(struct work *w, struct meeting *to)
{
  size_t n = 0;

  if (w->n) qsort(w->face, w->n, sizeof *w->face, by_node);
  for (size_t i = 0; i + 1 < w->n; i++) {
    const struct face *f = w->face + i, *last = f + 1;

    if (memcmp(f->node, f[1].node, sizeof f->node) || f->zone == f[1].zone ||
        f[1].zone == NO_ZONE)
      continue;
    if (i + 2 < w->n && !memcmp(f->node, f[2].node, sizeof f->node)) last++;
    to[n] = (struct meeting){ .zone = { f->zone, f[1].zone },
                              .is_free = last->zone != NO_ZONE };
    memcpy(to[n++].node, f->node, sizeof f->node);
  }
  if (n) qsort(to, n, sizeof *to, by_zone);
  return n;
}

static void count_free(const struct vg_mesh *m, const struct meeting *list,
                       size_t n_list, size_t *n, double x[3])
{
  int has_interface = 0;

  for (size_t i = 0; i < n_list; i++) {
    const struct meeting *a = &list[i];

    if (!i || memcmp(a->zone, a[-1].zone, sizeof a->zone)) has_interface = 0;
    if (!a->is_free) has_interface = 1;
    if (!a->is_free || !has_interface) continue;
    for (int d = 0; d < 3 && !*n; d++)
      x[d] = (m->point[a->node[0]][d] + m->point[a->node[1]][d] +
              m->point[a->node[2]][d]) /
             3;
    ++*n;
  }
}

vg_status vg_zone_faces_judge(const struct vg_mesh *m, size_t *n, double x[3],
                              struct vg_error *err)
{
  struct work w = { .m = m };
  struct meeting *list = NULL;
  vg_status st = VG_OK;

  *n = 0;
  if (!m->n_zone) return VG_OK;
  w.in = vg_alloc(m->n_point, sizeof *w.in);
  if (!w.in) return vg_fail_memory(err, "the zones");
  memset(w.in, 0xff, m->n_point * sizeof *w.in);
  each_cell(&w, mark);
  each_cell(&w, put_faces);
  for (size_t t = 0; t < m->n_sheet_tri && !w.is_bad; t++) {
    const uint32_t *v = m->sheet_tri[t];

    if (m->sheet[m->sheet_of[t]].is_interface)
      put_face(&w, (const uint32_t[4]){ v[0], v[1], v[2], v[2] }, NO_ZONE);
  }
  if (!w.is_bad) list = vg_alloc(w.n, sizeof *list);
  if (list) count_free(m, list, find_meetings(&w, list), n, x);
  else st = vg_fail_memory(err, "the zones");
  free(list);
  free(w.face);
  free(w.in);
  return st;
}
