/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/settings.h: all settings of a run, and the descriptions by which
 * they are read, written and documented.
 *
 * One row describes one value: the reader and writer of the deck, the command
 * line and its help, the log, the digest of a job and the check of a resumed
 * run iterate over these rows, so a new setting is one new row in
 * run/settings/setting_rows.h. Uses core and io/stream/stream.h. */
#ifndef VG_RUN_SETTINGS_SETTINGS_H
#define VG_RUN_SETTINGS_SETTINGS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "core/domain/planar.h"
#include "core/sizing/sizing.h"

#define VG_TITLE_MAX 80
#define VG_WRITE_MAX 480  /* bytes of a list of all formats */
#define VG_MESHER_MAX 240 /* bytes of a path */
#define VG_LIST_MAX 240   /* bytes of a list of patches */

/** Outer boundary that is generated around the input surface. */
enum vg_domain_choice {
  VG_DOMAIN_AUTO, /* a farfield if the surface has no outer boundary */
  VG_DOMAIN_NONE,
  VG_DOMAIN_SPHERE,
  VG_DOMAIN_BOX,
  VG_DOMAIN_MACH,
  VG_DOMAIN_C,     /* of plane sections only */
  VG_DOMAIN_TUNNEL /* of plane sections only */
};

/** The farfield table has one row. NAN: not given. */
struct vg_farfield_row {
  int kind; /* enum vg_domain_choice */
  double lengths, size, spacing;
  double centre[3], lo[3], hi[3];
  double mach, upstream, downstream, radial, flow[3]; /* of VG_DOMAIN_MACH */
};

/** What a patch is in the mesh. */
enum vg_patch_role {
  VG_PATCH_AUTO, /* as by the lists `baffles`, `sheets`, `zone_interfaces` */
  VG_PATCH_WALL, /* part of the boundary, with fluid on one side */
  VG_PATCH_BAFFLE,
  VG_PATCH_SHEET,
  VG_PATCH_INTERFACE /* a sheet that separates zones */
};

/** A zone of cells, which the interfaces around its seed point enclose. */
struct vg_zone_row {
  char name[VG_NAME_MAX];
  double seed[3];
  int kind;    /* VG_ZONE_... */
  double hmax; /* largest edge; 0: as elsewhere */
  int mesh;    /* enum vg_answer; auto: unless it is solid */
};

/** Name and condition of a patch. */
struct vg_patch_row {
  int32_t id, bc;            /* bc: USM3D or FUN3D code */
  int hard;                  /* 1: remeshing preserves the patch borders */
  int role;                  /* enum vg_patch_role */
  char name[VG_NAME_MAX];    /* "": as in the input */
  char id_name[VG_NAME_MAX]; /* a name or pattern instead of id; "": id is
                                used */
};

/** Largest edges of a remeshed surface on a patch, or on the curve between two
 * patches. 0: not given. */
struct vg_surface_row {
  int32_t patch, adjacent; /* the patch, and the other patch of the
                            curve; VG_BC_NONE: no curve */
  double size, lead, trail, root, tip, across, stretch;
  /* Names or patterns instead of patch and adjacent; "": the numbers are used.
   */
  char patch_name[VG_NAME_MAX], adjacent_name[VG_NAME_MAX];
};

/** Axis that points up: of the two normal to the stream, the one along which
 * the body is less extended, unless it is given. */
enum vg_wake_up { VG_UP_AUTO, VG_UP_X, VG_UP_Y, VG_UP_Z };

/** Axis along which the stream runs: axis VALUE / 2, backwards if odd. */
enum vg_wake_stream {
  VG_STREAM_X,
  VG_STREAM_MINUS_X,
  VG_STREAM_Y,
  VG_STREAM_MINUS_Y,
  VG_STREAM_Z,
  VG_STREAM_MINUS_Z
};

