/* Layers and field put together: which point is which, and the boundary. The
 * layers themselves come from expand.h. */
#include "layers/join.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "layers/expand.h"

#define GRAIN 65536

struct join {
  const struct vg_mesh *surface, *field;
  const struct vg_columns *columns;
  const struct vg_layer_front *front;
  struct vg_expand expand;
  struct vg_mesh *m;
  uint32_t *root;          /* [surface->n_point] point of the mesh, or
                              VG_NO_INDEX */
  uint32_t *top;           /* [n_column] point of the mesh */
  uint32_t *id;            /* [front n_point] point of the mesh */
  size_t n_surface, n_new; /* points of the surface, of re-meshed patches */
  size_t first_field, n_field;
  uint8_t *stays;          /* [surface->n_tri] */
  uint8_t *changed;        /* [n_patch] re-meshed */
  size_t *rim_tri, *rim_quad;  /* [n_rim] where their faces go */
};

static double now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static vg_status check(const struct join *j, struct vg_error *err)
{
  const struct vg_mesh *f = &j->front->mesh;

  if (j->field->n_point >= f->n_point && j->field->n_tri == f->n_tri &&
      !j->field->n_pyr && !j->field->n_pri && !j->field->n_hex)
    return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "the field (%zu points, %zu boundary triangles) does not "
                 "fill the front of the layers (%zu points, %zu triangles)",
                 j->field->n_point, j->field->n_tri, f->n_point, f->n_tri);
}

static vg_status reserve(struct join *j, struct vg_error *err)
{
  j->root = vg_alloc(j->surface->n_point, sizeof *j->root);
  j->top = vg_alloc(j->columns->n_column, sizeof *j->top);
  j->id = vg_alloc(j->front->mesh.n_point, sizeof *j->id);
  j->stays = vg_calloc(j->surface->n_tri, 1);
  j->changed = vg_calloc(j->surface->n_patch, 1);
  j->rim_tri = vg_calloc(j->columns->n_rim, sizeof *j->rim_tri);
  j->rim_quad = vg_calloc(j->columns->n_rim, sizeof *j->rim_quad);
  if (j->root && j->top && j->id && j->stays && j->changed && j->rim_tri &&
      j->rim_quad)
    return VG_OK;
  return vg_fail_memory(err, "joining layers and field");
}

static void release(struct join *j)
{
  vg_expand_close(&j->expand);
  free(j->root);
  free(j->top);
  free(j->id);
  free(j->stays);
  free(j->changed);
  free(j->rim_tri);
  free(j->rim_quad);
}

/* Number the points of the surface in use: roots, and what the front has. */
static void number_surface(struct join *j)
{
  const struct vg_layer_front *f = j->front;

  memset(j->root, 0xff, j->surface->n_point * sizeof *j->root);
  for (size_t i = 0; i < j->columns->n_column; i++)
    j->root[j->columns->column[i].root] = 0;
  for (size_t i = 0; i < f->mesh.n_point; i++)
    if (f->column[i] != VG_NO_INDEX) continue;
    else if (f->point[i] != VG_NO_INDEX) j->root[f->point[i]] = 0;
    else j->n_new++;
  for (size_t i = 0; i < j->surface->n_point; i++)
    if (j->root[i] != VG_NO_INDEX) j->root[i] = (uint32_t)j->n_surface++;
}

static vg_status number_points(struct join *j, struct vg_error *err)
{
  struct vg_expand *e = &j->expand;
  size_t flank, inner;

  number_surface(j);
  flank = j->n_surface + e->n_point[VG_FLANK];
  inner = flank + j->n_new;
  j->first_field = inner + e->n_point[VG_INNER];
  j->n_field = j->field->n_point - j->front->mesh.n_point;
  if (j->first_field + j->n_field > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh would have %zu points, %zu of them in the "
                   "layers; at most %u can be numbered: ask for fewer layers "
                   "or a coarser surface", j->first_field + j->n_field,
                   e->n_point[VG_FLANK] + e->n_point[VG_INNER], UINT32_MAX);
  vg_expand_place(e, VG_FLANK, j->n_surface);
  vg_expand_place(e, VG_INNER, inner);
  return VG_OK;
}

