/* run/common/json_file.h: JSON as a file. Uses jansson, io/stream. */
#ifndef VG_RUN_COMMON_JSON_FILE_H
#define VG_RUN_COMMON_JSON_FILE_H

#include <jansson.h>

#include "base/status.h"

/** Write o, indented, to path, which appears when it is complete.
 *
 * @param o     borrowed
 * @param what  it is, for messages: "the report"
 * VG_ERR_MEMORY, also where o is NULL; VG_ERR_IO: an earlier file of that name
 * stays as it was. */
vg_status vg_json_write(const char *path, const json_t *o, const char *what,
                        struct vg_error *err);

#endif
