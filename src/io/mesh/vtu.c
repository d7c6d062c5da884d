/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/mesh/vtu.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/sheets.h"
#include "io/mesh/vtu_put.h"
#include "io/stream/stream.h"

/* Elements of one kind. Slot k of the file is our node slot[k]. node is NULL if
 * others write the elements, as for points and for fields without data. */
struct block {
  const uint32_t *node;
  size_t n;
  int n_node;
  uint8_t type; /* VTK's type number */
  uint8_t slot[8];
};

#define END "\n </AppendedData>\n</VTKFile>\n"

/* Contents of a file: points (renumbered if `number` is set) and blocks. */
struct grid {
  size_t n_point, n_cell;
  const double (*point)[3];
  const uint32_t *list;   /* [n_point] points to write; NULL: all */
  const uint32_t *number; /* number of a point in the file; NULL: same */
  struct block block[4];
  int n_block;
  const struct vg_vtu_field *field;
  size_t n_field;
  const struct vg_mesh *patches; /* if not NULL, patch ids are added as cell
                                    data */
};

/* Our node order to VTK's, which differs for pyramid and wedge (formats.md
 * 2.3). */
#define PLAIN                                                                  \
  {                                                                            \
    0, 1, 2, 3, 4, 5, 6, 7                                                     \
  }
#define PYRAMID                                                                \
  {                                                                            \
    1, 0, 3, 4, 2                                                              \
  }
#define WEDGE                                                                  \
  {                                                                            \
    1, 0, 2, 4, 3, 5                                                           \
  }

static void add_block(struct grid *g, const uint32_t *node, size_t n,
                      const struct block *kind)
{
  if (!n) return;
  g->block[g->n_block] = *kind;
  g->block[g->n_block].node = node;
  g->block[g->n_block++].n = n;
  g->n_cell += n;
}

static const struct block triangle = { NULL, 0, 3, 5, PLAIN };
static const struct block quadrilateral = { NULL, 0, 4, 9, PLAIN };

static const struct block cells[4] = { /* in the order of VG_SLICE_TET, ... */
                                       { NULL, 0, 4, 10, PLAIN },
                                       { NULL, 0, 5, 14, PYRAMID },
                                       { NULL, 0, 6, 13, WEDGE },
                                       { NULL, 0, 8, 12, PLAIN }
};

static void add_cells(struct grid *g, const struct vg_mesh *m)
{
  add_block(g, m->tet ? m->tet[0] : NULL, m->n_tet, &cells[0]);
  add_block(g, m->pyr ? m->pyr[0] : NULL, m->n_pyr, &cells[1]);
  add_block(g, m->pri ? m->pri[0] : NULL, m->n_pri, &cells[2]);
  add_block(g, m->hex ? m->hex[0] : NULL, m->n_hex, &cells[3]);
}

/* --- header --- */

static const char *type_name(enum vg_vtu_type type)
{
  switch (type) {
  case VG_VTU_FLOAT32: return "Float32";
  case VG_VTU_INT32: return "Int32";
  default: return "Float64";
  }
}

static size_t type_size(enum vg_vtu_type type)
{
  return type == VG_VTU_FLOAT64 ? 8 : 4;
}

static int components(const struct vg_vtu_field *f)
{
  return f->n_component > 0 ? f->n_component : 1;
}

static uint64_t field_bytes(const struct grid *g, const struct vg_vtu_field *f)
{
  uint64_t n = f->place == VG_VTU_POINT ? g->n_point : g->n_cell;

  return n * (uint64_t)components(f) * type_size(f->type);
}

static uint64_t connectivity_bytes(const struct grid *g)
{
  uint64_t n = 0;

  for (int i = 0; i < g->n_block; i++)
    n += g->block[i].n * (uint64_t)g->block[i].n_node * 8;
  return n;
}

/* Declare an array of `bytes` bytes; *at becomes the offset of the next one. */
static void put_array(struct vg_output *o, const char *type, const char *name,
                      int n_component, uint64_t bytes, uint64_t *at)
{
  vg_output_format(o,
                   "    <DataArray type=\"%s\" Name=\"%s\" "
                   "NumberOfComponents=\"%d\" format=\"appended\" "
                   "offset=\"%llu\"/>\n",
                   type, name, n_component, (unsigned long long)*at);
  *at += 8 + bytes;
}

