/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "fuzz.h"

#include "cli/serve/rows.h"
#include "cli/serve/runs.h"

/* The texts that a portal reads about its runs: progress, logs, records,
 * squeue; and tables in forms. The first byte selects one. */
static void record(const char *text, size_t size)
{
  struct vg_serve_run run = { .id = 7 };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_record_parse("FUZZ", text, size, &run, &err);

  fuzz_check_answer(st, &err);
  if (st < 0) {
    fuzz_expect(!run.project && !*run.title, "the run is untouched");
    return;
  }
  fuzz_expect(run.project != NULL && run.state < VG_SERVE_STATES &&
                run.ranks > 0 && run.nodes > 0 && run.cpus > 0,
              "a record is complete");
  fuzz_expect(strspn(run.job, "0123456789_") == strlen(run.job),
              "job names are numbers");
  free(run.project);
}

static void tell(const char *text, size_t size)
{
  struct vg_tell t = VG_TELL_INIT;

  if (vg_tell_tail(text, size, size % 2 == 1, &t))
    fuzz_expect(*t.stage && t.share >= -1 && t.share <= 1,
                "a share is between -1 and 1");
  fuzz_expect(vg_tell_status(text, size) < 1000, "an exit status");
}

static void rows(const char *text, size_t size, int kind)
{
  char *copy = strndup(text, size);
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_settings_default(&s);
  st = copy
       ? vg_rows_read(copy, VG_TABLE_PATCHES + (enum vg_table_kind)(kind % 4),
                      &s, &err)
       : VG_OK;
  fuzz_expect(st >= 0 || *err.text, "a failure has a message");
  vg_settings_release(&s);
  free(copy);
}

static void squeue(const char *text, size_t size)
{
  struct vg_serve_run run = { .is_slurm = 1,
                              .state = VG_SERVE_RUNNING,
                              .job = "12",
                              .dir = (char *)"/nowhere",
                              .project = (char *)"" };
  struct vg_serve_run *list[] = { &run };
  struct vg_serve_runs r = { .n = 1, .item = list, .squeue_start = 1 };

  vg_runs_take_squeue(&r, text, size);
  fuzz_expect(run.state != VG_SERVE_QUEUED, "a job is no longer queued");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  const char *text = (const char *)data + 1;

  if (!size) return 0;
  switch (*data % 4) {
  case 0: record(text, size - 1); break;
  case 1: tell(text, size - 1); break;
  case 2: rows(text, size - 1, *data / 4); break;
  case 3: squeue(text, size - 1); break;
  }
  return 0;
}