/** What a wake is made of: sources, or an inner surface. */
enum vg_wake_kind { VG_WAKE_SOURCES, VG_WAKE_SHEET };

/** A wake of trailing edges (core/wake/wake.h, wake_sheet.h). */
struct vg_wake_row {
  int32_t patch; /* of its trailing edges */
  int kind;      /* enum vg_wake_kind */
  double length, size, height, growth;
  double chord;                 /* 0: the local chord */
  double stretch;               /* along the stream */
  int stream, up;               /* enum vg_wake_stream, enum vg_wake_up */
  char patch_name[VG_NAME_MAX]; /* as in vg_surface_row */
  char alpha[VG_LIST_MAX], beta[VG_LIST_MAX]; /* lists of angles in degrees */
};

/** Transform of a pair of periodic patches. */
enum vg_periodic_kind {
  VG_PERIODIC_AUTO,
  VG_PERIODIC_TRANSLATION,
  VG_PERIODIC_ROTATION
};

/** A pair of periodic patches (core/periodic/periodic.h). NAN: not given. */
struct vg_periodic_row {
  int32_t patch, image;
  int kind; /* enum vg_periodic_kind */
  double t[3], angle, centre[3], axis[3];
  char patch_name[VG_NAME_MAX], image_name[VG_NAME_MAX]; /* as in
                                                            vg_surface_row */
};

/** A yes/no setting that the run may decide itself. */
enum vg_answer { VG_ANSWER_AUTO, VG_ANSWER_NO, VG_ANSWER_YES };

#define VG_COUNT_NONE (-1) /* a count that is not given */

/** Limits that the layers of a wall patch must meet; see the settings of the
 * same names. NAN: no limit. */
struct vg_layer_limits {
  double min_full, min_any, min_height, max_first_error; /* per cent */
  double max_top_ratio;
};

#define VG_NO_LIMITS ((struct vg_layer_limits){ NAN, NAN, NAN, NAN, NAN })

/** The layers of one patch. NAN, VG_COUNT_NONE: the global setting. */
struct vg_layer_row {
  int32_t id;
  int grow; /* enum vg_answer; auto: by condition */
  double first, ratio, rate1, rate2, y_plus;
  int64_t count, constant;
  double total, cap;
  struct vg_layer_limits limit;
  char id_name[VG_NAME_MAX]; /* as in vg_patch_row */
};

/** Lists of numbers in the syntax of run/common/ranges.h, used by vanguard
 * sweep only; "": not given. */
struct vg_sweep_row {
  char ranks[VG_LIST_MAX], threads[VG_LIST_MAX];
  char bisections[VG_LIST_MAX], leaf_cells[VG_LIST_MAX], family[VG_LIST_MAX];
  char decompose[VG_LIST_MAX], subdomains[VG_LIST_MAX];
  int64_t repeat; /* 0: not given */
};

/** The loop of mesh, flow solver and metric that vanguard adapt runs. 0, "" and
 * NAN: not given. */
struct vg_adapt_row {
  char solver[VG_LIST_MAX]; /* program with arguments, separated by blanks */
  char field[VG_LIST_MAX];  /* as --field of vanguard metric */
  char norm[8];             /* as --norm */
  int64_t cycles;
  double cells, cells_ratio;
  double growth, h_min, h_max, aspect_max; /* of the metric */
};

/* The structures below take their members from the rows with their PLACE. */
#define VG_MEMBER_REAL double
#define VG_MEMBER_COUNT int64_t
#define VG_MEMBER_FLAG int
#define VG_MEMBER_WORD int
#define VG_ROW(type, place, member, ...) VG_IN_##place(VG_MEMBER_##type member;)
#define VG_TEXT_ROW(place, member, size, ...) VG_IN_##place(char member[size];)
#define VG_IN_limit(declaration)

/** Viscous layers on all walls. 0 (ratio, rates, cap and limits: NAN): not
 * given. */
