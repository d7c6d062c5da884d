/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Connected components of the surface, and consistent orientation. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"

/* Half-edge opposite h if its edge has two faces, else UINT32_MAX. */
static uint32_t opposite(const struct vg_edges *e, uint32_t h)
{
  uint32_t edge = e->of_half[h], at;

  if (edge == UINT32_MAX) return UINT32_MAX;
  at = e->start[edge];
  if (e->start[edge + 1] - at != 2) return UINT32_MAX;
  return e->half[at] == h ? e->half[at + 1] : e->half[at];
}

/* Walk from `seed` over manifold edges. queue[0 .. n) are the faces of the
 * component, turn[] their orientation relative to the seed (2: not visited).
 * Returns n, and whether two paths contradict each other. */
static size_t walk(const struct vg_faces *s, const struct vg_edges *e,
                   uint32_t seed, uint32_t *queue, uint8_t *turn,
                   int *is_one_sided)
{
  size_t n = 1;

  *is_one_sided = 0;
  queue[0] = seed;
  turn[seed] = 0;
  for (size_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < 3; k++) {
      uint32_t g = 3 * queue[i] + k, h = opposite(e, g);
      uint8_t want;

      if (h == UINT32_MAX) continue;
      want = turn[g / 3] ^ (s->node[g / 3][g % 3] == s->node[h / 3][h % 3]);
      if (turn[h / 3] == 2) {
        turn[h / 3] = want;
        queue[n++] = h / 3;
      } else if (turn[h / 3] != want) {
        *is_one_sided = 1;
      }
    }
  return n;
}

vg_status vg_orient_faces(const struct vg_faces *s, const struct vg_edges *e,
                          uint8_t *flip, struct vg_error *err)
{
  assert(flip || !s->n);

  uint32_t *queue = vg_alloc(s->n, sizeof *queue);
  uint8_t *turn = vg_alloc(s->n, 1);

  if (!queue || !turn) {
    free(queue);
    free(turn);
    return vg_fail_memory(err, "the orientation of the surface");
  }
  memset(turn, 2, s->n);
  for (size_t f = 0; f < s->n; f++) {
    size_t n, n_turned = 0;
    int is_one_sided;

    if (turn[f] != 2 || s->state[f] & VG_FACE_OUT) continue;
    n = walk(s, e, (uint32_t)f, queue, turn, &is_one_sided);
    if (is_one_sided) continue;
    for (size_t i = 0; i < n; i++) n_turned += turn[queue[i]];
    for (size_t i = 0; i < n; i++)
      flip[queue[i]] ^= turn[queue[i]] ^ (n_turned > n - n_turned);
  }
  free(queue);
  free(turn);
  return VG_OK;
}

static uint32_t *each_alone(size_t n)
{
  uint32_t *up = vg_alloc(n, sizeof *up);

  for (size_t i = 0; up && i < n; i++) up[i] = (uint32_t)i;
  return up;
}

vg_status vg_label_fans(const struct vg_faces *s, const struct vg_edges *e,
                        uint32_t (**fan)[3], struct vg_error *err)
{
  uint32_t *up = each_alone(3 * s->n);

  if (!up) return vg_fail_memory(err, "the umbrellas of the surface");
  for (size_t i = 0; i < e->n; i++) {
    uint32_t g = e->half[e->start[i]];

    for (uint32_t k = e->start[i] + 1; k < e->start[i + 1]; k++) {
      uint32_t h = e->half[k];
      int same_way = s->node[g / 3][g % 3] == s->node[h / 3][h % 3];

      vg_union(up, g, same_way ? h : vg_half_next(h));
      vg_union(up, vg_half_next(g), same_way ? vg_half_next(h) : h);
    }
  }
  for (uint32_t i = 0; i < 3 * s->n; i++) up[i] = vg_root_of(up, i);
  *fan = (uint32_t(*)[3])up;
  return VG_OK;
}

vg_status vg_count_components(const struct vg_faces *s, size_t *n_piece,
                              struct vg_error *err)
{
  uint32_t *up = each_alone(s->n_point);
  uint8_t *used = vg_calloc(s->n_point, 1);

  if (!up || !used) {
    free(up);
    free(used);
    return vg_fail_memory(err, "the pieces of the surface");
  }
  for (size_t f = 0; f < s->n; f++) {
    const uint32_t *n = s->node[f];

    vg_union(up, n[0], n[1]);
    vg_union(up, n[0], n[2]);
    used[n[0]] = used[n[1]] = used[n[2]] = 1;
  }
  *n_piece = 0;
  for (size_t p = 0; p < s->n_point; p++) *n_piece += used[p] && up[p] == p;
  free(up);
  free(used);
  return VG_OK;
}

vg_status vg_label_shells(const struct vg_faces *s, const struct vg_edges *e,
                          uint32_t *shell, size_t *n_shell,
                          struct vg_error *err)
{
  uint32_t *up = each_alone(s->n), n = 0;

  if (!up) return vg_fail_memory(err, "the shells of the surface");
  for (size_t i = 0; i < e->n; i++)
    for (uint32_t k = e->start[i] + 1; k < e->start[i + 1]; k++)
      vg_union(up, e->half[k - 1] / 3, e->half[k] / 3);
  for (size_t f = 0; f < s->n; f++) { /* a root is the lowest of its shell */
    uint32_t r = vg_root_of(up, (uint32_t)f);

    if (s->state[f] & VG_FACE_OUT) shell[f] = UINT32_MAX;
    else shell[f] = r == f ? n++ : shell[r];
  }
  free(up);
  *n_shell = n;
  return VG_OK;
}
