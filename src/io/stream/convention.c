/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Orientation, index base and patches of meshes read from files. */
#include "io/stream/convention.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "core/geometry/predicates.h"
#include "core/geometry/volume.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"

static int is_in_range(double x)
{
  double size = fabs(x);

  return size <= VG_COORDINATE_MAX && (size >= VG_COORDINATE_MIN || size == 0);
}

static vg_status out_of_range(const char *path, size_t i, int k,
                              const double p[3], struct vg_error *err)
{
  const double x = p[k];

  if (!isfinite(x))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: coordinate %c of point %zu is not a finite "
                   "number (%g); correct the file or check its byte order",
                   path, "xyz"[k], i + 1, x);
  if (fabs(x) > VG_COORDINATE_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: coordinate %c of point %zu (%g %g %g) is beyond %g; "
                   "check the byte order or use another unit of length",
                   path, "xyz"[k], i + 1, p[0], p[1], p[2], VG_COORDINATE_MAX);
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: coordinate %c of point %zu (%g %g %g) is not 0, but "
                 "smaller than %g, and volumes would not be exact; check the "
                 "byte order, replace it by 0 or use another unit of length",
                 path, "xyz"[k], i + 1, p[0], p[1], p[2], VG_COORDINATE_MIN);
}

vg_status vg_check_points(const char *path, size_t n, const double (*p)[3],
                          struct vg_error *err)
{
  assert(path && (p || !n));
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (!is_in_range(p[i][k])) return out_of_range(path, i, k, p[i], err);
  return VG_OK;
}

vg_status vg_index_from_file(const char *path, const char *element, size_t n,
                             int width, size_t n_point, uint32_t *index,
                             struct vg_error *err)
{
  size_t count = n * (size_t)width;
  uint32_t limit = n_point < UINT32_MAX ? (uint32_t)n_point : UINT32_MAX;
  uint32_t bad = 0;

  assert(path && element && width > 0 && (index || !n));
  for (size_t i = 0; i < count; i++) {
    index[i] -= 1;
    bad |= index[i] >= limit;
  }
  if (!bad) return VG_OK;
  for (size_t i = 0; i < count; i++)
    if (index[i] >= limit)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: %s %zu refers to point %lld; points are numbered "
                     "1 to %zu",
                     path, element, i / (size_t)width + 1,
                     (long long)(int32_t)(index[i] + 1), n_point);
  return VG_OK;
}

/* --- patches --- */

struct tags {
  struct vg_table table;
  size_t n, cap;
  int32_t *id; /* [n] in the order of their first appearance */
};

static uint64_t hash_tag(const void *of, uint32_t i)
{
  const struct tags *t = of;

  return vg_hash_1((uint32_t)t->id[i]);
}

/* Index of a tag, which is added if it is new; -1 if there is not enough
 * memory. */
static int64_t tag_index(struct tags *t, int32_t id)
{
  uint32_t *at;

  if (vg_table_reserve(&t->table, t->n + 1, hash_tag, t) ||
      vg_reserve(&t->id, &t->cap, t->n + 1, sizeof *t->id))
    return -1;
  VG_TABLE_FIND(&t->table, at, vg_hash_1((uint32_t)id), t->id[*at] == id);
  if (*at == VG_TABLE_FREE) {
    *at = (uint32_t)t->n;
    t->id[t->n++] = id;
  }
  return *at;
}

static int compare_patch(const void *a, const void *b)
{
  const struct vg_patch *p = a, *q = b;

  return (p->id > q->id) - (p->id < q->id);
}

/* Create the patches in ascending order of their ids; rank[i] is the patch of
 * the i-th tag found. */
static vg_status make_patches(struct vg_mesh *m, const struct tags *t,
                              uint32_t *rank, struct vg_error *err)
{
  struct vg_patch *patch = vg_calloc(t->n, sizeof *patch);

  if (!patch) return vg_fail_memory(err, "the patches");
  for (size_t i = 0; i < t->n; i++) {
    patch[i].id = t->id[i];
    patch[i].bc = (int32_t)i;
  }
  qsort(patch, t->n, sizeof *patch, compare_patch);
  for (size_t i = 0; i < t->n; i++) {
    rank[patch[i].bc] = (uint32_t)i;
    patch[i].bc = patch[i].bc_fun3d = patch[i].family = VG_BC_NONE;
  }
  free(m->patch);
  m->patch = patch;
  m->n_patch = t->n;
  return VG_OK;
}

