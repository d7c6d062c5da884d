/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "cli/plot/timeline.h"
#include "partition/model/model.h"

/* A timeline that the reader accepts can be replayed, or is refused by name. */
static void replay(const struct vg_timeline *t)
{
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_spans spans = VG_SPANS_INIT;
  struct vg_model_result f;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  m.ranks = 3;
  m.threads = 2;
  st = vg_model_replay(&t->spans, &m, &f, &spans, &err);
  fuzz_expect(st <= 0, "the model returns VG_OK or an error");
  if (st < 0) fuzz_expect(*err.text, "a failure has a message");
  else {
    fuzz_expect(spans.n == t->spans.n, "every task is simulated");
    fuzz_expect(f.wall >= f.critical * (1 - 1e-9),
                "the time is at least that of the critical path");
  }
  vg_spans_release(&spans);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_timeline t = VG_TIMELINE_INIT, empty = VG_TIMELINE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_timeline_parse("FUZZ", data, size, &t, &err);

  fuzz_check_answer(st, &err);
  if (st == VG_OK) {
    for (size_t i = 0; i < t.spans.n; i++) {
      const struct vg_span *s = &t.spans.span[i];

      fuzz_expect(s->rank < t.spans.n_rank && s->thread < t.spans.n_thread,
                  "workers belong to the run");
      fuzz_expect(s->end >= s->start && s->start >= 0, "times are ascending");
    }
    fuzz_expect(vg_spans_busy(&t.spans) >= 0, "time spent");
    fuzz_expect(vg_spans_imbalance(&t.spans) >= 0, "imbalance");
    replay(&t);
  } else {
    fuzz_expect(!memcmp(&t, &empty, sizeof t), "out is untouched");
  }
  vg_timeline_release(&t);
  return 0;
}
