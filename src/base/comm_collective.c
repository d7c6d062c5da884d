/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Collectives of base/comm.h. Ranks sleep while they wait. Where one rank may
 * run out of memory, all ranks agree before they continue. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/comm_parts.h"
#include "base/memory.h"

static vg_status finish(MPI_Request *request, int rc, const char *what,
                        struct vg_error *err)
{
  if (!rc) rc = vg_comm_wait(1, request, 0);
  return rc ? vg_comm_fail(err, what, rc) : VG_OK;
}

/* Reduce v [n] of an MPI type in place. */
static vg_status reduce(struct vg_comm *c, size_t n, void *v, size_t size,
                        MPI_Datatype type, MPI_Op op, struct vg_error *err)
{
  size_t most = c->chunk / size;
  vg_status st = VG_OK;

  if (!most) most = 1;
  for (size_t at = 0; at < n && st >= 0; at += most) {
    int m = (int)(n - at < most ? n - at : most);
    MPI_Request request;
    int rc = MPI_Iallreduce(MPI_IN_PLACE, (char *)v + at * size, m, type, op,
                            c->all, &request);

    st = finish(&request, rc, "reduction", err);
  }
  return st;
}

vg_status vg_comm_sum(struct vg_comm *c, size_t n, uint64_t *v,
                      struct vg_error *err)
{
  assert(v || !n);
  return c ? reduce(c, n, v, sizeof *v, MPI_UINT64_T, MPI_SUM, err) : VG_OK;
}

vg_status vg_comm_max(struct vg_comm *c, size_t n, double *v,
                      struct vg_error *err)
{
  assert(v || !n);
  return c ? reduce(c, n, v, sizeof *v, MPI_DOUBLE, MPI_MAX, err) : VG_OK;
}

/* --- agreement ----------------------------------------------------------- */

struct verdict {
  int status, rank;
  char text[sizeof((struct vg_error *)0)->text];
};

/* Order of verdicts: genuine failures first, then VG_ERR_REMOTE, which another
 * rank's failure caused, then outcomes > 0. */
static uint64_t severity(vg_status st)
{
  return st < 0 ? (st == VG_ERR_REMOTE) : st > 0 ? 2 : 3;
}

/* Does the message already begin with "rank 3: ..."? */
static int names_rank(const char *text)
{
  size_t n;

  if (strncmp(text, "rank ", 5)) return 0;
  n = strspn(text + 5, "0123456789");
  return n && text[5 + n] == ':';
}

vg_status vg_comm_agree_in(const struct vg_comm *c, MPI_Comm comm,
                           vg_status mine, struct vg_error *err)
{
  struct verdict v = { mine, c->rank, "" };
  MPI_Request request;
  uint64_t key;
  int me, rc, root;
  vg_status st;

  MPI_Comm_rank(comm, &me);
  key = severity(mine) << 32 | (uint32_t)me;
  rc = MPI_Iallreduce(MPI_IN_PLACE, &key, 1, MPI_UINT64_T, MPI_MIN, comm,
                      &request);
  if ((st = finish(&request, rc, "agreement", err)) < 0) return st;
  if (key >> 32 == severity(VG_OK)) return VG_OK;
  root = (int)(uint32_t)key;
  if (mine < 0 && err) memcpy(v.text, err->text, sizeof v.text);
  rc = MPI_Ibcast(&v, (int)sizeof v, MPI_BYTE, root, comm, &request);
  if ((st = finish(&request, rc, "agreement", err)) < 0) return st;
  if (root == me || v.status > 0) return (vg_status)v.status;
  v.text[sizeof v.text - 1] = 0;
  if (names_rank(v.text))
    return vg_fail(err, (vg_status)v.status, "%s", v.text);
  return vg_fail(err, (vg_status)v.status, "rank %d: %s", v.rank,
                 v.text[0] ? v.text : vg_status_name((vg_status)v.status));
}

vg_status vg_comm_agree(struct vg_comm *c, vg_status mine, struct vg_error *err)
{
  return c ? vg_comm_agree_in(c, c->all, mine, err) : mine;
}

/* --- bytes --------------------------------------------------------------- */

static vg_status fresh(uint64_t n, struct vg_bytes *b, struct vg_error *err)
{
  b->data = n <= SIZE_MAX ? vg_alloc((size_t)n, 1) : NULL;
  if (!b->data) return vg_fail_memory(err, "bytes from another rank");
  b->n = (size_t)n;
  return VG_OK;
}

