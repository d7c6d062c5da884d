/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* CGNS nodes in HDF5; see io/cgns/cgns_tree.h and, in the standard, "CGNS/HDF5
 * file mapping". Files are reproducible: HDF5 records no times, and space for
 * arrays is reserved at once. */
#include "io/cgns/cgns.h"
#include "io/cgns/cgns_tree.h"

#include <assert.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define DATA " data"
/* Best compression ratio of deflate. Data sets that claim a higher ratio are
 * wrong, or were never written. */
#define INFLATED_MOST 1100

struct vg_cgns_tree {
  struct vg_cgns_store *store;
  struct vg_cgns_store view; /* bytes to be read */
  hid_t driver, file, group_plist, data_plist, string[2];
  char *path;        /* name in messages */
  int failed;        /* 1: HDF5 failed while writing */
  H5E_auto2_t print; /* error handler of the library before this file */
  void *print_data;
};

int vg_cgns_tree_is_built(void)
{
  return 1;
}

void vg_library_hdf5(struct vg_library *out)
{
  unsigned v[3] = { 0, 0, 0 };

  H5get_libversion(&v[0], &v[1], &v[2]);
  out->name = "HDF5";
  snprintf(out->version, sizeof out->version, "%u.%u.%u", v[0], v[1], v[2]);
}

/* --- a virtual file driver of HDF5 on a store --- */

struct file {
  H5FD_t as_hdf5; /* must be first: HDF5 writes to it */
  struct vg_cgns_store *store;
};

static H5FD_t *file_open(const char *name, unsigned flags, hid_t access,
                         haddr_t most)
{
  struct vg_cgns_store *const *store = H5Pget_driver_info(access);
  struct file *f = store ? vg_calloc(1, sizeof *f) : NULL;

  (void)name, (void)flags, (void)most;
  if (!f) return NULL;
  f->store = *store;
  return &f->as_hdf5;
}

static herr_t file_close(H5FD_t *f)
{
  free(f);
  return 0;
}

static haddr_t file_end(const H5FD_t *f, H5FD_mem_t type)
{
  (void)type;
  return ((const struct file *)f)->store->size;
}

static herr_t file_set_end(H5FD_t *f, H5FD_mem_t type, haddr_t at)
{
  struct vg_cgns_store *s = ((struct file *)f)->store;

  (void)type;
  if (s->view) return at <= s->size ? 0 : -1;
  s->size = at;
  return 0;
}

static herr_t file_read(H5FD_t *f, H5FD_mem_t type, hid_t plist, haddr_t at,
                        size_t n, void *to)
{
  (void)type, (void)plist;
  vg_cgns_store_get(((struct file *)f)->store, at, n, to);
  return 0;
}

static herr_t file_write(H5FD_t *f, H5FD_mem_t type, hid_t plist, haddr_t at,
                         size_t n, const void *from)
{
  (void)type, (void)plist;
  vg_cgns_store_put(((struct file *)f)->store, at, n, from);
  return 0;
}

static const H5FD_class_t file_class = { .name = "vanguard_store",
                                         .maxaddr = INT64_MAX,
                                         .fc_degree = H5F_CLOSE_STRONG,
                                         .fapl_size = sizeof(
                                           struct vg_cgns_store *),
                                         .open = file_open,
                                         .close = file_close,
                                         .get_eoa = file_end,
                                         .set_eoa = file_set_end,
                                         .get_eof = file_end,
                                         .read = file_read,
                                         .write = file_write,
                                         .fl_map = H5FD_FLMAP_SINGLE };

/* --- both reading and writing --- */

/* Access properties that open the store as a file. */
static hid_t access_to(struct vg_cgns_tree *t)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);

  t->driver = H5FDregister(&file_class);
  if (t->driver < 0 || H5Pset_driver(access, t->driver, &t->store) < 0 ||
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0)
    t->failed = 1;
  return access;
}

static struct vg_cgns_tree *make_tree(const char *path)
{
  struct vg_cgns_tree *t = vg_calloc(1, sizeof *t);

