/* What decides the cells of a run, as lines for its run directory: a refused
 * resume shows which of them differ. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/version.h"
#include "run/stages/run.h"

/* These may change from one part of a run to the next. */
static const char *const free_to_change[] = {
  "threads", "schedule", "cad_seconds", "write", "report_html", "ugrid_tail",
  "solver_parts", "max_cells", "min_full",
  "min_any", "min_height", "max_first_error", "max_top_ratio" };

static int is_free(const char *name)
{
  for (size_t i = 0; i < sizeof free_to_change / sizeof *free_to_change; i++)
    if (!strcmp(free_to_change[i], name)) return 1;
  return 0;
}

static void put_values(FILE *to, const char *prefix, const struct vg_param *p,
                       size_t n, const void *base)
{
  char value[2 * VG_LIST_MAX + 4];

  for (size_t i = 0; i < n; i++) {
    if (is_free(p[i].name)) continue;
    vg_param_format(&p[i], base, value, sizeof value);
    fprintf(to, "%s%s=%s\n", prefix, p[i].name, value);
  }
}

/* Long tables as a count and a digest of their text. */
static void put_table(FILE *to, const struct vg_settings *s,
                      enum vg_table_kind kind)
{
  const struct vg_table *t = vg_settings_table(kind);
  struct vg_digest d = {{0, 0}};
  char value[2 * VG_LIST_MAX + 4];
  size_t n = vg_settings_rows(s, kind);

  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < t->n_column; c++) {
      vg_param_format(&t->column[c], vg_settings_row(s, kind, i), value,
                      sizeof value);
      d = vg_digest_of(d, strlen(value), value);
    }
  fprintf(to, "table %s=%zu rows", t->name, n);
  if (n) fprintf(to, " (digest %08x)", (unsigned)d.word[0]);
  fputc('\n', to);
}

static void put_boundary(FILE *to, const struct vg_mesh *m)
{
  struct vg_digest d = {{0, 0}};

  d = vg_digest_of(d, m->n_point * sizeof *m->point, m->point);
  d = vg_digest_of(d, m->n_tri * sizeof *m->tri, m->tri);
  fprintf(to, "boundary=%zu points, %zu triangles (digest %08x)\n",
          m->n_point, m->n_tri, (unsigned)d.word[0]);
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
  struct vg_digest d = {{0, 0}};

  if (vg_run_mesher_digest(s, &d))
    fprintf(to, "plug-in of the mesher=digest %08x\n", (unsigned)d.word[0]);
}

char *vg_run_settings(const struct vg_settings *s,
                      const struct vg_mesh *boundary)
{
  char *text = NULL;
  size_t size, n;
  FILE *to = open_memstream(&text, &size);
  const struct vg_param *p = vg_settings_params(&n);
  const struct vg_table *far = vg_settings_table(VG_TABLE_FARFIELD);

  if (!to) return NULL;
  fprintf(to, "program=Vanguard " VG_VERSION ", source %.16s\n",
          vg_source_digest);
  put_values(to, "", p, n, s);
  put_values(to, "farfield ", far->column, far->n_column, &s->farfield);
  put_table(to, s, VG_TABLE_LAYERS);
  put_table(to, s, VG_TABLE_SOURCES);
  put_mesher(to, s);
  put_boundary(to, boundary);
  if (fclose(to)) {
    free(text);
    return NULL;
  }
  return text;
}