static void put_field_arrays(struct vg_output *o, const struct grid *g,
                             enum vg_vtu_place place, uint64_t *at)
{
  for (size_t i = 0; i < g->n_field; i++) {
    const struct vg_vtu_field *f = &g->field[i];

    if (f->place == place)
      put_array(o, type_name(f->type), f->name, components(f),
                field_bytes(g, f), at);
  }
}

static void put_header(struct vg_output *o, const struct grid *g)
{
  uint64_t at = 0;

  vg_output_format(o,
                   "<?xml version=\"1.0\"?>\n"
                   "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                   "byte_order=\"%s\" header_type=\"UInt64\">\n"
                   " <UnstructuredGrid>\n"
                   "  <Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n",
                   vg_host_is_little() ? "LittleEndian" : "BigEndian",
                   g->n_point, g->n_cell);
  vg_output_text(o, "   <Points>\n");
  put_array(o, "Float64", "Points", 3, 24 * (uint64_t)g->n_point, &at);
  vg_output_text(o, "   </Points>\n   <Cells>\n");
  put_array(o, "Int64", "connectivity", 1, connectivity_bytes(g), &at);
  put_array(o, "Int64", "offsets", 1, 8 * (uint64_t)g->n_cell, &at);
  put_array(o, "UInt8", "types", 1, g->n_cell, &at);
  vg_output_text(o, "   </Cells>\n   <PointData>\n");
  put_field_arrays(o, g, VG_VTU_POINT, &at);
  vg_output_text(o, "   </PointData>\n   <CellData>\n");
  if (g->patches)
    put_array(o, "Int32", "patch", 1, 4 * (uint64_t)g->n_cell, &at);
  put_field_arrays(o, g, VG_VTU_CELL, &at);
  vg_output_text(o, "   </CellData>\n  </Piece>\n </UnstructuredGrid>\n"
                    " <AppendedData encoding=\"raw\">\n_");
}

/* --- data, in the order in which the header declares them --- */

static void put_size(struct vg_output *o, uint64_t bytes)
{
  vg_output_bytes(o, &bytes, sizeof bytes);
}

static void put_points(struct vg_output *o, const struct grid *g)
{
  put_size(o, 24 * (uint64_t)g->n_point);
  if (!g->point) {
    vg_output_skip(o, 24 * (uint64_t)g->n_point);
    return;
  }
  if (!g->list) {
    if (g->n_point) vg_output_f64(o, 3 * g->n_point, g->point[0]);
    return;
  }
  for (size_t i = 0; i < g->n_point; i++)
    vg_output_f64(o, 3, g->point[g->list[i]]);
}

static void put_nodes(struct vg_output *o, const struct block *k,
                      const uint32_t *number, uint64_t add)
{
  const uint32_t *node = k->node;

  if (!node) {
    vg_output_skip(o, k->n * (uint64_t)k->n_node * 8);
    return;
  }
  for (size_t i = 0; i < k->n; i++, node += k->n_node) {
    int64_t v[8];

    for (int j = 0; j < k->n_node; j++) {
      uint32_t p = node[k->slot[j]];

      v[j] = (int64_t)(add + (number ? number[p] : p));
    }
    vg_output_bytes(o, v, (size_t)k->n_node * sizeof *v);
  }
}

static void put_connectivity(struct vg_output *o, const struct grid *g)
{
  put_size(o, connectivity_bytes(g));
  for (int b = 0; b < g->n_block; b++) put_nodes(o, &g->block[b], g->number, 0);
}

/* Write the end of each cell in the connectivity; *end: end of the previous
 * cell. */
static void put_ends(struct vg_output *o, const struct block *k, int64_t *end)
{
  for (size_t i = 0; i < k->n; i++) {
    *end += k->n_node;
    vg_output_bytes(o, end, sizeof *end);
  }
}

static void put_types(struct vg_output *o, const struct block *k)
{
  for (size_t i = 0; i < k->n; i++) vg_output_bytes(o, &k->type, 1);
}

