/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Invariants of the settings by patch in AFLR's files, for all of their
 * formats. */
#ifndef VG_FUZZ_AFLR_H
#define VG_FUZZ_AFLR_H

#include "fuzz.h"

#include "io/mesh/aflr.h"

static int fuzz_aflr(const uint8_t *data, size_t size,
                     vg_status (*parse)(struct vg_input *, struct vg_aflr *,
                                        struct vg_error *))
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_aflr a = VG_AFLR_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK) st = parse(&in, &a, &err);
  fuzz_check_answer(st, &err);
  fuzz_expect(st == VG_OK || !a.patch, "out is untouched");
  for (size_t i = 0; i < a.n; i++) {
    const struct vg_aflr_patch *p = a.patch + i;

    fuzz_expect(memchr(p->name, 0, VG_NAME_MAX) != NULL,
                "names are terminated");
    fuzz_expect(isfinite(p->spacing) && p->spacing >= 0, "spacing");
    fuzz_expect(isfinite(p->thickness) && p->thickness >= 0, "thickness");
    fuzz_expect(p->n_layer >= 0, "layers");
  }
  vg_aflr_release(&a);
  vg_input_release(&in);
  return 0;
}

#endif
