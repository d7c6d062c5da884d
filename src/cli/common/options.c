/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/common/options.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/common/cli.h"
#include "run/settings/lists.h"
#include "run/settings/names.h"

/* --- parsing ------------------------------------------------------------- */

/* The option with the long name name[0..len), else the first one whose long
 * name begins with it. */
static const struct argp_option *long_option(const struct argp_option *o,
                                             const char *name, size_t len)
{
  const struct argp_option *first = NULL;

  for (; o->name || o->key || o->doc; o++) {
    if (!o->name || o->flags & OPTION_DOC || strncmp(o->name, name, len) != 0)
      continue;
    if (!o->name[len]) return o;
    if (!first) first = o;
  }
  return first;
}

static const struct argp_option *short_option(const struct argp_option *o,
                                              int key)
{
  for (; o->name || o->key || o->doc; o++)
    if (o->key == key && !(o->flags & OPTION_DOC)) return o;
  return NULL;
}

static const char *long_name(const void *user, size_t i)
{
  return (*((const struct argp_option *const *)user + i))->name;
}

/* The long options that the help lists, as candidates of suggestions. */
static struct vg_names long_names(const struct argp_option *o,
                                  const struct argp_option **known)
{
  struct vg_names names = { 0, long_name, known };

  for (; (o->name || o->key || o->doc) && names.n < VG_KEY_SETTING; o++)
    if (o->name && !(o->flags & (OPTION_DOC | OPTION_HIDDEN)))
      known[names.n++] = o;
  return names;
}

/* The word means the number of ranks in other programs. */
static int means_ranks(const char *word)
{
  static const struct argp_option option = { .name = "ranks" };
  const struct argp_option *known = &option;
  const struct vg_names names = { 1, long_name, &known };
  struct vg_suggestion s;

  vg_suggest_field(word, &names, &s);
  return s.n > 0;
}

struct command_line {
  const struct argp_option *option;
  const char *command; /* "vanguard mesh" */
  int argc;
  char **argv;
  int at; /* the word that is checked */
};

/* Ranks are given to the launcher of MPI, not to the program. */
static void refuse_ranks(const struct command_line *l, const char *dashes,
                         const char *word)
{
  const char *next = l->at + 1 < l->argc ? l->argv[l->at + 1] : "";
  const int is_number = *next && !next[strspn(next, "0123456789")];
  const char *n = is_number ? next : "N";

  fprintf(stderr, "%s: unknown option '%s%s'; ", l->command, dashes, word);
  if (!strcmp(l->command, "vanguard mesh"))
    fprintf(stderr,
            "the launcher of MPI sets the number of ranks, as in 'mpirun -n %s "
            "vanguard mesh -p PROJECT', and '--threads %s' the number of "
            "threads of each rank\n",
            n, n);
  else
    fprintf(stderr,
            "'%s' runs in one process, and '--threads %s' sets the number of "
            "its threads\n",
            l->command, n);
  exit(VG_EXIT_USAGE);
}

static void refuse_option(const struct command_line *l, const char *dashes,
                          const char *given, size_t len)
{
  const struct argp_option *known[VG_KEY_SETTING];
  const struct vg_names names = long_names(l->option, known);
  char word[64], hint[VG_HINT_SIZE], help[96];
  struct vg_suggestion near;

  snprintf(word, sizeof word, "%.*s", (int)len, given);
  if (means_ranks(word) && long_option(l->option, "threads", 7) &&
      !long_option(l->option, "ranks", 5) &&
      !long_option(l->option, "parts", 5))
    refuse_ranks(l, dashes, word);
  vg_suggest(word, &names, &near);
  snprintf(help, sizeof help, "'%.64s --help' lists the options", l->command);
  fprintf(stderr, "%s: unknown option '%s%.*s'; %s\n", l->command, dashes,
          (int)len, given, vg_hint(&near, "--", help, hint));
  exit(VG_EXIT_USAGE);
}

/* getopt completes "--size" to "--sizes". An abbreviation that other mesh
 * generators use for another option is refused. */
