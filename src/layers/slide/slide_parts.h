/* layers/slide/slide_parts.h: what the steps of vg_slide_front share. Private
 * to slide*.c.
 *
 * Points have one numbering while the front is built: those of the surface,
 * then one per column (its top; unused where n = 0), then new ones. */
#ifndef VG_LAYERS_SLIDE_SLIDE_PARTS_H
#define VG_LAYERS_SLIDE_SLIDE_PARTS_H

#include <assert.h>

#include "base/tri_key.h"
#include "core/search/box_tree.h"
#include "layers/slide/slide.h"

/* slide_tree.c ------------------------------------------------------------*/

/** A box in the plane: its third side has no length. */
static inline struct vg_box vg_slide_box(const double lo[2], const double hi[2])
{
  return (struct vg_box){ { lo[0], lo[1], 0 }, { hi[0], hi[1], 0 } };
}

/** Tree of n boxes in the plane, along a Morton curve through their middles.
 * O(n). VG_ERR_MEMORY. */
vg_status vg_slide_tree(struct vg_box_tree *t, size_t n,
                        const struct vg_box *box, struct vg_error *err);

/* slide.c -----------------------------------------------------------------*/

struct vg_slide_edge {
  uint32_t part, v[2];
};

struct vg_slide_work {
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  size_t n_slide;
  const struct vg_slide *slide;
  struct vg_columns *c;
  uint32_t *slide_of; /* [m->n_patch] index into slide[] */
  size_t n_x, cap_x;
  double (*x)[3];  /* [n_x] surface, tops, new points */
  uint32_t *local; /* [surface, tops, curves] scratch, VG_NO_INDEX
                      between uses */
  /* Half-edges 3 * triangle + corner of slide patches, by first point. */
  uint32_t *first, *half; /* [m->n_point + 1], [first[n_point]] */
  /* What is re-meshed: plane patches as a whole, of curved ones the
   * surroundings of the walls, each with its own mean normal. */
  size_t n_part, cap_part;
  struct vg_slide *part;
  uint32_t *part_of;         /* [m->n_tri] VG_NO_INDEX: stays */
  uint32_t *tri_first, *tri; /* [n_part + 1] into tri[]: triangles by part */
  uint32_t *border_first, *border; /* [n_part + 1] into border[]: borders by
                                      part */
  /* Curves between slide patches: edges of the surface that are gone (both
   * points, the lower one in the high half, sorted) and those in their
   * place. */
  size_t n_gone, cap_gone, n_edge, cap_edge;
  uint64_t *gone;
  struct vg_slide_edge *edge;
  /* Triangles of re-meshed patches. */
  size_t n_new, cap_new, cap_new_patch;
  uint32_t (*new_tri)[3], *new_patch;
  /* Failures. */
  uint8_t *bad; /* [n_column] 2: at any height */
  size_t n_bad, cap_path;
  char *text; /* [200] "" until something fails */
  struct vg_error *err;
};

/** The point that column i has in the front: its root, or its top. */
static inline uint32_t vg_slide_top(const struct vg_slide_work *w, uint32_t i)
{
  assert(i < w->c->n_column);

  const struct vg_column *c = &w->c->column[i];

  return c->n ? (uint32_t)(w->m->n_point + i) : c->root;
}

/** The column of which point p is the top, or VG_NO_INDEX. */
static inline uint32_t vg_slide_column(const struct vg_slide_work *w,
                                       uint32_t p)
{
  return p >= w->m->n_point && p - w->m->n_point < w->c->n_column
         ? (uint32_t)(p - w->m->n_point)
         : VG_NO_INDEX;
}

static inline uint64_t vg_slide_key(uint32_t a, uint32_t b)
{
  assert(a != b);
  return vg_edge_key(a, b);
}

/** Append a point; VG_ERR_MEMORY or VG_ERR_UNSUPPORTED. */
vg_status vg_slide_add_point(struct vg_slide_work *w, const double x[3],
                             uint32_t *number);

/** Mark column i as failed (columns without levels cannot be). The first
 * call says why: what, in patch, near x. */
void vg_slide_mark_bad(struct vg_slide_work *w, uint32_t i, uint32_t patch,
                       const double x[3], const char *what);

/** Mark all border columns of part s. */
void vg_slide_mark_bad_all(struct vg_slide_work *w, size_t s, const char *what);

/** The half-edge from b to a (twin of a -> b) in a slide patch, or
 * VG_NO_INDEX. */
