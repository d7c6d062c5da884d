/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: files of share, embedded in the program. */
#ifndef VG_CLI_SERVE_ASSETS_H
#define VG_CLI_SERVE_ASSETS_H

#include <stddef.h>

extern const unsigned char vg_asset_portal_css[], vg_asset_portal_js[],
  vg_asset_form_js[], vg_asset_case_js[], vg_asset_vanguard_sbatch[];
extern const size_t vg_asset_portal_css_size, vg_asset_portal_js_size,
  vg_asset_form_js_size, vg_asset_case_js_size, vg_asset_vanguard_sbatch_size;

#endif
