/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writer of .d3m project files. It uses the columns of VGRID's own example
 * (formats.md 1.6), since it is not known whether VGRID reads by column. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/vgrid/vgrid.h"

/* "%.10e" with a decimal point in every locale: at most 17 characters for
 * exponents of two digits. */
static size_t scientific(double v, char *text, size_t size)
{
  int n = snprintf(text, size, "%.10e", v);

  for (int i = 0; i < n; i++)
    if ((text[i] < '0' || text[i] > '9') && text[i] != '-' && text[i] != '+' &&
        text[i] != 'e')
      text[i] = '.';
  return (size_t)n;
}

/* Left-justified, followed by at least one blank. */
static void put_left(struct vg_output *out, const char *text, size_t n,
                     size_t width)
{
  static const char blanks[] = "                    ";

  vg_output_bytes(out, text, n);
  vg_output_bytes(out, blanks, n < width ? width - n : 1);
}

static void put_value(struct vg_output *out, double v)
{
  char text[40];
  size_t n = vg_format_real(v, text);

  if (n > 16) n = scientific(v, text, sizeof text);
  put_left(out, text, n, 17);
}

static void put_values(struct vg_output *out, int n, const double *v,
                       const char *comment)
{
  static const char blanks[] = "                                  ";

  for (int k = 0; k < n; k++) put_value(out, v[k]);
  vg_output_bytes(out, blanks, (size_t)(17 * (3 - n)));
  vg_output_format(out, "(%s)\n", comment);
}

static void put_int(struct vg_output *out, int64_t v, const char *comment)
{
  vg_output_format(out, "%16lld (%s)\n", (long long)v, comment);
}

static void put_real(struct vg_output *out, double v, const char *comment)
{
  char text[40];
  size_t n = vg_format_real(v, text);

  text[n] = 0;
  vg_output_format(out, "%16s (%s)\n", text, comment);
}

static void put_parameters(struct vg_output *out, const struct vg_project *p)
{
  vg_output_format(out,
                   "#VGRID VERSION\n3.6\n#Project Name\n%s\n#\n"
                   "#-------------  Parameters  -----------------\n#\n",
                   p->name[0] ? p->name : "project");
  put_int(out, p->grid,
          "grid: 0 Euler; 1 NS uniform spacing; 2 NS variable "
          "spacing");
  put_real(out, p->layer.rate1,
           "rate1: uniform normal spacing growth rate "
           "for NS grids");
  put_real(out, p->layer.rate2,
           "rate2: uniform normal spacing growth rate "
           "for NS grids");
  put_real(out, p->layer.delta1,
           "delt1: uniform normal spacing for the first "
           "viscous layer");
  put_int(out, p->layer.n_max, "nlayr: maximum no. of viscous layers");
  put_int(out, p->restart,
          "rstrt: -1 stop aft surf mesh; 1 continue; 0 no "
          "rstrt");
  put_real(out, p->ifact, "ifact: >1.0 coarser Euler grid; <1.0 finer");
  put_real(out, p->vfact, "vfact: >1.0 coarser NS grid; <1.0 finer");
  put_int(out, p->stretch, "strch: 0 off; 1 on");
  put_int(out, (int64_t)p->n_point,
          "npoli: no. of points defining the "
          "configuration");
  put_int(out, (int64_t)p->n_curve,
          "nline: no. of lines defining the "
          "configuration");
  put_int(out, (int64_t)p->n_shape,
          "nptch: no. of patches defining the "
          "configuration");
  put_int(out, (int64_t)p->n_source, "   ms: no. of background grid sources");
  put_int(out, p->n_background, "   ni: no. of background grid points");
  put_int(out, 250000, "mboun: maximum no. of surface mesh points");
  put_int(out, 2500000, "mpoin: maximum no. of mesh points in each run");
}

