/* SPDX-License-Identifier: BSD-2-Clause */
/* Meshing with MPI: each rank holds pieces of the mesh, and all ranks write one
 * file. usage: mpirun -n RANKS parallel SURFACE STEM */
#include <mpi.h>
#include <stdio.h>
#include <vanguard/vanguard.h>

/* Number of cells, and volume of the tetrahedra, in the pieces of this rank. */
static int measure_pieces(vanguard_job *job, double sum[2])
{
  for (size_t i = 0; i < vanguard_pieces(job); i++) {
    struct vanguard_piece p = VANGUARD_INIT(p);

    if (vanguard_piece_get(job, i, &p)) return -1;
    sum[0] += (double)(p.n_tet + p.n_pyr + p.n_pri + p.n_hex);
    for (size_t c = 0; c < p.n_tet; c++) {
      double e[3][3];

      for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++)
          e[j][k] = p.xyz[3 * p.tet[4 * c + 1 + (size_t)j] + (size_t)k] -
                    p.xyz[3 * p.tet[4 * c] + (size_t)k];
      sum[1] += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                 e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                 e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
                6;
    }
    vanguard_piece_put(job, &p);
  }
  return 0;
}

int main(int argc, char **argv)
{
  MPI_Comm all = MPI_COMM_WORLD;
  double mine[2] = { 0, 0 }, sum[2];
  vanguard_job *job;
  int bad, rank, level;

  vanguard_prepare();
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &level);
  MPI_Comm_rank(all, &rank);
  if (argc != 3) MPI_Abort(all, 2);
  bad = vanguard_new_mpi(VANGUARD_ABI, &all, &job) ||
        vanguard_open(job, argv[1], NULL) || vanguard_mesh(job, NULL, NULL) ||
        vanguard_write(job, argv[2], "b8.ugrid") || measure_pieces(job, mine);
  if (bad) fprintf(stderr, "rank %d: %s\n", rank, vanguard_message(job));
  MPI_Reduce(mine, sum, 2, MPI_DOUBLE, MPI_SUM, 0, all);
  if (!rank && !bad)
    printf("%.0f cells, volume of tetrahedra %.6g\n", sum[0], sum[1]);
  vanguard_free(job);
  MPI_Finalize();
  return bad;
}
