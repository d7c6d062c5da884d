#include "io/mesh/fluent.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/foam_parts.h"
#include "io/stream/boundary.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"
#include "io/vgrid/mapbc.h"

/* Numbers of zones; patches follow. */
enum { POINTS = 1, FLUID, INTERIOR, PATCHES };
enum { TYPE_INTERIOR = 2, MIXED = 0 };

struct writing {
  const struct vg_mesh *m;
  struct vg_cell_links faces;
  size_t *start, *order;     /* boundary faces by patch */
  struct vg_output out;
};

/* --- types of zones --- */

static const struct zone_type { int code; const char *name; }
wall = { 3, "wall" }, inlet = { 4, "pressure-inlet" },
outlet = { 5, "pressure-outlet" }, symmetry = { 7, "symmetry" },
far = { 9, "pressure-far-field" };

static const struct zone_type *zone_type(const struct vg_patch *p)
{
  int32_t code = p->bc;

  if (code == VG_BC_NONE) code = vg_bc_to_usm3d(p->bc_fun3d);
  switch (code) {
  case 1: return &symmetry;
  case 0: case 3: return &far;
  case 102: case 103: case 1001: return &inlet;
  case 2: case 101: case 1002: case 11002: case 11003: return &outlet;
  default: return &wall;
  }
}

/* --- points, cells --- */

static void put_points(struct writing *w)
{
  vg_output_format(&w->out, "(10 (0 1 %zx 0 3))\n(10 (%x 1 %zx 1 3)(\n",
                   w->m->n_point, POINTS, w->m->n_point);
  for (size_t i = 0; i < w->m->n_point; i++)
    for (int k = 0; k < 3; k++) {
      vg_output_real(&w->out, w->m->point[i][k]);
      vg_output_bytes(&w->out, k < 2 ? " " : "\n", 1);
    }
  vg_output_text(&w->out, "))\n");
}

/* Mixed cells are told kind by kind, a digit each. */
static void put_cells(struct writing *w)
{
  static const char digit[4] = { '2', '5', '6', '4' };
  const size_t n[4] = { w->m->n_tet, w->m->n_pyr, w->m->n_pri, w->m->n_hex };
  int n_kind = 0, only = 0;
  size_t column = 0;

  for (int k = 0; k < 4; k++) {
    n_kind += n[k] > 0;
    if (n[k]) only = digit[k] - '0';
  }
  vg_output_format(&w->out, "(12 (0 1 %x 0 0))\n(12 (%x 1 %x 1 %x)",
                   w->faces.n_cell, FLUID, w->faces.n_cell,
                   n_kind == 1 ? only : MIXED);
  if (n_kind > 1) vg_output_text(&w->out, "(\n");
  for (int k = 0; k < 4 && n_kind > 1; k++)
    for (size_t i = 0; i < n[k]; i++) {
      const char text[2] = { digit[k], ++column % 32 ? ' ' : '\n' };

      vg_output_bytes(&w->out, text, 2);
    }
  vg_output_text(&w->out, n_kind > 1 ? "))\n" : ")\n");
}

/* --- faces --- */

static char *put_hex(char *to, uint32_t v)
{
  int digits = 1;

  while (digits < 8 && v >> 4 * digits) digits++;
  for (int k = digits; k-- > 0;) *to++ = "0123456789abcdef"[v >> 4 * k & 15];
  *to++ = ' ';
  return to;
}

/* A half-face from its cell; mate: the other cell counted from 1, 0 for none.
 * Its own normal points out of the cell. */
static void put_face(struct writing *w, uint32_t code, uint32_t mate,
                     int is_mixed)
{
  char line[80], *to = line;
  uint32_t node[4], cell = (code >> 3) + 1;
  int n = vg_half_face_nodes(&w->faces, code, node);

  if (is_mixed) to = put_hex(to, (uint32_t)n);
  for (int k = 0; k < n; k++) to = put_hex(to, node[mate ? k : n - 1 - k] + 1);
  to = put_hex(to, mate ? mate : cell);
  to = put_hex(to, mate ? cell : 0);
  to[-1] = '\n';
  vg_output_bytes(&w->out, line, (size_t)(to - line));
}

