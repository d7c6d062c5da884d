#include "cli/common/cli.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/common/log.h"

int vg_cli_exit(const struct vg_error *err)
{
  return err->code == VG_ERR_USAGE ? VG_EXIT_USAGE : VG_EXIT_FAILED;
}

int vg_cli_fail(const struct vg_error *err)
{
  fflush(stdout);
  fprintf(stderr, "vanguard: %s\n", err->text);
  if (vg_log()) fprintf(vg_log(), "vanguard: %s\n", err->text);
  return vg_cli_exit(err);
}

/* errno says why not. */
static int is_folder(const char *path)
{
  struct stat s;

  if (stat(path, &s)) return 0;
  errno = ENOTDIR;
  return S_ISDIR(s.st_mode);
}

vg_status vg_cli_make_folder(const char *path, struct vg_error *err)
{
  char *part = strdup(path);
  vg_status st = part ? VG_OK : vg_fail_memory(err, "a path");

  for (char *end = part; st >= 0 && *end; ) {
    char kept;

    while (*end == '/') end++;
    while (*end && *end != '/') end++;
    kept = *end;
    *end = 0;
    if (mkdir(part, 0777) && (errno != EEXIST || !is_folder(part)))
      st = vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", part,
                   strerror(errno));
    *end = kept;
  }
  free(part);
  return st;
}

char *vg_cli_count(unsigned long long n, char *text)
{
  char digits[24];
  int len = snprintf(digits, sizeof digits, "%llu", n), at = 0;

  for (int i = 0; i < len; i++) {
    if (i && (len - i) % 3 == 0) text[at++] = ',';
    text[at++] = digits[i];
  }
  text[at] = 0;
  return text;
}
