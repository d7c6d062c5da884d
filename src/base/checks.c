/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Aborts the program when a stage has left a wrong result. */
#include "base/checks.h"

#include <stdio.h>
#include <stdlib.h>

void vg_check_none(const char *stage, const char *what, size_t n_defect)
{
  if (!n_defect) return;
  fprintf(stderr, "vanguard: check failed after %s: %s is %zu, not 0\n", stage,
          what, n_defect);
  abort();
}
