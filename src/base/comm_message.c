/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Messages between ranks; see base/comm.h.
 *
 * The tag of a message is 2 * kind, and the receiver finds its length by
 * probing. A message longer than one MPI call can send is announced by a
 * 16-byte message with tag 2 * kind + 1 that holds its length. Its parts follow
 * on the other communicator. Announcements and parts from one rank arrive in
 * order, because MPI does not let messages with the same sender, communicator
 * and tag overtake each other, and because all of them are posted under one
 * lock. */
#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/comm_parts.h"
#include "base/memory.h"

enum { KIND_MAX = 16383 }; /* MPI guarantees tags up to 32767 */

struct vg_sent {
  size_t n_left; /* requests that are not complete */
  uint64_t n;    /* length of the announced message */
  unsigned char *data;
};

struct vg_self_message {
  struct vg_message message;
  struct vg_self_message *next;
};

/* --- posting ------------------------------------------------------------- */

static int reserve_requests(struct vg_comm *c, size_t more)
{
  size_t need = (size_t)c->n_request + more;

  return need > INT_MAX ||
             vg_reserve(&c->request, &c->cap_request, need,
                        sizeof *c->request) ||
             vg_reserve(&c->sent, &c->cap_sent, need, sizeof *c->sent) ||
             vg_reserve(&c->done, &c->cap_done, need, sizeof *c->done)
         ? -1
         : 0;
}

static int send_part(struct vg_comm *c, struct vg_sent *s, const void *data,
                     size_t n, int to, int tag, MPI_Comm comm)
{
  int rc = MPI_Isend(data, (int)n, MPI_BYTE, to, tag, comm,
                     &c->request[c->n_request]);

  if (rc) return rc;
  c->sent[c->n_request++] = s;
  s->n_left++;
  return MPI_SUCCESS;
}

static int send_all(struct vg_comm *c, struct vg_sent *s, int to, int kind)
{
  int rc;

  if (s->n <= c->chunk)
    return send_part(c, s, s->data, (size_t)s->n, to, 2 * kind,
                     c->message_comm);
  rc = send_part(c, s, &s->n, sizeof s->n, to, 2 * kind + 1, c->message_comm);
  for (size_t at = 0; at < s->n && !rc; at += c->chunk)
    rc = send_part(c, s, s->data + at,
                   s->n - at < c->chunk ? s->n - at : c->chunk, to, VG_TAG_PART,
                   c->all);
  return rc;
}

static vg_status post_to_self(struct vg_comm *c, int kind, struct vg_bytes *b,
                              struct vg_error *err)
{
  struct vg_self_message *q = vg_alloc(1, sizeof *q);

  if (!q) return vg_fail_memory(err, "a message");
  *q = (struct vg_self_message){ { c->rank, kind, *b }, NULL };
  pthread_mutex_lock(&c->lock);
  *c->last = q;
  c->last = &q->next;
  pthread_mutex_unlock(&c->lock);
  *b = (struct vg_bytes){ 0, NULL };
  vg_comm_wake(c);
  return VG_OK;
}

static vg_status post(struct vg_comm *c, int to, int kind, struct vg_bytes *b,
                      struct vg_error *err)
{
  struct vg_sent *s = vg_alloc(1, sizeof *s);
  int rc;

  if (!s || reserve_requests(c, b->n / c->chunk + 2)) {
    free(s);
    return vg_fail_memory(err, "a message");
  }
  *s = (struct vg_sent){ 0, b->n, b->data };
  rc = send_all(c, s, to, kind);
  if (rc && !s->n_left) free(s);
  else *b = (struct vg_bytes){ 0, NULL };
  if (rc) return vg_comm_fail(err, "cannot send a message", rc);
  c->posted++;
  vg_comm_wake_rank(c, to);
  return VG_OK;
}

vg_status vg_comm_post(struct vg_comm *c, int to, int kind, struct vg_bytes *b,
                       struct vg_error *err)
{
  vg_status st;

  assert(b && (b->data || !b->n));
  assert(kind >= 0 && kind < 16384);
  assert(!c || (to >= 0 && to < c->size));
  if (!c)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "messages need a job with MPI");
  if (to < 0 || to >= c->size || kind < 0 || kind > KIND_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "no message of kind %d can go to rank "
                   "%d of %d",
                   kind, to, c->size);
  if (to == c->rank) return post_to_self(c, kind, b, err);
  pthread_mutex_lock(&c->lock);
  st = post(c, to, kind, b, err);
  pthread_mutex_unlock(&c->lock);
  return st;
}

