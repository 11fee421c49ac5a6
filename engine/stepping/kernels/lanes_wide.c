/* Starts side by side in the wider registers of x86-64 (AVX2). */
#include "vector_units.h"

#if defined(__x86_64__)
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define LANES MANY
#define BEGIN begin_wide
#define ADVANCE advance_wide
#include "linear_body.h"

const loop_t wide_lanes = {begin_wide, advance_wide};
#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
