/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Each kind of defect on constructed surfaces, the repair, the nesting of
 * shells, and the published figures of real data. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "grow.h"

#include "core/geometry/triangles.h"
#include "core/surface/surface_check.h"
#include "core/surface/surface_parts.h"

/* --- surfaces ------------------------------------------------------------ */

static uint32_t add_point(struct vg_mesh *m, double x, double y, double z)
{
  GROW(m->point, m->n_point);
  m->point[m->n_point][0] = x;
  m->point[m->n_point][1] = y;
  m->point[m->n_point][2] = z;
  return (uint32_t)m->n_point++;
}

static void add_tri(struct vg_mesh *m, uint32_t a, uint32_t b, uint32_t c,
                    uint32_t patch)
{
  GROW(m->tri, m->n_tri);
  GROW(m->tri_patch, m->n_tri);
  m->tri[m->n_tri][0] = a;
  m->tri[m->n_tri][1] = b;
  m->tri[m->n_tri][2] = c;
  m->tri_patch[m->n_tri++] = patch;
}

/* Node k of a box has the upper end in x, y, z for bits 0, 1, 2 of k. */
static const uint32_t side[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
                                     { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
                                     { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };

/* Twelve triangles of a new patch, normals outward, or inward. */
static void add_box(struct vg_mesh *m, double lo, double hi, int outward)
{
  uint32_t first = (uint32_t)m->n_point;
  uint32_t patch = (uint32_t)vg_mesh_add_patch(m, (int32_t)m->n_patch + 1,
                                               "box");

  for (int k = 0; k < 8; k++)
    add_point(m, k & 1 ? hi : lo, k & 2 ? hi : lo, k & 4 ? hi : lo);
  for (int s = 0; s < 6; s++)
    for (int half = 0; half < 2; half++) {
      uint32_t b = first + side[s][1 + half], c = first + side[s][2 + half];

      add_tri(m, first + side[s][0], outward ? b : c, outward ? c : b, patch);
    }
}

static void move_from(struct vg_mesh *m, size_t first, double x, double y,
                      double z)
{
  for (size_t i = first; i < m->n_point; i++) {
    m->point[i][0] += x;
    m->point[i][1] += y;
    m->point[i][2] += z;
  }
}

/* Kind, location and remedy of every finding, and a patch if it has a face. */
static void check_texts(const struct vg_mesh *m,
                        const struct vg_surface_report *r)
{
  char text[512], start[64];

  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];
    const char *at;

    vg_defect_text(m, d, text, sizeof text);
    snprintf(start, sizeof start, "%s: %s", vg_defect_name(d->kind),
             d->face[0] == SIZE_MAX ? "point " : "patch ");
    assert_memory_equal(text, start, strlen(start));
    at = strstr(text, " at (");
    assert_non_null(at);
    assert_true(strlen(strchr(at, ':')) > 20);
  }
}

static void check(struct vg_mesh *m, int repair, int external,
                  struct vg_surface_report *r)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t sum = 0;

  o.repair = repair;
  o.external = external;
  if (vg_surface_check(m, &o, r, &err) != VG_OK) fail_msg("%s", err.text);
  for (int k = 0; k < VG_DEFECT_N; k++) sum += r->count[k];
  if (r->count[VG_DEFECT_INTERSECTION] <= VG_SURFACE_PAIR_MAX)
    assert_int_equal(sum, r->n_defect);
  for (size_t i = 1; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];

    assert_true(d[-1].kind < d->kind ||
                (d[-1].kind == d->kind && d[-1].face[0] <= d->face[0]));
  }
  check_texts(m, r);
}

/* Only findings of one kind, n of them. */
static void assert_only(const struct vg_surface_report *r,
                        enum vg_defect_kind kind, size_t n)
{
  for (int k = 0; k < VG_DEFECT_N; k++)
    assert_int_equal(r->count[k], k == (int)kind ? n : 0);
}

static void assert_none(const struct vg_surface_report *r)
{
  assert_int_equal(r->n_defect, 0);
  assert_only(r, VG_DEFECT_OPEN_EDGE, 0);
}

static void done(struct vg_mesh *m, struct vg_surface_report *r)
{
  vg_mesh_release(m);
  vg_surface_report_release(r);
}

#define NEW                                                                    \
  struct vg_mesh m = VG_MESH_INIT;                                             \
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;                         \
  (void)unused

/* --- edges and orientation ----------------------------------------------- */

static void accepts_a_box(void **unused)
{
  NEW;

  add_box(&m, 0, 2, 1);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_true(r.is_closed);
  assert_int_equal(r.n_flipped, 0);
  assert_int_equal(r.shells_reoriented, 0);
  assert_int_equal(r.n_removed_point + r.n_removed_tri, 0);
  assert_int_equal(r.n_shell, 1);
  assert_int_equal(r.n_piece, 1);
  assert_int_equal(r.shell[0].n_tri, 12);
  assert_true(r.shell[0].is_closed);
  assert_true(r.shell[0].volume == 8); /* whole numbers: no rounding */
  assert_true(r.shell[0].lo[2] == 0 && r.shell[0].hi[2] == 2);
  assert_true(r.shell[0].parent == SIZE_MAX && r.shell[0].depth == 0);
  for (size_t t = 0; t < m.n_tri; t++) {
    assert_int_equal(r.face_kinds[t], 0);
    assert_int_equal(r.tri_shell[t], 0);
  }
  done(&m, &r);
}

