/* run/settings/settings.h: everything a run can be told, and the tables that
 * name it.
 *
 * One row of a table describes one value: the deck's reader and writer, the
 * command line and its help, the log, the digest of a job and the check of a
 * resumed run walk these rows, so a new setting is one new row in
 * run/settings/setting_rows.h. Uses core and io/stream/stream.h. */
#ifndef VG_RUN_SETTINGS_SETTINGS_H
#define VG_RUN_SETTINGS_SETTINGS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "core/domain/planar.h"
#include "core/sizing/sizing.h"

#define VG_TITLE_MAX 80
#define VG_WRITE_MAX 160
#define VG_MESHER_MAX 240 /* bytes of a path */
#define VG_LIST_MAX 240   /* bytes of a list of patches; no text is longer */

/** How the domain around the given surface is completed. */
enum vg_domain_choice {
  VG_DOMAIN_AUTO, /* a farfield only where a body stands alone */
  VG_DOMAIN_NONE,
  VG_DOMAIN_SPHERE,
  VG_DOMAIN_BOX
};

/** The farfield table has one row. NAN: not given. */
struct vg_farfield_row {
  int kind; /* enum vg_domain_choice */
  double lengths, size, spacing;
  double centre[3], lo[3], hi[3];
};

struct vg_patch_row {
  int32_t id, bc;            /* bc: USM3D or FUN3D code */
  int hard;                  /* a new surface keeps its borders */
  char name[VG_NAME_MAX];    /* "": as the input says */
  char id_name[VG_NAME_MAX]; /* a name or pattern in place of id; "": id
                                holds */
};

/** Largest edges of a remeshed surface on a patch, or on the curve between two
 * patches. 0: not given. */
struct vg_surface_row {
  int32_t patch, beside; /* the patch, and the other patch of the
                            curve; VG_BC_NONE: no curve */
  double size, lead, across, stretch;
  /* Names or patterns in place of patch and beside; "": the numbers hold. */
  char patch_name[VG_NAME_MAX], beside_name[VG_NAME_MAX];
};

/** Answers that a project may leave open. */
enum vg_answer { VG_ANSWER_AUTO, VG_ANSWER_NO, VG_ANSWER_YES };

#define VG_COUNT_NONE (-1) /* a count that is not given */

/** What layers must reach on a wall patch, as the settings of these names say;
 * NAN: nothing. */
struct vg_layer_limits {
  double min_full, min_any, min_height, max_first_error; /* per cent */
  double max_top_ratio;
};

#define VG_NO_LIMITS ((struct vg_layer_limits){ NAN, NAN, NAN, NAN, NAN })

/** The layers of one patch. NAN, VG_COUNT_NONE: the global value. */
struct vg_layer_row {
  int32_t id;
  int grow; /* enum vg_answer; auto: by condition */
  double first, ratio, rate1, rate2, y_plus;
  int64_t count, constant;
  double total, cap;
  struct vg_layer_limits limit;
  char id_name[VG_NAME_MAX]; /* as in vg_patch_row */
};

/** Lists of numbers as run/common/ranges.h takes them, for vanguard sweep
 * alone; "": not given. */
struct vg_sweep_row {
  char ranks[VG_LIST_MAX], threads[VG_LIST_MAX];
  char levels[VG_LIST_MAX], leaf_cells[VG_LIST_MAX], family[VG_LIST_MAX];
  char decompose[VG_LIST_MAX], parts[VG_LIST_MAX];
  int64_t repeat; /* 0: not given */
};

/* Members of the structures below: those of the rows in their place. */
#define VG_MEMBER_REAL double
#define VG_MEMBER_COUNT int64_t
#define VG_MEMBER_FLAG int
#define VG_MEMBER_WORD int
#define VG_ROW(type, place, member, ...) VG_IN_##place(VG_MEMBER_##type member;)
#define VG_TEXT_ROW(place, member, size, ...) VG_IN_##place(char member[size];)
#define VG_IN_limit(declaration)

/** Viscous layers on all walls. 0 (a rate, the cap and limits: NAN): not
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

/** How CAD becomes triangles: as struct vg_cad_options of io/cad/cad.h. */
struct vg_cad_settings {
#define VG_IN_layer(declaration)
#define VG_IN_cad(declaration) declaration
#include "run/settings/setting_rows.h"
#undef VG_IN_cad
#undef VG_IN_plain
};

/** All settings of a run; their rows say what they mean. */
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
  size_t n_sweep; /* 1: given */
  size_t n_source, cap_source, n_patch, cap_patch, n_layer, cap_layer;
  size_t n_surface, cap_surface;
  struct vg_source *source;           /* [n_source] owned */
  struct vg_patch_row *patch;         /* [n_patch] owned */
  struct vg_layer_row *layer_row;     /* [n_layer] owned */
  struct vg_surface_row *surface_row; /* [n_surface] owned */
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

/** What must be part of a run for a setting to have an effect on it. */
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
  VG_USE_N
};

