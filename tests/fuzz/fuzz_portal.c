/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "fuzz.h"

#include "../cli/portal_support.h"

/* Requests of strangers are refused. Requests with the token (which replaces
 * the word TOKEN in the input) never read or write outside the folder. No
 * process is ever started: there is no room for runs, and no Slurm. */
static struct portal_scene scene;

static int start(void)
{
  struct vg_error err = VG_ERROR_INIT;

  setenv("PATH", "/nowhere", 1);
  if (portal_scene_open(&scene, &err) >= 0) return 1;
  fuzz_expect(err.code == VG_ERR_UNSUPPORTED, err.text);
  return 0;
}

static void stop(void)
{
  portal_scene_close(&scene);
}

/* The input with each TOKEN replaced by the token. */
static char *with_token(const uint8_t *data, size_t size, size_t *n,
                        int *has_token)
{
  static const char word[] = "TOKEN";
  size_t token = strcspn(scene.token, "/"), most = size / 5 * token + size + 1;
  char *out = malloc(most);

  *n = 0;
  *has_token = 0;
  for (size_t i = 0; out && i < size;) {
    if (size - i >= 5 && !memcmp(data + i, word, 5)) {
      memcpy(out + *n, scene.token, token);
      *n += token;
      i += 5;
      *has_token = 1;
    } else {
      out[(*n)++] = (char)data[i++];
    }
  }
  return out;
}

static int count_other(void)
{
  char path[512];
  struct stat s;

  snprintf(path, sizeof path, "%s/other", scene.dir);
  fuzz_expect(!stat(path, &s), "the other folder still exists");
  return (int)s.st_mtim.tv_sec ^ (int)s.st_mtim.tv_nsec;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static int is_open = -1, other;
  size_t n, got;
  int has_token;
  char *request;

  if (is_open < 0) {
    is_open = start();
    if (is_open) other = count_other();
    atexit(stop);
  }
  if (!is_open) return 0;
  request = with_token(data, size, &n, &has_token);
  if (!request) return 0;
  got = portal_ask(&scene, request, n);
  free(request);
  fuzz_expect(!got || !strncmp(scene.answer, "HTTP/1.", 7),
              "an answer is an HTTP response");
  fuzz_expect(has_token || got < 12 || scene.answer[9] == '4' ||
                scene.answer[9] == '5' || scene.answer[9] == '1',
              "requests without the token are refused");
  fuzz_expect(!memmem(scene.answer, got, PORTAL_SECRET,
                      sizeof PORTAL_SECRET - 1),
              "nothing outside the folder is read");
  fuzz_expect(count_other() == other, "nothing outside the folder is written");
  return 0;
}
