/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/stages/agree.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "layers/columns/share.h"
#include "partition/store/store.h"

/* Digests of the data of a rank; equal data give equal bytes. */
struct claim {
  uint64_t counts; /* 1: the first rank of its node. */
  struct vg_digest of[VG_AGREE_N];
  char host[64];
};

const char *vg_agree_name(enum vg_agree what)
{
  static const char *const name[VG_AGREE_N] = { "surface", "layers", "sizes" };

  return (unsigned)what < VG_AGREE_N ? name[what] : NULL;
}

static void add(void *user, size_t n, const void *data)
{
  struct vg_digest *d = user;

  *d = vg_digest_of(*d, n, data);
}

/* Names of patches are omitted, since they do not affect the mesh. */
static struct vg_digest of_surface(const struct vg_mesh *m)
{
  struct vg_digest d = { { 0, 0 } };

  add(&d, m->n_point * sizeof *m->point, m->point);
  add(&d, m->n_tri * sizeof *m->tri, m->tri);
  add(&d, m->n_tri * sizeof *m->tri_patch, m->tri_patch);
  return d;
}

static struct claim make_claim(struct vg_comm *c, const struct vg_mesh *surface,
                               const struct vg_layers *layers,
                               const struct vg_sizing *sizing,
                               enum vg_agree change)
{
  struct claim own;

  memset(&own, 0, sizeof own);
  if (gethostname(own.host, sizeof own.host - 1)) own.host[0] = '?';
  own.counts = vg_comm_node_rank(c) == 0;
  if (!own.counts) return own;
  own.of[VG_AGREE_SURFACE] = of_surface(surface);
  if (layers) vg_layers_show(layers, add, &own.of[VG_AGREE_LAYERS]);
  vg_sizing_show(sizing, add, &own.of[VG_AGREE_SIZES]);
  if (change != VG_AGREE_NOTHING &&
      vg_comm_rank(c) + vg_comm_node_size(c) == vg_comm_size(c))
    own.of[change].word[0] ^= 1;
  return own;
}

static vg_status compare(int n, const struct vg_bytes *claim,
                         struct vg_error *err)
{
  struct claim first, other;

  memcpy(&first, claim[0].data, sizeof first);
  for (int r = 1; r < n; r++) {
    memcpy(&other, claim[r].data, sizeof other);
    for (int k = 0; k < VG_AGREE_N && other.counts; k++)
      if (memcmp(&other.of[k], &first.of[k], sizeof other.of[k]) != 0)
        return vg_fail(err, VG_ERR_REMOTE,
                       "rank %d on %s computed different %s than rank 0 on "
                       "%s; nothing was meshed. Give all ranks the same "
                       "program, input files and libraries; if they are the "
                       "same, please report this with both processor types",
                       r, other.host, vg_agree_name((enum vg_agree)k),
                       first.host);
  }
  return VG_OK;
}

/* Gathers `size` bytes of every rank. */
static vg_status gather(struct vg_comm *c, size_t size, void *data,
                        struct vg_bytes **all, struct vg_error *err)
{
  struct vg_bytes own = { size, data };
  vg_status st;

  *all = vg_calloc((size_t)vg_comm_size(c), sizeof **all);
  st = vg_comm_agree(c, *all ? VG_OK : vg_fail_memory(err, "a comparison"),
                     err);
  return st < 0 ? st : vg_comm_allgather(c, &own, *all, err);
}

vg_status vg_run_agree(struct vg_comm *c, const struct vg_mesh *surface,
                       const struct vg_layers *layers,
                       const struct vg_sizing *sizing, enum vg_agree change,
                       struct vg_error *err)
{
  int n = vg_comm_size(c);
  struct vg_bytes *all = NULL;
  struct claim claim;
  vg_status st;

  assert(surface && sizing && change <= VG_AGREE_NOTHING);
  if (n == vg_comm_node_size(c)) return VG_OK;
  claim = make_claim(c, surface, layers, sizing, change);
  st = gather(c, sizeof claim, &claim, &all, err);
  if (st >= 0) st = compare(n, all, err);
  vg_bytes_release(all, all ? (size_t)n : 0);
  return st;
}

/* --- helper programs ----------------------------------------------------- */

struct installed {
  char host[64];
  char identity[VG_HELPER_N][192]; /* "none": not installed */
};

static vg_status compare_helpers(int n, const struct vg_bytes *all,
                                 struct vg_error *err)
{
  const struct installed *first = (const void *)all[0].data;

  for (int r = 1; r < n; r++) {
    const struct installed *other = (const void *)all[r].data;

    for (int k = 0; k < VG_HELPER_N; k++)
      if (strcmp(other->identity[k], first->identity[k]) != 0)
        return vg_fail(err, VG_ERR_REMOTE,
                       "rank %d on %s uses another %s (%s) than rank 0 on %s "
                       "(%s); nothing was meshed. Install the same helper "
                       "programs on all nodes, or name a common folder with "
                       "--helpers",
                       r, other->host, vg_helper_name((enum vg_helper_kind)k),
                       other->identity[k], first->host, first->identity[k]);
  }
  return VG_OK;
}

vg_status vg_run_helpers(struct vg_comm *c, struct vg_error *err)
{
  struct vg_bytes *all = NULL;
  struct installed own;
  struct vg_helper h;
  vg_status st = VG_OK;

  memset(&own, 0, sizeof own);
  if (gethostname(own.host, sizeof own.host - 1)) own.host[0] = '?';
  for (int k = 0; k < VG_HELPER_N; k++) {
    vg_helper_find((enum vg_helper_kind)k, &h);
    memcpy(own.identity[k], h.identity, sizeof own.identity[k]);
    if (k == VG_HELPER_TETGEN && h.is_unusable)
      st = vg_fail(err, VG_ERR_IO, "%s", h.why);
  }
  st = vg_comm_agree(c, st, err);
  if (st >= 0 && vg_comm_size(c) > 1) {
    st = gather(c, sizeof own, &own, &all, err);
    if (st >= 0) st = compare_helpers(vg_comm_size(c), all, err);
    vg_bytes_release(all, all ? (size_t)vg_comm_size(c) : 0);
  }
  return st;
}
