#include "cli/html/html.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/version.h"
#include "cli/html/assets.h"
#include "cli/html/page.h"

/* Scripts at the end: the page is there before they run, and without them. */
static void scripts(struct page *p)
{
  vg_page_markup(
    p, "<!-- regl 2.1.1, https://github.com/regl-project/regl, "
       "copyright 2016 Mikola Lysenko, MIT license: share/html/regl.LICENSE of "
       "Vanguard -->\n<script>\n");
  vg_output_bytes(&p->out, vg_asset_regl_min_js, vg_asset_regl_min_js_size);
  vg_page_markup(p, "\n</script>\n<script>\n");
  vg_output_bytes(&p->out, vg_asset_report_js, vg_asset_report_js_size);
  vg_page_markup(p, "</script>\n");
}

static void foot(struct page *p)
{
  vg_page_markup(p, "</main>\n<footer><p>Made by Vanguard " VG_VERSION
                    ", source ");
  vg_page_format(p, "%.12s", vg_source_digest);
  vg_page_markup(
    p, ". This page loads nothing. The same figures, and more, "
       "are in PROJECT.report.json. The view to turn uses regl (MIT license, "
       "copyright 2016 Mikola Lysenko).</p></footer>\n");
  scripts(p);
  vg_page_markup(p, "</body>\n</html>\n");
}

static vg_status sections(struct page *p, struct vg_error *err)
{
  vg_status st;

  vg_html_head(p);
  vg_html_first(p);
  vg_html_tiles(p);
  VG_TRY(vg_html_scene(p, err));
  vg_html_surface(p);
  vg_html_cuts(p);
  vg_html_layers(p);
  vg_html_quality(p);
  vg_html_worst(p);
  vg_html_settings(p);
  vg_html_patches(p);
  vg_html_partition(p);
  VG_TRY(vg_html_run(p, err));
  foot(p);
done:
  return st;
}

vg_status vg_html_write(const char *path, const struct vg_html *h,
                        struct vg_error *err)
{
  const struct vg_mesh *m = &h->problem->boundary.surface;
  struct page p = { .out = VG_OUTPUT_INIT,
                    .h = h,
                    .has_layers = h->layers->is_on };
  vg_status st;

  p.body = vg_alloc(m->n_patch, 1);
  if (!p.body) return vg_fail_memory(err, "the report");
  vg_body_patches(m, p.has_layers ? &h->layers->layers.columns : NULL, p.body);
  VG_TRY(vg_html_draw(&p, err));
  VG_TRY(vg_output_open(path, &p.out, err));
  VG_TRY(sections(&p, err));
  st = vg_output_commit(&p.out, err);
done:
  vg_output_release(&p.out);
  for (int k = 0; k < PICTURES; k++) free(p.png[k].data);
  vg_walls_release(&p.walls);
  free(p.body);
  return st;
}
