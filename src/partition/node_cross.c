/* Changes that cross the front. Outline: a zone is given the front within a
 * band of its planes, so many of the spacings there, and keeps cells by their
 * corners. A long cell can leave that band between them, where the spacing is
 * less, and pass through a front that the zone never saw. Its new faces there
 * are few; they are tested against the whole front, as it was before the
 * stage. */
#include <math.h>
#include <string.h>

#include "core/triangles.h"
#include "partition/node.h"

/* --- faces that leave the band ------------------------------------------- */

/* Where the spacing was looked up last: it tells about faces nearby too. */
struct band {
  const struct vg_region *region;
  const struct vg_sizing *sizing;
  double width, slope;       /* in spacings; of the sizing */
  double x[3], h;
};

/* Is no point of a triangle so far from the planes as `most`, by the spacing
 * that was looked up? Between the feet of two points lies no more than between
 * them. */
static int is_within(const struct band *b, const double *const x[3],
                     double most)
{
  double far2 = 0;

  for (int i = 0; i < 3; i++) {
    double d2 = 0;

    for (int k = 0; k < 3; k++)
      d2 += (x[i][k] - b->x[k]) * (x[i][k] - b->x[k]);
    far2 = fmax(far2, d2);
  }
  return most <= b->width * (b->h - b->slope * sqrt(far2));
}

/* Does the triangle stay where the front is known? No also in doubt. */
static int stays(struct band *b, const double *const x[3])
{
  const struct vg_region *r = b->region;
  double most = 0;

  for (int i = 0; i < r->n_plane; i++)
    for (int k = 0; k < 3; k++)
      most = fmax(most, fabs(vg_plane_side(&r->plane[i], x[k])));
  if (is_within(b, x, most)) return 1;
  for (int k = 0; k < 3; k++) b->x[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  b->h = vg_region_spacing(r, b->sizing, b->x);
  return is_within(b, x, most);
}

/* --- faces that cross the front ------------------------------------------ */

struct crossing {
  const struct vg_node *n;
  size_t work;
  uint32_t v[3];
};

/* Faces that have a cell of the zone now are no longer there. */
static int is_gone(const struct crossing *c, uint32_t face)
{
  const struct vg_change *change = &c->n->change[c->work];

  for (size_t k = 0; k < change->n_gone; k++)
    if (c->n->face[c->work][change->gone[k]] == face) return 1;
  return 0;
}

static int crosses(void *context, uint32_t face)
{
  const struct crossing *c = context;
  const struct vg_front *f = &c->n->front;
  const uint32_t *v = c->v, *w = f->face[face];
  int common = 0;

  for (int k = 0; k < 9; k++) common += v[k / 3] == w[k % 3];
  return common < 3 &&
         vg_triangles_meet((const double (*)[3])f->x, v, w, v, w) &&
         !is_gone(c, face);
}

int vg_node_crosses(const struct vg_node *n, size_t i, size_t first)
{
  const struct vg_change *c = &n->change[i];
  const struct vg_sizing *sizing = n->select.sizing;
  const struct vg_region *r = &n->region[i];
  struct band b = { .region = r, .sizing = sizing,
                    .width = vg_region_band(r, VG_BAND_FRONT) };

  if (!r->n_plane || !sizing) return 0;
  b.slope = vg_sizing_slope(sizing);
  for (size_t k = 0; k < c->n_face; k++) {
    struct crossing at = { .n = n, .work = i };
    const double *x[3];

    for (int j = 0; j < 3; j++) {
      at.v[j] = vg_node_point(n, i, first, c->face[k][j]);
      x[j] = n->front.x[at.v[j]];
    }
    if (!stays(&b, x) && vg_select_touched(&n->select, x, crosses, &at))
      return 1;
  }
  return 0;
}
