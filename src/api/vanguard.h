/* vanguard/vanguard.h: Vanguard as a library: a surface in, a volume mesh out.
 *
 *   vanguard_job *job;
 *   vanguard_new(VANGUARD_ABI, &job);
 *   vanguard_surface(job, "wing", n_point, xyz, n_tri, tri, NULL);
 *   vanguard_set(job, "growth", "1.3");
 *   if (vanguard_mesh(job, NULL, NULL)) puts(vanguard_message(job));
 *   vanguard_write(job, "wing", "b8.ugrid,vtu");
 *   vanguard_free(job);
 *
 * Errors. Functions that can fail return a vanguard_status, 0 for success;
 * vanguard_message then tells a person what is wrong, where, and what to do.
 * The library never prints and never ends the process; a call that fails
 * leaves the job as it was, but for the mesh where that is said.
 *
 * Numbers. Points and patches are counted from 0, coordinates are in the unit
 * of the surface. The mesh is a function of input and settings alone: the same
 * for any number of ranks and threads.
 *
 * Threads. A job is for one thread at a time, save for vanguard_cancel, and a
 * thread can do with it what it likes; different jobs may be used by different
 * threads at once. Meshing starts threads of its own (setting "threads").
 *
 * Ranks. "Collective" functions of a job with MPI are called by all its ranks
 * in the same order, and succeed or fail on all of them.
 *
 * Compatibility. Programs stay binary compatible while the library accepts
 * the VANGUARD_ABI they were compiled with. Structures begin with their size,
 * which VANGUARD_INIT fills in: new members are added behind the others, and
 * the library touches no more of a structure than its caller knows. */
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
  VANGUARD_ERR_INPUT = -1,       /* data or settings contradict themselves */
  VANGUARD_ERR_FORMAT = -2,      /* a file does not follow its format */
  VANGUARD_ERR_IO = -3,          /* the system could not read or write */
  VANGUARD_ERR_MEMORY = -4,      /* not enough memory */
  VANGUARD_ERR_GEOMETRY = -5,    /* the surface cannot bound a mesh */
  VANGUARD_ERR_UNSUPPORTED = -6, /* valid, but beyond what this build can do */
  VANGUARD_ERR_REMOTE = -7,      /* another rank failed */
  VANGUARD_ERR_USAGE = -8,       /* a call that makes no sense now */
  VANGUARD_ERR_STOPPED = -9      /* vanguard_cancel, or the progress function */
} vanguard_status;

/** Settings, a surface and, once it is made, a mesh. */
typedef struct vanguard_job vanguard_job;

/* struct vanguard_counts n = VANGUARD_INIT(n); */
#define VANGUARD_INIT(name)                                                    \
  {                                                                            \
    .struct_size = sizeof(name)                                                \
  }

/* --- the library --------------------------------------------------------- */

/** "0.1.0". Static string. */
VANGUARD_API const char *vanguard_version(void);

/** The newest VANGUARD_ABI that this library serves. */
VANGUARD_API int vanguard_abi(void);

/** To be called, if at all, at the beginning of a program, before it starts
 * threads or MPI: a small process is forked from which those that run TetGen
 * and METIS come. Without it they are forked from the program when they are
 * needed, which takes longer the larger that is. A second call does nothing.
 * VANGUARD_ERR_MEMORY: the system refuses; all works as without. */
VANGUARD_API vanguard_status vanguard_prepare(void);

/* --- jobs ---------------------------------------------------------------- */

/** A job of this process alone, with default settings and no surface.
 *
 * @param abi  VANGUARD_ABI
 * @param out  to be freed also after a failure, which vanguard_message tells;
 *             NULL when memory is refused
 * VANGUARD_ERR_UNSUPPORTED: the library is too old, or too new, for it. */
VANGUARD_API vanguard_status vanguard_new(int abi, vanguard_job **out);

/** A job of the ranks of a communicator, on which all of them mesh together.
 * MPI has been started with MPI_THREAD_MULTIPLE. Collective.
 *
 * @param comm  the address of an MPI_Comm, which is duplicated; the MPI is
 *              the one that the library was built with
 * _fortran: a Fortran handle (MPI_Comm_c2f) instead. */
VANGUARD_API vanguard_status vanguard_new_mpi(int abi, const void *comm,
                                              vanguard_job **out);
VANGUARD_API vanguard_status vanguard_new_fortran(int abi, int32_t comm,
                                                  vanguard_job **out);

