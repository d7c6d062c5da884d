/* io/stream/metis_part.h: parts of cells as METIS's programs write them, in
 * STEM.part.N: a line with the number of its part, from 0, for each cell, in
 * the order of the cells. */
#ifndef VG_IO_STREAM_METIS_PART_H
#define VG_IO_STREAM_METIS_PART_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** part: [n]. The file appears complete or not at all. VG_ERR_IO. */
vg_status vg_metis_part_write(const char *path, size_t n, const uint32_t *part,
                              struct vg_error *err);

/** Bytes that such lines take. */
uint64_t vg_metis_part_bytes(size_t n, const uint32_t *part);

/** Such lines into an open file. */
struct vg_output;
void vg_metis_part_put(struct vg_output *out, size_t n, const uint32_t *part);

#endif