/* A node with many faces. */
static void accepts_a_double_cone(void **unused)
{
  const uint32_t n = 100;
  NEW;

  vg_mesh_add_patch(&m, 1, "");
  add_point(&m, 0, 0, -1);
  add_point(&m, 0, 0, 1);
  for (uint32_t i = 0; i < n; i++) {
    double u = 2 * 3.14159265358979 * i / n;

    add_point(&m, cos(u), sin(u), 0);
  }
  for (uint32_t i = 0; i < n; i++) {
    add_tri(&m, 0, 2 + (i + 1) % n, 2 + i, 0);
    add_tri(&m, 1, 2 + (i + i % 2) % n, 2 + (i + 1 - i % 2) % n, 0);
  }
  check(&m, 0, 1, &r);
  assert_true(r.is_closed);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, n / 2);
  /* Polygon of n corners, base of two cones of height 1. */
  assert_true(fabs(r.shell[0].volume - n * sin(2 * 3.14159265358979 / n) / 3) <
              1e-12);
  done(&m, &r);
}

static void accepts_an_empty_mesh(void **unused)
{
  NEW;

  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_false(r.is_closed);
  done(&m, &r);
}

static void reports_the_edges_of_a_hole(void **unused)
{
  char text[400];
  NEW;

  add_box(&m, 0, 1, 1);
  m.n_tri--; /* 4 7 6: nodes 5 7 8 of the file, plus one */
  check(&m, 1, 1, &r);
  assert_only(&r, VG_DEFECT_OPEN_EDGE, 3);
  assert_false(r.is_closed);
  assert_false(r.shell[0].is_closed);
  for (int i = 0; i < 3; i++) {
    size_t f = r.defect[i].face[0];

    assert_true(r.defect[i].face[1] == SIZE_MAX);
    assert_int_equal(r.face_kinds[f], 1u << VG_DEFECT_OPEN_EDGE);
    assert_true(r.defect[i].at[2] == 1);
  }
  vg_defect_text(&m, &r.defect[2], text, sizeof text);
  assert_string_equal(
    text,
    "open edge: patch 1 (box), face 11; points 8 and 5 at (0.5, 0.5, 1): "
    "only one face has this edge; close the gap, or weld the points with a "
    "tolerance");
  done(&m, &r);
}

static void reports_three_faces_at_an_edge(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 1);
  add_tri(&m, 0, 1, add_point(&m, .5, -1, -1), 0);
  check(&m, 0, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], 1);
  assert_int_equal(r.count[VG_DEFECT_OPEN_EDGE], 2);
  assert_int_equal(r.count[VG_DEFECT_ORIENTATION], 0);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0); /* reported once */
  assert_false(r.is_closed);
  assert_true(r.face_kinds[12] >> VG_DEFECT_NONMANIFOLD_EDGE & 1);
  assert_true(r.face_kinds[4] >> VG_DEFECT_NONMANIFOLD_EDGE & 1);
  done(&m, &r);
}

static void turns_a_face_back(void **unused)
{
  struct vg_mesh before = VG_MESH_INIT;
  uint32_t n;
  NEW;

  add_box(&m, 0, 1, 1);
  assert_int_equal(vg_mesh_copy(&before, &m, NULL), VG_OK);
  n = m.tri[0][1], m.tri[0][1] = m.tri[0][2], m.tri[0][2] = n;
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_ORIENTATION, 3);
  assert_true(r.is_closed);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 1);
  assert_int_equal(r.shells_reoriented, 0);
  assert_memory_equal(m.tri, before.tri, 12 * sizeof *m.tri);
  vg_mesh_release(&before);
  done(&m, &r);
}

static void turns_a_surface_inside_out(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 0);
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_SHELL, 1);
  assert_true(r.shell[0].volume == -1);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 12);
  assert_true(r.shells_reoriented && r.shell[0].volume == 1);
  check(&m, 1, 0, &r); /* the same box as a room */
  assert_none(&r);
  assert_true(r.shells_reoriented && r.shell[0].volume == -1);
  done(&m, &r);
}

static void leaves_a_moebius_strip(void **unused)
{
  uint32_t a[6], b[6], before[12][3];
  NEW;

  vg_mesh_add_patch(&m, 1, "strip");
  for (int i = 0; i < 6; i++) { /* half a turn over six steps */
    double u = 3.14159265358979 * i / 3, c = cos(u), s = sin(u);
    double p = cos(u / 2), q = sin(u / 2);

    a[i] = add_point(&m, (3 - p) * c, (3 - p) * s, -q);
    b[i] = add_point(&m, (3 + p) * c, (3 + p) * s, q);
  }
  for (int i = 0; i < 6; i++) {
    uint32_t c = i < 5 ? a[i + 1] : b[0], d = i < 5 ? b[i + 1] : a[0];

    add_tri(&m, a[i], b[i], d, 0);
    add_tri(&m, a[i], d, c, 0);
  }
  memcpy(before, m.tri, sizeof before);
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_OPEN_EDGE], 12);
  assert_int_equal(r.count[VG_DEFECT_ORIENTATION], 1);
  assert_int_equal(r.n_flipped, 0);
  assert_memory_equal(m.tri, before, sizeof before);
  done(&m, &r);
}

/* --- points and triangles ------------------------------------------------ */

