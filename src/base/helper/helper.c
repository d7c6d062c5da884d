/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "base/helper/helper.h"

#include <assert.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/parallel.h"

#define START_SECONDS                                                          \
  60 /* limit for the first message, on slow file systems                      \
      */
#define VARIABLE "VANGUARD_HELPERS"
#define PAUSE_SECONDS 1 /* before a repetition */

static const struct {
  const char *name, *holds, *package, *option;
} helper_names[VG_HELPER_N] = {
  { "vanguard-tetgen", "TetGen", "libtet1.5-dev", "VG_TETGEN" },
  { "vanguard-wrap", "CGAL", "libcgal-dev", "VG_WRAP" },
};

/* A folder in which helpers were searched, and those that were found. Folders
 * are never forgotten, so that threads can refer to them (vg_thread_data). */
struct place {
  struct place *next;
  char folder[4096]; /* "": the default search */
  struct vg_helper found[VG_HELPER_N];
  int is_known[VG_HELPER_N];
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct place anywhere; /* also the first of the list */

/* The place of the calling thread. */
static struct place *here(void)
{
  struct place *p = vg_thread_data();

  return p ? p : &anywhere;
}

/* --- in the child --------------------------------------------------------- */

struct program {
  char path[4096];
};

/* A child body: receives the path of a program and becomes that program. */
static void become(int fd)
{
  static struct program p;

  if (!vg_child_get(fd, &p, sizeof p)) _exit(1);
  p.path[sizeof p.path - 1] = 0;
  for (int k = 0; k < 2; k++) {
    if (fd != k && dup2(fd, k) < 0) _exit(1);
    if (fd == k) fcntl(fd, F_SETFD, 0);
  }
  execl(p.path, p.path, "--serve", (char *)NULL);
  _exit(127);
}

/* --- starting ------------------------------------------------------------- */

static int is_text(const char *text, size_t size)
{
  size_t n = strnlen(text, size);

  for (size_t i = 0; i < n; i++)
    if (text[i] < ' ' || text[i] > '~') return 0;
  return n > 0 && n < size;
}

const char *vg_helper_hello_wrong(const struct vg_helper_hello *h,
                                  const char *name)
{
  if (memcmp(h->magic, VG_HELPER_MAGIC, sizeof h->magic) != 0)
    return "it is not a helper program of Vanguard";
  if (h->order != VG_HELPER_ORDER) return "it has another byte order";
  if (h->format != VG_HELPER_FORMAT)
    return "it has another version of the message format; install the helpers "
           "of this version of Vanguard";
  if (!is_text(h->name, sizeof h->name) || strcmp(h->name, name) != 0)
    return "it is another helper program";
  if (!is_text(h->library, sizeof h->library) ||
      !is_text(h->source, sizeof h->source))
    return "its first message is damaged";
  return NULL;
}

/* Start a program and read its first message. Returns NULL, or what is wrong.
 * The child is closed on failure. */
static const char *start_once(const char *path, const char *name,
                              const struct vg_stop *stop, struct vg_child *c,
                              struct vg_link *l, struct vg_helper_hello *hello)
{
  struct program p = { "" };
  const char *wrong;

  snprintf(p.path, sizeof p.path, "%s", path);
  *l = (struct vg_link){ .state = VG_LINK_NO_MEMORY };
  if (vg_child_open(become, c) < 0) return "the system refuses another process";
  *l = (struct vg_link){ .fd = c->fd, .silence = START_SECONDS, .stop = stop };
  if (vg_link_put(l, &p, sizeof p) && vg_link_get(l, hello, sizeof *hello))
    wrong = vg_helper_hello_wrong(hello, name);
  else if (l->state == VG_LINK_SILENT)
    wrong = "it did not report itself within a minute";
  else wrong = "it ended when it was started; run it to see the reason";
  if (wrong) vg_helper_close(c);
  return wrong;
}

static const char *start(const char *path, const char *name,
                         const struct vg_stop *stop, struct vg_child *c,
                         struct vg_link *l, struct vg_helper_hello *hello)
{
  const struct timespec pause = { PAUSE_SECONDS, 0 };
  const char *wrong = start_once(path, name, stop, c, l, hello);

