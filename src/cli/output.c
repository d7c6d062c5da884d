#define _GNU_SOURCE
#include "cli/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "cli/cli.h"
#include "cli/deck.h"
#include "core/quality.h"
#include "io/foam.h"
#include "io/format.h"
#include "io/mapbc.h"
#include "io/ugrid.h"
#include "io/vgrid.h"
#include "io/vtu.h"

#define WALLS "wall.vtu"

static void remove_aside(struct vg_outputs *o)
{
  char *path;

  if (!o->aside) return;
  for (size_t i = 0; i < o->n_file; i++) {
    path = vg_outputs_aside(o, o->file[i].suffix);
    if (path && o->file[i].is_case) vg_foam_remove(path);
    else if (path) unlink(path);
    free(path);
  }
  rmdir(o->aside);
  free(o->aside);
  o->aside = NULL;
}

void vg_outputs_release(struct vg_outputs *o)
{
  remove_aside(o);
  for (size_t i = 0; i < o->n_file; i++) free(o->file[i].suffix);
  free(o->file);
  free(o->dir);
  free(o->name);
  memset(o, 0, sizeof *o);
}

static char *join(const char *dir, const char *name, const char *suffix)
{
  char *path;

  return asprintf(&path, "%s/%s.%s", dir, name, suffix) < 0 ? NULL : path;
}

char *vg_outputs_aside(struct vg_outputs *o, const char *suffix)
{
  return join(o->aside, o->name, suffix);
}

char *vg_outputs_final(const struct vg_outputs *o, const char *suffix)
{
  if (strcmp(o->dir, ".") == 0) {
    char *path;

    return asprintf(&path, "%s.%s", o->name, suffix) < 0 ? NULL : path;
  }
  return join(o->dir, o->name, suffix);
}

static int is_case(const char *item)
{
  struct vg_foam_options options;

  return vg_foam_word(item, &options);
}

/* Words of the write list that are no suffix of a mesh format. */
static int is_own_item(const char *item)
{
  return !strcmp(item, "cogsg") || !strcmp(item, "mapbc") ||
         !strcmp(item, "fun3d.mapbc") || !strcmp(item, "vtu") ||
         is_case(item);
}

static vg_status plan_item(struct vg_outputs *o, const char *item, size_t len,
                           struct vg_error *err)
{
  char *to = o->item[o->n_item];

  if (!len) return VG_OK;
  if (o->n_item == VG_OUTPUT_ITEMS || len >= sizeof o->item[0])
    return vg_fail(err, VG_ERR_INPUT, "write: too many or too long names");
  memcpy(to, item, len);
  to[len] = 0;
  for (size_t i = 0; i < o->n_item; i++)
    if (!strcmp(o->item[i], to)) return VG_OK;
  for (size_t i = 0; i < o->n_item; i++)
    if (is_case(to) && is_case(o->item[i]))
      return vg_fail(err, VG_ERR_INPUT, "write: foam and foam-ascii go into "
                     "the same folder; name one");
  if (!is_own_item(to) && !vg_format_can_write(to))
    return vg_fail(err, VG_ERR_INPUT, "write: '%s' is no format; known are "
                   "cogsg (with bc and mapbc), mapbc, fun3d.mapbc, vtu, "
                   "foam, foam-ascii and suffixes such as b8.ugrid, "
                   "lb8.ugrid, ugrid, meshb", to);
  o->n_item++;
  return VG_OK;
}

static vg_status plan_items(struct vg_outputs *o, const char *list,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  while (*list && st >= 0) {
    size_t len = strcspn(list, ", ");

    st = plan_item(o, list, len, err);
    list += len;
    list += strspn(list, ", ");
  }
  return st;
}

