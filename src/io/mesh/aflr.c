/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* .surf, .tags and AFLR's .bc; see io/mesh/aflr.h and formats.md 2.5 and
 * 2.6. */
#include "io/mesh/aflr.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/convention.h"

void vg_aflr_release(struct vg_aflr *a)
{
  const struct vg_aflr empty = VG_AFLR_INIT;

  free(a->patch);
  free(a->spacing);
  free(a->thickness);
  *a = empty;
}

static void move(struct vg_aflr *to, struct vg_aflr *from)
{
  const struct vg_aflr empty = VG_AFLR_INIT;

  vg_aflr_release(to);
  *to = *from;
  *from = empty;
}

/* --- lines --- */

enum { TOKENS = 16 };

struct row {
  const char *token[TOKENS];
  size_t len[TOKENS];
  int n; /* number of tokens; TOKENS + 1 if there are more than that */
  size_t line;
};

/* Read the next line that is neither blank nor a comment; returns 0 at the
 * end. */
static int next_row(struct vg_input *in, struct row *r)
{
  const char *text;
  size_t len;

  for (;;) {
    struct vg_input cut = *in;

    r->n = 0;
    r->line = in->line;
    if (!vg_input_line(in, &text, &len)) return 0;
    cut.size = (size_t)((const unsigned char *)text - in->data) + len;
    while (r->n < TOKENS &&
           vg_input_token_in_line(&cut, &r->token[r->n], &r->len[r->n]))
      r->n++;
    if (r->n == TOKENS && vg_input_token_in_line(&cut, &text, &len)) r->n++;
    if (r->n && r->token[0][0] != '#') return 1;
  }
}

static vg_status bad_row(const struct vg_input *in, const struct row *r,
                         const char *expected, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT, "%s:%zu: expected a line '%s'", in->path,
                 r->line, expected);
}

static int row_int(const struct row *r, int k, int32_t *v)
{
  int64_t wide;

  if (!vg_parse_int(r->token[k], r->len[k], &wide) || wide < INT32_MIN ||
      wide > INT32_MAX)
    return 0;
  *v = (int32_t)wide;
  return 1;
}

/* Read a length, which must not be negative. */
static int row_length(const struct row *r, int k, double *v)
{
  return vg_parse_real(r->token[k], r->len[k], v) && *v >= 0;
}

static void row_name(const struct row *r, int k, char name[VG_NAME_MAX])
{
  vg_name_from_file(r->token[k], r->len[k], name, VG_NAME_MAX);
}

static vg_status append(struct vg_aflr *a, size_t *cap,
                        const struct vg_aflr_patch *p, struct vg_error *err)
{
  if (vg_reserve(&a->patch, cap, a->n + 1, sizeof *p) < 0)
    return vg_fail_memory(err, "the lines of a file");
  a->patch[a->n++] = *p;
  return VG_OK;
}

static int by_id(const void *a, const void *b)
{
  const struct vg_aflr_patch *const *p = a, *const *q = b;

  return ((*p)->id > (*q)->id) - ((*p)->id < (*q)->id);
}

static int by_name(const void *a, const void *b)
{
  const struct vg_aflr_patch *const *p = a, *const *q = b;

  return strcmp((*p)->name, (*q)->name);
}

/* Return pointers to the entries, sorted by `compare`; entries that compare
 * equal are an error. */
static vg_status sort_unique(const char *path, const struct vg_aflr *a,
                             int (*compare)(const void *, const void *),
                             const struct vg_aflr_patch ***list,
                             struct vg_error *err)
{
  const struct vg_aflr_patch **l = vg_alloc(a->n, sizeof *l);

  if (!l) return vg_fail_memory(err, "the lines of a file");
  for (size_t i = 0; i < a->n; i++) l[i] = a->patch + i;
  qsort(l, a->n, sizeof *l, compare);
  for (size_t i = 1; i < a->n; i++)
    if (!compare(l + i - 1, l + i)) {
      vg_fail(err, VG_ERR_INPUT,
              "%s: patch %d %s is listed twice; remove one line", path,
              l[i]->id, l[i]->name);
      free(l);
      return VG_ERR_INPUT;
    }
  *list = l;
  return VG_OK;
}

