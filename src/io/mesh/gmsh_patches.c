/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
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

vg_status vg_gmsh_set_patches(struct vg_mesh *m,
                              struct vg_gmsh_group *const face[2],
                              size_t n_name, const struct vg_gmsh_name *name,
                              const char *path, struct vg_error *err)
{
  const size_t n[2] = { m->n_tri, m->n_quad };
  int32_t *tag = vg_alloc(n[0] + n[1], sizeof *tag), *to = tag;
  int has_groups = 0;
  vg_status st = VG_OK;

  if (!tag) return vg_fail_memory(err, "the patches");
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < n[k]; i++) has_groups |= face[k][i].physical != 0;
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < n[k] && st == VG_OK; i++) {
      int64_t id = patch_of(&face[k][i], has_groups);

      if (id < -INT32_MAX || id > INT32_MAX)
        st = vg_fail(err, VG_ERR_UNSUPPORTED,
                     "%s: group %lld does not fit into a 32-bit patch number",
                     path, (long long)id);
      *to++ = (int32_t)id;
    }
  if (st == VG_OK) st = vg_patches_from_tags(m, tag, err);
  free(tag);
  for (size_t i = 0; has_groups && i < n_name && st == VG_OK; i++)
    set_name(m, &name[i]);
  return st;
}
