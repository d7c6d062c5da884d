/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/zones.h"
#include "io/cad/cad.h"
#include "io/mesh/gmsh_parts.h"
#include "io/stream/convention.h"

/* Patch id of a face. */
static int64_t patch_of(const struct vg_gmsh_group *g, int has_groups)
{
  return has_groups ? g->physical : g->surface;
}

/* Patches are sorted by id. */
static void set_name(struct vg_mesh *m, const struct vg_gmsh_name *name)
{
  size_t lo = 0, hi = m->n_patch;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (m->patch[mid].id < name->tag) lo = mid + 1;
    else hi = mid;
  }
  if (lo < m->n_patch && m->patch[lo].id == name->tag)
    memcpy(m->patch[lo].name, name->text, VG_NAME_MAX);
}

/* The ids of n_list lists of faces or cells. NULL with *st set: no memory, or a
 * number is too large. */
static int32_t *tags_of(struct vg_gmsh_group *const *list, const size_t *n,
                        int n_list, int *has_groups, const char *path,
                        vg_status *st, struct vg_error *err)
{
  size_t sum = 0;
  int32_t *tag, *to;

  *has_groups = 0;
  for (int k = 0; k < n_list; k++) {
    sum += n[k];
    for (size_t i = 0; i < n[k]; i++) *has_groups |= list[k][i].physical != 0;
  }
  tag = to = vg_alloc(sum, sizeof *tag);
  *st = tag ? VG_OK : vg_fail_memory(err, "the groups of a mesh");
  for (int k = 0; tag && k < n_list; k++)
    for (size_t i = 0; i < n[k] && *st == VG_OK; i++) {
      int64_t id = patch_of(&list[k][i], *has_groups);

      if (id < -INT32_MAX || id > INT32_MAX)
        *st = vg_fail(err, VG_ERR_UNSUPPORTED,
                      "%s: group %lld does not fit into a 32-bit number of a "
                      "patch or zone",
                      path, (long long)id);
      *to++ = (int32_t)id;
    }
  if (*st == VG_OK) return tag;
  free(tag);
  return NULL;
}

vg_status vg_gmsh_set_patches(struct vg_mesh *m,
                              struct vg_gmsh_group *const face[2],
                              size_t n_name, const struct vg_gmsh_name *name,
                              const char *path, struct vg_error *err)
{
  const size_t n[2] = { m->n_tri, m->n_quad };
  int has_groups;
  vg_status st;
  int32_t *tag = tags_of(face, n, 2, &has_groups, path, &st, err);

  if (tag) st = vg_patches_from_tags(m, tag, err);
  free(tag);
  for (size_t i = 0; has_groups && i < n_name && st == VG_OK; i++)
    if (name[i].dimension == 2) set_name(m, &name[i]);
  return st;
}

vg_status vg_gmsh_set_zones(struct vg_mesh *m,
                            struct vg_gmsh_group *const cell[4], size_t n_name,
                            const struct vg_gmsh_name *name, const char *path,
                            struct vg_error *err)
{
  const size_t n[4] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  int has_groups;
  vg_status st;
  int32_t *tag = tags_of(cell, n, 4, &has_groups, path, &st, err);

  if (tag) st = vg_mesh_zones_from_tags(m, tag, 0, err);
  free(tag);
  for (size_t i = 0; has_groups && i < n_name && st == VG_OK; i++)
    for (size_t z = 0; z < m->n_zone && name[i].dimension == 3; z++)
      if (m->zone[z].id == name[i].tag)
        memcpy(m->zone[z].name, name[i].text, VG_NAME_MAX);
  return st;
}

/* The group of a surface or volume; NULL: none. */
static const struct vg_gmsh_group *group_of(const struct vg_gmsh_group *group,
                                            size_t n, int64_t surface)
{
  size_t lo = 0, hi = n;

  while (lo < hi) {
    const size_t mid = lo + (hi - lo) / 2;

    if (group[mid].surface < surface) lo = mid + 1;
    else hi = mid;
  }
  return lo < n && group[lo].surface == surface ? group + lo : NULL;
}