static vg_status check_unique(const char *path, const struct vg_aflr *a,
                              int (*compare)(const void *, const void *),
                              struct vg_error *err)
{
  const struct vg_aflr_patch **list = NULL;
  vg_status st = sort_unique(path, a, compare, &list, err);

  free(list);
  return st;
}

static vg_status refuse_binary(const struct vg_input *in, const char *what,
                               struct vg_error *err)
{
  if (vg_input_is_text(in)) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT, "%s: contains binary data; %s is text",
                 in->path, what);
}

/* --- .tags --- */

/* Flag that corresponds to the properties of a line. Of properties that exclude
 * each other the last one counts. */
static int32_t flag_of(const int32_t on[7])
{
  enum { VISC, RECON, REBUILD, FIXED, SOURCE, TRANS, DELETE };

  if (on[DELETE] || on[TRANS]) return 5;
  if (on[SOURCE]) return 3;
  if (on[FIXED]) return 7;
  if (on[REBUILD]) return 2;
  return on[VISC] ? -1 : 0;
}

static int parse_tag(const struct row *r, struct vg_aflr_patch *p)
{
  int32_t on[7];
  int k = 2;

  if (r->n < 10 || r->n > 12 || !row_int(r, 0, &p->id)) return 0;
  row_name(r, 1, p->name);
  for (int i = 0; i < 7; i++) {
    on[i] = 0;
    if (i == 3 && r->n == 10) continue; /* old files have no `fixed` */
    if (!row_int(r, k++, on + i)) return 0;
  }
  p->flag = flag_of(on);
  p->is_viscous = p->flag < 0;
  if (!row_length(r, k, &p->spacing) || !row_length(r, k + 1, &p->thickness))
    return 0;
  p->n_layer = 0;
  return r->n < 12 || (row_int(r, 11, &p->n_layer) && p->n_layer >= 0);
}

vg_status vg_aflr_tags_parse(struct vg_input *in, struct vg_aflr *out,
                             struct vg_error *err)
{
  struct vg_aflr a = VG_AFLR_INIT;
  struct row r;
  size_t cap = 0;
  vg_status st = refuse_binary(in, "a .tags", err);

  if (st < 0) return st;
  while (next_row(in, &r)) {
    struct vg_aflr_patch p = { 0 };

    if (!parse_tag(&r, &p)) {
      st = bad_row(in, &r,
                   "id group visc recon rebuild fixed source trans "
                   "delete spacing thickness layers",
                   err);
      goto done;
    }
    VG_TRY(append(&a, &cap, &p, err));
  }
  VG_TRY(check_unique(in->path, &a, by_id, err));
  move(out, &a);
done:
  vg_aflr_release(&a);
  return st;
}

/* --- .bc --- */

static int is_vgrid_head(const struct row *r)
{
  int32_t v;

  if (r->n != 4) return 0;
  for (int k = 0; k < 4; k++)
    if (!row_int(r, k, &v)) return 0;
  return 1;
}

vg_status vg_aflr_bc_parse(struct vg_input *in, struct vg_aflr *out,
                           struct vg_error *err)
{
  struct vg_aflr a = VG_AFLR_INIT;
  struct row r;
  size_t cap = 0;
  vg_status st = refuse_binary(in, "an AFLR .bc", err);

