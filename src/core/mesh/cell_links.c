/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matching of half-faces: core/mesh/cell_links.h.
 *
 * One pass visits the cells in order. A half-face whose mate has not been met
 * yet waits in a chain: its entry of link[] holds the next half-face of the
 * chain until the mate comes, and the mate from then on. The only extra memory
 * is therefore the heads of the chains: 16 bytes per point, or 3 per
 * tetrahedron. base/table.h would take 16 to 32 bytes per tetrahedron. The
 * head of a face lies near the number of its lowest point. Cells with
 * neighbouring numbers thus share cache lines, and the faces of a point with
 * very many faces spread over a window of heads. */
#include "core/mesh/cell_links.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/mesh/cell_faces.h"

#define NONE UINT32_MAX
#define HEADS 4u /* heads per point */
#define WINDOW_BITS 12u
#define WINDOW (1u << WINDOW_BITS)
/* Keeps 8 * cell + face below NONE. */
#define MAX_CELL ((UINT32_MAX >> 3) - 1)

struct heads {
  uint32_t *head; /* [n] */
  size_t n;
};

void vg_cell_links_release(struct vg_cell_links *f)
{
  const struct vg_cell_links empty = VG_CELL_LINKS_INIT;

  free(f->link);
  free(f->boundary);
  *f = empty;
}

/* Nodes of a cell. Sets its faces and their number. */
static inline const uint32_t *cell_nodes(const struct vg_cell_links *f,
                                         uint32_t cell,
                                         const unsigned char (**face)[4],
                                         int *n_face)
{
  *n_face = 5;
  if (cell < f->end_tet) {
    *n_face = 4;
    *face = vg_tet_face;
    return f->m->tet[cell];
  }
  if (cell < f->end_pyr) {
    *face = vg_pyr_face;
    return f->m->pyr[cell - f->end_tet];
  }
  if (cell < f->end_pri) {
    *face = vg_pri_face;
    return f->m->pri[cell - f->end_pyr];
  }
  *n_face = 6;
  *face = vg_hex_face;
  return f->m->hex[cell - f->end_pri];
}

static inline uint32_t *link_of(const struct vg_cell_links *f, uint32_t code)
{
  return f->link + vg_first_half(f, code >> 3) + (code & 7);
}

int vg_half_face_nodes(const struct vg_cell_links *f, uint32_t code,
                       uint32_t node[4])
{
  assert(code >> 3 < f->n_cell);
  assert((int)(code & 7) < vg_half_faces(f, code >> 3));

  const unsigned char(*face)[4], *q;
  int n_face, width;
  const uint32_t *c = cell_nodes(f, code >> 3, &face, &n_face);

  q = face[code & 7];
  width = q[2] == q[3] ? 3 : 4;
  for (int k = 0; k < width; k++) node[k] = c[q[width - 1 - k]];
  return width;
}

/* --- keys: sorted nodes, with NONE as the fourth entry for triangles ------ */

static inline void make_key(const uint32_t *c, const unsigned char *q,
                            uint32_t key[4])
{
  for (int k = 0; k < 3; k++) key[k] = c[q[k]];
  if (q[2] == q[3]) {
    vg_order3(key);
    key[3] = NONE;
    return;
  }
  key[3] = c[q[3]];
  vg_order4(key);
}

static inline size_t slot_of(const uint32_t key[4])
{
  uint64_t h = key[1] * VG_GOLDEN + key[2] * VG_HASH_2;

  return HEADS * (size_t)key[0] + (size_t)(h >> (64 - WINDOW_BITS));
}

static inline int has_key(const struct vg_cell_links *f, uint32_t code,
                          const uint32_t key[4])
{
  const unsigned char(*face)[4];
  uint32_t other[4];
  int n_face;
  const uint32_t *c = cell_nodes(f, code >> 3, &face, &n_face);

  make_key(c, face[code & 7], other);
  return !((key[0] ^ other[0]) | (key[1] ^ other[1]) | (key[2] ^ other[2]) |
           (key[3] ^ other[3]));
}

/* Remove the waiting half-face with this key from its chain and return it, or
 * NONE if no half-face waits. */
static inline uint32_t take(const struct vg_cell_links *f, struct heads *h,
                            size_t slot, const uint32_t key[4])
{
  uint32_t *at = h->head + slot, code;

  while ((code = *at) != NONE) {
    uint32_t *next = link_of(f, code);

    if (has_key(f, code, key)) {
      *at = *next;
      return code;
    }
    at = next;
  }
  return NONE;
}

/* --- building ------------------------------------------------------------- */

static void pass_cells(struct vg_cell_links *f, struct heads *h)
{
  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    const unsigned char(*face)[4];
    int n_face;
    const uint32_t *c = cell_nodes(f, cell, &face, &n_face);
    uint32_t *link = f->link + vg_first_half(f, cell);

    for (int i = 0; i < n_face; i++) {
      uint32_t key[4], code = cell << 3 | (uint32_t)i, mate;
      size_t slot;

      make_key(c, face[i], key);
      slot = slot_of(key);
      mate = take(f, h, slot, key);
      if (mate != NONE && mate >> 3 == cell) {
        /* A collapsed cell is not a neighbour of itself: both half-faces wait.
         */
        *link_of(f, mate) = h->head[slot];
        h->head[slot] = mate;
        mate = NONE;
      }
      if (mate == NONE) {
        link[i] = h->head[slot];
        h->head[slot] = code;
        continue;
      }
      link[i] = mate;
      *link_of(f, mate) = code;
      f->n_internal++;
      f->n_corner += key[3] == NONE ? 3 : 4;
    }
  }
}

