/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/patch_words.h: patch names for formats in which a name must be a
 * single word. */
#ifndef VG_IO_STREAM_PATCH_WORDS_H
#define VG_IO_STREAM_PATCH_WORDS_H

#include "core/mesh/mesh.h"

#define VG_PATCH_WORD (VG_NAME_MAX + 32)
#define VG_PATCH_WORD_MOST (VG_PATCH_WORD - 1)

/** Names of all patches as words that solvers accept: letters, digits and
 * "_-.", starting with a letter. Other characters become '_', and a patch
 * without a name is called "patch_ID". All words differ: of several equal ones,
 * all but the first get their patch number appended, until there are no
 * duplicates.
 * @param most  maximum length of a word, from 24 to VG_PATCH_WORD_MOST
 * Returns [n_patch], to be freed; NULL if there is not enough memory. */
char (*vg_patch_words(const struct vg_mesh *m, size_t most))[VG_PATCH_WORD];

/** Names of all zones by the same rules, [n_zone]; a zone without a name is
 * called "zone_ID". */
char (*vg_zone_words(const struct vg_mesh *m, size_t most))[VG_PATCH_WORD];

/** Store `word` in out, or the first of word_1, word_2, ... that differs from
 * the n words of `used`. Upper and lower case do not distinguish words. */
void vg_patch_free_word(const char (*used)[VG_PATCH_WORD], size_t n,
                        const char *word, char out[VG_PATCH_WORD]);

#endif