/** NULL is accepted. Collective. */
VANGUARD_API void vanguard_free(vanguard_job *job);

/** What the last call that failed has to say; "" before. Valid until the next
 * call with this job. NULL is accepted. */
VANGUARD_API const char *vanguard_message(const vanguard_job *job);

/** Lines about the surface after vanguard_mesh: what was repaired and, where
 * it cannot bound a mesh, every kind of defect with its first places. Valid
 * until the next vanguard_mesh. On the first rank of a node, else "". */
VANGUARD_API const char *vanguard_details(const vanguard_job *job);

/** Note i, in words, of what vanguard_mesh assumed, found odd or left out;
 * NULL behind the last. Valid until the next vanguard_mesh. */
VANGUARD_API const char *vanguard_note(const vanguard_job *job, size_t i);

/* --- settings ------------------------------------------------------------ */

/** Set what a run deck and the program's options set, by its name and in their
 * words: "growth" "1.2", "layers" "yes", "write" "b8.ugrid". */
VANGUARD_API vanguard_status vanguard_set(vanguard_job *job, const char *name,
                                          const char *value);

/** The value of a setting as text. VANGUARD_ERR_USAGE: it has more than
 * size - 1 characters; 512 are always enough. */
VANGUARD_API vanguard_status vanguard_get(vanguard_job *job, const char *name,
                                          char *value, size_t size);

/** Add a row to a table of the deck: "sources", "patches", "layers"; of
 * "farfield" the row is replaced. n columns by name, as in the deck; others
 * keep their defaults.
 * Example: columns { "kind", "x0", "r0", "h0" } and values { "sphere", "0.5",
 * "0.2", "0.01" } in "sources". */
VANGUARD_API vanguard_status vanguard_add(vanguard_job *job, const char *table,
                                          size_t n, const char *const *column,
                                          const char *const *value);

/** Take all settings and rows of a deck, given as text. */
VANGUARD_API vanguard_status vanguard_deck(vanguard_job *job, const char *text);

struct vanguard_setting {
  size_t struct_size;
  const char *name, *unit, *help; /* static */
  const char *kind;               /* "real", "count", "flag", "word", "text" */
  const char *const *words;       /* of a "word": NULL-ended; else NULL */
  double least, most;             /* of a number */
};

/** Setting i of all there are; 1, or 0 behind the last. */
VANGUARD_API int vanguard_setting(size_t i, struct vanguard_setting *out);

/* --- input --------------------------------------------------------------- */

/** What vanguard mesh -p PROJECT --deck DECK reads: a project, or a surface
 * file by its full name. Settings become the defaults and those of the deck:
 * set others after this. The files are read by vanguard_mesh.
 *
 * @param deck  NULL: PROJECT.deck, if there is one */
VANGUARD_API vanguard_status vanguard_open(vanguard_job *job,
                                           const char *project,
                                           const char *deck);

/** A surface in memory, copied; all ranks give the same. Closed, or half of a
 * symmetric body; triangles are counter-clockwise seen from the fluid.
 *
 * @param name   for messages and files
 * @param xyz    [n_point][3]
 * @param tri    [n_tri][3] points
 * @param patch  [n_tri] numbers of patches, any values; NULL: all are 1. Names
 *               and conditions: vanguard_add(job, "patches", ...)
 * VANGUARD_ERR_INPUT names a triangle with a point that is not there. */
VANGUARD_API vanguard_status vanguard_surface(vanguard_job *job,
                                              const char *name, size_t n_point,
                                              const double *xyz, size_t n_tri,
                                              const uint32_t *tri,
                                              const int32_t *patch);

/** Target edge length at x, above 0; INFINITY: others may decide. */
typedef double vanguard_size_function(void *user, const double x[3]);

/** Sizes by a function, besides surface and sources and, like those, limited
 * by the growth; the least of all holds. NULL: none any more. What is narrower
 * than a 32nd of the domain's box is found only where other sizes are small.
 *
 * @param size  called by several threads at once while vanguard_mesh is at
 *              work; it must follow from x alone, on all ranks alike */
VANGUARD_API vanguard_status vanguard_sizes(vanguard_job *job,
                                            vanguard_size_function *size,
                                            void *user);

