/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/stages/output.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/helper/helper.h"
#include "base/memory.h"
#include "io/cgns/cgns.h"
#include "io/mesh/fluent.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/mesh/ugrid.h"
#include "io/slices/slices.h"
#include "io/stream/sheet_file.h"
#include "io/vgrid/mapbc.h"
#include "partition/store/store.h"
#include "run/common/folder.h"
#include "run/common/progress.h"
#include "run/common/text.h"
#include "run/settings/deck.h"
#include "run/settings/lists.h"
#include "run/settings/plan_options.h"

#define WALLS "wall.vtu"

static void close_commit(struct vg_outputs *o)
{
  if (!o->commit.hidden) return;
  vg_commit_close(&o->commit);
  vg_display_temporary(NULL);
}

void vg_outputs_release(struct vg_outputs *o)
{
  close_commit(o);
  free(o->temp_dir);
  if (o->made_dir) rmdir(o->dir); /* Fails if a file was written. */
  for (size_t i = 0; i < o->n_file; i++) free(o->file[i].suffix);
  free(o->file);
  free(o->dir);
  free(o->name);
  memset(o, 0, sizeof *o);
}

static char *join(const char *dir, const char *name, const char *suffix)
{
  char *path;

  return asprintf(&path, "%s/%s%s%s", dir, name, *suffix == '_' ? "" : ".",
                  suffix) < 0
         ? NULL
         : path;
}

char *vg_outputs_temp_path(struct vg_outputs *o, const char *suffix)
{
  assert(o->temp_dir && o->name && suffix);
  return join(o->temp_dir, o->name, suffix);
}

char *vg_outputs_final(const struct vg_outputs *o, const char *suffix)
{
  char *path;

  assert(o->dir && o->name && suffix);
  if (strcmp(o->dir, ".") == 0) {
    if (asprintf(&path, "%s%s%s", o->name, *suffix == '_' ? "" : ".", suffix) <
        0)
      path = NULL;
  } else {
    path = join(o->dir, o->name, suffix);
  }
  if (!path) vg_print_lose();
  return path;
}

vg_status vg_outputs_failed(const struct vg_outputs *o, vg_status st,
                            struct vg_error *err)
{
  const size_t n = o->temp_dir ? strlen(o->temp_dir) : 0;
  char *at = st < 0 && err && n ? strstr(err->text, o->temp_dir) : NULL;
  char *rest;

  if (!at || at[n] != '/' || !(rest = strdup(at + n + 1))) return st;
  snprintf(at, (size_t)(err->text + sizeof err->text - at), "%s%s%s",
           strcmp(o->dir, ".") ? o->dir : "", strcmp(o->dir, ".") ? "/" : "",
           rest);
  free(rest);
  return st;
}

static int is_case(const char *item)
{
  struct vg_foam_options options;

  return vg_foam_word(item, &options);
}

int vg_is_same_file(const char *a, const char *b)
{
  struct stat x, y;

  if (!a || !b || !*a || !*b || stat(a, &x) || stat(b, &y)) return 0;
  return x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

/* The input that writing STEM.suffix would overwrite, or NULL. */
static const char *hits_input(const struct vg_outputs *o,
                              const struct vg_problem *p, const char *suffix)
{
  const struct vg_input_files *f = &p->read.files;
  const char *sizes = p->asked.sizes;
  const char *input[] = { f->d3m,  f->front, f->surface, f->mapbc,
                          f->deck, f->tags,  f->aflr,    sizes };
  char *path = vg_outputs_final(o, suffix);
  const char *hit = NULL;

  for (size_t i = 0; path && i < sizeof input / sizeof *input; i++)
    if (vg_is_same_file(path, input[i])) hit = input[i];
  free(path);
  return hit;
}

/* A .cogsg can hold only tetrahedra. */
static vg_status refuse_mixed(const char *item, const struct vg_problem *p,
                              struct vg_error *err)
{
  const struct vg_settings *s = &p->asked;

  if (strcmp(item, "cogsg") != 0) return VG_OK;
  if (p->read.is_section)
    return vg_fail(
      err, VG_ERR_INPUT,
      "write: a .cogsg can hold only tetrahedra, and the mesh of a "
      "section has none; write b8.ugrid, su2, foam or cgns");
  if (s->cells == VG_LAYER_TETS) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "write: a .cogsg can hold only tetrahedra, but cells is %s; "
                 "write b8.ugrid, or set cells to tets",
                 s->cells == VG_LAYER_HEX ? "hex" : "mixed");
}

