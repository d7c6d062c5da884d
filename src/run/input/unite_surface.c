/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Unites bodies of a surface that cross, overlap or touch each other. */
#include "core/wrap/unite.h"
#include "run/input/shape_parts.h"

static const char *name_of(const struct vg_patch *p, char *text, size_t size)
{
  if (*p->name) snprintf(text, size, "%d (%s)", (int)p->id, p->name);
  else snprintf(text, size, "%d", (int)p->id);
  return text;
}

/* A body that is mostly inside another one may also stand in a tunnel. */
static vg_status refuse_ambiguous(const struct vg_boundary *b,
                                  const struct vg_unite_report *r,
                                  struct vg_error *err)
{
  char inside[120], around[120];

  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the body of patch %s, at (%.6g, %.6g, %.6g), crosses "
                 "that of patch %s and is mostly inside it. This can be read "
                 "in two ways. Choose --flow external (both are bodies, which "
                 "are united, and the fluid is outside) or --flow internal "
                 "(the outer one bounds the fluid, and the inner one is cut "
                 "out of it)",
                 b->read->files.stem,
                 name_of(&b->surface.patch[r->inside], inside, sizeof inside),
                 r->at[0], r->at[1], r->at[2],
                 name_of(&b->surface.patch[r->around], around, sizeof around));
}

vg_status vg_boundary_unite(struct vg_boundary *b, struct vg_display *show,
                            struct vg_error *err)
{
  const struct vg_flow_options flow = vg_boundary_flow_options(b, show);
  const struct vg_unite_options o = { .subtracts = flow.kind ==
                                                   VG_FLOW_INTERNAL,
                                      .stop = { vg_display_stop, show } };
  struct vg_error why = VG_ERROR_INIT;
  struct vg_unite_report r;
  vg_status st;

  vg_display_update(show, "union of bodies", 0, 0);
  st = vg_unite(&b->surface, &b->check, &o, &r, &why);
  if (st < 0) return vg_fail(err, st, "%s: %s", b->read->files.stem, why.text);
  if (st != VG_OK) return st;
  if (r.is_ambiguous && flow.kind == VG_FLOW_UNKNOWN)
    return refuse_ambiguous(b, &r, err);
  vg_note(b->notes,
          o.subtracts
            ? "closed shells that cross or touch the wall around them were cut "
              "out of the fluid: %zu shells in %zu sets, %zu triangles became "
              "%zu"
            : "bodies that cross, overlap or touch each other were united: %zu "
              "shells became %zu, %zu triangles became %zu",
          r.n_shell, r.n_set, r.n_before, r.n_after);
  b->is_united = 1;
  if (b->read->settings.remesh == VG_ANSWER_AUTO) b->is_remeshed = 1;
  return VG_OK;
}
