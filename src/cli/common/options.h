/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/common/options.h: command-line options, generated from the rows of the
 * settings. Uses run/settings/settings.h. */
#ifndef VG_CLI_COMMON_OPTIONS_H
#define VG_CLI_COMMON_OPTIONS_H

#include <argp.h>

#include "base/status.h"
#include "run/settings/settings.h"

/** argp_parse with exit status 2 for wrong usage. */
void vg_cli_parse(const struct argp *argp, int argc, char **argv, void *input);

/** Splits the words after the first "--" off a command line: reduces *argc to
 * those before it, and returns their number, with *rest the first of them. */
int vg_cli_split(int *argc, char **argv, char ***rest);

/** Parser of a command that takes exactly one argument, called `what` in
 * messages ("file"): handles the argument, which may also be the value of the
 * option 'p', the end of arguments, and the options 'j' (JSON) and 'q' (no
 * progress). ARGP_ERR_UNKNOWN for other keys. A
 * second argument, or none, is wrong usage. */
struct vg_cli_one {
  const char *file;
  int json, quiet;
};
error_t vg_cli_one(struct vg_cli_one *one, const char *what, int key, char *arg,
                   const struct argp_state *state);

/** The options of a command: its own, followed by one for each setting
 * (vg_settings_name), whose help ends with "[unit, default x]". The help has a
 * group for the most used options, one for other options of the command, and
 * one for each topic of settings. Keys of settings are VG_KEY_SETTING +
 * position. The texts are owned by the table and freed by
 * vg_cli_options_free. */
enum { VG_GROUP_COMMON = 1, VG_GROUP_OWN, VG_GROUP_TOPIC };
#define VG_KEY_SETTING 1000
struct vg_cli_options {
  struct argp_option *option; /* terminated by a zero entry */
  char **text;
  size_t n, n_text;
};

/** @param own  the options of the subcommand, terminated by a zero entry */
vg_status vg_cli_options(const struct argp_option *own,
                         struct vg_cli_options *out, struct vg_error *err);
void vg_cli_options_free(struct vg_cli_options *o);

/** Key of the option of the setting `name`, for a short option with the same
 * meaning; 0 if there is no such setting. */
int vg_cli_option_key(const char *name);

/** Settings from the command line, stored until the deck has been read, which
 * they override. */
struct vg_cli_overrides {
  size_t n, cap;
  struct {
    int key;
    const char *text;
  } * set; /* text is argv's */
};

/** Store the value of the option with `key`. An invalid value is wrong usage,
 * reported before anything is read. Returns ARGP_ERR_UNKNOWN to the parser if
 * the key is not that of a setting. */
error_t vg_cli_add_override(struct vg_cli_overrides *kept, int key,
                            const char *text, const struct argp_state *state);

/** Apply all stored values to s and check the combination of all settings.
 * VG_ERR_USAGE if it is invalid. */
vg_status vg_cli_apply(const struct vg_cli_overrides *kept,
                       struct vg_settings *s, struct vg_error *err);

#endif