static vg_status refuse_hit(const struct vg_outputs *o,
                            const struct vg_problem *p, const char *suffix,
                            struct vg_error *err)
{
  const char *hit = hits_input(o, p, suffix);

  if (!hit) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "writing %s would overwrite the input "
                 "%s; use --out DIR or another --write list",
                 suffix, hit);
}

/* Refuses a surface with the stem of the input in its folder. A later run that
 * is given the stem could not tell it from the surface of the project. */
static vg_status refuse_second(const struct vg_outputs *o,
                               const struct vg_problem *p, const char *suffix,
                               struct vg_error *err)
{
  const struct vg_input_files *f = &p->read.files;
  const char *input = *f->surface ? f->surface : f->d3m;
  const char *slash = strrchr(f->stem, '/');
  const char *name = slash ? slash + 1 : f->stem;
  char *path = vg_outputs_final(o, suffix), *folder;
  vg_status st = VG_OK;

  folder = !slash
           ? strdup(".")
           : strndup(f->stem, slash == f->stem ? 1 : (size_t)(slash - f->stem));
  if (!path || !folder) st = vg_fail_memory(err, "the output paths");
  else if (*input && !*f->front && vg_format_is_tessellation(path) &&
           !strcmp(name, o->name) && vg_is_same_file(folder, o->dir))
    st = vg_fail(err, VG_ERR_INPUT,
                 "writing %s next to the input %s would make the surface of "
                 "the project %s ambiguous; use --out DIR or another --write "
                 "list",
                 path, input, f->stem);
  free(path);
  free(folder);
  return st;
}

/* Refuses a path at which a folder exists. If this were detected only by
 * renaming, some files of this mesh would be mixed with files of another
 * one. */
static vg_status refuse_folder(const struct vg_outputs *o, const char *suffix,
                               struct vg_error *err)
{
  char *path = vg_outputs_final(o, suffix);
  vg_status st = VG_OK;
  struct stat is;

  if (!path) st = vg_fail_memory(err, "the output paths");
  else if (!lstat(path, &is) && S_ISDIR(is.st_mode))
    st = vg_fail(err, VG_ERR_IO,
                 "%s: a folder exists where a file must be written; move it, "
                 "or choose another --out DIR",
                 path);
  free(path);
  return st;
}

vg_status vg_outputs_place(const char *stem, const char *dir,
                           struct vg_outputs *o, struct vg_error *err)
{
  const char *slash = strrchr(stem, '/');
  const char *base = slash ? slash + 1 : stem;
  vg_status st = VG_OK;

  assert(!o->dir && !o->name);
  if (dir) o->dir = strdup(dir);
  else if (!slash) o->dir = strdup(".");
  else o->dir = strndup(stem, slash == stem ? 1 : (size_t)(slash - stem));
  o->name = strdup(base);
  if (!o->dir || !o->name) return vg_fail_memory(err, "the output paths");
  if (!*base)
    return vg_fail(err, VG_ERR_INPUT, "%s: the project has no name", stem);
  o->made_dir = dir && access(dir, F_OK);
  if (dir) st = vg_make_folder(dir, err);
  return st;
}

static vg_status refuse_absent(const char *item, struct vg_error *err)
{
  if (strcmp(item, "cgns") != 0 || vg_cgns_is_built()) return VG_OK;
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "write: this build cannot write "
                 "CGNS: install libhdf5-dev and configure again");
}

/* Formats with numbers of patches, but neither names nor conditions. */
static int needs_conditions(const char *item)
{
  struct vg_ugrid_kind kind;

  return vg_ugrid_kind(item, &kind) || !strcmp(item, "mesh") ||
         !strcmp(item, "meshb");
}

/* Adds the .mapbc to files that lack its content, unless a .mapbc that is not
 * an output of Vanguard exists in its place. */
