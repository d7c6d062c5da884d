/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/input/zone_table.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/copies.h"

/* Triangles in a zone from which on a note tells that it is thin. */
#define THIN_TRIANGLES 10000

struct vg_zones {
  struct vg_zone_map map;
  double *hmax; /* [map.n] 0: none */
  const struct vg_size_map *other;
  struct vg_size_map sizes;
};

int vg_mesh_has_interfaces(const struct vg_mesh *surface)
{
  for (size_t i = 0; i < surface->n_patch; i++)
    if (surface->patch[i].is_interface) return 1;
  return 0;
}

/* --- the table --------------------------------------------------------------
 */

/* Has the zone no cells? */
static int is_empty_row(const struct vg_zone_row *r)
{
  return r->mesh == VG_ANSWER_NO ||
         (r->mesh == VG_ANSWER_AUTO && r->kind == VG_ZONE_SOLID);
}

int vg_zones_lack_cells(const struct vg_settings *s)
{
  for (size_t i = 0; i < s->n_zone; i++)
    if (is_empty_row(&s->zone[i])) return 1;
  return 0;
}

static int has_seed(const struct vg_zone_row *r)
{
  return !isnan(r->seed[0]) && !isnan(r->seed[1]) && !isnan(r->seed[2]);
}

vg_status vg_zone_rows_take(struct vg_settings *s, struct vg_cad_zones *z,
                            vg_status st, struct vg_error *err)
{
  for (size_t k = 0; k < z->n && st >= 0; k++) {
    struct vg_zone_row row;
    size_t i = 0;

    while (i < s->n_zone && strcmp(s->zone[i].name, z->of[k].name) != 0) i++;
    if (i < s->n_zone) {
      if (!has_seed(&s->zone[i]))
        memcpy(s->zone[i].seed, z->of[k].seed, sizeof row.seed);
      continue;
    }
    vg_settings_row_default(VG_TABLE_ZONES, &row);
    memcpy(row.name, z->of[k].name, sizeof row.name);
    memcpy(row.seed, z->of[k].seed, sizeof row.seed);
    row.kind = z->of[k].kind;
    if (row.kind == VG_ZONE_SOLID) row.mesh = VG_ANSWER_YES;
    st = vg_settings_add(s, VG_TABLE_ZONES, &row, err);
  }
  free(z->of);
  return st;
}

vg_status vg_zone_rows_bcast(struct vg_comm *c, struct vg_settings *s,
                             struct vg_error *err)
{
  struct vg_bytes b = { 0, NULL };
  vg_status st = VG_OK;

  if (!vg_comm_rank(c) && s->n_zone) {
    b.n = s->n_zone * sizeof *s->zone;
    b.data = vg_alloc(b.n, 1);
    if (!b.data) st = vg_fail_memory(err, "the zones");
    else memcpy(b.data, s->zone, b.n);
  }
  VG_TRY(vg_comm_agree(c, st, err));
  VG_TRY(vg_comm_bcast(c, 0, &b, err));
  if (vg_comm_rank(c)) s->n_zone = 0;
  for (size_t i = 0; vg_comm_rank(c) && i < b.n / sizeof *s->zone; i++)
    if (st >= 0)
      st = vg_settings_add(s, VG_TABLE_ZONES,
                           (const struct vg_zone_row *)b.data + i, err);
  st = vg_comm_agree(c, st, err);
done:
  free(b.data);
  return st;
}

static vg_status refuse_seed(const struct vg_zone_row *r, uint32_t zone,
                             struct vg_error *err)
{
  return vg_fail(
    err, VG_ERR_INPUT, "zones: the seed point (%g, %g, %g) of zone %s is %s",
    r->seed[0], r->seed[1], r->seed[2], r->name,
    zone == VG_ZONE_ON
      ? "on a triangle of the surface; move it into the zone"
      : "outside of the fluid; give a point inside the zone, which interfaces "
        "and the boundary enclose");
}

/* of: [n_zone] row of each zone, or SIZE_MAX */
static vg_status take_row(const struct vg_settings *s, size_t i,
                          struct vg_zone_map *z, size_t *of,
                          struct vg_error *err)
{
  const struct vg_zone_row *r = &s->zone[i], *q;
  uint32_t zone;

