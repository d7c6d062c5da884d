#include "run/common/json_file.h"

#include <assert.h>
#include <stdlib.h>

#include "io/stream/stream.h"

vg_status vg_json_write(const char *path, const json_t *o, const char *what,
                        struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *text = json_dumps(o, JSON_INDENT(2));
  vg_status st;

  assert(path && what);
  if (!text) return vg_fail_memory(err, what);
  st = vg_output_open(path, &out, err);
  if (st >= 0) {
    vg_output_text(&out, text);
    vg_output_text(&out, "\n");
    st = vg_output_commit(&out, err);
  }
  vg_output_release(&out);
  free(text);
  return st;
}
