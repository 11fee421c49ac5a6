/* Own logarithm, power, arctangent and hypotenuse: within one unit in the last place, the same bits everywhere.
 *
 * Numbers are kept as the sum of two doubles where one is not enough.
 */
#ifndef TORSION_ELEMENTARY_MORE_H
#define TORSION_ELEMENTARY_MORE_H
#include "elementary.h"

typedef struct { double high, low; } pair_t;

static inline pair_t pair_sum(double a, double b)
{
    pair_t s;
    s.high = whole_sum(a, b, &s.low);
    return s;
}

static inline pair_t pair_product(pair_t a, pair_t b)
{
    double lost, p = whole_product(a.high, b.high, &lost);
    return pair_sum(p, lost + (a.high * b.low + a.low * b.high));
}

static inline pair_t pair_plus(pair_t a, pair_t b)
{
    pair_t s = pair_sum(a.high, b.high);
    return pair_sum(s.high, s.low + (a.low + b.low));
}

static inline pair_t pair_quotient(pair_t a, pair_t b)
{
    double lost, q = a.high / b.high, p = whole_product(q, b.high, &lost);
    return pair_sum(q, (((a.high - p) - lost) + (a.low - q * b.low)) / b.high);
}

/* x = m 2^k with √½ ≤ m < √2; exact. */
static inline double mantissa_of(double x, int64_t *k)
{
    uint64_t bits;
    int exponent = 0;
    double m = x;
    if (x < 0x1p-1022) m = frexp(x, &exponent);
    memcpy(&bits, &m, sizeof bits);
    exponent += (int)(bits >> 52) - 1022;
    bits = (bits & 0xfffffffffffffu) | 0x3fe0000000000000u;
    memcpy(&m, &bits, sizeof m);
    if (m < 0x1.6a09e667f3bcdp-1) { m *= 2.0; exponent--; }
    *k = exponent;
    return m;
}

/* ln x of a positive finite number: with s = (m − 1)/(m + 1), |s| < 0.172, ln m = 2 s Σ s^2j / (2j + 1). */
static inline pair_t logarithm_pair(double x)
{
    const pair_t third = {0x1.5555555555555p-2, 0x1.5555555555555p-56};
    int64_t k;
    double m = mantissa_of(x, &k), z;
    pair_t s = pair_quotient((pair_t){m - 1.0, 0.0}, pair_sum(m, 1.0)), square = pair_product(s, s), sum, ln2;
    z = square.high;
    /* from s^5 on one double is enough, 1e-20 of the result; what follows the last term is below 1e-21 */
    sum.high = 1.0 / 5.0 + z * (1.0 / 7.0 + z * (1.0 / 9.0 + z * (1.0 / 11.0 + z * (1.0 / 13.0 + z * (1.0 / 15.0
        + z * (1.0 / 17.0 + z * (1.0 / 19.0 + z * (1.0 / 21.0 + z * (1.0 / 23.0 + z * (1.0 / 25.0
        + z * (1.0 / 27.0)))))))))));
    sum.low = 0.0;
    sum = pair_plus(third, pair_product(square, sum));
    sum = pair_plus((pair_t){1.0, 0.0}, pair_product(square, sum));
    sum = pair_product(s, sum);
    ln2 = pair_product((pair_t){(double)k, 0.0}, (pair_t){0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56});
    return pair_plus(ln2, (pair_t){2.0 * sum.high, 2.0 * sum.low});
}

static inline double logarithm(double x)
{
    pair_t found;
    if (!(x > 0.0)) return x == 0.0 ? -HUGE_VAL : (x - x) / (x - x);
    if (x == HUGE_VAL) return x;
    found = logarithm_pair(x);
    return found.high + found.low;
}