  if (st < 0) return st;
  while (next_row(in, &r)) {
    struct vg_aflr_patch p = { 0 };

    if (!a.n && is_vgrid_head(&r)) {
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: this is the list of triangles of a VGRID mesh, not "
                   "AFLR's list of lines 'name flag spacing'",
                   in->path);
      goto done;
    }
    if (r.n < 2 || r.n > 4 || !row_int(&r, 1, &p.flag) ||
        p.flag == VG_AFLR_NONE || (r.n > 2 && !row_length(&r, 2, &p.spacing)) ||
        (r.n > 3 && !row_length(&r, 3, &p.thickness))) {
      st = bad_row(in, &r, "name flag [spacing [thickness]]", err);
      goto done;
    }
    row_name(&r, 0, p.name);
    p.is_viscous = p.flag < 0;
    VG_TRY(append(&a, &cap, &p, err));
  }
  VG_TRY(check_unique(in->path, &a, by_name, err));
  move(out, &a);
done:
  vg_aflr_release(&a);
  return st;
}

int vg_aflr_is_bc(const char *path)
{
  struct vg_input in = VG_INPUT_INIT;
  struct row r;
  int is;

  if (vg_input_open_head(path, 65536, &in, NULL) < 0) return 0;
  is = vg_input_is_text(&in) && next_row(&in, &r) && !is_vgrid_head(&r);
  vg_input_release(&in);
  return is;
}

/* --- applying --- */

static const struct vg_aflr_patch *find(
  const struct vg_aflr_patch **list, size_t n, const struct vg_aflr_patch *key,
  int (*compare)(const void *, const void *))
{
  const struct vg_aflr_patch **at = bsearch(&key, list, n, sizeof *list,
                                            compare);

  return at ? *at : NULL;
}

static int is_viscous_wall(const struct vg_patch *p)
{
  return p->bc == 4 || (p->bc == VG_BC_NONE && p->bc_fun3d == 4000);
}

static void set_condition(struct vg_patch *p, int32_t bc, int32_t bc_fun3d)
{
  p->bc = p->family = bc;
  p->bc_fun3d = bc_fun3d;
}

static void give(const struct vg_aflr_patch *from, struct vg_patch *to)
{
  if (!to->name[0]) memcpy(to->name, from->name, sizeof to->name);
  if (from->is_viscous && !is_viscous_wall(to)) set_condition(to, 4, 4000);
  if (!from->is_viscous && is_viscous_wall(to)) set_condition(to, 5, 3000);
}

vg_status vg_aflr_apply(const struct vg_aflr *a, struct vg_mesh *m,
                        size_t *n_unused, struct vg_error *err)
{
  int (*compare)(const void *, const void *) = by_name;
  const struct vg_aflr_patch **list = NULL;
  unsigned char *used = vg_calloc(a->n, 1);
  size_t unused = a->n;
  vg_status st;

  if (!used) return vg_fail_memory(err, "the settings of patches");
  for (size_t i = 0; i < a->n; i++)
    if (a->patch[i].id) compare = by_id;
  VG_TRY(sort_unique("settings of patches", a, compare, &list, err));
  for (size_t i = 0; i < m->n_patch; i++) {
    struct vg_aflr_patch key = { .id = m->patch[i].id };
    const struct vg_aflr_patch *from;

    memcpy(key.name, m->patch[i].name, sizeof key.name);
    from = find(list, a->n, &key, compare);
    if (!from) continue;
    give(from, m->patch + i);
    unused -= !used[from - a->patch];
    used[from - a->patch] = 1;
  }
  if (n_unused) *n_unused = unused;
done:
  free(used);
  free(list);
  return st;
}

/* --- files --- */

static vg_status read_file(const char *path, struct vg_aflr *a,
                           vg_status (*parse)(struct vg_input *,
                                              struct vg_aflr *,
                                              struct vg_error *),
                           struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = parse(&in, a, err);
  vg_input_release(&in);
  return st;
}

vg_status vg_aflr_tags_read(const char *path, struct vg_aflr *a,
                            struct vg_error *err)
{
  return read_file(path, a, vg_aflr_tags_parse, err);
}

vg_status vg_aflr_bc_read(const char *path, struct vg_aflr *a,
                          struct vg_error *err)
{
  return read_file(path, a, vg_aflr_bc_parse, err);
}