  if (!t) return NULL;
  t->driver = t->file = t->group_plist = t->data_plist = t->string[0] =
    t->string[1] = H5I_INVALID_HID;
  t->path = strdup(path);
  if (!t->path) {
    free(t);
    return NULL;
  }
  H5Eget_auto2(H5E_DEFAULT, &t->print, &t->print_data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  return t;
}

static void release(struct vg_cgns_tree *t)
{
  if (t->driver >= 0) H5FDunregister(t->driver);
  if (t->group_plist >= 0) H5Pclose(t->group_plist);
  if (t->data_plist >= 0) H5Pclose(t->data_plist);
  for (int k = 0; k < 2; k++)
    if (t->string[k] >= 0) H5Tclose(t->string[k]);
  H5Eset_auto2(H5E_DEFAULT, t->print, t->print_data);
  free(t->path);
  free(t);
}

vg_status vg_cgns_tree_close(struct vg_cgns_tree *t, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!t) return VG_OK;
  if (t->file >= 0 && H5Fclose(t->file) < 0) t->failed = 1;
  if (t->store->failed) st = vg_fail_memory(err, "the nodes of a CGNS file");
  else if (t->failed)
    st = vg_fail(err, VG_ERR_IO,
                 "%s: the HDF5 library cannot write the "
                 "nodes",
                 t->path);
  release(t);
  return st;
}

/* --- writing --- */

static hid_t make_string(size_t n)
{
  hid_t type = H5Tcopy(H5T_C_S1);

  if (type >= 0) H5Tset_size(type, n);
  return type;
}

static void put_attribute(struct vg_cgns_tree *t, hid_t to, const char *name,
                          hid_t type, int is_array, const void *value)
{
  hsize_t one = 1;
  hid_t space = is_array ? H5Screate_simple(1, &one, NULL)
                         : H5Screate(H5S_SCALAR);
  hid_t a = H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT);

  if (a < 0 || H5Awrite(a, type, value) < 0) t->failed = 1;
  if (a >= 0) H5Aclose(a);
  if (space >= 0) H5Sclose(space);
}

/* Write a string of n bytes, zero-filled after its end. */
static void put_string(struct vg_cgns_tree *t, hid_t to, const char *name,
                       int is_type, const char *value)
{
  char text[VG_CGNS_NAME] = "";

  strncat(text, value, is_type ? 2 : VG_CGNS_NAME - 1);
  put_attribute(t, to, name, t->string[is_type], 0, text);
}

static hid_t type_of(const char *type)
{
  static const char names[] = "C1I4I8R4R8";
  const hid_t types[] = { H5T_STD_I8LE, H5T_STD_I32LE, H5T_STD_I64LE,
                          H5T_IEEE_F32LE, H5T_IEEE_F64LE };

  return types[(strstr(names, type) - names) / 2];
}

static hid_t native_of(const char *type)
{
  static const char names[] = "C1I4I8R4R8";
  const hid_t types[] = { H5T_NATIVE_SCHAR, H5T_NATIVE_INT32, H5T_NATIVE_INT64,
                          H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE };

  return types[(strstr(names, type) - names) / 2];
}

static void put_data(struct vg_cgns_tree *t, hid_t to, const char *name,
                     const struct vg_cgns_data *d, uint64_t *at)
{
  hsize_t dim[2];
  hid_t space, set;

  for (int k = 0; k < d->n_dim; k++) dim[k] = d->dim[d->n_dim - 1 - k];
  space = H5Screate_simple(d->n_dim, dim, NULL);
  set = H5Dcreate2(to, name, type_of(d->type), space, H5P_DEFAULT,
                   t->data_plist, H5P_DEFAULT);
  if (set < 0) {
    t->failed = 1;
  } else if (d->value) {
    if (H5Dwrite(set, native_of(d->type), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                 d->value) < 0)
      t->failed = 1;
  } else {
    haddr_t place = H5Dget_offset(set);

    if (place == HADDR_UNDEF) t->failed = 1;
    *at = place;
  }
  if (set >= 0) H5Dclose(set);
  if (space >= 0) H5Sclose(space);
}

static vg_status refused(const struct vg_cgns_tree *t, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO,
                 "%s: the HDF5 library cannot write the "
                 "nodes",
                 t->path);
}

