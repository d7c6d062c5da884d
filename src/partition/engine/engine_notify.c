/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Messages of a rank to the schedule: a function call on rank 0, a message
 * elsewhere. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/engine/engine_parts.h"

void vg_engine_wake(struct vg_engine *e)
{
  if (e->size > 1) vg_comm_wake(e->comm);
  else pthread_cond_signal(&e->serve);
}

/* If a message cannot even be posted, the other ranks would wait forever, so
 * the job is aborted. */
void vg_engine_post(struct vg_engine *e, int to, int kind, struct vg_bytes *b)
{
  assert(to >= 0 && to < e->size && kind >= VG_MSG_UPDATE);
  assert(kind <= VG_MSG_OUTCOME);
  if (!b->data || vg_comm_post(e->comm, to, kind, b, NULL) < 0)
    vg_comm_abort(e->comm, 1, VG_ENGINE_NO_MEMORY);
  e->sent[to]++;
  e->poll_soon = 1;
  vg_engine_wake(e);
}

static void post_copy(struct vg_engine *e, int to, int kind, const void *what,
                      size_t n)
{
  struct vg_bytes b = { n, vg_alloc(n, 1) };

  if (b.data) memcpy(b.data, what, n);
  vg_engine_post(e, to, kind, &b);
}

void vg_engine_send(struct vg_engine *e, int to, int kind, struct vg_msg msg)
{
  post_copy(e, to, kind, &msg, sizeof msg);
}

/* Gives the new tasks their handles; memory was reserved when they were
 * submitted. Pinned tasks need not wait for the schedule. */
static uint64_t enter_new(struct vg_engine *e)
{
  size_t n = e->n_new;

  for (size_t i = 0; i < n; i++) {
    struct vg_task_state *j = e->new_task[i];
    struct vg_task_notice *notice = &e->notice[i];

    j->handle = e->n_home;
    e->home[e->n_home++] = j;
    memcpy(notice->path, j->task.path, sizeof notice->path);
    notice->key = j->place.key;
    notice->weight = j->task.weight;
    notice->work = j->task.work;
    notice->handle = j->handle;
    notice->pinned = j->task.pinned != 0;
    if (j->task.pinned) vg_work_queue(e, j);
  }
  e->n_new = 0;
  return n;
}

static void send_update(struct vg_engine *e, const struct vg_update *update)
{
  size_t head = sizeof *update, tail = update->n * sizeof *e->notice;
  struct vg_bytes b = { head + tail, NULL };

  if (!e->rank) {
    vg_schedule_update(e, 0, update, e->notice);
    return;
  }
  b.data = vg_alloc(b.n, 1);
  if (b.data) {
    memcpy(b.data, update, head);
    if (tail) memcpy(b.data + head, e->notice, tail);
  }
  vg_engine_post(e, 0, VG_MSG_UPDATE, &b);
}

void vg_notify_update(struct vg_engine *e, const struct vg_task_state *ended)
{
  struct vg_update update = { .threads = e->threads };

  if (ended) {
    update.ended = 1;
    update.weight = ended->task.weight;
    update.n_cell = ended->n_cell;
  }
  update.n = enter_new(e);
  send_update(e, &update);
}

void vg_notify_dropped(struct vg_engine *e, double weight)
{
  struct vg_update update = { .ended = 1, .weight = weight };

  send_update(e, &update);
}

void vg_notify_free(struct vg_engine *e)
{
  if (!e->rank) vg_schedule_free(e, 0);
  else vg_engine_send(e, 0, VG_MSG_FREE, (struct vg_msg){ 0 });
}

void vg_notify_moved(struct vg_engine *e, int to, int ok)
{
  if (!e->rank) vg_schedule_moved(e, 0, to, ok);
  else
    vg_engine_send(e, 0, VG_MSG_MOVED, (struct vg_msg){ .to = to, .ok = ok });
}

void vg_notify_fail(struct vg_engine *e, vg_status status, const char *path,
                    const struct vg_error *err)
{
  struct vg_final_status v;

  assert(status != VG_OK);
  memset(&v, 0, sizeof v);
  v.status = status;
  v.from = e->rank;
  memcpy(v.path, path, strlen(path));
  if (err) memcpy(v.text, err->text, sizeof v.text);
  vg_serve_drain(e);
  if (!e->rank) vg_schedule_fail(e, &v);
  else post_copy(e, 0, VG_MSG_FAIL, &v, sizeof v);
}
