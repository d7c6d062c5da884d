/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Answers the questions of the parent and handles their errors. */
#include "io/occt/occt_parts.h"

#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <map>
#include <new>
#include <thread>

#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Standard_Failure.hxx>

namespace vg_occt
{

std::string format(const char *text, ...)
{
  char out[1600];
  va_list args;

  va_start(args, text);
  std::vsnprintf(out, sizeof out, text, args);
  va_end(args);
  return out;
}

std::string place(const gp_Pnt &p)
{
  return format("(%.6g, %.6g, %.6g)", p.X(), p.Y(), p.Z());
}

void Talk::put(const void *data, size_t size) const
{
  /* the parent has closed the socket */
  if (!wire_->put(fd_, data, size)) _exit(1);
}

bool Talk::get(void *data, size_t size) const
{
  return wire_->get(fd_, data, size);
}

void Talk::say(int what, int code, std::string text) const
{
  vg_cad_tell t = { what, code, 0 };

  for (char &c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  if (text.size() > 900) text.resize(900);
  t.n = text.size();
  put(&t, sizeof t);
  put(text.data(), text.size());
}

} // namespace vg_occt

namespace
{

using namespace vg_occt;

/* A file in memory with a path, for libraries that open files. */
class MemoryFile
{
public:
  MemoryFile(const Talk &talk, size_t n) : fd_(memfd_create("cad", 0))
  {
    std::vector<char> chunk(1 << 20);

    if (fd_ < 0) throw std::bad_alloc();
    while (n) {
      size_t part = n < chunk.size() ? n : chunk.size();

      if (!talk.get(chunk.data(), part)) _exit(0);
      if (!keep(chunk.data(), part)) throw std::bad_alloc();
      n -= part;
    }
  }
  ~MemoryFile()
  {
    close(fd_);
  }
  MemoryFile(const MemoryFile &) = delete;
  MemoryFile &operator=(const MemoryFile &) = delete;
  std::string path() const
  {
    return format("/proc/self/fd/%d", fd_);
  }

private:
  bool keep(const char *data, size_t n)
  {
    for (ssize_t k; n; data += k, n -= static_cast<size_t>(k))
      if ((k = write(fd_, data, n)) <= 0) return false;
    return true;
  }
  int fd_;
};

void send(const Model &model, const Surface &s, const Talk &talk)
{
  const vg_cad_tell t = { VG_CAD_TELL_SURFACE, 0, 1 };
  const vg_cad_counts n = { s.point.size() / 3,   s.tri.size() / 3,
                            s.segment.size() / 2, s.patches.size(),
                            model.is_solid,       model.volume,
                            model.unit,           model.n_solid,
                            model.zones.size() };

  talk.put(&t, sizeof t);
  talk.put(&n, sizeof n);
  talk.put(s.point.data(), s.point.size() * sizeof s.point[0]);
  talk.put(s.tri.data(), s.tri.size() * sizeof s.tri[0]);
  talk.put(s.face.data(), s.face.size() * sizeof s.face[0]);
  talk.put(s.patch.data(), s.patch.size() * sizeof s.patch[0]);
  talk.put(s.segment.data(), s.segment.size() * sizeof s.segment[0]);
  talk.put(s.curve.data(), s.curve.size() * sizeof s.curve[0]);
  talk.put(s.patches.data(), s.patches.size() * sizeof s.patches[0]);
  for (const Zone &z : model.zones) {
    vg_cad_place to = { { z.seed.X(), z.seed.Y(), z.seed.Z() }, "" };

    set_name(to.name, z.name);
    talk.put(&to, sizeof to);
  }
}

/* State of the child between questions. */
struct Held {
  Model healed; /* model before triangulation */
  Model model;
  Surface surface;
};

void answer_again(const vg_cad_ask &ask, Held &held, const Talk &talk)
{
  Model model = held.healed;
  Surface surface;

  talk.stage("triangulating its faces");
  triangulate(ask, model, surface, talk);
  send(model, surface, talk);
  held.model = model;
  held.surface = std::move(surface);
}

void answer_read(const vg_cad_ask &ask, Held &held, const Talk &talk)
{
  MemoryFile file(talk, ask.n);

  held = Held();
  talk.stage("reading the file");
  read(ask, file.path(), held.healed, talk);
  if (ask.section) {
    talk.stage("dividing its curves");
    section(ask, held.healed, held.surface);
    send(held.healed, held.surface, talk);
    return;
  }
  talk.stage("checking its faces for errors");
  complete(held.healed, talk);
  const Model whole = held.healed;
  heal(ask, held.healed, talk);
  try {
    answer_again(ask, held, talk);
  } catch (const Uncovered &f) {
    vg_cad_ask apart = ask;

    if (!held.healed.is_united) throw;
    talk.note(format("Open CASCADE covered only a part of %s of the union of "
                     "the solids: the union was not used",
                     f.face.c_str()));
    apart.leave_apart = VG_CAD_LEAVE_APART;
    held.healed = whole;
    heal(apart, held.healed, talk);
    answer_again(apart, held, talk);
  }
}

struct Points {
  std::vector<uint32_t> number;
  std::vector<double> x, distance;

