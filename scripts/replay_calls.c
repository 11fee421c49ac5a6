/* Makes recorded calls of a library of the loops: replay_calls LIBRARY RECORDING (record_calls.py).
 *
 * A line a call: the function, and a digest of what it returned and of the words that it changed.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernels.h"
#ifdef _WIN32
#include <windows.h>
#define open_library(name) LoadLibraryA(name)
#define address_of(name) GetProcAddress(library, name)
#else
#include <dlfcn.h>
#define open_library(name) dlopen(name, RTLD_NOW)
#define address_of(name) dlsym(library, name)
#endif

typedef union {
    int64_t i;
    uint64_t u;
    double d;
    void *p;
} word_t;

static void *library;
#define FUNCTION(name) ((__typeof__(&name))must(address_of(#name), #name))

static void *must(void *pointer, const char *what)
{
    if (pointer) return pointer;
    fprintf(stderr, "no %s\n", what);
    exit(2);
}

#include "calls.h"

/* The functions below are those of record_calls.py. */
static uint64_t spread(uint64_t word)
{
    word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    return word ^ (word >> 31);
}

static uint64_t without_sign_of_nan(word_t word)
{
    return word.u == 0xFFF8000000000000u ? 0x7FF8000000000000u : word.u;
}

static uint64_t digest(int64_t n, const word_t *before, const word_t *after)
{
    uint64_t sum = 0;
    for (int64_t i = 0; i < n; i++) {
        const uint64_t word = without_sign_of_nan(after[i]);
        if (after[i].u == before[i].u || word == without_sign_of_nan(before[i])) continue;
        sum += spread(spread((uint64_t)i + 1) + word);
    }
    return sum;
}

int main(int argc, char **argv)
{
    word_t header[2], *words, *before = NULL, *after = NULL;
    const word_t *at, *pages;
    size_t count;
    FILE *file;
    if (argc != 3) return 2;
    library = must(open_library(argv[1]), argv[1]);
    file = must(fopen(argv[2], "rb"), argv[2]);
    must(fread(header, sizeof *header, 2, file) == 2 ? header : NULL, "header");
    count = (size_t)(header[0].i + header[1].i);
    words = must(malloc(count * sizeof *words), "memory");
    must(fread(words, sizeof *words, count, file) == count ? words : NULL, "recording to its end");
    pages = words + header[0].i;
    for (at = words; at < pages;) {
        const int64_t function = at[0].i, n = at[1].i, pointers = at[2].i;
        at += 3;
        before = must(realloc(before, (size_t)n * sizeof *before), "memory");
        after = must(realloc(after, (size_t)n * sizeof *after), "memory");
        for (int64_t i = 0; i < n; i += PAGE)
            memcpy(before + i, pages + (at++)->i, (size_t)(n - i < PAGE ? n - i : PAGE) * sizeof *before);
        memcpy(after, before, (size_t)n * sizeof *after);
        for (int64_t i = 0; i < pointers; i++) after[at[2 * i].i].p = after + at[2 * i + 1].i;
        make_call(function, after);
        for (int64_t i = 0; i < pointers; i++) after[at[2 * i].i].i = 0;
        at += 2 * pointers;
        printf("%s %016" PRIx64 "\n", names[function], digest(n, before, after));
    }
    return 0;
}
