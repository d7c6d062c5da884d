/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/sheet_file.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/zones.h"
#include "io/stream/convention.h"
#include "io/stream/stream.h"

#define TITLE "# Vanguard sheets 1"

/* --- write ---------------------------------------------------------------- */

static void put_sheet(struct vg_output *out, const struct vg_mesh *m, size_t i)
{
  const struct vg_patch *p = &m->sheet[i];
  size_t n = 0;

  for (size_t t = 0; t < m->n_sheet_tri; t++) n += m->sheet_of[t] == i;
  vg_output_format(out, "%s %d %zu%s%s\n",
                   p->is_interface ? "interface" : "sheet", (int)p->id, n,
                   *p->name ? " " : "", p->name);
  for (size_t t = 0; t < m->n_sheet_tri; t++)
    for (int k = 0; k < 3 && m->sheet_of[t] == i; k++) {
      vg_output_int(out, (int64_t)m->sheet_tri[t][k] + 1);
      vg_output_text(out, k < 2 ? " " : "\n");
    }
}

static void put_zone(struct vg_output *out, const struct vg_zone *z)
{
  vg_output_format(out, "zone %d %s", (int)z->id, vg_zone_kind_word[z->kind]);
  for (int k = 0; k < VG_ZONE_KINDS; k++)
    vg_output_format(out, " %" PRIu64, z->n_cell[k]);
  vg_output_format(out, "%s%s\n", *z->name ? " " : "", z->name);
}

vg_status vg_sheet_file_write(const char *path, const struct vg_mesh *m,
                              uint64_t n_point, uint64_t n_cell,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = vg_output_open(path, &out, err);

  if (st < 0) return st;
  vg_output_text(&out, TITLE "\n# Faces between cells, by points from 1\n");
  vg_output_format(&out, "mesh %" PRIu64 " %" PRIu64 "\n", n_point, n_cell);
  for (size_t z = 0; z < m->n_zone; z++) put_zone(&out, &m->zone[z]);
  for (size_t i = 0; i < m->n_sheet; i++) put_sheet(&out, m, i);
  st = vg_output_commit(&out, err);
  vg_output_release(&out);
  return st;
}

int vg_sheet_file_is_own(const char *path)
{
  char line[sizeof TITLE + 1] = "";
  FILE *f = fopen(path, "r");
  int is_own;

  if (!f) return 0;
  is_own = fgets(line, sizeof line, f) &&
           !strncmp(line, TITLE, sizeof TITLE - 1);
  fclose(f);
  return is_own;
}

/* --- read ----------------------------------------------------------------- */

/* Sheets and triangles read so far. */
struct reading {
  struct vg_input *in;
  const struct vg_mesh *m;
  struct vg_patch *sheet;
  struct vg_zone *zone;
  uint32_t (*tri)[3], *of;
  size_t n_sheet, n_tri, n_zone, cap_sheet, cap_tri, cap_of, cap_zone;
};

static vg_status expect(struct vg_input *in, const char *word,
                        struct vg_error *err)
{
  const char *text;
  size_t len;

  if (vg_input_token(in, &text, &len) && vg_token_is(text, len, word))
    return VG_OK;
  return vg_input_fail(in, err, "the word %s is expected here", word);
}

static vg_status read_owner(struct reading *r, struct vg_error *err)
{
  const struct vg_mesh *m = r->m;
  const size_t n_cell = vg_mesh_n_cell(m);
  int64_t n[2];
  vg_status st;

  VG_TRY(expect(r->in, "mesh", err));
  VG_TRY(vg_input_int(r->in, &n[0], "the number of points", err));
  VG_TRY(vg_input_int(r->in, &n[1], "the number of cells", err));
  if (n[0] != (int64_t)m->n_point || n[1] != (int64_t)n_cell)
    st = vg_fail(err, VG_ERR_INPUT,
                 "%s: these sheets belong to a mesh of %" PRId64
                 " points and %" PRId64 " cells, but the mesh has %zu and %zu; "
                 "remove or rename the file if it belongs to another mesh",
                 r->in->path, n[0], n[1], m->n_point, n_cell);
done:
  return st;
}

static vg_status read_point(struct reading *r, uint32_t *v,
                            struct vg_error *err)
{
  int64_t p;
  vg_status st = vg_input_int(r->in, &p, "a point of a triangle", err);

