/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/common/process.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"
#include "run/common/progress.h"

void vg_words_release(struct vg_words *w)
{
  for (size_t i = 0; i < w->n; i++) free(w->word[i]);
  free(w->word);
  memset(w, 0, sizeof *w);
}

vg_status vg_words_take(struct vg_words *w, char *text, struct vg_error *err)
{
  if (!text || vg_reserve(&w->word, &w->cap, w->n + 2, sizeof *w->word)) {
    free(text);
    return vg_fail_memory(err, "a command line");
  }
  w->word[w->n++] = text;
  w->word[w->n] = NULL;
  return VG_OK;
}

vg_status vg_words_add(struct vg_words *w, const char *text,
                       struct vg_error *err)
{
  return vg_words_take(w, strdup(text), err);
}

vg_status vg_words_pair(struct vg_words *w, const char *name, int64_t v,
                        struct vg_error *err)
{
  char text[32];
  vg_status st = vg_words_add(w, name, err);

  snprintf(text, sizeof text, "%lld", (long long)v);
  return st < 0 ? st : vg_words_add(w, text, err);
}

/* A word of the launcher with its placeholders replaced. */
static char *fill_in(const char *word, size_t len, int ranks, int threads)
{
  char *out = vg_alloc(len * 4 + 32, 1);
  size_t at = 0;

  for (size_t i = 0; out && i < len;) {
    if (len - i >= 7 && !strncmp(word + i, "{ranks}", 7)) {
      at += (size_t)snprintf(out + at, 16, "%d", ranks);
      i += 7;
    } else if (len - i >= 9 && !strncmp(word + i, "{threads}", 9)) {
      at += (size_t)snprintf(out + at, 16, "%d", threads);
      i += 9;
    } else {
      out[at++] = word[i++];
    }
  }
  if (out) out[at] = 0;
  return out;
}

/* Copy the next word of a command, without its quotes, to word[*len]. Returns
 * the end of the word, or NULL if a quote is not closed. */
static const char *take_word(const char *from, char *word, size_t *len)
{
  char quote = 0;

  *len = 0;
  for (; *from && (quote || !isblank((unsigned char)*from)); from++)
    if (*from == quote) quote = 0;
    else if (!quote && (*from == '"' || *from == '\'')) quote = *from;
    else word[(*len)++] = *from;
  return quote ? NULL : from;
}

vg_status vg_words_launcher(struct vg_words *w, const char *launcher, int ranks,
                            int threads, struct vg_error *err)
{
  const char *at = launcher  ? launcher
                 : ranks > 1 ? "mpirun -n {ranks} --bind-to none"
                             : "";
  char *word = strdup(at);
  vg_status st = word ? VG_OK : vg_fail_memory(err, "a command line");

  while (st >= 0 && *(at += strspn(at, " \t"))) {
    size_t len;

    at = take_word(at, word, &len);
    st = at ? vg_words_take(w, fill_in(word, len, ranks, threads), err)
            : vg_fail(err, VG_ERR_INPUT,
                      "a quote in the command %s is not closed", launcher);
  }
  free(word);
  return st;
}

/* Execute the command in the child process, in a process group of its own;
 * never returns. */
static void become(char **word, const char *dir, const int to[2],
                   const sigset_t *mask)
{
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  sigprocmask(SIG_SETMASK, mask, NULL);
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  dup2(to[0], STDOUT_FILENO);
  dup2(to[1], STDERR_FILENO);
  if (dir && chdir(dir)) {
    dprintf(STDERR_FILENO, "cannot enter %s: %s\n", dir, strerror(errno));
    _exit(127);
  }
  execvp(word[0], word);
  dprintf(STDERR_FILENO, "cannot start %s: %s\n", word[0], strerror(errno));
  _exit(127);
}

/* Wait until the child ends. A request to stop is forwarded to its whole group:
 * a script may be waiting for a program of its own. */
static int wait_for(pid_t child, const sigset_t *chld)
{
  const struct timespec pause = { 0, 200000000 };
  int status = 0, signalled = 0;

  for (;;) {
    pid_t got = waitpid(child, &status, WNOHANG);

    if (got == child) break;
    if (got < 0 && errno != EINTR) return 127;
    if (vg_display_interrupted() && !signalled++) kill(-child, SIGTERM);
    sigtimedwait(chld, NULL, &pause);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static int open_log(const char *path, struct vg_error *err)
{
  const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);

  if (fd < 0)
    vg_fail(err, VG_ERR_IO, "%s: cannot write: %s", path, strerror(errno));
  return fd;
}

vg_status vg_words_run(const struct vg_words *w, const char *dir,
                       const char *log, const char *out, int *status,
                       double *wall, struct vg_error *err)
{
  const double start = vg_display_now();
  int to[2] = { -1, -1 };
  sigset_t chld, before;
  pid_t child = -1;
  vg_status st = VG_ERR_IO;

  to[1] = open_log(log, err);
  to[0] = to[1] >= 0 && out ? open_log(out, err) : to[1];
  if (to[0] < 0) goto done;
  sigemptyset(&chld);
  sigaddset(&chld, SIGCHLD);
  sigprocmask(SIG_BLOCK, &chld, &before);
  fflush(NULL);
  child = fork();
  if (child == 0) become(w->word, dir, to, &before);
  if (child > 0) setpgid(child, child); /* whichever of both is first */
  if (child > 0) *status = wait_for(child, &chld);
  sigprocmask(SIG_SETMASK, &before, NULL);
  *wall = vg_display_now() - start;
  st = child > 0 ? VG_OK
                 : vg_fail(err, VG_ERR_IO, "cannot start another process: %s",
                           strerror(errno));
done:
  if (to[0] >= 0 && to[0] != to[1]) close(to[0]);
  if (to[1] >= 0) close(to[1]);
  return st;
}

char *vg_own_path(void)
{
  char path[4096];
  ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);

  if (n <= 0) return strdup("vanguard");
  path[n] = 0;
  return strdup(path);
}

void vg_failure_note(const char *path, char *note, size_t size)
{
  enum { LAST, RULE, FRAMED, OURS } kept = LAST;
  FILE *f = fopen(path, "re");
  char *line = NULL;
  size_t cap = 0;

  snprintf(note, size, "see %.200s", path);
  while (f && getline(&line, &cap, f) > 0) {
    size_t ours = !strncmp(line, "vanguard: ", 10)      ? 10
                : !strncmp(line, "vanguard mesh: ", 15) ? 15
                                                        : 0;

    line[strcspn(line, "\r\n")] = 0;
    if (kept == LAST && !strncmp(line, "-----", 5)) kept = RULE;
    if (!line[strspn(line, " \t-")] || (kept >= FRAMED && !ours)) continue;
    kept = ours ? OURS : kept == RULE ? FRAMED : kept;
    if ((size_t)snprintf(note, size, "%s", line + ours) >= size)
      strcpy(note + size - 4, "...");
  }
  free(line);
  if (f) fclose(f);
}
