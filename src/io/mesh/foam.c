/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The files of an OpenFOAM mesh; see io/mesh/foam.h and formats.md 4.3. A
 * list is either text, one item per line, or its length, '(', the bytes and
 * ')'. Binary faces are two lists of labels: where each face starts, and the
 * nodes of all faces. */
#include "io/mesh/foam.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "core/mesh/cell_links.h"
#include "core/mesh/sheets.h"
#include "core/mesh/zones.h"
#include "core/geometry/vector.h"
#include "io/mesh/foam_parts.h"
#include "io/stream/patch_words.h"
#include "io/stream/boundary.h"
#include "io/stream/stream.h"
#include "io/vgrid/mapbc.h"

int vg_foam_word(const char *word, struct vg_foam_options *options)
{
  int is_ascii = !strcasecmp(word, "foam-ascii");

  if (!is_ascii && strcasecmp(word, "foam") &&
      strcasecmp(word, VG_FOAM_SUFFIX) != 0)
    return 0;
  options->is_ascii = is_ascii;
  return 1;
}

/* --- patches --- */

/* OpenFOAM's type of a patch, from its boundary condition; is_planar: all its
 * faces lie in one plane. Viscous and inviscid walls are walls; "symmetry" also
 * stands for other slip surfaces. *physical is the physical type, or "". */
static const char *patch_type(const struct vg_patch *p, int is_planar,
                              const char **physical)
{
  static const struct {
    int32_t code;
    const char *type, *physical;
  } known[] = {
    { 4, "wall", "viscousWall" },   { 41, "wall", "viscousWall" },
    { 44, "wall", "viscousWall" },  { 5, "wall", "inviscidWall" },
    { 55, "wall", "inviscidWall" }, { 1, "symmetry", "symmetry" },
    { 3, "patch", "farfield" },     { 0, "patch", "inflow" },
    { 2, "patch", "outflow" },      { 1001, "patch", "inflow" },
    { 1002, "patch", "outflow" },   { 11002, "patch", "outflow" },
    { 11003, "patch", "outflow" },  { 101, "patch", "outflow" },
    { 102, "patch", "inflow" },     { 103, "patch", "inflow" },
  };
  int32_t code = p->bc;

  *physical = "";
  if (code == VG_BC_NONE && p->bc_fun3d != VG_BC_NONE)
    code = vg_bc_to_usm3d(p->bc_fun3d);
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    if (known[i].code != code) continue;
    *physical = known[i].physical;
    return code == 1 && is_planar ? "symmetryPlane" : known[i].type;
  }
  return "patch";
}

static int is_symmetry(const struct vg_patch *p)
{
  return p->bc == 1 || (p->bc == VG_BC_NONE && p->bc_fun3d != VG_BC_NONE &&
                        vg_bc_to_usm3d(p->bc_fun3d) == 1);
}

/* Whether a mesh is one cell thick, for a flow in two dimensions: each cell is
 * a prism or a hexahedron with a face in each of the only two symmetry planes.
 */
static int is_thin(const struct vg_mesh *m)
{
  size_t patch[2], n_patch = 0, n_tri[2] = { 0, 0 }, n_quad[2] = { 0, 0 };

  if (m->n_tet || m->n_pyr) return 0;
  for (size_t p = 0; p < m->n_patch; p++) {
    if (!is_symmetry(&m->patch[p])) continue;
    if (n_patch == 2) return 0;
    patch[n_patch++] = p;
  }
  if (n_patch < 2) return 0;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 2; k++) n_tri[k] += m->tri_patch[i] == patch[k];
  for (size_t i = 0; i < m->n_quad; i++)
    for (int k = 0; k < 2; k++) n_quad[k] += m->quad_patch[i] == patch[k];
  return n_tri[0] == m->n_pri && n_tri[1] == m->n_pri &&
         n_quad[0] == m->n_hex && n_quad[1] == m->n_hex;
}

static const uint32_t *boundary_nodes(const struct vg_mesh *m, size_t face)
{
  return face < m->n_tri ? m->tri[face] : m->quad[face - m->n_tri];
}