static void check_abbreviation(const struct command_line *l, const char *given,
                               size_t len)
{
  const struct argp_option *known[VG_KEY_SETTING];
  const struct vg_names names = long_names(l->option, known);
  struct vg_suggestion field;
  char word[64];

  if (len >= sizeof word) return;
  snprintf(word, sizeof word, "%.*s", (int)len, given);
  vg_suggest_field(word, &names, &field);
  for (size_t i = 0; i < field.n; i++) {
    if (!strncmp(field.name[i], given, len)) continue;
    fprintf(stderr,
            "%s: option '--%s' is ambiguous: it abbreviates '--%s', but other "
            "mesh generators use the word for '--%s'%s%s%s; write the option "
            "in full\n",
            l->command, word, long_option(l->option, word, len)->name,
            field.name[0], field.n > 1 ? " or '--" : "",
            field.n > 1 ? field.name[1] : "", field.n > 1 ? "'" : "");
    exit(VG_EXIT_USAGE);
  }
}

/* "--name" or "--name=value". Returns 1 if the next word is its value. */
static int check_long(const struct command_line *l, const char *word)
{
  size_t len = strcspn(word, "=");
  const struct argp_option *found = long_option(l->option, word, len);
  static const char *const own[] = { "help", "usage", "option-table" };

  if (found && found->name[len]) check_abbreviation(l, word, len);
  if (found) return found->arg && !word[len];
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    if (!strncmp(own[i], word, len)) return 0;
  refuse_option(l, "--", word, len);
  return 0;
}

/* "-abc". Returns 1 if the next word is the value of the last letter. */
static int check_short(const struct command_line *l, const char *word)
{
  for (const char *c = word; *c; c++) {
    const struct argp_option *found = short_option(l->option,
                                                   (unsigned char)*c);

    if (found && found->arg) return !c[1];
    if (!found && !strchr("?h", *c))
      refuse_option(l, "-", word, strcspn(word, "="));
  }
  return 0;
}

/* Refuse an unknown option with a suggestion, which getopt cannot make. Words
 * that are values of options are skipped. */
static void check_options(const struct argp_option *o, int argc, char **argv)
{
  struct command_line l = { o, argv[0], argc, argv, 1 };

  for (; l.at < argc; l.at++) {
    const char *word = argv[l.at];

    if (!strcmp(word, "--")) return;
    if (word[0] != '-' || !word[1]) continue;
    l.at += word[1] == '-' ? check_long(&l, word + 2)
                           : check_short(&l, word + 1);
  }
}

/* Not letters. */
enum { KEY_USAGE = 256, KEY_TABLE };

/* Words that an option may take, separated by blanks. */
static void put_words(FILE *to, const struct argp_option *o)
{
  static const char *const yes_no[] = { "no", "yes", NULL };
  const struct vg_param *p = NULL;
  const char *const *words, *name;
  int in_farfield;

  if (o->key >= VG_KEY_SETTING)
    p = vg_settings_name((size_t)(o->key - VG_KEY_SETTING), &name,
                         &in_farfield);
  if (!p) return;
  words = p->type == VG_PARAM_FLAG ? yes_no : p->words;
  for (size_t i = 0; words && words[i]; i++)
    fprintf(to, "%s%s", i ? " " : "", words[i]);
  if (p->check == vg_write_list_check)
    for (size_t i = 0; vg_write_word(i); i++)
      fprintf(to, "%s%s", i ? " " : "", vg_write_word(i));
  if (p->check == vg_mesher_name_check) fputs("builtin tetgen hxt", to);
}

/* For cmake/manual.sh: a line for each option, with its long name, letter,
 * argument, words and help, separated by tabs. */
static void put_table(const struct argp_option *o, FILE *to)
{
  for (; o->name || o->key || o->doc; o++) {
    const int is_letter = o->key > ' ' && o->key < 127;

    if (o->flags & (OPTION_DOC | OPTION_HIDDEN) || (!o->name && !o->key))
      continue;
    fprintf(to, "%s\t%.*s\t%s\t", o->name ? o->name : "", is_letter,
            (const char[]){ (char)o->key, 0 }, o->arg ? o->arg : "");
    put_words(to, o);
    fprintf(to, "\t%s\n", o->doc ? o->doc : "");
  }
}