/* Creation properties of groups (including the root) and of data sets. */
static void set_plists(struct vg_cgns_tree *t, hid_t root_plist)
{
  const hid_t group[2] = { t->group_plist, root_plist };

  for (int k = 0; k < 2; k++)
    if (H5Pset_link_creation_order(group[k], H5P_CRT_ORDER_TRACKED |
                                               H5P_CRT_ORDER_INDEXED) < 0 ||
        H5Pset_obj_track_times(group[k], 0) < 0)
      t->failed = 1;
  if (H5Pset_obj_track_times(t->data_plist, 0) < 0 ||
      H5Pset_alloc_time(t->data_plist, H5D_ALLOC_TIME_EARLY) < 0 ||
      H5Pset_fill_time(t->data_plist, H5D_FILL_TIME_NEVER) < 0)
    t->failed = 1;
}

/* Write the attributes that the CGNS library puts into the root of a file. */
static int64_t put_root(struct vg_cgns_tree *t)
{
  static const char format[] = "IEEE_LITTLE_32", version[33] = "HDF5";
  const struct vg_cgns_data formats = { "C1", 1, { sizeof format, 0 }, format };
  const struct vg_cgns_data versions = {
    "C1", 1, { sizeof version, 0 }, version
  };
  hid_t root = H5Gopen2(t->file, "/", H5P_DEFAULT);

  put_string(t, root, "name", 0, "HDF5 MotherNode");
  put_string(t, root, "label", 0, "Root Node of HDF5 File");
  put_string(t, root, "type", 1, "MT");
  put_data(t, root, " format", &formats, NULL);
  put_data(t, root, " hdf5version", &versions, NULL);
  return root;
}

vg_status vg_cgns_tree_new(struct vg_cgns_store *store, const char *name,
                           struct vg_cgns_tree **out, int64_t *root,
                           struct vg_error *err)
{
  struct vg_cgns_tree *t = make_tree(name);
  hid_t access, create;
  vg_status st = VG_OK;

  assert(!store->view && !store->size && !store->n_page);
  if (!t) return vg_fail_memory(err, "a CGNS file");
  t->store = store;
  access = access_to(t);
  create = H5Pcreate(H5P_FILE_CREATE);
  t->group_plist = H5Pcreate(H5P_GROUP_CREATE);
  t->data_plist = H5Pcreate(H5P_DATASET_CREATE);
  t->string[0] = make_string(VG_CGNS_NAME);
  t->string[1] = make_string(3);
  set_plists(t, create);
  H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_V18);
  t->file = H5Fcreate(name, H5F_ACC_TRUNC, create, access);
  H5Pclose(access);
  H5Pclose(create);
  if (t->file >= 0 && !t->failed) *root = put_root(t);
  if (t->file < 0 || t->failed) {
    st = refused(t, err);
    vg_cgns_tree_close(t, NULL);
    return st;
  }
  *out = t;
  return VG_OK;
}

vg_status vg_cgns_tree_add(struct vg_cgns_tree *t, int64_t parent,
                           const char *name, const char *label,
                           const struct vg_cgns_data *d, int64_t *id,
                           uint64_t *at, struct vg_error *err)
{
  assert(d->n_dim >= 0 && d->n_dim <= 2);
  hid_t node = H5Gcreate2(parent, name, H5P_DEFAULT, t->group_plist,
                          H5P_DEFAULT);
  int flags = 1;

  if (node < 0) {
    t->failed = 1;
    return refused(t, err);
  }
  put_string(t, node, "name", 0, name);
  put_string(t, node, "label", 0, label);
  put_string(t, node, "type", 1, d->type);
  put_attribute(t, node, "flags", H5T_STD_I32LE, 1, &flags);
  if (d->n_dim) put_data(t, node, DATA, d, at);
  if (id) *id = node;
  else H5Gclose(node);
  return t->failed ? refused(t, err) : VG_OK;
}

/* --- reading --- */

vg_status vg_cgns_tree_open(struct vg_input *in, struct vg_cgns_tree **out,
                            int64_t *root, struct vg_error *err)
{
  struct vg_cgns_tree *t = make_tree(in->path);
  hid_t access;

  if (!t) return vg_fail_memory(err, "a CGNS file");
  t->view.view = in->data;
  t->view.size = in->size;
  t->store = &t->view;
  /* A file must not be able to load code. */
  H5PLset_loading_state(0);
  access = access_to(t);
  t->file = H5Fopen(in->path, H5F_ACC_RDONLY, access);
  H5Pclose(access);
  *root = t->file < 0 ? -1 : H5Gopen2(t->file, "/", H5P_DEFAULT);
  if (*root < 0) {
    vg_cgns_tree_close(t, NULL);
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: the HDF5 library cannot open it: the file is "
                   "truncated, damaged, or of a newer version",
                   in->path);
  }
  *out = t;
  return VG_OK;
}