vg_status vg_patches_from_tags(struct vg_mesh *m, const int32_t *tag,
                               struct vg_error *err)
{
  assert(tag || !(m->n_tri + m->n_quad));

  struct tags t = { 0 };
  size_t n = m->n_tri + m->n_quad;
  uint32_t *of = vg_alloc(n, sizeof *of), *rank = NULL;
  uint32_t *tri = vg_alloc(m->n_tri, sizeof *tri);
  uint32_t *quad = vg_alloc(m->n_quad, sizeof *quad);
  vg_status st = VG_OK;
  int64_t last = -1;

  if (!of || !tri || !quad) goto refused;
  for (size_t i = 0; i < n; i++) {
    if (last < 0 || t.id[last] != tag[i]) last = tag_index(&t, tag[i]);
    if (last < 0) goto refused;
    of[i] = (uint32_t)last;
  }
  rank = vg_alloc(t.n, sizeof *rank);
  if (!rank) goto refused;
  VG_TRY(make_patches(m, &t, rank, err));
  for (size_t i = 0; i < m->n_tri; i++) tri[i] = rank[of[i]];
  for (size_t i = 0; i < m->n_quad; i++) quad[i] = rank[of[m->n_tri + i]];
  free(m->tri_patch);
  free(m->quad_patch);
  m->tri_patch = tri;
  m->quad_patch = quad;
  tri = quad = NULL;
  goto done;
refused:
  st = vg_fail_memory(err, "the patches of the boundary faces");
done:
  free(of);
  free(rank);
  free(tri);
  free(quad);
  vg_table_release(&t.table);
  free(t.id);
  return st;
}

/* --- orientation --- */

/* Six times the volume, computed from the inward faces as seen from node 0.
 * Each quadrilateral counts as the mean of its two triangulations. */
static double volume6(const struct vg_mesh *m, const uint32_t *c,
                      const unsigned char (*face)[4], int n_face)
{
  const double *o = m->point[c[0]], *p[4];
  double volume = 0;

  for (int f = 0; f < n_face; f++) {
    const unsigned char *q = face[f];

    for (int k = 0; k < 4; k++) p[k] = m->point[c[q[k]]];
    volume -= q[2] == q[3] ? vg_tri_cone(o, p[0], p[1], p[2])
                           : vg_quad_cone(o, p[0], p[1], p[2], p[3]);
  }
  return volume;
}

static void swap(uint32_t *c, int a, int b)
{
  uint32_t t = c[a];

  c[a] = c[b];
  c[b] = t;
}

size_t vg_mesh_turn_cells(struct vg_mesh *m)
{
  assert(m);

  size_t n = 0;

  for (size_t i = 0; i < m->n_tet; i++) {
    uint32_t *c = m->tet[i];

    if (vg_orient3d(m->point[c[0]], m->point[c[1]], m->point[c[2]],
                    m->point[c[3]]) < 0) {
      swap(c, 1, 2);
      n++;
    }
  }
  for (size_t i = 0; i < m->n_pyr; i++)
    if (volume6(m, m->pyr[i], vg_pyr_face, 5) < 0) {
      swap(m->pyr[i], 1, 3);
      n++;
    }
  for (size_t i = 0; i < m->n_pri; i++)
    if (volume6(m, m->pri[i], vg_pri_face, 5) < 0) {
      swap(m->pri[i], 1, 2);
      swap(m->pri[i], 4, 5);
      n++;
    }
  for (size_t i = 0; i < m->n_hex; i++)
    if (volume6(m, m->hex[i], vg_hex_face, 6) < 0) {
      swap(m->hex[i], 1, 3);
      swap(m->hex[i], 5, 7);
      n++;
    }
  return n;
}

/* Boundary faces found by their sorted nodes; the last node of a triangle is
 * UINT32_MAX. Of several faces with the same nodes the first is kept. */
struct face_table {
  struct vg_table table;
  unsigned char *found; /* [n_tri + n_quad] sides with cells */
  size_t n_on;
  unsigned char *on; /* [n_on] is the point on the boundary? Points from n_on on
                        are not. */
};

