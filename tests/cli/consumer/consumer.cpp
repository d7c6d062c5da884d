/* SPDX-License-Identifier: LGPL-3.0-or-later */
// The header must compile in C++.
#include <cstdio>
#include <vanguard/vanguard.h>

int main()
{
  vanguard_counts n = VANGUARD_INIT(n);
  vanguard_job *job;
  int bad = vanguard_new(VANGUARD_ABI, &job) != VANGUARD_OK ||
            vanguard_count(job, &n) != VANGUARD_ERR_USAGE;

  vanguard_free(job);
  if (!bad) std::printf("C++ works too\n");
  return bad;
}
