/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/common/cli.h"

#include <stdio.h>

#include "run/common/log.h"
#include "run/common/text.h"

int vg_cli_exit(const struct vg_error *err)
{
  return err->code == VG_ERR_USAGE ? VG_EXIT_USAGE : VG_EXIT_FAILED;
}

int vg_cli_written(int status)
{
  int is_lost = vg_print_is_lost();

  if (!fflush(stdout) && !ferror(stdout) && !is_lost) return status;
  fprintf(stderr,
          "vanguard: %sstandard output could not be written completely\n",
          is_lost ? "not enough memory: " : "");
  return status == VG_EXIT_USAGE ? status : VG_EXIT_FAILED;
}

int vg_cli_fail(const struct vg_error *err)
{
  fflush(stdout);
  fprintf(stderr, "vanguard: %s\n", err->text);
  if (vg_log()) fprintf(vg_log(), "vanguard: %s\n", err->text);
  return vg_cli_exit(err);
}
