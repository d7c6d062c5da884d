/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/memory.h: allocation with overflow checks. All functions return NULL if
 * there is not enough memory. */
#ifndef VG_BASE_MEMORY_H
#define VG_BASE_MEMORY_H

#include <stddef.h>
#include <stdio.h>

/** n * size bytes, uninitialised; never a zero-byte block. free() it. */
void *vg_alloc(size_t n, size_t size);

/** As vg_alloc, zeroed. */
void *vg_calloc(size_t n, size_t size);

/** Resize a block to n * size bytes; NULL leaves the old block valid. */
void *vg_realloc(void *block, size_t n, size_t size);

/** Make room for at least `need` items of `size` bytes in *block, growing by
 * half.
 *
 * @param block  in/out: address of the array pointer, e.g. &list
 * @param cap    in/out: number of items that the array can hold
 * Returns 0, or -1 if there is not enough memory (array and cap are
 * unchanged). */
int vg_reserve(void *block, size_t *cap, size_t need, size_t size);

/** As open_memstream(3), but a text for which there was not enough memory is
 * never taken for a whole one: fclose then fails, and *text is NULL. (With
 * open_memstream of glibc 2.36, fclose and ferror return 0 if the text lacks
 * bytes or is NULL.) *text and *size are set by fclose only. */
FILE *vg_text_open(char **text, size_t *size);

/** Return the free memory of the heap to the system, after a stage that freed
 * much. Otherwise it stays with the process, in gaps in which the arrays of the
 * next stage may not fit. Threads: safe. */
void vg_memory_trim(void);

#endif