/* Unit normal, zero for a face without area. For a triangle, the cross product
 * of the diagonals is that of two sides. */
static void unit_normal(const struct vg_mesh *m, size_t face, double n[3])
{
  const uint32_t *node = boundary_nodes(m, face);
  const double *a = m->point[node[0]], *c = m->point[node[2]];
  const double *b = m->point[node[1]];
  const double *d = face < m->n_tri ? a : m->point[node[3]];
  double u[3], v[3];

  vg_sub(c, a, u);
  vg_sub(d, b, v);
  vg_cross(u, v, n);
  if (!(vg_unit(n) > 0)) memset(n, 0, 3 * sizeof *n);
}

/* OpenFOAM rejects a symmetryPlane if the squared difference between the normal
 * of a face and the mean normal exceeds 1e-15; we require a tenth of that. */
static int is_planar(const struct vg_mesh *m, const size_t *face, size_t n)
{
  double mean[3] = { 0, 0, 0 }, one[3];

  for (size_t i = 0; i < n; i++) {
    unit_normal(m, face[i], one);
    for (int k = 0; k < 3; k++) mean[k] += one[k];
  }
  for (int k = 0; k < 3; k++) mean[k] /= n ? (double)n : 1;
  for (size_t i = 0; i < n; i++) {
    double square = 0;

    unit_normal(m, face[i], one);
    for (int k = 0; k < 3; k++)
      square += (one[k] - mean[k]) * (one[k] - mean[k]);
    if (!(square < 1e-16)) return 0;
  }
  return 1;
}

/* --- faces --- */

int vg_foam_upper(const struct vg_cell_links *f, uint32_t cell,
                  uint32_t code[6], uint32_t neighbour[6])
{
  size_t at = vg_first_half(f, cell);
  int n_face = vg_half_faces(f, cell), n = 0;

  for (int i = 0; i < n_face; i++) {
    uint32_t mate = f->link[at + (size_t)i];
    int k = n;

    if (mate == VG_NO_CELL || mate >> 3 <= cell) continue;
    for (; k > 0 && neighbour[k - 1] > mate >> 3; k--) {
      code[k] = code[k - 1];
      neighbour[k] = neighbour[k - 1];
    }
    code[k] = cell << 3 | (uint32_t)i;
    neighbour[k] = mate >> 3;
    n++;
  }
  return n;
}

vg_status vg_foam_links(struct vg_cell_links *f, const struct vg_mesh *m,
                        const char *name, struct vg_error *err)
{
  vg_status st = vg_cell_links_build(f, m, 0, name, err);

  if (st < 0 || f->n_corner <= INT32_MAX) return st;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: the faces have %llu vertices in total, which exceeds "
                 "the 32-bit labels of face-based formats",
                 name, (unsigned long long)f->n_corner);
}

/* --- lists --- */

enum { BUFFER = 4096 };

struct labels {
  struct vg_output *out;
  int is_ascii;
  size_t n;
  int32_t v[BUFFER];
};

static void flush_labels(struct labels *l)
{
  vg_output_i32(l->out, l->n, l->v);
  l->n = 0;
}

static inline void put_label(struct labels *l, uint32_t v)
{
  if (l->is_ascii) {
    vg_output_int(l->out, v);
    vg_output_bytes(l->out, "\n", 1);
    return;
  }
  if (l->n == BUFFER) flush_labels(l);
  l->v[l->n++] = (int32_t)v;
}

static void open_list(struct labels *l, uint64_t n)
{
  vg_output_format(l->out, l->is_ascii ? "\n%llu\n(\n" : "\n%llu\n(",
                   (unsigned long long)n);
}

static void close_list(struct labels *l)
{
  flush_labels(l);
  vg_output_text(l->out, ")\n");
}

