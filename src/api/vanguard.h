/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard/vanguard.h: the Vanguard library. It takes a surface triangulation
 * and returns a volume mesh.
 *
 *   vanguard_job *job;
 *   vanguard_new(VANGUARD_ABI, &job);
 *   vanguard_surface(job, "wing", n_point, xyz, n_tri, tri, NULL);
 *   vanguard_set(job, "growth", "1.3");
 *   if (vanguard_mesh(job, NULL, NULL)) puts(vanguard_message(job));
 *   vanguard_write(job, "wing", "b8.ugrid,vtu");
 *   vanguard_free(job);
 *
 * Errors. Functions that can fail return a vanguard_status, 0 on success. After
 * a failure, vanguard_message describes the problem, its location and a remedy.
 * The library never prints and never ends the process. A failed call leaves the
 * job unchanged, except that a failed vanguard_mesh discards the old mesh.
 * Calls in the wrong order, NULL for a job or for an argument that is needed,
 * an index that is out of range, and a structure without VANGUARD_INIT give
 * VANGUARD_ERR_USAGE (or 0, NULL or "").
 *
 * Numbering and units. Points and patches are numbered from 0. Coordinates are
 * in the length unit of the surface. The mesh depends only on the input and the
 * settings: it is the same for any number of ranks and threads.
 *
 * Threads. Only one call at a time uses a job, with the exception of
 * vanguard_cancel, but the calls may come from different threads. While a call
 * runs, any other call with the same job, from another thread or from one of
 * its callbacks, changes nothing and returns VANGUARD_ERR_BUSY (or 0, NULL or
 * ""). Different jobs may be used by different threads at once. Meshing starts
 * its own threads (setting "threads").
 *
 * Ranks. All ranks of an MPI job must call the functions marked "Collective" in
 * the same order. Such a call succeeds on all ranks or fails on all ranks.
 *
 * Compatibility. Programs stay binary compatible as long as the library accepts
 * the VANGUARD_ABI they were compiled with. Every structure begins with its
 * size, which VANGUARD_INIT sets. New members are only appended, and the
 * library never writes beyond the size that the caller passed. */
#ifndef VANGUARD_VANGUARD_H
#define VANGUARD_VANGUARD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined __GNUC__
#define VANGUARD_API __attribute__((visibility("default")))
#else
#define VANGUARD_API
#endif

#define VANGUARD_ABI 1

typedef enum {
  VANGUARD_OK = 0,
  VANGUARD_ERR_INPUT = -1,       /* inconsistent data or settings */
  VANGUARD_ERR_FORMAT = -2,      /* a file violates its format */
  VANGUARD_ERR_IO = -3,          /* the system could not read or write */
  VANGUARD_ERR_MEMORY = -4,      /* not enough memory */
  VANGUARD_ERR_GEOMETRY = -5,    /* the surface cannot bound a mesh */
  VANGUARD_ERR_UNSUPPORTED = -6, /* valid, but not supported by this build */
  VANGUARD_ERR_REMOTE = -7,      /* another rank failed */
  VANGUARD_ERR_USAGE = -8,       /* the call is not valid in this state */
  VANGUARD_ERR_STOPPED = -9,     /* stopped by vanguard_cancel or progress */
  VANGUARD_ERR_BUSY = -10        /* another call uses the job */
} vanguard_status;

/** Opaque handle: the settings, a surface and, after vanguard_mesh, a mesh. */
typedef struct vanguard_job vanguard_job;

/* Initialiser of all structures with a struct_size:
 * struct vanguard_counts n = VANGUARD_INIT(n); */
#define VANGUARD_INIT(name)                                                    \
  {                                                                            \
    .struct_size = sizeof(name)                                                \
  }

/* --- the library --------------------------------------------------------- */

/** Version of the library, such as "0.2.0". Static string. */
VANGUARD_API const char *vanguard_version(void);

