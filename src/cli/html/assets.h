/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/html/assets.h: files of share/html, embedded in the program. Private to
 * cli/html. */
#ifndef VG_CLI_HTML_ASSETS_H
#define VG_CLI_HTML_ASSETS_H

#include <stddef.h>

extern const unsigned char vg_asset_report_css[], vg_asset_report_js[];
extern const size_t vg_asset_report_css_size, vg_asset_report_js_size;

#endif
