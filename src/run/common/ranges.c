/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/ranges.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/stream.h"

struct span {
  int64_t first, last, step;
  int is_factor;
};

void vg_range_release(struct vg_range_list *r)
{
  free(r->v);
  memset(r, 0, sizeof *r);
}

int vg_parse_count(const char *text, size_t len, int64_t *out)
{
  double v;

  if (vg_parse_int(text, len, out)) return 1;
  if (!vg_parse_real(text, len, &v) || fabs(v) > 9e15) return 0;
  *out = (int64_t)v;
  return (double)*out == v;
}

/* "a", "a:b", "a:b:step" or "a:b:xfactor". */
static int parse_one(const char *text, size_t len, struct span *s)
{
  const char *end = text + len, *colon = memchr(text, ':', len), *second;

  memset(s, 0, sizeof *s);
  s->step = 1;
  if (!colon) {
    if (!vg_parse_count(text, len, &s->first)) return 0;
    s->last = s->first;
    return 1;
  }
  second = memchr(colon + 1, ':', (size_t)(end - colon) - 1);
  if (!vg_parse_count(text, (size_t)(colon - text), &s->first) ||
      !vg_parse_count(colon + 1, (size_t)((second ? second : end) - colon) - 1,
                      &s->last))
    return 0;
  if (!second++) return 1;
  s->is_factor = second < end && *second == 'x';
  second += s->is_factor;
  return vg_parse_count(second, (size_t)(end - second), &s->step) &&
         s->step > s->is_factor;
}

static vg_status add(const char *what, struct vg_range_list *r, int64_t v,
                     struct vg_error *err)
{
  for (size_t i = 0; i < r->n; i++)
    if (r->v[i] == v) return VG_OK;
  if (r->n == VG_RANGE_MAX)
    return vg_fail(err, VG_ERR_INPUT, "%s names more than %d numbers", what,
                   VG_RANGE_MAX);
  if (vg_reserve(&r->v, &r->cap, r->n + 1, sizeof *r->v))
    return vg_fail_memory(err, "a list of numbers");
  r->v[r->n++] = v;
  return VG_OK;
}

static vg_status add_all(const char *what, const struct span *s, int64_t lo,
                         int64_t hi, struct vg_range_list *r,
                         struct vg_error *err)
{
  vg_status st = VG_OK;

  if (s->first < lo || s->last > hi || s->last < s->first)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s takes numbers from %lld to %lld, "
                   "the lower one first; not %lld to %lld",
                   what, (long long)lo, (long long)hi, (long long)s->first,
                   (long long)s->last);
  if (s->is_factor && s->first < 1)
    return vg_fail(
      err, VG_ERR_INPUT,
      "%s: multiplying %lld by a factor never reaches the end of the range; "
      "start at 1 or more",
      what, (long long)s->first);
  for (int64_t v = s->first; st >= 0;) {
    st = add(what, r, v, err);
    if (s->is_factor ? v > s->last / s->step : v > s->last - s->step) break;
    v = s->is_factor ? v * s->step : v + s->step;
  }
  return st;
}

vg_status vg_range_parse(const char *what, const char *text, int64_t lo,
                         int64_t hi, struct vg_range_list *out,
                         struct vg_error *err)
{
  struct vg_range_list r = VG_RANGE_INIT;
  vg_status st;

  assert(what && text && lo <= hi && out);
  for (;;) {
    size_t len = strcspn(text, ",");
    struct span s;

    if (!parse_one(text, len, &s)) {
      st = vg_fail(err, VG_ERR_INPUT,
                   "%s takes numbers such as 1,2,4 or ranges such as 3:7, "
                   "0:100:20 or 1:64:x2, not '%.*s'",
                   what, (int)len, text);
      goto done;
    }
    VG_TRY(add_all(what, &s, lo, hi, &r, err));
    if (!text[len]) break;
    text += len + 1;
  }
  vg_range_release(out);
  *out = r;
  memset(&r, 0, sizeof r);
done:
  vg_range_release(&r);
  return st;
}
