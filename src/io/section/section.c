/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/section/section.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "io/section/section_parts.h"

/* A gap between the first and the last point, relative to the extent of the
 * curve, up to which it is a blunt trailing edge. */
#define GAP 0.1 /* S97 */
/* Distance of the leading points of both sides in Lednicer's order, relative to
 * the extent. */
#define NOSE 0.05 /* S97 */
/* Distance of successive points up to which they are the same one, relative to
 * the extent, and to the distances of their other neighbours. */
#define SAME 1e-6 /* S97 */
#define NEXT 1e-4 /* S97 */
#define SEPARATOR 999

enum { POINTS_MIN = 3, SHOWN = 40 };

/* Points between two separators. */
struct block {
  size_t first, n;
};

struct reader {
  struct vg_input *in;
  struct vg_section all; /* All points of the file, in its order. */
  struct vg_section *out;
  size_t n_block, cap_block;
  struct block *block; /* Blocks of the current element. */
  char title[VG_NAME_MAX];
};

void vg_section_release(struct vg_section *s)
{
  free(s->element);
  free(s->x);
  free(s->line);
  memset(s, 0, sizeof *s);
}

size_t vg_section_suffix_length(const char *path)
{
  const size_t all = strlen(path);
  const size_t n = all > 3 && !strcasecmp(path + all - 3, ".gz") ? all - 3
                                                                 : all;

  return n > 4 && !strncasecmp(path + n - 4, VG_SECTION_SUFFIX, 4) ? all - n + 4
                                                                   : 0;
}

int vg_section_is(const char *path)
{
  return vg_section_suffix_length(path) > 0;
}

static vg_status add_point(struct vg_section *s, const double x[2], size_t line,
                           struct vg_error *err)
{
  if (vg_reserve(&s->x, &s->cap_point, s->n_point + 1, sizeof *s->x) ||
      vg_reserve(&s->line, &s->cap_line, s->n_point + 1, sizeof *s->line))
    return vg_fail_memory(err, "the points of a section");
  memcpy(s->x[s->n_point], x, sizeof *s->x);
  s->line[s->n_point++] = line;
  return VG_OK;
}

/* --- from blocks to elements --------------------------------------------- */

static double extent(const struct vg_section *s, size_t first, size_t n)
{
  double lo[2], hi[2];

  for (int k = 0; k < 2; k++) lo[k] = hi[k] = s->x[first][k];
  for (size_t i = first; i < first + n; i++)
    for (int k = 0; k < 2; k++) {
      lo[k] = fmin(lo[k], s->x[i][k]);
      hi[k] = fmax(hi[k], s->x[i][k]);
    }
  return fmax(hi[0] - lo[0], hi[1] - lo[1]);
}

static double distance(const struct vg_section *s, size_t a, size_t b)
{
  const double dx = s->x[b][0] - s->x[a][0], dy = s->x[b][1] - s->x[a][1];

  return sqrt(dx * dx + dy * dy);
}

static int same(const struct vg_section *s, size_t a, size_t b)
{
  return s->x[a][0] == s->x[b][0] && s->x[a][1] == s->x[b][1];
}

/* Twice the area; positive if the points run counter-clockwise. */
static double area(const struct vg_section *s, size_t first, size_t n)
{
  const double *o = s->x[first];
  double sum = 0;

  for (size_t i = first + 1; i + 1 < first + n; i++)
    sum += (s->x[i][0] - o[0]) * (s->x[i + 1][1] - o[1]) -
           (s->x[i + 1][0] - o[0]) * (s->x[i][1] - o[1]);
  return sum;
}

static void reverse(struct vg_section *s, size_t first, size_t n)
{
  for (size_t i = 0; i < n / 2; i++) {
    const size_t a = first + i, b = first + n - 1 - i, line = s->line[a];
    double x[2];

    memcpy(x, s->x[a], sizeof x);
    memcpy(s->x[a], s->x[b], sizeof x);
    memcpy(s->x[b], x, sizeof x);
    s->line[a] = s->line[b];
    s->line[b] = line;
  }
}

/* Points that are nearly the same would have a segment that is no side and far
 * shorter than all edges. */
static vg_status check_distances(const struct reader *r, size_t first, size_t n,
                                 struct vg_error *err)
{
  const struct vg_section *s = r->out;
  const double least = SAME * extent(s, first, n);