static void welds_a_soup(void **unused)
{
  struct vg_mesh box = VG_MESH_INIT;
  NEW;

  add_box(&box, 0, 1, 1);
  vg_mesh_add_patch(&m, 1, "soup");
  for (size_t t = 0; t < 12; t++) {
    for (int k = 0; k < 3; k++) {
      const double *p = box.point[box.tri[t][k]];

      /* 0 and -0 are one coordinate */
      add_point(&m, p[0], t & 1 && p[1] == 0 ? -0.0 : p[1], p[2]);
    }
    add_tri(&m, (uint32_t)(3 * t), (uint32_t)(3 * t + 1), (uint32_t)(3 * t + 2),
            0);
  }
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_DUPLICATE_POINT, 28);
  assert_true(r.is_closed); /* checked as if welded */
  assert_int_equal(m.n_point, 36);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_removed_point, 28);
  assert_int_equal(m.n_point, 8);
  assert_int_equal(m.n_tri, 12);
  vg_mesh_release(&box);
  done(&m, &r);
}

static void drops_unused_points(void **unused)
{
  static const uint32_t tet[4] = { 0, 1, 2, 9 };
  NEW;

  add_box(&m, 0, 1, 1);
  add_point(&m, 5, 5, 5);
  add_point(&m, .5, .5, .5);
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_UNUSED_POINT, 2);
  assert_true(r.defect[0].point[0] == 8 && r.defect[0].at[0] == 5);
  m.tet = malloc(sizeof *m.tet);
  memcpy(m.tet[0], tet, sizeof tet);
  m.n_tet = 1;
  check(&m, 1, 1, &r); /* the second is a node of the cell */
  assert_none(&r);
  assert_int_equal(r.n_removed_point, 1);
  assert_int_equal(m.n_point, 9);
  assert_int_equal(m.tet[0][3], 8);
  assert_true(m.point[8][0] == .5);
  done(&m, &r);
}

static void knows_degenerate_triangles(void **unused)
{
  uint32_t p;
  NEW;

  add_box(&m, 0, 1, 1);
  add_tri(&m, 3, 3, 5, 0);
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_DEGENERATE_TRIANGLE, 1);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_removed_tri, 1);
  /* A point exactly on an edge, the gap filled by a flat triangle. */
  p = add_point(&m, .5, 0, 0);
  for (size_t t = 0; t < 12; t++) {
    uint32_t *n = m.tri[t];

    for (int k = 0; k < 3; k++)
      if (n[k] == 0 && n[(k + 1) % 3] == 1) {
        uint32_t c = n[(k + 2) % 3];

        n[(k + 1) % 3] = p;
        add_tri(&m, p, 1, c, 0);
        add_tri(&m, 0, 1, p, 0);
        t = 12;
        break;
      }
  }
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_DEGENERATE_TRIANGLE], 1);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 2); /* along the edge */
  assert_int_equal(r.n_defect, 3);
  assert_true(r.is_closed);
  m.point[p][1] = 0x1p-60; /* not quite on it */
  m.point[p][2] = -0x1p-60;
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_DEGENERATE_TRIANGLE], 0);
  done(&m, &r);
}

static void drops_copies_of_a_triangle(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 1);
  add_tri(&m, m.tri[5][1], m.tri[5][2], m.tri[5][0], 0);
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_DUPLICATE_TRIANGLE, 1);
  assert_true(r.is_closed && r.n_shell == 1);
  assert_int_equal(r.defect[0].face[0], 5);
  assert_int_equal(r.defect[0].face[1], 12);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_removed_tri, 1);
  add_tri(&m, m.tri[5][1], m.tri[5][0], m.tri[5][2], 0); /* reversed */
  vg_mesh_add_patch(&m, 7, "paint");
  add_tri(&m, m.tri[0][0], m.tri[0][1], m.tri[0][2], 1); /* other patch */
  add_tri(&m, m.tri[0][0], m.tri[0][1], m.tri[0][2], 1); /* a third one */
  check(&m, 0, 1, &r);
  assert_only(&r, VG_DEFECT_DUPLICATE_TRIANGLE, 3);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_removed_tri, 3);
  assert_int_equal(m.n_tri, 12);
  assert_int_equal(m.tri_patch[0], 0); /* the first stays */
  done(&m, &r);
}

/* A complete duplicate of a body, inside out. */
static void drops_a_duplicate_skin(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 1);
  add_box(&m, 0, 1, 0);
  check(&m, 0, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_DUPLICATE_TRIANGLE], 12);
  assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], 0);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_removed_tri, 12);
  assert_true(r.n_shell == 1 && r.shell[0].volume == 1);
  done(&m, &r);
}

/* Two boxes with a common side, for either orientation of the second one. */
static void unites_bodies_that_share_a_wall(void **unused)
{
  (void)unused;
  for (int outward = 0; outward < 2; outward++) {
    NEW;

    add_box(&m, 0, 1, 1);
    add_box(&m, 0, 1, outward);
    move_from(&m, 8, 1, 0, 0);
    /* The diagonals of the sides x = 0 and 1 of a box differ. */
    for (int half = 0; half < 2; half++)
      for (int k = 0; k < 3; k++)
        m.tri[12 + half][k] = m.tri[2 + half][k] + 8 - 1;
    for (int half = 0; outward && half < 2; half++) {
      uint32_t n = m.tri[12 + half][1];

      m.tri[12 + half][1] = m.tri[12 + half][2];
      m.tri[12 + half][2] = n;
    }
    check(&m, 0, 1, &r);
    assert_int_equal(r.count[VG_DEFECT_SHARED_WALL], 2);
    assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], 0);
    assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0);
    check(&m, 1, 1, &r);
    assert_none(&r);
    assert_int_equal(r.n_removed_wall, 4);
    assert_int_equal(r.n_removed_tri, 0);
    assert_int_equal(m.n_tri, 20);
    assert_true(r.n_shell == 1 && r.shell[0].volume == 2);
    done(&m, &r);
  }
}

