/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Text files that break their format. */
#include <string.h>
#include <zlib.h>

#include "hostile.h"

#define FACET(x)                                                               \
  "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex " x "\n"               \
  "vertex 0 1 0\nendloop\nendfacet\n"
#define T1 "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define GMSH "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define POINTER                                                                \
  "version https://git-lfs.github.com/spec/v1\n"                               \
  "oid sha256:4d7a214614ab2935c943f9e0ff69d22e"                                \
  "adbb8f32b1258daaa5e2ca24d17e2393"                                           \
  "\nsize 12345\n"
#define MARK "\xef\xbb\xbf"
#define MEDIT "MeshVersionFormatted 2\nDimension 3\n"

/* A long line and a long token must not overflow a short buffer, nor truncate
 * the message away. */
static void make_long_token(const char *file)
{
  static char text[70000];

  memset(text, '7', sizeof text);
  memcpy(text, "v 0 0 ", 6);
  text[sizeof text - 1] = '\n';
  text[sizeof text - 2] = 'x';
  save(file, text, sizeof text);
}

static void make_gzip(const char *file, const char *text, size_t cut)
{
  unsigned char packed[4096];
  z_stream z = { 0 };
  size_t n;

  deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  z.next_in = (unsigned char *)text;
  z.avail_in = (uInt)strlen(text);
  z.next_out = packed;
  z.avail_out = sizeof packed;
  deflate(&z, Z_FINISH);
  n = sizeof packed - z.avail_out;
  deflateEnd(&z);
  if (cut > n) packed[n / 2] ^= 0x55;
  else n -= cut;
  save(file, packed, n);
}

static const char gzip_text[] = "solid a\n" FACET("1 0 0") FACET("2 0 0")
  FACET("3 0 0.123456789") "endsolid";

static void make_cut_gzip(const char *file)
{
  make_gzip(file, gzip_text, 30);
}

static void make_broken_gzip(const char *file)
{
  make_gzip(file, gzip_text, SIZE_MAX);
}

static void make_bad_mapbc(const char *file)
{
  save_text(file, "4 4\n" T1 "1 3 2\n1 2 4\n1 4 3\n2 3 4\n1\n2\n2\n2\n");
  save_text("bad_mapbc.mapbc", "2\n1 4000 wall\n1 5000 far\n");
}

static void make_cut_mapbc(const char *file)
{
  save_text(file, "4 4\n" T1 "1 3 2\n1 2 4\n1 4 3\n2 3 4\n1\n2\n2\n2\n");
  save_text("cut_mapbc.mapbc", "5\n1 4000 wall\n");
}

/* Patch 2 has no line in the .mapbc. */
static void make_no_bc(const char *file)
{
  save_text(file, "4 4\n" T1 "1 3 2\n1 2 4\n1 4 3\n2 3 4\n1\n2\n2\n2\n");
  save_text("no_bc.mapbc", "1\n1 4000 wall\n");
}

static void make_folder_like(const char *file)
{
  (void)file; /* a file that does not exist */
}

