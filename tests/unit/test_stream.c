/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include <locale.h>
#include <math.h>
#include <sys/stat.h>

#include "io/stream/stream.h"

/* Random numbers, the same on every run. */
static uint64_t next_random(uint64_t *state)
{
  *state += 0x9e3779b97f4a7c15u;
  uint64_t z = *state;

  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

static void refuse_open(const char *path, vg_status code, const char *phrase)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_input_open(path, &in, &err), code);
  assert_non_null(strstr(err.text, phrase));
  assert_non_null(strstr(err.text, path));
  assert_null(in.data);
}

static void reports_files_that_cannot_be_opened(void **state)
{
  const char *path = io_temp("stream_empty");

  (void)state;
  refuse_open(io_temp("stream_no_such_file"), VG_ERR_IO, "No such file");
  refuse_open(VG_TMP_DIR, VG_ERR_IO, "folder");
  refuse_open("/dev/zero", VG_ERR_IO, "device");
  io_write_file(path, "", 0);
  refuse_open(path, VG_ERR_FORMAT, "empty");
  unlink(path);
}

static void open_bytes(const void *data, size_t size, struct vg_input *in)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_input_memory("case", data, size, in, &err) != VG_OK)
    fail_msg("%s", err.text);
}

#define MARK "\xef\xbb\xbf"

/* In a text the mark is dropped once; in binary data the same bytes stay. */
static void drops_the_byte_order_mark_of_a_text(void **state)
{
  static const char twice[] = MARK MARK "v 1\n", binary[] = MARK "\0\0\1v";
  const char *path = io_temp("stream_marked.txt");
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_write_file(path, MARK "solid a\n", 11);
  assert_int_equal(vg_input_open(path, &in, &err), VG_OK);
  assert_int_equal(in.size, 8);
  assert_string_equal((char *)in.data, "solid a\n");
  vg_input_release(&in);
  assert_int_equal(vg_input_open_head(path, 5, &in, &err), VG_OK);
  assert_memory_equal(in.data, "so", 2);
  vg_input_release(&in);
  io_write_gzip(path, MARK "solid a\n", 11);
  assert_int_equal(vg_input_open(path, &in, &err), VG_OK);
  assert_string_equal((char *)in.data, "solid a\n");
  vg_input_release(&in);
  io_write_file(path, MARK, 3);
  refuse_open(path, VG_ERR_FORMAT, "empty");
  unlink(path);

  open_bytes(twice, sizeof twice - 1, &in);
  assert_int_equal(in.size, sizeof twice - 4);
  vg_input_release(&in);
  open_bytes(binary, sizeof binary - 1, &in);
  assert_int_equal(in.size, sizeof binary - 1);
  assert_memory_equal(in.data, binary, in.size);
  vg_input_release(&in);
  open_bytes(MARK, 2, &in);
  assert_int_equal(in.size, 2);
  vg_input_release(&in);
}

#define POINTER                                                                \
  "version https://git-lfs.github.com/spec/v1\n"                               \
  "oid sha256:4d7a214614ab2935c943f9e0ff69d22e"                                \
  "adbb8f32b1258daaa5e2ca24d17e2393"                                           \
  "\nsize 12345\n"

static void reports_a_git_lfs_pointer(void **state)
{
  const char *path = io_temp("stream_pointer.lb8.ugrid");
  struct vg_input in = VG_INPUT_INIT;

  (void)state;
  io_write_file(path, POINTER, sizeof POINTER - 1);
  refuse_open(path, VG_ERR_FORMAT,
              "is a Git LFS pointer, not the file "
              "itself; run `git lfs pull` in its repository");
  io_write_file(path, MARK POINTER, sizeof POINTER + 2);
  refuse_open(path, VG_ERR_FORMAT, "Git LFS pointer");
  unlink(path);
  /* only at the start */
  open_bytes("# " POINTER, sizeof POINTER + 1, &in);
  vg_input_release(&in);
}

