/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/scene/assets.h: the script that draws a scene (share/html/view.js),
 * embedded in the program. */
#ifndef VG_CLI_SCENE_ASSETS_H
#define VG_CLI_SCENE_ASSETS_H

#include <stddef.h>

extern const unsigned char vg_asset_view_js[];
extern const size_t vg_asset_view_js_size;

#endif
