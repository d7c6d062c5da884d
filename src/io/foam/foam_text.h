/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/foam/foam_text.h: OpenFOAM's files: a header, dictionaries and lists, in
 * text or binary. Private to its module.
 *
 * Numbers of a binary list follow its opening parenthesis directly, in the
 * byte order and sizes that the header's `arch` names ("LSB;label=32;scalar=64"
 * without it). Comments are those of C++. */
#ifndef VG_IO_FOAM_FOAM_TEXT_H
#define VG_IO_FOAM_FOAM_TEXT_H

#include "io/stream/stream.h"

struct vg_foam_text {
  struct vg_input in;
  char class_name[64]; /* `class` of the header */
  int is_binary, label_size, scalar_size;
};
#define VG_FOAM_TEXT_INIT                                                      \
  {                                                                            \
    .in = VG_INPUT_INIT                                                        \
  }

/** Path of FOLDER/NAME, or of FOLDER/NAME.gz if only that exists; to be freed.
 * has: out: 1 if one of them exists; may be NULL. NULL if there is not enough
 * memory. */
char *vg_foam_find_file(const char *folder, const char *name, int *has);

/** Open the file of vg_foam_find_file and read its header. Release it in any
 * case. VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_MEMORY. */
vg_status vg_foam_text_open(const char *folder, const char *name,
                            struct vg_foam_text *f, struct vg_error *err);

/** Read the header of the file in f->in. */
vg_status vg_foam_text_head(struct vg_foam_text *f, struct vg_error *err);

void vg_foam_text_release(struct vg_foam_text *f);

/** Next token: one of ( ) { } [ ] ; or a string with its quotes, or a word or
 * number. Returns 0 at the end. *text points into the data. */
int vg_foam_token(struct vg_foam_text *f, const char **text, size_t *len);

/** The next token must be `s`. */
vg_status vg_foam_expect(struct vg_foam_text *f, const char *s,
                         const char *what, struct vg_error *err);

/** Skip the value of an entry and the semicolon at its end, or a dictionary. */
vg_status vg_foam_skip_value(struct vg_foam_text *f, struct vg_error *err);

/** A number, or `width` numbers in parentheses; always text. */
vg_status vg_foam_item(struct vg_foam_text *f, const char *what, int width,
                       double *v, struct vg_error *err);

/** A list of labels, or of reals with `width` components each.
 * @param most  largest number of items; more are VG_ERR_FORMAT
 * @param n     out: items; *v: allocated, [n] or [n * width], to be freed */
vg_status vg_foam_labels(struct vg_foam_text *f, const char *what, size_t most,
                         size_t *n, int64_t **v, struct vg_error *err);
vg_status vg_foam_reals(struct vg_foam_text *f, const char *what, int width,
                        size_t most, size_t *n, double **v,
                        struct vg_error *err);

#endif