  void set(size_t i, const gp_Pnt &from, const gp_Pnt &to)
  {
    x[3 * i] = to.X();
    x[3 * i + 1] = to.Y();
    x[3 * i + 2] = to.Z();
    distance[i] = from.Distance(to);
  }
};

/* A face of the file, with all of its pieces. */
class Pieces
{
public:
  Pieces(const Model &model, uint32_t number)
  {
    for (const Face &f : model.faces)
      if (f.number == number && !f.shape.IsNull())
        list_.emplace_back(new Projector(f.shape));
  }
  bool none() const
  {
    return list_.empty();
  }
  gp_Pnt nearest(const gp_Pnt &p)
  {
    gp_Pnt best = list_[0]->nearest(p);

    for (size_t i = 1; i < list_.size(); i++) {
      gp_Pnt to = list_[i]->nearest(p);

      if (p.SquareDistance(to) < p.SquareDistance(best)) best = to;
    }
    return best;
  }

private:
  std::vector<std::unique_ptr<Projector>> list_;
};

void put_on_faces(const Model &model, Points &p)
{
  std::map<uint32_t, std::unique_ptr<Pieces>> open;

  for (size_t i = 0; i < p.number.size(); i++) {
    uint32_t k = p.number[i];
    gp_Pnt from(p.x[3 * i], p.x[3 * i + 1], p.x[3 * i + 2]);

    if (!open[k]) open[k].reset(new Pieces(model, k));
    if (open[k]->none())
      throw Failure{ VG_ERR_INPUT,
                     format("point %zu: the model has no face %u", i + 1, k) };
    p.set(i, from, open[k]->nearest(from));
  }
}

struct Triangle {
  Triangle(const Surface &s, size_t t) : piece{}
  {
    for (int i = 0; i < 3; i++) {
      const double *at = s.point.data() + 3 * s.tri[3 * t + i];

      x[i] = gp_Pnt(at[0], at[1], at[2]);
      piece.uv[i] = s.uv[3 * t + i];
    }
    gp_Vec u(x[0], x[1]), v(x[0], x[2]);
    double area = u.Crossed(v).Magnitude();
    for (int i = 0; i < 3; i++)
      if (s.rim[t] >> i & 1) /* relative to the height of the vertex */
        piece.least[i] = area > 0
                         ? s.bulge *
                             x[(i + 1) % 3].SquareDistance(x[(i + 2) % 3]) /
                             area
                         : 2;
  }

  /* Parameters of p in the triangle. */
  gp_Pnt2d guess(const gp_Pnt &p) const
  {
    const gp_Pnt2d *uv = piece.uv;
    gp_Vec u(x[0], x[1]), v(x[0], x[2]), d(x[0], p);
    double uu = u * u, w = u * v, vv = v * v, det = uu * vv - w * w;
    double a = 1. / 3, b = 1. / 3;

    if (det > 0) {
      a = (vv * (d * u) - w * (d * v)) / det;
      b = (uu * (d * v) - w * (d * u)) / det;
    }
    return gp_Pnt2d(uv[0].XY() + a * (uv[1].XY() - uv[0].XY()) +
                    b * (uv[2].XY() - uv[0].XY()));
  }

