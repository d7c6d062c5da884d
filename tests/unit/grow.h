/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Arrays that tests fill one by one. */
#ifndef VG_TESTS_GROW_H
#define VG_TESTS_GROW_H

#include <malloc.h>
#include <stdlib.h>

/* The array with room for item n; doubled if it is full, because ASan maps
 * large blocks to new pages at each reallocation. */
static inline void *grown(void *array, size_t n, size_t size)
{
  size_t need = (n + 1) * size;

  return array && malloc_usable_size(array) >= need ? array
                                                    : realloc(array, 2 * need);
}

#define GROW(array, n) ((array) = grown((array), (n), sizeof *(array)))

#endif
