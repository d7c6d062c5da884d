/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/fluent.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"
#include "io/mesh/foam_parts.h"
#include "io/stream/boundary.h"
#include "io/vgrid/mapbc.h"

/* Zone numbers; the patches have PATCHES and higher. */
enum { POINTS = 1, FLUID, INTERIOR, PATCHES };
enum { TYPE_INTERIOR = 2, MIXED = 0 };

/* A real and the blank before it; vg_format_real writes at most 24
 * characters. */
#define REAL_WIDTH 25
#define LINE 128

/* Fluent's code of each of the four kinds of cells. */
static const char digit[VG_FLUENT_KINDS] = { '2', '5', '6', '4' };

/* --- types of zones --- */

static const struct zone_type {
  int code;
  const char *name;
} wall = { 3, "wall" }, inlet = { 4, "pressure-inlet" },
  outlet = { 5, "pressure-outlet" }, symmetry = { 7, "symmetry" },
  far = { 9, "pressure-far-field" }, periodic = { 12, "periodic" },
  shadow = { 8, "shadow" }, interface = { 24, "interface" };

/* 1: the patch with this number is the first one of a pair; 2: the second
 * one; 0: neither. */
static int side_of(const struct vg_periodic_links *links, int32_t id)
{
  for (size_t i = 0; links && i < links->n; i++) {
    if (links->pair[i].patch == id) return 1;
    if (links->pair[i].image == id) return 2;
  }
  return 0;
}

static const struct zone_type *zone_type(const struct vg_fluent *f,
                                         size_t patch)
{
  const struct vg_patch *p = &f->frame->patch[patch];
  const int is_periodic = side_of(f->links, p->id);
  int32_t code = p->bc;

  if (is_periodic) return is_periodic == 1 ? &periodic : &shadow;
  if (vg_patch_is_sliding(p)) return &interface;
  if (code == VG_BC_NONE) code = vg_bc_to_usm3d(p->bc_fun3d);
  switch (code) {
  case 1: return &symmetry;
  case 0:
  case 3: return &far;
  case 102:
  case 103:
  case 1001: return &inlet;
  case 2:
  case 101:
  case 1002:
  case 11002:
  case 11003: return &outlet;
  default: return &wall;
  }
}

/* Kind of n faces, n_quad of which have four vertices. */
static int face_kind(uint64_t n, uint64_t n_quad)
{
  return n_quad == 0 ? 3 : n_quad == n ? 4 : MIXED;
}

/* Number of faces between cells that are in no sheet, which have the zone
 * INTERIOR; their kind. */
static uint64_t n_plain(const struct vg_fluent *f)
{
  return f->n_internal - f->frame->n_sheet_tri;
}

static int plain_kind(const struct vg_fluent *f)
{
  return face_kind(n_plain(f), f->n_quad);
}

/* --- lines --- */

/* Write a blank and v, right-justified in `width` columns, at *to. */
static void column(char **to, int width, uint64_t v)
{
  char *at = *to + width;

  *to = at + 1;
  do *at-- = "0123456789abcdef"[v & 15];
  while (v >>= 4);
  while (at >= *to - width - 1) *at-- = ' ';
}

/* Length of a line. Vertices that a face lacks are written as blanks, so that
 * all lines have the same length. */
static uint64_t face_line(const struct vg_fluent *f, int kind)
{
  int n_column = (kind == MIXED ? 4 : kind) + 2;

  return (kind == MIXED) + (uint64_t)(n_column * (f->width + 1)) + 1;
}

/* Number of a cell in the file, from 1. */
static uint32_t number_of(const struct vg_fluent *f, uint32_t cell)
{
  return (f->number ? f->number[cell] : cell) + 1;
}

/* mate: the cell on the side from which the normal points, counted from 1; 0:
 * none. */
static void put_face(struct vg_output *out, const struct vg_fluent *f, int kind,
                     int n, const uint32_t *node, uint32_t cell, uint32_t mate)
{
  char line[LINE], *to = line;
  size_t length = (size_t)face_line(f, kind);

  if (kind == MIXED) *to++ = (char)('0' + n);
  for (int k = 0; k < n; k++) column(&to, f->width, (uint64_t)node[k] + 1);
  column(&to, f->width, cell);
  column(&to, f->width, mate);
  memset(to, ' ', length - (size_t)(to - line));
  line[length - 1] = '\n';
  vg_output_bytes(out, line, length);
}