  if (!wrong || l->state == VG_LINK_OPEN || vg_stops(stop)) return wrong;
  nanosleep(&pause, NULL);
  return start_once(path, name, stop, c, l, hello);
}

static void identify(const struct vg_helper_hello *hello, struct vg_helper *h)
{
  snprintf(h->library, sizeof h->library, "%s", hello->library);
  snprintf(h->identity, sizeof h->identity, "%s, %s %.16s, format %d",
           hello->library, hello->name, hello->source, VG_HELPER_FORMAT);
}

/* --- searching ------------------------------------------------------------ */

/* Folder of the file that contains this code: the program or libvanguard. */
static int own_folder(char *out, size_t size)
{
  static const char mark = 0;
  Dl_info info;
  char full[PATH_MAX], *path = NULL, *slash;

  /* Without memory of the heap: a helper is not absent because memory is. */
  if (dladdr(&mark, &info) && info.dli_fname && strstr(info.dli_fname, ".so"))
    path = realpath(info.dli_fname, full);
  if (!path) path = realpath("/proc/self/exe", full);
  slash = path ? strrchr(path, '/') : NULL;
  if (slash) snprintf(out, size, "%.*s", (int)(slash - path), path);
  return slash != NULL;
}

/* A link that leads nowhere counts as a file. */
static int try_folder(const char *in, const char *below, struct vg_helper *h)
{
  struct stat s;
  int n = snprintf(h->path, sizeof h->path, "%s%s%s/%s", in, *below ? "/" : "",
                   below, h->name);

  if (n > 0 && (size_t)n < sizeof h->path &&
      (!lstat(h->path, &s) || (errno != ENOENT && errno != ENOTDIR)))
    return 1;
  *h->path = 0;
  return 0;
}

/* Find the file of a helper. */
static int find_file(const char *folder, struct vg_helper *h,
                     const char *package, const char *option)
{
  static const char *const below[] = { "", VG_LIBEXEC_FROM_BIN,
                                       VG_LIBEXEC_FROM_LIB, "../bin" };
  const char *given = *folder ? folder : getenv(VARIABLE);
  char own[4096];

  if (given && *given) {
    if (try_folder(given, "", h)) return 1;
    snprintf(h->why, sizeof h->why,
             "%s, the helper program with %s, is not in the folder %.500s that "
             "%s names",
             h->name, h->holds, given, *folder ? "--helpers" : VARIABLE);
    return 0;
  }
  for (size_t k = 0;
       own_folder(own, sizeof own) && k < sizeof below / sizeof *below; k++)
    if (try_folder(own, below[k], h)) return 1;
  snprintf(
    h->why, sizeof h->why,
    "%s, the helper program with %s, was not found; install it, name its "
    "folder with --helpers, or build Vanguard with it (Debian's %s, CMake "
    "option %s)",
    h->name, h->holds, package, option);
  return 0;
}

static void search(const char *folder, enum vg_helper_kind kind,
                   struct vg_helper *h)
{
  struct vg_helper_hello hello;
  struct vg_child c;
  struct vg_link l;
  const char *wrong;

  memset(h, 0, sizeof *h);
  h->name = helper_names[kind].name;
  h->holds = helper_names[kind].holds;
  snprintf(h->identity, sizeof h->identity, "none");
  if (!find_file(folder, h, helper_names[kind].package,
                 helper_names[kind].option))
    return;
  wrong = access(h->path, X_OK) ? "this user must not execute it"
                                : start(h->path, h->name, NULL, &c, &l, &hello);
  if (wrong) {
    h->is_unusable = 1;
    snprintf(h->why, sizeof h->why,
             "%s, the helper program with %s, is installed but cannot be used: "
             "%.600s: %s. Repair it, or remove it to run without it",
             h->name, h->holds, h->path, wrong);
    *h->path = 0;
    return;
  }
  vg_helper_close(&c);
  identify(&hello, h);
  h->is_found = 1;
}

void vg_helper_set_folder(const char *to)
{
  struct place *p = &anywhere;

  assert(to);
  if (!strcmp(here()->folder, to)) return;
  pthread_mutex_lock(&lock);
  while (strncmp(p->folder, to, sizeof p->folder - 1) != 0 && p->next)
    p = p->next;
  if (strncmp(p->folder, to, sizeof p->folder - 1) != 0) {
    p->next = calloc(1, sizeof *p);
    if (p->next) p = p->next;
    snprintf(p->folder, sizeof p->folder, "%s", to);
  }
  memset(p->is_known, 0, sizeof p->is_known);
  pthread_mutex_unlock(&lock);
  vg_thread_data_set(p);
}

const char *vg_helper_name(enum vg_helper_kind kind)
{
  assert(kind < VG_HELPER_N);
  return helper_names[kind].name;
}

void vg_helper_find(enum vg_helper_kind kind, struct vg_helper *out)
{
  struct place *p = here();

  assert(kind < VG_HELPER_N && out);
  pthread_mutex_lock(&lock);
  if (!p->is_known[kind]) search(p->folder, kind, &p->found[kind]);
  p->is_known[kind] = !p->found[kind].is_unusable;
  *out = p->found[kind];
  pthread_mutex_unlock(&lock);
}

/* --- for the users of helpers --------------------------------------------- */

vg_status vg_helper_open(enum vg_helper_kind kind, const struct vg_stop *stop,
                         double silence, struct vg_child *child,
                         struct vg_link *link, struct vg_error *err)
{
  struct vg_helper h, now;
  struct vg_helper_hello hello;
  const char *wrong = NULL;

