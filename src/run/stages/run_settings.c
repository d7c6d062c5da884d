/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Settings that affect the mesh of a run, as a digest and as lines for its run
 * directory: a refused resume lists those that differ. The rows of the settings
 * state which values affect it (vg_param.keeps_mesh). */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "base/version.h"
#include "run/stages/run.h"

static void put_values(FILE *to, const char *prefix, const struct vg_param *p,
                       size_t n, const void *base)
{
  char value[2 * VG_LIST_MAX + 4];

  for (size_t i = 0; i < n; i++) {
    if (p[i].keeps_mesh) continue;
    vg_param_format(&p[i], base, value, sizeof value);
    fprintf(to, "%s%s=%s\n", prefix, p[i].name, value);
  }
}

/* The plain settings, the farfield, and the helper that boundary recovery uses.
 * The work of vanguard-wrap is part of the boundary. */
static void put_plain(FILE *to, const struct vg_settings *s)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  const struct vg_setting_table *far = vg_settings_table(VG_TABLE_FARFIELD);
  struct vg_helper tetgen;

  put_values(to, "", p, n, s);
  put_values(to, "farfield ", far->column, far->n_column, &s->farfield);
  vg_helper_find(VG_HELPER_TETGEN, &tetgen);
  fprintf(to, "%s=%s\n", tetgen.name, tetgen.identity);
}

static void put_rows(FILE *to, const struct vg_settings *s,
                     enum vg_table_kind kind)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  size_t n = vg_settings_rows(s, kind);

  for (size_t i = 0; i < n; i++)
    put_values(to, "", t->column, t->n_column, vg_settings_row(s, kind, i));
}

/* Digest of the lines that `put_rows` writes for a table, or of the plain
 * settings if kind is VG_TABLE_FARFIELD. */
static int digest_part(const struct vg_settings *s, enum vg_table_kind kind,
                       struct vg_digest *d)
{
  char *text = NULL;
  size_t size;
  FILE *to = vg_text_open(&text, &size);

  if (!to) return -1;
  if (kind == VG_TABLE_FARFIELD) put_plain(to, s);
  else put_rows(to, s, kind);
  if (fclose(to)) return -1;
  *d = vg_digest_of(*d, size, text);
  free(text);
  return 0;
}

vg_status vg_run_settings_digest(const struct vg_settings *s,
                                 struct vg_digest *d, struct vg_error *err)
{
  struct vg_digest all = { { 0, 0 } }, plugin;
  int bad = 0;

  for (int kind = 0; kind < VG_TABLE_N; kind++)
    bad |= digest_part(s, (enum vg_table_kind)kind, &all);
  if (bad) return vg_fail_memory(err, "the settings");
  if (vg_run_mesher_digest(s, &plugin))
    all = vg_digest_of(all, sizeof plugin, &plugin);
  *d = all;
  return VG_OK;
}

static int decides(const struct vg_setting_table *t)
{
  for (size_t c = 0; c < t->n_column; c++)
    if (!t->column[c].keeps_mesh) return 1;
  return 0;
}

/* Tables may be long, so a count and a digest represent their rows. Returns 0,
 * or -1 if out of memory. */
static int put_table(FILE *to, const struct vg_settings *s,
                     enum vg_table_kind kind)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  struct vg_digest d = { { 0, 0 } };
  size_t n = vg_settings_rows(s, kind);

  if (!decides(t)) return 0;
  if (n && digest_part(s, kind, &d)) return -1;
  fprintf(to, "table %s=%zu rows", t->name, n);
  if (n) fprintf(to, " (digest %08x)", (unsigned)d.word[0]);
  fputc('\n', to);
  return 0;
}

static void put_boundary(FILE *to, const struct vg_mesh *m)
{
  struct vg_digest d = { { 0, 0 } };

  d = vg_digest_of(d, m->n_point * sizeof *m->point, m->point);
  d = vg_digest_of(d, m->n_tri * sizeof *m->tri, m->tri);
  fprintf(to, "boundary=%zu points, %zu triangles (digest %08x)\n", m->n_point,
          m->n_tri, (unsigned)d.word[0]);
}

int vg_run_mesher_digest(const struct vg_settings *s, struct vg_digest *d)
{
  uint64_t bytes;
  int fd = strchr(s->mesher, '/') ? open(s->mesher, O_RDONLY) : -1, bad;

  if (fd < 0) return 0;
  bad = vg_digest_file(fd, d, &bytes);
  close(fd);
  return !bad;
}

static void put_mesher(FILE *to, const struct vg_settings *s)
{
  struct vg_digest d = { { 0, 0 } };

  if (vg_run_mesher_digest(s, &d))
    fprintf(to, "plug-in of the mesher=digest %08x\n", (unsigned)d.word[0]);
}

char *vg_run_settings(const struct vg_settings *s,
                      const struct vg_mesh *boundary)
{
  char *text = NULL;
  size_t size;
  FILE *to = vg_text_open(&text, &size);
  int bad = 0;

  if (!to) return NULL;
  fprintf(to, "program=Vanguard " VG_VERSION ", source %.16s\n",
          vg_source_digest);
  put_plain(to, s);
  for (int kind = VG_TABLE_FARFIELD + 1; kind < VG_TABLE_N; kind++)
    bad |= put_table(to, s, (enum vg_table_kind)kind);
  put_mesher(to, s);
  put_boundary(to, boundary);
  if (!fclose(to) && !bad) return text;
  free(text);
  return NULL;
}