/* Read a string attribute; "" if it is absent. */
static void get_string(hid_t node, const char *name, char to[VG_CGNS_NAME])
{
  hid_t a = H5Aexists(node, name) > 0 ? H5Aopen(node, name, H5P_DEFAULT) : -1;
  hid_t type = a >= 0 ? H5Aget_type(a) : -1,
        space = a >= 0 ? H5Aget_space(a) : -1;
  hid_t as = make_string(VG_CGNS_NAME);

  memset(to, 0, VG_CGNS_NAME);
  /* Strings of variable length would be stored as pointers. */
  if (type >= 0 && space >= 0 && H5Tget_class(type) == H5T_STRING &&
      !H5Tis_variable_str(type) && H5Sget_simple_extent_npoints(space) == 1 &&
      H5Aread(a, as, to) < 0)
    memset(to, 0, VG_CGNS_NAME);
  to[VG_CGNS_NAME - 1] = 0;
  if (as >= 0) H5Tclose(as);
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (a >= 0) H5Aclose(a);
}

struct visit {
  struct vg_cgns_tree *t;
  const char *label;
  struct vg_cgns_node *list;
  size_t n, cap;
  vg_status st;
  struct vg_error *err;
};

static vg_status is_link(const struct vg_cgns_tree *t, const char *name,
                         struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: node '%.40s' is a link to another location; write a "
                 "single file without links",
                 t->path, name);
}

/* Collect a group that has the requested label. */
static vg_status take_child(struct visit *v, hid_t parent, const char *name)
{
  struct vg_cgns_node node = { .id = H5Oopen(parent, name, H5P_DEFAULT) };
  char type[VG_CGNS_NAME];

  if (node.id < 0)
    return vg_fail(v->err, VG_ERR_FORMAT, "%s: node '%.40s' is damaged",
                   v->t->path, name);
  if (H5Iget_type(node.id) == H5I_GROUP) {
    get_string(node.id, "type", type);
    if (!strcmp(type, "LK")) return is_link(v->t, name, v->err);
    get_string(node.id, "label", node.label);
    if (!strcmp(node.label, v->label)) {
      strncat(node.name, name, VG_CGNS_NAME - 1);
      if (vg_reserve(&v->list, &v->cap, v->n + 1, sizeof *v->list))
        return vg_fail_memory(v->err, "the nodes of a CGNS file");
      v->list[v->n++] = node;
      return VG_OK;
    }
  }
  H5Oclose(node.id);
  return VG_OK;
}

static herr_t see_child(hid_t parent, const char *name, const H5L_info_t *info,
                        void *visit)
{
  struct visit *v = visit;

  if (*name == ' ') return 0; /* a data set, not a node */
  v->st = info->type == H5L_TYPE_HARD ? take_child(v, parent, name)
                                      : is_link(v->t, name, v->err);
  return v->st < 0;
}

static H5_index_t order_of(hid_t group)
{
  hid_t plist = H5Gget_create_plist(group);
  unsigned flags = 0;

  if (plist < 0) return H5_INDEX_NAME;
  if (H5Pget_link_creation_order(plist, &flags) < 0) flags = 0;
  H5Pclose(plist);
  return flags & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
}

vg_status vg_cgns_tree_children(struct vg_cgns_tree *t, int64_t parent,
                                const char *label, struct vg_cgns_node **list,
                                size_t *n, struct vg_error *err)
{
  struct visit v = { .t = t, .label = label, .st = VG_OK, .err = err };

  if (H5Literate(parent, order_of(parent), H5_ITER_INC, NULL, see_child, &v) <
        0 &&
      v.st == VG_OK)
    v.st = vg_fail(err, VG_ERR_FORMAT, "%s: a list of nodes (%s) is damaged",
                   t->path, label);
  if (v.st < 0) {
    free(v.list);
    return v.st;
  }
  *list = v.list;
  *n = v.n;
  return VG_OK;
}

