#include "core/cdt_tetgen.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>

#define TETLIBRARY
#define terminatetetgen header_terminatetetgen
#include <tetgen.h>
#undef terminatetetgen

/* TetGen 1.5.0 leaves through this function, which frees the mesh and throws;
 * unwinding then destroys the mesh and frees it again. The library calls it
 * through its symbol table, so this definition, found first, takes its place:
 * the destructor alone frees. */
void terminatetetgen(tetgenmesh *, int code);
void terminatetetgen(tetgenmesh *, int code)
{
  throw code;
}

namespace {

std::mutex tetgen_lock;

/* TetGen tells its troubles to the standard output, quiet or not; the library
 * never prints. In force while the lock is held. */
class Silence {
public:
  Silence() : kept(stdout), nowhere(std::fopen("/dev/null", "w"))
  {
    if (nowhere) stdout = nowhere;
  }
  ~Silence()
  {
    stdout = kept;
    if (nowhere) std::fclose(nowhere);
  }
  Silence(const Silence &) = delete;
  Silence &operator=(const Silence &) = delete;

private:
  FILE *kept, *nowhere;
};

void put_points(tetgenio &in, size_t n, const double (*x)[3])
{
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(n);
  in.pointlist = new REAL[3 * n];
  std::memcpy(in.pointlist, x, 3 * n * sizeof(REAL));
}

void put_facets(tetgenio &in, size_t n, const uint32_t (*tri)[3])
{
  in.numberoffacets = static_cast<int>(n);
  in.facetlist = new tetgenio::facet[n];
  for (size_t i = 0; i < n; i++) {
    tetgenio::facet *f = &in.facetlist[i];

    tetgenio::init(f);
    f->numberofpolygons = 1;
    f->polygonlist = new tetgenio::polygon[1];
    tetgenio::init(f->polygonlist);
    f->polygonlist->numberofvertices = 3;
    f->polygonlist->vertexlist = new int[3];
    for (int k = 0; k < 3; k++)
      f->polygonlist->vertexlist[k] = static_cast<int>(tri[i][k]);
  }
}

vg_status take(const tetgenio &out, size_t *n_all, double (**all)[3],
               size_t *n_tet, uint32_t (**tet)[4], struct vg_error *err)
{
  size_t np = static_cast<size_t>(out.numberofpoints);
  size_t nt = static_cast<size_t>(out.numberoftetrahedra);
  double(*x)[3] = static_cast<double(*)[3]>(std::malloc((np + 1) * sizeof *x));
  uint32_t(*c)[4] =
      static_cast<uint32_t(*)[4]>(std::malloc((nt + 1) * sizeof *c));

  if (!x || !c) {
    std::free(x);
    std::free(c);
    return vg_fail_memory(err, "boundary recovery");
  }
  std::memcpy(x, out.pointlist, np * sizeof *x);
  for (size_t i = 0; i < nt; i++)
    for (int k = 0; k < 4; k++)
      c[i][k] = static_cast<uint32_t>(
          out.tetrahedronlist[i * static_cast<size_t>(out.numberofcorners) +
                              static_cast<size_t>(k)]);
  *n_all = np;
  *all = x;
  *n_tet = nt;
  *tet = c;
  return VG_OK;
}

const char *reason(int code)
{
  switch (code) {
  case 1: return "out of memory";
  case 2: return "internal error";
  case 3: return "the surface intersects itself";
  case 4: return "a feature is too small for its arithmetic";
  case 5: return "two facets are closer than its tolerance";
  case 10: return "input refused";
  default: return "unknown error";
  }
}

}  // namespace

extern "C" vg_status vg_cdt_tetgen(size_t n, const double (*x)[3],
                                   size_t n_tri, const uint32_t (*tri)[3],
                                   size_t *n_all, double (**all)[3],
                                   size_t *n_tet, uint32_t (**tet)[4],
                                   struct vg_error *err)
{
  /* p: keep facets; Y: without points on them; c: all of the hull;
   * M: coplanar neighbours stay separate facets; T: relative tolerance of
   * coplanarity, small because our predicates are exact. */
  char switches[] = "pYcMQT1e-13";

  if (n > 100000000 || n_tri > 200000000)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "boundary recovery of %zu points exceeds TetGen's indices",
                   n);
  std::lock_guard<std::mutex> guard(tetgen_lock);
  Silence silence;

  try {
    tetgenio in, out;

    put_points(in, n, x);
    put_facets(in, n_tri, tri);
    tetrahedralize(switches, &in, &out);
    return take(out, n_all, all, n_tet, tet, err);
  } catch (int code) {
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "TetGen could not recover the boundary: %s (code %d)",
                   reason(code), code);
  } catch (const std::bad_alloc &) {
    return vg_fail_memory(err, "boundary recovery");
  }
}
