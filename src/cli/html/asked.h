/* Private to cli/html: the settings that a page lists. */
#ifndef VG_CLI_HTML_ASKED_H
#define VG_CLI_HTML_ASKED_H

#include "cli/html/html.h"

/** Setting i of the plain ones and, behind them, of the farfield, and where
 * its value lies. Returns how many there are; beyond, nothing is set. */
size_t vg_asked_params(const struct vg_settings *s, size_t i,
                       const struct vg_param **param, const void **base);

#endif
