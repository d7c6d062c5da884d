/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* make_hostile FOLDER: writes all hostile files into FOLDER and their list,
 * CASES, one line for each: command, file, verdict, phrase, separated by '|'.
 * Deterministic; tests/hostile/run.sh reads the list. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hostile.h"

void put_raw(struct bytes *b, const void *data, size_t n)
{
  if (n > sizeof b->b - b->n) abort();
  memcpy(b->b + b->n, data, n);
  b->n += n;
}

static void put_word(struct bytes *b, uint64_t v, int size)
{
  unsigned char byte[8];

  for (int i = 0; i < size; i++)
    byte[i] = (unsigned char)(v >> 8 * (b->big ? size - 1 - i : i));
  put_raw(b, byte, (size_t)size);
}

void put_i32(struct bytes *b, int32_t v)
{
  put_word(b, (uint32_t)v, 4);
}

void put_i64(struct bytes *b, int64_t v)
{
  put_word(b, (uint64_t)v, 8);
}

void put_f32(struct bytes *b, float v)
{
  uint32_t word;

  memcpy(&word, &v, sizeof word);
  put_word(b, word, 4);
}

void put_f64(struct bytes *b, double v)
{
  uint64_t word;

  memcpy(&word, &v, sizeof word);
  put_word(b, word, 8);
}

void save(const char *file, const void *data, size_t n)
{
  FILE *f = fopen(file, "wb");

  if (f && fwrite(data, 1, n, f) == n && !fclose(f)) return;
  fprintf(stderr, "make_hostile: %s: %s\n", file, strerror(errno));
  exit(1);
}

void save_text(const char *file, const char *text)
{
  save(file, text, strlen(text));
}

static void write_table(FILE *list, const struct hostile *h)
{
  for (; h->file; h++) {
    if (h->text) save_text(h->file, h->text);
    else h->make(h->file);
    fprintf(list, "%s|%s|%s|%s\n", h->command ? h->command : "check", h->file,
            h->verdict == MENDED ? "mended" : "refused", h->phrase);
  }
}

int main(int argc, char **argv)
{
  FILE *list;

  if (argc != 2 || chdir(argv[1])) {
    fprintf(stderr, "usage: make_hostile FOLDER\n");
    return 2;
  }
  list = fopen("CASES", "w");
  if (!list) return 1;
  write_table(list, hostile_texts);
  write_table(list, hostile_binaries);
  write_table(list, hostile_volumes);
  write_table(list, hostile_shapes);
  write_table(list, hostile_projects);
  return fclose(list) ? 1 : 0;
}
