/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/stages/report_run.h"

#include <stdlib.h>

#include "base/helper/helper.h"
#include "base/version.h"
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/section/section_surface.h"

static json_t *files_json(const struct vg_run_report *r)
{
  json_t *list = json_array();

  for (size_t i = 0; i < r->outputs->n_file; i++) {
    const struct vg_outputs_file *f = &r->outputs->file[i];
    char *path = vg_outputs_final(r->outputs, f->suffix), digest[36];
    json_t *one = json_object();

    json_object_set_new(one, "path", path ? vg_text_json(path) : NULL);
    if (f->digest[0] || f->digest[1]) {
      snprintf(digest, sizeof digest, "%016llx%016llx",
               (unsigned long long)f->digest[0],
               (unsigned long long)f->digest[1]);
      json_object_set_new(one, "bytes", json_integer((json_int_t)f->bytes));
      json_object_set_new(one, "xxh3", json_string(digest));
    }
    json_array_append_new(list, one);
    free(path);
  }
  return list;
}

/* Identity of each helper program, or null. */
static json_t *helpers_json(void)
{
  json_t *o = json_object();
  struct vg_helper h;

  for (int kind = 0; kind < VG_HELPER_N; kind++) {
    vg_helper_find((enum vg_helper_kind)kind, &h);
    json_object_set_new(o, h.name,
                        h.is_found ? json_string(h.identity) : json_null());
  }
  return o;
}

static json_t *size_json(const struct vg_run *r)
{
  static const char *const kind[VG_SLICE_KINDS] = { "tetrahedra", "pyramids",
                                                    "prisms", "hexahedra" };
  const struct vg_slices *s = &r->slices;
  json_t *o = json_object();

  json_object_set_new(o, "points", json_integer((json_int_t)s->n_point));
  json_object_set_new(o, "cells", json_integer((json_int_t)vg_run_cells(r)));
  for (int k = 0; k < VG_SLICE_KINDS; k++)
    json_object_set_new(o, kind[k], json_integer((json_int_t)s->n_cell[k]));
  json_object_set_new(o, "boundary_points",
                      json_integer((json_int_t)s->n_boundary_point));
  json_object_set_new(o, "boundary_triangles",
                      json_integer((json_int_t)s->boundary->n_tri));
  json_object_set_new(o, "boundary_quadrilaterals",
                      json_integer((json_int_t)s->boundary->n_quad));
  return o;
}

static void put_mesh(json_t *o, const struct vg_run_report *r)
{
  const struct vg_problem *p = r->problem;
  const struct vg_mesh *m = vg_problem_surface(p);
  const struct vg_mesh front = vg_layer_stage_front(r->layers,
                                                    &p->boundary.surface);

  json_object_set_new(o, "sources",
                      vg_effects_json(&r->run->effects, &front,
                                      &p->resolved.settings));
  json_object_set_new(o, "size", size_json(r->run));
  if (p->read.wakes.n)
    json_object_set_new(o, "wakes",
                        vg_report_wakes_json(&p->read.wakes, r->run->n_probe,
                                             r->run->probe));
  json_object_set_new(o, "mesh", vg_report_mesh_json(&r->run->judge, m));
  if (p->read.is_section)
    json_object_set_new(o, "plane", vg_report_plane_json(&r->run->plane));
  if (p->boundary.pairs.n) {
    json_object_set_new(o, "periodic",
                        vg_report_periodic_json(p->boundary.pairs.n,
                                                p->boundary.pairs.pair));
    json_object_set_new(o, "periodic_distance",
                        json_real(r->run->periodic_distance));
  }
  if (r->run->sheets)
    json_object_set_new(o, "sheets",
                        vg_report_sheets_json(r->run->slices.boundary,
                                              r->run->sheets));
  if (r->run->zone_report)
    json_object_set_new(o, "zones",
                        vg_run_zones_json(r->run, &p->boundary.surface));
  json_object_set_new(o, "limits_missed",
                      vg_report_mesh_limits_json(&p->asked, &r->run->judge));
  if (!p->read.is_section) {
    json_object_set_new(o, "fill",
                        vg_report_fill_json(&r->run->partition.fill,
                                            r->run->n_field_cell));
    json_object_set_new(o, "partition", vg_report_partition_json(r->run));
  }
  json_object_set_new(o, "memory_bytes", vg_report_memory_json(r->run));
  if (r->layers->is_on && !p->read.is_section)
    json_object_set_new(o, "field",
                        vg_report_mesh_json(&r->run->field_judge, m));
  if (r->layers->is_on)
    json_object_set_new(o, "layers", vg_report_layers_json(r->layers, m));
  if (r->run->parts)
    json_object_set_new(o, "solver_parts",
                        vg_report_solver_json(&r->run->solver));
}

