/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/status.h: how every function of the library that can fail reports it.
 *
 * The library never prints and never exits. It returns a vg_status and, if
 * there is something to explain to a person, fills a vg_error. assert() is for
 * our own bugs, a status for errors that data or the machine can cause. */
#ifndef VG_BASE_STATUS_H
#define VG_BASE_STATUS_H

#ifdef __cplusplus
extern "C" { /* for the C++ adapters of third-party libraries */
#endif

typedef enum {
  VG_OK = 0,
  /* > 0: expected outcome of a local step; the caller tries an alternative. */
  VG_BLOCKED = 1,
  VG_NOT_BETTER = 2,
  /* < 0: failure; clean up and propagate. */
  VG_ERR_INPUT = -1,       /* inconsistent data or settings */
  VG_ERR_FORMAT = -2,      /* a file violates its format */
  VG_ERR_IO = -3,          /* the system could not read or write */
  VG_ERR_MEMORY = -4,      /* not enough memory */
  VG_ERR_GEOMETRY = -5,    /* no valid mesh exists for this geometry */
  VG_ERR_UNSUPPORTED = -6, /* valid, but not supported by this build */
  VG_ERR_REMOTE = -7,      /* another rank failed */
  VG_ERR_USAGE = -8,       /* inconsistent command line */
  VG_ERR_STOPPED = -9      /* stopped on request */
} vg_status;

/** Message for a person: names file, element, coordinates and a remedy. */
struct vg_error {
  vg_status code;
  char text[1024];
};
#define VG_ERROR_INIT                                                          \
  {                                                                            \
    VG_OK, ""                                                                  \
  }

/** Fill *err (which may be NULL) as printf does and return code. Threads: safe
 * on distinct err. */
vg_status vg_fail(struct vg_error *err, vg_status code, const char *format, ...)
  __attribute__((format(printf, 3, 4)));

/** vg_fail for a failed allocation of `what`. */
vg_status vg_fail_memory(struct vg_error *err, const char *what);

/** Short English name of a status ("input", "format", ...). Static string. */
const char *vg_status_name(vg_status code);

/* For functions with a `vg_status st` and a `done:` label that cleans up. */
#define VG_TRY(call)                                                           \
  do {                                                                         \
    if ((st = (call)) < 0) goto done;                                          \
  } while (0)

#ifdef __cplusplus
}
#endif

#endif
