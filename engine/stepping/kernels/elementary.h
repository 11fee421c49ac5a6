/* Own sin, cos and exp: the same bits from every compiler, within one unit in the last place. */
#ifndef TORSION_ELEMENTARY_H
#define TORSION_ELEMENTARY_H
#include "lanes.h"
#include <string.h>

typedef struct { double sine, cosine; } sincos_t;

/* π/2 in three parts: k times the first two is exact up to k = 2^20. */
#define HALF_PI_A 0x1.921fb544p+0
#define HALF_PI_B 0x1.0b4611a6p-34
#define HALF_PI_C 0x1.3198a2e037073p-69
#define LARGEST_EXACT 1e6
/* The same as three doubles, for larger numbers. */
#define HALF_PI_1 0x1.921fb54442d18p+0
#define HALF_PI_2 0x1.1a62633145c07p-54
#define HALF_PI_3 -0x1.f1976b7ed8fbcp-110
/* ln 2 in two parts: k times the first is exact. */
#define LN2_A 0x1.62e42feep-1
#define LN2_B 0x1.a39ef35793c76p-33
/* Added and taken away: the nearest whole number. */
#define ROUNDER 0x1.8p52

/* Sum of two numbers and what it lost. */
static inline double whole_sum(double a, double b, double *lost)
{
    double s = a + b, c = s - a;
    *lost = (a - (s - c)) + (b - c);
    return s;
}

/* Product and what it lost (Dekker; no fused operation, so that all machines agree). */
static inline double whole_product(double a, double b, double *lost)
{
    const double split = 134217729.0;
    double c = split * a, d = split * b;
    double ah = c - (c - a), bh = d - (d - b), al = a - ah, bl = b - bh;
    double p = a * b;
    *lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return p;
}

/* x − k π/2 as a sum of two numbers, and k. */
static inline double from_quadrant(double x, double *low, int64_t *quadrant)
{
    double k = (x * 0x1.45f306dc9c883p-1 + ROUNDER) - ROUNDER;
    double lost, further, high;
    *quadrant = (int64_t)k;
    if (fabs(x) <= LARGEST_EXACT) {
        high = whole_sum(x - k * HALF_PI_A, -(k * HALF_PI_B), &lost); /* the difference is exact */
        *low = lost - k * HALF_PI_C;
    } else {
        double first = whole_product(k, HALF_PI_1, &further), second, rest, more;
        high = whole_sum(x - first, -further, &lost); /* the difference is exact */
        second = whole_product(k, HALF_PI_2, &rest);
        high = whole_sum(high, -second, &more);
        *low = more + (lost - (rest + k * HALF_PI_3));
    }
    return high;
}

/* Sine and cosine of r + y, y what r lost. Taylor: what follows is below 1e-19 on |r| ≤ π/4. */
#define NEAR_ZERO(number, name)                                                                                \
    static inline void name(number r, number y, number *sine, number *cosine)                                  \
    {                                                                                                          \
        number z = r * r, half = 0.5 * z, w = 1.0 - half, s, c;                                                \
        s = -1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + z * (-1.0 / 39916800.0  \
            + z * (1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)))))));     \
        c = 1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * (-1.0 / 3628800.0                        \
            + z * (1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 + z * (1.0 / 20922789888000.0                 \
            + z * (-1.0 / 6402373705728000.0)))))));                                                           \
        *sine = r + (z * r * s + y * (1.0 - half));                                                            \
        *cosine = w + (((1.0 - w) - half) + (z * z * c - r * y));                                              \
    }
NEAR_ZERO(double, near_zero)

static inline sincos_t sin_cos(double x)
{
    int64_t quadrant;
    double low, high = from_quadrant(x, &low, &quadrant);
    double r = high + low, s, c;
    sincos_t wave;
    near_zero(r, (high - r) + low, &s, &c);
    switch (quadrant & 3) {
    case 0: wave.sine = s; wave.cosine = c; break;
    case 1: wave.sine = c; wave.cosine = -s; break;
    case 2: wave.sine = -s; wave.cosine = -c; break;
    default: wave.sine = -c; wave.cosine = s; break;
    }
    return wave;
}

#if LANES == 1
typedef sincos_t waves_t;
static inline waves_t waves_of(lane_t x) { return sin_cos(x); }
#else
typedef struct { lane_t sine, cosine; } waves_t;
NEAR_ZERO(lane_t, near_zeros)

/* The same of every lane. */
static inline waves_t waves_of(lane_t x)
{
    lane_t counted = x * 0x1.45f306dc9c883p-1 + ROUNDER, k = counted - ROUNDER;
    mask_t quadrant = (mask_t)counted; /* its last bits count the quadrants */
    mask_t odd = -(quadrant & 1), large = magnitude(x) > LARGEST_EXACT;
    lane_t a = x - k * HALF_PI_A, b = -(k * HALF_PI_B), high = a + b, of_b = high - a;
    lane_t low = ((a - (high - of_b)) + (b - of_b)) - k * HALF_PI_C;
    lane_t r = high + low, s, c;
    waves_t waves;
    near_zeros(r, (high - r) + low, &s, &c);
    waves.sine = (lane_t)((mask_t)choose(odd, c, s) ^ (quadrant & 2) << 62);
    waves.cosine = (lane_t)((mask_t)choose(odd, s, c) ^ ((quadrant + 1) & 2) << 62);
    for (int l = 0; any(large) && l < LANES; l++) {
        sincos_t wave;
        if (!large[l]) continue;
        wave = sin_cos(x[l]);
        waves.sine[l] = wave.sine;
        waves.cosine[l] = wave.cosine;
    }
    return waves;
}
#endif

/* 2^k for −1022 ≤ k ≤ 1023. */
static inline double power_of_two(int64_t k)
{
    uint64_t bits = (uint64_t)(k + 1023) << 52;
    double found;
    memcpy(&found, &bits, sizeof found);
    return found;
}

/* exp(x + low), low far below x. */
static inline double exponential_of_sum(double x, double low)
{
    double k, a, b, r, y, p;
    int64_t whole, half;
    if (!(x > -745.5)) return x == x ? 0.0 : x;
    if (x > 709.8) return HUGE_VAL;
    k = (x * 0x1.71547652b82fep+0 + ROUNDER) - ROUNDER;
    a = x - k * LN2_A; /* exact */
    b = k * LN2_B - low;
    r = a - b;
    y = (a - r) - b;
    /* Taylor: what follows is below 1e-18 on |r| ≤ ln 2 / 2 */
    p = 1.0 / 2.0 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0
        + r * (1.0 / 40320.0 + r * (1.0 / 362880.0 + r * (1.0 / 3628800.0 + r * (1.0 / 39916800.0
        + r * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0)))))))))));
    p = 1.0 + (r + (r * r * p + (y + r * y)));
    whole = (int64_t)k;
    half = whole / 2; /* in two steps: the first or the last may lie outside the range of one */
    return p * power_of_two(half) * power_of_two(whole - half);
}

static inline double exponential(double x) { return exponential_of_sum(x, 0.0); }
#endif
