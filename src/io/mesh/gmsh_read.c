/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader of Gmsh's .msh; see io/mesh/gmsh.h. Sections are enclosed by $Name and
 * $EndName; unknown sections are skipped. Versions 2.x have 4-byte integers in
 * binary files, and groups with every element. Version 4.1 has sizes and tags
 * of nodes and elements of 4 or 8 bytes, and groups with entities. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/gmsh.h"
#include "io/mesh/gmsh_parts.h"
#include "io/stream/convention.h"

enum { NODES_MOST = 8 };

/* Gmsh's element types of first order, and lines and points of any order. Slot
 * k of the file is our node slot[k]. */
enum element { SKIPPED, TRI, QUAD, TET, PYR, PRI, HEX, N_ELEMENT };

static const struct type {
  int64_t code;
  enum element element;
  int n_node, slot[NODES_MOST];
} types[] = {
  { 2, TRI, 3, { 0, 1, 2 } },
  { 3, QUAD, 4, { 0, 1, 2, 3 } },
  { 4, TET, 4, { 0, 1, 2, 3 } },
  { 7, PYR, 5, { 0, 3, 4, 1, 2 } },
  { 6, PRI, 6, { 0, 1, 2, 3, 4, 5 } },
  { 5, HEX, 8, { 0, 1, 2, 3, 4, 5, 6, 7 } },
  { 15, SKIPPED, 1, { 0 } },
  { 1, SKIPPED, 2, { 0 } },
  { 8, SKIPPED, 3, { 0 } },
  { 26, SKIPPED, 4, { 0 } },
  { 27, SKIPPED, 5, { 0 } },
  { 28, SKIPPED, 6, { 0 } },
};

struct numbered {
  int64_t tag;
  uint32_t at;
};

struct reader {
  struct vg_input *in;
  int version;      /* 2 or 4; 0: not read yet */
  int binary, wide; /* wide: sizes have 8 bytes */
  struct vg_mesh m;
  size_t cap_point, cap[N_ELEMENT];
  struct vg_gmsh_group *of[N_ELEMENT]; /* surface or volume and group of each
                                          face and cell, by element */
  size_t cap_of[N_ELEMENT];
  struct vg_gmsh_name *name; /* names of the physical groups */
  size_t n_name, cap_name;
  /* Groups of the surfaces and of the volumes, sorted by surface or volume. */
  struct vg_gmsh_group *group[2];
  size_t n_group[2], cap_group[2];
  struct vg_gmsh_side *side;  /* surfaces of the volumes */
  struct vg_cad_zones *zones; /* receives the volumes of a surface; or NULL */
  size_t n_side, cap_side;
  struct numbered *node; /* [n_point] sorted by tag */
  int is_run; /* tags are consecutive: first_tag, first_tag + 1, ... */
  int seen_nodes;
};

static vg_status fail_at(const struct reader *r, struct vg_error *err,
                         const char *text)
{
  if (!r->binary) return vg_input_fail(r->in, err, "%s", text);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s (near byte %zu)", r->in->path,
                 text, r->in->at);
}

/* --- numbers --- */

/* Read n integers. In binary files they have 4 bytes or the size of sizes. */
static vg_status read_ints(struct reader *r, size_t n, int64_t *v,
                           const char *what, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t k = 0; k < n && st == VG_OK; k++) {
    int32_t narrow = 0;

    if (!r->binary) {
      st = vg_input_int(r->in, &v[k], what, err);
      continue;
    }
    st = vg_input_i32(r->in, 1, &narrow, what, err);
    v[k] = narrow;
  }
  return st;
}

static vg_status read_sizes(struct reader *r, size_t n, int64_t *v,
                            const char *what, struct vg_error *err)
{
  if (!r->binary || !r->wide) return read_ints(r, n, v, what, err);
  return vg_input_i64(r->in, n, v, what, err);
}

static vg_status read_reals(struct reader *r, size_t n, double *v,
                            const char *what, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (r->binary) return vg_input_f64(r->in, n, v, what, err);
  for (size_t k = 0; k < n && st == VG_OK; k++)
    st = vg_input_real(r->in, &v[k], what, err);
  return st;
}

/* Check a count of items against the remaining bytes. In a binary file an item
 * has n_size sizes and n_int other integers; in text it has n_size + n_int
 * numbers. */