/* A unit box from x, y, z on, with diagonals from the lowest to the highest
 * corner of each side, so that those of neighbours are the same. */
static void add_cell(struct vg_mesh *m, int x, int y, int z, int outward)
{
  static const uint32_t quad[6][4] = { /* lowest, .., highest, .. */
                                       { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
                                       { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
                                       { 0, 2, 3, 1 }, { 4, 5, 7, 6 }
  };
  uint32_t first = (uint32_t)m->n_point;
  uint32_t patch = (uint32_t)vg_mesh_add_patch(m, (int32_t)m->n_patch + 1, "");

  for (int k = 0; k < 8; k++)
    add_point(m, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2 & 1));
  for (int s = 0; s < 6; s++)
    for (int half = 0; half < 2; half++) {
      uint32_t b = first + quad[s][1 + half], c = first + quad[s][2 + half];

      add_tri(m, first + quad[s][0], outward ? b : c, outward ? c : b, patch);
    }
}

/* 27 boxes, some of them inside out: walls meet in edges, and a body may be
 * surrounded by walls. If one box is left out, the others have a hole in a
 * corner, in an edge, in a side, or a cavity. */
static void unites_many_bodies(void **unused)
{
  (void)unused;
  for (int left_out = -1; left_out < 27; left_out++) {
    int n_side = 0; /* sides on the hull of the box that is left out */
    NEW;

    for (int i = 0; i < 27; i++)
      if (i != left_out) add_cell(&m, i % 3, i / 3 % 3, i / 9, i % 5 != 2);
    for (int k = 0, i = left_out; i >= 0 && k < 3; k++, i /= 3)
      n_side += i % 3 != 1;
    check(&m, 1, 1, &r);
    assert_none(&r);
    assert_int_equal(m.n_tri,
                     left_out < 0 ? 108 : 108 - 2 * n_side + 2 * (6 - n_side));
    assert_int_equal(r.n_removed_wall,
                     left_out < 0 ? 216 : 216 - 4 * (6 - n_side));
    assert_int_equal(r.n_shell, left_out >= 0 && !n_side ? 2 : 1);
    assert_true(r.shell[0].volume == (left_out >= 0 && n_side ? 26 : 27));
    done(&m, &r);
  }
}

/* A wall of two coincident sides attached to a body: the check does not guess
 * its thickness. */
static void leaves_a_wall_without_thickness(void **unused)
{
  uint32_t p;
  NEW;

  add_box(&m, 0, 1, 1);
  p = add_point(&m, .5, .5, 2);
  add_tri(&m, 4, 5, p, 0);
  add_tri(&m, 5, 4, p, 0);
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_DUPLICATE_TRIANGLE], 1);
  assert_int_equal(r.count[VG_DEFECT_NONMANIFOLD_EDGE], 1);
  assert_int_equal(r.n_defect, 2);
  assert_int_equal(m.n_tri, 14);
  done(&m, &r);
}

/* A box on another one, of which a side is missing: without the wall they would
 * have a hole. */
static void keeps_a_shared_wall_at_a_hole(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 1);
  add_box(&m, 0, 1, 1);
  move_from(&m, 8, 1, 0, 0);
  for (int half = 0; half < 2; half++) {
    m.tri[12 + half][0] = m.tri[2 + half][0] + 7;
    m.tri[12 + half][1] = m.tri[2 + half][2] + 7;
    m.tri[12 + half][2] = m.tri[2 + half][1] + 7;
  }
  m.n_tri -= 2; /* z = 1 of the second box */
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_SHARED_WALL], 2);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0);
  assert_true(r.count[VG_DEFECT_OPEN_EDGE] && !r.n_removed_wall);
  done(&m, &r);
}

static void reports_coordinates_that_are_not_finite(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 1);
  m.point[3][1] = NAN;
  m.point[6][0] = INFINITY;
  check(&m, 1, 1, &r);
  assert_only(&r, VG_DEFECT_NOT_FINITE, 2);
  assert_int_equal(r.defect[0].point[0] + r.defect[1].point[0], 9);
  done(&m, &r);
}

static void reports_quadrilaterals(void **unused)
{
  NEW;

  add_box(&m, 0, 1, 0);
  m.n_tri = 0;
  m.quad = malloc(6 * sizeof *m.quad);
  m.quad_patch = calloc(6, sizeof *m.quad_patch);
  m.n_quad = 6;
  for (int s = 0; s < 6; s++) memcpy(m.quad[s], side[s], sizeof side[s]);
  check(&m, 1, 0, &r); /* reversed: outward normals, fluid inside */
  assert_only(&r, VG_DEFECT_QUAD, 6);
  assert_true(r.is_closed && r.shell[0].volume == -1);
  assert_int_equal(r.n_flipped, 6);
  assert_int_equal(m.quad[0][1], side[0][3]);
  assert_int_equal(m.quad[0][3], side[0][1]);
  done(&m, &r);
}

static void asks_for_boundary_conditions(void **unused)
{
  struct vg_surface_check_options o = {
    .repair = 1, .require_bc = 1, .external = 1, .threads = 1
  };
  NEW;

  add_box(&m, 0, 1, 1);
  add_box(&m, 2, 3, 1);
  add_box(&m, 4, 5, 1);
  vg_mesh_add_patch(&m, 9, "without faces");
  m.patch[0].bc = 4;
  m.patch[2].bc_fun3d = 4000;
  assert_int_equal(vg_surface_check(&m, &o, &r, NULL), VG_OK);
  assert_only(&r, VG_DEFECT_NO_BC, 1);
  assert_int_equal(r.defect[0].face[0], 12);
  done(&m, &r);
}

