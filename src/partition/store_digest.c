#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "partition/store_parts.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static struct vg_digest hash(const void *data, size_t n)
{
  XXH128_hash_t h = XXH3_128bits(data, n);

  return (struct vg_digest){{h.high64, h.low64}};
}

/* Read in parts: a mapped file would count as memory of the program. One part
 * is hashed while the next is read; parts are large since each takes a thread
 * to be started. */
enum { PART = 4 << 20 };

struct reading {
  int fd, now;               /* part[now] is hashed */
  XXH3_state_t *state;
  char *part[2];
  size_t n[2];
  int why;                   /* errno of a read that failed */
};

static void read_part(struct reading *r, int k)
{
  r->n[k] = 0;
  while (r->n[k] < PART) {
    ssize_t n = read(r->fd, r->part[k] + r->n[k], PART - r->n[k]);

    if (n < 0 && errno == EINTR) continue;
    if (n < 0) r->why = errno;
    if (n <= 0) return;
    r->n[k] += (size_t)n;
  }
}

static void step(void *context, size_t first, size_t end, int worker)
{
  struct reading *r = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    if (i) read_part(r, !r->now);
    else XXH3_128bits_update(r->state, r->part[r->now], r->n[r->now]);
}

static int digest_parts(struct reading *r, int threads, struct vg_digest *d,
                        uint64_t *bytes)
{
  XXH128_hash_t h;

  *bytes = 0;
  XXH3_128bits_reset(r->state);
  read_part(r, 0);
  for (; r->n[r->now] && !r->why; r->now = !r->now) {
    vg_parallel_for(threads, 2, 1, step, r);
    *bytes += r->n[r->now];
  }
  if (r->why) {
    errno = r->why;
    return -1;
  }
  h = XXH3_128bits_digest(r->state);
  *d = (struct vg_digest){{h.high64, h.low64}};
  return 0;
}

int vg_digest_file(int fd, int threads, struct vg_digest *d, uint64_t *bytes)
{
  struct reading r = { .fd = fd, .state = XXH3_createState(),
                       .part = { vg_alloc(PART, 1), vg_alloc(PART, 1) } };
  int bad = -1;

  if (r.state && r.part[0] && r.part[1])
    bad = digest_parts(&r, threads, d, bytes);
  else errno = ENOMEM;
  for (int k = 0; k < 2; k++) free(r.part[k]);
  XXH3_freeState(r.state);
  return bad;
}

/* XXH3 takes seeds of 64 bits only, so that a chain through them would come
 * down to 64; and its state for streams would show in the interface. */
struct vg_digest vg_digest_of(struct vg_digest seed, size_t n,
                              const void *data)
{
  struct vg_digest both[2] = {seed, hash(data, n)};

  return hash(both, sizeof both);
}

void vg_digest_text(struct vg_digest d, char text[VG_DIGEST_TEXT])
{
  for (int k = 0; k < 32; k++)
    text[k] = "0123456789abcdef"[d.word[k / 16] >> (60 - k % 16 * 4) & 15];
  text[32] = 0;
}

int vg_digest_parse(const char *text, struct vg_digest *d)
{
  struct vg_digest v = {{0, 0}};

  for (int k = 0; k < 32; k++) {
    char c = text[k];
    unsigned digit;

    if (c >= '0' && c <= '9') digit = (unsigned)(c - '0');
    else if (c >= 'a' && c <= 'f') digit = (unsigned)(c - 'a') + 10;
    else return 0;
    v.word[k / 16] = v.word[k / 16] << 4 | digit;
  }
  *d = v;
  return 1;
}
