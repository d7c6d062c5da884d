#define _GNU_SOURCE
#include "cli/common/options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/common/cli.h"

void vg_cli_parse(const struct argp *argp, int argc, char **argv, void *input)
{
  argp_err_exit_status = VG_EXIT_USAGE;
  if (argp_parse(argp, argc, argv, 0, NULL, input)) exit(VG_EXIT_USAGE);
}

error_t vg_cli_one(struct vg_cli_one *one, const char *what, int key, char *arg,
                   const struct argp_state *state)
{
  switch (key) {
  case 'j': one->json = 1; return 0;
  case 'q': one->quiet = 1; return 0;
  case ARGP_KEY_ARG:
    if (one->file) argp_error(state, "only one %s is accepted: %s", what, arg);
    one->file = arg;
    return 0;
  case ARGP_KEY_END:
    if (!one->file) argp_error(state, "no %s given", what);
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

static char *keep(struct vg_cli_options *o, char *text)
{
  if (text) o->text[o->n_text++] = text;
  return text;
}

/* Add the option of setting p; base contains its default. */
static int add_option(struct vg_cli_options *o, const struct vg_param *p,
                      const char *name, int key, const void *base)
{
  char value[2 * VG_LIST_MAX + 4], *long_name, *help;
  struct argp_option *to = &o->option[o->n];

  vg_param_format(p, base, value, sizeof value);
  long_name = keep(o, strdup(name));
  if (!long_name) return -1;
  for (char *c = long_name; *c; c++)
    if (*c == '_') *c = '-';
  if (asprintf(&help, "%s [%s%sdefault %s]", p->help, p->unit,
               *p->unit ? ", " : "", value) < 0)
    return -1;
  keep(o, help);
  to->name = long_name;
  to->key = key;
  to->arg = p->argument                    ? p->argument
          : p->type == VG_PARAM_TEXT       ? "LIST"
          : p->type == VG_PARAM_WORD       ? "KIND"
          : p->type == VG_PARAM_FLAG       ? "yes|no"
          : p->type == VG_PARAM_COUNT      ? "N"
          : strcmp(p->unit, "length") == 0 ? "LENGTH"
                                           : "NUMBER";
  to->doc = help;
  to->group = 2;
  o->n++;
  return 0;
}

vg_status vg_cli_options(const struct argp_option *own,
                         struct vg_cli_options *out)
{
  size_t n = 0, n_own = 0, room;
  const struct vg_param *p;
  struct vg_settings defaults;
  const char *name;
  int bad = 0, in_farfield;

  while (own[n_own].name || own[n_own].key || own[n_own].doc) n_own++;
  while (vg_settings_name(n, &name, &in_farfield)) n++;
  room = n_own + 1 + n + 1;
  memset(out, 0, sizeof *out);
  out->option = vg_calloc(room, sizeof *out->option);
  out->text = vg_calloc(2 * room, sizeof *out->text);
  if (!out->option || !out->text) {
    vg_cli_options_free(out);
    return VG_ERR_MEMORY;
  }
  memcpy(out->option, own, n_own * sizeof *own);
  out->n = n_own;
  out->option[out->n].doc = "Settings, which override those of the deck:";
  out->option[out->n++].group = 2;
  vg_settings_default(&defaults);
  for (size_t i = 0; (p = vg_settings_name(i, &name, &in_farfield)); i++)
    bad |= add_option(out, p, name, VG_KEY_SETTING + (int)i,
                      in_farfield ? (void *)&defaults.farfield
                                  : (void *)&defaults);
  if (!bad) return VG_OK;
  vg_cli_options_free(out);
  return VG_ERR_MEMORY;
}

void vg_cli_options_free(struct vg_cli_options *o)
{
  for (size_t i = 0; i < o->n_text; i++) free(o->text[i]);
  free(o->text);
  free(o->option);
  memset(o, 0, sizeof *o);
}

int vg_cli_option_key(const char *name)
{
  const char *known;
  int in_farfield;

  for (size_t i = 0; vg_settings_name(i, &known, &in_farfield); i++)
    if (!strcmp(known, name)) return VG_KEY_SETTING + (int)i;
  return 0;
}

/* Set the setting of the option with `key`; VG_BLOCKED if `key` is not that of
 * a setting. */
static vg_status set_option(int key, const char *text, struct vg_settings *s,
                            struct vg_error *err)
{
  const char *name;
  int in_farfield;

  if (key < VG_KEY_SETTING ||
      !vg_settings_name((size_t)(key - VG_KEY_SETTING), &name, &in_farfield))
    return VG_BLOCKED;
  return vg_settings_set(s, name, text, err);
}

error_t vg_cli_add_override(struct vg_cli_overrides *kept, int key,
                            const char *text, const struct argp_state *state)
{
  struct vg_settings scratch;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_settings_default(&scratch);
  st = set_option(key, text, &scratch, &err);
  vg_settings_release(&scratch);
  if (st == VG_BLOCKED) return ARGP_ERR_UNKNOWN;
  if (st < 0) argp_error(state, "%s", err.text);
  if (vg_reserve(&kept->set, &kept->cap, kept->n + 1, sizeof *kept->set))
    return ENOMEM;
  kept->set[kept->n].key = key;
  kept->set[kept->n++].text = text;
  return 0;
}

vg_status vg_cli_apply(const struct vg_cli_overrides *kept,
                       struct vg_settings *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < kept->n && st >= 0; i++)
    st = set_option(kept->set[i].key, kept->set[i].text, s, err);
  if (st >= 0) st = vg_settings_check(s, err);
  if (st == VG_ERR_INPUT && err) err->code = VG_ERR_USAGE;
  return st == VG_ERR_INPUT ? VG_ERR_USAGE : st;
}
