/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_read_parts.h: declarations shared by the readers of unstructured
 * and of structured zones. Private to its module. */
#ifndef VG_IO_CGNS_READ_PARTS_H
#define VG_IO_CGNS_READ_PARTS_H

#include "io/cgns/cgns_block.h"
#include "io/cgns/cgns_tree.h"
#include "io/stream/soup.h"

#define VG_CGNS_NONE UINT32_MAX /* for an element without a patch */
enum { VG_CGNS_N_ELEMENT = 7 };

struct vg_cgns_family {
  char name[VG_CGNS_NAME], condition[VG_CGNS_NAME];
  char number[VG_CGNS_NAME]; /* of its patch, if Vanguard wrote it; or "" */
  char kind[VG_CGNS_NAME];   /* of its zone; or "" */
};

/* Cells of a region, elements first to last of a zone. */
struct vg_cgns_region {
  char name[VG_CGNS_NAME];
  int64_t first, last;
};

struct vg_cgns_reader {
  struct vg_input *in;
  struct vg_cgns_tree *tree;
  int64_t dimension; /* dimension of the cells: 2 or 3 */
  size_t n_zone, n_family, cap_family;
  size_t n_volume_block; /* number of structured zones with cells */
  size_t cap_quad, cap_quad_patch, cap[VG_CGNS_N_ELEMENT];
  struct vg_cgns_family *family; /* sorted by name */
  struct vg_soup soup;
  /* Data of the current zone. */
  struct vg_cgns_node zone;
  uint32_t *point; /* [n_point] numbers of its points in the mesh */
  size_t n_point, n_section;
  struct vg_cgns_section *section; /* sorted by element numbers */
  struct vg_cgns_block block;      /* points of a structured zone */
  int n_index;                     /* number of indices of a structured zone */
  int flat; /* index along which a surface has a single layer of points; -1:
               none */
  uint32_t *cell; /* patches of the faces of a surface */
  /* Regions of cells: those of the current zone from first_region on. */
  struct vg_cgns_region *region;
  size_t n_region, cap_region, first_region;
  int32_t *tag[VG_CGNS_N_ELEMENT]; /* of the cells read, by elements: number of
                                      the region from 1; 0: none */
  size_t cap_tag[VG_CGNS_N_ELEMENT];
};

typedef vg_status vg_cgns_read_one(struct vg_cgns_reader *r,
                                   const struct vg_cgns_node *b,
                                   struct vg_error *err);

vg_status vg_cgns_fail_zone(const struct vg_cgns_reader *r,
                            struct vg_error *err, vg_status code,
                            const char *what);

/** Text of a child, shortened if necessary; "" if there is no such child. */
vg_status vg_cgns_child_text(struct vg_cgns_reader *r, int64_t parent,
                             const char *label, const char *name,
                             char to[VG_CGNS_NAME], struct vg_error *err);

/** Family of a zone or condition, without the name of its base; "" if there is
 * none. */
vg_status vg_cgns_family_name(struct vg_cgns_reader *r, int64_t parent,
                              char to[VG_CGNS_NAME], struct vg_error *err);

/** Find or create the patch with this name. condition "" means that of the
 * family with the same name. */
vg_status vg_cgns_find_patch(struct vg_cgns_reader *r, const char *name,
                             const char *condition, uint32_t *at,
                             struct vg_error *err);

/** Read the three coordinates of the points, [n_point] each, which the caller
 * frees also on failure. */
vg_status vg_cgns_read_coordinates(struct vg_cgns_reader *r, double *x[3],
                                   struct vg_error *err);

/** Call `read` for every condition of the zone. */
vg_status vg_cgns_read_conditions(struct vg_cgns_reader *r,
                                  vg_cgns_read_one *read, struct vg_error *err);

/** Elements of a BC_t: the `name` of its range or list, and its *n numbers; 0
 * if it has none. The caller frees *v. */
vg_status vg_cgns_elements_of(struct vg_cgns_reader *r,
                              const struct vg_cgns_node *b,
                              char name[VG_CGNS_NAME], int64_t **v, size_t *n,
                              struct vg_error *err);

/** Patch of a BC_t: that of its family if it has one, otherwise of its own
 * name. */
vg_status vg_cgns_condition_patch(struct vg_cgns_reader *r,
                                  const struct vg_cgns_node *b, uint32_t *patch,
                                  struct vg_error *err);

/** Read the regions of cells of the current zone, and after all zones make the
 * zones of the mesh from them (cgns_read_zones.c). A zone of the file among
 * several is a region if it has none. Regions that overlap:
 * VG_ERR_UNSUPPORTED. */
vg_status vg_cgns_read_regions(struct vg_cgns_reader *r, struct vg_error *err);
vg_status vg_cgns_make_zones(struct vg_cgns_reader *r, struct vg_error *err);

/** The region of an element of the current zone, from 1; 0: none. *hint: of the
 * element before. */
int32_t vg_cgns_region_of(const struct vg_cgns_reader *r, int64_t element,
                          size_t *hint);

/** Note the region of the next cell, of the kind element < VG_CGNS_N_ELEMENT
 * (cgns_read.c). Returns nonzero without memory. */
int vg_cgns_take_tag(struct vg_cgns_reader *r, int element, int32_t region);

/** The family of this name, or NULL. */
const struct vg_cgns_family *vg_cgns_find_family(const struct vg_cgns_reader *r,
                                                 const char *name);

/** Read a structured zone with n sizes; the caller releases it. */
vg_status vg_cgns_read_block(struct vg_cgns_reader *r, const int64_t *size,
                             size_t n, struct vg_error *err);

#endif