int64_t vg_gmsh_physical(const struct vg_gmsh_group *group, size_t n,
                         int64_t surface)
{
  const struct vg_gmsh_group *of = group_of(group, n, surface);

  return of ? of->physical : 0;
}

/* --- volumes of a surface mesh -------------------------------------------- */

#define CANDIDATES 16 /* faces from which a point in a volume is searched */
#define ON_EDGE 1e-6  /* barycentric coordinate of a ray on an edge */

struct volumes {
  struct vg_mesh *m;
  struct vg_gmsh_group *const *face; /* of triangles, of quadrilaterals */
  size_t n_side, n_group;
  const struct vg_gmsh_side *side;   /* sorted by surface */
  const struct vg_gmsh_group *group; /* [n_group] the volumes, sorted */
  size_t *first; /* [n_group + 1] owned: faces of each volume in of[] */
  size_t *of;    /* owned */
};

static int by_side(const void *a, const void *b)
{
  const struct vg_gmsh_side *p = a, *q = b;

  if (p->surface != q->surface) return p->surface < q->surface ? -1 : 1;
  return (p->volume > q->volume) - (p->volume < q->volume);
}

/* The volumes of a surface begin at the result; *n is their number. */
static const struct vg_gmsh_side *sides_of(const struct volumes *v,
                                           int64_t surface, size_t *n)
{
  size_t lo = 0, hi = v->n_side;

  while (lo < hi) {
    const size_t mid = lo + (hi - lo) / 2;

    if (v->side[mid].surface < surface) lo = mid + 1;
    else hi = mid;
  }
  for (*n = 0; lo + *n < v->n_side && v->side[lo + *n].surface == surface;)
    ++*n;
  return v->side + lo;
}

static int64_t surface_of(const struct volumes *v, size_t f)
{
  const size_t n = v->m->n_tri;

  return f < n ? v->face[0][f].surface : v->face[1][f - n].surface;
}

/* Whether a face is between two volumes. */
static int is_between(const struct volumes *v, size_t f)
{
  size_t n;
  const struct vg_gmsh_side *s = sides_of(v, surface_of(v, f), &n);

  return n == 2 && s[0].volume != s[1].volume;
}

static uint32_t *place_of(const struct volumes *v, size_t f)
{
  const size_t n = v->m->n_tri;

  return f < n ? &v->m->tri_patch[f] : &v->m->quad_patch[f - n];
}

static vg_status add_interface(struct volumes *v, uint32_t patch, size_t *at,
                               struct vg_error *err)
{
  const int32_t last = vg_mesh_last_id(v->m);
  const char *of = v->m->patch[patch].name;
  char name[VG_NAME_MAX];

  if (last == INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "no number is left for an interface; renumber the surfaces");
  snprintf(name, sizeof name, "%.60s%sinterface", of, *of ? "_" : "");
  *at = vg_mesh_add_patch(v->m, last + 1, name);
  if (*at == SIZE_MAX) return vg_fail_memory(err, "the interfaces");
  return VG_OK;
}

/* Makes patches between two volumes interfaces. *any: there is one. */
static vg_status set_interfaces(struct volumes *v, int *any,
                                struct vg_error *err)
{
  const size_t n_patch = v->m->n_patch, n_face = v->m->n_tri + v->m->n_quad;
  size_t(*count)[2] = vg_calloc(n_patch, sizeof *count), at;
  size_t *to = vg_alloc(n_patch, sizeof *to);
  vg_status st = VG_OK;