static void unpacks_gzip_whatever_its_name(void **state)
{
  const char *path = io_temp("stream_packed.txt");
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n = 3000000, packed;
  char *text = malloc(n);
  unsigned char *gz;

  (void)state;
  for (size_t i = 0; i < n; i++) text[i] = (char)('a' + i * i % 23);
  io_write_gzip(path, text, n);
  assert_int_equal(vg_input_open(path, &in, &err), VG_OK);
  assert_int_equal(in.size, n);
  assert_memory_equal(in.data, text, n);
  vg_input_release(&in);

  /* Two consecutive members, then padding, as gzip allows. */
  FILE *f = fopen(path, "rb");
  gz = malloc(2 * n);
  packed = fread(gz, 1, n, f);
  fclose(f);
  memcpy(gz + packed, gz, packed);
  memset(gz + 2 * packed, 0, 100);
  io_write_file(path, gz, 2 * packed + 100);
  assert_int_equal(vg_input_open(path, &in, &err), VG_OK);
  assert_int_equal(in.size, 2 * n);
  assert_memory_equal(in.data + n, text, n);
  vg_input_release(&in);
  unlink(path);
  free(gz);
  free(text);
}

static void refuses_gzip_cut_anywhere(void **state)
{
  const char *path = io_temp("stream_cut.gz");
  unsigned char gz[512];
  size_t n;
  FILE *f;

  (void)state;
  io_write_gzip(path, "some text that is packed some text", 34);
  f = fopen(path, "rb");
  n = fread(gz, 1, sizeof gz, f);
  fclose(f);
  for (size_t cut = 2; cut < n; cut++) {
    io_write_file(path, gz, cut);
    refuse_open(path, VG_ERR_FORMAT, "gzip");
  }
  gz[n / 2] ^= 0x55;
  io_write_file(path, gz, n);
  refuse_open(path, VG_ERR_FORMAT, "gzip");
  unlink(path);
}

static void refuses_gzip_that_explodes(void **state)
{
  const char *path = io_temp("stream_bomb.gz");
  static char zero[1 << 20];
  gzFile f = gzopen(path, "wb1");

  (void)state;
  assert_non_null(f);
  for (int i = 0; i < 300; i++)
    assert_int_equal(gzwrite(f, zero, sizeof zero), sizeof zero);
  assert_int_equal(gzclose(f), Z_OK);
  refuse_open(path, VG_ERR_FORMAT, "200 times");
  unlink(path);
}

static void reads_numbers_of_both_orders(void **state)
{
  static const unsigned char data[] = {
    0, 0, 1, 2, 2,    1,    0,    0,    0x3f, 0xf0, 0,    0,    0,    0,
    0, 0, 0, 0, 0xc0, 0x3f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe
  };
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  int32_t i;
  int64_t l;
  double d;

  (void)state;
  assert_int_equal(vg_input_memory("m", data, sizeof data, &in, &err), VG_OK);
  vg_input_order(&in, 1);
  assert_int_equal(vg_input_i32(&in, 1, &i, "a", &err), VG_OK);
  assert_int_equal(i, 258);
  vg_input_order(&in, 0);
  assert_int_equal(vg_input_i32(&in, 1, &i, "b", &err), VG_OK);
  assert_int_equal(i, 258);
  vg_input_order(&in, 1);
  assert_int_equal(vg_input_f64(&in, 1, &d, "c", &err), VG_OK);
  assert_true(d == 1);
  vg_input_order(&in, 0);
  assert_int_equal(vg_input_f32(&in, 1, &d, "d", &err), VG_OK);
  assert_true(d == 1.5);
  vg_input_order(&in, 1);
  assert_int_equal(vg_input_i64(&in, 2, &l, "e", &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "truncated"));
  assert_int_equal(vg_input_i64(&in, 1, &l, "e", &err), VG_OK);
  assert_int_equal(l, -2);
  assert_int_equal(vg_input_left(&in), 0);
  assert_int_equal(vg_input_need(&in, UINT64_MAX, 8, "f", &err), VG_ERR_FORMAT);
  vg_input_release(&in);
}