void vg_fluent_put_point(struct vg_output *out, const double x[3])
{
  char line[3 * REAL_WIDTH + 1], text[32], *to = line;

  memset(line, ' ', sizeof line);
  for (int k = 0; k < 3; k++) {
    size_t n = vg_format_real(x[k], text);

    to += REAL_WIDTH;
    memcpy(to - n, text, n);
  }
  *to = '\n';
  vg_output_bytes(out, line, sizeof line);
}

/* --- kinds --- */

static int patch_kind(const struct vg_fluent *f, size_t patch)
{
  size_t first = f->start[patch], end = f->start[patch + 1], n_quad = 0;

  for (size_t i = first; i < end; i++) n_quad += f->order[i] >= f->frame->n_tri;
  return face_kind(end - first, n_quad);
}

/* Common kind of all cells, or MIXED. */
static int cell_kind(const struct vg_fluent *f)
{
  const struct vg_mesh *m = f->frame;
  const size_t n[VG_FLUENT_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };

  for (int k = 0; k < VG_FLUENT_KINDS; k++)
    if (n[k] == f->n_cell) return digit[k] - '0';
  return MIXED;
}

/* --- the frame --- */

static void put_head(struct vg_output *out, size_t zone, uint64_t before,
                     uint64_t n, int type, int kind)
{
  vg_output_format(out, "(13 (%zx %llx %llx %x %x)(\n", zone,
                   (unsigned long long)before + 1,
                   (unsigned long long)(before + n), type, kind);
}

/* Numbers of the zones of cells, and of the faces in them; z = n_zone: of the
 * faces between them. */
static size_t cells_id(const struct vg_fluent *f, size_t z)
{
  return z ? PATCHES + f->frame->n_patch + f->frame->n_sheet + z - 1 : FLUID;
}

static size_t interior_id(const struct vg_fluent *f, size_t z)
{
  return z ? cells_id(f, f->frame->n_zone + z) : INTERIOR;
}

static void put_zone_names(struct vg_output *out, const struct vg_fluent *f)
{
  const struct vg_mesh *m = f->frame;
  const char(*word)[VG_PATCH_WORD] = (const char(*)[VG_PATCH_WORD])f->word;
  const size_t first = m->n_patch + m->n_sheet, n_word = first + m->n_zone;
  char text[VG_PATCH_WORD], name[VG_PATCH_WORD];

  for (size_t z = 0; z < m->n_zone; z++)
    vg_output_format(out, "(45 (%zu %s %s)())\n", cells_id(f, z),
                     m->zone[z].kind == VG_ZONE_SOLID ? "solid" : "fluid",
                     f->word[first + z]);
  for (size_t z = 0; z <= m->n_zone; z++) {
    snprintf(text, sizeof text, "interior_%.*s", VG_PATCH_WORD - 24,
             z < m->n_zone ? f->word[first + z] : "between");
    vg_patch_free_word(word, n_word, text, name);
    if (f->n_face[z])
      vg_output_format(out, "(45 (%zu interior %s)())\n", interior_id(f, z),
                       name);
  }
}

static void put_plain_names(struct vg_output *out, const struct vg_fluent *f)
{
  const char(*word)[VG_PATCH_WORD] = (const char(*)[VG_PATCH_WORD])f->word;
  const size_t n_word = f->frame->n_patch + f->frame->n_sheet;
  char name[VG_PATCH_WORD];

  vg_patch_free_word(word, n_word, "fluid", name);
  vg_output_format(out, "(45 (%d fluid %s)())\n", FLUID, name);
  vg_patch_free_word(word, n_word, "interior", name);
  if (n_plain(f))
    vg_output_format(out, "(45 (%d interior %s)())\n", INTERIOR, name);
}

/* Zone numbers are decimal in this section. */
static void put_names(struct vg_output *out, const struct vg_fluent *f)
{
  const size_t n_word = f->frame->n_patch + f->frame->n_sheet;

  if (f->number) put_zone_names(out, f);
  else put_plain_names(out, f);
  for (size_t p = 0; p < f->frame->n_patch; p++)
    if (f->start[p] < f->start[p + 1])
      vg_output_format(out, "(45 (%zu %s %s)())\n", PATCHES + p,
                       zone_type(f, p)->name, f->word[p]);
  for (size_t p = f->frame->n_patch; p < n_word; p++)
    vg_output_format(out, "(45 (%zu interior %s)())\n", PATCHES + p,
                     f->word[p]);
}