/** The newest VANGUARD_ABI that this library supports. */
VANGUARD_API int vanguard_abi(void);

/** Fork the small server process that later starts the child processes for
 * TetGen and METIS. Optional; call it at the start of the program, before any
 * threads or MPI are started. Without it, these children are forked from the
 * program itself when they are needed, which takes longer the more memory the
 * program uses. A second call does nothing.
 * VANGUARD_ERR_MEMORY: the system refused to fork; the library works as if the
 * function had not been called. */
VANGUARD_API vanguard_status vanguard_prepare(void);

/* --- jobs ---------------------------------------------------------------- */

/** Create a job for this process alone, with default settings and no surface.
 *
 * @param abi  VANGUARD_ABI
 * @param out  the new job, to be freed with vanguard_free. After a failure it
 *             is set as well, so that vanguard_message can describe the error;
 *             it is NULL only if there is not enough memory.
 * VANGUARD_ERR_UNSUPPORTED: the library does not support this ABI. */
VANGUARD_API vanguard_status vanguard_new(int abi, vanguard_job **out);

/** Create a job for all ranks of a communicator, which mesh together. MPI must
 * have been initialised with MPI_THREAD_MULTIPLE. Collective.
 *
 * @param comm  address of an MPI_Comm, which is duplicated. It must belong to
 *              the MPI library that Vanguard was built with. The _fortran
 *              variant takes a Fortran handle (MPI_Comm_c2f) instead. */
VANGUARD_API vanguard_status vanguard_new_mpi(int abi, const void *comm,
                                              vanguard_job **out);
VANGUARD_API vanguard_status vanguard_new_fortran(int abi, int32_t comm,
                                                  vanguard_job **out);

/** Free a job and its mesh. Accepts NULL. Collective.
 * VANGUARD_ERR_BUSY: another call uses the job, which is not freed. */
VANGUARD_API vanguard_status vanguard_close(vanguard_job *job);

/** As vanguard_close, without its result. */
VANGUARD_API void vanguard_free(vanguard_job *job);

/** Error message of the last call that failed; "" if none has failed. While a
 * call uses the job, and in a thread whose last call was refused with
 * VANGUARD_ERR_BUSY, the message of that status. Valid until the next call with
 * this job. Accepts NULL (no job). */
VANGUARD_API const char *vanguard_message(const vanguard_job *job);

/** Report on the surface after vanguard_mesh, in lines of text: the repairs
 * made and, if the surface cannot bound a mesh, every kind of defect with its
 * first locations. Valid until the next vanguard_mesh. Available on the first
 * rank of each node; "" on the others. */
VANGUARD_API const char *vanguard_details(const vanguard_job *job);

/** Text of note i of vanguard_mesh: an assumption made, an oddity found or
 * something left out. NULL when i is past the last note. Valid until the next
 * vanguard_mesh. */
VANGUARD_API const char *vanguard_note(const vanguard_job *job, size_t i);

/* --- settings ------------------------------------------------------------ */

/** Set one setting. Names and values are those of run decks and of the
 * command-line options: "growth" "1.2", "layers" "yes", "write" "b8.ugrid". */
VANGUARD_API vanguard_status vanguard_set(vanguard_job *job, const char *name,
                                          const char *value);

/** Copy the value of a setting, as text, into an array of `size` characters;
 * 512 are always enough. VANGUARD_ERR_USAGE: the value does not fit. */
VANGUARD_API vanguard_status vanguard_get(vanguard_job *job, const char *name,
                                          char *value, size_t size);

/** Add a row to one of the deck's tables: "sources", "patches" or "layers". The
 * table "farfield" has a single row, which is replaced. The row is given by n
 * column names, as in the deck, and their values; the other columns keep their
 * defaults. For example, columns { "kind", "x0", "r0", "h0" } and values
 * { "sphere", "0.5", "0.2", "0.01" } add a row to "sources". */
