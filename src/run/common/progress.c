/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/common/progress.h"

#include <assert.h>
#include <ftw.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "run/common/log.h"
#include "run/common/text.h"

#define LIVE_EVERY_S 0.2
#define PLAIN_EVERY_S 10.0

/* Signals in quick succession are one request: timeout(1) sends its signal
 * twice, and launchers send it to a process and to its group. */
#define SAME_WISH_MS 1000

static volatile sig_atomic_t interrupted, ends_at_once, shows_line, posted,
  is_urgent;
static atomic_llong interrupted_ms;

/* Called in signal handlers: only async-signal-safe functions. */
static void end_at_once(void)
{
  static const char line[] = "\r\033[K";
  static const char text[] = "vanguard: interrupted; nothing was written\n";
  int failed = shows_line && write(STDERR_FILENO, line, sizeof line - 1) < 0;
  int to_log = vg_log_descriptor();

  if (to_log >= 0) failed |= write(to_log, text, sizeof text - 1) < 0;
  if (!failed) failed = write(STDERR_FILENO, text, sizeof text - 1) < 0;
  _exit(VG_EXIT_FAILED);
}

static long long now_ms(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (long long)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

/* --- a deadline ---------------------------------------------------------- */

/* Held while the output files are moved into place, and while the process
 * ends. */
static pthread_mutex_t ending = PTHREAD_MUTEX_INITIALIZER;
static char temporary[4096];
static double deadline; /* Seconds; 0: none. */
static int is_committed;
static sem_t asked;

static int remove_one(const char *path, const struct stat *info, int type,
                      struct FTW *at)
{
  (void)info, (void)type, (void)at;
  remove(path);
  return 0;
}

/* Waits for the next signal, for at most this many milliseconds. */
static void wait_for_more(long long ms)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  t.tv_sec += (time_t)(ms / 1000);
  t.tv_nsec += (long)(ms % 1000) * 1000000;
  if (t.tv_nsec >= 1000000000) t.tv_sec++, t.tv_nsec -= 1000000000;
  sem_clockwait(&asked, CLOCK_MONOTONIC, &t);
}

/* Other threads continue writing until the process ends, so removing the folder
 * may take several attempts. */
static void *wait_for_deadline(void *unused)
{
  (void)unused;
  while (sem_wait(&asked)) {
  }
  for (long long left;
       !is_urgent &&
       (left = interrupted_ms + (long long)(1000 * deadline) - now_ms()) > 0;)
    wait_for_more(left);
  pthread_mutex_lock(&ending);
  for (int k = 0; k < 3 && !is_committed && *temporary; k++)
    if (nftw(temporary, remove_one, 16, FTW_DEPTH | FTW_PHYS)) break;
  if (!is_committed) end_at_once();
  pthread_mutex_unlock(&ending);
  return NULL;
}

void vg_display_deadline(double seconds)
{
  assert(seconds > 0);
  sigset_t all, before;
  pthread_t thread;

  if (deadline > 0 || sem_init(&asked, 0, 0)) return;
  deadline = seconds;
  sigfillset(&all); /* Signals are handled by other threads. */
  pthread_sigmask(SIG_SETMASK, &all, &before);
  if (pthread_create(&thread, NULL, wait_for_deadline, NULL)) deadline = 0;
  else pthread_detach(thread);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (interrupted && deadline > 0) sem_post(&asked);
}

void vg_display_temporary(const char *dir)
{
  pthread_mutex_lock(&ending);
  snprintf(temporary, sizeof temporary, "%s", dir ? dir : "");
  pthread_mutex_unlock(&ending);
}

void vg_display_commit(void)
{
  pthread_mutex_lock(&ending);
  is_committed = 1;
  pthread_mutex_unlock(&ending);
}

/* --- signals ------------------------------------------------------------- */

static void on_signal(int number)
{
  if (number != SIGUSR1 && deadline > 0 && !posted) {
    posted = 1;
    interrupted_ms = now_ms();
    sem_post(&asked);
  }
  if (!interrupted) {
    interrupted_ms = now_ms();
    interrupted = 1;
    if (ends_at_once) end_at_once();
  } else if (number != SIGUSR1 && now_ms() - interrupted_ms > SAME_WISH_MS) {
    is_urgent = 1;
    if (deadline > 0) sem_post(&asked);
    else end_at_once();
  }
}

void vg_display_end_at_once(int on)
{
  ends_at_once = on;
  if (on && interrupted) end_at_once();
}

int vg_display_interrupted(void)
{
  return interrupted != 0;
}

int vg_display_stop(void *user)
{
  struct vg_display *d = user;

  return interrupted || (d && atomic_load(&d->asked));
}

vg_status vg_display_stopped(struct vg_display *d, struct vg_error *err)
{
  if (!vg_display_stop(d)) return VG_OK;
  return vg_fail(err, VG_ERR_STOPPED, "interrupted; nothing was written");
}

