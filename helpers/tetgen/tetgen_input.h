/* SPDX-License-Identifier: AGPL-3.0-or-later */
/* helpers/tetgen/tetgen_input.h: a triangulation as input to TetGen. */
#ifndef VG_HELPERS_TETGEN_TETGEN_INPUT_H
#define VG_HELPERS_TETGEN_TETGEN_INPUT_H

#include <cstddef>
#include <cstdint>

#define TETLIBRARY
#include <tetgen.h>

/** Allocate n points, numbered from 0, which the caller fills in. TetGen's
 * destructor frees them. */
inline void vg_tetgen_points(tetgenio &in, std::size_t n)
{
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(n);
  in.pointlist = new REAL[3 * n];
}

/** Set n triangles as facets with one polygon each. */
inline void vg_tetgen_triangles(tetgenio &in, std::size_t n,
                                const std::uint32_t (*tri)[3])
{
  in.numberoffacets = static_cast<int>(n);
  in.facetlist = new tetgenio::facet[n];
  for (std::size_t i = 0; i < n; i++) {
    tetgenio::facet *f = &in.facetlist[i];

    tetgenio::init(f);
    f->numberofpolygons = 1;
    f->polygonlist = new tetgenio::polygon[1];
    tetgenio::init(f->polygonlist);
    f->polygonlist->numberofvertices = 3;
    f->polygonlist->vertexlist = new int[3];
    for (int k = 0; k < 3; k++)
      f->polygonlist->vertexlist[k] = static_cast<int>(tri[i][k]);
  }
}

#endif
