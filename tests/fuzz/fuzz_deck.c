/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "fuzz.h"

#include "run/settings/deck.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_settings_default(&s);
  st = vg_deck_parse("FUZZ", data, size, &s, &err);
  fuzz_check_answer(st, &err);
  if (st == VG_OK) fuzz_check_answer(vg_settings_check(&s, &err), &err);
  vg_settings_release(&s);
  return 0;
}
