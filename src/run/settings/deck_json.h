/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/deck_json.h: the run deck as a JSON document, and the JSON
 * Schema that describes such documents. Uses run/settings/settings.h, jansson.
 *
 *   { "title": "...", "settings": { "growth": 1.2, ... },
 *     "farfield": { "kind": "sphere", ... },
 *     "sources": [ { "kind": "point", "x0": 0, "h0": 0.01 }, ... ], ... }
 *
 * Every member is optional. A setting that is not given has the value null, as
 * - in a text deck. Flags are true and false. */
#ifndef VG_RUN_SETTINGS_DECK_JSON_H
#define VG_RUN_SETTINGS_DECK_JSON_H

#include "run/common/json_build.h"
#include "run/settings/settings.h"

/** Is the text a JSON document? */
int vg_deck_is_json(const void *data, size_t size);

/** Parse a deck that is a JSON document. vg_deck_parse and vg_deck_read call
 * this function if the first character is '{', and for an array, which it
 * refuses. Parameters and results are
 * theirs; messages name the member, as in "wing.deck: sources[2].h0: ...". */
vg_status vg_deck_json_parse(const char *name, const void *data, size_t size,
                             struct vg_settings *s, struct vg_error *err);

/** All settings and tables as a document that vg_deck_json_parse reads back to
 * equal settings. The caller releases it; NULL: out of memory. */
json_t *vg_deck_json(const struct vg_settings *s);

/** A row of a table as an object; NULL: the default row. */
json_t *vg_deck_row_json(enum vg_table_kind kind, const void *row);

/** JSON Schema (draft 2020-12) of the documents: types, ranges, units and
 * defaults of all settings and tables, and the conditions between them.
 * Conditions that JSON Schema cannot express, such as hmin <= hmax, are listed
 * as x-conditions. The caller releases it; NULL: out of memory. */
json_t *vg_deck_schema(void);

#endif
