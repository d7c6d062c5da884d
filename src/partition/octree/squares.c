/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: edges of faces between subdomains are divided at all ends of edges
 * on their line (where octants of two sizes meet, edges overlap). A segment
 * with two faces in one plane, between the same two subdomains, is inside a
 * patch. The other segments bound patches, and form a curve where they
 * continue straight. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "partition/octree/octree_parts.h"

/* An edge of a square, before and after its division. */
struct edge {
  uint8_t axis;     /* Direction. */
  uint8_t is_right; /* 1: the square is to its right, seen from above. */
  uint32_t line[2]; /* Position along the two following axes. */
  uint32_t from, to;
  uint32_t square;
};

/* Edges first .. end - 1, which differ only in the square. */
struct segment {
  size_t first, end;
  uint32_t corner[2];
};

struct builder {
  const struct vg_octants *t;
  struct vg_patches *p;
  size_t n_square;
  uint32_t *square; /* [n_square] Faces between different ids, by index. */
  uint32_t *up;     /* [n_square] Union-find: patches. */
  size_t n_edge, cap_edge;
  struct edge *edge; /* [n_edge] Divided and sorted. */
  size_t n_segment;
  struct segment *segment; /* [n_segment] That bound patches, sorted. */
  size_t n_end;
  struct end {
    uint32_t at[3], segment;
  } * end; /* [n_end] Ends of segments, by position. */
};

static void builder_release(struct builder *b)
{
  free(b->square);
  free(b->up);
  free(b->edge);
  free(b->segment);
  free(b->end);
}

void vg_patches_release(struct vg_patches *p)
{
  free(p->corner);
  free(p->curve);
  free(p->patch);
  free(p->begin);
  free(p->border);
  memset(p, 0, sizeof *p);
}

static const struct vg_octant_face *face_of(const struct builder *b, size_t s)
{
  return &b->t->face[b->square[s]];
}

static uint32_t id_of(const struct builder *b, size_t s, int above)
{
  return b->t->octant[face_of(b, s)->leaf[above]].id;
}

/* --- edges --------------------------------------------------------------- */

static int order(uint64_t a, uint64_t b)
{
  return (a > b) - (a < b);
}

static int same_line(const struct edge *a, const struct edge *b)
{
  return a->axis == b->axis && a->line[0] == b->line[0] &&
         a->line[1] == b->line[1];
}

static int by_line(const void *p, const void *q)
{
  const struct edge *a = p, *b = q;
  int d = order(a->axis, b->axis);

  if (!d) d = order(a->line[0], b->line[0]);
  if (!d) d = order(a->line[1], b->line[1]);
  if (!d) d = order(a->from, b->from);
  if (!d) d = order(a->to, b->to);
  return d ? d : order(a->square, b->square);
}

static int by_number(const void *p, const void *q)
{
  return order(*(const uint32_t *)p, *(const uint32_t *)q);
}

/* The four edges of a square. Seen from above, u to v is counter-clockwise. */
static void edges_of(const struct vg_octant_face *f, uint32_t square,
                     struct edge out[4])
{
  const int u = (f->axis + 1) % 3, v = (f->axis + 2) % 3;

  for (int i = 0; i < 4; i++) {
    const int along = i < 2 ? u : v, across = i < 2 ? v : u, far = i & 1;
    struct edge *e = &out[i];
    uint32_t at[3];

    memcpy(at, f->at, sizeof at);
    at[across] += far ? f->side : 0;
    *e = (struct edge){ .axis = (uint8_t)along, .square = square };
    e->is_right = (uint8_t)(along == u ? far : !far);
    e->line[0] = at[(along + 1) % 3];
    e->line[1] = at[(along + 2) % 3];
    e->from = at[along];
    e->to = at[along] + f->side;
  }
}

static vg_status list_squares(struct builder *b, struct edge **whole,
                              struct vg_error *err)
{
  const struct vg_octants *t = b->t;
  size_t n = 0;

  for (size_t f = 0; f < t->n_face; f++)
    n += t->octant[t->face[f].leaf[0]].id != t->octant[t->face[f].leaf[1]].id;
  b->square = vg_alloc(n, sizeof *b->square);
  b->up = vg_alloc(n, sizeof *b->up);
  *whole = vg_alloc(n, 4 * sizeof **whole);
  if (!b->square || !b->up || !*whole || n > UINT32_MAX / 4)
    return vg_fail_memory(err, "the faces of subdomains");
  for (size_t f = 0; f < t->n_face; f++) {
    const size_t s = b->n_square;

    if (t->octant[t->face[f].leaf[0]].id == t->octant[t->face[f].leaf[1]].id)
      continue;
    b->square[s] = (uint32_t)f;
    b->up[s] = (uint32_t)s;
    edges_of(&t->face[f], (uint32_t)s, *whole + 4 * s);
    b->n_square++;
  }
  qsort(*whole, 4 * n, sizeof **whole, by_line);
  return VG_OK;
}