/* first: node at which the list begins; VG_PERIODIC_NONE: as it is. */
static void put_face(struct labels *l, const struct vg_cell_links *f,
                     uint32_t code, uint32_t first)
{
  uint32_t face[4], node[4];
  int width = vg_half_face_nodes(f, code, face), at = 0;

  while (first != VG_PERIODIC_NONE && at + 1 < width && face[at] != first) at++;
  for (int k = 0; k < width; k++) node[k] = face[(at + k) % width];
  if (!l->is_ascii) {
    for (int k = 0; k < width; k++) put_label(l, node[k]);
    return;
  }
  vg_output_bytes(l->out, width == 3 ? "3(" : "4(", 2);
  for (int k = 0; k < width; k++) {
    if (k) vg_output_bytes(l->out, " ", 1);
    vg_output_int(l->out, node[k]);
  }
  vg_output_bytes(l->out, ")\n", 2);
}

/* --- the files --- */

struct writing {
  const struct vg_mesh *m;
  struct vg_cell_links faces;
  size_t *start, *order; /* boundary faces by patch */
  uint32_t *first;       /* [boundary face] node at which a face of a periodic
                            image begins; NULL: no face is in one */
  const struct vg_foam_options *options; /* may be NULL */
  const char *folder;
  int is_ascii;
  char note[160];
  struct vg_output out[VG_FOAM_FILES];
};
enum { POINTS, FACES, OWNER, NEIGHBOUR, BOUNDARY };

static const char location[] = "constant/polyMesh";

static void put_points(struct writing *w)
{
  struct vg_output *o = w->out + POINTS;
  const struct vg_mesh *m = w->m;

  vg_foam_header(o, "vectorField", location, "points", w->is_ascii, NULL);
  vg_output_format(o, "\n%zu\n(", m->n_point);
  if (!w->is_ascii) {
    vg_output_f64(o, 3 * m->n_point, (const double *)m->point);
  } else {
    for (size_t i = 0; i < m->n_point; i++)
      for (int k = 0; k < 3; k++) {
        vg_output_text(o, k ? " " : "\n(");
        vg_output_real(o, m->point[i][k]);
        if (k == 2) vg_output_bytes(o, ")", 1);
      }
    vg_output_bytes(o, "\n", 1);
  }
  vg_output_text(o, ")\n");
}

/* Write owners and neighbours and, for a binary mesh, where each face
 * starts. */
static void put_cells(struct writing *w, struct labels l[3])
{
  const struct vg_cell_links *f = &w->faces;
  uint64_t n_boundary = w->m->n_tri + w->m->n_quad;
  uint32_t code[6], neighbour[6], node[4], at = 0;

  for (int i = 0; i < 3; i++) {
    l[i].out = w->out + FACES + i;
    l[i].is_ascii = w->is_ascii;
    l[i].n = 0;
  }
  open_list(l + 1, f->n_internal + n_boundary);
  open_list(l + 2, f->n_internal);
  if (!w->is_ascii) open_list(l, f->n_internal + n_boundary + 1);
  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    int n = vg_foam_upper(f, cell, code, neighbour);

    for (int i = 0; i < n; i++) {
      put_label(l + 1, cell);
      put_label(l + 2, neighbour[i]);
      if (w->is_ascii) continue;
      put_label(l, at);
      at += (uint32_t)vg_half_face_nodes(f, code[i], node);
    }
  }
  for (size_t i = 0; i < n_boundary; i++) {
    put_label(l + 1, f->boundary[w->order[i]] >> 3);
    if (w->is_ascii) continue;
    put_label(l, at);
    at += w->order[i] < w->m->n_tri ? 3 : 4;
  }
  close_list(l + 1);
  close_list(l + 2);
  if (w->is_ascii) return;
  put_label(l, at);
  close_list(l);
}