  if (!count || !to) VG_TRY(vg_fail_memory(err, "the interfaces"));
  for (size_t f = 0; f < n_face; f++)
    count[*place_of(v, f)][is_between(v, f)]++;
  for (size_t p = 0; p < n_patch; p++) {
    to[p] = p;
    if (!count[p][1]) continue;
    *any = 1;
    at = p;
    if (count[p][0]) VG_TRY(add_interface(v, (uint32_t)p, &at, err));
    to[p] = at;
    v->m->patch[at].is_interface = 1;
  }
  for (size_t f = 0; f < n_face; f++)
    if (is_between(v, f)) *place_of(v, f) = (uint32_t)to[*place_of(v, f)];
done:
  free(count);
  free(to);
  return st;
}

/* Share t of the ray from o along d at which it meets a triangle; 0: it does
 * not. *is_edge: it passes near an edge. */
static double meets(const double o[3], const double d[3], const double a[3],
                    const double b[3], const double c[3], int *is_edge)
{
  double u[3], v[3], h[3], s[3], q[3], det, x, y;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(d, v, h);
  det = vg_dot(u, h);
  if (!(fabs(det) > 0)) return 0;
  vg_sub(o, a, s);
  x = vg_dot(s, h) / det;
  vg_cross(s, u, q);
  y = vg_dot(d, q) / det;
  if (x < -ON_EDGE || y < -ON_EDGE || x + y > 1 + ON_EDGE) return 0;
  if (x < ON_EDGE || y < ON_EDGE || x + y > 1 - ON_EDGE) *is_edge = 1;
  return vg_dot(v, q) / det;
}

/* Triangle i of face f, a half of a quadrilateral; 0: it has none. */
static int corners(const struct vg_mesh *m, size_t f, int i, const double *x[3])
{
  const uint32_t *q = f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri];

  if (i && f < m->n_tri) return 0;
  x[0] = m->point[q[0]];
  x[1] = m->point[q[1 + i]];
  x[2] = m->point[q[2 + i]];
  return 1;
}

/* Searches a point in the volume bounded by the n faces, on the normal of face
 * `from`: halfway to the next face, on the side with an odd number of them. */
