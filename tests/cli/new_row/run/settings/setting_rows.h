/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The rows of the program, plus three rows for test_new_row.c. */
#include "../../../../../src/run/settings/setting_rows.h"

VG_ROW(REAL, plain, tip_size, "tip_size", 0.125, .hi = 1, .unit = "length",
       .help = "edge at the tip")
VG_ROW(COUNT, layer, tip_sweeps, "tip_sweeps", 3, .keeps_mesh = 1, .hi = 9,
       .unit = "sweeps", .help = "sweeps at the tip")
VG_TEXT_ROW(plain, tip_name, 40, "tip_name", "none", .unit = "",
            .argument = "NAME", .help = "name of the tip")
