/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sizes of the files of a forecast mesh. */
#include <string.h>
#include <strings.h>

#include "io/mesh/fluent.h"
#include "io/mesh/foam.h"
#include "run/plan/run_plan.h"

/* Bytes per point, tetrahedron, prism and boundary triangle in each file
 * format. Binary formats: from their layouts. Text formats: measured on meshes
 * of some million cells. */
static const struct form {
  const char *word;
  double point, tet, prism, face;
} forms[] = {
  { "b8.ugrid", 24, 16, 24, 16 },   { "lb8.ugrid", 24, 16, 24, 16 },
  { "r8.ugrid", 24, 16, 24, 16 },   { "lr8.ugrid", 24, 16, 24, 16 },
  { "b4.ugrid", 12, 16, 24, 16 },   { "lb4.ugrid", 12, 16, 24, 16 },
  { "r4.ugrid", 12, 16, 24, 16 },   { "lr4.ugrid", 12, 16, 24, 16 },
  { "b8l.ugrid", 24, 32, 48, 32 },  { "lb8l.ugrid", 24, 32, 48, 32 },
  { "b8.ugrid64", 24, 32, 48, 32 }, { "lb8.ugrid64", 24, 32, 48, 32 },
  { "ugrid", 51, 28, 42, 24 },      { "cogsg", 24, 16, 0, 41 },
  { "vtu", 24, 49, 57, 49 },        { "pvtu", 28, 49, 57, 0 },
  { "meshb", 28, 20, 28, 16 },      { "mesh", 56, 30, 44, 26 },
  { "su2", 85, 43, 58, 26 },        { "zones.su2", 85, 43, 58, 26 },
  { "msh", 32, 40, 56, 32 },        { "cgns", 24, 16, 24, 12 },
};

/* A Fluent file has one line per face, with the hexadecimal numbers of its
 * corners and two cells; all lines are assumed to have the same length. */
static double fluent_bytes(const struct vg_plan *p)
{
  int is_mixed = p->prism > 0, width = 1;
  double faces = 2 * p->tet + 2.5 * p->prism +
                 0.5 * (double)p->problem->boundary.surface.n_tri;

  for (double n = p->tet + p->prism; n >= 16; n /= 16) width++;
  return 76 * p->point +
         faces * ((is_mixed ? 6 : 5) * (width + 1) + 1 + is_mixed) +
         (is_mixed ? 2 * (p->tet + p->prism) : 0);
}

double vg_plan_bytes(const struct vg_plan *p, const char *item)
{
  struct vg_foam_options foam;
  double boundary = (double)p->problem->boundary.surface.n_tri;

  if (!strcmp(item, "auto")) return 0;
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    const struct form *f = &forms[i];

    if (!strcasecmp(item, f->word))
      return f->point * p->point + f->tet * p->tet + f->prism * p->prism +
             f->face * boundary;
  }
  if (!strcasecmp(item, VG_FLUENT_SUFFIX)) return fluent_bytes(p);
  if (vg_foam_word(item, &foam)) {
    double faces = 2 * p->tet + 2.5 * p->prism + 0.5 * boundary;

    return foam.is_ascii ? 58 * p->point + 46 * faces
                         : 24 * p->point + 24 * faces;
  }
  return 0;
}

double vg_plan_bytes_all(const struct vg_plan *p)
{
  char list[VG_WRITE_MAX], *save = NULL;
  double sum = 0;

  memcpy(list, p->problem->resolved.settings.write, sizeof list);
  for (char *word = strtok_r(list, " ,", &save); word;
       word = strtok_r(NULL, " ,", &save))
    sum += vg_plan_bytes(p, word);
  return sum;
}