static void put_faces(struct writing *w, struct labels *l)
{
  const struct vg_cell_links *f = &w->faces;
  uint64_t n_boundary = w->m->n_tri + w->m->n_quad;
  uint32_t code[6], neighbour[6];

  open_list(l, w->is_ascii ? f->n_internal + n_boundary : f->n_corner);
  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    int n = vg_foam_upper(f, cell, code, neighbour);

    for (int i = 0; i < n; i++) put_face(l, f, code[i], VG_PERIODIC_NONE);
  }
  for (size_t i = 0; i < n_boundary; i++)
    put_face(l, f, f->boundary[w->order[i]],
             w->first ? w->first[w->order[i]] : VG_PERIODIC_NONE);
  close_list(l);
}

static vg_status put_topology(struct writing *w, struct vg_error *err)
{
  struct labels *l = vg_alloc(3, sizeof *l);

  if (!l) return vg_fail_memory(err, "writing an OpenFOAM mesh");
  vg_foam_header(w->out + FACES, w->is_ascii ? "faceList" : "faceCompactList",
                 location, "faces", w->is_ascii, NULL);
  vg_foam_header(w->out + OWNER, "labelList", location, "owner", w->is_ascii,
                 w->note);
  vg_foam_header(w->out + NEIGHBOUR, "labelList", location, "neighbour",
                 w->is_ascii, w->note);
  put_cells(w, l);
  put_faces(w, l);
  free(l);
  return VG_OK;
}

/* The pair of a patch; NULL: it has none. *other: the number of its partner */
static const struct vg_periodic *pair_of(const struct writing *w, int32_t id,
                                         int32_t *other)
{
  for (size_t i = 0; w->options && i < w->options->n_periodic; i++) {
    const struct vg_periodic *p = &w->options->periodic[i];

    *other = p->patch == id ? p->image : p->patch;
    if (p->patch == id || p->image == id) return p;
  }
  return NULL;
}

/* OpenFOAM ignores the sign of a translation's vector in comparisons of
 * patches, and the vector of the image is the reverse. */
static void put_cyclic(struct vg_output *o, const struct vg_periodic *p,
                       int is_image, const char *other)
{
  const double *v = p->is_rotation ? p->axis : p->shift;
  double x[3];

  for (int k = 0; k < 3; k++)
    x[k] = is_image && !p->is_rotation ? 0 - v[k] : v[k];
  vg_output_format(o,
                   "        neighbourPatch  %s;\n        transform       %s;\n"
                   "        %s (%.17g %.17g %.17g);\n",
                   other, p->is_rotation ? "rotational" : "translational",
                   p->is_rotation ? "rotationAxis   " : "separationVector",
                   x[0], x[1], x[2]);
  if (p->is_rotation)
    vg_output_format(o, "        rotationCentre  (%.17g %.17g %.17g);\n",
                     p->centre[0], p->centre[1], p->centre[2]);
}

/* A side of an interface: solvers interpolate between both. */
static void put_sliding(struct vg_output *o, const char *other)
{
  vg_output_format(o,
                   "        neighbourPatch  %s;\n"
                   "        transform       noOrdering;\n"
                   "        matchTolerance  0.0001;\n",
                   other);
}

static vg_status put_boundary(struct writing *w, struct vg_error *err)
{
  struct vg_output *o = w->out + BOUNDARY;
  char(*name)[VG_PATCH_WORD] = vg_patch_words(w->m, VG_PATCH_WORD_MOST);
  const int thin = is_thin(w->m);

  if (!name) return vg_fail_memory(err, "the names of the patches");
  vg_foam_header(o, "polyBoundaryMesh", location, "boundary", 1, NULL);
  vg_output_format(o, "\n%zu\n(\n", w->m->n_patch);
  for (size_t i = 0; i < w->m->n_patch; i++) {
    size_t first = w->start[i], n = w->start[i + 1] - first;
    int32_t other = 0;
    const struct vg_periodic *pair = pair_of(w, w->m->patch[i].id, &other);
    const char *physical,
      *type = patch_type(w->m->patch + i, is_planar(w->m, w->order + first, n),
                         &physical);

    if (thin && is_symmetry(w->m->patch + i)) type = physical = "empty";
    if (pair || vg_patch_is_sliding(&w->m->patch[i])) {
      type = pair ? "cyclic" : "cyclicAMI";
      physical = "";
    }
    vg_output_format(o, "    %s\n    {\n        type            %s;\n", name[i],
                     type);
    if (*physical)
      vg_output_format(o, "        physicalType    %s;\n", physical);
    if (pair)
      put_cyclic(o, pair, other == pair->patch,
                 name[vg_mesh_find_patch(w->m, other)]);
    else if (vg_patch_is_sliding(&w->m->patch[i]))
      put_sliding(o,
                  name[w->m->patch[i].inner == VG_INNER_FRONT ? i + 1 : i - 1]);
    vg_output_format(o,
                     "        nFaces          %zu;\n"
                     "        startFace       %llu;\n    }\n",
                     n, (unsigned long long)(w->faces.n_internal + first));
  }
  vg_output_text(o, ")\n");
  free(name);
  return VG_OK;
}