/** One value: its name, where it lies, what it may be, and its help. */
struct vg_param {
  const char *name;
  enum vg_param_type type;
  enum vg_use use;
  size_t offset, size;      /* in the row or in vg_settings; size of a text */
  size_t name_at;           /* offset of the char[VG_NAME_MAX] with the name or
                               pattern of a VG_PARAM_PATCH; VG_BC_NONE is the
                               number then */
  double lo, hi;            /* range of a number; see above_lo */
  int above_lo;             /* 1: lo itself is refused */
  int optional;             /* 1: "-" stands for "not given" */
  int required;             /* 1: a table must have this column */
  int keeps_mesh;           /* 1: points, cells, patches and conditions of the
                               mesh do not depend on the value: it is no part
                               of the job's digest, and may change when a run
                               is resumed */
  const char *const *words; /* NULL-ended, for VG_PARAM_WORD */
  /* Of a text: whether it says what it should; NULL: any will do. */
  vg_status (*check)(const char *name, const char *text, struct vg_error *err);
  const char *unit; /* "" for pure numbers */
  const char *help;
  const char *argument; /* what help calls the value; NULL: by its type */
};

/** Type and range of a column with a patch; `name` is the member of the row
 * that takes a name. */
#define VG_PATCH_COLUMN(row, name)                                             \
  .type = VG_PARAM_PATCH, .name_at = offsetof(row, name), .lo = INT32_MIN,     \
  .hi = INT32_MAX, .unit = ""

enum vg_table_kind {
  VG_TABLE_FARFIELD,
  VG_TABLE_PATCHES,
  VG_TABLE_LAYERS,
  VG_TABLE_SURFACE,
  VG_TABLE_SOURCES,
  VG_TABLE_SWEEP,
  VG_TABLE_N
};

struct vg_setting_table {
  const char *name, *help;
  const struct vg_param *column;
  size_t n_column, row_size;
};

/** The plain settings (no tables); *n of them. Static. */
const struct vg_param *vg_settings_params(size_t *n);

/** Description of a table. Static. */
const struct vg_setting_table *vg_settings_table(enum vg_table_kind kind);

/** Give every setting its default. *s is overwritten, not released. */
void vg_settings_default(struct vg_settings *s);

/** Default row of a table into row[row_size]. */
void vg_settings_row_default(enum vg_table_kind kind, void *row);

/** Append a row; those of farfield and sweep replace the one there is. A source
 * without h1 gets its h0 there. */
vg_status vg_settings_add(struct vg_settings *s, enum vg_table_kind kind,
                          const void *row, struct vg_error *err);

/** Row i of a table and the count of rows (farfield: always one; sweep: at most
 * one). */
const void *vg_settings_row(const struct vg_settings *s,
                            enum vg_table_kind kind, size_t i);
size_t vg_settings_rows(const struct vg_settings *s, enum vg_table_kind kind);

void vg_settings_release(struct vg_settings *s);

/** A deep copy into *to, which is empty. */
vg_status vg_settings_copy(struct vg_settings *to,
                           const struct vg_settings *from,
                           struct vg_error *err);

/** A plain setting by its name, or one of the farfield by the name of its
 * option: "growth", "farfield", "farfield_lengths"; as on the command line '-'
 * stands for '_', too. The names are those of vg_settings_name.
 *
 * set: text as in the deck; vg_settings_override is applied. VG_ERR_INPUT
 * names the nearest name, or what the value should be.
 * get: out[size] as vg_param_format. */
vg_status vg_settings_set(struct vg_settings *s, const char *name,
                          const char *text, struct vg_error *err);
vg_status vg_settings_get(const struct vg_settings *s, const char *name,
                          char *out, size_t size, struct vg_error *err);

/** Setting i: its name, and what describes it, with *in_farfield 1 where that
 * is a column of the farfield's table; NULL behind the last. Static. */
const struct vg_param *vg_settings_name(size_t i, const char **name,
                                        int *in_farfield);

/** What the setting needs; never VG_USE_BY_PLACE. */
enum vg_use vg_param_use(const struct vg_param *p, int in_farfield);

/** Which settings are not as by default: one byte for each i of
 * vg_settings_name, which the caller frees. NULL: no memory. */
uint8_t *vg_settings_given(const struct vg_settings *s);

/** A row of the table `name` from n columns and their values, as in the deck;
 * what is not named keeps its default. */
vg_status vg_settings_add_named(struct vg_settings *s, const char *name,
                                size_t n, const char *const *column,
                                const char *const *value, struct vg_error *err);

/** What holds between settings, e.g. hmin <= hmax. VG_ERR_INPUT. */
vg_status vg_settings_check(const struct vg_settings *s, struct vg_error *err);

/** Set the value that `p` describes in the struct at `base` from text.
 * VG_ERR_INPUT says what is wrong, without a place: the caller adds it. */
vg_status vg_param_set(const struct vg_param *p, void *base, const char *text,
                       size_t len, struct vg_error *err);

/** The value as text that vg_param_set reads back to the same value.
 * out[size] should hold VG_LIST_MAX * 2 + 3 bytes. */
void vg_param_format(const struct vg_param *p, const void *base, char *out,
                     size_t size);

/** Nearest name to `text` among names (get(user, i), i < n), or NULL when
 * none is near enough to be a slip. */
const char *vg_nearest_name(const char *text, size_t n,
                            const char *(*get)(const void *user, size_t i),
                            const void *user);

/** Of settings that say the same in two ways (a first height and y+, a ratio
 * and its rates, leaf_cells and levels) the one that was set last holds: forget
 * the others.
 * @param set  the setting that has just been set */
void vg_settings_override(struct vg_settings *s, const struct vg_param *set);

#endif
