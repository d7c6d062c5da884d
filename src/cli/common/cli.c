/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/common/cli.h"

#include <stdio.h>

#include "run/common/log.h"
#include "run/common/text.h"

int vg_cli_exit(const struct vg_error *err)
{
  return err->code == VG_ERR_USAGE ? VG_EXIT_USAGE : VG_EXIT_FAILED;
}

int vg_cli_fail(const struct vg_error *err)
{
  fflush(stdout);
  fprintf(stderr, "vanguard: %s\n", err->text);
  if (vg_log()) fprintf(vg_log(), "vanguard: %s\n", err->text);
  return vg_cli_exit(err);
}

void vg_cli_put_error(json_t *report, const struct vg_error *err)
{
  json_object_set_new(report, "error", vg_text_json(err->text));
  json_object_set_new(report, "error_kind",
                      json_string(vg_status_name(err->code)));
}