/* The head of a zone of n faces, n_quad of them with four corners; whether the
 * faces must say how many they have. */
static int put_head(struct writing *w, size_t zone, uint64_t first, uint64_t n,
                    uint64_t n_quad, int type)
{
  int kind = n_quad == 0 ? 3 : n_quad == n ? 4 : MIXED;

  vg_output_format(&w->out, "(13 (%zx %llx %llx %x %x)(\n", zone,
                   (unsigned long long)first,
                   (unsigned long long)(first + n - 1), type, kind);
  return kind == MIXED;
}

static void put_interior(struct writing *w)
{
  const struct vg_cell_links *f = &w->faces;
  uint64_t n_quad = f->n_corner - 3 * (uint64_t)w->m->n_tri -
                    4 * (uint64_t)w->m->n_quad - 3 * f->n_internal;
  uint32_t code[6], neighbour[6];
  int is_mixed;

  if (!f->n_internal) return;
  is_mixed = put_head(w, INTERIOR, 1, f->n_internal, n_quad, TYPE_INTERIOR);
  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    int n = vg_foam_upper(f, cell, code, neighbour);

    for (int i = 0; i < n; i++)
      put_face(w, code[i], neighbour[i] + 1, is_mixed);
  }
  vg_output_text(&w->out, "))\n");
}

static void put_patch(struct writing *w, size_t patch)
{
  size_t first = w->start[patch], end = w->start[patch + 1], n_quad = 0;
  int is_mixed;

  if (first == end) return;
  for (size_t i = first; i < end; i++) n_quad += w->order[i] >= w->m->n_tri;
  is_mixed = put_head(w, PATCHES + patch, w->faces.n_internal + first + 1,
                      end - first, n_quad, zone_type(w->m->patch + patch)->code);
  for (size_t i = first; i < end; i++)
    put_face(w, w->faces.boundary[w->order[i]], 0, is_mixed);
  vg_output_text(&w->out, "))\n");
}

/* --- the file --- */

/* Numbers of zones are decimal here. */
static vg_status put_names(struct writing *w, struct vg_error *err)
{
  char (*word)[VG_PATCH_WORD] = vg_patch_words(w->m, VG_PATCH_WORD_MOST);

  if (!word) return vg_fail_memory(err, "the names of the patches");
  vg_output_format(&w->out, "(45 (%d fluid fluid)())\n", FLUID);
  if (w->faces.n_internal)
    vg_output_format(&w->out, "(45 (%d interior interior)())\n", INTERIOR);
  for (size_t p = 0; p < w->m->n_patch; p++)
    if (w->start[p] < w->start[p + 1])
      vg_output_format(&w->out, "(45 (%zu %s %s)())\n", PATCHES + p,
                       zone_type(w->m->patch + p)->name, word[p]);
  free(word);
  return VG_OK;
}

static vg_status put_all(struct writing *w, struct vg_error *err)
{
  vg_output_text(&w->out, "(0 \"Vanguard\")\n(2 3)\n");
  put_points(w);
  put_cells(w);
  vg_output_format(&w->out, "(13 (0 1 %llx 0 0))\n",
                   (unsigned long long)(w->faces.n_internal + w->m->n_tri +
                                        w->m->n_quad));
  put_interior(w);
  for (size_t p = 0; p < w->m->n_patch; p++) put_patch(w, p);
  return put_names(w, err);
}

vg_status vg_fluent_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err)
{
  struct writing w = { .m = m, .faces = VG_CELL_LINKS_INIT,
                       .out = VG_OUTPUT_INIT };
  vg_status st;

  if (!(m->n_tet + m->n_pyr + m->n_pri + m->n_hex))
    return vg_fail(err, VG_ERR_INPUT, "%s: the mesh has no cells; write the "
                   "surface as .stl", path);
  VG_TRY(vg_boundary_by_patch(m, &w.start, &w.order, err));
  VG_TRY(vg_foam_links(&w.faces, m, path, err));
  VG_TRY(vg_output_open(path, &w.out, err));
  VG_TRY(put_all(&w, err));
  st = vg_output_commit(&w.out, err);
done:
  vg_output_release(&w.out);
  vg_cell_links_release(&w.faces);
  free(w.start);
  free(w.order);
  return st;
}