static void put_points(struct vg_output *out, const struct vg_project *p)
{
  vg_output_text(out, "#\n#-------------  Points  ---------------------\n#\n"
                      "#No.              X-coor            Y-Coor            "
                      "Z-Coor\n");
  for (size_t i = 0; i < p->n_point; i++) {
    char text[40];
    int n = snprintf(text, sizeof text, "%zu", i + 1);

    put_left(out, text, (size_t)n, 17);
    for (int k = 0; k < 3; k++) {
      size_t len = scientific(p->point[i][k], text, sizeof text);

      put_left(out, text, len, 18);
    }
    vg_output_bytes(out, "\n", 1);
  }
}

static void put_curves(struct vg_output *out, const struct vg_project *p)
{
  vg_output_text(out, "#\n#-------------  Curves  ---------------------\n#\n"
                      "#no.          #pts     list of points\n");
  for (size_t i = 0; i < p->n_curve; i++) {
    const struct vg_curve *c = p->curve + i;

    vg_output_format(out, "%8d %7zu", c->id, c->n);
    for (size_t k = 0; k < c->n; k++)
      vg_output_format(out, " %7lu", (unsigned long)c->point[k] + 1);
    vg_output_text(out, "\n\n");
  }
}

static void put_patches(struct vg_output *out, const struct vg_project *p)
{
  vg_output_text(out, "#\n#-------------  Patches  --------------------\n#\n"
                      "#no.           type    #sides  rotation bc\n"
                      "#              side    #curves list of curves\n");
  for (size_t i = 0; i < p->n_shape; i++) {
    const struct vg_patch_shape *s = p->shape + i;

    vg_output_format(out, "%8d %7d %7d %7d %7d %s\n%24s", s->patch.id, s->type,
                     s->n_side, s->rotation, s->meshing_class, s->patch.name,
                     "");
    for (size_t k = 0; k < s->n; k++) {
      int32_t c = s->curve[k], id = p->curve[labs(c) - 1].id;

      vg_output_format(out, " %7d", c < 0 ? -id : id);
    }
    vg_output_text(out, "\n\n");
  }
}

static void put_sources(struct vg_output *out, const struct vg_project *p)
{
  vg_output_text(out, "#\n#-------------  Sources  --------------------\n#\n");
  for (size_t i = 0; i < p->n_source; i++) {
    const struct vg_source *s = p->source + i;
    const double type[2] = { s->kind == VG_SOURCE_VGRID_LINE, s->stretch };
    const double weight[3] = { s->an, s->bn, s->alpha };
    const double size0[2] = { s->h0, s->sp0 }, size1[2] = { s->h1, s->sp1 };

    vg_output_format(out, "\nsource_number    %-17zu%s\n", i + 1,
                     s->group[0] ? s->group : "all");
    put_values(out, 2, type, "type:0 node, :1 line, stretching");
    put_values(out, 3, weight, "an bn alpha");
    put_values(out, 2, size0, "S, SP for pt 1");
    put_values(out, 3, s->layer0, "delta1, rate1, rate2 for pt 1");
    put_values(out, 2, size1, "S, SP for pt 2");
    put_values(out, 3, s->layer1, "delta1, rate1, rate2 for pt 2");
    put_values(out, 3, s->u, "vector U");
    put_values(out, 3, s->p, "vector P");
    put_values(out, 3, s->p0, "x, y, z of pt 1");
    put_values(out, 3, s->p1, "x, y, z of pt 2");
  }
}

vg_status vg_d3m_write(const char *path, const struct vg_project *p,
                       struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st;

  for (size_t i = 0; i < p->n_source; i++)
    if (p->source[i].kind != VG_SOURCE_VGRID_NODE &&
        p->source[i].kind != VG_SOURCE_VGRID_LINE)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "%s: source %zu is of a kind that a .d3m cannot hold; "
                     "define it in the run deck",
                     path, i + 1);
  st = vg_output_open(path, &out, err);
  if (st < 0) return st;
  put_parameters(&out, p);
  put_points(&out, p);
  put_curves(&out, p);
  put_patches(&out, p);
  put_sources(&out, p);
  return vg_output_commit(&out, err);
}