  for (size_t i = 0; i < n; i++) {
    const size_t a = first + i, b = first + (i + 1) % n;
    const double d = distance(s, a, b);
    const double before = distance(s, first + (i + n - 1) % n, a);
    const double after = distance(s, b, first + (i + 2) % n);

    if (!(d > 0))
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "%s:%zu: the point (%.10g, %.10g) repeats that of line "
                     "%zu; remove one of them",
                     r->in->path, s->line[b], s->x[a][0], s->x[a][1],
                     s->line[a]);
    if (d > fmax(least, NEXT * fmin(before, after))) continue;
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s:%zu: the point (%.10g, %.10g) is only %.3g away from "
                   "that of line %zu, (%.10g, %.10g), and the next points are "
                   "%.3g and %.3g away; %s",
                   r->in->path, s->line[b], s->x[b][0], s->x[b][1], d,
                   s->line[a], s->x[a][0], s->x[a][1], before, after,
                   i + 1 < n ? "remove one of them"
                             : "make both the same for a sharp trailing edge");
  }
  return VG_OK;
}

/* The points from `first` on become an element. */
static vg_status close_element(struct reader *r, size_t first,
                               struct vg_error *err)
{
  struct vg_section *s = r->out;
  const char *path = r->in->path;
  struct vg_section_element e = { .first = first };
  vg_status st;

  const int is_joined = s->n_point - first > 1 &&
                        same(s, first, s->n_point - 1);

  if (is_joined) s->n_point--;
  e.n = s->n_point - first;
  if (e.n < POINTS_MIN)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s:%zu: a section needs at least %d different points, but "
                   "this one has %zu",
                   path, s->line[first], POINTS_MIN, e.n);
  VG_TRY(check_distances(r, first, e.n, err));
  if (!(fabs(area(s, first, e.n)) > 0))
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "%s:%zu: all points of this section lie on a line, so that "
                   "it encloses no area",
                   path, s->line[first]);
  /* The trailing edge remains the first point. */
  if (area(s, first, e.n) < 0)
    reverse(s, first + (size_t)is_joined, e.n - (size_t)is_joined);
  memcpy(e.name, r->title, sizeof e.name);
  if (vg_reserve(&s->element, &s->cap, s->n + 1, sizeof *s->element))
    return vg_fail_memory(err, "the elements of a section");
  s->element[s->n++] = e;
done:
  return st;
}

/* Number of points that a coordinate of a line of counts states; 0: none. */
static size_t count_of(double x)
{
  return x >= 2 && x < 1e9 && x == (double)(size_t)x ? (size_t)x : 0;
}

static vg_status take_selig(struct reader *r, struct block b,
                            struct vg_error *err)
{
  const size_t first = r->out->n_point;
  vg_status st = VG_OK;

  for (size_t i = b.first; i < b.first + b.n && st >= 0; i++)
    st = add_point(r->out, r->all.x[i], r->all.line[i], err);
  return st < 0 ? st : close_element(r, first, err);
}

/* The upper side backwards, then the lower side. Both have the leading point.
 */
static vg_status take_lednicer(struct reader *r, size_t upper, size_t n_upper,
                               size_t n_lower, struct vg_error *err)
{
  const struct vg_section *a = &r->all;
  const size_t first = r->out->n_point, lower = upper + n_upper;
  vg_status st = VG_OK;

  for (size_t i = lower; i-- > upper && st >= 0;)
    st = add_point(r->out, a->x[i], a->line[i], err);
  for (size_t i = lower; i < lower + n_lower && st >= 0; i++)
    if (i > lower || !same(a, upper, lower))
      st = add_point(r->out, a->x[i], a->line[i], err);
  return st < 0 ? st : close_element(r, first, err);
}

static int is_closed(const struct vg_section *s, struct block b)
{
  return distance(s, b.first, b.first + b.n - 1) <=
         GAP * extent(s, b.first, b.n);
}

static vg_status refuse_open(const struct reader *r, size_t k,
                             struct vg_error *err)
{
  const struct vg_section *s = &r->all;
  const struct block a = r->block[k];
  const double *p = s->x[a.first], *q = s->x[a.first + a.n - 1];
  const double size = extent(s, a.first, a.n);