  if (st < 0) return st;
  if (p < 1 || p > (int64_t)r->m->n_point)
    return vg_input_fail(r->in, err,
                         "point %" PRId64 " does not exist; the mesh has %zu",
                         p, r->m->n_point);
  *v = (uint32_t)(p - 1);
  return VG_OK;
}

static vg_status read_triangles(struct reading *r, int64_t n,
                                struct vg_error *err)
{
  vg_status st = vg_input_need(r->in, (uint64_t)n, 6, "triangles", err);

  for (int64_t t = 0; t < n && st >= 0; t++) {
    uint32_t *v;

    if (vg_reserve(&r->tri, &r->cap_tri, r->n_tri + 1, sizeof *r->tri) ||
        vg_reserve(&r->of, &r->cap_of, r->n_tri + 1, sizeof *r->of))
      return vg_fail_memory(err, "the sheets");
    v = r->tri[r->n_tri];
    for (int k = 0; k < 3; k++) VG_TRY(read_point(r, &v[k], err));
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      st = vg_input_fail(r->in, err, "a triangle has a point twice");
    r->of[r->n_tri++] = (uint32_t)r->n_sheet - 1;
  }
done:
  return st;
}

/* A sheet has a number that no patch and no other sheet has. */
static vg_status check_number(const struct reading *r, int64_t id,
                              struct vg_error *err)
{
  const char *what = NULL;

  for (size_t i = 0; i < r->m->n_patch && !what; i++)
    if (r->m->patch[i].id == id) what = "the number of a patch of the mesh";
  for (size_t i = 0; i < r->n_sheet && !what; i++)
    if (r->sheet[i].id == id) what = "the number of two sheets";
  if (!what) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s:%zu: the number %" PRId64 " of a sheet is %s; give the "
                 "sheet a number that nothing else has, or remove the file if "
                 "it belongs to another mesh",
                 r->in->path, r->in->line, id, what);
}

static void read_name(struct reading *r, char name[VG_NAME_MAX])
{
  const char *text;
  size_t len;

  if (!vg_input_line(r->in, &text, &len)) return;
  while (len && *text == ' ') {
    text++;
    len--;
  }
  vg_name_from_file(text, len, name, VG_NAME_MAX);
}

static vg_status read_zone(struct reading *r, struct vg_error *err)
{
  struct vg_zone *z;
  const char *text;
  int64_t id, n;
  size_t len;
  vg_status st;

  VG_TRY(vg_input_int(r->in, &id, "the number of a zone", err));
  for (size_t i = 0; i < r->n_zone; i++)
    if (r->zone[i].id == id)
      return vg_input_fail(r->in, err, "two zones have the number %" PRId64,
                           id);
  if (vg_reserve(&r->zone, &r->cap_zone, r->n_zone + 1, sizeof *r->zone))
    return vg_fail_memory(err, "the zones");
  z = &r->zone[r->n_zone++];
  *z = (struct vg_zone){ .id = (int32_t)id };
  if (id < 1 || id > INT32_MAX || !vg_input_token(r->in, &text, &len))
    return vg_input_fail(r->in, err, "a zone has a number above 0 and a kind");
  while (z->kind < VG_ZONE_KINDS &&
         !vg_token_is(text, len, vg_zone_kind_word[z->kind]))
    z->kind++;
  if (z->kind == VG_ZONE_KINDS)
    return vg_input_fail(r->in, err,
                         "the kind of a zone is fluid, rotating, porous or "
                         "solid, not %.*s",
                         len < 40 ? (int)len : 40, text);
  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    VG_TRY(vg_input_int(r->in, &n, "the number of cells of a zone", err));
    if (n < 0)
      return vg_input_fail(r->in, err, "a zone has %" PRId64 " cells", n);
    z->n_cell[k] = (uint64_t)n;
  }
  read_name(r, z->name);
done:
  return st;
}