static vg_status check_count(const struct reader *r, int64_t n, size_t n_size,
                             size_t n_int, const char *what,
                             struct vg_error *err)
{
  size_t bytes = r->binary ? n_size * (r->wide ? 8 : 4) + 4 * n_int
                           : 2 * (n_size + n_int);

  if (n < 0 || n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: %lld %s: the count is negative "
                   "or beyond 32 bits",
                   r->in->path, (long long)n, what);
  /* The last number of a text needs no blank after it. */
  return n
         ? vg_input_need(r->in, (uint64_t)n * bytes - !r->binary, 1, what, err)
         : VG_OK;
}

/* --- names, groups --- */

static vg_status read_name(struct reader *r, struct vg_error *err)
{
  const char *line, *first, *last;
  size_t len;
  int64_t v[2];
  vg_status st;

  for (int k = 0; k < 2; k++)
    VG_TRY(vg_input_int(r->in, &v[k], "a physical group", err));
  if (!vg_input_line(r->in, &line, &len) || !(first = memchr(line, '"', len)))
    return vg_input_fail(r->in, err,
                         "the name of a physical group is not in quotes");
  for (last = line + len - 1; *last != '"'; last--) {
  }
  if (last == first)
    return vg_input_fail(r->in, err,
                         "the name of a physical group has no closing quote");
  if (v[0] != 2 && v[0] != 3) return VG_OK;
  if (vg_reserve(&r->name, &r->cap_name, r->n_name + 1, sizeof *r->name))
    return vg_fail_memory(err, "the names of the patches");
  r->name[r->n_name].dimension = (int)v[0];
  r->name[r->n_name].tag = v[1];
  vg_name_from_file(first + 1, (size_t)(last - first - 1),
                    r->name[r->n_name++].text, VG_NAME_MAX);
done:
  return st;
}

static vg_status read_names(struct reader *r, struct vg_error *err)
{
  int64_t n;
  vg_status st = vg_input_int(r->in, &n, "the number of names", err);

  for (int64_t i = 0; i < n && st == VG_OK; i++) st = read_name(r, err);
  return st;
}

/* Skip the remaining integers of a list of n. */
static vg_status skip_ints(struct reader *r, int64_t n, const char *what,
                           struct vg_error *err)
{
  vg_status st = check_count(r, n, 0, 1, what, err);
  int64_t v;

  for (int64_t i = 0; i < n && st == VG_OK; i++)
    st = read_ints(r, 1, &v, what, err);
  return st;
}

static vg_status read_sides(struct reader *r, int64_t volume, int64_t n,
                            struct vg_error *err)
{
  vg_status st = check_count(r, n, 0, 1, "a volume", err);

  if (st >= 0 && vg_reserve(&r->side, &r->cap_side, r->n_side + (size_t)n,
                            sizeof *r->side) < 0)
    return vg_fail_memory(err, "the volumes");
  for (; n > 0 && st >= 0; n--) {
    int64_t v = 0;

    st = read_ints(r, 1, &v, "a volume", err);
    if (v < 0 && v > INT64_MIN) v = -v; /* its orientation */
    r->side[r->n_side++] = (struct vg_gmsh_side){ v, volume };
  }
  return st;
}

static vg_status read_entity(struct reader *r, int dimension,
                             struct vg_error *err)
{
  static const char what[] = "an entity";
  int64_t tag, n, physical = 0;
  const int k = dimension - 2;
  double box[6];
  vg_status st;

  VG_TRY(read_ints(r, 1, &tag, what, err));
  VG_TRY(read_reals(r, dimension ? 6 : 3, box, what, err));
  VG_TRY(read_sizes(r, 1, &n, what, err));
  if (n > 0) VG_TRY(read_ints(r, 1, &physical, what, err));
  VG_TRY(skip_ints(r, n > 0 ? n - 1 : n, what, err));
  if (dimension) {
    VG_TRY(read_sizes(r, 1, &n, what, err));
    VG_TRY(dimension == 3 ? read_sides(r, tag, n, err)
                          : skip_ints(r, n, what, err));
  }
  if (dimension < 2) return VG_OK;
  if (vg_reserve(&r->group[k], &r->cap_group[k], r->n_group[k] + 1,
                 sizeof **r->group))
    return vg_fail_memory(err, "the surfaces");
  /* Negative: the group contains the surface with reversed orientation. */
  r->group[k][r->n_group[k]++] = (struct vg_gmsh_group){ tag, llabs(physical) };
done:
  return st;
}

