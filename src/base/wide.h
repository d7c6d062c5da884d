/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/wide.h: variants of functions for processors with AVX2. Uses nothing.
 *
 * A loop over lanes is written once, as a VG_WITHIN function without calls, and
 * compiled twice: into a plain function, and into one with VG_WIDE, which the
 * plain one calls if VG_IS_WIDE. The operations of a lane are the same in both,
 * and no products are fused, so that they give the same bits:
 *
 *     VG_WITHIN void add(...) { ... }
 *     #ifdef VG_WIDE
 *     static VG_WIDE void add_wide(...) { add(...); }
 *     #endif
 *
 * With VG_PORTABLE defined the wide variants are left out, for comparisons. */
#ifndef VG_BASE_WIDE_H
#define VG_BASE_WIDE_H

#define VG_WITHIN static inline __attribute__((always_inline))

#if defined __x86_64__ && !defined VG_PORTABLE
#define VG_WIDE __attribute__((target("avx2")))
#define VG_IS_WIDE __builtin_cpu_supports("avx2")
#else
#define VG_IS_WIDE 0
#endif

#endif