/* Free the memory of messages that have been sent. */
static vg_status reclaim(struct vg_comm *c, struct vg_error *err)
{
  int n_done = 0, n = 0, rc;

  if (!c->n_request) return VG_OK;
  rc = MPI_Testsome(c->n_request, c->request, &n_done, c->done,
                    MPI_STATUSES_IGNORE);
  if (rc) return vg_comm_fail(err, "cannot send a message", rc);
  for (int i = 0; i < n_done; i++) {
    struct vg_sent *s = c->sent[c->done[i]];

    if (--s->n_left) continue;
    free(s->data);
    free(s);
  }
  if (n_done <= 0) return VG_OK; /* n_done may be MPI_UNDEFINED */
  for (int i = 0; i < c->n_request; i++) {
    if (c->request[i] == MPI_REQUEST_NULL) continue;
    c->request[n] = c->request[i];
    c->sent[n++] = c->sent[i];
  }
  c->n_request = n;
  return VG_OK;
}

/* --- incoming ------------------------------------------------------------ */

/* The message is delivered without data, so that its receiver knows that it was
 * lost. */
static vg_status lose(struct vg_incoming *a, struct vg_error *err)
{
  free(a->message.bytes.data);
  free(a->request);
  a->message.bytes.data = NULL;
  a->request = NULL;
  return vg_fail_memory(err, "a message from another rank");
}

/* Receive the parts of an announced message. They arrive in the order of the
 * announcements. */
static vg_status start_long(struct vg_comm *c, struct vg_incoming *a,
                            MPI_Message *handle, struct vg_error *err)
{
  struct vg_bytes *b = &a->message.bytes;
  uint64_t n;
  int rc = MPI_Mrecv(&n, sizeof n, MPI_BYTE, handle, MPI_STATUS_IGNORE);

  if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
  b->n = (size_t)n;
  b->data = vg_alloc(b->n, 1);
  a->request = vg_alloc(b->n / c->chunk + 1, sizeof *a->request);
  /* the parts of a lost message are not received, so that no later parts can be
   * told from them */
  c->has_lost_parts |= !b->data || !a->request;
  if (c->has_lost_parts) return lose(a, err);
  for (size_t at = 0; at < b->n; at += c->chunk) {
    size_t m = b->n - at < c->chunk ? b->n - at : c->chunk;

    rc = MPI_Irecv(b->data + at, (int)m, MPI_BYTE, a->message.from, VG_TAG_PART,
                   c->all, &a->request[a->n_request]);
    if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
    a->n_request++;
  }
  return VG_OK;
}

static vg_status start_short(struct vg_incoming *a, MPI_Message *handle,
                             MPI_Status *status, struct vg_error *err)
{
  struct vg_bytes *b = &a->message.bytes;
  int n, rc = MPI_Get_count(status, MPI_BYTE, &n);

  if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
  b->n = (size_t)n;
  b->data = vg_alloc(b->n, 1);
  if (!b->data) return lose(a, err);
  rc = MPI_Imrecv(b->data, n, MPI_BYTE, handle, &a->one);
  if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
  a->n_request = 1;
  return VG_OK;
}

static MPI_Request *requests_of(struct vg_incoming *a)
{
  return a->request ? a->request : &a->one;
}

/* Open MPI may detect a message during an unsuccessful probe, and report it
 * only at the next one. So probe twice. */
static int probe(struct vg_comm *c, int *is_there, MPI_Message *handle,
                 MPI_Status *status)
{
  int rc = MPI_SUCCESS;

  *is_there = 0;
  for (int i = 0; i < 2 && !*is_there && !rc; i++)
    rc = MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, c->message_comm, is_there,
                     handle, status);
  return rc;
}