static void put_offsets_types(struct vg_output *o, const struct grid *g)
{
  int64_t end = 0;

  put_size(o, 8 * (uint64_t)g->n_cell);
  for (int b = 0; b < g->n_block; b++)
    if (g->block[b].node) put_ends(o, &g->block[b], &end);
    else vg_output_skip(o, 8 * (uint64_t)g->block[b].n);
  put_size(o, g->n_cell);
  for (int b = 0; b < g->n_block; b++)
    if (g->block[b].node) put_types(o, &g->block[b]);
    else vg_output_skip(o, g->block[b].n);
}

static void put_patches(struct vg_output *o, const struct vg_mesh *m)
{
  put_size(o, 4 * ((uint64_t)m->n_tri + m->n_quad));
  for (size_t i = 0; i < m->n_tri; i++)
    vg_output_bytes(o, &m->patch[m->tri_patch[i]].id, 4);
  for (size_t i = 0; i < m->n_quad; i++)
    vg_output_bytes(o, &m->patch[m->quad_patch[i]].id, 4);
}

static void put_fields(struct vg_output *o, const struct grid *g,
                       enum vg_vtu_place place)
{
  for (size_t i = 0; i < g->n_field; i++) {
    const struct vg_vtu_field *f = &g->field[i];
    size_t size = (size_t)components(f) * type_size(f->type);
    const unsigned char *data = f->data;

    if (f->place != place) continue;
    put_size(o, field_bytes(g, f));
    if (!data) vg_output_skip(o, field_bytes(g, f));
    else if (place == VG_VTU_POINT && g->list)
      for (size_t p = 0; p < g->n_point; p++)
        vg_output_bytes(o, data + g->list[p] * size, size);
    else if (field_bytes(g, f)) vg_output_bytes(o, data, field_bytes(g, f));
  }
}

static vg_status check_names(const struct grid *g, struct vg_error *err)
{
  for (size_t i = 0; i < g->n_field; i++) {
    const char *name = g->field[i].name;
    int bad = !name || !*name || strlen(name) > 200;

    for (; !bad && *name; name++)
      bad = (unsigned char)*name < 32 || strchr("<>&\"'", *name) != NULL;
    if (bad)
      return vg_fail(err, VG_ERR_INPUT,
                     "the name of field %zu of a VTU file contains "
                     "characters that are not allowed in XML",
                     i + 1);
  }
  return VG_OK;
}

static void put_grid(struct vg_output *o, const struct grid *g)
{
  put_header(o, g);
  put_points(o, g);
  put_connectivity(o, g);
  put_offsets_types(o, g);
  put_fields(o, g, VG_VTU_POINT);
  if (g->patches) put_patches(o, g->patches);
  put_fields(o, g, VG_VTU_CELL);
  vg_output_text(o, END);
}

static vg_status write_grid(const char *path, const struct grid *g,
                            struct vg_error *err)
{
  struct vg_output o = VG_OUTPUT_INIT;
  vg_status st;

  VG_TRY(check_names(g, err));
  VG_TRY(vg_output_open(path, &o, err));
  put_grid(&o, g);
  st = vg_output_commit(&o, err);
done:
  vg_output_release(&o);
  return st;
}

/* --- parts, for meshes in slices --- */

void vg_vtu_put(struct vg_output *out, const struct vg_mesh *frame,
                const struct vg_vtu_field *field, size_t n)
{
  struct grid g = { .n_point = frame->n_point,
                    .point = (const double(*)[3])frame->point,
                    .field = field,
                    .n_field = n };

  assert((field || !n) && n <= VG_VTU_FIELDS_MAX);
  add_cells(&g, frame);
  put_grid(out, &g);
}

void vg_vtu_find(const struct vg_mesh *frame, uint64_t file_size,
                 const struct vg_vtu_field *field, size_t n,
                 struct vg_vtu_places *to)
{
  struct grid g = { .n_point = frame->n_point, .field = field, .n_field = n };
  uint64_t at = file_size - strlen(END);

  assert((field || !n) && n <= VG_VTU_FIELDS_MAX);
  add_cells(&g, frame);
  for (size_t i = n; i-- > 0;) {
    at -= field_bytes(&g, &field[i]);
    to->field[i] = at;
    at -= 8;
  }
  to->types = at -= g.n_cell;
  to->offsets = at -= 8 + 8 * (uint64_t)g.n_cell;
  to->connectivity = at -= 8 + connectivity_bytes(&g);
  to->points = at -= 8 + 24 * (uint64_t)g.n_point;
}

