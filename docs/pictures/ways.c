/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Draws a section through the subdomains of each decomposition, for
 * docs/design/decompositions.md:
 *
 *   ways CASE CELLS PARTS AXIS AT U V WIDTH PREFIX
 *
 * CASE and CELLS are those of vanguard demo, without layers. The section is the
 * plane AXIS (x, y, z) = AT. A window of width WIDTH and two thirds of that
 * height, centred at U V in the two other coordinates, is written to
 * PREFIX.advancing.png and so on. Every colour is a subdomain; cells of planes
 * that divide a void are dark. */
#include <stdio.h>
#include <stdlib.h>

#include "base/child.h"
#include "cli/examples/demo.h"
#include "partition/advance/advance.h"
#include "partition/advance/ways.h"
#include "run/picture/cuts.h"

static void must(vg_status st, const struct vg_error *err)
{
  if (st == VG_OK) return;
  fprintf(stderr, "ways: %s\n", err->text);
  exit(1);
}

static void write_png(const struct vg_cuts *cuts, const char *prefix,
                      const char *way)
{
  struct vg_image image = VG_IMAGE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_bytes png = { 0, NULL };
  char path[4096];
  FILE *f;

  must(vg_cuts_image(cuts, 0, VG_CUT_BY_PART, &image, &err), &err);
  must(vg_image_png(&image, &png, &err), &err);
  snprintf(path, sizeof path, "%s.%s.png", prefix, way);
  f = fopen(path, "wb");
  if (!f || fwrite(png.data, 1, png.n, f) != png.n || fclose(f)) {
    fprintf(stderr, "ways: cannot write %s\n", path);
    exit(1);
  }
  vg_image_release(&image);
  free(png.data);
}

static void draw(const struct vg_demo *d, const struct vg_sizing *sizing,
                 const struct vg_way *way, int parts, const struct vg_cut *cut,
                 const char *prefix)
{
  struct vg_partition_options o = VG_PARTITION_OPTIONS_INIT;
  struct vg_partition_report report = { .n_leaf = 0 };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_partition *p = NULL;
  struct vg_cuts *cuts = NULL;

  o.maker = way->maker;
  o.decomposition.n_part = parts;
  must(vg_partition_grow(NULL, &d->surface, sizing, &o, &p, &report, NULL,
                         &err),
       &err);
  must(vg_cuts_new(1, cut, &cuts, &err), &err);
  must(vg_slices_each(vg_partition_slices(p), 1, vg_cuts_put, cuts, &err),
       &err);
  must(vg_cuts_gather(cuts, NULL, &err), &err);
  write_png(cuts, prefix, way->name);
  vg_cuts_free(cuts);
  vg_partition_free(p);
}

int main(int argc, char **argv)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_cut cut;

  if (argc != 10) {
    fprintf(stderr, "usage: ways CASE CELLS PARTS AXIS AT U V WIDTH PREFIX\n");
    return 2;
  }
  must(vg_child_server_start(&err), &err);
  must(vg_demo_make(argv[1], (size_t)atof(argv[2]), &d, &err), &err);
  must(vg_sizing_new(&d.sizing, d.n_source, d.source, &d.surface, &sizing,
                     &err),
       &err);
  cut = (struct vg_cut){ argv[4][0] - 'x',
                         atof(argv[5]),
                         { atof(argv[6]), atof(argv[7]) },
                         atof(argv[8]) };
  for (int k = 0; k < VG_DECOMPOSITIONS; k++)
    draw(&d, sizing, &vg_ways[k], atoi(argv[3]), &cut, argv[9]);
  vg_sizing_free(sizing);
  vg_demo_release(&d);
  return 0;
}
