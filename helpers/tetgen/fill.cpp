/* SPDX-License-Identifier: AGPL-3.0-or-later */
/* TetGen as a mesher of whole voids (H. Si, "TetGen, a Delaunay-based quality
 * tetrahedral mesh generator", ACM TOMS 41(2), 2015). */
#include "tetgen/jobs.h"

#include <cmath>
#include <cstdlib>
#include <vector>

#include <sys/time.h>
#include <unistd.h>

#include "core/mesher/mesher_parts.h"
#include "tetgen/tetgen_input.h"

namespace
{

/* A cell is split if its volume exceeds this multiple of that of a regular
 * cell with the target edge length at its centroid. This gives about the same
 * number of cells as our own kernel. */
const double largest = 1.3; /* K32 */

const vg_mesher_sizes *sizes;

bool is_too_large(REAL *a, REAL *b, REAL *c, REAL *d, REAL *, REAL)
{
  double x[1][3], u[3], v[3], w[3], h, volume;

  for (int k = 0; k < 3; k++) {
    x[0][k] = (a[k] + b[k] + c[k] + d[k]) / 4;
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = d[k] - a[k];
  }
  sizes->at(sizes->user, 1, x, &h);
  volume = std::fabs(u[0] * (v[1] * w[2] - v[2] * w[1]) +
                     u[1] * (v[2] * w[0] - v[0] * w[2]) +
                     u[2] * (v[0] * w[1] - v[1] * w[0])) /
           6;
  return volume > largest * h * h * h / (6 * std::sqrt(2.0));
}

/* If the point of a hole misses its hollow, cells are made there or are missing
 * in the void; the check of the result by the program detects both. */
void put_holes(tetgenio &in, const vg_serve_surface &s)
{
  in.numberofholes = static_cast<int>(s.n_more);
  if (!s.n_more) return;
  in.holelist = new REAL[3 * s.n_more];
  for (size_t i = 0; i < 3 * s.n_more; i++)
    in.holelist[i] = s.more[i / 3][i % 3];
}

void put_front(tetgenio &in, const vg_mesher_front &f)
{
  vg_tetgen_points(in, f.n_point);
  for (size_t i = 0; i < f.n_point; i++)
    for (int k = 0; k < 3; k++) in.pointlist[3 * i + k] = f.x[i][k];
  vg_tetgen_triangles(in, f.n_face, f.face);
  in.tetunsuitable = is_too_large;
}

/* The cells that are connected to the inner side of a face of the front, from
 * neighbour to neighbour. All other cells are in hollows. */
class inside
{
public:
  inside(const tetgenio &out, const vg_mesher_front &f)
      : io(out), is_in(static_cast<size_t>(out.numberoftetrahedra))
  {
    mark_front(f);
    for (size_t c = 0; c < is_in.size(); c++)
      if (is_in[c] == start) spread(c);
  }
  bool has(size_t cell) const
  {
    return is_in[cell] != 0;
  }

private:
  enum { start = 1, reached = 2 };
  const tetgenio &io;
  std::vector<char> is_in;
  std::vector<std::vector<uint32_t>> face_at; /* faces by their lowest point */
  const vg_mesher_front *front = nullptr;

  static uint32_t lowest(const uint32_t v[3])
  {
    uint32_t low = v[0] < v[1] ? v[0] : v[1];

    return low < v[2] ? low : v[2];
  }

  /* Returns 0: not a face of the front; 1: a face that faces the cell; -1: a
   * face that faces away. The triangle is counter-clockwise seen from within
   * the cell. */
  int side(const uint32_t v[3]) const
  {
    uint32_t low = lowest(v);

    if (low >= face_at.size()) return 0;
    for (uint32_t i : face_at[low]) {
      const uint32_t *f = front->face[i];

      for (int k = 0; k < 3; k++) {
        if (f[0] != v[k]) continue;
        if (f[1] == v[(k + 1) % 3] && f[2] == v[(k + 2) % 3]) return 1;
        if (f[2] == v[(k + 1) % 3] && f[1] == v[(k + 2) % 3]) return -1;
      }
    }
    return 0;
  }