static int by_surface(const void *a, const void *b)
{
  const struct vg_gmsh_group *p = a, *q = b;

  if (p->surface != q->surface) return p->surface < q->surface ? -1 : 1;
  return (p->physical > q->physical) - (p->physical < q->physical);
}

static vg_status read_entities(struct reader *r, struct vg_error *err)
{
  int64_t n[4];
  vg_status st;

  if (r->version == 2)
    return fail_at(r, err, "entities in a file of version 2");
  VG_TRY(read_sizes(r, 4, n, "the numbers of entities", err));
  for (int d = 0; d < 4; d++) {
    VG_TRY(check_count(r, n[d], 0, 1, "entities", err));
    for (int64_t i = 0; i < n[d]; i++) VG_TRY(read_entity(r, d, err));
  }
  for (int k = 0; k < 2; k++)
    if (r->n_group[k])
      qsort(r->group[k], r->n_group[k], sizeof **r->group, by_surface);
done:
  return st;
}

/* --- nodes --- */

static vg_status reserve_points(struct reader *r, int64_t n,
                                struct vg_error *err)
{
  size_t need = r->m.n_point + (size_t)n, cap = r->cap_point;

  if (need >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: more points than 32-bit numbers can count",
                   r->in->path);
  if (vg_reserve(&r->m.point, &cap, need, sizeof *r->m.point) ||
      vg_reserve(&r->node, &r->cap_point, need, sizeof *r->node))
    return vg_fail_memory(err, "the points");
  return VG_OK;
}

static vg_status read_point(struct reader *r, int n_parameter,
                            struct vg_error *err)
{
  double parameter[3];
  vg_status st = read_reals(r, 3, r->m.point[r->m.n_point], "the points", err);

  if (st < 0) return st;
  r->m.n_point++;
  return read_reals(r, (size_t)n_parameter, parameter, "the points", err);
}

static void take_tag(struct reader *r, size_t at, int64_t tag)
{
  r->node[at] = (struct numbered){ tag, (uint32_t)at };
}

static vg_status read_nodes_2(struct reader *r, struct vg_error *err)
{
  int64_t n, tag;
  const char *line;
  size_t len;
  vg_status st;

  VG_TRY(vg_input_int(r->in, &n, "the number of nodes", err));
  vg_input_line(r->in, &line, &len);
  VG_TRY(check_count(r, n, 0, r->binary ? 7 : 4, "nodes", err));
  VG_TRY(reserve_points(r, n, err));
  for (int64_t i = 0; i < n; i++) {
    VG_TRY(read_ints(r, 1, &tag, "the nodes", err));
    take_tag(r, r->m.n_point, tag);
    VG_TRY(read_point(r, 0, err));
  }
done:
  return st;
}

static vg_status read_nodes_4(struct reader *r, struct vg_error *err)
{
  int64_t head[4], entity[3], n, tag;
  vg_status st;

  VG_TRY(read_sizes(r, 4, head, "the numbers of nodes", err));
  VG_TRY(check_count(r, head[0], 1, 3, "blocks of nodes", err));
  VG_TRY(check_count(r, head[1], 1, r->binary ? 6 : 3, "nodes", err));
  for (int64_t b = 0; b < head[0]; b++) {
    size_t first = r->m.n_point;

    VG_TRY(read_ints(r, 3, entity, "a block of nodes", err));
    VG_TRY(read_sizes(r, 1, &n, "a block of nodes", err));
    VG_TRY(check_count(r, n, 1, r->binary ? 6 : 3, "nodes", err));
    VG_TRY(reserve_points(r, n, err));
    if (entity[0] < 0 || entity[0] > 3)
      return fail_at(r, err,
                     "the entity of a block of nodes has a dimension other "
                     "than 0 to 3");
    for (int64_t i = 0; i < n; i++) {
      VG_TRY(read_sizes(r, 1, &tag, "the nodes", err));
      take_tag(r, first + (size_t)i, tag);
    }
    for (int64_t i = 0; i < n; i++)
      VG_TRY(read_point(r, entity[2] ? (int)entity[0] : 0, err));
  }
  if ((uint64_t)head[1] != r->m.n_point)
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: the blocks contain %zu nodes, but the section "
                 "announces %lld",
                 r->in->path, r->m.n_point, (long long)head[1]);
