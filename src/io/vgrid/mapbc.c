/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Both layouts of .mapbc, and the codes: io/vgrid/mapbc.h, formats.md 1.4,
 * 1.5. */
#include "io/vgrid/mapbc.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/stream/convention.h"
#include "io/stream/patch_words.h"

/* --- codes --- */

/* The first row with a code gives its translation. It follows refine's table
 * where that has the code (formats.md 1.5), otherwise the nearest meaning. */
static const struct {
  int32_t usm3d, fun3d;
} pair[] = { { 1, 6662 },    { 1, 6661 },    { 1, 6663 },     { 0, 5050 },
             { 2, 5026 },    { 3, 5000 },    { 3, 5025 },     { 4, 4000 },
             { 4, 4010 },    { 4, 4020 },    { 4, 4075 },     { 4, 4100 },
             { 4, 4110 },    { 4, -4000 },   { 4, -4100 },    { 4, -4110 },
             { 41, 4030 },   { 44, 4000 },   { 5, 3000 },     { 55, 3000 },
             { 101, 5051 },  { 101, 5052 },  { 102, 7011 },   { 103, 7036 },
             { 1001, 7011 }, { 1002, 5051 }, { 11002, 5051 }, { 11003, 5052 },
             { 101, 7012 } };
#define N_PAIR (sizeof pair / sizeof pair[0])

int32_t vg_bc_to_fun3d(int32_t usm3d, int axis)
{
  assert(axis < 3);
  if (usm3d == 1) return axis < 0 ? 3000 : 6661 + axis;
  for (size_t i = 0; i < N_PAIR; i++)
    if (pair[i].usm3d == usm3d) return pair[i].fun3d;
  return usm3d;
}

int32_t vg_bc_to_usm3d(int32_t fun3d)
{
  for (size_t i = 0; i < N_PAIR; i++)
    if (pair[i].fun3d == fun3d) return pair[i].usm3d;
  return fun3d;
}

vg_status vg_patch_axes(const struct vg_mesh *m, int *axis,
                        struct vg_error *err)
{
  double(*box)[6] = vg_alloc(m->n_patch, sizeof *box);
  double lo[3], hi[3], size = 0;

  assert(axis || !m->n_patch);
  if (!box) return vg_fail_memory(err, "the boxes of the patches");
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++)
    if (hi[k] - lo[k] > size) size = hi[k] - lo[k];
  for (size_t i = 0; i < m->n_patch; i++)
    for (int k = 0; k < 3; k++) {
      box[i][k] = hi[k];
      box[i][3 + k] = lo[k];
    }
  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    int is_tri = f < m->n_tri;
    const uint32_t *node = is_tri ? m->tri[f] : m->quad[f - m->n_tri];
    double *b = box[is_tri ? m->tri_patch[f] : m->quad_patch[f - m->n_tri]];

    for (int k = 0; k < (is_tri ? 9 : 12); k++) {
      double x = m->point[node[k / 3]][k % 3];

      if (x < b[k % 3]) b[k % 3] = x;
      if (x > b[3 + k % 3]) b[3 + k % 3] = x;
    }
  }
  for (size_t i = 0; i < m->n_patch; i++) {
    axis[i] = -1;
    for (int k = 2; k >= 0; k--)
      if (box[i][3 + k] >= box[i][k] &&
          box[i][3 + k] - box[i][k] <= 1e-9 * size)
        axis[i] = k;
  }
  free(box);
  return VG_OK;
}

/* --- reading --- */

void vg_mapbc_release(struct vg_mapbc *b)
{
  free(b->entry);
  memset(b, 0, sizeof *b);
}

#define N_TOKEN 6

struct line {
  const char *token[N_TOKEN];
  size_t len[N_TOKEN];
  size_t rest; /* length from the last token to the end of the line */
  int n;
  size_t number;
};

static int next_line(struct vg_input *in, struct line *l)
{
  struct vg_input cut = *in;
  const char *text;
  size_t len;

  l->n = 0;
  l->number = in->line;
  if (!vg_input_line(in, &text, &len)) return 0;
  cut.size = (size_t)((const unsigned char *)text - in->data) + len;
  while (len && isspace((unsigned char)text[len - 1])) len--;
  while (l->n < N_TOKEN &&
         vg_input_token_in_line(&cut, &l->token[l->n], &l->len[l->n]))
    l->n++;
  if (l->n) l->rest = (size_t)(text + len - l->token[l->n - 1]);
  return 1;
}

