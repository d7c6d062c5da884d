/* SPDX-License-Identifier: AGPL-3.0-or-later */
/* Boundary recovery with TetGen (H. Si, "TetGen, a Delaunay-based quality
 * tetrahedral mesh generator", ACM TOMS 41(2), 2015). */
#include "tetgen/jobs.h"

#include <cstdlib>
#include <cstring>
#include <new>

#include <dlfcn.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include "common/endless.h"
#include "tetgen/tetgen_input.h"

namespace
{

/* On some input, TetGen loops forever. A job is aborted after this many calls
 * of TetGen's predicates, plus this many per triangle: dozens of times what
 * pockets need. Unlike a time limit, a count of calls gives the same result on
 * any machine. */
const uint64_t call_limit = 20000000, call_limit_per_triangle = 50000; /* K4 */

/* TetGen may also loop forever without calling a predicate. Without calls, its
 * state is compared with earlier ones at these intervals of computing: only a
 * loop that is proven to be endless is aborted (common/endless.h). */
const suseconds_t look_us = 4000;

/* Calls left to the current job, and their number at the last check. */
volatile uint64_t calls_left = UINT64_MAX, calls_seen;

void give_up()
{
  vg_serve_put(VG_HELPER_NONE, 0, 0, 0);
  _exit(1);
}

void count_call()
{
  if (!(calls_left = calls_left - 1)) give_up();
}

void look(int, siginfo_t *, void *context)
{
  if (calls_left == calls_seen) {
    if (vg_endless_look(context)) give_up();
    return;
  }
  calls_seen = calls_left;
  vg_endless_start();
}

#ifndef VG_TETGEN_STATIC
/* TetGen's own function, which ours below replaces. */
template <typename function> function original(const char *name)
{
  void *at = dlsym(RTLD_NEXT, name);

  if (!at) _exit(1);
  return reinterpret_cast<function>(at);
}

#endif

const uint32_t ways = 2; /* number of sets of switches to try */

void give_output(const tetgenio &out, size_t n)
{
  const uint64_t n_added = static_cast<uint64_t>(out.numberofpoints) - n;
  const uint64_t n_tet = static_cast<uint64_t>(out.numberoftetrahedra);
  const itimerval never = {};

  setitimer(ITIMER_VIRTUAL, &never, nullptr); /* one answer only */
  vg_serve_put(VG_HELPER_CELLS, 0, n_added, n_tet);
  vg_serve_put_array(out.pointlist + 3 * n, 3 * n_added * sizeof(REAL));
  vg_serve_put_array(out.tetrahedronlist, 4 * n_tet * sizeof(int));
}

void take_input(tetgenio &in, const vg_serve_surface &s)
{
  vg_tetgen_points(in, s.n_point);
  if (s.n_point) std::memcpy(in.pointlist, s.x, 3 * s.n_point * sizeof(REAL));
  vg_tetgen_triangles(in, s.n_tri,
                      reinterpret_cast<const uint32_t(*)[3]>(s.tri));
}

/* Switches. p: keep facets; Y: add no points on them, in one of two ways; c:
 * keep all cells of the convex hull; M: do not merge coplanar facets; T:
 * relative tolerance of coplanarity, which is small because our predicates are
 * exact.
 *
 * TetGen puts points on edges of facets and moves them off afterwards. If one
 * stays there, or if TetGen ends its process, the other way succeeds in most
 * cases. */
bool run(uint32_t first, const vg_serve_surface &s)
{
  char switches[ways][16] = { "pYcMQT1e-13", "pY/2cMQT1e-13" };
  tetgenio in;

  take_input(in, s);
  for (uint32_t way = first; way < ways; way++) {
    tetgenio out;

    tetrahedralize(switches[way], &in, &out);
    if (out.numberofcorners != 4) return false;
    if (way + 1 == ways || out.numberoftrifaces == in.numberoffacets) {
      give_output(out, s.n_point);
      return true;
    }
  }
  return false;
}

void be_patient(size_t n_tri)
{
  struct sigaction a = {};
  itimerval time = {};

  calls_left = call_limit + call_limit_per_triangle * n_tri;
  calls_seen = 0;
  if (!vg_endless_start()) throw std::bad_alloc();
  a.sa_sigaction = look;
  a.sa_flags = SA_SIGINFO | SA_RESTART;
  sigaction(SIGVTALRM, &a, nullptr);
  time.it_value.tv_usec = look_us;
  time.it_interval = time.it_value;
  setitimer(ITIMER_VIRTUAL, &time, nullptr);
}

} // namespace

bool vg_tetgen_recover(uint32_t way, const vg_serve_surface &s)
{
  be_patient(s.n_tri);
  return run(way, s);
}

/* TetGen calls these functions in place of its own: the dynamic linker prefers
 * symbols of the program, and for a static TetGen the linker option --wrap
 * redirects the calls. */
#ifdef VG_TETGEN_STATIC
extern "C" REAL __real__Z8orient3dPdS_S_S_(REAL *, REAL *, REAL *, REAL *);
extern "C" REAL __real__Z8inspherePdS_S_S_S_(REAL *, REAL *, REAL *, REAL *,
                                             REAL *);
#define ORIENT3D extern "C" REAL __wrap__Z8orient3dPdS_S_S_
#define INSPHERE extern "C" REAL __wrap__Z8inspherePdS_S_S_S_

ORIENT3D(REAL *a, REAL *b, REAL *c, REAL *d)
{
  count_call();
  return __real__Z8orient3dPdS_S_S_(a, b, c, d);
}

INSPHERE(REAL *a, REAL *b, REAL *c, REAL *d, REAL *e)
{
  count_call();
  return __real__Z8inspherePdS_S_S_S_(a, b, c, d, e);
}
#else
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
#endif
