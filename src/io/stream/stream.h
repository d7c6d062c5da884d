/* io/stream/stream.h: what every reader and writer stands on. Uses base only.
 *
 * Input is a whole file in memory (gzip'd files are unpacked, told by their
 * first two bytes, not by name) with a cursor. Binary reads are checked
 * against the end; the byte order is that of the host unless `swap` is set.
 * Text reads do not depend on the locale.
 *
 * A reader of format X has two entries: vg_X_read(path, ...) opens the file
 * and calls vg_X_parse(struct vg_input *, ...), which fuzzers call directly.
 *
 * Output goes to PATH.part and gets its name by rename when complete; or into
 * a file that all ranks write, at any place of it (io/stream/shared_file.h). */
#ifndef VG_IO_STREAM_STREAM_H
#define VG_IO_STREAM_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/status.h"

struct vg_shared_file;

struct vg_input {
  char *path;          /* for messages; owned */
  unsigned char *data; /* data[size] is a zero byte */
  size_t size, at;     /* cursor: next byte to read */
  size_t line;         /* 1-based line of the cursor (text reads only) */
  int swap;            /* 1: values have the other byte order */
  int marker8;         /* 1: Fortran markers of 8 bytes */
  int comment;         /* a character that starts a comment reaching to the
                          end of the line in token reads; 0: none */
  int is_view;         /* part of another input, which owns path and data */
};
#define VG_INPUT_INIT                                                          \
  {                                                                            \
    .line = 1                                                                  \
  } /* releasing this is a no-op */

/** Read a file into the empty *in, unpacking gzip. The byte order mark of
 * UTF-8 at the start of a text is dropped.
 * VG_ERR_IO: missing, a directory, unreadable; VG_ERR_FORMAT: empty, broken
 * or truncated gzip, a pointer of Git LFS in the place of the file;
 * VG_ERR_MEMORY. *in is untouched on failure. */
vg_status vg_input_open(const char *path, struct vg_input *in,
                        struct vg_error *err);

/** As vg_input_open, but only about the first `limit` bytes (of the packed
 * file), to look at a header. */
vg_status vg_input_open_head(const char *path, size_t limit,
                             struct vg_input *in, struct vg_error *err);

/** As vg_input_open for bytes in memory (copied); `name` is for messages. */
vg_status vg_input_memory(const char *name, const void *data, size_t size,
                          struct vg_input *in, struct vg_error *err);

void vg_input_release(struct vg_input *in);

/** 1 when the host stores the lowest byte first. */
int vg_host_is_little(void);

/** Declare the byte order of the values that follow. */
void vg_input_order(struct vg_input *in, int is_big);

/** Bytes from the cursor to the end. */
size_t vg_input_left(const struct vg_input *in);

/** Fail (VG_ERR_FORMAT, "truncated") unless n items of `size` bytes are left.
 * To be called before allocating what a count in the file asks for. */
vg_status vg_input_need(const struct vg_input *in, uint64_t n, size_t size,
                        const char *what, struct vg_error *err);

/** Read n values, swapped as declared; the cursor stays on failure.
 * `what` names them in the message. The f32 form widens to double. */
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

/** Next Fortran sequential record as a view of its own (same byte order),
 * which needs no release and lives as long as `in`; the cursor moves behind
 * the record. Subrecords (formats.md 1.1) are joined in place, so a record
 * can be read once only. VG_ERR_FORMAT names the offset and the markers. */
vg_status vg_input_record(struct vg_input *in, struct vg_input *record,
                          const char *what, struct vg_error *err);

/* --- text --- */

/** Next token (characters up to white space). 0 at the end of the data.
 * *text points into the data and is not terminated. */
int vg_input_token(struct vg_input *in, const char **text, size_t *len);

/** Next token of the current line; 0 at its end (which is not passed). */
int vg_input_token_in_line(struct vg_input *in, const char **text, size_t *len);

/** Rest of the current line without its end (LF or CR LF), which is passed.
 * 0 at the end of the data. */
int vg_input_line(struct vg_input *in, const char **text, size_t *len);

/** Next token as a number; failures name line, token and `what`, and say
 * when the data are binary. Non-finite reals are refused. */
vg_status vg_input_int(struct vg_input *in, int64_t *v, const char *what,
                       struct vg_error *err);
vg_status vg_input_real(struct vg_input *in, double *v, const char *what,
                        struct vg_error *err);

/** 1 when the first 64 KB hold no zero byte and no other control character
 * than white space. */
int vg_input_is_text(const struct vg_input *in);

/** Is token text[0..len) the string s, exactly? */
int vg_token_is(const char *text, size_t len, const char *s);

/** Whole token as a number: 1 on success. Reals: correctly rounded, also
 * with Fortran exponents (1.5D-3, 1.5-100); NaN, infinity and what
 * overflows are refused. */
