/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/cad/cad.h"

#include <assert.h>
#include <ctype.h>
#include <dlfcn.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/child.h"
#include "base/clock.h"
#include "base/memory.h"
#include "io/cad/wire.h"
#include "io/stream/convention.h"

#define POLL_MS 100
#define CRASHED 1 /* code of VG_CAD_TELL_FAIL: no vg_status */
/* Default time limit. */
#define SECONDS 360.0         /* S15 */
#define SECONDS_PER_BYTE 6e-5 /* S15 */
#define TEXT_MAX 2048         /* longest message from the child */

struct vg_cad {
  struct vg_child child;
  int is_open, has_model;
  struct vg_cad_options o; /* options of the last parse */
  double limit;            /* seconds */
  char stage[80];          /* current stage, for messages */
};

void vg_cad_surface_release(struct vg_cad_surface *s)
{
  vg_mesh_release(&s->mesh);
  free(s->tri_face);
  free(s->segment);
  free(s->segment_curve);
  free(s->area);
  free(s->zones.of);
  memset(s, 0, sizeof *s);
}

void vg_cad_model_release(struct vg_cad_model *m)
{
  vg_cad_close(m->cad);
  vg_cad_surface_release(&m->surface);
  m->cad = NULL;
}

int vg_cad_is_built(void)
{
#ifdef VG_CAD_LIBRARY
  return 1;
#else
  return 0;
#endif
}

void vg_library_occt(struct vg_library *out)
{
  out->name = "Open CASCADE";
#ifdef VG_CAD_LIBRARY
  strcpy(out->version, VG_OCCT_VERSION ", by " VG_CAD_LIBRARY);
#else
  strcpy(out->version, VG_NOT_IN_BUILD " (VG_CAD=OFF)");
#endif
}

/* --- code that runs in the child ----------------------------------------- */

#ifdef VG_CAD_LIBRARY
/* The missing library, and the package to install. `why` is the message of
 * dlopen, which begins with the name of the library that was not found. */
static void explain(const char *why, char text[TEXT_MAX])
{
  const size_t n = strlen(VG_CAD_LIBRARY);

  if (!why)
    snprintf(text, TEXT_MAX,
             VG_CAD_LIBRARY " belongs to another build; install the packages "
                            "vanguard and libvanguard-cad0 of one version, or "
                            "build all targets again");
  else if (!strncmp(why, VG_CAD_LIBRARY ":", n + 1))
    snprintf(text, TEXT_MAX,
             "CAD files need " VG_CAD_LIBRARY
             ", which was not found (in ../lib, seen from the folder of the "
             "program, in LD_LIBRARY_PATH and in the folders of the system); "
             "install libvanguard-cad0, or build its target vanguard-cad");
  else if (!strstr(why, VG_CAD_LIBRARY))
    snprintf(text, TEXT_MAX,
             "CAD files need Open CASCADE, which was not found (%.400s); "
             "install libocct-data-exchange-" VG_OCCT_PACKAGE
             " and libocct-ocaf-" VG_OCCT_PACKAGE,
             why);
  else
    snprintf(text, TEXT_MAX,
             "CAD files need " VG_CAD_LIBRARY
             ", which cannot be loaded (%.400s); install libvanguard-cad0 "
             "again, or build its target vanguard-cad",
             why);
}
#endif

static void serve(int fd)
{
#ifdef VG_CAD_LIBRARY
  const struct vg_cad_wire wire = { vg_child_put, vg_child_get };
  const struct vg_cad_tell crash = { VG_CAD_TELL_FAIL, CRASHED, 0 };
  struct vg_cad_tell gone = { VG_CAD_TELL_FAIL, VG_ERR_UNSUPPORTED, 0 };
  void *library = dlopen(VG_CAD_LIBRARY, RTLD_NOW | RTLD_LOCAL), *at;
  const char *why = library ? NULL : dlerror();
  char text[TEXT_MAX];
  vg_occt_entry *entry;

  at = library ? dlsym(library, VG_OCCT_ENTRY) : NULL;
  vg_child_answer_crashes(fd, &crash, NULL, sizeof crash);
  if (at) {
    memcpy(&entry, &at, sizeof entry);
    entry(fd, &wire);
  }
  explain(why, text);
  gone.n = strlen(text);
  vg_child_put(fd, &gone, sizeof gone);
  vg_child_put(fd, text, gone.n);
#endif
  close(fd);
  _exit(1);
}

/* --- life of the child --------------------------------------------------- */