static vg_status bcast_in(const struct vg_comm *c, MPI_Comm comm, int root,
                          struct vg_bytes *b, struct vg_error *err)
{
  struct vg_bytes got = { 0, NULL };
  uint64_t n = b->n;
  MPI_Request request;
  vg_status st;
  int me, rc;

  MPI_Comm_rank(comm, &me);
  rc = MPI_Ibcast(&n, 1, MPI_UINT64_T, root, comm, &request);
  VG_TRY(finish(&request, rc, "broadcast", err));
  if (me == root) got = *b;
  else st = fresh(n, &got, err);
  VG_TRY(vg_comm_agree_in(c, comm, st, err));
  for (size_t at = 0; at < got.n; at += c->chunk) {
    size_t m = got.n - at < c->chunk ? got.n - at : c->chunk;

    rc = MPI_Ibcast(got.data + at, (int)m, MPI_BYTE, root, comm, &request);
    if (!rc) rc = vg_comm_wait(1, &request, 1);
    if (rc) VG_TRY(vg_comm_fail(err, "broadcast", rc));
  }
  if (me == root) return VG_OK;
  free(b->data);
  *b = got;
  return VG_OK;
done:
  if (me != root) free(got.data);
  return st;
}

vg_status vg_comm_bcast(struct vg_comm *c, int root, struct vg_bytes *b,
                        struct vg_error *err)
{
  assert(b && root >= 0 && root < vg_comm_size(c));
  return c ? bcast_in(c, c->all, root, b, err) : VG_OK;
}

vg_status vg_comm_node_bcast(struct vg_comm *c, struct vg_bytes *b,
                             struct vg_error *err)
{
  assert(b);
  return c ? bcast_in(c, c->node, 0, b, err) : VG_OK;
}

static vg_status copy_own(const struct vg_bytes *from, struct vg_bytes *to,
                          struct vg_error *err)
{
  vg_status st = fresh(from->n, to, err);

  if (st >= 0 && from->n) memcpy(to->data, from->data, from->n);
  return st;
}

static void release_all(struct vg_bytes *b, int n)
{
  for (int i = 0; b && i < n; i++) free(b[i].data);
  free(b);
}

/* Allocate n [size] bytes for the data of every rank. Succeeds on all ranks or
 * on none. */
static vg_status fresh_all(const struct vg_comm *c, const uint64_t *n,
                           struct vg_bytes **out, struct vg_error *err)
{
  struct vg_bytes *b = vg_calloc((size_t)c->size, sizeof *b);
  vg_status st = b ? VG_OK : vg_fail_memory(err, "bytes from all ranks");

  for (int i = 0; i < c->size && st >= 0; i++) st = fresh(n[i], &b[i], err);
  st = vg_comm_agree_in(c, c->all, st, err);
  if (st < 0) release_all(b, c->size);
  else *out = b;
  return st;
}

/* --- all to all ---------------------------------------------------------- */

struct transfers {
  int n;
  size_t cap;
  MPI_Request *request;
};

static vg_status transfer(const struct vg_comm *c, struct transfers *t,
                          const struct vg_bytes *b, int peer, int is_send,
                          struct vg_error *err)
{
  for (size_t at = 0; at < b->n; at += c->chunk) {
    int m = (int)(b->n - at < c->chunk ? b->n - at : c->chunk), rc;

    rc = is_send ? MPI_Isend(b->data + at, m, MPI_BYTE, peer, VG_TAG_EXCHANGE,
                             c->all, t->request + t->n)
                 : MPI_Irecv(b->data + at, m, MPI_BYTE, peer, VG_TAG_EXCHANGE,
                             c->all, t->request + t->n);
    if (rc) return vg_comm_fail(err, "exchange", rc);
    t->n++;
  }
  return VG_OK;
}

static size_t n_chunks(const struct vg_comm *c, const struct vg_bytes *b)
{
  size_t n = 0;

  for (int i = 0; i < c->size; i++)
    if (i != c->rank) n += b[i].n / c->chunk + 1;
  return n;
}

/* Each rank starts with its own successor, so that the ranks do not all send to
 * the same one at once. */
static vg_status exchange_bytes(const struct vg_comm *c,
                                const struct vg_bytes *to,
                                struct vg_bytes *from, MPI_Request *request,
                                struct vg_error *err)
{
  struct transfers t = { .request = request };
  vg_status st = VG_OK;
  int n_receive;