/* Places of all points, and the numbers of the front's. */
static vg_status place_points(struct join *j, struct vg_error *err)
{
  const struct vg_layer_front *f = j->front;
  struct vg_mesh *m = j->m;
  size_t next = j->n_surface + j->expand.n_point[VG_FLANK];

  m->n_point = j->first_field + j->n_field;
  m->point = vg_alloc(m->n_point, sizeof *m->point);
  if (!m->point) return vg_fail_memory(err, "the points of the mesh");
  for (size_t i = 0; i < j->surface->n_point; i++)
    if (j->root[i] != VG_NO_INDEX)
      memcpy(m->point[j->root[i]], j->surface->point[i], sizeof *m->point);
  vg_expand_points(&j->expand, j->surface, j->root, m->point, j->top);
  for (size_t i = 0; i < f->mesh.n_point; i++)
    if (f->column[i] != VG_NO_INDEX) j->id[i] = j->top[f->column[i]];
    else if (f->point[i] != VG_NO_INDEX) j->id[i] = j->root[f->point[i]];
    else {
      memcpy(m->point[next], f->mesh.point[i], sizeof *m->point);
      j->id[i] = (uint32_t)next++;
    }
  if (j->n_field)
    memcpy(m->point[j->first_field], j->field->point[f->mesh.n_point],
           j->n_field * sizeof *m->point);
  return VG_OK;
}

/* Is front triangle f, point for point, triangle s of the surface? */
static int same_tri(const struct join *j, size_t f, size_t s)
{
  for (int k = 0; k < 3; k++) {
    uint32_t p = j->front->mesh.tri[f][k];

    if (j->front->column[p] != VG_NO_INDEX ||
        j->front->point[p] != j->surface->tri[s][k])
      return 0;
  }
  return 1;
}

/* A patch off the walls stays when the front has the same triangles of it in
 * the same order; a wall stays, also where no column rises.
 * at: [n_patch + 1]; list: [surface->n_tri] its triangles, by patch. */
static void compare_patches(struct join *j, const uint8_t *is_wall, size_t *at,
                            uint32_t *list)
{
  const struct vg_mesh *s = j->surface, *f = &j->front->mesh;
  size_t sum = 0;

  for (size_t i = 0; i < s->n_tri; i++)
    if (!j->stays[i]) at[s->tri_patch[i]]++;
  for (size_t q = 0; q <= s->n_patch; q++) {
    size_t here = at[q];

    at[q] = sum;
    sum += here;
  }
  for (size_t i = 0; i < s->n_tri; i++)
    if (!j->stays[i]) list[at[s->tri_patch[i]]++] = (uint32_t)i;
  for (size_t q = s->n_patch; q; q--) at[q] = at[q - 1];
  at[0] = 0;
  for (size_t i = 0; i < f->n_tri; i++) {
    uint32_t q = f->tri_patch[i];

    if (j->front->face[i] != VG_NO_INDEX || is_wall[q]) continue;
    if (at[q] < sum && s->tri_patch[list[at[q]]] == q &&
        same_tri(j, i, list[at[q]]))
      at[q]++;
    else j->changed[q] = 1;
  }
  for (size_t i = 0; i < sum; i++) {
    uint32_t q = s->tri_patch[list[i]];

    if (i >= at[q]) j->changed[q] = 1;
  }
}

static vg_status find_changes(struct join *j, struct vg_error *err)
{
  const struct vg_mesh *s = j->surface;
  size_t *at = vg_calloc(s->n_patch + 1, sizeof *at);
  uint32_t *list = vg_alloc(s->n_tri, sizeof *list);
  uint8_t *is_wall = vg_calloc(s->n_patch, 1);
  vg_status st = VG_OK;

  for (size_t i = 0; is_wall && i < j->columns->n_face; i++) {
    uint32_t tri = j->columns->face_tri[i];

    if (tri == VG_NO_INDEX) continue;
    j->stays[tri] = 1;
    is_wall[s->tri_patch[tri]] = 1;
  }
  if (at && list && is_wall) {
    compare_patches(j, is_wall, at, list);
    for (size_t i = 0; i < s->n_tri; i++)
      if (!j->changed[s->tri_patch[i]]) j->stays[i] = 1;
  } else st = vg_fail_memory(err, "the boundary of the mesh");
  free(at);
  free(list);
  free(is_wall);
  return st;
}