/* --- points, cells, faces ------------------------------------------------ */

static void put_points(struct vg_output *out, const struct vg_fluent *f,
                       int is_whole)
{
  const struct vg_mesh *m = f->frame;

  if (!is_whole) vg_output_skip(out, m->n_point * (3 * REAL_WIDTH + 1));
  for (size_t i = 0; is_whole && i < m->n_point; i++)
    vg_fluent_put_point(out, m->point[i]);
}

static void put_kinds(struct vg_output *out, const struct vg_fluent *f,
                      int kind, uint64_t cell, uint64_t n)
{
  for (uint64_t at = f->first[kind] + cell, end = at + n; at < end;) {
    const char text[2] = { digit[kind], ++at % 32 ? ' ' : '\n' };

    vg_output_bytes(out, text, 2);
  }
}

/* The kinds of mixed cells are listed as one digit per cell. */
static void put_cells(struct vg_output *out, struct vg_fluent *f, int is_whole)
{
  int kind = cell_kind(f);

  vg_output_format(out, "(12 (0 1 %llx 0 0))\n(12 (%x 1 %llx 1 %x)",
                   (unsigned long long)f->n_cell, FLUID,
                   (unsigned long long)f->n_cell, kind);
  if (kind == MIXED) vg_output_text(out, "(\n");
  f->at_cell = out->written;
  if (kind == MIXED && !is_whole) vg_output_skip(out, 2 * f->n_cell);
  for (int k = 0; kind == MIXED && is_whole && k < VG_FLUENT_KINDS; k++)
    put_kinds(out, f, k, 0,
              (k + 1 < VG_FLUENT_KINDS ? f->first[k + 1] : f->n_cell) -
                f->first[k]);
  vg_output_text(out, kind == MIXED ? "))\n" : ")\n");
}

/* Cells of each zone, of one kind or with a list of kinds. */
static void put_zone_cells(struct vg_output *out, const struct vg_fluent *f)
{
  const struct vg_mesh *m = f->frame;
  uint64_t before = 0;

  vg_output_format(out, "(12 (0 1 %llx 0 0))\n", (unsigned long long)f->n_cell);
  for (size_t z = 0; z < m->n_zone; z++) {
    const uint64_t *n = m->zone[z].n_cell, all = vg_mesh_zone_cells(m, z);
    uint64_t at = 0;
    int kind = MIXED;

    for (int k = 0; k < VG_FLUENT_KINDS; k++)
      if (n[k] == all) kind = digit[k] - '0';
    if (!all) continue;
    vg_output_format(out, "(12 (%zx %llx %llx 1 %x)%s", cells_id(f, z),
                     (unsigned long long)before + 1,
                     (unsigned long long)(before + all), kind,
                     kind == MIXED ? "(\n" : "");
    for (int k = 0; kind == MIXED && k < VG_FLUENT_KINDS; k++)
      for (uint64_t c = 0; c < n[k]; c++) {
        const char text[2] = { digit[k], ++at % 32 ? ' ' : '\n' };

        vg_output_bytes(out, text, 2);
      }
    vg_output_text(out, kind == MIXED ? "))\n" : ")\n");
    before += all;
  }
}

/* A face between cells that is in a sheet: code of the half-face of the lower
 * cell, and the other cell. */
struct sheet_face {
  uint32_t code, mate;
};

/* Faces of the sheets, found while the others are written. face: [n_sheet_tri];
 * NULL: none are looked for */
struct sheet_faces {
  struct vg_sheet_table table;
  struct sheet_face *face;
};

/* Returns 1 for a face of a sheet. */
static int keep_sheet(struct sheet_faces *s, int n, const uint32_t *node,
                      uint32_t code, uint32_t mate)
{
  int is_same;
  const uint32_t t = n == 3 && s->face
                     ? vg_sheet_table_find(&s->table, node, &is_same)
                     : UINT32_MAX;

  if (t == UINT32_MAX) return 0;
  s->face[t] = (struct sheet_face){ code, mate };
  return 1;
}