  for (int k = 1; k < c->size && st >= 0; k++)
    st = transfer(c, &t, &from[(c->rank + c->size - k) % c->size],
                  (c->rank + c->size - k) % c->size, 0, err);
  n_receive = t.n;
  for (int k = 1; k < c->size && st >= 0; k++)
    st = transfer(c, &t, &to[(c->rank + k) % c->size], (c->rank + k) % c->size,
                  1, err);
  if (st >= 0) {
    int rc = vg_comm_wait(t.n, t.request, 1);

    if (rc) st = vg_comm_fail(err, "exchange", rc);
  }
  if (st < 0 && vg_comm_cancel_receives(n_receive, t.request))
    /* MPI may still write there */
    for (int k = 0; k < c->size; k++) from[k].data = NULL;
  return st;
}

/* Receive one size if a message has arrived; n [size]. */
static int take_size(struct vg_comm *c, int tag, uint64_t *n)
{
  MPI_Message message;
  MPI_Status status;
  uint64_t size;
  int is_there = 0, rc;

  rc = MPI_Improbe(MPI_ANY_SOURCE, tag, c->all, &is_there, &message, &status);
  if (rc || !is_there) return rc;
  rc = MPI_Mrecv(&size, 1, MPI_UINT64_T, &message, &status);
  if (!rc) n[status.MPI_SOURCE] = size;
  return rc;
}

/* Receive sizes until every size sent has been received, first by this rank and
 * then by all. */
static int take_sizes(struct vg_comm *c, int tag, int n_request,
                      MPI_Request *request, uint64_t *n)
{
  MPI_Request barrier;
  int sent = 0, done = 0, rc = MPI_SUCCESS;

  for (unsigned looks = 0; !rc && !done; looks++) {
    rc = take_size(c, tag, n);
    if (rc) break;
    if (sent) {
      rc = MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
    } else {
      rc = MPI_Testall(n_request, request, &sent, MPI_STATUSES_IGNORE);
      if (!rc && sent) rc = MPI_Ibarrier(c->all, &barrier);
    }
    if (!done) vg_comm_nap(looks);
  }
  return rc;
}

/* Find out how many bytes each rank will receive, where only the ranks that
 * send something announce it. The number of messages is the number of
 * communicating pairs, not the square of the number of ranks (Hoefler, Siebert,
 * Lumsdaine: Scalable communication protocols for dynamic sparse data exchange,
 * PPoPP 2010). Consecutive exchanges use different tags, since a rank that
 * knows that all sizes have been received may begin the next exchange before
 * the others have ended this one.
 * n in: [size] bytes to each rank; out: bytes from each rank. */
static vg_status exchange_sizes(struct vg_comm *c, uint64_t *n,
                                struct vg_error *err)
{
  MPI_Request *request = vg_alloc((size_t)c->size, sizeof *request);
  uint64_t *to = vg_alloc((size_t)c->size, sizeof *to);
  int tag = VG_TAG_SIZE + c->turn, m = 0, rc = MPI_SUCCESS;
  vg_status st = request && to ? VG_OK : vg_fail_memory(err, "transfers");

  VG_TRY(vg_comm_agree_in(c, c->all, st, err));
  c->turn = !c->turn;
  for (int i = 0; i < c->size; i++) {
    to[i] = n[i];
    if (i != c->rank) n[i] = 0;
  }
  for (int k = 1; k < c->size && !rc; k++) {
    int peer = (c->rank + k) % c->size;

    if (to[peer])
      rc = MPI_Issend(&to[peer], 1, MPI_UINT64_T, peer, tag, c->all,
                      &request[m++]);
  }
  if (!rc) rc = take_sizes(c, tag, m, request, n);
  /* MPI may still use the buffers */
  if (rc) return vg_comm_fail(err, "exchange", rc);
done:
  free(request);
  free(to);
  return st;
}

static vg_status exchange(struct vg_comm *c, const struct vg_bytes *to,
                          struct vg_bytes *from, uint64_t *n,
                          struct vg_error *err)
{
  struct vg_bytes *got = NULL;
  MPI_Request *all = NULL;
  vg_status st;

  VG_TRY(exchange_sizes(c, n, err));
  VG_TRY(fresh_all(c, n, &got, err));
  if (to[c->rank].n) memcpy(got[c->rank].data, to[c->rank].data, to[c->rank].n);
  all = vg_alloc(n_chunks(c, to) + n_chunks(c, got), sizeof *all);
  st = all ? VG_OK : vg_fail_memory(err, "transfers");
  VG_TRY(vg_comm_agree_in(c, c->all, st, err));
  VG_TRY(exchange_bytes(c, to, got, all, err));
  memcpy(from, got, (size_t)c->size * sizeof *from);
  memset(got, 0, (size_t)c->size * sizeof *got);
done:
  free(all);
  release_all(got, c->size);
  return st;
}

