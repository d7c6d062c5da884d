/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/stream.h: input and output functions for all readers and writers.
 * Uses base only.
 *
 * Input is a complete file in memory with a cursor. Files compressed by gzip
 * are unpacked; they are recognised by their first two bytes, not by their
 * name. Binary reads are checked against the end of the data; the byte order is
 * that of the host unless `swap` is set. Text reads do not depend on the
 * locale.
 *
 * A reader of format X has two functions: vg_X_read(path, ...) opens the file
 * and calls vg_X_parse(struct vg_input *, ...), which fuzzers call directly.
 *
 * Output goes to PATH.part, which is renamed when it is complete, or to any
 * offset of a file that all ranks write (io/stream/shared_file.h). */
#ifndef VG_IO_STREAM_STREAM_H
#define VG_IO_STREAM_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/status.h"

struct vg_shared_file;

struct vg_input {
  char *path;          /* name in messages; owned */
  unsigned char *data; /* data[size] is a zero byte */
  size_t size, at;     /* cursor: next byte to read */
  size_t line;         /* 1-based line of the cursor (text reads only) */
  int swap;            /* 1: values have the opposite byte order */
  int marker8;         /* 1: Fortran markers have 8 bytes */
  int comment; /* character that starts a comment up to the end of the line
                  in token reads; 0: none */
  int is_view; /* view of another input, which owns path and data */
};
#define VG_INPUT_INIT                                                          \
  {                                                                            \
    .line = 1                                                                  \
  } /* releasing this is a no-op */

/** Read a file into the empty *in, unpacking gzip. A UTF-8 byte order mark at
 * the start of a text is removed.
 * VG_ERR_IO: missing, a directory or unreadable; VG_ERR_FORMAT: empty, damaged
 * or truncated gzip data, or a Git LFS pointer in place of the file;
 * VG_ERR_MEMORY. *in is unchanged on failure. */
vg_status vg_input_open(const char *path, struct vg_input *in,
                        struct vg_error *err);

/** As vg_input_open, but reads only about the first `limit` bytes (of the
 * compressed file), enough to examine a header. */
vg_status vg_input_open_head(const char *path, size_t limit,
                             struct vg_input *in, struct vg_error *err);

/** As vg_input_open for bytes in memory, which are copied; `name` is used in
 * messages. */
vg_status vg_input_memory(const char *name, const void *data, size_t size,
                          struct vg_input *in, struct vg_error *err);

void vg_input_release(struct vg_input *in);

/** Returns 1 if the host is little-endian. */
int vg_host_is_little(void);

/** Set the byte order of the values that follow. */
void vg_input_order(struct vg_input *in, int is_big);

/** Number of bytes from the cursor to the end. */
size_t vg_input_left(const struct vg_input *in);

/** Fail with VG_ERR_FORMAT ("truncated") unless at least n items of `size`
 * bytes are left. Call it before allocating memory for a count read from the
 * file. */
vg_status vg_input_need(const struct vg_input *in, uint64_t n, size_t size,
                        const char *what, struct vg_error *err);

/** Read n values in the byte order that was set. The cursor does not move on
 * failure. `what` names the values in the message. The f32 variant converts to
 * double. */
vg_status vg_input_i32(struct vg_input *in, size_t n, int32_t *v,
                       const char *what, struct vg_error *err);
vg_status vg_input_i64(struct vg_input *in, size_t n, int64_t *v,
                       const char *what, struct vg_error *err);
vg_status vg_input_f32(struct vg_input *in, size_t n, double *v,
                       const char *what, struct vg_error *err);
vg_status vg_input_f64(struct vg_input *in, size_t n, double *v,
                       const char *what, struct vg_error *err);
vg_status vg_input_skip(struct vg_input *in, size_t bytes, const char *what,
                        struct vg_error *err);

/** Next Fortran sequential record, as a view with the same byte order that
 * needs no release and is valid as long as `in`; the cursor moves past the
 * record. Subrecords (formats.md 1.1) are joined in place, so a record can be
 * read only once. VG_ERR_FORMAT names the offset and the markers. */
vg_status vg_input_record(struct vg_input *in, struct vg_input *record,
                          const char *what, struct vg_error *err);

/* --- text --- */

/** Next token, delimited by white space. Returns 0 at the end of the data.
 * *text points into the data and is not terminated. */
int vg_input_token(struct vg_input *in, const char **text, size_t *len);

/** Next token of the current line. Returns 0 at the end of the line, where the
 * cursor stays. */
int vg_input_token_in_line(struct vg_input *in, const char **text, size_t *len);

/** Remainder of the current line without its end (LF or CR LF), which the
 * cursor passes. Returns 0 at the end of the data. */
int vg_input_line(struct vg_input *in, const char **text, size_t *len);

/** Next token as a number. Error messages give the line, the token and `what`,
 * and say if the data are binary. Reals that are not finite are errors. */
vg_status vg_input_int(struct vg_input *in, int64_t *v, const char *what,
                       struct vg_error *err);
vg_status vg_input_real(struct vg_input *in, double *v, const char *what,
                        struct vg_error *err);

/** Returns 1 if the first 64 KB contain no zero byte and no control character
 * other than white space. */
int vg_input_is_text(const struct vg_input *in);

/** Is the token text[0 .. len) exactly the string s? */
int vg_token_is(const char *text, size_t len, const char *s);

