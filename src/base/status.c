/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "base/status.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>

vg_status vg_fail(struct vg_error *err, vg_status code, const char *format, ...)
{
  assert(code != VG_OK && format);
  va_list args;

  if (!err) return code;
  err->code = code;
  va_start(args, format);
  vsnprintf(err->text, sizeof err->text, format, args);
  va_end(args);
  return code;
}

vg_status vg_fail_memory(struct vg_error *err, const char *what)
{
  assert(what);
  return vg_fail(err, VG_ERR_MEMORY,
                 "not enough memory for %s; use a coarser spacing or a "
                 "machine with more memory",
                 what);
}

const char *vg_status_name(vg_status code)
{
  switch (code) {
  case VG_OK: return "ok";
  case VG_BLOCKED: return "blocked";
  case VG_NOT_BETTER: return "not better";
  case VG_ERR_INPUT: return "input";
  case VG_ERR_FORMAT: return "format";
  case VG_ERR_IO: return "io";
  case VG_ERR_MEMORY: return "memory";
  case VG_ERR_GEOMETRY: return "geometry";
  case VG_ERR_UNSUPPORTED: return "unsupported";
  case VG_ERR_REMOTE: return "remote";
  case VG_ERR_USAGE: return "usage";
  case VG_ERR_STOPPED: return "stopped";
  }
  return "unknown";
}