static int find_seed(const struct vg_mesh *m, size_t n, const size_t *face,
                     size_t from, double seed[3])
{
  double o[3], d[3], u[3], v[3], near[2] = { INFINITY, INFINITY };
  size_t hits[2] = { 0, 0 };
  const double *x[3];
  int is_edge = 0, way;

  corners(m, face[from], 0, x);
  for (int k = 0; k < 3; k++) o[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  vg_sub(x[1], x[0], u);
  vg_sub(x[2], x[0], v);
  vg_cross(u, v, d);
  if (!(vg_unit(d) > 0)) return 0;
  for (size_t i = 0; i < n && !is_edge; i++)
    for (int half = 0; half < 2; half++) {
      double t;

      if (i == from || !corners(m, face[i], half, x)) continue;
      t = meets(o, d, x[0], x[1], x[2], &is_edge);
      if (t == 0) continue;
      hits[t < 0]++;
      near[t < 0] = fmin(near[t < 0], fabs(t));
    }
  way = !(hits[0] % 2);
  if (is_edge || hits[way] % 2 == 0) return 0;
  for (int k = 0; k < 3; k++)
    seed[k] = o[k] + (way ? -1 : 1) * d[k] * near[way] / 2;
  return 1;
}

static int is_named(const struct vg_cad_zones *zones, const char *name)
{
  for (size_t i = 0; i < zones->n; i++)
    if (!strcmp(zones->of[i].name, name)) return 1;
  return 0;
}

/* The name of the physical group, with the number of the volume if another
 * volume has it. */
static void name_zone(const struct vg_gmsh_group *volume, size_t n_name,
                      const struct vg_gmsh_name *name,
                      const struct vg_cad_zones *zones, char out[VG_NAME_MAX])
{
  char text[VG_NAME_MAX] = "";

  for (size_t i = 0; i < n_name; i++)
    if (volume->physical && name[i].dimension == 3 &&
        name[i].tag == volume->physical)
      memcpy(text, name[i].text, VG_NAME_MAX);
  if (*text && !is_named(zones, text)) memcpy(out, text, VG_NAME_MAX);
  else
    snprintf(out, VG_NAME_MAX, "%.40s_%lld", *text ? text : "volume",
             (long long)volume->surface);
}

/* Counts the faces of volume g in first[g + 2] or, once of[] is there, puts
 * them into it from first[g + 1] on, which ends where those of volume g + 1
 * begin. */
static void visit_faces(struct volumes *v)
{
  for (size_t f = 0; f < v->m->n_tri + v->m->n_quad; f++) {
    size_t n;
    const struct vg_gmsh_side *s = sides_of(v, surface_of(v, f), &n);

    for (size_t k = 0; k < n; k++) {
      const struct vg_gmsh_group *g = group_of(v->group, v->n_group,
                                               s[k].volume);

      assert(g);
      if (v->of) v->of[v->first[g - v->group + 1]++] = f;
      else v->first[g - v->group + 2]++;
    }
  }
}

/* The faces of each volume. */
static vg_status list_faces(struct volumes *v, struct vg_error *err)
{
  v->first = vg_calloc(v->n_group + 2, sizeof *v->first);
  if (!v->first) return vg_fail_memory(err, "the zones");
  visit_faces(v);
  for (size_t g = 2; g < v->n_group + 2; g++) v->first[g] += v->first[g - 1];
  v->of = vg_alloc(v->first[v->n_group + 1], sizeof *v->of);
  if (!v->of) return vg_fail_memory(err, "the zones");
  visit_faces(v);
  return VG_OK;
}

/* Adds the zone of volume g. */
static vg_status add_zone(const struct volumes *v, size_t g, size_t n_name,
                          const struct vg_gmsh_name *name, const char *path,
                          struct vg_cad_zones *zones, struct vg_error *err)
{
  const size_t *face = v->of + v->first[g];
  const size_t n = v->first[g + 1] - v->first[g], step = n / CANDIDATES + 1;
  struct vg_cad_zone z = { .kind = VG_ZONE_FLUID };
  int has_seed = 0;

  if (!n) return VG_OK; /* its surfaces were not saved */
  for (size_t i = 0; i < n && !has_seed; i += step)
    has_seed = find_seed(v->m, n, face, i, z.seed);
  if (!has_seed)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: the surfaces of volume %lld are not closed, so that no "
                   "point in it is found; save all of them (Mesh.SaveAll = 1)",
                   path, (long long)v->group[g].surface);
  name_zone(&v->group[g], n_name, name, zones, z.name);
  zones->of[zones->n++] = z;
  return VG_OK;
}

vg_status vg_gmsh_set_volumes(struct vg_mesh *m,
                              struct vg_gmsh_group *const face[2],
                              size_t n_group, const struct vg_gmsh_group *group,
                              size_t n_side, struct vg_gmsh_side *side,
                              size_t n_name, const struct vg_gmsh_name *name,
                              const char *path, struct vg_cad_zones *zones,
                              struct vg_error *err)
{
  struct volumes v = { .m = m,
                       .face = face,
                       .n_side = n_side,
                       .n_group = n_group,
                       .side = side,
                       .group = group };
  int any = 0;
  vg_status st = VG_OK;

  assert(!zones->n && !zones->of);
  if (!n_side) return VG_OK;
  qsort(side, n_side, sizeof *side, by_side);
  for (size_t i = 2; i < n_side; i++)
    if (side[i].surface == side[i - 2].surface)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: surface %lld bounds more than two volumes; correct "
                     "the geometry",
                     path, (long long)side[i].surface);
  VG_TRY(set_interfaces(&v, &any, err));
  if (!any) goto done;
  VG_TRY(list_faces(&v, err));
  zones->of = vg_calloc(n_group, sizeof *zones->of);
  if (!zones->of) VG_TRY(vg_fail_memory(err, "the zones"));
  for (size_t g = 0; g < n_group; g++)
    VG_TRY(add_zone(&v, g, n_name, name, path, zones, err));
done:
  free(v.first);
  free(v.of);
  return st;
}
