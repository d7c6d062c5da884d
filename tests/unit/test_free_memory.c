/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The free memory of a machine and of control groups, from files in a folder in
 * place of /proc and /sys. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "run/common/free_memory.h"

#define ROOT VG_TMP_DIR "/free_memory"

static void put(const char *path, const char *text)
{
  char command[1000];
  FILE *f;

  snprintf(command, sizeof command, "mkdir -p $(dirname %s%s)", ROOT, path);
  assert_int_equal(system(command), 0);
  snprintf(command, sizeof command, "%s%s", ROOT, path);
  f = fopen(command, "w");
  assert_non_null(f);
  fputs(text, f);
  fclose(f);
}

static int begin(void **state)
{
  (void)state;
  return system("rm -rf " ROOT);
}

static void without_files_the_memory_is_unknown(void **state)
{
  (void)state;
  assert_true(isinf(vg_free_memory(ROOT)));
}

static void a_machine_states_its_free_memory(void **state)
{
  (void)state;
  put("/proc/meminfo", "MemTotal: 9000 kB\nMemAvailable:   4000 kB\n");
  assert_true(vg_free_memory(ROOT) == 4000 * 1024);
}

/* A limit of the group around the own one applies, too, and pages of files can
 * be dropped. */
static void groups_limit_it(void **state)
{
  (void)state;
  put("/proc/meminfo", "MemAvailable: 4000 kB\n");
  put("/proc/self/cgroup", "0::/job/step\n");
  put("/sys/fs/cgroup/job/step/memory.max", "max\n");
  put("/sys/fs/cgroup/job/step/memory.current", "500\n");
  assert_true(vg_free_memory(ROOT) == 4000 * 1024);
  put("/sys/fs/cgroup/job/memory.max", "3000\n");
  put("/sys/fs/cgroup/job/memory.current", "1000\n");
  put("/sys/fs/cgroup/job/memory.stat", "anon 7\ninactive_file 100\n");
  assert_true(vg_free_memory(ROOT) == 2100);
  put("/sys/fs/cgroup/job/memory.current", "9000\n");
  assert_true(vg_free_memory(ROOT) == 0);
}

/* In a container the folder of the group may be missing. */
static void a_container_has_the_outermost_group(void **state)
{
  (void)state;
  put("/proc/self/cgroup", "0::/somewhere/outside\n");
  put("/sys/fs/cgroup/memory.max", "3000\n");
  put("/sys/fs/cgroup/memory.current", "1000\n");
  assert_true(vg_free_memory(ROOT) == 2000);
}

static void groups_of_version_1_limit_it(void **state)
{
  const char *folder = "/sys/fs/cgroup/memory/job";
  char path[200];

  (void)state;
  put("/proc/self/cgroup", "5:cpu:/other\n4:memory:/job\n0::/\n");
  snprintf(path, sizeof path, "%s/memory.limit_in_bytes", folder);
  put(path, "5000\n");
  snprintf(path, sizeof path, "%s/memory.usage_in_bytes", folder);
  put(path, "1500\n");
  assert_true(vg_free_memory(ROOT) == 3500);
}

static void this_process_uses_memory(void **state)
{
  double heap, before = vg_used_memory(&heap);
  char *block = malloc(64 << 20);

  (void)state;
  assert_true(before > 0 && heap >= 0);
  assert_non_null(block);
  memset(block, 1, 64 << 20);
  assert_true(block[12345] == 1 && vg_used_memory(&heap) > before + 6e7);
  free(block);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(without_files_the_memory_is_unknown, begin),
    cmocka_unit_test_setup(a_machine_states_its_free_memory, begin),
    cmocka_unit_test_setup(groups_limit_it, begin),
    cmocka_unit_test_setup(a_container_has_the_outermost_group, begin),
    cmocka_unit_test_setup(groups_of_version_1_limit_it, begin),
    cmocka_unit_test(this_process_uses_memory),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
