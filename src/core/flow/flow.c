/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the cap of a half model is removed, and a half model is joined with
 * its mirror image. Each outermost shell is classified, and the verdicts are
 * combined. Shells are then turned and sealed cavities dropped. */
#include "core/flow/flow.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/flow/half.h"
#include "core/flow/verdict.h"

/* Treatment of a shell. */
enum fate { KEEP_OUT, KEEP_IN, DROP }; /* normals out of it, into it */

struct settle {
  const struct vg_flow_options *o;
  struct vg_mesh *m;           /* The input without a cap. */
  struct vg_surface_report *r; /* Report on m. */
  struct vg_mesh whole;        /* m with its mirror image; empty: m is a whole
                                  model. */
  struct vg_surface_report whole_r;
  struct vg_flow_evidence e;     /* Evidence on the whole model. */
  enum vg_flow_verdict *verdict; /* [e.n_shell] Verdict on each outermost
                                    shell. */
  struct vg_flow out;
};

static void release(struct settle *s)
{
  vg_flow_evidence_release(&s->e);
  vg_surface_report_release(&s->whole_r);
  vg_mesh_release(&s->whole);
  free(s->verdict);
  s->verdict = NULL;
}

static __attribute__((format(printf, 2, 3))) void tell(struct vg_flow *f,
                                                       const char *format, ...)
{
  va_list args;

  if (f->n_evidence == VG_FLOW_EVIDENCE) return;
  va_start(args, format);
  vsnprintf(f->evidence[f->n_evidence++], VG_FLOW_TEXT, format, args);
  va_end(args);
}

/* --- half models --------------------------------------------------------- */

/* Drop marked triangles and repeat the surface check. */
static vg_status drop(struct settle *s, const uint8_t *gone, int external,
                      struct vg_error *err)
{
  const struct vg_surface_check_options o = { .repair = s->o->repair,
                                              .require_bc = s->o->require_bc,
                                              .external = external,
                                              .threads = s->o->threads,
                                              .stop = s->o->stop };
  struct vg_mesh *m = s->m;
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    if (gone[t]) continue;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n++] = m->tri_patch[t];
  }
  m->n_tri = n;
  return vg_surface_check(m, &o, s->r, err);
}

/* A closed surface may be a half model with a cap. *removed is set if the cap
 * was removed because the options or a condition require it. */
static vg_status look_for_cap(struct settle *s, int *removed,
                              struct vg_error *err)
{
  const enum vg_flow_half half = s->o->half;
  struct vg_flow_cap cap = { .axis = -1 };
  int by_condition = 0;
  vg_status st = VG_OK;

  *removed = 0;
  if (half == VG_HALF_NO || half == VG_HALF_YES || !s->r->is_closed)
    return VG_OK;
  VG_TRY(vg_flow_find_cap(s->m, half, &cap, &by_condition, err));
  if (cap.axis < 0) {
    if (half >= VG_HALF_X)
      st = vg_fail(err, VG_ERR_INPUT,
                   "half %c: the surface is closed and has no flat cap at an "
                   "end in %c that could be removed; give a half model that "
                   "is open along its symmetry plane, or omit the option half",
                   "xyz"[half - VG_HALF_X], "xyz"[half - VG_HALF_X]);
    goto done;
  }
  s->out.cap_axis = cap.axis;
  s->out.cap_at = cap.at;
  if (half < VG_HALF_X && !by_condition) goto done;
  *removed = 1;
  s->out.n_cap_tri = cap.n_tri;
  tell(&s->out, "the flat cap at %c = %g (%zu triangles) %s: it was removed",
       "xyz"[cap.axis], cap.at, cap.n_tri,
       by_condition ? "has the condition or name of a symmetry plane"
                    : "closes a half model according to the option half");
  VG_TRY(drop(s, cap.tri, -1, err));
done:
  vg_flow_cap_release(&cap);
  return st;
}

/* Rims can be followed if neighbouring triangles agree in orientation. A
 * reference surface may intersect itself by less than the tolerance of the
 * remeshed surface. */
static int has_rims(const struct vg_surface_report *r)
{
  return r->count[VG_DEFECT_OPEN_EDGE] && !r->count[VG_DEFECT_ORIENTATION] &&
         !r->count[VG_DEFECT_NONMANIFOLD_EDGE];
}

/* Move the rim of a half model into its plane. If it was off the plane, repeat
 * the surface check. */
