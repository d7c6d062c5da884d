/* Arrays that tests fill one by one. */
#ifndef VG_TESTS_GROW_H
#define VG_TESTS_GROW_H

#include <malloc.h>
#include <stdlib.h>

/* The array with room for item n, twice as much where there is none: ASan
 * moves what is large to pages of its own whenever it grows. */
static inline void *grown(void *array, size_t n, size_t size)
{
  size_t need = (n + 1) * size;

  return array && malloc_usable_size(array) >= need ? array
                                                    : realloc(array, 2 * need);
}

#define GROW(array, n) ((array) = grown((array), (n), sizeof *(array)))

#endif
