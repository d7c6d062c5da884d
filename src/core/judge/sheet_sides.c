/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/judge/sheet_sides.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/sheets.h"

struct vg_sheet_sides {
  const struct vg_mesh *m; /* borrowed */
  struct vg_sheet_table table;
  _Atomic uint32_t (*cell)[2]; /* [n_sheet_tri] cells on each side */
};

/* A triangle that occurs twice is found once, so that the other one is bad. */
vg_status vg_sheet_sides_new(const struct vg_mesh *m,
                             struct vg_sheet_sides **out, struct vg_error *err)
{
  struct vg_sheet_sides *q;
  vg_status st;

  assert(m && out);
  *out = NULL;
  if (!m->n_sheet_tri) return VG_OK;
  q = vg_calloc(1, sizeof *q);
  if (!q) return vg_fail_memory(err, "the sheets");
  q->m = m;
  st = vg_sheet_table_new(&q->table, m, err);
  q->cell = vg_calloc(m->n_sheet_tri, sizeof *q->cell);
  if (st >= 0 && !q->cell) st = vg_fail_memory(err, "the sheets");
  if (st < 0) vg_sheet_sides_free(q);
  else *out = q;
  return st;
}

/* v: points of the face, with the normal into the cell. */
static void meet(struct vg_sheet_sides *q, const uint32_t v[3])
{
  int is_same;
  const uint32_t t = vg_sheet_table_find(&q->table, v, &is_same);

  if (t != UINT32_MAX) atomic_fetch_add(&q->cell[t][!is_same], 1);
}

void vg_sheet_sides_add(struct vg_sheet_sides *q, const struct vg_slice *slice)
{
  if (!q) return;
  for (int kind = 0; kind < VG_SLICE_KINDS; kind++)
    for (size_t c = 0; c < slice->n_cell[kind]; c++) {
      const uint32_t *w = slice->cell[kind] + c * vg_slice_width[kind];
      uint32_t id[8];
      int n = 0;

      for (int k = 0; k < vg_slice_width[kind]; k++) {
        id[k] = slice->id[w[k]];
        n += vg_sheet_table_on(&q->table, id[k]);
      }
      for (int f = 0; n > 2 && f < vg_cell_faces[kind].n_face; f++) {
        const unsigned char *face = vg_cell_faces[kind].face[f];
        const uint32_t v[3] = { id[face[0]], id[face[1]], id[face[2]] };

        if (face[2] == face[3]) meet(q, v);
      }
    }
}

vg_status vg_sheet_sides_sum(struct vg_comm *comm,
                             const struct vg_sheet_sides *q,
                             struct vg_sheet_report *report,
                             struct vg_error *err)
{
  const size_t n = q ? q->m->n_sheet_tri : 0;
  uint64_t(*sum)[2] = vg_alloc(n, sizeof *sum);
  vg_status st = sum ? VG_OK : vg_fail_memory(err, "the sheets");

  VG_TRY(vg_comm_agree(comm, st, err));
  for (size_t i = 0; i < 2 * n; i++) sum[i / 2][i % 2] = q->cell[i / 2][i % 2];
  VG_TRY(vg_comm_sum(comm, 2 * n, (uint64_t *)sum, err));
  if (q) memset(report, 0, q->m->n_sheet * sizeof *report);
  for (size_t t = 0; t < n; t++) {
    struct vg_sheet_report *r = &report[q->m->sheet_of[t]];

    r->n_tri++;
    for (int k = 0; k < 2; k++) r->n_cell[k] += sum[t][k];
    r->n_bad += sum[t][0] != 1 || sum[t][1] != 1;
  }
done:
  free(sum);
  return st;
}

vg_status vg_sheet_sides_judge(const struct vg_mesh *m,
                               struct vg_sheet_report **report,
                               struct vg_error *err)
{
  struct vg_slice s = {
    .n_cell = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex },
    .cell = { (const uint32_t *)m->tet, (const uint32_t *)m->pyr,
              (const uint32_t *)m->pri, (const uint32_t *)m->hex }
  };
  struct vg_sheet_report *r = NULL;
  struct vg_sheet_sides *q = NULL;
  uint32_t *id = NULL;
  vg_status st = VG_OK;

  *report = NULL;
  if (!m->n_sheet) return VG_OK;
  id = vg_alloc(m->n_point, sizeof *id);
  r = vg_calloc(m->n_sheet, sizeof *r);
  if (!id || !r) VG_TRY(vg_fail_memory(err, "the sheets"));
  for (size_t p = 0; p < m->n_point; p++) id[p] = (uint32_t)p;
  s.id = id;
  VG_TRY(vg_sheet_sides_new(m, &q, err));
  vg_sheet_sides_add(q, &s);
  VG_TRY(vg_sheet_sides_sum(NULL, q, r, err));
  for (size_t i = 0; i < m->n_sheet; i++) r[i].area = vg_mesh_sheet_area(m, i);
  *report = r;
  r = NULL;
done:
  vg_sheet_sides_free(q);
  free(r);
  free(id);
  return st;
}

void vg_sheet_sides_free(struct vg_sheet_sides *q)
{
  if (!q) return;
  vg_sheet_table_release(&q->table);
  free(q->cell);
  free(q);
}