static void end_child(struct vg_cad *c)
{
  if (c->is_open) vg_child_close(&c->child);
  c->is_open = c->has_model = 0;
}

static vg_status start_child(struct vg_cad *c, struct vg_error *err)
{
  if (c->is_open) return VG_OK;
  if (vg_child_open(serve, &c->child) < 0)
    return vg_fail_memory(err, "a process for Open CASCADE");
  c->is_open = 1;
  strcpy(c->stage, "starting");
  return VG_OK;
}

vg_status vg_cad_open(struct vg_cad **out, struct vg_error *err)
{
  struct vg_cad *c;
  vg_status st;

  if (!vg_cad_is_built())
    return vg_fail(
      err, VG_ERR_UNSUPPORTED,
      "this build of vanguard cannot read CAD (CMake option VG_CAD): install "
      "Open CASCADE (Debian's libocct-data-exchange-dev) and configure again, "
      "or mesh the surface with another program ('gmsh -2 FILE -o NAME.stl') "
      "and use its triangles");
  c = vg_calloc(1, sizeof *c);
  if (!c) return vg_fail_memory(err, "a CAD model");
  st = start_child(c, err);
  if (st < 0) free(c);
  else *out = c;
  return st;
}

void vg_cad_close(struct vg_cad *c)
{
  if (!c) return;
  end_child(c);
  free(c);
}

/* --- answers ------------------------------------------------------------- */

/* Context of a question while its answer is awaited. */
struct call {
  struct vg_cad *cad;
  const char *path;
  const struct vg_cad_options *o;
  double start;
  int is_crash;
};

static vg_status gone(struct call *k, struct vg_error *err)
{
  char stage[sizeof k->cad->stage];

  strcpy(stage, k->cad->stage);
  end_child(k->cad);
  if (k->is_crash)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s: Open CASCADE crashed while %s; the file may be "
                   "damaged: export it again, or try another format (STEP, "
                   "IGES, BREP)",
                   k->path, stage);
  return vg_fail(err, VG_ERR_IO,
                 "%s: Open CASCADE ended without an answer while %s. If it was "
                 "killed for lack of memory (see dmesg), free memory and "
                 "repeat the command",
                 k->path, stage);
}

/* Wait until there are bytes to read, the child has ended, or the time limit is
 * exceeded. */
static vg_status await(struct call *k, struct vg_error *err)
{
  const struct vg_cad_options *o = k->o;
  struct pollfd p = { .fd = k->cad->child.fd, .events = POLLIN };

  do {
    if (o && vg_stops(&o->stop)) {
      end_child(k->cad);
      return vg_fail(err, VG_ERR_STOPPED, "%s: stopped while it was read",
                     k->path);
    }
    if (vg_clock() - k->start > k->cad->limit) {
      end_child(k->cad);
      return vg_fail(err, VG_ERR_IO,
                     "%s: Open CASCADE exceeded the time limit of %g s "
                     "while %s; if the file is in order, raise cad_seconds",
                     k->path, k->cad->limit, k->cad->stage);
    }
  } while (poll(&p, 1, POLL_MS) <= 0);
  return VG_OK;
}

static vg_status take(struct call *k, void *data, size_t size,
                      struct vg_error *err)
{
  return vg_child_get(k->cad->child.fd, data, size) ? VG_OK : gone(k, err);
}

static vg_status take_text(struct call *k, const struct vg_cad_tell *t,
                           char *text, struct vg_error *err)
{
  vg_status st = t->n < TEXT_MAX ? VG_OK : gone(k, err);

  if (st >= 0) st = take(k, text, t->n, err);
  if (st >= 0) text[t->n] = 0;
  return st;
}

/* Receive the next answer other than a note or a stage. If the child reports a
 * failure, the call fails with its message. */
static vg_status next(struct call *k, struct vg_cad_tell *t,
                      struct vg_error *err)
{
  char text[TEXT_MAX];
  vg_status st = VG_OK;

  for (;;) {
    VG_TRY(await(k, err));
    VG_TRY(take(k, t, sizeof *t, err));
    if (t->what > VG_CAD_TELL_FAIL) return VG_OK;
    k->is_crash = t->what == VG_CAD_TELL_FAIL && t->code == CRASHED;
    if (k->is_crash) return gone(k, err);
    VG_TRY(take_text(k, t, text, err));
    if (t->what == VG_CAD_TELL_NOTE) {
      if (k->o && k->o->note) k->o->note(k->o->user, text);
    } else if (t->what == VG_CAD_TELL_STAGE) {
      snprintf(k->cad->stage, sizeof k->cad->stage, "%.79s", text);
    } else {
      /* The child ended while it read the question. */
      if (t->code == VG_ERR_MEMORY) end_child(k->cad);
      return vg_fail(err,
                     t->code < 0 && t->code >= VG_ERR_USAGE ? (vg_status)t->code
                                                            : VG_ERR_GEOMETRY,
                     "%s: %s", k->path, text);
    }
  }
done:
  return st;
}