VANGUARD_API vanguard_status vanguard_add(vanguard_job *job, const char *table,
                                          size_t n, const char *const *column,
                                          const char *const *value);

/** Apply all settings and table rows of a deck, given as text. */
VANGUARD_API vanguard_status vanguard_deck(vanguard_job *job, const char *text);

/** Description of a setting. All strings are static. */
struct vanguard_setting {
  size_t struct_size;
  const char *name, *unit, *help;
  const char *kind;         /* "real", "count", "flag", "word" or "text" */
  const char *const *words; /* of a "word": NULL-terminated; else NULL */
  double least, most;       /* range of a number */
};

/** Describe setting i. Returns 1, or 0 when i is past the last setting. */
VANGUARD_API int vanguard_setting(size_t i, struct vanguard_setting *out);

/* --- input --------------------------------------------------------------- */

/** Open a project, or a surface file given by its full name, as
 * `vanguard mesh -p PROJECT --deck DECK` does. All settings are reset to the
 * defaults and the values of the deck, so call vanguard_set after this
 * function. The files themselves are read by vanguard_mesh.
 *
 * @param deck  NULL: PROJECT.deck, if that file exists */
VANGUARD_API vanguard_status vanguard_open(vanguard_job *job,
                                           const char *project,
                                           const char *deck);

/** Use a surface from memory, which is copied. All ranks must pass the same
 * surface. It is either closed or half of a symmetric body. Triangles are
 * counter-clockwise seen from the fluid.
 *
 * @param name   name of the surface in messages and files
 * @param xyz    [n_point][3] coordinates
 * @param tri    [n_tri][3] point numbers
 * @param patch  [n_tri] patch id of each triangle, any integers; NULL: all
 *               triangles belong to patch 1. Names and boundary conditions are
 *               set by vanguard_add(job, "patches", ...).
 * VANGUARD_ERR_INPUT: a point number is out of range; the message names the
 * triangle. */
VANGUARD_API vanguard_status vanguard_surface(vanguard_job *job,
                                              const char *name, size_t n_point,
                                              const double *xyz, size_t n_tri,
                                              const uint32_t *tri,
                                              const int32_t *patch);

/** User-defined target edge length at x: a value above 0, or INFINITY where the
 * function sets no limit. */
typedef double vanguard_size_function(void *user, const double x[3]);

/** Add a user-defined size function to the sizing field. At each point the
 * smallest of the sizes from surface, sources and function holds, and the
 * growth limit applies to all of them. Features of the function that are
 * narrower than 1/32 of the domain's bounding box are only found where other
 * sizes are small. This replaces the sizes given before by this function or
 * those below, and vice versa; NULL removes the function.
 *
 * @param size  called by several threads at once during vanguard_mesh; its
 *              result must depend on x alone and be the same on all ranks */
VANGUARD_API vanguard_status vanguard_sizes(vanguard_job *job,
                                            vanguard_size_function *size,
                                            void *user);

/** Add target edge lengths at points to the sizing field. From each point the
 * size grows at the rate of the setting "growth". The arrays are copied. This
 * replaces the sizes given before, and vice versa; n = 0 removes the points.
 *
 * @param xyz   [n][3] coordinates
 * @param size  [n] edge lengths, finite and above 0
 * VANGUARD_ERR_INPUT: a value is invalid; the message names the point. */
VANGUARD_API vanguard_status vanguard_size_points(vanguard_job *job, size_t n,
                                                  const double *xyz,
                                                  const double *size);

/** User-defined metric at x, for target edge lengths that depend on the
 * direction. m out: xx, xy, xz, yy, yz, zz of a symmetric positive tensor M. An
 * edge e has its target length if e' M e = 1: the eigenvalues are 1 / length^2,
 * and the eigenvectors are the directions of these lengths. All zero where the
 * function sets no limit. */
typedef void vanguard_metric_function(void *user, const double x[3],
                                      double m[6]);