/* Writes the plain faces of the cells first to end - 1 that are in group g:
 * both cells in zone g, or g = n_zone and two zones. out NULL: counts them in n
 * and n_quad instead, of all groups. */
static void group_faces(struct vg_output *out, const struct vg_fluent *f,
                        const struct vg_cell_links *links,
                        struct sheet_faces *sheets, uint64_t first,
                        uint64_t end, size_t g, uint64_t *n, uint64_t *n_quad)
{
  uint32_t code[6], neighbour[6], node[4];

  for (uint32_t cell = (uint32_t)first; cell < end; cell++) {
    const int n_face = vg_foam_upper(links, cell, code, neighbour);

    for (int i = 0; i < n_face; i++) {
      const uint32_t mate = neighbour[i];
      const size_t of = f->zone[cell] == f->zone[mate] ? f->zone[cell]
                                                       : f->frame->n_zone;
      const int n_node = vg_half_face_nodes(links, code[i], node);

      if (keep_sheet(sheets, n_node, node, code[i], mate)) continue;
      if (!out) {
        n[of]++;
        n_quad[of] += n_node == 4;
      } else if (of == g)
        put_face(out, f, face_kind(n[g], n_quad[g]), n_node, node,
                 number_of(f, mate), number_of(f, cell));
    }
  }
}

/* A zone of faces for each zone of cells, and one for those between. */
static void put_interiors(struct vg_output *out, struct vg_fluent *f,
                          const struct vg_cell_links *links,
                          struct sheet_faces *sheets)
{
  const struct vg_mesh *m = f->frame;
  uint64_t *n_quad = f->n_face + m->n_zone + 1, before = 0;

  group_faces(NULL, f, links, sheets, 0, f->n_cell, 0, f->n_face, n_quad);
  for (size_t g = 0; g <= m->n_zone; g++) {
    const uint64_t n = f->n_face[g];

    if (!n) continue;
    put_head(out, interior_id(f, g), before, n, TYPE_INTERIOR,
             face_kind(n, n_quad[g]));
    for (int k = 0; k < VG_FLUENT_KINDS && g < m->n_zone; k++) {
      const uint64_t first = f->first[k] + vg_mesh_zone_start(m, g, k);

      group_faces(out, f, links, sheets, first, first + m->zone[g].n_cell[k], g,
                  f->n_face, n_quad);
    }
    if (g == m->n_zone)
      group_faces(out, f, links, sheets, 0, f->n_cell, g, f->n_face, n_quad);
    vg_output_text(out, "))\n");
    before += n;
  }
}

static void put_interior(struct vg_output *out, struct vg_fluent *f,
                         const struct vg_cell_links *links,
                         struct sheet_faces *sheets)
{
  uint32_t code[6], neighbour[6], node[4];

  f->at_internal = out->written;
  if (!n_plain(f)) return;
  put_head(out, INTERIOR, 0, n_plain(f), TYPE_INTERIOR, plain_kind(f));
  f->at_internal = out->written;
  if (!links) vg_output_skip(out, n_plain(f) * face_line(f, plain_kind(f)));
  for (uint32_t cell = 0; links && cell < links->n_cell; cell++) {
    int n = vg_foam_upper(links, cell, code, neighbour);

    for (int i = 0; i < n; i++) {
      int n_node = vg_half_face_nodes(links, code[i], node);

      if (!keep_sheet(sheets, n_node, node, code[i], neighbour[i]))
        vg_fluent_put_internal(out, f, n_node, node, cell, neighbour[i]);
    }
  }
  vg_output_text(out, "))\n");
}

/* The faces of each sheet follow those of the zone INTERIOR, and have a zone of
 * the same type. */
static void put_sheets(struct vg_output *out, const struct vg_fluent *f,
                       const struct vg_cell_links *links,
                       const struct sheet_faces *sheets)
{
  const struct vg_mesh *m = f->frame;
  uint64_t before = n_plain(f);
  uint32_t node[4];

  for (size_t i = 0; i < m->n_sheet; i++) {
    size_t n = 0;

    for (size_t t = 0; t < m->n_sheet_tri; t++) n += m->sheet_of[t] == i;
    if (!n) continue;
    put_head(out, PATCHES + m->n_patch + i, before, n, TYPE_INTERIOR, 3);
    if (!links) vg_output_skip(out, n * face_line(f, 3));
    for (size_t t = 0; links && t < m->n_sheet_tri; t++) {
      const struct sheet_face *s = &sheets->face[t];

      if (m->sheet_of[t] != i) continue;
      vg_half_face_nodes(links, s->code, node);
      put_face(out, f, 3, 3, node, number_of(f, s->mate),
               number_of(f, s->code >> 3));
    }
    vg_output_text(out, "))\n");
    before += n;
  }
}