  if (!*r->name)
    return vg_fail(err, VG_ERR_INPUT,
                   "zones: row %zu has an empty name; give the zone a name",
                   i + 1);
  for (size_t k = 0; k < i; k++)
    if (!strcmp(s->zone[k].name, r->name))
      return vg_fail(err, VG_ERR_INPUT,
                     "zones: two rows have the name %s; give each zone a name "
                     "of its own",
                     r->name);
  if (!has_seed(r))
    return vg_fail(err, VG_ERR_INPUT,
                   "zones: the zone %s has no point; give x, y and z, or the "
                   "name of a zone of the file (solids of a CAD file with "
                   "cad_solids zones, zones of a volume mesh)",
                   r->name);
  zone = vg_zone_map_at(z, r->seed);
  if (zone >= VG_ZONE_ON) return refuse_seed(r, zone, err);
  if (of[zone] != SIZE_MAX) {
    q = &s->zone[of[zone]];
    return vg_fail(err, VG_ERR_INPUT,
                   "zones: the seed points of %s (%g, %g, %g) and %s (%g, %g, "
                   "%g) are in one zone, since no interface separates them; "
                   "remove one of the rows%s, or name the patches between the "
                   "points in zone_interfaces",
                   q->name, q->seed[0], q->seed[1], q->seed[2], r->name,
                   r->seed[0], r->seed[1], r->seed[2],
                   s->cad.solids == VG_CAD_SOLIDS_ZONES
                     ? " or give it the name of its solid"
                     : "");
  }
  of[zone] = i;
  return VG_OK;
}

static int has_row_name(const struct vg_settings *s, const char *name)
{
  for (size_t i = 0; i < s->n_zone; i++)
    if (!strcmp(s->zone[i].name, name)) return 1;
  return 0;
}

/* Names that the table does not give avoid those that it gives. */
static void put_names(const struct vg_settings *s, const size_t *of,
                      struct vg_zone_map *z)
{
  for (size_t k = 0; k < z->n; k++) {
    char *name = z->zone[k].name;

    if (of[k] != SIZE_MAX) {
      z->zone[k].kind = s->zone[of[k]].kind;
      memcpy(name, s->zone[of[k]].name, VG_NAME_MAX);
      continue;
    }
    for (size_t n = k + 1; has_row_name(s, name); n++)
      snprintf(name, VG_NAME_MAX, "zone_%zu", n);
  }
}

vg_status vg_zones_make(const struct vg_settings *s,
                        const struct vg_mesh *surface, int is_cut,
                        struct vg_zone_map *z, double **hmax,
                        struct vg_error *err)
{
  size_t *of = NULL;
  vg_status st;

  VG_TRY(vg_zone_map_new(surface, z, err));
  of = vg_alloc(z->n, sizeof *of);
  if (hmax) *hmax = vg_calloc(z->n, sizeof **hmax);
  if (!of || (hmax && !*hmax)) VG_TRY(vg_fail_memory(err, "the zones"));
  memset(of, 0xff, z->n * sizeof *of);
  for (size_t i = 0; i < s->n_zone; i++)
    if (!is_cut || !is_empty_row(&s->zone[i]))
      VG_TRY(take_row(s, i, z, of, err));
  put_names(s, of, z);
  for (size_t k = 0; hmax && k < z->n; k++)
    if (of[k] != SIZE_MAX) (*hmax)[k] = s->zone[of[k]].hmax;
done:
  free(of);
  if (st < 0) {
    vg_zone_map_release(z);
    if (hmax) free(*hmax);
    if (hmax) *hmax = NULL;
  }
  return st;
}

void vg_zones_limits(const struct vg_zone_map *z, const double *hmax,
                     struct vg_zone_limit *limit)
{
  const struct vg_mesh *m = z->surface;

  for (size_t k = 0; k < z->n; k++)
    limit[k] = (struct vg_zone_limit){ .hmax = hmax[k] };
  for (size_t t = 0; t < m->n_tri; t++) {
    struct vg_zone_limit *to = &limit[z->of[t]];

    for (int k = 0; k < 3; k++) {
      const double edge = vg_distance(m->point[m->tri[t][k]],
                                      m->point[m->tri[t][(k + 1) % 3]]);

      if (edge <= to->edge) continue;
      to->edge = edge;
      to->patch = vg_mesh_front_patch(m, m->tri_patch[t]);
    }
  }
}

vg_status vg_zones_check(const struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;

  if (!s->n_zone || b->zones) return VG_OK;
  return vg_fail(
    err, VG_ERR_INPUT,
    "%s: the table zones names zones, but no patch is an "
    "interface; name the patches that enclose them in zone_interfaces, "
    "or remove the table",
    b->read->files.stem);
}

/* --- sizes ------------------------------------------------------------------
 */

static double hmax_of(const struct vg_zones *z, uint32_t zone)
{
  return zone < VG_ZONE_ON && z->hmax[zone] > 0 ? z->hmax[zone] : INFINITY;
}

static double at(void *user, const double x[3])
{
  const struct vg_zones *z = user;
  const double h = hmax_of(z, vg_zone_map_at(&z->map, x));

  return z->other ? fmin(h, z->other->at(z->other->user, x)) : h;
}

/* Without a triangle in the box, its middle decides. */
static double least(void *user, const double lo[3], const double hi[3])
{
  const struct vg_zones *z = user;
  double h = INFINITY, x[3];

  for (int d = 0; d < 3; d++) x[d] = .5 * (lo[d] + hi[d]);
  if (!vg_zone_map_touches(&z->map, lo, hi))
    h = hmax_of(z, vg_zone_map_at(&z->map, x));
  else
    for (uint32_t k = 0; k < z->map.n; k++) h = fmin(h, hmax_of(z, k));
  return z->other ? fmin(h, z->other->least(z->other->user, lo, hi)) : h;
}

