/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cmake/no_mpi/mpi.h: takes the place of MPI's header in a build with
 * VG_MPI=OFF. A job of one rank never calls MPI. Under a launcher the program
 * asks MPI to start, which fails here with an explanation; all other functions
 * are never called. */
#ifndef VG_NO_MPI_H
#define VG_NO_MPI_H

#include <stdio.h>

typedef int MPI_Comm, MPI_Request, MPI_Message, MPI_Group, MPI_Datatype, MPI_Op,
  MPI_Info, MPI_Fint, MPI_File;
typedef long long MPI_Offset;
typedef struct {
  int MPI_SOURCE, MPI_TAG;
} MPI_Status;

enum {
  MPI_SUCCESS,
  MPI_ERR_OTHER,
  MPI_ERR_NO_MEM,
  MPI_ERR_COUNT,
  MPI_THREAD_SINGLE = 0,
  MPI_THREAD_MULTIPLE = 3,
  MPI_COMM_NULL = 0,
  MPI_COMM_WORLD = 1,
  MPI_COMM_TYPE_SHARED = 1,
  MPI_REQUEST_NULL = 0,
  MPI_GROUP_NULL = 0,
  MPI_INFO_NULL = 0,
  MPI_ERRORS_RETURN = 0,
  MPI_UNDEFINED = -1,
  MPI_ANY_SOURCE = -1,
  MPI_ANY_TAG = -1,
  MPI_MODE_WRONLY = 1,
  MPI_BYTE = 1,
  MPI_INT,
  MPI_UINT64_T,
  MPI_UINT32_T,
  MPI_DOUBLE,
  MPI_SUM,
  MPI_MIN,
  MPI_MAX,
  MPI_LOR,
  MPI_MAX_ERROR_STRING = 255,
  MPI_MAX_LIBRARY_VERSION_STRING = 255
};
#define MPI_IN_PLACE ((void *)-1)
#define MPI_STATUS_IGNORE ((MPI_Status *)0)
#define MPI_STATUSES_IGNORE ((MPI_Status *)0)

static inline int vg_no_mpi(int rc, ...)
{
  return rc;
}

static inline int vg_no_mpi_set(int *to, int value)
{
  *to = value;
  return MPI_SUCCESS;
}

static inline int vg_no_mpi_text(char *to, int *n, const char *text)
{
  *n = snprintf(to, MPI_MAX_ERROR_STRING, "%s", text);
  return MPI_SUCCESS;
}

#define MPI_Finalized(is) vg_no_mpi_set(is, 0)
#define MPI_Initialized(is) vg_no_mpi_set(is, 0)
#define MPI_Query_thread(level) vg_no_mpi_set(level, MPI_THREAD_MULTIPLE)
#define MPI_Error_string(rc, text, n)                                          \
  ((void)(rc), vg_no_mpi_text(text, n,                                         \
                              "this build has no MPI (it was configured "     \
                              "with VG_MPI=OFF); run it without a launcher"))
#define MPI_Get_library_version(text, n)                                       \
  vg_no_mpi_text(text, n, "not in this build (VG_MPI=OFF)")
#define MPI_Comm_f2c(handle) ((MPI_Comm)(handle))
#define MPI_Comm_rank(comm, at) ((void)(comm), vg_no_mpi_set(at, 0))
#define MPI_Comm_size(comm, at) ((void)(comm), vg_no_mpi_set(at, 1))

/* clang-format off */
#define MPI_Abort(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Allgather(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Cancel(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_dup(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_free(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_group(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_set_errhandler(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_split(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Comm_split_type(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_File_close(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_File_open(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_File_write_at(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Finalize() vg_no_mpi(MPI_ERR_OTHER)
#define MPI_Get_count(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Group_free(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Group_translate_ranks(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Iallgather(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Iallgatherv(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Iallreduce(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Ibarrier(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Ibcast(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Improbe(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Imrecv(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Init_thread(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Irecv(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Isend(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Issend(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Mrecv(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Test(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Testall(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Testsome(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Type_commit(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Type_contiguous(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Type_free(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
#define MPI_Waitall(...) vg_no_mpi(MPI_ERR_OTHER, __VA_ARGS__)
/* clang-format on */

#endif