static void put_patch(struct vg_output *out, struct vg_fluent *f, size_t patch,
                      const struct vg_cell_links *links)
{
  size_t first = f->start[patch], end = f->start[patch + 1];
  int kind = f->kind[patch];

  if (first == end) return;
  put_head(out, PATCHES + patch, f->n_internal + first, end - first,
           zone_type(f, patch)->code, kind);
  f->at_patch[patch] = out->written;
  if (!links) vg_output_skip(out, (end - first) * face_line(f, kind));
  for (size_t i = first; links && i < end; i++)
    vg_fluent_put_boundary(out, f, i, links->boundary[f->order[i]] >> 3);
  vg_output_text(out, "))\n");
}

/* Number of a boundary face in the file, from 1. */
static unsigned long long periodic_number(const struct vg_fluent *f,
                                          uint32_t face)
{
  return (unsigned long long)(f->n_internal + f->face_at[face] + 1);
}

/* Pairs of periodic faces. */
static void put_periodic(struct vg_output *out, const struct vg_fluent *f)
{
  for (size_t i = 0; f->links && i < f->links->n; i++) {
    const struct vg_periodic *p = &f->links->pair[i];
    const size_t a = vg_mesh_find_patch(f->frame, p->patch);

    vg_output_format(out, "(18 (1 %zx %zx %zx)(\n",
                     f->start[a + 1] - f->start[a], PATCHES + a,
                     PATCHES + vg_mesh_find_patch(f->frame, p->image));
    for (size_t k = f->start[a]; k < f->start[a + 1]; k++) {
      const uint32_t face = (uint32_t)f->order[k];

      vg_output_format(out, "%llx %llx\n", periodic_number(f, face),
                       periodic_number(f, f->links->match[i].face[face]));
    }
    vg_output_text(out, "))\n");
  }
}

/* links: of the whole mesh. With NULL, points, cells and faces are skipped. */
static void put_all(struct vg_output *out, struct vg_fluent *f,
                    const struct vg_cell_links *links,
                    struct sheet_faces *sheets)
{
  const struct vg_mesh *m = f->frame;

  vg_output_format(out,
                   "(0 \"Vanguard\")\n(2 3)\n(10 (0 1 %zx 0 3))\n"
                   "(10 (%x 1 %zx 1 3)(\n",
                   m->n_point, POINTS, m->n_point);
  f->at_point = out->written;
  put_points(out, f, links != NULL);
  vg_output_text(out, "))\n");
  if (f->number) put_zone_cells(out, f);
  else put_cells(out, f, links != NULL);
  vg_output_format(out, "(13 (0 1 %llx 0 0))\n",
                   (unsigned long long)(f->n_internal + m->n_tri + m->n_quad));
  if (f->number && links) put_interiors(out, f, links, sheets);
  else put_interior(out, f, links, sheets);
  put_sheets(out, f, links, sheets);
  for (size_t p = 0; p < m->n_patch; p++) put_patch(out, f, p, links);
  put_names(out, f);
  put_periodic(out, f);
}

vg_status vg_fluent_number_faces(struct vg_fluent *f, struct vg_error *err)
{
  const size_t n = f->frame->n_tri + f->frame->n_quad;

  f->face_at = vg_alloc(n, sizeof *f->face_at);
  if (!f->face_at) return vg_fail_memory(err, "the periodic faces");
  for (size_t i = 0; i < n; i++) f->face_at[f->order[i]] = i;
  return VG_OK;
}

void vg_fluent_put_frame(struct vg_output *out, struct vg_fluent *f)
{
  put_all(out, f, NULL, NULL);
}

/* --- parts --------------------------------------------------------------- */