static vg_status reserve_boundary(struct vg_mesh *m, struct vg_error *err)
{
  m->tri = vg_alloc(m->n_tri, sizeof *m->tri);
  m->tri_patch = vg_alloc(m->n_tri, sizeof *m->tri_patch);
  if (m->n_quad) {
    m->quad = vg_alloc(m->n_quad, sizeof *m->quad);
    m->quad_patch = vg_alloc(m->n_quad, sizeof *m->quad_patch);
  }
  if (m->tri && m->tri_patch &&
      (!m->n_quad || (m->quad && m->quad_patch)))
    return VG_OK;
  return vg_fail_memory(err, "the boundary of the mesh");
}

/* Is triangle i of the front boundary of the mesh, and none of the surface? */
static int is_new(const struct join *j, size_t i)
{
  return j->front->face[i] == VG_NO_INDEX &&
         j->changed[j->front->mesh.tri_patch[i]];
}

/* Counts faces by patch, then turns them into where each patch begins. */
static void count_boundary(struct join *j, size_t *tri, size_t *quad)
{
  const struct vg_columns *c = j->columns;
  size_t n_patch = j->surface->n_patch, n_tri = 0, n_quad = 0;

  for (size_t r = 0; r < c->n_rim; r++) {
    vg_expand_flank(&j->expand, r, &j->rim_tri[r], &j->rim_quad[r]);
    tri[c->rim_patch[r]] += j->rim_tri[r];
    quad[c->rim_patch[r]] += j->rim_quad[r];
  }
  for (size_t i = 0; i < j->front->mesh.n_tri; i++)
    if (is_new(j, i)) tri[j->front->mesh.tri_patch[i]]++;
  for (size_t i = 0; i < j->surface->n_tri; i++) n_tri += j->stays[i];
  for (size_t q = 0; q < n_patch; q++) {
    size_t here = tri[q];

    tri[q] = n_tri;
    n_tri += here;
    here = quad[q];
    quad[q] = n_quad;
    n_quad += here;
  }
  j->m->n_tri = n_tri;
  j->m->n_quad = n_quad;
}

/* All of the boundary but the nodes of flanks, for which rim_tri and rim_quad
 * then say where they go. tri, quad: where each patch begins. */
static void fill_boundary(struct join *j, size_t *tri, size_t *quad)
{
  const struct vg_columns *c = j->columns;
  const struct vg_mesh *s = j->surface, *f = &j->front->mesh;
  struct vg_mesh *m = j->m;
  size_t at = 0;

  for (size_t i = 0; i < s->n_tri; i++)
    if (j->stays[i]) {
      for (int k = 0; k < 3; k++) m->tri[at][k] = j->root[s->tri[i][k]];
      m->tri_patch[at++] = s->tri_patch[i];
    }
  for (size_t r = 0; r < c->n_rim; r++) {
    uint32_t q = c->rim_patch[r];
    size_t n_tri = j->rim_tri[r], n_quad = j->rim_quad[r];

    j->rim_tri[r] = tri[q];
    j->rim_quad[r] = quad[q];
    while (n_tri--) m->tri_patch[tri[q]++] = q;
    while (n_quad--) m->quad_patch[quad[q]++] = q;
  }
  for (size_t i = 0; i < f->n_tri; i++)
    if (is_new(j, i)) {
      size_t to = tri[f->tri_patch[i]]++;

      for (int k = 0; k < 3; k++) m->tri[to][k] = j->id[f->tri[i][k]];
      m->tri_patch[to] = f->tri_patch[i];
    }
}

