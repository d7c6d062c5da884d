/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Malformed and hostile files, made by a program so that the defect of each one
 * can be read here. Each table below is one kind of defect. */
#ifndef VG_TESTS_HOSTILE_H
#define VG_TESTS_HOSTILE_H

#include <stddef.h>
#include <stdint.h>

/** How `vanguard` must treat the file. */
enum hostile_verdict {
  REFUSED, /* exit status 1, stderr names the file */
  MENDED   /* `check` repairs it without guessing, reports it, status 0 */
};

/** One case. Exactly one of `text` and `make` is set. */
struct hostile {
  const char *file;   /* argument of the command */
  const char *phrase; /* that the program's answer must contain */
  enum hostile_verdict verdict;
  const char *text;               /* content of the file */
  void (*make)(const char *file); /* writes it, and the files next to it */
  const char *command;            /* subcommand and options; NULL: "check" */
};

extern const struct hostile hostile_texts[], hostile_binaries[],
  hostile_volumes[], hostile_shapes[],
  hostile_projects[]; /* each ends with file NULL */

/** Bytes of a binary file under construction. */
struct bytes {
  unsigned char b[8192];
  size_t n;
  int big; /* byte order of the values that are appended */
};
void put_raw(struct bytes *b, const void *data, size_t n);
void put_i32(struct bytes *b, int32_t v);
void put_i64(struct bytes *b, int64_t v);
void put_f32(struct bytes *b, float v);
void put_f64(struct bytes *b, double v);

/** Write a file in the current folder; ends the program if that fails. */
void save(const char *file, const void *data, size_t n);
void save_text(const char *file, const char *text);

#endif
