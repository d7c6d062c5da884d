/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/zones.h"
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
