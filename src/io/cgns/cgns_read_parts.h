/* io/cgns/cgns_read_parts.h: what the readers of unstructured and of structured
 * zones share. Private to its module. */
#ifndef VG_IO_CGNS_READ_PARTS_H
#define VG_IO_CGNS_READ_PARTS_H

#include "io/cgns/cgns_block.h"
#include "io/cgns/cgns_tree.h"
#include "io/stream/soup.h"

#define VG_CGNS_NONE UINT32_MAX /* an element without a patch */
enum { VG_CGNS_N_ELEMENT = 7 };

struct vg_cgns_family {
  char name[VG_CGNS_NAME], condition[VG_CGNS_NAME];
};

struct vg_cgns_reader {
  struct vg_input *in;
  struct vg_cgns_tree *tree;
  int64_t dimension; /* of the cells: 2 or 3 */
  size_t n_zone, n_family, cap_family;
  size_t n_volume_block; /* structured zones with cells */
  size_t cap_quad, cap_quad_patch, cap[VG_CGNS_N_ELEMENT];
  struct vg_cgns_family *family; /* by name */
  struct vg_soup soup;
  /* of the current zone */
  struct vg_cgns_node zone;
  uint32_t *point; /* [n_point] in the mesh */
  size_t n_point, n_section;
  struct vg_cgns_section *section; /* by rising numbers */
  struct vg_cgns_block block;      /* of a structured zone */
  int n_index;                     /* of a structured zone: indices */
  int flat;                        /* the one along which a surface has a
                                      single layer of points; -1: none */
  uint32_t *cell;                  /* patches of the faces of a surface */
};

typedef vg_status vg_cgns_read_one(struct vg_cgns_reader *r,
                                   const struct vg_cgns_node *b,
                                   struct vg_error *err);

vg_status vg_cgns_fail_zone(const struct vg_cgns_reader *r,
                            struct vg_error *err, vg_status code,
                            const char *what);

/** Text of a child, cut to fit; "" if the node has no such child. */
vg_status vg_cgns_child_text(struct vg_cgns_reader *r, int64_t parent,
                             const char *label, const char *name,
                             char to[VG_CGNS_NAME], struct vg_error *err);

/** The family of a zone or condition, without that of its base; "": none. */
vg_status vg_cgns_family_name(struct vg_cgns_reader *r, int64_t parent,
                              char to[VG_CGNS_NAME], struct vg_error *err);

/** The patch of a name, with a condition: "" that of a family of its name. */
vg_status vg_cgns_find_patch(struct vg_cgns_reader *r, const char *name,
                             const char *condition, uint32_t *at,
                             struct vg_error *err);

/** The three coordinates of the points, [n_point] each, which the caller frees
 * also on failure. */
vg_status vg_cgns_read_coordinates(struct vg_cgns_reader *r, double *x[3],
                                   struct vg_error *err);

/** Call `read` for all conditions of the zone. */
vg_status vg_cgns_read_conditions(struct vg_cgns_reader *r,
                                  vg_cgns_read_one *read, struct vg_error *err);

/** What a BC_t is on: `name` of its range or list and its *n numbers, 0: none.
 * The caller frees *v. */
vg_status vg_cgns_elements_of(struct vg_cgns_reader *r,
                              const struct vg_cgns_node *b,
                              char name[VG_CGNS_NAME], int64_t **v, size_t *n,
                              struct vg_error *err);

/** The patch of a BC_t: that of its family, where it has one, else of its own
 * name. */
vg_status vg_cgns_condition_patch(struct vg_cgns_reader *r,
                                  const struct vg_cgns_node *b, uint32_t *patch,
                                  struct vg_error *err);

/** A structured zone of n sizes, which the caller releases. */
vg_status vg_cgns_read_block(struct vg_cgns_reader *r, const int64_t *size,
                             size_t n, struct vg_error *err);

#endif