/** Add a user-defined metric function to the sizing field. At each point the
 * intersection of the metrics of surface, sources and function holds, limited
 * by the settings "growth" and "aspect_max". For narrow features, as for
 * threads and ranks, see vanguard_sizes. This replaces the sizes given before,
 * and vice versa; NULL removes the function. */
VANGUARD_API vanguard_status vanguard_metrics(vanguard_job *job,
                                              vanguard_metric_function *metric,
                                              void *user);

/** Add metrics at the points of a background mesh to the sizing field. Within
 * its tetrahedra, the tensor of sizes M^(-1/2) is interpolated linearly;
 * elsewhere, that at their nearest point, or without tetrahedra that of the
 * nearest given point, grows beyond one edge length at the rate of the setting
 * "growth". The arrays are copied. This replaces the sizes given
 * before, and vice versa; n = 0 removes the points.
 *
 * @param xyz     [n][3] coordinates
 * @param metric  [n][6] xx, xy, xz, yy, yz, zz (vanguard_metric_function), all
 *                positive
 * @param n_tet   number of tetrahedra; may be 0
 * @param tet     [n_tet][4] point numbers, from 0, in any orientation
 * VANGUARD_ERR_INPUT: a value is invalid; the message names the point or the
 * tetrahedron. */
VANGUARD_API vanguard_status vanguard_metric_points(vanguard_job *job, size_t n,
                                                    const double *xyz,
                                                    const double *metric,
                                                    size_t n_tet,
                                                    const uint32_t *tet);

/* --- meshing ------------------------------------------------------------- */

/** Progress callback. It is called from time to time, by the thread that called
 * vanguard_mesh or by another, but never by two threads at once. It is called
 * on every rank, except that only rank 0 calls it while the tetrahedra are
 * generated. A non-zero return value stops the run.
 *
 * @param phase     "read", "surface check", "sizing field", "layers", "fill",
 *                  "mesh check", ...
 * @param done      triangles, columns or cells finished so far; within a phase
 *                  neither this number nor the fraction ever decreases
 * @param expected  expected total; 0: not known */
typedef int vanguard_progress(void *user, const char *phase, uint64_t done,
                              uint64_t expected);

/** Generate the mesh. Any previous mesh of the job is discarded, even if the
 * call fails. `progress` may be NULL. Collective. */
VANGUARD_API vanguard_status vanguard_mesh(vanguard_job *job,
                                           vanguard_progress *progress,
                                           void *user);

/** Stop a running vanguard_mesh, vanguard_check, vanguard_make_surface,
 * vanguard_forecast or vanguard_write, which then returns VANGUARD_ERR_STOPPED
 * within about a second, on all ranks. Only formats that need the whole mesh in
 * one piece (vanguard_write) may take longer to write, and so may forecasts of
 * more than some ten million cells. Has no effect if none is running. May be
 * called by any thread and from a signal handler. */
VANGUARD_API void vanguard_cancel(vanguard_job *job);

/** Read, repair, remesh and complete the surface as vanguard_mesh does, decide
 * the flow domain, and plan the layers, without generating cells. The result is
 * success if vanguard_mesh would begin to generate cells, and otherwise its
 * error. vanguard_boundary, vanguard_details, vanguard_note and vanguard_report
 * describe the surface. Discards the mesh, as vanguard_mesh does. Collective.
 */
VANGUARD_API vanguard_status vanguard_check(vanguard_job *job,
                                            vanguard_progress *progress,
                                            void *user);

/** As vanguard_check, but for the surface alone: it is repaired, and remeshed
 * if the settings request it (remesh_surface), without a farfield, symmetry
 * plane or layers, and may have open edges. For jobs of one process.
 * VANGUARD_ERR_GEOMETRY: it has defects other than open edges. */
VANGUARD_API vanguard_status vanguard_make_surface(vanguard_job *job,
                                                   vanguard_progress *progress,
                                                   void *user);

/** Forecast of a mesh and of the run that makes it. Counts are expected numbers
 * and not rounded. */
