#include "core/recover/cdt_tetgen.h"

#include <cstdlib>
#include <cstring>
#include <vector>

#include <dlfcn.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include "base/child.h"
#include "core/recover/tetgen_input.h"

namespace
{

/* On some input, TetGen loops forever. A job is aborted after this many calls
 * of TetGen's predicates, plus this many per triangle: dozens of times what
 * pockets need. Unlike a time limit, a count of calls gives the same result on
 * any machine. */
const uint64_t call_limit = 20000000, call_limit_per_triangle = 50000; /* K4 */

/* TetGen may also loop forever without calling a predicate. A job is therefore
 * aborted, too, if it uses this many seconds of processor time, plus this many
 * per triangle, without a call. Otherwise there are millions of calls per
 * second, so the clock only stops jobs that would never end. */
const double silence = 2, silence_each = 1e-4;

/* Calls left to the current job, and their number at the last check. Only used
 * in the child. */
volatile uint64_t calls_left = UINT64_MAX, calls_seen;

void count_call()
{
  if (!(calls_left = calls_left - 1)) _exit(1);
}

void look(int)
{
  if (calls_left == calls_seen) _exit(1);
  calls_seen = calls_left;
}

/* TetGen's own function, which ours below replaces. */
template <typename function> function original(const char *name)
{
  void *at = dlsym(RTLD_NEXT, name);

  if (!at) _exit(1);
  return reinterpret_cast<function>(at);
}

/* Messages on the socket, in the byte order of the machine: */
struct question {         /* followed by x and tri */
  uint64_t n, n_tri, way; /* way: first of the ways below to try */
};
struct answer { /* followed by the added points and the tetrahedra */
  uint64_t n_added, n_tet;
};

const uint64_t n_max = 1u << 31; /* TetGen's indices are int */

const uint64_t ways = 2; /* number of sets of switches to try */

/* --- in the child --------------------------------------------------------- */

bool take_input(tetgenio &in, const question &q, int from)
{
  std::vector<uint32_t> tri(3 * q.n_tri);

  vg_tetgen_points(in, q.n);
  if (!vg_child_get(from, in.pointlist, 3 * q.n * sizeof(REAL)) ||
      !vg_child_get(from, tri.data(), tri.size() * sizeof tri[0]))
    return false;
  vg_tetgen_triangles(in, q.n_tri,
                      reinterpret_cast<const uint32_t(*)[3]>(tri.data()));
  return true;
}

bool give_output(const tetgenio &out, const question &q, int to)
{
  answer a;

  a.n_added = static_cast<uint64_t>(out.numberofpoints) - q.n;
  a.n_tet = static_cast<uint64_t>(out.numberoftetrahedra);
  return vg_child_put(to, &a, sizeof a) &&
         vg_child_put(to, out.pointlist + 3 * q.n,
                      3 * a.n_added * sizeof(REAL)) &&
         vg_child_put(to, out.tetrahedronlist, 4 * a.n_tet * sizeof(int));
}

/* Switches. p: keep facets; Y: add no points on them, in one of two ways; c:
 * keep all cells of the convex hull; M: do not merge coplanar facets; T:
 * relative tolerance of coplanarity, which is small because our predicates are
 * exact.
 *
 * TetGen puts points on edges of facets and moves them off afterwards. If one
 * stays there, or if TetGen ends its process, the other way succeeds in most
 * cases. */
bool run(const question &q, int fd)
{
  char switches[ways][16] = { "pYcMQT1e-13", "pY/2cMQT1e-13" };
  tetgenio in;

  if (!take_input(in, q, fd)) return false;
  for (uint64_t way = q.way; way < ways; way++) {
    tetgenio out;

    tetrahedralize(switches[way], &in, &out);
    if (out.numberofcorners != 4) return false;
    if (way + 1 == ways || out.numberoftrifaces == in.numberoffacets)
      return give_output(out, q, fd);
  }
  return false;
}

void be_patient(size_t n_tri)
{
  itimerval time = {};

  calls_left = call_limit + call_limit_per_triangle * n_tri;
  calls_seen = 0;
  signal(SIGPROF, look);
  time.it_value.tv_sec = static_cast<time_t>(
    silence + silence_each * static_cast<double>(n_tri));
  time.it_interval = time.it_value;
  setitimer(ITIMER_PROF, &time, nullptr);
}

/* --- in the parent -------------------------------------------------------- */

bool ask(const vg_cdt_job &job, uint64_t way, int to)
{
  question q = { job.n, job.n_tri, way };

  return vg_child_put(to, &q, sizeof q) &&
         vg_child_put(to, job.x, job.n * sizeof *job.x) &&
         vg_child_put(to, job.tri, job.n_tri * sizeof *job.tri);
}

/* Receive one answer. Returns false if the child has ended. */
bool receive(vg_cdt_job &job, int from)
{
  answer a;

  if (!vg_child_get(from, &a, sizeof a)) return false;
  if (a.n_added > n_max || a.n_tet > n_max) return false;
  job.n_all = job.n + a.n_added;
  job.n_tet = a.n_tet;
  job.all = static_cast<double(*)[3]>(
    std::malloc((job.n_all + 1) * sizeof *job.all));
  job.tet = static_cast<uint32_t(*)[4]>(
    std::malloc((job.n_tet + 1) * sizeof *job.tet));
  if (job.all && job.tet) {
    std::memcpy(job.all, job.x, job.n * sizeof *job.all);
    if (vg_child_get(from, job.all + job.n, a.n_added * sizeof *job.all) &&
        vg_child_get(from, job.tet, a.n_tet * sizeof *job.tet)) {
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

/* Main loop of a child: reads jobs and writes answers. */
void serve(int fd)
{
  question q;

  while (vg_child_get(fd, &q, sizeof q)) {
    be_patient(q.n_tri);
    try {
      if (!run(q, fd)) _exit(1);
    } catch (...) {
      _exit(1);
    }
  }
  _exit(0);
}

/* Start a child that works through the jobs until one of them ends it. Returns
 * the number of jobs that need not be tried again in this way, or a negative
 * status. */
long run_child(size_t n_job, vg_cdt_job *job, uint64_t way)
{
  struct vg_child c;
  long done = 0, n = static_cast<long>(n_job);

  if (vg_child_open(serve, &c) < 0) return VG_ERR_MEMORY;
  while (done < n && ask(job[done], way, c.fd) && receive(job[done], c.fd))
    done++;
  /* The job is at fault, unless the child ended with its server. */
  if (done < n && (c.pid || vg_child_server_is_alive())) done++;
  vg_child_close(&c);
  return done;
}

} // namespace

/* The dynamic linker uses these functions in place of TetGen's. */
REAL orient3d(REAL *a, REAL *b, REAL *c, REAL *d)
{
  static const auto real = original<REAL (*)(REAL *, REAL *, REAL *, REAL *)>(
    "_Z8orient3dPdS_S_S_");

  count_call();
  return real(a, b, c, d);
}

REAL insphere(REAL *a, REAL *b, REAL *c, REAL *d, REAL *e)
{
  static const auto real = original<REAL (*)(REAL *, REAL *, REAL *, REAL *,
                                             REAL *)>("_Z8inspherePdS_S_S_S_");

  count_call();
  return real(a, b, c, d, e);
}

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
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "boundary recovery of %zu points "
                     "exceeds the range of TetGen's indices",
                     job[k].n);
  }
  while (next < n_job) {
    long done = run_child(n_job - next, job + next, 0);

    if (done < 0) return vg_fail_memory(err, "a process for TetGen");
    next += static_cast<size_t>(done);
  }
  for (size_t k = 0; k < n_job;) {
    long done = job[k].st == VG_OK ? 1 : run_child(1, job + k, ways - 1);

    if (done < 0) return vg_fail_memory(err, "a process for TetGen");
    k += static_cast<size_t>(done);
  }
  return VG_OK;
}

extern "C" void vg_library_tetgen(struct vg_library *out)
{
  out->name = "TetGen";
  std::strcpy(out->version, "1.5"); /* tetgen.h has no constant for the
                                       version */
}
