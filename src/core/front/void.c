#include "core/front/void.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"

enum { PORTION = 1 << 16 };  /* items read at a time */

static const char magic[8] = {'V', 'G', 'V', 'O', 'I', 'D', '1', '\n'};

void vg_void_release(struct vg_void *v)
{
  free(v->x);
  free(v->face);
  free(v->cell);
  memset(v, 0, sizeof *v);
}

static int allocate(struct vg_void *v, size_t np, size_t nf, size_t nc)
{
  if (vg_reserve(&v->x, &v->cap_point, np, sizeof *v->x) ||
      vg_reserve(&v->face, &v->cap_face, nf, sizeof *v->face) ||
      vg_reserve(&v->cell, &v->cap_cell, nc, sizeof *v->cell)) {
    vg_void_release(v);
    return -1;
  }
  v->n_point = np;
  v->n_face = nf;
  v->n_cell = nc;
  return 0;
}

vg_status vg_void_from_mesh(struct vg_void *v, const struct vg_mesh *m,
                            struct vg_error *err)
{
  if (m->n_quad)
    return vg_fail(err, VG_ERR_INPUT, "the surface has %zu quadrilaterals; "
                   "split them into triangles", m->n_quad);
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT, "triangle %zu refers to point %u "
                       "of %zu", i + 1, m->tri[i][k] + 1, m->n_point);
  if (allocate(v, m->n_point, m->n_tri, 0))
    return vg_fail_memory(err, "the front");
  if (m->n_point) memcpy(v->x, m->point, m->n_point * sizeof *v->x);
  if (m->n_tri) memcpy(v->face, m->tri, m->n_tri * sizeof *v->face);
  return VG_OK;
}

size_t vg_void_defects(const struct vg_void *v)
{
  struct vg_key *edge = vg_alloc(3 * v->n_face, sizeof *edge);
  size_t bad = 0, n = 0;

  if (!edge) return SIZE_MAX;
  for (size_t i = 0; i < v->n_face; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = v->face[i][k], b = v->face[i][(k + 1) % 3];

      edge[n].key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
      edge[n++].index = a < b;
    }
  if (vg_sort_keys(n, edge, NULL)) bad = SIZE_MAX;
  for (size_t i = 0, j; bad != SIZE_MAX && i < n; i = j) {
    long balance = 0;

    for (j = i; j < n && edge[j].key == edge[i].key; j++)
      balance += edge[j].index ? 1 : -1;
    bad += balance != 0;
  }
  for (size_t c = 0; c < v->n_cell && bad != SIZE_MAX; c++) {
    const uint32_t *t = v->cell[c];

    bad += !(vg_orient3d(v->x[t[0]], v->x[t[1]], v->x[t[2]], v->x[t[3]]) > 0);
  }
  free(edge);
  return bad;
}

static int put(FILE *to, const void *from, size_t n, size_t size)
{
  return n && fwrite(from, size, n, to) != n;
}

vg_status vg_void_save(const struct vg_void *v, FILE *to,
                       struct vg_error *err)
{
  uint64_t count[3] = {v->n_point, v->n_face, v->n_cell};

  if (put(to, magic, 1, sizeof magic) || put(to, count, 3, sizeof *count) ||
      put(to, v->x, v->n_point, sizeof *v->x) ||
      put(to, v->face, v->n_face, sizeof *v->face) ||
      put(to, v->cell, v->n_cell, sizeof *v->cell) || fflush(to))
    return vg_fail(err, VG_ERR_IO, "the state of the front could not be "
                   "written; is the disk full?");
  return VG_OK;
}

/* Read n items into *block. In portions, so that a count that lies asks for no
 * more memory than there is data. Returns 0, 1: no data, -1: no memory. */
static int get(FILE *from, void *block, size_t *cap, size_t n, size_t size)
{
  char *at;

  for (size_t have = 0, more; have < n; have += more) {
    more = n - have < PORTION ? n - have : PORTION;
    if (vg_reserve(block, cap, have + more, size)) return -1;
    memcpy(&at, block, sizeof at);
    if (fread(at + have * size, size, more, from) != more) return 1;
  }
  return 0;
}

static int content_is_good(const struct vg_void *v)
{
  for (size_t p = 0; p < v->n_point; p++)
    for (int k = 0; k < 3; k++)
      if (!isfinite(v->x[p][k])) return 0;
  for (size_t i = 0; i < v->n_face; i++)
    for (int k = 0; k < 3; k++)
      if (v->face[i][k] >= v->n_point) return 0;
  for (size_t c = 0; c < v->n_cell; c++)
    for (int k = 0; k < 4; k++)
      if (v->cell[c][k] >= v->n_point) return 0;
  return 1;
}

vg_status vg_void_load(struct vg_void *v, FILE *from, struct vg_error *err)
{
  char head[sizeof magic];
  uint64_t count[3];
  int bad;

  if (fread(head, sizeof head, 1, from) != 1 ||
      memcmp(head, magic, sizeof head) ||
      fread(count, sizeof count, 1, from) != 1)
    return vg_fail(err, VG_ERR_FORMAT, "not the state of a front");
  if (count[0] > UINT32_MAX || count[1] > UINT32_MAX || count[2] > UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT, "the state of the front has "
                   "impossible counts");
  bad = get(from, &v->x, &v->cap_point, count[0], sizeof *v->x);
  if (!bad) bad = get(from, &v->face, &v->cap_face, count[1], sizeof *v->face);
  if (!bad) bad = get(from, &v->cell, &v->cap_cell, count[2], sizeof *v->cell);
  v->n_point = count[0];
  v->n_face = count[1];
  v->n_cell = count[2];
  if (!bad && content_is_good(v)) return VG_OK;
  vg_void_release(v);
  if (bad < 0) return vg_fail_memory(err, "the front");
  return vg_fail(err, VG_ERR_FORMAT, "the state of the front is damaged");
}
