/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/source_effect.h: notes and JSON on sources without effect. Uses
 * core/sizing/sizing_effect.h, run/input/input.h. */
#ifndef VG_RUN_INPUT_SOURCE_EFFECT_H
#define VG_RUN_INPUT_SOURCE_EFFECT_H

#include "core/sizing/sizing_effect.h"
#include "run/common/json_build.h"
#include "run/input/input.h"

/** vg_effects_find with the settings that were read. */
vg_status vg_boundary_effects(const struct vg_boundary *b,
                              const struct vg_mesh *front,
                              const struct vg_sizing *sizing,
                              struct vg_effects *out, struct vg_error *err);

/** Adds a note for each limited and each unresolved source, the first
 * VG_SHOWN_LIMITED of each kind (of limited sources of one group only the
 * first), and one note for all sources outside the
 * fluid. front: as for vg_effects_find; s: settings with the sources. */
#define VG_SHOWN_LIMITED 10
void vg_effects_note(const struct vg_effects *h, const struct vg_mesh *front,
                     const struct vg_settings *s, struct vg_notes *notes);

/** All of them: "limited" (by the surface), "unresolved", "inside_body"
 * and "outside_domain". */
json_t *vg_effects_json(const struct vg_effects *h, const struct vg_mesh *front,
                        const struct vg_settings *s);

#endif