  if (k + 1 < r->n_block && !is_closed(s, r->block[k + 1])) {
    const struct block b = r->block[k + 1];

    if (distance(s, a.first, b.first) <= NOSE * size)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s:%zu: the order of the points is not clear: this block "
                     "and the one from line %zu begin at the same point "
                     "(%.6g, %.6g) and end elsewhere. They are the two sides "
                     "of an element in Lednicer's order without its line of "
                     "counts, or two open sections. For the first reading, "
                     "insert the line '%zu. %zu.' before them; for Selig's "
                     "order, join them into one block from the trailing edge "
                     "around the leading edge",
                     r->in->path, s->line[a.first], s->line[b.first], p[0],
                     p[1], a.n, b.n);
    if (distance(s, a.first + a.n - 1, b.first) <= NOSE * size)
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "%s:%zu: this block is open, and the one from line %zu "
                     "begins where it ends, at (%.6g, %.6g); remove the "
                     "separator between them if they are one section in "
                     "Selig's order",
                     r->in->path, s->line[a.first], s->line[b.first], q[0],
                     q[1]);
  }
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "%s:%zu: the section is open: its first point (%.6g, %.6g) "
                 "and its last point (%.6g, %.6g), line %zu, are %.3g apart, "
                 "more than %g of its extent %.4g; add the missing points. A "
                 "section in Selig's order begins and ends at the trailing "
                 "edge",
                 r->in->path, s->line[a.first], p[0], p[1], q[0], q[1],
                 s->line[a.first + a.n - 1],
                 distance(s, a.first, a.first + a.n - 1), GAP, size);
}

/* Blocks in Selig's order: one element each. */
static vg_status take_blocks(struct reader *r, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t k = 0; k < r->n_block && st >= 0; k++)
    st = is_closed(&r->all, r->block[k]) || r->block[k].n < POINTS_MIN
         ? take_selig(r, r->block[k], err)
         : refuse_open(r, k, err);
  return st;
}

/* The end of an element with its title, or of the file. */
static vg_status end_element(struct reader *r, struct vg_error *err)
{
  const struct vg_section *s = &r->all;
  const size_t first = r->n_block ? r->block[0].first : 0;
  size_t n = 0, count[2];
  vg_status st;

  if (!r->n_block) return VG_OK;
  for (size_t k = 0; k < r->n_block; k++) n += r->block[k].n;
  for (int k = 0; k < 2; k++) count[k] = count_of(s->x[first][k]);
  if (!count[0] || !count[1]) st = take_blocks(r, err);
  else if (count[0] + count[1] + 1 != n)
    st = r->block[0].n > 1
         ? take_blocks(r, err)
         : vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: the line '%g %g' states the points of the upper "
                   "and the lower side, as in Lednicer's order, but %zu "
                   "points follow; correct the counts, or remove the line for "
                   "Selig's order",
                   r->in->path, s->line[first], s->x[first][0], s->x[first][1],
                   n - 1);
  else if (distance(s, first + 1, first + 1 + count[0]) >
           NOSE * extent(s, first + 1, n - 1))
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s:%zu: the order of the points is not clear: the line '%g "
                 "%g' states the numbers of points that follow, as in "
                 "Lednicer's order, but the sides do not begin at a common "
                 "leading point: (%.6g, %.6g), and (%.6g, %.6g) in line %zu. "
                 "In Selig's order, the line would be a point of the section. "
                 "Reverse the side that ends at the leading edge, or remove "
                 "the line",
                 r->in->path, s->line[first], s->x[first][0], s->x[first][1],
                 s->x[first + 1][0], s->x[first + 1][1],
                 s->x[first + 1 + count[0]][0], s->x[first + 1 + count[0]][1],
                 s->line[first + 1 + count[0]]);
  else st = take_lednicer(r, first + 1, count[0], count[1], err);
  r->n_block = 0;
  return st;
}

/* --- lines --------------------------------------------------------------- */

static int is_like_number(const char *text, size_t len)
{
  const size_t sign = len && (*text == '-' || *text == '+');
  const char *word = text + sign;
  const size_t n = len - sign;

  return (n && (isdigit((unsigned char)*word) || *word == '.')) ||
         (n == 3 &&
          (!strncasecmp(word, "nan", 3) || !strncasecmp(word, "inf", 3)));
}

static void set_title(struct reader *r, const char *text, size_t len)
{
  size_t n = 0;

  while (len && isspace((unsigned char)text[len - 1])) len--;
  while (len && isspace((unsigned char)*text)) text++, len--;
  for (; n < len && n + 1 < sizeof r->title; n++)
    r->title[n] = iscntrl((unsigned char)text[n]) ? '_' : text[n];
  r->title[n] = 0;
}

/* A new block begins after a separator. */
static vg_status put_point(struct reader *r, const double x[2], int *is_new,
                           struct vg_error *err)
{
  if (*is_new) {
    if (vg_reserve(&r->block, &r->cap_block, r->n_block + 1, sizeof *r->block))
      return vg_fail_memory(err, "the blocks of a section");
    r->block[r->n_block++] = (struct block){ r->all.n_point, 0 };
    *is_new = 0;
  }
  r->block[r->n_block - 1].n++;
  return add_point(&r->all, x, r->in->line, err);
}