done:
  return st;
}

static int by_tag(const void *a, const void *b)
{
  const struct numbered *p = a, *q = b;

  if (p->tag != q->tag) return p->tag < q->tag ? -1 : 1;
  return (p->at > q->at) - (p->at < q->at);
}

static vg_status read_nodes(struct reader *r, struct vg_error *err)
{
  vg_status st;
  size_t n;
  int is_sorted = 1;

  if (r->seen_nodes++)
    return fail_at(r, err, "the section of nodes appears twice");
  st = r->version == 2 ? read_nodes_2(r, err) : read_nodes_4(r, err);
  if (st < 0) return st;
  n = r->m.n_point;
  for (size_t i = 1; i < n; i++)
    is_sorted &= r->node[i - 1].tag < r->node[i].tag;
  if (!is_sorted) qsort(r->node, n, sizeof *r->node, by_tag);
  for (size_t i = 1; i < n; i++)
    if (r->node[i - 1].tag == r->node[i].tag)
      return vg_fail(err, VG_ERR_FORMAT, "%s: node %lld is defined twice",
                     r->in->path, (long long)r->node[i].tag);
  /* cannot overflow, since tags are ascending and their number is limited */
  r->is_run = n && is_sorted &&
              (uint64_t)r->node[n - 1].tag - (uint64_t)r->node[0].tag == n - 1;
  return VG_OK;
}

static int find_node(const struct reader *r, int64_t tag, uint32_t *at)
{
  size_t lo = 0, hi = r->m.n_point;

  if (r->is_run) {
    uint64_t k = (uint64_t)tag - (uint64_t)r->node[0].tag;

    *at = (uint32_t)k;
    return tag >= r->node[0].tag && k < hi;
  }
  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (r->node[mid].tag < tag) lo = mid + 1;
    else hi = mid;
  }
  if (lo == r->m.n_point || r->node[lo].tag != tag) return 0;
  *at = r->node[lo].at;
  return 1;
}

/* --- elements --- */

static const struct type *find_type(int64_t code)
{
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (types[i].code == code) return types + i;
  return NULL;
}

static vg_status unknown_type(const struct reader *r, int64_t code,
                              struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: elements of Gmsh's type %lld are not of first order, "
                 "or not of a supported kind; `gmsh FILE -setorder 1 -save "
                 "-format msh41 -o NEW.msh` makes triangles, quadrilaterals "
                 "and cells of first order",
                 r->in->path, (long long)code);
}

static size_t count_of(const struct vg_mesh *m, enum element e)
{
  const size_t n[N_ELEMENT] = { 0,        m->n_tri, m->n_quad, m->n_tet,
                                m->n_pyr, m->n_pri, m->n_hex };

  return n[e];
}

static vg_status reserve_elements(struct reader *r, enum element e, int64_t n,
                                  struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  int bad = 0;

#define MORE(array, count)                                                     \
  bad = vg_reserve(&m->array, &r->cap[e], m->count + (size_t)n,                \
                   sizeof *m->array)
  switch (e) {
  case TRI: MORE(tri, n_tri); break;
  case QUAD: MORE(quad, n_quad); break;
  case TET: MORE(tet, n_tet); break;
  case PYR: MORE(pyr, n_pyr); break;
  case PRI: MORE(pri, n_pri); break;
  case HEX: MORE(hex, n_hex); break;
  default: break;
  }
#undef MORE
  if (!bad && e != SKIPPED)
    bad = vg_reserve(&r->of[e], &r->cap_of[e], count_of(m, e) + (size_t)n,
                     sizeof **r->of);
  return bad ? vg_fail_memory(err, "the elements") : VG_OK;
}

/* Nodes of the next element of a kind, which is counted. */
static uint32_t *next_element(struct reader *r, enum element e,
                              struct vg_gmsh_group group)
{
  struct vg_mesh *m = &r->m;

