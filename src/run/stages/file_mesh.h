/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/file_mesh.h: a volume mesh from a file, as slices and with its
 * quality. */
#ifndef VG_RUN_STAGES_FILE_MESH_H
#define VG_RUN_STAGES_FILE_MESH_H

#include "core/judge/quality.h"
#include "core/mesh/slices.h"
#include "run/input/input.h"

struct vg_file_mesh {
  struct vg_mesh mesh;
  size_t n_turned;         /* Cells of negative volume, mirrored on reading. */
  uint32_t *identity;      /* [mesh.n_point] 0, 1, ... */
  struct vg_slices slices; /* The mesh as the only slice; refers to this
                              structure, which must not move. */
  struct vg_mesh_report judge;
};

/** Read and judge the mesh of a file. Names and conditions of its patches come
 * from the file `mapbc`, or from STEM.mapbc if mapbc is NULL or "".
 *
 * @param out    empty; released by the caller, also on failure
 * @param notes  receives what was changed on reading
 * VG_ERR_INPUT if the file has no cells; an invalid mesh is VG_OK. */
vg_status vg_file_mesh_read(const char *file, const char *mapbc,
                            struct vg_file_mesh *out, struct vg_notes *notes,
                            struct vg_error *err);

void vg_file_mesh_release(struct vg_file_mesh *f);

#endif