/* Divides the edges of one line at all their ends. */
static vg_status divide_line(struct builder *b, size_t n,
                             const struct edge *edge, uint32_t *place,
                             struct vg_error *err)
{
  size_t n_place = 0, n_kept = 1;

  for (size_t i = 0; i < n; i++) {
    place[n_place++] = edge[i].from;
    place[n_place++] = edge[i].to;
  }
  qsort(place, n_place, sizeof *place, by_number);
  for (size_t i = 1; i < n_place; i++)
    if (place[i] != place[n_kept - 1]) place[n_kept++] = place[i];
  for (size_t i = 0, at = 0; i < n; i++) {
    while (place[at] < edge[i].from) at++;
    for (size_t k = at; place[k] < edge[i].to; k++) {
      struct edge *to;

      if (vg_reserve(&b->edge, &b->cap_edge, b->n_edge + 1, sizeof *b->edge))
        return vg_fail_memory(err, "the edges of subdomains");
      to = &b->edge[b->n_edge++];
      *to = edge[i];
      to->from = place[k];
      to->to = place[k + 1];
    }
  }
  return VG_OK;
}

static vg_status divide_edges(struct builder *b, const struct edge *whole,
                              struct vg_error *err)
{
  const size_t n = 4 * b->n_square;
  uint32_t *place = vg_alloc(n, 2 * sizeof *place);
  vg_status st = place ? VG_OK : vg_fail_memory(err, "the edges of subdomains");

  for (size_t i = 0, end; st == VG_OK && i < n; i = end) {
    for (end = i + 1; end < n && same_line(&whole[i], &whole[end]);) end++;
    st = divide_line(b, end - i, whole + i, place, err);
  }
  free(place);
  if (st == VG_OK && b->n_edge)
    qsort(b->edge, b->n_edge, sizeof *b->edge, by_line);
  return st;
}

/* --- segments ------------------------------------------------------------ */

static int is_inside(const struct builder *b, const struct segment *s)
{
  const size_t p = b->edge[s->first].square, q = b->edge[s->end - 1].square;

  return s->end - s->first == 2 && face_of(b, p)->axis == face_of(b, q)->axis &&
         id_of(b, p, 0) == id_of(b, q, 0) && id_of(b, p, 1) == id_of(b, q, 1);
}

static vg_status list_segments(struct builder *b, struct vg_error *err)
{
  b->segment = vg_alloc(b->n_edge, sizeof *b->segment);
  if (!b->segment) return vg_fail_memory(err, "the edges of subdomains");
  for (size_t i = 0, end; i < b->n_edge; i = end) {
    struct segment s = { .first = i };

    for (end = i + 1; end < b->n_edge &&
                      same_line(&b->edge[i], &b->edge[end]) &&
                      b->edge[i].from == b->edge[end].from;)
      end++;
    s.end = end;
    if (is_inside(b, &s))
      vg_union(b->up, b->edge[i].square, b->edge[end - 1].square);
    else b->segment[b->n_segment++] = s;
  }
  return VG_OK;
}

static int by_end(const void *p, const void *q)
{
  const struct end *a = p, *b = q;
  int d = 0;

  for (int k = 0; k < 3 && !d; k++) d = order(a->at[k], b->at[k]);
  return d ? d : order(a->segment, b->segment);
}

static void place_of(const struct edge *e, int far, uint32_t at[3])
{
  at[e->axis] = far ? e->to : e->from;
  at[(e->axis + 1) % 3] = e->line[0];
  at[(e->axis + 2) % 3] = e->line[1];
}

static int goes_on(const struct builder *b, size_t i)
{
  const struct edge *e = &b->edge[b->segment[i].first];
  const struct edge *next = i + 1 < b->n_segment
                            ? &b->edge[b->segment[i + 1].first]
                            : NULL;

  return next && same_line(e, next) && e->to == next->from;
}

/* Lists the corners: ends of segments, except the middle of a straight run of
 * two segments. Sets the corners of the segments, or VG_OCTANT_NONE. */