/* A 48-byte record cut at 20 bytes, as gfortran writes it (formats.md 1.1). */
static void cuts_records_as_gfortran(void **state)
{
  static const unsigned char markers[6][4] = {
    { 0xff, 0xff, 0xff, 0xec }, { 0, 0, 0, 20 }, { 0xff, 0xff, 0xff, 0xec },
    { 0xff, 0xff, 0xff, 0xec }, { 0, 0, 0, 8 },  { 0xff, 0xff, 0xff, 0xf8 }
  };
  static const size_t place[6] = { 0, 24, 28, 52, 56, 68 };
  const char *path = io_temp("stream_record");
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_input in = VG_INPUT_INIT, record;
  struct vg_error err = VG_ERROR_INIT;
  double v[6] = { 1, 2, 3, 4, 5, 6 }, back[6];
  unsigned char *data;
  size_t size;

  (void)state;
  out.record_limit = 20;
  assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
  vg_output_order(&out, 1);
  vg_output_record(&out, sizeof v);
  vg_output_f64(&out, 6, v);
  vg_output_record_end(&out);
  vg_output_record(&out, 0);
  vg_output_record_end(&out);
  assert_int_equal(vg_output_commit(&out, &err), VG_OK);
  data = io_slurp(path, &size);
  assert_int_equal(size, 48 + 24 + 8);
  for (int i = 0; i < 6; i++)
    assert_memory_equal(data + place[i], markers[i], 4);
  free(data);
  assert_int_equal(vg_input_open(path, &in, &err), VG_OK);
  vg_input_order(&in, 1);
  assert_int_equal(vg_input_record(&in, &record, "r", &err), VG_OK);
  assert_int_equal(vg_input_left(&record), sizeof v);
  assert_int_equal(vg_input_f64(&record, 6, back, "r", &err), VG_OK);
  assert_memory_equal(v, back, sizeof v);
  assert_int_equal(vg_input_f64(&record, 1, back, "r", &err), VG_ERR_FORMAT);
  assert_int_equal(vg_input_record(&in, &record, "r", &err), VG_OK);
  assert_int_equal(vg_input_left(&record), 0);
  assert_int_equal(vg_input_record(&in, &record, "r", &err), VG_ERR_FORMAT);
  vg_input_release(&in);
  unlink(path);
}

static void refuses_records_with_wrong_markers(void **state)
{
  static const unsigned char cases[4][12] = {
    { 0, 0, 0, 4, 1, 1, 1, 1, 0, 0, 0, 5 },             /* other length */
    { 0, 0, 0, 4, 1, 1, 1, 1, 0xff, 0xff, 0xff, 0xfc }, /* other sign */
    { 0x7f, 0, 0, 4, 1, 1, 1, 1, 0, 0, 0, 4 },          /* too long */
    { 0x80, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 4 },          /* INT32_MIN */
  };
  struct vg_input in = VG_INPUT_INIT, record;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int i = 0; i < 4; i++) {
    assert_int_equal(vg_input_memory("m", cases[i], 12, &in, &err), VG_OK);
    vg_input_order(&in, 1);
    assert_int_equal(vg_input_record(&in, &record, "points", &err),
                     VG_ERR_FORMAT);
    assert_non_null(strstr(err.text, "points"));
    vg_input_release(&in);
  }
}

static void reads_tokens_and_lines(void **state)
{
  static const char text[] = "one  two # not this\r\n\r\n three\nlast line \r\n"
                             "# only\n7 8.5";
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *t;
  size_t n;
  int64_t i;
  double d;

  (void)state;
  assert_int_equal(vg_input_memory("m", text, sizeof text - 1, &in, &err),
                   VG_OK);
  in.comment = '#';
  assert_true(vg_input_token(&in, &t, &n) && vg_token_is(t, n, "one"));
  assert_true(vg_input_token_in_line(&in, &t, &n) && vg_token_is(t, n, "two"));
  assert_false(vg_input_token_in_line(&in, &t, &n));
  assert_int_equal(in.line, 1);
  assert_true(vg_input_token(&in, &t, &n) && vg_token_is(t, n, "three"));
  assert_int_equal(in.line, 3);
  assert_true(vg_input_line(&in, &t, &n));
  assert_int_equal(n, 0);
  assert_true(vg_input_line(&in, &t, &n) && vg_token_is(t, n, "last line "));
  assert_int_equal(vg_input_int(&in, &i, "count", &err), VG_OK);
  assert_int_equal(i, 7);
  assert_int_equal(in.line, 6);
  assert_int_equal(vg_input_int(&in, &i, "the count", &err), VG_ERR_FORMAT);
  assert_string_equal(err.text, "m:6: expected an integer (the count), not "
                                "'8.5'");
  assert_int_equal(vg_input_real(&in, &d, "x", &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "ends where x"));
  vg_input_release(&in);
}

static void notices_binary_data(void **state)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  int64_t i;

  (void)state;
  assert_int_equal(vg_input_memory("m", "\1\2\0\3", 4, &in, &err), VG_OK);
  assert_false(vg_input_is_text(&in));
  assert_int_equal(vg_input_int(&in, &i, "n", &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "binary"));
  vg_input_release(&in);
}