static int token_int(const struct line *l, int k, int32_t *v)
{
  int64_t wide;

  if (k >= l->n || !vg_parse_int(l->token[k], l->len[k], &wide) ||
      wide < -INT32_MAX || wide > INT32_MAX)
    return 0;
  *v = (int32_t)wide;
  return 1;
}

/* Set the name to the text from token k to the end of the line. */
static void set_name(struct vg_patch *p, const struct line *l, int k)
{
  const char *end;

  p->name[0] = 0;
  if (k >= l->n) return;
  end = l->token[l->n - 1] + l->rest;
  vg_name_from_file(l->token[k], (size_t)(end - l->token[k]), p->name,
                    sizeof p->name);
}

static int is_full_row(const struct line *l)
{
  int32_t v;

  for (int k = 0; k < 5; k++)
    if (!token_int(l, k, &v)) return 0;
  return l->n > 5 && !token_int(l, 5, &v);
}

static vg_status append(struct vg_mapbc *b, size_t *cap,
                        const struct vg_patch *p, struct vg_error *err)
{
  if (vg_reserve(&b->entry, cap, b->n + 1, sizeof *p) < 0)
    return vg_fail_memory(err, "the lines of a .mapbc");
  b->entry[b->n++] = *p;
  return VG_OK;
}

static vg_status bad_line(const struct vg_input *in, size_t number,
                          const char *expected, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_FORMAT, "%s:%zu: expected a line '%s'", in->path,
                 number, expected);
}

/* Read four header lines with any content, then the patches. If a complete
 * patch line is among the first four lines, the header is shorter, and every
 * line that is not a patch line belongs to the header. */
static vg_status parse_vgrid(struct vg_input *in, struct vg_mapbc *b,
                             struct vg_error *err)
{
  struct vg_input look = *in;
  size_t cap = 0;
  struct line l;
  int tolerant = 0;

  for (int i = 0; i < 4 && next_line(&look, &l); i++)
    tolerant |= is_full_row(&l);
  if (!tolerant) *in = look;
  while (next_line(in, &l)) {
    struct vg_patch p = { 0 };
    vg_status st;

    if (!l.n || l.token[0][0] == '#') continue;
    if (tolerant && !is_full_row(&l)) continue;
    if (!token_int(&l, 0, &p.id) || !token_int(&l, 1, &p.bc))
      return bad_line(in, l.number, "patch bc family nsurf surfids name", err);
    if (!token_int(&l, 2, &p.family)) p.family = p.bc;
    set_name(&p, &l, l.n > 5 ? 5 : 6);
    p.bc_fun3d = vg_bc_to_fun3d(p.bc, -1);
    if ((st = append(b, &cap, &p, err)) < 0) return st;
  }
  return VG_OK;
}

static vg_status parse_fun3d(struct vg_input *in, struct vg_mapbc *b,
                             struct vg_error *err)
{
  size_t cap = 0;
  struct line l;

  while (next_line(in, &l) && !l.n) {
  }
  while (next_line(in, &l)) {
    struct vg_patch p = { 0 };
    vg_status st;

    if (!l.n) continue;
    if (!token_int(&l, 0, &p.id) || !token_int(&l, 1, &p.bc_fun3d))
      return bad_line(in, l.number, "id code name", err);
    /* FUN3D accepts these old codes for 5000, 4000 and 3000. */
    if (p.bc_fun3d >= 3 && p.bc_fun3d <= 5)
      p.bc_fun3d = vg_bc_to_fun3d(p.bc_fun3d, -1);
    p.bc = p.family = vg_bc_to_usm3d(p.bc_fun3d);
    set_name(&p, &l, 2);
    if ((st = append(b, &cap, &p, err)) < 0) return st;
  }
  return VG_OK;
}

/* FUN3D's layout is a line with one integer, followed by that many lines. A
 * VGRID title may happen to be a number, but then the lines after the header
 * have five numbers. */
static int looks_fun3d(const struct vg_input *file)
{
  struct vg_input in = *file;
  struct line l;
  int32_t n = 0, v;
  int64_t count = 0;
  int full = 0;

  do {
    if (!next_line(&in, &l)) return 0;
  } while (!l.n);
  if (l.n != 1 || !token_int(&l, 0, &n)) return 0;
  while (next_line(&in, &l)) {
    count += l.n > 0;
    full |= l.n >= 5 && token_int(&l, 2, &v) && token_int(&l, 3, &v) &&
            token_int(&l, 4, &v);
  }
  return count == n || !full;
}