/* A face between cells that is in a sheet. */
struct zone_face {
  int32_t label;
  int is_flipped; /* 1: from the neighbour to the owner, against the sheet */
};

/* Finds the face of each triangle of the sheets: [n_sheet_tri] */
static void find_zones(const struct writing *w, const struct vg_sheet_table *t,
                       struct zone_face *face)
{
  const struct vg_cell_links *f = &w->faces;
  uint32_t code[6], neighbour[6], node[4];
  int32_t label = 0;
  int is_same;

  for (uint32_t cell = 0; cell < f->n_cell; cell++) {
    const int n = vg_foam_upper(f, cell, code, neighbour);

    for (int i = 0; i < n; i++, label++) {
      uint32_t at = UINT32_MAX;

      if (vg_half_face_nodes(f, code[i], node) == 3)
        at = vg_sheet_table_find(t, node, &is_same);
      if (at != UINT32_MAX) face[at] = (struct zone_face){ label, !is_same };
    }
  }
}

static void put_zone(struct vg_output *o, const struct vg_mesh *m, size_t i,
                     const struct zone_face *face)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_sheet_tri; t++) n += m->sheet_of[t] == i;
  for (int flip = 0; flip < 2; flip++) {
    vg_output_format(o,
                     flip ? "        flipMap         List<bool>\n%zu\n(\n"
                          : "        faceLabels      List<label>\n%zu\n(\n",
                     n);
    for (size_t t = 0; t < m->n_sheet_tri; t++) {
      if (m->sheet_of[t] != i) continue;
      vg_output_int(o, flip ? face[t].is_flipped : face[t].label);
      vg_output_bytes(o, "\n", 1);
    }
    vg_output_text(o, ")\n;\n");
  }
}

/* Sheets are zones of faces, whose normals are those of the sheets. Names that
 * patches have too are allowed. */
static vg_status put_zones(const struct writing *w, struct vg_output *o,
                           struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  const struct vg_mesh as_patches = { .n_patch = m->n_sheet,
                                      .patch = m->sheet };
  struct vg_sheet_table table = VG_SHEET_TABLE_INIT;
  char(*name)[VG_PATCH_WORD] = vg_patch_words(&as_patches, VG_PATCH_WORD_MOST);
  struct zone_face *face = vg_alloc(m->n_sheet_tri, sizeof *face);
  vg_status st = name && face ? vg_sheet_table_new(&table, m, err)
                              : vg_fail_memory(err, "the sheets");

  VG_TRY(st);
  find_zones(w, &table, face);
  vg_foam_header(o, "regIOobject", location, VG_FOAM_ZONES, 1, NULL);
  vg_output_format(o, "\n%zu\n(\n", m->n_sheet);
  for (size_t i = 0; i < m->n_sheet; i++) {
    vg_output_format(o, "    %s\n    {\n        type            faceZone;\n",
                     name[i]);
    put_zone(o, m, i, face);
    vg_output_text(o, "    }\n");
  }
  vg_output_text(o, ")\n");
done:
  vg_sheet_table_release(&table);
  free(name);
  free(face);
  return st;
}