static vg_status take_array(struct call *k, uint64_t n, size_t size, void *to,
                            struct vg_error *err)
{
  void *a = n < UINT32_MAX ? vg_alloc(n, size) : NULL;
  vg_status st;

  if (!a) {
    end_child(k->cad);
    return vg_fail(err, VG_ERR_MEMORY,
                   "%s: not enough memory for the %llu items of its surface",
                   k->path, (unsigned long long)n);
  }
  memcpy(to, &a, sizeof a); /* the caller frees it, also on failure */
  st = take(k, a, n * size, err);
  return st;
}

static vg_status take_patches(struct call *k, uint64_t n,
                              struct vg_cad_surface *s, struct vg_error *err)
{
  struct vg_mesh *m = &s->mesh;
  struct vg_cad_patch *from = NULL;
  vg_status st = take_array(k, n, sizeof *from, &from, err);

  if (st < 0) goto done;
  m->patch = vg_calloc(n, sizeof *m->patch);
  s->area = vg_alloc(n, sizeof *s->area);
  if (!m->patch || !s->area) {
    end_child(k->cad);
    st = vg_fail_memory(err, "the patches");
    goto done;
  }
  for (uint64_t i = 0; i < n; i++) {
    struct vg_patch *to = &m->patch[i];

    s->area[i] = from[i].area;
    to->id = from[i].id;
    to->is_interface = from[i].is_interface != 0;
    to->bc = to->bc_fun3d = to->family = VG_BC_NONE;
    memcpy(to->name, from[i].name, sizeof to->name - 1);
  }
  m->n_patch = n;
done:
  free(from);
  return st;
}

static vg_status take_zones(struct call *k, uint64_t n, struct vg_cad_zones *z,
                            struct vg_error *err)
{
  struct vg_cad_place *from = NULL;
  vg_status st = take_array(k, n, sizeof *from, &from, err);

  if (st >= 0 && n) {
    z->of = vg_calloc(n, sizeof *z->of);
    if (!z->of) {
      end_child(k->cad);
      st = vg_fail_memory(err, "the zones");
    }
  }
  for (; st >= 0 && z->n < n; z->n++) {
    memcpy(z->of[z->n].seed, from[z->n].seed, sizeof from->seed);
    memcpy(z->of[z->n].name, from[z->n].name, sizeof from->name - 1);
  }
  free(from);
  return st;
}

/* Check the indices: a damaged file may make the library write anywhere. */
static int is_sound(const struct vg_cad_surface *s)
{
  const struct vg_mesh *m = &s->mesh;
  int good = 1;

  for (size_t i = 0; i < m->n_tri; i++) {
    for (int k = 0; k < 3; k++) good &= m->tri[i][k] < m->n_point;
    good &= m->tri_patch[i] < m->n_patch;
  }
  for (size_t i = 0; i < s->n_segment; i++)
    good &= s->segment[i][0] < m->n_point && s->segment[i][1] < m->n_point;
  return good;
}

static vg_status take_surface(struct call *k, struct vg_cad_surface *s,
                              struct vg_error *err)
{
  struct vg_mesh *m = &s->mesh;
  struct vg_cad_counts n;
  vg_status st;

  VG_TRY(take(k, &n, sizeof n, err));
  VG_TRY(take_array(k, n.n_point, sizeof *m->point, &m->point, err));
  m->n_point = n.n_point;
  VG_TRY(take_array(k, n.n_tri, sizeof *m->tri, &m->tri, err));
  m->n_tri = n.n_tri;
  s->is_solid = n.is_solid != 0;
  s->n_solid = n.n_solid > 0 ? (size_t)n.n_solid : 0;
  s->volume = n.volume;
  s->unit = n.unit > 0 && n.unit < VG_CAD_UNIT_N ? (int)n.unit : 0;
  VG_TRY(take_array(k, n.n_tri, sizeof *s->tri_face, &s->tri_face, err));
  VG_TRY(take_array(k, n.n_tri, sizeof *m->tri_patch, &m->tri_patch, err));
  VG_TRY(take_array(k, n.n_segment, sizeof *s->segment, &s->segment, err));
  s->n_segment = n.n_segment;
  VG_TRY(take_array(k, n.n_segment, sizeof *s->segment_curve, &s->segment_curve,
                    err));
  VG_TRY(take_patches(k, n.n_patch, s, err));
  VG_TRY(take_zones(k, n.n_zone, &s->zones, err));
  if (!is_sound(s)) {
    st = gone(k, err);
    goto done;
  }
  st = vg_check_points(k->path, m->n_point, m->point, err);
done:
  return st;
}