struct vanguard_forecast {
  size_t struct_size;
  int32_t ranks, threads; /* machine of the forecast; threads of a rank */
  double n_cell, n_tet, n_pri, n_point;
  double n_layer_cell, n_layer_point; /* of these, in the layers */
  double n_wall_point;                /* points from which layers grow */
  int32_t has_grown_layers; /* 1: the layers were grown; 0: no layers were
                               requested, or they were estimated from the
                               growth law */
  size_t n_subdomain;       /* subdomains that one thread fills at a time */
  double seconds;           /* of the whole run on this machine */
  double work;              /* of one thread for the same run */
  /* Bytes of the rank that needs most: at most, in each of the stages, and the
   * part of which the ranks of a node have one copy. */
  double memory;
  double memory_surface, memory_sizes, memory_fill, memory_check;
  double memory_shared;
  const char *peak_stage; /* "surface", "sizes", "fill" or "check": the stage
                             of `memory` */
  double bytes_written;   /* files of the setting "write" */
};

/** Forecast the mesh and its run on another machine, or on this one, as
 * `vanguard plan` does. The surface is made as by vanguard_check, layers on up
 * to 50,000 wall points are grown, and the void is not filled: the cells follow
 * from the sizing field. Discards the mesh, as vanguard_mesh does;
 * vanguard_boundary, vanguard_details, vanguard_note and vanguard_report then
 * have the results of vanguard_check.
 *
 * Cells are within some per cent of those of the mesh. Times hold for cores on
 * which the built-in rates were measured (docs/reference/commands.md). Times of
 * the surface and the sizing field, and the memory of the program, are those of
 * this process. The call uses the setting "threads" here. For jobs of one
 * process, whatever `ranks` is.
 *
 * @param ranks    ranks of the run, on one node, 1 to 2^20 with all threads
 * @param threads  threads of a rank; 0: the setting "threads", or without it
 *                 the cores of this process
 * @param out      unchanged on failure
 * VANGUARD_ERR_INPUT: ranks or threads are out of range. The errors of
 * vanguard_check. */
VANGUARD_API vanguard_status vanguard_forecast(vanguard_job *job, int ranks,
                                               int threads,
                                               vanguard_progress *progress,
                                               void *user,
                                               struct vanguard_forecast *out);

/** Read a mesh from a file in one of the formats that `vanguard check` reads;
 * names and conditions of patches come from the setting "mapbc", or from
 * STEM.mapbc. The job then has this mesh instead of one of its own, for the
 * functions below except vanguard_write; it has one piece, no layers, and its
 * points and cells have the order of the file (n_boundary_point is 0 if
 * boundary points do not come first). vanguard_measure has its quality and
 * whether it is valid. Settings and input of the job do not change. For jobs of
 * one process. VANGUARD_ERR_INPUT: the file has no cells. After a failure the
 * job has no mesh. */
VANGUARD_API vanguard_status vanguard_read(vanguard_job *job, const char *file);

/* --- the surface --------------------------------------------------------- */
/* The functions below need the surface of vanguard_check, vanguard_forecast,
 * vanguard_make_surface or vanguard_mesh, which may have been refused for its
 * defects. They are available on the first rank of each node. Returned pointers
 * are valid until the next of these calls, vanguard_read or vanguard_free. */

struct vanguard_patch {
  size_t struct_size;
  int32_t id;           /* patch id in the input and in files */
  int32_t bc, bc_fun3d; /* USM3D and FUN3D condition; INT32_MIN: none */
  const char *name;     /* may be "" */
};

/** The surface, complete after vanguard_check and vanguard_mesh, and the flow
 * domain. */