static int compare_entry(const void *a, const void *b)
{
  const struct vg_patch *const *p = a, *const *q = b;

  if ((*p)->id != (*q)->id) return (*p)->id < (*q)->id ? -1 : 1;
  return (*p > *q) - (*p < *q);
}

/* Pointers to the entries, sorted by id; NULL if there is not enough memory. */
static const struct vg_patch **sorted(const struct vg_mapbc *b)
{
  const struct vg_patch **list = vg_alloc(b->n, sizeof *list);

  if (!list) return NULL;
  for (size_t i = 0; i < b->n; i++) list[i] = b->entry + i;
  qsort(list, b->n, sizeof *list, compare_entry);
  return list;
}

static vg_status check_entries(const struct vg_input *in,
                               const struct vg_mapbc *b, struct vg_error *err)
{
  const struct vg_patch **list;
  vg_status st = VG_OK;

  if (!b->n)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: no patch line found; a .mapbc has four header lines "
                   "and then lines 'patch bc family nsurf surfids name', or "
                   "in FUN3D's layout a number of lines and then lines 'id "
                   "code name'",
                   in->path);
  list = sorted(b);
  if (!list) return vg_fail_memory(err, "the lines of a .mapbc");
  for (size_t i = 1; i < b->n && st == VG_OK; i++)
    if (list[i]->id == list[i - 1]->id && list[i]->bc != list[i - 1]->bc)
      st = vg_fail(err, VG_ERR_INPUT,
                   "%s: patch %d is listed twice, with codes %d and %d; "
                   "remove one line",
                   in->path, list[i]->id, list[i - 1]->bc, list[i]->bc);
  free(list);
  return st;
}

vg_status vg_mapbc_parse(struct vg_input *in, struct vg_mapbc *out,
                         struct vg_error *err)
{
  struct vg_mapbc b = VG_MAPBC_INIT;
  vg_status st = VG_OK;
  int64_t announced;

  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: contains binary data; a .mapbc is text", in->path);
  if (looks_fun3d(in)) {
    struct vg_input head = *in;

    b.layout = VG_MAPBC_FUN3D;
    VG_TRY(vg_input_int(&head, &announced, "number of lines", err));
    VG_TRY(parse_fun3d(in, &b, err));
    if (announced != (int64_t)b.n) {
      st = vg_fail(err, VG_ERR_FORMAT,
                   "%s: announces %lld patches but lists %zu", in->path,
                   (long long)announced, b.n);
      goto done;
    }
  } else {
    VG_TRY(parse_vgrid(in, &b, err));
  }
  VG_TRY(check_entries(in, &b, err));
  vg_mapbc_release(out);
  *out = b;
  memset(&b, 0, sizeof b);
done:
  vg_mapbc_release(&b);
  return st;
}

vg_status vg_mapbc_read(const char *path, struct vg_mapbc *out,
                        struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = vg_mapbc_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

/* End of the title of a file that is written next to a mesh. */
static const char output_mark[] = " [written by vanguard mesh]";

vg_status vg_mapbc_is_output(const char *path, int *is, struct vg_error *err)
{
  const size_t n = sizeof output_mark - 1;
  struct vg_input in = VG_INPUT_INIT;
  const char *text;
  size_t len;
  vg_status st;

  *is = 0;
  if (access(path, F_OK)) return VG_OK;
  st = vg_input_open_head(path, 4096, &in, err);
  if (st < 0) return st;
  *is = vg_input_line(&in, &text, &len);
  while (*is && len && isspace((unsigned char)text[len - 1])) len--;
  *is = *is && len >= n && !memcmp(text + len - n, output_mark, n);
  vg_input_release(&in);
  return VG_OK;
}

/* --- applying --- */

static size_t find(const struct vg_patch **list, size_t n, int32_t id)
{
  size_t lo = 0, hi = n;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (list[mid]->id < id) lo = mid + 1;
    else hi = mid;
  }
  return lo < n && list[lo]->id == id ? lo : SIZE_MAX;
}

