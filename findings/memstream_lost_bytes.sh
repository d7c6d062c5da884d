#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# glibc (Debian libc6 2.36-9+deb12u14): open_memstream without memory.
#
# POSIX: a stream has an error indicator, and fclose fails if data could not be
# written. If the buffer of open_memstream cannot grow, one fprintf fails, but
# ferror and fclose report nothing, and the text lacks bytes in its middle: the
# rest is appended later, when memory is there again. If the last reallocation
# fails, every fprintf has succeeded, fclose succeeds, and the text is NULL. A
# program that checks fclose, as for files, takes the first text for a whole one,
# and reads through NULL in the second case.
#
# Output seen (400 writes of 100 bytes; the given request for memory fails):
#   request 0: 1 failed fprintf, ferror 0, fclose 0, 39992 bytes
#   request 1: 1 failed fprintf, ferror 0, fclose 0, 39984 bytes
#   request 2: 1 failed fprintf, ferror 0, fclose 0, 39968 bytes
#   request 3: 0 failed fprintf, ferror 0, fclose 0, NULL
. "$(dirname "$(realpath "$0")")/install.sh"
install libc6=2.36-9+deb12u14 libc6-dev=2.36-9+deb12u14 gcc=4:12.2.0-3
work

cat > text.c <<'C'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

static int left = -1; /* requests until one fails; negative: none fails */

static int refuses(void)
{
  if (left < 0 || left-- > 0) return 0;
  errno = ENOMEM;
  return 1;
}

void *malloc(size_t n)
{
  void *(*next)(size_t) = (void *(*)(size_t))dlsym(RTLD_NEXT, "malloc");

  return refuses() ? NULL : next(n);
}

void *realloc(void *block, size_t n)
{
  void *(*next)(void *, size_t) =
    (void *(*)(void *, size_t))dlsym(RTLD_NEXT, "realloc");

  return refuses() ? NULL : next(block, n);
}

int main(void)
{
  for (int k = 0; k < 4; k++) {
    char *text = NULL;
    size_t size = 0;
    FILE *to = open_memstream(&text, &size);
    int failed = 0, error, status;

    left = k;
    for (int i = 0; i < 400; i++) failed += fprintf(to, "%0100d", i) < 0;
    error = ferror(to);
    status = fclose(to);
    left = -1;
    printf("request %d: %d failed fprintf, ferror %d, fclose %d, ", k, failed,
           error, status);
    if (text) printf("%zu bytes\n", size);
    else printf("NULL\n");
    free(text);
  }
  return 0;
}
C
gcc -O1 -fno-builtin text.c -o text -ldl
./text | tee seen
diff - seen <<'END' || changed "other output"
request 0: 1 failed fprintf, ferror 0, fclose 0, 39992 bytes
request 1: 1 failed fprintf, ferror 0, fclose 0, 39984 bytes
request 2: 1 failed fprintf, ferror 0, fclose 0, 39968 bytes
request 3: 0 failed fprintf, ferror 0, fclose 0, NULL
END
