/* What the library was made with and from. */
#include "kernels.h"

#if defined(__clang__)
#define COMPILER "clang "
#else
#define COMPILER "gcc "
#endif
#if defined(__x86_64__)
#define PROCESSOR "x86-64"
#elif defined(__aarch64__)
#define PROCESSOR "aarch64"
#else
#define PROCESSOR "another processor"
#endif
#if defined(_WIN32)
#define SYSTEM "Windows"
#elif defined(__APPLE__)
#define SYSTEM "macOS"
#else
#define SYSTEM "Linux"
#endif
#ifndef SOURCES
#define SOURCES "unknown"
#endif
#define WORDS(a) #a
#define NUMBER(a) WORDS(a)
#define VERSION NUMBER(__GNUC__) "." NUMBER(__GNUC_MINOR__)
#if defined(__clang__)
#undef VERSION
#define VERSION NUMBER(__clang_major__) "." NUMBER(__clang_minor__)
#endif

const char *about(void)
{
    return COMPILER VERSION ", " PROCESSOR ", " SYSTEM ", sources " SOURCES;
}