static int is_all_digits(const char *text, size_t len)
{
  while (len && isdigit((unsigned char)text[len - 1])) len--;
  return !len;
}

/* Is the first line of a file a title that could be taken for numbers? "0012
 * 64" is a designation, as no coordinate is an integer that begins with zero;
 * one word is no point. */
static int is_first_title(const struct reader *r, const char *text, size_t len,
                          int n)
{
  if (r->all.n_point || *r->title) return 0;
  return (n == 1 && !strncasecmp(text, "nan", 3)) ||
         (n == 1 && !strncasecmp(text, "inf", 3)) ||
         (len > 1 && *text == '0' && is_all_digits(text, len));
}

/* A line that is a title, as are those that do not begin with a number. Between
 * blocks, a title may begin with one. */
static vg_status take_title(struct reader *r, struct vg_error *err)
{
  struct vg_input row = *r->in;
  const char *text = "";
  size_t len = 0;
  vg_status st = end_element(r, err);

  vg_input_line(&row, &text, &len);
  set_title(r, text, len);
  return st;
}

/* The current line: nothing, a comment, a point, a separator or a title. */
static vg_status take_line(struct reader *r, int *is_new, struct vg_error *err)
{
  struct vg_input row = *r->in;
  const char *text[3] = { "", "", "" };
  size_t len[3] = { 0, 0, 0 };
  int n = 0, is_number[2] = { 0, 0 };
  double x[2] = { 0, 0 };

  while (n < 3 && vg_input_token_in_line(&row, &text[n], &len[n])) n++;
  if (!n) *is_new = 1;
  if (!n || *text[0] == '#') return VG_OK;
  if (n > 2 && *text[2] == '#') n = 2;
  for (int k = 0; k < 2; k++)
    is_number[k] = k < n && vg_parse_real(text[k], len[k], &x[k]);
  if (is_first_title(r, text[0], len[0], n)) return take_title(r, err);
  if (n == 2 && is_number[0] && is_number[1]) {
    *is_new |= x[0] == SEPARATOR && x[1] == SEPARATOR;
    return x[0] == SEPARATOR && x[1] == SEPARATOR
           ? VG_OK
           : put_point(r, x, is_new, err);
  }
  if (n > 2 && is_number[0] && is_number[1])
    return vg_input_fail(r->in, err,
                         "a point of a plane section has two coordinates x y, "
                         "but a third word '%.*s' follows; remove it, or give "
                         "a surface in space in another format",
                         (int)(len[2] < SHOWN ? len[2] : SHOWN), text[2]);
  if (is_like_number(text[0], len[0]) && !(*is_new && is_number[0]))
    return vg_input_fail(r->in, err,
                         "expected a point with two finite coordinates x y, "
                         "not '%.*s%s%.*s'",
                         (int)(len[0] < SHOWN ? len[0] : SHOWN), text[0],
                         n > 1 ? " " : "",
                         (int)(len[1] < SHOWN ? len[1] : SHOWN), text[1]);
  *is_new = 1;
  return take_title(r, err);
}

static vg_status read_lines(struct reader *r, struct vg_error *err)
{
  const char *text;
  size_t len;
  int is_new = 1;
  vg_status st = VG_OK;

  do {
    if (r->in->at < r->in->size) st = take_line(r, &is_new, err);
  } while (st >= 0 && vg_input_line(r->in, &text, &len));
  return st < 0 ? st : end_element(r, err);
}

vg_status vg_section_parse(struct vg_input *in, struct vg_section *out,
                           struct vg_error *err)
{
  struct vg_section s = VG_SECTION_INIT;
  struct reader r = { .in = in, .all = VG_SECTION_INIT, .out = &s };
  vg_status st;

  if (!vg_input_is_text(in))
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: this is no text, as the coordinates of a section are",
                   in->path);
  VG_TRY(read_lines(&r, err));
  if (!s.n) {
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: there are no lines with two coordinates x y", in->path);
    goto done;
  }
  VG_TRY(vg_section_check(&s, in->path, err));
  *out = s;
  s = (struct vg_section)VG_SECTION_INIT;
done:
  vg_section_release(&s);
  vg_section_release(&r.all);
  free(r.block);
  return st;
}

vg_status vg_section_read(const char *path, struct vg_section *out,
                          struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  if (st < 0) return st;
  st = vg_section_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}