struct vanguard_boundary {
  size_t struct_size;
  size_t n_point, n_tri, n_patch;
  const char *flow;     /* "external", "internal"; "unknown": not decided */
  size_t n_body;        /* bodies in the fluid */
  size_t n_outer;       /* given outer boundaries */
  size_t n_cavity;      /* sealed cavities that were dropped */
  int32_t half_axis;    /* half model: 0 to 2, axis of the symmetry plane; -1:
                           whole model */
  double half_at;       /* coordinate of that plane */
  int32_t is_remeshed;  /* 1: the surface was remeshed */
  int32_t has_farfield; /* 1: a farfield was added */
  int32_t has_symmetry; /* 1: a symmetry plane was added */
  size_t n_defect;      /* defects that are left, and the open edges of these */
  size_t n_open_edge;
};
VANGUARD_API vanguard_status vanguard_boundary(vanguard_job *job,
                                               struct vanguard_boundary *out);
VANGUARD_API vanguard_status vanguard_boundary_patch(
  vanguard_job *job, size_t i, struct vanguard_patch *out);

/** Copy the surface into arrays of the caller: coordinates [n_point][3], point
 * numbers [n_tri][3], and the patch of each triangle [n_tri] as an index for
 * vanguard_boundary_patch. Triangles are counter-clockwise seen from the fluid.
 * Arrays that are NULL are skipped. */
VANGUARD_API vanguard_status vanguard_boundary_arrays(vanguard_job *job,
                                                      double *xyz,
                                                      uint32_t *tri,
                                                      uint32_t *patch);

/** Report on the last vanguard_mesh, vanguard_check, vanguard_forecast,
 * vanguard_make_surface or vanguard_read, also if it has failed.
 *
 * @param form  "json": the members of the .report.json of `vanguard mesh`
 *              (docs/reference/programs.md) without "files"; after
 * vanguard_read those of `vanguard check --json`. "text": the report for people
 * @param out   the report, valid until the next call of this function or of one
 *              of those above; "" except on rank 0 */
VANGUARD_API vanguard_status vanguard_report(vanguard_job *job,
                                             const char *form,
                                             const char **out);

/* --- the mesh ------------------------------------------------------------ */
/* The functions below need a mesh. Without one they return VANGUARD_ERR_USAGE,
 * or 0 or NULL. Returned pointers are valid until the next vanguard_mesh or
 * vanguard_free.
 *
 * Cells follow the node order of AFLR's UGRID. Tetrahedron: 0 1 2 is
 * counter-clockwise seen from 3. Pyramid: base 0 3 4 1, apex 2. Prism: triangle
 * 0 1 2 below triangle 3 4 5. Hexahedron: quadrilateral 0 1 2 3 below 4 5 6 7.
 * Boundary faces are counter-clockwise seen from the fluid. */

/** Size of the whole mesh; the same on every rank. Boundary points come first,
 * followed by the other layer points. Within each kind of cell, layer cells
 * come first, except in a mesh with zones, in which n_layer_tet and the like
 * are 0. */
struct vanguard_counts {
  size_t struct_size;
  uint64_t n_point, n_tet, n_pyr, n_pri;
  uint64_t n_tri, n_quad; /* boundary faces */
  uint64_t n_boundary_point;
  uint64_t n_layer_point; /* points from this number on are outside layers */
  uint64_t n_layer_tet, n_layer_pyr, n_layer_pri;
  size_t n_patch;
  uint64_t n_hex, n_layer_hex;
  uint64_t n_sheet_tri; /* faces of sheets, each between two cells */
  size_t n_sheet;
  size_t n_zone; /* 0: all cells are one zone without a name */
};
VANGUARD_API vanguard_status vanguard_count(vanguard_job *job,
                                            struct vanguard_counts *out);

VANGUARD_API vanguard_status vanguard_patch(vanguard_job *job, size_t i,
                                            struct vanguard_patch *out);

/** Boundary faces of the whole mesh, on every rank, without copying: point
 * numbers [n_tri][3] and [n_quad][4], and the patch of each face as an index
 * for vanguard_patch. */