void vg_fluent_seek_point(struct vg_output *out, const struct vg_fluent *f,
                          uint64_t point)
{
  vg_output_seek(out, f->at_point + point * (3 * REAL_WIDTH + 1));
}

void vg_fluent_put_kinds(struct vg_output *out, const struct vg_fluent *f,
                         int kind, uint64_t cell, uint64_t n)
{
  assert(kind >= 0 && kind < VG_FLUENT_KINDS);
  if (cell_kind(f) != MIXED) return;
  vg_output_seek(out, f->at_cell + 2 * (f->first[kind] + cell));
  put_kinds(out, f, kind, cell, n);
}

void vg_fluent_seek_internal(struct vg_output *out, const struct vg_fluent *f,
                             uint64_t face)
{
  assert(face <= f->n_internal && !f->frame->n_sheet);
  vg_output_seek(out, f->at_internal + face * face_line(f, plain_kind(f)));
}

void vg_fluent_put_internal(struct vg_output *out, const struct vg_fluent *f,
                            int n, const uint32_t *node, uint32_t cell,
                            uint32_t mate)
{
  assert((n == 3 || n == 4) && node && cell < mate && !f->number);
  put_face(out, f, plain_kind(f), n, node, mate + 1, cell + 1);
}

static size_t patch_of(const struct vg_fluent *f, size_t at)
{
  size_t i = f->order[at], n_tri = f->frame->n_tri;

  return i < n_tri ? f->frame->tri_patch[i] : f->frame->quad_patch[i - n_tri];
}

void vg_fluent_seek_boundary(struct vg_output *out, const struct vg_fluent *f,
                             size_t at)
{
  size_t p = patch_of(f, at);

  assert(at < f->frame->n_tri + f->frame->n_quad);
  vg_output_seek(out, f->at_patch[p] +
                        (at - f->start[p]) * face_line(f, f->kind[p]));
}

void vg_fluent_put_boundary(struct vg_output *out, const struct vg_fluent *f,
                            size_t at, uint32_t cell)
{
  size_t i = f->order[at], n_tri = f->frame->n_tri;
  int is_tri = i < n_tri;

  assert(at < f->frame->n_tri + f->frame->n_quad);
  put_face(out, f, f->kind[patch_of(f, at)], is_tri ? 3 : 4,
           is_tri ? f->frame->tri[i] : f->frame->quad[i - n_tri],
           number_of(f, cell), 0);
}

/* --- the file ------------------------------------------------------------ */

static int digits(uint64_t n)
{
  int width = 1;

  while (n >>= 4) width++;
  return width;
}

static vg_status find_places(struct vg_fluent *f, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_shared(NULL, &out, err);

  if (st >= 0) put_all(&out, f, NULL, NULL);
  vg_output_release(&out);
  return st;
}

static vg_status check_counts(const char *path, const struct vg_fluent *f,
                              struct vg_error *err)
{
  uint64_t n_corner = 3 * (f->n_internal + f->frame->n_tri) + f->n_quad +
                      4 * (uint64_t)f->frame->n_quad;

  if (!f->n_cell)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the mesh has no cells; write the "
                   "surface as .stl",
                   path);
  if (n_corner > INT32_MAX || f->n_cell > INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: the faces have %llu vertices in total, which "
                   "exceeds the 32-bit labels of face-based formats",
                   path, (unsigned long long)n_corner);
  return VG_OK;
}

/* Words of the patches and, after them, of the sheets and zones. NULL: no
 * memory. */
static char (*make_words(const struct vg_mesh *m))[VG_PATCH_WORD]
{
  struct vg_mesh all = { .n_patch = m->n_patch + m->n_sheet + m->n_zone };
  struct vg_patch *zone;
  char(*word)[VG_PATCH_WORD] = NULL;

  all.patch = vg_calloc(all.n_patch, sizeof *all.patch);
  if (!all.patch) return NULL;
  if (m->n_patch) memcpy(all.patch, m->patch, m->n_patch * sizeof *m->patch);
  if (m->n_sheet)
    memcpy(all.patch + m->n_patch, m->sheet, m->n_sheet * sizeof *m->sheet);
  zone = all.patch + m->n_patch + m->n_sheet;
  for (size_t z = 0; z < m->n_zone; z++) {
    zone[z].id = m->zone[z].id;
    snprintf(zone[z].name, VG_NAME_MAX, *m->zone[z].name ? "%s" : "zone",
             m->zone[z].name);
  }
  word = vg_patch_words(&all, VG_PATCH_WORD_MOST);
  free(all.patch);
  return word;
}

