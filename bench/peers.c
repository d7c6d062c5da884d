/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vg_bench_peers: converts between Vanguard and other meshers for bench/run.sh.
 *
 *   prepare SURFACE DECK STEM  the boundary of a .ugrid mesh as STEM.smesh
 *                              (TetGen), STEM.msh and scripts STEM.geo,
 *                              STEM.ext.geo (Gmsh), and the sizing field as
 *                              STEM.b.node, STEM.b.mtr
 *   view STEM                  the same field on TetGen's tetrahedra of these
 *                              points, as STEM.pos (Gmsh)
 *   judge MESH SURFACE DECK [OUT.ugrid]
 *                              figures of a mesh: .ugrid, .msh, or the stem
 *                              of .node and .ele; optionally written as UGRID
 *
 * DECK is a run deck (run/settings/deck.h), "-" for all defaults. Exit status 0
 * done, 1 failed, 2 usage. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/judge/quality.h"
#include "io/mesh/ugrid.h"
#include "io/stream/stream.h"
#include "peers.h"
#include "run/settings/deck.h"
#include "run/settings/plan_options.h"

#define NAME_MAX_LEN 4096

/* Width of the background cells in target lengths. */
#define BACKGROUND_CELLS 3

static vg_status load_surface(const char *path, const char *deck,
                              struct vg_mesh *m, struct vg_sizing **sizing,
                              struct vg_error *err)
{
  struct vg_settings s;
  struct vg_sizing_options options;
  vg_status st = VG_OK;

  vg_settings_default(&s);
  if (strcmp(deck, "-")) VG_TRY(vg_deck_read(deck, &s, err));
  VG_TRY(vg_ugrid_read(path, m, NULL, err));
  /* the file may be a volume mesh: drop its cells and inner points */
  free(m->tet);
  m->tet = NULL;
  m->n_tet = 0;
  options = vg_options_sizing(&s, NULL);
  VG_TRY(vg_sizing_new(&options, s.n_source, s.source, m, sizing, err));
done:
  vg_settings_release(&s);
  return st;
}

/* The points of the boundary come first in Vanguard's meshes. */
static size_t boundary_points(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] >= n) n = (size_t)m->tri[i][k] + 1;
  return n;
}

/* --- shells and a point in each body --- */

/* Distance along a ray to a triangle, or infinity (Moeller and Trumbore). */
static double ray_hit(const double o[3], const double d[3], const double a[3],
                      const double b[3], const double c[3])
{
  double e[3], f[3], p[3], q[3], s[3], det, u, v, t;

  for (int k = 0; k < 3; k++) {
    e[k] = b[k] - a[k];
    f[k] = c[k] - a[k];
    s[k] = o[k] - a[k];
  }
  vg_cross(d, f, p);
  det = vg_dot(e, p);
  if (det == 0) return INFINITY;
  vg_cross(s, e, q);
  u = vg_dot(s, p) / det;
  v = vg_dot(d, q) / det;
  t = vg_dot(f, q) / det;
  return u < 0 || v < 0 || u + v > 1 ? INFINITY : t;
}

/* The point half way from the centroid of triangle `face` to the next surface
 * behind it. */
static void point_behind(const struct vg_mesh *m, size_t face, double x[3])
{
  const uint32_t *n = m->tri[face];
  const double *p[3] = { m->point[n[0]], m->point[n[1]], m->point[n[2]] };
  double e[3], f[3], o[3], d[3], length, least = INFINITY;

  for (int k = 0; k < 3; k++) {
    e[k] = p[1][k] - p[0][k];
    f[k] = p[2][k] - p[0][k];
    o[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
  }
  vg_cross(f, e, d);
  length = sqrt(vg_dot(d, d));
  for (int k = 0; k < 3; k++) d[k] /= length;
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];
    double at = i == face
                ? INFINITY
                : ray_hit(o, d, m->point[t[0]], m->point[t[1]], m->point[t[2]]);

    if (at > 1e-9 * sqrt(length) && at < least) least = at;
  }
  for (int k = 0; k < 3; k++) x[k] = o[k] + least / 2 * d[k];
}

/* Shells with outward normals are bodies. Returns *n points, one inside each
 * body; the caller frees *hole. */
