/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* HXT of gmsh (C. Marot, J. Pellerin, J.-F. Remacle, "One machine, one minute,
 * three billion tetrahedra", Int. J. Numer. Methods Eng. 117(9), 2019),
 * through gmsh's C interface. The library is loaded in a child process when
 * this mesher is requested; it need not be installed otherwise. */
#include <assert.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesher/mesher_parts.h"

/* Interface of version 4.8; later versions have other arguments. */
static const char library_name[] = "libgmsh.so.4.8";

/* HXT makes edges that are on average 1.47 times as long as requested. With
 * this factor they have the requested length. */
static const double stretch = 0.68; /* K33 */

static struct {
  void (*initialize)(int argc, char **argv, int read_config, int *ierr);
  void (*set_number)(const char *name, double value, int *ierr);
  int (*add_discrete)(int dim, int tag, int *boundary, size_t n, int *ierr);
  void (*add_nodes)(int dim, int tag, size_t *tags, size_t n_tag, double *x,
                    size_t n_x, double *u, size_t n_u, int *ierr);
  void (*add_elements)(int tag, int type, size_t *tags, size_t n_tag,
                       size_t *nodes, size_t n_node, int *ierr);
  int (*add_loop)(int *surfaces, size_t n, int tag, int *ierr);
  int (*add_volume)(int *loops, size_t n, int tag, int *ierr);
  void (*synchronize)(int *ierr);
  void (*set_sizes)(double (*at)(int dim, int tag, double x, double y, double z,
                                 void *data),
                    void *data, int *ierr);
  void (*generate)(int dim, int *ierr);
  void (*get_nodes)(size_t **tags, size_t *n_tag, double **x, size_t *n_x,
                    double **u, size_t *n_u, int dim, int tag,
                    int with_boundary, int with_u, int *ierr);
  void (*get_elements)(int type, size_t **tags, size_t *n_tag, size_t **nodes,
                       size_t *n_node, int tag, size_t task, size_t n_task,
                       int *ierr);
} gmsh;

static int load(char *why, size_t size)
{
  const struct {
    const char *name;
    void *at;
  } function[] = {
    { "gmshInitialize", &gmsh.initialize },
    { "gmshOptionSetNumber", &gmsh.set_number },
    { "gmshModelAddDiscreteEntity", &gmsh.add_discrete },
    { "gmshModelMeshAddNodes", &gmsh.add_nodes },
    { "gmshModelMeshAddElementsByType", &gmsh.add_elements },
    { "gmshModelGeoAddSurfaceLoop", &gmsh.add_loop },
    { "gmshModelGeoAddVolume", &gmsh.add_volume },
    { "gmshModelGeoSynchronize", &gmsh.synchronize },
    { "gmshModelMeshSetSizeCallback", &gmsh.set_sizes },
    { "gmshModelMeshGenerate", &gmsh.generate },
    { "gmshModelMeshGetNodes", &gmsh.get_nodes },
    { "gmshModelMeshGetElementsByType", &gmsh.get_elements },
  };
  void *library = vg_mesher_library(library_name);

  if (!library) {
    snprintf(why, size,
             "gmsh's library %s cannot be loaded (%s); install it "
             "(Debian: libgmsh4.8), or use another mesher",
             library_name, dlerror());
    return 0;
  }
  for (size_t i = 0; i < sizeof function / sizeof *function; i++) {
    void *found = dlsym(library, function[i].name);

    if (!found) {
      snprintf(why, size, "%s has no function %s", library_name,
               function[i].name);
      return 0;
    }
    memcpy(function[i].at, &found, sizeof found);
  }
  return 1;
}

static double size_at(int dim, int tag, double x, double y, double z,
                      void *data)
{
  const struct vg_mesher_sizes *s = data;
  const double at[1][3] = { { x, y, z } };
  double h;

  (void)dim;
  (void)tag;
  s->at(s->user, 1, at, &h);
  return stretch * h;
}

static int set_options(void)
{
  static const struct {
    const char *name;
    double value;
  } option[] = {
    { "General.Terminal", 0 },
    { "General.NumThreads", 1 },
    { "Mesh.Algorithm3D", 10 },
    { "Mesh.Optimize", 1 },
    { "Mesh.MeshSizeExtendFromBoundary", 0 },
    { "Mesh.MeshSizeFromPoints", 0 },
    { "Mesh.MeshSizeFromCurvature", 0 },
    { "Mesh.Renumber", 0 },
  };
  int bad = 0;

  gmsh.initialize(0, NULL, 0, &bad);
  for (size_t i = 0; !bad && i < sizeof option / sizeof *option; i++)
    gmsh.set_number(option[i].name, option[i].value, &bad);
  return bad;
}

/* --- the front ------------------------------------------------------------ */

/* HXT identifies volumes by the surfaces around them. Where a front touches
 * itself along edges, the space between may also be a volume and would have
 * the same surface around it as the void. Each piece of a shell is therefore a
 * surface of its own. */

/* Add the points of a surface that no other surface has added; numbered from
 * 1. */
static int put_points(const struct vg_mesher_front *f,
                      const struct vg_mesher_shells *s, uint32_t piece,
                      unsigned char *is_put)
{
  size_t *node = vg_alloc(f->n_point, sizeof *node), n = 0;
  double *x = vg_alloc(f->n_point, 3 * sizeof *x);
  int bad = !node || !x;

  for (size_t i = 0; !bad && i < 3 * f->n_face; i++) {
    uint32_t v = f->face[i / 3][i % 3];

    if (s->piece[i / 3] != piece || is_put[v]) continue;
    is_put[v] = 1;
    memcpy(x + 3 * n, f->x[v], 3 * sizeof *x);
    node[n++] = (size_t)v + 1;
  }
  if (!bad) gmsh.add_discrete(2, (int)piece + 1, NULL, 0, &bad);
  if (!bad) gmsh.add_nodes(2, (int)piece + 1, node, n, x, 3 * n, NULL, 0, &bad);
  free(node);
  free(x);
  return bad;
}

static int put_triangles(const struct vg_mesher_front *f,
                         const struct vg_mesher_shells *s, uint32_t piece)
{
  size_t *tri = vg_alloc(f->n_face, 3 * sizeof *tri), n = 0;
  int bad = !tri;

  for (size_t i = 0; !bad && i < f->n_face; i++)
    for (int k = 0; s->piece[i] == piece && k < 3; k++)
      tri[n++] = (size_t)f->face[i][k] + 1;
  if (!bad) gmsh.add_elements((int)piece + 1, 2, NULL, 0, tri, n, &bad);
  free(tri);
  return bad;
}

/* Add one volume within one shell and around the hollow ones, or one volume in
 * each shell. Hollows in several shells are not supported, because gmsh needs
 * to know which hollow lies in which shell. */
static int put_volumes(const struct vg_mesher_shells *s)
{
  size_t n_outer = s->n - s->n_hollow, n = 1;
  int *loop = vg_alloc(s->n, sizeof *loop);
  int *surface = vg_alloc(s->n_piece, sizeof *surface), bad = !loop || !surface;

  if (!bad && n_outer != 1 && s->n_hollow) bad = 1;
  for (size_t k = 0; !bad && k < s->n; k++) {
    int tag = (int)k + 1;
    size_t n_surface = 0;

    for (size_t i = 0; i < s->n_piece; i++)
      if (s->shell_of[i] == k) surface[n_surface++] = (int)i + 1;
    gmsh.add_loop(surface, n_surface, tag, &bad);
    if (s->is_hollow[k]) loop[n++] = tag;
    else loop[0] = tag;
    if (!bad && n_outer > 1) gmsh.add_volume(loop, 1, tag, &bad);
  }
  if (!bad && n_outer == 1) gmsh.add_volume(loop, n, 1, &bad);
  if (!bad) gmsh.synchronize(&bad);
  free(loop);
  free(surface);
  return bad;
}

/* Limit, since a front in hundreds of pieces would scan its points hundreds of
 * times. */
#define MOST_PIECES 200

static int put_front(const struct vg_mesher_front *f)
{
  struct vg_mesher_shells s;
  unsigned char *is_put = vg_calloc(f->n_point, 1);
  int bad = !is_put || vg_mesher_find_shells(f, &s) || s.n_piece > MOST_PIECES;

  for (uint32_t k = 0; !bad && k < s.n_piece; k++)
    bad = put_points(f, &s, k, is_put);
  for (uint32_t k = 0; !bad && k < s.n_piece; k++)
    bad = put_triangles(f, &s, k);
  if (!bad) bad = put_volumes(&s);
  free(is_put);
  return bad; /* the process ends soon, which frees the rest */
}

/* --- the cells ------------------------------------------------------------ */

/* New nodes in the order of their tags, which may have gaps. */
static int take_nodes(size_t n_front, struct vg_mesher_cells *to,
                      uint32_t **number, size_t *most)
{
  size_t *tag = NULL, n = 0, n_x = 0, n_u = 0;
  double *x = NULL, *u = NULL;
  int bad = 0;

  gmsh.get_nodes(&tag, &n, &x, &n_x, &u, &n_u, 3, -1, 0, 0, &bad);
  if (bad || n_x != 3 * n) return 1;
  for (size_t i = 0; i < n; i++) *most = tag[i] > *most ? tag[i] : *most;
  *number = vg_calloc(*most + 1, sizeof **number);
  to->x = vg_alloc(n, sizeof *to->x);
  if (!*number || !to->x) return 1;
  for (size_t i = 0; i < n; i++)
    if (tag[i] > n_front) (*number)[tag[i]] = (uint32_t)i + 1;
  for (size_t t = n_front + 1; t <= *most; t++) {
    if (!(*number)[t]) continue;
    memcpy(to->x[to->n_point], x + 3 * ((*number)[t] - 1), sizeof *to->x);
    (*number)[t] = (uint32_t)(n_front + to->n_point++);
  }
  return 0;
}

static int take_cells(size_t n_front, struct vg_mesher_cells *to)
{
  size_t *tag = NULL, *node = NULL, n = 0, n_node = 0, most = n_front;
  uint32_t *number = NULL;
  int bad = 0;

  if (take_nodes(n_front, to, &number, &most)) return 1;
  gmsh.get_elements(4, &tag, &n, &node, &n_node, -1, 0, 1, &bad);
  if (bad || !n || n_node != 4 * n) return 1;
  to->cell = vg_alloc(n, sizeof *to->cell);
  if (!to->cell) return 1;
  for (size_t i = 0; i < n_node; i++) {
    if (!node[i] || node[i] > most) return 1;
    to->cell[i / 4][i % 4] = node[i] <= n_front ? (uint32_t)node[i] - 1
                                                : number[node[i]];
  }
  to->n_cell = n;
  return 0;
}

static int fill(const struct vg_mesher_front *front,
                const struct vg_mesher_sizes *sizes,
                struct vg_mesher_cells *cells)
{
  int bad = set_options();

  if (!bad) bad = put_front(front);
  if (!bad) gmsh.set_sizes(size_at, (void *)(uintptr_t)sizes, &bad);
  if (!bad) gmsh.generate(3, &bad);
  return bad ? 1 : take_cells(front->n_point, cells);
}

const struct vg_mesher *vg_mesher_hxt(char *why, size_t size)
{
  static const struct vg_mesher hxt = { VG_MESHER_VERSION, "HXT", fill, NULL };

  assert(why && size > 0);
  return load(why, size) ? &hxt : NULL;
}