/* x^y of x ≥ 0: exp(y ln x). */
static inline double power(double x, double y)
{
    pair_t found;
    double lost, p;
    if (y == 0.0 || x == 1.0) return 1.0;
    if (y != y || !(x > 0.0) || x == HUGE_VAL) {
        if (x == 0.0 || x == HUGE_VAL) return (x == 0.0) == (y > 0.0) ? 0.0 : HUGE_VAL;
        return (x - x) / (x - x); /* of a negative number: none */
    }
    found = logarithm_pair(x);
    p = y * found.high;
    if (!(p > -746.0)) return 0.0;
    if (p > 710.0) return HUGE_VAL;
    p = whole_product(y, found.high, &lost);
    found = pair_sum(p, lost + y * found.low);
    return exponential_of_sum(found.high, found.low);
}

/* Angle of a point with 0 ≤ y ≤ x, x > 0: the nearest k/8 to y/x first, then a series for what is left. */
static inline pair_t first_octant(double y, double x)
{
    static const pair_t eighth[] = {  /* atan(k/8) */
        {0.0, 0.0},
        {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59}, {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
        {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56}, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
        {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58}, {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
        {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56}, {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
    };
    double c, u, z, lost, k = floor(8.0 * (y / x) + 0.5);
    pair_t above, below, rest;
    c = 0.125 * k;
    above.high = whole_product(c, x, &lost);
    above = pair_plus((pair_t){y, 0.0}, (pair_t){-above.high, -lost});
    below.high = whole_product(c, y, &lost);
    below = pair_plus((pair_t){x, 0.0}, (pair_t){below.high, lost});
    rest = pair_quotient(above, below);
    u = rest.high;
    z = u * u;
    /* |u| ≤ 1/16: what follows is below 1e-19 of it */
    rest.low += u * z * (-1.0 / 3.0 + z * (1.0 / 5.0 + z * (-1.0 / 7.0 + z * (1.0 / 9.0 + z * (-1.0 / 11.0
        + z * (1.0 / 13.0 + z * (-1.0 / 15.0)))))));
    return pair_plus(eighth[(int)k], rest);
}

/* The larger of two magnitudes as a power of two, and whether they lie in the range that needs no care. */
static inline int exponent_of(double x, double y)
{
    int exponent;
    (void)frexp(x > y ? x : y, &exponent);
    return exponent;
}

static inline double arctangent(double y, double x)
{
    const pair_t half_pi = {HALF_PI_1, HALF_PI_2};
    double ax = fabs(x), ay = fabs(y), found;
    pair_t angle;
    int exponent;
    if (x != x || y != y) return x + y;
    if (ax == HUGE_VAL || ay == HUGE_VAL) {
        ax = ax == HUGE_VAL ? 1.0 : 0.0;
        ay = ay == HUGE_VAL ? 1.0 : 0.0;
    }
    if (ay == 0.0) return copysign(signbit(x) ? 2.0 * HALF_PI_1 : 0.0, y);
    if (ax == 0.0) return copysign(HALF_PI_1, y);
    exponent = exponent_of(ax, ay);
    if (!signbit(x) && ay < 0x1p-60 * ax) return y / x; /* as good as its tangent */
    ax = ldexp(ax, -exponent);
    ay = ldexp(ay, -exponent);
    angle = ay <= ax ? first_octant(ay, ax) : first_octant(ax, ay);
    if (ay > ax) angle = pair_plus(half_pi, (pair_t){-angle.high, -angle.low});
    if (signbit(x)) {
        angle = pair_plus((pair_t){2.0 * half_pi.high, 2.0 * half_pi.low}, (pair_t){-angle.high, -angle.low});
    }
    found = angle.high + angle.low;
    return copysign(found, y);
}

static inline double hypotenuse(double x, double y)
{
    double lost, more, root, square;
    int exponent;
    x = fabs(x);
    y = fabs(y);
    if (x == HUGE_VAL || y == HUGE_VAL) return HUGE_VAL;
    if (x == 0.0 || y == 0.0 || x != x || y != y) return x + y;
    exponent = exponent_of(x, y);
    x = ldexp(x, -exponent);
    y = ldexp(y, -exponent);
    square = whole_product(x, x, &lost);
    root = whole_product(y, y, &more);
    square = whole_sum(square, root, &root);
    lost = lost + more + root;
    root = sqrt(square);
    more = whole_product(root, root, &x);
    root += ((square - more) - x + lost) / (2.0 * root);
    return ldexp(root, exponent);
}
#endif