static int same_file(const char *a, const char *b)
{
  struct stat x, y;

  if (!*a || !*b || stat(a, &x) || stat(b, &y)) return 0;
  return x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

/* The input that writing STEM.suffix would overwrite, or NULL. */
static const char *hits_input(const struct vg_outputs *o,
                              const struct vg_input_files *f,
                              const char *suffix)
{
  const char *input[] = { f->d3m, f->front, f->surface, f->mapbc, f->deck,
                          f->tags, f->aflr };
  char *path = vg_outputs_final(o, suffix);
  const char *hit = NULL;

  for (size_t i = 0; path && i < sizeof input / sizeof *input; i++)
    if (same_file(path, input[i])) hit = input[i];
  free(path);
  return hit;
}

/* A .cogsg holds tetrahedra only. */
static vg_status refuse_mixed(const char *item, const struct vg_settings *s,
                              struct vg_error *err)
{
  if (s->cells != VG_LAYER_MIXED || strcmp(item, "cogsg") != 0) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "write: a .cogsg holds tetrahedra only, "
                 "but cells is mixed; write b8.ugrid, or set cells to tets");
}

static vg_status refuse_hit(const struct vg_outputs *o,
                            const struct vg_problem *p, const char *suffix,
                            struct vg_error *err)
{
  const char *hit = hits_input(o, &p->files, suffix);

  if (!hit) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT, "writing %s would overwrite the input "
                 "%s; use --out DIR or another --write list", suffix, hit);
}

static vg_status plan_place(const struct vg_problem *p, const char *dir,
                            struct vg_outputs *o, struct vg_error *err)
{
  const char *slash = strrchr(p->files.stem, '/');
  const char *base = slash ? slash + 1 : p->files.stem;

  if (dir) o->dir = strdup(dir);
  else if (!slash) o->dir = strdup(".");
  else o->dir = strndup(p->files.stem, slash == p->files.stem
                        ? 1 : (size_t)(slash - p->files.stem));
  o->name = strdup(base);
  if (!o->dir || !o->name) return vg_fail_memory(err, "the output paths");
  if (!*base)
    return vg_fail(err, VG_ERR_INPUT, "%s: the project has no name",
                   p->files.stem);
  return dir ? vg_cli_make_folder(dir, err) : VG_OK;
}

vg_status vg_outputs_plan(const struct vg_problem *p, const char *dir,
                          struct vg_outputs *o, struct vg_error *err)
{
  vg_status st = plan_place(p, dir, o, err);

  if (st >= 0) st = plan_items(o, p->settings.write, err);
  for (size_t i = 0; i < o->n_item && st >= 0; i++) {
    if (strcmp(o->item[i], "mapbc") != 0)
      st = refuse_hit(o, p, o->item[i], err);
    if (st >= 0 && !strcmp(o->item[i], "cogsg"))
      st = refuse_hit(o, p, "bc", err);
    if (st >= 0) st = refuse_mixed(o->item[i], &p->settings, err);
  }
  return st;
}

vg_status vg_outputs_check(const struct vg_problem *p, struct vg_outputs *o,
                           struct vg_error *err)
{
  struct vg_mapbc bc = VG_MAPBC_INIT;
  vg_status st;

  if (!hits_input(o, &p->files, "mapbc")) return VG_OK;
  st = vg_mapbc_read(p->files.mapbc, &bc, err);
  for (size_t i = 0; i < p->surface.n_patch && st >= 0; i++) {
    int found = 0;

    for (size_t j = 0; j < bc.n; j++)
      found |= bc.entry[j].id == p->surface.patch[i].id;
    if (!found)
      st = vg_fail(err, VG_ERR_INPUT, "%s is an input and is not overwritten, "
                   "but it lacks patch %d (%s) of the mesh; use --out DIR, or "
                   "add the patch to it", p->files.mapbc,
                   (int)p->surface.patch[i].id, p->surface.patch[i].name);
  }
  vg_mapbc_release(&bc);
  return st;
}

vg_status vg_outputs_begin(struct vg_outputs *o, struct vg_error *err)
{
  if (o->aside) return VG_OK;
  if (asprintf(&o->aside, "%s/.vanguard-XXXXXX", o->dir) < 0) {
    o->aside = NULL;
    return vg_fail_memory(err, "the output paths");
  }
  if (mkdtemp(o->aside)) return VG_OK;
  free(o->aside);
  o->aside = NULL;
  return vg_fail(err, VG_ERR_IO, "%s: cannot write in this folder: %s",
                 o->dir, strerror(errno));
}

