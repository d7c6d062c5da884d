/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/phase.h: the phases of a run, their names, and the parallel
 * fractions of their times. All functions are pure and thread-safe. */
#ifndef VG_PARTITION_MODEL_PHASE_H
#define VG_PARTITION_MODEL_PHASE_H

/** Phases of a run in order. VG_PHASE_ENGINE is cutting and filling. */
enum vg_phase {
  VG_PHASE_READ,
  VG_PHASE_CHECK,
  VG_PHASE_SIZES,
  VG_PHASE_LAYERS,
  VG_PHASE_ENGINE,
  VG_PHASE_NUMBER,
  VG_PHASE_JUDGE,
  VG_PHASE_WRITE,
  VG_PHASE_TOTAL,
  VG_PHASE_N
};

/** "read", "check", "sizes", "layers", "cut+fill", "number", "judge", "write",
 * "total". Static storage. */
const char *vg_phase_name(enum vg_phase phase);

/** Name of a phase in texts and plots: "surface check", ... Static storage. */
const char *vg_phase_label(enum vg_phase phase);

/** Fractions of the time of a phase on one core that one thread does alone, and
 * that every node does for itself; the remainder is parallel over all workers
 * (row M8). */
void vg_phase_shares(enum vg_phase phase, double *alone, double *by_node);

/** 1: the time of the phase counts as outside the tasks. */
int vg_phase_is_outside(enum vg_phase phase);

#endif