  assert(child && link && silence > 0);
  vg_helper_find(kind, &h);
  if (!h.is_found)
    return vg_fail(err, h.is_unusable ? VG_ERR_IO : VG_ERR_UNSUPPORTED, "%s",
                   h.why);
  wrong = start(h.path, h.name, stop, child, link, &hello);
  if (wrong && vg_stops(stop)) return vg_stopped(stop, err);
  if (wrong)
    return vg_fail(err, VG_ERR_IO, "%s no longer starts: %s", h.path, wrong);
  identify(&hello, &now);
  if (strcmp(now.identity, h.identity) != 0) {
    vg_helper_close(child);
    return vg_fail(err, VG_ERR_IO,
                   "%s was replaced during the run: it was %s "
                   "and is %s",
                   h.path, h.identity, now.identity);
  }
  link->silence = silence;
  return VG_OK;
}

vg_status vg_helper_lost(const struct vg_link *l, uint32_t cause,
                         const char *who, struct vg_error *err)
{
  static const char *const less =
    "use fewer ranks or threads per node, or smaller subdomains (leaf_cells)";

  assert(l && who);
  if (l->state == VG_LINK_STOPPED) return vg_stopped(l->stop, err);
  if (l->state == VG_LINK_NO_MEMORY)
    return vg_fail_memory(err, "the answer of a helper program");
  if (l->state == VG_LINK_SILENT)
    return vg_fail(err, VG_ERR_IO,
                   "%s sent nothing for %g seconds and was ended", who,
                   l->silence);
  if (l->state == VG_LINK_ENDED)
    return vg_fail(err, VG_ERR_IO,
                   "%s ended without an answer. If it was killed for "
                   "lack of memory (see dmesg), %s",
                   who, less);
  if (cause == VG_HELPER_NO_MEMORY)
    return vg_fail(err, VG_ERR_MEMORY, "%s was refused memory; %s", who, less);
  if (cause == VG_HELPER_TIME)
    return vg_fail(err, VG_ERR_IO,
                   "%s reached its limit of processor time; select "
                   "another mesher",
                   who);
  return vg_fail(err, VG_ERR_IO,
                 "%s sent an answer that this program does not know", who);
}

static int is_of_machine(vg_status st)
{
  return st == VG_ERR_IO || st == VG_ERR_MEMORY;
}

vg_status vg_helper_repeat(vg_helper_attempt *attempt, void *user,
                           const struct vg_stop *stop, struct vg_error *err)
{
  static pthread_mutex_t alone = PTHREAD_MUTEX_INITIALIZER;
  const struct timespec pause = { PAUSE_SECONDS, 0 };
  vg_status st = attempt(user, err);

  if (!is_of_machine(st) || vg_stops(stop)) return st;
  pthread_mutex_lock(&alone);
  nanosleep(&pause, NULL);
  st = attempt(user, err);
  pthread_mutex_unlock(&alone);
  return st;
}

/* A helper ends when its socket is closed. A process of our own is killed,
 * because it may hang and we wait for its end. */
void vg_helper_close(struct vg_child *child)
{
  if (child->pid > 0) kill(child->pid, SIGKILL);
  vg_child_close(child);
}