  r->of[e][count_of(m, e)] = group;
  switch (e) {
  case TRI: return m->tri[m->n_tri++];
  case QUAD: return m->quad[m->n_quad++];
  case TET: return m->tet[m->n_tet++];
  case PYR: return m->pyr[m->n_pyr++];
  case PRI: return m->pri[m->n_pri++];
  default: return m->hex[m->n_hex++];
  }
}

static vg_status take_element(struct reader *r, const struct type *t,
                              int64_t number, const int64_t *tag,
                              struct vg_gmsh_group group, struct vg_error *err)
{
  uint32_t node[NODES_MOST], *to;

  if (t->element == SKIPPED) return VG_OK;
  for (int k = 0; k < t->n_node; k++)
    if (!find_node(r, tag[k], &node[k]))
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: element %lld refers to node %lld, which does not "
                     "exist",
                     r->in->path, (long long)number, (long long)tag[k]);
  to = next_element(r, t->element, group);
  for (int k = 0; k < t->n_node; k++) to[t->slot[k]] = node[k];
  return VG_OK;
}

static vg_status read_block_4(struct reader *r, struct vg_error *err)
{
  int64_t head[3], n, v[1 + NODES_MOST];
  struct vg_gmsh_group group = { 0, 0 };
  const struct type *t;
  size_t n_value;
  vg_status st;

  VG_TRY(read_ints(r, 3, head, "a block of elements", err));
  VG_TRY(read_sizes(r, 1, &n, "a block of elements", err));
  t = find_type(head[2]);
  if (!t) return unknown_type(r, head[2], err);
  n_value = 1 + (size_t)t->n_node;
  VG_TRY(check_count(r, n, n_value, 0, "elements", err));
  VG_TRY(reserve_elements(r, t->element, n, err));
  if (head[0] == 2 || head[0] == 3)
    group = (struct vg_gmsh_group){
      head[1],
      vg_gmsh_physical(r->group[head[0] - 2], r->n_group[head[0] - 2], head[1])
    };
  for (int64_t i = 0; i < n; i++) {
    VG_TRY(read_sizes(r, n_value, v, "the elements", err));
    VG_TRY(take_element(r, t, v[0], v + 1, group, err));
  }
done:
  return st;
}

static vg_status read_elements_4(struct reader *r, struct vg_error *err)
{
  int64_t head[4];
  vg_status st;

  VG_TRY(read_sizes(r, 4, head, "the numbers of elements", err));
  VG_TRY(check_count(r, head[0], 1, 3, "blocks of elements", err));
  for (int64_t b = 0; b < head[0]; b++) VG_TRY(read_block_4(r, err));
done:
  return st;
}

/* Read the groups and nodes that follow the number of an element. In version 2,
 * the first two of n_tag are the physical group and the surface. */
static vg_status read_element_2(struct reader *r, const struct type *t,
                                int64_t n_tag, int64_t number,
                                struct vg_error *err)
{
  int64_t tag[2] = { 0, 0 }, node[NODES_MOST];
  vg_status st;

  VG_TRY(check_count(r, n_tag, 0, 1, "groups of an element", err));
  VG_TRY(read_ints(r, n_tag < 2 ? (size_t)n_tag : 2, tag,
                   "the groups of an element", err));
  if (n_tag > 2)
    VG_TRY(skip_ints(r, n_tag - 2, "the groups of an element", err));
  VG_TRY(read_ints(r, (size_t)t->n_node, node, "the elements", err));
  st = take_element(r, t, number, node,
                    (struct vg_gmsh_group){ tag[1], llabs(tag[0]) }, err);
done:
  return st;
}

/* Read elements of one type that have the same number of groups. *n out: number
 * of elements. */
static vg_status read_block_2(struct reader *r, int64_t *n,
                              struct vg_error *err)
{
  int64_t head[3], number;
  const struct type *t;
  vg_status st;