static vg_status add_conditions(struct vg_outputs *o, struct vg_error *err)
{
  int lacks = 0, has = 0, is_own = 1;
  vg_status st = VG_OK;
  char *path;

  for (size_t i = 0; i < o->n_item; i++) {
    lacks |= needs_conditions(o->item[i]);
    has |= !strcmp(o->item[i], "mapbc") || !strcmp(o->item[i], "cogsg");
  }
  if (!lacks || has || o->n_item == VG_WRITE_ITEMS) return VG_OK;
  path = vg_outputs_final(o, "mapbc");
  if (!path) return vg_fail_memory(err, "the output paths");
  if (!access(path, F_OK)) st = vg_mapbc_is_output(path, &is_own, err);
  if (st >= 0 && is_own) strcpy(o->item[o->n_item++], "mapbc");
  free(path);
  return st;
}

vg_status vg_outputs_plan(const struct vg_problem *p, const char *stem,
                          const char *dir, const char *list,
                          struct vg_outputs *o, struct vg_error *err)
{
  vg_status st = vg_outputs_place(stem, dir, o, err);

  if (st >= 0 && *list) st = vg_write_list(list, &o->n_item, o->item, err);
  for (size_t i = 0; i < o->n_item && st >= 0; i++) {
    if (strcmp(o->item[i], "mapbc") != 0)
      st = refuse_hit(o, p, o->item[i], err);
    if (st >= 0) st = refuse_second(o, p, o->item[i], err);
    if (st >= 0 && !is_case(o->item[i])) st = refuse_folder(o, o->item[i], err);
    if (st >= 0 && !strcmp(o->item[i], "cogsg"))
      st = refuse_hit(o, p, "bc", err);
    if (st >= 0) st = refuse_mixed(o->item[i], p, err);
    if (st >= 0) st = refuse_absent(o->item[i], err);
  }
  if (st >= 0) st = vg_outputs_check_sheets(o, &p->asked, err);
  return st < 0 ? st : add_conditions(o, err);
}

static void add_note(void *notes, const char *text)
{
  if (notes) vg_note(notes, "%s", text);
}

vg_status vg_outputs_claim(struct vg_outputs *o, struct vg_notes *notes,
                           struct vg_error *err)
{
  vg_status st;

  assert(o->dir && !o->commit.hidden);
  st = vg_commit_open(o->dir, o->name, add_note, notes, &o->commit, err);
  if (st < 0) return st;
  vg_display_temporary(o->commit.hidden);
  vg_commit_sweep(o->dir, &o->commit, add_note, notes);
  return VG_OK;
}

vg_status vg_outputs_check(const struct vg_problem *p, struct vg_outputs *o,
                           struct vg_error *err)
{
  const struct vg_mesh *m = &p->boundary.surface;
  struct vg_mapbc bc = VG_MAPBC_INIT;
  vg_status st = vg_outputs_check_zones(o, m, err);

  if (st < 0 || !hits_input(o, p, "mapbc")) return st;
  st = vg_mapbc_read(p->read.files.mapbc, &bc, err);
  for (size_t i = 0; i < m->n_patch && st >= 0; i++) {
    int found = m->patch[i].is_sheet; /* no part of the boundary */

    for (size_t j = 0; j < bc.n; j++) found |= bc.entry[j].id == m->patch[i].id;
    if (!found)
      st = vg_fail(err, VG_ERR_INPUT,
                   "%s is an input and will not be overwritten, but it does "
                   "not contain patch %d (%s) of the mesh; use --out DIR, or "
                   "add the patch to the file",
                   p->read.files.mapbc, (int)m->patch[i].id, m->patch[i].name);
  }
  vg_mapbc_release(&bc);
  return st;
}

vg_status vg_outputs_add(struct vg_outputs *o, const char *suffix,
                         struct vg_error *err)
{
  char *copy;

  for (size_t i = 0; i < o->n_file; i++) /* cogsg adds the mapbc. */
    if (!strcmp(o->file[i].suffix, suffix)) return VG_OK;
  copy = strdup(suffix);
  if (!copy ||
      vg_reserve(&o->file, &o->cap_file, o->n_file + 1, sizeof *o->file)) {
    free(copy);
    return vg_fail_memory(err, "the output paths");
  }
  o->file[o->n_file++] = (struct vg_outputs_file){ .suffix = copy };
  return VG_OK;
}

vg_status vg_outputs_new(struct vg_outputs *o, const char *suffix, char **path,
                         struct vg_error *err)
{
  vg_status st = vg_outputs_add(o, suffix, err);

