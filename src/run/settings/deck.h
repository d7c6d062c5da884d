/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/deck.h: the run deck, a text file with all settings that the
 * mesh files do not contain, modelled on USM3D's input file. Its grammar is
 * documented in docs/reference/deck.md:
 *
 *   title line
 *   names            one line of names above one line of values,
 *   values           blocks in any order
 *   sources          a table: its name alone on a line, one line of column
 *   names            names, then one line of values per row, up to a blank
 *   values           line or the end of the file
 *   ...
 *
 * '#' starts a comment; "two words" are one value. Uses
 * run/settings/settings.h. */
#ifndef VG_RUN_SETTINGS_DECK_H
#define VG_RUN_SETTINGS_DECK_H

#include "core/mesh/mesh.h"
#include "run/settings/settings.h"

/** Parse a deck in memory; entry point of the fuzzer.
 *
 * @param name  file name for messages, which all begin with name:line
 * @param s     receives the settings; defaults where the deck gives none;
 *              unchanged on failure
 * Returns VG_ERR_FORMAT for errors of grammar, VG_ERR_INPUT for invalid
 * values. */
vg_status vg_deck_parse(const char *name, const void *data, size_t size,
                        struct vg_settings *s, struct vg_error *err);

/** As vg_deck_parse, but reads a file. */
vg_status vg_deck_read(const char *path, struct vg_settings *s,
                       struct vg_error *err);

/** Content of a deck: all settings, with or without an explanation of each
 * value (unit and default), or only those that differ from the default. */
enum vg_deck_form { VG_DECK_ALL, VG_DECK_EXPLAINED, VG_DECK_CHANGED };

/** Write a deck that vg_deck_parse reads back to equal settings.
 *
 * @param comment  lines written after the title, each starting with '#'; may
 *                 be NULL */
vg_status vg_deck_write(const char *path, const struct vg_settings *s,
                        const char *comment, enum vg_deck_form form,
                        struct vg_error *err);

/** Append one row to the patch table for every patch of m, except the backs of
 * inner surfaces, which are not in the input. */
vg_status vg_deck_patches_of(const struct vg_mesh *m, struct vg_settings *s,
                             struct vg_error *err);

#endif