static vg_status make_boundary(struct join *j, struct vg_error *err)
{
  size_t n = j->surface->n_patch;
  size_t *tri = vg_calloc(n, sizeof *tri), *quad = vg_calloc(n, sizeof *quad);
  vg_status st = VG_OK;

  if (!tri || !quad) {
    st = vg_fail_memory(err, "the boundary of the mesh");
    goto done;
  }
  VG_TRY(find_changes(j, err));
  count_boundary(j, tri, quad);
  VG_TRY(reserve_boundary(j->m, err));
  fill_boundary(j, tri, quad);
done:
  free(tri);
  free(quad);
  return st;
}

static void fill_field(void *context, size_t first, size_t end, int worker)
{
  const struct join *j = context;
  size_t n_front = j->front->mesh.n_point;
  uint32_t (*tet)[4] = j->m->tet + j->expand.n_cell[VG_KIND_TET];

  (void)worker;
  for (size_t i = first; i < end; i++)
    for (int k = 0; k < 4; k++) {
      uint32_t p = j->field->tet[i][k];

      tet[i][k] = p < n_front ? j->id[p]
                              : (uint32_t)(j->first_field + (p - n_front));
    }
}

static vg_status make_cells(struct join *j, struct vg_error *err)
{
  struct vg_expand *e = &j->expand;
  struct vg_mesh *m = j->m;
  vg_status st = vg_expand_count(e, j->root, err);

  if (st < 0) return st;
  m->n_tet = e->n_cell[VG_KIND_TET] + j->field->n_tet;
  m->n_pyr = e->n_cell[VG_KIND_PYR];
  m->n_pri = e->n_cell[VG_KIND_PRI];
  m->tet = vg_alloc(m->n_tet, sizeof *m->tet);
  if (m->n_pyr) m->pyr = vg_alloc(m->n_pyr, sizeof *m->pyr);
  if (m->n_pri) m->pri = vg_alloc(m->n_pri, sizeof *m->pri);
  if (!m->tet || (m->n_pyr && !m->pyr) || (m->n_pri && !m->pri))
    return vg_fail_memory(err, "the cells of the mesh");
  st = vg_expand_cells(e, j->root, m, j->rim_tri, j->rim_quad, err);
  if (st == VG_OK)
    vg_parallel_for(e->threads, j->field->n_tet, GRAIN, fill_field, j);
  return st;
}

static vg_status copy_patches(struct join *j, struct vg_error *err)
{
  size_t n = j->surface->n_patch;

  if (!n) return VG_OK;
  j->m->patch = vg_alloc(n, sizeof *j->m->patch);
  if (!j->m->patch) return vg_fail_memory(err, "the patches of the mesh");
  memcpy(j->m->patch, j->surface->patch, n * sizeof *j->m->patch);
  j->m->n_patch = n;
  return VG_OK;
}

static void describe(const struct join *j, double time,
                     struct vg_join_info *info)
{
  const struct vg_expand *e = &j->expand;

  if (!info) return;
  info->n_boundary_point = j->n_surface + e->n_point[VG_FLANK] + j->n_new;
  info->n_layer_point = j->first_field;
  info->n_layer_tet = e->n_cell[VG_KIND_TET];
  info->n_layer_pyr = e->n_cell[VG_KIND_PYR];
  info->n_layer_pri = e->n_cell[VG_KIND_PRI];
  info->time = time;
}

vg_status vg_layers_join(const struct vg_mesh *surface,
                         const struct vg_layers *layers,
                         const struct vg_mesh *field,
                         enum vg_layer_cells cells, int threads,
                         struct vg_mesh *out, struct vg_join_info *info,
                         struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct join j = { .surface = surface, .field = field,
                    .columns = &layers->columns, .front = &layers->front,
                    .m = &m };
  double start = now();
  vg_status st;

  VG_TRY(check(&j, err));
  VG_TRY(reserve(&j, err));
  VG_TRY(vg_expand_open(&j.expand, j.columns, cells == VG_LAYER_MIXED,
                        threads, err));
  VG_TRY(number_points(&j, err));
  VG_TRY(place_points(&j, err));
  VG_TRY(make_boundary(&j, err));
  VG_TRY(make_cells(&j, err));
  VG_TRY(copy_patches(&j, err));
  vg_mesh_move(out, &m);
  describe(&j, now() - start, info);
done:
  vg_mesh_release(&m);
  release(&j);
  return st;
}