static vg_status list_corners(struct builder *b, struct vg_error *err)
{
  struct vg_patches *p = b->p;

  b->end = vg_alloc(2 * b->n_segment, sizeof *b->end);
  p->corner = vg_alloc(2 * b->n_segment, sizeof *p->corner);
  if (!b->end || !p->corner)
    return vg_fail_memory(err, "the edges of subdomains");
  for (size_t i = 0; i < b->n_segment; i++)
    for (int far = 0; far < 2; far++) {
      struct end *e = &b->end[b->n_end++];

      place_of(&b->edge[b->segment[i].first], far, e->at);
      e->segment = (uint32_t)(2 * i) + (uint32_t)far;
    }
  if (b->n_end) qsort(b->end, b->n_end, sizeof *b->end, by_end);
  for (size_t i = 0, end; i < b->n_end; i = end) {
    const struct end *e = &b->end[i];
    uint32_t number = (uint32_t)p->n_corner;

    for (end = i + 1;
         end < b->n_end && !memcmp(e->at, b->end[end].at, sizeof e->at);)
      end++;
    if (end - i == 2 && e->segment / 2 + 1 == b->end[i + 1].segment / 2 &&
        goes_on(b, e->segment / 2) && (e->segment & 1) &&
        !(b->end[i + 1].segment & 1))
      number = VG_OCTANT_NONE;
    else memcpy(p->corner[p->n_corner++], e->at, sizeof *p->corner);
    for (size_t k = i; k < end; k++)
      b->segment[b->end[k].segment / 2].corner[b->end[k].segment & 1] = number;
  }
  return VG_OK;
}

/* --- patches and their borders ------------------------------------------- */

/* number out: [n_square] index of the patch, at roots. */
static vg_status list_patches(struct builder *b, uint32_t *number,
                              struct vg_error *err)
{
  struct vg_patches *p = b->p;

  p->patch = vg_alloc(b->n_square, sizeof *p->patch);
  if (!p->patch) return vg_fail_memory(err, "the faces of subdomains");
  for (uint32_t s = 0; s < b->n_square; s++) {
    const struct vg_octant_face *f = face_of(b, s);

    if (vg_root_of(b->up, s) != s) continue;
    number[s] = (uint32_t)p->n;
    p->patch[p->n++] = (struct vg_plane_patch){
      f->axis, f->at[f->axis], { id_of(b, s, 0), id_of(b, s, 1) }
    };
  }
  p->begin = vg_calloc(p->n + 2, sizeof *p->begin);
  return p->begin ? VG_OK : vg_fail_memory(err, "the faces of subdomains");
}

/* Makes each curve from its first segment; the adjacent patches stay the same
 * along it. */
static void list_curves(struct builder *b)
{
  struct vg_patches *p = b->p;

  for (size_t i = 0; i < b->n_segment; i++) {
    const struct segment *s = &b->segment[i];

    if (s->corner[0] != VG_OCTANT_NONE) {
      b->segment[p->n_curve].first = s->first; /* of segments that start a
                                                  curve */
      b->segment[p->n_curve].end = s->end;
      p->curve[p->n_curve++] = (struct vg_patch_curve){
        b->edge[s->first].axis, { s->corner[0], s->corner[1] }
      };
    } else {
      p->curve[p->n_curve - 1].end[1] = s->corner[1];
    }
  }
}

static vg_status list_borders(struct builder *b, const uint32_t *number,
                              struct vg_error *err)
{
  struct vg_patches *p = b->p;

  p->curve = vg_alloc(b->n_segment, sizeof *p->curve);
  if (!p->curve) return vg_fail_memory(err, "the edges of subdomains");
  list_curves(b);
  for (int fill = 0; fill < 2; fill++) {
    for (size_t i = 0; i < p->n_curve; i++)
      for (size_t e = b->segment[i].first; e < b->segment[i].end; e++) {
        const struct edge *at = &b->edge[e];
        const uint32_t k = number[vg_root_of(b->up, at->square)];

        if (fill)
          p->border[p->begin[k + 1]++] = (uint32_t)(2 * i) + at->is_right;
        else p->begin[k + 2]++;
      }
    if (fill) break;
    for (size_t k = 2; k < p->n + 2; k++) p->begin[k] += p->begin[k - 1];
    p->border = vg_alloc(p->begin[p->n + 1], sizeof *p->border);
    if (!p->border) return vg_fail_memory(err, "the edges of subdomains");
  }
  return VG_OK;
}

vg_status vg_patches_make(const struct vg_octants *t, struct vg_patches *p,
                          struct vg_error *err)
{
  struct builder b = { .t = t, .p = p };
  struct edge *whole = NULL;
  uint32_t *number = NULL;
  vg_status st;

  assert(t->octant && p);
  memset(p, 0, sizeof *p);
  VG_TRY(list_squares(&b, &whole, err));
  VG_TRY(divide_edges(&b, whole, err));
  VG_TRY(list_segments(&b, err));
  VG_TRY(list_corners(&b, err));
  number = vg_alloc(b.n_square, sizeof *number);
  if (!number) {
    st = vg_fail_memory(err, "the faces of subdomains");
    goto done;
  }
  VG_TRY(list_patches(&b, number, err));
  VG_TRY(list_borders(&b, number, err));
done:
  builder_release(&b);
  free(whole);
  free(number);
  return st;
}