struct vg_layer_settings {
#define VG_IN_plain(declaration)
#define VG_IN_cad(declaration)
#define VG_IN_layer(declaration) declaration
#include "run/settings/setting_rows.h"
#undef VG_IN_layer
#undef VG_IN_cad
  struct vg_layer_limits limit;
};

/** Tessellation of CAD: as struct vg_cad_options of io/cad/cad.h. */
struct vg_cad_settings {
#define VG_IN_layer(declaration)
#define VG_IN_cad(declaration) declaration
#include "run/settings/setting_rows.h"
#undef VG_IN_cad
#undef VG_IN_plain
};

/** All settings of a run; the rows document them. */
struct vg_settings {
  char title[VG_TITLE_MAX + 1];
#define VG_IN_cad(declaration)
#define VG_IN_plain(declaration) declaration
#include "run/settings/setting_rows.h"
#undef VG_IN_plain
#undef VG_IN_cad
#undef VG_IN_layer
#undef VG_IN_limit
#undef VG_ROW
#undef VG_TEXT_ROW
  struct vg_cad_settings cad;
  struct vg_layer_settings layer;
  struct vg_farfield_row farfield;
  struct vg_sweep_row sweep;
  struct vg_adapt_row adapt;
  size_t n_sweep, n_adapt; /* 1: given */
  size_t n_source, cap_source, n_patch, cap_patch, n_layer, cap_layer;
  size_t n_surface, cap_surface, n_wake, cap_wake, n_zone, cap_zone;
  size_t n_periodic, cap_periodic;
  struct vg_source *source;             /* [n_source] owned */
  struct vg_patch_row *patch;           /* [n_patch] owned */
  struct vg_layer_row *layer_row;       /* [n_layer] owned */
  struct vg_surface_row *surface_row;   /* [n_surface] owned */
  struct vg_wake_row *wake_row;         /* [n_wake] owned */
  struct vg_zone_row *zone;             /* [n_zone] owned */
  struct vg_periodic_row *periodic_row; /* [n_periodic] owned */
};
#define VG_SETTINGS_INIT                                                       \
  {                                                                            \
    .n_source = 0                                                              \
  } /* releasing this is a no-op */

enum vg_param_type {
  VG_PARAM_REAL,  /* double; "-" is NAN where `optional` */
  VG_PARAM_COUNT, /* int64_t; "-" is VG_COUNT_NONE where `optional` */
  VG_PARAM_ID,    /* int32_t; "-" is VG_BC_NONE where `optional` */
  VG_PARAM_PATCH, /* int32_t as VG_PARAM_ID, or a name at name_at */
  VG_PARAM_FLAG,  /* int: yes or no */
  VG_PARAM_WORD,  /* int: position in words[] */
  VG_PARAM_TEXT   /* char[size] */
};

/** The part of a run that a setting affects: without that part it has no
 * effect. */
enum vg_use {
  VG_USE_BY_PLACE, /* CAD in vg_cad_settings, LAYERS in vg_layer_settings,
                      FARFIELD in a vg_farfield_row, else ALWAYS */
  VG_USE_ALWAYS,
  VG_USE_D3M,
  VG_USE_CAD,
  VG_USE_REMESH,
  VG_USE_LAYERS,
  VG_USE_FARFIELD,
  VG_USE_PLANES,
  VG_USE_PARTS,
  VG_USE_SECTION,
  VG_USE_VOLUME,
  VG_USE_N
};

/** Groups of the options in the help, in this order. */
enum vg_topic {
  VG_TOPIC_BY_USE, /* CAD, REMESH, FARFIELD, LAYERS, LIMITS and PARALLEL by
                      vg_param_use and place, else VOLUME */
  VG_TOPIC_SIZES,
  VG_TOPIC_SURFACE,
  VG_TOPIC_CAD,
  VG_TOPIC_REMESH,
  VG_TOPIC_SECTION,
  VG_TOPIC_FARFIELD,
  VG_TOPIC_LAYERS,
  VG_TOPIC_LIMITS,
  VG_TOPIC_VOLUME,
  VG_TOPIC_PARALLEL,
  VG_TOPIC_OUTPUT,
  VG_TOPIC_N
};