vg_status vg_outputs_add(struct vg_outputs *o, const char *suffix,
                         struct vg_error *err)
{
  char *copy;

  for (size_t i = 0; i < o->n_file; i++)   /* cogsg brings the mapbc */
    if (!strcmp(o->file[i].suffix, suffix)) return VG_OK;
  copy = strdup(suffix);
  if (!copy || vg_reserve(&o->file, &o->cap_file, o->n_file + 1,
                          sizeof *o->file)) {
    free(copy);
    return vg_fail_memory(err, "the output paths");
  }
  o->file[o->n_file++] = (struct vg_outputs_file){ copy, 0, 0 };
  return VG_OK;
}

static vg_status write_vtu(const char *path, const struct vg_mesh *m,
                           struct vg_error *err)
{
  float *angle = vg_alloc(m->n_tet, sizeof *angle);
  float *ratio = vg_alloc(m->n_tet, sizeof *ratio);
  const struct vg_vtu_field field[] = {
    { "angle_min", VG_VTU_CELL, VG_VTU_FLOAT32, 1, angle },
    { "radius_ratio", VG_VTU_CELL, VG_VTU_FLOAT32, 1, ratio },
  };
  int is_mixed = m->n_pyr + m->n_pri + m->n_hex > 0;
  vg_status st;

  if (!angle || !ratio) {
    st = vg_fail_memory(err, "the quality of the cells");
  } else {
    vg_mesh_cell_quality(m, angle, ratio);
    st = vg_vtu_write(path, m, field, is_mixed ? 0 : 2, err);
  }
  free(angle);
  free(ratio);
  return st;
}

static vg_status write_format(const char *path, const char *suffix,
                              const struct vg_problem *p,
                              const struct vg_layer_stage *layers,
                              const struct vg_mesh *m, struct vg_error *err)
{
  struct vg_ugrid_kind kind;

  if (p->settings.ugrid_tail && vg_ugrid_kind(suffix, &kind))
    return vg_ugrid_write_tail(path, m, layers->join.n_layer_tet, err);
  return vg_format_write(path, m, err);
}

static vg_status write_file(struct vg_outputs *o, const struct vg_problem *p,
                            const struct vg_layer_stage *layers,
                            const struct vg_mesh *m, const char *suffix,
                            struct vg_error *err)
{
  char *path = vg_outputs_aside(o, suffix);
  vg_status st;

  if (!path) return vg_fail_memory(err, "the output paths");
  if (!strcmp(suffix, "vtu"))
    st = write_vtu(path, m, err);
  else if (!strcmp(suffix, "surface.vtu"))
    st = vg_vtu_write_boundary(path, m, NULL, 0, err);
  else if (!strcmp(suffix, "mapbc"))
    st = vg_mapbc_write(path, m, VG_MAPBC_VGRID, p->settings.title, NULL,
                        err);
  else if (!strcmp(suffix, "fun3d.mapbc"))
    st = vg_mapbc_write(path, m, VG_MAPBC_FUN3D, NULL, NULL, err);
  else if (!strcmp(suffix, WALLS))
    st = vg_layer_stage_write(layers, &p->surface, path, err);
  else
    st = write_format(path, suffix, p, layers, m, err);
  free(path);
  return st < 0 ? st : vg_outputs_add(o, suffix, err);
}

static vg_status write_case(struct vg_outputs *o, const struct vg_mesh *m,
                            const char *item, struct vg_error *err)
{
  struct vg_foam_options options;
  char *path = vg_outputs_aside(o, VG_FOAM_SUFFIX);
  vg_status st = path ? VG_OK : vg_fail_memory(err, "the output paths");

  vg_foam_word(item, &options);
  if (st >= 0) st = vg_outputs_add(o, VG_FOAM_SUFFIX, err);
  if (st >= 0) {
    for (size_t i = 0; i < o->n_file; i++)
      if (!strcmp(o->file[i].suffix, VG_FOAM_SUFFIX)) o->file[i].is_case = 1;
    st = vg_foam_write(path, m, &options, err);
  }
  free(path);
  return st;
}