static vg_status flatten_root(struct settle *s, struct vg_error *err)
{
  const double length = vg_mesh_length(s->m);
  double off;
  uint8_t *none = NULL;
  vg_status st;

  VG_TRY(vg_domain_flatten(s->m, s->out.axis, s->out.at, &off, err));
  if (off <= VG_HALF_NEAR * length) goto done;
  s->out.root_off = off;
  tell(&s->out,
       "the root is up to %.3g off the plane %c = %g (%.2g of the length of "
       "the body) and was moved into it",
       off, "xyz"[s->out.axis], s -> out.at, off / length);
  none = vg_calloc(s->m->n_tri, 1);
  if (!none) VG_TRY(vg_fail_memory(err, "the root of a half model"));
  VG_TRY(drop(s, none, -1, err));
done:
  free(none);
  return st;
}

/* The rim of a cap that was removed is too far off its plane. */
static vg_status refuse_rim(const struct settle *s, struct vg_error *err)
{
  const int k = s->out.cap_axis;
  const struct vg_surface_report *r = s->r;
  const double *x = NULL;

  for (size_t i = 0; i < r->n_defect; i++) {
    const double *y = r->defect[i].at;

    if (r->defect[i].kind == VG_DEFECT_OPEN_EDGE &&
        (!x || fabs(y[k] - s->out.cap_at) > fabs(x[k] - s->out.cap_at)))
      x = y;
  }
  assert(x);
  return vg_fail(err, VG_ERR_INPUT,
                 "half %c: the rim of the root is %.3g off the plane %c = %g "
                 "at (%.9g, %.9g, %.9g) and cannot be moved into a plane at "
                 "the end of the body by at most %g of its length. Move the "
                 "points of the root into the plane",
                 "xyz"[k], fabs(x[k] - s->out.cap_at), "xyz"[k],
                 s -> out.cap_at, x[0], x[1], x[2], VG_ROOT_OFF);
}

/* An open surface may be a half model. */
static vg_status look_for_rims(struct settle *s, struct vg_error *err)
{
  const enum vg_flow_half half = s->o->half;
  const int symmetry = half == VG_HALF_AUTO && !s->out.n_cap_tri ? 0
                     : half == VG_HALF_NO                        ? -1
                     : half >= VG_HALF_X                         ? 2
                                                                 : 1;
  int axis;
  double at;
  vg_status st;

  if (symmetry < 0 || !has_rims(s->r)) return VG_OK;
  VG_TRY(vg_domain_half(s->m, symmetry, &axis, &at, err));
  if (axis < 0 && half >= VG_HALF_X && s->out.n_cap_tri)
    VG_TRY(refuse_rim(s, err));
  if (axis < 0) goto done;
  if (half >= VG_HALF_X && axis != (int)half - VG_HALF_X) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "half %c: the open edges of the surface lie in the plane %c "
                 "= %g; set half %c, or close them (close_holes yes)",
                 "xyz"[half - VG_HALF_X], "xyz"[axis], at, "xyz"[axis]);
    goto done;
  }
  s->out.axis = axis;
  s->out.at = at;
  if (symmetry > 1) VG_TRY(flatten_root(s, err));
  if (!s->out.n_cap_tri)
    tell(&s->out,
         "all %zu open edges lie in the plane %c = %g at an end of "
         "the surface: half of a symmetric model",
         s->r->count[VG_DEFECT_OPEN_EDGE], "xyz"[axis], at);
  VG_TRY(vg_flow_mirror(s->m, axis, at, &s->whole, err));
  VG_TRY(vg_surface_check(
    &s->whole,
    &(struct vg_surface_check_options){
      .external = -1, .threads = s->o->threads, .stop = s->o->stop },
    &s->whole_r, err));
done:
  return st;
}

/* --- verdicts ------------------------------------------------------------ */

static vg_status two_readings(const char *why, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "the flow domain is ambiguous and can be read in two ways: "
                 "%s. Choose --flow external (the surface is a body, the "
                 "fluid is outside) or --flow internal (the surface bounds "
                 "the fluid inside it), or give boundary conditions",
                 why);
}