const struct hostile hostile_texts[] = {
  { .file = "empty.stl", .phrase = "empty", .text = "" },
  { .file = "empty.ugrid", .phrase = "empty", .text = "" },
  { .file = "empty.mesh", .phrase = "empty", .text = "" },
  { .file = "absent.tri",
    .phrase = "does not exist",
    .make = make_folder_like },
  { .file = "mark.stl", .phrase = "empty", .text = MARK },
  { .file = "mark_mark.obj", .phrase = "no faces", .text = MARK MARK "\n" },
  { .file = "mark.tri", .phrase = "'four'", .text = MARK "four 4\n" T1 },
  { .file = "pointer.stl", .phrase = "git lfs pull", .text = POINTER },
  { .file = "pointer.cgns", .phrase = "git lfs pull", .text = POINTER },
  { .file = "pointer.step", .phrase = "git lfs pull", .text = POINTER },
  { .file = "pointer.lb8.ugrid",
    .phrase = "git lfs pull",
    .text = MARK POINTER },
  { .file = "blank.obj", .phrase = "no faces", .text = " \n\n\t\r\n" },
  { .file = "word.xyz", .phrase = "stl", .text = "hello\n" },
  { .file = "no_facets.stl",
    .phrase = "no facets",
    .text = "solid a\nendsolid a\n" },
  { .file = "cut_in_number.stl",
    .phrase = "cut_in_number.stl:5",
    .text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
            "vertex 1 0" },
  { .file = "no_endsolid.stl",
    .phrase = "endsolid",
    .text = "solid a\n" FACET("1 0 0") },
  { .file = "nan.stl",
    .phrase = "'nan'",
    .text = "solid a\n" FACET("nan 0 0") "endsolid a\n" },
  { .file = "infinite.stl",
    .phrase = "'inf'",
    .text = "solid a\n" FACET("1 inf 0") "endsolid a\n" },
  { .file = "overflow.stl",
    .phrase = "1e400",
    .text = "solid a\n" FACET("1e400 0 0") "endsolid a\n" },
  { .file = "four_corners.stl",
    .phrase = "triangles only",
    .text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
            "vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n"
            "endsolid\n" },
  { .file = "is_really_tri.stl", .phrase = "'solid'", .text = "4 4\n" T1 },
  { .file = "truncated.stl.gz", .phrase = "gzip", .make = make_cut_gzip },
  { .file = "broken.stl.gz", .phrase = "gzip", .make = make_broken_gzip },
  { .file = "zero.tri", .phrase = "no surface", .text = "0 0\n" },
  { .file = "negative.tri", .phrase = "-4", .text = "-4 4\n" T1 },
  { .file = "huge.tri",
    .phrase = "truncated",
    .text = "4000000000 4000000000\n" T1 },
  { .file = "huge64.tri",
    .phrase = "32-bit",
    .text = "9223372036854775807 9223372036854775807\n" T1 },
  { .file = "range.tri",
    .phrase = "vertex 5",
    .text = "4 4\n" T1 "1 3 2\n1 2 5\n1 4 3\n2 3 4\n" },
  { .file = "index_zero.tri",
    .phrase = "vertex 0",
    .text = "4 4\n" T1 "1 3 2\n1 2 0\n1 4 3\n2 3 4\n" },
  { .file = "cut_components.tri",
    .phrase = "component",
    .text = "4 4\n" T1 "1 3 2\n1 2 4\n1 4 3\n2 3 4\n1\n1\n" },
  { .file = "letters.tri", .phrase = "'four'", .text = "four 4\n" T1 },
  { .file = "range.obj",
    .phrase = "vertex 9",
    .text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n" },
  { .file = "negative_range.obj",
    .phrase = "out of range",
    .text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n" },
  { .file = "two_corners.obj",
    .phrase = "three or more corners",
    .text = "v 0 0 0\nv 1 0 0\nf 1 2\n" },
  { .file = "short_vertex.obj",
    .phrase = "three finite coordinates",
    .text = "v 0 0\nv 1 0 0\nf 1 2 2\n" },
  { .file = "long_token.obj",
    .phrase = "three finite coordinates",
    .make = make_long_token },
  { .file = "version.mesh",
    .phrase = "MeshVersionFormatted",
    .text = "MeshVersionFormatted 9\nDimension 3\n" },
  { .file = "plane.mesh",
    .phrase = "dimension 2",
    .text = "MeshVersionFormatted 2\nDimension 2\nEnd\n" },
  { .file = "range.mesh",
    .phrase = "out of range",
    .text = MEDIT "Vertices 3 0 0 0 0 1 0 0 0 0 1 0 0\n"
                  "Triangles 1 1 2 33 1\nEnd\n" },
  { .file = "huge.mesh",
    .phrase = "truncated",
    .text = MEDIT "Vertices 4000000000 0 0 0 0\nEnd\n" },
  { .file = "no_end.mesh",
    .phrase = "'End'",
    .text = MEDIT "Vertices 3 0 0 0 0 1 0 0 0 0 1 0 0\n"
                  "Triangles 1 1 2 3 1\n" },
  { .file = "huge.msh",
    .phrase = "truncated:",
    .text = GMSH "$Nodes\n1 4000000000 1 1\n2 1 0 4000000000\n" },
  { .file = "range.msh",
    .phrase = "node 77",
    .text = GMSH "$Nodes\n1 1 1 1\n2 1 0 1\n1\n0 0 0\n$EndNodes\n"
                 "$Elements\n1 1 1 1\n2 1 2 1\n1 1 1 77\n$EndElements\n" },
  { .file = "curved.msh",
    .phrase = "setorder 1",
    .text = GMSH "$Nodes\n1 1 1 1\n2 1 0 1\n1\n0 0 0\n$EndNodes\n"
                 "$Elements\n1 1 1 1\n2 1 9 1\n1 1 1 1 1 1 1\n$EndElements\n" },
  { .file = "old.msh", .phrase = "msh41", .text = "$NOD\n3\n1 0 0 0\n" },
  { .file = "text.cgns",
    .phrase = "neither HDF5 nor ADF",
    .text = "CGNS, says the name\n" },
  { .file = "adf.cgns",
    .phrase = "adf2hdf",
    .text = "@(#)ADF Database Version B02012>\n" },
  { .file = "is_fluent.msh", .phrase = "Fluent", .text = "(0 \"grid\")\n" },
  { .file = "huge.ugrid",
    .phrase = "truncated:",
    .text = "4000000000 4000000000 0 4000000000 0 0 0\n" T1 },
  { .file = "negative.ugrid",
    .phrase = "negative",
    .text = "4 -4 0 1 0 0 0\n" T1 },
  { .file = "range.ugrid",
    .phrase = "7",
    .text = "4 4 0 1 0 0 0\n" T1 "1 2 3\n1 4 7\n1 3 4\n2 4 3\n1 1 1 1\n"
            "1 2 3 4\n" },
  { .file = "nan.ugrid",
    .phrase = "nan",
    .text = "4 4 0 1 0 0 0\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n1 2 3\n1 4 2\n"
            "1 3 4\n2 4 3\n1 1 1 1\n1 2 3 4\n" },
  { .file = "truncated.ugrid",
    .phrase = "truncated:",
    .text = "4 4 0 1 0 0 0\n" T1 "1 2 3\n1 4 2\n" },
  { .file = "bad_mapbc.tri",
    .phrase = "bad_mapbc.mapbc",
    .make = make_bad_mapbc },
  { .file = "cut_mapbc.tri",
    .phrase = "cut_mapbc.mapbc",
    .make = make_cut_mapbc },
  { .file = "no_bc.tri",
    .phrase = "no boundary condition",
    .make = make_no_bc },
  { .file = "truncated.front",
    .phrase = "truncated:",
    .text = "npoit nelet npoif nface nboun nfacs nbouc nfaci npoiv nelev "
            "nbou0\n 4 0 4 4 4 4 4 4 0 0 4\n 1 1 2 3\n 2 1 4 2\n" },
  { .file = "huge.front",
    .phrase = "truncated:",
    .text = "npoit nelet npoif nface nboun nfacs nbouc nfaci npoiv nelev "
            "nbou0\n 2000000000 0 2000000000 2000000000 2000000000 "
            "2000000000 4 4 0 0 4\n 1 1 2 3\n" },
  { 0 }
};