static vg_status write_triple(struct vg_outputs *o,
                              const struct vg_layer_stage *layers,
                              const struct vg_mesh *m, struct vg_error *err)
{
  const char *part[] = { "cogsg", "bc", "mapbc" };
  struct vg_cogsg_info info = VG_COGSG_INFO_INIT;
  char *stem;
  vg_status st;

  if (asprintf(&stem, "%s/%s", o->aside, o->name) < 0)
    return vg_fail_memory(err, "the output paths");
  if (layers->is_on) {
    info.n_layer_point = layers->join.n_layer_point;
    info.n_layer_cell = layers->join.n_layer_tet;
  }
  st = vg_cogsg_write(stem, m, &info, 0, NULL, err);
  free(stem);
  for (int i = 0; i < 3 && st >= 0; i++) st = vg_outputs_add(o, part[i], err);
  return st;
}

/* The resolved settings say with which files they were used. */
static vg_status write_deck(struct vg_outputs *o, const struct vg_problem *p,
                            struct vg_error *err)
{
  const struct vg_input_files *f = &p->files;
  char *path = vg_outputs_aside(o, "resolved.deck"), *comment = NULL;
  vg_status st;

  if (!path ||
      asprintf(&comment, "# Settings of a run, complete: to repeat it,\n"
               "#   vanguard mesh -p %s --deck %s.resolved.deck\n"
               "# (sources of a .d3m are listed below and not read again)\n",
               *f->surface ? f->surface : f->stem, o->name) < 0) {
    free(path);
    return vg_fail_memory(err, "the settings");
  }
  st = vg_deck_write(path, &p->settings, comment, 0, err);
  free(path);
  free(comment);
  return st < 0 ? st : vg_outputs_add(o, "resolved.deck", err);
}

vg_status vg_outputs_mesh(struct vg_outputs *o, const struct vg_problem *p,
                          const struct vg_layer_stage *layers,
                          const struct vg_mesh *mesh, struct vg_error *err)
{
  vg_status st = vg_outputs_begin(o, err);

  for (size_t i = 0; i < o->n_item && st >= 0; i++) {
    const char *item = o->item[i];

    if (!strcmp(item, "cogsg")) st = write_triple(o, layers, mesh, err);
    else if (is_case(item)) st = write_case(o, mesh, item, err);
    else st = write_file(o, p, layers, mesh, item, err);
    if (st >= 0 && !strcmp(item, "vtu"))
      st = write_file(o, p, layers, mesh, "surface.vtu", err);
  }
  if (st >= 0 && layers->is_on)
    st = write_file(o, p, layers, mesh, WALLS, err);
  if (st >= 0) st = write_deck(o, p, err);
  /* What may coincide with an input by then: a .mapbc that knows all patches,
   * and the resolved deck of the run that is being repeated. */
  for (size_t i = 0; i < o->n_file && st >= 0; i++)
    o->file[i].keep_old = hits_input(o, &p->files, o->file[i].suffix) != NULL;
  return st;
}

vg_status vg_outputs_commit(struct vg_outputs *o, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < o->n_file && st >= 0; i++) {
    char *from = vg_outputs_aside(o, o->file[i].suffix);
    char *to = vg_outputs_final(o, o->file[i].suffix);

    if (!from || !to)
      st = vg_fail_memory(err, "the output paths");
    else if (o->file[i].is_case)
      st = vg_foam_place(from, to, err);
    else if (!o->file[i].keep_old && rename(from, to))
      st = vg_fail(err, VG_ERR_IO, "%s: cannot be put in place: %s", to,
                   strerror(errno));
    free(from);
    free(to);
  }
  remove_aside(o);
  return st;
}
