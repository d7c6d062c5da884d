/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "partition/store/store_parts.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static struct vg_digest hash(const void *data, size_t n)
{
  XXH128_hash_t h = XXH3_128bits(data, n);

  return (struct vg_digest){ { h.high64, h.low64 } };
}

enum { PART = 1 << 20 };

/* The file is read in parts, because a mapped file would count as memory of
 * the program. */
static int digest_parts(int fd, XXH3_state_t *state, char *part,
                        struct vg_digest *d, uint64_t *bytes)
{
  XXH128_hash_t h;
  ssize_t n;

  *bytes = 0;
  XXH3_128bits_reset(state);
  while ((n = read(fd, part, PART)) != 0) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return -1;
    XXH3_128bits_update(state, part, (size_t)n);
    *bytes += (uint64_t)n;
  }
  h = XXH3_128bits_digest(state);
  *d = (struct vg_digest){ { h.high64, h.low64 } };
  return 0;
}

int vg_digest_file(int fd, struct vg_digest *d, uint64_t *bytes)
{
  assert(fd >= 0 && d && bytes);
  XXH3_state_t *state = XXH3_createState();
  char *part = vg_alloc(PART, 1);
  int bad = -1;

  if (state && part) bad = digest_parts(fd, state, part, d, bytes);
  else errno = ENOMEM;
  free(part);
  XXH3_freeState(state);
  return bad;
}

/* XXH3 takes 64-bit seeds only, which would reduce a chain to 64 bits, and its
 * streaming state would have to appear in the interface. So digests are
 * chained by hashing pairs. */
struct vg_digest vg_digest_of(struct vg_digest seed, size_t n, const void *data)
{
  struct vg_digest both[2] = { seed, hash(data, n) };

  assert(data || !n);
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
  struct vg_digest v = { { 0, 0 } };

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

void vg_library_xxhash(struct vg_library *out)
{
  unsigned v = XXH_versionNumber();

  out->name = "xxHash";
  snprintf(out->version, sizeof out->version, "%u.%u.%u", v / 10000,
           v / 100 % 100, v % 100);
}