/* --- files --------------------------------------------------------------- */

/* The standards define how these files begin and end. So truncated files can be
 * distinguished from damaged ones without starting a child. */
static const char step_end[] = "END-ISO-10303-21;";

static size_t trimmed(const struct vg_input *in)
{
  size_t n = in->size;

  while (n && in->data[n - 1] <= ' ') n--;
  return n;
}

/* Last line that is not blank; *end: the position after it. */
static const char *last_line(const struct vg_input *in, const char **end)
{
  const char *data = (const char *)in->data;
  size_t n = trimmed(in), at = n;

  while (at && data[at - 1] != '\n' && data[at - 1] != '\r') at--;
  *end = data + n;
  return data + at;
}

static const char *skip_digits(const char *at, const char *end)
{
  while (at < end && *at >= '0' && *at <= '9') at++;
  return at;
}

/* Does a BREP file contain the number of its shape, such as "+1 0"? It follows
 * the last of the "TShapes N" sections, each of which ends with '*'. Text after
 * that number belongs to other programs (attributes of .egads files). */
static int ends_brep(const struct vg_input *in)
{
  static const char word[] = "TShapes ";
  const char *data = (const char *)in->data, *end = data + in->size;
  const char *at = memmem(data, in->size, word, sizeof word - 1), *from;
  size_t n = 0;

  if (!at) return 0;
  for (at += sizeof word - 1; at < end && *at >= '0' && *at <= '9'; at++)
    n = 10 * n + (size_t)(*at - '0');
  while (n && (at = memchr(at, '*', (size_t)(end - at)))) {
    at++;
    n--;
  }
  while (at && at < end && isspace((unsigned char)*at)) at++;
  if (!at || at == end || !memchr("+-io", *at, 4)) return 0;
  from = skip_digits(at + 1, end);
  if (from == at + 1 || from == end || *from != ' ') return 0;
  return skip_digits(from + 1, end) > from + 1;
}

/* Bytes of a STEP file up to the end of its last end mark; 0: it has none. Some
 * programs append text of their own. */
static size_t step_size(const struct vg_input *in)
{
  const size_t n = sizeof step_end - 1;

  for (size_t end = in->size; end >= n; end--)
    if (!memcmp(in->data + end - n, step_end, n)) return end;
  return 0;
}

static int is_whole(const struct vg_input *in, enum vg_cad_kind kind)
{
  const char *end, *at = last_line(in, &end);

  if (kind == VG_CAD_BREP) return ends_brep(in);
  if (kind == VG_CAD_IGES) return end - at >= 73 && at[72] == 'T';
  return step_size(in) > 0;
}

static const struct {
  const char *word, *last;
} frames[] = {
  [VG_CAD_STEP] = { "ISO-10303-21", "\"END-ISO-10303-21;\"" },
  [VG_CAD_IGES] = { "", "a line T (Terminate)" },
  [VG_CAD_BREP] = { "CASCADE Topology V", "the number of its shape" },
};

static vg_status check_frame(const struct vg_input *in, enum vg_cad_kind kind,
                             struct vg_error *err)
{
  const char *word = frames[kind].word;
  size_t head = in->size < 4096 ? in->size : 4096;

  if (*word && !memmem(in->data, head, word, strlen(word)))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: not a %s file: it should have \"%s\" near its "
                   "beginning",
                   in->path, kind == VG_CAD_STEP ? "STEP" : "BREP", word);
  if (kind == VG_CAD_IGES && (in->size < 80 || in->data[72] != 'S'))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: not an IGES file: column 73 of its first line "
                   "should be S (Start)",
                   in->path);
  if (is_whole(in, kind)) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: truncated: the file must end in %s; export it again",
                 in->path, frames[kind].last);
}

/* --- surfaces ------------------------------------------------------------ */