/** Sizes at points, copied, in the same way: from each point they grow at the
 * rate of the setting "growth". n 0: none any more. Replaces, and is replaced
 * by, vanguard_sizes.
 *
 * @param xyz   [n][3]
 * @param size  [n], above 0 and finite; VANGUARD_ERR_INPUT names the point */
VANGUARD_API vanguard_status vanguard_size_points(vanguard_job *job, size_t n,
                                                  const double *xyz,
                                                  const double *size);

/* --- meshing ------------------------------------------------------------- */

/** Called now and then by the thread that called vanguard_mesh or another,
 * one at a time, on every rank, but while the field is filled on rank 0 alone;
 * anything but 0 stops the run.
 *
 * @param phase     "read", "check", "sizes", "layers", "fill", "judge", ...;
 *                  within one neither count nor share runs backwards
 * @param done      triangles, columns or cells so far
 * @param expected  of how many; 0: not known */
typedef int vanguard_progress(void *user, const char *phase, uint64_t done,
                              uint64_t expected);

/** Make the mesh. The one before, if any, is gone, also after a failure.
 * progress may be NULL. Collective. */
VANGUARD_API vanguard_status vanguard_mesh(vanguard_job *job,
                                           vanguard_progress *progress,
                                           void *user);

/** Stop vanguard_mesh, which returns VANGUARD_ERR_STOPPED soon, on all ranks;
 * without effect when none is at work. By any thread, or a signal's handler. */
VANGUARD_API void vanguard_cancel(vanguard_job *job);

/* --- the mesh ------------------------------------------------------------ */
/* What follows needs a mesh: VANGUARD_ERR_USAGE, or nothing, without. Pointers
 * that are given out are valid until the next vanguard_mesh or vanguard_free.
 *
 * Nodes of cells: tetrahedron 0 1 2 counter-clockwise seen from 3; pyramid
 * base 0 3 4 1, apex 2; prism 0 1 2 below 3 4 5 (AFLR's UGRID). Faces of the
 * boundary are counter-clockwise seen from the fluid. */

/** Of the whole mesh, on every rank. Points of the boundary come first, then
 * those of the layers; cells of the layers are the first of their kind. */
struct vanguard_counts {
  size_t struct_size;
  uint64_t n_point, n_tet, n_pyr, n_pri;
  uint64_t n_tri, n_quad; /* of the boundary */
  uint64_t n_boundary_point;
  uint64_t n_layer_point; /* points before this are the layers' */
  uint64_t n_layer_tet, n_layer_pyr, n_layer_pri;
  size_t n_patch;
};
VANGUARD_API vanguard_status vanguard_count(vanguard_job *job,
                                            struct vanguard_counts *out);

struct vanguard_patch {
  size_t struct_size;
  int32_t id;           /* number in the input and in files */
  int32_t bc, bc_fun3d; /* USM3D's, FUN3D's code; INT32_MIN: none */
  const char *name;     /* may be "" */
};
VANGUARD_API vanguard_status vanguard_patch(vanguard_job *job, size_t i,
                                            struct vanguard_patch *out);

/** The boundary, on every rank, without copies: [n_tri][3], [n_quad][4] points
 * and, per face, its patch as an index for vanguard_patch. */