static void give(const struct vg_mapbc *b, const struct vg_patch *from,
                 int axis, struct vg_patch *to)
{
  to->bc = from->bc;
  to->family = from->family;
  to->bc_fun3d = b->layout == VG_MAPBC_VGRID ? vg_bc_to_fun3d(from->bc, axis)
                                             : from->bc_fun3d;
  if (from->name[0]) memcpy(to->name, from->name, sizeof to->name);
}

static void count_unused(const struct vg_mapbc *b, const struct vg_patch **list,
                         const unsigned char *used,
                         struct vg_mapbc_match *match)
{
  for (size_t i = 0; i < b->n; i++) {
    if (used[i] || (i && list[i]->id == list[i - 1]->id)) continue;
    if (!match->n_unused++) match->first_unused = list[i]->id;
  }
}

static void written_name(const struct vg_patch *p, char name[VG_NAME_MAX])
{
  size_t n = 0;

  for (; p->name[n] && n + 1 < VG_NAME_MAX; n++) {
    unsigned char c = (unsigned char)p->name[n];

    name[n] = c <= 32 || c == 127 ? '_' : p->name[n];
  }
  name[n] = 0;
  if (!n) snprintf(name, VG_NAME_MAX, "patch_%d", p->id);
}

/* Finds the entry of each patch: at[n_patch], indices into `list`; SIZE_MAX: it
 * has none. */
static void find_by_number(const struct vg_mapbc *b,
                           const struct vg_patch **list,
                           const struct vg_mesh *m, size_t *at)
{
  for (size_t i = 0; i < m->n_patch; i++)
    at[i] = find(list, b->n, m->patch[i].id);
}

/* A name in sorted order: of entry `at` of the list, or of patch `at`. */
struct named {
  char name[VG_PATCH_WORD];
  size_t at;
};

static int compare_named(const void *a, const void *b)
{
  const struct named *p = a, *q = b;
  int order = strcmp(p->name, q->name);

  return order ? order : (p->at > q->at) - (p->at < q->at);
}

/* First element with this name, or n. */
static size_t find_name(const struct named *list, size_t n, const char *name)
{
  size_t lo = 0, hi = n;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (strcmp(list[mid].name, name) < 0) lo = mid + 1;
    else hi = mid;
  }
  return lo < n && !strcmp(list[lo].name, name) ? lo : n;
}

/* The names of entries and patches, sorted. An entry is listed by its name and,
 * if that differs, by the word that replaces it in a CGNS file. */
struct names {
  const char *path;
  const struct vg_patch **list;
  struct named *entry, *patch;
  size_t n_list, n_entry, n_patch;
};

static vg_status collect_names(const struct vg_mapbc *b,
                               const struct vg_mesh *m, size_t most,
                               struct names *s, struct vg_error *err)
{
  const struct vg_mesh entries = { .n_patch = b->n, .patch = b->entry };
  char(*word)[VG_PATCH_WORD] = vg_patch_words(&entries, most);

  s->entry = vg_alloc(2 * b->n, sizeof *s->entry);
  s->patch = vg_alloc(m->n_patch, sizeof *s->patch);
  if (!word || !s->entry || !s->patch) {
    free(word);
    return vg_fail_memory(err, "the names in a .mapbc");
  }
  for (size_t i = 0; i < b->n; i++) {
    struct named *to = s->entry + s->n_entry;

    if (!*s->list[i]->name) continue;
    written_name(s->list[i], to->name);
    to[0].at = to[1].at = i;
    strcpy(to[1].name, word[s->list[i] - b->entry]);
    s->n_entry += 1 + (strcmp(to[0].name, to[1].name) != 0);
  }
  for (size_t i = 0; i < m->n_patch; i++) {
    if (!*m->patch[i].name) continue;
    written_name(m->patch + i, s->patch[s->n_patch].name);
    s->patch[s->n_patch++].at = i;
  }
  if (s->n_entry) qsort(s->entry, s->n_entry, sizeof *s->entry, compare_named);
  if (s->n_patch) qsort(s->patch, s->n_patch, sizeof *s->patch, compare_named);
  free(word);
  return VG_OK;
}

/* Is the entry meant for a patch of the mesh that has its name? */
static int is_of_patch(const struct names *s, size_t entry)
{
  for (size_t k = 0; k < s->n_entry; k++)
    if (s->entry[k].at == entry &&
        find_name(s->patch, s->n_patch, s->entry[k].name) < s->n_patch)
      return 1;
  return 0;
}

