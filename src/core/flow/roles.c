/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The role of a patch, by its condition or its name. Declared in
 * core/flow/flow.h. */
#include <ctype.h>
#include <string.h>

#include "core/flow/evidence.h"

struct code_range {
  int32_t first, last;
  enum vg_flow_role role;
};

/* Codes of formats.md 1.4 and 1.5. Those of USM3D end at 11,111. */
static const struct code_range codes[] = {
  { 0, 0, VG_ROLE_FARFIELD }, /* USM3D freestream */
  { 1, 1, VG_ROLE_SYMMETRY },
  { 2, 3, VG_ROLE_FARFIELD }, /* extrapolation, characteristic */
  { 4, 5, VG_ROLE_WALL },
  { 41, 55, VG_ROLE_WALL },     /* moving walls, blunt bases */
  { 101, 101, VG_ROLE_OUTLET }, /* outflow, fan face */
  { 102, 103, VG_ROLE_INLET },  /* inflow, jet */
  { 1001, 1001, VG_ROLE_INLET },
  { 1002, 1002, VG_ROLE_OUTLET },
  { 11002, 11003, VG_ROLE_OUTLET },
  { 3000, 4999, VG_ROLE_WALL }, /* FUN3D */
  { 5000, 5050, VG_ROLE_FARFIELD },
  { 5051, 5052, VG_ROLE_OUTLET },
  { 5053, 5999, VG_ROLE_FARFIELD },
  { 6000, 6999, VG_ROLE_SYMMETRY },
  { 7011, 7011, VG_ROLE_INLET },
  { 7012, 7012, VG_ROLE_OUTLET },
  { 7021, 7035, VG_ROLE_OUTLET },
  { 7036, 7041, VG_ROLE_INLET },
  { 7100, 7105, VG_ROLE_INLET },
};

static enum vg_flow_role by_code(int32_t code)
{
  if (code < 0) code = -code; /* weak forms of FUN3D */
  for (size_t i = 0; i < sizeof codes / sizeof *codes; i++)
    if (code >= codes[i].first && code <= codes[i].last) return codes[i].role;
  return VG_ROLE_OTHER;
}

struct word {
  const char *text;
  int is_whole;
  enum vg_flow_role role;
};

/* A word counts anywhere in a name, or only between blanks, digits and
 * punctuation. */
static const struct word words[] = {
  { "inlet", 0, VG_ROLE_INLET },        { "inflow", 0, VG_ROLE_INLET },
  { "outlet", 0, VG_ROLE_OUTLET },      { "outflow", 0, VG_ROLE_OUTLET },
  { "farfield", 0, VG_ROLE_FARFIELD },  { "far_field", 0, VG_ROLE_FARFIELD },
  { "far-field", 0, VG_ROLE_FARFIELD }, { "freestream", 0, VG_ROLE_FARFIELD },
  { "far", 1, VG_ROLE_FARFIELD },       { "symmetry", 0, VG_ROLE_SYMMETRY },
  { "symplane", 0, VG_ROLE_SYMMETRY },  { "symm", 1, VG_ROLE_SYMMETRY },
  { "sym", 1, VG_ROLE_SYMMETRY },       { "wall", 0, VG_ROLE_WALL },
};

/* Names of enclosures: evidence only for a shell with others inside it. */
static const char *const enclosures[] = { "tunnel", "domain", "enclosure",
                                          "outer_boundary" };

static int has_word(const char *name, const char *word, int is_whole)
{
  const size_t n = strlen(word);

  for (const char *at = name; (at = strstr(at, word)); at++)
    if (!is_whole || ((at == name || !isalpha((unsigned char)at[-1])) &&
                      !isalpha((unsigned char)at[n])))
      return 1;
  return 0;
}

static void lower_case(const char *name, char *out, size_t size)
{
  size_t n = 0;

  for (; name[n] && n + 1 < size; n++)
    out[n] = (char)tolower((unsigned char)name[n]);
  out[n] = 0;
}

/* The name of a cap over a hole (core/domain/holes.c) is no evidence for the
 * flow through it. */
static int is_cap_name(const char *name)
{
  if (strncmp(name, "cap_", 4) != 0 || !name[4]) return 0;
  for (name += 4; *name; name++)
    if (!isdigit((unsigned char)*name)) return 0;
  return 1;
}

enum vg_flow_role vg_flow_role_of(const struct vg_patch *p)
{
  char name[VG_NAME_MAX];

  if (p->bc_fun3d != VG_BC_NONE && p->bc_fun3d != p->bc &&
      by_code(p->bc_fun3d) != VG_ROLE_OTHER)
    return by_code(p->bc_fun3d);
  if (p->bc != VG_BC_NONE) return by_code(p->bc);
  lower_case(p->name, name, sizeof name);
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (has_word(name, words[i].text, words[i].is_whole)) return words[i].role;
  return *name && !is_cap_name(name) ? VG_ROLE_OTHER : VG_ROLE_NONE;
}

int vg_flow_is_enclosure(const struct vg_patch *p)
{
  char name[VG_NAME_MAX];

  lower_case(p->name, name, sizeof name);
  for (size_t i = 0; i < sizeof enclosures / sizeof *enclosures; i++)
    if (has_word(name, enclosures[i], 0)) return 1;
  return 0;
}
