/* partition/bytes.h: where base/bytes.h came from. */
#ifndef VG_PARTITION_BYTES_H
#define VG_PARTITION_BYTES_H

#include "base/bytes.h"

#endif