static int has_common_name(const struct names *s)
{
  for (size_t k = 0; k < s->n_entry; k++)
    if (find_name(s->patch, s->n_patch, s->entry[k].name) < s->n_patch)
      return 1;
  return 0;
}

static int is_same_condition(const struct vg_patch *a, const struct vg_patch *b)
{
  return a->bc == b->bc && a->bc_fun3d == b->bc_fun3d && a->family == b->family;
}

/* No entry has the name of the patch, if it has one. */
static vg_status find_unnamed(const struct names *s, const struct vg_patch *p,
                              size_t *at, struct vg_error *err)
{
  const size_t k = find(s->list, s->n_list, p->id);

  *at = k;
  if (k == SIZE_MAX || !*s->list[k]->name) return VG_OK;
  if (is_of_patch(s, k)) *at = SIZE_MAX;
  else if (*p->name)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: patch %d is '%s' here but '%s' in the mesh, whose "
                   "format has names, and numbers only by their order; write "
                   "the names of the mesh into the .mapbc, or no names to have "
                   "its numbers used; remove or rename the .mapbc if it "
                   "belongs to another mesh",
                   s->path, (int)p->id, s->list[k]->name, p->name);
  return VG_OK;
}

/* The entry with the name of the patch; of several, that with its number. */
static vg_status find_named(const struct names *s, const struct vg_patch *p,
                            size_t *at, struct vg_error *err)
{
  char name[VG_NAME_MAX];
  size_t k;

  written_name(p, name);
  k = *p->name ? find_name(s->entry, s->n_entry, name) : s->n_entry;
  if (k == s->n_entry) return find_unnamed(s, p, at, err);
  *at = s->entry[k].at;
  for (size_t i = k; i < s->n_entry && !strcmp(s->entry[i].name, name); i++)
    if (s->list[s->entry[i].at]->id == p->id) {
      *at = s->entry[i].at;
      return VG_OK;
    }
  for (size_t i = k; i < s->n_entry && !strcmp(s->entry[i].name, name); i++) {
    const struct vg_patch *a = s->list[*at], *b = s->list[s->entry[i].at];

    if (!is_same_condition(a, b))
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: lines %d and %d, with codes %d and %d, both have the "
                     "name '%s' of patch %d of the mesh, whose format has "
                     "names, and numbers only by their order; give the lines "
                     "different names, or this patch's number to one of them",
                     s->path, (int)a->id, (int)b->id, (int)a->bc, (int)b->bc,
                     p->name, (int)p->id);
  }
  return VG_OK;
}

static vg_status find_by_name(const char *path, const struct vg_mapbc *b,
                              const struct vg_patch **list, size_t most,
                              const struct vg_mesh *m, size_t *at,
                              struct vg_error *err)
{
  struct names s = { .path = path, .list = list, .n_list = b->n };
  vg_status st = collect_names(b, m, most, &s, err);

  if (st >= 0 && !has_common_name(&s)) find_by_number(b, list, m, at);
  else
    for (size_t i = 0; i < m->n_patch && st >= 0; i++)
      st = find_named(&s, m->patch + i, &at[i], err);
  free(s.entry);
  free(s.patch);
  return st;
}

/* Does the entry, which has the number of the patch, give it another name? */
static int is_renamed(const struct vg_patch *entry, const struct vg_patch *p)
{
  char a[VG_NAME_MAX], b[VG_NAME_MAX];

  if (entry->id != p->id || !*entry->name || !*p->name) return 0;
  written_name(entry, a);
  written_name(p, b);
  return strcmp(a, b) != 0;
}

/* most: 0 to match by number, otherwise as in vg_mapbc_apply_names. */
static vg_status apply(const char *path, const struct vg_mapbc *b, size_t most,
                       struct vg_mesh *m, struct vg_mapbc_match *match,
                       struct vg_error *err)
{
  struct vg_mapbc_match found = { 0 };
  const struct vg_patch **list = sorted(b);
  unsigned char *used = vg_calloc(b->n, 1);
  int *axis = vg_alloc(m->n_patch, sizeof *axis);
  size_t *at = vg_alloc(m->n_patch, sizeof *at);
  vg_status st = VG_OK;