/* Replaces argp's own options, of which -? is the only short one for help. */
static error_t show_help(int key, char *arg, struct argp_state *state)
{
  (void)arg;
  switch (key) {
  case 'h':
  case '?':
    argp_state_help(state, state->out_stream,
                    ARGP_HELP_STD_HELP & ~(unsigned)ARGP_HELP_EXIT_OK);
    exit(vg_cli_written(VG_EXIT_DONE));
  case KEY_USAGE:
    argp_state_help(state, state->out_stream, ARGP_HELP_USAGE);
    exit(vg_cli_written(VG_EXIT_DONE));
  case KEY_TABLE:
    put_table(state->root_argp->options, state->out_stream);
    exit(vg_cli_written(VG_EXIT_DONE));
  default: return ARGP_ERR_UNKNOWN;
  }
}

void vg_cli_parse(const struct argp *argp, int argc, char **argv, void *input)
{
  static const struct argp_option options[] = {
    { "help", 'h', NULL, 0, "Give this help list", -1 },
    { NULL, '?', NULL, OPTION_ALIAS, NULL, -1 },
    { "usage", KEY_USAGE, NULL, 0, "Give a short usage message", -1 },
    { "option-table", KEY_TABLE, NULL, OPTION_HIDDEN, NULL, -1 },
    { 0 }
  };
  static const struct argp help = { .options = options, .parser = show_help };
  const struct argp_child child[] = { { .argp = &help, .group = -1 }, { 0 } };
  struct argp all = *argp;

  assert(!argp->children && !short_option(argp->options, 'h'));
  all.children = child;
  argp_err_exit_status = VG_EXIT_USAGE;
  check_options(argp->options, argc, argv);
  if (argp_parse(&all, argc, argv, ARGP_NO_HELP, NULL, input)) {
    /* Wrong usage ends the program earlier, with a message. */
    fprintf(stderr, "vanguard: not enough memory for the options\n");
    exit(VG_EXIT_FAILED);
  }
}

error_t vg_cli_one(struct vg_cli_one *one, const char *what, int key, char *arg,
                   const struct argp_state *state)
{
  switch (key) {
  case 'j': one->json = 1; return 0;
  case 'q': one->quiet = 1; return 0;
  case 'p':
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
                      const char *name, int key, const void *base, int group)
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
  to->group = p->is_common ? VG_GROUP_COMMON : group;
  o->n++;
  return 0;
}

static const char *const topic_title[VG_TOPIC_N] = {
  [VG_TOPIC_SIZES] = "Edge lengths in the volume:",
  [VG_TOPIC_SURFACE] = "Surface and flow domain:",
  [VG_TOPIC_CAD] = "CAD files:",
  [VG_TOPIC_REMESH] = "Remeshing of the surface:",
  [VG_TOPIC_SECTION] = "Plane sections:",
  [VG_TOPIC_FARFIELD] = "Outer boundary:",
  [VG_TOPIC_LAYERS] = "Viscous layers:",
  [VG_TOPIC_LIMITS] = "Limits on the layers:",
  [VG_TOPIC_VOLUME] = "Volume mesh:",
  [VG_TOPIC_PARALLEL] = "Domain decomposition and threads:",
  [VG_TOPIC_OUTPUT] = "Output files:",
};

static void add_title(struct vg_cli_options *o, const char *title, int group)
{
  o->option[o->n].doc = title;
  o->option[o->n++].group = group;
}

vg_status vg_cli_options(const struct argp_option *own,
                         struct vg_cli_options *out, struct vg_error *err)
{
  size_t n = 0, n_own = 0, room;
  const struct vg_param *p;
  struct vg_settings defaults;
  const char *name;
  int bad = 0, has_own = 0, in_farfield;

