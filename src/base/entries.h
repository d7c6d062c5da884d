/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/entries.h: tables of the fields of a report. The functions that add
 * reports, sum them over ranks, store them and write them as JSON all use the
 * table, so that a new field needs one new row. Uses base only. */
#ifndef VG_BASE_ENTRIES_H
#define VG_BASE_ENTRIES_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

enum vg_entry_type {
  VG_ENTRY_COUNT,  /* uint64_t or size_t, which have the same size here */
  VG_ENTRY_FLAG,   /* int, treated as a flag when printed; sums count how often
                      it was set */
  VG_ENTRY_REAL,   /* double */
  VG_ENTRY_SECONDS /* double, a time; times are not stored */
};

/* How the reports of two tasks, or of two ranks, are combined. */
enum vg_entry_rule { VG_ENTRY_SUM, VG_ENTRY_MOST, VG_ENTRY_LEAST };

struct vg_entry {
  const char *name; /* key in the JSON report; NULL: not written to it */
  size_t offset;    /* offset of the field in its struct */
  enum vg_entry_type type;
  enum vg_entry_rule rule;
};

struct vg_entries {
  size_t n;
  const struct vg_entry *entry; /* [n] in the order of the JSON report */
};

/* A row of the table. `member` belongs to struct `type`; it may be nested in
 * another struct or an array. */
#define VG_ENTRY(name, type, member, kind, rule)                               \
  {                                                                            \
    name, offsetof(type, member), VG_ENTRY_##kind, VG_ENTRY_##rule             \
  }

_Static_assert(sizeof(size_t) == sizeof(uint64_t), "fields are 64 bits wide");

uint64_t vg_entry_count(const struct vg_entry *f, const void *report);
double vg_entry_real(const struct vg_entry *f, const void *report);

/** Combine the report `from` into *to. */
void vg_entries_add(const struct vg_entries *l, void *to, const void *from);

/** Combine the reports of all ranks, on every rank. Collective. */
vg_status vg_entries_agree(const struct vg_entries *l, void *report,
                           struct vg_comm *comm, struct vg_error *err);

/** Append the report without its times to a record, or read it back with times
 * of 0. Damaged data set r->bad. */
struct vg_writer;
struct vg_reader;
void vg_entries_put(const struct vg_entries *l, struct vg_writer *w,
                    const void *report);
void vg_entries_get(const struct vg_entries *l, struct vg_reader *r,
                    void *report);

#endif