static void refuses_an_index_out_of_range(void **unused)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  NEW;

  add_box(&m, 0, 1, 1);
  m.tri[6][2] = 8;
  assert_int_equal(vg_surface_check(&m, &o, &r, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "triangle 7"));
  assert_int_equal(vg_surface_weld(&m, 0, NULL, NULL, &err), VG_ERR_INPUT);
  m.tri[6][2] = 7;
  m.tri_patch[3] = 1;
  assert_int_equal(vg_surface_check(&m, &o, &r, &err), VG_ERR_INPUT);
  assert_null(r.shell);
  done(&m, &r);
}

/* --- intersections ------------------------------------------------------- */

/* Reference: two triangles of whole numbers are disjoint exactly if one of
 * these directions separates them strictly. */
typedef int64_t vec[3];

static void cross(const int64_t *a, const int64_t *b, int64_t *c)
{
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;

    c[k] = a[i] * b[j] - a[j] * b[i];
  }
}

static int separates(const int64_t *n, const vec *p, int np, const vec *q,
                     int nq)
{
  int64_t lo[2] = { INT64_MAX, INT64_MAX }, hi[2] = { INT64_MIN, INT64_MIN };

  for (int i = 0; i < np + nq; i++) {
    const int64_t *x = i < np ? p[i] : q[i - np];
    int64_t d = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
    int s = i >= np;

    if (d < lo[s]) lo[s] = d;
    if (d > hi[s]) hi[s] = d;
  }
  return hi[0] < lo[1] || hi[1] < lo[0];
}

/* p: triangle or segment, q: triangle. */
static int reference_meet(const vec *p, int np, const vec *q)
{
  vec e[2][3], n[2], x;
  int ne = np == 3 ? 3 : 1;

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      e[0][i][k] = i < ne ? p[(i + 1) % np][k] - p[i][k] : 0;
      e[1][i][k] = q[(i + 1) % 3][k] - q[i][k];
    }
  cross(e[0][0], e[0][1], n[0]);
  cross(e[1][0], e[1][1], n[1]);
  if (separates(n[0], p, np, q, 3) || separates(n[1], p, np, q, 3)) return 0;
  for (int i = 0; i < ne; i++)
    for (int j = 0; j < 3; j++) {
      cross(e[0][i], e[1][j], x);
      if (separates(x, p, np, q, 3)) return 0;
    }
  for (int i = 0; i < 3; i++) { /* needed, and valid, in a common plane */
    cross(n[1], e[0][i], x);
    if (separates(x, p, np, q, 3)) return 0;
    cross(n[1], e[1][i], x);
    if (separates(x, p, np, q, 3)) return 0;
  }
  return 1;
}

static int reference_folded(const vec *p, const vec *q)
{
  vec u, v, w, n[2], x;

  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
    w[k] = q[2][k] - p[0][k];
  }
  cross(u, v, n[0]);
  cross(u, w, n[1]);
  cross(n[0], n[1], x);
  return !x[0] && !x[1] && !x[2] &&
         n[0][0] * n[1][0] + n[0][1] * n[1][1] + n[0][2] * n[1][2] > 0;
}

static int reference(const vec *p, const vec *q, int shared)
{
  if (shared == 0) return reference_meet(p, 3, q);
  if (shared == 2) return reference_folded(p, q);
  return reference_meet(p + 1, 2, q) || reference_meet(q + 1, 2, p);
}

static uint32_t draw(uint64_t *s, uint32_t n)
{
  *s = *s * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((*s >> 33) % n);
}

static int is_flat(const vec *p)
{
  vec u, v, n;

  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
  }
  cross(u, v, n);
  return !n[0] && !n[1] && !n[2];
}

static int equal(const int64_t *a, const int64_t *b)
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* On a small grid most pairs touch, overlap or are coplanar. Corners are shared
 * by number; any other coincidence of corners is an intersection. */
static void agrees_with_separating_planes(void **unused)
{
  uint64_t s = 1;
  size_t n_meet[3] = { 0, 0, 0 }, n_all[3] = { 0, 0, 0 };

  (void)unused;
  for (int n = 0; n < 300000; n++) {
    int shared = n % 3, coincide = 0, meet;
    uint32_t flat = n / 3 % 4 ? 4 : 1, ids[2][3];
    vec p[3], q[3];
    double point[6][3];

    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        p[i][k] = draw(&s, k == 2 ? flat : 4);
        q[i][k] = draw(&s, k == 2 ? flat : 4);
        if (i < shared) q[i][k] = p[i][k];
      }
    if (is_flat(p) || is_flat(q)) continue;
    for (int i = 0; i < 6; i++) {
      ids[i / 3][i % 3] = (uint32_t)(i >= 3 && i - 3 < shared ? i - 3 : i);
      for (int k = 0; k < 3; k++)
        point[i][k] = (double)(i < 3 ? p[i] : q[i - 3])[k];
    }
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        coincide |= equal(p[i], q[j]) && !(i == j && i < shared);
    meet = vg_triangles_meet((const double(*)[3])point, ids[0], ids[1], ids[0],
                             ids[1]);
    assert_int_equal(vg_triangles_meet((const double(*)[3])point, ids[1],
                                       ids[0], ids[1], ids[0]),
                     meet);
    assert_int_equal(meet, coincide ||
                             reference((const vec *)p, (const vec *)q, shared));
    n_meet[shared] += (size_t)meet;
    n_all[shared]++;
  }
  for (int k = 0; k < 3; k++) /* both answers occur often */
    assert_true(20 * n_meet[k] > n_all[k] && 20 * n_meet[k] < 19 * n_all[k]);
}

