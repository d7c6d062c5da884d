/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A grid family: its members, and how well they follow the family rule. */
#define _GNU_SOURCE
#include <math.h>
#include <stdlib.h>

#include "cli/sweep/sweep.h"
#include "io/stream/stream.h"
#include "run/common/json_build.h"

static const char *const names[VG_MEMBER_N] = { "cells", "surface_edge",
                                                "field_edge", "first_height",
                                                "layers" };

/* Factor of quantity k from one member to another: that of cells is the cube of
 * the refinement ratio of edges, or its square in two dimensions. */
static double rule(const struct vg_sweep_options *o, int k,
                   const struct vg_sweep_case *from,
                   const struct vg_sweep_case *to)
{
  double finer = vg_sweep_scale(o, from->family) /
                 vg_sweep_scale(o, to->family);

  if (k == VG_MEMBER_CELLS) return finer * finer * (to->is_plane ? 1 : finer);
  return k == VG_MEMBER_LEVELS ? finer : 1 / finer;
}

void vg_sweep_member(const json_t *report, struct vg_sweep_case *c)
{
  const char *field = json_object_get(report, "field") ? "field" : "mesh";
  const json_t *layers = json_object_get(report, "layers");

  c->is_plane = json_object_get(report, "plane") != NULL;
  c->member[VG_MEMBER_CELLS] = vg_json_number(report, "mesh", "cells");
  c->member[VG_MEMBER_SURFACE] = vg_json_number(report, "surface", "quality",
                                                "edge_mean");
  c->member[VG_MEMBER_FIELD] = vg_json_number(report, field, "edge_length");
  c->member[VG_MEMBER_FIRST] = vg_json_number(layers, "all", "first", "mean");
  c->member[VG_MEMBER_LEVELS] = vg_json_number(layers, "all", "levels", "mean");
}

const struct vg_sweep_case *vg_sweep_before(const struct vg_sweep *s, size_t i)
{
  const struct vg_sweep_case *c = &s->item[i], *p;

  while (i--) {
    p = &s->item[i];
    if (p->is_done && p->family != c->family &&
        p->bisections == c->bisections && p->leaf_cells == c->leaf_cells &&
        p->way == c->way && p->subdomains == c->subdomains &&
        p->ranks == c->ranks && p->threads == c->threads &&
        p->repeat == c->repeat)
      return p;
  }
  return NULL;
}

/* Print a member and, if there is a previous one, the ratios to it. */
static void text_of(FILE *to, const struct vg_sweep_options *o,
                    const struct vg_sweep_case *c,
                    const struct vg_sweep_case *p)
{
  fprintf(to, "%-6lld %6.4f", (long long)c->family,
          vg_sweep_scale(o, c->family));
  for (int k = 0; k < VG_MEMBER_N; k++)
    fprintf(to, isfinite(c->member[k]) ? " %12.6g" : "            -",
            c->member[k]);
  fprintf(to, "\n");
  if (!p) return;
  fprintf(to, "       ratio");
  for (int k = 0; k < VG_MEMBER_N; k++) {
    double r = c->member[k] / p->member[k];

    fprintf(to, isfinite(r) ? " %12.4f" : "            -", r);
  }
  fprintf(to, "\n        rule");
  for (int k = 0; k < VG_MEMBER_N; k++)
    fprintf(to, " %12.4f", rule(o, k, p, c));
  fprintf(to, "\n");
}

void vg_sweep_family_text(FILE *to, const struct vg_sweep *s)
{
  if (!s->o->family.n) return;
  fprintf(to, "\n%-6s %6s %12s %12s %12s %12s %12s\n", "level", "scale",
          "cells", "surface edge", "field edge", "first height", "layers");
  for (size_t i = 0; i < s->n; i++)
    if (s->item[i].is_done)
      text_of(to, s->o, &s->item[i], vg_sweep_before(s, i));
}

static void put_real(struct vg_output *out, double v)
{
  vg_output_text(out, ",");
  if (isfinite(v)) vg_output_real(out, v);
}

vg_status vg_sweep_family_write(const struct vg_sweep *s, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = NULL;
  vg_status st = VG_OK;

  if (!s->o->family.n) return VG_OK;
  if (asprintf(&path, "%s/family.csv", s->o->dir) < 0) {
    path = NULL;
    VG_TRY(vg_fail_memory(err, "a path"));
  }
  VG_TRY(vg_output_open(path, &out, err));
  vg_output_text(&out, "case,level,scale");
  for (int k = 0; k < VG_MEMBER_N; k++)
    vg_output_format(&out, ",%s,%s_ratio,%s_rule", names[k], names[k],
                     names[k]);
  vg_output_text(&out, "\n");
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *c = &s->item[i], *p = vg_sweep_before(s, i);

    if (!c->is_done) continue;
    vg_output_format(&out, "%s,%lld", c->name, (long long)c->family);
    put_real(&out, vg_sweep_scale(s->o, c->family));
    for (int k = 0; k < VG_MEMBER_N; k++) {
      put_real(&out, c->member[k]);
      put_real(&out, p ? c->member[k] / p->member[k] : NAN);
      put_real(&out, p ? rule(s->o, k, p, c) : NAN);
    }
    vg_output_text(&out, "\n");
  }
  VG_TRY(vg_output_commit(&out, err));
done:
  vg_output_release(&out);
  free(path);
  return st;
}