/* Numbers the cells so that zones follow each other. */
static vg_status number_cells(struct vg_fluent *f, struct vg_error *err)
{
  const struct vg_mesh *m = f->frame;
  uint32_t next = 0;

  f->number = vg_alloc(f->n_cell, sizeof *f->number);
  f->zone = vg_alloc(f->n_cell, sizeof *f->zone);
  f->n_face = vg_calloc(2 * (m->n_zone + 1), sizeof *f->n_face);
  if (!f->number || !f->zone || !f->n_face)
    return vg_fail_memory(err, "the zones");
  for (uint32_t z = 0; z < m->n_zone; z++)
    for (int k = 0; k < VG_FLUENT_KINDS; k++) {
      const uint64_t first = f->first[k] + vg_mesh_zone_start(m, z, k);

      for (uint64_t c = first; c < first + m->zone[z].n_cell[k]; c++) {
        f->number[c] = next++;
        f->zone[c] = z;
      }
    }
  return VG_OK;
}

vg_status vg_fluent_plan(const char *path, const struct vg_mesh *frame,
                         uint64_t n_internal, uint64_t n_quad,
                         struct vg_fluent *f, struct vg_error *err)
{
  const size_t n[VG_FLUENT_KINDS] = { frame->n_tet, frame->n_pyr, frame->n_pri,
                                      frame->n_hex };
  vg_status st;

  *f = (struct vg_fluent){ .frame = frame,
                           .n_internal = n_internal,
                           .n_quad = n_quad };
  for (int k = 0; k < VG_FLUENT_KINDS; k++) {
    f->first[k] = f->n_cell;
    f->n_cell += n[k];
  }
  VG_TRY(check_counts(path, f, err));
  f->width = digits(f->n_cell > frame->n_point ? f->n_cell : frame->n_point);
  f->word = make_words(frame);
  f->at_patch = vg_calloc(frame->n_patch, sizeof *f->at_patch);
  f->kind = vg_calloc(frame->n_patch, sizeof *f->kind);
  if (!f->word || !f->at_patch || !f->kind)
    VG_TRY(vg_fail_memory(err, "the names of the patches"));
  VG_TRY(vg_boundary_by_patch(frame, &f->start, &f->order, err));
  for (size_t p = 0; p < frame->n_patch; p++) f->kind[p] = patch_kind(f, p);
  if (frame->n_zone) VG_TRY(number_cells(f, err));
  st = find_places(f, err);
done:
  if (st < 0) vg_fluent_release(f);
  return st;
}

void vg_fluent_release(struct vg_fluent *f)
{
  free(f->face_at);
  free(f->word);
  free(f->start);
  free(f->order);
  free(f->kind);
  free(f->at_patch);
  free(f->number);
  free(f->zone);
  free(f->n_face);
  memset(f, 0, sizeof *f);
}

vg_status vg_fluent_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err)
{
  struct vg_cell_links links = VG_CELL_LINKS_INIT;
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_fluent f = { .frame = NULL };
  struct sheet_faces sheets = { VG_SHEET_TABLE_INIT, NULL };
  uint64_t n_quad;
  vg_status st;

  VG_TRY(vg_sheet_table_new(&sheets.table, m, err));
  if (m->n_sheet_tri) {
    sheets.face = vg_calloc(m->n_sheet_tri, sizeof *sheets.face);
    if (!sheets.face) VG_TRY(vg_fail_memory(err, "the sheets"));
  }
  if (vg_mesh_n_cell(m)) VG_TRY(vg_foam_links(&links, m, path, err));
  n_quad = links.n_corner - 3 * (links.n_internal + m->n_tri) -
           4 * (uint64_t)m->n_quad;
  VG_TRY(vg_fluent_plan(path, m, links.n_internal, n_quad, &f, err));
  VG_TRY(vg_output_open(path, &out, err));
  put_all(&out, &f, &links, &sheets);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  vg_cell_links_release(&links);
  vg_fluent_release(&f);
  vg_sheet_table_release(&sheets.table);
  free(sheets.face);
  return st;
}
