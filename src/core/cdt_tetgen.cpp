#include "core/cdt_tetgen.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define TETLIBRARY
#include <tetgen.h>

namespace {

/* On some input TetGen turns in circles. A job is given up after this time on
 * the processor, milliseconds and so many more for each triangle: hundreds
 * of times what pockets need, so that the outcome is the same everywhere. */
const size_t patience = 2000, patience_each = 5;

struct answer {              /* on the pipe, before points and tetrahedra */
  uint64_t ok, n_added, n_tet;
};

/* --- in the child -------------------------------------------------------- */

void put(int to, const void *data, size_t size)
{
  const char *at = static_cast<const char *>(data);

  while (size) {
    ssize_t n = write(to, at, size);

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(1);
    at += n;
    size -= static_cast<size_t>(n);
  }
}

void take_input(tetgenio &in, const vg_cdt_job &job)
{
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(job.n);
  in.pointlist = new REAL[3 * job.n];
  std::memcpy(in.pointlist, job.x, 3 * job.n * sizeof(REAL));
  in.numberoffacets = static_cast<int>(job.n_tri);
  in.facetlist = new tetgenio::facet[job.n_tri];
  for (size_t i = 0; i < job.n_tri; i++) {
    tetgenio::facet *f = &in.facetlist[i];

    tetgenio::init(f);
    f->numberofpolygons = 1;
    f->polygonlist = new tetgenio::polygon[1];
    tetgenio::init(f->polygonlist);
    f->polygonlist->numberofvertices = 3;
    f->polygonlist->vertexlist = new int[3];
    for (int k = 0; k < 3; k++)
      f->polygonlist->vertexlist[k] = static_cast<int>(job.tri[i][k]);
  }
}

void run(const vg_cdt_job &job, int to)
{
  /* p: keep facets; Y: without points on them; c: all of the hull;
   * M: coplanar neighbours stay separate facets; T: relative tolerance of
   * coplanarity, small because our predicates are exact. */
  char switches[] = "pYcMQT1e-13";
  tetgenio in, out;
  answer a = {1, 0, 0};

  take_input(in, job);
  tetrahedralize(switches, &in, &out);
  a.n_added = static_cast<uint64_t>(out.numberofpoints) - job.n;
  a.n_tet = static_cast<uint64_t>(out.numberoftetrahedra);
  put(to, &a, sizeof a);
  put(to, out.pointlist + 3 * job.n, 3 * a.n_added * sizeof(REAL));
  for (uint64_t i = 0; i < a.n_tet; i++)
    put(to, out.tetrahedronlist +
                i * static_cast<uint64_t>(out.numberofcorners),
        4 * sizeof(int));
}

void be_patient(size_t n_tri)
{
  size_t limit = patience + patience_each * n_tri;
  itimerval time = {};

  time.it_value.tv_sec = static_cast<time_t>(limit / 1000);
  time.it_value.tv_usec = static_cast<suseconds_t>(limit % 1000 * 1000);
  setitimer(ITIMER_PROF, &time, nullptr);
}

[[noreturn]] void child(size_t n_job, const vg_cdt_job *job, int to)
{
  rlimit none = {0, 0};
  int nowhere = open("/dev/null", O_WRONLY);

  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setrlimit(RLIMIT_CORE, &none);
  signal(SIGSEGV, SIG_DFL);
  signal(SIGABRT, SIG_DFL);
  signal(SIGPROF, SIG_DFL);
  signal(SIGINT, SIG_IGN);   /* the parent decides */
  for (size_t k = 0; k < n_job; k++) {
    be_patient(job[k].n_tri);
    try {
      run(job[k], to);
    } catch (...) {
      _exit(1);
    }
  }
  _exit(0);
}

/* --- in the parent ------------------------------------------------------- */

bool get(int from, void *data, size_t size)
{
  char *at = static_cast<char *>(data);

  while (size) {
    ssize_t n = read(from, at, size);

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<size_t>(n);
  }
  return true;
}

/* One answer; false when the child is gone. */
bool receive(vg_cdt_job &job, int from)
{
  answer a;

  if (!get(from, &a, sizeof a) || !a.ok) return false;
  job.n_all = job.n + a.n_added;
  job.n_tet = a.n_tet;
  job.all = static_cast<double(*)[3]>(
      std::malloc((job.n_all + 1) * sizeof *job.all));
  job.tet = static_cast<uint32_t(*)[4]>(
      std::malloc((job.n_tet + 1) * sizeof *job.tet));
  if (job.all && job.tet) {
    std::memcpy(job.all, job.x, job.n * sizeof *job.all);
    if (get(from, job.all + job.n, a.n_added * sizeof *job.all) &&
        get(from, job.tet, a.n_tet * sizeof *job.tet)) {
      job.st = VG_OK;
      return true;
    }
  }
  std::free(job.all);
  std::free(job.tet);
  job.all = nullptr;
  job.tet = nullptr;
  return false;
}

/* A child works through the jobs until one ends it. Returns how many were
 * answered, or a negative status. */
long run_child(size_t n_job, vg_cdt_job *job)
{
  int ends[2], state;
  long done = 0;
  pid_t pid;

  if (pipe2(ends, O_CLOEXEC)) return VG_ERR_MEMORY;
  pid = fork();
  if (pid == 0) {
    close(ends[0]);
    child(n_job, job, ends[1]);
  }
  close(ends[1]);
  if (pid > 0) {
    while (static_cast<size_t>(done) < n_job && receive(job[done], ends[0]))
      done++;
  }
  close(ends[0]);
  if (pid < 0) return VG_ERR_MEMORY;
  while (waitpid(pid, &state, 0) < 0 && errno == EINTR) {
  }
  return done;
}

}  // namespace

extern "C" vg_status vg_cdt_tetgen(size_t n_job, struct vg_cdt_job *job,
                                   struct vg_error *err)
{
  size_t next = 0;

  for (size_t k = 0; k < n_job; k++) {
    job[k].st = VG_ERR_GEOMETRY;
    job[k].n_all = job[k].n_tet = 0;
    job[k].all = nullptr;
    job[k].tet = nullptr;
    if (job[k].n > 100000000 || job[k].n_tri > 200000000)
      return vg_fail(err, VG_ERR_UNSUPPORTED, "boundary recovery of %zu points "
                     "exceeds TetGen's indices", job[k].n);
  }
  while (next < n_job) {
    long done = run_child(n_job - next, job + next);

    if (done < 0) return vg_fail_memory(err, "a process for TetGen");
    next += static_cast<size_t>(done) + 1;  /* past the one that failed */
  }
  return VG_OK;
}