/** Convert a complete token to a number; returns 1 on success. Reals are
 * correctly rounded, also with Fortran exponents (1.5D-3, 1.5-100). NaN,
 * infinity and values that overflow are errors. */
int vg_parse_int(const char *text, size_t len, int64_t *v);
int vg_parse_real(const char *text, size_t len, double *v);

/** Fail with "PATH:LINE: message" for the position of the cursor, formatted as
 * by printf. */
vg_status vg_input_fail(const struct vg_input *in, struct vg_error *err,
                        const char *format, ...)
  __attribute__((format(printf, 3, 4)));

/* --- output --- */

/** Largest number of data bytes in a Fortran subrecord (gfortran). */
#define VG_RECORD_LIMIT 2147483639u

struct vg_output {
  char *path, *part; /* owned */
  int fd;
  unsigned char *buffer;
  size_t n;              /* bytes in the buffer */
  uint64_t written;      /* bytes written so far, including the buffer */
  int swap;              /* 1: write the opposite byte order */
  int error;             /* errno of the first failed write; 0: none */
  uint32_t record_limit; /* VG_RECORD_LIMIT; tests may set a smaller value */
  uint64_t record_left;  /* data bytes that the open record still expects */
  uint32_t part_len, part_left; /* length of the open subrecord, and bytes it
                                   still expects */
  int record_open, part_first;
  struct vg_shared_file *shared; /* used instead of fd; NULL: bytes are only
                                    counted */
  uint64_t at;                   /* offset of the buffer in the shared file */
  int no_markers;         /* markers are skipped: another rank writes them */
  struct vg_error failed; /* first error in a shared file, if `error` is set */
};
#define VG_OUTPUT_INIT                                                         \
  {                                                                            \
    .fd = -1, .record_limit = VG_RECORD_LIMIT                                  \
  }

/** PATH.part, the name of a file until it is complete. NULL if there is not
 * enough memory. */
char *vg_output_part(const char *path);

/** Start writing PATH.part. The write functions below return no status: the
 * first error is kept, and vg_output_commit returns it. */
vg_status vg_output_open(const char *path, struct vg_output *out,
                         struct vg_error *err);

/** Flush, close and rename to the final name; releases *out. On failure the
 * .part file is removed and an existing file of that name is unchanged. */
vg_status vg_output_commit(struct vg_output *out, struct vg_error *err);

/** Write all buffered data and return the first error, if any. For several
 * files that should appear together: call it for all before the first
 * commit. */
vg_status vg_output_flush(struct vg_output *out, struct vg_error *err);

/** Remove the .part file unless it was committed. Accepts an initialised
 * output. */
void vg_output_release(struct vg_output *out);

/** Write into a file shared by all ranks, from its start. The file is borrowed;
 * the caller closes it after vg_output_flush (for errors) and
 * vg_output_release. With NULL nothing is written, but `written` counts the
 * bytes. */
vg_status vg_output_shared(struct vg_shared_file *file, struct vg_output *out,
                           struct vg_error *err);

/** Move to an offset of a shared file, outside of any record. */
void vg_output_seek(struct vg_output *out, uint64_t at);

/** Move to data byte `offset` of a record of `bytes` bytes whose first marker
 * is at file offset `at`. The writer of the frame writes its markers. */
void vg_output_seek_record(struct vg_output *out, uint64_t at, uint64_t bytes,
                           uint64_t offset);

/** Skip n bytes that others write; only for shared files. If a record is open,
 * its markers are still written. */
void vg_output_skip(struct vg_output *out, uint64_t n);

/** Size of a Fortran record in a file, including its markers; limit as
 * record_limit. */
uint64_t vg_record_size(uint64_t bytes, uint32_t limit);

/** Set the byte order of the values that follow. */
void vg_output_order(struct vg_output *out, int is_big);

void vg_output_bytes(struct vg_output *out, const void *data, size_t n);
void vg_output_i32(struct vg_output *out, size_t n, const int32_t *v);
void vg_output_i64(struct vg_output *out, size_t n, const int64_t *v);
void vg_output_f64(struct vg_output *out, size_t n, const double *v);
/** Write n values rounded to single precision. */
void vg_output_f32(struct vg_output *out, size_t n, const double *v);

/** Open a Fortran record of `bytes` data bytes; exactly that many must follow
 * before vg_output_record_end. Markers and subrecords are those of gfortran. */
void vg_output_record(struct vg_output *out, uint64_t bytes);
void vg_output_record_end(struct vg_output *out);

/** Write text: a string, printf output (no reals, since they depend on the
 * locale), an integer, or a real that reads back to the same bits (15 digits if
 * they suffice, else 17). */
void vg_output_text(struct vg_output *out, const char *s);
/** Write a string with the special characters of markup escaped. */
void vg_output_markup(struct vg_output *out, const char *s);
void vg_output_format(struct vg_output *out, const char *format, ...)
  __attribute__((format(printf, 2, 3)));
void vg_output_int(struct vg_output *out, int64_t v);
void vg_output_real(struct vg_output *out, double v);

/** Version of zlib. */
void vg_library_zlib(struct vg_library *out);

/** Write the text of vg_output_real into text[32]; returns its length. */
size_t vg_format_real(double v, char *text);

#endif
