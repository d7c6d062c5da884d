/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Memory of a run by part. */
#include <assert.h>

#include "layers/columns/share.h"
#include "run/stages/run.h"

static void add_bytes(void *user, size_t n, const void *data)
{
  size_t *sum = user;

  (void)data;
  *sum += n;
}

void vg_run_measure(struct vg_run *r, const struct vg_mesh *surface,
                    const struct vg_layers *layers,
                    const struct vg_sizing *sizing)
{
  struct vg_memory_parts *m = &r->memory_of;

  assert(surface && sizing);
  *m = (struct vg_memory_parts){ 0 };
  m->surface = surface->n_point * sizeof *surface->point +
               surface->n_tri *
                 (sizeof *surface->tri + sizeof *surface->tri_patch);
  if (layers) vg_layers_show(layers, add_bytes, &m->columns);
  vg_sizing_show(sizing, add_bytes, &m->sizes);
}

struct part {
  const char *name, *text;
  double bytes;
};

enum { N_PART = 5 };

static void list_parts(const struct vg_run *r, struct part part[N_PART])
{
  const struct vg_memory_parts *m = &r->memory_of;
  const struct vg_partition_report *p = &r->partition;
  const struct part list[N_PART] = {
    { "surface", "surface", (double)m->surface },
    { "columns", "columns", (double)m->columns },
    { "sizes", "sizing field", (double)m->sizes },
    { "cells", "cells until written", p->cell_bytes },
    { "subdomain", "largest subdomain", p->fill.bytes }
  };

  for (int i = 0; i < N_PART; i++) part[i] = list[i];
}

void vg_report_memory_text(FILE *to, const struct vg_run *r)
{
  struct part part[N_PART];

  list_parts(r, part);
  fprintf(to, "\nPeak memory%s: %.0f MB;", r->size > 1 ? " of a rank" : "",
          r->memory / 1e6);
  for (int i = 0; i < N_PART; i++)
    fprintf(to, "%s%s %.1f",
            !i       ? " "
            : i == 3 ? ",\n  "
                     : ", ",
            part[i].text, part[i].bytes / 1e6);
  fprintf(to, "\n");
}

json_t *vg_report_memory_json(const struct vg_run *r)
{
  struct part part[N_PART];
  json_t *o = json_object();

  list_parts(r, part);
  for (int i = 0; i < N_PART; i++)
    json_object_set_new(o, part[i].name, json_real(part[i].bytes));
  return o;
}
