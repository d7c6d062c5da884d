/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "io/section/section.h"

/* Invariants of every section that the reader returns. */
static void check(const struct vg_section *s)
{
  size_t at = 0;

  fuzz_expect(s->n > 0, "a section has elements");
  for (size_t e = 0; e < s->n; e++) {
    const struct vg_section_element *of = &s->element[e];
    double area = 0;

    fuzz_expect(of->first == at && of->n >= 3, "elements follow each other");
    fuzz_expect(memchr(of->name, 0, VG_NAME_MAX) != NULL,
                "names are terminated");
    at += of->n;
    for (size_t i = of->first; i < at; i++) {
      const double *a = s->x[i], *b = s->x[i + 1 < at ? i + 1 : of->first];

      fuzz_expect(isfinite(a[0]) && isfinite(a[1]), "finite coordinates");
      fuzz_expect(a[0] != b[0] || a[1] != b[1], "neighbours differ");
      area += (a[0] - s->x[of->first][0]) * (b[1] - s->x[of->first][1]) -
              (b[0] - s->x[of->first][0]) * (a[1] - s->x[of->first][1]);
    }
    fuzz_expect(!(area < 0), "elements run counter-clockwise");
  }
  fuzz_expect(at == s->n_point, "elements have all points");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_section s = VG_SECTION_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_input_memory("FUZZ", data, size, &in, &err);

  if (st == VG_OK) {
    st = vg_section_parse(&in, &s, &err);
    vg_input_release(&in);
  }
  fuzz_check_answer(st, &err);
  if (st == VG_OK) check(&s);
  vg_section_release(&s);
  return 0;
}