/* Cells have the numbers of the mesh, kind after kind. */
static void put_cell_labels(struct vg_output *o, const struct vg_mesh *m,
                            size_t z)
{
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  uint64_t before = 0;

  vg_output_format(o, "        cellLabels      List<label>\n%llu\n(\n",
                   (unsigned long long)vg_mesh_zone_cells(m, z));
  for (int k = 0; k < VG_ZONE_KINDS; before += n[k++]) {
    const uint64_t first = before + vg_mesh_zone_start(m, z, k);

    for (uint64_t c = 0; c < m->zone[z].n_cell[k]; c++) {
      vg_output_int(o, (int64_t)(first + c));
      vg_output_bytes(o, "\n", 1);
    }
  }
  vg_output_text(o, ")\n;\n");
}

static vg_status put_cell_zones(const struct writing *w, struct vg_output *o,
                                struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  char(*name)[VG_PATCH_WORD] = vg_zone_words(m, VG_PATCH_WORD_MOST);

  if (!name) return vg_fail_memory(err, "the zones");
  vg_foam_header(o, "regIOobject", location, VG_FOAM_CELL_ZONES, 1, NULL);
  vg_output_format(o, "\n%zu\n(\n", m->n_zone);
  for (size_t z = 0; z < m->n_zone; z++) {
    vg_output_format(o, "    %s\n    {\n        type            cellZone;\n",
                     name[z]);
    put_cell_labels(o, m, z);
    vg_output_text(o, "    }\n");
  }
  vg_output_text(o, ")\n");
  free(name);
  return VG_OK;
}

/* Writes a file of zones with `put`. */
static vg_status write_zones(const struct writing *w, const char *name,
                             vg_status (*put)(const struct writing *w,
                                              struct vg_output *o,
                                              struct vg_error *err),
                             struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = vg_foam_path(w->folder, name);
  vg_status st = path ? vg_output_open(path, &out, err)
                      : vg_fail_memory(err, "a file name");

  if (st >= 0) st = put(w, &out, err);
  if (st >= 0) st = vg_output_commit(&out, err);
  vg_output_release(&out);
  free(path);
  return st;
}

/* Write all files completely into w->folder. */
static vg_status put_mesh(struct writing *w, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (int i = 0; i < VG_FOAM_FILES; i++) {
    char *path = vg_foam_path(w->folder, vg_foam_file[i]);

    st = path ? vg_output_open(path, w->out + i, err)
              : vg_fail_memory(err, "a file name");
    free(path);
    if (st < 0) return st;
  }
  snprintf(w->note, sizeof w->note,
           "nPoints:%zu  nCells:%u  nFaces:%llu  nInternalFaces:%llu",
           w->m->n_point, w->faces.n_cell,
           (unsigned long long)(w->faces.n_internal + w->m->n_tri +
                                w->m->n_quad),
           (unsigned long long)w->faces.n_internal);
  put_points(w);
  if ((st = put_topology(w, err)) < 0) return st;
  if ((st = put_boundary(w, err)) < 0) return st;
  if (w->m->n_sheet && (st = write_zones(w, VG_FOAM_ZONES, put_zones, err)) < 0)
    return st;
  if (w->m->n_zone &&
      (st = write_zones(w, VG_FOAM_CELL_ZONES, put_cell_zones, err)) < 0)
    return st;
  for (int i = 0; i < VG_FOAM_FILES; i++)
    if ((st = vg_output_commit(w->out + i, err)) < 0) return st;
  return VG_OK;
}

/* Puts the faces of the image of a pair in the order of their partners, and
 * lets each begin at the partner of the first node. */
