/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/plane/plane.h"

#include <assert.h>
#include <string.h>

#include "io/cgns/cgns.h"

typedef vg_status (*writer)(const char *path, const struct vg_plane_mesh *m,
                            struct vg_error *err);

static const struct {
  const char *word;
  writer write;
} formats[] = { { "su2", vg_su2_plane_write },
                { "msh", vg_gmsh_plane_write },
                { "cgns", vg_cgns_plane_write } };

static writer writer_of(const char *word)
{
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    if (!strcmp(word, formats[i].word)) return formats[i].write;
  return NULL;
}

int vg_plane_can_write(const char *word)
{
  return writer_of(word) != NULL;
}

vg_status vg_plane_write(const char *path, const char *word,
                         const struct vg_plane_mesh *m, struct vg_error *err)
{
  assert(vg_plane_can_write(word));
  return writer_of(word)(path, m, err);
}