static vg_status find_holes(const struct vg_mesh *m, size_t *n,
                            double (**hole)[3], struct vg_error *err)
{
  size_t np = m->n_point;
  uint32_t *parent = vg_alloc(np, sizeof *parent);
  double *volume = vg_calloc(np, sizeof *volume);
  double *area = vg_calloc(np, sizeof *area);
  size_t *face = vg_calloc(np, sizeof *face), cap = 0;
  vg_status st = VG_OK;

  *n = 0;
  *hole = NULL;
  if (!parent || !volume || !area || !face) {
    st = vg_fail_memory(err, "shells");
    goto done;
  }
  for (size_t i = 0; i < np; i++) parent[i] = (uint32_t)i;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 1; k < 3; k++)
      parent[vg_root_of(parent, m->tri[i][k])] = vg_root_of(parent,
                                                            m->tri[i][0]);
  for (size_t i = 0; i < m->n_tri; i++) {
    uint32_t r = vg_root_of(parent, m->tri[i][0]);
    const double *a = m->point[m->tri[i][0]], *b = m->point[m->tri[i][1]];
    const double *c = m->point[m->tri[i][2]];
    double e[3], f[3], w[3], bc[3];

    for (int k = 0; k < 3; k++) {
      e[k] = b[k] - a[k];
      f[k] = c[k] - a[k];
    }
    vg_cross(e, f, w);
    vg_cross(b, c, bc);
    volume[r] += vg_dot(a, bc);
    if (vg_dot(w, w) <= area[r]) continue;
    area[r] = vg_dot(w, w);
    face[r] = i;
  }
  for (size_t i = 0; i < np; i++) {
    if (parent[i] != i || !(volume[i] > 0)) continue;
    if (vg_reserve(hole, &cap, *n + 1, sizeof **hole)) {
      st = vg_fail_memory(err, "shells");
      goto done;
    }
    point_behind(m, face[i], (*hole)[(*n)++]);
  }
done:
  free(parent);
  free(volume);
  free(area);
  free(face);
  return st;
}

/* --- the surface for TetGen and Gmsh --- */

static void put_point(struct vg_output *f, size_t id, const double x[3])
{
  vg_output_format(f, "%zu", id);
  for (int k = 0; k < 3; k++) {
    vg_output_text(f, " ");
    vg_output_real(f, x[k]);
  }
  vg_output_text(f, "\n");
}

static vg_status write_smesh(const char *stem, const struct vg_mesh *m,
                             struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  struct vg_output f = VG_OUTPUT_INIT;
  size_t n_hole;
  double(*hole)[3] = NULL;
  vg_status st = VG_OK;

  VG_TRY(find_holes(m, &n_hole, &hole, err));
  snprintf(name, sizeof name, "%s.smesh", stem);
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_format(&f, "%zu 3 0 0\n", m->n_point);
  for (size_t i = 0; i < m->n_point; i++) put_point(&f, i + 1, m->point[i]);
  vg_output_format(&f, "%zu 1\n", m->n_tri);
  for (size_t i = 0; i < m->n_tri; i++)
    vg_output_format(&f, "3 %u %u %u %u\n", m->tri[i][0] + 1, m->tri[i][1] + 1,
                     m->tri[i][2] + 1, m->tri_patch[i] + 1);
  vg_output_format(&f, "%zu\n", n_hole);
  for (size_t i = 0; i < n_hole; i++) put_point(&f, i + 1, hole[i]);
  vg_output_text(&f, "0\n");
  VG_TRY(vg_output_commit(&f, err));
done:
  vg_output_release(&f);
  free(hole);
  return st;
}

/* Write the triangles, each patch as one discrete surface. Physical groups are
 * not set, because Gmsh would then save only these. */
static vg_status write_msh(const char *stem, const struct vg_mesh *m,
                           struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  struct vg_output f = VG_OUTPUT_INIT;
  vg_status st = VG_OK;

  snprintf(name, sizeof name, "%s.msh", stem);
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_format(&f, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%zu\n",
                   m->n_point);
  for (size_t i = 0; i < m->n_point; i++) put_point(&f, i + 1, m->point[i]);
  vg_output_format(&f, "$EndNodes\n$Elements\n%zu\n", m->n_tri);
  for (size_t i = 0; i < m->n_tri; i++)
    vg_output_format(&f, "%zu 2 2 0 %u %u %u %u\n", i + 1, m->tri_patch[i] + 1,
                     m->tri[i][0] + 1, m->tri[i][1] + 1, m->tri[i][2] + 1);
  vg_output_text(&f, "$EndElements\n");
  VG_TRY(vg_output_commit(&f, err));
done:
  vg_output_release(&f);
  return st;
}

static const char field_sizes[] =
  "Field[1] = PostView;\nField[1].ViewIndex = 0;\n"
  "Background Field = 1;\nMesh.MeshSizeExtendFromBoundary = 0;\n"
  "Mesh.MeshSizeFromPoints = 0;\n";
static const char extended_sizes[] =
  "Mesh.MeshSizeExtendFromBoundary = 1;\nMesh.MeshSizeFromPoints = 0;\n";

/* Write the script of a run: sizes from the field, or from the boundary
 * alone. */