static void make_key(const uint32_t *n, int width, uint32_t key[4])
{
  memcpy(key, n, (size_t)width * sizeof *key);
  if (width == 3) key[3] = UINT32_MAX;
  vg_order4(key);
}

static const uint32_t *face_nodes(const struct vg_mesh *m, size_t f, int *width)
{
  *width = f < m->n_tri ? 3 : 4;
  return f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri];
}

static int has_key(const struct vg_mesh *m, size_t f, const uint32_t key[4])
{
  uint32_t other[4];
  int width;
  const uint32_t *node = face_nodes(m, f, &width);

  make_key(node, width, other);
  return !memcmp(key, other, sizeof other);
}

/* Entry of the boundary face with these nodes, or the free slot for it. */
static uint32_t *find_face(const struct vg_mesh *m, const struct face_table *t,
                           const uint32_t *node, int width)
{
  uint32_t key[4], *at;

  make_key(node, width, key);
  VG_TABLE_FIND(&t->table, at,
                vg_hash_3((uint64_t)key[0] << 32 | key[1], key[2], key[3]),
                has_key(m, *at, key));
  return at;
}

static void face_release(struct face_table *t)
{
  vg_table_release(&t->table);
  free(t->found);
  free(t->on);
}

size_t vg_mesh_boundary_end(const struct vg_mesh *m)
{
  const uint32_t *tri = (const uint32_t *)m->tri;
  const uint32_t *quad = (const uint32_t *)m->quad;
  size_t end = 0;

  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (tri[i] >= end) end = (size_t)tri[i] + 1;
  for (size_t i = 0; i < 4 * m->n_quad; i++)
    if (quad[i] >= end) end = (size_t)quad[i] + 1;
  return end;
}

static int is_on(const struct face_table *t, uint32_t point)
{
  return point < t->n_on && t->on[point];
}

static vg_status face_build(struct face_table *t, const struct vg_mesh *m,
                            struct vg_error *err)
{
  size_t n = m->n_tri + m->n_quad;
  int bad = vg_table_init(&t->table, n);

  t->found = vg_calloc(n, 1);
  t->n_on = vg_mesh_boundary_end(m);
  t->on = vg_calloc(t->n_on, 1);
  if (bad || !t->found || !t->on) {
    face_release(t);
    return vg_fail_memory(err, "a table of the boundary faces");
  }
  for (size_t f = 0; f < n; f++) {
    int width;
    const uint32_t *node = face_nodes(m, f, &width);
    uint32_t *at = find_face(m, t, node, width);

    for (int k = 0; k < width; k++) t->on[node[k]] = 1;
    if (*at == VG_TABLE_FREE) *at = (uint32_t)f;
  }
  return VG_OK;
}

/* Do the cycles a and b of w nodes have the same edges when b is traversed
 * forwards (step 1) or backwards (step w - 1)? */
static int same_cycle(const uint32_t *a, const uint32_t *b, int w, int step)
{
  for (int i = 0; i < w; i++) {
    int k = 0;

    while (k < w && a[k] == b[(i + k * step) % w]) k++;
    if (k == w) return 1;
  }
  return 0;
}

enum { SIDE_FRONT = 1, SIDE_BACK = 2, SIDE_BOTH = 3 };

/* Record on which sides of a boundary face there are cells, given a face of a
 * cell, listed inward. A quadrilateral that visits the same nodes in another
 * cyclic order is a different face. */
static void note_side(struct vg_mesh *m, struct face_table *t,
                      const uint32_t *inward, int width)
{
  uint32_t f = *find_face(m, t, inward, width);
  const uint32_t *node;
  int w;

  if (f == VG_TABLE_FREE) return;
  node = face_nodes(m, f, &w);
  if (same_cycle(node, inward, w, 1)) t->found[f] |= SIDE_FRONT;
  else if (same_cycle(node, inward, w, w - 1)) t->found[f] |= SIDE_BACK;
}