  gp_Pnt x[3];
  Piece piece;
};

void put_on_triangles(const Model &model, const Surface &s, Points &p)
{
  std::map<uint32_t, std::unique_ptr<Projector>> open;

  for (size_t i = 0; i < p.number.size(); i++) {
    uint32_t t = p.number[i];
    gp_Pnt from(p.x[3 * i], p.x[3 * i + 1], p.x[3 * i + 2]);

    if (t >= s.face.size())
      throw Failure{ VG_ERR_INPUT,
                     format("point %zu: the model has no triangle %u", i + 1,
                            t) };
    std::unique_ptr<Projector> &on = open[s.piece[t]];
    if (!on) on.reset(new Projector(model.faces[s.piece[t]].shape));
    const Triangle tri(s, t);
    p.set(i, from, on->nearest(from, tri.guess(from), tri.piece));
  }
}

void put_on_curves(const Model &model, Points &p)
{
  for (size_t i = 0; i < p.number.size(); i++) {
    uint32_t k = p.number[i];
    gp_Pnt from(p.x[3 * i], p.x[3 * i + 1], p.x[3 * i + 2]);

    if (!k || k > model.curves.size())
      throw Failure{ VG_ERR_INPUT,
                     format("point %zu: the model has no curve %u", i + 1, k) };
    p.set(i, from, nearest_on_curve(model.curves[k - 1], from));
  }
}

void answer_points(const vg_cad_ask &ask, const Held &held, const Talk &talk)
{
  const vg_cad_tell t = { VG_CAD_TELL_POINTS, 0, ask.n };
  Points p;

  p.number.resize(ask.n);
  p.x.resize(3 * ask.n);
  p.distance.resize(ask.n);
  if (!talk.get(p.number.data(), ask.n * sizeof p.number[0]) ||
      !talk.get(p.x.data(), 3 * ask.n * sizeof p.x[0]))
    _exit(0);
  talk.stage("projecting points to its faces");
  if (ask.what == VG_CAD_ASK_FACES) put_on_faces(held.model, p);
  else if (ask.what == VG_CAD_ASK_CURVES) put_on_curves(held.model, p);
  else put_on_triangles(held.model, held.surface, p);
  talk.put(&t, sizeof t);
  talk.put(p.x.data(), 3 * ask.n * sizeof p.x[0]);
  talk.put(p.distance.data(), ask.n * sizeof p.distance[0]);
}

void answer(const vg_cad_ask &ask, Held &held, const Talk &talk)
{
  try {
    if (ask.what == VG_CAD_ASK_READ) answer_read(ask, held, talk);
    else if (ask.what == VG_CAD_ASK_AGAIN) answer_again(ask, held, talk);
    else answer_points(ask, held, talk);
  } catch (const Failure &f) {
    talk.fail(f);
  } catch (const std::bad_alloc &) {
    talk.fail({ VG_ERR_MEMORY, "not enough memory for Open CASCADE" });
    _exit(1); /* part of the question may still be unread */
  } catch (const Standard_Failure &f) {
    talk.fail({ VG_ERR_GEOMETRY,
                format("Open CASCADE could not process it (%s: %s); the "
                       "file may be damaged: export it again",
                       f.DynamicType()->Name(), f.GetMessageString()) });
  } catch (const std::exception &f) {
    talk.fail({ VG_ERR_GEOMETRY,
                format("Open CASCADE could not process it (%s)", f.what()) });
  }
}

/* End the process when the parent closes the socket, even if a call never
 * returns. */
void watch(int fd)
{
  pollfd p = { fd, POLLRDHUP, 0 };

  for (;;)
    if (poll(&p, 1, -1) > 0) _exit(0);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1 /* gcc's sanitizers need terabytes of address space */
#elif defined(__has_feature)
#define SANITIZED                                                              \
  (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#else
#define SANITIZED 0
#endif

/* A damaged file must not use up the memory of the machine. */
void limit_memory()
{
#if !SANITIZED
  double all = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
               static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit most;

  if (all <= 0 || getrlimit(RLIMIT_DATA, &most)) return;
  if (static_cast<double>(most.rlim_cur) <= 0.8 * all) return;
  most.rlim_cur = static_cast<rlim_t>(0.8 * all);
  setrlimit(RLIMIT_DATA, &most);
#endif
}

} // namespace

extern "C" vg_occt_entry vg_occt_serve;

void vg_occt_serve(int fd, const vg_cad_wire *wire)
{
  Talk talk(fd, wire);
  Held held;
  vg_cad_ask ask;

  limit_memory();
  std::thread(watch, fd).detach();
  while (talk.get(&ask, sizeof ask)) answer(ask, held, talk);
  _exit(0);
}