VANGUARD_API const uint32_t *vanguard_triangles(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_triangle_patches(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_quads(const vanguard_job *job);
VANGUARD_API const uint32_t *vanguard_quad_patches(const vanguard_job *job);

/** The whole mesh into arrays of the caller: xyz [n_point][3], tet [n_tet][4],
 * pyr [n_pyr][5], pri [n_pri][6]; those that are NULL are left out.
 * VANGUARD_ERR_UNSUPPORTED in a job of several ranks, where no process holds
 * the mesh (pieces are at hand there), and from 2^32 - 1 points on. */
VANGUARD_API vanguard_status vanguard_arrays(vanguard_job *job, double *xyz,
                                             uint32_t *tet, uint32_t *pyr,
                                             uint32_t *pri);

/** A part of the mesh that this rank has. All pieces of all ranks together are
 * the mesh, each cell once and each point owned once. Which there are follows
 * from the input alone, which rank has them does not. Arrays belong to the
 * library. */
struct vanguard_piece {
  size_t struct_size;
  size_t n_point;     /* of this piece, others' included */
  const double *xyz;  /* [n_point][3] */
  const uint32_t *id; /* [n_point] its number in the mesh */
  uint64_t own_at;    /* points own_at + k of the mesh ... */
  size_t n_own;
  const uint32_t *own; /* [n_own] ... are point own[k] of the piece */
  uint64_t tet_at, pyr_at, pri_at; /* first cells of it in the mesh */
  size_t n_tet, n_pyr, n_pri;
  const uint32_t *tet, *pyr, *pri; /* [][4], [][5], [][6] points of it */
  uint32_t subdomain;              /* 0: layers */
  void *keep;                      /* the library's */
};
VANGUARD_API size_t vanguard_pieces(const vanguard_job *job);

/** Have piece i at hand, until it is put; several at once are allowed. */
VANGUARD_API vanguard_status vanguard_piece_get(vanguard_job *job, size_t i,
                                                struct vanguard_piece *out);
VANGUARD_API void vanguard_piece_put(vanguard_job *job,
                                     struct vanguard_piece *piece);

/** How good it is; of all ranks together. With layers angles and ratios are
 * those of the field above them. Degrees. */
struct vanguard_quality {
  size_t struct_size;
  double volume;
  double angle_min, angle_max; /* dihedral */
  double angle_min_p1;         /* 1 % of the cells have a smaller one */
  double radius_ratio_min, radius_ratio_mean; /* 3 inradius / circumradius */
  double volume_ratio_p95, volume_ratio_max;  /* of cells with a common face */
  double edge_within; /* % of edges 0.7 to 1.5 times the target */
};
VANGUARD_API vanguard_status vanguard_measure(vanguard_job *job,
                                              struct vanguard_quality *out);

/** Layers on one patch, measured: ranges are least, mean, largest over its
 * points. */
struct vanguard_wall {
  size_t struct_size;
  size_t patch; /* index; SIZE_MAX: all of them together */
  size_t n_face, n_point;
  double full, any;          /* % of faces with all levels that law and
                                size ask for; with one level at least */
  double first[3], asked[3]; /* height of the first point; as asked */
  double level[3], total[3], growth[3];
  double share;        /* height over the law's, mean by area */
  double first_error;  /* largest |first - asked| / asked */
  double y_plus[3];    /* 0 without a Reynolds number */
  double top_ratio[3]; /* volumes across the tops: median, 95 %,
                          largest */
};

/** Walls with layers, on rank 0 (0 elsewhere, and without layers); wall i, or
 * the sum over all where i is their number. */
VANGUARD_API size_t vanguard_walls(const vanguard_job *job);
VANGUARD_API vanguard_status vanguard_wall(vanguard_job *job, size_t i,
                                           struct vanguard_wall *out);

/** Layers at the points of the walls, as STEM.wall.vtu has them: where a point
 * has several columns (at sharp edges), those of the worst. Arrays [n_point]
 * are the library's. */
struct vanguard_wall_points {
  size_t struct_size;
  size_t n_point;
  const uint32_t *point;         /* of the mesh, rising */
  const int32_t *level, *wanted; /* levels; as many as law and size ask for */
  const double *first, *asked;   /* height of the first point; as asked; 0:
                                    there is no level */
  const double *total;           /* height of the last */
  const double *share;           /* height over the law's */
  const double *growth;          /* largest ratio of neighbouring layers */
  const int32_t *cause, *compressed; /* of fewer levels, of thinner ones:
                                      numbers for vanguard_cause */
};

/** On rank 0; n_point is 0 elsewhere and without layers. */
VANGUARD_API vanguard_status
vanguard_wall_points(vanguard_job *job, struct vanguard_wall_points *out);

/** A cause in a word: 0 "none", 1 "size" (the layers end as thick as the local
 * cell, as intended), "proximity", "corner", "visibility", "cell", "collision",
 * "slide"; NULL behind the last. Static string; docs/layers.md explains. */
VANGUARD_API const char *vanguard_cause(int32_t cause);

/** Write the mesh as STEM.form for each form of a list, the words of the
 * setting "write": "b8.ugrid", "cogsg", "vtu", "openfoam", "mapbc", ...; NULL:
 * those of the setting. Besides, STEM.resolved.deck, with all settings as they
 * were used, and with layers STEM.wall.vtu. All appear together or not at all
 * and replace what is there, but never an input. Collective.
 * VANGUARD_ERR_UNSUPPORTED: several ranks, and a form that one writes. */
VANGUARD_API vanguard_status vanguard_write(vanguard_job *job, const char *stem,
                                            const char *forms);

#ifdef __cplusplus
}
#endif

#endif
