/* base/markup.h: characters that HTML and XML do not take as they are. */
#ifndef VG_BASE_MARKUP_H
#define VG_BASE_MARKUP_H

#include <stddef.h>

/** What stands for the character c in elements and in values in double quotes;
 * NULL: the character itself. */
static inline const char *vg_markup_entity(char c)
{
  return c == '&' ? "&amp;"
       : c == '<' ? "&lt;"
       : c == '>' ? "&gt;"
       : c == '"' ? "&quot;"
                  : NULL;
}

#endif