  /* binary: type, number of elements, number of groups; text: number, type,
   * number of groups */
  VG_TRY(read_ints(r, 3, head, "an element", err));
  *n = r->binary ? head[1] : 1;
  number = head[0];
  t = find_type(r->binary ? head[0] : head[1]);
  if (!t) return unknown_type(r, r->binary ? head[0] : head[1], err);
  if (*n < 1) return fail_at(r, err, "a block of elements is empty");
  VG_TRY(check_count(r, *n, 0, 1 + (size_t)t->n_node, "elements", err));
  VG_TRY(reserve_elements(r, t->element, *n, err));
  for (int64_t i = 0; i < *n; i++) {
    if (r->binary) VG_TRY(read_ints(r, 1, &number, "an element", err));
    VG_TRY(read_element_2(r, t, head[2], number, err));
  }
done:
  return st;
}

static vg_status read_elements_2(struct reader *r, struct vg_error *err)
{
  int64_t n, more;
  const char *line;
  size_t len;
  vg_status st;

  VG_TRY(vg_input_int(r->in, &n, "the number of elements", err));
  vg_input_line(r->in, &line, &len);
  VG_TRY(check_count(r, n, 0, 4, "elements", err));
  for (int64_t i = 0; i < n; i += more) VG_TRY(read_block_2(r, &more, err));
done:
  return st;
}

static vg_status read_elements(struct reader *r, struct vg_error *err)
{
  if (!r->seen_nodes) return fail_at(r, err, "the elements precede the nodes");
  return r->version == 2 ? read_elements_2(r, err) : read_elements_4(r, err);
}

/* --- sections --- */

static vg_status unknown_version(const struct reader *r, const char *text,
                                 size_t len, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: .msh of version %.*s is not supported, only 4.1 and "
                 "2.x; convert it with `gmsh FILE -save -format msh41 -o "
                 "NEW.msh`",
                 r->in->path, (int)(len < 20 ? len : 20), text);
}

/* The integer 1 after the line shows the byte order. */
static vg_status read_order(struct reader *r, struct vg_error *err)
{
  size_t start = r->in->at;
  int32_t one;

  for (int big = 0; big < 2; big++) {
    vg_status st;

    vg_input_order(r->in, big);
    r->in->at = start;
    st = vg_input_i32(r->in, 1, &one, "the byte order", err);
    if (st < 0 || one == 1) return st;
  }
  return fail_at(r, err, "the integer that shows the byte order is not 1");
}

static vg_status read_format(struct reader *r, struct vg_error *err)
{
  const char *text, *line;
  size_t len, line_len;
  int64_t binary, size;
  double version;
  vg_status st;

  if (!vg_input_token(r->in, &text, &len) ||
      !vg_parse_real(text, len, &version))
    return vg_input_fail(r->in, err, "$MeshFormat without a version");
  VG_TRY(vg_input_int(r->in, &binary, "the kind of file", err));
  VG_TRY(vg_input_int(r->in, &size, "the size of reals", err));
  if (version >= 2 && version < 3) r->version = 2;
  else if (vg_token_is(text, len, "4.1")) r->version = 4;
  else return unknown_version(r, text, len, err);
  if (binary < 0 || binary > 1 || (size != 8 && (size != 4 || r->version == 2)))
    return vg_input_fail(r->in, err,
                         "$MeshFormat must have 0 or 1 for text or binary, "
                         "and 8 for the bytes of a real or size");
  r->wide = size == 8 && r->version == 4;
  vg_input_line(r->in, &line, &line_len);
  if (!binary) return VG_OK;
  st = read_order(r, err);
  r->binary = 1;
done:
  return st;
}

static vg_status skip_section(struct reader *r, const char *name, size_t len,
                              struct vg_error *err)
{
  const char *line;
  size_t n;

  while (vg_input_line(r->in, &line, &n))
    if (n >= len + 3 && !memcmp(line, "$End", 4) &&
        !memcmp(line + 4, name + 1, len - 1))
      return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: truncated: the end of %.*s is missing", r->in->path,
                 (int)(len < 40 ? len : 40), name);
}

static vg_status read_end(struct reader *r, const char *name, size_t len,
                          struct vg_error *err)
{
  const char *text;
  size_t n;

  if (vg_input_token(r->in, &text, &n) && n == len + 3 &&
      !memcmp(text, "$End", 4) && !memcmp(text + 4, name + 1, len - 1))
    return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s: %.*s does not end where its counts say (near byte %zu)",
                 r->in->path, (int)(len < 40 ? len : 40), name, r->in->at);
}