VANGUARD_API const uint32_t *vanguard_triangles(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_triangle_patches(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_quads(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_quad_patches(const vanguard_job *job);

/** Sheets, which are no part of the boundary, as boundary faces above: number
 * and name of a sheet i < n_sheet, point numbers [n_sheet_tri][3] of its faces,
 * of any orientation, and the sheet of each face. */
VANGUARD_API vanguard_status vanguard_sheet(vanguard_job *job, size_t i,
                                            struct vanguard_patch *out);
VANGUARD_API const uint32_t *vanguard_sheet_triangles(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_sheet_numbers(const vanguard_job *job);

/** A zone of cells, which interfaces enclose. Cells of each kind are in the
 * order of the zones: the first n_tet tetrahedra are in zone 0, and so on. */
struct vanguard_zone {
  size_t struct_size;
  int32_t id;
  const char *name; /* may be "" */
  const char *kind; /* "fluid", "rotating", "porous" or "solid" */
  uint64_t n_tet, n_pyr, n_pri, n_hex;
};
VANGUARD_API vanguard_status vanguard_zone(vanguard_job *job, size_t i,
                                           struct vanguard_zone *out);

/** Copy the whole mesh into arrays of the caller: xyz [n_point][3],
 * tet [n_tet][4], pyr [n_pyr][5] and pri [n_pri][6]. Arrays that are NULL are
 * skipped. VANGUARD_ERR_UNSUPPORTED: the job has several ranks, so no process
 * holds the whole mesh (use pieces instead), or there are 2^32 - 1 points or
 * more. */
VANGUARD_API vanguard_status vanguard_arrays(vanguard_job *job, double *xyz,
                                             uint32_t *tet, uint32_t *pyr,
                                             uint32_t *pri);

/** Copy the hexahedra into hex: [n_hex][8], as vanguard_arrays copies the other
 * cells. */
VANGUARD_API vanguard_status vanguard_hexahedra(vanguard_job *job,
                                                uint32_t *hex);

/** A piece of the mesh held by this rank. The pieces of all ranks together are
 * the mesh: each cell is in exactly one piece, and each point is owned by
 * exactly one. The set of pieces depends on the input alone, but their
 * distribution to ranks does not. The library owns the arrays. */
struct vanguard_piece {
  size_t struct_size;
  size_t n_point;     /* points used, including those owned by other pieces */
  const double *xyz;  /* [n_point][3] */
  const uint32_t *id; /* [n_point] numbers in the whole mesh */
  /* Point own_at + k of the whole mesh is point own[k] of this piece. */
  uint64_t own_at;
  size_t n_own;
  const uint32_t *own; /* [n_own] */
  /* Numbers of this piece's first cells in the whole mesh. */
  uint64_t tet_at, pyr_at, pri_at;
  size_t n_tet, n_pyr, n_pri;
  const uint32_t *tet, *pyr, *pri; /* [][4], [][5], [][6] points of the piece */
  uint32_t subdomain;              /* task that made the cells; 0: layers */
  void *keep;                      /* internal */
  uint64_t hex_at;
  size_t n_hex;
  const uint32_t *hex; /* [][8] */
};
VANGUARD_API size_t vanguard_pieces(const vanguard_job *job);

/** Get piece i. Release it with vanguard_piece_put; several pieces may be held
 * at once. vanguard_mesh and vanguard_free release the pieces that are still
 * held; vanguard_piece_put then does nothing. */
VANGUARD_API vanguard_status vanguard_piece_get(vanguard_job *job, size_t i,
                                                struct vanguard_piece *out);
VANGUARD_API void vanguard_piece_put(vanguard_job *job,
                                     struct vanguard_piece *piece);

/** Quality of the whole mesh. If the mesh has layers, all figures except the
 * volume are those of the cells outside the layers. Angles are in degrees. */
struct vanguard_quality {
  size_t struct_size;
  double volume;
  double angle_min, angle_max; /* dihedral angles */
  double angle_min_p1;         /* 1st percentile of the cells' least angles */
  double radius_ratio_min, radius_ratio_mean; /* 3 inradius / circumradius */
  double volume_ratio_p95, volume_ratio_max;  /* of cells that share a face */
  double edge_within; /* % of edges within 0.7 to 1.5 times the target */
  int32_t is_valid; /* 1: all cells are positive and fit together; 0 is possible
                       after vanguard_read only */
};
VANGUARD_API vanguard_status vanguard_measure(vanguard_job *job,
                                              struct vanguard_quality *out);

/** Measured properties of the layers on one patch. Arrays of three hold the
 * minimum, mean and maximum over the patch's points that have a level. */
struct vanguard_wall {
  size_t struct_size;
  size_t patch; /* patch index; SIZE_MAX: all walls together */
  size_t n_face, n_point;
  /* % of faces that have all levels which growth law and local size allow, and
   * at least one; % that have at least one level */
  double full, any;
  double first[3], asked[3]; /* height of the first point; requested height */
  double level[3], total[3], growth[3];
  double share;        /* height relative to the law, area-weighted mean */
  double first_error;  /* largest |first - asked| / asked */
  double y_plus[3];    /* 0 without a Reynolds number */
  double top_ratio[3]; /* volume ratio across the layer tops: median, 95th
                          percentile, maximum */
};

/** Number of walls with layers, on rank 0; 0 on other ranks and without layers.
 * vanguard_wall returns wall i, or the totals if i is the number of walls. */
VANGUARD_API size_t vanguard_walls(const vanguard_job *job);
VANGUARD_API vanguard_status vanguard_wall(vanguard_job *job, size_t i,
                                           struct vanguard_wall *out);

/** Layers at each wall point; STEM.wall.vtu has the same data. Where a point
 * has several columns (at sharp edges), the values are those of the worst.
 * The library owns the arrays, [n_point] each. */
struct vanguard_wall_points {
  size_t struct_size;
  size_t n_point;
  const uint32_t *point; /* number in the mesh, ascending */
  /* Number of levels; number that the growth law, the local size and, for
   * a limited height, the setting layer_jump request. */
  const int32_t *level, *wanted;
  /* Height of the first point, 0: no levels; requested first height. */
  const double *first, *asked;
  const double *total;  /* height of the last point */
  const double *share;  /* height relative to that of the growth law; 0 without
                           levels */
  const double *growth; /* largest ratio of neighbouring layers */
  /* Causes of fewer and of thinner levels; see vanguard_cause. */
  const int32_t *cause, *compressed;
};

/** Available on rank 0; n_point is 0 elsewhere and without layers. */
VANGUARD_API vanguard_status
vanguard_wall_points(vanguard_job *job, struct vanguard_wall_points *out);

/** Name of a cause: 0 "none", 1 "size" (the layers end where they are as thick
 * as the local edge length, as intended), "proximity", "corner", "visibility",
 * "cell", "collision", "slide", "neighbour", "gradation", "inner". NULL when
 * `cause` is past the last one. Static string; docs/reference/layers.md
 * explains the causes. */
VANGUARD_API const char *vanguard_cause(int32_t cause);

/** Write the mesh as STEM.form for each form in a comma-separated list. The
 * forms are the words of the setting "write": "b8.ugrid", "cogsg", "vtu",
 * "foam", "mapbc", ...; NULL uses that setting. In addition,
 * STEM.resolved.deck holds all settings as they were used and, with layers,
 * STEM.wall.vtu the layer data of the walls. Either all files appear or none.
 * Existing files are replaced, but never an input. Rank 0 of a job with several
 * ranks needs memory for the whole mesh if one of the forms is "foam",
 * "foam-ascii", "meshb", "mesh" or "ugrid" (text). Collective. */
VANGUARD_API vanguard_status vanguard_write(vanguard_job *job, const char *stem,
                                            const char *forms);

#ifdef __cplusplus
}
#endif

#endif