static vg_status judge_shells(struct settle *s, struct vg_error *err)
{
  struct vg_flow_evidence *e = &s->e;
  enum vg_flow_side side = s->o->side;
  char why[VG_FLOW_TEXT];

  s->verdict = vg_alloc(e->n_shell, sizeof *s->verdict);
  if (!s->verdict) return vg_fail_memory(err, "the shells");
  /* The orientation of the triangles of a half model, which is open, is not
   * evidence. */
  if (s->out.axis >= 0 && side != VG_SIDE_DEFINED) side = VG_SIDE_FREE;
  for (size_t i = 0; i < e->n_shell; i++) {
    s->verdict[i] = vg_flow_judge(&e->shell[i], side, why);
    if (s->o->kind != VG_FLOW_UNKNOWN)
      s->verdict[i] = s->o->kind == VG_FLOW_EXTERNAL ? VG_FLOW_BODY
                                                     : VG_FLOW_OUTER;
    else if (s->verdict[i] == VG_FLOW_EITHER) return two_readings(why, err);
    else if (e->n_shell == 1) tell(&s->out, "%s", why);
    else if (i < 3 || s->verdict[i] == VG_FLOW_OUTER)
      tell(&s->out, "shell %u: %s", e->shell[i].shell + 1, why);
    s->out.n_outer += s->verdict[i] == VG_FLOW_OUTER;
  }
  if (s->o->kind != VG_FLOW_UNKNOWN)
    tell(&s->out, "given by the setting %s", s->o->asked_by);
  return VG_OK;
}

/* A shell inside another one cannot be the outer boundary of that shell's
 * fluid. */
static vg_status check_inner(const struct settle *s, struct vg_error *err)
{
  const struct vg_flow_evidence *e = &s->e;

  if (s->o->kind != VG_FLOW_UNKNOWN || s->o->all_regions) return VG_OK;
  for (size_t i = 0; i < e->m->n_patch; i++) {
    const struct vg_flow_patch *p = &e->patch[i];

    if (!p->is_used || p->shell == UINT32_MAX || !e->depth[p->shell] ||
        (p->role != VG_ROLE_FARFIELD && p->role != VG_ROLE_INLET &&
         p->role != VG_ROLE_OUTLET) ||
        (e->depth[p->shell] == 1 &&
         s->verdict[e->slot[p->shell]] == VG_FLOW_OUTER))
      continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "patch %d%s%.40s has the condition or "
                   "name of an outer boundary or an opening, but its shell "
                   "lies inside a body: either it bounds a second region of "
                   "fluid (--regions all meshes it too), or it is a sealed "
                   "cavity that is left out (--flow external)",
                   (int)e->m->patch[i].id, *e->m->patch[i].name ? " " : "",
                   e->m->patch[i].name);
  }
  return VG_OK;
}

static vg_status combine(struct settle *s, struct vg_error *err)
{
  struct vg_flow *f = &s->out;
  vg_status st;

  VG_TRY(judge_shells(s, err));
  VG_TRY(check_inner(s, err));
  f->kind = f->n_outer ? VG_FLOW_INTERNAL : VG_FLOW_EXTERNAL;
  if (f->n_outer && f->n_outer < s->e.n_shell) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "the flow domain is ambiguous and can be read in two ways: "
                 "%zu of %zu outermost shells are outer boundaries of a "
                 "fluid inside them, and the others are bodies outside these "
                 "boundaries. Choose --flow external or --flow internal, or "
                 "remove the shells that do not belong to the domain",
                 f->n_outer, s->e.n_shell);
  } else if (f->n_outer > 1 && !s->o->all_regions) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "the surface bounds %zu regions of fluid "
                 "that are not connected. Mesh them one by one, or all of them "
                 "together with --regions all",
                 f->n_outer);
  }
done:
  return st;
}

/* --- treatment of shells -------------------------------------------------- */

static enum fate fate_of(const struct settle *s, uint32_t shell)
{
  const struct vg_flow_evidence *e = &s->e;
  const int outer = s->verdict[e->slot[shell]] == VG_FLOW_OUTER;
  const int depth = e->depth[shell];

  assert(shell < e->r->n_shell && e->slot[shell] < e->n_shell);
  if (depth > outer && !s->o->all_regions) return DROP;
  return depth % 2 == outer ? KEEP_OUT : KEEP_IN;
}

/* Is the shell connected to its mirror image? */
static int is_joined(const struct settle *s, const struct vg_shell *x)
{
  return s->out.axis >= 0 &&
         s->e.r->tri_shell[x->face] == s->e.r->tri_shell[x->face + s->m->n_tri];
}

static void count_shell(struct settle *s, uint32_t shell, double *largest)
{
  const struct vg_shell *x = &s->e.r->shell[shell];
  const double volume = fabs(x->volume) / (1 + is_joined(s, x));

  if (fate_of(s, shell) == KEEP_OUT) s->out.n_body++;
  if (fate_of(s, shell) != DROP) return;
  s->out.n_cavity++;
  s->out.cavity_volume += volume;
  if (volume <= *largest) return;
  *largest = volume;
  for (int k = 0; k < 3; k++) s->out.cavity_at[k] = 0.5 * (x->lo[k] + x->hi[k]);
}