static struct vg_cad_ask question(uint32_t what, uint32_t kind, uint64_t n,
                                  const struct vg_cad_options *o)
{
  return (struct vg_cad_ask){
    what,     kind,     o->unit, o->patches, n,         o->tolerance, o->chord,
    o->angle, o->least, 0,       0,          o->solids, o->is_section
  };
}

/* Removes from the view of a STEP file what follows its end mark. */
static void drop_text_after_end(struct vg_input *view, const struct call *k)
{
  const size_t end = step_size(view), all = trimmed(view);
  char text[128];

  if (end < all && k->o->note) {
    snprintf(text, sizeof text, "%zu bytes after the end mark %s were not read",
             all - end, step_end);
    k->o->note(k->o->user, text);
  }
  view->size = end;
}

/* If the child stops reading, it may have sent the reason before it ended. */
static void send_file(struct call *k, const struct vg_input *in,
                      enum vg_cad_kind kind, int leave_apart, int with_volume)
{
  struct vg_cad_ask ask = question(VG_CAD_ASK_READ, (uint32_t)kind, in->size,
                                   k->o);

  ask.leave_apart = leave_apart;
  ask.with_volume = with_volume;
  if (vg_child_put(k->cad->child.fd, &ask, sizeof ask))
    vg_child_put(k->cad->child.fd, in->data, in->size);
}

/* *out is unchanged on failure. */
static vg_status await_surface(struct call *k, struct vg_cad_surface *out,
                               struct vg_error *err)
{
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_cad_tell t;
  vg_status st;

  VG_TRY(next(k, &t, err));
  VG_TRY(t.what == VG_CAD_TELL_SURFACE ? VG_OK : gone(k, err));
  VG_TRY(take_surface(k, &s, err));
  *out = s;
  return VG_OK;
done:
  vg_cad_surface_release(&s);
  return st;
}

/* The next simpler treatment of solids after a crash of the library in a union;
 * 0: the child ended otherwise. The surface is another one, so that only a
 * crash selects it. */
static int simpler_union(const struct call *k)
{
  if (!k->is_crash) return 0;
  if (!strcmp(k->cad->stage, VG_CAD_STAGE_UNITE_WHOLE))
    return VG_CAD_UNITE_WALLS;
  return strcmp(k->cad->stage, VG_CAD_STAGE_UNITE) ? 0 : VG_CAD_LEAVE_APART;
}

/* Read the file; after a crash in a union again with a simpler one. */
static vg_status read_solids(struct call *k, const struct vg_input *view,
                             enum vg_cad_kind kind, int with_volume,
                             struct vg_cad_surface *out, struct vg_error *err)
{
  int apart = k->o->keeps_solids ? VG_CAD_KEEP_WALLS : VG_CAD_UNITE_WHOLE;
  vg_status st;

  do {
    k->is_crash = 0;
    VG_TRY(start_child(k->cad, err));
    send_file(k, view, kind, apart, with_volume);
    st = await_surface(k, out, err);
    apart = st < 0 ? simpler_union(k) : 0;
    if (apart && k->o->note)
      k->o->note(k->o->user,
                 apart == VG_CAD_UNITE_WALLS
                   ? "Open CASCADE crashed while it united solids that touch "
                     "or overlap; the file was read again and their common "
                     "walls were dropped before the union"
                   : "Open CASCADE crashed while it united solids that touch "
                     "or overlap; the file was read again without uniting "
                     "them");
  } while (apart);
done:
  return st;
}

static vg_status parse(struct vg_cad *c, struct vg_input *in,
                       enum vg_cad_kind kind, const struct vg_cad_options *o,
                       int with_volume, struct vg_cad_surface *out,
                       struct vg_error *err)
{
  struct call k = { c, in->path, o, vg_clock(), 0 };
  struct vg_input view = *in;
  vg_status st;

  if (kind <= VG_CAD_NONE || kind > VG_CAD_BREP)
    return vg_fail(err, VG_ERR_INPUT, "%s: %d is not a kind of CAD file",
                   in->path, (int)kind);
  VG_TRY(check_frame(in, kind, err));
  if (kind == VG_CAD_STEP) drop_text_after_end(&view, &k);
  c->has_model = 0;
  c->o = *o;
  c->limit = o->seconds > 0 ? o->seconds
                            : SECONDS + SECONDS_PER_BYTE * (double)in->size;
  st = read_solids(&k, &view, kind, with_volume, out, err);
  c->has_model = st >= 0;
done:
  return st;
}

