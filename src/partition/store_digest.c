#include "partition/store_parts.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static struct vg_digest hash(const void *data, size_t n)
{
  XXH128_hash_t h = XXH3_128bits(data, n);

  return (struct vg_digest){{h.high64, h.low64}};
}

struct vg_digest vg_digest_plain(size_t n, const void *data)
{
  return hash(data, n);
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
