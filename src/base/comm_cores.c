/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cores of a node, and which ranks may use them; see base/comm.h. The only file
 * that includes hwloc.h: the kernel knows which processors a process may use,
 * hwloc which of them are hyperthreads of one core. */
#define _GNU_SOURCE
#include <hwloc.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/comm_parts.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/library.h"

#define BITS (8 * sizeof(unsigned long))
#define WORDS (sizeof(struct vg_cores_mask) / sizeof(unsigned long))

/* Affinity of this process; all zero if the kernel does not provide it. */
static void own_mask(struct vg_cores_mask *m)
{
  memset(m, 0, sizeof *m);
  if (sched_getaffinity(0, sizeof *m, (cpu_set_t *)m->word))
    memset(m, 0, sizeof *m);
}

static int n_processors(const struct vg_cores_mask *m)
{
  int n = 0;

  for (size_t i = 0; i < WORDS; i++) n += __builtin_popcountl(m->word[i]);
  return n;
}

/* Number of cores with a processor in m; 0: unknown. */
static int topology_cores(hwloc_topology_t topology,
                          const struct vg_cores_mask *m)
{
  hwloc_bitmap_t set = hwloc_bitmap_alloc();
  hwloc_obj_t core = NULL;
  int n = 0;

  if (!set) return 0;
  for (unsigned i = 0; i < WORDS * BITS; i++)
    if (m->word[i / BITS] >> (i % BITS) & 1) hwloc_bitmap_set(set, i);
  while ((core = hwloc_get_next_obj_by_type(topology, HWLOC_OBJ_CORE, core)))
    n += core->cpuset && hwloc_bitmap_intersects(core->cpuset, set);
  hwloc_bitmap_free(set);
  return n;
}

/* Number of cores in m, at least 1. Without information from hwloc, each
 * processor counts as a core. */
static int n_cores(const struct vg_cores_mask *m)
{
  hwloc_topology_t topology;
  int n = 0, most = n_processors(m);

  if (!most) return vg_cores();
  if (!hwloc_topology_init(&topology)) {
    hwloc_topology_set_all_types_filter(topology, HWLOC_TYPE_FILTER_KEEP_NONE);
    hwloc_topology_set_type_filter(topology, HWLOC_OBJ_CORE,
                                   HWLOC_TYPE_FILTER_KEEP_ALL);
    if (!hwloc_topology_load(topology)) n = topology_cores(topology, m);
    hwloc_topology_destroy(topology);
  }
  return n > 0 && n < most ? n : most;
}

vg_status vg_comm_cores_open(struct vg_comm *c, struct vg_error *err)
{
  struct vg_cores_mask own;
  MPI_Request request;
  vg_status st;
  int rc;

  c->core = vg_alloc((size_t)c->node_size, sizeof *c->core);
  st = c->core ? VG_OK : vg_fail_memory(err, "the binding of ranks");
  if ((st = vg_comm_agree_in(c, c->all, st, err)) < 0) return st;
  own_mask(&own);
  rc = MPI_Iallgather(&own, (int)sizeof own, MPI_BYTE, c->core, (int)sizeof own,
                      MPI_BYTE, c->node, &request);
  if (!rc) rc = vg_comm_wait(1, &request, 0);
  return rc ? vg_comm_fail(err, "cannot join the node", rc) : VG_OK;
}

void vg_comm_bind_node(struct vg_comm *c, int on)
{
  struct vg_cores_mask m;

  if (!c) return;
  m = c->core[c->node_rank];
  for (int i = 0; on && i < c->node_size; i++)
    for (size_t w = 0; w < WORDS; w++) m.word[w] |= c->core[i].word[w];
  /* If the call fails, the binding stays as it is. */
  if (n_processors(&m)) sched_setaffinity(0, sizeof m, (cpu_set_t *)m.word);
}

int vg_comm_node_cores(struct vg_comm *c, int on)
{
  struct vg_cores_mask m = { { 0 } };

  vg_comm_bind_node(c, on);
  own_mask(&m);
  return n_cores(&m);
}

int vg_comm_default_threads(const struct vg_comm *c)
{
  struct vg_cores_mask m;
  int n_same = 0, n;

  if (c) m = c->core[c->node_rank];
  else own_mask(&m);
  for (int i = 0; c && i < c->node_size; i++)
    n_same += !memcmp(&m, &c->core[i], sizeof m);
  n = n_cores(&m) / (n_same > 1 ? n_same : 1);
  return n > 1 ? n : 1;
}

void vg_library_hwloc(struct vg_library *out)
{
  unsigned v = hwloc_get_api_version();

  out->name = "hwloc";
  snprintf(out->version, sizeof out->version, "%u.%u.%u", v >> 16,
           v >> 8 & 0xff, v & 0xff);
}