static const uint32_t *boundary_nodes(const struct vg_mesh *m, size_t face,
                                      int *width)
{
  *width = face < m->n_tri ? 3 : 4;
  return face < m->n_tri ? m->tri[face] : m->quad[face - m->n_tri];
}

static vg_status loose_face(const struct vg_mesh *m, size_t face,
                            const char *name, struct vg_error *err)
{
  int width;
  const uint32_t *node = boundary_nodes(m, face, &width);
  const double *p = m->point[node[0]];

  return vg_fail(err, VG_ERR_INPUT,
                 "%s: boundary %s %zu of the mesh, at (%g, %g, %g), is not a "
                 "face of any cell, or its cell face is already matched; the "
                 "mesh is not closed: run 'vanguard check' on it",
                 name, width == 3 ? "triangle" : "quadrilateral",
                 (width == 3 ? face : face - m->n_tri) + 1, p[0], p[1], p[2]);
}

static vg_status pass_boundary(struct vg_cell_links *f, struct heads *h,
                               const char *name, struct vg_error *err)
{
  static const unsigned char tri[4] = { 0, 1, 2, 2 }, quad[4] = { 0, 1, 2, 3 };

  for (size_t i = 0; i < f->m->n_tri + f->m->n_quad; i++) {
    int width;
    const uint32_t *node = boundary_nodes(f->m, i, &width);
    uint32_t key[4], code;

    make_key(node, width == 3 ? tri : quad, key);
    code = take(f, h, slot_of(key), key);
    if (code == NONE) return loose_face(f->m, i, name, err);
    f->boundary[i] = code;
    *link_of(f, code) = VG_NO_CELL;
    f->n_corner += (uint64_t)width;
  }
  return VG_OK;
}

/* Does any half-face still wait? The error names the lowest one. */
static vg_status check_left(const struct vg_cell_links *f,
                            const struct heads *h, const char *name,
                            struct vg_error *err)
{
  const char *kind = "tetrahedron";
  uint32_t lowest = NONE, cell, node[4];
  const double *p;

  for (size_t i = 0; i < h->n; i++)
    for (uint32_t c = h->head[i]; c != NONE; c = *link_of(f, c))
      if (c < lowest) lowest = c;
  if (lowest == NONE) return VG_OK;
  vg_half_face_nodes(f, lowest, node);
  p = f->m->point[node[0]];
  cell = lowest >> 3;
  if (cell >= f->end_pri) {
    kind = "hexahedron";
    cell -= f->end_pri;
  } else if (cell >= f->end_pyr) {
    kind = "prism";
    cell -= f->end_pyr;
  } else if (cell >= f->end_tet) {
    kind = "pyramid";
    cell -= f->end_tet;
  }
  return vg_fail(
    err, VG_ERR_INPUT,
    "%s: the face with points %u, %u, %u at (%g, %g, %g) of %s %u "
    "has neither a neighbouring cell nor a boundary face; the mesh "
    "is not closed: run 'vanguard check' on it",
    name, node[0] + 1, node[1] + 1, node[2] + 1, p[0], p[1], p[2], kind,
    cell + 1);
}

/* Half-faces that still wait have no mate. */
static void leave_open(const struct vg_cell_links *f, const struct heads *h)
{
  for (size_t i = 0; i < h->n; i++)
    for (uint32_t c = h->head[i], next; c != NONE; c = next) {
      next = *link_of(f, c);
      *link_of(f, c) = VG_NO_CELL;
    }
}

static vg_status make_room(struct vg_cell_links *f, struct heads *h,
                           const struct vg_mesh *m, int is_open,
                           const char *name, struct vg_error *err)
{
  uint64_t n_cell = vg_mesh_n_cell(m);
  size_t n_face = m->n_tri + m->n_quad;

  if (n_cell > MAX_CELL || m->n_point > INT32_MAX || n_face > INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: %llu cells and %zu points are too many for 32-bit "
                   "labels of their faces",
                   name, (unsigned long long)n_cell, m->n_point);
  f->m = m;
  f->n_cell = (uint32_t)n_cell;
  f->end_tet = (uint32_t)m->n_tet;
  f->end_pyr = f->end_tet + (uint32_t)m->n_pyr;
  f->end_pri = f->end_pyr + (uint32_t)m->n_pri;
  f->link = vg_alloc(vg_first_half(f, f->n_cell), sizeof *f->link);
  if (!is_open) f->boundary = vg_alloc(n_face, sizeof *f->boundary);
  h->n = HEADS * m->n_point + WINDOW;
  h->head = vg_alloc(h->n, sizeof *h->head);
  if (!f->link || (!is_open && !f->boundary) || !h->head)
    return vg_fail_memory(err, "the faces of the cells");
  memset(h->head, 0xff, h->n * sizeof *h->head);
  return VG_OK;
}

vg_status vg_cell_links_build(struct vg_cell_links *f, const struct vg_mesh *m,
                              int is_open, const char *name,
                              struct vg_error *err)
{
  struct vg_cell_links made = VG_CELL_LINKS_INIT;
  struct heads h = { NULL, 0 };
  vg_status st;

  assert(f && m && name);
  assert(is_open == 0 || is_open == 1);
  VG_TRY(make_room(&made, &h, m, is_open, name, err));
  pass_cells(&made, &h);
  if (is_open) {
    leave_open(&made, &h);
  } else {
    VG_TRY(pass_boundary(&made, &h, name, err));
    VG_TRY(check_left(&made, &h, name, err));
  }
  *f = made;
  memset(&made, 0, sizeof made);
done:
  free(h.head);
  vg_cell_links_release(&made);
  return st;
}
