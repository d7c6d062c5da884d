/* Layers as bytes and back: counts, then the arrays one after the other. */
#include "layers/columns/pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"

#define MAGIC 0x317379616c677676ull

struct head {
  uint64_t magic, n_column, n_face, n_border, n_law, n_path;
  uint64_t n_point, n_tri, n_patch;    /* of the front */
};

struct array {
  void **at;
  size_t n, size;
};

#define N_ARRAY 14

/* All arrays of layers whose counts are set. */
static void list_arrays(struct vg_layers *l, struct array a[N_ARRAY])
{
  struct vg_columns *c = &l->columns;
  struct vg_mesh *m = &l->front.mesh;
  const struct array list[N_ARRAY] = {
    { (void **)&c->column, c->n_column, sizeof *c->column },
    { (void **)&c->face, c->n_face, sizeof *c->face },
    { (void **)&c->face_tri, c->n_face, sizeof *c->face_tri },
    { (void **)&c->border, c->n_border, sizeof *c->border },
    { (void **)&c->border_patch, c->n_border, sizeof *c->border_patch },
    { (void **)&c->law, c->n_law, sizeof *c->law },
    { (void **)&c->path, c->n_path, sizeof *c->path },
    { (void **)&m->point, m->n_point, sizeof *m->point },
    { (void **)&m->tri, m->n_tri, sizeof *m->tri },
    { (void **)&m->tri_patch, m->n_tri, sizeof *m->tri_patch },
    { (void **)&m->patch, m->n_patch, sizeof *m->patch },
    { (void **)&l->front.column, m->n_point, sizeof *l->front.column },
    { (void **)&l->front.point, m->n_point, sizeof *l->front.point },
    { (void **)&l->front.face, m->n_tri, sizeof *l->front.face }
  };

  memcpy(a, list, sizeof list);
}

vg_status vg_layers_pack(const struct vg_layers *layers, struct vg_bytes *out,
                         struct vg_error *err)
{
  const struct vg_columns *c = &layers->columns;
  const struct vg_mesh *m = &layers->front.mesh;
  struct vg_layers view = *layers;
  struct head h = { MAGIC, c->n_column, c->n_face, c->n_border, c->n_law,
                    c->n_path, m->n_point, m->n_tri, m->n_patch };
  struct vg_writer w = { { 0, NULL }, 0, 0 };
  struct array a[N_ARRAY];
  size_t n = sizeof h;

  list_arrays(&view, a);
  for (int i = 0; i < N_ARRAY; i++) n += a[i].n * a[i].size;
  w.refused = vg_reserve(&w.bytes.data, &w.cap, n, 1) != 0;
  vg_put(&w, 1, sizeof h, &h);
  for (int i = 0; i < N_ARRAY; i++) vg_put(&w, a[i].n, a[i].size, *a[i].at);
  if (w.refused) {
    free(w.bytes.data);
    return vg_fail_memory(err, "the layers as bytes");
  }
  *out = w.bytes;
  return VG_OK;
}

void vg_layers_show(const struct vg_layers *layers,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user)
{
  struct vg_layers view = *layers;
  struct array a[N_ARRAY];

  list_arrays(&view, a);
  for (int i = 0; i < N_ARRAY; i++)
    if (a[i].at != (void **)&view.front.mesh.patch)
      look(user, a[i].n * a[i].size, *a[i].at);
}

/* --- checks: 1 for good -------------------------------------------------- */

static int is_index(uint32_t i, size_t n)
{
  return i < n || i == VG_NO_INDEX;
}

static int are_finite(const double (*x)[3], size_t n)
{
  int good = 1;

  for (size_t i = 0; i < n; i++)
    good &= isfinite(x[i][0]) && isfinite(x[i][1]) && isfinite(x[i][2]);
  return good;
}

static int is_law(const struct vg_law *l)
{
  return isfinite(l->delta1) && l->delta1 > 0 && l->rate1 >= 0 &&
         l->rate2 >= 0 && l->cap >= 1;
}