static vg_status write_geo(const char *stem, const struct vg_mesh *m,
                           int has_field, struct vg_error *err)
{
  char name[NAME_MAX_LEN];
  const char *base = strrchr(stem, '/');
  struct vg_output f = VG_OUTPUT_INIT;
  vg_status st = VG_OK;

  snprintf(name, sizeof name, "%s%s.geo", stem, has_field ? "" : ".ext");
  base = base ? base + 1 : stem;
  VG_TRY(vg_output_open(name, &f, err));
  vg_output_format(&f, "Merge \"%s.msh\";\nSurface Loop(1) = {1", base);
  for (size_t i = 1; i < m->n_patch; i++) vg_output_format(&f, ", %zu", i + 1);
  vg_output_text(&f, "};\nVolume(1) = {1};\n");
  if (has_field) vg_output_format(&f, "Merge \"%s.pos\";\n", base);
  vg_output_text(&f, has_field ? field_sizes : extended_sizes);
  VG_TRY(vg_output_commit(&f, err));
done:
  vg_output_release(&f);
  return st;
}

static vg_status prepare(char **arg, struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *sizing = NULL;
  double lo[3], hi[3], (*point)[3] = NULL, *size = NULL;
  size_t n;
  vg_status st = VG_OK;

  VG_TRY(load_surface(arg[0], arg[1], &m, &sizing, err));
  m.n_point = boundary_points(&m);
  VG_TRY(write_smesh(arg[2], &m, err));
  VG_TRY(write_msh(arg[2], &m, err));
  VG_TRY(write_geo(arg[2], &m, 1, err));
  VG_TRY(write_geo(arg[2], &m, 0, err));
  vg_mesh_bounds(&m, lo, hi);
  VG_TRY(peer_sample(sizing, lo, hi, BACKGROUND_CELLS, &n, &point, &size, err));
  VG_TRY(
    peer_write_background(arg[2], n, (const double(*)[3])point, size, err));
  printf("points %zu\ntriangles %zu\nbackground %zu\n", m.n_point, m.n_tri, n);
done:
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
  free(point);
  free(size);
  return st;
}

/* --- mesh check --- */

static void print_report(const struct vg_mesh_report *r, size_t n_tri,
                         size_t n_surface_tri)
{
  printf("valid %d\nkept %d\n", r->is_valid, n_tri == n_surface_tri);
  printf("cells %zu\npoints %zu\n", r->n_cell, r->n_point);
  printf("not_positive %zu\nopen %zu\ncrowded %zu\nsame_side %zu\n"
         "orphan %zu\noutward %zu\nunused %zu\n",
         r->not_positive, r->open_face, r->crowded_face, r->same_side_face,
         r->orphan_boundary, r->outward_boundary, r->unused_point);
  printf("volume %.12g\nvolume_error %.3g\n", r->volume, r->volume_error);
  printf("angle_min %.2f\nangle_max %.2f\nbelow_20 %.4f\nabove_150 %.4f\n",
         r->angle_min, r->angle_max, r->below[3], r->above[0]);
  printf("radius_ratio %.4f\nedges_within %.2f\nedge_mean %.4f\n",
         r->radius_ratio_mean, r->edge_within, r->edge_mean);
}

static int ends_with(const char *s, const char *end)
{
  size_t n = strlen(s), k = strlen(end);

  return n >= k && !strcmp(s + n - k, end);
}

static vg_status judge(char **arg, const char *out, struct vg_error *err)
{
  struct vg_mesh surface = VG_MESH_INIT, m = VG_MESH_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_mesh_report r;
  vg_status st = VG_OK;

  VG_TRY(load_surface(arg[1], arg[2], &surface, &sizing, err));
  if (ends_with(arg[0], ".ugrid")) VG_TRY(vg_ugrid_read(arg[0], &m, NULL, err));
  else if (ends_with(arg[0], ".msh")) VG_TRY(peer_read_msh(arg[0], &m, err));
  else VG_TRY(peer_read_tetgen(arg[0], &surface, &m, err));
  VG_TRY(vg_mesh_judge(&m, sizing, &r, err));
  print_report(&r, m.n_tri, surface.n_tri);
  if (out) VG_TRY(vg_ugrid_write(out, &m, err));
done:
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
  vg_mesh_release(&surface);
  return st;
}

int main(int argc, char **argv)
{
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  if (argc == 5 && !strcmp(argv[1], "prepare")) st = prepare(argv + 2, &err);
  else if (argc == 3 && !strcmp(argv[1], "view"))
    st = peer_write_view(argv[2], &err);
  else if ((argc == 5 || argc == 6) && !strcmp(argv[1], "judge"))
    st = judge(argv + 2, argv[5], &err);
  else {
    fprintf(stderr, "usage: vg_bench_peers prepare SURFACE DECK STEM\n"
                    "       vg_bench_peers view STEM\n"
                    "       vg_bench_peers judge MESH SURFACE DECK [OUT]\n");
    return 2;
  }
  if (st < 0) fprintf(stderr, "vg_bench_peers: %s\n", err.text);
  return st < 0;
}
