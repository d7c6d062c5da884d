/* cli/common/options.h: options of the command line, made from the table of
 * settings. Uses run/settings/settings.h. */
#ifndef VG_CLI_COMMON_OPTIONS_H
#define VG_CLI_COMMON_OPTIONS_H

#include <argp.h>

#include "base/status.h"
#include "run/settings/settings.h"

/** argp_parse with exit status 2 for wrong usage and help on stdout. */
void vg_cli_parse(const struct argp *argp, int argc, char **argv, void *input);

/** For a parser whose command takes one argument, `what` ("file"): keys of
 * arguments, of their end, and 'j' and 'q' for JSON and no progress.
 * ARGP_ERR_UNKNOWN: another key. A second argument, or none, is wrong usage. */
struct vg_cli_one {
  const char *file;
  int json, quiet;
};
error_t vg_cli_one(struct vg_cli_one *one, const char *what, int key, char *arg,
                   const struct argp_state *state);

/** Help line "[unit; default x]" parts for the settings and their options.
 *
 * Appends one option per plain setting, and the farfield's kind, lengths, size
 * and spacing, to option[*n...]; keys are VG_KEY_SETTING + position. Text is
 * owned by the table, freed by vg_cli_options_free. */
#define VG_KEY_SETTING 1000
struct vg_cli_options {
  struct argp_option *option; /* NULL-ended */
  char **text;
  size_t n, n_text;
};

/** `own`: the subcommand's options, ended by a zero entry. */
vg_status vg_cli_options(const struct argp_option *own,
                         struct vg_cli_options *out);
void vg_cli_options_free(struct vg_cli_options *o);

/** Key of a plain setting's option, for a short one that means the same; 0:
 * no setting has the name. */
int vg_cli_option_key(const char *name);

/** Settings from the command line: they wait until the deck has been read,
 * which they win over. */
struct vg_cli_overrides {
  size_t n, cap;
  struct {
    int key;
    const char *text;
  } * set; /* text is argv's */
};

/** Keep what the option with `key` sets. A value that cannot be is wrong usage,
 * known before anything is read. For a parser: ARGP_ERR_UNKNOWN when the key
 * is no setting's. */
error_t vg_cli_add_override(struct vg_cli_overrides *kept, int key,
                            const char *text, const struct argp_state *state);

/** Set all of them, and check that the settings go together: VG_ERR_USAGE
 * where those of the deck alone did. */
vg_status vg_cli_apply(const struct vg_cli_overrides *kept,
                       struct vg_settings *s, struct vg_error *err);

#endif
