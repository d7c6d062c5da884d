/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/model/phase.h"

/* Names and labels of the phases, whether they count as outside the tasks, and
 * the fractions of their time that one thread does alone and that every node
 * does for itself; the remainder is parallel over all workers. Fractions are
 * from profiles of one thread (M8). */
static const struct {
  const char *name, *label;
  int is_outside;
  double alone, by_node;
} phases[VG_PHASE_N] = {
  { "read", "read", 0, 1, 0 },
  { "check", "surface check", 1, 0.2, 0.8 },
  { "sizes", "sizing field", 1, 0.05, 0.20 },
  { "layers", "layers", 1, 0.12, 0.27 },
  { "cut+fill", "cut+fill", 0, 1, 0 },
  { "number", "numbering", 0, 1, 0 },
  { "judge", "mesh check", 1, 0.01, 0 },
  { "write", "write", 1, 0.4, 0 },
  { "total", "total", 0, 1, 0 },
};

const char *vg_phase_name(enum vg_phase phase)
{
  return phases[phase].name;
}

const char *vg_phase_label(enum vg_phase phase)
{
  return phases[phase].label;
}

void vg_phase_shares(enum vg_phase phase, double *alone, double *by_node)
{
  *alone = phases[phase].alone;
  *by_node = phases[phase].by_node;
}

int vg_phase_is_outside(enum vg_phase phase)
{
  return phases[phase].is_outside;
}