  *path = st < 0 ? NULL : vg_outputs_temp_path(o, suffix);
  if (st >= 0 && !*path) st = vg_fail_memory(err, "the output paths");
  return st;
}

/* Distributes the name of the folder that rank 0 makes. */
vg_status vg_outputs_begin(struct vg_outputs *o, struct vg_comm *comm,
                           struct vg_error *err)
{
  struct vg_bytes name = { 0, NULL };
  vg_status st = VG_OK;

  assert(!o->temp_dir);
  o->is_guest = vg_comm_rank(comm) > 0;
  if (!o->is_guest && !o->commit.hidden) st = vg_outputs_claim(o, NULL, err);
  if (st >= 0 && !o->is_guest) {
    o->temp_dir = strdup(o->commit.fresh);
    if (!o->temp_dir) st = vg_fail_memory(err, "the output paths");
  }
  VG_TRY(vg_comm_agree(comm, st, err));
  if (!o->is_guest)
    name = (struct vg_bytes){ strlen(o->temp_dir) + 1,
                              (unsigned char *)o->temp_dir };
  o->temp_dir = NULL;
  st = vg_comm_bcast(comm, 0, &name, err);
  o->temp_dir = (char *)name.data;
done:
  return st;
}

/* --- files written slice by slice ---------------------------------------- */

static vg_status open_item(struct vg_outputs *o, const struct vg_problem *p,
                           struct vg_comm *comm, const struct vg_slices *mesh,
                           const char *item, struct vg_error *err)
{
  struct vg_slices_options options = vg_options_slices(&p->asked);
  char *path;
  vg_status st = vg_outputs_new(o, item, &path, err);

  st = vg_comm_agree(comm, st, err);
  if (st >= 0)
    st = vg_slices_ugrid_open(comm, mesh, path, &options, &o->open[o->n_open],
                              err);
  if (st >= 0) o->n_open++;
  free(path);
  return st;
}

vg_status vg_outputs_open(struct vg_outputs *o, const struct vg_problem *p,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          struct vg_error *err)
{
  vg_status st;

  if (!o) return VG_OK;
  st = vg_outputs_begin(o, comm, err);
  for (size_t i = 0; i < o->n_item && st >= 0; i++)
    if (vg_slices_is_ugrid(o->item[i]))
      st = open_item(o, p, comm, mesh, o->item[i], err);
  return st < 0 ? vg_outputs_close(o, st, err) : st;
}

vg_status vg_outputs_put(void *outputs, const struct vg_slice *slice,
                         struct vg_error *err)
{
  struct vg_outputs *o = outputs;
  double t = vg_display_now();
  vg_status st = VG_OK;

  if (!o) return VG_OK;
  for (size_t i = 0; i < o->n_open && st >= 0; i++)
    st = vg_slices_ugrid_put(o->open[i], slice, err);
  __atomic_fetch_add(&o->put_time, (uint64_t)(1e9 * (vg_display_now() - t)),
                     __ATOMIC_RELAXED);
  return st;
}

vg_status vg_outputs_close(struct vg_outputs *o, vg_status st,
                           struct vg_error *err)
{
  while (o && o->n_open)
    st = vg_slices_ugrid_close(o->open[--o->n_open], st, err);
  return st;
}

/* --- all other files ----------------------------------------------------- */

/* State of writing the mesh. */
struct writing {
  struct vg_outputs *o;
  const struct vg_problem *p;
  const struct vg_layer_stage *layers;
  struct vg_comm *comm;
  const struct vg_slices *mesh;
  int threads;
  /* Mesh and solver partitions on rank 0, for writers of whole meshes. */
  struct vg_mesh whole;
  uint32_t *part;
  int is_whole; /* 1: `whole` and `part` have been gathered. */
  struct vg_output_links links;
};

static vg_status write_format(const struct writing *w, const char *path,
                              const char *suffix, struct vg_error *err)
{
  struct vg_ugrid_kind kind;

  if (w->p->asked.ugrid_tail && vg_ugrid_kind(suffix, &kind))
    return vg_ugrid_write_tail(path, &w->whole,
                               w->mesh->n_layer_cell[VG_SLICE_TET], err);
  return vg_format_write(path, &w->whole, err);
}

static vg_status write_foam(struct writing *w, const char *path,
                            const struct vg_foam_options *options,
                            struct vg_error *err)
{
  size_t n = vg_mesh_n_cell(&w->whole);
  vg_status st = vg_foam_write(path, &w->whole, options, err);

