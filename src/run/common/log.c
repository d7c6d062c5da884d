/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/common/log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_WORD "vanguard "

static FILE *log_file;
static char *log_path;
static volatile int log_fd = -1;

/* Prevents a typing error from overwriting a file of the user. */
static int is_foreign(const char *path)
{
  char head[sizeof FIRST_WORD - 1];
  FILE *f = fopen(path, "rb");
  size_t n = f ? fread(head, 1, sizeof head, f) : 0;

  if (f) fclose(f);
  return n && (n < sizeof head || memcmp(head, FIRST_WORD, n) != 0);
}

vg_status vg_log_open(const char *path, struct vg_error *err)
{
  if (is_foreign(path))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: this file exists and is not a log; give --log another "
                   "name",
                   path);
  log_path = strdup(path);
  if (!log_path) return vg_fail_memory(err, "a path");
  log_file = fopen(path, "we");
  if (!log_file)
    return vg_fail(err, VG_ERR_IO, "%s: the log cannot be written: %s", path,
                   strerror(errno));
  setvbuf(log_file, NULL, _IOLBF, 0);
  log_fd = fileno(log_file);
  return VG_OK;
}

FILE *vg_log(void)
{
  return log_file;
}

int vg_log_descriptor(void)
{
  return log_fd;
}

vg_status vg_log_close(struct vg_error *err)
{
  vg_status st = VG_OK;

  log_fd = -1;
  if (log_file && (ferror(log_file) | fclose(log_file)))
    st = vg_fail(err, VG_ERR_IO, "%s: the log could not be written completely",
                 log_path);
  log_file = NULL;
  free(log_path);
  log_path = NULL;
  return st;
}
