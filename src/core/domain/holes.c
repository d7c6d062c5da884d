/* Outline: open edges into loops; those where a half body was cut stay; the
 * others are closed by plane patches on their rims. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/domain/open_edges.h"
#include "core/domain/planar.h"
#include "core/domain/symmetry.h"
#include "core/geometry/vector.h"

#define HOLE_FLATNESS 0.05 /* S11 */

struct holes {
  struct vg_mesh m;
  struct vg_border open;
  uint32_t *next;            /* [n_point] along the rim, or UINT32_MAX */
  uint32_t *loop;            /* [n_point] number of its loop */
  uint32_t n_loop;
  struct rim { uint32_t first, patch; double longest; int stays; } *rim;
  double lo[3], hi[3], tolerance;
};

static vg_status follow_rims(struct holes *h, struct vg_error *err)
{
  for (size_t i = 0; i < h->m.n_point; i++) h->next[i] = h->loop[i] = UINT32_MAX;
  for (size_t i = 0; i < h->open.n; i++) {
    const uint32_t *e = h->open.edge[i];
    const double *x = h->m.point[e[0]];

    if (h->next[e[0]] != UINT32_MAX)
      return vg_fail(err, VG_ERR_GEOMETRY, "two holes of the surface meet at "
                     "(%.9g, %.9g, %.9g), so that it is not clear how to close "
                     "them", x[0], x[1], x[2]);
    h->next[e[0]] = e[1];
  }
  for (size_t i = 0; i < h->open.n; i++) {
    uint32_t p = h->open.edge[i][0];

    if (h->loop[p] != UINT32_MAX) continue;
    h->rim[h->n_loop] = (struct rim){ .first = p };
    for (; h->loop[p] == UINT32_MAX; p = h->next[p]) h->loop[p] = h->n_loop;
    h->n_loop++;
  }
  return VG_OK;
}

/* A hole belongs to the patch at the longest edge of its rim. */
static void find_patches(struct holes *h)
{
  for (size_t i = 0; i < 3 * h->m.n_tri; i++) {
    uint32_t a = h->m.tri[i / 3][i % 3], b = h->m.tri[i / 3][(i + 1) % 3];
    struct rim *r;
    double l;

    if (h->next[b] != a) continue;
    r = &h->rim[h->loop[b]];
    l = vg_distance(h->m.point[a], h->m.point[b]);
    if (!(l > r->longest)) continue;
    r->longest = l;
    r->patch = h->m.tri_patch[i / 3];
  }
}

static int is_in_plane(const struct holes *h, uint32_t k, int axis, double at)
{
  uint32_t p = h->rim[k].first;

  do {
    if (fabs(h->m.point[p][axis] - at) > h->tolerance) return 0;
    p = h->next[p];
  } while (p != h->rim[k].first);
  return 1;
}

static vg_status list_edges(const struct holes *h, uint32_t k,
                            struct vg_border *to, struct vg_error *err)
{
  uint32_t p = h->rim[k].first;
  vg_status st = VG_OK;

  do {
    st = vg_border_add(to, p, h->next[p], err);
    p = h->next[p];
  } while (st == VG_OK && p != h->rim[k].first);
  return st;
}

/* Rims at one end of the body that are together where it was cut. */
static vg_status keep_symmetry(struct holes *h, int symmetry,
                               struct vg_error *err)
{
  struct vg_border some = VG_BORDER_INIT;
  int found = 0;
  vg_status st = VG_OK;

  for (int end = 0; end < 6 && symmetry >= 0 && !found; end++) {
    int axis = (end / 2 + 1) % 3;      /* y first: the usual one */
    double at = end % 2 ? h->hi[axis] : h->lo[axis];

    some.n = 0;
    for (uint32_t k = 0; k < h->n_loop; k++)
      if (is_in_plane(h, k, axis, at)) VG_TRY(list_edges(h, k, &some, err));
    found = some.n &&
            (symmetry > 0 || vg_is_symmetry(&h->m, &some, axis, at));
    for (uint32_t k = 0; found && k < h->n_loop; k++)
      h->rim[k].stays = is_in_plane(h, k, axis, at);
  }
done:
  vg_border_release(&some);
  return st;
}

static vg_status close_rim(struct holes *h, uint32_t k,
                           const struct vg_size_law *law, struct vg_error *err)
{
  struct vg_border rim = VG_BORDER_INIT;
  struct vg_error inner = VG_ERROR_INIT;
  const double *x = h->m.point[h->rim[k].first];
  vg_status st;

  VG_TRY(list_edges(h, k, &rim, err));
  st = vg_planar_patch_near(&h->m, rim.n, (const uint32_t (*)[2])rim.edge,
                            law, HOLE_FLATNESS, h->rim[k].patch, &inner);
  if (st < 0)
    st = vg_fail(err, st, "the hole at (%.9g, %.9g, %.9g), of %zu edges, "
                 "cannot be closed: %s", x[0], x[1], x[2], rim.n, inner.text);
done:
  vg_border_release(&rim);
  return st;
}

static vg_status prepare(struct holes *h, int symmetry, struct vg_error *err)
{
  double length = 0;
  vg_status st;

  vg_mesh_bounds(&h->m, h->lo, h->hi);
  for (int k = 0; k < 3; k++) length = fmax(length, h->hi[k] - h->lo[k]);
  h->tolerance = VG_PLANE_TOLERANCE * length;
  VG_TRY(vg_open_edges(&h->m, &h->open, err));
  h->next = vg_alloc(h->m.n_point, sizeof *h->next);
  h->loop = vg_alloc(h->m.n_point, sizeof *h->loop);
  h->rim = vg_alloc(h->open.n, sizeof *h->rim);
  if (!h->next || !h->loop || !h->rim)
    return vg_fail_memory(err, "the holes of the surface");
  VG_TRY(follow_rims(h, err));
  find_patches(h);
  st = keep_symmetry(h, symmetry, err);
done:
  return st;
}

vg_status vg_domain_close_holes(struct vg_mesh *surface, int symmetry,
                                const struct vg_sizing *sizing,
                                size_t *n_hole, size_t *n_tri,
                                struct vg_error *err)
{
  struct holes h = { .n_loop = 0 };
  const struct vg_size_law law = vg_size_law_of(sizing);
  vg_status st;

  *n_hole = *n_tri = 0;
  VG_TRY(vg_mesh_copy(&h.m, surface, err));
  VG_TRY(prepare(&h, symmetry, err));
  for (uint32_t k = 0; k < h.n_loop; k++) {
    if (h.rim[k].stays) continue;
    VG_TRY(close_rim(&h, k, &law, err));
    ++*n_hole;
  }
  *n_tri = h.m.n_tri - surface->n_tri;
  vg_mesh_move(surface, &h.m);
done:
  vg_mesh_release(&h.m);
  vg_border_release(&h.open);
  free(h.next);
  free(h.loop);
  free(h.rim);
  return st;
}
