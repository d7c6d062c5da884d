/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/free_memory.h: memory that the processes of a node may use. */
#ifndef VG_RUN_COMMON_FREE_MEMORY_H
#define VG_RUN_COMMON_FREE_MEMORY_H

/** Bytes that are free on this machine, and in the control groups (version 1
 * or 2) of this process, whichever is less. Pages of files that the kernel can
 * drop count as free. Infinite if the system does not state it.
 * @param root  folder with the files of /proc and /sys, for tests; "": those of
 *              the system */
double vg_free_memory(const char *root);

/** Bytes of this process in memory, without free memory of its heap, which the
 * next stage uses. *heap: that free memory. 0 if the system does not state
 * them. */
double vg_used_memory(double *heap);

#endif
