/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/markup.h: escaping of characters that are special in HTML and XML. */
#ifndef VG_BASE_MARKUP_H
#define VG_BASE_MARKUP_H

#include <stddef.h>

/** Entity for the character c in text and in attribute values in double quotes;
 * NULL if c needs none. */
static inline const char *vg_markup_entity(char c)
{
  return c == '&' ? "&amp;"
       : c == '<' ? "&lt;"
       : c == '>' ? "&gt;"
       : c == '"' ? "&quot;"
                  : NULL;
}

#endif
