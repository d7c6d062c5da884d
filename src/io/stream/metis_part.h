/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/metis_part.h: subdomains of cells in the files that METIS's
 * programs write, STEM.part.N. Each line holds the subdomain number of a cell,
 * counted from 0, in the order of the cells. */
#ifndef VG_IO_STREAM_METIS_PART_H
#define VG_IO_STREAM_METIS_PART_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** Write the file for part [n]. It appears complete or not at all.
 * VG_ERR_IO. */
vg_status vg_metis_part_write(const char *path, size_t n, const uint32_t *part,
                              struct vg_error *err);

/** Size of the file in bytes. */
uint64_t vg_metis_part_bytes(size_t n, const uint32_t *part);

/** Write the lines into an open file. */
struct vg_output;
void vg_metis_part_put(struct vg_output *out, size_t n, const uint32_t *part);

#endif
