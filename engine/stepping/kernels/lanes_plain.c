/* Starts side by side, with the vector instructions that every machine of this kind has. */
#include "vector_units.h"

#define LANES MANY
#define BEGIN begin_plain
#define ADVANCE advance_plain
#include "linear_body.h"

const loop_t plain_lanes = {begin_plain, advance_plain};

#if defined(__x86_64__)
#include <cpuid.h>

/* AVX2, and a system that keeps its registers. */
static int has_wide(void)
{
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c >> 27 & 1) || !(c >> 28 & 1)) return 0;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & 6) == 6 && __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b >> 5 & 1);
}

int has_wider(void)
{
    static int known, wide; /* asking the processor takes long where it is shared */
    if (!known) wide = has_wide(), known = 1;
    return wide;
}

const loop_t *widest(int64_t lanes)
{
    const int wide = has_wider();
    return lanes == 1 ? wide ? &wide_one : &plain_one : wide ? &wide_lanes : &plain_lanes;
}
#else
int has_wider(void) { return 0; }

const loop_t *widest(int64_t lanes) { return lanes == 1 ? &plain_one : &plain_lanes; }
#endif