uint32_t vg_slide_twin(const struct vg_slide_work *w, uint32_t a, uint32_t b);

/* slide_region.c ----------------------------------------------------------*/

/** Half-edges, parts, and what belongs to each. */
vg_status vg_slide_parts(struct vg_slide_work *w);

/* slide_curve.c -----------------------------------------------------------*/

/** Follow columns that slide in two patches along the patches' common curve:
 * fills gone[] and edge[]; bends columns where the curve is not straight. */
vg_status vg_slide_curves(struct vg_slide_work *w);

/* slide_loop.c ------------------------------------------------------------*/

/* The new boundary of a part, region on its left. */
struct vg_slide_loops {
  size_t n, cap;
  uint32_t (*edge)[2];
};

/** Boundary of part s; empty where columns were marked. */
vg_status vg_slide_boundary(struct vg_slide_work *w, size_t s,
                            struct vg_slide_loops *out);

/* slide_plane.c -----------------------------------------------------------*/

/* A plane's own coordinates. axis >= 0: the other two of space. */
struct vg_slide_frame {
  int axis, iu, iv;
  double at, o[3], u[3], v[3], n[3];
};

void vg_slide_frame(const struct vg_slide_work *w, size_t s,
                    struct vg_slide_frame *f);
void vg_slide_to_plane(const struct vg_slide_frame *f, const double x[3],
                       double p[2]);
void vg_slide_to_space(const struct vg_slide_frame *f, const double p[2],
                       double x[3]);

/** Mark columns at which the boundary crosses itself or enters a flank.
 *
 * @param p      coordinates in the plane, by w->local of the loops' points
 * @param n_bad  out: how many such places; 0: the region is as it should be */
vg_status vg_slide_cross(struct vg_slide_work *w, size_t s,
                         const struct vg_slide_frame *frame,
                         const struct vg_slide_loops *loops,
                         const double (*p)[2], size_t *n_bad);

/* slide_curved.c ----------------------------------------------------------*/

/* The triangles of a curved part over its mean plane. */
struct vg_slide_graph {
  const struct vg_slide_work *w;
  struct vg_slide_frame frame;
  size_t n;
  const uint32_t *tri; /* [n] */
  double (*p)[3][2];   /* [n] */
  double (*height)[3]; /* [n] above the plane */
  struct vg_box_tree tree;
  double extent;
};

/** VG_BLOCKED when the part is no graph over its mean plane. */
vg_status vg_slide_graph(const struct vg_slide_work *w, size_t s,
                         struct vg_slide_graph *g);
void vg_slide_graph_release(struct vg_slide_graph *g);

/** Mark the border columns of part s, which is no graph: for good when it is
 * none even right at their roots, since less height leaves a smaller part. */
void vg_slide_mark_steep(struct vg_slide_work *w, size_t s);

/** The point of the patch over p; beyond its border that nearest to it. */
void vg_slide_lift(const struct vg_slide_graph *g, const double p[2],
                   double x[3]);

/** Bend the border columns of part s onto it, those that follow a curve (bent
 * already) excepted. */
vg_status vg_slide_bend(struct vg_slide_work *w, size_t s,
                        const struct vg_slide_graph *g);

/* slide_size.c ------------------------------------------------------------*/

/* Edge length in a slide patch: the field's, but no finer than the edges
 * between tops, from where it may fall at the field's slope. */
struct vg_slide_law {
  const struct vg_sizing *sizing;
  const struct vg_slide_frame *frame;
  const struct vg_slide_graph *graph; /* NULL: the patch is plane */
  double slope;
  struct {
    double p[2], h;
  } * top;                 /* edges finer than which it would be */
  struct vg_box_tree tree; /* of them, as far as they matter */
};

/** Let tops bound the size from below. */
vg_status vg_slide_law_floor(struct vg_slide_work *w,
                             const struct vg_slide_loops *loops,
                             struct vg_slide_law *l);
void vg_slide_law_release(struct vg_slide_law *l);

/** The point of the patch at p. */
void vg_slide_place(const struct vg_slide_law *l, const double p[2],
                    double x[3]);

/** The size at p; law: the struct vg_slide_law. */
double vg_slide_size(void *law, const double p[2]);

/* slide_plane.c, again ----------------------------------------------------*/

/** Re-mesh part s. */
vg_status vg_slide_remesh(struct vg_slide_work *w, size_t s);

#endif
