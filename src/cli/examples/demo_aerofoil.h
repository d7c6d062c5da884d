/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/examples/demo_aerofoil.h: plane sections for `vanguard demo`. */
#ifndef VG_CLI_EXAMPLES_DEMO_AEROFOIL_H
#define VG_CLI_EXAMPLES_DEMO_AEROFOIL_H

#include "base/status.h"
#include "cli/examples/demo.h"

/** The cases that are plane sections: "aerofoil", a NACA 0012 with a sharp
 * trailing edge, and "aerofoil-blunt", with a blunt one. *n out: their number.
 * Static storage. */
const struct vg_demo_case *vg_demo_sections(size_t *n);

/** Writes the coordinates of NACA 0012 in Selig's order.
 *
 * @param path      name of the file
 * @param is_blunt  1: the thickness of the NACA report (Abbott and von
 *                  Doenhoff, Theory of Wing Sections, 1959), 0.252 % of the
 *                  chord at the trailing edge; 0: its last coefficient is
 *                  0.1036 instead of 0.1015, which makes the thickness 0
 * VG_ERR_IO, VG_ERR_MEMORY. The same bytes on every machine. */
vg_status vg_demo_aerofoil_write(const char *path, int is_blunt,
                                 struct vg_error *err);

#endif