/** One value: its name, location, permitted range and help text. */
struct vg_param {
  const char *name;
  enum vg_param_type type;
  enum vg_use use;
  enum vg_topic topic;
  int is_common;            /* 1: one of the most used options */
  size_t offset, size;      /* in the row or in vg_settings; size of a text */
  size_t name_at;           /* offset of the char[VG_NAME_MAX] with the name or
                               pattern of a VG_PARAM_PATCH; the number is then
                               VG_BC_NONE */
  double lo, hi;            /* range of a number; see above_lo */
  int above_lo;             /* 1: lo itself is out of range */
  int optional;             /* 1: "-" stands for "not given" */
  int required;             /* 1: a table must have this column */
  int keeps_mesh;           /* 1: points, cells, patches and conditions of the
                               mesh do not depend on the value: it is not part
                               of the job's digest, and may change when a run
                               is resumed */
  const char *const *words; /* NULL-terminated, for VG_PARAM_WORD */
  /* Validates a text; NULL: every text is valid. */
  vg_status (*check)(const char *name, const char *text, struct vg_error *err);
  /* Regular expression of the texts that `check` accepts, for the JSON Schema;
   * the caller frees it. NULL: no check. */
  char *(*pattern)(void);
  const char *unit; /* "" for pure numbers */
  const char *help;
  const char *argument; /* name of the value in the help; NULL: by its type */
};

/** Type and range of a column that identifies a patch; `name` is the member of
 * the row that stores a name. */
#define VG_PATCH_COLUMN(row, name)                                             \
  .type = VG_PARAM_PATCH, .name_at = offsetof(row, name), .lo = -INT32_MAX,    \
  .hi = INT32_MAX, .unit = ""

enum vg_table_kind {
  VG_TABLE_FARFIELD,
  VG_TABLE_PATCHES,
  VG_TABLE_LAYERS,
  VG_TABLE_SURFACE,
  VG_TABLE_WAKES,
  VG_TABLE_ZONES,
  VG_TABLE_PERIODIC,
  VG_TABLE_SOURCES,
  VG_TABLE_SWEEP,
  VG_TABLE_ADAPT,
  VG_TABLE_N
};

/** Whether a table has one row at most. */
static inline int vg_table_is_single(enum vg_table_kind kind)
{
  return kind == VG_TABLE_FARFIELD || kind == VG_TABLE_SWEEP ||
         kind == VG_TABLE_ADAPT;
}

struct vg_setting_table {
  const char *name, *help;
  const struct vg_param *column;
  size_t n_column, row_size;
};

/** Descriptions of the *n plain settings, which excludes tables. Static
 * storage. */
const struct vg_param *vg_settings_params(size_t *n);

/** Description of a table. Static storage. */
const struct vg_setting_table *vg_settings_table(enum vg_table_kind kind);

/** Set every setting to its default. *s is overwritten, not released. */
void vg_settings_default(struct vg_settings *s);

/** Store the default row of a table in row[row_size]. */
void vg_settings_row_default(enum vg_table_kind kind, void *row);

/** Append a row; that of a table with one row replaces the existing one. A
 * source with h1 = 0 gets h1 = h0. */
vg_status vg_settings_add(struct vg_settings *s, enum vg_table_kind kind,
                          const void *row, struct vg_error *err);

/** Row i of a table and the count of rows (farfield: always one; sweep and
 * adapt: at most one). */
const void *vg_settings_row(const struct vg_settings *s,
                            enum vg_table_kind kind, size_t i);
size_t vg_settings_rows(const struct vg_settings *s, enum vg_table_kind kind);