static void meet_cells(struct vg_mesh *m, struct face_table *t, size_t n,
                       const uint32_t *cell, int width,
                       const unsigned char (*face)[4], int n_face)
{
  for (size_t i = 0; i < n; i++) {
    const uint32_t *c = cell + i * (size_t)width;
    int on = 0;

    for (int k = 0; k < width; k++) on += is_on(t, c[k]);
    if (on < 3) continue;
    for (int f = 0; f < n_face; f++) {
      int w = face[f][2] == face[f][3] ? 3 : 4, all = 1;
      uint32_t node[4];

      for (int k = 0; k < w; k++) {
        node[k] = c[face[f][k]];
        all &= is_on(t, node[k]);
      }
      if (all) note_side(m, t, node, w);
    }
  }
}

static void meet_all(struct vg_mesh *m, struct face_table *t)
{
  meet_cells(m, t, m->n_tet, (const uint32_t *)m->tet, 4, vg_tet_face, 4);
  meet_cells(m, t, m->n_pyr, (const uint32_t *)m->pyr, 5, vg_pyr_face, 5);
  meet_cells(m, t, m->n_pri, (const uint32_t *)m->pri, 6, vg_pri_face, 5);
  meet_cells(m, t, m->n_hex, (const uint32_t *)m->hex, 8, vg_hex_face, 6);
}

/* Turns the faces that have a cell on their back only; returns their number.
 * Faces between two cells keep their direction. */
static size_t turn_faces(struct vg_mesh *m, const unsigned char *found)
{
  size_t n = 0;

  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    int width;
    uint32_t *node = (uint32_t *)face_nodes(m, f, &width);

    if (found[f] != SIDE_BACK) continue;
    swap(node, 1, width - 1);
    n++;
  }
  return n;
}

vg_status vg_mesh_turn(struct vg_mesh *m, struct vg_turned *turned,
                       struct vg_error *err)
{
  struct vg_turned result = { 0, 0, 0 };
  struct face_table t = { .n_on = 0 };
  vg_status st;

  assert(m);
  if (vg_mesh_n_cell(m)) {
    st = face_build(&t, m, err);
    if (st < 0) return st;
    result.cell = vg_mesh_turn_cells(m);
    meet_all(m, &t);
    result.face = turn_faces(m, t.found);
    for (size_t f = 0; f < m->n_tri + m->n_quad; f++)
      result.loose_face += !t.found[f];
    face_release(&t);
  }
  if (turned) *turned = result;
  return VG_OK;
}

/* --- sides of boundary faces, from parts of the cells --- */

struct vg_face_sides {
  struct face_table table;
  struct vg_mesh boundary; /* Borrowed faces, no cells. */
};

vg_status vg_face_sides_new(const struct vg_mesh *m, struct vg_face_sides **out,
                            struct vg_error *err)
{
  struct vg_face_sides *t = vg_calloc(1, sizeof *t);
  vg_status st;

  assert(m && out);
  if (!t) return vg_fail_memory(err, "a table of the boundary faces");
  t->boundary = (struct vg_mesh){
    .n_tri = m->n_tri, .tri = m->tri, .n_quad = m->n_quad, .quad = m->quad
  };
  st = face_build(&t->table, &t->boundary, err);
  if (st < 0) free(t);
  else *out = t;
  return st;
}

void vg_face_sides_meet(struct vg_face_sides *t, const struct vg_mesh *part)
{
  struct vg_mesh m = *part;

  m.n_tri = t->boundary.n_tri;
  m.tri = t->boundary.tri;
  m.n_quad = t->boundary.n_quad;
  m.quad = t->boundary.quad;
  meet_all(&m, &t->table);
}

int vg_face_sides_turn(const struct vg_face_sides *t, struct vg_mesh *m,
                       size_t *n)
{
  const size_t n_face = m->n_tri + m->n_quad;

  *n = 0;
  for (size_t f = 0; f < n_face; f++)
    if (t->table.found[f] == SIDE_BOTH) return 0;
  *n = turn_faces(m, t->table.found);
  return 1;
}

void vg_face_sides_free(struct vg_face_sides *t)
{
  if (!t) return;
  face_release(&t->table);
  free(t);
}

/* --- faces between cells --- */

/* The faces of a mesh while those between cells are taken out. */
struct inner_faces {
  struct vg_mesh *m;
  struct vg_inner_faces *found;
  unsigned char *is_inner; /* [n_tri + n_quad] 1: sheet, 2: removed */
  size_t *sheet;           /* [n_patch] triangles that become a sheet; later
                              its number */
  size_t *gone, *kept;     /* [n_patch] faces removed, faces that stay */
};

