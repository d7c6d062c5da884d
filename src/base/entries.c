/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "base/entries.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"

/* Times are summed over ranks as whole microseconds. */
static const double per_second = 1e6;

static int is_real(const struct vg_entry *f)
{
  return f->type == VG_ENTRY_REAL || f->type == VG_ENTRY_SECONDS;
}

uint64_t vg_entry_count(const struct vg_entry *f, const void *report)
{
  const char *at = (const char *)report + f->offset;
  uint64_t n;
  int flag;

  assert(!is_real(f));
  if (f->type == VG_ENTRY_FLAG) {
    memcpy(&flag, at, sizeof flag);
    return (uint64_t)flag;
  }
  memcpy(&n, at, sizeof n);
  return n;
}

static void set_count(const struct vg_entry *f, void *report, uint64_t n)
{
  char *at = (char *)report + f->offset;
  int flag = (int)n;

  if (f->type == VG_ENTRY_FLAG) memcpy(at, &flag, sizeof flag);
  else memcpy(at, &n, sizeof n);
}

double vg_entry_real(const struct vg_entry *f, const void *report)
{
  double x;

  assert(is_real(f));
  memcpy(&x, (const char *)report + f->offset, sizeof x);
  return x;
}

static void set_real(const struct vg_entry *f, void *report, double x)
{
  memcpy((char *)report + f->offset, &x, sizeof x);
}

static double real_of_two(enum vg_entry_rule rule, double a, double b)
{
  if (rule == VG_ENTRY_SUM) return a + b;
  return (rule == VG_ENTRY_MOST) == (b > a) ? b : a;
}

void vg_entries_add(const struct vg_entries *l, void *to, const void *from)
{
  for (size_t k = 0; k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];

    if (is_real(f))
      set_real(f, to,
               real_of_two(f->rule, vg_entry_real(f, to),
                           vg_entry_real(f, from)));
    else set_count(f, to, vg_entry_count(f, to) + vg_entry_count(f, from));
  }
}

/* Counts and times are summed. Other real numbers are combined by their
 * maximum; for a minimum their sign is changed before and after. */
vg_status vg_entries_agree(const struct vg_entries *l, void *report,
                           struct vg_comm *comm, struct vg_error *err)
{
  uint64_t *sum = vg_calloc(l->n, sizeof *sum);
  double *most = vg_calloc(l->n, sizeof *most);
  vg_status st = sum && most ? VG_OK : vg_fail_memory(err, "a report");

  for (size_t k = 0; st == VG_OK && k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];

    if (!is_real(f)) sum[k] = vg_entry_count(f, report);
    else if (f->rule == VG_ENTRY_SUM)
      sum[k] = (uint64_t)(vg_entry_real(f, report) * per_second);
    else
      most[k] = (f->rule == VG_ENTRY_LEAST ? -1 : 1) * vg_entry_real(f, report);
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_sum(comm, l->n, sum, err));
  VG_TRY(vg_comm_max(comm, l->n, most, err));
  for (size_t k = 0; k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];

    if (!is_real(f)) set_count(f, report, sum[k]);
    else if (f->rule == VG_ENTRY_SUM)
      set_real(f, report, (double)sum[k] / per_second);
    else set_real(f, report, f->rule == VG_ENTRY_LEAST ? -most[k] : most[k]);
  }
done:
  free(sum);
  free(most);
  return st;
}

void vg_entries_put(const struct vg_entries *l, struct vg_writer *w,
                    const void *report)
{
  for (size_t k = 0; k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];
    double x = is_real(f) ? vg_entry_real(f, report) : 0;
    uint64_t n = is_real(f) ? 0 : vg_entry_count(f, report);

    if (f->type == VG_ENTRY_REAL) vg_put(w, 1, sizeof x, &x);
    else if (f->type != VG_ENTRY_SECONDS) vg_put(w, 1, sizeof n, &n);
  }
}

void vg_entries_get(const struct vg_entries *l, struct vg_reader *r,
                    void *report)
{
  for (size_t k = 0; k < l->n; k++) {
    const struct vg_entry *f = &l->entry[k];
    double x = 0;
    uint64_t n = 0;

    if (f->type == VG_ENTRY_REAL) vg_get(r, 1, sizeof x, &x);
    else if (f->type != VG_ENTRY_SECONDS) vg_get(r, 1, sizeof n, &n);
    if (is_real(f)) set_real(f, report, x);
    else set_count(f, report, n);
  }
}