json_t *vg_run_report_json(const struct vg_run_report *r, int ok,
                           const struct vg_error *err)
{
  const struct vg_problem *p = r->problem;
  const struct vg_boundary *b = &p->boundary;
  const struct vg_mesh *m = vg_problem_surface(p);
  json_t *o = json_object();

  json_object_set_new(o, "vanguard", json_string(VG_VERSION));
  json_object_set_new(o, "source", json_string(vg_source_digest));
  json_object_set_new(o, "helpers", helpers_json());
  json_object_set_new(o, "title", vg_text_json(p->asked.title));
  json_object_set_new(o, "ok", json_boolean(ok));
  if (!ok) vg_report_error_json(o, err);
  json_object_set_new(o, "flow",
                      vg_report_flow_json(&b->flow, b->domain.added_farfield));
  json_object_set_new(o, "input", vg_report_size_json(m));
  json_object_set_new(o, "patches", vg_report_patches_json(m));
  json_object_set_new(o, "surface",
                      vg_report_surface_json(m, &b->check,
                                             r->problem->read.unit,
                                             VG_LISTED_DEFECTS));
  json_object_set_new(o, "remesh", vg_report_remesh_json(&b->remeshing, m));
  json_object_set_new(o, "domain", vg_report_domain_json(&b->domain));
  json_object_set_new(o, "notes", vg_report_notes_json(&p->notes));
  if (ok && r->has_mesh) put_mesh(o, r);
  if (ok && r->outputs) json_object_set_new(o, "files", files_json(r));
  json_object_set_new(
    o, "seconds",
    json_pack("{s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f s:f}", "read",
              r->time.read, "check", r->time.check, "sizes", r->run->time_size,
              "layers", r->run->time_layers, "fill", r->run->time_fill,
              "number", r->run->partition.number, "judge", r->run->time_judge,
              "parts", r->run->time_parts, "write", r->time.write, "digest",
              r->time.digest, "sync", r->time.sync, "pictures",
              r->run->pictures.time + r->time.page, "total",
              vg_display_now() - r->time.start));
  json_object_set_new(o, "peak_memory_bytes",
                      json_real(r->run->memory > 0 ? r->run->memory
                                                   : vg_report_peak_memory()));
  return o;
}

static void print_count(FILE *to, const char *name, size_t n)
{
  char count[32];

  fprintf(to, "  %-24s %15s\n", name, vg_text_count(n, count));
}

/* The slab of a section is of no interest to the user. */
static void print_section(FILE *to, const struct vg_problem *p)
{
  const struct vg_mesh *m = vg_problem_surface(p);
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  fprintf(to, "\nSection\n");
  print_count(to, "edges, with the farfield", vg_section_points(m));
  fprintf(to, "  bounding box             %.6g %.6g to %.6g %.6g\n", lo[0],
          lo[1], hi[0], hi[1]);
}

void vg_run_report_surface_text(FILE *to, const struct vg_run_report *r)
{
  const struct vg_problem *p = r->problem;
  const struct vg_boundary *b = &p->boundary;
  const struct vg_mesh *m = vg_problem_surface(p);

  fprintf(to, "%s\n\n", p->asked.title);
  vg_report_flow_text(to, &b->flow, b->domain.added_farfield);
  for (size_t i = 0; i < p->notes.n; i++)
    fprintf(to, "  note: %s\n", p->notes.text[i]);
  if (p->read.is_section) {
    print_section(to, p);
    return;
  }
  fprintf(to, "\nSurface\n");
  vg_report_size_text(to, m);
  if (b->n_welded || b->n_dropped)
    fprintf(to, "  welded: %zu points merged, %zu triangles removed\n",
            b->n_welded, b->n_dropped);
  vg_report_remesh_text(to, &b->remeshing);
  vg_report_domain_text(to, &b->domain);
  if (b->read)
    vg_report_surface_text(to, m, &b->check, r->problem->read.unit,
                           vg_boundary_is_stretched(b), VG_SHOWN_DEFECTS);
}