static uint32_t *patch_of(const struct vg_mesh *m, size_t f)
{
  return f < m->n_tri ? m->tri_patch + f : m->quad_patch + (f - m->n_tri);
}

/* Append "name (count)" to the list, if there is room. */
static void list_patch(struct vg_inner_faces *found, const struct vg_patch *p,
                       size_t n)
{
  size_t at = strlen(found->patches), room = sizeof found->patches - at;
  char name[VG_NAME_MAX + 16], text[VG_NAME_MAX + 48];

  snprintf(name, sizeof name, *p->name ? "%s" : "%.0spatch %d", p->name, p->id);
  snprintf(text, sizeof text, "%s%s (%zu)", at ? ", " : "", name, n);
  if (strlen(text) + 6 <= room) strcpy(found->patches + at, text);
  else if (room > 5 && (at < 3 || strcmp(found->patches + at - 3, "...")))
    strcpy(found->patches + at, ", ...");
}

/* Set is_inner for the faces that have cells on both sides: 1 for the first
 * copy of a triangle, 2 for other copies and quadrilaterals. Count them by
 * patch. */
static void find_inner(struct inner_faces *q, const struct face_table *t)
{
  const struct vg_mesh *m = q->m;

  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    const uint32_t patch = *patch_of(m, f);
    int width;
    const uint32_t *node = face_nodes(m, f, &width);
    uint32_t first = *find_face(m, t, node, width);

    q->is_inner[f] = t->found[first] != SIDE_BOTH ? 0
                   : width == 3 && first == f     ? 1
                                                  : 2;
    q->kept[patch] += !q->is_inner[f];
    q->sheet[patch] += q->is_inner[f] == 1;
    q->gone[patch] += q->is_inner[f] == 2;
    q->found->n_sheet_face += q->is_inner[f] == 1;
    q->found->n_face += q->is_inner[f] == 2;
    q->found->n_copy += q->is_inner[f] && first != f;
  }
}

static void take_faces(struct inner_faces *q)
{
  struct vg_mesh *m = q->m;
  const unsigned char *is_inner = q->is_inner;
  size_t n = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    if (is_inner[i] == 1) {
      memcpy(m->sheet_tri[m->n_sheet_tri], m->tri[i], sizeof *m->tri);
      m->sheet_of[m->n_sheet_tri++] = m->tri_patch[i];
    }
    if (is_inner[i]) continue;
    memmove(m->tri[n], m->tri[i], sizeof *m->tri);
    m->tri_patch[n++] = m->tri_patch[i];
  }
  is_inner += m->n_tri;
  m->n_tri = n;
  n = 0;
  for (size_t i = 0; i < m->n_quad; i++) {
    if (is_inner[i]) continue;
    memmove(m->quad[n], m->quad[i], sizeof *m->quad);
    m->quad_patch[n++] = m->quad_patch[i];
  }
  m->n_quad = n;
}

/* Moves the patches that are sheets to m->sheet, and removes those without
 * other faces. */
static void take_patches(struct inner_faces *q)
{
  struct vg_mesh *m = q->m;
  const size_t n_face = m->n_tri + m->n_quad;
  size_t n = 0;

  for (size_t p = 0; p < m->n_patch; p++) {
    const int is_gone = (q->sheet[p] || q->gone[p]) && !q->kept[p];

    if (q->gone[p]) list_patch(q->found, m->patch + p, q->gone[p]);
    if (q->sheet[p]) {
      m->sheet[m->n_sheet] = m->patch[p];
      m->sheet[m->n_sheet].is_sheet = 1;
      q->sheet[p] = m->n_sheet++;
    }
    q->kept[p] = n;
    if (!is_gone) m->patch[n++] = m->patch[p];
  }
  m->n_patch = n;
  for (size_t f = 0; f < n_face; f++)
    *patch_of(m, f) = (uint32_t)q->kept[*patch_of(m, f)];
  for (size_t t = 0; t < m->n_sheet_tri; t++)
    m->sheet_of[t] = (uint32_t)q->sheet[m->sheet_of[t]];
}