vg_status vg_comm_exchange(struct vg_comm *c, const struct vg_bytes *to,
                           struct vg_bytes *from, struct vg_error *err)
{
  uint64_t *n;
  vg_status st;

  assert(to && from);
  if (!c) return copy_own(to, from, err);
  n = vg_alloc((size_t)c->size, sizeof *n);
  st = vg_comm_agree(c, n ? VG_OK : vg_fail_memory(err, "sizes"), err);
  if (st >= 0) {
    for (int i = 0; i < c->size; i++) n[i] = to[i].n;
    st = exchange(c, to, from, n, err);
  }
  free(n);
  return st;
}

void vg_bytes_release(struct vg_bytes *list, size_t n)
{
  for (size_t k = 0; list && k < n; k++) free(list[k].data);
  free(list);
}

/* Gather by MPI_Allgatherv. at: [size] offset of each rank's bytes in `all`. */
static vg_status gather(struct vg_comm *c, const struct vg_bytes *mine,
                        const uint64_t *n, int *count, int *at,
                        struct vg_bytes *out, struct vg_error *err)
{
  struct vg_bytes *got = NULL;
  unsigned char *all = NULL;
  MPI_Request request;
  int total = 0, rc;
  vg_status st;

  VG_TRY(fresh_all(c, n, &got, err));
  for (int i = 0; i < c->size; i++) {
    at[i] = total;
    count[i] = (int)n[i];
    total += count[i];
  }
  all = vg_alloc((size_t)total, 1);
  VG_TRY(vg_comm_agree_in(c, c->all,
                          all ? VG_OK : vg_fail_memory(err, "gathering"), err));
  rc = MPI_Iallgatherv(mine->data, (int)mine->n, MPI_BYTE, all, count, at,
                       MPI_BYTE, c->all, &request);
  VG_TRY(finish(&request, rc, "gathering", err));
  for (int i = 0; i < c->size; i++) {
    if (n[i]) memcpy(got[i].data, all + at[i], (size_t)n[i]);
    out[i] = got[i];
    got[i] = (struct vg_bytes){ 0, NULL };
  }
done:
  free(all);
  release_all(got, c->size);
  return st;
}

/* Large amounts are sent by vg_comm_exchange, which has no size limit. */
static vg_status exchange_same(struct vg_comm *c, const struct vg_bytes *mine,
                               struct vg_bytes *out, struct vg_error *err)
{
  struct vg_bytes *to = vg_alloc((size_t)c->size, sizeof *to);
  vg_status st = to ? VG_OK : vg_fail_memory(err, "gathering");

  VG_TRY(vg_comm_agree(c, st, err));
  for (int i = 0; i < c->size; i++) to[i] = *mine;
  st = vg_comm_exchange(c, to, out, err);
done:
  free(to);
  return st;
}

vg_status vg_comm_allgather(struct vg_comm *c, const struct vg_bytes *mine,
                            struct vg_bytes *out, struct vg_error *err)
{
  assert(mine && out);

  uint64_t *n = NULL, own = mine->n, total = 0;
  int *count = NULL, *at = NULL, rc;
  MPI_Request request;
  vg_status st;

  if (!c) return copy_own(mine, out, err);
  n = vg_alloc((size_t)c->size, sizeof *n);
  count = vg_alloc((size_t)c->size, sizeof *count);
  at = vg_alloc((size_t)c->size, sizeof *at);
  st = n && count && at ? VG_OK : vg_fail_memory(err, "gathering");
  VG_TRY(vg_comm_agree(c, st, err));
  rc = MPI_Iallgather(&own, 1, MPI_UINT64_T, n, 1, MPI_UINT64_T, c->all,
                      &request);
  VG_TRY(finish(&request, rc, "gathering", err));
  for (int i = 0; i < c->size && total <= c->chunk; i++)
    total += n[i] < c->chunk ? n[i] : c->chunk + 1;
  st = total <= c->chunk ? gather(c, mine, n, count, at, out, err)
                         : exchange_same(c, mine, out, err);
done:
  free(n);
  free(count);
  free(at);
  return st;
}
