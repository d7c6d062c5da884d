/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/names.h: suggestions for unknown names of settings, columns,
 * options and words: the nearest name to a misspelt one, and the name that a
 * word of another mesh generator has here. Uses nothing. */
#ifndef VG_RUN_SETTINGS_NAMES_H
#define VG_RUN_SETTINGS_NAMES_H

#include <stddef.h>

#define VG_SUGGESTED_MAX 2
#define VG_HINT_SIZE 320

/** A list of names: get(user, i) for i < n. */
struct vg_names {
  size_t n;
  const char *(*get)(const void *user, size_t i);
  const void *user;
};

/** Names of a list that the user may have meant; n = 0: none. */
struct vg_suggestion {
  size_t n;
  const char *name[VG_SUGGESTED_MAX];
};

/** Suggest names for `text`, which is not in the list: the names that this word
 * of the field, or the name of an earlier version, has here; else the nearest
 * name, if `text` can be a misspelling of it; else the names of the nearest
 * word of the field. Case, '-' and '_' are not significant. */
void vg_suggest(const char *text, const struct vg_names *names,
                struct vg_suggestion *out);

/** As vg_suggest, but only if `text` is itself a word of the field. */
void vg_suggest_field(const char *text, const struct vg_names *names,
                      struct vg_suggestion *out);

/** Write "did you mean 'growth' or 'ratio'?" with `before` in front of each
 * name; without a suggestion, the text `otherwise`. Returns out. */
const char *vg_hint(const struct vg_suggestion *s, const char *before,
                    const char *otherwise, char out[VG_HINT_SIZE]);

/** vg_suggest and vg_hint. */
const char *vg_hint_for(const char *text, const struct vg_names *names,
                        const char *before, const char *otherwise,
                        char out[VG_HINT_SIZE]);

/** Suggest the name of a setting (vg_settings_name). vg_suggest_place replaces
 * those of columns of the farfield table by their place in a deck:
 * "farfield_size" by "farfield.size". */
void vg_suggest_setting(const char *text, struct vg_suggestion *out);
void vg_suggest_place(struct vg_suggestion *s);

/** Row i of the table of words of the field: the word, in *target the name that
 * it has here. NULL past the end. Static storage. */
const char *vg_field_word(size_t i, const char **target);

#endif