static void parses_integers_with_care(void **state)
{
  static const char *const bad[] = { "",
                                     "-",
                                     "+",
                                     "1.0",
                                     "1e3",
                                     "0x10",
                                     "12a",
                                     "9223372036854775808",
                                     "99999999999999999999",
                                     "--1",
                                     " 1" };
  int64_t v;

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_false(vg_parse_int(bad[i], strlen(bad[i]), &v));
  assert_true(vg_parse_int("9223372036854775807", 19, &v) && v == INT64_MAX);
  assert_true(vg_parse_int("-42", 3, &v) && v == -42);
  assert_true(vg_parse_int("+0042xyz", 5, &v) && v == 42);
}

static void parses_reals_with_care(void **state)
{
  static const char *const bad[] = { "",      ".",     "-",   "e5",   "1e",
                                     "1e+",   "1.2.3", "nan", "inf",  "-inf",
                                     "1e400", "0x1p3", "1,5", "1e5x", "1d",
                                     "1d+-3", "--1" };
  static const struct {
    const char *text;
    double v;
  } good[] = {
    { "1.5D-3", 1.5e-3 },
    { "1.5d+2", 150 },
    { "0.1-100", 0.1e-100 },
    { "1+2", 100 },
    { ".5", 0.5 },
    { "5.", 5 },
    { "-0", -0.0 },
    { "1e-400", 0 },
    { "0.000000000000000000000000000001", 1e-30 },
    { "123456789012345678901234567890", 123456789012345678901234567890.0 },
    { "4.9406564584124654e-324", 4.9406564584124654e-324 },
    { "1.7976931348623157e308", 1.7976931348623157e308 },
    { "2.2250738585072011e-308", 2.2250738585072011e-308 },
    /* Exactly half-way between two doubles: to even, and just above. */
    { "9007199254740993", 9007199254740992.0 },
    { "9007199254740993.0000000000000000000000001", 9007199254740994.0 },
    { "0e99999999", 0 },
    { "0.0000000000000000000000000000000000000000e+10", 0 }
  };
  double v;

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (vg_parse_real(bad[i], strlen(bad[i]), &v))
      fail_msg("'%s' was read as %g", bad[i], v);
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    assert_true(vg_parse_real(good[i].text, strlen(good[i].text), &v));
    if (memcmp(&v, &good[i].v, sizeof v))
      fail_msg("'%s' was read as %.17g", good[i].text, v);
  }
}

/* Compared with the C library, which is correctly rounded by definition, for
 * random bit patterns and for numbers of the size of coordinates. */
static void parses_as_the_c_library(void **state)
{
  uint64_t seed = 1;
  char text[64];
  double v, want;

  (void)state;
  for (int i = 0; i < 200000; i++) {
    uint64_t bits = next_random(&seed);

    memcpy(&want, &bits, sizeof want);
    if (i & 1) want = (double)(int64_t)bits * 1e-15;
    if (!isfinite(want)) continue;
    snprintf(text, sizeof text, "%.*e", 5 + i % 15, want);
    want = strtod(text, NULL);
    if (!isfinite(want)) continue;
    assert_true(vg_parse_real(text, strlen(text), &v));
    if (memcmp(&v, &want, sizeof v))
      fail_msg("'%s' was read as %.17g", text, v);
  }
}

static void written_reals_read_back(void **state)
{
  static const struct {
    double v;
    const char *text;
  } known[] = { { 0.1, "0.1" },
                { -2, "-2" },
                { 0, "0" },
                { -0.0, "-0" },
                { 1e-4, "0.0001" },
                { 1.0 / 3, "0.33333333333333331" },
                { 123456.75, "123456.75" },
                { 1e20, "1e+20" },
                { 0.3, "0.3" },
                { 5e-324, "4.94065645841247e-324" } };
  uint64_t seed = 7;
  char text[32];
  double v, back;

  (void)state;
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    text[vg_format_real(known[i].v, text)] = 0;
    assert_string_equal(text, known[i].text);
  }
  for (int i = 0; i < 200000; i++) {
    uint64_t bits = next_random(&seed);
    size_t n;

    memcpy(&v, &bits, sizeof v);
    if (i & 1) v = (double)(int64_t)bits * 1e-19;
    if (i % 4 == 2) v = (double)((int64_t)bits % 1000000007) * 1e-6;
    if (!isfinite(v)) continue;
    n = vg_format_real(v, text);
    assert_true(n < 32);
    assert_true(vg_parse_real(text, n, &back));
    if (memcmp(&v, &back, sizeof v)) fail_msg("%.17g: '%.*s'", v, (int)n, text);
    assert_true(n <= (size_t)snprintf(NULL, 0, "%.17g", v) + 4);
  }
}

