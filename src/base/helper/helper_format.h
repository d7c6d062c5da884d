/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/helper/helper_format.h: the messages between this program and its helper
 * programs (docs/reference/helpers.md). A helper reads requests from its
 * standard input and writes replies to its standard output, both in the byte
 * order of the machine. It contains no code, so that helpers under any licence
 * may include it. */
#ifndef VG_BASE_HELPER_FORMAT_H
#define VG_BASE_HELPER_FORMAT_H

#include <stdint.h>

/** Version of the format. Helpers with another version are refused. */
#define VG_HELPER_FORMAT 3

#define VG_HELPER_MAGIC "VGHELPER"
#define VG_HELPER_ORDER 0x01020304u

/** The first message of a helper. Texts are zero-terminated. */
struct vg_helper_hello {
  char magic[8];         /* VG_HELPER_MAGIC without the zero */
  uint32_t order;        /* VG_HELPER_ORDER, which shows the byte order */
  uint32_t format;       /* VG_HELPER_FORMAT */
  char name[32];         /* of the program: vanguard-tetgen, vanguard-wrap */
  char library[48];      /* name and version of the library that it contains */
  char source[64 + 1];   /* digest of the sources of the helper */
  char reserved[64 - 1]; /* zero */
};

/** Requests and replies. `what` determines the meaning of the other members and
 * the arrays that follow. Points are [n][3] double, triangles [n][3] and
 * tetrahedra [n][4] uint32_t indices from 0. */
struct vg_helper_message {
  uint32_t what, option;
  uint64_t n[3];
  double value[2];
};

enum {
  /* To vanguard-tetgen. */
  VG_HELPER_RECOVER = 1, /* option: 0 or 1, the first set of switches to try;
                            n[0] points, n[1] triangles */
  VG_HELPER_FILL = 2,    /* value[0]: limit of processor time in seconds; n[0]
                            points, n[1] triangles, n[2] holes; points,
                            triangles, one point in each hole */
  VG_HELPER_LENGTHS = 3, /* answer to VG_HELPER_SIZES: n[0] double */

  /* To vanguard-wrap: n[0] points and n[1] triangles of a surface. */
  VG_HELPER_WRAP = 10,      /* value: size, offset; n[2]: largest number of
                               points of the wrap */
  VG_HELPER_NEAREST = 11,   /* n[2] points */
  VG_HELPER_OUTSIDE = 12,   /* n[2] points */
  VG_HELPER_CROSSINGS = 13, /* n[2] segments: their first points, then their
                               last points */
  VG_HELPER_UNITE = 14,     /* closed shells without common points; option 1:
                               subtract all others from the first; answered by
                               VG_HELPER_SURFACE, then VG_HELPER_COUNTS: the
                               input triangle of each triangle */
  VG_HELPER_IMPRINT = 15,   /* option: the first triangles, which are walls;
                               divide surfaces without common points along the
                               curves on which they meet; answered like
                               VG_HELPER_UNITE, triangles of walls first */

  /* Replies. */
  VG_HELPER_CELLS = 20,    /* n[0] added points, n[1] tetrahedra */
  VG_HELPER_SIZES = 21,    /* requests target edge lengths at n[0] points */
  VG_HELPER_NONE = 22,     /* the void could not be filled, or its triangles
                              could not be recovered */
  VG_HELPER_SURFACE = 23,  /* n[0] points, n[1] triangles */
  VG_HELPER_FEET = 24,     /* n[0] nearest points, and their n[0] triangles
                              (uint32_t) */
  VG_HELPER_COUNTS = 25,   /* n[0] uint32_t: crossings, or 1: outside */
  VG_HELPER_PROGRESS = 26, /* n[0] points made so far */
  VG_HELPER_FAILED = 27    /* option: one of the causes below; n[0] characters
                              of an explanation */
};

/** Causes of VG_HELPER_FAILED. */
enum {
  VG_HELPER_NO_MEMORY = 1,
  VG_HELPER_TOO_MANY = 2,   /* more points than allowed */
  VG_HELPER_DEGENERATE = 3, /* all triangles are degenerate */
  VG_HELPER_ERROR = 4,      /* the library reported an error */
  VG_HELPER_CRASHED = 5,    /* the library crashed */
  VG_HELPER_TIME = 6        /* limit of processor time */
};

#endif
