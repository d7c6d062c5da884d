/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Driver shared by the fuzz targets of the readers: it turns bytes into an
 * input and checks that a reader's answer keeps its promises. */
#ifndef VG_TESTS_FUZZ_H
#define VG_TESTS_FUZZ_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void fuzz_expect(int holds, const char *what)
{
  if (holds) return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

static inline void fuzz_indices(const uint32_t *index, size_t n, size_t limit,
                                const char *what)
{
  for (size_t i = 0; i < n; i++) fuzz_expect(index[i] < limit, what);
}

/* Invariants of every mesh that a reader returns. */
static inline void fuzz_check_mesh(const struct vg_mesh *m)
{
#define NODES(array, count, width)                                             \
  if (m->count)                                                                \
  fuzz_indices(m->array[0], m->count *width, m->n_point, #array " nodes")
  NODES(tri, n_tri, 3);
  NODES(quad, n_quad, 4);
  NODES(tet, n_tet, 4);
  NODES(pyr, n_pyr, 5);
  NODES(pri, n_pri, 6);
  NODES(hex, n_hex, 8);
#undef NODES
  if (m->n_tri) fuzz_indices(m->tri_patch, m->n_tri, m->n_patch, "tri_patch");
  if (m->n_quad)
    fuzz_indices(m->quad_patch, m->n_quad, m->n_patch, "quad_patch");
  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++)
      fuzz_expect(isfinite(m->point[i][k]), "finite coordinates");
  for (size_t i = 0; i < m->n_patch; i++) {
    fuzz_expect(memchr(m->patch[i].name, 0, VG_NAME_MAX) != NULL,
                "names are terminated");
    fuzz_expect(!i || vg_mesh_find_patch(m, m->patch[i].id) == i || i > 64,
                "patch ids are unique");
  }
}

/* Invariant of every answer: a failure has a message that names the file. */
static inline void fuzz_check_answer(vg_status st, const struct vg_error *err)
{
  fuzz_expect(st <= 0, "a reader returns VG_OK or an error");
  if (st == VG_OK) return;
  fuzz_expect(err->code == st, "status and message agree");
  fuzz_expect(memchr(err->text, 0, sizeof err->text) && *err->text,
              "a failure has a message");
  if (st != VG_ERR_MEMORY)
    fuzz_expect(strstr(err->text, "FUZZ") != NULL, "messages name the file");
}

typedef vg_status (*fuzz_parse)(struct vg_input *, struct vg_mesh *,
                                struct vg_error *);

/* Run a reader that turns one input into a mesh. */
static inline void fuzz_mesh(fuzz_parse parse, const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_mesh m = VG_MESH_INIT, empty = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK) st = parse(&in, &m, &err);
  fuzz_check_answer(st, &err);
  if (st == VG_OK) fuzz_check_mesh(&m);
  else fuzz_expect(!memcmp(&m, &empty, sizeof m), "out is untouched");
  vg_mesh_release(&m);
  vg_input_release(&in);
}

#endif