int vg_parse_int(const char *text, size_t len, int64_t *v);
int vg_parse_real(const char *text, size_t len, double *v);

/** Fail with "PATH:LINE: message" at the cursor, printf-wise. */
vg_status vg_input_fail(const struct vg_input *in, struct vg_error *err,
                        const char *format, ...)
  __attribute__((format(printf, 3, 4)));

/* --- output --- */

/** Data bytes of a Fortran record beyond which it is cut (gfortran). */
#define VG_RECORD_LIMIT 2147483639u

struct vg_output {
  char *path, *part; /* owned */
  int fd;
  unsigned char *buffer;
  size_t n;                     /* bytes in the buffer */
  uint64_t written;             /* bytes put so far, buffer included */
  int swap;                     /* 1: write the other byte order */
  int error;                    /* errno of the first failed write; 0: none */
  uint32_t record_limit;        /* VG_RECORD_LIMIT; a test may set less */
  uint64_t record_left;         /* data bytes the open record still expects */
  uint32_t part_len, part_left; /* of the open subrecord */
  int record_open, part_first;
  struct vg_shared_file *shared; /* instead of fd; NULL: only measured */
  uint64_t at;            /* shared: where in the file the buffer belongs */
  int no_markers;         /* markers are passed over: another writes them */
  struct vg_error failed; /* shared: why, when error is set */
};
#define VG_OUTPUT_INIT                                                         \
  {                                                                            \
    .fd = -1, .record_limit = VG_RECORD_LIMIT                                  \
  }

/** PATH.part, the name of a file until it is complete. NULL: no memory. */
char *vg_output_part(const char *path);

/** Start writing PATH.part. Write calls below cannot fail visibly: the first
 * error is kept and reported by vg_output_commit. */
vg_status vg_output_open(const char *path, struct vg_output *out,
                         struct vg_error *err);

/** Flush, close and rename to the final name; releases *out. On failure the
 * .part file is removed and an earlier file of that name is untouched. */
vg_status vg_output_commit(struct vg_output *out, struct vg_error *err);

/** Hand everything to the system and report an error so far: for several
 * files that should appear together, before the first is committed. */
vg_status vg_output_flush(struct vg_output *out, struct vg_error *err);

/** Drop the .part file unless committed. Accepts an initialised output. */
void vg_output_release(struct vg_output *out);

/** Write into a file of all ranks, from its start; borrowed, and to be closed
 * by the caller after vg_output_flush (for errors) and vg_output_release.
 * NULL: nothing is written, but `written` tells how much would be. */
vg_status vg_output_shared(struct vg_shared_file *file, struct vg_output *out,
                           struct vg_error *err);

/** Go to a place of a shared file, outside of any record. */
void vg_output_seek(struct vg_output *out, uint64_t at);

/** Go to data byte `offset` of a record of `bytes` bytes that starts (with
 * its first marker) at `at`. Its markers are left to who writes the frame. */
void vg_output_seek_record(struct vg_output *out, uint64_t at, uint64_t bytes,
                           uint64_t offset);

/** Leave n bytes to others: only for shared files. Markers of a record that
 * is open are written where they belong. */
void vg_output_skip(struct vg_output *out, uint64_t n);

/** Bytes of a Fortran record in a file, with its markers; limit as
 * record_limit. */
uint64_t vg_record_size(uint64_t bytes, uint32_t limit);

/** Declare the byte order of the values that follow. */
void vg_output_order(struct vg_output *out, int is_big);

void vg_output_bytes(struct vg_output *out, const void *data, size_t n);
void vg_output_i32(struct vg_output *out, size_t n, const int32_t *v);
void vg_output_i64(struct vg_output *out, size_t n, const int64_t *v);
void vg_output_f64(struct vg_output *out, size_t n, const double *v);
/** Narrowed to 32 bits. */
void vg_output_f32(struct vg_output *out, size_t n, const double *v);

/** Open a Fortran record of `bytes` data bytes; exactly these must follow
 * before vg_output_record_end. Markers and subrecords are set as gfortran
 * does. */
void vg_output_record(struct vg_output *out, uint64_t bytes);
void vg_output_record_end(struct vg_output *out);

/** Text: a string; printf (no reals: the locale would show); an integer; a
 * real that reads back to the same bits (15 digits where these suffice, 17
 * otherwise). */
void vg_output_text(struct vg_output *out, const char *s);
/** A string with the characters of markup escaped. */
void vg_output_markup(struct vg_output *out, const char *s);
void vg_output_format(struct vg_output *out, const char *format, ...)
  __attribute__((format(printf, 2, 3)));
void vg_output_int(struct vg_output *out, int64_t v);
void vg_output_real(struct vg_output *out, double v);

/** Which zlib this is. */
void vg_library_zlib(struct vg_library *out);

/** The text of vg_output_real into text[32]; returns its length. */
size_t vg_format_real(double v, char *text);

#endif