/* Open a node's data. Links, external storage and virtual data sets would show
 * bytes of other files, so they are refused with VG_ERR_UNSUPPORTED. *set is
 * invalid if there are no data. */
static vg_status open_data(const struct vg_cgns_tree *t, hid_t node,
                           const char *what, hid_t *set, struct vg_error *err)
{
  H5L_info_t link = { .type = H5L_TYPE_ERROR };
  hid_t plist;
  int is_own;

  *set = -1;
  if (H5Lexists(node, DATA, H5P_DEFAULT) <= 0 ||
      H5Lget_info(node, DATA, &link, H5P_DEFAULT) < 0)
    return VG_OK;
  if (link.type == H5L_TYPE_HARD) *set = H5Dopen2(node, DATA, H5P_DEFAULT);
  plist = *set >= 0 ? H5Dget_create_plist(*set) : -1;
  is_own = link.type == H5L_TYPE_HARD &&
           (plist < 0 || (H5Pget_layout(plist) != H5D_VIRTUAL &&
                          H5Pget_external_count(plist) <= 0));
  if (plist >= 0) H5Pclose(plist);
  if (is_own) return VG_OK;
  if (*set >= 0) H5Dclose(*set);
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "%s: %s: the data are in another file or at another location; "
                 "write a single file without links, external storage and "
                 "virtual data sets",
                 t->path, what);
}

/* Read data as values of `size` bytes of a native type, with space for one
 * more. */
static vg_status get_data(struct vg_cgns_tree *t, int64_t id, const char *what,
                          H5T_class_t class, hid_t native, size_t size,
                          void **out, size_t *n, struct vg_error *err)
{
  hid_t set, type, space;
  hssize_t count;
  vg_status st = open_data(t, id, what, &set, err);
  void *v = NULL;

  if (st < 0) return st;
  type = set >= 0 ? H5Dget_type(set) : -1;
  space = set >= 0 ? H5Dget_space(set) : -1;
  count = space >= 0 ? H5Sget_simple_extent_npoints(space) : -1;
  if (type < 0 || count < 0 || H5Tget_class(type) != class)
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: %s: the data are missing or do not have the expected "
                 "type",
                 t->path, what);
  else if ((uint64_t)count > INFLATED_MOST * t->view.size)
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: %s: %lld values do not fit into a file of %llu bytes",
                 t->path, what, (long long)count,
                 (unsigned long long)t->view.size);
  else if (!(v = vg_calloc((size_t)count + 1, size)))
    st = vg_fail_memory(err, what);
  else if (count && H5Dread(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, v) < 0)
    st = vg_fail(err, VG_ERR_FORMAT, "%s: %s: the data are damaged", t->path,
                 what);
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  if (set >= 0) H5Dclose(set);
  if (st < 0) {
    free(v);
    return st;
  }
  *out = v;
  *n = (size_t)count;
  return VG_OK;
}

vg_status vg_cgns_tree_ints(struct vg_cgns_tree *t, int64_t id,
                            const char *what, int64_t **v, size_t *n,
                            struct vg_error *err)
{
  void *data;
  vg_status st = get_data(t, id, what, H5T_INTEGER, H5T_NATIVE_INT64,
                          sizeof **v, &data, n, err);

  if (st >= 0) *v = data;
  return st;
}

vg_status vg_cgns_tree_reals(struct vg_cgns_tree *t, int64_t id,
                             const char *what, double **v, size_t *n,
                             struct vg_error *err)
{
  void *data;
  vg_status st = get_data(t, id, what, H5T_FLOAT, H5T_NATIVE_DOUBLE, sizeof **v,
                          &data, n, err);

  if (st >= 0) *v = data;
  return st;
}

vg_status vg_cgns_tree_text(struct vg_cgns_tree *t, int64_t id,
                            const char *what, char **v, size_t *n,
                            struct vg_error *err)
{
  void *data;
  vg_status st = get_data(t, id, what, H5T_INTEGER, H5T_NATIVE_SCHAR,
                          sizeof **v, &data, n, err);

  if (st < 0) return st;
  *v = data;
  *n = strnlen(*v, *n);
  while (*n && (*v)[*n - 1] == ' ') (*v)[--*n] = 0;
  return VG_OK;
}