static size_t meetings(struct vg_mesh *m)
{
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  size_t n;

  check(m, 0, 1, &r);
  n = r.count[VG_DEFECT_INTERSECTION];
  vg_surface_report_release(&r);
  return n;
}

static void finds_boxes_that_cross(void **unused)
{
  NEW;

  add_box(&m, 0, 2, 1);
  add_box(&m, 1, 3, 1);
  check(&m, 1, 1, &r);
  assert_true(r.count[VG_DEFECT_INTERSECTION] > 0);
  assert_only(&r, VG_DEFECT_INTERSECTION, r.count[VG_DEFECT_INTERSECTION]);
  for (size_t i = 0; i < r.n_defect; i++) {
    assert_true(r.defect[i].face[0] < 12 && r.defect[i].face[1] >= 12);
    for (int k = 0; k < 3; k++)
      assert_true(r.defect[i].at[k] >= 1 && r.defect[i].at[k] <= 2);
  }
  move_from(&m, 8, 1, 0, 0); /* now the sides at x = 2 overlap, flat */
  assert_true(meetings(&m) > 0);
  move_from(&m, 8, 0, 1, 1); /* now one corner touches one corner */
  assert_int_equal(m.n_point, 16);
  assert_true(meetings(&m) > 0);
  move_from(&m, 8, 0x1p-50, 0, 0); /* a gap of one rounding */
  assert_int_equal(meetings(&m), 0);
  done(&m, &r);
}

/* Beyond the limit every face is listed once, and the count stays correct. */
static void counts_more_pairs_than_it_lists(void **unused)
{
  const uint32_t n = 520; /* 520^2 = 270400 pairs */
  NEW;

  vg_mesh_add_patch(&m, 1, "comb");
  for (uint32_t i = 0; i < n; i++) {
    double at = 1 + i;

    add_tri(&m, add_point(&m, at, 0, -1), add_point(&m, at, 2e3, -1),
            add_point(&m, at, 0, 2e3), 0);
  }
  for (uint32_t i = 0; i < n; i++) {
    double at = 1 + i;

    add_tri(&m, add_point(&m, 0, at, -1), add_point(&m, 2e3, at, -1),
            add_point(&m, 0, at, 2e3), 0);
  }
  check(&m, 0, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], n * n);
  assert_int_equal(r.n_defect, r.count[VG_DEFECT_OPEN_EDGE] + 2 * n);
  for (size_t i = r.count[VG_DEFECT_OPEN_EDGE]; i < r.n_defect; i++) {
    size_t f = i - r.count[VG_DEFECT_OPEN_EDGE];

    assert_int_equal(r.defect[i].face[0], f);
    assert_int_equal(r.defect[i].face[1], f < n ? n : 0);
    assert_true(r.face_kinds[f] >> VG_DEFECT_INTERSECTION & 1);
  }
  done(&m, &r);
}

/* --- shells -------------------------------------------------------------- */

static void nests_bodies_in_a_farfield(void **unused)
{
  NEW;

  add_box(&m, 1, 2, 1);
  add_box(&m, -20, 20, 0);
  add_box(&m, 4, 6, 1);
  check(&m, 1, 0, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 0);
  assert_int_equal(r.n_shell, 3);
  assert_true(r.shell[1].parent == SIZE_MAX && r.shell[1].depth == 0);
  assert_true(r.shell[0].parent == 1 && r.shell[2].parent == 1);
  assert_int_equal(r.shell[2].depth, 1);
  assert_true(r.shell[1].volume == -64000 && r.shell[2].volume == 8);
  done(&m, &r);
}

static void reverses_the_outer_boundary(void **unused)
{
  NEW;

  add_box(&m, 1, 2, 0);
  add_box(&m, -20, 20, 0);
  add_box(&m, 4, 6, 1);
  check(&m, 0, 0, &r);
  assert_only(&r, VG_DEFECT_SHELL, 1);
  check(&m, 1, 0, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 12);
  assert_false(r.shells_reoriented);
  assert_true(r.shell[0].volume == 1);
  check(&m, 1, 1, &r); /* solid between the bodies and the big box */
  assert_none(&r);
  assert_true(r.shells_reoriented);
  assert_int_equal(r.n_flipped, 36);
  done(&m, &r);
}

/* Concentric, so that the ray from each corner passes through edges and
 * diagonals of the boxes around it. */
static void sees_through_many_layers(void **unused)
{
  NEW;

  for (int i = 0; i < 9; i++) add_box(&m, -1 - i, 1 + i, i & 1);
  check(&m, 1, 0, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 0);
  for (int i = 0; i < 9; i++) {
    assert_int_equal(r.shell[i].depth, 8 - i);
    assert_true(r.shell[i].parent == (i < 8 ? (size_t)i + 1 : SIZE_MAX));
  }
  done(&m, &r);
}