/* Start to receive all announced messages, as far as there is room. */
static vg_status look(struct vg_comm *c, struct vg_error *err)
{
  while (c->n_incoming < VG_INCOMING_MAX) {
    struct vg_incoming *a = &c->incoming[c->n_incoming];
    MPI_Message handle;
    MPI_Status status;
    int is_there, rc;
    vg_status st;

    rc = probe(c, &is_there, &handle, &status);
    if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
    if (!is_there) return VG_OK;
    memset(a, 0, sizeof *a);
    a->message.from = status.MPI_SOURCE;
    a->message.kind = status.MPI_TAG / 2;
    c->n_incoming++; /* count it before the receive can fail, since its
                        memory must be kept */
    if (status.MPI_TAG % 2) st = start_long(c, a, &handle, err);
    else st = start_short(a, &handle, &status, err);
    if (st < 0) return st;
  }
  return VG_OK;
}

static int is_overtaking(const struct vg_comm *c, int i)
{
  for (int k = 0; k < i; k++)
    if (c->incoming[k].message.from == c->incoming[i].message.from) return 1;
  return 0;
}

/* Take the first complete message that no earlier message of the same sender
 * precedes. */
static vg_status take(struct vg_comm *c, struct vg_message *m,
                      struct vg_error *err)
{
  for (int i = 0; i < c->n_incoming; i++) {
    struct vg_incoming *a = &c->incoming[i];
    int is_whole = 0, rc;

    if (is_overtaking(c, i)) continue;
    rc = MPI_Testall(a->n_request, requests_of(a), &is_whole,
                     MPI_STATUSES_IGNORE);
    if (rc) return vg_comm_fail(err, "cannot receive a message", rc);
    if (!is_whole) continue;
    *m = a->message;
    free(a->request);
    memmove(a, a + 1, (size_t)(--c->n_incoming - i) * sizeof *a);
    c->received++;
    return VG_OK;
  }
  return VG_BLOCKED;
}

/* Take a message from this rank to itself. Called with the lock held. */
static int take_own(struct vg_comm *c, struct vg_message *m)
{
  struct vg_self_message *q = c->first;

  if (!q) return 0;
  c->first = q->next;
  if (!q->next) c->last = &c->first;
  *m = q->message;
  free(q);
  return 1;
}

vg_status vg_comm_poll(struct vg_comm *c, struct vg_message *m,
                       struct vg_error *err)
{
  vg_status st;
  int is_own;

  assert(m);
  if (!c)
    return vg_fail(err, VG_ERR_UNSUPPORTED, "messages need a job with MPI");
  pthread_mutex_lock(&c->lock);
  st = reclaim(c, err);
  is_own = st >= 0 && take_own(c, m);
  pthread_mutex_unlock(&c->lock);
  if (st < 0 || is_own) return st;
  if ((st = look(c, err)) < 0) return st;
  return take(c, m, err);
}

/* --- the end ------------------------------------------------------------- */

/* The messages in transit are those that all ranks have posted and not yet
 * received, including those that MPI has not yet sent. If one rank cannot go
 * on, all ranks stop waiting here; then MPI_Finalize waits for the remaining
 * messages, or the launcher ends the job. */
void vg_comm_drain(struct vg_comm *c)
{
  uint64_t v[2] = { 1, 0 };

  while (v[0] && !v[1]) {
    struct vg_message m;
    vg_status st;

    while ((st = vg_comm_poll(c, &m, NULL)) == VG_OK) free(m.bytes.data);
    pthread_mutex_lock(&c->lock);
    v[0] = c->posted - c->received;
    v[1] = st < 0;
    pthread_mutex_unlock(&c->lock);
    if (vg_comm_sum(c, 2, v, NULL) < 0) return;
  }
}

void vg_comm_messages_release(struct vg_comm *c)
{
  struct vg_message m;

  while (take_own(c, &m)) free(m.bytes.data);
  for (int i = 0; i < c->n_incoming; i++) {
    struct vg_incoming *a = &c->incoming[i];

    if (vg_comm_cancel_receives(a->n_request, requests_of(a))) continue;
    free(a->message.bytes.data);
    free(a->request);
  }
  for (int i = 0; i < c->n_request; i++) {
    int is_done = 0;

    /* memory of an incomplete send must be kept */
    if (MPI_Test(&c->request[i], &is_done, MPI_STATUS_IGNORE) || !is_done ||
        --c->sent[i]->n_left)
      continue;
    free(c->sent[i]->data);
    free(c->sent[i]);
  }
  free(c->request);
  free(c->sent);
  free(c->done);
}