  assert(b->entry || !b->n);
  if (!list || !used || !axis || !at)
    VG_TRY(vg_fail_memory(err, "the boundary conditions"));
  VG_TRY(vg_patch_axes(m, axis, err));
  if (most) VG_TRY(find_by_name(path, b, list, most, m, at, err));
  else find_by_number(b, list, m, at);
  for (size_t i = 0; i < m->n_patch; i++) {
    if (at[i] == SIZE_MAX) {
      if (!found.n_missing++) found.first_missing = m->patch[i].id;
      continue;
    }
    used[at[i]] = 1;
    if (most && is_renamed(list[at[i]], m->patch + i) && !found.n_renamed++)
      found.first_renamed = m->patch[i].id;
    give(b, list[at[i]], axis[i], m->patch + i);
  }
  count_unused(b, list, used, &found);
  if (match) *match = found;
done:
  free(list);
  free(used);
  free(axis);
  free(at);
  return st;
}

vg_status vg_mapbc_apply(const struct vg_mapbc *b, struct vg_mesh *m,
                         struct vg_mapbc_match *match, struct vg_error *err)
{
  return apply("", b, 0, m, match, err);
}

vg_status vg_mapbc_apply_names(const char *path, const struct vg_mapbc *b,
                               size_t most, struct vg_mesh *m,
                               struct vg_mapbc_match *match,
                               struct vg_error *err)
{
  assert(path && most);
  return apply(path, b, most, m, match, err);
}

/* --- writing --- */

static void codes_of(const struct vg_patch *p, int axis, int32_t *usm3d,
                     int32_t *fun3d, size_t *n_unset)
{
  *usm3d = p->bc;
  *fun3d = p->bc_fun3d;
  if (*usm3d == VG_BC_NONE && *fun3d == VG_BC_NONE) {
    *usm3d = 5;
    ++*n_unset;
  }
  if (*usm3d == VG_BC_NONE) *usm3d = vg_bc_to_usm3d(*fun3d);
  if (*fun3d == VG_BC_NONE) *fun3d = vg_bc_to_fun3d(*usm3d, axis);
}

static void put_header(struct vg_output *out, enum vg_mapbc_layout layout,
                       const char *title, const char *mark, size_t n)
{
  if (layout == VG_MAPBC_FUN3D) {
    vg_output_format(out, "%zu\n", n);
    return;
  }
  vg_output_format(out, "#%.900s%s\n", title ? title : "vanguard", mark);
  vg_output_text(out,
                 "#bc.map\n"
                 "Patch #        BC             Family   #surf   surfIDs"
                 "         Family\n"
                 "#---------------------------------------------------------"
                 "------------\n");
}

static vg_status write_marked(const char *path, const struct vg_mesh *m,
                              enum vg_mapbc_layout layout, const char *title,
                              const char *mark, size_t *n_unset,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  int *axis = vg_alloc(m->n_patch, sizeof *axis);
  size_t unset = 0;
  vg_status st;

  if (!axis) return vg_fail_memory(err, "the boundary conditions");
  VG_TRY(vg_patch_axes(m, axis, err));
  VG_TRY(vg_output_open(path, &out, err));
  put_header(&out, layout, title, mark, m->n_patch);
  for (size_t i = 0; i < m->n_patch; i++) {
    const struct vg_patch *p = m->patch + i;
    char name[VG_NAME_MAX];
    int32_t usm3d, fun3d;

    written_name(p, name);
    codes_of(p, axis[i], &usm3d, &fun3d, &unset);
    if (layout == VG_MAPBC_FUN3D)
      vg_output_format(&out, "%d %d %s\n", p->id, fun3d, name);
    else
      vg_output_format(&out, "%-14d %-14d %-14d %-12d %-8d %s\n", p->id, usm3d,
                       p->family == VG_BC_NONE ? usm3d : p->family, 0, 0, name);
  }
  VG_TRY(vg_output_commit(&out, err));
  if (n_unset) *n_unset = unset;
done:
  free(axis);
  return st;
}

vg_status vg_mapbc_write(const char *path, const struct vg_mesh *m,
                         enum vg_mapbc_layout layout, const char *title,
                         size_t *n_unset, struct vg_error *err)
{
  assert(layout == VG_MAPBC_VGRID || layout == VG_MAPBC_FUN3D);
  return write_marked(path, m, layout, title, "", n_unset, err);
}

vg_status vg_mapbc_write_output(const char *path, const struct vg_mesh *m,
                                const char *title, size_t *n_unset,
                                struct vg_error *err)
{
  return write_marked(path, m, VG_MAPBC_VGRID, title, output_mark, n_unset,
                      err);
}