static void does_not_guess_about_a_stray_body(void **unused)
{
  char text[400];
  NEW;

  add_box(&m, 0, 9, 1);
  add_box(&m, 3, 4, 1);
  check(&m, 1, 1, &r);
  assert_only(&r, VG_DEFECT_SHELL, 1);
  assert_int_equal(r.n_flipped, 0);
  assert_true(r.defect[0].face[0] == 12 && r.defect[0].face[1] == 0);
  assert_true(r.defect[0].at[0] == 3.5);
  vg_defect_text(&m, &r.defect[0], text, sizeof text);
  assert_non_null(strstr(text, "patch 2 (box), face 13; patch 1 (box), face "
                               "1 at (3.5, 3.5, 3.5)"));
  for (size_t t = 12; t < 24; t++) { /* as an intended cavity */
    uint32_t n = m.tri[t][1];

    m.tri[t][1] = m.tri[t][2];
    m.tri[t][2] = n;
  }
  check(&m, 1, 1, &r);
  assert_none(&r);
  done(&m, &r);
}

static void turns_a_hollow_body_as_one(void **unused)
{
  NEW;

  add_box(&m, 20, 29, 1);
  add_box(&m, 0, 9, 0);
  add_box(&m, 3, 4, 1);
  check(&m, 1, 1, &r);
  assert_none(&r);
  assert_int_equal(r.n_flipped, 24);
  assert_true(r.shell[1].volume == 729 && r.shell[2].volume == -1);
  done(&m, &r);
}

static void reports_a_shell_without_volume(void **unused)
{
  NEW;

  vg_mesh_add_patch(&m, 1, "leaf");
  for (int i = 0; i < 2; i++)
    add_point(&m, 0, 0, 0), add_point(&m, 1, 0, 0), add_point(&m, 0, 1, 0);
  add_tri(&m, 0, 1, 2, 0);
  add_tri(&m, 3, 5, 4, 0);
  check(&m, 1, 1, &r);
  assert_int_equal(r.count[VG_DEFECT_SHELL], 1);
  assert_int_equal(r.count[VG_DEFECT_DUPLICATE_TRIANGLE], 1);
  assert_true(r.is_closed);
  done(&m, &r);
}

/* --- weld ---------------------------------------------------------------- */

static void welds_a_chain(void **unused)
{
  size_t merged, dropped;
  NEW;

  vg_mesh_add_patch(&m, 1, "");
  for (int i = 0; i < 12; i++) add_point(&m, .9 * (11 - i), 0, 0);
  add_point(&m, 0, 30, 0);
  add_point(&m, 30, 0, 0);
  add_tri(&m, 0, 11, 12, 0);
  add_tri(&m, 11, 13, 12, 0);
  assert_int_equal(vg_surface_weld(&m, 0, &merged, &dropped, NULL), VG_OK);
  assert_true(!merged && !dropped);
  assert_int_equal(vg_surface_weld(&m, 1, &merged, &dropped, NULL), VG_OK);
  assert_true(merged == 11 && dropped == 1);
  assert_true(m.n_point == 3 && m.n_tri == 1);
  assert_true(m.point[0][0] == .9 * 11); /* the lowest index stays */
  assert_int_equal(m.tri[0][0], 0);
  assert_int_equal(m.tri[0][1], 2);
  assert_int_equal(vg_surface_weld(&m, -1, NULL, NULL, NULL), VG_ERR_INPUT);
  assert_int_equal(vg_surface_weld(&m, NAN, NULL, NULL, NULL), VG_ERR_INPUT);
  assert_int_equal(vg_surface_weld(&m, INFINITY, NULL, NULL, NULL),
                   VG_ERR_INPUT);
  done(&m, &r);
}

/* Lowest point that is reached by a chain of steps within the tolerance. */
static void reference_weld(const struct vg_mesh *m, double tolerance,
                           uint32_t *root)
{
  int changed = 1;

  for (uint32_t i = 0; i < m->n_point; i++) root[i] = i;
  while (changed) {
    changed = 0;
    for (size_t i = 0; i < m->n_point; i++)
      for (size_t j = 0; j < i; j++) {
        double d2 = 0;

        for (int k = 0; k < 3; k++)
          d2 += (m->point[i][k] - m->point[j][k]) *
                (m->point[i][k] - m->point[j][k]);
        if (d2 <= tolerance * tolerance && root[i] != root[j]) {
          uint32_t low = root[i] < root[j] ? root[i] : root[j];

          root[i] = root[j] = low;
          changed = 1;
        }
      }
  }
}

/* Whole coordinates: distances of exactly the tolerance, on both sides of cell
 * walls and of zero, and many equal points. */
static void welds_as_the_definition_says(void **unused)
{
  const double tolerance[] = { 0, 1, 2, 2.5, 4 };
  uint64_t s = 5;
  NEW;

  for (size_t n = 0; n < sizeof tolerance / sizeof *tolerance; n++) {
    uint32_t root[400], next = 0;

    for (int i = 0; i < 400; i++)
      add_point(&m, draw(&s, 24) - 12., draw(&s, 24) - 12., draw(&s, 24) - 12.);
    vg_mesh_add_patch(&m, 1, "");
    for (uint32_t i = 0; i < 400; i++)
      add_tri(&m, i, (i + 1) % 400, (i + 2) % 400, 0);
    struct vg_mesh w = VG_MESH_INIT;
    assert_int_equal(vg_mesh_copy(&w, &m, NULL), VG_OK);
    reference_weld(&m, tolerance[n], root);
    assert_int_equal(vg_surface_weld(&w, tolerance[n], NULL, NULL, NULL),
                     VG_OK);
    for (uint32_t i = 0; i < 400; i++)
      if (root[i] == i)
        assert_memory_equal(w.point[next++], m.point[i], sizeof *m.point);
    assert_int_equal(w.n_point, next);
    for (size_t i = 0, t = 0; i < 400; i++) {
      uint32_t a = root[m.tri[i][0]], b = root[m.tri[i][1]];
      uint32_t c = root[m.tri[i][2]];

      if (a == b || b == c || c == a) continue;
      assert_memory_equal(w.point[w.tri[t][0]], m.point[a], sizeof *m.point);
      assert_memory_equal(w.point[w.tri[t++][2]], m.point[c], sizeof *m.point);
    }
    vg_mesh_release(&w);
    vg_mesh_release(&m);
  }
  done(&m, &r);
}

