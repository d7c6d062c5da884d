/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* helpers/common/endless.h: proof that a computation never ends. A process with
 * one thread that makes no system calls is a function of its registers and its
 * memory. If both are the same twice, it repeats the same steps for ever.
 * Unlike a time limit, this does not depend on the speed of the machine: a
 * computation that is only slow never has the same state twice.
 *
 * Uses one process-wide state. Needs /proc. */
#ifndef VG_HELPERS_COMMON_ENDLESS_H
#define VG_HELPERS_COMMON_ENDLESS_H

#ifdef __cplusplus
extern "C" {
#endif

/** Forget all states. Returns 0 if memory was refused. */
int vg_endless_start(void);

/** Compare the interrupted computation with an earlier state. Call it in the
 * handler of a timer signal, with the third argument of the handler. Returns 1
 * if the computation is proven to be endless; 0 if it is not, or if the memory
 * cannot be read. */
int vg_endless_look(const void *context);

#ifdef __cplusplus
}
#endif

#endif
