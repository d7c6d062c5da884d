/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Escaping of markup in files. */
#include "io_support.h"

#include "base/markup.h"
#include "io/stream/stream.h"

static void four_characters_are_escaped(void **state)
{
  (void)state;
  for (int c = 1; c < 256; c++)
    assert_int_equal(vg_markup_entity((char)c) != NULL,
                     c == '&' || c == '<' || c == '>' || c == '"');
}

static void a_file_has_text_as_markup(void **state)
{
  static const char text[] = "a<b & \"c\" > d'e \xc3\xa9";
  static const char want[] = "a&lt;b &amp; &quot;c&quot; &gt; d'e \xc3\xa9";
  struct vg_output out = VG_OUTPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char path[] = VG_TMP_DIR "/markup.txt", got[sizeof want + 8];
  size_t n;
  FILE *f;

  (void)state;
  assert_int_equal(vg_output_open(path, &out, &err), VG_OK);
  vg_output_markup(&out, "");
  vg_output_markup(&out, text);
  assert_int_equal(vg_output_commit(&out, &err), VG_OK);
  f = fopen(path, "rb");
  assert_non_null(f);
  n = fread(got, 1, sizeof got, f);
  fclose(f);
  assert_int_equal(n, sizeof want - 1);
  assert_memory_equal(got, want, n);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(four_characters_are_escaped),
    cmocka_unit_test(a_file_has_text_as_markup),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