  if (st >= 0 && w->part)
    st = vg_foam_write_parts(path, n, w->part, w->mesh->n_part, err);
  return st;
}

/* Writes a format that needs the mesh in one piece. Rank 0 writes. */
static vg_status write_whole(struct writing *w, const char *item,
                             struct vg_error *err)
{
  struct vg_foam_options options;
  const int is_foam = vg_foam_word(item, &options);
  const char *suffix = is_foam ? VG_FOAM_SUFFIX : item;
  char *path;
  vg_status st = vg_outputs_new(w->o, suffix, &path, err);

  VG_TRY(vg_comm_agree(w->comm, st, err));
  w->o->file[w->o->n_file - 1].is_case = is_foam;
  if (!w->is_whole)
    VG_TRY(
      vg_slices_gather(w->comm, w->mesh, w->threads, &w->whole, &w->part, err));
  w->is_whole = 1;
  options.n_periodic = w->p->boundary.pairs.n;
  options.periodic = w->p->boundary.pairs.pair;
  if (!w->o->is_guest)
    st = is_foam ? write_foam(w, path, &options, err)
                 : write_format(w, path, item, err);
  st = vg_comm_agree(w->comm, st, err);
done:
  free(path);
  return st;
}

/* Writes the boundary conditions, with the title of the project. Rank 0
 * writes. */
static vg_status write_conditions(struct writing *w, const char *item,
                                  struct vg_error *err)
{
  int is_fun3d = strcmp(item, "mapbc") != 0;
  struct vg_mesh boundary = VG_MESH_INIT;
  char *path;
  vg_status st = vg_outputs_new(w->o, item, &path, err);

  VG_TRY(vg_comm_agree(w->comm, st, err));
  st = vg_slices_boundary(w->comm, w->mesh, w->threads, &boundary, err);
  if (st >= 0 && !w->o->is_guest)
    st = is_fun3d
         ? vg_mapbc_write(path, &boundary, VG_MAPBC_FUN3D, NULL, NULL, err)
         : vg_mapbc_write_output(path, &boundary, w->p->asked.title, NULL, err);
  st = vg_comm_agree(w->comm, st, err);
done:
  vg_mesh_release(&boundary);
  free(path);
  return st;
}

static vg_status write_slices(struct writing *w, const char *item,
                              struct vg_error *err)
{
  const char *triple[] = { "cogsg", "bc", "mapbc", NULL };
  const char *pair[] = { "vtu", "surface.vtu", NULL };
  const char *one[] = { item, NULL };
  const char **part = !strcmp(item, "cogsg") ? triple
                    : !strcmp(item, "vtu")   ? pair
                                             : one;
  struct vg_slices_options o = vg_options_slices(&w->p->asked);
  char *stem;
  vg_status st = VG_OK;

  o.threads = w->threads;
  o.links = w->links.links.n ? &w->links.links : NULL;
  if (asprintf(&stem, "%s/%s", w->o->temp_dir, w->o->name) < 0)
    return vg_fail_memory(err, "the output paths");
  for (size_t i = 0; part[i] && st >= 0; i++)
    st = vg_outputs_add(w->o, part[i], err);
  st = vg_comm_agree(w->comm, st, err);
  if (st >= 0) st = vg_slices_write_with(w->comm, w->mesh, stem, item, &o, err);
  if (st >= 0 && part == pair)
    st = vg_slices_write_with(w->comm, w->mesh, stem, pair[1], &o, err);
  if (st >= 0 && !strcmp(item, "pvtu")) st = vg_outputs_pieces(w->o, stem, err);
  free(stem);
  return st;
}

static vg_status write_parts(struct writing *w, struct vg_error *err)
{
  char form[32];

  snprintf(form, sizeof form, "part.%u", w->mesh->n_part);
  return write_slices(w, form, err);
}