static void numbers_do_not_depend_on_the_locale(void **state)
{
  static const char *const name[] = { "de_DE.UTF-8", "de_DE.utf8",
                                      "fr_FR.UTF-8" };
  char text[32];
  double v;
  int found = 0;

  (void)state;
  for (int i = 0; i < 3 && !found; i++)
    found = setlocale(LC_NUMERIC, name[i]) != NULL;
  if (!found) {
    print_message("no locale with a decimal comma here: skipped\n");
    skip();
  }
  text[vg_format_real(1e-7 / 3, text)] = 0;
  assert_null(strchr(text, ','));
  assert_true(vg_parse_real("0.1234567890123456789012345", 27, &v));
  assert_true(v > 0.1 && v < 0.2);
  setlocale(LC_NUMERIC, "C");
}

static void a_name_appears_only_when_complete(void **state)
{
  const char *path = io_temp("stream_out"), *part = io_temp("stream_out.part");
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t size;
  unsigned char *data;

  (void)state;
  unlink(path);
  assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
  vg_output_text(&out, "half");
  assert_int_equal(vg_output_flush(&out, &err), VG_OK);
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(access(part, F_OK), 0);
  vg_output_release(&out);
  assert_int_equal(access(part, F_OK), -1);
  io_write_file(path, "old", 3);
  assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
  vg_output_format(&out, "%d-", 12);
  vg_output_int(&out, INT64_MIN);
  vg_output_real(&out, 0.5);
  assert_int_equal(vg_output_commit(&out, &err), VG_OK);
  assert_int_equal(access(part, F_OK), -1);
  data = io_slurp(path, &size);
  assert_string_equal((char *)data, "12--92233720368547758080.5");
  free(data);
  unlink(path);
}

static void output_errors_are_reported(void **state)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("stream_no_folder/x");
  int32_t v[2] = { 1, 2 };

  (void)state;
  assert_int_equal(vg_output_open(path, &out, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, path));
  /* A record with fewer or more bytes than it announced. */
  path = io_temp("stream_bad_record");
  for (uint64_t announced = 4; announced <= 12; announced += 8) {
    assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
    vg_output_record(&out, announced);
    vg_output_i32(&out, 2, v);
    vg_output_record_end(&out);
    assert_int_equal(vg_output_commit(&out, &err), VG_ERR_IO);
    assert_int_equal(access(path, F_OK), -1);
  }
}

/* A full disk, simulated by a device that is always full. */
static void a_full_disk_is_reported(void **state)
{
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("stream_full");
  const char *part = io_temp("stream_full.part");

  (void)state;
  unlink(part);
  if (access("/dev/full", W_OK) || symlink("/dev/full", part)) skip();
  assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
  vg_output_text(&out, "text");
  assert_int_equal(vg_output_commit(&out, &err), VG_ERR_IO);
  assert_non_null(strstr(err.text, "No space"));
  assert_int_equal(access(path, F_OK), -1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reports_files_that_cannot_be_opened),
    cmocka_unit_test(drops_the_byte_order_mark_of_a_text),
    cmocka_unit_test(reports_a_git_lfs_pointer),
    cmocka_unit_test(unpacks_gzip_whatever_its_name),
    cmocka_unit_test(refuses_gzip_cut_anywhere),
    cmocka_unit_test(refuses_gzip_that_explodes),
    cmocka_unit_test(reads_numbers_of_both_orders),
    cmocka_unit_test(cuts_records_as_gfortran),
    cmocka_unit_test(refuses_records_with_wrong_markers),
    cmocka_unit_test(reads_tokens_and_lines),
    cmocka_unit_test(notices_binary_data),
    cmocka_unit_test(parses_integers_with_care),
    cmocka_unit_test(parses_reals_with_care),
    cmocka_unit_test(parses_as_the_c_library),
    cmocka_unit_test(written_reals_read_back),
    cmocka_unit_test(numbers_do_not_depend_on_the_locale),
    cmocka_unit_test(a_name_appears_only_when_complete),
    cmocka_unit_test(output_errors_are_reported),
    cmocka_unit_test(a_full_disk_is_reported),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