vg_status vg_cad_parse(struct vg_cad *c, struct vg_input *in,
                       enum vg_cad_kind kind, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err)
{
  assert(in && o && out);
  assert(kind >= VG_CAD_STEP && kind <= VG_CAD_BREP);
  return parse(c, in, kind, o, 1, out, err);
}

vg_status vg_cad_again(struct vg_cad *c, const struct vg_cad_options *o,
                       struct vg_cad_surface *out, struct vg_error *err)
{
  const struct vg_cad_ask ask = question(VG_CAD_ASK_AGAIN, 0, 0, o);
  struct call k = { c, "the CAD model", o, vg_clock(), 0 };

  assert(o && out);
  if (!c->has_model) return vg_fail(err, VG_ERR_INPUT, "no CAD model was read");
  c->o = *o;
  if (!vg_child_put(c->child.fd, &ask, sizeof ask)) return gone(&k, err);
  return await_surface(&k, out, err);
}

static void take_over(struct vg_cad_zones *from, struct vg_cad_zones *to)
{
  if (!to) return;
  *to = *from;
  *from = (struct vg_cad_zones){ 0, NULL };
}

vg_status vg_cad_read(const char *path, enum vg_cad_kind kind,
                      const struct vg_cad_options *options,
                      struct vg_cad_model *keep, struct vg_mesh *out, int *unit,
                      struct vg_cad_zones *zones, struct vg_error *err)
{
  const struct vg_cad_options plain = VG_CAD_OPTIONS_INIT;
  struct vg_cad_surface s = VG_CAD_SURFACE_INIT;
  struct vg_input in = VG_INPUT_INIT;
  struct vg_cad *c = NULL;
  vg_status st;

  assert(kind >= VG_CAD_STEP && kind <= VG_CAD_BREP);
  assert(!keep || !keep->cad);
  VG_TRY(vg_input_open(path, &in, err));
  VG_TRY(vg_cad_open(&c, err));
  VG_TRY(
    parse(c, &in, kind, options ? options : &plain, keep != NULL, &s, err));
  *unit = s.unit;
  if (keep) {
    struct vg_mesh copy = VG_MESH_INIT;

    VG_TRY(vg_mesh_copy(&copy, &s.mesh, err));
    take_over(&s.zones, zones);
    *keep = (struct vg_cad_model){ c, s };
    c = NULL;
    s = (struct vg_cad_surface)VG_CAD_SURFACE_INIT;
    vg_mesh_move(out, &copy);
  } else {
    vg_mesh_move(out, &s.mesh);
    take_over(&s.zones, zones);
  }
done:
  vg_cad_close(c);
  vg_cad_surface_release(&s);
  vg_input_release(&in);
  return st;
}

/* --- points -------------------------------------------------------------- */

vg_status vg_cad_project(struct vg_cad *c, enum vg_cad_on on, size_t n,
                         const uint32_t *number, double (*point)[3],
                         double *distance, struct vg_error *err)
{
  static const uint32_t what[] = {
    [VG_CAD_ON_FACES] = VG_CAD_ASK_FACES,
    [VG_CAD_ON_CURVES] = VG_CAD_ASK_CURVES,
    [VG_CAD_ON_TRIANGLES] = VG_CAD_ASK_TRIANGLES
  };
  const struct vg_cad_ask ask = { .n = n, .what = what[on] };
  struct call k = { c, "the CAD model", &c->o, vg_clock(), 0 };
  double(*to)[3] = NULL, *far = NULL;
  struct vg_cad_tell t;
  vg_status st = VG_OK;

  assert(on >= VG_CAD_ON_FACES && on <= VG_CAD_ON_TRIANGLES);
  assert((number && point) || !n);
  if (!c->has_model) return vg_fail(err, VG_ERR_INPUT, "no CAD model was read");
  if (!n) return VG_OK;
  if (!vg_child_put(c->child.fd, &ask, sizeof ask) ||
      !vg_child_put(c->child.fd, number, n * sizeof *number) ||
      !vg_child_put(c->child.fd, point, n * sizeof *point))
    return gone(&k, err);
  VG_TRY(next(&k, &t, err));
  if (t.what != VG_CAD_TELL_POINTS || t.n != n) {
    st = gone(&k, err);
    goto done;
  }
  VG_TRY(take_array(&k, n, sizeof *to, &to, err));
  VG_TRY(take_array(&k, n, sizeof *far, &far, err));
  memcpy(point, to, n * sizeof *point);
  if (distance) memcpy(distance, far, n * sizeof *distance);
done:
  free(to);
  free(far);
  return st;
}