static vg_status write_item(struct writing *w, const char *item,
                            struct vg_error *err)
{
  if (!strcmp(item, "mapbc") || !strcmp(item, "fun3d.mapbc"))
    return write_conditions(w, item, err);
  if (vg_outputs_has_plane(w->o, item))
    return vg_outputs_plane(w->o, w->comm, item, err);
  /* A sheet has a zone of its own among the faces between cells; the cells of a
   * zone are together. */
  if ((!strcmp(item, VG_FLUENT_SUFFIX) && w->mesh->boundary->n_sheet) ||
      (!strcmp(item, "cgns") && w->mesh->boundary->n_zone))
    return write_whole(w, item, err);
  return vg_slices_can_write(item) ? write_slices(w, item, err)
                                   : write_whole(w, item, err);
}

static uint64_t cells_of(const struct vg_slices *s)
{
  uint64_t n = 0;

  for (int k = 0; k < VG_SLICE_KINDS; k++) n += s->n_cell[k];
  return n;
}

static vg_status write_walls(struct vg_outputs *o, const struct vg_problem *p,
                             const struct vg_layer_stage *layers,
                             struct vg_error *err)
{
  char *path;
  vg_status st = vg_outputs_new(o, WALLS, &path, err);

  if (st >= 0)
    st = vg_layer_stage_write(layers, &p->boundary.surface, path, err);
  free(path);
  return st;
}

/* The resolved settings state the files with which they were used. The number
 * of threads and the folder of helpers are omitted, so that the file does not
 * depend on the machine. */
static vg_status write_deck(struct vg_outputs *o, const struct vg_problem *p,
                            struct vg_error *err)
{
  const struct vg_input_files *f = &p->read.files;
  struct vg_settings settings = p->resolved.settings; /* Tables are borrowed. */
  const char *input = *f->surface ? f->surface : f->stem;
  const char *quote = strchr(input, ' ') ? "'" : ""; /* Quotation for a
                                                        shell. */
  char *path, *comment = NULL;
  struct vg_helper tetgen, wrap;
  vg_status st;

  vg_helper_find(VG_HELPER_TETGEN, &tetgen);
  vg_helper_find(VG_HELPER_WRAPS, &wrap);
  VG_TRY(vg_outputs_new(o, "resolved.deck", &path, err));
  if (asprintf(&comment,
               "# Complete settings of a run. To repeat it:\n#   vanguard "
               "mesh -p %s%s%s --deck %s%s.resolved.deck%s\n# (sources of a "
               ".d3m are listed below and are not read again)\n"
               "# Helper programs: %s (%s); %s (%s)\n",
               quote, input, quote, quote, o->name, quote, tetgen.name,
               tetgen.identity, wrap.name, wrap.identity) < 0)
    comment = NULL;
  settings.threads = 0;
  *settings.helpers = 0;
  st = comment ? vg_deck_write(path, &settings, comment, VG_DECK_ALL, err)
               : vg_fail_memory(err, "the settings");
done:
  free(path);
  free(comment);
  return st;
}

vg_status vg_outputs_mesh(struct vg_outputs *o, struct vg_problem *p,
                          const struct vg_layer_stage *layers,
                          struct vg_comm *comm, const struct vg_slices *mesh,
                          int threads, struct vg_error *err)
{
  struct writing w = { .o = o,
                       .p = p,
                       .layers = layers,
                       .comm = comm,
                       .mesh = mesh,
                       .threads = threads };
  vg_status st = VG_OK;

  assert(!o->n_open && o->temp_dir);
  if (p->read.settings.n_periodic)
    st = vg_output_links_find(&p->boundary.pairs, comm, mesh, threads, &w.links,
                              err);
  for (size_t i = 0; i < o->n_item && st >= 0; i++)
    if (!vg_slices_is_ugrid(o->item[i])) st = write_item(&w, o->item[i], err);
  if (!o->is_guest) vg_outputs_note_sheets(o, mesh->boundary, &p->notes);
  if (st >= 0 && !o->is_guest && vg_outputs_need_sheets(o))
    st = vg_outputs_sheets(o, mesh->boundary, mesh->n_point, cells_of(mesh),
                           &p->notes, err);
  if (st >= 0) st = vg_outputs_periodic(o, &w.links, err);
  st = vg_comm_agree(comm, st, err);
  if (st >= 0 && mesh->n_part) st = write_parts(&w, err);
  if (st >= 0 && !o->is_guest && layers->is_on)
    st = write_walls(o, p, layers, err);
  if (st >= 0 && !o->is_guest) st = write_deck(o, p, err);
  /* Files that may coincide with an input at this point: a .mapbc that contains
   * all patches, and the resolved deck of the run that is being repeated. */
  for (size_t i = 0; i < o->n_file && st >= 0; i++)
    o->file[i].keep_old = hits_input(o, p, o->file[i].suffix) != NULL;
  vg_mesh_release(&w.whole);
  vg_output_links_release(&w.links);
  free(w.part);
  return vg_comm_agree(comm, st, err);
}