static void print_times(FILE *to, const struct vg_run_report *r)
{
  fprintf(to,
          "\nTime (s)\n  read %.2f, surface check %.2f, sizing field %.2f, ",
          r->time.read, r->time.check, r->run->time_size);
  if (r->layers->is_on) fprintf(to, "layers %.2f, ", r->run->time_layers);
  fprintf(to, "fill %.2f, numbering %.2f,\n  mesh check %.2f, ",
          r->run->time_fill, r->run->partition.number, r->run->time_judge);
  if (r->run->parts) fprintf(to, "solver partition %.2f, ", r->run->time_parts);
  fprintf(to, "write %.2f, total %.2f\n", r->time.write, r->time.total);
  vg_report_memory_text(to, r->run);
}

static void print_files(FILE *to, const struct vg_run_report *r)
{
  fprintf(to, "\nFiles\n");
  for (size_t i = 0; i < r->outputs->n_file; i++) {
    char *path = vg_outputs_final(r->outputs, r->outputs->file[i].suffix);

    fprintf(to, "  %s%s\n", path ? path : "",
            r->outputs->file[i].keep_old ? "  (input, kept)" : "");
    free(path);
  }
}

/* How the space outside the layers was filled. */
static void print_fill(FILE *to, const struct vg_run_report *r)
{
  const struct vg_run *m = r->run;

  fprintf(to, "\nDomain decomposition\n");
  vg_report_partition_text(to, m);
  fprintf(to, "\nVolume fill\n");
  vg_report_fill_text(to, &m->partition.fill, m->n_field_cell);
  if (r->layers->is_on) {
    fprintf(to, "\n"
                "Cells outside the layers\n");
    print_count(to, "tetrahedra", m->n_field_cell);
    vg_report_mesh_text(to, &m->field_judge, 0);
  }
}

void vg_run_report_text(FILE *to, const struct vg_run_report *r)
{
  const struct vg_run *m = r->run;

  vg_run_report_surface_text(to, r);
  if (!r->has_mesh) return;
  if (r->layers->is_on) {
    fprintf(to, "\nBoundary layers\n");
    vg_report_layers_text(to, r->layers, &r->problem->boundary.surface);
  }
  if (r->problem->read.is_section) {
    fprintf(to, "\nMesh in the plane\n");
    vg_report_plane_text(to, &m->plane);
  } else {
    print_fill(to, r);
  }
  fprintf(to, r->problem->read.is_section ? "\nMesh one cell thick\n"
                                          : "\nVolume mesh\n");
  print_count(to, "points", m->slices.n_point);
  if (!r->problem->read.is_section)
    print_count(to, "tetrahedra", m->slices.n_cell[VG_SLICE_TET]);
  if (m->slices.n_cell[VG_SLICE_PYR])
    print_count(to, "pyramids", m->slices.n_cell[VG_SLICE_PYR]);
  if (m->slices.n_cell[VG_SLICE_PRI])
    print_count(to, "prisms", m->slices.n_cell[VG_SLICE_PRI]);
  if (m->slices.n_cell[VG_SLICE_HEX])
    print_count(to, "hexahedra", m->slices.n_cell[VG_SLICE_HEX]);
  if (r->layers->is_on || r->problem->read.is_section)
    vg_report_whole_text(to, &m->judge);
  else vg_report_mesh_text(to, &m->judge, 0);
  vg_report_sheets_text(to, m->slices.boundary, m->sheets);
  vg_report_wakes_text(to, &r->problem->read.wakes, m->n_probe, m->probe);
  vg_report_zones_text(to, m->slices.boundary, m->zone_report);
  vg_report_periodic_text(to, r->problem->boundary.pairs.n,
                          r->problem->boundary.pairs.pair,
                          m->periodic_distance);
  if (m->parts) {
    fprintf(to, "\nSolver partition\n");
    vg_report_solver_text(to, &m->solver);
  }
  print_times(to, r);
  if (r->outputs) print_files(to, r);
}
