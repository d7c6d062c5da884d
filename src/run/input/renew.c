/* The triangles of the surface made anew, as settings ask for it. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/wrap/wrap.h"
#include "io/mesh/format.h"
#include "run/input/input.h"
#include "run/input/share.h"

int vg_problem_is_renewed(const struct vg_problem *p)
{
  if (p->settings.remesh != VG_ANSWER_AUTO)
    return p->settings.remesh == VG_ANSWER_YES;
  return !*p->files.front && vg_format_is_cad(p->files.surface)
         && !(p->settings.wrap > 0);
}

/* *hard: [n_patch], NULL where none is asked for. */
static vg_status hard_patches(const struct vg_problem *p, uint8_t **hard,
                              struct vg_error *err)
{
  for (size_t i = 0; i < p->settings.n_patch; i++) {
    const struct vg_patch_row *row = &p->settings.patch[i];
    size_t at = vg_mesh_find_patch(&p->surface, row->id);

    if (!row->hard || at == SIZE_MAX) continue;
    if (!*hard) *hard = vg_calloc(p->surface.n_patch, 1);
    if (!*hard) return vg_fail_memory(err, "the patches");
    (*hard)[at] = 1;
  }
  return VG_OK;
}

static void areas(const struct vg_mesh *m, int after, double *area)
{
  for (size_t t = 0; t < m->n_tri; t++) {
    double u[3], v[3], n[3];

    vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
    vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
    vg_cross(u, v, n);
    area[2 * m->tri_patch[t] + (size_t)after] += vg_norm(n) / 2;
  }
}

struct vg_remesh_options vg_remesh_options_of(const struct vg_settings *s)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

  o.tolerance = s->surface_tolerance;
  o.accuracy = s->wrap * VG_WRAP_OFFSET;
  o.ridge_angle = s->ridge_angle;
  o.per_turn = s->per_turn;
  o.h_min = s->hmin;
  o.h_max = s->surface_size > 0 && !(s->hmax > 0 && s->hmax < s->surface_size)
            ? s->surface_size : s->hmax;
  o.growth = s->growth;
  o.scale = s->scale;
  o.n_source = s->n_source;
  o.source = s->source;
  return o;
}

static vg_status remesh(struct vg_problem *p, const uint8_t *hard,
                        const struct vg_surface_sizes *sizes,
                        struct vg_display *show, struct vg_error *err)
{
  struct vg_remesh_options o = vg_remesh_options_of(&p->settings);

  o.map = p->map;
  o.hard = hard;
  o.cap = sizes->cap;
  o.across = sizes->across;
  o.stretch = sizes->stretch;
  o.threads = p->threads;
  o.stop = (struct vg_stop){ vg_display_stop, show };
  return vg_remesh(&p->surface, &o, &p->renewal.report, err);
}

static vg_status measure(struct vg_problem *p, struct vg_mesh *given,
                         struct vg_display *show, struct vg_error *err)
{
  const struct vg_stop stop = { vg_display_stop, show };
  struct vg_renewal *r = &p->renewal;
  vg_status st;

  r->face = vg_alloc(p->surface.n_tri, sizeof *r->face);
  r->n_patch = p->surface.n_patch;
  r->area = vg_calloc(2 * r->n_patch, sizeof *r->area);
  if (!r->face || !r->area) return vg_fail_memory(err, "the distances");
  areas(given, 0, r->area);
  VG_TRY(vg_remesh_arrange(given, err));
  VG_TRY(vg_remesh_measure(&p->surface, given, p->threads, &stop, r->face,
                           r->off, err));
done:
  return st;
}

vg_status vg_problem_renew(struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err)
{
  struct vg_renewal *r = &p->renewal;
  struct vg_surface_sizes sizes = { NULL, NULL, NULL };
  struct vg_mesh given = VG_MESH_INIT;
  uint8_t *hard = NULL;
  double t = vg_display_now();
  vg_status st;

  if (p->heights.n)
    return vg_fail(err, VG_ERR_INPUT, "first heights are given at points of "
                   "the surface, which remesh_surface would take away: give "
                   "them by patch instead, or keep the surface");
  vg_display_update(show, "remesh", p->surface.n_tri, 0);
  VG_TRY(vg_mesh_copy(&given, &p->surface, err));
  VG_TRY(hard_patches(p, &hard, err));
  VG_TRY(vg_surface_sizes_make(p, &sizes, err));
  VG_TRY(remesh(p, hard, &sizes, show, err));
  r->seconds = vg_display_now() - t;
  VG_TRY(measure(p, &given, show, err));
  r->is_done = 1;
  vg_display_update(show, "put back", p->surface.n_tri, 0);
  if (p->model.cad) VG_TRY(vg_problem_put_back(p, err));
  areas(&p->surface, 1, r->area);
  vg_note(&p->notes, "the surface was made anew (remesh_surface): %zu "
          "triangles, before %zu, at most %.3g from it, tolerance %.3g",
          r->report.n_tri[1], r->report.n_tri[0],
          r->off[0].most > r->off[1].most ? r->off[0].most : r->off[1].most,
          r->report.tolerance);
done:
  vg_surface_sizes_release(&sizes);
  free(hard);
  vg_mesh_release(&given);
  return st;
}

void vg_renewal_release(struct vg_renewal *r)
{
  vg_remesh_report_release(&r->report);
  free(r->face);
  free(r->area);
  memset(r, 0, sizeof *r);
}

vg_status vg_problem_share(struct vg_problem *p, struct vg_comm *comm,
                           int is_maker, vg_status st, struct vg_error *err)
{
  if (vg_comm_size(comm) == 1 || *p->files.front
      || !vg_format_is_cad(p->files.surface) || !vg_problem_is_renewed(p))
    return vg_comm_agree(comm, st, err);
  return vg_surface_bcast(comm, is_maker, st, &p->surface, err);
}