static vg_status order_pair(struct writing *w, const struct vg_periodic *p,
                            const char *name, struct vg_error *err)
{
  const size_t a = vg_mesh_find_patch(w->m, p->patch);
  const size_t b = vg_mesh_find_patch(w->m, p->image);
  struct vg_periodic_match r = VG_PERIODIC_MATCH_INIT;
  uint32_t node[4];
  vg_status st;

  VG_TRY(
    vg_periodic_match(w->m, p, 1e-5 * vg_periodic_extent(w->m, p), &r, err));
  if (!vg_periodic_matches(&r))
    VG_TRY(vg_fail(err, VG_ERR_INPUT,
                   "%s: the faces of the periodic patches %d and %d do not "
                   "match",
                   name, (int)p->patch, (int)p->image));
  for (size_t i = 0; i < r.n_face[0]; i++) {
    const size_t face = w->order[w->start[a] + i];
    const uint32_t other = r.face[face];

    w->order[w->start[b] + i] = other;
    vg_half_face_nodes(&w->faces, w->faces.boundary[face], node);
    w->first[other] = r.point[node[0]];
  }
done:
  vg_periodic_match_release(&r);
  return st;
}

static vg_status order_periodic(struct writing *w, const char *name,
                                struct vg_error *err)
{
  const size_t n = w->m->n_tri + w->m->n_quad;
  vg_status st = VG_OK;

  if (!w->options || !w->options->n_periodic) return VG_OK;
  w->first = vg_alloc(n, sizeof *w->first);
  if (!w->first) return vg_fail_memory(err, "the periodic patches");
  memset(w->first, 0xff, n * sizeof *w->first);
  for (size_t i = 0; i < w->options->n_periodic && st >= 0; i++)
    st = order_pair(w, &w->options->periodic[i], name, err);
  return st;
}

static void remove_mesh(const char *folder)
{
  for (int i = 0; i < VG_FOAM_FILES + 2; i++) {
    char *path = vg_foam_path(folder, i < VG_FOAM_FILES ? vg_foam_file[i]
                                      : i == VG_FOAM_FILES
                                        ? VG_FOAM_ZONES
                                        : VG_FOAM_CELL_ZONES);

    if (path) unlink(path);
    free(path);
  }
  rmdir(folder);
}

static vg_status write_into(const char *case_dir, const char *constant,
                            struct writing *w, struct vg_error *err)
{
  char *mesh = vg_foam_path(constant, "polyMesh");
  vg_status st;

  if (!mesh) return vg_fail_memory(err, "a file name");
  VG_TRY(vg_foam_folder(case_dir, err));
  VG_TRY(vg_foam_folder(constant, err));
  if (mkdir(mesh, 0777))
    VG_TRY(vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", mesh,
                   strerror(errno)));
  w->folder = mesh;
  st = put_mesh(w, err);
  for (int i = 0; i < VG_FOAM_FILES; i++) vg_output_release(w->out + i);
  if (st == VG_OK) st = vg_foam_surroundings(case_dir, err);
  if (st < 0) remove_mesh(mesh);
done:
  free(mesh);
  return st;
}

vg_status vg_foam_write(const char *case_dir, const struct vg_mesh *m,
                        const struct vg_foam_options *options,
                        struct vg_error *err)
{
  const struct vg_output none = VG_OUTPUT_INIT;
  struct writing w = { .m = m,
                       .faces = VG_CELL_LINKS_INIT,
                       .is_ascii = options && options->is_ascii,
                       .options = options };
  char *constant = vg_foam_path(case_dir, "constant");
  vg_status st;

  for (int i = 0; i < VG_FOAM_FILES; i++) w.out[i] = none;
  if (!constant) return vg_fail_memory(err, "a file name");
  if (!vg_mesh_n_cell(m)) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: a mesh without cells cannot be an OpenFOAM case; "
                 "write the surface as .stl",
                 case_dir);
    goto done;
  }
  VG_TRY(vg_boundary_by_patch(m, &w.start, &w.order, err));
  VG_TRY(vg_foam_links(&w.faces, m, case_dir, err));
  VG_TRY(order_periodic(&w, case_dir, err));
  st = write_into(case_dir, constant, &w, err);
  if (st < 0) {
    /* Remove the folders if they are empty. */
    rmdir(constant);
    rmdir(case_dir);
  }
done:
  vg_cell_links_release(&w.faces);
  free(w.start);
  free(w.order);
  free(w.first);
  free(constant);
  return st;
}
