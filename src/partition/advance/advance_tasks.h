/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/advance/advance_tasks.h: the tasks of the advancing partition for
 * the engine. Private to advance*.c. */
#ifndef VG_PARTITION_ADVANCE_ADVANCE_TASKS_H
#define VG_PARTITION_ADVANCE_ADVANCE_TASKS_H

#include "partition/cut/node.h"
#include "partition/engine/engine.h"

/** user: struct vg_partition. */
extern const struct vg_engine_ops vg_tasks_ops;

/** Makes the first task of a void, which it takes over. VG_ERR_MEMORY. */
vg_status vg_tasks_first(struct vg_partition *p, struct vg_node *n,
                         struct vg_task *t, struct vg_error *err);

#endif