/* Laws of patches without layers are never used, and may be anything. */
static int is_column(const struct vg_columns *c, const struct vg_column *v,
                     const struct vg_mesh *surface)
{
  const double x[2][3] = { { v->dir[0], v->dir[1], v->dir[2] },
                           { v->shift[0], v->shift[1], v->shift[2] } };

  return v->root < surface->n_point && v->law < c->n_law &&
         is_law(&c->law[v->law]) &&
         is_index(v->slide[0], surface->n_patch) &&
         is_index(v->slide[1], surface->n_patch) &&
         v->n <= VG_LEVELS_MAX && v->n_wanted <= VG_LEVELS_MAX &&
         v->cause < VG_CAUSE_N && v->squeezed < VG_CAUSE_N &&
         (v->bent == SIZE_MAX ||
          (v->bent < c->n_path && v->n < c->n_path - v->bent)) &&
         are_finite(x, 2) && !isnan(v->cap);
}

static int are_columns(const struct vg_columns *c,
                       const struct vg_mesh *surface)
{
  int good = are_finite((const double (*)[3])c->path, c->n_path);

  for (size_t i = 0; i < c->n_column; i++)
    good &= is_column(c, &c->column[i], surface) &&
            (!i || c->column[i - 1].root <= c->column[i].root);
  for (size_t i = 0; i < c->n_face; i++) {
    for (int k = 0; k < 3; k++) good &= c->face[i][k] < c->n_column;
    good &= is_index(c->face_tri[i], surface->n_tri);
  }
  for (size_t i = 0; i < c->n_border; i++)
    good &= c->border[i][0] < c->n_column && c->border[i][1] < c->n_column &&
            c->border_patch[i] < surface->n_patch;
  return good;
}

static int is_front(const struct vg_layers *l, const struct vg_mesh *surface)
{
  const struct vg_layer_front *f = &l->front;
  const struct vg_mesh *m = &f->mesh;
  int good = are_finite((const double (*)[3])m->point, m->n_point);

  for (size_t i = 0; i < m->n_point; i++)
    good &= is_index(f->column[i], l->columns.n_column) &&
            is_index(f->point[i], surface->n_point);
  for (size_t i = 0; i < m->n_tri; i++) {
    for (int k = 0; k < 3; k++) good &= m->tri[i][k] < m->n_point;
    good &= m->tri_patch[i] < m->n_patch &&
            is_index(f->face[i], l->columns.n_face);
  }
  for (size_t i = 0; i < m->n_patch; i++)
    good &= memchr(m->patch[i].name, 0, VG_NAME_MAX) != NULL;
  return good && m->n_patch == surface->n_patch;
}

/* --- reading ------------------------------------------------------------- */

/* Counts are held against the bytes before anything is allocated. */
static vg_status read_arrays(struct vg_reader *r, struct vg_layers *l,
                             struct vg_error *err)
{
  struct array a[N_ARRAY];
  size_t left = r->n - r->at;

  list_arrays(l, a);
  for (int i = 0; i < N_ARRAY; i++) {
    if (a[i].n > left / a[i].size) return VG_ERR_FORMAT;
    left -= a[i].n * a[i].size;
  }
  if (left) return VG_ERR_FORMAT;
  for (int i = 0; i < N_ARRAY; i++)
    if (!(*a[i].at = vg_get_array(r, a[i].n, a[i].size)))
      return vg_fail_memory(err, "the layers");
  return VG_OK;
}

vg_status vg_layers_unpack(const struct vg_bytes *bytes,
                           const struct vg_mesh *surface,
                           struct vg_layers *out, struct vg_error *err)
{
  struct vg_reader r = { bytes->data, bytes->n, 0, 0 };
  struct vg_layers l = VG_LAYERS_INIT;
  struct head h = { 0 };
  vg_status st = VG_ERR_FORMAT;

  vg_get(&r, 1, sizeof h, &h);
  if (!r.bad && h.magic == MAGIC) {
    l.columns.n_column = h.n_column;
    l.columns.n_face = h.n_face;
    l.columns.n_border = h.n_border;
    l.columns.n_law = h.n_law;
    l.columns.n_path = h.n_path;
    l.front.mesh.n_point = h.n_point;
    l.front.mesh.n_tri = h.n_tri;
    l.front.mesh.n_patch = h.n_patch;
    st = read_arrays(&r, &l, err);
  }
  if (st >= 0 && (!are_columns(&l.columns, surface) ||
                  !is_front(&l, surface)))
    st = VG_ERR_FORMAT;
  if (st >= 0) {
    *out = l;
    return st;
  }
  vg_layers_release(&l);
  if (st != VG_ERR_FORMAT) return st;
  return vg_fail(err, st, "%zu bytes are no layers of this surface, or "
                 "damaged ones; run again", bytes->n);
}
