/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cad/wire.h: the protocol between io/cad and io/occt over the socket, in
 * the byte order of the machine. */
#ifndef VG_IO_CAD_WIRE_H
#define VG_IO_CAD_WIRE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A question. READ is followed by n bytes of a file, AGAIN by nothing, the
 * others by n numbers (uint32_t) and n points. */
enum {
  VG_CAD_ASK_READ,
  VG_CAD_ASK_FACES,
  VG_CAD_ASK_CURVES,
  VG_CAD_ASK_TRIANGLES,
  VG_CAD_ASK_AGAIN
};
struct vg_cad_ask {
  uint32_t what, kind;
  int32_t unit, patches;
  uint64_t n;
  double tolerance, chord, angle, least;
  int32_t leave_apart; /* how solids that touch are treated, see below */
  int32_t with_volume; /* 1: determine is_solid, volume and areas */
  int32_t solids;      /* enum vg_cad_solids */
  int32_t section;     /* 1: READ answers with the curves of a section, see
                          struct vg_cad_options */
};

/* Treatment of solids that touch or overlap. WHOLE: unite the complete solids;
 * where that fails, drop the walls that they share as a whole first, as WALLS
 * does. APART: only drop these walls. KEEP_WALLS: change nothing. */
enum {
  VG_CAD_UNITE_WHOLE,
  VG_CAD_UNITE_WALLS,
  VG_CAD_LEAVE_APART,
  VG_CAD_KEEP_WALLS
};

/* Names of the stages that unite complete solids, and solids without some
 * walls. */
#define VG_CAD_STAGE_UNITE_WHOLE "uniting its complete solids"
#define VG_CAD_STAGE_UNITE "uniting its solids"

/* Answers: any number of notes and stages (n characters), followed by a failure
 * (n characters; code: a vg_status), a surface (n: 1, with its counts and
 * arrays), or points (n, and n distances). */
enum {
  VG_CAD_TELL_NOTE,
  VG_CAD_TELL_STAGE,
  VG_CAD_TELL_FAIL,
  VG_CAD_TELL_SURFACE,
  VG_CAD_TELL_POINTS
};
struct vg_cad_tell {
  int32_t what, code;
  uint64_t n;
};

/* Sent before the arrays, which follow in this order: points [][3], triangles
 * [][3], faces of triangles, patches of triangles, segments [][2], curves of
 * segments, patches, zones. */
struct vg_cad_counts {
  uint64_t n_point, n_tri, n_segment, n_patch;
  int64_t is_solid;
  double volume;
  int64_t unit; /* of the result; 0: not known */
  int64_t n_solid;
  uint64_t n_zone; /* zones, which follow the patches */
};

struct vg_cad_patch {
  double area; /* of its exact faces; NAN unless with_volume */
  int32_t id, is_interface;
  char name[80]; /* zero-terminated */
};

struct vg_cad_place { /* a zone */
  double seed[3];
  char name[80]; /* zero-terminated */
};

/* Entry point of the adapter, found by its name in the adapter's library. It
 * answers questions until the socket is shut, and does not return. put and get:
 * vg_child_put, vg_child_get. */
struct vg_cad_wire {
  int (*put)(int fd, const void *data, size_t size);
  int (*get)(int fd, void *data, size_t size);
};
#define VG_OCCT_ENTRY "vg_occt_serve"
typedef void vg_occt_entry(int fd, const struct vg_cad_wire *wire);

#ifdef __cplusplus
}
#endif

#endif
