/* io/stream/patch_words.h: names of patches for formats in which a name is a
 * word. */
#ifndef VG_IO_STREAM_PATCH_WORDS_H
#define VG_IO_STREAM_PATCH_WORDS_H

#include "core/mesh/mesh.h"

#define VG_PATCH_WORD (VG_NAME_MAX + 32)
#define VG_PATCH_WORD_MOST (VG_PATCH_WORD - 1)

/** Names of all patches as words that solvers take: letters, digits and "_-.",
 * a letter first; others become '_', no name "patch_ID". Unique: of equal ones
 * all but the first get their patch number, until nothing clashes.
 * @param most  characters of a word, from 24 to VG_PATCH_WORD_MOST
 * Returns [n_patch], to be freed; NULL: no memory. */
char (*vg_patch_words(const struct vg_mesh *m, size_t most))[VG_PATCH_WORD];

#endif
