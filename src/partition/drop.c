/* Cells that were made for nothing: of zones whose changes cross the front.
 * Their home found that, when they were kept elsewhere already. */
#include "base/memory.h"
#include "partition/node.h"

vg_status vg_partition_note_drop(struct vg_partition *p,
                                 const struct vg_change *c,
                                 struct vg_error *err)
{
  vg_status st = VG_OK;

  pthread_mutex_lock(&p->lock);
  if (vg_reserve(&p->drop, &p->cap_drop, p->n_drop + 1, sizeof *p->drop)) {
    st = vg_fail_memory(err, "cutting a front");
  } else {
    p->drop[p->n_drop++] = c->serial;
    p->report.n_crossing++;
    p->report.n_blocked++;
    p->report.n_zone_cell -= c->n_cell;
  }
  pthread_mutex_unlock(&p->lock);
  return st;
}

static void drop(struct vg_partition *p, uint32_t serial)
{
  size_t left = 0;

  for (size_t k = 0; k < p->n_piece; k++)
    if (p->piece[k].serial == serial) vg_piece_release(&p->piece[k]);
    else p->piece[left++] = p->piece[k];
  p->n_piece = left;
}

vg_status vg_partition_drop(struct vg_partition *p, struct vg_comm *comm,
                            struct vg_error *err)
{
  struct vg_bytes mine = { p->n_drop * sizeof *p->drop,
                           (unsigned char *)p->drop };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the cells of a task");

  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; r < p->size; r++) {
    const uint32_t *serial = (const uint32_t *)(const void *)all[r].data;

    for (size_t k = 0; k < all[r].n / sizeof *serial; k++) drop(p, serial[k]);
  }
  p->n_drop = 0;
done:
  vg_bytes_release(all, p->size);
  return st;
}