/* Mark the patches of the outer boundary. A patch with more than half of its
 * triangles on a body inside the outer boundary does not belong to it. */
static vg_status mark_outer(struct settle *s, struct vg_error *err)
{
  const struct vg_flow_evidence *e = &s->e;
  size_t(*n)[2] = vg_calloc(e->m->n_patch, sizeof *n);

  if (!n) return vg_fail_memory(err, "the patches");
  for (size_t t = 0; t < e->m->n_tri && e->in_pocket; t++)
    n[e->m->tri_patch[t]][e->in_pocket[t]]++;
  for (size_t i = 0; i < e->m->n_patch; i++) {
    const struct vg_flow_patch *p = &e->patch[i];

    s->out.on_outer[i] = p->is_used && p->shell != UINT32_MAX &&
                         !e->depth[p->shell] && n[i][1] <= n[i][0] &&
                         s->verdict[e->slot[p->shell]] == VG_FLOW_OUTER;
  }
  free(n);
  return VG_OK;
}

static void count_shells(struct settle *s)
{
  double largest = 0;

  /* Of a shell and its image count one: the shell whose first triangle is in
   * m. */
  for (size_t i = 0; i < s->e.r->n_shell; i++)
    if (s->out.axis < 0 || s->e.r->shell[i].face < s->m->n_tri)
      count_shell(s, (uint32_t)i, &largest);
  for (size_t i = 0; i < s->e.m->n_patch; i++) {
    const struct vg_flow_patch *p = &s->e.patch[i];

    s->out.n_inlet += p->is_used && p->role == VG_ROLE_INLET;
    s->out.n_outlet += p->is_used && p->role == VG_ROLE_OUTLET;
  }
}

static void turn(struct settle *s, const uint8_t *turned)
{
  struct vg_surface_report *r = s->r;
  size_t n = 0;

  for (size_t t = 0; t < s->m->n_tri; t++) {
    const uint32_t v = s->m->tri[t][1];

    if (r->tri_shell[t] == UINT32_MAX || !turned[r->tri_shell[t]]) continue;
    s->m->tri[t][1] = s->m->tri[t][2];
    s->m->tri[t][2] = v;
  }
  for (size_t i = 0; i < r->n_shell; i++) {
    struct vg_shell *shell = &r->shell[i];

    if (!turned[i]) continue;
    r->n_flipped += shell->n_tri - 2 * shell->n_flipped;
    shell->n_flipped = shell->n_tri - shell->n_flipped;
    shell->volume = -shell->volume;
    n++;
  }
  r->shells_reoriented = n && n == r->n_shell;
}

/* Triangles of m have the same numbers in the whole model. */
static vg_status apply(struct settle *s, struct vg_error *err)
{
  const struct vg_surface_report *whole = s->e.r;
  const int external = s->out.kind == VG_FLOW_EXTERNAL;
  uint8_t *gone = vg_calloc(s->m->n_tri, 1);
  uint8_t *turned = vg_calloc(s->r->n_shell, 1);
  size_t n_gone = 0, n_turned = 0;
  vg_status st = VG_OK;

  if (!gone || !turned) VG_TRY(vg_fail_memory(err, "the shells"));
  for (size_t t = 0; t < s->m->n_tri; t++) {
    const uint32_t shell = whole->tri_shell[t];
    enum fate fate;

    if (shell == UINT32_MAX) continue;
    fate = fate_of(s, shell);
    gone[t] = fate == DROP;
    n_gone += gone[t];
    turned[s->r->tri_shell[t]] |= (whole->shell[shell].volume > 0) !=
                                  (fate == KEEP_OUT);
  }
  for (size_t i = 0; i < s->r->n_shell; i++) n_turned += turned[i];
  if (n_turned && s->o->repair) turn(s, turned);
  if (n_gone || (n_turned && !s->o->repair))
    VG_TRY(drop(s, gone, external, err));
done:
  free(gone);
  free(turned);
  return st;
}

static int is_judged(const struct settle *s)
{
  const struct vg_surface_report *r = s->e.r;

  return s->m->n_tri && !r->count[VG_DEFECT_ORIENTATION] &&
         !r->count[VG_DEFECT_NONMANIFOLD_EDGE] &&
         !r->count[VG_DEFECT_OPEN_EDGE];
}

void vg_flow_release(struct vg_flow *f)
{
  free(f->on_outer);
  *f = (struct vg_flow)VG_FLOW_INIT;
}

