/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The run itself: times, memory, timeline, files. Only this section differs
 * between runs that make the same mesh. */
#include <stdio.h>
#include <string.h>

#include "cli/html/page.h"

static void times(struct page *p)
{
  static const struct {
    const char *key, *name;
  } phase[] = {
    { "read", "Reading" },
    { "check", "Surface check" },
    { "sizes", "Sizing field" },
    { "layers", "Boundary layers" },
    { "fill", "Volume fill" },
    { "number", "Numbering" },
    { "judge", "Mesh check" },
    { "parts", "Solver partition" },
    { "write", "Writing" },
    { "digest", "Digests of files" },
    { "sync", "Files to the disk (fsync)" },
  };
  const json_t *seconds = vg_page_json(p, "seconds");
  double total = vg_page_number(p, "seconds.total");

  vg_page_markup(p, "<table class=\"facts times\">\n");
  for (size_t i = 0; i < sizeof phase / sizeof *phase; i++) {
    double s = json_number_value(json_object_get(seconds, phase[i].key));

    vg_page_fact(p, phase[i].name);
    vg_page_fixed(p, s, 2);
    vg_page_markup(p, " s</td><td class=\"share\"><i style=\"width:");
    vg_page_fixed(p, total > 0 ? 100 * s / total : 0, 1);
    vg_page_markup(p, "%\"></i></td></tr>\n");
  }
  vg_page_fact(p, "Total, until this page was written");
  vg_page_fixed(p, total, 2);
  vg_page_markup(p, " s</td></tr>\n</table>\n");
}

static void machine(struct page *p)
{
  const struct vg_run *r = p->h->run;

  vg_page_markup(p, "<table class=\"facts\">\n");
  vg_page_fact(p, "Ranks x threads");
  vg_page_format(p, "%d x %d</td></tr>\n", r->size, r->threads);
  vg_page_fact(p, "Workers busy");
  vg_page_fixed(p, 100 * vg_page_number(p, "partition.busy"), 1);
  vg_page_markup(p, " %</td></tr>\n");
  vg_page_fact(p, "Imbalance (max/mean)");
  vg_page_fixed(p, vg_page_number(p, "partition.imbalance"), 3);
  vg_page_markup(p, "</td></tr>\n");
  vg_page_fact(p, "Peak memory of a rank");
  vg_page_fixed(p, r->memory / 1e6, 0);
  vg_page_markup(p, " MB</td></tr>\n");
  vg_page_fact(p, "Cells per second, complete run");
  vg_page_count(p, (uint64_t)((double)vg_run_cells(r) /
                              (vg_page_number(p, "seconds.total") + 1e-9)));
  vg_page_markup(p, "</td></tr>\n");
  vg_page_fact_count(p, "Tasks reused from an earlier run",
                     (uint64_t)vg_page_number(p, "partition.tasks_resumed"));
  vg_page_markup(p, "</table>\n");
}

/* Embed the SVG file of the timeline, without its XML declaration. */
static vg_status timeline(struct page *p, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  const char *svg;
  vg_status st;

  if (!p->h->timeline) return VG_OK;
  st = vg_input_open(p->h->timeline, &in, err);
  if (st < 0) return st;
  svg = strstr((const char *)in.data, "<svg");
  if (svg) {
    vg_page_markup(p, "<figure class=\"paper\" role=\"img\" "
                      "aria-label=\"Timeline of the workers.\">");
    vg_output_bytes(&p->out, svg,
                    in.size - (size_t)(svg - (const char *)in.data));
    vg_page_markup(p, "<figcaption>Timeline: one lane for each thread of each "
                      "rank</figcaption></figure>\n");
  }
  vg_input_release(&in);
  return VG_OK;
}

static void files(struct page *p)
{
  const json_t *list = vg_page_json(p, "files");

  vg_page_markup(p,
                 "<div class=\"wide\"><table>\n<thead><tr>"
                 "<th scope=\"col\">File</th><th scope=\"col\">Bytes</th>"
                 "<th scope=\"col\">XXH3 digest</th></tr></thead>\n<tbody>\n");
  for (size_t i = 0; i < json_array_size(list); i++) {
    const json_t *f = json_array_get(list, i);
    const char *digest = json_string_value(json_object_get(f, "xxh3"));

    vg_page_markup(p, "<tr><th scope=\"row\">");
    vg_page_text(p, json_string_value(json_object_get(f, "path")));
    vg_page_markup(p, "</th><td>");
    if (digest)
      vg_page_count(p,
                    (uint64_t)json_integer_value(json_object_get(f, "bytes")));
    vg_page_format(p, "</td><td><code>%s</code></td></tr>\n",
                   digest ? digest : "");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
}

vg_status vg_html_run(struct page *p, struct vg_error *err)
{
  vg_status st;

  vg_page_markup(p, "<!--run-->\n");
  vg_page_section(p, "run", "Time, memory and files");
  vg_page_markup(p, "<div class=\"pair\">\n<div>");
  times(p);
  vg_page_markup(p, "</div>\n<div>");
  machine(p);
  vg_page_markup(p, "</div>\n</div>\n");
  st = timeline(p, err);
  vg_page_markup(p, "<h3>Files</h3>\n");
  files(p);
  vg_page_end_section(p);
  vg_page_markup(p, "<!--/run-->\n");
  return st;
}