  while (own[n_own].name || own[n_own].key || own[n_own].doc) n_own++;
  while (vg_settings_name(n, &name, &in_farfield)) n++;
  room = n_own + 2 + VG_TOPIC_N + n + 1;
  memset(out, 0, sizeof *out);
  out->option = vg_calloc(room, sizeof *out->option);
  out->text = vg_calloc(2 * room, sizeof *out->text);
  if (!out->option || !out->text) {
    vg_cli_options_free(out);
    return vg_fail_memory(err, "the options");
  }
  memcpy(out->option, own, n_own * sizeof *own);
  out->n = n_own;
  add_title(out, "Most used options (settings override those of the deck):",
            VG_GROUP_COMMON);
  for (size_t i = 0; i < n_own; i++) has_own |= own[i].group == VG_GROUP_OWN;
  if (has_own) add_title(out, "The run and its reports:", VG_GROUP_OWN);
  for (int t = VG_TOPIC_SIZES; t < VG_TOPIC_N; t++)
    add_title(out, topic_title[t], VG_GROUP_TOPIC + t);
  vg_settings_default(&defaults);
  for (size_t i = 0; (p = vg_settings_name(i, &name, &in_farfield)); i++)
    bad |= add_option(out, p, name, VG_KEY_SETTING + (int)i,
                      in_farfield ? (void *)&defaults.farfield
                                  : (void *)&defaults,
                      VG_GROUP_TOPIC + (int)vg_param_topic(p, in_farfield));
  if (!bad) return VG_OK;
  vg_cli_options_free(out);
  return vg_fail_memory(err, "the options");
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

/* A message of a member of a table, as `kind` of the farfield, does not contain
 * the name of its option. */
static void refuse_value(int key, const struct vg_error *err,
                         const struct argp_state *state)
{
  const char *name;
  int in_farfield;
  const struct vg_param *p = vg_settings_name((size_t)(key - VG_KEY_SETTING),
                                              &name, &in_farfield);
  char option[64];

  snprintf(option, sizeof option, "%s", name);
  for (char *c = option; *c; c++)
    if (*c == '_') *c = '-';
  if (!strcmp(p->name, name)) argp_error(state, "%s", err->text);
  else argp_error(state, "--%s: %s", option, err->text);
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
  if (st < 0) refuse_value(key, &err, state);
  if (vg_reserve(&kept->set, &kept->cap, kept->n + 1, sizeof *kept->set))
    return ENOMEM;
  kept->set[kept->n].key = key;
  kept->set[kept->n++].text = text;
  return 0;
}

/* Two options of which one would silently replace the other. */
static vg_status refuse_pairs(const struct vg_cli_overrides *kept,
                              struct vg_error *err)
{
  const struct vg_param *p[2];
  const char *name[2];
  int far[2];

  for (size_t i = 0; i < kept->n; i++)
    for (size_t k = 0; k < i; k++) {
      p[0] = vg_settings_name((size_t)(kept->set[k].key - VG_KEY_SETTING),
                              &name[0], &far[0]);
      p[1] = vg_settings_name((size_t)(kept->set[i].key - VG_KEY_SETTING),
                              &name[1], &far[1]);
      if (far[0] || far[1] || !vg_settings_exclude(p[0], p[1])) continue;
      return vg_fail(err, VG_ERR_INPUT,
                     "the options for %s and %s are both given, and one would "
                     "replace the other; give one",
                     name[0], name[1]);
    }
  return VG_OK;
}

vg_status vg_cli_apply(const struct vg_cli_overrides *kept,
                       struct vg_settings *s, struct vg_error *err)
{
  vg_status st = refuse_pairs(kept, err);

  for (size_t i = 0; i < kept->n && st >= 0; i++)
    st = set_option(kept->set[i].key, kept->set[i].text, s, err);
  if (st >= 0) st = vg_settings_check(s, err);
  if (st == VG_ERR_INPUT && err) err->code = VG_ERR_USAGE;
  return st == VG_ERR_INPUT ? VG_ERR_USAGE : st;
}

int vg_cli_split(int *argc, char **argv, char ***rest)
{
  for (int i = 1; i < *argc; i++) {
    const int n = *argc - i - 1;

    if (strcmp(argv[i], "--") != 0) continue;
    *rest = argv + i + 1;
    *argc = i;
    return n;
  }
  return 0;
}