static void add_sizes(struct vg_boundary *b, struct vg_zones *z)
{
  int has_size = 0;

  for (size_t k = 0; k < z->map.n; k++) has_size |= z->hmax[k] > 0;
  if (!has_size) return;
  assert(!b->map || !b->map->metric); /* refused with inner surfaces */
  z->sizes = (struct vg_size_map){ .at = at,
                                   .least = b->map && !b->map->least ? NULL
                                                                     : least,
                                   .most = b->map ? b->map->most : 0,
                                   .user = z };
  b->map = &z->sizes;
}

static void note_zones(const struct vg_boundary *b, const struct vg_zones *z)
{
  for (size_t k = 0; k < z->map.n; k++) {
    const struct vg_zone *a = &z->map.zone[k];
    char size[40] = "";

    if (z->hmax[k] > 0)
      snprintf(size, sizeof size, ", requested size %g", z->hmax[k]);
    vg_note(b->notes, "zone %d %s: %s, volume %.6g%s", (int)a->id, a->name,
            vg_zone_kind_word[a->kind], z->map.volume[k], size);
  }
}

/* A zone between two close walls: the curves around it have short edges, and
 * the triangles of both walls are as small. */
static void note_thin(const struct vg_boundary *b, const struct vg_zones *z)
{
  const struct vg_mesh *m = z->map.surface;

  for (size_t k = 0; k < z->map.n; k++) {
    double area = 0, width, edge;
    size_t n = 0;

    for (size_t t = 0; t < m->n_tri; t++) {
      const uint32_t *v = m->tri[t];

      if (z->map.of[t] != k) continue;
      area += vg_triangle_area(m->point[v[0]], m->point[v[1]], m->point[v[2]]);
      n++;
    }
    width = 2 * z->map.volume[k] / area;
    edge = sqrt(area / (double)n * (4 / sqrt(3)));
    if (n < THIN_TRIANGLES || 4 * n < m->n_tri || 3 * edge < width) continue;
    vg_note(b->notes,
            "zone %s is thin, with a mean width of %.3g: %zu of the %zu "
            "triangles look into it, with edges of %.3g, and the cells next to "
            "them are as small; hmin, the smallest edge, makes them larger",
            z->map.zone[k].name, width, n, m->n_tri, edge);
  }
}

/* Removes the zones without cells. */
static vg_status cut_zones(struct vg_boundary *b, struct vg_error *err)
{
  const struct vg_settings *s = &b->read->settings;
  struct vg_zone_map map = VG_ZONE_MAP_INIT;
  uint8_t *is_empty = NULL;
  size_t n = 0;
  vg_status st;

  for (size_t i = 0; i < s->n_zone; i++) n += (size_t)is_empty_row(&s->zone[i]);
  if (!n) return VG_OK;
  VG_TRY(vg_zones_make(s, &b->surface, 0, &map, NULL, err));
  if (n == map.n)
    VG_TRY(
      vg_fail(err, VG_ERR_INPUT,
              "zones: no zone has cells; set mesh to yes for one of them"));
  is_empty = vg_calloc(map.n, 1);
  if (!is_empty) VG_TRY(vg_fail_memory(err, "the zones"));
  for (size_t i = 0; i < s->n_zone; i++)
    if (is_empty_row(&s->zone[i])) {
      is_empty[vg_zone_map_at(&map, s->zone[i].seed)] = 1;
      vg_note(b->notes, "zone %s: %s, without cells", s->zone[i].name,
              vg_zone_kind_word[s->zone[i].kind]);
    }
  st = vg_boundary_cut_zones(b, &map, is_empty, err);
done:
  free(is_empty);
  vg_zone_map_release(&map);
  return st;
}

vg_status vg_boundary_add_zones(struct vg_boundary *b, struct vg_error *err)
{
  struct vg_zones *z = NULL;
  vg_status st;

  assert(!b->zones);
  if (!vg_mesh_has_interfaces(&b->surface)) return VG_OK;
  VG_TRY(cut_zones(b, err));
  z = vg_calloc(1, sizeof *z);
  if (!z) return vg_fail_memory(err, "the zones");
  z->other = b->map;
  VG_TRY(
    vg_zones_make(&b->read->settings, &b->surface, 1, &z->map, &z->hmax, err));
  add_sizes(b, z);
  note_zones(b, z);
  note_thin(b, z);
  b->zones = z;
  z = NULL;
done:
  free(z);
  return st;
}

void vg_boundary_forget_zones(struct vg_boundary *b)
{
  if (!b->zones) return;
  b->map = b->zones->other;
  vg_zone_map_release(&b->zones->map);
  free(b->zones->hmax);
  free(b->zones);
  b->zones = NULL;
}