void vg_settings_release(struct vg_settings *s);

/** Deep copy into *to, which must be empty. */
vg_status vg_settings_copy(struct vg_settings *to,
                           const struct vg_settings *from,
                           struct vg_error *err);

/** Set or get a plain setting by its name, or a column of the farfield table by
 * the name of its option: "growth", "farfield", "farfield_lengths". '-' may
 * replace '_', as on the command line. The names are those of
 * vg_settings_name.
 *
 * set: text as in the deck; vg_settings_override is applied. The message of
 * VG_ERR_INPUT suggests the nearest name, or states the permitted values.
 * get: out[size] as for vg_param_format. */
vg_status vg_settings_set(struct vg_settings *s, const char *name,
                          const char *text, struct vg_error *err);
vg_status vg_settings_get(const struct vg_settings *s, const char *name,
                          char *out, size_t size, struct vg_error *err);

/** Name and description of setting i; *in_farfield is 1 if it is a column of
 * the farfield table. NULL if i is past the last setting. Static storage. */
const struct vg_param *vg_settings_name(size_t i, const char **name,
                                        int *in_farfield);

/** The part of a run that the setting affects; never VG_USE_BY_PLACE. */
enum vg_use vg_param_use(const struct vg_param *p, int in_farfield);

/** The topic of the setting; never VG_TOPIC_BY_USE. */
enum vg_topic vg_param_topic(const struct vg_param *p, int in_farfield);

/** Array with one byte for each i of vg_settings_name, 1 if the setting differs
 * from its default. The caller frees it. NULL: out of memory. */
uint8_t *vg_settings_given(const struct vg_settings *s);

/** Append a row to the table `name` from n columns and their values, as in the
 * deck; columns that are not named keep their defaults. */
vg_status vg_settings_add_named(struct vg_settings *s, const char *name,
                                size_t n, const char *const *column,
                                const char *const *value, struct vg_error *err);

/** Check conditions between settings, e.g. hmin <= hmax. Settings that contain
 * lengths with a unit are checked in the unit of the mesh, or not at all as
 * long as it is not known. VG_ERR_INPUT. */
vg_status vg_settings_check(const struct vg_settings *s, struct vg_error *err);

/** Set the value that `p` describes in the struct at `base` from text.
 * The message of VG_ERR_INPUT does not contain file and line: the caller adds
 * them. */
vg_status vg_param_set(const struct vg_param *p, void *base, const char *text,
                       size_t len, struct vg_error *err);

/** May the value have a unit of length, as in 30mm? */
int vg_param_is_length(const struct vg_param *p);

/** The unit of the mesh as far as the settings state it (enum vg_cad_unit);
 * VG_CAD_UNIT_FILE: they do not. */
int vg_settings_unit(const struct vg_settings *s);

/** Find a length with a unit (run/settings/length.h). Returns its setting, or
 * NULL if no length has a unit; *value: the length. */
const struct vg_param *vg_settings_find_unit(const struct vg_settings *s,
                                             double *value);

/** Replace all lengths with a unit by numbers in the unit `unit` (enum
 * vg_cad_unit, not FILE). */
void vg_settings_convert(struct vg_settings *s, int unit);

/** Write the value as text that vg_param_set reads back to the same value.
 * out[size] should hold VG_LIST_MAX * 2 + 3 bytes. */
void vg_param_format(const struct vg_param *p, const void *base, char *out,
                     size_t size);

/** Whether one of the two settings, which are not columns of the farfield
 * table, replaces the other: as first and y_plus. */
int vg_settings_exclude(const struct vg_param *a, const struct vg_param *b);

/** Reset the alternatives of a setting. Some quantities can be given in two
 * ways (first and y_plus, ratio and the rates, leaf_cells and bisections); the
 * one that was set last applies.
 * @param set  the setting that has just been set */
void vg_settings_override(struct vg_settings *s, const struct vg_param *set);

#endif