/* Every cell is in a zone. */
static vg_status check_zones(const struct reading *r, struct vg_error *err)
{
  const struct vg_mesh *m = r->m;
  const size_t has[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  static const char *const word[VG_ZONE_KINDS] = { "tetrahedra", "pyramids",
                                                   "prisms", "hexahedra" };

  for (int k = 0; k < VG_ZONE_KINDS && r->n_zone; k++) {
    uint64_t n = 0;

    for (size_t z = 0; z < r->n_zone && n <= has[k]; z++) {
      if (r->zone[z].n_cell[k] > has[k]) n = has[k];
      n += r->zone[z].n_cell[k];
    }
    if (n != has[k])
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: the zones do not have all %zu %s of the mesh, or "
                     "more; remove the file if it belongs to another mesh",
                     r->in->path, has[k], word[k]);
  }
  return VG_OK;
}

static vg_status read_sheet(struct reading *r, int is_interface,
                            struct vg_error *err)
{
  struct vg_patch *p;
  int64_t id, n;
  vg_status st;

  VG_TRY(vg_input_int(r->in, &id, "the number of a sheet", err));
  VG_TRY(vg_input_int(r->in, &n, "the number of triangles", err));
  if (id < INT32_MIN || id > INT32_MAX || n < 0)
    return vg_input_fail(r->in, err, "a number is out of range");
  VG_TRY(check_number(r, id, err));
  if (vg_reserve(&r->sheet, &r->cap_sheet, r->n_sheet + 1, sizeof *r->sheet))
    return vg_fail_memory(err, "the sheets");
  p = &r->sheet[r->n_sheet++];
  *p = (struct vg_patch){ .id = (int32_t)id,
                          .bc = VG_BC_NONE,
                          .bc_fun3d = VG_BC_NONE,
                          .family = VG_BC_NONE,
                          .is_sheet = 1,
                          .is_interface = is_interface };
  read_name(r, p->name);
  st = read_triangles(r, n, err);
done:
  return st;
}

/* Adds what was read to m. */
static vg_status append(const struct reading *r, struct vg_mesh *m,
                        struct vg_error *err)
{
  const size_t n_tri = m->n_tri + r->n_tri, n_patch = m->n_patch + r->n_sheet;
  uint32_t(*tri)[3] = vg_realloc(m->tri, n_tri, sizeof *tri), *patch_of;
  struct vg_patch *patch;

  if (tri) m->tri = tri;
  patch_of = vg_realloc(m->tri_patch, n_tri, sizeof *patch_of);
  if (patch_of) m->tri_patch = patch_of;
  patch = vg_realloc(m->patch, n_patch, sizeof *patch);
  if (patch) m->patch = patch;
  if (!tri || !patch_of || !patch) return vg_fail_memory(err, "the sheets");
  if (r->n_tri) memcpy(tri + m->n_tri, r->tri, r->n_tri * sizeof *tri);
  for (size_t t = 0; t < r->n_tri; t++)
    patch_of[m->n_tri + t] = (uint32_t)m->n_patch + r->of[t];
  if (r->n_sheet)
    memcpy(patch + m->n_patch, r->sheet, r->n_sheet * sizeof *patch);
  m->n_tri = n_tri;
  m->n_patch = n_patch;
  return VG_OK;
}

vg_status vg_sheet_file_parse(struct vg_input *in, struct vg_mesh *m,
                              struct vg_error *err)
{
  struct reading r = { .in = in, .m = m };
  const char *text;
  size_t len;
  vg_status st;

  in->comment = '#';
  VG_TRY(read_owner(&r, err));
  while (vg_input_token(in, &text, &len)) {
    const int is_interface = vg_token_is(text, len, "interface");

    if (vg_token_is(text, len, "zone")) st = read_zone(&r, err);
    else if (is_interface || vg_token_is(text, len, "sheet"))
      st = read_sheet(&r, is_interface, err);
    else
      st = vg_input_fail(in, err,
                         "the word sheet, interface or zone is expected here");
    if (st < 0) goto done;
  }
  VG_TRY(check_zones(&r, err));
  VG_TRY(append(&r, m, err));
  if (!r.n_zone) goto done;
  assert(!m->n_zone && !m->zone);
  m->zone = r.zone;
  m->n_zone = r.n_zone;
  r.zone = NULL;
done:
  free(r.zone);
  free(r.sheet);
  free(r.tri);
  free(r.of);
  return st;
}

vg_status vg_sheet_file_read(const char *path, struct vg_mesh *m,
                             struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st >= 0) st = vg_sheet_file_parse(&in, m, err);
  vg_input_release(&in);
  return st;
}