static vg_status take_inner(struct inner_faces *q, struct vg_error *err)
{
  struct vg_mesh *m = q->m;
  const size_t n = q->found->n_sheet_face;

  if (!n && !q->found->n_face) return VG_OK;
  m->sheet_tri = vg_alloc(n, sizeof *m->sheet_tri);
  m->sheet_of = vg_alloc(n, sizeof *m->sheet_of);
  m->sheet = vg_alloc(m->n_patch, sizeof *m->sheet);
  if (!m->sheet_tri || !m->sheet_of || !m->sheet) {
    vg_mesh_drop_sheets(m);
    return vg_fail_memory(err, "the faces between cells");
  }
  take_faces(q);
  take_patches(q);
  return VG_OK;
}

vg_status vg_mesh_take_inner(struct vg_mesh *m, struct vg_inner_faces *found,
                             struct vg_error *err)
{
  struct face_table t = { .n_on = 0 };
  struct inner_faces q = { .m = m, .found = found };
  vg_status st = VG_OK;

  assert(m && found && !m->n_sheet_tri && !m->sheet);
  memset(found, 0, sizeof *found);
  if (!vg_mesh_n_cell(m)) return VG_OK;
  VG_TRY(face_build(&t, m, err));
  meet_all(m, &t);
  q.is_inner = vg_calloc(m->n_tri + m->n_quad, 1);
  q.sheet = vg_calloc(m->n_patch, sizeof *q.sheet);
  q.gone = vg_calloc(m->n_patch, sizeof *q.gone);
  q.kept = vg_calloc(m->n_patch, sizeof *q.kept);
  if (!q.is_inner || !q.sheet || !q.gone || !q.kept)
    st = vg_fail_memory(err, "the faces between cells");
  else find_inner(&q, &t);
  if (st >= 0) st = take_inner(&q, err);
  if (st < 0) memset(found, 0, sizeof *found);
  free(q.is_inner);
  free(q.sheet);
  free(q.gone);
  free(q.kept);
  face_release(&t);
done:
  return st;
}

static void mark_used(size_t n, const uint32_t *node, uint32_t *mark)
{
  for (size_t i = 0; i < n; i++) mark[node[i]] = 0;
}

static void renumber(size_t n, uint32_t *node, const uint32_t *new_index)
{
  for (size_t i = 0; i < n; i++) node[i] = new_index[node[i]];
}

void vg_mesh_keep_boundary(struct vg_mesh *m)
{
  assert(m);

  uint32_t *new_index = vg_alloc(m->n_point, sizeof *new_index);
  size_t n = 0;

  free(m->tet);
  free(m->pyr);
  free(m->pri);
  free(m->hex);
  m->tet = NULL;
  m->pyr = NULL;
  m->pri = NULL;
  m->hex = NULL;
  m->n_tet = m->n_pyr = m->n_pri = m->n_hex = 0;
  vg_mesh_drop_zones(m);
  vg_mesh_drop_sheets(m);
  if (!new_index) return; /* keeping unused points is harmless */
  memset(new_index, 0xff, m->n_point * sizeof *new_index);
  mark_used(3 * m->n_tri, (uint32_t *)m->tri, new_index);
  mark_used(4 * m->n_quad, (uint32_t *)m->quad, new_index);
  for (size_t i = 0; i < m->n_point; i++)
    if (!new_index[i]) {
      memmove(m->point[n], m->point[i], sizeof m->point[n]);
      new_index[i] = (uint32_t)n++;
    }
  renumber(3 * m->n_tri, (uint32_t *)m->tri, new_index);
  renumber(4 * m->n_quad, (uint32_t *)m->quad, new_index);
  m->n_point = n;
  free(new_index);
}

/* Is c a continuation byte of a UTF-8 character? */
static int is_inside(char c)
{
  return ((unsigned char)c & 0xc0) == 0x80;
}

void vg_name_from_file(const char *text, size_t len, char *name, size_t size)
{
  assert((text || !len) && name && size > 0);
  if (len > size - 1) {
    size_t back = 0;

    len = size - 1;
    while (back < 4 && back < len && is_inside(text[len - back])) back++;
    if (back < 4) len -= back;
  }
  for (size_t i = 0; i < len; i++) {
    unsigned char c = (unsigned char)text[i];

    name[i] = c < 32 || c == 127 ? '_' : text[i];
  }
  name[len] = 0;
}