double vg_display_now(void)
{
  return vg_clock();
}

void vg_display_watch(void)
{
  static int watches;
  struct sigaction action, before;

  if (watches++) return;
  memset(&action, 0, sizeof action);
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &action, NULL);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  /* A lost terminal. Under nohup the signal is ignored, and remains so. */
  if (!sigaction(SIGHUP, NULL, &before) && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, NULL);
  /* A file that exceeds ulimit -f is a write error like any other. */
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, NULL);
}

void vg_display_init(struct vg_display *d, int quiet)
{
  memset(d, 0, sizeof *d);
  d->quiet = quiet;
  d->logs = vg_log() != NULL;
  d->start = vg_display_now();
  d->every = PLAIN_EVERY_S;
  d->live = !quiet && isatty(STDERR_FILENO);
  shows_line = d->live;
  vg_display_watch();
}

void vg_display_clear(struct vg_display *d)
{
  if (!d->open) return;
  fputs("\r\033[K", stderr);
  d->open = 0;
}

/* "3 s", "2 min 10 s", "1 h 05 min". */
static void duration(double s, char *text, size_t size)
{
  unsigned long t = s > 0 ? (unsigned long)(s + 0.5) : 0;

  if (t < 60) snprintf(text, size, "%lu s", t);
  else if (t < 3600) snprintf(text, size, "%lu min %02lu s", t / 60, t % 60);
  else snprintf(text, size, "%lu h %02lu min", t / 3600, t / 60 % 60);
}

/* The progress line of a stage. */
static void describe(const struct vg_display *d, double now, char line[160])
{
  char count[32], of[32], rate_text[32], eta[32];
  size_t done = d->done, expected = d->expected, size = 160;
  double elapsed = now - d->stage_start;
  double rate = elapsed > 0 ? (double)done / elapsed : 0;
  int n = snprintf(line, size, done || expected ? "%-24s" : "%s", d->stage);

  if (done || expected)
    n += snprintf(line + n, size - (size_t)n, " %12s",
                  vg_text_count(done, count));
  if (expected)
    n += snprintf(line + n, size - (size_t)n, " of ~%s  %3.0f%%",
                  vg_text_count(expected, of),
                  done < expected ? 100.0 * (double)done / (double)expected
                                  : 100.0);
  if (done && elapsed > 0.5) {
    n += snprintf(line + n, size - (size_t)n, "  %s/s",
                  vg_text_count((unsigned long long)rate, rate_text));
    if (expected > done && rate > 0) {
      duration((double)(expected - done) / rate, eta, sizeof eta);
      snprintf(line + n, size - (size_t)n, "  ETA %s", eta);
    }
  }
}

static void show(struct vg_display *d, double now)
{
  char line[160];

  describe(d, now, line);
  if (d->live) fprintf(stderr, "\r\033[K%s", line);
  else fprintf(stderr, "%s\n", line);
  fflush(stderr);
  d->open = d->live;
  d->last_shown = now;
}

static void log_line(struct vg_display *d, double now)
{
  char line[160];

  describe(d, now, line);
  fprintf(vg_log(), "%9.2f s  %s\n", now - d->start, line);
  d->last_logged = now;
  d->logged = d->done;
}

/* Estimates grow while work proceeds, and finished work may be discarded;
 * neither the count nor the share of a stage decreases. Returns 1 for a change
 * to show at once: a new stage, or its first count. */
static int move_on(struct vg_display *d, const char *stage, size_t done,
                   size_t expected, double now)
{
  int is_new = strncmp(stage, d->stage, sizeof d->stage - 1) != 0, tells;
  double share;

  if (is_new) {
    snprintf(d->stage, sizeof d->stage, "%s", stage);
    d->stage_start = now;
    d->done = d->expected = d->logged = 0;
    d->share = 0;
  }
  tells = is_new || (!d->done && !d->expected && (done || expected));
  if (done > d->done) d->done = done;
  d->expected = expected > d->done || !expected ? expected : d->done;
  if (!d->expected) return tells;
  share = (double)d->done / (double)d->expected;
  if (share >= d->share) d->share = share;
  else d->expected = (size_t)((double)d->done / d->share);
  return tells;
}

void vg_display_update(void *user, const char *stage, size_t done,
                       size_t expected)
{
  struct vg_display *d = user;
  double now = vg_display_now(), every = d->live ? LIVE_EVERY_S : d->every;
  int tells;

  assert(d && stage);
  if (d->logs && d->done > d->logged && strcmp(stage, d->stage) != 0)
    log_line(d, now);
  tells = move_on(d, stage, done, expected, now);

  if (d->tell && d->tell(d->user, stage, d->done, d->expected))
    atomic_store(&d->asked, 1);
  if (!d->quiet && (tells || now - d->last_shown > every)) show(d, now);
  if (d->logs && (tells || now - d->last_logged > PLAIN_EVERY_S))
    log_line(d, now);
}