static vg_status read_section(struct reader *r, const char *name, size_t len,
                              struct vg_error *err)
{
  static const struct {
    const char *name;
    vg_status (*read)(struct reader *r, struct vg_error *err);
  } known[] = {
    { "$PhysicalNames", read_names },
    { "$Entities", read_entities },
    { "$Nodes", read_nodes },
    { "$Elements", read_elements },
  };
  const char *line;
  size_t line_len;
  vg_status st;

  if (vg_token_is(name, len, "$PartitionedEntities"))
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%s: the mesh is partitioned; "
                   "save it in one part",
                   r->in->path);
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    if (!vg_token_is(name, len, known[i].name)) continue;
    if (!r->version) return fail_at(r, err, "a section precedes $MeshFormat");
    if (r->binary) vg_input_line(r->in, &line, &line_len);
    st = known[i].read(r, err);
    return st < 0 ? st : read_end(r, name, len, err);
  }
  return skip_section(r, name, len, err);
}

static vg_status read_sections(struct reader *r, struct vg_error *err)
{
  const char *text;
  size_t len;
  vg_status st = VG_OK;

  while (st == VG_OK && vg_input_token(r->in, &text, &len)) {
    if (*text != '$' || len < 2)
      st = fail_at(r, err,
                   r->version ? "text outside of a section"
                   : *text == '('
                     ? "this is a mesh of Fluent, which cannot be "
                       "read; Gmsh files begin with $MeshFormat"
                     : "not a Gmsh file: it does not begin with $MeshFormat");
    else if (vg_token_is(text, len, "$NOD"))
      st = unknown_version(r, "1", 1, err);
    else if (vg_token_is(text, len, "$MeshFormat"))
      st = r->version ? fail_at(r, err, "$MeshFormat appears twice")
                      : read_format(r, err);
    else if (!vg_token_is(text, len, "$EndMeshFormat"))
      st = read_section(r, text, len, err);
  }
  return st;
}

/* --- finishing --- */

static vg_status finish(struct reader *r, struct vg_error *err)
{
  struct vg_mesh *m = &r->m;
  int has_cells = m->n_tet || m->n_pyr || m->n_pri || m->n_hex;
  vg_status st;

  if (!r->version)
    return fail_at(r, err, "not a Gmsh file: there is no $MeshFormat");
  if (!m->n_tri && !m->n_quad && !has_cells)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: no triangles, quadrilaterals or cells: there is "
                   "nothing to mesh; if there are physical groups, Gmsh "
                   "saves only the elements in them",
                   r->in->path);
  VG_TRY(vg_check_points(r->in->path, m->n_point, (const double(*)[3])m->point,
                         err));
  VG_TRY(
    vg_gmsh_set_patches(m, r->of + TRI, r->n_name, r->name, r->in->path, err));
  VG_TRY(
    vg_gmsh_set_zones(m, r->of + TET, r->n_name, r->name, r->in->path, err));
  if (!has_cells) vg_mesh_keep_boundary(m);
  if (!has_cells && r->zones)
    VG_TRY(vg_gmsh_set_volumes(m, r->of + TRI, r->n_group[1], r->group[1],
                               r->n_side, r->side, r->n_name, r->name,
                               r->in->path, r->zones, err));
  VG_TRY(vg_mesh_turn(m, NULL, err));
done:
  return st;
}

vg_status vg_gmsh_parse_volumes(struct vg_input *in, struct vg_mesh *out,
                                struct vg_cad_zones *zones,
                                struct vg_error *err)
{
  struct reader r = { .in = in, .zones = zones };
  vg_status st = read_sections(&r, err);

  if (st == VG_OK) st = finish(&r, err);
  if (st == VG_OK) vg_mesh_move(out, &r.m);
  vg_mesh_release(&r.m);
  for (int e = 0; e < N_ELEMENT; e++) free(r.of[e]);
  for (int k = 0; k < 2; k++) free(r.group[k]);
  free(r.name);
  free(r.node);
  free(r.side);
  return st;
}

vg_status vg_gmsh_read_volumes(const char *path, struct vg_mesh *out,
                               struct vg_cad_zones *zones, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st == VG_OK) st = vg_gmsh_parse_volumes(&in, out, zones, err);
  vg_input_release(&in);
  return st;
}