  void sides(size_t cell, int s[4]) const
  {
    static const int face[4][3] = {
      { 1, 3, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 0, 1, 2 }
    };
    const int *v = &io.tetrahedronlist[4 * cell];
    const REAL *x[4];
    bool turned;

    for (int k = 0; k < 4; k++) x[k] = &io.pointlist[3 * v[k]];
    turned = volume(x) < 0;
    for (int i = 0; i < 4; i++) {
      uint32_t t[3];

      for (int k = 0; k < 3; k++)
        t[k] = static_cast<uint32_t>(v[face[i][turned ? 2 - k : k]]);
      s[i] = side(t);
    }
  }

  static double volume(const REAL *const x[4])
  {
    double u[3], v[3], w[3];

    for (int k = 0; k < 3; k++) {
      u[k] = x[1][k] - x[0][k];
      v[k] = x[2][k] - x[0][k];
      w[k] = x[3][k] - x[0][k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) +
           u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
  }

  void mark_front(const vg_mesher_front &f)
  {
    int s[4];

    front = &f;
    face_at.resize(f.n_point);
    for (size_t i = 0; i < f.n_face; i++)
      face_at[lowest(f.face[i])].push_back(static_cast<uint32_t>(i));
    for (size_t c = 0; c < is_in.size(); c++) {
      sides(c, s);
      for (int i = 0; i < 4; i++)
        if (s[i] > 0) is_in[c] = start;
    }
  }

  void spread(size_t first)
  {
    std::vector<size_t> list(1, first);

    is_in[first] = reached;
    while (!list.empty()) {
      size_t c = list.back();
      int s[4];

      list.pop_back();
      sides(c, s);
      for (int i = 0; i < 4; i++) {
        int next = io.neighborlist[4 * c + static_cast<size_t>(i)];

        if (s[i] || next < 0 || is_in[static_cast<size_t>(next)] == reached)
          continue;
        is_in[static_cast<size_t>(next)] = reached;
        list.push_back(static_cast<size_t>(next));
      }
    }
  }
};

void give_cells(const tetgenio &out, const vg_mesher_front &f)
{
  size_t n = static_cast<size_t>(out.numberoftetrahedra);
  size_t n_new = static_cast<size_t>(out.numberofpoints) - f.n_point;
  std::vector<int> cell;
  inside in(out, f);

  for (size_t c = 0; c < n; c++)
    for (size_t k = 0; in.has(c) && k < 4; k++)
      cell.push_back(out.tetrahedronlist[4 * c + k]);
  vg_serve_put(VG_HELPER_CELLS, 0, n_new, cell.size() / 4);
  vg_serve_put_array(out.pointlist + 3 * f.n_point, 3 * n_new * sizeof(REAL));
  vg_serve_put_array(cell.data(), cell.size() * sizeof(int));
}

/* A limit of processor time, after which vg_child_answer_crashes ends this
 * process. */
void set_end(double seconds)
{
  itimerval t = {};

  t.it_value.tv_sec = static_cast<time_t>(seconds > 0 && seconds < 1e9 ? seconds
                                                                       : 0) +
                      1;
  setitimer(ITIMER_PROF, &t, nullptr);
}

} // namespace

/* Switches. p: keep the facets; Y: no points on them; q: ratio of circumradius
 * to shortest edge; n: neighbours; M, T: as for boundary recovery. */
bool vg_tetgen_fill(double seconds, const vg_serve_surface &s)
{
  const vg_mesher_front front = {
    s.n_point, s.n_tri, reinterpret_cast<const double(*)[3]>(s.x),
    reinterpret_cast<const uint32_t(*)[3]>(s.tri)
  };
  char switches[] = "pYq1.4nMQT1e-13";
  vg_mesher_sizes wanted = { vg_child_sizes_at, nullptr };
  tetgenio in, out;

  set_end(seconds);
  if (!s.n_point || s.n_point > 100000000 || s.n_tri > 200000000) return false;
  wanted.user = vg_child_sizes_new(STDIN_FILENO, STDOUT_FILENO, &front);
  if (!wanted.user) return false;
  sizes = &wanted;
  put_front(in, front);
  put_holes(in, s);
  tetrahedralize(switches, &in, &out);
  if (out.numberofcorners != 4 || !out.neighborlist ||
      static_cast<size_t>(out.numberofpoints) < front.n_point)
    return false;
  give_cells(out, front);
  return true;
}