void vg_vtu_put_cells(struct vg_output *out, const struct vg_vtu_places *at,
                      const struct vg_vtu_cells *c)
{
  struct block b = cells[c->kind];
  int64_t end = (int64_t)c->first_node;

  assert(c->kind >= 0 && (size_t)c->kind < sizeof cells / sizeof *cells);
  assert(c->node || !c->n);
  b.node = c->node;
  b.n = c->n;
  vg_output_seek(out, at->connectivity + 8 * c->first_node);
  put_nodes(out, &b, c->number, c->add);
  vg_output_seek(out, at->offsets + 8 * c->first);
  put_ends(out, &b, &end);
  vg_output_seek(out, at->types + c->first);
  put_types(out, &b);
}

/* --- public functions --- */

vg_status vg_vtu_write(const char *path, const struct vg_mesh *m,
                       const struct vg_vtu_field *fields, size_t n,
                       struct vg_error *err)
{
  struct grid g = { .n_point = m->n_point,
                    .point = (const double(*)[3])m->point,
                    .field = fields,
                    .n_field = n };

  assert(fields || !n);
  add_cells(&g, m);
  if (!g.n_cell) return vg_vtu_write_boundary(path, m, fields, n, err);
  return write_grid(path, &g, err);
}

/* Number the points that the boundary uses, in their order in the mesh. */
static vg_status number_points(const struct vg_mesh *m, uint32_t **list,
                               uint32_t **number, size_t *n,
                               struct vg_error *err)
{
  uint32_t *to = vg_calloc(m->n_point, sizeof *to), *from = NULL;
  size_t used = 0;

  if (to) {
    for (size_t i = 0; i < m->n_tri; i++)
      for (int k = 0; k < 3; k++) to[m->tri[i][k]] = 1;
    for (size_t i = 0; i < m->n_quad; i++)
      for (int k = 0; k < 4; k++) to[m->quad[i][k]] = 1;
    for (size_t i = 0; i < m->n_point; i++) used += to[i];
    from = vg_alloc(used, sizeof *from);
  }
  if (!from) {
    free(to);
    return vg_fail_memory(err, "numbering the boundary points");
  }
  used = 0;
  for (size_t i = 0; i < m->n_point; i++)
    if (to[i]) {
      from[used] = (uint32_t)i;
      to[i] = (uint32_t)used++;
    }
  *list = from;
  *number = to;
  *n = used;
  return VG_OK;
}

static vg_status write_boundary(const char *path, const struct vg_mesh *m,
                                const struct vg_vtu_field *fields, size_t n,
                                struct vg_error *err)
{
  struct grid g = { .point = (const double(*)[3])m->point,
                    .field = fields,
                    .n_field = n,
                    .patches = m->n_patch ? m : NULL };
  uint32_t *list = NULL, *number = NULL;
  vg_status st = number_points(m, &list, &number, &g.n_point, err);

  if (st < 0) return st;
  g.list = list;
  g.number = number;
  add_block(&g, m->tri ? m->tri[0] : NULL, m->n_tri, &triangle);
  add_block(&g, m->quad ? m->quad[0] : NULL, m->n_quad, &quadrilateral);
  st = write_grid(path, &g, err);
  free(list);
  free(number);
  return st;
}

vg_status vg_vtu_write_boundary(const char *path, const struct vg_mesh *m,
                                const struct vg_vtu_field *fields, size_t n,
                                struct vg_error *err)
{
  struct vg_mesh view;
  vg_status st;

  assert((fields || !n) && (!n || !m->n_sheet));
  st = vg_mesh_sheet_view(m, &view, err);
  if (st >= 0) st = write_boundary(path, &view, fields, n, err);
  vg_mesh_sheet_view_release(&view, m);
  return st;
}

vg_status vg_vtu_write_triangles(const char *path, size_t n_point,
                                 const double (*point)[3], size_t n_tri,
                                 const uint32_t (*tri)[3],
                                 const struct vg_vtu_field *fields, size_t n,
                                 struct vg_error *err)
{
  struct grid g = {
    .n_point = n_point, .point = point, .field = fields, .n_field = n
  };

  assert((point || !n_point) && (tri || !n_tri) && (fields || !n));
  add_block(&g, n_tri ? tri[0] : NULL, n_tri, &triangle);
  return write_grid(path, &g, err);
}