static vg_status digest_file(const char *path, struct vg_outputs_file *f,
                             struct vg_error *err)
{
  struct vg_digest d = { { 0, 0 } };
  int fd = open(path, O_RDONLY), bad = 1, why;

  if (fd >= 0) bad = vg_digest_file(fd, &d, &f->bytes);
  why = errno;
  if (fd >= 0) close(fd);
  if (bad)
    return vg_fail(err, VG_ERR_IO, "%s: cannot be read back: %s", path,
                   strerror(why));
  memcpy(f->digest, d.word, sizeof f->digest);
  return VG_OK;
}

vg_status vg_outputs_digest(struct vg_outputs *o, struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(!o->is_guest && o->temp_dir);
  for (size_t i = 0; i < o->n_file && st >= 0; i++) {
    char *path = vg_outputs_temp_path(o, o->file[i].suffix);

    if (!path) st = vg_fail_memory(err, "the output paths");
    else if (!o->file[i].is_case) st = digest_file(path, &o->file[i], err);
    free(path);
  }
  return st;
}

vg_status vg_outputs_sync(const struct vg_outputs *o, struct vg_error *err)
{
  assert(!o->is_guest && o->temp_dir);
  return vg_commit_sync(&o->commit, err);
}

/* --- moving files into place --------------------------------------------- */

/* A case in the hidden folder. */
struct moving {
  struct vg_outputs *o;
  const char *case_name;
};

static vg_status add_case_move(void *moving, enum vg_foam_move kind,
                               const char *path, const char *to,
                               struct vg_error *err)
{
  const enum vg_move_kind kind_of[] = { [VG_FOAM_FILE] = VG_MOVE_FILE,
                                        [VG_FOAM_FOLDER] = VG_MOVE_FOLDER,
                                        [VG_FOAM_REMOVE] = VG_MOVE_REMOVE };
  const struct moving *m = moving;
  char *name;
  vg_status st;

  if (asprintf(&name, *path ? "%s/%s" : "%s", m->case_name, path) < 0)
    return vg_fail_memory(err, "the output paths");
  st = vg_commit_add(&m->o->commit, kind_of[kind],
                     kind == VG_FOAM_REMOVE ? "" : name, to ? to : name, err);
  free(name);
  return st;
}

static vg_status add_moves(struct vg_outputs *o,
                           const struct vg_outputs_file *f,
                           struct vg_error *err)
{
  char *from = vg_outputs_temp_path(o, f->suffix);
  char *to = vg_outputs_final(o, f->suffix);
  const char *name = from ? strrchr(from, '/') + 1 : NULL;
  struct moving moving = { o, name };
  const struct vg_foam_mover mover = { add_case_move, &moving };
  vg_status st;

  if (!from || !to) st = vg_fail_memory(err, "the output paths");
  else
    st = f->is_case ? vg_foam_merge(from, to, &mover, err)
                    : vg_commit_add(&o->commit, VG_MOVE_FILE, name, name, err);
  free(from);
  free(to);
  return st;
}

static vg_status drop_sheets(struct vg_outputs *o, struct vg_error *err)
{
  char *name;
  vg_status st;

  if (asprintf(&name, "%s." VG_SHEET_SUFFIX, o->name) < 0)
    return vg_fail_memory(err, "the output paths");
  st = vg_commit_add(&o->commit, VG_MOVE_REMOVE, "", name, err);
  free(name);
  return st;
}

vg_status vg_outputs_commit(struct vg_outputs *o, struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(!o->is_guest && o->temp_dir);
  if (vg_print_is_lost()) st = vg_fail_memory(err, "the report");
  for (size_t i = 0; i < o->n_file && st >= 0; i++)
    if (!o->file[i].keep_old) st = add_moves(o, &o->file[i], err);
  if (st >= 0 && o->drops_sheets) st = drop_sheets(o, err);
  if (st >= 0) st = vg_commit_run(&o->commit, err);
  close_commit(o);
  return st;
}