static void names_every_kind(void **unused)
{
  (void)unused;
  for (int k = 0; k < VG_DEFECT_N; k++) {
    const char *name = vg_defect_name((enum vg_defect_kind)k);

    assert_non_null(name);
    for (int j = 0; j < k; j++)
      assert_string_not_equal(name, vg_defect_name((enum vg_defect_kind)j));
    assert_string_not_equal(name, vg_defect_heading((enum vg_defect_kind)k));
  }
}

/* n random triangles in the unit cube, with edges of about `size`. */
static void add_soup(struct vg_mesh *m, size_t n, double size, uint64_t seed)
{
  uint32_t patch = (uint32_t)vg_mesh_add_patch(m, 1, "soup");

  for (size_t i = 0; i < 3 * n; i++) {
    double x[3];

    for (int k = 0; k < 3; k++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      x[k] = size * (double)(seed >> 40) / (1 << 24);
      if (i % 3) x[k] += m->point[i - i % 3][k] - size / 2;
      else x[k] /= size;
    }
    add_point(m, x[0], x[1], x[2]);
    if (i % 3 == 2)
      add_tri(m, (uint32_t)i - 2, (uint32_t)i - 1, (uint32_t)i, patch);
  }
}

/* Few pairs, each listed, and more than the limit, one partner for each. */
static void threads_find_the_same(void **unused)
{
  static const double size[2] = { 0.06, 1.5 };

  (void)unused;
  for (int pass = 0; pass < 2; pass++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_surface_report r[3];

    memset(r, 0, sizeof r);
    add_soup(&m, pass ? 3000 : 20000, size[pass], 7);
    for (int i = 0; i < 3; i++) {
      struct vg_surface_check_options o = { .external = 1, .threads = i + 1 };

      assert_int_equal(vg_surface_check(&m, &o, &r[i], NULL), VG_OK);
    }
    assert_true(r[0].count[VG_DEFECT_INTERSECTION] > 1000);
    assert_int_equal(r[0].count[VG_DEFECT_INTERSECTION] > VG_SURFACE_PAIR_MAX,
                     pass);
    for (int i = 1; i < 3; i++) {
      assert_memory_equal(r[0].count, r[i].count, sizeof r[0].count);
      assert_int_equal(r[0].n_defect, r[i].n_defect);
      for (size_t d = 0; d < r[0].n_defect; d++) {
        assert_int_equal(r[0].defect[d].kind, r[i].defect[d].kind);
        for (int k = 0; k < 2; k++)
          assert_int_equal(r[0].defect[d].face[k], r[i].defect[d].face[k]);
      }
      assert_memory_equal(r[0].face_kinds, r[i].face_kinds,
                          m.n_tri * sizeof *r[0].face_kinds);
      vg_surface_report_release(&r[i]);
    }
    vg_surface_report_release(&r[0]);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(accepts_a_box),
    cmocka_unit_test(accepts_a_double_cone),
    cmocka_unit_test(accepts_an_empty_mesh),
    cmocka_unit_test(reports_the_edges_of_a_hole),
    cmocka_unit_test(reports_three_faces_at_an_edge),
    cmocka_unit_test(turns_a_face_back),
    cmocka_unit_test(turns_a_surface_inside_out),
    cmocka_unit_test(leaves_a_moebius_strip),
    cmocka_unit_test(welds_a_soup),
    cmocka_unit_test(drops_unused_points),
    cmocka_unit_test(knows_degenerate_triangles),
    cmocka_unit_test(drops_copies_of_a_triangle),
    cmocka_unit_test(drops_a_duplicate_skin),
    cmocka_unit_test(unites_bodies_that_share_a_wall),
    cmocka_unit_test(unites_many_bodies),
    cmocka_unit_test(leaves_a_wall_without_thickness),
    cmocka_unit_test(keeps_a_shared_wall_at_a_hole),
    cmocka_unit_test(reports_coordinates_that_are_not_finite),
    cmocka_unit_test(reports_quadrilaterals),
    cmocka_unit_test(asks_for_boundary_conditions),
    cmocka_unit_test(refuses_an_index_out_of_range),
    cmocka_unit_test(agrees_with_separating_planes),
    cmocka_unit_test(finds_boxes_that_cross),
    cmocka_unit_test(counts_more_pairs_than_it_lists),
    cmocka_unit_test(nests_bodies_in_a_farfield),
    cmocka_unit_test(reverses_the_outer_boundary),
    cmocka_unit_test(sees_through_many_layers),
    cmocka_unit_test(does_not_guess_about_a_stray_body),
    cmocka_unit_test(turns_a_hollow_body_as_one),
    cmocka_unit_test(reports_a_shell_without_volume),
    cmocka_unit_test(welds_a_chain),
    cmocka_unit_test(welds_as_the_definition_says),
    cmocka_unit_test(names_every_kind),
    cmocka_unit_test(threads_find_the_same)
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
