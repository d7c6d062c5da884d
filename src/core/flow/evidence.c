/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: shells are arranged in trees by nesting. Each outermost shell gets
 * the roles of its patches. Shells that contain others, and a shell that is the
 * only one, are compared with their convex hull. */
#include "core/flow/evidence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_flow_evidence_release(struct vg_flow_evidence *e)
{
  free(e->patch);
  free(e->shell);
  free(e->slot);
  free(e->depth);
  free(e->crossed);
  free(e->in_pocket);
  memset(e, 0, sizeof *e);
}

/* --- nesting ------------------------------------------------------------- */

static int box_contains(const struct vg_shell *a, const struct vg_shell *b)
{
  for (int k = 0; k < 3; k++)
    if (!(a->lo[k] < b->lo[k] && b->hi[k] < a->hi[k])) return 0;
  return 1;
}

static void find_crossed(struct vg_flow_evidence *e)
{
  const struct vg_surface_report *r = e->r;

  for (size_t i = 0; i < r->n_defect; i++) {
    const size_t *f = r->defect[i].face;
    uint32_t a, b;

    if (r->defect[i].kind != VG_DEFECT_INTERSECTION || f[0] >= e->m->n_tri ||
        f[1] >= e->m->n_tri)
      continue;
    a = r->tri_shell[f[0]];
    b = r->tri_shell[f[1]];
    if (a != UINT32_MAX && b != UINT32_MAX && a != b)
      e->crossed[a] = e->crossed[b] = 1;
  }
}

/* The outermost closed shell around shell i, which is shell i itself in most
 * cases. A shell that is not closed has no nesting; with by_box it belongs to
 * the largest closed shell if that shell's box contains its box. */
static size_t top_of(const struct vg_flow_evidence *e, size_t i, size_t largest)
{
  const struct vg_surface_report *r = e->r;
  size_t top = i;

  if (!r->shell[i].is_closed && largest != SIZE_MAX && largest != i &&
      box_contains(&r->shell[largest], &r->shell[i]))
    return largest;
  while (r->shell[top].is_closed && r->shell[top].depth > 0 &&
         r->shell[top].parent != SIZE_MAX && !e->crossed[top])
    top = r->shell[top].parent;
  return top;
}

static size_t largest_closed(const struct vg_surface_report *r)
{
  size_t largest = SIZE_MAX;

  for (size_t i = 0; i < r->n_shell; i++)
    if (r->shell[i].is_closed && !r->shell[i].depth &&
        (largest == SIZE_MAX || box_contains(&r->shell[i], &r->shell[largest])))
      largest = i;
  return largest;
}

/* List the outermost shells by number; then add up the shells inside them. */
static void list_shells(struct vg_flow_evidence *e, int by_box)
{
  const struct vg_surface_report *r = e->r;
  const size_t largest = by_box ? largest_closed(r) : SIZE_MAX;

  for (uint32_t i = 0; i < r->n_shell; i++) {
    if (top_of(e, i, largest) != i) continue;
    e->slot[i] = (uint32_t)e->n_shell;
    e->shell[e->n_shell++] = (struct vg_flow_shell){
      .shell = i,
      .is_closed = r->shell[i].is_closed,
      .points_in = r->shell[i].volume < 0
    };
  }
  for (uint32_t i = 0; i < r->n_shell; i++) {
    const size_t top = top_of(e, i, largest);
    struct vg_flow_shell *s = &e->shell[e->slot[top]];

    if (top == i) continue;
    e->slot[i] = e->slot[top];
    e->depth[i] = r->shell[i].is_closed ? r->shell[i].depth : 1;
    if (e->depth[i] != 1) continue;
    s->n_inside++;
    s->share += fabs(r->shell[i].volume) / fabs(r->shell[top].volume);
    s->detail += (double)r->shell[i].n_tri / (double)r->shell[top].n_tri;
  }
}

/* --- patches ------------------------------------------------------------- */

static void list_patch(char *list, size_t size, const struct vg_patch *p)
{
  const size_t n = strlen(list);

  if (n + 40 > size) {
    if (n + 6 < size && strcmp(list + n - 3, "...") != 0)
      strcpy(list + n, ", ...");
    return;
  }
  snprintf(list + n, size - n, "%s%d%s%.24s%s", n ? ", " : "", (int)p->id,
           *p->name ? " (" : "", p->name, *p->name ? ")" : "");
}

static void add_patch(struct vg_flow_shell *s, const struct vg_flow_patch *p,
                      const struct vg_patch *named)
{
  const int is_opening = p->role == VG_ROLE_INLET || p->role == VG_ROLE_OUTLET;

  s->n_role[p->role]++;
  s->is_named_enclosure |= vg_flow_is_enclosure(named);
  s->n_symmetry_end += p->role == VG_ROLE_SYMMETRY && p->is_end;
  if (p->role == VG_ROLE_FARFIELD) list_patch(s->far, sizeof s->far, named);
  if (p->role == VG_ROLE_NONE && p->is_end) {
    s->n_plain_end++;
    list_patch(s->plain, sizeof s->plain, named);
  }
  if (!is_opening || (!p->has_condition && !p->is_flat)) return;
  s->n_opening++;
  s->n_opening_end += p->is_end != 0;
  s->n_opening_flush += p->is_flush != 0;
  list_patch(s->openings, sizeof s->openings, named);
}

static void add_patches(struct vg_flow_evidence *e)
{
  for (size_t i = 0; i < e->m->n_patch; i++) {
    const struct vg_flow_patch *p = &e->patch[i];

    if (!p->is_used || p->shell == UINT32_MAX || e->depth[p->shell]) continue;
    add_patch(&e->shell[e->slot[p->shell]], p, &e->m->patch[i]);
  }
}

vg_status vg_flow_collect(const struct vg_mesh *m,
                          const struct vg_surface_report *r, int by_box,
                          struct vg_flow_evidence *e, struct vg_error *err)
{
  vg_status st;

  e->m = m;
  e->r = r;
  e->slot = vg_calloc(r->n_shell, sizeof *e->slot);
  e->depth = vg_calloc(r->n_shell, sizeof *e->depth);
  e->shell = vg_calloc(r->n_shell, sizeof *e->shell);
  e->crossed = vg_calloc(r->n_shell, 1);
  if (!e->slot || !e->depth || !e->shell || !e->crossed)
    VG_TRY(vg_fail_memory(err, "the shells"));
  find_crossed(e);
  list_shells(e, by_box);
  VG_TRY(vg_flow_patches(m, r, &e->patch, err));
  add_patches(e);
  for (size_t i = 0; i < e->n_shell; i++)
    if (e->shell[i].is_closed && (e->shell[i].n_inside || e->n_shell == 1))
      VG_TRY(vg_flow_measure_shape(e, &e->shell[i], err));
done:
  return st;
}
