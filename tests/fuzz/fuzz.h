/* What all fuzz programs share. One fuzz_NAME.c is one target: with clang -DFUZZ -fsanitize=fuzzer it is a libFuzzer program (run.sh), else
 *
 *     fuzz_NAME [-n MUTATIONS] [-d DICTIONARY] PATH …     each file, or each file of each folder, as it is, then so many mutations of all
 *
 * which ends well, or aborts at the first input that breaks a promise. */
#ifndef TESTS_FUZZ_H
#define TESTS_FUZZ_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Promises; unlike assertions never left out. */
#define require(condition) ((condition) ? (void)0 : fuzz_broken(#condition, __FILE__, __LINE__))
G_GNUC_NORETURN void fuzz_broken(const char *promise, const char *file, int line);

/* Puts bytes into a file of that name in a folder of this process, for readers that take a path; the folder goes when the program ends. Valid until the
 * next call with that name. */
const char *fuzz_file(const char *name, const void *data, size_t size);

/* Either there is a result and no error, or none and an error of one of the domains (the last one 0) whose message people can read. Clears it. */
void fuzz_check_error(bool result, GError **error, ...);

/* Splits the bytes at lines that are "%%" alone: the k-th part as text, "" when there are fewer. Free it. */
char *fuzz_part(const uint8_t *data, size_t size, unsigned k);

#endif
