/* core/region.h: where growth may go. */
#ifndef VG_CORE_REGION_H
#define VG_CORE_REGION_H

/** A set of cells, by the signed distances of their corners. A cell belongs
 * to the region when it meets every slab: some corner has |s| <= reach or
 * corners lie on both sides, s = normal . x - offset. No slab: everything.
 * One slab with reach 0: the cells that cross a plane (a zone). Two: the cells
 * that cross the line where two planes meet (a pencil). */
struct vg_region {
  int n_slab;
  struct vg_slab { double normal[3], offset, reach; } slab[2];
};
#define VG_REGION_ALL { 0 }

/** Does the cell a b c d belong to the region? */
int vg_region_has_cell(const struct vg_region *r, const double a[3],
                       const double b[3], const double c[3],
                       const double d[3]);

/** May a cell of size about h with a corner at x belong to it? Points that
 * fail are not needed for growing the region. */
int vg_region_near(const struct vg_region *r, const double x[3], double h);

#endif