/* Collect evidence and verdicts on the current surface. */
static vg_status judge_surface(struct settle *s, struct vg_error *err)
{
  vg_status st;

  VG_TRY(look_for_rims(s, err));
  VG_TRY(s->out.axis < 0
           ? vg_flow_collect(s->m, s->r, 0, &s->e, err)
           : vg_flow_collect(&s->whole, &s->whole_r, 0, &s->e, err));
  if (is_judged(s)) VG_TRY(combine(s, err));
  else s->out.kind = s->o->kind;
done:
  return st;
}

/* A symmetry plane that closes a body is the cap of a half model; a symmetry
 * plane that is part of an outer boundary is not. */
static vg_status judge(struct settle *s, struct vg_error *err)
{
  struct vg_flow before;
  int removed = 0;
  vg_status st = VG_OK;

  if (s->o->half >= VG_HALF_X && s->o->kind != VG_FLOW_INTERNAL)
    VG_TRY(look_for_cap(s, &removed, err));
  VG_TRY(judge_surface(s, err));
  if (removed || s->out.kind != VG_FLOW_EXTERNAL || s->out.axis >= 0) goto done;
  before = s->out;
  s->out = (struct vg_flow)VG_FLOW_INIT;
  VG_TRY(look_for_cap(s, &removed, err));
  if (removed) {
    release(s);
    VG_TRY(judge_surface(s, err));
  } else {
    before.cap_axis = s->out.cap_axis;
    before.cap_at = s->out.cap_at;
    s->out = before;
  }
done:
  return st;
}

vg_status vg_flow_settle(struct vg_mesh *m, struct vg_surface_report *r,
                         const struct vg_flow_options *o, struct vg_flow *out,
                         struct vg_error *err)
{
  struct settle s = { .o = o, .m = m, .r = r, .out = VG_FLOW_INIT };
  vg_status st;

  assert(r && o && out);
  VG_TRY(judge(&s, err));
  if (is_judged(&s)) {
    s.out.on_outer = vg_calloc(m->n_patch, 1);
    if (!s.out.on_outer) VG_TRY(vg_fail_memory(err, "the patches"));
    VG_TRY(mark_outer(&s, err));
    count_shells(&s);
    VG_TRY(apply(&s, err));
  }
  vg_flow_release(out);
  *out = s.out;
  s.out.on_outer = NULL;
done:
  free(s.out.on_outer);
  release(&s);
  return st;
}

vg_status vg_flow_outer(const struct vg_mesh *m,
                        const struct vg_surface_report *r,
                        const struct vg_flow_options *o, uint8_t *outer,
                        size_t *n, struct vg_error *err)
{
  struct settle s = { .o = o, .out = VG_FLOW_INIT };
  vg_status st;

  assert(r && o && (outer || !m->n_tri) && n);
  VG_TRY(vg_flow_collect(m, r, 1, &s.e, err));
  VG_TRY(judge_shells(&s, err));
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t shell = r->tri_shell[t];

    outer[t] = shell != UINT32_MAX && !s.e.depth[shell] &&
               s.verdict[s.e.slot[shell]] == VG_FLOW_OUTER;
  }
  *n = s.out.n_outer;
done:
  release(&s);
  return st;
}

void vg_flow_statement(const struct vg_flow *f, int adds_farfield, char *out)
{
  char half[80] = "", bodies[80] = "";

  if (f->axis >= 0)
    snprintf(half, sizeof half, " (half model, cut at %c = %g)", "xyz"[f->axis],
             f -> at);
  if (f->n_body)
    snprintf(bodies, sizeof bodies, " around %zu closed bod%s", f->n_body,
             f->n_body > 1 ? "ies" : "y");
  if (f->kind == VG_FLOW_EXTERNAL)
    snprintf(out, VG_FLOW_TEXT, "External flow%s%s%s", bodies, half,
             !adds_farfield ? ""
             : f->axis < 0  ? "; farfield added"
                            : "; symmetry plane and half a farfield added");
  else if (f->kind != VG_FLOW_INTERNAL)
    snprintf(out, VG_FLOW_TEXT, "Not decided");
  else if (f->n_inlet + f->n_outlet)
    snprintf(out, VG_FLOW_TEXT,
             "Internal flow in a closed duct%s%s; inlets: %zu, outlets: %zu",
             bodies, half, f->n_inlet, f->n_outlet);
  else
    snprintf(out, VG_FLOW_TEXT, "Flow%s within %s outer boundar%s%s", bodies,
             f->n_outer > 1 ? "several given" : "the given",
             f->n_outer > 1 ? "ies" : "y", half);
}
